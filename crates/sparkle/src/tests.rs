//! Rays, closed forms and laws against each other.

use papilio_optics::{Beta, RandomFace};
use papilio_transport::spatial::Gap;

use super::*;

/// Bound of z-scores: probability 7e-6, two-sided.
const SIGMA: f64 = 4.5;

/// A window of 26 x 76 um in pixels of 84 um.
const DUTY: f64 = 0.026 * 0.076 / (0.084 * 0.084);

fn panel(thickness_mm: f64, slope_rms: f64, correlation_mm: f64) -> Panel {
    Panel {
        face: Face::Gaussian(RandomFace { slope_rms, correlation_mm }),
        media: vec![Gap { index: 1.5, thickness_mm }],
        matrix: Matrix::single(0.084, 0.026, 0.076),
        pixel: Pixel::Mirror,
        view: Beta::default(),
        pupil: Pupil::PINHOLE,
        room: Room::uniform(),
    }
}

/// More faces in `cargo xtask full`.
fn effort(pixels: usize) -> Effort {
    let seeds = papilio_testing::seeds().min(200) as usize;
    Effort { replicates: 2 * seeds, pixels: pixels * seeds / 16, samples: 6, seed: 11 }
}

fn run(panel: &Panel, pixels: usize) -> Sparkle {
    Plan::new(panel.clone(), effort(pixels)).unwrap().run()
}

fn gaussian(panel: &Panel) -> RandomFace {
    match panel.face {
        Face::Gaussian(face) => face,
        Face::Relief(_) => panic!("a relief"),
    }
}

fn exact(panel: &Panel) -> f64 {
    let per_slope = Deflection::new(&panel.media, panel.view).per_slope_mm();
    closed::pixel_power_deviation(gaussian(panel), per_slope, &panel.matrix, [0.0; 2]).unwrap()
}

/// With half of the cells' own error, about 0.4/36 of the PPD.
fn assert_deviation(what: &str, found: &Deviation, expected: f64) {
    let tolerance = SIGMA * found.standard_error + 0.2 / 36.0 * expected;
    assert!((found.ppd - expected).abs() < tolerance, "{what}: {found:?}, expected {expected}");
    assert!(found.standard_error < 0.08 * expected, "{what}: {found:?}");
}

/// Thickness, slope, correlation length; PPD of a separate Monte Carlo program (640 pixels: 2.8 %), and for
/// small deflections.
const KNOWN: [(f64, f64, f64, f64, f64); 6] = [
    (0.1, 0.01, 0.008, 0.0090, 0.0091),
    (0.2, 0.01, 0.008, 0.0181, 0.0181),
    (0.7, 0.01, 0.008, 0.0534, 0.0635),
    (0.7, 0.01, 0.015, 0.0884, 0.0870),
    (0.7, 0.03, 0.015, 0.182, 0.261),
    (0.7, 0.03, 0.030, 0.305, 0.369),
];

#[test]
fn known_panels_have_known_deviations() {
    for (thickness, slope, correlation, known, small) in KNOWN {
        let panel = panel(thickness, slope, correlation);
        let what = format!("{thickness} mm, {slope}, {correlation} mm");
        let exact = exact(&panel);
        assert!((exact / known - 1.0).abs() < 3.0 * 0.028 + 0.0001 / known, "{what}: {exact} {known}");
        let found = run(&panel, 320).matrix;
        assert_deviation(&what, &found, exact);
        assert!((found.mean - DUTY).abs() < SIGMA * found.mean_error, "{what}: {found:?}, duty {DUTY}");
        let deflection = Deflection::new(&panel.media, panel.view).per_slope_mm()[0];
        match closed::of_one_window(gaussian(&panel), deflection, 0.026, 0.076, 0.004) {
            Some(form) => {
                assert!((form / exact - 1.0).abs() < 0.05, "{what}: {form} {exact}");
                assert!((form - small).abs() < 6e-5, "{what}: {form} {small}");
            }
            None => assert!((small / exact - 1.0).abs() > 0.03, "{what}: {small} {exact}"),
        }
    }
}

