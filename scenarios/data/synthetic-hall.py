"""Writes synthetic-hall.exr: a made-up hall, 48 x 24 pixels of eleven wavelengths, for scenarios/spectral-map.toml.

Synthetic: grey walls and a floor under a black body of 2900 K in the ceiling, a window with a blue sky; by formula, no measurement.
Channels are named as in Fichet et al., JCGT 10(3), 2021, and hold W/(m2 sr nm). Run it in this folder: python3 synthetic-hall.py
"""

import math
import struct

WIDTH, HEIGHT = 48, 24
WAVELENGTHS_NM = range(380, 781, 40)


def black_body(nm, kelvin):
    """Planck's law, 1 at 560 nm."""
    law = lambda nm: nm**-5.0 / math.expm1(1.4387769e7 / (nm * kelvin))
    return law(nm) / law(560.0)


def radiance(elevation, azimuth, nm):
    """W/(m2 sr nm) by direction; azimuth in degrees from the middle of the picture, to the right."""
    lamp, sky = black_body(nm, 2900.0), (560.0 / nm) ** 4.0 * black_body(nm, 5800.0)
    if elevation < 0:
        return 1.3e-4 * lamp
    if elevation > 60 and azimuth % 60 < 30:
        return 0.013 * lamp
    if 5 < elevation < 45 and 60 < azimuth < 120:
        return 2e-3 * sky
    return 5e-4 * (0.8 * lamp + 0.2 * sky)


def attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value


# In the order of their names, as the format wants it; half floats.
channels = sorted((f"S0.{nm},000000nm", nm) for nm in WAVELENGTHS_NM)
names = b"".join(name.encode() + b"\0" + struct.pack("<iBBBBii", 1, 0, 0, 0, 0, 1, 1) for name, _ in channels)
window = struct.pack("<iiii", 0, 0, WIDTH - 1, HEIGHT - 1)
header = b"\x76\x2f\x31\x01\x02\0\0\0" + b"".join(
    [
        attribute("channels", "chlist", names + b"\0"),
        attribute("compression", "compression", b"\0"),
        attribute("dataWindow", "box2i", window),
        attribute("displayWindow", "box2i", window),
        attribute("lineOrder", "lineOrder", b"\0"),
        attribute("pixelAspectRatio", "float", struct.pack("<f", 1.0)),
        attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0.0, 0.0)),
        attribute("screenWindowWidth", "float", struct.pack("<f", 1.0)),
        b"\0",
    ]
)
size = len(channels) * WIDTH * 2
start = len(header) + 8 * HEIGHT
with open("synthetic-hall.exr", "wb") as file:
    file.write(header)
    file.write(struct.pack(f"<{HEIGHT}Q", *(start + row * (8 + size) for row in range(HEIGHT))))
    for row in range(HEIGHT):
        elevation = 90 - 180 * (row + 0.5) / HEIGHT
        file.write(struct.pack("<ii", row, size))
        for _, nm in channels:
            line = [radiance(elevation, 360 * (column + 0.5) / WIDTH - 180, nm) for column in range(WIDTH)]
            file.write(struct.pack(f"<{WIDTH}e", *line))
