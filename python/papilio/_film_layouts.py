"""How arrays of films are passed to the extension module: distinct numbers with strides, and the order of the axes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

_Number = TypeVar("_Number", bound=np.generic)

#: Numbers, and their stride along each axis of a call.
Spread = tuple[NDArray[np.float64], list[int]]

#: n, k and thickness of a layer.
LayerArrays = tuple[Spread, Spread, Spread]

#: Smallest numbers of wavelengths (one register) and of directions times gaps for which the grid method is faster.
_FEW_WAVELENGTHS, _FEW_PAIRS = 4, 16


class Layout(NamedTuple):
    """Layout of arrays for the extension module: their common shape, and the order of its axes."""

    shape: tuple[int, ...]
    order: list[int]

    def spread(self, array: NDArray[np.float64]) -> Spread:
        """Returns the distinct numbers of an array that broadcasts to the shape, with their strides."""
        last = np.asarray(_once(array, len(self.shape)).transpose(self.order), order="C")
        steps = [0 if length == 1 else stride // last.itemsize for length, stride in zip(last.shape, last.strides, strict=True)]
        return last.reshape(-1), steps

    def parts(self, array: NDArray[np.complex128]) -> tuple[Spread, Spread]:
        """Returns the real and the imaginary part, each with its strides."""
        return self.spread(array.real), self.spread(array.imag)

    def back(self, flat: NDArray[_Number], shape: tuple[int, ...], inner: tuple[int, ...] = ()) -> NDArray[_Number]:
        """Returns numbers in this order of axes as an array, without the axes of length 1 that precede those of ``shape``.

        Each point has numbers of shape ``inner``, which are the last axes.
        """
        last = len(self.order)
        found = flat.reshape([*(self.shape[axis] for axis in self.order), *inner])
        found = found.transpose([*np.argsort(self.order), *range(last, last + len(inner))])
        return np.asarray(found.reshape((*shape, *inner)), order="C")


def _once(array: NDArray[Any], axes: int) -> NDArray[Any]:
    """Returns an array with ``axes`` axes; those along which it is constant have length 1."""
    padded = array.reshape((1,) * (axes - array.ndim) + array.shape)
    return padded[tuple(slice(0, 1) if stride == 0 else slice(None) for stride in padded.strides)]


def in_rows(shape: tuple[int, ...]) -> Layout:
    """Returns the layout in which the points of the longest axis are contiguous."""
    longest = max(range(len(shape)), key=lambda axis: (shape[axis], axis), default=None)
    return Layout(shape, [axis for axis in range(len(shape)) if axis != longest] + ([] if longest is None else [longest]))


def grid(
    shape: tuple[int, ...], arrays: dict[str, NDArray[np.float64]], media: list[NDArray[np.complex128]], nm: list[NDArray[np.float64]]
) -> tuple[Layout, int | None] | None:
    """Returns the layout of the grid of directions, gaps and wavelengths that the arrays span; None if there is none.

    The grid has an axis along which only wavelengths and indices change, one along which only the angle changes, and one along
    which only the thickness of a single layer changes (its index is returned). Two axes of length 1 replace missing ones. The other
    axes precede them; along these, all arrays may change.
    """

    def along(some: Sequence[NDArray[Any]]) -> list[set[int]]:
        return [{axis for axis, length in enumerate(_once(one, len(shape)).shape) if length > 1} for one in some]

    spectral = set().union(*along([arrays["wavelength_nm"], *media]))
    tilted, immersed = along([arrays["theta_deg"], arrays["incidence"]])
    thick = along(nm)
    thicknesses = set().union(*thick)
    colours = spectral - tilted - immersed - thicknesses
    directions = tilted - spectral - immersed - thicknesses
    alone = {axis: [i for i, axes in enumerate(thick) if axis in axes] for axis in thicknesses - spectral - tilted - immersed}
    gaps = {axis: layers[0] for axis, layers in alone.items() if len(layers) == 1}

    def longest(axes: Sequence[int]) -> int | None:
        return max(axes, key=lambda axis: (shape[axis], axis), default=None)

    colour, direction, gap = longest([*colours]), longest([*directions]), longest([*gaps])
    many = (1 if direction is None else shape[direction]) * (1 if gap is None else shape[gap])
    if colour is None or shape[colour] < _FEW_WAVELENGTHS or many < _FEW_PAIRS:
        return None
    chosen = [0 if direction is None else direction + 2, 1 if gap is None else gap + 2, colour + 2]
    others = [axis for axis in range(len(shape) + 2) if axis not in chosen]
    return Layout((1, 1, *shape), [*others, *chosen]), None if gap is None else gaps[gap]


def by_wavelength(shape: tuple[int, ...], fixed: Sequence[NDArray[np.float64]]) -> Layout:
    """Returns the layout with the longest axis along which none of ``fixed`` (angles, thicknesses) changes as the last one."""
    axes = len(shape)
    moving = {axis for one in fixed for axis, length in enumerate(_once(one, axes).shape) if length > 1}
    free = [axis for axis in range(axes) if axis not in moving]
    last = max(free, key=lambda axis: (shape[axis], axis), default=None)
    return Layout(shape, [axis for axis in range(axes) if axis != last] + ([] if last is None else [last]))
