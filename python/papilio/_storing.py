"""Results as JSON and as files, in the same form for every kind of result."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .figure import Figure

if TYPE_CHECKING:
    import xarray

__all__ = ["Stored", "optional", "variable"]

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

    def save(self, folder: str | PathLike[str]) -> list[Path]:
        """Writes the files and figures of the result into a folder, which is created.

        Args:
            folder: the folder.

        Returns:
            The paths of the files.
        """
        figures = {f"{figure.name}.svg": figure.svg.encode() for figure in self.figures().values()}
        return written(folder, {**self._files(), **figures})


def written(folder: str | PathLike[str], files: Mapping[str, bytes]) -> list[Path]:
    """Writes files into a folder, which is created, and returns their paths."""
    where = Path(folder)
    where.mkdir(parents=True, exist_ok=True)
    for name, content in files.items():
        (where / name).write_bytes(content)
    return [where / name for name in files]


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
