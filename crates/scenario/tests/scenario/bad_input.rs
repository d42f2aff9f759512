//! Mistakes of users: place, message and hint of each error.

use std::fs;
use std::path::Path;

use crate::common::{GOOD, changed, resolve};
use papilio_scenario::ScenarioError;

/// Returns all errors of a text in a folder without files.
fn errors(text: &str, sets: &[&str]) -> Vec<ScenarioError> {
    let Err(errors) = resolve(text, Path::new(""), sets) else {
        panic!("this is no error:\n{text}\n{sets:?}")
    };
    errors.iter().cloned().collect()
}

/// Returns the only error after a change of the valid scenario: line, column, and the printed error.
fn one(from: &str, to: &str) -> ((usize, usize), String) {
    only(errors(&changed(&[(from, to)]), &[]))
}

fn only(errors: Vec<ScenarioError>) -> ((usize, usize), String) {
    assert_eq!(errors.len(), 1, "{errors:#?}");
    (errors[0].place.line_column().unwrap_or((0, 0)), errors[0].to_string())
}

/// A change, the place of the error, and parts of its text.
type Case = (&'static str, &'static str, (usize, usize), &'static [&'static str]);

const SPHERES: &[Case] = &[
    (
        "diffuse = 0.5",
        "diffuse = 0.5\nspot_mm = 4",
        (33, 11),
        &["the part of a port", "expected `port_mm` beside it"],
    ),
    (
        "diffuse = 0.5",
        "diffuse = 0.5\nsample_mm = 4",
        (33, 13),
        &["the size of a sample at the port", "`port_mm`"],
    ),
    (
        "diffuse = 0.5",
        "diffuse = 0.5\nport_mm = 8\nspot_mm = 9",
        (34, 11),
        &["9 is out of range", "the diameter of the port, 8 mm"],
    ),
    (
        "diffuse = 0.5",
        "diffuse = 0.5\nport_mm = 8\nspot_mm = 5\nsample_mm = 4",
        (34, 11),
        &["5 is out of range", "the diameter of the sample, 4 mm"],
    ),
    ("diffuse = 0.5", "diffuse = 0.5\nport_mm = 8", (33, 11), &["light from a lamp", "d8-included"]),
];

const KEYS_AND_TYPES: &[Case] = &[
    ("haze = 0.78", "hase = 0.78", (13, 1), &["no key `hase`", "did you mean `haze`?"]),
    ("range_nm = [400, 700]", "colour = 1", (4, 1), &["no key `colour`", "the keys are range_nm, step_nm"]),
    ("[viewer]", "[vewer]", (37, 2), &["did you mean `viewer`?"]),
    ("model = \"film\"\n", "", (19, 1), &["`model` is missing", "expected \"film\" or \"table\""]),
    (
        "thickness_nm = 12 ",
        "thickness_nm = \"12 nm\" ",
        (25, 45),
        &["a string", "expected a number from 0", "unit"],
    ),
    ("step_nm = 10", "step_nm = \"10\"", (5, 11), &["a string", "expected a number above 0"]),
    ("index = 1.5", "index = true", (17, 9), &["true or false", "a material or a file"]),
    ("theta_deg = 8", "theta_deg = 2026-01-01", (38, 13), &["a date"]),
    ("model = \"film\"", "model = \"flim\"", (20, 9), &["did you mean `film`?"]),
    ("title = \"Test\"", "title = Test", (1, 9), &["write strings in double quotes"]),
    ("[viewer]", "[viewer", (37, 8), &["`]`"]),
    ("title = \"Test\"", "title = \"Test\"\ntitle = \"Again\"", (2, 1), &["duplicate key"]),
    ("\"gap\"", "\"gab\"", (26, 38), &["expected a number from 0 to 1e6 (nm), or \"gap\""]),
];

