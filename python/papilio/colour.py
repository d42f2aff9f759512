"""Colours of arrays of spectra.

The components of a colour (X, Y, Z; L*, a*, b*; u', v') are along the last axis; all other axes broadcast. Undefined values (such
as the chromaticity of black) are NaN. Sources: CIE 15:2018; CIEDE2000 as in Sharma, Wu, Dalal, Color Res. Appl. 30, 21
(2005).
"""

from __future__ import annotations

import json
from functools import cache
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arguments, _messages, _papilio
from ._dims import check_places, is_labelled
from .errors import ArgumentError

__all__ = ["Gamut", "Observer", "coverage_percent", "delta_e_2000", "gamut_percent", "illuminant", "illuminant_info", "illuminant_names", "lab", "uv_prime", "xyz"]


def __dir__() -> list[str]:
    return __all__

#: The CIE standard observer of 2 or 10 degrees.
Observer = Literal["1931", "1964"]

#: A triangle of primaries.
Gamut = Literal["srgb", "ebu", "ntsc", "dci-p3"]

_GAMUTS = ("srgb", "ebu", "ntsc", "dci-p3")

#: Wavelengths of the observer, in the default step of scenarios, nm.
_SEEN_NM = np.arange(380.0, 781.0, 5.0)

#: Spectra may omit this fraction of X, Y or Z of the light without a warning.
_LEFT_OUT = 1e-3


def illuminant_names() -> list[str]:
    """Returns the names of illuminants.

    Returns:
        Names for the lights of this module and of scenarios.

    Example:
        >>> "D65" in papilio.colour.illuminant_names()
        True
    """
    return _papilio.illuminant_names()


def illuminant_info(name: str) -> dict[str, Any]:
    """Describes a CIE illuminant.

    Args:
        name: a name of `illuminant_names`, in any spelling, or a usual one ("F11", "TL84").

    Returns:
        `name`, `what`, `source`, `table_step_nm` (None for E), `x`, `y`, `u_prime`, `v_prime`, `cct_K`, `duv`, `Ra`, `lm_per_W`, and the
        arrays `wavelength_nm` and `relative_power` of its table.

    Example:
        >>> round(papilio.colour.illuminant_info("TL84")["cct_K"])
        4001
    """
    sheet: dict[str, Any] = json.loads(_papilio.illuminant_sheet(_arguments.text("name", name, "the name of an illuminant")))
    return sheet | {key: np.array(sheet[key]) for key in ("wavelength_nm", "relative_power")}


def illuminant(name: str, wavelength_nm: ArrayLike) -> NDArray[np.float64]:
    """Returns the relative spectrum of an illuminant.

    Args:
        name: one of `illuminant_names`: "D65", "A".
        wavelength_nm: uniformly spaced, nm.

    Returns:
        Spectral power, 100 at 560 nm for the illuminants of the CIE; one number for each wavelength.

    Example:
        >>> float(papilio.colour.illuminant("D65", [555, 560, 565])[1])
        100.0
    """
    return _illuminant("name", name, wavelength_nm)


def _illuminant(argument: str, name: str, wavelength_nm: ArrayLike) -> NDArray[np.float64]:
    """Returns the relative spectrum of an illuminant; errors call its name ``argument``."""
    named = _arguments.text(argument, name, "the name of an illuminant")
    return _papilio.illuminant_spectrum(argument, named, _arguments.grid("wavelength_nm", wavelength_nm))


