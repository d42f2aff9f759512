//! Runs of a scenario file by both solvers, through the project's own reader.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};

use papilio_display::result::{Absorbed, RunResult};
use papilio_display::scene::{Method, Scene, Stop};
use papilio_display::{Control, DisplayError};
use papilio_scenario::Scenario;

use super::draw::Drawn;

/// Largest CPU time of a scenario with a solver, seconds.
pub(crate) const SLOW: f64 = 60.0;

/// Time after which a run is stopped, on a processor that has other work, seconds.
pub(crate) const LONGEST: f64 = 5.0 * SLOW;

/// Monte Carlo runs of a scenario, one for each seed.
#[derive(Debug)]
pub(crate) struct MonteCarloRuns {
    pub(crate) drawn: Drawn,
    pub(crate) scene: Scene,
    pub(crate) runs: Vec<RunResult>,
    /// Total time of all runs.
    pub(crate) seconds: f64,
    /// Time after which a run is stopped, seconds.
    pub(crate) longest: f64,
}

/// A number as computed by both solvers.
#[derive(Debug, Clone)]
pub(crate) struct Pair {
    pub(crate) what: String,
    pub(crate) is_of_ledger: bool,
    pub(crate) walk: f64,
    pub(crate) standard_error: f64,
    pub(crate) adding: f64,
    pub(crate) discretisation_error: f64,
}

impl Pair {
    /// Returns the largest total error of the tables of films and coatings, as a fraction of the light, or of
    /// the value if it is larger.
    pub(crate) fn tables(&self) -> f64 {
        1e-7 * self.adding.abs().max(1.0)
    }

    /// Returns whether the Monte Carlo noise is most of the expected difference; only then is z distributed
    /// as Student's t.
    pub(crate) fn is_noisy(&self) -> bool {
        self.standard_error > 3.0 * self.discretisation_error.hypot(self.tables())
    }

    pub(crate) fn description(&self) -> String {
        let Self { what, walk, standard_error, adding, discretisation_error, .. } = self;
        let z = self.z();
        format!(
            "{what}: Monte Carlo {walk} ± {standard_error:.2e}, adding {adding} ± {discretisation_error:.2e}, z {z:.2}"
        )
    }

    pub(crate) fn z(&self) -> f64 {
        let error = self.standard_error.hypot(self.discretisation_error).hypot(self.tables());
        (self.walk - self.adding) / error
    }
}

/// Resolves the text of a scenario; its files are those of the examples.
pub(crate) fn scene(text: &str) -> Result<Scene, String> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../scenarios");
    let scenario = Scenario::from_text(text, "random.toml", folder.as_path(), &[]);
    scenario.and_then(|scenario| scenario.resolve()).map(|all| all.scene).map_err(|errors| errors.to_string())
}

/// Returns the CPU time of this thread in seconds, on systems that report it (Linux).
fn busy() -> Option<f64> {
    let nanoseconds = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    nanoseconds.split_whitespace().next()?.parse::<f64>().ok().map(|nanoseconds| 1e-9 * nanoseconds)
}

/// Runs a scene for at most `longest` seconds, and returns the time that it took: for adding, which runs on this
/// thread, the CPU time.
pub(crate) fn timed(scene: &Scene, longest: f64) -> (Result<RunResult, DisplayError>, f64) {
    let stop = AtomicBool::new(false);
    let (done, wait) = channel::<()>();
    std::thread::scope(|scope| {
        let stop = &stop;
        scope.spawn(move || {
            use std::sync::mpsc::RecvTimeoutError::Timeout;
            if wait.recv_timeout(Duration::from_secs_f64(longest)) == Err(Timeout) {
                stop.store(true, Ordering::Relaxed);
            }
        });
        let (begun, before) = (Instant::now(), busy());
        let control = Control { threads: Some(1), progress: &|_| {}, stop };
        let result = papilio_display::run(scene, &control);
        drop(done);
        let by_processor = before.zip(busy()).map(|(before, now)| now - before);
        let seconds = by_processor.filter(|_| scene.solver.method == Method::Adding);
        (result, seconds.unwrap_or_else(|| begun.elapsed().as_secs_f64()))
    })
}

