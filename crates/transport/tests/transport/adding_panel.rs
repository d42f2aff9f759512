//! The deterministic solver of the ordinary panel: closed forms, physical laws, levels, and Monte Carlo.

mod resonance;

use std::f64::consts::PI;

use crate::common::*;
use crate::double_pass::*;
use papilio_optics::lobe::Lobe;
use papilio_optics::{Beta, Scatterer};
use papilio_sampling::Sampler;
use papilio_transport::adding::{Kernel, error_over_difference};
use papilio_transport::{
    AngularTable, Base, Cone, CosinePanels, Diffuser, Estimate, Interface, Layer, Medium, Nodes, Reflector,
    Source, Stack, Top,
};

fn lambertian_diffuser(regular_fraction: f64) -> Top {
    Top::Diffuser(Diffuser { lobe: Lobe::Lambertian, transmittance: one(1.0), regular_fraction })
}

fn solve(panel: &Panel, view: Cone, sources: &[Source], level: u32) -> Estimate {
    let stack = panel.stack();
    let mut kernel = Kernel::new(level);
    kernel.prepare(&stack, &[view], sources);
    kernel.estimate(&stack, 0)
}

fn beam(theta_deg: f64, phi_deg: f64) -> Source {
    Source::Beam(Beta::from_source(theta_deg, phi_deg, 1.0))
}

/// A pixel whose reflectance changes with the angle.
fn fringes(nodes: Nodes) -> Base {
    let count = nodes.count();
    let at = |k: usize| {
        let x = k as f64 / (count - 1).max(1) as f64;
        0.45 + 0.4 * (7.0 * x).cos() * (0.3 + 0.7 * x)
    };
    let table =
        AngularTable { nodes, basis: (0..count).map(at).collect(), mixture: vec![1.0], common: vec![0.0] };
    Base { reflector: Reflector::Specular(table), inactive_absorptance: one(0.05) }
}

/// Two passes of a k-correlation lobe over a mirror are one lobe of twice the width, from wide lobes to
/// widths of 1e-6.
#[test]
fn double_pass_over_mirror_equals_lobe_of_twice_the_width() {
    for (width, view_deg, light_deg, phi_deg) in [
        (0.0567, 8.0, -20.0, 0.0),
        (0.0567, 0.0, 0.0, 0.0),
        (0.03, 30.0, 15.0, 40.0),
        (0.2, 8.0, -8.0, 0.0),
        (1e-3, 20.0, -20.05, 0.0),
        (2e-3, 20.0, -35.0, 0.0),
        (1e-4, 20.0, 60.0, 0.0),
        (1e-4, 20.0, -20.0, 0.01),
        (1e-4, 20.0, 50.0, 70.0),
        (1e-6, 20.0, -20.0001, 0.0),
    ] {
        let stack = panel(diffuser(width, 0.9, 0.0), mirror(1.0));
        let (from, to) = (Beta::towards(view_deg, 0.0, 1.0), Beta::from_source(light_deg, phi_deg, 1.0));
        let (narrow, wide) = (Lobe::KCorrelation { width }, Lobe::KCorrelation { width: 2.0 * width });
        let truth = PI * 0.81 * (wide.density(from, to) - beyond_the_glass(narrow, from, to));
        // Two lobes in one place make a pole of third order: the error is a few hundred times exp(-digits).
        for (level, within) in [(0, 2e-4), (1, 1e-5), (3, 2e-7)] {
            let found = rho(&solve(&stack, view(view_deg), &[beam(light_deg, phi_deg)], level), 0);
            // The midpoint rule leaves 1e-7 of the light beyond the glass; positions are rounded to 1e-16.
            let allowed = (within + 1e-15 / width) * truth + 1e-7;
            assert!(
                (found - truth).abs() < allowed,
                "{width} {view_deg} {light_deg}, {level}: {found} {truth}"
            );
        }
    }
}

