//! Bare displays whose faces and film keep s and p apart, against the program `tmm`:
//! `validation/films/polarised_oracle.py`.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use papilio_display::result::RunResult;
use papilio_display::{Control, run};
use papilio_scenario::{Resolved, Scenario, ScenarioErrors};

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
    for display in DISPLAYS {
        let own = text.lines().filter_map(|line| line.strip_prefix(display)?.strip_prefix(','));
        let expected: Vec<f64> = own.map(|line| line.split(',').nth(1).unwrap().parse().unwrap()).collect();
        assert_eq!(expected.len(), 4);
        let of =
            |set: &[&str]| reflectance(&result(display, &[&[paper, "lighting.diffuse=1"], set].concat()));
        for (set, most) in [
            (&["solver.relative_error=1e-5"][..], 1e-5),
            (&["solver.method=monte-carlo", "solver.paths=65536"], 2e-3),
        ] {
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
