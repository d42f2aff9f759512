"""Liquid-crystal pixels: the same numbers as the command line, by state, voltage and direction, from files and dictionaries."""

import json
import subprocess

import numpy as np
import papilio
import pytest

pytestmark = pytest.mark.filterwarnings("ignore:colours are computed")

#: A vertically aligned cell, driven by a voltage, below a circular polariser.
CELL = {
    "kind": "cell",
    "gap_um": 2.2,
    "n_o": 1.474,
    "n_e": 1.557,
    "rub_deg": 45,
    "pretilt_deg": 88,
    "K11_pN": 16,
    "K22_pN": 7,
    "K33_pN": 18,
    "epsilon_parallel": 3.6,
    "epsilon_perpendicular": 7.8,
    "states": {"white": {"volts": 3}, "black": {"volts": 0}},
}
STACK = [
    {"kind": "polariser", "axis_deg": 0},
    {"kind": "retarder", "axis_deg": 45, "retardance_nm": 137.5},
    CELL,
]
COARSE = {"range_nm": [450, 650], "step_nm": 50}


def display(stack):
    pixel = {"model": "liquid-crystal", "substrate": "Ag", "stack": stack}
    return papilio.Scenario.from_dict(
        {
            "spectrum": COARSE,
            "display": {"glass": {"index": 1.5, "surface": "fresnel"}, "pixel": pixel},
            "lighting": {"spectrum": "E", "diffuse": 1.0},
            "viewer": {"theta_deg": [0, 40], "phi_deg": [0, 90]},
        }
    )


def test_display_from_a_dictionary_equals_the_program(program, tmp_path):
    scenario = display(STACK)
    path = tmp_path / "lcd.toml"
    path.write_text(scenario.to_toml(), encoding="utf-8")
    printed = subprocess.run([program, "run", path, "--json"], capture_output=True, check=True, text=True).stdout
    result = papilio.run(scenario)
    assert result.states == ["white", "black"]
    assert result["reflectance_factor"].shape == (4, 2, 5)
    theirs = [view["states"]["white"]["reflectance_factor"] for view in json.loads(printed)["views"]]
    assert np.array_equal(result["white.reflectance_factor"], np.array(theirs))


def test_sweep_over_the_voltage_is_the_electro_optic_curve():
    scenario = display(STACK)
    volts = [0.0, 1.0, 2.5, 3.0]
    curve = papilio.sweep(scenario, {"display.pixel.stack.2.states.white.volts": volts}, ["white.Y"])
    values = curve["white.Y"]
    # Nothing happens below the threshold pi sqrt(K33/(epsilon0 |epsilon difference|)), here 2.2 V.
    assert abs(values[1] - values[0]) < 0.002 < 0.02 < values[3] - values[0]
    assert values[3] == papilio.run(scenario)["white.Y"][0]


def test_cone_has_the_azimuths_of_the_cell():
    cone = papilio.cone(display(STACK), theta_deg=[0, 40], phi_deg=[0, 90, 180, 270])
    white = cone["Y"][..., 0]
    assert white.shape == (4, 2)
    assert np.allclose(white[:, 0], white[0, 0])
    assert np.ptp(white[:, 1]) > 1e-4
    # Unpolarised light is reflected in the same way towards opposite azimuths (reciprocity).
    assert np.allclose(white[:2], white[2:], rtol=0, atol=1e-9)


def test_prepared_display_follows_a_retarder():
    scenario = display(STACK)
    prepared = papilio.Prepared(scenario)
    for nm in (100, 137.5):
        retarder = {"display.pixel.stack.1.retardance_nm": nm}
        ours, alone = prepared.run(retarder), papilio.run(scenario, set=retarder)
        assert np.array_equal(ours["reflectance_factor"], alone["reflectance_factor"])


def test_indices_may_be_arrays():
    nm = np.linspace(400, 700, 7)
    constant = display([STACK[0], STACK[1], CELL | {"n_o": 1.5, "n_e": 1.58}])
    expected = papilio.run(constant)["reflectance_factor"]
    for index in (np.full(7, 1.5), np.full(7, 1.5 + 0j)):
        scenario = display([STACK[0], STACK[1], CELL | {"n_o": (nm, index), "n_e": (nm, index + 0.08)}])
        assert np.allclose(papilio.run(scenario)["reflectance_factor"], expected, rtol=0, atol=1e-12)


def test_mistakes_have_their_place():
    with pytest.raises(papilio.ScenarioError, match="did you mean `polariser`") as caught:
        display([{"kind": "polarizer"}])
    assert "line" in str(caught.value) or "-->" in str(caught.value)
    without = {key: value for key, value in CELL.items() if not key.startswith("K")}
    with pytest.raises(papilio.ScenarioError, match="K11_pN"):
        papilio.run(display([STACK[0], without]))
