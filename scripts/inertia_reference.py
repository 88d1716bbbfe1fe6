#!/usr/bin/env python3
"""Torques of moving bodies by Pinocchio, MuJoCo and OpenSim: crates/contrapposto-formats/tests/data/inertia_reference.json.

    python3 -m venv venv && venv/bin/pip install pin==4.1.0 mujoco==4.0.0 opensim==4.6 numpy
    venv/bin/python scripts/inertia_reference.py

Small models that our writers wrote (tests/written) and, if they lie beside the repository, published ones (../shared/models; only
numbers are kept). Every case has the values, speeds and accelerations of all coordinates by name, and the torques that inertia and
weight give, which are minus those of inverse dynamics. Deterministic: fixed seeds.

A free root has our rates: three speeds along ground axes (`root_tx`) and three about the body's own (`root_mx`). MuJoCo's are the
same; Pinocchio has all six in the body's axes, where the derivative of the velocity `v = R^T x'` is `R^T x'' - w x v`.
MuJoCo's armature, which is no mass of the body, is set to zero. OpenSim's rows are those of its solver, without any force.
"""

import json
import pathlib

import mujoco
import numpy
import opensim
import pinocchio

HERE = pathlib.Path(__file__).resolve().parent.parent
TESTS = HERE / "crates/contrapposto-formats/tests"
SHARED = HERE.parent / "shared"
CASES = 3
ROOT = ["root_tx", "root_ty", "root_tz"]
TURN = ["root_mx", "root_my", "root_mz"]
opensim.Logger.setLevelString("off")
opensim.Logger.removeFileSink()


def row(values):
    return [float(value) for value in values]


def unit_quaternion(random):
    turn = random.normal(size=4)
    return turn / numpy.linalg.norm(turn)


def free_root(q):
    """Our coordinates of a free root at x, y, z, qw, qx, qy, qz."""
    return dict(zip([*ROOT, "root_qw", "root_qx", "root_qy", "root_qz"], row(q)))


def by_pinocchio(path, free):
    model = pinocchio.buildModelFromUrdf(str(path), *([pinocchio.JointModelFreeFlyer()] if free else []))
    data, random = model.createData(), numpy.random.RandomState(5)
    names = [model.names[j] for j in range(2 if free else 1, model.njoints)]
    first, joints = (7, 6) if free else (0, 0), model.nv
    cases = []
    for _ in range(CASES):
        q = pinocchio.neutral(model)
        q[first[0] :] = random.uniform(-1, 1, model.nq - first[0])
        speed, acceleration = random.uniform(-3, 3, joints), random.uniform(-20, 20, joints)
        given = speed.copy(), acceleration.copy()
        values = {}
        rotation = numpy.eye(3)
        if free:
            q[:3] = random.uniform(-1, 1, 3)
            w, x, y, z = unit_quaternion(random)
            q[3:7] = x, y, z, w
            values = free_root([*q[:3], w, x, y, z])
            rotation = pinocchio.Quaternion(w, x, y, z).toRotationMatrix()
            given[0][:3] = rotation.T @ speed[:3]
            given[1][:3] = rotation.T @ acceleration[:3] - numpy.cross(speed[3:6], given[0][:3])
        torque = -pinocchio.rnea(model, data, q, *given)
        if free:
            torque[:3] = rotation @ torque[:3]
        values.update(zip(names, row(q[first[0] :])))
        rates = ([*ROOT, *TURN] if free else []) + names
        cases.append({"q": values, **{k: dict(zip(rates, row(v))) for k, v in [("speed", speed), ("acceleration", acceleration), ("torque", torque)]}})
    return cases


