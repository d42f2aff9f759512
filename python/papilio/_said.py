"""What a user should know of a result: its warnings and notes, in every form that a result takes."""

from __future__ import annotations

import html
import warnings
from collections.abc import Iterable, Sequence

from .errors import PapilioWarning

__all__ = ["attributes", "both", "listed", "short", "warn"]


def warn(texts: Iterable[str], stacklevel: int = 2) -> None:
    """Raises each as a `PapilioWarning`; with 2 at the line that called the function that calls this."""
    for text in texts:
        warnings.warn(text, PapilioWarning, stacklevel=stacklevel + 1)


def both(*texts: Iterable[str]) -> list[str]:
    """All of them in order, each once."""
    return list(dict.fromkeys(text for some in texts for text in some))


def short(texts: Sequence[str]) -> str:
    """How many warnings there are, for the end of a ``repr``."""
    return "" if not texts else f"; {len(texts)} warning{'s' if len(texts) > 1 else ''}, see .warnings"


def listed(warned: Sequence[str], notes: Sequence[str]) -> str:
    """Warnings and notes as HTML; empty without any."""
    lines = [f"<li><b>warning:</b> {html.escape(text)}</li>" for text in warned]
    lines += [f"<li>note: {html.escape(text)}</li>" for text in notes]
    return f"<ul>{''.join(lines)}</ul>" if lines else ""


def attributes(warned: Sequence[str], notes: Sequence[str]) -> dict[str, str]:
    """Warnings and notes as attributes of a Dataset, a line for each: what every format of files can hold."""
    return {"warnings": "\n".join(warned), "notes": "\n".join(notes)}
