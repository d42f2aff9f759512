//! Derivatives of the metrics with respect to the reflectance factors under each source.
//!
//! All quantities up to X, Y and Z are linear; the metrics are closed forms of a few of these numbers. They
//! are differentiated by central differences of fourth order. The steps are small relative to each number
//! ([`STEP`]) and do not cross the joint of CIELAB's cube root and its linear toe: errors are below 1e-10 of
//! the slope. At the joint itself, where the slope is continuous, they are below 1e-6.

use papilio_colour::{LUMENS_PER_WATT, Xyz, peak_slopes};

use super::metrics::{StateObservation, ViewScalars};
use super::{Meter, Sample};
use crate::setup::Setup;

/// Derivatives of a number with respect to the quantities of each state.
pub(crate) struct Slopes {
    /// With respect to X, Y and Z.
    pub(crate) xyz: Vec<[f64; 3]>,
    /// With respect to the luminance, cd/m2.
    pub(crate) luminance: Vec<f64>,
    /// With respect to the peak wavelength, nm.
    pub(crate) peak_nm: Vec<f64>,
    /// With respect to the reflectance factor, `[state][wavelength]`.
    pub(crate) factor: Vec<f64>,
    /// With respect to the luminance factor under the diffuse light alone.
    pub(crate) diffuse: Vec<f64>,
}

impl Slopes {
    pub(crate) fn zeros(states: usize, bins: usize) -> Self {
        Self {
            xyz: vec![[0.0; 3]; states],
            luminance: vec![0.0; states],
            peak_nm: vec![0.0; states],
            factor: vec![0.0; states * bins],
            diffuse: vec![0.0; states],
        }
    }
}

/// Number of a state on which a metric may depend.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Number {
    /// X (0), Y (1) or Z (2).
    Xyz(usize),
    Luminance,
    Peak,
}

impl Number {
    fn of(self, observation: &mut StateObservation) -> Option<&mut f64> {
        match self {
            Self::Xyz(0) => Some(&mut observation.xyz.x),
            Self::Xyz(1) => Some(&mut observation.xyz.y),
            Self::Xyz(_) => Some(&mut observation.xyz.z),
            Self::Luminance => Some(&mut observation.luminance_cd_m2),
            Self::Peak => observation.peak_nm.as_mut(),
        }
    }
}

/// Step of the differences, relative to each number.
const STEP: f64 = 3e-5;
/// Ratio to the white's X, Y or Z at which CIELAB's cube root joins its linear toe.
const JOINT: f64 = 216.0 / 24389.0;

