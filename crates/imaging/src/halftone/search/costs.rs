//! What a change of one pixel, or of two neighbours at once, adds to the error.

use super::Filter;
use super::filter::Correlation;

/// The neighbours with which a pixel changes at once; the other four find this pixel as their neighbour.
pub(super) const NEIGHBOURS: [(isize, isize); 4] = [(1, 0), (-1, 1), (0, 1), (1, 1)];

/// Largest number of states of which all pairs are tried; of more, those of the states that are best alone,
/// and the exchange.
const ALL_PAIRS: usize = 8;

/// A change of a pixel to a state, and of one of its neighbours to another.
#[derive(Debug, Clone, Copy)]
pub(super) struct Change {
    pub(super) state: u8,
    /// Number of the neighbour, and its state.
    pub(super) other: Option<(usize, u8)>,
}

/// The states and the correlations, prepared for the costs of changes.
pub(super) struct Costs<const N: usize> {
    pub(super) palette: Vec<[f64; N]>,
    pub(super) correlations: [Correlation; N],
    middles: [f64; N],
    /// For each neighbour and each pair of states: twice the sum of the products of their coordinates, each
    /// with the correlation there.
    near: [Vec<f64>; 4],
    /// A change must lower the error by this much, so that rounding cannot go in circles.
    least: f64,
}

/// Costs of all states at two pixels.
#[derive(Default)]
pub(super) struct Scratch {
    here: Vec<f64>,
    there: Vec<f64>,
    best_here: Vec<usize>,
    best_there: Vec<usize>,
}

impl<const N: usize> Costs<N> {
    pub(super) fn new(palette: &[[f64; N]], filters: &[Filter; N]) -> Self {
        let correlations = filters.each_ref().map(Filter::autocorrelation);
        let mut extent: f64 = 0.0;
        for (k, correlation) in correlations.iter().enumerate() {
            let along = palette.iter().map(|colour| colour[k]);
            let (low, high) = along.fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)));
            extent += (high - low).powi(2) * correlation.middle();
        }
        let near = NEIGHBOURS.map(|(right, down)| {
            let at = correlations.each_ref().map(|correlation| correlation.at(right, down));
            let product = |one: &[f64; N], other: &[f64; N]| {
                2.0 * (0..N).map(|k| at[k] * one[k] * other[k]).sum::<f64>()
            };
            palette.iter().flat_map(|one| palette.iter().map(move |other| product(one, other))).collect()
        });
        let middles = correlations.each_ref().map(Correlation::middle);
        Self { palette: palette.to_vec(), correlations, middles, near, least: 1e-9 * extent }
    }

    /// Rows and columns over which a change of a pixel is felt.
    pub(super) fn reach(&self) -> [usize; 2] {
        let largest = |k: usize| self.correlations.iter().map(|one| one.reach[k]).max().unwrap_or(0);
        [largest(0), largest(1)]
    }

    /// Costs of the states of a pixel in a state, where the correlated error is `r`.
    fn single(&self, own: usize, r: [f64; N], costs: &mut Vec<f64>) {
        let shown = self.palette[own];
        costs.clear();
        costs.extend(self.palette.iter().map(|colour| {
            (0..N)
                .map(|k| {
                    let d = colour[k] - shown[k];
                    d * (2.0 * r[k] + d * self.middles[k])
                })
                .sum::<f64>()
        }));
    }

    /// The change of a pixel, alone or with a neighbour, that lowers the error most, and by how much.
    /// `neighbours` have their states and correlated errors.
    pub(super) fn best(
        &self,
        own: u8,
        r: [f64; N],
        neighbours: [Option<(u8, [f64; N])>; 4],
        scratch: &mut Scratch,
    ) -> Option<(Change, f64)> {
        let Scratch { here, there, best_here, best_there } = scratch;
        let own = usize::from(own);
        let count = self.palette.len();
        let (mut best, mut most) = (None, self.least);
        self.single(own, r, here);
        for (state, cost) in here.iter().enumerate() {
            if -cost > most {
                (best, most) = (Some(Change { state: state as u8, other: None }), -cost);
            }
        }
        lowest(here, best_here);
        for (number, neighbour) in neighbours.into_iter().enumerate() {
            let Some((other, r)) = neighbour else { continue };
            let other = usize::from(other);
            self.single(other, r, there);
            lowest(there, best_there);
            // The costs of both, and the sum of c (state - own) (to - other) from its four products.
            let near = &self.near[number];
            let (apart, products) = (near[own * count + other], &near[own * count..][..count]);
            there.iter_mut().zip(products).for_each(|(cost, product)| *cost += apart - product);
            let mut consider = |state: usize, to: usize| {
                let row = &near[state * count..][..count];
                let gain = row[other] - here[state] - there[to] - row[to];
                if gain > most {
                    let change = Change { state: state as u8, other: Some((number, to as u8)) };
                    (best, most) = (Some(change), gain);
                }
            };
            for state in &*best_here {
                best_there.iter().for_each(|to| consider(*state, *to));
            }
            if count > ALL_PAIRS && own != other {
                consider(other, own);
            }
        }
        best.map(|change| (change, most))
    }
}

/// The states with the lowest costs, in their own order.
fn lowest(costs: &[f64], states: &mut Vec<usize>) {
    if costs.len() <= ALL_PAIRS && states.len() == costs.len() {
        return;
    }
    states.clear();
    states.extend(0..costs.len());
    if costs.len() > ALL_PAIRS {
        states.select_nth_unstable_by(ALL_PAIRS, |a, b| costs[*a].total_cmp(&costs[*b]).then(a.cmp(b)));
        states.truncate(ALL_PAIRS);
        states.sort_unstable();
    }
}
