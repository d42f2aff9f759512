//! Films and liquid crystals whose interference fringes over wavelength are too narrow for the grid.
//!
//! For films, there are two steps. The distance of the fringes, `lambda^2/(2 sum of n d)`, shows at no cost that almost
//! all films are thin enough. For any other film the error is computed: the error of X, Y and Z for light
//! along the normal if the reflectance is known only at the wavelengths of the grid and linear between them,
//! as in the computation of colours.

use num_complex::Complex64;
use papilio_display::scene::{CrystalPart, CrystalPixel, FilmLayer, Interface, Pixel, Scene, Thickness};
use papilio_optics::berreman::SpectralStack;
use papilio_optics::film::{Film, Layer, Polarisation, coherent, fringe_spacing_nm};
use papilio_spectra::{Grid, Tabulated};

use super::Resolver;
use super::film::distinct_gaps;
use super::sampling::{Judge, NEGLIGIBLE_ERROR};

/// Wavelengths per fringe that are sufficient: the error of Y is 0.04 % or less (docs/films.md, "Thick
/// films").
const ENOUGH_PER_FRINGE: f64 = 12.0;

/// Samples of the true spectrum in each fringe, and the largest number of them in each step.
const PER_FRINGE: f64 = 32.0;
const MOST_PER_STEP: f64 = 512.0;

/// A film of the scene, and the media on its two sides.
struct FilmStack<'a> {
    key: &'a str,
    layers: &'a [FilmLayer],
    gap_nm: f64,
    above: &'a [f64],
    below: Vec<Complex64>,
}

impl Resolver<'_> {
    /// Warns of the film with the largest colour error due to the wavelength grid, if there is one.
    pub(super) fn warn_of_fringes(&mut self, scene: &Scene, judge: &Judge) {
        let grid = &scene.grid;
        self.warn_of_crystal(scene, judge);
        let Some((film, error)) = worst(scene, |film| {
            let is_held = film.spacing_nm(grid) >= ENOUGH_PER_FRINGE * grid.step_nm();
            if is_held { None } else { film.colour_error(grid, judge, grid.step_nm()) }
        }) else {
            return;
        };
        if error <= NEGLIGIBLE_ERROR {
            return;
        }
        let enough = judge.fine_step(|step| film.colour_error(grid, judge, step));
        let remedy = match enough {
            Some(step) => format!("set spectrum.step_nm = {step}"),
            None => "no step is fine enough, because colours are sums over integer nanometres: describe so thick a layer as a layer \
                     of the display, which does not interfere"
                .to_owned(),
        };
        let (nm, step_nm) = (grid.wavelength_nm(grid.len() / 2), grid.step_nm());
        self.warnings.push(format!(
            "{}: the film's reflectance changes too fast for spectrum.step_nm = {step_nm} (its interference fringes are {:.1} nm apart \
             near {nm} nm): for light along the normal, the error of X, Y or Z is {error:.4} relative to a perfect white (a wide lobe averages over \
             fringes, and has a smaller error); {remedy}",
            film.key,
            film.spacing_nm(grid)
        ));
    }

    /// Warns of a liquid-crystal pixel whose reflectance changes too fast for the grid: compared with steps of 1 nm.
    fn warn_of_crystal(&mut self, scene: &Scene, judge: &Judge) {
        let (Pixel::Crystal(pixel), step_nm) = (&scene.display.pixel, scene.grid.step_nm()) else { return };
        if step_nm <= 1.0 {
            return;
        }
        let Some(states) = every_nm(pixel, scene) else { return };
        let errors = states.iter().zip(&pixel.states).filter_map(|(reflectance, name)| {
            let error = |step: f64| judge.error_of_table(reflectance, step);
            Some((error(step_nm)?, name, judge.fine_step(error)))
        });
        let Some((error, name, enough)) = errors.max_by(|a, b| a.0.total_cmp(&b.0)) else { return };
        if error <= NEGLIGIBLE_ERROR {
            return;
        }
        let enough = enough.unwrap_or(1.0);
        self.warnings.push(format!(
            "display.pixel: the reflectance of `{name}` changes too fast for spectrum.step_nm = {step_nm}: for light along the normal, the error of \
             X, Y or Z is {error:.4} relative to a perfect white; set spectrum.step_nm = {enough}"
        ));
    }
}

