//! The deviations of a campaign: a table by families of displays, and a figure.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use papilio_figures::{Chart, ChartCurve, Hue, chart};

use super::solvers::Pair;
use super::wide::beyond;

/// Returns the families of a display by the words of its name: its layers, its pixel and its light.
pub(crate) fn families(name: &str) -> BTreeSet<String> {
    let first = |word: &str| word.split(' ').next().unwrap_or(word).to_owned();
    let family = |word: String| match word.as_str() {
        "H65" | "H78" | "H78-raw" | "H81" => "measured".to_owned(),
        _ => word,
    };
    let mut words = name.split('/').map(|all| all.split('+').map(first).map(family));
    let mut all: BTreeSet<String> = BTreeSet::from(["all".to_owned()]);
    for group in ["layer", "pixel", "light"] {
        all.extend(words.next().into_iter().flatten().map(|word| format!("{group} {word}")));
    }
    all
}

/// |z| up to which means are computed.
const FAR: f64 = 5.0;

/// |z| up to which the figure is drawn.
const MOST_DRAWN: f64 = 8.0;

/// Sums of a family.
#[derive(Default)]
struct Family {
    displays: BTreeSet<String>,
    numbers: f64,
    noisy: Vec<f64>,
    beyond: Vec<f64>,
}

/// Returns a table of the families (CSV), and the z-scores of all numbers with noise.
pub(super) fn table(compared: &[(&str, Pair)]) -> (String, Vec<f64>) {
    let mut all: BTreeMap<String, Family> = BTreeMap::new();
    for (name, pair) in compared {
        for family in families(name) {
            let family = all.entry(family).or_default();
            family.displays.insert((*name).to_owned());
            family.numbers += 1.0;
            family.noisy.extend(pair.is_noisy().then(|| pair.z()));
            family.beyond.push(beyond(pair));
        }
    }
    let header = "family,displays,numbers,noisy,mean_z_up_to_5,mean_square_z_up_to_5,percent_beyond_3,percent_beyond_4,worst\n";
    let mut table = header.to_owned();
    for (family, Family { displays, numbers, noisy, beyond }) in &all {
        // What is far beyond is counted apart: a single one would be all of a mean square.
        let near: Vec<f64> = noisy.iter().copied().filter(|z| z.abs() <= FAR).collect();
        let mean = |of: fn(f64) -> f64| near.iter().map(|z| of(*z)).sum::<f64>() / near.len() as f64;
        let percent = |most: f64| 100.0 * beyond.iter().filter(|z| **z > most).count() as f64 / numbers;
        let _ = writeln!(
            table,
            "{family},{},{numbers},{},{:.3},{:.3},{:.3},{:.3},{:.1}",
            displays.len(),
            noisy.len(),
            mean(|z| z),
            mean(|z| z * z),
            percent(3.0),
            percent(4.0),
            beyond.iter().copied().fold(0.0, f64::max)
        );
    }
    (table, all.remove("all").map_or_else(Vec::new, |all| all.noisy))
}

/// Draws the fraction of numbers beyond each |z|, with that of Student's t; the curve ends at the fraction beyond
/// [`MOST_DRAWN`].
pub(super) fn figure(mut z: Vec<f64>) -> String {
    z.iter_mut().for_each(|z| *z = z.abs().min(MOST_DRAWN));
    z.sort_by(f64::total_cmp);
    let count = z.len() as f64;
    // All of the largest ones, and some of the others.
    let step = (z.len() / 400).max(1);
    let drawn = |k: &usize| k.is_multiple_of(step) || k + 100 > z.len();
    let found = (0..z.len()).filter(drawn).map(|k| (z[k], (count - k as f64) / count)).collect();
    let steps = (0..=100).map(|k| 0.06 * f64::from(k));
    let student = steps.map(|z| (z, beyond_student(z))).collect();
    let curve = |name: &str, group, dashed, points| ChartCurve {
        name: name.to_owned(),
        hue: Hue::Group(group),
        dashed,
        marks: false,
        points,
    };
    let curves = vec![curve("found", 0, false, found), curve("Student's t", 3, true, student)];
    let chart_of = Chart {
        x: "Deviation |z|, standard errors".to_owned(),
        y: "Fraction of numbers beyond it".to_owned(),
        logarithmic: true,
        at_least: vec![1.0],
        curves,
    };
    chart(&chart_of, "Deviations of the two solvers on random displays")
}

/// Probability that |t| of 31 degrees of freedom exceeds a number, by Simpson's rule.
fn beyond_student(z: f64) -> f64 {
    const NORM: f64 = 0.395_738_7; // Gamma(16) / (sqrt(31 pi) Gamma(15.5))
    let density = |t: f64| NORM * (1.0 + t * t / 31.0).powi(-16);
    let steps = 200;
    let h = z / f64::from(steps);
    let weight = |k: i32| match k {
        0 => 1.0,
        k if k == steps => 1.0,
        k if k % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let inside: f64 = (0..=steps).map(|k| weight(k) * density(h * f64::from(k))).sum::<f64>() * h / 3.0;
    1.0 - 2.0 * inside
}

#[test]
fn tail_of_student_equals_published_quantiles() {
    for (z, probability) in [(2.0395, 0.05), (2.7440, 0.01), (3.6335, 0.001)] {
        assert!((beyond_student(z) / probability - 1.0).abs() < 2e-3, "{z}: {}", beyond_student(z));
    }
}

#[test]
fn families_of_a_display_are_the_words_of_its_name() {
    let found = families("component+H65 laminated+slab 5e-2/film/diffuse+sky 4 sun");
    let words =
        ["layer component", "layer measured", "layer slab", "light diffuse", "light sky", "pixel film"];
    let expected: Vec<&str> = ["all"].into_iter().chain(words).collect();
    assert_eq!(found.iter().map(String::as_str).collect::<Vec<_>>(), expected);
}
