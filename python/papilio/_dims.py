"""xarray arrays as arguments: dimensions are matched by name, or the arrays are refused; never silently by position."""

from __future__ import annotations

import sys
from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ._storing import optional
from .errors import ArgumentError

if TYPE_CHECKING:
    import xarray

__all__ = ["Dims", "check_places", "crossed", "is_labelled"]

_Name = TypeVar("_Name")


@dataclass(frozen=True)
class Dims:
    """The union of the dimensions of arrays, in order of first appearance."""

    names: tuple[Hashable, ...]
    coordinates: dict[Hashable, Any]

    def labelled(self, values: NDArray[np.float64], **inner: list[str]) -> xarray.DataArray:
        """Returns numbers over these dimensions, followed by further dimensions with the specified labels."""
        with optional("xarray"):
            import xarray

        for name in inner:
            if name in self.names:
                raise ArgumentError(f"variables: the dimension name {name!r} is reserved for the result: rename it")
        return xarray.DataArray(values, {**self.coordinates, **inner}, (*self.names, *inner))


def is_labelled(value: object) -> bool:
    """Returns whether a value is an xarray array."""
    known = sys.modules.get("xarray")
    return known is not None and isinstance(value, (known.DataArray, known.Variable))


def crossed(arrays: Mapping[_Name, Any], called: Mapping[_Name, str]) -> tuple[dict[_Name, Any], Dims | None]:
    """Converts xarray arrays, which broadcast by dimension, to arrays that broadcast equally by numpy's rules.

    ``called`` has the names for errors. Without an xarray array, the arrays are returned unchanged.

    Raises:
        ArgumentError: if a shared dimension has two lengths or two coordinates, or if one of the arrays has no dimension names.
    """
    found = {name: array for name, array in arrays.items() if is_labelled(array)}
    if not found:
        return dict(arrays), None
    with optional("xarray"):
        import xarray

    for name, array in arrays.items():
        if name not in found and np.ndim(array) > 0:
            shape = np.shape(array)
            raise ArgumentError(
                f"{called[name]}: expected an xarray array, as for the other arguments, not an array of shape {shape} without names: "
                "make it a DataArray, or pass the .values of the others"
            )
    whole = {name: xarray.DataArray(array) for name, array in found.items()}
    try:
        aligned = dict(zip(whole, xarray.align(*whole.values(), join="exact", copy=False), strict=True))
    except ValueError as error:
        words = ", ".join(called[name] for name in found)
        raise ArgumentError(f"{words}: a shared dimension differs: {error}") from None
    names = tuple(dict.fromkeys(dimension for array in aligned.values() for dimension in array.dims))
    coordinates = {
        dimension: array.coords[dimension]
        for array in aligned.values()
        for dimension in array.dims
        if dimension in array.coords
    }
    plain: dict[_Name, Any] = dict(arrays)
    for name, array in aligned.items():
        own = [dimension for dimension in names if dimension in array.dims]
        lengths = [array.sizes[dimension] if dimension in own else 1 for dimension in names]
        plain[name] = array.transpose(*own).to_numpy().reshape(lengths)
    return plain, Dims(names, coordinates)


def check_places(arrays: Mapping[str, Any]) -> None:
    """Checks that broadcasting by position agrees with the dimensions of xarray arrays.

    Raises:
        ArgumentError: if it does not; with the names of both arrays.
    """
    found = [(name, array) for name, array in arrays.items() if is_labelled(array) and array.ndim]
    if not found:
        return
    first, dims = found[0][0], found[0][1].dims
    for name, array in arrays.items():
        own = array.dims if is_labelled(array) else None
        if np.ndim(array) == 0 if own is None else not own:
            continue
        agrees = own is not None and (own == dims[len(dims) - len(own) :] or dims == own[len(own) - len(dims) :])
        if not agrees:
            has = f"dimensions {own}" if own is not None else "no names"
            raise ArgumentError(
                f"{name}: its axes have {has}, but those of {first} are {dims}; this function broadcasts by position, as numpy does: "
                "transpose the arrays to one order and pass their .values"
            )
