//! Colour filters at a height above the pixels: limits, known shares, and what is refused.

use std::f64::consts::{FRAC_1_SQRT_2, PI};
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::AtomicBool;

use num_complex::Complex64;
use papilio_display::image::{ImageResult, ImageSettings, PictureSurround, Screen, SourceImage, image};
use papilio_display::result::RunResult;
use papilio_display::scene::Ready;
use papilio_display::spatial::{CrosstalkResult, Figure, crosstalk, walk};
use papilio_display::{Control, DisplayError, Progress, run};
use papilio_optics::lobe::Lobe;
use papilio_optics::{Beta, Scatterer};
use papilio_scenario::{Resolved, Scenario};
use papilio_spectra::Spectrum;
use papilio_testing::{everyday, sized};

use crate::common::run_on;
use crate::tangents::Tangents;

pub(crate) const PAPER: &str = "[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\nreflectance = { white = 0.6, black = 0.03 }\n";
pub(crate) const LIGHT: &str = "[lighting]\nilluminance_lx = 500\nspectrum = \"D65\"\ndiffuse = 1.0\n";

pub(crate) fn glass(surface: &str, thickness_mm: f64) -> String {
    format!("[display.glass]\nindex = 1.5\nsurface = \"{surface}\"\nthickness_mm = {thickness_mm}\n")
}

/// Stripes of a third of 84.67 um.
pub(crate) fn filter(height_um: f64, transmittance: &str) -> String {
    format!(
        "[display.matrix]\npitch_um = 84.67\n[display.matrix.filter]\nheight_um = {height_um}\n\
         transmittance = {{ {transmittance} }}\n"
    )
}

pub(crate) fn resolved(parts: &[&str]) -> Resolved {
    resolved_with(parts, &[])
}

fn resolved_with(parts: &[&str], overrides: &[String]) -> Resolved {
    let step = sized(80, 40);
    let text = format!("[spectrum]\nstep_nm = {step}\n{}[solver]\nrelative_error = 1e-3\n", parts.concat());
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    Scenario::from_text(&text, "filter.toml", &folder, overrides).unwrap().resolve().unwrap()
}

fn computed(resolved: &Resolved) -> Result<CrosstalkResult, DisplayError> {
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
    crosstalk(&resolved.scene, &resolved.patterns.text, &control)
}

pub(crate) fn near(what: &str, found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() < tolerance, "{what}: {found} against {expected}");
}

const CLEAR: &str = "red = 1.0, green = 1.0, blue = 1.0";

/// Without colour a filter changes nothing: white and black are those of the pixel; red, a third white, is
/// the mean of fine stripes.
#[test]
fn clear_filter_leaves_the_display_as_it_is() {
    let mirror = PAPER.replace("lambertian", "mirror");
    for (surface, pixel) in [("fresnel", PAPER), ("coated", PAPER), ("fresnel", &mirror), ("coated", &mirror)]
    {
        let view = "[viewer]\ntheta_deg = 20\nfield_deg = 0\n";
        let with = resolved(&[&glass(surface, 0.5), pixel, LIGHT, &filter(30.0, CLEAR), view]);
        let without = resolved(&[&glass(surface, 0.5), pixel, LIGHT, view]);
        let [with, without] = [&with, &without].map(|one| run_on(&one.scene, Some(1)).unwrap());
        let of = |state: &str| with.views[0].states.get(state).unwrap().value.Y;
        for (state, value) in without.views[0].states.iter() {
            near(state, of(state) / value.value.Y, 1.0, 1e-3);
        }
        let names: Vec<&str> = with.views[0].states.iter().map(|(name, _)| name).collect();
        assert_eq!(names.len(), 8, "{names:?}");
        assert!(of("red") < of("yellow") && of("yellow") < of("white"));
        near("stripes of white", of("red") / of("green"), 1.0, 1e-6);
        let ledger = &with.views[0].ledger.get("white").unwrap();
        near("energy", ledger.returned + ledger.unaccounted, 1.0, 1e-9);
    }
}

