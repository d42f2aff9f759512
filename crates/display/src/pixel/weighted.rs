//! Tables of a film's reflectances for known light: as many nodes over angle as X, Y and Z need.
//!
//! At a single wavelength the reflectance of a film has sharp structure over angle, above all where light grazes an air gap.
//! Little of it is left in what a reader sees: sums over wavelength blur it, a lobe sends little light there, and light that
//! is smooth over angle averages it. All these sums are linear in the table. Therefore only the smoothness of the reflectance
//! *weighted by the colour-matching functions* counts, not that at each wavelength.
//!
//! **Error.** On a panel with N nodes, let `a_k` be the Chebyshev coefficients of a weighted reflectance and `m_k` the moments
//! of the light, its integrals of T_k. The nodes cannot distinguish `T_(N+j)` from `-T_(N-j)` (Trefethen, *Approximation
//! Theory and Approximation Practice*, theorem 4.1), so that the error of the panel's light is the sum of
//! `a_(N+j) (m_(N+j) + m_(N-j))` over j. The missing `a` are extrapolated from the last six. Where the light is smooth, the
//! moments with which the largest of them are multiplied are small, as in a Gauss rule. The panel with the largest error is
//! halved until the sum of all errors is small enough.
//!
//! Recycled light is a product of reflectances, wavelength by wavelength. Its fraction of the error uses the mean magnitude
//! of the coefficients over wavelength, in which nothing cancels.

use std::collections::HashMap;
use std::sync::Arc;

use papilio_transport::CosinePanels;

use super::table::{Panel, Table, joined};

mod smoothness;

use smoothness::{Decay, NODES, PAIRS, colour_sums, last, roughness};

/// Halvings of the panels on which the light is given. Panels are not finer.
const FINEST: u32 = 5;

/// Halvings of the first panels, from grazing to normal incidence: they suffice for most films.
const FIRST: [u32; 4] = [1, 2, 3, 3];

/// Largest number of panels. Films that need more are tabulated as for all light.
const MOST_PANELS: usize = 20;

/// Y below which errors are relative to this instead of Y.
const FAINT: f64 = 0.01;

/// Number of Y among the quantities.
const LUMINOUS: usize = 1;

/// Light of one source that a view sees after one reflection.
#[derive(Debug, Clone)]
pub(crate) struct SeenLight {
    /// Number of the view. Lights of a view follow each other.
    pub(crate) view: usize,
    /// Weights of a reflectance in X, Y and Z, relative to Y of the white: `[quantity][wavelength]`.
    pub(crate) colour: Vec<Vec<f64>>,
    /// Weights on the nodes of [`WeightedNodes::light_nodes`].
    pub(crate) weights: Vec<f64>,
}

/// Nodes over angle for films in known light.
#[derive(Debug, Clone)]
pub(crate) struct WeightedNodes {
    tolerance: f64,
    recycled: f64,
    lights: Vec<Light>,
    /// The different weights over wavelength, `[colour][quantity][wavelength]`.
    colours: Vec<Vec<Vec<f64>>>,
    /// The lights on each panel that was used, by number and halvings.
    known: HashMap<(u32, u32), Arc<[LightOnPanel]>>,
}

#[derive(Debug, Clone)]
struct Light {
    view: usize,
    /// Number of its colour, and the factor of that colour.
    colour: usize,
    factor: f64,
    weights: Vec<f64>,
    /// Sum of the weights: the light if it were reflected completely.
    total: f64,
}

/// Light of one source on one panel.
#[derive(Debug)]
struct LightOnPanel {
    /// Weights on the nodes.
    weights: [f64; NODES],
    /// Factors of missing coefficients in the error.
    aliases: Aliases,
    /// The same for recycled light, which comes from all directions as well.
    recycled: Aliases,
}

/// Factors of the missing coefficients N and N + 1, N + 2 and N + 3, ... in the error; the last one is that of all others.
type Aliases = [f64; PAIRS + 1];

/// Panel with the colours of its values.
struct Evaluated {
    panel: Panel,
    /// Y of each light, `[light][gap]`.
    luminous: Vec<f64>,
    /// Error of each quantity, `[light][quantity][gap]`.
    errors: Vec<f64>,
}

/// Area fractions `[state][gap]` and number of gaps.
pub(crate) type Fractions<'a> = (&'a [f64], usize);

