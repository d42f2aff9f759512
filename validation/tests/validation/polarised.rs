//! Bare displays whose faces and film keep s and p apart, against the program `tmm`:
//! `validation/films/polarised_oracle.py`.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use papilio_display::result::RunResult;
use papilio_display::spatial::{Picture, Precision, crosstalk, mtf, picture, walk};
use papilio_display::{Control, note_of_places, run};
use papilio_scenario::{Resolved, Scenario, ScenarioErrors};
use papilio_testing::{everyday, sized};

/// The pixel of the oracle, and a view.
const PIXEL: &str = r#"
[spectrum]
range_nm = [450, 650]
step_nm = 100
[display.pixel]
model = "film"
substrate = { n = 0.97, k = 6.46 }
area = { one = 1.0 }
gap_nm = { one = 192.3 }
default_states = false
film = [
  { material = { n = 3.18, k = 3.33 }, thickness_nm = 12 },
  { material = { n = 1.46 }, thickness_nm = 38.6 },
  { material = "air", thickness_nm = "gap" },
]
[display.pixel.states]
film = { one = { gap_nm = 192.3 } }
[viewer]
theta_deg = [8, 45, 60, 75]
field_deg = 0
"#;

const COATING: &str =
    "[[display.layers]]\nkind = \"coating\"\nfilm = [{ material = { n = 1.38 }, thickness_nm = 99.6 }]\n";

/// The layers of a display of the oracle.
fn layers(display: &str) -> String {
    let medium = |index: f64| format!("[[display.layers]]\nkind = \"medium\"\nindex = {index}\n");
    let cover = [1.5, 1.0, 1.5].map(medium).concat();
    match display {
        "face" => medium(1.5),
        "cover" => cover,
        "panes" => [medium(1.5), medium(1.0), cover].concat(),
        _ => [COATING.to_owned(), cover].concat(),
    }
}

fn resolved(display: &str, set: &[&str]) -> Result<Resolved, ScenarioErrors> {
    let set: Vec<String> = set.iter().map(|one| (*one).to_owned()).collect();
    let text = format!("{PIXEL}{}", layers(display));
    Scenario::from_text(&text, display, Path::new(""), &set)?.resolve()
}

fn result(display: &str, set: &[&str]) -> RunResult {
    let stop = AtomicBool::new(false);
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &stop };
    run(&resolved(display, set).unwrap().scene, &control).unwrap()
}

/// Reflectance `[view][wavelength]`.
fn reflectance(result: &RunResult) -> Vec<Vec<f64>> {
    let of = |view: usize| result.views[view].states.0[0].1.value.reflectance_factor.clone().unwrap();
    (0..result.views.len()).map(of).collect()
}

/// `[R_s, R_p]` of the oracle, `[view][wavelength]`.
fn oracle(display: &str) -> Vec<Vec<[f64; 2]>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("films/polarised.csv");
    let text = std::fs::read_to_string(path).unwrap();
    let own = text.lines().filter_map(|line| line.strip_prefix(display)?.strip_prefix(','));
    let numbers = own.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect::<Vec<f64>>());
    let both: Vec<[f64; 2]> = numbers.map(|row| [row[2], row[3]]).collect();
    both.chunks(3).map(<[_]>::to_vec).collect()
}

const DISPLAYS: [&str; 4] = ["face", "cover", "panes", "coated"];

fn largest_difference(found: &[Vec<f64>], expected: &[Vec<[f64; 2]>], weights: [f64; 2]) -> f64 {
    let pairs = found.iter().flatten().zip(expected.iter().flatten());
    pairs.map(|(found, [s, p])| (found - weights[0] * s - weights[1] * p).abs()).fold(0.0, f64::max)
}

/// Both solvers return the mean of the whole sums of s and of p, and not the sum of means.
#[test]
fn bare_displays_reflect_the_mean_of_s_and_p_of_tmm() {
    for display in DISPLAYS {
        let expected = oracle(display);
        assert_eq!((expected.len(), expected[0].len()), (4, 3));
        for method in ["solver.method=adding", "solver.method=monte-carlo"] {
            let found = reflectance(&result(display, &[method, "lighting.diffuse=1"]));
            let worst = largest_difference(&found, &expected, [0.5; 2]);
            assert!(worst < 2e-6, "{display}, {method}: {worst:e}");
        }
        let unpolarised = reflectance(&result(display, &["solver.approximation=unpolarised"]));
        let worst = largest_difference(&unpolarised, &expected, [0.5; 2]);
        assert!(worst > 0.005, "{display}: {worst}");
    }
}

