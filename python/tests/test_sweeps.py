"""Tests sweeps and populations from Python: the program's files to the byte, by threads and by workers of Dask of which one is killed."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

import contrapposto
from contrapposto import InputError

BASE = """format = 1
title = "Held out"
[model]
adult = { sex = "male", stature_m = 1.75, mass_kg = 75, part = "right_arm" }
[posture]
arm_flex_r_deg = 60
elbow_flex_r_deg = 20
[coordinates]
free = ["elbow_flex_r"]
[[load]]
segment = "hand_r"
mass_kg = 3
[strategy]
kind = "active"
[run]
duration_s = 200
"""

PLAN = """base = "base.toml"
design = "sobol"
rows = 60
rows_per_part = 7
[parameters]
"model.adult.stature_m" = { normal = [1.7, 0.07], correlate = { "model.adult.mass_kg" = 0.5 } }
"model.adult.mass_kg" = { lognormal = [75, 0.16] }
"load.0.mass_kg" = { range = [0, 12] }
"model.adult.sex" = { list = ["female", "male"] }
"""


def files(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


@pytest.fixture(scope="session")
def plan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("plan")
    (folder / "base.toml").write_text(BASE)
    (folder / "plan.toml").write_text(PLAN)
    return folder / "plan.toml"


@pytest.fixture(scope="session")
def theirs(plan: Path, program: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder that the program writes."""
    out = tmp_path_factory.mktemp("program") / "out"
    subprocess.run([program, "sweep", str(plan), "--out", str(out)], check=True, capture_output=True)
    return out


def test_files_are_those_of_the_program_to_the_byte(plan: Path, theirs: Path, tmp_path: Path) -> None:
    seen: list[tuple[int, int]] = []
    found = contrapposto.sweep(plan, tmp_path / "out", progress=lambda done, rows: seen.append((done, rows)))
    assert files(tmp_path / "out") == files(theirs) and len(files(theirs)) == 10
    assert seen[-1] == (60, 60) and seen == sorted(seen)
    assert len(found) == 60 and len(found.files) == 9
    assert found.plan.seed == 0 and "correlate" in found.plan.plan and found.plan.scenario == BASE
    with pytest.raises(InputError, match="--resume keeps those"):
        contrapposto.sweep(plan, tmp_path / "out")
    again = contrapposto.sweep(plan, tmp_path / "out", resume=True, threads=1)
    assert files(again.folder) == files(theirs)


