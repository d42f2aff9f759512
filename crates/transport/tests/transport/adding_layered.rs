//! General stacks by *adding*: published tables, closed forms, and the panel's solver.

use std::f64::consts::PI;

use crate::common::*;
use crate::layers::*;
use papilio_optics::interface::fresnel_reflectance;
use papilio_optics::lobe::Lobe;
use papilio_optics::{Beta, Scatterer};
use papilio_transport::{Cone, Diffuser, Estimate, Interface, Source, Stack, Top};

/// Angles in degrees and weights of a mean over the hemisphere, weighted with the cosine: the Gauss-Legendre
/// rule of eight points in theta, twice.
fn hemisphere() -> Vec<(f64, f64)> {
    let half = [
        (0.183_434_642_495_649_8, 0.362_683_783_378_362),
        (0.525_532_409_916_329, 0.313_706_645_877_887_3),
        (0.796_666_477_413_626_7, 0.222_381_034_453_374_47),
        (0.960_289_856_497_536_2, 0.101_228_536_290_376_26),
    ];
    let mut rule = Vec::new();
    for (x, w) in half {
        for (sign, middle) in [(-1.0, 0.25), (1.0, 0.25), (-1.0, 0.75), (1.0, 0.75)] {
            let theta = (middle + 0.25 * sign * x) * PI / 2.0;
            rule.push((theta.to_degrees(), w * PI / 8.0 * (2.0 * theta).sin()));
        }
    }
    rule
}

/// Mean of a quantity under diffuse light over all views.
fn mean_over_views(level: u32, stack: &Stack, quantity: impl Fn(&Estimate) -> f64) -> f64 {
    let rule = hemisphere();
    let cones: Vec<Cone> = rule.iter().map(|(theta, _)| view(*theta)).collect();
    let estimates = views(level, stack, &cones, &[Source::Diffuse]);
    rule.iter().zip(&estimates).map(|((_, weight), estimate)| weight * quantity(estimate)).sum()
}

/// Index-matched slabs with the Henyey-Greenstein phase function, converged to 1e-8 by an independent solver
/// and given to 6 digits; transmitted light ends in a black base.
#[test]
fn slabs_equal_published_table() {
    let table = [
        (0.9, 1.0, 0.0, [0.267410, 0.591625, 0.393662, 0.414840, 0.352712, 0.474746]),
        (0.9, 4.0, 0.0, [0.408142, 0.128524, 0.504093, 0.071824, 0.473186, 0.090564]),
        (0.9, 1.0, 0.75, [0.055947, 0.827917, 0.171039, 0.622342, 0.138359, 0.688548]),
        (0.99, 1.0, 0.9, [0.025123, 0.963707, 0.110993, 0.865378, 0.095950, 0.884380]),
        (1.0, 0.5, 0.9, [0.012376, 0.987624, 0.058414, 0.941586, 0.058365, 0.941635]),
        (1.0, 1.0, 0.75, [0.078740, 0.921260, 0.240480, 0.759520, 0.191971, 0.808029]),
        (1.0, 8.0, 0.9, [0.250996, 0.749004, 0.475303, 0.524697, 0.400949, 0.599051]),
    ];
    for (albedo, tau, g, row) in table {
        let stack = stack([(Interface::Open, slab(tau, g, albedo, 1.0))], mirror(0.0));
        let found = views(1, &stack, &[view(0.0), view(60.0)], &[Source::Diffuse]);
        let through = |estimate: &Estimate| estimate.ledger.pixel[0];
        let found = [
            rho(&found[0], 0),
            through(&found[0]),
            rho(&found[1], 0),
            through(&found[1]),
            mean_over_views(2, &stack, |e| rho(e, 0)),
            mean_over_views(2, &stack, through),
        ];
        for (column, (found, truth)) in found.into_iter().zip(row).enumerate() {
            assert_close(&format!("{albedo} {tau} {g} column {column}"), found, truth, 1.5e-6);
        }
    }
}

/// van de Hulst, *Multiple Light Scattering* (1980): a = 0.9, tau = 2, g = 0.75, normal incidence.
#[test]
fn slab_equals_van_de_hulst_table() {
    let stack = stack([(Interface::Open, slab(2.0, 0.75, 0.9, 1.0))], mirror(0.0));
    let found = estimate(1, &stack, view(0.0), &[Source::Diffuse]);
    assert_close("R", rho(&found, 0), 0.09739, 5e-6);
    assert_close("T", found.ledger.pixel[0], 0.66096, 5e-6);
}

