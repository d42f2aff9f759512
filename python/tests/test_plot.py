"""Figures of arrays."""

import xml.etree.ElementTree

import numpy as np
import pytest

from papilio import ArgumentError, plot


def drawn(figure):
    return xml.etree.ElementTree.fromstring(figure.svg)


def test_curves_are_labelled():
    x = np.linspace(0, 1, 11)
    text = plot.curves(x, {"one": x, "other": np.where(x > 0.5, np.nan, x)}, kinds={"other": "points"}, title="Two").svg
    assert all(word in text for word in ["one", "other", "Two"])


def test_maps_have_axis_labels():
    figure = plot.map([1, 2, 3], ["SiO2", "MgF2"], [[1, 2, 3], [4, np.nan, 6]], name="gamut")
    drawn(figure)
    assert "MgF2" in figure.svg and "gamut" in figure.svg


def test_incompatible_shapes_are_refused():
    with pytest.raises(ArgumentError, match=r"^ys\['a'\]"):
        plot.curves([1, 2], {"a": [1, 2, 3]})
    with pytest.raises(ArgumentError, match="^values"):
        plot.map([1, 2], [1], [[1], [2]])
