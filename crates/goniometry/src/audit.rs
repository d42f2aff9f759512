//! Quality of a measurement: coverage, energy, reciprocity, holes, noise, haze.
//!
//! Reciprocity is a matter of pairs of directions that were both measured ([`reciprocity`]).
//!
//! Haze and clarity are the values of a hazemeter in the same light, computed from the goniometric data. ASTM
//! D1003 defines haze up to 30 %; above that it refers to goniometric methods (ASTM E2387). Clarity has no
//! standard. It is defined here as `(C - R)/(C + R)`, where C is the light within 1 deg of the direct beam,
//! and R the light between 1 and 2.5 deg.

mod cells;
mod patches;
mod reciprocity;

use crate::shape::{Extent, Resampling, inclined_to_deg, on_specular_grid, pair_interpolation};
use crate::{Fill, Geometry, MeasuredPart, PairErrors, Shape, SpecularGrid};

/// Smallest angle of light that counts as haze, degrees (ASTM D1003).
const HAZE_DEG: f64 = 2.5;
/// Radius of the inner disc of clarity, degrees.
const CLEAR_DEG: f64 = 1.0;
/// Angle from the incident light within which the source may hide cells, degrees.
const BEAM_DEG: f64 = 7.5;
/// Fraction of the peak above which values are tested for reciprocity.
const FAINT: f64 = 1e-3;

/// Quality of one channel of one part.
#[derive(Debug, Clone, PartialEq)]
pub struct Audit {
    /// Number of cells in the hemisphere.
    pub cells: usize,
    /// Cells with a positive value.
    pub lit: usize,
    /// Cells that were not measured (NaN).
    pub unmeasured: usize,
    /// Cells with a negative value.
    pub negative: usize,
    /// Largest inclination of a cell with light, degrees.
    pub dark_beyond_deg: f64,
    /// Cells without light below that inclination.
    pub holes: usize,
    /// Cells without light near the direction of the source, on its side (reflection).
    pub beam_holes: usize,
    /// Noise: standard deviation estimated from neighbouring values in the faint half of the cells, 1/sr.
    pub noise: f64,
    /// Smallest and largest positive value, 1/sr.
    pub range: [f64; 2],
    /// Difference of mirrored and rotated cells relative to their mean (root mean square).
    pub asymmetry: f64,
    /// Difference of f(i, o) and f(o, i) relative to their mean: root mean square, weighted by the light, and
    /// maximum.
    pub reciprocity: Option<[f64; 2]>,
    /// Fraction of the transmitted light beyond 2.5 deg, at the smallest incidence; only of a transmission.
    pub haze: Option<f64>,
    /// Clarity (see the module documentation), negative where there is more light in the ring than in the disc;
    /// only of a grid with steps of 0.5 deg or less near the peak that has light there.
    pub clarity: Option<f64>,
    /// First and last azimuth, degrees from the plane of incidence, if not 0 and 180; beyond them the nearest
    /// value is used.
    pub held_azimuths_deg: Option<[f64; 2]>,
    /// Largest inclination to which light was measured, degrees, if a grid of inclinations ends before the
    /// horizon.
    pub inclined_to_deg: Option<f64>,
    /// Of listed pairs of directions that form no grid.
    pub pairs: Option<ListedPairs>,
    /// Quality by incidence.
    pub incidences: Vec<Incidence>,
    /// Quality by rotation and incidence, of a measurement at several rotations.
    pub rotations: Vec<Rotation>,
}

/// Listed pairs of directions in any order, and the errors of the interpolation between them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ListedPairs {
    /// Number of different points: pairs that are mirror images or rotations of each other are one.
    pub points: usize,
    /// Largest inclinations of light and viewer, degrees.
    pub largest_deg: [f64; 2],
    /// Errors of the interpolation.
    pub errors: PairErrors,
}

