//! How many pixels, cells and rays an estimate of sparkle needs.

use std::fmt;

use num_complex::Complex64;
use papilio_fourier::Plane;
use papilio_optics::Beta;
use papilio_sampling::{SampleStream, Sampler};
use papilio_transport::spatial::{Cells, Gap};

use crate::Matrix;
use crate::deflection::{Deflection, Pupil, directions};
use crate::faces::FaceSampler;
use crate::meetings::Meetings;
use crate::relief::{Extent, Face, ReliefSampler};
use crate::room::{Pixel, Room, Source};
use crate::statistics::{Deviation, Moments, Sparkle};

/// A panel below a rough face, and its viewer.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// The face.
    pub face: Face,
    /// Media between face and pixel plane, that of the face first.
    pub media: Vec<Gap>,
    /// The lit windows.
    pub matrix: Matrix,
    /// How the pixel plane reflects.
    pub pixel: Pixel,
    /// Direction cosines of light that leaves towards the viewer.
    pub view: Beta,
    /// The viewer's pupil.
    pub pupil: Pupil,
    /// The light.
    pub room: Room,
}

/// Work for an estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Effort {
    /// Number of independent faces, 2 or more; standard errors follow from them.
    pub replicates: usize,
    /// Least number of pixels in total. The relative standard error of a PPD is about `1/sqrt(2 pixels)`.
    pub pixels: usize,
    /// Least number of cells in a correlation length, 4 or more. Cells lower a PPD by about `0.4/samples²` of
    /// itself.
    pub samples: usize,
    /// Seed of the faces.
    pub seed: u64,
}

impl Default for Effort {
    fn default() -> Self {
        Self { replicates: 32, pixels: 640, samples: 8, seed: 0 }
    }
}

/// Reason why sparkle cannot be estimated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SparkleError {
    /// A number of the panel is out of its range.
    Range {
        /// Its name.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The range.
        expected: &'static str,
    },
    /// The face or the sources have details that are too small for the area of pixels that is needed.
    TooFine {
        /// Number of cells of one face.
        cells: f64,
        /// The largest number.
        most: f64,
    },
    /// A random relief repeats within the part of it that the light of a pixel meets.
    ShortPeriod {
        /// Its period, mm.
        period_mm: f64,
        /// The least period, mm.
        least_mm: f64,
    },
    /// A relief is too steep.
    Steep {
        /// Its root mean square slope.
        slope_rms: f64,
    },
}

impl fmt::Display for SparkleError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Range { what, value, expected } => write!(f, "{what} is {value} (expected {expected})"),
            Self::TooFine { cells, most } => write!(
                f,
                "one face needs {cells:.1e} cells (expected {most:.1e} at most): the correlation length is too far below the \
                 pitch or above it, the face spreads the light of a pixel too widely, or a source is too small for a pinhole"
            ),
            Self::ShortPeriod { period_mm, least_mm } => write!(
                f,
                "the random surface repeats after {period_mm:.3} mm, and the light of a pixel meets {least_mm:.3} mm of it (expected no \
                 repetition): its structures are too fine for these pixels and this distance of face and pixels"
            ),
            Self::Steep { slope_rms } => write!(
                f,
                "the face has an rms slope of {slope_rms:.2} (expected {STEEPEST} at most): sparkle is computed for faces that light \
                 meets once on its way, and does not hold for steep bumps"
            ),
        }
    }
}

impl std::error::Error for SparkleError {}

/// Largest number of cells of a face: about 100 MB for each source.
const MOST_CELLS: f64 = 4e6;

/// Largest root mean square slope of a relief.
const STEEPEST: f64 = 0.3;

/// Most cells of a pixel along an axis because of its windows.
const MOST_ACROSS: f64 = 32.0;

/// Most rings of points in the pupil.
const MOST_RINGS: f64 = 6.0;

/// Where the slopes of a replicate come from.
enum Slopes {
    Random(FaceSampler),
    Relief(ReliefSampler),
}

