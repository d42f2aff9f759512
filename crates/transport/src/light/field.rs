//! Light from the whole hemisphere: a radiance for each direction of the hemisphere of air.
//!
//! # Model
//! A field consists of cells, rows of inclination times equal columns of azimuth with uniform radiance in
//! each (exact for rings, and for a map over a horizontal display); or of the [`Pixels`] of a map in any
//! orientation; or of a formula ([`Radiance`]). Pixels and formulas are evaluated for look-ups and for means
//! over a view, and integrated for sums of the light with smooth functions ([`gathered`]: pixels in any
//! orientation). Radiance is stored for unit irradiance in the display plane: its integral over direction
//! cosines is 1.
//!
//! [`Field::sample`] samples directions (inverse cumulative distributions of rows, then of columns; uniform
//! in direction cosines within a cell) with the density [`Field::density`]. For cells, the density is
//! proportional to the radiance. Formulas and pixels also have cells to sample from, which are about as
//! bright as they are, and nowhere dark where they are bright.
//!
//! A field of one column is the same at all azimuths.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

use papilio_optics::Beta;

use super::formula::{Edge, Formula, Polar, Radiance};
use super::gathered::{self, Channel, Gathered, ROWS, edges_deg, gather, means};
use super::pixels::Pixels;

/// Radiance by direction, zero outside its rows.
#[derive(Debug, Clone)]
pub struct Field {
    /// Cells from which directions are sampled.
    cells: Cells,
    light: Exact,
}

/// The radiances themselves.
#[derive(Debug, Clone)]
enum Exact {
    /// Those of the cells from which directions are sampled.
    Cells,
    Formula(OfUnit),
    Pixels(Arc<UnitPixels>),
}

/// Pixels, and the factor that makes their irradiance one.
#[derive(Debug, PartialEq)]
struct UnitPixels {
    pixels: Pixels,
    scale: f64,
    /// Their light, unless their pole is the normal.
    gathered: Option<Gathered>,
}

/// A formula, and the factor that makes its irradiance one.
#[derive(Debug, Clone)]
struct OfUnit {
    formula: Formula,
    scale: f64,
}

