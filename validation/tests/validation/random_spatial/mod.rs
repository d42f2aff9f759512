//! Comparison of the two solvers on random displays with places: `papilio mtf`, `papilio crosstalk` and
//! pictures of Lambertian pixels by adding against paths. The deviations must agree with the standard errors, and stated errors of adding must
//! hold for 99 % of all numbers.
//!
//! `PAPILIO_SCENARIOS=100` sets the number of displays, `PAPILIO_SCENARIOS=17..18` selects some;
//! `PAPILIO_PATHS=65536` the paths.

mod draw;
mod numbers;
mod pictures;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use papilio_display::scene::{Method, Scene, Stop};
use papilio_display::spatial::{crosstalk, mtf};
use papilio_display::{Control, DisplayError};
use papilio_scenario::{Resolved, Scenario};
use papilio_testing::sized;

use self::draw::{Drawn, drawn};
use self::numbers::{Number, Numbers, of_crosstalk, of_sharpness};
use crate::random_scenarios::{each, range};

/// Number of displays every day, of the fast ones, and in the full run; and paths of each.
const DISPLAYS: [usize; 2] = [4, 200];
const PATHS: [u64; 2] = [1 << 12, 1 << 14];

/// Longest time of one command for one display, seconds.
const LONGEST: f64 = 60.0;

/// Standard errors beyond a stated error from which on this does not hold, and the largest fraction of such
/// numbers.
const FAR: f64 = 4.0;
const MAX_FAR: f64 = 0.01;

/// Errors of tables and of the step between wavelengths, as a fraction of the light.
const TABLES: f64 = 2e-6;

/// A number by adding and by paths.
#[derive(Debug)]
struct Pair {
    what: String,
    exact: Number,
    path: Number,
}

impl Pair {
    fn distance(&self) -> f64 {
        let [re, im] = [0, 1].map(|k| self.exact.value[k] - self.path.value[k]);
        re.hypot(im)
    }

    fn tables(&self) -> f64 {
        TABLES * self.exact.value[0].abs().max(1.0)
    }

    /// Deviation in standard errors, of complex numbers the modulus, where noise is most of it.
    fn z(&self) -> Option<f64> {
        let stated = self.exact.error + self.tables();
        let is_noisy = self.path.error > 3.0 * stated && !self.what.ends_with('*');
        is_noisy.then(|| self.distance() / self.path.error.hypot(stated))
    }

    /// What is beyond the stated error, in standard errors.
    fn beyond(&self) -> f64 {
        let stated = self.exact.error + self.tables();
        (self.distance() - stated).max(0.0) / (self.path.error + 1e-9)
    }

    fn kind(&self) -> &str {
        self.what.split(' ').next().unwrap_or_default()
    }
}

/// What both solvers make of a display.
struct Compared {
    drawn: Drawn,
    pairs: Vec<Pair>,
    refused: Vec<String>,
    seconds: [f64; 2],
}

