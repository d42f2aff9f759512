//! Film pixels: layers, sub-pixels and states.

use std::collections::HashSet;

use papilio_diagnostics::{Diagnostic, suggestion};
use papilio_display::scene::{Drive, FilmLayer, FilmPixel, FilmState, SubPixel, Thickness};

use super::Resolver;
use crate::describe::display::{IndexOf, MaterialSpec};
use crate::describe::pixel as describe;
use crate::describe::pixel::{DriveSpec, StateSpec};
use crate::mistake::{self, Mistake, tidy};
use crate::read::Item;

/// Default states: fractions of red, green and blue in their own colour.
pub(super) const DEFAULT_STATES: [(&str, [f64; 3]); 8] = [
    ("white", [1.0, 1.0, 1.0]),
    ("black", [0.0, 0.0, 0.0]),
    ("red", [1.0, 0.0, 0.0]),
    ("green", [0.0, 1.0, 0.0]),
    ("blue", [0.0, 0.0, 1.0]),
    ("cyan", [0.0, 1.0, 1.0]),
    ("magenta", [1.0, 0.0, 1.0]),
    ("yellow", [1.0, 1.0, 0.0]),
];

/// Smallest plausible thickness, nm: two atoms.
const THINNEST_NM: f64 = 0.5;

/// Name in `gap_nm` in addition to those of the sub-pixels.
const DARK: &str = "dark";

