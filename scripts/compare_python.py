#!/usr/bin/env python3
"""Processor time of torques of many postures from Python: ours, a loop over Pinocchio, and a loop over OpenSim, in one run.

    python3 -m venv venv && venv/bin/pip install ./python pin==4.1.0 opensim==4.6
    venv/bin/python scripts/compare_python.py

The body is the built-in adult, written as URDF and .osim by the program. Ours gives external, passive and active torque; Pinocchio's
loop gives gravity torque (`computeGeneralizedGravity`), OpenSim's the torques of
its `InverseDynamicsSolver` at rest. Each number is the least of five rounds, microseconds of one thread's processor time
a posture. Deterministic: fixed seed.
"""

import pathlib
import tempfile
import time

import numpy
import opensim
import pinocchio

import contrapposto
from contrapposto._native import run_program

POSTURES = 10_000
FEW = 500
ROUNDS = 5


def microseconds(job, postures):
    """Least processor time of a posture."""
    found = []
    for _ in range(ROUNDS):
        start = time.thread_time()
        job()
        found.append(1e6 * (time.thread_time() - start) / postures)
    return min(found)


def ours():
    model = contrapposto.Model.adult()
    low, high = model.ranges.T
    q = numpy.random.default_rng(1).uniform(low, high, (POSTURES, len(low)))
    yield "ours: external, passive and active torque, (10,000, 43)", microseconds(lambda: model.torques(q), POSTURES)
    yield "ours: one posture a call", microseconds(lambda: [model.torques(row) for row in q[:FEW]], FEW)
    yield "ours: gradient, (500, 43, 43)", microseconds(lambda: model.gradient(q[:FEW]), FEW)


def of_pinocchio(path):
    model = pinocchio.buildModelFromUrdf(str(path))
    data = model.createData()
    random = numpy.random.default_rng(1)
    low, high = numpy.maximum(model.lowerPositionLimit, -3), numpy.minimum(model.upperPositionLimit, 3)
    q = random.uniform(low, high, (POSTURES, model.nq))
    out = numpy.empty((POSTURES, model.nv))

    def job():
        for i, row in enumerate(q):
            out[i] = pinocchio.computeGeneralizedGravity(model, data, row)

    yield f"Pinocchio {pinocchio.__version__}, a loop: gravity torque of {model.nv} rates", microseconds(job, POSTURES)


def of_opensim(path):
    opensim.Logger.setLevelString("off")
    opensim.Logger.removeFileSink()
    model = opensim.Model(str(path))
    state = model.initSystem()
    solver = opensim.InverseDynamicsSolver(model)
    random = numpy.random.default_rng(1)
    q = [opensim.Vector.createFromMat(row) for row in random.uniform(-0.5, 0.5, (FEW, state.getNQ()))]
    at_rest = opensim.Vector(state.getNU(), 0.0)

    def job():
        for row in q:
            state.setQ(row)
            solver.solve(state, at_rest)

    yield f"OpenSim {opensim.GetVersion()}, a loop: inverse dynamics at rest", microseconds(job, FEW)


def main():
    with tempfile.TemporaryDirectory() as folder:
        urdf, osim = (pathlib.Path(folder) / f"adult.{ending}" for ending in ("urdf", "osim"))
        for path in (urdf, osim):
            assert run_program(["contrapposto", "convert", "adult", str(path)]) == 0
        for rows in (ours(), of_pinocchio(urdf), of_opensim(osim)):
            for what, time_of in rows:
                print(f"{time_of:8.2f}  {what}")


main()
