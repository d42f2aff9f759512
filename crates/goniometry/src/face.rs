//! The smooth face through which light leaves a sample, as its values near the horizon show it.
//!
//! The transmittance of a face to air falls towards the horizon as a square root of `1 - |beta|`: too steeply for an
//! interpolation, and tails that continue it vanish within a step. The light of a paper below glass was thus up to
//! three times too much or none at all from 70 deg. What is below the face is smooth.

use papilio_optics::Beta;

use crate::kernel::MIN_TRANSMITTANCE;
use crate::{Direction, Lamination, SpecularGrid};

/// Indices of faces through which light may have left a sample.
const FACES: [f64; 6] = [1.35, 1.42, 1.5, 1.6, 1.75, 2.0];
/// Inclination from which the fall towards the horizon shows the face, degrees.
const FACE_FROM_DEG: f64 = 60.0;
/// A face must reduce what interpolation misses there to this fraction.
const CLEARLY: f64 = 0.5;
/// Widths of lobes that are tried without and with faces, direction cosines.
const FACE_WIDTHS: [f64; 4] = [0.03, 0.1, 0.3, 1.0];

/// Most values of which the face is found.
const MOST_NEAR_HORIZON: usize = 20_000;

/// Returns the face through which light leaves a sample, if the values towards the horizon show one: with its
/// transmittance divided out, neighbours predict the values much better. A kernel behind it is right up to the
/// horizon, where the transmittance falls too steeply for an interpolation. `horizon`: the largest `|beta|` to which
/// values are known.
pub(crate) fn face_of(grid: &SpecularGrid, cells: &[f64], horizon: f64) -> Option<Lamination> {
    let known = near_horizon(grid, cells, horizon);
    let step = known.len().div_ceil(MOST_NEAR_HORIZON).max(1);
    let missed = |face: Option<Lamination>| {
        let of = |width: f64| known.iter().step_by(step).map(|three| three.missed(face, width)).sum::<f64>();
        FACE_WIDTHS.into_iter().map(of).fold(f64::INFINITY, f64::min)
    };
    let of = |face: Lamination| (face, missed(Some(face)));
    let faces = FACES.map(|index| Lamination { index }).into_iter().map(of);
    let (face, least) = faces.min_by(|a, b| a.1.total_cmp(&b.1))?;
    (least < CLEARLY * missed(None)).then_some(face)
}

/// Three neighbouring cells of a line outwards from the specular direction.
struct Neighbours {
    theta_deg: [f64; 3],
    /// Square of the distance from the specular direction in direction cosines.
    away: [f64; 3],
    values: [f64; 3],
    /// Projected solid angle of the middle one, but for a constant.
    size: f64,
}

impl Neighbours {
    /// The light of the difference between the middle value and what the others predict, by the logarithm of a lobe
    /// of this width without the face.
    fn missed(&self, face: Option<Lamination>, width: f64) -> f64 {
        let passed = self.theta_deg.map(|theta| face.map_or(1.0, |face| face.passed_at(theta)));
        let x = self.away.map(|away| (away / (width * width)).ln_1p());
        let [before, after] = [0, 2].map(|k| (self.values[k] / passed[k]).ln());
        let t = (x[1] - x[0]) / (x[2] - x[0]);
        let predicted = (before + t * (after - before)).exp() * passed[1];
        self.size * (predicted - self.values[1]).abs()
    }
}

/// Neighbouring cells near the horizon that have light.
fn near_horizon(grid: &SpecularGrid, cells: &[f64], horizon: f64) -> Vec<Neighbours> {
    let (azimuths, radials) = (grid.azimuths_deg.len(), &grid.radials_deg);
    // The same cells for all faces: the limit is that of the densest one.
    let limit = Lamination { index: FACES[FACES.len() - 1] };
    let mut all = Vec::new();
    for (row, line) in cells.chunks_exact(radials.len().max(1)).enumerate() {
        let theta_deg = grid.incidences_deg[row / azimuths % grid.incidences_deg.len()];
        let specular = Beta { x: theta_deg.to_radians().sin(), y: 0.0 };
        let to = |r: usize| SpecularGrid::direction(theta_deg, grid.azimuths_deg[row % azimuths], radials[r]);
        let on_hemisphere: Vec<Direction> = (0..radials.len()).map_while(to).collect();
        for (r, three) in on_hemisphere.windows(3).enumerate() {
            let (middle, values) = (radials[r + 1], [line[r], line[r + 1], line[r + 2]]);
            let is_known = |k: usize| {
                let beta = three[k].leaving().length();
                values[k] > 0.0 && beta <= horizon && limit.passed(beta) > MIN_TRANSMITTANCE
            };
            let away = [0, 1, 2].map(|k| (three[k].leaving() - specular).squared());
            if three[1].theta_deg >= FACE_FROM_DEG && (0..3).all(is_known) && away[0] < away[2] {
                let size = middle.to_radians().sin() * (radials[r + 2] - radials[r]);
                let theta_deg = [0, 1, 2].map(|k| three[k].theta_deg);
                all.push(Neighbours {
                    theta_deg,
                    away,
                    values,
                    size: size * theta_deg[1].to_radians().cos(),
                });
            }
        }
    }
    all
}
