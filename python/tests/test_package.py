"""Tests the package as a whole: Ctrl-C, the program, threads, and the time that it takes to import."""

from __future__ import annotations

import os
import signal
import statistics
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

import pytest

import contrapposto
from contrapposto._program import arguments


def time_to_interrupt() -> float:
    """Seconds from Ctrl-C in the middle of a long call to KeyboardInterrupt."""
    script = (
        "import numpy as np, threading, time, contrapposto\n"
        "model = contrapposto.Model.adult()\n"
        "q = np.zeros((400_000, 45))\n"
        # The interpreter's lock is free again once the inputs are copied.
        "threading.Thread(target=lambda: (time.sleep(0.1), print('copied', flush=True))).start()\n"
        "try:\n"
        "    model.torques(q)\n"
        "except KeyboardInterrupt:\n"
        "    print('interrupted', time.time(), flush=True)\n"
    )
    child = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    assert child.stdout is not None and child.stdout.readline() == "copied\n"
    asked = time.time()
    os.kill(child.pid, signal.SIGINT)
    words = child.stdout.readline().split()
    child.wait()
    assert words and words[0] == "interrupted", "the torques were ready before: give more rows"
    return float(words[1]) - asked


def test_ctrl_c_raises_keyboard_interrupt_within_a_fifth_of_a_second() -> None:
    assert min(time_to_interrupt() for _ in range(3)) < 0.2


def test_the_program_of_the_package_shows_its_version_and_refuses_bad_words() -> None:
    def run(*words: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run([sys.executable, "-m", "contrapposto", *words], capture_output=True, text=True)

    assert run("--version").stdout == f"contrapposto {contrapposto.__version__}\n"
    assert run("--nonsense").returncode == 2
    refused = run("pose", "no-such-file.toml", "--out", "out")
    assert refused.returncode == 2 and "no-such-file.toml" in refused.stderr
    schema = run("schema")
    assert schema.returncode == 0 and schema.stdout.startswith("{")


def test_the_program_of_the_package_carries_out_the_demo(tmp_path: Path) -> None:
    code = "from contrapposto._program import main; main()"
    words = ["demo", "--figure-8", "--out", str(tmp_path / "out")]
    subprocess.run([sys.executable, "-c", code, *words], check=True, capture_output=True)
    assert (tmp_path / "out" / "report.html").stat().st_size > 100_000


def test_importing_costs_less_than_half_of_what_importing_numpy_costs() -> None:
    code = """
import time
start = time.process_time()
import numpy
numpy_ready = time.process_time()
import contrapposto
print((time.process_time() - numpy_ready) / (numpy_ready - start))
"""
    ratios = [float(subprocess.check_output([sys.executable, "-c", code])) for _ in range(5)]
    assert statistics.median(ratios) < 0.5, ratios


def test_the_studio_of_the_package_serves_the_page_that_it_carries() -> None:
    page = Path(contrapposto.__file__).parent / "page"
    expected = os.environ.get("CONTRAPPOSTO_EXPECT_PAGE") == "1"
    if not page.is_dir() and not expected:
        pytest.skip("this package was built without the page of the studio (web/dist)")
    code = "from contrapposto._program import main; main()"
    words = ["studio", "--no-browser"]
    server = subprocess.Popen([sys.executable, "-c", code, *words], stdout=subprocess.PIPE, text=True)
    try:
        assert server.stdout is not None
        address = server.stdout.readline().strip()
        assert address.startswith("http://127.0.0.1:"), address
        for name in ("index.html", *(f"assets/{file.name}" for file in (page / "assets").glob("*.wasm"))):
            with urllib.request.urlopen(address + name) as answer:
                assert answer.read() == (page / name).read_bytes(), name
        assert list((page / "assets").glob("*.wasm"))
    finally:
        server.kill()
        server.wait()


def test_words_that_name_a_page_stay_as_they_are() -> None:
    named = ["studio", "job.toml", "--page", "dist"]
    assert arguments(named) == named
    assert arguments(["studio", "--page=dist"]) == ["studio", "--page=dist"]
    assert arguments(["demo"]) == ["demo"]