/// Total scatter at one rotation and incidence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotation {
    /// Rotation of the sample, degrees.
    pub rotation_deg: f64,
    /// Inclination of the light, degrees.
    pub theta_deg: f64,
    /// Total integrated scatter stated in the file for this rotation.
    pub tis: Option<f64>,
    /// Integral of the values of this rotation.
    pub integral: f64,
}

/// Quality at one incidence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Incidence {
    /// Inclination of the light, degrees.
    pub theta_deg: f64,
    /// Total integrated scatter stated in the file, mean over rotations.
    pub tis: Option<f64>,
    /// Integral of the values, mean over rotations, with dark cells unchanged and no extrapolation.
    pub integral: f64,
    /// Smallest distance from the specular direction, degrees, at which measured cells end before the
    /// horizon.
    pub measured_to_deg: Option<f64>,
    /// Integral with tails extrapolated beyond the last measured distance.
    pub integral_beyond: f64,
    /// Integral with tails extrapolated, also into dark cells.
    pub integral_filled: f64,
    /// Relative uncertainty of the integral from the grid: of distances and azimuths together; `None` for listed
    /// pairs, for which it is not known.
    pub grid_error: Option<f64>,
    /// Relative uncertainty of the integral from the grid's azimuths; `None` as `grid_error`.
    pub azimuth_error: Option<f64>,
    /// Value in the specular direction, 1/sr; `None` if this is beyond the largest measured angle.
    pub peak: Option<f64>,
    /// Distance from the specular direction to half the peak, degrees: towards the normal, sideways, away
    /// from the normal.
    pub half_widths_deg: [Option<f64>; 3],
}

impl Incidence {
    /// Quality of an incidence whose values are constant over cells: the integral is their sum, without
    /// interpolation.
    fn of_cells(theta_deg: f64, integral: f64, peak: f64) -> Self {
        Self {
            theta_deg,
            tis: None,
            integral,
            measured_to_deg: None,
            integral_beyond: integral,
            integral_filled: integral,
            grid_error: Some(0.0),
            azimuth_error: Some(0.0),
            peak: Some(peak),
            half_widths_deg: [None; 3],
        }
    }

    /// Fraction of the light beyond the last measured distance, if tails are extrapolated.
    pub fn beyond_share(&self) -> f64 {
        if self.integral_beyond > 0.0 { (1.0 - self.integral / self.integral_beyond).max(0.0) } else { 0.0 }
    }
}

/// Channels of a part that are audited: they share the resampling and the width of the interpolation.
#[derive(Debug)]
pub struct Channels<'a> {
    part: &'a MeasuredPart,
    channels: Vec<usize>,
    /// Values on a specular-centred grid, and the width, if the cells are not summed.
    grid: Option<(SpecularGrid, Vec<f64>)>,
    width: Option<f64>,
    /// What is known of the resampling: of the luminous channel, or of the first.
    resampling: Resampling,
}

impl<'a> Channels<'a> {
    /// Channels of a part, given by their indices; `None` for fewer than 12 different listed pairs.
    pub fn new(part: &'a MeasuredPart, channels: Vec<usize>) -> Option<Self> {
        if let Geometry::Patches { .. } | Geometry::Tree(_) = &part.geometry {
            return Some(Self { part, channels, grid: None, width: None, resampling: Resampling::default() });
        }
        let (grid, values) = on_specular_grid(part, &channels)?;
        // All are interpolated with the width of the luminous one, or of the first: lobes of a sample differ
        // little in it.
        let luminous = channels.iter().position(|channel| *channel == part.luminous()).unwrap_or(0);
        let width = (channels.len() > 1).then(|| {
            Shape::of_grid(&grid, &values[luminous * grid.cells()..][..grid.cells()], Fill::None).width()
        });
        let resampling = channels.get(luminous).map(|channel| Resampling::new(part, *channel, &grid));
        let resampling = resampling.unwrap_or_default();
        Some(Self { part, channels, grid: Some((grid, values)), width, resampling })
    }

