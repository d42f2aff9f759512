//! Recycled light of every state and wavelength: its forms in the reflectances of the base, or the series
//! summed on the grid.

use std::f64::consts::PI;

use super::super::ledger::Sums;
use super::forms::Products;
use super::grid::Columns;
use super::narrow::{Light, Narrow};
use super::{Direction, Forms, Group, Profile, Recycling, Seen, Towards, azimuth_factor};
use crate::numerics::quadrature::Node;
use crate::{AngularTable, Base, Medium};

/// The base's part of recycled light; columns are `[state][wavelength]`.
#[derive(Debug, Clone, Default)]
pub(in super::super) struct Reflectances {
    grid: OnGrid,
    /// Under a narrow lobe.
    narrow: Option<Light>,
}

/// Reflectances of the base that the grid needs.
#[derive(Debug, Clone)]
enum OnGrid {
    /// For each order of the series.
    Products(Vec<Products>),
    /// At the nodes of the grid, `[glass][column]` and `[air][column]`.
    Nodes { glass: Vec<f64>, air: Vec<f64> },
}

impl Default for OnGrid {
    fn default() -> Self {
        Self::Products(Vec::new())
    }
}

impl Recycling {
    /// Computes the base's part of recycled light; it can be used under all fronts, and takes the least time
    /// under one that sends back the fraction `g` of each column.
    pub(in super::super) fn reflectances(
        &self,
        base: &Base,
        table: &AngularTable,
        medium: &Medium,
        g: &[f64],
    ) -> Reflectances {
        let columns = base.states() * base.bins();
        let look_up = |squares: &[f64]| {
            let mut all = vec![0.0; squares.len() * columns];
            for (row, square) in all.chunks_exact_mut(columns.max(1)).zip(squares) {
                base.reflectance(*square, medium, row);
            }
            all
        };
        let squares = |nodes: &[Node]| nodes.iter().map(|node| node.x * node.x).collect::<Vec<f64>>();
        let light = |narrow: &Narrow| {
            let of_radii = |radii: &[f64]| look_up(&radii.iter().map(|r| r * r).collect::<Vec<f64>>());
            let [glass, air] = narrow.radii().map(of_radii);
            let terms = narrow.squares().map(|squares| look_up(&squares)).collect();
            narrow.light(Columns { count: columns, glass: &glass, air: &air }, terms, g)
        };
        let narrow = self.narrow.as_ref().map(light);
        if self.sums_columns() {
            let glass = look_up(&squares(&self.grid.glass));
            let air = if self.grid.straight > 0.0 { look_up(&squares(&self.grid.air)) } else { Vec::new() };
            let grid = OnGrid::Nodes { glass, air };
            return Reflectances { grid, narrow };
        }
        let terms: Vec<&[f64]> = self.terms().collect();
        Reflectances { narrow, ..self.products(&table.weighted_sums(&terms), columns) }
    }

    /// Returns the products of these values of all [`terms`](Self::terms), `[term][column]`.
    pub(in super::super) fn products(&self, terms: &[f64], columns: usize) -> Reflectances {
        let mut rest = terms;
        let of = |(k, profile): (usize, &Profile)| {
            let own;
            (own, rest) = rest.split_at(profile.terms.len() * columns);
            Products::new(own.to_vec(), columns, k as u32 + 2)
        };
        let products = self.profiles.iter().enumerate().map(of).collect();
        Reflectances { grid: OnGrid::Products(products), narrow: None }
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
        let OnGrid::Products(products) = &r.grid else { return sum };
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
        let OnGrid::Products(products) = &r.grid else { return slopes };
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

    /// Adds the recycled light of a view's group under a narrow lobe. `sources`: for each source its groups
    /// as seen by the view, and their round trips; light towards them is that of the grid, and is replaced.
    pub(in super::super) fn add_narrow(
        &self,
        view: &Seen,
        sources: &[Vec<(Option<&Towards>, &Direction)>],
        r: &Reflectances,
        g: &[f64],
        sums: &mut Sums,
    ) {
        let (Some(light), Some(narrow)) = (&r.narrow, &self.narrow) else { return };
        let own = light.own(narrow, view, g);
        sums.leaving = own.leaving;
        sums.reflected = own.reflected;
        sums.arriving = own.arriving;
        for (groups, sum) in sources.iter().zip(&mut sums.directed) {
            let towards: Vec<_> = groups
                .iter()
                .filter_map(|(towards, own)| Some(((*towards)?, &own.round_trips[..])))
                .collect();
            if towards.is_empty() {
                continue;
            }
            let mut closed = light.between(view, &towards, g);
            // What is left of the grid's light is the error of the closed form under the wider lobe.
            for (source, round_trips) in &towards {
                if let Some(wider) = light.under_wider(view, source, g, !self.sums_columns()) {
                    add_times(sum, &wider, round_trips, -1.0);
                }
            }
            let all: Vec<&Towards> = towards.iter().map(|(source, _)| *source).collect();
            let correction = Towards::correction(&all);
            closed.iter_mut().zip(&*sum).for_each(|(closed, error)| *closed += correction * error);
            *sum = closed;
        }
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
        let OnGrid::Nodes { glass, air } = &r.grid else { return };
        let columns = Columns { count: g.len(), glass, air };
        let grid = &self.grid;
        for m in 0..self.plan.orders {
            let light =
                self.series(m, grid.scattered(&view.0.meridian, m, columns, &view.1.reflectance), columns, g);
            if m == 0 && !self.is_narrow() {
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

/// `sum += scale values * factors`; an empty slice of factors means ones.
pub(super) fn add_times(sum: &mut [f64], values: &[f64], factors: &[f64], scale: f64) {
    for (k, (sum, value)) in sum.iter_mut().zip(values).enumerate() {
        *sum += scale * value * factors.get(k).copied().unwrap_or(1.0);
    }
}

/// Largest number of passes for light that every pass returns almost completely.
const MOST_PASSES: usize = 4000;
