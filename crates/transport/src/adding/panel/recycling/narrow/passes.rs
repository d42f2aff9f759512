//! Light between a view and a source that meets the base two or three times, under a narrow lobe.
//!
//! With S one pass in which light is scattered ([`OnePass`]) and `d = s² R` one in which it is not, two
//! passes are the integral of `S(v, a) S(a, l)` over the disc of air, and three that of `S(v, a) N(a, l)`,
//! where N is d S or two passes. Each is the product of two lobes, around v and around l, and a smooth
//! function ([`Between`]). The reflectance is a sum of terms, so that it is a form of degree 2 or 3 in these.
//!
//! Divided by the lobe of all its passes, such light is itself smooth: it differs from the closed form
//! ([`super`]) by the order of b, and around the rim, over a distance of b, by what is lost there. The
//! difference is interpolated between a few directions, for the third pass and for fields. Between two
//! directions near the rim it also changes with the azimuth between them, over a distance of b: for the third
//! pass, azimuths are stretched as radii are ([`Azimuths`]). Fields have few orders of azimuth instead.

use std::f64::consts::{FRAC_PI_2, PI};

use papilio_optics::{Beta, with_widest_simd};

use super::super::forms::Places;
use super::super::plan::ExactPlan;
use super::super::profile::chebyshev;
use super::basis::{Basis, Disc};
use super::between::{Between, density};
use super::one_pass::{End, Here, OnePass, add_padded, cosine_between};
use super::polynomials::Polynomials;
use super::shares;
use crate::adding::panel::first_pass::Pass;
use crate::adding::panel::lobes::LANES;
use crate::light::cone_points::Point;
use crate::numerics::quadrature::Pole;

/// Two or three passes through the panel, in terms of the reflectance.
#[derive(Debug, Clone)]
pub(super) struct Passes {
    pub(super) once: OnePass,
    /// Number of passes.
    pub(super) count: usize,
    pub(super) digits: f64,
    /// For two passes, and for three, the fractions of light that meets 0, 1, ... lobes.
    shares: Vec<Vec<f64>>,
    /// |beta| between which differences from the closed form are interpolated, and azimuths: of the third pass,
    /// and cosines for fields.
    pub(super) rings: Basis,
    azimuths: Azimuths,
    pub(super) turns: Polynomials,
    /// Products of terms.
    places: Places,
}

/// Azimuths between which even functions are interpolated that change over a distance of the lobe's width, on
/// the rim, around azimuth 0: polynomials in u², where the distance is `width sinh u`.
#[derive(Debug, Clone)]
struct Azimuths {
    width: f64,
    polynomials: Polynomials,
    cosines: Vec<f64>,
}

impl Azimuths {
    fn new(width: f64, digits: f64) -> Self {
        let end = (2.0 / width).asinh();
        // Half of the nodes of an interval about azimuth 0, with the pole of the lobe.
        let each = 2.0 * Pole { at: 0.0, off: FRAC_PI_2 }.ellipse(-end, end).ln();
        let count = (digits / each).ceil() as usize + MORE_AZIMUTHS;
        let node = |k: usize| end * (FRAC_PI_2 * (k as f64 + 0.5) / count as f64).cos();
        let cosine = |k: usize| 1.0 - 0.5 * (width * node(k).sinh()).powi(2);
        Self {
            width,
            polynomials: Polynomials::new((0..count).map(|k| node(k) * node(k)).collect()),
            cosines: (0..count).map(cosine).collect(),
        }
    }

    fn len(&self) -> usize {
        self.cosines.len()
    }

    /// Computes the polynomials at the azimuth of this cosine.
    #[inline(always)]
    fn at(&self, cosine: f64, out: &mut [f64]) {
        let u = ((2.0 - 2.0 * cosine).max(0.0).sqrt() / self.width).asinh();
        self.polynomials.at(u * u, out);
    }
}

