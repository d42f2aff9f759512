//! The stack with its base: light that a view sees via the pixel.
//!
//! The light that falls from the last scatterer on the flat layers and the base below it obeys
//! `x = t + G B x`: t is transmitted light, B the reflectance below, G the light that the layers above send
//! back down. B differs by state and wavelength and is a factor for each direction ([`reflections`]).

mod block;
mod reflections;

use std::ops::Range;

use super::beams::Beams;
use super::grid::Grid;
use super::matrix::Matrix;
use super::part::Part;
use super::single::{Chain, Single};
pub(super) use block::Block;

/// The layers down to the last scatterer in one azimuthal order, as far as views and sources require it. Of
/// the nodes with weight it contains those that the medium below carries. Extra nodes are counted from the
/// first of them, lights from the first light.
#[derive(Debug, Clone)]
pub(super) struct Above {
    carried: usize,
    /// Whether light that the base reflects once is left out ([`first_bounce`](super::first_bounce)).
    pub(super) first_apart: bool,
    /// Light from above that is reflected, `[extra, light]`.
    front: Matrix,
    /// Regular transmission from above, by node.
    down_straight: Vec<f64>,
    /// Extra nodes from which beams enter, ascending.
    entering: Vec<usize>,
    /// Transmission from these to the nodes with weight.
    down: Matrix,
    /// Transmission between extra nodes and lights: down from an extra node to a light's, `[extra, light]`,
    /// ...
    to_light: Matrix,
    /// ... and down from a light's to an extra one.
    from_light: Matrix,
    /// Regular reflection of light from below, by node.
    below_straight: Vec<f64>,
    /// Reflection of light from below among the nodes with weight.
    below: Back,
    /// The same from the entering beams to the nodes with weight.
    below_extras: Matrix,
    /// The same between extra nodes and lights, `[extra, light]`.
    below_light: Matrix,
    /// Upper bound of the light between a view and a light, if everything below is white, `[extra, light]`:
    /// in total, and via other directions.
    most: [Matrix; 2],
}

/// The extra nodes between which light is computed, ascending.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ends<'a> {
    pub(super) views: &'a [usize],
    pub(super) lights: &'a [usize],
}

impl<'a> Ends<'a> {
    /// Returns whether beams are followed from the views: from whichever side has fewer directions.
    pub(super) fn is_from_views(self) -> bool {
        self.views.len() <= self.lights.len()
    }

    /// Returns the extra nodes from which beams are followed.
    pub(super) fn beams(self) -> &'a [usize] {
        if self.is_from_views() { self.views } else { self.lights }
    }
}

/// Reflection of light from below by kernels, among the nodes with weight.
#[derive(Debug, Clone)]
enum Back {
    /// As one kernel.
    Formed(Matrix),
    /// Kernel by kernel.
    Chain(Chain),
}

impl Back {
    /// Returns whether the light of both takes the same kernels.
    fn shares(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Chain(one), Self::Chain(other)) => one.shares(other),
            _ => std::ptr::eq(self, other),
        }
    }

    /// Adds the reflection of light, `[node, column]`, or its transpose; `layers` is one for each column, and
    /// all share their kernels.
    fn add(layers: &[&Above], rising: &Matrix, sum: &mut Matrix, reversed: bool) {
        let Some(first) = layers.first() else { return };
        match &first.below {
            Self::Formed(kernel) if reversed => sum.add_transposed_product(kernel, rising, 1.0),
            Self::Formed(kernel) => sum.add_scaled_product(kernel, rising, 1.0),
            Self::Chain(_) => {
                let chains: Vec<&Chain> = layers.iter().filter_map(|above| above.below.chain()).collect();
                Chain::add(&chains, rising, sum, reversed);
            }
        }
    }

    fn chain(&self) -> Option<&Chain> {
        match self {
            Self::Chain(chain) => Some(chain),
            Self::Formed(_) => None,
        }
    }
}

/// Light propagating up from the base, for a unit beam that entered at an extra node: densities over the
/// nodes with weight, scaled, by column (state and wavelength), and the rest.
#[derive(Debug)]
pub(super) struct Rising {
    /// Scattered light, `[node, column]`.
    scattered: Matrix,
    /// The beam itself, by column.
    beam: Vec<f64>,
    /// Extra node of the beam.
    extra: usize,
    /// Scattered light that has met the base once, if it is known apart.
    once: Option<Matrix>,
    /// Whether it has no other light.
    is_once_alone: bool,
}