def xyz(
    spectra: ArrayLike, wavelength_nm: ArrayLike, light: str | ArrayLike | None = "D65", *, observer: Observer = "1931"
) -> NDArray[np.float64]:
    """Computes X, Y, Z of spectra, shape [..., wavelength] to [..., 3].

    Args:
        spectra: reflectance factors; with ``light=None``, spectra of light.
        wavelength_nm: uniformly spaced, ascending, nm.
        light: name of the illuminant (``illuminant_names()``), or its spectrum with one number for each wavelength; Y is 1 (not 100)
            for a perfect white diffuser. None: X, Y, Z in the spectra's unit times nm.
        observer: "1931" (2 degrees) or "1964" (10 degrees).

    The product of spectrum and light at the specified wavelengths is interpolated linearly to 1 nm and summed from 380 to 780 nm.
    Steps of 1 to 10 nm agree within a colour difference (CIEDE2000) of about 0.15, also with narrow-band lights; steps of 20 nm
    deviate by up to 1. Light outside the specified wavelengths is ignored.

    Returns:
        X, Y and Z along the last axis.

    Raises:
        ArgumentError: if an argument is invalid; the message names it.

    Warns:
        PapilioWarning: if more than 0.1 % of X, Y or Z of the light lies outside the wavelengths.

    Example:
        >>> nm = np.arange(380, 781, 5)
        >>> papilio.colour.xyz(np.full(81, 0.5), nm, "D65").round(4).tolist()
        [0.4752, 0.5, 0.5443]
    """
    _arguments.one_of("observer", observer, ("1931", "1964"))
    given = {"spectra": spectra, "wavelength_nm": wavelength_nm, "light": light}
    check_places({name: one for name, one in given.items() if is_labelled(one)})
    grid = _arguments.grid("wavelength_nm", wavelength_nm)
    count = np.asarray(wavelength_nm).size
    numbers = _arguments.reals("spectra", spectra)
    _arguments.last_axis("spectra", numbers, count, "one number for each wavelength")
    scale = 1.0
    if light is not None:
        of_light = _illuminant("light", light, wavelength_nm) if isinstance(light, str) else _arguments.reals("light", light, least=0.0)
        if of_light.shape != (count,):
            raise ArgumentError(f"light: expected {count} numbers, one for each wavelength; the shape is {of_light.shape}")
        numbers = numbers * of_light
        scale = float(_papilio.xyz(grid, observer, np.ascontiguousarray(of_light))[1])
        if not scale > 0.0:
            raise ArgumentError("light: expected visible light (380 to 780 nm), but its Y is 0")
    found = _rows(_papilio.xyz(grid, observer, _flat(numbers)), numbers.shape[:-1], 3) / scale
    _messages.warn(_truncated(grid[0], grid[1], light if isinstance(light, str) else None, observer))
    return found


def lab(colours: ArrayLike, white: ArrayLike | None = None) -> NDArray[np.float64]:
    """Computes L*, a*, b* of X, Y, Z relative to a white, shape [..., 3].

    Both are on one scale, with Y = 1 for a perfect white diffuser, as `xyz` returns colours under a light. The default white is
    that of `xyz` under "D65" at 380 to 780 nm in steps of 5 nm, (0.95042, 1, 1.08861): its L*, a*, b* are exactly 100, 0, 0 (within
    5e-5 in steps of 1 to 10 nm). For other lights, observers and wavelengths, specify their white:
    ``white=xyz(np.ones(nm.size), nm, light)``.

    Args:
        colours: X, Y, Z along the last axis.
        white: X, Y, Z of the white; None: that of D65. Both broadcast.

    Returns:
        L*, a*, b* along the last axis.

    Example:
        >>> bool(np.allclose(papilio.colour.lab([0.95042, 1.0, 1.08861]), [100, 0, 0], atol=0.01))
        True
    """
    pairs, shape = _together(3, colours=colours, white=_white_of_d65() if white is None else white)
    return _rows(_papilio.lab(pairs), shape, 3)


def uv_prime(colours: ArrayLike) -> NDArray[np.float64]:
    """Computes CIE 1976 u', v'.

    Args:
        colours: X, Y, Z along the last axis; NaN is allowed.

    Returns:
        u' and v' along the last axis; NaN for black.

    Example:
        >>> papilio.colour.uv_prime([0.95042, 1.0, 1.08861]).round(4).tolist()
        [0.1978, 0.4684]
    """
    numbers = _arguments.reals("colours", colours, missing=True)
    _arguments.last_axis("colours", numbers, 3, "X, Y and Z")
    return _rows(_papilio.uv_prime(_flat(numbers)), numbers.shape[:-1], 2)


def gamut_percent(primaries: ArrayLike, reference: Gamut = "srgb") -> NDArray[np.float64]:
    """Computes the area of the triangle of red, green and blue in u'v', in % of the area of a reference.

    Args:
        primaries: u', v' of red, green and blue, shape [..., 3, 2].
        reference: "srgb", "ebu", "ntsc" or "dci-p3".

    Returns:
        The area in %, shape [...]; NaN where a chromaticity is NaN.

    Example:
        >>> srgb = [[0.4507, 0.5229], [0.1250, 0.5625], [0.1754, 0.1579]]
        >>> round(float(papilio.colour.gamut_percent(srgb)))
        100
    """
    return _gamut(primaries, reference, False)