/// What arrives on the way from one of the ends.
enum Far<'a> {
    /// After one pass.
    Once(&'a End),
    /// After two passes.
    Twice(&'a Around),
}

/// Two passes between an end and all directions.
struct Around {
    end: End,
    /// Differences from the closed form, `[|a|][azimuth][sequence of terms]`.
    differences: Vec<f64>,
}

/// Directions close together: all factors but the lobe are computed for their centre.
#[derive(Debug, Clone)]
pub(super) struct Cluster {
    pub(super) centre: Beta,
    /// Numbers of the group and the point.
    pub(super) members: Vec<(usize, usize)>,
}

impl Passes {
    /// Prepares this number of passes.
    pub(super) fn new(pass: &Pass<'_>, width: f64, count: usize, plan: ExactPlan) -> Self {
        let digits_between = DIGITS_OF_DIFFERENCES * plan.digits;
        let turns = (digits_between / DIGITS_A_TURN).ceil() as usize + 2;
        Self {
            once: OnePass::new(pass, width, plan.digits, plan.terms),
            count,
            digits: plan.digits,
            shares: shares(pass.straight(), 2),
            rings: Basis::new(Disc::Air, width, digits_between, MORE_RINGS),
            azimuths: Azimuths::new(width, digits_between),
            turns: Polynomials::new(chebyshev(turns).iter().map(|node| 2.0 * node.x - 1.0).collect()),
            places: Places::new(plan.terms, count as u32),
        }
    }

    /// Returns the lobes of this number of passes: their fraction and width.
    pub(super) fn lobes(&self, count: usize) -> impl Iterator<Item = (f64, f64)> {
        let all = self.shares[count - 2].iter().enumerate().skip(1);
        all.filter(|(_, share)| **share > 0.0).map(move |(n, share)| (*share, n as f64 * self.once.width))
    }

    /// Returns the kernel of this number of passes over a uniform base without rims.
    pub(super) fn lobe(&self, count: usize, away: Beta) -> f64 {
        self.lobes(count).map(|(share, width)| share * density(width, away)).sum()
    }

    /// Returns the number of sequences of terms of this number of passes.
    pub(super) fn sequences(&self, count: usize) -> usize {
        self.once.terms().pow(count as u32)
    }

    /// Returns a coefficient for each product of terms, from those of each sequence.
    pub(super) fn folded(&self, sequences: &[f64]) -> Vec<f64> {
        self.places.folded(sequences)
    }

    /// Returns two passes between an end and all directions.
    fn around(&self, end: &End) -> Around {
        let mut there = end.clone();
        there.at = Beta { x: end.at.length(), y: 0.0 };
        let azimuths = &self.azimuths.cosines;
        let differences = self.between_rings((2, azimuths), |one| self.form(one, &Far::Once(&there)), &there);
        Around { end: end.clone(), differences }
    }

    /// Returns the difference from the closed form of all passes between a direction of azimuth 0 and all
    /// directions.
    pub(super) fn differences_around(&self, end: &End) -> Vec<f64> {
        if self.count == 2 {
            return self.between_rings((2, self.turns.nodes()), |one| self.form(one, &Far::Once(end)), end);
        }
        let around = self.around(end);
        self.between_rings((3, self.turns.nodes()), |one| self.form(one, &Far::Twice(&around)), end)
    }

    /// Returns the difference from the closed form of passes between `end` and a direction, at all rings and
    /// azimuths of these cosines.
    fn between_rings(
        &self,
        (count, cosines): (usize, &[f64]),
        passes: impl Fn(&End) -> Vec<f64>,
        end: &End,
    ) -> Vec<f64> {
        let mut all = Vec::with_capacity(self.rings.len() * cosines.len() * self.sequences(count));
        for radius in &self.rings.radii {
            let mut one = self.once.end(Beta { x: *radius, y: 0.0 });
            for cos in cosines {
                one.at = Beta { x: radius * cos, y: radius * (1.0 - cos * cos).max(0.0).sqrt() };
                let mut form = passes(&one);
                let scale = 1.0 / self.lobe(count, one.at - end.at);
                form.iter_mut().for_each(|value| *value *= scale);
                add_closed(
                    count,
                    [&one.terms, &end.terms].map(|all| &all[..self.once.terms()]),
                    -1.0,
                    &mut form,
                );
                all.append(&mut form);
            }
        }
        all
    }

    /// Returns passes between a direction and light from the other end, a coefficient for each sequence of
    /// terms.
    fn form(&self, one: &End, far: &Far<'_>) -> Vec<f64> {
        let ways = [self.once.ways(), self.ways(far)];
        let narrowest = ways.iter().flatten().map(|(_, width)| *width).fold(f64::INFINITY, f64::min);
        let ends = [one.at, far.end().at];
        let rule = Between::new(ends, narrowest, 1.0, self.digits);
        let mut work = Workspace::new(self, far);
        with_widest_simd(
            #[inline(always)]
            || {
                for (at, area) in rule.inside() {
                    let mut densities = [[0.0; MOST_WAYS]; 2];
                    for ((densities, ways), end) in densities.iter_mut().zip(&ways).zip(ends) {
                        for (value, (share, width)) in densities.iter_mut().zip(ways) {
                            *value = share * density(*width, *at - end);
                        }
                    }
                    work.add(self, (one, far), (*at, *area), densities);
                }
                for (k, first) in ways[0].iter().enumerate() {
                    for (i, second) in ways[1].iter().enumerate() {
                        let mut densities = [[0.0; MOST_WAYS]; 2];
                        (densities[0][k], densities[1][i]) = (first.0, second.0);
                        for end in ends.into_iter().zip(rule.weights_at_ends([first.1, second.1])) {
                            work.add(self, (one, far), end, densities);
                        }
                    }
                }
                work.add_differences(far);
            },
        );
        work.into_form()
    }

    /// Returns the fractions and widths of the lobes around the other end: after two passes, first those of
    /// light scattered in both.
    fn ways(&self, far: &Far<'_>) -> Vec<(f64, f64)> {
        match far {
            Far::Once(_) => self.once.ways(),
            Far::Twice(_) => {
                let s = self.once.straight;
                let unscattered = self.once.ways().into_iter().map(|(share, width)| (s * s * share, width));
                self.lobes(2).chain(unscattered.filter(|(share, _)| *share > 0.0)).collect()
            }
        }
    }

    /// Returns `pi` times the difference from the closed form of all passes between groups of points of a
    /// view and of a source: for each group of the view and of the source a coefficient for each product of
    /// terms. Directions close together differ only by the lobe.
    pub(super) fn between(&self, views: &[&[Point]], sources: &[&[Point]]) -> Vec<Vec<Vec<f64>>> {
        let [of_view, of_source] = [views, sources].map(|groups| clusters(groups, self.digits));
        let mut all = vec![vec![vec![0.0; self.places.count()]; sources.len()]; views.len()];
        let ends: Vec<End> = of_view.iter().map(|cluster| self.once.end(cluster.centre)).collect();
        for far in &of_source {
            let end = self.once.end(far.centre);
            let around = (self.count > 2).then(|| self.around(&end));
            let other = around.as_ref().map_or(Far::Once(&end), Far::Twice);
            for (near, end) in of_view.iter().zip(&ends) {
                let mut form = self.form(end, &other);
                let lobe = self.lobe(self.count, far.centre - near.centre);
                let terms = [&end.terms, &other.end().terms].map(|all| &all[..self.once.terms()]);
                add_closed(self.count, terms, -lobe, &mut form);
                let (form, scale) = (self.folded(&form), PI / lobe);
                for (view, v) in &near.members {
                    for (source, l) in &far.members {
                        let (v, l) = (&views[*view][*v], &sources[*source][*l]);
                        let weight = scale * v.weight * l.weight * self.lobe(self.count, l.beta - v.beta);
                        let sum = &mut all[*view][*source];
                        sum.iter_mut().zip(&form).for_each(|(sum, value)| *sum += weight * value);
                    }
                }
            }
        }
        all
    }
}

/// Adds the closed form of two or three passes between directions with these terms, for each sequence of
/// terms.
#[inline(always)]
pub(super) fn add_closed(count: usize, [one, other]: [&[f64]; 2], scale: f64, out: &mut [f64]) {
    let terms = one.len();
    if count == 2 {
        for (i, row) in out.chunks_exact_mut(terms).enumerate() {
            let first = 0.25 * scale * (one[i] + other[i]);
            for ((out, one), other) in row.iter_mut().zip(one).zip(other) {
                *out += first * (one + other);
            }
        }
        return;
    }
    for (i, plane) in out.chunks_exact_mut(terms * terms).enumerate() {
        for (j, row) in plane.chunks_exact_mut(terms).enumerate() {
            // (v v v + 2 v v l + 2 v l l + l l l) / 6.
            let of_one = scale / 6.0 * one[i] * one[j];
            let of_other = 2.0 * of_one + scale / 6.0 * (2.0 * one[i] + other[i]) * other[j];
            for ((out, one), other) in row.iter_mut().zip(one).zip(other) {
                *out += of_one * one + of_other * other;
            }
        }
    }
}

impl Far<'_> {
    fn end(&self) -> &End {
        match self {
            Self::Once(end) => end,
            Self::Twice(around) => &around.end,
        }
    }
}

