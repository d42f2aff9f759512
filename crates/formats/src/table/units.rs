//! Units in the names of columns, and the values in the units of Papilio.

use super::rounding::Digits;

/// A unit, with the factor to the base unit of its kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Unit {
    /// A length, nm.
    Length(f64),
    /// A wavenumber, 1/cm.
    Wavenumber(f64),
    /// A photon energy, eV.
    Energy(f64),
    /// A frequency of light, THz.
    Frequency(f64),
    /// An angle, degrees.
    Angle(f64),
    /// A part of the whole: 0.01 for per cent.
    Fraction(f64),
    /// Per steradian.
    PerSteradian,
    /// A power spectral density of heights, um^4.
    Density(f64),
    /// A spectral density per wavelength, whose scale has no meaning.
    PerWavelength,
    /// Any quantity in an arbitrary scale.
    Relative,
    /// Counts of a detector.
    Counts,
}

/// Quantity of a column's values, which determines its units and the unit of Papilio.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Dimension {
    /// A wavelength, in nm; wavenumbers, photon energies and frequencies are converted.
    Wavelength,
    /// An angle, in degrees.
    Angle,
    /// A part of the whole, 1.
    Fraction,
    /// A number without a unit: n, k, L\*.
    Number,
    /// A BSDF, in 1/sr.
    Bsdf,
    /// A spectrum of light, of any scale, per wavelength.
    Light,
    /// A spatial frequency, in 1/um.
    SpatialFrequency,
    /// A two-dimensional power spectral density of heights, in um^4.
    Density,
    /// Text: the name of a state.
    Text,
}

/// Product of wavelength in nm and photon energy in eV (h c / e, exact in the SI of 2019).
const NM_EV: f64 = 1_239.841_984_332_002_6;
/// Product of wavelength in nm and frequency in THz.
const NM_THZ: f64 = 299_792.458;
/// Product of wavelength in nm and wavenumber in 1/cm.
const NM_PER_CM: f64 = 1e7;

/// Units and their names, in small letters, without blanks and with `u` for the micro sign. `A`, `meV`, `MeV`
/// and `Grad` need their case.
#[rustfmt::skip]
const UNITS: [(Unit, &[&str]); 29] = [
    (Unit::Length(1.0), &["nm", "nanometer", "nanometers", "nanometre", "nanometres"]),
    (Unit::Length(1e3), &["um", "micron", "microns", "micrometer", "micrometers", "micrometre", "micrometres", "mum"]),
    (Unit::Length(0.1), &["angstrom", "angstroms", "aangstroem", "ang"]),
    (Unit::Length(1e-3), &["pm"]),
    (Unit::Length(1e6), &["mm"]),
    (Unit::Length(1e9), &["m"]),
    (Unit::Wavenumber(1.0), &["cm-1", "1/cm", "/cm", "percm", "kayser"]),
    (Unit::Wavenumber(1e4), &["um-1", "1/um", "/um", "perum", "cycles/um", "cyclesperum", "c/um"]),
    (Unit::Wavenumber(1e7), &["nm-1", "1/nm", "/nm", "pernm"]),
    (Unit::Wavenumber(10.0), &["mm-1", "1/mm", "/mm", "permm", "cycles/mm", "cyclespermm", "lp/mm"]),
    (Unit::Energy(1.0), &["ev", "electronvolt", "electronvolts"]),
    (Unit::Frequency(1.0), &["thz"]),
    (Unit::Frequency(1e-12), &["hz"]),
    (Unit::Angle(1.0), &["deg", "degs", "degree", "degrees"]),
    (Unit::Angle(180.0 / std::f64::consts::PI), &["rad", "rads", "radian", "radians"]),
    (Unit::Angle(0.18 / std::f64::consts::PI), &["mrad"]),
    (Unit::Fraction(1.0), &["", "1", "-", "fraction", "fractions", "0-1", "0..1", "0to1", "ratio", "unitless", "dimensionless", "none"]),
    (Unit::Fraction(1e-2), &["%", "percent", "pct", "prozent", "pourcent", "%r", "%t", "r%", "t%"]),
    (Unit::Fraction(1e-3), &["permille", "\u{2030}"]),
    (Unit::PerSteradian, &["1/sr", "sr-1", "/sr", "persr", "persteradian", "1/steradian"]),
    (Unit::Density(1.0), &["um4"]),
    (Unit::Density(1e-12), &["nm4"]),
    (Unit::Relative, &["a.u.", "a.u", "au", "arb.", "arb", "arb.u.", "arb.units", "arbitraryunits", "arbitrary", "rel.", "relative"]),
    (Unit::PerWavelength, &["w/nm", "mw/nm", "uw/nm", "nw/nm"]),
    (Unit::PerWavelength, &["w/m2/nm", "w/m2nm", "w/(m2nm)", "wm-2nm-1", "mw/m2/nm", "mw/(m2nm)", "mwm-2nm-1", "uw/cm2/nm", "uw/(cm2nm)", "uwcm-2nm-1"]),
    (Unit::PerWavelength, &["w/m2/um", "w/(m2um)", "wm-2um-1", "w/sr/m2/nm", "w/m2/sr/nm", "w/m2sr/nm", "w/(m2srnm)", "wm-2sr-1nm-1", "mw/m2/sr/nm", "uw/cm2/sr/nm"]),
    (Unit::PerWavelength, &["w/m2", "w", "mw", "uw", "w/sr/nm", "w/(srnm)"]),
    (Unit::Counts, &["counts", "count", "cts", "dn", "adu"]),
    (Unit::Counts, &["counts/s", "cps"]),
];

