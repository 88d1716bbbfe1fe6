#!/usr/bin/env python3
"""Inverse dynamics of published OpenSim pipelines by OpenSim 4.6 and by contrapposto, on the same files: differences.

    python3 -m venv venv && venv/bin/pip install opensim==4.6 numpy scipy
    cargo build --release
    venv/bin/python scripts/inverse_dynamics_peer.py FOLDER [PROGRAM]

FOLDER is the folder `Pipelines` of opensim-core's `opensim-models` repository, which is not a part of this project. Each pipeline is
copied into a temporary folder. Where a pipeline has no motion or no scaled model (Rajagopal2016), `contrapposto scale` and `track` make them, from
`Models` beside FOLDER, and both programs read them; where it has no setup of inverse dynamics, its cut-off is that of its residual reduction. OpenSim runs without the forces of the model; our torques are external ones with their signs turned. Frames
before the first one of the motion, which OpenSim extrapolates, are left out. `opensim_times.py` times both.

Two differences have their cause in the programs, which this script shows:
- Between samples forces are straight lines here and natural cubic splines in OpenSim; `--grf-splines` takes splines here, too, and the limit holds for
  these. It matters where forces have 60 Hz (Hamner).
- OpenSim's accelerations of a joint whose one coordinate drives several rotations (the knee of Rajagopal2016) are not the second derivative of its own
  positions: both programs' force on the root of a swinging knee is compared with second differences of OpenSim's centre of mass. The limit does not
  hold for torques of such a model; that of momentum does.
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
from scipy.interpolate import CubicSpline

REPOSITORY = pathlib.Path(__file__).resolve().parent.parent
PIPELINES = {  # folder: model, setup of inverse dynamics
    "Gait2392_Simbody": ("OutputReference/subject01_simbody.osim", "subject01_Setup_InverseDynamics.xml"),
    "Gait10dof18musc": ("OutputReference/subject01.osim", "ID/walk_Setup_ID.xml"),
}
PARTS = {  # folder: model, motion, forces, cut-off in Hz, time range in s
    "Hamner": ("outputReference/subject02_registered.osim", "outputReference/ResultsIK/subject02_running_ik.mot", "External_Loads.xml", 15.0, (0.2, 9.8)),
    "Rajagopal": ("scaled.osim", "tracked/motion.mot", "ID/grf_run.xml", 15.0, (0.832, 1.546)),
}
SCALED = {"Rajagopal": ("Rajagopal/Rajagopal2016.osim", "Scale/scale_setup_run.xml", "ExpData/static_run.trc", "IK/ik_setup_run.xml", "ExpData/motion_capture_run.trc")}
LARGEST_SHARE = 0.01  # of a peak
LARGEST_MOMENTUM = 1e-4  # N, of second differences
TURNING_KNEES = {"Rajagopal": "knee_angle_r"}
FINE = 2000  # Hz
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



def parts_of_setup(folder, name):
    """Model, motion, forces, cut-off and times of a pipeline with a setup file."""
    model, setup_path = (folder / part for part in PIPELINES[name])
    setup = xml.etree.ElementTree.parse(setup_path)
    base = setup_path.parent
    found = []
    for key in ("coordinates_file", "external_loads_file"):
        file = pathlib.PurePosixPath(setting(setup, key)).name
        found.append(next(p for p in [base / file, *sorted(folder.rglob(file))] if p.is_file()))
    times = tuple(map(float, setting(setup, "time_range").split()))
    return model, *found, float(setting(setup, "lowpass_cutoff_frequency_for_coordinates")), times


def tracked(models, folder, name, program):
    """Makes the scaled model and the motion of a pipeline that has neither."""
    model, scale, static, tasks, markers = SCALED[name]
    run = lambda *command: subprocess.run([program, *map(str, command)], check=True, capture_output=True)
    run("scale", models / model, folder / static, "--setup", folder / scale, "--out", folder / "scaled.osim")
    run("track", folder / "scaled.osim", folder / markers, "--tasks", folder / tasks, "--out", folder / "tracked")


def opensims(model_path, motion, loads, cutoff, times, folder):
    model = opensim.Model(str(model_path))
    model.updForceSet().clearAndDestroy()
    tool = opensim.InverseDynamicsTool()
    tool.setModel(model)
    tool.setCoordinatesFileName(str(motion))
    if loads is not None:
        tool.setExternalLoadsFileName(str(loads))
    tool.setLowpassCutoffFrequency(cutoff)
    tool.setStartTime(times[0])
    tool.setEndTime(times[1])
    tool.setResultsDir(str(folder))
    tool.setOutputGenForceFileName("forces.sto")
    tool.run()
    return sto(folder / "forces.sto")


def column(label):
    coordinate, kind = label.rsplit("_", 1)
    return f"{coordinate}.external_{'nm' if kind == 'moment' else 'n'}"


def differences(theirs, mine):
    """Peak and greatest difference of each row; our instants lie between OpenSim's where the steps of time are uneven."""
    inside = (theirs["time"] >= mine["time"][0]) & (theirs["time"] <= mine["time"][-1])
    found = {}
    for label in theirs.keys() - {"time"}:
        if column(label) in mine:  # a dependent coordinate is folded into its independent one
            values = CubicSpline(mine["time"], -mine[column(label)])(theirs["time"])
            found[label] = numpy.abs(theirs[label][inside]).max(), numpy.abs(values - theirs[label])[inside].max()
    return found


