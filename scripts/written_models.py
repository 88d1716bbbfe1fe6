#!/usr/bin/env python3
"""Small models that our writers wrote, with numbers of Pinocchio, MuJoCo and OpenSim: crates/contrapposto-formats/tests/written.

    python3 -m venv venv && venv/bin/pip install pin==4.1.0 mujoco==4.0.0 opensim==4.6 numpy
    venv/bin/python scripts/written_models.py

The test `exchange` of contrapposto-formats writes the files; the adult's right arm and a made-up chain with every joint of hinges
and slides are kept. The keys of the vectors are those of the files in ../shared/vectors, so that one test reads both.
Deterministic: fixed seed. Run it again when a writer or the adult changes.
"""

import json
import math
import os
import pathlib
import shutil
import subprocess
import tempfile

import mujoco
import numpy
import opensim
import pinocchio

HERE = pathlib.Path(__file__).resolve().parent.parent
KEPT = HERE / "crates/contrapposto-formats/tests/written"
# Number of the model in the folder of `exchange`, its name here, its last segment and one in the middle.
MODELS = [(2, "right_arm", "hand_r", "humerus_r"), (3, "hinges_and_slides", "h", "e")]
POSTURES = 2
WORLD = pinocchio.ReferenceFrame.LOCAL_WORLD_ALIGNED
opensim.Logger.setLevelString("off")
opensim.Logger.removeFileSink()


def lists(values):
    return numpy.asarray(values, dtype=float).tolist()


def by_pinocchio(path, right, left, free):
    model = pinocchio.buildModelFromUrdf(str(path), *([pinocchio.JointModelFreeFlyer()] if free else []))
    data = model.createData()
    random = numpy.random.RandomState(48)
    frames = {side: model.getFrameId(name, pinocchio.FrameType.BODY) for side, name in [("right", right), ("left", left)]}

    def gravity(q):
        return pinocchio.computeGeneralizedGravity(model, data, q).copy()

    def jacobian(q, side):
        return pinocchio.computeFrameJacobian(model, data, q, frames[side], WORLD).copy()

    def static(q, wrench):
        return gravity(q) - jacobian(q, "right").T @ wrench

    def case():
        q = pinocchio.neutral(model)
        if free:
            q[:3] = random.uniform(-1, 1, 3)
            turn = random.normal(size=4)
            q[3:7] = turn / numpy.linalg.norm(turn)
        first = 7 if free else 0
        q[first:] = random.uniform(model.lowerPositionLimit[first:], model.upperPositionLimit[first:])
        force, couple = random.uniform(-50, 50, 3), random.uniform(-5, 5, 3)
        wrench = numpy.concatenate([force, couple])
        slope = pinocchio.computeGeneralizedGravityDerivatives(model, data, q).copy()
        rows = jacobian(q, "right")
        # The wrench at the frame's origin, in the axes of its joint: constant there when it turns with the segment.
        frame = model.frames[frames["right"]]
        pinocchio.framesForwardKinematics(model, data, q)
        turned = data.oMf[frames["right"]].rotation.T
        local = frame.placement.act(pinocchio.Force(turned @ force, turned @ couple))
        forces = pinocchio.StdVec_Force()
        for joint in range(model.njoints):
            forces.append(local if joint == frame.parentJoint else pinocchio.Force.Zero())
        in_body = pinocchio.computeStaticTorqueDerivatives(model, data, q, forces).copy()
        turning = numpy.vstack([numpy.cross(rows[3:].T, force).T, numpy.cross(rows[3:].T, couple).T])
        in_world = in_body + rows.T @ turning
        check_derivative(q, slope, gravity)
        check_derivative(q, in_world, lambda q: static(q, wrench))
        found = {
            "q": lists(q),
            "g": lists(gravity(q)),
            "dg_dq": lists(slope),
            "com": lists(pinocchio.centerOfMass(model, data, q)),
            "J_com": lists(pinocchio.jacobianCenterOfMass(model, data, q)),
            "f_world": lists(force),
            "m_world": lists(couple),
            "tau_static": lists(static(q, wrench)),
            "dtau_static_dq_wrench_const_in_body": lists(in_body),
            "dtau_static_dq_wrench_const_in_world": lists(in_world),
        }
        for side in frames:
            found[f"J_{side}_hand"] = lists(jacobian(q, side))
            pinocchio.framesForwardKinematics(model, data, q)
            found[f"{side}_hand_pos"] = lists(data.oMf[frames[side]].translation)
        return found

    def check_derivative(q, slope, function):
        for k in range(model.nv):
            step = numpy.zeros(model.nv)
            step[k] = 1e-6
            ahead, behind = (function(pinocchio.integrate(model, q, sign * step)) for sign in (1, -1))
            worst = numpy.abs((ahead - behind) / 2e-6 - slope[:, k]).max()
            assert worst < 1e-5, (path.name, k, worst)

    return {
        "root": "free" if free else "fixed",
        "nv": model.nv,
        "root_link_mass_at_universe": model.inertias[0].mass,
        "center_of_mass_at_universe": lists(model.inertias[0].lever),
        "joint_names": list(model.names),
        "force_frame": right,
        "right_hand_frame": right,
        "left_hand_frame": left,
        "cases": [case() for _ in range(POSTURES)],
    }


