//! *measure*: from what replicates of a solver saw to what a meter would say, with errors.
//!
//! Standard errors come from the jackknife (Efron 1982): metrics of the mean with one
//! replicate left out, for each in turn. For linear quantities this is the textbook
//! standard error; for ratios and colour coordinates it carries all correlations between
//! wavelengths and states.

use std::f64::consts::PI;

use papilio_colour::{LUMENS_PER_WATT, Xyz};
use papilio_spectra::Grid;
use papilio_transport::Estimate;

use crate::metrics::{Reference, Scalars, ViewScalars};
use crate::prepare::{Prepared, ViewPoint};
use crate::result::{
    Absorbed, Illuminant, Ledger, LedgerError, Named, State, StateValues, Terms, View, ViewError,
};
use crate::sample::{Layout, Sample, relative, spread};

/// A spectrum whose extremes differ by less than this many of its largest standard error is flat.
const FLAT: f64 = 10.0;

/// Turns estimates into samples and samples into results.
pub(crate) struct Meter<'a> {
    prepared: &'a Prepared,
    grid: Grid,
    layout: Layout,
    /// Spectral radiance of the perfect white, and its X, Y, Z in W/(m2 sr).
    white: Vec<f64>,
    white_xyz: Xyz,
}

impl<'a> Meter<'a> {
    pub(crate) fn new(prepared: &'a Prepared, grid: Grid) -> Self {
        let mut white = vec![0.0; grid.len()];
        for light in &prepared.lights {
            white.iter_mut().zip(light.irradiance.iter()).for_each(|(l, e)| *l += e / PI);
        }
        let layout =
            Layout { states: prepared.states.len(), bins: grid.len(), lights: prepared.lights.len() };
        let white_xyz = prepared.observer.xyz(&white);
        Self { prepared, grid, layout, white, white_xyz }
    }

    /// ybar at each wavelength, nm.
    fn y_bar(&self) -> &[f64] {
        self.prepared.observer.weights()[1]
    }

    /// One replicate's estimate as a sample.
    pub(crate) fn sample(&self, estimate: &Estimate) -> Sample {
        let layout = &self.layout;
        let mut sample = vec![0.0; layout.len()];
        let total: f64 = self.prepared.lights.iter().map(|light| light.illuminance_lx).sum();
        for (l, (light, rho)) in self.prepared.lights.iter().zip(&estimate.rho).enumerate() {
            let share = light.illuminance_lx / total;
            for state in 0..layout.states {
                let base = &rho.base[state * layout.bins..][..layout.bins];
                let (mut from_base, mut from_front) = (0.0, 0.0);
                for (bin, (base, front)) in base.iter().zip(&rho.front).enumerate() {
                    let radiance_of_white = light.irradiance[bin] / PI;
                    sample[layout.radiance(state).start + bin] += radiance_of_white * (base + front);
                    sample[layout.factor(state).start + bin] += share * (base + front);
                    let y = radiance_of_white * self.y_bar()[bin] / self.white_xyz.y;
                    from_base += y * base;
                    from_front += y * front;
                }
                sample[layout.terms(state).start + l] = from_base;
                sample[layout.front_term(state)] += from_front;
            }
        }
        self.add_ledger(&estimate.ledger, &mut sample);
        Sample(sample)
    }

    fn add_ledger(&self, ledger: &papilio_transport::Ledger, sample: &mut [f64]) {
        let y = self.white.iter().zip(self.y_bar());
        let luminous: Vec<f64> = y.map(|(l, y)| l * y / self.white_xyz.y).collect();
        let parts: [&[f64]; Layout::LEDGER] = [
            &ledger.returned,
            &ledger.front,
            &ledger.diffuser,
            &ledger.glass,
            &ledger.pixel,
            &ledger.inactive,
            &ledger.unaccounted,
        ];
        for state in 0..self.layout.states {
            for (slot, part) in self.layout.ledger(state).zip(parts) {
                let row = &part[state * self.layout.bins..][..self.layout.bins];
                sample[slot] = row.iter().zip(&luminous).map(|(a, b)| a * b).sum();
            }
        }
    }

