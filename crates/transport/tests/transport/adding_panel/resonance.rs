//! Pixels whose reflectance changes over directions faster than any lobe.

use super::*;
use papilio_optics::Scatterer;

/// A resonance as films have them, at a cosine in the glass within the disc of air.
fn resonance(cosine: f64) -> f64 {
    0.5 + 0.4 / (1.0 + ((cosine - 0.8) / 0.01).powi(2))
}

fn resonant(nodes: Nodes, cosines: &[f64]) -> Base {
    let basis = cosines.iter().map(|c| resonance(*c)).collect();
    let table = AngularTable { nodes, basis, mixture: vec![1.0], common: vec![0.0] };
    Base { reflector: Reflector::Specular(table), inactive_absorptance: one(0.0) }
}

/// The same resonance, in both kinds of tables.
fn resonant_bases() -> [(&'static str, Base); 2] {
    let even: Vec<f64> = (0..1025).map(|k| f64::from(k) / 1024.0).collect();
    let panels = CosinePanels::new(&[1, 2, 6, 6, 6, 6, 6, 6, 6, 6, 6, 6, 6, 6, 6, 6, 6, 6]);
    let cosines: Vec<f64> = panels.nodes().collect();
    [
        ("evenly spaced", resonant(Nodes::Cosines(1025), &even)),
        ("panels", resonant(Nodes::CosinePanels(panels), &cosines)),
    ]
}

/// The resonance under a diffuser: the light from the view that leaves, and `pi` times the kernel towards a
/// beam. Trapezoid rule in azimuth, midpoint rule over the angle in the glass.
fn over_the_resonance(lobe: Lobe, from: Beta, to: Beta) -> [f64; 2] {
    let (rings, spokes) = (20_000, 100);
    let rim = if lobe == Lobe::Lambertian { (1.0_f64 / 1.5).asin() } else { 0.5 * PI };
    let step = rim / f64::from(rings);
    let mut sum = [0.0; 2];
    for ring in 0..rings {
        let (sin, cos) = ((f64::from(ring) + 0.5) * step).sin_cos();
        let radius = 1.5 * sin;
        let weight = 2.25 * sin * cos * step * 2.0 * PI / f64::from(spokes) * resonance(cos);
        let share_leaving = lobe.fraction_in_disc(radius, 1.0);
        for spoke in 0..spokes {
            let (x, y) = papilio_sampling::warp::polar(radius, f64::from(spoke) / f64::from(spokes));
            let seen = weight * lobe.density(from, Beta { x, y });
            sum[0] += seen * share_leaving;
            sum[1] += seen * PI * lobe.density(Beta { x, y }, to);
        }
    }
    sum
}

/// The reflectance of a pixel may change over directions faster than any lobe.
#[test]
fn wide_lobes_over_resonance_equal_quadrature() {
    let (from, to) = (Beta::towards(8.0, 0.0, 1.0), Beta::from_source(-20.0, 40.0, 1.0));
    let lights = [Source::Diffuse, beam(-20.0, 40.0)];
    let lobes = [0.1, 0.2, 1.0, 50.0].map(|width| Lobe::KCorrelation { width });
    for lobe in lobes.into_iter().chain([Lobe::Lambertian]) {
        let truths = over_the_resonance(lobe, from, to);
        for (table, base) in resonant_bases() {
            let top = Top::Diffuser(Diffuser { lobe, transmittance: one(1.0), regular_fraction: 0.0 });
            let stack = panel(top, base);
            let estimates = [0, 1, 2].map(|level| solve(&stack, view(8.0), &lights, level));
            for (source, truth) in truths.iter().enumerate() {
                let error = estimates.each_ref().map(|e| (rho(e, source) / truth - 1.0).abs());
                let claimed = (rho(&estimates[0], source) - rho(&estimates[1], source)).abs() / truth;
                assert!(error.iter().all(|error| *error < 1e-6), "{lobe:?}, {table}: {error:?}");
                // Eight-point interpolation itself has an error of 4e-7.
                assert!(error[0] < 2.0 * claimed + 5e-7, "{lobe:?}, {table}: {error:?} {claimed}");
            }
        }
    }
}

/// A Lambertian diffuser makes the panel Lambertian: T^2 R_p/(1 - r R_p) for scattered light, with R_p the
/// mean of the pixel over the disc of air; wide lobes converge.
#[test]
fn recycled_light_over_resonance_equals_closed_form() {
    let (wide, anywhere) = (Lobe::KCorrelation { width: 1.0 }, Beta { x: 0.1, y: 0.0 });
    let mean = over_the_resonance(Lobe::Lambertian, anywhere, anywhere)[1];
    for (table, base) in resonant_bases() {
        for (lobe, r) in
            [Lobe::Lambertian, wide].into_iter().flat_map(|l| [0.005, 0.05, 0.2, 0.5].map(|r| (l, r)))
        {
            let top = Top::Diffuser(Diffuser { lobe, transmittance: one(1.0), regular_fraction: 0.0 });
            let mut stack = panel(top, base.clone());
            stack.front = front(&[(r, 0.0)]);
            let values =
                [0, 1, 2, 3].map(|level| rho(&solve(&stack, view(8.0), &[beam(-20.0, 40.0)], level), 0));
            let exact = (1.0_f64 - r).powi(2) * mean / (1.0 - r * mean);
            let truth = if lobe == Lobe::Lambertian { exact } else { values[3] };
            let error = values.map(|value| (value / truth - 1.0).abs());
            assert!(
                error[0] < 3e-5 && error[1] < 3e-6 && error[2] < 1e-6,
                "{table}, {lobe:?}, {r}: {error:?}"
            );
        }
    }
}
