"""Coherent thin films: any stack of flat layers, in one call for all wavelengths, angles and designs.

All multiple reflections interfere. Layers are flat, homogeneous and isotropic, with local bulk indices n + 1j k,
k >= 0. Sources: M. Born, E. Wolf, "Principles of Optics", 7th ed., section 1.6; A. Macleod, "Thin-Film Optical
Filters", 4th ed., chapter 2.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from os import PathLike, fspath
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arguments, _papilio
from ._dims import check_places
from .errors import ArgumentError
from .running import checked_threads

__all__ = ["Material", "Polarisation", "Power", "index", "material_names", "power", "reflectance", "transmittance"]

#: A name ("SiO2"), a number or array n + 1j k, or the path of an n-k file.
Material = str | PathLike[str] | complex | ArrayLike

#: One of the two polarisations, or their mean.
Polarisation = Literal["s", "p", "mean"]


class Power(NamedTuple):
    """Reflectance and transmittance: fractions of the incident power."""

    reflectance: NDArray[np.float64]
    #: Fraction that enters the substrate; 0 if the wave in it is evanescent.
    transmittance: NDArray[np.float64]

    @property
    def absorptance(self) -> NDArray[np.float64]:
        """Fraction that the layers absorb."""
        return 1.0 - self.reflectance - self.transmittance


def material_names() -> list[str]:
    """Returns the names of materials; docs/films.md has the sources of their data."""
    return _papilio.material_names()


def index(material: Material, wavelength_nm: ArrayLike, *, name: str = "material") -> NDArray[np.complex128]:
    """Returns n + 1j k of a material at wavelengths (vacuum, nm), in their shape.

    Data are not extrapolated: a wavelength outside the range of a material's data is an `ArgumentError`.
    """
    nm = _arguments.reals("wavelength_nm", wavelength_nm, least=1.0, most=1e6)
    if not isinstance(material, (str, PathLike)):
        return _arguments.complexes(name, material)
    flat = np.ascontiguousarray(nm).reshape(-1)
    try:
        if isinstance(material, str):
            named = _arguments.text("material", material, "the name of a material")
            known = _papilio.material_index(named, None, flat)
        else:
            known = _papilio.material_index(None, fspath(material), flat)
    except ArgumentError as error:
        raise ArgumentError(f"{name}: {error}") from None
    return known.reshape(nm.shape)


def power(
    layers: Sequence[tuple[Material, ArrayLike]],
    wavelength_nm: ArrayLike,
    theta_deg: ArrayLike = 0.0,
    *,
    incidence: ArrayLike = 1.0,
    substrate: Material = "Al",
    polarisation: Polarisation = "mean",
    threads: int | None = None,
) -> Power:
    """Computes reflectance and transmittance of films, with SIMD and threads, outside the interpreter.

    Wavelengths, angles, thicknesses, indices and media broadcast by numpy's rules; the results have their common shape.
    Broadcasting is by position: xarray arrays with different dimensions are refused. ::

        d = np.linspace(0, 200, 101)                  # designs
        nm = np.arange(380, 781, 5)
        theta = np.array([0, 20, 40, 60])
        films.power([("SiO2", d[:, None, None])], nm[:, None], theta).reflectance.shape   # (101, 81, 4)

    Args:
        layers: (material, thickness in nm), from the side of the light to the substrate.
        wavelength_nm: in vacuum, nm.
        theta_deg: inclination in the medium of incidence, 0 to less than 90 degrees.
        incidence: refractive index of the medium of incidence, which is transparent.
        substrate: semi-infinite medium behind the layers.
        polarisation: "s", "p", or "mean" for their mean.
        threads: number of threads; None: one for each processor. The results do not depend on it.

    Raises:
        ArgumentError: if an argument is invalid; the message names it.
        KeyboardInterrupt: on Ctrl-C.
    """
    return Power(*_computed(layers, wavelength_nm, theta_deg, incidence, substrate, polarisation, True, threads))


def _computed(
    layers: Sequence[tuple[Material, ArrayLike]],
    wavelength_nm: ArrayLike,
    theta_deg: ArrayLike,
    incidence: ArrayLike,
    substrate: Material,
    polarisation: Polarisation,
    both: bool,
    threads: int | None,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Computes reflectance and, if ``both``, transmittance."""
    _arguments.one_of("polarisation", polarisation, ("s", "p", "mean"))
    arguments: dict[str, Any] = {"wavelength_nm": wavelength_nm, "theta_deg": theta_deg, "incidence": incidence, "substrate": substrate}
    arrays: dict[str, NDArray[np.float64]] = {
        "wavelength_nm": _arguments.reals("wavelength_nm", wavelength_nm, least=1.0, most=1e6),
        "theta_deg": _arguments.reals("theta_deg", theta_deg, least=0.0, most=np.nextafter(90.0, 0.0)),
        "incidence": _arguments.reals("incidence", incidence, least=1e-6, most=1e3),
    }
    media: dict[str, NDArray[np.complex128]] = {"substrate": index(substrate, wavelength_nm, name="substrate")}
    count = 0
    for count, layer in enumerate(_listed(layers), 1):
        name = f"layers[{count - 1}]"
        if not isinstance(layer, (tuple, list)) or len(layer) != 2:
            raise ArgumentError(f"{name}: expected (material, thickness in nm), not {_arguments.described(layer)}")
        material, thickness = layer
        arguments |= {name: material, f"{name} thickness": thickness}
        media[name] = index(material, wavelength_nm, name=name)
        arrays[f"{name} thickness"] = _arguments.reals(f"{name} thickness", thickness, least=0.0)
    check_places({name: one for name, one in arguments.items() if not isinstance(one, (str, PathLike))})
    shape = _arguments.common_shape({**arrays, **media})
    if 0 in shape:
        return np.zeros(shape), np.zeros(shape)
    sine = np.sin(np.radians(arrays["theta_deg"]))
    beta, index_0 = np.broadcast_arrays(arrays["incidence"] * sine, arrays["incidence"])
    nm = [arrays[f"layers[{i}] thickness"] for i in range(count)]
    indices = [media[f"layers[{i}]"] for i in range(count)]
    workers = checked_threads(threads) or os.cpu_count() or 1
    grid = None if both or polarisation != "mean" else _grid(shape, arrays, [*indices, media["substrate"]], nm)
    laid, gap = grid or (_in_rows(shape), None)
    lengths = [laid.shape[axis] for axis in laid.order]
    stack = [(*laid.parts(index), laid.spread(thickness)) for index, thickness in zip(indices, nm, strict=True)]
    around = laid.spread(arrays["wavelength_nm"]), laid.spread(beta), laid.spread(index_0)
    if grid is None:
        flat, other = _papilio.film(lengths, *around, stack, laid.parts(media["substrate"]), polarisation, both, workers)
        return laid.back(flat, shape), laid.back(other, shape) if both else other
    return laid.back(_papilio.film_grid(lengths, *around, stack, laid.parts(media["substrate"]), gap, workers), shape), np.zeros(0)


