use std::f64::consts::{FRAC_1_SQRT_2, PI};
use std::ops::Range;

use papilio_optics::interface::fresnel_reflectance;

use super::super::{rows, stripes};
use super::*;
use papilio_optics::Beta;

fn fresnel(beta: f64) -> f64 {
    fresnel_reflectance(1.5, 1.0, beta)
}

fn pixels<'a>(windows: &'a [Window], transmittance: &'a [Vec<f64>], thickness_mm: f64) -> FilteredPixels<'a> {
    FilteredPixels {
        pitch_mm: [1.0; 2],
        columns: 1,
        windows,
        transmittance,
        between: &[1.0],
        height_mm: 0.0,
        thickness_mm,
        index: 1.5,
        spread: None,
    }
}

fn clear(windows: usize) -> Vec<Vec<f64>> {
    vec![vec![1.0]; windows]
}

/// Fraction of the light that reaches the third of five stripes through the window above it, and of the light
/// that leaves it towards a view through the window above it: values of a separate program.
#[test]
fn shares_of_own_windows_are_known() {
    let (windows, transmittance) = (stripes(&[0.2; 5], 1.0), clear(5));
    let own = |height: f64, directions: &[Direction]| {
        let plan = FilteredPixels { height_mm: 0.2 * height, ..pixels(&windows, &transmittance, 3.0) };
        let planes = TwoPlanes::new(&plan, None, 0);
        let passed = planes.entering(directions);
        let cells = planes.cells();
        let of = |window: Option<usize>| -> f64 {
            let own = (0..cells.count()).filter(|cell| cells.window_of(*cell) == Some(2));
            own.map(|cell| {
                window.map_or_else(|| passed.all(cell)[0], |window| passed.by_window(cell, window)[0])
            })
            .sum()
        };
        of(Some(2)) / of(None)
    };
    for (height, expected) in
        [(0.1, 0.966_65), (0.25, 0.916_63), (0.5, 0.833_25), (1.0, 0.666_50), (2.0, 0.406_24)]
    {
        let errors = [0, 1].map(|level| (own(height, &diffuse_directions(level, |_| 1.0)) - expected).abs());
        assert!(errors[1] < 1.5e-5 && errors[0] < 2e-4, "{height}: {errors:?}");
    }
    // The height times the tangent of the angle in the glass, over the width of a stripe.
    for (theta_deg, expected) in [(10.0, 0.116_55), (30.0, 0.353_55), (45.0, 0.534_52), (60.0, FRAC_1_SQRT_2)]
    {
        let direction = Direction { beta: Beta::towards(theta_deg, 0.0, 1.0), weight: 1.0 };
        assert!((1.0 - own(1.0, &[direction]) - expected).abs() < 1e-5, "{theta_deg}");
    }
}

/// Mean that is seen of pixels, relative to the light that would reach them alone.
fn seen(planes: &TwoPlanes, view: Beta, level: u32, rho: &[f64]) -> f64 {
    seen_through(planes, view, level, rho, 0..rho.len() + 1)
}

/// The part of it that passes some windows of the filter.
fn seen_through(planes: &TwoPlanes, view: Beta, level: u32, rho: &[f64], windows: Range<usize>) -> f64 {
    let entering = planes.entering(&diffuse_directions(level, |beta| 1.0 - fresnel(beta)));
    let leaving = planes.leaving(&[Direction { beta: view, weight: 1.0 }]);
    let rho: Vec<[f64; 1]> = rho.iter().map(|rho| [*rho]).collect();
    let rows: Vec<&[f64]> = rho.iter().map(|row| &row[..]).collect();
    let irradiance = planes.irradiance(&entering, &rows);
    let cells = planes.cells();
    let of = |cell: usize| {
        let own = cells.window_of(cell).map_or(0.0, |window| rho[window][0]);
        let passes: f64 = windows.clone().map(|window| leaving.by_window(cell, window)[0]).sum();
        passes * own * irradiance[cell]
    };
    (0..cells.count()).map(of).sum()
}

