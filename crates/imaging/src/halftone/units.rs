//! The states of a halftone in whole units of light, and the nearest one to a colour.

/// Whole units of the largest coordinate of a palette: 2^23 to 2^24.
const UNIT_BITS: i32 = 24;

/// States whose distances are computed at once.
const LANES: usize = 8;

/// Largest wanted coordinate in units, 16 times that of the palette: sums stay within 32 bits.
pub(super) const MOST_UNITS: f32 = 268_435_456.0;

/// The states in units, prepared for the search of the nearest one.
pub(super) struct Palette<const N: usize> {
    /// Units per 1, a power of 2.
    pub(super) scale: f32,
    pub(super) units: Vec<[i32; N]>,
    /// For a colour v in units: `gradient.v + constant` is the squared distance to a state in the metric,
    /// less |v|^2, halved.
    gradients: [Vec<f32>; N],
    constants: Vec<f32>,
    /// The same of five to [`LANES`] states, whose distances are computed at once; states that do not exist are infinitely far.
    lanes: Option<([[f32; LANES]; N], [f32; LANES])>,
    /// Limit of the error in units.
    pub(super) limit: i32,
}

impl<const N: usize> Palette<N> {
    pub(super) fn new(palette: &[[f64; N]], metric: [[f64; N]; N], limit: f64) -> Self {
        let largest = palette.iter().flatten().fold(0.0_f64, |largest, value| largest.max(value.abs()));
        let exponent = if largest > 1e-30 { largest.log2().ceil() as i32 } else { 0 };
        let scale = 2.0_f64.powi(UNIT_BITS - exponent.min(60));
        let units: Vec<[i32; N]> =
            palette.iter().map(|colour| colour.map(|value| (value * scale).round() as i32)).collect();
        let extent = (0..N).map(|k| {
            let along = || units.iter().map(|colour| colour[k]);
            along().max().unwrap_or(0) - along().min().unwrap_or(0)
        });
        let extent = f64::from(extent.max().unwrap_or(0).max(1));
        let limit = (if limit.is_nan() { 1.0 } else { limit.clamp(0.0, 4.0) } * extent) as i32;
        let in_metric = |colour: [f64; N]| {
            metric.map(|row| row.iter().zip(colour).map(|(m, value)| m * value).sum::<f64>())
        };
        // The size of the metric does not matter; that of the numbers must fit single precision.
        let size = metric.iter().flatten().fold(1e-30_f64, |size, m| size.max(m.abs()));
        let mut prepared = Self {
            scale: scale as f32,
            units,
            gradients: [const { Vec::new() }; N],
            constants: Vec::new(),
            lanes: None,
            limit,
        };
        for units in &prepared.units {
            let at = in_metric(units.map(f64::from));
            let square: f64 = at.iter().map(|value| value * value).sum();
            prepared.constants.push((0.5 * square / (size * size)) as f32);
            for (k, gradients) in prepared.gradients.iter_mut().enumerate() {
                let along: f64 = metric.iter().zip(at).map(|(row, value)| row[k] * value).sum();
                gradients.push((-along / (size * size)) as f32);
            }
        }
        // Of fewer states, one after the other is as quick.
        if (5..=LANES).contains(&palette.len()) {
            let lanes = |of: &[f32], rest: f32| std::array::from_fn(|at| of.get(at).copied().unwrap_or(rest));
            let gradients = prepared.gradients.each_ref().map(|gradients| lanes(gradients, 0.0));
            prepared.lanes = Some((gradients, lanes(&prepared.constants, f32::INFINITY)));
        }
        prepared
    }

    /// The state nearest to a colour in units; of several, the last one.
    #[inline(always)]
    pub(super) fn nearest(&self, colour: [i32; N]) -> usize {
        let Some((gradients, constants)) = &self.lanes else { return self.nearest_of(colour, |_| true) };
        let mut distances = *constants;
        for (value, gradients) in colour.iter().zip(gradients) {
            for lane in 0..LANES {
                distances[lane] += *value as f32 * gradients[lane];
            }
        }
        let one = |state: usize| (distances[state], state);
        let nearer = |one: (f32, usize), other: (f32, usize)| if other.0 <= one.0 { other } else { one };
        let low = nearer(nearer(one(0), one(1)), nearer(one(2), one(3)));
        let high = nearer(nearer(one(4), one(5)), nearer(one(6), one(7)));
        nearer(low, high).1
    }

    /// The same of some states.
    #[inline]
    pub(super) fn nearest_of(&self, colour: [i32; N], is_allowed: impl Fn(usize) -> bool) -> usize {
        let colour = colour.map(|value| value as f32);
        let (mut nearest, mut smallest) = (0, f32::INFINITY);
        for (state, constant) in self.constants.iter().enumerate() {
            let mut distance = *constant;
            for (value, gradients) in colour.iter().zip(&self.gradients) {
                distance += value * gradients[state];
            }
            if distance <= smallest && is_allowed(state) {
                (nearest, smallest) = (state, distance);
            }
        }
        nearest
    }
}
