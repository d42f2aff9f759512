"""Arrays as spectra, refractive indices and measurements in scenarios."""

import pickle
from types import SimpleNamespace

import numpy as np
import pytest

import papilio
from papilio import ArgumentError, Scenario, colour, films

NM = np.arange(380.0, 781.0, 5.0)


@pytest.fixture
def indoor(scenarios):
    return Scenario.load(scenarios / "indoor.toml")


def y_of(scenario, values):
    return papilio.run(scenario, set=values)["Y"]


def test_arrays_equal_named_data(indoor):
    """Light and film from arrays give the numbers of their names."""
    light, oxide = colour.illuminant("D65", NM), films.index("SiO2", NM)
    own = y_of(indoor, {})
    spectra = [light, (NM, light), (list(NM), list(light)), (NM[::-1], light[::-1]), SimpleNamespace(wavelengths=NM, values=light)]
    for one in spectra:
        np.testing.assert_allclose(y_of(indoor, {"lighting.spectrum": one}), own, rtol=1e-9)
    for one in (oxide, (NM, oxide)):
        np.testing.assert_allclose(y_of(indoor, {"display.pixel.film.2.material": one}), own, rtol=1e-9)


def test_labelled_arrays_are_spectra(indoor):
    xarray, pandas = pytest.importorskip("xarray"), pytest.importorskip("pandas")
    light = colour.illuminant("A", NM)
    expected = y_of(indoor, {"lighting.spectrum": "A"})
    for one in (xarray.DataArray(light, {"wavelength_nm": NM}), pandas.Series(light, NM)):
        np.testing.assert_allclose(y_of(indoor, {"lighting.spectrum": one}), expected, rtol=1e-9)


def test_scenario_with_arrays_is_saved_copied_and_compared(indoor, tmp_path):
    changed = indoor.with_values({"lighting.spectrum": colour.illuminant("A", NM)})
    name = changed["lighting.spectrum"]
    assert list(changed.files) == [name] and name.endswith(".csv") and changed != indoor
    copy = pickle.loads(pickle.dumps(changed))
    assert copy == changed and copy.hash == changed.hash
    written = changed.save(tmp_path / "folder" / "a.toml")
    assert [path.name for path in written] == ["a.toml", name]
    assert Scenario.load(written[0]).hash == changed.hash
    prepared = papilio.Prepared(changed)
    # With a quantity of spectra, designs equal runs; colours alone take fewer angles.
    found = prepared.evaluate({"display.pixel.film.0.thickness_nm": [50.0, 55.9]}, ["white.Y", "white.R_hemi"])
    assert found[1, 0] == pytest.approx(papilio.run(changed)["white.Y"][0], rel=1e-9)
    changed["lighting.spectrum"] = "D65"
    assert not changed.files and changed == indoor.with_values({"lighting.spectrum": "D65"})


def test_scenario_of_dictionaries_takes_arrays():
    white = np.linspace(0.3, 0.5, NM.size)
    pixel = {"model": "uniform", "kind": "lambertian", "reflectance": {"white": white, "black": 0.02}}
    scenario = Scenario.from_dict({"display": {"pixel": pixel}, "lighting": {"preset": "office"}})
    result = papilio.run(scenario)
    # Paper below glass of index 1.5: what returns into the air, and what total reflection sends back.
    inside = 1 / 1.5**2
    np.testing.assert_allclose(result["white.reflectance_factor"][0], white * inside / (1 - white * (1 - inside)), rtol=1e-6)


RED = np.exp(-(((np.arange(400.0, 721.0, 4.0) - 630) / 10) ** 2)) + 1e-6


@pytest.mark.parametrize(
    "values",
    [
        {"spectrum.range_nm": [400, 720], "spectrum.step_nm": 4, "lighting.spectrum": RED},
        {"lighting.spectrum": RED, "spectrum.step_nm": 4, "spectrum.range_nm": np.array([400.0, 720.0])},
        {"spectrum": {"range_nm": [400, 720], "step_nm": 4}, "lighting.spectrum": RED},
    ],
)
def test_arrays_are_over_the_wavelengths_that_the_same_call_sets(indoor, values):
    """A red LED at 630 nm stays there, although the old and the new wavelengths are as many; its spectrum may also be a pair."""
    pair = indoor.with_values({**values, "lighting.spectrum": (np.arange(400.0, 721.0, 4.0), RED)})
    together = indoor.with_values(values)
    assert together == pair and together.hash == pair.hash
    in_turn = indoor.copy()
    in_turn.update({key: value for key, value in values.items() if key != "lighting.spectrum"})
    in_turn["lighting.spectrum"] = RED
    assert in_turn.files == together.files
    expected = papilio.run(pair)["white.Y"]
    thickness = indoor["display.pixel.film.0.thickness_nm"]
    for found in (
        papilio.run(indoor, set=values)["white.Y"],
        papilio.Prepared(indoor).run(values)["white.Y"],
        papilio.Prepared(indoor, set=values).run()["white.Y"],
        papilio.sweep(indoor, {"display.pixel.film.0.thickness_nm": [thickness]}, ["white.Y", "white.R_hemi"], set=values)["white.Y"],
    ):
        np.testing.assert_allclose(found, expected, rtol=1e-9)


