//! Tables of a film's reflectances over cos(theta) in the glass, with few nodes.
//!
//! On each panel of the table the reflectance is interpolated by a polynomial through Chebyshev points.
//! Its Chebyshev coefficients decrease geometrically (Trefethen, *Approximation Theory and
//! Approximation Practice*, theorem 8.2), so that the last of them give an estimate of the missing ones.
//! Panels whose estimate is too large are halved.

use std::f64::consts::PI;
use std::sync::Arc;

use papilio_transport::CosinePanels;

/// Upper limit of the interpolation error of a film pixel's table, as a reflectance, for each gap, direction
/// and wavelength, as estimated from the last coefficients of its panels. A view of a mirror image sees one
/// direction alone, so that the limit is the same for panels of any width, except for those of the last
/// halving, a millionth of all cosines, which have none: there is one at each critical angle of a transparent
/// substrate, where the reflectance has a square root.
///
/// A resonance between nodes is not missed unless it is narrower than about 3e-4 of their distance: else the nodes on
/// its slopes, which decrease as the square of the distance, differ by more than this limit from a polynomial. Its
/// angle depends on the wavelength, so that at some of many wavelengths a node is close to it. Tables of few
/// wavelengths begin with more panels instead.
pub const TABLE_ERROR: f64 = 1e-7;

/// Smallest initial and largest number of halvings of the panel from 0 to 1. Between mirrors a thick gap has
/// resonances near its critical angle that are far narrower than any fringe; those narrower than the last
/// halving contain hardly any light.
const HALVINGS: (u32, u32) = (1, 20);

/// Number of halvings above which panels are those of resonances and critical angles, whose last coefficients decrease irregularly: of their
/// estimated error, up to 8 times too small, only this fraction of the limit is allowed.
const NARROW: u32 = 6;
const MARGIN: f64 = 0.1;

/// Smallest number of values of the initial panels, for one gap at all wavelengths: resonances wider than about 1e-6 are found.
const FIRST_VALUES: usize = 960;

/// Largest number of panels, and of values. Films that need more have more than about 150 fringes over
/// angle, or fewer and sharper ones. They are refused, because the error of a table that is too coarse is
/// unlimited.
const MOST_PANELS: usize = 2048;
const MOST_VALUES: usize = 100_000_000;

/// Panels, with the values of the functions at their nodes.
type Table = (CosinePanels, Arc<[f64]>);

/// Returns panels that are fine enough for functions of the cosine, with the values of the functions at the
/// nodes, `[node][function]`. `whole` computes all functions at these cosines, `sample` some of them: if
/// their error is too large, the others need not be computed. Panels in `known`, which suffice for similar
/// functions, skip the sample; this affects the time only, not the result. The functions are those of so many `gaps` at so many
/// `wavelengths`. `None` if they need more than [`MOST_PANELS`] or [`MOST_VALUES`].
pub(super) fn panels<E>(
    [gaps, wavelengths]: [usize; 2],
    known: Option<&CosinePanels>,
    sample: impl Fn(&[f64]) -> Result<Vec<f64>, E>,
    whole: impl Fn(&[f64]) -> Result<Vec<f64>, E>,
) -> Result<Option<Table>, E> {
    let first = FIRST_VALUES.div_ceil(wavelengths.max(1) * CosinePanels::NODES).next_power_of_two().ilog2();
    let limits = (|_| TABLE_ERROR, most_panels([gaps, wavelengths]));
    panels_from(first.max(HALVINGS.0), limits, known, sample, whole)
}

/// Returns the largest number of panels of so many gaps at so many wavelengths.
pub(super) fn most_panels([gaps, wavelengths]: [usize; 2]) -> usize {
    let values_of_panel = gaps.max(1) * wavelengths.max(1) * CosinePanels::NODES;
    MOST_PANELS.min(MOST_VALUES / values_of_panel)
}

