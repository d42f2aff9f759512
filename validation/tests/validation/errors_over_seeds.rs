//! Standard errors of the Monte Carlo solver: every example scenario and random scenarios.
//!
//! Two things are tested of Y of every state. The variance of Y between 16 seeds over the mean of their
//! squared standard errors has the mean 1, with few and with four times as many paths. The standard error of
//! 4, 16 and 64 times the paths is at most 1/2, 1/4 and 1/8 (less, where the points of low discrepancy help).
//! Where a warning says that the result is infinite, neither is tested.
//!
//! `docs/monte-carlo.md` summarises the errors of the examples, whose rows this command prints:
//! `PAPILIO_SEEDS=16 cargo test -p papilio-validation --test validation -- errors_over_seeds --nocapture`.

use std::fmt::Write as _;
use std::sync::atomic::{AtomicUsize, Ordering};

use papilio_display::DisplayError;
use papilio_display::scene::{Method, Scene, Stop};
use papilio_scenario::Scenario;
use papilio_testing::{Campaign, CaseRow, everyday, mean_square_bounds, sized};
use papilio_validation::{run_on, scenario};

use crate::random_scenarios::draw::wide::wide;
use crate::random_scenarios::draw::{Drawn, drawn};
use crate::random_scenarios::summary::families;
use crate::random_scenarios::{each, range};

/// Seeds of the variance between seeds.
const SEEDS: u64 = 16;

/// Numbers of paths, as multiples of the smallest, and the numbers of seeds from which their standard errors
/// are computed.
const MULTIPLES: [(u64, u64); 4] = [(1, SEEDS), (4, SEEDS), (16, 4), (64, 2)];

/// Largest standard error over the one that falls with the root of the number of paths. Standard errors of 32
/// replicates are known to 13 %, the last ones therefore to 9 %. Random scenarios have fewer paths: at first,
/// some replicates miss their least probable light, and errors are less well known.
const MOST_OVER_ROOT: f64 = 1.5;
const MOST_OVER_ROOT_OF_RANDOM: f64 = 2.0;

/// Relative error from which on few paths find the light: its error is honest, but hardly known, and so is
/// its fall.
const FAINT: f64 = 0.1;

/// Multiple of the least stated error, that of few paths, below which an error may be too large.
const LIMITED: f64 = 10.0;

/// Relative errors below this one are those of rounding.
const NEGLIGIBLE: f64 = 1e-12;

/// What the runs of a scenario say about one state.
struct OfState {
    name: String,
    /// Standard error over Y with the fewest paths.
    relative_error: f64,
    /// Variance between seeds over the stated one, with the two smallest numbers of paths.
    ratios: [f64; 2],
    /// Standard error of each larger number of paths over that of the smallest.
    falls: [f64; 3],
}

/// The runs of a scenario.
struct Measured {
    name: String,
    paths: u64,
    /// States with noise.
    states: Vec<OfState>,
}

/// Computes Y of each state of the first view and its standard error.
fn states(scene: &mut Scene, paths: u64, seed: u64) -> Result<Vec<(String, f64, f64)>, DisplayError> {
    (scene.solver.stop, scene.solver.seed) = (Stop::Paths(paths), seed);
    let run = run_on(scene, Some(1))?;
    let of = run.views[0].states.iter();
    Ok(of.map(|(name, state)| (name.to_owned(), state.value.Y, state.standard_error.Y)).collect())
}

fn measured(name: &str, mut scene: Scene, paths: u64) -> Result<Measured, DisplayError> {
    scene.solver.method = Method::MonteCarlo;
    scene.viewer.theta_deg.truncate(1);
    scene.viewer.phi_deg.truncate(1);
    let mut runs = Vec::new();
    for (multiple, seeds) in MULTIPLES {
        let of_seed = |seed| states(&mut scene, multiple * paths, 1000 * multiple + seed);
        runs.push((0..seeds).map(of_seed).collect::<Result<Vec<_>, _>>()?);
    }
    let of_state = |k: usize| {
        let squares: Vec<f64> =
            runs.iter().map(|runs| mean(runs.iter().map(|run| run[k].2.powi(2)))).collect();
        let ratio = |number: usize| {
            let values = runs[number].iter().map(|run| run[k].1);
            let centre = mean(values.clone());
            let square = values.map(|value| (value - centre).powi(2)).sum::<f64>();
            square / (SEEDS - 1) as f64 / squares[number]
        };
        let (name, y, _) = &runs[0][0][k];
        let relative_error = squares[0].sqrt() / y;
        let falls = [1, 2, 3].map(|number| (squares[number] / squares[0]).sqrt());
        (relative_error > NEGLIGIBLE).then(|| OfState {
            name: name.clone(),
            relative_error,
            ratios: [0, 1].map(ratio),
            falls,
        })
    };
    let states = (0..runs[0][0].len()).filter_map(of_state).collect();
    Ok(Measured { name: name.to_owned(), paths, states })
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / count
}

