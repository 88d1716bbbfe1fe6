#!/usr/bin/env python3
"""Compares `contrapposto relax` with SLSQP of scipy from random starts, on the same problems of least effort.

    cargo build --release -p contrapposto-cli
    cargo build -p contrapposto-formats --example least_effort_rows
    pip install numpy scipy==1.17.1
    OMP_NUM_THREADS=1 python scripts/effort_by_slsqp.py target/release/contrapposto target/debug/examples/least_effort_rows

prints the table of docs/benchmarks.md and writes crates/contrapposto-formats/tests/data/effort_slsqp.json, which
`tests/effort_slsqp.rs` of that crate holds `relax` to. Options: --starts, --seed, --only SCENARIO ..., --out FILE; scenarios
that are left out keep their results in FILE. 50 starts of six scenarios take two minutes on one core.

Shared by both: the body, its kinematics, external and passive torque, strength, the rows of tasks and their first derivatives
(`examples/least_effort_rows.rs`). Torques are held to Pinocchio elsewhere (docs/benchmarks.md); before each scenario this script holds
the derivatives to central differences. Independent: the optimiser; the starts; the statement of objective, equilibrium of the root,
friction, shares and bounds in this file; no second derivative, no exploration, no goal angles, no mirror images, no basin hopping.

Unknowns: free coordinates (rad, m), and the force of every corner of every support along normal and two axes of its plane (body weights).

    minimise  sum_i (tau_a,i / S_i)^2                      active torque over strength, three-axis joints about their axes
    where     the torque of the root's rates is zero       (forces and moments, body weights)
              supports keep their places                   (or lie flat in their regions, where they are free)
              tasks above effort have the errors           that the best posture of `relax` has: zero where it reaches them
              parts of the body keep their clearance
              0 <= f_n <= 2,  |f_t| <= mu / sqrt(2) f_n    the pyramid inscribed in the cone of friction
              a support carries no more than its share
              coordinates are in their ranges

Start number k of a scenario, with the generator of seed (SEED, k): every free coordinate is drawn uniformly from its range, those of the root
within 0.3 m and 0.5 rad of the scenario's start; the start lies 1/3, 2/3 or the whole way (k mod 3) from the scenario's start to that
posture, and is then moved to its supports by bounded least squares. SLSQP is started again where it ended, up to four times,
since its estimate of curvature degenerates. A result counts as feasible if no constraint is violated by more than 1e-6 (m, rad, body
weights), converged or not: any feasible posture of less effort would be one that `relax` misses.
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys
import time

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
import scipy
from scipy.optimize import least_squares, lsq_linear, minimize

HERE = pathlib.Path(__file__).resolve().parent.parent
SCENARIOS = ["stand-relaxed", "hold-tool", "lean-on-table", "counter", "screw-overhead", "reach-floor"]
OUT = HERE / "crates/contrapposto-formats/tests/data/effort_slsqp.json"
SEED = 20261123
GREATEST_FORCE = 2.0  # body weights, of a corner
FEASIBLE = 1e-6  # m, rad, body weights
HELD = 1e-6  # errors of tasks below this count as zero
SCALE = 100.0  # of the objective: effort is small against 1
ROUNDS = 5  # runs of SLSQP from one start
FAR = 0.05  # stands for the distance of parts that have no row, m
NEAR = 0.1  # distance from which on a pair of parts is left out until it is violated, m
SAME = 0.02  # share of effort


class Rows:
    """The process that evaluates a scenario."""

    def __init__(self, program, scenario):
        self.process = subprocess.Popen([program, str(scenario)], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.about = json.loads(self.process.stdout.readline())
        self.n = len(self.about["coordinates"])
        self.effort, self.root = np.array(self.about["effort"]), np.array(self.about["root"])
        self.corners = sum(support["corners"] for support in self.about["supports"])
        self.tasks = sum(task["rows"] for task in self.about["tasks"])
        self.evaluations = 0

    def evaluate(self, q, forces):
        """Forces in N along the axes of ground, one row a corner."""
        n, m, r, c, t = self.n, len(self.effort), len(self.root), 3 * self.corners, self.tasks
        self.process.stdin.write(np.concatenate([q, forces.ravel()]).astype("<f8").tobytes())
        self.process.stdin.flush()
        sizes = [n, m, m * n, m, r * n, c * n, t * (n + 2)]
        data = self.process.stdout.read(8 * sum(sizes))
        if len(data) != 8 * sum(sizes):
            sys.exit(f"{self.about['title']}: the evaluation ended early")
        parts = np.split(np.frombuffer(data, "<f8"), np.cumsum(sizes)[:-1])
        self.evaluations += 1
        tasks = parts[6].reshape(t, n + 2)
        return {
            "active": parts[0],
            "loads": parts[1],
            "loads_by_q": parts[2].reshape(m, n),
            "strength": parts[3],
            "root_by_q": parts[4].reshape(r, n),
            "by_force": parts[5].reshape(c, n),
            "lower": tasks[:, 0],
            "upper": tasks[:, 1],
            "tasks_by_q": tasks[:, 2:],
        }

    def close(self):
        self.process.stdin.close()
        self.process.wait()


class Problem:
    """Objective and constraints in the unknowns (free coordinates, then forces)."""

    def __init__(self, rows):
        about, self.rows = rows.about, rows
        self.start = np.array(about["start"])
        self.free = np.flatnonzero(~np.array(about["locked"]))
        self.low, self.high = np.array(about["low"])[self.free], np.array(about["high"])[self.free]
        self.weight = about["weight_n"]
        self.forces = 3 * rows.corners
        # Directions of the three forces of every corner, N a body weight.
        axes = [plane(np.array(support["normal"])) for support in about["supports"] for _ in range(support["corners"])]
        self.turn = np.zeros((self.forces, self.forces))
        for i, axis in enumerate(axes):
            self.turn[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] = self.weight * axis
        self.bounds = list(zip(self.low, self.high))
        self.bounds += [(0.0 if i % 3 == 0 else -GREATEST_FORCE, GREATEST_FORCE) for i in range(self.forces)]
        self.friction_and_shares(about["supports"])
        self.known = (None, None)
        self.kinds()
        self.held = np.zeros(rows.tasks)
        self.watched = np.ones(len(self.pairs), bool)

    def friction_and_shares(self, supports):
        """Linear inequalities `limit - matrix forces >= 0`."""
        matrix, limit, corner = [], [], 0
        for support in supports:
            corners = range(corner, corner + support["corners"])
            corner += support["corners"]
            for i in corners if support["friction"] is not None else []:
                for axis, sign in [(1, 1), (1, -1), (2, 1), (2, -1)]:
                    row = np.zeros(self.forces)
                    row[3 * i], row[3 * i + axis] = -support["friction"] / np.sqrt(2), sign
                    matrix.append(row)
                    limit.append(0.0)
            if support["share_max"] < 1:
                row = np.zeros(self.forces)
                row[[3 * i for i in corners]] = 1.0
                matrix.append(row)
                limit.append(support["share_max"])
        self.friction = np.array(matrix).reshape(-1, self.forces), np.array(limit)

    def kinds(self):
        """Rows of tasks that are equations, that have a lower and an upper limit, and pairs that keep their distance."""
        at = self.at(np.concatenate([self.start[self.free], np.zeros(self.forces)]))
        tasks = self.rows.about["tasks"]
        label = np.array([task["label"] for task in tasks for _ in range(task["rows"])])
        place = np.array([task["place"] for task in tasks for _ in range(task["rows"])])
        pair = np.char.startswith(label, "clearance")
        equal = (at["lower"] == at["upper"]) & ~pair
        self.equal, self.pairs = np.flatnonzero(equal), np.flatnonzero(pair)
        self.above = np.flatnonzero(~equal & ~pair & np.isfinite(at["lower"]))
        self.below = np.flatnonzero(~equal & ~pair & np.isfinite(at["upper"]))
        self.supported = np.flatnonzero(equal & (place == "support"))

    def at(self, x):
        key = x.tobytes()
        if self.known[0] != key:
            q = self.start.copy()
            q[self.free] = x[: len(self.free)]
            forces = self.turn.T @ x[len(self.free) :]
            self.known = (key, self.rows.evaluate(q, forces.reshape(-1, 3)))
        return self.known[1]

    def effort(self, x):
        return float(np.sum(self.at(x)["loads"] ** 2))

    def effort_slope(self, x):
        at = self.at(x)
        by_force = -(self.turn @ at["by_force"][:, self.rows.effort]).T / at["strength"][:, None]
        return 2.0 * np.concatenate([at["loads"] @ at["loads_by_q"][:, self.free], at["loads"] @ by_force])

    def equations(self, x):
        at = self.at(x)
        errors = -at["upper"][self.equal] - self.held[self.equal]
        return np.concatenate([-at["active"][self.rows.root] / self.weight, errors])

    def equation_slopes(self, x):
        at = self.at(x)
        by_force = (self.turn @ at["by_force"][:, self.rows.root]).T
        root = np.hstack([at["root_by_q"][:, self.free], by_force]) / self.weight
        return np.vstack([root, self.padded(at["tasks_by_q"][self.equal])])

    def inequalities(self, x):
        at = self.at(x)
        pairs = -at["lower"][self.pairs[self.watched]]
        matrix, limit = self.friction
        return np.concatenate(
            [
                -at["lower"][self.above],
                at["upper"][self.below],
                np.where(np.isfinite(pairs), pairs, FAR),
                limit - matrix @ x[len(self.free) :],
            ]
        )

    def inequality_slopes(self, x):
        rows, (matrix, _) = self.at(x)["tasks_by_q"], self.friction
        tasks = np.vstack([rows[self.above], -rows[self.below], rows[self.pairs[self.watched]]])
        return np.vstack([self.padded(tasks), np.hstack([np.zeros((len(matrix), len(self.free))), -matrix])])

    def padded(self, rows):
        return np.hstack([rows[:, self.free], np.zeros((len(rows), self.forces))])

    def violation(self, x):
        """The largest violation of a constraint, all pairs included."""
        low, high = np.array(self.bounds).T
        pairs = -self.at(x)["lower"][self.pairs]
        inside = [self.inequalities(x), pairs[np.isfinite(pairs)], x - low, high - x]
        return max(np.abs(self.equations(x)).max(), -min(np.min(part, initial=0.0) for part in inside))


def plane(normal):
    """Normal, and two axes of the plane, one a row."""
    across = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    across /= np.linalg.norm(across)
    return np.array([normal, across, np.cross(normal, across)])


def drawn(problem, seed, k):
    """Start number k, before it is moved to its supports."""
    generator = np.random.default_rng([seed, k])
    start, low, high = problem.start[problem.free], problem.low.copy(), problem.high.copy()
    root = np.isin(problem.free, problem.rows.root)
    slides = np.array([not np.isfinite(lo) or name.endswith(("_tx", "_ty", "_tz")) for lo, name in named(problem)])
    low[root] = np.maximum(low, start - np.where(slides, 0.3, 0.5))[root]
    high[root] = np.minimum(high, start + np.where(slides, 0.3, 0.5))[root]
    return start + (1 + k % 3) / 3 * (generator.uniform(low, high) - start)


def named(problem):
    names = problem.rows.about["coordinates"]
    return [(low, names[i]) for i, low in zip(problem.free, problem.low)]


def on_supports(problem, posture):
    """The posture moved to its supports, and forces that come near equilibrium in it."""
    free, keep = len(problem.free), 1e-3
    zero = np.zeros(problem.forces)

    def errors(q):
        at = problem.at(np.concatenate([q, zero]))
        return np.concatenate([-at["upper"][problem.supported], keep * (q - posture)])

    def slopes(q):
        at = problem.at(np.concatenate([q, zero]))
        return np.vstack([at["tasks_by_q"][np.ix_(problem.supported, problem.free)], keep * np.eye(free)])

    inside = np.clip(posture, problem.low + 1e-9, problem.high - 1e-9)
    q = least_squares(errors, inside, slopes, (problem.low, problem.high), max_nfev=200).x
    x = np.concatenate([q, zero])
    matrix, target = problem.equation_slopes(x)[: len(problem.rows.root), free:], -problem.equations(x)[: len(problem.rows.root)]
    small = 1e-2 * np.eye(problem.forces)
    low, high = np.array(problem.bounds[free:]).T
    forces = lsq_linear(np.vstack([matrix, small]), np.concatenate([target, np.zeros(problem.forces)]), (low, high)).x
    return np.concatenate([q, forces])


def descend(problem, x):
    """SLSQP from x, again from where it ended while that helps or a pair that was left out is violated."""
    steps, status, best = 0, None, None
    for _ in range(ROUNDS):
        watch(problem, x)
        constraints = [
            {"type": "eq", "fun": problem.equations, "jac": problem.equation_slopes},
            {"type": "ineq", "fun": problem.inequalities, "jac": problem.inequality_slopes},
        ]
        found = minimize(
            lambda x: SCALE * problem.effort(x),
            x,
            jac=lambda x: SCALE * problem.effort_slope(x),
            method="SLSQP",
            bounds=problem.bounds,
            constraints=constraints,
            options={"maxiter": 400, "ftol": 1e-9},
        )
        steps, status = steps + found.nit, found.status
        if not np.all(np.isfinite(found.x)):
            break
        before, x = (problem.effort(x), problem.violation(x)), found.x
        effort, violation = problem.effort(x), problem.violation(x)
        if violation <= FEASIBLE and (best is None or effort < problem.effort(best)):
            best = x
        settled = before[1] <= FEASIBLE and abs(before[0] - effort) <= 1e-4 * effort
        if violation <= FEASIBLE and (settled or best is not x):
            break
    return (x if best is None else best), status, steps


def watch(problem, x):
    """Watches the pairs that are near in x, besides those that were watched before."""
    pairs = -problem.at(x)["lower"][problem.pairs]
    problem.watched = problem.watched | (np.isfinite(pairs) & (pairs < NEAR))


def of_posture(problem, posture):
    """The unknowns of a posture with the contact forces of least effort in it."""
    free = len(problem.free)
    x = on_supports(problem, posture)
    x[:free] = posture
    inside = lambda f: np.concatenate([posture, f])
    matrix, limit = problem.friction
    root = len(problem.rows.root)
    found = minimize(
        lambda f: SCALE * problem.effort(inside(f)),
        x[free:],
        jac=lambda f: SCALE * problem.effort_slope(inside(f))[free:],
        method="SLSQP",
        bounds=problem.bounds[free:],
        constraints=[
            {
                "type": "eq",
                "fun": lambda f: problem.equations(inside(f))[:root],
                "jac": lambda f: problem.equation_slopes(inside(f))[:root, free:],
            },
            {"type": "ineq", "fun": lambda f: limit - matrix @ f, "jac": lambda f: -matrix},
        ],
        options={"maxiter": 500, "ftol": 1e-12},
    )
    return inside(found.x)


def difference(problem, x, seed):
    """The largest difference between derivatives and central differences along random directions, relative."""
    generator, worst, step = np.random.default_rng(seed), 0.0, 1e-6
    functions = [
        (problem.effort, problem.effort_slope),
        (problem.equations, problem.equation_slopes),
        (problem.inequalities, problem.inequality_slopes),
    ]
    for _ in range(10):
        along = generator.uniform(-1, 1, len(x))
        for value, slope in functions:
            exact = slope(x) @ along
            numeric = (value(x + step * along) - value(x - step * along)) / (2 * step)
            worst = max(worst, np.max(np.abs(numeric - exact) / (1 + np.abs(exact)), initial=0.0))
    return worst


def relaxed(program, scenario):
    """Best posture of relax, and its effort."""
    done = subprocess.run([program, "relax", str(scenario), "--json", "--no-suggest"], capture_output=True, text=True)
    if not done.stdout:
        sys.exit(done.stderr)
    found = json.loads(done.stdout)["postures"]
    return found[0]["coordinates"], [posture["effort"] for posture in found]


def compare(scenario, arguments):
    path = HERE / f"scenarios/{scenario}.toml"
    problem = Problem(Rows(arguments.rows, path))
    names = problem.rows.about["coordinates"]
    coordinates, efforts = relaxed(arguments.program, path)
    ours = np.array([coordinates[names[i]] for i in problem.free])
    problem.watched[:] = False
    ours = of_posture(problem, ours)
    errors = -problem.at(ours)["upper"]
    missed = np.isin(np.arange(len(errors)), problem.equal) & (np.abs(errors) > HELD)
    problem.held = np.where(missed, errors, 0.0)
    by_difference = difference(problem, on_supports(problem, drawn(problem, arguments.seed, 0)), arguments.seed)
    print(
        f"{scenario}: {len(problem.free)} coordinates, {problem.forces} forces, {len(problem.equations(ours))} equations, "
        f"{len(problem.pairs)} pairs; relax {efforts[0]:.6f}, the same posture here {problem.effort(ours):.6f}, violation "
        f"{problem.violation(ours):.1e}; derivatives off by {by_difference:.1e}",
        flush=True,
    )
    watch(problem, ours)
    onward, _, _ = descend(problem, ours)
    print(f"{scenario}: SLSQP from the posture of relax {problem.effort(onward):.6f}, {problem.violation(onward):.1e}", flush=True)
    runs, best = [], None
    for k in range(arguments.starts):
        begun = time.monotonic()
        problem.watched[:] = False
        x, status, steps = descend(problem, on_supports(problem, drawn(problem, arguments.seed, k)))
        effort, violation = problem.effort(x), problem.violation(x)
        runs.append({"start": k, "effort": effort, "violation": violation, "status": int(status), "steps": int(steps)})
        if violation <= FEASIBLE and (best is None or effort < problem.effort(best)):
            best = x
        print(f"{scenario} {arguments.seed} {k}: {effort:.6f}, {violation:.1e}, {status}, {steps} steps, {time.monotonic() - begun:.1f} s", flush=True)
    result = {
        "relax": efforts,
        "relax_here": problem.effort(ours),
        "relax_continued": problem.effort(onward),
        "derivatives_off_by": by_difference,
        "tasks_held_at": {f"{i}": e for i, e in enumerate(problem.held) if e != 0.0},
        "runs": runs,
    }
    if best is not None:
        q = problem.start.copy()
        q[problem.free] = best[: len(problem.free)]
        result["best"] = {"effort": problem.effort(best), "violation": problem.violation(best), "coordinates": dict(zip(names, q))}
    problem.rows.close()
    return result


def row(scenario, result):
    least, runs = result["relax"][0], result["runs"]
    feasible = [run for run in runs if run["violation"] <= FEASIBLE]
    converged = sum(run["status"] == 0 for run in feasible)
    best = min((run["effort"] for run in feasible), default=float("nan"))
    reached = sum(run["effort"] <= least * (1 + SAME) for run in feasible)
    return (
        f"| `{scenario}` | {least:.4f} | {best:.4f} | {best / least:.3f} | {len(feasible)} of {len(runs)} | {converged} | {reached} |"
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", help="the program contrapposto")
    parser.add_argument("rows", help="the example least_effort_rows")
    parser.add_argument("--starts", type=int, default=50)
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--only", nargs="*", default=SCENARIOS)
    parser.add_argument("--out", type=pathlib.Path, default=OUT)
    arguments = parser.parse_args()
    kept = json.loads(arguments.out.read_text()) if arguments.out.exists() else {}
    scenarios = kept.get("scenarios", {}) if kept.get("seed") == arguments.seed else {}
    for scenario in arguments.only:
        scenarios[scenario] = compare(scenario, arguments)
        about = {"tool": f"scipy {scipy.__version__} SLSQP", "script": "scripts/effort_by_slsqp.py", "seed": arguments.seed}
        arguments.out.write_text(json.dumps({**about, "scenarios": scenarios}, indent=1) + "\n")
    print("\n| Scenario | relax | best of SLSQP | by relax | feasible | converged | within 2 % of relax, or lower |")
    print("|---|---|---|---|---|---|---|")
    for scenario, result in scenarios.items():
        print(row(scenario, result))


if __name__ == "__main__":
    main()