/// The mirror image of a lamp, whose plane of incidence is that of the view.
#[test]
fn image_of_a_lamp_is_the_mean_of_s_and_p() {
    let lamp = "lighting.directed=[{theta_deg=60,phi_deg=180,radius_deg=5,share=1}]";
    for display in DISPLAYS {
        let of = |more: &[&str]| {
            let set = ["lighting.diffuse=0", "viewer.theta_deg=60", "viewer.field_deg=0.1", lamp];
            result(display, &[&set[..], more].concat())
        };
        let [s, p, both] = ["s", "p", "45"]
            .map(|polariser| reflectance(&of(&[&format!("viewer.polariser={polariser}")])).remove(0));
        let open = reflectance(&of(&[])).remove(0);
        let expected = &oracle(display)[2];
        // A lamp of 5 deg: pi/(pi sin^2 5) of a white surface's luminance.
        let brighter = 1.0 / 5.0_f64.to_radians().sin().powi(2) / 60.0_f64.to_radians().cos();
        for bin in 0..3 {
            let [of_s, of_p] = expected[bin];
            let close = |found: f64, r: f64| (found / (brighter * r) - 1.0).abs() < 2e-3;
            assert!(close(s[bin], of_s) && close(p[bin], of_p), "{display}: {} {}", s[bin], p[bin]);
            assert!((both[bin] / open[bin] - 1.0).abs() < 1e-9, "{display}");
            assert!((0.5 * (s[bin] + p[bin]) / open[bin] - 1.0).abs() < 1e-9, "{display}");
        }
    }
}

/// Sunglasses before a bare display: the angle is counted from the plane of incidence.
#[test]
fn polariser_passes_its_share_of_s_and_p() {
    for (word, weights) in
        [("s", [1.0, 0.0]), ("p", [0.0, 1.0]), ("30", [0.25, 0.75]), ("-120", [0.75, 0.25])]
    {
        let set = [&format!("viewer.polariser={word}")[..], "lighting.diffuse=1"];
        for method in ["solver.method=adding", "solver.method=monte-carlo"] {
            let found = reflectance(&result("cover", &[&set[..], &[method]].concat()));
            let worst = largest_difference(&found, &oracle("cover"), weights);
            assert!(worst < 2e-6, "{word}, {method}: {worst:e}");
        }
    }
}

/// Paper scatters: s and p are kept apart through the glass above it, and not beyond. Both solvers.
#[test]
fn paper_below_several_faces_has_the_mean_transmittance_of_tmm() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("films/polarised_paper.csv");
    let text = std::fs::read_to_string(path).unwrap();
    let paper = "display.pixel={model=\"uniform\",kind=\"lambertian\",reflectance={one=0.8}}";
    let (paths, noise) = sized(("solver.paths=8192", 6e-3), ("solver.paths=65536", 2e-3));
    for display in DISPLAYS {
        let own = text.lines().filter_map(|line| line.strip_prefix(display)?.strip_prefix(','));
        let expected: Vec<f64> = own.map(|line| line.split(',').nth(1).unwrap().parse().unwrap()).collect();
        assert_eq!(expected.len(), 4);
        let of =
            |set: &[&str]| reflectance(&result(display, &[&[paper, "lighting.diffuse=1"], set].concat()));
        for (set, most) in
            [(&["solver.relative_error=1e-5"][..], 1e-5), (&["solver.method=monte-carlo", paths], noise)]
        {
            for (found, expected) in of(set).iter().zip(&expected) {
                let off = (found[1] / expected - 1.0).abs();
                assert!(off < most, "{display}, {set:?}: {} {expected}", found[1]);
            }
        }
        let unpolarised = of(&["solver.approximation=unpolarised"]);
        let off = (unpolarised[2][1] / expected[2] - 1.0).abs();
        // Light meets one face alone.
        assert!(if display == "face" { off < 2e-4 } else { off > 0.005 }, "{display}: {off}");
    }
}

/// A diffuser that sends the same radiance everywhere makes light unpolarised before and after a mirror below several
/// faces: seen from anywhere, R over the square of the sine, with s and p kept apart between diffuser and mirror.
#[test]
fn diffuser_above_faces_and_mirror_has_the_mean_reflectance_of_tmm() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("films/polarised_diffused.csv");
    let text = std::fs::read_to_string(path).unwrap();
    let diffuser = "[[display.layers]]\nkind = \"diffuser\"\nmodel = \"lambertian\"\ntransmittance = 1.0\n\
        [[display.layers]]\nkind = \"medium\"\nindex = \"air\"\n";
    for display in everyday(1, ["coated", "cover", "panes", "face"]) {
        let own = text.lines().filter_map(|line| line.strip_prefix(display)?.strip_prefix(','));
        let expected: Vec<f64> = own.map(|line| line.split(',').nth(1).unwrap().parse().unwrap()).collect();
        assert_eq!(expected.len(), 3);
        let text = format!("{PIXEL}{diffuser}{}", layers(display));
        let of = |set: &[&str]| {
            let set: Vec<String> = set
                .iter()
                .chain(&["lighting.diffuse=1", "viewer.theta_deg=[8,60]"])
                .map(|one| (*one).to_owned())
                .collect();
            let resolved =
                Scenario::from_text(&text, display, Path::new(""), &set).unwrap().resolve().unwrap();
            let stop = AtomicBool::new(false);
            let control = Control { threads: Some(1), progress: &|_| {}, stop: &stop };
            run(&resolved.scene, &control).unwrap()
        };
        for (set, most) in [
            (&["solver.method=adding", "solver.relative_error=1e-5"][..], 2e-5),
            (&["solver.method=monte-carlo", "solver.paths=65536"], 4e-3),
        ] {
            let result = of(set);
            for found in reflectance(&result) {
                for (found, expected) in found.iter().zip(&expected) {
                    let off = (found / expected - 1.0).abs();
                    assert!(off < most, "{display}, {set:?}: {found} {expected}");
                }
            }
            let balance = &result.views[0].states.0[0].1;
            assert!(balance.value.Y > 0.0);
        }
        let unpolarised = reflectance(&of(&["solver.approximation=unpolarised"]));
        let off = (unpolarised[0][1] / expected[1] - 1.0).abs();
        assert!(off > 0.002, "{display}: {off}");
    }
}