impl Measured {
    fn largest(&self, of: impl Fn(&OfState) -> f64) -> f64 {
        self.states.iter().map(of).fold(0.0, f64::max)
    }

    /// Row of the table; numbers are the largest of all states, and of ratios also the smallest.
    fn row(&self) -> String {
        let Self { name, paths, states } = self;
        if states.is_empty() {
            return format!("| `{name}` | {paths} | no noise | | | | | |");
        }
        let percent = 100.0 * self.largest(|one| one.relative_error);
        let percent = if percent < 0.005 { "< 0.01".to_owned() } else { format!("{percent:.2}") };
        let mut row = format!("| `{name}` | {paths} | {percent} % |");
        for k in [0, 1] {
            let least = states.iter().map(|one| one.ratios[k]).fold(f64::INFINITY, f64::min);
            let _ = write!(row, " {least:.2} to {:.2} |", self.largest(|one| one.ratios[k]));
        }
        for k in [0, 1, 2] {
            let _ = write!(row, " {:.3} |", self.largest(|one| one.falls[k]));
        }
        row
    }

    /// Describes what is not as it should be; errors are at most `over_root` times those that fall with the
    /// root.
    fn faults(&self, over_root: f64) -> Vec<String> {
        // The variance of a ratio: 2 by the seeds, and some by the uncertainty of the errors and by the tails
        // of paths.
        let bounds = mean_square_bounds(1.0, 2.55, (SEEDS - 1) as f64);
        let mut faults = Vec::new();
        for OfState { name, relative_error, ratios, falls } in &self.states {
            // Runs with few paths have errors of at least 1/paths.
            let limits = [1.0 / self.paths as f64, 0.25 / self.paths as f64 / falls[0]];
            let is_limited = |limit: f64| *relative_error < LIMITED * limit;
            let is_wrong = |(ratio, limit): (&f64, f64)| {
                ratio > bounds.end() || (ratio < bounds.start() && !is_limited(limit))
            };
            if ratios.iter().zip(limits).any(is_wrong) {
                faults.push(format!(
                    "{}, {name}: variance over stated variance {ratios:.2?}, not in {bounds:.2?}",
                    self.name
                ));
            }
            let most = [0.5, 0.25, 0.125].map(|root| over_root * root);
            if *relative_error < FAINT && falls.iter().zip(most).any(|(fall, most)| *fall > most) {
                faults
                    .push(format!("{}, {name}: errors fall to {falls:.3?}, more than {most:.3?}", self.name));
            }
        }
        faults
    }
}

fn assert_honest(all: &[Measured], over_root: f64) {
    let faults: Vec<String> = all.iter().flat_map(|one| one.faults(over_root)).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Examples that take milliseconds: a colour filter, and layers.
const EVERYDAY: [&str; 2] = ["printed-filter", "ward"];

#[test]
fn errors_over_seeds_of_every_example_are_honest() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios");
    let files = folder.read_dir().unwrap().flatten().map(|entry| entry.path());
    let mut names: Vec<String> = files
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .map(|path| path.file_stem().unwrap().to_string_lossy().into_owned())
        .filter(|name| sized(EVERYDAY.contains(&name.as_str()), true))
        .collect();
    names.sort();
    let all = each(&names, |name| {
        // Steps that divide the ranges of all examples: 380 to 780 nm, and 380 to 730 nm of a file of a lamp.
        let scene = scenario(name, &[sized("spectrum.step_nm=50", "spectrum.step_nm=25")]).unwrap().scene;
        let measured = measured(name, scene, sized(256, 2048)).unwrap();
        println!("{}", measured.row());
        measured
    });
    assert_honest(&all, MOST_OVER_ROOT);
}

/// The first random scenario, and two with Ward's lobe in Duer's normalisation over paper.
const EVERYDAY_RANDOM: [u64; 3] = [0, 116, 247];

