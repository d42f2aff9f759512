//! Tables of a film's reflectances over cos(theta) in the glass, on few nodes.
//!
//! On a panel of the table the reflectance is a polynomial through as many points of Chebyshev's.
//! Its Chebyshev coefficients fall off geometrically (Trefethen, *Approximation Theory and
//! Approximation Practice*, theorem 8.2): the last of them tell how large those are that it lacks. Panels
//! that lack too much are halved.

use std::f64::consts::PI;
use std::sync::Arc;

use papilio_transport::CosinePanels;

/// The interpolation error of a film pixel's table is below this reflectance, in
/// each gap, direction and wavelength, as far as the last coefficients of its panels tell. In panels narrower than 1/64, about a
/// critical angle, it may be larger, up to 1e-3, the more the narrower they are; in panels of 1e-6 it is not held.
pub const TABLE_ERROR: f64 = 1e-7;

/// Halvings of the panel from 0 to 1 to begin with, and at most. Between mirrors a thick gap has resonances close to its
/// critical angle that are far narrower than any fringe; what is narrower than the last halving holds no light.
const HALVINGS: (u32, u32) = (1, 20);

/// Panels of more halvings are narrow.
const NARROW: u32 = 6;

/// What any panel may lack.
const NARROW_ERROR: f64 = 1e-3;

/// The most panels. Films that need more have a hundred fringes over angle and more; they
/// are refused, for a table that is too coarse for them is wrong by any amount.
const MOST_PANELS: usize = 1024;

/// Panels, and the functions' values at their nodes.
type Table = (CosinePanels, Arc<[f64]>);

/// Panels fine enough for functions of the cosine, and the functions' values at the nodes,
/// `[node][function]`. `whole` computes them at these cosines, `sample` some of them: where those are
/// lacking, the others need not be known. Panels that are known to serve a function much like these
/// are not looked at by the sample; this changes the time that it takes, nothing else. `None` if it would take more than
/// [`MOST_PANELS`].
pub(super) fn panels<E>(
    known: Option<&CosinePanels>,
    sample: impl Fn(&[f64]) -> Result<Vec<f64>, E>,
    whole: impl Fn(&[f64]) -> Result<Vec<f64>, E>,
) -> Result<Option<Table>, E> {
    let last = last_polynomials();
    let suffice = |panel: &Panel, values: &[f64]| lacking(values, &last) < panel.tolerance();
    let mut done: Vec<Panel> = Vec::new();
    let mut open: Vec<Panel> = (0..1 << HALVINGS.0).rev().map(|k| Panel::new(k, HALVINGS.0)).collect();
    while let Some(mut panel) = open.pop() {
        let nodes: Vec<f64> = panel.nodes().collect();
        let is_known = known.is_some_and(|known| known.holds(panel.start(), panel.width()));
        if is_known || suffice(&panel, &sample(&nodes)?) {
            panel.values = whole(&nodes)?;
            if suffice(&panel, &panel.values) {
                done.push(panel);
                continue;
            }
        }
        if panel.halvings == HALVINGS.1 || done.len() + open.len() + 2 > MOST_PANELS {
            return Ok(None);
        }
        open.extend([1, 0].map(|half| Panel::new(2 * panel.number + half, panel.halvings + 1)));
    }
    let panels = CosinePanels::new(&done.iter().map(|panel| panel.halvings).collect::<Vec<u32>>());
    let count = done.iter().map(|panel| panel.values.len()).sum();
    let mut all: Arc<[f64]> = std::iter::repeat_n(0.0, count).collect();
    let mut rest = Arc::make_mut(&mut all);
    for panel in &done {
        let (here, beyond) = rest.split_at_mut(panel.values.len());
        here.copy_from_slice(&panel.values);
        rest = beyond;
    }
    Ok(Some((panels, all)))
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
        f64::from(self.number) * self.width()
    }

    fn width(&self) -> f64 {
        0.5_f64.powi(self.halvings as i32)
    }

    /// The largest error that is left: [`TABLE_ERROR`], but in narrow panels more. There may be a critical angle, a square root,
    /// which polynomials close in on by narrower panels alone; what they lack there is a part of ever less light. Of the last
    /// halving, a millionth of all cosines, any reflectance serves.
    fn tolerance(&self) -> f64 {
        if self.halvings == HALVINGS.1 {
            return 1.0;
        }
        (TABLE_ERROR * 4.0_f64.powi(self.halvings.saturating_sub(NARROW) as i32)).min(NARROW_ERROR)
    }

    fn nodes(&self) -> impl Iterator<Item = f64> + use<> {
        CosinePanels::nodes_between(self.start(), self.start() + self.width())
    }
}

/// Of how many coefficients at the end the pace is taken.
const LAST: usize = 4;

/// What makes the last coefficients of the values at a panel's nodes, in its lower half; in the upper
/// half it is the same for even degrees, and the opposite for odd ones.
fn last_polynomials() -> [[f64; LAST]; HALF] {
    let count = CosinePanels::NODES as f64;
    std::array::from_fn(|node| {
        std::array::from_fn(|k| {
            let degree = count - (LAST - k) as f64;
            2.0 / count * (degree * PI * (node as f64 + 0.5) / count).cos()
        })
    })
}

