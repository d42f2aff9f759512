"""The common protocol of results, and tables of arrays over labelled axes."""

from __future__ import annotations

from collections.abc import Iterator, KeysView, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from ._storing import optional
from .figure import Figure

if TYPE_CHECKING:
    import pandas
    import xarray

__all__ = ["AnyResult", "long_table"]


@runtime_checkable
class AnyResult(Protocol):
    """What every result has: `Result`, `Cone`, `Reflection`, `Brdf`, `Evaluated`, `Absorption`, `Optimum`, `Yield`, `Diffuser`,
    `Mtf`, `Crosstalk`, `Sparkle`, `Gloss`, `Fitted`, `Palette`, `Image`, `Surface`.

    Arrays by name (``found["Y"]``, ``in``, iteration, ``keys()``, ``get``), the same as tables and as JSON, figures, files, and what the
    program has to say. ``to_xarray`` and ``to_pandas`` need these packages, and ``to_json`` needs xarray where the program writes no JSON file
    (`Cone`, `Reflection`, `Brdf`, `Absorption`, `Evaluated`, `Optimum`). Results can be copied and pickled.
    """

    @property
    def warnings(self) -> list[str]:
        """Warnings; each was also raised as a `papilio.PapilioWarning`."""

    @property
    def notes(self) -> list[str]:
        """Notes on data that were measured, assumed or scaled."""

    def __getitem__(self, name: str, /) -> NDArray[Any]: ...
    def __contains__(self, name: object, /) -> bool: ...
    def __iter__(self) -> Iterator[str]: ...
    def keys(self) -> KeysView[str]: ...
    def to_xarray(self) -> xarray.Dataset: ...
    def to_pandas(self) -> pandas.DataFrame: ...
    def to_json(self) -> str: ...
    def figures(self) -> dict[str, Figure]: ...
    def save(self, folder: str | PathLike[str], /) -> list[Path]: ...


def long_table(labels: Mapping[str, Sequence[Any] | NDArray[Any]], arrays: Mapping[str, tuple[tuple[str, ...], NDArray[Any]]]) -> pandas.DataFrame:
    """Returns a table with a row for each combination of labels, and a column for each array; arrays over some of the axes are repeated."""
    with optional("pandas"):
        import pandas

    index: pandas.Index = pandas.MultiIndex.from_product([list(one) for one in labels.values()], names=list(labels))
    if len(labels) == 1:
        index = index.get_level_values(0)
    shape = [len(one) for one in labels.values()]
    columns = {}
    for name, (dims, values) in arrays.items():
        spread = values.reshape([length if axis in dims else 1 for axis, length in zip(labels, shape, strict=True)])
        columns[name] = np.broadcast_to(spread, shape).reshape(-1)
    return pandas.DataFrame(columns, index=index)
