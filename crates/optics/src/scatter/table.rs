//! A tabulated kernel: a measured BTDF or BRDF.
//!
//! **Coordinates.** `|beta|` of the incidence (the sine of its angle in air), and the scattered direction
//! about the specular one: distance and azimuth of `beta_out - beta_in`, both of propagation, azimuth 0 away
//! from the normal, pi towards it. The peak thus moves with the incidence, whereas interpolation between
//! plain directions would show it twice. A lobe that depends only on that difference (k-correlation) is the
//! same at all incidences.
//!
//! **Interpolation.** The kernel is cubic in its logarithm, along diameters through the peak and over
//! azimuth and incidence, and does not overshoot ([`smooth`](super::smooth)). A k-correlation lobe tabulated
//! every 0.3 of its width b keeps its values within 0.04 %, every 0.9 within 0.5 %; every b, its integral
//! within 0.1 %.
//!
//! **Edges.** Before the first incidence its values are used. Beyond the last one its values are used too,
//! or nothing is scattered ([`Table::dark_beyond`]). Beyond the last distance nothing is scattered. Along
//! the normal, and at the peak, the mean over azimuth is used: an isotropic sample has no azimuth there.
//!
//! **Faces.** What leaves through a smooth face falls towards the horizon with the transmittance of the face,
//! as a square root of `1 - |beta|`, which no cubic follows. A kernel [behind a face](Table::behind_face) is
//! the interpolated one times the transmittances of both directions.
//!
//! **Sampling.** [`sample`](crate::scatterer::Scatterer::sample) uses a working table that is bilinear
//! between finer nodes: samples follow `density` exactly, and value over density is the albedo, within a few
//! percent.

use std::f64::consts::PI;
use std::sync::OnceLock;

use super::albedos::{Albedos, Totals, integral, intervals, turned};
use super::axis::Axis;
use super::proposal::Proposal;
use super::smooth::Smooth;
use crate::interface::fresnel_reflectance;
use crate::{Beta, OpticsError};

/// A tabulated kernel.
#[derive(Debug, Clone)]
pub struct Table {
    smooth: Smooth,
    /// Sampling tables, forward and for light in the opposite direction; computed on first use.
    proposals: [OnceLock<Proposal>; 2],
    albedos: [OnceLock<Albedos>; 2],
    /// The same by fineness, more accurately.
    totals: [[OnceLock<Totals>; FINEST]; 2],
    /// Cells for integrals.
    cells: OnceLock<[Axis; 2]>,
    width: f64,
    /// Last tabulated `|beta|` of incidence.
    last: f64,
    /// Largest `|beta|`, 1 at most, of incidence from which light is scattered.
    end: f64,
    /// Largest `|beta|` to which light is scattered.
    reach: f64,
    /// Index of a medium below a smooth face to air that the light passes twice.
    face: Option<f64>,
}

/// Kernels are equal if their values are: everything else follows from them.
impl PartialEq for Table {
    fn eq(&self, other: &Self) -> bool {
        let ends = |table: &Self| [table.width, table.last, table.end, table.reach];
        ends(self) == ends(other) && self.face == other.face && self.smooth == other.smooth
    }
}

/// Largest distance between working incidences, distances and azimuths.
const WORKING_INCIDENCE: f64 = 0.05;
const WORKING_AZIMUTH: f64 = PI / 18.0;
/// Largest `|beta|` to which light is scattered: indices of glass are smaller.
const FARTHEST: f64 = 4.0;
/// Number of cells of the working table up to which distances are halved.
const WORKING_CELLS: usize = 60_000;
/// Smallest transmittance of a face with which directions are sampled: samples towards the horizon, where it
/// vanishes within less than a cell, are then frequent enough.
const LEAST_SAMPLED: f64 = 0.3;
/// Finest accuracy of totals.
const FINEST: usize = 8;
/// Nodes of totals in an interval, besides one for each step of fineness, and their longest interval.
const TOTAL_NODES: usize = 4;
const TOTAL_INTERVAL: f64 = 0.125;
/// Number of cells about the peak that integrals need.
const SMOOTH_CELLS: usize = 1000;

