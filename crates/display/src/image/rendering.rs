//! From the colours of a picture to colours of a display in its light and view: [`papilio_colour::mapping`]
//! with the states of the display, and a table for large pictures.

use papilio_colour::mapping::{
    ClosestLattice, DisplayColours, GamutMapping, GamutTable, Intent, MapSpace, SEVERAL, SourceSpace,
};
use papilio_colour::pictures::AffineMap;
use papilio_colour::states::{StateHull, TOLERANCE};
use papilio_colour::{Adaptation, D65_WHITE, Xyz};

use super::chunks::in_chunks;
use super::colour;
use super::natural::{AdjustedSource, Adjustments, Rendition};
use crate::DisplayError;
use crate::palette::Palette;

/// Number of pixels from which a table is quicker than the mapping of each.
const MANY: usize = 40_000;

/// Number of pixels of which the error of a table is measured.
const PROBES: usize = 400;

/// Distance from the hull, relative to its size, that rounding to 32 bits may cause.
const INSIDE: f64 = 1e-6;

/// Distance from the hull, relative to its size, up to which a colour counts as one of the display. The white
/// of pictures, from its chromaticity or from a profile of four digits, differs from the D65 of colorimetry
/// by up to 0.0005 of X or Z: a neutral is not a colour that the display lacks. It is less than a just
/// noticeable difference.
const COUNTED_INSIDE: f64 = 1e-3;

/// Weights of red-green and of blue-yellow differences of states, over that of lightness, in error diffusion.
const RED_GREEN: f64 = 1.7;
const BLUE_YELLOW: f64 = 0.6;

/// Colours of a display for the colours of a picture.
pub(super) struct Rendering {
    mapping: GamutMapping,
    /// The mapping of many colours.
    table: Option<GamutTable>,
    intent: Intent,
    pub(super) white: Xyz,
    black: Xyz,
    /// From D65 to the white of the display.
    to_white: Adaptation,
    /// X, Y, Z of the states.
    pub(super) states: Vec<[f64; 3]>,
}

/// A picture before and after gamut mapping.
pub(super) struct Rendered {
    /// The picture after exposure and white balance, if they change it.
    pub(super) adjusted: Option<Vec<[f32; 3]>>,
    /// After exposure, tone and chroma, before gamut mapping; empty unless it is requested.
    pub(super) toned: Vec<[f32; 3]>,
    /// In the gamut of the display.
    pub(super) mapped: Vec<[f32; 3]>,
    /// Number of pixels whose colour some mixture of states has.
    pub(super) inside: usize,
    /// Error of the mapping of such colours by a table, CIEDE2000, 95th percentile; `None` if each was mapped.
    pub(super) table_error: Option<f64>,
    /// What was chosen for this picture.
    pub(super) rendition: Option<Rendition>,
}

impl Rendering {
    /// Prepares the mapping of `pixels` colours.
    pub(super) fn new(
        palette: &Palette,
        perfect_white: Xyz,
        (intent, space): (Intent, MapSpace),
        pixels: usize,
    ) -> Result<Self, DisplayError> {
        let states: Vec<[f64; 3]> = palette.colours.iter().map(|one| [one.X, one.Y, one.Z]).collect();
        let points: Vec<Xyz> = states.iter().map(|[x, y, z]| Xyz { x: *x, y: *y, z: *z }).collect();
        let find = |name: &str| palette.colours.iter().position(|one| one.state == name).map(|at| points[at]);
        let by_light = |a: &&Xyz, b: &&Xyz| a.y.total_cmp(&b.y);
        let nothing = DisplayError::NoWhite { what: "a picture" };
        let white =
            find("white").or_else(|| points.iter().max_by(by_light).copied()).ok_or(nothing.clone())?;
        let black = find("black").or_else(|| points.iter().min_by(by_light).copied()).ok_or(nothing)?;
        let to_white =
            Adaptation::between(D65_WHITE, white).ok_or(DisplayError::NoWhite { what: "a picture" })?;
        let display = DisplayColours { white, black, perfect_white };
        let mapping = GamutMapping::new(StateHull::new(&points)?, display, SourceSpace::Srgb, intent, space)?;
        let has_table = pixels > MANY && !is_natural(intent);
        let table = has_table.then(|| GamutTable::new(&mapping, GamutTable::LEVELS));
        Ok(Self { mapping, table, intent, white, black, to_white, states })
    }

