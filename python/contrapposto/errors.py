"""Defines the exceptions of this package."""

from __future__ import annotations


class ContrappostoError(Exception):
    """Any error of this package."""


class InputError(ContrappostoError, ValueError):
    """A refused input. The message says what is wrong, where, and what would be accepted; the attributes say the same in parts,
    each of them None where it has no meaning."""

    #: Name of the coordinate.
    coordinate: str | None = None
    #: Row of an array of postures.
    row: int | None = None
    #: The refused value.
    value: float | None = None
    #: Unit of the value.
    unit: str | None = None
    #: The values that would be accepted.
    limit: str | None = None
    #: Name of the file.
    file: str | None = None
    #: Line in the file, counted from 1.
    line: int | None = None
    #: Column in the line, counted from 1.
    column: int | None = None
    #: The accepted alternative.
    help: str | None = None

    def __str__(self) -> str:
        text = super().__str__()
        if self.line is not None:
            text = f"{self.file}:{self.line}:{self.column}: {text}"
        return f"{text}\n  {self.help}" if self.help else text


class JobError(ContrappostoError, RuntimeError):
    """A job that was understood and failed."""

    #: The accepted alternative.
    help: str | None = None


class InternalError(ContrappostoError, RuntimeError):
    """A defect of this package; please report it with its message."""
