//! Environment maps: images of the whole sphere.
//!
//! # Model
//! Rows of the image are uniformly spaced in inclination from the zenith, and columns in azimuth, to the right as seen from
//! inside. At `rotate_deg = 0` an upright display faces the middle of the image (azimuth -90 deg, see [`Pose`]); a rotation
//! turns the world counterclockwise seen from above.
//!
//! For a horizontal display, pixels are cells: nothing is resampled. After a rotation by a fraction of a pixel each
//! pixel consists of several cells; where the pixels' borders lie within cells, these hold the mean of both. For a tilted display, each pixel is divided into many parts, and the
//! light of each part is added to the cell in which it falls. The radiance of a cell is the mean of its parts, and all
//! cells are scaled to preserve the illuminance. Near the normal, where cells are narrow, the light of a row is averaged
//! over several cells.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::pose::{Pose, by_inclination};

/// Image of the whole sphere in equirectangular projection.
#[derive(Debug, Clone)]
pub struct Panorama<'a> {
    /// Number of pixels in a row: twice the number of rows.
    pub width: usize,
    /// Number of rows, which must be even.
    pub height: usize,
    /// Radiances of each channel, row by row.
    pub channels: Vec<&'a [f32]>,
}

/// Radiances in cells over the display: rows of inclination and columns of azimuth.
#[derive(Debug, Clone, PartialEq)]
pub struct Cells {
    /// Inclinations between the rows, degrees.
    pub edges_deg: Vec<f64>,
    /// Number of columns of each row.
    pub columns: usize,
    /// Radiances of each channel, `[row][column]`.
    pub channels: Vec<Vec<f64>>,
}

impl Cells {
    /// Integrates a channel over solid angle.
    pub fn light(&self, channel: usize) -> f64 {
        let rows = self.channels[channel].chunks_exact(self.columns).zip(self.edges_deg.windows(2));
        let of = |(cells, edges): (&[f64], &[f64])| {
            (edges[0].to_radians().cos() - edges[1].to_radians().cos()) * cells.iter().sum::<f64>()
        };
        rows.map(of).sum::<f64>() * TAU / self.columns as f64
    }
}

/// Largest number of columns for a horizontal display.
const MOST_FLAT: usize = 1024;
/// Largest number of columns for a horizontal display whose map is turned by a part of a pixel.
const MOST_TURNED: usize = 2048;
/// Number of columns for a tilted display.
const TILTED: usize = 512;
/// Approximate number of parts of an image pixel per cell of a tilted display, along each direction.
const PARTS: usize = 8;

