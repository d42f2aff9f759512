//! Tables of a film's reflectances for known light: as many nodes over angle as X, Y and Z need.
//!
//! At a single wavelength the reflectance of a film has sharp structure over angle, above all where light grazes an air gap.
//! Little of it is left in what a reader sees: sums over wavelength blur it, a lobe sends little light there, and light that
//! is smooth over angle averages it. All these sums are linear in the table. Therefore only the smoothness of the reflectance
//! *weighted by the colour-matching functions* counts, not that at each wavelength.
//!
//! **Nodes.** What is seen depends on a few sums of the reflectance over angle, with known weights. They are integrals, with the
//! light as a density, and a Gauss rule for this density needs the fewest nodes ([`rule`]). The density has a peak in the
//! directions of the lobes and long tails; one polynomial would need many nodes for the structure of the film in the tails.
//! Two to four panels, each with several times as much light as the one before, have about the same number of nodes.
//!
//! **Error.** On a panel with N nodes, let `a_k` be the coefficients of a weighted reflectance in the polynomials `p_k` that are
//! orthonormal for the light. The missing terms, from k = N on, contribute `a_k e_k` to the error, where `e_k` is the error of
//! the rule for `p_k`, which is known. The missing `a_k` are extrapolated from the last six. Where the sum of all errors is too
//! large, the panel with the largest error takes more nodes, and is halved if it has the most.
//!
//! Recycled light is a product of reflectances, wavelength by wavelength. Its fraction of the error uses the mean magnitude
//! of the coefficients over wavelength, in which nothing cancels.

use std::collections::HashMap;
use std::f64::consts::PI;
use std::sync::Arc;

use papilio_transport::CosinePanels;

mod rule;
mod smoothness;

use rule::{FineLight, Panel, Rule};
use smoothness::{Decay, colour_sums, roughness};

/// Halvings of the panels on which the light is given.
const FINEST: u32 = 5;

/// Number of parts of 0 to 1 of which panels are made. Each has [`CosinePanels::NODES`] light nodes.
const PARTS: u32 = 1 << FINEST;

/// Smallest number of parts of a panel: its rule needs more light nodes than it has degrees.
const LEAST_PARTS: u32 = 2;

/// Numbers of nodes of a panel. With fewer, the last coefficients say little about the missing ones.
const COUNTS: [usize; 4] = [10, 12, 14, 16];

/// Number of nodes of a half of a panel with the most nodes.
const COUNT_OF_HALF: usize = 12;

/// Largest number of nodes. Films that need more are tabulated as for all light.
const MOST_NODES: usize = 256;

/// Largest fractions of the light below the borders of the panels: choices, of which the one with the fewest nodes is taken.
const TAILS: [&[f64]; 4] = [&[1e-3], &[5e-4, 5e-3], &[2e-3, 2e-2], &[2e-4, 2e-3, 2e-2]];

/// Fraction of the tolerance that the scene's own film takes on the first panels. Similar films then seldom need others.
const MARGIN: f64 = 0.4;

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

/// Panel with the colours of its values.
struct Evaluated {
    panel: Panel,
    rule: Arc<Rule>,
    /// `[node][gap][wavelength]`.
    values: Vec<f64>,
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
    pub(crate) cosines: Vec<f64>,
    /// `[node][gap][wavelength]`.
    pub(crate) values: Vec<f64>,
    /// `[row][node]`.
    pub(crate) weights: Vec<f64>,
}

impl WeightedNodes {
    /// Returns the nodes on which light is given.
    pub(crate) fn light_nodes() -> CosinePanels {
        CosinePanels::new(&[FINEST; 1 << FINEST])
    }

