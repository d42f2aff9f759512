//! Environment maps: images of the whole sphere.
//!
//! # Model
//! Rows of the image are uniformly spaced in inclination from the zenith, and columns in azimuth, to the
//! right as seen from inside. At `rotate_deg = 0` an upright display faces the middle of the image (azimuth
//! -90 deg, see [`Pose`]); a rotation turns the world counterclockwise seen from above.
//!
//! Nothing smooths the pixels: look-ups and mean values over a field of view are those of the pixels
//! themselves, for any rotation and tilt of the display ([`Pixels`]). For a horizontal display, the pixels
//! are cells of a [`Field`], whose first column begins at any azimuth. For a tilted display, or a large map,
//! the light that a lobe scatters is summed over cells: each pixel is divided into parts, and the light of
//! each part is distributed among the four nearest cells, so that it keeps its place on average. Near the
//! normal, where cells are narrow, the light of a row is averaged over several cells. The cells have the
//! irradiance of the pixels.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use std::sync::Arc;

use papilio_transport::{Field, Pixels};

use super::pose::Pose;

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

/// Light of one channel of a map over the display.
#[derive(Debug, Clone, PartialEq)]
pub struct MapField {
    /// Its radiance by direction.
    pub field: Field,
    /// Integral of the radiance over direction cosines: the irradiance of the display plane.
    pub irradiance: f64,
    /// Integral of the radiance over the solid angle above the display.
    pub light: f64,
}

/// Largest number of columns of cells for a horizontal display.
const MOST_FLAT: usize = 1024;
/// Number of columns of cells for a tilted display: 0.18 deg, so that lobes of 1 deg are summed within about
/// 1e-3.
const TILTED: usize = 2048;
/// Smallest number of parts of the image per cell of a tilted display, along each direction.
const PARTS: usize = 2;

impl Panorama<'_> {
    /// Integrates a channel over the solid angle of the whole sphere.
    pub fn light(&self, channel: usize) -> f64 {
        let rows = self.channels[channel].chunks_exact(self.width).enumerate();
        let of = |(row, pixels): (usize, &[f32])| {
            self.band(row, 1) * pixels.iter().map(|value| f64::from(*value)).sum::<f64>()
        };
        rows.map(of).sum::<f64>() * TAU / self.width as f64
    }

    /// Returns the light of each channel above the plane of a display of this pose; `None` where there is
    /// none.
    pub fn over(&self, pose: Pose, rotate_deg: f64) -> Vec<Option<MapField>> {
        if pose.tilt_deg == 0.0 {
            self.channels.iter().map(|pixels| self.over_flat(pixels, rotate_deg)).collect()
        } else {
            let cells = self.cells_of_tilted(pose, rotate_deg);
            let channels = self.channels.iter().zip(cells);
            channels.map(|(pixels, cells)| self.exact(pixels, pose, rotate_deg, 0.0, cells)).collect()
        }
    }

    fn over_flat(&self, pixels: &[f32], rotate_deg: f64) -> Option<MapField> {
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
        // Azimuth decreases from column to column of the image.
        let cell = |k: usize| {
            let (row, column) = (k / columns, columns - 1 - k % columns);
            self.mean(pixels, (row * step, column * step), step)
        };
        let cells: Vec<f64> = (0..rows * columns).map(cell).collect();
        let cells = Cells { rows, columns, radiance: cells };
        let start_deg = 90.0 + rotate_deg;
        if step > 1 {
            return self.exact(pixels, Pose::default(), rotate_deg, start_deg, cells);
        }
        let light = cells.light();
        let (field, irradiance) = Field::new(&cells.edges_deg(), columns, cells.radiance)?;
        Some(MapField { field: field.turned(start_deg), irradiance, light })
    }

    /// Returns the light of the pixels themselves; sums of it use these cells, whose columns begin at an
    /// azimuth.
    fn exact(
        &self,
        pixels: &[f32],
        pose: Pose,
        rotate_deg: f64,
        start_deg: f64,
        cells: Cells,
    ) -> Option<MapField> {
        let (sin, cos) = (90.0 + rotate_deg).to_radians().sin_cos();
        let frame = [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]].map(|axis| pose.to_display(axis));
        let radiance: Arc<[f32]> =
            pixels.chunks_exact(self.width).flat_map(|row| row.iter().rev().copied()).collect();
        let pixels = Pixels { columns: self.width, radiance, frame };
        let (edges, columns) = (cells.edges_deg(), cells.columns);
        let (field, [irradiance, light]) =
            Field::of_pixels(pixels, &edges, columns, start_deg, cells.radiance)?;
        Some(MapField { field, irradiance, light })
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

    /// Distributes the light over cells of a tilted display, by channel.
    fn cells_of_tilted(&self, pose: Pose, rotate_deg: f64) -> Vec<Cells> {
        let (rows, columns) = (TILTED / 4, TILTED);
        let parts = (PARTS * TILTED).div_ceil(self.width);
        let (fine_rows, fine_columns) = (self.height * parts, self.width * parts);
        let mut light = vec![vec![0.0; rows * columns]; self.channels.len()];
        let mut areas = vec![0.0; rows * columns];
        let turns: Vec<(f64, f64)> = (0..fine_columns)
            .map(|column| {
                let along = (column as f64 + 0.5) / fine_columns as f64;
                ((90.0 + rotate_deg).to_radians() - TAU * along).sin_cos()
            })
            .collect();
        for fine_row in 0..fine_rows {
            let (sin, cos) = (PI * (fine_row as f64 + 0.5) / fine_rows as f64).sin_cos();
            let solid_angle = self.band(fine_row, parts) * TAU / fine_columns as f64;
            let start = fine_row / parts * self.width;
            for (column, (sin_turn, cos_turn)) in turns.iter().enumerate() {
                let [x, y, z] = pose.to_display([sin * cos_turn, sin * sin_turn, cos]);
                if z <= 0.0 {
                    continue;
                }
                let down = x.hypot(y).atan2(z) / FRAC_PI_2 * rows as f64;
                let along = y.atan2(x).rem_euclid(TAU) / TAU * columns as f64;
                for (cell, weight) in nearest(down, along, [rows, columns]) {
                    let area = weight * solid_angle * z;
                    areas[cell] += area;
                    for (light, pixels) in light.iter_mut().zip(&self.channels) {
                        light[cell] += f64::from(pixels[start + column / parts]) * area;
                    }
                }
            }
        }
        light.into_iter().map(|light| Cells::of_light(light, &areas, [rows, columns])).collect()
    }
}