    /// Coordinates in which error diffusion searches the nearest state: lightness, red-green and blue-yellow,
    /// relative to the white.
    ///
    /// Of weights of red-green from 0.5 to 4 and of blue-yellow from 0.15 to 1, these have the smallest mean
    /// S-CIELAB difference for four photographs on the displays of six-ink.toml (under its lamp and D65),
    /// page.toml and matrix.toml: 4 to 13 % less than 1 and 0.4. The minimum is flat: from 1.4 to 2 and from
    /// 0.5 to 0.8 the mean is within 3 %. With a weight of blue-yellow below 0.5, errors grow until they are
    /// cut, under D65 in up to 6 % of the pixels with 0.4. Else the mean colour is the same with any weights.
    pub(super) fn metric(&self) -> [[f64; 3]; 3] {
        self.opponent(RED_GREEN, BLUE_YELLOW)
    }

    /// Lightness, red-green and blue-yellow with these weights, relative to the white.
    pub(super) fn opponent(&self, red_green: f64, blue_yellow: f64) -> [[f64; 3]; 3] {
        let [x, y, z] = self.white.to_array().map(|value| 1.0 / value);
        [[0.0, y, 0.0], [red_green * x, -red_green * y, 0.0], [0.0, blue_yellow * y, -blue_yellow * z]]
    }

    /// The display's black and white.
    pub(super) fn black_and_white(&self) -> [Xyz; 2] {
        [self.black, self.white]
    }

    /// The colour of the hull that is nearest to a colour.
    pub(super) fn nearest(&self, colour: Xyz) -> Xyz {
        self.mapping.hull().nearest(colour, self.white)
    }

    /// Largest distance of a colour from a face of the hull, in X, Y, Z; 0 or less inside.
    #[cfg(test)]
    pub(super) fn excess(&self, colour: Xyz) -> f64 {
        self.mapping.hull().excess(colour)
    }

    /// Number of the state closest to a colour, in the space of the mapping, of those that may be taken.
    pub(super) fn closest_state(&self, colour: Xyz, is_allowed: impl Fn(usize) -> bool) -> usize {
        let here = self.mapping.coordinates(colour);
        let distance = |[x, y, z]: &[f64; 3]| {
            let there = self.mapping.coordinates(Xyz { x: *x, y: *y, z: *z });
            here.iter().zip(there).map(|(a, b)| (a - b).powi(2)).sum::<f64>()
        };
        let distances: Vec<f64> = self.states.iter().map(distance).collect();
        let allowed = (0..distances.len()).filter(|state| is_allowed(*state));
        allowed.min_by(|a, b| distances[*a].total_cmp(&distances[*b])).unwrap_or(0)
    }

    /// Maps all pixels of a picture with these columns, some of which may be those of a drawing; the picture before gamut mapping is kept if
    /// `keep_toned`.
    pub(super) fn rendered(
        &self,
        (pixels, columns, is_drawn): (&[[f32; 3]], usize, Option<&[bool]>),
        adjustments: &Adjustments,
        keep_toned: bool,
        threads: usize,
    ) -> Result<Rendered, DisplayError> {
        let adjusted = adjustments.of_source(pixels, is_drawn, is_natural(self.intent), threads)?;
        let shown = adjusted.pixels.as_deref().unwrap_or(pixels);
        let mut rendered = if is_natural(self.intent) {
            self.natural((shown, columns, is_drawn), adjustments, &adjusted, keep_toned, threads)?
        } else {
            self.colour_by_colour(shown, keep_toned)
        };
        rendered.adjusted = adjusted.pixels;
        Ok(rendered)
    }

    /// From the picture itself to it with the white of the display; its black is 0.
    pub(super) fn photograph(&self) -> AffineMap {
        AffineMap::of(|colour| self.to_white.apply(colour))
    }

    /// From the picture after exposure and white balance to it with the white and black of the display.
    pub(super) fn wanted(&self) -> AffineMap {
        AffineMap::of(|colour| self.mapping.target_xyz(colour))
    }

    /// Maps the colour of each pixel by itself.
    fn colour_by_colour(&self, pixels: &[[f32; 3]], keep_toned: bool) -> Rendered {
        let table_error = self.table.as_ref().map(|table| table.error(&self.mapping).p95);
        let mut mapped = Vec::with_capacity(pixels.len());
        let (mut toned, mut inside) = (Vec::new(), 0);
        for pixel in pixels {
            let (wanted, shown, is_inside) = self.mapped(*pixel);
            mapped.push(shown);
            inside += usize::from(is_inside);
            if keep_toned {
                toned.push(wanted);
            }
        }
        Rendered { adjusted: None, toned, mapped, inside, table_error, rendition: None }
    }

