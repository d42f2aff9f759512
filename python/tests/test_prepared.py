"""Many designs in one call: the results of single runs, with numpy's shapes."""

import pickle

import numpy as np
import pytest

import papilio
from papilio import ArgumentError, DesignError, Prepared, ScenarioError

LAYER = "display.pixel.film.0.thickness_nm"
RED = "display.pixel.gap_nm.red"
METRICS = ["gamut_percent_srgb", "white.Y", "contrast_ratio"]


@pytest.fixture(scope="module")
def prepared():
    from conftest import ROOT

    return Prepared(ROOT / "scenarios" / "indoor.toml")


def test_run_of_prepared_display_equals_run(prepared, scenarios):
    for thickness in [55.9, 40.0, 55.9]:
        kept = prepared.run({LAYER: thickness})
        assert kept.to_json() == papilio.run(scenarios / "indoor.toml", set={LAYER: thickness}).to_json()


def test_first_answer_is_within_its_error_of_the_exact_one(prepared):
    first, exact = (prepared.run({"display.diffuser.haze": 0.2}, accuracy=accuracy) for accuracy in ["first", "exact"])
    away = abs(first["white.Y"] - exact["white.Y"])
    assert (away <= first["white.discretisation_error.Y"] + exact["white.discretisation_error.Y"]).all()
    assert [one.data["solver"]["is_final"] for one in (first, exact)] == [False, True]
    with pytest.raises(ArgumentError, match="accuracy"):
        prepared.run(accuracy="coarse")


def test_designs_broadcast_and_equal_single_runs(prepared):
    """Colours take as many angles as an error of 1e-5 of Y needs; with a quantity of spectra, designs equal runs."""
    d, gap = np.array([45.0, 55.9]), np.array([[260.0], [275.9], [290.0]])
    values = prepared.evaluate({LAYER: d, RED: gap}, METRICS)
    assert values.shape == (3, 2, 3)
    exact = prepared.evaluate({LAYER: d, RED: gap}, [*METRICS, "white.R_hemi"])
    for i, j in np.ndindex(3, 2):
        single = prepared.run({LAYER: d[j], RED: gap[i, 0]}).metrics()
        np.testing.assert_allclose(values[i, j], [single[name] for name in METRICS], rtol=1e-5)
        np.testing.assert_allclose(exact[i, j, :3], [single[name] for name in METRICS], rtol=1e-9)


def test_result_does_not_depend_on_threads(prepared):
    d = np.linspace(40, 60, 37)
    one, three = (prepared.evaluate({LAYER: d}, METRICS, threads=n) for n in [1, 3])
    assert one.tobytes() == three.tobytes()


def test_derivatives_equal_central_differences(prepared):
    d, gap, step = np.array([45.0, 55.9]), np.array([[260.0], [290.0]]), 1e-3
    values, slopes = prepared.derivatives({LAYER: d, RED: gap}, METRICS)
    assert values.shape == (2, 2, 3) and slopes.shape == (2, 2, 3, 2)
    assert values.tobytes() == prepared.evaluate({LAYER: d, RED: gap}, METRICS).tobytes()
    by_layer = differences(lambda h: prepared.evaluate({LAYER: d + h, RED: gap}, METRICS), step)
    by_gap = differences(lambda h: prepared.evaluate({LAYER: d, RED: gap + h}, METRICS), step)
    np.testing.assert_allclose(slopes, np.stack([by_layer, by_gap], axis=-1), rtol=1e-6, atol=1e-9)


def differences(of, step):
    """Central differences of fourth order."""
    return (8 * (of(step) - of(-step)) - (of(2 * step) - of(-2 * step))) / (12 * step)


def test_progress_counts_designs(prepared):
    told = []
    prepared.evaluate({LAYER: np.linspace(40, 60, 200)}, METRICS, progress=told.append)
    assert all(set(one) == {"done", "of"} and one["of"] == 200 for one in told)


def test_common_keys_and_string_variables_are_evaluated(prepared):
    both = prepared.evaluate({(RED, "display.pixel.gap_nm.green"): [200.0]}, METRICS)
    apart = prepared.evaluate({RED: [200.0], "display.pixel.gap_nm.green": [200.0]}, METRICS)
    assert both.tobytes() == apart.tobytes()
    materials = prepared.evaluate({"display.pixel.film.2.material": ["SiO2", "MgF2", "SiO2"]}, METRICS)
    assert materials[0].tobytes() == materials[2].tobytes() != materials[1].tobytes()


