//! Cells of a liquid-crystal pixel: indices, the director of each state, and how it is cut into slices.

use num_complex::Complex64;
use papilio_diagnostics::{Diagnostic, suggestion};
use papilio_display::scene::{CrystalPart, CrystalSlice};
use papilio_formats::{DirectorRow, read_director};
use papilio_optics::berreman::axes;
use papilio_optics::frank_oseen::{DrivenCell, Nematic, director};
use papilio_spectra::{LIQUID_CRYSTAL_RANGE_NM, liquid_crystal, liquid_crystal_names};

use super::{Director, MOST_CRYSTAL_UM, MOST_SLICE_NM, RETARDANCE_AT_NM};
use crate::describe::crystal as describe;
use crate::describe::crystal::CellState;
use crate::mistake::{self, tidy};
use crate::origin::Origin;
use crate::read::{Item, Spanned};
use crate::resolve::Resolver;

/// Fewest slices of a cell by default.
const FEWEST_SLICES: f64 = 40.0;

/// Slices for each degree of turn of the director and root of a wave of retardance at 550 nm. The error of Y falls with the square of the
/// number: this one keeps it below [`ERROR_OF_SLICES`], by comparison with 2000 slices of cells from 2 to 20 um that turn by 20 to 720 deg.
const SLICES_OF_TURN: f64 = 1.4;

/// From this number on, slices for each degree to the power 0.75 and root of a wave: by comparison with the limit of 1000 and 2000 slices,
/// 260 cells from 2 to 20 um of birefringence 0.05 to 0.3 that turn by 90 to 3600 deg need at most 3.24.
const MANY_SLICES: f64 = 500.0;
const SLICES_OF_LONG_TURN: f64 = 4.0;

/// Error of Y (a perfect white: 1) with slices enough.
const ERROR_OF_SLICES: f64 = 1e-4;

/// Difference from 90 deg within which an anchoring is vertical, degrees.
const VERTICAL_DEG: f64 = 1e-6;

/// Steps in which the turn of a director is found.
const STEPS_OF_TURN: usize = 200;

/// Keys of what states by voltage need.
const CONSTANTS: [&str; 5] = ["K11_pN", "K22_pN", "K33_pN", "epsilon_parallel", "epsilon_perpendicular"];

/// What the states of a cell have in common.
#[derive(Clone, Copy)]
struct Shape {
    rub_deg: f64,
    tilt_deg: f64,
    twist_deg: f64,
    slicing: Slicing,
}

/// How a cell is cut into slices.
#[derive(Clone, Copy)]
struct Slicing {
    thickness_nm: f64,
    /// Retardance at 550 nm, waves.
    waves: f64,
    /// The number that the user states.
    stated: Option<usize>,
}

impl Slicing {
    /// Returns the number of slices that this director needs.
    fn enough(&self, director: impl Fn(f64) -> Director) -> usize {
        let axis = |k: usize| {
            let (azimuth_deg, tilt_deg) = director(k as f64 / STEPS_OF_TURN as f64);
            axes(azimuth_deg, tilt_deg, 0.0)[0]
        };
        // A chord is as long as its arc to 2e-4 at 720 deg in 200 steps, to 4e-3 at 3600 deg.
        let chord = |k: usize| -> f64 { axis(k).iter().zip(axis(k + 1)).map(|(a, b)| (a - b).powi(2)).sum() };
        let rate_squared = (0..STEPS_OF_TURN).map(chord).sum::<f64>() * STEPS_OF_TURN as f64;
        if rate_squared < 1e-12 {
            return FEWEST_SLICES as usize;
        }
        let turn_deg = rate_squared.sqrt().to_degrees();
        let of_long_turn = SLICES_OF_LONG_TURN * turn_deg.powf(0.75) * self.waves.sqrt();
        let of_turn = SLICES_OF_TURN * turn_deg * self.waves.sqrt();
        // Thicker cells are refused.
        let of_thickness = self.thickness_nm.min(1e3 * MOST_CRYSTAL_UM) / MOST_SLICE_NM;
        of_turn.min(of_long_turn.max(MANY_SLICES)).max(of_thickness).max(FEWEST_SLICES).ceil() as usize
    }
}

