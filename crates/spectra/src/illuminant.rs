//! Spectra of light sources: CIE illuminants, black bodies, daylight and an LED model.
//!
//! Each function returns a *relative* spectral power distribution, per nm. To scale it
//! to lux, use `papilio_colour::Observer::scale_to_illuminance`.
//!
//! | light | parameters | valid | source |
//! |---|---|---|---|
//! | [`illuminant`] | a CIE name | 380 to 780 nm; E: any wavelength | the CIE's tables, every 1 or 5 nm (`data/README.md`) |
//! | [`daylight`] | CCT, 4000 to 25 000 K | 380 to 780 nm | CIE 15:2018, the D series; components S0, S1, S2 at 5 nm, linear between |
//! | [`planck`] | temperature, 500 to 100 000 K | any wavelength | Planck's law, CODATA 2014 constants |
//! | [`ohno_led`] | peak, width | any wavelength | Ohno, Opt. Eng. 44(11), 111302 (2005) |
//!
//! Tables are linear between their points and never extrapolated: a grid that
//! extends beyond 380 to 780 nm is an error for tabulated light.
//!
//! The tables of discharge lamps (FL1 to FL12, FL3.1 to FL3.15, HP1 to HP5) give the power in bands of 5 nm:
//! a mercury line is as wide as its band. On a grid with those wavelengths, colours are within 0.0003 in x
//! and y of the published ones, which are sums over the bands. A grid between those wavelengths, or a coarser
//! one, misses lines or counts them twice.
//!
//! The names of the D series give the *nominal* temperature: D65 has
//! 6504 K, because the second radiation constant was revised after D65 was
//! defined. `daylight(6500.0, ..)` is therefore close to D65, but not equal.

use std::f64::consts::PI;
use std::sync::LazyLock;

use crate::{Grid, SpectraError, Spectrum, Tabulated, table};

/// First and last wavelength of the CIE's tables, nm.
const TABLES_NM: (u32, u32) = (380, 780);
/// Temperature range of the definition of the D series, K.
const DAYLIGHT_K: (f64, f64) = (4000.0, 25_000.0);
/// Accepted temperatures of black bodies, K.
const PLANCK_K: (f64, f64) = (500.0, 100_000.0);

/// CODATA 2014: speed of light, m/s; Planck's constant, J s; Boltzmann's constant, J/K.
const C: f64 = 299_792_458.0;
const H: f64 = 6.626_070_040_818_1e-34;
const K: f64 = 1.380_648_527_9e-23;

const CIE_2018: &str = "CIE 015:2018";
const CIE_2004: &str = "CIE 015:2004";

