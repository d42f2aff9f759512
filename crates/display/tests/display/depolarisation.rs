//! Scatterers that keep the shares of s and p (`depolarisation` below 1).

use papilio_display::scene::Scene;

use crate::common::{run, scenario, walked};

/// A bare substrate of n = 4 as the pixel: its reflectances are Fresnel's.
const SUBSTRATE: &str = "display.pixel={ model = \"film\", substrate = { n = 4, k = 0 }, area = { red = 1.0 }, gap_nm = { red = 0, dark = 0 }, \
    film = [{ material = \"air\", thickness_nm = \"gap\" }], default_states = false, states = { white = { red = 1.0 } } }";

const GRID: [&str; 3] = ["spectrum.range_nm=[500,600]", "spectrum.step_nm=50", SUBSTRATE];

/// Reflectance factor of the first view and state at the first wavelength.
fn first(scene: &Scene) -> f64 {
    let result = run(scene).unwrap();
    let (_, state) = result.views[0].states.iter().next().unwrap();
    state.value.reflectance_factor.as_ref().unwrap()[0]
}

fn of(sets: &[&str]) -> f64 {
    first(&scenario("reference-pixel", &[&GRID[..], sets].concat()).unwrap().scene)
}

/// A white lobe above a mirror: uniform light of all directions of the air comes down, and returns by r of s or of p.
#[test]
fn lambertian_diffuser_shows_the_mean_reflectance_of_each_polarisation() {
    let mean = |polarisation: usize| {
        let steps = 2000;
        let r = |k: i32| {
            let square = (f64::from(k) + 0.5) / f64::from(steps);
            let [c1, c2] = [1.5, 4.0].map(|n: f64| (1.0 - square / (n * n)).sqrt());
            let [a, b] = if polarisation == 0 { [1.5 * c1, 4.0 * c2] } else { [4.0 * c1, 1.5 * c2] };
            ((a - b) / (a + b)).powi(2)
        };
        (0..steps).map(r).sum::<f64>() / f64::from(steps)
    };
    let [s, p] = [mean(0), mean(1)];
    let diffuser = "display.diffuser={ model = \"lambertian\", transmittance = 1, depolarisation = D }";
    for (depolarisation, polariser, expected) in [
        ("0", "s", s),
        ("0", "p", p),
        ("0", "30", 0.25 * s + 0.75 * p),
        ("1", "s", 0.5 * (s + p)),
        ("0.3", "s", 0.5 * (s + p) + 0.35 * (s - p)),
    ] {
        let sets = [
            diffuser.replace("= D", &format!("= {depolarisation}")),
            format!("viewer.polariser={polariser}"),
            "solver.angle_medium=air".to_owned(),
        ];
        let found = of(&sets.each_ref().map(String::as_str));
        assert!((found - expected).abs() < 1e-6, "{depolarisation} {polariser}: {found} {expected}");
    }
}

/// The limit of a narrow lobe is no lobe: a flat display that keeps s and p, or one that takes their mean at each face.
#[test]
fn narrow_lobe_is_a_flat_display() {
    let layers = |lobe: &str| {
        format!(
            "display.layers=[{{ kind = \"medium\", index = 1.5 }}, {lobe} {{ kind = \"medium\", index = 1.5 }}]"
        )
    };
    let narrow = |depolarisation: f64| {
        layers(&format!(
            "{{ kind = \"diffuser\", model = \"ward\", alpha = 0.01, transmittance = 1, depolarisation = {depolarisation} }},"
        ))
    };
    let without_glass = |layers: &str, more: &[&str]| {
        let own = ["viewer.theta_deg=60", "viewer.field_deg=0", layers];
        first(&scenario("sunglasses", &[&GRID[..], &own, more].concat()).unwrap().scene)
    };
    for more in [&["viewer.polariser=s"][..], &["viewer.polariser=p"]] {
        let flat = without_glass(&layers(""), more);
        let kept = without_glass(&narrow(0.0), more);
        assert!((kept / flat - 1.0).abs() < 2e-3, "{kept} {flat}");
    }
    let mean = without_glass(&narrow(1.0), &["viewer.polariser=s"]);
    assert!((mean / without_glass(&layers(""), &["viewer.polariser=s"]) - 1.0).abs() > 0.01, "{mean}");
}

/// The two solvers, with polarised light of a lamp and a polariser, below a face that sends light back to the diffuser.
#[test]
fn monte_carlo_agrees_with_adding() {
    let sets = [
        &GRID[..],
        &[
            "display.layers=[{ kind = \"medium\", index = 1.5 }, \
             { kind = \"diffuser\", model = \"k-correlation\", width = 0.2, transmittance = 0.9, depolarisation = 0 }, { kind = \"medium\", index = 1.5 }]",
            "lighting={ diffuse = 0.5, directed = [{ theta_deg = -50, phi_deg = 0, share = 0.5, polarisation = { degree = 0.8, angle_deg = 90 } }] }",
            "viewer.theta_deg=40",
            "viewer.polariser=p",
            "solver.relative_error=0.001",
        ],
    ]
    .concat();
    let adding = run(&scenario("sunglasses", &sets).unwrap().scene).unwrap();
    let paths = run(&walked("sunglasses", &sets).unwrap().scene).unwrap();
    let values = |result: &papilio_display::result::RunResult| {
        let state = result.views[0].states.get("white").unwrap();
        (state.value.Y, state.standard_error.Y)
    };
    let ((adding, _), (paths, error)) = (values(&adding), values(&paths));
    assert!((adding - paths).abs() < 4.0 * error && error < 0.002 * adding, "{adding} {paths} {error}");
}

