"""Computes the time for which a standing posture can be held, by height and reach of the hands.

For hands at 25 to 150 % of shoulder height and 25 to 100 % of arm reach (the 19 postures of Miedema et al. 1997 are among these 24),
nothing in them and nothing else asked: finds the postures of least effort, holds two of them (the most upright and the easiest)
until the first muscle group gives up, and lets the most upright one shift by hybrid minimisation. Prints the table of
docs/holding-times.md and draws its picture. With measured times (rows of `height %,reach %,minutes`) also rank correlation and
agreement of classes.

    cargo build --release
    python3 scripts/study_holding_times.py target/release/contrapposto docs/images/holding-times.svg [MEASURED.csv]
"""

import csv
import json
import math
import pathlib
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

HEIGHTS, REACHES = [150, 125, 100, 75, 50, 25], [25, 50, 75, 100]
STATURE, MASS = 1.75, 73
# crates/contrapposto/data/anthropometry.toml: shoulder height (Drillis & Contini); upper arm, forearm and hand up to the
# knuckles of de Leva's man of 1.741 m. Where the sole begins behind the ankle: adult.toml.
SHOULDER = 0.818 * STATURE
HAND = 0.0862 * STATURE / 1.741
ARM = (0.2817 + 0.2689) * STATURE / 1.741 + HAND
HEEL = 0.0271 * STATURE
# Back and heels against a wall, arms level: from the wall to the knuckles.
REACH = HEEL + ARM
# Of each hand from the middle: assumed.
APART = 0.1
# Longest time that is simulated, and its step, s.
LONGEST, STEP = 45 * 60, 0.5
# Of relief; the other one ends alike.
STRATEGY = "passive"
# A hand is where it should be, m.
NEAR = 0.005
# Standing; where nothing is found from there, with bent elbows.
STARTS = ["", "[posture]\nelbow_flex_r_deg = 90\nelbow_flex_l_deg = 90\n"]


def scenario(height, reach, more="", law="endurance"):
    """Knuckles at these shares of shoulder height and of arm reach ahead of the heels."""
    target = f"{reach / 100 * REACH - HEEL:.4f}, {height / 100 * SHOULDER:.4f}"
    hands = "".join(
        f'[[task]]\nkind = "point"\nsegment = "hand_{side}"\nat_m = [0, {-HAND:.4f}, 0]\n'
        f"target_m = [{target}, {across}]\nabove_relief = true\n"
        for side, across in [("r", APART), ("l", -APART)]
    )
    return (
        f'format = 1\nupright = false\ntitle = "Hands at {height} % shoulder height, {reach} % arm reach"\n'
        f'[model]\nadult = {{ sex = "male", stature_m = {STATURE}, mass_kg = {MASS} }}\n'
        f'[fatigue]\nlaw = "{law}"\n[[support]]\nsegment = "calcn_r"\n[[support]]\nsegment = "calcn_l"\n'
        f'{hands}[[task]]\nkind = "effort"\n{more}'
    )


def run(program, command, text):
    """The JSON that the program prints, also where the job cannot be done."""
    with tempfile.TemporaryDirectory() as out:
        folder = ["--no-suggest", *(["--out", out] if command == "simulate" else [])]
        done = subprocess.run([program, command, "-", "--json", *folder], input=text, capture_output=True, text=True)
    if done.returncode == 2:
        sys.exit(done.stderr)
    return json.loads(done.stdout) if done.stdout else None


def lean(posture):
    """Angle by which the chest leans forward, degrees."""
    values = posture["coordinates"]
    return -math.degrees(sum(values[name] for name in ["pelvis_tilt", "lumbar_extension", "thoracic_extension"]))


def held(posture):
    """Minutes, the group that gives up, and its load."""
    first = posture["fails_first"]
    return (first["endurance_s"] / 60, first["group"], first["relative_load"]) if first else (math.inf, "nobody", 0)


def shifting(program, height, reach, posture):
    """Minutes until the first group gives up when tired groups may seek relief, and which; None beyond the longest time."""
    unit = lambda name, value: f"m = {value!r}" if name[:-1] in ("pelvis_t", "shoulder_rise_") and name != "pelvis_tilt" else f"deg = {math.degrees(value)!r}"
    start = "".join(f"{name}_{unit(name, value)}\n" for name, value in posture["coordinates"].items())
    more = f'[posture]\n{start}[strategy]\nkind = "{STRATEGY}"\n[run]\nduration_s = {LONGEST}\nstep_s = {STEP}\n'
    summary = run(program, "simulate", scenario(height, reach, more))
    first = summary["failed_first"] if summary else None
    return (first["at_s"] / 60, first["group"]) if first else None


def study(program, height, reach):
    """The postures of a cell; where there are none, the distance (m) by which the worse hand misses its place."""
    missing = math.inf
    for start in STARTS:
        found = run(program, "relax", scenario(height, reach, start)) or {"postures": []}
        # The shoulders may rise farther than their rhythm asks.
        hands = [(max(task["error"] for task in p["tasks"] if "point" in task["task"]), p) for p in found["postures"]]
        missing = min([missing, *(error for error, _ in hands)])
        postures = [p for error, p in hands if error < NEAR]
        if postures:
            break
    if not postures:
        return missing
    upright = min(postures, key=lambda posture: abs(lean(posture)))
    return {"upright": upright, "easiest": postures[0], "shifting": shifting(program, height, reach, upright)}


def number(minutes):
    return "for ever" if math.isinf(minutes) else f"{minutes:.1f}" if minutes < 9.95 else f"{minutes:.0f}"