/// Paper with a filter of stripes below a lobe, against integrals by place: the own shares of light through a clear filter, and Y of
/// paper below a filter that is black but for one stripe, are within their stated errors.
#[test]
fn numbers_below_a_filter_and_a_lobe_are_within_their_stated_errors() {
    // Width of the lobe, view in degrees, height of the filter in um.
    let cases = [
        [0.01, 10.0, 100.0],
        [0.1, 0.0, 100.0],
        [0.1, 30.0, 50.0],
        [0.05667, 8.0, 200.0],
        [0.05, 20.0, 20.0],
        [0.02, 15.0, 10.0],
        [0.03, 0.0, 60.0],
    ];
    for [width, theta_deg, height_um] in everyday(2, cases) {
        let what = format!("{width} {theta_deg} {height_um}");
        let lobe =
            format!("[display.diffuser]\nmodel = \"k-correlation\"\nwidth = {width}\ntransmittance = 1.0\n");
        let view = format!("[viewer]\ntheta_deg = {theta_deg}\nfield_deg = 0\n");
        let below = |filter: &str| resolved(&[&lobe, &glass("coated", 0.3), PAPER, LIGHT, filter, &view]);
        let lobe_of_width = Lobe::KCorrelation { width };
        let seen_from = Beta::towards(theta_deg, 0.0, 1.0);
        let leaves = |beta: Beta| lobe_of_width.density(seen_from, beta);
        let enters = |beta: Beta| lobe_of_width.fraction_in_disc(beta.length(), 1.0);
        let pitch = 84.67 / height_um;
        let of = |light: &dyn Fn(Beta) -> f64, peak: Option<(f64, f64)>| {
            let tangents = Tangents { peak, rim: width, first: 0.0, step: pitch / 3.0 };
            let (mut own, mut all) = (0.0, 0.0);
            let mut waves = [Complex64::ZERO; 64];
            let rest = tangents.each(light, &mut |x, light| {
                let periods = x / pitch;
                own += light * (1.0 - 3.0 * (periods - periods.round()).abs()).max(0.0);
                all += light;
                for (k, wave) in waves.iter_mut().enumerate() {
                    *wave += Complex64::from_polar(light, 2.0 * PI * k as f64 * periods);
                }
            });
            waves[0] += rest;
            ((own + rest / 3.0) / (all + rest), waves.map(|wave| wave / (all + rest)))
        };
        let (own_out, waves_out) = of(&leaves, Some((seen_from.x, width)));
        let (own_in, waves_in) = of(&enters, None);
        let shares = &computed(&below(&filter(height_um, CLEAR))).unwrap().views[0].shares;
        for (found, error, expected) in [
            (shares.own_share_out, shares.own_share_errors[0], own_out),
            (shares.own_share_in, shares.own_share_errors[1], own_in),
        ] {
            let (found, error) = (found.unwrap(), error.unwrap());
            assert!(
                (found - expected).abs() < error + 1e-7,
                "{what}: {found} ({error:.1e}) against {expected}"
            );
        }
        // Light enters and leaves through the same stripe: a Fourier series with the waves of both ways.
        let of_order = |k: usize| {
            let x = PI * k as f64;
            let stripe = if k == 0 { 1.0 / 9.0 } else { 2.0 * ((x / 3.0).sin() / x).powi(2) };
            stripe * (waves_in[k] * waves_out[k]).re
        };
        let part: f64 = (0..waves_in.len()).map(of_order).sum();
        let [clear, black] = [CLEAR, "red = 1.0, green = 0.0, blue = 0.0"]
            .map(|filter_of| run_on(&below(&filter(height_um, filter_of)).scene, Some(1)).unwrap());
        let white = |result: &RunResult| {
            let state = result.views[0].states.get("white").unwrap();
            (state.value.Y, state.discretisation_error.as_ref().unwrap().Y)
        };
        let ((all, _), (found, error)) = (white(&clear), white(&black));
        // Y below a clear filter is that of paper below the lobe, within 1e-5.
        let expected = part * all;
        assert!(
            (found - expected).abs() < error + 1e-5 * expected,
            "{what}: Y {found} ({error:.1e}) against {expected}"
        );
        assert!(error < 1e-2 * found, "{what}: Y {found} ({error:.1e})");
    }
}

