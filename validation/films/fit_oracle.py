"""Fits of films to measured spectra by SciPy's least_squares over `tmm`, as reference values for `papilio fit`.

    pip install tmm==0.2.0 scipy==1.17.1 numpy==2.4.6 pyElli==0.23.1 packaging==26.4
    python validation/films/fit_oracle.py --write     # makes the tables
    python validation/films/fit_oracle.py --check     # recomputes and compares with them

fit_data.csv: the reflectance at normal incidence from air of an absorbing film (n 2.1, k 0.03) of 187.3 nm, an air gap
of 43.1 nm, and a substrate (n 3.9, k 0.05), at 61 wavelengths, with noise of 0.4 % and 0.0005 of a fixed seed, and the
standard deviation of each value. fit_tauc_data.csv: the same of an amorphous semiconductor of 152.4 nm on glass (n 1.52),
a Tauc-Lorentz oscillator (by pyElli) of amplitude 96 eV and gap 1.83 eV.
fit.csv and fit_tauc.csv: the values of the fitted numbers at the minimum of chi-square, their standard errors
sqrt(diag((J^T J)^-1)), correlations, chi-square, and the intervals of 95 % of the profile likelihood, whose ends are roots of
the increase of the smallest chi-square with one value held.
"""

import pathlib
import sys

import elli
import numpy as np
import tmm
from scipy.optimize import brentq, least_squares

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent))

import oracle  # noqa: E402

NM = np.arange(400.0, 701.0, 5.0)
QUANTILE = 1.959963985


def over_gap(values):
    thickness, gap, k = values
    indices = [1.0, 2.1 + 1j * k, 1.0, 3.9 + 0.05j]
    lengths = [np.inf, thickness, gap, np.inf]
    return np.array([tmm.coh_tmm("s", indices, lengths, 0.0, nm)["R"] for nm in NM])


def amorphous(values):
    thickness, amplitude, gap = values
    model = elli.TaucLorentz(Eg=gap)
    model.add(A=amplitude, E=3.6, C=2.3)
    index = np.sqrt(1.2 + np.asarray(model.dielectric_function(NM)))
    lengths = [np.inf, thickness, np.inf]
    return np.array([tmm.coh_tmm("s", [1.0, n, 1.52], lengths, 0.0, nm)["R"] for n, nm in zip(index, NM)])


# Name of the files, reflectance, names of its numbers, their true values, steps of derivatives, and scales.
CASES = [
    ("fit", over_gap, ["thickness", "gap", "k"], [187.3, 43.1, 0.03], [1e-3, 1e-3, 1e-6], [1.0, 1.0, 1e-3]),
    ("fit_tauc", amorphous, ["thickness", "amplitude", "gap"], [152.4, 96.0, 1.83], [1e-3, 1e-3, 1e-5], [1.0, 1.0, 1e-2]),
]


def data(reflectance, true):
    exact = reflectance(true)
    deviation = np.round(np.hypot(0.004 * exact, 5e-4), 6)
    noise = np.random.default_rng(20260117).standard_normal(len(NM))
    return np.round(exact + deviation * noise, 6), deviation


def fitted(reflectance, measured, deviation, start, scales, held=None):
    """Values at the minimum; one may be held at its start."""
    free = [k for k in range(3) if k != held]

    def residuals(of_free):
        values = np.array(start, dtype=float)
        values[free] = of_free
        return (reflectance(values) - measured) / deviation

    found = least_squares(
        residuals, np.array(start)[free], x_scale=np.array(scales)[free], jac="3-point",
        xtol=1e-14, ftol=1e-14, gtol=1e-14,
    )
    values = np.array(start, dtype=float)
    values[free] = found.x
    return values, 2 * found.cost


def tables(name, reflectance, keys, true, steps, scales):
    measured, deviation = data(reflectance, np.array(true))
    best, chi_square = fitted(reflectance, measured, deviation, true, scales)
    jacobian = np.empty((len(NM), 3))
    for k in range(3):
        step = np.eye(3)[k] * steps[k]
        jacobian[:, k] = (reflectance(best + step) - reflectance(best - step)) / (2 * steps[k]) / deviation
    covariance = np.linalg.inv(jacobian.T @ jacobian)
    error = np.sqrt(np.diag(covariance))
    correlation = covariance / np.outer(error, error)

    def end(k, side):
        def excess(distance):
            start = best.copy()
            start[k] += side * distance * error[k]
            increase = fitted(reflectance, measured, deviation, start, scales, k)[1] - chi_square
            return np.sqrt(max(increase, 0)) - QUANTILE

        return best[k] + side * error[k] * brentq(excess, 1.0, 4.0, xtol=1e-5)

    rows = [["key", "value", "standard_error", "from_95", "to_95", *(f"with_{key}" for key in keys)]]
    for k, key in enumerate(keys):
        numbers = [best[k], error[k], end(k, -1), end(k, 1), *correlation[k]]
        rows.append([key, *(f"{number:.9g}" for number in numbers)])
    rows.append(["chi_square", f"{chi_square:.9g}", "", "", "", "", "", ""])
    table = [["state", "wavelength_nm", "reflectance_factor", "standard_deviation"]]
    table += [["film", f"{nm:g}", f"{r:.6f}", f"{d:.6f}"] for nm, r, d in zip(NM, measured, deviation)]
    return [(f"{name}_data.csv", table, 1e-9), (f"{name}.csv", rows, 1e-5)]


oracle.main(__doc__, HERE, [table for case in CASES for table in tables(*case)], 1e-6)