impl Table {
    /// Builds a kernel from f in 1/sr in `[incidence][azimuth][radial]` order, at ascending `|beta|` of
    /// incidence (0 to 1), azimuths (radians, from 0 to pi, or one for all) and distances (0 to 2, or more
    /// for a table that is to [extend](Self::reaching) farther).
    ///
    /// # Errors
    /// An axis that does not ascend or leaves its range; a value that is negative or not finite; a wrong
    /// number of values.
    pub fn new(
        incidence: &[f64],
        radial: &[f64],
        azimuth: &[f64],
        values: &[f64],
    ) -> Result<Self, OpticsError> {
        ascending("|beta| of incidence", incidence, 1.0, 1)?;
        ascending("distances", radial, 1.0 + FARTHEST, 2)?;
        ascending("azimuths", azimuth, PI, 1)?;
        if let [first, .., last] = azimuth
            && (*first > 1e-9 || *last < PI - 1e-9)
        {
            return Err(OpticsError::Axis { what: "azimuths", expected: "numbers from 0 to pi" });
        }
        let expected = incidence.len() * azimuth.len() * radial.len();
        if values.len() != expected {
            return Err(OpticsError::Length { what: "densities", expected, found: values.len() });
        }
        if let Some(at) = values.iter().position(|v| !(v.is_finite() && *v >= 0.0)) {
            return Err(OpticsError::Density { at, value: values[at] });
        }
        let smooth = Smooth::new(incidence, radial, azimuth, values);
        Ok(Self {
            width: width(&smooth),
            smooth,
            proposals: Default::default(),
            albedos: Default::default(),
            totals: Default::default(),
            cells: OnceLock::new(),
            last: incidence[incidence.len() - 1],
            end: 1.0,
            reach: 1.0,
            face: None,
        })
    }

    /// Returns the kernel times the transmittances, for the directions of incident and of scattered light in air,
    /// of a smooth face to a medium of this index.
    pub fn behind_face(self, index: f64) -> Self {
        Self { face: Some(index), ..self }.without_integrals()
    }

    /// Transmittances of the face for both directions, if there is one.
    #[inline]
    fn passed(&self, from: Beta, to: Beta) -> f64 {
        let Some(index) = self.face else { return 1.0 };
        let [from, to] = [from, to].map(|beta| 1.0 - fresnel_reflectance(1.0, index, beta.length()));
        from * to
    }

    /// Returns the same kernel without scattering of light from beyond its last incidence.
    pub fn dark_beyond(self) -> Self {
        let end = self.last.min(1.0);
        Self { end, ..self }.without_integrals()
    }

    /// Returns the same kernel as a transmission that scatters light of air into a medium of this index, 1
    /// to 4, also beyond the disc of air; light of the medium returns along the same paths.
    pub fn reaching(self, reach: f64) -> Self {
        let reach = reach.clamp(1.0, FARTHEST);
        Self { reach, ..self }.without_integrals()
    }

    /// Returns the same kernel without light that is scattered to a `|beta|` above this one, 1 at most.
    pub fn ending(self, reach: f64) -> Self {
        let reach = reach.clamp(0.0, 1.0);
        Self { reach, ..self }.without_integrals()
    }

    fn without_integrals(self) -> Self {
        let (albedos, totals) = (Default::default(), Default::default());
        Self { proposals: Default::default(), albedos, totals, ..self }
    }

    /// Returns the `|beta|` at which the kernel ends: of incident light, and of scattered light.
    #[inline]
    pub(super) fn ends(&self) -> [f64; 2] {
        [self.end, self.reach]
    }

    /// Returns the radii of the discs of incident and scattered light, within which its kernel may end
    /// earlier.
    fn discs(&self, reversed: bool) -> [f64; 2] {
        if reversed { [self.reach, 1.0] } else { [1.0, self.reach] }
    }

