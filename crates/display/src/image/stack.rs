//! What the layers above the pixels make of a picture, in one or several lights and views.
//!
//! What is seen of the states of a picture is linear in the colours and kernels of light and view. Those of
//! many scenes that share their display are therefore mixtures of a few ([`Shapes`]), and so are their
//! pictures: only these few are computed.

use std::sync::Arc;

use papilio_fourier::StatePicture;
use papilio_transport::spatial::Shapes;

use super::filter::error_of_mixture;
use crate::DisplayError;
use crate::lamp_images;
use crate::palette::{Palette, PaletteColour};
use crate::run::Control;
use crate::scene::{Method, Pixel, SPREAD_KEY, Scene, UniformKind};
use crate::setup::Setup;
use crate::spatial::{Blur, BlurredPicture, LitPicture, PictureSurround, Precision};

/// What the reader sees of each pixel.
pub(super) struct Seen {
    pub(super) pixels: Vec<[f32; 3]>,
    /// Estimated error of X, Y, Z.
    pub(super) error: f64,
    /// The part of it between places of the panel whose directions are computed.
    pub(super) between_places: f64,
    /// Whether light that the layers return to neighbours is contained.
    pub(super) neighbours_light: bool,
}

/// The states of the pixels of a picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Picture<'a> {
    /// Number of columns and rows.
    pub(super) size: [usize; 2],
    /// State of each pixel by its number in a palette, rows from the top.
    pub(super) states: &'a [u8],
    /// For each state of the display, the state of the pixel of which it is a part; itself, if it is none.
    /// Empty: none is.
    pub(super) wholes: &'a [usize],
}

/// How the pictures of several scenes are computed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Several {
    /// Light that kernels and mixtures may miss, relative to a perfect white.
    pub(super) missed: f64,
    /// Whether the mirror images of round lamps are left out.
    pub(super) without_lamps: bool,
    /// Whether light by place below general layers is computed, which takes seconds.
    pub(super) by_paths: bool,
}

impl Several {
    /// One scene, as it is, with a negligible error.
    const ONE: Self = Self { missed: 1e-5, without_lamps: false, by_paths: true };
}

/// X, Y and Z of each state.
type Colours = Vec<[f32; 3]>;

/// A picture below the layers of several scenes, which have the same display and differ in light or view.
pub(super) struct Layers {
    kind: Kind,
    /// Number of columns of the picture.
    columns: usize,
    /// States of the display, rows from the top.
    states: Vec<u8>,
    /// A few scenes, made up, of which all others are mixtures: what is seen is linear in these numbers.
    few: Vec<Vec<f64>>,
    /// Weights of the few, for each scene.
    mixtures: Vec<Vec<f64>>,
    /// Estimated error of X, Y, Z.
    error: f64,
}

enum Kind {
    /// Each pixel has the colour of a page of its state.
    Pages,
    /// Below a diffuser.
    Diffuser(Box<(Blur, BlurredPicture)>),
    /// Paper below a flat face or general layers.
    Paper(Box<LitPicture>),
}

/// Computes what the reader sees of the states of all pixels, by their numbers in a palette.
pub(super) fn seen(
    lit: (&Setup, &Palette),
    picture: Picture<'_>,
    surround: PictureSurround,
    control: &Control<'_>,
) -> Result<Seen, DisplayError> {
    let layers = Layers::new(&[lit], picture, surround, Several::ONE, &mut None, control)?;
    layers.seen_in_each().pop().ok_or(DisplayError::NoWhite { what: "a picture" })
}

