//! Monte Carlo compared with closed forms, within its own error bars, over many seeds.

use crate::common::*;
use crate::double_pass::*;
use papilio_optics::lobe::Lobe;
use papilio_optics::{Beta, Scatterer};
use papilio_sampling::{SampleStream, Sampler};
use papilio_transport::specular_image;
use papilio_transport::walk::Walk;
use papilio_transport::{
    AngularTable, Base, Cone, CosinePanels, Diffuser, Front, Medium, Nodes, Reflector, Source, Top,
};

/// Compares `rho` under the last source, over seeds, with the expected value.
fn check(what: &str, stack: &Panel, view: Cone, sources: &[Source], paths: u64, truth: f64) {
    for sampler in [Sampler::Random, Sampler::Sobol] {
        let what = format!("{what}, {sampler:?}");
        assert_unbiased(&what, truth, 0.05, |seed| {
            let estimates = replicates(stack, view, sources, seed, paths, sampler);
            mean_and_error(estimates.iter().map(|e| rho(e, sources.len() - 1)))
        });
    }
}

/// Two passes of a k-correlation lobe over a mirror: the same lobe with 2b and T^2.
#[test]
fn double_pass_over_mirror_equals_lobe_of_twice_the_width() {
    let (width, t) = (0.03, 0.9);
    let stack = panel(diffuser(width, t, 0.0), mirror(1.0));
    let (narrow, wide) = (Lobe::KCorrelation { width }, Lobe::KCorrelation { width: 2.0 * width });
    for (view_deg, light_deg) in [(8.0, -20.0), (0.0, 0.0), (8.0, -8.0), (30.0, 15.0)] {
        let beam = Beta::from_source(light_deg, 0.0, 1.0);
        let eye = Beta::towards(view_deg, 0.0, 1.0);
        let density = wide.density(eye, beam) - beyond_the_glass(narrow, eye, beam);
        let truth = std::f64::consts::PI * t * t * density;
        check(
            &format!("double pass, view {view_deg}, light {light_deg}"),
            &stack,
            view(view_deg),
            &[Source::Diffuse, Source::Beam(beam)],
            256,
            truth,
        );
    }
}

/// With a regular fraction s the double pass is s^2 delta + 2 s (1-s) lobe(b) + (1-s)^2 lobe(2b).
#[test]
fn double_pass_with_regular_fraction_equals_closed_form() {
    let (width, t, s) = (0.04, 0.8, 0.3);
    let stack = panel(diffuser(width, t, s), mirror(0.7));
    let beam = Beta::from_source(-20.0, 0.0, 1.0);
    let from = Beta::towards(8.0, 0.0, 1.0);
    let density = |width| Lobe::KCorrelation { width }.density(from, beam);
    let scattered = 2.0 * s * (1.0 - s) * density(width) + (1.0 - s).powi(2) * density(2.0 * width);
    let truth = std::f64::consts::PI * t * t * 0.7 * scattered;
    check("straight-through", &stack, view(8.0), &[Source::Beam(beam)], 256, truth);
    let image = specular_image(&stack.stack(), beam);
    assert!((image.via_pixel[0] - (s * t).powi(2) * 0.7).abs() < 1e-15 && image.front[0] == 0.0);
}

/// A round source of growing radius over the same panel: its `rho` is that of a beam, averaged over the disc
/// (by an independent sum over points of the disc).
#[test]
fn disc_equals_mean_of_beams() {
    let (width, t, s) = (0.05, 0.9, 0.2);
    let stack = panel(diffuser(width, t, s), mirror(0.5));
    let passes = DoublePass { width, transmittance: t, regular_fraction: s, reflectance: 0.5 };
    for (theta_deg, radius_deg) in [(-20.0, 3.0), (-14.0, 10.0)] {
        let disc = Cone::new(theta_deg, 0.0, radius_deg, 1.0);
        // The mirrored view lies in the second disc.
        let truth = passes.of_disc(Beta::towards(8.0, 0.0, 1.0), &disc, theta_deg == -14.0);
        check(&format!("disc of {radius_deg} deg"), &stack, view(8.0), &[Source::Disc(disc)], 512, truth);
    }
}

