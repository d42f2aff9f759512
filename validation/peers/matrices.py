"""Layered matrices: a pane over a white shade in pywincalc.

One unit of work: the reflectance of a pane of index 1.5 above a matte, opaque shade at normal incidence, at
81 wavelengths. pywincalc multiplies matrices over the 145 patches of Klems' full basis; a woven shade without
openings is its matte layer.
"""

import numpy as np


def problem(given):
    return given


def with_pywincalc(given):
    import pywincalc

    # Two interfaces of index 1.5, without interference.
    interface = ((given["index"] - 1) / (given["index"] + 1)) ** 2
    reflected, passed = 2 * interface / (1 + interface), (1 - interface) / (1 + interface)

    def layer(passed, reflected, thickness):
        data = [
            pywincalc.WavelengthData(nm / 1000, passed, reflected, reflected) for nm in given["wavelengths_nm"]
        ]
        return pywincalc.ProductDataOpticalNBand(
            pywincalc.MaterialType.MONOLITHIC, thickness, data, None, 0.0, 0.0, 0.84, 0.84, 0.0, False
        )

    def solid(optical, thickness):
        thermal = pywincalc.ProductDataThermal(1.0, thickness, False)
        return pywincalc.ProductDataOpticalAndThermal(optical, thermal)

    pane = solid(layer(passed, reflected, 0.003), 0.003)
    closed = pywincalc.WovenGeometry(0.001, 0.0010001, 0.0)
    matte = pywincalc.ProductDataOpticalWovenShade(layer(0.0, given["reflectance"], 0.001), closed)
    system = pywincalc.GlazingSystem(
        solid_layers=[pane, solid(matte, 0.001)],
        gap_layers=[pywincalc.Layers.gap(thickness=0.01)],
        bsdf_hemisphere=pywincalc.BSDFHemisphere.create(pywincalc.BSDFBasisType.FULL),
    )
    front = system.optical_method_results("PHOTOPIC", 0.0, 0.0).system_results.front.reflectance
    return np.array([front.direct_hemispherical])


PEERS = {"pywincalc": with_pywincalc}