def coverage_percent(primaries: ArrayLike, reference: Gamut = "srgb") -> NDArray[np.float64]:
    """Computes the part of a reference triangle in u'v' that red, green and blue cover.

    Args:
        primaries: u', v' of red, green and blue, shape [..., 3, 2].
        reference: "srgb", "ebu", "ntsc" or "dci-p3".

    Returns:
        The covered part in %, 0 to 100, shape [...]; NaN where a chromaticity is NaN.

    Example:
        >>> srgb = [[0.4507, 0.5229], [0.1250, 0.5625], [0.1754, 0.1579]]
        >>> round(float(papilio.colour.coverage_percent(srgb)))
        100
    """
    return _gamut(primaries, reference, True)


def delta_e_2000(one: ArrayLike, other: ArrayLike) -> NDArray[np.float64]:
    """Computes the CIEDE2000 colour difference, all weights 1.

    Args:
        one, other: L*, a*, b* along the last axis; they broadcast.

    Returns:
        The difference, shape [...].

    Example:
        >>> round(float(papilio.colour.delta_e_2000([50, 2.6772, -79.7751], [50, 0, -82.7485])), 4)    # Sharma 2005, pair 1
        2.0425
    """
    pairs, shape = _together(3, one=one, other=other)
    return _papilio.delta_e_2000(pairs).reshape(shape)


@cache
def _white_of_d65() -> tuple[float, ...]:
    return tuple(xyz(np.ones(_SEEN_NM.size), _SEEN_NM, "D65").tolist())


@cache
def _truncated(first_nm: float, last_nm: float, light: str | None, observer: Observer) -> list[str]:
    """Returns a warning if wavelengths from ``first_nm`` to ``last_nm`` omit visible light; None: equal-energy illuminant."""
    if first_nm <= _SEEN_NM[0] and last_nm >= _SEEN_NM[-1]:
        return []
    whole = np.ones(_SEEN_NM.size) if light is None else illuminant(light, _SEEN_NM)
    fine_nm = np.arange(_SEEN_NM[0], _SEEN_NM[-1] + 1.0)
    fine = np.interp(fine_nm, _SEEN_NM, whole)
    inside = np.where((fine_nm >= first_nm - 1e-6) & (fine_nm <= last_nm + 1e-6), fine, 0.0)
    seen, of_all = (_papilio.xyz(_arguments.grid("wavelength_nm", fine_nm), observer, one) for one in (inside, fine))
    missing = 1.0 - seen / of_all
    if missing.max() <= _LEFT_OUT:
        return []
    fractions = ", ".join(f"{100 * fraction:.2g} % of {name}" for fraction, name in zip(missing, "XYZ", strict=True))
    of = "the equal-energy illuminant" if light is None else light
    return [
        f"wavelength_nm: {first_nm:g} to {last_nm:g} nm omit {fractions} of {of}, which is visible from 380 to 780 nm; "
        "for L*, a*, b*, use the white of the same wavelengths: lab(colours, white=xyz(np.ones(nm.size), nm, light))"
    ]


def _gamut(primaries: ArrayLike, reference: str, covered: bool) -> NDArray[np.float64]:
    _arguments.one_of("reference", reference, _GAMUTS)
    numbers = _arguments.reals("primaries", primaries, missing=True)
    if numbers.shape[-2:] != (3, 2):
        raise ArgumentError(f"primaries: expected u', v' of red, green and blue, shape [..., 3, 2], not {numbers.shape}")
    return _papilio.gamut(_flat(numbers), reference, covered).reshape(numbers.shape[:-2])


def _together(length: int, **colours: ArrayLike) -> tuple[NDArray[np.float64], tuple[int, ...]]:
    """Concatenates the colours of two arguments into a flat array; also returns the shape of their other axes."""
    check_places(colours)
    arrays = {name: _arguments.reals(name, values, missing=True) for name, values in colours.items()}
    for name, array in arrays.items():
        _arguments.last_axis(name, array, length, "a colour")
    shape = _arguments.common_shape(arrays)
    return _flat(np.concatenate([np.broadcast_to(array, shape) for array in arrays.values()], axis=-1)), shape[:-1]


def _flat(array: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.ascontiguousarray(array).reshape(-1)


def _rows(flat: NDArray[np.float64], shape: tuple[int, ...], length: int) -> NDArray[np.float64]:
    return flat.reshape(*shape, length)
