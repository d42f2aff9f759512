//! The named materials with their models, constants and sources. Those of the refractiveindex.info database
//! are in `catalogue`.

use std::sync::LazyLock;

use crate::dispersion::Oscillator;
use crate::{Dispersion, MaterialInfo, SpectraError, Tabulated, catalogue};

/// Materials that are defined here: name, what it is, source.
#[rustfmt::skip]
const BUILT_IN: [(&str, &str, &str); 20] = [
    ("air", "air, n = 1", "by definition; 3e-4 below the real index"),
    ("SiO2", "fused silica", "I. H. Malitson, J. Opt. Soc. Am. 55, 1205-1208 (1965)"),
    ("MgF2", "magnesium fluoride, crystal, ordinary ray; similar to dense films", "M. J. Dodge, Appl. Opt. 23, 1980-1985 (1984)"),
    ("Al2O3", "sapphire, ordinary ray", "I. H. Malitson, M. J. Dodge, J. Opt. Soc. Am. 62, 1405A (1972)"),
    ("AlOx", "aluminium oxide, deposited film, n = 1.64", "typical of the visible"),
    ("Si3N4", "silicon nitride", "H. R. Philipp, J. Electrochem. Soc. 120, 295-300 (1973)"),
    ("BK7", "borosilicate crown glass N-BK7", "Schott, data sheet"),
    ("ITO", "indium tin oxide, film of 72 nm on glass", "T. A. F. Koenig et al., ACS Nano 8, 6182-6192 (2014)"),
    ("OCA", "optically clear adhesive, acrylic, n = 1.47", "typical; manufacturers state 1.4 to 1.5 for optically clear adhesives"),
    ("Al", "aluminium, Lorentz-Drude model", RAKIC),
    ("Cr", "chromium, Lorentz-Drude model", RAKIC),
    ("W", "tungsten, Lorentz-Drude model", RAKIC),
    ("Ni", "nickel, Lorentz-Drude model", RAKIC),
    ("Ti", "titanium, Lorentz-Drude model", RAKIC),
    ("Au", "gold, Lorentz-Drude model", RAKIC),
    ("Ag", "silver, Lorentz-Drude model", RAKIC),
    ("Al:BB", "aluminium, Brendel-Bormann model", RAKIC),
    ("Cr:BB", "chromium, Brendel-Bormann model", RAKIC),
    ("W:BB", "tungsten, Brendel-Bormann model", RAKIC),
    ("Cr:Johnson", "chromium, evaporated films", "P. B. Johnson, R. W. Christy, Phys. Rev. B 9, 5056-5070 (1974)"),
];

const RAKIC: &str = "A. D. Rakic et al., Appl. Opt. 37, 5271-5283 (1998)";

/// Other words for materials of which the description does not begin with them.
const WORDS: [(&str, &str); 30] = [
    ("alumina", "Al2O3:Franta"),
    ("alumina", "AlOx"),
    ("acrylic", "PMMA"),
    ("acrylicglass", "PMMA"),
    ("plexiglas", "PMMA"),
    ("plexiglass", "PMMA"),
    ("adhesive", "OCA"),
    ("glue", "OCA"),
    ("chrome", "Cr:Johnson"),
    ("chrome", "Cr"),
    ("chrome", "Cr:Sytchkova"),
    ("glass", "BK7"),
    ("glass", "soda-lime"),
    ("windowglass", "soda-lime"),
    ("floatglass", "soda-lime"),
    ("hafnia", "HfO2"),
    ("kapton", "PI"),
    ("mylar", "PET"),
    ("polyester", "PET"),
    ("niobia", "Nb2O5"),
    ("quartz", "SiO2"),
    ("silica", "SiO2"),
    ("silicondioxide", "SiO2"),
    ("tantala", "Ta2O5"),
    ("titania", "TiO2"),
    ("titaniumoxide", "TiO2"),
    ("zirconia", "ZrO2"),
    ("molybdenumchromium", "Mo"),
    ("mocr", "Mo"),
    ("mocr", "Cr:Sytchkova"),
];

static NAMES: LazyLock<Vec<&'static str>> =
    LazyLock::new(|| BUILT_IN.iter().map(|built_in| built_in.0).chain(catalogue::names()).collect());

/// Names accepted by [`material`].
pub fn material_names() -> &'static [&'static str] {
    &NAMES
}

