//! Measurement: from the estimates of a solver to metrics with errors.
//!
//! All quantities that are linear in light are collected in a [`Sample`]. Colours and other metrics
//! ([`ViewScalars`]) are computed last, from samples. The source of the errors depends on the solver:
//! `replicates` (Monte Carlo) or `levels` (adding). `view` assembles values and errors into results.

mod angle;
mod colours;
mod front_light;
mod levels;
mod lines;
mod metrics;
mod replicates;
mod sample;
mod slopes;
mod sums;
mod view;

use std::borrow::Cow;
use std::f64::consts::PI;
use std::ops::Range;

use papilio_colour::{LUMENS_PER_WATT, Standard, Xyz, peak_nm};
use papilio_spectra::{Grid, StateSpectra, sum_of_products};
use papilio_transport::{Base, Estimate, ReflectanceFactor};

use crate::readability::Reader;
use crate::result::{Illuminant, ReferenceWhite};
use crate::setup::{Light, LineWeights, Setup, ViewPoint};
pub(crate) use angle::{ViewSamples, against_angle};
use front_light::BelowFront;
use lines::Corrections;
pub(crate) use metrics::{PRIMARIES, ViewScalars, jackknife};
use metrics::{Reference, StateObservation};
pub(crate) use replicates::LeastErrors;
use sample::Layout;
pub(crate) use sample::{Sample, relative, spread};
pub(crate) use slopes::{Number, Slopes};
pub(crate) use sums::{STANDARD_ERRORS, SampleOfSums};

/// Converts estimates to samples, and samples to results.
pub(crate) struct Meter<'a> {
    setup: &'a Setup,
    grid: Grid,
    layout: Layout,
    /// Spectral radiance of the perfect white, and its X, Y, Z in W/(m2 sr), in the ambient light, or in that
    /// of the front light if there is no ambient light.
    white: Vec<f64>,
    white_xyz: Xyz,
    /// The lights of the perfect white, by number.
    white_lights: Range<usize>,
    /// Weights of each light.
    lights: Vec<Weights>,
    /// The front light, which is the last light, if there is one.
    below_front: Option<BelowFront>,
    /// Whether the front light is the only light.
    is_self_lit: bool,
    /// Y of the perfect white in each contribution of a result, which may combine several lights.
    luminous: Vec<f64>,
}

/// Light that reaches the pixel.
#[derive(Debug, Clone)]
pub(crate) struct PixelLight {
    /// Number of the light of which it is a part.
    pub(crate) light: usize,
    /// Source, above the front, whose reflectance factor via the pixel it has.
    pub(crate) source: usize,
    /// Weights of that reflectance factor over wavelength in X, Y and Z.
    pub(crate) weights: [Vec<f64>; 3],
}

impl PixelLight {
    /// True if it contributes to Y.
    pub(crate) fn is_seen(&self) -> bool {
        self.weights[1].iter().any(|weight| *weight != 0.0)
    }
}

/// Weights by which a reflectance factor under one light contributes to the observed quantities.
struct Weights {
    /// Radiance: that of the perfect white, `[wavelength]`.
    radiance: Vec<f64>,
    /// X, Y and Z, `[wavelength]`.
    xyz: [Vec<f64>; 3],
    /// Reflectance factor weighted by illuminance: fraction of the illuminance.
    share: f64,
    /// Number of the contribution to Y to which the light belongs.
    term: usize,
    /// Fraction of the light of that contribution, `[wavelength]`; empty unless spectra by light are
    /// reported.
    within: Vec<f64>,
    /// Corrections of X, Y, Z and luminance if the light has narrow lines.
    corrections: Option<Corrections>,
    /// X, Y and Z from the light at every nanometre, `[wavelength]`, relative to Y of the perfect white in such light.
    every_nm: [Vec<f64>; 3],
    /// X, Y and Z of reflectances at every nanometre, in the same unit, if the display changes within a step.
    at_each_nm: Option<[Vec<f64>; 3]>,
}

