//! Studies and searches: both evaluation methods, derivatives, and independence of threads and journals.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use papilio_design::search::{
    Record, Search, SearchProgress, SearchRecords, SearchResult, SearchSchedule, WorkItem, WorkResult, front,
};
use papilio_design::{
    Condition, DesignError, Evaluator, Key, NamedQuantity, Quantity, Study, Values, Variable,
};
use papilio_display::DisplayError;
use papilio_display::scene::Metric;
use papilio_scenario::{Optimisation, ParameterisedScenario};

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

/// Study of some keys and metrics.
fn study(keys: &[&str], metrics: &[&str]) -> Study {
    let paths: Vec<String> = keys.iter().map(|key| (*key).to_owned()).collect();
    let varied = ParameterisedScenario::from_text(DISPLAY, "test.toml", Path::new(""), &[], &paths).unwrap();
    let variable = |key: &&str| Variable {
        name: (*key).to_owned(),
        keys: vec![Key::plain(*key)],
        values: Values::Number,
    };
    let named =
        |name: &&str| NamedQuantity { name: (*name).to_owned(), condition: 0, quantity: metric(name) };
    Study {
        conditions: vec![Condition { name: String::new(), varied }],
        variables: keys.iter().map(variable).collect(),
        quantities: metrics.iter().map(named).collect(),
    }
}

fn search(text: &str) -> (Arc<Search>, Evaluator<'static>) {
    let spec = Optimisation::from_text(&format!("{DISPLAY}{text}"), "test.toml", Path::new(""), &[]).unwrap();
    let mut evaluator = Evaluator::new(Arc::new(Study::of(&spec)), &STOP);
    (Arc::new(Search::new(spec, &mut evaluator).unwrap()), evaluator)
}

fn run(
    search: &Arc<Search>,
    evaluator: &Evaluator<'_>,
    threads: usize,
    known: &SearchRecords,
) -> (Vec<SearchResult>, Vec<Record>) {
    let mut schedule = SearchSchedule::new(Arc::clone(search), known.clone(), threads);
    let mut records = Vec::new();
    let mut on_record = |record: &Record, _: SearchProgress| {
        records.push(record.clone());
        Ok::<(), DesignError>(())
    };
    schedule.run(evaluator, threads, &mut on_record).unwrap();
    (schedule.results(), records)
}