/// A picture of white and black columns below a clear filter: pixels have the colours of pages, and the error
/// contains the light that the face returns to neighbours, known from the limits of fine and of wide patterns
/// (Clapper and Yule) and from the same picture without filter. The face reflects 0.04.
#[test]
fn pictures_below_a_filter_have_the_colours_of_pages() {
    let view = "[viewer]\ntheta_deg = 0\nfield_deg = 0\n";
    let states: Vec<u8> = (0..64).map(|k| k % 2).collect();
    let shown = |matrix: &str| -> ImageResult {
        let scene = resolved(&[&glass("fresnel", 0.5), PAPER, LIGHT, matrix, view]).scene;
        let names = ["white", "black"].map(str::to_owned).to_vec();
        let (given, surround) = (Some(states.clone()), PictureSurround::Repeat);
        let settings = ImageSettings { given, surround, states: names, ..ImageSettings::default() };
        let source = SourceImage { columns: 8, pixels: vec![[0.5; 3]; 64] };
        let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
        image(&scene, &source, &settings, Screen::default(), &control).unwrap()
    };
    let [below, without] =
        [filter(30.0, CLEAR), "[display.matrix]\npitch_um = 84.67\n".to_owned()].map(|matrix| shown(&matrix));
    assert!(!below.numbers.neighbours_light && without.numbers.neighbours_light);
    near("white", f64::from(below.seen[0][1]), 0.04 + 0.362_048, 4e-4);
    near("black", f64::from(below.seen[1][1]), 0.04 + 0.011_837, 4e-4);
    let y_of_white = below.palette.white_XYZ[1] / below.palette.white_XYZ.into_iter().fold(0.0, f64::max);
    near("error", below.numbers.error * y_of_white, 0.186_943 - 0.150_298, 1e-3);
    let mean = |one: &ImageResult| one.seen.iter().map(|pixel| f64::from(pixel[1])).sum::<f64>() / 64.0;
    let lost = mean(&below) - mean(&without);
    assert!(lost > 0.5 * below.numbers.error && lost < below.numbers.error, "{lost} {}", below.numbers.error);
}

/// Height over width of a stripe of 0.5, 1 and 2 under a coated face, diffuse light: light that entered by
/// the own stripe (closed form; three stripes repeat, so that of 2 includes the same colour further away),
/// and light seen through the neighbour.
#[test]
fn shares_of_three_stripes_are_known() {
    let stripe_um = 84.67 / 3.0;
    let share = |ratio: f64, theta_deg: f64| {
        let view = format!("[viewer]\ntheta_deg = {theta_deg}\nfield_deg = 0\n");
        let filter = filter(ratio * stripe_um, CLEAR);
        let result = computed(&resolved(&[&glass("coated", 0.5), PAPER, LIGHT, &filter, &view])).unwrap();
        let shares = result.views[0].shares.clone();
        let rows = shares.out.iter().chain(shares.in_.as_ref().unwrap());
        rows.for_each(|row| near("row", row.iter().sum(), 1.0, 1e-12));
        assert_eq!(shares.between_in, Some(vec![0.0; 3]));
        shares
    };
    for (ratio, expected) in [(0.5, 0.833_25), (1.0, 0.666_50)] {
        let found = share(ratio, 0.0);
        near("in", found.own_share_in.unwrap(), expected, 1e-4);
        near("out", found.own_share_out.unwrap(), 1.0, 1e-9);
    }
    for (theta_deg, expected) in everyday(1, [(60.0, FRAC_1_SQRT_2), (30.0, 0.353_55), (10.0, 0.116_55)]) {
        let found = share(1.0, theta_deg);
        near("out", 1.0 - found.own_share_out.unwrap(), expected, 2e-3);
        // Seen from the right, light comes from the pixel on the left.
        near("neighbour", found.out[1][0], expected, 2e-3);
    }
}

