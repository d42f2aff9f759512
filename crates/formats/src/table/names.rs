//! Names of columns: a quantity, and a unit in brackets, after a slash, a comma or a blank, or as a suffix.

use super::quantities::WAVELENGTH;
use super::units::{Unit, unit};

/// The name of a column.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ColumnName {
    /// As it stands in the file.
    pub(crate) raw: String,
    /// Without the unit.
    pub(crate) text: String,
    /// In small letters, ASCII, with `_` between words, without the unit: `theta_i` of `Theta_i (deg)`.
    pub(crate) name: String,
    /// The same with the case of the letters: `L` of `L*`.
    pub(crate) exact: String,
    /// The unit; a text in brackets that is no known unit is `Err`.
    pub(crate) unit: Option<Result<Unit, String>>,
}

impl ColumnName {
    pub(crate) fn new(raw: &str) -> Self {
        let text = raw.trim().trim_matches('"').trim();
        let (text, unit) = split_unit(text);
        let exact = words(text);
        Self { raw: raw.to_owned(), text: text.to_owned(), name: exact.to_lowercase(), exact, unit }
    }

    /// Returns whether the name is one of `names`: with the case of its letters, or without case and `_`
    /// (`thetaI` is `theta_i` too).
    pub(crate) fn is_one_of(&self, names: &[&str], with_case: bool) -> bool {
        if with_case {
            return names.contains(&self.exact.as_str());
        }
        let squeezed = |name: &str| name.replace('_', "");
        let mine = squeezed(&self.name);
        !mine.is_empty() && names.iter().any(|name| squeezed(name) == mine)
    }
}

/// Separates the unit from the name of a column. A name that is a unit alone (`nm`) has this unit and keeps
/// its name.
fn split_unit(text: &str) -> (&str, Option<Result<Unit, String>>) {
    if let Some((name, inside)) = brackets(text) {
        // `n(lambda)` is a function of the wavelength.
        if is_wavelength(inside) && unit(inside).is_none() && !is_wavelength(name) {
            return (name, None);
        }
        return (name, Some(unit(inside).ok_or_else(|| inside.trim().to_owned())));
    }
    let bare = text.trim_end_matches('.');
    // `A` may be a quantity, `m` a name of anything, and numbers are no units.
    if let Some(found) = unit(bare)
        && !matches!(found, Unit::Fraction(1.0) | Unit::Length(1e9))
        && (bare.len() > 1 || bare == "%")
    {
        return (text, Some(Ok(found)));
    }
    for rest in [text.strip_prefix('%'), text.strip_suffix('%')].into_iter().flatten() {
        let rest = rest.trim_matches([' ', '_']);
        if !rest.is_empty() {
            return (rest, Some(Ok(Unit::Fraction(1e-2))));
        }
    }
    // The longest unit at the end: `W/m2/nm` of `Irradiance W/m2/nm`.
    for (at, mark) in text.char_indices().filter(|(_, c)| matches!(c, '/' | '_' | ' ' | ',' | '-')) {
        let name = text[..at].trim_end_matches([' ', ',', '_', '/']);
        let after = text[at + mark.len_utf8()..].trim().trim_end_matches('.');
        // `n_1` is no name with a unit; a single letter is one only after a slash or a blank, or after the
        // name of a wavelength: `wavelength_m`, `wl_A`.
        let is_word = after.contains(|c: char| c.is_alphabetic() || matches!(c, '%' | '\u{b0}'));
        let is_letter =
            after.len() == 1 && after != "%" && !matches!(mark, '/' | ' ') && !is_wavelength(name);
        // After a slash stands the unit, not its inverse, except for steradians: BRDF /sr.
        let found = if mark == '/' && after == "sr" { Some(Unit::PerSteradian) } else { unit(after) };
        if !name.is_empty()
            && is_word
            && !is_letter
            && !after.starts_with('/')
            && let Some(found) = found
        {
            return (name, Some(Ok(found)));
        }
    }
    (text, None)
}

/// Returns whether a name without its unit is that of a wavelength.
fn is_wavelength(name: &str) -> bool {
    let squeezed = |name: &str| name.to_lowercase().replace('_', "");
    let mine = squeezed(&words(name));
    // `E_m` may be anything.
    mine.len() > 1 && WAVELENGTH.names.iter().any(|name| squeezed(name) == mine)
}

/// Returns the text before the brackets at the end of a name, and the text in them: `BTDF` and `1/sr` of
/// `BTDF [1/sr]`.
fn brackets(text: &str) -> Option<(&str, &str)> {
    let text = text.trim_end_matches(['.', ':']);
    let pairs = [('(', ')'), ('[', ']'), ('{', '}'), ('<', '>')];
    let (open, close) = pairs.into_iter().find(|(_, close)| text.ends_with(*close))?;
    let inner = &text[..text.len() - close.len_utf8()];
    let mut depth = 1;
    let start = inner.char_indices().rev().find(|(_, c)| {
        depth += i32::from(*c == close) - i32::from(*c == open);
        depth == 0
    })?;
    let (name, inside) = (inner[..start.0].trim(), &inner[start.0 + open.len_utf8()..]);
    let name = name.trim_end_matches(['_', '/', ',']).trim_end();
    (!name.is_empty()).then_some((name, inside))
}

