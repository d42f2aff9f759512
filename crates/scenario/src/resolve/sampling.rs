//! Tests of the wavelength grid: whether it is fine enough for a light, and for a reflectance.
//!
//! A light is sampled at the wavelengths of the grid and is linear between them, so that
//! lines narrower than the step are lost or too strong. The test compares colour (u', v')
//! and luminous efficacy (lm/W), which do not depend on the level of the light, with those
//! of the light itself: its means over 1 nm, weighted according to the linear interpolation
//! of the observer, from samples 0.1 nm apart.
//!
//! A light that fails the test is represented by its means over 1 nm ([`LightSpectrum`]).
//!
//! A reflectance, too, is known at the wavelengths of the grid and linear between them. Its test is the error
//! of X, Y and Z in the light of the scenario ([`Judge`]).

use papilio_colour::{LUMENS_PER_WATT, Observer, UvPrime};
use papilio_display::scene::Scene;
use papilio_spectra::{EveryNm, Grid, LightSpectrum, SpectraError, Spectrum, Tabulated};

use super::Resolver;

/// Largest distance in u'v' without a warning: a quarter of a just noticeable difference, 0.5 % of X/Y or Z/Y
/// near white.
const COLOUR: f64 = 0.001;
/// Largest relative difference of the luminous efficacy without a warning. Linear interpolation over 5 nm
/// causes 0.7 % for light at 430 or 665 nm, however smooth, because ybar is curved there.
const EFFICACY: f64 = 0.01;
/// Largest error of X, Y and Z because of a reflectance, relative to a perfect white, without a warning: the
/// default relative error.
pub(super) const NEGLIGIBLE_ERROR: f64 = 1e-3;
/// Steps that may be recommended, nm. Colours are sums over integer nanometres, so that a finer step has no
/// effect.
const STEPS_NM: [f64; 6] = [20.0, 10.0, 5.0, 2.5, 2.0, 1.0];
/// Samples of the light itself per nanometre.
const PER_NM: usize = 10;

/// Colour and luminous efficacy of a light, which do not depend on its level.
#[derive(Clone, Copy)]
pub(super) struct ColourAndEfficacy {
    colour: UvPrime,
    lm_per_w: f64,
}

