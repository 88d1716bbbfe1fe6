#!/usr/bin/env python3
"""Kills sweeps at random and compares the files, and measures sweeps of many rows.

    pip install './python[all]' psutil
    python scripts/sweep_kills.py kills FOLDER       # 1,000 rows: each way undisturbed, and each way with 20 kills; the files to the byte
    python scripts/sweep_kills.py overhead FOLDER    # workers of Dask beside threads, at parts of about a second
    python scripts/sweep_kills.py many FOLDER        # 100,000 rows of a joint: time and memory

FOLDER is a new one. CONTRAPPOSTO_PROGRAM names a program of the same version; without it the one that pip installed is used. SEED (1) is
that of the delays before the kills.
"""

import json
import os
import pathlib
import random
import shutil
import subprocess
import sys
import time

import contrapposto

SCENARIOS = pathlib.Path(__file__).resolve().parents[1] / "scenarios"
PROGRAM = os.environ.get("CONTRAPPOSTO_PROGRAM") or shutil.which("contrapposto")
KILLS = 20

BASE = """format = 1
[model]
adult = { sex = "male", stature_m = 1.75, mass_kg = 75, part = "right_arm" }
[posture]
arm_flex_r_deg = 60
elbow_flex_r_deg = 20
[coordinates]
free = ["elbow_flex_r"]
[[load]]
segment = "hand_r"
mass_kg = 3
[strategy]
kind = "active"
[run]
duration_s = 200
"""
PLAN = """base = "base.toml"
design = "sobol"
rows = 1000
rows_per_part = 10
[parameters]
"model.adult.stature_m" = { normal = [1.7, 0.07], correlate = { "model.adult.mass_kg" = 0.5 } }
"model.adult.mass_kg" = { lognormal = [75, 0.16] }
"load.0.mass_kg" = { range = [0, 12] }
"strength.deviations" = { normal = [0, 1] }
"model.adult.sex" = { list = ["female", "male"] }
"""
CHILD = """import sys, contrapposto
plan, out, threads, address = sys.argv[1:]
client = None
if address:
    import distributed
    client = distributed.Client(address)
contrapposto.sweep(plan, out, resume=True, threads=None if address else int(threads), client=client)
"""


def files(folder):
    """The files of a sweep; what a killed one left for the next is in folders and in `sweep.lock`."""
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def plan_in(folder, rows_per_part=10, rows=1000):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "base.toml").write_text(BASE)
    plan = folder / "plan.toml"
    plan.write_text(PLAN.replace("rows_per_part = 10", f"rows_per_part = {rows_per_part}").replace("rows = 1000", f"rows = {rows}"))
    return plan


def command(way, plan, out, threads, address=""):
    if way == "program":
        return [PROGRAM, "sweep", str(plan), "--out", str(out), "--resume", "--threads", str(threads)]
    return [sys.executable, "-c", CHILD, str(plan), str(out), str(threads), address]


def started(words):
    return subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def parts(out):
    return sum(path.name.startswith("part-") for path in out.iterdir()) if out.exists() else 0


def with_kills(words, out, share):
    """Begins the sweep again and again; each time it is killed at a random moment after the first new part, or before it. Gives how many
    parts there were after each kill."""
    seen = []
    while len(seen) < KILLS:
        child, before = started(words), parts(out)
        # One kill in five may come before the first part: in the start, or while a folder is taken up again.
        if len(seen) % 5 == 4:
            time.sleep(random.uniform(0, share))
        else:
            while parts(out) == before and child.poll() is None:
                time.sleep(0.001)
            time.sleep(random.uniform(0, share))
        assert child.poll() is None, f"the sweep ended before kill {len(seen) + 1}; parts after each kill: {seen}"
        child.kill()
        child.wait()
        seen.append(parts(out))
    assert subprocess.run(words, capture_output=True, text=True).returncode == 0
    return seen


def kills(folder):
    import distributed

    seed = int(os.environ.get("SEED", "1"))
    random.seed(seed)
    plan = plan_in(folder)
    expected = None
    print(f"seed {seed}; load of the machine {os.getloadavg()}")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50) as cluster:
        ways = [(way, threads, "") for way in ("program", "python") for threads in (1, 2)]
        for way, threads, address in [*ways, ("dask", 2, cluster.scheduler_address)]:
            out = folder / f"{way}-{threads}"
            start = time.monotonic()
            done = subprocess.run(command(way, plan, out, threads, address), capture_output=True, text=True)
            assert done.returncode == 0, done.stderr
            whole = time.monotonic() - start
            expected = expected or files(out)
            assert files(out) == expected, f"{way}, {threads} threads: other files"
            killed = folder / f"{way}-{threads}-killed"
            seen = with_kills(command(way, plan, killed, threads, address), killed, whole / KILLS)
            assert files(killed) == expected, f"{way}, {threads} threads, killed: other files"
            print(f"{way}, {threads} threads: {whole:.1f} s undisturbed; {len(expected) - 1} parts; after each kill {seen}")
    dask_workers(folder, plan, expected)


