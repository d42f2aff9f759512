"""The display's BSDF from Python equals that of the program."""

import subprocess

import numpy as np
import pytest

import papilio
from papilio import ArgumentError

COARSE = {"spectrum.step_nm": 50}


def test_brdf_equals_file_of_program(program, scenarios, tmp_path):
    command = [program, "brdf", scenarios / "indoor.toml", "--step", "30", "--set", "spectrum.step_nm=50", "--out", tmp_path]
    subprocess.run(command, check=True, capture_output=True)
    found = papilio.brdf(scenarios / "indoor.toml", step_deg=30, set=COARSE)
    found.save(tmp_path / "ours.npz")
    assert (tmp_path / "ours.npz").read_bytes() == (tmp_path / "display-bsdf.npz").read_bytes()
    assert found.brdf.shape == (8, 3, 3, 7, 9) and found.specular.shape == (8, 3, 9)
    assert found.about["format"] == "papilio-bsdf" and found.missed > 0
    parts = papilio.reflection(scenarios / "indoor.toml", set=COARSE)
    rows = (tmp_path / "reflection.csv").read_text().splitlines()[1:]
    assert [float(row.split(",")[2]) for row in rows] == parts["returned"].reshape(-1).tolist()
    assert parts["mirror"].shape == (4, 8)
    np.testing.assert_allclose(parts["mirror"] + parts["haze"] + parts["lambertian"], parts["returned"], rtol=1e-9)


def test_table_without_step_meets_its_limit(scenarios, program, tmp_path):
    """Without a step, the deviation is at most 0.02; a step that is too coarse causes the program's warning."""
    coarse = {"spectrum.step_nm": 200}
    found = papilio.brdf(scenarios / "indoor.toml", theta_i_deg=[0, 30, 60], set=coarse)
    assert found.missed <= 0.02 and np.diff(found.theta_o_deg)[0] < 5
    with pytest.warns(papilio.PapilioWarning, match="what its readers interpolate differs by up to") as heard:
        five = papilio.brdf(scenarios / "indoor.toml", step_deg=5, set=coarse)
    assert five.missed > 0.05 and five.warnings == [str(one.message) for one in heard] and "warnings" in repr(five)
    command = [program, "brdf", scenarios / "indoor.toml", "--set", "spectrum.step_nm=200", "--out", tmp_path]
    said = subprocess.run(command, check=True, capture_output=True, text=True).stderr
    assert all(f"warning: {text}".replace("step_deg=", "--step ") in said for text in five.warnings)
    # A display that does not require a finer step keeps the program's step.
    paper = papilio.Scenario(
        '[display.pixel]\nmodel = "uniform"\nkind = "lambertian"\nreflectance = { white = 0.5, black = 0.1 }\n'
        '[lighting]\npreset = "indoor"\n[spectrum]\nstep_nm = 200\n'
    )
    assert papilio.brdf(paper).theta_i_deg.size == 18


def test_arrays_have_documented_names(scenarios):
    pytest.importorskip("xarray")
    angles = {"theta_i_deg": [0, 20], "theta_o_deg": [0, 20, 40], "dphi_deg": [0, 180]}
    found = papilio.brdf(scenarios / "indoor.toml", set=COARSE, **angles)
    arrays = found.to_xarray()
    assert dict(arrays.sizes) == {"state": 8, "theta_i_deg": 2, "theta_o_deg": 3, "dphi_deg": 2, "wavelength_nm": 9}
    assert arrays.brdf.attrs["units"] == "1/sr"
    # Reciprocal: light and viewer can be exchanged.
    there = arrays.brdf.sel(theta_i_deg=20, theta_o_deg=0, state="white")
    back = arrays.brdf.sel(theta_i_deg=0, theta_o_deg=20, state="white")
    np.testing.assert_allclose(there, back, rtol=1e-4)
    parts = papilio.reflection(scenarios / "indoor.toml", theta_deg=[8], set=COARSE).to_xarray()
    assert float(parts.returned.sel(state="white", theta_deg=8)) > float(parts.returned.sel(state="black", theta_deg=8))


@pytest.mark.parametrize(
    ("dphi_deg", "reads"),
    [([0], True), ([0, 180], True), ([0, 90, 180], True), ([15, 45, 75, 105, 135, 165], True), ([0, 10], False), ([0, 90], False), ([90, 180], False)],
)
def test_saved_azimuths_are_those_that_the_program_reads(program, scenarios, tmp_path, dphi_deg, reads):
    found = papilio.brdf(scenarios / "indoor.toml", theta_i_deg=[0, 30], theta_o_deg=[0, 30, 60], dphi_deg=dphi_deg, set=COARSE)
    assert found.brdf.shape[3] == len(dphi_deg)
    path = tmp_path / "table.npz"
    if reads:
        found.save(path)
    else:
        with pytest.raises(ArgumentError, match="^dphi_deg: .*half a circle"):
            found.save(path)
        with pytest.raises(ArgumentError, match="^dphi_deg"):
            found.save(tmp_path / "folder")
        # The reader agrees.
        path.write_bytes(found._content)
    end = subprocess.run([program, "diffuser", "inspect", path, "--json"], capture_output=True, text=True)
    assert ("half a circle" not in end.stderr) == reads, end.stderr


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"step_deg": 7}, "step_deg"),
        ({"step_deg": 0}, "step_deg"),
        ({"step_deg": 0.5}, "step_deg.*numbers"),
        ({"theta_i_deg": [90]}, "theta_i_deg"),
        ({"dphi_deg": [10, 5]}, "dphi_deg"),
        ({"theta_o_deg": []}, "theta_o_deg"),
        ({"threads": 0}, "threads"),
    ],
)
def test_invalid_directions_are_named(scenarios, arguments, says):
    with pytest.raises(ArgumentError, match=f"^{says}"):
        papilio.brdf(scenarios / "indoor.toml", **arguments)
    with pytest.raises(ArgumentError, match="^theta_deg"):
        papilio.reflection(scenarios / "indoor.toml", theta_deg=[87])