impl<'a> Meter<'a> {
    pub(crate) fn new(setup: &'a Setup) -> Self {
        let grid = setup.scene.grid;
        let mut white = vec![0.0; grid.len()];
        let below_front = BelowFront::new(&setup.scene, &setup.stack);
        // The reference white is lit by the ambient light only, if there is any.
        let (room, guide) = setup.lights.split_at(setup.lights.len() - usize::from(below_front.is_some()));
        let is_self_lit = !guide.is_empty() && room.iter().all(|light| light.illuminance_lx == 0.0);
        let reference = if is_self_lit { guide } else { room };
        let white_lights = if is_self_lit { room.len()..setup.lights.len() } else { 0..room.len() };
        for light in reference {
            white.iter_mut().zip(light.irradiance.iter()).for_each(|(l, e)| *l += e / PI);
        }
        let terms = setup.lights.last().map_or(0, |light| light.term + 1);
        let by_light = setup.scene.metrics.spectra_by_light;
        let has_lines = setup.lights.iter().any(|light| light.lines.is_some());
        let corrections = if has_lines { lines::QUANTITIES } else { 0 };
        // X, Y and Z are sums over integer wavelengths: a finer step changes nothing.
        let every_nm = grid.step_nm() > 1.0;
        let states = setup.states.len();
        let within_step = setup.scene.within_step.as_ref().map_or(0, |within| within.estimates());
        let layout = Layout { states, bins: grid.len(), terms, by_light, corrections, every_nm, within_step };
        let mut white_xyz = setup.seen_by().xyz(&white);
        for corrections in reference.iter().filter_map(|light| Corrections::new(setup, light)) {
            let [x, y, z, ..] = corrections.of(std::iter::repeat_n(1.0, grid.len()));
            white_xyz = white_xyz + Xyz { x, y, z };
        }
        let total: f64 = reference.iter().map(|light| light.illuminance_lx).sum();
        // A light that is known only on the grid is the same at every nanometre.
        let at_every_nm = |light: &Light| -> [Vec<f64>; 3] {
            let on_grid =
                |bar: &[f64]| light.irradiance.iter().zip(bar).map(|(e, bar)| e * bar).collect::<Vec<f64>>();
            light.every_nm.clone().unwrap_or_else(|| setup.seen_by().weights().map(on_grid))
        };
        let white_at_every_nm: f64 =
            reference.iter().map(|light| at_every_nm(light)[1].iter().sum::<f64>()).sum();
        let weights = |light: &Light| {
            let radiance: Vec<f64> = light.irradiance.iter().map(|e| e / PI).collect();
            let over_white =
                |bar: &[f64]| radiance.iter().zip(bar).map(|(l, bar)| l * bar / white_xyz.y).collect();
            let of_lines = |own: &Vec<f64>| own.iter().map(|own| own / PI / white_xyz.y).collect();
            let xyz: [Vec<f64>; 3] = match &light.lines {
                Some(lines) => lines.xyz.each_ref().map(of_lines),
                None => setup.seen_by().weights().map(over_white),
            };
            let within = if by_light { within(setup, light) } else { Vec::new() };
            let every_nm =
                at_every_nm(light).map(|own| own.iter().map(|own| own / white_at_every_nm).collect());
            let (share, corrections) = (light.illuminance_lx / total, Corrections::new(setup, light));
            let relative = |own: &Vec<f64>| own.iter().map(|own| own / white_at_every_nm).collect();
            let at_each_nm = light.at_each_nm.as_ref().map(|own| own.each_ref().map(relative));
            Weights { xyz, radiance, share, term: light.term, within, corrections, every_nm, at_each_nm }
        };
        let lights: Vec<Weights> = setup.lights.iter().map(weights).collect();
        let mut luminous = vec![0.0; terms];
        lights.iter().for_each(|light| luminous[light.term] += light.xyz[1].iter().sum::<f64>());
        Self {
            setup,
            grid,
            layout,
            white,
            white_xyz,
            white_lights,
            lights,
            below_front,
            is_self_lit,
            luminous,
        }
    }