    /// Maps a natural picture: the tone of a pixel depends on its surroundings.
    fn natural(
        &self,
        picture @ (pixels, ..): (&[[f32; 3]], usize, Option<&[bool]>),
        adjustments: &Adjustments,
        adjusted: &AdjustedSource,
        keep_toned: bool,
        threads: usize,
    ) -> Result<Rendered, DisplayError> {
        let vivid = self.intent == Intent::Vivid;
        let (mut mapped, rendition) =
            adjustments.targets(&self.mapping, picture, vivid, adjusted, threads)?;
        let toned = if keep_toned {
            let black = self.mapping.target_xyz(Xyz { x: 0.0, y: 0.0, z: 0.0 });
            changed(threads, &mapped, |target| {
                single(self.mapping.xyz(target.map(f64::from)).unwrap_or(black))
            })
        } else {
            Vec::new()
        };
        let lattice = (pixels.len() > MANY).then(|| ClosestLattice::new(&self.mapping));
        let every = (pixels.len() / PROBES).max(1);
        // Of each chunk, the number of colours of the display, and errors of the lattice.
        let found = in_chunks(threads, &mut mapped, |first, mapped| {
            let (mut inside, mut errors) = (0, Vec::new());
            for (block, mapped) in mapped.chunks_mut(SEVERAL).enumerate() {
                let placed = self.mapping.placed(mapped);
                for (at, pixel) in mapped.iter_mut().enumerate() {
                    let target = pixel.map(f64::from);
                    let excess = placed.excess(at);
                    let closest = match &lattice {
                        _ if excess <= TOLERANCE => placed.colour(at),
                        Some(lattice) => lattice.closest(target),
                        None => self.mapping.closest(target),
                    };
                    if lattice.is_some() && (first + block * SEVERAL + at).is_multiple_of(every) {
                        let labs = [closest, self.mapping.closest(target)].map(|one| one.lab(self.white));
                        if let [Some(ours), Some(exact)] = labs {
                            errors.push(ours.delta_e_2000(exact));
                        }
                    }
                    inside += usize::from(excess <= COUNTED_INSIDE);
                    *pixel = single(closest);
                }
            }
            (inside, errors)
        });
        let inside = found.iter().map(|(inside, _)| inside).sum();
        let mut errors: Vec<f64> = found.into_iter().flat_map(|(_, errors)| errors).collect();
        errors.sort_by(f64::total_cmp);
        let table_error = errors.get(errors.len() * 95 / 100).copied();
        Ok(Rendered { adjusted: None, toned, mapped, inside, table_error, rendition: Some(rendition) })
    }

    /// The colour that the display should show, the one that it can show instead, and whether a mixture of
    /// states has the former.
    fn mapped(&self, pixel: [f32; 3]) -> ([f32; 3], [f32; 3], bool) {
        let source = colour(pixel);
        let wanted = self.mapping.target_xyz(source);
        let is_inside = self.mapping.hull().contains_within(wanted, INSIDE);
        let mapped = match &self.table {
            _ if is_inside => wanted,
            Some(table) if is_srgb(source.linear_srgb()) => table.map(source.linear_srgb()),
            _ => self.mapping.map_xyz(source),
        };
        let counts = is_inside || self.mapping.hull().contains_within(wanted, COUNTED_INSIDE);
        (single(wanted), single(mapped), counts)
    }
}

/// The pixels of a picture after a change.
fn changed(
    threads: usize,
    pixels: &[[f32; 3]],
    change: impl Fn([f32; 3]) -> [f32; 3] + Sync,
) -> Vec<[f32; 3]> {
    let mut all = vec![[0.0; 3]; pixels.len()];
    in_chunks(threads, &mut all, |first, all| {
        all.iter_mut().zip(&pixels[first..]).for_each(|(to, pixel)| *to = change(*pixel));
    });
    all
}

/// Whether the mapping of a pixel depends on its surroundings.
pub(super) fn is_natural(intent: Intent) -> bool {
    matches!(intent, Intent::Natural | Intent::Vivid)
}

fn single(colour: Xyz) -> [f32; 3] {
    colour.to_array().map(|value| value as f32)
}

/// Whether a colour is in the gamut of sRGB, for which the table was made.
fn is_srgb(rgb: [f64; 3]) -> bool {
    rgb.iter().all(|value| (-1e-4..=1.0001).contains(value))
}
