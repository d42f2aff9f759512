//! Accuracy against cost of both solvers, as a figure and a table:
//! `cargo run --release -p papilio-validation --example accuracy -- FILE.svg`.
//!
//! Three displays at one wavelength, with the reflectance factor of one view each. The reference is the
//! finest level of adding; a published value confirms that of the slab. *adding*: the error of each coarser
//! level, with the time of kernel and estimate. *Monte Carlo*: the root mean square of the error over 32
//! seeds, after 64, 128, ... paths, with the time of the fastest seed.
//!
//! The last panel shows the quadrature rule alone, without a solver: light inside glass that is reflected by
//! its interface with air, integrated with nodes split at |beta| = 1, as in adding, and without the split.

#![allow(clippy::print_stdout, reason = "a program for the terminal")]

use std::error::Error;
use std::time::Instant;

use papilio_display::pixel::scan;
use papilio_display::scene::AngleMedium;
use papilio_figures::{ErrorCurve, ErrorPanel, accuracy};
use papilio_optics::Beta;
use papilio_optics::interface::fresnel_reflectance;
use papilio_optics::lobe::Lobe;
use papilio_sampling::{SampleStream, Sampler};
use papilio_transport::adding::{FINEST, Kernel};
use papilio_transport::walk::Walk;
use papilio_transport::{
    AngularTable, Base, Component, Cone, CosinePanels, Diffuser, Estimate, Interface, Layer, Medium, Nodes,
    Reflector, Scattering, Source, Stack,
};
use papilio_validation::scenario;

const SEEDS: u64 = 32;

/// A display, its viewer and sources, and their fractions of the illuminance.
struct Case {
    name: &'static str,
    stack: Stack,
    view: Cone,
    sources: Vec<Source>,
    shares: Vec<f64>,
    /// Published value and its tolerance, if there is one.
    published: Option<(f64, f64)>,
    /// log2 of the largest number of paths of a seed.
    doublings: u32,
}

impl Case {
    fn reflectance_factor(&self, estimate: &Estimate) -> f64 {
        let rho = estimate.rho.iter().map(|rho| rho.via_pixel[0] + rho.front[0]);
        rho.zip(&self.shares).map(|(rho, share)| rho * share).sum()
    }

    /// Returns the value of a level of adding, its number of nodes, and its time in seconds (the smallest of
    /// nine).
    fn level(&self, level: u32) -> (f64, f64, f64) {
        let once = || {
            let start = Instant::now();
            let mut kernel = Kernel::new(level);
            kernel.prepare(&self.stack, &[self.view], &self.sources);
            let value = self.reflectance_factor(&kernel.estimate(&self.stack, 0));
            (value, kernel.nodes() as f64, start.elapsed().as_secs_f64())
        };
        let least = |a: (f64, f64, f64), b: (f64, f64, f64)| if b.2 < a.2 { b } else { a };
        (0..8).fold(once(), |best, _| least(best, once()))
    }

    /// Returns the time of the fastest seed in seconds and the relative error after 64, 128, ... paths.
    fn monte_carlo(&self, sampler: Sampler, truth: f64) -> Vec<(f64, f64)> {
        let steps = 6..=self.doublings;
        let walk = Walk::new(&self.stack, self.view, &self.sources);
        let mut sums = vec![(f64::INFINITY, 0.0); steps.clone().count()];
        for seed in 0..SEEDS {
            let (mut replicate, mut seconds) = (walk.replicate(), 0.0);
            let numbers = SampleStream::new(sampler, seed, 0);
            for (power, sum) in steps.clone().zip(&mut sums) {
                let start = Instant::now();
                let more = (1 << power) - replicate.paths();
                walk.trace(&mut replicate, &numbers, more);
                seconds += start.elapsed().as_secs_f64();
                sum.0 = f64::min(sum.0, seconds);
                sum.1 += (self.reflectance_factor(&walk.estimate(&replicate)) / truth - 1.0).powi(2);
            }
        }
        let n = SEEDS as f64;
        sums.into_iter().map(|(seconds, square)| (seconds, (square / n).sqrt())).collect()
    }
}

fn one(value: f64) -> Vec<f64> {
    vec![value]
}

