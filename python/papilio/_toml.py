"""Python values as TOML."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping, Sequence
from pathlib import PurePath
from typing import Any

from .errors import ArgumentError

_BARE = re.compile(r"[A-Za-z0-9_-]+\Z")

#: Deeper than this is no scenario.
_DEEPEST = 32


def plain(value: Any, name: str, depth: int = 0) -> Any:
    """The value as plain bool, int, float, str, list and dict; ``name`` is how mistakes call it."""
    if depth > _DEEPEST:
        raise ArgumentError(f"{name}: this is nested too deeply, or holds itself")
    if hasattr(value, "tolist"):  # numpy's scalars and arrays
        value = value.tolist()
    if isinstance(value, (bool, int, str)):
        return value
    if isinstance(value, float):
        if not math.isfinite(value):
            raise ArgumentError(f"{name}: {value} is no finite number")
        return value
    if isinstance(value, PurePath):
        return str(value)
    if isinstance(value, Mapping):
        for key in value:
            if not isinstance(key, str):
                raise ArgumentError(f"{name}: the key {key!r} is no string")
        return {key: plain(one, f"{name}.{key}", depth + 1) for key, one in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, (bytes, bytearray)):
        return [plain(one, f"{name}.{i}", depth + 1) for i, one in enumerate(value)]
    raise ArgumentError(f"{name}: {type(value).__name__} has no TOML; give a number, a string, a list or a dict")


def document(tables: Mapping[str, Any]) -> str:
    """A plain dictionary as a TOML document."""
    lines: list[str] = []
    _table(lines, [], tables)
    return "\n".join(lines).lstrip("\n") + "\n"


def _table(lines: list[str], path: list[str], table: Mapping[str, Any]) -> None:
    inner = {key: one for key, one in table.items() if _is_table(one) or _is_tables(one)}
    for key, one in table.items():
        if key not in inner:
            lines.append(f"{_key(key)} = {value(one)}")
    for key, one in inner.items():
        below = [*path, _key(key)]
        name = ".".join(below)
        if _is_table(one):
            # A table that holds nothing but tables needs no line of its own.
            if not one or not all(_is_table(each) or _is_tables(each) for each in one.values()):
                lines += ["", f"[{name}]"]
            _table(lines, below, one)
        else:
            for each in one:
                lines += ["", f"[[{name}]]"]
                _table(lines, below, each)


def _is_table(one: Any) -> bool:
    return isinstance(one, dict) and (not one or any(isinstance(each, (dict, list)) for each in one.values()) or len(one) > 4)


def _is_tables(one: Any) -> bool:
    return isinstance(one, list) and bool(one) and all(isinstance(each, dict) for each in one) and any(map(_is_table, one))


def value(one: Any) -> str:
    """A plain value in one line."""
    if isinstance(one, bool):
        return "true" if one else "false"
    if isinstance(one, (int, float)):
        return repr(one)
    if isinstance(one, str):
        return _text(one)
    if isinstance(one, list):
        return "[" + ", ".join(map(value, one)) + "]"
    inside = ", ".join(f"{_key(key)} = {value(each)}" for key, each in one.items())
    return f"{{ {inside} }}" if inside else "{}"


def _key(key: str) -> str:
    return key if _BARE.match(key) else _text(key)


def _text(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
