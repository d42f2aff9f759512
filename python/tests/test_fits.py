"""Fits: the numbers and files of ``papilio fit``, measured files and tables, mistakes."""

import csv
import json
import subprocess

import numpy as np
import pytest

import papilio

FEW = {"fit.starts": 1}


@pytest.fixture(scope="module")
def files():
    from conftest import ROOT

    return ROOT / "scenarios" / "fit.toml", ROOT / "scenarios" / "data" / "synthetic-film.csv"


@pytest.fixture(scope="module")
def found(files):
    return papilio.fit(*files, set=FEW)


def columns(path):
    with path.open() as lines:
        rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    number = ("theta_deg", "wavelength_nm", "reflectance_factor", "standard_deviation")
    return {name: [float(row[name]) if name in number else row[name] for row in rows] for name in rows[0]}


def test_files_are_those_of_program(found, files, program, tmp_path):
    scenario, measured = files
    out = tmp_path / "program"
    subprocess.run([program, "fit", scenario, measured, "--set", "fit.starts=1", "--out", out], check=True, capture_output=True)
    paths = found.save(tmp_path / "own")
    assert {path.name for path in paths} == {path.name for path in out.iterdir()}
    for path in paths:
        assert path.read_bytes() == (out / path.name).read_bytes(), path.name


def test_numbers_are_those_of_report(found):
    report = json.loads(found.to_json())
    assert list(found.variables) == [one["key"] for one in report["variables"]]
    for at, (key, one) in enumerate(found.variables.items()):
        told = report["variables"][at]
        assert (one.value, one.standard_error, list(one.interval_95), one.at_bound, list(one.cut_by)) == tuple(
            told[name] for name in ("value", "standard_error", "interval_95", "at_bound", "cut_by")
        )
        assert found["value"][at] == one.value and tuple(found["interval_68"][at]) == one.interval_68
        # The true values, of the header of the data, lie within three and a half standard errors.
        true = {"display.pixel.gap_nm.red": 271.5, "display.pixel.gap_nm.green": 194.5, "display.pixel.film.1.thickness_nm": 11.6}
        assert key not in true or abs(one.value - true[key]) < 3.5 * one.standard_error
    np.testing.assert_array_equal(found.correlations, np.array(report["correlations"], dtype=float))
    assert (found.chi_square, found.bic, found.undetermined) == (report["chi_square"], report["bic"], report["undetermined"])
    residuals = found.residuals
    np.testing.assert_allclose(residuals["fitted"] - residuals["measured"], residuals["residual"], rtol=0, atol=1e-15)
    # Chi-square is that of the numbers and of the priors.
    priors = sum(((one["best"] - one["prior"][0]) / one["prior"][1]) ** 2 for one in report["variables"] if "prior" in one)
    assert np.sum(residuals["z"] ** 2) + priors == pytest.approx(found.chi_square, rel=1e-9)


def test_fitted_scenario_predicts_the_measurement(found):
    scenario = found.scenario
    assert scenario.to_toml().startswith("# Fitted to measured data") and found.to_toml() == scenario.to_toml()
    result = papilio.run(scenario)
    white = found.residuals["name"] == "white"
    nm = np.arange(380, 781, 5)
    scale = found.variables["meter.scale"].value
    there = result["white.reflectance_factor"][0][np.searchsorted(nm, found.residuals["wavelength_nm"][white])]
    np.testing.assert_allclose(scale * there, found.residuals["fitted"][white], atol=2e-4)
    again = papilio.fit(scenario, _table(found), set=FEW)
    assert again.chi_square == pytest.approx(found.chi_square, rel=1e-3)


def _table(found):
    """The measured numbers of a fit as a table."""
    residuals = found.residuals
    return {
        "state": residuals["name"],
        "theta_deg": residuals["theta_deg"],
        "wavelength_nm": residuals["wavelength_nm"],
        "reflectance_factor": residuals["measured"],
        "standard_deviation": residuals["standard_deviation"],
    }


def test_measured_tables_equal_their_files(found, files):
    pandas = pytest.importorskip("pandas")
    scenario, measured = files
    table = columns(measured)
    for given in (table, pandas.DataFrame(table)):
        assert papilio.fit(scenario, given, set=FEW).to_json() == found.to_json()
    states = np.array(table["state"])
    halves = [{name: np.array(values)[states == state] for name, values in table.items()} for state in dict.fromkeys(table["state"])]
    parts = papilio.fit(scenario, *halves, set=FEW)
    np.testing.assert_allclose(parts["value"], found["value"], rtol=1e-9)


def test_what_data_cannot_tell_apart_is_nan(files):
    """A colour that is known to 20 % says nothing of two factors on it."""
    scenario = papilio.Scenario.load(files[0])
    two = [{"key": "display.pixel.fill_factor", "bounds": [0.7, 1.0]}, {"key": "meter.scale", "bounds": [0.8, 1.2]}]
    one = {"state": ["white"], "X": [0.25], "Y": [0.25], "Z": [0.25], "standard_deviation": [0.05]}
    found = papilio.fit(scenario, one, set={"fit.variables": two, **FEW})
    assert found.undetermined and np.isnan(found["value"]).all() and np.isfinite(found["best"]).all()
    assert "not determined" in found._repr_html_()


def test_mistakes_are_named(files):
    scenario, measured = files
    with pytest.raises(papilio.ArgumentError, match="at least one measured file"):
        papilio.fit(scenario)
    with pytest.raises(papilio.ArgumentError, match="is given twice"):
        papilio.fit(scenario, measured, str(measured))
    with pytest.raises(papilio.ArgumentError, match="not 5"):
        papilio.fit(scenario, 5)
    for column in (550, "white"):
        with pytest.raises(papilio.ArgumentError, match="measured: expected a list of values in the column 'wavelength_nm', not"):
            papilio.fit(scenario, {"wavelength_nm": column, "film": [0.5]})
    with pytest.raises(papilio.ArgumentError, match="columns of the same length, not 1, 2"):
        papilio.fit(scenario, {"state": ["white", "black"], "Y": [0.5]})
    with pytest.raises(papilio.FileError, match="absent.csv"):
        papilio.fit(scenario, "absent.csv")
    with pytest.raises(papilio.FileError) as caught:
        papilio.fit(scenario, {"state": ["white"], "X": ["a"], "Y": [0.2], "Z": [0.2]})
    assert (caught.value.file, caught.value.line) == ("measured table 1", 2)
    with pytest.raises(papilio.ArgumentError, match=r"(?s)measured: .*states are white, black"):
        papilio.fit(scenario, {"state": ["grey"], "X": [0.2], "Y": [0.2], "Z": [0.2]})
    with pytest.raises(papilio.ScenarioError, match=r"no `\[fit\]`"):
        papilio.fit(scenario.parent / "indoor.toml", measured)