impl Resolver<'_> {
    pub(super) fn film(&mut self, pixel: &describe::FilmPixel) -> Option<FilmPixel> {
        self.limit(&pixel.film, "layers", pixel.film.len(), 256)?;
        self.limit(&pixel.area, "sub-pixels", pixel.area.0.len(), 64)?;
        self.limit(&pixel.gap_nm, "gaps", pixel.gap_nm.0.len(), 65)?;
        self.limit(&pixel.states, "states", pixel.states.0.len(), 256)?;
        let layers = self.films(pixel);
        let materials = pixel.film.iter().map(|layer| &layer.material).chain([&pixel.substrate]);
        let materials = materials.map(|material| name(&material.value)).collect();
        let substrate = self.material(&pixel.substrate);
        let inactive_reflectance = self.share(&pixel.inactive_reflectance, pixel.inactive_reflectance.origin);
        let sub_pixels = self.sub_pixels(pixel)?;
        let states = self.states(pixel, &sub_pixels);
        Some(FilmPixel {
            layers: layers?,
            substrate: substrate?,
            materials,
            sub_pixels,
            dark_gap_nm: pixel.gap_nm.get(DARK).map(|gap| gap.0),
            fill_factor: pixel.fill_factor.0,
            inactive_reflectance: inactive_reflectance?,
            states: states?,
        })
    }

    fn films(&mut self, pixel: &describe::FilmPixel) -> Option<Vec<FilmLayer>> {
        let mut gaps = 0;
        let mut layers = Vec::with_capacity(pixel.film.len());
        for (i, layer) in pixel.film.iter().enumerate() {
            let thickness = match layer.thickness_nm.value {
                describe::LayerThickness::Fixed(nm) => {
                    self.check_nm(&format!("display.pixel.film.{i}.thickness_nm"), nm.0);
                    Thickness::Fixed(nm.0)
                }
                describe::LayerThickness::Gap(_) => {
                    gaps += 1;
                    Thickness::Gap
                }
            };
            layers.push(self.material(&layer.material).map(|index| FilmLayer { index, thickness }));
        }
        if gaps != 1 {
            let thicknesses = pixel.film.iter().map(|layer| layer.thickness_nm.origin);
            let wrong = Diagnostic::new(format!("{gaps} layers of this film have thickness_nm = \"gap\""));
            let wrong = wrong.expected("one layer with thickness_nm = \"gap\"");
            self.errors.push(pixel.film.origin.or_override(thicknesses), wrong);
        }
        layers.into_iter().collect()
    }

    /// Resolves the sub-pixels, each with an area and a gap; `None` if the two tables do not match.
    fn sub_pixels(&mut self, pixel: &describe::FilmPixel) -> Option<Vec<SubPixel>> {
        let (area, gap_nm) = (&pixel.area.value, &pixel.gap_nm.value);
        for gap in &gap_nm.0 {
            self.check_nm(&format!("display.pixel.gap_nm.{}", gap.name), gap.value.0);
        }
        if area.0.is_empty() {
            let wrong = Diagnostic::new("this pixel has no sub-pixels");
            self.err(
                &pixel.area,
                wrong.expected("a fraction of the area for each, such as { red = 0.5, green = 0.5 }"),
            );
            return None;
        }
        let mut sub_pixels = Vec::with_capacity(area.0.len());
        for Item { name, name_origin, value } in &area.0 {
            match gap_nm.get(name) {
                _ if name == DARK => self.errors.push(*name_origin, dark_is_no_sub_pixel()),
                Some(gap) => sub_pixels.push(SubPixel { name: name.clone(), area: value.0, gap_nm: gap.0 }),
                None => {
                    let at = name_origin.or_override([pixel.gap_nm.origin]);
                    self.errors.push(at, no_sub_pixel(name, "gap_nm", &gap_nm.names()));
                }
            }
        }
        for Item { name, name_origin, .. } in gap_nm.0.iter().filter(|item| item.name != DARK) {
            if area.get(name).is_none() {
                let at = name_origin.or_override([pixel.area.origin]);
                self.errors.push(at, no_sub_pixel(name, "area", &area.names()));
            }
        }
        let sum: f64 = area.0.iter().map(|item| item.value.0).sum();
        if (sum - 1.0).abs() > 1e-3 {
            let at = pixel.area.origin.or_override(area.0.iter().map(|item| item.value.origin));
            let wrong = mistake::sum("the areas", sum, "1 within 0.001");
            self.errors.push(
                at,
                wrong.hint(
                    "areas are fractions of the pixel: what changes one of them changes another by as much, as `compensated_by` of a \
                     variable of [optimize] or [fit] does; [tolerance] varies none alone",
                ),
            );
        } else if (sum - 1.0).abs() > 1e-9 {
            self.warnings
                .push(format!("the areas of the sub-pixels sum to {}, and are used as given", tidy(sum)));
        }
        (sub_pixels.len() == area.0.len()).then_some(sub_pixels)
    }

    fn states(&mut self, pixel: &describe::FilmPixel, sub_pixels: &[SubPixel]) -> Option<Vec<FilmState>> {
        let mut states = if pixel.default_states.value { default_states(sub_pixels) } else { Vec::new() };
        for item in &pixel.states.0 {
            let state =
                FilmState { name: item.name.clone(), drives: self.drives(item, sub_pixels)?, areas: None };
            match states.iter_mut().find(|known| known.name == item.name) {
                Some(known) => *known = state,
                None => states.push(state),
            }
        }
        if states.is_empty() {
            let at = pixel.states.origin.or_override([pixel.default_states.origin, pixel.area.origin]);
            let remedy = "add one under `[display.pixel.states]`, or name sub-pixels red, green and blue";
            self.errors.push(at, mistake::no_states(remedy));
        }
        if pixel.gap_nm.get(DARK).is_none() {
            self.check_no_dark(pixel, &states, sub_pixels);
        }
        Some(states)
    }

    /// Resolves the drive of each sub-pixel in a state of the user; sub-pixels that it does not name are
    /// dark.
    fn drives(&mut self, state: &Item<StateSpec>, sub_pixels: &[SubPixel]) -> Option<Vec<Drive>> {
        let mut drives = vec![Drive::Share(0.0); sub_pixels.len()];
        for item in &state.value.0.0 {
            let drive = match &item.value.value {
                DriveSpec::Share(share) => Drive::Share(share.0),
                DriveSpec::Gap(gap) => {
                    self.check_nm(
                        &format!("display.pixel.states.{}.{}.gap_nm", state.name, item.name),
                        gap.gap_nm.0,
                    );
                    Drive::Gap(gap.gap_nm.0)
                }
            };
            match sub_pixels.iter().position(|sub_pixel| sub_pixel.name == item.name) {
                Some(i) => drives[i] = drive,
                None if item.name == DARK => {
                    self.errors.push(item.name_origin, dark_is_no_sub_pixel());
                    return None;
                }
                None => {
                    let known: Vec<String> = sub_pixels.iter().map(|one| one.name.clone()).collect();
                    self.errors.push(item.name_origin, no_sub_pixel(&item.name, "area", &known));
                    return None;
                }
            }
        }
        Some(drives)
    }

    /// Warns of a film or gap that is probably in micrometres; 0 is allowed.
    pub(super) fn check_nm(&mut self, key: &str, nm: f64) {
        if nm > 0.0 && nm < THINNEST_NM {
            let meant = tidy(1e3 * nm);
            self.warnings
                .push(format!("{key} is {nm} nm, which looks like micrometres: {nm} um = {meant} nm"));
        }
    }

    fn check_no_dark(&mut self, pixel: &describe::FilmPixel, states: &[FilmState], sub_pixels: &[SubPixel]) {
        for state in states {
            let dark =
                state.drives.iter().position(|drive| matches!(drive, Drive::Share(share) if *share < 1.0));
            if let Some(i) = dark {
                let (state, sub_pixel) = (&state.name, &sub_pixels[i].name);
                let wrong = format!("state `{state}` leaves `{sub_pixel}` dark, but there is no dark gap");
                let wrong = Diagnostic::new(wrong).hint("add `dark = 20.0`, in nm, to `gap_nm`");
                let drives = pixel.states.0.iter().flat_map(|state| &state.value.0.0);
                let at = pixel.gap_nm.origin.or_override(drives.map(|drive| drive.value.origin));
                return self.errors.push(at, wrong);
            }
        }
    }
}