def test_nested_arrays_are_over_the_wavelengths_of_their_tables(indoor):
    pixel = {"model": "uniform", "kind": "lambertian", "reflectance": {"white": RED, "black": 0.0}}
    grid, light = {"range_nm": [400, 720], "step_nm": 4}, {"preset": "office"}
    own = Scenario.from_dict({"display": {"pixel": pixel}, "spectrum": grid, "lighting": light})
    changed = Scenario.from_dict({"display": {"pixel": {**pixel, "reflectance": {"white": 0.5, "black": 0.0}}}, "lighting": light})
    changed.update({"display.pixel.reflectance": {"white": RED, "black": 0.0}, "spectrum": grid})
    assert list(own.files.values()) == list(changed.files.values()) and own.hash == changed.hash
    rows = next(iter(own.files.values())).decode().splitlines()
    assert (rows[1].split(",")[0], rows[-1].split(",")[0], len(rows)) == ("400.0", "720.0", 82)


def test_errors_of_several_changes_are_those_of_the_changed_scenario(indoor):
    """Lengths are compared with the new wavelengths, and errors in other keys have their place."""
    with pytest.raises(ArgumentError, match=r"shape \(81,\), but the scenario has 41 wavelengths \(380 to 780 nm in steps of 10 nm\)"):
        indoor.with_values({"lighting.spectrum": np.ones(81), "spectrum.step_nm": 10})
    with pytest.raises(papilio.ScenarioError) as alone:
        indoor.with_values({"lighting.spectrum": "array-000000000000.csv", "display.diffuser.haze": 2})
    with pytest.raises(papilio.ScenarioError) as together:
        indoor.with_values({"lighting.spectrum": np.ones(81), "display.diffuser.haze": 2})
    assert str(together.value) == str(alone.value) and together.value.path == "display.diffuser.haze"


def test_lists_of_numbers_remain_lists(indoor):
    indoor["viewer.theta_deg"] = np.array([0.0, 10.0])
    assert indoor["viewer.theta_deg"] == [0.0, 10.0] and not indoor.files


@pytest.mark.parametrize(
    ("value", "says"),
    [
        (np.ones(80), r"lighting\.spectrum: an array of float64, shape \(80,\), but the scenario has 81 wavelengths"),
        ((NM, np.ones(3)), r"lighting\.spectrum: expected as many values as wavelengths"),
        ((NM, np.full(81, np.nan)), r"lighting\.spectrum: expected finite numbers"),
    ],
)
def test_wrong_arrays_are_named(indoor, value, says):
    with pytest.raises(ArgumentError, match=f"^{says}"):
        papilio.run(indoor, set={"lighting.spectrum": value})


def test_scenario_is_equal_by_any_path_and_shown_in_notebooks(scenarios, monkeypatch):
    monkeypatch.chdir(scenarios)
    here, there = Scenario.load("indoor.toml"), Scenario.load(scenarios / "indoor.toml")
    assert here == there and here.hash == there.hash and here != there.with_values({"viewer.theta_deg": 5})
    page = there._repr_html_()
    assert "<pre>" in page and "Si3N4" in page and "<script" not in page


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"display": {}}, "scenario: expected a path or a papilio.Scenario, not a dict: papilio.Scenario.from_dict"),
        ("[display]\nx = 1\n" * 100, "scenario: expected a path or a papilio.Scenario, not a TOML text: papilio.Scenario"),
    ],
)
def test_other_objects_than_scenarios_are_explained(given, says):
    with pytest.raises(ArgumentError, match=f"^{says}") as error:
        papilio.run(given)
    assert len(str(error.value)) < 200
