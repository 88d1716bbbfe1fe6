"""Tests the exchange of postures with MuJoCo, Pinocchio and OpenSim's tables. MuJoCo and Pinocchio are no packages of `.ci/run`: there
these tests are skipped, and pytest names them; `pip install mujoco pin` brings them in."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from contrapposto import InputError, Model, interop

#: A free body with an arm on a ball and a forearm on a hinge.
MJCF = """<mujoco><compiler angle="radian"/><worldbody><body name="trunk" pos="0 0 1"><freejoint name="root"/>
  <inertial mass="9" pos="0 0.01 0" diaginertia="0.1 0.2 0.3"/>
  <body name="arm" pos="0.1 0.2 0.3"><joint name="shoulder" type="ball"/><inertial mass="2" pos="0.1 0 -0.2" diaginertia="0.1 0.1 0.1"/>
  <body name="forearm" pos="0 0 -0.4"><joint name="elbow" axis="0 1 0" range="-2 2"/>
  <inertial mass="1.5" pos="0.05 0 -0.2" diaginertia="0.01 0.01 0.01"/></body></body></body></worldbody></mujoco>"""

#: A wheel that turns without end, and an arm.
URDF = """<robot name="r"><link name="base"/><link name="wheel"><inertial><origin xyz="0.2 0 0"/><mass value="2"/>
  <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
  <link name="arm"><inertial><origin xyz="0 0 0.3"/><mass value="1"/>
  <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
  <joint name="turn" type="continuous"><parent link="base"/><child link="wheel"/><axis xyz="0 1 0"/></joint>
  <joint name="lift" type="revolute"><parent link="wheel"/><child link="arm"/><origin xyz="0.4 0 0"/><axis xyz="1 0 0"/>
  <limit lower="-1" upper="1" effort="40" velocity="1"/></joint></robot>"""


def written(folder: Path, name: str, text: str) -> Path:
    path = folder / name
    path.write_text(text)
    return path


def floating(model: Model, rows: int) -> np.ndarray:
    """Postures of MJCF with quaternions of length 1, from a fixed seed."""
    random = np.random.default_rng(7)
    q = random.uniform(-1, 1, (rows, len(model.coordinate_names)))
    for first in (model.coordinate_names.index(name) for name in ("root_qw", "shoulder_qw")):
        turn = q[:, first : first + 4]
        q[:, first : first + 4] = turn / np.linalg.norm(turn, axis=1, keepdims=True)
    return q


def test_torques_of_exchanged_postures_are_those_of_mujoco(tmp_path: Path) -> None:
    mujoco: Any = pytest.importorskip("mujoco")
    path = written(tmp_path, "arm.xml", MJCF)
    ours, theirs = Model.from_file(path), mujoco.MjModel.from_xml_path(str(path))
    q = floating(ours, 20)
    qpos = interop.to_mujoco(ours, q, theirs)
    data = mujoco.MjData(theirs)
    external = ours.torques(q).external
    assert ours.torque_names[:3] == ("root_fx", "root_fy", "root_fz")
    for row in range(20):
        data.qpos = qpos[row]
        mujoco.mj_forward(theirs, data)
        np.testing.assert_allclose(external[row], -data.qfrc_bias, atol=1e-9)
    assert interop.from_mujoco(ours, qpos, theirs).tobytes() == q.tobytes()
    assert interop.from_mujoco(ours, qpos[3], theirs).tobytes() == q[3].tobytes()


def test_the_adult_goes_to_mujoco_and_back(woman: Model, program: str, tmp_path: Path) -> None:
    mujoco: Any = pytest.importorskip("mujoco")
    path = tmp_path / "adult.xml"
    subprocess.run([program, "convert", "adult:female,1.65m,60kg", str(path)], check=True, capture_output=True)
    theirs = mujoco.MjModel.from_xml_path(str(path))
    low, high = woman.ranges.T
    q = woman._native.coupled(np.random.default_rng(5).uniform(low, high, (5, len(low))))
    qpos = interop.to_mujoco(woman, q, theirs)
    assert interop.from_mujoco(woman, qpos, theirs).tobytes() == q.tobytes()
    data = mujoco.MjData(theirs)
    external = woman.torques(q)
    places = {theirs.joint(i).name: int(theirs.jnt_dofadr[i]) for i in range(theirs.njnt)}
    for row in range(5):
        data.qpos = qpos[row]
        mujoco.mj_forward(theirs, data)
        for name in ("elbow_flex_r", "knee_angle_l", "hip_flexion_r", "pelvis_tilt"):
            ours = external[name]["external"][row]
            assert ours == pytest.approx(-data.qfrc_bias[places[name]], abs=1e-6), name


def test_torques_of_exchanged_postures_are_those_of_pinocchio(tmp_path: Path) -> None:
    pinocchio: Any = pytest.importorskip("pinocchio")
    path = written(tmp_path, "r.urdf", URDF)
    for root, theirs in (
        ("fixed", pinocchio.buildModelFromUrdf(str(path))),
        ("free", pinocchio.buildModelFromUrdf(str(path), pinocchio.JointModelFreeFlyer())),
    ):
        ours = Model.from_file(path, root=root)  # type: ignore[arg-type]
        q = np.random.default_rng(9).uniform(-1, 1, (10, len(ours.coordinate_names)))
        if root == "free":
            first = ours.coordinate_names.index("root_qw")
            q[:, first : first + 4] /= np.linalg.norm(q[:, first : first + 4], axis=1, keepdims=True)
        configurations = interop.to_pinocchio(ours, q, theirs)
        assert configurations.shape == (10, theirs.nq)
        data = theirs.createData()
        torques = ours.torques(q)
        for row in range(10):
            gravity = pinocchio.computeGeneralizedGravity(theirs, data, configurations[row])
            for name in ("turn", "lift"):
                joint = theirs.joints[theirs.getJointId(name)]
                assert torques[name]["external"][row] == pytest.approx(-gravity[joint.idx_v], abs=1e-6)
        np.testing.assert_allclose(interop.from_pinocchio(ours, configurations, theirs), q, atol=1e-15)


def test_quaternions_have_the_order_that_is_named(tmp_path: Path) -> None:
    pinocchio: Any = pytest.importorskip("pinocchio")
    path = written(tmp_path, "r.urdf", URDF)
    theirs = pinocchio.buildModelFromUrdf(str(path), pinocchio.JointModelFreeFlyer())
    ours = Model.from_file(path, root="free")
    q = ours.default_posture
    w, x, y, z = 0.8, 0.36, 0.48, 0.0
    q[[ours.coordinate_names.index(f"root_{end}") for end in interop.SCALAR_FIRST]] = w, x, y, z
    assert interop.to_pinocchio(ours, q, theirs)[3:7].tolist() == [x, y, z, w]


def test_a_joint_that_one_of_them_lacks_is_named(woman: Model, tmp_path: Path) -> None:
    mujoco: Any = pytest.importorskip("mujoco")
    theirs = mujoco.MjModel.from_xml_path(str(written(tmp_path, "arm.xml", MJCF)))
    with pytest.raises(InputError, match="no coordinates for these joints of the other one: root, shoulder, elbow; or"):
        interop.to_mujoco(woman, woman.default_posture, theirs)
    ours = Model.from_file(written(tmp_path, "less.xml", MJCF.replace("elbow", "knee")))
    assert interop.to_mujoco(ours, {"knee": 0.3}, theirs, partial=True)[-1] == 0.0
    with pytest.raises(InputError, match="these joints of the other one: elbow"):
        interop.from_mujoco(ours, np.zeros(12), theirs)
    with pytest.raises(InputError, match="has 3 numbers; that of the other model has 12"):
        interop.from_mujoco(ours, np.zeros(3), theirs)


def test_coordinates_that_follow_others_have_the_values_that_these_ask_for(tmp_path: Path) -> None:
    mujoco: Any = pytest.importorskip("mujoco")
    follows = '<equality><joint joint1="elbow" joint2="wrist" polycoef="0.1 0.5 0 0 0"/></equality></mujoco>'
    hand = """<body name="hand" pos="0 0 -0.3"><joint name="wrist" axis="0 1 0" range="-1 1"/>
      <inertial mass="0.4" pos="0 0 -0.1" diaginertia="0.01 0.01 0.01"/></body></body></body></body>"""
    text = MJCF.replace("</body></body></body>", hand).replace("</mujoco>", follows)
    path = written(tmp_path, "hand.xml", text)
    ours, theirs = Model.from_file(path), mujoco.MjModel.from_xml_path(str(path))
    qpos = interop.to_mujoco(ours, {"wrist": 0.4}, theirs)
    assert qpos[theirs.joint("elbow").qposadr[0]] == pytest.approx(0.1 + 0.5 * 0.4)
    assert qpos[theirs.joint("wrist").qposadr[0]] == 0.4


def test_a_motion_is_written_and_read(woman: Model, tmp_path: Path, program: str) -> None:
    low, high = woman.ranges.T
    times = np.linspace(0.5, 2, 7)
    q = woman._native.coupled(np.random.default_rng(2).uniform(low, high, (7, len(low))))
    path = tmp_path / "motion.mot"
    interop.write_motion(woman, path, q, times)
    assert "inDegrees=yes" in path.read_text()
    back, table, notes = interop.read_motion(woman, path)
    assert back.tobytes() == times.tobytes() and notes == ()
    np.testing.assert_allclose(table, q, rtol=4.5e-16)
    # The program takes it, too.
    words = [program, "torques", "adult:female,1.65m,60kg", str(path), "--static"]
    assert len(subprocess.run(words, capture_output=True, text=True, check=True).stdout.splitlines()) == 8
    with pytest.raises(InputError, match="time falls at row 1"):
        interop.write_motion(woman, path, q, times[::-1])
    with pytest.raises(InputError, match="6 times and 7 postures"):
        interop.write_motion(woman, path, q, times[:6])
    (tmp_path / "one.csv").write_text("time,elbow_flex_r\n0,90\n")
    _, table, notes = interop.read_motion(woman, tmp_path / "one.csv", degrees=True)
    assert table[0, woman.coordinate_names.index("elbow_flex_r")] == np.radians(90)
    assert f"{len(woman.coordinate_names) - 1} coordinates have no column" in notes[0]
