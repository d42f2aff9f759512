"""Sweeps on this machine: labelled axes, several views, spectra."""

import numpy as np
import pytest

import papilio
from papilio import ArgumentError, DesignError

xarray = pytest.importorskip("xarray")
pandas = pytest.importorskip("pandas")

LAYER, GAP = "display.pixel.film.0.thickness_nm", "display.pixel.gap_nm.red"
VIEWS = {"viewer.theta_deg": [0, 30]}


@pytest.fixture(scope="module")
def prepared():
    from conftest import ROOT

    return papilio.Prepared(ROOT / "scenarios" / "indoor.toml", set=VIEWS)


def test_sweep_equals_evaluate_and_has_labels(prepared):
    axes = {LAYER: np.linspace(50, 60, 3), GAP: [265.0, 275.9]}
    found = prepared.sweep(axes, ["gamut_percent_srgb", "red.Y", "white.Y", "white.contrast"], names={GAP: "gap"})
    grid = {LAYER: np.linspace(50, 60, 3)[:, None], GAP: [265.0, 275.9]}
    assert np.array_equal(found.values, prepared.evaluate(grid, found.metrics))
    arrays = found.to_xarray()
    assert arrays.Y.dims == (LAYER, "gap", "state") and arrays.gamut_percent_srgb.dims == (LAYER, "gap")
    assert arrays.gap.attrs == {"units": "nm", "long_name": papilio.label(GAP).quantity, "key": GAP}
    assert float(arrays.Y.sel(state="red", gap=275.9)[1]) == found["red.Y"][1, 1] and np.isnan(arrays.contrast.sel(state="red")).all()
    short = found.to_xarray(names=["layer", "gap"], by_state=False)
    assert short.white_Y.dims == ("layer", "gap") and found["white_Y"][0, 0] == found["white.Y"][0, 0]
    table = found.to_pandas(names=["layer", "gap"])
    assert list(table.columns[:2]) == ["layer", "gap"] and len(table) == 6 and table["red.Y"][3] == found["red.Y"][1, 1]
    assert set(found.figures()) == set(found.metrics)
    # The variables are those of a run: the two can be joined.
    one = prepared.run({LAYER: 55.0, GAP: 275.9}).to_xarray().isel(view=0)
    np.testing.assert_allclose(arrays.Y.sel(gap=275.9).isel({LAYER: 1}), one.Y.sel(state=arrays.state), rtol=2e-3)


def test_views_and_spectra_equal_those_of_run(prepared):
    name = "red.reflectance_factor"
    found = prepared.sweep({GAP: [265.0, 275.9]}, [name], view="all", names=["gap"])
    result = prepared.run({GAP: 275.9})
    assert found.shape == (2, 2, 1, 81) and found[name].shape == (2, 2, 81)
    np.testing.assert_allclose(found[name][1], result["red.reflectance_factor"], rtol=1e-12)
    arrays = found.to_xarray()
    assert arrays.reflectance_factor.dims == ("gap", "view", "state", "wavelength_nm")
    assert arrays.theta_deg.values.tolist() == [0, 30] and arrays.wavelength_nm.values.tolist() == result.wavelength_nm.tolist()
    reverse = prepared.evaluate({GAP: [265.0, 275.9]}, [name], view=[1, 0])
    assert np.array_equal(reverse[:, ::-1], found.values)
    table = found.to_pandas()
    assert len(table) == 2 * 2 * 81 and table[name].iloc[-1] == found[name][1, 1, -1]


def test_derivatives_of_spectra_equal_differences(prepared):
    name, step = ["red.reflectance_factor"], 1e-3
    values, slopes = prepared.derivatives({GAP: [265.0]}, name, view="all")
    assert values.shape == (1, 2, 1, 81) and slopes.shape == (1, 2, 1, 81, 1)
    above, below = (prepared.evaluate({GAP: [265.0 + sign * step]}, name, view="all") for sign in (1, -1))
    np.testing.assert_allclose(slopes[..., 0], (above - below) / (2 * step), atol=1e-9)
    assert np.abs(slopes).max() > 1e-3


def test_table_as_variables(prepared):
    frame = pandas.DataFrame({LAYER: [50.0, 55.0], "display.pixel.film.2.material": ["SiO2", "MgF2"]})
    columns = {name: frame[name].tolist() for name in frame}
    assert np.array_equal(prepared.evaluate(frame, ["white.Y"]), prepared.evaluate(columns, ["white.Y"]))


def test_invalid_designs_are_skipped_on_request(prepared):
    found = prepared.sweep({LAYER: [50.0, -1.0]}, ["white.Y"], on_error="nan")
    assert np.isnan(found["white.Y"]).tolist() == [False, True]
    assert found.errors == [((1,), f"{LAYER}: -1 is out of range; expected a number from 0 to 1e6 (nm)")]
    with pytest.raises(DesignError, match="^design \\(1,\\): display") as error:
        prepared.sweep({LAYER: [50.0, -1.0]}, ["white.Y"])
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"names": ["a", "b"]}, "names: expected 1 names"),
        ({"names": {"x": "a"}}, "names: x is no variable"),
        ({"view": 2}, "view: expected 0 to 1, not 2"),
        ({"view": []}, "view: expected different"),
        ({"view": "first"}, "view: expected 'all'"),
        ({"metrics": ["white.Y", "white.reflectance_factor"]}, "metrics: white.reflectance_factor is a spectrum, white.Y a number"),
        ({"metrics": ["grey.reflectance_factor"]}, "metrics: there is no state"),
        ({"axes": {LAYER: [[1.0]]}}, "axes: expected the values"),
        ({"axes": {}}, "axes: expected at least one key"),
    ],
)
def test_invalid_arguments_are_named(prepared, arguments, says):
    given = {"axes": {LAYER: [50.0]}, "metrics": ["white.Y"], **arguments}
    with pytest.raises(ArgumentError, match=f"^{says}"):
        prepared.sweep(given.pop("axes"), given.pop("metrics"), **given)


def test_name_of_axis_differs_from_metrics(prepared):
    found = prepared.sweep({LAYER: [50.0]}, ["white.Y"], names=["Y"])
    with pytest.raises(ArgumentError, match="^names: 'Y' is the name of a metric"):
        found.to_xarray()


def test_progress_is_printed_on_request(prepared, capsys):
    prepared.sweep({LAYER: np.linspace(40, 70, 2000)}, ["white.Y"], progress=True)
    prepared.run(progress=True)
    said = capsys.readouterr().err
    assert "designs" in said or "views" in said
    assert said == "" or said.endswith("\n")
