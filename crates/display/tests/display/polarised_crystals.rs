//! Polarised light onto a liquid crystal, and polarisers before the eye, against sums of Stokes parameters through the reference matrices of optics,
//! which share neither the tables nor the fast implementation; and against closed forms.

use std::f64::consts::PI;
use std::path::Path;

use num_complex::Complex64;
use papilio_display::DisplayError;
use papilio_display::result::RunResult;
use papilio_display::scene::{Pixel, Scene};
use papilio_optics::berreman::{AnisotropicLayer, Dielectric, Mueller, Stack, Wave, mueller};
use papilio_scenario::Scenario;

use crate::common::{run, scenario, walked};

/// Cells and films alone: both implementations agree on them to rounding.
pub(crate) const CELLS: &str = "display.pixel.stack=[{ kind = \"film\", material = 1.7, thickness_nm = 90 }, \
    { kind = \"cell\", gap_um = 1.1, n_o = 1.5, n_e = 1.62, rub_deg = 100, twist_deg = -40, slices = 6, \
      states = { white = { tilt_deg = 25 }, black = { tilt_deg = 70 } } }]";

/// A polariser and a retarder above a cell.
const TWISTED: &str = "display.pixel.stack=[{ kind = \"polariser\", axis_deg = 20 }, \
    { kind = \"retarder\", axis_deg = 60, retardance_nm = 150 }, \
    { kind = \"cell\", gap_um = 2.0, n_o = 1.5, n_e = 1.62, rub_deg = 10, twist_deg = 50, slices = 12, \
      states = { white = { tilt_deg = 5 }, black = { tilt_deg = 60 } } }]";

const GRID: [&str; 2] = ["spectrum.range_nm=[400,700]", "spectrum.step_nm=100"];

fn display(stack: &str, more: &[&str]) -> Scene {
    scenario("mip-lcd", &[&[stack, "viewer.field_deg=0"], &GRID[..], more].concat()).unwrap().scene
}

/// Spectra of the reflectance factor, `[view][state][wavelength]`.
fn spectra(scene: &Scene) -> Vec<Vec<Vec<f64>>> {
    let result = run(scene).unwrap();
    let view = |view: &papilio_display::result::View| {
        view.states.iter().map(|(_, state)| state.value.reflectance_factor.clone().unwrap()).collect()
    };
    result.views.iter().map(view).collect()
}

/// Mueller's matrix of the whole display: a thick pane of each medium above the pixel's layers.
fn whole(scene: &Scene, direction: [f64; 2], state: usize, bin: usize) -> Mueller {
    whole_below_gray(scene, direction, (state, bin), 1.0)
}

/// The same with glass above the pixel that transmits this fraction of light along the normal, once.
pub(crate) fn whole_below_gray(
    scene: &Scene,
    [theta_deg, phi_deg]: [f64; 2],
    (state, bin): (usize, usize),
    transmittance: f64,
) -> Mueller {
    let Pixel::Crystal(pixel) = &scene.display.pixel else { panic!("a liquid crystal") };
    let wavelength_nm = scene.grid.wavelengths_nm()[bin];
    let last = scene.display.layers.len() - 1;
    let panes = scene.display.layers.iter().enumerate().map(|(number, layer)| {
        let depth = if number == last { -transmittance.ln() } else { 0.0 };
        // Of a pane of 1 mm.
        let index = Complex64::new(layer.medium.index[bin], depth * wavelength_nm / (4.0 * PI * 1e6));
        AnisotropicLayer {
            dielectric: Dielectric::uniaxial(index, index, [0.0, 0.0, 1.0]).unwrap(),
            thickness_nm: 1e6,
            coherent: false,
        }
    });
    let layers = pixel.parts.iter().flat_map(|part| {
        let slices = &part.slices[if part.slices.len() == 1 { 0 } else { state }];
        slices.iter().map(|slice| AnisotropicLayer {
            dielectric: Dielectric::biaxial(
                part.indices.each_ref().map(|n: &Vec<Complex64>| n[bin]),
                slice.axes,
            )
            .unwrap(),
            thickness_nm: slice.thickness_nm,
            coherent: part.coherent,
        })
    });
    let layers = panes.chain(layers).collect();
    let stack = Stack { front: 1.0, layers, back: pixel.substrate[bin] };
    let beta = theta_deg.to_radians().sin();
    mueller(&stack, Wave { wavelength_nm, beta, azimuth_deg: phi_deg }).unwrap().r
}

