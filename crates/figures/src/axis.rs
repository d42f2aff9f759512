//! Axes: their range and ticks.

/// Smallest value on a logarithmic axis, relative to the largest.
const LOGARITHMIC_REACH: f64 = 1e-6;

/// Smallest and largest number that labels of a logarithmic axis write without an exponent; a tenth of the
/// smallest where there are labels between the powers of ten.
const SHORT: [f64; 2] = [0.01, 10_000.0];

/// Smallest space between two labels, px.
const LABEL_GAP: f64 = 4.0;

/// A linear or logarithmic axis with round ticks.
#[derive(Debug, Clone)]
pub(crate) struct Axis {
    min: f64,
    max: f64,
    ticks: Vec<(f64, String)>,
    title: String,
    logarithmic: bool,
}

impl Axis {
    /// Returns an axis from `min` to `max` exactly, with about `count` ticks.
    pub(crate) fn exact(min: f64, max: f64, count: usize, title: &str) -> Self {
        let step = round_step((max - min) / count.max(1) as f64);
        let first = (min / step - 1e-9).ceil();
        let ticks = (0..=2 * count).map(|i| (first + i as f64) * step);
        let ticks = ticks.take_while(|tick| *tick <= max + 1e-9 * step);
        let named = |tick: f64| (tick, written(if tick.abs() < 1e-9 * step { 0.0 } else { tick }, step));
        Self { min, max, ticks: ticks.map(named).collect(), title: title.to_owned(), logarithmic: false }
    }

    /// Returns an axis that extends to the ticks around all finite `values`.
    pub(crate) fn covering(values: impl IntoIterator<Item = f64>, count: usize, title: &str) -> Self {
        let (mut min, mut max) = range(values.into_iter().filter(|v| v.is_finite())).unwrap_or((0.0, 1.0));
        if max - min <= 1e-9 * max.abs().max(min.abs()) {
            let margin = if max == 0.0 { 1.0 } else { 0.1 * max.abs() };
            (min, max) = (min - margin, max + margin);
        }
        let step = round_step((max - min) / count.max(1) as f64);
        let (low, high) = ((min / step + 1e-9).floor() * step, (max / step - 1e-9).ceil() * step);
        Self::exact(low, high, ((high - low) / step).round() as usize, title)
    }

    /// Returns a logarithmic axis if the positive `values` span more than this `ratio`.
    ///
    /// Ticks are at 1, 2 and 5 times the powers of ten, or at the powers alone
    /// where there are many. The axis has at most six decades, from the largest value down.
    pub(crate) fn logarithmic_beyond(ratio: f64, values: &[f64], title: &str) -> Option<Self> {
        let positive = values.iter().copied().filter(|v| (1e-300..1e300).contains(v));
        let (min, max) = range(positive).filter(|(min, max)| max / min > ratio)?;
        Self::decades(min.max(LOGARITHMIC_REACH * max), max, title)
    }

    /// Returns a logarithmic axis that extends to the ticks around two positive values. Ticks are as above,
    /// or at every second or third power of ten where all powers would be too many.
    pub(crate) fn decades(min: f64, max: f64, title: &str) -> Option<Self> {
        let decades = (min.log10().floor() as i32, max.log10().ceil() as i32);
        let apart = (decades.1 - decades.0).unsigned_abs().div_ceil(8).max(1) as i32;
        let steps: &[f64] = if max / min > 2e3 { &[1.0] } else { &[1.0, 2.0, 5.0] };
        let powers = (decades.0.div_euclid(apart)..=decades.1.div_euclid(apart) + 1).map(|d| d * apart);
        let round: Vec<f64> = powers.flat_map(|d| steps.iter().map(move |s| s * 10.0_f64.powi(d))).collect();
        let low = round.iter().copied().rfind(|tick| *tick <= min * (1.0 + 1e-9))?;
        let high = round.iter().copied().find(|tick| *tick >= max * (1.0 - 1e-9))?;
        let ticks: Vec<f64> = round.into_iter().filter(|tick| (low..=high).contains(tick)).collect();
        // All labels of an axis have the same form: powers of ten, unless all numbers are short.
        let least = if steps.len() > 1 { 0.1 * SHORT[0] } else { SHORT[0] };
        let is_short = |tick: &f64| (0.99 * least..=1.01 * SHORT[1]).contains(tick);
        let plain = ticks.iter().all(is_short);
        let named = |tick: f64| if plain { written(tick, tick) } else { power(tick, 0) };
        let ticks = ticks.into_iter().map(|tick| (tick, named(tick))).collect();
        Some(Self { min: low, max: high, ticks, title: title.to_owned(), logarithmic: true })
    }

