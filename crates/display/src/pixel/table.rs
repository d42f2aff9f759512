//! Tables of a film's reflectances over cos(theta) in the glass, on few nodes.
//!
//! On a panel of the table the reflectance is a polynomial through as many points of Chebyshev's.
//! Its Chebyshev coefficients fall off geometrically (Trefethen, *Approximation Theory and
//! Approximation Practice*, theorem 8.2): the last of them tell how large those are that it lacks. Panels
//! that lack too much are halved.

use std::f64::consts::PI;

use papilio_transport::CosinePanels;

/// The interpolation error of a film pixel's table is below this reflectance, in
/// each gap, direction and wavelength, as far as the last coefficients of its panels tell.
pub const TABLE_ERROR: f64 = 1e-7;

/// Halvings of the panel from 0 to 1 to begin with, and at most: only extremely thick films need more.
const HALVINGS: (u32, u32) = (1, 6);

/// Panels fine enough for functions of the cosine, so many in number, and the functions' values at the
/// nodes, `[node][function]`. `at` computes them at these cosines.
pub(super) fn panels<E>(
    functions: usize,
    at: impl Fn(&[f64]) -> Result<Vec<f64>, E>,
) -> Result<(CosinePanels, Vec<f64>), E> {
    let size = CosinePanels::NODES * functions;
    let last = last_polynomials();
    let mut done: Vec<Panel> = Vec::new();
    let mut open: Vec<Panel> = (0..1 << HALVINGS.0).map(|number| Panel::new(number, HALVINGS.0)).collect();
    while !open.is_empty() {
        let cosines: Vec<f64> = open.iter().flat_map(Panel::nodes).collect();
        let known = at(&cosines)?;
        let mut halves = Vec::new();
        for (mut panel, values) in open.into_iter().zip(known.chunks_exact(size)) {
            if panel.halvings == HALVINGS.1 || lacking(values, functions, &last) < TABLE_ERROR {
                panel.values = values.to_vec();
                done.push(panel);
            } else {
                halves.extend([0, 1].map(|half| Panel::new(2 * panel.number + half, panel.halvings + 1)));
            }
        }
        open = halves;
    }
    done.sort_by(|a, b| a.start().total_cmp(&b.start()));
    let panels = CosinePanels::new(&done.iter().map(|panel| panel.halvings).collect::<Vec<u32>>());
    Ok((panels, done.into_iter().flat_map(|panel| panel.values).collect()))
}

/// A panel in the making: the one of this number, of those of its width.
struct Panel {
    number: u32,
    halvings: u32,
    values: Vec<f64>,
}

impl Panel {
    fn new(number: u32, halvings: u32) -> Self {
        Self { number, halvings, values: Vec::new() }
    }

    fn start(&self) -> f64 {
        f64::from(self.number) * 0.5_f64.powi(self.halvings as i32)
    }

    fn nodes(&self) -> impl Iterator<Item = f64> + use<> {
        CosinePanels::nodes_between(self.start(), self.start() + 0.5_f64.powi(self.halvings as i32))
    }
}

/// Of how many coefficients at the end the pace is taken.
const LAST: usize = 4;

/// What makes the last coefficients of the values at a panel's nodes.
fn last_polynomials() -> [[f64; CosinePanels::NODES]; LAST] {
    let count = CosinePanels::NODES;
    std::array::from_fn(|k| {
        let degree = (count - LAST + k) as f64;
        std::array::from_fn(|node| {
            2.0 / count as f64 * (degree * PI * (node as f64 + 0.5) / count as f64).cos()
        })
    })
}

/// An estimate of the largest error of the polynomials through these values, `[node][function]`.
fn lacking(values: &[f64], functions: usize, last: &[[f64; CosinePanels::NODES]; LAST]) -> f64 {
    let coefficients = last.map(|polynomial| {
        let mut sum = vec![0.0; functions];
        for (row, weight) in values.chunks_exact(functions).zip(polynomial) {
            sum.iter_mut().zip(row).for_each(|(sum, value)| *sum += weight * value);
        }
        sum
    });
    let [a, b, c, d] = &coefficients;
    let one = |k: usize| {
        let (before, last) = (a[k].abs() + b[k].abs(), c[k].abs() + d[k].abs());
        // The rest of a geometric series, in pairs of terms; what is left out of it reappears, at the
        // nodes, as much again.
        let rest = if 2.0 * last < before { last / (before - last) } else { 1.0 };
        2.0 * last * rest
    };
    (0..functions).map(one).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of a table by the second barycentric formula, next to the true ones.
    fn largest_error(panels: &CosinePanels, values: &[f64], truth: impl Fn(f64) -> f64) -> f64 {
        let nodes: Vec<f64> = panels.nodes().collect();
        let mut worst = 0.0_f64;
        for (x, y) in nodes.chunks(CosinePanels::NODES).zip(values.chunks(CosinePanels::NODES)) {
            for step in 0..=200 {
                let at = x[0] + (x[x.len() - 1] - x[0]) * (f64::from(step) + 0.123) / 201.0;
                let weight = |k: usize| {
                    let sine = (PI * (k as f64 + 0.5) / x.len() as f64).sin();
                    if k.is_multiple_of(2) { sine / (at - x[k]) } else { -sine / (at - x[k]) }
                };
                let (mut sum, mut all) = (0.0, 0.0);
                (0..x.len()).for_each(|k| (sum, all) = (sum + weight(k) * y[k], all + weight(k)));
                worst = worst.max((sum / all - truth(at)).abs());
            }
        }
        worst
    }

    #[test]
    fn errors_are_within_what_is_claimed() {
        let resonance = |width: f64, c: f64| 0.5 + 0.4 / (1.0 + ((c - 0.8) / width).powi(2));
        type Function<'a> = &'a dyn Fn(f64) -> f64;
        let functions: [(Function<'_>, usize); 6] = [
            (&|_| 0.3, 2),
            (&|c| 0.5 + 0.5 * (9.0 * c).cos(), 2),
            (&|c| 0.5 + 0.5 * (90.0 * c).cos(), 16),
            (&|c| resonance(0.1, c), 6),
            (&|c| resonance(0.02, c), 12),
            (&|c| 0.1 / (c + 0.05), 6),
        ];
        for (number, (function, most)) in functions.into_iter().enumerate() {
            let at = |cosines: &[f64]| Ok::<_, ()>(cosines.iter().map(|c| function(*c)).collect());
            let (panels, values) = panels(1, at).unwrap();
            let error = largest_error(&panels, &values, function);
            assert!(error < TABLE_ERROR, "{number}: {error}");
            assert!(panels.count() <= most * CosinePanels::NODES, "{number}: {}", panels.count());
        }
    }
}
