//! What a change of one pixel, or of two neighbours at once, adds to the error.
//!
//! Numbers have single precision: the costs of up to [`LANES`] states are computed at once.

use super::Filter;
use super::filter::Correlation;

/// The neighbours with which a pixel changes at once; the other four find this pixel as their neighbour.
pub(super) const NEIGHBOURS: [(isize, isize); 4] = [(1, 0), (-1, 1), (0, 1), (1, 1)];

/// Numbers that are computed at once, and the largest number of states of which all pairs are tried; of more,
/// those of the states that are best alone, and the exchange.
pub(super) const LANES: usize = 8;

/// Columns and rows of the areas whose means are kept. In smaller ones, a change of a pixel is a large part of the sum,
/// which makes patterns uneven.
pub(super) const AREA: usize = 32;

/// Cost of a state that does not exist.
const IMPOSSIBLE: f32 = 1e30;

/// Part of the largest gain of a single change by which a change must lower the error, so that rounding cannot go
/// in circles.
const LEAST: f64 = 1e-5;

/// A change of a pixel to a state, and of one of its neighbours to another.
#[derive(Debug, Clone, Copy)]
pub(super) struct Change {
    pub(super) state: u8,
    /// Number of the neighbour, and its state.
    pub(super) other: Option<(usize, u8)>,
}

/// The states and the correlations, prepared for the costs of changes.
pub(super) struct Costs<const N: usize> {
    pub(super) palette: Vec<[f32; N]>,
    pub(super) correlations: [Correlation; N],
    middles: [f32; N],
    /// Whether pixels that take few states may take each.
    allowed: Vec<bool>,
    /// Weights of the squares of the sums of an area's errors.
    pub(super) of_areas: [f32; N],
    /// For neighbours in another area and in the same one, each neighbour and each pair of states: twice the sum of the
    /// products of their coordinates, each with the correlation there.
    near: [[Vec<f32>; 4]; 2],
    /// The same for up to [`LANES`] states.
    pub(super) lanes: Option<Lanes<N>>,
    pub(super) least: f32,
}

/// Costs of up to [`LANES`] states.
pub(super) struct Lanes<const N: usize> {
    /// Twice each coordinate of the states.
    doubled: [[f32; LANES]; N],
    /// For pixels that take all states and for those that take few, and each state of a pixel: the squares of the
    /// changes to the others, each with the middle of the correlation.
    squares: [[[f32; LANES]; LANES]; 2],
    near: [[[[f32; LANES]; LANES]; 4]; 2],
    /// The same by the state of the neighbour, and then that of the pixel.
    near_other: [[[[f32; LANES]; LANES]; 4]; 2],
}

/// Costs of all states at two pixels, of many states.
#[derive(Default)]
pub(super) struct Scratch {
    here: Vec<f32>,
    there: Vec<f32>,
    best_here: Vec<usize>,
    best_there: Vec<usize>,
}

/// A pixel: its state, its correlated error with what its area adds to it, whether it takes few states, and its area.
#[derive(Clone, Copy)]
pub(super) struct Here<const N: usize> {
    pub(super) own: u8,
    pub(super) r: [f32; N],
    pub(super) is_few: bool,
    /// Number of its area.
    pub(super) area: usize,
}

/// The neighbours of a pixel inside the picture.
pub(super) type Neighbours<const N: usize> = [Option<Here<N>>; 4];

/// A pixel by the costs of its states alone, of up to [`LANES`].
#[derive(Clone, Copy)]
pub(super) struct Alone {
    costs: [f32; LANES],
    own: u8,
    area: usize,
}

impl Alone {
    /// Of a pixel that cannot change.
    pub(super) const FIXED: Self = Self { costs: [IMPOSSIBLE; LANES], own: 0, area: usize::MAX };

    #[inline(always)]
    pub(super) fn is_fixed(&self) -> bool {
        self.area == usize::MAX
    }
}

