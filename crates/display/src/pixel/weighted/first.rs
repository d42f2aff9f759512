//! The panels that are tried first: the fewest nodes that suffice for the scene's own film, with a margin.

use super::rule::Panel;
use super::{Evaluated, Fractions, PARTS, WeightedNodes};

/// Numbers of nodes of which equally accurate panels are made.
const COUNTS: [usize; 5] = [10, 12, 14, 16, 18];

/// Smallest number of nodes of a panel. The last coefficients of fewer say little about the missing ones.
const LEAST: usize = 8;

/// Fraction of the tolerance that the scene's own film takes. Similar films then seldom need other panels.
const MARGIN: f64 = 0.7;

/// Fraction of that error that a single panel may have at first.
const SHARE: f64 = 1.0 / 3.0;

/// Panels of equal width that suffice for most films.
pub(super) fn for_any_film() -> Vec<Panel> {
    const WIDTH: u32 = PARTS / 8;
    (0..PARTS).step_by(WIDTH as usize).map(|start| Panel { start, end: start + WIDTH, count: 16 }).collect()
}

/// A film and the scale of its errors.
struct Own<'a, F> {
    fractions: Fractions<'a>,
    film: F,
    /// Border between panels, in parts.
    border: u32,
    luminances: Vec<f64>,
}

impl WeightedNodes {
    /// Chooses the first panels so that they suffice for this film, with a margin. `critical` is the cosine
    /// of the critical angle of the film's gap: there, films have structure that is sharp and at the same
    /// angle at all wavelengths. A panel resolves it best at its ends.
    pub(crate) fn fit<E>(
        &mut self,
        fractions: Fractions<'_>,
        critical: f64,
        film: impl Fn(&[f64]) -> Result<Vec<f64>, E>,
    ) -> Result<(), E> {
        let border = (critical * f64::from(PARTS)).round() as u32;
        let mut own = Own { fractions, film, border, luminances: Vec::new() };
        let mut panels = Vec::new();
        for panel in for_any_film() {
            panels.push(self.evaluated_of(&own, panel)?);
        }
        own.luminances = self.luminances(&panels, fractions);
        let mut best: Option<Vec<Panel>> = None;
        for count in COUNTS {
            let Some(panels) = self.equally_accurate(&own, count)? else { continue };
            let panels = self.with_fewer_nodes(&own, panels)?;
            if best.as_ref().is_none_or(|best| nodes_of(&panels) < nodes_of(best)) {
                best = Some(panels);
            }
        }
        self.known.clear();
        if let Some(panels) = best {
            self.start_from(panels);
        }
        Ok(())
    }

    /// Returns panels of this number of nodes, each as wide as its share of the error allows; `None` if the
    /// narrowest are too wide.
    fn equally_accurate<E, F: Fn(&[f64]) -> Result<Vec<f64>, E>>(
        &mut self,
        own: &Own<'_, F>,
        count: usize,
    ) -> Result<Option<Vec<Panel>>, E> {
        let mut panels: Vec<Panel> = Vec::new();
        let mut start = 0;
        while start < PARTS {
            // The widest that is known to suffice, and the narrowest that is known not to.
            let limit = if start < own.border { own.border } else { PARTS };
            let (mut end, mut beyond) = (start, limit + 1);
            while beyond - end > 1 {
                let middle = end.midpoint(beyond);
                let errors = self.errors_of(own, Panel { start, end: middle, count })?;
                let is_sufficient = errors.iter().all(|error| *error <= SHARE * MARGIN * self.tolerance);
                if is_sufficient { end = middle } else { beyond = middle }
            }
            if end == start {
                return Ok(None);
            }
            panels.push(Panel { start, end, count });
            start = end;
        }
        Ok(Some(panels))
    }

    /// Returns the panels with as few nodes as the error of all allows.
    fn with_fewer_nodes<E, F: Fn(&[f64]) -> Result<Vec<f64>, E>>(
        &mut self,
        own: &Own<'_, F>,
        mut panels: Vec<Panel>,
    ) -> Result<Vec<Panel>, E> {
        let mut errors = Vec::new();
        for panel in &panels {
            errors.push(self.errors_of(own, *panel)?);
        }
        loop {
            let mut best: Option<(f64, usize, Vec<f64>)> = None;
            for (number, panel) in panels.iter().enumerate().filter(|(_, panel)| panel.count > LEAST) {
                let fewer = self.errors_of(own, Panel { count: panel.count - 2, ..*panel })?;
                let others = errors.iter().enumerate().filter(|(other, _)| *other != number);
                let mut sums = fewer.clone();
                for (_, other) in others {
                    sums.iter_mut().zip(other).for_each(|(sum, error)| *sum += error);
                }
                let largest = sums.into_iter().fold(0.0, f64::max);
                let limit = best.as_ref().map_or(MARGIN * self.tolerance, |best| best.0);
                if largest <= limit {
                    best = Some((largest, number, fewer));
                }
            }
            let Some((_, number, fewer)) = best else { return Ok(panels) };
            panels[number].count -= 2;
            errors[number] = fewer;
        }
    }

    /// Returns the errors of a panel, `[view][state][quantity]`.
    fn errors_of<E, F: Fn(&[f64]) -> Result<Vec<f64>, E>>(
        &mut self,
        own: &Own<'_, F>,
        panel: Panel,
    ) -> Result<Vec<f64>, E> {
        let evaluated = self.evaluated_of(own, panel)?;
        Ok(self.relative_errors(&evaluated, own.fractions, &own.luminances))
    }

    fn evaluated_of<E, F: Fn(&[f64]) -> Result<Vec<f64>, E>>(
        &mut self,
        own: &Own<'_, F>,
        panel: Panel,
    ) -> Result<Evaluated, E> {
        let rule = self.rule(panel);
        let values = (own.film)(&rule.cosines)?;
        Ok(self.evaluated(panel, own.fractions.1, &values))
    }
}

fn nodes_of(panels: &[Panel]) -> usize {
    panels.iter().map(|panel| panel.count).sum()
}
