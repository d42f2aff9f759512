//! Comparison of the two solvers on a family of random displays, with all kinds of layers,
//! light and views. Each number of the Monte Carlo solver is compared with that of adding, and the
//! z-scores must be distributed as Student's t.
use papilio_display::result::{State, StateValues, View};
use papilio_display::scene::{Method, Stop};
use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;
use papilio_sampling::{SampleStream, Sampler};
use papilio_testing::{assert_student, everyday, mean_and_error, sized};
use papilio_transport::adding::{Kernel, error_over_difference, nodes_needed};
use papilio_transport::walk::Walk;
use papilio_transport::{Base, Cone, Diffuser, Estimate, Interface, Layer, Medium, Reflector, Source, Stack};
use papilio_validation::random_stacks::{
    Member, STATES, WAVELENGTHS_NM, member, rare_member, reflecting_member,
};
use papilio_validation::{run, scenario};
use rayon::prelude::*;

const REPLICATES: u64 = 32;

/// Returns all numbers of an estimate that both solvers compute, except `unaccounted`.
fn numbers(estimate: &Estimate) -> Vec<f64> {
    let bins = WAVELENGTHS_NM.len();
    let mut all = Vec::new();
    for rho in &estimate.rho {
        all.extend((0..STATES * bins).map(|k| rho.via_pixel[k] + rho.front[k % bins]));
    }
    let ledger = &estimate.ledger;
    for part in
        [&ledger.returned, &ledger.front, &ledger.diffuser, &ledger.glass, &ledger.pixel, &ledger.inactive]
    {
        all.extend(part);
    }
    all
}

/// The results of both solvers for one number.
#[derive(Debug, Clone, Copy)]
struct Pair {
    walk: f64,
    standard_error: f64,
    adding: f64,
    discretisation_error: f64,
}

/// Largest total error of the tables of films and coatings, as a fraction of the light.
const TABLES: f64 = 1e-7;

impl Pair {
    /// Returns whether the Monte Carlo noise is most of the expected difference; only then is z distributed
    /// as Student's t. (Closed forms have no noise; for rough interfaces, adding has a large discretisation
    /// error.)
    fn is_noisy(self) -> bool {
        self.standard_error > 3.0 * self.discretisation_error.hypot(TABLES)
    }

    fn z(self) -> f64 {
        let error = self.standard_error.hypot(self.discretisation_error).hypot(TABLES);
        (self.walk - self.adding) / error
    }
}

/// Returns mean and standard error of each number over the Monte Carlo replicates.
fn walk(member: &Member, (sampler, seed): (Sampler, u64), paths: u64) -> Vec<(f64, f64)> {
    let walk = Walk::new(&member.stack, member.view, &member.sources);
    let replicates: Vec<Vec<f64>> = (0..REPLICATES)
        .map(|stream| {
            let mut replicate = walk.replicate();
            walk.trace(&mut replicate, &SampleStream::new(sampler, seed, stream), paths);
            numbers(&walk.estimate(&replicate))
        })
        .collect();
    let numbers = 0..replicates[0].len();
    numbers.map(|k| mean_and_error(replicates.iter().map(|replicate| replicate[k]))).collect()
}

/// Finest level, and largest number of nodes; beyond these, rough interfaces take minutes. The
/// remaining error is part of the z-scores.
const FINEST: u32 = 2;
const MAX_NODES: usize = 150;

/// Returns each number and its discretisation error, refined until the latter is small compared with
/// the Monte Carlo standard errors.
fn adding(member: &Member, walk: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut before: Option<Vec<f64>> = None;
    let mut found = Vec::new();
    let bound = error_over_difference(&member.stack, &member.sources);
    for level in 0..=FINEST {
        if level > 1 && nodes_needed(&member.stack, level) > MAX_NODES {
            break;
        }
        let mut kernel = Kernel::new(level);
        kernel.prepare(&member.stack, &[member.view], &member.sources);
        let now = numbers(&kernel.estimate(&member.stack, 0));
        if let Some(before) = before {
            found =
                now.iter().zip(&before).map(|(now, before)| (*now, bound * (now - before).abs())).collect();
            let good =
                |((_, error), (_, standard)): (&(f64, f64), &(f64, f64))| *error <= 0.2 * standard + 1e-9;
            if found.iter().zip(walk).all(good) {
                break;
            }
        }
        before = Some(now);
    }
    found
}