/// A conservative layer over a back surface, all orders, to 2e-6 by an independent solver.
#[test]
fn layers_over_back_surface_equal_published_table() {
    let table = [
        (1.0, 1.0, 0.9, mirror(0.5), [0.503286, 0.503368, 0.527987]),
        (1.0, 1.0, 0.9, lambertian(0.5), [0.487380, 0.487701, 0.526353]),
        (1.5, 0.5, 0.9, mirror(0.5), [0.470261, 0.469453, 0.454946]),
        (1.5, 1.0, 0.9, mirror(0.5), [0.439692, 0.438485, 0.421758]),
        (1.5, 1.0, 0.9, mirror(0.02), [0.060391, 0.060386, 0.110288]),
        (1.5, 1.0, 0.9, lambertian(0.5), [0.318526, 0.318567, 0.356460]),
    ];
    for (row, (index, tau, g, base, truth)) in table.into_iter().enumerate() {
        let face = if index == 1.0 { Interface::Open } else { Interface::Fresnel };
        let stack = stack([(face, slab(tau, g, 1.0, index))], base);
        let found = views(2, &stack, &[view(0.0), view(8.0)], &[Source::Diffuse]);
        let all = mean_over_views(2, &stack, |e| rho(e, 0));
        for (found, truth) in [rho(&found[0], 0), rho(&found[1], 0), all].into_iter().zip(truth) {
            assert_close(&format!("row {row}"), found, truth, 3e-6);
        }
    }
}

/// Giovanelli, Opt. Acta 2, 153 (1955): a half space of albedo 0.9 under a surface of n = 1.5.
#[test]
fn half_space_under_glass_equals_giovanelli() {
    let stack = stack([(Interface::Fresnel, slab(200.0, 0.0, 0.9, 1.5))], mirror(0.0));
    assert_close("normal", rho(&estimate(1, &stack, view(0.0), &[Source::Diffuse]), 0), 0.259919, 1e-6);
    assert_close("diffuse", mean_over_views(1, &stack, |e| rho(e, 0)), 0.307890, 1e-6);
}

/// Chandrasekhar, *Radiative Transfer* (1960): isotropic half space, omega = 0.9:
/// `R = omega/4 H(mu) H(mu0)/(mu + mu0)`; H to 5 decimals.
#[test]
fn half_space_radiance_equals_h_function() {
    let stack = stack([(Interface::Open, slab(1e4, 0.0, 0.9, 1.0))], mirror(0.0));
    let h = [(0.1_f64, 1.17214), (0.5, 1.55603), (1.0, 1.85010)];
    for (mu, h_out) in h {
        for (mu0, h_in) in h {
            let light = beam(mu0.acos().to_degrees(), 40.0);
            let found = estimate(3, &stack, view(mu.acos().to_degrees()), &[light]);
            let truth = 0.225 * h_out * h_in / (mu + mu0);
            // Half a unit of the table's last decimal, 1e-5, twice.
            assert_close(&format!("{mu} {mu0}"), rho(&found, 0), truth, 1.2e-5 * truth);
        }
    }
}

