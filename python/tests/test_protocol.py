"""All results have the same methods and names."""

import copy
import json
import pickle
import subprocess
import sys
import warnings

import numpy as np
import pytest

import papilio
from papilio import ArgumentError

xarray = pytest.importorskip("xarray")
pandas = pytest.importorskip("pandas")

COARSE = {"spectrum.step_nm": 50}


@pytest.fixture(scope="module")
def results():
    from conftest import ROOT

    indoor = ROOT / "scenarios" / "indoor.toml"
    few = {"tolerance.samples": 64, "tolerance.sensitivity_samples": 4}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return {
            "Result": papilio.run(indoor, set=COARSE),
            "Cone": papilio.cone(indoor, theta_deg=[0, 20, 40], phi_deg=[0, 90, 180, 270], set=COARSE),
            "Reflection": papilio.reflection(indoor, set=COARSE),
            "Brdf": papilio.brdf(indoor, step_deg=30, set=COARSE),
            "Absorption": papilio.absorption(indoor, set=COARSE),
            "Evaluated": papilio.sweep(indoor, {"display.pixel.gap_nm.red": [265.0, 275.9]}, ["red.Y"]),
            "Yield": papilio.tolerance(ROOT / "scenarios" / "tolerance.toml", set=few),
            "Optimum": papilio.optimize(ROOT / "scenarios" / "optimize.toml", set={"optimize.evaluations": 20, "optimize.starts": 1}),
            "Mtf": papilio.mtf(ROOT / "scenarios" / "matrix.toml", set=COARSE),
            "Crosstalk": papilio.crosstalk(ROOT / "scenarios" / "matrix.toml", set={"solver.relative_error": 0.02} | COARSE),
            "Sparkle": papilio.sparkle(ROOT / "scenarios" / "antiglare.toml", set={"sparkle.replicates": 2, "sparkle.correlation_um": 60} | COARSE),
            "Fitted": papilio.fit(ROOT / "scenarios" / "fit.toml", ROOT / "scenarios" / "data" / "synthetic-film.csv", set={"fit.starts": 1}),
            "Palette": papilio.palette(ROOT / "scenarios" / "six-ink.toml", rooms=["D65"]),
            "Image": papilio.image(ROOT / "scenarios" / "six-ink.toml", np.full((16, 24, 3), 0.5)),
            "Surface": papilio.gonio(ROOT / "surfaces" / "hemispheres.toml", set={"microgeometry.rays": 640}),
            "Diffuser": papilio.diffuser.Diffuser(ROOT / "scenarios" / "data" / "H78.bsdf"),
        }


NAMES = ["Result", "Cone", "Reflection", "Brdf", "Absorption", "Evaluated", "Yield", "Optimum", "Mtf", "Crosstalk", "Sparkle", "Fitted", "Palette", "Image", "Surface", "Diffuser"]


@pytest.mark.parametrize("name", NAMES)
def test_result_follows_protocol(results, name):
    found = results[name]
    assert type(found).__name__ == name and isinstance(found, papilio.AnyResult)
    names = list(found)
    assert names and names == list(found.keys()) and len(names) == len(found)
    assert all(one in found and isinstance(found[one], np.ndarray) for one in names)
    assert "nothing" not in found and found.get("nothing") is None and 5 not in found
    with pytest.raises(KeyError, match="nothing"):
        found["nothing"]
    assert not found[names[-1]].flags.writeable
    assert all(isinstance(text, str) for text in (*found.warnings, *found.notes))
    figures = found.figures()
    assert all(isinstance(figure, papilio.Figure) and figure.svg.startswith("<svg") for figure in figures.values())
    assert figures or name == "Image"  # its pictures are arrays and PNG


@pytest.mark.parametrize("name", NAMES)
def test_tables_have_units_and_names(results, name):
    found = results[name]
    arrays, table = found.to_xarray(), found.to_pandas()
    for one, variable in arrays.variables.items():
        if one not in ("design", "display"):
            assert "long_name" in variable.attrs, one
    assert len(table) > 0
    quantities = [one for one in table.columns if one in arrays.data_vars]
    assert quantities or name == "Evaluated"
    assert {"warnings", "notes"} <= set(arrays.attrs)


@pytest.mark.parametrize("name", NAMES)
def test_result_is_copied_and_stored(results, name, tmp_path):
    """Pickles, JSON and files have the numbers of the result."""
    found = results[name]
    again = pickle.loads(pickle.dumps(found))
    for other in (again, copy.copy(found), copy.deepcopy(found)):
        assert list(other) == list(found) and repr(other) == repr(found)
        for one in found:
            np.testing.assert_array_equal(other[one], found[one])
    assert again.to_json() == found.to_json()
    content = json.loads(found.to_json())
    if "data_vars" in content:  # the others have the program's JSON
        xarray.testing.assert_allclose(defined(xarray.Dataset.from_dict(content)), defined(found.to_xarray()))
    paths = found.save(tmp_path / "new" / "folder")
    assert paths and all(path.is_file() and path.stat().st_size > 0 for path in paths)
    assert {path.name for path in paths} == {path.name for path in (tmp_path / "new" / "folder").iterdir()}
    assert {f"{figure.name}.svg" for figure in found.figures().values()} <= {path.name for path in paths}
    # The name of a file is this file alone, not a folder with all; names of other files are refused.
    for path in paths:
        (alone,) = found.save(tmp_path / "alone" / path.name)
        assert alone.read_bytes() == path.read_bytes()
    with pytest.raises(ArgumentError, match="path: expected a folder, or a path that ends as one of the files"):
        found.save(tmp_path / "none" / "found.tiff")
    assert not (tmp_path / "none").exists()


