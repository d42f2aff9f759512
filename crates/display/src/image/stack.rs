//! What the layers above the pixels make of a picture.

use crate::DisplayError;
use crate::palette::{Palette, PaletteColour};
use crate::run::Control;
use crate::scene::{Pixel, Scene, UniformKind};
use crate::spatial::{Blur, Picture, PictureSurround, Precision, picture};

/// What the reader sees of each pixel.
pub(super) struct Seen {
    pub(super) pixels: Vec<[f32; 3]>,
    /// Estimated error of X, Y, Z.
    pub(super) error: f64,
    /// Whether light that the layers return to neighbours is contained.
    pub(super) neighbours_light: bool,
}

/// Computes what the reader sees of the states of all pixels.
pub(super) fn seen(
    scene: &Scene,
    size: [usize; 2],
    states: &[u8],
    palette: &Palette,
    surround: PictureSurround,
    control: &Control<'_>,
) -> Result<Seen, DisplayError> {
    let names = scene.display.state_names();
    let number = |one: &PaletteColour| names.iter().position(|name| *name == one.state).unwrap_or(0) as u8;
    let numbers: Vec<u8> = palette.colours.iter().map(number).collect();
    if let Some(blur) = Blur::new(scene)? {
        let mut pages = vec![[0.0; 3]; names.len()];
        let mut shown = vec![0.0; names.len()];
        for (colour, number) in palette.colours.iter().zip(&numbers) {
            pages[usize::from(*number)] = [colour.X, colour.Y, colour.Z];
        }
        let states: Vec<u8> = states.iter().map(|state| numbers[usize::from(*state)]).collect();
        states.iter().for_each(|state| shown[usize::from(*state)] += 1.0 / states.len() as f64);
        let pixels = blur.seen(&blur.picture(&states, size[0], surround), &pages, &shown);
        return Ok(Seen { pixels, error: palette.error(), neighbours_light: true });
    }
    let is_paper =
        matches!(&scene.display.pixel, Pixel::Uniform(pixel) if pixel.kind == UniformKind::Lambertian);
    let is_glass = scene.display.index_above_pixel().max() > 1.0;
    let is_plain = scene.display.matrix.as_ref().is_some_and(|matrix| matrix.filter.is_none());
    if is_paper && is_glass && is_plain {
        if surround == PictureSurround::BlackMask {
            let what = "a black mask around pictures below a flat face".to_owned();
            return Err(DisplayError::PlacesNotComputed { what, key: "image.surround".to_owned() });
        }
        let flipped = states.chunks_exact(size[0]).rev().flatten();
        let shown =
            Picture { count: size, states: flipped.map(|state| numbers[usize::from(*state)]).collect() };
        match picture(scene, &shown, Precision::FAST, control) {
            Ok(mut found) => {
                let view = found.views.pop().unwrap_or_default();
                let rows = view.chunks_exact(size[0]).rev().flatten().copied();
                return Ok(Seen { pixels: rows.collect(), error: found.error, neighbours_light: true });
            }
            // Below other layers, pixels have the colours of pages.
            Err(DisplayError::PlacesNotComputed { .. }) => {}
            Err(error) => return Err(error),
        }
    }
    let colours: Vec<[f32; 3]> =
        palette.colours.iter().map(|one| [one.X, one.Y, one.Z].map(|value| value as f32)).collect();
    let pixels = states.iter().map(|state| colours[usize::from(*state)]).collect();
    Ok(Seen { pixels, error: palette.error(), neighbours_light: false })
}
