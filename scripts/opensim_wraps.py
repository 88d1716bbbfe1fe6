"""Lengths of OpenSim's lines over single surfaces, for a test of contrapposto-formats.

    python3 -m venv venv && venv/bin/pip install opensim==4.6 numpy
    venv/bin/python scripts/opensim_wraps.py [LINES [SEED [FILE]]]

Writes crates/contrapposto-formats/tests/data/opensim_wraps.json: for every surface, quadrant and method LINES (4) straight lines between
random points about the surface, and the length of OpenSim's path. A row: kind, sizes in m, quadrant, method, ends in m, length in m
(null where OpenSim gives no number).
"""

import json
import math
import pathlib
import sys

import numpy
import opensim

opensim.Logger.setLevelString("off")
opensim.Logger.removeFileSink()
LINES = int(sys.argv[1]) if len(sys.argv) > 1 else 4
RANDOM = numpy.random.default_rng(int(sys.argv[2]) if len(sys.argv) > 2 else 19)
HERE = pathlib.Path(__file__).resolve().parent.parent / "crates/contrapposto-formats/tests/data/opensim_wraps.json"
FILE = pathlib.Path(sys.argv[3]) if len(sys.argv) > 3 else HERE

ELLIPSOIDS = [(0.03, 0.05, 0.04), (0.02, 0.06, 0.03), (0.035, 0.02, 0.02), (0.1, 0.135, 0.08)]
SURFACES = [("sphere", (0.04,), "hybrid")]
SURFACES += [("ellipsoid", sizes, method) for sizes in ELLIPSOIDS for method in ("hybrid", "midpoint", "axial")]
SURFACES += [("torus", sizes, "hybrid") for sizes in ((0.01, 0.05), (0.04, 0.06), (0.0068, 0.008))]


def surface(kind, sizes, quadrant):
    if kind == "sphere":
        made = opensim.WrapSphere()
        made.set_radius(sizes[0])
    elif kind == "ellipsoid":
        made = opensim.WrapEllipsoid()
        made.set_dimensions(opensim.Vec3(*sizes))
    else:
        made = opensim.WrapTorus()
        made.set_inner_radius(sizes[0])
        made.set_outer_radius(sizes[1])
    made.setName("surface")
    made.set_quadrant(quadrant)
    return made


def lengths(kind, sizes, quadrant, method, lines):
    model = opensim.Model()
    body = opensim.Body("body", 1, opensim.Vec3(0), opensim.Inertia(1, 1, 1))
    model.addBody(body)
    model.addJoint(opensim.SliderJoint("joint", model.getGround(), body))
    wrapped = surface(kind, sizes, quadrant)
    model.updGround().addWrapObject(wrapped)
    for number, ends in enumerate(lines):
        force = opensim.PathActuator()
        force.setName(f"line{number}")
        for name, end in zip("ab", ends):
            force.addNewPathPoint(name, model.getGround(), opensim.Vec3(*end))
        model.addForce(force)
        path = force.updGeometryPath()
        path.addPathWrap(wrapped)
        if method != "hybrid":
            path.updWrapSet().get(0).set_method(method)
    state = model.initSystem()
    forces = model.getForceSet()
    return [opensim.PathActuator.safeDownCast(forces.get(n)).getGeometryPath().getLength(state) for n in range(len(lines))]


def unit(vector):
    return vector / numpy.linalg.norm(vector)


def line(size):
    """Ends about opposite each other, some of them inside."""
    side = unit(RANDOM.normal(size=3))
    other = unit(-side + 0.7 * RANDOM.normal(size=3))
    ends = (side * size * RANDOM.uniform(0.9, 4), other * size * RANDOM.uniform(0.9, 4))
    return [[float(f"{x:.12g}") for x in end] for end in ends]


rows = []
for kind, sizes, method in SURFACES:
    for quadrant in ("all", "x", "-x", "y", "-y", "z", "-z"):
        lines = [line(max(sizes)) for _ in range(LINES)]
        for ends, length in zip(lines, lengths(kind, sizes, quadrant, method, lines)):
            rows.append([kind, sizes, quadrant, method, *ends, length if math.isfinite(length) else None])
text = ",\n".join(json.dumps(row) for row in rows)
FILE.write_text(f'{{"tool": "opensim {opensim.GetVersion()}", "rows": [\n{text}\n]}}\n')