/// Fresnel's formulas for s and p, from the angles of incidence and refraction.
fn face(theta_deg: f64, index: f64) -> [f64; 2] {
    let i = theta_deg.to_radians();
    let t = (i.sin() / index).asin();
    [((i - t).sin() / (i + t).sin()).powi(2), ((i - t).tan() / (i + t).tan()).powi(2)]
}

/// Reflectance and transmittance of the display "cover" without its pixel, for s and p: a pane in air, then a face; all
/// orders, by hand.
fn cover(theta_deg: f64) -> [[f64; 2]; 2] {
    face(theta_deg, 1.5).map(|r| {
        let (pane, through) = (2.0 * r / (1.0 + r), (1.0 - r) / (1.0 + r));
        let series = 1.0 / (1.0 - pane * r);
        [pane + through * through * r * series, through * (1.0 - r) * series]
    })
}

const METHODS: [&str; 2] = ["solver.method=adding", "solver.method=monte-carlo"];
const PAPER: &str = "display.pixel={model=\"uniform\",kind=\"lambertian\",reflectance={one=0.8}}";

/// p light at Brewster's angle has no gloss, and s light that of ((n^2 - 1)/(n^2 + 1))^2.
#[test]
fn p_light_at_brewsters_angle_has_no_gloss() {
    let theta_deg = 1.5_f64.atan().to_degrees();
    let view = format!("viewer.theta_deg={theta_deg}");
    let of = |angle_deg: f64, degree: f64, method: &str| {
        let lamp = format!(
            "lighting.directed=[{{theta_deg={theta_deg},phi_deg=180,radius_deg=1,share=1,polarisation={{degree={degree},angle_deg={angle_deg}}}}}]"
        );
        let black = PAPER.replace("0.8", "0.0");
        let set = [&black[..], "lighting.diffuse=0", "viewer.field_deg=0.2", &view, &lamp, method];
        reflectance(&result("face", &set)).remove(0)[1]
    };
    let brighter = 1.0 / 1.0_f64.to_radians().sin().powi(2) / theta_deg.to_radians().cos();
    let s = (1.25_f64 / 3.25).powi(2);
    for method in METHODS {
        assert!(of(0.0, 1.0, method) < 1e-5 * brighter, "{method}: {}", of(0.0, 1.0, method) / brighter);
        assert!((of(90.0, 1.0, method) / (brighter * s) - 1.0).abs() < 1e-3, "{method}");
        assert!((of(90.0, 0.5, method) / (brighter * 0.75 * s) - 1.0).abs() < 1e-3, "{method}");
        assert!((of(45.0, 1.0, method) / (brighter * 0.5 * s) - 1.0).abs() < 1e-3, "{method}");
    }
}

/// Paper scatters: of a polarised lamp, what passes the glass above it counts, and of a polariser, what passes it back.
#[test]
fn paper_below_faces_in_polarised_light_and_through_a_polariser() {
    let lamp = |more: &str| format!("lighting.directed=[{{theta_deg=60,phi_deg=90,share=1{more}}}]");
    let of = |lamp: &str, more: &[&str]| {
        let set = [&[PAPER, "lighting.diffuse=0", "viewer.theta_deg=45", lamp], more].concat();
        reflectance(&result("cover", &set)).remove(0)[1]
    };
    let mean = |both: [f64; 2]| 0.5 * (both[0] + both[1]);
    let (enters, leaves) = (cover(60.0).map(|k| k[1]), cover(45.0).map(|k| k[1]));
    for (method, most) in METHODS.into_iter().zip([1e-9, 1e-9]) {
        let method = [method, "solver.paths=16384"];
        let method = if method[0] == METHODS[0] { &method[..1] } else { &method[..] };
        let open = of(&lamp(""), method);
        for (degree, angle_deg, s) in [(1.0, 0.0, 0.0), (0.6, 90.0, 0.8), (1.0, 30.0, 0.25)] {
            let polarised = lamp(&format!(",polarisation={{degree={degree},angle_deg={angle_deg}}}"));
            let expected = (s * enters[0] + (1.0 - s) * enters[1]) / mean(enters);
            assert!(
                (of(&polarised, method) / open / expected - 1.0).abs() < most,
                "{method:?} {degree} {angle_deg}"
            );
            for (polariser, seen) in [("s", leaves[0]), ("p", leaves[1])] {
                let polariser = format!("viewer.polariser={polariser}");
                let both = of(&polarised, &[method, &[&polariser]].concat());
                assert!((both / open / (expected * seen / mean(leaves)) - 1.0).abs() < most, "{polariser}");
            }
        }
    }
}

