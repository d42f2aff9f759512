"""Docstrings: every example runs, and public functions describe their arguments and results."""

import doctest
import importlib
import inspect
import pkgutil

import numpy as np
import pytest
from conftest import ROOT

import papilio

MODULES = [importlib.import_module(f"papilio.{module.name}") for module in pkgutil.iter_modules(papilio.__path__) if module.name not in ("_papilio", "__main__")]


@pytest.mark.filterwarnings("ignore::papilio.PapilioWarning")
@pytest.mark.parametrize("module", [papilio, *MODULES], ids=lambda module: module.__name__)
def test_examples_of_docstrings_run(module, monkeypatch):
    pytest.importorskip("xarray")
    pytest.importorskip("pandas")
    monkeypatch.chdir(ROOT)
    finder, said = doctest.DocTestFinder(exclude_empty=True), []
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
    for test in finder.find(module, extraglobs={"papilio": papilio, "np": np, "films": papilio.films}):
        failed, _ = runner.run(test, out=said.append)
        assert failed == 0, "".join(said)


def public_functions():
    for place in (papilio, papilio.cluster, papilio.colour, papilio.diffuser, papilio.films, papilio.plot):
        for name in place.__all__:
            one = getattr(place, name)
            if inspect.isfunction(one):
                yield f"{place.__name__}.{name}", one


@pytest.mark.parametrize(("name", "function"), list(public_functions()), ids=lambda one: one if isinstance(one, str) else "")
def test_functions_describe_arguments_and_results(name, function):
    text = inspect.getdoc(function)
    required = {"Returns:", "Example:"} | ({"Args:"} if inspect.signature(function).parameters else set())
    if name.endswith("print_progress"):
        required = {"Args:"}
    assert not {one for one in required if one not in text}, text


@pytest.mark.parametrize("place", ["papilio", "cluster", "colour", "diffuser", "films", "plot", "errors"])
def test_dir_has_public_names_only(place):
    module = papilio if place == "papilio" else getattr(papilio, place, None) or importlib.import_module(f"papilio.{place}")
    assert dir(module) == sorted(module.__all__)
    assert all(hasattr(module, name) for name in module.__all__)
