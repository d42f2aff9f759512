"""Arrays of xarray's as arguments: their dimensions count by name, or they are refused; never by place in silence."""

from __future__ import annotations

import sys
from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from .errors import ArgumentError

if TYPE_CHECKING:
    import xarray

__all__ = ["Dims", "check_places", "crossed", "is_labelled"]

_Name = TypeVar("_Name")


@dataclass(frozen=True)
class Dims:
    """The dimensions that arrays have together, in the order in which they first stand there."""

    names: tuple[Hashable, ...]
    coordinates: dict[Hashable, Any]

    def labelled(self, values: NDArray[np.float64], **inner: list[str]) -> xarray.DataArray:
        """Numbers over these dimensions and some more, of which the labels are given."""
        import xarray

        for name in inner:
            if name in self.names:
                raise ArgumentError(f"variables: a dimension is called {name!r}, as one of the answer is: rename it")
        return xarray.DataArray(values, {**self.coordinates, **inner}, (*self.names, *inner))


def is_labelled(value: object) -> bool:
    """Whether it is an array of xarray's."""
    known = sys.modules.get("xarray")
    return known is not None and isinstance(value, (known.DataArray, known.Variable))


def crossed(arrays: Mapping[_Name, Any], called: Mapping[_Name, str]) -> tuple[dict[_Name, Any], Dims | None]:
    """Arrays that broadcast by numpy's rules as those given do by xarray's: by dimension; ``called`` is how mistakes call them.

    Without an array of xarray's they stay as they are.

    Raises:
        ArgumentError: a shared dimension has two lengths or two coordinates, or an array without names stands among them.
    """
    found = {name: array for name, array in arrays.items() if is_labelled(array)}
    if not found:
        return dict(arrays), None
    import xarray

    for name, array in arrays.items():
        if name not in found and np.ndim(array) > 0:
            shape = np.shape(array)
            raise ArgumentError(
                f"{called[name]}: an array of shape {shape} without names beside arrays with dimensions: "
                "make it a DataArray, or give .values of the others"
            )
    whole = {name: xarray.DataArray(array) for name, array in found.items()}
    try:
        aligned = dict(zip(whole, xarray.align(*whole.values(), join="exact", copy=False), strict=True))
    except ValueError as error:
        words = ", ".join(called[name] for name in found)
        raise ArgumentError(f"{words}: a dimension that they share differs: {error}") from None
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
    """Fails where arrays of xarray's would be broadcast against others by place, and not by dimension.

    Raises:
        ArgumentError: with both names.
    """
    found = [(name, array) for name, array in arrays.items() if is_labelled(array) and array.ndim]
    if not found:
        return
    first, dims = found[0][0], found[0][1].dims
    for name, array in arrays.items():
        own = array.dims if is_labelled(array) else None
        if np.ndim(array) == 0 if own is None else not own:
            continue
        alike = own is not None and (own == dims[len(dims) - len(own) :] or dims == own[len(own) - len(dims) :])
        if not alike:
            has = f"dimensions {own}" if own is not None else "no names"
            raise ArgumentError(
                f"{name}: its axes have {has}, those of {first} are {dims}; here arrays broadcast by place, as numpy's do: "
                "bring them in one order and give their .values"
            )
