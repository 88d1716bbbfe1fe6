#!/usr/bin/env python3
"""Scaled models of published OpenSim pipelines by OpenSim 4.6 and by contrapposto, on the same files.

    python3 -m venv venv && venv/bin/pip install opensim==4.6 numpy
    cargo build --release
    venv/bin/python scripts/scale_peer.py MODELS [PROGRAM]

MODELS is a checkout of the `opensim-models` repository, which is not a part of this project. OpenSim reads both scaled models, so that the
comparison does not depend on our reader. Its tool solves the static posture, in which markers are placed, with the accuracy 1e-4; so
markers are compared before they are placed, with those that OpenSim's tool places, and with those that OpenSim's solver places with the
accuracy 1e-9.
"""

import pathlib
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree

import numpy
import opensim

REPOSITORY = pathlib.Path(__file__).resolve().parent.parent
PIPELINES = {  # name: model, setup, markers
    "gait2392": ("Models/Gait2392_Simbody/gait2392_thelen2003muscle.osim", "Pipelines/Gait2392_Simbody/subject01_Setup_Scale.xml", "Pipelines/Gait2392_Simbody/subject01_static.trc"),
    "gait2392, Millard": ("Models/Gait2392_Simbody/gait2392_millard2012muscle.osim", "Pipelines/Gait2392_Simbody/subject01_Setup_Scale.xml", "Pipelines/Gait2392_Simbody/subject01_static.trc"),
    "gait2354": ("Models/Gait2354_Simbody/gait2354_simbody.osim", "Pipelines/Gait2354_Simbody/subject01_Setup_Scale.xml", "Pipelines/Gait2354_Simbody/subject01_static.trc"),
    "Hamner": ("Pipelines/Hamner/FullBodyModel_Hamner2010_v2_0.osim", "Pipelines/Hamner/Setup_Scale.xml", "Pipelines/Hamner/subject02_static.trc"),
    "Rajagopal, walking": ("Models/Rajagopal/Rajagopal2016.osim", "Pipelines/Rajagopal/Scale/scale_setup_walk_scaleOnly.xml", "Pipelines/Rajagopal/ExpData/static_walk_1.trc"),
    "Rajagopal, running": ("Models/Rajagopal/Rajagopal2016.osim", "Pipelines/Rajagopal/Scale/scale_setup_run.xml", "Pipelines/Rajagopal/ExpData/static_run.trc"),
}
LARGEST_DIFFERENCE = 1e-9  # of masses (of a kilogram), lengths (m), inertia (kg m^2)
LARGEST_LENGTH_OF_MUSCLE = 1e-7  # m
LARGEST_MARKER = 1e-4  # m, markers placed with the accuracy 1e-9
opensim.Logger.setLevelString("off")
opensim.Logger.removeFileSink()


def setup_for_opensim(folder, model, setup, markers):
    """The setup file with absolute names of files; the two models that OpenSim writes."""
    tree = xml.etree.ElementTree.parse(setup)
    put = lambda node, key, text: [setattr(e, "text", str(text)) for e in node.iter(key)]
    put(tree, "model_file", model)
    put(tree, "marker_file", markers)
    for element in tree.iter("marker_set_file"):
        if (element.text or "").strip() not in ("", "Unassigned"):
            element.text = str(setup.parent / element.text.strip())
    written = []
    for part, name in (("ModelScaler", "scaled.osim"), ("MarkerPlacer", "placed.osim")):
        node = next(tree.iter(part))
        for key in ("output_scale_file", "output_motion_file", "output_marker_file"):
            put(node, key, "Unassigned")
        for element in node.findall("output_model_file"):
            node.remove(element)
        xml.etree.ElementTree.SubElement(node, "output_model_file").text = str(folder / name)
        written.append(folder / name)
    path = folder / "setup.xml"
    tree.write(path)
    return path, written


def without_placer(setup, folder):
    """The setup file with no placing of markers, for our program; beside the original one, whose folder its file of markers is in."""
    tree = xml.etree.ElementTree.parse(setup)
    placer = next(tree.iter("MarkerPlacer"))
    for element in placer.findall("apply"):
        placer.remove(element)
    xml.etree.ElementTree.SubElement(placer, "apply").text = "false"
    for element in tree.iter("marker_set_file"):
        name = (element.text or "").strip()
        if name not in ("", "Unassigned"):
            (folder / name).write_bytes((setup.parent / name).read_bytes())
    path = folder / "without_placer.xml"
    tree.write(path)
    return path


