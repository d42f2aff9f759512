//! Quadrature rules for known light on a panel of cosines.
//!
//! The nodes are those of the Gauss rule for the light of all sources together. The weights for each kind of light integrate
//! polynomials of degree up to N - 1 exactly, and almost exactly those of up to twice that degree, because its density varies
//! little relative to the common one.
//!
//! Source: G. H. Golub, G. Meurant, "Matrices, Moments and Quadrature" (2010), chapter 4 (discretised measures).

/// Number of last coefficients from which the missing ones are extrapolated.
pub(super) const LAST: usize = 6;

/// Number of pairs of missing coefficients whose effect on the error is computed. Gauss rules are almost exact for about as many
/// missing polynomials as they have nodes, and not beyond.
pub(super) const PAIRS: usize = 8;

/// Fraction of the light of a panel that is spread uniformly, so that no region is without nodes.
const UNIFORM: f64 = 0.01;

/// Effects of the missing coefficients N and N + 1, N + 2 and N + 3, ... on the error; the last one is a bound for all others.
pub(super) type Aliases = [f64; PAIRS + 1];

/// Panel with this number of nodes; its borders are given in parts of 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Panel {
    pub(super) start: u32,
    pub(super) end: u32,
    pub(super) count: usize,
}

/// Light on the fine nodes of a panel: what rules are made for.
pub(super) struct FineLight<'a> {
    pub(super) cosines: &'a [f64],
    /// Weights of the nodes in an integral over the cosine.
    pub(super) widths: &'a [f64],
    /// `[row][node]`.
    pub(super) rows: Vec<&'a [f64]>,
    /// Rows of light whose errors are estimated, and the sums of their weights over all panels.
    pub(super) lights: Vec<(usize, f64)>,
}

/// Quadrature rule for all rows.
#[derive(Debug)]
pub(super) struct Rule {
    pub(super) cosines: Vec<f64>,
    /// `[row][node]`.
    pub(super) weights: Vec<Vec<f64>>,
    /// Weights on the nodes that give the last coefficients of a function.
    pub(super) last: [Vec<f64>; LAST],
    /// For each light, the effect of missing coefficients.
    pub(super) aliases: Vec<Aliases>,
    /// The same with the recycled light of it, which comes from all directions as well.
    pub(super) recycled: Vec<Aliases>,
}

impl Rule {
    /// Makes a rule of `count` nodes, at least [`LAST`].
    pub(super) fn new(count: usize, fine: &FineLight<'_>) -> Self {
        let measure = fine.measure();
        let degrees = count + 2 * PAIRS;
        let polynomials = Polynomials::new(fine.cosines, &measure, degrees);
        let cosines = polynomials.roots(count, fine.cosines);
        // `[node][degree]`.
        let at: Vec<Vec<f64>> = cosines.iter().map(|cosine| polynomials.at(*cosine, degrees)).collect();
        let gauss: Vec<f64> =
            at.iter().map(|at| 1.0 / at[..count].iter().map(|p| p * p).sum::<f64>()).collect();
        let weights_of = |moments: &[f64]| -> Vec<f64> {
            let one = |(at, gauss): (&Vec<f64>, &f64)| gauss * dot(&at[..count], &moments[..count]);
            at.iter().zip(&gauss).map(one).collect()
        };
        let aliases_of = |moments: &[f64]| -> Aliases {
            let weights = weights_of(moments);
            let error = |degree: usize| {
                let found: f64 = weights.iter().zip(&at).map(|(weight, at)| weight * at[degree]).sum();
                (moments[degree] - found).abs()
            };
            let mut aliases = [0.0; PAIRS + 1];
            for (pair, alias) in aliases[..PAIRS].iter_mut().enumerate() {
                *alias = error(count + 2 * pair).max(error(count + 2 * pair + 1));
            }
            let largest = |at: &Vec<f64>| at[count..].iter().fold(0.0_f64, |most, p| most.max(p.abs()));
            aliases[PAIRS] = weights.iter().zip(&at).map(|(weight, at)| weight.abs() * largest(at)).sum();
            aliases
        };
        let moments: Vec<Vec<f64>> = fine.rows.iter().map(|row| polynomials.moments(row)).collect();
        let lights = fine.lights.iter();
        // By projected area.
        let uniform: Vec<f64> =
            fine.cosines.iter().zip(fine.widths).map(|(c, width)| 2.0 * c * width).collect();
        let uniform = aliases_of(&polynomials.moments(&uniform));
        let recycled = |(row, total): &(usize, f64)| {
            let own = aliases_of(&moments[*row]);
            std::array::from_fn(|k| own[k] + total.abs() * uniform[k])
        };
        let last = |k: usize| -> Vec<f64> {
            at.iter().zip(&gauss).map(|(at, gauss)| gauss * at[count - LAST + k]).collect()
        };
        Self {
            weights: moments.iter().map(|moments| weights_of(moments)).collect(),
            last: std::array::from_fn(last),
            aliases: lights.clone().map(|(row, _)| aliases_of(&moments[*row])).collect(),
            recycled: lights.map(recycled).collect(),
            cosines,
        }
    }
}

