"""Tests the model: the adult, model files, pickling, and errors."""

from __future__ import annotations

import pickle
import shutil
from pathlib import Path

import numpy as np
import pytest

import contrapposto
from contrapposto import ContrappostoError, InputError, InternalError, Model
from contrapposto import _native

URDF = """<robot name="arm"><link name="base"/>
  <link name="forearm"><inertial><origin xyz="0.2 0 0"/><mass value="1.5"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
  <joint name="elbow" type="revolute"><parent link="base"/><child link="forearm"/>
    <axis xyz="0 1 0"/><limit lower="-1" upper="2.5" effort="40" velocity="1"/></joint>
</robot>"""

MJCF = """<mujoco><include file="parts/arm.xml"/></mujoco>"""
PART = """<mujoco><worldbody><body name="arm"><joint name="elbow" axis="0 1 0" range="-60 60"/>
  <geom type="sphere" size="0.1" mass="2" pos="0.3 0 0"/></body></worldbody></mujoco>"""


def test_the_adult_has_the_mass_and_coordinates_that_it_is_given(woman: Model) -> None:
    assert woman.mass == pytest.approx(60, rel=1e-3)
    assert len(woman.coordinate_names) == 45 == len(woman.coordinate_units) == len(woman.default_posture)
    assert woman.coordinate_units[woman.coordinate_names.index("pelvis_tx")] == "m"
    assert "hand_r" in woman.segment_names
    assert Model.adult().mass == pytest.approx(73.0, rel=1e-3)
    assert "45 coordinates" in repr(woman)


@pytest.mark.parametrize(
    ("size", "message"),
    [
        ({"stature": 5.0}, "stature .*5.* must lie in 1.2"),
        ({"mass": float("nan")}, "mass .*NaN"),
        ({"sex": "x"}, "'female' or 'male'"),
    ],
)
def test_an_adult_of_no_adults_size_is_refused(size: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message) as error:
        Model.adult(**size)  # type: ignore[arg-type]
    assert isinstance(error.value, (ValueError, ContrappostoError))


def test_a_model_does_not_change_and_is_not_made_by_its_name(woman: Model) -> None:
    with pytest.raises(AttributeError):
        woman.mass = 3  # type: ignore[misc]
    with pytest.raises(AttributeError):
        woman.other = 3  # type: ignore[attr-defined]
    with pytest.raises(TypeError, match="Model.adult"):
        Model()


def test_pickled_adults_give_the_same_bits(woman: Model, random_postures: np.ndarray) -> None:
    copy = pickle.loads(pickle.dumps(woman))
    assert copy.torques(random_postures[:5]).active.tobytes() == woman.torques(random_postures[:5]).active.tobytes()


def test_a_urdf_file_is_read_with_its_root(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(URDF)
    arm = Model.from_file(path)
    assert arm.coordinate_names == ("elbow",)
    assert arm.torques([0.0]).external[0] == pytest.approx(1.5 * 9.80665 * 0.2, rel=1e-3)
    free = Model.from_file(path, root="free")
    assert free.coordinate_names[3:7] == ("root_qw", "root_qx", "root_qy", "root_qz")
    assert "root_fz" in free.torque_names
    with pytest.raises(InputError, match="`fixed` or `free`"):
        Model.from_file(path, root="both")  # type: ignore[arg-type]


def test_a_pickled_model_file_needs_no_file(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "arm.xml").write_text(PART)
    (tmp_path / "model.xml").write_text(MJCF)
    model = Model.from_file(tmp_path / "model.xml")
    expected, bytes_of = model.torques([0.4]), pickle.dumps(model)
    shutil.rmtree(tmp_path)
    copy = pickle.loads(bytes_of)
    assert copy.torques([0.4]).external.tobytes() == expected.external.tobytes()
    assert copy.notes == model.notes


def test_a_file_that_is_no_model_is_refused_by_its_name(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="gone.osim"):
        Model.from_file(tmp_path / "gone.osim")
    path = tmp_path / "broken.urdf"
    path.write_text("<robot")
    with pytest.raises(InputError, match="broken.urdf"):
        Model.from_file(path)
    with pytest.raises(InputError, match="not a regular file"):
        Model.from_file(tmp_path)


def test_an_overlay_is_refused_with_its_line(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(URDF)
    (tmp_path / "over.toml").write_text("\n[coordinate.elbow]\nnonsense = 3\n")
    with pytest.raises(InputError) as error:
        Model.from_file(tmp_path / "arm.urdf", overlay=tmp_path / "over.toml")
    assert error.value.file is not None and error.value.file.endswith("over.toml")
    assert error.value.line is not None and error.value.line >= 2


def test_bytes_that_are_no_model_are_refused() -> None:
    with pytest.raises(InputError, match="no pickled model"):
        _native.Model.from_state(b"nonsense")


def test_a_panic_is_an_internal_error() -> None:
    with pytest.raises(InternalError, match="contrapposto has a defect: asked for by a test"):
        _native._panic_for_tests()


def test_the_version_is_that_of_the_distribution() -> None:
    from importlib.metadata import version

    assert contrapposto.__version__ == version("contrapposto")


def test_an_adult_at_a_percentile_is_that_of_the_table() -> None:
    # docs/sweeps.md: measured 5th and 95th percentile of mass, ANSUR II, to which the lognormal form comes within 0.1 kg; of a normal
    # distribution they lie 1.6449 deviations away.
    for sex, stature, masses in (("female", (1.628, 0.0642), (51.3, 66.9, 87.1)), ("male", (1.756, 0.0686), (64.4, 84.4, 110.7))):
        for percentile, score, mass in zip((5, 50, 95), (-1.644854, 0, 1.644854), masses):
            model = Model.adult(sex, percentile=percentile)  # type: ignore[arg-type]
            assert model.mass == pytest.approx(mass, abs=0.15)
            (note,) = [note for note in model.notes if "percentile" in note]
            assert f"stature {stature[0] + score * stature[1]:.3f} m and mass {model.mass:.1f} kg" in note
            assert "measured" in note and "ANSUR II" in note and ("women" in note) == (sex == "female")
            copy = pickle.loads(pickle.dumps(model))
            assert copy.mass == model.mass and copy.notes == model.notes
    assert not any("percentile" in note for note in Model.adult().notes)
    for odd in (0, 100, -3, float("nan")):
        with pytest.raises(InputError, match="must lie between 0 and 100"):
            Model.adult(percentile=odd)
    with pytest.raises(InputError, match="leave them out"):
        Model.adult(stature=1.7, percentile=5)
