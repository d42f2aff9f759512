//! All strategies for directions, with all kinds of random numbers: the same mean as adding, honest standard
//! errors, and the gain of the guide.
use crate::common::Panel;
use crate::common::{self, REPLICATES, everyday, front, lambertian, mirror, one, panel, rho, sized};
use papilio_optics::lobe::Lobe;
use papilio_optics::{Beta, Scatterer};
use papilio_sampling::{SampleStream, Sampler};
use papilio_testing::assert_student;
use papilio_transport::adding::Kernel;
use papilio_transport::walk::{Strategy, Walk};
use papilio_transport::{AngularTable, Base, Cone, Diffuser, Estimate, Nodes, Reflector, Source, Stack, Top};

/// A mirror that is brighter at some angles than at others.
fn coloured() -> Base {
    let nodes = 17;
    let basis: Vec<f64> =
        (0..nodes).map(|k| 0.5 + 0.4 * (12.0 * k as f64 / (nodes - 1) as f64).cos()).collect();
    let table = AngularTable {
        nodes: Nodes::Cosines(nodes),
        basis: basis.into(),
        mixture: vec![1.0],
        common: vec![0.0],
    };
    Base { reflector: Reflector::Specular(table), inactive_absorptance: one(0.05) }
}

fn display(width: f64, regular_fraction: f64, base: Base) -> Panel {
    let lobe = Lobe::KCorrelation { width };
    let mut stack = panel(Top::Diffuser(Diffuser { lobe, transmittance: one(0.95), regular_fraction }), base);
    stack.front = front(&[(0.08, 0.01)]);
    stack
}

fn view() -> Cone {
    Cone::new(8.0, 0.0, 0.05, 1.0)
}

/// Diffuse light, a beam near the mirror direction, a disc next to it.
fn near() -> Vec<Source> {
    vec![
        Source::Diffuse,
        Source::Beam(Beta::from_source(-20.0, 0.0, 1.0)),
        Source::Disc(Cone::new(30.0, 120.0, 4.0, 1.0)),
    ]
}

fn estimates(
    stack: &Stack,
    sources: &[Source],
    strategy: Strategy,
    (sampler, seed): (Sampler, u64),
    paths: u64,
) -> Vec<Estimate> {
    let walk = Walk::with_strategy(stack, view(), sources, strategy, &[]);
    let of = |stream| {
        let mut replicate = walk.replicate();
        walk.trace(&mut replicate, &SampleStream::new(sampler, seed, stream), paths);
        walk.estimate(&replicate)
    };
    (0..REPLICATES).map(of).collect()
}

fn adding(stack: &Stack, sources: &[Source]) -> Estimate {
    let mut kernel = Kernel::new(2);
    kernel.prepare(stack, &[view()], sources);
    kernel.estimate(stack, 0)
}

/// Quantities that are compared.
fn quantities(e: &Estimate) -> Vec<f64> {
    let sources = (0..e.rho.len()).map(|source| rho(e, source));
    let ledger = &e.ledger;
    sources.chain([ledger.returned[0], ledger.pixel[0], ledger.front[0], ledger.diffuser[0]]).collect()
}

/// z-scores of all quantities relative to adding.
fn scores(estimates: &[Estimate], truth: &Estimate) -> Vec<f64> {
    let all: Vec<Vec<f64>> = estimates.iter().map(quantities).collect();
    let score = |(k, truth): (usize, &f64)| {
        let (mean, error) = common::mean_and_error(all.iter().map(|one| one[k]));
        // The errors of adding and of the tables.
        (mean - truth) / error.hypot(3e-7 * (1.0 + truth))
    };
    quantities(truth).iter().enumerate().map(score).collect()
}

/// Tests scores as Student's t, with as many independent ones as there are displays (the quantities of one
/// are correlated); the largest must be below 6.5.
fn assert_scattered(what: &str, scores: &[f64], independent: f64) {
    assert_student(what, scores, independent);
    let worst = scores.iter().fold(0.0_f64, |worst, z| worst.max(z.abs()));
    assert!(worst < 6.5, "{what}: worst z {worst}");
}

