"""Pictures on panels of electronic paper: Papilio and free dithering programs, judged against the photograph.

    cargo xtask peers

runs this file with the path of `papilio`.

The judge shares nothing with Papilio: S-CIELAB of 1996 in numpy, CIEDE2000 of scikit-image. The reference is the photograph
as a good screen beside the panel would show it, its white at the panel's white, its black at 0. What a program returns is
seen through the colours of `papilio palette`, which all programs are given as the colours of the inks. The halftones alone are
judged against one target: each program gets the picture that Papilio's tone and gamut mapping makes. Photographs: those of
scikit-image, scikit-learn and matplotlib; drawings are made here.
"""

import functools
import json
import pathlib
import subprocess
import sys
import tempfile
import time

import epaper_dithering as epaper
import matplotlib
import numpy as np
import skimage.data
import sklearn.datasets
from PIL import Image, ImageDraw
from scipy.ndimage import gaussian_filter, uniform_filter
from skimage.color import deltaE_ciede2000

PAGE = pathlib.Path(__file__).parents[2] / "docs" / "peers.md"
MARKS = ("<!-- pictures -->\n", "<!-- end of pictures -->\n")

# Displays of `papilio new`, their pixels, pixels per inch, and the light.
PANELS = {
    "six-ink": ([800, 480], 127, "LED-B1"),
    "seven-ink": ([600, 448], 132, "LED-B1"),
    "four-grey": ([800, 480], 124, "D65"),
}
DISTANCE_MM = 500
PHOTOGRAPHS = "8 photographs"
# Programs in the table of the page.
ON_PAGE = ("Papilio", "Papilio, search", "Pillow", "epaper-dithering, Atkinson", "epaper-dithering, search")

D65 = np.array([0.95047, 1.0, 1.08883])
XYZ_FROM_RGB = np.array([[0.4123908, 0.3575843, 0.1804808], [0.2126390, 0.7151687, 0.0721923], [0.0193308, 0.1191948, 0.9505322]])
CAT16 = np.array([[0.401288, 0.650173, -0.051461], [-0.250268, 1.204414, 0.045854], [-0.002079, 0.048952, 0.953127]])


def decoded(srgb):
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def encoded(linear):
    linear = np.clip(linear, 0, 1)
    return np.where(linear <= 0.0031308, linear * 12.92, 1.055 * linear ** (1 / 2.4) - 0.055)


def adaptation(white, to):
    """Von Kries adaptation of X, Y, Z with CAT16."""
    return np.linalg.inv(CAT16) @ np.diag((CAT16 @ to) / (CAT16 @ white)) @ CAT16


class Panel:
    """A display with its inks in one light: `papilio` computes their colours."""

    def __init__(self, program, folder, name):
        self.program, self.name = program, name
        (self.columns, self.rows), ppi, light = PANELS[name]
        self.scenario = folder / f"{name}.toml"
        subprocess.run([program, "new", "--display", name, "--light", "living-room", self.scenario], check=True, capture_output=True)
        keys = f"\n[display.matrix]\nppi = {ppi}\npixels = [{self.columns}, {self.rows}]\n"
        self.scenario.write_text(self.scenario.read_text() + keys)
        self.set = ["--set", f"lighting.spectrum={light}", "--set", f"viewer.distance_mm={DISTANCE_MM}"]
        told = subprocess.run([program, "palette", self.scenario, *self.set, "--json"], check=True, capture_output=True, text=True)
        colours = json.loads(told.stdout)["colours"]
        self.states = [colour["state"] for colour in colours]
        self.xyz = np.array([[colour["X"], colour["Y"], colour["Z"]] for colour in colours])
        self.white = self.xyz[self.states.index("white")]
        self.per_degree = DISTANCE_MM * np.radians(1) / (25.4 / ppi)

    def srgb(self):
        """Inks as sRGB, relative to the panel's white: what other programs are given."""
        return encoded(self.xyz @ adaptation(self.white, D65).T @ np.linalg.inv(XYZ_FROM_RGB).T)

    def reference(self, picture):
        """X, Y, Z of a picture as seen beside the panel."""
        return decoded(picture / 255.0) @ XYZ_FROM_RGB.T @ adaptation(D65, self.white).T

    def papilio(self, picture, *keys):
        """Numbers of the states, and seconds of the whole program."""
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "picture.png"
            Image.fromarray(picture).save(file)
            more = [word for key in keys for word in ("--set", key)]
            start = time.perf_counter()
            command = [self.program, "image", self.scenario, file, *self.set, *more, "--out", folder]
            subprocess.run(command, check=True, capture_output=True)
            seconds = time.perf_counter() - start
            return np.asarray(Image.open(f"{folder}/states.png")), seconds

    def target(self, picture):
        """What Papilio's tone and gamut mapping wants the halftone to show, in sRGB relative to the panel's white."""
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "picture.png"
            Image.fromarray(picture).save(file)
            none = ["--set", 'image.halftone="none"', "--relative-to", "display", "--out", folder]
            subprocess.run([self.program, "image", self.scenario, file, *self.set, *none], check=True, capture_output=True)
            return np.asarray(Image.open(f"{folder}/seen.png").convert("RGB"))


