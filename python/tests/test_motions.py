"""Tests assessed motions: the program's words and numbers, from files and from arrays, and what is refused."""

from __future__ import annotations

import json
import pickle
import subprocess
from pathlib import Path

import numpy as np
import pytest

import contrapposto
from contrapposto import Force, InputError, Model, Weight

TIMES = np.linspace(0, 120, 25)
#: A weight is held out while the elbow bends slowly.
MOTION = {"arm_flex_r": np.full(25, np.radians(60)), "elbow_flex_r": np.radians(np.linspace(20, 50, 25))}
LOADS = ["hand_r 2kg", Weight("hand_l", 0.3), Force("hand_l", (0.1, -4, 0), at=(0, -0.08, 0))]
WORDS = ["--load", "hand_r 2kg", "--load", "hand_l 0.3kg", "--force", "hand_l 0.1,-4,0 at 0,-0.08,0"]


@pytest.fixture(scope="session")
def table(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The motion as a file, every number with all its digits."""
    path = tmp_path_factory.mktemp("motion") / "held.csv"
    rows = ["time," + ",".join(MOTION)]
    rows += [",".join(repr(float(value)) for value in row) for row in zip(TIMES, *MOTION.values())]
    path.write_text("\n".join(rows) + "\n")
    return path


def assessed(woman: Model) -> contrapposto.Assessment:
    return contrapposto.assess(woman, MOTION, TIMES, loads=LOADS, fixed_root=True)


def test_words_and_numbers_are_those_of_the_program(woman: Model, program: str, table: Path) -> None:
    command = [program, "assess", "adult:female,1.65m,60kg", str(table), "--radians", "--fixed-root", *WORDS]
    text = subprocess.run([*command, "--json", "--no-suggest"], capture_output=True, text=True).stdout
    theirs = json.loads(text)
    ours = assessed(woman)
    assert ours.summary == contrapposto.Record({**theirs, "motion": "motion"})
    assert ours.verdict.kind == "held_until" and ours.verdict.who == theirs["verdict"]["who"]
    suggested = json.loads(subprocess.run([*command, "--json"], capture_output=True, text=True).stdout)
    ours = contrapposto.assess(woman, MOTION, TIMES, loads=LOADS, fixed_root=True, suggest=True)
    assert ours.summary.suggestions == contrapposto.Record(suggested).suggestions != ()


def test_a_file_and_options_are_those_of_the_program(woman: Model, program: str, tmp_path: Path) -> None:
    path = tmp_path / "standing.csv"
    path.write_text("time,elbow_flex_r\n" + "".join(f"{time},{20 + time / 2}\n" for time in range(60)))
    words = ["--support", "calcn_l,calcn_r", "--angle-error", "2", "--from", "6", "--fatigue", "muscle_group"]
    words += ["--fatigue-sex", "any", "--dynamics", "--cutoff-hz", "0.3", "--degrees"]
    command = [program, "assess", "adult:female,1.65m,60kg", str(path), "--json", "--no-suggest", *words]
    theirs = json.loads(subprocess.run(command, capture_output=True, text=True).stdout)
    ours = contrapposto.assess(
        woman, path, degrees=True, support=["calcn_l", "calcn_r"], angle_error=np.radians(2), start=6, fatigue="muscle_group",
        fatigue_sex="any", inertia=True, cutoff_hz=0.3,
    )  # fmt: skip
    assert ours.summary == contrapposto.Record(theirs)


def test_repeats_are_those_of_the_program(woman: Model, program: str, table: Path) -> None:
    command = [program, "assess", "adult:female,1.65m,60kg", str(table), "--radians", "--fixed-root", "--json", "--no-suggest"]
    command += ["--repeat", "8h", "--every", "3min", "--work", "50min", "--break", "10min"]
    theirs = json.loads(subprocess.run(command, capture_output=True, text=True).stdout)
    ours = contrapposto.assess(woman, MOTION, TIMES, fixed_root=True, repeat=8 * 3600, every=180, work=3000, rest=600)
    assert ours.summary == contrapposto.Record({**theirs, "motion": "motion"}) and ours.summary.repeats.cycles > 100
    with pytest.raises(InputError, match="--repeat"):
        contrapposto.assess(woman, MOTION, TIMES, fixed_root=True, every=180)


def test_arrays_have_a_row_a_posture(woman: Model) -> None:
    found = contrapposto.assess(woman, MOTION, TIMES, loads=LOADS, fixed_root=True, angle_error=0.0)
    np.testing.assert_array_equal(found.t, TIMES)
    elbow = found.names.index("elbow_flex_r")
    np.testing.assert_array_equal(found.q[:, elbow], MOTION["elbow_flex_r"])
    torques = woman.torques(MOTION, loads=LOADS)
    np.testing.assert_allclose(found.active[:, elbow], torques["elbow_flex_r"]["active"], atol=1e-9)
    np.testing.assert_allclose(found.external + found.passive + found.active, 0, atol=1e-9)
    assert found.fatigue.shape == (25, len(found.names), 2)
    groups = found.summary.groups
    assert found.load.max() == pytest.approx(max(group.peak_load.value for group in groups), abs=1e-12)
    assert found.fatigue.max() == pytest.approx(max(group.peak_fatigue.value for group in groups), abs=1e-12)


def test_an_assessment_pickles_and_shows_its_page(woman: Model, table: Path, tmp_path: Path, program: str) -> None:
    found = contrapposto.assess(woman, table, degrees=False, loads=["hand_r 2kg"], fixed_root=True)
    copy = pickle.loads(pickle.dumps(found))
    assert copy.summary == found.summary and copy.html() == found.html()
    command = [program, "assess", "adult:female,1.65m,60kg", str(table), "--radians", "--fixed-root", "--load", "hand_r 2kg"]
    subprocess.run([*command, "--no-suggest", "--out", str(tmp_path / "out")], capture_output=True)
    assert (tmp_path / "out/report.html").read_text() == found.html()


def test_odd_motions_and_options_are_refused(woman: Model, tmp_path: Path) -> None:
    def refused(words: str, *motion: object, **options: object) -> None:
        with pytest.raises(InputError, match=words):
            contrapposto.assess(woman, *motion, **options)  # type: ignore[arg-type]

    refused("needs times", MOTION)
    refused("3 times and 25 postures", MOTION, [0, 1, 2])
    refused("times must rise", MOTION, np.zeros(25))
    refused("time of row 0 is NaN s", MOTION, np.full(25, np.nan))
    refused("`elbow_flex_r` of row 1 is inf", {"elbow_flex_r": [0.1, np.inf]}, [0, 1])
    refused("have 3 values; the model has", np.zeros((2, 3)), [0, 1])
    refused("gone.mot", tmp_path / "gone.mot")
    refused("leave them out", tmp_path / "gone.mot", [0, 1])
    refused("no segment `paw`", MOTION, TIMES, support=["paw"])
    refused("between 0 and 20 deg", MOTION, TIMES, angle_error=1.0)
    refused("joint, muscle_group", MOTION, TIMES, fatigue="nonsense")
    refused("has 25 rows; a load at all times has one", MOTION, TIMES, loads=[Weight("hand_r", np.ones(25))])
    refused("lists of texts", MOTION, TIMES, support="calcn_r")
