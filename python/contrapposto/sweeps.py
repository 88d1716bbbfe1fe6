"""Runs a scenario for many bodies, loads or other values: on this machine, or by the workers of Dask."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from contrapposto import _native
from contrapposto.errors import InputError
from contrapposto.jobs import Scenario, source_of
from contrapposto._results import PAGE_HEIGHT, Record, framed

if TYPE_CHECKING:
    import pandas  # type: ignore[import-untyped, unused-ignore]

#: Called from time to time with the number of finished runs and of all runs.
Progress: TypeAlias = Callable[[int, int], object]


def sweep(
    plan: Scenario,
    out: str | os.PathLike[str],
    *,
    client: Any = None,
    resume: bool = False,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Results:
    """Carries out a plan of many runs, as `contrapposto sweep`, with the same files to the byte.

    plan: as a scenario: the path of a file, its text, or a dictionary of the same words. The base of a text or a dictionary is seen
        from the present folder.
    out: folder for the parts, which appear whole; `sweep.json` is written last.
    client: a `distributed.Client`: its workers compute one part a task, and this process writes them. Parts of a worker that dies are
        computed again by another one. Without a client threads of this process compute, `threads` or all cores.
    resume: keep the parts of the same plan, scenario and version that the folder has. Parts of another plan are removed when all parts
        of this one are there.
    progress: called with the number of finished runs and of all runs. Ctrl-C ends within 0.2 s; finished parts stay.
    """
    native = _native.Sweep(*source_of(plan))
    threads = _threads(threads)
    folder = native.folder(out, resume)
    try:
        if client is None:
            folder.fill(threads, progress)
        else:
            _by_workers(native, folder, client, progress)
        folder.finish()
    finally:
        folder.close()
    return results(out)


def _by_workers(native: _native.Sweep, folder: _native.SweepFolder, client: Any, progress: Progress | None) -> None:
    """Parts from the workers of Dask. Each part is a task of the same bytes, so that it can be computed anywhere and again."""
    import distributed

    as_completed: Any = distributed.as_completed
    state, missing = native.state(), folder.missing
    # A task, not scattered data: where all workers that have it die, it is computed again.
    shared = client.submit(bytes, state, pure=False)
    futures = {client.submit(_part, shared, part, pure=False): part for part in missing}
    rows, done = sum(map(native.rows_of, missing)), 0
    try:
        for future in as_completed(list(futures)):
            part = futures.pop(future)
            folder.write(part, future.result())
            # The scheduler need not keep what is on the disk.
            future.release()
            done += native.rows_of(part)
            if progress is not None:
                progress(done, rows)
    except BaseException:
        client.cancel(list(futures))
        raise


#: The last sweep of this worker, and its bytes.
_opened: list[tuple[bytes, _native.Sweep]] = []


def _part(state: bytes, part: int) -> bytes:
    """The bytes of a part, in a worker."""
    if not _opened or _opened[0][0] != state:
        _opened[:] = [(state, _native.Sweep.from_state(state))]
    return _opened[0][1].part(part)


def results(out: str | os.PathLike[str]) -> Results:
    """The finished sweep in a folder. No part is read yet."""
    path = Path(out)
    try:
        text = (path / "sweep.json").read_text(encoding="utf-8")
    except FileNotFoundError:
        raise InputError(f"{path} has no sweep.json: the sweep is not finished; contrapposto.sweep(..., resume=True) goes on") from None
    return Results(path, Record(json.loads(text)))


class Results:
    """The answers of a sweep in a folder: `plan` has the words of `sweep.json`, with all columns and their units; parts are read when
    they are asked for."""

    __slots__ = ("folder", "plan")

    def __init__(self, folder: Path, plan: Record) -> None:
        self.folder, self.plan = folder, plan

    @property
    def files(self) -> tuple[Path, ...]:
        """The parts, Parquet files in the order of their rows: for `polars.scan_parquet`, DuckDB and Dask's data frames."""
        return tuple(self.folder / name for name in self.plan.parts)

    def __len__(self) -> int:
        return int(self.plan.rows)

    def parts(self) -> Iterator[pandas.DataFrame]:
        """Tables, one a part."""
        import pandas

        for file in self.files:
            yield pandas.read_parquet(file, engine="pyarrow")

    def to_pandas(self) -> pandas.DataFrame:
        """One table of all rows (index `row`); `attrs` has the meaning of each column, the program and the plan."""
        import pandas

        table = pandas.concat(self.parts()).set_index("row")
        table.attrs["columns"] = {column.name: column.meaning for column in self.plan.columns}
        table.attrs["program"], table.attrs["plan"] = self.plan.program, self.plan.plan
        return table

    def to_xarray(self) -> Any:
        """All columns over `row`, with the meaning of each."""
        data: Any = self.to_pandas().to_xarray()
        for column in self.plan.columns:
            data[column.name].attrs["meaning"] = column.meaning
        return data.assign_attrs(program=self.plan.program, plan=self.plan.plan)

    def __repr__(self) -> str:
        return f"<contrapposto.Results: {len(self)} rows in {len(self.files)} parts of {str(self.folder)!r}>"


