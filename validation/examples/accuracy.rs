//! Accuracy against cost of both solvers, as a figure and a table:
//! `cargo run --release -p papilio-validation --example accuracy -- FILE.svg`.
//!
//! Three displays at one wavelength, each with the reflectance factor that one viewer sees. The
//! truth is adding's finest level; for the slab the published value confirms it. *adding*: each
//! coarser level against it, with the time that kernel and estimate take. *walk*: the root mean
//! square over 32 seeds of the error, after 64, 128, ... paths, and the time of the quickest seed.
//!
//! The last panel is no solver's but the rule's alone: light inside glass that its face
//! sends back, integrated with nodes split at |beta| = 1, as adding's are, and not split.

#![allow(clippy::print_stdout, reason = "a program for the terminal")]

use std::error::Error;
use std::time::Instant;

use papilio_display::pixel::scan;
use papilio_display::scene::AngleMedium;
use papilio_figures::{ErrorCurve, ErrorPanel, accuracy};
use papilio_optics::Beta;
use papilio_optics::interface::fresnel_reflectance;
use papilio_optics::lobe::Lobe;
use papilio_sampling::{Numbers, Sampler};
use papilio_transport::adding::{FINEST, Kernel};
use papilio_transport::walk::Walk;
use papilio_transport::{
    AngularTable, Base, Cone, CosinePanels, Diffuser, Estimate, Front, Interface, Layer, Layered, Medium,
    Nodes, Panel, Reflector, Scattering, Source, Stack, Top,
};
use papilio_validation::scenario;

const SEEDS: u64 = 32;

/// A display, its viewer and lights, and their shares of the illuminance.
struct Case {
    name: &'static str,
    stack: Stack,
    view: Cone,
    sources: Vec<Source>,
    shares: Vec<f64>,
    /// Where one is known, a value found elsewhere and how far off it may be.
    published: Option<(f64, f64)>,
    /// log2 of the paths that each seed takes at most.
    doublings: u32,
}

impl Case {
    fn seen(&self, estimate: &Estimate) -> f64 {
        let rho = estimate.rho.iter().map(|rho| rho.via_pixel[0] + rho.front[0]);
        rho.zip(&self.shares).map(|(rho, share)| rho * share).sum()
    }

    /// What the level gives, its nodes and seconds (the least of nine).
    fn level(&self, level: u32) -> (f64, f64, f64) {
        let once = || {
            let start = Instant::now();
            let mut kernel = Kernel::new(level);
            kernel.prepare(&self.stack, &[self.view], &self.sources);
            let seen = self.seen(&kernel.estimate(&self.stack, 0));
            (seen, kernel.nodes() as f64, start.elapsed().as_secs_f64())
        };
        let least = |a: (f64, f64, f64), b: (f64, f64, f64)| if b.2 < a.2 { b } else { a };
        (0..8).fold(once(), |best, _| least(best, once()))
    }

    /// Seconds of the quickest seed and relative error after 64, 128, ... paths.
    fn walked(&self, sampler: Sampler, truth: f64) -> Vec<(f64, f64)> {
        let steps = 6..=self.doublings;
        let walk = Walk::new(&self.stack, self.view, &self.sources);
        let mut sums = vec![(f64::INFINITY, 0.0); steps.clone().count()];
        for seed in 0..SEEDS {
            let (mut replicate, mut seconds) = (walk.replicate(), 0.0);
            let numbers = Numbers::new(sampler, seed, 0);
            for (power, sum) in steps.clone().zip(&mut sums) {
                let start = Instant::now();
                let more = (1 << power) - replicate.paths();
                walk.trace(&mut replicate, &numbers, more);
                seconds += start.elapsed().as_secs_f64();
                sum.0 = f64::min(sum.0, seconds);
                sum.1 += (self.seen(&walk.estimate(&replicate)) / truth - 1.0).powi(2);
            }
        }
        let n = SEEDS as f64;
        sums.into_iter().map(|(seconds, square)| (seconds, (square / n).sqrt())).collect()
    }
}

fn one(value: f64) -> Vec<f64> {
    vec![value]
}

