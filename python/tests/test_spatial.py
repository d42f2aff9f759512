"""Sharpness, crosstalk and sparkle are those of the program."""

import copy
import json
import pickle
import re
import subprocess
from pathlib import Path

import numpy as np
import papilio
import pytest
from conftest import ROOT

COARSE = {"spectrum.step_nm": 50}


@pytest.fixture(scope="module")
def sharp() -> papilio.Mtf:
    return papilio.mtf(ROOT / "scenarios" / "matrix.toml", set=COARSE)


def test_files_are_those_of_the_program(sharp: papilio.Mtf, scenarios: Path, program: Path, tmp_path: Path) -> None:
    def assert_equal(found: papilio.AnyResult, command: str, *arguments: str) -> None:
        theirs = tmp_path / command
        call = [program, command, *arguments, "--json", "--out", theirs]
        assert found.to_json() == subprocess.run(call, capture_output=True, text=True, check=True).stdout
        saved = found.save(tmp_path / "own" / command)
        assert {path.name for path in saved} == {path.name for path in theirs.iterdir()}
        assert all(path.read_bytes() == (theirs / path.name).read_bytes() for path in saved)

    assert_equal(sharp, "mtf", str(scenarios / "matrix.toml"), "--set", "spectrum.step_nm=50")
    shares = papilio.crosstalk(scenarios / "matrix.toml", set={"solver.relative_error": 0.02} | COARSE)
    rough = ["--set", "solver.relative_error=0.02", "--set", "spectrum.step_nm=50"]
    assert_equal(shares, "crosstalk", str(scenarios / "matrix.toml"), *rough)
    few = ["--set", "sparkle.replicates=2", "--set", "sparkle.correlation_um=60", "--set", "spectrum.step_nm=50"]
    values = {"sparkle.replicates": 2, "sparkle.correlation_um": 60} | COARSE
    glitter = papilio.sparkle(scenarios / "antiglare.toml", set=values)
    assert_equal(glitter, "sparkle", str(scenarios / "antiglare.toml"), *few)
    assert glitter["ppd"][0] == json.loads(glitter.to_json())["rows"][0]["ppd"]
    shiny = papilio.gloss(scenarios / "epaper.toml", set=COARSE)
    assert_equal(shiny, "gloss", str(scenarios / "epaper.toml"), "--set", "spectrum.step_nm=50")
    assert shiny["gloss_60"][1] == shiny.data["states"]["black"]["gloss_60"]


def test_transfer_functions_and_kernels_have_the_light_of_a_state(sharp: papilio.Mtf) -> None:
    for state in sharp.states:
        assert sharp.otf(state)[0] == 1 and abs(sharp.otf(state, axis="y", light="diffuse")[0] - 1) < 1e-12
        about = sharp.data["views"][0]["states"][state]["kernel"]
        assert abs(sharp.kernel(state)[0].sum() + about["outside"] - 1) < 1e-6
    moduli = np.abs([sharp.otf(state) for state in sharp.states])
    assert moduli.shape == (len(sharp.states), sharp.frequency_per_mm.size) and (moduli < 1 + 1e-9).all()
    assert np.array_equal(sharp["white.f50_x_per_mm"], sharp["f50_x_per_mm"][:, sharp.states.index("white")])


def test_results_are_copied_and_pickled(sharp: papilio.Mtf) -> None:
    for again in (copy.deepcopy(sharp), pickle.loads(pickle.dumps(sharp))):
        assert again.to_json() == sharp.to_json() and list(again) == list(sharp)
        assert np.array_equal(again.kernel("white"), sharp.kernel("white"))


def test_bad_names_and_scenarios_are_refused(sharp: papilio.Mtf, scenarios: Path) -> None:
    with pytest.raises(papilio.ArgumentError, match="expected 'x' or 'y'"):
        sharp.otf("white", axis="z")
    with pytest.raises(papilio.ArgumentError, match="'white'"):
        sharp.kernel("grey")
    for view in (-1, 1, "0", None):
        with pytest.raises(papilio.ArgumentError, match="^view:"):
            sharp.otf("white", view=view)
    with pytest.raises(papilio.ArgumentError, match="'diffuse'"):
        sharp.otf("white", light="lamp")
    with pytest.raises(papilio.ScenarioError, match="thickness_mm"):
        papilio.mtf(scenarios / "epaper.toml")
    with pytest.raises(papilio.ArgumentError, match="antiglare face"):
        papilio.sparkle(scenarios / "matrix.toml")


def test_progress_reports_positive_errors_beside_their_target(
    scenarios: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    papilio.mtf(scenarios / "matrix.toml", set={"viewer.theta_deg": [0, 20, 40]} | COARSE, progress=True)
    # Which of the reports are shown depends on their time.
    shown = capsys.readouterr().err
    errors = re.findall(r"relative error ([^,]*), target 0\.001 ", shown)
    assert "100 %, 3 of 3 views" in shown and shown.count("relative error") == len(errors), shown
    assert all(0.0 < float(error) < 1.0 for error in errors), shown