#[test]
fn strategies_and_samplers_agree_with_adding() {
    // Lobes wide enough for uniform directions to have a normally distributed mean of this many paths.
    let displays = [
        display(0.3, 0.0, coloured()),
        display(0.3, 0.25, coloured()),
        display(0.3, 0.0, lambertian(0.8)),
        display(0.3, 0.25, lambertian(0.8)),
    ];
    let sources = near();
    let samplers = [Sampler::Sobol, Sampler::Random, Sampler::Stratified, Sampler::BestCandidate];
    for strategy in Strategy::ALL {
        let (mut all, mut runs) = (Vec::new(), 0);
        for (k, panel) in displays.iter().enumerate() {
            let stack = panel.stack();
            let truth = adding(&stack, &sources);
            for (l, sampler) in everyday(2, samplers).enumerate() {
                let paths = if strategy == Strategy::Guided { 256 } else { sized(1024, 4096) };
                let seed = (4 * k + l) as u64;
                all.extend(scores(&estimates(&stack, &sources, strategy, (sampler, seed), paths), &truth));
                runs += 1;
            }
        }
        assert_scattered(&format!("{strategy:?}"), &all, f64::from(runs));
    }
}

/// Over a mirror, successive lobes are one: pass k has width 2 k b, except for losses beyond the horizon
/// (below 1e-3 here); with a regular fraction some of them are missing.
fn in_closed_form(width: f64, straight: f64, view: Beta, lamp: Beta) -> f64 {
    let (t, r, mirror, diffuser): (f64, f64, f64, f64) = (0.91, 0.08, 0.8, 0.95);
    let pass = |k: i32| {
        let mut ways = straight.powi(2 * k);
        let mut seen = 0.0;
        for scattered in 1..=2 * k {
            ways *= f64::from(2 * k - scattered + 1) / f64::from(scattered) * (1.0 - straight);
            ways = if straight > 0.0 { ways / straight } else { f64::from(u8::from(scattered == 2 * k)) };
            seen += ways * Lobe::KCorrelation { width: f64::from(scattered) * width }.density(view, lamp);
        }
        (diffuser * diffuser * mirror).powi(k) * r.powi(k - 1) * seen
    };
    t * t * std::f64::consts::PI * (1..20).map(pass).sum::<f64>()
}

/// Faint light of sources far from the mirror direction of a narrow lobe, which is scattered once, in any of
/// its passes through the diffuser, and otherwise passes unscattered.
#[test]
fn narrow_lobes_with_small_sources_equal_closed_form() {
    for strategy in [Strategy::Kernel, Strategy::Guided] {
        let mut all = Vec::new();
        // Half of them have all widths and all radii, too.
        for seed in (0..24_u32).filter(|seed| sized(seed % 4 < 2, true)) {
            let width = [0.004, 0.007, 0.011][seed as usize % 3];
            let straight = if seed.is_multiple_of(2) { 0.0 } else { 0.3 };
            let stack =
                display(width, straight, Base { inactive_absorptance: one(0.0), ..mirror(0.8) }).stack();
            let turn = 15.0 * f64::from(seed);
            let radius = [0.1, 0.25, 0.7, 2.0][seed as usize / 6];
            let disc = Cone::new(40.0, turn, radius, 1.0);
            let beam = Beta::from_source(50.0, turn, 1.0);
            let sources = [Source::Beam(beam), Source::Disc(disc)];
            let paths = if strategy == Strategy::Guided { sized(256, 512) } else { sized(2048, 4096) };
            let found =
                estimates(&stack, &sources, strategy, (Sampler::Random, 100 + u64::from(seed)), paths);
            let at = |lamp| in_closed_form(width, straight, view().axis_towards(), lamp);
            let numbers = SampleStream::new(Sampler::Sobol, 0, 0);
            let point = |k| at(-disc.sample_towards([numbers.block(k, 0)[0], numbers.block(k, 0)[1]]));
            let truth = [at(beam), (0..1024).map(point).sum::<f64>() / 1024.0];
            for (source, truth) in truth.into_iter().enumerate() {
                let (mean, error) = common::mean_and_error(found.iter().map(|e| rho(e, source)));
                assert!(error < 0.02 * truth, "{strategy:?} {seed} {source}: {error} of {truth}");
                all.push((mean - truth) / error.hypot(1e-3 * truth));
            }
        }
        assert_scattered(&format!("{strategy:?}"), &all, 0.5 * all.len() as f64);
    }
}

