//! A bare panel: front and surface are flat, only the base may scatter.
//!
//! A mirror under flat parts is a geometric series at every angle. A Lambertian base sends the same basic
//! radiance `R/(pi n^2)` everywhere, so one number closes all orders: the fraction `r_d` of it that front
//! and surface send back (Saunderson's internal diffuse reflectance), which is exact beyond the critical
//! angle.

use std::f64::consts::FRAC_PI_2;

use papilio_optics::Beta;
use papilio_spectra::StateSpectra;

use super::add_scaled;
use crate::light::cone_points::{Nodes, Point, cone_points_of, disc_points, smooth_at};
use crate::light::images::{ImagePoints, Mirror, image_points};
use crate::light::rings::{Peaks, Ring, rings};
use crate::mueller::Orders;
use crate::numerics::quadrature::{Node, Pole, graded};
use crate::specular::{FlatTop, panel_image};
use crate::{Cone, Estimate, Field, Ledger, Panel, ReflectanceFactor, Reflector, Source, Top, WholeView};

/// Angle over which the reflectances of interfaces and pixels change, radians.
const SMOOTH: f64 = 0.3;

#[derive(Debug, Clone, Default)]
pub(super) struct Kernel {
    digits: f64,
    views: Vec<View>,
    lights: Vec<Light>,
    /// Direction cosines of the light of lamps.
    centres: Vec<Option<Beta>>,
    is_polarising: bool,
}

#[derive(Debug, Clone)]
struct View {
    cone: Cone,
    /// Number of nodes of the base's table across it for which its points were made.
    across: f64,
    points: Vec<Point>,
    images: Vec<ImagePoints>,
}

#[derive(Debug, Clone)]
enum Light {
    Diffuse,
    /// A beam, a disc or a field, as points.
    Directed(Vec<Point>),
}

/// Light at the base and above it: shapes as in the [`Ledger`], `mirrored` and `absorbed_entering`
/// `[wavelength]`.
struct Fate {
    mirrored: Vec<f64>,
    absorbed_entering: Vec<f64>,
    arriving: StateSpectra,
    reflected: StateSpectra,
    leaving: StateSpectra,
    absorbed: StateSpectra,
    unaccounted: StateSpectra,
}

/// Returns whether the pixel changes polarisation: it takes long in each direction, and is smooth where its table has few nodes.
fn is_polarising(stack: &Panel) -> bool {
    stack.mueller.is_some()
}

impl Kernel {
    /// Computes the points of a view or source in this panel.
    pub(super) fn new(stack: &Panel, views: &[Cone], sources: &[Source], digits: f64) -> Self {
        let view = |cone: &Cone| {
            let across = stack.base.nodes_across(cone, &stack.medium);
            let rings = if is_polarising(stack) { 1 } else { (digits / 2.5) as usize };
            View {
                cone: *cone,
                across,
                points: cone_points_of(cone, smooth_at(cone, SMOOTH), digits, Nodes { rings, across }),
                images: image_points(cone, sources, digits, Mirror::Across(across)),
            }
        };
        let light = |source: &Source| match source {
            Source::Diffuse => Light::Diffuse,
            Source::Beam(beta) => Light::Directed(vec![Point { beta: *beta, weight: 1.0 }]),
            Source::Disc(cone) => Light::Directed(disc_points(cone, smooth_at(cone, SMOOTH), digits)),
            Source::Field(field) => Light::Directed(smooth_points(field, SMOOTH, digits)),
        };
        Self {
            digits,
            views: views.iter().map(view).collect(),
            is_polarising: is_polarising(stack),
            lights: sources.iter().map(light).collect(),
            centres: sources.iter().map(Source::direction).collect(),
        }
    }

    /// Returns whether its points can be used for this base.
    pub(super) fn serves(&self, stack: &Panel) -> bool {
        let across = |view: &View| stack.base.nodes_across(&view.cone, &stack.medium);
        self.is_polarising == is_polarising(stack)
            && self.views.iter().all(|view| view.across == across(view))
    }

    pub(super) fn nodes(&self) -> usize {
        self.views.iter().map(|view| view.points.len()).sum()
    }

