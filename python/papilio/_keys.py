"""Keys of a scenario as variables: their names in tables, units and long names."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from . import _papilio
from ._arguments import described, text
from .errors import ArgumentError

__all__ = ["Keys", "Names", "attributes", "joined", "short_names"]

#: One key of a scenario, or several keys with a common value.
Keys = str | tuple[str, ...]

#: Names of variables in tables: ``{key: name}`` for some of them, or a name for each in their order.
Names = Mapping[Any, str] | Sequence[str]

#: Units of labels as in attributes of xarray.
_UNITS = {"": "1", "deg": "degree", "µm": "um", "cd/m²": "cd m-2"}


def joined(keys: Keys) -> str:
    """Returns the name of a variable in tables: keys with a common value are joined by commas."""
    return keys if isinstance(keys, str) else ", ".join(keys)


def attributes(keys: Keys) -> dict[str, str]:
    """Returns the unit, the long name and the keys of a variable, as attributes of a coordinate."""
    each = (keys,) if isinstance(keys, str) else keys
    labels = [_papilio.label(key) for key in each]
    units = {_UNITS.get(unit, unit) for _, unit in labels}
    return {"units": units.pop() if len(units) == 1 else "1", "long_name": ", ".join(words for words, _ in labels), "key": joined(keys)}


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