impl Layers {
    /// Prepares scenes, each with the colours of pages, for a picture of the states of a palette. What
    /// `known` has of the transform of the picture is not computed again.
    pub(super) fn new(
        lit: &[(&Setup, &Palette)],
        Picture { size, states, wholes }: Picture<'_>,
        surround: PictureSurround,
        several: Several,
        known: &mut Option<Arc<StatePicture>>,
        control: &Control<'_>,
    ) -> Result<Self, DisplayError> {
        let (setup, palette) = lit.first().ok_or(DisplayError::NoWhite { what: "a picture" })?;
        let scene = &setup.scene;
        let names = scene.display.state_names();
        let numbers = numbers(&names, palette);
        let states: Vec<u8> = states.iter().map(|state| numbers[usize::from(*state)] as u8).collect();
        let setups: Vec<&Setup> = lit.iter().map(|(setup, _)| *setup).collect();
        let pages: Vec<_> = lit
            .iter()
            .map(|(setup, palette)| colours_of_pages(setup, palette, several.without_lamps))
            .collect();
        let spreads = scene.display.pixel_spread().is_some();
        can_spread(scene)?;
        let mut error = lit.iter().map(|(_, palette)| palette.error()).fold(0.0, f64::max);
        let mut blurred = |blur: Blur, error: &mut f64| {
            let blur = blur.with_wholes(wholes);
            let shown = shares_of(&states, names.len());
            *error += blur.error(&shown, surround);
            let rows = blur.rows(&pages, &shown);
            let picture = blur.picture(&states, size[0], surround, known, control.thread_count());
            (Kind::Diffuser(Box::new((blur, picture))), rows)
        };
        let Several { without_lamps, .. } = several;
        let mut by_paths = |error: &mut f64| {
            let found = match several.by_paths {
                true => Blur::by_paths(&setups, &pages, without_lamps, control)?,
                false => None,
            };
            let Some((blur, of_paths)) = found else {
                // Pixels have the colours of pages.
                return Ok((Kind::Pages, of_pages(&pages)));
            };
            *error += of_paths;
            Ok::<_, DisplayError>(blurred(blur, error))
        };
        // Below general layers pictures take seconds: by adding, or by the kernels of paths.
        let is_layered = setup.stack.panel().is_none();
        let is_walked = scene.solver.method == Method::MonteCarlo;
        let (kind, rows) = if scene.display.filter().is_some() {
            error += error_of_mixture(setup, &pages[0], &shares_of(&states, names.len()), control)?;
            (Kind::Pages, of_pages(&pages))
        } else if let Some(blur) = Blur::new(&setups, several.missed, without_lamps, control)? {
            blurred(blur, &mut error)
        } else if is_paper(scene) && !(is_layered && (!several.by_paths || is_walked)) {
            match LitPicture::new(&setups, (size, &states, surround), Precision::FAST, without_lamps, control)
            {
                Ok((picture, rows)) => {
                    error += picture.error;
                    (Kind::Paper(Box::new(picture)), rows)
                }
                Err(DisplayError::PlacesNotComputed { .. } | DisplayError::PlacesByPaths { .. })
                    if !spreads =>
                {
                    by_paths(&mut error)?
                }
                Err(other) => return Err(other),
            }
        } else {
            by_paths(&mut error)?
        };
        let (few, mixtures) = if setups.len() == 1 {
            (rows, vec![vec![1.0]])
        } else {
            // The numbers of a row belong to X, Y, Z and to all states; a pixel has one of them at each
            // place.
            let apart = (3 * names.len()) as f64;
            let Shapes { shapes, mixtures, missed } = Shapes::of(&rows, apart * several.missed);
            error += missed / apart;
            (shapes, mixtures)
        };
        Ok(Self { kind, columns: size[0], states, few, mixtures, error })
    }

    /// Weights of these pictures, for each scene.
    pub(super) fn mixtures(&self) -> &[Vec<f64>] {
        &self.mixtures
    }

    /// Estimated error of X, Y, Z.
    pub(super) fn error(&self) -> f64 {
        self.error
    }

    /// Whether light that the layers return to neighbours is contained.
    pub(super) fn have_neighbours_light(&self) -> bool {
        !matches!(self.kind, Kind::Pages)
    }

    /// The states of the pixels, and the colour of each state in each picture, if pixels have the colours of pages.
    pub(super) fn pages(&self) -> Option<(&[u8], Vec<Colours>)> {
        let colours = |row: &Vec<f64>| row.as_chunks().0.iter().map(|one| one.map(single)).collect();
        matches!(self.kind, Kind::Pages).then(|| (&self.states[..], self.few.iter().map(colours).collect()))
    }

    /// Computes the pictures one by one, each with its number: X, Y and Z of each pixel, rows from the top.
    pub(super) fn each(&self, mut found: impl FnMut(usize, &mut Vec<[f32; 3]>)) {
        match &self.kind {
            Kind::Pages => {
                let mut pixels = Vec::new();
                for (number, row) in self.few.iter().enumerate() {
                    let colours: Vec<[f32; 3]> =
                        row.as_chunks().0.iter().map(|one| one.map(single)).collect();
                    pixels.clear();
                    pixels.extend(self.states.iter().map(|state| colours[usize::from(*state)]));
                    found(number, &mut pixels);
                }
            }
            Kind::Diffuser(blurred) => {
                let (blur, picture) = &**blurred;
                blur.seen(picture, &self.few, found);
            }
            Kind::Paper(picture) => {
                for (number, row) in self.few.iter().enumerate() {
                    let pixels = picture.seen(row);
                    let rows = pixels.chunks_exact(self.columns).rev().flatten().copied();
                    found(number, &mut rows.collect());
                }
            }
        }
    }