/// Returns the four cells whose middles are nearest to a position, in rows and columns, and the weights of
/// linear interpolation between them.
fn nearest(down: f64, along: f64, [rows, columns]: [usize; 2]) -> [(usize, f64); 4] {
    let (row, column) = ((down - 0.5).floor(), (along - 0.5).floor());
    let (below, right) = (down - 0.5 - row, along - 0.5 - column);
    let cell = |row: f64, column: f64| {
        // Beyond the normal lies the first row at the opposite azimuth.
        let opposite = if row < 0.0 { 0.5 * columns as f64 } else { 0.0 };
        let column = (column + opposite).rem_euclid(columns as f64) as usize;
        (row.max(0.0) as usize).min(rows - 1) * columns + column.min(columns - 1)
    };
    [
        (cell(row, column), (1.0 - below) * (1.0 - right)),
        (cell(row, column + 1.0), (1.0 - below) * right),
        (cell(row + 1.0, column), below * (1.0 - right)),
        (cell(row + 1.0, column + 1.0), below * right),
    ]
}

/// Radiances in cells over the display: rows of equal height from the normal to the horizon, and columns.
struct Cells {
    rows: usize,
    columns: usize,
    /// `[row][column]`.
    radiance: Vec<f64>,
}

impl Cells {
    /// Returns the inclinations between the rows.
    fn edges_deg(&self) -> Vec<f64> {
        (0..=self.rows).map(|row| 90.0 * row as f64 / self.rows as f64).collect()
    }

    /// Integrates over solid angle.
    fn light(&self) -> f64 {
        let cosine = |row: usize| (FRAC_PI_2 * row as f64 / self.rows as f64).cos();
        let rows = self.radiance.chunks_exact(self.columns).enumerate();
        let of = |(row, cells): (usize, &[f64])| (cosine(row) - cosine(row + 1)) * cells.iter().sum::<f64>();
        rows.map(of).sum::<f64>() * TAU / self.columns as f64
    }

