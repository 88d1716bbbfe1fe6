"""Solves and follows moving targets: the tasks of a scenario in strict order of priority, for many targets, or one step a call."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from contrapposto import _native
from contrapposto._arrays import Array, numbers, rows
from contrapposto.errors import InputError
from contrapposto.jobs import Scenario, source_of

Targets = Mapping[str, npt.ArrayLike]


class Engine:
    """The tasks of a scenario, whose targets may move.

    scenario: as for `contrapposto.pose`.
    max_step: largest change of a coordinate in one step, rad or m; that of the scenario when left out.

    A target is named as in `tasks` ("point hand_r"): three numbers (m) of a point; three, or seven (m, then a quaternion w, x, y, z),
    of a placement; four of an orientation. It stays until it is moved again. An engine serves one thread at a time.
    """

    __slots__ = ("_native", "_errors")

    def __init__(self, scenario: Scenario, *, max_step: float | None = None) -> None:
        self._native = _native.Engine(*source_of(scenario), max_step)
        self._errors: Array | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the coordinates."""
        return tuple(self._native.names)

    @property
    def tasks(self) -> tuple[str, ...]:
        """Names of the tasks, the most important first."""
        return tuple(self._native.tasks)

    @property
    def start(self) -> Array:
        """The posture in which the scenario starts, shape (n,)."""
        start: Array = self._native.start[0]
        return start

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes of the reader."""
        return tuple(text for _, text in self._native.notes)

    @property
    def errors(self) -> Array | None:
        """Length of the error of every priority level: where the last step began, or after the last solve."""
        return self._errors

    def step(self, q: npt.ArrayLike, targets: Targets | None = None) -> Array:
        """Makes one step from the posture `q` (n,) toward the targets; gives the new posture."""
        row = rows("q", q)
        if len(row) != 1:
            raise InputError(f"q has {len(row)} rows; a step is made of one posture")
        moved, errors = self._advance(row, targets, False)
        self._errors = errors[0]
        posture: Array = moved[0]
        return posture

    def solve(self, targets: Targets | None = None, q: npt.ArrayLike | None = None) -> Array:
        """Solves for the targets, each of shape (k,), or (N, k) for N postures at once; gives postures (n,) or (N, n). Each begins in
        `q`, (n,) or (N, n), the scenario's start when left out, and does not depend on the others."""
        given = {name: numbers(f"target of {name!r}", target) for name, target in (targets or {}).items()}
        start = self._native.start if q is None else rows("q", q)
        counts = {len(target) for target in given.values() if target.ndim == 2} | ({len(start)} - {1})
        if len(counts) > 1:
            raise InputError(f"targets and q have {sorted(counts)} rows; all must have as many, or one")
        many = bool(counts) or (q is not None and np.ndim(q) == 2)
        count = counts.pop() if counts else len(start)
        solved, errors = self._advance(np.repeat(start, count, axis=0) if len(start) == 1 else start, given, True)
        self._errors = errors if many else errors[0]
        return solved if many else solved[0]

    def _advance(self, q: Array, targets: Mapping[str, Any] | None, solve: bool) -> tuple[Array, Array]:
        named = [(name, rows(f"target of {name!r}", target)) for name, target in (targets or {}).items()]
        for name, target in named:
            if len(target) not in (1, len(q)):
                raise InputError(f"target of {name!r} has {len(target)} rows; it must have 1, or {len(q)}, one a posture")
        return self._native.advance(q, named, solve)
