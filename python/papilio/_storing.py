"""Results as JSON and as files, in the same form for every kind of result."""

from __future__ import annotations

import json
import os
import secrets
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ._arguments import described
from .errors import ArgumentError

if TYPE_CHECKING:
    import xarray

    from .figure import Figure

__all__ = ["Stored", "optional", "put", "single", "variable", "written"]

#: Ends of names of files. A path with another one is a folder.
_ENDS = frozenset(
    ".bin .bmp .csv .eps .exr .gif .h .hdr .html .jpeg .jpg .json .jsonl .jxl .md .npy .npz .parquet .pdf .pfm .pgm .png .ppm .svg .tga .tif "
    ".tiff .toml .txt .webp .xlsx .xml .zip".split()
)

#: The extra of this package that installs each optional package.
_EXTRAS = {"xarray": "xarray", "pandas": "pandas", "distributed": "cluster", "pyarrow": "cluster"}


@contextmanager
def optional(package: str) -> Iterator[None]:
    """Context of the import of an optional package: if it is missing, the error says how to install it."""
    try:
        yield
    except ModuleNotFoundError as error:
        if error.name != package:
            raise
        hint = f"run 'pip install {package}', or install papilio with its extra [{_EXTRAS[package]}]"
        raise ImportError(f"{package} is not installed: {hint}", name=package) from None


def variable(name: str) -> str:
    """Returns the name of a quantity or key as the name of a variable of a Dataset: without blanks, which netCDF files do not keep."""
    return "_".join(name.split())


class Stored:
    """`to_json` and `save` of a result."""

    __slots__ = ()

    #: Files that names with these ends mean, whatever the rest of the name, if several files have the end.
    _BY_END: ClassVar[Mapping[str, str]] = {}

    def to_xarray(self) -> xarray.Dataset:
        raise NotImplementedError

    def figures(self) -> dict[str, Figure]:
        raise NotImplementedError

    def to_json(self) -> str:
        """Returns the contents of `to_xarray`, which needs xarray, as JSON; undefined numbers are null.

        ``xarray.Dataset.from_dict(json.loads(text))`` restores the Dataset.

        Raises:
            ImportError: if xarray is not installed.
        """
        return json.dumps(_plain(self.to_xarray().to_dict()), allow_nan=False)

    def _files(self) -> Mapping[str, bytes]:
        """Returns the files of the result except figures, by name."""
        raise NotImplementedError

    def _alone(self) -> Mapping[str, Callable[[], bytes]]:
        """Returns further files, which are written only where a path names them."""
        return {}

    def save(self, folder: str | PathLike[str]) -> list[Path]:
        """Writes the files and figures of the result into a folder, which is created.

        Args:
            folder: the folder; or a path that ends as one of the files, where this file alone is written.

        Returns:
            The paths of the files.

        Raises:
            ArgumentError: if the path ends as a file that the result does not have.
        """
        figures = {f"{figure.name}.svg": figure.svg.encode() for figure in self.figures().values()}
        return written(folder, {**self._files(), **figures}, self._alone(), self._BY_END)


def written(
    folder: str | PathLike[str],
    files: Mapping[str, bytes],
    alone: Mapping[str, Callable[[], bytes]] | None = None,
    by_end: Mapping[str, str] | None = None,
) -> list[Path]:
    """Writes files into a folder, or one of them or of those that stand alone to a path that ends as it; returns their paths."""
    where, further = Path(folder), alone or {}
    name = single(folder, [*files, *further], by_end)
    contents = {where / one: content for one, content in files.items()}
    if name is not None:
        contents = {where: files[name] if name in files else further[name]()}
    for path, content in contents.items():
        put(path, content)
    return list(contents)


def single(path: str | PathLike[str], names: Iterable[str], by_end: Mapping[str, str] | None = None) -> str | None:
    """Returns the file, by its name among ``names``, that alone is written to a path; None: the path is a folder.

    Raises:
        ArgumentError: if the path ends as a file, but as none or as several of these.
    """
    where, known = Path(path), list(dict.fromkeys(names))
    end = where.suffix.lower()
    if end not in {*_ENDS, *(Path(name).suffix for name in known)} or where.is_dir() or os.fspath(path).endswith(("/", os.sep)):
        return None
    with_end = [name for name in known if Path(name).suffix == end]
    if where.name in known:
        return where.name
    if end in (by_end or {}):
        return (by_end or {})[end]
    if len(with_end) == 1:
        return with_end[0]
    expected = f"a folder, or a path that ends as one of the files {', '.join(known)}"
    raise ArgumentError(f"path: expected {expected}, not {described(where.name)}")


def put(path: Path, content: bytes) -> None:
    """Writes a file completely, or not at all; the folder is created."""
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{secrets.token_hex(8)}.part")
    try:
        temporary.write_bytes(content)
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


def _plain(content: Any) -> Any:
    """Replaces what JSON does not have: undefined numbers by None, numbers of NumPy by those of Python."""
    if isinstance(content, Mapping):
        return {str(key): _plain(value) for key, value in content.items()}
    if isinstance(content, np.generic | np.ndarray):
        return _plain(content.tolist())
    if isinstance(content, float):
        return content if np.isfinite(content) else None
    if isinstance(content, Iterable) and not isinstance(content, str):
        return [_plain(value) for value in content]
    return content
