"""Coherent thin films: any stack of flat layers, in one call over wavelengths, angles and designs.

All multiple reflections interfere; layers are flat, homogeneous and isotropic, with local bulk indices n + 1j k,
k >= 0. Source: M. Born, E. Wolf, "Principles of Optics", 7th ed., section 1.6; A. Macleod, "Thin-Film Optical
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

#: One of both polarisations, or the mean of them.
Polarisation = Literal["s", "p", "mean"]


class Power(NamedTuple):
    """Shares of the power that comes in."""

    reflectance: NDArray[np.float64]
    #: Into the substrate; 0 where the wave there is evanescent.
    transmittance: NDArray[np.float64]

    @property
    def absorptance(self) -> NDArray[np.float64]:
        """What the layers absorb."""
        return 1.0 - self.reflectance - self.transmittance


def material_names() -> list[str]:
    """The names of materials; docs/films.md says where their numbers come from."""
    return _papilio.material_names()


def index(material: Material, wavelength_nm: ArrayLike, *, name: str = "material") -> NDArray[np.complex128]:
    """n + 1j k of a material at wavelengths (vacuum, nm), in their shape.

    Nothing is extrapolated: a wavelength beyond a material's data is an `ArgumentError`.
    """
    nm = _arguments.reals("wavelength_nm", wavelength_nm, least=1.0, most=1e6)
    if not isinstance(material, (str, PathLike)):
        return _arguments.complexes(name, material)
    flat = np.ascontiguousarray(nm).reshape(-1)
    try:
        if isinstance(material, str):
            named = _arguments.text("material", material, "the name of one")
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
    """Reflectance and transmittance of films, in SIMD registers and on threads, without the interpreter.

    Wavelengths, angles, thicknesses, indices and media broadcast as numpy does; the answers have their common shape.
    (By place: xarray's arrays with other dimensions are refused.) ::

        d = np.linspace(0, 200, 101)                  # designs
        nm = np.arange(380, 781, 5)
        theta = np.array([0, 20, 40, 60])
        films.power([("SiO2", d[:, None, None])], nm[:, None], theta).reflectance.shape   # (101, 81, 4)

    Args:
        layers: (material, thickness in nm) from the side of the light down.
        wavelength_nm: in vacuum, nm.
        theta_deg: inclination in the medium that the light comes from, 0 to less than 90 degrees.
        incidence: index of that (transparent) medium.
        substrate: semi-infinite, behind the layers.
        polarisation: "s", "p", or "mean" of both.
        threads: how many; None: one for each processor. They change no number.

    Raises:
        ArgumentError: names what is wrong.
        KeyboardInterrupt: on Ctrl-C.
    """
    found, shape = _computed(layers, wavelength_nm, theta_deg, incidence, substrate, polarisation, True, threads)
    return Power(*(_in_place(flat, shape) for flat in found))


def _computed(
    layers: Sequence[tuple[Material, ArrayLike]],
    wavelength_nm: ArrayLike,
    theta_deg: ArrayLike,
    incidence: ArrayLike,
    substrate: Material,
    polarisation: Polarisation,
    both: bool,
    threads: int | None,
) -> tuple[tuple[NDArray[np.float64], NDArray[np.float64]], tuple[int, ...]]:
    """Reflectance and, if ``both``, transmittance, flat, with the longest axis last; and their shape."""
    _arguments.one_of("polarisation", polarisation, ("s", "p", "mean"))
    given: dict[str, Any] = {"wavelength_nm": wavelength_nm, "theta_deg": theta_deg, "incidence": incidence, "substrate": substrate}
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
        given |= {name: material, f"{name} thickness": thickness}
        media[name] = index(material, wavelength_nm, name=name)
        arrays[f"{name} thickness"] = _arguments.reals(f"{name} thickness", thickness, least=0.0)
    check_places({name: one for name, one in given.items() if not isinstance(one, (str, PathLike))})
    shape = _arguments.common_shape({**arrays, **media})
    axis = _longest(shape)
    sine = np.sin(np.radians(arrays["theta_deg"]))
    around = np.broadcast_arrays(arrays["incidence"] * sine, arrays["incidence"])
    beta, index_0 = (_spread(one, shape, axis) for one in around)

    def medium(name: str) -> tuple[_Spread, _Spread]:
        return _spread(media[name].real, shape, axis), _spread(media[name].imag, shape, axis)

    stack = [
        (*medium(f"layers[{i}]"), _spread(arrays[f"layers[{i}] thickness"], shape, axis)) for i in range(count)
    ]
    workers = checked_threads(threads) or os.cpu_count() or 1
    moved = [*shape[:axis], *shape[axis + 1 :], shape[axis]] if shape else []
    if 0 in shape:
        return (np.zeros(0), np.zeros(0)), shape
    nm = _spread(arrays["wavelength_nm"], shape, axis)
    found = _papilio.film(moved, nm, beta, index_0, stack, medium("substrate"), polarisation, both, workers)
    return found, shape


#: Numbers, and how far apart they are along each axis of a call.
_Spread = tuple[NDArray[np.float64], list[int]]


def _longest(shape: tuple[int, ...]) -> int:
    """The axis whose points stand side by side."""
    return max(range(len(shape)), key=lambda axis: (shape[axis], axis), default=0)


def _spread(array: NDArray[np.float64], shape: tuple[int, ...], axis: int) -> _Spread:
    """The numbers of an array that broadcasts to ``shape``, each once, with ``axis`` as the last."""
    padded = array.reshape((1,) * (len(shape) - array.ndim) + array.shape)
    once = padded[tuple(slice(0, 1) if stride == 0 else slice(None) for stride in padded.strides)]
    last = np.ascontiguousarray(np.moveaxis(once, axis, -1) if shape else once)
    steps = [0 if length == 1 else stride // last.itemsize for length, stride in zip(last.shape, last.strides, strict=True)]
    return last.reshape(-1), steps if shape else []


def _in_place(flat: NDArray[np.float64], shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Numbers with the longest axis last, as an array of ``shape``."""
    if not shape or not flat.size:
        return flat.reshape(shape)
    axis = _longest(shape)
    moved = flat.reshape(*shape[:axis], *shape[axis + 1 :], shape[axis])
    return np.ascontiguousarray(np.moveaxis(moved, -1, axis))


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
    """The share of the power that is reflected; arguments and errors are those of `power`."""
    (found, _), shape = _computed(layers, wavelength_nm, theta_deg, incidence, substrate, polarisation, False, threads)
    return _in_place(found, shape)


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
    """The share of the power that enters the substrate; arguments and errors are those of `power`."""
    return power(
        layers, wavelength_nm, theta_deg, incidence=incidence, substrate=substrate, polarisation=polarisation, threads=threads
    ).transmittance


def _listed(layers: Sequence[tuple[Material, ArrayLike]]) -> list[tuple[Material, ArrayLike]]:
    if not isinstance(layers, (list, tuple)):
        raise ArgumentError(f"layers: expected a list of (material, thickness in nm), not {_arguments.described(layers)}")
    return list(layers)
