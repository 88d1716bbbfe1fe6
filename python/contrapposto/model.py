"""Defines the body, and computes its torques in postures at rest."""

from __future__ import annotations

import os
import warnings
import zlib
from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from contrapposto import _native
from contrapposto._native import Model as NativeModel
from contrapposto._arrays import Array, line, numbers, postures, rows
from contrapposto._toml import toml
from contrapposto.errors import InputError
from contrapposto.loads import Load, native_loads
from contrapposto.torques import Torques

#: The quantities that the muscles of a model file give.
Muscles: TypeAlias = Literal["off", "strength", "passive", "both"]
#: Sense of a coordinate: that of the torque of a muscle group.
Sense: TypeAlias = Literal["positive", "negative"]


class Model:
    """An immutable body: the built-in adult (`Model.adult`), or a model file (`Model.from_file`)."""

    __slots__ = ("_native",)
    _native: NativeModel

    def __init__(self) -> None:
        raise TypeError("a model is made by Model.adult(...) or Model.from_file(...)")

    @classmethod
    def _of(cls, native: NativeModel) -> Model:
        model = object.__new__(cls)
        object.__setattr__(model, "_native", native)
        return model

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError("a model does not change")

    @classmethod
    def adult(
        cls,
        sex: Literal["female", "male"] = "male",
        stature: float | None = None,
        mass: float | None = None,
        *,
        percentile: float | None = None,
    ) -> Model:
        """The built-in adult; stature (m) and mass (kg) are those of de Leva's reference woman or man where they are left out.

        percentile: above 0 and below 100; stature and mass are each at that percentile of women or men of ANSUR II (measured; soldiers
            of the US Army). Of both together fewer people are that small, or that large: `notes` says so, with the source.
        """
        if sex not in ("female", "male"):
            raise InputError(f"sex is {sex!r}; it must be 'female' or 'male'")
        if percentile is not None:
            if stature is not None or mass is not None:
                raise InputError("percentile gives stature and mass; leave them out, or leave out percentile")
            return cls._of(_native.Model.adult_at(sex == "female", percentile))
        return cls._of(_native.Model.adult(sex == "female", stature, mass))

    @classmethod
    def from_file(
        cls,
        path: str | os.PathLike[str],
        *,
        overlay: str | os.PathLike[str] | None = None,
        root: Literal["fixed", "free"] | None = None,
        passive: Literal["library", "file"] | None = None,
        strength: bool = True,
        person: str | None = None,
    ) -> Model:
        """Reads an OpenSim, URDF or MJCF file.

        overlay: ranges, passive laws, strength and fatigue by coordinate (TOML), laid over the model.
        root: how the root of a URDF or MJCF model is attached; as the file says when left out.
        passive: whether passive torque and strength that the file does not have come from the built-in library; without an overlay
            they do when left out.
        strength: False leaves out the strength that the file gives to motors.
        person: the person whom the model stands for: "female,1.65m,60kg", or some of them.

        Warnings of the reader are warnings of Python; `notes` has all that was ignored or filled in.
        """
        if passive not in (None, "library", "file"):
            raise InputError(f"passive is {passive!r}; it must be 'library' or 'file'")
        fill = None if passive is None else passive == "library"
        model = cls._of(_native.Model.from_file(path, overlay, root, fill, not strength, person))
        for kind, text in model._native.notes:
            if kind == "warning":
                warnings.warn(text, stacklevel=2)
        return model

    @classmethod
    def _from_state(cls, state: bytes) -> Model:
        return cls._of(_native.Model.from_state(zlib.decompress(state)))

    def __reduce__(self) -> tuple[Any, tuple[bytes]]:
        return (Model._from_state, (zlib.compress(self._native.state(), 1),))

    def with_passive(self, coordinate: str, angles: npt.ArrayLike, torques: npt.ArrayLike) -> Model:
        """The same body with a measured passive torque of a coordinate: torques (N m), which never rise, at rising angles (rad) that
        cover its range; between them a monotone cubic."""
        rows = _table(angles, torques)
        return self._laid(coordinate, {"passive": {"table_deg_nm": rows}})

    def with_strength(
        self,
        coordinate: str,
        positive: npt.ArrayLike,
        negative: npt.ArrayLike,
        angles: npt.ArrayLike | None = None,
        *,
        fatigue: str | None = None,
    ) -> Model:
        """The same body with the strength of both muscle groups of a coordinate, N m, both positive: two numbers, or one a rising angle
        (rad) of `angles`, between which a cubic goes and outside of which the nearer end holds. fatigue: class of their law of fatigue
        ("knee", "shoulder", ...); it stays as it is when left out, "general" of a coordinate that had no groups."""
        if angles is None:
            both = {"positive_nm": _number("positive", positive), "negative_nm": _number("negative", negative)}
            laid: dict[str, Any] = {"strength": both}
        else:
            laid = {"strength": {"table_deg_nm": _table(angles, positive, negative)}}
        return self._laid(coordinate, laid if fatigue is None else {**laid, "fatigue": fatigue})

    def _laid(self, coordinate: str, words: Mapping[str, Any]) -> Model:
        return Model._of(self._native.lay_over(toml({"coordinates": {coordinate: words}})))

    @property
    def name(self) -> str:
        """Name of the body."""
        return self._native.name

    @property
    def mass(self) -> float:
        """Mass of the body, kg."""
        return self._native.mass

    @property
    def coordinate_names(self) -> tuple[str, ...]:
        """Names of the coordinates, in the order of the columns of postures."""
        return tuple(self._native.coordinate_names)

    @property
    def coordinate_units(self) -> tuple[str, ...]:
        """Units of the coordinates: "rad", "m", or "1" for components of quaternions (in the order w, x, y, z)."""
        return tuple(self._native.coordinate_units)

    @property
    def ranges(self) -> Array:
        """Least and greatest value of every coordinate, shape (n, 2)."""
        return self._native.ranges

    @property
    def default_posture(self) -> Array:
        """Every coordinate at its default, shape (n,)."""
        posture: Array = self._native.default_posture[0]
        return posture

    @property
    def segment_names(self) -> tuple[str, ...]:
        """Names of the segments, which loads name."""
        return tuple(self._native.segment_names)

    @property
    def torque_names(self) -> tuple[str, ...]:
        """Names of the torques, in the order of the columns of `torques`. They are those of the coordinates, but a free root has
        forces and moments instead of a position and a quaternion, and coordinates that follow others have none."""
        return tuple(self._native.torque_names)

    @property
    def notes(self) -> tuple[str, ...]:
        """The parts of the file that were ignored, changed or filled in, one sentence each."""
        return tuple(text for _, text in self._native.notes)

    def torques(
        self,
        q: Any,
        loads: Load | Sequence[Load] = (),
        external: Any | None = None,
        *,
        muscles: Muscles | None = None,
        threads: int = 1,
    ) -> Torques:
        """External, passive and active torque of postures at rest.

        q: postures (rad, m), shape (N, n), or (n,) for one; or a table or dictionary with names of coordinates, the others of which
            stay at their default.
        loads: weights and forces on segments: `Weight`, `Force`, or texts such as "hand_r 3kg".
        external: generalised forces of a device at the joints (N m, N), in the order of `torque_names`, shape (N, r) or (r,); they
            count as external torque.
        muscles: the quantities that the muscles of a model file give, as `--muscles` of the program: "both" for an OpenSim file with
            muscles and "off" for all others when left out. With "passive" or "both" passive torque is that of its resting fibres.
        threads: number of threads. Each result is the same to the bit for any number.
        """
        table, single = postures(self._native, q)
        device = None if external is None else rows("external", external)
        results = self._native.torques(table, native_loads(loads), device, muscles, _count(threads))
        return Torques(
            self.torque_names, tuple(self._native.torque_units), *(array[0] if single else array for array in results)
        )

    def gradient(self, q: Any, loads: Load | Sequence[Load] = (), *, threads: int = 1) -> Array:
        """Derivatives of external torque, d external_i / d q_j (N m or N, per rad or m), of shape (N, r, r), or (r, r) of one
        posture, rows and columns in the order of `torque_names`. Arguments are those of `torques`."""
        table, single = postures(self._native, q)
        gradient = self._native.gradient(table, native_loads(loads), _count(threads))
        return gradient[0] if single else gradient

    def passive(self, coordinate: str, angles: npt.ArrayLike) -> Array:
        """Passive torque (N m) of a coordinate at angles (rad), the other coordinates at their default; that of `torques`."""
        if coordinate not in self.torque_names:
            raise _unknown(coordinate)
        angles = line("angles", angles)
        return self.torques({coordinate: angles}).passive[:, self.torque_names.index(coordinate)]

    def strength(self, coordinate: str, angles: npt.ArrayLike) -> Array:
        """Greatest voluntary torque (N m, both positive) of the muscle groups of the positive and the negative sense of a coordinate at
        angles (rad), shape (N, 2). Muscles of a model file have no part in it; `contrapposto.muscles` gives their strength."""
        angles = line("angles", angles)
        odd = angles[~np.isfinite(angles)]
        if odd.size:
            error = InputError(f"an angle of `{coordinate}` is {odd[0]}; it must be finite (rad)")
            error.coordinate, error.value, error.unit, error.limit = coordinate, float(odd[0]), "rad", "finite"
            raise error
        both = [_native.strength(self._native, coordinate, positive, angles) for positive in (True, False)]
        return np.stack(both, axis=1)

    def group_names(self, coordinate: str) -> tuple[str, str]:
        """Names of the muscle groups of the positive and the negative sense of a coordinate."""
        positive, negative = (_native.group_names(self._native, coordinate, sense)[0] for sense in (True, False))
        return (positive, negative)

    def endurance_time(self, coordinate: str, loads: npt.ArrayLike, sense: Sense = "positive") -> Array:
        """Time (s) for which a rested muscle group holds relative loads (torque over strength), shape (N,); inf where for ever."""
        return _native.endurance_time(self._native, coordinate, _positive(sense), _loads(loads))

    def fatigue(
        self, coordinate: str, loads: npt.ArrayLike, seconds: float, sense: Sense = "positive", start: float = 0.0
    ) -> Array:
        """Fatigue of a muscle group, 0 rested and 1 where its load can no longer be held, after each of the relative loads, which last
        `seconds` each, one after the other; `start` is the fatigue before. Shape (N,)."""
        if not (0 < seconds < np.inf):
            raise InputError(f"seconds is {seconds}; it must be greater than 0 and finite (s)")
        if not 0 <= start <= 1:
            raise InputError(f"start is {start}; it must lie in 0..1")
        return _native.fatigue(self._native, coordinate, _positive(sense), (_loads(loads), seconds, start))

    def __repr__(self) -> str:
        return f"<contrapposto.Model {self.name!r}: {len(self.coordinate_names)} coordinates, {self.mass:.1f} kg>"


