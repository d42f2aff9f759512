"""Coherent thin films: any stack of flat layers, in one call for all wavelengths, angles and designs.

All multiple reflections interfere. Layers are flat, homogeneous and isotropic, with local bulk indices n + 1j k,
k >= 0. Sources: M. Born, E. Wolf, "Principles of Optics", 7th ed., section 1.6; A. Macleod, "Thin-Film Optical
Filters", 4th ed., chapter 2.

>>> import numpy as np
>>> from papilio import films
>>> quarter = 550 / 4 / 1.5**0.5                     # of the index sqrt(1.5) on glass: no reflection at 550 nm
>>> bool(films.reflectance([(1.5**0.5, quarter)], 550.0, substrate=1.5) < 1e-30)
True
"""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from os import PathLike, fspath
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arguments, _papilio
from ._dims import check_places
from ._film_layouts import LayerArrays, Layout, Spread, by_wavelength, grid, in_rows
from .errors import ArgumentError
from .running import checked_threads

__all__ = [
    "Amplitudes",
    "Derivatives",
    "Material",
    "Polarisation",
    "Power",
    "Variable",
    "absorptance",
    "amplitudes",
    "derivatives",
    "index",
    "material_info",
    "material_names",
    "power",
    "reflectance",
    "transmittance",
]


def __dir__() -> list[str]:
    return __all__


#: A name ("SiO2"), a number or array n + 1j k, or the path of an n-k file: a string is a name, or else a path if it has a separator or an extension.
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
    """Returns the names of materials; docs/films.md has the sources of their data.

    Returns:
        Names for the layers and substrates of this module, and for scenarios.

    Example:
        >>> "SiO2" in papilio.films.material_names()
        True
    """
    return _papilio.material_names()


def material_info(name: str) -> dict[str, Any]:
    """Describes a named material.

    Args:
        name: a name of `material_names`, in any case.

    Returns:
        `name`, `what`, `source`, `page` and `licence` (None unless it is from refractiveindex.info), `measured_nm` and `range_nm`
        (None for a constant), `n_550`, `k_550`, and the arrays `wavelength_nm`, `n` and `k`.

    Example:
        >>> papilio.films.material_info("TiO2")["source"]
        'T. Siefke et al., Adv. Opt. Mater. 4, 1780-1786 (2016)'
    """
    sheet: dict[str, Any] = json.loads(_papilio.material_sheet(_arguments.text("name", name, "the name of a material")))
    arrays = {key: np.array(sheet[key]) for key in ("wavelength_nm", "n", "k")}
    return sheet | arrays