/// Prepared estimate: [`Plan::replicate`] for each replicate, on any thread, then [`Plan::sparkle`].
pub struct Plan {
    pub(crate) panel: Panel,
    pub(crate) effort: Effort,
    pub(crate) cells: Cells,
    /// Cells of a pixel along x and y.
    pub(crate) of_pixel: [usize; 2],
    sampler: Slopes,
    pub(crate) view: Deflection,
    /// Views of the pupil: places on the pixel plane relative to those of the middle.
    pub(crate) pupil: Vec<[f64; 2]>,
    /// Deflection of each source.
    pub(crate) entering: Vec<Deflection>,
    pub(crate) meetings: Meetings,
    /// Transform of the cells.
    pub(crate) plane: Plane,
}

impl Plan {
    /// Prepares the estimate.
    ///
    /// # Errors
    /// [`SparkleError`]: a number out of range, or too many cells.
    pub fn new(panel: Panel, effort: Effort) -> Result<Self, SparkleError> {
        check(&panel, &effort)?;
        let view = Deflection::new(&panel.media, panel.view);
        let of_source = |source: &Source| Deflection::new(&panel.media, source.middle());
        let entering: Vec<Deflection> = panel.room.sources.iter().map(of_source).collect();
        let meetings = Meetings::new(&panel, &view, &entering);
        let (cells, of_pixel, sampler) = cells(&panel, &view, &meetings, &effort)?;
        let rings = pupil_rings(&panel, &view);
        let pupil = directions(panel.view, panel.pupil.radius(), rings)
            .into_iter()
            .map(|beta| view.shift(beta).map(|place| -place))
            .collect();
        let plane = Plane::new(cells.count);
        Ok(Self { effort, cells, of_pixel, sampler, view, pupil, entering, meetings, plane, panel })
    }

    /// True if mirror-like pixels show images of sources.
    pub(crate) fn images_sources(&self) -> bool {
        self.panel.pixel == Pixel::Mirror && !self.panel.room.sources.is_empty()
    }

    /// Number of pixels of one replicate.
    pub fn pixels(&self) -> usize {
        self.columns_and_rows().iter().product()
    }

    /// Slopes of the face of one replicate: along x the real parts, along y the imaginary parts.
    pub(crate) fn slopes(&self, numbers: &SampleStream) -> Vec<Complex64> {
        match &self.sampler {
            Slopes::Random(face) => face.slopes(numbers),
            Slopes::Relief(relief) => relief.slopes(numbers),
        }
    }

    /// Sparkle of the [`Moments`] of all replicates, in their order.
    ///
    /// Of a face of which a certain area is known, replicates are not independent: the errors contain those
    /// of the pixels that this area holds.
    pub fn sparkle(&self, replicates: &[[Moments; 3]]) -> Sparkle {
        let apart = self.panel.matrix.pitch_mm.map(|pitch| pitch.max(2.0 * self.panel.face.correlation_mm()));
        let independent = match self.panel.face.extent() {
            Extent::Known { area_mm2 } => Some((area_mm2 / (apart[0] * apart[1])).max(1.0)),
            Extent::Drawn | Extent::Periodic => None,
        };
        let deviation = |k: usize| {
            let moments: Vec<_> = replicates.iter().map(|moments| moments[k]).collect();
            let found = Deviation::new(&moments);
            independent.map_or(found, |pixels| found.of_independent(pixels))
        };
        Sparkle { all: deviation(0), matrix: deviation(1), source: deviation(2) }
    }

    /// Computes all replicates, one after the other.
    pub fn run(&self) -> Sparkle {
        let replicates = 0..self.effort.replicates as u64;
        self.sparkle(&replicates.map(|replicate| self.replicate(replicate)).collect::<Vec<_>>())
    }
}

