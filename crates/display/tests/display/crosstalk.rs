//! Crosstalk: shares against a series of transfers, figures against closed forms and paths, and what is
//! refused.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use papilio_display::scene::Stop;
use papilio_display::spatial::walk::pattern;
use papilio_display::spatial::{CrosstalkResult, Figure, PatternValues, crosstalk};
use papilio_display::{Control, DisplayError};
use papilio_optics::lobe::Lobe;
use papilio_optics::{Beta, Scatterer};
use papilio_scenario::{Resolved, Scenario};
use papilio_spectra::{Grid, Spectrum};
use papilio_testing::everyday;
use papilio_transport::Diffuser;
use papilio_transport::spatial::{Accuracy, Gap, Light, Spread, shares_by_transfer, stripes};
use papilio_transport::walk::places::Pattern;

use crate::common;
use crate::tangents::{Tangents, tangent};

const LOBE: &str = "[display.diffuser]\nmodel = \"k-correlation\"\nwidth = 0.05667\ntransmittance = 1.0\n";
const GLASS: &str = "[display.glass]\nindex = 1.5\nthickness_mm = 0.5\n";
const BARE: &str = "[display.glass]\nindex = 1.5\nsurface = \"fresnel\"\nthickness_mm = 1.0\n";
const DIFFUSE: &str = "[lighting]\nilluminance_lx = 500\nspectrum = \"D65\"\ndiffuse = 1.0\n";
const MIRROR: &str =
    "[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = { white = 0.9, black = 0.05 }\n";
const PAPER: &str = "[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\nreflectance = { white = 0.6, black = 0.03 }\n";
/// A layer with the index of the glass: every sub-pixel is bare aluminium, whatever its gap.
const ALUMINIUM: &str = "[display.pixel]\nmodel = \"film\"\nsubstrate = \"Al\"\n\
    area = { red = 0.5, green = 0.3, blue = 0.2 }\nfill_factor = 0.9\n\
    gap_nm = { red = 200, green = 150, blue = 100, dark = 20 }\n\
    film = [{ material = 1.5, thickness_nm = \"gap\" }]\n";

fn resolved(parts: &[&str]) -> Resolved {
    let text = format!("[spectrum]\nstep_nm = 40\n{}[solver]\nrelative_error = 1e-4\n", parts.concat());
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    Scenario::from_text(&text, "crosstalk.toml", &folder, &[]).unwrap().resolve().unwrap()
}

fn computed(resolved: &Resolved) -> Result<CrosstalkResult, DisplayError> {
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
    crosstalk(&resolved.scene, &resolved.patterns.text, &control)
}

fn values(result: &CrosstalkResult, figure: Figure) -> PatternValues {
    result.views[0].patterns.iter().find(|pattern| pattern.name == figure).unwrap().values
}

fn near(what: &str, found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() < tolerance, "{what}: {found} against {expected}");
}

fn assert_rows_sum_to_one(shares: &[Vec<f64>]) {
    shares.iter().for_each(|row| near("row", row.iter().sum(), 1.0, 1e-12));
}

/// H78 over 0.5 mm: the shares of equal reflectances by a Fourier series with the transfer of the spread, at
/// 300 and 150 ppi, along the normal and obliquely.
#[test]
fn shares_equal_the_series_of_transfers() {
    for (ppi, theta_deg) in everyday(1, [(150.0, 30.0), (300.0, 0.0)]) {
        let matrix = format!("[display.matrix]\nppi = {ppi}\n");
        let view = format!("[viewer]\ntheta_deg = {theta_deg}\nfield_deg = 0\n");
        let result = computed(&resolved(&[LOBE, GLASS, &matrix, ALUMINIUM, DIFFUSE, &view])).unwrap();
        let shares = &result.views[0].shares;
        assert_rows_sum_to_one(&shares.out);
        let grid = Grid::new(500.0, 600.0, 50.0).unwrap();
        let diffuser = Diffuser {
            lobe: Lobe::KCorrelation { width: 0.05667 },
            transmittance: Spectrum::constant(&grid, 1.0),
            regular_fraction: 0.0,
        };
        let gap = Gap { index: 1.5, thickness_mm: 0.5 };
        let (pitch, orders) = (25.4 / ppi, 24);
        let beta = Beta::towards(theta_deg, 0.0, 1.0);
        let accuracy = Accuracy { digits: 11.0, most_per_mm: f64::from(orders) / pitch };
        let spread = Spread::new(&diffuser, gap, beta, Light::Diffuse, accuracy);
        let zero = spread.transfer([0.0; 2], |_| 1.0).re;
        let transfer = |wave: [f64; 2]| {
            if wave[1] != 0.0 {
                // Stripes have no such order.
                return num_complex::Complex64::ZERO;
            }
            // What is seen from the origin is on the opposite side.
            spread.transfer(wave.map(|wave| wave / pitch), |_| 1.0).conj() / zero
        };
        let expected = shares_by_transfer(&stripes(&[0.5, 0.3, 0.2], 0.9), orders, transfer);
        for (i, (row, expected)) in shares.out.iter().zip(&expected).enumerate() {
            let active: f64 = expected.iter().sum();
            for (j, (found, expected)) in row.iter().zip(expected).enumerate() {
                near(&format!("{ppi}, {i}, {j}"), *found, expected / active, 1e-3);
            }
        }
        assert!(shares.error < 1e-3, "{}", shares.error);
    }
}