/// Stripes of 0.6 and 0.03 without filter: known means through all orders, by the period over the thickness.
#[test]
fn stripes_without_filter_have_known_means() {
    let (windows, transmittance) = (stripes(&[0.5, 0.5], 1.0), clear(2));
    for (period, expected) in
        [(0.1, 0.15030), (1.0, 0.15047), (3.0, 0.14910), (5.0, 0.14812), (10.0, 0.15594)]
    {
        let plan = pixels(&windows, &transmittance, 1.0 / period);
        let [coarse, fine] = [0, 1].map(|level| {
            let planes = TwoPlanes::new(&plan, Some(&fresnel), level);
            let returned = planes.returned_uniform()[0];
            assert!((returned - 0.596_346).abs() < 1e-5, "{returned}");
            0.387_508 * seen(&planes, Beta::default(), level, &[0.6, 0.03])
        });
        assert!((fine - expected).abs() < 1e-4, "{period}: {fine} {expected}");
        assert!((coarse - expected).abs() < 3e-4, "{period}: {coarse} {expected}");
    }
}

/// A clear filter over a uniform page: the geometric series of the face.
#[test]
fn uniform_page_has_its_geometric_series() {
    let cells = [vec![(0, 0.3), (1, 0.2)], vec![(1, 0.2), (2, 0.3)]];
    let (windows, transmittance) = (rows(&cells, 3, 1.0), clear(3));
    let plan = FilteredPixels { height_mm: 0.3, ..pixels(&windows, &transmittance, 1.2) };
    let planes = TwoPlanes::new(&plan, Some(&fresnel), 0);
    let expected = 0.5 / (1.0 - 0.5 * planes.returned_uniform()[0]);
    assert!((seen(&planes, Beta { x: 0.4, y: 0.2 }, 0, &[0.5; 3]) - expected).abs() < 1e-10);
}

/// A plain path tracer: backwards from the viewer through filter and pixel until the path leaves.
struct Paths<'a> {
    plan: FilteredPixels<'a>,
    rho: &'a [f64],
    state: u64,
}

impl Paths<'_> {
    /// Uniform random number (splitmix64).
    fn number(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn window(&self, place: [f64; 2]) -> Option<usize> {
        let [x, y] = [0, 1].map(|k| (place[k] / self.plan.pitch_mm[k]).rem_euclid(1.0));
        let holds = |window: &Window| {
            window
                .rectangles
                .iter()
                .any(|one| (one.x[0]..one.x[1]).contains(&x) && (one.y[0]..one.y[1]).contains(&y))
        };
        self.plan.windows.iter().position(holds)
    }

    fn filtered(&self, place: [f64; 2], beta: Beta) -> f64 {
        let slant = 1.0 / (1.0 - beta.squared() / self.plan.index.powi(2)).sqrt();
        self.window(place).map_or(1.0, |window| self.plan.transmittance[window][0].powf(slant))
    }

    /// Light of a path that ends through one of the windows, over that of a white page without filter and
    /// return.
    fn path(&mut self, view: Beta, windows: &Range<usize>) -> f64 {
        let FilteredPixels { pitch_mm, height_mm, thickness_mm, index, .. } = self.plan;
        let moved = |place: [f64; 2], beta: Beta, length: f64| {
            let shift = displacement(beta, length, index);
            [place[0] + shift[0], place[1] + shift[1]]
        };
        let mut place = [self.number() * pitch_mm[0], self.number() * pitch_mm[1]];
        let last = moved(place, view, height_mm);
        if !windows.contains(&self.window(last).unwrap_or(self.rho.len())) {
            return 0.0;
        }
        let mut weight = self.filtered(last, view);
        for _ in 0..60 {
            weight *= self.window(place).map_or(0.0, |window| self.rho[window]);
            let radius = index * self.number().sqrt();
            let (sin, cos) = (2.0 * PI * self.number()).sin_cos();
            let beta = Beta { x: radius * cos, y: radius * sin };
            weight *= self.filtered(moved(place, beta, height_mm), beta);
            let face = if radius < 1.0 { fresnel(radius) } else { 1.0 };
            if self.number() >= face {
                return weight;
            }
            place = moved(place, beta, 2.0 * thickness_mm);
            weight *= self.filtered(moved(place, beta, -height_mm), beta);
        }
        0.0
    }
}