/// The image of a polarised lamp in the glass above black paper, through a polariser: s stays s.
#[test]
fn glass_above_paper_mirrors_s_as_s() {
    let black = PAPER.replace("0.8", "0.0");
    let of = |angle_deg: f64, more: &[&str]| {
        let lamp = format!(
            "lighting.directed=[{{theta_deg=60,phi_deg=180,radius_deg=5,share=1,polarisation={{angle_deg={angle_deg}}}}}]"
        );
        let set = [&black[..], "lighting.diffuse=0", "viewer.theta_deg=60", &lamp];
        reflectance(&result("cover", &[&set[..], more].concat())).remove(0)[1]
    };
    let brighter = 1.0 / 5.0_f64.to_radians().sin().powi(2) / 60.0_f64.to_radians().cos();
    let [s, p] = cover(60.0).map(|k| k[0]);
    for method in METHODS {
        for (angle_deg, polariser, expected) in [
            (90.0, None, s),
            (0.0, None, p),
            (90.0, Some("s"), 2.0 * s),
            (0.0, Some("p"), 2.0 * p),
            (0.0, Some("s"), 0.0),
            (90.0, Some("p"), 0.0),
        ] {
            let polariser = polariser.map(|word| format!("viewer.polariser={word}"));
            // Nothing has no relative error.
            let paths = (method == METHODS[1]).then_some("solver.paths=16384");
            let set: Vec<&str> = std::iter::once(method).chain(paths).chain(polariser.as_deref()).collect();
            let found = of(angle_deg, &set) / brighter;
            assert!(
                (found - expected).abs() < 2e-3 * s,
                "{method} {angle_deg} {polariser:?}: {found} {expected}"
            );
        }
    }
}

/// A sky of uniform radiance whose light is polarised.
fn sky(elevation_deg: f64, azimuth_deg: f64) -> String {
    format!(
        "lighting.environment=[{{model=\"sky\",number=5,share=1,polarisation=0.75,sun_elevation_deg={elevation_deg},sun_azimuth_deg={azimuth_deg}}}]"
    )
}

/// A bare display mirrors the sky at 90 deg from the sun, whose light is 0.75 polarised across the plane of the sun, and a
/// sky beside it.
#[test]
fn bare_displays_mirror_a_polarised_sky() {
    for display in everyday(1, ["cover", "face", "panes", "coated"]) {
        let oracle = &oracle(display)[1];
        // The view at phi 0 shows the sky at 45 deg and phi 180. From the sun at (45, 0) that is 90 deg (s); from (90, 90)
        // too, in the plane of incidence (p); from (45, 90) by the spherical law of cosines 60 deg, with the angle
        // between the planes by that of sines.
        let degree = 0.75 * 0.75 / 1.25;
        let turn = (45.0_f64.to_radians().sin() / 60.0_f64.to_radians().sin()).asin();
        for (sun, more_s) in [
            ([45.0, 0.0], 0.75),
            ([1e-6, 90.0], -0.75),
            ([45.0, 90.0], degree * (turn.cos().powi(2) - turn.sin().powi(2))),
        ] {
            let light = sky(sun[0], sun[1]);
            for method in METHODS {
                for (polariser, weights) in
                    [(None, [0.5; 2]), (Some("s"), [1.0, 0.0]), (Some("p"), [0.0, 1.0])]
                {
                    let polariser = polariser.map(|word| format!("viewer.polariser={word}"));
                    let set = ["lighting.diffuse=0", "viewer.theta_deg=45", &light, method];
                    let set: Vec<&str> = set.into_iter().chain(polariser.as_deref()).collect();
                    let found = reflectance(&result(display, &set)).remove(0);
                    for (found, [s, p]) in found.iter().zip(oracle) {
                        let expected = weights[0] * (1.0 + more_s) * s + weights[1] * (1.0 - more_s) * p;
                        assert!(
                            (found - expected).abs() < 1e-5,
                            "{display} {sun:?} {set:?}: {found} {expected}"
                        );
                    }
                }
            }
        }
    }
}