    /// Returns the lights that reach the pixel, one for each source in order. What a front light leaks
    /// upwards and the front sends back is another one, diffuse, at last.
    pub(crate) fn pixel_lights(&self) -> Vec<PixelLight> {
        let last = self.lights.len() - 1;
        let mut all: Vec<PixelLight> = Vec::with_capacity(last + 2);
        let mut leaking = None;
        for (light, Weights { xyz, .. }) in self.lights.iter().enumerate() {
            let mut weights = xyz.clone();
            if let Some(guide) = self.below_front.as_ref().filter(|_| light == last) {
                let [x, y, z] = xyz.each_ref().map(|xyz| guide.weights(xyz));
                let [of_it, of_diffuse] = [0, 1].map(|k| [&x[k], &y[k], &z[k]].map(Clone::clone));
                weights = of_it;
                if guide.is_diffuse() {
                    let pairs = weights.iter_mut().flatten().zip(of_diffuse.iter().flatten());
                    pairs.for_each(|(weight, more)| *weight += more);
                } else if of_diffuse[1].iter().any(|weight| *weight != 0.0) {
                    leaking = Some(PixelLight { light, source: 0, weights: of_diffuse });
                }
            }
            all.push(PixelLight { light, source: light, weights });
        }
        all.extend(leaking);
        all
    }

    /// Weights of the reflectance factor under a light over wavelength, in X, Y and Z.
    pub(crate) fn weights(&self, light: usize) -> &[Vec<f64>; 3] {
        &self.lights[light].xyz
    }

    /// Returns X, Y and Z of what is seen without the pixel, from the reflectance factors under all lights.
    pub(crate) fn without_pixel(&self, all: &[ReflectanceFactor]) -> [f64; 3] {
        let mut sums = [0.0; 3];
        for (light, rho) in self.lights.iter().zip(self.seen_of(all)) {
            for (sum, weights) in sums.iter_mut().zip(&light.xyz) {
                *sum += sum_of_products(&rho.front, weights);
            }
        }
        sums
    }

    /// Luminance of Y = 1, cd/m2.
    pub(crate) fn luminance_of_white(&self) -> f64 {
        self.setup.observer.luminance(&self.white)
    }

    /// Returns the weights of ybar at each wavelength, nm.
    fn y_bar(&self) -> &[f64] {
        self.setup.seen_by().weights()[1]
    }

    /// Computes Y of a state of a sample, W/(m2 sr).
    fn luminous(&self, state: usize, sample: &Sample) -> f64 {
        let on_grid = sum_of_products(&sample.0[self.layout.radiance(state)], self.y_bar());
        self.corrections(state, sample).map_or(on_grid, |[_, y, ..]| on_grid + y)
    }

    /// Returns the corrections of a state for lights with narrow lines; `None` without such lights.
    fn corrections(&self, state: usize, sample: &Sample) -> Option<[f64; lines::QUANTITIES]> {
        <[f64; lines::QUANTITIES]>::try_from(&sample.0[self.layout.corrections(state)]).ok()
    }

    /// Estimates the errors of X, Y and Z of a state because lights and reflectances are known only at the wavelengths of
    /// the grid: the differences from those in the lights at every nanometre, and what reflectances change within a step; `None` if the step is
    /// 1 nm or less.
    fn interpolation_error(&self, state: usize, sample: &Sample) -> Option<[f64; 3]> {
        let at_every_nm = <[f64; 3]>::try_from(&sample.0[self.layout.every_nm(state)]).ok()?;
        let on_grid = over(self.xyz(state, sample), self.white_xyz.y).to_array();
        let within = self.setup.scene.unresolved.get(state).copied().unwrap_or_default();
        let tables = sample.0[self.layout.within_step(state)].chunks_exact(3);
        let of_tables = |k: usize| tables.clone().map(|xyz| xyz[k].abs()).fold(0.0, f64::max);
        Some(std::array::from_fn(|k| (at_every_nm[k] - on_grid[k]).abs() + within[k] + of_tables(k)))
    }

