//! The search for better designs, compared with known designs of the reference pixel and with a global
//! method.
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use papilio_design::search::{
    FEASIBLE, Record, Search, SearchProgress, SearchRecords, SearchResult, SearchSchedule, SelectedDesign,
};
use papilio_design::{DesignError, Evaluator, Study};
use papilio_display::scene::{Method, Stop};
use papilio_scenario::Optimisation;
use papilio_validation::{run, scenario};

static STOP: AtomicBool = AtomicBool::new(false);

/// Runs the search of scenarios/optimize.toml, with changes.
fn search(overrides: &[String]) -> (Arc<Search>, Vec<SearchResult>, SelectedDesign) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/optimize.toml");
    let said = Optimisation::load(&file, overrides).unwrap();
    let mut evaluator = Evaluator::new(Arc::new(Study::of(&said)), &STOP);
    let search = Arc::new(Search::new(said, &mut evaluator).unwrap());
    let mut on_record = |_: &Record, _: SearchProgress| Ok::<(), DesignError>(());
    let mut schedule = SearchSchedule::new(Arc::clone(&search), SearchRecords::default(), 2);
    schedule.run(&evaluator, 2, &mut on_record).unwrap();
    let found = schedule.results();
    let best = search.selected(&found, &mut evaluator).unwrap().remove(0);
    (search, found, best)
}

/// Sufficient effort to find the better pixel, starting with the design of the scenario.
const FEW: [&str; 2] = ["optimize.starts=3", "optimize.evaluations=900"];

/// Returns gamut, luminance factor of white, and contrast.
fn worth(chosen: &SelectedDesign) -> [f64; 3] {
    [0, 1, 2].map(|at| chosen.values[at].unwrap())
}

/// From a stack without the matching layer, the search finds a pixel whose gamut with H78 indoors is at least
/// 3 points above that of the reference pixel, without loss of reflectance and contrast. The Monte Carlo
/// solver agrees.
#[test]
fn search_finds_better_pixel_than_reference() {
    let reference = run(&scenario("indoor", &[]).unwrap().scene).unwrap();
    let view = &reference.views[0];
    let white = view.states.get("white").unwrap().value.Y;
    let (search, _, best) = search(&FEW.map(str::to_owned));
    let [gamut, found_white, contrast] = worth(&best);
    assert!(gamut >= view.metrics.gamut_percent_srgb.unwrap() + 3.0, "{gamut}");
    assert!(found_white >= white, "{found_white}, {white}");
    assert!(contrast >= view.metrics.contrast_ratio.unwrap(), "{contrast}");
    let study = search.study();
    let values = study.values(&best.design).unwrap();
    for (name, limit) in [("red.Y", "red"), ("green.Y", "green"), ("blue.Y", "blue")] {
        let at = study.quantities.iter().position(|one| one.name == name).unwrap();
        let reference = view.states.get(limit).unwrap().value.Y;
        assert!(best.values[at].unwrap() >= reference, "{name}");
    }
    let mut scene = study.conditions[0].varied.scenario(&values).unwrap().resolve().unwrap().scene;
    scene.solver.method = Method::MonteCarlo;
    scene.solver.stop = Stop::RelativeError { target: 0.002, per_wavelength: false };
    let result = run(&scene).unwrap();
    for (asked, adding) in study.quantities.iter().zip(worth(&best)) {
        let walk = asked.quantity.of(&result).unwrap();
        let error = asked.quantity.standard_error(&result).unwrap();
        // Four standard errors, and the difference between adding's levels.
        assert!(
            (walk - adding).abs() < 4.0 * error + 1e-3 * adding,
            "{}: {walk} ({error}), {adding}",
            asked.name
        );
    }
}

/// The largest gamut found by many gradient searches (60 starts of two seeds, of which 18 end there) and by a
/// population of 125 300 designs.
const BEST_GAMUT: f64 = 35.518;

/// Returns the number of seeds, and whether populations with 100 times the evaluations are compared as well,
/// which is the case if `PAPILIO_SEARCH_SEEDS` is set.
fn seeds() -> (u64, bool) {
    let seeds = std::env::var("PAPILIO_SEARCH_SEEDS").ok().and_then(|text| text.parse().ok());
    (seeds.unwrap_or(1), seeds.is_some())
}

/// For nine of ten seeds, the gradient search is within 0.1 of the best known gamut, which a global method
/// finds with a hundred times the evaluations. The first start is the design of the scenario for all seeds
/// and is not counted.
#[test]
fn gradient_searches_find_optimum_of_populations() {
    let (seeds, by_population) = seeds();
    let (mut best, mut near) = (BEST_GAMUT, Vec::new());
    for seed in 1..=seeds {
        let (search, found, _) = self::search(&[format!("optimize.seed={seed}")]);
        let evaluations: usize = found.iter().map(|one| one.evaluations).sum();
        let sound = |one: &&SearchResult| one.task > 0 && search.aims().missed(&one.values) <= FEASIBLE;
        near.push(found.iter().filter(sound).filter_map(|one| one.values[0]).fold(0.0, f64::max));
        // A population takes as long as a hundred searches; two of them suffice to determine the optimum.
        if by_population && seed <= 2 {
            let overrides = [
                "optimize.method=global".to_owned(),
                format!("optimize.seed={seed}"),
                format!("optimize.evaluations={}", 100 * evaluations),
            ];
            let (_, _, chosen) = self::search(&overrides);
            println!("seed {seed}: {near:?} by {evaluations} designs, {} by a population", worth(&chosen)[0]);
            best = worth(&chosen)[0].max(best);
        }
    }
    let missed = near.iter().filter(|gamut| **gamut < best - 0.1).count() as u64;
    assert!(missed <= seeds / 10, "{near:?}, {best}");
}
