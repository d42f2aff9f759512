//! Paper: a slab without faces against the exact solution of the half-space (Chandrasekhar 1950).

use papilio_validation::{run, scenario};

/// H function of isotropic scattering with this albedo, at the cosines of a Gauss-Legendre rule on 0 to 1, by iteration of
/// `H(mu) (sqrt(1 - albedo) + albedo/2 integral of mu' H(mu')/(mu + mu')) = 1`.
fn h_function(albedo: f64, mu: f64) -> f64 {
    let count = 2000;
    let nodes: Vec<f64> = (0..count).map(|k| (f64::from(k) + 0.5) / f64::from(count)).collect();
    let root = (1.0 - albedo).sqrt();
    let next = |h: &[f64], mu: f64| {
        let sum: f64 = nodes.iter().zip(h).map(|(other, h)| other * h / (mu + other)).sum();
        1.0 / (root + 0.5 * albedo * sum / f64::from(count))
    };
    let mut h = vec![1.0; nodes.len()];
    for _ in 0..60 {
        // The mean of both converges for every albedo below 1.
        h = nodes.iter().zip(&h).map(|(mu, old)| 0.5 * (old + next(&h, *mu))).collect();
    }
    next(&h, mu)
}

/// In diffuse light, a thick slab in air has the reflectance factor `1 - H(mu) sqrt(1 - albedo)`: no face of its own.
#[test]
fn thick_paper_is_the_half_space_of_chandrasekhar() {
    for (albedo, theta_deg) in [(0.9, 8.0), (0.98, 8.0), (0.98, 60.0)] {
        let [albedo_key, theta_key] =
            [format!("display.layers.0.albedo={albedo}"), format!("viewer.theta_deg={theta_deg}")];
        let overrides =
            ["display.layers.0.optical_thickness=100", &albedo_key, &theta_key, "solver.method=\"adding\""];
        let result = run(&scenario("paper", &overrides).unwrap().scene).unwrap();
        let found = result.views[0].states.get("black").unwrap().value.Y;
        let expected = 1.0 - h_function(albedo, f64::to_radians(theta_deg).cos()) * f64::sqrt(1.0 - albedo);
        assert!((found / expected - 1.0).abs() < 2e-3, "{albedo}, {theta_deg}: {found} {expected}");
    }
}
