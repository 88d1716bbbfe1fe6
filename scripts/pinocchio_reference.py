#!/usr/bin/env python3
"""Reference numbers of URDF models, as Pinocchio resolves them.

    python3 -m venv pinvenv && pinvenv/bin/pip install pin==4.1.0 numpy
    pinvenv/bin/python scripts/pinocchio_reference.py [FOLDER]

Without FOLDER: of our own crates/contrapposto-formats/tests/models/humanoid.urdf, and of a published human with its root fixed that
lies beside the repository (../shared/models; only numbers are kept), in tests/data/pinocchio_{reference,human66_fixed}.json.
With FOLDER: of every .urdf in it, `MODEL.urdf.reference.json` beside each; the test `published_robots` of contrapposto-formats
compares us with them where CONTRAPPOSTO_ROBOT_MODELS names FOLDER. Humanoids and other robots: `pip download --no-deps
example-robot-data==6.0.0`, then unzip. Nothing of them is kept in the project. Deterministic: fixed seed.

Written in our conventions: external torque is minus the generalised gravity. A free joint's rates are three speeds along the
axes of the joint's own frame in its parent and three turning speeds about the child's own axes (Pinocchio has all six in the
child's), and those of a planar joint are in its parent's, too. Joints that mimic others stand in their place; `raw` has a row
for each, `torque` and everything after it has theirs folded into the joint that they mimic. A fixed root link counts.
"""

import json
import pathlib
import sys
import xml.etree.ElementTree

import numpy
import pinocchio

HERE = pathlib.Path(__file__).resolve().parent.parent / "crates/contrapposto-formats/tests"
PUBLISHED = HERE.parents[3] / "shared/models/human-gazebo/humanSubject01_66dof.urdf"
TOOL = f"pinocchio {pinocchio.__version__}, numpy {numpy.__version__}"
WORLD = pinocchio.ReferenceFrame.LOCAL_WORLD_ALIGNED


def mimics(path, joints):
    """Joints that mimic another one: which, how much, from where. Those that do not move, or whose other one is not there, do not."""
    found = {}
    for joint in xml.etree.ElementTree.parse(path).getroot().findall("joint"):
        mimic = joint.find("mimic")
        if mimic is not None and joint.get("name") in joints and mimic.get("joint") in joints:
            found[joint.get("name")] = (mimic.get("joint"), float(mimic.get("multiplier", 1)), float(mimic.get("offset", 0)))
    return found


def place(joint, name, own, q, values):
    """Writes a joint's q and our coordinates of it. `own`: angle or distance of a joint that has one, random numbers otherwise."""
    at = slice(joint.idx_q, joint.idx_q + joint.nq)
    if joint.nv == 1:
        values[name] = float(own)
        q[at] = own if joint.nq == 1 else [numpy.cos(own), numpy.sin(own)]
    elif joint.nq == 4:
        q[at] = [own[0], own[1], numpy.cos(own[2]), numpy.sin(own[2])]
        values.update(zip([f"{name}_{end}" for end in ("tx", "ty", "rz")], map(float, own)))
    else:
        x, y, z, w = own[3:7] / numpy.linalg.norm(own[3:7])
        q[at] = [*own[:3], x, y, z, w]
        values.update(zip([f"{name}_{end}" for end in ("tx", "ty", "tz", "qw", "qx", "qy", "qz")], map(float, [*own[:3], w, x, y, z])))


def rate_names(joint, name):
    ends = {1: [""], 3: ["_tx", "_ty", "_rz"], 6: ["_tx", "_ty", "_tz", "_mx", "_my", "_mz"]}[joint.nv]
    return [name + end for end in ends]


def turned(joint, q, force):
    """Pinocchio's speeds of a joint by ours, and how that matrix, transposed, turns with our rates under `force`."""
    speeds, turning = numpy.eye(joint.nv), numpy.zeros((joint.nv, joint.nv))
    if joint.nv == 6:
        x, y, z, w = q[joint.idx_q + 3 : joint.idx_q + 7]
        rotation = pinocchio.Quaternion(w, x, y, z).toRotationMatrix()
        speeds[:3, :3] = rotation.T
        turning[:3, 3:] = -rotation @ pinocchio.skew(force[:3])
    elif joint.nv == 3:
        cos, sin = q[joint.idx_q + 2 : joint.idx_q + 4]
        speeds[:2, :2] = [[cos, sin], [-sin, cos]]
        turning[:2, 2] = numpy.array([[-sin, -cos], [cos, -sin]]) @ force[:2]
    return speeds, turning


