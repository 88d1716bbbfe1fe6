"""Defines the results of jobs: frozen, picklable, with tables, charts and the page of the program."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from contrapposto import _native
from contrapposto._arrays import Array

if TYPE_CHECKING:
    import pandas  # type: ignore[import-untyped, unused-ignore]
    import xarray

    from contrapposto._native import Job

R = TypeVar("R", bound="Result")

#: Height of the page in a notebook, pixels.
PAGE_HEIGHT = 720


class Record(Mapping[str, Any]):
    """The words of a JSON file, as keys and as attributes: `verdict["kind"]` is `verdict.kind`. It does not change."""

    __slots__ = ("_words",)
    _words: dict[str, Any]

    def __init__(self, words: Mapping[str, Any]) -> None:
        object.__setattr__(self, "_words", {key: _frozen(value) for key, value in words.items()})

    def __getitem__(self, key: str) -> Any:
        return self._words[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._words)

    def __len__(self) -> int:
        return len(self._words)

    def __getattr__(self, name: str) -> Any:
        if name == "_words":
            raise AttributeError(name)
        try:
            return self._words[name]
        except KeyError:
            raise AttributeError(f"there is no {name!r}; there are: {', '.join(self._words)}") from None

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError("a result does not change")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._words]

    def __reduce__(self) -> tuple[Any, ...]:
        return (Record, (self._words,))

    def __repr__(self) -> str:
        return f"Record({self._words!r})"


def _frozen(value: Any) -> Any:
    if isinstance(value, Mapping):
        return Record(value)
    if isinstance(value, (list, tuple)):
        return tuple(_frozen(item) for item in value)
    return value


def framed(page: str, height: int) -> str:
    """A page inside another one, `height` pixels high."""
    inside = html.escape(page, quote=True)
    return f'<iframe srcdoc="{inside}" style="width:100%;height:{height}px;border:0" sandbox="allow-scripts"></iframe>'


class Result:
    """The result of a job. Each array has one row a moment or posture, and one column a coordinate."""

    __slots__ = ("_native", "_job", "names", "t", "q", "external", "passive", "active", "load", "fatigue", "summary", "notes")

    #: Names of the coordinates, in the order of the columns.
    names: tuple[str, ...]
    #: Times, s; zeros where time has no part.
    t: Array
    #: Values of the coordinates: rad, m, components of quaternions.
    q: Array
    #: External torque, N m, with contact forces; of three-axis joints about the axes that stand for their coordinates, as all below.
    external: Array
    #: Passive torque, N m.
    passive: Array
    #: Active torque, N m.
    active: Array
    #: Active torque over the strength of its muscle group.
    load: Array
    #: Fatigue of the positive and the negative muscle group, shape (N, n, 2); (0, n, 2) where time has no part.
    fatigue: Array
    #: The words of the program's JSON file.
    summary: Record
    #: Notes of the reader.
    notes: tuple[str, ...]

    _native: Job | None
    #: How to do the job again: a function that picklable arguments go to, and these.
    _job: tuple[Callable[..., Job], tuple[Any, ...]]

    def __init__(self) -> None:
        raise TypeError("results are made by jobs: contrapposto.pose, relax, simulate, assess")

    @classmethod
    def _run(cls: type[R], make: Callable[..., Job], *arguments: Any) -> R:
        native, job = make(*arguments), (make, arguments)
        names, (times, *columns, fatigue) = native.frames()
        fatigue = fatigue.reshape(len(fatigue), len(names), 2)
        notes = tuple(text for _, text in native.notes)
        return cls._of(native, job, (tuple(names), times[0], *columns, fatigue, Record(json.loads(native.json)), notes))

    @classmethod
    def _of(cls: type[R], native: Job | None, job: tuple[Callable[..., Job], tuple[Any, ...]], parts: tuple[Any, ...]) -> R:
        result = object.__new__(cls)
        object.__setattr__(result, "_native", native)
        object.__setattr__(result, "_job", job)
        for name, part in zip(Result.__slots__[2:], parts):
            if isinstance(part, np.ndarray):
                part.flags.writeable = False
            object.__setattr__(result, name, part)
        return result

    def __reduce__(self) -> tuple[Any, ...]:
        return (type(self)._of, (None, self._job, tuple(getattr(self, name) for name in Result.__slots__[2:])))

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError("a result does not change")

    @property
    def verdict(self) -> Record:
        """The answer, in the words of `verdict` in the program's JSON: `kind`, `sentence`, `lines` (the findings behind it), `minutes`,
        `who`, ..."""
        verdict: Record = self.summary["verdict"]
        return verdict

    def __repr__(self) -> str:
        return f"<contrapposto.{type(self).__name__}: {self.verdict.sentence}>"

    def html(self) -> str:
        """The page of the program, one HTML text that needs no network. A result that was pickled does its job again for it."""
        make, arguments = self._job
        return (self._native or make(*arguments)).report()

    def report(self, path: str | os.PathLike[str]) -> Path:
        """Writes the page of the program; gives its path."""
        path = Path(path)
        path.write_text(self.html(), encoding="utf-8")
        return path

    def _repr_html_(self) -> str:
        return framed(self.html(), PAGE_HEIGHT)

    def to_pandas(self) -> pandas.DataFrame:
        """One row a moment or posture (index `t`, s), and columns (coordinate, quantity)."""
        import pandas

        kinds = {"q": self.q, "external": self.external, "passive": self.passive, "active": self.active, "load": self.load}
        if len(self.fatigue):
            kinds["fatigue_positive"], kinds["fatigue_negative"] = self.fatigue[..., 0], self.fatigue[..., 1]
        stacked = np.stack(list(kinds.values()), axis=2)
        columns = pandas.MultiIndex.from_product([self.names, kinds], names=["coordinate", "quantity"])
        index = pandas.Index(self.t, name="t")
        table = pandas.DataFrame(stacked.reshape(len(self.t), -1), index=index, columns=columns)
        table.attrs["verdict"] = self.verdict.sentence
        return table

    def to_xarray(self) -> xarray.Dataset:
        """The arrays over `t` (s), `coordinate` and `sense` of the muscle group."""
        import xarray

        kinds = {"external": "N m", "passive": "N m", "active": "N m", "load": "1"}
        over = ("t", "coordinate")
        columns: dict[str, Any] = {name: (over, getattr(self, name), {"units": unit}) for name, unit in kinds.items()}
        columns["q"] = (over, self.q, {"units": "rad, m or 1 (components of quaternions)"})
        if len(self.fatigue):
            columns["fatigue"] = ((*over, "sense"), self.fatigue, {"units": "1"})
        places = {"t": ("t", self.t, {"units": "s"}), "coordinate": list(self.names), "sense": ["positive", "negative"]}
        provenance = {"verdict": self.verdict.sentence, "program": f"contrapposto {_native.__version__}"}
        return xarray.Dataset(columns, places, provenance)

    def plot(self, *coordinates: str, ax: Any = None) -> Any:
        """Draws the loads of coordinates with matplotlib: of a run over time, of postures as bars. Without names: of the six with the
        greatest load. Gives the axes."""
        import matplotlib.pyplot as plt

        if not coordinates:
            greatest = self.load.max(axis=0, initial=0.0)
            coordinates = tuple(self.names[i] for i in np.argsort(-greatest)[:6])
        columns = [self.names.index(name) for name in coordinates]
        ax = plt.subplots()[1] if ax is None else ax
        if len(self.fatigue):
            for name, column in zip(coordinates, columns):
                ax.plot(self.t, 100 * self.load[:, column], label=name)
            ax.set_xlabel("time (s)")
            ax.legend()
        else:
            width = 0.8 / max(len(self.t), 1)
            for row in range(len(self.t)):
                places = np.arange(len(columns)) + row * width
                ax.bar(places, 100 * self.load[row, columns], width, label=f"posture {row + 1}")
            ax.set_xticks(range(len(columns)), coordinates, rotation=30, ha="right")
            if len(self.t) > 1:
                ax.legend()
        ax.set_ylabel("load (% of strength)")
        ax.set_title(self.verdict.sentence, fontsize="small", wrap=True)
        return ax


class Pose(Result):
    """A posture that was solved from tasks: one row. `summary.levels` has the remaining error of every task."""

    __slots__ = ()


class Equilibria(Result):
    """The different postures of least effort, the one of least effort first; no row for a body that cannot stand.
    `summary.postures` has their stability, the joints on ligaments and the muscle groups at work."""

    __slots__ = ()


class Run(Result):
    """A run over time. A long run keeps every second, third, ... sample. `summary` has reliefs, steps, suggestions and failures."""

    __slots__ = ()


class Assessment(Result):
    """A recorded motion that was assessed, a row a posture. `summary.groups` has the muscle groups, the worst first, with their peaks,
    the time at which each fails, and changes of posture that would relieve it; its peaks are judged within the error of the angles, `load`
    is that of the angles as they are given."""

    __slots__ = ()