/// Returns the numbers of both solvers: those of adding, computed once, with those of Monte Carlo for each
/// seed.
fn compare(member: &Member, sampler: Sampler, seeds: &[u64], paths: u64) -> Vec<Vec<Pair>> {
    let walks: Vec<_> = seeds.iter().map(|seed| walk(member, (sampler, *seed), paths)).collect();
    let adding = adding(member, &walks[0]);
    let pairs = |walk: Vec<(f64, f64)>| {
        let pair = |((walk, standard_error), (adding, discretisation_error)): (&(f64, f64), &(f64, f64))| {
            let (walk, standard_error) = (*walk, *standard_error);
            let (adding, discretisation_error) = (*adding, *discretisation_error);
            Pair { walk, standard_error, adding, discretisation_error }
        };
        walk.iter().zip(&adding).map(pair).collect()
    };
    walks.into_iter().map(pairs).collect()
}

/// Returns whether the long tests are requested.
fn has_time() -> bool {
    std::env::var_os("PAPILIO_STACKS").is_some()
}

/// Returns the numbers of members and of seeds: `everyday` members, or the value of `PAPILIO_STACKS` with two
/// seeds each.
fn count(everyday: u64) -> (u64, u64) {
    std::env::var("PAPILIO_STACKS").map_or((everyday, 1), |more| (more.parse().unwrap(), 2))
}

/// Smallest value that counts for the largest deviation. Few of some thousand paths contribute to fainter
/// light (such as that transmitted through eleven mean free paths of an absorbing slab), so that the means of
/// replicates are far from normal.
const FAINT: f64 = 1e-4;

/// The z-scores of one member.
#[derive(Debug, Default)]
struct Scores {
    /// One number of each source, selected by the number of the member.
    sources: Vec<f64>,
    /// One number of the ledger.
    ledger: Vec<f64>,
    /// The largest deviations, with descriptions.
    worst: Vec<(f64, String)>,
}

fn scores(member: &Member, number: u64, sampler: Sampler, seeds: u64, paths: u64) -> Scores {
    let seeds: Vec<u64> = (0..seeds).map(|seed| number + 1_000_000 * seed).collect();
    let mut scores = Scores::default();
    for pairs in compare(member, sampler, &seeds, paths) {
        let each = STATES * WAVELENGTHS_NM.len();
        let ledger = member.sources.len() * each;
        let noisy = |k: usize| Some(pairs[k]).filter(|pair| pair.is_noisy()).map(Pair::z);
        let drawn = (0..member.sources.len()).map(|source| source * each + number as usize % each);
        scores.sources.extend(drawn.filter_map(noisy));
        // Of the ledger, the first noisy number after a selected position: most numbers of most members are
        // zero.
        let parts = pairs.len() - ledger;
        let turned = (0..parts).map(|k| ledger + (number as usize + k) % parts);
        scores.ledger.extend(turned.filter_map(noisy).next());
        let bright = pairs.iter().enumerate().filter(|(_, pair)| pair.adding.abs() > FAINT);
        let worst = bright.max_by(|a, b| a.1.z().abs().total_cmp(&b.1.z().abs()));
        let (k, pair) = worst.unwrap();
        scores.worst.push((pair.z(), format!("{number} ({}) [{k}] {pair:?}", member.name)));
    }
    scores
}

