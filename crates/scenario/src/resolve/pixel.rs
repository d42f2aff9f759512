//! The pixel: uniform states, tables and their range of angles, and the medium above a measured pixel.

use papilio_colour::Observer;
use papilio_diagnostics::Diagnostic;
use papilio_display::scene::{
    self, AngleMedium, Lobe, Pixel, Ready, ReflectingDiffuser, Scene, TableAngles, TablePixel, TableState,
    UniformKind, UniformPixel,
};
use papilio_formats::read_pixel_over_half_turn;
use papilio_spectra::{Grid, Spectrum};

use super::{Resolver, sampling};
use crate::describe::File;
use crate::describe::diffuser::Diffuser;
use crate::describe::pixel as describe;
use crate::mistake::{self, tidy};
use crate::read::Spanned;

/// Largest error of X, Y and Z between the angles of a table, relative to a perfect white, without a note.
const COARSE_ANGLES: f64 = 0.005;

/// Largest number of values in a table of a pixel: 80 MB.
const MOST_NUMBERS: usize = 10_000_000;

/// Angle of a view in air from which on a face polarises light noticeably, degrees: at 40, s and p pass it as 0.91 to 0.98.
const OBLIQUE_DEG: f64 = 40.0;

impl Resolver<'_> {
    pub(super) fn pixel(&mut self, pixel: &Spanned<describe::Pixel>) -> Option<Pixel> {
        match &pixel.value {
            describe::Pixel::Film(film) => self.film(film).map(Pixel::Film),
            describe::Pixel::Table(table) => self.table_pixel(table).map(Pixel::Table),
            describe::Pixel::Uniform(uniform) => self.uniform(uniform).map(Pixel::Uniform),
            describe::Pixel::Measured(measured) => self.measured_pixel(measured).map(Pixel::Scattering),
            describe::Pixel::Palette(palette) => self.palette(palette).map(Pixel::Uniform),
            describe::Pixel::Crystal(crystal) => self.crystal(crystal).map(Pixel::Crystal),
        }
    }

    fn uniform(&mut self, pixel: &describe::UniformPixel) -> Option<UniformPixel> {
        self.limit(&pixel.reflectance, "states", pixel.reflectance.0.len(), 256)?;
        if pixel.reflectance.0.is_empty() {
            let remedy = "name a state with its reflectance: reflectance = { white = 0.45 }";
            self.err(&pixel.reflectance, mistake::no_states(remedy));
        }
        let is_mirror = pixel.kind.0 == UniformKind::Mirror;
        for (key, origin) in [
            ("measured_through", pixel.measured_through.as_ref().map(|_| pixel.measured_through.origin)),
            ("spread_um", pixel.spread_um.as_ref().map(|_| pixel.spread_um.origin)),
        ] {
            let Some(origin) = origin.filter(|_| is_mirror) else { continue };
            let wrong = Diagnostic::new(format!(
                "`{key}` is for pixels that scatter light, but these are mirror-like"
            ));
            self.errors.push(origin, wrong.expected("kind = \"lambertian\"").hint(format!("remove `{key}`")));
        }
        let face = self.face(&pixel.measured_through);
        let states = pixel.reflectance.0.iter();
        let states: Vec<_> = states
            .map(|item| {
                let measured = self.share(&item.value, item.value.origin)?;
                let own = self.below(face, (item.name.as_str(), measured), item.value.origin)?;
                Some((item.name.clone(), own))
            })
            .collect();
        Some(UniformPixel {
            spread_mm: self.spread_within(&pixel.spread_um)?,
            kind: pixel.kind.0,
            states: states.into_iter().collect::<Option<_>>()?,
        })
    }

    fn table_pixel(&mut self, pixel: &describe::TablePixel) -> Option<TablePixel> {
        let table = self.data_with_notes(&pixel.file, pixel.file.origin, read_pixel_over_half_turn)?;
        let directions = table.theta_deg.len().saturating_mul(table.phi_deg.len().max(1));
        let size = table.states.len().saturating_mul(directions).saturating_mul(self.grid.len());
        self.limit(&pixel.file, "numbers (states x angles x wavelengths)", size, MOST_NUMBERS)?;
        self.limit(&pixel.file, "states", table.states.len(), 256)?;
        self.is_tabulated = true;
        let mut states = Vec::with_capacity(table.states.len());
        for (i, (name, _)) in table.states.iter().enumerate() {
            let spectra = table.spectra(i, &self.grid);
            // The direction nearest to the normal stands for all.
            let nearest = table.spectrum(i, 0).filter(|own| !sampling::has_all_points(&self.grid, own));
            self.tables.extend(nearest.map(|own| (pixel.file.value.clone(), own)));
            let reflectance = self.sampled(&pixel.file, pixel.file.origin, spectra)?;
            states.push(TableState { name: name.clone(), reflectance });
        }
        let (angles, theta_deg, phi_deg) = (pixel.angles.0, table.theta_deg, table.phi_deg);
        if let Some((error, name, theta)) = error_between_angles(&states, &theta_deg, &self.grid)
            && error > COARSE_ANGLES
        {
            self.notes.push(format!(
                "{}: the reflectances change too fast between the angles of the table: near {theta} deg, the error of X, Y or Z of \
                 `{name}` is about {error:.3} relative to a perfect white; expected a table with finer steps",
                *pixel.file
            ));
        }
        Some(TablePixel { angles, theta_deg, phi_deg, states })
    }

    /// Checks that the medium above a measured pixel has one index, because its directions are those of that
    /// medium.
    pub(super) fn check_medium(&mut self, file: &File, scene: &Scene) {
        let Pixel::Scattering(_) = scene.display.pixel else { return };
        let index = scene.display.index_above_pixel();
        if !index.is_constant() {
            let display = &file.display;
            let causes = [display.glass.origin, display.layers.origin];
            let glass = display.glass.as_ref().map(|glass| glass.index.origin);
            let at = display.pixel.model().or_override(glass.into_iter().chain(causes));
            self.errors.push(at, dispersive("the medium above this pixel", index));
        }
    }

    /// Notes that a table has no polarisation, where what lies above it, or a polariser before the eye, makes that matter.
    pub(super) fn note_unpolarised(&mut self, scene: &Scene) {
        let Pixel::Table(_) = &scene.display.pixel else { return };
        let is_face = |layer: &scene::Layer| {
            matches!(layer.interface, scene::Interface::Ready(Ready::Fresnel) | scene::Interface::Coating(_))
        };
        let is_oblique = scene.viewer.theta_deg.iter().any(|theta_deg| *theta_deg >= OBLIQUE_DEG);
        let why = if !scene.display.is_flat() {
            return;
        } else if scene.viewer.polariser_deg.is_some() {
            "Through `viewer.polariser`"
        } else if is_oblique && scene.display.layers.iter().any(is_face) {
            "Below flat faces, which polarise oblique light"
        } else {
            return;
        };
        self.notes.push(format!(
            "a table has no polarisation: it reflects s and p equally. {why}, a pixel that does not, such as a liquid crystal with its polariser, looks \
             different; expected its layers, model = \"liquid-crystal\" or \"film\""
        ));
    }

    /// Checks that a pixel table covers the angles of the light in the stack.
    ///
    /// All light in a bare panel, and below a Lambertian diffuser, has |beta| <= 1:
    /// 90 deg in air. A k-correlation lobe fills the glass. With unrefracted angles,
    /// those in air also extend to 90 deg "in glass".
    pub(super) fn check_reach(&mut self, file: &File, scene: &Scene) {
        let (Pixel::Table(table), describe::Pixel::Table(described)) =
            (&scene.display.pixel, &file.display.pixel.value)
        else {
            return;
        };
        let display = &file.display;
        let mut causes = vec![display.layers.origin, display.diffuser.origin, display.glass.origin];
        causes.extend(display.diffuser.as_ref().map(Diffuser::model));
        causes.extend(display.glass.as_ref().map(|glass| glass.index.origin));
        causes.push(file.solver.angle_medium.origin);
        let fills_glass =
            fills_glass(&scene.display.layers) || scene.solver.angle_medium == AngleMedium::Unrefracted;
        let (medium, needed_deg) = match table.angles {
            TableAngles::Air if fills_glass => {
                let wrong = Diagnostic::new("angles in air do not cover light beyond the critical angle of total internal reflection")
                    .expected("angles = \"glass\"")
                    .hint(
                        "give the table with angles in glass, up to 90 deg; `papilio pixel` with angles in glass writes such a table",
                    );
                return self.errors.push(described.angles.origin.or_override(causes), wrong);
            }
            TableAngles::Air => ("air", 90.0),
            TableAngles::Glass if fills_glass => ("glass", 90.0),
            TableAngles::Glass => ("glass", critical_deg(scene.display.index_above_pixel())),
        };
        let last_deg = table.theta_deg.last().copied().unwrap_or_default();
        if last_deg < needed_deg {
            let at = described.file.origin.or_override(causes).or_override([described.angles.origin]);
            let wrong =
                Diagnostic::new(format!("the angles of this table end at {last_deg} deg in {medium}"))
                    .expected(format!("{needed_deg:.2} deg or more"))
                    .hint("tables are not extrapolated: compute larger angles with the tool that made it");
            self.errors.push(at, wrong);
        }
    }
}