/// Name of a material in reports: as in the scenario, or its index.
fn name(material: &MaterialSpec) -> String {
    match material {
        MaterialSpec::Text(name) => name.clone(),
        MaterialSpec::Number(n) => format!("n = {}", tidy(n.0)),
        MaterialSpec::Model(model) => model.name().to_owned(),
        MaterialSpec::Complex(table) => match table.index_of() {
            Ok(IndexOf::Material(name)) => name.to_owned(),
            Ok(IndexOf::Constant { n, k }) => format!("n = {} + {}i", tidy(n), tidy(k)),
            Err(_) => "an index".to_owned(),
        },
    }
}

/// Error: a sub-pixel is in one table and not in another.
pub(super) fn no_sub_pixel(name: &str, of: &str, known: &[String]) -> Mistake {
    let hint = suggestion(name, known.iter().map(String::as_str), "sub-pixels");
    mistake::of_path(Diagnostic::new(format!("there is no sub-pixel `{name}` in `{of}`")).hint(hint))
}

fn dark_is_no_sub_pixel() -> Diagnostic {
    Diagnostic::new("`dark` is not a sub-pixel: it has no area and is not driven")
}

/// Returns the distinct gaps of all states of a film, nm, in any order.
pub(super) fn distinct_gaps(film: &FilmPixel) -> Vec<f64> {
    let mut gaps = HashSet::new();
    for (drive, sub_pixel) in film.states.iter().flat_map(|state| state.drives.iter().zip(&film.sub_pixels)) {
        let (own, dark) = match drive {
            Drive::Share(share) => {
                ((*share > 0.0).then_some(sub_pixel.gap_nm), film.dark_gap_nm.filter(|_| *share < 1.0))
            }
            Drive::Gap(gap) => (Some(*gap), None),
        };
        gaps.extend(own.into_iter().chain(dark).map(f64::to_bits));
    }
    gaps.into_iter().map(f64::from_bits).collect()
}

/// Returns the eight default states, if there are sub-pixels red, green and blue; other sub-pixels are dark.
fn default_states(sub_pixels: &[SubPixel]) -> Vec<FilmState> {
    let position = |name| sub_pixels.iter().position(|sub_pixel| sub_pixel.name == name);
    let (Some(red), Some(green), Some(blue)) = (position("red"), position("green"), position("blue")) else {
        return Vec::new();
    };
    let state = |(name, shares): (&str, [f64; 3])| {
        let mut drives = vec![Drive::Share(0.0); sub_pixels.len()];
        for (i, share) in [red, green, blue].into_iter().zip(shares) {
            drives[i] = Drive::Share(share);
        }
        FilmState { name: name.to_owned(), drives, areas: None }
    };
    DEFAULT_STATES.map(state).to_vec()
}
