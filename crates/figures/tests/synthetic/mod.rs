//! A synthetic run: Gaussian reflectances under D65, in several views.

use papilio_colour::{D65_UV, GamutReference, Observer, gamut_percent, peak_nm};
use papilio_display::result::*;
use papilio_display::{ConeLight, ConeResult, ConeState, ConeView};
use papilio_spectra::{Grid, Spectrum, illuminant};

/// A sub-pixel: peak height, centre and width in nm.
const SUB_PIXELS: [(&str, f64, f64, f64); 3] =
    [("red", 0.17, 655.0, 85.0), ("green", 0.19, 535.0, 62.0), ("blue", 0.11, 440.0, 45.0)];
const STATES: [(&str, [bool; 3]); 8] = [
    ("white", [true, true, true]),
    ("black", [false, false, false]),
    ("red", [true, false, false]),
    ("green", [false, true, false]),
    ("blue", [false, false, true]),
    ("cyan", [false, true, true]),
    ("magenta", [true, false, true]),
    ("yellow", [true, true, false]),
];

/// Returns views at these inclinations, with standard errors of this fraction of the values.
pub(crate) fn result(thetas: &[f64], relative_error: f64) -> RunResult {
    let grid = Grid::new(380.0, 780.0, 5.0).unwrap();
    let observer = Observer::new(&grid).unwrap();
    let light = observer.scale_to_illuminance(&illuminant("D65", &grid).unwrap(), 500.0).unwrap();
    let white = light.map(|e| e / std::f64::consts::PI);
    let xyz = observer.xyz(&white);
    let (xy, uv) = (xyz.chromaticity().unwrap(), xyz.uv_prime().unwrap());
    let view = |theta: &f64| view(&grid, &observer, &white, *theta, relative_error);
    RunResult {
        solver: SolverReport {
            chosen_because: None,
            method: "monte-carlo".to_owned(),
            paths: Some(65_536),
            nodes: None,
            level: None,
            degrees_of_freedom: 15,
            target: None,
            relative_error_reached: relative_error,
            is_final: true,
            interrupted: false,
        },
        wavelength_nm: grid.wavelengths_nm(),
        views: thetas.iter().map(view).collect(),
        illuminant: Illuminant {
            radiance_of_white: white.to_vec(),
            x: xy.x,
            y: xy.y,
            u_prime: uv.u,
            v_prime: uv.v,
        },
        reader: Reader {
            age_years: 25.0,
            text_height_mm: 1.6,
            distance_mm: 500.0,
            detail_arcmin: 2.2,
            cycles_per_degree: 13.6,
            is_described: false,
        },
        reference_white: ReferenceWhite::Perfect,
        primaries: ["red", "green", "blue"].map(str::to_owned).to_vec(),
        warnings: vec![],
        notes: vec![],
    }
}

/// Returns the same display over all directions, in light from 20 degrees behind a diffuser.
pub(crate) fn cone(theta_deg: &[f64], phi_deg: &[f64]) -> ConeResult {
    let run = result(theta_deg, 0.0);
    let states: Vec<String> = STATES.iter().map(|(name, _)| (*name).to_owned()).collect();
    let direction = |theta: f64, phi: f64| {
        let (sin, cos) = phi.to_radians().sin_cos();
        (theta.to_radians().sin() * cos, theta.to_radians().sin() * sin)
    };
    let mirror = direction(20.0, 0.0);
    let views =
        phi_deg.iter().flat_map(|phi| run.views.iter().map(move |view| (view, *phi))).map(|(view, phi)| {
            let (x, y) = direction(view.theta_deg, phi);
            let lobe =
                0.5 + 0.3 * 0.1 / ((x - mirror.0).powi(2) + (y - mirror.1).powi(2) + 0.01).powf(1.5) * 0.1;
            let states = states.iter().map(|name| {
                let (here, normal) = (view.states.get(name).unwrap(), run.views[0].states.get(name).unwrap());
                let (here, normal) = (&here.value, &normal.value);
                let (u, v) = (here.u_prime.unwrap(), here.v_prime.unwrap());
                let lab = |of: &StateValues| papilio_colour::Lab {
                    l: of.L_star.unwrap(),
                    a: of.a_star.unwrap(),
                    b: of.b_star.unwrap(),
                };
                ConeState {
                    lab: Some(lab(here)),
                    delta_e_2000: Some(lab(here).delta_e_2000(lab(normal))),
                    delta_e_1976: Some(lab(here).delta_e_1976(lab(normal))),
                    reflectance_factor_y: lobe * here.Y,
                    luminance_cd_m2: lobe * here.luminance_cd_m2,
                    u_prime: Some(u),
                    v_prime: Some(v),
                    uv_shift: Some((u - normal.u_prime.unwrap()).hypot(v - normal.v_prime.unwrap())),
                }
            });
            ConeView {
                contrast_ratio: view.metrics.contrast_ratio.map(|contrast| contrast * lobe.sqrt()),
                gamut_percent_srgb: view.metrics.gamut_percent_srgb,
                gamut_percent_ebu: view.metrics.gamut_percent_ebu,
                states: states.collect(),
            }
        });
    ConeResult {
        theta_deg: theta_deg.to_vec(),
        phi_deg: phi_deg.to_vec(),
        reference_deg: [0.0, 0.0],
        reference_white: ReferenceWhite::Perfect,
        views: views.collect(),
        states: states.clone(),
        views_deg: vec![[8.0, 0.0]],
        lights: vec![ConeLight { theta_deg: -20.0, phi_deg: 0.0, radius_deg: 0.0 }],
        nodes: 0,
        discretisation_error: 0.0,
        row_errors: Default::default(),
        warnings: vec![],
    }
}

