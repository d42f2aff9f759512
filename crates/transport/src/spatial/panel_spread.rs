//! What a view sees of the pixel plane through the layers of an ordinary panel: directions, places and their light.
//!
//! **What.** A [`PanelSpread`] belongs to a view and a source. It is a list of [`Part`]s, each a list of [`Sample`]s (direction,
//! place, weight) with one factor for each wavelength. Light that has met the pixel once adds up to
//! `sum of through(wavelength) x weight x reflectance(beta, wavelength)`, the reflectance factor of that light: the same number as
//! that of colours, now with a place for each of its terms.
//!
//! **All orders.** The layers return light to the pixel ([`Returned`]). A small modulation of the pixel about a state of
//! reflectance rho is then seen as `V(f) rho/(1 - rho A(f))`, with V the transform of the samples; at f = 0 this is the reflectance
//! factor of a uniform state in all orders ([`PanelSpread::transfer`]). A mirror-like pixel under a flat face
//! has its own ghosts in A, a Lambertian one a halo.
//!
//! | above the pixel | Lambertian pixel | mirror-like pixel |
//! |---|---|---|
//! | a flat face | one place for each direction of view; halo | the same; ghosts |
//! | a diffuser | the lobe towards the viewer; halo by the front | lobes towards viewer and light; light that the front returns is missing |
//!
//! What is missing in the last case is the difference between the reflectance factor of colours and that of the spread at f = 0: a
//! bound of the error of both.

use std::fmt;

use papilio_optics::Beta;
use rustfft::num_complex::Complex64;

use super::returned::Returned;
use super::spread::Light;
use super::{Accuracy, Gap, Sample, Spread, displacement};
use crate::adding::quadrature::{Nodes, Point, cone_points_of, disc_points, smooth_at};
use crate::adding::{Mirror, diffuse_shares, image_points};
use crate::specular::FlatTop;
use crate::{Cone, Diffuser, Panel, Reflector, Source, Top};

/// Reason why the spread of a panel cannot be computed.
#[derive(Debug, Clone, PartialEq)]
pub enum SpreadError {
    /// There must be one length for each component of the front of screen that has a place, then that of the glass.
    Lengths {
        /// Number of lengths.
        found: usize,
    },
    /// Several components of the front of screen at different heights reflect light to the pixel; their common reflectance does
    /// not tell how much each of them does.
    SeveralFronts,
    /// The pixel scatters by a kernel of its own.
    ScatteringPixel,
    /// This kind of source is not covered above a diffuser.
    Source,
    /// A field of view of finite size is not covered above a diffuser.
    FieldOfView,
    /// A glass whose index depends on wavelength is not covered below a diffuser.
    DispersiveGlass,
    /// This lobe is not covered.
    Lobe,
    /// Light does not refract at a face of another index than the glass: places are not defined.
    Unrefracted,
}

impl fmt::Display for SpreadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Lengths { found } => {
                write!(f, "there are {found} lengths (expected at least one, that of the glass)")
            }
            Self::SeveralFronts => f.write_str(
                "several components of the front of screen reflect light to the pixel from different heights (expected one); \
                 the Monte Carlo solver follows them",
            ),
            Self::ScatteringPixel => f.write_str("the pixel scatters by a kernel of its own (expected a mirror or a Lambertian pixel)"),
            Self::Source => f.write_str("this kind of source is not covered above a diffuser"),
            Self::FieldOfView => f.write_str("a field of view of finite size is not covered above a diffuser"),
            Self::DispersiveGlass => f.write_str("a glass whose index depends on wavelength is not covered below a diffuser"),
            Self::Lobe => f.write_str("this lobe is not covered"),
            Self::Unrefracted => f.write_str("without refraction light has no place in the glass (expected angles in air or in glass)"),
        }
    }
}

impl std::error::Error for SpreadError {}

/// Directions and places with a common factor for each wavelength.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// What is seen, for a pixel that reflects everything and layers that transmit everything.
    pub samples: Vec<Sample>,
    /// Factor of these samples, `[wavelength]`: the transmittance of the layers on both ways. It may be negative where
    /// results are interpolated between indices of the glass.
    pub through: Vec<f64>,
    /// What the layers return to the pixel, for these samples.
    returned: Returned,
}

/// What a view sees of the pixel plane in the light of one source.
#[derive(Debug, Clone, PartialEq)]
pub struct PanelSpread {
    parts: Vec<Part>,
    own_mm: [f64; 2],
}