def vector(v):
    return numpy.array([v.get(i) for i in range(v.size())])


class Numbers:
    """All numbers of a model that scaling changes, by name."""

    def __init__(self, path):
        self.model = model = opensim.Model(str(path))
        state = model.initSystem()
        self.masses, self.lengths, self.inertia, self.markers, self.muscles = {}, {}, {}, {}, {}
        for body in model.getBodyList():
            name = body.getName()
            self.masses[name] = numpy.array([body.getMass()])
            self.lengths[name] = vector(body.get_mass_center())
            inertia = body.getInertia()
            self.inertia[name] = numpy.concatenate([vector(inertia.getMoments()), vector(inertia.getProducts())])
        for frame in model.getComponentsList():
            offset = opensim.PhysicalOffsetFrame.safeDownCast(frame)
            if offset is not None:
                self.lengths[frame.getAbsolutePathString()] = vector(offset.get_translation())
            station = opensim.PathPoint.safeDownCast(frame)
            if station is not None:
                self.lengths[frame.getAbsolutePathString()] = vector(station.get_location())
            marker = opensim.Marker.safeDownCast(frame)
            if marker is not None:
                self.markers[frame.getName()] = vector(marker.get_location())
            for kind in ("WrapCylinder", "WrapEllipsoid", "WrapSphere", "WrapTorus"):
                surface = getattr(opensim, kind).safeDownCast(frame)
                if surface is not None:
                    self.lengths[frame.getAbsolutePathString()] = vector(surface.get_translation())
                if surface is not None and kind == "WrapCylinder":
                    self.lengths[frame.getAbsolutePathString() + "/size"] = numpy.array([surface.get_radius(), surface.get_length()])
                if surface is not None and kind == "WrapEllipsoid":
                    self.lengths[frame.getAbsolutePathString() + "/size"] = vector(surface.get_dimensions())
        # Joints: places of all bodies in some postures.
        coordinates = model.getCoordinateSet()
        for posture in range(3):
            for i in range(coordinates.getSize()):
                c = coordinates.get(i)
                if not c.isConstrained(state) and not c.get_locked():
                    middle = 0.5 * (c.getRangeMin() + c.getRangeMax())
                    c.setValue(state, [0.0, middle, 0.7 * c.getRangeMax()][posture], False)
            model.assemble(state)
            model.realizePosition(state)
            for body in model.getBodyList():
                self.lengths[f"{body.getName()} in posture {posture}"] = vector(body.getPositionInGround(state))
            if posture == 1:
                for muscle in model.getMuscles():
                    self.muscles[muscle.getName() + ", path"] = numpy.array([muscle.getLength(state)])
        for muscle in model.getMuscles():
            self.muscles[muscle.getName()] = numpy.array([muscle.getOptimalFiberLength(), muscle.getTendonSlackLength()])


def placed_accurately(scaled, setup, markers):
    """Places of the markers of OpenSim's scaled model that are not fixed, by its solver with the accuracy 1e-9."""
    placer = next(xml.etree.ElementTree.parse(setup).iter("MarkerPlacer"))
    first, last = (float(word) for word in placer.findtext("time_range").split())
    table = opensim.TimeSeriesTableVec3(str(markers))
    times, labels = table.getIndependentColumn(), list(table.getColumnLabels())
    scale = {"mm": 1e-3, "m": 1.0}[table.getTableMetaDataString("Units")]
    mean_of = lambda rows: scale * numpy.mean([[vector(table.getRowAtIndex(i)[j]) for j in range(len(labels))] for i in rows], axis=0)
    mean = mean_of([i for i, t in enumerate(times) if max(first, times[0]) <= t <= min(last, times[-1])])
    begin = max([i for i, t in enumerate(times) if t <= first], default=0)  # OpenSim's averageFrames has other ends
    end = min([i for i, t in enumerate(times) if t >= last - 2e-16 and i >= begin], default=len(times) - 1)
    measured = mean_of(range(begin, end + 1))
    applied = lambda kind: [t for t in placer.iter(kind) if t.findtext("apply", "true").strip() == "true"]
    weights, wanted = opensim.SetMarkerWeights(), opensim.SimTKArrayCoordinateReference()
    for task in applied("IKMarkerTask"):
        weights.cloneAndAppend(opensim.MarkerWeight(task.get("name"), float(task.findtext("weight", "0"))))
    model = opensim.Model(str(scaled))
    state = model.initSystem()
    for task in applied("IKCoordinateTask"):
        value = model.getCoordinateSet().get(task.get("name")).getDefaultValue()
        if task.findtext("value_type", "default_value").strip() == "manual_value":
            value = float(task.findtext("value", "0"))
        reference = opensim.CoordinateReference(task.get("name"), opensim.Constant(value))
        reference.setWeight(float(task.findtext("weight", "0")))
        wanted.push_back(reference)
    frame, row = opensim.TimeSeriesTableVec3(), opensim.RowVectorVec3(len(labels))
    for j, place in enumerate(mean):
        row[j] = opensim.Vec3(*place)
    frame.appendRow(0.0, row)
    frame.setColumnLabels(labels)
    frame.addTableMetaDataString("Units", "m")
    solver = opensim.InverseKinematicsSolver(model, opensim.MarkersReference(frame, weights), wanted, float("inf"))
    solver.setAccuracy(1e-9)
    solver.assemble(state)
    model.realizePosition(state)
    places = {}
    for i in range(model.getMarkerSet().getSize()):
        marker = model.getMarkerSet().get(i)
        if marker.getName() in labels and not marker.get_fixed():
            point = opensim.Vec3(*measured[labels.index(marker.getName())])
            places[marker.getName()] = vector(model.getGround().findStationLocationInAnotherFrame(state, point, marker.getParentFrame()))
    return places