const RANGES: &[Case] = &[
    (
        "thickness_nm = 12",
        "thickness_nm = -5",
        (25, 45),
        &["-5 is out of range", "expected a number from 0 to 1e6 (nm)"],
    ),
    ("red = 0.5", "red = 0.6", (22, 8), &["the areas sum to 1.1", "expected 1 within 0.001"]),
    ("haze = 0.78", "haze = 78", (13, 8), &["78 is out of range", "expected a number above 0 and below 1"]),
    ("absorptance = 0.005", "absorptance = 0.995", (7, 1), &["sum to 1.005", "at most 1"]),
    ("diffuse = 0.5", "diffuse = 0.4", (35, 9), &["sum to 0.9", "expected 1"]),
    ("diffuse = 0.5", "diffuse = nan", (32, 11), &["NaN is out of range"]),
    ("illuminance_lx = 500", "illuminance_lx = inf", (30, 18), &["inf is out of range"]),
    ("illuminance_lx = 500", "illuminance_lx = 1e308", (30, 18), &["expected a number from 1e-6 to 1e9"]),
    ("illuminance_lx = 500", "illuminance_lx = 0", (30, 18), &["0 is out of range"]),
    ("theta_deg = 8", "theta_deg = 90", (38, 13), &["above -90 and below 90"]),
    ("theta_deg = 8", "theta_deg = []", (38, 13), &["empty"]),
    ("theta_deg = 8", "theta_deg = 89\nfield_deg = 5", (39, 13), &["91.5 deg", "less than 90"]),
    ("theta_deg = 8", "theta_deg = { from = 0, to = 80, step = 1e-9 }", (38, 13), &["views", "at most 5000"]),
    ("theta_deg = 8", "theta_deg = { from = 20, to = 10, step = 1 }", (38, 13), &["from <= to"]),
    ("theta_deg = 8", "theta_deg = { from = 0, to = 90, step = 1 }", (38, 30), &["above -90 and below 90"]),
    ("step_nm = 10", "step_nm = 7", (5, 11), &["not a grid"]),
    ("step_nm = 10", "step_nm = 1e-9", (5, 11), &["not a grid"]),
    ("range_nm = [400, 700]", "range_nm = [700, 400]", (4, 12), &["not a grid"]),
    ("range_nm = [400, 700]", "range_nm = [400]", (4, 12), &["first and last"]),
    ("range_nm = [400, 700]", "range_nm = [800, 1000]", (4, 12), &["visible"]),
    ("index = 1.5", "index = 0.9", (17, 9), &["0.9 + 0i", "n from 1 to 10"]),
    ("index = 1.5", "index = \"Al\"", (17, 9), &["k below 1e-6"]),
    (
        "total_transmittance = 0.9",
        "total_transmittance = 0.99",
        (14, 23),
        &["cannot transmit 0.9900", "at most 0.943"],
    ),
];

const NAMES_AND_CHOICES: &[Case] = &[
    (
        "\"Cr:Johnson\"",
        "\"Cr:jonson\"",
        (25, 16),
        &["no material named `Cr:jonson`", "did you mean `Cr:Johnson`?"],
    ),
    ("\"Al\"", "\"Unobtainium\"", (21, 13), &["names are listed by `papilio materials`: air, SiO2"]),
    ("\"D65\"", "\"D66\"", (31, 12), &["no light named `D66`", "did you mean `D60` or `D65`?"]),
    ("\"D65\"", "\"D93\"", (31, 12), &["no light named `D93`", "{ daylight_K = 9305 }"]),
    ("range_nm = [400, 700]", "range_nm = [340, 700]\n#", (26, 16), &["from 354 to 892 nm", "[360, 700]"]),
    ("green = 0.3", "lime = 0.3", (22, 21), &["no sub-pixel `lime` in `gap_nm`"]),
    ("dark = 20", "drak = 20", (23, 10), &["no dark gap"]),
    (", dark = 20", "", (23, 10), &["state `black` leaves `red` dark", "add `dark = 20.0`"]),
    ("[lighting]", "[display.pixel.states]\nx = { rde = 1 }\n[lighting]", (30, 7), &["did you mean `red`?"]),
    ("[lighting]", "[display.pixel.states]\nx = { red = 2 }\n[lighting]", (30, 13), &["2 is out of range"]),
    ("\"gap\"", "30", (24, 8), &["0 layers of this film have thickness_nm"]),
    ("haze = 0.78\n", "", (11, 1), &["none of `haze` and `width`"]),
    ("haze = 0.78", "haze = 0.78\nwidth = 0.05", (14, 9), &["more than one of `haze` and `width`"]),
    (
        "\"k-correlation\"",
        "\"lambertian\"",
        (13, 8),
        &["`haze` cannot be combined with model = \"lambertian\""],
    ),
    ("index = 1.5", "index = 1.5\nsurface = \"fresnel\"", (18, 11), &["includes its surfaces"]),
    ("[viewer]", "[solver]\nangle_medium = \"glass\"\n[viewer]", (38, 16), &["a panel without diffuser"]),
    ("[viewer]", "[solver]\npaths = 10\nrelative_error = 0.1\n[viewer]", (38, 9), &["more than one of"]),
    (
        "[viewer]",
        "[solver]\npaths = 10\n[viewer]",
        (38, 9),
        &[
            "`paths` cannot be combined with method = \"adding\"",
            "give `relative_error`, or method = \"monte-carlo\"",
        ],
    ),
    (
        "[viewer]",
        "[solver]\nmethod = \"adds\"\n[viewer]",
        (38, 10),
        &["`adds`", "\"adding\" or \"monte-carlo\""],
    ),
    ("\"D65\"", "{ led_nm = 500, width_nm = 0.01 }", (31, 39), &["0.01 is out of range", "0.1 to 1000"]),
    ("\"D65\"", "{ led_nm = 500 }", (31, 12), &["`width_nm` is missing"]),
    ("\"D65\"", "{ led_nm = 9000, width_nm = 10 }", (31, 12), &["dark between 400 and 700 nm"]),
];

