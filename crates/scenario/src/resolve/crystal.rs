//! Liquid-crystal pixels: indices, axes and slices of each layer.

mod cell;

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_diagnostics::Diagnostic;
use papilio_display::scene::{CrystalPart, CrystalPixel, CrystalSlice};
use papilio_formats::{PolariserTable, read_polariser};
use papilio_optics::berreman::axes;
use papilio_spectra::Spectrum;

use super::Resolver;
use crate::describe::crystal as describe;
use crate::describe::crystal::{CrystalLayer, Handedness, HelixState, Plate, TransmittedWave};
use crate::describe::numbers::{AxisAngle, CrystalThickness};
use crate::mistake::{self, tidy};
use crate::origin::Origin;
use crate::read::Spanned;

/// Name of the only state where no cell has states, and where there is no cell.
const ONLY_STATE: [&str; 2] = ["cell", "pixel"];

/// Largest number of layers and of slices.
const MOST_LAYERS: usize = 64;
const MOST_STATES: usize = 256;
const MOST_SLICES: usize = 20_000;

/// Largest number of slices of all states x wavelengths, each of which is computed for thousands of directions.
const MOST_CRYSTAL_WORK: usize = 1_000_000;

/// Thickest liquid crystal, um.
const MOST_CRYSTAL_UM: f64 = 100.0;

/// Largest birefringence without a note.
const MOST_BIREFRINGENCE: f64 = 0.6;

/// Wavelength at which fringes are compared with the grid, nm.
const FRINGES_AT_NM: f64 = 550.0;

/// Thickest slice of a director that turns, nm: the steps between thicker ones reflect visible light in phase, 2 n h = lambda.
const MOST_SLICE_NM: f64 = 100.0;

/// Fewest slices of half a turn of a cholesteric layer, and the most that its retardance asks for.
const FEWEST_SLICES_OF_HELIX: f64 = 32.0;
const MOST_SLICES_OF_HELIX: f64 = 512.0;

/// Slices of half a turn of a cholesteric layer for a root of a wave of retardance at 550 nm. The error of Y falls with the square of the number: this one
/// keeps it below 5e-5, by comparison with eight times as many.
const SLICES_OF_HELIX: f64 = 72.0;

/// Wavelengths of the retardance and of its dispersion, nm.
const RETARDANCE_AT_NM: f64 = 550.0;
const DISPERSION_AT_NM: f64 = 450.0;

/// Director at a fraction of the depth: azimuth and tilt, degrees.
type Director = (f64, f64);