/// A face whose structures are far larger than a window, along the normal and obliquely.
#[test]
fn wide_structures_have_the_deviation_of_their_series() {
    for theta_deg in [0.0, -65.0] {
        let mut panel = panel(0.5, 0.03, 0.2);
        panel.matrix = Matrix::single(0.1, 0.05, 0.07);
        panel.view = Beta::towards(theta_deg, 0.0, 1.0);
        let effort = Effort { replicates: 1200, pixels: 1200, samples: 8, seed: 7 };
        let found = Plan::new(panel.clone(), effort).unwrap().run().matrix;
        // The cells' own error is 0.4/64; statistics have 0.35 %.
        let bound = SIGMA * found.standard_error + 0.4 / 64.0 * found.ppd;
        assert!(
            (found.ppd - exact(&panel)).abs() < bound,
            "{theta_deg}: {found:?}, expected {}",
            exact(&panel)
        );
        assert!(bound < 0.025 * found.ppd, "{found:?}");
    }
}

/// Wherever the form for small deflections is not refused, it is within 5 %.
#[test]
fn form_for_small_deflections_is_refused_beyond_its_range() {
    let mut answers = 0;
    for (width, height) in [(0.02, 0.02), (0.03, 0.07)] {
        for correlation in papilio_testing::sized([0.005, 0.007, 0.01], [0.003, 0.006, 0.01]) {
            for moved in [papilio_testing::sized(0.05, 0.02), 0.15, 0.3] {
                let face = RandomFace { slope_rms: 0.01, correlation_mm: correlation };
                let per_slope = moved * correlation / 0.01;
                let border = 0.5 * (0.084_f64 - width).min(0.084 - height);
                let form = closed::of_one_window(face, per_slope, width, height, border);
                let matrix = Matrix::single(0.084, width, height);
                if let Some(form) = form {
                    let tensor = [per_slope, 0.0, per_slope];
                    let exact = closed::pixel_power_deviation(face, tensor, &matrix, [0.0; 2]).unwrap();
                    assert!(
                        (form / exact - 1.0).abs() < 0.05,
                        "{width} {correlation} {moved}: {form} {exact}"
                    );
                    answers += 1;
                }
            }
        }
    }
    assert!(answers >= 6, "{answers}");
}

/// Stripes of different weight with narrow gaps, seen obliquely: light that misses one window lands on
/// another.
#[test]
fn windows_of_several_weights_have_deviation_of_their_series() {
    let mut panel = panel(0.7, 0.02, 0.012);
    panel.view = Beta::towards(35.0, 0.0, 1.0);
    let stripe = |k: f64, weight| Window {
        rectangle_mm: [0.001 + 0.028 * k, 0.003, 0.027 + 0.028 * k, 0.081],
        weight,
    };
    panel.matrix.windows = vec![stripe(0.0, 0.2), stripe(1.0, 0.7), stripe(2.0, 0.1)];
    panel.matrix.background = 0.05;
    assert_deviation("stripes", &run(&panel, 320).matrix, exact(&panel));
    // The same at an azimuth of 90 deg has other values; in between there is no closed form.
    panel.view = Beta::towards(35.0, 90.0, 1.0);
    assert_deviation("stripes from above", &run(&panel, 320).matrix, exact(&panel));
    let between = Deflection::new(&panel.media, Beta::towards(35.0, 45.0, 1.0)).per_slope_mm();
    assert!(closed::pixel_power_deviation(gaussian(&panel), between, &panel.matrix, [0.0; 2]).is_none());
}

/// Small deflections have deviations in proportion, also where edges of windows meet within the correlation
/// length: their overlaps change within the deflection there, which the rule has to resolve.
#[test]
fn closed_form_is_linear_in_small_deflections() {
    let stripe = |k: f64, weight| Window {
        rectangle_mm: [0.001 + 0.028 * k, 0.003, 0.027 + 0.028 * k, 0.081],
        weight,
    };
    let windows = vec![stripe(0.0, 0.2), stripe(1.0, 0.7), stripe(2.0, 0.1)];
    // Long correlations take long.
    let matrix = Matrix { windows, ..Matrix::single(0.084, 0.026, 0.076) };
    for correlation_mm in papilio_testing::everyday(1, [0.008, 0.03, 0.02]) {
        let face = RandomFace { slope_rms: 0.005, correlation_mm };
        let at = |per_slope: f64| {
            closed::pixel_power_deviation(face, [per_slope, 0.0, per_slope], &matrix, [0.0; 2]).unwrap()
        };
        let ratio = at(0.04) / at(0.02);
        assert!((ratio - 2.0).abs() < 2e-3, "{correlation_mm}: {ratio}");
    }
}

