"""Conversion of Python values to TOML."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping, Sequence
from pathlib import PurePath
from typing import Any

import numpy as np

from ._arguments import described, text, whole
from .errors import ArgumentError

_BARE = re.compile(r"[A-Za-z0-9_-]+\Z")

#: A scenario is at most 1 MiB of text.
_MOST_ITEMS = 1 << 20

#: The largest depth of nesting in a scenario.
_DEEPEST = 32


def plain(value: Any, name: str, depth: int = 0) -> Any:
    """Converts a value to plain bool, int, float, str, list and dict; errors call it ``name``."""
    if depth > _DEEPEST:
        raise ArgumentError(f"{name}: the value is nested too deeply, or contains itself; expected at most {_DEEPEST} levels")
    if isinstance(value, (np.ndarray, np.generic)):
        if value.size > _MOST_ITEMS:
            raise ArgumentError(f"{name}: expected at most {_MOST_ITEMS} items, not {value.size}")
        value = value.tolist()
    if isinstance(value, str):
        return text(name, value, "text")
    if isinstance(value, bool):
        return value
    if isinstance(value, int):
        return whole(name, value, -(2**63), 2**63 - 1)
    if isinstance(value, float):
        if not math.isfinite(value):
            raise ArgumentError(f"{name}: expected a finite number, not {value}")
        return value
    if isinstance(value, PurePath):
        return text(name, str(value), "a path")
    if isinstance(value, Mapping):
        for key in value:
            text(name, key, "strings as keys")
        return {key: plain(one, f"{name}.{key}", depth + 1) for key, one in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, (bytes, bytearray)):
        return [plain(one, f"{name}.{i}", depth + 1) for i, one in enumerate(value)]
    raise ArgumentError(f"{name}: expected a number, a string, a list or a dict, not {described(value)}")


def document(tables: Mapping[str, Any]) -> str:
    """Converts a plain dictionary to a TOML document."""
    lines: list[str] = []
    _table(lines, [], tables)
    return "\n".join(lines).lstrip("\n") + "\n"


def _table(lines: list[str], path: list[str], table: Mapping[str, Any]) -> None:
    inner = {key: one for key, one in table.items() if _is_table(one) or _is_tables(one)}
    for key, one in table.items():
        if key not in inner:
            lines.append(f"{_key(key)} = {inline(one)}")
    for key, one in inner.items():
        below = [*path, _key(key)]
        name = ".".join(below)
        if _is_table(one):
            # A table that contains only tables needs no header.
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


def inline(one: Any) -> str:
    """Converts a plain value to one line of TOML."""
    if isinstance(one, bool):
        return "true" if one else "false"
    if isinstance(one, (int, float)):
        return repr(one)
    if isinstance(one, str):
        return _quoted(one)
    if isinstance(one, list):
        return "[" + ", ".join(map(inline, one)) + "]"
    inside = ", ".join(f"{_key(key)} = {inline(each)}" for key, each in one.items())
    return f"{{ {inside} }}" if inside else "{}"


def _key(key: str) -> str:
    return key if _BARE.match(key) else _quoted(key)


def _quoted(words: str) -> str:
    return json.dumps(words, ensure_ascii=False).replace("\x7f", "\\u007f")
