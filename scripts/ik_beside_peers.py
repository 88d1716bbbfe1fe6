"""Inverse kinematics beside placo and mink, on targets drawn anew, in turns in one run on one core; prints the tables of docs/benchmarks.md.

    cargo bench -p contrapposto-formats --bench reach --no-run          # names the executable
    taskset -c 0 venv/bin/python scripts/ik_beside_peers.py EXECUTABLE ../shared SEED [COUNT] [BEYOND]

EXECUTABLE is that of the benchmark `reach`; the folder `shared` holds the peers' problem and their back ends (`peers/bench`); the
environment has placo, mink, daqp and pin. COUNT targets within reach (default 2,000; the peers get the first 400 of them, as they take long) and BEYOND
targets out of reach (default 100; the peers make 300 steps). Times of one thread: ours by the wall clock, within reach the least of three runs a step;
those of the peers, whose runs are made once, processor time of their step alone. A step of a peer is the mean of a target's steps.
"""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

PEERS = {
    "placo, one weighted problem (step 0.1)": ("placo", dict(mode="soft", step=0.1)),
    "placo, feet and centre of mass strict (step 0.05)": ("placo", dict(mode="hard", step=0.05)),
    "mink, one weighted problem, damped": ("mink", dict(mode="soft", step=0.2, gain=1.0, lm=1.0)),
    "mink, feet and centre of mass strict, damped": ("mink", dict(mode="hard", step=0.2, gain=1.0, lm=1.0)),
}
BEYOND_PEERS = {
    "placo, feet and centre of mass strict (regularisation 1000)": ("placo", dict(mode="hard", step=0.05, reg=1000.0)),
    "mink, feet and centre of mass strict, damped": ("mink", dict(mode="hard", step=0.2, gain=1.0, lm=1.0)),
}
TARGETS_OF_PEERS = 400
STEPS = 300


def lay_out(shared: Path, root: Path) -> None:
    """The folders in which the peers' scripts look for models and targets."""
    models = root / "models"
    for folder in ("human-gazebo/humanSubject01", "neutral"):
        (models / folder).mkdir(parents=True)
    for source in (shared / "models/human-gazebo").iterdir():
        folder = "human-gazebo/humanSubject01" if source.suffix == ".urdf" else "neutral"
        if source.suffix in (".urdf", ".xml"):
            shutil.copy(source, models / folder)
    (root / "results").mkdir()
    shutil.copytree(shared / "vectors", root / "vectors")


def ours(executable: str, mode: str, seed: str, count: int) -> dict:
    """Name of a line of the benchmark to its numbers; the other lines under an empty name."""
    text = subprocess.run([executable, mode, seed, str(count)], capture_output=True, text=True, check=True).stdout
    found: dict = {"": []}
    for line in text.splitlines():
        name, _, rest = line.partition(": ")
        numbers = {key: float(value) for key, value in re.findall(r"(\w+) ([-\d.e]+)", rest)}
        if "p99" in numbers:
            found[name] = numbers
        else:
            found[""].append(line)
    return found


def back_end(peer: str, settings: dict):
    if peer == "placo":
        from ik_backend_placo import Placo

        return Placo(**settings)
    from ik_backends import Mink

    return Mink(**settings)


