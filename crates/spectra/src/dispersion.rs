//! Dispersion: the complex refractive index n + ik as a function of wavelength.
//!
//! The convention is n + ik with k >= 0 for an absorber; fields vary as
//! `exp(-i omega t)`. All interfaces use vacuum wavelengths in nm;
//! a model's own unit (um or eV) is internal. No model is evaluated
//! outside its range, which is that of the table's points or of the data
//! to which a formula was fitted.

mod faddeeva;
mod formula;
mod oscillators;
mod parameters;

use num_complex::Complex64;

use crate::spectrum::within;
use crate::{Grid, SpectraError, Tabulated};
use formula::Formula;
use oscillators::{BrendelBormann, LorentzDrude};

pub(crate) use oscillators::Oscillator;
pub use parameters::{Absorption, DispersionModel, OscillatorTerm, SellmeierTerm};

/// Complex refractive index n + ik of a medium, with its range of validity.
///
/// ```
/// use papilio_spectra::material;
/// let glass = material("BK7")?;
/// let n_d = glass.index(587.5618)?.re;
/// assert!((n_d - 1.516800).abs() < 1e-6);
/// assert!(glass.index(200.0).is_err());
/// # Ok::<(), papilio_spectra::SpectraError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Dispersion {
    model: Model,
    range_nm: (f64, f64),
    /// Range of the data, nm: that of `range_nm`, unless it is continued.
    data_nm: (f64, f64),
}

#[derive(Debug, Clone, PartialEq)]
enum Model {
    Constant(Complex64),
    LorentzDrude(LorentzDrude),
    BrendelBormann(BrendelBormann),
    Tabulated { n: Tabulated, k: Option<Tabulated> },
    Formula { n: Formula, k: Option<Tabulated> },
    Parameters(DispersionModel),
}

impl Dispersion {
    fn of(model: Model, range_nm: (f64, f64)) -> Self {
        Self { model, range_nm, data_nm: range_nm }
    }

    /// Dispersion that may be used in all of `to_nm`, too: beyond the data, a formula is continued, and
    /// tables keep their first or last value.
    pub(crate) fn continued(mut self, to_nm: (f64, f64)) -> Self {
        self.range_nm = (self.range_nm.0.min(to_nm.0), self.range_nm.1.max(to_nm.1));
        self
    }

    /// Constant n + ik at every wavelength.
    ///
    /// # Errors
    /// Unless n and k are finite, not negative and not both zero.
    pub fn constant(n: f64, k: f64) -> Result<Self, SpectraError> {
        let index = checked(Complex64::new(n, k))?;
        Ok(Self::of(Model::Constant(index), (0.0, f64::INFINITY)))
    }

    /// Tables of n and k against wavelength (nm), each linear between its points; without `k`, k = 0.
    ///
    /// The range is the intersection of the ranges of the two tables.
    ///
    /// # Errors
    /// If a value is negative, n and k vanish together, or the ranges do not overlap.
    pub fn tabulated(n: Tabulated, k: Option<Tabulated>) -> Result<Self, SpectraError> {
        let range_nm = shared_range(n.range_nm(), k.as_ref())?;
        let dispersion = Self::of(Model::Tabulated { n, k }, range_nm);
        // Both tables are linear between points, so checking the points is sufficient.
        for nm in dispersion.table_points() {
            dispersion.index(nm)?;
        }
        Ok(dispersion)
    }

    /// A dispersion formula of refractiveindex.info.
    ///
    /// `number` is 1 to 9 and `coefficients` are C1, C2, ... for wavelengths in
    /// um, both as in the database; missing coefficients at the end of
    /// formulas 4 and 7 to 9 are zero. `range_nm` is the range of validity of the formula.
    /// With a table of k, the range is restricted to that of `k`.
    ///
    /// # Errors
    /// An unknown number, a wrong number of coefficients for the formula,
    /// a range that is empty or does not overlap that of `k`, a negative k.
    pub fn formula(
        number: u8,
        coefficients: &[f64],
        range_nm: (f64, f64),
        k: Option<Tabulated>,
    ) -> Result<Self, SpectraError> {
        let n = Formula::new(number, coefficients)?;
        if !(range_nm.0 > 0.0 && range_nm.0 <= range_nm.1 && range_nm.1.is_finite()) {
            return Err(SpectraError::NoRange { first: range_nm.0, last: range_nm.1 });
        }
        let range_nm = shared_range(range_nm, k.as_ref())?;
        if let Some(&k) = k.as_ref().and_then(|k| k.values().iter().find(|&&k| k < 0.0)) {
            return Err(SpectraError::NoIndex { n: 1.0, k });
        }
        Ok(Self::of(Model::Formula { n, k }, range_nm))
    }

    /// A model by its parameters, at any wavelength.
    pub fn model(model: DispersionModel) -> Self {
        Self::of(Model::Parameters(model), (0.0, f64::INFINITY))
    }

    pub(crate) fn lorentz_drude(
        plasma_ev: f64,
        drude: (f64, f64),
        oscillators: &[Oscillator],
        range_nm: (f64, f64),
    ) -> Self {
        let model = LorentzDrude { plasma_ev, drude, oscillators: oscillators.to_vec() };
        Self::of(Model::LorentzDrude(model), range_nm)
    }

    pub(crate) fn brendel_bormann(
        plasma_ev: f64,
        drude: (f64, f64),
        oscillators: &[(Oscillator, f64)],
        range_nm: (f64, f64),
    ) -> Self {
        let model = BrendelBormann { plasma_ev, drude, oscillators: oscillators.to_vec() };
        Self::of(Model::BrendelBormann(model), range_nm)
    }

    /// First and last wavelength of the range of validity, nm; (0, infinity) for a constant and for a model by parameters.
    pub fn range_nm(&self) -> (f64, f64) {
        self.range_nm
    }