/// Light that falls on the layers below, in the same form as [`Rising`].
pub(super) type Falling = Rising;

impl Above {
    /// Composes the layers down to the last scatterer and that scatterer, on the nodes that the medium below
    /// it carries: the first `carried` of those with weight, and the extra ones.
    pub(super) fn new(upper: &Part, last: &Part, ends: Ends<'_>, carried: usize) -> Self {
        let lights = ends.lights;
        let (n, len) = (last.down.regular, last.down.len());
        let (kept, extras) = ((0..carried).chain(n..len).collect::<Vec<_>>(), len - n);
        let gap = upper.below.after(&last.above).one_plus(-1.0);
        let factors = gap.kernel.as_ref().map(|_| gap.weighted_block().factors());
        // Beams from above, down to the last scatterer, and back.
        let falls = gap.unsend(upper.down.send(&Beams::units((n..len).collect())), factors.as_ref(), false);
        let down = last.down.send(&falls);
        let back = upper.down.transposed().send(&last.above.send(&falls));
        // Beams from below.
        let enter = Beams::sent_back_by(&last.down, kept.clone());
        let rises = gap.transposed().unsend(enter, factors.as_ref(), true);
        let again = upper.below.send(&rises);
        let below = |rows: Range<usize>, beams: &Beams| -> Matrix {
            let sent = last.down.send_to(beams, rows.clone());
            let mut sent = sent.unwrap_or_else(|| Matrix::zeros(rows.len(), beams.nodes().len()));
            if let Some(kernel) = &last.below.kernel {
                for (beam, column) in sent.columns_mut() {
                    let more = &kernel.column(beams.nodes()[beam])[rows.clone()];
                    column.iter_mut().zip(more).for_each(|(x, k)| *x += k);
                }
            }
            sent
        };
        let of_lights = again.some(lights.iter().map(|light| carried + light));
        let on_kept = |straight: &dyn Fn(usize) -> f64| kept.iter().map(|&node| straight(node)).collect();
        let pairs = |at: &dyn Fn(usize, usize) -> f64| {
            Matrix::from_fn(extras, lights.len(), |extra, light| at(extra, lights[light]))
        };
        let above = |i: usize, extra: usize| back.at(i, extra) + upper.above.at(i, n + extra);
        let mut all = Self {
            carried,
            first_apart: false,
            front: pairs(&|extra, light| above(n + extra, light)),
            down_straight: on_kept(&|i| {
                upper.down.straight[i] * gap.inverse_straight_at(i) * last.down.straight[i]
            }),
            entering: (0..extras).collect(),
            down: Matrix::from_fn(carried, extras, |i, extra| down.at(i, extra)),
            to_light: pairs(&|extra, light| down.at(n + light, extra)),
            from_light: pairs(&|extra, light| down.at(n + extra, light)),
            below_straight: on_kept(&|i| {
                let (t, trips) = (last.down.straight[i], gap.inverse_straight_at(i));
                last.below.straight[i] + t * t * trips * upper.below.straight[i]
            }),
            below: Back::Formed(below(0..carried, &again.some(0..carried))),
            below_extras: below(0..carried, &again.some(carried..kept.len())),
            below_light: below(n..len, &of_lights),
            most: [Matrix::zeros(0, 0), Matrix::zeros(0, 0)],
        };
        let scattered =
            Matrix::from_fn(n, extras, |i, extra| down.at(i, extra).abs() + above(i, extra).abs());
        let often = Matrix::from_fn(extras, lights.len(), |v, l| {
            scattered.column(v).iter().zip(scattered.column(lights[l])).map(|(a, b)| a * b).sum()
        });
        all.most = all.most(often, ends);
        all
    }

