//! A metric as a sum of polynomials of the keys: a sparse polynomial chaos, fitted to all displays.
//!
//! Every replicate has a fit of its own, made of all *other* replicates: what a fit says of a display then owes nothing to that
//! display, and how far it is off is what it would be off for any. How many terms there are is chosen by that: of the lists of
//! terms (see [`Terms`]) the one whose fits are off least.
//!
//! The variance of a fit, and the parts of it that come from a group of keys, are sums of squares of its coefficients.
//!
//! Sources: B. Sudret, Reliab. Eng. Syst. Saf. 93, 964 (2008), for the indices; G. Blatman and B. Sudret, J. Comput. Phys. 230, 2345
//! (2011), for lists of terms by a hyperbolic norm.

use super::plan::{Draw, Plan, REPLICATES, replicate};
use super::polynomials::Polynomials;

/// Displays that a fit is made of, at most; the products that its matrix takes, at most.
const MOST_FITTED: usize = 8192;
const MOST_PRODUCTS: f64 = 3e8;
/// Displays for each term, at least.
const DISPLAYS_FOR_A_TERM: usize = 6;
/// The exponent of the norm of degrees that lists of terms are ordered by, and the largest norm.
const HYPERBOLIC: f64 = 0.75;
const LARGEST_NORM: usize = 14;
/// Lists of terms that are tried.
const LISTS: usize = 12;

/// A product of polynomials: its keys, and its degree in each, which is not 0.
pub(super) type Term = [(usize, usize)];

/// Products of polynomials, the simplest first; the first is 1.
#[derive(Debug, Clone)]
pub(super) struct Terms {
    /// Each a [`Term`].
    terms: Vec<Vec<(usize, usize)>>,
    /// How many of the first terms make a list.
    lists: Vec<usize>,
}

impl Terms {
    /// Of these polynomials, `most` at most.
    fn new(axes: &[Polynomials], most: usize) -> Self {
        let mut ordered: Vec<(f64, Vec<(usize, usize)>)> = Vec::new();
        for norm in 0..=LARGEST_NORM {
            let mut within = Vec::new();
            let budget = (norm as f64 + 1e-9).powf(HYPERBOLIC);
            let whole = collect(axes, 0, budget, 4 * most, &mut Vec::new(), &mut within);
            ordered = within.into_iter().map(|term| (size(axes, &term), term)).collect();
            if !whole || ordered.len() > most {
                break;
            }
        }
        ordered.sort_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.cmp(&b.1)));
        // A list ends where the norm rises.
        let ends = (1..ordered.len()).filter(|at| ordered[*at].0 > ordered[at - 1].0 + 1e-9);
        let ends: Vec<usize> = ends.chain([ordered.len()]).filter(|end| *end <= most.max(1)).collect();
        let mut lists: Vec<usize> = Vec::new();
        for (at, end) in ends.iter().enumerate() {
            // The first few, and then ever longer steps.
            let is_far = lists.last().is_none_or(|last| *end as f64 >= 1.25 * *last as f64);
            if (lists.len() < LISTS && is_far) || at + 1 == ends.len() {
                lists.push(*end);
            }
        }
        ordered.truncate(lists.last().copied().unwrap_or(1));
        Self { terms: ordered.into_iter().map(|(_, term)| term).collect(), lists }
    }

    /// The terms at a display, into `to`; `values[key][degree - 1]` are its polynomials, flat, from `from[key]`.
    fn at(&self, count: usize, values: &[f64], from: &[usize], to: &mut Vec<f64>) {
        to.clear();
        let one = |term: &Vec<(usize, usize)>| {
            term.iter().map(|(key, degree)| values[from[*key] + degree - 1]).product::<f64>()
        };
        to.extend(self.terms[..count].iter().map(one));
    }
}

/// A term's norm, without the outer exponent.
fn cost(axes: &[Polynomials], key: usize, degree: usize) -> f64 {
    // Of choices, the order of which means nothing, all functions are alike.
    if axes[key].is_choice { 1.0 } else { (degree as f64).powf(HYPERBOLIC) }
}

fn size(axes: &[Polynomials], term: &Term) -> f64 {
    term.iter().map(|(key, degree)| cost(axes, *key, *degree)).sum::<f64>().powf(1.0 / HYPERBOLIC)
}

/// All terms of keys from `key` on within a budget; false if there are more than `most`.
fn collect(
    axes: &[Polynomials],
    key: usize,
    budget: f64,
    most: usize,
    begun: &mut Vec<(usize, usize)>,
    all: &mut Vec<Vec<(usize, usize)>>,
) -> bool {
    all.push(begun.clone());
    for next in key..axes.len() {
        for degree in 1..=axes[next].highest() {
            let left = budget - cost(axes, next, degree);
            if left < 0.0 {
                break;
            }
            if all.len() > most {
                return false;
            }
            begun.push((next, degree));
            let whole = collect(axes, next + 1, left, most, begun, all);
            begun.pop();
            if !whole {
                return false;
            }
        }
    }
    true
}

