"""Names of metrics and keys in words, with their units: for axes and tables of your own."""

from __future__ import annotations

from typing import NamedTuple

from . import _papilio
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
        Quantity and unit, the same as in figures and tables. A name that is unknown is returned as it is, without a unit.

    Example:
        >>> str(papilio.label("display.pixel.film.1.thickness_nm"))
        'Thickness of film layer 1 (nm)'
        >>> papilio.label("gamut_percent_srgb").unit
        '% of sRGB'
    """
    return Label(*_papilio.label(text("name", name, "the name of a metric or a key")))
