#!/usr/bin/env python3
"""Least squares in strict priority, growing: our solver beside a hierarchical QP and a cascade of QPs, on the same problems.

    python3 -m venv peervenv
    peervenv/bin/pip install numpy==2.4.6 daqp==0.11.0 proxsuite==0.8.0 clarabel==0.11.1 scipy==1.17.1
    taskset -c 0 peervenv/bin/python scripts/compare_growth.py

The benchmark `solve` of `hierarchical-least-squares` writes its growing problems first, with our answers and least times (active set known, and cold).
DAQP solves all levels in one call (`break_points`); the others solve one QP a level, the rows of the levels above held as
equations where they came to. Every time is the solver's own, without python (DAQP and ProxQP: setting up and solving; Clarabel:
solving), summed over the levels, the least of all repetitions, cold. A residual that differs from ours by more than 1e-6 of its
length is marked with `!`.

Prints one table for Markdown, microseconds and how many times ours (active set known) it is.
"""

import importlib.metadata
import json
import os
import pathlib
import subprocess
import tempfile
import time

import clarabel
import daqp
import numpy as np
import scipy.sparse as sparse
from proxsuite import proxqp

HERE = pathlib.Path(__file__).resolve().parent.parent
SECONDS = 0.2
SAME = 1e-6


def problems(folder):
    """Our benchmark writes one file a problem."""
    command = ["cargo", "bench", "-q", "-p", "hierarchical-least-squares", "--bench", "solve", "--", "growth"]
    subprocess.run(command, cwd=HERE, check=True, env={**os.environ, "CONTRAPPOSTO_EXCHANGE": str(folder)})
    read = [json.loads(path.read_text()) for path in folder.glob("*.json")]
    for problem in read:
        problem["lower"], problem["upper"] = np.array(problem["lower"]), np.array(problem["upper"])
        n = len(problem["lower"])
        for level in problem["levels"]:
            level["matrix"] = np.array(level["matrix"]).reshape(-1, n)
            level["right"] = np.array(level["right"])
    return sorted(read, key=lambda p: (p["count"], len(p["lower"])))


def hierarchical(problem):
    """DAQP, all levels at once. Its first level is the bounds."""
    levels = [level for level in problem["levels"] if len(level["right"])]
    matrix = np.ascontiguousarray(np.vstack([level["matrix"] for level in levels]))
    right = np.concatenate([level["right"] for level in levels])
    n = len(problem["lower"])
    ends = np.cumsum([n] + [len(level["right"]) for level in levels]).astype(np.intc)
    upper, lower = np.r_[problem["upper"], right], np.r_[problem["lower"], right]
    sense = np.zeros(n + len(right), dtype=np.intc)
    x, _, flag, info = daqp.solve(None, None, matrix, upper, lower, sense, break_points=ends, primal_tol=1e-9)
    return (x if flag > 0 else None), info["setup_time"] + info["solve_time"]


def cascade(solve):
    """One QP a level, by `solve(H, g, C, d, lower, upper)`: x and seconds."""

    def run(problem):
        n = len(problem["lower"])
        held, at, seconds = np.zeros((0, n)), np.zeros(0), 0.0
        for level in problem["levels"]:
            a, b = level["matrix"], level["right"]
            if len(b) == 0:
                continue
            x, spent = solve(a.T @ a, -a.T @ b, held, at, problem["lower"], problem["upper"])
            seconds += spent
            if x is None:
                return None, seconds
            held, at = np.vstack([held, a]), np.r_[at, a @ x]
        return x, seconds

    return run


def by_proxqp(h, g, c, d, lower, upper):
    n = len(g)
    qp = proxqp.dense.QP(n, len(d), 0, True)
    qp.settings.eps_abs, qp.settings.compute_timings = 1e-9, True
    qp.init(h, g, c, d, None, None, None, lower, upper)
    qp.solve()
    solved = qp.results.info.status == proxqp.QPSolverOutput.PROXQP_SOLVED
    return (qp.results.x if solved else None), 1e-6 * qp.results.info.run_time


def by_clarabel(h, g, c, d, lower, upper):
    n = len(g)
    settings = clarabel.DefaultSettings()
    settings.verbose, settings.max_threads = False, 1
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-10
    rows = sparse.csc_matrix(np.vstack([c, np.eye(n), -np.eye(n)]))
    cones = [clarabel.ZeroConeT(len(d)), clarabel.NonnegativeConeT(2 * n)]
    solver = clarabel.DefaultSolver(sparse.csc_matrix(np.triu(h)), g, rows, np.r_[d, upper, -lower], cones, settings)
    solution = solver.solve()
    solved = solution.status == clarabel.SolverStatus.Solved
    return (np.array(solution.x) if solved else None), solution.solve_time


PEERS = {
    f"DAQP {importlib.metadata.version('daqp')}, hierarchical": hierarchical,
    f"ProxQP {importlib.metadata.version('proxsuite')}, cascade": cascade(by_proxqp),
    f"Clarabel {importlib.metadata.version('clarabel')}, cascade": cascade(by_clarabel),
}


def agrees(problem, x):
    """Whether every level is as short as ours. The length separates shorter and longer ones from rounding."""
    outside = np.maximum(problem["lower"] - x, x - problem["upper"]).max()
    off = [np.linalg.norm(l["matrix"] @ x - l["right"]) - l["residual"] for l in problem["levels"]]
    size = [max(1.0, level["residual"]) for level in problem["levels"]]
    return outside < SAME and all(abs(o) < SAME * s for o, s in zip(off, size))


def least(problem, solve):
    """Microseconds, and whether the answer is ours."""
    x, seconds = solve(problem)
    same = x is not None and agrees(problem, x)
    end = time.monotonic() + SECONDS
    while time.monotonic() < end:
        seconds = min(seconds, solve(problem)[1])
    return 1e6 * seconds, same


def main():
    with tempfile.TemporaryDirectory() as folder:
        read = problems(pathlib.Path(folder))
    print(f"load {os.getloadavg()[0]:.1f}")
    names = list(PEERS)
    print("| Levels | Unknowns | Ours, active set known | Ours, cold | " + " | ".join(names) + " |")
    print("|---" * (4 + len(names)) + "|")
    for problem in read:
        cells = [f"{problem['count']}", f"{len(problem['lower'])}", f"{problem['known']:.3g}", f"{problem['cold']:.3g}"]
        for solve in PEERS.values():
            spent, same = least(problem, solve)
            cells.append(f"{spent:.3g} ({spent / problem['known']:.1f})" + ("" if same else " !"))
        print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
