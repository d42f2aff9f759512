//! Tables of a film's reflectances for known light: as many nodes over angle as X, Y and Z need.
//!
//! What is seen depends on a few sums of the reflectance over angle, with known weights. At grazing
//! incidence, where the structure of a film is sharpest, there is little light, and in the directions of a
//! lobe there is much. The panels are chosen for the light and the scene's own film ([`first`]): each has the
//! number of nodes that it needs.
//!
//! **Error.** On a panel with N nodes, let `a_k` be the Chebyshev coefficients of the reflectance at one
//! wavelength and `m_k` the moments of the light, its integrals of T_k. The nodes cannot distinguish
//! `T_(N+j)` from `-T_(N-j)` (Trefethen, *Approximation Theory and Approximation Practice*, theorem 4.1), so
//! that the error of the panel's light is the sum of `a_(N+j) (m_(N+j) + m_(N-j))` over j. The missing `a`
//! are extrapolated from the mean magnitude of the last six over wavelength, weighted by each colour-matching
//! function, as a geometric series ([`decay`]).
//!
//! Nothing cancels in this mean. It is therefore the error if those of all wavelengths have the same sign,
//! which they seldom have: X, Y and Z are mostly more exact by an order of magnitude or two. And it does not
//! miss a resonance between the nodes. The angle of a resonance depends on wavelength, so that it meets the
//! nodes at some wavelengths; in coefficients of X, Y and Z, which were used before, these contributions
//! cancel, and the errors of some films were twice the estimate. Structure at the critical angle of a gap is
//! at the same angle at all wavelengths. Panels end there ([`first`]), and the estimate is cautious
//! ([`decay`]).
//!
//! Where the sum of all errors is too large, the panel with the largest error takes more nodes, and is halved
//! if it has the most.

use std::collections::HashMap;
use std::sync::Arc;

use papilio_transport::CosinePanels;

mod decay;
mod first;
mod rule;

use decay::{Decay, dots, weighted_rows};
use rule::{FineLight, Panel, Rule};

/// Halvings of the panels on which the light is given.
const FINEST: u32 = 5;

/// Number of parts of 0 to 1 of which panels are made. Each has [`CosinePanels::NODES`] light nodes.
const PARTS: u32 = 1 << FINEST;

/// Largest number of nodes of a panel.
const MOST_OF_PANEL: usize = 18;

/// Nodes that a panel takes in addition where its error is too large.
const STEP: usize = 4;

/// Number of nodes of a half of a panel with the most nodes.
const COUNT_OF_HALF: usize = 12;

/// Largest number of nodes. Films that need more are tabulated as for all light.
const MOST_NODES: usize = 256;

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
    /// Number of the row with its weights.
    pub(crate) row: usize,
}

/// Nodes over angle for films in known light.
#[derive(Debug, Clone)]
pub(crate) struct WeightedNodes {
    tolerance: f64,
    recycled: f64,
    /// Weights of all sums on the light nodes, `[row][node]`.
    rows: Arc<[Vec<f64>]>,
    lights: Vec<Light>,
    /// The different weights over wavelength, `[colour][quantity][wavelength]`.
    colours: Vec<Vec<Vec<f64>>>,
    /// Panels that are tried first.
    first: Vec<Panel>,
    /// All sums on the nodes of the first panels.
    on_first: RowsOnNodes,
    /// The rules of all panels that were used.
    known: HashMap<Panel, Arc<Rule>>,
}

#[derive(Debug, Clone)]
struct Light {
    view: usize,
    /// Number of its colour, and the factor of that colour.
    colour: usize,
    factor: f64,
    row: usize,
    /// Sum of the weights: the light if it were reflected completely.
    total: f64,
}

/// Nodes of some panels and the weights of all sums there.
#[derive(Debug, Clone)]
struct RowsOnNodes {
    cosines: Arc<[f64]>,
    /// `[row][node]`.
    weights: Arc<[f64]>,
}

/// Panel with the errors of the light that it reflects.
struct Evaluated {
    panel: Panel,
    rule: Arc<Rule>,
    /// Y of each light, `[light][gap]`.
    luminous: Vec<f64>,
    /// Error of each quantity, `[light][quantity][gap]`.
    errors: Vec<f64>,
}