/// Compares mean and mean square of z with those of Student's t.
fn compare_with_student(what: &str, z: &[f64]) {
    let n = z.len() as f64;
    let (mean, square) = (z.iter().sum::<f64>() / n, z.iter().map(|z| z * z).sum::<f64>() / n);
    println!("{what}: {n} z-scores: mean {mean:.3}, mean square {square:.3}; Student's t: 0, 1.069");
    assert_student(what, z, n);
}

/// All numbers of a member come from the same paths and are strongly correlated. The
/// distribution is therefore tested on a few numbers of each member, the largest deviation on all.
fn assert_distribution(what: &str, all: &[Scores], most: f64) {
    let gathered = |of: fn(&Scores) -> &Vec<f64>| all.iter().flat_map(of).copied().collect::<Vec<f64>>();
    let mut worst: Vec<&(f64, String)> = all.iter().flat_map(|scores| &scores.worst).collect();
    worst.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    for (z, what) in worst.iter().take(10) {
        println!("z {z:.2}: {what}");
    }
    compare_with_student(&format!("{what}, sources"), &gathered(|scores| &scores.sources));
    compare_with_student(&format!("{what}, ledger"), &gathered(|scores| &scores.ledger));
    assert!(worst[0].0.abs() < most, "{worst:?}");
}

/// Largest deviation: 36 numbers of each of 20 members, Student's t with 31 degrees of freedom; one number in
/// 5 million exceeds 6.5.
#[test]
fn random_stacks_have_student_distributed_deviations() {
    let (count, seeds) = count(8);
    let one = |number| {
        let member = member(number);
        // Paths in a panel are fast; faint light of a source far from the peak of a narrow lobe needs many.
        let paths = sized(1, 2) * if member.stack.panel().is_some() { 1 << 13 } else { 1 << 9 };
        scores(&member, number, Sampler::Random, seeds, paths)
    };
    let all: Vec<Scores> = (0..count).into_par_iter().map(one).collect();
    assert_distribution("random stacks", &all, 6.5);
}

/// The same for diffusers that reflect light by lobes of their own and mirror a part of it.
#[test]
fn reflecting_diffusers_have_student_distributed_deviations() {
    let (count, seeds) = count(4);
    let paths = sized(1 << 9, 1 << 10);
    let one = |number| scores(&reflecting_member(number), number, Sampler::Random, seeds, paths);
    let all: Vec<Scores> = (0..count).into_par_iter().map(one).collect();
    assert_distribution("reflecting diffusers", &all, 6.5);
}

/// The spread of replicates includes improbable events, with the sampler and about the smallest number of
/// paths of a run. (With so few paths, the means of replicates are not quite normal, and a relative
/// difference of 1e-5 of a number that is nearly a closed form may be many of its errors; the limit of the
/// largest deviation is therefore larger.)
#[test]
fn standard_errors_include_improbable_events() {
    let (count, seeds) = count(12);
    let one = |number| scores(&rare_member(number), number, Sampler::Sobol, seeds, 1 << 7);
    let all: Vec<Scores> = (0..count).into_par_iter().map(one).collect();
    assert_distribution("rare ways", &all, if seeds > 1 { 25.0 } else { 10.0 });
}