const ADVICE: &[Case] = &[
    (
        "haze = 0.78",
        "haze = 0.999",
        (13, 8),
        &["no k-correlation lobe has a haze of 0.999", "haze can be 0.998 at most"],
    ),
    ("haze = 0.78", "haze = 0.9\nregular_fraction = 0.3", (13, 8), &["haze can be 0.6"]),
    ("haze = 0.78", "haze = 0.9\nregular_fraction = 1", (13, 8), &["regular transmission is not haze"]),
    ("haze = 0.78", "haze = .78", (13, 8), &["mantissa", "0.50"]),
    ("haze = 0.78", "haze = 1.", (13, 10), &["fraction", "0.50"]),
    ("\"Cr:Johnson\"", "{ n = 2, k = -1 }", (25, 29), &["n + ik", "change the sign"]),
    ("diffuse = 0.5", "diffuse = 0.4", (35, 9), &["lighting.diffuse=0.5 would make the sum 1"]),
    ("[[display.front]]", "[display.front]", (7, 1), &["expected a list", "as in [[display.layers]]"]),
    ("[[lighting.directed]]", "[lighting.directed]", (33, 1), &["in double brackets, once for each item"]),
    (
        "\"D65\"",
        "{ led_nm = 9000, width_nm = 10 }",
        (31, 12),
        &["this light is dark", "change spectrum.range_nm"],
    ),
];

const WRITTEN_OTHERWISE: &[Case] = &[
    ("theta_deg = 8", "theta_deg = 8 deg", (38, 13), &["found `deg`", "the unit is in the key's name"]),
    ("thickness_nm = 12 ", "thickness_nm = 12 nm ", (25, 45), &["found `nm`"]),
    ("illuminance_lx = 500", "illuminance_lx = 500lx", (30, 18), &["found `lx`"]),
    ("theta_deg = 8", "theta_deg = [0, 8 deg]", (38, 17), &["found `deg`"]),
    ("theta_deg = 8", "theta_deg = 8 20", (38, 13), &["this is not a value"]),
    ("theta_deg = 8", "theta_deg = 8, 20", (38, 14), &["expected newline"]),
    ("haze = 0.78", "haze = 78 %", (13, 8), &["found `%`", "write 78 % as 0.78"]),
    ("haze = 0.78", "haze = 78%", (13, 8), &["found `%`", "write 78 % as 0.78"]),
    ("haze = 0.78", "haze = 78", (13, 8), &["fraction relative to 1, not per cent"]),
    ("haze = 0.78", "haze = 0,78", (13, 8), &["has a decimal comma", "with a point"]),
    ("red = 0.5", "red = 0,5", (22, 16), &["has a decimal comma", "with a point"]),
    ("title = \"Test\"", "title = Test", (1, 9), &["this is not a value", "write strings in double quotes"]),
    ("title = \"Test\"", "title = \"Test", (1, 14), &["a string ends with the double quote"]),
    ("title = \"Test\"", "title = \"Te\\u001bst\"", (1, 9), &["control characters", "one line"]),
    ("red = 0.5", "\"r\\u0007\" = 0.5", (22, 10), &["this name is not permitted", "no control characters"]),
    ("red = 0.5", "\"red \" = 0.5", (22, 10), &["this name is not permitted", "no blanks at the ends"]),
    ("haze = 0.78", "haze = 1e-9", (13, 8), &["this haze is too small: give a larger one"]),
    (
        "red = 0.5, green = 0.3, blue = 0.2",
        "",
        (22, 8),
        &["has no sub-pixels", "a fraction of the area for each"],
    ),
    (
        "\"D65\"",
        "\"\"",
        (31, 12),
        &["the name of the light is empty", "names are listed by `papilio illuminants`"],
    ),
    (
        "[lighting]",
        "[display.pixel.states]\nx = { gap_nm = 100 }\n[lighting]",
        (30, 5),
        &["under a sub-pixel"],
    ),
    ("theta_deg = 8", "theta_deg = [8, 20, 8.0]", (38, 21), &["8 is in this list twice"]),
    ("theta_deg = 8", "phi_deg = [0, -0.0]", (38, 15), &["0 is in this list twice"]),
    ("[viewer]", "[solver]\npaths = 1099511627777\n[viewer]", (38, 9), &["from 1 to 1099511627776"]),
];