/// With a regular fraction s the double pass is s^2 delta + 2 s (1-s) lobe(b) + (1-s)^2 lobe(2b).
#[test]
fn double_pass_with_regular_fraction_equals_closed_form() {
    let (width, t, s) = (0.04, 0.8, 0.3);
    let stack = panel(diffuser(width, t, s), mirror(0.7));
    let (from, to) = (Beta::towards(8.0, 0.0, 1.0), Beta::from_source(-20.0, 0.0, 1.0));
    let density = |width| Lobe::KCorrelation { width }.density(from, to);
    let lost = beyond_the_glass(Lobe::KCorrelation { width }, from, to);
    let scattered = 2.0 * s * (1.0 - s) * density(width) + (1.0 - s).powi(2) * (density(2.0 * width) - lost);
    let truth = PI * t * t * 0.7 * scattered;
    let found = rho(&solve(&stack, view(8.0), &[beam(-20.0, 0.0)], 3), 0);
    assert!((found / truth - 1.0).abs() < 1e-7, "{found} {truth}");
}

/// A disc is the mean of the beams from it, plus its mirror image where this is in view.
#[test]
fn disc_equals_mean_of_beams() {
    let (width, t, s) = (0.05, 0.9, 0.2);
    let stack = panel(diffuser(width, t, s), mirror(0.5));
    let passes = DoublePass { width, transmittance: t, regular_fraction: s, reflectance: 0.5 };
    for (theta_deg, radius_deg) in [(-20.0, 3.0), (-14.0, 10.0), (40.0, 0.27)] {
        let disc = Cone::new(theta_deg, 0.0, radius_deg, 1.0);
        // The mirrored view lies in the second disc.
        let truth = passes.of_disc(Beta::towards(8.0, 0.0, 1.0), &disc, theta_deg == -14.0);
        let found = rho(&solve(&stack, view(8.0), &[Source::Disc(disc)], 2), 0);
        assert!((found / truth - 1.0).abs() < 1e-5, "{theta_deg} {radius_deg}: {found} {truth}");
    }
}

/// The sun's image in a bare mirror: if it fills a fraction of the field, `rho` is that fraction of
/// `pi R / Omega`.
#[test]
fn small_image_in_large_view_equals_its_fraction() {
    let stack = panel(Top::IdealAr, mirror(0.5));
    for (radius_deg, field_deg) in [(0.27, 5.0), (0.02, 20.0), (0.0001, 0.1), (3.0, 0.0)] {
        let sun = Cone::new(-8.0, 0.0, radius_deg, 1.0);
        let field = Cone::new(8.0, 0.0, 0.5 * field_deg, 1.0);
        let small = |half_deg: f64| 2.0 * (0.5 * half_deg.to_radians()).sin().powi(2);
        let share = if field_deg == 0.0 { 1.0 } else { small(radius_deg) / small(0.5 * field_deg) };
        let truth = 0.5 * share * PI / sun.projected_solid_angle();
        let found = rho(&solve(&stack, field, &[Source::Disc(sun)], 0), 0);
        assert!((found / truth - 1.0).abs() < 1e-6, "{radius_deg} {field_deg}: {found} {truth}");
    }
}

/// Internal diffuse reflectance of a medium of index n (Walsh; Duntley, J. Opt. Soc. Am. 32, 61 (1942),
/// through the reflectance from outside).
fn internal_diffuse_reflectance(n: f64) -> f64 {
    let (n2, n4) = (n * n, n.powi(4));
    let outside = 0.5
        + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0).powi(2))
        + n2 * (n2 - 1.0).powi(2) / (n2 + 1.0).powi(3) * ((n - 1.0) / (n + 1.0)).ln()
        - 2.0 * n.powi(3) * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n4 - 1.0))
        + 8.0 * n4 * (n4 + 1.0) / ((n2 + 1.0) * (n4 - 1.0).powi(2)) * n.ln();
    1.0 - (1.0 - outside) / n2
}