/// 1 is the default, to the last bit.
#[test]
fn one_is_the_default() {
    let diffuser = |more: &str| {
        format!("display.diffuser={{ model = \"k-correlation\", width = 0.1, transmittance = 0.9{more} }}")
    };
    let air = "solver.angle_medium=air";
    let usual = of(&[&diffuser(""), air]);
    assert_eq!(usual.to_bits(), of(&[&diffuser(", depolarisation = 1"), air]).to_bits());
}

#[test]
fn what_is_not_followed_is_refused() {
    let lobe = "{ kind = \"diffuser\", model = \"k-correlation\", width = 0.1, transmittance = 0.9, depolarisation = D }";
    let glass = "{ kind = \"medium\", index = 1.5 }";
    let kept = lobe.replace("= D", "= 0");
    for (layers, more, expected) in [
        (
            format!("[{glass}, {}, {glass}]", lobe.replace("= D", "= 0.5")),
            "viewer.theta_deg=8",
            "a value of 0 or 1",
        ),
        (
            format!("[{kept}, {glass}, {}, {glass}]", lobe.replace("= D", "= 1")),
            "viewer.theta_deg=8",
            "no other scatterer",
        ),
        (
            format!("[{kept}, {glass}]"),
            "display.pixel={ model = \"uniform\", kind = \"lambertian\", reflectance = { white = 0.5 } }",
            "a pixel that is a mirror",
        ),
    ] {
        let layers = format!("display.layers={layers}");
        let scene = scenario("sunglasses", &[&layers, "viewer.polariser=s", more]).unwrap().scene;
        let message = run(&scene).unwrap_err().to_string();
        assert!(message.contains("depolarisation") && message.contains(expected), "{message}");
    }
}

/// A described reflection of zero is none.
#[test]
fn reflection_of_zero_is_no_reflection() {
    let with = |reflection: &str| {
        let diffuser = format!(
            "display.diffuser={{ model = \"k-correlation\", width = 0.2, transmittance = 0.9, depolarisation = 0.4{reflection} }}"
        );
        of(&[&diffuser, "solver.angle_medium=air", "viewer.polariser=s", "viewer.theta_deg=40"])
    };
    let zero = ", reflection = { model = \"lambertian\", reflectance = 0.0 }";
    assert_eq!(with(""), with(zero));
}

/// A polariser and a lamp between s and p, where nothing but scattered light is seen: what comes in has the fractions of s and p of the lamp,
/// what leaves those of the polariser, so that X of any angles is bilinear in sin² of both.
#[test]
fn oblique_polarisers_and_lamps_are_computed_where_all_light_is_scattered() {
    let paper = "display={ layers = [{ kind = \"component\", reflectance = 0.05 }, \
         { kind = \"coating\", film = [{ material = { n = 1.38 }, thickness_nm = 100 }] }, { kind = \"medium\", index = 1.5 }], \
         pixel = { model = \"uniform\", kind = \"lambertian\", reflectance = { white = 0.7, black = 0.03 } } }";
    let seen = |polariser_deg: f64, lamp_deg: f64, view_deg: f64, radius: &str| {
        let lamp = format!(
            "lighting.directed=[{{ theta_deg = -60, phi_deg = 130, share = 1.0{radius}, polarisation = {{ degree = 1, angle_deg = {lamp_deg} }} }}]"
        );
        let (view, polariser) =
            (format!("viewer.theta_deg={view_deg}"), format!("viewer.polariser={polariser_deg}"));
        let grid = [
            "spectrum.range_nm=[500,600]",
            "spectrum.step_nm=50",
            "solver.angle_medium=air",
            "viewer.phi_deg=130",
            "lighting.diffuse=0",
        ];
        let sets = [&[paper, &*lamp, &*view, &*polariser][..], &grid].concat();
        run(&scenario("reference-pixel", &sets).unwrap().scene).map(|result| {
            result.views[0].states.get("white").unwrap().value.reflectance_factor.clone().unwrap()[1]
        })
    };
    let square = |angle_deg: f64| angle_deg.to_radians().sin().powi(2);
    let corner = |polariser_deg: f64, lamp_deg: f64| seen(polariser_deg, lamp_deg, 30.0, "").unwrap();
    let [[pp, ps], [sp, ss]] =
        [0.0, 90.0].map(|polariser_deg| [0.0, 90.0].map(|lamp_deg| corner(polariser_deg, lamp_deg)));
    let (s_out, s_in) = (square(30.0), square(25.0));
    let expected = (1.0 - s_out) * ((1.0 - s_in) * pp + s_in * ps) + s_out * ((1.0 - s_in) * sp + s_in * ss);
    let found = corner(30.0, 25.0);
    assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    assert!((pp / ss - 1.0).abs() > 0.05, "{pp} {ss}");
}
