"""How much of contrapposto hangs on a curve that nobody has measured?

Runs scenarios/stand-relaxed.toml with the passive curve of hip adduction made softer and stiffer, for both strategies, and
prints the table of docs/contrapposto.md.

    cargo build --release
    python3 scripts/study_hip_adduction.py target/release/contrapposto
"""

import csv
import json
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
SCALES = [0.0, 0.1, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 4.0, 8.0]


def curve(scale):
    """The built-in curve (crates/contrapposto/data/passive.toml, hip_adduction) of a woman of 60 kg with its torques scaled."""
    torque = 30.0 * 60 / 73 * scale
    end = lambda angle: f"{{ torque_nm = {torque}, rate_per_rad = 8.0, angle_deg = {angle} }}"
    return f"{{ double_exponential = {{ lower = {end(-45.0)}, upper = {end(20.0)}, stiffness_nm_per_rad = 0.0, neutral_deg = 0.0 }} }}"


def run(program, strategy, scale):
    text = (ROOT / "scenarios/stand-relaxed.toml").read_text()
    text = text.replace('kind = "passive"', f'kind = "{strategy}"')
    text = re.sub(r"duration_s = \d+", "duration_s = 60", text)
    scale = max(scale, 1e-6)  # a curve must fall, however little
    text += f"\n[passive]\nhip_adduction_r = {curve(scale)}\nhip_adduction_l = {curve(scale)}\n"
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
        f"| {scale:g} | {strategy} | {of('pelvis_list')['final_deg']:.1f} | {hip['final_deg']:.1f} "
        f"| {hip['final_passive_nm']:.1f} | {hip['final_active_nm']:.1f} | {knee['final_deg']:.1f} "
        f"| {100 * summary['standing']['supports'][0]['share']:.0f} | {summary['standing']['effort_at_start']:.4f} "
        f"| {summary['standing']['effort']:.4f} | {', '.join(dict.fromkeys(fates))} |"
    )


def main():
    program = sys.argv[1]
    print("| stiffness | strategy | pelvis list, deg | hip adduction, deg | passive, N m | active, N m | knee, deg | weight on it, % | effort before | after | relief |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    for scale in SCALES:
        for strategy in ["passive", "active"]:
            print(run(program, strategy, scale), flush=True)


main()