    /// n + ik at `nm`, with k >= 0.
    ///
    /// # Errors
    /// Outside [`range_nm`](Self::range_nm), or if a formula gives no real n.
    pub fn index(&self, nm: f64) -> Result<Complex64, SpectraError> {
        let (first, last) = self.range_nm;
        let nm = within(nm, self.range_nm).ok_or(SpectraError::OutsideTable { nm, first, last })?;
        let in_data = nm.clamp(self.data_nm.0, self.data_nm.1);
        let index = match &self.model {
            Model::Constant(index) => *index,
            Model::LorentzDrude(model) => model.index(nm),
            Model::BrendelBormann(model) => model.index(nm),
            Model::Parameters(model) => return model.index(nm),
            Model::Tabulated { n, k } => Complex64::new(n.at(in_data)?, at_or_zero(k.as_ref(), in_data)?),
            Model::Formula { n, k } => Complex64::new(n.index(nm)?, at_or_zero(k.as_ref(), in_data)?),
        };
        checked(index)
    }

    /// n + ik at every wavelength of `grid`.
    ///
    /// # Errors
    /// If the range does not cover the grid.
    pub fn on(&self, grid: &Grid) -> Result<Vec<Complex64>, SpectraError> {
        grid.wavelengths_nm().into_iter().map(|nm| self.index(nm)).collect()
    }

    /// Wavelengths of all table points within the range, and its two ends.
    fn table_points(&self) -> Vec<f64> {
        let (first, last) = self.range_nm;
        let mut points = vec![first, last];
        if let Model::Tabulated { n, k } = &self.model {
            let tables = std::iter::once(n).chain(k);
            points.extend(tables.flat_map(|table| table.wavelengths_nm().iter().copied()));
        }
        points.retain(|nm| (first..=last).contains(nm));
        points
    }
}

fn at_or_zero(table: Option<&Tabulated>, nm: f64) -> Result<f64, SpectraError> {
    table.map_or(Ok(0.0), |table| table.at(nm))
}

fn checked(index: Complex64) -> Result<Complex64, SpectraError> {
    let passive = index.re >= 0.0 && index.im >= 0.0 && index.is_finite();
    if passive && index != Complex64::ZERO {
        Ok(index)
    } else {
        Err(SpectraError::NoIndex { n: index.re, k: index.im })
    }
}

fn shared_range(n: (f64, f64), k: Option<&Tabulated>) -> Result<(f64, f64), SpectraError> {
    let k = k.map_or(n, Tabulated::range_nm);
    let shared = (n.0.max(k.0), n.1.min(k.1));
    if shared.0 <= shared.1 {
        Ok(shared)
    } else {
        Err(SpectraError::NoRange { first: shared.0, last: shared.1 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(points: &[(f64, f64)]) -> Tabulated {
        Tabulated::new(points.iter().map(|p| p.0).collect(), points.iter().map(|p| p.1).collect()).unwrap()
    }

    #[test]
    fn tables_of_n_and_k_are_interpolated_separately() {
        let n = table(&[(400.0, 1.5), (600.0, 1.7), (800.0, 1.6)]);
        let k = table(&[(500.0, 0.1), (900.0, 0.5)]);
        let dispersion = Dispersion::tabulated(n, Some(k)).unwrap();
        assert_eq!(dispersion.range_nm(), (500.0, 800.0));
        let index = dispersion.index(700.0).unwrap();
        assert!((index - Complex64::new(1.65, 0.3)).norm() < 1e-15);
    }

    #[test]
    fn wavelength_outside_table_is_refused() {
        let dispersion = Dispersion::tabulated(table(&[(400.0, 1.5), (600.0, 1.7)]), None).unwrap();
        let expected = SpectraError::OutsideTable { nm: 601.0, first: 400.0, last: 600.0 };
        assert_eq!(dispersion.index(601.0), Err(expected));
        assert!(dispersion.index(f64::NAN).is_err());
        let grid = Grid::new(380.0, 780.0, 5.0).unwrap();
        assert!(dispersion.on(&grid).is_err());
    }

    /// Cauchy's formula, n = 1.5, over ranges that are empty, not positive or without end.
    #[test]
    fn range_of_a_formula_is_positive_and_finite() {
        let over = |range_nm| Dispersion::formula(5, &[1.5], range_nm, None);
        for range in [(0.0, 700.0), (-1.0, 700.0), (700.0, 400.0), (400.0, f64::INFINITY), (f64::NAN, 700.0)]
        {
            assert!(matches!(over(range), Err(SpectraError::NoRange { .. })), "{range:?}");
        }
        assert_eq!(over((500.0, 500.0)).unwrap().range_nm(), (500.0, 500.0));
    }

    #[test]
    fn negative_k_zero_index_and_disjoint_ranges_are_refused() {
        assert!(Dispersion::constant(1.5, -1e-9).is_err());
        assert!(Dispersion::constant(0.0, 0.0).is_err());
        assert!(Dispersion::constant(f64::NAN, 0.0).is_err());
        let n = table(&[(400.0, 1.5), (600.0, 1.7)]);
        let gain = table(&[(400.0, 0.1), (500.0, -0.1), (600.0, 0.1)]);
        assert!(Dispersion::tabulated(n.clone(), Some(gain.clone())).is_err());
        assert!(Dispersion::formula(5, &[1.5], (400.0, 600.0), Some(gain)).is_err());
        let elsewhere = table(&[(700.0, 0.1), (800.0, 0.1)]);
        assert!(Dispersion::tabulated(n, Some(elsewhere)).is_err());
        assert!(Dispersion::formula(5, &[1.5], (600.0, 400.0), None).is_err());
    }
}