/// The polynomials of the displays of a plan, and what all fits of them share.
#[derive(Debug)]
pub(super) struct Basis {
    axes: Vec<Polynomials>,
    terms: Terms,
    /// Where the polynomials of each key begin among those of a display.
    from: Vec<usize>,
    /// The displays that are fitted: row, and which of its displays.
    fitted: Vec<(usize, Draw)>,
    /// Their terms, display by display.
    design: Vec<f64>,
    /// Sums of products of terms over the displays of each replicate, lower halves; and the factor of those of all
    /// others, as far as it goes.
    products: Vec<Vec<f64>>,
    factors: Vec<Factor>,
}

/// The Cholesky factor of a matrix, as far as it is well-conditioned.
#[derive(Debug)]
struct Factor {
    lower: Vec<f64>,
    count: usize,
}

/// A metric's fits, one for each replicate, made of the others.
#[derive(Debug, Clone)]
pub(super) struct Fits {
    /// Coefficients, `[replicate][term]`, of a metric that was scaled and moved so.
    coefficients: Vec<Vec<f64>>,
    centre: f64,
    scale: f64,
    /// The variance that the fits leave unexplained in displays that they were not made of, over the variance.
    pub(super) unexplained: f64,
}

impl Basis {
    /// Of rows whose first ones have all their displays.
    pub(super) fn new(plan: &Plan, rows: usize, sensitivity_rows: usize) -> Self {
        let axes = plan.polynomials();
        let draws = [Draw::Own, Draw::Other].into_iter().chain((0..plan.groups().len()).map(Draw::Mixed));
        let of_row = |row: usize| {
            let count = if row < sensitivity_rows { plan.groups().len() + 2 } else { 1 };
            draws.clone().take(count).map(move |draw| (row, draw))
        };
        let fitted: Vec<(usize, Draw)> = (0..rows).flat_map(of_row).take(MOST_FITTED).collect();
        let most = (fitted.len() / DISPLAYS_FOR_A_TERM)
            .min((MOST_PRODUCTS / fitted.len().max(1) as f64).sqrt() as usize)
            .max(1);
        let terms = Terms::new(&axes, most);
        let mut from = vec![0];
        axes.iter().for_each(|axis| from.push(from[from.len() - 1] + axis.highest()));
        let mut basis =
            Self { axes, terms, from, fitted, design: Vec::new(), products: Vec::new(), factors: Vec::new() };
        basis.prepare(plan);
        basis
    }

    fn prepare(&mut self, plan: &Plan) {
        let count = self.terms.terms.len();
        let (mut values, mut one) = (Vec::new(), Vec::new());
        self.products = vec![vec![0.0; count * count]; REPLICATES];
        for (row, draw) in &self.fitted {
            self.polynomials(plan, *row, *draw, &mut values);
            self.terms.at(count, &values, &self.from, &mut one);
            let products = &mut self.products[replicate(*row)];
            for (i, a) in one.iter().enumerate() {
                let line = &mut products[i * count..][..=i];
                line.iter_mut().zip(&one).for_each(|(sum, b)| *sum += a * b);
            }
            self.design.extend_from_slice(&one);
        }
        let mut all = vec![0.0; count * count];
        self.products.iter().for_each(|one| all.iter_mut().zip(one).for_each(|(sum, x)| *sum += x));
        let without = |one: &Vec<f64>| all.iter().zip(one).map(|(all, own)| all - own).collect();
        self.factors = self.products.iter().map(|one| Factor::of(without(one), count)).collect();
    }

    /// The polynomials of a display, those of each key after the other.
    fn polynomials(&self, plan: &Plan, row: usize, draw: Draw, values: &mut Vec<f64>) {
        values.clear();
        let at = plan.coordinates(row as u64, draw);
        self.axes.iter().zip(at).for_each(|(axis, x)| axis.values(x, values));
    }

    /// Fits a metric of the displays; `value` gives it. `None` where it is undefined somewhere.
    pub(super) fn fit(&self, value: impl Fn(usize, Draw) -> f64) -> Option<Fits> {
        let values: Vec<f64> = self.fitted.iter().map(|(row, draw)| value(*row, *draw)).collect();
        let count = values.len() as f64;
        let centre = values.iter().sum::<f64>() / count;
        let scale = (values.iter().map(|y| (y - centre).powi(2)).sum::<f64>() / count).sqrt();
        if !(scale.is_finite() && scale > 0.0) {
            return None;
        }
        let terms = self.terms.terms.len();
        let (mut moments, mut squares) = (vec![vec![0.0; terms]; REPLICATES], [0.0; REPLICATES]);
        for (((row, _), y), one) in self.fitted.iter().zip(values).zip(self.design.chunks_exact(terms)) {
            let (y, of) = ((y - centre) / scale, replicate(*row));
            moments[of].iter_mut().zip(one).for_each(|(sum, x)| *sum += y * x);
            squares[of] += y * y;
        }
        let mut all = vec![0.0; terms];
        moments.iter().for_each(|one| all.iter_mut().zip(one).for_each(|(sum, x)| *sum += x));
        let halves: Vec<Vec<f64>> = (self.factors.iter().zip(&moments))
            .map(|(factor, own)| factor.forward(all.iter().zip(own).map(|(all, own)| all - own)))
            .collect();
        let possible = self.factors.iter().map(|factor| factor.count).min().unwrap_or(0);
        let mut best: Option<Fits> = None;
        for list in self.terms.lists.iter().filter(|list| **list <= possible) {
            let fit = |(factor, half): (&Factor, &Vec<f64>)| factor.backward(&half[..*list]);
            let coefficients: Vec<Vec<f64>> = self.factors.iter().zip(&halves).map(fit).collect();
            let off = coefficients.iter().enumerate().map(|(of, c)| {
                squares[of] - 2.0 * dot(c, &moments[of]) + quadratic(&self.products[of], terms, c)
            });
            let unexplained = off.sum::<f64>().max(0.0) / squares.iter().sum::<f64>();
            if best.as_ref().is_none_or(|best| unexplained < best.unexplained) {
                best = Some(Fits { coefficients, centre, scale, unexplained });
            }
        }
        best
    }