impl Panorama<'_> {
    /// Integrates a channel over the solid angle of the whole sphere.
    pub fn light(&self, channel: usize) -> f64 {
        let rows = self.channels[channel].chunks_exact(self.width).enumerate();
        let of = |(row, pixels): (usize, &[f32])| {
            self.band(row, 1) * pixels.iter().map(|value| f64::from(*value)).sum::<f64>()
        };
        rows.map(of).sum::<f64>() * TAU / self.width as f64
    }

    /// Converts the light above the plane of a display of this pose to cells.
    pub fn over(&self, pose: Pose, rotate_deg: f64) -> Cells {
        if pose.tilt_deg == 0.0 { self.over_flat(rotate_deg) } else { self.over_tilted(pose, rotate_deg) }
    }

    fn over_flat(&self, rotate_deg: f64) -> Cells {
        let rows = self.height / 2;
        // Halved until it is small enough, as long as the size is even.
        let mut step = 1;
        while self.width / step > MOST_FLAT
            && rows.is_multiple_of(2 * step)
            && self.width.is_multiple_of(2 * step)
        {
            step *= 2;
        }
        let (rows, columns) = (rows / step, self.width / step);
        // Azimuth decreases from column to column. Columns are divided so that a turn by a part of a pixel moves pixels by whole cells
        // and does not smooth them; only cells at the border of two pixels are divided between them, if the turn needs finer ones.
        let shift = (90.0 + rotate_deg) / 360.0 * columns as f64;
        let off = |parts: usize| (shift * parts as f64 - (shift * parts as f64).round()).abs();
        let most = (MOST_TURNED / columns).max(1);
        let parts = (1..=most).find(|parts| off(*parts) < 1e-9).unwrap_or(most);
        let cells_around = columns * parts;
        let shift = shift * parts as f64;
        let shift = if off(parts) < 1e-9 { shift.round() } else { shift };
        let (whole, part) = (shift.floor(), shift - shift.floor());
        let channel = |pixels: &&[f32]| {
            let mut radiance = vec![0.0; rows * cells_around];
            for (row, cells) in radiance.chunks_exact_mut(cells_around).enumerate() {
                for column in 0..columns {
                    let value = self.mean(pixels, (row * step, column * step), step);
                    let cell = |k: f64| (k.rem_euclid(cells_around as f64) as usize).min(cells_around - 1);
                    for fine in column * parts..(column + 1) * parts {
                        cells[cell(whole - fine as f64 - 1.0)] += (1.0 - part) * value;
                        cells[cell(whole - fine as f64)] += part * value;
                    }
                }
            }
            radiance
        };
        let edges_deg = (0..=rows).map(|row| 90.0 * row as f64 / rows as f64).collect();
        Cells { edges_deg, columns: cells_around, channels: self.channels.iter().map(channel).collect() }
    }

    /// Computes the mean of a block of pixels, weighted by solid angle.
    fn mean(&self, pixels: &[f32], (row, column): (usize, usize), step: usize) -> f64 {
        let (mut sum, mut area) = (0.0, 0.0);
        for row in row..row + step {
            let weight = self.band(row, 1);
            let pixels = &pixels[row * self.width..][column..column + step];
            sum += weight * pixels.iter().map(|value| f64::from(*value)).sum::<f64>();
            area += weight * step as f64;
        }
        sum / area
    }

    /// Solid angle of a part of a row, over 2 pi.
    fn band(&self, row: usize, parts: usize) -> f64 {
        let angle = |row: f64| PI * row / (self.height * parts) as f64;
        angle(row as f64).cos() - angle(row as f64 + 1.0).cos()
    }

    fn over_tilted(&self, pose: Pose, rotate_deg: f64) -> Cells {
        let (rows, columns) = (TILTED / 4, TILTED);
        let parts = (PARTS * TILTED).div_ceil(self.width).max(2);
        let (fine_rows, fine_columns) = (self.height * parts, self.width * parts);
        let mut light = vec![vec![0.0; rows * columns]; self.channels.len()];
        let mut areas = vec![0.0; rows * columns];
        let turns: Vec<f64> = (0..fine_columns)
            .map(|column| {
                let along = (column as f64 + 0.5) / fine_columns as f64;
                (90.0 + rotate_deg).to_radians() - TAU * along
            })
            .collect();
        for fine_row in 0..fine_rows {
            let theta = PI * (fine_row as f64 + 0.5) / fine_rows as f64;
            let solid_angle = self.band(fine_row, parts) * TAU / fine_columns as f64;
            let start = fine_row / parts * self.width;
            for (column, turn) in turns.iter().enumerate() {
                let [x, y, z] = pose.to_display(by_inclination(theta, *turn));
                if z > 0.0 {
                    let row = (x.hypot(y).atan2(z) / FRAC_PI_2 * rows as f64) as usize;
                    let turn = y.atan2(x).rem_euclid(TAU) / TAU;
                    let cell =
                        row.min(rows - 1) * columns + ((turn * columns as f64) as usize).min(columns - 1);
                    areas[cell] += solid_angle * z;
                    for (light, pixels) in light.iter_mut().zip(&self.channels) {
                        light[cell] += f64::from(pixels[start + column / parts]) * solid_angle * z;
                    }
                }
            }
        }
        let edge = |row: usize| FRAC_PI_2 * row as f64 / rows as f64;
        for light in &mut light {
            let (incident, mut stored) = (light.iter().sum::<f64>(), 0.0);
            let rows = light.chunks_exact_mut(columns).zip(areas.chunks_exact(columns)).enumerate();
            for (row, (cells, areas)) in rows {
                let area =
                    0.5 * (edge(row + 1).sin().powi(2) - edge(row).sin().powi(2)) * TAU / columns as f64;
                let middle = (0.5 * (edge(row) + edge(row + 1))).sin();
                let together = ((1.0 / middle) as usize).next_power_of_two().min(columns / 4);
                for (cells, areas) in cells.chunks_mut(together).zip(areas.chunks(together)) {
                    let mean = cells.iter().sum::<f64>() / areas.iter().sum::<f64>().max(1e-300);
                    stored += mean * area * cells.len() as f64;
                    cells.fill(mean);
                }
            }
            let scale = if stored > 0.0 { incident / stored } else { 0.0 };
            light.iter_mut().for_each(|value| *value *= scale);
        }
        Cells { edges_deg: (0..=rows).map(|row| edge(row).to_degrees()).collect(), columns, channels: light }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use papilio_optics::Beta;
    use papilio_transport::Field;

    fn field(cells: Cells) -> (Field, f64) {
        Field::new(&cells.edges_deg, cells.columns, cells.channels[0].clone()).unwrap()
    }

    fn map(width: usize, value: impl Fn(usize, usize) -> f32) -> Vec<f32> {
        (0..width * width / 2).map(|k| value(k / width, k % width)).collect()
    }

    #[test]
    fn uniform_map_is_uniform_over_a_display_of_any_tilt() {
        let radiance = vec![2.0; 64 * 32];
        let map = Panorama { width: 64, height: 32, channels: vec![&radiance] };
        let flat = map.over(Pose::default(), 17.0);
        assert!(flat.channels[0].iter().all(|value| (value - 2.0).abs() < 1e-12));
        for tilt_deg in [30.0, 90.0, 180.0] {
            let cells = map.over(Pose { tilt_deg }, 17.0);
            let (worst, irradiance) = (
                cells.channels[0].iter().map(|value| (value - 2.0).abs()).fold(0.0, f64::max),
                field(cells.clone()).1,
            );
            assert!((irradiance / (2.0 * PI) - 1.0).abs() < 1e-4, "{tilt_deg}: {irradiance}");
            assert!(worst < 1e-3, "{tilt_deg}: {worst}");
        }
    }

    /// A bright pixel is at its azimuth and elevation for any pose, and its light is preserved.
    #[test]
    fn bright_pixel_has_its_direction_and_light_for_any_pose() {
        // Row 20 of 64: elevation 90 - 20.5/64 180 = 32.3 deg. Column 32 of 128: a quarter to the left of the middle.
        let radiance = map(128, |row, column| if (row, column) == (20, 32) { 5.0 } else { 0.0 });
        let map = Panorama { width: 128, height: 64, channels: vec![&radiance] };
        let elevation = 90.0 - 20.5 / 64.0 * 180.0;
        let azimuth = -90.0 + 360.0 * (0.5 - 32.5 / 128.0);
        let solid_angle = map.band(20, 1) * TAU / 128.0;
        for (tilt_deg, rotate_deg) in [(0.0, 0.0), (0.0, 100.0), (40.0, -60.0), (90.0, -70.0)] {
            let pose = Pose { tilt_deg };
            let (field, irradiance) = field(map.over(pose, rotate_deg));
            let (theta, phi) = pose.sees([elevation, azimuth + rotate_deg]);
            let at = field.radiance(Beta::from_source(theta, phi, 1.0));
            assert!(at > 0.2 / solid_angle, "{tilt_deg} {rotate_deg}: {at}");
            let truth = 5.0 * solid_angle * theta.to_radians().cos();
            assert!((irradiance / truth - 1.0).abs() < 3e-3, "{tilt_deg} {rotate_deg}: {irradiance} {truth}");
        }
    }

    /// A turn by a part of a pixel moves the pixels and does not smooth them: each keeps its own radiance in its middle.
    #[test]
    fn turned_map_keeps_the_radiances_of_its_pixels() {
        let radiance = map(64, |_, column| if column % 2 == 0 { 1.0 } else { 9.0 });
        let map = Panorama { width: 64, height: 32, channels: vec![&radiance] };
        let pixel = 360.0 / 64.0;
        for part in [0.0, 0.5, 0.25, 0.3, 0.9137] {
            let (field, irradiance) = field(map.over(Pose::default(), part * pixel));
            assert!((irradiance / (5.0 * PI) - 1.0).abs() < 1e-12, "{part}: {irradiance}");
            for column in 0..64 {
                for inside in [0.1, 0.5, 0.9] {
                    let phi = 90.0 + part * pixel - pixel * (f64::from(column) + inside);
                    let at = field.radiance(Beta::from_source(40.0, phi, 1.0)) * irradiance;
                    let wanted = if column % 2 == 0 { 1.0 } else { 9.0 };
                    assert!((at / wanted - 1.0).abs() < 1e-9, "{part} {column} {inside}: {at}");
                }
            }
        }
    }

    #[test]
    fn large_map_is_reduced_and_its_light_is_preserved() {
        let radiance = map(4096, |row, column| ((row * 7 + column * 3) % 11) as f32);
        let cells =
            Panorama { width: 4096, height: 2048, channels: vec![&radiance] }.over(Pose::default(), 0.0);
        assert_eq!((cells.columns, cells.edges_deg.len()), (1024, 257));
        assert!((field(cells).1 / (5.0 * PI) - 1.0).abs() < 1e-2);
    }
}
