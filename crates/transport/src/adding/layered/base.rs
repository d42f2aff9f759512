//! The stack with its base: light that a view sees via the pixel.
//!
//! The light that falls from the last scatterer on the flat layers and the base below it obeys
//! `x = t + G B x`: t is transmitted light, B the reflectance below, G the light that the layers above send
//! back down. B differs by state and wavelength and is a factor for each direction. All columns are iterated
//! at once, with one matrix product for each order of reflection. Where light is nearly trapped, a direct
//! solution is cheaper.

use std::ops::Range;

use super::algebra::Operator;
use super::beams::Beams;
use super::grid::Grid;
use super::matrix::Matrix;
use super::part::Part;
use super::pivots::Pivots;
use super::single::{Chain, Single};

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
    /// Upper bound of the light between a view and a light, if everything below is white, `[extra, light]`: in
    /// total, and via other directions.
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
    pub(super) fn from_views(self) -> bool {
        self.views.len() <= self.lights.len()
    }

    /// Returns the extra nodes from which beams are followed.
    pub(super) fn beams(self) -> &'a [usize] {
        if self.from_views() { self.views } else { self.lights }
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
    /// Adds the reflection of light, `[node, column]`, or its transpose.
    fn add(&self, rising: &Matrix, sum: &mut Matrix, reversed: bool) {
        match self {
            Self::Formed(kernel) if reversed => sum.add_transposed_product(kernel, rising, 1.0),
            Self::Formed(kernel) => sum.add_scaled_product(kernel, rising, 1.0),
            Self::Chain(chain) => chain.add(rising, sum, reversed),
        }
    }

    /// Returns it as one kernel among this many nodes.
    fn formed(&self, nodes: usize, reversed: bool) -> Matrix {
        let mut kernel = Matrix::zeros(nodes, nodes);
        self.add(
            &Matrix::from_fn(nodes, nodes, |i, j| if i == j { 1.0 } else { 0.0 }),
            &mut kernel,
            reversed,
        );
        kernel
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
}

/// Light that falls on the layers below, in the same form as [`Rising`].
pub(super) type Falling = Rising;