def test_a_dictionary_is_the_same_plan(
    theirs: Path, plan: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tomllib = pytest.importorskip("tomllib", reason="part of Python from 3.11 on")
    monkeypatch.chdir(plan.parent)
    found = contrapposto.sweep(tomllib.loads(PLAN), tmp_path / "out")
    ours = files(found.folder)
    assert {name: text for name, text in files(theirs).items() if name != "sweep.json"}.items() <= ours.items()


def test_tables_have_every_row_with_its_values(theirs: Path) -> None:
    pytest.importorskip("pandas")
    found = contrapposto.results(theirs)
    table = found.to_pandas()
    assert table.index.tolist() == list(range(60)) and table.index.name == "row"
    assert {"holds", "held_until", "cannot_be_done"} <= set(table["kind"])
    assert table["minutes"].notna()[table["kind"] == "held_until"].all() and table["minutes"].isna().any()
    assert (table["search_cut"] == False).all()  # noqa: E712
    assert set(table.attrs["columns"]) == {"row", *table.columns} and table.attrs["program"].startswith("contrapposto ")
    assert sum(len(part) for part in found.parts()) == 60
    assert table["load.0.mass_kg"].dtype == float and table["load.0.mass_kg"].between(0, 12).all()
    data = pytest.importorskip("xarray") and found.to_xarray()
    assert data["load"].sel(row=7).item() == table["load"][7] and "sum of" in data["effort"].attrs["meaning"]


def columns_of_pandas(paths: list[Path]) -> dict[str, list[Any]]:
    pandas: Any = pytest.importorskip("pandas")
    table = pandas.concat(pandas.read_parquet(path) for path in paths).astype(object)
    return {name: column.where(column.notna(), None).tolist() for name, column in table.items()}


def columns_of_polars(paths: list[Path]) -> dict[str, list[Any]]:
    polars: Any = pytest.importorskip("polars")
    columns: dict[str, list[Any]] = polars.scan_parquet(paths).collect().to_dict(as_series=False)
    return columns


def columns_of_duckdb(paths: list[Path]) -> dict[str, list[Any]]:
    duckdb: Any = pytest.importorskip("duckdb")
    result = duckdb.sql(f"select * from read_parquet({[str(path) for path in paths]}) order by row")
    return dict(zip(result.columns, map(list, zip(*result.fetchall()))))


READERS = [columns_of_pandas, columns_of_polars, columns_of_duckdb]


@pytest.mark.parametrize("read", READERS)
def test_readers_of_parquet_give_the_values_of_the_plan_and_of_the_csv_of_the_program(
    read: Any, plan: Path, program: str, tmp_path: Path
) -> None:
    """A grid of texts and numbers in one part of several pages, of which one row in five is refused; and the people of a population."""
    titles = ["=1+1", "a, \"b\"", "ü 🧍", "nan", ""]
    loads = [0.1, -1.0, 1 / 3, 2.0, 1e-300]
    text = PLAN.split("[parameters]")[0].replace("sobol", "grid").replace("rows = 60", "").replace("= 7", "= 5000")
    text += f'[parameters]\n"title" = {{ list = {json.dumps(titles, ensure_ascii=False)} }}\n'
    text += f'"load.0.mass_kg" = {{ list = {loads} }}\n"run.duration_s" = {{ range = [1, 2], levels = 101 }}\n'
    plan.with_name("grid.toml").write_text(text, encoding="utf-8")
    found = contrapposto.sweep(plan.with_name("grid.toml"), tmp_path / "out")
    columns = read(list(found.files))
    assert list(columns) == [column.name for column in found.plan.columns]
    rows = [(title, load, 1 + level / 100) for title in titles for load in loads for level in range(101)]
    assert columns["row"] == list(range(len(rows))) and len(rows) == 2525
    assert columns["title"] == [title for title, _, _ in rows]
    assert columns["load.0.mass_kg"] == [load for _, load, _ in rows]
    assert columns["run.duration_s"] == pytest.approx([seconds for _, _, seconds in rows], abs=1e-15)
    refused = [load < 0 for _, load, _ in rows]
    assert [kind == "refused" for kind in columns["kind"]] == refused
    assert [note is not None and "-1" in note for note in columns["note"]] == refused
    assert [cut is None for cut in columns["search_cut"]] == refused and not any(columns["search_cut"])
    assert [seconds is None for seconds in columns["seconds"]] == refused

    people = tmp_path / "people"
    command = [program, "population", str(plan.with_name("base.toml")), "--rows", "40", "--out", str(people)]
    subprocess.run(command, check=True, capture_output=True)
    columns = read(sorted(people.glob("rows/part-*.parquet")))
    with (people / "population.csv").open(newline="", encoding="utf-8") as file:
        lines = list(csv.DictReader(file))
    assert list(columns) == list(lines[0]) and len(lines) == 40
    shown = {True: "true", False: "false", None: ""}
    for name, values in columns.items():
        for value, line in zip(values, lines):
            if isinstance(value, (int, float)) and not isinstance(value, bool):
                assert float(line[name]) == value, name
            else:
                assert line[name] == shown.get(value, value), name


def test_a_part_says_what_wrote_it_and_what_its_columns_mean(theirs: Path) -> None:
    parquet: Any = pytest.importorskip("pyarrow.parquet")
    found = contrapposto.results(theirs)
    for path in found.files:
        facts = {key.decode(): text.decode() for key, text in parquet.read_metadata(path).metadata.items()}
        assert facts.pop("program") == found.plan.program == parquet.read_metadata(path).created_by
        assert path.name.endswith(f"-{facts.pop('key')}.parquet")
        assert facts == {f"column {column.name}": column.meaning for column in found.plan.columns}
        assert facts["column minutes"].startswith("min; ")


def test_an_unfinished_folder_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is not finished"):
        contrapposto.results(tmp_path)


def test_odd_plans_are_refused_and_nothing_is_written(plan: Path, tmp_path: Path) -> None:
    for change, words in (("rows = -1", "odd.toml:3:8"), ('base = "gone.toml"', "gone.toml")):
        odd = plan.with_name("odd.toml")
        key = change.split(" = ")[0]
        odd.write_text("\n".join(change if line.startswith(f"{key} =") else line for line in PLAN.splitlines()))
        with pytest.raises(InputError, match=words):
            contrapposto.sweep(odd, tmp_path / "out")
    with pytest.raises(InputError, match="threads is 0"):
        contrapposto.sweep(plan, tmp_path / "out", threads=0)
    assert not (tmp_path / "out").exists()


def test_ctrl_c_ends_within_a_fifth_of_a_second_and_leaves_whole_parts(plan: Path, tmp_path: Path) -> None:
    plan = plan.with_name("long.toml")
    plan.write_text(PLAN.replace("rows = 60", "rows = 60000"))
    script = (
        "import contrapposto, time\n"
        "told = []\n"
        "try:\n"
        f"    contrapposto.sweep({str(plan)!r}, {str(tmp_path / 'out')!r}, threads=1, resume=True,\n"
        "        progress=lambda done, rows: done >= 14 and not told and (told.append(1), print('under way', flush=True)))\n"
        "except KeyboardInterrupt:\n"
        "    print('interrupted', time.time(), flush=True)\n"
    )
    delays = []
    for _ in range(3):
        child = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
        assert child.stdout is not None and child.stdout.readline() == "under way\n"
        asked = time.time()
        os.kill(child.pid, signal.SIGINT)
        words = child.stdout.readline().split()
        child.wait()
        assert words[0] == "interrupted"
        delays.append(float(words[1]) - asked)
    assert min(delays) < 0.2, delays
    parts = [path for path in (tmp_path / "out").iterdir() if path.name.startswith("part-")]
    assert len(parts) >= 2
    pandas: Any = pytest.importorskip("pandas")
    assert all(len(pandas.read_parquet(path)) == 7 for path in parts)


def test_an_exception_of_a_progress_ends_the_sweep(plan: Path, tmp_path: Path) -> None:
    def odd(done: int, rows: int) -> None:
        raise RuntimeError("no")

    with pytest.raises(RuntimeError, match="no"):
        contrapposto.sweep(plan, tmp_path / "out", progress=odd)


@pytest.fixture
def cluster() -> Any:
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50
    ) as local, distributed.Client(local) as client:
        yield client


