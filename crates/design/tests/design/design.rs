//! Designs and searches from outside: two roads to the same numbers, slopes, and what a search may not depend on.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use papilio_design::search::{Answer, Course, Found, Kept, Piece, Record, Search, front};
use papilio_design::{Condition, DesignError, Evaluator, Key, Named, Quantity, Study, Values, Variable};
use papilio_display::DisplayError;
use papilio_display::scene::Metric;
use papilio_scenario::{Optimisation, Varied};

const DISPLAY: &str = r#"
[spectrum]
step_nm = 20
[display.diffuser]
model = "k-correlation"
haze = 0.78
total_transmittance = 0.9
[display.pixel]
model = "film"
substrate = "Al"
area = { red = 0.4, green = 0.4, blue = 0.2 }
gap_nm = { red = 275.9, green = 192.3, blue = 137.8, dark = 20.0 }
film = [
  { material = "Si3N4", thickness_nm = 55.9 },
  { material = "Cr:Johnson", thickness_nm = 12.15 },
  { material = "SiO2", thickness_nm = 38.6 },
  { material = "AlOx", thickness_nm = 9.0 },
  { material = "air", thickness_nm = "gap" },
]
[lighting]
preset = "indoor"
"#;

const SEARCH: &str = r#"
[optimize]
starts = 4
evaluations = 400
points = 5
[[optimize.variables]]
key = "display.pixel.film.0.thickness_nm"
bounds = [0, 120]
[[optimize.variables]]
key = "display.pixel.film.1.thickness_nm"
bounds = [3, 25]
[[optimize.variables]]
key = "display.pixel.area.red"
compensated_by = "display.pixel.area.green"
bounds = [0.2, 0.6]
[[optimize.constraints]]
metric = "contrast_ratio"
at_least = 5
[[optimize.objectives]]
metric = "gamut_percent_srgb"
aim = "maximise"
"#;

const SECOND: &str = "[[optimize.objectives]]\nmetric = \"white.Y\"\naim = \"maximise\"\n";

static STOP: AtomicBool = AtomicBool::new(false);

fn metric(name: &str) -> Quantity {
    let (state, name) =
        name.split_once('.').map_or((None, name), |(state, name)| (Some(state.to_owned()), name));
    Quantity::Metric { view: 0, state, metric: Metric::named(name).unwrap() }
}

/// A study of some keys and metrics.
fn study(keys: &[&str], metrics: &[&str]) -> Study {
    let paths: Vec<String> = keys.iter().map(|key| (*key).to_owned()).collect();
    let varied = Varied::from_text(DISPLAY, "test.toml", Path::new(""), &[], &paths).unwrap();
    let variable = |key: &&str| Variable {
        name: (*key).to_owned(),
        keys: vec![Key::plain(*key)],
        values: Values::Number,
    };
    let named = |name: &&str| Named { name: (*name).to_owned(), condition: 0, quantity: metric(name) };
    Study {
        conditions: vec![Condition { name: String::new(), varied }],
        variables: keys.iter().map(variable).collect(),
        quantities: metrics.iter().map(named).collect(),
    }
}

fn search(text: &str) -> (Arc<Search>, Evaluator<'static>) {
    let said = Optimisation::from_text(&format!("{DISPLAY}{text}"), "test.toml", Path::new(""), &[]).unwrap();
    let mut evaluator = Evaluator::new(Arc::new(Study::of(&said)), &STOP);
    (Arc::new(Search::new(said, &mut evaluator).unwrap()), evaluator)
}

fn run(
    search: &Arc<Search>,
    evaluator: &Evaluator<'_>,
    threads: usize,
    kept: &Kept,
) -> (Vec<Found>, Vec<Record>) {
    let mut course = Course::new(Arc::clone(search), kept.clone(), threads);
    let mut records = Vec::new();
    let mut tell = |record: &Record, _: (usize, usize)| {
        records.push(record.clone());
        Ok::<(), DesignError>(())
    };
    course.run(evaluator, threads, &mut tell).unwrap();
    (course.found(), records)
}

