//! What reflects in a pixel: surfaces, each with one reflectance, and where they are in each state.

use papilio_spectra::Spectrum;
use papilio_transport::{AngularTable, Base, Reflector};

use super::places::Windows;
use crate::DisplayError;
use crate::pixel::film::{Mixture, with_constant};
use crate::scene::{Matrix, Pixel, Scene};
use crate::setup::Setup;

/// A fraction of the area of a sub-pixel that has a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Part {
    pub(super) sub_pixel: usize,
    pub(super) surface: usize,
    /// Fraction of the sub-pixel's area, mixed uniformly over its windows.
    pub(super) fraction: f64,
}

/// Surfaces of a pixel, as the states of a base, and the sub-pixels that they are in.
#[derive(Debug)]
pub(super) struct Surfaces {
    /// The surfaces are its states.
    pub(super) base: Base,
    /// The same for light of s and of p, if they are kept apart.
    pub(super) both: Option<[Base; 2]>,
    /// `[state]`. The inactive area is the sub-pixel after the last one.
    pub(super) states: Vec<Vec<Part>>,
}

impl Surfaces {
    /// Separates the surfaces of a display's pixel.
    pub(super) fn new(setup: &Setup, matrix: &Matrix) -> Result<Self, DisplayError> {
        let Scene { display, grid, .. } = &setup.scene;
        let (base, sub_pixels) = (setup.stack.base(), matrix.sub_pixels.len());
        let both = setup.stack.polarised_bases();
        let Pixel::Film(film) = &display.pixel else {
            let state = |surface| vec![Part { sub_pixel: 0, surface, fraction: 1.0 }];
            let states = (0..base.states()).map(state).collect();
            return Ok(Self { base: base.clone(), both: both.map(|both| both.map(Base::clone)), states });
        };
        let mixture = Mixture::new(film)?;
        let mut states: Vec<Vec<Part>> = vec![Vec::new(); film.states.len()];
        for part in &mixture.parts {
            states[part.state].push(Part { sub_pixel: part.sub_pixel, surface: part.gap, fraction: part.on });
        }
        let inactive = mixture.gaps_nm.len();
        for state in &mut states {
            state.push(Part { sub_pixel: sub_pixels, surface: inactive, fraction: 1.0 });
        }
        let alone = |base: &Base| Base {
            reflector: match &base.reflector {
                Reflector::Specular(table) => {
                    Reflector::Specular(each_alone(table, &film.inactive_reflectance))
                }
                other => other.clone(),
            },
            inactive_absorptance: vec![0.0; grid.len()].into(),
        };
        Ok(Self { base: alone(base), both: both.map(|both| both.map(alone)), states })
    }

    /// Surfaces of each state in each window and between them, with the fractions that they cover,
    /// `[state][window]`.
    pub(super) fn shown(&self, windows: &Windows) -> Vec<Vec<Vec<(usize, f64)>>> {
        let of_window = |parts: &[Part], window: usize| {
            let here = parts.iter().filter(|part| part.sub_pixel == window);
            here.map(|part| (part.surface, part.fraction * windows.scale[window])).collect()
        };
        let of_state =
            |parts: &Vec<Part>| (0..=windows.all.len()).map(|window| of_window(parts, window)).collect();
        self.states.iter().map(of_state).collect()
    }
}

/// A table whose states are the basis of another, and a reflectance that does not depend on angle.
fn each_alone(table: &AngularTable, constant: &Spectrum) -> AngularTable {
    let count = table.basis_count() + 1;
    let unit = |k: usize| if k / count == k % count { 1.0 } else { 0.0 };
    AngularTable {
        nodes: table.nodes.clone(),
        basis: with_constant(&table.basis, count - 1, constant),
        mixture: (0..count * count).map(unit).collect(),
        common: vec![0.0; constant.len()],
    }
}

impl Part {
    /// Sub-pixel and surface.
    pub(super) fn at(&self) -> [usize; 2] {
        [self.sub_pixel, self.surface]
    }
}