/// Runs the scenario with the Monte Carlo solver, with seeds that no other scenario has.
pub(crate) fn monte_carlo_runs(
    drawn: Drawn,
    seeds: std::ops::Range<u64>,
    longest: f64,
) -> Result<MonteCarloRuns, String> {
    let about = |why: String| format!("{} ({}): {why}\n{}", drawn.number, drawn.name, drawn.text);
    let mut scene = scene(&drawn.text).map_err(about)?;
    scene.solver.method = Method::MonteCarlo;
    scene.solver.stop = Stop::Paths(drawn.paths);
    let mut all = MonteCarloRuns { drawn, scene, runs: Vec::new(), seconds: 0.0, longest };
    for seed in seeds {
        all.scene.solver.seed = 1000 * all.drawn.number + seed;
        let (run, seconds) = timed(&all.scene, longest);
        all.runs.push(run.map_err(|error| format!("{} by Monte Carlo: {error}", all.drawn.number))?);
        all.seconds += seconds;
    }
    Ok(all)
}

impl MonteCarloRuns {
    /// Returns the target of adding, the largest relative error of Y over states, such that the Monte Carlo
    /// noise is most of the difference.
    fn target(&self) -> f64 {
        let of_state = |state: &papilio_display::result::State| {
            let part = [
                (state.standard_error.X, state.value.X),
                (state.standard_error.Y, state.value.Y),
                (state.standard_error.Z, state.value.Z),
            ];
            part.into_iter().map(|(error, value)| error / value.abs().max(1e-9)).fold(1.0, f64::min)
        };
        let states = self.runs.iter().flat_map(|run| run.views[0].states.iter());
        (0.2 * states.map(|(_, state)| of_state(state)).fold(1.0, f64::min))
            .clamp(self.drawn.least_error, 1e-2)
    }

    /// Runs this scene, or a different one, with adding, and returns the time in seconds.
    pub(crate) fn adding(&self, scene: &Scene) -> (Result<RunResult, String>, f64) {
        let mut scene = scene.clone();
        scene.solver.method = Method::Adding;
        scene.solver.stop = Stop::RelativeError { target: self.target(), per_wavelength: false };
        let (run, seconds) = timed(&scene, self.longest);
        (run.map_err(|error| format!("adding: {error}")), seconds)
    }

    /// Returns the numbers of both solvers for each seed; those of adding are computed once.
    pub(crate) fn pairs(&self, adding: &RunResult) -> Vec<Vec<Pair>> {
        let exact = numbers(adding);
        let of = |walk: &RunResult| {
            let pair = |(walk, exact): (Number, &Number)| Pair {
                what: walk.what,
                is_of_ledger: walk.is_of_ledger,
                walk: walk.value,
                standard_error: walk.standard_error,
                adding: exact.value,
                discretisation_error: exact.discretisation_error,
            };
            numbers(walk).into_iter().zip(&exact).map(pair).collect()
        };
        self.runs.iter().map(of).collect()
    }
}

#[derive(Debug)]
struct Number {
    what: String,
    is_of_ledger: bool,
    value: f64,
    standard_error: f64,
    discretisation_error: f64,
}

/// Returns X, Y, Z of each state, and the entries of its ledger.
fn numbers(run: &RunResult) -> Vec<Number> {
    let mut all = Vec::new();
    let view = &run.views[0];
    for (name, state) in view.states.iter() {
        let of = state.discretisation_error.as_ref();
        let (value, error) = (&state.value, &state.standard_error);
        for (what, value, standard_error, discretisation_error) in [
            ("X", value.X, error.X, of.map(|error| error.X)),
            ("Y", value.Y, error.Y, of.map(|error| error.Y)),
            ("Z", value.Z, error.Z, of.map(|error| error.Z)),
        ] {
            let discretisation_error = discretisation_error.unwrap_or(0.0);
            let what = format!("{name} {what}");
            all.push(Number { what, is_of_ledger: false, value, standard_error, discretisation_error });
        }
    }
    for (name, ledger) in view.ledger.iter() {
        let (of, error) = (ledger.discretisation_error.as_ref(), &ledger.standard_error);
        let accounts = accounts(ledger.returned, &ledger.absorbed);
        let errors = accounts_of(error.returned, &error.absorbed);
        let of = of.map_or([0.0; 6], |of| accounts_of(of.returned, &of.absorbed));
        for (((what, value), standard_error), discretisation_error) in
            accounts.into_iter().zip(errors).zip(of)
        {
            let what = format!("{name} {what}");
            all.push(Number { what, is_of_ledger: true, value, standard_error, discretisation_error });
        }
    }
    all
}

fn accounts(returned: f64, absorbed: &Absorbed) -> [(&'static str, f64); 6] {
    let names = ["returned", "front", "diffuser", "glass", "pixel", "inactive"];
    let values = accounts_of(returned, absorbed);
    std::array::from_fn(|k| (names[k], values[k]))
}

fn accounts_of(returned: f64, absorbed: &Absorbed) -> [f64; 6] {
    [returned, absorbed.front, absorbed.diffuser, absorbed.glass, absorbed.pixel, absorbed.inactive]
}