/// Thicknesses, gaps, areas: the kept kernels give what a run of the scenario gives, to what two levels differ by.
#[test]
fn film_designs_are_worth_what_their_runs_are() {
    let keys = [
        "display.pixel.film.0.thickness_nm",
        "display.pixel.gap_nm.red",
        "display.pixel.gap_nm.dark",
        "display.pixel.fill_factor",
    ];
    let metrics = ["gamut_percent_srgb", "contrast_ratio", "white.Y", "red.L_star"];
    let study = study(&keys, &metrics);
    let mut evaluator = Evaluator::new(Arc::new(study.clone()), &STOP);
    for design in [[55.9, 275.9, 20.0, 1.0], [0.0, 250.0, 40.0, 0.8], [110.0, 340.0, 0.0, 0.9]] {
        let fast = evaluator.evaluate(&design).unwrap();
        let result = evaluator.run(&design, 0).unwrap();
        for (named, fast) in study.quantities.iter().zip(fast) {
            let (fast, full) = (fast.unwrap(), named.quantity.of(&result).unwrap());
            assert!((fast - full).abs() < 2e-3 * full.abs(), "{} at {design:?}: {fast}, {full}", named.name);
        }
    }
}

/// What is not a number of the film takes the general road; both roads have slopes.
#[test]
fn slopes_are_those_of_differences() {
    let metrics = ["white.Y", "contrast_ratio"];
    for (key, own) in [("display.pixel.gap_nm.green", 192.3), ("display.diffuser.transmittance", 0.9)] {
        let mut evaluator = Evaluator::new(Arc::new(study(&[key], &metrics)), &STOP);
        let slopes = evaluator.derivatives(&[own]).unwrap();
        let step = 1e-3 * own;
        let [above, below] = [step, -step].map(|step| evaluator.evaluate(&[own + step]).unwrap());
        for at in 0..metrics.len() {
            let difference = (above[at].unwrap() - below[at].unwrap()) / (2.0 * step);
            let slope = slopes.slopes[at];
            assert!(
                (slope - difference).abs() < 1e-3 * difference.abs() + 1e-7,
                "{key}: {slope}, {difference}"
            );
        }
    }
}

#[test]
fn what_is_no_design_is_refused() {
    let mut evaluator = Evaluator::new(Arc::new(study(&["display.pixel.gap_nm.red"], &["white.Y"])), &STOP);
    assert!(matches!(evaluator.evaluate(&[]), Err(DesignError::Length { expected: 1, found: 0 })));
    assert!(matches!(evaluator.evaluate(&[f64::NAN]), Err(DesignError::Value { .. })));
    assert!(matches!(evaluator.evaluate(&[-1.0]), Err(DesignError::Scenario(_))));
    let stop = AtomicBool::new(true);
    let stopped = study(&["display.pixel.gap_nm.red"], &["white.Y"]);
    let error = Evaluator::new(Arc::new(stopped), &stop).evaluate(&[270.0]).unwrap_err();
    assert_eq!(error, DesignError::Display(DisplayError::Interrupted));
}

/// What a search finds does not depend on threads, nor on what of it was known before.
#[test]
fn a_search_depends_on_its_seed_alone() {
    for text in [SEARCH.to_owned(), SEARCH.replace("[optimize]", "[optimize]\nmethod = \"both\"")] {
        let (search, evaluator) = search(&text);
        let (found, records) = run(&search, &evaluator, 1, &Kept::default());
        assert_eq!(found, run(&search, &evaluator, 4, &Kept::default()).0);
        for known in [records.len() / 2, records.len()] {
            let mut kept = Kept::default();
            for record in &records[..known] {
                let line = serde_json::to_string(record).unwrap();
                kept.add(Record::parse(&line).unwrap());
            }
            assert_eq!(found, run(&search, &evaluator, 2, &kept).0, "with {known} of {}", records.len());
        }
    }
}

/// Pieces and answers are plain data: through a wire, in another order, twice over, some of them lost and done again; of
/// generations cut into pieces, too.
#[test]
fn the_pieces_of_a_search_may_go_anywhere() {
    let both = SEARCH.replace("[optimize]", "[optimize]\nmethod = \"both\"");
    for text in [both, format!("{SEARCH}{SECOND}").replace("starts = 4", "starts = 2")] {
        let (search, mut evaluator) = search(&text);
        let (found, records) = run(&search, &evaluator, 1, &Kept::default());
        let mut course = Course::new(Arc::clone(&search), Kept::default(), 5);
        let (mut told, mut out, mut lost) = (Vec::new(), Vec::new(), false);
        while !course.is_over() {
            out.extend(
                std::iter::from_fn(|| course.piece()).map(|piece| serde_json::to_string(&piece).unwrap()),
            );
            let piece: Piece = serde_json::from_str(&out.pop().unwrap()).unwrap();
            lost = !lost;
            if lost {
                out.insert(0, serde_json::to_string(&piece).unwrap());
                continue;
            }
            let answer = serde_json::to_string(&search.work(&piece, &mut evaluator).unwrap()).unwrap();
            for _ in 0..2 {
                course.take(serde_json::from_str::<Answer>(&answer).unwrap());
            }
            told.extend(course.news());
        }
        assert_eq!(found, course.found());
        let lines = |records: &[Record]| {
            let mut lines: Vec<_> =
                records.iter().map(|record| serde_json::to_string(record).unwrap()).collect();
            lines.sort();
            lines
        };
        assert_eq!(lines(&records), lines(&told));
    }
}