/// Illuminants of the CIE: name, what it is, step of its table in nm (0: a constant), source.
#[rustfmt::skip]
const ILLUMINANTS: [(&str, &str, u32, &str); 49] = [
    ("A", "incandescent lamp, 2856 K", 1, "CIE 015:2018; ISO/CIE 11664-2"),
    ("C", "daylight of 6774 K, from A with filters; obsolete", 5, CIE_2004),
    ("D50", "daylight, horizon; graphic arts", 1, CIE_2018),
    ("D55", "daylight, mid-morning", 5, CIE_2018),
    ("D60", "daylight", 5, "CIE 015:2018, formula of the D series"),
    ("D65", "daylight, noon", 1, CIE_2018),
    ("D75", "daylight, north sky", 5, CIE_2018),
    ("E", "equal energy", 0, CIE_2018),
    ("FL1", "fluorescent, standard: daylight", 5, CIE_2004),
    ("FL2", "fluorescent, standard: cool white (CWF)", 5, CIE_2004),
    ("FL3", "fluorescent, standard: white", 5, CIE_2004),
    ("FL4", "fluorescent, standard: warm white (WWF)", 5, CIE_2004),
    ("FL5", "fluorescent, standard: daylight", 5, CIE_2004),
    ("FL6", "fluorescent, standard: light white", 5, CIE_2004),
    ("FL7", "fluorescent, broad-band: simulates D65 (DLF)", 5, CIE_2004),
    ("FL8", "fluorescent, broad-band: simulates D50", 5, CIE_2004),
    ("FL9", "fluorescent, broad-band: cool white de luxe", 5, CIE_2004),
    ("FL10", "fluorescent, three narrow bands (as TL85)", 5, CIE_2004),
    ("FL11", "fluorescent, three narrow bands (as TL84)", 5, CIE_2004),
    ("FL12", "fluorescent, three narrow bands (as TL83)", 5, CIE_2004),
    ("FL3.1", "fluorescent, halophosphate", 5, CIE_2004),
    ("FL3.2", "fluorescent, halophosphate", 5, CIE_2004),
    ("FL3.3", "fluorescent, halophosphate", 5, CIE_2004),
    ("FL3.4", "fluorescent, de luxe", 5, CIE_2004),
    ("FL3.5", "fluorescent, de luxe", 5, CIE_2004),
    ("FL3.6", "fluorescent, de luxe", 5, CIE_2004),
    ("FL3.7", "fluorescent, three bands", 5, CIE_2004),
    ("FL3.8", "fluorescent, three bands", 5, CIE_2004),
    ("FL3.9", "fluorescent, three bands", 5, CIE_2004),
    ("FL3.10", "fluorescent, three bands", 5, CIE_2004),
    ("FL3.11", "fluorescent, three bands", 5, CIE_2004),
    ("FL3.12", "fluorescent, multi-band", 5, CIE_2004),
    ("FL3.13", "fluorescent, multi-band", 5, CIE_2004),
    ("FL3.14", "fluorescent, multi-band", 5, CIE_2004),
    ("FL3.15", "fluorescent, simulates D65", 5, CIE_2004),
    ("HP1", "high-pressure sodium lamp", 5, CIE_2004),
    ("HP2", "high-pressure sodium lamp, colour-enhanced", 5, CIE_2004),
    ("HP3", "high-pressure metal halide lamp", 5, CIE_2004),
    ("HP4", "high-pressure metal halide lamp", 5, CIE_2004),
    ("HP5", "high-pressure metal halide lamp", 5, CIE_2004),
    ("LED-B1", "blue LED with phosphor, 2733 K", 1, CIE_2018),
    ("LED-B2", "blue LED with phosphor, 2998 K", 1, CIE_2018),
    ("LED-B3", "blue LED with phosphor, 4103 K", 1, CIE_2018),
    ("LED-B4", "blue LED with phosphor, 5109 K", 1, CIE_2018),
    ("LED-B5", "blue LED with phosphor, 6598 K", 1, CIE_2018),
    ("LED-BH1", "blue LED with phosphor, and a red LED", 1, CIE_2018),
    ("LED-RGB1", "red, green and blue LEDs", 1, CIE_2018),
    ("LED-V1", "violet LED with phosphors", 1, CIE_2018),
    ("LED-V2", "violet LED with phosphors", 1, CIE_2018),
];

/// Other names that people write, upper case without separators. TL84 and its kin are lamps of one
/// manufacturer, of the type that the CIE's illuminant averages.
const ALIASES: [(&str, &str); 13] = [
    ("CWF", "FL2"),
    ("CWF2", "FL2"),
    ("DLF", "FL7"),
    ("DLF7", "FL7"),
    ("HPS", "HP1"),
    ("TL83", "FL12"),
    ("TL84", "FL11"),
    ("TL85", "FL10"),
    ("U30", "FL12"),
    ("ULTRALUME30", "FL12"),
    ("ULTRALUME40", "FL11"),
    ("ULTRALUME50", "FL10"),
    ("WWF", "FL4"),
];

/// Words that are no name of one illuminant, but suggest some.
const WORDS: [(&str, &[&str]); 10] = [
    ("BULB", &["A"]),
    ("COOLWHITE", &["FL2", "FL9"]),
    ("DAYLIGHT", &["D65", "D50"]),
    ("FLUORESCENT", &["FL2", "FL7", "FL11"]),
    ("HALOGEN", &["A"]),
    ("INCANDESCENT", &["A"]),
    ("LED", &["LED-B1", "LED-B3", "LED-B5"]),
    ("SODIUM", &["HP1"]),
    ("TUNGSTEN", &["A"]),
    ("WARMWHITE", &["FL4", "LED-B1"]),
];

