//! Irradiance of cells of given reflectances, to which the layers of a flat panel or a front return light:
//! `E = 1 + A * (rho E)`.

use std::f64::consts::PI;

use papilio_optics::Beta;
use papilio_transport::Cone;
use papilio_transport::spatial::{
    Cells, LambertianReturn, PixelSpread, Recycling, displacement, fraction_of_order, orders_between,
};

use super::Level;
use super::below_layers::Layers;
use super::ghosts::Faces;
use super::response::Lit;
use crate::DisplayError;
use crate::setup::ViewPoint;

/// Most meetings of light with mirror-like pixels that are followed one by one. Those of pixels and a front
/// of 0.99 each are; of better mirrors the rest is taken as a geometric series.
const MOST_ORDERS: usize = 1000;

/// Computes the irradiance of cells from their reflectances and a tolerance.
pub(super) type Solver<'a> = Box<dyn Fn(&[f64], f64) -> Vec<f64> + 'a>;

/// Place of an image, mm, and the fraction of the light that it has at the wavelengths.
pub(super) type PlacedImage = ([f64; 2], Vec<f64>);

/// Images that have less than this fraction of the light belong to the one before.
const FAINTEST_IMAGE: f64 = 1e-6;

/// What lies above pixels: the layers of an ordinary panel, or general layers above Lambertian pixels.
#[derive(Clone, Copy)]
pub(super) enum Above<'a> {
    Panel(Lit<'a>),
    Layers(&'a Layers),
}

impl Above<'_> {
    pub(super) fn level(&self) -> Level {
        match self {
            Self::Panel(lit) => lit.level,
            Self::Layers(layers) => layers.level,
        }
    }

    /// Level of adding of the light of pages.
    pub(super) fn level_of_pages(&self) -> u32 {
        match self {
            Self::Panel(lit) => lit.level.of_pages(),
            Self::Layers(layers) => layers.level.of_layers(),
        }
    }

    /// How finely light varies that comes back.
    pub(super) fn thickness_mm(&self) -> f64 {
        match self {
            Self::Panel(lit) => lit.thickness_mm(),
            Self::Layers(layers) => layers.thickness_mm(),
        }
    }

    /// How far light spreads that comes back.
    pub(super) fn reach_mm(&self) -> Result<f64, DisplayError> {
        match self {
            Self::Panel(lit) => lit.reach_mm(),
            Self::Layers(layers) => Ok(layers.height_mm),
        }
    }

    /// Whether light spreads inside the pixels.
    pub(super) fn spreads(&self) -> bool {
        matches!(self, Self::Panel(Lit { spread: Some(_), .. }))
    }

    /// What comes back to the pixels, for cells with frequencies up to `most_per_mm`.
    pub(super) fn returns(&self, most_per_mm: f64) -> Result<Vec<Return>, DisplayError> {
        match self {
            Self::Panel(lit) => Return::all(*lit, most_per_mm),
            Self::Layers(layers) => {
                Ok(layers.returns().into_iter().map(|one| Return::Everywhere(one, None)).collect())
            }
        }
    }

    /// Sharp images of the pixels: the first one shows each at its own place. None is sharp below general
    /// layers ([`seen_from`](Self::seen_from)).
    pub(super) fn images(&self) -> Result<Vec<PlacedImage>, DisplayError> {
        match self {
            Self::Panel(lit) if lit.panel.base.is_specular() => images(*lit),
            Self::Panel(lit) => images_of_field(*lit),
            Self::Layers(_) => Ok(Vec::new()),
        }
    }

    /// How much the light of each cell counts in the mean of what the view sees at some cells, for what comes
    /// back by its number, and the fraction of the light at each wavelength that is seen so; `None` if all of
    /// it is in sharp images.
    pub(super) fn seen_from(
        &self,
        number: usize,
        cells: Cells,
        seen: &[usize],
    ) -> Option<(Vec<f64>, Vec<f64>)> {
        match self {
            Self::Panel(_) => None,
            Self::Layers(layers) => Some((layers.seen_from(number, cells, seen), vec![1.0; layers.bins])),
        }
    }
}

/// What comes back to pixels, at wavelengths at which it is the same.
pub(super) enum Return {
    /// To Lambertian pixels, inside which light may spread.
    Everywhere(LambertianReturn, Option<PixelSpread>),
    /// To mirror-like pixels, in the direction of the view.
    Trips(Trips),
}