def defined(arrays):
    """The numbers of a Dataset, in double precision; undefined ones are NaN."""
    return xarray.Dataset({name: (one.dims, one.values.astype(float)) for name, one in arrays.data_vars.items() if one.dtype.kind not in "US"})


@pytest.mark.parametrize("name", NAMES)
def test_tables_survive_files(results, name, tmp_path):
    """What netCDF and Parquet files return is what was written, coordinates included."""
    pytest.importorskip("h5netcdf")
    arrays, table = results[name].to_xarray(), results[name].to_pandas()
    arrays.to_netcdf(tmp_path / "all.nc", engine="h5netcdf")
    with xarray.open_dataset(tmp_path / "all.nc", engine="h5netcdf") as read:
        assert set(read.coords) == set(arrays.coords) and set(read.data_vars) == set(arrays.data_vars)
        for one in arrays.data_vars:
            np.testing.assert_array_equal(read[one].values.astype(arrays[one].dtype), arrays[one].values)
    if name != "Brdf":  # large
        pandas.testing.assert_frame_equal(pandas.read_parquet(written(table, tmp_path / "all.parquet")), table)


def written(table, path):
    table.to_parquet(path)
    return path


def test_files_are_those_of_program(results, program, scenarios, tmp_path):
    """Files of maps and absorptances equal those of the program, byte for byte."""
    indoor = scenarios / "indoor.toml"
    coarse = ["--set", "spectrum.step_nm=50"]
    subprocess.run([program, "pixel", indoor, "--absorption", *coarse, "--out", tmp_path / "pixel"], check=True, capture_output=True)
    for name in ("absorption.csv", "sub-pixels.csv"):
        (path,) = (path for path in results["Absorption"].save(tmp_path / "own") if path.name == name)
        assert path.read_bytes() == (tmp_path / "pixel" / name).read_bytes()


def test_missing_package_is_named_with_its_installation(results, monkeypatch):
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(ImportError, match=r"xarray is not installed: run 'pip install xarray', or .* extra \[xarray\]"):
        results["Result"].to_xarray()


def test_deterministic_run_lists_no_standard_errors(results):
    names = list(results["Result"])
    assert "Y_discretisation_error" in names and not any(name.endswith("_standard_error") for name in names)
    assert "Y_standard_error" in results["Result"]  # known, but undefined
    assert not any(str(axis)[-2:] in ("_0", "_1", "_2") for name in NAMES for axis in results[name].to_xarray().sizes)


def test_number_has_one_name(results):
    """The names of keys, Datasets and tables agree; names of files are accepted."""
    result = results["Result"]
    arrays, table = result.to_xarray(), result.to_pandas()
    assert set(arrays.data_vars) - {"radiance_of_white"} <= set(result.keys())
    for name in ("Y_discretisation_error", "contrast", "u_prime"):
        np.testing.assert_array_equal(arrays[name].values.reshape(-1), table[name])
        np.testing.assert_array_equal(arrays[name].values, result[name])
    for other in ("discretisation_error.Y", "Y_de"):
        assert other in result and np.array_equal(result[other], result["Y_discretisation_error"])
    np.testing.assert_array_equal(result["white.Y_de"], result["white.discretisation_error.Y"])
    assert "Y_de" in result.to_pandas(short_errors=True)


def test_views_as_product_of_angles(scenarios):
    views = {"viewer.theta_deg": [0, 20, 40], "viewer.phi_deg": [0, 90], **COARSE}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = papilio.run(scenarios / "indoor.toml", set=views)
    flat, product = result.to_xarray(), result.to_xarray(directions=True)
    assert product.Y.dims == ("phi_deg", "theta_deg", "state")
    for at in range(6):
        one = flat.isel(view=at)
        np.testing.assert_array_equal(one.Y, product.Y.sel(theta_deg=one.theta_deg.item(), phi_deg=one.phi_deg.item()))


def test_sensitivities_and_fits_are_tables(results):
    table = results["Yield"].sensitivities()
    assert list(table.index.names) == ["metric", "group"] and len(table) > 1 and table["first"].notna().any()
    report = results["Yield"].report
    assert table["total"].iloc[0] == report["metrics"][0]["indices"][0]["total"]["value"]
    assert results["Yield"].keys == results["Yield"].varied  # the old meaning of the name
    fits = results["Diffuser"].fits("k-correlation (s = 3)")
    assert set(fits["name"]) == {"transmittance", "width"} and {"value", "unit"} <= set(fits.columns)