/// The indoor scenario's panel at 550 nm in white: its lobe, its front, its film, its light.
fn panel() -> Result<Case, Box<dyn Error>> {
    let mut scene = scenario("indoor", &["spectrum.range_nm=[545, 555]", "spectrum.step_nm=5"])?.scene;
    scene.solver.angle_medium = AngleMedium::Glass;
    // The display has this table for its pixel: what lies between the nodes is no error here.
    let panels = CosinePanels::new(&[3; 8]);
    let angles: Vec<f64> = panels.nodes().map(|cosine| cosine.acos().to_degrees()).collect();
    let pixel = scan(&scene, &angles)?;
    let white = pixel.states.iter().find(|(name, _)| name == "white").ok_or("no white state")?;
    let basis = white.1.chunks(3).map(|bins| bins[1]).collect();
    let table =
        AngularTable { nodes: Nodes::CosinePanels(panels), basis, mixture: one(1.0), common: one(0.0) };
    Ok(Case {
        name: "panel",
        stack: Stack::Panel(Panel {
            front: Front::exact(1, [(&[0.005][..], &[0.01][..])]),
            top: Top::Diffuser(lobe(0.05667, 0.953)),
            medium: Medium::new(one(1.5).into()),
            base: Base { reflector: Reflector::Specular(table), inactive_absorptance: one(0.0).into() },
            single_pass: false,
        }),
        view: Cone::new(8.0, 0.0, 0.05, 1.0),
        sources: vec![Source::Diffuse, Source::Beam(Beta::from_source(-20.0, 0.0, 1.0))],
        shares: vec![0.5, 0.5],
        published: None,
        doublings: 18,
    })
}

fn lobe(width: f64, transmittance: f64) -> Diffuser {
    Diffuser {
        lobe: Lobe::KCorrelation { width },
        transmittance: one(transmittance).into(),
        straight_through: 0.0,
    }
}

fn slab(optical_thickness: f64, anisotropy: f64, index: f64) -> Medium {
    Medium::new(one(index).into()).with_scattering(Scattering {
        optical_thickness,
        anisotropy,
        albedo: one(1.0).into(),
    })
}

fn over_mirror<const N: usize>(layers: [(Interface, Medium); N], reflectance: f64) -> Stack {
    let layers = layers.into_iter().map(|(interface, medium)| Layer { interface, medium }).collect();
    let table = AngularTable {
        nodes: Nodes::Constant,
        basis: one(reflectance).into(),
        mixture: one(1.0),
        common: one(0.0),
    };
    let base = Base { reflector: Reflector::Specular(table), inactive_absorptance: one(0.0).into() };
    Stack::Layered(Layered { layers, base })
}

/// A slab that traps light, over a mirror: R(0) of the table of layers.
fn one_slab() -> Case {
    Case {
        name: "slab",
        stack: over_mirror([(Interface::Fresnel, slab(1.0, 0.9, 1.5))], 0.5),
        view: Cone::new(0.0, 0.0, 0.0, 1.0),
        sources: vec![Source::Diffuse],
        shares: vec![1.0],
        published: Some((0.439692, 2e-6)),
        doublings: 16,
    }
}

/// Particles under a face, a lobe between them and the glass: both scatter, both trap.
fn layers() -> Case {
    let list = [
        (Interface::Fresnel, slab(0.5, 0.5, 1.6)),
        (Interface::Diffuser(lobe(0.2, 1.0)), Medium::new(one(1.5).into())),
    ];
    Case {
        name: "layers",
        stack: over_mirror(list, 0.6),
        view: Cone::new(20.0, 0.0, 0.0, 1.0),
        sources: vec![Source::Diffuse, Source::Beam(Beta::from_source(-30.0, 40.0, 1.0))],
        shares: vec![0.5, 0.5],
        published: None,
        doublings: 16,
    }
}

