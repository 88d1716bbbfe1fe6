"""Tests strength, passive torque and fatigue of muscle groups, and decisions of single joints."""

from __future__ import annotations

import json
import pickle
import subprocess

import numpy as np
import pytest

import contrapposto
from contrapposto import InputError, Model

PROBLEM = {
    "passive": {
        "lower": {"torque_nm": 0.3, "rate_per_rad": 8, "angle_deg": 10},
        "upper": {"torque_nm": 0.4, "rate_per_rad": 8, "angle_deg": 135},
    },
    "range_deg": [0, 145],
    "angle_deg": 20,
    "external_nm": -2.7,
    "external_slope_nm_per_rad": 0.9,
    "strategy": "passive",
    "minimum_decrease_ratio": 0.9,
    "tolerance_nm": 0.05,
}


def test_strength_and_names_of_the_elbow(woman: Model) -> None:
    strength = woman.strength("elbow_flex_r", np.radians([10, 90]))
    assert strength.shape == (2, 2) and (strength > 5).all()
    assert woman.group_names("elbow_flex_r") == ("elbow flexion", "elbow extension")
    with pytest.raises(InputError, match="no coordinate `elbow`"):
        woman.strength("elbow", 0.0)
    with pytest.raises(InputError, match="no strength of `pelvis_tx` is known"):
        woman.strength("pelvis_tx", 0.0)


def test_the_passive_curve_is_that_of_torques(woman: Model) -> None:
    angles = np.linspace(0.1, 2.4, 30)
    assert woman.passive("elbow_flex_r", angles).tobytes() == np.ascontiguousarray(
        woman.torques({"elbow_flex_r": angles})["elbow_flex_r"]["passive"]
    ).tobytes()
    with pytest.raises(InputError, match="no coordinate `elbow`"):
        woman.passive("elbow", angles)


def test_a_group_fails_at_its_endurance_time(woman: Model) -> None:
    time = woman.endurance_time("elbow_flex_r", [0.005, 0.3, 0.6])
    assert np.isinf(time[0]) and time[1] > time[2] > 0
    step = time[2] / 1000
    fatigue = woman.fatigue("elbow_flex_r", np.full(1100, 0.6), step)
    assert (np.diff(fatigue[:990]) > 0).all()
    assert fatigue[989] < 1 and fatigue[1010] == pytest.approx(1, abs=1e-9)
    rested = woman.fatigue("elbow_flex_r", np.zeros(1000), 60.0, start=0.8)
    assert rested[-1] < 0.1


def test_odd_loads_and_senses_are_refused(woman: Model) -> None:
    with pytest.raises(InputError, match="an angle of `elbow_flex_r` is nan"):
        woman.strength("elbow_flex_r", [0.1, float("nan")])
    with pytest.raises(InputError, match="relative load is -1"):
        woman.endurance_time("elbow_flex_r", [0.2, -1.0])
    with pytest.raises(InputError, match="relative load is nan"):
        woman.fatigue("elbow_flex_r", [float("nan")], 1.0)
    with pytest.raises(InputError, match="seconds is 0"):
        woman.fatigue("elbow_flex_r", [0.2], 0)
    with pytest.raises(InputError, match="start is 2"):
        woman.fatigue("elbow_flex_r", [0.2], 1.0, start=2)
    with pytest.raises(InputError, match="'positive' or 'negative'"):
        woman.endurance_time("elbow_flex_r", 0.2, sense="flexion")  # type: ignore[arg-type]


def test_decisions_are_those_of_the_program(program: str) -> None:
    line = subprocess.run([program, "minimize"], input=json.dumps(PROBLEM), capture_output=True, text=True).stdout
    assert contrapposto.minimize(PROBLEM) == contrapposto.Record(json.loads(line))
    assert contrapposto.minimize(PROBLEM).why
    with pytest.raises(InputError, match="invalid type: string"):
        contrapposto.minimize({**PROBLEM, "angle_deg": "x"})
    with pytest.raises(InputError, match="no JSON object of finite numbers"):
        contrapposto.minimize({**PROBLEM, "angle_deg": float("nan")})


def test_a_measured_passive_torque_goes_through_its_rows(woman: Model) -> None:
    (low, high) = woman.ranges[woman.coordinate_names.index("elbow_flex_r")]
    angles, torques = np.linspace(low, high, 6), np.array([9.0, 2.0, 0.5, -0.5, -3.0, -12.0])
    model = woman.with_passive("elbow_flex_r", angles, torques)
    np.testing.assert_allclose(model.passive("elbow_flex_r", angles), torques, atol=1e-9)
    between = model.passive("elbow_flex_r", np.linspace(low, high, 101))
    assert (np.diff(between) <= 1e-12).all()
    assert model.passive("elbow_flex_l", angles).tobytes() == woman.passive("elbow_flex_l", angles).tobytes()
    copy = pickle.loads(pickle.dumps(model))
    assert copy.passive("elbow_flex_r", angles).tobytes() == model.passive("elbow_flex_r", angles).tobytes()
    with pytest.raises(InputError, match="rise"):
        woman.with_passive("elbow_flex_r", angles, torques[::-1])
    with pytest.raises(InputError, match="6 angles and 5 torques"):
        woman.with_passive("elbow_flex_r", angles, torques[1:])
    with pytest.raises(InputError, match="begin at or below"):
        woman.with_passive("elbow_flex_r", angles + 0.1, torques)
    with pytest.raises(InputError, match="no coordinate `elbow`"):
        woman.with_passive("elbow", angles, torques)


def test_a_measured_strength_counts_everywhere(woman: Model) -> None:
    angles = np.radians([10, 60, 120])
    model = woman.with_strength("elbow_flex_r", [20, 45, 25], [15, 30, 35], angles)
    np.testing.assert_allclose(model.strength("elbow_flex_r", angles), [[20, 15], [45, 30], [25, 35]], atol=1e-9)
    np.testing.assert_allclose(model.strength("elbow_flex_r", np.radians([0, 140])), [[20, 15], [25, 35]], atol=1e-9)
    assert model.group_names("elbow_flex_r") == woman.group_names("elbow_flex_r")
    # A load is a share of this strength in an assessment.
    found = contrapposto.assess(model, {"elbow_flex_r": angles}, [0, 1, 2], loads=["hand_r 2kg"], fixed_root=True, angle_error=0.0)
    elbow = found.names.index("elbow_flex_r")
    active = found.active[:, elbow]
    strength = np.where(active > 0, [20, 45, 25], [15, 30, 35])
    np.testing.assert_allclose(found.load[:, elbow], np.abs(active) / strength, rtol=1e-9)
    flat = model.with_strength("elbow_flex_r", 50, 40, fatigue="knee")
    assert flat.strength("elbow_flex_r", angles).tolist() == [[50, 40]] * 3
    assert flat.endurance_time("elbow_flex_r", 0.4) == woman.endurance_time("knee_angle_r", 0.4)
    assert pickle.loads(pickle.dumps(model)).strength("elbow_flex_r", 0.7).tolist() == model.strength("elbow_flex_r", 0.7).tolist()
    with pytest.raises(InputError, match="-1"):
        woman.with_strength("elbow_flex_r", -1, 40)
    with pytest.raises(InputError, match="no table of strength"):
        woman.with_strength("elbow_flex_r", [20, 45], [15, 30], [1, 0.5])
    with pytest.raises(InputError, match="must be one number"):
        woman.with_strength("elbow_flex_r", [20, 45], [15, 30])
    with pytest.raises(InputError, match="no fatigue class `tail`"):
        woman.with_strength("elbow_flex_r", 20, 45, fatigue="tail")