/// Light with these Stokes parameters, seen through a polariser at this angle: over what a perfect white would send through it.
fn seen(matrix: &Mueller, light: [f64; 4], polariser_deg: Option<f64>) -> f64 {
    let [i, q, u] = [0, 1, 2].map(|row: usize| (0..4).map(|k| matrix[row][k] * light[k]).sum::<f64>());
    match polariser_deg.map(|angle| (2.0 * angle).to_radians().sin_cos()) {
        None => i,
        Some((sin, cos)) => i + q * cos + u * sin,
    }
}

const UNPOLARISED: [f64; 4] = [1.0, 0.0, 0.0, 0.0];

/// In diffuse light, at several azimuths; the face of the glass polarises what passes it. Both solvers.
#[test]
fn polariser_before_the_eye_sees_the_sum_of_stokes_parameters() {
    let views = ["viewer.theta_deg=[0,25,60,75]", "viewer.phi_deg=[33,213]"];
    // Of harmonics those below 5e-5 are left out, and thick retarders have the faces of their mean index.
    for (stack, tolerance) in [(CELLS, 6e-4), (TWISTED, 2e-3)] {
        for polariser_deg in [None, Some(0.0), Some(30.0), Some(-75.0)] {
            let set = polariser_deg.map(|angle| format!("viewer.polariser={angle}"));
            let set: Vec<&str> = views.into_iter().chain(set.as_deref()).collect();
            // The table of Monte Carlo, where nothing is polarised and where something is.
            let walks = matches!(polariser_deg, None | Some(30.0));
            for method in
                ["solver.method=adding", "solver.method=monte-carlo"].into_iter().take(1 + usize::from(walks))
            {
                let scene = display(stack, &[&set[..], &[method]].concat());
                let found = spectra(&scene);
                for (view, (theta_deg, phi_deg)) in scene.viewer.directions().enumerate() {
                    for (state, found) in found[view].iter().enumerate() {
                        for (bin, found) in found.iter().enumerate() {
                            let matrix = whole(&scene, [theta_deg, phi_deg], state, bin);
                            let expected = seen(&matrix, UNPOLARISED, polariser_deg);
                            assert!(
                                (found - expected).abs() < tolerance,
                                "{polariser_deg:?} {theta_deg} {phi_deg} {state} {bin}: {found} {expected}"
                            );
                        }
                    }
                }
            }
        }
    }
}

/// Cells below these layers.
fn below(layers: &str, more: &[&str]) -> Scene {
    let (_, stack) = CELLS.split_once('=').unwrap();
    let text = format!(
        "[spectrum]\nrange_nm = [400, 700]\nstep_nm = 100\n[display]\nlayers = [{layers}]\n[display.pixel]\nmodel = \"liquid-crystal\"\n\
         substrate = \"Ag\"\nstack = {}\n[viewer]\nfield_deg = 0\n",
        stack
    );
    let sets: Vec<String> = more.iter().map(|set| (*set).to_owned()).collect();
    Scenario::from_text(&text, "below.toml", Path::new(""), &sets).unwrap().resolve().unwrap().scene
}

const COVER: &str = "{ kind = \"medium\", index = 1.52 }, { kind = \"medium\", index = 1.0 }, { kind = \"medium\", index = 1.5 }";