impl<const N: usize> Costs<N> {
    pub(super) fn new(palette: &[[f64; N]], allowed: &[bool], filters: &[Filter; N]) -> Self {
        let correlations = filters.each_ref().map(Filter::autocorrelation);
        let mut extent: f64 = 0.0;
        for (k, correlation) in correlations.iter().enumerate() {
            let along = palette.iter().map(|colour| colour[k]);
            let (low, high) = along.fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)));
            extent += (high - low).powi(2) * correlation.middle();
        }
        let of_areas = filters.each_ref().map(|filter| filter.weight_of_area(AREA * AREA));
        let near_with = |of_areas: [f64; N], (right, down)| {
            let at: [f64; N] = std::array::from_fn(|k| correlations[k].at(right, down) + of_areas[k]);
            let product = |one: &[f64; N], other: &[f64; N]| {
                (2.0 * (0..N).map(|k| at[k] * one[k] * other[k]).sum::<f64>()) as f32
            };
            palette.iter().flat_map(|one| palette.iter().map(move |other| product(one, other))).collect()
        };
        let near = [[0.0; N], of_areas].map(|of_areas| NEIGHBOURS.map(|step| near_with(of_areas, step)));
        let middles = std::array::from_fn(|k| (correlations[k].middle() + of_areas[k]) as f32);
        let of_areas = of_areas.map(|weight| weight as f32);
        let palette: Vec<[f32; N]> = palette.iter().map(|colour| colour.map(|value| value as f32)).collect();
        let allowed: Vec<bool> = (0..palette.len()).map(|state| allowed.get(state) == Some(&true)).collect();
        let lanes = (palette.len() <= LANES).then(|| Lanes::new(&palette, &allowed, middles, &near));
        Self {
            palette,
            correlations,
            middles,
            allowed,
            of_areas,
            near,
            lanes,
            least: (LEAST * extent) as f32,
        }
    }

    /// Rows and columns over which a change of a pixel is felt.
    pub(super) fn reach(&self) -> [usize; 2] {
        let largest = |k: usize| self.correlations.iter().map(|one| one.reach[k]).max().unwrap_or(0);
        [largest(0), largest(1)]
    }

    /// Costs of the states of a pixel.
    fn single(&self, Here { own, r, is_few, .. }: Here<N>, costs: &mut Vec<f32>) {
        let shown = self.palette[usize::from(own)];
        costs.clear();
        costs.extend(self.palette.iter().zip(&self.allowed).map(|(colour, is_allowed)| {
            if is_few && !is_allowed {
                return IMPOSSIBLE;
            }
            (0..N)
                .map(|k| {
                    let d = colour[k] - shown[k];
                    d * (2.0 * r[k] + d * self.middles[k])
                })
                .sum::<f32>()
        }));
    }

    /// The change of a pixel, alone or with a neighbour, that lowers the error most, and by how much; of many states.
    #[inline(never)]
    pub(super) fn best_of_many(
        &self,
        pixel: Here<N>,
        neighbours: Neighbours<N>,
        scratch: &mut Scratch,
    ) -> Option<(Change, f32)> {
        let Scratch { here, there, best_here, best_there } = scratch;
        let own = usize::from(pixel.own);
        let count = self.palette.len();
        let (mut best, mut most) = (None, self.least);
        self.single(pixel, here);
        for (state, cost) in here.iter().enumerate() {
            if -cost > most {
                (best, most) = (Some(Change { state: state as u8, other: None }), -cost);
            }
        }
        lowest(here, best_here);
        for (number, neighbour) in neighbours.into_iter().enumerate() {
            let Some(neighbour) = neighbour else { continue };
            let other = usize::from(neighbour.own);
            self.single(neighbour, there);
            lowest(there, best_there);
            // The costs of both, and the sum of c (state - own) (to - other) from its four products.
            let near = &self.near[usize::from(neighbour.area == pixel.area)][number];
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
            if own != other {
                consider(other, own);
            }
        }
        best.map(|change| (change, most))
    }
}

impl<const N: usize> Lanes<N> {
    fn new(palette: &[[f32; N]], allowed: &[bool], middles: [f32; N], near: &[[Vec<f32>; 4]; 2]) -> Self {
        let lanes = |of: &dyn Fn(usize) -> f32, rest: f32| {
            std::array::from_fn(|at| if at < palette.len() { of(at) } else { rest })
        };
        let square = |one: &[f32; N], other: &[f32; N]| {
            (0..N).map(|k| (other[k] - one[k]) * (other[k] - one[k]) * middles[k]).sum::<f32>()
        };
        let count = palette.len();
        let table = |near: &[f32], of: &dyn Fn(usize, usize) -> usize| {
            let row = |state| lanes(&|at| if state < count { near[of(state, at)] } else { 0.0 }, 0.0);
            std::array::from_fn(row)
        };
        let tables = |of: &dyn Fn(usize, usize) -> usize| {
            near.each_ref().map(|near| near.each_ref().map(|near| table(near, of)))
        };
        Self {
            doubled: std::array::from_fn(|k| lanes(&|at| 2.0 * palette[at][k], 0.0)),
            squares: [false, true].map(|is_few| {
                let to = |own: &[f32; N], at: usize| match is_few && !allowed[at] {
                    true => IMPOSSIBLE,
                    false => square(own, &palette[at]),
                };
                let of = |own: usize| palette.get(own).map(|own| lanes(&|at| to(own, at), IMPOSSIBLE));
                std::array::from_fn(|own| of(own).unwrap_or([IMPOSSIBLE; LANES]))
            }),
            near: tables(&|state, at| state * count + at),
            near_other: tables(&|state, at| at * count + state),
        }
    }

