//! Gloss and distinctness of image against closed forms, by both solvers.

use std::f64::consts::{SQRT_2, TAU};
use std::path::Path;
use std::sync::atomic::AtomicBool;

use papilio_display::Control;
use papilio_display::gloss::{GlossResult, StateGloss, gloss, gloss_of};
use papilio_scenario::Scenario;

/// Glass over an absorber: a face, its index, and the solver.
fn read(layer: &str, index: f64, solver: &str) -> GlossResult {
    let text = format!(
        "[spectrum]\nrange_nm = [400, 700]\nstep_nm = 100\n[[display.layers]]\n{layer}\n[[display.layers]]\nkind = \"medium\"\n\
         index = {index}\n[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = {{ dark = 0.0 }}\n\
         [lighting]\ndiffuse = 1.0\n[viewer]\ntheta_deg = 0\nphi_deg = 25\n[solver]\nmethod = \"{solver}\"\nrelative_error = 0.004\n"
    );
    let scene =
        Scenario::from_text(&text, "glass.toml", Path::new(""), &[]).unwrap().resolve().unwrap().scene;
    gloss(&scene, &Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) }).unwrap()
}

/// Haze of glass of index 1.52 with these layers above it, without any other metric.
fn haze(layers: &str) -> Option<f64> {
    let text = format!(
        "display.layers = [{layers}, {{ kind = \"medium\", index = 1.52 }}]\n[display.pixel]\nmodel = \"uniform\"\n\
         kind = \"mirror\"\nreflectance = {{ dark = 0.0 }}\n[lighting]\ndiffuse = 1.0\n"
    );
    let scene =
        Scenario::from_text(&text, "glass.toml", Path::new(""), &[]).unwrap().resolve().unwrap().scene;
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
    let found = dark(&gloss_of(&scene, &|_| false, &control).unwrap()).values;
    assert_eq!((found.gloss_60, found.distinctness_of_image), (None, None));
    found.haze_percent
}

fn dark(result: &GlossResult) -> StateGloss {
    *result.states.get("dark").unwrap()
}

/// Unpolarised reflectance of glass in air, from the angles of incidence and refraction (Fresnel).
fn fresnel(index: f64, theta_deg: f64) -> f64 {
    let (i, r) = (theta_deg.to_radians(), (theta_deg.to_radians().sin() / index).asin());
    let s = ((i - r).sin() / (i + r).sin()).powi(2);
    let p = ((i - r).tan() / (i + r).tan()).powi(2);
    0.5 * (s + p)
}

/// The standard has a gloss of 100, other glass that of its reflectance; its images are distinct.
#[test]
fn flat_glass_has_the_gloss_of_its_reflectance() {
    for solver in ["adding", "monte-carlo"] {
        for index in [1.567, 1.46, 2.0] {
            let found = dark(&read("kind = \"fresnel\"", index, solver)).values;
            let pairs = [(found.gloss_20, 20.0), (found.gloss_60, 60.0), (found.gloss_85, 85.0)];
            for (value, theta_deg) in pairs {
                let expected = 100.0 * fresnel(index, theta_deg) / fresnel(1.567, theta_deg);
                assert!(
                    (value.unwrap() - expected).abs() < 1e-9,
                    "{solver} {index} {theta_deg}: {value:?} {expected}"
                );
            }
            assert_eq!(found.distinctness_of_image, Some(100.0));
        }
    }
}

/// Gaussian slopes of a root mean square of `alpha/sqrt 2`: reflected light deviates by twice the slope in the plane of
/// incidence, and by 2 cos(theta) times the slope across. The share of the receptor follows from normal distributions.
#[test]
fn rough_glass_has_the_gloss_of_its_slopes() {
    for alpha in papilio_testing::everyday(2, [0.0587, 0.001, 0.01]) {
        let face = format!("kind = \"rough\"\nalpha = {alpha}\ndistribution = \"beckmann\"");
        let found = dark(&read(&face, 1.52, "monte-carlo"));
        let (values, errors) = (found.values, found.error);
        let meters = [
            (values.gloss_20, errors.gloss_20, 20.0, [1.8, 3.6]),
            (values.gloss_60, errors.gloss_60, 60.0, [4.4, 11.7]),
            (values.gloss_85, errors.gloss_85, 85.0, [4.0, 6.0]),
        ];
        for (value, error, theta_deg, receptor) in meters {
            let slope = alpha / SQRT_2;
            let cosine = f64::to_radians(theta_deg).cos();
            let accepted = accepted(2.0 * slope, [0.75, receptor[0]], 0.0)
                * accepted(2.0 * cosine * slope, [2.5, receptor[1]], 0.0);
            let expected = 100.0 * fresnel(1.52, theta_deg) / fresnel(1.567, theta_deg) * accepted;
            // At 85 deg the reflectance changes over the lobe, and facets shadow each other.
            let small_angles = if theta_deg > 80.0 { 0.012 * expected } else { 0.003 * expected };
            let off = value.unwrap() - expected;
            assert!(
                off.abs() < small_angles + 4.0 * error.unwrap(),
                "{alpha} {theta_deg}: {value:?} {expected}"
            );
        }
        // Across, both slits accept the same; the reflectance of facets and their projection change by 0.3 % between them.
        let slit = |off_deg: f64| accepted(2.0 * alpha / SQRT_2, [0.44, 0.14], off_deg);
        let expected = 100.0 * (1.0 - slit(0.3) / slit(0.0));
        let (found, error) = (values.distinctness_of_image.unwrap(), errors.distinctness_of_image.unwrap());
        assert!((found - expected).abs() < 0.5 + 4.0 * error, "{alpha}: {found} {expected}");
    }
}

