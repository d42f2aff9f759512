//! Values on another geometry, for formats that hold one kind only.

use papilio_goniometry::{
    Channel, Direction, Geometry, Part, Ring, SpecularGrid, Symmetry, projected_solid_angle,
};

/// Whether a geometry covers directions and not only pairs of them.
pub(super) fn covers(geometry: &Geometry) -> bool {
    !matches!(geometry, Geometry::Pairs(_))
}

/// The number of the channel nearest to a luminous one.
pub(super) fn choose_single(part: &Part) -> Option<usize> {
    let rank = |channel: &Channel| match channel {
        Channel::Monochrome => 0.0,
        Channel::Y => 1.0,
        Channel::Green => 2.0,
        Channel::Wavelength(nm) => 3.0 + (nm - 555.0).abs(),
        _ => f64::INFINITY,
    };
    let channels = part.channels.iter().enumerate();
    channels.min_by(|(_, a), (_, b)| rank(a).total_cmp(&rank(b))).map(|(number, _)| number)
}

/// A part on the grid of an imaging sphere, for light from azimuth 180 deg; what could not be evaluated is NaN.
pub(super) fn on_specular_grid(part: &Part, channels: &[usize]) -> Part {
    let steps = |count: u32, step: f64| (0..count).map(|k| f64::from(k) * step).collect::<Vec<f64>>();
    let grid = SpecularGrid {
        rotations_deg: vec![0.0],
        incidences_deg: steps(16, 5.0),
        azimuths_deg: steps(36, 10.0),
        radials_deg: steps(91, 2.0),
        symmetry: Symmetry::None,
    };
    let geometry = Geometry::Specular(grid);
    let (mut values, mut tis) = (Vec::new(), Vec::new());
    for &channel in channels {
        let value = |cell| {
            let [i, o] = geometry.directions(cell)?;
            part.evaluate(channel, i, o)
        };
        values.extend((0..geometry.cells()).map(|cell| value(cell).unwrap_or(f64::NAN)));
        tis.extend((0..16).map(|k| integral(part, channel, f64::from(k) * 5.0)));
    }
    let channels = channels.iter().map(|&number| part.channels[number]).collect();
    Part { way: part.way, channels, geometry, values, tis }
}

/// The integral of f cos over the hemisphere for light from azimuth 180 deg, by the midpoint rule.
fn integral(part: &Part, channel: usize, theta_deg: f64) -> f64 {
    const AROUND: usize = 72;
    let rings: Vec<Ring> = (0..45).map(|k| Ring { from_deg: 2.0 * f64::from(k), patches: AROUND }).collect();
    let weights = projected_solid_angle(&rings);
    let light = Direction::new(theta_deg, 180.0);
    let terms = weights.iter().enumerate().filter_map(|(patch, weight)| {
        let viewer = Direction::new(
            2.0 * (patch / AROUND) as f64 + 1.0,
            360.0 * (patch % AROUND) as f64 / AROUND as f64,
        );
        Some(weight * part.evaluate(channel, light, viewer)?)
    });
    terms.sum()
}