impl WeightedNodes {
    /// Returns the nodes on which light is given.
    pub(crate) fn light_nodes() -> CosinePanels {
        CosinePanels::new(&[FINEST; 1 << FINEST])
    }

    /// Prepares nodes for errors of X, Y and Z of at most the fraction `tolerance` of Y, or of 0.01 if Y is less, in these
    /// lights; `recycled` is an upper bound of the fraction of light that meets the film again.
    pub(crate) fn new(lights: Vec<SeenLight>, recycled: f64, tolerance: f64) -> Self {
        let mut colours: Vec<Vec<Vec<f64>>> = Vec::new();
        let lights = lights.into_iter().map(|SeenLight { view, colour, weights }| {
            let known = colours.iter().enumerate();
            let found = known.into_iter().find_map(|(k, known)| Some((k, ratio(&colour, known)?)));
            let (colour, factor) = found.unwrap_or_else(|| {
                colours.push(colour);
                (colours.len() - 1, 1.0)
            });
            Light { view, colour, factor, total: weights.iter().sum(), weights }
        });
        let lights = lights.collect();
        Self { tolerance, recycled, lights, colours, known: HashMap::new() }
    }

    /// Tabulates a film whose reflectances at some cosines are `[cosine][gap][wavelength]`; `None` if it needs more nodes than
    /// are available here.
    pub(crate) fn table<E>(
        &mut self,
        fractions: Fractions<'_>,
        film: impl Fn(&[f64]) -> Result<Vec<f64>, E>,
    ) -> Result<Option<Table>, E> {
        let mut panels = Vec::with_capacity(MOST_PANELS);
        let mut place = 0.0;
        for halvings in FIRST {
            let number = (place * f64::from(1 << halvings)) as u32;
            let panel = Panel::new(number, halvings);
            place += panel.width();
            panels.push(self.evaluated(panel, fractions.1, &film)?);
        }
        while let Some(worst) = self.insufficient(&panels, fractions) {
            let Panel { number, halvings, .. } = panels[worst].panel;
            if halvings == FINEST || panels.len() == MOST_PANELS {
                return Ok(None);
            }
            let [low, high] = [0, 1].map(|half| Panel::new(2 * number + half, halvings + 1));
            let halves =
                [self.evaluated(low, fractions.1, &film)?, self.evaluated(high, fractions.1, &film)?];
            panels.splice(worst..=worst, halves);
        }
        let panels: Vec<Panel> = panels.into_iter().map(|one| one.panel).collect();
        Ok(Some(joined(&panels)))
    }

    /// Returns the panel with the largest error if the sum of the errors of all panels is too large.
    fn insufficient(&self, panels: &[Evaluated], (fractions, gaps): Fractions<'_>) -> Option<usize> {
        let quantities = self.colours.first().map_or(0, Vec::len);
        let (mut worst, mut most) = (None, self.tolerance);
        let mut first = 0;
        for lights in self.lights.chunk_by(|one, next| one.view == next.view) {
            let numbers = first..first + lights.len();
            first = numbers.end;
            for shares in fractions.chunks_exact(gaps) {
                let mixed = |values: &[f64]| -> f64 { values.iter().zip(shares).map(|(v, s)| v * s).sum() };
                let y = |one: &Evaluated| -> f64 {
                    numbers.clone().map(|light| mixed(&one.luminous[light * gaps..][..gaps])).sum()
                };
                let y = panels.iter().map(y).sum::<f64>().max(FAINT);
                for quantity in 0..quantities {
                    let error = |one: &Evaluated, light: usize| {
                        mixed(&one.errors[(light * quantities + quantity) * gaps..][..gaps]) / y
                    };
                    let errors: Vec<f64> = panels
                        .iter()
                        .map(|one| numbers.clone().map(|light| error(one, light)).sum())
                        .collect();
                    let sum: f64 = errors.iter().sum();
                    if sum > most || sum.is_nan() {
                        most = sum;
                        worst = (0..panels.len()).max_by(|a, b| errors[*a].total_cmp(&errors[*b]));
                    }
                }
            }
        }
        worst
    }