static NAMES: LazyLock<Vec<&'static str>> = LazyLock::new(|| ILLUMINANTS.iter().map(|one| one.0).collect());

/// A CIE illuminant, without its numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct IlluminantInfo {
    /// Name in the spelling of the CIE.
    pub name: &'static str,
    /// The lamp or light.
    pub what: &'static str,
    /// Step of its table, nm; 0 if it is constant.
    pub step_nm: u32,
    /// Publication.
    pub source: &'static str,
}

/// Names of the CIE's illuminants, in the spelling of the CIE.
pub fn illuminant_names() -> &'static [&'static str] {
    &NAMES
}

/// Describes the illuminant of this name or alias; `None` if it is not tabulated.
pub fn illuminant_info(name: &str) -> Option<IlluminantInfo> {
    let known = illuminant_name(name)?;
    let &(name, what, step_nm, source) = ILLUMINANTS.iter().find(|one| one.0 == known)?;
    Some(IlluminantInfo { name, what, step_nm, source })
}

/// Returns the name in the spelling of the CIE for any name that [`illuminant`] accepts: `F11`, `fl 11` and
/// `TL84` are FL11. `None` for other names.
///
/// ```
/// use papilio_spectra::illuminant_name;
/// assert_eq!(illuminant_name("TL84"), Some("FL11"));
/// assert_eq!(illuminant_name("f3.4"), Some("FL3.4"));
/// assert_eq!(illuminant_name("D66"), None);
/// ```
pub fn illuminant_name(name: &str) -> Option<&'static str> {
    let wanted = normalised(name);
    let wanted = ALIASES.iter().find(|(alias, _)| *alias == wanted).map_or(&*wanted, |(_, name)| name);
    // The older tables of the CIE call them F1 to F12.
    let with_l = wanted.strip_prefix('F').map(|number| format!("FL{number}"));
    let is = |known: &&str| normalised(known) == wanted || Some(normalised(known)) == with_l;
    ILLUMINANTS.iter().map(|one| one.0).find(is)
}

/// Returns the correlated colour temperature, K, of daylight that is named after it: `D93` has 9300 K times
/// 1.4388/1.4380, by the second radiation constant of the D series. `None` for other names, and outside 4000
/// to 25 000 K.
///
/// ```
/// assert_eq!(papilio_spectra::named_daylight_k("D93").map(f64::round), Some(9305.0));
/// ```
pub fn named_daylight_k(name: &str) -> Option<f64> {
    let name = normalised(name);
    let number = name.strip_prefix('D').filter(|number| (2..=3).contains(&number.len()))?;
    let nominal_k = 100.0 * f64::from(number.parse::<u16>().ok()?);
    let cct_k = nominal_k * 1.4388 / 1.4380;
    (DAYLIGHT_K.0..=DAYLIGHT_K.1).contains(&cct_k).then_some(cct_k)
}

/// Returns the names of illuminants that a word suggests: `incandescent` is A; empty for an unknown word.
pub fn illuminants_called(word: &str) -> &'static [&'static str] {
    let wanted = normalised(word);
    WORDS.iter().find(|(known, _)| *known == wanted).map_or(&[], |(_, names)| names)
}

/// Returns the CIE illuminant of that name on `grid`, relative.
///
/// Case is ignored, and so are `-`, `_` and spaces
/// (`led_b5`, `LED-B5`). `F11` and `TL84` are FL11; see [`illuminant_name`].
///
/// # Errors
/// For a name that [`illuminant_name`] does not know, and for a grid that
/// extends beyond 380 to 780 nm, except for E.
pub fn illuminant(name: &str, grid: &Grid) -> Result<Spectrum, SpectraError> {
    let unknown = || SpectraError::UnknownName { kind: "illuminant", name: name.to_owned() };
    let known = illuminant_name(name).ok_or_else(unknown)?;
    match table::illuminant(known) {
        Some(table) => table?.on(grid),
        // Equal energy is constant everywhere.
        None => Ok(Spectrum::constant(grid, 1.0)),
    }
}