/// Returns a name as words of ASCII letters and digits, joined by `_`.
fn words(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    for c in text.chars() {
        match ascii(c) {
            Some(word) => plain.push_str(word),
            None if c.is_ascii_alphanumeric() => plain.push(c),
            // Primes of eps' and eps'' are kept as p, to differ.
            None if matches!(c, '\'' | '\u{2032}' | '\u{2019}') => plain.push('p'),
            None if c == '\u{2033}' => plain.push_str("pp"),
            None if c.is_alphanumeric() => plain.push(c),
            None => plain.push('_'),
        }
    }
    plain.split('_').filter(|word| !word.is_empty()).collect::<Vec<_>>().join("_")
}

/// Returns Greek letters and letters with accents in ASCII.
fn ascii(c: char) -> Option<&'static str> {
    Some(match c {
        '\u{3bb}' | '\u{39b}' => "lambda",
        '\u{3b8}' | '\u{3d1}' | '\u{398}' => "theta",
        '\u{3c6}' | '\u{3d5}' | '\u{3a6}' => "phi",
        '\u{3b5}' | '\u{3f5}' => "eps",
        '\u{3ba}' => "kappa",
        '\u{3b1}' => "alpha",
        '\u{3c1}' => "rho",
        '\u{3c4}' => "tau",
        '\u{394}' | '\u{2206}' => "delta",
        '\u{3bd}' => "nu",
        '\u{e4}' | '\u{c4}' => "ae",
        '\u{f6}' | '\u{d6}' => "oe",
        '\u{fc}' | '\u{dc}' => "ue",
        '\u{df}' => "ss",
        '\u{e0}' | '\u{e1}' | '\u{e2}' => "a",
        '\u{e8}' | '\u{e9}' | '\u{ea}' | '\u{c9}' => "e",
        '\u{ed}' | '\u{ec}' => "i",
        '\u{f3}' | '\u{f2}' => "o",
        '\u{2080}' => "0",
        '\u{2081}' => "1",
        '\u{2082}' => "2",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn name_and_unit_are_separated() {
        let nm = Some(Ok(Unit::Length(1.0)));
        let percent = Some(Ok(Unit::Fraction(1e-2)));
        let deg = Some(Ok(Unit::Angle(1.0)));
        for (raw, name, unit) in [
            ("wavelength_nm", "wavelength", nm.clone()),
            ("Wavelength (nm)", "wavelength", nm.clone()),
            ("wavelength [nm]", "wavelength", nm.clone()),
            ("Wavelength/nm", "wavelength", nm.clone()),
            ("\u{3bb} / nm", "lambda", nm.clone()),
            ("Wavelength in nm", "wavelength", nm.clone()),
            ("Wavelength nm.", "wavelength", nm.clone()),
            ("Wavelength, nm", "wavelength", nm.clone()),
            ("nm", "nm", nm.clone()),
            ("Wellenl\u{e4}nge (nm)", "wellenlaenge", nm),
            ("Theta_i (deg)", "theta_i", deg.clone()),
            ("theta_deg", "theta", deg.clone()),
            ("\u{3b8} (\u{b0})", "theta", deg.clone()),
            ("Winkel (Grad)", "winkel", deg.clone()),
            ("Winkel in Grad", "winkel", deg.clone()),
            ("theta_Grad", "theta", deg),
            ("theta (grad)", "theta", Some(Err("grad".to_owned()))),
            ("theta_grad", "theta_grad", None),
            ("theta_rad", "theta", Some(Ok(Unit::Angle(180.0 / std::f64::consts::PI)))),
            ("BRDF (1/sr)", "brdf", Some(Ok(Unit::PerSteradian))),
            ("BRDF 1/sr", "brdf", Some(Ok(Unit::PerSteradian))),
            ("BRDF /sr", "brdf", Some(Ok(Unit::PerSteradian))),
            ("%R", "r", percent.clone()),
            ("R%", "r", percent.clone()),
            ("T (%)", "t", percent.clone()),
            ("reflectance_percent", "reflectance", percent),
            ("reflectance_factor", "reflectance_factor", None),
            ("theta_i", "theta_i", None),
            ("n", "n", None),
            ("eps1", "eps1", None),
            ("wavelength_m", "wavelength", Some(Ok(Unit::Length(1e9)))),
            ("wl_A", "wl", Some(Ok(Unit::Length(0.1)))),
            ("LAB_A", "lab_a", None),
            ("theta_m", "theta_m", None),
            ("eps''", "epspp", None),
            ("L*", "l", None),
            ("Energy (eV)", "energy", Some(Ok(Unit::Energy(1.0)))),
            ("Irradiance W/m2/nm", "irradiance", Some(Ok(Unit::PerWavelength))),
            ("W/m2/nm", "w_m2_nm", Some(Ok(Unit::PerWavelength))),
            ("cm-1", "cm_1", Some(Ok(Unit::Wavenumber(1.0)))),
            ("W", "w", None),
            ("a.u.", "a_u", Some(Ok(Unit::Relative))),
            ("n(lambda)", "n", None),
            ("T(\u{3bb})", "t", None),
            ("wavelength (furlong)", "wavelength", Some(Err("furlong".to_owned()))),
            ("", "", None),
        ] {
            let found = ColumnName::new(raw);
            assert_eq!((found.name.as_str(), found.unit), (name, unit), "{raw}");
        }
        assert_eq!(ColumnName::new("L*").exact, "L");
        assert!(ColumnName::new("thetaI").is_one_of(&["theta_i"], false));
        assert!(!ColumnName::new("y").is_one_of(&["Y"], true));
    }
}