fn check(panel: &Panel, effort: &Effort) -> Result<(), SparkleError> {
    if let Some(relief) = panel.face.relief()
        && relief.slope_rms() > STEEPEST
    {
        return Err(SparkleError::Steep { slope_rms: relief.slope_rms() });
    }
    let light = panel.room.diffuse + panel.room.sources.iter().map(|source| source.illuminance).sum::<f64>();
    let mut ranges = vec![
        ("slope_rms", panel.face.slope_rms(), panel.face.slope_rms() > 0.0, "a number above 0"),
        (
            "correlation length, mm,",
            panel.face.correlation_mm(),
            panel.face.correlation_mm() > 0.0,
            "a number above 0",
        ),
        ("size of details, mm,", panel.face.detail_mm(), panel.face.detail_mm() > 0.0, "a number above 0"),
        ("diffuse illuminance", panel.room.diffuse, panel.room.diffuse >= 0.0, "0 or more"),
        ("|beta| of the view", panel.view.length(), panel.view.squared() < 1.0, "below 1"),
        ("pupil, mm,", panel.pupil.diameter_mm, panel.pupil.diameter_mm >= 0.0, "0 or more"),
        ("distance, mm,", panel.pupil.distance_mm, panel.pupil.distance_mm > 0.0, "a number above 0"),
        ("mean of the matrix", panel.matrix.mean(), panel.matrix.mean() > 0.0, "a number above 0"),
        ("illuminance", light, light > 0.0, "a number above 0"),
        ("number of replicates", effort.replicates as f64, effort.replicates >= 2, "2 or more"),
        ("samples in a correlation length", effort.samples as f64, effort.samples >= 4, "4 or more"),
    ];
    if let Some(face) = panel.media.first() {
        ranges.push(("index below the face", face.index, face.index > 1.0, "a number above 1"));
    }
    for medium in &panel.media {
        ranges.push(("index", medium.index, medium.index >= 1.0, "1 or more"));
        ranges.push(("thickness, mm,", medium.thickness_mm, medium.thickness_mm >= 0.0, "0 or more"));
    }
    for pitch in panel.matrix.pitch_mm {
        ranges.push(("pitch, mm,", pitch, pitch > 0.0, "a number above 0"));
    }
    for window in &panel.matrix.windows {
        let [x0, y0, x1, y1] = window.rectangle_mm;
        for (size, pitch) in [x1 - x0, y1 - y0].into_iter().zip(panel.matrix.pitch_mm) {
            ranges.push((
                "size of a window, mm,",
                size,
                (0.0..=pitch * (1.0 + 1e-9)).contains(&size),
                "0 to the pitch",
            ));
        }
    }
    for source in &panel.room.sources {
        let radius = source.radius_deg;
        ranges.push(("|beta| of a source", source.beta.length(), source.beta.squared() < 1.0, "below 1"));
        ranges.push((
            "radius of a source, degrees,",
            radius,
            radius > 0.0 && radius <= 90.0,
            "above 0, up to 90",
        ));
        ranges.push(("illuminance", source.illuminance, source.illuminance >= 0.0, "0 or more"));
    }
    let wrong = ranges.into_iter().find(|(_, value, right, _)| !(*right && value.is_finite()));
    wrong.map_or(Ok(()), |(what, value, _, expected)| Err(SparkleError::Range { what, value, expected }))
}

