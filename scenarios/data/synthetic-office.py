"""Writes synthetic-office.hdr: a made-up office, 64 x 32 pixels, for scenarios/map.toml.

Synthetic: walls, a floor, ceiling lamps and a window, invented for this example; by formula, no photograph.
Run it in this folder: python3 synthetic-office.py
"""

import math

WIDTH, HEIGHT = 64, 32


def radiance(elevation, azimuth):
    """Linear sRGB by direction; azimuth in degrees from the middle of the picture, to the right."""
    if elevation < 0:
        return (0.06, 0.05, 0.04)  # a carpet
    wall = 0.25 + 0.1 * math.sin(math.radians(elevation))
    if 50 < elevation < 62 and -60 < azimuth % 120 - 60 < 30:
        return (9.0, 8.4, 7.2)  # lamps in the ceiling, warm
    if 5 < elevation < 40 and 70 < azimuth < 110:
        return (2.2, 2.9, 4.0)  # a window, blue sky
    return (wall, 0.95 * wall, 0.85 * wall)


def rgbe(colour):
    """Three mantissas and an exponent."""
    largest = max(colour)
    mantissa, exponent = math.frexp(largest)
    scale = mantissa * 256 / largest
    return bytes([int(value * scale) for value in colour] + [exponent + 128])


with open("synthetic-office.hdr", "wb") as file:
    file.write(b"#?RADIANCE\n# Synthetic: see synthetic-office.py\nFORMAT=32-bit_rle_rgbe\n\n")
    file.write(f"-Y {HEIGHT} +X {WIDTH}\n".encode())
    for row in range(HEIGHT):
        # Rows of this width may be plain: no pixel begins with 2, 2.
        for column in range(WIDTH):
            elevation = 90 - 180 * (row + 0.5) / HEIGHT
            file.write(rgbe(radiance(elevation, 360 * (column + 0.5) / WIDTH - 180)))
