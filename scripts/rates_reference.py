#!/usr/bin/env python3
"""Filters, splines and inverse dynamics of OpenSim: crates/contrapposto-formats/tests/data/rates_reference.json.

    python3 -m venv venv && venv/bin/pip install opensim==4.6 numpy
    venv/bin/python scripts/rates_reference.py

`signals`: values, speeds and accelerations of OpenSim's Storage (pad, lowpassIIR at 6 Hz) and GCVSplineSet of degree 5, at even and at
uneven times, and of the splines alone. `tool`: a motion of tests/written/right_arm.osim and the generalised forces that
InverseDynamicsTool gives without the forces of the file, with a low-pass at 6 Hz.
"""

import json
import pathlib
import tempfile

import numpy
import opensim

TESTS = pathlib.Path(__file__).resolve().parent.parent / "crates/contrapposto-formats/tests"
CUTOFF = 6.0
opensim.Logger.setLevelString("off")
opensim.Logger.removeFileSink()


def write_table(path, times, columns, degrees=False):
    head = f"table\nversion=1\nnRows={len(times)}\nnColumns={len(columns) + 1}\ninDegrees={'yes' if degrees else 'no'}\nendheader\n"
    rows = ["\t".join(["time", *columns])]
    rows += ["\t".join(repr(float(v)) for v in row) for row in zip(times, *columns.values())]
    path.write_text(head + "\n".join(rows) + "\n")


def derivative(spline, order, time):
    parts = opensim.StdVectorInt()
    for _ in range(order):
        parts.append(0)
    return spline.calcDerivative(parts, opensim.Vector(1, time)) if order else spline.calcValue(opensim.Vector(1, time))


def signal(folder, times, values, filtered):
    write_table(folder / "signal.sto", times, {"q": values})
    storage = opensim.Storage(str(folder / "signal.sto"))
    if filtered:
        storage.pad(storage.getSize() // 2)
        storage.lowpassIIR(CUTOFF)
    splines = opensim.GCVSplineSet(5, storage)
    spline = splines.get(0)
    rows = [[derivative(spline, order, float(time)) for order in range(3)] for time in times]
    return {"times": [float(t) for t in times], "values": [float(v) for v in values], "filtered": filtered, "rows": rows}


def tool(folder):
    model = TESTS / "written/right_arm.osim"
    opened = opensim.Model(str(model))  # kept: its set of coordinates is a part of it
    opened.updForceSet().clearAndDestroy()
    coordinates = opened.getCoordinateSet()
    names = [coordinates.get(i).getName() for i in range(coordinates.getSize())]
    times = numpy.round(numpy.arange(40) * 0.02, 8)
    columns = {name: 0.3 * numpy.sin((3 + k) * times + k) + 0.01 * numpy.cos(40 * times) for k, name in enumerate(names)}
    write_table(folder / "motion.sto", times, columns)
    run = opensim.InverseDynamicsTool()
    run.setModel(opened)
    run.setCoordinatesFileName(str(folder / "motion.sto"))
    run.setLowpassCutoffFrequency(CUTOFF)
    run.setStartTime(0.0)
    run.setEndTime(float(times[-1]))
    run.setResultsDir(str(folder))
    run.setOutputGenForceFileName("forces.sto")
    run.run()
    table = opensim.TimeSeriesTable(str(folder / "forces.sto"))
    labels = table.getColumnLabels()
    forces = {label.rsplit("_", 1)[0]: [float(v) for v in table.getDependentColumn(label).to_numpy()] for label in labels}
    motion = {name: [float(v) for v in values] for name, values in columns.items()}
    return {"times": [float(t) for t in times], "motion": motion, "force_times": list(table.getIndependentColumn()), "forces": forces}


def main():
    random = numpy.random.RandomState(9)
    even = numpy.arange(45) / 64  # exact steps, so that OpenSim interpolates nothing
    uneven = even + random.uniform(-0.002, 0.002, 45)
    wave = lambda t: 0.4 * numpy.sin(7 * t) + 0.1 * numpy.cos(23 * t) + 0.02 * numpy.sin(120 * t)
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        signals = [signal(folder, t, wave(t), filtered) for t in (even, uneven) for filtered in (False, True)]
        data = {"tool": f"opensim {opensim.GetVersion()}", "cutoff": CUTOFF, "signals": signals, "inverse_dynamics": tool(folder)}
    (TESTS / "data/rates_reference.json").write_text(json.dumps(data).replace('"rows"', '\n"rows"').replace("}, {", "},\n{") + "\n")


if __name__ == "__main__":
    main()
