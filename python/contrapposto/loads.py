"""Defines the loads on a body: weights and forces on points of segments."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy.typing as npt

from contrapposto._arrays import Array, numbers
from contrapposto.errors import InputError

if TYPE_CHECKING:
    Numbers: TypeAlias = "npt.ArrayLike"
    Parts: TypeAlias = tuple[str, str, Array, tuple[float, float, float] | None, bool]


@dataclass(frozen=True)
class Weight:
    """A held mass, pulled by gravity.

    segment: name of the segment that carries it.
    mass: kg; one number, or N of them, one a posture.
    at: point in the segment's frame, m; its centre of mass when left out.
    """

    segment: str
    mass: Numbers
    at: Sequence[float] | None = None

    def _native(self) -> Parts:
        mass = numbers("mass of a Weight", self.mass)
        if mass.ndim > 1:
            raise InputError(f"mass of the Weight on `{self.segment}` has shape {mass.shape}; it must be a number, or (N,)")
        return ("weight", self.segment, mass.reshape(-1, 1), _point(self.at), False)


@dataclass(frozen=True)
class Force:
    """A force on a point of a segment.

    segment: name of the segment.
    force: N; three numbers, or (N, 3), one row a posture.
    at: point in the segment's frame, m; its centre of mass when left out.
    axes: "ground" where the force keeps its direction, "segment" where it turns with the segment.
    """

    segment: str
    force: Numbers
    at: Sequence[float] | None = None
    axes: Literal["ground", "segment"] = "ground"

    def _native(self) -> Parts:
        force = numbers("force of a Force", self.force)
        if force.ndim not in (1, 2) or force.shape[-1] != 3:
            raise InputError(f"force of the Force on `{self.segment}` has shape {force.shape}; it must be (3,) or (N, 3)")
        if self.axes not in ("ground", "segment"):
            raise InputError(f"axes of the Force on `{self.segment}` is {self.axes!r}; it must be 'ground' or 'segment'")
        return ("force", self.segment, force.reshape(-1, 3), _point(self.at), self.axes == "segment")


#: A load: `Weight`, `Force`, or a text as the program takes it ("hand_r 3kg", "hand_r 0,-20,0 at 0,-0.08,0").
Load: TypeAlias = str | Weight | Force


def _point(at: Sequence[float] | None) -> tuple[float, float, float] | None:
    if at is None:
        return None
    point = numbers("`at` of a load", at)
    if point.shape != (3,):
        raise InputError(f"`at` of a load has shape {point.shape}; it must be three numbers, m")
    x, y, z = (float(value) for value in point)
    return (x, y, z)


def native_loads(loads: Load | Sequence[Load]) -> list[Any]:
    """Loads as the compiled half takes them."""
    return [load if isinstance(load, str) else load._native() for load in _listed(loads)]


def load_words(loads: Load | Sequence[Load]) -> list[str]:
    """Loads at all times as options of the program."""
    return [f"--load={text}" if "kg" in text else f"--force={text}" for text in map(_text, _listed(loads))]


def _listed(loads: Load | Sequence[Load]) -> list[Load]:
    listed = [loads] if isinstance(loads, (str, Weight, Force)) else list(loads)
    for load in listed:
        if not isinstance(load, (str, Weight, Force)):
            raise InputError(f"{load!r} is no load; accepted: a Weight, a Force, or a text such as 'hand_r 3kg'")
    return listed


def _text(load: Load) -> str:
    if isinstance(load, str):
        return load
    _, segment, rows, at, in_segment = load._native()
    if len(rows) != 1:
        raise InputError(f"the load on `{segment}` has {len(rows)} rows; a load at all times has one")
    point = "" if at is None else f" at {_joined(at)}"
    if isinstance(load, Weight):
        return f"{segment} {float(rows[0, 0])!r}kg{point}"
    return f"{segment} {_joined(rows[0])}{point} {'segment' if in_segment else 'world'}"


def _joined(numbers: Any) -> str:
    return ",".join(repr(float(number)) for number in numbers)
