"""Coherent thin films: any stack of flat layers, in one call over wavelengths, angles and designs.

All multiple reflections interfere; layers are flat, homogeneous and isotropic, with local bulk indices n + 1j k,
k >= 0. Source: M. Born, E. Wolf, "Principles of Optics", 7th ed., section 1.6; A. Macleod, "Thin-Film Optical
Filters", 4th ed., chapter 2.
"""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike, fspath
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arguments, _papilio
from .errors import ArgumentError

__all__ = ["Power", "index", "material_names", "power", "reflectance", "transmittance"]

#: A name ("SiO2"), a number or array n + 1j k, or the path of an n-k file.
Material = str | PathLike[str] | complex | ArrayLike


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
    """The names of materials; docs/materials says where their numbers come from."""
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
    polarisation: str = "mean",
) -> Power:
    """Reflectance and transmittance of films.

    Wavelengths, angles, thicknesses, indices and media broadcast as numpy does; the answers have their common shape::

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

    Raises:
        ArgumentError: names what is wrong.
    """
    _arguments.one_of("polarisation", polarisation, ("s", "p", "mean"))
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
        media[name] = index(material, wavelength_nm, name=name)
        arrays[f"{name} thickness"] = _arguments.reals(f"{name} thickness", thickness, least=0.0)
    shape = _arguments.common_shape({**arrays, **media})

    def at(name: str) -> NDArray[np.float64]:
        return np.broadcast_to(arrays[name], shape)

    def medium(name: str) -> NDArray[np.complex128]:
        return np.broadcast_to(media[name], shape)

    beta = arrays["incidence"] * np.sin(np.radians(arrays["theta_deg"]))
    stack = [(medium(f"layers[{i}]"), at(f"layers[{i}] thickness")) for i in range(count)]
    of = _papilio.film(
        at("wavelength_nm"), np.broadcast_to(beta, shape), at("incidence"), stack, medium("substrate"), polarisation
    )
    return Power(of[0].reshape(shape), of[1].reshape(shape))


def reflectance(
    layers: Sequence[tuple[Material, ArrayLike]],
    wavelength_nm: ArrayLike,
    theta_deg: ArrayLike = 0.0,
    *,
    incidence: ArrayLike = 1.0,
    substrate: Material = "Al",
    polarisation: str = "mean",
) -> NDArray[np.float64]:
    """The share of the power that is reflected; see `power`."""
    return power(
        layers, wavelength_nm, theta_deg, incidence=incidence, substrate=substrate, polarisation=polarisation
    ).reflectance


def transmittance(
    layers: Sequence[tuple[Material, ArrayLike]],
    wavelength_nm: ArrayLike,
    theta_deg: ArrayLike = 0.0,
    *,
    incidence: ArrayLike = 1.0,
    substrate: Material = "Al",
    polarisation: str = "mean",
) -> NDArray[np.float64]:
    """The share of the power that enters the substrate; see `power`."""
    return power(
        layers, wavelength_nm, theta_deg, incidence=incidence, substrate=substrate, polarisation=polarisation
    ).transmittance


def _listed(layers: Sequence[tuple[Material, ArrayLike]]) -> list[tuple[Material, ArrayLike]]:
    if not isinstance(layers, (list, tuple)):
        raise ArgumentError(f"layers: expected a list of (material, thickness in nm), not {_arguments.described(layers)}")
    return list(layers)
