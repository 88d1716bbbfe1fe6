"""Assesses recorded motions."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from contrapposto import _native
from contrapposto._arrays import line, postures
from contrapposto.errors import InputError
from contrapposto.loads import Load, load_words
from contrapposto.model import Model, Muscles
from contrapposto._results import Assessment

#: Name of a file.
Name: TypeAlias = str | os.PathLike[str]


def assess(
    model: Model,
    motion: Any,
    times: npt.ArrayLike | None = None,
    *,
    degrees: bool | None = None,
    loads: Load | Sequence[Load] = (),
    support: Sequence[str] = (),
    patch: Sequence[str] = (),
    grf: Name | None = None,
    grf_on: Sequence[str] = (),
    fixed_root: bool = False,
    inertia: bool | None = None,
    cutoff_hz: float | None = None,
    muscles: Muscles | None = None,
    fatigue: Literal["joint", "muscle_group"] = "joint",
    fatigue_sex: Literal["female", "male", "any"] | None = None,
    angle_error: float | None = None,
    start: float | None = None,
    end: float | None = None,
    repeat: float | None = None,
    every: float | None = None,
    work: float | None = None,
    rest: float | None = None,
    suggest: bool = False,
) -> Assessment:
    """Finds the muscle group that fails first in a recorded motion, when, and its relief, as `contrapposto assess`.

    motion: the path of a .mot, .sto or .csv file; or postures (rad, m) of shape (N, n), or a table or dictionary with names of
        coordinates, with `times`.
    times: of the postures, s, rising; only where the motion is no file.
    degrees: whether the angles of a file are degrees, else radians, whatever the file says; a plain column of a .csv file says nothing.
    loads: weights and forces at all times, as for `Model.torques`.
    support: segments that carry the body in every posture; `patch`: texts "calcn_r 0.1,-0.02,0.04 ..." of the corners (m, in the
        segment's frame) of those whose sole is not known.
    grf: table of ground reactions (.mot, .sto) or OpenSim's ExternalLoads file; `grf_on`: the segments that they act on.
    fixed_root: nothing carries the body, and the muscles alone are judged.
    inertia: whether it counts; where the motion is fast when left out. `cutoff_hz`: of the low-pass filter of the motion then.
    muscles: as for `Model.torques`, and their strength.
    fatigue, fatigue_sex: published parameters of the law of fatigue.
    angle_error: error of the given angles, rad: muscles that work against ligaments are judged at the angle within it where they work
        least; 5 degrees when left out.
    start, end: leave out postures before and after, s.
    repeat: the motion, one whole cycle, is repeated for this time, s, breaks included; `every`: time from the start of a cycle to that of
        the next, s; `work`, `rest`: time before each break and length of a break, s.
    suggest: changes of a motion that does not hold are tried, too: `summary.suggestions`.
    """
    if isinstance(support, str) or isinstance(patch, str) or isinstance(grf_on, str):
        raise InputError("support, patch and grf_on are lists of texts")
    words = load_words(loads)
    if support:
        words.append(f"--support={','.join(support)}")
    words += [f"--patch={text}" for text in patch]
    if grf is not None:
        words.append(f"--grf={os.fspath(grf)}")
    if grf_on:
        words.append(f"--grf-on={','.join(grf_on)}")
    error = None if angle_error is None else math.degrees(angle_error)
    numbers = {"cutoff-hz": cutoff_hz, "angle-error": error, "from": start, "to": end}
    spans = {"repeat": repeat, "every": every, "work": work, "break": rest}
    words += [f"--{key}={value!r}s" for key, value in spans.items() if value is not None]
    names = {"muscles": muscles, "fatigue": fatigue, "fatigue-sex": fatigue_sex}
    words += [f"--{key}={value!r}" for key, value in numbers.items() if value is not None]
    words += [f"--{key}={value}" for key, value in names.items() if value is not None]
    switches = {"fixed-root": fixed_root, "dynamics": inertia is True, "static": inertia is False, "no-suggest": not suggest}
    switches |= {"degrees": degrees is True, "radians": degrees is False}
    words += [f"--{key}" for key, on in switches.items() if on]
    path, rows = _motion(model, motion, times)
    return Assessment._run(_assess, model, path, rows, words)


def _assess(model: Model, path: str | None, rows: Any, words: list[str]) -> _native.Job:
    return _native.Job.assess(model._native, path, rows, words)


def _motion(model: Model, motion: Any, times: npt.ArrayLike | None) -> tuple[str | None, Any]:
    if isinstance(motion, (str, os.PathLike)):
        if times is not None:
            raise InputError("times are those of the file; leave them out")
        return str(Path(motion)), None
    if times is None:
        raise InputError("a motion that is no file needs times (s), one a posture")
    table, _ = postures(model._native, motion)
    seconds = line("times", times)
    if len(seconds) != len(table):
        raise InputError(f"there are {len(seconds)} times and {len(table)} postures; there must be as many")
    if table.shape[1] != len(model.coordinate_names):
        raise InputError(f"postures have {table.shape[1]} values; the model has {len(model.coordinate_names)} coordinates")
    return None, (seconds[np.newaxis, :], table)
