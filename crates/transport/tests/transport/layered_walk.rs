//! The general tracer, compared with the panel's tracers, published slabs and physical laws.

use std::cell::RefCell;
use std::collections::HashMap;

use crate::common::*;
use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;
use papilio_optics::rough::Rough;
use papilio_sampling::{SampleStream, Sampler};
use papilio_spectra::Spectrum;
use papilio_transport::adding::Kernel;
use papilio_transport::walk::Walk;
use papilio_transport::{
    AngularTable, Base, Component, Cone, Diffuser, Estimate, Interface, Layer, Medium, Nodes, Reflector,
    Scattering, Source, Stack, Top, specular_image,
};

fn layered(layers: Vec<Layer>, base: Base) -> Stack {
    Stack::general(layers, base)
}

fn layer(interface: Interface, medium: Medium) -> Layer {
    Layer::new(interface, medium)
}

fn clear(index: f64) -> Medium {
    Medium::new(one(index))
}

fn slab(index: f64, optical_thickness: f64, anisotropy: f64, albedo: f64) -> Medium {
    clear(index).with_scattering(Scattering::unpolarised(optical_thickness, anisotropy, one(albedo)))
}

/// A slab under air, with a Fresnel interface if the index changes.
fn under_air(medium: Medium) -> Layer {
    let interface = if medium.constant_index() == Some(1.0) { Interface::Open } else { Interface::Fresnel };
    layer(interface, medium)
}

/// Quantities of one family of runs, each compared with its expected value within its own error bars.
struct Runs<'a> {
    stack: &'a Stack,
    from: Cone,
    sources: &'a [Source],
    paths: u64,
    cache: RefCell<HashMap<u64, Vec<Estimate>>>,
}

impl<'a> Runs<'a> {
    fn new(stack: &'a Stack, theta_deg: f64, sources: &'a [Source], paths: u64) -> Self {
        Self { stack, from: view(theta_deg), sources, paths, cache: RefCell::default() }
    }

    /// Mean and standard error over the replicates of a seed.
    fn mean(&self, seed: u64, quantity: impl Fn(&Estimate) -> f64) -> (f64, f64) {
        let mut cache = self.cache.borrow_mut();
        let estimates = cache.entry(seed).or_insert_with(|| {
            replicates_of(self.stack, self.from, self.sources, seed, self.paths, Sampler::Sobol)
        });
        mean_and_error(estimates.iter().map(quantity))
    }

    fn check(&self, what: &str, truth: f64, most_error: f64, quantity: impl Fn(&Estimate) -> f64) {
        assert_unbiased(what, truth, most_error, |seed| self.mean(seed, &quantity));
    }
}

/// Asserts that two families agree on the same quantity.
fn assert_same(what: &str, a: (&Runs<'_>, usize), b: (&Runs<'_>, usize), most_error: f64) {
    assert_unbiased(what, 1.0, most_error, |seed| {
        let (x, error_x) = a.0.mean(2 * seed, |e| rho(e, a.1));
        let (y, error_y) = b.0.mean(2 * seed + 1, |e| rho(e, b.1));
        (x / y, (x / y) * (error_x / x).hypot(error_y / y))
    });
}

fn diffuser(width: f64, transmittance: f64, regular_fraction: f64) -> Diffuser {
    let lobe = Lobe::KCorrelation { width };
    Diffuser { lobe, transmittance: one(transmittance), regular_fraction }
}

fn sheet(reflectance: f64, absorptance: f64) -> Interface {
    Interface::Component(Component { reflectance: one(reflectance), absorptance: one(absorptance) })
}

fn beam(theta_deg: f64) -> Source {
    Source::Beam(Beta::from_source(theta_deg, 0.0, 1.0))
}

