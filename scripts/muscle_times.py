#!/usr/bin/env python3
"""Times of muscles a posture, by OpenSim 4.6, MuJoCo and contrapposto in one run on one core: medians over random postures.

    python3 -m venv venv && venv/bin/pip install opensim==4.6 mujoco numpy
    cargo build --release -p contrapposto-formats --example muscle_times
    venv/bin/python scripts/muscle_times.py RAJAGOPAL2016.osim MYOLEGS.xml [EXAMPLE]

RAJAGOPAL2016.osim: Rajagopal2016 of opensim-models; MYOLEGS.xml: leg/myolegs.xml of MyoSuite's myo_sim; neither is a part of this project. The programs
take turns, ROUNDS times; a quantity counts with the least of its medians. OpenSim: all lengths after `realizePosition`; `computeMomentArm` of every
muscle about every coordinate that its group of joints can move (all pairs of the file's muscles and free coordinates whose arm is not zero in the first
posture); `computeEquilibrium` of all muscles; one frame of the StaticOptimization analysis. MuJoCo: `mj_kinematics`, `mj_comPos`, `mj_tendon`
and `mj_transmission`, which fill lengths and moments of all actuators, and these inside of `mj_fwdPosition`.
"""

import os
import statistics
import subprocess
import sys
import tempfile
import time

import mujoco
import numpy
import opensim

ROUNDS = 3
POSTURES = {"opensim": 10, "mujoco": 200, "ours": 200}
# ms; of static optimisation, lengths with all moment arms, equilibria, of Rajagopal2016.
LIMITS = {"paths": 0.3, "equilibria": 0.3, "static": 5.0}


class OpenSim:
    """Rajagopal2016 with its muscles."""

    def __init__(self, path):
        opensim.Logger.setLevelString("error")
        opensim.Logger.removeFileSink()
        self.model = opensim.Model(path)
        self.state = self.model.initSystem()
        self.muscles = [self.model.getMuscles().get(i) for i in range(self.model.getMuscles().getSize())]
        coordinates = [self.model.getCoordinateSet().get(i) for i in range(self.model.getCoordinateSet().getSize())]
        self.free = [c for c in coordinates if not c.isDependent(self.state) and not c.getLocked(self.state)]
        self.rng = numpy.random.default_rng(19)
        self.pose()
        self.pairs = [(m, c) for m in self.muscles for c in self.free if abs(m.computeMomentArm(self.state, c)) > 1e-9]

    def pose(self):
        for c in self.free:
            low, high = max(c.getRangeMin(), c.getDefaultValue() - 1), min(c.getRangeMax(), c.getDefaultValue() + 1)
            if low < high:
                c.setValue(self.state, float(self.rng.uniform(low, high)), False)
        self.model.assemble(self.state)

    def times(self):
        spent = {"paths": [], "equilibria": []}
        for _ in range(POSTURES["opensim"]):
            self.pose()
            begin = time.perf_counter()
            self.model.realizePosition(self.state)
            for muscle in self.muscles:
                muscle.getLength(self.state)
            for muscle, coordinate in self.pairs:
                muscle.computeMomentArm(self.state, coordinate)
            spent["paths"].append(time.perf_counter() - begin)
            for muscle in self.muscles:
                muscle.setActivation(self.state, 0.5)
            self.model.realizeVelocity(self.state)
            begin = time.perf_counter()
            self.model.equilibrateMuscles(self.state)
            spent["equilibria"].append(time.perf_counter() - begin)
        return {kind: 1e3 * statistics.median(seconds) for kind, seconds in spent.items() if seconds}


def static_time(path):
    """One frame of OpenSim's StaticOptimization tool, ms: the difference of a motion of 12 frames and one of 2, by ten."""
    def run(frames):
        with tempfile.TemporaryDirectory() as folder:
            model = opensim.Model(path)
            forces = f"{folder}/reserves.xml"
            actuators = opensim.ForceSet()
            for i in range(model.getCoordinateSet().getSize()):
                coordinate = model.getCoordinateSet().get(i)
                actuator = opensim.CoordinateActuator(coordinate.getName())
                actuator.setName("reserve_" + coordinate.getName())
                actuator.setOptimalForce(10000.0 if coordinate.getName().startswith("pelvis") else 1.0)
                actuator.setMinControl(-1000.0)
                actuator.setMaxControl(1000.0)
                actuators.cloneAndAppend(actuator)
            actuators.printToXML(forces)
            names = [model.getCoordinateSet().get(i).getName() for i in range(model.getCoordinateSet().getSize())]
            values = [model.getCoordinateSet().get(i).getDefaultValue() for i in range(len(names))]
            with open(f"{folder}/q.mot", "w", encoding="utf-8") as motion:
                motion.write(f"q\nversion=1\nnRows={frames + 20}\nnColumns={len(names) + 1}\ninDegrees=no\nendheader\n")
                motion.write("\t".join(["time", *names]) + "\n")
                for frame in range(-10, frames + 10):
                    motion.write("\t".join(map(repr, [0.01 * frame, *values])) + "\n")
            tool = opensim.AnalyzeTool()
            tool.setName("t")
            tool.setModelFilename(path)
            tool.setCoordinatesFileName(f"{folder}/q.mot")
            tool.setInitialTime(0.0)
            tool.setFinalTime(0.01 * (frames - 1))
            tool.setResultsDir(folder)
            tool.setForceSetFiles(array([forces]))
            tool.setReplaceForceSet(False)
            tool.setLowpassCutoffFrequency(-1)
            analysis = opensim.StaticOptimization()
            analysis.setStartTime(0.0)
            analysis.setEndTime(0.01 * (frames - 1))
            tool.updAnalysisSet().cloneAndAppend(analysis)
            setup = f"{folder}/setup.xml"
            tool.printToXML(setup)
            tool = opensim.AnalyzeTool(setup)
            begin = time.perf_counter()
            tool.run()
            return time.perf_counter() - begin
    return 1e3 * (run(14) - run(4)) / 10


