//! Forms: homogeneous polynomials in the terms of the reflectance.
//!
//! The grid gives a coefficient for each sequence of terms that light may meet. Sequences of the same terms
//! in another order have the same product; here they share one coefficient. The products of the terms
//! ([`Products`]) depend only on the pixel, the coefficients on views and sources: many values of both are
//! one matrix product.

use super::values::Values;
use crate::numerics::product::add_product;

/// Index of the product of each sequence of terms.
#[derive(Debug, Clone)]
pub(super) struct Places {
    /// For each sequence of terms (the last one varies fastest) the number of its product.
    place: Vec<usize>,
    count: usize,
}

impl Places {
    /// Enumerates the products of `degree` out of this many terms.
    pub(super) fn new(terms: usize, degree: u32) -> Self {
        let sequences = terms.pow(degree);
        let mut place = vec![usize::MAX; sequences];
        let mut count = 0;
        // In this order ascending sequences come first, and products in the order of `Products`.
        for sequence in 0..sequences {
            let sorted = ascending(sequence, terms, degree);
            if place[sorted] == usize::MAX {
                place[sorted] = count;
                count += 1;
            }
            place[sequence] = place[sorted];
        }
        Self { place, count }
    }

    /// Returns the number of products.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Returns a coefficient for each product, from those of each sequence.
    pub(super) fn folded(&self, sequences: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; self.count];
        sequences.iter().zip(&self.place).for_each(|(value, place)| sum[*place] += value);
        sum
    }
}

impl Places {
    /// Returns the derivatives of a form of `degree` by each of its terms: forms of one degree less, whose
    /// products are those of `less`; `[term][product]`.
    pub(super) fn differentiated(&self, form: &[f64], less: &Self, terms: usize, degree: u32) -> Vec<f64> {
        let mut out = vec![0.0; terms * less.count];
        let sequences = less.place.len();
        for (sequence, product) in less.place.iter().enumerate() {
            for term in 0..terms {
                // Each sequence of a product once: the same terms in another order have the same place and
                // coefficient.
                let times = 1 + count(sequence, term, terms, degree - 1);
                let coefficient = form[self.place[term * sequences + sequence]];
                out[term * less.count + product] = coefficient * times as f64;
            }
        }
        out
    }
}

/// Returns how often a term occurs in a sequence of this length.
fn count(mut sequence: usize, term: usize, terms: usize, length: u32) -> usize {
    let is_it = |_| {
        let found = sequence % terms == term;
        sequence /= terms;
        usize::from(found)
    };
    (0..length).map(is_it).sum()
}

/// Returns the number of the sequence of the same terms in ascending order.
fn ascending(mut sequence: usize, terms: usize, degree: u32) -> usize {
    let mut digits: Vec<usize> = (0..degree)
        .map(|_| {
            let digit = sequence % terms;
            sequence /= terms;
            digit
        })
        .collect();
    digits.sort_unstable();
    digits.into_iter().fold(0, |number, digit| number * terms + digit)
}

/// Products of the terms of one order of the series, without their first factors: those of full degree are
/// several times as many, and need not be stored.
#[derive(Debug, Clone)]
pub(in super::super) struct Products {
    /// `[term][column]`.
    terms: Vec<f64>,
    /// Products of one degree less than the form's, `[product][column]`.
    less: Vec<f64>,
    /// For each term, the first of these products whose own first factor is that term or a later one.
    from: Vec<usize>,
}

impl Products {
    /// Multiplies `degree` (2 or more) terms, given as `[term][column]`.
    pub(super) fn new(terms: Vec<f64>, columns: usize, degree: u32) -> Self {
        let count = terms.len() / columns.max(1);
        let mut from: Vec<usize> = (0..count).collect();
        let mut less = terms.clone();
        for _ in 2..degree {
            let before = std::mem::take(&mut less);
            let kept = before.len() / columns;
            less.reserve_exact(from.iter().map(|from| (kept - from) * columns).sum());
            for (term, from) in terms.chunks_exact(columns).zip(&mut from) {
                let first = std::mem::replace(from, less.len() / columns);
                for product in before[first * columns..].chunks_exact(columns) {
                    less.extend(product.iter().zip(term).map(|(product, term)| product * term));
                }
            }
        }
        Self { terms, less, from }
    }

