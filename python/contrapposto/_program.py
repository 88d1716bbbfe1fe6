"""The program `contrapposto`, as `pip install` puts it on the path."""

from __future__ import annotations

import signal
import sys

from contrapposto._native import run_program


def main() -> None:
    """Carries out the command line and leaves with its exit code."""
    # Python's handler would wait for the end of the command; the program has one of its own where it needs one.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(run_program(["contrapposto", *sys.argv[1:]]))
