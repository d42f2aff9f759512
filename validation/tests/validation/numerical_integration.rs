//! The reference pixel behind its diffuser by numerical integration: an independent method that has neither
//! the sampling, the tables nor the closed forms of the Monte Carlo solver.
use papilio_display::pixel::scan;
use papilio_display::scene::{AngleMedium, Lobe, Scene};
use papilio_validation::{monte_carlo_scenario, run, state};

const INDEX: f64 = 1.5;
const PI: f64 = std::f64::consts::PI;

/// Three wavelengths, without recycling by the front, which the integral does not include.
const COMMON: [&str; 4] = [
    "spectrum.range_nm=[450, 650]",
    "spectrum.step_nm=100",
    "viewer.field_deg=0",
    "solver.relative_error=0.0003",
];

/// Reflectance of `white` against the direction cosine in glass: 8001 angles, with linear interpolation.
struct WhiteReflectance(Vec<f64>);

impl WhiteReflectance {
    const STEPS: usize = 8000;

    fn new(scene: &Scene) -> Self {
        let mut in_glass = scene.clone();
        in_glass.solver.angle_medium = AngleMedium::Glass;
        let thetas: Vec<f64> = (0..=Self::STEPS).map(|k| 90.0 * k as f64 / Self::STEPS as f64).collect();
        let scan = scan(&in_glass, &thetas).unwrap();
        Self(scan.states.into_iter().find(|(name, _)| name == "white").unwrap().1)
    }

    fn at(&self, beta: f64, bin: usize) -> f64 {
        let x = (beta / INDEX).asin() / (0.5 * PI) * Self::STEPS as f64;
        let left = (x as usize).min(Self::STEPS - 1);
        let t = x - left as f64;
        self.0[3 * left + bin] * (1.0 - t) + self.0[3 * (left + 1) + bin] * t
    }
}

fn lobe(width: f64, d2: f64) -> f64 {
    width / (2.0 * PI * (width * width + d2).powf(1.5))
}

/// Returns width and T of the k-correlation diffuser of a scene.
fn diffuser(scene: &Scene) -> (f64, f64) {
    let diffuser = scene.display.panel().unwrap().diffuser().unwrap();
    let Lobe::KCorrelation { width } = diffuser.lobe else { panic!("a k-correlation diffuser") };
    (width, diffuser.transmittance[0])
}

/// Returns transmittance and reflectance of the front of screen, to first order.
fn front(scene: &Scene) -> (f64, f64) {
    let component = scene.display.panel().unwrap().front.remove(0);
    (1.0 - component.reflectance[0] - component.absorptance[0], component.reflectance[0])
}

/// Integrates `g` over the disc |beta| < n, in polar coordinates around `centre`, with
/// radii distributed as the lobe (midpoint rule).
fn around(centre: f64, width: f64, g: impl Fn(f64, f64) -> f64) -> f64 {
    let (rings, spokes) = (1200, 360);
    let mut sum = 0.0;
    for ring in 0..rings {
        let u = (f64::from(ring) + 0.5) / f64::from(rings);
        let radius = width * (1.0 / (u * u) - 1.0).sqrt();
        let mut over_spokes = 0.0;
        for spoke in 0..spokes {
            let phi = 2.0 * PI * (f64::from(spoke) + 0.5) / f64::from(spokes);
            let (x, y) = (centre + radius * phi.cos(), radius * phi.sin());
            if x * x + y * y < INDEX * INDEX {
                over_spokes += g(x, y);
            }
        }
        sum += over_spokes / f64::from(spokes) / lobe(width, radius * radius);
    }
    sum / f64::from(rings)
}