    /// The largest relative standard error of Y over the states; with `every_bin`, also of
    /// the radiance at each wavelength, against the spectrum's maximum.
    pub(crate) fn relative_error(&self, samples: &[Sample], every_bin: bool) -> f64 {
        let mut worst = 0.0_f64;
        for state in 0..self.layout.states {
            let at = self.layout.radiance(state);
            let y = |s: &Sample| s.0[at.clone()].iter().zip(self.y_bar()).map(|(l, y)| l * y).sum::<f64>();
            worst = worst.max(relative(spread(samples.iter().map(y))));
            if every_bin {
                let bins: Vec<(f64, f64)> = at.map(|k| spread(samples.iter().map(|s| s.0[k]))).collect();
                let most = bins.iter().map(|(mean, _)| *mean).fold(0.0, f64::max);
                worst = bins.iter().map(|(_, error)| relative((most, *error))).fold(worst, f64::max);
            }
        }
        worst
    }

    /// The perfect white under the scene's light.
    pub(crate) fn illuminant(&self) -> Illuminant {
        let (xy, uv) = (self.white_xyz.chromaticity(), self.white_xyz.uv_prime());
        Illuminant {
            radiance_of_white: self.white.clone(),
            x: xy.map_or(f64::NAN, |c| c.x),
            y: xy.map_or(f64::NAN, |c| c.y),
            u_prime: uv.map_or(f64::NAN, |c| c.u),
            v_prime: uv.map_or(f64::NAN, |c| c.v),
        }
    }

    /// A view's result from the samples of all replicates; `specular` has shape `[state][light]`.
    pub(crate) fn view(&self, at: &ViewPoint, samples: &[Sample], specular: &[Vec<f64>]) -> View {
        let mean = Sample::mean(samples, None);
        let errors = Sample::standard_errors(samples);
        let mut scalars = self.scalars(&mean);
        let flat = |s: usize| self.is_flat(s, &mean.0, &errors);
        scalars
            .states
            .iter_mut()
            .enumerate()
            .filter(|(s, _)| flat(*s))
            .for_each(|(_, state)| state.peak_nm = None);
        let left_out: Vec<ViewScalars> =
            (0..samples.len()).map(|k| self.scalars(&Sample::mean(samples, Some(k)))).collect();
        let mut scalar_errors = ViewScalars::jackknife(&left_out);
        for (error, value) in scalar_errors.states.iter_mut().zip(&scalars.states) {
            error.peak_nm = value.peak_nm.and(error.peak_nm);
        }
        let state = |s: usize| {
            let none = vec![0.0; specular[s].len()];
            State {
                value: self.state(s, &mean.0, &scalars.states[s], specular[s].clone()),
                standard_error: self.state(s, &errors, &scalar_errors.states[s], none),
                discretisation_error: None,
            }
        };
        View {
            theta_deg: at.theta_deg,
            phi_deg: at.phi_deg,
            states: self.by_name(state),
            contrast_ratio: scalars.contrast_ratio,
            gamut_percent_srgb: scalars.gamut_srgb,
            gamut_percent_ebu: scalars.gamut_ebu,
            standard_error: ViewError {
                contrast_ratio: scalar_errors.contrast_ratio,
                gamut_percent_srgb: scalar_errors.gamut_srgb,
                gamut_percent_ebu: scalar_errors.gamut_ebu,
            },
            discretisation_error: None,
            ledger: self.by_name(|s| self.ledger(s, &mean.0, &errors)),
        }
    }

    fn by_name<T>(&self, one: impl Fn(usize) -> T) -> Named<T> {
        Named(self.prepared.states.iter().enumerate().map(|(s, name)| (name.clone(), one(s))).collect())
    }

    fn scalars(&self, mean: &Sample) -> ViewScalars {
        let relative = |state: usize| {
            let xyz = self.prepared.observer.xyz(&mean.0[self.layout.radiance(state)]);
            over(xyz, self.white_xyz.y)
        };
        let xyz: Vec<Xyz> = (0..self.layout.states).map(relative).collect();
        let factors: Vec<Vec<f64>> =
            (0..self.layout.states).map(|s| self.reflectance_factor(s, &mean.0)).collect();
        let factors: Vec<&[f64]> = factors.iter().map(Vec::as_slice).collect();
        let reference = Reference {
            names: &self.prepared.states,
            grid: &self.grid,
            white: over(self.white_xyz, self.white_xyz.y),
            white_luminance: LUMENS_PER_WATT * self.white_xyz.y,
        };
        reference.view(&xyz, &factors)
    }

