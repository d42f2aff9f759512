//! The nine dispersion formulas of the refractiveindex.info database.
//!
//! With l the wavelength in um and C1, C2, ... the coefficients:
//!
//! | number | name | formula |
//! |---|---|---|
//! | 1 | Sellmeier | n^2 - 1 = C1 + C2 l^2/(l^2 - C3^2) + C4 l^2/(l^2 - C5^2) + ... |
//! | 2 | Sellmeier-2 | n^2 - 1 = C1 + C2 l^2/(l^2 - C3) + C4 l^2/(l^2 - C5) + ... |
//! | 3 | polynomial | n^2 = C1 + C2 l^C3 + C4 l^C5 + ... |
//! | 4 | special to the database | n^2 = C1 + C2 l^C3/(l^2 - C4^C5) + C6 l^C7/(l^2 - C8^C9) + C10 l^C11 + ... |
//! | 5 | Cauchy | n = C1 + C2 l^C3 + C4 l^C5 + ... |
//! | 6 | gases | n - 1 = C1 + C2/(C3 - l^-2) + C4/(C5 - l^-2) + ... |
//! | 7 | Herzberger | n = C1 + C2/(l^2 - 0.028) + C3/(l^2 - 0.028)^2 + C4 l^2 + C5 l^4 + C6 l^6 |
//! | 8 | retro | (n^2 - 1)/(n^2 + 2) = C1 + C2 l^2/(l^2 - C3) + C4 l^2 |
//! | 9 | exotic | n^2 = C1 + C2/(l^2 - C3) + C4 (l - C5)/((l - C5)^2 + C6) |
//!
//! Validity: the range given with each set of coefficients, for
//! transparent media (n real; k, if given, is a separate table).
//!
//! Source: M. N. Polyanskiy, "Refractiveindex.info database of optical
//! constants", Sci. Data 11, 94 (2024), and its "Dispersion formulas" sheet.

use crate::SpectraError;

/// A formula of the database with its coefficients.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Formula {
    number: u8,
    /// The leading C1.
    constant: f64,
    /// C2, C3, ...; padded with zeros if the formula has a fixed number of coefficients.
    rest: Vec<f64>,
}

impl Formula {
    pub(super) fn new(number: u8, coefficients: &[f64]) -> Result<Self, SpectraError> {
        if let Some(point) = coefficients.iter().position(|c| !c.is_finite()) {
            return Err(SpectraError::NotFinite { point });
        }
        let found = coefficients.len();
        let wrong_count = |expected| SpectraError::FormulaCoefficients { number, expected, found };
        let Some((&constant, rest)) = coefficients.split_first() else {
            return Err(wrong_count("at least one"));
        };
        let mut rest = rest.to_vec();
        let (fits, expected, pad_to) = match number {
            1..=3 | 5 | 6 => (rest.len() % 2 == 0, "an odd number of", rest.len()),
            4 => (rest.len() <= 8 || rest.len() % 2 == 0, "up to 9, or an odd number of", rest.len().max(8)),
            7 | 9 => (rest.len() <= 5, "up to 6", 5),
            8 => (rest.len() <= 3, "up to 4", 3),
            _ => return Err(SpectraError::FormulaNumber { number }),
        };
        if !fits {
            return Err(wrong_count(expected));
        }
        rest.resize(pad_to, 0.0);
        Ok(Self { number, constant, rest })
    }

    /// n at a wavelength in nm.
    pub(super) fn index(&self, nm: f64) -> Result<f64, SpectraError> {
        let um = nm * 1e-3;
        let n = match self.number {
            1 => (1.0 + self.pairs(|b, c| b * um * um / (um * um - c * c))).sqrt(),
            2 => (1.0 + self.pairs(|b, c| b * um * um / (um * um - c))).sqrt(),
            3 => self.pairs(|b, p| b * um.powf(p)).sqrt(),
            4 => self.database_own(um).sqrt(),
            5 => self.pairs(|b, p| b * um.powf(p)),
            6 => 1.0 + self.pairs(|b, c| b / (c - um.powi(-2))),
            7 => self.herzberger(um),
            8 => self.retro(um),
            _ => self.exotic(um).sqrt(),
        };
        if n.is_finite() && n > 0.0 {
            Ok(n)
        } else {
            Err(SpectraError::FormulaUndefined { number: self.number, nm })
        }
    }

