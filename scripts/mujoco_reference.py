#!/usr/bin/env python3
"""Reference numbers of MJCF models, as MuJoCo resolves them: crates/contrapposto-formats/tests/data/mujoco_reference.json.

    python3 -m venv mjvenv && mjvenv/bin/pip install mujoco==4.0.0 numpy
    mjvenv/bin/python scripts/mujoco_reference.py [FOLDER]

The models: our own files in crates/contrapposto-formats/tests/models, and published ones that lie beside the repository
(../shared/models), of which only numbers are kept: dm_control's CMU humanoid (Apache 2.0).

With FOLDER: of every MJCF model in it that MuJoCo reads, `MODEL.xml.reference.json` beside each, with torques, springs and Jacobians on
20 postures; the test `published_robots` of contrapposto-formats compares us with them where CONTRAPPOSTO_ROBOT_MODELS names
FOLDER. Humanoids: `pip download --no-deps gymnasium==1.4.0 dm_control==1.0.50 brax==0.14.2`, then unzip. Coordinates and rates
are ours in order, external torque is minus `qfrc_bias` at rest, and MuJoCo has no derivative of it to compare with.
"""

import json
import pathlib
import sys

import mujoco
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent.parent
OURS = HERE / "crates/contrapposto-formats/tests/models"
SHARED = HERE.parent / "shared/models"
MODELS = [OURS / f"{n}.xml" for n in ("features", "compiler", "from_geoms")]
MODELS += [SHARED / "cmu" / f"{n}.xml" for n in ("cmu_suite_free_saved", "cmu_v2020_fixed_saved")]
POSES = 3


def flat(array):
    return [float(f"{x:.16g}") for x in np.asarray(array, dtype=float).ravel()]


def inertia(model, body):
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, model.body_iquat[body])
    turn = turn.reshape(3, 3)
    return turn @ np.diag(model.body_inertia[body]) @ turn.T


def reference(path):
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    rng = np.random.default_rng(len(path.name))
    off = model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_GRAVITY
    poses = []
    for _ in range(POSES):
        for joint in range(model.njnt):
            at = model.jnt_qposadr[joint]
            kind = model.jnt_type[joint]
            if kind == mujoco.mjtJoint.mjJNT_FREE:
                data.qpos[at : at + 3] = rng.uniform(-1, 1, 3)
                at += 3
            if kind in (mujoco.mjtJoint.mjJNT_FREE, mujoco.mjtJoint.mjJNT_BALL):
                quat = rng.normal(size=4)
                data.qpos[at : at + 4] = quat / np.linalg.norm(quat)
            else:
                data.qpos[at] = rng.uniform(-1, 1)
        mujoco.mj_forward(model, data)
        poses.append(
            {
                "qpos": flat(data.qpos),
                "positions": flat(data.xpos[1:]),
                "rotations": flat(data.xmat[1:]),
                "sites": flat(data.site_xpos),
                "center_of_mass": flat(data.subtree_com[0]),
                "spring": flat(data.qfrc_spring[model.jnt_dofadr[model.jnt_type >= 2]]),
            }
        )
    bodies = [
        {
            "name": model.body(b).name,
            "parent": int(model.body_parentid[b]),
            "mass": float(model.body_mass[b]),
            "center": flat(model.body_ipos[b]),
            "inertia": flat(inertia(model, b)),
        }
        for b in range(1, model.nbody)
    ]
    joints = [
        {
            "name": model.joint(j).name,
            "type": ["free", "ball", "slide", "hinge"][model.jnt_type[j]],
            "limited": bool(model.jnt_limited[j]),
            "range": flat(model.jnt_range[j]),
            "qpos0": float(model.qpos0[model.jnt_qposadr[j]]),
            "stiffness": flat([model.jnt_stiffness[j], *model.jnt_stiffnesspoly[j]]),
            "rest": float(model.qpos_spring[model.jnt_qposadr[j]]),
        }
        for j in range(model.njnt)
    ]
    return {
        "model": path.name,
        "gravity": [0.0, 0.0, 0.0] if off else flat(model.opt.gravity),
        "limits_disabled": bool(model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_LIMIT),
        "springs_disabled": bool(model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_SPRING),
        "bodies": bodies,
        "joints": joints,
        "sites": [model.site(s).name for s in range(model.nsite)],
        "poses": poses,
    }