    fn evaluated<E>(
        &mut self,
        mut panel: Panel,
        gaps: usize,
        film: &impl Fn(&[f64]) -> Result<Vec<f64>, E>,
    ) -> Result<Evaluated, E> {
        let nodes: Vec<f64> = panel.nodes().collect();
        panel.values = film(&nodes)?;
        let lights = self.lights_on(&panel);
        let rough = (self.recycled > 0.0).then(|| roughness(&panel.values, gaps));
        // Of each colour: the values, and the decay of their coefficients, `[quantity][gap]`.
        let of_colour = |colour: &Vec<Vec<f64>>| -> Vec<([f64; NODES], Decay)> {
            let sums = colour_sums(&panel.values, colour, gaps).into_iter();
            sums.map(|values| (values, Decay::of(last(&values)))).collect()
        };
        let colours: Vec<_> = self.colours.iter().map(of_colour).collect();
        let (mut luminous, mut errors) = (Vec::new(), Vec::new());
        for (one, light) in self.lights.iter().zip(&*lights) {
            let values = &colours[one.colour];
            let seen = |values: &[f64; NODES]| -> f64 {
                values.iter().zip(&light.weights).map(|(v, w)| v * w).sum()
            };
            let of_gaps = values[LUMINOUS * gaps..][..gaps].iter();
            luminous.extend(of_gaps.map(|(values, _)| one.factor * seen(values)));
            for (of_gaps, weights) in values.chunks_exact(gaps).zip(&self.colours[one.colour]) {
                let white = 2.0 * self.recycled * weights.iter().sum::<f64>();
                for (gap, (_, decay)) in of_gaps.iter().enumerate() {
                    let again = rough.as_ref().map_or(0.0, |rough| white * rough[gap].error(&light.recycled));
                    errors.push(one.factor * (decay.error(&light.aliases) + again));
                }
            }
        }
        Ok(Evaluated { panel, luminous, errors })
    }

    fn lights_on(&mut self, panel: &Panel) -> Arc<[LightOnPanel]> {
        let key = (panel.number, panel.halvings);
        if let Some(known) = self.known.get(&key) {
            return Arc::clone(known);
        }
        let inside = NODES << (FINEST - panel.halvings);
        let first = panel.number as usize * inside;
        let nodes: Vec<f64> = Self::light_nodes().nodes().skip(first).take(inside).collect();
        let made: Arc<[LightOnPanel]> = self
            .lights
            .iter()
            .map(|light| LightOnPanel::new(panel, &nodes, (&light.weights[first..][..inside], light.total)))
            .collect();
        self.known.insert(key, Arc::clone(&made));
        made
    }
}

impl LightOnPanel {
    /// Computes the light on a panel from its weights on finer nodes.
    fn new(panel: &Panel, nodes: &[f64], (weights, total): (&[f64], f64)) -> Self {
        let (mut moments, mut uniform) = ([0.0; NODES], [0.0; NODES]);
        let each = panel.width() / nodes.len() as f64;
        for (cosine, weight) in nodes.iter().zip(weights) {
            let angle = (2.0 * (cosine - panel.start()) / panel.width() - 1.0).clamp(-1.0, 1.0).acos();
            for (k, (moment, uniform)) in moments.iter_mut().zip(&mut uniform).enumerate() {
                let polynomial = (k as f64 * angle).cos();
                *moment += weight * polynomial;
                // By projected area.
                *uniform += 2.0 * cosine * each * total * polynomial;
            }
        }
        let aliases = aliases(&moments);
        let recycled = std::array::from_fn(|k| aliases[k] + self::aliases(&uniform)[k]);
        Self { weights: smoothness::node_weights(&moments), aliases, recycled }
    }
}

fn aliases(moments: &[f64; NODES]) -> Aliases {
    let size = |k: usize| moments[k.min(NODES - 1)].abs();
    // Moments of the missing degrees are not known, and are not larger than the last ones.
    let missing = size(NODES - 2).max(size(NODES - 1));
    std::array::from_fn(|pair| {
        let degree = NODES - 2 * pair;
        missing + if degree == 0 { size(0) } else { size(degree).max(size(degree - 1)) }
    })
}