/// The share of even light in glass of index 1.5 that a bare face sends back, by Gauss and
/// Legendre's rule in angles t of beta^2 = a^2 + (b^2 - a^2) sin^2(t) between a and b.
fn sent_back(edges: &[f64], points: usize) -> f64 {
    let between = |a: f64, b: f64| -> f64 {
        let node = |(x, weight): (f64, f64)| {
            let turn = std::f64::consts::FRAC_PI_4 * (1.0 + x);
            let squared = a * a + (b * b - a * a) * turn.sin().powi(2);
            let area = (b * b - a * a) * (2.0 * turn).sin() * std::f64::consts::FRAC_PI_4 * weight;
            area * fresnel_reflectance(1.5, 1.0, squared.sqrt())
        };
        legendre(points).into_iter().map(node).sum()
    };
    edges.windows(2).map(|pair| between(pair[0], pair[1])).sum::<f64>() / 2.25
}

/// Nodes and weights on (-1, 1).
fn legendre(points: usize) -> Vec<(f64, f64)> {
    let n = points as f64;
    let node = |i: usize| {
        let (mut x, mut slope) = ((std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).cos(), 1.0);
        for _ in 0..8 {
            let (mut before, mut value) = (1.0, x);
            for k in 2..=points {
                let k = k as f64;
                (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
            }
            slope = n * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..points).map(node).collect()
}

/// The rule's error, with nodes split at |beta| = 1 and not.
fn faces(group: usize) -> Vec<ErrorCurve> {
    let truth = sent_back(&[0.0, 1.0, 1.5], 60);
    let curve = |name: &str, dashed, edges: &[f64]| {
        let parts = edges.len() - 1;
        let point = |n: usize| (n as f64, (sent_back(edges, n / parts) / truth - 1.0).abs());
        ErrorCurve { name: name.to_owned(), group, dashed, points: (1..=10).map(|k| point(4 * k)).collect() }
    };
    vec![curve("split", false, &[0.0, 1.0, 1.5]), curve("not split", true, &[0.0, 1.5])]
}

/// A case's curves: adding against seconds and against nodes (of the coarsest level's), the walk against seconds.
fn curves(group: usize, case: &Case) -> Result<[ErrorCurve; 3], Box<dyn Error>> {
    let (truth, ..) = case.level(FINEST);
    println!("{}: {truth:.12}", case.name);
    if let Some((published, tolerance)) = case.published
        && (truth - published).abs() > tolerance
    {
        return Err(format!("{}: {published} is published", case.name).into());
    }
    let (mut by_seconds, mut by_nodes, mut coarsest) = (Vec::new(), Vec::new(), None);
    for level in 0..FINEST {
        let (seen, nodes, seconds) = case.level(level);
        let error = seen / truth - 1.0;
        println!("  adding level {level}: {nodes:5} nodes {seconds:9.2e} s, error {error:+8.1e}");
        by_seconds.push((seconds, error.abs()));
        by_nodes.push((nodes / *coarsest.get_or_insert(nodes), error.abs()));
    }
    let walked = case.walked(Sampler::Random, truth);
    walked.iter().for_each(|(seconds, error)| println!("  walk: {seconds:9.2e} s, error {error:8.1e}"));
    let curve = |name, dashed, points| ErrorCurve { name, group, dashed, points };
    Ok([
        curve(format!("{}, adding", case.name), false, by_seconds),
        curve(format!("{}, walk", case.name), true, walked),
        curve(case.name.to_owned(), false, by_nodes),
    ])
}

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).ok_or("which file shall the figure be written to?")?;
    let cases = [panel()?, one_slab(), layers()];
    let (mut against_seconds, mut against_nodes) = (Vec::new(), Vec::new());
    for (group, case) in cases.iter().enumerate() {
        let [adding, walk, nodes] = curves(group, case)?;
        against_seconds.extend([adding, walk]);
        against_nodes.push(nodes);
    }
    let panel = |x: &str, powers, curves| ErrorPanel { x: x.to_owned(), powers, curves };
    let panels = [
        panel("Seconds on one core", true, against_seconds),
        panel("Nodes of adding, of the coarsest level's", false, against_nodes),
        panel("Nodes over a bare face, split at |\u{3b2}| = 1 or not", false, faces(cases.len())),
    ];
    std::fs::write(file, accuracy(&panels, "Accuracy against cost"))?;
    Ok(())
}