    /// Prepares nodes for sums with these weights on the light nodes, with errors of X, Y and Z of at most the fraction
    /// `tolerance` of Y, or of 0.01 if Y is less, in these lights; `recycled` is an upper bound of the fraction of light that
    /// meets the film again.
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
        let first = first_panels(&rows, &lights, TAILS[1]);
        Self { tolerance, recycled, rows: rows.into(), lights, colours, first, known: HashMap::new() }
    }

    /// Chooses the first panels so that they suffice for this film, with a margin.
    pub(crate) fn fit<E>(
        &mut self,
        fractions: Fractions<'_>,
        film: impl Fn(&[f64]) -> Result<Vec<f64>, E>,
    ) -> Result<(), E> {
        let mut best: Option<(usize, Vec<Panel>)> = None;
        for tails in TAILS {
            self.first = first_panels(&self.rows, &self.lights, tails);
            let Some(panels) = self.sufficient(fractions, &film, (MARGIN * self.tolerance, 1))? else {
                continue;
            };
            let nodes = panels.iter().map(|one| one.panel.count).sum();
            if best.as_ref().is_none_or(|(least, _)| nodes < *least) {
                best = Some((nodes, panels.into_iter().map(|one| one.panel).collect()));
            }
        }
        if let Some((_, panels)) = best {
            self.first = panels;
        }
        Ok(())
    }

    /// Tabulates a film whose reflectances at some cosines are `[cosine][gap][wavelength]`; `None` if it needs more nodes than
    /// are available here.
    pub(crate) fn table<E>(
        &mut self,
        fractions: Fractions<'_>,
        film: impl Fn(&[f64]) -> Result<Vec<f64>, E>,
    ) -> Result<Option<WeightedTable>, E> {
        // A film that differs so much that it needs more nodes mostly needs many more.
        let panels = self.sufficient(fractions, &film, (self.tolerance, 2))?;
        Ok(panels.map(|panels| {
            let nodes = panels.iter().flat_map(|one| &one.rule.cosines);
            let weights = |row: usize| panels.iter().flat_map(move |one| &one.rule.weights[row]).copied();
            WeightedTable {
                cosines: nodes.copied().collect(),
                weights: (0..self.rows.len()).flat_map(weights).collect(),
                values: panels.iter().map(|one| &one.values[..]).collect::<Vec<_>>().concat(),
            }
        }))
    }

    /// Returns panels with an error of at most `most`; where it is larger, the number of nodes increases by `steps` of
    /// [`COUNTS`]. `None` if more nodes are needed than are available.
    fn sufficient<E>(
        &mut self,
        fractions: Fractions<'_>,
        film: &impl Fn(&[f64]) -> Result<Vec<f64>, E>,
        (most, steps): (f64, usize),
    ) -> Result<Option<Vec<Evaluated>>, E> {
        let mut panels = Vec::with_capacity(2 * self.first.len());
        for panel in self.first.clone() {
            panels.push(self.evaluated(panel, fractions.1, film)?);
        }
        while let Some(worst) = self.insufficient(&panels, fractions, most) {
            let Some(finer) = panels[worst].panel.finer(steps) else { return Ok(None) };
            let finer: Result<Vec<_>, _> =
                finer.into_iter().map(|panel| self.evaluated(panel, fractions.1, film)).collect();
            panels.splice(worst..=worst, finer?);
            if panels.iter().map(|one| one.panel.count).sum::<usize>() > MOST_NODES {
                return Ok(None);
            }
        }
        Ok(Some(panels))
    }

    /// Returns the panel with the largest error if the sum of the errors of all panels is too large.
    fn insufficient(
        &self,
        panels: &[Evaluated],
        (fractions, gaps): Fractions<'_>,
        mut most: f64,
    ) -> Option<usize> {
        let quantities = self.colours.first().map_or(0, Vec::len);
        let mut worst = None;
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
                    let error = |one: &Evaluated| -> f64 {
                        let of = |light| mixed(&one.errors[(light * quantities + quantity) * gaps..][..gaps]);
                        numbers.clone().map(of).sum::<f64>() / y
                    };
                    let sum: f64 = panels.iter().map(error).sum();
                    if sum > most || sum.is_nan() {
                        most = sum;
                        worst = (0..panels.len())
                            .max_by(|a, b| error(&panels[*a]).total_cmp(&error(&panels[*b])));
                    }
                }
            }
        }
        worst
    }

    fn evaluated<E>(
        &mut self,
        panel: Panel,
        gaps: usize,
        film: &impl Fn(&[f64]) -> Result<Vec<f64>, E>,
    ) -> Result<Evaluated, E> {
        let rule = self.rule(panel);
        let (values, nodes) = (film(&rule.cosines)?, panel.count);
        let rough = (self.recycled > 0.0).then(|| roughness(&values, &rule, gaps));
        // Of each colour: the values at the nodes, and the decay of their coefficients, `[quantity][gap]`.
        let of_colour = |colour: &Vec<Vec<f64>>| -> (Vec<f64>, Vec<Decay>) {
            let sums = colour_sums(&values, colour, (nodes, gaps));
            let decay =
                |at_nodes: &[f64]| Decay::of_sums(rule.last.each_ref().map(|last| dot(last, at_nodes)));
            let decays = sums.chunks_exact(nodes).map(decay).collect();
            (sums, decays)
        };
        let colours: Vec<_> = self.colours.iter().map(of_colour).collect();
        let (mut luminous, mut errors) = (Vec::new(), Vec::new());
        for (number, one) in self.lights.iter().enumerate() {
            let (values, decays) = &colours[one.colour];
            let of_gaps = values[LUMINOUS * gaps * nodes..][..gaps * nodes].chunks_exact(nodes);
            luminous.extend(of_gaps.map(|values| one.factor * dot(values, &rule.weights[one.row])));
            for (decays, weights) in decays.chunks_exact(gaps).zip(&self.colours[one.colour]) {
                let white = 2.0 * self.recycled * weights.iter().sum::<f64>();
                for (gap, decay) in decays.iter().enumerate() {
                    let again =
                        rough.as_ref().map_or(0.0, |rough| white * rough[gap].error(&rule.recycled[number]));
                    errors.push(one.factor * (decay.error(&rule.aliases[number]) + again));
                }
            }
        }
        Ok(Evaluated { panel, rule, values, luminous, errors })
    }

    /// Returns the rule of a panel.
    fn rule(&mut self, panel: Panel) -> Arc<Rule> {
        if let Some(known) = self.known.get(&panel) {
            return Arc::clone(known);
        }
        let [first, last] = [panel.start, panel.end].map(|part| part as usize * CosinePanels::NODES);
        let (cosines, widths) = fine_nodes();
        let fine = FineLight {
            cosines: &cosines[first..last],
            widths: &widths[first..last],
            rows: self.rows.iter().map(|row| &row[first..last]).collect(),
            lights: self.lights.iter().map(|light| (light.row, light.total)).collect(),
        };
        let made = Arc::new(Rule::new(panel.count, &fine));
        self.known.insert(panel, Arc::clone(&made));
        made
    }
}

