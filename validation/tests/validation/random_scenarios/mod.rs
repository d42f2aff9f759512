//! The two solvers against each other on random scenario *files*, through the project's own reader: panels and layers,
//! every diffuser and pixel, every kind of light. X, Y, Z of each state and each account of its ledger must scatter as the
//! walk's standard errors say.
//!
//! `PAPILIO_SCENARIOS=300` takes more of them, `PAPILIO_SCENARIOS=17..18` some; `PAPILIO_SCENARIO_SEEDS=2..6` other seeds of the walk.

mod draw;
mod scores;
mod solvers;

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, OnceLock};

use draw::{Drawn, drawn};
use scores::{FAR, Scores};
use solvers::{Pair, SLOW, Walked, scene, walked};

/// How many every day: a few seconds.
const EVERYDAY: usize = 12;

/// Documented refusals (what adding cannot resolve, a film's fringes), and those that take more than a minute: of either at
/// most so many of the scenarios.
const MOST_LEFT_OUT: f64 = 0.01;

/// A range from a variable of the environment: its end alone, or `FROM..TO`.
fn range(variable: &str) -> Option<Range<u64>> {
    let text = std::env::var(variable).ok()?;
    let (from, to) = text.split_once("..").unwrap_or(("0", &text));
    Some(from.parse().unwrap()..to.parse().unwrap())
}

fn seeds() -> Range<u64> {
    range("PAPILIO_SCENARIO_SEEDS").unwrap_or(0..2)
}

/// `f` of each, on all processors, in order. (Not by rayon, whose threads take up other work while a run waits for its own.)
fn each<T: Sync, R: Send>(all: &[T], f: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let found: Mutex<Vec<(usize, R)>> = Mutex::new(Vec::new());
    let work = || {
        while let Some((number, one)) = {
            let number = next.fetch_add(1, Ordering::Relaxed);
            all.get(number).map(|one| (number, one))
        } {
            let result = f(one);
            found.lock().unwrap().push((number, result));
        }
    };
    std::thread::scope(|scope| {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        (0..threads).for_each(|_| drop(scope.spawn(work)));
    });
    let mut found = found.into_inner().unwrap();
    found.sort_by_key(|(number, _)| *number);
    found.into_iter().map(|(_, one)| one).collect()
}

/// The walk's part of those of every day, for all tests here: the first that take adding no seconds.
fn everyday() -> &'static [Result<Walked, String>] {
    static WALKED: OnceLock<Vec<Result<Walked, String>>> = OnceLock::new();
    WALKED.get_or_init(|| {
        let fast: Vec<Drawn> = (0..).map(drawn).filter(|drawn| !drawn.is_slow).take(EVERYDAY).collect();
        each(&fast, |drawn| walked(drawn.clone(), seeds()))
    })
}

/// A scenario in both solvers.
enum Outcome {
    Compared { name: String, text: String, runs: Vec<Vec<Pair>>, seconds: [f64; 2] },
    Refused(String),
}

fn outcome(walked: &Result<Walked, String>) -> Outcome {
    let walked = match walked {
        Ok(walked) => walked,
        Err(why) => return Outcome::Refused(why.clone()),
    };
    let (adding, seconds) = walked.adding(&walked.scene);
    let name = format!("{} ({})", walked.drawn.number, walked.drawn.name);
    match adding {
        Err(why) => Outcome::Refused(format!("{name}: {why}, after {seconds:.1} s\n{}", walked.drawn.text)),
        Ok(adding) => Outcome::Compared {
            name,
            text: walked.drawn.text.clone(),
            runs: walked.pairs(&adding),
            seconds: [seconds, walked.seconds / walked.runs.len() as f64],
        },
    }
}

impl Outcome {
    /// One line; with its text and what is far off, where there is anything to look at.
    fn words(&self) -> String {
        let (name, text, runs, seconds) = match self {
            Self::Refused(why) => return format!("refused: {why}"),
            Self::Compared { name, text, runs, seconds } => (name, text, runs, seconds),
        };
        let mut words = format!("{name}: adding {:.2} s, walk {:.2} s", seconds[0], seconds[1]);
        let is_far = |pair: &&Pair| pair.z().abs() > FAR;
        for (run, pairs) in runs.iter().enumerate() {
            for pair in pairs.iter().filter(is_far) {
                words += &format!("\n  run {run}: {}", pair.words());
            }
        }
        if runs.iter().flatten().any(|pair| is_far(&pair)) {
            words += &format!("\n{text}");
        }
        words
    }
}

