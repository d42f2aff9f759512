//! Sparse polynomial chaos: a metric as a sum of products of polynomials of the keys, fitted to all displays.
//!
//! Every replicate has its own fit, from all *other* replicates. The value of a fit for a display is
//! therefore independent of that display, and its residuals are those of new displays (cross-validation).
//! They determine the number of terms: of the lists of terms (see [`Terms`]), the one with the smallest
//! residuals is used.
//!
//! The variance of a fit, and the contributions of a group of keys to it, are sums of squares of its
//! coefficients.
//!
//! Sources: B. Sudret, Reliab. Eng. Syst. Saf. 93, 964 (2008), for the indices; G. Blatman and B. Sudret, J.
//! Comput. Phys. 230, 2345 (2011), for lists of terms by a hyperbolic norm.

use super::plan::{Draw, Plan, REPLICATES, replicate};
use super::polynomials::Polynomials;

/// Largest number of displays of a fit, and of products in the computation of its matrix.
const MOST_FITTED: usize = 8192;
const MOST_PRODUCTS: f64 = 3e8;
/// Smallest number of displays per term.
const DISPLAYS_FOR_A_TERM: usize = 6;
/// Exponent of the hyperbolic norm of the degrees, by which terms are ordered, and the largest norm.
const HYPERBOLIC: f64 = 0.75;
const LARGEST_NORM: usize = 14;
/// Number of lists of terms that are tried.
const LISTS: usize = 12;

/// Product of polynomials: its keys, and the degree in each, which is at least 1.
pub(super) type Term = [(usize, usize)];

/// Products of polynomials in order of their norms; the first one is the constant 1.
#[derive(Debug, Clone)]
pub(super) struct Terms {
    /// The [`Term`]s.
    terms: Vec<Vec<(usize, usize)>>,
    /// Lengths of the lists; each list is the first terms.
    lists: Vec<usize>,
}

impl Terms {
    /// Creates at most `most` products of these polynomials.
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
        // A list ends where the norm increases.
        let ends = (1..ordered.len()).filter(|at| ordered[*at].0 > ordered[at - 1].0 + 1e-9);
        let ends: Vec<usize> = ends.chain([ordered.len()]).filter(|end| *end <= most.max(1)).collect();
        let mut lists: Vec<usize> = Vec::new();
        for (at, end) in ends.iter().enumerate() {
            // Lengths increase by a factor of at least 1.25.
            let is_far = lists.last().is_none_or(|last| *end as f64 >= 1.25 * *last as f64);
            if (lists.len() < LISTS && is_far) || at + 1 == ends.len() {
                lists.push(*end);
            }
        }
        ordered.truncate(lists.last().copied().unwrap_or(1));
        Self { terms: ordered.into_iter().map(|(_, term)| term).collect(), lists }
    }

    /// Writes the first `count` terms of a display to `to`. The polynomial of a key and a degree is
    /// `values[from[key] + degree - 1]`.
    fn at(&self, count: usize, values: &[f64], from: &[usize], to: &mut Vec<f64>) {
        to.clear();
        let product = |term: &Vec<(usize, usize)>| {
            term.iter().map(|(key, degree)| values[from[*key] + degree - 1]).product::<f64>()
        };
        to.extend(self.terms[..count].iter().map(product));
    }
}

/// Contribution of a key to the norm of a term, without the outer exponent.
fn cost(axes: &[Polynomials], key: usize, degree: usize) -> f64 {
    // The order of choices has no meaning, so that all their polynomials count equally.
    if axes[key].is_choice { 1.0 } else { (degree as f64).powf(HYPERBOLIC) }
}

/// Norm of a term.
fn size(axes: &[Polynomials], term: &Term) -> f64 {
    term.iter().map(|(key, degree)| cost(axes, *key, *degree)).sum::<f64>().powf(1.0 / HYPERBOLIC)
}

/// Collects all terms of the keys from `key` within a budget; returns false if there are more than `most`.
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

/// Polynomials of the displays of a plan, and the matrices that all fits share.
#[derive(Debug)]
pub(super) struct Basis {
    axes: Vec<Polynomials>,
    terms: Terms,
    /// Index of the first polynomial of each key among those of a display.
    from: Vec<usize>,
    /// Displays that are fitted: row, and display of the row.
    fitted: Vec<(usize, Draw)>,
    /// Terms of these displays, display by display.
    design: Vec<f64>,
    /// For each replicate: the lower triangle of the sums of products of terms over its displays, and the
    /// Cholesky factor of the sums over all other replicates, as far as it is well-conditioned.
    products: Vec<Vec<f64>>,
    factors: Vec<Factor>,
}

/// The Cholesky factor of a matrix, as far as it is well-conditioned.
#[derive(Debug)]
struct Factor {
    lower: Vec<f64>,
    count: usize,
}

