//! Recycled light of every state and wavelength: its forms in the base's reflectances, or the
//! series summed on the grid.

use std::f64::consts::PI;

use super::super::books::Sums;
use super::grid::Columns;
use super::{Direction, Forms, Group, OwnForms, Profile, Recycling, azimuth_factor};
use crate::{AngularTable, Base, Medium};

/// The base's reflectances that recycling needs, and g; columns are `[state][wavelength]`.
#[derive(Debug, Clone)]
pub(in super::super) struct Reflectances {
    /// `r T^2` of each column.
    g: Vec<f64>,
    at: At,
}

#[derive(Debug, Clone)]
enum At {
    /// For each order of the series, `[term][column]`.
    Terms(Vec<Vec<f64>>),
    /// At the grid's nodes, `[glass][column]` and `[air][column]`.
    Nodes { glass: Vec<f64>, air: Vec<f64> },
}

/// Columns worked on at a time.
const LANES: usize = 8;

impl Recycling {
    /// `sent_back` is `r T^2` per wavelength.
    pub(in super::super) fn reflectances(
        &self,
        base: &Base,
        table: &AngularTable,
        medium: &Medium,
        sent_back: &[f64],
    ) -> Reflectances {
        let columns = base.states() * base.bins();
        let g = sent_back.iter().copied().cycle().take(columns).collect();
        let look_up = |squares: &mut dyn Iterator<Item = f64>| {
            let mut all = Vec::new();
            for square in squares {
                let start = all.len();
                all.resize(start + columns, 0.0);
                base.reflectance(square, medium, &mut all[start..]);
            }
            all
        };
        let at = if self.sums_columns() {
            let glass = look_up(&mut self.grid.glass.iter().map(|n| n.x * n.x));
            let straight = self.grid.straight > 0.0;
            let air = self.grid.air.iter().filter(|_| straight);
            At::Nodes { glass, air: look_up(&mut air.map(|n| n.x * n.x)) }
        } else {
            let of = |profile: &Profile| {
                let mut all = vec![0.0; profile.terms.len() * columns];
                for (term, values) in profile.terms.iter().zip(all.chunks_exact_mut(columns)) {
                    table.weighted_sum(&term.0, values);
                }
                all
            };
            At::Terms(self.profiles.iter().map(of).collect())
        };
        Reflectances { g, at }
    }

    /// Whether the series is summed column by column.
    pub(in super::super) fn sums_columns(&self) -> bool {
        self.plan.terms.is_empty()
    }

    /// Adds a view's own recycled light by its forms.
    pub(in super::super) fn add_alone(&self, forms: &OwnForms, r: &Reflectances, sums: &mut Sums) {
        self.add(&forms.leaving, r, false, &mut sums.leaving);
        self.add(&forms.reflected, r, false, &mut sums.reflected);
        self.add(&forms.arriving, r, true, &mut sums.arriving);
    }

    /// Adds the value of forms, `one_less` than the order in degree or not.
    pub(in super::super) fn add(&self, forms: &Forms, r: &Reflectances, one_less: bool, out: &mut [f64]) {
        let At::Terms(values) = &r.at else { return };
        for (k, ((form, values), profile)) in forms.0.iter().zip(values).zip(&self.profiles).enumerate() {
            let degree = if one_less { k + 1 } else { k + 2 };
            let value = Form { coefficients: form, terms: profile.cosines.len(), degree };
            for (block, out) in out.chunks_mut(LANES).enumerate() {
                let start = block * LANES;
                let sum = value.evaluate(values, r.g.len(), start, out.len());
                for ((o, sum), g) in out.iter_mut().zip(sum).zip(&r.g[start..]) {
                    *o += g.powi(k as i32 + 1) * sum;
                }
            }
        }
    }