def array(texts):
    found = opensim.ArrayStr()
    for text in texts:
        found.append(text)
    return found


class MuJoCo:
    """Myolegs."""

    def __init__(self, path):
        self.model = mujoco.MjModel.from_xml_path(path)
        self.data = mujoco.MjData(self.model)

    def times(self):
        rng, parts, whole = numpy.random.default_rng(19), [], []
        model, data = self.model, self.data
        for _ in range(POSTURES["mujoco"]):
            mujoco.mj_resetData(model, data)
            for joint in range(model.njnt):
                if int(model.jnt_type[joint]) >= 2:
                    low, high = model.jnt_range[joint] if model.jnt_limited[joint] else (-0.5, 0.5)
                    data.qpos[model.jnt_qposadr[joint]] = rng.uniform(max(low, -1), min(high, 1)) if max(low, -1) < min(high, 1) else 0
            mujoco.mj_fwdPosition(model, data)
            # The functions are looked up beforehand: a call from Python then costs a part of a microsecond.
            one, two, three, four, all_ = mujoco.mj_kinematics, mujoco.mj_comPos, mujoco.mj_tendon, mujoco.mj_transmission, mujoco.mj_fwdPosition
            begin = time.perf_counter()
            one(model, data)
            two(model, data)
            three(model, data)
            four(model, data)
            middle = time.perf_counter()
            all_(model, data)
            whole.append(time.perf_counter() - middle)
            parts.append(middle - begin)
        return {"paths": 1e3 * statistics.median(parts), "fwdPosition": 1e3 * statistics.median(whole)}


def our_times(example, path):
    text = subprocess.run([example, path, str(POSTURES["ours"])], check=True, capture_output=True, text=True).stdout
    spent = {}
    for kind, number in map(str.split, text.splitlines()):
        spent.setdefault(kind, []).append(float(number))
    return {kind: 1e-3 * statistics.median(times) for kind, times in spent.items()}


def least(rounds):
    return {kind: min(times[kind] for times in rounds) for kind in rounds[0]}


def main():
    rajagopal, myolegs = sys.argv[1:3]
    root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    example = sys.argv[3] if len(sys.argv) > 3 else f"{root}/target/release/examples/muscle_times"
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})  # all on the same core
    opensim_, mujoco_ = OpenSim(rajagopal), MuJoCo(myolegs)
    rounds = {"OpenSim": [], "MuJoCo": [], "Rajagopal2016": [], "myolegs": []}
    for _ in range(ROUNDS):
        rounds["OpenSim"].append(opensim_.times())
        rounds["Rajagopal2016"].append(our_times(example, rajagopal))
        rounds["MuJoCo"].append(mujoco_.times())
        rounds["myolegs"].append(our_times(example, myolegs))
    theirs, ours = least(rounds["OpenSim"]), least(rounds["Rajagopal2016"])
    print(f"Rajagopal2016, {len(opensim_.pairs)} moment arms of OpenSim, ms a posture, medians", flush=True)
    theirs["static"] = static_time(rajagopal)
    for kind, limit in LIMITS.items():
        print(f"{kind}: OpenSim {theirs[kind]:.3f}, contrapposto {ours[kind]:.4f}, {theirs[kind] / ours[kind]:.0f} times faster; limit {limit}", flush=True)
    print(f"reactions: contrapposto {ours['reactions']:.4f}")
    them, us = least(rounds["MuJoCo"]), least(rounds["myolegs"])
    print(f"myolegs, kinematics, lengths and moments: MuJoCo {mujoco.__version__} {them['paths']:.4f} (mj_fwdPosition {them['fwdPosition']:.4f}), contrapposto {us['paths']:.4f}")
    slow = [kind for kind, limit in LIMITS.items() if ours[kind] > limit] + ["myolegs"] * (us["paths"] > them["paths"])
    sys.exit(f"too slow: {', '.join(slow)}" if slow else 0)


if __name__ == "__main__":
    main()