def by_mujoco(path, right, left):
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    random = numpy.random.RandomState(2001)

    def case():
        data.qpos[:] = random.uniform(model.jnt_range[:, 0], model.jnt_range[:, 1])
        data.qvel[:] = 0
        mujoco.mj_forward(model, data)
        found = {
            "qpos": lists(data.qpos),
            "qfrc_bias": lists(data.qfrc_bias),
            "qfrc_passive": lists(data.qfrc_passive),
            "com": lists(data.subtree_com[0]),
        }
        rows, turns = numpy.zeros((3, model.nv)), numpy.zeros((3, model.nv))
        mujoco.mj_jacSubtreeCom(model, data, rows, 0)
        found["J_com"] = lists(rows)
        for side, name in [("right", right), ("left", left)]:
            mujoco.mj_jacBody(model, data, rows, turns, model.body(name).id)
            found[f"J_{side}_hand_pos"], found[f"J_{side}_hand_rot"] = lists(rows), lists(turns)
        return found

    kinds = ["free", "ball", "slide", "hinge"]
    joints = [{"name": model.joint(j).name, "type": kinds[model.jnt_type[j]]} for j in range(model.njnt)]
    return {"right_hand_body": right, "left_hand_body": left, "joints": joints, "cases": [case() for _ in range(POSTURES)]}


def by_opensim(path):
    model = opensim.Model(str(path))
    model.updForceSet().clearAndDestroy()
    model.initSystem()
    tree = model.getCoordinateNamesInMultibodyTreeOrder()
    names = [tree.getElt(i) for i in range(tree.size())]
    every = {name: model.getCoordinateSet().get(name) for name in names}
    margin, transition = math.radians(15), 10.0
    limited = {}
    for name, coordinate in every.items():
        if coordinate.getMotionType() == 1:
            high, low = (math.degrees(end) for end in (coordinate.getRangeMax() - margin, coordinate.getRangeMin() + margin))
            limited[name] = opensim.CoordinateLimitForce(name, high, 2.0, low, 2.0, 0.0, transition)
            model.addForce(limited[name])
    state = model.initSystem()
    for force in limited.values():
        force.setAppliesForce(state, False)
    solver = opensim.InverseDynamicsSolver(model)
    still = opensim.Vector(state.getNU(), 0.0)
    random = numpy.random.RandomState(3002)

    def place(q):
        for name, value in zip(names, q):
            every[name].setLocked(state, False)
            every[name].setValue(state, float(value), False)
        state.setU(still)
        model.realizeDynamics(state)

    def center(q):
        place(q)
        point = model.calcMassCenterPosition(state)
        return numpy.array([point.get(i) for i in range(3)])

    def case():
        q = numpy.array([random.uniform(c.getRangeMin(), c.getRangeMax()) for c in every.values()])
        steps = 1e-6 * numpy.eye(len(q))
        moved = [(center(q + step) - center(q - step)) / 2e-6 for step in steps]
        com = center(q)
        held = solver.solve(state, still)
        return {
            "q": dict(zip(names, lists(q))),
            "tau_id": {name: held.get(i) for i, name in enumerate(names)},
            "limit_torque": {name: force.calcLimitForce(state) for name, force in limited.items()},
            "com": lists(com),
            "J_com_central_difference": lists(numpy.array(moved).T),
        }

    return {
        "coordinates": names,
        "range": {name: [c.getRangeMin(), c.getRangeMax()] for name, c in every.items()},
        "coordinate_limit_force": {"parameters": {"upper_stiffness_Nm_per_deg": 2.0, "lower_stiffness_Nm_per_deg": 2.0}},
        "cases": [case() for _ in range(POSTURES)],
    }


def keep(name, tool, found):
    text = json.dumps({"made_by": "scripts/written_models.py", "tool": tool, **found})
    (KEPT / f"{name}.json").write_text(text.replace("], [", "],\n[").replace("}, ", "},\n") + "\n")


def main():
    KEPT.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        command = ["cargo", "test", "-q", "-p", "contrapposto-formats", "--test", "all", "write::peers::exchange", "--", "--ignored", "--exact"]
        subprocess.run(command, cwd=HERE, check=True, env={**os.environ, "CONTRAPPOSTO_EXCHANGE": folder})
        for number, name, *_ in MODELS:
            for ending in ("osim", "urdf", "xml"):
                shutil.copy(pathlib.Path(folder) / f"model_{number}.{ending}", KEPT / f"{name}.{ending}")
    for _, name, right, left in MODELS:
        for free in (False, True):
            found = by_pinocchio(KEPT / f"{name}.urdf", right, left, free)
            keep(f"{name}_pinocchio_{found['root']}", f"pinocchio {pinocchio.__version__}", found)
        keep(f"{name}_mujoco", f"mujoco {mujoco.__version__}", by_mujoco(KEPT / f"{name}.xml", right, left))
        keep(f"{name}_opensim", f"opensim {opensim.GetVersion()}", by_opensim(KEPT / f"{name}.osim"))


if __name__ == "__main__":
    main()