    /// Number of channels.
    pub fn count(&self) -> usize {
        self.channels.len()
    }

    /// Audits the channel with this number among them.
    pub fn audit(&self, number: usize) -> Audit {
        let channel = self.channels[number];
        match (&self.part.geometry, &self.grid) {
            (_, Some((grid, values))) => {
                let values = &values[number * grid.cells()..][..grid.cells()];
                Audit::on_grid(self.part, channel, (grid, values), (self.width, &self.resampling))
            }
            (Geometry::Tree(tree), None) => cells::audit(tree, self.part, channel),
            (Geometry::Patches { incoming, outgoing }, None) => {
                patches::audit([incoming, outgoing], self.part.channel(channel))
            }
            (_, None) => Audit::empty(),
        }
    }
}

impl Audit {
    /// Audits one channel, given by its index. Patches and the cells of trees are summed directly. A part on
    /// another geometry is first resampled on a specular-centred grid, and its cells are those of that grid.
    /// `None` for fewer than 12 different listed pairs.
    pub fn of(part: &MeasuredPart, channel: usize) -> Option<Self> {
        Some(Channels::new(part, vec![channel])?.audit(0))
    }

    /// Audits the values of a channel on a specular-centred grid.
    fn on_grid(
        part: &MeasuredPart,
        channel: usize,
        (grid, values): (&SpecularGrid, &[f64]),
        (width, resampling): (Option<f64>, &Resampling),
    ) -> Self {
        let inclined_to_deg = inclined_to_deg(part, channel);
        let extent = Extent { width, inclined_to_deg, ..Extent::default() };
        let shape = Shape::of_extent(grid, values, Fill::None, extent).resampled(resampling);
        // Where all cells have light, and reach the horizon, nothing can be filled.
        let is_full = |k: usize| shape.measured_to_deg(k).is_none();
        let is_closed = (0..grid.incidences_deg.len()).all(is_full) && !has_dark_cells(grid, values);
        let filled = (!is_closed)
            .then(|| [Fill::Beyond, Fill::Tail].map(|fill| Shape::of_extent(grid, values, fill, extent)));
        let incidence = |k: usize| {
            let integral = shape.total(k);
            let [by_distance, by_azimuth] = shape.grid_errors_of(k, integral);
            let [integral_beyond, integral_filled] = match &filled {
                Some(filled) => filled.each_ref().map(|shape| shape.total(k)),
                None => [integral; 2],
            };
            Incidence {
                theta_deg: grid.incidences_deg[k],
                tis: part.mean_tis(channel, k),
                integral,
                measured_to_deg: shape.measured_to_deg(k),
                integral_beyond,
                integral_filled,
                grid_error: Some(by_distance + by_azimuth),
                azimuth_error: Some(by_azimuth),
                peak: shape.peak(k),
                half_widths_deg: [0.0, 90.0, 180.0].map(|azimuth| shape.half_width_deg(k, azimuth)),
            }
        };
        let beyond = |degrees: f64| {
            let all = shape.total(0);
            (all > 0.0).then(|| 1.0 - shape.total_within(0, degrees.to_radians().sin()) / all)
        };
        let transmission = part.way.is_transmission();
        let haze = beyond(HAZE_DEG).filter(|_| transmission);
        // A coarser grid does not resolve the disc and the ring.
        let near = |pair: &[f64]| pair[0] >= HAZE_DEG || pair[1] - pair[0] <= 0.5 * CLEAR_DEG;
        let fine = grid.radials_deg.windows(2).all(near);
        let clarity = beyond(CLEAR_DEG).zip(haze).filter(|_| fine).map(|(beyond_disc, haze)| {
            let (disc, ring) = (1.0 - beyond_disc, beyond_disc - haze);
            (disc - ring) / (disc + ring)
        });
        // Without light near the direct beam, it is not defined.
        let clarity = clarity.filter(|clarity| clarity.is_finite());
        let incidences: Vec<Incidence> = (0..grid.incidences_deg.len()).map(incidence).collect();
        let peak = incidences.iter().filter_map(|i| i.peak).fold(0.0, f64::max);
        Self {
            asymmetry: shape.asymmetry(),
            reciprocity: reciprocity::reciprocity(part, channel, (grid, values, &shape), peak),
            haze,
            clarity,
            incidences,
            held_azimuths_deg: shape.held_azimuths_deg(),
            inclined_to_deg,
            rotations: rotations(part, channel, grid, values),
            ..Self::from_cells(grid, values, transmission)
        }
        .with_pairs(part, channel)
    }