/// Error: a medium must have one index at all wavelengths.
pub(super) fn dispersive(what: &str, index: &Spectrum) -> Diagnostic {
    let (least, largest) = (tidy(index.min()), tidy(index.max()));
    Diagnostic::new(format!("{what} has an index of {least} to {largest}"))
        .expected("the same index at all wavelengths")
        .hint("give the index as a number, for example that at 550 nm")
}

/// Largest angle in glass of light with |beta| <= 1 over all wavelengths, degrees.
fn critical_deg(index: &Spectrum) -> f64 {
    (1.0 / index.min()).asin().to_degrees()
}

/// True if a diffuser that reflects scatters light beyond |beta| = 1.
fn fills(diffuser: &ReflectingDiffuser, wide: impl Fn(&scene::Diffuser) -> bool) -> bool {
    let through = match diffuser.transmission() {
        Ready::Diffuser(diffuser) => wide(diffuser),
        _ => false,
    };
    let [_, below] = diffuser.reflections();
    through || below.as_ref().is_some_and(|below| below.scattered().max() > 0.0)
}

/// True if a layer scatters light beyond |beta| = 1.
fn fills_glass(layers: &[scene::Layer]) -> bool {
    let wide = |diffuser: &scene::Diffuser| matches!(diffuser.lobe, Lobe::KCorrelation { .. });
    layers.iter().any(|layer| {
        layer.medium.scattering.is_some()
            || match &layer.interface {
                scene::Interface::Ready(Ready::Diffuser(diffuser)) => wide(diffuser),
                scene::Interface::Ready(Ready::Reflecting(diffuser)) => fills(diffuser, wide),
                scene::Interface::Rough { .. } => true,
                _ => false,
            }
    })
}

