//! Grid on which recycled light is followed, and one pass through the panel on it.
//!
//! Directions in air and in the glass each have a rule over the radius; azimuth is represented by Fourier
//! orders. With `L` the lobe between the two rules, one pass of light above the diffuser is
//! `s^2 R + s(1-s)(R l + l R) + (1-s)^2 L^T R L`: a diagonal, single and double scattering.

use std::f64::consts::FRAC_PI_2;

use papilio_optics::lobe::Lobe;
use pulp::{Arch, Simd, WithSimd};

use super::super::add_scaled;
use super::super::first_pass::Pass;
use super::super::lobes;
use super::super::projected::Circle;
use crate::Nodes;
use crate::light::cone_points::Point;
use crate::numerics::product::{add_product, add_transposed_product};
use crate::numerics::quadrature::{Node, Pole, gauss, graded};

/// Largest number of points of one panel.
const PANEL: usize = 36;

#[derive(Debug, Clone)]
pub(super) struct Grid {
    lobe: Lobe,
    pub(super) straight: f64,
    /// Number of azimuthal orders 0, 1, ...
    pub(super) orders: usize,
    /// Rules over the radius in air and in the glass.
    pub(super) air: Vec<Node>,
    pub(super) glass: Vec<Node>,
    /// The lobe, `[order][air][glass]`, and, if the diffuser has regular transmittance, between directions
    /// in air.
    between: Vec<f64>,
    within: Vec<f64>,
    /// Fraction of light at the underside of the diffuser that leaves, at the nodes of the glass, and
    /// fraction of light above it that reaches the base, at the nodes of air; `leaving_straight` is
    /// `leaving` at the nodes of air.
    pub(super) leaving: Vec<f64>,
    pub(super) leaving_straight: Vec<f64>,
    pub(super) arriving: Vec<f64>,
}

/// Lobes of a group of directions with the same fraction of unscattered light, symmetric about an azimuth.
#[derive(Debug, Clone)]
pub(super) struct Meridian {
    /// `[order][glass]`, and `[order][air]` if the diffuser has regular transmittance.
    glass: Vec<f64>,
    air: Vec<f64>,
}

/// Reflectance of the base where the grid needs it, in any number of columns: at the nodes
/// (`[glass][column]`, `[air][column]`).
#[derive(Debug, Clone, Copy)]
pub(super) struct Columns<'a> {
    pub(super) count: usize,
    pub(super) glass: &'a [f64],
    pub(super) air: &'a [f64],
}

/// Light that is multiplied by other light, in each azimuthal order.
#[derive(Debug, Clone, Default)]
pub(super) struct End {
    width: usize,
    /// At the nodes of the glass, `[order][width][glass]`.
    glass: Vec<f64>,
    /// If the diffuser has regular transmittance: `[order][width][air]`, and the same after one lobe within
    /// air.
    air: Vec<f64>,
    across: Vec<f64>,
}

impl Meridian {
    pub(super) fn numbers(&self) -> usize {
        self.glass.len() + self.air.len()
    }
}

impl End {
    pub(super) fn numbers(&self) -> usize {
        self.glass.len() + self.air.len() + self.across.len()
    }
}