def apart(a, b):
    """Largest difference, and its name; both must have the same names."""
    if a.keys() != b.keys():
        only = sorted(a.keys() ^ b.keys())
        return float("inf"), f"{len(only)} are in one model only: {only[:3]}"
    if not a:
        return 0.0, "none"
    differences = {name: numpy.abs(a[name] - b[name]).max() for name in a}
    worst = max(differences, key=differences.get)
    return differences[worst], worst


def compare(models, name, program):
    model, setup, markers = (models / part for part in PIPELINES[name])
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        path, [scaled, placed] = setup_for_opensim(folder, model, setup, markers)
        tool = opensim.ScaleTool(str(path))
        tool.setPathToSubject("")
        begin = time.perf_counter()
        if not tool.run():
            sys.exit(f"{name}: OpenSim refuses")
        theirs = time.perf_counter() - begin
        command = [program, "scale", model, markers]
        begin = time.perf_counter()
        subprocess.run([*command, "--setup", setup, "--out", folder / "ours.osim"], check=True, capture_output=True)
        ours = time.perf_counter() - begin
        plain = without_placer(setup, folder)
        subprocess.run([*command, "--setup", plain, "--out", folder / "ours_scaled.osim"], check=True, capture_output=True)
        a, b = Numbers(scaled), Numbers(folder / "ours_scaled.osim")
        c, d = Numbers(placed), Numbers(folder / "ours.osim")
        accurate = placed_accurately(scaled, setup, markers)
    held = True
    for kind, unit, limit in (
        ("masses", "kg", LARGEST_DIFFERENCE),
        ("lengths", "m", LARGEST_DIFFERENCE),
        ("inertia", "kg m^2", LARGEST_DIFFERENCE),
        ("markers", "m", LARGEST_DIFFERENCE),
        ("muscles", "m", LARGEST_LENGTH_OF_MUSCLE),
    ):
        most, worst = apart(getattr(a, kind), getattr(b, kind))
        held &= most <= limit
        print(f"{name}: {len(getattr(a, kind))} {kind}, at most {most:.1e} {unit} apart ({worst})")
    most, worst = apart(c.markers, d.markers)
    held &= most < float("inf")  # the same markers
    print(f"{name}: {len(c.markers)} placed markers, at most {most:.1e} m apart ({worst})")
    most, worst = apart(accurate, {marker: d.markers[marker] for marker in accurate})
    held &= most <= LARGEST_MARKER
    print(f"{name}: {len(accurate)} markers placed with the accuracy 1e-9, at most {most:.1e} m apart ({worst})")
    print(f"{name}: {theirs:.2f} s by OpenSim, {ours:.2f} s by contrapposto")
    return held


def main():
    program = sys.argv[2] if len(sys.argv) > 2 else str(REPOSITORY / "target/release/contrapposto")
    models = pathlib.Path(sys.argv[1]).resolve()
    held = [compare(models, name, program) for name in PIPELINES]
    sys.exit(0 if all(held) else "a limit of this script is not kept")


if __name__ == "__main__":
    main()