/// Paper below glass in the light of such a sky, whose luminance is the same at all azimuths, and its polarisation only with the sun at the zenith.
/// Sum over inclinations and azimuths by hand; sun and view turned together change nothing.
#[test]
fn paper_below_faces_under_a_polarised_sky() {
    const STEPS: [usize; 2] = [4000, 60];
    // The sky is polarised across the great circle to the sun, at this angle from that to the zenith (spherical law of cosines).
    let more_s = |theta: f64, elevation_deg: f64, apart_deg: f64| {
        let from_zenith = (90.0 - elevation_deg).to_radians();
        let from_sun =
            theta.cos() * from_zenith.cos() + theta.sin() * from_zenith.sin() * apart_deg.to_radians().cos();
        let along = (from_zenith.cos() - theta.cos() * from_sun) / theta.sin();
        0.75 * (2.0 * along * along - (1.0 - from_sun * from_sun)) / (1.0 + from_sun * from_sun)
    };
    let mean = |both: [f64; 2]| 0.5 * (both[0] + both[1]);
    for (number, [elevation_deg, sun_deg, view_deg]) in
        [[90.0, 0.0, 0.0], [10.0, 30.0, 0.0], [10.0, 150.0, 120.0], [45.0, 200.0, 0.0]]
            .into_iter()
            .enumerate()
    {
        let (mut enters, mut as_mean) = (0.0, 0.0);
        for step in 0..STEPS[0] {
            let theta_deg = 90.0 * (step as f64 + 0.5) / STEPS[0] as f64;
            let theta = theta_deg.to_radians();
            let [s, p] = cover(theta_deg).map(|k| k[1]);
            let weight = 2.0 * theta.sin() * theta.cos() * std::f64::consts::FRAC_PI_2 / STEPS[0] as f64;
            let around =
                (0..STEPS[1]).map(|k| more_s(theta, elevation_deg, k as f64 * 360.0 / STEPS[1] as f64));
            let more_s = around.sum::<f64>() / STEPS[1] as f64;
            enters += weight * 0.5 * ((1.0 + more_s) * s + (1.0 - more_s) * p);
            as_mean += weight * 0.5 * (s + p);
        }
        let returned = 1.0 - as_mean / 2.25;
        let light = sky(elevation_deg, sun_deg);
        let through = mean(cover(45.0).map(|k| k[1]));
        let paper = enters * 0.8 / (1.0 - 0.8 * returned) * through / 2.25;
        // And what the glass mirrors, from the other side.
        let more_s = more_s(45.0_f64.to_radians(), elevation_deg, view_deg + 180.0 - sun_deg);
        let [s, p] = cover(45.0).map(|k| k[0]);
        let expected = paper + 0.5 * ((1.0 + more_s) * s + (1.0 - more_s) * p);
        let view = format!("viewer.phi_deg={view_deg}");
        for (set, most) in [
            (&["solver.method=adding", "solver.relative_error=1e-5"][..], 2e-5),
            (
                &["solver.method=monte-carlo", sized("solver.paths=32768", "solver.paths=131072")],
                sized(6e-3, 3e-3),
            ),
        ] {
            let set = [&[PAPER, "lighting.diffuse=0", "viewer.theta_deg=45", &view, &light], set].concat();
            if number > 1 && set.contains(&"solver.method=monte-carlo") {
                continue;
            }
            let found = reflectance(&result("cover", &set)).remove(0)[1];
            assert!((found / expected - 1.0).abs() < most, "{set:?}: {found} {expected}");
        }
    }
}

/// Refusals say where, what and why.
#[test]
fn polarisation_that_is_not_followed_is_refused() {
    let lamp = "lighting.directed=[{theta_deg=60,share=1,polarisation={angle_deg=30}}]";
    for (set, part) in [
        (&["viewer.polariser=s", "solver.approximation=unpolarised"][..], "a polariser is not possible here"),
        (&[lamp, "solver.approximation=unpolarised"], "polarised light is not possible here"),
    ] {
        let set = [&["lighting.diffuse=0", "lighting.illuminance_lx=100"], set].concat();
        let resolved =
            resolved("cover", &if set.contains(&lamp) { set.clone() } else { set[2..].to_vec() }).unwrap();
        let stop = AtomicBool::new(false);
        let control = Control { threads: Some(1), progress: &|_| {}, stop: &stop };
        let error = run(&resolved.scene, &control).unwrap_err();
        let text = resolved.located(&error).unwrap().to_string();
        assert!(text.contains(part), "{text}");
    }
    let without_sun = "lighting.environment=[{model=\"sky\",number=5,share=1,polarisation=0.75}]";
    let text = resolved("cover", &["lighting.diffuse=0", without_sun]).unwrap_err().to_string();
    assert!(text.contains("sun_elevation_deg") && text.contains("plane of the sun"), "{text}");
}

/// A cover glass of 0.5 mm, 0.1 mm above glass of 0.4 mm over paper, with its places.
fn placed(set: &[&str]) -> Resolved {
    let medium = |index: f64, mm: f64| {
        format!("[[display.layers]]\nkind = \"medium\"\nindex = {index}\nthickness_mm = {mm}\n")
    };
    let layers = medium(1.5, 0.5) + &medium(1.0, 0.1) + &medium(1.5, 0.4);
    let paper = "[spectrum]\nrange_nm = [500, 600]\nstep_nm = 50\n[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\n\
        reflectance = { white = 0.8, black = 0.1 }\n[viewer]\ntheta_deg = 60\nfield_deg = 0\n[lighting]\nspectrum = \"E\"\ndiffuse = 1.0\n";
    let set: Vec<String> = set.iter().map(|one| (*one).to_owned()).collect();
    Scenario::from_text(&format!("{paper}{layers}"), "placed", Path::new(""), &set)
        .unwrap()
        .resolve()
        .unwrap()
}

/// Light of frequency f, cycles per mm along the plane of incidence, that leaves towards 60 deg: every reflection between
/// the three faces displaces it. By hand for s and for p.
fn leaving(frequency_per_mm: f64) -> num_complex::Complex64 {
    use num_complex::Complex64;
    let theta = 60.0_f64.to_radians();
    let in_glass = (theta.sin() / 1.5).asin();
    let phase = |mm: f64| std::f64::consts::TAU * frequency_per_mm * 2.0 * mm;
    let [pane, gap] =
        [phase(0.5 * in_glass.tan()), phase(0.1 * theta.tan())].map(|phase| Complex64::cis(-phase));
    let of_each = face(60.0, 1.5).map(|r| {
        let t = 1.0 - r;
        let inside = 1.0 / (1.0 - r * r * pane);
        // The cover from below, and through it.
        let (back, through) = (r + t * t * r * pane * inside, t * t * inside);
        through * t / (1.0 - back * r * gap)
    });
    0.5 * (of_each[0] + of_each[1])
}

