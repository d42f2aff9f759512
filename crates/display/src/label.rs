//! Labels: the names of quantities in words, with their units, for figures, tables, the page and Python.
//!
//! The labels of metrics stand in the table of metrics (`metrics/mod.rs`), those of the other numbers of a
//! result in this file. The labels of keys of a scenario come from its grammar, in `papilio_scenario::label`.

use std::fmt;

use crate::metrics::{
    Cam16, CrosstalkMetrics, GlossMetrics, ImageMetrics, SharpnessMetrics, SparkleMetrics, SpatialScalars,
    StateMetrics, VALUE_LABELS, ViewMetrics,
};

/// The name of a quantity in words, with its unit.
///
/// ```
/// use papilio_display::metric_label;
///
/// assert_eq!(metric_label("white.luminance_cd_m2").unwrap().to_string(), "Luminance of white (cd/m²)");
/// assert_eq!(metric_label("gamut_percent_srgb").unwrap().unit, "% of sRGB");
/// assert_eq!(metric_label("haze"), None);
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Label {
    /// The quantity, beginning with a capital letter.
    pub quantity: String,
    /// Its unit; empty for numbers without one.
    pub unit: String,
}

/// An angle in a text or in the name of a file: in digits, unless that would be a long row of zeros.
///
/// ```
/// use papilio_display::{angle_in_text, view_in_name};
///
/// assert_eq!(angle_in_text(-17.5), "-17.5");
/// assert_eq!(angle_in_text(1e-300), "1e-300");
/// assert_eq!(view_in_name(20.0, 0.0), "_theta20_phi0");
/// ```
pub fn angle_in_text(deg: f64) -> String {
    if deg != 0.0 && deg.abs() < 1e-6 { format!("{deg:e}") } else { deg.to_string() }
}

/// The direction of a view at the end of the name of a file.
pub fn view_in_name(theta_deg: f64, phi_deg: f64) -> String {
    format!("_theta{}_phi{}", angle_in_text(theta_deg), angle_in_text(phi_deg))
}

impl Label {
    /// Creates a label.
    pub fn new(quantity: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { quantity: quantity.into(), unit: unit.into() }
    }

    /// Returns the label of this quantity of something: `Luminance of white`. The name follows the noun,
    /// before what specifies it further: `Colour difference CIEDE2000 of red from the perfect white`.
    #[must_use]
    pub fn of(&self, name: &str) -> Self {
        const FURTHER: [&str; 8] =
            [" from ", " with ", " under ", " in diffuse", " to ", " at ", ", ", " by "];
        let end = FURTHER.iter().filter_map(|word| self.quantity.find(word)).min();
        let (noun, further) = self.quantity.split_at(end.unwrap_or(self.quantity.len()));
        Self::new(format!("{noun} of {name}{further}"), self.unit.as_str())
    }

    /// Returns the quantity with a value of it: `Viewing angle = 8 deg`.
    pub fn with_value(&self, value: &str) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
        format!("{} = {value}{unit}", self.quantity)
    }

    /// Returns the label of the standard error, or of another error, of this quantity.
    fn error(&self, kind: &str) -> Self {
        Self::new(format!("{kind} of {}", uncapitalised(&self.quantity)), self.unit.as_str())
    }
}

impl fmt::Display for Label {
    /// Writes `quantity (unit)`, or the quantity alone.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.unit.as_str() {
            "" => out.write_str(&self.quantity),
            unit => write!(out, "{} ({unit})", self.quantity),
        }
    }
}

/// A line of a table of labels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct KnownLabel {
    /// The name in results.
    pub(crate) name: &'static str,
    /// The quantity; `None` if it follows from the name.
    pub(crate) quantity: Option<&'static str>,
    pub(crate) unit: &'static str,
}