    /// Computes the picture of each scene.
    pub(super) fn seen_in_each(&self) -> Vec<Seen> {
        let mut all: Vec<Vec<[f32; 3]>> = vec![Vec::new(); self.mixtures.len()];
        self.each(|number, part| match &mut all[..] {
            // The picture of a single scene is its own only part.
            [only] => *only = std::mem::take(part),
            all => {
                for (sums, weights) in all.iter_mut().zip(&self.mixtures) {
                    add(sums, weights[number] as f32, part);
                }
            }
        });
        let seen = |pixels: Vec<[f32; 3]>| Seen {
            pixels,
            error: self.error,
            between_places: 0.0,
            neighbours_light: self.have_neighbours_light(),
        };
        all.into_iter().map(seen).collect()
    }
}

/// Fraction of the pixels in each state.
fn shares_of(states: &[u8], count: usize) -> Vec<f64> {
    let mut counts = vec![0_usize; count];
    states.iter().for_each(|state| counts[usize::from(*state)] += 1);
    counts.into_iter().map(|one| one as f64 / states.len() as f64).collect()
}

/// Adds a picture with a weight to a sum, which may still be empty.
fn add(sums: &mut Vec<[f32; 3]>, weight: f32, part: &[[f32; 3]]) {
    if sums.is_empty() {
        *sums = part.iter().map(|pixel| pixel.map(|value| weight * value)).collect();
        return;
    }
    for (sum, more) in sums.as_flattened_mut().iter_mut().zip(part.as_flattened()) {
        *sum += weight * more;
    }
}

/// Refuses pictures of pixels with spread where it is not computed.
fn can_spread(scene: &Scene) -> Result<(), DisplayError> {
    let display = &scene.display;
    if display.pixel_spread().is_none() {
        return Ok(());
    }
    if display.matrix.is_none() {
        return Err(DisplayError::NoMatrix { command: "image" });
    }
    let below = |what: &str| {
        let what = format!("pictures on pixels inside which light spreads, below {what}");
        Err(DisplayError::PlacesNotComputed { what, key: SPREAD_KEY.to_owned() })
    };
    if display.filter().is_some() {
        return below("a colour filter");
    }
    match display.panel() {
        None => below("general layers"),
        Some(panel) if panel.diffuser().is_some() => below("a diffuser"),
        Some(_) => Ok(()),
    }
}

/// Returns whether pixels are Lambertian and a face returns light to them, or light spreads inside them.
fn is_paper(scene: &Scene) -> bool {
    let is_paper =
        matches!(&scene.display.pixel, Pixel::Uniform(pixel) if pixel.kind == UniformKind::Lambertian);
    let is_glass = scene.display.index_above_pixel().max() > 1.0;
    is_paper && (is_glass || scene.display.pixel_spread().is_some()) && scene.display.matrix.is_some()
}

/// X, Y and Z of pages of all states of a display; 0 for those that are not in the palette. The mirror images
/// of lamps can be left out.
pub(super) fn colours_of_pages(setup: &Setup, palette: &Palette, without_lamps: bool) -> Vec<[f64; 3]> {
    let names = &setup.states;
    let mut pages = vec![[0.0; 3]; names.len()];
    let lamps = if without_lamps { lamp_images::in_view(setup) } else { Vec::new() };
    for (colour, number) in palette.colours.iter().zip(numbers(names, palette)) {
        pages[number] = [colour.X, colour.Y, colour.Z];
        for lamp in &lamps {
            (0..3).for_each(|k| pages[number][k] -= lamp.front[k] + lamp.pixel[number][k]);
        }
    }
    pages
}

/// Numbers of the states of a palette among those of the display.
pub(super) fn numbers(names: &[String], palette: &Palette) -> Vec<usize> {
    let number = |one: &PaletteColour| names.iter().position(|name| *name == one.state).unwrap_or(0);
    palette.colours.iter().map(number).collect()
}

fn of_pages(pages: &[Vec<[f64; 3]>]) -> Vec<Vec<f64>> {
    pages.iter().map(|page| page.as_flattened().to_vec()).collect()
}

fn single(value: f64) -> f32 {
    value as f32
}
