#!/usr/bin/env python3
"""Compares, in OpenSim 4.6, the muscles of a model with those of the file that `convert` makes of it: lengths, moment arms, forces at five postures.

    python3 -m venv venv && venv/bin/pip install opensim==4.6 numpy
    venv/bin/python scripts/converted_muscles.py PROGRAM MODEL.osim...

PROGRAM: the program `contrapposto`. Ends with an error beyond 1e-9 m of length, 1e-8 m of moment arm, 1e-7 of the greatest force, and where muscles, wrap objects or
markers are missing. Both models get the same coordinates by name. Moment arms: those of all pairs of a muscle and a coordinate. Forces: tendons'
in equilibrium at activations of 0.05 and 1.
"""

import pathlib
import subprocess
import sys
import tempfile

import numpy
import opensim

POSTURES = 5
LIMITS = {"length": 1e-9, "arm": 1e-8, "force": 1e-7, "marker": 1e-9}


class Body:
    def __init__(self, path):
        self.model = opensim.Model(str(path))
        # Coordinates that follow others are solved for, by default to 1e-9.
        self.model.set_assembly_accuracy(1e-13)
        self.state = self.model.initSystem()
        every = lambda of: {of.get(i).getName(): of.get(i) for i in range(of.getSize())}
        self.coordinates = every(self.model.getCoordinateSet())
        self.muscles = every(self.model.getMuscles())
        self.markers = every(self.model.getMarkerSet())
        bodies = self.model.getBodySet()
        wraps = [bodies.get(i).getWrapObjectSet() for i in range(bodies.getSize())] + [self.model.getGround().getWrapObjectSet()]
        self.wraps = sum(of.getSize() for of in wraps)

    def pose(self, values):
        for name, value in values.items():
            if name in self.coordinates and not self.coordinates[name].isDependent(self.state):
                self.coordinates[name].setLocked(self.state, False)
                self.coordinates[name].setValue(self.state, value, False)
        self.model.assemble(self.state)
        self.model.realizePosition(self.state)

    def force(self, muscle, activation):
        muscle.setActivation(self.state, activation)
        self.model.realizeVelocity(self.state)
        muscle.computeEquilibrium(self.state)
        self.model.realizeDynamics(self.state)
        return muscle.getTendonForce(self.state)


def compared(program, path, folder):
    converted = pathlib.Path(folder) / f"converted_{pathlib.Path(path).name}"
    subprocess.run([program, "convert", str(path), str(converted)], check=True, capture_output=True)
    first, second = Body(path), Body(converted)
    for what in ("coordinates", "muscles", "markers"):
        missing = set(getattr(first, what)) - set(getattr(second, what))
        assert not missing, f"{what} missing: {sorted(missing)}"
    assert first.wraps == second.wraps, f"{first.wraps} wrap objects, {second.wraps} in the converted model"
    rng, worst, pairs = numpy.random.default_rng(19), dict.fromkeys(LIMITS, 0.0), 0
    for _ in range(POSTURES):
        values = {}
        for name, coordinate in first.coordinates.items():
            low, high = max(coordinate.getRangeMin(), -1.0), min(coordinate.getRangeMax(), 1.0)
            values[name] = float(rng.uniform(low, high)) if low < high else coordinate.getDefaultValue()
        for body in (first, second):
            body.pose(values)
        for name, muscle in first.muscles.items():
            other = second.muscles[name]
            worst["length"] = max(worst["length"], abs(muscle.getLength(first.state) - other.getLength(second.state)))
            for coordinate, of in first.coordinates.items():
                arm = muscle.computeMomentArm(first.state, of)
                pairs += 1
                worst["arm"] = max(worst["arm"], abs(arm - other.computeMomentArm(second.state, second.coordinates[coordinate])))
            for activation in (0.05, 1.0):
                forces = [body.force(of, activation) for body, of in ((first, muscle), (second, other))]
                worst["force"] = max(worst["force"], abs(forces[0] - forces[1]) / muscle.getMaxIsometricForce())
        for name, marker in first.markers.items():
            apart = [marker.getLocationInGround(first.state).get(k) - second.markers[name].getLocationInGround(second.state).get(k) for k in range(3)]
            worst["marker"] = max(worst["marker"], float(numpy.abs(apart).max()))
    print(f"{pathlib.Path(path).name}: {len(first.muscles)} muscles, {first.wraps} wrap objects, {len(first.markers)} markers, {pairs} pairs; " + ", ".join(f"{k} {v:.1e}" for k, v in worst.items()), flush=True)
    return all(worst[kind] <= limit for kind, limit in LIMITS.items())


def main():
    opensim.Logger.setLevelString("error")
    opensim.Logger.removeFileSink()
    program, *models = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        same = [compared(program, path, folder) for path in models]
    sys.exit(0 if all(same) else "the converted model differs")


if __name__ == "__main__":
    main()
