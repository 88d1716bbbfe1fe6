"""Varies the passive curve of hip adduction, which nobody has measured, and records how contrapposto depends on it.

Runs scenarios/stand-relaxed.toml (the resting foot may be put elsewhere) and scenarios/stand-relaxed-feet-fixed.toml with the passive
curve of hip adduction made softer and stiffer, steeper and flatter: the postures that `relax` finds, and the runs of both strategies.
Prints the tables of docs/contrapposto.md.

    cargo build --release
    python3 scripts/study_hip_adduction.py target/release/contrapposto
"""

import csv
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
SCENARIOS = ["stand-relaxed", "stand-relaxed-feet-fixed"]
# Size of the torque against the built-in curve, and rate, 1/rad. 0.51 to 0.73 follow from the modified Ober test (Ferber 2010).
CURVES = [(0.0, 8.0), (0.17, 8.0), (0.25, 8.0), (0.51, 8.0), (0.73, 8.0), (1.0, 8.0), (2.0, 8.0), (4.0, 8.0), (1.0, 4.0), (1.0, 12.0)]

# A pelvis that hangs by less is level, deg. Slouches of the stiffest tissue hang by 7.9 deg, level postures by 6.2 at most.
LEVEL = 7.0


def curve(scale, rate):
    """The built-in curve (crates/contrapposto/data/passive.toml, hip_adduction) of a woman of 60 kg with its torques scaled."""
    torque = 30.0 * 60 / 73 * scale
    end = lambda angle: f"{{ torque_nm = {torque}, rate_per_rad = {rate}, angle_deg = {angle} }}"
    return f"{{ double_exponential = {{ lower = {end(-45.0)}, upper = {end(20.0)}, stiffness_nm_per_rad = 0.0, neutral_deg = 0.0 }} }}"


def run(program, scenario, strategy, scale, rate):
    text = (ROOT / f"scenarios/{scenario}.toml").read_text()
    text = text.replace('kind = "passive"', f'kind = "{strategy}"')
    text = re.sub(r"duration_s = \d+", "duration_s = 60", text)
    scale = max(scale, 1e-6)  # a curve must fall, however little
    text += f"\n[passive]\nhip_adduction_r = {curve(scale, rate)}\nhip_adduction_l = {curve(scale, rate)}\n"
    with tempfile.TemporaryDirectory() as out:
        done = subprocess.run(
            [program, "simulate", "-", "--json", "--out", out], input=text, capture_output=True, text=True
        )
        if done.returncode:
            sys.exit(done.stderr)
        with open(f"{out}/decisions.csv") as table:
            fates = [row["outcome"] for row in csv.DictReader(table) if row["coordinate"] == "hip_adduction_r"]
    summary = json.loads(done.stdout)
    of = lambda name: summary["coordinates"][name]
    hip, knee = of("hip_adduction_r"), of("knee_angle_r")
    return (
        f"| {scale:g} | {rate:g} | {strategy} | {of('pelvis_list')['final_deg']:.1f} | {hip['final_deg']:.1f} "
        f"| {hip['final_passive_nm']:.1f} | {hip['final_active_nm']:.1f} | {knee['final_deg']:.1f} "
        f"| {100 * summary['standing']['supports'][0]['share']:.0f} | {summary['standing']['effort_at_start']:.4f} "
        f"| {summary['standing']['effort']:.4f} | {', '.join(dict.fromkeys(fates))} | {len(summary.get('steps', []))} |"
    )


def answers(program, scenario, scale, rate):
    """Effort, pelvis list and right hip adduction (deg) of each posture that `relax` answers with."""
    scale = max(scale, 1e-6)
    text = (ROOT / f"scenarios/{scenario}.toml").read_text()
    text += f"\n[passive]\nhip_adduction_r = {curve(scale, rate)}\nhip_adduction_l = {curve(scale, rate)}\n"
    with tempfile.TemporaryDirectory() as out:
        done = subprocess.run(
            [program, "relax", "-", "--json", "--no-suggest", "--out", out], input=text, capture_output=True, text=True
        )
    postures = json.loads(done.stdout)["postures"]
    angle = lambda posture, name: math.degrees(posture["coordinates"][name])
    return [(p["effort"], angle(p, "pelvis_list"), angle(p, "hip_adduction_r")) for p in postures]


def postures(program):
    """The postures of least effort; level: the pelvis hangs by less than LEVEL."""
    print("| size | rate, 1/rad | foot free: least effort | list, deg | adduction, deg | level posture | feet fixed: slouch | level posture |")
    print("|---|---|---|---|---|---|---|---|")
    first = lambda found, wanted: next((f"{effort:.4f}" for effort, lean, _ in found if wanted(lean)), "none")
    for scale, rate in CURVES:
        free, fixed = (answers(program, scenario, scale, rate) for scenario in SCENARIOS)
        effort, lean, adduction = free[0]
        is_level, hangs = lambda lean: abs(lean) < LEVEL, lambda lean: lean <= -LEVEL
        print(
            f"| {scale:g} | {rate:g} | {effort:.4f} | {lean:.1f} | {adduction:.1f} | {first(free, is_level)} "
            f"| {first(fixed, hangs)} | {first(fixed, is_level)} |",
            flush=True,
        )


def main():
    program = sys.argv[1]
    postures(program)
    for scenario in SCENARIOS:
        print(f"\n{scenario}\n")
        table(program, scenario)


def table(program, scenario):
    print("| stiffness | rate, 1/rad | strategy | pelvis list, deg | hip adduction, deg | passive, N m | active, N m | knee, deg | weight on it, % | effort before | after | relief | steps |")
    print("|---|---|---|---|---|---|---|---|---|---|---|---|---|")
    for scale, rate in CURVES:
        for strategy in ["passive", "active"]:
            print(run(program, scenario, strategy, scale, rate), flush=True)


main()