    /// Adds the recycled light of a view's group by summing the series on the grid.
    pub(in super::super) fn add_by_columns(
        &self,
        view: (&Group, &Direction),
        sources: &[Vec<(&Group, &Direction)>],
        r: &Reflectances,
        sums: &mut Sums,
    ) {
        let At::Nodes { glass, air } = &r.at else { return };
        let columns = Columns { count: r.g.len(), glass, air };
        let grid = &self.grid;
        for m in 0..self.plan.orders {
            let light = self.series(
                m,
                grid.scattered(&view.0.meridian, m, columns, &view.1.reflectance),
                columns,
                &r.g,
            );
            if m == 0 {
                let ones = |n: usize| vec![1.0; n];
                let leaving = grid.diffuse(columns, &grid.leaving, &grid.leaving_straight);
                let reflected = grid.diffuse(columns, &ones(grid.glass.len()), &ones(grid.air.len()));
                let spread = |share: &f64| std::iter::repeat_n(*share, columns.count);
                let arriving: Vec<f64> = grid.arriving.iter().flat_map(spread).collect();
                self.add_products(&light, &leaving, &r.g, 1.0, &mut sums.leaving);
                self.add_products(&light, &reflected, &r.g, 1.0, &mut sums.reflected);
                self.add_products(&light, &arriving, &r.g, 1.0, &mut sums.arriving);
            }
            for (groups, sum) in sources.iter().zip(&mut sums.directed) {
                for (group, own) in groups {
                    let turn = group.meridian.azimuth - view.0.meridian.azimuth;
                    let scattered = grid.scattered(&group.meridian, m, columns, &own.reflectance);
                    let mut g = r.g.clone();
                    g.iter_mut().zip(&own.round_trips).for_each(|(g, t)| *g *= t);
                    self.add_products(&light, &scattered, &g, PI * azimuth_factor(m, turn), sum);
                }
            }
        }
    }

    /// The sum of `(g P)^j light` over all j.
    fn series(&self, order: usize, light: Vec<f64>, r: Columns<'_>, g: &[f64]) -> Vec<f64> {
        let largest = |light: &[f64]| light.iter().fold(0.0_f64, |most, l| most.max(l.abs()));
        let least = largest(&light) * (-self.plan.digits).exp();
        let (mut sum, mut term) = (light.clone(), light);
        for _ in 0..MOST_PASSES {
            term = self.grid.pass(order, &term, r, true);
            for row in term.chunks_exact_mut(g.len()) {
                row.iter_mut().zip(g).for_each(|(t, g)| *t *= g);
            }
            sum.iter_mut().zip(&term).for_each(|(s, t)| *s += t);
            if largest(&term) <= least {
                break;
            }
        }
        sum
    }

    /// `sum += scale g` times the integral of light times other, column by column.
    fn add_products(&self, light: &[f64], other: &[f64], g: &[f64], scale: f64, sum: &mut [f64]) {
        let rows = light.chunks_exact(g.len()).zip(other.chunks_exact(g.len()));
        for (node, (light, other)) in self.grid.air.iter().zip(rows) {
            for (((s, l), o), g) in sum.iter_mut().zip(light).zip(other).zip(g) {
                *s += scale * node.weight * g * l * o;
            }
        }
    }
}

/// Light that every pass returns almost whole is followed this far.
const MOST_PASSES: usize = 4000;

/// A homogeneous polynomial in the reflectances at `terms` cosines.
struct Form<'a> {
    coefficients: &'a [f64],
    terms: usize,
    degree: usize,
}

impl Form<'_> {
    /// Its values for `count` columns from `start` on; `values` has shape `[term][column]`.
    fn evaluate(&self, values: &[f64], columns: usize, start: usize, count: usize) -> [f64; LANES] {
        let mut c = vec![[0.0; LANES]; self.terms];
        for (p, c) in c.iter_mut().enumerate() {
            c[..count].copy_from_slice(&values[p * columns + start..][..count]);
        }
        self.sum(self.coefficients, self.degree, &c)
    }

    fn sum(&self, coefficients: &[f64], degree: usize, c: &[[f64; LANES]]) -> [f64; LANES] {
        let mut sum = [0.0; LANES];
        if degree == 1 {
            for (q, c) in coefficients.iter().zip(c) {
                for (s, c) in sum.iter_mut().zip(c) {
                    *s += q * c;
                }
            }
            return sum;
        }
        for (part, first) in coefficients.chunks_exact(coefficients.len() / self.terms).zip(c) {
            let rest = self.sum(part, degree - 1, c);
            for ((s, rest), first) in sum.iter_mut().zip(rest).zip(first) {
                *s += rest * first;
            }
        }
        sum
    }
}