/// Heights of a panel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Heights {
    /// Air between the front of screen and what is below it, mm.
    pub(super) front_mm: f64,
    /// Glass, mm.
    pub(super) glass_mm: f64,
}

impl Heights {
    /// Reads the gaps of the components of the front, outermost first, and the thickness of the glass.
    pub(super) fn new(panel: &Panel, lengths_mm: &[f64]) -> Result<Self, SpreadError> {
        let Some((&glass_mm, fronts)) = lengths_mm.split_last() else {
            return Err(SpreadError::Lengths { found: 0 });
        };
        let returns = !panel.single_pass && panel.front.reflectance_below.max() > 0.0;
        // A component without reflectance above the highest one that reflects has no length.
        let apart = fronts.iter().skip_while(|gap| **gap == 0.0).count() > 1;
        if returns && apart {
            return Err(SpreadError::SeveralFronts);
        }
        Ok(Self { front_mm: if returns { fronts.iter().sum() } else { 0.0 }, glass_mm })
    }

    /// Shift of a crossing of the glass.
    fn in_glass(self, beta: Beta, index: f64) -> [f64; 2] {
        displacement(beta, self.glass_mm, index)
    }
}

impl PanelSpread {
    /// Prepares the spread.
    ///
    /// - `lengths_mm`: air below each component of the front of screen, outermost first, then the glass.
    /// - `view`: directions in air.
    ///
    /// # Errors
    /// If this panel, view or source is not covered.
    pub fn new(
        panel: &Panel,
        lengths_mm: &[f64],
        view: &Cone,
        source: &Source,
        accuracy: Accuracy,
    ) -> Result<Self, SpreadError> {
        let heights = Heights::new(panel, lengths_mm)?;
        if matches!(panel.base.reflector, Reflector::Scattering(_)) {
            return Err(SpreadError::ScatteringPixel);
        }
        let index = panel.medium.index();
        if index.min() <= 1.0 || matches!(&panel.top, Top::Fresnel(face) if face != index) {
            return Err(SpreadError::Unrefracted);
        }
        let middle = index[index.len() / 2];
        let parts = match &panel.top {
            Top::Diffuser(diffuser) => diffused((panel, diffuser), heights, view, source, accuracy)?,
            Top::IdealAr | Top::Fresnel(_) => bare(panel, heights, view, source, accuracy),
        };
        Ok(Self { parts, own_mm: heights.in_glass(view.axis_towards(), middle) })
    }

    /// The samples, by parts of a common factor.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Shift of the view's own ray, mm, at the wavelength in the middle of the grid.
    pub fn own_mm(&self) -> [f64; 2] {
        self.own_mm
    }

    /// Returns what is seen of a small modulation of the pixel about each of its states at each of these frequencies (cycles per
    /// mm along x and y), as a reflectance factor: 1 of it at all places at f = 0. Its phase is about the
    /// view's own ray. Shape `[frequency][state][wavelength]`.
    pub fn transfer(&self, panel: &Panel, frequencies_per_mm: &[[f64; 2]]) -> Vec<Complex64> {
        let base = &panel.base;
        let (states, bins) = (base.states(), base.bins());
        let mut out = vec![Complex64::ZERO; frequencies_per_mm.len() * states * bins];
        let mut rho = vec![0.0; states * bins];
        for part in &self.parts {
            for (frequency, out) in frequencies_per_mm.iter().zip(out.chunks_exact_mut(states * bins)) {
                let returned = part.returned.at(*frequency);
                for sample in &part.samples {
                    base.reflectance(sample.beta.squared(), &panel.medium, &mut rho);
                    let turns: f64 =
                        (0..2).map(|k| frequency[k] * (sample.shift_mm[k] - self.own_mm[k])).sum();
                    let phase = Complex64::from_polar(sample.weight, -2.0 * std::f64::consts::PI * turns);
                    for (k, (out, rho)) in out.iter_mut().zip(&rho).enumerate() {
                        let orders = returned.get(k % bins).map_or(Complex64::ONE, |a| 1.0 / (1.0 - a * rho));
                        *out += phase * orders * (rho * part.through[k % bins]);
                    }
                }
            }
        }
        out
    }
}