/// Returns the unit with this name.
pub(crate) fn unit(text: &str) -> Option<Unit> {
    let text = text.trim();
    let text = text.strip_prefix("in ").unwrap_or(text).trim();
    match text {
        "A" | "\u{c5}" | "\u{212b}" => return Some(Unit::Length(0.1)),
        "meV" => return Some(Unit::Energy(1e-3)),
        "MeV" => return None,
        // German for degrees. `grad` is also a gon, a hundredth of a right angle, and is refused.
        "\u{b0}" | "Grad" => return Some(Unit::Angle(1.0)),
        _ => {}
    }
    let plain: String = text.chars().filter_map(plain).flat_map(char::to_lowercase).collect();
    let plain = plain.replace("**", "").replace("per cent", "percent");
    let plain: String = plain.chars().filter(|c| !c.is_whitespace() && *c != '_').collect();
    UNITS.iter().find(|(_, names)| names.contains(&plain.as_str())).map(|(unit, _)| *unit)
}

/// Returns a character as ASCII where units use it; `None` for marks of powers and products.
fn plain(c: char) -> Option<char> {
    Some(match c {
        '\u{b5}' | '\u{3bc}' => 'u',
        '\u{207b}' | '\u{2212}' | '\u{2013}' => '-',
        '\u{b9}' => '1',
        '\u{b2}' => '2',
        '\u{2074}' => '4',
        '^' | '\u{b7}' | '\u{22c5}' => return None,
        c => c,
    })
}

impl Unit {
    /// Returns whether values in this unit can be converted to those of a quantity.
    pub(crate) fn fits(self, dimension: Dimension) -> bool {
        use Dimension as D;
        match self {
            Self::Length(_) | Self::Energy(_) | Self::Frequency(_) => dimension == D::Wavelength,
            Self::Wavenumber(_) => matches!(dimension, D::Wavelength | D::SpatialFrequency),
            Self::Angle(_) => dimension == D::Angle,
            Self::Fraction(factor) => match dimension {
                D::Fraction | D::Light => true,
                D::Number => factor == 1.0,
                _ => false,
            },
            Self::PerSteradian => dimension == D::Bsdf,
            Self::Density(_) => dimension == D::Density,
            Self::PerWavelength => dimension == D::Light,
            Self::Relative | Self::Counts => matches!(dimension, D::Light | D::Bsdf),
        }
    }

    /// Returns whether values in this unit were probably converted before they were written, and are rounded.
    pub(crate) fn is_rounded(self, dimension: Dimension) -> bool {
        match self {
            Self::Wavenumber(_) | Self::Energy(_) | Self::Frequency(_) => dimension == Dimension::Wavelength,
            Self::Angle(factor) => factor != 1.0,
            _ => false,
        }
    }

    /// Returns the largest error of a converted value, in the unit of Papilio: of the rounding of a value in
    /// this unit with these digits, and of the constants with which others convert.
    pub(crate) fn error(self, value: f64, digits: Digits, dimension: Dimension) -> f64 {
        let error = digits.error(value);
        match (self, dimension) {
            (Self::Angle(factor), _) => error * factor,
            (Self::Energy(_) | Self::Frequency(_) | Self::Wavenumber(_), Dimension::Wavelength) => {
                // 1239.8 eV nm instead of 1239.842, 3e5 nm THz is no rounding.
                let constant = if matches!(self, Self::Wavenumber(_)) { 0.0 } else { 4e-5 };
                self.convert(value, dimension) * (error / value.abs() + constant)
            }
            _ => error,
        }
    }

    /// Returns a value in the unit of Papilio.
    pub(crate) fn convert(self, value: f64, dimension: Dimension) -> f64 {
        match (self, dimension) {
            (Self::Length(1.0) | Self::Angle(1.0) | Self::Fraction(1.0) | Self::Density(1.0), _) => value,
            (Self::Wavenumber(factor), Dimension::SpatialFrequency) => value * factor / 1e4,
            (Self::Length(factor), _) => rounded(value * factor),
            (Self::Wavenumber(factor), _) => rounded(NM_PER_CM / (value * factor)),
            (Self::Energy(factor), _) => rounded(NM_EV / (value * factor)),
            (Self::Frequency(factor), _) => rounded(NM_THZ / (value * factor)),
            (Self::Angle(factor), _) => value * factor,
            (Self::Fraction(factor), _) => value / (1.0 / factor).round(),
            (Self::Density(factor), _) => value * factor,
            (Self::PerSteradian | Self::PerWavelength | Self::Relative | Self::Counts, _) => value,
        }
    }
}

