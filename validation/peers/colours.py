"""Colour: spectra to XYZ, L*a*b*, u'v' and differences in colour-science.

One unit of work: for each of the given reflectances (380 to 780 nm by 1 nm) under D65 and the CIE 1931 observer: XYZ,
L*a*b*, u'v', and the difference CIEDE2000 from the one before it.
"""

import numpy as np


def problem(given):
    return {"spectra": np.array(given["spectra"]).reshape(-1, 401), "light": np.array(given["light"])}


def with_colour_science(work):
    import colour

    shape = colour.SpectralShape(380, 780, 1)
    cmfs = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(shape)
    light = colour.SpectralDistribution(work["light"], shape.range())

    def xyz_of(spectra):
        return colour.msds_to_XYZ(
            spectra, cmfs=cmfs, illuminant=light, method="Integration", shape=shape
        )

    xyz = xyz_of(work["spectra"]) / 100
    white = xyz_of(np.ones((1, 401)))[0] / 100
    lab = colour.XYZ_to_Lab(xyz, colour.XYZ_to_xy(white))
    total = xyz @ [1, 15, 3]
    uv = np.column_stack([4 * xyz[:, 0] / total, 9 * xyz[:, 1] / total])
    difference = colour.delta_E(lab, np.roll(lab, 1, axis=0), method="CIE 2000")
    return np.column_stack([xyz, lab, uv, difference])


PEERS = {"colour-science": with_colour_science}