const TARGETS: &[Case] = &[
    (
        "[viewer]",
        "[solver]\nmethod = \"monte-carlo\"\ntarget = { metric = \"Y\", state = \"wite\", error = 0.1 }\n[viewer]",
        (39, 34),
        &["there is no state `wite`"],
    ),
    (
        "[viewer]",
        "[solver]\nmethod = \"monte-carlo\"\ntarget = { metric = \"Y\" }\n[viewer]",
        (39, 10),
        &["expected exactly one of `error` and `relative_error`"],
    ),
    (
        "[viewer]",
        "[solver]\nmethod = \"monte-carlo\"\ntarget = { metric = \"gamut_percent_ebu\", state = \"red\", error = 1 }\n[viewer]",
        (39, 50),
        &["a metric of all states together"],
    ),
];

/// Changes of `[metrics]`.
const METRICS: &[Case] = &[
    ("[viewer]", "[metrics]\nreference_state = \"wite\"\n[viewer]", (38, 19), &["there is no state `wite`"]),
    ("[viewer]", "[metrics]\nobserver = \"1960\"\n[viewer]", (38, 12), &["1931", "1964"]),
    ("[viewer]", "[metrics]\nobserver = 1931\n[viewer]", (38, 12), &["expected"]),
    ("[viewer]", "[viewer]\nage_years = 80", (38, 13), &["from 20 to 75 (years)"]),
    ("[viewer]", "[viewer]\ntext_height_mm = 0", (38, 18), &["above 0", "(mm)"]),
    ("[viewer]", "[metrics]\ngamut_volume = 1\n[viewer]", (38, 16), &["expected"]),
    ("[viewer]", "[metrics]\nappearance = { background = 0 }\n[viewer]", (38, 29), &["from 0.01 to 1"]),
    (
        "[viewer]",
        "[metrics]\nappearance = { surround = \"bright\" }\n[viewer]",
        (38, 27),
        &["average", "dark"],
    ),
    (
        "[viewer]",
        "[metrics.appearance]\nadapting_luminance_cd_m2 = 0.0\n[viewer]",
        (38, 28),
        &["from 0.01 to 1e6"],
    ),
    ("[viewer]", "[metrics]\nobservr = \"1964\"\n[viewer]", (38, 1), &["observer"]),
];

/// Models of dispersion.
const DISPERSION: &[Case] = &[
    (
        "substrate = \"Al\"",
        "substrate = { model = \"cauchi\", a = 1.5 }",
        (21, 23),
        &["`cauchi`", "`cauchy`"],
    ),
    ("substrate = \"Al\"", "substrate = { model = \"cauchy\" }", (21, 13), &["`a` is missing"]),
    (
        "substrate = \"Al\"",
        "substrate = { model = \"cauchy\", a = 1.5, gap_ev = 2 }",
        (21, 42),
        &["no key `gap_ev`"],
    ),
    (
        "substrate = \"Al\"",
        "substrate = { model = \"cauchy\", a = 1.5, b_um2 = -1 }",
        (21, 13),
        &["Cauchy's formula: n = -", "no refractive index"],
    ),
    (
        "substrate = \"Al\"",
        "substrate = { model = \"sellmeier\", terms = [{ b = 1, resonance_nm = 450 }] }",
        (21, 13),
        &["Sellmeier's formula: n^2 = -"],
    ),
    (
        "substrate = \"Al\"",
        "substrate = { model = \"oscillators\", terms = [{ kind = \"lorentz\", strength = -1, energy_ev = 3, damping_ev = 0.1 }] }",
        (21, 78),
        &["-1 is out of range", "from 0"],
    ),
    (
        "substrate = \"Al\"",
        "substrate = { model = \"oscillators\", terms = [{ kind = \"drude\", plasma_ev = 9, damping_ev = 0, gap_ev = 0.1 }] }",
        (21, 105),
        &["`gap_ev` cannot be combined with kind = \"drude\""],
    ),
];

const NOT_IN_THIS_VERSION: &[Case] =
    &[("[viewer]", "[study]\n[viewer]", (37, 2), &["`study` is not in this version"])];