    /// Costs of the states of a pixel.
    #[inline(always)]
    pub(super) fn alone(&self, Here { own, r, is_few, area }: Here<N>) -> Alone {
        let mut sums = [0.0; LANES];
        for (r, doubled) in r.iter().zip(&self.doubled) {
            for lane in 0..LANES {
                sums[lane] += r * doubled[lane];
            }
        }
        let own_lane = usize::from(own) % LANES;
        let (before, squares) = (sums[own_lane], &self.squares[usize::from(is_few)][own_lane]);
        Alone { costs: std::array::from_fn(|lane| sums[lane] - before + squares[lane]), own, area }
    }

    /// The change of a pixel, alone or with a neighbour, that lowers the error most, and by how much; `STATES` is the number of states, or
    /// more.
    #[inline(always)]
    pub(super) fn best<const STATES: usize>(
        &self,
        least: f32,
        pixel: Alone,
        [right, left_below, below, right_below]: [Alone; NEIGHBOURS.len()],
    ) -> Option<(Change, f32)> {
        let mut best = Best { change: None, cost: -least };
        if any_below(&pixel.costs, best.cost) {
            for (state, cost) in pixel.costs.into_iter().enumerate() {
                if cost < best.cost {
                    best = Best { change: Some(Change { state: state as u8, other: None }), cost };
                }
            }
        }
        // Without a loop, which would keep them in memory.
        self.try_both::<STATES, 0>(pixel, right, &mut best);
        self.try_both::<STATES, 1>(pixel, left_below, &mut best);
        self.try_both::<STATES, 2>(pixel, below, &mut best);
        self.try_both::<STATES, 3>(pixel, right_below, &mut best);
        best.change.map(|change| (change, -best.cost))
    }

    /// Tries the changes of a pixel together with its neighbour of this number.
    #[inline(always)]
    fn try_both<const STATES: usize, const NUMBER: usize>(
        &self,
        pixel: Alone,
        neighbour: Alone,
        best: &mut Best,
    ) {
        let same = usize::from(neighbour.area == pixel.area);
        let near = &self.near[same][NUMBER];
        let [own, other] = [pixel.own, neighbour.own].map(|state| usize::from(state) % LANES);
        // The costs of both, and the sum of c (state - own) (to - other) from its four products.
        let (from_own, from_other) = (&near[own], &self.near_other[same][NUMBER][other]);
        let apart = from_own[other];
        let [mut here, mut there] = [pixel.costs, neighbour.costs];
        for lane in 0..LANES {
            here[lane] -= from_other[lane];
            there[lane] += apart - from_own[lane];
        }
        let mut smallest = [IMPOSSIBLE; LANES];
        for state in 0..STATES {
            for to in 0..LANES {
                let cost = here[state] + near[state][to];
                smallest[to] = if cost < smallest[to] { cost } else { smallest[to] };
            }
        }
        for to in 0..LANES {
            smallest[to] += there[to];
        }
        if !any_below(&smallest, best.cost) {
            return;
        }
        for (to, cost) in smallest.into_iter().enumerate() {
            if cost < best.cost {
                let is_it = |state: &usize| here[*state] + near[*state][to] + there[to] == cost;
                let state = (0..STATES).find(is_it).unwrap_or(own) as u8;
                *best = Best { change: Some(Change { state, other: Some((NUMBER, to as u8)) }), cost };
            }
        }
    }
}

/// The best change so far, and its cost.
struct Best {
    change: Option<Change>,
    cost: f32,
}

/// Whether one of the costs is below a limit: mostly none is, which vectors find out at once.
#[inline(always)]
fn any_below(costs: &[f32; LANES], limit: f32) -> bool {
    costs.iter().fold(false, |any, cost| any | (*cost < limit))
}

/// The states with the lowest costs, in their own order.
fn lowest(costs: &[f32], states: &mut Vec<usize>) {
    states.clear();
    states.extend(0..costs.len());
    states.select_nth_unstable_by(LANES, |a, b| costs[*a].total_cmp(&costs[*b]).then(a.cmp(b)));
    states.truncate(LANES);
    states.sort_unstable();
}