/// Flat layers have no discretisation error: closed forms, and Saunderson's correction.
#[test]
fn clear_layers_equal_closed_forms() {
    let glass = |base| stack([(Interface::Fresnel, clear(1.5))], base);
    let seen = |stack: &Stack, theta| rho(&estimate(0, stack, view(theta), &[Source::Diffuse]), 0);
    let r = |theta: f64| fresnel_reflectance(1.0, 1.5, theta.to_radians().sin());
    for theta in [0.0, 40.0, 85.0] {
        let truth = r(theta) + (1.0 - r(theta)).powi(2) * 0.5 / (1.0 - 0.5 * r(theta));
        assert_close("mirror", seen(&glass(mirror(0.5)), theta), truth, 1e-12);
    }
    let finest = |stack: &Stack| rho(&estimate(3, stack, view(0.0), &[Source::Diffuse]), 0);
    assert_close("Saunderson, normal", finest(&glass(lambertian(0.5))), 0.316071, 6e-7);
    assert_close(
        "Saunderson, diffuse",
        mean_over_views(3, &glass(lambertian(0.5)), |e| rho(e, 0)),
        0.352959,
        1e-6,
    );
    // A filter of transmittance 0.6 along the normal, seen at an angle; a medium of albedo 0 is the same.
    let cosine = (1.0 - (0.5 / 1.5_f64).powi(2)).sqrt();
    let t = 0.6_f64.powf(1.0 / cosine);
    let truth = r(30.0) + (1.0 - r(30.0)).powi(2) * t * t * 0.5 / (1.0 - 0.5 * t * t * r(30.0));
    let filter = clear(1.5).with_transmittance(one(0.6));
    for medium in [filter, slab(-0.6_f64.ln(), 0.5, 0.0, 1.5)] {
        let found = seen(&stack([(Interface::Fresnel, medium)], mirror(0.5)), 30.0);
        assert_close("filter", found, truth, 1e-12);
    }
}

/// Two passes through a lobe of width b equal one of width 2b, except for light outside the discs.
#[test]
fn double_pass_over_mirror_equals_lobe_of_twice_the_width() {
    let (b, t) = (0.05, 0.9);
    let stack = stack([(diffuser(b, t, 0.0), clear(1.5))], mirror(0.7));
    for (theta, phi) in [(-8.0, 0.0), (-12.0, 0.0), (-3.0, 40.0)] {
        let found = rho(&estimate(2, &stack, view(8.0), &[beam(theta, phi)]), 0);
        let lobe = Lobe::KCorrelation { width: 2.0 * b };
        let truth =
            PI * t * t * 0.7 * lobe.density(Beta::from_source(theta, phi, 1.0), Beta::towards(8.0, 0.0, 1.0));
        assert_close("double pass", found / truth, 1.0, 1e-3);
    }
}

/// A panel given as layers equals the panel, for both of its solvers.
#[test]
fn panel_as_layers_equals_panel() {
    let disc = |theta| Source::Disc(Cone::new(theta, 20.0, 3.0, 1.0));
    let sources = [Source::Diffuse, beam(-20.0, 0.0), beam(40.0, 70.0), disc(-10.0), disc(-8.0)];
    for (lobe, regular_fraction, base) in [
        (Lobe::KCorrelation { width: 0.06 }, 0.0, mirror(0.6)),
        (Lobe::KCorrelation { width: 0.2 }, 0.3, mirror(0.6)),
        (Lobe::KCorrelation { width: 0.1 }, 0.0, lambertian(0.5)),
        (Lobe::Lambertian, 0.0, mirror(0.6)),
    ] {
        let diffuser = Diffuser { lobe, transmittance: one(0.9), regular_fraction };
        let front = [(0.04, 0.01), (0.02, 0.0)];
        let panel = Panel {
            front: Front::of(front.iter().map(|(r, a)| (std::slice::from_ref(r), std::slice::from_ref(a)))),
            top: Top::Diffuser(diffuser.clone()),
            medium: clear(1.5),
            base: base.clone(),
            single_pass: false,
        }
        .stack();
        let layers = stack(
            [
                (sheet(0.04, 0.01), clear(1.0)),
                (sheet(0.02, 0.0), clear(1.0)),
                (Interface::Diffuser(diffuser), clear(1.5)),
            ],
            base,
        );
        let eye = Cone::new(8.0, 0.0, 0.5, 1.0);
        let [panel, layers] =
            [(panel, 2), (layers, 2)].map(|(stack, level)| estimate(level, &stack, eye, &sources));
        for source in 0..sources.len() {
            let (truth, found) = (rho(&panel, source), rho(&layers, source));
            assert_close(&format!("{lobe:?} source {source}"), found / truth, 1.0, 3e-5);
            assert_close("front", layers.rho[source].front[0], panel.rho[source].front[0], 1e-9);
        }
        let books = |e: &Estimate| {
            let l = &e.ledger;
            [l.returned[0], l.front[0], l.diffuser[0], l.glass[0], l.pixel[0], l.inactive[0]]
        };
        for (found, truth) in books(&layers).into_iter().zip(books(&panel)) {
            assert_close("ledger", found, truth, 2e-5);
        }
    }
}
