"""Typical use of the package, for the strict type check in test_types.py."""

import numpy as np

import papilio
from papilio import colour, films

scenario = papilio.Scenario.load("scenarios/indoor.toml")
scenario["display.pixel.film.0.thickness_nm"] = 50
result = papilio.run(scenario, solver="adding", set={"viewer.theta_deg": [0, 30]})
contrast: float = float(result["contrast_ratio"][0])
prepared = papilio.Prepared(scenario)
values = prepared.evaluate({"display.pixel.gap_nm.red": np.linspace(250, 300, 11)}, metrics=["white.Y"])
best: int = int(values[:, 0].argmax())
nm = np.arange(380, 781, 5)
share = films.reflectance([("SiO2", np.linspace(0, 100, 5)[:, None]), (1.9 + 0.1j, 10)], nm, substrate="Al")
uv = colour.uv_prime(colour.xyz(share, nm))
svg: str = result.figures()["overview"].svg
try:
    papilio.run("absent.toml")
except papilio.ScenarioError as error:
    line: int | None = error.line

# A variable has the same type as the expression in the call.
columns = {"display.pixel.gap_nm.red": np.linspace(250, 300, 11)}
values = prepared.evaluate(columns, ["white.Y"])
values, slopes = prepared.derivatives(columns, ["white.Y"])
equal_gaps = {("display.pixel.gap_nm.red", "display.pixel.gap_nm.green"): np.linspace(250, 300, 11)}
values = prepared.evaluate(equal_gaps, ["white.Y"])
both = {"display.pixel.gap_nm.red": [250.0], ("display.pixel.gap_nm.green", "display.pixel.gap_nm.blue"): [200.0]}
found = papilio.cluster.sweep(scenario, columns, ["white.Y"], on_error="nan", batch_seconds=1.0)
found = papilio.cluster.evaluate_many(scenario, columns, ["white.Y"], progress=True)
lists = {"display.pixel.gap_nm.red": [250.0, 260.0]}
values = prepared.evaluate(lists, ["white.Y"])
words = {"display.pixel.film.2.material": ["SiO2", "MgF2"]}
values = prepared.evaluate(words, ["white.Y"])
said: list[str] = [*result.warnings, *result.notes, *found.warnings, *papilio.cone(scenario).warnings]
names: list[str] = list(result.keys()) if "white.Y" in result else []
share = films.power([("SiO2", 100.0)], nm, substrate="Al", polarisation="p", threads=2).transmittance
lab = colour.lab(colour.xyz(share, nm, observer="1964"), white=colour.xyz(np.ones(nm.size), nm, observer="1964"))

# Sweeps, results and arrays.
swept = papilio.sweep(scenario, columns, ["white.Y"], names=["gap"], view="all")
spectra = prepared.evaluate(columns, ["white.reflectance_factor"], view=[0])
wave = films.amplitudes([("SiO2", 100.0)], nm, substrate="Al")
delta: float = float(wave.delta_deg[0])
slopes_of_film = films.derivatives([("SiO2", 100.0)], nm, substrate="Al", by=[("thickness", 0), ("n", "substrate")]).derivatives
layers = films.absorptance([("SiO2", 100.0)], nm, substrate="Al")
foil = papilio.diffuser.Diffuser("scenarios/data/H78.bsdf")
everything: list[papilio.AnyResult] = [
    result, swept, foil, papilio.cone(scenario), papilio.brdf(scenario), papilio.reflection(scenario), papilio.absorption(scenario),
    papilio.optimize(scenario), papilio.tolerance(scenario), papilio.fit(scenario, "a.csv", {"state": ["white"], "Y": [0.5]}),
]  # fmt: skip
drawn: list[str] = [figure.svg for one in everything for figure in one.figures().values()]
