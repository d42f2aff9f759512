//! What is seen of a period of pixels below a filter.

/// States and windows of a period of pixels below a filter.
#[derive(Debug, Clone)]
pub struct Asked<'a> {
    /// State of the pixel below each window of the period, of several periods.
    pub states: &'a [Vec<usize>],
    /// Windows that light passes last; after the last one follow the areas between them, one for each pixel.
    pub windows: Vec<usize>,
}

/// Light of several periods as a mean over the period, `[period][window][sub-pixel][wavelength]`, by the window
/// of the filter that it passes last and the sub-pixel that it has left before.
#[derive(Debug, Clone, PartialEq)]
pub struct Shown {
    values: Vec<f64>,
    windows: Vec<usize>,
    sub_pixels: usize,
    bins: usize,
}

impl Shown {
    pub(super) fn dark(asked: &Asked<'_>, sub_pixels: usize, bins: usize) -> Self {
        let count = asked.states.len() * asked.windows.len() * sub_pixels * bins;
        Self { values: vec![0.0; count], windows: asked.windows.clone(), sub_pixels, bins }
    }

    /// Sum of light, each part times a factor; `None` of none.
    pub fn sum_of(parts: Vec<(Self, f64)>) -> Option<Self> {
        let add = |mut sum: Self, more: Self| {
            sum.values.iter_mut().zip(more.values).for_each(|(sum, more)| *sum += more);
            sum
        };
        let times = |(mut one, factor): (Self, f64)| {
            one.values.iter_mut().for_each(|light| *light *= factor);
            one
        };
        parts.into_iter().map(times).reduce(add)
    }

    /// Light of a period that passes all windows.
    pub fn all(&self, period: usize) -> Vec<f64> {
        let (mut sum, count) = (vec![0.0; self.bins], self.windows.len() * self.sub_pixels * self.bins);
        for part in self.values[period * count..][..count].chunks_exact(self.bins) {
            sum.iter_mut().zip(part).for_each(|(sum, light)| *sum += light);
        }
        sum
    }

    /// Light of a period that has left one sub-pixel and passes one window.
    pub fn part(&self, period: usize, window: usize, sub_pixel: usize) -> &[f64] {
        &self.values[self.start(period, window, sub_pixel)..][..self.bins]
    }

    /// Multiplies the light by a factor for each wavelength.
    pub fn times(mut self, factors: &[f64]) -> Self {
        for part in self.values.chunks_exact_mut(self.bins) {
            part.iter_mut().zip(factors).for_each(|(light, factor)| *light *= factor);
        }
        self
    }

    pub(super) fn slot(&mut self, period: usize, window: usize, sub_pixel: usize) -> &mut [f64] {
        let start = self.start(period, window, sub_pixel);
        &mut self.values[start..][..self.bins]
    }

    fn start(&self, period: usize, window: usize, sub_pixel: usize) -> usize {
        // Light of windows that were not asked for does not come here.
        let window = self.windows.iter().position(|asked| *asked == window).unwrap_or(0);
        ((period * self.windows.len() + window) * self.sub_pixels + sub_pixel) * self.bins
    }
}