/// The sun's image in a bare mirror: if it fills a fraction of the field, `rho` is that fraction of
/// `pi R / Omega`; random points of the field would hit it once in thousands.
#[test]
fn small_image_in_large_view_equals_its_fraction() {
    let stack = panel(Top::IdealAr, mirror(0.5));
    for (radius_deg, field_deg) in [(0.27, 5.0), (0.02, 20.0), (0.0001, 0.1), (3.0, 0.0)] {
        let sun = Cone::new(-8.0, 0.0, radius_deg, 1.0);
        let field = Cone::new(8.0, 0.0, 0.5 * field_deg, 1.0);
        let small = |half_deg: f64| 2.0 * (0.5 * half_deg.to_radians()).sin().powi(2);
        let share = if field_deg == 0.0 { 1.0 } else { small(radius_deg) / small(0.5 * field_deg) };
        let truth = 0.5 * share * std::f64::consts::PI / sun.projected_solid_angle();
        check(&format!("sun of {radius_deg} in {field_deg}"), &stack, field, &[Source::Disc(sun)], 64, truth);
    }
}

/// A sun seen through a partly regular diffuser: light scattered only on the way down or up equals that of a
/// beam. The disc is so small that no path would reach it by chance.
#[test]
fn small_disc_under_partly_regular_diffuser_equals_beam() {
    let (s, t) = (0.4, 0.9);
    for (name, base) in [("mirror", mirror(0.7)), ("Lambertian", lambertian(0.7))] {
        let stack = panel(diffuser(0.05, t, s), base);
        let sources = [
            Source::Beam(Beta::from_source(-20.0, 0.0, 1.0)),
            Source::Disc(Cone::new(-20.0, 0.0, 0.02, 1.0)),
        ];
        let estimates = replicates(&stack, view(8.0), &sources, 0, 4096, Sampler::Sobol);
        let (beam, error) = mean_and_error(estimates.iter().map(|e| rho(e, 0)));
        let (disc, disc_error) = mean_and_error(estimates.iter().map(|e| rho(e, 1)));
        assert!((beam - disc).abs() < 5.0 * error.hypot(disc_error) + 1e-5 * beam, "{name}: {beam} {disc}");
    }
}

#[test]
fn perfect_white_has_reflectance_one_under_any_light() {
    for (name, top) in [("coated", Top::IdealAr), ("fresnel", Top::Fresnel(one(1.5)))] {
        let stack = panel(top, lambertian(1.0));
        check(&format!("white, {name}"), &stack, view(8.0), &[Source::Diffuse], 256, 1.0);
    }
    // Below an ideal antireflection surface the Lambertian radiance is uniform, and so is the light that
    // leaves.
    let stack = panel(Top::IdealAr, lambertian(1.0));
    let beam = Source::Beam(Beta::from_source(40.0, 90.0, 1.0));
    let disc = Source::Disc(Cone::new(30.0, 45.0, 5.0, 1.0));
    for (name, source) in [("beam", beam), ("disc", disc)] {
        check(&format!("white, {name}"), &stack, view(20.0), &[source], 256, 1.0);
    }
}

/// Bare glass of index 1.5 over a mirror of 0.5: r + t^2 0.5/(1 - 0.5 r), r = 0.04.
#[test]
fn glass_over_mirror_equals_closed_form() {
    let stack = panel(Top::Fresnel(one(1.5)), mirror(0.5));
    check("glass over a mirror", &stack, view(0.0), &[Source::Diffuse], 256, 0.510204081632653);
}

/// Saunderson: a Lambertian base of 0.5 under bare glass of index 1.5.
#[test]
fn lambertian_base_under_glass_equals_saunderson() {
    let stack = panel(Top::Fresnel(one(1.5)), lambertian(0.5));
    check("Saunderson, normal", &stack, view(0.0), &[Source::Diffuse], 1024, 0.316_071);
    // Diffuse light: mean of the view over the hemisphere, Gauss-Legendre in the cosine.
    let nodes = gauss_legendre_12();
    assert_unbiased("Saunderson, diffuse", 0.352_959, 0.01, |seed| {
        let parts = nodes.iter().enumerate().map(|(k, (cosine, weight))| {
            let from = view(cosine.acos().to_degrees());
            let estimates =
                replicates(&stack, from, &[Source::Diffuse], 100 * seed + k as u64, 256, Sampler::Sobol);
            let (mean, error) = mean_and_error(estimates.iter().map(|e| rho(e, 0)));
            (2.0 * cosine * weight * mean, 2.0 * cosine * weight * error)
        });
        let parts: Vec<(f64, f64)> = parts.collect();
        (parts.iter().map(|p| p.0).sum(), parts.iter().map(|p| p.1 * p.1).sum::<f64>().sqrt())
    });
}

