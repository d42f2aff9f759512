//! A campaign over the whole grammar: both solvers on random displays whose keys go to their ends.
//!
//! Each display is compared once: X, Y, Z of each state and its ledger. Where the noise of Monte Carlo is most of the
//! difference, its z-scores are collected; where the stated error of adding is, the error of adding must hold.
//!
//! The full run writes each display into `target/random/wide.txt` and does not repeat it: an interrupted run is
//! resumed. Delete the file after a change of a solver. `PAPILIO_WIDE=0..300` selects displays, and
//! `target/random/z-scores.svg` shows the scores of all displays of the file.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs::{self, OpenOptions};
use std::io::Write as _;
use std::path::PathBuf;
use std::sync::Mutex;

use papilio_figures::{Chart, ChartCurve, Hue, chart};
use papilio_testing::sized;

use super::draw::wide::wide;
use super::solvers::{Pair, monte_carlo_runs};
use super::{each, range};

/// Displays in every day's test, and in the full campaign.
const DISPLAYS: [u64; 2] = [6, 10_000];

/// Longest time of a solver for a display, seconds.
const LONGEST: f64 = 30.0;

/// Deviation beyond the stated error, in standard errors, from which on a stated error does not hold.
const FAR: f64 = 4.0;

/// Largest fraction of numbers beyond: 99 % hold.
const MOST_FAR: f64 = 0.01;

/// A display that was compared, or the reason why it was not.
struct Row {
    number: u64,
    name: String,
    outcome: Result<Vec<Score>, String>,
}

#[derive(Debug, Clone, Copy)]
struct Score {
    /// Deviation over the quadratic sum of both errors.
    z: f64,
    /// True if the noise of Monte Carlo is most of the expected difference.
    is_noisy: bool,
    /// What is beyond the error of adding, in standard errors of Monte Carlo.
    beyond: f64,
}

fn score(pair: &Pair) -> Score {
    let distance = (pair.walk - pair.adding).abs();
    let stated = pair.discretisation_error + pair.tables();
    let beyond = (distance - stated).max(0.0) / (pair.standard_error + 1e-9);
    Score { z: pair.z(), is_noisy: pair.is_noisy(), beyond }
}

impl Row {
    fn of(number: u64) -> Self {
        let drawn = wide(number);
        let name = drawn.name.clone();
        let outcome = monte_carlo_runs(drawn, 0..1, LONGEST).and_then(|runs| {
            let (adding, _) = runs.adding(&runs.scene);
            let pairs = runs.pairs(&adding?);
            for pair in pairs[0].iter().filter(|pair| score(pair).beyond > FAR) {
                println!("{number}: {}", pair.description());
            }
            if pairs[0].iter().any(|pair| score(pair).beyond > FAR) {
                println!("{}", runs.drawn.text);
            }
            Ok(pairs[0].iter().map(score).collect())
        });
        Self { number, name, outcome }
    }

    fn to_line(&self) -> String {
        let mut line = format!("{}\t{}\t", self.number, self.name);
        match &self.outcome {
            Err(why) => line += &format!("refused: {}", why.lines().next().unwrap_or_default()),
            Ok(scores) => {
                for Score { z, is_noisy, beyond } in scores {
                    let _ = write!(line, "{z:.3}:{}:{beyond:.3} ", u8::from(*is_noisy));
                }
            }
        }
        line
    }

    fn from_line(line: &str) -> Option<Self> {
        let mut parts = line.split('\t');
        let (number, name, rest) = (parts.next()?.parse().ok()?, parts.next()?.to_owned(), parts.next()?);
        if let Some(why) = rest.strip_prefix("refused: ") {
            return Some(Self { number, name, outcome: Err(why.to_owned()) });
        }
        let score = |word: &str| {
            let mut parts = word.split(':');
            let z = parts.next()?.parse().ok()?;
            let is_noisy = parts.next()? == "1";
            Some(Score { z, is_noisy, beyond: parts.next()?.parse().ok()? })
        };
        let scores = rest.split_whitespace().map(score).collect::<Option<_>>()?;
        Some(Self { number, name, outcome: Ok(scores) })
    }
}

/// The folder of the record and the figure.
fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).with_file_name("random")
}

/// Draws the fraction of numbers beyond each |z|, with that of Student's t.
fn figure(mut z: Vec<f64>) -> String {
    z.iter_mut().for_each(|z| *z = z.abs());
    z.sort_by(f64::total_cmp);
    let count = z.len() as f64;
    let step = (z.len() / 400).max(1);
    let found = z.iter().enumerate().step_by(step).map(|(k, z)| (*z, (count - k as f64) / count)).collect();
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
fn deviations_over_the_whole_grammar_agree_with_errors() {
    let numbers = range("PAPILIO_WIDE").unwrap_or(0..sized(DISPLAYS[0], DISPLAYS[1]));
    let record = folder().join("wide.txt");
    let mut rows: BTreeMap<u64, Row> = BTreeMap::new();
    let file = sized(None, Some(())).map(|()| {
        fs::create_dir_all(folder()).unwrap();
        let text = fs::read_to_string(&record).unwrap_or_default();
        rows.extend(text.lines().filter_map(Row::from_line).map(|row| (row.number, row)));
        Mutex::new(OpenOptions::new().create(true).append(true).open(&record).unwrap())
    });
    let missing: Vec<u64> = numbers.filter(|number| !rows.contains_key(number)).collect();
    let new = each(&missing, |number| {
        if missing.len() == 1 {
            println!("{}", wide(*number).text);
        }
        let row = Row::of(*number);
        if let Some(file) = &file {
            writeln!(file.lock().unwrap(), "{}", row.to_line()).unwrap();
        }
        row
    });
    rows.extend(new.into_iter().map(|row| (row.number, row)));
    let mut refused: BTreeMap<&str, usize> = BTreeMap::new();
    let (mut noisy, mut count, mut far, mut worst) = (Vec::new(), 0.0, 0.0, (0.0, ""));
    for row in rows.values() {
        match &row.outcome {
            Err(why) => *refused.entry(why).or_default() += 1,
            Ok(scores) => {
                for score in scores {
                    count += 1.0;
                    far += f64::from(u8::from(score.beyond > FAR));
                    if score.beyond > worst.0 {
                        worst = (score.beyond, &row.name);
                    }
                    noisy.extend(score.is_noisy.then_some(score.z));
                }
            }
        }
    }
    println!("refused: {refused:#?}");
    let square = noisy.iter().map(|z| z * z).sum::<f64>() / noisy.len() as f64;
    println!(
        "{} displays, {count} numbers, {} noisy: mean square of z {square:.3} (Student's t: 1.069); {:.3} % beyond {FAR} \
         standard errors and the stated error of adding; worst {worst:?}",
        rows.len(),
        noisy.len(),
        100.0 * far / count
    );
    if file.is_some() {
        fs::write(folder().join("z-scores.svg"), figure(noisy)).unwrap();
    }
    assert!(far <= MOST_FAR * count, "{far} of {count} numbers are beyond the stated errors");
}

#[test]
fn tail_of_student_equals_published_quantiles() {
    for (z, probability) in [(2.0395, 0.05), (2.7440, 0.01), (3.6335, 0.001)] {
        assert!((beyond_student(z) / probability - 1.0).abs() < 2e-3, "{z}: {}", beyond_student(z));
    }
}
