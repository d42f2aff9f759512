//! Environment maps: images of the whole sphere.
//!
//! # Model
//! Rows of the image are uniformly spaced in inclination from the zenith, and columns in azimuth, to the
//! right as seen from inside. At `rotate_deg = 0` an upright display faces the middle of the image (azimuth
//! -90 deg, see [`Pose`]); a rotation turns the world counterclockwise seen from above.
//!
//! Nothing smooths the pixels: look-ups, mean values over a field of view, and the light that a lobe scatters
//! are those of the pixels themselves, for any rotation and tilt of the display ([`Pixels`]). Of a small map
//! over a horizontal display, the pixels are cells of a [`Field`], whose first column begins at any azimuth.

use std::f64::consts::{PI, TAU};

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

/// Largest number of columns of pixels that are cells of a [`Field`].
const MOST_CELLS: usize = 1024;

impl Panorama<'_> {
    /// Integrates a channel over the solid angle of the whole sphere.
    pub fn light(&self, channel: usize) -> f64 {
        self.light_of(self.channels[channel], self.height)
    }

    /// Integrates the first rows of a channel over their solid angle.
    fn light_of(&self, pixels: &[f32], rows: usize) -> f64 {
        let rows = pixels.chunks_exact(self.width).take(rows).enumerate();
        let of = |(row, pixels): (usize, &[f32])| {
            self.band(row) * pixels.iter().map(|value| f64::from(*value)).sum::<f64>()
        };
        rows.map(of).sum::<f64>() * TAU / self.width as f64
    }

    /// Returns the light of each channel above the plane of a display of this pose; `None` where there is
    /// none.
    pub fn over(&self, pose: Pose, rotate_deg: f64) -> Vec<Option<MapField>> {
        if pose.tilt_deg == 0.0 && self.width <= MOST_CELLS {
            return self.channels.iter().map(|pixels| self.cells(pixels, rotate_deg)).collect();
        }
        let (sin, cos) = (90.0 + rotate_deg).to_radians().sin_cos();
        let frame = [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]].map(|axis| pose.to_display(axis));
        // Azimuth decreases from column to column of the image.
        let reversed = |row: &[f32]| row.iter().rev().copied().collect::<Vec<f32>>();
        let pixels = |pixels: &&[f32]| Pixels {
            columns: self.width,
            radiance: pixels.chunks_exact(self.width).flat_map(reversed).collect(),
            frame,
        };
        let fields = Field::of_pixels(self.channels.iter().map(pixels).collect());
        let light = |(field, [irradiance, light]): (Field, [f64; 2])| MapField { field, irradiance, light };
        fields.into_iter().map(|field| field.map(light)).collect()
    }

    /// Returns a field whose cells are the pixels above a horizontal display.
    fn cells(&self, pixels: &[f32], rotate_deg: f64) -> Option<MapField> {
        let rows = self.height / 2;
        let above = pixels.chunks_exact(self.width).take(rows);
        let radiance = above.flat_map(|row| row.iter().rev().map(|value| f64::from(*value)));
        let edges: Vec<f64> = (0..=rows).map(|row| 90.0 * row as f64 / rows as f64).collect();
        let (field, irradiance) = Field::new(&edges, self.width, radiance.collect())?;
        let light = self.light_of(pixels, rows);
        Some(MapField { field: field.turned(90.0 + rotate_deg), irradiance, light })
    }

    /// Returns the solid angle of a row, over 2 pi.
    fn band(&self, row: usize) -> f64 {
        let angle = |row: usize| PI * row as f64 / self.height as f64;
        angle(row).cos() - angle(row + 1).cos()
    }
}

#[cfg(test)]
mod tests {
    use super::super::pose::by_inclination;
    use super::*;
    use papilio_optics::Beta;
    use std::f64::consts::FRAC_PI_2;

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
        let solid_angle = map.band(20) * TAU / 128.0;
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