/// Patches are those of `run` at any height; black stripes under a filter keep the contrast of fine ones, 20
/// on paper of 0.6 and 0.03.
#[test]
fn patches_below_a_filter_are_those_of_a_run() {
    let transmittance = "red = 0.7, green = 0.4, blue = 0.2";
    for height_um in everyday(1, [60.0, 0.0]) {
        let resolved = resolved(&[&glass("fresnel", 0.5), PAPER, LIGHT, &filter(height_um, transmittance)]);
        let result = computed(&resolved).unwrap();
        let patterns = result.views[0].patterns.clone();
        let run = run_on(&resolved.scene, Some(1)).unwrap();
        let contrast = run.views[0].metrics.contrast_ratio.unwrap();
        near("contrast", patterns[0].values.contrast_ratio.unwrap() / contrast, 1.0, 2e-3);
        assert_eq!([patterns[1].name, patterns[2].name], [Figure::Stripe, Figure::Line]);
        near("stripes", patterns[1].values.contrast_ratio_via_pixel.unwrap(), 20.0, 0.05);
        // Text is not computed, and says so.
        assert_eq!(patterns[3].values.contrast_ratio, None);
        assert!(patterns[3].why_null.is_some_and(|why| why.contains("filter")), "{:?}", patterns[3]);
        assert_eq!(patterns.iter().filter(|pattern| pattern.why_null.is_some()).count(), 1);
    }
}

/// Below a front that returns light, and in a front light: a clear filter changes nothing, and a gray one
/// absorbs as the whole glass would; also in glass that absorbs itself.
#[test]
fn gray_filters_below_a_front_absorb_as_glass() {
    let front = "[[display.front]]\nreflectance = 0.2\nabsorptance = 0.05\ngap_mm = 0.1\n";
    let guide = "[lighting.front_light]\nilluminance_lx = 200\nspectrum = \"D65\"\nupward_leak = 0.1\n";
    let view = "[viewer]\ntheta_deg = 20\nfield_deg = 0\n";
    let mirror = PAPER.replace("lambertian", "mirror");
    let gray = |t: f64| format!("red = {t}, green = {t}, blue = {t}");
    for (of_glass, of_filter) in [(1.0, 1.0), (1.0, 0.6), (0.6, 1.0), (0.75, 0.8)] {
        for (surface, pixel) in
            [("fresnel", PAPER), ("coated", PAPER), ("fresnel", &mirror), ("coated", &mirror)]
        {
            let filter = filter(30.0, &gray(of_filter));
            let glass = |t: f64| format!("{}internal_transmittance = {t}\n", glass(surface, 0.5));
            let with = resolved(&[front, &glass(of_glass), pixel, LIGHT, guide, &filter, view]);
            let without = resolved(&[front, &glass(of_glass * of_filter), pixel, LIGHT, guide, view]);
            let [with, without] = [&with, &without].map(|one| run_on(&one.scene, Some(1)).unwrap());
            for (state, value) in without.views[0].states.iter() {
                let found = with.views[0].states.get(state).unwrap().value.Y;
                near(
                    &format!("{surface}, {of_glass}, {of_filter}, {state}"),
                    found / value.value.Y,
                    1.0,
                    1e-3,
                );
            }
        }
    }
}