/// Light of a field in the form in which it is summed.
#[derive(Debug)]
pub(crate) enum Light<'a> {
    Cells(Lit<'a>),
    /// A formula, and the factor of its radiances.
    Formula(&'a Formula, f64),
    /// Pixels, the factor of their radiances, and their light unless their pole is the normal.
    Pixels(&'a Pixels, f64, Option<&'a Gathered>),
}

/// Lit rows of cells.
#[derive(Debug)]
pub(crate) struct Lit<'a> {
    /// The inclinations between which they lie, radians, and their radiances.
    pub(crate) rows: Vec<([f64; 2], &'a [f64])>,
    /// Azimuth at which the first column begins, radians.
    pub(crate) turn: f64,
}

#[derive(Debug, Clone, PartialEq)]
struct Cells {
    /// Inclinations between which the rows lie, radians, and the squares of their sines.
    edges: Vec<f64>,
    squares: Vec<f64>,
    columns: usize,
    /// Azimuth at which the first column begins, radians.
    turn: f64,
    /// `[row][column]`.
    radiance: Vec<f64>,
    /// Irradiance up to the end of each row.
    up_to_row: Vec<f64>,
    /// Up to the end of each column, as fractions of its row's; `[row][column]`.
    up_to_column: Vec<f64>,
}

/// Fraction of the mean over all cells that is sampled even where a formula or pixels seem dark: a cell that
/// contains an edge may do so.
const WHEREVER: f64 = 0.01;

impl PartialEq for Field {
    /// Formulas are equal if their irradiances and their cells are, to the last digit.
    fn eq(&self, other: &Self) -> bool {
        self.cells == other.cells
            && match (&self.light, &other.light) {
                (Exact::Cells, Exact::Cells) => true,
                (Exact::Formula(one), Exact::Formula(other)) => one.scale == other.scale,
                (Exact::Pixels(one), Exact::Pixels(other)) => one == other,
                _ => false,
            }
    }
}

impl Field {
    /// Builds a field of these radiances, shape `[row][column]`; returns it with the irradiance in the
    /// display plane.
    ///
    /// Rows lie between the inclinations `edges_deg`, which ascend from 0 or more to 90 or less; column k
    /// contains azimuths from k to k + 1 of `columns` parts of the circle. `None` if the sizes do not agree,
    /// if a radiance is negative or NaN, or if there is no light.
    pub fn new(edges_deg: &[f64], columns: usize, radiance: Vec<f64>) -> Option<(Self, f64)> {
        let (cells, irradiance) = Cells::new(edges_deg, columns, radiance)?;
        Some((Self { cells, light: Exact::Cells }, irradiance))
    }

    /// Builds a field from each channel of a picture, all with the same frame and the same number of columns;
    /// returns it with its irradiance and its integral over the solid angle above the display. `None` for a
    /// channel without light.
    pub fn of_pixels(channels: Vec<Pixels>) -> Vec<Option<(Self, [f64; 2])>> {
        if channels.iter().all(Pixels::is_level) {
            return channels.into_iter().map(Self::of_level_pixels).collect();
        }
        let gathered = gather(&channels);
        let field = |(pixels, Channel { gathered, cells }): (Pixels, Channel)| {
            let (sampled, _) = Cells::new(&edges_deg(ROWS), gathered::COLUMNS, wherever(cells))?;
            Self::of_sampled(sampled, pixels, Some(gathered))
        };
        channels.into_iter().zip(gathered).map(field).collect()
    }

    fn of_level_pixels(pixels: Pixels) -> Option<(Self, [f64; 2])> {
        let ([rows, columns], cells) = means(&pixels);
        let (sampled, _) = Cells::new(&edges_deg(rows), columns, wherever(cells))?;
        let sampled = sampled.turned(pixels.azimuth().to_degrees());
        Self::of_sampled(sampled, pixels, None)
    }

    fn of_sampled(cells: Cells, pixels: Pixels, gathered: Option<Gathered>) -> Option<(Self, [f64; 2])> {
        let [irradiance, light] = pixels.light();
        let unit = UnitPixels { pixels, scale: 1.0 / irradiance, gathered };
        (irradiance > 0.0 && irradiance.is_finite())
            .then(|| (Self { cells, light: Exact::Pixels(Arc::new(unit)) }, [irradiance, light]))
    }

    /// Returns a field of cells whose first column begins at this azimuth.
    #[must_use]
    pub fn turned(self, turn_deg: f64) -> Self {
        Self { cells: self.cells.turned(turn_deg), ..self }
    }

    /// Builds a field from a formula; returns it with its irradiance. Directions are sampled from cells as
    /// of [`Field::new`] with approximately the radiances of the formula, at any scale; they must cover
    /// everything that is lit. One column means that the formula is the same at all azimuths.
    pub fn of(
        radiance: Arc<dyn Radiance>,
        edges_deg: &[f64],
        columns: usize,
        about: Vec<f64>,
    ) -> Option<(Self, f64)> {
        let (cells, _) = Cells::new(edges_deg, columns, wherever(about))?;
        let formula = Formula::new(radiance, Polar::NORMAL);
        debug_assert!(columns > 1 || formula.is_round(), "one column has no azimuths");
        let irradiance = formula.irradiance();
        let light = Exact::Formula(OfUnit { formula, scale: 1.0 / irradiance });
        (irradiance > 0.0 && irradiance.is_finite()).then_some((Self { cells, light }, irradiance))
    }

    /// Returns this light times a factor of the direction it comes from, a unit vector away from the display, and its
    /// irradiance over that of this light; no field if none is left. `None` unless it is light of a formula. The factor is
    /// smooth except along the normal, and where the formula is not.
    pub(crate) fn times(&self, factor: Factor) -> Option<(Option<Self>, f64)> {
        let Exact::Formula(OfUnit { formula, scale }) = &self.light else { return None };
        let rows = self.cells.squares.len() - 1;
        let columns = if self.cells.columns == 1 { COLUMNS } else { self.cells.columns };
        let mut about = Vec::with_capacity(rows * columns);
        for row in self.cells.edges.windows(2) {
            for column in 0..columns {
                let points = [(0.25, 0.25), (0.25, 0.75), (0.75, 0.25), (0.75, 0.75)];
                let light = points.map(|(along, turn)| {
                    let (sin, cos) = (row[0] + along * (row[1] - row[0])).sin_cos();
                    let (y, x) = (self.cells.turn + TAU * (column as f64 + turn) / columns as f64).sin_cos();
                    let direction = [sin * x, sin * y, cos];
                    formula.radiance(direction) * factor(direction)
                });
                about.push(light.iter().sum());
            }
        }
        let edges: Vec<f64> = self.cells.edges.iter().map(|edge| edge.to_degrees()).collect();
        let product = Product { radiance: formula.of_light(), factor };
        Some(match Self::of(Arc::new(product), &edges, columns, about) {
            Some((field, irradiance)) => {
                (Some(field.turned(self.cells.turn.to_degrees())), irradiance * scale)
            }
            None => (None, 0.0),
        })
    }

    /// Returns uniform light from a ring around the normal, or from a cap if it begins at 0, degrees.
    pub fn ring(from_deg: f64, to_deg: f64) -> Option<Self> {
        Some(Self::new(&[from_deg, to_deg], 1, vec![1.0])?.0)
    }

    /// Returns radiance over irradiance, 1/sr, of the light that propagates with `beta`.
    #[inline]
    pub fn radiance(&self, beta: Beta) -> f64 {
        // Directions beyond the horizon carry no light.
        let source = || {
            let square = 1.0 - beta.squared();
            (square >= -1e-12).then(|| [-beta.x, -beta.y, square.max(0.0).sqrt()])
        };
        match &self.light {
            Exact::Cells => self.cells.at(beta),
            Exact::Formula(OfUnit { formula, scale }) => {
                source().map_or(0.0, |direction| scale * formula.radiance(direction))
            }
            Exact::Pixels(unit) => source().map_or(0.0, |direction| unit.scale * unit.pixels.at(direction)),
        }
    }

    /// Returns the density over direction cosines with which [`Self::sample`] samples this direction.
    #[inline]
    pub fn density(&self, beta: Beta) -> f64 {
        self.cells.at(beta)
    }

    /// Samples a direction approximately by radiance; returns the direction cosines of its light, and
    /// [`Self::density`] there.
    #[inline]
    pub fn sample(&self, u: [f64; 2]) -> (Beta, f64) {
        self.cells.sample(u)
    }

    /// Returns true if it is the same at all azimuths.
    pub fn is_ring(&self) -> bool {
        self.cells.columns == 1
    }

    /// Returns the light in the form in which it is summed.
    pub(crate) fn light(&self) -> Light<'_> {
        match &self.light {
            Exact::Cells => Light::Cells(self.cells.lit()),
            Exact::Formula(OfUnit { formula, scale }) => Light::Formula(formula, *scale),
            Exact::Pixels(unit) => Light::Pixels(&unit.pixels, unit.scale, unit.gathered.as_ref()),
        }
    }
}