@pytest.mark.parametrize("number", [1, 2])
def test_workers_of_dask_of_which_one_or_all_are_killed_give_the_same_files(
    number: int, plan: Path, theirs: Path, tmp_path: Path, cluster: Any
) -> None:
    """Two processes; one or both are killed when a part is there; their parts are computed again, by others that take their place."""
    pids = list(cluster.run(os.getpid).values())
    assert len(set(pids)) == 2
    killed: list[int] = []

    def kill_once(done: int, rows: int) -> None:
        if not killed:
            killed.append(done)
            for pid in pids[:number]:
                os.kill(pid, signal.SIGKILL)

    found = contrapposto.sweep(plan, tmp_path / "out", client=cluster, progress=kill_once)
    assert killed and killed[0] < 60
    assert files(found.folder) == files(theirs)


def test_workers_compute_no_part_that_is_there(plan: Path, theirs: Path, tmp_path: Path, cluster: Any) -> None:
    out = tmp_path / "out"
    out.mkdir()
    parts = sorted(name for name in files(theirs) if name.startswith("part-"))
    for name in parts[2:]:
        (out / name).write_bytes((theirs / name).read_bytes())
    told: list[tuple[int, int]] = []
    contrapposto.sweep(plan, out, client=cluster, resume=True, progress=lambda *counts: told.append(counts))
    assert told == [(7, 14), (14, 14)] and files(out) == files(theirs)


def test_a_population_of_workers_of_which_one_is_killed_is_that_of_threads(plan: Path, tmp_path: Path, cluster: Any) -> None:
    base, pids = plan.with_name("base.toml"), list(cluster.run(os.getpid).values())
    killed: list[int] = []

    def kill_once(done: int, rows: int) -> None:
        if not killed:
            killed.append(done)
            os.kill(pids[0], signal.SIGKILL)

    theirs = contrapposto.population(base, 40, seed=3, out=tmp_path / "theirs")
    found = contrapposto.population(base, 40, seed=3, out=tmp_path / "ours", client=cluster, progress=kill_once)
    assert killed and killed[0] < 40 and found.summary == theirs.summary and found.html() == theirs.html()
    for folder in ("", "rows"):
        ours, expected = files(tmp_path / "ours" / folder), files(tmp_path / "theirs" / folder)
        assert ours == expected and len(ours) > 3
    with pytest.raises(InputError, match="--resume keeps them"):
        contrapposto.population(base, 40, seed=3, out=tmp_path / "ours", client=cluster)
    told: list[int] = []
    contrapposto.population(
        base, 44, seed=3, out=tmp_path / "ours", client=cluster, resume=True, progress=lambda done, rows: told.append(done)
    )
    assert len(told) == 1, "ten of eleven parts were there"
    with pytest.raises(InputError, match="give it as out"):
        contrapposto.population(base, 40, client=cluster)


def test_a_population_is_that_of_the_program(plan: Path, program: str, tmp_path: Path) -> None:
    base = plan.with_name("base.toml")
    command = [program, "population", str(base), "--rows", "12", "--seed", "3", "--out", str(tmp_path / "theirs")]
    subprocess.run(command, check=True, capture_output=True)
    found = contrapposto.population(base, 12, seed=3, out=tmp_path / "ours")
    assert {path: (tmp_path / "ours" / path).read_bytes() for path in ("population.json", "population.csv")} == {
        path: (tmp_path / "theirs" / path).read_bytes() for path in ("population.json", "population.csv")
    }
    assert files(tmp_path / "ours/rows") == files(tmp_path / "theirs/rows")
    assert found.html() == (tmp_path / "theirs/population.html").read_text() and "srcdoc" in found._repr_html_()
    assert found.sentence == found.summary.sentence and found.summary.women.bodies == 6
    without = contrapposto.population(BASE, 12, seed=3)
    assert without.summary.women == found.summary.women and without.summary.files == ()
    if pytest.importorskip("pandas"):
        table = found.to_pandas()
        assert len(table) == 12 and set(table["model.adult.sex"]) == {"female", "male"}
    for odd, words in (((3,), "even number"), ((0,), "even number"), ((12.0,), "whole number")):
        with pytest.raises(InputError, match=words):
            contrapposto.population(base, *odd)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="give it as out"):
        contrapposto.population(base, 12, resume=True)