/// All tracers include light from 89.9999999 deg, whose sine is 1 to the last bit, from every azimuth: a
/// Lambertian base under an interface that transmits all light returns the same fraction as for any other
/// light.
#[test]
fn light_just_above_horizon_is_included_by_all_tracers() {
    let bins = WAVELENGTHS_NM.len();
    let base = || Base {
        reflector: Reflector::lambertian(vec![0.5; STATES * bins], bins),
        inactive_absorptance: vec![0.0; bins].into(),
    };
    let air = || Medium::new(vec![1.0; bins].into());
    let under = |interface| vec![Layer::new(interface, air())];
    let diffuser = Diffuser {
        lobe: Lobe::KCorrelation { width: 0.1 },
        transmittance: vec![1.0; bins].into(),
        regular_fraction: 0.3,
    };
    for theta in [89.999_999, 89.999_999_9, 89.999_999_999] {
        for phi in [0.0, 33.3, 90.0, 217.0] {
            let sources = vec![Source::Beam(Beta::from_source(theta, phi, 1.0))];
            let stacks = [
                (Stack::new(under(Interface::IdealAr), base()), Some(0.5)),
                (Stack::general(under(Interface::IdealAr), base()), Some(0.5)),
                (Stack::new(under(Interface::Diffuser(diffuser.clone())), base()), None),
            ];
            for (number, (stack, exact)) in stacks.into_iter().enumerate() {
                let view = Cone::new(8.0, 0.0, 0.05, 1.0);
                let member = Member { name: String::new(), stack, view, sources: sources.clone() };
                let walk = walk(&member, (Sampler::Sobol, 1), 64);
                let adding = adding(&member, &walk);
                for ((found, error), (truth, of_adding)) in walk.iter().zip(&adding).take(STATES * bins) {
                    let truth = exact.unwrap_or(*truth);
                    let off = (found - truth).abs();
                    assert!(
                        truth > 0.0 && off <= 5.0 * error.hypot(*of_adding) + 1e-6,
                        "{number} {theta} {phi}: {found} {truth}"
                    );
                }
            }
        }
    }
}

/// A gap of 16 um has 85 fringes over angle, and resonances that are far narrower. Earlier, Monte Carlo gave
/// 0.33 for white, and adding gave no number.
#[test]
fn both_solvers_agree_on_thick_gaps_or_refuse_them() {
    let by = |gap: &str, solver: &str| {
        let all =
            ["spectrum.range_nm=[500,600]", "spectrum.step_nm=50", "display.diffuser.haze=0.3", gap, solver];
        run(&scenario("indoor", &all).unwrap().scene)
    };
    let [adding, walk] = ["solver.method=adding", "solver.method=monte-carlo"]
        .map(|solver| by("display.pixel.gap_nm.red=16000", solver));
    let (adding, walk) = (adding.unwrap(), walk.unwrap());
    for (name, noisy) in walk.views[0].states.iter() {
        let exact = adding.views[0].states.get(name).unwrap();
        let z = (noisy.value.Y - exact.value.Y) / noisy.standard_error.Y;
        assert!(z.abs() < 5.0, "{name}: {} {}", noisy.value.Y, exact.value.Y);
        assert!(noisy.value.radiance.iter().all(|radiance| *radiance > 0.0), "{name}");
    }
    for solver in ["solver.method=adding", "solver.method=monte-carlo"] {
        let error = by("display.pixel.gap_nm.red=100000", solver).unwrap_err().to_string();
        assert!(error.contains("display.pixel.gap_nm.red") && error.contains("fringes"), "{error}");
    }
}

/// A run with few paths is computed as requested, with a warning and a lower limit of the standard errors.
#[test]
fn too_few_paths_give_warning_and_minimum_errors() {
    let of =
        |paths: &str| run(&scenario("indoor", &["solver.method=monte-carlo", paths]).unwrap().scene).unwrap();
    let few = of("solver.paths=64");
    assert!(
        few.warnings.iter().any(|warning| warning.contains("64 paths per view are too few")),
        "{:?}",
        few.warnings
    );
    for (_, state) in few.views[0].states.iter() {
        assert!(state.standard_error.Y >= state.value.Y / 64.0);
    }
    let enough = of("solver.paths=4096");
    assert!(!enough.warnings.iter().any(|warning| warning.contains("too few")), "{:?}", enough.warnings);
}

/// Values of a view with their errors, in a fixed order.
fn of_view(view: &View, of_solver: impl Fn(&State) -> &StateValues) -> Vec<(String, f64, f64)> {
    let mut all = Vec::new();
    for (name, state) in view.states.iter() {
        let (value, error) = (&state.value, of_solver(state));
        all.push((format!("{name} Y"), value.Y, error.Y));
        all.push((format!("{name} X"), value.X, error.X));
        all.push((format!("{name} Z"), value.Z, error.Z));
        all.push((format!("{name} diffuse"), value.terms.diffuse, error.terms.diffuse));
        for bin in (0..value.radiance.len()).step_by(8) {
            all.push((format!("{name} radiance {bin}"), value.radiance[bin], error.radiance[bin]));
        }
    }
    all
}