def dask_workers(folder, plan, expected):
    """A worker of Dask is killed every few parts, where both are at work: a nanny does not replace one that is killed while it starts."""
    import distributed

    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50) as cluster:
        with distributed.Client(cluster) as client:
            killed, next_kill = [], [0]

            def kill(done, rows):
                if len(killed) < KILLS and done >= next_kill[0] and len(client.scheduler_info()["workers"]) == 2:
                    pid = random.choice(list(client.run(os.getpid).values()))
                    os.kill(pid, 9)
                    killed.append(pid)
                    next_kill[0] = done + random.randint(10, 40)

            out = folder / "dask-workers-killed"
            contrapposto.sweep(plan, out, client=client, progress=kill)
    assert files(out) == expected, "dask, killed workers: other files"
    print(f"dask: {len(killed)} kills of a worker ({len(set(killed))} processes)")


def overhead(folder):
    import distributed

    pace = folder / "pace"
    plan = plan_in(pace, rows=40, rows_per_part=40)
    before = time.process_time()
    contrapposto.sweep(plan, pace / "out", threads=1)
    seconds = (time.process_time() - before) / 40
    rows = max(1, round(1 / seconds))
    print(f"{seconds * 1e3:.1f} ms of processor a row: {rows} rows a part; load of the machine {os.getloadavg()}")
    plan = plan_in(folder, rows_per_part=rows, rows=40 * rows)
    small = plan_in(folder / "small", rows_per_part=1, rows=1000)
    elbow = SCENARIOS / "figure-08.toml"
    (folder / "small" / "base.toml").write_text(elbow.read_text())
    small.write_text("base = \"base.toml\"\nrows = 1000\nrows_per_part = 1\ndesign = \"sobol\"\n[parameters]\n\"strength.spread\" = { range = [0.9, 1.1] }\n")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50) as cluster:
        with distributed.Client(cluster) as client:
            for name, job in (("40 parts of a second", plan), ("1000 parts of one run of an elbow", small)):
                for attempt in range(3):
                    for way, options in (("threads", {"threads": 2}), ("dask", {"client": client})):
                        start = time.monotonic()
                        contrapposto.sweep(job, job.parent / f"{way}-{attempt}-{job.parent.name}", **options)
                        print(f"{name}: {way} {time.monotonic() - start:.2f} s")


def many(folder):
    folder.mkdir(parents=True, exist_ok=True)
    for rows in (4000, 100_000):
        plan = folder / f"{rows}.toml"
        shutil.copy(SCENARIOS / "figure-08.toml", folder)
        text = (SCENARIOS / "sweeps/elbow.toml").read_text().replace("../figure-08.toml", "figure-08.toml")
        plan.write_text(text.replace("rows = 1000", f"rows = {rows}").replace("rows_per_part = 100", "rows_per_part = 1000"))
        start = time.monotonic()
        child = subprocess.Popen([PROGRAM, "sweep", str(plan), "--out", str(folder / f"out-{rows}"), "--threads", "2"])
        # The greatest memory that wait4 gives counts that of this process, too.
        memory, ended = 0, 0
        while not ended:
            for line in pathlib.Path(f"/proc/{child.pid}/status").read_text().splitlines():
                memory = int(line.split()[1]) if line.startswith("VmHWM") else memory
            time.sleep(0.01)
            ended, status, used = os.wait4(child.pid, os.WNOHANG)
        assert status == 0
        size = sum(path.stat().st_size for path in (folder / f"out-{rows}").iterdir())
        print(
            f"{rows} rows: {time.monotonic() - start:.1f} s, {used.ru_utime + used.ru_stime:.1f} s of processor, "
            f"{memory / 1024:.1f} MB of memory, {size / 1e6:.2f} MB of files; load of the machine {os.getloadavg()}"
        )
        kinds = contrapposto.results(folder / f"out-{rows}").to_pandas()["kind"].value_counts()
        print(json.dumps(kinds.to_dict()))


if __name__ == "__main__":
    {"kills": kills, "overhead": overhead, "many": many}[sys.argv[1]](pathlib.Path(sys.argv[2]))