/// Colours below a filter by paths: those of the other solver in diffuse light and a lamp, below a face that
/// reflects, and a front; and, of mirror-like pixels below a lobe, those of glass that absorbs as much if the
/// filter is gray.
#[test]
fn colours_below_filters_are_those_of_paths() {
    let light = "[lighting]\nilluminance_lx = 500\nspectrum = \"D65\"\ndiffuse = 0.6\n[[lighting.directed]]\ntheta_deg = -35\nphi_deg = 20\nshare = 0.4\n";
    let front = "[[display.front]]\nreflectance = 0.1\ngap_mm = 0.1\n";
    let view = "[viewer]\ntheta_deg = 20\nfield_deg = 0\n";
    let stop = AtomicBool::new(false);
    let control = Control { threads: Some(2), progress: &|_| {}, stop: &stop };
    let coloured = filter(30.0, "red = 0.8, green = 0.5, blue = 0.2");
    let paper = resolved(&[front, &glass("fresnel", 0.2), PAPER, light, &coloured, view]);
    let gray = filter(30.0, "red = 0.6, green = 0.6, blue = 0.6");
    let lobe = "[display.diffuser]\nmodel = \"k-correlation\"\nwidth = 0.1\ntransmittance = 1.0\n";
    let mirror = PAPER.replace("lambertian", "mirror");
    let film = resolved(&[lobe, &glass("coated", 0.2), &mirror, light, &gray, view]);
    let absorbing = format!("{}internal_transmittance = 0.6\n", glass("coated", 0.2));
    let glass = resolved(&[lobe, &absorbing, &mirror, light, view]);
    for (found, expected) in [(&paper, &paper), (&film, &glass)] {
        let found = &walk::filtered(&found.scene, 1 << 14, &control).unwrap()[0];
        let expected = run_on(&expected.scene, Some(1)).unwrap();
        let states = if expected.views[0].states.iter().count() == 8 { 0..8 } else { 0..2 };
        assert_eq!(found.via_pixel.len(), 8);
        for ((name, state), walk::Mean { value, standard_error }) in
            expected.views[0].states.iter().zip(&found.via_pixel[states])
        {
            let y = state.value.Y - state.value.terms.front_reflection;
            assert!(*standard_error < 0.03 * y, "{name}: {value} +- {standard_error}");
            assert!(
                (value - y).abs() < 4.5 * standard_error + 2e-3 * y,
                "{name}: {value} +- {standard_error}, {y}"
            );
        }
    }
    // A run has the same paths, with errors, and reports which part of them is traced.
    let overrides =
        ["solver.method=monte-carlo", "solver.paths=4096", "viewer.theta_deg=[0, 20]"].map(str::to_owned);
    let by_paths =
        resolved_with(&[lobe, &super::filter::glass("coated", 0.2), &mirror, light, &gray, view], &overrides);
    let shares = Mutex::new(Vec::new());
    let progress = |now: Progress<'_>| shares.lock().unwrap().push((now.views_done.1, now.share_of_view));
    let run = run(&by_paths.scene, &Control { progress: &progress, ..control }).unwrap();
    assert_eq!(run.views[0].states.iter().count(), 8);
    let shares = shares.into_inner().unwrap();
    assert!(shares.iter().all(|(views, _)| *views == 2), "{shares:?}");
    assert!(shares.iter().any(|(_, share)| *share == Some(1.0)), "{shares:?}");
}

/// Glass and a front whose index and reflectance depend strongly on the wavelength: what returns, and the
/// places of light, differ at each. Colours and their errors against paths.
#[test]
fn colours_below_filters_in_dispersion_and_coloured_fronts_are_those_of_paths() {
    let view = "[viewer]\ntheta_deg = 40\nfield_deg = 0\n";
    let front = "[[display.front]]\nreflectance = 0.1\ngap_mm = 0.1\n";
    let coloured = filter(30.0, "red = 0.8, green = 0.5, blue = 0.2");
    let mut resolved = resolved(&[front, &glass("fresnel", 0.2), PAPER, LIGHT, &coloured, view]);
    let count = resolved.scene.grid.len();
    let spectrum = |from: f64, to: f64| {
        let at = |bin: usize| from + (to - from) * bin as f64 / (count - 1) as f64;
        Spectrum::from_values((0..count).map(at).collect())
    };
    let [front, glass] = &mut resolved.scene.display.layers[..] else { panic!("two layers") };
    front.interface = Ready::component(spectrum(0.02, 0.3), spectrum(0.0, 0.0)).into();
    glass.medium = papilio_display::scene::Medium { index: spectrum(1.7, 1.4), ..glass.medium.clone() };
    assert_colours_are_those_of_paths(&resolved.scene);
}