/// Room for the light at one direction, and the sum of products.
struct Workspace {
    here: Here,
    rings: Vec<f64>,
    azimuths: Vec<f64>,
    /// Light of one pass, of the same without the last reflection, and from the other end; padded to a
    /// multiple of [`LANES`].
    near: Vec<f64>,
    once: Vec<f64>,
    far: Vec<f64>,
    /// Number of values of that light without padding.
    size: usize,
    /// `[near][far]`, with padding.
    form: Vec<f64>,
    /// Factors of the differences of two passes here, `[|a|][azimuth]`, and the sum of their products with
    /// the light of one pass, `[near][|a|][azimuth]`.
    factors: Vec<f64>,
    moments: Vec<f64>,
}

impl Workspace {
    fn new(of: &Passes, far: &Far<'_>) -> Self {
        let terms = of.once.terms();
        let (size, factors) = match far {
            Far::Once(_) => (terms, 0),
            Far::Twice(_) => (of.sequences(2), of.rings.len() * of.azimuths.len()),
        };
        Self {
            here: of.once.here(),
            rings: vec![0.0; of.rings.len()],
            azimuths: vec![0.0; of.azimuths.polynomials.padded_len()],
            near: vec![0.0; of.once.padded_terms()],
            once: vec![0.0; of.once.padded_terms()],
            far: vec![0.0; size.next_multiple_of(LANES)],
            size,
            form: vec![0.0; terms * size.next_multiple_of(LANES)],
            factors: vec![0.0; factors],
            moments: vec![0.0; terms * factors],
        }
    }