/// Returns the panel of the indoor scenario at 550 nm in its white state.
fn panel() -> Result<Case, Box<dyn Error>> {
    let mut scene = scenario("indoor", &["spectrum.range_nm=[545, 555]", "spectrum.step_nm=5"])?.scene;
    scene.solver.angle_medium = AngleMedium::Glass;
    // This table is the pixel of the display, so that its interpolation is not an error here.
    let panels = CosinePanels::new(&[3; 8]);
    let angles: Vec<f64> = panels.nodes().map(|cosine| cosine.acos().to_degrees()).collect();
    let pixel = scan(&scene, &angles)?;
    let white = pixel.states.iter().find(|(name, _)| name == "white").ok_or("no white state")?;
    let basis = white.1.chunks(3).map(|bins| bins[1]).collect();
    let table =
        AngularTable { nodes: Nodes::CosinePanels(panels), basis, mixture: one(1.0), common: one(0.0) };
    let front = Component { reflectance: one(0.005).into(), absorptance: one(0.01).into() };
    let layers = vec![
        Layer::new(Interface::Component(front), Medium::new(one(1.0).into())),
        Layer::new(Interface::Diffuser(lobe(0.05667, 0.953)), Medium::new(one(1.5).into())),
    ];
    let base = Base { reflector: Reflector::Specular(table), inactive_absorptance: one(0.0).into() };
    Ok(Case {
        name: "panel",
        stack: Stack::new(layers, base),
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
        regular_fraction: 0.0,
    }
}

fn slab(optical_thickness: f64, anisotropy: f64, index: f64) -> Medium {
    Medium::new(one(index).into()).with_scattering(Scattering::unpolarised(
        optical_thickness,
        anisotropy,
        one(1.0).into(),
    ))
}

fn over_mirror<const N: usize>(layers: [(Interface, Medium); N], reflectance: f64) -> Stack {
    let layers = layers.into_iter().map(|(interface, medium)| Layer::new(interface, medium)).collect();
    let table = AngularTable {
        nodes: Nodes::Constant,
        basis: one(reflectance).into(),
        mixture: one(1.0),
        common: one(0.0),
    };
    let base = Base { reflector: Reflector::Specular(table), inactive_absorptance: one(0.0).into() };
    Stack::general(layers, base)
}

/// Returns a slab with total internal reflection over a mirror: R(0) of the table of layers.
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

/// Returns a slab under an interface, with a lobe between slab and glass: both scatter, and both media have
/// total internal reflection.
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

/// Returns the reflectance of a bare interface for isotropic light in glass of index 1.5, by the
/// Gauss-Legendre rule in angles t with beta^2 = a^2 + (b^2 - a^2) sin^2(t) between a and b.
fn internal_reflectance(edges: &[f64], points: usize) -> f64 {
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

/// Returns the nodes and weights of the Gauss-Legendre rule on (-1, 1).
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

/// Returns the error of the rule, with and without nodes split at |beta| = 1.
fn rule_errors(group: usize) -> Vec<ErrorCurve> {
    let truth = internal_reflectance(&[0.0, 1.0, 1.5], 60);
    let curve = |name: &str, dashed, edges: &[f64]| {
        let parts = edges.len() - 1;
        let point = |n: usize| (n as f64, (internal_reflectance(edges, n / parts) / truth - 1.0).abs());
        ErrorCurve { name: name.to_owned(), group, dashed, points: (1..=10).map(|k| point(4 * k)).collect() }
    };
    vec![curve("split", false, &[0.0, 1.0, 1.5]), curve("not split", true, &[0.0, 1.5])]
}

/// Returns the curves of a case: adding against seconds and against nodes (over those of the coarsest level),
/// Monte Carlo against seconds.
fn curves(group: usize, case: &Case) -> Result<[ErrorCurve; 3], Box<dyn Error>> {
    let (truth, ..) = case.level(FINEST);
    println!("{}: {truth:.12}", case.name);
    if let Some((published, tolerance)) = case.published
        && (truth - published).abs() > tolerance
    {
        return Err(format!("{}: the published value is {published}", case.name).into());
    }
    let (mut by_seconds, mut by_nodes, mut coarsest) = (Vec::new(), Vec::new(), None);
    for level in 0..FINEST {
        let (value, nodes, seconds) = case.level(level);
        let error = value / truth - 1.0;
        println!("  adding level {level}: {nodes:5} nodes {seconds:9.2e} s, error {error:+8.1e}");
        by_seconds.push((seconds, error.abs()));
        by_nodes.push((nodes / *coarsest.get_or_insert(nodes), error.abs()));
    }
    let monte_carlo = case.monte_carlo(Sampler::Random, truth);
    monte_carlo
        .iter()
        .for_each(|(seconds, error)| println!("  Monte Carlo: {seconds:9.2e} s, error {error:8.1e}"));
    let curve = |name, dashed, points| ErrorCurve { name, group, dashed, points };
    Ok([
        curve(format!("{}, adding", case.name), false, by_seconds),
        curve(format!("{}, MC", case.name), true, monte_carlo),
        curve(case.name.to_owned(), false, by_nodes),
    ])
}

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).ok_or("usage: accuracy FILE.svg")?;
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
        panel("Nodes of adding, relative to the coarsest level", false, against_nodes),
        panel("Nodes for a bare interface, split at |\u{3b2}| = 1 or not", false, rule_errors(cases.len())),
    ];
    std::fs::write(file, accuracy(&panels, "Accuracy against cost (MC: Monte Carlo)"))?;
    Ok(())
}