/// Describes a named material: substance, source, range.
///
/// # Errors
/// If the name is not in [`material_names`].
pub fn material_info(name: &str) -> Result<MaterialInfo, SpectraError> {
    if let Some(info) = catalogue::info(name) {
        return Ok(info);
    }
    let range_nm = material(name)?.range_nm();
    let built_in = BUILT_IN.iter().find(|built_in| built_in.0 == name);
    let &(name, what, source) = built_in.ok_or_else(|| unknown(name))?;
    Ok(MaterialInfo { name, what, source, page: None, measured_nm: range_nm, range_nm })
}

/// Returns the names of materials for a word: `aluminium` (or Aluminum) is Al, Al:BB and Al:McPeak; empty for
/// an unknown word.
///
/// ```
/// assert_eq!(papilio_spectra::materials_called("Titanium Dioxide"), ["TiO2", "TiO2:Franta"]);
/// ```
pub fn materials_called(word: &str) -> Vec<&'static str> {
    let plain = |text: &str| {
        let text: String = text.to_lowercase().chars().filter(|c| c.is_alphanumeric()).collect();
        text.replace("aluminum", "aluminium").replace("sulphide", "sulfide")
    };
    let wanted = plain(word);
    let is_called = |name: &&&str| {
        let what = material_info(name).map_or("", |info| info.what);
        // "fused silica", but not "magnesium fluoride" for "magnesium".
        plain(what.split([',', ';']).next().unwrap_or_default()) == wanted
    };
    let mut names: Vec<&str> = NAMES.iter().filter(is_called).copied().collect();
    names.extend(WORDS.iter().filter(|(known, _)| *known == wanted).map(|(_, name)| name));
    names
}

fn unknown(name: &str) -> SpectraError {
    SpectraError::UnknownName { kind: "material", name: name.to_owned() }
}

/// Returns the dispersion of the named material.
///
/// `docs/films.md` lists all with their sources and ranges ([`material_info`]).
///
/// The data sets of chromium differ by 0.5 in n across the visible; evaporated
/// films vary as much. Sapphire (`Al2O3`, n = 1.77) is not a deposited film (`AlOx`).
///
/// The models of metals are valid over the energies of their fits: 5 meV to 20 eV
/// for Al; up to 5 eV (248 nm) for the others, down to 0.02 eV for Cr, 0.04 eV
/// for Ti, 0.1 eV for W and Ag, 0.2 eV for Ni and Au.
///
/// # Errors
/// If the name is not in [`material_names`]; names are case-sensitive.
pub fn material(name: &str) -> Result<Dispersion, SpectraError> {
    match name {
        "air" => Dispersion::constant(1.0, 0.0),
        "SiO2" => sellmeier(&SIO2, (210.0, 3710.0)),
        "MgF2" => sellmeier(&MGF2, (200.0, 7000.0)),
        "Al2O3" => sellmeier(&AL2O3, (200.0, 5000.0)),
        "AlOx" => Dispersion::constant(1.64, 0.0),
        "OCA" => Dispersion::constant(1.47, 0.0),
        "Si3N4" => sellmeier(&SI3N4, (207.0, 1240.0)),
        "BK7" => {
            let [um, k] = [0, 1].map(|column| BK7_K.iter().map(move |row| row[column]));
            let k = Tabulated::new(um.map(|um| 1e3 * um).collect(), k.collect())?;
            Dispersion::formula(2, &BK7, (300.0, 2500.0), Some(k))
        }
        "ITO" => table(&ITO),
        "Cr:Johnson" => table(&CR_JOHNSON),
        _ => match metal(name) {
            Some(metal) => Ok(metal),
            None => catalogue::material(name).unwrap_or_else(|| Err(unknown(name))),
        },
    }
}

fn sellmeier(coefficients: &[f64], range_nm: (f64, f64)) -> Result<Dispersion, SpectraError> {
    Dispersion::formula(1, coefficients, range_nm, None)
}

/// Dispersion from a table of (um, n, k).
fn table(rows: &[(f64, f64, f64)]) -> Result<Dispersion, SpectraError> {
    let nm: Vec<f64> = rows.iter().map(|row| 1e3 * row.0).collect();
    let n = Tabulated::new(nm.clone(), rows.iter().map(|row| row.1).collect())?;
    let k = Tabulated::new(nm, rows.iter().map(|row| row.2).collect())?;
    Dispersion::tabulated(n, Some(k))
}