    /// Returns the audit with what concerns listed pairs of directions, whose cells are interpolated.
    fn with_pairs(self, part: &MeasuredPart, channel: usize) -> Self {
        let Some(interpolation) = pair_interpolation(part, channel) else { return self };
        let values = || part.channel(channel).iter().copied();
        let pairs = ListedPairs {
            points: interpolation.points(),
            largest_deg: interpolation.largest_deg(),
            errors: interpolation.errors(),
        };
        Self {
            cells: values().count(),
            lit: values().filter(|value| *value > 0.0).count(),
            unmeasured: values().filter(|value| value.is_nan()).count(),
            holes: 0,
            beam_holes: 0,
            noise: 0.0,
            range: values()
                .filter(|value| *value > 0.0)
                .fold([f64::INFINITY, 0.0], |[a, b], f| [a.min(f), b.max(f)]),
            dark_beyond_deg: pairs.largest_deg[1],
            asymmetry: interpolation.asymmetry(),
            pairs: Some(pairs),
            // That of the grid on which they are interpolated says nothing of the directions that were measured.
            incidences: (self.incidences.iter())
                .map(|one| Incidence { grid_error: None, azimuth_error: None, ..*one })
                .collect(),
            ..self
        }
    }

    /// Largest relative uncertainty of the integrals from the grid; `None` if it is not known.
    pub fn grid_error(&self) -> Option<f64> {
        self.incidences.iter().try_fold(0.0, |most: f64, incidence| Some(most.max(incidence.grid_error?)))
    }

    /// An audit of no cells.
    fn empty() -> Self {
        Self {
            cells: 0,
            lit: 0,
            unmeasured: 0,
            negative: 0,
            dark_beyond_deg: 0.0,
            holes: 0,
            beam_holes: 0,
            noise: 0.0,
            range: [f64::INFINITY, 0.0],
            asymmetry: 0.0,
            reciprocity: None,
            haze: None,
            clarity: None,
            held_azimuths_deg: None,
            inclined_to_deg: None,
            pairs: None,
            incidences: Vec::new(),
            rotations: Vec::new(),
        }
    }

    /// Counts and noise of the cells; the other fields are empty.
    fn from_cells(grid: &SpecularGrid, values: &[f64], transmission: bool) -> Self {
        let mut audit = Self { noise: noise(grid, values), ..Self::empty() };
        let mut dark = Vec::new();
        for (cell, value) in values.iter().enumerate() {
            let (rest, radial) =
                (cell / grid.radials_deg.len(), grid.radials_deg[cell % grid.radials_deg.len()]);
            let (rest, azimuth) =
                (rest / grid.azimuths_deg.len(), grid.azimuths_deg[rest % grid.azimuths_deg.len()]);
            let incidence = grid.incidences_deg[rest % grid.incidences_deg.len()];
            let Some(to) = SpecularGrid::direction(incidence, azimuth, radial) else { continue };
            audit.cells += 1;
            audit.unmeasured += usize::from(value.is_nan());
            audit.negative += usize::from(*value < 0.0);
            if *value > 0.0 {
                audit.lit += 1;
                audit.dark_beyond_deg = audit.dark_beyond_deg.max(to.theta_deg);
                audit.range = [audit.range[0].min(*value), audit.range[1].max(*value)];
            } else {
                // The light comes from azimuth 180 deg.
                let [x, _, z] = to.vector();
                let (sin, cos) = incidence.to_radians().sin_cos();
                let from_light = (-x * sin + z * cos).clamp(-1.0, 1.0).acos().to_degrees();
                dark.push((to.theta_deg, from_light));
            }
        }
        let below = dark.iter().filter(|(theta, _)| *theta < audit.dark_beyond_deg);
        let beam = |(_, from_light): &&(f64, f64)| !transmission && *from_light < BEAM_DEG;
        audit.beam_holes = below.clone().filter(beam).count();
        audit.holes = below.count() - audit.beam_holes;
        audit
    }
}