    /// Returns the weights over wavelength of a reflectance factor under each light in X, Y and Z, and in the
    /// luminance if another observer sees the colours: `[light][quantity][wavelength]`. `None` if there is
    /// more to it: narrow lines, a front light, or a port.
    pub(crate) fn colour_weights(&self) -> Option<Vec<Vec<Vec<f64>>>> {
        if self.layout.corrections > 0 || self.below_front.is_some() || self.setup.kept.is_some() {
            return None;
        }
        let luminance = |light: &Weights| -> Vec<f64> {
            let y_bar = self.setup.observer.weights()[1];
            light.radiance.iter().zip(y_bar).map(|(l, y)| l * y / self.white_xyz.y).collect()
        };
        let is_other = self.setup.scene.metrics.observer != Standard::Cie1931;
        let weights = |light: &Weights| -> Vec<Vec<f64>> {
            light.xyz.iter().cloned().chain(is_other.then(|| luminance(light))).collect()
        };
        Some(self.lights.iter().map(weights).collect())
    }

    fn is_front_light(&self, light: &Weights) -> bool {
        self.below_front.is_some() && light.term + 1 == self.layout.terms
    }

    /// Reflectance factors under each light, with that of the front light converted to its place below the
    /// front, and what an instrument with a port sees of them.
    fn seen_of<'e>(&self, all: &'e [ReflectanceFactor]) -> impl Iterator<Item = Cow<'e, ReflectanceFactor>> {
        let last = all.len().saturating_sub(1);
        let kept = self.setup.kept.as_deref();
        all.iter().enumerate().map(move |(k, rho)| {
            match (&self.below_front, kept.and_then(|kept| kept.get(k))) {
                (Some(guide), _) if k == last => Cow::Owned(guide.seen(rho, &all[0])),
                (_, Some(kept)) => Cow::Owned(kept.of_light(rho)),
                _ => Cow::Borrowed(rho),
            }
        })
    }

    /// Converts an estimate to a sample.
    pub(crate) fn sample(&self, estimate: &Estimate) -> Sample {
        let mut sample = self.sample_without_ledger(&estimate.rho);
        self.add_ledger(&estimate.ledger, &mut sample.0);
        sample
    }

    /// Converts reflectance factors under each light to a sample; the entries of the energy balance are 0.
    pub(crate) fn sample_without_ledger(&self, seen: &[ReflectanceFactor]) -> Sample {
        let layout = &self.layout;
        let mut sample = vec![0.0; layout.len()];
        for (light, rho) in self.lights.iter().zip(self.seen_of(seen)) {
            let from_front = sum_of_products(&rho.front, &light.xyz[1]);
            for state in 0..layout.states {
                let base = rho.via_pixel.state(state);
                let both = base.iter().zip(&rho.front).map(|(base, front)| base + front);
                let radiance = sample[layout.radiance(state)].iter_mut().zip(&light.radiance);
                radiance.zip(both.clone()).for_each(|((sum, white), rho)| *sum += white * rho);
                let factor = sample[layout.factor(state)].iter_mut();
                factor.zip(both).for_each(|(sum, rho)| *sum += light.share * rho);
                let from_pixel = sum_of_products(base, &light.xyz[1]);
                sample[layout.terms(state).start + light.term] += from_pixel;
                let mirrored = if self.is_front_light(light) {
                    layout.terms(state).start + light.term
                } else {
                    layout.front_term(state)
                };
                sample[mirrored] += from_front;
                let alone = sample[layout.spectrum_alone(state, light.term)].iter_mut().zip(&light.within);
                let both = base.iter().zip(&rho.front).map(|(base, front)| base + front);
                alone.zip(both).for_each(|((sum, within), rho)| *sum += within * rho);
                if let Some(corrections) = &light.corrections {
                    let both = base.iter().zip(&rho.front).map(|(base, front)| base + front);
                    let slots = sample[layout.corrections(state)].iter_mut();
                    slots.zip(corrections.of(both)).for_each(|(slot, value)| *slot += value);
                }
                for (slot, weights) in layout.every_nm(state).zip(&light.every_nm) {
                    let both = base.iter().zip(&rho.front).zip(weights);
                    sample[slot] += both.map(|((base, front), weight)| (base + front) * weight).sum::<f64>();
                }
                if let Some((within, weights)) =
                    self.setup.scene.within_step.as_ref().zip(light.at_each_nm.as_ref())
                {
                    within.add((base, &rho.front), state, weights, &mut sample[layout.within_step(state)]);
                }
                let luminous = self.luminous[light.term];
                if luminous > 0.0 {
                    sample[layout.alone(state).start + light.term] += (from_pixel + from_front) / luminous;
                }
            }
        }
        Sample(sample)
    }

    fn add_ledger(&self, ledger: &papilio_transport::Ledger, sample: &mut [f64]) {
        let luminous: Vec<f64> = if self.layout.corrections == 0 {
            self.white.iter().zip(self.y_bar()).map(|(l, y)| l * y / self.white_xyz.y).collect()
        } else {
            let lights = &self.lights[self.white_lights.clone()];
            (0..self.grid.len()).map(|bin| lights.iter().map(|light| light.xyz[1][bin]).sum()).collect()
        };
        let parts: [&StateSpectra; Layout::LEDGER] = [
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
                sample[slot] = sum_of_products(part.state(state), &luminous);
            }
        }
    }

    /// Returns the perfect white under the scene's light.
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

    /// Computes the metrics of a sample; `bare` holds the peak wavelengths of the states of the pixel alone,
    /// nm.
    pub(crate) fn scalars(&self, mean: &Sample, bare: &[Option<f64>]) -> ViewScalars {
        let observations: Vec<StateObservation> =
            (0..self.layout.states).map(|state| self.observation(state, mean, bare[state])).collect();
        self.reference(&observations).view(&observations)
    }

    fn observation(&self, state: usize, mean: &Sample, bare_peak_nm: Option<f64>) -> StateObservation {
        let radiance = &mean.0[self.layout.radiance(state)];
        let factor = self.reflectance_factor(state, &mean.0);
        let mut luminance_cd_m2 = self.setup.observer.luminance(radiance);
        if let Some([.., y_1931]) = self.corrections(state, mean) {
            luminance_cd_m2 += LUMENS_PER_WATT * y_1931;
        }
        StateObservation {
            xyz: over(self.xyz(state, mean), self.white_xyz.y),
            luminance_cd_m2,
            peak_nm: factor.and_then(|factor| peak_nm(&self.grid, &factor)),
            bare_peak_nm,
        }
    }

    /// Computes X, Y and Z of a state, W/(m2 sr).
    fn xyz(&self, state: usize, sample: &Sample) -> Xyz {
        let on_grid = self.setup.seen_by().xyz(&sample.0[self.layout.radiance(state)]);
        self.corrections(state, sample).map_or(on_grid, |[x, y, z, _]| on_grid + Xyz { x, y, z })
    }

    /// Computes the peak wavelength of each state of the pixel alone in the direction of a view, nm.
    pub(crate) fn bare_peaks(&self, at: &ViewPoint, base: &Base) -> Vec<Option<f64>> {
        let mut reflectance = StateSpectra::zeros(self.layout.states, self.layout.bins);
        // Below a colour filter the display has other states than its pixel.
        let is_filtered = self.setup.scene.display.filter().is_some();
        if is_filtered || !self.setup.pixel_alone(base, at, &mut reflectance) {
            return vec![None; self.layout.states];
        }
        reflectance.rows().map(|one| peak_nm(&self.grid, one)).collect()
    }

    /// Returns the references of the states: a perfect white, or the display's white state if the front light
    /// is the only light or the scene requests it.
    fn reference(&self, observations: &[StateObservation]) -> Reference<'_> {
        self.reference_among(&self.setup.states, observations)
    }

    /// Returns the references if only states of these names are observed.
    fn reference_among<'b>(
        &'b self,
        names: &'b [String],
        observations: &[StateObservation],
    ) -> Reference<'b> {
        let mut luminance = self.setup.observer.luminance(&self.white);
        for light in
            self.lights[self.white_lights.clone()].iter().filter_map(|light| light.corrections.as_ref())
        {
            let [.., y_1931] = light.of(std::iter::repeat_n(1.0, self.grid.len()));
            luminance += LUMENS_PER_WATT * y_1931;
        }
        let paper = (over(self.white_xyz, self.white_xyz.y), luminance);
        let own = || {
            let white = observations.get(names.iter().position(|name| name == "white")?)?;
            Some((white.xyz, white.luminance_cd_m2))
        };
        let white = if self.is_self_lit { own() } else { Some(paper) };
        let lab_white = if self.has_own_white() { own() } else { white };
        let lab_white = lab_white.map(|(xyz, _)| xyz);
        let reader = Reader::of(&self.setup.scene);
        Reference { names, white, lab_white, settings: &self.setup.scene.metrics, reader }
    }

    /// Returns the numbers of states, wavelengths and sources.
    pub(crate) fn sizes(&self) -> (usize, usize, usize) {
        (self.layout.states, self.layout.bins, self.lights.len())
    }

    /// Returns the name of the reference state.
    pub(crate) fn reference_state(&self) -> &str {
        &self.setup.scene.metrics.reference_state
    }

    /// Returns true if L*, a* and b* are relative to the display's white state: because the scene requests
    /// it, or because the front light is the only light.
    pub(crate) fn has_own_white(&self) -> bool {
        self.is_self_lit || self.setup.scene.metrics.white == ReferenceWhite::Display
    }

    /// Returns the white to which L*, a* and b* are relative.
    pub(crate) fn reference_white(&self) -> ReferenceWhite {
        if self.has_own_white() { ReferenceWhite::Display } else { ReferenceWhite::Perfect }
    }

    /// Computes the reflectance factor of a state. It applies to standard errors, too, because radiance and
    /// factor are linear in light. `None` if there is no ambient light.
    pub(crate) fn reflectance_factor(&self, state: usize, linear: &[f64]) -> Option<Vec<f64>> {
        let (radiance, by_share) = (&linear[self.layout.radiance(state)], &linear[self.layout.factor(state)]);
        let bins = radiance.iter().zip(by_share).zip(&self.white);
        let factor =
            || bins.map(|((l, share), white)| if *white > 0.0 { l / white } else { *share }).collect();
        (!self.is_self_lit).then(factor)
    }

    /// Returns the index of a state.
    pub(crate) fn state_named(&self, name: &str) -> Option<usize> {
        self.setup.states.iter().position(|state| state == name)
    }

    /// Returns the luminance factor under the diffuse light alone; `None` without diffuse light.
    pub(crate) fn under_diffuse(&self, state: usize, sample: &Sample) -> Option<f64> {
        (self.luminous[0] > 0.0).then(|| sample.0[self.layout.alone(state)][0])
    }

    /// Computes the image luminance ratios of the directed sources, `[state][light]`.
    pub(crate) fn specular(&self, images: &[StateSpectra]) -> Vec<Vec<f64>> {
        let lights = &self.setup.lights[1..];
        let one = |state: usize, (light, image): (&Light, &StateSpectra)| {
            let row = image.state(state);
            if let Some(LineWeights { y_1931, .. }) = &light.lines {
                let source: f64 = y_1931.iter().sum();
                return if source > 0.0 { sum_of_products(row, y_1931) / source } else { 0.0 };
            }
            let seen: Vec<f64> = row.iter().zip(light.irradiance.iter()).map(|(r, e)| r * e).collect();
            let source = self.setup.observer.luminance(&light.irradiance);
            if source > 0.0 { self.setup.observer.luminance(&seen) / source } else { 0.0 }
        };
        (0..self.layout.states)
            .map(|s| lights.iter().zip(images).map(|pair| one(s, pair)).collect())
            .collect()
    }
}

/// Fraction of a light in the light of its contribution to Y, by irradiance, or by illuminance at wavelengths
/// where the irradiance is 0.
fn within(setup: &Setup, light: &Light) -> Vec<f64> {
    let part = || setup.lights.iter().filter(|other| other.term == light.term);
    let lux: f64 = part().map(|other| other.illuminance_lx).sum();
    let share = |(bin, own): (usize, &f64)| {
        let all: f64 = part().map(|other| other.irradiance[bin]).sum();
        match (all > 0.0, lux > 0.0) {
            (true, _) => own / all,
            (false, true) => light.illuminance_lx / lux,
            (false, false) => 0.0,
        }
    };
    light.irradiance.iter().enumerate().map(share).collect()
}

fn over(xyz: Xyz, y: f64) -> Xyz {
    Xyz { x: xyz.x / y, y: xyz.y / y, z: xyz.z / y }
}