def row(height, reach, cell):
    if isinstance(cell, float):
        missing = f", {100 * cell:.1f} cm missing" if math.isfinite(cell) else ""
        return f"| {height} | {reach} | not reached{missing} | | | | | | |"
    columns = [height, reach]
    for kind in ["upright", "easiest"]:
        minutes, group, load = held(cell[kind])
        columns += [number(minutes), f"{group}, {load:.0%}", f"{round(lean(cell[kind]))}"]
    ended = cell["shifting"]
    columns.append(f"{number(ended[0])}, {ended[1]}" if ended else f"over {LONGEST / 60:.0f}")
    return "| " + " | ".join(map(str, columns)) + " |"


def ranks(values):
    """From 1; equal values share the mean of theirs."""
    return [(sum(v < value for v in values) + 1 + sum(v <= value for v in values)) / 2 for value in values]


def spearman(a, b):
    a, b = ranks(a), ranks(b)
    mean = (len(a) + 1) / 2
    product = lambda x, y: sum((p - mean) * (q - mean) for p, q in zip(x, y))
    return product(a, b) / math.sqrt(product(a, a) * product(b, b))


def band(minutes):
    """The classes of Miedema et al. 1997."""
    return "comfortable" if minutes > 10 else "moderate" if minutes > 5 else "uncomfortable"


def compare(cells, measured):
    with open(measured) as table:
        figures = {(int(height), int(reach)): float(minutes) for height, reach, minutes in csv.reader(table)}
    for kind in ["upright", "easiest"]:
        pairs = [(held(cells[at][kind])[0], minutes) for at, minutes in figures.items() if isinstance(cells.get(at), dict)]
        agree = sum(band(ours) == band(theirs) for ours, theirs in pairs)
        print(f"{kind}: {len(pairs)} postures, rank correlation {spearman(*zip(*pairs)):.2f}, the same class in {agree}")


STYLE = """text { font: 12px sans-serif; fill: #1b1f24 } .strong { font-size: 16px; font-weight: 600 } .small { font-size: 10px }
.comfortable { fill: #bfe3c6 } .moderate { fill: #f6dfa4 } .uncomfortable { fill: #f2b8ae } .none { fill: #e4e7eb }
.around { fill: #1b1f24 } @media (prefers-color-scheme: dark) { .around { fill: #e6edf3 } }"""
WIDE, HIGH, LEFT, TOP = 136, 50, 50, 46


def picture(cells):
    """Two maps, height by reach."""
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {2 * (LEFT + 4 * WIDE) + 30} {TOP + 6 * HIGH + 62}"><style>{STYLE}</style>']
    say = lambda x, y, text, kind="", anchor="middle": out.append(
        f'<text class="{kind}" x="{x}" y="{y}" text-anchor="{anchor}">{text}</text>'
    )
    for place, (kind, title) in enumerate([("upright", "the most upright way"), ("easiest", "the easiest way")]):
        left = LEFT + place * (LEFT + 4 * WIDE + 20)
        say(left, 18, f"Held {title}: minutes until the first muscle group gives up", "around", "start")
        for line, height in enumerate(HEIGHTS):
            say(left - 6, TOP + line * HIGH + HIGH / 2 + 4, f"{height} %", "around", "end")
            for column, reach in enumerate(REACHES):
                cell = cells[height, reach]
                minutes, group, _ = held(cell[kind]) if isinstance(cell, dict) else (0, "not reached", 0)
                x, y = left + column * WIDE, TOP + line * HIGH
                out.append(
                    f'<rect class="{band(minutes) if isinstance(cell, dict) else "none"}" x="{x + 1}" y="{y + 1}" width="{WIDE - 2}" height="{HIGH - 2}" rx="3"/>'
                )
                if isinstance(cell, dict):
                    say(x + WIDE / 2, y + 22, number(minutes), "strong")
                say(x + WIDE / 2, y + 39, group, "small")
        for column, reach in enumerate(REACHES):
            say(left + column * WIDE + WIDE / 2, TOP - 8, f"{reach} %", "around")
        say(left + 2 * WIDE, TOP + 6 * HIGH + 18, "down: height of the hands, of shoulder height; across: their reach, of arm reach", "around small")
    for place, (kind, text) in enumerate(
        [("comfortable", "over 10 min"), ("moderate", "5 to 10 min"), ("uncomfortable", "up to 5 min"), ("none", "not reached")]
    ):
        x, y = LEFT + place * 110, TOP + 6 * HIGH + 36
        out.append(f'<rect class="{kind}" x="{x}" y="{y}" width="14" height="14" rx="3"/>')
        say(x + 20, y + 11, text, "around", "start")
    return "\n".join(out) + "\n</svg>\n"


def main():
    program, drawing = sys.argv[1:3]
    places = [(height, reach) for height in HEIGHTS for reach in REACHES]
    with ThreadPoolExecutor(2) as pool:
        cells = dict(zip(places, pool.map(lambda place: study(program, *place), places)))
    print(f"shoulder height {SHOULDER:.3f} m, arm reach {REACH:.3f} m")
    print("| height, % | reach, % | upright, min | gives up, at load | lean, deg | easiest, min | gives up, at load | lean, deg | shifting, min |")
    print("|---|---|---|---|---|---|---|---|---|")
    for place, cell in cells.items():
        print(row(*place, cell))
    for kind in ["upright", "easiest"]:
        bands = [band(held(cell[kind])[0]) for cell in cells.values() if isinstance(cell, dict)]
        print(f"{kind}: {', '.join(f'{bands.count(b)} {b}' for b in ['comfortable', 'moderate', 'uncomfortable'])}")
    pathlib.Path(drawing).write_text(picture(cells))
    if len(sys.argv) > 3:
        compare(cells, sys.argv[3])


if __name__ == "__main__":
    main()
