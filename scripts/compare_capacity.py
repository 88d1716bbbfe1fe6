#!/usr/bin/env python3
"""Compares the forces of fixed arms with the force polytopes of pycapacity: vertices for a test, and times on one core.

    python3 -m venv /tmp/venv && /tmp/venv/bin/pip install pycapacity
    taskset -c 0 /tmp/venv/bin/python scripts/compare_capacity.py [--write]

--write stores pycapacity's vertices in crates/contrapposto-formats/tests/data/pycapacity.json.
"""

import json
import subprocess
import sys
import time
from importlib.metadata import version
from pathlib import Path

import numpy
from pycapacity.robot import force_polytope

ROOT = Path(__file__).resolve().parent.parent
STORED = ROOT / "crates/contrapposto-formats/tests/data/pycapacity.json"
ARMS = 12
REPEATS = 5


def bench(*args):
    command = ["cargo", "bench", "--quiet", "-p", "contrapposto-formats", "--bench", "capacity", "--", *args]
    lines = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout.splitlines()
    return [json.loads(line) for line in lines if line.startswith("{")]


def main():
    problems = bench("problems", str(ARMS))
    arms, times = [], []
    for problem in problems:
        jacobian = numpy.array(problem["jacobian"]).T
        least, greatest, bias = (numpy.array(problem[key]) for key in ("least", "greatest", "bias"))
        for _ in range(REPEATS):
            start = time.process_time()
            polytope = force_polytope(jacobian, greatest, least, bias)
            times.append(1e3 * (time.process_time() - start))
        # Which side the bias is on is judged by the torques of the vertices.
        torques = jacobian.T @ polytope.vertices + bias[:, None]
        excess = max((torques - greatest[:, None]).max(), (least[:, None] - torques).max())
        assert excess < 1e-6, f"arm {problem['number']}: a vertex exceeds a torque by {excess} N m"
        arms.append({"posture": problem["posture"], "vertices_n": polytope.vertices.T.tolist()})
    times.sort()
    for line in bench("time", "20"):
        print(f"contrapposto, {line['what']}: {line['least_ms']:.3f} ms at least, {line['median_ms']:.3f} ms median")
    print(f"pycapacity {version('pycapacity')}, right arm, fixed: {times[0]:.3f} ms at least, {times[len(times) // 2]:.3f} ms median "
          f"({len(arms)} arms)")
    if "--write" in sys.argv:
        source = f"pycapacity {version('pycapacity')}, robot.force_polytope; scripts/compare_capacity.py --write"
        STORED.write_text(json.dumps({"source": source, "arms": arms}, indent=1) + "\n")


if __name__ == "__main__":
    main()