    pub(super) fn estimate(&self, stack: &Panel, view: usize) -> Estimate {
        let Some(view) = self.views.get(view) else { return Estimate::default() };
        let mut estimate = match &stack.base.reflector {
            Reflector::Specular(_) => self.over_mirror(stack, view),
            Reflector::Lambertian(reflectance) => self.over_lambertian(stack, view, reflectance),
            // Such a base occurs only under general layers, never in a panel.
            Reflector::Scattering(_) => Estimate::default(),
        };
        for seen in &view.images {
            let rho = &mut estimate.rho[seen.source];
            for point in &seen.points {
                let image = match Orders::of(stack, point.beta) {
                    Some(orders) => orders.seen(Some(&view.cone), seen.source, self.centres[seen.source]),
                    None => panel_image(stack, point.beta),
                };
                rho.add(&image, point.weight);
            }
        }
        estimate
    }

    fn over_mirror(&self, stack: &Panel, view: &View) -> Estimate {
        let mut fate = Fate::zeros(stack);
        let mut r = vec![0.0; fate.arriving.len()];
        let mut flat = FlatTop::new(stack.base.bins());
        let is_polarised = stack.whole.as_ref().is_some_and(WholeView::is_polarised);
        let mut polarised = None;
        for point in &view.points {
            flat.set(stack, point.beta.squared());
            if let Some(orders) = Orders::of(stack, point.beta) {
                orders.set(&mut flat);
                orders.equivalent(&flat, &mut r);
                if is_polarised {
                    let zeros = || ReflectanceFactor::zeros(stack.base.states(), stack.base.bins());
                    let seen = orders.seen(Some(&view.cone), usize::MAX, None);
                    polarised.get_or_insert_with(zeros).add(&seen, point.weight);
                }
            } else {
                stack.base.reflectance_towards(point.beta, &stack.medium, &mut r);
            }
            fate.enter(&flat, point.weight);
            for (k, r) in r.iter().enumerate() {
                let bin = k % flat.t.len();
                let (t, below) = (flat.t[bin], flat.below[bin]);
                let arriving = point.weight * t * orders(stack, t, below * r);
                fate.meet_base(k, arriving, *r, (t, below));
            }
        }
        let diffuse = polarised.unwrap_or_else(|| ReflectanceFactor {
            via_pixel: fate.leaving.clone(),
            front: fate.mirrored.clone(),
        });
        let rho = self.lights.iter().map(|light| match light {
            Light::Diffuse => diffuse.clone(),
            Light::Directed(_) => ReflectanceFactor::zeros(stack.base.states(), stack.base.bins()),
        });
        Estimate { rho: rho.collect(), ledger: fate.ledger(stack) }
    }

    fn over_lambertian(&self, stack: &Panel, view: &View, reflectance: &[f64]) -> Estimate {
        let mut fate = Fate::zeros(stack);
        let bins = stack.base.bins();
        let mut flat = FlatTop::new(bins);
        let mut entering = vec![0.0; bins];
        for point in &view.points {
            flat.set(stack, point.beta.squared());
            fate.enter(&flat, point.weight);
            add_scaled(&mut entering, &flat.t, point.weight);
        }
        let (out, back) = diffuse_shares(stack, self.digits);
        for (k, r) in reflectance.iter().enumerate() {
            let bin = k % bins;
            let arriving = entering[bin] * orders(stack, entering[bin], back[bin] * r);
            fate.meet_base(k, arriving, *r, (out[bin], back[bin]));
        }
        let rho = self.lights.iter().map(|light| match light {
            Light::Diffuse => {
                ReflectanceFactor { via_pixel: fate.leaving.clone(), front: fate.mirrored.clone() }
            }
            Light::Directed(points) => {
                let mut towards = vec![0.0; bins];
                for point in points {
                    flat.set(stack, point.beta.squared());
                    add_scaled(&mut towards, &flat.t, point.weight);
                }
                let index = stack.medium.index();
                let seen = |(k, light): (usize, &f64)| light * towards[k % bins] / index[k % bins].powi(2);
                let base = fate.reflected.iter().enumerate().map(seen).collect();
                ReflectanceFactor { via_pixel: StateSpectra::new(base, bins), front: vec![0.0; bins] }
            }
        });
        Estimate { rho: rho.collect(), ledger: fate.ledger(stack) }
    }
}