/// Light that spreads inside pixels below a filter: paths, and the square of the mean of `sqrt(rho)` where it
/// spreads far over pixels in air.
#[test]
fn light_spreads_inside_pixels_below_stripes() {
    let view = "[viewer]\ntheta_deg = 20\nfield_deg = 0\n";
    let spreads = |um: f64| format!("{PAPER}spread_um = {um}\n");
    let air = "[display.glass]\nindex = 1\nsurface = \"ideal-ar\"\nthickness_mm = 0.1\n";
    let far = resolved(&[air, &spreads(3000.0), LIGHT, &filter(0.0, CLEAR), view]);
    let run = run_on(&far.scene, Some(1)).unwrap();
    let red = run.views[0].states.get("red").unwrap().value.Y;
    near("far", red, ((0.6_f64.sqrt() + 2.0 * 0.03_f64.sqrt()) / 3.0).powi(2), 1e-3);
    let coloured = filter(20.0, "red = 0.8, green = 0.5, blue = 0.2");
    let lobe = "[display.diffuser]\nmodel = \"k-correlation\"\nwidth = 0.1\ntransmittance = 0.9\n";
    for (top, surface) in everyday(1, [("", "fresnel"), (lobe, "coated")]) {
        let parts = [top, &glass(surface, 0.2), &spreads(15.0), LIGHT, &coloured, view];
        assert_colours_are_those_of_paths(&resolved(&parts).scene);
    }
    let tiles = coloured.replace(
        "[display.matrix.filter]",
        "subpixel = { red = [[0, 0, 0.5, 0.5]], \
        green = [[0.5, 0, 1, 0.5]], blue = [[0, 0.5, 1, 1]] }\n[display.matrix.filter]",
    );
    let refused =
        run_on(&resolved(&[&glass("fresnel", 0.2), &spreads(15.0), LIGHT, &tiles, view]).scene, Some(1));
    assert!(
        matches!(refused, Err(DisplayError::PlacesByPaths { key, .. }) if key == "display.pixel.spread_um")
    );
}

/// A sky through a lobe, low on one side: light arrives from there.
#[test]
fn colours_below_filters_and_lobes_under_a_sky_are_those_of_paths() {
    let view = "[viewer]\ntheta_deg = 20\nphi_deg = 180\nfield_deg = 0\n";
    let lobe = "[display.diffuser]\nmodel = \"k-correlation\"\nwidth = 0.1\ntransmittance = 0.9\n";
    let sky = "[lighting]\nilluminance_lx = 500\nspectrum = \"D65\"\ndiffuse = 0.2\n\
               [[lighting.environment]]\nshare = 0.8\nmodel = \"sky\"\nnumber = 12\nsun_elevation_deg = 30\n";
    let coloured = filter(50.0, "red = 0.8, green = 0.5, blue = 0.2");
    let resolved = resolved(&[lobe, &glass("coated", 0.2), PAPER, sky, &coloured, view]);
    assert_colours_are_those_of_paths(&resolved.scene);
}

pub(crate) fn assert_colours_are_those_of_paths(scene: &papilio_display::scene::Scene) {
    let expected = run_on(scene, Some(1)).unwrap();
    let control = Control { threads: Some(2), progress: &|_| {}, stop: &AtomicBool::new(false) };
    let found = &walk::filtered(scene, 1 << 14, &control).unwrap()[0];
    for ((name, state), walk::Mean { value, standard_error }) in
        expected.views[0].states.iter().zip(&found.via_pixel)
    {
        let y = state.value.Y - state.value.terms.front_reflection;
        assert!(*standard_error < 0.03 * y, "{name}: {value} +- {standard_error}");
        assert!(
            (value - y).abs() < 4.5 * standard_error + 2e-3 * y,
            "{name}: {value} +- {standard_error}, {y}"
        );
    }
}