/// Returns CIE daylight of a correlated colour temperature on `grid`, relative.
///
/// # Errors
/// For a temperature outside 4000 to 25 000 K, and for a grid that extends beyond 380 to 780 nm.
pub fn daylight(cct_k: f64, grid: &Grid) -> Result<Spectrum, SpectraError> {
    within("the colour temperature of daylight, K,", cct_k, DAYLIGHT_K)?;
    let t = cct_k;
    let x = if t <= 7000.0 {
        0.244063 + 0.09911e3 / t + 2.9678e6 / t.powi(2) - 4.607e9 / t.powi(3)
    } else {
        0.23704 + 0.24748e3 / t + 1.9018e6 / t.powi(2) - 2.0064e9 / t.powi(3)
    };
    let y = -3.0 * x.powi(2) + 2.87 * x - 0.275;
    let m = 0.0241 + 0.2562 * x - 0.7341 * y;
    let m1 = (-1.3515 - 1.7703 * x + 5.9114 * y) / m;
    let m2 = (0.03 - 31.4424 * x + 30.0717 * y) / m;
    let nodes: Vec<f64> = table::daylight_components().map(|[s0, s1, s2]| s0 + m1 * s1 + m2 * s2).collect();
    let every_nm: Vec<f64> = (TABLES_NM.0..=TABLES_NM.1).map(|nm| between(&nodes, nm)).collect();
    let scale = 1.0 / every_nm.iter().sum::<f64>();
    let values = every_nm.iter().map(|value| value * scale).collect();
    Tabulated::new((TABLES_NM.0..=TABLES_NM.1).map(f64::from).collect(), values)?.on(grid)
}

/// Interpolates a table of equidistant nodes over the range of the CIE's tables, at an integer wavelength in
/// nm.
fn between(nodes: &[f64], nm: u32) -> f64 {
    // Units of metres and this order of operations keep results the same to the last bit across versions.
    let [first, last, here] = [TABLES_NM.0, TABLES_NM.1, nm].map(|nm| f64::from(nm) * 1e-9);
    let position = ((here - first) / (last - first)).clamp(0.0, 1.0) * nodes.len().saturating_sub(1) as f64;
    let (left, fraction) = (position.trunc() as usize, position.fract());
    match nodes[left..] {
        [here, next, ..] => here * (1.0 - fraction) + next * fraction,
        [.., last] => last,
        [] => f64::NAN,
    }
}

/// Returns the spectrum of a black body of that temperature on `grid`, relative.
///
/// # Errors
/// For a temperature outside 500 to 100 000 K.
pub fn planck(temperature_k: f64, grid: &Grid) -> Result<Spectrum, SpectraError> {
    within("the temperature of a black body, K,", temperature_k, PLANCK_K)?;
    let (c1, c2) = (2.0 * PI * H * C * C, H * C / K);
    Ok(Spectrum::from_fn(grid, |nm| {
        let m = nm * 1e-9;
        1e-9 * (c1 / m.powi(5) / ((c2 / (m * temperature_k)).exp() - 1.0))
    }))
}

/// Returns the spectrum of a single-colour LED on `grid`, 1 at its peak: `(g + 2 g^5)/3` with
/// `g = exp(-((l - peak)/width)^2)`. The full width at half maximum is 0.92 `width_nm`.
///
/// # Errors
/// For a peak outside 100 to 10 000 nm or a width outside 0.1 to 1000 nm.
pub fn ohno_led(grid: &Grid, peak_nm: f64, width_nm: f64) -> Result<Spectrum, SpectraError> {
    within("the peak wavelength of an LED, nm,", peak_nm, (100.0, 10_000.0))?;
    within("the width of an LED, nm,", width_nm, (0.1, 1000.0))?;
    Ok(Spectrum::from_fn(grid, |nm| {
        let g = (-((nm - peak_nm) / width_nm).powi(2)).exp();
        (g + 2.0 * g.powi(5)) / 3.0
    }))
}

/// Converts a name to upper case without separators.
fn normalised(name: &str) -> String {
    name.to_uppercase().replace(['-', '_', ' '], "")
}

