#!/usr/bin/env python3
"""Renders the display of this folder with Mitsuba 3: a panel and a ball on a desk, in a room or in a map of light.

    pip install mitsuba
    python scene.py                                  # scene.png and scene.exr, beside this file
    python scene.py --state black --out black.png
    python scene.py --picture photograph.png         # a picture on the panel
    python scene.py --image out/page                 # the pixels that `papilio image` wrote into this folder
    python scene.py --light garden.exr               # a map of the whole sphere (EXR or HDR), also one with a channel per wavelength

`papilio brdf --format rgl` wrote this file, the scattered light of each state (display-STATE.bsdf) and the mirror parts
(display-mirror.json). Wavelengths are those of the scenario: the colours are computed from spectra, not from R, G, B.

--picture mixes the states black, red, green, blue, cyan, magenta, yellow and white. Each pixel of the picture states which fraction of
the red, green and blue areas is on; the reflectance of a display is the sum over its areas, so that the mixture is exact. A display
with the states black and white, but not these eight, shows the luminance of the picture.

--image shows states.png of `papilio image`, a halftone in any states: each pixel of the panel is in one of them.

The mirror part is a conductor: its reflectance has the spectrum along the normal, and the dependence on the angle of the Fresnel
reflection that fits it at 60 deg. Its mirror images are blurred by about 1 deg, because Mitsuba does not weight the samples of a
blendbsdf correctly if one of its materials is a perfect mirror. display-mirror.json has the exact values.

The variant scalar_spectral needs no other software. llvm_ad_spectral is faster and needs the library LLVM, version 19 or newer;
older ones may end the program on processors with AVX-512. DRJIT_LIBLLVM_PATH names the file of the library.
"""

from __future__ import annotations

import argparse
import array
import ctypes
import json
import operator
import re
import struct
import sys
import tempfile
import zlib
from pathlib import Path

TITLE = @TITLE@
HERE = Path(__file__).resolve().parent
MIRROR = "display-mirror.json"
#: Corner states of a picture: [red][green][blue] areas off or on.
CORNERS = [[["black", "blue"], ["green", "cyan"]], [["red", "magenta"], ["yellow", "white"]]]
#: Linear red, green and blue of sRGB (IEC 61966-2-1) of X, Y and Z.
SRGB_OF_XYZ = [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]]
#: Roughness of the mirror part.
ROUGHNESS = 0.01
#: Mirror parts below this fraction are not rendered.
FAINT = 1e-5


def main() -> None:
    arguments = parsed()
    try:
        import mitsuba as mi
    except ImportError:
        sys.exit("scene.py needs Mitsuba: pip install mitsuba")
    mi.set_variant("scalar_spectral")
    light = None if arguments.light == "room" else light_map(mi, Path(arguments.light))
    mi.set_variant(arguments.variant)
    mirror = json.loads((HERE / MIRROR).read_text(encoding="utf-8"))
    state = chosen(arguments.state, mirror["states"])
    with tempfile.TemporaryDirectory() as folder:
        display = Display(mirror, Path(folder))
        material = display.material(state)
        panel = material
        size = [1.5, 1.0]
        if arguments.picture is not None:
            shares, size = split_picture(mi, arguments.picture, Path(folder))
            panel = picture(display, shares)
        elif arguments.image is not None:
            coverages, columns, rows = image_coverages(arguments.image)
            panel = mixture(display, coverages, columns)
            size = [columns / rows, 1.0]
        scene = mi.load_dict(scene_of(mi, arguments, light, panel, material, size))
        image = mi.render(scene, spp=arguments.samples, seed=arguments.seed)
    out = arguments.out
    mi.util.write_bitmap(str(out.with_suffix(".exr")), image)
    if out.suffix.lower() != ".exr":
        mi.util.write_bitmap(str(out), image)
    print(f"{TITLE}, {arguments.picture or arguments.image or state}: wrote {out}")