/// Glass over a mirror: r + t^2 R/(1 - r R); a Lambertian base of 0.5 under bare glass of index 1.5
/// (Saunderson).
#[test]
fn bare_glass_equals_closed_forms() {
    let stack = panel(Top::Fresnel(one(1.5)), mirror(0.5));
    let found = rho(&solve(&stack, view(0.0), &[Source::Diffuse], 0), 0);
    assert!((found - 0.510_204_081_632_653).abs() < 1e-14, "{found}");
    // Saunderson with the exact internal diffuse reflectance F of index 1.5.
    let f = internal_diffuse_reflectance(1.5);
    let stack = panel(Top::Fresnel(one(1.5)), lambertian(0.5));
    let truth = 0.04 + 0.96 * 0.5 * (1.0 - f) / (1.0 - 0.5 * f);
    let found = rho(&solve(&stack, view(0.0), &[Source::Diffuse], 3), 0);
    assert!((found - truth).abs() < 1e-8 && (found - 0.316_071).abs() < 1e-6, "{found} {truth}");
    // Under diffuse light: the mean over the hemisphere of views (a Lambertian receiver).
    let nodes = 60;
    let mean: f64 = (0..nodes)
        .map(|k| {
            // Midpoint rule, graded towards grazing: cos^2 = u^4.
            let u = (f64::from(k) + 0.5) / f64::from(nodes);
            let theta = (u * u).acos().to_degrees();
            4.0 * u.powi(3) / f64::from(nodes) * rho(&solve(&stack, view(theta), &[Source::Diffuse], 2), 0)
        })
        .sum();
    assert!((mean - 0.352_959).abs() < 1e-4, "{mean}");
}

/// Lossless layers return all light.
#[test]
fn lossless_layers_return_all_light() {
    for front in [Front::none(), front(&[(0.04, 0.0), (0.1, 0.0)]), front(&[(0.6, 0.0)])] {
        for (name, top, base) in [
            ("fresnel, mirror", Top::Fresnel(one(1.5)), mirror(1.0)),
            ("fresnel, Lambertian", Top::Fresnel(one(1.5)), lambertian(1.0)),
            ("coated, mirror", Top::IdealAr, mirror(1.0)),
            ("coated, Lambertian", Top::IdealAr, lambertian(1.0)),
            ("Lambertian diffuser, mirror", lambertian_diffuser(0.0), mirror(1.0)),
            ("Lambertian diffuser and straight, mirror", lambertian_diffuser(0.3), mirror(1.0)),
        ] {
            let mut stack = panel(top, base);
            stack.front = front.clone();
            let found = rho(&solve(&stack, view(25.0), &[Source::Diffuse], 3), 0);
            assert!((found - 1.0).abs() < 1e-8, "{name}: {found}");
        }
    }
}

/// Recycling between a Lambertian panel and the front: R + T^2 R_p/(1 - r R_p).
#[test]
fn recycled_light_equals_closed_form() {
    for r in [0.04, 0.3, 0.8] {
        let mut stack = panel(lambertian_diffuser(0.0), mirror(0.4));
        stack.front = front(&[(r, 0.0)]);
        let exact = r + (1.0 - r).powi(2) * 0.4 / (1.0 - r * 0.4);
        let found = rho(&solve(&stack, view(0.0), &[Source::Diffuse], 3), 0);
        assert!((found - exact).abs() < 1e-8, "{r}: {found} {exact}");
    }
}

/// Panels of every kind, with fronts from faint to strong.
fn family() -> Vec<(String, Panel)> {
    let angles = [0.0_f64, 20.0, 45.0, 70.0, 88.0].map(f64::to_radians).to_vec();
    let bases = [
        ("cosines", fringes(Nodes::Cosines(33))),
        ("angles in glass", fringes(Nodes::AnglesInMedium(angles.clone()))),
        ("angles in air", fringes(Nodes::AnglesInAir(angles))),
        ("mirror", mirror(0.8)),
        ("Lambertian", lambertian(0.7)),
    ];
    let tops = [
        ("narrow", diffuser(0.03, 0.9, 0.0)),
        ("wide", diffuser(0.1, 0.95, 0.0)),
        ("straight", diffuser(0.08, 0.9, 0.25)),
        ("Lambertian", lambertian_diffuser(0.1)),
        ("fresnel", Top::Fresnel(one(1.5))),
    ];
    let mut all = Vec::new();
    for (k, (base_name, base)) in bases.iter().enumerate() {
        for (j, (top_name, top)) in tops.iter().enumerate() {
            let mut stack = panel(top.clone(), base.clone());
            let r = [0.0, 0.005, 0.04, 0.3][(k + 2 * j) % 4];
            stack.front = front(&[(r, 0.01)]);
            all.push((format!("{top_name} over {base_name}, front {r}"), stack));
        }
    }
    all
}