    /// C1 plus the sum of `term` over the pairs (C2, C3), (C4, C5), ...
    fn pairs(&self, term: impl Fn(f64, f64) -> f64) -> f64 {
        // The database marks an unused pair by a zero coefficient.
        let present = self.rest.chunks_exact(2).filter(|pair| pair[0] != 0.0);
        self.constant + present.map(|pair| term(pair[0], pair[1])).sum::<f64>()
    }

    fn database_own(&self, um: f64) -> f64 {
        let (resonances, powers) = self.rest.split_at(8);
        let resonance = |c: &[f64]| c[0] * um.powf(c[1]) / (um * um - c[2].powf(c[3]));
        let present = resonances.chunks_exact(4).filter(|c| c[0] != 0.0);
        self.constant
            + present.map(resonance).sum::<f64>()
            + powers.chunks_exact(2).map(|c| c[0] * um.powf(c[1])).sum::<f64>()
    }

    fn herzberger(&self, um: f64) -> f64 {
        let c = &self.rest;
        let l2 = um * um;
        let l = 1.0 / (l2 - 0.028);
        self.constant + c[0] * l + c[1] * l * l + l2 * (c[2] + l2 * (c[3] + l2 * c[4]))
    }

    fn retro(&self, um: f64) -> f64 {
        let c = &self.rest;
        let l2 = um * um;
        let lorentz_lorenz = self.constant + c[0] * l2 / (l2 - c[1]) + c[2] * l2;
        ((1.0 + 2.0 * lorentz_lorenz) / (1.0 - lorentz_lorenz)).sqrt()
    }

