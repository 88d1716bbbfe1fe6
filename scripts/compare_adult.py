#!/usr/bin/env python3
"""Compares the external torque of the exported adult with that of Pinocchio, MuJoCo and OpenSim.

    python3 -m venv peervenv && peervenv/bin/pip install opensim==4.6 pin mujoco==4.0.0 numpy
    peervenv/bin/python scripts/compare_adult.py [FOLDER]

FOLDER holds model_N.osim, model_N.urdf, model_N.xml and answers.json (100 random postures, seed fixed, with our torques). Without
FOLDER the test `exchange` of contrapposto-formats writes them first. The result, with the versions and the torques of ten
postures, becomes crates/contrapposto-formats/tests/data/adult_peers.json, which the test
`other_programs_agree` holds our torques to. Run it again whenever the built-in adult
changes. A made-up model with every joint of hinges and slides is compared as well.

Coordinate map: every joint of the URDF and MJCF files and every OpenSim coordinate has the name of our coordinate, and its value
is the same number. The URDF's ground is turned by a right angle about x (our y is its z). Our external torque is minus the
generalised gravity of Pinocchio (computeGeneralizedGravity), minus MuJoCo's qfrc_bias at rest, and minus OpenSim's inverse
dynamics at rest without forces; the passive torque is the difference that OpenSim's coordinate forces make.
"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile

import mujoco
import numpy
import opensim
import pinocchio

HERE = pathlib.Path(__file__).resolve().parent.parent
KEPT = HERE / "crates/contrapposto-formats/tests/data/adult_peers.json"
POSTURES_KEPT = 10
LIMITS = {"pinocchio": 1e-9, "mujoco": 1e-9, "opensim": 1e-6}
opensim.Logger.setLevelString("off")
opensim.Logger.removeFileSink()


def exchange(folder):
    command = ["cargo", "test", "-q", "-p", "contrapposto-formats", "--test", "all", "write::peers::exchange", "--", "--ignored", "--exact"]
    subprocess.run(command, cwd=HERE, check=True, env={**os.environ, "CONTRAPPOSTO_EXCHANGE": str(folder)})


def by_pinocchio(path, names, postures):
    model = pinocchio.buildModelFromUrdf(str(path))
    data = model.createData()
    joints = [model.joints[model.getJointId(name)] for name in names]
    assert model.nq == model.nv == len(names), "a joint too many or too few"
    external = []
    for posture in postures:
        q = numpy.zeros(model.nq)
        for joint, value in zip(joints, posture):
            q[joint.idx_q] = value
        gravity = pinocchio.computeGeneralizedGravity(model, data, q)
        external.append([-float(gravity[joint.idx_v]) for joint in joints])
    return external


def by_mujoco(path, names, postures):
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    joints = [mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name) for name in names]
    assert min(joints) >= 0 and model.nq == model.nv == len(names), "a joint too many or too few"
    external = []
    for posture in postures:
        for joint, value in zip(joints, posture):
            data.qpos[model.jnt_qposadr[joint]] = value
        data.qvel[:] = 0
        mujoco.mj_forward(model, data)
        external.append([-float(data.qfrc_bias[model.jnt_dofadr[joint]]) for joint in joints])
    return external


def inverse_dynamics(path, names, postures, forces):
    """Generalised forces that hold the body still, in the order of `names`."""
    model = opensim.Model(str(path))
    for force in model.updForceSet():
        force.set_appliesForce(forces)
    state = model.initSystem()
    coordinates = model.getCoordinateSet()
    tree = model.getCoordinateNamesInMultibodyTreeOrder()
    order = [tree.getElt(i) for i in range(tree.size())]
    assert sorted(order) == sorted(names), "a coordinate too many or too few"
    solver = opensim.InverseDynamicsSolver(model)
    still = opensim.Vector(state.getNU(), 0.0)
    rows = []
    for posture in postures:
        for name, value in zip(names, posture):
            coordinates.get(name).setLocked(state, False)
            coordinates.get(name).setValue(state, value, False)
        state.setU(still)
        model.realizeDynamics(state)
        held = solver.solve(state, still)
        by_name = {name: held.get(i) for i, name in enumerate(order)}
        rows.append([by_name[name] for name in names])
    return numpy.array(rows)


def worst(ours, theirs):
    return float(numpy.abs(numpy.asarray(ours) - numpy.asarray(theirs)).max())


def main():
    with tempfile.TemporaryDirectory() as made:
        folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else made)
        if len(sys.argv) < 2:
            exchange(folder)
        answers = json.loads((folder / "answers.json").read_text())
        models = [compare(folder, i, model) for i, model in enumerate(answers["models"])]
    versions = {
        "pinocchio": pinocchio.__version__,
        "mujoco": mujoco.__version__,
        "opensim": opensim.GetVersion(),
        "numpy": numpy.__version__,
        "python": ".".join(map(str, sys.version_info[:3])),
    }
    text = json.dumps({"made_by": "scripts/compare_adult.py", "versions": versions, "seed": answers["seed"], "models": models})
    KEPT.write_text(text.replace("], [", "],\n[").replace("}, ", "},\n") + "\n")
    for model in models:
        for tool, limit in LIMITS.items():
            assert model["tools"][tool]["worst_external"] < limit, (model["name"], tool)
        assert model["tools"]["opensim"]["worst_passive"] < 1e-6, model["name"]


def compare(folder, i, model):
    names = model["coordinates"]
    postures = [case["posture"] for case in model["cases"]]
    ours = [case["external"] for case in model["cases"]]
    still = inverse_dynamics(folder / f"model_{i}.osim", names, postures, False)
    sprung = inverse_dynamics(folder / f"model_{i}.osim", names, postures, True)
    found = {
        "pinocchio": by_pinocchio(folder / f"model_{i}.urdf", names, postures),
        "mujoco": by_mujoco(folder / f"model_{i}.xml", names, postures),
        "opensim": (-still).tolist(),
    }
    tools = {}
    for tool, external in found.items():
        tools[tool] = {"worst_external": worst(ours, external), "external": external[:POSTURES_KEPT]}
    held = [k for k, name in enumerate(names) if name in model["passive_curves"]]
    passive = (still - sprung)[:, held]
    expected = numpy.array([case["passive"] for case in model["cases"]])[:, held]
    # Outside their ranges' middle curves reach thousands of N m: relative to their size.
    size = numpy.maximum(1.0, numpy.abs(expected))
    tools["opensim"]["worst_passive"] = float((numpy.abs(passive - expected) / size).max(initial=0.0))
    for tool, rows in tools.items():
        print(model["name"], tool, {key: value for key, value in rows.items() if key.startswith("worst")})
    size = numpy.abs(ours).max()
    return {
        **{key: model[key] for key in ("name", "coordinates", "passive_curves")},
        "compared_postures": len(postures),
        "greatest_external": float(size),
        "postures": postures[:POSTURES_KEPT],
        "tools": tools,
    }


if __name__ == "__main__":
    main()
