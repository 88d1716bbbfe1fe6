"""Runs the examples of the documents."""

from __future__ import annotations

import os
import re
import sysconfig
from pathlib import Path

import pytest

from conftest import REPOSITORY

DOCUMENTS = ["README.md", "docs/python.md", "python/README.md"]


@pytest.mark.parametrize("document", DOCUMENTS)
def test_examples_run(document: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # The program stands beside the interpreter, whether or not the environment is active.
    monkeypatch.setenv("PATH", os.pathsep.join([sysconfig.get_path("scripts"), os.environ["PATH"]]))
    text = (REPOSITORY / document).read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert blocks, f"{document} has no example"
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, document, "exec"), names)