impl Resolver<'_> {
    pub(super) fn cell(&mut self, cell: &describe::Cell, states: &[String]) -> Option<CrystalPart> {
        let indices = self.cell_indices(cell);
        let rub_deg = self.azimuth(&cell.rub_deg, "rub_deg");
        let twist_deg = self.degrees(cell.twist_deg.0, cell.twist_deg.origin, "twist_deg");
        let pretilt_deg = self.degrees(cell.pretilt_deg.0, cell.pretilt_deg.origin, "pretilt_deg");
        let thickness_nm = 1e3 * cell.gap_um.0;
        let (rub_deg, usual) = (rub_deg?, (pretilt_deg?, twist_deg?));
        let nematic = self.nematic(cell)?;
        let is_driven = |state: &Item<CellState>| matches!(&state.value.value, CellState::Uniform(own) if own.volts.is_some());
        if !cell.states.0.iter().any(is_driven) {
            let why = "it is for states by voltage, and no state of this cell has `volts`";
            if cell.pretilt_bottom_deg.is_some() {
                self.without_effect(cell.pretilt_bottom_deg.origin, "pretilt_bottom_deg", why);
            }
            if cell.pitch_um.is_some() {
                self.without_effect(cell.pitch_um.origin, "pitch_um", why);
            }
        }
        if cell.pitch_um.value.as_ref().is_some_and(|pitch| pitch.0 == 0.0) {
            let wrong = Diagnostic::new("a helix has no pitch of 0").expected("a length above or below 0");
            self.err(&cell.pitch_um, wrong.hint("leave out `pitch_um` if there is no chiral dopant"));
            return None;
        }
        let birefringence = indices
            .iter()
            .map(|[o, e]| o.iter().zip(e).map(|(o, e)| (e.re - o.re).abs()).fold(0.0, f64::max));
        let birefringence = birefringence.fold(0.0, f64::max);
        let waves = birefringence * thickness_nm / RETARDANCE_AT_NM;
        let stated = cell.slices.value.as_ref().map(|count| count.0 as usize);
        let slicing = Slicing { thickness_nm, waves, stated };
        let mut slices = Vec::with_capacity(states.len());
        let mut enough = 0;
        if cell.states.0.is_empty() {
            let [tilt_deg, twist_deg] = [usual.0, usual.1];
            slices.push(sliced(slicing, &mut enough, |depth| (rub_deg + twist_deg * depth, tilt_deg)));
        }
        for state in &cell.states.0 {
            let shape = Shape { rub_deg, tilt_deg: usual.0, twist_deg: usual.1, slicing };
            slices.push(self.cell_state(state, cell, nematic, shape, &mut enough)?);
        }
        if let Some(stated) = stated.filter(|stated| *stated < enough && enough > FEWEST_SLICES as usize) {
            let error = ERROR_OF_SLICES * (enough as f64 / stated as f64).powi(2);
            self.notes.push(format!(
                "`slices` = {stated} is less than the {enough} that this cell needs for Y within 1e-4: Y may be off by up to {error:.1e}; leave out `slices`"
            ));
        }
        let [ordinary, extraordinary] = indices?;
        self.note_birefringence("n_e - n_o", birefringence);
        self.check_fringes("gap_um", &cell.gap_um, &extraordinary)?;
        Some(CrystalPart {
            indices: [extraordinary, ordinary.clone(), ordinary],
            slices,
            repeats: 1,
            rest: 0,
            coherent: true,
        })
    }

    fn cell_state(
        &mut self,
        state: &Item<CellState>,
        cell: &describe::Cell,
        nematic: Option<Nematic>,
        shape: Shape,
        enough: &mut usize,
    ) -> Option<Vec<CrystalSlice>> {
        let Shape { rub_deg, tilt_deg, twist_deg, slicing } = shape;
        let own = match &state.value.value {
            CellState::File(name) => {
                let rows = self.data(name, state.value.origin, read_director)?;
                return Some(sliced(slicing, enough, |depth| {
                    let (tilt_deg, twist_deg) = director_at(&rows, depth);
                    (rub_deg + twist_deg, tilt_deg)
                }));
            }
            CellState::Uniform(own) => own,
        };
        let tilt = own.tilt_deg.value.as_ref().map(|tilt| (tilt.0, own.tilt_deg.origin, "tilt_deg"));
        let twist = own.twist_deg.value.as_ref().map(|twist| (twist.0, own.twist_deg.origin, "twist_deg"));
        if let Some(volts) = &own.volts.value {
            if let Some((_, origin, key)) = tilt.or(twist) {
                let wrong = mistake::not_with("volts", key);
                let hint =
                    "remove it: the director follows from the voltage, pretilt_deg and twist_deg of the cell";
                self.errors.push(origin, wrong.hint(hint));
                return None;
            }
            let Some(nematic) = nematic else {
                let wrong =
                    Diagnostic::new("the director at a voltage needs the constants of the liquid crystal");
                let wrong = wrong.expected(CONSTANTS.map(|key| format!("`{key}`")).join(", "));
                let hint = "add them to the cell, from the data sheet (at the temperature and frequency of the display)";
                self.err(&own.volts, wrong.hint(hint));
                return None;
            };
            let bottom = cell.pretilt_bottom_deg.value.as_ref().map_or(tilt_deg, |tilt| tilt.0);
            let is_vertical = |tilt_deg: &f64| (tilt_deg.abs() - 90.0).abs() < VERTICAL_DEG;
            if let Some(tilt_deg) =
                [tilt_deg, bottom].into_iter().find(is_vertical).filter(|_| twist_deg != 0.0)
            {
                let note = format!(
                    "`twist_deg` = {} has no meaning for `volts`, because a surface that anchors the director vertically (pretilt {} deg) has no azimuth: \
                     expected `twist_deg` = 0, or pretilts such as 89 deg",
                    tidy(twist_deg),
                    tidy(tilt_deg)
                );
                if !self.notes.contains(&note) {
                    self.notes.push(note);
                }
            }
            let [along, across] = nematic.permittivity;
            let is_level = |tilt_deg: f64| tilt_deg % 180.0 == 0.0;
            let why = if along == across {
                Some("both permittivities are equal")
            } else if along > across && [tilt_deg, bottom].iter().all(is_vertical) {
                Some(
                    "the director is along the field already (pretilt 90 deg, epsilon_parallel > epsilon_perpendicular)",
                )
            } else if along < across && is_level(tilt_deg) && is_level(bottom) {
                Some(
                    "the director is across the field already (pretilt 0 deg, epsilon_parallel < epsilon_perpendicular)",
                )
            } else {
                None
            };
            if let Some(why) = why.filter(|_| volts.0 != 0.0) {
                let note = format!("`volts` = {} does not move the director, because {why}", tidy(volts.0));
                if !self.notes.contains(&note) {
                    self.notes.push(note);
                }
            }
            let turns = cell.pitch_um.value.as_ref().map_or(0.0, |pitch| cell.gap_um.0 / pitch.0);
            let natural_twist_deg = 360.0 * turns;
            let driven = DrivenCell {
                nematic,
                tilt_deg: [tilt_deg, bottom],
                twist_deg,
                natural_twist_deg,
                volts: volts.0,
            };
            let profile = match director(&driven) {
                Ok(profile) => profile,
                Err(error) => {
                    self.err(&own.volts, Diagnostic::new(error.to_string()));
                    return None;
                }
            };
            return Some(sliced(slicing, enough, |depth| {
                let (right, share) = between(&profile.depth, depth);
                let at = |angles: &[f64]| angles[right - 1] + share * (angles[right] - angles[right - 1]);
                (rub_deg + at(&profile.twist_deg), at(&profile.tilt_deg))
            }));
        }
        if tilt.is_none() && twist.is_none() {
            let wrong = Diagnostic::new(format!("the state `{}` has no director", state.name));
            let hint =
                "add `volts`, or `tilt_deg`, `twist_deg` or both, or state a file of directors by depth";
            self.err(
                &state.value,
                wrong.expected("{ volts = 5 }, { tilt_deg = 85 } or \"on.csv\"").hint(hint),
            );
            return None;
        }
        let mut checked = |own: Option<(f64, Origin, &str)>, usual: f64| match own {
            Some((angle, origin, key)) => self.degrees(angle, origin, key),
            None => Some(usual),
        };
        let (tilt_deg, twist_deg) = (checked(tilt, tilt_deg)?, checked(twist, twist_deg)?);
        Some(sliced(slicing, enough, |depth| (rub_deg + twist_deg * depth, tilt_deg)))
    }

    /// The elastic constants and permittivities of a cell, if it states them.
    fn nematic(&mut self, cell: &describe::Cell) -> Option<Option<Nematic>> {
        let elastic = [&cell.K11_pN, &cell.K22_pN, &cell.K33_pN];
        let permittivity = [&cell.epsilon_parallel, &cell.epsilon_perpendicular];
        let has =
            elastic.map(|k| k.is_some()).into_iter().chain(permittivity.map(|epsilon| epsilon.is_some()));
        let missing: Vec<String> =
            CONSTANTS.iter().zip(has).filter(|(_, has)| !has).map(|(key, _)| format!("`{key}`")).collect();
        if missing.len() == CONSTANTS.len() {
            return Some(None);
        }
        let values = [elastic[0], elastic[1], elastic[2]].map(|k| k.value.as_ref().map(|k| k.0));
        let others = permittivity.map(|epsilon| epsilon.value.as_ref().map(|epsilon| epsilon.0));
        let ([Some(k11), Some(k22), Some(k33)], [Some(along), Some(across)]) = (values, others) else {
            let wrong = Diagnostic::new(format!("this cell has no {}", missing.join(", ")));
            let expected = "all three elastic constants and both permittivities, or none of them";
            self.err(&cell.gap_um, wrong.expected(expected));
            return None;
        };
        Some(Some(Nematic { elastic_pn: [k11, k22, k33], permittivity: [along, across] }))
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
}