def momentum(model_path, coordinate, program, folder):
    """Force on the root while one knee swings at 10 rad/s: greatest differences of both programs from second differences of OpenSim's centre of mass."""
    model = opensim.Model(str(model_path))
    model.updForceSet().clearAndDestroy()
    state = model.initSystem()
    coordinates = model.getCoordinateSet()
    independent = [coordinates.get(i) for i in range(coordinates.getSize())]
    couplers = {}  # dependent coordinate: independent one, function
    for i in range(model.getConstraintSet().getSize()):
        coupler = opensim.CoordinateCouplerConstraint.safeDownCast(model.getConstraintSet().get(i))
        couplers[coupler.getDependentCoordinateName()] = coupler.getIndependentCoordinateNames().get(0), coupler.getFunction()

    def angle(c, at):
        if c.getName() in couplers:
            other, function = couplers[c.getName()]
            return function.calcValue(opensim.Vector(1, angle(coordinates.get(other), at)))
        return 0.5 + 10 * at if c.getName() == coordinate else c.getDefaultValue()

    times = numpy.linspace(-0.03, 0.03, 61)
    rows = ["\t".join(["time", *(c.getName() for c in independent)])]
    rows += ["\t".join(repr(float(x)) for x in (at, *(angle(c, at) for c in independent))) for at in times]
    head = f"swing\nversion=1\nnRows={len(times)}\nnColumns={len(independent) + 1}\ninDegrees=no\nendheader\n"
    motion = folder / "swing.mot"
    motion.write_text(head + "\n".join(rows) + "\n")

    def center(at):
        for c in independent:
            c.setLocked(state, False)
            c.setValue(state, angle(c, at), False)
        model.realizePosition(state)
        place = model.calcMassCenterPosition(state)
        return numpy.array([place.get(i) for i in range(3)])

    h = 1e-3
    second = (16 * (center(h) + center(-h)) - center(2 * h) - center(-2 * h) - 30 * center(0)) / (12 * h * h)
    gravity = model.getGravity()
    expected = model.getTotalMass(state) * (second - numpy.array([gravity.get(i) for i in range(3)]))
    theirs = opensims(model_path, motion, None, -1, (-0.03, 0.03), folder)
    mine = ours(program, [model_path, motion, "--passive", "file", "--cutoff-hz", "none", "--dynamics"])
    apart = lambda found, rows, sign: max(
        abs(sign * found[row][int(numpy.abs(found["time"]).argmin())] - value) for row, value in zip(rows, expected)
    )
    return apart(mine, [f"pelvis_t{x}.external_n" for x in "xyz"], -1), apart(theirs, [f"pelvis_t{x}_force" for x in "xyz"], 1)


def compare(pipelines, name, program):
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary) / name
        shutil.copytree(pipelines / name, folder)
        if name in SCALED:
            tracked(pipelines.parent / "Models", folder, name, program)
        if name in PIPELINES:
            model, motion, loads, cutoff, times = parts_of_setup(folder, name)
        else:
            *files, cutoff, times = PARTS[name]
            model, motion, loads = (folder / file for file in files)
        span = ["--from", times[0], "--to", times[1]]

        def our_torques(loads, *how):
            return ours(program, [model, motion, "--grf", loads, "--allow-path", folder, "--passive", "file", *how, *span])

        moving = "--dynamics", "--cutoff-hz", cutoff if cutoff > 0 else "none"
        mine = our_torques(loads, *moving)
        as_given = opensims(model, motion, loads, cutoff, times, folder)
        given, rest = differences(as_given, mine), differences(as_given, our_torques(loads, "--static"))
        smooth = differences(as_given, our_torques(loads, *moving, "--grf-splines"))
        print(f"{name}: {len(mine['time'])} instants, cut-off {cutoff:g} Hz; peak, difference, with splines between forces, at rest")
        for label, (peak, difference) in given.items():
            print(f"  {label:25} {peak:9.3f} {difference:8.5f} ({100 * difference / peak:.4f} %) {smooth[label][1]:8.5f} {rest[label][1]:8.3f}")
        worst = [max(difference / peak for peak, difference in rows.values()) for rows in (given, smooth)]
        print(f"  greatest difference {100 * worst[0]:.4f} % of a peak, {100 * worst[1]:.4f} % with --grf-splines")
        if name not in TURNING_KNEES:
            return worst[1] <= LARGEST_SHARE
        of_ours, of_theirs = momentum(model, TURNING_KNEES[name], program, folder)
        print(f"  a swinging knee, force on the root: {of_ours:.1e} N from second differences of positions, OpenSim's own {of_theirs:.1e} N")
        return of_ours <= LARGEST_MOMENTUM


def main():
    program = sys.argv[2] if len(sys.argv) > 2 else str(REPOSITORY / "target/release/contrapposto")
    held = [compare(pathlib.Path(sys.argv[1]).resolve(), name, program) for name in (*PIPELINES, *PARTS)]
    sys.exit(0 if all(held) else f"more than {100 * LARGEST_SHARE:g} % of a peak apart")


if __name__ == "__main__":
    main()
