#!/usr/bin/env python3
"""Compares the equilibria of all muscles of OpenSim models with OpenSim 4.6, in random postures, at three activations.

    cargo build --release && python3 -m venv venv && venv/bin/pip install opensim==4.6 numpy
    venv/bin/python scripts/opensim_equilibria.py 200 Rajagopal2016.osim gait2392_thelen2003muscle.osim

Prints, of each model and activation, the greatest difference of a tendon's force over the muscle's greatest isometric force, and the muscles of
which only one of the two programs finds an equilibrium. A row a difference above 1e-6.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy
import opensim

PROGRAM = Path(__file__).resolve().parent.parent / "target/release/contrapposto"
SEED = 7
SAID = 1e-6


def postures(model, state, coordinates, count):
    random = numpy.random.default_rng(SEED)
    rows = []
    for _ in range(count):
        for coordinate in coordinates:
            if coordinate.isDependent(state) or coordinate.getLocked(state):
                continue
            low, high = max(coordinate.getRangeMin(), -2.0), min(coordinate.getRangeMax(), 2.0)
            if low < high:
                coordinate.setValue(state, float(random.uniform(low, high)), False)
        model.assemble(state)
        rows.append([coordinate.getValue(state) for coordinate in coordinates])
    return rows


def ours(path, coordinates, rows, activation):
    with tempfile.TemporaryDirectory() as folder:
        motion = Path(folder) / "postures.sto"
        names = "\t".join(["time"] + [coordinate.getName() for coordinate in coordinates])
        head = f"postures\nversion=1\nnRows={len(rows)}\nnColumns={len(coordinates) + 1}\ninDegrees=no\nendheader\n{names}\n"
        lines = ("\t".join(map(repr, [10.0 * k, *map(float, row)])) for k, row in enumerate(rows))
        motion.write_text(head + "\n".join(lines) + "\n")
        command = [PROGRAM, "muscles", path, motion, "--json", "--rule", "opensim", "--activation", str(activation)]
        found = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    return [json.loads(line) for line in found.splitlines()]


def compare(path, count):
    model = opensim.Model(path)
    model.set_assembly_accuracy(1e-13)
    state = model.initSystem()
    coordinates = [model.getCoordinateSet().get(i) for i in range(model.getCoordinateSet().getSize())]
    muscles = [model.getMuscles().get(i) for i in range(model.getMuscles().getSize())]
    rows = postures(model, state, coordinates, count)
    for activation in (0.01, 0.3, 1.0):
        known, apart, only_ours, only_theirs = ours(path, coordinates, rows, activation), [], 0, 0
        for k, row in enumerate(rows):
            for coordinate, value in zip(coordinates, row):
                if not coordinate.isDependent(state) and not coordinate.getLocked(state):
                    coordinate.setValue(state, value, False)
            model.assemble(state)
            for muscle in muscles:
                muscle.setActivation(state, activation)
            model.realizeVelocity(state)
            for muscle in muscles:
                name = muscle.getName()
                try:
                    muscle.computeEquilibrium(state)
                    model.realizeDynamics(state)
                    theirs = muscle.getTendonForce(state)
                except RuntimeError:
                    theirs = float("nan")
                force = known[k]["tendon_forces_n"][name]
                if not numpy.isfinite(theirs):
                    only_ours += 1
                elif not numpy.isfinite(force):
                    only_theirs += 1
                else:
                    apart.append(abs(force - theirs) / muscle.getMaxIsometricForce())
                    if apart[-1] > SAID:
                        along = muscle.getFiberLengthAlongTendon(state)
                        print(f"  posture {k}, {name}: {force:.6g} N, OpenSim {theirs:.6g} N, its fibres' length along the tendon {along:.4g} m")
        print(f"{Path(path).name}, activation {activation}: {len(apart)} muscles, {max(apart):.1e} apart at most; equilibrium of only one: "
              f"ours {only_ours}, OpenSim {only_theirs}", flush=True)


def main():
    opensim.Logger.setLevelString("off")
    for path in sys.argv[2:]:
        compare(path, int(sys.argv[1]))


if __name__ == "__main__":
    main()