/// Round trips of light that keeps its direction between pixels and flat faces.
pub(super) struct Trips {
    bins: Vec<usize>,
    index: f64,
    /// Distance between meetings, and how much a trip through the air above the face adds, mm.
    step_mm: [f64; 2],
    air_mm: [f64; 2],
    faces: Faces,
}

impl Return {
    /// What comes back to the pixels of a panel, for cells with frequencies up to `most_per_mm`.
    fn all(lit: Lit<'_>, most_per_mm: f64) -> Result<Vec<Self>, DisplayError> {
        if !lit.panel.base.is_specular() {
            let all = lit.lambertian_return(most_per_mm)?;
            return Ok(all.into_iter().map(|one| Self::Everywhere(one, lit.spread)).collect());
        }
        let (beta, index) = (lit.view.field.axis_towards(), lit.panel.medium.index());
        let air_mm = displacement(beta, 2.0 * lit.air_mm()?, 1.0);
        let mut all: Vec<Trips> = Vec::new();
        for bin in 0..index.len() {
            let faces = Faces::new(lit.faces(bin, beta), air_mm != [0.0; 2]);
            let same = |one: &&mut Trips| one.index == index[bin] && one.faces == faces;
            if let Some(known) = all.iter_mut().find(same) {
                known.bins.push(bin);
                continue;
            }
            let step_mm = displacement(beta, 2.0 * lit.thickness_mm(), index[bin]);
            all.push(Trips { bins: vec![bin], index: index[bin], step_mm, air_mm, faces });
        }
        Ok(all.into_iter().map(Self::Trips).collect())
    }

    /// Numbers of the wavelengths.
    pub(super) fn bins(&self) -> &[usize] {
        match self {
            Self::Everywhere(returned, _) => &returned.bins,
            Self::Trips(trips) => &trips.bins,
        }
    }

    /// Fraction of the light of a page that comes back.
    pub(super) fn of_page(&self) -> f64 {
        match self {
            Self::Everywhere(returned, _) => returned.at(0.0),
            Self::Trips(trips) => trips.faces.returned(),
        }
    }

    /// Solves the irradiance of cells, given their reflectances and a tolerance.
    pub(super) fn solver<'a>(&'a self, cells: Cells) -> Solver<'a> {
        match self {
            Self::Everywhere(returned, spread) => {
                let recycling = Recycling::new(cells, |f| returned.at(f)).with_spread(*spread);
                Box::new(move |rho, tolerance| recycling.irradiance(rho, tolerance))
            }
            Self::Trips(Trips { faces, step_mm, air_mm, .. }) => {
                Box::new(move |rho, tolerance| irradiance(faces, [*step_mm, *air_mm], cells, rho, tolerance))
            }
        }
    }
}

/// Irradiance of mirror-like cells of these reflectances; the ways are those of a trip through the glass and
/// of one through the air above it.
pub(super) fn irradiance(
    faces: &Faces,
    [step_mm, air_mm]: [[f64; 2]; 2],
    cells: Cells,
    rho: &[f64],
    tolerance: f64,
) -> Vec<f64> {
    let ways = (0..faces.returned.len())
        .map(|k| Way::new(cells, [0, 1].map(|axis| step_mm[axis] + k as f64 * air_mm[axis])));
    let ways: Vec<Way> = ways.collect();
    let mut irradiance = vec![1.0; rho.len()];
    let mut last = f64::INFINITY;
    for order in 1.. {
        let light: Vec<f64> = rho.iter().zip(&irradiance).map(|(rho, e)| rho * e).collect();
        let mut next = vec![1.0; rho.len()];
        for (part, way) in faces.returned.iter().zip(&ways) {
            way.add(*part, &light, &mut next);
        }
        let change = next.iter().zip(&irradiance).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let before = std::mem::replace(&mut irradiance, next);
        if change <= tolerance {
            break;
        }
        if order == MOST_ORDERS {
            // Light of the last order, and of all that follow.
            let ratio = change / last;
            let rest = if ratio < 1.0 { ratio / (1.0 - ratio) } else { 0.0 };
            irradiance.iter_mut().zip(before).for_each(|(e, before)| *e += rest * (*e - before));
            break;
        }
        last = change;
    }
    irradiance
}

/// Natural digits of the mean over the directions of a field of view, at the coarse and the finer level. Pixels have
/// edges: more digits gain little.
const DIGITS_OF_FIELD: [f64; 2] = [3.0, 5.0];