impl Grid {
    /// Builds the grid; `terms`: number of terms of the polynomials that the grid has to distinguish;
    /// `None`: it resolves the table itself.
    pub(super) fn new(pass: &Pass<'_>, lobe: Lobe, orders: usize, digits: f64, terms: usize) -> Self {
        let straight = pass.straight();
        let (resolved, least) = (terms == 0, if terms > 1 { terms + 3 } else { 0 });
        let width = match lobe {
            Lobe::KCorrelation { width } => width,
            Lobe::Lambertian => 1.0,
        };
        let doubled = if straight > 0.0 { width } else { 2.0 * width };
        let air = disc(even(0.0, FRAC_PI_2, doubled, digits, least), 1.0);
        let rim = (1.0 / pass.index).min(1.0).asin();
        let mut angles = Vec::new();
        let mut from = 0.0;
        let breaks = if resolved && width > NARROW { table_breaks(pass) } else { kinks(pass) };
        for to in breaks.iter().copied().filter(|x| *x < rim).chain([rim]).filter(|x| *x > 0.0) {
            let off = if resolved { SMOOTH_OFF * (to - from) } else { f64::INFINITY };
            angles.extend(even(from, to, off.min(width / pass.index), digits, least));
            from = to;
        }
        if rim < FRAC_PI_2 && lobe != Lobe::Lambertian {
            // Wide lobes leave few panels here; at 3.6 digits per point, half as many points each.
            let enough = if width > NARROW { 1.8 * least as f64 } else { 0.0 };
            let poles = [1.0, -1.0].map(|at| Pole { at, off: width }.in_arc(pass.index));
            angles.extend(graded(rim, FRAC_PI_2, &breaks, &poles, digits.max(enough)));
        }
        let glass = disc(angles, pass.index);
        let table = |rows: &[Node], columns: &[Node]| {
            let mut all = vec![0.0; orders * rows.len() * columns.len()];
            for (k, row) in rows.iter().enumerate() {
                lobes::orders_of_nodes(lobe, row.x, columns, orders, |m, first, values| {
                    let start = (m * rows.len() + k) * columns.len() + first;
                    all[start..][..values.len()].copy_from_slice(values);
                });
            }
            all
        };
        let between = table(&air, &glass);
        let within = if straight > 0.0 { table(&air, &air) } else { Vec::new() };
        let (leaving, leaving_straight) = (pass.shares_leaving(&glass), pass.shares_leaving(&air));
        let reaching = |node: &Node| straight + (1.0 - straight) * lobe.fraction_in_disc(node.x, pass.index);
        let arriving = air.iter().map(reaching).collect();
        Self { lobe, straight, orders, air, glass, between, within, leaving, leaving_straight, arriving }
    }

    /// Returns the lobes of a group of points that is symmetric about `azimuth`.
    pub(super) fn meridian(&self, points: &[Point], azimuth: f64) -> Meridian {
        self.meridian_of_circles(&Circle::of_points(points, azimuth, self.orders))
    }

    /// Returns the lobes of light on circles about the normal, symmetric about azimuth 0: of equal light on
    /// both sides by its integrals times `cos m phi`, of opposite light by those times `sin m phi`.
    pub(super) fn meridian_of_circles(&self, circles: &[Circle]) -> Meridian {
        let lobes_at = |nodes: &[Node]| {
            let mut sum = vec![0.0; self.orders * nodes.len()];
            for circle in circles {
                let count = self.orders.min(circle.orders.len());
                lobes::orders_of_nodes(self.lobe, circle.radius, nodes, count, |m, first, values| {
                    add_scaled(&mut sum[m * nodes.len() + first..], values, circle.orders[m]);
                });
            }
            sum
        };
        let air = if self.straight > 0.0 { lobes_at(&self.air) } else { Vec::new() };
        Meridian { glass: lobes_at(&self.glass), air }
    }

    /// Returns the light of a group after one pass in which it was scattered, at the nodes of air; `own` is
    /// the reflectance of the base in the direction of the group.
    pub(super) fn scattered(&self, group: &Meridian, order: usize, r: Columns<'_>, own: &[f64]) -> Vec<f64> {
        let (n, s) = (r.count, self.straight);
        let glass = &group.glass[order * self.glass.len()..][..self.glass.len()];
        let mut below = r.glass.to_vec();
        for ((row, node), lobe) in below.chunks_exact_mut(n).zip(&self.glass).zip(glass) {
            let weight = (1.0 - s).powi(2) * node.weight * lobe;
            row.iter_mut().for_each(|value| *value *= weight);
        }
        let mut light = self.lower(order, &below, n);
        if s > 0.0 {
            let air = &group.air[order * self.air.len()..][..self.air.len()];
            for ((light, lobe), r) in light.chunks_exact_mut(n).zip(air).zip(r.air.chunks_exact(n)) {
                let once = s * (1.0 - s) * lobe;
                light.iter_mut().zip(r).zip(own).for_each(|((l, r), own)| *l += once * (r + own));
            }
        }
        light
    }