/// A panel and the same display as layers, with a front of these components.
fn both_forms(mut panel: Panel, components: &[(f64, f64)]) -> (Stack, Stack) {
    panel.front = front(components);
    let mut layers: Vec<Layer> = components.iter().map(|&(r, a)| layer(sheet(r, a), clear(1.0))).collect();
    let interface = match &panel.top {
        Top::IdealAr => Interface::IdealAr,
        Top::Fresnel(_) => Interface::Fresnel,
        Top::Diffuser(diffuser) => Interface::Diffuser(diffuser.clone()),
    };
    layers.push(layer(interface, panel.medium.clone()));
    let base = panel.base.clone();
    (panel.stack(), layered(layers, base))
}

/// Without scattering nothing is random: image, diffuse light and ledger in closed form.
#[test]
fn flat_layers_equal_closed_forms() {
    let components = [(0.1, 0.02), (0.05, 0.0)];
    for top in [Top::IdealAr, Top::Fresnel(one(1.5))] {
        let (panel, layers) = both_forms(panel(top, mirror(0.5)), &components);
        let beta = Beta::towards(50.0, 20.0, 1.0);
        let (a, b) = (specular_image(&panel, beta), specular_image(&layers, beta));
        assert!((a.front[0] - b.front[0]).abs() < 1e-14 && (a.via_pixel[0] - b.via_pixel[0]).abs() < 1e-14);
        let from = Cone::new(50.0, 20.0, 0.0, 1.0);
        for e in replicates_of(&layers, from, &[Source::Diffuse], 0, 3, Sampler::Sobol) {
            assert!((e.rho[0].front[0] - a.front[0]).abs() < 1e-14);
            assert!((e.rho[0].via_pixel[0] - a.via_pixel[0]).abs() < 1e-14);
            assert!((e.ledger.returned[0] - a.front[0] - a.via_pixel[0]).abs() < 1e-14);
            assert!(e.ledger.unaccounted[0] == 0.0);
        }
    }
    // n = 1.5 over a mirror of 0.5: the published number; and through an absorbing glass.
    let glass = clear(1.5).with_transmittance(one(0.8));
    for (medium, t) in [(clear(1.5), 1.0), (glass, 0.64)] {
        let stack = layered(vec![layer(Interface::Fresnel, medium)], mirror(0.5));
        let e = &replicates_of(&stack, view(0.0), &[Source::Diffuse], 0, 1, Sampler::Sobol)[0];
        let truth = 0.04 + 0.96 * 0.96 * 0.5 * t / (1.0 - 0.04 * 0.5 * t);
        assert!((rho(e, 0) - truth).abs() < 1e-14);
        assert!(t < 1.0 || (truth - 0.510204).abs() < 1e-6);
    }
}

/// Any panel, expressed as layers, has the results of the panel's own tracers.
#[test]
fn panel_as_layers_equals_panel() {
    let sources = [Source::Diffuse, beam(-20.0), Source::Disc(Cone::new(-12.0, 0.0, 5.0, 1.0))];
    let diffuser = |straight| Top::Diffuser(diffuser(0.08, 0.9, straight));
    for (name, panel) in [
        ("Fresnel, Lambertian", panel(Top::Fresnel(one(1.5)), lambertian(0.6))),
        ("coated, Lambertian", panel(Top::IdealAr, lambertian(0.6))),
        ("diffuser, mirror", panel(diffuser(0.0), mirror(0.7))),
        ("diffuser with straight-through light, mirror", panel(diffuser(0.3), mirror(0.7))),
        ("diffuser, Lambertian", panel(diffuser(0.3), lambertian(0.7))),
    ] {
        let (panel, layers) = both_forms(panel, &[(0.2, 0.05), (0.1, 0.02)]);
        let a = Runs::new(&panel, 8.0, &sources, sized(64, 128));
        let b = Runs::new(&layers, 8.0, &sources, sized(64, 128));
        for (source, what) in ["diffuse", "beam", "disc"].into_iter().enumerate() {
            assert_same(&format!("{name}, {what}"), (&a, source), (&b, source), 0.05);
        }
    }
}

