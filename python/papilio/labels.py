"""Names of metrics and keys in words, with their units: for axes and tables of your own."""

from __future__ import annotations

from typing import NamedTuple

from . import _metadata, _papilio
from ._arguments import text

__all__ = ["Label", "label"]


class Label(NamedTuple):
    """The name of a quantity in words, and its unit; ``str`` gives both."""

    quantity: str
    """The quantity, such as ``Luminance of white``."""
    unit: str
    """Its unit; empty for numbers without one."""

    def __str__(self) -> str:
        return f"{self.quantity} ({self.unit})" if self.unit else self.quantity


def label(name: str) -> Label:
    """Returns the label of a metric, of another number of a result, or of a key of a scenario.

    Args:
        name: name of a metric (``"white.Y"``), column (``"wavelength_nm"``) or dotted path of a key (``"viewer.theta_deg"``).

    Returns:
        Quantity and unit, the same as in figures and tables. The words of a key are not checked against the scenario.

    Raises:
        KeyError: if there is no such metric, number or key.

    Example:
        >>> str(papilio.label("display.pixel.film.1.thickness_nm"))
        'Thickness of film layer 1 (nm)'
        >>> papilio.label("gamut_percent_srgb").unit
        '% of sRGB'
    """
    given = text("name", name, "the name of a metric or a key")
    short = _metadata.in_tables(given)
    found = Label(*_papilio.label(short))
    if found != (short, ""):
        return found
    words = _metadata.description(given)
    if words is None:
        raise KeyError(f"{name!r}: there is no such metric, number of a result or key of a scenario; papilio.metric_names() lists the metrics")
    return Label(words, "")
