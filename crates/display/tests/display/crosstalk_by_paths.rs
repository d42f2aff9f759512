//! Crosstalk by Monte Carlo against adding where both compute it, and against known values where only paths
//! do.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use papilio_display::spatial::{CrosstalkResult, CrosstalkView, crosstalk};
use papilio_display::{Control, DisplayError};
use papilio_scenario::{Resolved, Scenario};
use papilio_testing::{everyday, mean_square_bounds, seeds, sized};

const LOBE: &str = "[display.diffuser]\nmodel = \"k-correlation\"\nwidth = 0.05667\ntransmittance = 1.0\n";
const GLASS: &str = "[display.glass]\nindex = 1.5\nthickness_mm = 0.3\n";
const BARE: &str = "[display.glass]\nindex = 1.5\nsurface = \"fresnel\"\nthickness_mm = 0.3\n";
const MIXED: &str = "[lighting]\nilluminance_lx = 500\nspectrum = \"D65\"\ndiffuse = 0.6\n\
    [[lighting.directed]]\ntheta_deg = -25\nshare = 0.4\n";
const VIEW: &str = "[viewer]\ntheta_deg = 15\nfield_deg = 0\n";
const MATRIX: &str = "[display.matrix]\nppi = 200\n";
const PAPER: &str = "[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\nreflectance = { white = 0.6, black = 0.05 }\n";
const FILM: &str = "[display.pixel]\nmodel = \"film\"\nsubstrate = \"Al\"\n\
    area = { red = 0.5, green = 0.3, blue = 0.2 }\nfill_factor = 0.9\ninactive_reflectance = 0.2\n\
    gap_nm = { red = 276, green = 192, blue = 138, dark = 20 }\n\
    film = [{ material = \"Cr:Johnson\", thickness_nm = 12 }, { material = \"air\", thickness_nm = \"gap\" }]\n";
/// A film of one gap.
const FILM_BELOW_FILTER: &str = "[display.pixel]\nmodel = \"film\"\nsubstrate = \"Al\"\n\
    area = { red = 0.3334, green = 0.3333, blue = 0.3333 }\ngap_nm = { red = 120, green = 120, blue = 120, dark = 20 }\n\
    film = [{ material = \"Cr:Johnson\", thickness_nm = 12 }, { material = \"air\", thickness_nm = \"gap\" }]\n";
const PRINTED: &str = "[display.matrix]\npitch_um = 150\n[display.matrix.filter]\nheight_um = 40\n\
    transmittance = { red = 0.8, green = 0.5, blue = 0.2 }\n";
const FRONT: &str = "[[display.front]]\nreflectance = 0.1\ngap_mm = 0.1\n";

fn resolved(parts: &[&str], solver: &str) -> Resolved {
    let text = format!("[spectrum]\nstep_nm = 40\n{}[solver]\n{solver}\n", parts.concat());
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    Scenario::from_text(&text, "paths.toml", &folder, &[]).unwrap().resolve().unwrap()
}

fn computed(resolved: &Resolved) -> Result<CrosstalkResult, DisplayError> {
    let control = Control { threads: Some(2), progress: &|_| {}, stop: &AtomicBool::new(false) };
    crosstalk(&resolved.scene, &resolved.patterns.text, &control)
}

fn by_paths(parts: &[&str], seed: u64, paths: u64) -> CrosstalkView {
    let solver = format!("method = \"monte-carlo\"\npaths = {paths}\nseed = {seed}");
    computed(&resolved(parts, &solver)).unwrap().views.remove(0)
}

