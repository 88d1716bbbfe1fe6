#!/usr/bin/env python3
"""Times of marker tracking and inverse dynamics an instant, by OpenSim 4.6 and by contrapposto in one run on one core: mean, p99, slowest.

    python3 -m venv venv && venv/bin/pip install opensim==4.6 numpy
    cargo build --release
    cargo build --release -p contrapposto-formats --example opensim_times
    venv/bin/python scripts/opensim_times.py FOLDER [EXAMPLE]

FOLDER is the folder `Pipelines` of opensim-core's `opensim-models` repository, which is not a part of this project. Both programs get the same
model, markers and setup file. Only the solvers are timed, each instant alone and by the clock of the wall: of OpenSim
`InverseKinematicsSolver.track` with the accuracy of the setup file, and `InverseDynamicsSolver.solve` with `realizeVelocity` on the model
without muscles; of contrapposto the same by `examples/opensim_times.rs`. The first instant of tracking is left out. The two programs take
turns, ROUNDS times, and each instant counts with the least of its times, so that other programs of the machine count little.
"""

import os
import pathlib
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree

import numpy
import opensim

import marker_tracking_peer as tracking

ROUNDS = 5
LEAST_SPEED = 20


def solvers_times(model_path, setup_path, markers_path):
    """Seconds of OpenSim an instant: of tracking, and of inverse dynamics in its postures."""
    setup = xml.etree.ElementTree.parse(setup_path)
    model = opensim.Model(str(model_path))
    model.updForceSet().clearAndDestroy()
    state = model.initSystem()
    applied = lambda kind: [t for t in setup.iter(kind) if t.findtext("apply", "true").strip() == "true"]
    weights = opensim.SetMarkerWeights()
    known = {model.getMarkerSet().get(i).getName() for i in range(model.getMarkerSet().getSize())}
    names = set(tracking.trc(markers_path)[0]) & known
    for task in applied("IKMarkerTask"):
        if task.get("name") in names:
            weights.cloneAndAppend(opensim.MarkerWeight(task.get("name"), float(task.findtext("weight", "0"))))
    reference = opensim.MarkersReference(str(markers_path), weights)
    coordinates = opensim.SimTKArrayCoordinateReference()
    for task in applied("IKCoordinateTask"):
        value = model.getCoordinateSet().get(task.get("name")).getDefaultValue()
        if task.findtext("value_type", "default_value").strip() == "manual_value":
            value = float(task.findtext("value", "0"))
        wanted = opensim.CoordinateReference(task.get("name"), opensim.Constant(value))
        wanted.setWeight(float(task.findtext("weight", "0")))
        coordinates.push_back(wanted)
    solver = opensim.InverseKinematicsSolver(model, reference, coordinates, float("inf"))
    solver.setAccuracy(float(setup.findtext(".//accuracy", "1e-5")))
    dynamics, udot = opensim.InverseDynamicsSolver(model), opensim.Vector(state.getNU(), 0.1)
    start, end = map(float, setup.findtext(".//time_range").split())
    times = [t for t in sorted(tracking.trc(markers_path)[1]) if start - 5e-4 <= t <= end + 5e-4]
    state.setTime(times[0])
    solver.assemble(state)
    spent = {"track": [], "dynamics": []}
    for at in times[1:]:
        state.setTime(at)
        begin = time.perf_counter()
        solver.track(state)
        spent["track"].append(time.perf_counter() - begin)
        state.updU().setTo(0.3)
        # A new posture: everything is computed anew.
        state.updQ()
        begin = time.perf_counter()
        model.realizeVelocity(state)
        dynamics.solve(state, udot)
        spent["dynamics"].append(time.perf_counter() - begin)
    return {kind: 1e6 * numpy.array(seconds) for kind, seconds in spent.items()}


def our_times(example, paths):
    text = subprocess.run([example, *map(str, paths)], check=True, capture_output=True, text=True).stdout
    spent = {"track": [], "dynamics": []}
    for kind, number in map(str.split, text.splitlines()):
        spent[kind].append(float(number))
    return {kind: numpy.array(times) for kind, times in spent.items()}


def main():
    pipelines = pathlib.Path(sys.argv[1]).resolve()
    example = sys.argv[2] if len(sys.argv) > 2 else str(tracking.REPOSITORY / "target/release/examples/opensim_times")
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})  # both on the same core
    fast = True
    temporary = tempfile.TemporaryDirectory()
    for name, parts in tracking.PIPELINES.items():
        _, setup, markers = (pipelines / part for part in parts)
        model = tracking.model_of(pipelines, name, str(tracking.REPOSITORY / "target/release/contrapposto"), pathlib.Path(temporary.name))
        theirs, ours = [], []
        for _ in range(ROUNDS):
            theirs.append(solvers_times(model, setup, markers))
            ours.append(our_times(example, (model, markers, setup)))
        for kind in ("track", "dynamics"):
            both = [numpy.min([times[kind] for times in rounds], axis=0) for rounds in (theirs, ours)]
            words = [f"{t.mean():.1f} / {numpy.percentile(t, 99):.1f} / {t.max():.1f}" for t in both]
            speeds = [both[0].mean() / both[1].mean(), *(f(both[0]) / f(both[1]) for f in (lambda t: numpy.percentile(t, 99), numpy.max))]
            print(f"{name}, {kind}, {len(both[0])} and {len(both[1])} instants, mean / p99 / slowest, us: OpenSim {words[0]}, contrapposto {words[1]}, {' / '.join(f'{s:.0f}' for s in speeds)} times faster", flush=True)
            fast &= speeds[0] >= LEAST_SPEED
    sys.exit(0 if fast else f"less than {LEAST_SPEED} times faster")


if __name__ == "__main__":
    main()