/// Number of columns of light that depends on azimuth, where it was the same at all.
const COLUMNS: usize = 180;

/// A factor by direction.
pub(crate) type Factor = Arc<dyn Fn([f64; 3]) -> f64 + Send + Sync>;

/// A radiance times a factor.
struct Product {
    radiance: Arc<dyn Radiance>,
    factor: Factor,
}

impl std::fmt::Debug for Product {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Product").field("radiance", &self.radiance).finish_non_exhaustive()
    }
}

impl Radiance for Product {
    fn at(&self, direction: [f64; 3]) -> f64 {
        self.radiance.at(direction) * (self.factor)(direction)
    }

    fn edges(&self) -> Vec<Edge> {
        let normal = Edge { centre: [0.0, 0.0, 1.0], radius: 0.0, scale: 0.0 };
        self.radiance.edges().into_iter().chain([normal]).collect()
    }

    fn span(&self) -> [f64; 2] {
        self.radiance.span()
    }

    /// A factor may: that of a polarised sky, whose luminance is round, does.
    fn has_azimuths(&self) -> bool {
        true
    }
}

/// Adds a little light everywhere to radiances of cells from which directions are sampled.
fn wherever(mut radiance: Vec<f64>) -> Vec<f64> {
    let mean = radiance.iter().sum::<f64>() / radiance.len() as f64;
    radiance.iter_mut().for_each(|value| *value += WHEREVER * mean);
    radiance
}

