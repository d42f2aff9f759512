//! Tests of the standard errors of the Monte Carlo solver, including those of derived metrics: over many
//! seeds, the deviations from a long run follow the distribution that the errors imply.
use crate::common::{run, run_on, scenario, walked};
use papilio_display::result::{RunResult, View};

/// Linear and nonlinear metrics with their standard errors.
fn metrics(view: &View) -> Vec<(&'static str, f64, f64)> {
    let mut all = vec![
        ("contrast", view.metrics.contrast_ratio.unwrap(), view.standard_error.contrast_ratio.unwrap()),
        ("gamut", view.metrics.gamut_percent_srgb.unwrap(), view.standard_error.gamut_percent_srgb.unwrap()),
    ];
    let red = view.states.get("red").unwrap();
    let (value, error) = (&red.value, &red.standard_error);
    all.push(("Y", value.Y, error.Y));
    all.push(("diffuse part", value.terms.diffuse, error.terms.diffuse));
    all.push(("directed part", value.terms.directed[0], error.terms.directed[0]));
    all.push(("u'", value.u_prime.unwrap(), error.u_prime.unwrap()));
    all.push(("a*", value.a_star.unwrap(), error.a_star.unwrap()));
    all.push(("L*", value.L_star.unwrap(), error.L_star.unwrap()));
    all.push(("peak", value.peak_nm.unwrap(), error.peak_nm.unwrap()));
    all.push(("from white", value.distance_from_white_uv.unwrap(), error.distance_from_white_uv.unwrap()));
    let (other, other_error) = (&value.metrics, &error.metrics);
    all.push((
        "dE2000",
        other.delta_E_2000_from_reference.unwrap(),
        other_error.delta_E_2000_from_reference.unwrap(),
    ));
    all.push(("v*", other.v_star.unwrap(), other_error.v_star.unwrap()));
    all.push(("R_hemi", value.R_hemi.unwrap(), error.R_hemi.unwrap()));
    all.push(("R_dir", value.R_dir[0].unwrap(), error.R_dir[0].unwrap()));
    let (together, together_error) = (&view.metrics, &view.standard_error);
    all.push((
        "coverage",
        together.coverage_percent_ebu.unwrap(),
        together_error.coverage_percent_ebu.unwrap(),
    ));
    all.push(("text", together.text_contrast.unwrap(), together_error.text_contrast.unwrap()));
    all.push((
        "shift",
        together.average_peak_shift_nm.unwrap(),
        together_error.average_peak_shift_nm.unwrap(),
    ));
    all.push(("radiance", value.radiance[40], error.radiance[40]));
    let ledger = view.ledger.get("red").unwrap();
    all.push(("returned", ledger.returned, ledger.standard_error.returned));
    all.push(("absorbed", ledger.absorbed.pixel, ledger.standard_error.absorbed.pixel));
    all
}

fn indoor(sampler: &str, seed: u64, relative_error: f64) -> RunResult {
    let overrides = [
        format!("solver.seed={seed}"),
        format!("solver.sampler=\"{sampler}\""),
        format!("solver.relative_error={relative_error}"),
    ];
    let overrides: Vec<&str> = overrides.iter().map(String::as_str).collect();
    run(&walked("indoor", &overrides).unwrap().scene).unwrap()
}

/// The z-scores follow Student's distribution (Sidak over 40 metrics: 3e-4), each with at least 48 seeds.
#[test]
fn z_scores_of_every_metric_follow_students_distribution() {
    let seeds = papilio_testing::seeds().max(48);
    for (sampler, target) in [("sobol", 0.01), ("random", 0.02)] {
        // A run has at least two rounds, after which the error is well below these targets.
        let truth = metrics(&indoor("sobol", 1_000_000, 2e-5).views[0]);
        let mut scores = vec![Vec::new(); truth.len()];
        for seed in 0..seeds {
            let found = metrics(&indoor(sampler, seed, target).views[0]);
            for ((scores, (_, value, error)), (name, exact, exact_error)) in
                scores.iter_mut().zip(found).zip(&truth)
            {
                assert!(*exact_error < 0.3 * error, "{name}: the reference is not accurate enough");
                scores.push((value - exact) / error.hypot(*exact_error));
            }
        }
        for (scores, (name, ..)) in scores.iter().zip(truth) {
            papilio_testing::assert_student(&format!("{sampler}, {name}"), scores, seeds as f64);
        }
    }
}

#[test]
fn number_of_threads_has_no_effect() {
    let scene = walked("angle-scan", &[]).unwrap().scene;
    let one = run_on(&scene, Some(1)).unwrap();
    assert_eq!(one, run_on(&scene, Some(3)).unwrap());
    assert_eq!(one, run_on(&scene, None).unwrap());
}