/// Light with its places keeps s and p apart through flat layers above paper: the blur of a view by a sum of its own, both
/// solvers, and the light of all places together.
#[test]
fn places_below_flat_layers_keep_s_and_p_apart() {
    let stop = AtomicBool::new(false);
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &stop };
    let resolved = placed(&["solver.relative_error=0.001"]);
    let scene = resolved.scene;
    assert!(note_of_places(&scene).is_none());
    let blur = mtf(&scene, &resolved.patterns, &control).unwrap();
    let (state, error) = (blur.views[0].states.get("white").unwrap(), blur.error_reached);
    let places = |f: f64| blur.frequency_per_mm.iter().position(|one| (one - f).abs() < 1e-9);
    let frequencies = [0.5, 1.0, 2.0];
    let wanted: Vec<[f64; 2]> = frequencies.iter().map(|f| [*f, 0.0]).collect();
    let walked = walk::transfer(&scene, &wanted, sized(1 << 15, 1 << 18), &control).unwrap();
    let [white, _] = ["white", "black"].map(|name| walked[0].states.get(name).unwrap());
    for (k, f) in frequencies.into_iter().enumerate() {
        let expected = leaving(f) / leaving(0.0);
        let [re, im] = white.once.otf[k];
        let close = |found: walk::Mean, expected: f64| {
            (found.value - expected).abs() < 4.5 * found.standard_error + 1e-4
        };
        assert!(close(re, expected.re), "{f}: {re:?} {expected}");
        assert!(close(im, expected.im) || close(im, -expected.im), "{f}: {im:?} {expected}");
        let Some(k_adding) = places(f) else { continue };
        let ([adding, _], [re, _]) = (state.otf.otf_x[k_adding], white.response.otf[k]);
        let most = 4.5 * re.standard_error + 2.0 * error + 1e-3;
        assert!((adding - re.value).abs() < most, "{f}: {adding} {re:?}");
    }
    // The sum of all places.
    let total = run(&scene, &control).unwrap().views[0].states.get("white").unwrap().value.Y;
    let shown = walk::pattern(
        &scene,
        &papilio_transport::walk::places::Uniform { states: 2 },
        sized(1 << 14, 1 << 17),
        &control,
    )
    .unwrap();
    let (via, front) = (shown[0].via_pixel[0], shown[0].front);
    let found = via.value + front.value;
    let allowed = 4.5 * via.standard_error.hypot(front.standard_error) + 1e-3 * total;
    assert!((found - total).abs() < allowed, "{found} +- {allowed}, {total}");
    let mean_scene = placed(&["solver.approximation=unpolarised"]).scene;
    let as_mean = run(&mean_scene, &control).unwrap().views[0].states.get("black").unwrap().value.Y;
    let kept = run(&scene, &control).unwrap().views[0].states.get("black").unwrap().value.Y;
    assert!((as_mean / kept - 1.0).abs() > 0.02, "{as_mean} {kept}");
    let mirror = "display.pixel={model=\"uniform\",kind=\"mirror\",reflectance={white=0.5,black=0.02}}";
    assert!(note_of_places(&placed(&[mirror]).scene).is_none());
    let below_haze =
        "display.layers.0={kind=\"diffuser\",model=\"k-correlation\",width=0.1,transmittance=0.9}";
    assert!(note_of_places(&placed(&[mirror, below_haze]).scene).is_some());
}

/// Sheets of a front of screen in air, `[reflectance, absorptance]` from the top, as one: reflectance from above and from
/// below, and transmittance.
fn sheets(all: &[[f64; 2]]) -> [f64; 3] {
    all.iter().fold([0.0, 0.0, 1.0], |[above, below, through], [r, a]| {
        let (t, series) = (1.0 - r - a, 1.0 / (1.0 - below * r));
        [above + through * through * r * series, r + t * t * below * series, through * t * series]
    })
}

/// Reflectance, transmittance and reflectance from below of sheets above a face of glass, for s and p; all orders, by hand.
fn below_sheets(all: &[[f64; 2]], theta_deg: f64) -> [[f64; 3]; 2] {
    let [above, below, through] = sheets(all);
    face(theta_deg, 1.5).map(|r| {
        let (t, series) = (1.0 - r, 1.0 / (1.0 - below * r));
        [above + through * through * r * series, through * t * series, r + t * t * below * series]
    })
}