/// Area fractions `[state][gap]` and number of gaps.
pub(crate) type Fractions<'a> = (&'a [f64], usize);

/// Reflectances of a film on the nodes that the light needs, and the weights of all sums there.
#[derive(Debug, Clone)]
pub(crate) struct WeightedTable {
    pub(crate) cosines: Arc<[f64]>,
    /// `[node][gap][wavelength]`.
    pub(crate) values: Vec<f64>,
    /// `[row][node]`.
    pub(crate) weights: Arc<[f64]>,
}

impl WeightedNodes {
    /// Returns the nodes on which light is given.
    pub(crate) fn light_nodes() -> CosinePanels {
        CosinePanels::new(&[FINEST; 1 << FINEST])
    }

    /// Prepares nodes for sums with these weights on the light nodes, with errors of X, Y and Z of at most
    /// the fraction `tolerance` of Y, or of 0.01 if Y is less, in these lights; `recycled` is an upper bound
    /// of the fraction of light that meets the film again.
    pub(crate) fn new(rows: Vec<Vec<f64>>, lights: Vec<SeenLight>, recycled: f64, tolerance: f64) -> Self {
        let mut colours: Vec<Vec<Vec<f64>>> = Vec::new();
        let lights = lights.into_iter().map(|SeenLight { view, colour, row }| {
            let known = colours.iter().enumerate();
            let found = known.into_iter().find_map(|(k, known)| Some((k, ratio(&colour, known)?)));
            let (colour, factor) = found.unwrap_or_else(|| {
                colours.push(colour);
                (colours.len() - 1, 1.0)
            });
            Light { view, colour, factor, row, total: rows[row].iter().sum() }
        });
        let lights: Vec<Light> = lights.collect();
        let on_first = RowsOnNodes { cosines: Arc::new([]), weights: Arc::new([]) };
        let known = HashMap::new();
        let mut nodes = Self {
            tolerance,
            recycled,
            rows: rows.into(),
            lights,
            colours,
            first: Vec::new(),
            on_first,
            known,
        };
        nodes.start_from(first::for_any_film());
        nodes
    }

    /// Tabulates a film whose reflectances at some cosines are `[cosine][gap][wavelength]`; `None` if it
    /// needs more nodes than are available here.
    pub(crate) fn table<E>(
        &mut self,
        fractions: Fractions<'_>,
        film: impl Fn(&[f64]) -> Result<Vec<f64>, E>,
    ) -> Result<Option<WeightedTable>, E> {
        let RowsOnNodes { cosines, weights } = self.on_first.clone();
        let mut values = film(&cosines)?;
        let size = values.len() / cosines.len();
        let (mut panels, mut at) = (Vec::with_capacity(2 * self.first.len()), 0);
        for panel in self.first.clone() {
            let own = &values[at * size..][..panel.count * size];
            panels.push(self.evaluated(panel, fractions.1, own));
            at += panel.count;
        }
        if self.insufficient(&panels, fractions).is_none() {
            return Ok(Some(WeightedTable { cosines, values, weights }));
        }
        while let Some(worst) = self.insufficient(&panels, fractions) {
            let Some(finer) = panels[worst].panel.finer() else { return Ok(None) };
            let before: usize = panels[..worst].iter().map(|one| one.panel.count).sum();
            let own = before * size..(before + panels[worst].panel.count) * size;
            let (mut own_values, mut evaluated) = (Vec::new(), Vec::new());
            for panel in finer {
                let found = film(&self.rule(panel).cosines)?;
                evaluated.push(self.evaluated(panel, fractions.1, &found));
                own_values.extend(found);
            }
            values.splice(own, own_values);
            panels.splice(worst..=worst, evaluated);
            if values.len() > MOST_NODES * size {
                return Ok(None);
            }
        }
        let rules: Vec<Arc<Rule>> = panels.into_iter().map(|one| one.rule).collect();
        let RowsOnNodes { cosines, weights } = RowsOnNodes::new(&rules, self.rows.len());
        Ok(Some(WeightedTable { cosines, values, weights }))
    }

