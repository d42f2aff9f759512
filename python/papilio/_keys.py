"""Keys of a scenario as variables: their names in tables, units and long names."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ._arguments import described, text
from .errors import ArgumentError

__all__ = ["Keys", "Names", "attributes", "joined", "short_names"]

#: One key of a scenario, or several keys with a common value.
Keys = str | tuple[str, ...]

#: Names of variables in tables: ``{key: name}`` for some of them, or a name for each in their order.
Names = Mapping[Any, str] | Sequence[str]

#: Units at the end of the parts of a key.
_UNITS = {
    "nm": "nm",
    "um": "um",
    "mm": "mm",
    "deg": "degree",
    "lx": "lx",
    "cd_m2": "cd m-2",
    "percent": "%",
    "per_mm": "mm-1",
    "K": "K",
    "years": "years",
}


def joined(keys: Keys) -> str:
    """Returns the name of a variable in tables: keys with a common value are joined by commas."""
    return keys if isinstance(keys, str) else ", ".join(keys)


def attributes(keys: Keys) -> dict[str, str]:
    """Returns the unit, the long name and the keys of a variable, as attributes of a coordinate."""
    each = (keys,) if isinstance(keys, str) else keys
    units = {_split(part)[1] for key in each for part in key.split(".") if _split(part)[1]}
    words = [" ".join(_words(key)) for key in each]
    return {"units": units.pop() if len(units) == 1 else "1", "long_name": ", ".join(words), "key": joined(keys)}


def _words(key: str) -> list[str]:
    parts = key.split(".")
    while len(parts) > 1 and parts[0] in ("display", "pixel"):
        parts = parts[1:]
    return [_split(part)[0].replace("_", " ") for part in parts]


def _split(part: str) -> tuple[str, str]:
    """Splits a part of a key into its name and its unit; "" if it has none."""
    for end, unit in _UNITS.items():
        if part.endswith(f"_{end}"):
            return part.removesuffix(f"_{end}"), unit
    return part, ""


def short_names(names: Names | None, variables: Sequence[Keys]) -> dict[str, str]:
    """Returns the name of each variable in tables, by its `joined` keys.

    Raises:
        ArgumentError: if there are too few or too many names, or one occurs twice.
    """
    whole = [joined(keys) for keys in variables]
    if names is None:
        return {name: name for name in whole}
    if isinstance(names, Mapping):
        given = {joined(keys) if isinstance(keys, (str, tuple)) else described(keys): name for keys, name in names.items()}
        unknown = [key for key in given if key not in whole]
        if unknown:
            raise ArgumentError(f"names: {unknown[0]} is no variable; the variables are {', '.join(whole)}")
        found = {key: given.get(key, key) for key in whole}
    elif isinstance(names, str) or not isinstance(names, Sequence) or len(names) != len(whole):
        raise ArgumentError(f"names: expected {len(whole)} names, one for each variable, or a dict of keys and names, not {described(names)}")
    else:
        found = dict(zip(whole, names, strict=True))
    for name in found.values():
        text("names", name, "names")
        if list(found.values()).count(name) > 1:
            raise ArgumentError(f"names: expected a different name for each variable; {name!r} occurs twice")
    return found
