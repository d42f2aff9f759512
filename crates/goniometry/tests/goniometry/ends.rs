//! Tables that end before the horizon, with holes, and with zeros where nothing was measured: a constant BRDF stays constant.

use std::f64::consts::PI;

use papilio_goniometry::{
    Audit, Channel, Direction, Geometry, MeasuredPart, Preparation, ScatterMode, SpecularGrid, SphericalGrid,
    Symmetry, kernel,
};

fn steps(to: u32, step: usize) -> Vec<f64> {
    (0..=to).step_by(step).map(f64::from).collect()
}

fn part(geometry: Geometry, value: impl Fn(usize, Direction) -> f64) -> MeasuredPart {
    let of_cell = |cell: usize| geometry.directions(cell).map_or(0.0, |[_, to]| value(cell, to));
    let values = (0..geometry.cells()).map(of_cell).collect();
    let (way, channels) = (ScatterMode::FrontReflection, vec![Channel::Monochrome]);
    MeasuredPart { way, channels, geometry, values, tis: Vec::new() }
}

/// Grid of inclinations: light and viewer up to these.
fn inclined(light_deg: u32, viewer_deg: u32) -> Geometry {
    Geometry::Spherical(SphericalGrid {
        theta_i_deg: steps(light_deg, 10),
        phi_i_deg: vec![180.0],
        theta_o_deg: steps(viewer_deg, 5),
        phi_o_deg: (12..=24).map(|k| 15.0 * f64::from(k)).collect(),
    })
}

/// Grid of an imaging sphere, with cells up to this angle from the specular direction.
fn sphere(radial_deg: u32) -> Geometry {
    Geometry::Specular(SpecularGrid {
        rotations_deg: vec![0.0],
        incidences_deg: steps(75, 15),
        azimuths_deg: steps(180, 15),
        radials_deg: steps(radial_deg, 5),
        symmetry: Symmetry::Plane,
    })
}

/// The constant BRDF 0.3 as various instruments write it, with the inclination at which it ends.
fn constants() -> Vec<(&'static str, f64, MeasuredPart)> {
    let all = |_: usize, _: Direction| 0.3;
    let to = |end_deg: f64| move |_: usize, d: Direction| if d.theta_deg <= end_deg { 0.3 } else { 0.0 };
    let holes = |cell: usize, _: Direction| if cell * 7919 % 101 < 5 { f64::NAN } else { 0.3 };
    vec![
        ("to 80 deg", 80.0, part(inclined(80, 80), all)),
        ("to 60 deg", 60.0, part(inclined(60, 60), all)),
        ("to 45 deg", 45.0, part(inclined(40, 45), all)),
        ("with holes", 80.0, part(inclined(80, 80), holes)),
        ("zeros beyond 85 deg", 85.0, part(inclined(80, 90), to(85.5))),
        ("zero at the horizon", 90.0, part(sphere(180), to(89.995))),
        ("sphere, zeros beyond 85 deg", 85.0, part(sphere(180), to(85.001))),
        ("sphere to 60 deg", 90.0, part(sphere(60), all)),
    ]
}

#[test]
fn constants_are_constant_to_the_horizon() {
    let hold = Preparation { extrapolate: Some(1.0), ..Preparation::default() };
    for (name, _, part) in constants() {
        let (scatter, changes) = kernel(&part, 0, &hold, &[]).unwrap();
        for beta in [0.0, 0.3, 0.6, 0.9, 0.99] {
            let total = scatter.albedo_at(beta);
            assert!((total / (0.3 * PI) - 1.0).abs() < 1e-4, "{name}, {beta}: {total}");
        }
        assert!(scatter.width() > 0.5, "{name}: the end of the table is no feature of the lobe");
        assert!((changes.largest - 0.3).abs() < 1e-12, "{name}");
    }
}

/// Without extrapolation, light goes to the measured inclinations only: the total is 0.3 pi sin^2 of the last.
#[test]
fn without_extrapolation_tables_end_where_they_end() {
    for (name, end_deg, part) in constants().into_iter().filter(|(_, end_deg, _)| *end_deg < 90.0) {
        let (scatter, changes) = kernel(&part, 0, &Preparation::default(), &[]).unwrap();
        let expected = 0.3 * PI * end_deg.to_radians().sin().powi(2);
        for beta in [0.0, 0.3, 0.6] {
            let total = scatter.albedo_at(beta);
            assert!((total / expected - 1.0).abs() < 5e-3, "{name}, {beta}: {total} {expected}");
        }
        assert!(scatter.width() > 0.5, "{name}: {}", scatter.width());
        let stated = changes.inclined_to_deg.unwrap();
        assert!((stated - end_deg).abs() < 1.5, "{name}: {stated}");
    }
}

#[test]
fn constants_are_reciprocal_however_they_were_measured() {
    for (name, _, part) in constants() {
        let audit = Audit::of(&part, 0).unwrap();
        let [_, worst] = audit.reciprocity.unwrap();
        assert!(worst < 1e-9, "{name}: {worst}");
    }
}

/// The integral over the measured inclinations, in closed form: c cos^n to 70 deg.
#[test]
fn audit_integrates_over_the_measured_inclinations() {
    for n in [0, 1, 4] {
        let measured = part(inclined(60, 70), |_, to| 0.3 * to.theta_deg.to_radians().cos().powi(n));
        let audit = Audit::of(&measured, 0).unwrap();
        let last_cos = 70.0_f64.to_radians().cos();
        let expected = 0.6 * PI * (1.0 - last_cos.powi(n + 2)) / f64::from(n + 2);
        for incidence in &audit.incidences {
            let ratio = incidence.integral / expected;
            // Steps of 15 deg in azimuth and 5 deg in inclination leave what the audit states.
            let most = 2e-3 + incidence.grid_error.unwrap();
            assert!(
                (ratio - 1.0).abs() < most && most < 0.02,
                "cos^{n} at {}: {ratio} {most}",
                incidence.theta_deg
            );
        }
    }
}

/// A lobe that is dark where it has become faint stays dark: zeros are only doubted where light ends at once.
#[test]
fn lobe_that_fades_stays_dark() {
    let faint = |_: usize, to: Direction| {
        let f = (-(to.theta_deg / 14.0).powi(2)).exp();
        if f < 1e-8 { 0.0 } else { f }
    };
    let part = part(inclined(0, 90), faint);
    let hold = Preparation { extrapolate: Some(1.0), ..Preparation::default() };
    let (_, changes) = kernel(&part, 0, &hold, &[]).unwrap();
    assert_eq!(changes.inclined_to_deg, None);
}
