//! The task `designs`: the film of the reference pixel with other thicknesses and gaps, from its layers to
//! the gamut.
//!
//! The task computes the bare film at normal incidence, as the peers do. The task `displays` computes the
//! same designs as pixels of scenarios/indoor.toml, with its diffuser and front.

use std::sync::atomic::AtomicBool;

use papilio_colour::{GamutReference, Observer, Xyz, gamut_percent};
use papilio_display::scene::{FilmPixel, Metric, Pixel};
use papilio_display::{Control, Designs, Quantity};
use papilio_optics::film::{GapFilm, SpectralLayer, Thickness};
use papilio_spectra::illuminant;

use papilio_validation::scenario;

use super::{GAPS_NM, INDEX, LAYERS, SampleStream, grid, indices};

/// Number of designs, a multiple of the batch sizes of programs that compute in batches.
const DESIGNS: usize = 256;
/// Areas of red, green and blue.
pub(super) const AREAS: [f64; 3] = [0.493, 0.381, 0.126];
/// Sub-pixels that are on in the states red, green and blue.
const PRIMARIES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// Sub-pixels that are on in the other states, which are also computed: white, black, cyan, magenta, yellow.
const OTHERS: [[f64; 3]; 5] =
    [[1.0, 1.0, 1.0], [0.0, 0.0, 0.0], [0.0, 1.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 0.0]];

/// Thicknesses of all layers (NaN for the gap) and the four gaps.
pub(super) struct Design {
    pub(super) layers_nm: [f64; LAYERS.len()],
    pub(super) gaps_nm: [f64; GAPS_NM.len()],
}

/// Returns all designs, spread uniformly over 0.8 to 1.2 times the values of the reference pixel (multiples
/// of powers of the golden ratio).
pub(super) fn all() -> impl Iterator<Item = Design> {
    (0..DESIGNS).map(|k| {
        let factor = |number: usize| {
            0.8 + 0.4 * (k as f64 * 0.618_033_988_749_895_f64.powi(number as i32 + 1)).fract()
        };
        Design {
            layers_nm: std::array::from_fn(|layer| LAYERS[layer].1 * factor(layer)),
            gaps_nm: std::array::from_fn(|gap| GAPS_NM[gap] * factor(LAYERS.len() + gap)),
        }
    })
}

/// Returns the thicknesses for the peers, shape `[design][gap][layer]`.
pub(super) fn given() -> impl Iterator<Item = f64> {
    all().flat_map(|design| {
        design.gaps_nm.into_iter().flat_map(move |gap| {
            design.layers_nm.into_iter().map(move |nm| if nm.is_nan() { gap } else { nm })
        })
    })
}

/// Returns the task that computes the gamut of each bare film.
pub(super) fn bare() -> Result<impl FnMut() -> SampleStream, Box<dyn std::error::Error>> {
    let (coarse, indices) = (grid(5.0)?, indices()?);
    let (observer, light) = (Observer::new(&coarse)?, illuminant("D65", &coarse)?);
    let wavelengths = coarse.wavelengths_nm();
    let (front, back) = (vec![INDEX; wavelengths.len()], vec![INDEX.into(); wavelengths.len()]);
    let white = observer.xyz(&light).y;
    Ok(move || {
        all()
            .map(|design| {
                let layer = |(index, nm): (&Vec<_>, &f64)| SpectralLayer {
                    index: index.clone(),
                    thickness: if nm.is_nan() { Thickness::Gap } else { Thickness::Fixed(*nm) },
                };
                let layers: Vec<SpectralLayer> = indices.iter().zip(&design.layers_nm).map(layer).collect();
                let mut by_gap = vec![0.0; design.gaps_nm.len() * wavelengths.len()];
                let film = GapFilm::new(&wavelengths, &front, &layers, &back)?;
                film.reflectance(&[0.0], &design.gaps_nm, &mut by_gap)?;
                let state = |on: [f64; 3]| -> Xyz {
                    let shares: Vec<f64> = AREAS.iter().zip(on).map(|(area, on)| area * on).collect();
                    let dark = 1.0 - shares.iter().sum::<f64>();
                    let seen = |bin: usize| {
                        let of = |gap: usize| by_gap[gap * wavelengths.len() + bin];
                        let on = shares.iter().enumerate().map(|(gap, share)| share * of(gap)).sum::<f64>();
                        light[bin] * (on + dark * of(3)) / white
                    };
                    observer.xyz(&(0..wavelengths.len()).map(seen).collect::<Vec<f64>>())
                };
                std::hint::black_box(OTHERS.map(state));
                let uv = PRIMARIES.map(|on| state(on).uv_prime());
                let [Some(red), Some(green), Some(blue)] = uv else { return Err("black".into()) };
                Ok(gamut_percent([red, green, blue], GamutReference::Srgb))
            })
            .collect()
    })
}

/// Returns the task that computes the gamut of each design in the indoor scenario, and the colours of all
/// eight states.
pub(super) fn through_diffuser() -> Result<impl FnMut() -> SampleStream, Box<dyn std::error::Error>> {
    let scene = scenario("indoor", &[])?.scene;
    let Pixel::Film(film) = scene.display.pixel.clone() else { return Err("the pixel is not a film".into()) };
    let gamut = Quantity::Metric { view: 0, state: None, metric: Metric::gamut_percent_srgb };
    let lightness = film.states.iter().map(|state| Quantity::Metric {
        view: 0,
        state: Some(state.name.clone()),
        metric: Metric::L_star,
    });
    let wanted: Vec<Quantity> = std::iter::once(gamut).chain(lightness).collect();
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
    let mut designs = Designs::new(&scene, &wanted, &control)?;
    Ok(move || {
        all()
            .map(|design| {
                let values = designs.evaluate(&pixel(&film, &design))?;
                values[0].ok_or_else(|| "no gamut".into())
            })
            .collect()
    })
}

/// Returns the pixel of the scenario with the thicknesses (its metal is opaque) and gaps of a design.
fn pixel(film: &FilmPixel, design: &Design) -> FilmPixel {
    let mut film = film.clone();
    for (layer, nm) in film.layers.iter_mut().zip(design.layers_nm) {
        if let Thickness::Fixed(thickness) = &mut layer.thickness {
            *thickness = nm;
        }
    }
    let [gaps @ .., dark] = design.gaps_nm;
    film.sub_pixels.iter_mut().zip(gaps).for_each(|(sub_pixel, gap)| sub_pixel.gap_nm = gap);
    film.dark_gap_nm = Some(dark);
    film
}
