//! The scale of a swept axis: linear, logarithmic, or a list of names.

use super::SweepAxis;
use crate::axis::{Axis, range};
use crate::panel::SMALL;
use crate::svg::{shortened, text_width};

/// Smallest ratio of the last to the first value for which an axis may be logarithmic.
const LOGARITHMIC_FROM: f64 = 8.0;

/// Largest number of values that all have ticks.
const MAX_MARKED: usize = 24;

/// Side of a panel that an axis is on, and its length, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Side {
    Below(f64),
    Left(f64),
}

/// Scale of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Scale {
    Linear,
    Logarithmic,
    /// Indices in the list.
    Names,
}

impl SweepAxis {
    /// Returns the values as numbers if all are numbers; otherwise their indices in the list.
    pub(super) fn places(&self) -> Vec<f64> {
        self.numbers().unwrap_or_else(|| (0..self.values.len()).map(|i| i as f64).collect())
    }

    fn numbers(&self) -> Option<Vec<f64>> {
        let numbers = self.values.iter().map(|text| text.parse::<f64>().ok().filter(|v| v.is_finite()));
        numbers.collect()
    }

    /// Returns a logarithmic scale if the ratios of neighbours vary less than their differences.
    fn scale(&self) -> Scale {
        let Some(mut sorted) = self.numbers() else { return Scale::Names };
        sorted.sort_by(f64::total_cmp);
        sorted.dedup();
        let (Some(first), Some(last)) = (sorted.first(), sorted.last()) else { return Scale::Linear };
        if sorted.len() < 3 || *first <= 0.0 || last / first < LOGARITHMIC_FROM {
            return Scale::Linear;
        }
        let variation = |step: fn(f64, f64) -> f64| {
            let steps = range(sorted.windows(2).map(|pair| step(pair[0], pair[1])));
            steps.map_or(1.0, |(least, most)| most / least)
        };
        let by_ratios = variation(|a, b| (b / a).ln()) < variation(|a, b| b - a);
        if by_ratios { Scale::Logarithmic } else { Scale::Linear }
    }

    /// Returns an axis with round ticks around all values.
    pub(super) fn axis(&self) -> Axis {
        let places = self.places();
        match self.scale() {
            Scale::Names => {
                let short: Vec<String> = self.values.iter().map(|v| shortened(v, 84.0, SMALL)).collect();
                Axis::of_names(&short, 6, &self.name)
            }
            Scale::Logarithmic => Axis::logarithmic_beyond(1.0, &places, &self.name)
                .unwrap_or_else(|| Axis::covering(places, 7, &self.name)),
            Scale::Linear => Axis::covering(places, 7, &self.name),
        }
    }
}

/// Cells of an axis; their edges are halfway between neighbouring values.
pub(super) struct Cells {
    /// Axis with a tick at every value, and labels where there is space for them.
    pub(super) axis: Axis,
    pub(super) edges: Vec<(f64, f64)>,
}

impl Cells {
    pub(super) fn of(of: &SweepAxis, side: Side) -> Self {
        let scale = of.scale();
        let logarithmic = scale == Scale::Logarithmic;
        let on = |value: f64| if logarithmic { value.ln() } else { value };
        let back = |place: f64| if logarithmic { place.exp() } else { place };
        let places: Vec<f64> = of.places().into_iter().map(on).collect();
        let mut order: Vec<usize> = (0..places.len()).collect();
        order.sort_by(|a, b| places[*a].total_cmp(&places[*b]));
        let sorted: Vec<f64> = order.iter().map(|i| places[*i]).collect();
        let edges = halfway(&order, &sorted);
        let ends = range(edges.iter().flat_map(|(low, high)| [*low, *high])).unwrap_or((0.0, 1.0));
        let longest = if matches!(side, Side::Left(_)) { 62.0 } else { 84.0 };
        let texts: Vec<String> = order.iter().map(|i| shortened(&of.values[*i], longest, SMALL)).collect();
        let fractions: Vec<f64> = sorted.iter().map(|place| (place - ends.0) / (ends.1 - ends.0)).collect();
        let shown = with_room(&fractions, &texts, side);
        let ticks = sorted.iter().zip(texts).zip(shown);
        let ticks =
            ticks.map(|((place, text), shown)| (back(*place), if shown { text } else { String::new() }));
        let axis = if scale == Scale::Linear && order.len() > MAX_MARKED {
            Axis::exact(ends.0, ends.1, 7, &of.name)
        } else {
            let ends = (back(ends.0), back(ends.1));
            Axis::marked(ends, ticks.collect(), &of.name, logarithmic)
        };
        Self { axis, edges: edges.into_iter().map(|(low, high)| (back(low), back(high))).collect() }
    }
}

