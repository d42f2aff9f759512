//! Comparison of the two solvers on random scenario *files*, read by the project's own reader: panels and
//! layers, all diffusers and pixels, all kinds of light. The deviations of X, Y, Z of each state and of the
//! entries of its ledger must agree with the Monte Carlo standard errors.
//!
//! `PAPILIO_SCENARIOS=100` sets their number, `PAPILIO_SCENARIOS=17..18` selects some;
//! `PAPILIO_SCENARIO_SEEDS=2..6` selects other Monte Carlo seeds.

pub(crate) mod draw;
mod scores;
mod solvers;
pub(crate) mod summary;
mod wide;

use std::ops::Range;
use std::sync::OnceLock;

use draw::{Drawn, drawn};
pub(crate) use papilio_testing::each;
use papilio_testing::sized;
use scores::{FAR, Scores};
use solvers::{LONGEST, MonteCarloRuns, Pair, SLOW, monte_carlo_runs, scene};

/// Number of scenarios by default: a few seconds.
const EVERYDAY: usize = 12;

/// Number of scenarios in `cargo xtask full`: the mean square of the z-scores is known to 10 %.
const ALL: u64 = 300;

/// Largest fraction of scenarios that are refused for documented reasons. Some are drawn against the laws (a
/// Ward lobe that reflects more light than arrives, one in a dispersive medium): 4 of 300.
const MAX_REFUSED: f64 = 0.02;

/// Reads a range from an environment variable: only its end, or `FROM..TO`.
pub(crate) fn range(variable: &str) -> Option<Range<u64>> {
    let text = std::env::var(variable).ok()?;
    let (from, to) = text.split_once("..").unwrap_or(("0", &text));
    Some(from.parse().unwrap()..to.parse().unwrap())
}

fn seeds() -> Range<u64> {
    range("PAPILIO_SCENARIO_SEEDS").unwrap_or(0..2)
}

/// Returns the Monte Carlo runs of the default scenarios, for all tests of this file: the first scenarios
/// that are fast with adding.
fn everyday() -> &'static [Result<MonteCarloRuns, String>] {
    static RUNS: OnceLock<Vec<Result<MonteCarloRuns, String>>> = OnceLock::new();
    RUNS.get_or_init(|| {
        let fast: Vec<Drawn> = (0..).map(drawn).filter(|drawn| !drawn.is_slow).take(EVERYDAY).collect();
        each(&fast, |drawn| monte_carlo_runs(drawn.clone(), seeds(), LONGEST))
    })
}

/// The comparison of both solvers for a scenario.
enum Outcome {
    Compared { name: String, text: String, runs: Vec<Vec<Pair>>, seconds: [f64; 2] },
    Refused(String),
}

fn outcome(monte_carlo: &Result<MonteCarloRuns, String>) -> Outcome {
    let monte_carlo = match monte_carlo {
        Ok(monte_carlo) => monte_carlo,
        Err(why) => return Outcome::Refused(why.clone()),
    };
    let (adding, seconds) = monte_carlo.adding(&monte_carlo.scene);
    let name = format!("{} ({})", monte_carlo.drawn.number, monte_carlo.drawn.name);
    match adding {
        Err(why) => {
            Outcome::Refused(format!("{name}: {why}, after {seconds:.1} s\n{}", monte_carlo.drawn.text))
        }
        Ok(adding) => Outcome::Compared {
            name,
            text: monte_carlo.drawn.text.clone(),
            runs: monte_carlo.pairs(&adding),
            seconds: [seconds, monte_carlo.seconds / monte_carlo.runs.len() as f64],
        },
    }
}

impl Outcome {
    /// Describes the outcome in one line, followed by large deviations and the text of the scenario, if there
    /// are any.
    fn description(&self) -> String {
        let (name, text, runs, seconds) = match self {
            Self::Refused(why) => return format!("refused: {why}"),
            Self::Compared { name, text, runs, seconds } => (name, text, runs, seconds),
        };
        let mut description = format!("{name}: adding {:.2} s, Monte Carlo {:.2} s", seconds[0], seconds[1]);
        let is_far = |pair: &&Pair| pair.z().abs() > FAR;
        for (run, pairs) in runs.iter().enumerate() {
            for pair in pairs.iter().filter(is_far) {
                description += &format!("\n  run {run}: {}", pair.description());
            }
        }
        if runs.iter().flatten().any(|pair| is_far(&pair)) {
            description += &format!("\n{text}");
        }
        description
    }
}