/// Returns the same within another error than [`TABLE_ERROR`], given the upper end of a panel, with at most this number of panels.
pub(super) fn panels_within<E>(
    limits: (impl Fn(f64) -> f64, usize),
    known: Option<&CosinePanels>,
    sample: impl Fn(&[f64]) -> Result<Vec<f64>, E>,
    whole: impl Fn(&[f64]) -> Result<Vec<f64>, E>,
) -> Result<Option<Table>, E> {
    panels_from(HALVINGS.0, limits, known, sample, whole)
}

/// Returns the same from panels of this number of halvings on.
fn panels_from<E>(
    first: u32,
    (error, most): (impl Fn(f64) -> f64, usize),
    known: Option<&CosinePanels>,
    sample: impl Fn(&[f64]) -> Result<Vec<f64>, E>,
    whole: impl Fn(&[f64]) -> Result<Vec<f64>, E>,
) -> Result<Option<Table>, E> {
    let last = last_polynomials();
    let suffice = |panel: &Panel, values: &[f64]| {
        let margin = if panel.halvings > NARROW { MARGIN } else { 1.0 };
        let most = margin * error(panel.start() + panel.width());
        panel.halvings == HALVINGS.1 || estimated_error(values, &last) < most
    };
    let mut done: Vec<Panel> = Vec::new();
    let mut open: Vec<Panel> = (0..1 << first).rev().map(|k| Panel::new(k, first)).collect();
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
        if panel.halvings == HALVINGS.1 || done.len() + open.len() + 2 > most.min(MOST_PANELS) {
            return Ok(None);
        }
        open.extend([1, 0].map(|half| Panel::new(2 * panel.number + half, panel.halvings + 1)));
    }
    Ok(Some(joined(done)))
}

/// Returns the table of panels in ascending order. Each panel is released as it is copied: large tables are not in memory twice.
fn joined(done: Vec<Panel>) -> Table {
    let panels = CosinePanels::new(&done.iter().map(|panel| panel.halvings).collect::<Vec<u32>>());
    let count = done.iter().map(|panel| panel.values.len()).sum();
    let mut values: Arc<[f64]> = std::iter::repeat_n(0.0, count).collect();
    let mut rest: &mut [f64] = Arc::make_mut(&mut values);
    for panel in done {
        let (own, later) = rest.split_at_mut(panel.values.len());
        own.copy_from_slice(&panel.values);
        rest = later;
    }
    (panels, values)
}

/// Candidate panel: the one of this number among those of its width.
pub(super) struct Panel {
    pub(super) number: u32,
    pub(super) halvings: u32,
    /// Values of the functions at the nodes, `[node][function]`.
    pub(super) values: Vec<f64>,
}

impl Panel {
    pub(super) fn new(number: u32, halvings: u32) -> Self {
        Self { number, halvings, values: Vec::new() }
    }

    pub(super) fn start(&self) -> f64 {
        f64::from(self.number) * self.width()
    }

    pub(super) fn width(&self) -> f64 {
        0.5_f64.powi(self.halvings as i32)
    }

    pub(super) fn nodes(&self) -> impl Iterator<Item = f64> + use<> {
        CosinePanels::nodes_between(self.start(), self.start() + self.width())
    }
}

/// Number of last coefficients from which the rate of decrease is estimated.
const LAST: usize = 4;

/// Matrix from the values at a panel's nodes to its last coefficients, for the lower half of the nodes; for
/// the upper half it is the same for even degrees, and has the opposite sign for odd ones.
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

/// Number of functions that are processed together.
const TOGETHER: usize = 32;

/// Estimates the largest error of the polynomials through these values, `[node][function]`.
fn estimated_error(values: &[f64], last: &[[f64; LAST]; HALF]) -> f64 {
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
        worst = (0..count).map(|k| error_of_coefficients([a[k], b[k], c[k], d[k]])).fold(worst, f64::max);
    }
    worst
}