    /// Sets the panels that are tried first.
    fn start_from(&mut self, panels: Vec<Panel>) {
        let rules: Vec<Arc<Rule>> = panels.iter().map(|panel| self.rule(*panel)).collect();
        self.on_first = RowsOnNodes::new(&rules, self.rows.len());
        self.first = panels;
    }

    /// Returns the panel with the largest error if the sum of the errors of all panels is too large.
    fn insufficient(&self, panels: &[Evaluated], fractions: Fractions<'_>) -> Option<usize> {
        let luminances = self.luminances(panels, fractions);
        let errors: Vec<Vec<f64>> =
            panels.iter().map(|one| self.relative_errors(one, fractions, &luminances)).collect();
        let (mut worst, mut most) = (None, self.tolerance);
        for number in 0..errors.first().map_or(0, Vec::len) {
            let sum: f64 = errors.iter().map(|of_panel| of_panel[number]).sum();
            if sum > most || sum.is_nan() {
                most = sum;
                worst = (0..panels.len()).max_by(|a, b| errors[*a][number].total_cmp(&errors[*b][number]));
            }
        }
        worst
    }

    /// Returns Y of all states, or [`FAINT`] if that is more, `[view][state]`.
    fn luminances(&self, panels: &[Evaluated], (fractions, gaps): Fractions<'_>) -> Vec<f64> {
        let mut all = Vec::new();
        for numbers in self.lights_of_views() {
            for shares in fractions.chunks_exact(gaps) {
                let of = |one: &Evaluated| -> f64 {
                    numbers.clone().map(|light| dot(&one.luminous[light * gaps..][..gaps], shares)).sum()
                };
                all.push(panels.iter().map(of).sum::<f64>().max(FAINT));
            }
        }
        all
    }

    /// Returns the errors of a panel relative to these luminances, `[view][state][quantity]`.
    fn relative_errors(
        &self,
        one: &Evaluated,
        (fractions, gaps): Fractions<'_>,
        luminances: &[f64],
    ) -> Vec<f64> {
        let quantities = self.colours.first().map_or(0, Vec::len);
        let mut all = Vec::with_capacity(luminances.len() * quantities);
        let mut luminances = luminances.iter();
        for numbers in self.lights_of_views() {
            for (shares, luminance) in fractions.chunks_exact(gaps).zip(&mut luminances) {
                for quantity in 0..quantities {
                    let of = |light: usize| {
                        dot(&one.errors[(light * quantities + quantity) * gaps..][..gaps], shares)
                    };
                    all.push(numbers.clone().map(of).sum::<f64>() / luminance);
                }
            }
        }
        all
    }

    /// Returns the numbers of the lights of each view.
    fn lights_of_views(&self) -> impl Iterator<Item = std::ops::Range<usize>> {
        let mut first = 0;
        self.lights.chunk_by(|one, next| one.view == next.view).map(move |lights| {
            let numbers = first..first + lights.len();
            first = numbers.end;
            numbers
        })
    }

    /// Computes the errors of a panel with these reflectances at its nodes, `[node][gap][wavelength]`.
    fn evaluated(&mut self, panel: Panel, gaps: usize, values: &[f64]) -> Evaluated {
        let rule = self.rule(panel);
        let mut coefficients = weighted_rows(values, &rule.last);
        coefficients.iter_mut().for_each(|value| *value = value.abs());
        let (mut luminous, mut errors) = (Vec::new(), Vec::new());
        // Of each colour: Y at the nodes, `[node][gap]`, and the decay of the coefficients,
        // `[quantity][gap]`.
        let of_colour = |colour: &Vec<Vec<f64>>| -> (Vec<f64>, Vec<Decay>) {
            let decays = |weights: &Vec<f64>| {
                let sums = dots(&coefficients, weights);
                (0..gaps).map(move |gap| Decay::of(std::array::from_fn(|k| sums[k * gaps + gap])))
            };
            (dots(values, &colour[LUMINOUS]), colour.iter().flat_map(decays).collect())
        };
        let colours: Vec<_> = self.colours.iter().map(of_colour).collect();
        for (number, one) in self.lights.iter().enumerate() {
            let (at_nodes, decays) = &colours[one.colour];
            let weights = &rule.weights[one.row];
            let y = |gap: usize| {
                let of_gap = at_nodes.iter().skip(gap).step_by(gaps);
                one.factor * of_gap.zip(weights).map(|(y, weight)| y * weight).sum::<f64>()
            };
            luminous.extend((0..gaps).map(y));
            let error = |decay: &Decay| {
                let again = 2.0 * self.recycled * decay.error(&rule.recycled[number]);
                one.factor * (decay.error(&rule.aliases[number]) + again)
            };
            errors.extend(decays.iter().map(error));
        }
        Evaluated { panel, rule, luminous, errors }
    }