impl Resolver<'_> {
    pub(super) fn crystal(&mut self, pixel: &describe::CrystalPixel) -> Option<CrystalPixel> {
        self.limit(&pixel.stack, "layers", pixel.stack.len(), MOST_LAYERS)?;
        let states = self.crystal_states(pixel)?;
        let parts: Vec<_> = pixel.stack.iter().map(|layer| self.crystal_layer(layer, &states)).collect();
        let substrate = self.material(&pixel.substrate);
        let inactive_reflectance = self.share(&pixel.inactive_reflectance, pixel.inactive_reflectance.origin);
        let parts: Vec<CrystalPart> = parts.into_iter().collect::<Option<Vec<_>>>()?.concat();
        let slices: usize = parts.iter().flat_map(|part| &part.slices).map(Vec::len).sum();
        if slices > MOST_SLICES {
            let wrong = mistake::too_many("slices", slices as f64, MOST_SLICES);
            self.err(&pixel.stack, wrong.hint("state `slices` of a cell: a note then has the error of Y"));
            return None;
        }
        let work = slices * self.grid.len();
        self.limit(&pixel.stack, "slices of all states x wavelengths", work, MOST_CRYSTAL_WORK)?;
        Some(CrystalPixel {
            parts,
            substrate: substrate?,
            states,
            fill_factor: pixel.fill_factor.0,
            inactive_reflectance: inactive_reflectance?,
        })
    }

    /// The names of the states, which all layers that have states have in common.
    fn crystal_states(&mut self, pixel: &describe::CrystalPixel) -> Option<Vec<String>> {
        let mut first: Option<Vec<String>> = None;
        for layer in pixel.stack.iter() {
            let (names, at) = match &layer.value {
                CrystalLayer::Cell(cell) => (cell.states.names(), cell.states.origin),
                CrystalLayer::Cholesteric(layer) => (layer.states.names(), layer.states.origin),
                _ => continue,
            };
            if names.is_empty() {
                continue;
            }
            if names.len() > MOST_STATES {
                self.errors.push(at, mistake::too_many("states", names.len() as f64, MOST_STATES));
                return None;
            }
            match &first {
                None => first = Some(names),
                Some(first) if *first != names => {
                    let wrong = Diagnostic::new("two layers have different states");
                    let expected = format!("the states of the first of them: {}", first.join(", "));
                    self.errors.push(at, wrong.expected(expected));
                    return None;
                }
                Some(_) => {}
            }
        }
        let has_cell = pixel.stack.iter().any(|layer| matches!(layer.value, CrystalLayer::Cell(_)));
        let only = ONLY_STATE[usize::from(!has_cell)];
        Some(first.unwrap_or_else(|| vec![only.to_owned()]))
    }

    fn crystal_layer(
        &mut self,
        layer: &Spanned<CrystalLayer>,
        states: &[String],
    ) -> Option<Vec<CrystalPart>> {
        let part = match &layer.value {
            CrystalLayer::Polariser(polariser) => self.polariser(polariser),
            CrystalLayer::Retarder(retarder) => self.retarder(retarder),
            CrystalLayer::Cell(cell) => self.cell(cell, states),
            CrystalLayer::Cholesteric(layer) => return self.cholesteric(layer, states),
            CrystalLayer::Film(film) => {
                self.check_nm("display.pixel.stack.thickness_nm", film.thickness_nm.0);
                let index = self.material(&film.material)?;
                Some(uniform([index.clone(), index.clone(), index], (0.0, 0.0), film.thickness_nm.0, true))
            }
            CrystalLayer::Slab(pane) => {
                let index = self.material(&pane.material)?;
                let thickness_nm = 1e3 * pane.thickness_um.0;
                Some(uniform([index.clone(), index.clone(), index], (0.0, 0.0), thickness_nm, false))
            }
        };
        part.map(|part| vec![part])
    }

    fn polariser(&mut self, polariser: &describe::Polariser) -> Option<CrystalPart> {
        let axis_deg = self.azimuth(&polariser.axis_deg, "axis_deg");
        let index = self.material(&polariser.index)?;
        if index.iter().any(|index| index.im > 0.0) {
            let wrong = Diagnostic::new("the index of this polariser has an extinction coefficient k")
                .expected("a real index: what it absorbs follows from `transmittance` and `extinction`, or from `file`");
            self.err(
                &polariser.index,
                wrong.hint("leave out k; a `file` may have k_transmitted and k_absorbed"),
            );
            return None;
        }
        let thickness_nm = 1e3 * polariser.thickness_um.0;
        let [along, across] = self.extinction_of(polariser, thickness_nm)?;
        let with = |k: Vec<f64>| -> Vec<Complex64> {
            index.iter().zip(k).map(|(index, k)| index + Complex64::new(0.0, k)).collect()
        };
        let (along, across) = (with(along), with(across));
        let indices = match polariser.transmits.value {
            // The molecules lie across the axis; along it and along the normal the wave is ordinary.
            TransmittedWave::Ordinary => {
                return Some(uniform(
                    [across, along.clone(), along],
                    (axis_deg? + 90.0, 0.0),
                    thickness_nm,
                    false,
                ));
            }
            TransmittedWave::Extraordinary => [along, across.clone(), across],
        };
        Some(uniform(indices, (axis_deg?, 0.0), thickness_nm, false))
    }

    /// The extinction coefficients of a polariser: of the transmitted polarisation and of the absorbed one.
    fn extinction_of(&mut self, polariser: &describe::Polariser, thickness_nm: f64) -> Option<[Vec<f64>; 2]> {
        let own = [&polariser.transmittance, &polariser.extinction];
        let (transmittance, extinction) = if let Some(name) = &polariser.file.value {
            if let Some(both) = own.into_iter().find(|own| own.is_some()) {
                let wrong = mistake::not_with("file", "transmittance or extinction");
                self.errors.push(both.origin, wrong.hint("remove one of the two"));
                return None;
            }
            let origin = polariser.file.origin;
            match self.data(name, origin, read_polariser)? {
                PolariserTable::Extinction(of) => {
                    self.is_tabulated = true;
                    let [along, across] = of.map(|k| k.on(&self.grid).map(|k| k.to_vec()));
                    return Some([self.sampled(name, origin, along)?, self.sampled(name, origin, across)?]);
                }
                PolariserTable::Transmittance(of) => {
                    let [t, ratio] = of;
                    (self.fractions(name, origin, &t)?, self.fractions(name, origin, &ratio)?)
                }
            }
        } else {
            let [t, ratio] = [(own[0], 0.44), (own[1], 1e-4)].map(|(own, usual)| match &own.value {
                Some(share) => self.share(share, own.origin),
                None => Some(Spectrum::constant(&self.grid, usual)),
            });
            (t?, ratio?)
        };
        let [of_transmittance, of_extinction] =
            if polariser.file.is_some() { [polariser.file.origin; 2] } else { own.map(|own| own.origin) };
        // Along the transmitted polarisation and across it; both halves of unpolarised light give the transmittance.
        let transmitted: Vec<f64> =
            transmittance.iter().zip(extinction.iter()).map(|(t, ratio)| 2.0 * t / (1.0 + ratio)).collect();
        if transmitted.iter().any(|t| *t > 1.0) {
            let wrong = Diagnostic::new(format!(
                "this polariser would transmit {} of the polarisation along its axis",
                tidy(transmitted.iter().copied().fold(0.0, f64::max))
            ));
            let expected = "a transmittance for unpolarised light of at most (1 + extinction)/2";
            self.errors.push(of_transmittance, wrong.expected(expected));
            return None;
        }
        if transmitted.iter().chain(extinction.iter()).any(|value| *value <= 0.0) {
            let wrong = Diagnostic::new(
                "a polariser of finite thickness transmits some light of either polarisation",
            );
            let wrong = wrong.expected("transmittance and extinction above 0");
            self.errors.push(of_extinction, wrong.hint("an almost ideal one has extinction = 1e-9"));
            return None;
        }
        let nm = self.grid.wavelengths_nm();
        let absorbing = |k: usize, t: f64| (-t.ln() * nm[k] / (4.0 * PI * thickness_nm)).max(0.0);
        let along = transmitted.iter().enumerate().map(|(k, t)| absorbing(k, *t)).collect();
        let pairs = transmitted.iter().zip(extinction.iter()).enumerate();
        Some([along, pairs.map(|(k, (t, ratio))| absorbing(k, t * ratio)).collect()])
    }

    fn retarder(&mut self, retarder: &describe::Retarder) -> Option<CrystalPart> {
        let plate = retarder.plate.value;
        if plate == Plate::C && retarder.axis_deg.is_some() {
            self.without_effect(retarder.axis_deg.origin, "axis_deg", "the axis of a C plate is the normal");
        }
        let axis_deg = match (&retarder.axis_deg.value, plate) {
            (Some(axis), _) => self.degrees(axis.0, retarder.axis_deg.origin, "axis_deg"),
            (None, Plate::C) => Some(0.0),
            (None, _) => {
                let wrong = Diagnostic::new("this retarder has no axis");
                let hint = "add `axis_deg`, the azimuth of its slow axis, or plate = \"C\" for an axis along the normal";
                self.err(&retarder.plate, wrong.expected("`axis_deg`").hint(hint));
                None
            }
        };
        let tilt_deg = match (&retarder.tilt_deg.value, plate) {
            (None, Plate::A) => 0.0,
            (None, Plate::C) => 90.0,
            (Some(tilt), Plate::O) => self.degrees(tilt.0, retarder.tilt_deg.origin, "tilt_deg")?,
            (Some(_), _) => {
                let wrong = Diagnostic::new("`tilt_deg` is for O plates only");
                self.err(&retarder.tilt_deg, wrong.expected("plate = \"O\"").hint("remove `tilt_deg`"));
                return None;
            }
            (None, Plate::O) => {
                let wrong = Diagnostic::new("this O plate has no tilt");
                self.err(
                    &retarder.plate,
                    wrong.expected("`tilt_deg`, the tilt of its axis out of the panel"),
                );
                return None;
            }
        };
        if plate != Plate::A && retarder.nz.0 != 1.0 {
            let wrong = Diagnostic::new("`nz` is for A plates only");
            self.err(&retarder.nz, wrong.expected("plate = \"A\"").hint("remove `nz`"));
            return None;
        }
        let ordinary = self.material(&retarder.index)?;
        let thickness_nm = 1e3 * retarder.thickness_um.0;
        let square = |nm: f64| (RETARDANCE_AT_NM / nm).powi(2);
        let slope = (retarder.dispersion.0 - 1.0) / (square(DISPERSION_AT_NM) - 1.0);
        let nm = self.grid.wavelengths_nm();
        let more = |k: usize| {
            let retardance_nm = retarder.retardance_nm.0 * (1.0 + slope * (square(nm[k]) - 1.0));
            retardance_nm / thickness_nm
        };
        let turned = (0..nm.len()).find(|k| more(*k) * retarder.retardance_nm.0 < 0.0);
        if let Some(k) = turned {
            self.notes.push(format!(
                "`dispersion` = {}: the retardance has the opposite sign at {} nm, {} nm: it is a line over 1/wavelength^2 through 450 and 550 nm",
                tidy(retarder.dispersion.0),
                tidy(nm[k]),
                tidy((10.0 * more(k) * thickness_nm).round() / 10.0),
            ));
        }
        let with = |share: f64| -> Vec<Complex64> {
            ordinary.iter().enumerate().map(|(k, n)| n + share * more(k)).collect()
        };
        self.note_birefringence("retardance_nm over the thickness", more(0).abs());
        // x along the axis, y across it, z: n_x - nz (n_x - n_y).
        let indices = [with(1.0), ordinary.clone(), with(1.0 - retarder.nz.0)];
        let least = indices.iter().flatten().map(|n| n.re).fold(f64::INFINITY, f64::min);
        if least < 1.0 {
            let wrong = Diagnostic::new(format!(
                "this retarder has an index of {} along an axis",
                tidy((1e3 * least).round() / 1e3)
            ))
            .expected("at least 1");
            let hint = "the index differs by retardance_nm over the thickness, times nz along the normal: enlarge `thickness_um`, or check the unit";
            self.err(&retarder.retardance_nm, wrong.hint(hint));
            return None;
        }
        Some(uniform(indices, (axis_deg?, tilt_deg), thickness_nm, false))
    }

    /// Notes a birefringence that no film and no liquid crystal has.
    fn note_birefringence(&mut self, what: &str, birefringence: f64) {
        if birefringence <= MOST_BIREFRINGENCE {
            return;
        }
        let note = format!(
            "a birefringence of {} ({what}) is more than films and liquid crystals have (up to {MOST_BIREFRINGENCE}): check the units",
            tidy((1e3 * birefringence).round() / 1e3)
        );
        if !self.notes.contains(&note) {
            self.notes.push(note);
        }
    }

    /// Refuses a layer that is thicker than any liquid crystal, and notes fringes that the grid of wavelengths does not resolve.
    fn check_fringes(
        &mut self,
        key: &str,
        thickness: &Spanned<CrystalThickness>,
        index: &[Complex64],
    ) -> Option<()> {
        let (um, nm) = (thickness.value.0, 1e3 * thickness.value.0);
        let fringes = |from_nm: f64, to_nm: f64| 2.0 * index[0].re * nm * (1.0 / from_nm - 1.0 / to_nm);
        let (start, stop, step) = (self.grid.start_nm(), self.grid.stop_nm(), self.grid.step_nm());
        if um > MOST_CRYSTAL_UM {
            let count = tidy(fringes(start, stop).round());
            let wrong = Diagnostic::new(format!(
                "`{key}` = {} makes {count} interference fringes between {start} and {stop} nm, which nothing resolves",
                tidy(um)
            ));
            let hint = format!("did you mean {} (from nm)? A thick pane is kind = \"slab\"", tidy(um / 1e3));
            self.err(thickness, wrong.expected(format!("at most {MOST_CRYSTAL_UM} um")).hint(hint));
            return None;
        }
        let of_step = fringes(FRINGES_AT_NM, FRINGES_AT_NM + step);
        if of_step > 1.0 {
            self.notes.push(format!(
                "`{key}` = {} makes {} fringes in a step of {step} nm at {FRINGES_AT_NM} nm: its reflectance is that at single wavelengths; \
                 a step of {} nm resolves them",
                tidy(um),
                tidy((10.0 * of_step).round() / 10.0),
                tidy((1.0_f64).max((5.0 * step / of_step).round() / 10.0)),
            ));
        }
        Some(())
    }

    /// A helix in slices of equal thickness, a thinner one below it, and what the layer is in focal conic states.
    fn cholesteric(&mut self, layer: &describe::Cholesteric, states: &[String]) -> Option<Vec<CrystalPart>> {
        let [ordinary, extraordinary] = [&layer.n_o, &layer.n_e].map(|n| self.material(n));
        let azimuth_deg = self.azimuth(&layer.azimuth_deg, "azimuth_deg")?;
        let thickness_nm = 1e3 * layer.thickness_um.0;
        let (ordinary, extraordinary) = (ordinary?, extraordinary?);
        self.check_fringes("thickness_um", &layer.thickness_um, &extraordinary)?;
        let birefringence =
            ordinary.iter().zip(&extraordinary).map(|(o, e)| (e.re - o.re).abs()).fold(0.0, f64::max);
        self.note_birefringence("n_e - n_o", birefringence);
        let of_retardance = SLICES_OF_HELIX * (birefringence * thickness_nm / RETARDANCE_AT_NM).sqrt();
        let of_thickness = layer.pitch_nm.0 / (2.0 * MOST_SLICE_NM);
        let enough = of_retardance.min(MOST_SLICES_OF_HELIX).max(of_thickness).max(FEWEST_SLICES_OF_HELIX);
        // Azimuths, of which there are powers of two, that are multiples of the angle of a slice have their scattering matrices in common.
        let count = (enough.ceil() as usize).next_power_of_two();
        let slice_nm = layer.pitch_nm.0 / (2 * count) as f64;
        // Clockwise away from the viewer is right-handed.
        let step_deg = match layer.handedness.value {
            Handedness::Right => -180.0,
            Handedness::Left => 180.0,
        } / count as f64;
        let slice = |middle: f64, thickness_nm: f64| CrystalSlice {
            axes: axes(azimuth_deg + step_deg * middle, 0.0, 0.0),
            thickness_nm,
        };
        let half_turn: Vec<CrystalSlice> = (0..count).map(|k| slice(k as f64 + 0.5, slice_nm)).collect();
        let nothing = || vec![CrystalSlice { axes: axes(azimuth_deg, 0.0, 0.0), thickness_nm: 0.0 }];
        let shapes: Vec<HelixState> = match layer.states.0.is_empty() {
            true => vec![HelixState::Planar],
            false => layer.states.0.iter().map(|state| state.value.value).collect(),
        };
        debug_assert!(shapes.len() == 1 || shapes.len() == states.len(), "states are checked before");
        let planar = |slices: Vec<CrystalSlice>| -> Vec<Vec<CrystalSlice>> {
            let of =
                |shape: &HelixState| if *shape == HelixState::Planar { slices.clone() } else { nothing() };
            shapes.iter().map(of).collect()
        };
        let indices = [extraordinary.clone(), ordinary.clone(), ordinary.clone()];
        let part = |slices, repeats, rest| CrystalPart {
            indices: indices.clone(),
            slices,
            repeats,
            rest,
            coherent: true,
        };
        let slices = thickness_nm / slice_nm;
        let whole = (slices + 1e-6).floor();
        let last = slices - whole;
        let (repeats, rest) = (whole as usize / count, whole as usize % count);
        let mut parts = Vec::new();
        if repeats > 0 {
            parts.push(part(planar(half_turn), repeats, rest));
        } else if rest > 0 {
            parts.push(part(planar(half_turn[..rest].to_vec()), 1, 0));
        }
        if last > 1e-6 {
            parts.push(part(planar(vec![slice(whole + 0.5 * last, last * slice_nm)]), 1, 0));
        }
        if shapes.contains(&HelixState::FocalConic) {
            // Small domains of all directions: the mean of the permittivity.
            let mean: Vec<Complex64> = ordinary
                .iter()
                .zip(&extraordinary)
                .map(|(o, e)| ((2.0 * o * o + e * e) / 3.0).sqrt())
                .collect();
            let slice = |thickness_nm| vec![CrystalSlice { axes: axes(0.0, 0.0, 0.0), thickness_nm }];
            let of =
                |shape: &HelixState| slice(if *shape == HelixState::FocalConic { thickness_nm } else { 0.0 });
            let slices = shapes.iter().map(of).collect();
            let indices = [mean.clone(), mean.clone(), mean];
            parts.push(CrystalPart { indices, slices, repeats: 1, rest: 0, coherent: true });
        }
        Some(parts)
    }

    fn azimuth(&mut self, angle: &Spanned<AxisAngle>, key: &str) -> Option<f64> {
        self.degrees(angle.value.0, angle.origin, key)
    }

    /// Checks that an angle is not a fraction of pi.
    fn degrees(&mut self, angle: f64, origin: Origin, key: &str) -> Option<f64> {
        let Some((words, degrees)) = radians(angle) else { return Some(angle) };
        let wrong = Diagnostic::new(format!("`{key}` = {} looks like {words} radians", tidy(angle)))
            .expected("an angle in degrees")
            .hint(format!(
                "write {degrees} for that angle, or {} for these degrees",
                tidy((angle * 100.0).round() / 100.0)
            ));
        self.errors.push(origin, wrong);
        None
    }
}

