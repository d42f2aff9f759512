"""Arrays as spectra and refractive indices of a scenario: they become files in memory, which its text names."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _papilio
from ._arguments import complexes, described, reals
from ._dims import is_labelled
from .errors import ArgumentError

__all__ = ["Grid", "GridOf", "stored"]

#: Deeper values are no scenario.
_DEEPEST = 40

#: Keys whose values are refractive indices: real numbers are n.
_INDICES = {"index", "material", "n_e", "n_o", "substrate"}

#: First and last wavelength and step of a scenario, nm.
Grid = tuple[float, float, float]

#: Function that returns the wavelengths of a scenario, called where a value requires them; None: not known yet.
GridOf = Callable[[], Grid] | None

#: Name of the file of an array for which the wavelengths are not known yet, as long as that of any other.
_LATER = f"array-{'0' * 12}.csv"


def stored(value: Any, path: str, grid: GridOf, files: dict[str, bytes], depth: int = 0) -> Any:
    """Replaces the arrays in a value for ``path`` by names of files, whose contents are added to ``files``.

    Arrays are pairs ``(wavelength_nm, values)``, objects with wavelengths (DataArray, Series, SpectralDistribution), and numpy arrays
    over the scenario's own wavelengths (``grid``) where a key accepts a file. Complex values are n + 1j k; the real ones of an index are n.
    Without a grid, arrays of the third kind get a name without contents.
    """
    if depth > _DEEPEST:
        return value  # refused with the other values
    if isinstance(value, Mapping):
        return {key: stored(one, f"{path}.{key}" if path else str(key), grid, files, depth + 1) for key, one in value.items()}
    if hasattr(value, "to_bytes") and hasattr(value, "parts"):  # a Diffuser
        content = value.to_bytes()
        name = f"array-{hashlib.sha256(content).hexdigest()[:12]}.npz"
        files[name] = content
        return name
    if grid is None and _is_on_grid(value, path):
        return _LATER
    pair = _pair(value, path, grid)
    if pair is None:
        if isinstance(value, list):
            return [stored(one, f"{path}.{i}", grid, files, depth + 1) for i, one in enumerate(value)]
        return value
    content = _file(path, *pair)
    name = f"array-{hashlib.sha256(content).hexdigest()[:12]}.csv"
    files[name] = content
    return name


def _is_on_grid(value: Any, path: str) -> bool:
    """Returns whether a value is an array over the scenario's own wavelengths."""
    if not isinstance(value, np.ndarray) or value.ndim == 0 or value.dtype.kind not in "fiuc":
        return False
    return value.dtype.kind == "c" or _takes_file(path)


def _pair(value: Any, path: str, grid: GridOf) -> tuple[Any, Any] | None:
    """Returns the wavelengths and values of an array; None if the value is not a spectrum."""
    if isinstance(value, tuple) and len(value) == 2 and all(_is_line(one) for one in value):
        return value[0], value[1]
    if is_labelled(value):
        axis = next((name for name in getattr(value, "coords", {}) if value.coords[name].ndim == 1), None)
        if value.ndim != 1 or axis is None:
            raise ArgumentError(f"{path}: expected a DataArray with one dimension, the wavelength in nm, as its coordinate")
        return value.coords[axis].to_numpy(), value.to_numpy()
    if hasattr(value, "wavelengths") and hasattr(value, "values"):  # colour.SpectralDistribution
        return value.wavelengths, value.values
    if hasattr(value, "index") and hasattr(value, "to_numpy") and getattr(value, "ndim", 0) == 1:  # pandas.Series
        return np.asarray(value.index), value.to_numpy()
    if grid is None or not _is_on_grid(value, path):
        return None
    first, last, step = grid()
    count = round((last - first) / step) + 1
    if value.shape != (count,):
        raise ArgumentError(
            f"{path}: {described(value)}, but the scenario has {count} wavelengths ({first:g} to {last:g} nm in steps of "
            f"{step:g} nm); expected one number for each of them, or a pair (wavelength_nm, values)"
        )
    return np.linspace(first, last, count), value


def _is_line(one: Any) -> bool:
    """Returns whether a value has one dimension and at least two numbers."""
    if isinstance(one, (list, tuple)):
        return len(one) > 1 and all(isinstance(each, (int, float, complex, np.number)) for each in one)
    return isinstance(one, np.ndarray) and one.ndim == 1 and one.size > 1


def _file(path: str, wavelength_nm: Any, values: Any) -> bytes:
    """Returns the contents of a spectrum file (numbers) or of an n-k file (complex numbers)."""
    nm = reals(f"{path}: wavelengths", wavelength_nm, least=1e-3, most=1e6)
    numbers: NDArray[Any] = complexes(path, values)
    if nm.shape != numbers.shape or nm.ndim != 1:
        raise ArgumentError(f"{path}: expected as many values as wavelengths; the shapes are {nm.shape} and {numbers.shape}")
    order = np.argsort(nm, kind="stable")
    if np.asarray(values).dtype.kind == "c" or _papilio.path_keys(path)[-1] in _INDICES:
        rows = [f"{at!r},{n!r},{k!r}" for at, n, k in zip(nm[order].tolist(), numbers.real[order].tolist(), numbers.imag[order].tolist(), strict=True)]
        return ("\n".join(["nm,n,k", *rows]) + "\n").encode()
    rows = [f"{at!r},{one!r}" for at, one in zip(nm[order].tolist(), numbers.real[order].tolist(), strict=True)]
    return ("\n".join(["wavelength_nm,value", *rows]) + "\n").encode()


@cache
def _schema() -> dict[str, Any]:
    return dict(json.loads(_papilio.schema(False)))


def _takes_file(path: str) -> bool:
    """Returns whether the key at a path accepts a name but no list of numbers, so that an array can only be a spectrum."""
    nodes = [_schema()]
    for key in _papilio.path_keys(path):
        nodes = [below for node in nodes for below in _below(node, key)]
    choices = [one for node in nodes for one in _choices(node)]
    items = [below for one in choices for below in _choices(one.get("items", {}))]
    return any(_accepts(one, "string") for one in choices) and not any(_accepts(one, "number", "integer") for one in items)


def _accepts(node: Mapping[str, Any], *kinds: str) -> bool:
    own = node.get("type")
    return any(kind in kinds for kind in ([own] if isinstance(own, str) else own or []))


def _below(node: Mapping[str, Any], key: str) -> Iterator[dict[str, Any]]:
    for one in _choices(node):
        if key.isdecimal() and isinstance(one.get("items"), dict):
            yield one["items"]
        elif key in one.get("properties", {}):
            yield one["properties"][key]
        elif isinstance(one.get("additionalProperties"), dict):
            yield one["additionalProperties"]


def _choices(node: Mapping[str, Any]) -> Iterator[Mapping[str, Any]]:
    """Yields the alternatives of a node of the schema."""
    if "$ref" in node:
        yield from _choices(_schema()["$defs"][node["$ref"].rpartition("/")[2]])
    for word in ("anyOf", "oneOf", "allOf"):
        for one in node.get(word, ()):
            yield from _choices(one)
    yield node