def _number(what: str, value: npt.ArrayLike) -> float:
    array = numbers(what, value)
    if array.ndim != 0:
        raise InputError(f"{what} has shape {array.shape}; without `angles` it must be one number (N m)")
    return float(array)


def _table(angles: npt.ArrayLike, *columns: npt.ArrayLike) -> list[list[float]]:
    """Rows of a table: angles in degrees, then the columns."""
    turns = np.degrees(line("angles", angles))
    # Back in radians the ends must not lie inside of what was given, by a last digit.
    turns[:1], turns[-1:] = np.nextafter(turns[:1], -np.inf), np.nextafter(turns[-1:], np.inf)
    sizes = [line("torques", column) for column in columns]
    for size in sizes:
        if len(size) != len(turns):
            raise InputError(f"there are {len(turns)} angles and {len(size)} torques; there must be as many")
    rows: list[list[float]] = np.stack([turns, *sizes], axis=1).tolist()
    return rows


def _unknown(coordinate: str) -> InputError:
    error = InputError(f"the model has no coordinate `{coordinate}` with a torque; Model.torque_names lists them")
    error.coordinate = coordinate
    return error


def _positive(sense: Sense) -> bool:
    if sense not in ("positive", "negative"):
        raise InputError(f"sense is {sense!r}; it must be 'positive' or 'negative'")
    return sense == "positive"


def _loads(loads: npt.ArrayLike) -> Array:
    checked = line("loads", loads)
    odd = checked[~((checked >= 0) & (checked < np.inf))]
    if odd.size:
        raise InputError(f"a relative load is {odd[0]}; it must be at least 0 and finite")
    return checked


def _count(threads: int) -> int:
    if not isinstance(threads, int) or isinstance(threads, bool) or not 1 <= threads <= 1024:
        raise InputError(f"threads is {threads!r}; it must be a whole number from 1 to 1024")
    return threads
