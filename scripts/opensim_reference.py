"""Reference values of OpenSim for the tests of contrapposto-formats and contrapposto.

    python3 -m venv venv && venv/bin/pip install opensim==4.6 numpy
    venv/bin/python scripts/opensim_reference.py [FOLDER]

Writes crates/contrapposto-formats/tests/data/opensim_{expressions,functions,models,torques}.json. Deterministic: fixed seeds.

FOLDER holds the published models of `PUBLISHED`, which are not copied into the project; without it their part of
opensim_torques.json stays as it is. They come out of packages of PyPI: `pip download --no-deps nimblephysics==0.10.52.1
pose2sim==0.10.49 osim-rl==3.0.11`, then unzip or untar the `.osim` files into FOLDER.
"""

import json
import math
import multiprocessing
import pathlib
import sys

import numpy
import opensim

HERE = pathlib.Path(__file__).resolve().parent.parent / "crates/contrapposto-formats/tests"
TOOL = f"opensim {opensim.GetVersion()}"
opensim.Logger.setLevelString("off")
opensim.Logger.removeFileSink()

ANGLES = [0.7, -0.3, 0.0, 2.0, -1.6]

EXPRESSIONS = """-q^2 | (-q)^2 | -(q)^2 | 2^3^2 | 2^-1 | q^-2 | -q^-2 | 2^-q^2 | -2^2 | -q*2^2 | (q+3)^2^0.5 | 2^-3*4 | 2--3 | 2*-q | --q | q--q
3 - 2 - 1 | 8/4/2 | 2*q/3*4 | q-1-q*2 | q/2*3 | -q+q*q | 1 2*q | sin (q) | q^3 | (q+2)^0.5 | 0^q | q^0 | 0*log(q) | q/q | q-q | 0/q
exp(-5*(q+0.1)) | log(q+3) | sqrt(q+3) | sin(q) | cos(q) | sec(q) | csc(q+4) | tan(q) | cot(q+4) | asin(q/3) | acos(q/3) | atan(q)
sinh(q) | cosh(q) | tanh(q) | erf(q) | erfc(q) | erf(4*q) | erfc(4*q) | step(q) | step(q)*q | delta(q) | square(q) | cube(q) | recip(q+3)
min(q,0.2) | max(q,0.2) | abs(q) | min(q,q^2) | max(sin(q),cos(q)) | sin(q)^2 | -sin(q)^2 | a+1; a=q*2 | a+b;a=b*q;b=q+1 | a;a=q; | q;q=3 | sin;sin=q
qdot | q*qdot+1 | 1e2*q | 1.5e-1*q | 2.0E+1*q | .5*q | 5.*q | a$1+q;a$1=2 | exp(q)^-q | (q+3)^(q/2) | 2^q | -2*exp(-5*(q+0.1)) + 3*exp(4*(q-1.2)) - 0.5*q
((((q)))) | -(-(-q)) | 3.1*exp(22.4*(-1.0-q))-10.5*exp(14.8*(q-0.3)) | k*(q-r)^3; k=-2.5; r=0.1"""

REFUSED = ["+q", "q*+2", "2q", "sin(q", "sin)q", "()", "", "q,1", "min(q)", "sqrt(q,1)", "1.2.3", "q=2", "Q", "q%2", "q**2", "pi*q", "e*q",
           "sign(q)", "floor(q)", "atan2(q,1)", "pow(q,2)", "ln(q)", "a+b;b=q+1;a=b*q", "a+a; a = q ; b = ;", "q;3", "q<1"]


def expression_model():
    model = opensim.Model()
    body = opensim.Body("b", 1, opensim.Vec3(0), opensim.Inertia(1, 1, 1, 0, 0, 0))
    model.addBody(body)
    joint = opensim.PinJoint("j", model.getGround(), body)
    joint.updCoordinate().setName("q0")
    model.addJoint(joint)
    force = opensim.ExpressionBasedCoordinateForce("q0", "0")
    model.addForce(force)

    def evaluate(text, q):
        force.setExpression(text)
        state = model.initSystem()
        model.getCoordinateSet().get(0).setValue(state, q)
        model.realizeVelocity(state)
        return force.calcExpressionForce(state)

    return model, evaluate


def expressions():
    keep, evaluate = expression_model()
    rows = []
    for text in [t.strip() for line in EXPRESSIONS.splitlines() for t in line.split(" | ")]:
        rows.append({"text": text, "values": [evaluate(text, q) for q in ANGLES]})
    refused = []
    for text in REFUSED:
        try:
            evaluate(text, 0.5)
        except RuntimeError:
            refused.append(text)
    assert refused == REFUSED, set(REFUSED) - set(refused)
    return {"tool": TOOL, "q": ANGLES, "expressions": rows, "refused": refused}