/// Models of Rakic et al. 1998: plasma energy (table 1, eV), (f0, G0), resonances (f, G, w_j[, s]).
fn metal(name: &str) -> Option<Dispersion> {
    let lorentz_drude = |wp, drude, oscillators: &[Oscillator], range_nm| {
        Some(Dispersion::lorentz_drude(wp, drude, oscillators, range_nm))
    };
    let brendel_bormann = |wp, drude, oscillators: &[(Oscillator, f64)], range_nm| {
        Some(Dispersion::brendel_bormann(wp, drude, oscillators, range_nm))
    };
    match name {
        "Al" => lorentz_drude(14.98, (0.523, 0.047), &AL, AL_RANGE),
        "Cr" => lorentz_drude(10.75, (0.168, 0.047), &CR, CR_RANGE),
        "W" => lorentz_drude(13.22, (0.206, 0.064), &W, W_RANGE),
        "Ni" => lorentz_drude(15.92, (0.096, 0.048), &NI, (248.0, 6199.0)),
        "Ti" => lorentz_drude(7.29, (0.148, 0.082), &TI, (248.0, 30_996.0)),
        "Au" => lorentz_drude(9.03, (0.760, 0.053), &AU, (248.0, 6199.0)),
        "Ag" => lorentz_drude(9.01, (0.845, 0.048), &AG, (248.0, 12_398.0)),
        "Al:BB" => brendel_bormann(14.98, (0.526, 0.047), &AL_BB, AL_RANGE),
        "Cr:BB" => brendel_bormann(10.75, (0.154, 0.048), &CR_BB, CR_RANGE),
        "W:BB" => brendel_bormann(13.22, (0.197, 0.057), &W_BB, W_RANGE),
        _ => None,
    }
}

const AL_RANGE: (f64, f64) = (62.0, 247_970.0);
const CR_RANGE: (f64, f64) = (248.0, 61_992.0);
const W_RANGE: (f64, f64) = (248.0, 12_398.0);

/// Formula 1: 0, then (B, C in um) of each term.
const SIO2: [f64; 7] = [0.0, 0.6961663, 0.0684043, 0.4079426, 0.1162414, 0.8974794, 9.896161];
const MGF2: [f64; 7] = [0.0, 0.48755108, 0.04338408, 0.39875031, 0.09461442, 2.3120353, 23.793604];
const AL2O3: [f64; 7] = [0.0, 1.4313493, 0.0726631, 0.65054713, 0.1193242, 5.3414021, 18.028251];
const SI3N4: [f64; 3] = [0.0, 2.8939, 0.13967];
/// Formula 2: 0, then (B, C^2 in um^2) of each term.
const BK7: [f64; 7] = [0.0, 1.03961212, 0.00600069867, 0.231792344, 0.0200179144, 1.01046945, 103.560653];

/// k of N-BK7, from the internal transmittances of 10 and 25 mm in Schott's data sheet: (um, k).
#[rustfmt::skip]
const BK7_K: [[f64; 2]; 25] = [
    [0.3, 2.8607e-6],
    [0.31, 1.3679e-6],
    [0.32, 6.6608e-7],
    [0.334, 2.6415e-7],
    [0.35, 9.2894e-8],
    [0.365, 3.4191e-8],
    [0.37, 2.7405e-8],
    [0.38, 2.074e-8],
    [0.39, 1.3731e-8],
    [0.4, 1.0227e-8],
    [0.405, 9.0558e-9],
    [0.42, 9.3912e-9],
    [0.436, 1.1147e-8],
    [0.46, 1.0286e-8],
    [0.5, 9.5781e-9],
    [0.546, 6.9658e-9],
    [0.58, 9.2541e-9],
    [0.62, 1.1877e-8],
    [0.66, 1.2643e-8],
    [0.7, 8.9305e-9],
    [1.06, 1.0137e-8],
    [1.53, 9.839e-8],
    [1.97, 1.0933e-6],
    [2.325, 4.2911e-6],
    [2.5, 8.13e-6],
];

const AL: [Oscillator; 4] =
    [(0.227, 0.333, 0.162), (0.050, 0.312, 1.544), (0.166, 1.351, 1.808), (0.030, 3.382, 3.473)];
const CR: [Oscillator; 4] =
    [(0.151, 3.175, 0.121), (0.150, 1.305, 0.543), (1.149, 2.676, 1.970), (0.825, 1.335, 8.775)];
const W: [Oscillator; 4] =
    [(0.054, 0.530, 1.004), (0.166, 1.281, 1.917), (0.706, 3.332, 3.580), (2.590, 5.836, 7.498)];
const NI: [Oscillator; 4] =
    [(0.100, 4.511, 0.174), (0.135, 1.334, 0.582), (0.106, 2.178, 1.597), (0.729, 6.292, 6.089)];
const TI: [Oscillator; 4] =
    [(0.899, 2.276, 0.777), (0.393, 2.518, 1.545), (0.187, 1.663, 2.509), (0.001, 1.762, 19.43)];
