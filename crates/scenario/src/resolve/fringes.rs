//! Films whose interference fringes over wavelength are too narrow for the grid.
//!
//! There are two steps. The distance of the fringes, `lambda^2/(2 sum of n d)`, shows at no cost that almost
//! all films are thin enough. For any other film the error is computed: the error of X, Y and Z for light
//! along the normal if the reflectance is known only at the wavelengths of the grid and linear between them,
//! as in the computation of colours.

use num_complex::Complex64;
use papilio_colour::Observer;
use papilio_display::scene::{FilmLayer, Interface, Pixel, Scene, Thickness};
use papilio_optics::film::{Film, Layer, Polarisation, coherent, fringe_spacing_nm};
use papilio_spectra::Grid;

use super::Resolver;
use super::film::distinct_gaps;

/// Wavelengths per fringe that are sufficient: the error of Y is 0.04 % or less (docs/films.md, "Thick
/// films").
const ENOUGH_PER_FRINGE: f64 = 12.0;

/// Largest error of X, Y and Z, relative to a perfect white, that gives no warning: the default relative
/// error.
const NEGLIGIBLE_ERROR: f64 = 1e-3;

/// Samples of the true spectrum in each fringe, and the largest number of them in each step.
const PER_FRINGE: f64 = 32.0;
const MOST_PER_STEP: f64 = 512.0;

/// Steps that may be recommended, nm. Colours are sums over integer nanometres, so that a finer step has no
/// effect.
const STEPS_NM: [f64; 3] = [2.5, 2.0, 1.0];

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
    pub(super) fn warn_of_fringes(&mut self, scene: &Scene) {
        let grid = &scene.grid;
        let Some((film, error)) = worst(scene, |film| {
            let is_held = film.spacing_nm(grid) >= ENOUGH_PER_FRINGE * grid.step_nm();
            if is_held { None } else { film.colour_error(grid, grid.step_nm()) }
        }) else {
            return;
        };
        if error <= NEGLIGIBLE_ERROR {
            return;
        }
        let finer = STEPS_NM.into_iter().filter(|step| *step < grid.step_nm());
        let enough = finer
            .into_iter()
            .find(|step| film.colour_error(grid, *step).is_some_and(|error| error <= NEGLIGIBLE_ERROR));
        let remedy = match enough {
            Some(step) => format!("set spectrum.step_nm = {step}"),
            None => "no step is fine enough, because colours are sums over integer nanometres: describe so thick a layer as a layer \
                     of the display, which does not interfere"
                .to_owned(),
        };
        let (nm, step_nm) = (grid.wavelength_nm(grid.len() / 2), grid.step_nm());
        self.warnings.push(format!(
            "{}: the film's interference fringes are {:.1} nm apart near {nm} nm, too close for spectrum.step_nm = {step_nm}: for \
             light along the normal, the error of X, Y or Z is {error:.4} relative to a perfect white (a wide lobe averages over \
             fringes, and has a smaller error); {remedy}",
            film.key,
            film.spacing_nm(grid)
        ));
    }
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

    /// Largest error of X, Y and Z in equal-energy light, relative to a perfect white, if the reflectance is
    /// known only in these steps.
    fn colour_error(&self, grid: &Grid, step_nm: f64) -> Option<f64> {
        let step_nm = step_nm.max(1.0);
        let (first, last) = (grid.start_nm().ceil().max(380.0), grid.stop_nm().floor().min(780.0));
        let every_nm = Grid::new(first, last, 1.0).ok()?;
        let observer = Observer::new(&every_nm).ok()?;
        let parts = (step_nm * PER_FRINGE / self.spacing_nm(grid)).ceil().clamp(2.0, MOST_PER_STEP) as usize;
        let (mut off, mut white) = ([0.0; 3], [0.0; 3]);
        let mut from = (first, self.reflectance(grid, first)?);
        while from.0 + step_nm <= last + 1e-6 {
            let to_nm = from.0 + step_nm;
            let to = (to_nm, self.reflectance(grid, to_nm)?);
            for part in 0..parts {
                let share = (part as f64 + 0.5) / parts as f64;
                let nm = from.0 + share * step_nm;
                let missed = (1.0 - share) * from.1 + share * to.1 - self.reflectance(grid, nm)?;
                let nearest = ((nm - first).round() as usize).min(every_nm.len() - 1);
                for (k, weight) in observer.weights().into_iter().enumerate() {
                    off[k] += weight[nearest] * missed;
                    white[k] += weight[nearest];
                }
            }
            from = to;
        }
        let errors = off.iter().zip(white).map(|(off, white)| (off / white).abs());
        errors.reduce(f64::max).filter(|error| error.is_finite())
    }
}
