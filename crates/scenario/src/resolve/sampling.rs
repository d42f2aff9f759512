//! Whether the wavelength grid is fine enough for a light.
//!
//! A light is sampled at the wavelengths of the grid and runs linearly between them, so
//! lines narrower than the step are lost or swell. How much that matters is seen by
//! comparing colour (u', v') and luminous efficacy (lm/W), which do not depend on the
//! light's amount, with those of the light itself: its means over 1 nm, weighted as
//! linear interpolation of the observer weights them, from samples .1 nm apart.

use papilio_colour::{LUMENS_PER_WATT, Observer, UvPrime};
use papilio_spectra::{Grid, SpectraError, Spectrum, Tabulated};

/// Distance in u'v' that passes: a quarter of what an eye can tell, .5 % of X/Y or Z/Y near white.
const COLOUR: f64 = 0.001;
/// Relative difference of the luminous efficacy that passes. Running linearly over 5 nm makes
/// .7 % of light at 430 or 665 nm, however smooth, for ybar is curved there.
const EFFICACY: f64 = 0.01;
/// Samples per nanometre of the light itself.
const PER_NM: usize = 10;

/// What the eye makes of a light, whatever its amount.
#[derive(Clone, Copy)]
struct ColourAndEfficacy {
    colour: UvPrime,
    lm_per_w: f64,
}

impl ColourAndEfficacy {
    /// From values at every nanometre; `None` in the dark.
    fn of(spectrum: &[f64], observer: &Observer) -> Option<Self> {
        let xyz = observer.xyz(spectrum);
        let lm_per_w = LUMENS_PER_WATT * xyz.y / spectrum.iter().sum::<f64>();
        Some(Self { colour: xyz.uv_prime()?, lm_per_w })
    }

    fn is_near(self, other: Self) -> bool {
        let efficacy = self.lm_per_w / other.lm_per_w - 1.0;
        self.colour.distance(other.colour) <= COLOUR && efficacy.abs() <= EFFICACY
    }
}

impl std::fmt::Display for ColourAndEfficacy {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let UvPrime { u, v } = self.colour;
        write!(f, "u' {u:.4}, v' {v:.4} and {:.1} lm/W", self.lm_per_w)
    }
}

/// What is lost of `light` on `grid`, in words; `None` if nothing that matters.
pub(super) fn loss(light: impl Fn(&Grid) -> Result<Spectrum, SpectraError>, grid: &Grid) -> Option<String> {
    let (first, last) = (grid.start_nm().max(380.0).ceil(), grid.stop_nm().min(780.0).floor());
    let every_nm = Grid::new(first, last, 1.0).ok()?;
    let finer = light(&Grid::new(first, last, 1.0 / PER_NM as f64).ok()?).ok()?;
    let sampled = Tabulated::new(grid.wavelengths_nm(), light(grid).ok()?.to_vec()).ok()?;
    let observer = Observer::new(&every_nm).ok()?;
    let seen = |spectrum: &[f64]| ColourAndEfficacy::of(spectrum, &observer);

    let (here, itself) = (seen(&sampled.on(&every_nm).ok()?)?, seen(&means(&finer))?);
    if here.is_near(itself) {
        return None;
    }
    let at_1_nm: Vec<f64> = finer.iter().step_by(PER_NM).copied().collect();
    let advice = if seen(&at_1_nm)?.is_near(itself) {
        "set spectrum.step_nm = 1"
    } else {
        "its lines are narrower than 1 nm: give its means over 1 nm, and set spectrum.step_nm = 1"
    };
    Some(format!(
        "changes faster than a step of {} nm can follow: {here} on the grid, {itself} without it; {advice}",
        grid.step_nm()
    ))
}

/// Means over 1 nm, falling off linearly to either side, from `PER_NM` samples per nm.
fn means(finer: &[f64]) -> Vec<f64> {
    let reach = PER_NM as i64;
    let mean = |centre: usize| {
        let (mut sum, mut weights) = (0.0, 0.0);
        for offset in 1 - reach..reach {
            // Beyond the ends of the grid there is nothing.
            if let Some(value) = centre.checked_add_signed(offset as isize).and_then(|i| finer.get(i)) {
                let weight = (reach - offset.abs()) as f64;
                sum += weight * value;
                weights += weight;
            }
        }
        sum / weights
    };
    (0..finer.len()).step_by(PER_NM).map(mean).collect()
}
