//! Quality of a measurement: coverage, energy, reciprocity, holes, noise, haze.
//!
//! Haze and clarity are the values of a hazemeter in the same light, computed from the goniometric data. ASTM
//! D1003 defines haze up to 30 %; above that it refers to goniometric methods (ASTM E2387). Clarity has no
//! standard. It is defined here as `(C - R)/(C + R)`, where C is the light within 1 deg of the direct beam,
//! and R the light between 1 and 2.5 deg.

mod patches;

use papilio_optics::Beta;

use crate::shape::on_specular_grid;
use crate::{Fill, Geometry, MeasuredPart, Shape, SpecularGrid};

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
    /// Clarity (see the module documentation); only of a grid with steps of 0.5 deg or less near the peak.
    pub clarity: Option<f64>,
    /// First and last azimuth, degrees from the plane of incidence, if not 0 and 180; beyond them the nearest
    /// value is used.
    pub held_azimuths_deg: Option<[f64; 2]>,
    /// Quality by incidence.
    pub incidences: Vec<Incidence>,
    /// Quality by rotation and incidence, of a measurement at several rotations.
    pub rotations: Vec<Rotation>,
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
    /// Relative uncertainty of the integral from the grid: of distances and azimuths together.
    pub grid_error: f64,
    /// Relative uncertainty of the integral from the grid's azimuths.
    pub azimuth_error: f64,
    /// Value in the specular direction, 1/sr.
    pub peak: f64,
    /// Distance from the specular direction to half the peak, degrees: towards the normal, sideways, away
    /// from the normal.
    pub half_widths_deg: [Option<f64>; 3],
}

impl Incidence {
    /// Fraction of the light beyond the last measured distance, if tails are extrapolated.
    pub fn beyond_share(&self) -> f64 {
        if self.integral_beyond > 0.0 { (1.0 - self.integral / self.integral_beyond).max(0.0) } else { 0.0 }
    }
}

impl Audit {
    /// Audits one channel, given by its index. Patches are summed directly. A part on another geometry is
    /// first resampled on a specular-centred grid, and its cells are those of that grid. `None` for listed
    /// pairs.
    pub fn of(part: &MeasuredPart, channel: usize) -> Option<Self> {
        if let Geometry::Patches { incoming, outgoing } = &part.geometry {
            return Some(patches::audit([incoming, outgoing], part.channel(channel)));
        }
        let (grid, values) = &on_specular_grid(part, &[channel])?;
        let [shape, beyond, filled] =
            [Fill::None, Fill::Beyond, Fill::Tail].map(|fill| Shape::of_grid(grid, values, fill));
        let incidence = |k: usize| {
            let [by_distance, by_azimuth] = shape.grid_errors(k);
            Incidence {
                theta_deg: grid.incidences_deg[k],
                tis: part.mean_tis(channel, k),
                integral: shape.total(k),
                measured_to_deg: shape.measured_to_deg(k),
                integral_beyond: beyond.total(k),
                integral_filled: filled.total(k),
                grid_error: by_distance + by_azimuth,
                azimuth_error: by_azimuth,
                peak: shape.along(k, 0.0, 0.0).unwrap_or(0.0),
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
        let incidences: Vec<Incidence> = (0..grid.incidences_deg.len()).map(incidence).collect();
        Some(Self {
            asymmetry: shape.asymmetry(),
            reciprocity: reciprocity(&shape, incidences.iter().map(|i| i.peak).fold(0.0, f64::max)),
            haze,
            clarity,
            incidences,
            held_azimuths_deg: shape.held_azimuths_deg(),
            rotations: rotations(part, channel, grid, values),
            ..Self::from_cells(grid, values, transmission)
        })
    }

    /// Largest relative uncertainty of the integrals from the grid.
    pub fn grid_error(&self) -> f64 {
        self.incidences.iter().map(|incidence| incidence.grid_error).fold(0.0, f64::max)
    }

    /// Counts and noise of the cells; the other fields are empty.
    fn from_cells(grid: &SpecularGrid, values: &[f64], transmission: bool) -> Self {
        let mut audit = Self {
            cells: 0,
            lit: 0,
            unmeasured: 0,
            negative: 0,
            dark_beyond_deg: 0.0,
            holes: 0,
            beam_holes: 0,
            noise: noise(grid, values),
            range: [f64::INFINITY, 0.0],
            asymmetry: 0.0,
            reciprocity: None,
            haze: None,
            clarity: None,
            held_azimuths_deg: None,
            incidences: Vec::new(),
            rotations: Vec::new(),
        };
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

/// Root mean square and maximum of the difference of f(i, o) and f(o, i), relative to their mean.
fn reciprocity(shape: &Shape, peak: f64) -> Option<[f64; 2]> {
    let thetas: Vec<f64> = shape.incidences_deg().collect();
    let (mut squares, mut sizes, mut worst) = (0.0, 0.0, 0.0_f64);
    for (i, from) in thetas.iter().enumerate() {
        for (j, to) in thetas.iter().enumerate().skip(i + 1) {
            for azimuth in (0..=180).step_by(10) {
                let (sin, cos) = f64::from(azimuth).to_radians().sin_cos();
                let [a, b] = [(i, from, to), (j, to, from)].map(|(k, from, to)| {
                    let [from, to] = [from, to].map(|theta| theta.to_radians().sin());
                    shape.value(k, Beta { x: to * cos - from, y: to * sin })
                });
                let mean = 0.5 * (a + b);
                if a.min(b) > FAINT * peak {
                    squares += (a - b).powi(2);
                    sizes += mean * mean;
                    worst = worst.max((a - b).abs() / mean);
                }
            }
        }
    }
    (sizes > 0.0).then(|| [(squares / sizes).sqrt(), worst])
}

/// Standard deviation from second differences along radial lines, median over the faint half of the cells.
fn noise(grid: &SpecularGrid, values: &[f64]) -> f64 {
    let mut triples: Vec<[f64; 2]> = values
        .chunks_exact(grid.radials_deg.len())
        .flat_map(|line| line.windows(3))
        .filter(|three| three.iter().all(|value| *value > 0.0))
        .map(|three| [three[1], (three[0] - 2.0 * three[1] + three[2]).abs()])
        .collect();
    triples.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut differences: Vec<f64> = triples[..triples.len() / 2].iter().map(|[_, d]| *d).collect();
    differences.sort_by(f64::total_cmp);
    // The median of |d| of a normal distribution is 0.6745 sigma, and the variances add as 1 + 4 + 1.
    differences.get(differences.len() / 2).map_or(0.0, |median| median / 0.6745 / 6.0_f64.sqrt())
}