def functions():
    random = numpy.random.RandomState(7)
    rows = []

    def add(kind, data, function, points):
        values = []
        for x in points:
            vector = opensim.Vector(1, float(x))
            first, second = opensim.StdVectorInt(), opensim.StdVectorInt()
            first.append(0)
            second.append(0)
            second.append(0)
            values.append([float(x), function.calcValue(vector), function.calcDerivative(first, vector), function.calcDerivative(second, vector)])
        rows.append({"kind": kind, **data, "values": values})

    for n in [2, 3, 4, 5, 6, 9, 15, 40]:
        x = numpy.sort(random.uniform(-2, 2, n))
        y = random.uniform(-1, 1, n)
        spline = opensim.SimmSpline()
        lines = opensim.PiecewiseLinearFunction()
        for a, b in zip(x, y):
            spline.addPoint(float(a), float(b))
            lines.addPoint(float(a), float(b))
        inside = random.uniform(x[0], x[-1], 12)
        points = [x[0] - 1, x[0] - 1e-3, x[-1] + 1e-3, x[-1] + 2, *inside]
        data = {"x": x.tolist(), "y": y.tolist()}
        add("simm_spline", data, spline, [*points, *x])
        add("piecewise_linear", data, lines, points)
    own = numpy.random.RandomState(8)
    for n in [4, 5, 6, 9, 15, 40]:
        x = numpy.sort(own.uniform(-2, 2, n))
        y = own.uniform(-1, 1, n)
        spline = opensim.GCVSpline()
        spline.setDegree(3)
        for a, b in zip(x, y):
            spline.addPoint(float(a), float(b))
        inside = own.uniform(x[0], x[-1], 12)
        add("gcv_spline_cubic", {"x": x.tolist(), "y": y.tolist()}, spline, [x[0] - 1, x[0] - 1e-3, x[-1] + 1e-3, x[-1] + 2, *inside, *x])
    points = [-1.5, -0.2, 0.0, 0.4, 2.0]
    coefficients = opensim.Vector(4, 0.0)
    for i, c in enumerate([0.5, -1.5, 2.0, 0.25]):
        coefficients[i] = c
    add("polynomial_highest_first", {"coefficients": [0.5, -1.5, 2.0, 0.25]}, opensim.PolynomialFunction(coefficients), points)
    sine = opensim.Sine(1.5, 2.0, 0.3, 0.7)
    rows.append({"kind": "sine", "parameters": [1.5, 2.0, 0.3, 0.7],
                 "values": [[x, sine.calcValue(opensim.Vector(1, x))] for x in points]})
    return {"tool": TOOL, "functions": rows}


def vector(v):
    return [v.get(i) for i in range(3)]


def model_reference(path):
    model = opensim.Model(str(path))
    state = model.initSystem()
    coordinates = model.getCoordinateSet()
    names = [coordinates.get(i).getName() for i in range(coordinates.getSize())]
    random = numpy.random.RandomState(11)
    cases = []
    for _ in range(12):
        q = random.uniform(-0.9, 0.9, len(names))
        for i, value in enumerate(q):
            coordinates.get(i).setLocked(state, False)
            coordinates.get(i).setValue(state, float(value), False)
        model.realizeVelocity(state)
        bodies = {}
        for body in model.getBodyList():
            pose = body.getTransformInGround(state)
            rotation = [[pose.R().get(i, j) for j in range(3)] for i in range(3)]
            bodies[body.getName()] = {"origin": vector(pose.p()), "R": rotation}
        forces = {}
        for force in model.getForceSet():
            kind = force.getConcreteClassName()
            if force.get_appliesForce() and (kind.startswith("Coordinate") and kind.endswith("LimitForce") or "Generalized" in kind or "Expression" in kind):
                forces[force.getName()] = force.getRecordValues(state).get(0)
        markers = {m.getName(): vector(m.getLocationInGround(state)) for m in model.getMarkerSet()}
        cases.append({"q": q.tolist(), "bodies": bodies, "forces": forces, "markers": markers})
    coupled = []
    for value in [-1.3, -0.4, 0.2, 0.9, 1.7] if "slide" in names else []:
        coordinates.get("pin_angle").setClamped(state, False)
        coordinates.get("pin_angle").setValue(state, value, True)
        coupled.append([value, coordinates.get("slide").getValue(state)])
    kinds = {n: coordinates.get(n).getMotionType() for n in names}
    ranges = {n: [coordinates.get(n).getRangeMin(), coordinates.get(n).getRangeMax()] for n in names}
    defaults = {n: coordinates.get(n).getDefaultValue() for n in names}
    mass = model.getTotalMass(state)
    return {"file": path.name, "coordinates": names, "motion_type": kinds, "default": defaults, "mass": mass,
            "range": {n: [str(v) if math.isinf(v) else v for v in r] for n, r in ranges.items()},
            "coupled_pin_angle_slide": coupled, "cases": cases}


def models():
    # One process each: OpenSim keeps the <defaults> of a model for all that are read after it.
    paths = sorted((HERE / "models").glob("joints_*.osim"))
    with multiprocessing.get_context("spawn").Pool(1, maxtasksperchild=1) as pool:
        return {"tool": TOOL, "models": pool.map(model_reference, paths, chunksize=1)}