/// Spread through a diffuser.
fn diffused(
    (panel, diffuser): (&Panel, &Diffuser),
    heights: Heights,
    view: &Cone,
    source: &Source,
    accuracy: Accuracy,
) -> Result<Vec<Part>, SpreadError> {
    let index = panel.medium.constant_index().ok_or(SpreadError::DispersiveGlass)?;
    if !view.is_point() {
        return Err(SpreadError::FieldOfView);
    }
    if !panel.base.is_specular() || diffuser.lobe == papilio_optics::lobe::Lobe::Lambertian {
        return Err(SpreadError::Lobe);
    }
    let light = match source {
        Source::Diffuse => Light::Diffuse,
        Source::Beam(beta) => Light::Beam(*beta),
        Source::Disc(_) | Source::Field(_) => return Err(SpreadError::Source),
    };
    let gap = Gap { index, thickness_mm: heights.glass_mm };
    let spread = Spread::new(diffuser, gap, view.axis_towards(), light, accuracy);
    let through = panel.front.transmittance.iter().zip(diffuser.transmittance.iter());
    Ok(vec![Part {
        samples: spread.samples().to_vec(),
        through: through.map(|(front, diffuser)| (front * diffuser).powi(2)).collect(),
        returned: Returned::Nothing,
    }])
}

/// Spread through a flat face: every direction of view has one place.
fn bare(panel: &Panel, heights: Heights, view: &Cone, source: &Source, accuracy: Accuracy) -> Vec<Part> {
    let digits = accuracy.digits;
    let points = seen_points(panel, view, source, digits);
    let light = light_of(panel, source, digits);
    let lambertian = (!panel.base.is_specular()).then(|| Returned::by_face(panel, heights, accuracy));
    let mut flat = FlatTop::new(panel.base.bins());
    let mut parts = Vec::new();
    for point in points {
        flat.set(panel, point.beta.squared());
        let returned = match &lambertian {
            Some(returned) => returned.clone(),
            None => Returned::ghosts(panel, heights, point.beta),
        };
        for (index, bins) in by_index(panel) {
            let through = |bin: usize| {
                let entering = light.as_ref().map_or(flat.t[bin], |light| light[bin]);
                if bins.contains(&bin) { entering * flat.t[bin] } else { 0.0 }
            };
            let shift_mm = heights.in_glass(point.beta, index);
            parts.push(Part {
                samples: vec![Sample { beta: point.beta, shift_mm, weight: point.weight }],
                through: (0..flat.t.len()).map(through).collect(),
                returned: returned.clone(),
            });
        }
    }
    parts
}

/// Returns the directions of a bare panel that are seen, with the weights of their light.
fn seen_points(panel: &Panel, view: &Cone, source: &Source, digits: f64) -> Vec<Point> {
    let across = panel.base.nodes_across(view, &panel.medium);
    if *source != Source::Diffuse && panel.base.is_specular() {
        let images = image_points(view, std::slice::from_ref(source), digits, Mirror::Across(across));
        return images.into_iter().flat_map(|image| image.points).collect();
    }
    let nodes = Nodes { rings: (digits / 2.5) as usize, across };
    cone_points_of(view, smooth_at(view, SMOOTH), digits, nodes)
}

/// Angle over which the reflectances of interfaces and pixels change, radians.
const SMOOTH: f64 = 0.3;

/// Returns, for a Lambertian pixel, what reaches it of the light, times that which leaves into the directions of the light, over
/// what is emitted; none for a mirror, which sees the light in the direction of view. Shape `[wavelength]`.
fn light_of(panel: &Panel, source: &Source, digits: f64) -> Option<Vec<f64>> {
    if panel.base.is_specular() {
        return None;
    }
    let points = match source {
        Source::Diffuse => return Some(diffuse_shares(panel, digits).0),
        Source::Beam(beta) => vec![Point { beta: *beta, weight: 1.0 }],
        Source::Disc(cone) => disc_points(cone, smooth_at(cone, SMOOTH), digits),
        Source::Field(field) => crate::adding::smooth_points(field, SMOOTH, digits),
    };
    let mut flat = FlatTop::new(panel.base.bins());
    let mut sum = vec![0.0; panel.base.bins()];
    for point in points {
        flat.set(panel, point.beta.squared());
        let index = panel.medium.index().iter();
        for ((sum, t), index) in sum.iter_mut().zip(&flat.t).zip(index) {
            *sum += point.weight * t / (index * index);
        }
    }
    Some(sum)
}

/// Returns the indices of the glass, each with its wavelengths.
fn by_index(panel: &Panel) -> Vec<(f64, Vec<usize>)> {
    let mut all: Vec<(f64, Vec<usize>)> = Vec::new();
    for (bin, index) in panel.medium.index().iter().enumerate() {
        match all.iter_mut().find(|known| known.0 == *index) {
            Some(known) => known.1.push(bin),
            None => all.push((*index, vec![bin])),
        }
    }
    all
}
