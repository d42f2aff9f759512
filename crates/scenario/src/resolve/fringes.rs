//! Films and liquid crystals whose interference fringes over wavelength are too narrow for the grid.
//!
//! For films, there are two steps. The distance of the fringes, `lambda^2/(2 sum of n d)`, shows at no cost that almost
//! all films below scatterers, and almost all coatings, are thin enough. For any other film the error is computed: the error of X, Y and Z for
//! light along the normal and at the inclinations of the views if the reflectance is known only at the wavelengths of the grid and
//! linear between them, as in the computation of colours. A film pixel below flat layers is always computed: between metals or
//! mirrors of films, its resonances are much narrower than its fringes are apart. Errors of the parts of a state have signs.

use num_complex::Complex64;
use papilio_display::scene::{
    AngleMedium, CrystalPart, CrystalPixel, Drive, FilmLayer, FilmPixel, Interface, Pixel, Scene, Thickness,
};
use papilio_optics::berreman::SpectralStack;
use papilio_optics::film::{Film, Layer, Polarisation, coherent, fringe_spacing_nm};
use papilio_spectra::{Grid, Tabulated};

use super::Resolver;
use super::film::distinct_gaps;
use super::sampling::{Judge, NEGLIGIBLE_ERROR, largest};

/// Wavelengths per fringe that are sufficient: the error of Y is 0.04 % or less (docs/films.md, "Thick
/// films").
const ENOUGH_PER_FRINGE: f64 = 12.0;

/// Samples of the true spectrum in each fringe, and the largest number of them in each step.
const PER_FRINGE: f64 = 32.0;
const MOST_PER_STEP: f64 = 512.0;

/// Safety factor of the changes of a film pixel within a step, where the indices of its materials are interpolated, too.
const MARGIN: f64 = 1.1;

/// Largest number of inclinations at which films are tested.
const MOST_INCLINATIONS: usize = 8;

/// Inclination of light, degrees, and the medium of its angle.
#[derive(Clone, Copy)]
struct Inclination {
    theta_deg: f64,
    in_air: bool,
}

/// Errors of X, Y and Z, and the inclination where the largest of them is largest.
#[derive(Clone, Copy)]
struct Errors {
    xyz: [f64; 3],
    at: Inclination,
}

/// A film of the scene, and the media on its two sides.
struct FilmStack<'a> {
    key: &'a str,
    is_pixel: bool,
    layers: &'a [FilmLayer],
    gap_nm: f64,
    above: &'a [f64],
    below: Vec<Complex64>,
}