PUBLISHED = ["Rajagopal2015.osim", "Model_Pose2Sim_simple.osim", "Model_Pose2Sim_muscles_flex.osim", "MoBL_ARMS_J.osim",
             "gait14dof22musc_20170320.osim", "gait9dof18musc.osim", "gait14dof22musc_pros_20180507.osim"]


def torque_reference(path):
    """Inverse dynamics at rest without any force: raw rows, and rows with followers folded in by OpenSim's derivatives."""
    first = opensim.StdVectorInt()
    first.append(0)
    forced = opensim.Model(str(path))
    forced_state = forced.initSystem()
    kinds = ["CoordinateLimitForce", "SpringGeneralizedForce"]
    springs = [f for f in forced.getForceSet() if f.getConcreteClassName() in kinds and f.get_appliesForce()]
    model = opensim.Model(str(path))
    model.updForceSet().clearAndDestroy()
    state = model.initSystem()
    coordinates = model.getCoordinateSet()
    every = [coordinates.get(i) for i in range(coordinates.getSize())]
    constraints = [model.getConstraintSet().get(i) for i in range(model.getConstraintSet().getSize())]
    couplers = [opensim.CoordinateCouplerConstraint.safeDownCast(c) for c in constraints]
    scale = lambda c: opensim.PropertyHelper.getValueDouble(c.getPropertyByName("scale_factor"))
    couplings = {}
    for c in couplers:
        couplings[c.getDependentCoordinateName()] = (c.getIndependentCoordinateNames().get(0), c.getFunction(), scale(c))
    mass = model.getTotalMass(state)

    def place(q):
        def value(name):
            if name not in couplings:
                return q[name]
            independent, function, factor = couplings[name]
            return factor * function.calcValue(opensim.Vector(1, value(independent)))

        values = {c.getName(): value(c.getName()) for c in every}
        for c in every:
            c.setLocked(state, False)
            c.setValue(state, values[c.getName()], False)
        model.realizePosition(state)
        return values

    # Which of the solver's rows belongs to which coordinate.
    row = {}
    for c in every:
        c.setLocked(state, False)
        c.setSpeedValue(state, 1.0)
        row[c.getName()] = max(range(state.getNU()), key=lambda i: abs(state.getU().get(i)))
        c.setSpeedValue(state, 0.0)
    assert sorted(row.values()) == list(range(len(every)))
    solver = opensim.InverseDynamicsSolver(model)
    random = numpy.random.RandomState(23)
    cases = []
    for _ in range(3):
        q = {}
        for c in every:
            low, high = max(c.getRangeMin(), -1.0), min(c.getRangeMax(), 1.0)
            q[c.getName()] = float(random.uniform(low, high)) if low < high else c.getDefaultValue()
        values = place(q)
        model.realizeVelocity(state)
        torques = solver.solve(state)
        raw = {name: torques.get(i) for name, i in row.items()}
        center = vector(model.calcMassCenterPosition(state))
        folded = {name: 0.0 for name in q if name not in couplings}
        for name, torque in raw.items():
            while name in couplings:
                independent, function, factor = couplings[name]
                torque *= factor * function.calcDerivative(first, opensim.Vector(1, values[independent]))
                name = independent
            folded[name] += torque
        passive = {}
        for c in every:
            own = forced.getCoordinateSet().get(c.getName())
            own.setLocked(forced_state, False)
            own.setValue(forced_state, values[c.getName()], False)
        forced.realizeVelocity(forced_state)
        for force in springs:
            name = force.getPropertyByName("coordinate").toString().strip("()")
            passive[name] = passive.get(name, 0.0) + force.getRecordValues(forced_state).get(0)
        cases.append({"q": values, "passive": passive, "raw": raw, "folded": folded, "center": center})
    return {"file": path.name, "mass": mass, "cases": cases}


def torques(folder):
    paths = [HERE / "models/coupled.osim"]
    kept = []
    if folder:
        paths += [pathlib.Path(folder) / name for name in PUBLISHED]
    elif (HERE / "data/opensim_torques.json").exists():
        kept = json.loads((HERE / "data/opensim_torques.json").read_text())["models"][1:]
    with multiprocessing.get_context("spawn").Pool(1, maxtasksperchild=1) as pool:
        return {"tool": TOOL, "models": pool.map(torque_reference, paths, chunksize=1) + kept}


def main():
    (HERE / "data").mkdir(exist_ok=True)
    folder = sys.argv[1] if len(sys.argv) > 1 else None
    for name, make in [("expressions", expressions), ("functions", functions), ("models", models), ("torques", lambda: torques(folder))]:
        text = json.dumps(make(), allow_nan=True).replace("-Infinity", '"-inf"').replace("Infinity", '"inf"').replace("NaN", '"nan"')
        (HERE / f"data/opensim_{name}.json").write_text(text.replace("}, {", "},\n{") + "\n")


if __name__ == "__main__":
    main()
