"""Absorptance of the layers of a film pixel."""

from pathlib import Path

import numpy as np
import papilio
import pytest


def test_layers_and_reflectance_sum_to_one(scenarios: Path) -> None:
    found = papilio.absorption(scenarios / "indoor.toml", theta_deg=[0, 45, 90], set={"spectrum.step_nm": 50})
    assert found.layers[1] == ("1", "Cr:Johnson") and found.layers[-1] == ("substrate", "Al")
    assert found.states[:2] == ["white", "black"] and found.sub_pixels == ["red", "green", "blue"]
    assert found.absorptance.shape == (8, 3, 6, 3, 9)
    np.testing.assert_allclose(found.absorptance.sum(axis=2) + found.reflectance, 1.0, atol=1e-12)
    np.testing.assert_allclose(found.area.sum(axis=1), 0.873)


def test_dataset_and_figure_name_the_layers(scenarios: Path) -> None:
    pytest.importorskip("xarray")
    found = papilio.absorption(scenarios / "indoor.toml", set={"spectrum.step_nm": 50})
    data = found.to_xarray()
    chromium = data.absorptance.sel(state="black", sub_pixel="red", layer="1", theta_deg=0, wavelength_nm=580)
    assert float(chromium) > 0.9
    assert list(data.material.values) == ["Si3N4", "Cr:Johnson", "SiO2", "AlOx", "air", "Al"]
    assert "substrate: Al" in found.figure().svg


def test_pixel_without_film_is_refused(scenarios: Path) -> None:
    with pytest.raises(papilio.ScenarioError, match="no film"):
        papilio.absorption(scenarios / "epaper.toml")


def test_cone_compares_with_a_reference_direction(scenarios: Path) -> None:
    axes = {"theta_deg": [0, 30, 60], "phi_deg": [0, 90, 180, 270]}
    cone = papilio.cone(scenarios / "epaper.toml", **axes, reference_deg=(30, 90))
    white = cone.states.index("white")
    assert cone["delta_E_2000_with_angle"][1, 1, white] < 0.1
    assert cone["L_star"].shape == (4, 3, 2)
    with pytest.raises(papilio.ArgumentError, match="reference_deg"):
        papilio.cone(scenarios / "epaper.toml", **axes, reference_deg=(90, 0))