    /// Transmits light at the nodes of air (`[air][width]`) through one pass, for each column of the
    /// reflectance: shape `[air][width][column]`; if `paired`, column by column.
    pub(super) fn pass(&self, order: usize, light: &[f64], r: Columns<'_>, paired: bool) -> Vec<f64> {
        let (s, width) = (self.straight, light.len() / self.air.len());
        let count = if paired { width } else { width * r.count };
        let lifted = self.lift(order, light, width);
        let mut below = vec![0.0; self.glass.len() * count];
        for (i, node) in self.glass.iter().enumerate() {
            let weight = (1.0 - s).powi(2) * node.weight;
            let r = &r.glass[i * r.count..][..r.count];
            times(&mut below[i * count..][..count], &lifted[i * width..][..width], r, weight, paired);
        }
        let mut out = self.lower(order, &below, count);
        if s > 0.0 {
            let across = self.across(order, light, width);
            let mut before = vec![0.0; self.air.len() * count];
            for k in 0..self.air.len() {
                let r = &r.air[k * r.count..][..r.count];
                let (light, across) = (&light[k * width..][..width], &across[k * width..][..width]);
                times(&mut out[k * count..][..count], light, r, s * s, paired);
                times(&mut out[k * count..][..count], across, r, s * (1.0 - s), paired);
                times(&mut before[k * count..][..count], light, r, s * (1.0 - s), paired);
            }
            let after = self.across(order, &before, count);
            out.iter_mut().zip(after).for_each(|(o, a)| *o += a);
        }
        out
    }

    /// Prepares light of this many orders to be multiplied by other light.
    pub(super) fn end(&self, air: Vec<f64>, orders: usize) -> End {
        let width = air.len() / (orders * self.air.len()).max(1);
        let each = |one: &dyn Fn(usize, &[f64]) -> Vec<f64>| {
            let lights = air.chunks_exact(self.air.len() * width).enumerate();
            lights.map(|(m, light)| one(m, light)).collect::<Vec<Vec<f64>>>().concat()
        };
        let glass = each(&|m, light| self.met_by(light, self.lobes_between(m), self.glass.len()));
        if self.straight == 0.0 {
            return End { width, glass, ..End::default() };
        }
        let count = self.air.len();
        // The lobes within air are the same in both directions.
        let across =
            each(&|m, light| self.met_by(light, &self.within[m * count * count..][..count * count], count));
        let air =
            each(&|_, light| (0..width).flat_map(|k| light.iter().skip(k).step_by(width).copied()).collect());
        End { width, glass, air, across }
    }

    /// Multiplies the light of a group, after one pass in which it was scattered, by other light, summed
    /// over orders with these factors: shape `[other][column]`. The reflectance is the same in all orders,
    /// so they are summed before it is applied; `own` is that of the direction of the group.
    pub(super) fn form_of_two(
        &self,
        group: &Meridian,
        own: &[f64],
        other: &End,
        factors: &[f64],
        r: Columns<'_>,
    ) -> Vec<f64> {
        let (s, width) = (self.straight, other.width);
        let mut form = vec![0.0; width * r.count];
        let meeting = |of: [&[f64]; 2], nodes: &[Node], share: f64| {
            let mut sum = vec![0.0; width * nodes.len()];
            Pairs { of, widths: [1, width], nodes, share, factors, sum: &mut sum }.add();
            sum
        };
        let sum = meeting([&group.glass, &other.glass], &self.glass, (1.0 - s).powi(2));
        add_product(&sum, r.glass, self.glass.len(), &mut form);
        if s > 0.0 {
            let sum = meeting([&group.air, &other.air], &self.air, s * (1.0 - s));
            add_product(&sum, r.air, self.air.len(), &mut form);
            for (form, sum) in form.chunks_exact_mut(r.count).zip(sum.chunks_exact(self.air.len())) {
                add_scaled(form, own, sum.iter().sum());
            }
        }
        form
    }

