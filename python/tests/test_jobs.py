"""Tests jobs on scenarios: the program's words and numbers, pickling, pages, tables, Ctrl-C, and what is refused."""

from __future__ import annotations

import json
import os
import pickle
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import contrapposto
from conftest import REPOSITORY
from contrapposto import InputError
from contrapposto._results import Result

SCENARIOS = {
    "pose": REPOSITORY / "scenarios/poses/reach-shelf.toml",
    "relax": REPOSITORY / "scenarios/sit-slumped.toml",
    "simulate": REPOSITORY / "scenarios/figure-08.toml",
}
JSON = {"pose": "pose.json", "relax": "relax.json", "simulate": "summary.json"}


@pytest.fixture(scope="session")
def results() -> dict[str, Result]:
    return {kind: getattr(contrapposto, kind)(path) for kind, path in SCENARIOS.items()}


@pytest.mark.parametrize("kind", SCENARIOS)
def test_the_words_are_those_of_the_program(
    results: dict[str, Result], kind: str, program: str, tmp_path: Path
) -> None:
    options = ["--no-suggest"] if kind == "simulate" else []
    command = [program, kind, str(SCENARIOS[kind]), "--out", str(tmp_path), *options]
    subprocess.run(command, capture_output=True)
    theirs = json.loads((tmp_path / JSON[kind]).read_text())
    theirs["files"] = []
    assert results[kind].summary == contrapposto.Record(theirs)
    assert (tmp_path / "report.html").read_text() == results[kind].html()


@pytest.mark.parametrize("kind", SCENARIOS)
def test_results_are_frozen_and_pickle(results: dict[str, Result], kind: str, tmp_path: Path) -> None:
    result = results[kind]
    copy = pickle.loads(pickle.dumps(result))
    assert type(copy) is type(result)
    assert copy.verdict == result.verdict and copy.names == result.names
    for name in ("t", "q", "external", "passive", "active", "load", "fatigue"):
        assert getattr(copy, name).tobytes() == getattr(result, name).tobytes()
        with pytest.raises(ValueError, match="read-only"):
            getattr(copy, name)[...] = 1.0
        with pytest.raises(ValueError, match="read-only"):
            getattr(result, name)[...] = 1.0
    with pytest.raises(AttributeError, match="does not change"):
        result.q = None  # type: ignore[assignment]
    with pytest.raises(AttributeError, match="does not change"):
        result.verdict.kind = "holds"
    with pytest.raises(AttributeError, match="there are: "):
        result.verdict.nonsense
    assert copy.report(tmp_path / "page.html").read_text() == result.html()
    assert "srcdoc" in result._repr_html_()
    assert result.verdict.sentence in repr(result)


@pytest.mark.parametrize("kind", SCENARIOS)
def test_tables_and_charts(results: dict[str, Result], kind: str) -> None:
    pytest.importorskip("pandas")
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    result = results[kind]
    table = result.to_pandas()
    assert len(table) == len(result.t) > 0
    name = result.names[-1]
    np.testing.assert_array_equal(table[name]["load"], result.load[:, -1])
    assert result.plot().get_ylabel() == "load (% of strength)"
    assert result.plot(name).get_title() == result.verdict.sentence
    np.testing.assert_allclose(result.external + result.passive + result.active, 0, atol=1e-9)


@pytest.mark.parametrize("kind", SCENARIOS)
def test_arrays_have_names_for_xarray(results: dict[str, Result], kind: str, tmp_path: Path) -> None:
    pytest.importorskip("xarray")
    result = results[kind]
    data = result.to_xarray()
    name = result.names[-1]
    assert data["load"].sel(coordinate=name).values.tobytes() == result.load[:, -1].tobytes()
    assert data["active"].attrs["units"] == "N m" and data.attrs["verdict"] == result.verdict.sentence
    if kind == "simulate":
        assert data["fatigue"].sel(coordinate=name, sense="negative").values.tobytes() == result.fatigue[:, -1, 1].tobytes()
        assert float(data["load"].sel(t=result.t[-1], coordinate=name)) == result.load[-1, -1]
    else:
        assert "fatigue" not in data