def parsed() -> argparse.Namespace:
    text = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=text)
    parser.add_argument("--state", help="state of the ball, and of the panel without --picture and --image (default: white, or the first)")
    shown = parser.add_mutually_exclusive_group()
    shown.add_argument("--picture", type=Path, help="picture on the panel (PNG, JPEG, EXR)")
    shown.add_argument("--image", type=Path, metavar="FOLDER", help="folder of papilio image, whose states.png is shown on the panel")
    parser.add_argument("--light", default="room", help="room, or the file of a map of the whole sphere (default: room)")
    parser.add_argument("--out", type=Path, default=HERE / "scene.png", help="picture to write (default: scene.png beside this file)")
    parser.add_argument("--width", type=int, default=480, help="width in pixels (default: 480)")
    parser.add_argument("--samples", type=int, default=64, help="paths per pixel (default: 64)")
    parser.add_argument("--seed", type=int, default=0, help="seed of the random numbers (default: 0)")
    parser.add_argument("--exposure", type=float, default=1.0, help="factor of all light (default: 1)")
    parser.add_argument("--tilt", type=float, default=40.0, help="angle between the panel and the desk, degrees (default: 40)")
    parser.add_argument("--variant", default="scalar_spectral", help="variant of Mitsuba (default: scalar_spectral)")
    arguments = parser.parse_args()
    if "spectral" not in arguments.variant:
        parser.error(f"--variant {arguments.variant}: expected a spectral variant, such as llvm_ad_spectral")
    return arguments


def chosen(name: str | None, states: dict) -> str:
    if name is None:
        return "white" if "white" in states else next(iter(states))
    if name not in states:
        sys.exit(f"--state {name}: expected one of {', '.join(states)}")
    return name


class Display:
    """The materials of the states."""

    def __init__(self, mirror: dict, folder: Path) -> None:
        self.mirror = mirror
        self.folder = folder

    def material(self, state: str) -> dict:
        """Scattered light and mirror part of a state, as a weighted sum of two materials whose weights sum to 1."""
        found = self.mirror["states"].get(state)
        if found is None:
            sys.exit(f"there is no state {state}; papilio brdf --format rgl --states all writes all states")
        along_normal = found["specular"][0]
        at_60 = self.near(found["specular"], 60.0)
        total = mean(self.near(found["directional_hemispherical"], 30.0))
        if max(max(spectrum) for spectrum in found["specular"]) < FAINT or total <= 0.0:
            return {"type": "measured", "filename": str(HERE / found["file"])}
        weight = min(max(mean(self.near(found["specular"], 30.0)) / total, 0.02), 1.0)
        scattered = total * (1.0 - weight) >= FAINT
        weight = min(weight, 0.98) if scattered else 1.0
        index = fitted_index(mean(at_60) / max(mean(along_normal), 1e-12))
        at_normal = fresnel(index, 0.0) if index is not None else 1.0
        reflectance = self.spectrum([value / (weight * at_normal) for value in along_normal])
        conductor = {"type": "roughconductor", "alpha": ROUGHNESS, "specular_reflectance": reflectance}
        if index is None:
            conductor["material"] = "none"
        else:
            conductor |= {"eta": uniform(index), "k": uniform(0.0)}
        if not scattered:
            return conductor
        file = self.folder / found["file"]
        if not file.exists():
            file.write_bytes(scaled((HERE / found["file"]).read_bytes(), 1.0 / (1.0 - weight)))
        first = {"type": "measured", "filename": str(file)}
        return {"type": "blendbsdf", "weight": weight, "bsdf_0": first, "bsdf_1": conductor}

    def near(self, spectra: list, theta_deg: float) -> list:
        """The spectrum at the nearest inclination."""
        distances = [abs(theta - theta_deg) for theta in self.mirror["theta_i_deg"]]
        return spectra[distances.index(min(distances))]

    def spectrum(self, values: list) -> dict:
        nm = ", ".join(str(value) for value in self.mirror["wavelength_nm"])
        return {"type": "irregular", "wavelengths": nm, "values": ", ".join(f"{value:.6g}" for value in values)}


def uniform(value: float) -> dict:
    return {"type": "uniform", "value": value}


