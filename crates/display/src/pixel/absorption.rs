//! Absorptance of each layer of a film pixel, against angle.

use papilio_optics::film::{Film, Layer, absorbed};

use super::film::{Beta, Film as Films, Mixture};
use crate::DisplayError;
use crate::scene::{AngleMedium, FilmPixel, Pixel, Scene, Thickness};

/// Absorptance of each layer of a film pixel, in the medium of the scene's angles.
#[derive(Debug, Clone, PartialEq)]
pub struct PixelAbsorption {
    /// Angles, degrees.
    pub theta_deg: Vec<f64>,
    /// Wavelengths, nm.
    pub wavelength_nm: Vec<f64>,
    /// The layers, downwards from the glass, and the substrate.
    pub layers: Vec<PixelLayer>,
    /// One entry for each state and sub-pixel, sub-pixels varying fastest.
    pub sub_pixels: Vec<SubPixelAbsorption>,
}

/// Layer of a film pixel, or its substrate.
#[derive(Debug, Clone, PartialEq)]
pub struct PixelLayer {
    /// Number in `display.pixel.film`, from 0; `None`: the substrate.
    pub number: Option<usize>,
    /// Its material, as in the scenario.
    pub material: String,
}

/// Sub-pixel in a drive state: fractions of the light that falls on this sub-pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct SubPixelAbsorption {
    /// The state.
    pub state: String,
    /// The sub-pixel.
    pub sub_pixel: String,
    /// Fraction of the panel's area, which includes the fill factor.
    pub area: f64,
    /// Reflectance, `[angle][wavelength]`.
    pub reflectance: Vec<f64>,
    /// Absorptance, `[layer][angle][wavelength]`. The layers and the substrate sum to 1 - reflectance.
    pub absorptance: Vec<f64>,
}

/// Computes the absorptance of each layer of a film pixel alone, without front, surface or diffuser, at these
/// angles (0 to 90 deg) in the medium of the scene's angles: mean of s and p.
///
/// The inactive area is not part of it.
///
/// # Errors
/// If the pixel is not a film, or the film is invalid.
pub fn absorption(scene: &Scene, theta_deg: &[f64]) -> Result<PixelAbsorption, DisplayError> {
    let Pixel::Film(film) = &scene.display.pixel else {
        return Err(DisplayError::AbsorptionWithoutFilm);
    };
    let mixture = Mixture::new(film)?;
    let of_gaps = OfGaps::new(scene, film, &mixture.gaps_nm, theta_deg)?;
    let names = film.states.iter().enumerate().flat_map(|(state, named)| {
        film.sub_pixels.iter().enumerate().map(move |(number, sub_pixel)| (state, named, number, sub_pixel))
    });
    let sub_pixels = names.map(|(state, named, number, sub_pixel)| {
        let parts = mixture.parts.iter().filter(|part| part.state == state && part.sub_pixel == number);
        let parts: Vec<(usize, f64)> = parts.map(|part| (part.gap, part.on)).collect();
        SubPixelAbsorption {
            state: named.name.clone(),
            sub_pixel: sub_pixel.name.clone(),
            area: film.fill_factor * sub_pixel.area,
            reflectance: mixed(&of_gaps.reflectance, &parts),
            absorptance: mixed(&of_gaps.absorptance, &parts),
        }
    });
    let sub_pixels: Vec<SubPixelAbsorption> = sub_pixels.collect();
    let values = sub_pixels.iter().flat_map(|one| one.reflectance.iter().chain(&one.absorptance));
    if !values.into_iter().all(|value| value.is_finite()) {
        return Err(DisplayError::NotFinite);
    }
    let material = |number: usize| film.materials.get(number).cloned().unwrap_or_default();
    let layers = (0..=film.layers.len()).map(|number| PixelLayer {
        number: (number < film.layers.len()).then_some(number),
        material: material(number),
    });
    let wavelength_nm = scene.grid.wavelengths_nm();
    Ok(PixelAbsorption { theta_deg: theta_deg.to_vec(), wavelength_nm, layers: layers.collect(), sub_pixels })
}

/// Sum of the values of these gaps, weighted by their area fractions.
fn mixed(of_gaps: &[Vec<f64>], parts: &[(usize, f64)]) -> Vec<f64> {
    let mut sum = vec![0.0; of_gaps.first().map_or(0, Vec::len)];
    for (gap, on) in parts {
        sum.iter_mut().zip(&of_gaps[*gap]).for_each(|(sum, value)| *sum += on * value);
    }
    sum
}

/// Reflectance `[angle][wavelength]` and absorptance `[layer][angle][wavelength]` of each gap.
struct OfGaps {
    reflectance: Vec<Vec<f64>>,
    absorptance: Vec<Vec<f64>>,
}

impl OfGaps {
    fn new(
        scene: &Scene,
        film: &FilmPixel,
        gaps_nm: &[f64],
        theta_deg: &[f64],
    ) -> Result<Self, DisplayError> {
        let index = scene.display.index_above_pixel();
        let beta = match scene.solver.angle_medium {
            AngleMedium::Air => Beta::Air,
            AngleMedium::Glass | AngleMedium::Unrefracted => Beta::InGlass,
        };
        let sines: Vec<f64> = theta_deg.iter().map(|theta| theta.to_radians().sin()).collect();
        // The reflectances are those of `pixel.csv`, from the fast implementation.
        let all = Films::new(film, &scene.grid, index, gaps_nm, beta)?.reflectance(&sines)?;
        let (bins, gaps) = (scene.grid.len(), gaps_nm.len());
        let rows = |gap: usize| all.chunks_exact(bins).skip(gap).step_by(gaps).flatten().copied().collect();
        let reflectance = (0..gaps).map(rows).collect();
        let wavelengths_nm = scene.grid.wavelengths_nm();
        let mut absorptance = vec![vec![0.0; (film.layers.len() + 1) * sines.len() * bins]; gaps];
        for (bin, nm) in wavelengths_nm.into_iter().enumerate() {
            let scale = if beta == Beta::Air { 1.0 } else { index[bin] };
            for (gap, out) in gaps_nm.iter().zip(&mut absorptance) {
                let film = film_at(film, bin, index[bin], *gap);
                for (angle, sine) in sines.iter().enumerate() {
                    // At grazing incidence, all light is reflected.
                    if scale * sine >= index[bin] {
                        continue;
                    }
                    let light = absorbed(&film, nm, scale * sine)?;
                    for (layer, fraction) in light.layers.iter().chain([&light.substrate]).enumerate() {
                        out[(layer * sines.len() + angle) * bins + bin] = *fraction;
                    }
                }
            }
        }
        Ok(Self { reflectance, absorptance })
    }
}

/// Returns the film at a wavelength of the grid and a gap.
fn film_at(film: &FilmPixel, bin: usize, incidence: f64, gap_nm: f64) -> Film {
    let layers = film.layers.iter().map(|layer| Layer {
        index: layer.index[bin],
        thickness_nm: match layer.thickness {
            Thickness::Fixed(nm) => nm,
            Thickness::Gap => gap_nm,
        },
    });
    Film { incidence, layers: layers.collect(), substrate: film.substrate[bin] }
}
