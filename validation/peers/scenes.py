"""Scenes: paper under an anti-glare interface in Mitsuba 3.

One unit of work: the reflectance factor from one direction, of each of 81 bands or of the luminous one, with a standard error
of 0.1 %. The variance of the path tracer is measured over independent renderings, and its time is scaled to that error. For
Mitsuba, this is the root mean square over the bands; Papilio must reach it in every band.
"""

import time

import numpy as np

# Extent and depth of the scene: paths inside the glass remain short.
WIDE, DEEP = 1000.0, 0.01
DISTANCE = 10_000.0
RENDERINGS = 24


def problem(given):
    return given


def towards(theta_deg):
    theta = np.radians(theta_deg)
    return np.array([np.sin(theta), 0.0, np.cos(theta)])


def scene(mi, given, luminous, light):
    """Returns a scene; `light`: "sky", "lamp", or "white" (the sky itself, viewed from below)."""
    nm = given["wavelengths_nm"]
    T = mi.ScalarTransform4f

    def regular(low, high, values):
        values = ",".join(f"{value:.9g}" for value in values)
        return {"type": "regular", "wavelength_min": low, "wavelength_max": high, "values": values}

    def band(k):
        half = (nm[1] - nm[0]) / 2
        return regular(max(nm[k] - half, nm[0]), min(nm[k] + half, nm[-1]), [1, 1])

    def looking(from_, **size):
        to = T().look_at(origin=from_.tolist(), target=[0, 0, 0], up=[0, 1, 0])
        return to.scale(**size) if size else to

    bands = {f"band_{k:03}": band(k) for k in range(len(nm))}
    if luminous:
        bands = {"luminous": regular(nm[0], nm[-1], given["luminous"])}
    eye = -towards(given["view_deg"]) if light == "white" else towards(given["view_deg"])
    parts = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 64, "rr_depth": 8},
        "sensor": {
            "type": "radiancemeter",
            "to_world": looking(eye),
            "film": {
                "type": "specfilm",
                "width": 1,
                "height": 1,
                "rfilter": {"type": "box"},
                "component_format": "float32",
                **bands,
            },
            "sampler": {"type": "independent", "sample_count": 1},
        },
    }
    even = regular(nm[0], nm[-1], [1, 1])
    if light == "lamp":
        radius = float(DISTANCE * np.tan(np.radians(given["lamp_radius_deg"])))
        way = towards(given["lamp_deg"]) * DISTANCE
        emitter = {"type": "area", "radiance": even}
        parts["lamp"] = {"type": "disk", "to_world": looking(way, v=radius), "emitter": emitter}
    else:
        parts["sky"] = {"type": "constant", "radiance": even}
    if light != "white":
        glass = {"alpha": given["alpha"], "int_ior": given["index"], "ext_ior": 1.0}
        face = {"type": "roughdielectric", "distribution": "ggx", **glass}
        parts["face"] = {"type": "rectangle", "to_world": T().scale(WIDE), "bsdf": face}
        paper = {"type": "diffuse", "reflectance": regular(nm[0], nm[-1], given["paper"])}
        below = T().translate([0, 0, -DEEP]).scale(WIDE)
        parts["paper"] = {"type": "rectangle", "to_world": below, "bsdf": paper}
    return mi.load_dict(parts)


def rendered(mi, given, luminous, light, samples):
    """Returns the CPU seconds of a rendering, and the values of all renderings."""
    world = scene(mi, given, luminous, light)

    def once(seed):
        # Reading the array waits for the end of the rendering.
        return np.array(mi.render(world, spp=samples, seed=seed)).ravel().astype(float)

    once(0)
    start = time.process_time()
    values = np.array([once(1 + seed) for seed in range(RENDERINGS)])
    return (time.process_time() - start) / RENDERINGS, values


def measured(variant, given, luminous, light):
    """Returns the seconds to a standard error of 0.1 %, and the reflectance factors."""
    import mitsuba as mi

    mi.set_variant(variant)
    samples = 4096 if variant.startswith("scalar") else 65536
    seconds, values = rendered(mi, given, luminous, light, samples)
    mean = values.mean(axis=0)
    error = np.sqrt(np.mean(values.var(axis=0, ddof=1) / mean**2))
    white = rendered(mi, given, luminous, "white", samples)[1].mean(axis=0)
    if light == "lamp":
        radius, theta = np.radians([given["lamp_radius_deg"], given["lamp_deg"]])
        white = white * np.sin(radius) ** 2 * np.cos(theta)
    return seconds * (error / 1e-3) ** 2, mean / white