/// Returns the factor by which one colour is a multiple of another; `None` if it is not.
fn ratio(colour: &[Vec<f64>], other: &[Vec<f64>]) -> Option<f64> {
    /// Rounding errors of normalised spectra.
    const ROUNDING: f64 = 1e-12;
    let sum = |colour: &[Vec<f64>]| colour.iter().flatten().sum::<f64>();
    let factor = sum(colour) / sum(other);
    let mut pairs = colour.iter().flatten().zip(other.iter().flatten());
    let is_multiple = |(a, b): (&f64, &f64)| (a - factor * b).abs() <= ROUNDING * a.abs().max(b.abs());
    (factor.is_finite() && pairs.all(is_multiple)).then_some(factor)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests express expectations by unwrapping")]
mod tests {
    use super::*;

    /// Light around the cosine 0.97, with a tail to all others.
    fn light() -> Vec<f64> {
        let each = 1.0 / WeightedNodes::light_nodes().count() as f64;
        WeightedNodes::light_nodes()
            .nodes()
            .map(|c| each * (1.0 + ((c - 0.97) / 0.01).powi(2)).powf(-1.5))
            .collect()
    }

    /// Returns the number of nodes, and the error of the light that a film of one wavelength reflects; `None` if it takes the
    /// full table.
    fn error(tolerance: f64, film: impl Fn(f64) -> f64) -> Option<(usize, f64)> {
        let seen = SeenLight { view: 0, colour: vec![vec![1.0]; 3], weights: light() };
        let mut nodes = WeightedNodes::new(vec![seen], 0.0, tolerance);
        let at = |cosines: &[f64]| Ok::<_, ()>(cosines.iter().map(|c| film(*c)).collect());
        let (panels, values) = nodes.table((&[1.0], 1), at).unwrap()?;
        let mut sum = 0.0;
        for ([start, end], values) in borders(&panels).into_iter().zip(values.chunks_exact(NODES)) {
            let halvings = (1.0 / (end - start)).log2().round() as u32;
            let panel = Panel::new((start / (end - start)).round() as u32, halvings);
            let light = nodes.lights_on(&panel);
            sum += light[0].weights.iter().zip(values).map(|(w, v)| w * v).sum::<f64>();
        }
        let fine = WeightedNodes::light_nodes();
        let truth: f64 = fine.nodes().zip(light()).map(|(c, weight)| weight * film(c)).sum();
        Some((panels.count(), (sum - truth).abs() / truth.max(FAINT)))
    }

    /// Ends of the panels, from the nodes, which are symmetric within each.
    fn borders(panels: &CosinePanels) -> Vec<[f64; 2]> {
        let nodes: Vec<f64> = panels.nodes().collect();
        let mut start = 0.0;
        let end = |panel: &[f64]| {
            let from = start;
            start = panel[0] + panel[NODES - 1] - from;
            [from, start]
        };
        nodes.chunks_exact(NODES).map(end).collect()
    }

    /// Reflectance by cosine.
    type Film = Box<dyn Fn(f64) -> f64>;

    #[test]
    fn error_of_smooth_films_and_of_structure_is_below_the_tolerance() {
        let resonance = |at: f64, width: f64| move |c: f64| 0.2 + 0.5 / (1.0 + ((c - at) / width).powi(2));
        for tolerance in [1e-4, 1e-5, 1e-6] {
            let films: [(&str, Film); 6] = [
                ("constant", Box::new(|_| 0.3)),
                ("fringes", Box::new(|c| 0.5 + 0.4 * (20.0 * c).cos())),
                ("resonance in faint light", Box::new(resonance(0.76, 0.02))),
                ("resonance in the lobe", Box::new(resonance(0.965, 0.02))),
                ("narrow resonance in the lobe", Box::new(resonance(0.972, 0.003))),
                ("dark", Box::new(|c| 1e-4 * (1.0 + (9.0 * c).sin()))),
            ];
            for (name, film) in films {
                // The full table is always accurate.
                let Some((count, error)) = error(tolerance, film) else { continue };
                assert!(error < tolerance, "{name}: {error:e} for {tolerance:e} with {count} nodes");
            }
        }
        assert_eq!(error(1e-5, |c| 0.3 + 0.1 * c).unwrap().0, 64);
        assert!(error(1e-5, resonance(0.972, 0.003)).is_none_or(|(count, _)| count > 64));
        assert!(error(1e-5, |c| 0.5 + 0.5 * (3000.0 * c).cos()).is_none());
    }

    /// The same structure needs fewer nodes where there is little light.
    #[test]
    fn nodes_are_where_the_light_is() {
        let structure = |at: f64| move |c: f64| 0.2 + 0.3 / (1.0 + ((c - at) / 0.02).powi(2));
        let [faint, bright] =
            [0.7, 0.965].map(|at| error(1e-5, structure(at)).map_or(usize::MAX, |found| found.0));
        assert!(faint < bright, "{faint} {bright}");
    }
}