/// Directions of a field of view along which flat faces show other places, and their fractions of the field.
pub(super) fn along_field(lit: Lit<'_>) -> Result<Vec<(ViewPoint, f64)>, DisplayError> {
    let (field, index, level) = (&lit.view.field, lit.panel.medium.index().min(), lit.level);
    let air_mm = lit.air_mm()?;
    let mm_per_beta = 2.0 * (lit.thickness_mm() / (index * index - 1.0).max(0.1).sqrt() + air_mm);
    let phase = 2.0 * PI * level.most_per_mm * mm_per_beta * field.half_angle();
    let digits = DIGITS_OF_FIELD[usize::from(level.is_fine)] + f64::from(level.finer);
    let along = |(beta, share): (Beta, f64)| {
        let theta_deg = beta.length().min(1.0).asin().to_degrees();
        let phi_deg = beta.y.atan2(beta.x).to_degrees();
        (ViewPoint { theta_deg, phi_deg, field: Cone::new(theta_deg, phi_deg, 0.0, 1.0) }, share)
    };
    Ok(field.directions(phase, digits).into_iter().map(along).collect())
}

/// [`images`] of all directions of a field of view.
pub(super) fn images_of_field(lit: Lit<'_>) -> Result<Vec<PlacedImage>, DisplayError> {
    let along_axis = images(lit)?;
    let directions = along_field(lit)?;
    if directions.len() < 2 || lit.air_mm()? == 0.0 {
        return Ok(along_axis);
    }
    let mut all: Vec<PlacedImage> = Vec::new();
    for (view, share) in directions {
        for (number, (at_mm, mut fraction)) in images(Lit { view: &view, ..lit })?.into_iter().enumerate() {
            fraction.iter_mut().for_each(|part| *part *= share);
            match all.first_mut() {
                // Each direction sees the pixel itself at its own place.
                Some((_, sum)) if number == 0 => {
                    sum.iter_mut().zip(fraction).for_each(|(sum, part)| *sum += part);
                }
                _ => all.push((at_mm, fraction)),
            }
        }
    }
    Ok(all)
}

/// Images of the pixels that a view sees because light was reflected between a flat face and a front above
/// it: the place of each, mm, and the fraction of the light that each has at the wavelengths.
pub(super) fn images(lit: Lit<'_>) -> Result<Vec<PlacedImage>, DisplayError> {
    let air_mm = lit.air_mm()?;
    let beta = lit.view.field.axis_towards();
    let way = displacement(beta, 2.0 * air_mm, 1.0);
    let bins = lit.panel.base.bins();
    let between: Vec<[(f64, f64); 2]> = (0..bins).map(|bin| lit.between(bin, beta)).collect();
    let all = between.iter().flatten().map(|(between, _)| *between);
    let largest = if way == [0.0; 2] { 0.0 } else { all.fold(0.0, f64::max) };
    let count = orders_between(largest, FAINTEST_IMAGE);
    let one = |k: usize| {
        let fraction = |(between, share): (f64, f64)| share * fraction_of_order(between, k, count);
        let fraction = |both: &[(f64, f64); 2]| both.map(fraction).iter().sum();
        (way.map(|way| k as f64 * way), between.iter().map(fraction).collect())
    };
    Ok((0..count).map(one).collect())
}

/// Light of cells from a place so far away: of a cell, the part that lies there.
pub(super) fn moved(light: &[f64], cells: Cells, way_mm: [f64; 2]) -> Vec<f64> {
    let mut sum = vec![0.0; light.len()];
    Way::new(cells, way_mm).add(1.0, light, &mut sum);
    sum
}

/// A displacement on a grid of cells.
struct Way {
    count: [usize; 2],
    /// Of each axis, how many cells away the two cells are in which the place lies, and the part in the second.
    axes: [([usize; 2], f64); 2],
}

impl Way {
    fn new(Cells { count, period_mm }: Cells, way_mm: [f64; 2]) -> Self {
        let of_axis = |axis: usize| {
            let at = way_mm[axis] / period_mm[axis] * count[axis] as f64;
            let first = at.floor();
            let steps =
                [first, first + 1.0].map(|step| (step as i64).rem_euclid(count[axis] as i64) as usize);
            (steps, if count[axis] > 1 { at - first } else { 0.0 })
        };
        Self { count, axes: [0, 1].map(of_axis) }
    }

