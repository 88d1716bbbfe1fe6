"""Defines the result of Model.torques."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from contrapposto._arrays import Array

if TYPE_CHECKING:
    import pandas  # type: ignore[import-untyped, unused-ignore]
    import xarray


@dataclass(frozen=True, eq=False)
class Torques:
    """Torques of postures at rest, each array of shape (N, n), or (n,) of a single posture.

    names: of the columns.
    units: of the columns, "N m" or "N".
    external: of gravity, loads and devices.
    passive: of ligaments, capsules and stretched muscles.
    active: that muscles must give; external + passive + active is 0.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    external: Array
    passive: Array
    active: Array

    def __getitem__(self, name: str) -> dict[str, Array]:
        """The three torques of one column."""
        try:
            column = self.names.index(name)
        except ValueError:
            raise KeyError(f"there is no torque {name!r}; `names` lists them") from None
        return {kind: getattr(self, kind)[..., column] for kind in ("external", "passive", "active")}

    def to_pandas(self) -> pandas.DataFrame:
        """A table with one row a posture, and columns (name, kind)."""
        import numpy as np
        import pandas

        kinds = ("external", "passive", "active")
        stacked = np.stack([np.atleast_2d(getattr(self, kind)) for kind in kinds], axis=2)
        columns = pandas.MultiIndex.from_product([self.names, kinds], names=["coordinate", "torque"])
        table: Any = pandas.DataFrame(stacked.reshape(stacked.shape[0], -1), columns=columns)
        table.attrs["units"] = dict(zip(self.names, self.units))
        return table

    def to_xarray(self) -> xarray.Dataset:
        """The three torques over `posture` and `coordinate`, whose units are a coordinate of their own."""
        import numpy as np
        import xarray

        kinds = ("external", "passive", "active")
        columns = {kind: (("posture", "coordinate"), np.atleast_2d(getattr(self, kind))) for kind in kinds}
        return xarray.Dataset(columns, {"coordinate": list(self.names), "unit": ("coordinate", list(self.units))})
