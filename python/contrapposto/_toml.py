"""Writes dictionaries as TOML."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from contrapposto.errors import InputError


def toml(words: Mapping[str, Any]) -> str:
    """A file of these words, tables in one line."""
    return "".join(f"{_key(key)} = {_toml(value)}\n" for key, value in words.items())


def _key(key: object) -> str:
    if not isinstance(key, str):
        raise InputError(f"the key {key!r} of a scenario is no text")
    return _text(key)


def _text(text: str) -> str:
    """A text as TOML takes it: JSON's, but for characters beyond 16 bits, which JSON writes as two, and for DEL."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _toml(value: Any) -> str:
    """The value in TOML, tables in one line."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_key(key)} = {_toml(item)}" for key, item in value.items()) + "}"
    if hasattr(value, "tolist"):  # arrays and numbers of numpy
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_toml(item) for item in value) + "]"
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        # TOML writes inf and nan as Python does.
        return repr(value)
    raise InputError(f"{value!r} is no value of a scenario; accepted: texts, numbers, lists and dictionaries")