    /// Returns the radiances of cells that receive this light over these areas, both in direction cosines.
    fn of_light(mut light: Vec<f64>, areas: &[f64], [rows, columns]: [usize; 2]) -> Self {
        let edge = |row: usize| FRAC_PI_2 * row as f64 / rows as f64;
        let (incident, mut stored) = (light.iter().sum::<f64>(), 0.0);
        let by_row = light.chunks_exact_mut(columns).zip(areas.chunks_exact(columns)).enumerate();
        for (row, (cells, areas)) in by_row {
            let area = 0.5 * (edge(row + 1).sin().powi(2) - edge(row).sin().powi(2)) * TAU / columns as f64;
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
        Self { rows, columns, radiance: light }
    }
}

#[cfg(test)]
mod tests {
    use super::super::pose::by_inclination;
    use super::*;
    use papilio_optics::Beta;

    fn over(map: &Panorama<'_>, tilt_deg: f64, rotate_deg: f64) -> MapField {
        map.over(Pose { tilt_deg }, rotate_deg).remove(0).unwrap()
    }

    fn map(width: usize, value: impl Fn(usize, usize) -> f32) -> Vec<f32> {
        (0..width * width / 2).map(|k| value(k / width, k % width)).collect()
    }

    /// Radiance in a direction of the display, by the pixel at its elevation and azimuth: independent of
    /// frames and cells.
    fn pixel_at(map: &Panorama<'_>, tilt_deg: f64, rotate_deg: f64, theta: f64, phi: f64) -> f64 {
        let world = Pose { tilt_deg }.to_world(by_inclination(theta.to_radians(), phi.to_radians()));
        let zenith = world[2].clamp(-1.0, 1.0).acos().to_degrees();
        // To the right is clockwise; the middle of the image is at azimuth -90 deg.
        let turn = (world[1].atan2(world[0]).to_degrees() + 90.0 - rotate_deg).rem_euclid(360.0);
        let along = (0.5 - turn / 360.0).rem_euclid(1.0);
        let row = (zenith / 180.0 * map.height as f64) as usize;
        let column = (along * map.width as f64) as usize;
        f64::from(map.channels[0][row.min(map.height - 1) * map.width + column.min(map.width - 1)])
    }

    #[test]
    fn uniform_map_is_uniform_over_a_display_of_any_tilt() {
        let radiance = vec![2.0; 64 * 32];
        let map = Panorama { width: 64, height: 32, channels: vec![&radiance] };
        for tilt_deg in [0.0, 30.0, 90.0, 180.0] {
            let MapField { field, irradiance, light } = over(&map, tilt_deg, 17.0);
            // Pixels that the horizon divides are integrated to about 1e-7 of the whole.
            assert!((irradiance / (2.0 * PI) - 1.0).abs() < 1e-6, "{tilt_deg}: {irradiance}");
            assert!((light / (4.0 * PI) - 1.0).abs() < 1e-6, "{tilt_deg}: {light}");
            for (theta, phi) in [(0.0, 0.0), (33.0, 70.0), (80.0, -100.0), (89.99, 10.0)] {
                let at = field.radiance(Beta::from_source(theta, phi, 1.0)) * irradiance;
                assert!((at / 2.0 - 1.0).abs() < 1e-6, "{tilt_deg}: {at}");
            }
        }
    }