const AU: [Oscillator; 5] = [
    (0.024, 0.241, 0.415),
    (0.010, 0.345, 0.830),
    (0.071, 0.870, 2.969),
    (0.601, 2.494, 4.304),
    (4.384, 2.214, 13.32),
];
const AG: [Oscillator; 5] = [
    (0.065, 3.886, 0.816),
    (0.124, 0.452, 4.481),
    (0.011, 0.065, 8.185),
    (0.840, 0.916, 9.083),
    (5.646, 2.419, 20.29),
];
const AL_BB: [(Oscillator, f64); 4] = [
    ((0.213, 0.312, 0.163), 0.013),
    ((0.060, 0.315, 1.561), 0.042),
    ((0.182, 1.587, 1.827), 0.256),
    ((0.014, 2.145, 4.495), 1.735),
];
const CR_BB: [(Oscillator, f64); 4] = [
    ((0.338, 4.256, 0.281), 0.115),
    ((0.261, 3.957, 0.584), 0.252),
    ((0.817, 2.218, 1.919), 0.225),
    ((0.105, 6.983, 6.997), 4.903),
];
const W_BB: [(Oscillator, f64); 4] = [
    ((0.006, 3.689, 0.481), 3.754),
    ((0.022, 0.277, 0.985), 0.059),
    ((0.136, 1.433, 1.962), 0.273),
    ((2.648, 4.555, 5.442), 1.912),
];

/// Koenig et al. 2014, sputtered ITO: (um, n, k), the rows of the page between which lines are 2e-4 from n
/// and 5e-4 from the transmittance of 1 um to 10 mm.
const ITO: [(f64, f64, f64); 41] = [
    (0.35981, 2.1101, 0.019905),
    (0.36459, 2.0996, 0.018426),
    (0.36936, 2.0896, 0.017081),
    (0.37414, 2.0801, 0.015855),
    (0.38050, 2.0682, 0.014387),
    (0.38687, 2.0569, 0.013089),
    (0.39324, 2.0462, 0.011939),
    (0.40119, 2.0336, 0.010683),
    (0.40915, 2.0217, 0.009600),
    (0.41711, 2.0104, 0.008665),
    (0.42506, 1.9996, 0.007857),
    (0.43302, 1.9893, 0.007157),
    (0.44097, 1.9794, 0.006550),
    (0.44893, 1.9697, 0.006024),
    (0.45688, 1.9604, 0.005568),
    (0.46484, 1.9514, 0.005172),
    (0.47279, 1.9425, 0.004828),
    (0.48074, 1.9339, 0.004531),
    (0.48869, 1.9254, 0.004274),
    (0.49664, 1.9171, 0.004052),
    (0.50618, 1.9073, 0.003828),
    (0.51571, 1.8976, 0.003642),
    (0.52525, 1.8880, 0.003491),
    (0.53637, 1.8770, 0.003352),
    (0.54749, 1.8661, 0.003248),
    (0.55861, 1.8552, 0.003174),
    (0.57131, 1.8428, 0.003123),
    (0.58560, 1.8289, 0.003101),
    (0.59988, 1.8150, 0.003113),
    (0.61574, 1.7994, 0.003161),
    (0.63318, 1.7822, 0.003251),
    (0.65062, 1.7647, 0.003376),
    (0.66963, 1.7454, 0.003549),
    (0.69021, 1.7240, 0.003777),
    (0.71077, 1.7021, 0.004046),
    (0.73291, 1.6780, 0.004378),
    (0.75502, 1.6531, 0.004756),
    (0.77870, 1.6256, 0.005212),
    (0.80235, 1.5971, 0.005723),
    (0.82598, 1.5675, 0.006293),
    (0.83070, 1.5615, 0.006414),
];

/// Johnson and Christy 1974: (um, n, k).
#[allow(clippy::approx_constant, reason = "k = 3.14 at 451 nm is a measurement")]
const CR_JOHNSON: [(f64, f64, f64); 18] = [
    (0.354, 1.84, 2.64),
    (0.368, 1.87, 2.69),
    (0.381, 1.92, 2.74),
    (0.397, 2.00, 2.83),
    (0.413, 2.08, 2.93),
    (0.431, 2.19, 3.04),
    (0.451, 2.33, 3.14),
    (0.471, 2.51, 3.24),
    (0.496, 2.75, 3.30),
    (0.521, 2.94, 3.33),
    (0.549, 3.18, 3.33),
    (0.582, 3.22, 3.30),
    (0.617, 3.17, 3.30),
    (0.659, 3.09, 3.34),
    (0.704, 3.05, 3.39),
    (0.756, 3.08, 3.42),
    (0.821, 3.20, 3.48),
    (0.892, 3.30, 3.52),
];