/// Number of reflections up to which light is followed by iteration.
const ITERATIONS: usize = 40;
/// Number of columns whose interpolated light is compared with that of an iteration: those which one more reflection changes
/// most.
const COMPARED: usize = 8;
/// Error of their light, over the tolerance of the iteration, up to which no other columns are iterated.
const ERROR_OF_INTERPOLATED: f64 = 1000.0;

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

    /// Composes the same of a single scatterer, whose kernels are shared; beams enter from extra nodes `entering`,
    /// which contain those of [`Ends::beams`].
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
        let below_light = |extra: usize, light: usize| match ends.from_views() {
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

    /// Returns the upper bound of the light between a view's extra node and a light in this order, if everything
    /// below is white, and the part of it that takes other directions in between.
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

    /// Returns the light that rises from the base, given its reflectance `[node, column]` and its pivots, to this
    /// error relative to the largest density or to `floor`, by column; `floor` is raised to the largest density
    /// found.
    pub(super) fn rise(
        &self,
        extra: usize,
        base: &Matrix,
        pivots: Option<&Pivots>,
        tolerance: f64,
        floor: &mut [f64],
    ) -> Rising {
        let (n, columns) = (self.carried, base.columns());
        let (node, entering) = (n + extra, self.entering(extra));
        let beam: Vec<f64> = (0..columns).map(|c| self.regular_rise(node, base[(node, c)])).collect();
        let mut arrives = Matrix::zeros(n, columns);
        for (c, column) in arrives.columns_mut() {
            let scattered = self.down.column(entering).iter().zip(self.below_extras.column(entering));
            column.iter_mut().zip(scattered).for_each(|(x, (d, g))| *x = d + g * beam[c]);
        }
        let scattered = self.scattered_rise(&arrives, (base, pivots), tolerance, floor, false);
        Rising { scattered, beam, extra }
    }

    /// Returns the solution of the transposed problem: light on the nodes whose product with the light that arrives at
    /// the base, scattered, is the total of a functional of the light that rises; `functional` is its value at each
    /// node with weight, scaled.
    pub(super) fn functional_of_arriving(
        &self,
        functional: &[f64],
        base: &Matrix,
        pivots: Option<&Pivots>,
        tolerance: f64,
    ) -> Matrix {
        let values = Matrix::from_fn(self.carried, base.columns(), |i, _| functional[i]);
        self.scattered_rise(&values, (base, pivots), tolerance, &mut vec![0.0; base.columns()], true)
    }

    /// Returns the scattered light that rises from the base, given the scattered light that arrives, `[node, column]`;
    /// or, if `reversed`, the solution of the transposed problem.
    fn scattered_rise(
        &self,
        arrives: &Matrix,
        (base, pivots): (&Matrix, Option<&Pivots>),
        tolerance: f64,
        floor: &mut [f64],
        reversed: bool,
    ) -> Matrix {
        let (n, columns) = (self.carried, base.columns());
        let mut gain = Matrix::zeros(n, columns);
        for (c, column) in gain.columns_mut() {
            let straight = base.column(c).iter().zip(&self.below_straight);
            column.iter_mut().zip(straight).for_each(|(x, (b, g))| *x = round_trips(*b, *g));
        }
        let mut scattered = Matrix::zeros(n, columns);
        let open = match pivots.filter(|_| n > 0) {
            Some(pivots) => {
                self.interpolate(pivots, [arrives, &gain], &mut scattered, tolerance, floor, reversed)
            }
            None => self.iterate([arrives, &gain], &mut scattered, tolerance, floor, reversed),
        };
        if !open.is_empty() {
            let below = self.below.formed(n, reversed);
            for column in open {
                self.solve(&below, column, base, arrives, &mut scattered);
            }
        }
        scattered
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
        self.below.add(&rising.scattered, &mut scattered, false);
        Falling { scattered, beam, extra: rising.extra }
    }

    /// Iterates the light of the pivots, and interpolates that of all columns. One more reflection then makes what the base
    /// has reflected once exact. The columns that it changes most are iterated themselves, which shows the error of the
    /// interpolation: if it is too large, all others are iterated, too. Returns those that have not converged.
    fn interpolate(
        &self,
        pivots: &Pivots,
        [arrives, gain]: [&Matrix; 2],
        rising: &mut Matrix,
        tolerance: f64,
        floor: &mut [f64],
        reversed: bool,
    ) -> Vec<usize> {
        let mut of_pivots = Matrix::zeros(self.carried, pivots.columns().len());
        let mut again = of_pivots.clone();
        let mut next = arrives.clone();
        let left =
            self.iterate_some(pivots.columns(), [arrives, gain], &mut of_pivots, tolerance, floor, reversed);
        if !left.is_empty() {
            return self.iterate([arrives, gain], rising, tolerance, floor, reversed);
        }
        self.below.add(&of_pivots, &mut again, reversed);
        pivots.add_interpolated(&again, &mut next);
        pivots.add_interpolated(&of_pivots, rising);
        let mut changes = Vec::with_capacity(rising.columns());
        for (c, old) in rising.columns_mut() {
            let (change, size) = reflect(old, next.column(c), gain.column(c));
            floor[c] = size.max(floor[c]);
            changes.push((c, if floor[c] > 0.0 { change / floor[c] } else { 0.0 }));
        }
        changes.sort_by(|a, b| b.1.total_cmp(&a.1));
        let compared: Vec<usize> = changes.iter().take(COMPARED).map(|(c, _)| *c).collect();
        let mut exact = Matrix::zeros(self.carried, compared.len());
        let left = self.iterate_some(&compared, [arrives, gain], &mut exact, tolerance, floor, reversed);
        let differs = |(exact, c): (&[f64], &usize)| {
            let most = ERROR_OF_INTERPOLATED * tolerance * floor[*c];
            exact.iter().zip(rising.column(*c)).any(|(exact, found)| (exact - found).abs() > most)
        };
        let columns = (0..compared.len()).map(|k| exact.column(k));
        if !left.is_empty() || columns.zip(&compared).any(differs) {
            return self.iterate([arrives, gain], rising, tolerance, floor, reversed);
        }
        for (c, (_, exact)) in compared.iter().zip(exact.columns_mut()) {
            rising.column_mut(*c).copy_from_slice(exact);
        }
        Vec::new()
    }

    /// Iterates the light of some columns; returns those that have not converged after many orders.
    fn iterate_some(
        &self,
        columns: &[usize],
        [arrives, gain]: [&Matrix; 2],
        rising: &mut Matrix,
        tolerance: f64,
        floor: &mut [f64],
        reversed: bool,
    ) -> Vec<usize> {
        let [arrives, gain] = [arrives, gain].map(|all| all.some_columns(columns));
        let mut floors: Vec<f64> = columns.iter().map(|c| floor[*c]).collect();
        let open = self.iterate([&arrives, &gain], rising, tolerance, &mut floors, reversed);
        columns.iter().zip(floors).for_each(|(c, size)| floor[*c] = size);
        open.into_iter().map(|number| columns[number]).collect()
    }

    /// Iterates light between base and layers; returns the columns that have not converged after many
    /// orders.
    fn iterate(
        &self,
        [arrives, gain]: [&Matrix; 2],
        rising: &mut Matrix,
        tolerance: f64,
        floor: &mut [f64],
        reversed: bool,
    ) -> Vec<usize> {
        let n = self.carried;
        if n == 0 {
            return Vec::new();
        }
        let mut open: Vec<usize> = (0..arrives.columns()).collect();
        let mut before = vec![f64::INFINITY; arrives.columns()];
        let mut next = arrives.clone();
        for _ in 0..ITERATIONS {
            open.clear();
            for (c, old) in rising.columns_mut() {
                let (change, size) = reflect(old, next.column(c), gain.column(c));
                let size = size.max(floor[c]);
                // Changes decrease geometrically: the remainder is their sum.
                let ratio = (change / before[c]).min(1.0);
                if change > tolerance * size * (1.0 - ratio) {
                    open.push(c);
                }
                (before[c], floor[c]) = (change, size);
            }
            if open.is_empty() {
                break;
            }
            next.copy_from(arrives);
            self.below.add(rising, &mut next, reversed);
        }
        open
    }

    fn solve(&self, below: &Matrix, column: usize, base: &Matrix, arrives: &Matrix, rising: &mut Matrix) {
        let n = self.carried;
        // 1 - B G acts on the light that rises.
        let b: Vec<f64> = (0..n).map(|i| base[(i, column)]).collect();
        let kernel = Matrix::from_fn(n, n, |i, j| -b[i] * below[(i, j)]);
        let straight = (0..n).map(|i| 1.0 - b[i] * self.below_straight[i]).collect();
        let closed = Operator { regular: n, straight, kernel: Some(kernel.into()) };
        let mut right = Matrix::from_fn(n, 1, |i, _| b[i] * arrives[(i, column)]);
        closed.weighted_block().factors().solve(&mut right);
        rising.column_mut(column).copy_from_slice(right.column(0));
    }

    /// Returns scattered light that rises, times the kernels towards each of these extra nodes, `[column, node]`:
    /// of light that leaves, and of light that is reflected once more.
    pub(super) fn scattered_to(&self, scattered: &Matrix, extras: &[usize]) -> [Matrix; 2] {
        match &self.below {
            Back::Chain(chain) => {
                chain.towards_extras(scattered).map(|towards| towards.transposed_rows(extras))
            }
            Back::Formed(_) => [&self.down, &self.below_extras].map(|kernel| {
                let mut sums = Matrix::zeros(scattered.columns(), extras.len());
                sums.add_transposed_product(scattered, &kernel.some_columns(extras), 1.0);
                sums
            }),
        }
    }

    /// Returns the same of the light of a beam. What the base, of reflectance `[node, column]`, has reflected only once
    /// does not leave if it is apart.
    pub(super) fn rising_to(&self, rising: &Rising, extras: &[usize], base: &Matrix) -> [Matrix; 2] {
        let [mut leaving, again] = self.scattered_to(&rising.scattered, extras);
        if self.first_apart {
            let first = self.down.column(self.entering(rising.extra));
            let towards: Vec<usize> = extras.iter().map(|extra| self.entering(*extra)).collect();
            let once =
                Matrix::from_fn(self.carried, extras.len(), |i, to| first[i] * self.down[(i, towards[to])]);
            leaving.add_transposed_product(base, &once, -1.0);
        }
        [leaving, again]
    }

    /// Returns the kernel of the whole display between a view's extra node and a light, by column: the beam
    /// entered at one of them and leaves at `to`, the other; `sums` are those of [`Self::scattered_to`].
    pub(super) fn leaves(
        &self,
        rising: &Rising,
        [down, below]: [&[f64]; 2],
        pair: (usize, usize),
        to: usize,
        base: &Matrix,
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
        (0..base.columns()).map(one).collect()
    }
}

