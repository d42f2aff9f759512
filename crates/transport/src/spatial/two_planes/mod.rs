//! Pixels below a second pattern: a colour filter at a height above them, under a face that returns light to
//! both. Mirror-like ones are in `mirrors.rs`, Lambertian ones here.
//!
//! **What.** Light that enters along beta passes the filter at one place and reaches the pixel `D_h(beta)`
//! further; what leaves the pixel passes the filter at another place. The face returns a part of it, which
//! passes the filter twice more. With the irradiance E of the pixels, their reflectance rho and the
//! transmittance t of the filter at its places,
//! `E(x) = sum over beta of w L t(x - D_h)^s + sum over beta of w F t(x - D_h)^s t(x - 2D + D_h)^s rho E (x - 2D)`,
//! s = 1/cos(theta), D the shift of the whole way to the face, w the weight of a direction in the irradiance.
//! All orders are solved.
//!
//! **How.** A period is divided into cells along the edges of the windows, shorter towards these edges,
//! beside which E changes over lengths of the height. E is constant in a cell; all areas on which a cell,
//! shifted, lies below or above others are exact. Directions are sums: rings of inclinations with azimuths.
//! Where the way to the face and back is many periods, cells and shifts are taken as independent: the limit
//! of Clapper and Yule.
//!
//! **Limits.** One refractive index and face; those of other wavelengths are sums of some ([`TwoPlanes::sum_of`]). Glass that
//! absorbs is a part of the filter: light crosses all of it with each pass.
//!
//! **Source.** Clapper, Yule, J. Opt. Soc. Am. 43, 600 (1953), for uniform filters.

mod cells;
mod directions;
mod mirrors;
mod shown;

use self::cells::Piece;
pub use self::cells::{Division, PeriodCells};
pub use self::directions::{
    Direction, diffuse_directions, diffused_directions, diffused_directions_of_field,
};
use self::directions::{Ring, azimuths, front_rings, return_rings};
pub use self::shown::{Asked, Shown};
use super::{PixelSpread, Window, displacement};

/// Pixels and filter.
#[derive(Debug, Clone, Copy)]
pub struct FilteredPixels<'a> {
    /// Period along x and y, mm.
    pub pitch_mm: [f64; 2],
    /// Number of pixels in the period along x: the area between windows is one area for each.
    pub columns: usize,
    /// Windows of the pixels, and of the filter above them.
    pub windows: &'a [Window],
    /// Transmittance of each window of the filter along the normal, `[window][wavelength]`.
    pub transmittance: &'a [Vec<f64>],
    /// The same between the windows.
    pub between: &'a [f64],
    /// Height of the filter above the pixels, and of the face, mm.
    pub height_mm: f64,
    /// Distance of the face from the pixels, mm; at least `height_mm`.
    pub thickness_mm: f64,
    /// Refractive index of the medium.
    pub index: f64,
    /// How light spreads inside Lambertian pixels below windows that depend on x alone.
    pub spread: Option<PixelSpread>,
}

/// Filter and face above pixels.
#[derive(Debug, Clone)]
pub struct TwoPlanes {
    cells: PeriodCells,
    pitch_mm: [f64; 2],
    height_mm: f64,
    index: f64,
    bins: usize,
    /// Transmittance of each window and, last, of each area between them, `[window][wavelength]`.
    transmittance: Vec<Vec<f64>>,
    /// Number of windows below which there are sub-pixels.
    sub_pixels: usize,
    /// Return from cell to cell, `[to][from][wavelength]`: irradiance of a cell per radiosity of another.
    returned: Vec<f64>,
    /// Return of a uniform clear filter, by wavelength.
    returned_uniform: Vec<f64>,
    /// Light that spreads inside the pixels, `[to][from]`: mean in a cell of what enters another; empty if it
    /// leaves where it enters.
    spread: Vec<f64>,
}

/// Light that passes the filter above each cell, as an integral over the cell in fractions of the period:
/// `[cell][window][wavelength]`. The last windows are the areas between the windows.
#[derive(Debug, Clone, PartialEq)]
pub struct Passed {
    values: Vec<f64>,
    windows: usize,
    bins: usize,
}

impl Passed {
    /// Light above a cell that passes one window.
    pub fn by_window(&self, cell: usize, window: usize) -> &[f64] {
        &self.values[(cell * self.windows + window) * self.bins..][..self.bins]
    }