/// An air-spaced cover glass: three faces, between which and the cell light stays as polarised as it is. Both solvers.
#[test]
fn cells_below_several_faces_are_seen_through_all_of_them() {
    let views = ["viewer.theta_deg=[0,40,70]", "viewer.phi_deg=[33,213]"];
    for polariser in [None, Some(-35.0)] {
        let set = polariser.map(|angle| format!("viewer.polariser={angle}"));
        for method in ["solver.method=adding", "solver.method=monte-carlo"] {
            let set: Vec<&str> = views.into_iter().chain(set.as_deref()).chain([method]).collect();
            let scene = below(COVER, &set);
            let found = spectra(&scene);
            for (view, direction) in scene.viewer.directions().enumerate() {
                for (state, found) in found[view].iter().enumerate() {
                    for (bin, found) in found.iter().enumerate() {
                        let matrix = whole(&scene, [direction.0, direction.1], state, bin);
                        let expected = seen(&matrix, UNPOLARISED, polariser);
                        assert!(
                            (found - expected).abs() < 1e-3,
                            "{method} {polariser:?} {direction:?} {state} {bin}: {found} {expected}"
                        );
                    }
                }
            }
        }
    }
}

/// Below a film that scatters nothing, a face and the cell keep s, p and their phase in the light between them: as without the film, which transmits
/// 0.9 twice.
#[test]
fn faces_between_a_film_and_a_cell_are_followed() {
    let film = "{ kind = \"diffuser\", model = \"k-correlation\", width = 0.05, transmittance = 0.9, regular_fraction = 1 }";
    let glass = "{ kind = \"medium\", index = 1.5 }";
    let views = ["viewer.theta_deg=[0,65]", "viewer.phi_deg=[33]"];
    let of = |layers: &str| spectra(&below(layers, &views));
    let covered = of(&format!("{film}, {{ kind = \"medium\", index = 1.0 }}, {glass}"));
    let bare = of(glass);
    for (covered, bare) in covered.iter().flatten().flatten().zip(bare.iter().flatten().flatten()) {
        assert!((covered - 0.81 * bare).abs() < 1e-3, "{covered} {bare}");
    }
}

/// A polarised lamp at this place, with a mirror image that fills the view at the opposite azimuth.
fn lamp(theta_deg: f64, phi_deg: f64, angle_deg: f64) -> String {
    format!(
        "lighting.directed=[{{theta_deg={theta_deg},phi_deg={phi_deg},radius_deg=2,share=1,\
         polarisation={{degree=1,angle_deg={angle_deg}}}}}]"
    )
}

/// A white surface has the illuminance of a lamp of 2 deg over pi, a mirror the luminance of the lamp.
fn brighter(theta_deg: f64) -> f64 {
    1.0 / (2.0_f64.to_radians().sin().powi(2) * theta_deg.to_radians().cos())
}

/// What is seen of a polarised lamp, by state and wavelength, and the scene.
fn lit(
    stack: &str,
    [theta_deg, phi_deg]: [f64; 2],
    [lamp_deg, polariser_deg]: [f64; 2],
    more: &[&str],
) -> (Scene, Vec<Vec<f64>>) {
    let set = [
        "lighting.diffuse=0".to_owned(),
        lamp(theta_deg, (phi_deg + 180.0) % 360.0, lamp_deg),
        format!("viewer.theta_deg={theta_deg}"),
        format!("viewer.phi_deg={phi_deg}"),
        format!("viewer.polariser={polariser_deg}"),
    ];
    let set: Vec<&str> = set.iter().map(String::as_str).chain(more.iter().copied()).collect();
    let scene = display(stack, &set);
    let found = spectra(&scene).remove(0);
    (scene, found)
}

#[test]
fn polarised_lamp_is_mirrored_with_its_stokes_parameters() {
    for (direction, angles) in
        [([50.0, 70.0], [0.0, 90.0]), ([50.0, 70.0], [40.0, -20.0]), ([70.0, 200.0], [110.0, 45.0])]
    {
        for method in ["solver.method=adding", "solver.method=monte-carlo"] {
            let (scene, found) = lit(CELLS, direction, angles, &[method]);
            for (state, found) in found.iter().enumerate() {
                for (bin, found) in found.iter().enumerate() {
                    // As seen from the lamp: s, and with it U, has the opposite sign in the frame of its light.
                    let (sin, cos) = (2.0 * angles[0]).to_radians().sin_cos();
                    let matrix = whole(&scene, direction, state, bin);
                    let expected = seen(&matrix, [1.0, cos, -sin, 0.0], Some(angles[1]));
                    let found = found / brighter(direction[0]);
                    assert!(
                        (found - expected).abs() < 3e-3,
                        "{direction:?} {angles:?} {state} {bin}: {found} {expected}"
                    );
                }
            }
        }
    }
}