const HALF: usize = CosinePanels::NODES / 2;

/// Functions that are looked at together.
const TOGETHER: usize = 32;

/// An estimate of the largest error of the polynomials through these values, `[node][function]`.
fn lacking(values: &[f64], last: &[[f64; LAST]; HALF]) -> f64 {
    let functions = values.len() / CosinePanels::NODES;
    let mut worst = 0.0_f64;
    for first in (0..functions).step_by(TOGETHER) {
        let count = TOGETHER.min(functions - first);
        let row = |node: usize| &values[node * functions + first..][..count];
        let [mut a, mut b, mut c, mut d] = [[0.0; TOGETHER]; LAST];
        for (node, [p, q, r, s]) in last.iter().enumerate() {
            let (lower, upper) = (row(node), row(CosinePanels::NODES - 1 - node));
            for k in 0..count {
                let (even, odd) = (lower[k] + upper[k], lower[k] - upper[k]);
                a[k] += p * even;
                b[k] += q * odd;
                c[k] += r * even;
                d[k] += s * odd;
            }
        }
        worst = (0..count).map(|k| lacking_of([a[k], b[k], c[k], d[k]])).fold(worst, f64::max);
    }
    worst
}

/// The estimate for a function of these last coefficients.
fn lacking_of([a, b, c, d]: [f64; LAST]) -> f64 {
    let (before, last) = (a.abs() + b.abs(), c.abs() + d.abs());
    // The rest of a geometric series, in pairs of terms; what is left out of it reappears, at the
    // nodes, as much again.
    let rest = if 2.0 * last < before { last / (before - last) } else { 1.0 };
    2.0 * last * rest
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
            let (panels, values) = panels(None, at, at).unwrap().unwrap();
            let error = largest_error(&panels, &values, function);
            assert!(error < TABLE_ERROR, "{number}: {error}");
            assert!(panels.count() <= most * CosinePanels::NODES, "{number}: {}", panels.count());
        }
    }

    /// Where a sample sees nothing, the whole is looked at, and so is it where panels are known.
    #[test]
    fn neither_a_sample_nor_known_panels_change_anything() {
        let smooth = |c: f64| 0.3 + 0.1 * c;
        let sharp = |c: f64| 0.1 / (1.0 + ((c - 0.8) / 0.02).powi(2));
        let whole =
            |cosines: &[f64]| Ok::<_, ()>(cosines.iter().flat_map(|c| [smooth(*c), sharp(*c)]).collect());
        let blind = |cosines: &[f64]| Ok(cosines.iter().map(|c| smooth(*c)).collect());
        let plain = panels(None, whole, whole).unwrap();
        assert_eq!(panels(None, blind, whole).unwrap(), plain);
        let plain = plain.unwrap();
        for known in [&[1_u32, 1][..], &[2, 2, 3, 3, 2], &[5; 32]] {
            assert_eq!(panels(Some(&CosinePanels::new(known)), whole, whole).unwrap().unwrap(), plain);
        }
        assert_eq!(panels(Some(&plain.0), whole, whole).unwrap().unwrap(), plain);
    }

    /// A resonance a hundred thousandth wide is found if fringes around it lead there, and a square root's
    /// error is small where it is not tiny.
    #[test]
    fn narrow_resonances_and_critical_angles_are_closed_in_on() {
        let resonance = |c: f64| {
            0.5 + 0.4 / (1.0 + ((c - 0.745) / 1e-5).powi(2)) + 0.1 / (1.0 + ((c - 0.745) / 1e-3).powi(2))
        };
        let at = |cosines: &[f64]| Ok::<_, ()>(cosines.iter().map(|c| resonance(*c)).collect());
        let (panels_of_it, values) = panels(None, at, at).unwrap().unwrap();
        let error = largest_error(&panels_of_it, &values, resonance);
        assert!(error < NARROW_ERROR, "{error}");
        let critical = |c: f64| if c < 0.745 { 1.0 } else { 1.0 - (c - 0.745_f64).sqrt() };
        let at = |cosines: &[f64]| Ok::<_, ()>(cosines.iter().map(|c| critical(*c)).collect());
        let (panels_of_it, values) = panels(None, at, at).unwrap().unwrap();
        // Coefficients of a square root fall off as a power: a geometric series is an estimate from below.
        let error = largest_error(&panels_of_it, &values, critical);
        assert!(error < 2.0 * NARROW_ERROR, "{error}");
    }

    #[test]
    fn films_with_thousands_of_fringes_have_no_table() {
        let fringes = |c: f64| 0.5 + 0.5 * (30_000.0 * c).cos();
        let at = |cosines: &[f64]| Ok::<_, ()>(cosines.iter().map(|c| fringes(*c)).collect());
        assert!(panels(None, at, at).unwrap().is_none());
    }
}
