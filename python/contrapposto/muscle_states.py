"""Computes the muscles of a model file: paths, forces, moment arms, and the strength of joints."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from contrapposto._arrays import Array, postures
from contrapposto.errors import InputError
from contrapposto.model import Model

if TYPE_CHECKING:
    import xarray


@dataclass(frozen=True, eq=False)
class MuscleStates:
    """Muscles in N postures at rest, fibres and tendons in equilibrium: m muscles and the r coordinates that they cross.

    names: of the muscles; `coordinates`: of the crossed coordinates.
    lengths: of paths, m, (N, m), as the five below.
    fibre_lengths: m.
    tendon_forces: at the given activation, N.
    passive_forces: along the tendon, N.
    max_forces: of the tendon at full activation, N.
    moment_arms: torque about a coordinate for each newton of tension, m (N m/N), (N, m, r).
    passive_torques: of resting fibres, ligaments and bushings, N m, (N, r).
    strength: of the positive and the negative sense, N m, (N, r, 2): the muscles that pull that way at full activation, all others at
        the given one.
    coupled_strength: the same while the muscles give no torque about any other coordinate; `missing_torques` (N m, (N, r)) is what they
        lack for that, summed over the other coordinates.
    """

    names: tuple[str, ...]
    coordinates: tuple[str, ...]
    lengths: Array
    fibre_lengths: Array
    tendon_forces: Array
    passive_forces: Array
    max_forces: Array
    moment_arms: Array
    passive_torques: Array
    strength: Array
    coupled_strength: Array
    missing_torques: Array

    def to_xarray(self) -> xarray.Dataset:
        """All arrays over `posture`, `muscle`, `coordinate` and `sense`."""
        import xarray

        muscle, joint = ("posture", "muscle"), ("posture", "coordinate")
        dimensions = {
            **dict.fromkeys(["lengths", "fibre_lengths"], (muscle, "m")),
            **dict.fromkeys(["tendon_forces", "passive_forces", "max_forces"], (muscle, "N")),
            "moment_arms": ((*muscle, "coordinate"), "m"),
            **dict.fromkeys(["passive_torques", "missing_torques"], (joint, "N m")),
            **dict.fromkeys(["strength", "coupled_strength"], ((*joint, "sense"), "N m")),
        }
        columns = {name: (over, getattr(self, name), {"units": unit}) for name, (over, unit) in dimensions.items()}
        places = {"muscle": list(self.names), "coordinate": list(self.coordinates), "sense": ["positive", "negative"]}
        return xarray.Dataset(columns, places)


def muscles(
    model: Model, q: Any = None, *, rule: Literal["geodesic", "opensim"] = "geodesic", activation: float = 0.01
) -> MuscleStates:
    """The muscles of an OpenSim or MJCF model in postures at rest, with the numbers of `contrapposto muscles --json`.

    q: as for `Model.torques`; the default posture when left out.
    rule: paths lie on the surfaces that they wrap over as shortest lines, or as OpenSim lays them, for comparisons with it.
    activation: of all muscles, 0 to 1.
    """
    if rule not in ("geodesic", "opensim"):
        raise InputError(f"rule is {rule!r}; it must be 'geodesic' or 'opensim'")
    table, _ = postures(model._native, {} if q is None else q)
    frames = [json.loads(line) for line in model._native.muscles(table, rule == "opensim", activation)]
    if not frames:
        raise InputError("q has no row; at least one posture is needed")
    names, coordinates = tuple(frames[0]["lengths_m"]), tuple(frames[0]["passive_torques_nm"])

    def array(of: Any) -> Array:
        return np.array([of(frame) for frame in frames], dtype=np.float64)

    def by_muscle(key: str) -> Array:
        return array(lambda frame: [frame[key][name] for name in names])

    def by_sense(kind: str) -> Array:
        senses: Sequence[str] = ("positive", "negative")
        return array(lambda frame: [[frame["strength_nm"][name][sense][kind] for sense in senses] for name in coordinates])

    return MuscleStates(
        names=names,
        coordinates=coordinates,
        lengths=by_muscle("lengths_m"),
        fibre_lengths=by_muscle("fibre_lengths_m"),
        tendon_forces=by_muscle("tendon_forces_n"),
        passive_forces=by_muscle("passive_forces_n"),
        max_forces=by_muscle("max_forces_n"),
        moment_arms=array(lambda f: [[f["moment_arms_m"][name].get(c, 0.0) for c in coordinates] for name in names]),
        passive_torques=array(lambda frame: [frame["passive_torques_nm"][name] for name in coordinates]),
        strength=by_sense("sum"),
        coupled_strength=by_sense("coupled"),
        missing_torques=array(lambda frame: [frame["strength_nm"][name]["missing_nm"] for name in coordinates]),
    )
