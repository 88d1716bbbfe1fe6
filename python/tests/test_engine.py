"""Tests engines: one step a call, many targets at once, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

import contrapposto
from conftest import REPOSITORY
from contrapposto import Engine, InputError

SCENARIO = """
format = 1
[model]
adult = { sex = "male", stature_m = 1.741, mass_kg = 73, part = "right_arm" }
[[task]]
kind = "point"
segment = "hand_r"
target_m = [0.3, 1.2, 0.3]
"""


def test_a_solve_is_the_pose_of_the_scenario() -> None:
    path = REPOSITORY / "scenarios/poses/reach-shelf.toml"
    engine, pose = Engine(path), contrapposto.pose(path)
    assert engine.names == pose.names
    assert engine.solve().tobytes() == pose.q[0].tobytes()


def test_steps_follow_a_target_that_moves() -> None:
    engine = Engine(SCENARIO)
    (task,) = engine.tasks
    q = engine.start
    for height in np.linspace(1.2, 1.4, 60):
        q = engine.step(q, {task: (0.3, height, 0.3)})
        assert q.shape == (len(engine.names),)
    for _ in range(10):
        q = engine.step(q)
    assert engine.errors is not None and engine.errors[0] < 1e-6
    # the target is reached: the same posture is held where the same target is asked for in a scenario of its own
    again = Engine(SCENARIO.replace("1.2", "1.4"))
    again.step(q)
    assert again.errors is not None and again.errors[0] < 1e-6


def test_many_targets_at_once_are_those_of_one_at_a_time() -> None:
    engine = Engine(SCENARIO)
    (task,) = engine.tasks
    targets = np.random.default_rng(3).uniform((0.1, 1.0, 0.1), (0.4, 1.5, 0.4), (20, 3))
    together = engine.solve({task: targets})
    assert together.shape == (20, len(engine.names))
    assert engine.errors is not None and engine.errors.shape == (20, 1)
    for i in (7, 0, 19):
        assert Engine(SCENARIO).solve({task: targets[i]}).tobytes() == together[i].tobytes()
    starts = np.repeat(engine.start[np.newaxis], 20, axis=0)
    assert engine.solve({task: targets}, starts).tobytes() == together.tobytes()


def test_odd_targets_and_postures_are_refused() -> None:
    engine = Engine(SCENARIO)
    (task,) = engine.tasks
    with pytest.raises(InputError, match=f"no task `hand`; there are: {task}"):
        engine.step(engine.start, {"hand": (0, 0, 0)})
    with pytest.raises(InputError, match=r"has 2 values; it needs 3 \(m\)"):
        engine.step(engine.start, {task: (0, 0)})
    with pytest.raises(InputError, match="it must be finite"):
        engine.step(engine.start, {task: (0, float("nan"), 0)})
    with pytest.raises(InputError, match="posture has 3 values"):
        engine.step([0, 0, 0])
    with pytest.raises(InputError, match="is NaN"):
        engine.step(np.full(len(engine.names), np.nan))
    with pytest.raises(InputError, match="one posture"):
        engine.step(np.zeros((2, len(engine.names))))
    with pytest.raises(InputError, match="rows; all must have as many"):
        engine.solve({task: np.zeros((3, 3))}, np.zeros((2, len(engine.names))))
    # nothing of this has changed the engine
    assert engine.solve().tobytes() == Engine(SCENARIO).solve().tobytes()
