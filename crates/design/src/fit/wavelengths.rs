//! Wavelengths of the predicted spectra.
//!
//! A meter whose wavelengths are wrong measures light from beyond the range of the scenario at the ends of its spectra.
//! They are therefore computed over a range that the bounds of `meter.wavelength_offset_nm` widen, as far as the data of the
//! scenario's materials and light reach. So the numbers of a fit do not depend on whether, and how far, the offset varies, and
//! its BIC can be compared with that of a fit without it.
//!
//! A reflectance factor does not depend on the spectrum of the light, if all sources have the same one: where the table of a light
//! ends (most end at 380 and 780 nm), the light of these spectra is one of equal energy.

use papilio_display::compare::{Measurement, Quantity, Simulated};
use papilio_display::scene::Lighting;
use papilio_scenario::{Fit, FitTarget, ParameterisedScenario};
use papilio_spectra::Grid;
use serde_json::{Value as Json, json};

/// Wavelengths of a fit.
#[derive(Debug, Clone)]
pub(super) struct Wavelengths {
    /// Those of the scenario: of colours, of metrics, and of the measured numbers that are used.
    pub(super) own: Grid,
    /// Those of the predicted spectra.
    pub(super) of_spectra: Grid,
    /// Smallest and largest offset, nm.
    pub(super) offsets_nm: [f64; 2],
}

impl Wavelengths {
    /// Wavelengths of a fit, with the scenario of the spectra if it is another one. `own` are the values of its paths, which
    /// have this light.
    pub(super) fn of(
        spec: &Fit,
        (own, light): (&[Json], &Lighting),
        simulated: &Simulated,
        measurement: &Measurement,
    ) -> (Self, Option<ParameterisedScenario>) {
        let offset = spec.variables.iter().find(|one| one.target == FitTarget::WavelengthOffset);
        let offsets_nm = offset.map_or([0.0; 2], |one| [one.bounds[0].min(0.0), one.bounds[1].max(0.0)]);
        let grid = simulated.grid;
        let plain = Self { own: grid, of_spectra: grid, offsets_nm };
        let wanted = plain.missing_steps(measurement);
        let reaches = |steps: [usize; 2]| {
            let widened = plain.widened(steps)?;
            let range = ("spectrum.range_nm", json!([widened.start_nm(), widened.stop_nm()]));
            let other = spec.varied.with_values(std::slice::from_ref(&range));
            let in_white = has_one_spectrum(light)
                .then(|| spec.varied.with_values(&[range, ("lighting.spectrum", json!("E"))]));
            let is_possible = |other: &ParameterisedScenario| {
                other.scenario(own).and_then(|scenario| scenario.resolve()).is_ok()
            };
            Some((widened, std::iter::once(other).chain(in_white).find(is_possible)?))
        };
        let both = reaches(wanted).or_else(|| {
            let [below, above] = wanted;
            reaches([
                most(below, |steps| reaches([steps, 0]).is_some()),
                most(above, |steps| reaches([0, steps]).is_some()),
            ])
        });
        match both {
            Some((of_spectra, other)) if of_spectra != grid => (Self { of_spectra, ..plain }, Some(other)),
            _ => (plain, None),
        }
    }

    /// Steps that are missing below and above: one more than the offsets need, so that every wavelength is between two others.
    fn missing_steps(&self, measurement: &Measurement) -> [usize; 2] {
        let spectra = measurement.states.iter().filter_map(|one| match &one.quantity {
            Quantity::Spectrum(spectrum) => Some(spectrum.wavelengths_nm()),
            _ => None,
        });
        let used: Vec<f64> = spectra.flatten().copied().filter(|nm| self.is_own(*nm)).collect();
        let [below, above] = self.offsets_nm;
        let is_beyond =
            [used.iter().any(|nm| !self.is_own(nm + below)), used.iter().any(|nm| !self.is_own(nm + above))];
        let steps = |offset: f64| (offset.abs() / self.own.step_nm() - 1e-9).ceil() as usize + 1;
        [0, 1].map(|side| if is_beyond[side] { steps(self.offsets_nm[side]) } else { 0 })
    }

    fn widened(&self, [below, above]: [usize; 2]) -> Option<Grid> {
        let step = self.own.step_nm();
        let from = self.own.start_nm() - below as f64 * step;
        Grid::new(from, self.own.stop_nm() + above as f64 * step, step).ok().filter(|_| from > 0.0)
    }

    /// Whether a wavelength is one of the scenario's range.
    pub(super) fn is_own(&self, nm: f64) -> bool {
        (self.own.start_nm()..=self.own.stop_nm()).contains(&nm)
    }

    /// Whether spectra are predicted at a measured wavelength, whatever the offset.
    pub(super) fn is_predicted(&self, nm: f64) -> bool {
        let range = self.of_spectra.start_nm()..=self.of_spectra.stop_nm();
        self.offsets_nm.iter().all(|offset| range.contains(&(nm + offset)))
    }
}

/// Whether all light has the same spectrum.
fn has_one_spectrum(light: &Lighting) -> bool {
    let mut spectra = light.directed.iter().map(|one| &one.spectrum);
    light.front_light.is_none()
        && light.environment.is_empty()
        && spectra.all(|spectrum| *spectrum == light.diffuse_spectrum)
}

/// The largest number up to `wanted` that is possible, if all smaller ones are.
fn most(wanted: usize, is_possible: impl Fn(usize) -> bool) -> usize {
    let (mut possible, mut impossible) = (0, wanted + 1);
    while impossible - possible > 1 {
        let middle = (possible + impossible) / 2;
        if is_possible(middle) {
            possible = middle;
        } else {
            impossible = middle;
        }
    }
    possible
}

#[cfg(test)]
mod tests {
    use super::most;

    #[test]
    fn largest_possible_number_is_found() {
        for (wanted, limit, found) in [(5, 3, 3), (5, 5, 5), (5, 9, 5), (5, 0, 0), (0, 4, 0)] {
            assert_eq!(most(wanted, |one| one <= limit), found);
        }
    }
}
