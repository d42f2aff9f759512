//! Values on another geometry, for formats that hold one kind only.

use papilio_goniometry::{Channel, Fill, Geometry, Part, Shape, SpecularGrid, Symmetry};

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

/// A part on the grid of an imaging sphere, for light from azimuth 180 deg; what could not be evaluated is NaN. The
/// incidences are the part's own where it has any: between two of them a plain reading shows a peak twice.
pub(super) fn on_specular_grid(part: &Part, channels: &[usize]) -> Part {
    let steps = |count: u32, step: f64| (0..count).map(|k| f64::from(k) * step).collect::<Vec<f64>>();
    let grid = SpecularGrid {
        rotations_deg: vec![0.0],
        incidences_deg: match &part.geometry {
            Geometry::Spherical(grid) => {
                grid.theta_i_deg.iter().copied().filter(|theta| *theta < 90.0).collect()
            }
            _ => steps(16, 5.0),
        },
        azimuths_deg: steps(36, 10.0),
        radials_deg: steps(91, 2.0),
        symmetry: Symmetry::None,
    };
    let geometry = Geometry::Specular(grid.clone());
    let (mut values, mut tis) = (Vec::new(), Vec::new());
    for &channel in channels {
        let value = |cell| {
            let [i, o] = geometry.directions(cell)?;
            part.evaluate(channel, i, o)
        };
        let cells: Vec<f64> = (0..geometry.cells()).map(|cell| value(cell).unwrap_or(f64::NAN)).collect();
        let shape = Shape::of_grid(&grid, &cells, Fill::None);
        tis.extend((0..grid.incidences_deg.len()).map(|k| shape.total(k)));
        values.extend(cells);
    }
    let channels = channels.iter().map(|&number| part.channels[number]).collect();
    Part { way: part.way, channels, geometry, values, tis }
}