/// Under a directed source the guide leaves less than a tenth of the kernel's variance, path by path: with
/// random numbers, and (if the front returns little light, which is decided by independent numbers) with
/// Sobol numbers.
#[test]
fn guided_strategy_has_less_variance_than_kernel() {
    let mut weak = display(0.0567, 0.0, coloured());
    weak.front = front(&[(0.002, 0.01)]);
    for (sampler, panel) in [(Sampler::Random, display(0.0567, 0.0, coloured())), (Sampler::Sobol, weak)] {
        let stack = panel.stack();
        let sources = [Source::Beam(Beta::from_source(-20.0, 0.0, 1.0))];
        let variance = |strategy| {
            let seeds = (0..4).map(|seed| estimates(&stack, &sources, strategy, (sampler, seed), 512));
            let one = |all: Vec<Estimate>| common::mean_and_error(all.iter().map(|e| rho(e, 0))).1.powi(2);
            seeds.map(one).sum::<f64>()
        };
        let (guided, kernel) = (variance(Strategy::Guided), variance(Strategy::Kernel));
        // The ratio is known to 18 %, with 124 degrees of freedom each.
        assert!(guided < 0.1 * kernel, "{sampler:?}: {guided} against {kernel}");
    }
}

/// Exponent of the standard error against the number of paths, and its own standard error: each error is
/// known to `1/sqrt(2 * 31)` of itself.
fn slope(stack: &Stack, sources: &[Source], strategy: Strategy, paths: &[u64]) -> (f64, f64) {
    let log_error = |paths: &u64| {
        let all = estimates(stack, sources, strategy, (Sampler::Sobol, 3), *paths);
        common::mean_and_error(all.iter().map(|e| rho(e, 0))).1.ln()
    };
    let logs: Vec<(f64, f64)> = paths.iter().map(|n| ((*n as f64).ln(), log_error(n))).collect();
    let n = logs.len() as f64;
    let (x, y) = (logs.iter().map(|p| p.0).sum::<f64>() / n, logs.iter().map(|p| p.1).sum::<f64>() / n);
    let xx: f64 = logs.iter().map(|p| (p.0 - x).powi(2)).sum();
    let xy: f64 = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    (-xy / xx, 1.0 / (62.0 * xx).sqrt())
}

/// On smooth scenes the error decreases faster than `1/sqrt(paths)`, by more than three standard errors of
/// the exponent, also beyond 2^16 points of a sequence. (Smooth: little of the lobe is cut off at the edge
/// of the glass's directions, which is a jump for the kernel.)
#[test]
fn sobol_error_decreases_faster_than_square_root() {
    let mut smooth = display(0.05, 0.0, coloured());
    smooth.front = front(&[(0.0, 0.01)]);
    let stack = smooth.stack();
    let beam = Source::Beam(Beta::from_source(-20.0, 0.0, 1.0));
    let cases = [
        ("diffuse", Source::Diffuse, Strategy::Kernel, vec![64, 256, 1024, 4096, 16_384]),
        ("beam", beam.clone(), Strategy::Kernel, vec![64, 256, 1024, 4096, 16_384]),
        ("beam, guided", beam, Strategy::Guided, vec![16, 64, 256, 1024]),
        ("diffuse, long", Source::Diffuse, Strategy::Kernel, vec![1 << 16, 1 << 17, 1 << 18]),
    ];
    for (what, source, strategy, paths) in everyday(3, cases) {
        let (power, error) = slope(&stack, &[source], strategy, &paths);
        println!("{what}: error ~ paths^-{power:.2} +- {error:.2}");
        assert!(power - 3.0 * error > 0.5, "{what}: {power} +- {error}");
    }
}