/// Slabs over black (converged to 1e-8): the reflected light is that of diffuse light seen from that
/// direction, by reciprocity; the transmitted light is absorbed by the base.
#[test]
fn index_matched_slabs_equal_published_values() {
    for (albedo, tau, g, normal, oblique) in [
        (0.9, 1.0, 0.0, (0.267410, 0.591625), (0.393662, 0.414840)),
        (0.9, 4.0, 0.0, (0.408142, 0.128524), (0.504093, 0.071824)),
        (0.9, 1.0, 0.75, (0.055947, 0.827917), (0.171039, 0.622342)),
        (0.99, 1.0, 0.9, (0.025123, 0.963707), (0.110993, 0.865378)),
        (1.0, 0.5, 0.9, (0.012376, 0.987624), (0.058414, 0.941586)),
        (1.0, 1.0, 0.75, (0.078740, 0.921260), (0.240480, 0.759520)),
        (1.0, 8.0, 0.9, (0.250996, 0.749004), (0.475303, 0.524697)),
        // van de Hulst.
        (0.9, 2.0, 0.75, (0.09739, 0.66096), (f64::NAN, f64::NAN)),
    ] {
        let stack = layered(vec![under_air(slab(1.0, tau, g, albedo))], mirror(0.0));
        for (theta_deg, (reflected, transmitted)) in [(0.0, normal), (60.0, oblique)] {
            if reflected.is_nan() {
                continue;
            }
            let what = format!("slab {albedo} {tau} {g} from {theta_deg}");
            let runs = Runs::new(&stack, theta_deg, &[Source::Diffuse], 64);
            runs.check(&format!("{what}, R"), reflected, 0.3, |e| rho(e, 0));
            runs.check(&format!("{what}, T"), transmitted, 0.1, |e| e.ledger.pixel[0]);
        }
    }
}

/// A conservative slab over a back surface, under a Fresnel interface if n = 1.5, all orders.
#[test]
fn slabs_over_back_surface_equal_published_values() {
    let cases = [
        (1.5, 1.0, mirror(0.5), 0.439692, 0.438485),
        (1.0, 1.0, lambertian(0.5), 0.487380, 0.487701),
        (1.5, 0.5, mirror(0.5), 0.470261, 0.469453),
        (1.0, 1.0, mirror(0.5), 0.503286, 0.503368),
        (1.5, 1.0, mirror(0.02), 0.060391, 0.060386),
        (1.5, 1.0, lambertian(0.5), 0.318526, 0.318567),
    ];
    for (n, tau, base, normal, oblique) in everyday(3, cases) {
        let stack = layered(vec![under_air(slab(n, tau, 0.9, 1.0))], base);
        for (theta_deg, truth) in [(0.0, normal), (8.0, oblique)] {
            let runs = Runs::new(&stack, theta_deg, &[Source::Diffuse], sized(64, 128));
            runs.check(&format!("n {n}, tau {tau}, from {theta_deg}"), truth, 0.05, |e| rho(e, 0));
        }
    }
}

/// Giovanelli's half-space under a Fresnel interface of 1.5: albedo 0.9, isotropic (converged).
#[test]
fn half_space_under_interface_equals_giovanelli() {
    let stack = layered(vec![under_air(slab(1.5, 200.0, 0.0, 0.9))], mirror(0.0));
    let runs = Runs::new(&stack, 0.0, &[Source::Diffuse], 256);
    runs.check("Giovanelli", 0.259919, 0.05, |e| rho(e, 0));
}

/// Rough antiglare glass, adhesive, a diffuser, a slab, an air gap, over a base.
pub(crate) fn everything(loss: f64, base: Base) -> Stack {
    let t = |value: f64| 1.0 - loss * (1.0 - value);
    let absorbing = |medium: Medium, value| medium.with_transmittance(one(t(value)));
    let white = Diffuser { lobe: Lobe::Lambertian, transmittance: one(1.0), regular_fraction: 0.3 };
    let inner = if loss == 0.0 { white } else { diffuser(0.15, 0.9, 0.2) };
    layered(
        vec![
            layer(sheet(0.05, 0.02 * loss), clear(1.0)),
            layer(Interface::Rough(Rough::new(0.3, 1.0, 1.5)), absorbing(clear(1.5), 0.9)),
            layer(Interface::Fresnel, absorbing(slab(1.4, 0.7, 0.6, t(0.9)), 0.8)),
            layer(Interface::IdealAr, clear(1.0)),
            layer(Interface::Diffuser(inner), clear(1.5)),
            layer(Interface::Fresnel, clear(1.0)),
        ],
        base,
    )
}

