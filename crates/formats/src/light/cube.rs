//! Cubes: pictures of the sphere on six faces, as equirectangular maps.
//!
//! Faces and directions are those of OpenEXR (`ImfEnvmap`): +X, -X, +Y, -Y, +Z and -Z from top to bottom; Y
//! is up, the middle of the equirectangular map is +Z, and +X is to its left.

use std::f64::consts::{PI, TAU};

use super::map::{MOST_WIDTH, MapChannel};

/// Parts of a pixel of the map, along each direction, over which the faces are averaged.
const PARTS: usize = 4;

/// Resamples the channels of a cube whose faces have this size; returns width and height of the map.
pub(super) fn equirectangular(face: usize, channels: &mut [MapChannel]) -> (usize, usize) {
    let width = (4 * face).min(MOST_WIDTH);
    let height = width / 2;
    let mut maps = vec![vec![0.0_f64; width * height]; channels.len()];
    let turns: Vec<(f64, f64)> = (0..PARTS * width)
        .map(|k| (PI - TAU * (k as f64 + 0.5) / (PARTS * width) as f64).sin_cos())
        .collect();
    for fine_row in 0..PARTS * height {
        let (up, across) = (0.5 * PI - PI * (fine_row as f64 + 0.5) / (PARTS * height) as f64).sin_cos();
        for (fine_column, (sin, cos)) in turns.iter().enumerate() {
            let from = place([across * sin, up, across * cos], face);
            let to = fine_row / PARTS * width + fine_column / PARTS;
            for (map, channel) in maps.iter_mut().zip(channels.iter()) {
                map[to] += f64::from(channel.radiance[from]);
            }
        }
    }
    for (channel, map) in channels.iter_mut().zip(maps) {
        channel.radiance = map.into_iter().map(|sum| (sum / (PARTS * PARTS) as f64) as f32).collect();
    }
    (width, height)
}

/// Returns the place of the pixel that is seen in a direction.
fn place([x, y, z]: [f64; 3], face: usize) -> usize {
    let last = face - 1;
    let at = |along: f64, axis: f64| (((along / axis + 1.0) / 2.0 * face as f64) as usize).min(last);
    let [width, height, depth] = [x.abs(), y.abs(), z.abs()];
    let (number, column, row) = if width >= height && width >= depth {
        let (a, b) = (at(y, width), at(z, width));
        if x > 0.0 { (0, b, last - a) } else { (1, last - b, last - a) }
    } else if height >= depth {
        let (a, b) = (at(x, height), at(z, height));
        if y > 0.0 { (2, a, last - b) } else { (3, a, b) }
    } else {
        let (a, b) = (at(x, depth), at(y, depth));
        if z > 0.0 { (4, last - a, last - b) } else { (5, a, last - b) }
    };
    (number * face + row) * face + column
}