#[test]
fn random_scenarios_scatter_as_the_errors_say() {
    let told = |outcome: Outcome| {
        println!("{}", outcome.words());
        outcome
    };
    let outcomes = match range("PAPILIO_SCENARIOS") {
        Some(numbers) => {
            let numbers: Vec<u64> = numbers.collect();
            each(&numbers, |number| told(outcome(&walked(drawn(*number), seeds()))))
        }
        None => each(everyday(), |walked| told(outcome(walked))),
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
    println!("X, Y, Z: {}\nledger: {}", radiances.words(), ledgers.words());
    for count in [refused, slow.len()] {
        assert!(count as f64 <= MOST_LEFT_OUT * of as f64, "{refused} refused, {} slow", slow.len());
    }
    radiances.hold().unwrap();
    ledgers.hold().unwrap();
}

/// Adding of scenarios that are a little wrong, `wrong` of their texts, against the walk of the right ones.
fn of_wrong<'a>(all: impl Iterator<Item = &'a Walked>, wrong: impl Fn(&str) -> String) -> [Scores; 2] {
    let mut scores = [Scores::default(), Scores::default()];
    for walked in all {
        let (adding, _) = walked.adding(&scene(&wrong(&walked.drawn.text)).unwrap());
        for pairs in walked.pairs(&adding.unwrap()) {
            scores[0].add(pairs.iter().filter(|pair| !pair.is_of_ledger));
            scores[1].add(pairs.iter().filter(|pair| pair.is_of_ledger));
        }
    }
    scores
}

/// The power of the comparison: light that passes twice what absorbs 0.002 of it is 0.4 % less.
#[test]
fn an_absorptance_that_is_wrong_by_two_thousandths_is_caught() {
    let wrong = |text: &str| {
        // The topmost layer stands right after the wavelengths.
        let is_first =
            |kind: &str| text.contains(&format!("step_nm = 50\n[[display.layers]]\nkind = \"{kind}\""));
        let more = if !text.contains("[[display.layers]]") {
            "[[display.front]]\nabsorptance = 0.002\n"
        } else if is_first("medium") || is_first("slab") {
            // The bare face that is there in any case, so that the sheet lies in the air.
            "[[display.layers]]\nkind = \"sheet\"\nabsorptance = 0.002\n[[display.layers]]\nkind = \"fresnel\"\n"
        } else {
            "[[display.layers]]\nkind = \"sheet\"\nabsorptance = 0.002\n"
        };
        text.replacen("step_nm = 50\n", &format!("step_nm = 50\n{more}"), 1)
    };
    let scores = of_wrong(everyday().iter().flatten(), wrong);
    for (what, scores) in ["X, Y, Z", "ledger"].into_iter().zip(scores) {
        println!("{what}: {}", scores.words());
        assert!(scores.hold().unwrap_err().contains("mean square"), "{what}: {}", scores.words());
    }
}

/// A haze that is 1 % too high, of four panels that are given by their haze.
#[test]
fn a_haze_that_is_wrong_by_a_hundredth_is_caught() {
    let of_haze = (0..).map(drawn).filter(|drawn| drawn.text.contains("\nhaze = ")).take(4);
    let all: Vec<Walked> = of_haze.map(|drawn| walked(drawn, seeds()).unwrap()).collect();
    let wrong = |text: &str| {
        let lines = text.lines().map(|line| match line.strip_prefix("haze = ") {
            Some(haze) => format!("haze = {}\n", 1.01 * haze.parse::<f64>().unwrap()),
            None => format!("{line}\n"),
        });
        lines.collect()
    };
    let scores = of_wrong(all.iter(), wrong);
    for (what, scores) in ["X, Y, Z", "ledger"].into_iter().zip(scores) {
        println!("{what}: {}", scores.words());
        assert!(scores.hold().unwrap_err().contains("mean square"), "{what}: {}", scores.words());
    }
}