impl Resolver<'_> {
    /// Warns of the film with the largest colour error due to the wavelength grid, if there is one, and of a liquid crystal. Returns the errors
    /// of each state below flat layers. Scatterers average them over angle: there, they are upper bounds, and returned if there is a warning.
    pub(super) fn warn_of_fringes(&mut self, scene: &Scene, judge: &Judge) -> Vec<[f64; 3]> {
        let (grid, warnings_before) = (&scene.grid, self.warnings.len());
        let mut of_states = self.warn_of_crystal(scene, judge);
        let inclinations = inclinations(scene);
        let is_close = |film: &FilmStack<'_>| film.spacing_nm(grid) < ENOUGH_PER_FRINGE * grid.step_nm();
        let is_flat = scene.display.is_flat();
        let films: Vec<(FilmStack<'_>, Errors)> = films(scene)
            .into_iter()
            .filter(|film| is_close(film) || film.is_pixel && is_flat)
            .filter_map(|film| {
                let errors = film.errors(grid, judge, grid.step_nm(), &inclinations)?;
                Some((film, errors))
            })
            .collect();
        if let Pixel::Film(pixel) = &scene.display.pixel {
            of_states = vec![[0.0; 3]; pixel.states.len()];
            // Below flat layers, each view sees light of its own inclination.
            for at in inclinations.iter().filter(|at| !is_flat || is_seen(scene, at)) {
                let of_pixel = films.iter().filter(|(film, _)| film.is_pixel);
                let of_gaps: Vec<(f64, [f64; 3])> = of_pixel
                    .filter_map(|(film, _)| {
                        Some((film.gap_nm, film.changes(grid, judge, grid.step_nm(), *at)?))
                    })
                    .collect();
                let of_gap = |gap_nm: f64| {
                    of_gaps
                        .iter()
                        .find(|(known, _)| *known == gap_nm)
                        .map_or([0.0; 3], |(_, changes)| *changes)
                };
                for (largest, changes) in of_states.iter_mut().zip(changes_of_states(pixel, of_gap)) {
                    *largest = std::array::from_fn(|k| largest[k].max(MARGIN * changes[k].abs()));
                }
            }
        }
        if let Some((film, errors)) =
            films.iter().max_by(|a, b| largest(a.1.xyz).total_cmp(&largest(b.1.xyz)))
            && largest(errors.xyz) > NEGLIGIBLE_ERROR
        {
            let error = |step: f64| Some(largest(film.errors(grid, judge, step, &inclinations)?.xyz));
            let remedy = match judge.fine_step(error) {
                Some(step) => format!("set spectrum.step_nm = {step}"),
                None => "no step is fine enough, because colours are sums over integer nanometres: describe so thick a layer as a layer \
                     of the display, which does not interfere"
                    .to_owned(),
            };
            let (nm, step_nm) = (grid.wavelength_nm(grid.len() / 2), grid.step_nm());
            let cause = match is_close(film) {
                true => {
                    format!("its interference fringes are {:.1} nm apart near {nm} nm", film.spacing_nm(grid))
                }
                false => "it has narrow resonances".to_owned(),
            };
            self.warnings.push(format!(
                "{}: the film's reflectance changes too fast for spectrum.step_nm = {step_nm} ({cause}): {}, the error of X, Y or Z is {:.4} relative to a perfect white (a wide lobe averages over \
                 fringes, and has a smaller error); {remedy}",
                film.key,
                errors.at,
                largest(errors.xyz),
            ));
        }
        if !is_flat && self.warnings.len() == warnings_before {
            return Vec::new();
        }
        // Coatings, through which all states are seen.
        for (_, errors) in films.iter().filter(|(film, _)| !film.is_pixel) {
            of_states.resize(scene.display.state_names().len(), [0.0; 3]);
            of_states.iter_mut().for_each(|of_state| *of_state = added(*of_state, errors.xyz, 1.0));
        }
        of_states
    }

    /// Warns of a liquid-crystal pixel whose reflectance changes too fast for the grid: compared with steps of 1 nm. Returns the errors of its states.
    fn warn_of_crystal(&mut self, scene: &Scene, judge: &Judge) -> Vec<[f64; 3]> {
        let (Pixel::Crystal(pixel), step_nm) = (&scene.display.pixel, scene.grid.step_nm()) else {
            return Vec::new();
        };
        if step_nm <= 1.0 {
            return Vec::new();
        }
        // Along the normal, and the steepest view.
        let all = inclinations(scene);
        let mut of_states: Vec<(Errors, Tabulated)> = Vec::new();
        for at in [all.first(), all.last().filter(|_| all.len() > 1)].into_iter().flatten() {
            let phi_deg = scene.viewer.phi_deg.first().copied().unwrap_or(0.0);
            let Some(states) = every_nm(pixel, scene, (*at, phi_deg)) else { continue };
            for (state, table) in states.into_iter().enumerate() {
                let xyz = judge.errors_of_table(&table, step_nm).unwrap_or_default();
                let xyz = xyz.map(|error| pixel.fill_factor * error);
                let errors = Errors { xyz, at: *at };
                match of_states.get_mut(state) {
                    Some(known) if largest(known.0.xyz) < largest(xyz) => *known = (errors, table),
                    Some(_) => {}
                    None => of_states.push((errors, table)),
                }
            }
        }
        let worst = of_states
            .iter()
            .zip(&pixel.states)
            .max_by(|a, b| largest(a.0.0.xyz).total_cmp(&largest(b.0.0.xyz)));
        if let Some(((errors, table), name)) = worst
            && largest(errors.xyz) > NEGLIGIBLE_ERROR
        {
            let enough = judge.fine_step(|step| judge.error_of_table(table, step)).unwrap_or(1.0);
            self.warnings.push(format!(
                "display.pixel: the reflectance of `{name}` changes too fast for spectrum.step_nm = {step_nm}: {}, the error of \
                 X, Y or Z is {:.4} relative to a perfect white; set spectrum.step_nm = {enough}",
                errors.at,
                largest(errors.xyz),
            ));
        }
        of_states.into_iter().map(|(errors, _)| errors.xyz).collect()
    }
}

/// Returns the normal and the inclinations of the views, in ascending order; not all of many.
fn inclinations(scene: &Scene) -> Vec<Inclination> {
    let mut all: Vec<f64> = scene.viewer.theta_deg.iter().map(|theta_deg| theta_deg.abs()).collect();
    all.push(0.0);
    all.sort_by(f64::total_cmp);
    all.dedup();
    let last = all.len() - 1;
    let count = all.len().min(MOST_INCLINATIONS);
    let in_air = scene.solver.angle_medium == AngleMedium::Air;
    let chosen = |k: usize| Inclination { theta_deg: all[k * last / (count - 1).max(1)], in_air };
    (0..count).map(chosen).collect()
}

