//! Mirrors that depend on azimuth below scatterers, by the Monte Carlo solver: against integrals over directions, the reference tracer, and limits.

use std::f64::consts::{PI, TAU};

use papilio_optics::lobe::{KCorrelation, Lobe};
use papilio_optics::{Beta, Scatterer};
use papilio_sampling::{SampleStream, Sampler};
use papilio_transport::adding::Kernel;
use papilio_transport::walk::Plain;
use papilio_transport::{
    AngularTable, Base, Cone, CosinePanels, Estimate, Interface, Layer, LobeReflection, Nodes, ReflectedLobe,
    ReflectingDiffuser, Reflector, Source, Stack,
};

use crate::common::{REPLICATES, assert_unbiased, mean_and_error, one, replicates_of, sized};
use crate::layers::{beam, clear, diffuser, sheet, slab};

const INDEX: f64 = 1.5;

/// `even + 0.1 s^2 + cos s^2 cos 2 phi + sin s^2 sin 2 phi`, with the sine s of the inclination in the glass.
#[derive(Clone, Copy)]
struct Shape {
    even: f64,
    cos: f64,
    sin: f64,
}

const SHAPE: Shape = Shape { even: 0.45, cos: 0.35, sin: 0.25 };

impl Shape {
    fn at(self, Beta { x, y }: Beta) -> f64 {
        let (x, y) = (x / INDEX, y / INDEX);
        self.even + 0.1 * (x * x + y * y) + self.cos * (x * x - y * y) + 2.0 * self.sin * x * y
    }

    fn base(self) -> Base {
        let panels = CosinePanels::new(&[1, 1]);
        let of = |cosine: f64| {
            let s = 1.0 - cosine * cosine;
            [self.even + 0.1 * s, self.cos * s, self.sin * s]
        };
        let basis: Vec<f64> = panels.nodes().flat_map(of).collect();
        let table = AngularTable {
            nodes: Nodes::Azimuthal(Box::new(Nodes::CosinePanels(panels)), 3),
            basis: basis.into(),
            mixture: vec![1.0, 0.0, 0.0],
            common: vec![0.0],
        };
        Base { reflector: Reflector::Specular(table), inactive_absorptance: one(0.0) }
    }
}

fn over(layers: Vec<(Interface, f64)>, base: Base) -> Stack {
    Stack::new(layers.into_iter().map(|(interface, n)| Layer::new(interface, clear(n))).collect(), base)
}

const WIDTH: f64 = 0.12;
const TRANSMITTANCE: f64 = 0.9;
const REGULAR: f64 = 0.2;

fn from() -> Cone {
    Cone::new(40.0, 25.0, 0.0, 1.0)
}

fn lamp() -> Source {
    beam(30.0, 110.0)
}

/// Integral over the directions of the glass, about the origin.
fn over_directions(of: impl Fn(Beta) -> f64) -> f64 {
    let (rings, turns) = (600, 480);
    let ring = |i: usize| {
        let r = INDEX * (i as f64 + 0.5) / rings as f64;
        let point = |j: usize| {
            let (sin, cos) = (TAU * j as f64 / turns as f64).sin_cos();
            of(Beta { x: r * cos, y: r * sin })
        };
        r * (0..turns).map(point).sum::<f64>()
    };
    (0..rings).map(ring).sum::<f64>() * INDEX / rings as f64 * TAU / turns as f64
}