/// White and black of 0.6 and 0.03 under 1 mm of bare glass: stripes of half a period of 10 mm, and a line
/// much thinner than the glass, which has the irradiance of the white page.
#[test]
fn figures_on_paper_have_known_contrast() {
    let view = "[viewer]\ntheta_deg = 0\nfield_deg = 0\n";
    let at = |pitch_um: f64| {
        let matrix = format!("[display.matrix]\npitch_um = {pitch_um}\n[pattern]\ntext = \" \"\n");
        computed(&resolved(&[BARE, &matrix, PAPER, DIFFUSE, view])).unwrap()
    };
    let coarse = at(5000.0);
    let via = |figure| values(&coarse, figure).contrast_ratio_via_pixel.unwrap();
    near("patch", via(Figure::Patch), 30.586, 2e-3);
    near("stripes", via(Figure::Stripe), 0.29795 / 0.01393, 0.02);
    let fine = at(20.0);
    let via = |figure| values(&fine, figure).contrast_ratio_via_pixel.unwrap();
    near("line", via(Figure::Line), 20.0, 0.05);
    // Fine stripes have the irradiance of their mean.
    near("fine stripes", via(Figure::Stripe), 20.0, 1e-3);
    assert_eq!(fine.views[0].shares.out, [[1.0]]);
    assert_eq!(values(&fine, Figure::Patch).gamut_percent_srgb, None);
    assert!(values(&fine, Figure::Patch).contrast_ratio.unwrap() < 8.0);
}

/// A black column, or every second one, on white; seen are the places of column 0.
struct Columns {
    pitch_mm: f64,
    repeats: bool,
}

impl Pattern for Columns {
    fn images(&self) -> usize {
        1
    }

    fn period_mm(&self) -> [f64; 2] {
        [self.pitch_mm; 2]
    }

    fn shows(&self, place_mm: [f64; 2], show: &mut dyn FnMut(usize, usize, f64)) {
        let column = (place_mm[0] / self.pitch_mm).floor();
        let black = if self.repeats { column.rem_euclid(2.0) == 0.0 } else { column == 0.0 };
        show(0, usize::from(black), 1.0);
    }
}

/// Figures below a diffuser in mixed light, seen obliquely: those of Monte Carlo with places.
#[test]
fn figures_below_a_diffuser_equal_those_of_paths() {
    let light = "[lighting]\nilluminance_lx = 500\nspectrum = \"D65\"\ndiffuse = 0.5\n\
        [[lighting.directed]]\ntheta_deg = -10\nshare = 0.5\n";
    let view = "[viewer]\ntheta_deg = 15\nfield_deg = 0\n";
    let matrix = "[display.matrix]\nppi = 300\n";
    let resolved = resolved(&[LOBE, GLASS, matrix, MIRROR, light, view]);
    let result = computed(&resolved).unwrap();
    let stop = AtomicBool::new(false);
    let control = Control { threads: None, progress: &|_| {}, stop: &stop };
    let page = common::run(&resolved.scene).unwrap().views[0].states.get("white").unwrap().value.Y;
    for (figure, repeats) in [(Figure::Line, false), (Figure::Stripe, true)] {
        let columns = Columns { pitch_mm: 25.4 / 300.0, repeats };
        let found = pattern(&resolved.scene, &columns, 1 << 15, &control).unwrap()[0].via_pixel[0];
        let ratio = values(&result, figure).contrast_ratio.unwrap();
        let black = if repeats {
            // Half of the light is that of either column: white and black add to the two pages.
            let black_page = page / values(&result, Figure::Patch).contrast_ratio.unwrap();
            (page + black_page) / (1.0 + ratio)
        } else {
            page / ratio
        };
        let error = found.standard_error;
        assert!(error < 0.03 * black, "{error} of {black}");
        assert!((found.value - black).abs() < 5.0 * error + 1e-3 * black, "{figure:?} {found:?} {black}");
    }
}

