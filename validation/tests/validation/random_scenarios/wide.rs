//! A campaign over the whole grammar: both solvers on random displays whose keys go to their ends.
//!
//! Each display is compared once: X, Y, Z of each state and its ledger. Where the noise of Monte Carlo is most of the
//! difference, its z-scores are collected; where the stated error of adding is, the error of adding must hold.
//!
//! The full run writes each display into `target/random/wide-0-of-1.csv` and does not repeat it; it can be computed in
//! parts ([`papilio_testing::Campaign`]). Delete the files after a change of a solver. `PAPILIO_WIDE=0..300` selects
//! displays, without a file; a single one is printed. `z-scores.svg` and `z-scores.csv` show all displays of the files.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use std::time::Instant;

use papilio_testing::{Campaign, CaseRow, each, sized};

use super::draw::wide::wide;
use super::range;
use super::solvers::{Pair, monte_carlo_runs};
use super::summary::{figure, table};

/// Displays in every day's test, and in the full campaign.
const DISPLAYS: [u64; 2] = [6, 10_000];

/// Longest time of a solver for a display, seconds.
const LONGEST: f64 = 3.0;

/// Deviation beyond the stated error, in standard errors, from which on a stated error does not hold.
const FAR: f64 = 4.0;

/// Largest fraction of numbers beyond: 99 % hold.
const MOST_FAR: f64 = 0.01;

/// First word of the quantity of a display that was not compared, before the reason.
const REFUSED: &str = "refused: ";

/// Returns what is beyond the error of adding, in standard errors of Monte Carlo.
pub(super) fn beyond(pair: &Pair) -> f64 {
    let distance = (pair.walk - pair.adding).abs();
    let stated = pair.discretisation_error + pair.tables();
    (distance - stated).max(0.0) / (pair.standard_error + 1e-9)
}

/// Compares the solvers on a display, and returns its name, its rows and the times of both.
fn compare(number: u64) -> (String, Vec<CaseRow>, [f64; 2]) {
    let drawn = wide(number);
    let (name, text, begun) = (drawn.name.clone(), drawn.text.clone(), Instant::now());
    let runs = monte_carlo_runs(drawn, 0..1, LONGEST);
    let walked = begun.elapsed().as_secs_f64();
    let outcome = runs.and_then(|runs| Ok(runs.pairs(&runs.adding(&runs.scene).0?).remove(0)));
    let times = [walked, begun.elapsed().as_secs_f64() - walked];
    let row = |pair: &Pair| {
        let Pair { what, walk, standard_error, adding, discretisation_error, .. } = pair;
        CaseRow::new(number, &name, what, [*walk, *standard_error, *adding, *discretisation_error])
    };
    let rows = match outcome {
        Err(why) => {
            let why = why.lines().next().unwrap_or_default().to_owned();
            vec![CaseRow::new(number, &name, &format!("{REFUSED}{why}"), [])]
        }
        Ok(pairs) => {
            if pairs.iter().any(|pair| beyond(pair) > FAR) {
                println!("{text}");
            }
            for pair in pairs.iter().filter(|pair| beyond(pair) > FAR) {
                println!("{number}: {}", pair.description());
            }
            pairs.iter().map(row).collect()
        }
    };
    (name, rows, times)
}

/// Returns the numbers of a row of a file.
fn pair(row: &CaseRow) -> Option<Pair> {
    let [walk, standard_error, adding, discretisation_error] = *row.numbers.as_slice() else { return None };
    let is_of_ledger = !matches!(row.quantity.rsplit(' ').next(), Some("X" | "Y" | "Z"));
    let what = row.quantity.clone();
    Some(Pair { what, is_of_ledger, walk, standard_error, adding, discretisation_error })
}

#[test]
fn deviations_over_the_whole_grammar_agree_with_errors() {
    let chosen = range("PAPILIO_WIDE");
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).with_file_name("random");
    let header = "monte_carlo,standard_error,adding,stated_error";
    let campaign = sized(None, Some(())).filter(|()| chosen.is_none());
    let campaign = campaign.map(|()| Campaign::open(&folder, "wide", header));
    let numbers = chosen.unwrap_or(0..sized(DISPLAYS[0], DISPLAYS[1]));
    let missing = campaign.as_ref().map_or(numbers.clone().collect(), |files| files.missing(numbers));
    let new = each(&missing, |number| {
        if missing.len() == 1 {
            println!("{}", wide(*number).text);
        }
        let (name, rows, times) = compare(*number);
        if let Some(campaign) = &campaign {
            campaign.append(*number, &name, &rows, &times);
        }
        (*number, rows)
    });
    let rows: BTreeMap<u64, Vec<CaseRow>> =
        campaign.as_ref().map_or_else(|| new.into_iter().collect(), Campaign::rows);
    let (mut refused, mut compared): (BTreeMap<&str, usize>, Vec<(&str, Pair)>) = Default::default();
    for row in rows.values().flatten() {
        match row.quantity.strip_prefix(REFUSED) {
            Some(why) => *refused.entry(why.split(" it needs").next().unwrap_or(why)).or_default() += 1,
            None => compared.extend(pair(row).map(|pair| (row.name.as_str(), pair))),
        }
    }
    println!("{} displays; refused: {refused:#?}", rows.len());
    let (table, noisy) = table(&compared);
    println!("{table}");
    if let Some(campaign) = &campaign {
        fs::write(campaign.folder().join("z-scores.csv"), table).unwrap();
        fs::write(campaign.folder().join("z-scores.svg"), figure(noisy)).unwrap();
    }
    let far = compared.iter().filter(|(_, pair)| beyond(pair) > FAR).count() as f64;
    let count = compared.len() as f64;
    assert!(far <= MOST_FAR * count, "{far} of {count} numbers are beyond the stated errors");
}
