"""How the package is used: type-checked strictly by test_types.py."""

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