    /// Every direction has the radiance of its own pixel, at any rotation, tilt and size.
    #[test]
    fn map_in_any_orientation_keeps_the_radiances_of_its_pixels() {
        let small = map(64, |row, column| ((row * 37 + column * 101) % 19) as f32);
        let large = map(2048, |row, column| ((row * 37 + column * 101) % 19) as f32);
        let mut dice = papilio_testing::Dice::new(3, 0);
        for (width, radiance) in [(64, &small), (2048, &large)] {
            let map = Panorama { width, height: width / 2, channels: vec![radiance] };
            for (tilt_deg, rotate_deg) in
                [(0.0, 0.0), (0.0, 180.0 / 64.0), (0.0, 123.456), (20.0, 1.7), (90.0, -61.3), (137.0, 200.0)]
            {
                // Once is enough for a large tilted map, which takes long.
                if width == 2048 && tilt_deg != 0.0 && tilt_deg != 20.0 {
                    continue;
                }
                let MapField { field, irradiance, .. } = over(&map, tilt_deg, rotate_deg);
                for _ in 0..500 {
                    let (theta, phi) = (
                        90.0 * dice.below(1_000_003) as f64 / 1_000_003.0,
                        dice.below(360_007) as f64 / 1000.0,
                    );
                    let at = field.radiance(Beta::from_source(theta, phi, 1.0)) * irradiance;
                    let wanted = pixel_at(&map, tilt_deg, rotate_deg, theta, phi);
                    assert!(
                        (at - wanted).abs() < 1e-9,
                        "{tilt_deg} {rotate_deg} {theta} {phi}: {at} {wanted}"
                    );
                }
            }
        }
    }

    /// The irradiance of a rough map in any orientation is the sum over a fine grid of the display's own
    /// directions.
    #[test]
    fn irradiance_in_any_orientation_is_that_of_a_sum_over_directions() {
        let radiance = map(16, |row, column| ((row * 5 + column * 11) % 7) as f32);
        let map = Panorama { width: 16, height: 8, channels: vec![&radiance] };
        for (tilt_deg, rotate_deg) in [(0.0, 10.0), (35.0, 0.0), (90.0, 77.0), (160.0, -30.0)] {
            let found = over(&map, tilt_deg, rotate_deg);
            let (rings, turns) = (600, 1200);
            let mut sums = [0.0; 2];
            for ring in 0..rings {
                let theta = 90.0 * (f64::from(ring) + 0.5) / f64::from(rings);
                let (sin, cos) = theta.to_radians().sin_cos();
                let area = sin * FRAC_PI_2 / f64::from(rings) * TAU / f64::from(turns);
                for turn in 0..turns {
                    let phi = 360.0 * (f64::from(turn) + 0.5) / f64::from(turns);
                    let at = pixel_at(&map, tilt_deg, rotate_deg, theta, phi);
                    sums[0] += at * area * cos;
                    sums[1] += at * area;
                }
            }
            assert!((found.irradiance / sums[0] - 1.0).abs() < 5e-4, "{tilt_deg}: {found:?} {sums:?}");
            assert!((found.light / sums[1] - 1.0).abs() < 5e-4, "{tilt_deg}: {sums:?}");
        }
    }

    /// A bright pixel is at its azimuth and elevation for any pose, and its light is preserved.
    #[test]
    fn bright_pixel_has_its_direction_and_light_for_any_pose() {
        // Row 20 of 64: elevation 90 - 20.5/64 180 = 32.3 deg. Column 32 of 128: a quarter to the left of the
        // middle.
        let radiance = map(128, |row, column| if (row, column) == (20, 32) { 5.0 } else { 0.0 });
        let map = Panorama { width: 128, height: 64, channels: vec![&radiance] };
        let elevation = 90.0 - 20.5 / 64.0 * 180.0;
        let azimuth = -90.0 + 360.0 * (0.5 - 32.5 / 128.0);
        let solid_angle = map.band(20, 1) * TAU / 128.0;
        for (tilt_deg, rotate_deg) in [(0.0, 0.0), (0.0, 100.0), (40.0, -60.0), (90.0, -70.0)] {
            let MapField { field, irradiance, light } = over(&map, tilt_deg, rotate_deg);
            let (theta, phi) = Pose { tilt_deg }.sees([elevation, azimuth + rotate_deg]);
            let at = field.radiance(Beta::from_source(theta, phi, 1.0));
            assert!((at * irradiance / 5.0 - 1.0).abs() < 1e-12, "{tilt_deg} {rotate_deg}: {at}");
            assert!((light / (5.0 * solid_angle) - 1.0).abs() < 1e-12, "{light}");
            // The mean cosine over a pixel of 2.8 deg is about that of its middle.
            let truth = 5.0 * solid_angle * theta.to_radians().cos();
            assert!((irradiance / truth - 1.0).abs() < 3e-3, "{tilt_deg} {rotate_deg}: {irradiance} {truth}");
        }
    }
}
