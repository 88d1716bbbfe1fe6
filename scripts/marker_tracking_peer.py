#!/usr/bin/env python3
"""Inverse kinematics of published OpenSim pipelines by OpenSim 4.6 and by contrapposto, on the same files: objectives, angles and times.

    python3 -m venv venv && venv/bin/pip install opensim==4.6 numpy
    cargo build --release
    venv/bin/python scripts/marker_tracking_peer.py FOLDER [PROGRAM]

FOLDER is the folder `Pipelines` of opensim-core's `opensim-models` repository, which is not a part of this project. OpenSim runs twice, with
the accuracy of the setup file and with that of TIGHT; objectives of all answers are computed here from the places of OpenSim's markers. Times are
those of the tool alone (without reading the model) and of our whole program (with its start and all files); `opensim_times.py` times both solvers. Of Rajagopal2016 the repository has no
scaled model: `contrapposto scale` makes it, from `Models` beside FOLDER, and both programs read it.
"""

import pathlib
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree

import numpy
import opensim

REPOSITORY = pathlib.Path(__file__).resolve().parent.parent
PIPELINES = {  # name: model, setup, markers
    "gait2392": ("Gait2392_Simbody/OutputReference/subject01_simbody.osim", "Gait2392_Simbody/subject01_Setup_IK.xml", "Gait2392_Simbody/subject01_walk1.trc"),
    "gait10dof18musc": ("Gait10dof18musc/OutputReference/subject01.osim", "Gait10dof18musc/IK/walk_Setup_IK.xml", "Gait10dof18musc/ExperimentalData/subject01_walk.trc"),
    "Hamner": ("Hamner/outputReference/subject02_registered.osim", "Hamner/Setup_IK.xml", "Hamner/subject02_running.trc"),
}
SCALED = {  # name: model, setup of scaling, static trial
    "Rajagopal2016, running": ("../Models/Rajagopal/Rajagopal2016.osim", "Rajagopal/Scale/scale_setup_run.xml", "Rajagopal/ExpData/static_run.trc"),
}
PIPELINES |= {"Rajagopal2016, running": ("scaled.osim", "Rajagopal/IK/ik_setup_run.xml", "Rajagopal/ExpData/motion_capture_run.trc")}
LARGEST_EXCESS = 1e-6
LARGEST_ANGLE = 0.05  # deg
TIGHT = 1e-9  # accuracy of OpenSim's solver
TIGHTER = {"Rajagopal2016, running": 1e-11}  # where angles at TIGHT are still on their way
opensim.Logger.setLevelString("off")
opensim.Logger.removeFileSink()


def model_of(pipelines, name, program, folder):
    """The model of a pipeline; scaled into `folder` where the repository has none."""
    if name not in SCALED:
        return pipelines / PIPELINES[name][0]
    model, setup, markers = (pipelines / part for part in SCALED[name])
    command = [program, "scale", model, markers, "--setup", setup, "--out", folder / PIPELINES[name][0]]
    subprocess.run(command, check=True, capture_output=True)
    return folder / PIPELINES[name][0]


def sto(path):
    head, _, body = path.read_text().partition("endheader\n")
    lines = [line.split() for line in body.splitlines() if line.strip()]
    values = numpy.array([[float(cell) for cell in line] for line in lines[1:]])
    return {label: values[:, i] for i, label in enumerate(lines[0])}, "inDegrees=yes" in head


def opensims(folder, model_path, setup_path, markers_path, accuracy):
    """Motion and seconds of OpenSim's tool."""
    tree = xml.etree.ElementTree.parse(setup_path)
    put = lambda key, text: setattr(next(tree.iter(key)), "text", str(text))
    put("results_directory", folder)
    put("model_file", model_path)
    put("marker_file", markers_path)
    put("output_motion_file", folder / "ik.mot")
    put("constraint_weight", "Infinity")  # couplings hold exactly
    if accuracy is not None:
        put("accuracy", accuracy)
    setup = folder / "setup.xml"
    tree.write(setup)
    tool = opensim.InverseKinematicsTool(str(setup))
    model = opensim.Model(str(model_path))  # the tool does not own it
    tool.setModel(model)
    begin = time.perf_counter()
    tool.run()
    return sto(folder / "ik.mot"), time.perf_counter() - begin


def seconds_of(command):
    begin = time.perf_counter()
    subprocess.run(command, check=True, capture_output=True)
    return time.perf_counter() - begin


def trc(path):
    lines = path.read_text(encoding="latin-1").splitlines()
    names = [cell.strip() for cell in lines[3].split("\t")[2:] if cell.strip()]
    scale = {"mm": 1e-3, "m": 1.0}[dict(zip(lines[1].split(), lines[2].split()))["Units"]]
    rows = {}
    for line in lines[5:]:
        cells = line.split("\t")
        if len(cells) > 2 and cells[1].strip():
            values = [float(cell) if cell.strip() else numpy.nan for cell in cells[2 : 2 + 3 * len(names)]]
            rows[round(float(cells[1]), 6)] = scale * numpy.array(values).reshape(-1, 3)
    return names, rows