/// Returns whether a view has this inclination.
fn is_seen(scene: &Scene, at: &Inclination) -> bool {
    scene.viewer.theta_deg.iter().any(|theta_deg| theta_deg.abs() == at.theta_deg)
}

impl Inclination {
    /// Returns `n sin(theta)` in a medium of this index, into which it is refracted from air. Grazing light is that at 89.9 deg.
    fn beta(self, index: f64) -> f64 {
        const GRAZING: f64 = 1.0 - 1e-6;
        let sine = self.theta_deg.to_radians().sin().min(GRAZING);
        if self.in_air { sine.min(GRAZING * index) } else { sine * index }
    }
}

impl std::fmt::Display for Inclination {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.theta_deg {
            0.0 => f.write_str("for light along the normal"),
            theta_deg => write!(f, "for light at {theta_deg} deg"),
        }
    }
}

/// Returns errors, and a factor of others, together.
fn added(errors: [f64; 3], more: [f64; 3], factor: f64) -> [f64; 3] {
    std::array::from_fn(|k| errors[k] + factor * more[k])
}

/// Returns the changes of X, Y and Z of the states of a film pixel from those of its gaps.
fn changes_of_states(pixel: &FilmPixel, of_gap: impl Fn(f64) -> [f64; 3]) -> Vec<[f64; 3]> {
    let of_state = |state: &papilio_display::scene::FilmState| {
        let mut sum = [0.0; 3];
        for (k, (drive, sub_pixel)) in state.drives.iter().zip(&pixel.sub_pixels).enumerate() {
            let usual = pixel.fill_factor * sub_pixel.area;
            let area = state.areas.as_ref().map_or(usual, |areas| areas[k]);
            let (gap_nm, share) = match drive {
                Drive::Share(share) => (sub_pixel.gap_nm, *share),
                Drive::Gap(gap_nm) => (*gap_nm, 1.0),
            };
            sum = added(sum, of_gap(gap_nm), area * share);
            if let Some(dark) = pixel.dark_gap_nm {
                sum = added(sum, of_gap(dark), area * (1.0 - share));
            }
        }
        sum
    };
    pixel.states.iter().map(of_state).collect()
}

/// Reflectances of the states of a liquid-crystal pixel at an inclination and azimuth at every nanometre, with indices that are
/// linear between the wavelengths of the grid.
fn every_nm(
    pixel: &CrystalPixel,
    scene: &Scene,
    (at, phi_deg): (Inclination, f64),
) -> Option<Vec<Tabulated>> {
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
    let beta: Vec<f64> = front.iter().map(|n| at.beta(*n)).collect();
    stack.reflectance(&beta, &[phi_deg], &mut out).ok()?;
    let rows = out.chunks_exact(wavelengths.len());
    let tables: Option<Vec<_>> =
        rows.map(|row| Tabulated::new(wavelengths.clone(), row.to_vec()).ok()).collect();
    tables
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
                is_pixel: false,
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
            is_pixel: true,
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

    /// Reflectance for unpolarised light, with indices that are interpolated linearly between the wavelengths of
    /// the grid.
    fn reflectance(&self, grid: &Grid, nm: f64, inclination: Inclination) -> Option<f64> {
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
        let beta = inclination.beta(film.incidence);
        let of = |polarisation| coherent(&film, nm, beta, polarisation).ok().map(|film| film.reflectance);
        let s = of(Polarisation::S)?;
        Some(if beta == 0.0 { s } else { 0.5 * (s + of(Polarisation::P)?) })
    }

    /// Changes of X, Y and Z ([`Judge::changes`]) at an inclination, from [`PER_FRINGE`] samples of each fringe, at least one per nanometre.
    fn changes(&self, grid: &Grid, judge: &Judge, step_nm: f64, at: Inclination) -> Option<[f64; 3]> {
        let (step_nm, of_fringes) = (step_nm.max(1.0), PER_FRINGE / self.spacing_nm(grid));
        let parts = (step_nm * of_fringes.max(1.0)).ceil().clamp(2.0, MOST_PER_STEP);
        judge.changes(step_nm, parts as usize, |nm| self.reflectance(grid, nm, at))
    }

    /// Errors of X, Y and Z, the magnitudes of these changes, at the inclination of the largest one.
    fn errors(
        &self,
        grid: &Grid,
        judge: &Judge,
        step_nm: f64,
        inclinations: &[Inclination],
    ) -> Option<Errors> {
        let errors = inclinations.iter().filter_map(|at| {
            let xyz = self.changes(grid, judge, step_nm, *at)?.map(f64::abs);
            Some(Errors { xyz, at: *at })
        });
        errors.max_by(|a, b| largest(a.xyz).total_cmp(&largest(b.xyz)))
    }
}