    /// Sum of light, each with a weight for each wavelength; `None` of none.
    pub fn sum_of(parts: &[(Self, &[f64])]) -> Option<Self> {
        let mut sum = parts.first()?.0.clone();
        sum.values.fill(0.0);
        parts.iter().for_each(|(one, weights)| add_weighted(&mut sum.values, &one.values, weights));
        Some(sum)
    }

    /// Light above a cell through all windows.
    pub fn all(&self, cell: usize) -> Vec<f64> {
        let mut sum = vec![0.0; self.bins];
        for window in 0..self.windows {
            sum.iter_mut().zip(self.by_window(cell, window)).for_each(|(sum, more)| *sum += more);
        }
        sum
    }
}

/// Largest change of a repetition with which the irradiance is taken as solved.
const TOLERANCE: f64 = 1e-13;

/// The same relative to the largest irradiance, where that is above 50: rounding never falls below it.
const ROUNDING: f64 = 2e-15;

/// Orders of light between the face and a front above it that have less than this fraction belong to the one
/// before.
const FAINTEST: f64 = 1e-5;
const MOST_ORDERS: i32 = 5;

impl TwoPlanes {
    /// Prepares pixels and filter. `face` is the reflectance of the face from below as a function of `|beta|`
    /// up to 1; beyond, all light returns; `None`: nothing returns. A higher `level` is finer: 0, 1, ...
    pub fn new(pixels: &FilteredPixels<'_>, face: Option<&dyn Fn(f64) -> f64>, level: u32) -> Self {
        Self::with_cells(pixels, face, level, &Division::everywhere(10 << level, 0))
    }

    /// The same with other cells along each axis that the windows depend on.
    pub fn with_cells(
        pixels: &FilteredPixels<'_>,
        face: Option<&dyn Fn(f64) -> f64>,
        level: u32,
        division: &Division,
    ) -> Self {
        // The shortest length over which light changes.
        let lengths = [Some(pixels.height_mm), pixels.spread.map(|spread| spread.radius_mm())];
        let shortest = lengths.into_iter().flatten().filter(|length| *length > 0.0).reduce(f64::min);
        let reach = pixels.pitch_mm.map(|pitch| shortest.unwrap_or(0.0) / pitch);
        let mut cells = PeriodCells::new((pixels.windows, pixels.columns), division, reach);
        if cells.varies(0) && cells.varies(1) {
            // Their number is that along x times that along y.
            let fewer = Division { per_period: division.per_period * 6 / 10, per_window: 0, ..*division };
            cells = PeriodCells::new((pixels.windows, pixels.columns), &fewer, reach);
        }
        let bins = pixels.between.len();
        let between = std::iter::repeat_n(pixels.between.to_vec(), pixels.columns);
        let transmittance = pixels.transmittance.iter().cloned().chain(between).collect();
        let count = cells.count();
        let mut planes = Self {
            cells,
            pitch_mm: pixels.pitch_mm,
            height_mm: pixels.height_mm,
            index: pixels.index,
            bins,
            transmittance,
            sub_pixels: pixels.windows.len(),
            returned: Vec::new(),
            returned_uniform: vec![0.0; bins],
            spread: Vec::new(),
        };
        if let Some(spread) = pixels.spread {
            planes.spread = spread.between_cells(planes.cells.axis(0).edges(), pixels.pitch_mm[0]);
        }
        if let Some(face) = face {
            planes.returned = vec![0.0; count * count * bins];
            planes.add_returned(pixels.thickness_mm, face, level);
        }
        planes
    }

    /// Adds the light that a front of screen above an air gap returns through the face, of these reflectances for s and p.
    pub fn add_front(
        &mut self,
        (thickness_mm, gap_mm): (f64, f64),
        reflectance: f64,
        face: &dyn Fn(f64) -> [f64; 2],
        level: u32,
    ) {
        let count = self.cells.count();
        self.returned.resize(count * count * self.bins, 0.0);
        let finest = self.pitch_mm[0].min(self.pitch_mm[1]);
        let is_plane = self.cells.varies(0) && self.cells.varies(1);
        // Order k is reflected k times by the front, the last one standing for all that follow.
        let orders = (1..MOST_ORDERS).find(|k| reflectance.powi(*k) < FAINTEST).unwrap_or(MOST_ORDERS);
        for order in 1..=orders {
            let of = |r: f64| {
                let rest = if order == orders { 1.0 } else { 0.0 };
                let following = 1.0 - rest + rest / (1.0 - r * reflectance);
                (1.0 - r).powi(2) * r.powi(order - 1) * reflectance.powi(order) * following
            };
            let weight = |beta: f64| {
                let [s, p] = face(beta).map(of);
                0.5 * (s + p)
            };
            let lengths = [thickness_mm, f64::from(order) * gap_mm];
            let rings = front_rings(self.index, (lengths, finest), (level, is_plane), weight);
            self.add_rings(&rings, thickness_mm);
        }
    }