impl FineLight<'_> {
    /// Returns the light of all sources together, each with the same weight.
    fn measure(&self) -> Vec<f64> {
        let mut sum = vec![0.0; self.cosines.len()];
        for (row, total) in self.lights.iter().filter(|(_, total)| *total > 0.0) {
            sum.iter_mut().zip(self.rows[*row]).for_each(|(sum, weight)| *sum += weight.max(0.0) / total);
        }
        let width: f64 = self.widths.iter().sum();
        let spread = (UNIFORM * sum.iter().sum::<f64>()).max(f64::MIN_POSITIVE.sqrt()) / width;
        sum.iter_mut().zip(self.widths).for_each(|(sum, width)| *sum += spread * width);
        sum
    }
}

/// Polynomials that are orthonormal for a discrete measure, by their recurrence
/// `b_j p_(j+1) = (x - a_j) p_j - b_(j-1) p_(j-1)`.
struct Polynomials {
    /// p_0.
    constant: f64,
    a: Vec<f64>,
    b: Vec<f64>,
    /// `[degree][point]`.
    values: Vec<Vec<f64>>,
}

impl Polynomials {
    /// Computes the polynomials below this degree, of which there must be no more than points, by the procedure of Stieltjes
    /// with repeated orthogonalisation.
    fn new(points: &[f64], measure: &[f64], degrees: usize) -> Self {
        let product = |one: &[f64], other: &[f64]| -> f64 {
            one.iter().zip(other).zip(measure).map(|((one, other), weight)| weight * one * other).sum()
        };
        let constant = 1.0 / measure.iter().sum::<f64>().sqrt();
        let (mut a, mut b, mut values) = (Vec::new(), Vec::new(), vec![vec![constant; points.len()]]);
        while values.len() < degrees {
            let last = &values[values.len() - 1];
            let mut next: Vec<f64> = points.iter().zip(last).map(|(x, p)| x * p).collect();
            a.push(product(&next, last));
            for _ in 0..2 {
                for known in &values {
                    let along = product(&next, known);
                    next.iter_mut().zip(known).for_each(|(next, known)| *next -= along * known);
                }
            }
            let size = product(&next, &next).sqrt();
            next.iter_mut().for_each(|value| *value /= size);
            b.push(size);
            values.push(next);
        }
        Self { constant, a, b, values }
    }

    /// Returns the values at a point.
    fn at(&self, x: f64, degrees: usize) -> Vec<f64> {
        let (mut values, mut before) = (vec![self.constant], 0.0);
        for j in 0..degrees - 1 {
            let last = values[j];
            values.push(((x - self.a[j]) * last - before) / self.b[j]);
            before = self.b[j] * last;
        }
        values
    }

    /// Returns the value of one of them at a point.
    fn value(&self, x: f64, degree: usize) -> f64 {
        let (mut last, mut before) = (self.constant, 0.0);
        for (a, b) in self.a.iter().zip(&self.b).take(degree) {
            let next = ((x - a) * last - before) / b;
            (last, before) = (next, b * last);
        }
        last
    }

    /// Returns the integrals of the polynomials with these weights on the points.
    fn moments(&self, weights: &[f64]) -> Vec<f64> {
        self.values.iter().map(|values| dot(values, weights)).collect()
    }

    /// Returns the roots of the polynomial of this degree, which separate those of the next one.
    fn roots(&self, degree: usize, points: &[f64]) -> Vec<f64> {
        /// Number of halvings of an interval, down to rounding.
        const HALVINGS: usize = 60;
        let (first, last) = (points[0], points[points.len() - 1]);
        let mut roots = Vec::new();
        for degree in 1..=degree {
            let value = |x: f64| self.value(x, degree);
            let ends: Vec<f64> = std::iter::once(first).chain(roots.iter().copied()).chain([last]).collect();
            let between = |ends: &[f64]| {
                let (mut low, mut high) = (ends[0], ends[1]);
                let rises = value(high) > 0.0;
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (low + high);
                    if (value(middle) > 0.0) == rises { high = middle } else { low = middle }
                }
                0.5 * (low + high)
            };
            roots = ends.windows(2).map(between).collect();
        }
        roots
    }
}

fn dot(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(one, other)| one * other).sum()
}
