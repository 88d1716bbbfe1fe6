"""The program `contrapposto`, as `pip install` puts it on the path."""

from __future__ import annotations

import signal
import sys
from pathlib import Path

from contrapposto._native import run_program

#: The built page of the studio, where the package carries it.
PAGE = Path(__file__).parent / "page"


def arguments(given: list[str]) -> list[str]:
    """The words of a command line; `studio` gets the page of the package, where there is one and the words name no other."""
    names_page = any(word == "--page" or word.startswith("--page=") for word in given)
    if given[:1] == ["studio"] and not names_page and (PAGE / "index.html").is_file():
        return [*given, f"--page={PAGE}"]
    return given


def main() -> None:
    """Carries out the command line and leaves with its exit code."""
    # Python's handler would wait for the end of the command; the program has one of its own where it needs one.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(run_program(["contrapposto", *arguments(sys.argv[1:])]))