/// Returns both edges of each cell, in the original order of the values.
fn halfway(order: &[usize], sorted: &[f64]) -> Vec<(f64, f64)> {
    let half = |i: usize| 0.5 * (sorted[i + 1] - sorted[i]);
    let last = sorted.len().saturating_sub(1);
    let mut edges = vec![(0.0, 0.0); sorted.len()];
    for (k, place) in order.iter().enumerate() {
        // The first and the last cell are symmetric about their values; a single cell has a width of 1.
        let below = if k > 0 {
            half(k - 1)
        } else if last > 0 {
            half(0)
        } else {
            0.5
        };
        let above = if k < last { half(k) } else { below };
        edges[*place] = (sorted[k] - below, sorted[k] + above);
    }
    edges
}

/// Returns which labels can be written without touching the previous one.
fn with_room(fractions: &[f64], texts: &[String], side: Side) -> Vec<bool> {
    const GAP: f64 = 6.0;
    let mut free = f64::NEG_INFINITY;
    let fits = fractions.iter().zip(texts).map(|(fraction, text)| {
        let (middle, half) = match side {
            Side::Below(length) => (fraction * length, 0.5 * text_width(text, SMALL)),
            Side::Left(length) => (fraction * length, 0.5 * SMALL),
        };
        let fits = middle - half >= free;
        if fits {
            free = middle + half + GAP;
        }
        fits
    });
    fits.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(values: &[&str]) -> SweepAxis {
        SweepAxis { name: "a".to_owned(), values: values.iter().map(|&v| v.to_owned()).collect() }
    }

    #[test]
    fn cell_edges_are_halfway_for_any_order() {
        let cells = Cells::of(&axis(&["3", "1", "0"]), Side::Left(300.0));
        assert_eq!(cells.edges, [(2.0, 4.0), (0.5, 2.0), (-0.5, 0.5)]);
        let cells = Cells::of(&axis(&["1", "10", "100"]), Side::Left(300.0));
        for (edge, power) in cells.edges.iter().zip([-0.5_f64, 0.5, 1.5]) {
            assert!((edge.0 / 10_f64.powf(power) - 1.0).abs() < 1e-12, "{edge:?}");
        }
    }

    #[test]
    fn values_in_geometric_progression_have_logarithmic_scale() {
        for (values, scale) in [
            (&["500", "1000", "2000", "4000", "6000", "10000"][..], Scale::Logarithmic),
            (&["10", "1", "0.1"], Scale::Logarithmic),
            (&["1", "4", "7", "10"], Scale::Linear),
            (&["0", "1", "10", "100"], Scale::Linear),
            (&["0.3", "0.6", "1.2"], Scale::Linear),
            (&["1", "100"], Scale::Linear),
            (&["SiO2", "air", "1"], Scale::Names),
        ] {
            assert_eq!(axis(values).scale(), scale, "{values:?}");
        }
    }

    #[test]
    fn every_value_has_tick_and_labels_do_not_touch() {
        let texts: Vec<String> = (0..24).map(|i| (1000 * i).to_string()).collect();
        let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
        let cells = Cells::of(&axis(&texts), Side::Below(470.0));
        let written: Vec<usize> =
            cells.axis.ticks().iter().enumerate().filter(|(_, (_, t))| !t.is_empty()).map(|t| t.0).collect();
        assert_eq!(cells.axis.ticks().len(), 24);
        assert!(written.len() > 5 && written.windows(2).all(|pair| pair[1] - pair[0] >= 2), "{written:?}");
    }
}