/// Slopes with a tail are a mixture of Gaussian ones, whose inverse variance has a gamma distribution: the gloss is the mean
/// of theirs.
#[test]
fn glass_with_a_tail_has_the_gloss_of_a_mixture() {
    let (alpha, tail) = (0.02, 2.5);
    let face = format!("kind = \"rough\"\nalpha = {alpha}\ndistribution = \"student-t\"\ntail = {tail}");
    let found = dark(&read(&face, 1.52, "monte-carlo"));
    let meters = [
        (found.values.gloss_20, found.error.gloss_20, 20.0, [1.8, 3.6]),
        (found.values.gloss_60, found.error.gloss_60, 60.0, [4.4, 11.7]),
    ];
    for (value, error, theta_deg, receptor) in meters {
        let cosine = f64::to_radians(theta_deg).cos();
        let (mut sum, mut all) = (0.0, 0.0);
        for k in 0..80 {
            let g = (-9.0 + 12.0 * (f64::from(k) + 0.5) / 80.0).exp();
            let weight = ((tail - 1.0) * g.ln() - g).exp();
            let slope = alpha * ((tail - 1.0) / g).sqrt() / SQRT_2;
            all += weight;
            sum += weight
                * accepted(2.0 * slope, [0.75, receptor[0]], 0.0)
                * accepted(2.0 * cosine * slope, [2.5, receptor[1]], 0.0);
        }
        let expected = 100.0 * fresnel(1.52, theta_deg) / fresnel(1.567, theta_deg) * sum / all;
        let off = value.unwrap() - expected;
        assert!(off.abs() < 0.004 * expected + 4.0 * error.unwrap(), "{theta_deg}: {value:?} {expected}");
    }
}

/// Mean over a source of the probability that a normally distributed deviation leads into a receptor whose middle is
/// `off_deg` beside the mirror direction. Widths of source and receptor in degrees.
fn accepted(deviation: f64, widths_deg: [f64; 2], off_deg: f64) -> f64 {
    let [source, receptor] = widths_deg.map(f64::to_radians);
    let off = off_deg.to_radians();
    // Steps far below both widths and the deviation, over all of the receptor that light can reach.
    let count = 40_000;
    let reach = 8.0 * deviation;
    let cell = |k: usize| {
        let angle = ((k as f64 + 0.5) / count as f64 - 0.5) * 2.0 * reach;
        let ends = [angle - 0.5 * source, angle + 0.5 * source];
        let overlap = ends[1].min(off + 0.5 * receptor) - ends[0].max(off - 0.5 * receptor);
        let weight = (-0.5 * (angle / deviation).powi(2)).exp();
        [weight, weight * (overlap / source).clamp(0.0, 1.0)]
    };
    let [all, inside] = (0..count).map(cell).fold([0.0; 2], |sum, one| [sum[0] + one[0], sum[1] + one[1]]);
    inside / all
}

/// Both solvers agree where the light below the face counts, too.
#[test]
fn solvers_agree_on_the_gloss_of_paper_below_rough_glass() {
    let both = ["adding", "monte-carlo"].map(|solver| {
        let layer = "kind = \"rough\"\nalpha = 0.8";
        let text = format!(
            "[spectrum]\nrange_nm = [400, 700]\nstep_nm = 100\n[[display.layers]]\n{layer}\n[[display.layers]]\nkind = \"medium\"\n\
             index = 1.5\n[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\nreflectance = {{ white = 0.8 }}\n\
             [lighting]\ndiffuse = 1.0\n[viewer]\ntheta_deg = 0\n[solver]\nmethod = \"{solver}\"\nrelative_error = 0.01\n"
        );
        let scene = Scenario::from_text(&text, "paper.toml", Path::new(""), &[]).unwrap().resolve().unwrap().scene;
        let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
        *gloss(&scene, &control).unwrap().states.get("white").unwrap()
    });
    let [adding, paths] = both;
    for ((name, one), (_, other)) in adding.values.named().zip(paths.values.named()) {
        let error = |of: &StateGloss| of.error.named().find(|(known, _)| *known == name).unwrap().1.unwrap();
        let (off, allowed) = (one.unwrap() - other.unwrap(), error(&adding) + 4.0 * error(&paths));
        assert!(off.abs() < allowed + 1e-9, "{name}: {one:?} {other:?}");
    }
    assert!(adding.values.distinctness_of_image.unwrap().abs() < 2.0);
}