/// Returns the regular light that rises after all its round trips between a base and layers that reflect it,
/// per unit that arrives; zero if no light enters the layers.
fn round_trips(base: f64, layers: f64) -> f64 {
    let open = 1.0 - base * layers;
    if open > 0.0 { base / open } else { 0.0 }
}

/// Sets `rising` to `next` times `gain`; returns the largest change and the largest value.
fn reflect(rising: &mut [f64], next: &[f64], gain: &[f64]) -> (f64, f64) {
    // Chunks of fixed size, so that they are vectorised.
    let (rising, rising_rest) = rising.as_chunks_mut::<8>();
    let (next, next_rest) = next.as_chunks::<8>();
    let (gain, gain_rest) = gain.as_chunks::<8>();
    let (mut change, mut size) = ([0.0; 8], [0.0; 8]);
    for ((rising, next), gain) in rising.iter_mut().zip(next).zip(gain) {
        for k in 0..8 {
            let value = next[k] * gain[k];
            change[k] = larger((value - rising[k]).abs(), change[k]);
            size[k] = larger(value.abs(), size[k]);
            rising[k] = value;
        }
    }
    for ((rising, next), gain) in rising_rest.iter_mut().zip(next_rest).zip(gain_rest) {
        let value = next * gain;
        change[0] = larger((value - *rising).abs(), change[0]);
        size[0] = larger(value.abs(), size[0]);
        *rising = value;
    }
    [change, size].map(|lanes| lanes.into_iter().fold(0.0, larger)).into()
}

/// Returns the larger number, by a comparison that can be vectorised.
#[inline]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
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