    /// Cells of a period.
    pub fn cells(&self) -> &PeriodCells {
        &self.cells
    }

    /// Fraction of the light of pixels that the face returns at each wavelength, without filter.
    pub fn returned_uniform(&self) -> &[f64] {
        &self.returned_uniform
    }

    /// Sum of the same pixels and filter below some optics, each with a weight for each wavelength. The index
    /// is that of the first one; `None` of none.
    pub fn sum_of(parts: &[(Self, &[f64])]) -> Option<Self> {
        let mut sum = parts.first()?.0.clone();
        let length = parts.iter().map(|(one, _)| one.returned.len()).max().unwrap_or(0);
        sum.returned = vec![0.0; length];
        sum.returned_uniform.fill(0.0);
        for (one, weights) in parts {
            add_weighted(&mut sum.returned, &one.returned, weights);
            add_weighted(&mut sum.returned_uniform, &one.returned_uniform, weights);
        }
        Some(sum)
    }

    /// The same pixels and filter in a medium of another index, for light that passes the filter.
    pub fn in_medium(&self, index: f64) -> Self {
        let (returned, spread) = (Vec::new(), Vec::new());
        let Self { cells, transmittance, returned_uniform, .. } = self;
        let (cells, transmittance) = (cells.clone(), transmittance.clone());
        let returned_uniform = returned_uniform.clone();
        Self { cells, transmittance, returned, returned_uniform, spread, index, ..*self }
    }

    /// Light that reaches each cell from outside along these directions of propagation, through the filter;
    /// the sum of the weights is taken as 1.
    pub fn entering(&self, directions: &[Direction]) -> Passed {
        self.passed(directions, 1.0)
    }

    /// Light that leaves each cell along these directions of propagation, through the filter.
    pub fn leaving(&self, directions: &[Direction]) -> Passed {
        self.passed(directions, -1.0)
    }

    /// What is seen of Lambertian pixels along these directions, relative to a page of 1 without filter and
    /// further orders, given their radiosity by list.
    pub fn shown(&self, leaving: &Passed, radiosity: &[impl AsRef<[f64]>], asked: &Asked<'_>) -> Shown {
        let (bins, mut shown) = (self.bins, self.nothing(asked));
        for (list, radiosity) in radiosity.iter().enumerate() {
            for (cell, radiosity) in radiosity.as_ref().chunks_exact(bins).enumerate() {
                let Some(own) = self.cells.window_of(cell) else { continue };
                for window in asked.windows.iter().copied() {
                    let rows = leaving.by_window(cell, window).iter().zip(radiosity);
                    let slot = shown.slot(list, window, own);
                    slot.iter_mut().zip(rows).for_each(|(slot, (t, b))| *slot += t * b);
                }
            }
        }
        shown
    }

    /// A period in the dark.
    fn nothing(&self, asked: &Asked<'_>) -> Shown {
        Shown::dark(asked, self.sub_pixels, self.bins)
    }

    fn passed(&self, directions: &[Direction], sign: f64) -> Passed {
        let windows = self.transmittance.len();
        let mut values = vec![0.0; self.cells.count() * windows * self.bins];
        let total: f64 = directions.iter().map(|one| one.weight).sum();
        let mut pieces = [Vec::new(), Vec::new()];
        let mut last = (f64::NAN, self.transmittance.clone());
        for direction in directions {
            if direction.beta.squared() != last.0 {
                last = (direction.beta.squared(), self.oblique(direction.beta.length(), self.index));
            }
            let shift = self.periods(displacement(direction.beta, self.height_mm, self.index));
            for axis in [0, 1] {
                self.cells.axis(axis).pieces(&[sign * shift[axis]], &mut pieces[axis]);
            }
            for (x, y) in products(&pieces) {
                let cell = self.cells.cell([x.to, y.to]);
                let window = self.cells.window([x.at[0], y.at[0]]);
                let weight = direction.weight / total * x.length * y.length;
                let slot = &mut values[(cell * windows + window) * self.bins..][..self.bins];
                slot.iter_mut().zip(&last.1[window]).for_each(|(slot, t)| *slot += weight * t);
            }
        }
        Passed { values, windows, bins: self.bins }
    }