def test_empty_single_and_constant_designs_are_evaluated(prepared):
    assert prepared.evaluate({LAYER: []}, METRICS).shape == (0, 3)
    assert prepared.evaluate({LAYER: 50.0}, METRICS).shape == (3,)
    np.testing.assert_allclose(prepared.evaluate({}, METRICS), prepared.evaluate({LAYER: 55.9}, METRICS), rtol=1e-12)


def test_prepared_display_can_be_pickled(prepared):
    again = pickle.loads(pickle.dumps(prepared))
    assert again.evaluate({LAYER: 50.0}, METRICS).tobytes() == prepared.evaluate({LAYER: 50.0}, METRICS).tobytes()


@pytest.mark.parametrize(
    ("variables", "names"),
    [
        ({LAYER: "thick"}, "film.0.thickness_nm"),
        ({LAYER: [50.0, np.nan]}, "variables"),
        ({LAYER: [50.0, np.inf]}, "variables"),
        ({LAYER: [[1, 2], [3]]}, "variables"),
        ({LAYER: None}, "variables"),
        ({LAYER: [True]}, "variables"),
        ({LAYER: [1 + 2j]}, "variables"),
        ({LAYER: np.zeros(2), RED: np.zeros(3)}, "variables"),
        ({LAYER: np.ma.array([50.0, 60.0], mask=[False, True])}, "variables"),
        ({(LAYER,): [50.0], LAYER: [60.0]}, "variables"),
        ({(LAYER, LAYER): [50.0]}, "variables"),
        ({5: [1.0]}, "variables"),
        ({(): [1.0]}, "variables"),
        ({"": [1.0]}, "variables"),
        ([LAYER], "variables"),
        ({LAYER: np.broadcast_to(np.float64(1), (1 << 20, 1)), RED: np.broadcast_to(np.float64(1), (1, 1 << 20))}, "variables"),
    ],
)
def test_invalid_variables_are_named(prepared, variables, names):
    with pytest.raises((ArgumentError, DesignError), match=names.replace(".", r"\.")):
        prepared.evaluate(variables, METRICS)


@pytest.mark.parametrize(
    ("variables", "said"),
    [
        ({LAYER: [[50.0, -1.0], [-2.0, 50.0]]}, r"design \(0, 1\): .*-1"),
        ({"display.pixel.film.2.material": ["Si02"]}, r"Si02"),
    ],
)
def test_invalid_design_is_named(prepared, variables, said):
    with pytest.raises(DesignError, match=f"(?s){said}"):
        prepared.evaluate(variables, METRICS)


@pytest.mark.parametrize(
    ("key", "said"),
    [
        ("display.pixel.film.9.thickness_nm", "the indices 0 to 4"),
        ("display.pixle.fill_factor", "pixle"),
        ("display..fill_factor", "empty"),
    ],
)
def test_unknown_key_raises_scenario_error(prepared, key, said):
    with pytest.raises(ScenarioError, match=said):
        prepared.evaluate({key: [5.0]}, METRICS)


@pytest.mark.parametrize(
    ("arguments", "names"),
    [
        ({"metrics": "white.Y"}, "metrics"),
        ({"metrics": []}, "metrics"),
        ({"metrics": [3]}, "metrics"),
        ({"metrics": ["gamut"]}, "metrics"),
        ({"metrics": ["Y"]}, "metrics"),
        ({"metrics": ["purple.Y"]}, "metrics"),
        ({"metrics": METRICS, "view": 1}, "view"),
        ({"metrics": METRICS, "view": -1}, "view"),
        ({"metrics": METRICS, "view": 0.5}, "view"),
        ({"metrics": METRICS, "threads": 0}, "threads"),
        ({"metrics": METRICS, "threads": "two"}, "threads"),
        ({"metrics": METRICS, "progress": 3}, "progress"),
    ],
)
def test_invalid_arguments_are_named(prepared, arguments, names):
    with pytest.raises(ArgumentError, match=f"^{names}"):
        prepared.evaluate({LAYER: [50.0]}, **arguments)