    fn exotic(&self, um: f64) -> f64 {
        let c = &self.rest;
        let offset = um - c[3];
        self.constant + c[0] / (um * um - c[1]) + c[2] * offset / (offset * offset + c[4])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MALITSON: [f64; 7] = [0.0, 0.6961663, 0.0684043, 0.4079426, 0.1162414, 0.8974794, 9.896161];
    const BK7: [f64; 7] = [0.0, 1.03961212, 0.00600069867, 0.231792344, 0.0200179144, 1.01046945, 103.560653];
    const E_F1: [f64; 11] = [
        2.5730565,
        -0.010203605,
        2.0,
        0.023095784,
        -2.0,
        0.00087114252,
        -4.0,
        -3.0730079e-05,
        -6.0,
        6.9457986e-06,
        -8.0,
    ];
    const EDWARDS_OCHOA: [f64; 5] = [3.41983, 0.159906, -0.123109, 1.26878e-6, -1.95104e-9];

    fn index(number: u8, coefficients: &[f64], nm: f64) -> f64 {
        Formula::new(number, coefficients).and_then(|formula| formula.index(nm)).unwrap()
    }

    /// Coefficients from the database; indices from independent sources: data sheets (2, 3),
    /// the paper's own table (1), handbook values of the same substance from other
    /// measurements (the others, hence their wider tolerances).
    #[test]
    fn every_formula_equals_a_published_index() {
        let cases: [(u8, &[f64], f64, f64, f64); 9] = [
            // Fused silica, Malitson 1965.
            (1, &MALITSON, 587.5618, 1.458464, 1e-6),
            // N-BK7, Schott data sheet.
            (2, &BK7, 587.5618, 1.516800, 1e-6),
            // E-F1, HOYA catalogue 2017.
            (3, &E_F1, 587.5618, 1.62588, 5e-6),
            // Rutile, extraordinary ray (Devore 1951); handbook value at the sodium D line.
            (4, &[7.197, 0.3322, 0.0, 0.0843, 1.0, 0.0, 0.0, 0.0, 1.0], 589.3, 2.909, 1e-3),
            // Acetone (Rheims 1997); CRC Handbook, 20 C.
            (5, &[1.34979, 0.00306, -2.0, 0.00006, -4.0], 589.3, 1.3588, 5e-4),
            // Standard air (Ciddor 1996).
            (6, &[0.0, 0.05792105, 238.0185, 0.00167917, 57.362], 587.5618, 1.000_277_17, 1e-8),
            // Silicon (Edwards and Ochoa 1980); Salzberg and Villa 1957.
            (7, &EDWARDS_OCHOA, 10_000.0, 3.4179, 4e-3),
            // Silver bromide (Schroeter 1931); CRC Handbook, sodium D line.
            (8, &[0.452505, 0.09939, 0.070537, -0.000150], 589.3, 2.253, 5e-3),
            // Urea, extraordinary ray (Rosker 1985); CRC Handbook, sodium D line.
            (9, &[2.51527, 0.0240, 0.0300, 0.020, 1.52, 0.8771], 589.3, 1.602, 5e-3),
        ];
        for (number, coefficients, nm, published, tolerance) in cases {
            let found = index(number, coefficients, nm);
            assert!((found - published).abs() < tolerance, "formula {number}: {found}, not {published}");
        }
    }

    /// Small terms below the accuracy of the published values above, computed by hand.
    #[test]
    fn small_terms_of_formulas_7_to_9_equal_hand_computation() {
        // 3.41983 + 0.00159951 - 0.00001232 + 0.00012688 - 0.00001951
        assert!((index(7, &EDWARDS_OCHOA, 10_000.0) - 3.42152456).abs() < 1e-8);
        // The same with C6 l^6 = 1e-9 * 1e6.
        let sixth = [3.41983, 0.159906, -0.123109, 1.26878e-6, -1.95104e-9, 1e-9];
        assert!((index(7, &sixth, 10_000.0) - 3.42252456).abs() < 1e-8);
        // Lorentz-Lorenz 0.45 + 0.1 * 0.25/(0.25 - 0.05) + 0.02 * 0.25 = 0.58, so n^2 = 2.16/0.42.
        assert!((index(8, &[0.45, 0.1, 0.05, 0.02], 500.0).powi(2) - 2.16 / 0.42).abs() < 1e-12);
        // 2.5 + 0.02/(0.25 - 0.05) + 0.1 * (-1)/(1 + 1)
        assert!((index(9, &[2.5, 0.02, 0.05, 0.1, 1.5, 1.0], 500.0).powi(2) - 2.55).abs() < 1e-12);
    }

    #[test]
    fn formula_4_contains_formulas_1_and_3() {
        let (b1, c1, b2, c2) = (0.6961663, 0.0684043, 0.4079426, 0.1162414);
        let four = index(4, &[1.0, b1, 2.0, c1, 2.0, b2, 2.0, c2, 2.0, -0.01, 2.0, 0.003, -4.0], 500.0);
        let one = index(1, &[0.0, b1, c1, b2, c2], 500.0);
        let powers: f64 = -0.01 * 0.25 + 0.003 / 0.0625;
        assert!((four * four - (one * one + powers)).abs() < 1e-14);
    }

    #[test]
    fn pole_is_an_error() {
        let pole = Formula::new(1, &[0.0, 1.0, 0.5]).unwrap();
        assert_eq!(pole.index(500.0), Err(SpectraError::FormulaUndefined { number: 1, nm: 500.0 }));
        assert!(pole.index(400.0).is_err(), "n^2 is negative below the pole");
    }

    #[test]
    fn wrong_formula_number_or_coefficients_are_refused() {
        assert_eq!(Formula::new(10, &[1.0]), Err(SpectraError::FormulaNumber { number: 10 }));
        assert_eq!(Formula::new(0, &[1.0]), Err(SpectraError::FormulaNumber { number: 0 }));
        for (number, count) in [(1, 0), (1, 2), (4, 10), (7, 7), (8, 5), (9, 7)] {
            let error = Formula::new(number, &vec![1.0; count]).unwrap_err();
            assert!(matches!(error, SpectraError::FormulaCoefficients { .. }), "{error}");
        }
        assert_eq!(Formula::new(3, &[1.0, f64::NAN, 2.0]), Err(SpectraError::NotFinite { point: 1 }));
    }
}