def main() -> None:
    executable, shared, seed = sys.argv[1], Path(sys.argv[2]).resolve(), sys.argv[3]
    count, beyond = (int(number) for number in (sys.argv[4:] + ["2000", "100"][len(sys.argv[4:]) :]))
    root = Path(tempfile.mkdtemp())
    lay_out(shared, root)
    os.environ["PEERS_ROOT"] = str(root)
    sys.path.insert(0, str(shared / "peers/bench"))
    import ik_harness as harness

    drawn = json.loads(subprocess.check_output([executable, "targets", seed, str(max(count, beyond))]))
    print(f"seed {seed}: {count} targets within reach ({min(count, TARGETS_OF_PEERS)} for the peers), {beyond} out of reach\n")
    print("| | Reached | Steps, median / most | Microseconds a step, median / mean / p99 | Milliseconds a posture, median / mean / slowest |")
    print("|---|---|---|---|---|")

    def row(name: str, reached: str, steps: tuple, step: tuple, posture: tuple) -> None:
        cells = (" / ".join(f"{x:.{d}f}" for x in xs) for xs, d in ((steps, 0), (step, 0), (posture, 2)))
        print(f"| {name} | {reached} | {' | '.join(cells)} |", flush=True)

    def our_row(name: str) -> None:
        found = ours(executable, "within", seed, count)
        missed = int(re.search(r"(\d+) of", found[""][-1]).group(1))
        step, posture, steps = found["ms a step"], found["ms a target"], found["steps"]
        us = (1e3 * step["median"], 1e3 * step["mean"], 1e3 * step["p99"])
        ms = (posture["median"], posture["mean"], posture["max"])
        row(name, f"{count - missed} of {count}", (steps["median"], steps["max"]), us, ms)

    our_row("contrapposto, five strict levels")
    for name, (peer, settings) in PEERS.items():
        targets = [dict(target=target) for target in drawn["within"][: min(count, TARGETS_OF_PEERS)]]
        rows = harness.run(back_end(peer, settings), targets, STEPS)
        ms = np.array([1e3 * r["cpu_s"] for r in rows])
        made = np.array([r["iterations"] for r in rows])
        each = 1e3 * ms / made
        reached = f"{sum(r['converged'] for r in rows)} of {len(rows)}"
        mean = 1e3 * ms.sum() / made.sum()
        us = (np.median(each), mean, np.percentile(each, 99))
        row(name, reached, (np.median(made), made.max()), us, (np.median(ms), ms.mean(), ms.max()))
    our_row("contrapposto again")

    print("\n| Out of reach | Steps, median | Microseconds a step, mean | Seconds, all targets | Feet, mm, most | Hand nearer than ours by over 1 mm |")
    print("|---|---|---|---|---|---|")

    def our_beyond(name: str) -> list:
        found = ours(executable, "solve", seed, beyond)
        total, steps = found["ms a target"]["total"], found["steps"]
        lines = [re.search(r"hand ([\d.]+) feet ([\d.e+-]+)", line) for line in found[""]]
        lines = [line for line in lines if line]
        feet = 1e3 * max(float(line.group(2)) for line in lines)
        print(f"| {name} | {steps['median']:.0f} | {1e3 * total / steps['total']:.0f} | {total / 1e3:.2f} | {feet:.1g} | |", flush=True)
        return [float(line.group(1)) for line in lines]

    hands = our_beyond("contrapposto, `solve`, three starts")
    for name, (peer, settings) in BEYOND_PEERS.items():
        solver = back_end(peer, settings)
        targets = [dict(target=target) for target in drawn["beyond"][:beyond]]
        rows = harness.run(solver, targets, STEPS, stop=False)
        seconds, steps = sum(r["cpu_s"] for r in rows), sum(r["iterations"] for r in rows)
        feet = 1e3 * max(r["final"]["foot"] for r in rows)
        held = [(r, hand) for r, hand in zip(rows, hands) if r["final"]["foot"] < 1e-3 and r["final"]["com"] < 1e-3]
        nearer = sum(r["final"]["hand"] < hand - 1e-3 for r, hand in held)
        print(f"| {name} | {STEPS} | {1e6 * seconds / steps:.0f} | {seconds:.2f} | {feet:.2g} | {nearer} of {len(held)} that hold feet and centre of mass to 1 mm |", flush=True)
    our_beyond("contrapposto again")
    print(f"\nload average {os.getloadavg()[0]:.1f}, {time.strftime('%Y-%m-%d')}")
    shutil.rmtree(root)


if __name__ == "__main__":
    main()
