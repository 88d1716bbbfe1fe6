#!/usr/bin/env python3
"""Compares joint centres of `motion.glb` and `motion.bvh` in Blender with those of our kinematics.

    python3.11 -m venv blendervenv && blendervenv/bin/pip install bpy==4.5.15
    blendervenv/bin/python scripts/compare_blender.py

The test `exchange_motion` of contrapposto-formats writes the motions and our points first. Prints the worst distance of each file; more
than 1e-5 m ends it with an error.
"""

import json
import math
import os
import pathlib
import subprocess
import tempfile

import bpy
import numpy

HERE = pathlib.Path(__file__).resolve().parent.parent
LIMIT = 1e-5


def exchange(folder):
    command = ["cargo", "test", "-q", "-p", "contrapposto-formats", "--test", "all", "write::motion::exchange_motion", "--", "--ignored", "--exact"]
    subprocess.run(command, cwd=HERE, check=True, env={**os.environ, "CONTRAPPOSTO_EXCHANGE": str(folder)})


def upright(place):
    """Blender's z is up; the files' y."""
    return numpy.array([place[0], place[2], -place[1]])


def by_gltf(path, names, seconds):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=str(path))
    scene = bpy.context.scene
    for time in seconds:
        frame = time * scene.render.fps / scene.render.fps_base
        scene.frame_set(math.floor(frame), subframe=frame - math.floor(frame))
        yield [upright(bpy.data.objects[name].matrix_world.translation) for name in names]


def by_bvh(path, names, rows):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_anim.bvh(filepath=str(path), global_scale=0.01, axis_forward="-Z", axis_up="Y", frame_start=1)
    scene, (armature,) = bpy.context.scene, [o for o in bpy.data.objects if o.type == "ARMATURE"]
    for row in rows:
        scene.frame_set(1 + row)
        yield [upright(armature.matrix_world @ armature.pose.bones[name].head) for name in names]


def main():
    with tempfile.TemporaryDirectory() as made:
        folder = pathlib.Path(made)
        exchange(folder)
        for i, model in enumerate(json.loads((folder / "answers.json").read_text())["models"]):
            # Every other station is a joint's centre.
            names = [station[0] for station in model["stations"][::2]]
            expected = numpy.array(model["points"])[:, ::2] @ numpy.array(model["directions"]).T
            rows = [k * model["every"] for k in range(len(expected))]
            gltf = list(by_gltf(folder / f"motion_{i}.glb", names, [row * model["step"] for row in rows]))
            bvh = list(by_bvh(folder / f"motion_{i}.bvh", names, rows))
            for kind, found in [("glb", gltf), ("bvh", bvh)]:
                worst = float(numpy.linalg.norm(numpy.array(found) - expected, axis=-1).max())
                print("blender", bpy.app.version_string, model["name"], kind, f"{worst:.1e} m")
                assert worst < LIMIT, (model["name"], kind)


if __name__ == "__main__":
    main()
