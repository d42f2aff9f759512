//! Assembly of values and their errors into results.

use super::Meter;
use super::metrics::{PRIMARIES, Scalars, ViewScalars, three};
use super::sample::Sample;
use crate::readability::Reader;
use crate::result::{
    Absorbed, Ledger, LedgerError, Named, SpectraByLight, State, StateValues, Terms, View, XyzError,
};
use crate::setup::ViewPoint;

/// A spectrum is flat if its range is below this multiple of its largest error.
const FLAT: f64 = 10.0;

/// Values of a view, or their errors.
pub(super) struct Numbers {
    pub(super) linear: Sample,
    pub(super) scalars: ViewScalars,
}

#[allow(non_snake_case, reason = "the field's own letters")]
impl Meter<'_> {
    /// Assembles the result of a view; without noise, `standard` is 0 and `discretisation` is given.
    pub(super) fn view(
        &self,
        at: &ViewPoint,
        mut value: Numbers,
        mut standard: Numbers,
        mut discretisation: Option<Numbers>,
        specular: &[Vec<f64>],
    ) -> View {
        self.remove_flat_peaks(&mut value, &mut standard, discretisation.as_mut());
        let state =
            |s: usize| {
                let error = |errors: &Numbers| self.state(s, errors, vec![0.0; specular[s].len()]);
                State {
                    value: self.state(s, &value, specular[s].clone()),
                    standard_error: error(&standard),
                    discretisation_error: discretisation.as_ref().map(error),
                    interpolation_error: self
                        .interpolation_error(s, &value.linear)
                        .map(|[X, Y, Z]| XyzError { X, Y, Z }),
                }
            };
        let reader = Reader::of(&self.setup.scene);
        let text = value.scalars.together.text_luminance_cd_m2;
        View {
            theta_deg: at.theta_deg,
            phi_deg: at.phi_deg,
            states: self.by_name(state),
            metrics: value.scalars.together,
            visibility_level_in_range: text.map(|luminance| reader.is_visibility_in_range(luminance)),
            contrast_margin_in_range: text.map(|luminance| reader.is_margin_in_range(luminance)),
            standard_error: standard.scalars.together,
            discretisation_error: discretisation.as_ref().map(|errors| errors.scalars.together),
            ledger: self.by_name(|s| self.ledger(s, &value, &standard, discretisation.as_ref())),
        }
    }

    /// Removes the peaks of flat spectra, and all metrics that depend on them.
    fn remove_flat_peaks(
        &self,
        value: &mut Numbers,
        standard: &mut Numbers,
        mut discretisation: Option<&mut Numbers>,
    ) {
        let errors = discretisation.as_deref().unwrap_or(standard);
        let flat: Vec<usize> = (0..self.layout.states).filter(|s| self.is_flat(*s, value, errors)).collect();
        for numbers in [Some(value), Some(standard), discretisation.take()].into_iter().flatten() {
            for &s in &flat {
                numbers.scalars.states[s].peak_nm = None;
                numbers.scalars.states[s].metrics.peak_shift_nm = None;
            }
            if flat.iter().any(|s| PRIMARIES.contains(&self.setup.states[*s].as_str())) {
                numbers.scalars.together.average_peak_shift_nm = None;
            }
        }
    }

    fn by_name<T>(&self, one: impl Fn(usize) -> T) -> Named<T> {
        Named(self.setup.states.iter().enumerate().map(|(s, name)| (name.clone(), one(s))).collect())
    }

    /// Returns true if a spectrum is flat within its errors.
    fn is_flat(&self, state: usize, value: &Numbers, errors: &Numbers) -> bool {
        let [Some(factor), Some(error)] =
            [value, errors].map(|numbers| self.reflectance_factor(state, &numbers.linear.0))
        else {
            return true;
        };
        let (mut least, mut most, mut noise) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
        for (bin, (factor, error)) in factor.into_iter().zip(error).enumerate() {
            if (400.0..=700.0).contains(&self.grid.wavelength_nm(bin)) {
                (least, most, noise) = (least.min(factor), most.max(factor), noise.max(error));
            }
        }
        most - least < FLAT * noise
    }

    fn state(&self, state: usize, numbers: &Numbers, specular: Vec<f64>) -> StateValues {
        let linear = &numbers.linear.0;
        let scalars: &Scalars = &numbers.scalars.states[state];
        let terms = &linear[self.layout.terms(state)];
        let lighting = &self.setup.scene.lighting;
        let (directed, environments) = (lighting.directed.len(), lighting.environment.len());
        let alone = |light: usize| {
            let is_lit = self.luminous[light] > 0.0;
            is_lit.then(|| linear[self.layout.alone(state)][light])
        };
        let spectrum = |light: usize| {
            let is_lit = self.luminous[light] > 0.0;
            is_lit.then(|| linear[self.layout.spectrum_alone(state, light)].to_vec())
        };
        StateValues {
            radiance: linear[self.layout.radiance(state)].to_vec(),
            reflectance_factor: self.reflectance_factor(state, linear),
            R_hemi: alone(0),
            R_dir: (1..=directed).map(alone).collect(),
            R_environment: (1 + directed..1 + directed + environments).map(alone).collect(),
            by_light: self.layout.by_light.then(|| SpectraByLight {
                R_hemi: spectrum(0),
                R_dir: (1..=directed).map(spectrum).collect(),
                R_environment: (1 + directed..1 + directed + environments).map(spectrum).collect(),
            }),
            terms: Terms {
                diffuse: terms[0],
                directed: terms[1..][..directed].to_vec(),
                environment: terms[1 + directed..][..environments].to_vec(),
                front_light: terms.get(1 + directed + environments).copied(),
                front_reflection: linear[self.layout.front_term(state)],
            },
            specular,
            ..StateValues::of_scalars(scalars)
        }
    }

    fn ledger(
        &self,
        state: usize,
        value: &Numbers,
        standard: &Numbers,
        discretisation: Option<&Numbers>,
    ) -> Ledger {
        let parts = |numbers: &Numbers| ledger_parts(&numbers.linear.0[self.layout.ledger(state)]);
        let LedgerError { returned, absorbed, unaccounted } = parts(value);
        let (standard_error, discretisation_error) = (parts(standard), discretisation.map(parts));
        Ledger { returned, absorbed, unaccounted, standard_error, discretisation_error }
    }
}

impl StateValues {
    /// Converts the scalar metrics; all quantities that are linear in light are left empty.
    pub(crate) fn of_scalars(scalars: &Scalars) -> Self {
        let [x, y, z] = scalars.xyz.map(Option::unwrap_or_default);
        Self {
            radiance: Vec::new(),
            reflectance_factor: None,
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
            hue_rgb: three(scalars.hue_rgb),
            metrics: scalars.metrics,
            cam16: scalars.cam16,
            R_hemi: None,
            R_dir: Vec::new(),
            R_environment: Vec::new(),
            by_light: None,
            terms: Terms {
                diffuse: 0.0,
                directed: Vec::new(),
                environment: Vec::new(),
                front_light: None,
                front_reflection: 0.0,
            },
            specular: Vec::new(),
        }
    }
}

/// Converts the energy balance of a sample, or its errors, to the parts of a ledger.
fn ledger_parts(fractions: &[f64]) -> LedgerError {
    let absorbed = Absorbed {
        front: fractions[1],
        diffuser: fractions[2],
        glass: fractions[3],
        pixel: fractions[4],
        inactive: fractions[5],
    };
    LedgerError { returned: fractions[0], absorbed, unaccounted: fractions[6] }
}