def case(model, data, joints, follow, random, links):
    q, values = pinocchio.neutral(model), {}
    for name, joint in joints.items():
        own = random.uniform(-1, 1, 7)
        if joint.nv == 1:
            low, high = (-3.0, 3.0) if joint.nq == 2 else (model.lowerPositionLimit[joint.idx_q], model.upperPositionLimit[joint.idx_q])
            low, high = max(low, -4.0), min(high, 4.0)
            own = random.uniform(low, high) if low < high else low
        place(joint, name, own, q, values)

    def value(name):
        if name not in follow:
            return values[name]
        independent, multiplier, offset = follow[name]
        return multiplier * value(independent) + offset

    fold = numpy.eye(model.nv)
    for name in follow:
        place(joints[name], name, value(name), q, values)
        independent, factor = name, 1.0
        while independent in follow:
            factor *= follow[independent][1]
            independent = follow[independent][0]
        fold[joints[name].idx_v, :] = 0
        fold[joints[name].idx_v, joints[independent].idx_v] = factor
    gravity = pinocchio.computeGeneralizedGravity(model, data, q).copy()
    slope = pinocchio.computeGeneralizedGravityDerivatives(model, data, q).copy()
    speeds, turning = numpy.eye(model.nv), numpy.zeros((model.nv, model.nv))
    for joint in joints.values():
        at = slice(joint.idx_v, joint.idx_v + joint.nv)
        speeds[at, at], turning[at, at] = turned(joint, q, gravity[at])
    raw = -speeds.T @ gravity
    gradient = -(speeds.T @ slope @ speeds + turning)
    fixed = model.inertias[0]
    center = pinocchio.centerOfMass(model, data, q).copy()
    jacobian = pinocchio.jacobianCenterOfMass(model, data, q).copy()
    moving = data.mass[0]
    mass = moving + fixed.mass
    if moving > 0:
        center = (moving * center + fixed.mass * fixed.lever) / mass
        jacobian = jacobian * moving / mass
    frames = {}
    for name, frame in links.items():
        rows = pinocchio.computeFrameJacobian(model, data, q, frame, WORLD) @ speeds @ fold
        pose = data.oMf[frame]
        frames[name] = {"position": pose.translation.tolist(), "rotation": pose.rotation.tolist(), "jacobian": rows.tolist()}
    return {
        "values": values,
        "raw": raw.tolist(),
        "torque": (fold.T @ raw).tolist(),
        "gradient": (fold.T @ gradient @ fold).tolist(),
        "center": center.tolist() if moving > 0 else None,
        "center_jacobian": (jacobian @ speeds @ fold).tolist() if moving > 0 else None,
        "mass": mass,
        "links": frames,
    }


def rooted(path, root, postures):
    free = [pinocchio.JointModelFreeFlyer()] if root == "free" else []
    model = pinocchio.buildModelFromUrdf(str(path), *free)
    data = model.createData()
    joints = {"root" if free and i == 1 else model.names[i]: model.joints[i] for i in range(1, model.njoints)}
    follow = mimics(path, joints)
    bodies = [(frame.name, i) for i, frame in enumerate(model.frames) if frame.type == pinocchio.FrameType.BODY]
    links = dict(bodies[:: max(1, len(bodies) // 4)])
    rates = [name for joint in joints.items() for name in rate_names(joint[1], joint[0])]
    random = numpy.random.RandomState(20)
    cases = [case(model, data, joints, follow, random, links) for _ in range(postures)]
    if follow:
        check_folding(path, free, joints, follow, cases)
    return {"root": root, "rates": rates, "followers": sorted(follow), "cases": cases}


def check_folding(path, free, joints, follow, cases):
    """Pinocchio's own mimic joints give the torques that we have folded. It builds them where dependent joints come after independent ones only."""
    try:
        model = pinocchio.buildModelFromUrdf(str(path), *free, mimic=True)
    except ValueError as refusal:
        print(f"{path.name}, mimic=True: {refusal}")
        return
    data = model.createData()
    for case in cases:
        q, rows = pinocchio.neutral(model), {}
        for i in range(1, model.njoints):
            name, joint = "root" if free and i == 1 else model.names[i], model.joints[i]
            if name in follow:
                continue
            theirs = joints[name]
            own = numpy.array([v for k, v in case["values"].items() if k == name or theirs.nv > 1 and k.startswith(name + "_")])
            if joint.nv == 6:
                own = own[[0, 1, 2, 4, 5, 6, 3]]
            place(joint, name, own if joint.nv > 1 else own[0], q, {})
            if joint.nv == 1:
                rows[theirs.idx_v] = joint.idx_v
        gravity = pinocchio.computeGeneralizedGravity(model, data, q)
        ours = numpy.array(case["torque"])
        worst = max((abs(ours[theirs] + gravity[row]) for theirs, row in rows.items()), default=0.0)
        assert worst < 1e-9 * max(1.0, numpy.abs(ours).max()), (path, worst)


def reference(path, postures, roots=("fixed", "free")):
    written = [rooted(path, root, postures) for root in roots]
    return {"made_by": "scripts/pinocchio_reference.py", "tool": TOOL, "model": path.name, "roots": written}


def keep(name, written):
    text = json.dumps(written).replace("-0.0,", "0.0,").replace("], [", "],\n[").replace("}, ", "},\n")
    (HERE / f"data/{name}.json").write_text(text + "\n")


def main():
    if len(sys.argv) < 2:
        keep("pinocchio_reference", reference(HERE / "models/humanoid.urdf", 3))
        if PUBLISHED.exists():
            keep("pinocchio_human66_fixed", reference(PUBLISHED, 2, ["fixed"]))
        return
    for path in sorted(pathlib.Path(sys.argv[1]).rglob("*.urdf")):
        try:
            written = reference(path, 20)
        except (ValueError, RuntimeError) as refusal:
            print(f"{path}: {refusal}")
            continue
        path.with_name(path.name + ".reference.json").write_text(json.dumps(written))
        print(f"{path}: {len(written['roots'][0]['rates'])} rates, {len(written['roots'][0]['followers'])} followers")


if __name__ == "__main__":
    main()
