"""Palettes are those of the program."""

import copy
import pickle
import subprocess
from pathlib import Path

import numpy as np
import papilio
import pytest


def test_palette_is_that_of_the_program(scenarios: Path, program: Path) -> None:
    file = scenarios / "six-ink.toml"
    found = papilio.palette(file, rooms=["office", "FL11"])
    command = [program, "palette", str(file), "--rooms", "office,FL11", "--json"]
    assert found.to_json() == subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert found.states[:2] == ["black", "white"] and found.rooms == ["office", "FL11"]
    assert found["XYZ"].shape == found["Lab"].shape == found["srgb"].shape == (6, 3)
    assert np.all(found["Y"] == found["XYZ"][:, 1]) and np.all(found.delta_e_2000("FL11") >= 0)
    assert list(found.figures()) == ["palette"]
    assert copy.copy(found).to_json() == pickle.loads(pickle.dumps(found)).to_json() == found.to_json()


def test_files_are_those_of_the_program(scenarios: Path, program: Path, tmp_path: Path) -> None:
    file, theirs = scenarios / "six-ink.toml", tmp_path / "six-ink"
    subprocess.run([program, "palette", str(file), "--relative-to", "display", "--out", str(theirs)], check=True)
    ours = papilio.palette(file, relative_to="display").save(tmp_path / "ours")
    assert {path.name: path.read_bytes() for path in ours} == {path.name: path.read_bytes() for path in theirs.iterdir()}


def test_mistakes_are_named(scenarios: Path) -> None:
    file = scenarios / "six-ink.toml"
    with pytest.raises(papilio.ArgumentError, match="rooms: it is the text 'office'"):
        papilio.palette(file, rooms="office")
    with pytest.raises(papilio.ArgumentError, match="rooms: 'office' is given twice"):
        papilio.palette(file, rooms=["office", "FL11", "office"])
    with pytest.raises(papilio.ArgumentError, match="relative_to"):
        papilio.palette(file, relative_to="paper")  # type: ignore[arg-type]
    with pytest.raises(papilio.ScenarioError, match="Offce"):
        papilio.palette(file, rooms=["Offce"])
    with pytest.raises(papilio.ScenarioError, match="one view"):
        papilio.palette(file, set={"viewer.theta_deg": [0, 10]})
    with pytest.raises(KeyError, match="there is no such room; expected none"):
        papilio.palette(file).delta_e_2000("office")