/// Nodes and weights on (0, 1) (Abramowitz & Stegun, table 25.4, n = 12).
fn gauss_legendre_12() -> Vec<(f64, f64)> {
    const HALF: [(f64, f64); 6] = [
        (0.125233408511469, 0.249147045813403),
        (0.367831498998180, 0.233492536538355),
        (0.587317954286617, 0.203167426723066),
        (0.769902674194305, 0.160078328543346),
        (0.904117256370475, 0.106939325995318),
        (0.981560634246719, 0.047175336386512),
    ];
    HALF.iter().flat_map(|&(x, w)| [(0.5 * (1.0 - x), 0.5 * w), (0.5 * (1.0 + x), 0.5 * w)]).collect()
}

/// Front of screen (0.04, 0.01) (0.01, 0.005) (0.02, 0) over a mirror of 0.4 with an ideal antireflection
/// surface: exact R + T^2 0.4/(1 - r 0.4), and the dissertation's R + T^2 0.4.
#[test]
fn front_of_screen_exact_and_first_order() {
    let components = [(0.04, 0.01), (0.01, 0.005), (0.02, 0.0)];
    let reversed: Vec<(f64, f64)> = components.iter().rev().copied().collect();
    let pairs = |components: &[(f64, f64)]| components.iter().map(|(r, a)| ([*r], [*a])).collect::<Vec<_>>();
    let (reversed, pairs) = (pairs(&reversed), pairs(&components));
    let below = Front::exact(1, reversed.iter().map(|(r, a)| (&r[..], &a[..]))).reflectance_above[0];
    let exactly = Front::exact(1, pairs.iter().map(|(r, a)| (&r[..], &a[..])));
    let mut stack = panel(Top::IdealAr, mirror(0.4));
    stack.front = front(&components);
    let (t, r) = (0.918_299, 0.066_572);
    let exact = exactly.reflectance_above[0] + exactly.transmittance[0].powi(2) * 0.4 / (1.0 - below * 0.4);
    assert!((exact - (r + t * t * 0.4 / (1.0 - below * 0.4))).abs() < 2e-6);
    check("front, exact", &stack, view(8.0), &[Source::Diffuse], 1024, exact);
    stack.single_pass = true;
    let once = Front::first_order(1, pairs.iter().map(|(r, a)| (&r[..], &a[..])));
    let first_order = once.reflectance_above[0] + once.transmittance[0].powi(2) * 0.4;
    assert!((first_order - (0.066_538 + 0.917_035_f64.powi(2) * 0.4)).abs() < 2e-6);
    // Light that the front sends back down is not followed: the ledger contains it as unaccounted.
    let e = &replicates(&stack, view(8.0), &[Source::Diffuse], 0, 16, Sampler::Random)[0].ledger;
    let sent_back = once.transmittance[0] * 0.4 * once.reflectance_below[0];
    assert!((e.unaccounted[0] - sent_back).abs() < 1e-12 && sent_back > 0.02);
    assert!((e.returned[0] + e.front[0] + e.pixel[0] + e.unaccounted[0] - 1.0).abs() < 1e-12);
    check("front, first order", &stack, view(8.0), &[Source::Diffuse], 16, first_order);
}

/// Recycling between a Lambertian panel and the front: R + T^2 R_p/(1 - r R_p), eq. 3-5 without and with its
/// missing factor (1.016 for r = 0.04, R_p = 0.4).
#[test]
fn recycled_light_equals_closed_form() {
    let mut stack = panel(diffuser_white(), mirror(0.4));
    stack.front = front(&[(0.04, 0.0)]);
    let exact = 0.04 + 0.96 * 0.96 * 0.4 / (1.0 - 0.04 * 0.4);
    check("recycling", &stack, view(0.0), &[Source::Diffuse], 1024, exact);
    assert!((1.0_f64 / (1.0 - 0.04 * 0.4) - 1.016).abs() < 5e-4);
}