    /// Returns an axis of names at 0, 1, ...; at most about `count` of them have labels.
    pub(crate) fn of_names(names: &[String], count: usize, title: &str) -> Self {
        let every = names.len().div_ceil(count.max(1)).max(1);
        let ticks =
            names.iter().enumerate().step_by(every).map(|(i, name)| (i as f64, name.clone())).collect();
        let max = names.len() as f64 - 0.5;
        Self { min: -0.5, max: max.max(0.5), ticks, title: title.to_owned(), logarithmic: false }
    }

    /// Returns an axis with the given ends and ticks.
    pub(crate) fn marked(
        (min, max): (f64, f64),
        ticks: Vec<(f64, String)>,
        title: &str,
        logarithmic: bool,
    ) -> Self {
        Self { min, max, ticks, title: title.to_owned(), logarithmic }
    }

    /// Returns an axis from the first to the last of ascending `values`.
    pub(crate) fn between(values: &[f64], count: usize, title: &str) -> Self {
        match values {
            [first, .., last] if last - first > 0.0 && (last - first).is_finite() => {
                Self::exact(*first, *last, count, title)
            }
            _ => Self::covering(values.iter().copied(), count, title),
        }
    }

    /// Removes the title, for panels next to one that shows it.
    pub(crate) fn untitled(self) -> Self {
        Self { title: String::new(), ..self }
    }

    /// Returns the value at the left or lower end.
    pub(crate) fn min(&self) -> f64 {
        self.min
    }

    /// Returns the tick values with their labels.
    pub(crate) fn ticks(&self) -> &[(f64, String)] {
        &self.ticks
    }

    /// Returns the ticks whose labels can be written side by side on an axis of this `length`, px; `extent`
    /// returns the extent of a label along the axis. If there is no space for all, a logarithmic axis has
    /// those at powers of ten, and after that every second one, every third one and so on.
    pub(crate) fn labelled(&self, length: f64, extent: impl Fn(&str) -> f64) -> Vec<(f64, &str)> {
        let all: Vec<(f64, &str)> = self.ticks.iter().map(|(tick, text)| (*tick, text.as_str())).collect();
        let fits = |chosen: &[(f64, &str)]| {
            let written = chosen.iter().filter(|(_, text)| !text.is_empty());
            let mut spans: Vec<(f64, f64)> =
                written.map(|(tick, text)| (length * self.fraction(*tick), 0.5 * extent(text))).collect();
            spans.sort_by(|a, b| a.0.total_cmp(&b.0));
            spans.windows(2).all(|pair| pair[0].0 + pair[0].1 + LABEL_GAP <= pair[1].0 - pair[1].1)
        };
        let is_power = |tick: f64| (tick.log10() - tick.log10().round()).abs() < 1e-6;
        let powers: Vec<(f64, &str)> = all.iter().copied().filter(|(tick, _)| is_power(*tick)).collect();
        let fewer = if self.logarithmic && powers.len() > 1 { &powers } else { &all };
        if fits(&all) {
            return all;
        }
        let strides =
            (1..=fewer.len()).map(|stride| fewer.iter().copied().step_by(stride).collect::<Vec<_>>());
        strides.into_iter().find(|chosen| fits(chosen)).unwrap_or_default()
    }