    /// Returns the kernel without regard to the disc of air and to its ends, in either direction.
    #[inline]
    fn held(&self, from: Beta, to: Beta, reversed: bool) -> f64 {
        self.inner(from, to, reversed) * self.passed(from, to)
    }

    /// Returns the kernel below its face.
    #[inline]
    fn inner(&self, from: Beta, to: Beta, reversed: bool) -> f64 {
        let [from, to] = if reversed { [to, from] } else { [from, to] };
        let (length, distance, azimuth) = place(from, to);
        self.smooth.value(length, distance, azimuth)
    }

    /// Returns incidences, distances and azimuths of the working table.
    fn working(&self, from: f64) -> [Vec<f64>; 3] {
        let incidence = finer(self.smooth.incidence.nodes(), from, WORKING_INCIDENCE);
        let azimuth = finer(self.smooth.azimuth.nodes(), PI, WORKING_AZIMUTH);
        let mut radial = self.smooth.radial.nodes().to_vec();
        while 2 * radial.len() * azimuth.len() * incidence.len() < WORKING_CELLS {
            radial = halved(&radial);
        }
        [incidence, radial, azimuth]
    }

    fn proposal(&self, reversed: bool) -> &Proposal {
        self.proposals[usize::from(reversed)].get_or_init(|| {
            let [from, to] = self.discs(reversed);
            let axes = self.working(from);
            Proposal::new(axes.each_ref().map(|axis| &axis[..]), to, |from, to| {
                // The light of an incidence is sampled in any case, however little of it there is.
                self.inner(from, to, reversed) * self.passed(Beta::default(), to).max(LEAST_SAMPLED)
            })
        })
    }

    fn albedos(&self, reversed: bool) -> &Albedos {
        self.albedos[usize::from(reversed)].get_or_init(|| {
            let cells = self.cells();
            let from = if reversed { self.reach } else { self.end };
            Albedos::new(from, |length| self.integral(cells, length, reversed, 2))
        })
    }

    /// Returns distances and azimuths between which the kernel is smooth, and changes little.
    fn cells(&self) -> &[Axis; 2] {
        self.cells.get_or_init(|| {
            let azimuth = finer(self.smooth.azimuth.nodes(), PI, WORKING_AZIMUTH);
            let mut radial = self.smooth.radial.nodes().to_vec();
            while radial.len() * azimuth.len() < SMOOTH_CELLS {
                radial = halved(&radial);
            }
            [radial, azimuth].map(Axis::mirrored)
        })
    }

    fn integral(&self, [distances, angles]: &[Axis; 2], length: f64, reversed: bool, points: usize) -> f64 {
        let to = if reversed { self.end } else { self.reach };
        integral(distances, angles, (length, to), points, |distance, angle| {
            if !reversed && self.face.is_none() {
                return self.smooth.value(length, distance, angle);
            }
            let [from, to] = turned(length, distance, angle);
            self.held(from, to, reversed)
        })
    }

    /// Returns [`Self::albedo`] more accurately, the more so with every step of `fineness`: by more points in
    /// each cell, and by interpolation between more nodes. All incidences together take as long as some
    /// hundred integrals, once for each fineness.
    pub(super) fn albedo_by(&self, length: f64, reversed: bool, fineness: usize) -> f64 {
        let [end, to] = if reversed { [self.reach, self.end] } else { [self.end, self.reach] };
        if length > end {
            return 0.0;
        }
        let fineness = fineness.clamp(1, FINEST);
        if end == 0.0 {
            return self.integral(self.cells(), length, reversed, fineness);
        }
        let totals = self.totals[usize::from(reversed)][fineness - 1].get_or_init(|| {
            // The kernel is smooth between its incidences. Its integral over them is smooth but for the
            // normal, where it may be a cone.
            let (nodes, normal): (&[f64], _) =
                if reversed { (&[], Some(0.0)) } else { (self.smooth.incidence.nodes(), None) };
            let edges: Vec<f64> = [end, to].into_iter().chain(normal).collect();
            let ends = intervals(end, &edges, self.width, nodes, TOTAL_INTERVAL);
            let cells = self.cells();
            Totals::new(ends, fineness + TOTAL_NODES, |length| {
                self.integral(cells, length, reversed, fineness)
            })
        });
        totals.at(length)
    }