/// Diffuse light and a beam through a diffuser onto a mirror and out again, with its regular part: integrals over all directions between, without any
/// path; by both solvers.
#[test]
fn haze_film_over_azimuthal_mirror_is_an_integral_over_directions() {
    let stack = over(vec![(diffuser(WIDTH, TRANSMITTANCE, REGULAR), INDEX)], SHAPE.base());
    assert!(stack.panel().is_none());
    let (lobe, kernel) = (Lobe::KCorrelation { width: WIDTH }, KCorrelation { width: WIDTH });
    let (view, source) = (from().axis_towards(), lamp().direction().unwrap());
    let towards = |to: Beta| move |at: Beta| kernel.evaluate(to, at);
    let leaves = |at: Beta| {
        REGULAR * f64::from(at.length() < 1.0) + (1.0 - REGULAR) * lobe.fraction_in_disc(at.length(), 1.0)
    };
    let scattered = 1.0 - REGULAR;
    let diffuse = scattered * over_directions(|at| towards(view)(at) * SHAPE.at(at) * leaves(at))
        + REGULAR * SHAPE.at(view) * leaves(view);
    let twice =
        over_directions(|at| towards(view)(at) * SHAPE.at(at) * towards(source)(at)) * scattered * scattered;
    let once = scattered * REGULAR * towards(view)(source) * (SHAPE.at(view) + SHAPE.at(source));
    let truth = [diffuse, PI * (twice + once)].map(|x| TRANSMITTANCE * TRANSMITTANCE * x);
    // The mean over azimuth is another number.
    let mean = Shape { cos: 0.0, sin: 0.0, ..SHAPE };
    assert!((mean.at(view) - SHAPE.at(view)).abs() > 0.03);
    let sources = [Source::Diffuse, lamp()];
    let mut adding = Kernel::new(2);
    adding.prepare(&stack, &[from()], &sources);
    let adding = adding.estimate(&stack, 0);
    for (k, truth) in truth.into_iter().enumerate() {
        let found = adding.rho[k].via_pixel[0];
        // The sum over directions has steps of 0.003.
        assert!((found - truth).abs() < 2e-4 * truth, "adding {k}: {found} {truth}");
        assert_unbiased(&format!("source {k}"), truth, 0.02, |seed| {
            let all = replicates_of(&stack, from(), &sources, seed, sized(256, 1024), Sampler::Sobol);
            mean_and_error(all.iter().map(|e: &Estimate| e.rho[k].via_pixel[0]))
        });
    }
}

/// A round mirror, given by harmonics of 0: adding by direction against adding by azimuthal order, with reflections from both sides, fields of view,
/// discs, rings of light and balances.
#[test]
fn adding_by_direction_is_adding_by_order_over_round_mirrors() {
    let round = Shape { cos: 0.0, sin: 0.0, ..SHAPE };
    let azimuthal = round.base();
    let Reflector::Specular(table) = &azimuthal.reflector else { unreachable!() };
    let nodes = table.nodes.of_inclination().clone();
    let basis: Vec<f64> = table.basis.iter().step_by(3).copied().collect();
    let plain = AngularTable { nodes, basis: basis.into(), mixture: vec![1.0], common: vec![0.0] };
    let plain = Base { reflector: Reflector::Specular(plain), ..azimuthal.clone() };
    let lobe = |width: f64| ReflectedLobe::Lobe(Lobe::KCorrelation { width });
    let side = |lobe: ReflectedLobe, r: f64| Some(LobeReflection::new(lobe, &one(r), 0.0));
    let films = [
        diffuser(0.2, 0.95, 0.0),
        diffuser(0.2, 0.9, 0.3),
        Interface::Reflecting(Box::new(ReflectingDiffuser::new(
            diffuser(0.25, 0.7, 0.2),
            [side(lobe(0.15), 0.1), side(lobe(0.2), 0.25)],
        ))),
        Interface::Reflecting(Box::new(ReflectingDiffuser::new(
            diffuser(0.3, 0.7, 0.0),
            [None, side(ReflectedLobe::Lobe(Lobe::Lambertian), 0.3)],
        ))),
    ];
    let sources = [Source::Diffuse, lamp(), Source::Disc(Cone::new(35.0, 60.0, 8.0, 1.0))];
    let views = [from(), Cone::new(20.0, 110.0, 6.0, 1.0)];
    for (number, film) in films.into_iter().enumerate() {
        let layers = vec![Layer::new(film, clear(INDEX))];
        let of = |base: &Base, level: u32| {
            let stack = Stack::general(layers.clone(), base.clone());
            let mut kernel = Kernel::new(level);
            kernel.prepare(&stack, &views, &sources);
            [0, 1].map(|view| kernel.estimate(&stack, view))
        };
        for (view, (a, b)) in of(&azimuthal, 2).iter().zip(&of(&plain, 3)).enumerate() {
            let near = |what: &str, a: f64, b: f64| {
                assert!((a - b).abs() < 2e-5 + 1e-4 * b.abs(), "{number} {view} {what}: {a} {b}");
            };
            for (a, b) in a.rho.iter().zip(&b.rho) {
                near("via pixel", a.via_pixel[0], b.via_pixel[0]);
                near("front", a.front[0], b.front[0]);
            }
            near("returned", a.ledger.returned[0], b.ledger.returned[0]);
            near("pixel", a.ledger.pixel[0], b.ledger.pixel[0]);
            near("diffuser", a.ledger.diffuser[0], b.ledger.diffuser[0]);
        }
    }
}