/// The numbers of a result that are not metrics: columns of `states.csv`, `spectra.csv` and other tables.
#[rustfmt::skip]
const OTHERS: &[(&str, &str, &str)] = &[
    ("theta_deg", "Viewing angle", "deg"),
    ("phi_deg", "Azimuth of the view", "deg"),
    ("wavelength_nm", "Wavelength", "nm"),
    ("radiance", "Spectral radiance", "W/(m² sr nm)"),
    ("reflectance_factor", "Reflectance factor", ""),
    ("reflectance", "Reflectance", ""),
    ("absorptance", "Absorptance", ""),
    ("z", "Chromaticity z", ""),
    ("uv_shift", "Chromaticity difference Δu′v′ from the reference direction", ""),
    ("delta_E_1976_with_angle", "Colour difference ΔE*ab from the reference direction", ""),
    ("hue_r", "Red of the hue", ""),
    ("hue_g", "Green of the hue", ""),
    ("hue_b", "Blue of the hue", ""),
    ("R_dir", "Luminance factor in the light of directed source", ""),
    ("R_environment", "Luminance factor in the light of environment", ""),
    ("Y_diffuse", "Contribution to Y by diffuse light", ""),
    ("Y_front_reflection", "Contribution to Y by front reflection", ""),
    ("Y_front_light", "Contribution to Y by the front light", ""),
    ("Y_directed", "Contribution to Y by directed source", ""),
    ("Y_environment", "Contribution to Y by environment", ""),
    ("specular", "Image luminance ratio of directed source", ""),
    ("ledger_returned", "Returned to the air", ""),
    ("ledger_front", "Absorbed by the front", ""),
    ("ledger_diffuser", "Absorbed by the diffuser", ""),
    ("ledger_glass", "Absorbed by the glass", ""),
    ("ledger_pixel", "Absorbed by the pixel", ""),
    ("ledger_inactive", "Absorbed by the inactive area", ""),
    ("ledger_unaccounted", "Unaccounted energy", ""),
];

/// Endings of names, with the units that they state.
const UNITS: [(&str, &str); 17] = [
    ("_cd_m2", "cd/m²"),
    ("_per_mm", "1/mm"),
    ("_ev", "eV"),
    ("_um2", "µm²"),
    ("_um4", "µm⁴"),
    ("_nm", "nm"),
    ("_um", "µm"),
    ("_mm", "mm"),
    ("_m", "m"),
    ("_deg", "deg"),
    ("_lx", "lx"),
    ("_lm", "lm"),
    ("_K", "K"),
    ("_years", "years"),
    ("_pN", "pN"),
    ("_percent", "%"),
    ("_ppi", "ppi"),
];

/// Splits a name into its words and the unit that its ending states: `("thickness", "nm")` for
/// `thickness_nm`.
pub fn split_unit(name: &str) -> (&str, &'static str) {
    // The quantity is called by its unit.
    if name == "volts" {
        return (name, "V");
    }
    let found = UNITS.iter().find_map(|(end, unit)| Some((name.strip_suffix(end)?, *unit)));
    found.filter(|(words, _)| !words.is_empty()).unwrap_or((name, ""))
}

/// Returns a label whose words are those of the name: `Total transmittance` for `total_transmittance`.
pub fn label_from_name(name: &str) -> Label {
    let (words, unit) = split_unit(name);
    Label::new(capitalised(&words.replace('_', " ")), unit)
}

/// Returns the label of a number of a result: a metric (`contrast_ratio`, `white.Y`), another column of its
/// tables (`wavelength_nm`), or the error of one (`Y_se`, `white.Y_de`). `None` if there is no such number.
pub fn metric_label(name: &str) -> Option<Label> {
    if let Some((state, number)) = name.rsplit_once('.') {
        let of_view = metrics_of_views().any(|known| known.name == number)
            || ["theta_deg", "phi_deg", "wavelength_nm"].contains(&number);
        return known(number).filter(|_| !of_view && !state.is_empty()).map(|label| label.of(state));
    }
    known(name)
}

/// All names of numbers with a label, without those of errors.
pub fn labelled_names() -> impl Iterator<Item = String> {
    let cam16 = Cam16::LABELS.iter().map(|known| format!("cam16_{}", known.name));
    let own = metrics().map(|known| known.name.to_owned());
    own.chain(cam16).chain(OTHERS.iter().map(|(name, ..)| (*name).to_owned()))
}

fn metrics() -> impl Iterator<Item = &'static KnownLabel> {
    let of_states = VALUE_LABELS
        .iter()
        .chain(StateMetrics::LABELS)
        .chain(SpatialScalars::LABELS)
        .chain(GlossMetrics::LABELS);
    metrics_of_views().chain(of_states)
}

