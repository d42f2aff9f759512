//! Faces whose heights are given: measured, periodic, or random with any spectrum.

use std::f64::consts::PI;
use std::fmt;
use std::sync::Arc;

use num_complex::Complex64;
use papilio_fourier::Plane;
use papilio_optics::RandomFace;
use papilio_sampling::SampleStream;
use papilio_transport::spatial::Cells;

/// Heights of a rectangle that repeats.
#[derive(Debug, Clone, PartialEq)]
pub struct Tile {
    /// Places of heights and size of the rectangle.
    pub cells: Cells,
    /// Heights by rows from the bottom, mm.
    pub heights_mm: Vec<f64>,
}

/// A face whose heights are not those of [`RandomFace`].
pub trait Relief: fmt::Debug + Send + Sync {
    /// A random piece of the face, always of the same size for the same `wanted_mm`: about as large, or more,
    /// if the face is; of a drawn face, as large or larger if it can be.
    fn tile(&self, numbers: &SampleStream, wanted_mm: [f64; 2]) -> Tile;

    /// Root mean square height, mm, above 0.
    fn rms_mm(&self) -> f64;

    /// Root mean square slope along one axis, the mean of both; above 0.
    fn slope_rms(&self) -> f64;

    /// Distance at which the correlation of heights is 1/e, mm.
    fn correlation_mm(&self) -> f64;

    /// What there is of it.
    fn extent(&self) -> Extent;
}

/// What there is of a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Extent {
    /// A random face, drawn again for each replicate: that it repeats is no property of it.
    Drawn,
    /// A face that repeats as its pieces do: light that meets it a period further on finds the same slope.
    Periodic,
    /// A part of a face, of which no more is known: other pieces of the part stand for the rest.
    Known {
        /// Its area, mm².
        area_mm2: f64,
    },
}

/// The heights of a face.
#[derive(Debug, Clone)]
pub enum Face {
    /// Gaussian heights of the correlation exp(-r²/ξ²).
    Gaussian(RandomFace),
    /// Any other heights.
    Relief(Arc<dyn Relief>),
}

impl PartialEq for Face {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Gaussian(one), Self::Gaussian(other)) => one == other,
            (Self::Relief(one), Self::Relief(other)) => Arc::ptr_eq(one, other),
            _ => false,
        }
    }
}

impl Face {
    /// Root mean square slope along one axis.
    pub fn slope_rms(&self) -> f64 {
        match self {
            Self::Gaussian(face) => face.slope_rms,
            Self::Relief(relief) => relief.slope_rms(),
        }
    }

    /// Distance at which the correlation of heights is 1/e, mm.
    pub fn correlation_mm(&self) -> f64 {
        match self {
            Self::Gaussian(face) => face.correlation_mm,
            Self::Relief(relief) => relief.correlation_mm(),
        }
    }

    /// Size of the structures that bend light, mm: sqrt(2) times the rms height over the rms slope, the
    /// correlation length of the Gaussian face of the same heights and slopes.
    pub fn detail_mm(&self) -> f64 {
        match self {
            Self::Gaussian(face) => face.correlation_mm,
            Self::Relief(relief) => 2.0_f64.sqrt() * relief.rms_mm() / relief.slope_rms(),
        }
    }

    /// What there is of it.
    pub fn extent(&self) -> Extent {
        self.relief().map_or(Extent::Drawn, |relief| relief.extent())
    }

    /// Distance at which slopes are independent, mm.
    ///
    /// The correlation of the slopes of Gaussian heights is below 4e-6 there. If a period is longer than a
    /// distance by this much, slopes at that distance have the correlation of a face without end: waves that
    /// are longer than the period are not missing.
    pub(crate) fn independent_mm(&self) -> f64 {
        match self {
            Self::Gaussian(face) => 4.0 * face.correlation_mm,
            Self::Relief(_) => 8.0 * self.correlation_mm().max(self.detail_mm()),
        }
    }

    /// The face as a relief.
    pub(crate) fn relief(&self) -> Option<&Arc<dyn Relief>> {
        match self {
            Self::Gaussian(_) => None,
            Self::Relief(relief) => Some(relief),
        }
    }
}

/// Draws slopes of a relief on the cells of a plan.
pub(crate) struct ReliefSampler {
    relief: Arc<dyn Relief>,
    wanted_mm: [f64; 2],
    /// Places of heights of each tile.
    tile: Cells,
    /// How often a tile repeats in the cells along x and y.
    repeats: [usize; 2],
    cells: Cells,
    of_tile: Plane,
    of_cells: Plane,
}

impl ReliefSampler {
    pub(crate) fn new(
        relief: Arc<dyn Relief>,
        wanted_mm: [f64; 2],
        tile: Cells,
        repeats: [usize; 2],
        cells: Cells,
    ) -> Self {
        let (of_tile, of_cells) = (Plane::new(tile.count), Plane::new(cells.count));
        Self { relief, wanted_mm, tile, repeats, cells, of_tile, of_cells }
    }

