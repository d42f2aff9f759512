//! Distribution of a unit beam that enters the display: diffuse light seen by a view (by reciprocity, the
//! fraction of the beam that leaves), and the ledger. Only azimuthal order 0 contributes.

use super::base::{Above, Block, Falling, Rising};
use super::columns::{BaseColumns, Columns, arrives};
use super::matrix::Matrix;
use super::prepare::Group;

/// Distribution of a unit beam from one extra node, by column.
#[derive(Debug, Default)]
pub(super) struct DiffuseResponse {
    /// Fraction that leaves, via the base.
    pub(super) diffuse: Vec<f64>,
    /// Fraction that leaves without having reached it.
    pub(super) diffuse_front: f64,
    /// Returned, then absorbed in front, diffuser, glass, pixel, inactive area.
    pub(super) ledger: Vec<Vec<f64>>,
    /// Over a Lambertian base, the kernel via it towards a direction whose light all arrives.
    towards: Vec<f64>,
}

impl DiffuseResponse {
    /// Computes the response from the light that rises for a beam that entered from a view, in order 0.
    pub(super) fn new(group: &Group, columns: &Columns, above: &Above, rising: &Rising) -> Self {
        let node = group.share(rising.extra());
        let mut seen = Self { diffuse_front: group.shares.leaving_front[node], ..Self::default() };
        match &columns.base {
            BaseColumns::Specular(base) => {
                let falling = above.falls(rising, &columns.below);
                seen.specular(group, columns, base, rising, &falling);
            }
            BaseColumns::Lambertian(reflectance) => seen.lambertian(group, columns, node, reflectance),
        }
        seen
    }

    /// Computes the responses of views, without ledgers. The diffuse light that leaves towards a view is the
    /// fraction that leaves of a beam which enters there: a functional of the light that rises, which is the
    /// same for all views. So one solution of the transposed problem serves all.
    pub(super) fn of_views(
        group: &Group,
        columns: &Columns,
        above: &Above,
        views: &[usize],
        tolerance: f64,
    ) -> Vec<Self> {
        let shares = &group.shares;
        let new =
            |view: usize| Self { diffuse_front: shares.leaving_front[group.share(view)], ..Self::default() };
        if let BaseColumns::Lambertian(reflectance) = &columns.base {
            let one = |view: &usize| {
                let mut seen = new(*view);
                seen.lambertian(group, columns, group.share(*view), reflectance);
                seen
            };
            return views.iter().map(one).collect();
        }
        let leaving: Vec<f64> =
            shares.scale.iter().zip(&shares.leaving).map(|(s, share)| s * share).collect();
        let block = Block::new(&[(0, above, &columns.below)]);
        let light = block.functional_of_arriving(&leaving, tolerance);
        let [down, below] = block.scattered_to(&light, views);
        let one = |(k, view): (usize, &usize)| {
            let (mut seen, node) = (new(*view), group.node(*view));
            let leaves = shares.leaving[group.share(*view)];
            let diffuse = |c: usize| {
                let beam = above.regular_rise(node, columns.below[(node, c)]);
                down[(c, k)] + beam * (below[(c, k)] + leaves)
            };
            seen.diffuse = (0..columns.below.columns()).map(diffuse).collect();
            seen.take_dark();
            seen
        };
        views.iter().enumerate().map(one).collect()
    }

    /// Moves the light that leaves over black, the last column, to that which has not reached the base.
    fn take_dark(&mut self) {
        let dark = self.diffuse.pop().unwrap_or(0.0);
        self.diffuse.iter_mut().for_each(|share| *share -= dark);
        self.diffuse_front += dark;
    }

    /// Returns, over a Lambertian base, the kernel via it towards an extra node.
    pub(super) fn by_way_of_base(&self, group: &Group, to: usize) -> impl Iterator<Item = f64> {
        let arriving = group.shares.arriving[group.share(to)];
        self.towards.iter().map(move |kernel| kernel * arriving)
    }

