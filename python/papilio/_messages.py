"""Warnings and notes of a result, in every form of the result."""

from __future__ import annotations

import html
import warnings
from collections.abc import Iterable, Sequence

from .errors import PapilioWarning

__all__ = ["as_html", "attributes", "merged", "summary", "warn"]


def warn(texts: Iterable[str], stacklevel: int = 2) -> None:
    """Raises each text as a `PapilioWarning`. With ``stacklevel`` 2, it refers to the caller of the function that calls `warn`."""
    for text in texts:
        warnings.warn(text, PapilioWarning, stacklevel=stacklevel + 1)


def merged(*texts: Iterable[str]) -> list[str]:
    """Returns all texts in order, without repetitions."""
    return list(dict.fromkeys(text for some in texts for text in some))


def summary(texts: Sequence[str]) -> str:
    """Returns the number of warnings, for the end of a ``repr``."""
    return "" if not texts else f"; {len(texts)} warning{'s' if len(texts) > 1 else ''}, see .warnings"


def as_html(warned: Sequence[str], notes: Sequence[str]) -> str:
    """Returns warnings and notes as HTML; an empty string if there are none."""
    lines = [f"<li><b>warning:</b> {html.escape(text)}</li>" for text in warned]
    lines += [f"<li>note: {html.escape(text)}</li>" for text in notes]
    return f"<ul>{''.join(lines)}</ul>" if lines else ""


def attributes(warned: Sequence[str], notes: Sequence[str]) -> dict[str, str]:
    """Returns warnings and notes as attributes of a Dataset, one line each. Every file format can store such strings."""
    return {"warnings": "\n".join(warned), "notes": "\n".join(notes)}