impl ColourAndEfficacy {
    /// Computes both from values at every nanometre; `None` without light.
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

/// A light that the grid does not represent.
pub(super) struct Loss {
    /// The light on the grid; `None` if it is dark there.
    pub(super) on_grid: Option<ColourAndEfficacy>,
    /// The light itself; `None` if its lines are too narrow for samples 0.1 nm apart.
    pub(super) itself: Option<ColourAndEfficacy>,
}

/// Returns the loss of `light` on `grid`; `None` if it is negligible.
pub(super) fn loss(light: impl Fn(&Grid) -> Result<Spectrum, SpectraError>, grid: &Grid) -> Option<Loss> {
    let (first, last) = (grid.start_nm().max(380.0).ceil(), grid.stop_nm().min(780.0).floor());
    let every_nm = Grid::new(first, last, 1.0).ok()?;
    let finer = light(&Grid::new(first, last, 1.0 / PER_NM as f64).ok()?).ok()?;
    let sampled = Tabulated::new(grid.wavelengths_nm(), light(grid).ok()?.to_vec()).ok()?;
    let observer = Observer::new(&every_nm).ok()?;
    let seen = |spectrum: &[f64]| ColourAndEfficacy::of(spectrum, &observer);

    let (on_grid, itself) = (seen(&sampled.on(&every_nm).ok()?), seen(&means(&finer, PER_NM)));
    let is_near = on_grid.zip(itself).is_some_and(|(a, b)| a.is_near(b));
    (!is_near).then_some(Loss { on_grid, itself })
}

/// Computes means over 1 nm with triangular weights, from `per_nm` samples per nm.
pub(super) fn means(finer: &[f64], per_nm: usize) -> Vec<f64> {
    let reach = per_nm as i64;
    let mean = |centre: usize| {
        let (mut sum, mut weights) = (0.0, 0.0);
        for offset in 1 - reach..reach {
            // There are no samples beyond the ends of the grid.
            if let Some(value) = centre.checked_add_signed(offset as isize).and_then(|i| finer.get(i)) {
                let weight = (reach - offset.abs()) as f64;
                sum += weight * value;
                weights += weight;
            }
        }
        sum / weights
    };
    (0..finer.len()).step_by(per_nm).map(mean).collect()
}

/// Weights of reflectances in X, Y and Z, relative to a perfect white, in the light of a scenario.
pub(super) struct Judge {
    grid: Grid,
    /// Integer wavelengths that are seen, nm.
    seen: Grid,
    /// At each of them.
    weights: [Vec<f64>; 3],
}

impl Judge {
    /// `None` if no light is visible.
    pub(super) fn new(scene: &Scene) -> Option<Self> {
        let (grid, lighting) = (scene.grid, &scene.lighting);
        let (first, last) = (grid.start_nm().ceil().max(380.0), grid.stop_nm().floor().min(780.0));
        let seen = Grid::new(first, last, 1.0).ok()?;
        let (luminous, observer) =
            (Observer::new(&seen).ok()?, Observer::of(scene.metrics.observer, &seen).ok()?);
        // X, Y and Z of this illuminance, at each wavelength.
        let add = |sums: &mut [Vec<f64>; 3], light: &LightSpectrum, lux: f64| -> Option<()> {
            let (grid, values) =
                light.every_nm().map_or((&grid, &**light), |EveryNm { grid, values }| (grid, values));
            let values = Tabulated::new(grid.wavelengths_nm(), values.to_vec()).ok()?.on(&seen).ok()?;
            let scale = lux / luminous.luminance(&values);
            for (sums, bar) in sums.iter_mut().zip(observer.weights()) {
                for ((sum, bar), value) in sums.iter_mut().zip(bar).zip(values.iter()).filter(|_| lux > 0.0) {
                    *sum += scale * bar * value;
                }
            }
            Some(())
        };
        let mut weights = [(); 3].map(|()| vec![0.0; seen.len()]);
        let lux = lighting.illuminance_lx;
        add(&mut weights, &lighting.diffuse_spectrum, lux * lighting.diffuse)?;
        for lamp in &lighting.directed {
            let cosine = if lamp.normal_to_beam { lamp.theta_deg.to_radians().cos() } else { 1.0 };
            add(&mut weights, &lamp.spectrum, lux * lamp.share * cosine)?;
        }
        for part in lighting.environment.iter().flat_map(|environment| &environment.parts) {
            add(&mut weights, &part.spectrum, lux * part.share)?;
        }
        // A front light adds to the ambient light, of which the white is.
        let mut white: f64 = weights[1].iter().sum();
        if let Some(guide) = &lighting.front_light {
            add(&mut weights, &guide.spectrum, guide.illuminance_lx)?;
            white = if white > 0.0 { white } else { weights[1].iter().sum() };
        }
        (white > 0.0).then(|| {
            weights.iter_mut().flatten().for_each(|weight| *weight /= white);
            Self { grid, seen, weights }
        })
    }

    /// Changes of X, Y and Z, relative to a perfect white, if this reflectance (a function of the wavelength, nm) is known only in
    /// steps of `step_nm` (at least 1) and linear between them. Each step is divided into `parts`.
    pub(super) fn changes(
        &self,
        step_nm: f64,
        parts: usize,
        reflectance: impl Fn(f64) -> Option<f64>,
    ) -> Option<[f64; 3]> {
        let step_nm = step_nm.max(1.0);
        let (first, last) = (self.seen.start_nm(), self.seen.stop_nm());
        // The first wavelength of such a grid that is seen.
        let first = first + (self.grid.start_nm() - first).rem_euclid(step_nm);
        let mut off = [0.0; 3];
        let mut from = (first, reflectance(first)?);
        while from.0 + step_nm <= last + 1e-6 {
            let to_nm = from.0 + step_nm;
            let to = (to_nm, reflectance(to_nm)?);
            for part in 0..parts {
                let share = (part as f64 + 0.5) / parts as f64;
                let nm = from.0 + share * step_nm;
                let missed = (1.0 - share) * from.1 + share * to.1 - reflectance(nm)?;
                let nearest = ((nm - self.seen.start_nm()).round() as usize).min(self.seen.len() - 1);
                for (off, weights) in off.iter_mut().zip(&self.weights) {
                    *off += weights[nearest] * missed * step_nm / parts as f64;
                }
            }
            from = to;
        }
        Some(off).filter(|changes| changes.iter().all(|change| change.is_finite()))
    }

