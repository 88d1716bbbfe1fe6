"""Gives postures to MuJoCo, Pinocchio and OpenSim, and takes them back.

A joint of the other model and a coordinate of ours are the same where they have the same name, as they do of one file (URDF, MJCF) that
both read. Quaternions of this package and of MuJoCo have the order w, x, y, z; those of Pinocchio x, y, z, w. Free joints are a place (m)
and a quaternion in all three; `.mot` files of OpenSim have angles only.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from contrapposto._arrays import Array, line, postures, rows
from contrapposto.errors import InputError
from contrapposto.model import Model

#: Endings of the coordinates of a quaternion in the order of this package and of MuJoCo.
SCALAR_FIRST = ("qw", "qx", "qy", "qz")
#: The same in the order of Pinocchio.
SCALAR_LAST = ("qx", "qy", "qz", "qw")
_PLACE = ("tx", "ty", "tz")

#: Name of a joint, and the place and kind of its numbers: "free", "ball", "one", or "circle" (cosine and sine).
_Joint = tuple[str, int, str]


def to_mujoco(model: Model, q: Any, mj_model: Any, *, partial: bool = False) -> Array:
    """Postures as `qpos` of a `mujoco.MjModel`, shape (N, nq), or (nq,) of one. Coordinates that follow others have the values that
    these ask for. partial: joints that `model` does not have stay at `qpos0`, and coordinates that MuJoCo does not have are left out."""
    return _given(model, q, list(_mujoco(mj_model)), SCALAR_FIRST, np.array(mj_model.qpos0), partial)


def from_mujoco(model: Model, qpos: npt.ArrayLike, mj_model: Any, *, partial: bool = False) -> Array:
    """Postures from `qpos` of a `mujoco.MjModel`. partial: coordinates that MuJoCo does not have stay at their default."""
    return _taken(model, qpos, list(_mujoco(mj_model)), SCALAR_FIRST, int(mj_model.nq), partial)


def to_pinocchio(model: Model, q: Any, pin_model: Any, *, partial: bool = False) -> Array:
    """Postures as configurations of a `pinocchio.Model`, shape (N, nq), or (nq,) of one; as `to_mujoco`, with Pinocchio's neutral
    configuration."""
    joints = list(_pinocchio(pin_model))
    neutral = np.zeros(int(pin_model.nq))
    for _, at, kind in joints:
        if kind in ("free", "ball"):
            neutral[at + (6 if kind == "free" else 3)] = 1.0
        elif kind == "circle":
            neutral[at] = 1.0
    return _given(model, q, joints, SCALAR_LAST, neutral, partial)


def from_pinocchio(model: Model, configurations: npt.ArrayLike, pin_model: Any, *, partial: bool = False) -> Array:
    """Postures from configurations of a `pinocchio.Model`; angles of unlimited joints lie between -pi and pi."""
    return _taken(model, configurations, list(_pinocchio(pin_model)), SCALAR_LAST, int(pin_model.nq), partial)


def read_motion(
    model: Model, path: str | os.PathLike[str], *, degrees: bool | None = None
) -> tuple[Array, Array, tuple[str, ...]]:
    """Times (s, shape (N,)), postures (rad, m, shape (N, n)) and notes of a table of OpenSim (.mot, .sto) or a .csv file. Coordinates
    without a column stay at their default. degrees: whether its angles are degrees, else radians, whatever the file says."""
    times, table, notes = model._native.read_motion(path, degrees)
    return times[0], table, tuple(text for _, text in notes)


def write_motion(model: Model, path: str | os.PathLike[str], q: Any, times: npt.ArrayLike) -> None:
    """Writes postures with their times (s) as a .mot file that OpenSim plays, angles in degrees."""
    table, _ = postures(model._native, q)
    seconds = line("times", times)
    if len(seconds) != len(table):
        raise InputError(f"there are {len(seconds)} times and {len(table)} postures; there must be as many")
    model._native.write_motion(path, seconds[np.newaxis, :], table)


def _mujoco(mj_model: Any) -> Iterator[_Joint]:
    for index in range(int(mj_model.njnt)):
        # mjtJoint: free, ball, slide, hinge.
        kind = ("free", "ball", "one", "one")[int(mj_model.jnt_type[index])]
        # The reader of this package names a free joint without a name so.
        yield mj_model.joint(index).name or ("root" if kind == "free" else ""), int(mj_model.jnt_qposadr[index]), kind


def _pinocchio(pin_model: Any) -> Iterator[_Joint]:
    for name, joint in zip(list(pin_model.names)[1:], list(pin_model.joints)[1:]):
        kinds = {(1, 1): "one", (2, 1): "circle", (4, 3): "ball", (7, 6): "free"}
        kind = kinds.get((int(joint.nq), int(joint.nv)))
        if kind is None:
            raise InputError(f"joint `{name}` of Pinocchio is a {joint.shortname()}; accepted: joints with one freedom, balls, free joints")
        yield ("root" if kind == "free" and name == "root_joint" else name), int(joint.idx_q), kind


def _columns(model: Model, joints: list[_Joint], order: tuple[str, ...], partial: bool) -> Iterator[tuple[slice, list[int], str]]:
    """The numbers of each joint and the coordinates in their order, of the joints that both have."""
    place = {name: column for column, name in enumerate(model.coordinate_names)}
    strange = []
    for name, at, kind in joints:
        if kind in ("one", "circle"):
            names = [name]
        else:
            names = [f"{name}_{end}" for end in (*(_PLACE if kind == "free" else ()), *order)]
        if all(each in place for each in names):
            yield slice(at, at + (2 if kind == "circle" else len(names))), [place.pop(each) for each in names], kind
        else:
            strange.append(name)
    if partial:
        return
    if strange:
        raise InputError(f"the model has no coordinates for these joints of the other one: {', '.join(strange)}; or give partial=True")
    if place:
        raise InputError(f"the other model has no joints for these coordinates: {', '.join(place)}; or give partial=True")


def _given(model: Model, q: Any, joints: list[_Joint], order: tuple[str, ...], rest: Array, partial: bool) -> Array:
    table, single = postures(model._native, q)
    table = model._native.coupled(table)
    out = np.repeat(rest[np.newaxis, :], len(table), axis=0)
    for numbers, columns, kind in _columns(model, joints, order, partial):
        angles = table[:, columns]
        out[:, numbers] = np.hstack([np.cos(angles), np.sin(angles)]) if kind == "circle" else angles
    return out[0] if single else out


def _taken(model: Model, given: npt.ArrayLike, joints: list[_Joint], order: tuple[str, ...], width: int, partial: bool) -> Array:
    array = rows("qpos", given)
    if array.shape[1] != width:
        raise InputError(f"the configuration has {array.shape[1]} numbers; that of the other model has {width}")
    table = np.repeat(model.default_posture[np.newaxis, :], len(array), axis=0)
    for numbers, columns, kind in _columns(model, joints, order, partial):
        values = array[:, numbers]
        table[:, columns] = np.arctan2(values[:, 1:], values[:, :1]) if kind == "circle" else values
    return table[0] if np.ndim(given) == 1 else table