/// Below a gray filter without gaps, mirror-like pixels are as sharp as below glass that absorbs as much,
/// which is general layers: transfer functions within standard errors of other paths, and the contrast of
/// lines.
#[test]
fn sharpness_below_a_gray_filter_is_that_of_absorbing_glass() {
    let view = "[viewer]\ntheta_deg = 20\nfield_deg = 0\n";
    let lobe = "[display.diffuser]\nmodel = \"k-correlation\"\nwidth = 0.1\ntransmittance = 1.0\n";
    let mirror = PAPER.replace("lambertian", "mirror");
    let gray = filter(30.0, "red = 0.6, green = 0.6, blue = 0.6");
    let by_paths = |seed: u64| {
        let all = ["solver.method=monte-carlo", "solver.paths=16384", &format!("solver.seed={seed}")];
        all.map(str::to_owned)
    };
    let with = resolved_with(&[lobe, &glass("coated", 0.2), &mirror, LIGHT, &gray, view], &by_paths(0));
    let absorbing = format!("{}internal_transmittance = 0.6\n", glass("coated", 0.2));
    let matrix = "[display.matrix]\npitch_um = 84.67\n";
    let without = resolved_with(&[lobe, &absorbing, &mirror, LIGHT, matrix, view], &by_paths(1));
    let [with, without] = [&with, &without].map(|one| {
        let control = Control { threads: Some(2), progress: &|_| {}, stop: &AtomicBool::new(false) };
        papilio_display::spatial::mtf(&one.scene, &one.patterns, &control).unwrap().views.remove(0)
    });
    let (found, expected) = (with.states.get("white").unwrap(), without.states.get("white").unwrap());
    near("Y", found.Y_via_pixel / expected.Y_via_pixel, 1.0, 0.02);
    let off = |k: usize| {
        let [found, expected] = [&found.otf, &expected.otf];
        let apart = [0, 1].map(|part| found.otf_x[k][part] - expected.otf_x[k][part]);
        apart[0].hypot(apart[1]) / (found.error_x[k].hypot(expected.error_x[k]) + 1e-4)
    };
    let worst = (0..found.otf.otf_x.len()).map(off).fold(0.0, f64::max);
    assert!(worst < 4.5 && found.otf.error_x.iter().all(|error| *error < 0.05), "{worst}");
    let line = |one: &papilio_display::spatial::MtfView| one.line_contrast_via_pixel.black_1_x.unwrap();
    let [error, other] = [&with, &without].map(|one| one.line_contrast_via_pixel_error.black_1_x.unwrap());
    near("line", line(&with), line(&without), 4.5 * error.hypot(other) + 1e-3);
    // Red pixels are white below a third of the filter.
    let of = |name: &str| with.states.get(name).unwrap().Y_via_pixel;
    assert!(of("red") < 0.5 * of("white") && of("red") > 0.3 * of("white"), "{}", of("red"));
}

/// A line below a clear filter is that on paper without filter, by Fourier transforms; in colour all figures
/// have the less gamut the higher the filter.
#[test]
fn line_below_a_filter_is_that_of_paper() {
    for (thickness_mm, tolerance) in everyday(1, [(0.2, 0.01), (0.5, 0.03)]) {
        let glass = glass("fresnel", thickness_mm);
        let with = computed(&resolved(&[&glass, PAPER, LIGHT, &filter(20.0, CLEAR)])).unwrap();
        let matrix = "[display.matrix]\npitch_um = 84.67\nlayout = \"single\"\n";
        let without = computed(&resolved(&[&glass, PAPER, LIGHT, matrix])).unwrap();
        let line = |result: &CrosstalkResult| {
            let pattern = result.views[0].patterns[2];
            assert_eq!((pattern.name, pattern.why_null), (Figure::Line, None));
            [pattern.values, pattern.error].map(|numbers| numbers.contrast_ratio_via_pixel.unwrap())
        };
        let ([found, error], [expected, _]) = (line(&with), line(&without));
        near("line", found / expected, 1.0, tolerance);
        assert!((found - expected).abs() < 3.0 * error + 0.02, "{found} {expected} {error}");
    }
    let transmittance = "red = \"data/synthetic-filter-red.csv\", green = \"data/synthetic-filter-green.csv\", \
                         blue = \"data/synthetic-filter-blue.csv\"";
    let gamuts = |height_um: f64| {
        let display = resolved(&[&glass("fresnel", 0.2), PAPER, LIGHT, &filter(height_um, transmittance)]);
        let result = computed(&display).unwrap();
        let of = |figure: usize| result.views[0].patterns[figure].values.gamut_percent_srgb.unwrap();
        [of(0), of(1), of(2)]
    };
    let (low, high) = (gamuts(1.0), gamuts(25.0));
    // A line hardly loses more: its colour is that of its own windows.
    [low, high].iter().for_each(|gamuts| near("line", gamuts[2] / gamuts[0], 1.0, 0.02));
    assert!((0..3).all(|figure| high[figure] < 0.8 * low[figure]), "{low:?} {high:?}");
}