/// Cells of a face, and of a pixel, and the slopes on them.
fn cells(
    panel: &Panel,
    view: &Deflection,
    meetings: &Meetings,
    effort: &Effort,
) -> Result<(Cells, [usize; 2], Slopes), SparkleError> {
    let pitch = panel.matrix.pitch_mm;
    let width = cell_width(panel, view, effort);
    let of_pixel = pitch.map(|pitch| smooth((pitch / width).ceil()));
    let per_pixel = of_pixel[0] * of_pixel[1];
    let affordable = MOST_CELLS / per_pixel;
    let too_fine = |pixels: f64| SparkleError::TooFine { cells: pixels * per_pixel, most: MOST_CELLS };
    let in_pixels = |mm: [f64; 2]| [0, 1].map(|axis| (mm[axis] / pitch[axis]).ceil().max(1.0));
    let (mut least, best) = (in_pixels(meetings.least_mm), in_pixels(meetings.best_mm));
    if least[0] * least[1] > affordable {
        return Err(too_fine(least[0] * least[1]));
    }
    // Directions beyond the period of the face find other parts of it again, of which the mean is one of
    // many.
    if best[0] * best[1] <= affordable {
        least = best;
    }
    let wanted = (effort.pixels as f64 / effort.replicates as f64).ceil().min(affordable);
    // About square in pixels, unless the correlation length demands another number along an axis.
    let columns = wanted.sqrt().ceil().max(least[0]).min((affordable / least[1]).floor());
    let rows = (wanted / columns).ceil().max(least[1]).min((affordable / columns).floor());
    let whole = of_pixel.map(|count| count as usize);
    let period_mm = [columns * pitch[0], rows * pitch[1]];
    let relief = match &panel.face {
        Face::Gaussian(face) => {
            let count = [columns * of_pixel[0], rows * of_pixel[1]].map(|count| count as usize);
            let cells = Cells { count, period_mm };
            return Ok((cells, whole, Slopes::Random(FaceSampler::new(*face, cells))));
        }
        Face::Relief(relief) => relief,
    };
    // The cells are as large as a piece of the face, which is no whole number of pixels: the rest of the last
    // ones is not used. A piece that is smaller than a pixel repeats.
    let tile = relief.tile(&SampleStream::new(Sampler::Random, effort.seed, 0), period_mm).cells;
    if relief.extent() == Extent::Drawn
        && let Some(axis) = (0..2).find(|axis| tile.period_mm[*axis] < meetings.least_mm[*axis])
    {
        return Err(SparkleError::ShortPeriod {
            period_mm: tile.period_mm[axis],
            least_mm: meetings.least_mm[axis],
        });
    }
    let size = [0, 1].map(|axis| pitch[axis] / of_pixel[axis]);
    let of_tile = [0, 1].map(|axis| (tile.period_mm[axis] / size[axis]).round().max(1.0));
    let repeats = [0, 1].map(|axis| (of_pixel[axis] / of_tile[axis]).ceil());
    let count = [0, 1].map(|axis| repeats[axis] * of_tile[axis]);
    // A piece may be a little larger than wanted.
    if count[0] * count[1] > 1.5 * MOST_CELLS {
        return Err(too_fine(count[0] * count[1] / per_pixel));
    }
    let cells = Cells {
        count: count.map(|count| count as usize),
        period_mm: [0, 1].map(|axis| count[axis] * size[axis]),
    };
    let repeats = repeats.map(|count| count as usize);
    let sampler = ReliefSampler::new(relief.clone(), period_mm, tile, repeats, cells);
    Ok((cells, whole, Slopes::Relief(sampler)))
}

/// Largest width of a cell, mm.
fn cell_width(panel: &Panel, view: &Deflection, effort: &Effort) -> f64 {
    let correlation = panel.face.detail_mm();
    let even = (correlation / effort.samples as f64).min(across_window(panel));
    if panel.pixel != Pixel::Mirror {
        return even;
    }
    // From one cell to the next, rays move by less than the radius of the source or pupil.
    let bend = view.bend * panel.face.slope_rms();
    let sources = panel.room.sources.iter().map(|source| {
        let radius = source.radius().hypot(panel.pupil.radius());
        0.25 * correlation * radius / bend
    });
    sources.fold(even, f64::min)
}

/// A quarter of the smallest side of a window, in which the light of a cell is uniform: of 2 cells across, a PPD is
/// 3 % too high. Not below a part of the pitch.
fn across_window(panel: &Panel) -> f64 {
    let sides = panel.matrix.windows.iter().flat_map(|window| {
        let [left, bottom, right, top] = window.rectangle_mm;
        [right - left, top - bottom]
    });
    let [x, y] = panel.matrix.pitch_mm;
    (0.25 * sides.fold(f64::INFINITY, f64::min)).max(x.max(y) / MOST_ACROSS)
}

/// Rings of points in the pupil, close enough for the face.
fn pupil_rings(panel: &Panel, view: &Deflection) -> usize {
    let radius = panel.pupil.radius();
    let reach = radius * largest(view.place_per_beta_mm);
    (3.0 * reach / panel.face.detail_mm()).ceil().clamp(1.0, MOST_RINGS) as usize
}

fn largest([xx, _, yy]: [f64; 3]) -> f64 {
    xx.max(yy)
}

/// The smallest product of 2, 3 and 5 that is not below a number.
fn smooth(least: f64) -> f64 {
    let reduced = |mut n: u64| {
        for factor in [2, 3, 5] {
            while n.is_multiple_of(factor) {
                n /= factor;
            }
        }
        n
    };
    let mut count = least.clamp(1.0, 1e9) as u64;
    while reduced(count) != 1 {
        count += 1;
    }
    count as f64
}