    /// Composes the same of a single scatterer, whose kernels are shared; beams enter from extra nodes
    /// `entering`, which contain those of [`Ends::beams`].
    pub(super) fn of_single(
        single: &Single<'_>,
        ends: Ends<'_>,
        entering: Vec<usize>,
        carried: usize,
        grid: &Grid,
    ) -> Self {
        let (n, len, lights) = (grid.regular, grid.len(), ends.lights);
        let (kept, extras) = ((0..carried).chain(n..len).collect::<Vec<_>>(), len - n);
        let on_kept = |straight: &dyn Fn(usize) -> f64| kept.iter().map(|&node| straight(node)).collect();
        let pairs = |at: &dyn Fn(usize, usize) -> f64| {
            Matrix::from_fn(extras, lights.len(), |extra, light| at(n + extra, n + lights[light]))
        };
        let down = |out: usize, from: usize| single.down.at(out, from) * single.arrives(from);
        let chain = Chain::new(single, carried, n);
        let [below_extras, enters] = chain.entering(&entering);
        let place = |extra: usize| entering.binary_search(&extra).unwrap_or_default();
        // Its reflection of light from below is reciprocal.
        let below_light = |extra: usize, light: usize| match ends.is_from_views() {
            true => ends.views.binary_search(&extra).map_or(0.0, |_| enters[(lights[light], place(extra))]),
            false => enters[(extra, place(lights[light]))],
        };
        let mut all = Self {
            carried,
            first_apart: false,
            front: pairs(&|extra, light| single.front(extra, light)),
            down_straight: on_kept(&|i| single.arrives(i) * single.down.straight[i]),
            down: Matrix::from_fn(carried, entering.len(), |i, b| down(i, n + entering[b])),
            to_light: pairs(&|extra, light| down(light, extra)),
            from_light: pairs(&|extra, light| down(extra, light)),
            below_straight: on_kept(&|i| {
                single.below.straight[i] + single.down.straight[i].powi(2) * single.returns(i)
            }),
            below: Back::Chain(chain),
            below_light: Matrix::from_fn(extras, lights.len(), below_light),
            entering,
            below_extras,
            most: [Matrix::zeros(0, 0), Matrix::zeros(0, 0)],
        };
        all.most = all.most(single.often(ends, n), ends);
        all
    }

    /// Returns the upper bounds of light, given those via other directions.
    fn most(&self, often: Matrix, ends: Ends<'_>) -> [Matrix; 2] {
        let Ends { views, lights } = ends;
        let straight = |extra: usize| self.down_straight[self.carried + extra];
        let mut at_all = Matrix::zeros(self.front.rows(), lights.len());
        for (l, column) in at_all.columns_mut() {
            for &v in views {
                let (from, to) = (straight(v), straight(lights[l]));
                let ends = to * self.to_light[(v, l)].abs() + from * self.from_light[(v, l)].abs();
                let twice = from * to * self.below_light[(v, l)].abs();
                column[v] = self.front[(v, l)].abs() + ends + twice + often[(v, l)];
            }
        }
        [at_all, often]
    }

    /// Returns the upper bound of the light between a view's extra node and a light in this order, if
    /// everything below is white, and the part of it that takes other directions in between.
    pub(super) fn at_most(&self, extra: usize, light: usize) -> [f64; 2] {
        self.most.each_ref().map(|most| most[(extra, light)])
    }

    /// Returns its approximate size in bytes, and that of what it shares with other wavelengths.
    pub(super) fn bytes(&self) -> [usize; 2] {
        let [below, shared] = match &self.below {
            Back::Formed(kernel) => [8 * self.carried * kernel.columns(), 0],
            Back::Chain(chain) => [chain.bytes(), chain.shared_bytes()],
        };
        let columns = 2 * self.down.columns() + self.front.columns() * 6;
        [below + 8 * self.carried * columns + 48 * self.front.columns() * self.down.columns(), shared]
    }

    /// Returns the number of nodes with weight that it contains.
    pub(super) fn carried(&self) -> usize {
        self.carried
    }

    /// Returns the kernel between an extra node and a light of the light that is reflected from above.
    pub(super) fn front(&self, extra: usize, light: usize) -> f64 {
        self.front[(extra, light)]
    }

    /// Returns whether its light takes the same kernels as that of another.
    fn shares_kernels(&self, other: &Self) -> bool {
        self.carried == other.carried && self.entering == other.entering && self.below.shares(&other.below)
    }