/// Returns the fraction of pi, in words, and the degrees of an angle that is one to at least four digits.
fn radians(angle: f64) -> Option<(String, f64)> {
    const FRACTIONS: [(u32, u32); 12] =
        [(1, 12), (1, 8), (1, 6), (1, 4), (1, 3), (3, 8), (5, 12), (1, 2), (2, 3), (3, 4), (5, 6), (1, 1)];
    let size = angle.abs();
    let is_round = (size * 100.0 - (size * 100.0).round()).abs() < 1e-9;
    FRACTIONS.into_iter().find_map(|(a, b)| {
        let fraction = f64::from(a) / f64::from(b);
        let is_near = (size - PI * fraction).abs() < 6e-4 && !is_round;
        let sign = if angle < 0.0 { "-" } else { "" };
        let times = if a == 1 { String::new() } else { format!("{a} ") };
        let over = if b == 1 { String::new() } else { format!("/{b}") };
        is_near.then(|| (format!("{sign}{times}pi{over}"), (180.0 * fraction).copysign(angle)))
    })
}

/// Returns a layer whose first principal axis has this azimuth and tilt.
fn uniform(
    indices: [Vec<Complex64>; 3],
    (azimuth_deg, tilt_deg): Director,
    thickness_nm: f64,
    coherent: bool,
) -> CrystalPart {
    let slice = CrystalSlice { axes: axes(azimuth_deg, tilt_deg, 0.0), thickness_nm };
    CrystalPart { indices, slices: vec![vec![slice]], repeats: 1, rest: 0, coherent }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[allow(clippy::approx_constant, reason = "digits as users write them")]
    fn fractions_of_pi_are_recognised_and_degrees_are_not() {
        for (angle, expected) in
            [(0.7854, 45.0), (-1.5708, -90.0), (3.14159265, 180.0), (1.0472, 60.0), (1.571, 90.0)]
        {
            assert_eq!(radians(angle).map(|(_, degrees)| degrees), Some(expected), "{angle}");
        }
        for angle in [0.0, 0.5, 1.0, 1.05, 1.57, 2.0, 3.0, 3.14, 6.0, 45.0, 63.6396] {
            assert_eq!(radians(angle), None, "{angle}");
        }
    }
}