fn watched<T>(work: impl FnOnce(&Control<'_>) -> Result<T, DisplayError>) -> (Result<T, DisplayError>, f64) {
    let (stop, begun) = (AtomicBool::new(false), Instant::now());
    let (done, wait) = channel::<()>();
    std::thread::scope(|scope| {
        scope.spawn(|| {
            if wait.recv_timeout(Duration::from_secs_f64(LONGEST)) == Err(RecvTimeoutError::Timeout) {
                stop.store(true, Ordering::Relaxed);
            }
            drop(wait);
        });
        let result = work(&Control { threads: Some(1), progress: &|_| {}, stop: &stop });
        drop(done);
        (result, begun.elapsed().as_secs_f64())
    })
}

fn resolved(text: &str) -> Resolved {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios");
    let scenario = Scenario::from_text(text, "random.toml", &folder, &[]);
    scenario.and_then(|scenario| scenario.resolve()).unwrap_or_else(|errors| panic!("{errors}\n{text}"))
}

fn with_method(scene: &Scene, method: Method, stop: Stop, seed: u64) -> Scene {
    let mut scene = scene.clone();
    (scene.solver.method, scene.solver.stop, scene.solver.seed) = (method, stop, seed);
    scene
}

fn compared(number: u64, paths: u64) -> Compared {
    let drawn = drawn(number);
    let mut compared = Compared { pairs: Vec::new(), refused: Vec::new(), seconds: [0.0; 2], drawn };
    let Resolved { scene, patterns, .. } = &resolved(&compared.drawn.text);
    let exact = with_method(
        scene,
        Method::Adding,
        Stop::RelativeError { target: compared.drawn.target, per_wavelength: false },
        0,
    );
    let walk = with_method(scene, Method::MonteCarlo, Stop::Paths(paths), number);
    if !compared.drawn.has_filter {
        let thickness: f64 = scene.display.lengths_mm().map(|all| all.iter().sum()).unwrap_or(1.0);
        let of = |result| of_sharpness(&result, [0.5 / thickness, 20.0 / thickness]);
        let mut patterns = patterns.clone();
        let mut found = watched(|control| mtf(&exact, &patterns, control));
        if let Err(DisplayError::PlacesByPaths { what, key }) = &found.0
            && key == "pattern"
        {
            compared.refused.push(format!("mtf: {what}"));
            patterns.period_mm.clear();
            found = watched(|control| mtf(&exact, &patterns, control));
        }
        let found = (found.0.map(of), found.1);
        compared.add("mtf", found, || {
            let (found, seconds) = watched(|control| mtf(&walk, &patterns, control));
            (found.map(of), seconds)
        });
    }
    let (found, seconds) = watched(|control| crosstalk(&exact, &patterns.text, control));
    compared.add("crosstalk", (found.map(|found| of_crosstalk(&found)), seconds), || {
        let (found, seconds) = watched(|control| crosstalk(&walk, &patterns.text, control));
        (found.map(|found| of_crosstalk(&found)), seconds)
    });
    if compared.drawn.has_picture() {
        let found = watched(|control| pictures::by_adding(&exact, control));
        compared.add("picture", found, || watched(|control| pictures::by_paths(&walk, paths, control)));
    }
    println!("{}", compared.description());
    compared
}

type Timed = (Result<Numbers, DisplayError>, f64);

impl Compared {
    fn add(&mut self, command: &str, exact: Timed, walk: impl FnOnce() -> Timed) {
        self.seconds[0] += exact.1;
        let exact = match exact.0 {
            Ok(exact) => exact,
            Err(DisplayError::Interrupted) => return self.refused.push(format!("{command}: too slow")),
            Err(error) => return self.refused.push(format!("{command}: {error}")),
        };
        let (walk, seconds) = walk();
        self.seconds[1] += seconds;
        let walk = walk.unwrap_or_else(|error| panic!("{command} by paths: {error}\n{}", self.drawn.text));
        for (what, exact) in exact {
            if let Some(path) = walk.get(&what) {
                self.pairs.push(Pair { what: format!("{what} ({command})"), exact, path: *path });
            }
        }
        self.pairs.sort_by(|a, b| a.what.cmp(&b.what));
    }

    fn description(&self) -> String {
        let Self { drawn, pairs, refused, seconds: [adding, walk] } = self;
        let mut text =
            format!("{}: {} numbers, adding {adding:.1} s, paths {walk:.1} s", drawn.number, pairs.len());
        refused.iter().for_each(|why| text += &format!("\n  refused {why}"));
        let mut far: Vec<&Pair> = pairs.iter().filter(|pair| pair.beyond() > FAR).collect();
        far.sort_by(|a, b| b.beyond().total_cmp(&a.beyond()));
        for Pair { what, exact, path } in far.iter().take(8) {
            text += &format!(
                "\n  {what}: {:.6?} +- {:.1e}, paths {:.6?} +- {:.1e}",
                exact.value, exact.error, path.value, path.error
            );
        }
        if refused.iter().any(|why| why.ends_with("too slow")) && far.is_empty() {
            text += &format!("\n{}", drawn.text);
        }
        if !far.is_empty() {
            text += &format!("\n  {} of {} beyond\n{}", far.len(), pairs.len(), drawn.text);
        }
        text
    }
}

#[test]
fn stated_errors_of_random_displays_with_places_hold() {
    let numbers: Vec<u64> = match range("PAPILIO_SCENARIOS") {
        Some(numbers) => numbers.collect(),
        None => {
            let (count, slow_too) = sized((DISPLAYS[0], false), (DISPLAYS[1], true));
            (0..).filter(|number| slow_too || !drawn(*number).is_slow).take(count).collect()
        }
    };
    let paths = std::env::var("PAPILIO_PATHS").ok().and_then(|text| text.parse().ok());
    let paths = paths.unwrap_or(sized(PATHS[0], PATHS[1]));
    let all = each(&numbers, |number| compared(*number, paths));
    // By kind of number: their count, those beyond, noisy ones and the sum of their squares.
    let mut kinds: BTreeMap<&str, [f64; 4]> = BTreeMap::new();
    for pair in all.iter().flat_map(|one| &one.pairs) {
        for kind in [pair.kind(), "all"] {
            let sums = kinds.entry(kind).or_default();
            sums[0] += 1.0;
            sums[1] += f64::from(u8::from(pair.beyond() > FAR));
            if let Some(z) = pair.z() {
                sums[2] += 1.0;
                sums[3] += z * z;
            }
        }
    }
    for (kind, [count, far, noisy, squares]) in &kinds {
        let percent = 100.0 * far / count;
        println!(
            "{kind}: {count} numbers, {percent:.2} % beyond; mean square of {noisy}: {:.3}",
            squares / noisy
        );
    }
    let mut refused: BTreeMap<&str, usize> = BTreeMap::new();
    all.iter().flat_map(|one| &one.refused).for_each(|why| *refused.entry(why).or_default() += 1);
    println!("refused: {refused:#?}");
    let [count, far, ..] = kinds["all"];
    assert!(far <= MAX_FAR * count, "{far} of {count} numbers are beyond the stated errors");
}
