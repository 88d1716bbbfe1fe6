"""Carries out scenarios: one posture, the postures of least effort, a run over time."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import Any, TypeAlias

from contrapposto import _native
from contrapposto._toml import toml
from contrapposto.errors import InputError
from contrapposto._results import Equilibria, Pose, Record, Run

#: A scenario: the path of a file, its text (TOML), or a dictionary of the same words.
Scenario: TypeAlias = str | os.PathLike[str] | Mapping[str, Any]


def example(name: str) -> str:
    """The text (TOML) of a scenario that comes with the package, by its name in the folder `scenarios` of the repository: a job to
    begin with.

    >>> print(contrapposto.simulate(contrapposto.example("figure-08")).verdict.kind)
    holds
    """
    texts = dict(_native.examples())
    if name not in texts:
        raise InputError(f"no example has the name `{name}`; there are {', '.join(texts)}")
    return texts[name]


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
    """The scenario, and whether it is a text (else a path). A text has more than one line, or an `=` and is the name of no file."""
    if isinstance(scenario, Mapping):
        return toml(scenario), True
    if isinstance(scenario, os.PathLike):
        return os.fspath(scenario), False
    if isinstance(scenario, str):
        return scenario, "\n" in scenario or ("=" in scenario and not os.path.exists(scenario))
    raise InputError(f"scenario is {type(scenario).__name__}; it must be a path, a text (TOML) or a dictionary")