fn view(grid: &Grid, observer: &Observer, white: &Spectrum, theta_deg: f64, error: f64) -> View {
    // Interference colours shift to the blue with increasing angle.
    let blue_shift = theta_deg.to_radians().cos().powf(0.5);
    let reflectance = |on: [bool; 3]| {
        Spectrum::from_fn(grid, |nm| {
            let peaks = SUB_PIXELS.iter().zip(on).filter(|(_, on)| *on);
            let bell = |(_, height, centre, width): &(&str, f64, f64, f64)| {
                height * (-((nm - centre * blue_shift) / width).powi(2)).exp()
            };
            0.009 + 0.02 * (-((nm - 395.0) / 40.0).powi(2)).exp() + peaks.map(|(p, _)| bell(p)).sum::<f64>()
        })
    };
    let state = |(name, on): &(&str, [bool; 3])| {
        (name.to_string(), state(grid, observer, white, &reflectance(*on), error))
    };
    let states = Named(STATES.iter().map(state).collect());
    let y = |name: &str| states.get(name).unwrap().value.Y;
    let uv = ["red", "green", "blue"].map(|name| {
        let value = &states.get(name).unwrap().value;
        papilio_colour::UvPrime { u: value.u_prime.unwrap(), v: value.v_prime.unwrap() }
    });
    let (srgb, ebu) = (gamut_percent(uv, GamutReference::Srgb), gamut_percent(uv, GamutReference::Ebu));
    let metrics = |of: f64| ViewMetrics {
        contrast_ratio: Some(of * y("white") / y("black")),
        gamut_percent_srgb: Some(of * srgb),
        gamut_percent_ebu: Some(of * ebu),
        ..ViewMetrics::default()
    };
    View {
        theta_deg,
        phi_deg: 0.0,
        metrics: metrics(1.0),
        visibility_level_in_range: None,
        contrast_margin_in_range: None,
        standard_error: metrics(2.0 * error),
        discretisation_error: None,
        ledger: Named(vec![]),
        states,
    }
}

fn state(grid: &Grid, observer: &Observer, white: &Spectrum, reflectance: &Spectrum, error: f64) -> State {
    let radiance = reflectance.zip_map(white, |r, w| r * w);
    let reference = observer.xyz(white);
    let xyz = observer.xyz(&radiance) * (1.0 / reference.y);
    let lab = xyz.lab(reference * (1.0 / reference.y)).unwrap();
    let (xy, uv) = (xyz.chromaticity().unwrap(), xyz.uv_prime().unwrap());
    let value = StateValues {
        radiance: radiance.to_vec(),
        reflectance_factor: Some(reflectance.to_vec()),
        X: xyz.x,
        Y: xyz.y,
        Z: xyz.z,
        x: Some(xy.x),
        y: Some(xy.y),
        z: Some(1.0 - xy.x - xy.y),
        u_prime: Some(uv.u),
        v_prime: Some(uv.v),
        L_star: Some(lab.l),
        a_star: Some(lab.a),
        b_star: Some(lab.b),
        luminance_cd_m2: observer.luminance(&radiance),
        contrast: None,
        peak_nm: peak_nm(grid, reflectance),
        distance_from_white_uv: None,
        distance_from_d65_uv: Some(uv.distance(D65_UV)),
        hue_rgb: xyz.hue_rgb(),
        metrics: StateMetrics::default(),
        cam16: None,
        by_light: None,
        R_hemi: Some(xyz.y),
        R_dir: vec![],
        R_environment: vec![],
        terms: Terms {
            diffuse: xyz.y,
            directed: vec![],
            environment: vec![],
            front_light: None,
            front_reflection: 0.0,
        },
        specular: vec![],
    };
    let scaled = |share: f64| StateValues {
        reflectance_factor: value
            .reflectance_factor
            .as_ref()
            .map(|factor| factor.iter().map(|v| share * v).collect()),
        radiance: value.radiance.iter().map(|v| share * v).collect(),
        Y: share * value.Y,
        u_prime: value.u_prime.map(|u| 0.3 * share * u),
        v_prime: value.v_prime.map(|v| 0.3 * share * v),
        peak_nm: value.peak_nm.map(|_| 40.0 * share),
        ..value.clone()
    };
    State { standard_error: scaled(error), discretisation_error: None, interpolation_error: None, value }
}