/// Reflectances of the states of a liquid-crystal pixel along the normal at every nanometre, with indices that are
/// linear between the wavelengths of the grid.
fn every_nm(pixel: &CrystalPixel, scene: &Scene) -> Option<Vec<Tabulated>> {
    let own = scene.grid.integers().ok()?;
    let wavelengths = own.wavelengths_nm();
    let between = |index: &[Complex64]| -> Vec<Complex64> {
        let at = |nm: &f64| scene.grid.between(*nm).map(|(bin, share)| index[bin] * share).sum::<Complex64>();
        wavelengths.iter().map(at).collect()
    };
    let part = |part: &CrystalPart| CrystalPart {
        indices: part.indices.each_ref().map(|index| between(index)),
        ..part.clone()
    };
    let front: Vec<Complex64> = scene.display.index_above_pixel().iter().map(|n| (*n).into()).collect();
    let front: Vec<f64> = between(&front).into_iter().map(|n| n.re).collect();
    let parts: Vec<CrystalPart> = pixel.parts.iter().map(part).collect();
    let stack = SpectralStack::new(&wavelengths, &front, &parts, &between(&pixel.substrate)).ok()?;
    let mut out = vec![0.0; stack.states() * wavelengths.len()];
    stack.reflectance(&vec![0.0; wavelengths.len()], &[0.0], &mut out).ok()?;
    let rows = out.chunks_exact(wavelengths.len());
    let tables: Option<Vec<_>> =
        rows.map(|row| Tabulated::new(wavelengths.clone(), row.to_vec()).ok()).collect();
    tables
}

/// Returns the film and gap with the largest error.
fn worst<'a>(
    scene: &'a Scene,
    error: impl Fn(&FilmStack<'a>) -> Option<f64>,
) -> Option<(FilmStack<'a>, f64)> {
    let errors = films(scene).into_iter().filter_map(|film| error(&film).map(|error| (film, error)));
    errors.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// Returns all films of a scene with all their gaps.
fn films(scene: &Scene) -> Vec<FilmStack<'_>> {
    let mut films = Vec::new();
    let mut above = None;
    for layer in &scene.display.layers {
        let below = &*layer.medium.index;
        if let Interface::Coating(coating) = &layer.interface {
            let below = below.iter().map(|n| (*n).into()).collect();
            films.push(FilmStack {
                key: &coating.key,
                layers: &coating.films,
                gap_nm: 0.0,
                above: above.unwrap_or(&[]),
                below,
            });
        }
        above = Some(below);
    }
    if let Pixel::Film(film) = &scene.display.pixel {
        films.extend(distinct_gaps(film).into_iter().map(|gap_nm| FilmStack {
            key: "display.pixel",
            layers: &film.layers,
            gap_nm,
            above: scene.display.index_above_pixel(),
            below: film.substrate.clone(),
        }));
    }
    films
}

impl FilmStack<'_> {
    fn thickness_nm(&self, layer: &FilmLayer) -> f64 {
        match layer.thickness {
            Thickness::Fixed(nm) => nm,
            Thickness::Gap => self.gap_nm,
        }
    }

    /// Distance of the fringes at the centre of the grid, nm.
    fn spacing_nm(&self, grid: &Grid) -> f64 {
        let bin = grid.len() / 2;
        let layers = self.layers.iter().map(|layer| (layer.index[bin], self.thickness_nm(layer)));
        fringe_spacing_nm(layers, grid.wavelength_nm(bin))
    }

    /// Reflectance along the normal, with indices that are interpolated linearly between the wavelengths of
    /// the grid.
    fn reflectance(&self, grid: &Grid, nm: f64) -> Option<f64> {
        let at = ((nm - grid.start_nm()) / grid.step_nm()).clamp(0.0, (grid.len() - 1) as f64);
        let bin = (at as usize).min(grid.len() - 2);
        let share = at - bin as f64;
        let between = |index: &[Complex64]| index[bin] * (1.0 - share) + index[bin + 1] * share;
        let layer = |layer: &FilmLayer| Layer {
            index: between(&layer.index),
            thickness_nm: self.thickness_nm(layer),
        };
        let film = Film {
            // Air is above all layers.
            incidence: self.above.get(bin).copied().unwrap_or(1.0),
            layers: self.layers.iter().map(layer).collect(),
            substrate: between(&self.below),
        };
        coherent(&film, nm, 0.0, Polarisation::S).ok().map(|film| film.reflectance)
    }

    /// Error of X, Y and Z ([`Judge::error`]), from [`PER_FRINGE`] samples of each fringe.
    fn colour_error(&self, grid: &Grid, judge: &Judge, step_nm: f64) -> Option<f64> {
        let parts = (step_nm.max(1.0) * PER_FRINGE / self.spacing_nm(grid)).ceil().clamp(2.0, MOST_PER_STEP);
        judge.error(step_nm, parts as usize, |nm| self.reflectance(grid, nm))
    }
}