fn lights() -> Vec<Source> {
    vec![Source::Diffuse, beam(-20.0, 10.0), Source::Disc(Cone::new(-35.0, 30.0, 2.0, 1.0))]
}

/// The difference between levels is the error of the coarser one, and it decreases.
#[test]
fn level_differences_estimate_errors_and_decrease() {
    // Every second one has all pixels, all tops and all fronts, too.
    for (name, stack) in family().into_iter().step_by(sized(2, 1)) {
        let view = Cone::new(12.0, 0.0, 0.3, 1.0);
        let estimates: Vec<Estimate> = (0..4).map(|level| solve(&stack, view, &lights(), level)).collect();
        for source in 0..3 {
            let values: Vec<f64> = estimates.iter().map(|e| rho(e, source)).collect();
            // A bare mirror shows nothing of a beam.
            let error = |level: usize| (values[level] - values[3]).abs() / values[3].abs().max(1e-12);
            let angles = name.contains("angles");
            for (level, most) in [(0, 1e-3), (1, 1e-4), (2, if angles { 3e-5 } else { 1e-5 })] {
                assert!(error(level) < most, "{name}, source {source}: {values:?}");
            }
            let times = error_over_difference(&stack.stack(), &lights());
            let claimed = times * (values[0] - values[1]).abs() / values[3].abs().max(1e-12);
            assert!(error(1) < 0.3 * claimed + 3e-6, "{name}, source {source}: {values:?}");
        }
    }
}

/// Lobes too narrow for the grid of recycled light: the work is bounded, and the result is right at the peak
/// of the lobe and far from it.
#[test]
fn narrow_lobes_under_front_equal_closed_form() {
    for (width, sent_back, light_deg) in [
        (2e-3, 0.02, -20.0),
        (1e-4, 0.02, -20.0),
        (1e-6, 0.02, -20.0),
        (2e-3, 0.02, -35.0),
        (2e-3, 0.08, 50.0),
        (4e-3, 0.08, 50.0),
        (4e-3, 0.08, -25.0),
        (7e-3, 0.3, 10.0),
    ] {
        for straight in [0.0, 0.3] {
            let mut stack = panel(diffuser(width, 1.0, straight), mirror(0.8));
            stack.front = front(&[(sent_back, 0.0)]);
            let found = rho(&solve(&stack, view(20.0), &[beam(light_deg, 0.0)], 0), 0);
            // Without rims, light scattered n times has one lobe of width nb.
            let (from, to) = (Beta::towards(20.0, 0.0, 1.0), Beta::from_source(light_deg, 0.0, 1.0));
            let order = |k: i32| {
                let (scattered, mut ways) = (1.0 - straight, 1.0);
                let mut seen = 0.0;
                for n in 1..=2 * k {
                    ways *= f64::from(2 * k - n + 1) / f64::from(n);
                    let share = ways * scattered.powi(n) * f64::powi(straight, 2 * k - n);
                    let lobe = Lobe::KCorrelation { width: f64::from(n) * width };
                    seen += share * lobe.density(from, to);
                }
                PI * (1.0 - sent_back).powi(2) * sent_back.powi(k - 1) * 0.8_f64.powi(k) * seen
            };
            let truth: f64 = (1..12).map(order).sum();
            let error = (found / truth - 1.0).abs();
            // Far from the peak all orders are tails, which are cut at the rims; those of the grid's wider
            // lobe more so.
            let allowed = if (from - to).length() < 0.1 { 3e-5 } else { 3e-3 };
            assert!(error < allowed, "{width} {sent_back} {light_deg} {straight}: {found} {truth}");
        }
    }
}

