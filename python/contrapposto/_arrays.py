"""Reads postures from arrays, tables and dictionaries, whatever their type and layout."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import numpy.typing as npt

from contrapposto.errors import InputError

if TYPE_CHECKING:
    import contrapposto._native as _native

#: Arrays of float64.
Array: TypeAlias = npt.NDArray[np.float64]


def numbers(what: str, values: Any) -> Array:
    """The values as float64; complex numbers, texts, dates and objects are refused. The result may share its memory with them."""
    array = np.asarray(values)
    if array.dtype.kind not in "fiu":
        error = InputError(f"{what} is an array of {array.dtype}; it must hold real numbers")
        error.limit = "real numbers"
        raise error
    return np.require(array, np.float64, ["ALIGNED"])


def rows(what: str, values: Any) -> Array:
    """The values as rows: an array of one axis is one row."""
    array = numbers(what, values)
    if array.ndim == 1:
        return array[np.newaxis, :]
    if array.ndim != 2:
        raise InputError(f"{what} has shape {array.shape}; it must be (N, n), or (n,) for one posture")
    return array


def line(what: str, values: Any) -> Array:
    """The values as one axis; a single number is an axis of one."""
    array = np.atleast_1d(numbers(what, values))
    if array.ndim != 1:
        raise InputError(f"{what} has shape {array.shape}; it must be (N,)")
    return array


def postures(model: _native.Model, given: Any) -> tuple[Array, bool]:
    """Rows of coordinates, and whether one posture was given alone. Columns of a table and keys of a dictionary are names of
    coordinates; coordinates without one stay at their default."""
    columns = getattr(given, "columns", None)
    if columns is None and not isinstance(given, Mapping):
        array = rows("q", given)
        return array, np.ndim(given) == 1
    names = model.coordinate_names
    by_name = {str(name): numbers(f"q[{name!r}]", given[name]) for name in (given if columns is None else columns)}
    for name in by_name:
        if name not in names:
            error = InputError(f"the model has no coordinate `{name}`; Model.coordinate_names lists them")
            error.coordinate = name
            raise error
    lengths = {array.shape for array in by_name.values() if array.ndim > 0}
    if len(lengths) > 1 or any(len(shape) != 1 for shape in lengths):
        raise InputError(f"the columns of q have shapes {sorted(lengths)}; all must be (N,) or single numbers")
    count = next(iter(lengths))[0] if lengths else 1
    table = np.repeat(model.default_posture, count, axis=0)
    for name, array in by_name.items():
        table[:, names.index(name)] = array
    return table, not lengths