/// Lossless layers return all light.
#[test]
fn lossless_layers_return_all_light() {
    let rough = |alpha| Interface::Rough(Rough::new(alpha, 1.0, 1.5));
    let cases = [
        ("everything over a mirror", everything(0.0, mirror(1.0)), sized(16, 64)),
        (
            "rough face over white",
            layered(vec![layer(rough(0.6), clear(1.5))], lambertian(1.0)),
            sized(32, 64),
        ),
        ("slab under glass", layered(vec![under_air(slab(1.5, 3.0, 0.8, 1.0))], mirror(1.0)), sized(16, 64)),
        // Some hundred collisions on each path.
        ("thick slab", layered(vec![under_air(slab(1.5, 1e3, 0.0, 1.0))], mirror(1.0)), sized(4, 16)),
        ("rough face over a mirror", layered(vec![layer(rough(0.2), clear(1.5))], mirror(1.0)), 64),
        ("everything over white", everything(0.0, lambertian(1.0)), 64),
    ];
    for (name, stack, paths) in everyday(4, cases) {
        let runs = Runs::new(&stack, 25.0, &[Source::Diffuse], paths);
        // The number of collisions in the thick slab has a long tail, n^(-3/2): of many seeds, few have errors
        // far above the usual 0.025.
        let most_error = if name == "thick slab" { sized(0.1, 0.25) } else { 0.1 };
        runs.check(&format!("furnace, {name}"), 1.0, most_error, |e| rho(e, 0));
    }
}

/// A round source as large as the hemisphere is diffuse light: connections, chance and images together. A
/// small one is a beam.
#[test]
fn small_and_hemispherical_discs_equal_beam_and_diffuse_light() {
    let sky = Source::Disc(Cone::new(0.0, 0.0, 90.0, 1.0));
    let small = Source::Disc(Cone::new(-25.0, 0.0, 0.3, 1.0));
    let sources = [Source::Diffuse, sky, beam(-25.0), small];
    for (name, base) in everyday(1, [("mirror", mirror(0.8)), ("Lambertian", lambertian(0.8))]) {
        let stack = everything(1.0, base);
        let runs = Runs::new(&stack, 10.0, &sources, sized(32, 64));
        assert_same(&format!("sky over a {name}"), (&runs, 1), (&runs, 0), 0.1);
        assert_same(&format!("beam over a {name}"), (&runs, 3), (&runs, 2), 0.1);
    }
}

/// Exchanging viewer and source changes nothing.
#[test]
fn exchanged_view_and_source_give_the_same_value() {
    for (name, base) in everyday(1, [("mirror", mirror(0.8)), ("Lambertian", lambertian(0.8))]) {
        let stack = everything(1.0, base);
        let (there, back) = ([beam(35.0)], [beam(10.0)]);
        let a = Runs::new(&stack, 10.0, &there, sized(64, 128));
        let b = Runs::new(&stack, 35.0, &back, sized(64, 128));
        assert_same(&format!("reciprocity over a {name}"), (&a, 0), (&b, 0), 0.1);
    }
}