    /// Multiplies two lights, one of them after one further pass, summed over orders with these factors:
    /// shape `[one][other][column]`.
    pub(super) fn form(&self, one: &End, other: &End, factors: &[f64], r: Columns<'_>) -> Vec<f64> {
        let pairs = one.width * other.width;
        let (s, mut form) = (self.straight, vec![0.0; r.count * pairs]);
        let widths = [one.width, other.width];
        let scatter = |of: [&[f64]; 2], nodes: &[Node], share: f64, sum: &mut [f64]| {
            Pairs { of, widths, nodes, share, factors, sum }.add();
        };
        let mut sum = vec![0.0; self.glass.len() * pairs];
        scatter([&one.glass, &other.glass], &self.glass, (1.0 - s).powi(2), &mut sum);
        add_product(&sum, r.glass, self.glass.len(), &mut form);
        if s > 0.0 {
            let mut sum = vec![0.0; self.air.len() * pairs];
            scatter([&one.air, &other.air], &self.air, s * s, &mut sum);
            scatter([&one.across, &other.air], &self.air, s * (1.0 - s), &mut sum);
            scatter([&one.air, &other.across], &self.air, s * (1.0 - s), &mut sum);
            add_product(&sum, r.air, self.air.len(), &mut form);
        }
        form
    }

    /// Returns diffuse light (`[air][column]`) after one reflection by the base: of the light that arrives,
    /// the fractions `of_scattered` (at the nodes of the glass) and `of_straight` (at those of air).
    pub(super) fn diffuse(&self, r: Columns<'_>, of_scattered: &[f64], of_straight: &[f64]) -> Vec<f64> {
        let (n, s) = (r.count, self.straight);
        let mut below = r.glass.to_vec();
        for ((row, node), share) in below.chunks_exact_mut(n).zip(&self.glass).zip(of_scattered) {
            let weight = (1.0 - s) * node.weight * share;
            row.iter_mut().for_each(|value| *value *= weight);
        }
        let mut light = self.lower(0, &below, n);
        if s > 0.0 {
            for ((light, share), r) in light.chunks_exact_mut(n).zip(of_straight).zip(r.air.chunks_exact(n)) {
                add_scaled(light, r, s * share);
            }
        }
        light
    }

    /// Returns light at the nodes of air times their weights.
    fn weighted(&self, light: &[f64]) -> Vec<f64> {
        let mut light = light.to_vec();
        let width = light.len() / self.air.len();
        for (node, row) in self.air.iter().zip(light.chunks_exact_mut(width)) {
            row.iter_mut().for_each(|value| *value *= node.weight);
        }
        light
    }

    /// Returns light scattered once more, at the other end of these lobes (`[air][node]`): `[width][node]`.
    fn met_by(&self, light: &[f64], lobes: &[f64], nodes: usize) -> Vec<f64> {
        let mut out = vec![0.0; light.len() / self.air.len() * nodes];
        add_transposed_product(&self.weighted(light), lobes, self.air.len(), &mut out);
        out
    }

    /// Scatters from the nodes of air to those of the glass.
    fn lift(&self, order: usize, light: &[f64], width: usize) -> Vec<f64> {
        let mut out = vec![0.0; self.glass.len() * width];
        add_transposed_product(self.lobes_between(order), &self.weighted(light), self.air.len(), &mut out);
        out
    }

    /// Scatters from the nodes of the glass (weights included) to those of air.
    fn lower(&self, order: usize, below: &[f64], width: usize) -> Vec<f64> {
        let mut out = vec![0.0; self.air.len() * width];
        add_product(self.lobes_between(order), below, self.glass.len(), &mut out);
        out
    }

    /// Scatters once within air.
    fn across(&self, order: usize, light: &[f64], width: usize) -> Vec<f64> {
        let air = self.air.len();
        let mut out = vec![0.0; air * width];
        add_product(&self.within[order * air * air..][..air * air], &self.weighted(light), air, &mut out);
        out
    }

    fn lobes_between(&self, order: usize) -> &[f64] {
        let size = self.air.len() * self.glass.len();
        &self.between[order * size..][..size]
    }
}

/// Products of two lights at each node, summed over azimuthal orders.
struct Pairs<'a> {
    /// `[order][width][node]`.
    of: [&'a [f64]; 2],
    widths: [usize; 2],
    nodes: &'a [Node],
    share: f64,
    /// For each order.
    factors: &'a [f64],
    /// `[one][other][node]`.
    sum: &'a mut [f64],
}

