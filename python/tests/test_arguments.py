"""Invalid arguments: an exception names the argument, and the interpreter never crashes."""

import datetime
import random
from pathlib import Path

import numpy as np
import pytest

import papilio
from papilio import ArgumentError, PapilioError, Scenario, ScenarioError, colour, films

ODD = [
    None, True, 0, -1, 2**70, 0.5, float("nan"), float("inf"), -1e308, 1j, "", "x", "0.5", "\0", "\ud800", "ä" * 1000, b"x",
    [], [1], [[1], [2, 3]], {}, {"a": 1}, {1: 2}, (), (1, "a"), object(), len, Path("x"), np.zeros(0), np.zeros((2, 0)),
    np.array("a"), np.array([None]), np.float32(3), np.int8(3), np.array([1, np.nan]), np.datetime64("2020-01-01"),
    datetime.date(2020, 1, 1), slice(3), range(3), iter([1]), np.broadcast_to(1.0, (1 << 40, 1)),
]  # fmt: skip


@pytest.mark.parametrize(
    ("arguments", "names"),
    [
        ({"solver": "path-tracing"}, "solver"),
        ({"seed": -1}, "seed"),
        ({"seed": 2**63}, "seed"),
        ({"seed": 1.5}, "seed"),
        ({"threads": 0}, "threads"),
        ({"threads": True}, "threads"),
        ({"set": ["a=1"]}, "set"),
        ({"set": {"a": object()}}, "a"),
        ({"set": {"solver.seed": 2**70}}, r"solver\.seed"),
        ({"set": {"solver.relative_error": float("nan")}}, r"solver\.relative_error"),
        ({"set": {5: 1}}, "path"),
        ({"progress": "bar"}, "progress"),
    ],
)
def test_run_with_invalid_argument_names_it(scenarios, arguments, names):
    with pytest.raises(ArgumentError, match=f"^{names}"):
        papilio.run(scenarios / "indoor.toml", **arguments)


def test_names_of_solvers_are_the_present_ones(scenarios):
    """The old name is accepted, and not among those that an error lists."""
    with pytest.raises(ArgumentError, match="expected 'adding' or 'monte-carlo' or 'auto', not 'x'"):
        papilio.run(scenarios / "indoor.toml", solver="x")
    old = papilio.run(scenarios / "indoor.toml", solver="walk", set={"solver.paths": 32, "spectrum.step_nm": 50})
    assert old.data["solver"]["method"] == "monte-carlo"


def test_invalid_scenario_raises_named_error():
    for path in [None, 5, b"x", "a\0b", ["indoor.toml"]]:
        with pytest.raises(ArgumentError, match="^scenario:"):
            papilio.run(path)
    for path in ["absent.toml", "", "/", Path("no/such.toml"), "\ud800"]:
        with pytest.raises((ScenarioError, ArgumentError)):
            papilio.run(path)
    for text in [None, 5, b"[display]"]:
        with pytest.raises(ArgumentError, match="^text:"):
            Scenario(text)
    for text in ["", "]", "a = 1", "\ud800", "x" * (2 << 20)]:
        with pytest.raises((ScenarioError, ArgumentError)):
            Scenario(text)
    with pytest.raises(ArgumentError, match="^tables"):
        Scenario.from_dict({"display": {"x": {1: 2}}})
    with pytest.raises(ArgumentError, match="^preset"):
        Scenario.new("moon")
    endless = {}
    endless["a"] = endless
    with pytest.raises(ArgumentError, match="nested too deeply"):
        Scenario.from_dict(endless)


def test_run_of_invalid_display_raises_error(scenarios):
    wrong = {"solver.method": "adding", "display.diffuser.width": 1e-9}
    with pytest.raises((papilio.DisplayError, ScenarioError)):
        papilio.run(scenarios / "indoor.toml", set=wrong)