    /// Adds diffuse light and ledger of a specular base.
    fn specular(
        &mut self,
        group: &Group,
        columns: &Columns,
        base: &Matrix,
        rising: &Rising,
        falling: &Falling,
    ) {
        let (shares, lower) = (&group.shares, &group.lower);
        self.diffuse = rising.total(&shares.scale, |i, _| shares.leaving[i]);
        self.take_dark();
        let node = group.share(rising.extra());
        let reflectance = |i: usize, c: usize| if c < columns.len() { base[(i, c)] } else { 0.0 };
        let arrival = |i: usize, c: usize| arrives(lower.flats[i], reflectance(i, c));
        let mut in_flats = vec![0.0; columns.len()];
        let absorbs = |share: &[f64]| share.iter().any(|share| *share != 0.0);
        let none = || vec![0.0; rising.columns()];
        let layers = std::array::from_fn(|place| {
            let [from_above, from_below] = lower.absorbed.each_ref().map(|places| &places[place]);
            let in_upper = &shares.absorbed[1][place];
            let upper = match absorbs(in_upper) {
                true => rising.total(&shares.scale, |i, _| in_upper[i]),
                false => none(),
            };
            let lower = match absorbs(from_above) || absorbs(from_below) {
                true => falling.total(&shares.scale, |i, c| {
                    from_above[i] + arrival(i, c) * reflectance(i, c) * from_below[i]
                }),
                false => none(),
            };
            in_flats.iter_mut().zip(&lower).for_each(|(sum, lower)| *sum += lower);
            let first = shares.absorbed[0][place][node];
            (0..columns.len()).map(|c| first + upper[c] + lower[c]).collect()
        });
        // Light that falls and does not rise is absorbed below: the remainder of the iteration is not lost.
        let [falls, rises] = [falling, rising].map(|light| light.total(&shares.scale, |_, _| 1.0));
        let arriving = falling.total(&shares.scale, arrival);
        let below: Vec<f64> = (0..columns.len()).map(|c| falls[c] - rises[c] - in_flats[c]).collect();
        self.record(columns, layers, &arriving, &below);
    }

    /// Adds the same of a Lambertian base, whose light has one angular distribution: rank one, in closed
    /// form.
    fn lambertian(&mut self, group: &Group, columns: &Columns, node: usize, reflectance: &[f64]) {
        let shares = &group.shares;
        let regular = group.share(0);
        let areas: Vec<f64> = shares.scale[..regular].iter().map(|scale| scale * scale).collect();
        let whole: f64 = areas.iter().sum();
        let mean =
            |share: &[f64]| areas.iter().zip(share).map(|(area, share)| area * share).sum::<f64>() / whole;
        let returns = mean(&shares.returning);
        let rises: Vec<f64> =
            reflectance.iter().map(|r| shares.arriving[node] * r / (1.0 - r * returns)).collect();
        let scaled = |factor: f64| -> Vec<f64> { rises.iter().map(|x| x * factor).collect() };
        self.towards = scaled(1.0 / whole);
        self.diffuse = scaled(mean(&shares.leaving));
        let layers = std::array::from_fn(|place| {
            let (above, below) = (shares.absorbed[0][place][node], mean(&shares.absorbed[1][place]));
            rises.iter().map(|x| above + below * x).collect()
        });
        let arrives: Vec<f64> = rises.iter().map(|x| shares.arriving[node] + returns * x).collect();
        let below: Vec<f64> = arrives.iter().zip(&rises).map(|(arrives, rises)| arrives - rises).collect();
        self.record(columns, layers, &arrives, &below);
    }

    /// Adds to the ledger: `arrives` at the base; `below` is absorbed by pixel and inactive area.
    fn record(&mut self, columns: &Columns, layers: [Vec<f64>; 4], arrives: &[f64], below: &[f64]) {
        let returned = self.diffuse.iter().map(|share| share + self.diffuse_front).collect();
        let inactive: Vec<f64> = arrives.iter().zip(&columns.inactive).map(|(a, i)| a * i).collect();
        let [front, diffuser, glass, in_pixel] = layers;
        let pixel = (0..below.len()).map(|c| below[c] - inactive[c] + in_pixel[c]).collect();
        self.ledger = vec![returned, front, diffuser, glass, pixel, inactive];
    }
}