    #[inline]
    pub(super) fn value(&self, from: Beta, to: Beta) -> f64 {
        let is_dark = from.squared() > self.end * self.end || to.squared() > self.reach * self.reach;
        if is_dark { 0.0 } else { self.held(from, to, false) }
    }

    #[inline]
    pub(super) fn sample(&self, from: Beta, u: [f64; 3], reversed: bool) -> Beta {
        self.proposal(reversed).sample(from, u)
    }

    #[inline]
    pub(super) fn density(&self, from: Beta, to: Beta, reversed: bool) -> f64 {
        let (length, distance, azimuth) = place(from, to);
        self.proposal(reversed).density(length, distance, azimuth)
    }

    #[inline]
    pub(super) fn albedo(&self, length: f64, reversed: bool) -> f64 {
        self.albedos(reversed).at(length)
    }

    pub(super) fn width(&self) -> f64 {
        self.width
    }
}

/// Returns `|beta|` of incidence, then distance and azimuth of the displacement to `to`.
#[inline]
fn place(from: Beta, to: Beta) -> (f64, f64, f64) {
    let way = to - from;
    let along = way.x * from.x + way.y * from.y;
    let across = way.y * from.x - way.x * from.y;
    (from.length(), way.length(), across.abs().atan2(along))
}

/// Returns the smallest width of a k-correlation lobe that decreases to half of its peak where this kernel
/// does at some incidence and azimuth.
fn width(smooth: &Smooth) -> f64 {
    // For a lobe of width 1.
    let half_of_lobe = (2.0_f64.powf(2.0 / 3.0) - 1.0).sqrt();
    let mut least = f64::INFINITY;
    for &incidence in smooth.incidence.nodes() {
        for &azimuth in smooth.azimuth.nodes() {
            let peak = smooth.value(incidence, 0.0, azimuth);
            let below = |r: f64| smooth.value(incidence, r, azimuth) < 0.5 * peak;
            let Some(node) = smooth.radial.nodes().iter().position(|r| below(*r)) else { continue };
            let (mut low, mut high) = (smooth.radial.nodes()[node.max(1) - 1], smooth.radial.nodes()[node]);
            for _ in 0..30 {
                let middle = 0.5 * (low + high);
                if below(middle) { high = middle } else { low = middle }
            }
            least = least.min(high / half_of_lobe);
        }
    }
    least.clamp(1e-3, 1.0)
}

/// Returns nodes, with further ones in between, up to `end`, so that none are farther apart than `step`.
fn finer(nodes: &[f64], end: f64, step: f64) -> Vec<f64> {
    let mut all = vec![nodes[0]];
    let ends = nodes[1..].iter().copied().chain((nodes[nodes.len() - 1] < end).then_some(end));
    for node in ends {
        let start = all[all.len() - 1];
        let parts = ((node - start) / step - 1e-9).ceil().max(1.0);
        all.extend((1..=parts as usize).map(|part| start + (node - start) * part as f64 / parts));
    }
    all
}

fn halved(nodes: &[f64]) -> Vec<f64> {
    let mut all: Vec<f64> = nodes.windows(2).flat_map(|pair| [pair[0], 0.5 * (pair[0] + pair[1])]).collect();
    all.extend(nodes.last());
    all
}

fn ascending(what: &'static str, nodes: &[f64], last: f64, least: usize) -> Result<(), OpticsError> {
    let good = nodes.len() >= least
        && nodes.windows(2).all(|pair| pair[1] > pair[0])
        && nodes.iter().all(|node| (0.0..=last + 1e-9).contains(node));
    if good { Ok(()) } else { Err(OpticsError::Axis { what, expected: "ascending numbers in their range" }) }
}