    /// Slopes of one replicate: along x the real parts, along y the imaginary parts. The tile begins at a
    /// random place.
    ///
    /// They are those of the waves of the heights, so that finer cells show the same face at more points, and
    /// coarser ones lack only the waves that they cannot show.
    pub(crate) fn slopes(&self, numbers: &SampleStream) -> Vec<Complex64> {
        let tile = self.relief.tile(&numbers.part(0x7469_6c65), self.wanted_mm);
        assert_eq!(tile.cells, self.tile, "all tiles of a face have the same size");
        let [columns, rows] = tile.cells.count;
        let scale = 1.0 / tile.heights_mm.len() as f64;
        let waves = self
            .of_tile
            .forward(tile.heights_mm.into_iter().map(|height| Complex64::from(height * scale)).collect());
        // Waves along an axis that both the tile and the cells can show.
        let most = [0, 1].map(|axis| {
            let cells = self.cells.count[axis] / self.repeats[axis];
            (self.tile.count[axis].min(cells).saturating_sub(1) / 2) as i64
        });
        let [u, v, ..] = numbers.part(0x70_6c61_6365).block(0, 0);
        let mut slopes = vec![Complex64::ZERO; self.cells.len()];
        for x in -most[0]..=most[0] {
            for y in -most[1]..=most[1] {
                let wave =
                    waves[x.rem_euclid(columns as i64) as usize * rows + y.rem_euclid(rows as i64) as usize];
                let frequency = [x as f64 / tile.cells.period_mm[0], y as f64 / tile.cells.period_mm[1]];
                let [in_x, in_y] = [0, 1].map(|axis| [x, y][axis] * self.repeats[axis] as i64);
                // Slopes at the middles of cells.
                let middle =
                    in_x as f64 / self.cells.count[0] as f64 + in_y as f64 / self.cells.count[1] as f64;
                let turn = PI * middle + 2.0 * PI * (x as f64 * u + y as f64 * v);
                let bin = in_x.rem_euclid(self.cells.count[0] as i64) as usize * self.cells.count[1]
                    + in_y.rem_euclid(self.cells.count[1] as i64) as usize;
                slopes[bin] = wave
                    * Complex64::from_polar(2.0 * PI, turn)
                    * Complex64::new(-frequency[1], frequency[0]);
            }
        }
        self.of_cells.inverse(slopes)
    }
}

#[cfg(test)]
mod tests {
    use papilio_optics::Beta;
    use papilio_transport::spatial::Gap;

    use super::*;
    use crate::faces::FaceSampler;
    use crate::{Deflection, Effort, Matrix, Panel, Pixel, Plan, Pupil, Room, Source, closed};

    const FACE: RandomFace = RandomFace { slope_rms: 0.02, correlation_mm: 0.012 };

    /// Gaussian heights as if they were measured.
    #[derive(Debug)]
    struct Measured {
        cells: Cells,
        extent: Extent,
    }

    impl Relief for Measured {
        fn tile(&self, numbers: &SampleStream, _: [f64; 2]) -> Tile {
            Tile { cells: self.cells, heights_mm: FaceSampler::new(FACE, self.cells).heights(numbers) }
        }

        fn rms_mm(&self) -> f64 {
            FACE.slope_rms * FACE.correlation_mm / 2.0_f64.sqrt()
        }

        fn slope_rms(&self) -> f64 {
            FACE.slope_rms
        }

        fn correlation_mm(&self) -> f64 {
            FACE.correlation_mm
        }

        fn extent(&self) -> Extent {
            self.extent
        }
    }

    fn panel(face: Face) -> Panel {
        Panel {
            face,
            media: vec![Gap { index: 1.5, thickness_mm: 0.7 }],
            matrix: Matrix::single(0.084, 0.026, 0.076),
            pixel: Pixel::Mirror,
            view: Beta::default(),
            pupil: Pupil::PINHOLE,
            room: Room::uniform(),
        }
    }

    /// A piece of 4.6 x 3.7 pixels, whose heights are as coarse as these cells allow.
    fn measured(extent: Extent) -> Face {
        let cells = Cells { count: [160, 120], period_mm: [0.39, 0.31] };
        Face::Relief(Arc::new(Measured { cells, extent }))
    }

    fn effort() -> Effort {
        let seeds = papilio_testing::seeds().min(200) as usize;
        Effort { replicates: 4 * seeds, pixels: papilio_testing::sized(400, 640), samples: 6, seed: 5 }
    }