impl Panel {
    /// Returns the panel with more nodes, by this number of steps of [`COUNTS`], or its halves; `None` if there are none.
    fn finer(self, steps: usize) -> Option<Vec<Self>> {
        let Self { start, end, count } = self;
        let most = COUNTS.len() - 1;
        if count < COUNTS[most] {
            let place = COUNTS.iter().position(|known| *known >= count).unwrap_or(most);
            return Some(vec![Self { count: COUNTS[(place + steps).min(most)], ..self }]);
        }
        let middle = (start + end).div_ceil(2);
        let halves = [(start, middle), (middle, end)];
        let halves = halves.map(|(start, end)| Self { start, end, count: COUNT_OF_HALF });
        halves.iter().all(|half| half.end - half.start >= LEAST_PARTS).then(|| halves.to_vec())
    }
}

/// Returns the panels of tails with these fractions of the light, and of the rest.
fn first_panels(rows: &[Vec<f64>], lights: &[Light], tails: &[f64]) -> Vec<Panel> {
    let within = |part: u32| {
        let nodes = part as usize * CosinePanels::NODES;
        let share = |light: &Light| rows[light.row][..nodes].iter().sum::<f64>() / light.total;
        lights.iter().filter(|light| light.total > 0.0).map(share).fold(0.0, f64::max)
    };
    let last = PARTS / LEAST_PARTS - 1;
    let border = |most: f64| {
        let mut parts = (0..=last).rev().map(|k| k * LEAST_PARTS);
        parts.find(|part| within(*part) <= most)
    };
    let borders = tails.iter().filter_map(|most| border(*most));
    let mut borders: Vec<u32> = borders.filter(|part| *part > 0).collect();
    borders.dedup();
    let starts = std::iter::once(0).chain(borders.iter().copied());
    let ends = borders.iter().copied().chain([PARTS]);
    starts.zip(ends).map(|(start, end)| Panel { start, end, count: COUNTS[0] }).collect()
}

/// Returns the cosines of the light nodes, and their weights in an integral over the cosine (Fejer's rule, to 0.2 %).
fn fine_nodes() -> (Vec<f64>, Vec<f64>) {
    let angle = |k: usize| PI * ((k % CosinePanels::NODES) as f64 + 0.5) / CosinePanels::NODES as f64;
    let width = |k: usize| 0.5 * PI / (CosinePanels::NODES as f64 * f64::from(PARTS)) * angle(k).sin();
    let cosines: Vec<f64> = WeightedNodes::light_nodes().nodes().collect();
    let widths = (0..cosines.len()).map(width).collect();
    (cosines, widths)
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

    /// Returns the number of nodes, and the error of the light that a film of one wavelength reflects; `None` if it takes the
    /// full table.
    fn error(tolerance: f64, film: impl Fn(f64) -> f64) -> Option<(usize, f64)> {
        let seen = SeenLight { view: 0, colour: vec![vec![1.0]; 3], row: 0 };
        let mut nodes = WeightedNodes::new(vec![light()], vec![seen], 0.0, tolerance);
        let at = |cosines: &[f64]| Ok::<_, ()>(cosines.iter().map(|c| film(*c)).collect());
        let table = nodes.table((&[1.0], 1), at).unwrap()?;
        let sum = dot(&table.weights, &table.values);
        let fine = WeightedNodes::light_nodes();
        let truth: f64 = fine.nodes().zip(light()).map(|(c, weight)| weight * film(c)).sum();
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
        assert_eq!(error(1e-5, |c| 0.3 + 0.1 * c).unwrap().0, 30);
        assert!(error(1e-5, resonance(0.972, 0.003)).is_none_or(|(count, _)| count > 30));
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