    /// Also of standard errors: both radiance and factor are linear in light.
    fn reflectance_factor(&self, state: usize, linear: &[f64]) -> Vec<f64> {
        let (radiance, by_share) = (&linear[self.layout.radiance(state)], &linear[self.layout.factor(state)]);
        let bins = radiance.iter().zip(by_share).zip(&self.white);
        bins.map(|((l, share), white)| if *white > 0.0 { l / white } else { *share }).collect()
    }

    /// A spectrum that varies by no more than its own noise has no peak.
    fn is_flat(&self, state: usize, mean: &[f64], errors: &[f64]) -> bool {
        let (factor, error) = (self.reflectance_factor(state, mean), self.reflectance_factor(state, errors));
        let (mut least, mut most, mut noise) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
        for ((nm, factor), error) in self.grid.wavelengths_nm().into_iter().zip(factor).zip(error) {
            if (400.0..=700.0).contains(&nm) {
                (least, most, noise) = (least.min(factor), most.max(factor), noise.max(error));
            }
        }
        most - least < FLAT * noise
    }

    /// Assembles values, or their errors.
    fn state(&self, state: usize, linear: &[f64], scalars: &Scalars, specular: Vec<f64>) -> StateValues {
        let terms = &linear[self.layout.terms(state)];
        let [x, y, z] = scalars.xyz.map(Option::unwrap_or_default);
        StateValues {
            radiance: linear[self.layout.radiance(state)].to_vec(),
            reflectance_factor: self.reflectance_factor(state, linear),
            X: x,
            Y: y,
            Z: z,
            x: scalars.chromaticity[0],
            y: scalars.chromaticity[1],
            z: scalars.chromaticity[2],
            u_prime: scalars.uv_prime[0],
            v_prime: scalars.uv_prime[1],
            L_star: scalars.lab[0],
            a_star: scalars.lab[1],
            b_star: scalars.lab[2],
            luminance_cd_m2: scalars.luminance.unwrap_or_default(),
            contrast: scalars.contrast,
            peak_nm: scalars.peak_nm,
            distance_from_white_uv: scalars.from_white,
            distance_from_d65_uv: scalars.from_d65,
            hue_rgb: all(scalars.hue_rgb),
            terms: Terms {
                diffuse: terms[0],
                directed: terms[1..].to_vec(),
                front_reflection: linear[self.layout.front_term(state)],
            },
            specular,
        }
    }

    fn ledger(&self, state: usize, mean: &[f64], errors: &[f64]) -> Ledger {
        let at = self.layout.ledger(state);
        let (returned, absorbed, unaccounted) = ledger_parts(&mean[at.clone()]);
        let (e_returned, e_absorbed, e_unaccounted) = ledger_parts(&errors[at]);
        let standard_error =
            LedgerError { returned: e_returned, absorbed: e_absorbed, unaccounted: e_unaccounted };
        Ledger { returned, absorbed, unaccounted, standard_error, discretisation_error: None }
    }

    /// Luminance factors of the directed sources' images, shape `[state][light]`.
    pub(crate) fn specular(&self, images: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let lights = &self.prepared.lights[1..];
        let one = |state: usize, (light, image): (&crate::prepare::Light, &Vec<f64>)| {
            let row = &image[state * self.layout.bins..][..self.layout.bins];
            let seen: Vec<f64> = row.iter().zip(light.irradiance.iter()).map(|(r, e)| r * e).collect();
            let source = self.prepared.observer.luminance(&light.irradiance);
            if source > 0.0 { self.prepared.observer.luminance(&seen) / source } else { 0.0 }
        };
        (0..self.layout.states)
            .map(|s| lights.iter().zip(images).map(|pair| one(s, pair)).collect())
            .collect()
    }
}

fn over(xyz: Xyz, y: f64) -> Xyz {
    Xyz { x: xyz.x / y, y: xyz.y / y, z: xyz.z / y }
}

/// In the order of [`Layout::LEDGER`].
fn ledger_parts(shares: &[f64]) -> (f64, Absorbed, f64) {
    let absorbed = Absorbed {
        front: shares[1],
        diffuser: shares[2],
        glass: shares[3],
        pixel: shares[4],
        inactive: shares[5],
    };
    (shares[0], absorbed, shares[6])
}

/// All three, or none.
fn all([r, g, b]: [Option<f64>; 3]) -> Option<[f64; 3]> {
    Some([r?, g?, b?])
}
