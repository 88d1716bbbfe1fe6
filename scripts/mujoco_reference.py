#!/usr/bin/env python3
"""Reference numbers of MJCF models, as MuJoCo resolves them: crates/contrapposto-formats/tests/data/mujoco_reference.json.

    python3 -m venv mjvenv && mjvenv/bin/pip install mujoco==4.0.0 numpy
    mjvenv/bin/python scripts/mujoco_reference.py

The models: our own files in crates/contrapposto-formats/tests/models, and published ones that lie beside the repository
(../shared/models), of which only numbers are kept: dm_control's CMU humanoid (Apache 2.0).
"""

import json
import pathlib

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


def main():
    out = HERE / "crates/contrapposto-formats/tests/data/mujoco_reference.json"
    found = [path for path in MODELS if path.exists()]
    result = {"tool": f"mujoco {mujoco.__version__}", "script": "scripts/mujoco_reference.py"}
    result["models"] = [reference(path) for path in found]
    out.write_text(json.dumps(result, separators=(",", ":")) + "\n")
    print(f"{out}: {[path.name for path in found]}")


if __name__ == "__main__":
    main()
