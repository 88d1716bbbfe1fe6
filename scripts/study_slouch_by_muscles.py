"""Seeks the postures of least effort of published models whose hips have the passive torque of their muscles, with and without the capsule
and the iliotibial tract beside them: is a slouch among them, and does standing straight exhaust a muscle group?

Prints the tables of docs/contrapposto.md ("With the muscles of published models"). Models are not part of the repository: give their paths, e.g.
gait2392_thelen2003muscle.osim, Rajagopal2016.osim and RajagopalLaiUhlrich2023.osim of https://github.com/opensim-org/opensim-models.

    cargo build --release
    python3 scripts/study_slouch_by_muscles.py target/release/contrapposto MODEL.osim...
"""

import json
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile

# Corners of the soles in the frame of calcn, m: of gait2392, whose foot the other models have, too (assumed).
CORNERS = "[[0.2, -0.02, 0.04], [0.2, -0.02, -0.04], [-0.04, -0.02, -0.03], [-0.04, -0.02, 0.03]]"
TISSUES = ["off", "flexible", "mean", "stiff"]
# A pelvis that hangs by less is level, deg: as in study_hip_adduction.py.
LEVEL = 7.0

SCENARIO = """
format = 1
title = "Standing on the muscles of a model"
[model]
file = "{model}"
muscles = "both"
{tissue}
[[support]]
segment = "calcn_r"
corners_m = {corners}
[[support]]
segment = "calcn_l"
corners_m = {corners}
{resting}
[[task]]
kind = "orientation"
segment = "torso"
target = "start"
{held}
[[task]]
kind = "effort"
"""

# A task that adducts the hip of the standing leg, whatever it costs.
HELD_DEG = 20
HELD = f"""[[task]]
kind = "posture"
coordinates = ["hip_adduction_r"]
values = {{ hip_adduction_r_deg = {HELD_DEG} }}
"""


def relaxed(program, model, tissue, rests, held=""):
    """The answer of `relax` and what it says of the band at the hip. A resting leg carries 15 % at most and stands where it likes."""
    with tempfile.TemporaryDirectory() as folder:
        shutil.copy(model, folder)
        text = SCENARIO.format(
            model=pathlib.Path(model).name,
            corners=CORNERS,
            tissue="" if tissue == "off" else f'hip_tract = "{tissue}"',
            held=held,
            resting='place = "free"\nshare_max = 0.15' if rests else "",
        )
        (pathlib.Path(folder) / "stand.toml").write_text(text)
        command = [program, "relax", f"{folder}/stand.toml", "--json", "--no-suggest", "--verbose"]
        done = subprocess.run(command, capture_output=True, text=True)
    if not done.stdout:
        sys.exit(done.stderr)
    settled = "its effort still fell" not in done.stderr
    return json.loads(done.stdout), done.stderr, settled


def row(posture):
    angle = lambda name: math.degrees(posture["coordinates"][name])
    hung = {one["coordinate"]: one["passive_nm"] for one in posture["hanging"]}
    group = max(posture["groups"], key=lambda one: one["relative_load"])
    hip = hung.get("hip_adduction_r")
    return (
        f"{posture['effort']:.4f} | {angle('pelvis_list'):.1f} | {angle('hip_adduction_r'):.1f} | "
        f"{'under half' if hip is None else f'{hip:.1f}'} | {group['group']} ({group['coordinate']}) {100 * group['relative_load']:.1f} %"
    )


def main():
    program, models = sys.argv[1], sys.argv[2:]
    print("One leg rests (15 % of the weight at most, where it likes). `tissue`: the band beside the muscles.\n")
    print("| model | tissue | posture | effort | pelvis list, deg | right hip adduction, deg | passive torque that carries it, N m | greatest load | all settled |")
    print("|---|---|---|---|---|---|---|---|---|")
    for model in models:
        for tissue in TISSUES:
            answer, _, settled = relaxed(program, model, tissue, True)
            held, _, held_settled = relaxed(program, model, tissue, True, HELD)
            list_of = lambda posture: math.degrees(posture["coordinates"]["pelvis_list"])
            kinds = [
                ("resting side hangs", lambda p: list_of(p) <= -LEVEL),
                ("pelvis level", lambda p: abs(list_of(p)) < LEVEL),
                ("resting side raised", lambda p: list_of(p) >= LEVEL),
            ]
            rows = [(kind, next(filter(wanted, answer["postures"]), None), settled) for kind, wanted in kinds]
            rows.append((f"hip held at {HELD_DEG} deg", held["postures"][0], held_settled))
            for kind, posture, settled in rows:
                shown = row(posture) if posture else "not found | | | |"
                end = "" if not posture else "yes" if settled else "no"
                print(f"| {pathlib.Path(model).stem} | {tissue} | {kind} | {shown} | {end} |", flush=True)
    print("\nOn both feet.\n")
    print("| model | tissue | effort | greatest load | knee extension, right, % | answer |")
    print("|---|---|---|---|---|---|")
    for model in models:
        for tissue in ["off", "mean"]:
            answer, _, _ = relaxed(program, model, tissue, False)
            best = answer["postures"][0]
            loads = {one["group"]: one for one in best["groups"] if one["coordinate"].endswith("_r") or "_" not in one["group"]}
            knee = next((one["relative_load"] for name, one in loads.items() if name.startswith("knee ext")), 0.0)
            group = max(best["groups"], key=lambda one: one["relative_load"])
            print(
                f"| {pathlib.Path(model).stem} | {tissue} | {best['effort']:.4f} | {group['group']} ({group['coordinate']}) "
                f"{100 * group['relative_load']:.1f} % | {100 * knee:.1f} | {answer['verdict']['sentence']} |",
                flush=True,
            )


main()
