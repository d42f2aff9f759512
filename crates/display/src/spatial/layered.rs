//! Sharpness of mirror-like pixels below general layers, and of pixels inside which light spreads: modulation
//! transfer at chosen frequencies.
//!
//! Light by place (spreads, kernels, lines, text, patterns) would take the transform at many frequencies in
//! the plane; it is left to Monte Carlo. Other Lambertian pixels are those of `below_layers.rs`.

use num_complex::Complex64;
use papilio_optics::lobe::Lobe;
use papilio_transport::adding::{self, LayeredSpread};
use papilio_transport::{Interface, ReflectanceFactor, Source};

use super::measured::{Light, Measured, sum};
use super::mtf::Frame;
use super::response::name_of_light;
use super::target::refined;
use super::{LineContrast, MtfView, Refused, SpatialScalars};
use crate::DisplayError;
use crate::meter::{Meter, PixelLight};
use crate::run::{Control, Workers, each, finest};
use crate::setup::{SeenPart, Setup, ViewPoint};

/// Uniform steps of frequencies, and preferred numbers of a decade (ISO 3, R 5), from the lowest on, cycles
/// per mm.
const UNIFORM: u32 = 12;
const PREFERRED: [f64; 5] = [1.0, 1.6, 2.5, 4.0, 6.3];
const LOWEST_PER_MM: f64 = 0.1;

/// `f50` is searched up to this multiple of the highest frequency: a factor farther each time, in steps of
/// another one.
const SEARCHED: f64 = 8.0;
const FARTHER: f64 = 1.4;
const STEP: f64 = 1.25;

/// Loss of modulation over the upper half of the frequencies from which on `f50` is searched beyond them.
const FALLS: f64 = 0.02;

/// Finest level.
const MOST_LEVEL: usize = 3;

/// Error of light by place over the difference of two levels, where a Lambertian layer and another one scatter: it
/// is up to 3.6 times the difference in lines below two of them, which the solver by paths shows.
const OF_LAMBERTIAN: f64 = 4.0;

/// The factor by which the difference between two levels must be multiplied to bound the error of light by place.
pub(super) fn error_over_difference(setup: &Setup) -> f64 {
    let of_light = adding::error_over_difference(&setup.stack, &setup.sources);
    let layers = || setup.stack.layers().iter().map(|layer| &layer.interface);
    let scatters = |one: &&Interface| {
        matches!(
            one,
            Interface::Diffuser(_) | Interface::Reflecting(_) | Interface::Rough(_) | Interface::Scatter(_)
        )
    };
    let is_wide = |one: &Interface| match one {
        Interface::Diffuser(diffuser) => diffuser.lobe == Lobe::Lambertian,
        Interface::Reflecting(_) => true,
        _ => false,
    };
    let is_slow = layers().filter(scatters).count() > 1 && layers().any(is_wide);
    if is_slow { of_light.max(OF_LAMBERTIAN) } else { of_light }
}

/// Frequencies between 0 and the highest, cycles per mm.
pub(super) fn frequencies(highest: f64) -> Vec<f64> {
    let mut all: Vec<f64> = (1..UNIFORM).map(|k| highest * f64::from(k) / f64::from(UNIFORM)).collect();
    let decades = LOWEST_PER_MM.log10() as i32..=highest.log10().ceil() as i32;
    all.extend(decades.flat_map(|decade| PREFERRED.map(|number| number * 10.0_f64.powi(decade))));
    all
}

