"""Runs the examples of the documents."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from conftest import REPOSITORY

DOCUMENTS = ["README.md", "docs/python.md", "python/README.md"]


@pytest.mark.parametrize("document", DOCUMENTS)
def test_examples_run(document: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = (REPOSITORY / document).read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert blocks, f"{document} has no example"
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, document, "exec"), names)