class Objective:
    """The objective of a setup file in postures of a motion."""

    def __init__(self, model_path, setup_path, markers_path):
        self.model = opensim.Model(str(model_path))
        self.state = self.model.initSystem()
        names, self.rows = trc(markers_path)
        tasks = xml.etree.ElementTree.parse(setup_path)
        applied = lambda kind: [t for t in tasks.iter(kind) if t.findtext("apply", "true").strip() == "true"]
        markers = self.model.getMarkerSet()
        known = {markers.get(i).getName() for i in range(markers.getSize())}
        weights = {t.get("name"): float(t.findtext("weight", "0")) for t in applied("IKMarkerTask")}
        self.markers = [(markers.get(n), names.index(n), w) for n, w in weights.items() if n in known and n in names]
        self.coordinates = [
            (t.get("name"), float(t.findtext("weight", "0")), self.wanted(t)) for t in applied("IKCoordinateTask")
        ]

    def wanted(self, task):
        if task.findtext("value_type", "default_value").strip() == "manual_value":
            return float(task.findtext("value", "0"))
        return self.model.getCoordinateSet().get(task.get("name")).getDefaultValue()

    def of(self, motion, in_degrees):
        coordinates = self.model.getCoordinateSet()
        all_of_it = [coordinates.get(i) for i in range(coordinates.getSize())]
        values = []
        for frame, at in enumerate(motion["time"]):
            for c in all_of_it:
                angle = in_degrees and c.getMotionType() == 1
                value = motion[c.getName()][frame]
                c.setLocked(self.state, False)
                c.setValue(self.state, numpy.radians(value) if angle else value, False)
            self.model.realizePosition(self.state)
            total, weight = 0.0, 0.0
            for marker, column, w in self.markers:
                place = self.rows[round(at, 6)][column]
                if numpy.isfinite(place).all() and numpy.any(place):
                    here = marker.getLocationInGround(self.state)
                    total += w * sum((here.get(i) - place[i]) ** 2 for i in range(3))
                    weight += w
            extra = sum(w * (coordinates.get(n).getValue(self.state) - v) ** 2 for n, w, v in self.coordinates)
            values.append(0.5 * (total / weight + extra))
        return numpy.array(values)


def compare(pipelines, name, program):
    _, setup, markers = (pipelines / part for part in PIPELINES[name])
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        model = model_of(pipelines, name, program, folder)
        theirs, seconds = opensims(folder, model, setup, markers, None)
        accuracy = TIGHTER.get(name, TIGHT)
        tight, _ = opensims(folder, model, setup, markers, accuracy)
        command = [program, "track", model, markers, "--tasks", setup, "--out", folder / "ours"]
        our_seconds = min(seconds_of(command) for _ in range(5))
        mine = sto(folder / "ours/motion.mot")
        objective = Objective(model, setup, markers)
    ours, [of_setup, of_tight] = objective.of(*mine), [objective.of(*motion) for motion in (theirs, tight)]
    excess = max((ours / of_setup - 1).max(), (ours / of_tight - 1).max())
    angles = {}
    for label, values in mine[0].items():
        if label in tight[0] and label != "time" and not label.endswith(("_tx", "_ty", "_tz")):
            angles[label] = numpy.abs(values - tight[0][label]).max()
    worst = max(angles, key=angles.get)
    frames = len(mine[0]["time"])
    print(f"{name}: {frames} instants, {len(objective.markers)} markers, {len(objective.coordinates)} coordinate tasks")
    print(f"  objective: ours above OpenSim's by at most {excess:.1e} of it; OpenSim's above ours by up to {(of_setup / ours - 1).max():.1e}, at accuracy {accuracy:g} {(of_tight / ours - 1).max():.1e}")
    print(f"  angles: at most {angles[worst]:.5f} deg apart ({worst}), at accuracy {accuracy:g}")
    print(f"  an instant: OpenSim {1e3 * seconds / frames:.2f} ms, contrapposto with its start and all files {1e3 * our_seconds / frames:.3f} ms")
    return excess <= LARGEST_EXCESS and angles[worst] <= LARGEST_ANGLE


def main():
    program = sys.argv[2] if len(sys.argv) > 2 else str(REPOSITORY / "target/release/contrapposto")
    held = [compare(pathlib.Path(sys.argv[1]).resolve(), name, program) for name in PIPELINES]
    sys.exit(0 if all(held) else "a limit of this script is not kept")


if __name__ == "__main__":
    main()