/// Moves a coarse level away from the fine one by this factor, so that their difference bounds the error: transfers,
/// contrasts and means of patterns. Those of widths and radii are multiplied by [`widen_radii`].
pub(super) fn widen(coarse: &mut Measured, fine: &Measured, factor: f64) {
    let away = |coarse: &mut f64, fine: f64| *coarse = fine + factor * (*coarse - fine);
    let lights = coarse.lights.iter_mut().flatten().zip(fine.lights.iter().flatten());
    for (coarse, fine) in lights {
        for (coarse, fine) in coarse.transfer.iter_mut().zip(&fine.transfer) {
            coarse.iter_mut().zip(fine).for_each(|(coarse, fine)| *coarse = fine + factor * (*coarse - fine));
        }
    }
    for (coarse, fine) in coarse.line_contrast.iter_mut().zip(&fine.line_contrast) {
        for (coarse, (_, fine)) in coarse.all_mut().zip(fine.named()) {
            coarse.iter_mut().zip(fine).for_each(|(coarse, fine)| away(coarse, fine));
        }
    }
    for (coarse, fine) in coarse.text_contrast.iter_mut().flatten().zip(fine.text_contrast.iter().flatten()) {
        coarse.iter_mut().zip(fine).for_each(|(coarse, fine)| away(coarse, *fine));
    }
    coarse.patterns.iter_mut().zip(&fine.patterns).for_each(|(coarse, fine)| away(coarse, *fine));
}

/// Multiplies the errors of what is read from tables of places.
pub(super) fn widen_radii(error: &mut SpatialScalars, factor: f64) {
    let SpatialScalars { edge_10_90_x_um, edge_10_90_y_um, r50_um, r90_um, .. } = error;
    for error in [edge_10_90_x_um, edge_10_90_y_um, r50_um, r90_um].into_iter().flatten() {
        *error *= factor;
    }
}

/// Adds the transfer of another list of frequencies, without its first one, 0.
fn append(all: &mut Measured, farther: &Measured) {
    all.frequencies.extend(&farther.frequencies[1..]);
    let lights = all.lights.iter_mut().flatten().zip(farther.lights.iter().flatten());
    for (all, farther) in lights {
        all.transfer.iter_mut().zip(&farther.transfer).for_each(|(all, farther)| all.extend(&farther[1..]));
    }
}

/// What all frequencies of a view have in common at a level.
struct Prepared<'a> {
    /// Light of s and of p, if they are kept apart, or all.
    parts: Vec<(LayeredSpread<'a>, Vec<ReflectanceFactor>)>,
    lit: Vec<PixelLight>,
    /// Number of axes along which light differs.
    axes: usize,
    from_faces: f64,
}