/// A random scenario; `None` if it is refused (films with too many fringes) or warned of as infinite, of which `infinite`
/// counts the latter.
fn random(drawn: Drawn, infinite: &AtomicUsize) -> Option<(String, Scene)> {
    let number = drawn.number;
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios");
    let set = ["solver.method=monte-carlo".to_owned()];
    let resolved =
        Scenario::from_text(&drawn.text, "random.toml", &folder, &set).and_then(|all| all.resolve()).ok()?;
    let is_infinite = resolved.warnings.iter().any(|warning| warning.contains("is infinite"));
    let name = format!("{number} ({})", drawn.name);
    if is_infinite {
        infinite.fetch_add(1, Ordering::Relaxed);
        println!("| `{name}` | infinite | | | | | | |");
    }
    (!is_infinite).then_some((name, resolved.scene))
}

#[test]
fn errors_over_seeds_of_random_scenarios_are_honest() {
    let numbers: Vec<u64> = match range("PAPILIO_SCENARIOS") {
        Some(numbers) => numbers.collect(),
        None => sized(EVERYDAY_RANDOM.to_vec(), (0..200).collect()),
    };
    let infinite = AtomicUsize::new(0);
    let all = each(&numbers, |number| {
        let (name, scene) = random(drawn(*number), &infinite)?;
        let measured = measured(&name, scene, sized(64, 1024)).ok()?;
        println!("{}", measured.row());
        if !measured.faults(MOST_OVER_ROOT_OF_RANDOM).is_empty() {
            println!("{}", drawn(*number).text);
        }
        Some(measured)
    });
    let all: Vec<Measured> = all.into_iter().flatten().collect();
    let ratios = all.iter().flat_map(|one| one.states.first()).map(|state| state.ratios);
    let (count, sums) = ratios.fold((0.0, [0.0; 2]), |(n, [a, b]), [c, d]| (n + 1.0, [a + c, b + d]));
    println!("{count} scenarios with noise, mean of the ratios {:.3?}", sums.map(|sum| sum / count));
    let compared = all.len() + infinite.into_inner();
    assert!(compared + 1 + numbers.len() / 20 >= numbers.len(), "{compared} of {}", numbers.len());
    assert_honest(&all, MOST_OVER_ROOT_OF_RANDOM);
}

/// Displays of the campaign over the whole grammar.
const WIDE: u64 = 400;

/// Variance of the logarithm of a ratio of two standard errors of 32 replicates, of 16 and 2 seeds.
const OF_FALLS: f64 = 0.5 * (1.0 / 31.0) * (1.0 / 16.0 + 1.0 / 2.0);

/// Over the whole grammar: the variance between seeds and the slope of the error with paths, by family of displays. In
/// the campaign only, whose files other machines can compute in parts.
#[test]
fn errors_over_seeds_of_the_whole_grammar_are_honest() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("random");
    let header = "relative_error,ratio_1,ratio_4,fall_4,fall_16,fall_64";
    let Some(campaign) = sized(None, Some(())).map(|()| Campaign::open(&folder, "seeds", header)) else {
        return;
    };
    let infinite = AtomicUsize::new(0);
    each(&campaign.missing(0..WIDE), |number| {
        let begun = std::time::Instant::now();
        let drawn = wide(*number);
        let (name, paths) = (drawn.name.clone(), drawn.paths / 32);
        let found = random(drawn, &infinite).and_then(|(_, scene)| measured(&name, scene, paths).ok());
        let states = found.map_or_else(Vec::new, |found| found.states);
        let row = |state: &OfState| {
            let OfState { name: of, relative_error, ratios, falls } = state;
            let numbers = [&[*relative_error][..], ratios, falls].concat();
            CaseRow::new(*number, &name, of, numbers)
        };
        let rows: Vec<CaseRow> = states.iter().map(row).collect();
        campaign.append(*number, &name, &rows, &[begun.elapsed().as_secs_f64()]);
    });
    let mut by_family: std::collections::BTreeMap<String, Vec<[f64; 3]>> = Default::default();
    for rows in campaign.rows().into_values() {
        // The states of a display share their paths: the first one with noise counts.
        let known = |row: &&CaseRow| row.numbers.len() == 6 && row.numbers[0] < FAINT;
        for row in rows.iter().find(known).into_iter() {
            let slope = row.numbers[5].ln() / 64.0_f64.ln();
            for family in families(&row.name) {
                by_family.entry(family).or_default().push([row.numbers[1], row.numbers[2], slope]);
            }
        }
    }
    let mut table =
        "family,displays,variance_over_stated,with_4_times_the_paths,slope,slope_by_chance\n".to_owned();
    let mut faults = Vec::new();
    for (family, rows) in &by_family {
        let count = rows.len() as f64;
        let [few, more, slope] = [0, 1, 2].map(|k| mean(rows.iter().map(|row| row[k])));
        // At most this by chance, were the true slope -0.5.
        let most = -0.5 + 4.5 * (OF_FALLS / count).sqrt() / 64.0_f64.ln();
        let _ = writeln!(table, "{family},{count},{few:.3},{more:.3},{slope:.3},{most:.3}");
        let bounds = mean_square_bounds(1.0, 2.55 / (SEEDS - 1) as f64, count);
        if few > *bounds.end() || more > *bounds.end() || slope > most {
            faults.push(format!(
                "{family}: {few:.3}, {more:.3} of {bounds:.3?}; slope {slope:.3} of {most:.3}"
            ));
        }
    }
    println!("{table}");
    std::fs::write(campaign.folder().join("seeds.csv"), table).unwrap();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Displays in which light that is scattered comes to Ward's lobe in Duer's normalisation near the horizon,