def test_a_verdict_has_the_findings_behind_it(
    results: dict[str, Result], program: str, tmp_path: Path
) -> None:
    for kind, path in SCENARIOS.items():
        options = ["--no-suggest"] if kind == "simulate" else []
        said = subprocess.run([program, kind, str(path), "--out", str(tmp_path / kind), *options], capture_output=True, text=True)
        lines = results[kind].verdict.lines
        assert isinstance(lines, tuple)
        assert said.stdout.splitlines()[: 1 + len(lines)] == [results[kind].verdict.sentence, *lines]
    assert results["simulate"].verdict.lines


def test_a_text_and_a_dictionary_give_the_same_as_the_file(results: dict[str, Result]) -> None:
    if sys.version_info >= (3, 11):
        import tomllib

        words = tomllib.loads(SCENARIOS["pose"].read_text())
        assert contrapposto.pose(words).q.tobytes() == results["pose"].q.tobytes()
    text = SCENARIOS["simulate"].read_text()
    assert contrapposto.simulate(text).q.tobytes() == results["simulate"].q.tobytes()


def test_the_examples_are_the_scenarios_of_the_repository_that_need_no_other_file() -> None:
    files = {path.stem: path.read_text(encoding="utf-8") for path in (REPOSITORY / "scenarios").glob("*.toml")}
    needing_none = {name: text for name, text in files.items() if "file = " not in text}
    assert len(needing_none) > 20
    for name, text in needing_none.items():
        assert contrapposto.example(name) == text
    with pytest.raises(InputError, match="no example has the name `bus`; there are bus-stop, chatter, "):
        contrapposto.example("bus")


def test_texts_of_dictionaries_and_odd_names_arrive_as_they_are(tmp_path: Path) -> None:
    title = 'a "tool" \\ 🧍 ü'
    words = {"format": 1, "title": title, "run": {"duration_s": 1}, "strategy": {"kind": "active"}}
    words |= {"coordinates": {"free": ["elbow_flex_r"]}}
    assert contrapposto.simulate(words).summary.title == title
    for odd in ("\x7f", "\x01", "\n"):
        with pytest.raises(InputError, match="the title holds control characters"):
            contrapposto.simulate({**words, "title": odd})
    path = tmp_path / "a=b.toml"
    path.write_text(SCENARIOS["simulate"].read_text())
    assert contrapposto.simulate(str(path)).verdict == contrapposto.simulate(path).verdict


def test_errors_of_scenarios_have_their_place(tmp_path: Path) -> None:
    path = tmp_path / "job.toml"
    path.write_text(SCENARIOS["simulate"].read_text() + "\nnonsense = 3\n")
    with pytest.raises(InputError, match="nonsense") as error:
        contrapposto.simulate(path)
    assert error.value.file == str(path)
    assert error.value.line == len(path.read_text().splitlines())
    assert error.value.column == 1
    with pytest.raises(InputError, match="gone.toml"):
        contrapposto.pose(tmp_path / "gone.toml")
    with pytest.raises(InputError, match="a path, a text"):
        contrapposto.pose(3)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="is no value of a scenario"):
        contrapposto.pose({"model": object()})


def test_a_body_that_cannot_stand_has_a_verdict_and_no_row() -> None:
    ice = "on = { normal = [0.45, 1, 0] }\nfriction = 0\n"
    text = f'format = 1\n[[support]]\nsegment = "calcn_r"\n{ice}[[support]]\nsegment = "calcn_l"\n{ice}'
    result = contrapposto.relax(text)
    assert result.verdict.kind == "cannot_stand"
    assert result.q.shape[0] == 0
    with pytest.raises(contrapposto.JobError, match="cannot stand"):
        result.html()


def test_ctrl_c_ends_a_job_within_a_fifth_of_a_second() -> None:
    script = (
        "import threading, time, contrapposto\n"
        "threading.Thread(target=lambda: (time.sleep(0.3), print('under way', flush=True))).start()\n"
        "try:\n"
        f"    contrapposto.relax({str(REPOSITORY / 'scenarios/lean-on-table.toml')!r})\n"
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
        assert words and words[0] == "interrupted", "the job was done before"
        delays.append(float(words[1]) - asked)
    assert min(delays) < 0.2, delays