/// Returns the tilt and the twist at a depth, linear between the rows.
fn director_at(rows: &[DirectorRow], depth: f64) -> (f64, f64) {
    let right = rows.partition_point(|row| row.depth < depth).clamp(1, rows.len() - 1);
    let (a, b) = (rows[right - 1], rows[right]);
    let t = ((depth - a.depth) / (b.depth - a.depth)).clamp(0.0, 1.0);
    (a.tilt_deg + t * (b.tilt_deg - a.tilt_deg), a.twist_deg + t * (b.twist_deg - a.twist_deg))
}

/// Returns the number of the first of these rising depths at or below a depth, from 1 on, and the position between it and the one above.
fn between(depths: &[f64], depth: f64) -> (usize, f64) {
    let right = depths.partition_point(|other| *other < depth).clamp(1, depths.len() - 1);
    let above = depths[right - 1];
    (right, ((depth - above) / (depths[right] - above)).clamp(0.0, 1.0))
}

/// Returns slices with the director in the middle of each, as many as are stated or enough; `enough` becomes the largest number so far.
fn sliced(slicing: Slicing, enough: &mut usize, director: impl Fn(f64) -> Director) -> Vec<CrystalSlice> {
    let own = slicing.enough(&director);
    *enough = own.max(*enough);
    let count = slicing.stated.unwrap_or(own);
    let thickness_nm = slicing.thickness_nm / count as f64;
    let slice = |k: usize| {
        let (azimuth_deg, tilt_deg) = director((k as f64 + 0.5) / count as f64);
        CrystalSlice { axes: axes(azimuth_deg, tilt_deg, 0.0), thickness_nm }
    };
    (0..count).map(slice).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directors_are_linear_between_rows() {
        let row = |depth, tilt_deg, twist_deg| DirectorRow { depth, tilt_deg, twist_deg };
        let rows = [row(0.0, 2.0, 0.0), row(0.5, 60.0, 45.0), row(1.0, 2.0, 90.0)];
        assert_eq!(director_at(&rows, 0.25), (31.0, 22.5));
        assert_eq!(director_at(&rows, 0.75), (31.0, 67.5));
    }
}