/// What the view sees of paper in diffuse light below such sheets and a face, with these weights of s and of p.
fn paper_below_sheets(all: &[[f64; 2]], theta_deg: f64, paper: f64, weights: [f64; 2]) -> f64 {
    const STEPS: usize = 20_000;
    let (mut enters, mut returned) = (0.0, 1.0 - 1.0 / 2.25);
    for step in 0..STEPS {
        let theta_deg = 90.0 * (step as f64 + 0.5) / STEPS as f64;
        let (sin, cos) = theta_deg.to_radians().sin_cos();
        let weight = 2.0 * sin * cos * std::f64::consts::FRAC_PI_2 / STEPS as f64;
        let [[_, t_s, back_s], [_, t_p, back_p]] = below_sheets(all, theta_deg);
        enters += weight * 0.5 * (t_s + t_p);
        returned += weight * 0.5 * (back_s + back_p) / 2.25;
    }
    let leaving = enters * paper / (1.0 - paper * returned) / 2.25;
    let seen = below_sheets(all, theta_deg).map(|[r, t, _]| r + t * leaving);
    weights[0] * seen[0] + weights[1] * seen[1]
}

/// Paper below a bare face and these sheets, in the short form or as a list of layers.
fn paper_with_front(all: &[[f64; 2]], is_list: bool, set: &[&str]) -> Resolved {
    let component = |[r, a]: &[f64; 2]| match is_list {
        true => format!(
            "[[display.layers]]\nkind = \"component\"\nreflectance = {r}\nabsorptance = {a}\n\
             [[display.layers]]\nkind = \"medium\"\nindex = 1\nthickness_mm = 0.1\n"
        ),
        false => format!("[[display.front]]\nreflectance = {r}\nabsorptance = {a}\ngap_mm = 0.1\n"),
    };
    let glass = match is_list {
        true => {
            "[[display.layers]]\nkind = \"fresnel\"\n[[display.layers]]\nkind = \"medium\"\nindex = 1.5\nthickness_mm = 0.4\n"
        }
        false => "[display.glass]\nindex = 1.5\nsurface = \"fresnel\"\nthickness_mm = 0.4\n",
    };
    let rest = "[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\nreflectance = { white = 0.5, black = 0.02 }\n\
        [spectrum]\nrange_nm = [540, 560]\nstep_nm = 10\n[viewer]\ntheta_deg = [60, 70, 80]\nfield_deg = 0\n[lighting]\ndiffuse = 1.0\n";
    let text = all.iter().map(component).collect::<String>() + glass + rest;
    let set: Vec<String> = set.iter().map(|one| (*one).to_owned()).collect();
    Scenario::from_text(&text, "front", Path::new(""), &set).unwrap().resolve().unwrap()
}

/// A front of screen returns to a face what it has reflected, with its shares of s and p: both solvers, with and without
/// a polariser, in both written forms.
#[test]
fn face_below_a_front_keeps_s_and_p_apart() {
    let stop = AtomicBool::new(false);
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &stop };
    // `[view][white, black]`.
    let seen = |resolved: &Resolved| -> Vec<[f64; 2]> {
        let result = run(&resolved.scene, &control).unwrap();
        let of = |state: &str, view: usize| {
            result.views[view].states.get(state).unwrap().value.reflectance_factor.clone().unwrap()[1]
        };
        (0..result.views.len()).map(|view| ["white", "black"].map(|state| of(state, view))).collect()
    };
    let fronts: [&[[f64; 2]]; 2] = [&[[0.3, 0.0]], &[[0.04, 0.05], [0.2, 0.0]]];
    for all in fronts {
        for (polariser, weights) in [(None, [0.5; 2]), (Some("s"), [1.0, 0.0]), (Some("p"), [0.0, 1.0])] {
            let polariser = polariser.map(|word| format!("viewer.polariser={word}"));
            let with = |set: &[&'static str], is_list: bool| {
                let set: Vec<&str> = set.iter().copied().chain(polariser.as_deref()).collect();
                seen(&paper_with_front(all, is_list, &set))
            };
            let exact = ["solver.method=adding", "solver.relative_error=1e-5"];
            let paths = ["solver.method=monte-carlo", sized("solver.paths=16384", "solver.paths=131072")];
            for (set, most) in [(exact, 1e-5), (paths, sized(2e-3, 1e-3))] {
                let found = with(&set, false);
                assert_eq!(found, with(&set, true), "{all:?} {polariser:?} {set:?}");
                for (theta_deg, found) in [60.0, 70.0, 80.0].into_iter().zip(found) {
                    for (paper, found) in [0.5, 0.02].into_iter().zip(found) {
                        let expected = paper_below_sheets(all, theta_deg, paper, weights);
                        assert!(
                            (found / expected - 1.0).abs() < most,
                            "{all:?} {theta_deg} {paper} {polariser:?} {set:?}: {found} {expected}"
                        );
                    }
                }
            }
        }
        // The mean at each reflection is another number.
        let as_mean = seen(&paper_with_front(all, false, &["solver.approximation=unpolarised"]));
        let expected = paper_below_sheets(all, 70.0, 0.02, [0.5; 2]);
        assert!((as_mean[1][1] / expected - 1.0).abs() > 0.004, "{} {expected}", as_mean[1][1]);
    }
}

