#!/usr/bin/env python3
"""Times a minute of 100 Hz capture from markers to the report: `track`, then `assess` with the model's muscles.

    cargo build --release
    python3 scripts/minute_of_capture.py FOLDER [PROGRAM]

FOLDER is the folder `Pipelines` of opensim-core's `opensim-models` repository, which is not a part of this project. Markers and measured forces of
gait2392's walking trial are taken forward and backward in turns, interpolated to 100 Hz, until they last a minute (6,000 instants), so that they
have no jump. Both runs are timed by the clock of the wall and by the processor, start and all files included.
"""

import bisect
import pathlib
import resource
import shutil
import subprocess
import sys
import tempfile
import time

REPOSITORY = pathlib.Path(__file__).resolve().parent.parent
FORCES = "subject01_walk1_grf.mot"
GAIT = pathlib.Path("Gait2392_Simbody")
INSTANTS, RATE = 6000, 100
LARGEST_SECONDS = 5.0


def interpolated(times, rows):
    """A row at every instant: forward and backward in turns."""
    span = times[-1] - times[0]
    for i in range(INSTANTS):
        at = times[0] + span - abs((i / RATE) % (2 * span) - span)
        k = min(max(bisect.bisect_right(times, at) - 1, 0), len(times) - 2)
        share = (at - times[k]) / (times[k + 1] - times[k])
        yield i / RATE, [a + share * (b - a) for a, b in zip(rows[k], rows[k + 1])]


def markers(trial):
    """The text of a .trc file of a minute."""
    lines = trial.read_text(encoding="latin-1").splitlines()
    cells = [line.split("\t") for line in lines[5:] if line.strip()]
    count = 3 * len([cell for cell in lines[3].split("\t")[2:] if cell.strip()])
    rows = [[float(cell) for cell in row[2 : 2 + count]] for row in cells]
    keys = dict(zip(lines[1].split(), lines[2].split()))
    keys.update(dict.fromkeys(("DataRate", "CameraRate", "OrigDataRate"), RATE), NumFrames=INSTANTS, OrigNumFrames=INSTANTS)
    text = [*lines[:2], "\t".join(str(keys[key]) for key in lines[1].split()), *lines[3:5]]
    for i, (time_, row) in enumerate(interpolated([float(row[1]) for row in cells], rows)):
        text.append("\t".join([str(i + 1), f"{time_:.2f}", *(f"{value:.5f}" for value in row)]))
    return "\n".join(text) + "\n"


def forces(trial):
    """The text of a .mot file of a minute."""
    all_lines = [line.strip() for line in trial.read_text().splitlines() if line.strip()]
    end = all_lines.index("endheader")
    head, labels, lines = all_lines[:end], all_lines[end + 1], all_lines[end + 2 :]
    rows = [[float(cell) for cell in line.split()] for line in lines]
    text = [*(f"nRows={INSTANTS}" if line.startswith("nRows") else line for line in head), "endheader", labels]
    for time_, row in interpolated([row[0] for row in rows], [row[1:] for row in rows]):
        text.append("\t".join([f"{time_:.2f}", *(f"{value:.8f}" for value in row)]))
    return "\n".join(text) + "\n"


def timed(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    begin = time.perf_counter()
    run = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    wall = time.perf_counter() - begin
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if run.returncode:
        sys.exit(run.stderr)
    processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    print(f"{command[1]}: {wall:.2f} s, {processor:.2f} s of processor time")
    return wall


def main():
    pipelines = pathlib.Path(sys.argv[1]).resolve() / GAIT
    program = sys.argv[2] if len(sys.argv) > 2 else str(REPOSITORY / "target/release/contrapposto")
    model = pipelines / "OutputReference/subject01_simbody.osim"
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        (folder / "minute.trc").write_text(markers(pipelines / "subject01_walk1.trc"))
        (folder / FORCES).write_text(forces(pipelines / FORCES))
        loads = shutil.copy(pipelines / "subject01_walk1_grf.xml", folder)
        setup = pipelines / "subject01_Setup_IK.xml"
        wall = timed([program, "track", model, folder / "minute.trc", "--tasks", setup, "--from", 0, "--to", 60, "--out", folder / "tracked"])
        motion = folder / "tracked/motion.mot"
        wall += timed([program, "assess", model, motion, "--muscles", "strength", "--dynamics", "--grf", loads, "--out", folder / "report"])
        rows = sum(line[:1].isdigit() for line in (folder / "report/torques.sto").open())
        sizes = {path.name: path.stat().st_size for path in (folder / "report").iterdir()}
        print(f"{rows} instants, markers to report: {wall:.2f} s; files: {sizes}")
    if rows != INSTANTS:
        sys.exit(f"{INSTANTS} instants were asked for")
    sys.exit(0 if wall <= LARGEST_SECONDS else f"more than {LARGEST_SECONDS} s")


if __name__ == "__main__":
    main()