    /// Adds this fraction of the light from there to each cell.
    fn add(&self, part: f64, light: &[f64], sum: &mut [f64]) {
        let ([columns, rows], [x, y]) = (self.count, &self.axes);
        let parts = |of: f64, ([near, far], second): &([usize; 2], f64)| {
            [(*near, of * (1.0 - second)), (*far, of * second)]
        };
        for (down, part) in parts(part, y).into_iter().filter(|(_, part)| *part != 0.0) {
            for (row, sum) in sum.chunks_exact_mut(columns).enumerate() {
                let light = &light[(row + rows - down) % rows * columns..][..columns];
                for (along, part) in parts(part, x).into_iter().filter(|(_, part)| *part != 0.0) {
                    // The last cells of a row come first.
                    let (head, tail) = sum.split_at_mut(along);
                    let (first, last) = light.split_at(columns - along);
                    head.iter_mut().zip(last).for_each(|(sum, light)| *sum += part * light);
                    tail.iter_mut().zip(first).for_each(|(sum, light)| *sum += part * light);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STRIPES: Cells = Cells { count: [16, 1], period_mm: [1.6, 1.0] };

    /// A front of 0.97 above mirrors of 0.97, as of electrowetting with a half mirror.
    fn bright() -> Faces {
        Faces { returned: vec![0.97], leaving: vec![1.0] }
    }

    fn found(faces: &Faces, step_mm: f64, rho: &[f64]) -> Vec<f64> {
        irradiance(faces, [[step_mm, 0.0], [0.0; 2]], STRIPES, rho, 1e-9)
    }

    /// A cell has the light of the two cells in which the place lies from which it comes, by linear interpolation: on both axes,
    /// and over the end of the period.
    #[test]
    fn light_moves_by_parts_of_cells() {
        let cells = Cells { count: [4, 3], period_mm: [2.0, 1.5] };
        let light: Vec<f64> = (0..12).map(|cell| f64::from(cell * cell)).collect();
        let at = |column: i64, row: i64| light[(row.rem_euclid(3) * 4 + column.rem_euclid(4)) as usize];
        // Cells are 0.5 mm wide: 1.2 cells along a row, 0.7 of a row back.
        let found = moved(&light, cells, [0.6, -0.35]);
        for (cell, found) in found.into_iter().enumerate() {
            let (x, y) = ((cell % 4) as i64, (cell / 4) as i64);
            let of_row = |y: i64| 0.8 * at(x - 1, y) + 0.2 * at(x - 2, y);
            let expected = 0.3 * of_row(y) + 0.7 * of_row(y + 1);
            assert!((found - expected).abs() < 1e-12, "{x} {y}: {found} {expected}");
        }
    }

    /// 1/(1 - F rho) of a page, wherever light goes; a geometric series of up to 1e5 orders, too.
    #[test]
    fn irradiance_of_bright_mirrors_is_that_of_all_orders() {
        for (front, rho) in [(0.04, 0.9), (0.97, 0.97), (0.99, 0.99), (0.999, 0.9999), (0.9999, 0.9999)] {
            let faces = Faces { returned: vec![front], leaving: vec![1.0] };
            let expected = 1.0 / (1.0 - front * rho);
            for e in found(&faces, 0.13, &[rho; 16]) {
                assert!((e / expected - 1.0).abs() < 1e-6, "{front} {rho}: {e} {expected}");
            }
        }
        // Nothing leaves: the sum has no end.
        let closed = Faces { returned: vec![1.0], leaving: vec![1.0] };
        assert!(found(&closed, 0.13, &[1.0; 16]).iter().all(|e| e.is_finite()));
    }

    /// Stripes of 8 cells each. Half a period on, light meets the other state; a quarter on, two of each in
    /// turn.
    #[test]
    fn irradiance_of_stripes_of_bright_mirrors_has_a_closed_form() {
        let (f, states) = (0.97, [0.97, 0.2]);
        let rho: Vec<f64> = (0..16).map(|cell| states[cell / 8]).collect();
        for (step_mm, period) in [(0.8, 2), (0.4, 4)] {
            let half = period / 2;
            for (cell, e) in found(&bright(), step_mm, &rho).into_iter().enumerate() {
                // Light that meets a cell has met those at these steps before it: E = 1 + F rho_1 (1 + F
                // rho_2 (...)), which repeats.
                let at = |k: usize| f * rho[(cell + 16 * period - k * 8 / half) % 16];
                let (mut sum, mut product) = (0.0, 1.0);
                for k in 1..=period {
                    sum += product;
                    product *= at(k);
                }
                let expected = sum / (1.0 - product);
                assert!((e / expected - 1.0).abs() < 1e-7, "{step_mm} {cell}: {e} {expected}");
            }
        }
    }
}
