#!/usr/bin/env python3
"""Writes MuJoCo's lengths, moments, gains and biases of muscles in random postures, for the test `myo_sim`.

    python3 mujoco_muscles.py MYO_SIM POSTURES OUT

MYO_SIM: a checkout of MyoSuite's myo_sim in a folder of that name; OUT: a folder for one `mj_NAME.json` a model. Needs `pip install mujoco`.
"""
import json
import os
import sys

import mujoco as mj
import numpy as np

MODELS = {
    "myolegs": "leg/myolegs.xml",
    "myoarm": "arm/myoarm.xml",
    "myohand": "hand/myohand.xml",
    "myoelbow": "elbow/myoelbow_2dof6muscles.xml",
    "myobody": "body/myobody.xml",
    "myotorso": "torso/myotorso.xml",
    "myoelbow_exo": "elbow/myoelbow_1dof6muscles_1dofexo.xml",
    "myolegs_abdomen": "leg/myolegs_abdomen.xml",
}


def numbers(values):
    return [float(value) for value in values]


def posture(model, data, rng):
    mj.mj_resetData(model, data)
    for joint in range(model.njnt):
        if int(model.jnt_type[joint]) in (int(mj.mjtJoint.mjJNT_HINGE), int(mj.mjtJoint.mjJNT_SLIDE)):
            low, high = model.jnt_range[joint]
            if not model.jnt_limited[joint] or high <= low:
                low, high = -0.5, 0.5
            data.qpos[model.jnt_qposadr[joint]] = rng.uniform(low, high)
    mj.mj_fwdPosition(model, data)


def vectors(name, path, count):
    model = mj.MjModel.from_xml_path(path)
    data, rng = mj.MjData(model), np.random.default_rng(20261122)
    muscles = [i for i in range(model.nu) if int(model.actuator_gaintype[i]) == int(mj.mjtGain.mjGAIN_MUSCLE)]
    postures = []
    for _ in range(count):
        posture(model, data, rng)
        moment = np.zeros((model.nu, model.nv))
        mj.mju_sparse2dense(
            moment, data.actuator_moment.ravel(), data.moment_rownnz, data.moment_rowadr, data.moment_colind.ravel()
        )
        gains, biases = [], []
        for i in muscles:
            length, lengths, acceleration = data.actuator_length[i], model.actuator_lengthrange[i], model.actuator_acc0[i]
            gains.append(mj.mju_muscleGain(length, 0.0, lengths, acceleration, model.actuator_gainprm[i, :9]))
            biases.append(mj.mju_muscleBias(length, lengths, acceleration, model.actuator_biasprm[i, :9]))
        entries = [[i, int(v), float(moment[i, v])] for i in muscles for v in np.nonzero(moment[i])[0]]
        postures.append(
            {
                "qpos": numbers(data.qpos),
                "actuator_length": numbers(data.actuator_length[muscles]),
                "gain_full": numbers(gains),
                "bias_passive": numbers(biases),
                "moment": entries,
            }
        )
    names = [mj.mj_id2name(model, mj.mjtObj.mjOBJ_ACTUATOR, i) for i in range(model.nu)]
    return {"model": name, "mujoco": mj.__version__, "actuators": names, "muscles": muscles, "postures": postures}


def main():
    folder, count, out = sys.argv[1], int(sys.argv[2]), sys.argv[3]
    os.makedirs(out, exist_ok=True)
    for name, file in MODELS.items():
        with open(f"{out}/mj_{name}.json", "w", encoding="utf-8") as text:
            json.dump(vectors(name, f"{folder}/{file}", count), text)


if __name__ == "__main__":
    main()
