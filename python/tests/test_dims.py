"""xarray arrays: dimensions are matched by name, or the arrays are refused."""

import numpy as np
import pytest

import papilio
from papilio import ArgumentError, cluster, colour, films

xarray = pytest.importorskip("xarray")

LAYER = "display.pixel.film.0.thickness_nm"
RED = "display.pixel.gap_nm.red"
METRICS = ["white.Y", "red.Y"]


@pytest.fixture(scope="module")
def prepared():
    from conftest import ROOT

    return papilio.Prepared(ROOT / "scenarios" / "indoor.toml")


@pytest.fixture
def arrays():
    d = xarray.DataArray([40.0, 50.0, 60.0], {"d": [1, 2, 3]}, ["d"])
    gap = xarray.DataArray([260.0, 270.0], dims="gap")
    return d, gap


def test_different_dimensions_broadcast_by_name(prepared, arrays):
    d, gap = arrays
    found = prepared.evaluate({LAYER: d, RED: gap}, METRICS)
    assert found.dims == ("d", "gap", "metric") and found.metric.values.tolist() == METRICS and found.d.values.tolist() == [1, 2, 3]
    assert np.array_equal(found.values, prepared.evaluate({LAYER: d.values[:, None], RED: gap.values}, METRICS))
    # The order of dimensions does not matter.
    both = xarray.DataArray(np.array([[40.0, 50.0, 60.0], [41.0, 51.0, 61.0]]), dims=["gap", "d"])
    other = prepared.evaluate({LAYER: both, RED: (d * 0 + 260.0)}, METRICS)
    assert other.dims == ("gap", "d", "metric")
    assert np.array_equal(other.values, prepared.evaluate({LAYER: both.values, RED: 260.0}, METRICS))


def test_shared_dimension_occurs_once(prepared, arrays):
    d, _ = arrays
    found = prepared.evaluate({LAYER: d, RED: 200.0 + d}, METRICS)
    assert found.dims == ("d", "metric")
    assert np.array_equal(found.values, prepared.evaluate({LAYER: d.values, RED: 200.0 + d.values}, METRICS))
    values, slopes = prepared.derivatives({LAYER: d, RED: 200.0 + d}, METRICS)
    assert values.dims == ("d", "metric") and slopes.dims == ("d", "metric", "variable")
    assert slopes["variable"].values.tolist() == [LAYER, RED]


def test_incompatible_dimensions_are_refused(prepared, arrays):
    d, gap = arrays
    with pytest.raises(ArgumentError, match="without names"):
        prepared.evaluate({LAYER: d, RED: np.array([260.0, 270.0, 280.0])}, METRICS)
    with pytest.raises(ArgumentError, match="a shared dimension differs"):
        prepared.evaluate({LAYER: d, RED: xarray.DataArray([1.0, 2.0, 3.0], {"d": [1, 2, 4]}, ["d"])}, METRICS)
    with pytest.raises(ArgumentError, match="rename it"):
        prepared.evaluate({LAYER: d.rename(d="metric")}, METRICS)
    with pytest.raises(ArgumentError, match="same dimension"):
        cluster.sweep(prepared.scenario, {LAYER: d, RED: d}, METRICS)


def test_batches_keep_dimensions(prepared, arrays):
    d, gap = arrays
    found = cluster.evaluate_many(prepared.scenario, {LAYER: d, RED: gap}, METRICS, batch_seconds=0.01)
    assert found.shape == (3, 2, 2)
    table = found.to_xarray()
    assert table.Y.sel(state="white").dims == ("d", "gap") and table[LAYER].dims == ("d",) and table.d.values.tolist() == [1, 2, 3]
    assert np.array_equal(found.values, prepared.evaluate({LAYER: d, RED: gap}, METRICS).values)
    swept = cluster.sweep(prepared.scenario, {LAYER: d, RED: gap}, METRICS, batch_seconds=0.01)
    assert np.array_equal(swept.values, found.values)


def test_broadcasting_by_position_against_dimensions_is_refused(arrays):
    d, gap = arrays
    nm = xarray.DataArray(np.arange(400.0, 701.0, 100.0), dims="nm")
    with pytest.raises(ArgumentError, match="broadcasts by position"):
        films.power([("SiO2", d), ("air", gap)], 550.0, substrate="Al")
    with pytest.raises(ArgumentError, match="broadcasts by position"):
        films.power([("SiO2", d)], np.array([500.0, 550.0, 600.0]), substrate="Al")
    together = films.power([("SiO2", d), ("air", 200 + d)], 550.0, substrate="Al")
    assert together.reflectance.shape == (3,)
    with pytest.raises(ArgumentError, match="broadcasts by position"):
        colour.xyz(xarray.DataArray(np.ones((4, 4)), dims=["nm", "d"]), nm, None)
    one, other = (xarray.DataArray(np.ones((3, 3)), dims=[name, "colour"]) for name in "ab")
    with pytest.raises(ArgumentError, match="broadcasts by position"):
        colour.delta_e_2000(one, other)