    /// The largest usual step below that of the grid at which this error is negligible; `None` if there is none.
    pub(super) fn fine_step(&self, error: impl Fn(f64) -> Option<f64>) -> Option<f64> {
        let grid = &self.grid;
        let is_grid = |step: &f64| Grid::new(grid.start_nm(), grid.stop_nm(), *step).is_ok();
        let finer = STEPS_NM.into_iter().filter(|step| *step < grid.step_nm()).filter(is_grid);
        finer.into_iter().find(|step| error(*step).is_some_and(|error| error <= NEGLIGIBLE_ERROR))
    }

    /// Errors of a table of reflectances or transmittances, in steps of `step_nm`.
    pub(super) fn errors_of_table(&self, table: &Tabulated, step_nm: f64) -> Option<[f64; 3]> {
        let parts = (step_nm.max(1.0) * PER_NM as f64).ceil() as usize;
        // A table may end a little before the grid.
        let (first, last) = table.range_nm();
        let changes = self.changes(step_nm, parts, |nm| table.at(nm.clamp(first, last)).ok())?;
        Some(changes.map(f64::abs))
    }

    /// Largest of them.
    pub(super) fn error_of_table(&self, table: &Tabulated, step_nm: f64) -> Option<f64> {
        self.errors_of_table(table, step_nm).map(largest)
    }
}

/// Returns the largest of the errors of X, Y and Z.
pub(super) fn largest(errors: [f64; 3]) -> f64 {
    errors.into_iter().fold(0.0, f64::max)
}

/// Returns whether the grid has all points of a table, between which the table is linear itself.
pub(super) fn has_all_points(grid: &Grid, table: &Tabulated) -> bool {
    let is_point = |nm: f64| ((nm - grid.start_nm()) / grid.step_nm()).fract() == 0.0;
    table.wavelengths_nm().iter().all(|nm| is_point(*nm))
}

impl Resolver<'_> {
    /// Warns of the tables of reflectances and transmittances that are not linear between the wavelengths of the grid; of several
    /// columns of a file, of the one with the largest error. Returns whether there is a warning.
    pub(super) fn warn_of_tables(&mut self, judge: &Judge) -> bool {
        let step_nm = judge.grid.step_nm();
        let mut worst: Vec<(&str, &Tabulated, f64)> = Vec::new();
        for (name, table) in &self.tables {
            let Some(error) = judge.error_of_table(table, step_nm).filter(|error| *error > NEGLIGIBLE_ERROR)
            else {
                continue;
            };
            match worst.iter_mut().find(|(other, ..)| other == name) {
                None => worst.push((name, table, error)),
                Some(known) if known.2 < error => *known = (name, table, error),
                Some(_) => {}
            }
        }
        let warning = |(name, table, error): (&str, &Tabulated, f64)| {
            let remedy = match judge.fine_step(|step| judge.error_of_table(table, step)) {
                Some(step) => format!("set spectrum.step_nm = {step}"),
                None => "no step is fine enough: state its means over 1 nm".to_owned(),
            };
            format!(
                "{name}: the values change too fast for spectrum.step_nm = {step_nm}: in the light of the scenario, the error of X, Y or Z is \
                 {error:.4} relative to a perfect white; {remedy}"
            )
        };
        let warnings: Vec<String> = worst.into_iter().map(warning).collect();
        let is_any = !warnings.is_empty();
        self.warnings.extend(warnings);
        is_any
    }
}