/// Numbers of a view with their errors: shares of all light and of each, and those of figures.
fn numbers(view: &CrosstalkView) -> Vec<(String, f64, f64)> {
    let mut all = Vec::new();
    let lights = view.by_light.iter().chain([("all", &view.shares)]);
    for (light, shares) in lights {
        let rows = shares.out.iter().chain(shares.in_.iter().flatten()).flatten();
        let rest = shares.inactive_out.iter().chain(shares.between_in.iter().flatten());
        let shares_of = rows.chain(rest).enumerate();
        all.extend(shares_of.map(|(k, share)| (format!("{light} {k}"), *share, shares.error)));
        let own = [shares.own_share_out, shares.own_share_in].into_iter().zip(shares.own_share_errors);
        let both = own.enumerate().filter_map(|(k, (share, error))| Some((k, share?, error?)));
        all.extend(both.map(|(k, share, error)| (format!("{light}, own {k}"), share, error)));
    }
    for pattern in &view.patterns {
        let (values, errors) = (pattern.values, pattern.error);
        for (name, value, error) in [
            ("gamut", values.gamut_percent_srgb, errors.gamut_percent_srgb),
            ("contrast", values.contrast_ratio, errors.contrast_ratio),
            ("contrast via pixel", values.contrast_ratio_via_pixel, errors.contrast_ratio_via_pixel),
        ] {
            let both = value.zip(error).into_iter();
            all.extend(both.map(|(value, error)| (format!("{:?} {name}", pattern.name), value, error)));
        }
    }
    all
}

/// Deviations of paths from adding beyond its stated errors: those of the means over seeds over their standard
/// errors, and the squares of all over those of the errors. Few paths give skewed estimates of shares, whose
/// errors are too small where the estimates are: the errors are pooled, as in
/// `papilio_testing::assert_unbiased`.
fn deviations(parts: &[&str], paths: u64) -> Vec<(String, f64, f64)> {
    // Either is below the errors of paths.
    let exact = computed(&resolved(parts, sized("relative_error = 1e-3", "relative_error = 1e-4")))
        .unwrap()
        .views
        .remove(0);
    let seeds = seeds().div_ceil(4);
    let runs: Vec<_> = (0..seeds).map(|seed| numbers(&by_paths(parts, seed, paths))).collect();
    let deviation = |(name, value, stated): (String, f64, f64)| {
        let (mut deviation, mut squares, mut errors) = (0.0, 0.0, 0.0);
        for run in &runs {
            // Text below a filter is computed by paths only.
            let Some((_, path, error)) = run.iter().find(|(other, ..)| *other == name) else {
                panic!("{name}")
            };
            deviation += (path - value) / seeds as f64;
            squares += ((path - value).abs() - stated).max(0.0).powi(2);
            errors += (error + 1e-6).powi(2);
        }
        let (error, off) = (errors.sqrt() / seeds as f64, (deviation.abs() - stated).max(0.0));
        let what = format!("{name}: {deviation} +- {error} from {value} +- {stated}, {}", squares / errors);
        (what, off / error, squares / errors)
    };
    numbers(&exact).into_iter().map(deviation).collect()
}

pub(crate) fn assert_agree(what: &str, parts: &[&str], paths: u64) {
    let all = deviations(parts, paths);
    let worst = all.iter().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
    let beyond_two = all.iter().filter(|(_, z, _)| *z > 2.0).count();
    assert!(worst.1 < 4.5 && beyond_two * 8 < all.len(), "{what}: {worst:?}, {beyond_two} of {}", all.len());
    // Shares and ratios of few paths are not normally distributed: twice the variance of a square.
    let bounds = mean_square_bounds(1.0, 5.1, seeds().div_ceil(4) as f64);
    let largest = all.iter().max_by(|a, b| a.2.total_cmp(&b.2)).unwrap();
    assert!(largest.2 <= *bounds.end(), "{what}: {largest:?}, not in {bounds:?}");
}

/// Film pixels below a lobe, with an inactive area that reflects, seen obliquely in mixed light: who lights
/// whom, stripes, lines and text.
#[test]
fn films_below_a_lobe_agree() {
    assert_agree("film", &[LOBE, GLASS, FILM, MATRIX, MIXED, VIEW], 1 << 14);
}

/// Paper below a bare face, which returns light to the figures.
#[test]
fn paper_below_a_face_agrees() {
    assert_agree("paper", &[BARE, PAPER, MATRIX, MIXED, VIEW], 1 << 14);
}

/// White paper beside text changes its contrast by less than the stated errors, however far light returns from:
/// from a front far above, too.
#[test]
fn contrast_of_text_does_not_depend_on_white_beside_it() {
    let fronts = ["", "[[display.front]]\nreflectance = 0.3\ngap_mm = 2\n"];
    for front in everyday(1, fronts) {
        let mut scene = resolved(&[front, BARE, PAPER, MATRIX, MIXED, VIEW], "relative_error = 1e-3");
        let contrasts = ["ax", "ax                        "].map(|text| {
            text.clone_into(&mut scene.patterns.text);
            let found = computed(&scene).unwrap().views.remove(0).patterns.pop().unwrap();
            (found.values.contrast_ratio_via_pixel.unwrap(), found.error.contrast_ratio_via_pixel.unwrap())
        });
        let [(alone, error), (far, error_far)] = contrasts;
        assert!((alone - far).abs() < error + error_far, "{front}: {contrasts:?}");
        assert!(error + error_far < 0.01 * alone, "{front}: {contrasts:?}");
    }
}

