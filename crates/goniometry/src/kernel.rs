//! From a part of a measurement to the kernel that light meets in a display.
//!
//! Nothing is changed that is not asked for, and [`Changes`] says what was: dark cells stay dark unless tails are to go on
//! through them, totals are the values' own unless they are to be the instrument's TIS, and light from
//! beyond the largest incidence is not let through unless the last lobe is to hold there.

use papilio_optics::interface::fresnel_reflectance;
use papilio_optics::scatter::{Scatter, Table};

use crate::{Fill, Geometry, GoniometryError, Part, Shape, incidence_scale};

/// Distances of the table: `w sinh(t)` in such steps of t, w a half-width. Interpolation by cubics is good to
/// 1e-4 then.
const STEP: f64 = 0.125;
/// Azimuths of the table.
const AZIMUTHS: usize = 19;
/// A lobe this wide (direction cosines) needs no finer distances.
const WIDEST: f64 = 0.5;
/// Beyond the last incidence light fades over this distance, in direction cosines.
const FADE: f64 = 0.004;

/// What may be done to a measurement on its way into a display.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Preparation {
    /// Dark cells.
    pub fill: Fill,
    /// Totals become the instrument's TIS.
    pub to_tis: bool,
    /// Beyond the largest incidence its lobe holds, shifted with the light.
    pub extrapolate: bool,
    /// Of a transmission: its back face in air is removed.
    pub lamination: Option<Lamination>,
}

/// A film that was measured in air, and in the display touches the glass: the Fresnel loss of its back face is
/// taken out of what it transmits, `f / T(beta_out)` with T of a face of this index.
///
/// To first order: light that the back face sent into the film again is not followed. Next to grazing, where T goes
/// to 0, the division ends at a T of .1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lamination {
    /// Index of film and glass.
    pub index: f64,
}

/// A face that passes less than this is taken to pass as much.
const LEAST_PASSED: f64 = 0.1;

/// What was done, and what is left open.
#[derive(Debug, Clone, PartialEq)]
pub struct Changes {
    /// Share of the cells in the hemisphere that were dark and filled.
    pub filled: f64,
    /// Totals before and after, by incidence.
    pub totals: Vec<[f64; 2]>,
    /// True if totals became the instrument's.
    pub to_tis: bool,
    /// True if the loss of a back face was taken out.
    pub laminated: bool,
    /// The largest incidence, degrees.
    pub last_deg: f64,
    /// Share of diffuse light that comes from beyond it, and is lost.
    pub lost: f64,
    /// Relative error of the totals that the grid leaves, the largest.
    pub grid_error: f64,
    /// Mirrored and turned cells differed by so much (root mean square, relative).
    pub asymmetry: f64,
}

/// The kernel of one channel of a part, times k of each incidence (see
/// [`incidence_scale`]); `spectrum` is what it will be multiplied with, at evenly spaced
/// wavelengths (empty: 1).
///
/// # Errors
/// If the part has no lobe of its own (patches), lacks the TIS that is asked for, or a table cannot hold it.
pub fn kernel(
    part: &Part,
    channel: usize,
    preparation: &Preparation,
    spectrum: &[f64],
) -> Result<(Scatter, Changes), GoniometryError> {
    // Patches of ten degrees hide what a display shows.
    let coarse = matches!(part.geometry, Geometry::Patches { .. });
    let shape =
        Shape::of_part(part, channel, preparation.fill).filter(|_| !coarse).ok_or(GoniometryError::NoGrid)?;
    let incidences: Vec<f64> = shape.incidences_deg().collect();
    let tis: Option<Vec<f64>> = (0..incidences.len()).map(|k| part.tis(channel, 0, k)).collect();
    let tis = match (preparation.to_tis, tis) {
        (true, None) => return Err(GoniometryError::NoTis),
        (true, tis) => tis,
        (false, _) => None,
    };
    let scale = incidence_scale(&shape, tis.as_deref(), spectrum);
    let mean = if spectrum.is_empty() { 1.0 } else { spectrum.iter().sum::<f64>() / spectrum.len() as f64 };
    let radial = distances(&shape);
    let azimuth: Vec<f64> =
        (0..AZIMUTHS).map(|k| std::f64::consts::PI * k as f64 / (AZIMUTHS - 1) as f64).collect();
    let mut values = shape.tabulate(&radial, &azimuth);
    let cells = radial.len() * azimuth.len();
    for ((lobe, scale), from) in values.chunks_exact_mut(cells).zip(&scale).zip(&incidences) {
        lobe.iter_mut().for_each(|value| *value *= scale);
        if let Some(lamination) = preparation.lamination {
            lamination.apply(lobe, from.to_radians().sin(), &azimuth, &radial);
        }
    }
    let mut incidence: Vec<f64> = incidences.iter().map(|theta| theta.to_radians().sin()).collect();
    let last = incidence[incidence.len() - 1];
    let mut lost = 0.0;
    if !preparation.extrapolate && last + FADE < 1.0 {
        lost = 1.0 - last * last;
        incidence.extend([last + FADE, 1.0]);
        values.extend(std::iter::repeat_n(0.0, 2 * cells));
    }
    let scatter = Scatter::from(Table::new(&incidence, &radial, &azimuth, &values)?);
    let totals = (0..incidences.len()).map(|k| [shape.total(k), mean * scatter.total(incidence[k])]);
    let changes = Changes {
        filled: shape.filled(),
        totals: totals.collect(),
        to_tis: preparation.to_tis,
        laminated: preparation.lamination.is_some(),
        last_deg: incidences[incidences.len() - 1],
        lost,
        grid_error: (0..incidences.len()).map(|k| shape.grid_error(k)).fold(0.0, f64::max),
        asymmetry: shape.asymmetry(),
    };
    Ok((scatter, changes))
}

impl Lamination {
    /// Of one incidence's values, `[azimuth][radial]`.
    fn apply(&self, lobe: &mut [f64], from: f64, azimuth: &[f64], radial: &[f64]) {
        for (line, azimuth) in lobe.chunks_exact_mut(radial.len()).zip(azimuth) {
            for (value, r) in line.iter_mut().zip(radial) {
                let out = (from + r * azimuth.cos()).hypot(r * azimuth.sin()).min(1.0);
                let passed = 1.0 - fresnel_reflectance(1.0, self.index, out);
                *value /= passed.max(LEAST_PASSED);
            }
        }
    }
}

/// Distances from the peak, fine where the lobe falls, up to across the disc.
fn distances(shape: &Shape) -> Vec<f64> {
    let half_widths = (0..shape.incidences_deg().count())
        .flat_map(|k| [0.0, 90.0, 180.0].map(|azimuth| shape.half_width_deg(k, azimuth)))
        .flatten()
        .map(|degrees| degrees.to_radians().sin());
    let width = half_widths.fold(WIDEST, f64::min);
    let steps = ((2.0 / width).asinh() / STEP).ceil();
    let step = (2.0 / width).asinh() / steps;
    (0..=steps as usize).map(|k| (width * (k as f64 * step).sinh()).min(2.0)).collect()
}