    /// Irradiance of each cell through all orders, `[cell][wavelength]`, relative to that without filter and
    /// pixels. `reflectance` is that of the window of a cell; between windows it is 0.
    pub fn irradiance(&self, entering: &Passed, reflectance: &[&[f64]]) -> Vec<f64> {
        let (count, bins) = (self.cells.count(), self.bins);
        let mut first = Vec::with_capacity(count * bins);
        for cell in 0..count {
            let area = self.cells.area(cell);
            first.extend(entering.all(cell).iter().map(|light| light / area));
        }
        if self.returned.is_empty() {
            return first;
        }
        let mut irradiance = first.clone();
        loop {
            let radiosity = self.radiosity(&irradiance, reflectance);
            let [mut change, mut largest] = [0.0_f64; 2];
            for (cell, returned) in self.returned.chunks_exact(count * bins).enumerate() {
                let row = cell * bins..(cell + 1) * bins;
                let mut next = first[row.clone()].to_vec();
                for (a, b) in returned.chunks_exact(bins).zip(radiosity.chunks_exact(bins)) {
                    next.iter_mut().zip(a).zip(b).for_each(|((next, a), b)| *next += a * b);
                }
                for (value, next) in irradiance[row].iter_mut().zip(next) {
                    change = change.max((next - *value).abs());
                    largest = largest.max(next);
                    *value = next;
                }
            }
            if change.is_nan() || change <= TOLERANCE.max(ROUNDING * largest) {
                return irradiance;
            }
        }
    }

    /// Radiosity of each cell in this irradiance, `[cell][wavelength]`.
    pub fn radiosity(&self, irradiance: &[f64], reflectance: &[&[f64]]) -> Vec<f64> {
        let (count, bins) = (self.cells.count(), self.bins);
        let reflected = |light: &[f64], fraction: fn(f64) -> f64| {
            let mut out = vec![0.0; count * bins];
            for (cell, (out, light)) in out.chunks_exact_mut(bins).zip(light.chunks_exact(bins)).enumerate() {
                let own = self.cells.window_of(cell).and_then(|window| reflectance.get(window));
                let rows = out.iter_mut().zip(light).zip(own.copied().unwrap_or_default());
                rows.for_each(|((out, light), rho)| *out = light * fraction(*rho));
            }
            out
        };
        if self.spread.is_empty() {
            return reflected(irradiance, |rho| rho);
        }
        // Light passes the state below the window on its way in, and that where it leaves on its way out.
        let inside = reflected(irradiance, f64::sqrt);
        let mut spread = vec![0.0; count * bins];
        for (out, parts) in spread.chunks_exact_mut(bins).zip(self.spread.chunks_exact(count)) {
            for (part, light) in parts.iter().zip(inside.chunks_exact(bins)) {
                out.iter_mut().zip(light).for_each(|(out, light)| *out += part * light);
            }
        }
        reflected(&spread, f64::sqrt)
    }

    /// Adds all directions of the return.
    fn add_returned(&mut self, thickness_mm: f64, face: &dyn Fn(f64) -> f64, level: u32) {
        let finest = self.pitch_mm[0].min(self.pitch_mm[1]);
        let is_plane = self.cells.varies(0) && self.cells.varies(1);
        let rings = return_rings(self.index, 2.0 * thickness_mm / finest, (level, is_plane), face);
        self.add_rings(&rings, thickness_mm);
    }

    fn add_rings(&mut self, rings: &[Ring], thickness_mm: f64) {
        for ring in rings {
            self.returned_uniform.iter_mut().for_each(|sum| *sum += ring.weight);
            let windows = self.transmittance.len();
            let passes = self.oblique(ring.beta, self.index);
            // Both passes of each pair of windows, times the weight of the ring.
            let mut both = Vec::with_capacity(windows * windows * self.bins);
            for (one, other) in (0..windows).flat_map(|i| (0..windows).map(move |k| (i, k))) {
                both.extend(passes[one].iter().zip(&passes[other]).map(|(a, b)| ring.weight * a * b));
            }
            if ring.is_far {
                self.add_far(ring, &passes);
            } else {
                self.add_ring(ring, thickness_mm, &both);
            }
        }
    }

