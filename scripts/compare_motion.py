#!/usr/bin/env python3
"""Compares joint centres and centres of mass of our `.mot` on our `.osim` in OpenSim with those of our kinematics.

    python3 -m venv peervenv && peervenv/bin/pip install opensim==4.6 numpy
    peervenv/bin/python scripts/compare_motion.py

The test `exchange_motion` of contrapposto-formats writes models, motions and points first. OpenSim's points become
crates/contrapposto-formats/tests/data/motion_peers.json, which the test `opensim_plays_the_motion_to_the_same_places` holds ours to.
Run it again whenever the built-in adult or the motions of that test change.

The table goes the way of OpenSim's own programs: `Storage` reads it, `SimbodyEngine` turns its degrees into radians where OpenSim
calls a coordinate rotational, and every column with the name of a coordinate gives that coordinate's value.
"""

import json
import os
import pathlib
import subprocess
import tempfile

import numpy
import opensim

HERE = pathlib.Path(__file__).resolve().parent.parent
KEPT = HERE / "crates/contrapposto-formats/tests/data/motion_peers.json"
LIMIT = 1e-5
opensim.Logger.setLevelString("off")
opensim.Logger.removeFileSink()


def exchange(folder):
    command = ["cargo", "test", "-q", "-p", "contrapposto-formats", "--test", "all", "write::motion::exchange_motion", "--", "--ignored", "--exact"]
    subprocess.run(command, cwd=HERE, check=True, env={**os.environ, "CONTRAPPOSTO_EXCHANGE": str(folder)})


def played(model_path, motion_path, every, stations):
    """Of every so many rows the places of all stations (body, point) in ground, m."""
    model = opensim.Model(str(model_path))
    state = model.initSystem()
    table = opensim.Storage(str(motion_path))
    if table.isInDegrees():
        model.getSimbodyEngine().convertDegreesToRadians(table)
    labels = table.getColumnLabels()
    columns = {labels.get(i): i - 1 for i in range(1, labels.getSize())}
    coordinates = model.getCoordinateSet()
    coordinates = [coordinates.get(i) for i in range(coordinates.getSize())]
    missing = [c.getName() for c in coordinates if c.getName() not in columns]
    assert not missing, missing
    rows = []
    for row in range(0, table.getSize(), every):
        values = table.getStateVector(row).getData()
        for coordinate in coordinates:
            coordinate.setLocked(state, False)
            coordinate.setValue(state, values.get(columns[coordinate.getName()]), False)
        model.realizePosition(state)
        bodies = model.getBodySet()
        place = lambda body, point: bodies.get(body).findStationLocationInGround(state, opensim.Vec3(*point))
        rows.append([[place(body, point).get(k) for k in range(3)] for body, point in stations])
    return rows


def main():
    with tempfile.TemporaryDirectory() as made:
        folder = pathlib.Path(made)
        exchange(folder)
        models = []
        for i, model in enumerate(json.loads((folder / "answers.json").read_text())["models"]):
            found = played(folder / f"model_{i}.osim", folder / f"motion_{i}.mot", model["every"], model["stations"])
            worst = float(numpy.linalg.norm(numpy.subtract(found, model["points"]), axis=-1).max())
            print(model["name"], f"{worst:.1e} m")
            assert worst < LIMIT, model["name"]
            points = numpy.round(found, 9).tolist()
            models.append({"name": model["name"], "worst": worst, "points": points})
    tool = f"opensim {opensim.GetVersion()}"
    text = json.dumps({"made_by": "scripts/compare_motion.py", "tool": tool, "models": models})
    KEPT.write_text(text.replace("]], ", "]],\n").replace("}, ", "},\n") + "\n")


if __name__ == "__main__":
    main()
