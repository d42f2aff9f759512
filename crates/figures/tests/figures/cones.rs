//! Tests of conoscopic maps.

use super::*;

/// A conoscopic map of 9 by 24 directions.
fn small_cone() -> ConeResult {
    let every = |count: u32, step: f64| (0..count).map(|k| step * f64::from(k)).collect::<Vec<_>>();
    synthetic::cone(&every(9, 9.0), &every(24, 15.0))
}

#[test]
fn cone_is_drawn_as_labelled_maps() {
    let svg = cone(&small_cone(), TITLE).unwrap();
    assert_texts(&svg, &STATES);
    assert_texts(
        &svg,
        &[
            TITLE,
            "Luminance of white (cd/m\u{b2})",
            "Contrast ratio",
            "Gamut area",
            "Luminance factor Y",
            "Colour shift",
            "270\u{b0}",
            "60\u{b0}",
            "direction of the light",
        ],
    );
    let ConeGrid { theta_deg, phi_deg, .. } = ConeGrid::default();
    let full = cone(&synthetic::cone(&theta_deg, &phi_deg), TITLE).unwrap();
    assert!(full.len() < 1_000_000, "{} bytes", full.len());
}

/// Returns a cone with changed values in all states.
fn cone_with(change: fn(&mut ConeState)) -> ConeResult {
    let mut cone = small_cone();
    cone.views.iter_mut().flat_map(|view| &mut view.states).for_each(change);
    cone
}

#[test]
fn cone_with_invalid_values_is_well_formed() {
    let mut holed = small_cone();
    for view in holed.views.iter_mut().step_by(3) {
        view.contrast_ratio = Some(f64::NAN);
        view.gamut_percent_srgb = None;
        view.states[2].reflectance_factor_y = f64::INFINITY;
        view.states[3].uv_shift = None;
    }
    let mut nothing = small_cone();
    nothing.views.clear();
    let mut short = small_cone();
    short.views.truncate(30);
    short.views.iter_mut().for_each(|view| view.states.truncate(2));
    let mut stateless = small_cone();
    stateless.states.clear();
    let mut many = small_cone();
    many.states = (0..30).map(|k| format!("<{k}> & a long name")).collect();
    let mut lights = small_cone();
    (lights.lights[0].theta_deg, lights.lights[0].phi_deg) = (f64::NAN, f64::INFINITY);
    for broken in [
        holed,
        nothing,
        short,
        stateless,
        many,
        lights,
        cone_with(|state| (state.reflectance_factor_y, state.luminance_cd_m2) = (f64::NAN, f64::NAN)),
        cone_with(|state| (state.reflectance_factor_y, state.luminance_cd_m2) = (0.0, 1e300)),
        cone_with(|state| (state.u_prime, state.uv_shift) = (None, None)),
        cone_with(|state| (state.reflectance_factor_y, state.uv_shift) = (-1e-9, Some(-1.0))),
    ] {
        texts(&cone(&broken, TITLE).unwrap());
        cone_differences(&broken, TITLE).iter().for_each(|svg| _ = texts(svg));
    }
}

#[test]
fn colour_differences_are_drawn_with_their_reference() {
    let svg = cone_differences(&small_cone(), TITLE).unwrap();
    assert_texts(&svg, &STATES);
    let titles =
        ["CIEDE2000 colour difference", "\u{394}E*ab", "\u{394}u\u{2032}v\u{2032}", "along the normal"];
    assert_texts(&svg, &titles);
    let mut aside = small_cone();
    aside.reference_deg = [30.0, 90.0];
    // One direction is far above all others.
    aside.views[40].states[0].delta_e_2000 = Some(900.0);
    let svg = cone_differences(&aside, TITLE).unwrap();
    assert_texts(&svg, &["at 30\u{b0}, azimuth 90\u{b0}", "(up to 900.000)"]);
    let undefined =
        cone_with(|state| (state.uv_shift, state.delta_e_2000, state.delta_e_1976) = (None, None, None));
    assert_eq!(cone_differences(&undefined, TITLE), None);
}

/// The image of the sun in one direction does not determine the scale; its value and its place are stated.
#[test]
fn narrow_mirror_image_does_not_determine_the_scale() {
    let ConeGrid { theta_deg, phi_deg, .. } = ConeGrid::default();
    let mut sun = synthetic::cone(&theta_deg, &phi_deg);
    assert!(!cone(&sun, TITLE).unwrap().contains("up to"));
    for state in &mut sun.views[45].states {
        (state.luminance_cd_m2, state.reflectance_factor_y) = (4.2e7, 5e3);
    }
    let svg = cone(&sun, TITLE).unwrap();
    assert_texts(
        &svg,
        &["up to 4.2×10⁷", "up to 5000", "at 45\u{b0}, azimuth 0\u{b0}", "direction of the view"],
    );
    let texts = texts(&svg);
    assert!(!texts.iter().any(|text| text == "10⁷"), "{texts:?}");
}

/// Directions on a line give no map; half a circle, a few spokes or a ring do.
#[test]
fn directions_without_area_give_no_map() {
    let (some, one) = ([0.0, 20.0, 40.0], [10.0]);
    for (theta, phi) in
        [(&some[..], &one[..]), (&one, &some), (&one, &one), (&some, &[0.0, 180.0]), (&some, &[])]
    {
        assert_eq!(cone(&synthetic::cone(theta, phi), TITLE), None, "{theta:?} {phi:?}");
    }
    for phi in [&[0.0, 45.0, 90.0][..], &[0.0, 90.0, 180.0, 270.0], &[300.0, 330.0]] {
        texts(&cone(&synthetic::cone(&some, phi), TITLE).unwrap());
    }
}
