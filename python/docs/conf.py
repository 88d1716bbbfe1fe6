"""Settings of the site of the Python package: `sphinx-build python/docs OUT`, without the network."""

from __future__ import annotations

import re
from typing import Any

import contrapposto

project = "contrapposto"
author = "the authors of contrapposto"
version = release = contrapposto.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc"]
html_theme = "furo"
# Links to pages of the repository that are not part of the site.
suppress_warnings = ["myst.xref_missing"]
autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_typehints_format = "short"
myst_heading_anchors = 3
default_role = "code"

#: `name: meaning` or `name, other: meaning`, as docstrings of this package list arguments and attributes.
ENTRY = re.compile(r"([a-z_]+(?:, [a-z_]+)*): (.*)")


def listed(app: Any, what: str, name: str, thing: object, options: Any, lines: list[str]) -> None:
    """Makes a list of the arguments and attributes of a docstring."""
    found: list[str] = []
    for line in lines:
        entry = ENTRY.fullmatch(line)
        if entry:
            found += [] if found and found[-1].startswith(("* ", "  ")) else [""]
            found.append(f"* **{entry[1]}**: {entry[2]}")
        elif line.startswith("    ") and found and found[-1].startswith(("* ", "  ")):
            found.append("  " + line.strip())
        else:
            found += [""] if line and found and found[-1].startswith(("* ", "  ")) else []
            found.append(line)
    lines[:] = found


def setup(app: Any) -> None:
    app.connect("autodoc-process-docstring", listed)