#[test]
fn ledger_sums_to_one() {
    for (name, mut stack) in family() {
        for single_pass in [false, true] {
            stack.single_pass = single_pass;
            let e = solve(&stack, view(30.0), &[Source::Diffuse], 1);
            let l = &e.ledger;
            let absorbed = l.front[0] + l.diffuser[0] + l.pixel[0] + l.inactive[0] + l.glass[0];
            let sum = l.returned[0] + absorbed + l.unaccounted[0];
            assert!((sum - 1.0).abs() < 1e-9, "{name}: {sum}");
            assert!((l.returned[0] - rho(&e, 0)).abs() < 1e-12, "{name}");
            assert!(single_pass || l.unaccounted[0] == 0.0, "{name}");
            for part in [&l.front, &l.diffuser, &l.pixel, &l.inactive] {
                assert!(part[0] > -1e-6, "{name}: {l:?}");
            }
        }
    }
}

/// Exchanging viewer and source changes nothing (Helmholtz).
#[test]
fn exchanged_view_and_source_give_the_same_value() {
    for (name, stack) in family() {
        let one_way = rho(&solve(&stack, view(10.0), &[beam(35.0, 40.0)], 2), 0);
        let other = rho(&solve(&stack, view(35.0), &[beam(10.0, 40.0)], 2), 0);
        assert!((one_way - other).abs() < 3e-6 * one_way.abs() + 1e-12, "{name}: {one_way} {other}");
    }
}

/// A kernel that was used for other views, sources and fronts gives the same results as a new one, to the
/// bit.
#[test]
fn reused_kernel_is_bit_identical_to_new_one() {
    for (name, panel) in family() {
        let (mut kept, views) =
            (Kernel::new(sized(0, 1)), [view(8.0), view(20.0), Cone::new(40.0, 90.0, 0.5, 1.0)]);
        let mut other = panel.clone();
        other.front = front(&[(0.02, 0.0)]);
        kept.prepare(&panel.stack(), &views[..2], &[beam(50.0, 0.0), Source::Diffuse]);
        kept.prepare(&other.stack(), &views[1..], &lights());
        kept.prepare(&panel.stack(), &views[1..], &lights()[..2]);
        let stack = panel.stack();
        kept.prepare(&stack, &views, &lights());
        let mut fresh = Kernel::new(sized(0, 1));
        fresh.prepare(&stack, &views, &lights());
        for view in 0..3 {
            assert_eq!(kept.estimate(&stack, view), fresh.estimate(&stack, view), "{name}");
        }
        assert_eq!(kept.nodes(), fresh.nodes());
    }
}

/// A kernel prepared for a faint front is also right for a strong one.
#[test]
fn kernel_under_stronger_front_than_prepared_is_correct() {
    let mut faint = panel(diffuser(0.08, 0.9, 0.1), fringes(Nodes::Cosines(33)));
    faint.front = front(&[(0.005, 0.0)]);
    let mut strong = faint.clone();
    strong.front = front(&[(0.3, 0.0)]);
    let mut kernel = Kernel::new(0);
    kernel.prepare(&faint.stack(), &[view(8.0)], &lights());
    let found = kernel.estimate(&strong.stack(), 0);
    assert_eq!(found, solve(&strong, view(8.0), &lights(), 0));
}

/// Every wavelength of dispersive glass equals the panel with that index.
#[test]
fn dispersive_glass_equals_glass_of_each_index() {
    let indices: Vec<f64> = (0..30).map(|k| 1.5 + 0.001 * f64::from(k)).collect();
    for base in [fringes(Nodes::Cosines(33)), lambertian(0.7)] {
        let mut stack = panel(diffuser(0.08, 0.9, 0.2), base.clone());
        stack.front = front(&[(0.02, 0.0)]);
        let bins = indices.len();
        let mut many = stack.clone();
        let all = |value: f64| vec![value; bins];
        many.front = Front::of([(&all(0.02)[..], &all(0.0)[..])]);
        many.top = Top::Diffuser(Diffuser {
            lobe: Lobe::KCorrelation { width: 0.08 },
            transmittance: all(0.9).into(),
            regular_fraction: 0.2,
        });
        many.medium = Medium::new(indices.clone().into());
        many.base.inactive_absorptance = all(0.05).into();
        match &mut many.base.reflector {
            Reflector::Specular(table) => {
                table.basis = table.basis.iter().flat_map(|v| all(*v)).collect();
                table.common = all(0.0);
            }
            reflector @ Reflector::Lambertian(_) => {
                *reflector = Reflector::lambertian(all(0.7), indices.len())
            }
            Reflector::Scattering(_) => unreachable!("no panel has one"),
        }
        let found = solve(&many, view(8.0), &lights(), 1);
        for bin in [0, 13, 29] {
            stack.medium = Medium::new(one(indices[bin]));
            let single = solve(&stack, view(8.0), &lights(), 1);
            for source in 0..3 {
                let (a, b) = (found.rho[source].via_pixel[bin], single.rho[source].via_pixel[0]);
                assert!((a / b - 1.0).abs() < 1e-5, "bin {bin}, source {source}: {a} {b}");
            }
        }
    }
}