/// Scenarios that take seconds and are like others: faces by waves and by rays are compared in
/// `papilio_display`'s tests of microgeometry, measured diffusers by `measured-diffused` and in `measured.rs`, maps of
/// light by `map-regions`, liquid crystals by `stn` and `mip-lcd-cover`, and below haze films in `papilio_display`'s tests.
const ONLY_IN_FULL: [&str; 7] =
    ["etched-face", "hazy-face", "map", "measured-h65", "measured-h78", "mip-lcd", "mip-lcd-haze"];

/// Adding refuses a colour filter below a film that reflects; `papilio_display` compares filters above liquid crystals without that reflection. It refuses
/// particles whose polarised light is followed; the transport's tests compare them with published tables.
const BY_PATHS_ALONE: [&str; 2] = ["mip-lcd-colour", "rayleigh-film"];

/// Every scenario of the repository through both solvers, at every view: colours, spectra and parts. (Every
/// day, fewer.) About 3000 numbers: 6.5 of Student's 31 degrees of freedom happens to one of 5 million.
#[test]
fn every_scenario_agrees() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios");
    let mut names: Vec<String> = folder
        .read_dir()
        .unwrap()
        .flatten()
        .filter(|entry| entry.path().extension().is_some_and(|extension| extension == "toml"))
        .map(|entry| entry.path().file_stem().unwrap().to_string_lossy().into_owned())
        .collect();
    names.sort();
    assert!(names.len() >= 13, "{names:?}");
    let paths = if has_time() { 65_536 } else { 8192 };
    names.retain(|name| !BY_PATHS_ALONE.contains(&name.as_str()));
    names.retain(|name| has_time() || !ONLY_IN_FULL.contains(&name.as_str()));
    for name in names {
        // A coarse grid that divides the ranges of all examples, 380 to 780 nm, and 380 to 730 nm of a file
        // of a lamp: what is compared is transport, wavelength by wavelength.
        let step = if has_time() { "spectrum.step_nm=25" } else { "spectrum.step_nm=50" };
        let mut scene = scenario(&name, &["solver.method=adding", step]).unwrap().scene;
        // Of many views every day only some: neighbours have much in common.
        let views = &mut scene.viewer.theta_deg;
        let step = views.len().div_ceil(if has_time() { views.len() } else { 2 });
        *views = views.iter().copied().step_by(step).collect();
        let adding = run(&scene).unwrap();
        (scene.solver.method, scene.solver.stop) = (Method::MonteCarlo, Stop::Paths(paths));
        let walk = run(&scene).unwrap();
        // Adding computes a liquid crystal in each direction, and paths interpolate in its table, within 1e-4: 6.5 of these are 2e-4.
        let is_crystal = matches!(scene.display.pixel, papilio_display::scene::Pixel::Crystal(_));
        let of_table = if is_crystal { 3e-5 } else { 0.0 };
        for (exact, noisy) in adding.views.iter().zip(&walk.views) {
            let exact = of_view(exact, |state| state.discretisation_error.as_ref().unwrap());
            let noisy = of_view(noisy, |state| &state.standard_error);
            for ((what, exact, discretisation), (_, noisy, standard)) in exact.into_iter().zip(noisy) {
                let rounding = 1e-7 * exact.abs() + 1e-12;
                let error = standard.hypot(discretisation) + rounding + of_table * (1.0 + exact.abs());
                let z = (noisy - exact) / error;
                assert!(
                    z.abs() < 6.5,
                    "{name}: {what}: walk {noisy} +- {standard}, adding {exact} +- {discretisation}"
                );
            }
        }
    }
}