/// All orders between a sheet, a slab of particles, faces and the mirror, against the reference tracer; nothing is lost.
#[test]
fn azimuthal_mirror_below_many_layers_agrees_with_the_reference() {
    let mut layers = vec![
        Layer::new(sheet(0.1, 0.05), clear(1.0)),
        Layer::new(Interface::Fresnel, slab(0.6, 0.7, 0.97, 1.4)),
        Layer::new(Interface::Fresnel, clear(INDEX)),
    ];
    let murky = Stack::general(layers.clone(), SHAPE.base());
    layers[1] = Layer::new(diffuser(0.2, 0.95, 0.1), clear(1.0));
    let hazy = Stack::general(layers, SHAPE.base());
    let sources = [Source::Diffuse, lamp(), Source::Disc(Cone::new(35.0, 60.0, 20.0, 1.0))];
    for (name, stack) in [("murky", murky), ("hazy", hazy)] {
        let plain = Plain::new(&stack, from(), &sources, [0, 0]);
        let reference: Vec<Vec<f64>> = (0..REPLICATES)
            .map(|stream| {
                plain.reflectance_factors(&SampleStream::new(Sampler::Random, 3, stream), sized(2048, 8192))
            })
            .collect();
        let walked = replicates_of(&stack, from(), &sources, 4, sized(256, 1024), Sampler::Sobol);
        for k in 0..sources.len() {
            let (y, error_y) = mean_and_error(reference.iter().map(|rho| rho[k]));
            let total = |e: &Estimate| e.rho[k].via_pixel[0] + e.rho[k].front[0];
            let (x, error_x) = mean_and_error(walked.iter().map(total));
            let error = error_x.hypot(error_y);
            assert!((x - y).abs() < 4.0 * error && error < 0.1 * y, "{name} {k}: {x} {y} +- {error}");
        }
        for estimate in &walked {
            let ledger = &estimate.ledger;
            let books = [
                &ledger.returned,
                &ledger.front,
                &ledger.diffuser,
                &ledger.glass,
                &ledger.pixel,
                &ledger.inactive,
                &ledger.unaccounted,
            ];
            let sum: f64 = books.iter().map(|book| book[0]).sum();
            assert!((sum - 1.0).abs() < 1e-9, "{name}: {sum}");
        }
    }
}

/// A diffuser without haze is a flat sheet; a mirror that is the same at all azimuths is today's, path by path; and lamp and viewer may be exchanged.
#[test]
fn limits_of_azimuthal_mirrors() {
    let clear_film = over(vec![(diffuser(WIDTH, TRANSMITTANCE, 1.0), INDEX)], SHAPE.base());
    let found = replicates_of(&clear_film, from(), &[Source::Diffuse], 1, 4, Sampler::Sobol);
    let flat = TRANSMITTANCE.powi(2) * SHAPE.at(from().axis_towards());
    assert!((found[0].rho[0].via_pixel[0] - flat).abs() < 1e-12);

    let round = Shape { cos: 0.0, sin: 0.0, ..SHAPE };
    let azimuthal = round.base();
    let Reflector::Specular(table) = &azimuthal.reflector else { unreachable!() };
    let nodes = table.nodes.of_inclination().clone();
    let plain =
        Base { reflector: Reflector::Specular(AngularTable { nodes, ..table.clone() }), ..azimuthal.clone() };
    let layers = || vec![Layer::new(diffuser(0.2, 0.95, 0.1), clear(INDEX))];
    let sources = [Source::Diffuse, lamp()];
    let of =
        |base: Base| replicates_of(&Stack::general(layers(), base), from(), &sources, 2, 64, Sampler::Sobol);
    for (one, other) in of(azimuthal.clone()).iter().zip(&of(plain)) {
        for k in 0..2 {
            let [a, b] = [one, other].map(|e| e.rho[k].via_pixel[0]);
            assert!((a - b).abs() < 1e-12 * b, "{a} {b}");
        }
    }

    let stack = over(vec![(diffuser(0.2, 0.95, 0.1), INDEX)], SHAPE.base());
    let seen = |view: Cone, source: Source| {
        let all = replicates_of(&stack, view, &[source], 5, sized(1024, 4096), Sampler::Sobol);
        mean_and_error(all.iter().map(|e| e.rho[0].via_pixel[0]))
    };
    let (there, error) = seen(Cone::new(40.0, 25.0, 0.0, 1.0), beam(30.0, 110.0));
    let (back, other_error) = seen(Cone::new(30.0, 110.0, 0.0, 1.0), beam(40.0, 25.0));
    let error = error.hypot(other_error);
    assert!((there - back).abs() < 4.0 * error && error < 0.01 * there, "{there} {back} +- {error}");
}