/// Fits of a metric, one for each replicate, from all others.
#[derive(Debug, Clone)]
pub(super) struct Fits {
    /// Coefficients, `[replicate][term]`, of the metric minus `centre`, divided by `scale`.
    coefficients: Vec<Vec<f64>>,
    centre: f64,
    scale: f64,
    /// Fraction of the variance that the fits do not explain, for displays to which they were not fitted.
    pub(super) unexplained: f64,
}

impl Basis {
    /// Creates the basis of a plan's rows, of which the first ones have displays for sensitivities.
    pub(super) fn new(plan: &Plan, rows: usize, sensitivity_rows: usize) -> Self {
        let axes = plan.polynomials();
        let draws = [Draw::Own, Draw::Other].into_iter().chain((0..plan.groups().len()).map(Draw::Mixed));
        let draws_of_row = |row: usize| {
            let count = if row < sensitivity_rows { plan.groups().len() + 2 } else { 1 };
            draws.clone().take(count).map(move |draw| (row, draw))
        };
        let fitted: Vec<(usize, Draw)> = (0..rows).flat_map(draws_of_row).take(MOST_FITTED).collect();
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

    /// Computes the terms of all displays, and the matrices and their factors.
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

    /// Computes the polynomials of a display, key by key.
    fn polynomials(&self, plan: &Plan, row: usize, draw: Draw, values: &mut Vec<f64>) {
        values.clear();
        let at = plan.coordinates(row as u64, draw);
        self.axes.iter().zip(at).for_each(|(axis, x)| axis.values(x, values));
    }

    /// Fits a metric, whose values are given by `value`. `None` if it is undefined for a display or does not
    /// vary.
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

    /// Evaluates the fits of several metrics for a display, with the coefficients of the display's replicate.
    pub(super) fn evaluate(
        &self,
        plan: &Plan,
        fits: &[&Fits],
        row: usize,
        draw: Draw,
        workspace: &mut Workspace,
    ) {
        let count = fits.iter().map(|fit| fit.terms()).max().unwrap_or(0);
        let Workspace { values, terms, values_of_fits } = workspace;
        self.polynomials(plan, row, draw, values);
        self.terms.at(count, values, &self.from, terms);
        let of = replicate(row);
        let value = |fit: &&Fits| fit.centre + fit.scale * dot(&fit.coefficients[of], terms);
        values_of_fits.clear();
        values_of_fits.extend(fits.iter().map(value));
    }

    /// Mean of a replicate's fit.
    pub(super) fn mean(&self, fit: &Fits, of: usize) -> f64 {
        fit.centre + fit.scale * fit.coefficients[of][0]
    }

    /// Variance of a replicate's fit from the terms for which `counts` returns true.
    pub(super) fn variance(&self, fit: &Fits, of: usize, counts: impl Fn(&Term) -> bool) -> f64 {
        let terms = self.terms.terms.iter().zip(&fit.coefficients[of]).skip(1);
        let counted = terms.filter(|(term, _)| counts(term));
        fit.scale * fit.scale * counted.map(|(_, c)| c * c).sum::<f64>()
    }
}

/// Buffers for the evaluation of fits.
#[derive(Debug, Default)]
pub(super) struct Workspace {
    values: Vec<f64>,
    terms: Vec<f64>,
    /// Value of each fit.
    pub(super) values_of_fits: Vec<f64>,
}

impl Fits {
    /// Number of terms.
    pub(super) fn terms(&self) -> usize {
        self.coefficients.first().map_or(0, Vec::len)
    }
}

impl Factor {
    /// Factor of a symmetric matrix, given by its lower triangle.
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
                    // The term is almost a linear combination of the others.
                    if rest.is_nan() || rest <= 1e-9 * lower[i * size + i] {
                        return Self { lower, count: i }.truncated(size);
                    }
                    lower[i * size + i] = rest.sqrt();
                } else {
                    lower[i * size + j] = rest / lower[j * size + j];
                }
            }
        }
        Self { lower, count: size }.truncated(size)
    }

    /// Keeps the square block of the finished rows.
    fn truncated(self, size: usize) -> Self {
        let lines = self.lower.chunks(size.max(1)).take(self.count);
        Self { lower: lines.flat_map(|line| line[..self.count].to_vec()).collect(), count: self.count }
    }

    /// Forward substitution.
    fn forward(&self, right: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut half: Vec<f64> = Vec::with_capacity(self.count);
        for (line, right) in self.lower.chunks(self.count.max(1)).zip(right) {
            let i = half.len();
            half.push((right - dot(&half, line)) / line[i]);
        }
        half
    }

    /// Backward substitution with the first rows only, as many as `half` has.
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

/// Dot product over the length of the shorter vector.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Quadratic form `c' G c` of a symmetric matrix G, given by its lower triangle.
fn quadratic(lower: &[f64], size: usize, c: &[f64]) -> f64 {
    let of_line = |(i, own): (usize, &f64)| {
        let line = &lower[i * size..][..=i];
        own * (2.0 * dot(&c[..i], line) + own * line[i])
    };
    c.iter().enumerate().map(of_line).sum()
}
