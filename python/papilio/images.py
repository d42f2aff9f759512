"""Pictures on a display as the reader sees them: what ``papilio image`` writes."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _messages, _papilio
from ._arguments import described, one_of, reals
from ._storing import optional, written
from ._tables import long_table
from .errors import ArgumentError
from .running import Progress, checked_threads, reporting
from .scenario import Scenario, read
from .spatial import _Written

if TYPE_CHECKING:
    import pandas
    import xarray

__all__ = ["Frame", "Image", "image"]

#: Long name and channels of each picture.
_PICTURES: dict[str, tuple[str, tuple[str, ...]]] = {
    "seen": ("X, Y, Z that the reader sees, relative to a perfect white in the light", ("xyz",)),
    "srgb": ("picture for a screen", ("rgb",)),
    "wanted": ("X, Y, Z of the picture with the white and black of the display", ("xyz",)),
    "mapped": ("X, Y, Z of the picture in the gamut of the display", ("xyz",)),
    "states": ("number of the state of each pixel", ()),
}

#: Files of a frame.
_FRAMES = ("frame.bin", "frame.bmp", "frame.h")

_NO_STATES = "a picture without a halftone has no states"

Picture = str | PathLike[str] | ArrayLike


@dataclass(frozen=True)
class Frame:
    """What the controller of a panel takes: the files ``frame.bin``, ``frame.bmp`` and ``frame.h`` of ``papilio image``."""

    #: The bytes of the frame.
    data: bytes
    #: Code of each pixel, shape [row, column], in the rows and columns of the panel.
    codes: NDArray[np.uint8]
    #: Layout: ``size``, ``bits``, ``planes``, ``bytes_per_row``, the ``codes`` of the states, as ``frame`` in ``image.json``.
    numbers: dict[str, Any]
    #: The same bytes as a C header.
    header: str
    #: The codes as an indexed BMP, whose palette has the colours that are seen.
    bmp: bytes

    def save(self, path: str | PathLike[str]) -> list[Path]:
        """Writes the bytes, the BMP or the C header, by the end of the path: ``.bin``, ``.bmp`` or ``.h``; all three into a folder.

        Returns:
            The paths of the files.

        Raises:
            ArgumentError: for other ends.
        """
        return written(path, self._files())

    def _files(self) -> dict[str, bytes]:
        return {"frame.bin": self.data, "frame.bmp": self.bmp, "frame.h": self.header.encode()}


class Image(_Written):
    """A picture on a display as the reader sees it: the output of ``papilio image``.

    The pictures are arrays of the shape [row, column, 3], the first row at the top: ``found["seen"]`` (X, Y, Z relative to a perfect white in
    the light), ``found["srgb"]`` (the same for a screen, bytes; in Display P3 on request), ``found["wanted"]`` (the picture with the white and black of the display) and
    ``found["mapped"]`` (the same in the gamut of the display: what a halftone should show). ``found["states"]``, shape [row, column], has the
    number of the state of each pixel; without a halftone there is none. With ``image.samples_per_pixel``, "seen" and "srgb" have that many rows
    and columns for each pixel. Arrays are read-only. It can be copied and pickled.
    """

    _FILE = "image.json"
    _BY_END: ClassVar[Mapping[str, str]] = {".png": "seen.png"}

    def __init__(
        self,
        text: str,
        arrays: Mapping[str, NDArray[Any]],
        pictures: list[tuple[str, bytes]],
        title: str,
        warned: list[str],
        notes: list[str],
        codes: tuple[str | None, list[tuple[str, int]]] | None,
        colours: list[tuple[int, int, int]],
        light: tuple[list[list[float]], float],
    ) -> None:
        super().__init__(text, arrays, [], title, warned, notes, pictures)
        self._codes, self._colours = codes, colours
        #: The matrix that adapts X, Y and Z to D65, and the luminance of a perfect white, cd/m².
        self._light = light

    @property
    def states(self) -> list[str]:
        """Names of the states, in the order of their numbers."""
        return list(self.data["states"])

    @property
    def numbers(self) -> dict[str, Any]:
        """The contents of ``image.json``: coverages, differences, fractions out of gamut; None where a number is undefined."""
        return self.data

    def to_xarray(self) -> xarray.Dataset:
        """Returns the pictures as a Dataset over ``row``, ``column`` and their channels, and the ``coverage`` of each state.

        ``seen`` and ``srgb`` are over ``sample_row`` and ``sample_column`` if they have several samples for each pixel.

        Raises:
            ImportError: if xarray is not installed.
        """
        with optional("xarray"):
            import xarray

        columns, rows = self.data["size"]
        data: dict[str, Any] = {}
        for name, values in self._arrays.items():
            words, channel = _PICTURES[name]
            pixels = ("row", "column") if values.shape[:2] == (rows, columns) else ("sample_row", "sample_column")
            data[name] = ((*pixels, *channel), values.copy(), {"units": "1", "long_name": words})
        data["coverage"] = ("state", self._coverage(), {"units": "1", "long_name": "fraction of the pixels in the state"})
        coordinates: dict[str, Any] = {
            "state": ("state", self.states, {"long_name": "drive state"}),
            "xyz": ("xyz", ["X", "Y", "Z"], {"long_name": "tristimulus value"}),
            "rgb": ("rgb", ["red", "green", "blue"], {"long_name": "channel of the screen"}),
        }
        return xarray.Dataset(data, coordinates, {"title": self.title} | _messages.attributes(self.warnings, self.notes))

    def to_pandas(self) -> pandas.DataFrame:
        """Returns a table with a row for each state: its coverage; NaN without a halftone.

        Raises:
            ImportError: if pandas is not installed.
        """
        return long_table({"state": self.states}, {"coverage": (("state",), self._coverage())})

    def _coverage(self) -> NDArray[np.float64]:
        coverage = self.data.get("coverage") or {}
        return np.array([coverage.get(state, np.nan) for state in self.states], float)

    def png(self) -> bytes:
        """Returns the content of ``seen.png``."""
        return self._tables["seen.png"]

    def exr(self) -> bytes:
        """Returns the content of ``seen.exr``: what is seen in linear light, a perfect white 1."""
        return bytes(_papilio.scene_exr(self["seen"], *self._light))

    def _files(self) -> dict[str, bytes]:
        return {**super()._files(), "seen.exr": self.exr()}

    def _alone(self) -> dict[str, Callable[[], bytes]]:
        def states() -> bytes:
            raise ArgumentError(_NO_STATES)

        def other(name: str, option: str) -> Callable[[], bytes]:
            def refuse() -> bytes:
                raise ArgumentError(f"path: {name} is written by `papilio image` with {option}; this picture is seen.png")

            return refuse

        frames: dict[str, Callable[[], bytes]] = {name: lambda name=name: self.frame()._files()[name] for name in _FRAMES}  # type: ignore[misc]
        own = {} if "states.png" in self._tables else {"states.png": states}
        return {**frames, **own, "rooms.png": other("rooms.png", "--rooms"), "changed.png": other("changed.png", "--since")}

    def save(self, path: str | PathLike[str]) -> list[Path]:
        """Writes the files of ``papilio image`` into a folder, which is created, or one of them.

        Args:
            path: a folder; or a path that ends with ``.png`` (what is seen; the states, if the name is ``states.png``), ``.exr`` (what is
                seen in linear light), ``.json`` (`numbers`), or ``.bin``, ``.bmp`` or ``.h`` (the `frame` for the panel), where this
                file alone is written.

        Returns:
            The paths of the files.

        Raises:
            ArgumentError: for other ends of files, and for states and frames of a picture without a halftone.
        """
        return super().save(path)

    def frame(self, packed: int | Literal["planes"] | None = None, *, rotate: int = 0, mirror: bool = False) -> Frame:
        """Packs the states for the controller of the panel, with the codes of ``display.pixel.codes``, or else the numbers of the states.

        Args:
            packed: bits for each pixel, 1, 2, 4 or 8, or ``"planes"`` of 1 bit; None: as the controller takes them, or the fewest.
            rotate: clockwise rotation of the frame, 0, 90, 180 or 270 degrees.
            mirror: whether the rotated frame is mirrored left to right.

        Returns:
            The bytes, the codes as an array, the layout, a C header and a BMP.

        Raises:
            ArgumentError: for other numbers, too few bits, and a picture without a halftone.

        Example:
            >>> found = papilio.image("scenarios/six-ink.toml", np.full((4, 6, 3), 0.5))
            >>> frame = found.frame(4)
            >>> len(frame.data), frame.numbers["bytes_per_row"], frame.numbers["codes"]["green"]
            (12, 3, 6)
        """
        if "states" not in self._arrays:
            raise ArgumentError(f"{_NO_STATES}, and a frame consists of states")
        if rotate not in (0, 90, 180, 270):
            raise ArgumentError(f"rotate: expected 0, 90, 180 or 270 degrees, not {described(rotate)}")
        if packed not in (None, 1, 2, 4, 8, "planes"):
            raise ArgumentError(f"packed: expected 1, 2, 4, 8 or 'planes', not {described(packed)}")
        controller, codes = self._codes or (None, [(state, number) for number, state in enumerate(self.states)])
        if len(codes) > 256:
            raise ArgumentError(f"a frame has codes from 0 to 255, and this display has {len(codes)} states: image.states lists those to use")
        bits = 0 if packed == "planes" else packed
        data, shown, text, header, bmp = _papilio.frame(
            self["states"], codes, self._colours, controller, bits, rotate // 90, mirror, self.title
        )
        return Frame(bytes(data), shown, json.loads(text), header, bytes(bmp))

    def _repr_png_(self) -> bytes:
        return self.png()

    def _repr_html_(self) -> None:  # type: ignore[override]
        return None

    def __repr__(self) -> str:
        columns, rows = self.data["size"]
        return f"<papilio.Image {self.title!r}: {columns} x {rows} pixels{_messages.summary(self.warnings)}>"


def image(
    scenario: Scenario | str | PathLike[str],
    picture: Picture | None = None,
    *,
    states: ArrayLike | None = None,
    encoding: Literal["srgb", "linear"] = "srgb",
    relative_to: Literal["white", "display"] = "white",
    space: Literal["srgb", "display-p3"] = "srgb",
    set: Mapping[str, Any] | None = None,
    threads: int | None = None,
    progress: Progress | bool | None = None,
) -> Image:
    """Shows a picture on a display: the output of ``papilio image``.

    Args:
        scenario: a `Scenario`, or the path of a scenario file, with one view.
        picture: path of a PNG, JPEG, OpenEXR or Radiance file, or red, green and blue of sRGB as an array of the shape [row, column, 3] (or [row, column] of
            grey): integers of 8 or 16 bits without sign, or numbers from 0 to 1; None: the picture, text or pattern of the scenario.
        states: number of the state of each pixel, shape [row, column], instead of a halftone; the numbers are those of ``Image.states``.
        encoding: ``"srgb"``, or ``"linear"`` if the numbers of an array are proportional to light.
        relative_to: what is 255, 255, 255 in ``srgb``: a perfect white in the light, or the white of the ``"display"``.
        space: colour space of the screen, of the array ``srgb`` and of ``png()``.
        set: values to set in the scenario first, ``{key: value}`` with keys such as "image.halftone".
        threads: number of threads; None: one for each processor.
        progress: function that is called a few times a second, or True for a line on the terminal.

    Returns:
        The pictures, by name, and numbers.

    Raises:
        ScenarioError: for mistakes in the scenario, a picture that cannot be read, and more than one view, with their places.
        ArgumentError: for arrays of other shapes or numbers.
        DisplayError: for states that the display does not have.
        KeyboardInterrupt: on Ctrl-C.

    Warns:
        PapilioWarning: each warning that the program prints; ``warnings`` of the result contains it.

    Example:
        >>> grey = np.full((32, 48, 3), 0.5)
        >>> found = papilio.image("scenarios/six-ink.toml", grey)
        >>> found["seen"].shape, found.states[:2], bool(found["states"].max() < 6)
        ((32, 48, 3), ['black', 'white'], True)
        >>> own = np.where(found["mapped"][..., 1] > 0.2, 1, 0)          # a halftone of one's own
        >>> papilio.image("scenarios/six-ink.toml", grey, states=own).numbers["coverage"]["red"]
        0.0
    """
    one_of("encoding", encoding, ("srgb", "linear"))
    one_of("relative_to", relative_to, ("white", "display"))
    one_of("space", space, ("srgb", "display-p3"))
    values, pixels = dict(set or {}), None
    if isinstance(picture, (str, PathLike)):
        values["image.file"] = os.path.abspath(os.fspath(picture))
    elif picture is not None:
        pixels = _pixels(picture)
    changed = read(scenario, values)
    shown = None if states is None else _states(states)
    with reporting(progress, "views") as tell:
        core = _papilio.Image(
            changed._described,
            changed.name,
            pixels,
            encoding == "srgb",
            shown,
            relative_to == "display",
            space == "display-p3",
            checked_threads(threads),
            tell,
        )
    found = Image(
        core.json(), core.arrays(), core.pictures(), core.title, core.warnings(), core.notes(), core.codes(), core.colours(), core.light()
    )
    _messages.warn(found.warnings)
    return found


def _pixels(picture: ArrayLike) -> NDArray[np.float64]:
    """Returns red, green and blue from 0 to 1."""
    array = np.asarray(picture)
    if array.ndim == 2:
        array = np.repeat(array[..., np.newaxis], 3, axis=2)
    if array.ndim != 3 or array.shape[2] != 3 or array.size == 0:
        raise ArgumentError(f"picture: expected a path, or an array of the shape (rows, columns, 3), not {described(picture)}")
    if array.dtype.kind == "u":
        if array.dtype.itemsize > 2:
            raise ArgumentError(f"picture: expected integers of 8 or 16 bits or numbers from 0 to 1, not {described(picture)}")
        return np.ascontiguousarray(array / float(np.iinfo(array.dtype).max))
    if array.dtype.kind != "f":
        raise ArgumentError(f"picture: expected uint8, uint16 or numbers from 0 to 1, not {described(picture)}")
    return np.ascontiguousarray(reals("picture", array, least=0.0, most=1.0))


def _states(states: ArrayLike) -> NDArray[np.uint8]:
    """Returns numbers of states."""
    array = np.asarray(states)
    if array.ndim != 2 or array.dtype.kind not in "iu" or array.size == 0:
        raise ArgumentError(f"states: expected whole numbers of the shape (rows, columns), not {described(states)}")
    if array.min() < 0 or array.max() > 255:
        raise ArgumentError(f"states: {array.min()} to {array.max()} is out of range; expected numbers of states, from 0")
    return np.ascontiguousarray(array.astype(np.uint8))