#[test]
fn deviations_of_random_scenarios_agree_with_errors() {
    let printed = |outcome: Outcome| {
        println!("{}", outcome.description());
        outcome
    };
    let outcomes = match range("PAPILIO_SCENARIOS").or(sized(None, Some(0..ALL))) {
        Some(numbers) => {
            let numbers: Vec<u64> = numbers.collect();
            each(&numbers, |number| printed(outcome(&monte_carlo_runs(drawn(*number), seeds(), LONGEST))))
        }
        None => each(everyday(), |runs| printed(outcome(runs))),
    };
    let (mut radiances, mut ledgers) = (Scores::default(), Scores::default());
    let (mut refused, mut slow) = (0_usize, Vec::new());
    for outcome in &outcomes {
        match outcome {
            Outcome::Refused(_) => refused += 1,
            Outcome::Compared { name, runs, seconds, .. } => {
                for pairs in runs {
                    radiances.add(pairs.iter().filter(|pair| !pair.is_of_ledger));
                    ledgers.add(pairs.iter().filter(|pair| pair.is_of_ledger));
                }
                if seconds.iter().any(|seconds| *seconds > SLOW) {
                    slow.push(name);
                }
            }
        }
    }
    let of = outcomes.len();
    println!("{refused} of {of} refused, {} took more than {SLOW} s: {slow:?}", slow.len());
    println!("X, Y, Z: {}\nledger: {}", radiances.summary(), ledgers.summary());
    assert!(refused as f64 <= MAX_REFUSED * of as f64, "{refused} of {of} refused");
    radiances.check().unwrap();
    ledgers.check().unwrap();
}

/// Compares adding of slightly wrong scenarios (`wrong` of their texts) with the Monte Carlo runs of the
/// correct ones.
fn of_wrong<'a>(
    all: impl Iterator<Item = &'a MonteCarloRuns>,
    wrong: impl Fn(&str) -> String,
) -> [Scores; 2] {
    let mut scores = [Scores::default(), Scores::default()];
    for monte_carlo in all {
        let (adding, _) = monte_carlo.adding(&scene(&wrong(&monte_carlo.drawn.text)).unwrap());
        for pairs in monte_carlo.pairs(&adding.unwrap()) {
            scores[0].add(pairs.iter().filter(|pair| !pair.is_of_ledger));
            scores[1].add(pairs.iter().filter(|pair| pair.is_of_ledger));
        }
    }
    scores
}

/// Power of the test: light that passes twice through an absorptance of 0.002 is reduced by 0.4 %.
#[test]
fn absorptance_error_of_two_thousandths_is_detected() {
    let wrong = |text: &str| {
        // The topmost layer follows directly after the wavelengths.
        let is_first =
            |kind: &str| text.contains(&format!("step_nm = 50\n[[display.layers]]\nkind = \"{kind}\""));
        let more = if !text.contains("[[display.layers]]") {
            "[[display.front]]\nabsorptance = 0.002\n"
        } else if is_first("medium") || is_first("slab") {
            // The bare interface, which is otherwise implicit, places the component in the air.
            "[[display.layers]]\nkind = \"component\"\nabsorptance = 0.002\n[[display.layers]]\nkind = \"fresnel\"\n"
        } else {
            "[[display.layers]]\nkind = \"component\"\nabsorptance = 0.002\n"
        };
        text.replacen("step_nm = 50\n", &format!("step_nm = 50\n{more}"), 1)
    };
    let scores = of_wrong(everyday().iter().flatten(), wrong);
    for (what, scores) in ["X, Y, Z", "ledger"].into_iter().zip(scores) {
        println!("{what}: {}", scores.summary());
        assert!(scores.check().unwrap_err().contains("mean square"), "{what}: {}", scores.summary());
    }
}

/// Four panels that are specified by their haze, with a haze that is 1 % too high.
#[test]
fn haze_error_of_one_percent_is_detected() {
    let of_haze = (0..).map(drawn).filter(|drawn| drawn.text.contains("\nhaze = ")).take(4);
    let all: Vec<MonteCarloRuns> =
        of_haze.map(|drawn| monte_carlo_runs(drawn, seeds(), LONGEST).unwrap()).collect();
    let wrong = |text: &str| {
        let lines = text.lines().map(|line| match line.strip_prefix("haze = ") {
            Some(haze) => format!("haze = {}\n", 1.01 * haze.parse::<f64>().unwrap()),
            None => format!("{line}\n"),
        });
        lines.collect()
    };
    let scores = of_wrong(all.iter(), wrong);
    for (what, scores) in ["X, Y, Z", "ledger"].into_iter().zip(scores) {
        println!("{what}: {}", scores.summary());
        assert!(scores.check().unwrap_err().contains("mean square"), "{what}: {}", scores.summary());
    }
}