def pillow(panel, picture):
    inks = np.round(255 * panel.srgb()).astype(np.uint8)
    palette = Image.new("P", (1, 1))
    palette.putpalette(list(inks.ravel()) + list(inks[-1]) * (256 - len(inks)))
    start = time.perf_counter()
    found = Image.fromarray(picture).quantize(palette=palette, dither=Image.Dither.FLOYDSTEINBERG)
    seconds = time.perf_counter() - start
    return np.minimum(np.asarray(found), len(inks) - 1), seconds


def epaper_dithering(panel, picture, **settings):
    inks = np.round(255 * panel.srgb()).astype(int)
    colours = {state: tuple(int(value) for value in ink) for state, ink in zip(panel.states, inks)}
    palette = epaper.ColorPalette(colors=colours, accent=panel.states[-1])
    start = time.perf_counter()
    found = epaper.dither_image(Image.fromarray(picture), palette, **settings)
    seconds = time.perf_counter() - start
    # Its palette may have another order: states by the nearest ink.
    rgb = np.asarray(found.convert("RGB"), dtype=int)
    return np.argmin(np.abs(rgb[..., None, :] - inks).sum(-1), -1), seconds


def programs(panel):
    ppi = PANELS[panel.name][1]
    search = epaper.DbsParams(viewing_distance_cm=DISTANCE_MM / 10, ppi=ppi)
    modes = {"Burkes": epaper.DitherMode.BURKES, "Atkinson": epaper.DitherMode.ATKINSON}
    yield "Papilio", functools.partial(panel.papilio)
    yield "Papilio, search", lambda picture: panel.papilio(picture, 'image.halftone="direct-binary-search"')
    yield "Pillow", functools.partial(pillow, panel)
    for name, mode in modes.items():
        yield f"epaper-dithering, {name}", functools.partial(epaper_dithering, panel, mode=mode, tone=0.0, gamut=0.0)
    yield "epaper-dithering, tone and gamut", functools.partial(epaper_dithering, panel, tone="auto", gamut="auto")
    yield "epaper-dithering, search", functools.partial(epaper_dithering, panel, dbs=search)
    yield "epaper-dithering, tone, gamut, search", functools.partial(epaper_dithering, panel, tone="auto", gamut="auto", dbs=search)


OPPONENT = np.array([[0.279, 0.72, -0.107], [-0.449, 0.29, -0.077], [0.086, -0.59, 0.501]])
# Half widths in degrees and weights of Zhang and Wandell (1996).
FILTERS = [
    ([0.05, 0.225, 7.0], [1.00327, 0.114416, -0.117686]),
    ([0.0685, 0.826], [0.616725, 0.383275]),
    ([0.092, 0.6451], [0.567885, 0.432115]),
]


