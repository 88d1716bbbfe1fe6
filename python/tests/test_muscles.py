"""Tests muscles of a model file: the program's numbers, and torques with muscles."""

from __future__ import annotations

import json
import pickle
import subprocess
from pathlib import Path

import numpy as np
import pytest

import contrapposto
from contrapposto import InputError, Model

MUSCLE = """<Thelen2003Muscle name="{name}"><GeometryPath><PathPointSet><objects>
  <PathPoint name="p"><socket_parent_frame>/ground</socket_parent_frame><location>{x} 0.2 0</location></PathPoint>
  <PathPoint name="o"><socket_parent_frame>/bodyset/b</socket_parent_frame><location>{x} -0.3 0</location></PathPoint>
  </objects></PathPointSet></GeometryPath><max_isometric_force>500</max_isometric_force>
  <optimal_fiber_length>0.1</optimal_fiber_length><tendon_slack_length>0.38</tendon_slack_length></Thelen2003Muscle>"""

OSIM = """<OpenSimDocument Version="40500"><Model name="m"><BodySet><objects><Body name="b"><mass>2</mass>
  <mass_center>0 -0.2 0</mass_center></Body></objects></BodySet><JointSet><objects><PinJoint name="j">
  <socket_parent_frame>/ground</socket_parent_frame><socket_child_frame>/bodyset/b</socket_child_frame>
  <coordinates><Coordinate name="q"><range>-1 1</range></Coordinate></coordinates></PinJoint></objects></JointSet>
  <ForceSet><objects>{forces}</objects></ForceSet></Model></OpenSimDocument>"""

ANGLES = np.linspace(-0.4, 0.4, 5)


@pytest.fixture(scope="session")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("muscles") / "m.osim"
    forces = MUSCLE.format(name="front", x=0.04) + MUSCLE.format(name="back", x=-0.03)
    path.write_text(OSIM.format(forces=forces))
    return path


@pytest.fixture(scope="session")
def postures(file: Path) -> Path:
    path = file.parent / "q.csv"
    path.write_text("time,q\n" + "".join(f"{row},{angle!r}\n" for row, angle in enumerate(ANGLES.tolist())))
    return path


def lines(program: str, *words: str) -> list[dict[str, object]]:
    text = subprocess.run([program, *words], capture_output=True, text=True).stdout
    return [json.loads(line) for line in text.splitlines()]


@pytest.mark.parametrize("rule", ["geodesic", "opensim"])
def test_numbers_are_those_of_the_program(file: Path, postures: Path, program: str, rule: str) -> None:
    model = Model.from_file(file)
    found = contrapposto.muscles(model, {"q": ANGLES}, rule=rule, activation=0.2)  # type: ignore[arg-type]
    words = ["muscles", str(file), str(postures), "--radians", "--json", "--rule", rule, "--activation", "0.2"]
    theirs = lines(program, *words)
    assert len(theirs) == 5 and found.names == ("front", "back") and found.coordinates == ("q",)
    for row, frame in enumerate(theirs):
        record = contrapposto.Record(frame)
        for array, key in [
            (found.lengths, "lengths_m"),
            (found.fibre_lengths, "fibre_lengths_m"),
            (found.tendon_forces, "tendon_forces_n"),
            (found.passive_forces, "passive_forces_n"),
            (found.max_forces, "max_forces_n"),
        ]:
            assert array[row].tolist() == [record[key][name] for name in found.names]
        assert found.moment_arms[row, :, 0].tolist() == [record.moment_arms_m[name].q for name in found.names]
        assert found.passive_torques[row, 0] == record.passive_torques_nm.q
        strength = record.strength_nm.q
        assert found.strength[row, 0].tolist() == [strength.positive["sum"], strength.negative["sum"]]
        assert found.coupled_strength[row, 0].tolist() == [strength.positive.coupled, strength.negative.coupled]
        assert found.missing_torques[row, 0] == strength.missing_nm


def test_moment_arms_are_minus_the_slope_of_the_length(file: Path) -> None:
    model, step = Model.from_file(file), 1e-6
    found = contrapposto.muscles(model, {"q": ANGLES})
    beside = [contrapposto.muscles(model, {"q": ANGLES + way * step}).lengths for way in (1, -1)]
    np.testing.assert_allclose(found.moment_arms[..., 0], (beside[1] - beside[0]) / (2 * step), atol=1e-8)


@pytest.mark.parametrize("use", [None, "off", "strength", "passive", "both"])
def test_torques_with_muscles_are_those_of_the_program(file: Path, postures: Path, program: str, use: str | None) -> None:
    options = [] if use is None else ["--muscles", use]
    words = [program, "torques", str(file), str(postures), "--radians", "--static", "--json", *options]
    theirs = json.loads(subprocess.run(words, capture_output=True, text=True).stdout)
    for model in (Model.from_file(file), pickle.loads(pickle.dumps(Model.from_file(file)))):
        ours = model.torques({"q": ANGLES}, muscles=use)
        for kind in ("external", "passive", "active"):
            expected = [frame["coordinates"]["q"][kind] for frame in theirs]
            assert getattr(ours, kind)[:, 0].tolist() == expected, kind


def test_passive_torque_is_that_of_resting_fibres(file: Path) -> None:
    model = Model.from_file(file)
    of_muscles = contrapposto.muscles(model, {"q": ANGLES}).passive_torques[:, 0]
    assert np.abs(of_muscles).max() > 0.1
    assert model.torques({"q": ANGLES})["q"]["passive"].tolist() == of_muscles.tolist()
    assert model.passive("q", ANGLES).tolist() == of_muscles.tolist()
    assert not model.torques({"q": ANGLES}, muscles="off")["q"]["passive"].any()


def test_odd_questions_are_refused(file: Path, woman: Model) -> None:
    with pytest.raises(InputError, match="no muscles"):
        contrapposto.muscles(woman)
    with pytest.raises(InputError, match="no muscle could be read"):
        woman.torques(woman.default_posture, muscles="both")
    with pytest.raises(InputError, match="muscles is `all`"):
        woman.torques(woman.default_posture, muscles="all")  # type: ignore[arg-type]
    model = Model.from_file(file)
    with pytest.raises(InputError, match="activation is 2"):
        contrapposto.muscles(model, activation=2)
    with pytest.raises(InputError, match="activation is NaN"):
        contrapposto.muscles(model, activation=float("nan"))
    with pytest.raises(InputError, match="'geodesic' or 'opensim'"):
        contrapposto.muscles(model, rule="straight")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="NaN"):
        contrapposto.muscles(model, [np.nan])
    with pytest.raises(InputError, match="q has no row"):
        contrapposto.muscles(model, np.zeros((0, 1)))


def test_arrays_have_names_for_xarray(file: Path) -> None:
    pytest.importorskip("xarray")
    found = contrapposto.muscles(Model.from_file(file), {"q": ANGLES})
    data = found.to_xarray()
    assert data["strength"].sel(coordinate="q", sense="negative").values.tolist() == found.strength[:, 0, 1].tolist()
    assert data["moment_arms"].attrs["units"] == "m" and data["moment_arms"].dims == ("posture", "muscle", "coordinate")