/// A Lambertian diffuser without losses.
fn diffuser_white() -> Top {
    Top::Diffuser(Diffuser { lobe: Lobe::Lambertian, transmittance: one(1.0), regular_fraction: 0.0 })
}

/// Lossless layers return all light, whatever they do to directions.
#[test]
fn lossless_layers_return_all_light() {
    let fronts = [front(&[]), front(&[(0.04, 0.0), (0.1, 0.0)])];
    for (k, front) in fronts.into_iter().enumerate() {
        for (name, top, base) in [
            ("fresnel, mirror", Top::Fresnel(one(1.5)), mirror(1.0)),
            ("fresnel, Lambertian", Top::Fresnel(one(1.8)), lambertian(1.0)),
            ("coated, mirror", Top::IdealAr, mirror(1.0)),
            ("coated, Lambertian", Top::IdealAr, lambertian(1.0)),
            ("Lambertian diffuser, mirror", diffuser_white(), mirror(1.0)),
        ] {
            let mut stack = panel(top, base);
            stack.medium = Medium::new(one(if name == "fresnel, Lambertian" { 1.8 } else { 1.5 }));
            stack.front = front.clone();
            check(&format!("furnace {k}, {name}"), &stack, view(25.0), &[Source::Diffuse], 256, 1.0);
        }
    }
}

/// The ledger closes: its fractions sum to one, the part of roulette is zero within its error bar, and under
/// uniform white light the returned light equals the visible light.
#[test]
fn ledger_sums_to_one() {
    for (name, top, base) in [
        ("diffuser, mirror", diffuser(0.06, 0.9, 0.1), mirror(0.5)),
        ("diffuser, Lambertian", diffuser(0.06, 0.9, 0.1), lambertian(0.5)),
        ("fresnel, Lambertian", Top::Fresnel(one(1.5)), lambertian(0.7)),
        ("coated, mirror", Top::IdealAr, mirror(0.3)),
    ] {
        let mut stack = panel(top, base);
        stack.front = front(&[(0.2, 0.05), (0.1, 0.02)]);
        let unaccounted = |seed| {
            let estimates = replicates(&stack, view(30.0), &[Source::Diffuse], seed, 512, Sampler::Sobol);
            for e in &estimates {
                let l = &e.ledger;
                let absorbed = l.front[0] + l.diffuser[0] + l.pixel[0] + l.inactive[0];
                assert!((l.returned[0] + absorbed + l.unaccounted[0] - 1.0).abs() < 1e-12, "{name}");
                assert!((l.returned[0] - rho(e, 0)).abs() < 1e-12, "{name}");
            }
            let (mean, error) = mean_and_error(estimates.iter().map(|e| e.ledger.unaccounted[0]));
            (1.0 + mean, error)
        };
        assert_unbiased(&format!("ledger, {name}"), 1.0, 0.01, unaccounted);
    }
}

/// Exchanging viewer and source changes nothing, whatever lies between (Helmholtz).
#[test]
fn exchanged_view_and_source_give_the_same_value() {
    for (name, top, base) in [
        ("diffuser, mirror", diffuser(0.08, 0.9, 0.1), mirror(0.9)),
        ("diffuser, Lambertian", diffuser(0.08, 0.9, 0.1), lambertian(0.9)),
        ("fresnel, Lambertian", Top::Fresnel(one(1.5)), lambertian(0.9)),
    ] {
        let mut stack = panel(top, base);
        stack.front = front(&[(0.3, 0.05)]);
        let one_way = |reader: f64, lamp: f64, seed| {
            let beam = Source::Beam(Beta::from_source(lamp, 40.0, 1.0));
            let reader = Cone::new(reader, 0.0, 0.0, 1.0);
            let estimates = replicates(&stack, reader, &[beam], seed, 1024, Sampler::Sobol);
            mean_and_error(estimates.iter().map(|e| rho(e, 0)))
        };
        // The same pair of directions, with the azimuth between them mirrored. They are far from each other's
        // mirror images: most of the light comes by rare paths. No seed may be noisier than others (with
        // weights that grew from pass to pass, one seed in 500 had an error of 0.3).
        assert_unbiased(&format!("reciprocity, {name}"), 1.0, 0.025, |seed| {
            let (a, error_a) = one_way(10.0, 35.0, 2 * seed);
            let (b, error_b) = one_way(35.0, 10.0, 2 * seed + 1);
            (a / b, (a / b) * (error_a / a).hypot(error_b / b))
        });
    }
}

