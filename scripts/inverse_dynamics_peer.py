#!/usr/bin/env python3
"""Inverse dynamics of published OpenSim pipelines by OpenSim 4.6 and by contrapposto, on the same files: differences.

    python3 -m venv venv && venv/bin/pip install opensim==4.6 numpy
    cargo build --release
    venv/bin/python scripts/inverse_dynamics_peer.py FOLDER [PROGRAM]

FOLDER is the folder `Pipelines` of opensim-core's `opensim-models` repository, which is not a part of this project. Each pipeline is
copied into a temporary folder. OpenSim runs without the forces of the model; our torques are external ones with their signs turned. Frames
before the first one of the motion, which OpenSim extrapolates, are left out. `opensim_times.py` times both.
"""

import csv
import io
import pathlib
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

import numpy
import opensim

REPOSITORY = pathlib.Path(__file__).resolve().parent.parent
PIPELINES = {  # folder, model, setup of inverse dynamics
    "Gait2392_Simbody": ("OutputReference/subject01_simbody.osim", "subject01_Setup_InverseDynamics.xml"),
    "Gait10dof18musc": ("OutputReference/subject01.osim", "ID/walk_Setup_ID.xml"),
}
opensim.Logger.setLevelString("off")
opensim.Logger.removeFileSink()


def sto(path):
    head, _, body = path.read_text().partition("endheader\n")
    lines = [line.split() for line in body.splitlines() if line.strip()]
    values = numpy.array([[float(cell) for cell in line] for line in lines[1:]])
    return {label: values[:, i] for i, label in enumerate(lines[0])}


def setting(setup, key):
    return next(setup.iter(key)).text.strip()


def ours(program, arguments):
    run = subprocess.run([program, "torques", *map(str, arguments)], capture_output=True, text=True, check=True)
    rows = list(csv.reader(io.StringIO(run.stdout)))
    return {name: numpy.array([float(row[i]) for row in rows[1:]]) for i, name in enumerate(rows[0])}




def compare(pipelines, name, program):
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary) / name
        shutil.copytree(pipelines / name, folder)
        model_path, setup_path = (folder / part for part in PIPELINES[name])
        setup = xml.etree.ElementTree.parse(setup_path)
        base = setup_path.parent
        file = lambda key: pathlib.PurePosixPath(setting(setup, key)).name
        motion_name, loads_name = file("coordinates_file"), file("external_loads_file")
        motion = next(p for p in [base / motion_name, *sorted(folder.rglob(motion_name))] if p.is_file())
        loads = next(p for p in [base / loads_name, *sorted(folder.rglob(loads_name))] if p.is_file())
        start, end = map(float, setting(setup, "time_range").split())
        cutoff = float(setting(setup, "lowpass_cutoff_frequency_for_coordinates"))
        model = opensim.Model(str(model_path))
        model.updForceSet().clearAndDestroy()
        tool = opensim.InverseDynamicsTool()
        tool.setModel(model)
        tool.setCoordinatesFileName(str(motion))
        tool.setExternalLoadsFileName(str(loads))
        tool.setLowpassCutoffFrequency(cutoff)
        tool.setStartTime(start)
        tool.setEndTime(end)
        tool.setResultsDir(temporary)
        tool.setOutputGenForceFileName("forces.sto")
        tool.run()
        theirs = sto(pathlib.Path(temporary) / "forces.sto")
        cut = [] if cutoff < 0 else ["--cutoff-hz", cutoff]
        common = [model_path, motion, "--grf", loads, "--passive", "file", *(cut or ["--cutoff-hz", "none"])]
        mine = ours(program, [*common, "--dynamics", "--from", start, "--to", end])
        rest = ours(program, [*common[:-2], "--static", "--from", start, "--to", end])
        inside = (theirs["time"] >= mine["time"][0]) & (theirs["time"] <= mine["time"][-1])
        print(f"{name}: {len(mine['time'])} frames, cut-off {cutoff:g} Hz")
        worst = 0.0
        for label, values in theirs.items():
            if label == "time":
                continue
            coordinate, kind = label.rsplit("_", 1)
            column = f"{coordinate}.external_{'nm' if kind == 'moment' else 'n'}"
            if column not in mine:
                print(f"  {coordinate}: a dependent coordinate, folded into its independent one")
                continue
            difference = numpy.abs(numpy.interp(theirs["time"], mine["time"], -mine[column]) - values)[inside].max()
            at_rest = numpy.abs(numpy.interp(theirs["time"], rest["time"], -rest[column]) - values)[inside].max()
            peak = numpy.abs(values[inside]).max()
            worst = max(worst, difference / peak)
            print(f"  {coordinate:20} peak {peak:9.3f}  difference {difference:8.5f} ({100 * difference / peak:.4f} %)  at rest {at_rest:8.3f}")
        print(f"  greatest difference {100 * worst:.4f} % of a peak")


def main():
    program = sys.argv[2] if len(sys.argv) > 2 else str(REPOSITORY / "target/release/contrapposto")
    for name in PIPELINES:
        compare(pathlib.Path(sys.argv[1]), name, program)


if __name__ == "__main__":
    main()