    /// Returns the rule of a panel.
    fn rule(&mut self, panel: Panel) -> Arc<Rule> {
        if let Some(known) = self.known.get(&panel) {
            return Arc::clone(known);
        }
        let [first, last] = [panel.start, panel.end].map(|part| part as usize * CosinePanels::NODES);
        let cosines: Vec<f64> = Self::light_nodes().nodes().skip(first).take(last - first).collect();
        let fine = FineLight {
            cosines: &cosines,
            rows: self.rows.iter().map(|row| &row[first..last]).collect(),
            lights: self.lights.iter().map(|light| (light.row, light.total)).collect(),
        };
        let made = Arc::new(Rule::new(panel, &fine));
        self.known.insert(panel, Arc::clone(&made));
        made
    }
}

impl RowsOnNodes {
    fn new(rules: &[Arc<Rule>], rows: usize) -> Self {
        let nodes = rules.iter().flat_map(|rule| &rule.cosines).copied();
        let weights = |row: usize| rules.iter().flat_map(move |rule| &rule.weights[row]).copied();
        Self { cosines: nodes.collect(), weights: (0..rows).flat_map(weights).collect() }
    }
}

impl Panel {
    /// Returns the panel with more nodes, or its halves; `None` if there are none.
    fn finer(self) -> Option<Vec<Self>> {
        let Self { start, end, count } = self;
        if count < MOST_OF_PANEL {
            return Some(vec![Self { count: (count + STEP).min(MOST_OF_PANEL), ..self }]);
        }
        let middle = start.midpoint(end);
        let half = |start, end| Self { start, end, count: COUNT_OF_HALF };
        (middle > start).then(|| vec![half(start, middle), half(middle, end)])
    }
}

fn dot(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(one, other)| one * other).sum()
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

    /// Number of wavelengths.
    const BINS: usize = 16;

    /// Returns the reflectances of a film at several wavelengths. The angles of its structure depend on
    /// wavelength.
    fn spectrum(cosine: f64, film: impl Fn(f64) -> f64) -> impl Iterator<Item = f64> {
        (0..BINS).map(move |bin| film(cosine + 0.04 * (bin as f64 / (BINS - 1) as f64 - 0.5)))
    }

    /// Returns the number of nodes, and the error of the light that a film reflects; `None` if it takes the
    /// full table.
    fn error(tolerance: f64, film: impl Fn(f64) -> f64) -> Option<(usize, f64)> {
        let seen = SeenLight { view: 0, colour: vec![vec![1.0; BINS]; 3], row: 0 };
        let mut nodes = WeightedNodes::new(vec![light()], vec![seen], 0.0, tolerance);
        let at = |cosines: &[f64]| Ok::<_, ()>(cosines.iter().flat_map(|c| spectrum(*c, &film)).collect());
        let table = nodes.table((&[1.0], 1), at).unwrap()?;
        let at_nodes: Vec<f64> = table.values.chunks_exact(BINS).map(|values| values.iter().sum()).collect();
        let sum = dot(&table.weights, &at_nodes);
        let panels = WeightedNodes::light_nodes();
        let lit = panels.nodes().zip(light());
        let truth: f64 = lit.map(|(c, weight)| weight * spectrum(c, &film).sum::<f64>()).sum();
        Some((table.cosines.len(), (sum - truth).abs() / truth.max(FAINT)))
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
        let fewest = error(1e-5, |c| 0.3 + 0.1 * c).unwrap().0;
        assert!(error(1e-5, resonance(0.972, 0.003)).is_none_or(|(count, _)| count > fewest));
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