def mean(values: list) -> float:
    return sum(values) / max(len(values), 1)


def fresnel(index: float, theta_deg: float) -> float:
    """Reflectance of a dielectric for unpolarised light."""
    import math

    cos_i = math.cos(math.radians(theta_deg))
    cos_t = math.sqrt(1.0 - (1.0 - cos_i * cos_i) / index**2)
    s = (cos_i - index * cos_t) / (cos_i + index * cos_t)
    p = (index * cos_i - cos_t) / (index * cos_i + cos_t)
    return 0.5 * (s * s + p * p)


def fitted_index(ratio: float) -> float | None:
    """Index of a dielectric whose reflectance increases by this factor from 0 to 60 deg; None if that of none does."""
    low, high = 1.3, 4.0
    rise = [fresnel(index, 60.0) / fresnel(index, 0.0) for index in (low, high)]
    if ratio <= rise[1]:
        return None
    for _ in range(40):
        middle = 0.5 * (low + high)
        if fresnel(middle, 60.0) / fresnel(middle, 0.0) > ratio:
            low = middle
        else:
            high = middle
    return low


def scaled(tensors: bytes, factor: float) -> bytes:
    """A tensor file whose spectra are multiplied by a factor."""
    (count,) = struct.unpack_from("<I", tensors, 14)
    at = 18
    for _ in range(count):
        (length,) = struct.unpack_from("<H", tensors, at)
        name = tensors[at + 2 : at + 2 + length]
        at += 2 + length
        dimensions, _kind, offset = struct.unpack_from("<HBQ", tensors, at)
        shape = struct.unpack_from(f"<{dimensions}Q", tensors, at + 11)
        at += 11 + 8 * dimensions
        if name == b"spectra":
            size = 4
            for edge in shape:
                size *= edge
            values = floats(tensors[offset : offset + size])
            values = array.array("f", [factor * value for value in values])
            return tensors[:offset] + little(values).tobytes() + tensors[offset + size :]
    sys.exit("a file of the display has no spectra")


def floats(data: bytes) -> array.array:
    return little(array.array("f", data))


def little(values: array.array) -> array.array:
    if sys.byteorder == "big":
        values.byteswap()
    return values


def split_picture(mi, path: Path, folder: Path) -> tuple[dict[str, Path], list[float]]:
    """Textures with the linear red, green, blue and grey of a picture, and the size of the panel in units of its height."""
    if not path.exists():
        sys.exit(f"--picture {path}: there is no such file")
    bitmap = mi.Bitmap(str(path)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False)
    width, height = bitmap.size()
    whole = folder / "picture.pfm"
    bitmap.write(str(whole))
    data = whole.read_bytes()
    # The header has three lines; a negative scale means little-endian numbers.
    header, values = data[: -12 * width * height], array.array("f", data[-12 * width * height :])
    if (float(header.split()[-1]) < 0.0) != (sys.byteorder == "little"):
        values.byteswap()
    # The file begins with the lowest row.
    rows = range(0, len(values), 3 * width)
    values = sum((values[row : row + 3 * width] for row in reversed(rows)), array.array("f"))
    channels = {name: clipped(values[channel::3]) for channel, name in enumerate(("red", "green", "blue"))}
    # Luminance of linear sRGB.
    parts = zip(channels["red"], channels["green"], channels["blue"])
    channels["grey"] = array.array("f", [0.2126 * r + 0.7152 * g + 0.0722 * b for r, g, b in parts])
    files = {name: texture(share, width, folder / f"{name}.pfm") for name, share in channels.items()}
    return files, [width / height, 1.0]


def clipped(values: array.array) -> array.array:
    return array.array("f", [min(max(value, 0.0), 1.0) for value in values])


def texture(values: array.array, columns: int, path: Path) -> Path:
    """Writes numbers, the upper row first, as a texture."""
    # Mitsuba reads the first row of this file as the last one of the texture, which is at the upper edge of a rectangle.
    path.write_bytes(f"Pf\n{columns} {len(values) // columns}\n-1.0\n".encode() + little(values[:]).tobytes())
    return path