/// where its weight has no bound: from a pixel, another lobe above and below, a rough face, a slab.
const TOWARDS_HORIZON: [(&str, &str); 5] = [
    ("pixel", "{ kind = \"medium\", index = 1.5 }"),
    (
        "lobe above",
        "{ kind = \"diffuser\", model = \"k-correlation\", width = 0.3, transmittance = 0.9 }, { kind = \"medium\", index = 1 }, DUER, \
         { kind = \"medium\", index = 1.5 }",
    ),
    (
        "lobe below",
        "DUER, { kind = \"medium\", index = 1 }, { kind = \"diffuser\", model = \"lambertian\", transmittance = 0.9 }, \
         { kind = \"medium\", index = 1.5 }",
    ),
    (
        "rough face",
        "DUER, { kind = \"medium\", index = 1 }, { kind = \"rough\", alpha = 0.6 }, { kind = \"medium\", index = 1.5 }",
    ),
    ("slab", "DUER, { kind = \"slab\", index = 1.3, optical_thickness = 0.7, anisotropy = 0.3 }"),
];

/// The scenario of these layers over paper, under diffuse light and a beam.
fn towards_horizon(layers: &str, method: &str) -> Scene {
    let duer = "{ kind = \"diffuser\", model = \"ward\", alpha = 0.3, normalisation = \"duer\", transmittance = 0.8 }";
    let layers =
        if layers.contains("DUER") { layers.replace("DUER", duer) } else { format!("{duer}, {layers}") };
    let text = format!(
        "[spectrum]\nrange_nm = [400, 700]\nstep_nm = 150\n[display]\nlayers = [{layers}]\n[display.pixel]\nmodel = \"uniform\"\n\
         kind = \"lambertian\"\nreflectance = {{ white = 0.8 }}\n[lighting]\nspectrum = \"E\"\nilluminance_lx = 500\ndiffuse = 0.5\n\
         [[lighting.directed]]\nshare = 0.5\ntheta_deg = 40\n[viewer]\ntheta_deg = 10\n[solver]\nmethod = \"{method}\"\n"
    );
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let resolved = Scenario::from_text(&text, "horizon.toml", folder, &[]).and_then(|all| all.resolve());
    resolved.unwrap_or_else(|errors| panic!("{errors}")).scene
}

/// Errors are honest and fall with the root of the number of paths, and the mean is that of *adding*.
#[test]
fn errors_of_light_near_the_horizon_are_honest() {
    let displays: Vec<(&str, &str)> = everyday(2, TOWARDS_HORIZON).collect();
    let all = each(&displays, |(name, layers)| {
        let measured = measured(name, towards_horizon(layers, "monte-carlo"), sized(64, 1024)).unwrap();
        println!("{}", measured.row());
        let mut scene = towards_horizon(layers, "monte-carlo");
        let [(_, value, error)] = &states(&mut scene, sized(1 << 13, 1 << 17), 7).unwrap()[..] else {
            panic!()
        };
        let adding = run_on(&towards_horizon(layers, "adding"), Some(1)).unwrap();
        let adding = &adding.views[0].states.iter().next().unwrap().1;
        let exact = adding.value.Y;
        let stated = adding.discretisation_error.as_ref().map_or(0.0, |error| error.Y);
        println!("{name}: {value} +- {error}, adding {exact} +- {stated}");
        assert!(
            (value - exact).abs() < 4.5 * error + stated,
            "{name}: {value} +- {error}, adding {exact} +- {stated}"
        );
        measured
    });
    assert_honest(&all, MOST_OVER_ROOT_OF_RANDOM);
}
