//! The two solvers against each other on random scenario *files*, through the project's own reader: panels and layers,
//! every diffuser and pixel, every kind of light. X, Y, Z of each state and each account of its ledger must scatter as the
//! walk's standard errors say.
//!
//! `PAPILIO_SCENARIOS=300` takes more of them, `PAPILIO_SCENARIOS=17..18` some; `PAPILIO_SCENARIO_SEEDS=2..6` other seeds of the walk.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test says what it expects by unwrapping")]

mod draw;
mod scores;
mod solvers;

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, OnceLock};

use draw::drawn;
use scores::Scores;
use solvers::{Pair, SLOW, Walked, scene, walked};

/// How many every day: a few seconds.
const EVERYDAY: u64 = 12;

/// A range from a variable of the environment: its end alone, or `FROM..TO`.
fn range(variable: &str, default: Range<u64>) -> Range<u64> {
    let Ok(text) = std::env::var(variable) else { return default };
    let (from, to) = text.split_once("..").unwrap_or(("0", &text));
    from.parse().unwrap()..to.parse().unwrap()
}

fn seeds() -> Range<u64> {
    range("PAPILIO_SCENARIO_SEEDS", 0..2)
}

/// `f` of each number, on all processors, in order.
fn all<T: Send>(numbers: Range<u64>, f: impl Fn(u64) -> T + Sync) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let found: Mutex<Vec<(u64, T)>> = Mutex::new(Vec::new());
    let work = || {
        loop {
            let number = numbers.start + next.fetch_add(1, Ordering::Relaxed) as u64;
            if number >= numbers.end {
                return;
            }
            let one = f(number);
            found.lock().unwrap().push((number, one));
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

/// Those of every day by the walk, for all tests here.
fn everyday() -> &'static [Result<Walked, String>] {
    static WALKED: OnceLock<Vec<Result<Walked, String>>> = OnceLock::new();
    WALKED.get_or_init(|| all(0..EVERYDAY, |number| walked(drawn(number), seeds())))
}

/// A scenario in both solvers.
enum Outcome {
    Compared { name: String, text: String, runs: Vec<Vec<Pair>>, seconds: [f64; 2] },
    Refused(String),
}

fn outcome(number: u64, walked: &Result<Walked, String>) -> Outcome {
    let walked = match walked {
        Ok(walked) => walked,
        Err(why) => return Outcome::Refused(format!("{number}: {why}\n{}", drawn(number).text)),
    };
    let (adding, seconds) = walked.adding(&walked.scene);
    let name = format!("{number} ({})", walked.drawn.name);
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

#[test]
fn random_scenarios_scatter_as_the_errors_say() {
    let numbers = range("PAPILIO_SCENARIOS", 0..EVERYDAY);
    let one = |number: u64| match number {
        ..EVERYDAY => outcome(number, &everyday()[number as usize]),
        _ => outcome(number, &walked(drawn(number), seeds())),
    };
    let outcomes = all(numbers, one);
    let (mut radiances, mut ledgers) = (Scores::default(), Scores::default());
    let (mut refused, mut slow) = (Vec::new(), Vec::new());
    for outcome in &outcomes {
        match outcome {
            Outcome::Refused(why) => refused.push(why),
            Outcome::Compared { name, text, runs, seconds } => {
                println!("{name}: adding {:.2} s, walk {:.2} s", seconds[0], seconds[1]);
                for (run, pairs) in runs.iter().enumerate() {
                    radiances.add(pairs.iter().filter(|pair| !pair.is_of_ledger));
                    ledgers.add(pairs.iter().filter(|pair| pair.is_of_ledger));
                    for pair in pairs.iter().filter(|pair| pair.z().abs() > 4.0) {
                        println!("  z {:.2} of run {run}: {pair:?}", pair.z());
                    }
                }
                if runs.iter().flatten().any(|pair| pair.z().abs() > 4.0) {
                    println!("{text}");
                }
                if seconds.iter().any(|seconds| *seconds > SLOW) {
                    slow.push(name);
                }
            }
        }
    }
    refused.iter().for_each(|why| println!("refused: {why}"));
    slow.iter().for_each(|name| println!("slow: {name}"));
    println!("X, Y, Z: {}\nledger: {}", radiances.words(), ledgers.words());
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
        // A sheet stands in the air above: the next layer needs a face of its own.
        let more = if text.contains("[[display.layers]]") {
            "[[display.layers]]\nkind = \"sheet\"\nabsorptance = 0.002\n"
        } else {
            "[[display.front]]\nabsorptance = 0.002\n"
        };
        // Above all others, which come right after the wavelengths.
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