impl Cells {
    fn new(edges_deg: &[f64], columns: usize, radiance: Vec<f64>) -> Option<(Self, f64)> {
        let rows = edges_deg.len().checked_sub(1)?;
        let ascend = edges_deg.windows(2).all(|pair| pair[0] < pair[1]);
        let within = *edges_deg.first()? >= 0.0 && *edges_deg.last()? <= 90.0;
        if !ascend || !within || columns == 0 || rows.checked_mul(columns)? != radiance.len() {
            return None;
        }
        let edges: Vec<f64> = edges_deg.iter().map(|edge| edge.to_radians().min(FRAC_PI_2)).collect();
        let squares: Vec<f64> = edges.iter().map(|edge| edge.sin().powi(2)).collect();
        let (mut up_to_row, mut up_to_column) =
            (Vec::with_capacity(rows), Vec::with_capacity(radiance.len()));
        let mut irradiance = 0.0;
        for (row, squares) in radiance.chunks_exact(columns).zip(squares.windows(2)) {
            let start = up_to_column.len();
            let mut sum = 0.0;
            for value in row {
                sum += value;
                up_to_column.push(sum);
            }
            up_to_column[start..].iter_mut().for_each(|part| *part /= if sum > 0.0 { sum } else { 1.0 });
            irradiance += sum * cell_area(squares, columns);
            up_to_row.push(irradiance);
        }
        let is_light = irradiance > 0.0 && irradiance.is_finite();
        if !is_light || !radiance.iter().all(|value| *value >= 0.0) {
            return None;
        }
        up_to_row.iter_mut().for_each(|part| *part /= irradiance);
        let radiance = radiance.into_iter().map(|value| value / irradiance).collect();
        Some((Self { edges, squares, columns, turn: 0.0, radiance, up_to_row, up_to_column }, irradiance))
    }

    fn turned(self, turn_deg: f64) -> Self {
        Self { turn: turn_deg.to_radians(), ..self }
    }

    #[inline(always)]
    fn at(&self, beta: Beta) -> f64 {
        let square = beta.squared();
        let row = match self.squares.partition_point(|edge| *edge <= square) {
            0 => return 0.0,
            // The last row includes its own end, grazing light.
            all if all == self.squares.len() && square > self.squares[all - 1] => return 0.0,
            all if all == self.squares.len() => all - 2,
            after => after - 1,
        };
        self.row(row)[self.column(beta)]
    }

    /// Returns the column that sends light of these direction cosines.
    #[inline]
    fn column(&self, beta: Beta) -> usize {
        if self.columns == 1 {
            return 0;
        }
        let turn = ((-beta.y).atan2(-beta.x) - self.turn).rem_euclid(TAU) / TAU;
        ((turn * self.columns as f64) as usize).min(self.columns - 1)
    }

    #[inline(always)]
    fn sample(&self, u: [f64; 2]) -> (Beta, f64) {
        let (row, along) = pick(&self.up_to_row, u[0]);
        let (column, turn) = pick(&self.up_to_column[row * self.columns..][..self.columns], u[1]);
        let square = self.squares[row] + along * (self.squares[row + 1] - self.squares[row]);
        let (sin, cos) = (self.turn + (column as f64 + turn) * TAU / self.columns as f64).sin_cos();
        let radius = -square.sqrt();
        (Beta { x: radius * cos, y: radius * sin }, self.row(row)[column])
    }

    fn lit(&self) -> Lit<'_> {
        let rows = self.edges.windows(2).zip(self.radiance.chunks_exact(self.columns));
        let lit = rows.filter(|(_, row)| row.iter().any(|value| *value > 0.0));
        Lit { rows: lit.map(|(edges, row)| ([edges[0], edges[1]], row)).collect(), turn: self.turn }
    }

    fn row(&self, row: usize) -> &[f64] {
        &self.radiance[row * self.columns..][..self.columns]
    }
}

/// Returns the area of a row's cells in direction cosines.
fn cell_area(squares: &[f64], columns: usize) -> f64 {
    0.5 * (squares[1] - squares[0]) * TAU / columns as f64
}