/// Returns about the largest error of X, Y and Z of reflectances that are linear between these angles, in
/// light of equal energy and relative to a perfect white, with its state and angle. Without every second
/// angle, the error would be four times as large.
fn error_between_angles<'a>(
    states: &'a [TableState],
    theta_deg: &[f64],
    grid: &Grid,
) -> Option<(f64, &'a str, f64)> {
    let observer = Observer::new(grid).ok()?;
    let white = observer.xyz(&vec![1.0; grid.len()]);
    let azimuths = |state: &TableState| state.reflectance.len() / theta_deg.len();
    let mut worst: Option<(f64, &str, f64)> = None;
    for state in states {
        let row = azimuths(state);
        for (k, angles) in theta_deg.windows(3).enumerate() {
            let share = (angles[1] - angles[0]) / (angles[2] - angles[0]);
            for azimuth in 0..row {
                let at = |angle: usize| &state.reflectance[(k + angle) * row + azimuth];
                let missed: Vec<f64> = (at(0).iter().zip(at(1).iter()).zip(at(2).iter()))
                    .map(|((before, here), after)| here - (1.0 - share) * before - share * after)
                    .collect();
                let off = observer.xyz(&missed);
                let parts = [off.x / white.x, off.y / white.y, off.z / white.z];
                let error = parts.into_iter().map(|part| 0.25 * part.abs()).fold(0.0, f64::max);
                if worst.is_none_or(|(most, ..)| error > most) {
                    worst = Some((error, &state.name, angles[1]));
                }
            }
        }
    }
    worst
}