def index(material: Material, wavelength_nm: ArrayLike, *, name: str = "material") -> NDArray[np.complex128]:
    """Returns the refractive index of a material.

    Args:
        material: a name, a number or array n + 1j k, or the path of an n-k file; a string is first interpreted as a name, then as a
            file.
        wavelength_nm: wavelengths in vacuum, nm.
        name: name of the material in errors.

    Returns:
        n + 1j k, in the shape of the wavelengths (of the array, if the material is one).

    Raises:
        ArgumentError: if a wavelength is outside the range of the material's data, which are not extrapolated.
        FileError: if the file cannot be read.

    Example:
        >>> round(float(papilio.films.index("SiO2", 550.0).real), 3)
        1.46
    """
    nm = _arguments.reals("wavelength_nm", wavelength_nm, least=1.0, most=1e6)
    if not isinstance(material, (str, PathLike)):
        numbers = _arguments.complexes(name, material)
        wrong = (numbers.real < 0) | (numbers.imag < 0) | (numbers == 0)
        if wrong.any():
            first = complex(numbers[wrong].flat[0]) if numbers.ndim else complex(numbers[()])
            raise ArgumentError(
                f"{name}: n = {first.real:g}, k = {first.imag:g}; expected n and k of 0 or more, not both 0 (absorption is n + 1j k)"
            )
        return numbers
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
    incidence: Material = 1.0,
    substrate: Material,
    polarisation: Polarisation = "mean",
    threads: int | None = None,
) -> Power:
    """Computes reflectance and transmittance of films, with SIMD and threads, outside the interpreter.

    Wavelengths, angles, thicknesses, indices and media broadcast by numpy's rules. Broadcasting is by position: xarray arrays with
    different dimensions are refused.

    Args:
        layers: (material, thickness in nm), the layer nearest the light first. A material is a name (``material_names()``), a complex
            index n + 1j k (k >= 0 absorbs), an array of indices, or the path of an n-k file. Light is coherent in all layers, thick ones included.
        wavelength_nm: in vacuum, nm.
        theta_deg: inclination in the medium of incidence, 0 to less than 90 degrees.
        incidence: refractive index of the medium of incidence, which is transparent (k up to 1e-6): a number, an array or a material.
        substrate: semi-infinite medium behind the layers.
        polarisation: "s", "p", or "mean" for their mean.
        threads: number of threads; None: one for each processor. The results do not depend on it.

    Returns:
        ``reflectance``, ``transmittance`` (into the substrate) and ``absorptance`` (of the layers), fractions of the incident power in the
        common shape of all arguments.

    Raises:
        ArgumentError: if an argument is invalid; the message names it.
        KeyboardInterrupt: on Ctrl-C.

    Example:
        >>> d = np.linspace(0, 200, 101)                  # designs
        >>> nm = np.arange(380, 781, 5)
        >>> theta = np.array([0, 20, 40, 60])
        >>> films.power([("SiO2", d[:, None, None])], nm[:, None], theta, substrate="Al").reflectance.shape
        (101, 81, 4)
    """
    return Power(*_computed(layers, wavelength_nm, theta_deg, incidence, substrate, polarisation, True, threads))


class _Stack(NamedTuple):
    """The checked arguments of a call."""

    shape: tuple[int, ...]
    arrays: dict[str, NDArray[np.float64]]
    #: The indices of the layers, and that of the substrate.
    media: list[NDArray[np.complex128]]
    thicknesses: list[NDArray[np.float64]]
    workers: int

    def passed(self, laid: Layout) -> tuple[list[int], Spread, Spread, Spread, list[LayerArrays], tuple[Spread, Spread]]:
        """Returns the arrays as the extension module takes them."""
        index_0 = self.arrays["incidence"]
        beta, index_0 = np.broadcast_arrays(index_0 * np.sin(np.radians(self.arrays["theta_deg"])), index_0)
        layers = [(*laid.parts(index), laid.spread(nm)) for index, nm in zip(self.media[:-1], self.thicknesses, strict=True)]
        around = laid.spread(self.arrays["wavelength_nm"]), laid.spread(beta), laid.spread(index_0)
        return [laid.shape[axis] for axis in laid.order], *around, layers, laid.parts(self.media[-1])


def _given(
    layers: Sequence[tuple[Material, ArrayLike]],
    wavelength_nm: ArrayLike,
    theta_deg: ArrayLike,
    incidence: Material,
    substrate: Material,
    threads: int | None,
) -> _Stack:
    """Checks the arguments of a call."""
    arguments: dict[str, Any] = {"wavelength_nm": wavelength_nm, "theta_deg": theta_deg, "incidence": incidence, "substrate": substrate}
    arrays: dict[str, NDArray[np.float64]] = {
        "wavelength_nm": _arguments.reals("wavelength_nm", wavelength_nm, least=1.0, most=1e6),
        "theta_deg": _arguments.reals("theta_deg", theta_deg, least=0.0, below=90.0),
        "incidence": _transparent(incidence, wavelength_nm),
    }
    media: dict[str, NDArray[np.complex128]] = {}
    for at, layer in enumerate(_listed(layers)):
        name = f"layers[{at}]"
        if not isinstance(layer, (tuple, list)) or len(layer) != 2:
            raise ArgumentError(f"{name}: expected (material, thickness in nm), not {_arguments.described(layer)}")
        material, thickness = layer
        arguments |= {name: material, f"{name} thickness": thickness}
        media[name] = index(material, wavelength_nm, name=name)
        arrays[f"{name} thickness"] = _arguments.reals(f"{name} thickness", thickness, least=0.0)
    media["substrate"] = index(substrate, wavelength_nm, name="substrate")
    check_places({name: one for name, one in arguments.items() if not isinstance(one, (str, PathLike))})
    shape = _arguments.common_shape({**arrays, **media})
    thicknesses = [arrays[f"layers[{i}] thickness"] for i in range(len(media) - 1)]
    return _Stack(shape, arrays, list(media.values()), thicknesses, checked_threads(threads) or os.cpu_count() or 1)