/// Helmholtz: lamp and viewer, each with its polariser, are exchanged.
#[test]
fn lamp_and_viewer_with_their_polarisers_may_be_exchanged() {
    for stack in [CELLS, TWISTED] {
        let (_, there) = lit(stack, [50.0, 70.0], [25.0, -60.0], &[]);
        let (_, back) = lit(stack, [50.0, 250.0], [-60.0, 25.0], &[]);
        let (_, other) = lit(stack, [50.0, 250.0], [25.0, -60.0], &[]);
        let difference = |a: &[Vec<f64>], b: &[Vec<f64>]| {
            let pairs = a.iter().flatten().zip(b.iter().flatten());
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / brighter(50.0)
        };
        assert!(difference(&there, &back) < 1e-6, "{}", difference(&there, &back));
        assert!(difference(&there, &other) > 1e-3, "{}", difference(&there, &other));
    }
}

/// A quarter wave over an ideal mirror is a half wave: it turns the plane of a lamp's light from a to 2 b - a, b its axis, and sunglasses see Malus's
/// law. Angles are counter-clockwise as the viewer sees them, of the lamp as seen from it.
#[test]
fn quarter_wave_over_a_mirror_turns_the_plane_of_polarisation() {
    let stack = "display.pixel.stack=[{ kind = \"retarder\", axis_deg = 25, retardance_nm = 137.5, thickness_um = 400 }]";
    let ideal = [
        "display.glass.surface=ideal-ar",
        "display.pixel.substrate={ n = 0.001, k = 900 }",
        "spectrum.range_nm=[500,600]",
        "spectrum.step_nm=50",
    ];
    for phi_deg in [0.0_f64, 30.0] {
        // The azimuth of the lamp is 180 deg more, which is the same plane.
        for (lamp_deg, polariser_deg) in [(0.0, 50.0), (0.0, -40.0), (70.0, 10.0), (45.0, 90.0)] {
            let turned = 2.0 * 25.0 - (lamp_deg + phi_deg);
            let expected = 2.0 * (polariser_deg + phi_deg - turned).to_radians().cos().powi(2);
            let (_, found) = lit(stack, [0.0, phi_deg], [lamp_deg, polariser_deg], &ideal);
            let found = found[0][1] / brighter(0.0);
            assert!(
                (found - expected).abs() < 0.02,
                "{phi_deg} {lamp_deg} {polariser_deg}: {found} {expected}"
            );
        }
    }
}

/// Through sunglasses, light that a display's own polariser passed last follows Malus's law; light that leaves through a quarter wave above it is
/// circular, and the same at all angles.
#[test]
fn sunglasses_follow_the_last_layer_of_a_display() {
    let polariser = "{ kind = \"polariser\", axis_deg = 35, transmittance = 0.4999, extinction = 1e-6 }";
    let quarter = "{ kind = \"retarder\", axis_deg = 80, retardance_nm = 137.5 }";
    let of = |stack: &str, more: &[&str]| {
        let set = [
            "display.glass.surface=ideal-ar",
            "spectrum.range_nm=[500,600]",
            "spectrum.step_nm=50",
            "lighting.diffuse=1",
            "viewer.theta_deg=0",
            "viewer.phi_deg=0",
        ];
        spectra(&display(&format!("display.pixel.stack=[{stack}]"), &[&set[..], more].concat()))
            .remove(0)
            .remove(0)[1]
    };
    let open = of(polariser, &[]);
    assert!(open > 0.4 && open < 0.5, "{open}");
    for angle_deg in [35.0_f64, 80.0, 125.0, -100.0] {
        let seen = of(polariser, &[&format!("viewer.polariser={angle_deg}")]);
        let malus = 2.0 * open * (angle_deg - 35.0).to_radians().cos().powi(2);
        assert!((seen - malus).abs() < 2e-3, "{angle_deg}: {seen} {malus}");
    }
    let circular = format!("{quarter}, {polariser}");
    let open = of(&circular, &[]);
    for angle_deg in [0.0, 45.0, 100.0] {
        let seen = of(&circular, &[&format!("viewer.polariser={angle_deg}")]);
        assert!((seen - open).abs() < 0.01 * open, "{angle_deg}: {seen} {open}");
    }
}