/// Estimates the error of a function with these last coefficients.
fn error_of_coefficients([a, b, c, d]: [f64; LAST]) -> f64 {
    let (before, last) = (a.abs() + b.abs(), c.abs() + d.abs());
    // Remainder of a geometric series in pairs of terms. Aliasing at the nodes doubles the error of
    // the truncated terms.
    let rest = if 2.0 * last < before { last / (before - last) } else { 1.0 };
    2.0 * last * rest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tables of many wavelengths begin with few panels.
    const MANY: [usize; 2] = [1, 100];

    /// Largest difference between the true values and the table, interpolated by the second barycentric
    /// formula.
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
    fn error_of_the_table_is_below_its_limit() {
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
            let (panels, values) = panels(MANY, None, at, at).unwrap().unwrap();
            let error = largest_error(&panels, &values, function);
            assert!(error < TABLE_ERROR, "{number}: {error}");
            assert!(panels.count() <= most * CosinePanels::NODES, "{number}: {}", panels.count());
        }
    }

    /// All functions are tested even if the sample is smooth, and for known panels.
    #[test]
    fn table_does_not_depend_on_the_sample_and_on_known_panels() {
        let smooth = |c: f64| 0.3 + 0.1 * c;
        let sharp = |c: f64| 0.1 / (1.0 + ((c - 0.8) / 0.02).powi(2));
        let whole =
            |cosines: &[f64]| Ok::<_, ()>(cosines.iter().flat_map(|c| [smooth(*c), sharp(*c)]).collect());
        let blind = |cosines: &[f64]| Ok(cosines.iter().map(|c| smooth(*c)).collect());
        let plain = panels(MANY, None, whole, whole).unwrap();
        assert_eq!(panels(MANY, None, blind, whole).unwrap(), plain);
        let plain = plain.unwrap();
        for known in [&[1_u32, 1][..], &[2, 2, 3, 3, 2], &[5; 32]] {
            assert_eq!(panels(MANY, Some(&CosinePanels::new(known)), whole, whole).unwrap().unwrap(), plain);
        }
        assert_eq!(panels(MANY, Some(&plain.0), whole, whole).unwrap().unwrap(), plain);
    }

    /// A resonance of width 1e-5 is resolved wherever it is, and the error of a square root is small outside the
    /// narrowest panels.
    #[test]
    fn narrow_resonances_and_critical_angles_are_resolved() {
        for place in [0.1, 0.3456, 0.745, 0.999] {
            let resonance = |c: f64| 0.5 + 0.4 / (1.0 + ((c - place) / 1e-5).powi(2));
            let at = |cosines: &[f64]| Ok::<_, ()>(cosines.iter().map(|c| resonance(*c)).collect());
            let (panels_of_it, values) = panels([1, 1], None, at, at).unwrap().unwrap();
            let error = largest_error(&panels_of_it, &values, resonance);
            assert!(error < TABLE_ERROR, "{place}: {error}");
            let nodes = panels_of_it.nodes().collect::<Vec<f64>>();
            let nearest = nodes.windows(2).filter(|pair| pair[0] <= place && place < pair[1]);
            assert!(nearest.map(|pair| pair[1] - pair[0]).all(|step| step < 1e-5), "{place}");
        }
        let critical = |c: f64| if c < 0.745 { 1.0 } else { 1.0 - (c - 0.745_f64).sqrt() };
        let at = |cosines: &[f64]| Ok::<_, ()>(cosines.iter().map(|c| critical(*c)).collect());
        let (panels_of_it, values) = panels(MANY, None, at, at).unwrap().unwrap();
        // Coefficients of a square root decrease as a power: a geometric series underestimates the error.
        let outside = |c: f64| (c - 0.745).abs() > 2e-6;
        for (is_near, limit) in [(true, 2e-3), (false, 2.0 * TABLE_ERROR)] {
            let truth = |c: f64| if is_near || outside(c) { critical(c) } else { f64::NAN };
            let error = largest_error(&panels_of_it, &values, truth);
            assert!(error < limit, "{is_near}: {error}");
        }
    }

    #[test]
    fn film_with_thousands_of_fringes_is_refused() {
        let fringes = |c: f64| 0.5 + 0.5 * (100_000.0 * c).cos();
        let at = |cosines: &[f64]| Ok::<_, ()>(cosines.iter().map(|c| fringes(*c)).collect());
        assert!(panels(MANY, None, at, at).unwrap().is_none());
    }
}
