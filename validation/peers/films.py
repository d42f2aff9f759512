"""Thin films: the reference pixel's reflectance in tmm, tmm_fast, PyMoosh and pyElli.

One unit of work: the mean of the reflectances of both polarisations of one film at all its gaps, wavelengths and
angles, `[angle][gap][wavelength]`, from the indices of its layers. Behind the film's metal there is a medium without
absorption, as tmm_fast requires.
"""

import numpy as np


def problem(given):
    """The film as arrays: indices `[layer][wavelength]` with both outer media, thicknesses with the gap as NaN."""
    wavelengths = np.array(given["wavelengths_nm"])
    indices = np.array(given["index_n"]) + 1j * np.array(given["index_k"])
    return {
        "wavelengths": wavelengths,
        "indices": indices.reshape(-1, wavelengths.size),
        "thicknesses": np.array(given["thicknesses_nm"]),
        "gaps": np.array(given["gaps_nm"]),
        "angles": np.radians(given["angles_deg"]),
    }


def at_gap(film, gap):
    return np.where(np.isnan(film["thicknesses"]), gap, film["thicknesses"])


def with_tmm(film):
    import tmm

    def reflectance(angle, gap, bin):
        layers = [np.inf, *at_gap(film, gap), np.inf]
        indices, wavelength = film["indices"][:, bin], film["wavelengths"][bin]
        return sum(tmm.coh_tmm(p, indices, layers, angle, wavelength)["R"] for p in "sp") / 2

    bins = range(film["wavelengths"].size)
    return np.array([[[reflectance(a, g, b) for b in bins] for g in film["gaps"]] for a in film["angles"]])


def with_tmm_fast(film):
    import tmm_fast

    stacks = np.repeat(film["indices"][None], film["gaps"].size, axis=0)
    layers = np.array([[np.inf, *at_gap(film, gap) * 1e-9, np.inf] for gap in film["gaps"]])
    both = [
        tmm_fast.coh_tmm(p, stacks, layers, film["angles"], film["wavelengths"] * 1e-9)["R"] for p in "sp"
    ]
    return np.asarray(sum(both) / 2).transpose(1, 0, 2)


def with_pymoosh(film):
    import PyMoosh

    permittivities, count = film["indices"] ** 2, film["indices"].shape[0]

    def reflectance(angle, gap, bin):
        thicknesses = [0, *at_gap(film, gap), 0]
        stack = PyMoosh.Structure(list(permittivities[:, bin]), list(range(count)), thicknesses, verbose=False)
        wavelength = film["wavelengths"][bin]
        return sum(PyMoosh.coefficient_S(stack, wavelength, angle, p)[2] for p in (0, 1)) / 2

    bins = range(film["wavelengths"].size)
    return np.array([[[reflectance(a, g, b) for b in bins] for g in film["gaps"]] for a in film["angles"]])


def with_pyelli(film):
    import elli

    def material(index):
        table = elli.Table(film["wavelengths"], index)
        return elli.IsotropicMaterial(table)

    front, *inner, back = [material(index) for index in film["indices"]]

    def reflectance(angle, gap):
        layers = [elli.Layer(m, d) for m, d in zip(inner, at_gap(film, gap))]
        stack = elli.Structure(front, layers, back)
        return stack.evaluate(film["wavelengths"], np.degrees(angle), solver=elli.Solver2x2).R

    return np.array([[reflectance(angle, gap) for gap in film["gaps"]] for angle in film["angles"]])


def from_python(film):
    """Papilio's own package, on one thread."""
    import papilio.films

    front, *inner, back = film["indices"]
    gap = film["gaps"][:, None]
    layers = [(n, gap if np.isnan(nm) else nm) for n, nm in zip(inner, film["thicknesses"])]
    angles = np.degrees(film["angles"])[:, None, None]
    options = {"incidence": front.real, "substrate": back, "threads": 1}
    return papilio.films.reflectance(layers, film["wavelengths"], angles, **options)


PEERS = {"tmm": with_tmm, "tmm_fast": with_tmm_fast, "PyMoosh": with_pymoosh, "pyElli": with_pyelli}