/// A front that reflects above a lobe: light that it returns meets the sub-pixels and figures at its places.
#[test]
fn fronts_above_a_lobe_agree_within_stated_errors() {
    let front = "[[display.front]]\nreflectance = 0.3\ngap_mm = 0.1\n";
    for (pixel, name) in everyday(1, [(FILM, "film"), (PAPER, "paper")]) {
        let parts = [front, LOBE, GLASS, pixel, MATRIX, MIXED, VIEW];
        assert_agree(name, &parts, 1 << 13);
        let exact = computed(&resolved(&parts, "relative_error = 1e-4")).unwrap().views.remove(0);
        for (number, value, stated) in numbers(&exact) {
            assert!(stated < 0.005 * value.max(0.5), "{name}, {number}: {value} +- {stated}");
        }
    }
}

/// Two fronts that are apart show images of the pixels beside the seen place, and return light from both heights: of coloured ones,
/// more at some wavelengths.
#[test]
fn fronts_that_are_apart_above_a_lobe_agree() {
    let front = |reflectance: &str, gap_mm: f64| {
        format!("[[display.front]]\nreflectance = {reflectance}\ngap_mm = {gap_mm}\n")
    };
    let grey = [front("0.3", 4.0), front("0.3", 0.1)].concat();
    let coloured = [front("\"data/synthetic-filter-red.csv\"", 0.4), front("0.2", 0.2)].concat();
    for (fronts, pixel) in everyday(1, [(&grey, FILM), (&coloured, FILM), (&grey, PAPER)]) {
        let parts = [fronts, LOBE, GLASS, pixel, MATRIX, MIXED, VIEW];
        let exact = computed(&resolved(&parts, "relative_error = 1e-2")).unwrap().views.remove(0);
        let paths = by_paths(&parts, 0, sized(1 << 16, 1 << 20));
        for ((name, value, stated), (other, path, error)) in numbers(&exact).into_iter().zip(numbers(&paths))
        {
            let z = ((path - value).abs() - stated).max(0.0) / (error + 1e-6);
            assert!(name == other && z < 4.5, "{name}: {value} +- {stated}, {path} +- {error}");
        }
    }
}

/// Mirror-like pixels below a bare face, and below a front above it: a figure is seen again at the places of
/// ghosts, and light of a page has met its neighbours before. An oblique view through front and face sees
/// further images of the pixels.
#[test]
fn mirrors_below_faces_and_fronts_agree() {
    let mirror = "[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = { white = 0.9, black = 0.3 }\n";
    let diffuse = "[lighting]\nilluminance_lx = 500\nspectrum = \"D65\"\ndiffuse = 1.0\n";
    let oblique = "[viewer]\ntheta_deg = 50\nphi_deg = 20\nfield_deg = 0\n";
    // Paper below a face and a front is compared with paths every day in the next test.
    let cases = [(FRONT, BARE, mirror), (FRONT, BARE, PAPER), ("", BARE, mirror), (FRONT, GLASS, mirror)];
    for (front, glass, pixel) in everyday(1, cases) {
        assert_agree(
            &format!("{front}{glass}{pixel}"),
            &[front, glass, pixel, MATRIX, diffuse, oblique],
            1 << 13,
        );
    }
}

/// A filter at a height above paper, below a bare face and a front: shares on the way in and out, stripes and
/// lines.
#[test]
fn filters_above_paper_agree() {
    // Lines below thin glass have short periods.
    let thin = BARE.replace("0.3", "0.1");
    assert_agree("filter", &[FRONT, &thin, PAPER, PRINTED, MIXED, VIEW], 1 << 13);
}

