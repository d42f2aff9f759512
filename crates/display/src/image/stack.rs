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

/// Computes what the reader sees of the states of all pixels, by their numbers in a palette.
pub(super) fn seen(
    scene: &Scene,
    picture: ([usize; 2], &[u8]),
    palette: &Palette,
    surround: PictureSurround,
    control: &Control<'_>,
) -> Result<Seen, DisplayError> {
    let mut all = seen_in_each(&[(scene, palette)], picture, surround, control)?;
    all.pop().ok_or(DisplayError::NoWhite { what: "a picture" })
}

/// The same for several scenes with the same display and view, and their palettes; they differ in light.
pub(super) fn seen_in_each(
    lit: &[(&Scene, &Palette)],
    (size, states): ([usize; 2], &[u8]),
    surround: PictureSurround,
    control: &Control<'_>,
) -> Result<Vec<Seen>, DisplayError> {
    let Some((scene, palette)) = lit.first() else { return Ok(Vec::new()) };
    let names = scene.display.state_names();
    let number = |one: &PaletteColour| names.iter().position(|name| *name == one.state).unwrap_or(0) as u8;
    let numbers: Vec<u8> = palette.colours.iter().map(number).collect();
    let states: Vec<u8> = states.iter().map(|state| numbers[usize::from(*state)]).collect();
    let scenes: Vec<&Scene> = lit.iter().map(|(scene, _)| *scene).collect();
    let Some(blur) = Blur::new(&scenes)? else {
        let alone = |(scene, palette): &(&Scene, &Palette)| {
            without_diffuser(scene, (size, &states), &numbers, palette, surround, control)
        };
        return lit.iter().map(alone).collect();
    };
    let mut shown = vec![0.0; names.len()];
    states.iter().for_each(|state| shown[usize::from(*state)] += 1.0 / states.len() as f64);
    let pages_of = |(_, palette): &(&Scene, &Palette)| {
        let mut pages = vec![[0.0; 3]; names.len()];
        for (colour, number) in palette.colours.iter().zip(&numbers) {
            pages[usize::from(*number)] = [colour.X, colour.Y, colour.Z];
        }
        pages
    };
    let pages: Vec<Vec<[f64; 3]>> = lit.iter().map(pages_of).collect();
    let all = blur.seen(&blur.picture(&states, size[0], surround), &pages, &shown);
    let seen = |(pixels, (_, palette)): (Vec<[f32; 3]>, &(&Scene, &Palette))| Seen {
        pixels,
        error: palette.error(),
        neighbours_light: true,
    };
    Ok(all.into_iter().zip(lit).map(seen).collect())
}

/// What the reader sees of states of the display, through flat faces and general layers. `numbers` are those of the colours of the palette.
fn without_diffuser(
    scene: &Scene,
    (size, states): ([usize; 2], &[u8]),
    numbers: &[u8],
    palette: &Palette,
    surround: PictureSurround,
    control: &Control<'_>,
) -> Result<Seen, DisplayError> {
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
        let shown = Picture { count: size, states: flipped.copied().collect() };
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
    let mut colours = vec![[0.0; 3]; scene.display.state_names().len()];
    for (colour, number) in palette.colours.iter().zip(numbers) {
        colours[usize::from(*number)] = [colour.X, colour.Y, colour.Z].map(|value| value as f32);
    }
    let pixels = states.iter().map(|state| colours[usize::from(*state)]).collect();
    Ok(Seen { pixels, error: palette.error(), neighbours_light: false })
}