    /// Adds the product of the light of both ends at a direction, given its densities.
    #[inline(always)]
    fn add(
        &mut self,
        of: &Passes,
        (one, far): (&End, &Far<'_>),
        (at, weight): (Beta, f64),
        [near, densities]: [[f64; MOST_WAYS]; 2],
    ) {
        of.once.move_to(at, &mut self.here);
        self.near.fill(0.0);
        of.once.add_light(one, &mut self.here, [near[0], near[1]], &mut self.near);
        self.far.fill(0.0);
        match far {
            Far::Once(end) => {
                of.once.add_light(end, &mut self.here, [densities[0], densities[1]], &mut self.far);
            }
            Far::Twice(around) => self.add_twice(of, around, densities),
        }
        for (near, row) in self.near.iter().zip(self.form.chunks_exact_mut(self.far.len())) {
            add_padded(row, &self.far, weight * near);
        }
        if !self.factors.is_empty() {
            for (near, row) in self.near.iter().zip(self.moments.chunks_exact_mut(self.factors.len())) {
                let near = weight * near;
                row.iter_mut().zip(&self.factors).for_each(|(sum, factor)| *sum += near * factor);
            }
        }
    }

    /// Adds the differences of two passes from the closed form. They are interpolated linearly: their
    /// products with the moments of the light of one pass take much less than an interpolation at each
    /// direction.
    #[inline(always)]
    fn add_differences(&mut self, far: &Far<'_>) {
        if let Far::Twice(around) = far {
            let rows = self.form.chunks_exact_mut(self.far.len());
            for (row, moments) in rows.zip(self.moments.chunks_exact(self.factors.len())) {
                for (moment, differences) in moments.iter().zip(around.differences.chunks_exact(self.size)) {
                    row.iter_mut().zip(differences).for_each(|(sum, value)| *sum += moment * value);
                }
            }
        }
    }

    /// Returns the sum of products, without padding.
    fn into_form(self) -> Vec<f64> {
        let rows = self.form.chunks_exact(self.far.len());
        rows.flat_map(|row| &row[..self.size]).copied().collect()
    }

    /// Computes the light that arrives here after two passes, without its differences from the closed form,
    /// and the factors of these.
    #[inline(always)]
    fn add_twice(&mut self, of: &Passes, around: &Around, densities: [f64; MOST_WAYS]) {
        let lobes = of.lobes(2).count();
        let both: f64 = densities[..lobes].iter().sum();
        let terms = of.once.terms();
        let closed = [&self.here.terms, &around.end.terms].map(|all| &all[..terms]);
        add_closed(2, closed, both, &mut self.far[..terms * terms]);
        self.rings.fill(0.0);
        of.rings.add_values(self.here.at.length(), both, &mut self.rings);
        of.azimuths.at(cosine_between(self.here.at, around.end.at), &mut self.azimuths);
        for (ring, factors) in self.rings.iter().zip(self.factors.chunks_exact_mut(of.azimuths.len())) {
            factors.iter_mut().zip(&self.azimuths).for_each(|(factor, azimuth)| *factor = ring * azimuth);
        }
        if of.once.straight > 0.0 {
            self.once.fill(0.0);
            let scattered = [densities[lobes], densities[lobes + 1]];
            of.once.add_light(&around.end, &mut self.here, scattered, &mut self.once);
            let rows = self.far.chunks_exact_mut(terms);
            for (row, reflectance) in rows.zip(&self.here.terms[..terms]) {
                row.iter_mut().zip(&self.once).for_each(|(out, once)| *out += reflectance * once);
            }
        }
    }
}

/// Largest number of lobes around one end: two, three or four of two passes, and one or two of a single one.
const MOST_WAYS: usize = 5;

/// Collects points close together.
pub(super) fn clusters(groups: &[&[Point]], digits: f64) -> Vec<Cluster> {
    let size = LARGEST_CLUSTER * (-0.2 * digits).exp();
    let mut all: Vec<(Beta, Cluster)> = Vec::new();
    for (group, points) in groups.iter().enumerate() {
        for (number, point) in points.iter().enumerate() {
            let near = all.iter().position(|(first, _)| (*first - point.beta).length() < size);
            let place = near.unwrap_or_else(|| {
                all.push((point.beta, Cluster { centre: Beta::default(), members: Vec::new() }));
                all.len() - 1
            });
            all[place].1.members.push((group, number));
        }
    }
    let with_centre = |(_, mut cluster): (Beta, Cluster)| {
        let scale = 1.0 / cluster.members.len() as f64;
        for (group, number) in &cluster.members {
            let beta = groups[*group][*number].beta;
            cluster.centre =
                Beta { x: cluster.centre.x + scale * beta.x, y: cluster.centre.y + scale * beta.y };
        }
        cluster
    };
    all.into_iter().map(with_centre).collect()
}

/// Size of a cluster at no digits.
const LARGEST_CLUSTER: f64 = 0.5;

/// Natural digits of the interpolation of differences from the closed form, which are small, as a fraction of
/// those of all light; rings in addition to those that the rim requires, and digits for each azimuth.
const DIGITS_OF_DIFFERENCES: f64 = 0.6;
const MORE_RINGS: usize = 2;
const DIGITS_A_TURN: f64 = 1.5;
/// Azimuths of the third pass in addition to those that the lobe requires.
const MORE_AZIMUTHS: usize = 1;
