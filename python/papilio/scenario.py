"""Scenarios as Python objects: reading, building, and editing that preserves the text."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from os import PathLike, fspath
from pathlib import Path
from typing import Any, Literal

from . import _arguments, _papilio
from ._arguments import described, one_of, whole
from ._mapping import ByName
from ._spectra import Grid, GridOf, stored
from ._storing import put
from ._toml import document, plain
from .errors import ArgumentError

__all__ = ["Scenario", "preset_names", "schema"]


def preset_names() -> list[str]:
    """Returns the names of the presets: rooms, daylight, and measurement geometries of standards.

    Returns:
        Names for `Scenario.new` and for the key ``lighting.preset``.

    Example:
        >>> "office" in papilio.preset_names()
        True
    """
    return _papilio.preset_names()


def schema(of: Literal["scenario", "result"] = "scenario") -> dict[str, Any]:
    """Returns the JSON Schema of scenarios or of results.

    Args:
        of: ``"scenario"``, or ``"result"`` for ``result.json``.

    Returns:
        The schema as dictionaries and lists.

    Example:
        >>> "display" in papilio.schema()["properties"]
        True
    """
    return dict(json.loads(_papilio.schema(one_of("of", of, ("scenario", "result")) == "result")))


class Scenario(ByName[Any]):
    """A display, its light, its viewer and the options of the computation, as a TOML text.

    Paths are those of ``--set``: dotted, with indices of arrays from 0. Reading returns values including all defaults; writing
    changes the text and preserves its comments and layout::

        scenario = papilio.Scenario.load("scenarios/indoor.toml")
        scenario["display.pixel.film.0.thickness_nm"]        # 55.9
        scenario["display.pixel.film.0.thickness_nm"] = 50
        scenario.update({"display.diffuser.haze": 0.6, "viewer.theta_deg": [0, 15, 30]})
        print(scenario.to_toml())

    Wherever a spectrum or a material may stand, a value may also be an array: a pair ``(wavelength_nm, values)``, a numpy array over the
    scenario's own wavelengths, an xarray DataArray or a pandas Series over wavelengths; complex values are n + 1j k. The text then names
    a file in memory (`files`), which `save` writes beside the scenario::

        scenario["lighting.spectrum"] = (nm, power)
        scenario["display.pixel.film.1.material"] = (nm, n + 1j * k)

    As a mapping, it has the keys of its tables: ``dict(scenario)`` is `to_dict`; ``in`` and ``get`` also accept paths. A change
    that makes the scenario invalid raises `ScenarioError` with its position in the text, and is not made. Errors that depend on
    files and other keys (a missing ``share``, a spectrum that does not cover the wavelengths) are detected by a run or by `check`.
    """

    __slots__ = ("_arrays", "_described", "_files", "_folder", "_name", "_resolved", "_text")

    #: Files that were made from arrays, by their names in the text.
    _arrays: dict[str, bytes]

    _described: _papilio.Described
    _resolved: _papilio.Resolved | None

    def __init__(
        self,
        text: str,
        *,
        name: str = "scenario",
        folder: str | PathLike[str] = ".",
        files: Mapping[str, bytes] | None = None,
    ) -> None:
        """Creates a scenario from its TOML text.

        Args:
            text: the TOML text.
            name: name of the scenario in errors.
            folder: folder of the files that the scenario names.
            files: these files in memory, names and bytes; then no file is read from the disk.

        Raises:
            ScenarioError: if the scenario is invalid; with the positions of all errors.
        """
        if isinstance(text, PathLike) or (isinstance(text, str) and text.endswith(".toml") and "\n" not in text):
            raise ArgumentError("text: expected a TOML text, not the path of a file; use papilio.Scenario.load to read a file")
        _arguments.text("text", text, "a TOML text")
        self._name = _arguments.text("name", name, "a name")
        self._folder = _checked_path("folder", folder)
        self._files = None if files is None else _checked_files(files)
        self._put(text, {})

    def _put(self, text: str, arrays: Mapping[str, bytes]) -> None:
        """Replaces the text, and keeps those of the arrays that it names."""
        named = {name: content for name, content in arrays.items() if name in text}
        self._described = _papilio.Described(text, self._name, *self._sources(named))
        self._text, self._arrays, self._resolved = text, named, None

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Scenario:
        """Reads a scenario file.

        Args:
            path: path of the TOML file.

        Returns:
            The scenario; files that it names are read relative to its own folder.

        Raises:
            ScenarioError: if the scenario is invalid; with the positions of all errors.
        """
        made = cls.__new__(cls)
        name = _checked_path("path", path)
        made._text, made._described = _papilio.Described.load(name)
        made._name, made._files, made._arrays, made._resolved = name, None, {}, None
        made._folder = name.rpartition("/")[0] or "."
        return made

    @classmethod
    def from_dict(
        cls,
        tables: Mapping[str, Any],
        *,
        name: str = "scenario",
        folder: str | PathLike[str] = ".",
        files: Mapping[str, bytes] | None = None,
    ) -> Scenario:
        """Creates a scenario from its tables as dictionaries.

        Args:
            tables: ``{"display": {...}, "lighting": {"preset": "indoor"}}``; spectra and materials may be arrays, as in the class.
            name: name of the scenario in errors.
            folder: folder of the files that the scenario names.
            files: these files in memory, names and bytes; then no file is read from the disk.

        Returns:
            The scenario; `to_toml` is its text.

        Example:
            >>> paper = {"model": "uniform", "kind": "lambertian", "reflectance": {"white": 0.45, "black": 0.03}}
            >>> scenario = papilio.Scenario.from_dict({"display": {"pixel": paper}, "lighting": {"preset": "office"}})
            >>> scenario["display.pixel.reflectance.white"]
            0.45
        """
        if not isinstance(tables, Mapping):
            raise ArgumentError(f"tables: expected a dict, not {described(tables)}")
        made = cls.__new__(cls)
        made._name, made._folder = _arguments.text("name", name, "a name"), _checked_path("folder", folder)
        made._files = None if files is None else _checked_files(files)
        made._change(lambda grid, arrays: document(plain(stored(tables, "", grid, arrays), "tables")), {})
        return made

    @classmethod
    def new(cls, preset: str) -> Scenario:
        """Creates a commented scenario of an example display in the light of a preset.

        Args:
            preset: one of `preset_names`.

        Returns:
            The scenario, as ``papilio new`` writes it.

        Example:
            >>> papilio.Scenario.new("office")["lighting.illuminance_lx"] > 100
            True
        """
        known = one_of("preset", preset, preset_names())
        return cls(_papilio.new_scenario(known), name=known)

    def _names(self) -> Iterable[str]:
        return self.to_dict()

    def _read(self) -> dict[str, Any]:
        return self.to_dict()

    def __getitem__(self, path: str) -> Any:
        """Returns the value at a path, including defaults.

        Raises:
            KeyError: if the path does not exist.
        """
        here: Any = self.to_dict()
        done: list[str] = []
        for key in _papilio.path_keys(_checked_key(path)):
            try:
                # Negative indices are refused, as in --set.
                here = here[int(key)] if isinstance(here, list) and key.isdecimal() else here[key]
            except (KeyError, IndexError, ValueError, TypeError):
                there = f"{'.'.join(done) or 'the scenario'} has "
                there += f"{len(here)} items, from 0" if isinstance(here, list) else ", ".join(here) if isinstance(here, dict) else "no keys"
                raise KeyError(f"{path}: {there}") from None
            done.append(key)
        return here

    def __setitem__(self, path: str, value: Any) -> None:
        """Sets one value; see `update` for several at once."""
        self.update({_checked_key(path): value})

    def __delitem__(self, path: str) -> None:
        """Removes a key or an item, so that its default applies."""
        self._put(_papilio.edit(self._text, json.dumps([{"op": "remove", "path": _checked_key(path)}])), self._arrays)

    def update(self, values: Mapping[str, Any]) -> None:
        """Sets several values at once.

        Args:
            values: ``{path: value}``; spectra and materials may be arrays, as in the class. Arrays without wavelengths are over
                those of the changed scenario.

        Raises:
            ScenarioError: if the result is invalid; then the scenario is not changed.
        """
        if not isinstance(values, Mapping):
            raise ArgumentError(f"values: expected a dict of paths and values, not {described(values)}")
        if not values:
            return

        def changed(grid: GridOf, arrays: dict[str, bytes]) -> str:
            edits = []
            for path, one in values.items():
                key = _checked_key(path)
                edits.append({"op": "set", "path": key, "value": plain(stored(one, key, grid, arrays), key)})
            return _papilio.edit(self._text, json.dumps(edits))

        self._change(changed, self._arrays)

    def with_values(self, values: Mapping[str, Any]) -> Scenario:
        """Returns a copy with several values set.

        Args:
            values: ``{path: value}``, as of `update`.

        Returns:
            The changed scenario; this one stays as it is.

        Example:
            >>> scenario = papilio.Scenario.load("scenarios/indoor.toml")
            >>> scenario.with_values({"display.diffuser.haze": 0.6})["display.diffuser.haze"]
            0.6
        """
        copy = self.copy()
        copy.update(values)
        return copy

    def insert(self, path: str, value: Any, index: int | None = None) -> None:
        """Inserts an item into an array.

        Args:
            path: path of the array: ``"display.pixel.film"``.
            value: the item, for example a dict.
            index: number of the item before which it is inserted, from 0; None: at the end.
        """
        at = None if index is None else whole("index", index, 0, 2**31)
        key = _checked_key(path)

        def changed(grid: GridOf, arrays: dict[str, bytes]) -> str:
            item = plain(stored(value, f"{key}.0", grid, arrays), key)
            return _papilio.edit(self._text, json.dumps([{"op": "insert", "path": key, "value": item, "index": at}]))

        self._change(changed, self._arrays)

    def _change(self, changed: Callable[[GridOf, dict[str, bytes]], str], arrays: Mapping[str, bytes]) -> None:
        """Replaces the text by that of ``changed``, which adds its arrays to those of its second argument.

        Arrays without wavelengths are over those of the changed text, which is read a first time for them.
        """

        @cache
        def grid() -> Grid:
            first = _papilio.Described(changed(None, {}), self._name, *self._sources({}))
            spectrum = json.loads(first.filled())["spectrum"]
            ends = spectrum["range_nm"]
            return float(ends[0]), float(ends[1]), float(spectrum["step_nm"])

        added = dict(arrays)
        text = changed(grid, added)
        self._put(text, added)

    @property
    def files(self) -> dict[str, bytes]:
        """The files in memory, by name: those of the constructor, and those that were made from arrays."""
        return {**(self._files or {}), **self._arrays}

    def copy(self) -> Scenario:
        """Returns a copy with the same text."""
        copy = type(self).__new__(type(self))
        for slot in Scenario.__slots__:
            setattr(copy, slot, getattr(self, slot))
        return copy

    __copy__ = copy

    def save(self, path: str | PathLike[str]) -> list[Path]:
        """Writes the scenario, and beside it the files that were made from arrays.

        Args:
            path: path of the TOML file. Relative paths of files in the text are adapted to its folder.

        Returns:
            The paths of the written files.
        """
        where = Path(path)
        text = _papilio.moved_text(self._text, self._folder, str(where.parent))
        for name in self._arrays:  # these move with the scenario
            text = text.replace(_papilio.moved_text(f'[lighting]\nspectrum = "{name}"\n', self._folder, str(where.parent)).split('"')[1], name)
        contents = {where: text.encode(), **{where.parent / name: content for name, content in self._arrays.items()}}
        for file, content in contents.items():
            put(file, content)
        return list(contents)

    def to_toml(self) -> str:
        """Returns the TOML text."""
        return self._text

    def to_dict(self) -> dict[str, Any]:
        """Returns all tables as dictionaries, including all defaults."""
        return dict(json.loads(self._described.filled()))

    def migrate(self) -> list[tuple[int, str, str]]:
        """Replaces old names of keys and values in the text by the current ones, and adds the format version.

        Comments, order and layout are preserved. Old names are accepted everywhere; this method updates files for long-term use.

        Returns:
            Each replaced name: its line in the old text, the old name and the new one.

        Raises:
            ScenarioError: if one table has both names of a key; then the scenario is not changed.
        """
        text, renamed = _papilio.migrate(self._text, self._name)
        self._put(text, self._arrays)
        return renamed

    def check(self) -> list[str]:
        """Checks the scenario with all files and data that it names, and returns its warnings.

        Raises:
            ScenarioError: if the scenario is invalid; with the positions of all errors.
        """
        return self._scene().warnings

    @property
    def name(self) -> str:
        """The name in errors: the path, if the scenario was loaded from a file."""
        return self._name

    @property
    def title(self) -> str:
        """The title, or the name if there is none."""
        return self._scene().title or self._name.rpartition("/")[2].removesuffix(".toml")

    @property
    def hash(self) -> str:
        """SHA-256 of the resolved scenario and its input files, which identifies a computation."""
        return self._scene().hash

    def _scene(self) -> _papilio.Resolved:
        """Returns the resolved scenario; files are read once for each text."""
        if self._resolved is None:
            self._resolved = self._described.resolve()
        return self._resolved

    def __repr__(self) -> str:
        return f"<papilio.Scenario {self._name!r}, {len(self._text.splitlines())} lines>"

    def _repr_html_(self) -> str:
        """The title, the number of lines, and the text to unfold, as HTML."""
        name, lines = html.escape(self._name), len(self._text.splitlines())
        title = html.escape(str(self.to_dict().get("title") or self._name))
        return f"<h4>{title}</h4><details><summary>{name}, {lines} lines</summary><pre>{html.escape(self._text)}</pre></details>"

    def __eq__(self, other: object) -> bool:
        """Returns whether two scenarios have the same text and the same files, whatever their names."""
        return isinstance(other, Scenario) and self._content() == other._content()

    def _content(self) -> tuple[Any, ...]:
        return self._text, os.path.abspath(self._folder) if self._files is None else None, self.files

    __hash__ = None  # type: ignore[assignment]

    def _sources(self, arrays: Mapping[str, bytes]) -> tuple[str | None, dict[str, bytes] | None]:
        """Returns the folder for files on the disk (None: nothing is read from it), and the files in memory."""
        if self._files is None:
            return self._folder, dict(arrays) or None
        return None, {**self._files, **arrays}

    def _state(self) -> tuple[str, str, str | None, dict[str, bytes] | None]:
        """Returns what the extension module needs to read the scenario."""
        return self._text, self._name, *self._sources(self._arrays)

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self._text, self._name, self._folder, self._files, self._arrays)


def _restored(text: str, name: str, folder: str, files: dict[str, bytes] | None, arrays: dict[str, bytes]) -> Scenario:
    made = Scenario.__new__(Scenario)
    made._name, made._folder, made._files = name, folder, files
    made._put(text, arrays)
    return made


def read(scenario: Scenario | str | PathLike[str], set: Mapping[str, Any] | None = None) -> Scenario:
    """Returns a scenario, or that of a file, with values set."""
    if not isinstance(scenario, Scenario):
        scenario = Scenario.load(_scenario_path(scenario))
    return scenario.with_values(set) if set else scenario


def _scenario_path(given: object) -> str:
    """Returns the path of a scenario file; the errors say how to get a scenario from other objects."""
    if isinstance(given, Mapping):
        raise ArgumentError("scenario: expected a path or a papilio.Scenario, not a dict: papilio.Scenario.from_dict creates a scenario from it")
    if isinstance(given, str) and "\n" in given:
        raise ArgumentError("scenario: expected a path or a papilio.Scenario, not a TOML text: papilio.Scenario(text) creates a scenario from it")
    if not isinstance(given, (str, PathLike)):
        raise ArgumentError(f"scenario: expected a path or a papilio.Scenario, not {described(given)}")
    return _checked_path("scenario", given)


def _checked_path(name: str, path: str | PathLike[str]) -> str:
    named: object = fspath(path) if isinstance(path, PathLike) else path
    checked = _arguments.text(name, named, "a path")
    if "\0" in checked:
        raise ArgumentError(f"{name}: expected a path without null characters, not {checked!r}")
    return checked


def _checked_key(path: str) -> str:
    return _arguments.text("path", path, "a dotted path such as display.diffuser.haze")


def _checked_files(files: Mapping[str, bytes]) -> dict[str, bytes]:
    if not isinstance(files, Mapping):
        raise ArgumentError(f"files: expected a dict of names and bytes, not {described(files)}")
    for name, content in files.items():
        _arguments.text("files", name, "names")
        if not isinstance(content, (bytes, bytearray)):
            raise ArgumentError(f"files: expected the bytes of {name}, not {described(content)}")
    return {name: bytes(content) for name, content in files.items()}