/// Totals at each rotation separately; empty for a single rotation.
fn rotations(part: &MeasuredPart, channel: usize, grid: &SpecularGrid, values: &[f64]) -> Vec<Rotation> {
    let turns = grid.rotations_deg.len();
    if turns < 2 {
        return Vec::new();
    }
    let of_rotation = |(index, cells): (usize, &[f64])| {
        let rotation_deg = grid.rotations_deg[index];
        let shape = Shape::of_grid(
            &SpecularGrid { rotations_deg: vec![rotation_deg], ..grid.clone() },
            cells,
            Fill::None,
        );
        let one = |k: usize| Rotation {
            rotation_deg,
            theta_deg: grid.incidences_deg[k],
            tis: part.tis(channel, index, k),
            integral: shape.total(k),
        };
        (0..grid.incidences_deg.len()).map(one).collect::<Vec<_>>()
    };
    values.chunks_exact((values.len() / turns).max(1)).enumerate().flat_map(of_rotation).collect()
}

/// Returns whether a cell in the hemisphere has no light.
fn has_dark_cells(grid: &SpecularGrid, values: &[f64]) -> bool {
    values
        .iter()
        .enumerate()
        .any(|(cell, value)| (value.is_nan() || *value <= 0.0) && grid.directions(cell).is_some())
}

/// Standard deviation of a value from its four neighbours on its radial line, median over the faint half of
/// the cells. A value is compared with the cubic of ln f through its neighbours, so that the lobe itself does
/// not count as noise.
fn noise(grid: &SpecularGrid, values: &[f64]) -> f64 {
    let radials = &grid.radials_deg;
    // Weights of the neighbours, and the standard deviation of the difference for values with one of 1.
    let cubic = |k: usize| {
        let places = [k - 2, k - 1, k + 1, k + 2];
        let weights = places.map(|place| {
            let others = places.iter().filter(|other| **other != place);
            others
                .map(|other| (radials[k] - radials[*other]) / (radials[place] - radials[*other]))
                .product::<f64>()
        });
        (weights, (1.0 + weights.iter().map(|weight| weight * weight).sum::<f64>()).sqrt())
    };
    let cubics: Vec<([f64; 4], f64)> = (2..radials.len().saturating_sub(2)).map(cubic).collect();
    let mut cells: Vec<[f64; 2]> = values
        .chunks_exact(radials.len())
        .flat_map(|line| line.windows(5).zip(&cubics))
        .filter(|(five, _)| five.iter().all(|value| *value > 0.0))
        .map(|(five, (weights, spread))| {
            let neighbours = [five[0], five[1], five[3], five[4]];
            let expected: f64 = neighbours.iter().zip(weights).map(|(f, weight)| weight * f.ln()).sum();
            [five[2], five[2] * (five[2].ln() - expected).abs() / spread]
        })
        .collect();
    cells.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut differences: Vec<f64> = cells[..cells.len() / 2].iter().map(|[_, d]| *d).collect();
    differences.sort_by(f64::total_cmp);
    // The median of |d| of a normal distribution is 0.6745 sigma.
    differences.get(differences.len() / 2).map_or(0.0, |median| median / 0.6745)
}