def population(
    scenario: Scenario,
    rows: int = 200,
    *,
    seed: int = 0,
    out: str | os.PathLike[str] | None = None,
    client: Any = None,
    resume: bool = False,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Population:
    """The percent of women and of men who can hold a job, as `contrapposto population`: `rows` bodies, half of them women.

    out: folder for the files of the program; nothing is written without it, and workers (`client`) need it. The other arguments are those
        of `sweep`.
    """
    for name, value, most in (("rows", rows, 100_000), ("seed", seed, 0x7FFF_FFFF)):
        if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value <= most:
            raise InputError(f"{name} is {value!r}; it must be a whole number from 0 to {most}")
    if rows < 2 or rows % 2:
        raise InputError(f"rows is {rows}; it must be an even number from 2 on: half are women, half are men")
    if resume and out is None:
        raise InputError("resume keeps the bodies of a folder; give it as out")
    threads = _threads(threads)
    if client is not None:
        if out is None:
            raise InputError("the bodies of the workers are kept in a folder; give it as out")
        native = _native.Sweep.population(*source_of(scenario), rows, seed)
        folder = native.folder(out, resume)
        try:
            _by_workers(native, folder, client, progress)
        finally:
            folder.close()
        # All bodies are there now, to be counted.
        resume, progress = True, None
    return Population(*_native.population(*source_of(scenario), rows, seed, out, resume, threads, progress))


class Population:
    """The answers of a population: `summary` has the words of `population.json`."""

    __slots__ = ("_table", "_page", "summary")

    def __init__(self, summary: str, table: str, page: str) -> None:
        self.summary, self._table, self._page = Record(json.loads(summary)), table, page

    @property
    def sentence(self) -> str:
        """The answer in one sentence."""
        return str(self.summary.sentence)

    def to_pandas(self) -> pandas.DataFrame:
        """A row a body (index `row`)."""
        import io

        import pandas

        # An empty cell is no value; a text such as "nan" stays a text.
        options: dict[str, Any] = {"keep_default_na": False, "na_values": [""], "index_col": "row"}
        if int(pandas.__version__.split(".")[0]) < 3:  # later ones read to the last bit, and warn of the option
            options["float_precision"] = "round_trip"
        return pandas.read_csv(io.StringIO(self._table), **options)

    def html(self) -> str:
        """The page of the program."""
        return self._page

    def report(self, path: str | os.PathLike[str]) -> Path:
        """Writes the page of the program; gives its path."""
        path = Path(path)
        path.write_text(self._page, encoding="utf-8")
        return path

    def _repr_html_(self) -> str:
        return framed(self._page, PAGE_HEIGHT)

    def __repr__(self) -> str:
        return f"<contrapposto.Population: {self.sentence}>"


def _threads(threads: int | None) -> int | None:
    if threads is not None and (not isinstance(threads, int) or isinstance(threads, bool) or not 1 <= threads <= 1024):
        raise InputError(f"threads is {threads!r}; it must be a whole number from 1 to 1024")
    return threads