#[test]
fn mistakes_are_reported_at_their_places() {
    let mut wrong = Vec::new();
    for (from, to, place, says) in [
        KEYS_AND_TYPES,
        SPHERES,
        DISPERSION,
        RANGES,
        NAMES_AND_CHOICES,
        ADVICE,
        WRITTEN_OTHERWISE,
        NOT_IN_THIS_VERSION,
        TARGETS,
        METRICS,
    ]
    .concat()
    {
        let errors = errors(&changed(&[(from, to)]), &[]);
        let (at, shown) = (errors[0].place.line_column(), errors[0].to_string());
        if at != Some(place) || !says.iter().all(|words| shown.contains(words)) {
            wrong.push(format!("{to}: expected at {place:?}, {says:?}\n{shown}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn error_is_printed_as_by_compilers() {
    let (_, shown) = one("thickness_nm = 12 ", "thickness_nm = -5 ");
    let expected = "error: -5 is out of range\n  --> test.toml:25:45\n   |\n25 |   { material = \"Cr:Johnson\", thickness_nm = -5 },\n   \
                    |                                             ^^ expected a number from 0 to 1e6 (nm)";
    assert_eq!(shown, expected);
}

#[test]
fn independent_mistakes_are_reported_together() {
    let text = changed(&[
        ("haze", "hase"),
        ("thickness_nm = 12", "thickness_nm = -5"),
        ("theta_deg = 8", "theta_deg = 95"),
    ]);
    let lines: Vec<_> = errors(&text, &[]).iter().map(|e| e.place.line_column().unwrap().0).collect();
    assert_eq!(lines, [13, 25, 38]);
    let text = changed(&[("\"Al\"", "\"Alu\""), ("\"D65\"", "\"D66\""), ("diffuse = 0.5", "diffuse = 0.4")]);
    assert_eq!(errors(&text, &[]).len(), 3);
}

#[test]
fn mistakes_in_set_are_reported_with_its_number_and_column() {
    let cases: [(&[&str], &str, &[&str]); 16] = [
        (&["display.glas.index=1.5"], "--set #1:1:9", &["no key `glas`", "did you mean `glass`?"]),
        (
            &["title=\"x\"", "viewer.theta_deg=-95"],
            "--set #2:1:18",
            &["viewer.theta_deg=-95", "above -90 and below 90"],
        ),
        (&["display.pixel.film.2.material=1.4"], "--set #1:1:20", &["`thickness_nm` is missing"]),
        (
            &["display.pixel.film.3.material=1.4"],
            "--set #1:1:20",
            &["has the indices 0 to 1", "expected an index from 0 to 2; 2 appends an item", "count from 0"],
        ),
        (
            &["display.pixel.film.first.material=1.4"],
            "--set #1:1:20",
            &["an index is needed here", "expected an index from 0 to 2"],
        ),
        (
            &["display.glass.index.n=1.4"],
            "--set #1:1:21",
            &["a number, which has no keys", "expected the end of the path", "remove this key"],
        ),
        (&["nonsense"], "--set #1:1:1", &["not PATH=VALUE"]),
        (&["=1"], "--set #1:1:1", &["the path has an empty key"]),
        (
            &["display..glass=1"],
            "--set #1:1:9",
            &["the path has an empty key", "expected a key", "points separate the keys"],
        ),
        (&["title=7"], "--set #1:1:7", &["a number", "expected a string"]),
        (
            &["display.pixel.film.2.thickness_nm=3"],
            "--set #1:1:20",
            &["the key `material` is missing", "indices 0 to 1: index 2 appends"],
        ),
        (
            &["display.layers.0.thickness_mm=3"],
            "--set #1:1:16",
            &["the key `kind` is missing", "no such list yet"],
        ),
        (&["viewer.theta_deg=[1,"], "--set #1", &["array"]),
        (&["lighting.preset=suny"], "--set #1:1:17", &["did you mean `sunny`?"]),
        (&["display.glass.index=nothing"], "--set #1:1:21", &["no material named `nothing`"]),
        (&[""], "--set #1", &["not PATH=VALUE"]),
    ];
    for (sets, place, says) in cases {
        let error = &errors(GOOD, sets)[0];
        let shown = error.to_string();
        assert!(error.place.to_string().starts_with(place), "{sets:?} at {}:\n{shown}", error.place);
        for words in says {
            assert!(shown.contains(words), "`{words}` is not in\n{shown}");
        }
    }
    // A file that a --set asks for: which key it was is shown.
    let shown = errors(GOOD, &["display.glass.index=none.csv"])[0].to_string();
    let note = "requested at --set #1:1:21: display.glass.index=none.csv";
    assert!(shown.contains(note) && shown.contains("paths in a scenario"), "{shown}");
    let long = format!("a{}=1", ".a".repeat(100_000));
    assert_eq!(errors(GOOD, &[&long]).len(), 1);
}

/// The file alone is valid: the error is at the `--set`, whichever value it concerns.
#[test]
fn mistakes_caused_by_set_are_reported_at_the_set() {
    let bare = {
        let (start, end) = (GOOD.find("[display.diffuser]").unwrap(), GOOD.find("[display.glass]").unwrap());
        format!("{}{}", &GOOD[..start], &GOOD[end..])
    };
    let coated = bare.replace("index = 1.5", "index = 1.5\nsurface = \"fresnel\"");
    let in_glass = format!("{bare}[solver]\nangle_medium = \"glass\"\n");
    let with_range = changed(&[("theta_deg = 8", "theta_deg = { from = 0, to = 9, step = 1 }")]);
    let diffuser = "display.diffuser={ model = \"lambertian\", transmittance = 1 }";
    let cases: [(&str, &str, &str); 18] = [
        (GOOD, "display.pixel.area.red=0.9", "the areas sum to 1.4"),
        (GOOD, "display.pixel.film.0.thickness_nm=gap", "2 layers of this film"),
        (GOOD, "display.pixel.gap_nm={ red = 200 }", "in `gap_nm`"),
        (GOOD, "display.pixel.area={ red = 1 }", "in `area`"),
        (GOOD, "display.diffuser.width=2", "a lobe this wide cannot transmit"),
        (GOOD, "display.diffuser.regular_fraction=0.9", "lobe has a haze"),
        (GOOD, "display.diffuser.model=lambertian", "`haze` cannot be combined"),
        (GOOD, "display.front.0.reflectance=0.999", "reflectance and absorptance sum"),
        (GOOD, "spectrum.range_nm=[340, 700]", "`Cr:Johnson` reaches from"),
        (GOOD, "spectrum.step_nm=7", "not a grid"),
        (GOOD, "viewer.theta_deg=89.99", "this cone reaches"),
        (GOOD, "viewer.field_deg=180", "theta_deg plus half of field_deg: reduce one of them"),
        (&coated, diffuser, "includes its surfaces"),
        (
            &coated,
            "display.diffuser={ model = \"slab\", optical_thickness = 1, anisotropy = 0 }",
            "faces of its own",
        ),
        (&in_glass, diffuser, "a panel without diffuser"),
        (&in_glass, "display.glass.index=9", "never leaves it"),
        (&with_range, "viewer.theta_deg.to=-1", "is empty"),
        (GOOD, "display.pixel.default_states=false", "no states"),
    ];
    for (text, set, says) in cases {
        let errors = errors(text, &[set]);
        assert!(errors.iter().any(|error| error.to_string().contains(says)), "{set}: {errors:#?}");
        let elsewhere = errors.iter().find(|error| error.place.name != "--set #1");
        assert!(elsewhere.is_none(), "{set}: {elsewhere:#?}");
    }
}

/// The range that the message proposes is a grid, and within the data.
#[test]
fn proposed_range_of_wavelengths_is_a_grid() {
    for set in ["spectrum={range_nm=[320, 700],step_nm=20}", "spectrum={range_nm=[330, 700],step_nm=10}"] {
        let errors = errors(GOOD, &[set]);
        let text = errors
            .iter()
            .map(ToString::to_string)
            .find(|text| text.contains("`Cr:Johnson` reaches"))
            .unwrap();
        let range = text.split("set spectrum.range_nm=").nth(1).unwrap().trim();
        let step = set.split("step_nm=").nth(1).unwrap().trim_end_matches('}');
        let proposed = format!("spectrum={{range_nm={range},step_nm={step}}}");
        let accepted = resolve(GOOD, Path::new(""), &[&proposed]);
        // The illuminant begins later still, and says so itself.
        let remains = accepted.err().map(|errors| errors.to_string()).unwrap_or_default();
        assert!(
            !remains.contains("is not a grid") && !remains.contains("Cr:Johnson"),
            "{proposed}: {remains}"
        );
    }
}

#[test]
fn errors_beyond_the_limit_are_counted() {
    let keys: String = (0..73).map(|i| format!("k{i} = 1\n")).collect();
    let errors = resolve(&format!("{keys}{GOOD}"), Path::new(""), &[]).unwrap_err();
    assert_eq!(errors.iter().count(), 50);
    assert!(errors.to_string().ends_with("error: there are 23 more errors, not shown"));
}

#[test]
fn shares_that_do_not_fit_a_preset_are_refused() {
    let text = GOOD.replace(&GOOD[GOOD.find("illuminance_lx").unwrap()..], "preset = \"indoor\"\n");
    let error = &errors(&text, &["lighting.diffuse=0.7"])[0];
    let shown = error.to_string();
    assert!(error.place.to_string().starts_with("--set #1:1:18"), "{shown}");
    assert!(shown.contains("lighting.directed.0.share=0.3 would make the sum 1"), "{shown}");
    assert!(
        resolve(&text, Path::new(""), &["lighting.diffuse=0.7", "lighting.directed.0.share=0.3"]).is_ok()
    );
    let shown = errors(&text, &["lighting.directed.1={ theta_deg = 10, share = 0.2 }"])[0].to_string();
    assert!(shown.contains("lighting.directed.0.share=0.3 would make the sum 1"), "{shown}");
    // Nothing from 0 to 1 would do: no advice.
    let sets = ["lighting.directed.1={ theta_deg = 1, share = 0.9 }", "lighting.directed.0.share=0.9"];
    let shown = errors(&text, &[sets[0], sets[1], "lighting.diffuse=0.9"])[0].to_string();
    assert!(shown.contains("sum to 2.7") && !shown.contains("would make"), "{shown}");
}

#[test]
fn other_text_than_toml_gives_one_error() {
    for text in ["nm,R\n380,0.1\n390,0.1\n400,0.1\n", "{\"a\": 1,\n\"b\": 2}\n", "Dear reader,\n\nhello.\n"] {
        let (_, shown) = only(errors(text, &[]));
        assert!(shown.contains("does not look like a scenario (TOML)"), "{shown}");
    }
    let (_, shown) = only(errors("title = 0,5\n", &[]));
    assert!(shown.contains("has a decimal comma"), "{shown}");
    let empty = "[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = {}\n";
    let (_, shown) = only(errors(empty, &[]));
    assert!(shown.contains("reflectance = { white = 0.45 }"), "{shown}");
    let (_, shown) = only(errors("", &[]));
    assert!(shown.contains("= expected a table") && !shown.contains("expected: expected"), "{shown}");
    let wrong = papilio_scenario::Scenario::load(Path::new("none.toml"), &[]).unwrap_err().to_string();
    assert!(wrong.contains("no such file") && !wrong.contains("relative"), "{wrong}");
}

#[test]
fn mistakes_in_files_state_the_file_and_the_key_that_names_it() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    file("nan.csv", "nm,R\n380,0.1\n500,nan\n780,0.1\n");
    file("short.csv", "450,0.1\n650,0.1\n");
    file("percent.csv", "380,10\n780,20\n");
    file("um.csv", "0.38,1.5,0\n0.78,1.5,0\n");
    file("binary.csv", "380,0.1\n780,\0\u{1}\n");
    fs::write(folder.path().join("latin1.csv"), b"# bei 20 \xB0C\n380,0.1\n780,0.1\n").unwrap();
    let shown = |from: &str, to: &str| {
        let errors = resolve(&changed(&[(from, to)]), folder.path(), &[]).unwrap_err();
        only(errors.iter().cloned().collect())
    };
    let front = "reflectance = 0.01";
    let (place, text) = shown(front, "reflectance = \"nan.csv\"");
    assert_eq!(place, (3, 5));
    // As an editor in the current folder finds it.
    let found = format!("--> {}:3:5", folder.path().join("nan.csv").display());
    assert!(text.contains(&found) && text.contains("requested at test.toml:8:15"), "{text}");
    let (place, text) = shown(front, "reflectance = \"short.csv\"");
    assert_eq!(place, (8, 15));
    assert!(text.contains("from 450 to 650 nm") && text.contains("[450, 650]"), "{text}");
    let (place, text) = shown(front, "reflectance = \"percent.csv\"");
    assert_eq!(place, (1, 5));
    assert!(text.contains("the fraction is 10") && text.contains("from 0 to 1, not in percent"), "{text}");
    assert!(text.contains("requested at test.toml:8:15"), "{text}");
    let (_, text) = shown("index = 1.5", "index = \"um.csv\"");
    assert!(text.contains("micrometres") && text.contains("convert the values to nm"), "{text}");
    let (_, text) = shown(front, "reflectance = \"none.csv\"");
    assert!(
        text.contains("none.csv") && text.contains("no such file") && text.contains("test.toml:8:15"),
        "{text}"
    );
    assert_eq!(shown(front, "reflectance = \"binary.csv\"").0, (2, 5));
    // Latin-1 is read.
    resolve(&changed(&[(front, "reflectance = \"latin1.csv\"")]), folder.path(), &[]).unwrap();
    assert!(shown(front, "reflectance = \".\"").1.contains("it is a folder"));
    let (place, text) = shown(front, "reflectance = \"\"");
    assert!(place == (8, 15) && text.contains("the name of the file is empty"), "{text}");
}

#[test]
fn pixel_table_that_does_not_cover_the_light_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for last in [41, 42, 90] {
        let rows: String =
            [0, last].iter().map(|t| format!("white,{t},400,0.5\nwhite,{t},700,0.5\n")).collect();
        let text = format!("state,theta_deg,wavelength_nm,reflectance\n{rows}");
        fs::write(folder.path().join(format!("{last}.csv")), text).unwrap();
    }
    let problem = |bare: bool, last: u32, angles: &str, medium: &str| {
        let start = GOOD.find("[display.pixel]").unwrap();
        let end = GOOD.find("[lighting]").unwrap();
        let pixel =
            format!("[display.pixel]\nmodel = \"table\"\nfile = \"{last}.csv\"\nangles = \"{angles}\"\n");
        let mut text = format!("{}{pixel}{}", &GOOD[..start], &GOOD[end..]);
        if bare {
            let (start, end) =
                (text.find("[display.diffuser]").unwrap(), text.find("[display.glass]").unwrap());
            text.replace_range(start..end, "");
        }
        let medium = format!("solver.angle_medium={medium}");
        resolve(&text, folder.path(), &[&medium])
            .err()
            .map(|e| e.iter().next().unwrap().diagnostic.message.clone())
    };
    // asin(1/1.5) = 41.81 deg bounds all light of a bare panel; a lobe fills the glass.
    let ends =
        |deg: u32, medium: &str| Some(format!("the angles of this table end at {deg} deg in {medium}"));
    let in_air = "angles in air do not cover light beyond the critical angle of total internal reflection";
    assert_eq!(problem(true, 41, "glass", "air"), ends(41, "glass"));
    assert_eq!(problem(true, 42, "glass", "air"), None);
    assert_eq!(problem(true, 42, "air", "air"), ends(42, "air"));
    assert_eq!(problem(true, 90, "air", "air"), None);
    assert_eq!(problem(false, 42, "glass", "air"), ends(42, "glass"));
    assert_eq!(problem(false, 90, "glass", "air"), None);
    assert_eq!(problem(false, 90, "air", "air"), Some(in_air.to_owned()));
    assert_eq!(problem(true, 90, "air", "unrefracted"), Some(in_air.to_owned()));
    assert_eq!(problem(true, 90, "glass", "unrefracted"), None);
}

#[test]
fn angles_in_glass_beyond_the_critical_angle_are_refused() {
    let bare = {
        let (start, end) = (GOOD.find("[display.diffuser]").unwrap(), GOOD.find("[display.glass]").unwrap());
        format!("{}{}", &GOOD[..start], &GOOD[end..])
    };
    let glass = "solver.angle_medium=glass";
    assert!(resolve(&bare, Path::new(""), &[glass, "viewer.theta_deg=41.7"]).is_ok());
    let message = |sets: &[&str]| errors(&bare, sets)[0].diagnostic.message.clone();
    let trapped = |theta: &str| format!("light at {theta} deg in this glass never leaves it");
    assert_eq!(message(&[glass, "viewer.theta_deg=41.8"]), trapped("41.849999999999994"));
    assert_eq!(message(&[glass, "lighting.directed.0.theta_deg=-60"]), trapped("60"));
    // asin(1/1.5) = 41.81 deg; half of the field of 0.1 deg counts, and so does a lamp's radius.
    let lamp = ["lighting.directed.0.theta_deg=-40", "lighting.directed.0.radius_deg=2"];
    assert_eq!(message(&[glass, lamp[0], lamp[1]]), trapped("42"));
    let dispersive = message(&[glass, "display.glass.index=BK7"]);
    assert_eq!(dispersive, "angles in glass need a glass of the same index at all wavelengths");
}

/// Values that were measured through a face: impossible ones, and keys where they mean nothing.
#[test]
fn values_through_a_face_are_checked_where_they_are_written() {
    let pixel = |keys: &str| {
        format!(
            "[display.pixel]\nmodel = \"uniform\"\n{keys}\n[lighting]\nilluminance_lx = 500\nspectrum = \"D65\"\ndiffuse = 1.0\n"
        )
    };
    let through = "measured_through = { index = 1.5 }";
    for (keys, place, words) in [
        (
            format!("kind = \"lambertian\"\nreflectance = {{ white = 0.4, black = 0.02 }}\n{through}"),
            (4, 38),
            &["state `black` has 0.02 at 380 nm", "expected 0.04 to 1", "specular = \"excluded\""][..],
        ),
        (
            "kind = \"lambertian\"\nreflectance = { white = 0.97 }\nmeasured_through = { index = 1.5, specular = \"excluded\" }".to_owned(),
            (4, 25),
            &["expected 0 to 0.96", "fractions, not per cent"],
        ),
        (
            format!("kind = \"mirror\"\nreflectance = {{ white = 0.4 }}\n{through}"),
            (5, 20),
            &["`measured_through` is for pixels that scatter light", "remove `measured_through`"],
        ),
        (
            "kind = \"mirror\"\nreflectance = { white = 0.4 }\nspread_um = 20".to_owned(),
            (5, 13),
            &["`spread_um` is for pixels that scatter light"],
        ),
        (
            "kind = \"lambertian\"\nreflectance = { white = 0.4 }\nspread_um = \"slab\"".to_owned(),
            (5, 13),
            &["the spread of a slab is not computed", "expected a length in um", "kind = \"slab\""],
        ),
        (
            "kind = \"lambertian\"\nreflectance = { white = 0.4 }\nspread_um = \"wide\"".to_owned(),
            (5, 13),
            &["expected a number from 0 to 100000 (um), or \"slab\""],
        ),
        (
            "kind = \"lambertian\"\nreflectance = { white = 0.4 }\nspread_um = -1".to_owned(),
            (5, 13),
            &["-1 is out of range"],
        ),
        (
            "kind = \"lambertian\"\nreflectance = { white = 0.4 }\nmeasured_through = { index = 0.9 }".to_owned(),
            (5, 30),
            &["0.9 is out of range", "1.01 to 4"],
        ),
    ] {
        let (found, text) = only(errors(&pixel(&keys), &[]));
        assert_eq!(found, place, "{text}");
        words.iter().for_each(|words| assert!(text.contains(words), "{words}: {text}"));
    }
}