impl Dimension {
    /// Returns the units of the quantity, in words.
    pub(crate) fn units(self) -> &'static str {
        match self {
            Self::Wavelength => "nm, um, angstrom, cm-1, eV, THz or Hz",
            Self::Angle => "deg, rad or mrad",
            Self::Fraction => "1 or %",
            Self::Number | Self::Text => "no unit",
            Self::Bsdf => "1/sr, or a.u. or counts for values in relative units",
            Self::Light => "a spectral density per nm, such as W/m2/nm, or a.u.",
            Self::SpatialFrequency => "1/um or 1/mm",
            Self::Density => "um4 or nm4",
        }
    }
}

/// Removes the rounding errors of a conversion: 0.57 um are exactly 570 nm.
fn rounded(nm: f64) -> f64 {
    let near = (nm * 1e6).round() / 1e6;
    if (near - nm).abs() <= 1e-12 * nm.abs() { near } else { nm }
}

/// Returns whether angles without a unit are probably in radians: none exceeds the largest value of its set in radians,
/// and not all are whole numbers, as those of a few degrees are. Each set of angles comes with its largest value.
pub(crate) fn may_be_radians<'a>(sets: impl IntoIterator<Item = (f64, &'a [f64])>) -> bool {
    let mut is_whole = true;
    let all_fit = sets.into_iter().all(|(most, angles)| {
        is_whole &= angles.iter().all(|angle| angle.fract() == 0.0);
        angles.iter().all(|angle| angle.abs() <= most)
    });
    all_fit && !is_whole
}

/// Largest inclinations, tilts and azimuths in radians, rounded up.
pub(crate) const QUARTER_TURN: f64 = std::f64::consts::FRAC_PI_2 + ROUNDED;
pub(crate) const HALF_TURN: f64 = std::f64::consts::PI + ROUNDED;
pub(crate) const TURN: f64 = std::f64::consts::TAU + ROUNDED;
/// What three rounded decimals can add to an angle, rad.
const ROUNDED: f64 = 1e-3;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_found_and_converted() {
        let nm = |text: &str, value: f64| unit(text).unwrap().convert(value, Dimension::Wavelength);
        for (text, value) in [
            ("nm", 550.0),
            ("\u{b5}m", 0.55),
            ("\u{3bc}m", 0.55),
            ("um", 0.55),
            ("A", 5500.0),
            ("\u{c5}", 5500.0),
            ("Angstrom", 5500.0),
            ("cm-1", 1e7 / 550.0),
            ("cm\u{207b}\u{b9}", 1e7 / 550.0),
            ("cm^-1", 1e7 / 550.0),
            ("1/cm", 1e7 / 550.0),
            // 2018 CODATA: h c = 1.239841984e-6 eV m.
            ("eV", 1239.841984332 / 550.0),
            ("THz", 299792.458 / 550.0),
            ("m", 550e-9),
        ] {
            assert!((nm(text, value) - 550.0).abs() < 1e-9, "{text}: {}", nm(text, value));
        }
        assert_eq!((nm("um", 0.57), nm("um", 0.78)), (570.0, 780.0));
        assert!((unit("per cent").unwrap().convert(16.022, Dimension::Fraction) - 0.16022).abs() < 1e-15);
        for (text, dimension) in [
            ("1/sr", Dimension::Bsdf),
            ("sr^-1", Dimension::Bsdf),
            ("sr\u{207b}\u{b9}", Dimension::Bsdf),
            ("W/m\u{b2}/nm", Dimension::Light),
            ("\u{b5}W/cm\u{b2}/nm", Dimension::Light),
            ("um^4", Dimension::Density),
        ] {
            assert!(unit(text).unwrap().fits(dimension), "{text}");
        }
        let deg = |text: &str| unit(text).map(|unit| unit.convert(30.0, Dimension::Angle));
        for text in ["deg", "Deg", "DEGREES", "\u{b0}", "Grad", "in Grad", " Grad "] {
            assert_eq!(deg(text), Some(30.0), "{text}");
        }
        // 100 gon are a right angle: what may be gon is not read as degrees.
        for text in [
            "grad",
            "GRAD",
            "gRad",
            "grads",
            "Gradian",
            "gon",
            "Gon",
            "MeV",
            "furlong",
            "W/m2/eV",
            "umol/m2/s/nm",
            "dB",
        ] {
            assert_eq!(unit(text), None, "{text}");
        }
    }
}