/// A thin slab on absorbing glass, seen near the critical angle: it traps much of the light that it scatters
/// once. A stop at 4096 paths was up to ten standard errors too low.
const TRAPPING: &str = r#"
[spectrum]
range_nm = [400, 700]
step_nm = 50
[[display.front]]
reflectance = 0.0625
absorptance = 0.0226
[display.glass]
index = 1.3
internal_transmittance = 0.7926
[display.diffuser]
model = "slab"
optical_thickness = 0.0314
anisotropy = 0.881
albedo = 0.8914
index = 1.5
[display.pixel]
model = "uniform"
kind = "mirror"
reflectance = { white = 0.3891, black = 0.0778 }
[lighting]
diffuse = 1
[viewer]
theta_deg = 75.5652
"#;

#[test]
fn monte_carlo_stopped_at_a_target_has_honest_errors_of_light_that_a_thin_slab_traps() {
    let by = |overrides: &[String]| {
        let scenario = papilio_scenario::Scenario::from_text(
            TRAPPING,
            "trapping.toml",
            std::path::Path::new(""),
            overrides,
        );
        run(&scenario.unwrap().resolve().unwrap().scene).unwrap()
    };
    let exact = by(&["solver.relative_error=1e-5".to_owned()]);
    for seed in everyday(1, 1..=4) {
        let set = ["method=monte-carlo", "relative_error=0.001", &format!("seed={seed}")];
        let found = by(&set.map(|set| format!("solver.{set}")));
        for ((name, exact), (_, found)) in exact.views[0].states.iter().zip(found.views[0].states.iter()) {
            let z = (found.value.Y - exact.value.Y) / found.standard_error.Y;
            assert!(z.abs() < 4.5, "{name}, seed {seed}: z {z}");
        }
    }
}

/// Rough faces of the narrowest lobes that adding accepts, of 300 to 450 directions: at and about the mirror
/// image of a beam, and far from it. 24 numbers each: 5.5 of Student's 31 degrees of freedom happens to one
/// of 200 000.
#[test]
fn faces_of_the_narrowest_lobes_agree() {
    for alpha in everyday(1, [0.01, 0.012, 0.0135]) {
        let text = format!(
            "[display]\nlayers = [{{ kind = \"rough\", alpha = {alpha} }}, {{ kind = \"medium\", index = 1.5 }}]\n[display.pixel]\n\
             model = \"uniform\"\nkind = \"lambertian\"\nreflectance = {{ white = 0.6, black = 0.03 }}\n[spectrum]\nstep_nm = 200\n\
             [lighting]\ndiffuse = 0.6\n[[lighting.directed]]\ntheta_deg = -30\nshare = 0.4\n[viewer]\ntheta_deg = [0, 25, 28, 45]\n\
             field_deg = 0\n"
        );
        let by = |set: &str| {
            let folder = std::path::Path::new("");
            let scenario =
                papilio_scenario::Scenario::from_text(&text, "rough.toml", folder, &[set.to_owned()]);
            run(&scenario.unwrap().resolve().unwrap().scene).unwrap()
        };
        let exact = by("solver.method=adding");
        let nodes = exact.solver.nodes.unwrap();
        assert!((300..=450).contains(&nodes), "alpha {alpha}: {nodes}");
        let noisy = by("solver={method=\"monte-carlo\",paths=16384}");
        for (exact, noisy) in exact.views.iter().zip(&noisy.views) {
            for ((name, exact), (_, noisy)) in exact.states.iter().zip(noisy.states.iter()) {
                let (value, found, error) = (&exact.value, &noisy.value, &noisy.standard_error);
                for (value, found, error) in
                    [(value.X, found.X, error.X), (value.Y, found.Y, error.Y), (value.Z, found.Z, error.Z)]
                {
                    let error = error.hypot(2e-6 * value);
                    assert!(
                        (found - value).abs() < 5.5 * error,
                        "{alpha} {name}: {found} +- {error}, {value}"
                    );
                }
            }
        }
    }
}
