"""Parts of large results: Parquet files that are named by the hash of their contents."""

from __future__ import annotations

import json
import os
import secrets
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._storing import optional
from .errors import ArgumentError, FileError
from .prepared import Skipped

if TYPE_CHECKING:
    import pyarrow

#: Metadata key for the skipped designs of a part.
_SKIPPED = "papilio.skipped"
_QUESTION = "_question.json"  # readers of a Parquet folder ignore names that begin with an underscore


def open_folder(out: Path, address: str, described: Mapping[str, Any], size: int) -> tuple[Path, int]:
    """Returns the folder of a request in ``out``, and the number of designs in each of its parts.

    ``size`` applies to a new folder. An existing folder keeps its own size, so that its parts are found again.
    """
    folder = out / address[:16]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        question = folder / _QUESTION
        if not question.exists():
            content = json.dumps({**described, "designs_per_part": size}, indent=2) + "\n"
            temporary = _written(folder, content.encode())
            try:
                os.link(temporary, question)  # if two programs start at once, the file of the first one is used
            except FileExistsError:
                pass
            finally:
                temporary.unlink()
        return folder, _size(question)
    except OSError as error:
        raise ArgumentError(f"out: {error}") from None


def known_size(out: Path, address: str) -> int | None:
    """Returns the number of designs in each part of a request, or None for a new request."""
    question = out / address[:16] / _QUESTION
    return _size(question) if question.exists() else None


def _size(question: Path) -> int:
    try:
        size = json.loads(question.read_bytes())["designs_per_part"]
        if isinstance(size, int) and size > 0:
            return size
    except (ValueError, KeyError, TypeError):
        pass
    raise FileError(f"{question}: expected a record of an evaluation with designs_per_part; move this file away")


def write(
    folder: Path,
    address: str,
    columns: Mapping[Any, NDArray[Any]],
    metrics: Sequence[str],
    values: NDArray[np.float64],
    described: Mapping[str, Any],
    skipped: Skipped,
) -> None:
    """Writes a part completely, or not at all."""
    with optional("pyarrow"):
        import pyarrow
    from pyarrow import parquet

    from ._batches import as_names

    named = {**as_names(columns), **{name: values[:, at] for at, name in enumerate(metrics)}}
    table = pyarrow.table(named).replace_schema_metadata(
        {"papilio": json.dumps(described), **({_SKIPPED: json.dumps(skipped)} if skipped else {})}
    )
    sink = pyarrow.BufferOutputStream()
    parquet.write_table(table, sink, compression="zstd")
    os.replace(_written(folder, sink.getvalue()), path(folder, address))


def _written(folder: Path, content: Any) -> Path:
    """Writes a temporary file with a unique name to the disk."""
    temporary = folder / f".{secrets.token_hex(8)}.part"
    with temporary.open("xb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    return temporary


def path(folder: Path, address: str) -> Path:
    """Returns the path of a part."""
    return folder / f"{address}.parquet"


def whole(folder: Path, address: str, rows: int) -> bool:
    """Returns whether a part exists and is complete."""
    from pyarrow import ArrowException, parquet

    try:
        return int(parquet.read_metadata(path(folder, address)).num_rows) == rows
    except (OSError, ArrowException):
        return False


def skipped(folder: Path, address: str) -> Skipped:
    """Reads the invalid designs of a part: their indices in it, and the reasons."""
    with optional("pyarrow"):
        import pyarrow
    from pyarrow import parquet

    where = path(folder, address)
    try:
        recorded = (parquet.read_schema(where).metadata or {}).get(_SKIPPED.encode(), b"[]")
        return [(int(at), str(why)) for at, why in json.loads(recorded)]
    except (OSError, pyarrow.ArrowException, ValueError, TypeError) as error:
        raise FileError(f"{where}: {error}") from None


def read(folder: Path, address: str, metrics: Sequence[str]) -> NDArray[np.float64]:
    """Reads the metrics of a part, shape [design, metric]."""
    with optional("pyarrow"):
        import pyarrow
    from pyarrow import parquet

    where = path(folder, address)
    try:
        table: pyarrow.Table = parquet.read_table(where, columns=list(metrics))
    except (OSError, pyarrow.ArrowException) as error:
        raise FileError(f"{where}: {error}") from None
    return np.stack([table[name].to_numpy() for name in metrics], axis=-1)