/// Mean of paths through some windows, and its error.
fn traced(plan: FilteredPixels<'_>, rho: &[f64], view: Beta, windows: &Range<usize>) -> (f64, f64) {
    let mut paths = Paths { plan, rho, state: 7 };
    let (mut sum, mut squares, count) = (0.0, 0.0, 200_000);
    for _ in 0..count {
        let light = paths.path(view, windows);
        sum += light;
        squares += light * light;
    }
    let mean = sum / f64::from(count);
    let error = ((squares / f64::from(count) - mean * mean) / f64::from(count)).sqrt();
    assert!(error < 0.02 * mean, "{error} of {mean}");
    (mean, error)
}

/// A black pixel beside a white one, seen obliquely through its own windows: what comes from the white pixel
/// left it beside the edge, where the irradiance changes within the height of the filter.
#[test]
fn black_stripe_beside_white_is_seen_through_its_own_windows() {
    let (windows, transmittance) =
        (stripes(&[1.0 / 6.0; 6], 1.0), [0.9, 0.1, 0.02, 0.9, 0.1, 0.02].map(|t| vec![t]).to_vec());
    let rho = [0.03, 0.03, 0.03, 0.45, 0.45, 0.45];
    let view = Beta { x: 0.5, y: 0.0 };
    // Heights of 5 and 20 um, and a face 0.2 mm away, above pixels of 84.67 um.
    for height_mm in [0.005, 0.02] {
        let plan = FilteredPixels {
            height_mm,
            pitch_mm: [0.16934, 0.08467],
            ..pixels(&windows, &transmittance, 0.2)
        };
        let (mean, error) = traced(plan, &rho, view, &(0..3));
        let [coarse, fine] = [0, 1].map(|level| {
            let division = Division::everywhere(10 << level, 8 << level);
            let planes = TwoPlanes::with_cells(&plan, Some(&fresnel), level, &division);
            seen_through(&planes, view, level, &rho, 0..3) * (1.0 - planes.returned_uniform()[0])
        });
        assert!((fine - mean).abs() < 4.0 * error + 0.005 * mean, "{height_mm}: {fine} {mean} +- {error}");
        assert!((coarse - mean).abs() < 4.0 * error + 0.03 * mean, "{height_mm}: {coarse} {mean} +- {error}");
    }
}

/// Coloured windows, at two heights, seen obliquely, through all orders: paths.
#[test]
fn filters_equal_a_plain_path_tracer() {
    let quad = [vec![(0, 0.3), (1, 0.2)], vec![(1, 0.2), (2, 0.3)]];
    let transmittance = vec![vec![0.9], vec![0.4], vec![0.1]];
    let rho = [0.6, 0.05, 0.5];
    let view = Beta { x: 0.35, y: -0.5 };
    for (windows, height_mm, thickness_mm) in
        [(stripes(&[0.5, 0.3, 0.2], 0.8), 0.4, 1.1), (rows(&quad, 3, 0.9), 0.15, 0.6)]
    {
        let plan = FilteredPixels { height_mm, ..pixels(&windows, &transmittance, thickness_mm) };
        let planes = TwoPlanes::new(&plan, Some(&fresnel), 0);
        let found = seen(&planes, view, 0, &rho) * (1.0 - planes.returned_uniform()[0]);
        let (mean, error) = traced(plan, &rho, view, &(0..4));
        assert!((found - mean).abs() < 4.0 * error + 1e-3 * mean, "{height_mm}: {found} {mean} +- {error}");
    }
}