def pose(model, data, random):
    """A random posture; followers of equality constraints in their place."""
    mujoco.mj_resetData(model, data)
    for joint in range(model.njnt):
        at, kind = model.jnt_qposadr[joint], model.jnt_type[joint]
        if kind == mujoco.mjtJoint.mjJNT_FREE:
            data.qpos[at : at + 3] = random.uniform(-1, 1, 3)
            at += 3
        if kind in (mujoco.mjtJoint.mjJNT_FREE, mujoco.mjtJoint.mjJNT_BALL):
            turn = random.normal(size=4)
            data.qpos[at : at + 4] = turn / np.linalg.norm(turn)
        else:
            low, high = model.jnt_range[joint] if model.jnt_limited[joint] else (-1, 1)
            data.qpos[at] = random.uniform(low, high)
    for k in range(model.neq):
        if model.eq_type[k] == mujoco.mjtEq.mjEQ_JOINT and model.eq_active0[k]:
            follower = model.jnt_qposadr[model.eq_obj1id[k]]
            offset = 0.0
            if model.eq_obj2id[k] >= 0:
                independent = model.jnt_qposadr[model.eq_obj2id[k]]
                offset = data.qpos[independent] - model.qpos0[independent]
            data.qpos[follower] = model.qpos0[follower] + np.polyval(model.eq_data[k][4::-1], offset)
    mujoco.mj_forward(model, data)


def torques(model):
    """A case for published_robots."""
    data = mujoco.MjData(model)
    random = np.random.default_rng(20)
    coupled = any(model.eq_type[k] == mujoco.mjtEq.mjEQ_JOINT and model.eq_active0[k] for k in range(model.neq))
    named = [b for b in range(1, model.nbody) if model.body(b).name]
    cases = []
    for _ in range(20):
        pose(model, data, random)
        links = {}
        rows, turns = np.zeros((3, model.nv)), np.zeros((3, model.nv))
        for body in [] if coupled else named[:: max(1, len(named) // 4)]:
            mujoco.mj_jacBody(model, data, rows, turns, body)
            links[model.body(body).name] = {
                "position": data.xpos[body].tolist(),
                "rotation": data.xmat[body].tolist(),
                "jacobian": [*rows.tolist(), *turns.tolist()],
            }
        mujoco.mj_jacSubtreeCom(model, data, rows, 0)
        cases.append(
            {
                "values": data.qpos.tolist(),
                "raw": (-data.qfrc_bias).tolist(),
                "torque": None if coupled else (-data.qfrc_bias).tolist(),
                "gradient": None,
                "passive": data.qfrc_spring.tolist(),
                "center": data.subtree_com[0].tolist(),
                "center_jacobian": None if coupled else rows.tolist(),
                "links": links,
            }
        )
    return {"root": "file", "rates": None, "cases": cases}


def published(folder):
    for path in sorted(folder.rglob("*.xml")):
        if "<mujoco" not in path.read_text(errors="replace"):
            continue
        try:
            model = mujoco.MjModel.from_xml_path(str(path))
        except (ValueError, RuntimeError) as refusal:
            print(f"{path}: {str(refusal).splitlines()[0]}")
            continue
        written = {"made_by": "scripts/mujoco_reference.py", "tool": f"mujoco {mujoco.__version__}", "model": path.name, "roots": [torques(model)]}
        path.with_name(path.name + ".reference.json").write_text(json.dumps(written))
        print(f"{path}: {model.nv} rates")


def main():
    if len(sys.argv) > 1:
        published(pathlib.Path(sys.argv[1]))
        return
    out = HERE / "crates/contrapposto-formats/tests/data/mujoco_reference.json"
    found = [path for path in MODELS if path.exists()]
    result = {"tool": f"mujoco {mujoco.__version__}", "script": "scripts/mujoco_reference.py"}
    result["models"] = [reference(path) for path in found]
    out.write_text(json.dumps(result, separators=(",", ":")) + "\n")
    print(f"{out}: {[path.name for path in found]}")


if __name__ == "__main__":
    main()