impl Meter<'_> {
    /// Adds to `slopes` the derivatives of a metric, which `value` selects, with respect to these numbers of
    /// some states; returns false if it is not defined here. Only these states are evaluated.
    pub(crate) fn add_slopes(
        &self,
        sample: &Sample,
        states: &[usize],
        numbers: &[Number],
        value: impl Fn(&ViewScalars) -> Option<f64>,
        slopes: &mut Slopes,
    ) -> bool {
        let observations: Vec<StateObservation> =
            states.iter().map(|state| self.observation(*state, sample, None)).collect();
        let names: Vec<String> = states.iter().map(|state| self.setup.states[*state].clone()).collect();
        let at = |observations: &[StateObservation]| {
            value(&self.reference_among(&names, observations).view(observations))
        };
        let own_white = self.reference_among(&names, &observations).lab_white;
        let white = own_white.unwrap_or(self.white_xyz * (1.0 / self.white_xyz.y)).to_array();
        for (place, &state) in states.iter().enumerate() {
            for &number in numbers {
                let Some(slope) = self.slope(&observations, place, number, white, at) else { return false };
                match number {
                    Number::Xyz(k) => slopes.xyz[state][k] += slope,
                    Number::Luminance => slopes.luminance[state] += slope,
                    Number::Peak => slopes.peak_nm[state] += slope,
                }
            }
        }
        true
    }

    fn slope(
        &self,
        observations: &[StateObservation],
        place: usize,
        number: Number,
        white: [f64; 3],
        at: impl Fn(&[StateObservation]) -> Option<f64>,
    ) -> Option<f64> {
        let mut moved = observations.to_vec();
        let Xyz { x, y, z } = moved[place].xyz;
        let value = *number.of(&mut moved[place])?;
        let step = match number {
            Number::Xyz(k) => {
                let size = value.abs().max(0.01 * (x.abs() + y.abs() + z.abs()));
                let room = 0.4 * (value - JOINT * white[k]).abs();
                (STEP * size).min(room.max(1e-6 * size))
            }
            Number::Luminance | Number::Peak => STEP * value.abs(),
        };
        if step == 0.0 {
            return None;
        }
        let mut shifted = |steps: f64| {
            *number.of(&mut moved[place])? = value + steps * step;
            at(&moved)
        };
        let near = shifted(1.0)? - shifted(-1.0)?;
        let far = shifted(2.0)? - shifted(-2.0)?;
        Some((8.0 * near - far) / (12.0 * step))
    }

    /// Adds the derivatives of the number with respect to each source's `rho.base` to `out`,
    /// `[source][state][wavelength]`. Returns false if a peak is not defined.
    pub(crate) fn pull_back(&self, sample: &Sample, slopes: &mut Slopes, out: &mut [f64]) -> bool {
        let (states, bins) = (self.layout.states, self.layout.bins);
        for state in (0..states).filter(|state| slopes.peak_nm[*state] != 0.0) {
            let peak = self.reflectance_factor(state, &sample.0).and_then(|f| peak_slopes(&self.grid, &f));
            let Some((first, of_bins)) = peak else { return false };
            let factor = &mut slopes.factor[state * bins + first..];
            factor.iter_mut().zip(of_bins).for_each(|(f, slope)| *f += slopes.peak_nm[state] * slope);
        }
        let mut radiance = vec![0.0; bins];
        for state in 0..states {
            self.by_radiance(slopes, state, &mut radiance);
            for (light, out) in self.lights.iter().zip(out.chunks_exact_mut(states * bins)) {
                let diffuse = if light.term == 0 && self.luminous[0] > 0.0 {
                    slopes.diffuse[state] / self.luminous[0]
                } else {
                    0.0
                };
                let factor = &slopes.factor[state * bins..][..bins];
                let of_xyz = slopes.xyz[state].map(|slope| slope / self.white_xyz.y);
                let of_y_1931 = LUMENS_PER_WATT * slopes.luminance[state];
                for (bin, out) in out[state * bins..][..bins].iter_mut().enumerate() {
                    let by_share = if self.white[bin] > 0.0 { 0.0 } else { light.share * factor[bin] };
                    *out += light.radiance[bin] * radiance[bin] + by_share + light.xyz[1][bin] * diffuse;
                    if let Some(corrections) = &light.corrections {
                        *out += corrections.slope(bin, of_xyz, of_y_1931);
                    }
                }
            }
        }
        if let Some(guide) = &self.below_front {
            let (others, last) = out.split_at_mut(out.len() - states * bins);
            guide.pull_back(last, &mut others[..states * bins]);
        }
        true
    }

    /// Computes the derivative with respect to a state's radiance.
    fn by_radiance(&self, slopes: &Slopes, state: usize, radiance: &mut [f64]) {
        let Setup { observer, .. } = self.setup;
        let (bars, y_bar) = (self.setup.seen_by().weights(), observer.weights()[1]);
        let of_luminance = LUMENS_PER_WATT * slopes.luminance[state];
        let of_xyz = slopes.xyz[state].map(|slope| slope / self.white_xyz.y);
        let factor = &slopes.factor[state * radiance.len()..];
        for (bin, radiance) in radiance.iter_mut().enumerate() {
            let by_colour: f64 = bars.iter().zip(of_xyz).map(|(bar, slope)| bar[bin] * slope).sum();
            let white = self.white[bin];
            let by_factor = if white > 0.0 { factor[bin] / white } else { 0.0 };
            *radiance = by_colour + of_luminance * y_bar[bin] + by_factor;
        }
    }
}