/// Returns the fractions of a Lambertian base's light that leave, and that return to it, under flat parts.
pub(crate) fn diffuse_shares(stack: &Panel, digits: f64) -> (Vec<f64>, Vec<f64>) {
    let bins = stack.base.bins();
    let (mut out, mut back) = (vec![0.0; bins], vec![0.0; bins]);
    let lowest = match &stack.top {
        Top::Fresnel(index) => index.min(),
        Top::IdealAr | Top::Diffuser(_) => f64::INFINITY,
    };
    // beta = sin x resolves the grazing end in air; the grazing end in the medium of the interface is a
    // pole.
    let poles = if lowest.is_finite() { vec![Pole { at: lowest, off: 0.0 }.in_arc(1.0)] } else { vec![] };
    let mut flat = FlatTop::new(bins);
    for Node { x, weight } in graded(0.0, FRAC_PI_2, &[], &poles, digits) {
        flat.set(stack, x.sin().powi(2));
        let area = weight * (2.0 * x).sin();
        add_scaled(&mut out, &flat.t, area);
        add_scaled(&mut back, &flat.below, area);
    }
    for (bin, index) in stack.medium.index().iter().enumerate() {
        let area = index * index;
        out[bin] /= area;
        // Beyond the critical angle all light returns.
        back[bin] = (back[bin] + area - 1.0) / area;
    }
    (out, back)
}

/// Returns points of a field for functions of the inclination that change over this angle.
pub(crate) fn smooth_points(field: &Field, smooth: f64, digits: f64) -> Vec<Point> {
    let rings = rings(field, Peaks { views: &[], width: smooth }, digits);
    let point = |ring: &Ring| Point { beta: Beta { x: ring.radius, y: 0.0 }, weight: ring.weight() };
    rings.iter().map(point).collect()
}

/// Sums all orders of a round trip that preserves this fraction of light that has entered with `t`.
fn orders(stack: &Panel, t: f64, share: f64) -> f64 {
    if stack.single_pass || t == 0.0 { 1.0 } else { 1.0 / (1.0 - share) }
}

impl Fate {
    fn zeros(stack: &Panel) -> Self {
        let base = &stack.base;
        let (all, one) = (|| StateSpectra::zeros(base.states(), base.bins()), || vec![0.0; base.bins()]);
        Self {
            mirrored: one(),
            absorbed_entering: one(),
            arriving: all(),
            reflected: all(),
            leaving: all(),
            absorbed: all(),
            unaccounted: all(),
        }
    }

    fn enter(&mut self, flat: &FlatTop, weight: f64) {
        add_scaled(&mut self.mirrored, &flat.above, weight);
        for (sum, (t, above)) in self.absorbed_entering.iter_mut().zip(flat.t.iter().zip(&flat.above)) {
            *sum += weight * (1.0 - t - above);
        }
    }

    /// Adds light that arrives at the base in all orders, and its way up: `above` holds the fractions of it
    /// that leave and that return.
    fn meet_base(&mut self, k: usize, arriving: f64, r: f64, above: (f64, f64)) {
        let (out, back) = above;
        let reflected = arriving * r;
        self.arriving[k] += arriving;
        self.reflected[k] += reflected;
        self.leaving[k] += reflected * out;
        self.absorbed[k] += reflected * (1.0 - out - back);
        self.unaccounted[k] += reflected * back;
    }

    fn ledger(self, stack: &Panel) -> Ledger {
        let mut ledger = Ledger::zeros(self.arriving.states(), stack.base.bins());
        let inactive = &stack.base.inactive_absorptance;
        for k in 0..self.arriving.len() {
            let bin = k % inactive.len();
            ledger.inactive[k] = self.arriving[k] * inactive[bin];
            ledger.pixel[k] = self.arriving[k] - self.reflected[k] - ledger.inactive[k];
            ledger.returned[k] = self.mirrored[bin] + self.leaving[k];
            ledger.front[k] = self.absorbed_entering[bin] + self.absorbed[k];
        }
        if stack.single_pass {
            ledger.unaccounted = self.unaccounted;
        }
        ledger
    }
}
