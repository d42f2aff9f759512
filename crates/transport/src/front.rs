//! Front of screen: flat components in air, combined incoherently.
//!
//! Each component mirrors a fraction R and absorbs a fraction A of the light, the same from both sides and
//! at every angle (Feng 2012, fig. 3.2); it transmits 1 - R - A. For two parts above each other, with `r'`
//! the upper one's reflectance from below:
//!
//! `T = T1 T2 / (1 - r1' r2)`, `R = r1 + T1^2 r2 / (1 - r1' r2)`,
//!
//! which sums all inter-reflections. The first order of Feng 2012, eq. 3-2 and 3-3, leaves the denominators
//! out. Valid for components whose distance exceeds the coherence length of room light (tens of
//! micrometres).

use papilio_spectra::Spectrum;

/// The whole front of screen, per wavelength: fractions; the three of each side sum to one.
#[derive(Debug, Clone, PartialEq)]
pub struct Front {
    /// Fraction transmitted, the same in both directions.
    pub transmittance: Spectrum,
    /// Fraction mirrored back to the reader.
    pub reflectance_above: Spectrum,
    /// Fraction mirrored back to the panel.
    pub reflectance_below: Spectrum,
}

impl Front {
    /// Returns a front without components: everything passes.
    pub fn none(bins: usize) -> Self {
        let all = |value| Spectrum::from_values(vec![value; bins]);
        Self { transmittance: all(1.0), reflectance_above: all(0.0), reflectance_below: all(0.0) }
    }

    /// Sums all inter-reflections of components given as (R, A), outermost first.
    pub fn exact<'a>(bins: usize, components: impl IntoIterator<Item = (&'a [f64], &'a [f64])>) -> Self {
        let mut sum = Self::none(bins);
        for (r, a) in components {
            for bin in 0..bins {
                let lower = Flat { t: 1.0 - r[bin] - a[bin], above: r[bin], below: r[bin] };
                sum.set(bin, sum.at(bin).over(lower));
            }
        }
        sum
    }

    /// Combines components to first order only (Feng 2012, eq. 3-2 and 3-3).
    pub fn first_order<'a>(
        bins: usize,
        components: impl IntoIterator<Item = (&'a [f64], &'a [f64])>,
    ) -> Self {
        let mut sum = Self::none(bins);
        for (r, a) in components {
            for bin in 0..bins {
                let lower = Flat { t: 1.0 - r[bin] - a[bin], above: r[bin], below: r[bin] };
                sum.set(bin, sum.at(bin).once_over(lower));
            }
        }
        sum
    }

    /// Returns the three numbers of one wavelength.
    #[inline]
    pub(crate) fn at(&self, bin: usize) -> Flat {
        Flat {
            t: self.transmittance[bin],
            above: self.reflectance_above[bin],
            below: self.reflectance_below[bin],
        }
    }

    fn set(&mut self, bin: usize, flat: Flat) {
        self.transmittance[bin] = flat.t;
        self.reflectance_above[bin] = flat.above;
        self.reflectance_below[bin] = flat.below;
    }
}

/// A flat part of the stack at one wavelength and angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Flat {
    /// Transmittance, the same in both directions (of basic radiance).
    pub(crate) t: f64,
    /// Reflectance from above.
    pub(crate) above: f64,
    /// Reflectance from below.
    pub(crate) below: f64,
}

impl Flat {
    /// Everything passes.
    pub(crate) const CLEAR: Self = Self { t: 1.0, above: 0.0, below: 0.0 };
    /// Everything is absorbed, or scattered.
    pub(crate) const OPAQUE: Self = Self { t: 0.0, above: 0.0, below: 0.0 };
    /// Everything is reflected.
    pub(crate) const MIRROR: Self = Self { t: 0.0, above: 1.0, below: 1.0 };

    /// Returns the mean of two.
    pub(crate) fn mean([one, other]: [Self; 2]) -> Self {
        let mean = |a: f64, b: f64| 0.5 * (a + b);
        Self {
            t: mean(one.t, other.t),
            above: mean(one.above, other.above),
            below: mean(one.below, other.below),
        }
    }

    /// Combines this part with `lower` below it, all inter-reflections included.
    #[inline]
    pub(crate) fn over(self, lower: Self) -> Self {
        if self.t == 0.0 {
            return Self { t: 0.0, above: self.above, below: lower.below_under(self) };
        }
        let series = 1.0 / (1.0 - self.below * lower.above);
        Self {
            t: self.t * lower.t * series,
            above: self.above + self.t * self.t * lower.above * series,
            below: lower.below + lower.t * lower.t * self.below * series,
        }
    }

    /// Combines this part with `lower` below it to first order: without light reflected back and forth
    /// between them.
    #[inline]
    pub(crate) fn once_over(self, lower: Self) -> Self {
        Self {
            t: self.t * lower.t,
            above: self.above + self.t * self.t * lower.above,
            below: lower.below + lower.t * lower.t * self.below,
        }
    }

    /// Returns the reflectance from below of this part under another one.
    #[inline]
    fn below_under(self, upper: Self) -> f64 {
        let denominator = 1.0 - upper.below * self.above;
        // Between two perfect mirrors nothing passes.
        if denominator <= 0.0 { self.below } else { self.below + self.t * self.t * upper.below / denominator }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const R: [f64; 3] = [0.04, 0.01, 0.02];
    const A: [f64; 3] = [0.01, 0.005, 0.0];

    fn components() -> impl Iterator<Item = (&'static [f64], &'static [f64])> {
        R.iter().zip(&A).map(|(r, a)| (std::slice::from_ref(r), std::slice::from_ref(a)))
    }

    /// Values summed by hand from eq. 3-2, 3-3 and from the full series.
    #[test]
    fn three_components_first_order_and_exact() {
        let first = Front::first_order(1, components());
        assert!((first.transmittance[0] - 0.917035).abs() < 1e-6);
        assert!((first.reflectance_above[0] - 0.066538).abs() < 1e-6);
        let exact = Front::exact(1, components());
        assert!((exact.transmittance[0] - 0.918299).abs() < 1e-6);
        assert!((exact.reflectance_above[0] - 0.066572).abs() < 1e-6);
    }

    #[test]
    fn order_of_combination_does_not_matter() {
        let flat = |i: usize| Flat { t: 1.0 - R[i] - A[i], above: R[i], below: R[i] };
        let left = flat(0).over(flat(1)).over(flat(2));
        let right = flat(0).over(flat(1).over(flat(2)));
        assert!((left.t - right.t).abs() < 1e-15 && (left.above - right.above).abs() < 1e-15);
        assert!((left.below - right.below).abs() < 1e-15);
    }

    #[test]
    fn perfect_mirror_above_another_is_finite() {
        let mirror = Flat { t: 0.0, above: 1.0, below: 1.0 };
        let both = mirror.over(mirror);
        assert_eq!((both.t, both.above, both.below), (0.0, 1.0, 1.0));
    }
}