/// Two slabs in contact equal one.
#[test]
fn split_slab_equals_whole_slab() {
    let sources = [Source::Diffuse, beam(-30.0)];
    let part = |share: f64| slab(1.5, 2.0 * share, 0.7, 0.95).with_transmittance(one(0.8_f64.powf(share)));
    let whole = layered(vec![under_air(part(1.0))], mirror(0.6));
    let halves = layered(vec![under_air(part(0.3)), layer(Interface::Open, part(0.7))], mirror(0.6));
    let [a, b] = [&whole, &halves].map(|stack| Runs::new(stack, 20.0, &sources, sized(64, 256)));
    for (source, what) in ["diffuse", "beam"].into_iter().enumerate() {
        assert_same(&format!("split slab, {what}"), (&a, source), (&b, source), 0.1);
    }
}

/// The ledger closes on every path, and roulette removes nothing on average.
#[test]
fn ledger_sums_to_one() {
    for (name, base) in [("mirror", mirror(0.8)), ("Lambertian", lambertian(0.8))] {
        let stack = everything(1.0, base);
        let runs = Runs::new(&stack, 30.0, &[Source::Diffuse], sized(32, 128));
        runs.check(&format!("unaccounted, {name}"), 1.0, 0.1, |e| {
            let l = &e.ledger;
            let absorbed = l.front[0] + l.diffuser[0] + l.glass[0] + l.pixel[0] + l.inactive[0];
            assert!((l.returned[0] + absorbed + l.unaccounted[0] - 1.0).abs() < 1e-12, "{name}");
            assert!((l.returned[0] - rho(e, 0)).abs() < 1e-12, "{name}");
            1.0 + l.unaccounted[0]
        });
    }
}

/// A stack with these of three wavelengths, in which all properties depend on wavelength, including the
/// indices of glass. Two states.
pub(crate) fn coloured(bins: &[usize], lambertian: bool) -> Stack {
    let of =
        |values: [f64; 3]| -> Spectrum { bins.iter().map(|&bin| values[bin]).collect::<Vec<_>>().into() };
    let glass = Medium::new(of([1.48, 1.5, 1.55])).with_transmittance(of([0.9, 0.8, 1.0]));
    let scattering = Scattering::unpolarised(0.8, 0.7, of([0.5, 0.9, 1.0]));
    let milk = Medium::new(of([1.4; 3])).with_scattering(scattering).with_transmittance(of([0.7, 1.0, 0.9]));
    let lobe = Lobe::KCorrelation { width: 0.2 };
    let diffuser = Diffuser { lobe, transmittance: of([0.9, 0.7, 0.5]), regular_fraction: 0.2 };
    let sheet = Interface::Component(Component {
        reflectance: of([0.1, 0.3, 0.0]),
        absorptance: of([0.0, 0.1, 0.2]),
    });
    let whole = of([0.8, 0.5, 0.3]);
    let reflector = if lambertian {
        let of_states = whole.iter().copied().chain(whole.iter().map(|r| 0.3 * r)).collect();
        Reflector::lambertian(of_states, bins.len())
    } else {
        let (basis, common) = (whole.to_vec().into(), of([0.0, 0.1, 0.2]).to_vec());
        Reflector::Specular(AngularTable { nodes: Nodes::Constant, basis, mixture: vec![1.0, 0.3], common })
    };
    let layers = vec![
        layer(sheet, Medium::new(of([1.0; 3]))),
        layer(Interface::Fresnel, milk),
        layer(Interface::Fresnel, Medium::new(of([1.0; 3]))),
        layer(Interface::Diffuser(diffuser), glass),
    ];
    layered(layers, Base { reflector, inactive_absorptance: of([0.02, 0.0, 0.05]) })
}