    /// What a metric's fit of a display's replicate says of the display.
    pub(super) fn said(&self, plan: &Plan, fits: &[&Fits], row: usize, draw: Draw, room: &mut Room) {
        let count = fits.iter().map(|fit| fit.terms()).max().unwrap_or(0);
        self.polynomials(plan, row, draw, &mut room.values);
        self.terms.at(count, &room.values, &self.from, &mut room.terms);
        room.said.clear();
        let of = replicate(row);
        room.said
            .extend(fits.iter().map(|fit| fit.centre + fit.scale * dot(&fit.coefficients[of], &room.terms)));
    }

    /// The mean of a fit of one replicate.
    pub(super) fn mean(&self, fit: &Fits, of: usize) -> f64 {
        fit.centre + fit.scale * fit.coefficients[of][0]
    }

    /// The variance of a fit of one replicate that comes from the terms that `counts`, each its keys and degrees.
    pub(super) fn variance(&self, fit: &Fits, of: usize, counts: impl Fn(&Term) -> bool) -> f64 {
        let terms = self.terms.terms.iter().zip(&fit.coefficients[of]).skip(1);
        let of_them = terms.filter(|(term, _)| counts(term));
        fit.scale * fit.scale * of_them.map(|(_, c)| c * c).sum::<f64>()
    }
}

/// Room to evaluate fits in.
#[derive(Debug, Default)]
pub(super) struct Room {
    values: Vec<f64>,
    terms: Vec<f64>,
    /// What each fit says.
    pub(super) said: Vec<f64>,
}

impl Fits {
    /// How many terms there are.
    pub(super) fn terms(&self) -> usize {
        self.coefficients.first().map_or(0, Vec::len)
    }
}

impl Factor {
    /// Of a matrix whose lower half is given.
    fn of(mut lower: Vec<f64>, size: usize) -> Self {
        for i in 0..size {
            for j in 0..=i {
                let (above, line) = lower.split_at(i * size);
                let known = if i == j {
                    dot(&line[..j], &line[..j])
                } else {
                    dot(&line[..j], &above[j * size..][..j])
                };
                let rest = lower[i * size + j] - known;
                if i == j {
                    // A term that is next to one made of the others.
                    if rest.is_nan() || rest <= 1e-9 * lower[i * size + i] {
                        return Self { lower, count: i }.cut(size);
                    }
                    lower[i * size + i] = rest.sqrt();
                } else {
                    lower[i * size + j] = rest / lower[j * size + j];
                }
            }
        }
        Self { lower, count: size }.cut(size)
    }

    /// Only the lines that are done, each as long as there are lines.
    fn cut(self, size: usize) -> Self {
        let lines = self.lower.chunks(size.max(1)).take(self.count);
        Self { lower: lines.flat_map(|line| line[..self.count].to_vec()).collect(), count: self.count }
    }

    fn forward(&self, right: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut half: Vec<f64> = Vec::with_capacity(self.count);
        for (line, right) in self.lower.chunks(self.count.max(1)).zip(right) {
            let i = half.len();
            half.push((right - dot(&half, line)) / line[i]);
        }
        half
    }

    /// Of the first lines alone, as many as `half` has.
    fn backward(&self, half: &[f64]) -> Vec<f64> {
        let mut solution = half.to_vec();
        for i in (0..half.len()).rev() {
            let line = &self.lower[i * self.count..][..=i];
            solution[i] /= line[i];
            let own = solution[i];
            solution[..i].iter_mut().zip(line).for_each(|(x, l)| *x -= own * l);
        }
        solution
    }
}

/// Of as many numbers as the shorter one has.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `c' G c` of the lower half of a matrix.
fn quadratic(lower: &[f64], size: usize, c: &[f64]) -> f64 {
    let of_line = |(i, own): (usize, &f64)| {
        let line = &lower[i * size..][..=i];
        own * (2.0 * dot(&c[..i], line) + own * line[i])
    };
    c.iter().enumerate().map(of_line).sum()
}