    /// Returns its reflection of light from below as one kernel.
    fn formed(&self, reversed: bool) -> Matrix {
        let n = self.carried;
        let mut kernel = Matrix::zeros(n, n);
        let units = Matrix::from_fn(n, n, |i, j| if i == j { 1.0 } else { 0.0 });
        Back::add(&vec![self; n], &units, &mut kernel, reversed);
        kernel
    }

    /// Returns the regular light of a unit beam at a node that rises from a base of this reflectance.
    pub(super) fn regular_rise(&self, node: usize, base: f64) -> f64 {
        round_trips(base, self.below_straight[node]) * self.down_straight[node]
    }

    /// Returns the place of an extra node among those from which beams enter.
    fn entering(&self, extra: usize) -> usize {
        self.entering.binary_search(&extra).unwrap_or_default()
    }

    /// Returns the light that falls, given the light that rises by a reflectance `[node, column]`.
    pub(super) fn falls(&self, rising: &Rising, base: &Matrix) -> Falling {
        let (n, node) = (self.carried, self.carried + rising.extra);
        let entering = self.entering(rising.extra);
        let mut scattered = Matrix::zeros(n, base.columns());
        let mut beam = vec![0.0; base.columns()];
        for (c, beam) in beam.iter_mut().enumerate() {
            let rises = rising.beam[c];
            *beam = self.down_straight[node] + self.below_straight[node] * rises;
            let came = self.down.column(entering).iter().zip(self.below_extras.column(entering));
            let again = self.below_straight.iter().zip(rising.scattered.column(c));
            for ((x, (d, g)), (straight, up)) in scattered.column_mut(c).iter_mut().zip(came).zip(again) {
                *x = d + g * rises + straight * up;
            }
        }
        Back::add(&vec![self; base.columns()], &rising.scattered, &mut scattered, false);
        Falling { scattered, beam, extra: rising.extra, once: None, is_once_alone: false }
    }

    /// Returns the kernel of the whole display between a view's extra node and a light, for some columns: the
    /// beam entered at one of them and leaves at `to`, the other; `sums` are those of
    /// [`Block::scattered_to`].
    fn leaves(
        &self,
        rising: &Rising,
        [down, below]: [&[f64]; 2],
        pair: (usize, usize),
        to: usize,
        (base, columns): (&Matrix, Range<usize>),
    ) -> Vec<f64> {
        let n = self.carried;
        let (mut there, mut back) = (self.from_light[pair], self.to_light[pair]);
        if to == pair.0 && to != rising.extra {
            std::mem::swap(&mut there, &mut back);
        }
        let one = |c: usize| {
            let beam = rising.beam[c];
            let out = there * beam + down[c];
            let back = back + self.below_light[pair] * beam + below[c];
            let trips = round_trips(base[(n + to, c)], self.below_straight[n + to]);
            out + self.down_straight[n + to] * trips * back
        };
        columns.map(one).collect()
    }
}

/// Returns the regular light that rises after all its round trips between a base and layers that reflect it,
/// per unit that arrives; zero if no light enters the layers.
fn round_trips(base: f64, layers: f64) -> f64 {
    let open = 1.0 - base * layers;
    if open > 0.0 { base / open } else { 0.0 }
}

impl Rising {
    /// Returns the extra node of the beam.
    pub(super) fn extra(&self) -> usize {
        self.extra
    }

    /// Returns the number of columns.
    pub(super) fn columns(&self) -> usize {
        self.beam.len()
    }

    /// Returns some columns of it.
    pub(super) fn some(&self, columns: Range<usize>) -> Self {
        Self {
            scattered: self.scattered.columns_in(columns.clone()),
            beam: self.beam[columns].to_vec(),
            extra: self.extra,
            once: None,
            is_once_alone: false,
        }
    }

    /// Returns the total of a functional, by column: `share` is its value for unit light at each node that
    /// is stored, and for each column; `scale` the scaling of densities.
    pub(super) fn total(&self, scale: &[f64], share: impl Fn(usize, usize) -> f64) -> Vec<f64> {
        let one = |c: usize| {
            let column = self.scattered.column(c);
            let scattered: f64 = column.iter().enumerate().map(|(i, x)| x * scale[i] * share(i, c)).sum();
            scattered + share(column.len() + self.extra, c) * self.beam[c]
        };
        (0..self.beam.len()).map(one).collect()
    }
}