/// Light with its places keeps s and p apart below a front and a face, too: the mean of pages, patterns, pictures, paths, and
/// pixels below a clear colour filter, by the sum of this file.
#[test]
fn places_at_a_face_below_a_front_keep_s_and_p_apart() {
    let stop = AtomicBool::new(false);
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &stop };
    let all = [[0.3, 0.0]];
    let near = |what: &str, found: f64, expected: f64, most: f64| {
        assert!((found / expected - 1.0).abs() < most, "{what}: {found} {expected}");
    };
    // Three views take as much longer.
    let views = sized(vec![60.0, 80.0], vec![60.0, 70.0, 80.0]);
    let seen_from = format!("viewer.theta_deg={views:?}");
    let papers = [("white", 0.5), ("black", 0.02)];
    // Light of faces is that of no paper.
    let via = |theta_deg: f64, paper: f64| {
        paper_below_sheets(&all, theta_deg, paper, [0.5; 2])
            - paper_below_sheets(&all, theta_deg, 0.0, [0.5; 2])
    };
    let matrix = "display.matrix={pitch_um=10}";
    let wide = "display.matrix={pitch_um=200}";
    let fine = "pattern={kind=[\"stripes\"],period_mm=[0.002]}";
    let exact = "solver.relative_error=1e-4";
    let scenario = paper_with_front(&all, true, &[fine, exact, &seen_from]);
    assert!(note_of_places(&scenario.scene).is_none());
    let blur = mtf(&scenario.scene, &scenario.patterns, &control).unwrap();
    for (view, theta_deg) in blur.views.iter().zip(views.clone()) {
        for (name, paper) in papers {
            let found = view.states.get(name).unwrap().Y_via_pixel;
            near("mtf", found, via(theta_deg, paper), 1e-4);
        }
        // Fine stripes have the mean reflectance.
        near("stripes", view.patterns[0].mean_Y_via_pixel, via(theta_deg, 0.26), 1e-3);
    }
    let scenario = paper_with_front(&all, false, &[wide, exact, "viewer.theta_deg=70"]);
    let figures = crosstalk(&scenario.scene, " ", &control).unwrap();
    let contrast = via(70.0, 0.5) / via(70.0, 0.02);
    near("patch", figures.views[0].patterns[0].values.contrast_ratio_via_pixel.unwrap(), contrast, 1e-4);
    let scenario = paper_with_front(&all, false, &[matrix, exact, &seen_from]);
    let scene = &scenario.scene;
    let page = |state: u8| Picture { count: [4, 4], states: vec![state; 16] };
    // Pixels much smaller than the glass is thick.
    let mixed = Picture { count: [2, 2], states: vec![0, 1, 1, 0] };
    let shown = [page(0), page(1), mixed].map(|one| picture(scene, &one, Precision::FINE, &control).unwrap());
    for (number, theta_deg) in views.iter().copied().enumerate() {
        let seen = shown.each_ref().map(|one| f64::from(one.views[number][0][1]));
        let [white, black] = papers.map(|(_, paper)| paper_below_sheets(&all, theta_deg, paper, [0.5; 2]));
        near("white page", seen[0], white, 1e-4);
        near("black page", seen[1], black, 1e-4);
        let both = shown[2].views[number].iter().map(|colour| f64::from(colour[1])).sum::<f64>() / 4.0;
        near("pixels", both, paper_below_sheets(&all, theta_deg, 0.26, [0.5; 2]), 1e-3);
    }
    // Paths with places.
    let uniform = papilio_transport::walk::places::Uniform { states: 2 };
    let walked = walk::pattern(scene, &uniform, sized(1 << 15, 1 << 18), &control).unwrap();
    for (walked, theta_deg) in walked.iter().zip(views.clone()) {
        for (found, (_, paper)) in walked.via_pixel.iter().zip(papers) {
            let expected = via(theta_deg, paper);
            let most = 4.5 * found.standard_error + 2e-4 * expected;
            assert!((found.value - expected).abs() < most, "{theta_deg} {paper}: {found:?} {expected}");
        }
    }
    // A filter that absorbs nothing, far below the pitch above the pixels.
    let filter = "display.matrix.filter={height_um=0.01,transmittance={red=1.0,green=1.0,blue=1.0}}";
    let methods: [(&[&str], f64); 2] = [
        (&["solver.method=adding", "solver.relative_error=1e-3"], 1e-3),
        (&["solver.method=monte-carlo", sized("solver.paths=16384", "solver.paths=131072")], 4e-3),
    ];
    for (set, most) in methods {
        let filtered = paper_with_front(&all, false, &[&[matrix, filter, &seen_from][..], set].concat());
        let result = run(&filtered.scene, &control).unwrap();
        for (view, theta_deg) in result.views.iter().zip(views.clone()) {
            for (name, paper) in papers {
                let found = view.states.get(name).unwrap().value.reflectance_factor.clone().unwrap()[1];
                near(name, found, paper_below_sheets(&all, theta_deg, paper, [0.5; 2]), most);
            }
        }
    }
    // Glass that absorbs belongs to the filter.
    let tinted =
        ["display.glass.internal_transmittance=0.8", "solver.method=adding", "solver.relative_error=1e-3"];
    let [with, without] = [&[matrix, filter][..], &[]].map(|more| {
        let result = run(
            &paper_with_front(&all, false, &[more, &tinted, &["viewer.theta_deg=70"]].concat()).scene,
            &control,
        )
        .unwrap();
        result.views[0].states.get("black").unwrap().value.Y
    });
    near("tinted", with, without, 1e-3);
}