    /// Returns the title: quantity and unit.
    pub(crate) fn title(&self) -> &str {
        &self.title
    }

    /// Returns whether a value lies between the ends.
    pub(crate) fn contains(&self, value: f64) -> bool {
        self.min < value && value < self.max
    }

    /// Returns the position of a value, from 0 to 1 between the ends; not finite where the logarithm is not.
    pub(crate) fn fraction(&self, value: f64) -> f64 {
        if self.logarithmic {
            // Values that are not positive are infinitely far below.
            let decades = if value <= 0.0 { f64::NEG_INFINITY } else { (value / self.min).log10() };
            return decades / (self.max / self.min).log10();
        }
        (value - self.min) / (self.max - self.min)
    }
}

/// Returns the smallest and the largest value, if there are any.
pub(crate) fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values
        .fold(None, |range, v| Some(range.map_or((v, v), |(min, max): (f64, f64)| (min.min(v), max.max(v)))))
}

/// Formats a tick with the decimals that a step of this size needs, or as a power of ten if these are many.
fn written(tick: f64, step: f64) -> String {
    let decade = (step.log10() + 1e-9).floor();
    if (-5.0..6.0).contains(&decade) {
        let decimals = (-decade).max(0.0) as usize;
        return format!("{tick:.decimals$}");
    }
    let own = if tick == 0.0 { decade } else { (tick.abs().log10() + 1e-9).floor() };
    power(tick, (own - decade).max(0.0) as usize)
}

/// Formats a number as a multiple of a power of ten with a raised exponent: `10⁻⁴`, `2×10⁵`, `1.2×10⁷`.
pub(crate) fn power(value: f64, decimals: usize) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let text = format!("{value:.decimals$e}");
    let Some((mantissa, exponent)) = text.split_once('e') else { return text };
    if value == 0.0 {
        return "0".to_owned();
    }
    let raised = exponent.chars().map(|c| c.to_digit(10).map_or('⁻', |digit| RAISED[digit as usize]));
    let raised: String = raised.collect();
    match mantissa {
        "1" => format!("10{raised}"),
        "-1" => format!("-10{raised}"),
        _ => format!("{mantissa}×10{raised}"),
    }
}

