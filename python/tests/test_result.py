"""Results as arrays, tables, datasets and figures: the same numbers everywhere."""

import csv
import io
import xml.etree.ElementTree

import numpy as np
import pytest

import papilio


@pytest.fixture(scope="module")
def result():
    from conftest import ROOT

    values = {"viewer.theta_deg": [0, 20, 40], "metrics.spectra_by_light": True}
    return papilio.run(ROOT / "scenarios" / "indoor.toml", set=values)


def test_arrays_equal_result_json(result):
    for v, view in enumerate(result.data["views"]):
        assert number(view["contrast_ratio"]) == result["contrast_ratio"][v]
        for s, state in enumerate(result.states):
            given = view["states"][state]
            for name in ["X", "L_star", "peak_nm", "luminance_cd_m2"]:
                assert same(result[name][v, s], number(given[name]))
                assert same(result[f"{state}.{name}"][v], number(given[name]))
                assert same(result[f"discretisation_error.{name}"][v, s], number(given["discretisation_error"][name]))
            assert result["reflectance_factor"][v, s].tolist() == given["reflectance_factor"]
            assert result["terms.directed"][v, s].tolist() == given["terms"]["directed"]
            assert result["ledger.absorbed.pixel"][v, s] == view["ledger"][state]["absorbed"]["pixel"]


def number(value):
    return np.nan if value is None else value


def same(one, other):
    return one == other or (np.isnan(one) and np.isnan(other))


def test_unknown_name_raises_key_error(result):
    for name in ["Q", "white.Q", "purple.Y", "", "white.", "standard_error", 5, None]:
        with pytest.raises(KeyError):
            result[name]
    for view in (3, -1, "a", None, 1.0):
        with pytest.raises(papilio.ArgumentError, match="^view:"):
            result.metrics(view)


def test_metrics_of_view_have_names(result):
    metrics = result.metrics(1)
    assert metrics["white.Y"] == result["white.Y"][1] and metrics["contrast_ratio"] == result["contrast_ratio"][1]


def test_dataset_has_units_and_long_names(result):
    xarray = pytest.importorskip("xarray")
    dataset = result.to_xarray()
    assert isinstance(dataset, xarray.Dataset)
    at = dataset.sel(state="white").isel(view=2)
    assert float(at.theta_deg) == 40 and float(at.Y) == result["white.Y"][2]
    assert dataset.reflectance_factor.dims == ("view", "state", "wavelength_nm")
    assert dataset.wavelength_nm.attrs["units"] == "nm" and dataset.theta_deg.attrs["units"] == "degree"
    assert dataset.luminance_cd_m2.attrs["units"] == "cd m-2"
    assert dataset.radiance.attrs == {"units": "W m-2 sr-1 nm-1", "long_name": "Spectral radiance"}
    assert dataset.Y_discretisation_error.attrs["long_name"].startswith("discretisation error: ")
    for name, variable in dataset.variables.items():
        assert "long_name" in variable.attrs, name
        assert "units" in variable.attrs or name == "state", name
        assert not any(dimension.endswith("_0") for dimension in variable.dims), (name, variable.dims)


def test_table_equals_states_csv(result):
    pytest.importorskip("pandas")
    table = result.to_pandas()
    rows = list(csv.DictReader(io.StringIO(result._core.states_csv().decode())))
    assert len(table) == len(rows) == 24
    assert table.loc[(20.0, 0.0, "red"), "Y"] == result["red.Y"][1]
    assert {"Y_standard_error", "Y_discretisation_error"} <= set(table.columns)


def test_columns_of_states_csv_are_arrays(result):
    """Every column of numbers has its name in ``[]``, with the numbers of the table; columns of one state, too."""
    table = result.to_pandas(short_errors=True)
    for name in table.columns:
        np.testing.assert_array_equal(np.broadcast_to(by_state(result[name]), (3, 8)).reshape(-1), table[name], err_msg=name)
    np.testing.assert_array_equal(result["R_dir_0"], result["R_dir"][..., 0])
    np.testing.assert_array_equal(result["Y_diffuse_discretisation_error"], result["discretisation_error.terms.diffuse"])
    np.testing.assert_array_equal(result["white.hue_r"], result["hue_rgb"][:, 0, 0])
    assert "Y_diffuse" in result and "Y_diffuse" not in list(result) and "R_dir_1" not in result


def by_state(values):
    """Numbers of a view for each of its states."""
    return values if values.ndim == 2 else values[:, np.newaxis]


def test_labels_have_words_and_units(result):
    """Labels are known for every name of a result, and unknown names are errors."""
    assert all(papilio.label(name).quantity != name for name in [*result.keys(), *papilio.metric_names()])
    assert papilio.label("terms_diffuse_standard_error") == papilio.label("Y_diffuse_se") != papilio.label("Y_diffuse")
    for name in ("nope", "gama_percent_srgb", ""):
        with pytest.raises(KeyError, match="no such metric"):
            papilio.label(name)


def test_figures_are_svg_with_notebook_display(result, tmp_path):
    figures = result.figures()
    assert "overview_theta0_phi0" in figures or "overview" in "".join(figures)
    for figure in figures.values():
        assert xml.etree.ElementTree.fromstring(figure._repr_svg_()).tag.endswith("svg")
    first = next(iter(figures.values()))
    first.save(tmp_path / "a.svg")
    assert (tmp_path / "a.svg").read_text() == first.svg
    try:
        first.save(tmp_path / "a.png")
    except papilio.ArgumentError as error:
        # The wheel of the fast tests has no PNG support.
        assert "was built without PNG pictures" in str(error)
    else:
        assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(papilio.ArgumentError, match="^path:"):
        first.save(tmp_path / "a.gif")
    page = result._repr_html_()
    assert "<table>" in page and "<svg" in page and "white" in page


def test_saved_files_equal_those_of_program(result, tmp_path):
    paths = result.save(tmp_path / "out")
    assert {path.name for path in paths} >= {"result.json", "states.csv", "spectra.csv"}
    assert (tmp_path / "out" / "result.json").read_text() == result.to_json()


def test_cone_equals_single_views(scenarios):
    values = {"solver.relative_error": 0.001}
    cone = papilio.cone(scenarios / "indoor.toml", theta_deg=[0, 20, 40], phi_deg=[0, 90, 180, 270], set=values)
    single = papilio.run(scenarios / "indoor.toml", set={**values, "viewer.theta_deg": 40, "viewer.phi_deg": 90})
    assert cone["Y"].shape == (4, 3, 8)
    np.testing.assert_allclose(cone["Y"][1, 2], single["Y"][0], rtol=2e-3)
    assert "<svg" in cone._repr_html_() and set(cone.figures()) == {"cone", "cone_differences"}
    pytest.importorskip("xarray")
    assert float(cone.to_xarray().contrast_ratio.sel(theta_deg=40, phi_deg=90)) == cone["contrast_ratio"][1, 2]