#: Numbers, and their stride along each axis of a call.
_Spread = tuple[NDArray[np.float64], list[int]]

#: Smallest numbers of wavelengths (one register) and of directions times gaps for which the grid method is faster.
_FEW_WAVELENGTHS, _FEW_PAIRS = 4, 16


class _Laid(NamedTuple):
    """Layout of arrays for the extension module: their common shape, and the order of its axes."""

    shape: tuple[int, ...]
    order: list[int]

    def spread(self, array: NDArray[np.float64]) -> _Spread:
        """Returns the distinct numbers of an array that broadcasts to the shape, with their strides."""
        last = np.asarray(_once(array, len(self.shape)).transpose(self.order), order="C")
        steps = [0 if length == 1 else stride // last.itemsize for length, stride in zip(last.shape, last.strides, strict=True)]
        return last.reshape(-1), steps

    def parts(self, array: NDArray[np.complex128]) -> tuple[_Spread, _Spread]:
        """Returns the real and the imaginary part, each with its strides."""
        return self.spread(array.real), self.spread(array.imag)

    def back(self, flat: NDArray[np.float64], shape: tuple[int, ...]) -> NDArray[np.float64]:
        """Returns numbers in this order of axes as an array, without the axes of length 1 that precede those of ``shape``."""
        found = flat.reshape([self.shape[axis] for axis in self.order]).transpose(np.argsort(self.order))
        return np.asarray(found.reshape(shape), order="C")


def _once(array: NDArray[Any], axes: int) -> NDArray[Any]:
    """Returns an array with ``axes`` axes; those along which it is constant have length 1."""
    padded = array.reshape((1,) * (axes - array.ndim) + array.shape)
    return padded[tuple(slice(0, 1) if stride == 0 else slice(None) for stride in padded.strides)]


def _in_rows(shape: tuple[int, ...]) -> _Laid:
    """Returns the layout in which the points of the longest axis are contiguous."""
    longest = max(range(len(shape)), key=lambda axis: (shape[axis], axis), default=None)
    return _Laid(shape, [axis for axis in range(len(shape)) if axis != longest] + ([] if longest is None else [longest]))


def _grid(
    shape: tuple[int, ...], arrays: dict[str, NDArray[np.float64]], media: list[NDArray[np.complex128]], nm: list[NDArray[np.float64]]
) -> tuple[_Laid, int | None] | None:
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
    return _Laid((1, 1, *shape), [*others, *chosen]), None if gap is None else gaps[gap]


def reflectance(
    layers: Sequence[tuple[Material, ArrayLike]],
    wavelength_nm: ArrayLike,
    theta_deg: ArrayLike = 0.0,
    *,
    incidence: ArrayLike = 1.0,
    substrate: Material = "Al",
    polarisation: Polarisation = "mean",
    threads: int | None = None,
) -> NDArray[np.float64]:
    """Computes the reflected fraction of the power; arguments and errors are those of `power`."""
    return _computed(layers, wavelength_nm, theta_deg, incidence, substrate, polarisation, False, threads)[0]


def transmittance(
    layers: Sequence[tuple[Material, ArrayLike]],
    wavelength_nm: ArrayLike,
    theta_deg: ArrayLike = 0.0,
    *,
    incidence: ArrayLike = 1.0,
    substrate: Material = "Al",
    polarisation: Polarisation = "mean",
    threads: int | None = None,
) -> NDArray[np.float64]:
    """Computes the fraction of the power that enters the substrate; arguments and errors are those of `power`."""
    return power(
        layers, wavelength_nm, theta_deg, incidence=incidence, substrate=substrate, polarisation=polarisation, threads=threads
    ).transmittance


def _listed(layers: Sequence[tuple[Material, ArrayLike]]) -> list[tuple[Material, ArrayLike]]:
    if not isinstance(layers, (list, tuple)):
        raise ArgumentError(f"layers: expected a list of (material, thickness in nm), not {_arguments.described(layers)}")
    return list(layers)