/// Returns the interval of cumulative fractions up to 1 that contains `u`, and the position in it.
#[inline]
fn pick(up_to: &[f64], u: f64) -> (usize, f64) {
    // Empty intervals are never selected: their end is not larger than the end before.
    let k = up_to.partition_point(|end| *end <= u).min(up_to.len() - 1);
    let from = if k > 0 { up_to[k - 1] } else { 0.0 };
    (k, ((u - from) / (up_to[k] - from)).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use papilio_sampling::{SampleStream, Sampler};

    fn patches() -> Field {
        let radiance = vec![0.0, 1.0, 2.0, 0.5, 3.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.1, 1.0, 0.0];
        Field::new(&[0.0, 10.0, 35.0, 60.0, 90.0], 4, radiance).unwrap().0
    }

    /// Chi-square of sampled directions over cells, compared with the integral of the density over each.
    #[test]
    fn sampled_directions_follow_radiance() {
        let field = patches();
        let numbers = SampleStream::new(Sampler::Random, 7, 0);
        let (samples, mut counts) = (40_000_u64, [0.0; 16]);
        for path in 0..samples {
            let u = numbers.block(path, 0);
            let (beta, density) = field.sample([u[0], u[1]]);
            assert_eq!(density, field.radiance(beta));
            let row = field.cells.squares.partition_point(|square| *square <= beta.squared()) - 1;
            counts[row * 4 + field.cells.column(beta)] += 1.0;
        }
        let expected = |cell: usize| {
            field.cells.radiance[cell] * cell_area(&field.cells.squares[cell / 4..], 4) * samples as f64
        };
        let cells = counts.iter().enumerate().map(|(cell, count)| (*count, expected(cell)));
        let found = papilio_testing::ChiSquare::of(cells, 5.0);
        assert!(found.is_likely() && found.freedom == 7.0, "eight lit cells: {found:?}");
    }

    /// The irradiance of one, computed in two ways: the sum over cells, and uniform directions in the disc.
    #[test]
    fn radiance_integrates_to_one() {
        let field = patches();
        let numbers = SampleStream::new(Sampler::Sobol, 0, 0);
        let samples = 1 << 15;
        let mean: f64 = (0..samples)
            .map(|path| {
                let u = numbers.block(path, 0);
                let (x, y) = papilio_sampling::warp::uniform_disc(1.0, [u[0], u[1]]);
                std::f64::consts::PI * field.radiance(Beta { x, y })
            })
            .sum();
        assert!((mean / samples as f64 - 1.0).abs() < 2e-3, "{mean}");
    }

    #[test]
    fn column_contains_light_from_its_azimuth() {
        // Only the column from 0 to 90 deg is lit.
        let (field, irradiance) = Field::new(&[0.0, 90.0], 4, vec![2.0, 0.0, 0.0, 0.0]).unwrap();
        assert!((irradiance - 0.5 * std::f64::consts::PI).abs() < 1e-15);
        assert!(field.radiance(Beta::from_source(40.0, 45.0, 1.0)) > 0.0);
        assert_eq!(field.radiance(Beta::from_source(40.0, 135.0, 1.0)), 0.0);
        assert_eq!(field.radiance(Beta::from_source(-40.0, 45.0, 1.0)), 0.0);
    }

    #[test]
    fn invalid_fields_are_refused() {
        assert!(Field::new(&[0.0, 90.0], 1, vec![0.0]).is_none());
        assert!(Field::new(&[0.0, 90.0], 1, vec![-1.0]).is_none());
        assert!(Field::new(&[0.0, 90.0], 2, vec![2.0, -1.0]).is_none());
        assert!(Field::new(&[0.0, 90.0], 2, vec![f64::NAN, 1.0]).is_none());
        assert!(Field::new(&[0.0, 90.0], 2, vec![1.0]).is_none());
        assert!(Field::new(&[0.0, 0.0], 1, vec![1.0]).is_none());
        assert!(Field::new(&[0.0, 91.0], 1, vec![1.0]).is_none());
        assert!(Field::new(&[], 1, vec![]).is_none());
    }
}
