"""Checks of arguments, and their conversion to arrays. Each error names its argument."""

from __future__ import annotations

import os
from collections.abc import Sequence
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import ArgumentError

#: The largest number of elements in an array of a result.
MOST_NUMBERS = 2**31


def reals(
    name: str, values: ArrayLike, *, least: float = -np.inf, most: float = np.inf, below: float | None = None, missing: bool = False
) -> NDArray[np.float64]:
    """Returns an array of finite numbers from ``least`` to ``most``, or to less than ``below``; with ``missing``, NaN is allowed."""
    array = _array(name, values)
    if array.dtype.kind not in "fiu":
        raise ArgumentError(f"{name}: expected numbers, not {described(values)}")
    numbers = array.astype(np.float64, copy=False)
    fine = numbers if not missing else numbers[~np.isnan(numbers)]
    if not np.isfinite(fine).all():
        raise ArgumentError(f"{name}: expected finite numbers, not {_first(numbers, ~np.isfinite(numbers))}")
    if fine.size and not (fine.min() >= least and fine.max() <= most):
        wrong = _first(numbers, (numbers < least) | (numbers > most))
        raise ArgumentError(f"{name}: {wrong:g} is out of range; expected {_range(least, most)}")
    if below is not None and fine.size and not (fine.min() >= least and fine.max() < below):
        wrong = _first(numbers, (numbers < least) | (numbers >= below))
        raise ArgumentError(f"{name}: {wrong:g} is out of range; expected {least:g} to less than {below:g}")
    return numbers


def ascending(name: str, values: ArrayLike | None, most: float = np.inf, below: float | None = None) -> list[float] | None:
    """Returns ascending angles from 0 to ``most`` degrees, or to less than ``below``, at least one; None for None."""
    if values is None:
        return None
    numbers = reals(name, values, least=0.0, most=most, below=below)
    if numbers.ndim != 1 or numbers.size == 0 or not (np.diff(numbers) > 0).all():
        raise ArgumentError(f"{name}: expected a list of ascending angles, not {described(values)}")
    return [float(number) for number in numbers]


def complexes(name: str, values: ArrayLike) -> NDArray[np.complex128]:
    """Returns an array of finite complex numbers."""
    array = _array(name, values)
    if array.dtype.kind not in "fiuc":
        raise ArgumentError(f"{name}: expected numbers n + 1j k, not {described(values)}")
    numbers = array.astype(np.complex128, copy=False)
    if not np.isfinite(numbers).all():
        raise ArgumentError(f"{name}: expected finite numbers, not {_first(numbers, ~np.isfinite(numbers))}")
    return numbers


def grid(name: str, wavelength_nm: ArrayLike) -> tuple[float, float, float]:
    """Returns the first and last of uniformly spaced wavelengths, and their step."""
    nm = reals(name, wavelength_nm, least=1.0, most=1e6)
    if nm.ndim != 1 or nm.size < 2:
        raise ArgumentError(f"{name}: expected at least two wavelengths in one dimension, not shape {nm.shape}")
    step = (nm[-1] - nm[0]) / (nm.size - 1)
    if not (step > 0 and np.allclose(np.diff(nm), step, rtol=1e-6, atol=0)):
        raise ArgumentError(f"{name}: expected ascending wavelengths in uniform steps, in nm")
    return float(nm[0]), float(nm[-1]), float(step)


def last_axis(name: str, values: NDArray[Any], length: int, what: str) -> None:
    """Checks the length of the last axis.

    Raises:
        ArgumentError: if it is not ``length``; ``what`` names its contents.
    """
    if values.ndim < 1 or values.shape[-1] != length:
        raise ArgumentError(f"{name}: expected {what} along the last axis ({length} numbers); the shape is {values.shape}")


def common_shape(arrays: dict[str, NDArray[Any]]) -> tuple[int, ...]:
    """Returns the shape to which all arrays broadcast."""
    try:
        shape = np.broadcast_shapes(*(array.shape for array in arrays.values()))
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items())
        raise ArgumentError(f"{_names(arrays)}: the shapes do not broadcast together: {shapes}") from None
    if np.prod([float(length) for length in shape]) > MOST_NUMBERS:
        raise ArgumentError(f"{_names(arrays)}: the arrays broadcast to shape {shape}; expected at most {MOST_NUMBERS} numbers")
    return shape


def text(name: str, value: object, expected: str) -> str:
    """Returns a string that can be encoded as UTF-8; ``expected`` describes it in the error."""
    if isinstance(value, str):
        try:
            value.encode()
        except UnicodeEncodeError:
            pass
        else:
            return value
    raise ArgumentError(f"{name}: expected {expected}, not {described(value)}")


def one_of(name: str, value: object, known: Sequence[str]) -> str:
    """Returns ``value`` if it is one of ``known``."""
    if not isinstance(value, str) or value not in known:
        raise ArgumentError(f"{name}: expected {' or '.join(map(repr, known))}, not {described(value)}")
    return value


def whole(name: str, value: object, least: int, most: int) -> int:
    """Returns an integer from ``least`` to ``most``."""
    number: object = value
    if isinstance(value, np.ndarray) and value.ndim == 0:
        number = value[()]
    if isinstance(number, (bool, np.bool_)) or not isinstance(number, (int, np.integer)):
        raise ArgumentError(f"{name}: expected an integer, not {described(value)}")
    if not least <= int(number) <= most:
        raise ArgumentError(f"{name}: expected {least} to {most}, not {described(value)}")
    return int(number)


def checked_folder(out: str | PathLike[str] | None) -> str | None:
    """Returns the absolute path of a folder for results; creates the folder if necessary."""
    if out is None:
        return None
    try:
        where = os.path.abspath(os.fspath(out))
        os.makedirs(where, exist_ok=True)
    except (OSError, TypeError, ValueError) as error:
        raise ArgumentError(f"out: {error}") from None
    return os.fsdecode(where)


def described(value: object) -> str:
    """Returns a short description of a value."""
    if isinstance(value, np.ndarray) and value.ndim:
        return f"an array of {value.dtype}, shape {value.shape}"
    shown = ascii(value)
    return shown if len(shown) <= 60 else f"{shown[:57]}..."


def _array(name: str, values: ArrayLike) -> NDArray[Any]:
    """Converts values with `numpy.asarray`."""
    if np.ma.is_masked(values):
        raise ArgumentError(f"{name}: expected an array without masked values")
    try:
        array = np.asarray(values)
    except Exception as error:  # an object's own conversion may raise any exception
        raise ArgumentError(f"{name}: expected numbers: {error}") from None
    if array.size > MOST_NUMBERS:
        raise ArgumentError(f"{name}: expected at most {MOST_NUMBERS} numbers; the shape is {array.shape}")
    return array


def _names(arrays: dict[str, NDArray[Any]]) -> str:
    return ", ".join(arrays)


def _first(array: NDArray[Any], wrong: NDArray[np.bool_]) -> Any:
    return array[wrong].flat[0] if array.ndim else array[()]


def _range(least: float, most: float) -> str:
    if np.isinf(most):
        return f"{least:g} or more"
    return f"{most:g} or less" if np.isinf(least) else f"{least:g} to {most:g}"