fn metrics_of_views() -> impl Iterator<Item = &'static KnownLabel> {
    let of_pixels = SharpnessMetrics::LABELS
        .iter()
        .chain(CrosstalkMetrics::LABELS)
        .chain(SparkleMetrics::LABELS)
        .chain(ImageMetrics::LABELS);
    ViewMetrics::LABELS.iter().chain(of_pixels)
}

fn known(name: &str) -> Option<Label> {
    let own = |known: &KnownLabel| match known.quantity {
        Some(quantity) => Label::new(quantity, known.unit),
        None => label_from_name(known.name),
    };
    if let Some(metric) = metrics().find(|known| known.name == name) {
        return Some(own(metric));
    }
    if let Some(number) = name.strip_prefix("cam16_") {
        return Cam16::LABELS.iter().find(|known| known.name == number).map(own);
    }
    if let Some((_, quantity, unit)) = OTHERS.iter().find(|(known, ..)| *known == name) {
        return Some(Label::new(*quantity, *unit));
    }
    for (end, kind) in [("_se", "Standard error"), ("_de", "Discretisation error")] {
        if let Some(number) = name.strip_suffix(end) {
            return known(number).map(|label| label.error(kind));
        }
    }
    // Numbers of several lights are counted from 0.
    let (number, index) = name.rsplit_once('_')?;
    let index: usize = index.parse().ok()?;
    let (_, quantity, unit) = OTHERS.iter().find(|(known, ..)| *known == number)?;
    let counted = quantity.ends_with("source") || quantity.ends_with("environment");
    counted.then(|| Label::new(format!("{quantity} {index}"), *unit))
}

/// Returns a text that begins with a capital letter.
pub fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Returns a label for the middle of a sentence: the first letter is small, unless the first word is a symbol
/// or an abbreviation.
pub fn uncapitalised(text: &str) -> String {
    let mut letters = text.chars();
    match (letters.next(), letters.next()) {
        (Some(first), Some(second)) if second.is_lowercase() => {
            first.to_lowercase().chain([second]).chain(letters).collect()
        }
        _ => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_name_the_quantity_and_its_unit() {
        for (name, label) in [
            ("contrast_ratio", "Contrast ratio"),
            ("gamut_percent_srgb", "Gamut area, u′v′ (% of sRGB)"),
            ("white.Y", "Luminance factor Y of white"),
            ("red.peak_nm", "Peak wavelength of red (nm)"),
            ("red.delta_E_2000_from_white", "Colour difference CIEDE2000 of red from the perfect white"),
            ("black.contrast", "Contrast ratio of black to black"),
            ("white.R_hemi", "Luminance factor of white in diffuse light"),
            ("Y_se", "Standard error of luminance factor Y"),
            ("x_de", "Discretisation error of chromaticity x"),
            ("a_star_se", "Standard error of CIELAB a*"),
            ("R_dir_1", "Luminance factor in the light of directed source 1"),
            ("cam16_J_prime", "CAM16-UCS lightness J′"),
            ("ledger_pixel", "Absorbed by the pixel"),
        ] {
            assert_eq!(metric_label(name).map(|label| label.to_string()).as_deref(), Some(label));
        }
        for name in [
            "haze",
            "white.contrast_ratio",
            "viewer.theta_deg",
            ".Y",
            "white.haze",
            "Y_3_se_4",
            "Y_1",
            "radiance_2",
            "",
        ] {
            assert_eq!(metric_label(name), None, "{name}");
        }
    }

    /// A label has words: no underscore and no dotted path.
    #[test]
    fn every_number_has_a_label_in_words() {
        for name in labelled_names() {
            let label = metric_label(&name).unwrap_or_else(|| panic!("{name}")).to_string();
            assert!(!label.contains('_') && !label.contains('.'), "{name}: {label}");
            assert!(label.starts_with(|c: char| c.is_uppercase()), "{name}: {label}");
        }
    }

    #[test]
    fn label_with_a_value_has_its_unit() {
        assert_eq!(metric_label("theta_deg").unwrap().with_value("8"), "Viewing angle = 8 deg");
        assert_eq!(metric_label("Y").unwrap().with_value("0.5"), "Luminance factor Y = 0.5");
    }
}