/// The reference display: patches are those of a run; fine figures have less contrast and gamut.
#[test]
fn patches_are_those_of_a_run() {
    let resolved = common::scenario("matrix", &["spectrum.step_nm=20"]).unwrap();
    let result = computed(&resolved).unwrap();
    let run = common::run(&resolved.scene).unwrap();
    let metrics = run.views[0].metrics;
    let patch = values(&result, Figure::Patch);
    near("gamut", patch.gamut_percent_srgb.unwrap(), metrics.gamut_percent_srgb.unwrap(), 0.02);
    near("contrast", patch.contrast_ratio.unwrap() / metrics.contrast_ratio.unwrap(), 1.0, 1e-3);
    // Strokes of text are a few pixels wide.
    for (figure, most) in [(Figure::Stripe, 0.1), (Figure::Line, 0.1), (Figure::Text, 0.9)] {
        let fine = values(&result, figure);
        assert!(fine.gamut_percent_srgb.unwrap() < most * patch.gamut_percent_srgb.unwrap(), "{fine:?}");
        assert!(fine.contrast_ratio.unwrap() < most * patch.contrast_ratio.unwrap(), "{fine:?}");
    }
    let view = &result.views[0];
    assert_eq!(result.subpixels, ["red", "green", "blue"]);
    assert_rows_sum_to_one(&view.shares.out);
    let lights: Vec<&str> = view.by_light.iter().map(|(name, _)| name).collect();
    assert_eq!(lights, ["diffuse", "directed.0"]);
    assert!(view.shares.error < 2e-3, "{}", view.shares.error);
}

/// Lines and stripes of Lambertian and mirror-like pixels through lobes that are wider and narrower than a pixel, against an integral
/// by place in the test: the stated error holds the kinks of areas, where borders of pixels meet.
#[test]
fn lines_through_a_lobe_are_within_their_stated_error() {
    const WHITE_BLACK: &str = "reflectance = { white = 0.8, black = 0.1 }\n";
    let pixel =
        |kind: &str| format!("[display.pixel]\nmodel = \"uniform\"\nkind = \"{kind}\"\n{WHITE_BLACK}");
    // Width of the lobe, view in degrees, thickness and pitch in mm.
    let cases = [
        ("mirror", [0.03, 0.0, 3.0, 0.2]),
        ("lambertian", [0.1, 20.0, 1.0, 0.2]),
        ("lambertian", [0.05667, 8.0, 0.5, 0.0847]),
        ("lambertian", [0.03, 0.0, 0.5, 0.2]),
        ("lambertian", [0.02, 20.0, 0.5, 0.2]),
        ("lambertian", [0.05, 35.0, 0.5, 0.2]),
        ("lambertian", [0.05667, 0.0, 1.0, 0.2]),
        ("lambertian", [0.005, 10.0, 1.0, 0.05]),
        ("lambertian", [0.003, 8.0, 3.0, 0.2]),
        ("mirror", [0.02, 0.0, 3.0, 0.2]),
        ("mirror", [0.01, 0.0, 3.0, 0.2]),
        ("mirror", [0.05667, 8.0, 0.5, 0.0847]),
        ("mirror", [0.1, 20.0, 1.0, 0.2]),
        ("mirror", [0.03, 40.0, 1.0, 0.3]),
    ];
    for (kind, sizes) in everyday(3, cases) {
        let [width, theta_deg, thickness_mm, pitch_mm] = sizes;
        let lobe = LOBE.replace("0.05667", &width.to_string());
        let glass = GLASS.replace("0.5", &thickness_mm.to_string());
        let matrix = format!(
            "[display.matrix]\npitch_um = {}\nlayout = \"single\"\n[pattern]\ntext = \" \"\n",
            1e3 * pitch_mm
        );
        let view = format!("[viewer]\ntheta_deg = {theta_deg}\nfield_deg = 0\n");
        let mut resolved = resolved(&[&lobe, &glass, &matrix, &pixel(kind), DIFFUSE, &view]);
        resolved.scene.solver.stop = Stop::RelativeError { target: 1e-3, per_wavelength: false };
        let result = computed(&resolved).unwrap();
        let own = shares_of_own_columns(kind == "mirror", sizes);
        for (figure, own) in [Figure::Line, Figure::Stripe].into_iter().zip(own) {
            // Of a stripe, the page is that of white stripes on black.
            let (white, black) = (1.0 - 0.875 * (1.0 - own), 1.0 - 0.875 * own);
            let expected = if figure == Figure::Line { 1.0 / black } else { white / black };
            let pattern = result.views[0].patterns.iter().find(|pattern| pattern.name == figure).unwrap();
            let found = pattern.values.contrast_ratio_via_pixel.unwrap();
            let error = pattern.error.contrast_ratio_via_pixel.unwrap();
            let what = format!("{kind} {sizes:?} {figure:?}: {found} ({error:.1e}) against {expected}");
            // The page, of which figures take light, has its own error, 1e-7.
            assert!((found - expected).abs() < error + 2e-7 * expected, "{what}");
            // The target of the scene.
            assert!(error < 1e-3 * expected, "{what}");
        }
    }
}