    /// Adds the values of several forms of the full degree, or of one less, to `out` (`[form][column]`).
    pub(super) fn add(
        &self,
        (forms, count): (&[f64], usize),
        one_less: bool,
        columns: usize,
        out: &mut [f64],
    ) {
        let kept = self.less.len() / columns.max(1);
        if one_less {
            return add_product(forms, &self.less, kept, out);
        }
        let products = forms.len() / count.max(1);
        let (terms, less, from) = (&self.terms[..], &self.less[..], &self.from[..]);
        Values { forms, products, terms, less, from, columns, out }.add();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Evaluates every sequence separately.
    fn plainly(coefficients: &[f64], terms: &[f64], degree: u32) -> f64 {
        let value = |(sequence, coefficient): (usize, &f64)| {
            let mut rest = sequence;
            (0..degree).fold(*coefficient, |product, _| {
                let term = terms[rest % terms.len()];
                rest /= terms.len();
                product * term
            })
        };
        coefficients.iter().enumerate().map(value).sum()
    }

    /// A polynomial of degree d has exact derivatives by d + 1 differences.
    #[test]
    fn slopes_equal_derivatives_of_polynomial() {
        for (terms, degree) in [(1_usize, 2_u32), (1, 5), (4, 2), (3, 4)] {
            let coefficients: Vec<f64> = (0..terms.pow(degree)).map(|k| (k * k % 23) as f64 - 9.0).collect();
            let (places, less) = (Places::new(terms, degree), Places::new(terms, degree - 1));
            let slopes = places.differentiated(&places.folded(&coefficients), &less, terms, degree);
            let values: Vec<f64> = (0..terms).map(|k| 0.3 + 0.1 * k as f64).collect();
            let products = Products::new(values.clone(), 1, degree);
            let mut found = vec![0.0; terms];
            products.add((&slopes, terms), true, 1, &mut found);
            for (term, found) in found.iter().enumerate() {
                let at = |x: f64| {
                    let mut values = values.clone();
                    values[term] += x;
                    plainly(&coefficients, &values, degree)
                };
                let differences = [1.0, 2.0, 3.0].map(|x| (at(x) - at(-x)) / 2.0);
                let truth = 1.5 * differences[0] - 0.3 * differences[1] + differences[2] / 30.0;
                assert!((found - truth).abs() < 1e-9 * truth.abs().max(1.0), "{terms} {degree}");
            }
        }
    }

    #[test]
    fn folded_forms_equal_sums_of_sequences() {
        for (terms, degree) in [(1_usize, 2_u32), (1, 5), (4, 2), (3, 4), (2, 7)] {
            // Two forms at three columns.
            let size = terms.pow(degree);
            let both = [23, 19]
                .map(|modulus| -> Vec<f64> { (0..size).map(|k| (k * k % modulus) as f64 - 9.0).collect() });
            let values: Vec<f64> = (0..3 * terms).map(|k| 0.3 + 0.1 * k as f64).collect();
            let products = Products::new(values.clone(), 3, degree);
            let mut found = vec![0.0; 6];
            let places = Places::new(terms, degree);
            let folded = both.each_ref().map(|one| places.folded(one)).concat();
            products.add((&folded, 2), false, 3, &mut found);
            let mut less = vec![0.0; 3];
            let smaller = &both[0][..terms.pow(degree - 1)];
            products.add((&Places::new(terms, degree - 1).folded(smaller), 1), true, 3, &mut less);
            for column in 0..3 {
                let at: Vec<f64> = values[column..].iter().step_by(3).copied().collect();
                for form in 0..2 {
                    let truth = plainly(&both[form], &at, degree);
                    assert!((found[form * 3 + column] - truth).abs() < 1e-9 * truth.abs().max(1.0));
                }
                let truth = plainly(smaller, &at, degree - 1);
                assert!((less[column] - truth).abs() < 1e-9 * truth.abs().max(1.0));
            }
        }
    }
}