def calls(scenario, prepared):
    """Calls of all functions, each with one odd argument."""
    key = "display.pixel.film.0.thickness_nm"
    return {
        "run": lambda x: papilio.run(x),
        "run solver": lambda x: papilio.run(scenario, solver=x) if x is not None else None,
        "run seed": lambda x: papilio.run(scenario, seed=x),
        "run set": lambda x: papilio.run(scenario, set=x),
        "set item": lambda x: scenario.copy().__setitem__(key, x),
        "set path": lambda x: scenario.copy().__setitem__(x, 5.0),
        "get item": lambda x: scenario[x],
        "delete item": lambda x: scenario.copy().__delitem__(x),
        "insert": lambda x: scenario.copy().insert("display.pixel.film", x),
        "insert path": lambda x: scenario.copy().insert(x, {}),
        "insert index": lambda x: scenario.copy().insert("display.pixel.film", {"material": "air", "thickness_nm": 1}, x),
        "text": lambda x: Scenario(x),
        "files": lambda x: Scenario(scenario.to_toml(), files=x),
        "from_dict": lambda x: Scenario.from_dict(x),
        "from_dict inside": lambda x: Scenario.from_dict({"title": x}),
        "new": lambda x: Scenario.new(x),
        "variables": lambda x: prepared.evaluate(x, ["white.Y"]),
        "values": lambda x: prepared.evaluate({key: x}, ["white.Y"]),
        "keys": lambda x: prepared.evaluate({x: [50.0]}, ["white.Y"]),
        "metrics": lambda x: prepared.evaluate({key: 50.0}, x),
        "metric": lambda x: prepared.evaluate({key: 50.0}, [x]),
        "view": lambda x: prepared.evaluate({key: 50.0}, ["white.Y"], view=x),
        "layers": lambda x: films.power(x, 550.0, substrate="Al"),
        "layer": lambda x: films.power([x], 550.0, substrate="Al"),
        "material": lambda x: films.power([(x, 10.0)], 550.0, substrate="Al"),
        "thickness": lambda x: films.power([("SiO2", x)], 550.0, substrate="Al"),
        "wavelength": lambda x: films.power([("SiO2", 10.0)], x, substrate="Al"),
        "theta": lambda x: films.power([("SiO2", 10.0)], 550.0, x, substrate="Al"),
        "incidence": lambda x: films.power([("SiO2", 10.0)], 550.0, incidence=x, substrate="Al"),
        "substrate": lambda x: films.power([("SiO2", 10.0)], 550.0, substrate=x),
        "polarisation": lambda x: films.power([("SiO2", 10.0)], 550.0, polarisation=x, substrate="Al"),
        "spectra": lambda x: colour.xyz(x, [400, 500]),
        "grid": lambda x: colour.xyz([1.0, 2.0], x),
        "light": lambda x: colour.xyz([1.0, 2.0], [400, 500], x),
        "lab": lambda x: colour.lab(x, x),
        "uv": lambda x: colour.uv_prime(x),
        "gamut": lambda x: colour.gamut_percent(x, x),
        "difference": lambda x: colour.delta_e_2000(x, x),
        "cone": lambda x: papilio.cone(scenario, theta_deg=x, phi_deg=[0.0]),
        "figure": lambda x: papilio.Figure("a", x).png(),
        "scale": lambda x: papilio.Figure("a", "<svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'/>").png(x),
        "diffuser": lambda x: papilio.diffuser.Diffuser(x),
        "curves": lambda x: papilio.plot.curves([1.0, 2.0], {"a": x}),
        "curves x": lambda x: papilio.plot.curves(x, {"a": [1.0, 2.0]}, kinds=x, title=x),
        "map": lambda x: papilio.plot.map([1.0], [2.0], x),
        "map x": lambda x: papilio.plot.map(x, [1.0], [[2.0]], name=x),
        "schema": lambda x: papilio.schema(x),
    }


@pytest.fixture(scope="module")
def small():
    text = '[display.pixel]\nmodel = "uniform"\nkind = "lambertian"\nreflectance = { white = 0.5, black = 0.1 }\n'
    scenario = Scenario(text + '[lighting]\npreset = "indoor"\n[spectrum]\nstep_nm = 50\n')
    from conftest import ROOT

    return scenario, papilio.Prepared(ROOT / "scenarios" / "indoor.toml")


def names():
    return list(calls(None, None))


@pytest.mark.parametrize("name", names())
def test_call_with_odd_value_succeeds_or_raises_papilio_error(small, name):
    call = calls(*small)[name]
    allowed = (PapilioError, KeyError) if "item" in name else PapilioError
    for odd in ODD:
        if isinstance(odd, (dict, list, np.ndarray, slice)) and name == "keys":
            continue  # not hashable: Python's own TypeError
        try:
            call(odd)
        except allowed as error:
            assert str(error)
        except Exception as error:
            pytest.fail(f"{name} of {odd!r}: {type(error).__name__}: {error}")


def test_damaged_text_succeeds_or_raises_scenario_error(scenarios):
    good = (scenarios / "indoor.toml").read_text()
    numbers = random.Random(0)
    for _ in range(300):
        at, length = numbers.randrange(len(good)), numbers.randrange(12)
        put = "".join(numbers.choice('0123456789[]{}=."\n#-e ä') for _ in range(numbers.randrange(6)))
        try:
            Scenario(good[:at] + put + good[at + length :], folder=scenarios).check()
        except ScenarioError as error:
            assert error.mistakes and str(error).startswith("error: ")