#[test]
fn what_is_not_computed_is_refused() {
    let key = |parts: &[&str]| match computed(&resolved(parts)) {
        Err(DisplayError::PlacesByPaths { key, .. } | DisplayError::MissingLength { key, .. }) => key,
        other => panic!("{other:?}"),
    };
    let filter = filter(30.0, CLEAR);
    let lobe = "[display.diffuser]\nmodel = \"k-correlation\"\nwidth = 0.1\ntransmittance = 0.9\n";
    let front = "[[display.front]]\nreflectance = 0.1\ngap_mm = 0.1\n";
    let reflecting = format!("{lobe}[display.diffuser.reflection]\nreflectance = 0.02\n");
    assert_eq!(key(&[&reflecting, &glass("coated", 0.5), PAPER, LIGHT, &filter]), "display.layers");
    for pixel in [PAPER, &PAPER.replace("lambertian", "mirror")] {
        assert_eq!(key(&[front, lobe, &glass("coated", 0.5), pixel, LIGHT, &filter]), "display.front");
    }
    let thin = "[display.glass]\nindex = 1.5\n";
    assert_eq!(key(&[thin, PAPER, LIGHT, &filter]), "display.glass.thickness_mm");
    let resolved = resolved(&[&glass("fresnel", 0.5), PAPER, LIGHT, &filter]);
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
    let other = papilio_display::spatial::mtf(&resolved.scene, &resolved.patterns, &control);
    assert!(matches!(other, Err(DisplayError::PlacesByPaths { key, .. }) if key == "display.matrix.filter"));
}

/// Standard errors of patches by Monte Carlo, of one seed each: deviations from the mean of the seeds, which
/// is that of adding. Black is mostly light that the face reflects: with points of low discrepancy 41 of 1024
/// paths were reflected in nearly all replicates, 40.96 on average, and black was up to seven of its errors
/// off.
#[test]
fn patches_by_monte_carlo_have_honest_errors_at_every_seed() {
    let parts = [&glass("fresnel", 0.3), PAPER, LIGHT, &filter(30.0, "red = 0.7, green = 0.4, blue = 0.2")];
    let by_adding =
        run_on(&resolved_with(&parts, &["solver.relative_error=1e-4".to_owned()]).scene, Some(1)).unwrap();
    let seeds = 100..sized(108, 116);
    let walked: Vec<_> = seeds
        .map(|seed| {
            let set = ["method=monte-carlo", "paths=32768", &format!("seed={seed}")];
            let set = set.map(|key| format!("solver.{key}"));
            run_on(&resolved_with(&parts, &set).scene, Some(1)).unwrap()
        })
        .collect();
    let count = walked.len() as f64;
    let mut scores = Vec::new();
    for (name, exact) in by_adding.views[0].states.iter() {
        let of = |run: &papilio_display::result::RunResult| {
            let state = run.views[0].states.get(name).unwrap();
            (state.value.Y, state.standard_error.Y)
        };
        let centre = walked.iter().map(|run| of(run).0).sum::<f64>() / count;
        let discretisation = exact.discretisation_error.as_ref().unwrap().Y;
        near(name, centre, exact.value.Y, discretisation + 1e-3 * exact.value.Y);
        for run in &walked {
            let (value, error) = of(run);
            let z = (value - centre) / error * (count / (count - 1.0)).sqrt();
            assert!(z.abs() < 5.0, "{name}: {value} ± {error}, mean of the seeds {centre}");
            scores.push(z);
        }
    }
    // The eight states of a seed are of the same paths.
    papilio_testing::assert_student("patches below a filter", &scores, count);
}