/// With a field of view, a lamp of some size and a polarised sky.
#[test]
fn solvers_agree_in_polarised_light() {
    let sky = "lighting.environment=[{ model = \"sky\", number = 12, sun_elevation_deg = 40, sun_azimuth_deg = 100, polarisation = 0.75, share = 0.6 }]";
    let common = [
        TWISTED,
        GRID[0],
        GRID[1],
        sky,
        "lighting.diffuse=0.1",
        "lighting.directed=[{theta_deg=30,phi_deg=250,radius_deg=8,share=0.3,polarisation={degree=0.8,angle_deg=30}}]",
        "viewer.theta_deg=[0,32]",
        "viewer.phi_deg=[70]",
        "viewer.field_deg=6",
        "viewer.polariser=20",
        "solver.relative_error=0.002",
    ];
    let adding = spectra(&scenario("mip-lcd", &common).unwrap().scene);
    let paths = spectra(&walked("mip-lcd", &common).unwrap().scene);
    for (adding, paths) in adding.iter().flatten().flatten().zip(paths.iter().flatten().flatten()) {
        assert!((adding - paths).abs() < 0.01 * adding + 1e-4, "{adding} {paths}");
    }
    let unpolarised = [&common[..], &["lighting.environment.0.polarisation=0"]].concat();
    let other = spectra(&scenario("mip-lcd", &unpolarised).unwrap().scene);
    let changes = adding.iter().flatten().flatten().zip(other.iter().flatten().flatten());
    assert!(changes.map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max) > 0.01);
}

/// A plate that is the same at all azimuths, below these layers.
fn round(layers: &str, sets: &[&str]) -> Result<RunResult, DisplayError> {
    let text = format!(
        "[spectrum]\nrange_nm = [400, 720]\nstep_nm = 160\n[display]\nlayers = [{layers}]\n[display.pixel]\nmodel = \"liquid-crystal\"\n\
         substrate = \"Ag\"\nstack = [{{ kind = \"retarder\", plate = \"C\", retardance_nm = 100, thickness_um = 1 }}]\n\
         [viewer]\ntheta_deg = 60\n[solver]\nrelative_error = 0.02\n"
    );
    let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
    run(&Scenario::from_text(&text, "round.toml", Path::new(""), &sets).unwrap().resolve().unwrap().scene)
}

/// Where polarisation is not followed above a liquid crystal, a polariser is refused; above a scatterer it sees what the faces there do to s and p.
#[test]
fn polarisers_are_refused_where_the_light_counts_as_unpolarised() {
    let glass = "{ kind = \"medium\", index = 1.5 }";
    let error = round(glass, &["viewer.polariser=s", "solver.approximation=unpolarised"]).unwrap_err();
    let is_of_solver = error.to_string().contains("solver.approximation");
    assert!(matches!(error, DisplayError::Polarised { .. }) && is_of_solver, "{error}");
    let haze = "{ kind = \"diffuser\", model = \"k-correlation\", haze = 0.5, total_transmittance = 0.9 }";
    let hazy = format!("{glass}, {haze}, {glass}");
    let y = |sets: &[&str]| round(&hazy, sets).unwrap().views[0].states.0[0].1.value.Y;
    let [s, p, both] = [y(&["viewer.polariser=s"]), y(&["viewer.polariser=p"]), y(&[])];
    // One face, at 60 deg: it mirrors 18 % of s and nothing of p.
    assert!((0.5 * (s + p) / both - 1.0).abs() < 0.02 && s > p + 0.03, "{s} {p} {both}");
}
