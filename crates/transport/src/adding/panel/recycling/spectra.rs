//! Recycled light of every state and wavelength: its forms in the reflectances of the base, or the series
//! summed on the grid.

use std::f64::consts::PI;

use super::super::ledger::Sums;
use super::forms::Products;
use super::grid::Columns;
use super::{Direction, Forms, Group, Profile, Recycling, azimuth_factor};
use crate::{AngularTable, Base, Medium};

/// Reflectances of the base that recycling needs; columns are `[state][wavelength]`.
#[derive(Debug, Clone)]
pub(in super::super) enum Reflectances {
    /// For each order of the series.
    Products(Vec<Products>),
    /// At the nodes of the grid, `[glass][column]` and `[air][column]`.
    Nodes { glass: Vec<f64>, air: Vec<f64> },
}

impl Recycling {
    pub(in super::super) fn reflectances(
        &self,
        base: &Base,
        table: &AngularTable,
        medium: &Medium,
    ) -> Reflectances {
        let columns = base.states() * base.bins();
        let look_up = |squares: &mut dyn Iterator<Item = f64>| {
            let mut all = Vec::new();
            for square in squares {
                let start = all.len();
                all.resize(start + columns, 0.0);
                base.reflectance(square, medium, &mut all[start..]);
            }
            all
        };
        if self.sums_columns() {
            let glass = look_up(&mut self.grid.glass.iter().map(|n| n.x * n.x));
            let straight = self.grid.straight > 0.0;
            let air = self.grid.air.iter().filter(|_| straight);
            return Reflectances::Nodes { glass, air: look_up(&mut air.map(|n| n.x * n.x)) };
        }
        let of = |(k, profile): (usize, &Profile)| {
            let terms: Vec<&[f64]> = profile.terms.iter().map(|term| &term.0[..]).collect();
            Products::new(table.weighted_sums(&terms), columns, k as u32 + 2)
        };
        Reflectances::Products(self.profiles.iter().enumerate().map(of).collect())
    }

    /// Returns whether the series is summed column by column.
    pub(in super::super) fn sums_columns(&self) -> bool {
        self.plan.terms.is_empty()
    }

    /// Returns the values of forms, of the degree of the orders or of one less (`one_less`); `g` is `r T^2`
    /// of each column. Shape `[form][column]`.
    pub(in super::super) fn values(
        &self,
        forms: &[&Forms],
        one_less: bool,
        r: &Reflectances,
        g: &[f64],
    ) -> Vec<f64> {
        let mut sum = vec![0.0; forms.len() * g.len()];
        let Reflectances::Products(products) = r else { return sum };
        // Horner's rule in g.
        for (k, products) in products.iter().enumerate().rev() {
            let coefficients: Vec<&[f64]> = forms.iter().map(|forms| &forms.0[k][..]).collect();
            products.add((&coefficients.concat(), forms.len()), one_less, g.len(), &mut sum);
            for row in sum.chunks_exact_mut(g.len()) {
                row.iter_mut().zip(g).for_each(|(sum, g)| *sum *= g);
            }
        }
        sum
    }

    /// Returns the weights on table nodes of all terms, those of order 2 of the series first.
    pub(in super::super) fn terms(&self) -> impl Iterator<Item = &[f64]> {
        self.profiles.iter().flat_map(|profile| &profile.terms).map(|term| &term.0[..])
    }

    /// Returns the derivatives of sums of forms by each of these terms: shape `[sum][term][column]`.
    pub(in super::super) fn slopes(&self, sums: &[Vec<&Forms>], r: &Reflectances, g: &[f64]) -> Vec<f64> {
        let columns = g.len();
        let all: usize = self.profiles.iter().map(|profile| profile.cosines.len()).sum();
        let mut slopes = vec![0.0; sums.len() * all * columns];
        let Reflectances::Products(products) = r else { return slopes };
        let (mut first, mut power) = (0, g.to_vec());
        for (k, (products, profile)) in products.iter().zip(&self.profiles).enumerate() {
            let terms = profile.cosines.len();
            let forms: Vec<f64> = sums
                .iter()
                .flat_map(|forms| {
                    let mut sum = vec![0.0; forms.first().map_or(0, |one| one.0[k].len())];
                    forms.iter().for_each(|one| sum.iter_mut().zip(&one.0[k]).for_each(|(s, c)| *s += c));
                    profile.places[0].differentiated(&sum, &profile.places[1], terms, k as u32 + 2)
                })
                .collect();
            let mut found = vec![0.0; sums.len() * terms * columns];
            products.add((&forms, sums.len() * terms), true, columns, &mut found);
            for (sum, found) in found.chunks_exact(terms * columns).enumerate() {
                let out = &mut slopes[(sum * all + first) * columns..][..terms * columns];
                for (out, found) in out.chunks_exact_mut(columns).zip(found.chunks_exact(columns)) {
                    out.iter_mut().zip(found).zip(&power).for_each(|((out, value), g)| *out = value * g);
                }
            }
            first += terms;
            power.iter_mut().zip(g).for_each(|(power, g)| *power *= g);
        }
        slopes
    }

    /// Adds the recycled light of a view's group by summing the series on the grid.
    pub(in super::super) fn add_by_columns(
        &self,
        view: (&Group, &Direction),
        sources: &[Vec<(&Group, &Direction)>],
        r: &Reflectances,
        g: &[f64],
        sums: &mut Sums,
    ) {
        let Reflectances::Nodes { glass, air } = r else { return };
        let columns = Columns { count: g.len(), glass, air };
        let grid = &self.grid;
        for m in 0..self.plan.orders {
            let light =
                self.series(m, grid.scattered(&view.0.meridian, m, columns, &view.1.reflectance), columns, g);
            if m == 0 {
                let ones = |n: usize| vec![1.0; n];
                let leaving = grid.diffuse(columns, &grid.leaving, &grid.leaving_straight);
                let reflected = grid.diffuse(columns, &ones(grid.glass.len()), &ones(grid.air.len()));
                let spread = |share: &f64| std::iter::repeat_n(*share, columns.count);
                let arriving: Vec<f64> = grid.arriving.iter().flat_map(spread).collect();
                self.add_products(&light, &leaving, g, 1.0, &mut sums.leaving);
                self.add_products(&light, &reflected, g, 1.0, &mut sums.reflected);
                self.add_products(&light, &arriving, g, 1.0, &mut sums.arriving);
            }
            for (groups, sum) in sources.iter().zip(&mut sums.directed) {
                for (group, own) in groups {
                    let turn = group.azimuth - view.0.azimuth;
                    let scattered = grid.scattered(&group.meridian, m, columns, &own.reflectance);
                    let mut g = g.to_vec();
                    g.iter_mut().zip(&own.round_trips).for_each(|(g, t)| *g *= t);
                    self.add_products(&light, &scattered, &g, PI * azimuth_factor(m, turn, group.odd), sum);
                }
            }
        }
    }

    /// Returns the sum of `(g P)^j light` over all j.
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

/// Largest number of passes for light that every pass returns almost completely.
const MOST_PASSES: usize = 4000;
