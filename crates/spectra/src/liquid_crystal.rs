//! Nematic liquid crystals by name: both indices, by the extended Cauchy formula.
//!
//! `n = A + B/l^2 + C/l^4`, l in micrometres, at 25 deg C. J. Li, C. H. Wen, S. Gauza, R. Lu, S. T. Wu, J. Disp. Technol. 1, 51-61
//! (2005), which fits measurements from 450 to 656 nm; the coefficients are those of the refractiveindex.info database (CC0 1.0). Beyond that
//! range the formula is smooth, and resonances of the molecules in the ultraviolet make it too low below about 400 nm.

/// Range of the measurements, nm.
pub const LIQUID_CRYSTAL_RANGE_NM: (f64, f64) = (450.0, 656.0);

/// A nematic liquid crystal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LiquidCrystal {
    /// Its name.
    pub name: &'static str,
    /// Coefficients A, B, C of the ordinary index.
    ordinary: [f64; 3],
    /// Those of the extraordinary index.
    extraordinary: [f64; 3],
}

const KNOWN: [LiquidCrystal; 3] = [
    LiquidCrystal {
        name: "5CB",
        ordinary: [1.5139, 0.0052, 0.0008],
        extraordinary: [1.6708, 0.0081, 0.0024],
    },
    LiquidCrystal { name: "E7", ordinary: [1.4990, 0.0072, 0.0003], extraordinary: [1.6933, 0.0078, 0.0028] },
    LiquidCrystal { name: "MLC-6608", ordinary: [1.4609, 0.0050, 0.0], extraordinary: [1.5359, 0.0070, 0.0] },
];

/// Returns the names of all liquid crystals.
pub fn liquid_crystal_names() -> impl Iterator<Item = &'static str> {
    KNOWN.iter().map(|known| known.name)
}

/// Returns the liquid crystal of this name.
///
/// ```
/// let [n_o, n_e] = papilio_spectra::liquid_crystal("E7").unwrap().indices(589.0);
/// // 1.5212 and 1.7394 were measured at 589 nm and 25 deg C (Merck).
/// assert!((n_o - 1.5212).abs() < 0.002 && (n_e - 1.7394).abs() < 0.005);
/// ```
pub fn liquid_crystal(name: &str) -> Option<LiquidCrystal> {
    KNOWN.into_iter().find(|known| known.name == name)
}

impl LiquidCrystal {
    /// Returns the ordinary and the extraordinary index at a wavelength.
    pub fn indices(&self, wavelength_nm: f64) -> [f64; 2] {
        let square = (wavelength_nm / 1000.0).powi(-2);
        [self.ordinary, self.extraordinary].map(|[a, b, c]| a + square * (b + square * c))
    }
}