def blend(first: dict, second: dict, weight: Path) -> dict:
    """Two materials; `weight` is the texture with the fraction of the second one."""
    bitmap = {"type": "bitmap", "filename": str(weight), "raw": True, "filter_type": "nearest", "wrap_mode": "clamp"}
    return {"type": "blendbsdf", "weight": bitmap, "bsdf_0": first, "bsdf_1": second}


def picture(display: Display, shares: dict[str, Path]) -> dict:
    """The exact mixture of the eight corner states, or of black and white."""
    material = display.material
    states = display.mirror["states"]
    if any(state not in states for by_green in CORNERS for by_blue in by_green for state in by_blue):
        if "black" in states and "white" in states:
            return blend(material("black"), material("white"), shares["grey"])
        sys.exit("--picture needs the states black and white; papilio image and --image show a picture in any states")
    by_blue = [[blend(material(off), material(on), shares["blue"]) for off, on in by_green] for by_green in CORNERS]
    by_green = [blend(off, on, shares["green"]) for off, on in by_blue]
    return blend(by_green[0], by_green[1], shares["red"])


def mixture(display: Display, coverages: dict[str, array.array], columns: int) -> dict:
    """The exact mixture of any states; `coverages` has the fraction of each state in each pixel, the upper row first."""
    found = None
    for state, weight in blend_weights(coverages):
        material = display.material(state)
        if found is None:
            found = material
        else:
            name = f"weight-{list(coverages).index(state)}.pfm"
            found = blend(found, material, texture(weight, columns, display.folder / name))
    return found


def blend_weights(coverages: dict[str, array.array]) -> list[tuple[str, array.array]]:
    """The weights with which each state is blended with the mixture of those before it: its fraction of their sum.

    State k then has its weight times the product of (1 - weight) of all later states, which is its coverage. States that no pixel
    shows are left out.
    """
    found = []
    sums = None
    for state, coverage in coverages.items():
        if not any(coverage):
            continue
        sums = coverage if sums is None else array.array("f", map(operator.add, sums, coverage))
        found.append((state, array.array("f", [own / all_ if own > 0.0 else 0.0 for own, all_ in zip(coverage, sums)])))
    return found


def image_coverages(folder: Path) -> tuple[dict[str, array.array], int, int]:
    """The coverages of the states in each pixel of states.png, with the numbers of columns and rows."""
    try:
        # In the order of the palette of states.png.
        states = list(json.loads((folder / "image.json").read_text(encoding="utf-8"))["coverage"] or {})
        columns, rows, pixels = indexed_png((folder / "states.png").read_bytes())
    except (OSError, LookupError, ValueError, TypeError, struct.error, zlib.error) as error:
        sys.exit(f"--image {folder}: expected image.json and states.png of papilio image with a halftone: {error}")
    if pixels and max(pixels) >= len(states):
        sys.exit(f"--image {folder}: states.png has {max(pixels) + 1} states, image.json {len(states)}")
    is_state = [bytes(int(number == k) for number in range(256)) for k in range(len(states))]
    coverages = {state: array.array("f", list(pixels.translate(is_state[k]))) for k, state in enumerate(states)}
    return coverages, columns, rows


def indexed_png(data: bytes) -> tuple[int, int, bytes]:
    """Columns, rows and numbers of the colours of a PNG with a palette of 8 bits."""
    at, packed, header = 8, b"", None
    while at + 8 <= len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        if kind == b"IHDR":
            header = struct.unpack_from(">IIBBBBB", data, at + 8)
        elif kind == b"IDAT":
            packed += data[at + 8 : at + 8 + length]
        at += 12 + length
    if header is None or header[2:] != (8, 3, 0, 0, 0):
        raise ValueError("states.png is not a picture with a palette")
    columns, rows = header[:2]
    filtered = zlib.decompress(packed)
    if len(filtered) != rows * (columns + 1):
        raise ValueError("states.png is cut off")
    before, pixels = bytes(columns), []
    for start in range(0, len(filtered), columns + 1):
        before = unfiltered(filtered[start], filtered[start + 1 : start + 1 + columns], before)
        pixels.append(before)
    return columns, rows, b"".join(pixels)