#[cfg(test)]
mod tests {
    use num_complex::Complex64;

    use super::*;
    use crate::Grid;

    fn assert_index(name: &str, nm: f64, expected: Complex64, tolerance: f64) {
        let found = material(name).and_then(|m| m.index(nm)).unwrap();
        assert!((found - expected).norm() < tolerance, "{name} at {nm} nm: {found}, not {expected}");
    }

    /// Values computed independently from the same paper, which
    /// equal its published tables within 1.1e-4.
    #[test]
    fn metals_equal_independently_computed_values() {
        let table = [
            ("Al", [(0.5897, 5.3107), (0.9656, 6.4581), (1.4204, 7.4674)]),
            ("Cr", [(2.1448, 3.8623), (2.9007, 4.2311), (3.5348, 4.3476)]),
            ("Al:BB", [(0.6169, 5.3036), (0.9653, 6.3996), (1.3416, 7.4735)]),
            ("Cr:BB", [(2.0245, 3.8592), (2.7894, 4.1983), (3.4263, 4.2734)]),
        ];
        for (name, values) in table {
            for (nm, (n, k)) in [450.0, 550.0, 650.0].into_iter().zip(values) {
                assert_index(name, nm, Complex64::new(n, k), 1e-4);
            }
        }
    }

    /// The same models as tabulated by refractiveindex.info (5 digits, CC0).
    #[test]
    fn metals_equal_their_published_tables() {
        let table = [
            ("Au", 556.72, (0.47290, 2.4364)),
            ("Ag", 555.18, (0.13465, 3.2132)),
            ("Ti", 550.47, (1.7913, 3.0026)),
            ("Ni", 553.14, (1.8214, 3.2759)),
            ("W", 551.23, (3.4586, 2.7601)),
            ("W:BB", 555.18, (3.5170, 2.7637)),
        ];
        for (name, nm, (n, k)) in table {
            assert_index(name, nm, Complex64::new(n, k), 1.5e-4);
        }
    }

    #[test]
    fn dielectrics_equal_published_indices() {
        assert_index("SiO2", 587.5618, 1.458464.into(), 1e-6);
        assert_index("BK7", 587.5618, 1.516800.into(), 1e-6);
        assert_index("MgF2", 587.5618, 1.3777.into(), 5e-5);
        assert_index("Al2O3", 550.0, 1.770446.into(), 1e-6);
        for (nm, n) in [(450.0, 2.0500), (550.0, 2.0232), (650.0, 2.0085)] {
            assert_index("Si3N4", nm, n.into(), 1e-4);
        }
        assert_index("AlOx", 550.0, 1.64.into(), 1e-15);
        assert_index("ITO", 560.2, Complex64::new(1.854, 0.0032), 5e-4);
        assert_index("Cr:Johnson", 549.0, Complex64::new(3.18, 3.33), 1e-12);
    }

    #[test]
    fn every_material_covers_the_visible_and_is_passive() {
        let grid = Grid::new(380.0, 780.0, 1.0).unwrap();
        for name in material_names() {
            let index = material(name).and_then(|m| m.on(&grid)).unwrap();
            assert!(index.iter().all(|n| n.re > 0.0 && n.im >= 0.0), "{name}");
        }
    }

    #[test]
    fn every_name_is_described_and_spelled_out_names_are_found() {
        for name in material_names() {
            let info = material_info(name).unwrap();
            assert_eq!((info.name, info.range_nm), (*name, material(name).unwrap().range_nm()));
        }
        for (word, names) in [
            ("Aluminium", &["Al", "Al:BB", "Al:McPeak"][..]),
            ("aluminum", &["Al", "Al:BB", "Al:McPeak"]),
            ("Titanium dioxide", &["TiO2", "TiO2:Franta"]),
            ("fused silica", &["SiO2"]),
            ("silica", &["SiO2"]),
            ("MoCr", &["Mo", "Cr:Sytchkova"]),
            ("indium-tin-oxide", &["ITO", "ITO:Minenkov", "ITO:Minenkov-top", "ITO:Minenkov-bottom"]),
            ("unobtainium", &[]),
            ("", &[]),
        ] {
            assert_eq!(materials_called(word), names, "{word}");
        }
        assert!(WORDS.iter().all(|(_, name)| material(name).is_ok()));
    }

    #[test]
    fn unknown_material_is_an_error() {
        let error = material("unobtainium").unwrap_err();
        assert_eq!(error.to_string(), "there is no material named `unobtainium`");
    }
}
