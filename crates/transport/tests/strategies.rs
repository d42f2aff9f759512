//! Every way to draw directions, with numbers of every kind: the same mean as adding, honest errors,
//! and what the guide is worth.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test says what it expects by unwrapping")]

mod common;

use common::{REPLICATES, front, lambertian, mirror, one, panel, rho};
use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;
use papilio_sampling::{Numbers, Sampler};
use papilio_transport::adding::Kernel;
use papilio_transport::walk::{Strategy, Walk};
use papilio_transport::{
    AngularTable, Base, Cone, Diffuser, Estimate, Nodes, Panel, Reflector, Source, Stack, Top,
};

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

fn display(width: f64, straight_through: f64, base: Base) -> Panel {
    let lobe = Lobe::KCorrelation { width };
    let mut stack = panel(Top::Diffuser(Diffuser { lobe, transmittance: one(0.95), straight_through }), base);
    stack.front = front(&[(0.08, 0.01)], false);
    stack
}

fn view() -> Cone {
    Cone::new(8.0, 0.0, 0.05, 1.0)
}

/// Diffuse light, a beam near the mirror direction, a disc beside it.
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
        walk.trace(&mut replicate, &Numbers::new(sampler, seed, stream), paths);
        walk.estimate(&replicate)
    };
    (0..REPLICATES).map(of).collect()
}

fn adding(stack: &Stack, sources: &[Source]) -> Estimate {
    let mut kernel = Kernel::new(2);
    kernel.prepare(stack, &[view()], sources);
    kernel.estimate(stack, 0)
}

/// What is compared.
fn quantities(e: &Estimate) -> Vec<f64> {
    let sources = (0..e.rho.len()).map(|source| rho(e, source));
    let ledger = &e.ledger;
    sources.chain([ledger.returned[0], ledger.pixel[0], ledger.front[0], ledger.diffuser[0]]).collect()
}

/// z-scores of all quantities against adding's.
fn scores(estimates: &[Estimate], truth: &Estimate) -> Vec<f64> {
    let all: Vec<Vec<f64>> = estimates.iter().map(quantities).collect();
    let score = |(k, truth): (usize, &f64)| {
        let (mean, error) = common::mean_and_error(all.iter().map(|one| one[k]));
        // Adding's own error, and the tables'.
        (mean - truth) / error.hypot(3e-7 * (1.0 + truth))
    };
    quantities(truth).iter().enumerate().map(score).collect()
}

/// Scores as Student's t of 31 degrees of freedom: mean 0 and mean square 31/29 at 4.5 sigma of as
/// many independent ones as there are displays (the quantities of one are not), the worst below 6.5.
fn assert_scattered(what: &str, scores: &[f64], independent: f64) {
    let n = scores.len() as f64;
    let (mean, square) = (scores.iter().sum::<f64>() / n, scores.iter().map(|z| z * z).sum::<f64>() / n);
    let worst = scores.iter().fold(0.0_f64, |worst, z| worst.max(z.abs()));
    assert!(mean.abs() < 4.5 * (1.07 / independent).sqrt(), "{what}: mean z {mean}");
    assert!((square - 1.07).abs() < 4.5 * (2.55 / independent).sqrt(), "{what}: mean square of z {square}");
    assert!(worst < 6.5, "{what}: worst z {worst}");
}

#[test]
fn every_strategy_and_sampler_agrees_with_adding() {
    let displays = [
        display(0.12, 0.0, coloured()),
        display(0.12, 0.25, coloured()),
        display(0.2, 0.0, lambertian(0.8)),
        display(0.2, 0.25, lambertian(0.8)),
    ];
    let sources = near();
    for strategy in Strategy::ALL {
        let mut all = Vec::new();
        for (k, panel) in displays.iter().enumerate() {
            let stack = Stack::Panel(panel.clone());
            let truth = adding(&stack, &sources);
            for (l, sampler) in Sampler::ALL.into_iter().enumerate() {
                let paths = if strategy == Strategy::Guided { 256 } else { 2048 };
                let seed = (4 * k + l) as u64;
                all.extend(scores(&estimates(&stack, &sources, strategy, (sampler, seed), paths), &truth));
            }
        }
        assert_scattered(&format!("{strategy:?}"), &all, 16.0);
    }
}

/// Faint light of lamps far from the mirror direction of a narrow lobe: light that turns once, on
/// any of its ways through the diffuser, and then goes straight from lamp to viewer or back.
#[test]
fn narrow_lobes_and_small_lamps() {
    for strategy in [Strategy::Kernel, Strategy::Guided] {
        let mut all = Vec::new();
        for seed in 0..24_u64 {
            let width = [0.004, 0.007, 0.011][seed as usize % 3];
            let straight = if seed % 2 == 0 { 0.0 } else { 0.3 };
            let base = if seed % 4 < 2 { mirror(0.8) } else { coloured() };
            let stack = Stack::Panel(display(width, straight, base));
            let turn = 15.0 * seed as f64;
            let sources = [
                Source::Beam(Beta::from_source(50.0, turn, 1.0)),
                Source::Disc(Cone::new(40.0, turn, [0.1, 0.25, 0.7, 2.0][seed as usize / 6], 1.0)),
            ];
            let truth = adding(&stack, &sources);
            let paths = if strategy == Strategy::Guided { 1024 } else { 8192 };
            let found = estimates(&stack, &sources, strategy, (Sampler::Random, 100 + seed), paths);
            all.extend(&scores(&found, &truth)[..2]);
        }
        assert_scattered(&format!("{strategy:?}"), &all, 24.0);
    }
}

/// Under a lamp the guide leaves less than a tenth of the kernel's variance, path by path, with
/// random numbers and with better ones (measured: 1/100 and less).
#[test]
fn the_guide_beats_the_kernel() {
    let stack = Stack::Panel(display(0.0567, 0.0, coloured()));
    let sources = [Source::Beam(Beta::from_source(-20.0, 0.0, 1.0))];
    for sampler in [Sampler::Random, Sampler::Sobol] {
        let variance = |strategy| {
            let all = estimates(&stack, &sources, strategy, (sampler, 1), 512);
            common::mean_and_error(all.iter().map(|e| rho(e, 0))).1.powi(2)
        };
        let (guided, kernel) = (variance(Strategy::Guided), variance(Strategy::Kernel));
        // Each is known to a factor of (1 +- .25) with 31 degrees of freedom; 3 sigma of the ratio.
        assert!(guided < 0.1 * kernel / 2.5, "{sampler:?}: {guided} against {kernel}");
    }
}