def unfiltered(kind: int, row: bytes, above: bytes) -> bytes:
    """A row of a PNG without its filter, with one byte for each pixel."""
    if kind == 0:
        return row
    found = bytearray()
    left = corner = 0
    for value, up in zip(row, above):
        guess = left + up - corner
        nearest = min((left, up, corner), key=lambda candidate: abs(guess - candidate))
        left = (value + (left, up, (left + up) // 2, nearest)[kind - 1]) % 256
        corner = up
        found.append(left)
    return bytes(found)


def scene_of(mi, arguments: argparse.Namespace, light, panel: dict, ball: dict, size: list[float]) -> dict:
    """Lengths in metres; z is up, the viewer looks along y. The panel is 16 cm high."""
    T = mi.ScalarTransform4f
    half = [0.08 * size[0], 0.08]
    foot = T().translate([-0.055, 0.0, 0.004]).rotate([1, 0, 0], arguments.tilt)
    scene = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 8},
        "sensor": {
            "type": "perspective",
            "fov": 38.0,
            "to_world": T().look_at(origin=[0.0, -0.55, 0.4], target=[0.0, 0.05, 0.04], up=[0, 0, 1]),
            "film": {"type": "hdrfilm", "width": arguments.width, "height": max(arguments.width * 2 // 3, 1)},
            "sampler": {"type": "independent"},
        },
        "panel": {
            "type": "rectangle",
            "to_world": foot @ T().translate([0.0, half[1], 0.0]).scale([half[0], half[1], 1.0]),
            "bsdf": panel,
        },
        "ball": {"type": "sphere", "center": [half[0], 0.02, 0.045], "radius": 0.045, "bsdf": ball},
        "desk": {
            "type": "rectangle",
            "to_world": T().scale([0.8, 0.5, 1.0]),
            "bsdf": {"type": "diffuse", "reflectance": uniform(0.25)},
        },
    }
    if light is None:
        return scene | room(T, arguments.exposure)
    up = T().rotate([1, 0, 0], 90)
    sky = {"type": "envmap", "bitmap": light, "scale": arguments.exposure, "to_world": up}
    return scene | {"sky": sky}


def light_map(mi, path: Path):
    """A map of the whole sphere as a bitmap of red, green and blue, or grey.

    Mitsuba's maps have no spectra. A map with one channel per wavelength becomes one with its X, Y and Z, of which Mitsuba makes smooth
    spectra; a map of constant radiance 1 has a luminance of 1.
    """
    if not path.exists():
        sys.exit(f"--light {path}: expected room, or a file (EXR or HDR) that exists")
    try:
        bitmap = mi.Bitmap(str(path))
    except RuntimeError as error:
        sys.exit(f"--light {path}: {error}")
    if bitmap.pixel_format() != mi.Bitmap.PixelFormat.MultiChannel:
        return bitmap
    names = [field.name for field in bitmap.struct_()]
    weights = channel_weights(mi, names)
    if weights is None:
        channels = ", ".join(names[:12])
        sys.exit(f"--light {path}: expected channels R, G and B, or Y, or wavelengths (S0.550,0nm); it has {channels}")
    import drjit

    (columns, rows), values = bitmap.size(), array.array("f")
    for row in channel_rows(bitmap, len(names)):
        found = []
        for own in weights:
            color = [0.0] * columns
            for channel, weight in enumerate(own):
                if weight != 0.0:
                    color = [sum_ + weight * value for sum_, value in zip(color, row[channel :: len(names)])]
            found.append(color)
        # Colours outside the gamut of sRGB have no spectrum in Mitsuba.
        values.extend(max(value, 0.0) for pixel in zip(*found) for value in pixel)
    return mi.Bitmap(mi.TensorXf(drjit.array_t(mi.TensorXf)(values.tolist()), (rows, columns, 3)))


def channel_weights(mi, names: list[str]) -> list[list[float]] | None:
    """The weights of the channels in linear red, green and blue; None if the channels are neither colours nor wavelengths."""
    found = [re.fullmatch(r"(?:S0\.)?(\d+(?:[.,]\d+)?)nm", name) for name in names]
    nm = [float(match.group(1).replace(",", ".")) if match else None for match in found]
    known = sorted(one for one in nm if one is not None)
    if len(known) > 1:
        print("scene.py: the map has a spectrum in each pixel; it is rendered with smooth spectra of the same X, Y and Z")
        xyz = {one: [0.0] * 3 for one in known}
        for low, high in zip(known, known[1:]):
            # Radiances are linear between the channels.
            steps = max(int(high - low), 1)
            for step in range(steps):
                t = (step + 0.5) / steps
                for k, bar in enumerate(mi.cie1931_xyz(low + t * (high - low))):
                    xyz[low][k] += (1.0 - t) * float(bar) * (high - low) / steps
                    xyz[high][k] += t * float(bar) * (high - low) / steps
        bars = [[0.0] * 3 if one is None else xyz[one] for one in nm]
        # The integral of y-bar is 106.857 nm.
        return [[sum(a * b for a, b in zip(row, own)) / 106.857 for own in bars] for row in SRGB_OF_XYZ]
    if {"R", "G", "B"} <= set(names):
        return [[float(name == color) for name in names] for color in "RGB"]
    return None


def channel_rows(bitmap, channels: int):
    """The rows of a bitmap as numbers, with the channels of each pixel together."""
    columns, rows = bitmap.size()
    about = bitmap.__array_interface__
    kind = about["typestr"]
    code = {"f2": "e", "f4": "f", "u4": "I"}[(kind.decode() if isinstance(kind, bytes) else kind)[1:]]
    layout = struct.Struct(f"={columns * channels}{code}")
    for row in range(rows):
        yield layout.unpack(ctypes.string_at(about["data"][0] + row * layout.size, layout.size))


def room(T, exposure: float) -> dict:
    """A room of 4 m x 4 m x 2.6 m with two lamps on the ceiling and a window on the left; the desk is 0.75 m high."""

    def wall(transform, reflectance: float) -> dict:
        return {"type": "rectangle", "to_world": transform, "bsdf": {"type": "diffuse", "reflectance": uniform(reflectance)}}

    def lamp(transform, radiance: float) -> dict:
        light = {"type": "area", "radiance": {"type": "d65", "scale": radiance * exposure}}
        return {"type": "rectangle", "to_world": transform, "emitter": light}

    middle = 0.55
    return {
        "floor": wall(T().translate([0, 0, -0.75]).scale([2, 2, 1]), 0.3),
        "ceiling": wall(T().translate([0, 0, 1.85]).rotate([1, 0, 0], 180).scale([2, 2, 1]), 0.8),
        "back": wall(T().translate([0, 2, middle]).rotate([1, 0, 0], 90).scale([2, 1.3, 1]), 0.6),
        "front": wall(T().translate([0, -2, middle]).rotate([1, 0, 0], -90).scale([2, 1.3, 1]), 0.6),
        "left": wall(T().translate([-2, 0, middle]).rotate([0, 1, 0], 90).scale([1.3, 2, 1]), 0.6),
        "right": wall(T().translate([2, 0, middle]).rotate([0, 1, 0], -90).scale([1.3, 2, 1]), 0.6),
        "lamp_1": lamp(T().translate([-0.7, 0.6, 1.84]).rotate([1, 0, 0], 180).scale([0.15, 0.6, 1]), 24.0),
        "lamp_2": lamp(T().translate([0.9, -0.6, 1.84]).rotate([1, 0, 0], 180).scale([0.15, 0.6, 1]), 24.0),
        "window": lamp(T().translate([-1.99, 0.2, 0.75]).rotate([0, 1, 0], 90).scale([0.6, 0.7, 1]), 6.0),
    }


if __name__ == "__main__":
    main()