/// A filter above mirror-like pixels, below a bare face and a front: an oblique view sees the pixels through
/// other parts, and their ghosts.
#[test]
fn filters_above_mirrors_agree() {
    let mirror = PAPER.replace("lambertian", "mirror");
    assert_agree("filter", &[FRONT, BARE, &mirror, PRINTED, MIXED, VIEW], 1 << 13);
    assert_agree("filter below a lobe", &[LOBE, GLASS, FILM_BELOW_FILTER, PRINTED, MIXED, VIEW], 1 << 13);
}

/// Light that passes between the parts of the filter belongs to the pixel below it, of a line as of a page.
/// Along the normal, below a face that returns nothing, all patterns have the same contrast.
#[test]
fn lines_with_gaps_between_sub_pixels_have_the_contrast_of_pages() {
    let film = FILM.replace("inactive_reflectance = 0.2\n", "");
    let glass = "[display.glass]\nindex = 1.5\nsurface = \"ideal-ar\"\nthickness_mm = 0.3\n";
    let view = "[viewer]\ntheta_deg = 0\nfield_deg = 0\n";
    let display = resolved(&[glass, &film, PRINTED, MIXED, view], "method = \"adding\"");
    let patterns = computed(&display).unwrap().views.remove(0).patterns;
    let contrasts: Vec<f64> =
        patterns.iter().filter_map(|pattern| pattern.values.contrast_ratio_via_pixel).collect();
    assert!(contrasts.len() == 3, "{contrasts:?}");
    assert!(contrasts.iter().all(|contrast| (contrast / contrasts[0] - 1.0).abs() < 1e-9), "{contrasts:?}");
}

/// Oblique views of gaps, and a wide field: a line lies where the viewer sees the filter.
#[test]
fn gaps_and_wide_fields_above_mirrors_agree() {
    let film = FILM.replace("inactive_reflectance = 0.2\n", "");
    let view = "[viewer]\ntheta_deg = 20\nphi_deg = 30\nfield_deg = 10\n";
    assert_agree("gaps", &[BARE, &film, PRINTED, MIXED, view], 1 << 12);
    let mirror = "[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = { white = 0.8, black = 0.1 }\n";
    let along = "[viewer]\ntheta_deg = 0\nfield_deg = 20\n";
    assert_agree("field", &[BARE, mirror, PRINTED, MIXED, along], 1 << 12);
}

/// A wide field without a filter: along each of its directions, mirror-like pixels below flat faces show light that
/// has met the pixels at other places, and paper shows other images of itself between face and front.
#[test]
fn wide_fields_below_flat_faces_agree() {
    let mirror = "[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = { white = 0.8, black = 0.1 }\n";
    let front = "[[display.front]]\nreflectance = 0.2\ngap_mm = 0.4\n";
    let view = |theta_deg: f64| format!("[viewer]\ntheta_deg = {theta_deg}\nfield_deg = 9\n");
    let cases = [
        ("mirrors", mirror, "", 0.0),
        ("paper", PAPER, front, 0.0),
        ("mirrors, obliquely", mirror, "", 25.0),
    ];
    for (what, pixel, front, theta_deg) in everyday(1, cases) {
        assert_agree(what, &[front, BARE, pixel, MATRIX, MIXED, &view(theta_deg)], 1 << 13);
    }
}

/// Below a lobe: shares and patches, and stripes and lines, which only paths compute: they are blurred above
/// the filter, too.
#[test]
fn filters_below_a_lobe_agree() {
    let parts = [LOBE, GLASS, PAPER, PRINTED, MIXED, VIEW];
    assert_agree("filter below a lobe", &parts, 1 << 13);
    let exact = computed(&resolved(&parts, "relative_error = 1e-3")).unwrap().views.remove(0);
    let found = by_paths(&parts, 0, 1 << 13);
    for (exact, found) in exact.patterns.iter().zip(&found.patterns).skip(1) {
        assert!(exact.why_null.is_some_and(|why| why.contains("monte-carlo")), "{exact:?}");
        assert!(found.values.contrast_ratio.is_some() && found.why_null.is_none(), "{found:?}");
    }
    // Glass of 0.3 mm blurs pixels of 0.15 mm.
    let [patch, stripe] = [0, 1].map(|k| found.patterns[k].values.contrast_ratio_via_pixel.unwrap());
    assert!(stripe < 0.9 * patch, "{stripe} {patch}");
}