impl Frame<'_> {
    /// Computes how sharp the display is in a view.
    pub(super) fn layered_view(
        &self,
        view: &ViewPoint,
        control: &Control<'_>,
    ) -> Result<MtfView, DisplayError> {
        if !self.patterns().is_empty() {
            return Err(Refused::PatternsBelowLayers.into());
        }
        let prepared = |level: usize| self.prepared(view, level as u32);
        let mut frequencies = self.frequencies.clone();
        let at = |level: usize| {
            let prepared = prepared(level)?;
            let mut found = self.measured(&prepared, &frequencies)?;
            let mut reach = self.highest();
            while level == 0 && self.is_falling(&found) && reach < SEARCHED * self.highest() {
                reach *= FARTHER;
                let mut farther = vec![0.0];
                while let Some(last) = frequencies.last().filter(|last| **last < reach) {
                    frequencies.push(last * STEP);
                    farther.extend(frequencies.last());
                }
                append(&mut found, &self.measured(&prepared, &farther)?);
            }
            Ok(found)
        };
        let factor = error_over_difference(self.setup);
        let error = |[fine, coarse]: [&Measured; 2]| factor * self.largest_error(coarse, fine);
        let finest = finest(self.setup)?.min(MOST_LEVEL);
        let found = refined(self.setup, finest, at, error, control)?;
        let (mut coarse, fine) = (found.coarser, found.finer);
        widen(&mut coarse, &fine, factor);
        let states = self.setup.states.iter().enumerate();
        let of_state = |(number, name): (usize, &String)| {
            let mut state = self.state(number, &coarse, &fine);
            self.add_between_frequencies(&mut state.error, number, &fine);
            (name.clone(), state)
        };
        let states = states.map(of_state);
        Ok(MtfView {
            theta_deg: view.theta_deg,
            phi_deg: view.phi_deg,
            states: crate::result::Named(states.collect()),
            line_contrast: LineContrast::default(),
            line_contrast_via_pixel: LineContrast::default(),
            line_contrast_error: LineContrast::default(),
            line_contrast_via_pixel_error: LineContrast::default(),
            text_contrast_min: None,
            text_contrast_median: None,
            text_contrast_min_via_pixel: None,
            text_contrast_median_via_pixel: None,
            text_contrast_error: None,
            text_contrast_via_pixel_error: None,
            yule_nielsen_n: None,
            patterns: Vec::new(),
        })
    }

    /// Computes what a view sees at the first level, up to the Nyquist frequency of the pixels.
    pub(super) fn layered_by_frequency(&self, view: &ViewPoint) -> Result<Measured, DisplayError> {
        let most = self.nyquist_per_mm.map_or(self.highest(), |[x, y]| x.max(y));
        let frequencies: Vec<f64> = self.frequencies.iter().copied().filter(|f| *f <= most).collect();
        self.measured(&self.prepared(view, 0)?, &frequencies)
    }

    /// Whether more than half of the modulation is left at the highest frequency in some state, and becomes
    /// less.
    fn is_falling(&self, measured: &Measured) -> bool {
        let all = measured.lights.iter().filter_map(|lights| lights.last());
        let mut curves = all.flat_map(|all| &all.transfer);
        curves.any(|curve| {
            let modulus = |k: usize| curve[k].norm() / curve[0].norm();
            let last = curve.len() - 1;
            curve[0].norm() > 0.0 && modulus(last) >= 0.5 && modulus(last / 2) - modulus(last) > FALLS
        })
    }

    /// Largest error of a modulation transfer.
    fn largest_error(&self, coarse: &Measured, fine: &Measured) -> f64 {
        let mut largest = 0.0;
        for (coarse, fine) in coarse.lights.iter().zip(&fine.lights) {
            let (Some(coarse), Some(fine)) = (coarse.last(), fine.last()) else { continue };
            for (coarse, fine) in coarse.transfer.iter().zip(&fine.transfer) {
                let y = fine[0].norm();
                let of = |(a, b): (&Complex64, &Complex64)| (a - b).norm() / y;
                largest = coarse.iter().zip(fine).filter(|_| y > 0.0).map(of).fold(largest, f64::max);
            }
        }
        largest
    }

    /// Prepares a level.
    fn prepared(&self, view: &ViewPoint, level: u32) -> Result<Prepared<'_>, DisplayError> {
        let (setup, stop) = (self.setup, self.control.stop);
        let meter = Meter::new(setup);
        let is_specular = setup.placed()?.base().is_specular();
        let parts = setup.seen_in_parts(view, level, self.control)?;
        let from_faces = parts.iter().map(|part| meter.without_pixel(&part.factors)[1]).sum();
        let with_spread = |SeenPart { stack, factors }| {
            let spread = LayeredSpread::new(stack, view.field, &setup.sources, level, stop);
            let spread = spread.map_err(Refused::Layered)?.with_spread(setup.scene.display.pixel_spread());
            Ok((spread, factors))
        };
        let lit: Vec<PixelLight> = meter.pixel_lights().into_iter().filter(PixelLight::is_seen).collect();
        // Seen along the normal, light without an azimuth is the same along both axes.
        let is_round = lit.iter().all(|light| setup.sources[light.source] == Source::Diffuse) || !is_specular;
        let is_same = is_round && view.theta_deg == 0.0;
        Ok(Prepared {
            parts: parts.into_iter().map(with_spread).collect::<Result<_, DisplayError>>()?,
            axes: if is_same { 1 } else { 2 },
            from_faces,
            lit,
        })
    }

    /// Computes the light of frequencies, of which the first one is 0, at a level.
    fn measured<'p>(
        &self,
        Prepared { parts, axes, from_faces, lit }: &'p Prepared<'_>,
        frequencies: &[f64],
    ) -> Result<Measured, DisplayError> {
        let (setup, control, axes) = (self.setup, self.control, *axes);
        let seen_in = |factors: &'p [ReflectanceFactor]| -> Vec<adding::Seen<'p>> {
            let of = |light: &'p PixelLight| adding::Seen {
                source: light.source,
                weights: &light.weights[1],
                via_pixel: &factors[light.source].via_pixel,
            };
            lit.iter().map(of).collect()
        };
        let seen: Vec<_> = parts.iter().map(|(spread, factors)| (spread, seen_in(factors))).collect();
        let along = |f: &f64| [[*f, 0.0], [0.0, *f]].into_iter().take(axes);
        let mut workers = None;
        let pool =
            if setup.views.len() == 1 { Workers::unless_one(&mut workers, control.threads)? } else { None };
        // High frequencies take longer: each part has some of them.
        let count = pool.map_or(1, |pool| pool.current_num_threads()).min(frequencies.len());
        let mut pieces: Vec<Vec<usize>> =
            (0..count).map(|first| (first..frequencies.len()).step_by(count).collect()).collect();
        let found = each(pool, &mut pieces, |(_, piece)| {
            control.check()?;
            let some: Vec<[f64; 2]> = piece.iter().flat_map(|k| along(&frequencies[*k])).collect();
            let light = seen.iter().map(|(spread, seen)| spread.light(seen, &some));
            Ok::<_, DisplayError>((
                piece.clone(),
                light.collect::<Result<Vec<_>, _>>().map_err(Refused::Layered)?,
            ))
        });
        let blank = || vec![Complex64::ZERO; frequencies.len()];
        let mut light = vec![vec![[blank(), blank()]; setup.states.len()]; lit.len()];
        for found in found {
            let (piece, some) = found?;
            for some in some {
                for (all, some) in light.iter_mut().flatten().zip(some.into_iter().flatten()) {
                    for (k, values) in piece.iter().zip(some.chunks_exact(axes)) {
                        all[0][*k] += values[0];
                        all[1][*k] += values[axes - 1];
                    }
                }
            }
        }
        let of_state = |state: usize| {
            let mut lights: Vec<Light> = Vec::new();
            for (number, light) in light.iter().enumerate() {
                let y: f64 = seen.iter().map(|(_, seen)| self.luminous(&seen[number], state)).sum();
                let zero = light[state][0][0].re;
                let scale = if zero > 0.0 { y / zero } else { 0.0 };
                let scaled = |values: &Vec<Complex64>| values.iter().map(|value| scale * value).collect();
                lights.push(Light {
                    transfer: light[state].each_ref().map(scaled),
                    strips: [Vec::new(), Vec::new()],
                    rings: Vec::new(),
                });
            }
            let all = sum(&lights);
            lights.extend(all);
            lights
        };
        let names = lit.iter().map(|light| name_of_light(setup, light));
        Ok(Measured {
            names: names.chain(["all".to_owned()]).collect(),
            frequencies: frequencies.to_vec(),
            places: [Vec::new(), Vec::new()],
            radii: Vec::new(),
            lights: (0..setup.states.len()).map(of_state).collect(),
            line_contrast: [LineContrast::default(); 2],
            text_contrast: [None; 2],
            patterns: Vec::new(),
            from_faces: *from_faces,
            seen: Vec::new(),
        })
    }

    /// Y of a state in a light via the pixel.
    fn luminous(&self, seen: &adding::Seen<'_>, state: usize) -> f64 {
        let bins = seen.weights.len();
        seen.via_pixel[state * bins..][..bins]
            .iter()
            .zip(seen.weights)
            .map(|(light, weight)| light * weight)
            .sum()
    }
}