/// Returns the smallest 1, 2 or 5 times a power of ten that is at least `step`.
fn round_step(step: f64) -> f64 {
    let decade = 10.0_f64.powf(step.log10().floor());
    let mantissa = step / decade;
    let round = [1.0, 2.0, 5.0].into_iter().find(|r| mantissa <= r * (1.0 + 1e-9));
    decade * round.unwrap_or(10.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<&str> {
        axis.ticks.iter().map(|(_, label)| label.as_str()).collect()
    }

    #[test]
    fn linear_axis_has_round_ticks() {
        let axis = Axis::covering([0.013, 0.241], 5, "Y");
        assert_eq!((axis.min, axis.max), (0.0, 0.25));
        assert_eq!(labels(&axis), ["0.00", "0.05", "0.10", "0.15", "0.20", "0.25"]);
    }

    #[test]
    fn tiny_and_huge_ticks_have_short_labels() {
        for scale in [1e-290, 1e-13, 1e9, 1e290] {
            for axis in [
                Axis::covering([0.0, 4.0 * scale], 5, "Y"),
                Axis::logarithmic_beyond(30.0, &[0.1 * scale, 4.0 * scale], "Y").unwrap(),
            ] {
                assert!(labels(&axis).iter().all(|label| label.chars().count() <= 8), "{axis:?}");
            }
        }
        assert_eq!(labels(&Axis::exact(-1.0, 1.0, 2, "")), ["-1", "0", "1"]);
    }

    #[test]
    fn powers_of_ten_have_raised_exponents() {
        assert_eq!(
            labels(&Axis::decades(1e-6, 1e-4, "").unwrap()),
            ["10⁻⁶", "2×10⁻⁶", "5×10⁻⁶", "10⁻⁵", "2×10⁻⁵", "5×10⁻⁵", "10⁻⁴"]
        );
        assert_eq!(labels(&Axis::decades(1e-2, 1e2, "").unwrap()), ["0.01", "0.1", "1", "10", "100"]);
        assert_eq!(
            labels(&Axis::decades(1.0, 1e6, "").unwrap()),
            ["10⁰", "10¹", "10²", "10³", "10⁴", "10⁵", "10⁶"]
        );
        // The labels of a linear axis are exact: every one is a multiple of the step.
        assert_eq!(
            labels(&Axis::exact(8e6, 1.6e7, 4, "")),
            ["8×10⁶", "1.0×10⁷", "1.2×10⁷", "1.4×10⁷", "1.6×10⁷"]
        );
        assert_eq!(labels(&Axis::exact(-2e-7, 1e-7, 3, "")), ["-2×10⁻⁷", "-10⁻⁷", "0", "10⁻⁷"]);
    }

    /// Labels never touch: those that have no space are left out, powers of ten last.
    #[test]
    fn labels_never_collide() {
        let extent = |text: &str| 6.7 * text.chars().count() as f64;
        for (low, high) in [(7e4, 3e6), (1e-6, 1e-5), (0.3, 400.0), (1e-12, 1e12), (1.0, 2.0)] {
            for length in [60.0, 120.0, 300.0, 500.0] {
                let axis = Axis::decades(low, high, "").unwrap();
                let shown = axis.labelled(length, extent);
                let places: Vec<f64> = shown.iter().map(|(tick, _)| length * axis.fraction(*tick)).collect();
                for (pair, texts) in places.windows(2).zip(shown.windows(2)) {
                    let halves = 0.5 * (extent(texts[0].1) + extent(texts[1].1));
                    assert!(pair[1] - pair[0] > halves, "{low} to {high}, {length} px: {shown:?}");
                }
                assert!(length < 300.0 || shown.len() > 1, "{low} to {high}, {length} px: {shown:?}");
            }
        }
    }

    #[test]
    fn wide_range_has_logarithmic_ticks() {
        assert!(Axis::logarithmic_beyond(30.0, &[0.0, 0.1, 3.0], "Y").is_none());
        assert!(Axis::logarithmic_beyond(30.0, &[0.0, -1.0, f64::NAN], "Y").is_none());
        let axis = Axis::logarithmic_beyond(30.0, &[0.03, -1.0, 4.3, f64::NAN], "Y").unwrap();
        assert_eq!(labels(&axis), ["0.02", "0.05", "0.1", "0.2", "0.5", "1", "2", "5"]);
        assert!((axis.fraction(0.02) - 0.0).abs() < 1e-12 && (axis.fraction(5.0) - 1.0).abs() < 1e-12);
        assert!((axis.fraction(0.316_227_766) - 0.5).abs() < 1e-6, "the middle is the geometric mean");
        assert_eq!(axis.fraction(0.0), f64::NEG_INFINITY);
        // Noise around zero does not determine the range.
        let axis = Axis::logarithmic_beyond(30.0, &[1e-30, 1.0], "Y").unwrap();
        assert_eq!((axis.min, labels(&axis).len()), (1e-6, 7));
    }

    #[test]
    fn unusual_data_give_finite_axis() {
        for values in
            [vec![], vec![f64::NAN], vec![0.0], vec![3.0, 3.0], vec![-1e-9, 1e12], vec![1e300, -1e300]]
        {
            let axis = Axis::covering(values.clone(), 5, "");
            assert!(
                axis.min < axis.max && axis.ticks.len() > 1 && axis.ticks.len() < 20,
                "{values:?} {axis:?}"
            );
        }
    }
}