/// The first round in parts that do not know of each other; what they tell, joined, is as good as one search's.
#[test]
fn parts_are_joined() {
    let (search, evaluator) = search(SEARCH);
    let mut tell = |_: &Record, _: (usize, usize)| Ok::<(), DesignError>(());
    let mut kept = Kept::default();
    for k in 1..=3 {
        let mut part = Course::part(Arc::clone(&search), Kept::default(), 1, (k, 3));
        part.run(&evaluator, 1, &mut tell).unwrap();
        let numbers: Vec<usize> = part.found().iter().map(|one| one.task).collect();
        assert_eq!(numbers, [vec![0, 3], vec![1], vec![2]][k - 1]);
        let mut own = Kept::default();
        part.found().into_iter().for_each(|one| own.add(Record::Found(one)));
        kept.join(own);
    }
    let mut whole = Course::new(Arc::clone(&search), kept, 1);
    assert!(whole.is_over() && whole.news().is_empty());
    assert_eq!(whole.found(), run(&search, &evaluator, 1, &Kept::default()).0);
}

/// The best of a search is better than where it began, meets its limits, and lies within its bounds.
#[test]
fn a_search_finds_something_better() {
    let (search, mut evaluator) = search(SEARCH);
    let (found, _) = run(&search, &evaluator, 1, &Kept::default());
    let best = search.chosen(&found, &mut evaluator).unwrap().remove(0);
    let (own, own_values) = search.own();
    assert_eq!(own, [55.9, 12.15, 0.4]);
    assert!(best.values[0].unwrap() > own_values[0].unwrap(), "{best:?}");
    assert!(best.meets_limits());
    assert!((0.0..=120.0).contains(&best.design[0]) && (0.2..=0.6).contains(&best.design[2]));
}

/// What a pixel is made of, from its spectrum through the diffuser: the search finds the thicknesses again that made it.
#[test]
fn a_wanted_spectrum_is_found_again() {
    let keys = ["display.pixel.film.0.thickness_nm", "display.pixel.film.1.thickness_nm"];
    let mut evaluator = Evaluator::new(Arc::new(study(&keys, &["white.Y"])), &STOP);
    let result = evaluator.run(&[70.0, 9.0], 0).unwrap();
    let white = result.views[0].states.get("white").unwrap().value.reflectance_factor.clone().unwrap();
    let pairs: Vec<String> =
        result.wavelength_nm.iter().zip(&white).map(|(nm, value)| format!("[{nm}, {value}]")).collect();
    let text = format!(
        "[optimize]\nstarts = 2\nevaluations = 200\n\
         [[optimize.variables]]\nkey = \"{}\"\nbounds = [20, 100]\n\
         [[optimize.variables]]\nkey = \"{}\"\nbounds = [5, 20]\n\
         [[optimize.objectives]]\nstate = \"white\"\nspectrum = [{}]\n",
        keys[0],
        keys[1],
        pairs.join(", ")
    );
    let (search, mut evaluator) = search(&text);
    let (found, _) = run(&search, &evaluator, 1, &Kept::default());
    let best = search.chosen(&found, &mut evaluator).unwrap().remove(0);
    for (found, made) in best.design.iter().zip([70.0, 9.0]) {
        assert!((found - made).abs() < 0.05, "{best:?}");
    }
}

#[test]
fn a_front_holds_what_nothing_beats() {
    let (search, evaluator) = search(&format!("{SEARCH}{SECOND}"));
    let (found, _) = run(&search, &evaluator, 1, &Kept::default());
    let aims = search.aims();
    let front = front(aims, &found);
    assert!(front.len() >= 4, "{front:?}");
    let merits = |at: usize| [0, 1].map(|objective| aims.merit(objective, &found[at].values).unwrap());
    let sound: Vec<usize> = (0..found.len()).filter(|at| aims.missed(&found[*at].values) <= 1e-6).collect();
    for one in front {
        let beats = |other: usize| {
            let (one, other) = (merits(one), merits(other));
            other[0] <= one[0] && other[1] <= one[1] && (other[0] < one[0] - 1e-4 || other[1] < one[1] - 1e-4)
        };
        assert!(!sound.iter().any(|other| beats(*other)));
    }
}