#[test]
fn run_stops_at_its_stopping_criterion() {
    let result = indoor("random", 3, 0.02);
    assert!(result.solver.relative_error_reached <= 0.02);
    let every_bin = walked("overcast", &["solver.per_wavelength=true"]).unwrap().scene;
    let result = run(&every_bin).unwrap();
    for (name, state) in result.views[0].states.iter() {
        let most = state.value.radiance.iter().copied().fold(0.0, f64::max);
        let worst = state.standard_error.radiance.iter().copied().fold(0.0, f64::max);
        assert!(worst <= 0.001 * most, "{name}");
        assert!(state.standard_error.Y <= 0.001 * state.value.Y, "{name}");
    }
}

/// Points that are spread evenly find the part of a lobe that stays in the glass equally often in all replicates: the
/// balance then has the error of one path, not none. Without a scatterer, it is a smooth sum over directions.
#[test]
fn balance_of_evenly_spread_paths_has_the_error_of_one_path() {
    let mirror = "display.pixel={ model = \"uniform\", kind = \"mirror\", reflectance = { white = 0.5, black = 0.04 } }";
    let sets = [mirror, "display.front=[]", "spectrum.step_nm=100", "solver.sampler=sobol"];
    for width in [0.003, 0.006, 0.012] {
        let lobe = format!(
            "display.diffuser={{ model = \"k-correlation\", width = {width}, transmittance = 0.56 }}"
        );
        let sets = [&sets[..], &[lobe.as_str()]].concat();
        let by_adding = run(&scenario("indoor", &sets).unwrap().scene).unwrap();
        let by_paths =
            run(&walked("indoor", &[&sets[..], &["solver.paths=16384"]].concat()).unwrap().scene).unwrap();
        for state in ["white", "black"] {
            let [a, m] = [&by_adding, &by_paths].map(|run| run.views[0].ledger.get(state).unwrap());
            for (name, exact, value, error) in [
                ("pixel", a.absorbed.pixel, m.absorbed.pixel, m.standard_error.absorbed.pixel),
                ("returned", a.returned, m.returned, m.standard_error.returned),
                ("diffuser", a.absorbed.diffuser, m.absorbed.diffuser, m.standard_error.absorbed.diffuser),
            ] {
                let off = (exact - value).abs();
                assert!(off <= 4.0 * error, "{width} {state} {name}: {off} with {error}");
                assert!(error > 0.0 && error < 1e-3, "{width} {state} {name}: {error}");
            }
        }
    }
    let bare = run(&walked("reference-pixel", &["solver.paths=1024", "spectrum.step_nm=100"]).unwrap().scene)
        .unwrap();
    let balance = bare.views[0].ledger.get("white").unwrap();
    assert!(balance.standard_error.absorbed.pixel < 1e-6);
}

/// Few paths, or none, pass an absorbing slab of an optical thickness of 12: the error of the pixel's part, and of its
/// light in the view, includes what all may have missed. Adding computes it without paths.
#[test]
fn balance_below_thick_slabs_includes_what_all_paths_may_miss() {
    let slab = "display.diffuser={ model = \"slab\", optical_thickness = 12, albedo = 0.7, anisotropy = 0.5, index = 1.5 }";
    let paper = "display.pixel={ model = \"uniform\", kind = \"lambertian\", reflectance = { white = 0.9, black = 0.05 } }";
    let sets = [slab, paper, "display.front=[]", "spectrum.step_nm=100"];
    let by_adding = run(&scenario("indoor", &sets).unwrap().scene).unwrap();
    let mut none = 0;
    for seed in 0..4 {
        let seed = format!("solver.seed={seed}");
        let more = ["solver.paths=2048", "solver.sampler=sobol", seed.as_str()];
        let by_paths = run(&walked("indoor", &[&sets[..], &more].concat()).unwrap().scene).unwrap();
        for state in ["white", "black"] {
            let [a, m] = [&by_adding, &by_paths].map(|run| run.views[0].ledger.get(state).unwrap());
            let (exact, value, error) = (a.absorbed.pixel, m.absorbed.pixel, m.standard_error.absorbed.pixel);
            assert!(exact > 0.0 && exact < 1e-3, "{exact}");
            none += usize::from(value == 0.0);
            assert!((exact - value).abs() <= 4.0 * error, "{seed} {state}: {exact} {value} {error}");
            assert!(error < 2.0 / 2048.0, "{seed} {state}: {error}");
            let [a, m] = [&by_adding, &by_paths].map(|run| run.views[0].states.get(state).unwrap());
            let off = (a.value.terms.diffuse - m.value.terms.diffuse).abs();
            assert!(off <= 4.0 * m.standard_error.terms.diffuse, "{seed} {state}: {off}");
        }
    }
    println!("{none} of 8 balances have no light in the pixel");
}
