"""Fits of a film to a measured spectrum by SciPy's least_squares over `tmm`, as reference values for `papilio fit`.

    pip install tmm==0.2.0 scipy==1.17.1 numpy==2.4.6
    python validation/films/fit_oracle.py --write     # makes fit_data.csv and fit.csv
    python validation/films/fit_oracle.py --check     # recomputes and compares with them

fit_data.csv: the reflectance at normal incidence from air of an absorbing film (n 2.1, k 0.03) of 187.3 nm, an air gap
of 43.1 nm, and a substrate (n 3.9, k 0.05), at 61 wavelengths, with noise of 0.4 % and 0.0005 of a fixed seed, and the
standard deviation of each value.
fit.csv: thickness, gap and k of the film at the minimum of chi-square, their standard errors sqrt(diag((J^T J)^-1)),
correlations, chi-square, and the intervals of 95 % of the profile likelihood, whose ends are roots of the increase of
the smallest chi-square with one value held.
"""

import pathlib
import sys

import numpy as np
import tmm
from scipy.optimize import brentq, least_squares

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent))

import oracle  # noqa: E402

NM = np.arange(400.0, 701.0, 5.0)
TRUE = np.array([187.3, 43.1, 0.03])
STEPS = np.array([1e-3, 1e-3, 1e-6])
QUANTILE = 1.959963985


def reflectance(values):
    thickness, gap, k = values
    indices = [1.0, 2.1 + 1j * k, 1.0, 3.9 + 0.05j]
    lengths = [np.inf, thickness, gap, np.inf]
    return np.array([tmm.coh_tmm("s", indices, lengths, 0.0, nm)["R"] for nm in NM])


def data():
    exact = reflectance(TRUE)
    deviation = np.round(np.hypot(0.004 * exact, 5e-4), 6)
    noise = np.random.default_rng(20260117).standard_normal(len(NM))
    return np.round(exact + deviation * noise, 6), deviation


def fitted(measured, deviation, start, held=None):
    """Values at the minimum; one may be held at its start."""
    free = [k for k in range(3) if k != held]

    def residuals(of_free):
        values = np.array(start, dtype=float)
        values[free] = of_free
        return (reflectance(values) - measured) / deviation

    found = least_squares(
        residuals, np.array(start)[free], x_scale=np.array([1.0, 1.0, 1e-3])[free], jac="3-point",
        xtol=1e-14, ftol=1e-14, gtol=1e-14,
    )
    values = np.array(start, dtype=float)
    values[free] = found.x
    return values, 2 * found.cost


def main():
    measured, deviation = data()
    best, chi_square = fitted(measured, deviation, TRUE)
    jacobian = np.empty((len(NM), 3))
    for k in range(3):
        step = np.eye(3)[k] * STEPS[k]
        jacobian[:, k] = (reflectance(best + step) - reflectance(best - step)) / (2 * STEPS[k]) / deviation
    covariance = np.linalg.inv(jacobian.T @ jacobian)
    error = np.sqrt(np.diag(covariance))
    correlation = covariance / np.outer(error, error)

    def end(k, side):
        def excess(distance):
            start = best.copy()
            start[k] += side * distance * error[k]
            return np.sqrt(max(fitted(measured, deviation, start, k)[1] - chi_square, 0)) - QUANTILE

        return best[k] + side * error[k] * brentq(excess, 1.0, 4.0, xtol=1e-5)

    rows = [["key", "value", "standard_error", "from_95", "to_95", "with_thickness", "with_gap", "with_k"]]
    for k, key in enumerate(["thickness", "gap", "k"]):
        numbers = [best[k], error[k], end(k, -1), end(k, 1), *correlation[k]]
        rows.append([key, *(f"{number:.9g}" for number in numbers)])
    rows.append(["chi_square", f"{chi_square:.9g}", "", "", "", "", "", ""])
    table = [["state", "wavelength_nm", "reflectance_factor", "standard_deviation"]]
    table += [["film", f"{nm:g}", f"{r:.6f}", f"{d:.6f}"] for nm, r, d in zip(NM, measured, deviation)]
    oracle.main(__doc__, HERE, [("fit_data.csv", table, 1e-9), ("fit.csv", rows, 1e-5)], 1e-6)


main()