/// Thicknesses, gaps, fill factor: the reused kernels match a full run of the scenario within 0.2 %, the
/// difference of two levels.
#[test]
fn film_fast_path_matches_full_run() {
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

/// Numbers of materials, by a model or as factors, are evaluated by the fast method too, and not by full runs: it has the
/// accuracy of above.
#[test]
fn numbers_of_materials_match_full_run() {
    let model = "{ model = \"oscillators\", eps_inf = 1.1, terms = [{ kind = \"tauc-lorentz\", amplitude_ev = 60, \
                 energy_ev = 7, damping_ev = 5, gap_ev = 2.4 }] }";
    let set = [
        format!("display.pixel.film.0.material={model}"),
        "display.pixel.film.1.material={ material = \"Cr\", k_scale = 1 }".to_owned(),
    ];
    let keys = ["film.0.material.terms.0.gap_ev", "film.1.material.k_scale", "gap_nm.red"];
    let keys = keys.map(|key| format!("display.pixel.{key}"));
    let mut study = study(&keys.each_ref().map(String::as_str), &["white.Y", "red.L_star"]);
    study.conditions[0].varied =
        ParameterisedScenario::from_text(DISPLAY, "test.toml", Path::new(""), &set, &keys).unwrap();
    let mut evaluator = Evaluator::new(Arc::new(study.clone()), &STOP);
    let mut found = Vec::new();
    for design in [[2.4, 1.0, 275.0], [1.6, 1.2, 250.0]] {
        let fast = evaluator.evaluate(&design).unwrap();
        let result = evaluator.run(&design, 0).unwrap();
        for (named, fast) in study.quantities.iter().zip(&fast) {
            let (fast, full) = (fast.unwrap(), named.quantity.of(&result).unwrap());
            assert!((fast - full).abs() < 2e-3 * full.abs(), "{} at {design:?}: {fast}, {full}", named.name);
        }
        found.push(fast);
    }
    assert!((found[0][0].unwrap() - found[1][0].unwrap()).abs() > 0.01, "{found:?}");
    assert!(evaluator.derivatives(&[2.4, 1.0, 275.0]).unwrap().slopes.iter().all(|slope| *slope != 0.0));
    assert!(matches!(evaluator.evaluate(&[-1.0, 1.0, 275.0]), Err(DesignError::Scenario(_))));
}

/// A number of a material's table is not always the index of the film: a factor scales it, and `k` of a model has an edge.
#[test]
fn numbers_beside_factors_and_edges_match_full_run() {
    for (material, number) in [
        ("{ n = 1.9, k = 0.05, k_scale = 2 }", "k"),
        ("{ n = 1.9, k = 0.05, n_scale = 1.2 }", "n"),
        ("{ model = \"cauchy\", a = 1.9, b_um2 = 0.01, k = 0.05, k_at_nm = 500, urbach_ev = 0.3 }", "k"),
    ] {
        let set = [format!("display.pixel.film.0.material={material}")];
        let keys = [format!("display.pixel.film.0.material.{number}")];
        let mut study = study(&[&keys[0]], &["white.Y", "red.L_star"]);
        study.conditions[0].varied =
            ParameterisedScenario::from_text(DISPLAY, "test.toml", Path::new(""), &set, &keys).unwrap();
        let mut evaluator = Evaluator::new(Arc::new(study.clone()), &STOP);
        for value in if number == "n" { [1.7, 1.9] } else { [0.2, 0.05] } {
            let fast = evaluator.evaluate(&[value]).unwrap();
            let result = evaluator.run(&[value], 0).unwrap();
            for (named, fast) in study.quantities.iter().zip(fast) {
                let (fast, full) = (fast.unwrap(), named.quantity.of(&result).unwrap());
                assert!(
                    (fast - full).abs() < 2e-3 * full.abs(),
                    "{material}, {number} {value}: {fast}, {full}"
                );
            }
        }
    }
}

/// Retarders and gaps of a liquid crystal: one display after the other, with the kernels of the first, equals a display of its own by a table
/// (at another number of azimuths than is computed one by one).
#[test]
fn retarders_match_full_run() {
    let text = r#"
[spectrum]
step_nm = 20
[display.glass]
index = 1.5
surface = "fresnel"
[display.pixel]
model = "liquid-crystal"
substrate = "Ag"
stack = [
  { kind = "polariser", axis_deg = 0, transmittance = 0.47, extinction = 1e-4 },
  { kind = "retarder", axis_deg = 45, retardance_nm = 137.5 },
  { kind = "cell", gap_um = 2, n_o = 1.5, n_e = 1.6, rub_deg = 45, states = { white = { tilt_deg = 30 }, black = { tilt_deg = 88 } } },
]
[viewer]
theta_deg = [0, 45]
polariser = 20
"#;
    let keys = ["stack.1.retardance_nm", "stack.1.axis_deg", "stack.2.gap_um"];
    let keys = keys.map(|key| format!("display.pixel.{key}"));
    let mut study = study(&keys.each_ref().map(String::as_str), &["white.Y", "black.Y", "white.u_prime"]);
    let varied = |set: &[String]| {
        ParameterisedScenario::from_text(text, "test.toml", Path::new(""), set, &keys).unwrap()
    };
    study.conditions[0].varied = varied(&[]);
    let mut evaluator = Evaluator::new(Arc::new(study.clone()), &STOP);
    let many = "viewer.phi_deg=[0,1,2,3,4,5,6,7,8]".to_owned();
    for design in [[137.5, 45.0, 2.0], [120.0, 50.0, 1.5], [150.0, 40.0, 2.4]] {
        let fast = evaluator.evaluate(&design).unwrap();
        let mut alone = study.clone();
        alone.conditions[0].varied = varied(std::slice::from_ref(&many));
        let result = Evaluator::new(Arc::new(alone), &STOP).run(&design, 0).unwrap();
        for (named, fast) in study.quantities.iter().zip(fast) {
            let (fast, full) = (fast.unwrap(), named.quantity.of(&result).unwrap());
            assert!((fast - full).abs() < 3e-4, "{} at {design:?}: {fast}, {full}", named.name);
        }
    }
    assert!(evaluator.derivatives(&[137.5, 45.0, 2.0]).unwrap().slopes.iter().all(|slope| slope.is_finite()));
    assert!(matches!(evaluator.evaluate(&[137.5, 45.0, -2.0]), Err(DesignError::Scenario(_))));
}

/// A parameter of the film is evaluated by the fast method, any other key by full runs. Both have
/// derivatives.
#[test]
fn derivatives_match_finite_differences() {
    let metrics = ["white.Y", "contrast_ratio"];
    for (key, own) in [("display.pixel.gap_nm.green", 192.3), ("display.diffuser.transmittance", 0.9)] {
        let mut evaluator = Evaluator::new(Arc::new(study(&[key], &metrics)), &STOP);
        let slopes = evaluator.derivatives(&[own]).unwrap();
        let step = 1e-3 * own;
        let [above, below] = [step, -step].map(|step| evaluator.evaluate(&[own + step]).unwrap());
        for index in 0..metrics.len() {
            let difference = (above[index].unwrap() - below[index].unwrap()) / (2.0 * step);
            let slope = slopes.slopes[index];
            assert!(
                (slope - difference).abs() < 1e-3 * difference.abs() + 1e-7,
                "{key}: {slope}, {difference}"
            );
        }
    }
}

#[test]
fn invalid_design_is_refused() {
    let mut evaluator = Evaluator::new(Arc::new(study(&["display.pixel.gap_nm.red"], &["white.Y"])), &STOP);
    assert!(matches!(evaluator.evaluate(&[]), Err(DesignError::Length { expected: 1, found: 0 })));
    assert!(matches!(evaluator.evaluate(&[f64::NAN]), Err(DesignError::Value { .. })));
    assert!(matches!(evaluator.evaluate(&[-1.0]), Err(DesignError::Scenario(_))));
    let stop = AtomicBool::new(true);
    let stopped = study(&["display.pixel.gap_nm.red"], &["white.Y"]);
    let error = Evaluator::new(Arc::new(stopped), &stop).evaluate(&[270.0]).unwrap_err();
    assert_eq!(error, DesignError::Display(DisplayError::Interrupted));
}

/// The result does not depend on the number of threads or on the records from which the search is resumed.
#[test]
fn search_result_depends_on_seed_alone() {
    for text in [SEARCH.to_owned(), SEARCH.replace("[optimize]", "[optimize]\nmethod = \"both\"")] {
        let (search, evaluator) = search(&text);
        let (found, records) = run(&search, &evaluator, 1, &SearchRecords::default());
        assert_eq!(found, run(&search, &evaluator, 4, &SearchRecords::default()).0);
        for known in [records.len() / 2, records.len()] {
            let mut stored = SearchRecords::default();
            for record in &records[..known] {
                let line = serde_json::to_string(record).unwrap();
                stored.add(Record::parse(&line).unwrap());
            }
            assert_eq!(found, run(&search, &evaluator, 2, &stored).0, "with {known} of {}", records.len());
        }
    }
}

/// Work items and results are transmitted as text, in any order, repeatedly, and some items are lost and
/// computed again. Generations are divided into several items.
#[test]
fn search_result_does_not_depend_on_transport_of_work_items() {
    let both = SEARCH.replace("[optimize]", "[optimize]\nmethod = \"both\"");
    for text in [both, format!("{SEARCH}{SECOND}").replace("starts = 4", "starts = 2")] {
        let (search, mut evaluator) = search(&text);
        let (found, records) = run(&search, &evaluator, 1, &SearchRecords::default());
        let mut schedule = SearchSchedule::new(Arc::clone(&search), SearchRecords::default(), 5);
        let (mut received, mut out, mut lost) = (Vec::new(), Vec::new(), false);
        while !schedule.is_finished() {
            out.extend(
                std::iter::from_fn(|| schedule.next_item()).map(|item| serde_json::to_string(&item).unwrap()),
            );
            let item: WorkItem = serde_json::from_str(&out.pop().unwrap()).unwrap();
            lost = !lost;
            if lost {
                out.insert(0, serde_json::to_string(&item).unwrap());
                continue;
            }
            let result = serde_json::to_string(&search.work(&item, &mut evaluator).unwrap()).unwrap();
            for _ in 0..2 {
                schedule.add_result(serde_json::from_str::<WorkResult>(&result).unwrap());
            }
            received.extend(schedule.take_records());
        }
        assert_eq!(found, schedule.results());
        let lines = |records: &[Record]| {
            let mut lines: Vec<_> =
                records.iter().map(|record| serde_json::to_string(record).unwrap()).collect();
            lines.sort();
            lines
        };
        assert_eq!(lines(&records), lines(&received));
    }
}

/// The joined records of independent shards of the first round give the result of a single search.
#[test]
fn joined_shards_equal_a_single_search() {
    let (search, evaluator) = search(SEARCH);
    let mut on_record = |_: &Record, _: SearchProgress| Ok::<(), DesignError>(());
    let mut joined = SearchRecords::default();
    for k in 1..=3 {
        let mut shard = SearchSchedule::shard(Arc::clone(&search), SearchRecords::default(), 1, (k, 3));
        shard.run(&evaluator, 1, &mut on_record).unwrap();
        let numbers: Vec<usize> = shard.results().iter().map(|one| one.task).collect();
        assert_eq!(numbers, [vec![0, 3], vec![1], vec![2]][k - 1]);
        let mut own = SearchRecords::default();
        shard.results().into_iter().for_each(|one| own.add(Record::Task(one)));
        joined.join(own);
    }
    let mut whole = SearchSchedule::new(Arc::clone(&search), joined, 1);
    assert!(whole.is_finished() && whole.take_records().is_empty());
    assert_eq!(whole.results(), run(&search, &evaluator, 1, &SearchRecords::default()).0);
}

/// The best design is better than the scenario's own, satisfies the constraints, and is within its bounds.
#[test]
fn search_improves_on_the_scenario() {
    let (search, mut evaluator) = search(SEARCH);
    let (found, _) = run(&search, &evaluator, 1, &SearchRecords::default());
    let best = search.selected(&found, &mut evaluator).unwrap().remove(0);
    let (own, own_values) = search.own();
    assert_eq!(own, [55.9, 12.15, 0.4]);
    assert!(best.values[0].unwrap() > own_values[0].unwrap(), "{best:?}");
    assert!(best.meets_limits());
    assert!((0.0..=120.0).contains(&best.design[0]) && (0.2..=0.6).contains(&best.design[2]));
}

/// The target is the spectrum of a known pixel through the diffuser; the search recovers its thicknesses.
#[test]
fn search_for_a_spectrum_recovers_the_film() {
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
    let (found, _) = run(&search, &evaluator, 1, &SearchRecords::default());
    let best = search.selected(&found, &mut evaluator).unwrap().remove(0);
    for (found, true_nm) in best.design.iter().zip([70.0, 9.0]) {
        assert!((found - true_nm).abs() < 0.05, "{best:?}");
    }
}

/// A population is cut where the evaluations end.
#[test]
fn global_search_keeps_to_its_evaluations() {
    for evaluations in [10, 100, 151] {
        let limit = format!("method = \"global\"\nevaluations = {evaluations}");
        let (search, evaluator) = search(&SEARCH.replace("evaluations = 400", &limit));
        let (found, _) = run(&search, &evaluator, 1, &SearchRecords::default());
        for one in found {
            assert_eq!(one.evaluations, evaluations);
        }
    }
}

#[test]
fn front_designs_are_not_dominated() {
    let (search, evaluator) = search(&format!("{SEARCH}{SECOND}"));
    let (found, _) = run(&search, &evaluator, 1, &SearchRecords::default());
    let aims = search.aims();
    let front = front(aims, &found);
    assert!(front.len() >= 4, "{front:?}");
    let merits = |index: usize| [0, 1].map(|objective| aims.merit(objective, &found[index].values).unwrap());
    let feasible: Vec<usize> =
        (0..found.len()).filter(|index| aims.missed(&found[*index].values) <= 1e-6).collect();
    for one in front {
        let dominates = |other: usize| {
            let (one, other) = (merits(one), merits(other));
            other[0] <= one[0] && other[1] <= one[1] && (other[0] < one[0] - 1e-4 || other[1] < one[1] - 1e-4)
        };
        assert!(!feasible.iter().any(|other| dominates(*other)));
    }
}

/// A white w and a black b of paper, w from 0.3 to 0.8 and b from 0.02 to 0.3: white is to be bright, and the contrast near 2. The
/// first objective is flat in b. At every w of the front the contrast is above 2, so all of it has the brightest black, b = 0.3; an end
/// with any other b would be dominated, and limits that begin there would lie beside the front.
#[test]
fn ends_of_the_front_are_best_in_the_other_objective_too() {
    let paper = r#"
[spectrum]
step_nm = 20
[display.pixel]
model = "uniform"
kind = "lambertian"
reflectance = { white = 0.5, black = 0.1 }
[optimize]
starts = 2
evaluations = 200
points = 5
variables = [
  { key = "display.pixel.reflectance.white", bounds = [0.3, 0.8] },
  { key = "display.pixel.reflectance.black", bounds = [0.02, 0.3] },
]
objectives = [{ metric = "white.Y", aim = "maximise" }, { metric = "contrast_ratio", aim = { target = 2 } }]
"#;
    let spec = Optimisation::from_text(paper, "test.toml", Path::new(""), &[]).unwrap();
    let mut evaluator = Evaluator::new(Arc::new(Study::of(&spec)), &STOP);
    let search = Arc::new(Search::new(spec, &mut evaluator).unwrap());
    let (found, _) = run(&search, &evaluator, 1, &SearchRecords::default());
    let all = search.selected(&found, &mut evaluator).unwrap();
    let white: Vec<f64> = all.iter().map(|one| one.design[0]).collect();
    assert!(all.iter().all(|one| (one.design[1] - 0.3).abs() < 1e-4), "{all:?}");
    assert!(white.len() >= 5 && (white[0] - 0.8).abs() < 1e-6, "{white:?}");
    // Merits that differ by 1e-4, at the other end contrasts that differ by 0.05 from 2, count as equal.
    let contrast = all[all.len() - 1].values[1].unwrap();
    assert!((contrast - 2.0).abs() < 0.06, "{contrast}");
    assert!(white.is_sorted_by(|a, b| a > b), "{white:?}");
}