impl Pairs<'_> {
    fn add(self) {
        Arch::new().dispatch(self);
    }
}

impl WithSimd for Pairs<'_> {
    type Output = ();

    // Plain loops, which the compiler vectorises: rows of nodes are long.
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { of: [one, other], widths: [left, right], nodes, share, factors, sum } = self;
        let count = nodes.len();
        let mut weighted = vec![0.0; count];
        for (m, factor) in factors.iter().enumerate().filter(|(_, factor)| **factor != 0.0) {
            let ones = one[m * left * count..][..left * count].chunks_exact(count);
            let others = &other[m * right * count..][..right * count];
            for (one, sums) in ones.zip(sum.chunks_exact_mut(right * count)) {
                for ((weighted, one), node) in weighted.iter_mut().zip(one).zip(nodes) {
                    *weighted = share * factor * node.weight * one;
                }
                for (sum, other) in sums.chunks_exact_mut(count).zip(others.chunks_exact(count)) {
                    for ((sum, one), other) in sum.iter_mut().zip(&weighted).zip(other) {
                        *sum += one * other;
                    }
                }
            }
        }
    }
}

/// `out += scale * light * r`, for all pairs or column by column.
#[inline]
fn times(out: &mut [f64], light: &[f64], r: &[f64], scale: f64, paired: bool) {
    if paired {
        for ((o, l), r) in out.iter_mut().zip(light).zip(r) {
            *o += scale * l * r;
        }
    } else {
        for (out, l) in out.chunks_exact_mut(r.len()).zip(light) {
            add_scaled(out, r, scale * l);
        }
    }
}

/// Returns the kinks of the base's table, as angles in the glass; if they are too many, none.
fn kinks(pass: &Pass<'_>) -> Vec<f64> {
    match pass.table {
        Nodes::AnglesInMedium(angles) if angles.len() <= MOST_KINKS => {
            angles.iter().copied().skip(1).collect()
        }
        Nodes::AnglesInAir(angles) if angles.len() <= MOST_KINKS => {
            angles.iter().skip(1).map(|angle| (angle.sin() / pass.index).min(1.0).asin()).collect()
        }
        _ => Vec::new(),
    }
}

const MOST_KINKS: usize = 24;

/// Returns the borders between which the table is smooth, as angles in the glass.
fn table_breaks(pass: &Pass<'_>) -> Vec<f64> {
    let angle = |radius: &f64| (radius / pass.index).min(1.0).asin();
    let mut angles: Vec<f64> = pass.table.breaks(pass.index).iter().map(angle).collect();
    angles.sort_by(f64::total_cmp);
    angles
}

/// Width up to which the grid of a lobe resolves the reflectance itself.
pub(super) const NARROW: f64 = 0.03;
/// Distance of a table's singularities, in units of the distance between breaks.
const SMOOTH_OFF: f64 = 1.0;

/// Returns a rule for integrands with poles at this distance everywhere, of at least `least` points.
fn even(from: f64, to: f64, off: f64, digits: f64, least: usize) -> Vec<Node> {
    let points = |panels: usize| {
        let half = 0.5 * (to - from) / panels as f64;
        (digits / (2.0 * (off / half).asinh())).ceil().max(2.0) as usize
    };
    let mut panels = 1;
    while points(panels) > PANEL {
        panels *= 2;
    }
    let step = (to - from) / panels as f64;
    let count = points(panels).max(least);
    (0..panels).flat_map(|k| gauss(from + k as f64 * step, from + (k + 1) as f64 * step, count)).collect()
}

/// Converts a rule in `x` of `|beta| = radius sin x` to one in the radius, with weights that include `2 pi
/// |beta|`.
fn disc(mut nodes: Vec<Node>, radius: f64) -> Vec<Node> {
    for node in &mut nodes {
        let (sin, cos) = node.x.sin_cos();
        node.x = radius * sin;
        node.weight *= 2.0 * std::f64::consts::PI * node.x * radius * cos;
    }
    nodes
}