def by_mujoco(path):
    model = mujoco.MjModel.from_xml_path(str(path))
    model.dof_armature[:] = 0
    data, random = mujoco.MjData(model), numpy.random.RandomState(6)
    free = model.jnt_type[0] == mujoco.mjtJoint.mjJNT_FREE
    names = [model.joint(j).name for j in range(1 if free else 0, model.njnt)]
    cases = []
    for _ in range(CASES):
        data.qpos[:] = random.uniform(-1, 1, model.nq)
        values = {}
        if free:
            data.qpos[3:7] = unit_quaternion(random)
            values = free_root(data.qpos[:7])
        data.qvel[:], data.qacc[:] = random.uniform(-3, 3, model.nv), random.uniform(-20, 20, model.nv)
        acceleration = data.qacc.copy()
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        data.qacc[:] = acceleration
        torque = numpy.zeros(model.nv)
        mujoco.mj_rne(model, data, 1, torque)
        values.update(zip(names, row(data.qpos[7 if free else 0 :])))
        rates = ([*ROOT, *TURN] if free else []) + names
        parts = [("speed", data.qvel), ("acceleration", acceleration), ("torque", -torque)]
        cases.append({"q": values, **{k: dict(zip(rates, row(v))) for k, v in parts}})
    return cases


def by_opensim(path):
    model = opensim.Model(str(path))
    model.updForceSet().clearAndDestroy()
    model.updConstraintSet().clearAndDestroy()
    state = model.initSystem()
    coordinates = [model.getCoordinateSet().get(i) for i in range(model.getCoordinateSet().getSize())]
    rows = {}
    for c in coordinates:
        c.setLocked(state, False)
        c.setSpeedValue(state, 1.0)
        rows[c.getName()] = max(range(state.getNU()), key=lambda i: abs(state.getU().get(i)))
        c.setSpeedValue(state, 0.0)
    solver, random, cases = opensim.InverseDynamicsSolver(model), numpy.random.RandomState(7), []
    for _ in range(CASES):
        case = {"q": {}, "speed": {}, "acceleration": {}}
        udot = opensim.Vector(state.getNU(), 0.0)
        for c in coordinates:
            name, low, high = c.getName(), max(c.getRangeMin(), -1.0), min(c.getRangeMax(), 1.0)
            case["q"][name] = float(random.uniform(low, high))
            case["speed"][name], case["acceleration"][name] = float(random.uniform(-3, 3)), float(random.uniform(-20, 20))
            c.setValue(state, case["q"][name], False)
            c.setSpeedValue(state, case["speed"][name])
            udot[rows[name]] = case["acceleration"][name]
        model.realizeVelocity(state)
        torques = solver.solve(state, udot)
        case["torque"] = {name: -torques.get(i) for name, i in rows.items()}
        cases.append(case)
    return cases


def main():
    written, models = TESTS / "written", []

    def add(folder, file, tool, cases, free=False):
        where = "written" if folder == written else "shared"
        models.append({"where": where, "file": str(file), "tool": tool, "free": bool(free), "cases": cases})

    pin, mj, osim = f"pinocchio {pinocchio.__version__}", f"mujoco {mujoco.__version__}", f"opensim {opensim.GetVersion()}"
    for name in ["right_arm", "hinges_and_slides"]:
        for free in [False, True]:
            add(written, f"{name}.urdf", pin, by_pinocchio(written / f"{name}.urdf", free), free)
        add(written, f"{name}.xml", mj, by_mujoco(written / f"{name}.xml"))
        add(written, f"{name}.osim", osim, by_opensim(written / f"{name}.osim"))
    if SHARED.exists():
        for name in ["48", "66"]:
            path = f"models/human-gazebo/humanSubject01_{name}dof.urdf"
            add(SHARED, path, pin, by_pinocchio(SHARED / path, True), True)
            path = f"models/human-gazebo/human{name}_free.mjcf.xml"
            add(SHARED, path, mj, by_mujoco(SHARED / path))
        for path in ["models/cmu/cmu_suite_free_saved.xml", "models/cmu/cmu_v2020_fixed_saved.xml"]:
            add(SHARED, path, mj, by_mujoco(SHARED / path))
        path = "models/opensim/gait2392_thelen2003muscle.osim"
        add(SHARED, path, osim, by_opensim(SHARED / path))
    text = json.dumps({"models": models}).replace('{"q"', '\n{"q"')
    (TESTS / "data/inertia_reference.json").write_text(text + "\n")


if __name__ == "__main__":
    main()
