//! Patterns of states in the plane of the pixel.

use crate::window::Window;

/// A pattern, or several *images*: at each place of the plane of the pixel, the fraction that each state
/// covers.
///
/// One path serves all images, whose estimates are therefore correlated. An image that is shifted is the same
/// pattern seen from another place.
pub trait Pattern: Sync {
    /// Number of images.
    fn images(&self) -> usize;

    /// Period over which the place that the view's own ray meets is uniformly distributed, mm; 0: always the
    /// origin.
    fn period_mm(&self) -> [f64; 2];

    /// Calls `covered` with the number of each image, of each state that it shows at a place (mm, in the
    /// plane of the panel), and the fraction that the state covers.
    fn shows(&self, place_mm: [f64; 2], covered: &mut dyn FnMut(usize, usize, f64));

    /// The same for a pattern that depends on more of a meeting than its place.
    fn shows_at(&self, meeting: &Meeting, covered: &mut dyn FnMut(usize, usize, f64)) {
        self.shows(meeting.place_mm, covered);
    }
}

/// A meeting of a path, followed back from the viewer, with the pixel. Places are in mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Meeting {
    /// Where it is.
    pub place_mm: [f64; 2],
    /// Where the view's own ray meets the pixel.
    pub own_mm: [f64; 2],
    /// Where the view's own ray passes the plane of the filter; without filter where it meets the pixel.
    pub own_at_filter_mm: [f64; 2],
    /// Where the path first passed the plane of the filter; without filter that of the own ray.
    pub passed_mm: [f64; 2],
    /// True for the first meeting: the last one of the light.
    pub is_first: bool,
}

/// Every state everywhere: image k is state k.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Uniform {
    /// Number of states.
    pub states: usize,
}

impl Pattern for Uniform {
    fn images(&self) -> usize {
        self.states
    }

    fn period_mm(&self) -> [f64; 2] {
        [0.0; 2]
    }

    fn shows(&self, _: [f64; 2], covered: &mut dyn FnMut(usize, usize, f64)) {
        (0..self.states).for_each(|state| covered(state, state, 1.0));
    }
}

/// A matrix of windows that repeats, in one image; estimates are means over a period.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrix {
    /// Period along x and y, mm.
    pub period_mm: [f64; 2],
    /// Windows in fractions of the period; no two overlap.
    pub windows: Vec<Window>,
    /// Coverage of each state within each window; `[window][state]`.
    pub within: Vec<Vec<f64>>,
    /// Coverage of each state outside all windows.
    pub between: Vec<f64>,
}

impl Pattern for Matrix {
    fn images(&self) -> usize {
        1
    }

    fn period_mm(&self) -> [f64; 2] {
        self.period_mm
    }

    fn shows(&self, place_mm: [f64; 2], covered: &mut dyn FnMut(usize, usize, f64)) {
        let part = |k: usize| fraction(place_mm[k] / self.period_mm[k]);
        let (x, y) = (part(0), part(1));
        let holds = |window: &&Window| {
            let mut rectangles = window.rectangles.iter();
            rectangles.any(|one| (one.x[0]..one.x[1]).contains(&x) && (one.y[0]..one.y[1]).contains(&y))
        };
        let window = self.windows.iter().position(|window| holds(&window));
        let coverages = window.map_or(&self.between, |window| &self.within[window]);
        let shown = coverages.iter().enumerate().filter(|(_, coverage)| **coverage != 0.0);
        shown.for_each(|(state, coverage)| covered(0, state, *coverage));
    }
}

/// Stripes or a checkerboard of two states, half of the area each; estimates are means over a period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoStates {
    /// Shape.
    pub shape: Shape,
    /// Period, mm.
    pub period_mm: f64,
    /// Numbers of the two states.
    pub states: [usize; 2],
}

/// Shape of a pattern of two states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Stripes that repeat along x.
    Stripes,
    /// Squares with sides of half the period.
    Checkerboard,
}

impl Pattern for TwoStates {
    fn images(&self) -> usize {
        1
    }

    fn period_mm(&self) -> [f64; 2] {
        match self.shape {
            Shape::Stripes => [self.period_mm, 0.0],
            Shape::Checkerboard => [self.period_mm; 2],
        }
    }

    fn shows(&self, place_mm: [f64; 2], covered: &mut dyn FnMut(usize, usize, f64)) {
        let is_second = |k: usize| fraction(place_mm[k] / self.period_mm) >= 0.5;
        let second = match self.shape {
            Shape::Stripes => is_second(0),
            Shape::Checkerboard => is_second(0) != is_second(1),
        };
        covered(0, self.states[usize::from(second)], 1.0);
    }
}

/// Part of a number above the largest integer that is not larger.
fn fraction(x: f64) -> f64 {
    x - x.floor()
}

/// A pattern seen from several places: image `k * pattern.images() + i` is image i seen where the view's own
/// ray meets place k.
pub struct SeenFrom<'a> {
    /// The pattern.
    pub pattern: &'a dyn Pattern,
    /// Places, mm.
    pub places_mm: &'a [[f64; 2]],
}

impl Pattern for SeenFrom<'_> {
    fn images(&self) -> usize {
        self.places_mm.len() * self.pattern.images()
    }

    fn period_mm(&self) -> [f64; 2] {
        [0.0; 2]
    }

    fn shows(&self, place_mm: [f64; 2], covered: &mut dyn FnMut(usize, usize, f64)) {
        for (k, from) in self.places_mm.iter().enumerate() {
            let first = k * self.pattern.images();
            let place_mm = [place_mm[0] + from[0], place_mm[1] + from[1]];
            let mut shown =
                |image: usize, state: usize, coverage: f64| covered(first + image, state, coverage);
            self.pattern.shows(place_mm, &mut shown);
        }
    }
}
