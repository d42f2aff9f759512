//! The task `designs`: the reference pixel's film with other thicknesses and gaps, from its layers to the gamut.
//!
//! The bare film along the normal, as the peers have it; the same designs as whole displays are the task `displays`.

use papilio_colour::{GamutReference, Observer, Xyz, gamut_percent};
use papilio_optics::film::{GapFilm, SpectralLayer, Thickness};
use papilio_spectra::illuminant;

use super::{GAPS_NM, INDEX, LAYERS, Numbers, grid, indices};

/// How many: an even number of batches for whoever works in batches.
const DESIGNS: usize = 256;
/// Of red, green and blue.
pub(super) const AREAS: [f64; 3] = [0.493, 0.381, 0.126];
/// Which sub-pixels are on in red, green and blue.
const PRIMARIES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// The other states, which are seen as well: white, black, cyan, magenta, yellow.
const OTHERS: [[f64; 3]; 5] =
    [[1.0, 1.0, 1.0], [0.0, 0.0, 0.0], [0.0, 1.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 0.0]];

/// Thicknesses of all layers (the gap's is not a number) and the four gaps.
pub(super) struct Design {
    pub(super) layers_nm: [f64; LAYERS.len()],
    pub(super) gaps_nm: [f64; GAPS_NM.len()],
}

/// Spread evenly over .8 to 1.2 times the reference pixel's numbers (multiples of the golden ratio's powers).
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

/// What the peers are given: shape `[design][gap][layer]`.
pub(super) fn given() -> impl Iterator<Item = f64> {
    all().flat_map(|design| {
        design.gaps_nm.into_iter().flat_map(move |gap| {
            design.layers_nm.into_iter().map(move |nm| if nm.is_nan() { gap } else { nm })
        })
    })
}

/// The gamut of each bare film.
pub(super) fn bare() -> Result<impl FnMut() -> Numbers, Box<dyn std::error::Error>> {
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
