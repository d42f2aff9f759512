"""Warnings and notes of the program are available in every form of a result."""

import pickle
import subprocess
import warnings

import numpy as np
import pytest

import papilio
from papilio import PapilioWarning, Scenario, cluster

#: A thickness that looks like micrometres.
UNLIKELY = {"spectrum.step_nm": 20, "display.pixel.film.1.thickness_nm": 0.3}
SAYS = "display.pixel.film.1.thickness_nm is 0.3 nm, which looks like micrometres"

PRODUCTION = """
[tolerance]
samples = 64
sensitivity_samples = 0
metrics = ["white.Y"]
[[tolerance.keys]]
key = "display.pixel.film.0.thickness_nm"
normal = { sigma = 1 }
"""


@pytest.fixture
def unlikely(scenarios):
    return Scenario.load(scenarios / "indoor.toml").with_values(UNLIKELY)


def heard(call):
    """Returns the result of a call and its papilio warnings, each of which refers to the calling line."""
    with warnings.catch_warnings(record=True) as all_of_them:
        warnings.simplefilter("always")
        found = call()
    ours = [one for one in all_of_them if issubclass(one.category, PapilioWarning)]
    assert all(one.filename == __file__ for one in ours), [one.filename for one in ours]
    return found, [str(one.message) for one in ours]


def test_run_has_warnings_of_program(unlikely, program, scenarios, tmp_path):
    result, said = heard(lambda: papilio.run(unlikely))
    assert said == result.warnings and any(text.startswith(SAYS) for text in said)
    settings = [word for key, value in UNLIKELY.items() for word in ("--set", f"{key}={value!r}".replace("'", '"'))]
    printed = subprocess.run(
        [program, "run", scenarios / "indoor.toml", *settings, "--out", tmp_path], capture_output=True, text=True, check=True
    ).stderr
    assert all(f"warning: {text}" in printed for text in said)
    assert "1 warning" in repr(result) and SAYS in result._repr_html_()
    assert result.notes == result.data["notes"]
    pytest.importorskip("xarray")
    assert result.to_xarray().attrs["warnings"] == "\n".join(said)


def test_result_has_notes(scenarios):
    result = papilio.run(scenarios / "measured-diffused.toml", set={"spectrum.step_nm": 50})
    assert result.notes and result.notes == result.data["notes"]
    assert papilio.Prepared(scenarios / "measured-diffused.toml").notes


@pytest.mark.parametrize("kind", ["prepared", "cone", "reflection", "brdf", "evaluated", "sweep", "optimum", "yield"])
def test_every_result_type_has_warnings(kind, unlikely):
    key, metrics = "display.pixel.film.0.thickness_nm", ["white.Y"]
    angles = {"theta_deg": [0.0, 20.0], "phi_deg": [0.0, 90.0]}
    search = "[optimize]\nstarts = 1\nevaluations = 10\n[[optimize.variables]]\n"
    search += f'key = "{key}"\nbounds = [50, 60]\n[[optimize.objectives]]\nmetric = "white.Y"\naim = "maximise"\n'
    asked = {
        "prepared": lambda: papilio.Prepared(unlikely),
        "cone": lambda: papilio.cone(unlikely, **angles),
        "reflection": lambda: papilio.reflection(unlikely, theta_deg=[8]),
        "brdf": lambda: papilio.brdf(unlikely, theta_i_deg=[0], theta_o_deg=[0], dphi_deg=[0]),
        "evaluated": lambda: cluster.evaluate_many(unlikely, {key: [50.0]}, metrics, batch_seconds=0.01),
        "sweep": lambda: cluster.sweep(unlikely, {key: [50.0]}, metrics, batch_seconds=0.01),
        "optimum": lambda: papilio.optimize(with_text(unlikely, search)),
        "yield": lambda: papilio.tolerance(with_text(unlikely, PRODUCTION)),
    }
    found, said = heard(asked[kind])
    assert said == found.warnings and any(text.startswith(SAYS) for text in said)
    assert isinstance(found.notes, list) and "warning" in repr(found)
    assert kind == "prepared" or SAYS in found._repr_html_()
    if hasattr(found, "to_xarray"):
        pytest.importorskip("xarray")
        assert SAYS in found.to_xarray().attrs["warnings"]
    again, said = heard(lambda: pickle.loads(pickle.dumps(found)))
    assert again.warnings == found.warnings and not said


def with_text(scenario, text):
    return Scenario(scenario.to_toml() + text, name="more.toml", folder=scenario._folder)


def test_search_without_feasible_design_warns(scenarios):
    search = '[optimize]\nstarts = 1\nevaluations = 10\n[[optimize.variables]]\nkey = "display.pixel.film.0.thickness_nm"\n'
    search += 'bounds = [50, 60]\n[[optimize.objectives]]\nmetric = "white.Y"\naim = "maximise"\n'
    search += '[[optimize.constraints]]\nmetric = "white.Y"\nat_least = 0.99\n'
    found, said = heard(lambda: papilio.optimize(with_text(Scenario.load(scenarios / "indoor.toml"), search)))
    assert any("no feasible design was found" in text for text in said) and said == found.warnings


def test_run_without_problems_does_not_warn(scenarios):
    result, said = heard(lambda: papilio.run(scenarios / "indoor.toml"))
    assert said == result.warnings == [] and "warning" not in repr(result) and "warning" not in result._repr_html_()


def test_arrays_of_results_are_read_only(scenarios):
    result = papilio.run(scenarios / "indoor.toml", set={"spectrum.step_nm": 50})
    cone = papilio.cone(scenarios / "indoor.toml", theta_deg=[0.0], phi_deg=[0.0], set={"spectrum.step_nm": 50})
    table = papilio.brdf(scenarios / "indoor.toml", theta_i_deg=[0], theta_o_deg=[0], dphi_deg=[0], set={"spectrum.step_nm": 50})
    parts = papilio.reflection(scenarios / "indoor.toml", theta_deg=[8], set={"spectrum.step_nm": 50})
    many = cluster.evaluate_many(scenarios / "indoor.toml", {"viewer.theta_deg": [0.0]}, ["white.Y"], batch_seconds=0.01)
    production = papilio.tolerance(with_text(Scenario.load(scenarios / "indoor.toml"), PRODUCTION))
    arrays = [result["Y"], result["white.Y"], result.wavelength_nm, cone["Y"], cone.theta_deg, table.brdf, table.specular, parts["haze"]]
    arrays += [parts.theta_deg, many.values, many["white.Y"], production.values]
    for number, array in enumerate(arrays):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0
            pytest.fail(f"number {number} can be written to")
    # Unpickled arrays are read-only, too.
    for found, name in [(result, "Y"), (cone, "Y"), (parts, "haze"), (many, "white.Y")]:
        with pytest.raises(ValueError, match="read-only"):
            pickle.loads(pickle.dumps(found))[name][...] = 0
    pytest.importorskip("xarray")
    result.to_xarray()["Y"][:] = 0  # a Dataset is a copy
    assert np.all(result["Y"] > 0)