/// A pupil blurs the windows as a disc. Here its image is twice as wide as a window: 0.0330(3) of a separate Monte Carlo program, and
/// 0.0367(3) of a Gaussian of the same mean square.
#[test]
fn pupil_lowers_sparkle() {
    let mut panel = panel(3.0, 0.01, 0.008);
    let pinhole = exact(&panel);
    panel.pupil = Pupil { diameter_mm: 8.0, distance_mm: 300.0 };
    let view = Deflection::new(&panel.media, panel.view);
    let blur = view.blur_mm(&panel.pupil);
    let lower =
        closed::pixel_power_deviation(gaussian(&panel), view.per_slope_mm(), &panel.matrix, blur).unwrap();
    assert!(lower < 0.9 * pinhole, "{lower} {pinhole}");
    let found = run(&panel, 320).matrix;
    // Three standard errors of that program, 1 % each, and the deflections that are not small. A Gaussian is 11 % off.
    assert!((lower / 0.0330 - 1.0).abs() < 0.04, "{lower}");
    assert!((found.ppd - lower).abs() < SIGMA * found.standard_error + 0.03 * lower, "{found:?} {lower}");
}

/// Seen obliquely, a pupil is foreshortened along the plane of view, and blurs the windows less there: rays and closed form agree, for
/// windows whose short side is along this plane, and across it. A pupil that is not foreshortened would blur 2.4 times as much.
#[test]
fn oblique_pupil_is_foreshortened() {
    let mut panel = panel(1.0, 0.004, 0.008);
    panel.pupil = Pupil { diameter_mm: 10.0, distance_mm: 300.0 };
    for phi_deg in [0.0, 90.0] {
        panel.view = Beta::towards(65.0, phi_deg, 1.0);
        let view = Deflection::new(&panel.media, panel.view);
        let blurred = |blur| {
            closed::pixel_power_deviation(gaussian(&panel), view.per_slope_mm(), &panel.matrix, blur).unwrap()
        };
        let blur = view.blur_mm(&panel.pupil);
        let (lower, wrong) =
            (blurred(blur), blurred([0, 2].map(|k| 0.5 * panel.pupil.radius() * view.place_per_beta_mm[k])));
        let found = run(&panel, 320).matrix;
        // Within the standard errors and 3 %, for cells and for deflections that are not small.
        assert!((found.ppd - lower).abs() < SIGMA * found.standard_error + 0.03 * lower, "{found:?} {lower}");
        assert!(
            phi_deg > 0.0 || lower - wrong > SIGMA * found.standard_error + 0.02 * lower,
            "{lower} {wrong}"
        );
    }
}

/// Small deflections through the oblique disc of a pupil, by an integral in the plane that knows nothing of Gaussians or of the
/// transform of a disc: the light of a window whose edges are blurred is the mean over points of the pupil, its variance the double integral of
/// the correlation of the slopes.
#[test]
fn disc_of_an_oblique_pupil_has_its_own_sparkle() {
    let mut panel = panel(1.0, 1e-4, 0.012);
    panel.matrix = Matrix::single(0.084, 0.026, 0.04);
    panel.pupil = Pupil { diameter_mm: 12.0, distance_mm: 300.0 };
    for phi_deg in [0.0, 90.0] {
        panel.view = Beta::towards(65.0, phi_deg, 1.0);
        let view = Deflection::new(&panel.media, panel.view);
        let (k, blur) = (view.per_slope_mm(), view.blur_mm(&panel.pupil));
        let found = closed::pixel_power_deviation(gaussian(&panel), k, &panel.matrix, blur).unwrap();
        // The four edges of the window, in steps, each moved to the points of the pupil: places and normals times K.
        let pupil: Vec<[f64; 2]> = deflection::directions(panel.view, panel.pupil.radius(), 3)
            .into_iter()
            .map(|beta| view.shift(beta))
            .collect();
        let step = 0.002;
        let mut edges: Vec<([f64; 2], [f64; 2])> = Vec::new();
        for (axis, length, width) in [(0, 0.04, 0.026), (1, 0.026, 0.04)] {
            for side in [-1.0, 1.0] {
                let count = (length / step) as i32;
                for n in 0..count {
                    let along = (f64::from(n) + 0.5) * step - 0.5 * length;
                    let across = 0.5 * side * width;
                    let (place, normal) = if axis == 0 {
                        ([across, along], [side * k[0], 0.0])
                    } else {
                        ([along, across], [0.0, side * k[2]])
                    };
                    edges.push((place, normal.map(|part| part * step)));
                }
            }
        }
        let pairs = pupil.iter().flat_map(|one| pupil.iter().map(move |other| (one, other)));
        let apart: Vec<[f64; 2]> = pairs.map(|(one, other)| [one[0] - other[0], one[1] - other[1]]).collect();
        let mut variance = 0.0;
        for (at, one) in &edges {
            for (place, other) in &edges {
                for offset in &apart {
                    let r = [0, 1].map(|axis| at[axis] - place[axis] + offset[axis]);
                    let [xx, xy, yy] = gaussian(&panel).slope_correlation(r);
                    variance +=
                        one[0] * (xx * other[0] + xy * other[1]) + one[1] * (xy * other[0] + yy * other[1]);
                }
            }
        }
        let expected = 1e-4 * (variance / apart.len() as f64).sqrt() / (0.026 * 0.04);
        assert!((found / expected - 1.0).abs() < 0.01, "{phi_deg}: {found} {expected}");
    }
}

