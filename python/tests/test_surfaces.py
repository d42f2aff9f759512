"""Measured surfaces are those of the program."""

import copy
import io
import json
import pickle
import subprocess
from pathlib import Path

import numpy as np
import papilio
import pytest
from conftest import ROOT

SURFACES = ROOT / "surfaces"
FEW = {
    "microgeometry.rays": 640,
    "microgeometry.rms_nm": 300.0,
    "microgeometry.road": "both",
    "microgeometry.incidence_deg": [0, 60],
    "microgeometry.wavelength_nm": [450, 650],
}


def test_surface_is_that_of_the_program(program: Path, tmp_path: Path) -> None:
    found = papilio.gonio(SURFACES / "etched.toml", set=FEW)
    keys = [f"{key}={json.dumps(value)}" for key, value in FEW.items()]
    command = [program, "gonio", str(SURFACES / "etched.toml"), "--out", str(tmp_path)]
    subprocess.run(command + [word for key in keys for word in ("--set", key)], capture_output=True, check=True)
    assert found.to_json() == (tmp_path / "audit.json").read_text()
    assert found.face() == (tmp_path / "face.npz").read_bytes()
    lines = (tmp_path / "totals.csv").read_text().splitlines()
    column = lines[0].split(",").index("transmitted")
    assert [float(line.split(",")[column]) for line in lines[1:]] == found["transmitted"].reshape(-1).tolist()
    for name, figure in found.figures().items():
        assert figure.svg == (tmp_path / f"{name}.svg").read_text()
    assert list(found.figures()) == ["totals", "psd", "cutoff", "waves", "waves-oblique"]
    with np.load(io.BytesIO(found.face())) as kernel:
        assert np.array_equal(found["scattered"], kernel["scattered"])
    lines = [line.split(",") for line in (tmp_path / "waves.csv").read_text().splitlines()]
    haze, side = lines[0].index("haze_reflected"), lines[0].index("from")
    below = [float(line[haze]) for line in lines[1:] if line[side] == "below"]
    assert below == found["waves_haze_reflected"][1].reshape(-1).tolist() and np.array_equal(found["waves_theta_deg"], found["theta_deg"])
    assert np.array_equal(found["waves_straight"][0, 0], found["straight"]) and np.isnan(found["waves_straight"][1, -1]).all()
    assert set(found["waves_holds"][0].flat) <= {"waves", "neither", "rays", "both"} and set(found["waves_holds"][1, -1]) == {""}
    assert found["haze"].shape == found["wavelength_nm"].shape == (2,) and np.all((found["haze"] > 0) & (found["haze"] < 1))
    again = pickle.loads(pickle.dumps(copy.copy(found)))
    assert again.to_json() == found.to_json() and np.array_equal(again["reflected"], found["reflected"])


def test_preview_has_a_ninth_of_the_rays() -> None:
    rays = [papilio.gonio(SURFACES / "hemispheres.toml", set={"microgeometry.rays": 1152}, preview=short).data["rays"] for short in (False, True)]
    assert rays[0] == 9 * rays[1]


def test_azimuths_have_their_own_arrays(program: Path, tmp_path: Path) -> None:
    keys = {"microgeometry.rays": 640, "microgeometry.azimuth_deg": 90, "microgeometry.incidence_deg": [0, 30, 70]}
    found = papilio.gonio(SURFACES / "prisms.toml", set=keys)
    command = [program, "gonio", str(SURFACES / "prisms.toml"), "--out", str(tmp_path)]
    subprocess.run(command + [word for key, value in keys.items() for word in ("--set", f"{key}={value}")], capture_output=True, check=True)
    assert found.face() == (tmp_path / "face.npz").read_bytes()
    assert found["phi_deg"].tolist() == [0, 90, 180, 270]
    bands = found["scattered"].shape[0]
    assert found["scattered_by_azimuth"].shape == found["error_by_azimuth"].shape == (bands, 4, bands, 4)
    transmitted = found["transmitted_by_azimuth"]
    assert transmitted.shape == found["transmitted_by_azimuth_error"].shape == (2, 3, 4)
    # From below, light along the prisms is totally reflected, and light across them at 30 deg is not.
    assert np.all(transmitted[1, 1:, [1, 3]] == 0) and np.all(transmitted[1, 1, [0, 2]] > 0.7)
    again = pickle.loads(pickle.dumps(found))
    assert np.array_equal(again["scattered_by_azimuth"], found["scattered_by_azimuth"])
    assert again.data["by_azimuth"]["azimuth_deg"] == 90 and list(found.figures())[:2] == ["totals", "azimuths"]
    with pytest.raises(papilio.ScenarioError, match="not a whole number of steps of 50 deg"):
        papilio.gonio(SURFACES / "prisms.toml", set={"microgeometry.azimuth_deg": 50})


def test_waves_alone_have_no_kernel() -> None:
    # A longer cut-off than the surface's needs a sixteenth of the heights.
    few = {"microgeometry.wavelength_nm": [550], "microgeometry.incidence_deg": [0], "microgeometry.cutoff_um": 4}
    found = papilio.gonio(SURFACES / "hazy.toml", set=few)
    assert found.face() is None and "transmitted" not in found and found["haze"].shape == (1,)
    assert repr(found) == "<papilio.Surface 'Exponential face with the haze of H78': by waves>"


def test_mistakes_are_named(scenarios: Path) -> None:
    with pytest.raises(papilio.ScenarioError, match="this is the scenario of a display, not a surface"):
        papilio.gonio(scenarios / "indoor.toml")
    with pytest.raises(papilio.ScenarioError, match="microgeometry.rms_nm"):
        papilio.gonio(SURFACES / "etched.toml", set={"microgeometry.rms_nm": -1})
    with pytest.raises(papilio.ArgumentError, match="set: expected a dict"):
        papilio.gonio(SURFACES / "etched.toml", set=["microgeometry.rays=640"])  # type: ignore[arg-type]
    with pytest.raises(papilio.ArgumentError, match="preview: expected True or False"):
        papilio.gonio(SURFACES / "etched.toml", preview=9)  # type: ignore[arg-type]


def test_threads_and_progress() -> None:
    told: list[dict[str, int]] = []
    few = {**FEW, "microgeometry.wavelength_nm": [550.0]}
    one = papilio.gonio(SURFACES / "etched.toml", set=few, threads=1, progress=told.append)
    assert told[-1]["done"] <= told[-1]["of"] == 8 + 32
    assert [now["done"] for now in told] == sorted(now["done"] for now in told)
    assert papilio.gonio(SURFACES / "etched.toml", set=few, threads=3).face() == one.face()
    with pytest.raises(papilio.ArgumentError, match="threads"):
        papilio.gonio(SURFACES / "etched.toml", threads=0)