    fn add_ring(&mut self, ring: &Ring, thickness_mm: f64, both: &[f64]) {
        let (count, bins, windows) = (self.cells.count(), self.bins, self.transmittance.len());
        let mut pieces = [Vec::new(), Vec::new()];
        for (beta, weight) in azimuths(ring, !self.cells.varies(1)) {
            let height = self.periods(displacement(beta, self.height_mm, self.index));
            let mut whole = self.periods(displacement(beta, 2.0 * thickness_mm, self.index));
            if ring.air_mm > 0.0 {
                let air = self.periods(displacement(beta, 2.0 * ring.air_mm, 1.0));
                whole = [whole[0] + air[0], whole[1] + air[1]];
            }
            for axis in [0, 1] {
                let (h, d) = (height[axis], whole[axis]);
                self.cells.axis(axis).return_pieces([h, d - h], d, &mut pieces[axis]);
            }
            for (x, y) in products(&pieces) {
                let (to, from) = (self.cells.cell([x.to, y.to]), self.cells.cell([x.from, y.from]));
                // Light has the product of both passes of the filter, in either order.
                let [one, other] = [0, 1].map(|pass| self.cells.window([x.at[pass], y.at[pass]]));
                let share = weight * x.length * y.length / self.cells.area(to);
                let slot = &mut self.returned[(to * count + from) * bins..][..bins];
                let both = &both[(one * windows + other) * bins..][..bins];
                slot.iter_mut().zip(both).for_each(|(slot, both)| *slot += share * both);
            }
        }
    }

    /// Light whose way is so long that where it returns does not depend on where it left: only its passes of
    /// the filter are known.
    fn add_far(&mut self, ring: &Ring, passes: &[Vec<f64>]) {
        let (count, bins) = (self.cells.count(), self.bins);
        let mut pieces = [Vec::new(), Vec::new()];
        for (beta, weight) in azimuths(ring, !self.cells.varies(1)) {
            let height = self.periods(displacement(beta, self.height_mm, self.index));
            // Light above each cell on its way up and down.
            let [down, up] = [1.0, -1.0].map(|sign| {
                let mut light = vec![0.0; count * bins];
                for axis in [0, 1] {
                    self.cells.axis(axis).pieces(&[sign * height[axis]], &mut pieces[axis]);
                }
                for (x, y) in products(&pieces) {
                    let cell = self.cells.cell([x.to, y.to]);
                    let window = self.cells.window([x.at[0], y.at[0]]);
                    let area = x.length * y.length;
                    let slot = &mut light[cell * bins..][..bins];
                    slot.iter_mut().zip(&passes[window]).for_each(|(slot, t)| *slot += area * t);
                }
                light
            });
            for to in 0..count {
                let share = weight * ring.weight / self.cells.area(to);
                for from in 0..count {
                    let slot = &mut self.returned[(to * count + from) * bins..][..bins];
                    let rows = down[to * bins..][..bins].iter().zip(&up[from * bins..][..bins]);
                    slot.iter_mut().zip(rows).for_each(|(slot, (a, b))| *slot += share * a * b);
                }
            }
        }
    }

    /// Transmittance of one pass along `|beta|` in a medium of this index.
    fn oblique(&self, beta: f64, index: f64) -> Vec<Vec<f64>> {
        let slant = 1.0 / (1.0 - (beta / index).powi(2)).max(1e-12).sqrt();
        let pass = |t: &f64| if *t > 0.0 { t.powf(slant) } else { 0.0 };
        self.transmittance.iter().map(|row| row.iter().map(pass).collect()).collect()
    }

    fn periods(&self, shift_mm: [f64; 2]) -> [f64; 2] {
        [shift_mm[0] / self.pitch_mm[0], shift_mm[1] / self.pitch_mm[1]]
    }
}

/// Adds values by wavelength, each times its weight.
fn add_weighted(sums: &mut [f64], values: &[f64], weights: &[f64]) {
    for (sums, values) in sums.chunks_exact_mut(weights.len()).zip(values.chunks_exact(weights.len())) {
        sums.iter_mut().zip(values).zip(weights).for_each(|((sum, value), weight)| *sum += weight * value);
    }
}

/// All pairs of pieces along x and y.
fn products(pieces: &[Vec<Piece>; 2]) -> impl Iterator<Item = (&Piece, &Piece)> {
    pieces[1].iter().flat_map(|y| pieces[0].iter().map(move |x| (x, y)))
}

#[cfg(test)]
mod tests;