def blurred_lab(xyz, white, per_degree):
    """CIELAB after the eye's blur (S-CIELAB)."""
    margin = int(per_degree)
    channels = np.pad(xyz / white @ OPPONENT.T, ((margin, margin), (margin, margin), (0, 0)), mode="symmetric")
    down, across = np.fft.fftfreq(channels.shape[0]), np.fft.rfftfreq(channels.shape[1])
    square = (down[:, None] ** 2 + across[None] ** 2) * per_degree**2
    for number, (widths, weights) in enumerate(FILTERS):
        transfer = sum(weight * np.exp(-((np.pi * width) ** 2) * square / (4 * np.log(2))) for width, weight in zip(widths, weights))
        channels[..., number] = np.fft.irfft2(np.fft.rfft2(channels[..., number]) * transfer, s=channels.shape[:2])
    ratio = channels[margin:-margin, margin:-margin] @ np.linalg.inv(OPPONENT).T
    root = np.where(ratio > 216 / 24389, np.cbrt(np.maximum(ratio, 0)), (24389 / 27 * ratio + 16) / 116)
    return np.stack([116 * root[..., 1] - 16, 500 * (root[..., 0] - root[..., 1]), 200 * (root[..., 1] - root[..., 2])], -1)


def judged(panel, reference, states):
    """S-CIELAB, hue error in degrees, ratios of chroma and of local contrast, and of the part of it that is the picture's own."""
    wanted, seen = (blurred_lab(xyz, panel.white, panel.per_degree) for xyz in (reference, panel.xyz[states]))
    chroma, chroma_seen = (np.hypot(lab[..., 1], lab[..., 2]) for lab in (wanted, seen))
    hue, hue_seen = (np.arctan2(lab[..., 2], lab[..., 1]) for lab in (wanted, seen))
    apart = np.abs((hue - hue_seen + np.pi) % (2 * np.pi) - np.pi)
    coloured = chroma > 8
    some = coloured & (chroma_seen > 2)
    window = max(3, round(0.15 * panel.per_degree))

    def covariance(one, other):
        return uniform_filter(one * other, window) - uniform_filter(one, window) * uniform_filter(other, window)

    def contrast(lightness):
        return np.sqrt(np.maximum(covariance(lightness, lightness), 0))

    # The contrast of what is seen that varies as the picture does: a visible pattern has contrast of its own.
    own = (covariance(wanted[..., 0], seen[..., 0]) / np.maximum(contrast(wanted[..., 0]), 1e-6)).mean()
    local = contrast(wanted[..., 0]).mean()
    return (
        deltaE_ciede2000(wanted, seen).mean(),
        np.degrees((apart * chroma)[some].sum() / max(chroma[some].sum(), 1e-9)),
        chroma_seen[coloured].sum() / max(chroma[coloured].sum(), 1e-9) if coloured.any() else np.nan,
        contrast(seen[..., 0]).mean() / max(local, 1e-9),
        own / max(local, 1e-9),
    )


def to_target(panel, name, show, picture, target):
    """S-CIELAB between a halftone and the target that all programs are given."""
    given = picture if name.startswith("Papilio") else target
    return judged(panel, panel.reference(target), show(given)[0])[0]


def photographs(columns, rows):
    sklearn_folder = pathlib.Path(sklearn.datasets.__file__).parent / "images"
    samples = pathlib.Path(matplotlib.__file__).parent / "mpl-data" / "sample_data"
    folder = pathlib.Path(skimage.data.__file__).parent
    files = {name: folder / f"{name}.png" for name in ("astronaut", "coffee", "chelsea", "motorcycle_left")}
    files |= {"rocket": folder / "rocket.jpg", "hopper": samples / "grace_hopper.jpg"}
    files |= {name: sklearn_folder / f"{name}.jpg" for name in ("china", "flower")}
    for name, file in files.items():
        picture = Image.open(file).convert("RGB")
        scale = max(columns / picture.width, rows / picture.height)
        picture = picture.resize((round(picture.width * scale), round(picture.height * scale)), Image.Resampling.LANCZOS)
        left, top = (picture.width - columns) // 2, (picture.height - rows) // 2
        yield name, np.asarray(picture.crop((left, top, left + columns, top + rows)))


