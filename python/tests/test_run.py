"""Runs: the same numbers as the command line."""

import json
import subprocess

import papilio


def of_program(program, scenario, *arguments):
    """The JSON output of the program."""
    command = [program, "run", scenario, "--json", *arguments]
    return subprocess.run(command, capture_output=True, check=True, text=True).stdout


def test_indoor_scenario_equals_program_to_last_bit(program, scenarios):
    indoor = scenarios / "indoor.toml"
    result = papilio.run(indoor)
    printed = of_program(program, indoor)
    assert same(result.data, json.loads(printed)) > 1000
    assert result.to_json() == printed


def test_monte_carlo_and_set_values_equal_program(program, scenarios):
    indoor = scenarios / "indoor.toml"
    result = papilio.run(indoor, solver="monte-carlo", seed=5, set={"solver.relative_error": 0.01, "viewer.theta_deg": [0, 30]})
    arguments = ["--solver", "monte-carlo", "--seed", "5", "--set", "solver.relative_error=0.01", "--set", "viewer.theta_deg=[0, 30]"]
    assert result.to_json() == of_program(program, indoor, *arguments)
    assert result.views == [(0.0, 0.0), (30.0, 0.0)]


def same(ours, theirs):
    """Counts the numbers; fails if two differ in any bit."""
    assert type(ours) is type(theirs)
    if isinstance(ours, dict):
        assert list(ours) == list(theirs)
        return sum(same(ours[key], theirs[key]) for key in ours)
    if isinstance(ours, list):
        assert len(ours) == len(theirs)
        return sum(map(same, ours, theirs))
    if isinstance(ours, float):
        assert ours.hex() == theirs.hex()
        return 1
    assert ours == theirs
    return 0