/// Monte Carlo, within its error bars: fronts, regular light, Lambertian lobes, discs.
#[test]
fn monte_carlo_agrees_with_adding() {
    for (name, stack) in family().into_iter().step_by(3) {
        let view = Cone::new(12.0, 0.0, 0.3, 1.0);
        let truth = solve(&stack, view, &lights(), 2);
        let estimates = replicates(&stack, view, &lights(), 11, 1024, Sampler::Random);
        let check = |what: &str, truth: f64, of: &dyn Fn(&Estimate) -> f64| {
            let (mean, error) = mean_and_error(estimates.iter().map(of));
            // 9 panels and 8 quantities, by Student's t of 31 degrees of freedom: 5 sigma is 2e-5 each.
            let off = (mean - truth).abs();
            assert!(off < 5.0 * error + 1e-6, "{name}, {what}: {mean} +- {error} against {truth}");
        };
        for source in 0..3 {
            check(&format!("source {source}"), rho(&truth, source), &|e| rho(e, source));
        }
        check("diffuser", truth.ledger.diffuser[0], &|e| e.ledger.diffuser[0]);
        check("pixel", truth.ledger.pixel[0], &|e| e.ledger.pixel[0]);
        check("inactive", truth.ledger.inactive[0], &|e| e.ledger.inactive[0]);
        check("front", truth.ledger.front[0], &|e| e.ledger.front[0]);
        check("returned", truth.ledger.returned[0], &|e| e.ledger.returned[0]);
    }
}

/// Fringes of a film as thick as glass, about fourteen across the field of view. Along the normal all rings
/// are circles about it, and the mean is an integral over one angle. The result is right at every level.
#[test]
fn view_over_fringes_equals_quadrature() {
    let (fringes, nodes) = (3600.0, 40_001);
    let at = |cosine: f64| 0.5 + 0.4 * (2.0 * PI * fringes * cosine).cos();
    let table = AngularTable {
        nodes: Nodes::Cosines(nodes),
        basis: (0..nodes).map(|k| at(k as f64 / (nodes - 1) as f64)).collect(),
        mixture: vec![1.0],
        common: vec![0.0],
    };
    let base = Base { reflector: Reflector::Specular(table), inactive_absorptance: one(0.0) };
    let stack = panel(Top::IdealAr, base);
    let half_angle = 5.0_f64;
    // Uniform in solid angle, for rays in air; the table is over the cosine in glass.
    let steps = 20_000;
    let mean: f64 = (0..steps)
        .map(|k| {
            let drop = (k as f64 + 0.5) / steps as f64 * (1.0 - half_angle.to_radians().cos());
            let sine_squared = drop * (2.0 - drop);
            at((1.0 - sine_squared / 2.25).sqrt()) / steps as f64
        })
        .sum();
    for level in [0, 1, 3] {
        let eye = Cone::new(0.0, 0.0, half_angle, 1.0);
        let found = rho(&solve(&stack, eye, &[Source::Diffuse], level), 0);
        assert!((found - mean).abs() < 1e-6, "level {level}: {found} against {mean}");
        // The same display as general layers.
        let layers = vec![Layer::new(Interface::IdealAr, stack.medium.clone())];
        let layered = Stack::general(layers, stack.base.clone());
        let mut kernel = Kernel::new(level);
        kernel.prepare(&layered, &[eye], &[Source::Diffuse]);
        assert!(kernel.serves(&layered));
        let found = rho(&kernel.estimate(&layered, 0), 0);
        assert!((found - mean).abs() < 1e-6, "layers, level {level}: {found} against {mean}");
    }
}