def drawings(columns, rows):
    x, y = np.meshgrid(np.linspace(-1, 1, columns), np.linspace(-1, 1, rows))
    ramp = np.repeat(np.repeat(np.linspace(0, 255, columns)[None, :, None], rows, 0), 3, 2)
    yield "grey ramp", np.round(ramp).astype(np.uint8)
    hue, chroma = np.arctan2(y, x), np.clip(np.hypot(x, y), 0, 1)
    wheel = 0.5 + 0.5 * chroma[..., None] * np.cos(hue[..., None] - np.array([0, 2 * np.pi / 3, -2 * np.pi / 3]))
    yield "colour wheel", np.round(255 * wheel).astype(np.uint8)
    board = Image.new("RGB", (columns, rows), "white")
    pen = ImageDraw.Draw(board)
    for number, colour in enumerate(["#ff0000", "#ffff00", "#00a000", "#0000ff", "#808080", "#c0c0c0"]):
        left = columns * number // 6
        pen.rectangle([left + 8, rows // 2, left + columns // 6 - 8, rows - 20 - 12 * number], fill=colour, outline="black")
    pen.text((30, 30), "21.5 C   48 %   1013 hPa", fill="black", font_size=rows // 9)
    pen.line([30, rows // 3, columns - 30, rows // 4], fill="#ff0000", width=3)
    yield "dashboard", np.asarray(board)


def rows(program):
    """Yields the rows of the table: means over the photographs, and each drawing."""
    with tempfile.TemporaryDirectory() as folder:
        for name in PANELS:
            panel = Panel(program, pathlib.Path(folder), name)
            size = panel.columns, panel.rows
            for group, pictures in ((PHOTOGRAPHS, list(photographs(*size))), *((one[0], [one]) for one in drawings(*size))):
                targets = [panel.target(picture) for _, picture in pictures]
                for other, show in programs(panel):
                    if group != PHOTOGRAPHS and "tone" not in other and other not in ("Papilio", "Papilio, search", "Pillow"):
                        continue
                    found = [(picture, *show(picture)) for _, picture in pictures]
                    numbers = np.nanmean([judged(panel, panel.reference(picture), states) for picture, states, _ in found], 0)
                    seconds = np.median([seconds for *_, seconds in found])
                    scielab, hue, chroma, contrast, own = numbers
                    # A tone or gamut of its own would change the target.
                    given = [] if group != PHOTOGRAPHS or "tone" in other else zip(pictures, targets)
                    halftone = [to_target(panel, other, show, picture, target) for (_, picture), target in given]
                    halftone = f"{np.mean(halftone):.2f}" if halftone else "-"
                    yield (
                        f"| {name} | {group} | {other} | {scielab:.2f} | {hue:.1f} | {chroma:.2f} | {contrast:.2f} | {own:.2f} | {halftone} "
                        f"| {seconds:.2f} s |"
                    )


def measure(program):
    head = "| panel | program | S-CIELAB | hue error, deg | chroma | local contrast | of the photograph | to one target | time |"
    lines = [head, "|---|" + 8 * "---|"]
    for line in rows(program):
        print(line, flush=True)
        # The page has the means over the photographs of some programs; it says in words what drawings show.
        panel, pictures, other, *numbers = line.strip("| ").split(" | ")
        lines += [f"| {' | '.join([panel, other, *numbers])} |"] if pictures == PHOTOGRAPHS and other in ON_PAGE else []
    before, rest = PAGE.read_text().split(MARKS[0])
    after = rest.split(MARKS[1])[1]
    PAGE.write_text(before + MARKS[0] + "\n" + "\n".join(lines) + "\n\n" + MARKS[1] + after)


if __name__ == "__main__":
    measure(sys.argv[1])
