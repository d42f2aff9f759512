"""Pixel designs: from layers to the gamut, in tmm_fast and colour-science.

One unit of work: for each of the given designs (thicknesses of the reference pixel's film and its gaps) the film's reflectance along
the normal in glass at all gaps and wavelengths, the eight states' spectra, their XYZ under D65, and the area of the gamut in u'v' over
that of sRGB, %. Only the bare film: without diffuser, front, and light from several directions.
"""

import numpy as np

# Fractions of red, green, blue and dark in white, black, red, green, blue, cyan, magenta, yellow.
ON = np.array([[1, 1, 1], [0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 1, 1], [1, 0, 1], [1, 1, 0]])
SRGB = np.array([[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]])


def problem(given):
    wavelengths = np.array(given["wavelengths_nm"])
    indices = np.array(given["index_n"]) + 1j * np.array(given["index_k"])
    return {
        "wavelengths": wavelengths,
        "indices": indices.reshape(-1, wavelengths.size),
        # [design][gap][layer]
        "thicknesses": np.array(given["designs_nm"]).reshape(-1, 4, indices.size // wavelengths.size - 2),
        "areas": np.array(given["areas"]),
        "light": np.array(given["light"]),
    }


def reflectance(work):
    """Returns the reflectance, shape `[design][gap][wavelength]`; at normal incidence both polarisations are equal."""
    import tmm_fast

    designs, gaps, layers = work["thicknesses"].shape
    inner = work["thicknesses"].reshape(designs * gaps, layers) * 1e-9
    outer = np.full((designs * gaps, 1), np.inf)
    stacks = np.repeat(work["indices"][None], designs * gaps, axis=0)
    found = tmm_fast.coh_tmm("s", stacks, np.hstack([outer, inner, outer]), np.zeros(1), work["wavelengths"] * 1e-9)
    return np.asarray(found["R"]).reshape(designs, gaps, -1)


def gamut(work, by_gap):
    """Returns the gamut of each design, %."""
    import colour

    shape = colour.SpectralShape(380, 780, 1)
    cmfs = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(shape)
    on = ON * work["areas"]
    shares = np.column_stack([on, 1 - on.sum(axis=1)])
    states = np.einsum("sg,dgw->dsw", shares, by_gap)
    # Radiance, interpolated linearly from the grid to 1 nm, as in Papilio.
    bins = work["wavelengths"].size
    fine = np.array([np.interp(shape.range(), work["wavelengths"], row) for row in np.eye(bins)])
    light = np.interp(work["wavelengths"], shape.range(), work["light"])
    spectra = (states.reshape(-1, bins) * light) @ fine
    xyz = colour.msds_to_XYZ(spectra, cmfs=cmfs, k=1, method="Integration", shape=shape)
    total = xyz @ [1, 15, 3]
    uv = np.column_stack([4 * xyz[:, 0] / total, 9 * xyz[:, 1] / total]).reshape(-1, len(ON), 2)
    x, y = SRGB.T
    srgb = np.column_stack([4 * x, 9 * y]) / (-2 * x + 12 * y + 3)[:, None]
    return 100 * area(uv[:, 2:5]) / area(srgb)


def area(corners):
    a, b, c = np.moveaxis(corners, -2, 0)
    return 0.5 * np.abs((b - a)[..., 0] * (c - a)[..., 1] - (b - a)[..., 1] * (c - a)[..., 0])


def with_tmm_fast(work):
    return gamut(work, reflectance(work))


PEERS = {"tmm_fast + colour-science": with_tmm_fast}
