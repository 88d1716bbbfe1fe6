#!/usr/bin/env python3
"""Writes what OpenSim's JointReaction analysis says of random postures at rest under random tensions, for the test `joint_reactions`.

    python3 -m venv venv && venv/bin/pip install opensim==4.6 numpy
    venv/bin/python scripts/opensim_reactions.py OUT MODEL...

OUT: a folder for one `reactions_NAME.json` a model (numbers and names only). All coordinates are locked, so that nothing accelerates whatever the muscles
pull; each muscle has the given tension in place of its own. Forces and moments act on the child, at the origin of its joint's frame, in the axes of
its body. Forces of the model that are no muscles are switched off.
"""

import json
import pathlib
import sys
import tempfile

import numpy
import opensim

POSTURES = 5
SEED = 19
# Ranges beyond this size are cut, rad and m.
MOST = 1.0


def analysis_of(model):
    """The analysis of all joints; OpenSim wants it before the system of the model is made."""
    joints, child = opensim.ArrayStr(), opensim.ArrayStr()
    joints.append("ALL")
    child.append("child")
    analysis = opensim.JointReaction(model)
    analysis.setName("r")
    analysis.setJointNames(joints)
    analysis.setOnBody(child)
    analysis.setInFrame(child)
    model.addAnalysis(analysis)
    return analysis


def analysed(model, analysis, state):
    """Six numbers by name of joint: force, then moment."""
    analysis.begin(state)
    with tempfile.TemporaryDirectory() as folder:
        analysis.printResults("r", folder)
        table = opensim.TimeSeriesTable(str(next(pathlib.Path(folder).glob("*.sto"))))
    row = table.getRowAtIndex(table.getNumRows() - 1)
    values = {label: row[i] for i, label in enumerate(table.getColumnLabels())}
    found = {}
    for i in range(model.getJointSet().getSize()):
        joint = model.getJointSet().get(i)
        name, body = joint.getName(), joint.getChildFrame().findBaseFrame().getName()
        stem = f"{name}_on_{body}_in_{body}_"
        found[name] = [values[stem + part] for part in ("fx", "fy", "fz", "mx", "my", "mz")]
    return found


def exact(model, state):
    """The same by the functions on which the analysis stands, with all digits."""
    found = {}
    for i in range(model.getJointSet().getSize()):
        joint = model.getJointSet().get(i)
        pair = joint.calcReactionOnChildExpressedInGround(state)
        body = joint.getChildFrame().findBaseFrame()
        ground = model.getGround()
        vectors = [ground.expressVectorInAnotherFrame(state, pair.get(k), body) for k in (1, 0)]
        found[joint.getName()] = [float(v.get(k)) for v in vectors for k in range(3)]
    return found


def write(path, out):
    model = opensim.Model(str(path))
    muscles = [model.getMuscles().get(i) for i in range(model.getMuscles().getSize())]
    names = {muscle.getName() for muscle in muscles}
    for i in range(model.getForceSet().getSize()):
        force = model.updForceSet().get(i)
        if force.getName() not in names:
            force.set_appliesForce(False)
    analysis = analysis_of(model)
    state = model.initSystem()
    coordinates = [model.getCoordinateSet().get(i) for i in range(model.getCoordinateSet().getSize())]
    rng, postures = numpy.random.default_rng(SEED), []
    for _ in range(POSTURES):
        for coordinate in coordinates:
            coordinate.setLocked(state, False)
        for coordinate in coordinates:
            if coordinate.isDependent(state):
                continue
            low, high = max(coordinate.getRangeMin(), -MOST), min(coordinate.getRangeMax(), MOST)
            coordinate.setValue(state, float(rng.uniform(low, high)) if low < high else coordinate.getDefaultValue(), False)
        model.assemble(state)
        for coordinate in coordinates:
            if not coordinate.isDependent(state):
                coordinate.setLocked(state, True)
        tensions = {}
        for muscle in muscles:
            tensions[muscle.getName()] = float(rng.uniform(0.0, 0.5 * muscle.getMaxIsometricForce()))
            muscle.overrideActuation(state, True)
            muscle.setOverrideActuation(state, tensions[muscle.getName()])
        model.realizeAcceleration(state)
        assert max(abs(state.getUDot().get(i)) for i in range(state.getNU())) < 1e-9, "a locked body accelerates"
        reactions = exact(model, state)
        for name, printed in analysed(model, analysis, state).items():
            assert numpy.allclose(printed, reactions[name], rtol=1e-6, atol=1e-4), name
        values = {coordinate.getName(): float(coordinate.getValue(state)) for coordinate in coordinates}
        postures.append({"q": values, "tensions": tensions, "reactions": reactions})
    # Names once.
    order = {key: list(postures[0][key]) for key in ("q", "tensions", "reactions")}
    rows = [{key: [posture[key][name] for name in order[key]] for key in order} for posture in postures]
    name = pathlib.Path(path).stem
    (pathlib.Path(out) / f"reactions_{name}.json").write_text(json.dumps({"by": f"OpenSim {opensim.GetVersion()}", "order": order, "postures": rows}))
    print(name, "greatest force", max(abs(x) for row in rows for r in row["reactions"] for x in r[:3]))


def main():
    opensim.Logger.setLevelString("error")
    opensim.Logger.removeFileSink()
    for path in sys.argv[2:]:
        write(path, sys.argv[1])


if __name__ == "__main__":
    main()