/// Ten grades of etched glass: Ra and RSm in um, and the haze that their manufacturer prints. With slopes of the mean that
/// Ra and RSm determine, and the tail of GGX, it is within a factor of 1.6 for all; Gaussian slopes have none for the weak ones.
#[test]
fn tails_have_the_haze_of_etched_glass() {
    for (ra, rsm, printed) in [
        (0.58, 110.0, 12.6),
        (0.39, 110.0, 4.2),
        (0.25, 110.0, 2.2),
        (0.14, 110.0, 0.6),
        (0.10, 110.0, 0.3),
        (0.38, 55.0, 20.0),
        (0.26, 55.0, 11.1),
        (0.20, 55.0, 5.5),
        (0.13, 55.0, 3.6),
        (0.08, 55.0, 1.7),
    ] {
        let mean = TAU * ra / rsm;
        let of =
            |slopes: &str| haze(&format!("{{ kind = \"rough\", slope_mean = {mean}, {slopes} }}")).unwrap();
        let [ggx, student, gaussian] = [
            "distribution = \"ggx\"",
            "distribution = \"student-t\", tail = 2",
            "distribution = \"beckmann\"",
        ]
        .map(of);
        assert!((ggx / student - 1.0).abs() < 1e-6, "{ra} {rsm}: {ggx} {student}");
        assert!((1.0 / 1.6..1.6).contains(&(ggx / printed)), "{ra} {rsm}: {ggx} {printed}");
        assert!(printed > 4.0 || gaussian < 0.01 * printed, "{ra} {rsm}: {gaussian} {printed}");
        // Where most light is within 2.5 deg, less of the tail is less haze.
        let between = of("distribution = \"student-t\", tail = 4");
        assert!(printed > 4.0 || (gaussian..ggx).contains(&between), "{ra} {rsm}: {between}");
    }
}

/// A diffuser has the haze that describes it; flat glass, and two rough faces, have none.
#[test]
fn haze_is_that_of_one_scattering_interface() {
    let diffuser = "{ kind = \"diffuser\", model = \"k-correlation\", haze = 0.4, transmittance = 1 }";
    assert!((haze(diffuser).unwrap() - 40.0).abs() < 1e-6, "{:?}", haze(diffuser));
    let face = "{ kind = \"rough\", alpha = 0.1 }";
    assert!(haze(face).is_some());
    assert_eq!(haze("{ kind = \"fresnel\" }"), None);
    assert_eq!(haze(&format!("{face}, {{ kind = \"medium\", index = 1.4 }}, {face}")), None);
}

/// A rough plate of glass in air, whose second face is seen through the first: the method of adding for the light near the
/// mirror direction against paths, down to a roughness of 0.001, with and without a tail; and, where both are possible, against
/// adding for all directions (alpha above its limit).
#[test]
fn solvers_agree_on_the_gloss_of_a_rough_plate() {
    let cases = [
        ("alpha = 0.05\ndistribution = \"beckmann\"", 0.015),
        ("alpha = 0.02", 0.02),
        ("alpha = 0.001\ndistribution = \"beckmann\"", 0.004),
        ("alpha = 0.01\ndistribution = \"beckmann\"", 0.004),
        ("alpha = 0.05\ndistribution = \"beckmann\"", 0.004),
        ("alpha = 0.02", 0.01),
        ("alpha = 0.1", 0.01),
        ("alpha = 0.12", 0.01),
    ];
    for (face, error) in papilio_testing::everyday(1, cases) {
        let both = ["adding", "monte-carlo"].map(|solver| {
            let text = format!(
                "[spectrum]\nrange_nm = [400, 700]\nstep_nm = 100\n[[display.layers]]\nkind = \"rough\"\n{face}\n[[display.layers]]\n\
                 kind = \"medium\"\nindex = 1.52\n[display.pixel]\nmodel = \"film\"\nsubstrate = 1.0\n\
                 film = [{{ material = \"air\", thickness_nm = \"gap\" }}]\narea = {{ back = 1.0 }}\n\
                 gap_nm = {{ back = 0, dark = 0 }}\ndefault_states = false\n[display.pixel.states]\ndark = {{ back = {{ gap_nm = 0 }} }}\n\
                 [lighting]\ndiffuse = 1.0\n[solver]\nmethod = \"{solver}\"\nrelative_error = {error}\n"
            );
            let scene = Scenario::from_text(&text, "plate.toml", Path::new(""), &[]).unwrap().resolve().unwrap().scene;
            dark(&gloss(&scene, &Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) }).unwrap())
        });
        let [adding, paths] = both;
        for ((name, one), (_, other)) in adding.values.named().zip(paths.values.named()) {
            if name == "haze_percent" {
                continue;
            }
            let of = |of: &StateGloss| of.error.named().find(|(known, _)| *known == name).unwrap().1.unwrap();
            let (off, allowed) = (one.unwrap() - other.unwrap(), of(&adding) + 4.5 * of(&paths));
            let is_exact = of(&adding) < 2.0 * error * one.unwrap().max(20.0);
            assert!(is_exact || name == "distinctness_of_image", "{face} {name}: {one:?} ({})", of(&adding));
            assert!(off.abs() < allowed + 1e-9, "{face} {name}: {one:?} {other:?}");
        }
    }
}
