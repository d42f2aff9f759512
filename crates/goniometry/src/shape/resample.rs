//! Any geometry read on a grid about the specular direction.

use crate::{Direction, Geometry, Part, SpecularGrid, Symmetry};

/// Incidences where a geometry has none of its own: to 85 deg by 5.
const INCIDENCES: u32 = 18;

/// A part's channel on a specular-centred grid: its own, or what a plain reading of its geometry gives, 10 deg around
/// and half a degree to two degrees outwards. `None` for listed pairs, which leave open what is between them.
pub(crate) fn on_specular_grid(part: &Part, channel: usize) -> Option<(SpecularGrid, Vec<f64>)> {
    let (incidences_deg, light_deg) = match &part.geometry {
        Geometry::Specular(grid) => return Some((grid.clone(), part.channel(channel).to_vec())),
        Geometry::Pairs(_) => return None,
        Geometry::Spherical(grid) => {
            let below = grid.theta_i_deg.iter().copied().filter(|theta| *theta < 90.0);
            (below.collect(), *grid.phi_i_deg.first()?)
        }
        _ => ((0..INCIDENCES).map(|k| 5.0 * f64::from(k)).collect::<Vec<_>>(), 180.0),
    };
    let grid = SpecularGrid {
        rotations_deg: vec![0.0],
        incidences_deg,
        azimuths_deg: (0..36).map(|k| 10.0 * f64::from(k)).collect(),
        radials_deg: radials(),
        symmetry: Symmetry::None,
    };
    let mut values = Vec::with_capacity(grid.cells());
    for theta in &grid.incidences_deg {
        let light = Direction::new(*theta, light_deg);
        let value = |azimuth: f64, radial: f64| {
            // The grid's light comes from 180 deg.
            let to = SpecularGrid::direction(*theta, azimuth, radial)?;
            part.evaluate(channel, light, Direction::new(to.theta_deg, to.phi_deg + light_deg - 180.0))
        };
        for azimuth in &grid.azimuths_deg {
            values.extend(grid.radials_deg.iter().map(|radial| value(*azimuth, *radial).unwrap_or(f64::NAN)));
        }
    }
    let lit = |incidence: usize| {
        let cells = values.len() / grid.incidences_deg.len();
        values[incidence * cells..][..cells].iter().any(|value| *value > 0.0)
    };
    // What was not measured at all is no incidence.
    let kept: Vec<usize> = (0..grid.incidences_deg.len()).filter(|k| lit(*k)).collect();
    let cells = values.len() / grid.incidences_deg.len().max(1);
    let values = kept.iter().flat_map(|k| values[k * cells..][..cells].to_vec()).collect();
    let incidences_deg: Vec<f64> = kept.iter().map(|k| grid.incidences_deg[*k]).collect();
    (!incidences_deg.is_empty()).then_some((SpecularGrid { incidences_deg, ..grid }, values))
}

fn radials() -> Vec<f64> {
    let fine = (0..20).map(|k| 0.5 * f64::from(k));
    let medium = (10..30).map(f64::from);
    fine.chain(medium).chain((15..=90).map(|k| 2.0 * f64::from(k))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Channel, Fill, Shape, SphericalGrid, Way};

    /// A wide lobe on a grid of inclinations has the total of its formula.
    #[test]
    fn spherical_grids_keep_the_total() {
        let steps =
            |to: f64, step: f64| (0..=(to / step) as usize).map(|k| k as f64 * step).collect::<Vec<_>>();
        let grid = SphericalGrid {
            theta_i_deg: steps(60.0, 15.0),
            phi_i_deg: vec![0.0],
            theta_o_deg: steps(90.0, 1.0),
            phi_o_deg: steps(358.0, 2.0),
        };
        let b: f64 = 0.1;
        let mut values = Vec::new();
        for theta_i in &grid.theta_i_deg {
            for theta_o in &grid.theta_o_deg {
                values.extend(grid.phi_o_deg.iter().map(|phi_o| {
                    let (from, to) = (Direction::new(*theta_i, 0.0), Direction::new(*theta_o, *phi_o));
                    let squared = (to.leaving() - from.arriving()).squared();
                    b / (2.0 * std::f64::consts::PI * (b * b + squared).powf(1.5))
                }));
            }
        }
        let part = Part {
            way: Way::FrontTransmission,
            channels: vec![Channel::Monochrome],
            geometry: Geometry::Spherical(grid),
            values,
            tis: Vec::new(),
        };
        let shape = Shape::of_part(&part, 0, Fill::None).unwrap();
        for (k, share) in [0.9005, 0.8953, 0.8768, 0.8331, 0.7291].into_iter().enumerate() {
            assert!((shape.total(k) - share).abs() < 2e-3, "{k}: {} {share}", shape.total(k));
        }
    }
}
