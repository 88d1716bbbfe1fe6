"""Generalised forces of OpenSim's ligaments, path springs and bushings, for a test of contrapposto-formats.

    python3 -m venv venv && venv/bin/pip install opensim==4.6 numpy
    venv/bin/python scripts/opensim_springs.py

Writes crates/contrapposto-formats/tests/data/opensim_springs.json: for each kind a model of three pins and a slide with one such force
between its ends, as text, and the force by coordinate (N m, N) in random postures without gravity and at rest.
"""

import json
import pathlib
import re
import tempfile

import numpy
import opensim

opensim.Logger.setLevelString("off")
opensim.Logger.removeFileSink()
RANDOM = numpy.random.default_rng(19)
FILE = pathlib.Path(__file__).resolve().parent.parent / "crates/contrapposto-formats/tests/data/opensim_springs.json"
VECTOR = opensim.Vec3


def chain():
    model = opensim.Model()
    model.setName("chain")
    model.setGravity(VECTOR(0))
    parent = model.getGround()
    turns = [VECTOR(0), VECTOR(0.9, 0.2, 0), VECTOR(0.1, 1.1, 0.3), VECTOR(0.4, 0.2, 1.0)]
    for number, turn in enumerate(turns):
        body = opensim.Body(f"b{number}", 1, VECTOR(0), opensim.Inertia(1, 1, 1))
        model.addBody(body)
        kind = opensim.SliderJoint if number == 3 else opensim.PinJoint
        joint = kind(f"j{number}", parent, VECTOR(0.05, 0.1, 0), turn, body, VECTOR(0, -0.1, 0.02), VECTOR(0.1, 0, 0))
        joint.updCoordinate().setName(f"q{number}")
        model.addJoint(joint)
        parent = body
    return model, parent


def along_path(force, last):
    def add(name, frame, place):
        path.appendNewPathPoint(name, frame, place)

    path = opensim.GeometryPath.safeDownCast(force.updPath())
    add("a", last[0].getGround(), VECTOR(0.02, 0.01, 0.0))
    add("b", last[0].getBodySet().get("b1"), VECTOR(0.03, 0.05, 0.01))
    add("c", last[1], VECTOR(0.02, 0.04, -0.03))
    return force


def force(kind, last):
    if kind == "BushingForce":
        made = opensim.BushingForce(
            "x", last[0].getGround(), opensim.Transform(opensim.Rotation(0.3, opensim.CoordinateAxis(1)), VECTOR(0.1, 0.2, 0.3)),
            last[1], opensim.Transform(opensim.Rotation(-0.2, opensim.CoordinateAxis(0)), VECTOR(0.0, 0.1, 0.1)),
            VECTOR(100, 200, 300), VECTOR(10, 20, 30), VECTOR(1), VECTOR(1))
        return made
    if kind == "Ligament":
        made = opensim.Ligament()
        made.setRestingLength(0.2)
        made.setMaxIsometricForce(120)
    elif kind == "PathSpring":
        made = opensim.PathSpring("x", 0.25, 900, 0.1)
    else:
        made = opensim.Blankevoort1991Ligament()
        made.set_slack_length(0.3)
        made.set_linear_stiffness(1500)
        made.set_transition_strain(0.06)
    made.setName("x")
    return along_path(made, last)


def torques(model, state):
    model.realizeDynamics(state)
    # Without motion, inverse dynamics gives what balances the applied forces.
    balance = opensim.InverseDynamicsSolver(model).solve(state, opensim.Vector(state.getNU(), 0.0))
    return [-balance.get(i) for i in range(balance.size())]


rows = {}
for kind in ("Ligament", "Blankevoort1991Ligament", "PathSpring", "BushingForce"):
    model, last = chain()
    model.addForce(force(kind, (model, last)))
    model.finalizeConnections()
    with tempfile.NamedTemporaryFile(suffix=".osim") as file:
        model.printToXML(file.name)
        text = re.sub(r"\s*<!--.*?-->", "", pathlib.Path(file.name).read_text(), flags=re.S)
        model = opensim.Model(file.name)
    state = model.initSystem()
    coordinates = model.getCoordinateSet()
    names = [coordinates.get(i).getName() for i in range(coordinates.getSize())]
    postures = []
    for _ in range(8):
        q = [float(f"{x:.12g}") for x in RANDOM.uniform(-0.9, 0.9, len(names)) * [1, 1, 1, 0.1]]
        for i, value in enumerate(q):
            coordinates.get(i).setValue(state, value)
        postures.append({"q": q, "torque": torques(model, state)})
    rows[kind] = {"coordinates": names, "osim": text, "postures": postures}
FILE.write_text(json.dumps({"tool": f"opensim {opensim.GetVersion()}", "kinds": rows}, indent=1) + "\n")
