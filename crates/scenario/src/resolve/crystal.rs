//! Liquid-crystal pixels: indices, axes and slices of each layer.

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_diagnostics::{Diagnostic, suggestion};
use papilio_display::scene::{CrystalPart, CrystalPixel, CrystalSlice};
use papilio_formats::{DirectorRow, PolariserTable, read_director, read_polariser};
use papilio_optics::berreman::axes;
use papilio_optics::frank_oseen::{DrivenCell, Nematic, director};
use papilio_spectra::{LIQUID_CRYSTAL_RANGE_NM, Spectrum, liquid_crystal, liquid_crystal_names};

use super::Resolver;
use crate::describe::crystal as describe;
use crate::describe::crystal::{CellState, CrystalLayer, Handedness, HelixState, Plate, TransmittedWave};
use crate::describe::numbers::{AxisAngle, CrystalThickness};
use crate::mistake::{self, tidy};
use crate::origin::Origin;
use crate::read::{Item, Spanned};

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

/// Fewest slices of a cell by default, and the most that its turn and retardance ask for.
const FEWEST_SLICES: f64 = 40.0;
const MOST_SLICES_OF_TURN: f64 = 500.0;

/// Slices for each degree of turn of the director and root of a wave of retardance at 550 nm. The error of Y falls with the square of the
/// number: this one keeps it below 1e-4 (a perfect white: 1), by
/// comparison with 2000 slices of cells from 2 to 20 um that turn by 20 to 720 deg.
const SLICES_OF_TURN: f64 = 1.4;

/// Thickest slice of a director that turns, nm: the steps between thicker ones reflect visible light in phase, 2 n h = lambda.
const MOST_SLICE_NM: f64 = 100.0;

/// Steps in which the turn of a director is found.
const STEPS_OF_TURN: usize = 200;

/// Wavelength at which fringes are compared with the grid, nm.
const FRINGES_AT_NM: f64 = 550.0;

/// Keys of what states by voltage need.
const CONSTANTS: [&str; 5] = ["K11_pN", "K22_pN", "K33_pN", "epsilon_parallel", "epsilon_perpendicular"];

/// Slices of half a turn of a cholesteric layer: azimuths that are multiples of the angle of one have their scattering matrices in common.
const SLICES_OF_HALF_A_TURN: usize = 32;

/// Wavelengths of the retardance and of its dispersion, nm.
const RETARDANCE_AT_NM: f64 = 550.0;
const DISPERSION_AT_NM: f64 = 450.0;

/// Director at a fraction of the depth: azimuth and tilt, degrees.
type Director = (f64, f64);

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
        // A chord is as long as its arc to 2e-4 at 720 deg in 200 steps.
        let chord = |k: usize| -> f64 { axis(k).iter().zip(axis(k + 1)).map(|(a, b)| (a - b).powi(2)).sum() };
        let rate_squared = (0..STEPS_OF_TURN).map(chord).sum::<f64>() * STEPS_OF_TURN as f64;
        if rate_squared < 1e-12 {
            return FEWEST_SLICES as usize;
        }
        let of_turn = SLICES_OF_TURN * rate_squared.sqrt().to_degrees() * self.waves.sqrt();
        // Thicker cells are refused.
        let of_thickness = self.thickness_nm.min(1e3 * MOST_CRYSTAL_UM) / MOST_SLICE_NM;
        of_turn.min(MOST_SLICES_OF_TURN).max(of_thickness).max(FEWEST_SLICES).ceil() as usize
    }
}

impl Resolver<'_> {
    pub(super) fn crystal(&mut self, pixel: &describe::CrystalPixel) -> Option<CrystalPixel> {
        self.limit(&pixel.stack, "layers", pixel.stack.len(), MOST_LAYERS)?;
        let states = self.crystal_states(pixel)?;
        let parts: Vec<_> = pixel.stack.iter().map(|layer| self.crystal_layer(layer, &states)).collect();
        let substrate = self.material(&pixel.substrate);
        let inactive_reflectance = self.share(&pixel.inactive_reflectance, pixel.inactive_reflectance.origin);
        let parts: Vec<CrystalPart> = parts.into_iter().collect::<Option<Vec<_>>>()?.concat();
        let slices = parts.iter().flat_map(|part| &part.slices).map(Vec::len).sum();
        self.limit(&pixel.stack, "slices", slices, MOST_SLICES)?;
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
            self.notes.push(format!(
                "`slices` = {stated} is less than the {enough} that this cell needs for Y within 1e-4: leave out `slices`"
            ));
        }
        let [ordinary, extraordinary] = indices?;
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
                (rub_deg + between(&profile.twist_deg, depth), between(&profile.tilt_deg, depth))
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

    /// A helix in slices of equal thickness, a thinner one below it, and what the layer is in focal conic states.
    fn cholesteric(&mut self, layer: &describe::Cholesteric, states: &[String]) -> Option<Vec<CrystalPart>> {
        let [ordinary, extraordinary] = [&layer.n_o, &layer.n_e].map(|n| self.material(n));
        let azimuth_deg = self.azimuth(&layer.azimuth_deg, "azimuth_deg")?;
        let thickness_nm = 1e3 * layer.thickness_um.0;
        let (ordinary, extraordinary) = (ordinary?, extraordinary?);
        self.check_fringes("thickness_um", &layer.thickness_um, &extraordinary)?;
        let count = SLICES_OF_HALF_A_TURN;
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

/// Returns the tilt and the twist at a depth, linear between the rows.
fn director_at(rows: &[DirectorRow], depth: f64) -> (f64, f64) {
    let right = rows.partition_point(|row| row.depth < depth).clamp(1, rows.len() - 1);
    let (a, b) = (rows[right - 1], rows[right]);
    let t = ((depth - a.depth) / (b.depth - a.depth)).clamp(0.0, 1.0);
    (a.tilt_deg + t * (b.tilt_deg - a.tilt_deg), a.twist_deg + t * (b.twist_deg - a.twist_deg))
}

/// Returns a value at a depth, linear between values at equal steps.
fn between(values: &[f64], depth: f64) -> f64 {
    let at = depth * (values.len() - 1) as f64;
    let k = (at as usize).min(values.len() - 2);
    values[k] + (at - k as f64) * (values[k + 1] - values[k])
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

    #[test]
    fn directors_are_linear_between_rows() {
        let row = |depth, tilt_deg, twist_deg| DirectorRow { depth, tilt_deg, twist_deg };
        let rows = [row(0.0, 2.0, 0.0), row(0.5, 60.0, 45.0), row(1.0, 2.0, 90.0)];
        assert_eq!(director_at(&rows, 0.25), (31.0, 22.5));
        assert_eq!(director_at(&rows, 0.75), (31.0, 67.5));
    }
}