#[test]
fn directed_light_agrees_with_integral() {
    let overrides = ["lighting.diffuse=0.0", "lighting.directed.0.share=1.0"];
    let scene = monte_carlo_scenario("single-pass", &[&COMMON[..], &overrides].concat()).unwrap().scene;
    let reflectance = WhiteReflectance::new(&scene);
    let ((width, t), (front_t, _)) = (diffuser(&scene), front(&scene));
    let (view, light) = (8.0_f64.to_radians().sin(), 20.0_f64.to_radians().sin());
    let result = run(&scene).unwrap();
    let white = state(&result, "white").unwrap();
    for bin in 0..3 {
        // The integrand has two peaks, and each is integrated in coordinates around it.
        let part = |x: f64, y: f64| {
            let from_view = lobe(width, (x - view).powi(2) + y * y);
            let from_light = lobe(width, (x - light).powi(2) + y * y);
            let share = from_view / (from_view + from_light);
            let value = from_view * from_light * reflectance.at(x.hypot(y), bin);
            (value * share, value * (1.0 - share))
        };
        let integral = around(view, width, |x, y| part(x, y).0) + around(light, width, |x, y| part(x, y).1);
        let expected = PI * (front_t * t).powi(2) * integral;
        let (found, error) = (
            white.value.reflectance_factor.as_ref().unwrap()[bin],
            white.standard_error.reflectance_factor.as_ref().unwrap()[bin],
        );
        assert!(error < 1e-3 * found);
        // Five standard errors; the integral itself has converged to 1e-5.
        assert!(
            (found - expected).abs() < 5.0 * error + 2e-5 * expected,
            "{bin}: {found}({error}) against {expected}"
        );
    }
}

#[test]
fn diffuse_light_agrees_with_integral() {
    let overrides = ["lighting.diffuse=1.0", "lighting.directed=[]"];
    let scene = monte_carlo_scenario("single-pass", &[&COMMON[..], &overrides].concat()).unwrap().scene;
    let reflectance = WhiteReflectance::new(&scene);
    let ((width, t), (front_t, front_r)) = (diffuser(&scene), front(&scene));
    let view = 8.0_f64.to_radians().sin();
    let result = run(&scene).unwrap();
    let white = state(&result, "white").unwrap();
    let leaving = EscapeFraction::new(width);
    for bin in 0..3 {
        let integral = around(view, width, |x, y| {
            let beta = x.hypot(y);
            lobe(width, (x - view).powi(2) + y * y) * reflectance.at(beta, bin) * leaving.at(beta)
        });
        let expected = front_r + (front_t * t).powi(2) * integral;
        let (found, error) = (
            white.value.reflectance_factor.as_ref().unwrap()[bin],
            white.standard_error.reflectance_factor.as_ref().unwrap()[bin],
        );
        assert!(error < 1e-3 * found);
        assert!(
            (found - expected).abs() < 5.0 * error + 2e-5 * expected,
            "{bin}: {found}({error}) against {expected}"
        );
    }
}

/// Fraction of a lobe that leaves into the air, integrated over azimuth and tabulated against |beta|.
struct EscapeFraction(Vec<f64>);

impl EscapeFraction {
    const STEPS: usize = 3000;

    fn new(width: f64) -> Self {
        let within = |radius: f64| 1.0 - width / width.hypot(radius);
        let share = |beta: f64| {
            let spokes = 2000;
            let rim = |spoke: i32| {
                let phi = PI * (f64::from(spoke) + 0.5) / f64::from(spokes);
                let half_chord = 1.0 - (beta * phi.sin()).powi(2);
                if half_chord < 0.0 {
                    return 0.0;
                }
                let [near, far] =
                    [-1.0, 1.0].map(|sign| (sign * half_chord.sqrt() - beta * phi.cos()).max(0.0));
                within(far) - within(near)
            };
            (0..spokes).map(rim).sum::<f64>() / f64::from(spokes)
        };
        Self((0..=Self::STEPS).map(|k| share(INDEX * k as f64 / Self::STEPS as f64)).collect())
    }

    fn at(&self, beta: f64) -> f64 {
        let x = beta / INDEX * Self::STEPS as f64;
        let left = (x as usize).min(Self::STEPS - 1);
        self.0[left] + (x - left as f64) * (self.0[left + 1] - self.0[left])
    }
}