#[test]
fn uniform_plane_in_uniform_light_has_no_sparkle() {
    let mut panel = panel(0.7, 0.03, 0.015);
    panel.matrix.windows[0].rectangle_mm = [0.0, 0.0, 0.084, 0.084];
    panel.pupil = Pupil { diameter_mm: 4.0, distance_mm: 400.0 };
    for view in [Beta::default(), Beta::towards(60.0, 30.0, 1.0)] {
        panel.view = view;
        let found = run(&panel, 64);
        for deviation in [found.all, found.matrix, found.source] {
            assert_eq!((deviation.ppd, deviation.standard_error), (0.0, 0.0));
        }
        assert!((found.matrix.mean - 1.0).abs() < 1e-12);
    }
}

#[test]
fn mean_transfer_is_that_of_gaussian_deflections() {
    let face = RandomFace { slope_rms: 0.02, correlation_mm: 0.01 };
    let per_slope = Deflection::new(&[Gap { index: 1.5, thickness_mm: 0.6 }], Beta::default()).per_slope_mm();
    // 0.2 mm per slope: a deflection of 4 um; at 10 cycles per mm exp(-2 pi^2 0.04^2).
    let found = closed::mean_transfer(face, per_slope, [10.0, 0.0]);
    assert!((found - (-2.0 * (std::f64::consts::PI * 0.04).powi(2)).exp()).abs() < 1e-12);
}

/// A beam of light with the direction of the view: its image in a flat panel.
fn mirrored(panel: &Panel, radius_deg: f64) -> Room {
    let source = Source { beta: panel.view, radius_deg, illuminance: 1.0 };
    Room { diffuse: 0.0, sources: vec![source] }
}

/// Along the normal, light enters where it leaves: both refractions add, and the slopes of rays have a normal
/// distribution of 2 (n - 1) times the slope. The mean is the fraction of rays that find the source, over its
/// solid angle.
#[test]
fn image_of_source_along_normal_has_known_mean() {
    let mut panel = panel(0.05, 0.01, 0.02);
    for radius_deg in [0.3, 1.0] {
        panel.room = mirrored(&panel, radius_deg);
        let found = run(&panel, 160);
        let radius = radius_deg.to_radians().sin();
        let fraction = 1.0 - (-0.5 * (radius / 0.01).powi(2)).exp();
        let source = found.source;
        let expected = fraction / (radius * radius);
        // At a distance of 2 K m slopes differ slightly.
        let tolerance = SIGMA * source.mean_error + 0.01 * expected;
        assert!((source.mean - expected).abs() < tolerance, "{radius_deg}: {source:?} {expected}");
        assert!(source.ppd > 0.05 && found.all.ppd > found.matrix.ppd, "{found:?}");
    }
}

