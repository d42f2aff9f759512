"""Parts of large answers: Parquet files named by what they hold."""

from __future__ import annotations

import json
import os
import secrets
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .errors import ArgumentError, FileError
from .prepared import Skipped

if TYPE_CHECKING:
    import pyarrow

#: Where a part says which of its designs cannot be.
_SKIPPED = "papilio.skipped"
_QUESTION = "_question.json"  # readers of a folder of Parquet pass over such names


def open_folder(out: Path, address: str, described: Mapping[str, Any], size: int) -> tuple[Path, int]:
    """The folder of a question in ``out``, and how many designs each of its parts holds.

    ``size`` is for a new one; one that is there keeps its own, so that its parts are found again.
    """
    folder = out / address[:16]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        question = folder / _QUESTION
        if not question.exists():
            content = json.dumps({**described, "designs_per_part": size}, indent=2) + "\n"
            temporary = _written(folder, content.encode())
            try:
                os.link(temporary, question)  # of two programs that begin at once, the first one's holds
            except FileExistsError:
                pass
            finally:
                temporary.unlink()
        return folder, _size(question)
    except OSError as error:
        raise ArgumentError(f"out: {error}") from None


def known_size(out: Path, address: str) -> int | None:
    """How many designs each part of a question holds, if it was asked before."""
    question = out / address[:16] / _QUESTION
    return _size(question) if question.exists() else None


def _size(question: Path) -> int:
    try:
        size = json.loads(question.read_bytes())["designs_per_part"]
        if isinstance(size, int) and size > 0:
            return size
    except (ValueError, KeyError, TypeError):
        pass
    raise FileError(f"{question}: this is no record of an evaluation; move it away")


def write(
    folder: Path,
    address: str,
    columns: Mapping[Any, NDArray[Any]],
    metrics: Sequence[str],
    values: NDArray[np.float64],
    described: Mapping[str, Any],
    skipped: Skipped,
) -> None:
    """Writes a part: whole, or not at all."""
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
    """A file of a name of its own, on the disk."""
    temporary = folder / f".{secrets.token_hex(8)}.part"
    with temporary.open("xb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    return temporary


def path(folder: Path, address: str) -> Path:
    """Where a part lies."""
    return folder / f"{address}.parquet"


def whole(folder: Path, address: str, rows: int) -> bool:
    """Whether a part is there, to its end."""
    from pyarrow import ArrowException, parquet

    try:
        return int(parquet.read_metadata(path(folder, address)).num_rows) == rows
    except (OSError, ArrowException):
        return False


def skipped(folder: Path, address: str) -> Skipped:
    """The designs of a part that cannot be: their number in it, and why."""
    import pyarrow
    from pyarrow import parquet

    where = path(folder, address)
    try:
        said = (parquet.read_schema(where).metadata or {}).get(_SKIPPED.encode(), b"[]")
        return [(int(at), str(why)) for at, why in json.loads(said)]
    except (OSError, pyarrow.ArrowException, ValueError, TypeError) as error:
        raise FileError(f"{where}: {error}") from None


def read(folder: Path, address: str, metrics: Sequence[str]) -> NDArray[np.float64]:
    """The metrics of a part, shape [design, metric]."""
    import pyarrow
    from pyarrow import parquet

    where = path(folder, address)
    try:
        table: pyarrow.Table = parquet.read_table(where, columns=list(metrics))
    except (OSError, pyarrow.ArrowException) as error:
        raise FileError(f"{where}: {error}") from None
    return np.stack([table[name].to_numpy() for name in metrics], axis=-1)