/// What is seen in diffuse light of the own column of a pixel, and of every second one, through a k-correlation lobe of this width over
/// glass.
fn shares_of_own_columns(is_mirror: bool, [width, theta_deg, thickness_mm, pitch_mm]: [f64; 4]) -> [f64; 2] {
    let lobe = Lobe::KCorrelation { width };
    let view = Beta::towards(theta_deg, 0.0, 1.0);
    let arrives = |beta: Beta| if is_mirror { lobe.fraction_in_disc(beta.length(), 1.0) } else { 1.0 };
    let light = |beta: Beta| lobe.density(view, beta) * arrives(beta);
    let pixels = pitch_mm / thickness_mm;
    let tangents = Tangents { peak: Some((view.x, width)), rim: width, first: tangent(view.x), step: pixels };
    let [mut line, mut stripe, mut all] = [0.0; 3];
    let rest = tangents.each(&light, &mut |x, light| {
        let apart = (x - tangent(view.x)).abs() / pixels;
        line += light * (1.0 - apart).max(0.0);
        stripe += light * (1.0 - apart.rem_euclid(2.0)).abs();
        all += light;
    });
    // Far away there is as much light of either column.
    [line / (all + rest), (stripe + 0.5 * rest) / (all + rest)]
}

/// A lobe whose blur c is 1/1300 of the pitch: stripes without gaps lose what the closed form of a stripe
/// alone says, less some per cent that beyond the hemisphere is lost and that returns from the same stripe of
/// other pixels. At a grazing view, too, shares are shares.
#[test]
fn narrow_lobes_and_grazing_views_have_right_numbers() {
    let narrow = LOBE.replace("0.05667", "0.0002");
    let matrix = "[display.matrix]\nppi = 300\n";
    let view = "[viewer]\ntheta_deg = [0, 86]\nfield_deg = 0\n";
    let whole = ALUMINIUM.replace("fill_factor = 0.9", "fill_factor = 1.0");
    let result = computed(&resolved(&[&narrow, GLASS, matrix, &whole, DIFFUSE, view])).unwrap();
    let (c, pitch) = (0.0002 * 0.5 / 1.5, 25.4 / 300.0);
    let own =
        |w: f64| 2.0 / std::f64::consts::PI * ((w / c).atan() - c / (2.0 * w) * (w * w / (c * c)).ln_1p());
    let widths = [0.5, 0.3, 0.2].map(|area| area * pitch);
    let seen: f64 = widths.iter().map(|w| w * own(*w)).sum::<f64>() / widths.iter().sum::<f64>();
    let shares = &result.views[0].shares;
    let (lost, expected) = (1.0 - shares.own_share_out.unwrap(), 1.0 - seen);
    near("lost", lost / expected, 0.92, 0.1);
    assert!(expected < 0.02, "{expected}");
    for view in &result.views {
        assert_rows_sum_to_one(&view.shares.out);
        assert!(view.shares.error < 0.01, "{}", view.shares.error);
    }
}

#[test]
fn what_has_no_place_is_refused() {
    let key = |parts: &[&str]| match computed(&resolved(parts)) {
        Err(
            DisplayError::PlacesByPaths { key, .. }
            | DisplayError::PlacesNotComputed { key, .. }
            | DisplayError::MissingLength { key, .. },
        ) => key,
        other => panic!("{other:?}"),
    };
    let matrix = "[display.matrix]\nppi = 300\n";
    let thin = "[display.glass]\nindex = 1.5\n";
    assert_eq!(key(&[LOBE, thin, matrix, MIRROR, DIFFUSE]), "display.glass.thickness_mm");
    assert_eq!(key(&[BARE, matrix, ALUMINIUM, DIFFUSE]), "display.glass.surface");
    let spread = "[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\nreflectance = { white = 0.6 }\nspread_um = 5\n";
    assert_eq!(key(&[LOBE, GLASS, matrix, spread, DIFFUSE]), "display.pixel.spread_um");
    let front = "[[display.front]]\nreflectance = 0.01\nabsorptance = 0.0\ngap_mm = 0.1\n";
    assert_eq!(key(&[front, GLASS, matrix, ALUMINIUM, DIFFUSE]), "display.glass.surface");
    assert_eq!(key(&[front, front, BARE, matrix, MIRROR, DIFFUSE]), "display.front");
    let missing = computed(&resolved(&[LOBE, GLASS, MIRROR, DIFFUSE])).unwrap_err();
    assert_eq!(missing, DisplayError::NoMatrix { command: "crosstalk" });
}