/// Obliquely, light leaves far from where it entered: slopes are independent, and the directions have the
/// variance of two faces.
#[test]
fn image_of_source_at_20_deg_has_known_mean() {
    let mut panel = panel(0.7, 0.02, 0.015);
    panel.view = Beta::towards(20.0, 0.0, 1.0);
    panel.pupil = Pupil { diameter_mm: 4.0, distance_mm: 400.0 };
    let view = Deflection::new(&panel.media, panel.view);
    let cosine = 20.0_f64.to_radians().cos();
    // The pupil adds the mean square of its own directions.
    let spread = (2.0_f64.sqrt() * view.bend * 0.02).hypot(0.5 * panel.pupil.radius());
    // The sun is smaller than the change of the direction over a cell.
    for radius_deg in [0.265_f64, 0.8] {
        panel.room = mirrored(&panel, radius_deg);
        let found = run(&panel, 160).source;
        let radius = radius_deg.to_radians().sin();
        // The density of directions over the foreshortened disc.
        let points = 2000;
        let density = |k: usize| {
            let r = (k as f64 + 0.5) / points as f64;
            let around = (0..64).map(|turn| {
                let (sin, cos) = (std::f64::consts::TAU * (f64::from(turn) + 0.5) / 64.0).sin_cos();
                let square = (radius * r).powi(2) * ((cosine * cos).powi(2) + sin * sin);
                (-0.5 * square / (spread * spread)).exp()
            });
            2.0 * r * around.sum::<f64>() / 64.0
        };
        let mean = (0..points).map(density).sum::<f64>() / points as f64;
        // Area of the disc in direction cosines times the density, over radius^2 cosine.
        let expected = mean / (2.0 * spread * spread);
        assert!(
            (found.mean - expected).abs() < SIGMA * found.mean_error + 0.02 * expected,
            "{found:?} {expected}"
        );
    }
}

#[test]
fn larger_sources_and_pupils_sparkle_less() {
    let mut panel = panel(0.7, 0.02, 0.015);
    panel.view = Beta::towards(20.0, 0.0, 1.0);
    let mut last = f64::INFINITY;
    for (radius_deg, diameter_mm) in [(0.5, 0.0), (0.5, 8.0), (1.0, 8.0), (2.0, 8.0), (8.0, 8.0)] {
        panel.room = mirrored(&panel, radius_deg);
        panel.pupil = Pupil { diameter_mm, distance_mm: 400.0 };
        let found = run(&panel, 64).source.ppd;
        assert!(found < 0.95 * last, "{radius_deg} {diameter_mm}: {found}, before {last}");
        last = found;
    }
    // All rays find the largest source.
    assert!(last < 1e-6, "{last}");
}

/// The irradiance below a face has the mean of the light on it, where light and view meet different facets.
/// Where they meet the same ones, bright places are seen more often.
#[test]
fn paper_in_directed_light_has_known_mean() {
    let mut panel = panel(0.7, 0.03, 0.015);
    panel.pixel = Pixel::Lambertian;
    panel.room = mirrored(&panel, 0.5);
    let same = run(&panel, 160).source;
    assert!(same.mean > 1.0 + SIGMA * same.mean_error, "{same:?}");
    panel.room.sources[0].beta = Beta::from_source(40.0, 0.0, 1.0);
    let other = run(&panel, 160).source;
    assert!((other.mean - 1.0).abs() < SIGMA * other.mean_error && other.ppd > 0.01, "{other:?}");
    assert!(other.mean_error < 0.02, "{other:?}");
}

#[test]
fn impossible_panels_are_refused() {
    let good = panel(0.7, 0.03, 0.015);
    let with = |change: &dyn Fn(&mut Panel)| {
        let mut panel = good.clone();
        change(&mut panel);
        Plan::new(panel, Effort::default()).err()
    };
    assert!(with(&|_| {}).is_none());
    let range = |error: Option<SparkleError>| matches!(error, Some(SparkleError::Range { .. }));
    let other = |slope_rms, correlation_mm| {
        with(&move |panel| panel.face = Face::Gaussian(RandomFace { slope_rms, correlation_mm }))
    };
    assert!(range(other(0.0, 0.015)));
    assert!(range(other(0.03, f64::NAN)));
    assert!(range(with(&|panel| panel.view = Beta { x: 1.0, y: 0.0 })));
    assert!(range(with(&|panel| panel.matrix.windows[0].rectangle_mm[2] = 1.0)));
    assert!(range(with(&|panel| panel.matrix.windows.clear())));
    assert!(range(with(&|panel| panel.matrix.pitch_mm[1] = 0.0)));
    assert!(range(with(&|panel| panel.room.diffuse = 0.0)));
    assert!(range(with(&|panel| panel.media[0].index = 1.0)));
    // A thousandth of a pixel.
    let error = other(0.03, 8.4e-5).unwrap();
    assert!(
        matches!(error, SparkleError::TooFine { .. }) && error.to_string().contains("correlation length")
    );
}

#[test]
fn same_seed_gives_same_bits() {
    let plan = |seed| Plan::new(panel(0.7, 0.03, 0.015), Effort { seed, ..effort(32) }).unwrap();
    assert_eq!(plan(1).replicate(3), plan(1).replicate(3));
    assert_ne!(plan(1).replicate(3), plan(2).replicate(3));
}