    /// Heights of a Gaussian face, cut into pieces that are no whole number of pixels, have the sparkle of
    /// the closed form; and with a lamp that of rays through Gaussian faces, on pixels of both kinds.
    #[test]
    fn heights_of_gaussian_faces_have_their_sparkle() {
        let light = Source {
            beta: Beta { x: 0.05, y: 0.0 },
            radius_deg: papilio_testing::sized(1.5, 3.0),
            illuminance: 1.0,
        };
        let lit = Room { diffuse: 0.5, sources: vec![light] };
        let per_slope =
            Deflection::new(&panel(measured(Extent::Drawn)).media, Beta::default()).per_slope_mm();
        let exact =
            closed::pixel_power_deviation(FACE, per_slope, &Matrix::single(0.084, 0.026, 0.076), [0.0; 2])
                .unwrap();
        for pixel in [Pixel::Mirror, Pixel::Lambertian] {
            let [as_relief, as_gaussian] = [measured(Extent::Drawn), Face::Gaussian(FACE)].map(|face| {
                let plan = Plan::new(Panel { room: lit.clone(), pixel, ..panel(face) }, effort()).unwrap();
                plan.run()
            });
            let error = as_relief.matrix.standard_error;
            assert!(error < 0.06 * exact, "{as_relief:?}");
            assert!(
                (as_relief.matrix.ppd - exact).abs() < 4.5 * error + 0.2 / 36.0 * exact,
                "{as_relief:?} {exact}"
            );
            for (one, other) in [(as_relief.source, as_gaussian.source), (as_relief.all, as_gaussian.all)] {
                let error = one.standard_error.hypot(other.standard_error);
                assert!((one.ppd - other.ppd).abs() < 4.5 * error, "{pixel:?} {one:?} {other:?}");
                let error = one.mean_error.hypot(other.mean_error);
                assert!((one.mean - other.mean).abs() < 4.5 * error, "{pixel:?} {one:?} {other:?}");
            }
        }
    }

    /// Of a small piece of a face, the errors are those of the pixels that it holds, however often it is
    /// used.
    #[test]
    fn errors_contain_that_of_the_known_area() {
        let plan =
            Plan::new(panel(measured(Extent::Known { area_mm2: 10.0 * 0.084 * 0.084 })), effort()).unwrap();
        let found = plan.run().matrix;
        assert!(found.standard_error > found.ppd / 20.0_f64.sqrt(), "{found:?}");
        assert!(found.mean_error > found.mean * found.ppd / 10.0_f64.sqrt(), "{found:?}");
    }

    /// A wave along x, 30 um long.
    #[derive(Debug)]
    struct Wave;

    const LENGTH_MM: f64 = 0.03;
    const STEEPEST: f64 = 0.05;

    impl Relief for Wave {
        fn tile(&self, _: &SampleStream, _: [f64; 2]) -> Tile {
            let cells = Cells { count: [32, 1], period_mm: [LENGTH_MM; 2] };
            let height = |k: u32| self.rms_mm() * 2.0_f64.sqrt() * (2.0 * PI * f64::from(k) / 32.0).sin();
            Tile { cells, heights_mm: (0..32).map(height).collect() }
        }

        fn rms_mm(&self) -> f64 {
            STEEPEST * LENGTH_MM / (2.0 * PI * 2.0_f64.sqrt())
        }

        /// The mean of the squares along both axes.
        fn slope_rms(&self) -> f64 {
            0.5 * STEEPEST
        }

        fn correlation_mm(&self) -> f64 {
            0.2 * LENGTH_MM
        }

        fn extent(&self) -> Extent {
            Extent::Periodic
        }
    }

    /// Lenticular lenses over pixels of 2.8 times their period: the deviation over all offsets of the lenses,
    /// by quadrature.
    #[test]
    fn waves_shorter_than_pixels_have_their_deviation() {
        let panel = panel(Face::Relief(Arc::new(Wave)));
        let moved = Deflection::new(&panel.media, panel.view).per_slope_mm()[0] * STEEPEST;
        let inside = |x: f64| f64::from((x.rem_euclid(0.084) - 0.042).abs() < 0.013) * 0.076 / 0.084;
        let light = |offset: f64| {
            let at = |k: i32| {
                let x = 0.084 * (f64::from(k) + 0.5) / 4000.0;
                inside(x + moved * (2.0 * PI * (x / LENGTH_MM + offset)).cos())
            };
            (0..4000).map(at).sum::<f64>() / 4000.0
        };
        let lights: Vec<f64> = (0..200).map(|k| light(f64::from(k) / 200.0)).collect();
        let mean = lights.iter().sum::<f64>() / 200.0;
        let expected = (lights.iter().map(|light| (light - mean).powi(2)).sum::<f64>() / 200.0).sqrt() / mean;
        let effort = Effort { replicates: 400, pixels: 400, samples: 16, seed: 3 };
        let plan = Plan::new(panel, effort).unwrap();
        assert_eq!(plan.pixels(), 1);
        let found = plan.run().matrix;
        assert!(expected > 0.05 && found.standard_error < 0.1 * expected, "{found:?} {expected}");
        assert!((found.ppd - expected).abs() < 4.5 * found.standard_error, "{found:?} {expected}");
        assert!((found.mean - mean).abs() < 4.5 * found.mean_error, "{found:?} {mean}");
    }
}