/// A medium whose index depends on wavelength uses another algorithm (spectra from the start). With an index
/// that hardly varies it must agree with the constant one. Over a mirror without regular transmittance this
/// also compares single paths with groups of paths.
#[test]
fn dispersive_medium_agrees_with_constant_one() {
    for (base, regular_fraction) in [(mirror(0.8), 0.1), (mirror(0.8), 0.0), (lambertian(0.8), 0.1)] {
        let sources = [Source::Diffuse, Source::Beam(Beta::from_source(-15.0, 0.0, 1.0))];
        let constant = panel(diffuser(0.2, 0.9, regular_fraction), base.clone());
        let mut two_bins = constant.clone();
        two_bins.front = front(&[]);
        two_bins.medium = Medium::new(vec![1.5, 1.5 + 1e-9].into());
        let Top::Diffuser(d) = &mut two_bins.top else { unreachable!() };
        d.transmittance = vec![0.9; 2].into();
        two_bins.base.inactive_absorptance = vec![0.0; 2].into();
        match &mut two_bins.base.reflector {
            Reflector::Specular(table) => {
                table.basis = vec![0.8; 2].into();
                table.common = vec![0.0; 2];
            }
            reflector @ Reflector::Lambertian(_) => *reflector = Reflector::lambertian(vec![0.8; 2], 2),
            Reflector::Scattering(_) => unreachable!(),
        }
        let a = replicates(&constant, view(8.0), &sources, 5, 128, Sampler::Sobol);
        let b = replicates(&two_bins, view(8.0), &sources, 5, 128, Sampler::Sobol);
        for (a, b) in a.iter().zip(&b) {
            for source in 0..2 {
                for bin in 0..2 {
                    let (x, y) = (a.rho[source].via_pixel[0], b.rho[source].via_pixel[bin]);
                    assert!((x - y).abs() < 1e-6 * x, "source {source}, bin {bin}: {x} {y}");
                }
            }
        }
    }
}

/// Paths are traced in groups. The sums are bit-identical however calls divide them, over a table of one
/// node and over one in panels.
#[test]
fn sums_of_split_calls_are_bit_identical() {
    for base in [mirror(0.8), in_panels()] {
        let mut stack = panel(diffuser(0.06, 0.9, 0.0), base);
        stack.front = front(&[(0.1, 0.05)]);
        let stack = stack.stack();
        let sources = [Source::Diffuse, Source::Beam(Beta::from_source(-15.0, 0.0, 1.0))];
        let walk = Walk::new(&stack, view(8.0), &sources);
        let numbers = SampleStream::new(Sampler::Sobol, 3, 0);
        let (mut whole, mut parts) = (walk.replicate(), walk.replicate());
        walk.trace(&mut whole, &numbers, 1000);
        for count in [1, 60, 3, 136, 64, 700, 36] {
            walk.trace(&mut parts, &numbers, count);
        }
        assert_eq!(walk.estimate(&whole), walk.estimate(&parts));
    }
}

/// A mirror whose reflectance is a table in panels of the cosine, brighter towards the normal.
fn in_panels() -> Base {
    let panels = CosinePanels::new(&[1, 2, 3, 3]);
    let table = AngularTable {
        basis: panels.nodes().map(|cosine| 0.2 + 0.6 * cosine).collect(),
        nodes: Nodes::CosinePanels(panels),
        mixture: vec![1.0],
        common: vec![0.0],
    };
    Base { reflector: Reflector::Specular(table), inactive_absorptance: one(0.0) }
}

/// The statistics above can fail: an expected value that is off by half a percent is refused.
#[test]
#[should_panic(expected = "mean z")]
fn wrong_expected_value_is_refused() {
    let stack = panel(Top::Fresnel(one(1.5)), lambertian(0.5));
    check("wrong on purpose", &stack, view(0.0), &[Source::Diffuse], 1024, 0.316_071 * 1.005);
}