#: Largest k of the medium of incidence, as for the glass of a scenario without a thickness.
_CLEAR_K = 1e-6


def _transparent(incidence: Material, wavelength_nm: ArrayLike) -> NDArray[np.float64]:
    """Returns the index of the medium of incidence.

    Raises:
        ArgumentError: if the medium absorbs.
    """
    if isinstance(incidence, (str, PathLike)):
        found = index(incidence, wavelength_nm, name="incidence")
    else:
        found = _arguments.complexes("incidence", incidence)
    if (np.abs(found.imag) > _CLEAR_K).any():
        most = found.imag.flat[np.abs(found.imag).argmax()]
        raise ArgumentError(
            f"incidence: k = {most:g}; expected a transparent medium (k up to {_CLEAR_K:g}, which is not used), in which incident power is defined"
        )
    return _arguments.reals("incidence", found.real, least=1e-6, most=1e3)


def _computed(
    layers: Sequence[tuple[Material, ArrayLike]],
    wavelength_nm: ArrayLike,
    theta_deg: ArrayLike,
    incidence: Material,
    substrate: Material,
    polarisation: Polarisation,
    both: bool,
    threads: int | None,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Computes reflectance and, if ``both``, transmittance."""
    _arguments.one_of("polarisation", polarisation, ("s", "p", "mean"))
    given = _given(layers, wavelength_nm, theta_deg, incidence, substrate, threads)
    if 0 in given.shape:
        return np.zeros(given.shape), np.zeros(given.shape)
    spanned = None if both or polarisation != "mean" else grid(given.shape, given.arrays, given.media, given.thicknesses)
    if spanned is not None:
        laid, gap = spanned
        return laid.back(_papilio.film_grid(*given.passed(laid), gap, given.workers), given.shape), np.zeros(0)
    laid = in_rows(given.shape)
    flat, other = _papilio.film(*given.passed(laid), polarisation, both, given.workers)
    return laid.back(flat, given.shape), laid.back(other, given.shape) if both else other


def reflectance(
    layers: Sequence[tuple[Material, ArrayLike]],
    wavelength_nm: ArrayLike,
    theta_deg: ArrayLike = 0.0,
    *,
    incidence: Material = 1.0,
    substrate: Material,
    polarisation: Polarisation = "mean",
    threads: int | None = None,
) -> NDArray[np.float64]:
    """Computes the reflected fraction of the power; faster than `power` for the mean of both polarisations.

    Args:
        layers, wavelength_nm, theta_deg, incidence, substrate, polarisation, threads: as for `power`.

    Returns:
        The reflectance, 0 to 1, in the common shape of all arguments.

    Raises:
        ArgumentError, KeyboardInterrupt: as for `power`.

    Example:
        >>> round(float(films.reflectance([("SiO2", 100.0)], 550.0, substrate="Al")), 2)
        0.85
    """
    return _computed(layers, wavelength_nm, theta_deg, incidence, substrate, polarisation, False, threads)[0]


def transmittance(
    layers: Sequence[tuple[Material, ArrayLike]],
    wavelength_nm: ArrayLike,
    theta_deg: ArrayLike = 0.0,
    *,
    incidence: Material = 1.0,
    substrate: Material,
    polarisation: Polarisation = "mean",
    threads: int | None = None,
) -> NDArray[np.float64]:
    """Computes the fraction of the power that enters the substrate.

    Args:
        layers, wavelength_nm, theta_deg, incidence, substrate, polarisation, threads: as for `power`.

    Returns:
        The transmittance, 0 to 1, in the common shape of all arguments; 0 if the wave in the substrate is evanescent.

    Raises:
        ArgumentError, KeyboardInterrupt: as for `power`.

    Example:
        >>> round(float(films.transmittance([], 550.0, substrate=1.5)), 2)
        0.96
    """
    return power(
        layers, wavelength_nm, theta_deg, incidence=incidence, substrate=substrate, polarisation=polarisation, threads=threads
    ).transmittance


class Amplitudes(NamedTuple):
    """Complex amplitudes of the electric field over that of the incident wave, at the two faces of the film.

    Fields vary as exp(-i omega t): a longer path adds to the phase. At normal incidence ``r_p`` is ``-r_s`` (the p axes of incident and
    reflected light are opposite), as in ellipsometry.
    """

    r_s: NDArray[np.complex128]
    r_p: NDArray[np.complex128]
    t_s: NDArray[np.complex128]
    t_p: NDArray[np.complex128]

    @property
    def psi_deg(self) -> NDArray[np.float64]:
        """Ellipsometric angle psi, 0 to 90 degrees: tan(psi) = |r_p / r_s|."""
        return np.asarray(np.degrees(np.arctan2(np.abs(self.r_p), np.abs(self.r_s))))

    @property
    def delta_deg(self) -> NDArray[np.float64]:
        """Ellipsometric angle Delta, 0 to less than 360 degrees: phase of r_p / r_s in the convention exp(+i omega t), n - 1j k."""
        return np.asarray(np.mod(-np.degrees(np.angle(self.r_p * np.conj(self.r_s))), 360.0))


def amplitudes(
    layers: Sequence[tuple[Material, ArrayLike]],
    wavelength_nm: ArrayLike,
    theta_deg: ArrayLike = 0.0,
    *,
    incidence: Material = 1.0,
    substrate: Material,
    threads: int | None = None,
) -> Amplitudes:
    """Computes complex amplitudes of reflection and transmission, for phases and ellipsometry.

    Args:
        layers, wavelength_nm, theta_deg, incidence, substrate, threads: as for `power`.

    Returns:
        ``r_s``, ``r_p``, ``t_s``, ``t_p`` in the common shape of all arguments, and from these ``psi_deg`` and ``delta_deg``.

    Raises:
        ArgumentError, KeyboardInterrupt: as for `power`.

    Example:
        >>> bare = films.amplitudes([], 550.0, 56.31, substrate=1.5)       # Brewster's angle: p is not reflected
        >>> bool(bare.psi_deg < 0.01)
        True
    """
    given = _given(layers, wavelength_nm, theta_deg, incidence, substrate, threads)
    if 0 in given.shape:
        return Amplitudes(*(np.zeros(given.shape, np.complex128) for _ in range(4)))
    laid = in_rows(given.shape)
    found = laid.back(_papilio.film_amplitudes(*given.passed(laid), given.workers), given.shape, (4,))
    return Amplitudes(*(found[..., i] for i in range(4)))


def absorptance(
    layers: Sequence[tuple[Material, ArrayLike]],
    wavelength_nm: ArrayLike,
    theta_deg: ArrayLike = 0.0,
    *,
    incidence: Material = 1.0,
    substrate: Material,
    polarisation: Polarisation = "mean",
    threads: int | None = None,
) -> NDArray[np.float64]:
    """Computes the fraction of the power that each layer absorbs.

    Args:
        layers, wavelength_nm, theta_deg, incidence, substrate, polarisation, threads: as for `power`.

    Returns:
        Shape [..., layer]: the common shape of all arguments, and the layers in their order. The sum over the layers is
        ``power(...).absorptance``; the substrate absorbs what enters it, ``transmittance``.

    Raises:
        ArgumentError, KeyboardInterrupt: as for `power`.

    Example:
        >>> films.absorptance([("Cr:Johnson", 10.0), ("SiO2", 100.0)], [500.0, 600.0], substrate="Al").shape
        (2, 2)
    """
    _arguments.one_of("polarisation", polarisation, ("s", "p", "mean"))
    given = _given(layers, wavelength_nm, theta_deg, incidence, substrate, threads)
    count = len(given.thicknesses)
    if 0 in given.shape or not count:
        return np.zeros((*given.shape, count))
    laid = in_rows(given.shape)
    return laid.back(_papilio.film_absorptance(*given.passed(laid), polarisation, given.workers), given.shape, (count,))


#: A number of a film: "thickness", "n" or "k", and the index of its layer, or "substrate".
Variable = tuple[Literal["thickness", "n", "k"], int | Literal["substrate"]]


class Derivatives(NamedTuple):
    """The mean reflectance of both polarisations, and its derivatives."""

    reflectance: NDArray[np.float64]
    #: Shape [..., variable]: per nm of a thickness, per 1 of n and k.
    derivatives: NDArray[np.float64]
    variables: list[Variable]


def derivatives(
    layers: Sequence[tuple[Material, ArrayLike]],
    wavelength_nm: ArrayLike,
    theta_deg: ArrayLike = 0.0,
    *,
    by: Sequence[Variable] | None = None,
    incidence: Material = 1.0,
    substrate: Material,
    threads: int | None = None,
) -> Derivatives:
    """Computes the reflectance for unpolarised light (the mean of s and p) and its exact derivatives, all in one pass.

    Args:
        layers, wavelength_nm, theta_deg, incidence, substrate, threads: as for `power`.
        by: pairs of a quantity, "thickness", "n" or "k", and the index of a layer from 0, or "substrate": ("thickness", 0),
            ("k", "substrate"). None: the thicknesses of all layers.

    Returns:
        ``reflectance`` in the common shape of all arguments; ``derivatives`` with the variables as one more, last axis, per nm for
        thicknesses and per unit of n or k; ``variables``, in the order of that axis.

    Raises:
        ArgumentError, KeyboardInterrupt: as for `power`.

    Example:
        >>> found = films.derivatives([("SiO2", 100.0), ("Cr:Johnson", 10.0)], np.arange(400, 701, 10), [[0], [30]], substrate="Al")
        >>> found.derivatives.shape, found.variables
        ((2, 31, 2), [('thickness', 0), ('thickness', 1)])
    """
    given = _given(layers, wavelength_nm, theta_deg, incidence, substrate, threads)
    count = len(given.thicknesses)
    wanted = [_variable(at, one, count) for at, one in enumerate(by)] if by is not None else [("thickness", i) for i in range(count)]
    variables: list[Variable] = wanted  # type: ignore[assignment]
    if 0 in given.shape:
        return Derivatives(np.zeros(given.shape), np.zeros((*given.shape, len(variables))), variables)
    laid = by_wavelength(given.shape, [given.arrays["theta_deg"], given.arrays["incidence"], *given.thicknesses])
    named = [(of, None if layer == "substrate" else layer) for of, layer in variables]
    values, slopes = _papilio.film_derivatives(*given.passed(laid), named, given.workers)
    return Derivatives(laid.back(values, given.shape), laid.back(slopes, given.shape, (len(variables),)), variables)


def _variable(at: int, one: object, count: int) -> tuple[str, int | str]:
    """Checks a variable of `derivatives`."""
    name = f"by[{at}]"
    if not isinstance(one, tuple) or len(one) != 2:
        raise ArgumentError(f'{name}: expected a variable such as ("thickness", 0) or ("n", "substrate"), not {_arguments.described(one)}')
    of = _arguments.one_of(name, one[0], ("thickness", "n", "k"))
    if isinstance(one[1], str):
        _arguments.one_of(name, one[1], ("substrate",))
        if of == "thickness":
            raise ArgumentError(f"{name}: the substrate has no thickness")
        return of, "substrate"
    return of, _arguments.whole(name, one[1], 0, count - 1)


def _listed(layers: Sequence[tuple[Material, ArrayLike]]) -> list[tuple[Material, ArrayLike]]:
    if not isinstance(layers, (list, tuple)):
        raise ArgumentError(f"layers: expected a list of (material, thickness in nm), not {_arguments.described(layers)}")
    return list(layers)