/// Paths that carry many wavelengths and states give the same results as separate paths for each.
#[test]
fn wavelengths_and_states_are_independent() {
    let sources = [Source::Diffuse, beam(-20.0), Source::Disc(Cone::new(-12.0, 0.0, 5.0, 1.0))];
    for lambertian in [false, true] {
        let all = coloured(&[0, 1, 2], lambertian);
        let all = Runs::new(&all, 15.0, &sources, sized(32, 64));
        for bin in everyday(2, [0, 2, 1]) {
            let alone = coloured(&[bin], lambertian);
            let alone = Runs::new(&alone, 15.0, &sources, sized(32, 64));
            for (source, state) in [(0, 0), (0, 1), (1, 0), (1, 1), (2, 1)] {
                let what = format!("bin {bin}, state {state}, source {source}, Lambertian {lambertian}");
                assert_unbiased(&what, 1.0, 0.15, |seed| {
                    let seen = |e: &Estimate, bins: usize, bin: usize| {
                        e.rho[source].via_pixel[state * bins + bin] + e.rho[source].front[bin]
                    };
                    let (x, error_x) = all.mean(2 * seed, |e| seen(e, 3, bin));
                    let (y, error_y) = alone.mean(2 * seed + 1, |e| seen(e, 1, 0));
                    (x / y, (x / y) * (error_x / x).hypot(error_y / y))
                });
            }
        }
    }
}

/// The thinnest and the thickest layers that can be requested: the first orders, and an end in finite time.
#[test]
fn thinnest_and_thickest_slabs_have_known_limits() {
    // Isotropic and thin, seen along the normal: half of tau is scattered back up.
    let breath = layered(vec![under_air(slab(1.0, 1e-6, 0.0, 1.0))], mirror(0.0));
    let runs = Runs::new(&breath, 0.0, &[Source::Diffuse], 64);
    runs.check("a breath", 0.5e-6, 0.1, |e| rho(e, 0));
    // A layer without absorption returns all but one in a million; the rest needs 10^12 events.
    let wall = layered(vec![under_air(slab(1.0, 1e6, 0.0, 1.0))], mirror(0.0));
    let runs = Runs::new(&wall, 0.0, &[Source::Diffuse], 32);
    runs.check("a wall", 1.0 - 1.7e-6, 0.2, |e| rho(e, 0));
    // Near grazing incidence, through a lobe as narrow as a diffraction limit.
    let stack = layered(vec![layer(Interface::Diffuser(diffuser(1e-4, 1.0, 0.0)), clear(1.5))], mirror(1.0));
    let runs = Runs::new(&stack, 89.9, &[Source::Diffuse], 16);
    let sin = 89.9_f64.to_radians().sin();
    runs.check("grazing", Lobe::KCorrelation { width: 2e-4 }.fraction_in_disc(sin, 1.0), 0.05, |e| rho(e, 0));
}

/// Light scattered once in a thin slab is rarely scattered again; the standard errors include this.
#[test]
fn errors_of_thin_slabs_are_honest() {
    for (thickness, albedo) in [(1e-4, 1.0), (1e-2, 0.9)] {
        let medium = slab(1.5, thickness, 0.3, albedo).with_transmittance(one(0.99));
        let stack = layered(vec![under_air(medium)], mirror(0.6));
        let sources = [beam(-30.0)];
        let mut kernel = Kernel::new(3);
        kernel.prepare(&stack, &[view(10.0)], &sources);
        let truth = rho(&kernel.estimate(&stack, 0), 0);
        let runs = Runs::new(&stack, 10.0, &sources, 64);
        runs.check(&format!("thickness {thickness}"), truth, 0.02, |e| rho(e, 0));
    }
}

/// The sums depend on the random numbers and the number of paths, not on how whole batches are divided among
/// calls.
#[test]
fn sums_of_split_calls_are_bit_identical() {
    let stack = everything(1.0, mirror(0.7));
    let sources = [Source::Diffuse, beam(-20.0), Source::Disc(Cone::new(-12.0, 0.0, 5.0, 1.0))];
    let walk = Walk::new(&stack, view(8.0), &sources);
    let numbers = SampleStream::new(Sampler::Sobol, 3, 0);
    let (mut whole, mut parts) = (walk.replicate(), walk.replicate());
    walk.trace(&mut whole, &numbers, 2 * walk.batch() + 7);
    for count in [walk.batch(), walk.batch(), 7] {
        walk.trace(&mut parts, &numbers, count);
    }
    assert_eq!(walk.estimate(&whole), walk.estimate(&parts));
}
