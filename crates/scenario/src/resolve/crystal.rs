//! Liquid-crystal pixels: indices, axes and slices of each layer.

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_diagnostics::{Diagnostic, suggestion};
use papilio_display::scene::{CrystalPart, CrystalPixel, CrystalSlice};
use papilio_formats::{DirectorRow, read_director};
use papilio_optics::berreman::{MOST_SLABS, axes};
use papilio_spectra::{LIQUID_CRYSTAL_RANGE_NM, liquid_crystal, liquid_crystal_names};

use super::Resolver;
use crate::describe::crystal as describe;
use crate::describe::crystal::{CellState, CrystalLayer, Handedness, Plate, TransmittedWave};
use crate::describe::numbers::AxisAngle;
use crate::mistake::{self, tidy};
use crate::origin::Origin;
use crate::read::{Item, Spanned};

/// Name of the only state where no cell has states, and where there is no cell.
const ONLY_STATE: [&str; 2] = ["cell", "pixel"];

/// Largest number of layers and of slices.
const MOST_LAYERS: usize = 64;
const MOST_SLICES: usize = 20_000;

/// Slices of a turn of a cholesteric layer.
const SLICES_OF_A_TURN: f64 = 40.0;

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
        let parts: Vec<CrystalPart> = parts.into_iter().collect::<Option<_>>()?;
        let slices = parts.iter().flat_map(|part| &part.slices).map(Vec::len).sum();
        self.limit(&pixel.stack, "slices", slices, MOST_SLICES)?;
        if parts.iter().filter(|part| !part.coherent).count() > MOST_SLABS {
            let wrong = Diagnostic::new("this stack has too many thick layers")
                .expected(format!("{MOST_SLABS} polarisers, retarders and slabs at most"))
                .hint("join neighbouring slabs of nearly the same index");
            self.err(&pixel.stack, wrong);
            return None;
        }
        Some(CrystalPixel {
            parts,
            substrate: substrate?,
            states,
            fill_factor: pixel.fill_factor.0,
            inactive_reflectance: inactive_reflectance?,
        })
    }

    /// The names of the states, which all cells that have states have in common.
    fn crystal_states(&mut self, pixel: &describe::CrystalPixel) -> Option<Vec<String>> {
        let mut first: Option<Vec<String>> = None;
        for layer in pixel.stack.iter() {
            let CrystalLayer::Cell(cell) = &layer.value else { continue };
            let names = cell.states.names();
            if names.is_empty() {
                continue;
            }
            self.limit(&cell.states, "states", names.len(), 256)?;
            match &first {
                None => first = Some(names),
                Some(first) if *first != names => {
                    let wrong = Diagnostic::new("two cells have different states");
                    let expected = first.join(", ");
                    self.err(
                        &cell.states,
                        wrong.expected(format!("the states of the first cell: {expected}")),
                    );
                    return None;
                }
                Some(_) => {}
            }
        }
        let has_cell = pixel.stack.iter().any(|layer| matches!(layer.value, CrystalLayer::Cell(_)));
        let only = ONLY_STATE[usize::from(!has_cell)];
        Some(first.unwrap_or_else(|| vec![only.to_owned()]))
    }

    fn crystal_layer(&mut self, layer: &Spanned<CrystalLayer>, states: &[String]) -> Option<CrystalPart> {
        match &layer.value {
            CrystalLayer::Polariser(polariser) => self.polariser(polariser),
            CrystalLayer::Retarder(retarder) => self.retarder(retarder),
            CrystalLayer::Cell(cell) => self.cell(cell, states),
            CrystalLayer::Cholesteric(layer) => self.cholesteric(layer),
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
        }
    }

    fn polariser(&mut self, polariser: &describe::Polariser) -> Option<CrystalPart> {
        let axis_deg = self.azimuth(&polariser.axis_deg, "axis_deg");
        let transmittance = self.share(&polariser.transmittance, polariser.transmittance.origin);
        let extinction = self.share(&polariser.extinction, polariser.extinction.origin);
        let index = self.material(&polariser.index)?;
        let (transmittance, extinction) = (transmittance?, extinction?);
        let thickness_nm = 1e3 * polariser.thickness_um.0;
        // Along the transmitted polarisation and across it; both halves of unpolarised light give the transmittance.
        let transmitted: Vec<f64> =
            transmittance.iter().zip(extinction.iter()).map(|(t, ratio)| 2.0 * t / (1.0 + ratio)).collect();
        if transmitted.iter().any(|t| *t > 1.0) {
            let wrong = Diagnostic::new(format!(
                "a transmittance of {} needs {} of the polarisation along the axis, more than there is",
                tidy(transmittance.iter().copied().fold(0.0, f64::max)),
                tidy(transmitted.iter().copied().fold(0.0, f64::max))
            ));
            let expected = "a transmittance for unpolarised light of at most (1 + extinction)/2";
            self.err(&polariser.transmittance, wrong.expected(expected));
            return None;
        }
        let is_dark = |value: f64| value <= 0.0;
        if transmitted.iter().any(|t| is_dark(*t)) || extinction.iter().any(|ratio| is_dark(*ratio)) {
            let wrong = Diagnostic::new(
                "a polariser of finite thickness transmits some light of either polarisation",
            );
            self.err(
                &polariser.extinction,
                wrong
                    .expected("transmittance and extinction above 0")
                    .hint("an almost ideal one has extinction = 1e-9"),
            );
            return None;
        }
        let nm = self.grid.wavelengths_nm();
        let absorbing = |k: usize, t: f64| {
            let extinction = -t.ln() * nm[k] / (4.0 * PI * thickness_nm);
            Complex64::new(index[k].re, index[k].im + extinction.max(0.0))
        };
        let along = transmitted.iter().enumerate().map(|(k, t)| absorbing(k, *t)).collect();
        let pairs = transmitted.iter().zip(extinction.iter()).enumerate();
        let across: Vec<Complex64> = pairs.map(|(k, (t, ratio))| absorbing(k, t * ratio)).collect();
        let indices = match polariser.transmits.value {
            // The molecules lie across the axis; along it and along the normal the wave is ordinary.
            TransmittedWave::Ordinary => {
                let along: Vec<Complex64> = along;
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

    fn retarder(&mut self, retarder: &describe::Retarder) -> Option<CrystalPart> {
        let plate = retarder.plate.value;
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
        let with = |share: f64| -> Vec<Complex64> {
            ordinary.iter().enumerate().map(|(k, n)| n + share * more(k)).collect()
        };
        // x along the axis, y across it, z: n_x - nz (n_x - n_y).
        let indices = [with(1.0), ordinary.clone(), with(1.0 - retarder.nz.0)];
        if indices.iter().flatten().any(|n| n.re < 0.1) {
            let wrong = Diagnostic::new("the birefringence of this retarder exceeds its index");
            self.err(
                &retarder.retardance_nm,
                wrong.hint("enlarge `thickness_um`, or check the unit of `retardance_nm`"),
            );
            return None;
        }
        Some(uniform(indices, (axis_deg?, tilt_deg), thickness_nm, false))
    }

    fn cell(&mut self, cell: &describe::Cell, states: &[String]) -> Option<CrystalPart> {
        let indices = self.cell_indices(cell);
        let rub_deg = self.azimuth(&cell.rub_deg, "rub_deg");
        let twist_deg = self.degrees(cell.twist_deg.0, cell.twist_deg.origin, "twist_deg");
        let pretilt_deg = self.degrees(cell.pretilt_deg.0, cell.pretilt_deg.origin, "pretilt_deg");
        let thickness_nm = 1e3 * cell.gap_um.0;
        let count = cell.slices.value.0 as usize;
        let (rub_deg, usual) = (rub_deg?, (pretilt_deg?, twist_deg?));
        let mut slices = Vec::with_capacity(states.len());
        if cell.states.0.is_empty() {
            let [tilt_deg, twist_deg] = [usual.0, usual.1];
            slices.push(sliced(thickness_nm, count, |depth| (rub_deg + twist_deg * depth, tilt_deg)));
        }
        for state in &cell.states.0 {
            slices.push(self.cell_state(state, (rub_deg, usual), thickness_nm, count)?);
        }
        let [ordinary, extraordinary] = indices?;
        Some(CrystalPart { indices: [extraordinary, ordinary.clone(), ordinary], slices, coherent: true })
    }

    fn cell_state(
        &mut self,
        state: &Item<CellState>,
        (rub_deg, (tilt_deg, twist_deg)): (f64, (f64, f64)),
        thickness_nm: f64,
        count: usize,
    ) -> Option<Vec<CrystalSlice>> {
        match &state.value.value {
            CellState::File(name) => {
                let rows = self.data(name, state.value.origin, read_director)?;
                Some(sliced(thickness_nm, count, |depth| {
                    let (tilt_deg, twist_deg) = director_at(&rows, depth);
                    (rub_deg + twist_deg, tilt_deg)
                }))
            }
            CellState::Uniform(own) => {
                if own.tilt_deg.is_none() && own.twist_deg.is_none() {
                    let wrong = Diagnostic::new(format!("the state `{}` has no director", state.name));
                    let hint = "add `tilt_deg`, `twist_deg` or both, or state a file of directors by depth";
                    self.err(&state.value, wrong.expected("{ tilt_deg = 85 } or \"on.csv\"").hint(hint));
                    return None;
                }
                let tilt_deg = match &own.tilt_deg.value {
                    Some(tilt) => self.degrees(tilt.0, own.tilt_deg.origin, "tilt_deg")?,
                    None => tilt_deg,
                };
                let twist_deg = match &own.twist_deg.value {
                    Some(twist) => self.degrees(twist.0, own.twist_deg.origin, "twist_deg")?,
                    None => twist_deg,
                };
                Some(sliced(thickness_nm, count, |depth| (rub_deg + twist_deg * depth, tilt_deg)))
            }
        }
    }

    /// The ordinary and the extraordinary index of a cell.
    fn cell_indices(&mut self, cell: &describe::Cell) -> Option<[Vec<Complex64>; 2]> {
        let own = [&cell.n_o, &cell.n_e];
        let Some(name) = &cell.liquid_crystal.value else {
            let [Some(_), Some(_)] = own.map(|n| n.value.as_ref()) else {
                let wrong = Diagnostic::new("this cell has no liquid crystal");
                let hint = "add `n_o` and `n_e`, or liquid_crystal = \"E7\"";
                self.err(&cell.gap_um, wrong.expected("`n_o` and `n_e`, or `liquid_crystal`").hint(hint));
                return None;
            };
            let indices = own.map(|n| {
                let spec = n.value.clone().map(|value| Spanned { value, origin: n.origin });
                spec.and_then(|spec| self.material(&spec))
            });
            let [n_o, n_e] = indices;
            return Some([n_o?, n_e?]);
        };
        if let Some(both) = own.into_iter().find(|n| n.is_some()) {
            let wrong = mistake::not_with("liquid_crystal", "n_o or n_e");
            self.errors.push(both.origin, wrong.hint("remove one of the two"));
            return None;
        }
        let Some(known) = liquid_crystal(name) else {
            let wrong = Diagnostic::new(format!("there is no liquid crystal `{name}`"));
            let hint = suggestion(name, liquid_crystal_names(), "liquid crystals");
            self.err(&cell.liquid_crystal, wrong.hint(hint));
            return None;
        };
        let (first, last) = LIQUID_CRYSTAL_RANGE_NM;
        if self.grid.start_nm() < first || self.grid.stop_nm() > last {
            self.notes
                .push(format!("{name} was measured from {first} to {last} nm; its formula is used beyond"));
        }
        let indices: Vec<[f64; 2]> = self.grid.wavelengths_nm().iter().map(|nm| known.indices(*nm)).collect();
        Some([0, 1].map(|k| indices.iter().map(|n| n[k].into()).collect()))
    }

    fn cholesteric(&mut self, layer: &describe::Cholesteric) -> Option<CrystalPart> {
        let [ordinary, extraordinary] = [&layer.n_o, &layer.n_e].map(|n| self.material(n));
        let azimuth_deg = self.azimuth(&layer.azimuth_deg, "azimuth_deg")?;
        let thickness_nm = 1e3 * layer.thickness_um.0;
        let turns = thickness_nm / layer.pitch_nm.0;
        let slices = (SLICES_OF_A_TURN * turns).ceil().max(1.0) as usize;
        self.limit(&layer.thickness_um, "slices (40 a turn)", slices, MOST_SLICES)?;
        // Clockwise away from the viewer is right-handed.
        let turn_deg = match layer.handedness.value {
            Handedness::Right => -360.0 * turns,
            Handedness::Left => 360.0 * turns,
        };
        let slices = sliced(thickness_nm, slices, |depth| (azimuth_deg + turn_deg * depth, 0.0));
        let (ordinary, extraordinary) = (ordinary?, extraordinary?);
        let indices = [extraordinary, ordinary.clone(), ordinary];
        Some(CrystalPart { indices, slices: vec![slices], coherent: true })
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

/// Returns the tilt and the twist at a depth, linear between the rows.
fn director_at(rows: &[DirectorRow], depth: f64) -> (f64, f64) {
    let right = rows.partition_point(|row| row.depth < depth).clamp(1, rows.len() - 1);
    let (a, b) = (rows[right - 1], rows[right]);
    let t = ((depth - a.depth) / (b.depth - a.depth)).clamp(0.0, 1.0);
    (a.tilt_deg + t * (b.tilt_deg - a.tilt_deg), a.twist_deg + t * (b.twist_deg - a.twist_deg))
}

/// Returns slices with the director in the middle of each.
fn sliced(thickness_nm: f64, count: usize, director: impl Fn(f64) -> Director) -> Vec<CrystalSlice> {
    let slice = |k: usize| {
        let (azimuth_deg, tilt_deg) = director((k as f64 + 0.5) / count as f64);
        CrystalSlice { axes: axes(azimuth_deg, tilt_deg, 0.0), thickness_nm: thickness_nm / count as f64 }
    };
    (0..count).map(slice).collect()
}

/// Returns a layer whose first principal axis has this azimuth and tilt.
fn uniform(
    indices: [Vec<Complex64>; 3],
    (azimuth_deg, tilt_deg): Director,
    thickness_nm: f64,
    coherent: bool,
) -> CrystalPart {
    let slice = CrystalSlice { axes: axes(azimuth_deg, tilt_deg, 0.0), thickness_nm };
    CrystalPart { indices, slices: vec![vec![slice]], coherent }
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

    #[test]
    fn directors_are_linear_between_rows() {
        let row = |depth, tilt_deg, twist_deg| DirectorRow { depth, tilt_deg, twist_deg };
        let rows = [row(0.0, 2.0, 0.0), row(0.5, 60.0, 45.0), row(1.0, 2.0, 90.0)];
        assert_eq!(director_at(&rows, 0.25), (31.0, 22.5));
        assert_eq!(director_at(&rows, 0.75), (31.0, 67.5));
    }
}
