"""Carries out scenarios: one posture, the postures of least effort, a run over time."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import Any, TypeAlias

from contrapposto import _native
from contrapposto.errors import InputError
from contrapposto.results import Equilibria, Pose, Record, Run

#: A scenario: the path of a file, its text (TOML), or a dictionary of the same words.
Scenario: TypeAlias = str | os.PathLike[str] | Mapping[str, Any]


def pose(scenario: Scenario) -> Pose:
    """Solves one posture from tasks in strict order of priority, as `contrapposto pose`."""
    return Pose._run(_native.Job.run, "pose", *source_of(scenario), False)


def relax(scenario: Scenario) -> Equilibria:
    """Finds the different postures of least effort under the tasks, and their stability, as `contrapposto relax`."""
    return Equilibria._run(_native.Job.run, "relax", *source_of(scenario), False)


def simulate(scenario: Scenario, *, suggest: bool = False) -> Run:
    """Runs a scenario over time, as `contrapposto simulate`. With `suggest` changes of a job that does not hold are tried, too, which
    takes several times as long; `summary.suggestions` has those that help."""
    return Run._run(_native.Job.run, "simulate", *source_of(scenario), bool(suggest))


def minimize(problem: Mapping[str, Any], *, literal: bool = False) -> Record:
    """Decides a single joint, in the words of a line of `contrapposto minimize`; `literal` follows the printed tables of the paper to
    the letter."""
    try:
        text = json.dumps(dict(problem), allow_nan=False)
    except (TypeError, ValueError) as error:
        raise InputError(f"the problem is no JSON object of finite numbers and texts: {error}") from None
    return Record(json.loads(_native.minimize(text, literal)))


def source_of(scenario: Scenario) -> tuple[str, bool]:
    """The scenario, and whether it is a text (else a path). A text has more than one line, or an `=`."""
    if isinstance(scenario, Mapping):
        return "".join(f"{_key(key)} = {_toml(value)}\n" for key, value in scenario.items()), True
    if isinstance(scenario, os.PathLike):
        return os.fspath(scenario), False
    if isinstance(scenario, str):
        return scenario, "\n" in scenario or "=" in scenario
    raise InputError(f"scenario is {type(scenario).__name__}; it must be a path, a text (TOML) or a dictionary")


def _key(key: object) -> str:
    if not isinstance(key, str):
        raise InputError(f"the key {key!r} of a scenario is no text")
    return json.dumps(key)


def _toml(value: Any) -> str:
    """The value in TOML, tables in one line."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_key(key)} = {_toml(item)}" for key, item in value.items()) + "}"
    if hasattr(value, "tolist"):  # arrays and numbers of numpy
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_toml(item) for item in value) + "]"
    if isinstance(value, (bool, str)):
        return json.dumps(value)
    if isinstance(value, (int, float)):
        # TOML writes inf and nan as Python does.
        return repr(value)
    raise InputError(f"{value!r} is no value of a scenario; accepted: texts, numbers, lists and dictionaries")