fn within(quantity: &'static str, value: f64, range: (f64, f64)) -> Result<(), SpectraError> {
    if (range.0..=range.1).contains(&value) { Ok(()) } else { Err(outside(quantity, value, range)) }
}

fn outside(quantity: &'static str, value: f64, (first, last): (f64, f64)) -> SpectraError {
    SpectraError::OutsideModel { quantity, value, first, last }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn visible(step_nm: f64) -> Grid {
        Grid::new(380.0, 780.0, step_nm).unwrap()
    }

    /// ISO 11664-2 (CIE standard illuminants D65 and A), relative to 100 at 560 nm.
    #[test]
    fn names_aliases_and_words_find_their_illuminants() {
        for (name, known) in [("TL84", "FL11"), ("d65", "D65"), ("led_b5", "LED-B5")] {
            let info = illuminant_info(name).unwrap();
            assert_eq!(info.name, known);
            assert!(!info.what.is_empty() && !info.source.is_empty());
        }
        assert_eq!(illuminant_info("D66"), None);
        assert_eq!(illuminants_called("bulb"), ["A"]);
        assert!(illuminants_called("moonlight").is_empty());
    }

    #[test]
    fn illuminants_a_d65_and_e_equal_published_values() {
        let grid = visible(5.0);
        let at = |s: &Spectrum, nm: f64| s[((nm - 380.0) / 5.0) as usize];
        let d65 = illuminant("D65", &grid).unwrap();
        for (nm, value) in [(400.0, 82.7549), (460.0, 117.812), (560.0, 100.0), (650.0, 80.0268)] {
            assert!((100.0 * at(&d65, nm) / at(&d65, 560.0) - value).abs() < 1e-3, "D65 at {nm} nm");
        }
        let a = illuminant("a", &grid).unwrap();
        for (nm, value) in [(400.0, 14.708), (500.0, 59.8611), (700.0, 198.261)] {
            assert!((100.0 * at(&a, nm) / at(&a, 560.0) - value).abs() < 1e-3, "A at {nm} nm");
        }
        assert!(illuminant("E", &grid).unwrap().is_constant());
    }

    #[test]
    fn every_illuminant_name_is_found_in_any_spelling() {
        let grid = visible(20.0);
        for name in illuminant_names() {
            let exact = illuminant(name, &grid).unwrap();
            assert_eq!(illuminant(&name.to_lowercase().replace('-', "_"), &grid).unwrap(), exact, "{name}");
            assert!(exact.iter().all(|v| v.is_finite() && *v >= 0.0), "{name}");
        }
        assert_eq!(illuminant("led b5", &grid), illuminant("LED-B5", &grid));
    }

    #[test]
    fn names_that_people_write_are_found() {
        for (name, expected) in [
            ("F11", "FL11"),
            ("f 2", "FL2"),
            ("F3.15", "FL3.15"),
            ("TL84", "FL11"),
            ("tl-85", "FL10"),
            ("CWF", "FL2"),
            ("hps", "HP1"),
            ("d65", "D65"),
        ] {
            assert_eq!(illuminant_name(name), Some(expected), "{name}");
            let grid = visible(5.0);
            assert_eq!(illuminant(name, &grid), illuminant(expected, &grid), "{name}");
        }
        assert!(ALIASES.iter().all(|(_, name)| NAMES.contains(name)));
        assert!(WORDS.iter().flat_map(|(_, names)| *names).all(|name| NAMES.contains(name)));
        assert_eq!(illuminants_called("Incandescent"), ["A"]);
        // The tables of D55 and D75 are those of the series at nominal temperatures.
        let grid = visible(5.0);
        for (name, nominal) in [("D55", 55.0), ("D75", 75.0), ("D60", 60.0)] {
            let (table, series) = (
                illuminant(name, &grid).unwrap(),
                daylight(100.0 * nominal * 1.4388 / 1.4380, &grid).unwrap(),
            );
            for i in 0..grid.len() {
                assert!((table[i] / table[36] - series[i] / series[36]).abs() < 2e-4, "{name} {i}");
            }
        }
    }

    #[test]
    fn table_is_linear_between_integer_wavelengths() {
        let quarter = illuminant("LED-RGB1", &visible(0.25)).unwrap();
        let whole = illuminant("LED-RGB1", &visible(1.0)).unwrap();
        for i in 0..400 {
            let expected = 0.75 * whole[i] + 0.25 * whole[i + 1];
            assert!((quarter[4 * i + 1] - expected).abs() < 1e-12);
        }
    }

    /// The two cubics of the chromaticity of daylight meet at 7000 K but for the rounding of their coefficients: x = 0.3053574 and
    /// 0.3053570. CIE 15 takes the first there.
    #[test]
    fn daylight_at_7000_k_has_the_chromaticity_of_the_first_cubic() {
        let grid = visible(5.0);
        let at = |kelvin: f64| daylight(kelvin, &grid).unwrap();
        let step = |from: f64, to: f64| (at(to)[0] / at(to)[36]) / (at(from)[0] / at(from)[36]) - 1.0;
        let (below, above) = (step(6999.999, 7000.0), step(7000.0, 7000.001));
        assert!(below.abs() < 1e-6 && below.abs() < above.abs(), "{below:e} {above:e}");
    }

    #[test]
    fn daylight_at_6504_k_equals_d65() {
        let grid = visible(5.0);
        let (ours, d65) = (daylight(6504.0, &grid).unwrap(), illuminant("D65", &grid).unwrap());
        let i560 = 36;
        for i in 0..grid.len() {
            assert!((ours[i] / ours[i560] - d65[i] / d65[i560]).abs() < 5e-4, "{} nm", grid.wavelength_nm(i));
        }
    }

    /// Illuminant A is a black body of nominally 2856 K; with the present constants, 2855.54 K.
    #[test]
    fn planck_equals_illuminant_a_and_follows_wien() {
        let grid = visible(10.0);
        let (ours, a) = (planck(2855.54, &grid).unwrap(), illuminant("A", &grid).unwrap());
        for i in 0..grid.len() {
            assert!((ours[i] / ours[18] / (a[i] / a[18]) - 1.0).abs() < 1e-4);
        }
        let wide = Grid::new(400.0, 700.0, 0.1).unwrap();
        let light = planck(5500.0, &wide).unwrap();
        let peak = (0..wide.len()).max_by(|&i, &j| light[i].total_cmp(&light[j])).unwrap();
        assert!((wide.wavelength_nm(peak) - 2_897_771.955 / 5500.0).abs() < 0.1);
    }

    #[test]
    fn ohno_led_has_peak_one_and_width_092() {
        let grid = Grid::new(300.0, 1100.0, 0.1).unwrap();
        let led = ohno_led(&grid, 525.0, 35.0).unwrap();
        assert!((led.max() - 1.0).abs() < 1e-12);
        let above = led.iter().filter(|v| **v >= 0.5).count() as f64 * 0.1;
        assert!((above / 35.0 - 0.92).abs() < 0.01, "{above}");
    }

    #[test]
    fn wavelength_name_or_parameter_out_of_range_is_refused() {
        let (grid, wide) = (visible(5.0), Grid::new(380.0, 785.0, 5.0).unwrap());
        assert!(matches!(illuminant("D65", &wide), Err(SpectraError::OutsideTable { .. })));
        assert!(matches!(daylight(5000.0, &wide), Err(SpectraError::OutsideTable { .. })));
        assert!(matches!(illuminant("D66", &grid), Err(SpectraError::UnknownName { .. })));
        for name in [
            "", "-", "\u{df}", "LED", "FL", "FL13", "FL3.16", "HP6", "F13", "F", "D", "D6", "D651", "D-",
            "D6504",
        ] {
            assert!(illuminant(name, &grid).is_err(), "{name}");
        }
        for t in [3999.0, 25_001.0, f64::NAN] {
            assert!(matches!(daylight(t, &grid), Err(SpectraError::OutsideModel { .. })));
        }
        assert!(planck(0.0, &grid).is_err());
        assert!(ohno_led(&grid, 525.0, 0.0).is_err());
        assert!(ohno_led(&grid, f64::INFINITY, 20.0).is_err());
    }
}
