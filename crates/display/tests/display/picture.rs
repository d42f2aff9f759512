//! Pictures on paper below a flat face: pages of `run`, figures of `crosstalk`, errors, and what is refused.

use std::f64::consts::PI;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use papilio_display::image::{HeldPicture, PictureSurround};
use papilio_display::spatial::{Figure, Picture, PictureColours, Precision, crosstalk, picture};
use papilio_display::{Control, DisplayError};
use papilio_scenario::{Resolved, Scenario};

use crate::common;

const GLASS: &str = "[display.glass]\nindex = 1.5\nsurface = \"fresnel\"\nthickness_mm = 0.5\n";
const MATRIX: &str = "[display.matrix]\npitch_um = 200\n";
const PAPER: &str = "[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\nreflectance = { white = 0.6, grey = 0.3, black = 0.03 }\n";
const LIGHT: &str = "[lighting]\nilluminance_lx = 500\nspectrum = \"A\"\ndiffuse = 0.6\n[[lighting.directed]]\ntheta_deg = -45\nshare = 0.4\n";

fn resolved(parts: &[&str]) -> Resolved {
    let text = format!("[spectrum]\nstep_nm = 40\n{}[solver]\nrelative_error = 1e-5\n", parts.concat());
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    Scenario::from_text(&text, "picture.toml", &folder, &[]).unwrap().resolve().unwrap()
}

fn computed(
    resolved: &Resolved,
    states: &Picture,
    precision: Precision,
) -> Result<PictureColours, DisplayError> {
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
    picture(&resolved.scene, states, precision, &control)
}

fn near(what: &str, found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() < tolerance, "{what}: {found} against {expected}");
}

#[test]
fn uniform_pictures_are_pages_of_a_run() {
    let view = "[viewer]\ntheta_deg = [8, 40]\nfield_deg = 0\n";
    let display = resolved(&[GLASS, MATRIX, PAPER, LIGHT, view]);
    let run = common::run(&display.scene).unwrap();
    for state in 0..3_u8 {
        let page = Picture { count: [6, 5], states: vec![state; 30] };
        let found = computed(&display, &page, Precision::FAST).unwrap();
        assert!(found.error < 1e-5, "{}", found.error);
        for (found, view) in found.views.iter().zip(&run.views) {
            let value = &view.states.iter().nth(usize::from(state)).unwrap().1.value;
            for (found, expected) in found[7].iter().zip([value.X, value.Y, value.Z]) {
                near("page", f64::from(*found), expected, 2e-5);
            }
        }
    }
}

/// Below glass that is much thinner than a pixel each pixel is a page of its own, and a picture needs few
/// cells; at all thicknesses the stated error holds against smaller cells.
#[test]
fn pixels_below_thin_glass_are_pages() {
    let view = "[viewer]\ntheta_deg = 8\nfield_deg = 0\n";
    let at = |thickness_mm: f64| {
        let glass = GLASS.replace("0.5", &thickness_mm.to_string());
        resolved(&[&glass, MATRIX, PAPER, LIGHT, view])
    };
    let mixed = Picture { count: [12, 10], states: (0..120).map(|k| (k * k % 3) as u8).collect() };
    let pages: Vec<f32> = (0..3_u8)
        .map(|state| {
            let page = Picture { count: [4, 4], states: vec![state; 16] };
            computed(&at(0.5), &page, Precision::FAST).unwrap().views[0][5][1]
        })
        .collect();
    for thickness_mm in [1e-12, 1e-9, 1e-6] {
        let found = computed(&at(thickness_mm), &mixed, Precision::FAST).unwrap();
        for (found, state) in found.views[0].iter().zip(&mixed.states) {
            near("thin", f64::from(found[1]), f64::from(pages[usize::from(*state)]), 1e-4);
        }
    }
    for thickness_mm in [0.01, 0.03, 0.1, 0.2] {
        let display = at(thickness_mm);
        let [fast, fine] = [Precision::FAST, Precision { cell: 0.05, most_per_pixel: 32, ..Precision::FINE }]
            .map(|precision| computed(&display, &mixed, precision).unwrap());
        for (fast_pixel, fine_pixel) in fast.views[0].iter().zip(&fine.views[0]) {
            let bound = fast.error + fine.error;
            near(
                &format!("{thickness_mm} mm"),
                f64::from(fast_pixel[1]),
                f64::from(fine_pixel[1]),
                1.5 * bound + 1e-4,
            );
        }
    }
}

/// Every second column black: the contrast of both columns is that of `crosstalk`, which solves stripes by
/// other cells. The error of a fast picture is as large as it says.
#[test]
fn columns_have_the_contrast_of_stripes() {
    let display = resolved(&[GLASS, MATRIX, PAPER, LIGHT, "[viewer]\ntheta_deg = 8\nfield_deg = 0\n"]);
    let columns =
        Picture { count: [8, 6], states: (0..48).map(|k| if k % 2 == 0 { 0 } else { 2 }).collect() };
    let fine = computed(&display, &columns, Precision { cell: 0.05, ..Precision::FINE }).unwrap();
    let fast = computed(&display, &columns, Precision::FAST).unwrap();
    let contrast = f64::from(fine.views[0][2][1]) / f64::from(fine.views[0][1][1]);
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
    let figures = crosstalk(&display.scene, " ", &control).unwrap();
    let stripes = figures.views[0].patterns[1];
    assert_eq!(stripes.name, Figure::Stripe);
    near("contrast", contrast / stripes.values.contrast_ratio.unwrap(), 1.0, 1e-3);
    let pairs = fast.views[0].iter().flatten().zip(fine.views[0].iter().flatten());
    let off = pairs.map(|(fast, fine)| f64::from((fast - fine).abs())).fold(0.0, f64::max);
    assert!(off < 1e-3 && off < 3.0 * fast.error + 1e-5, "{off} {}", fast.error);
}

/// Reflectance of the face of a medium of index 1.5 from inside, unpolarised (Fresnel).
fn from_inside(cos: f64) -> f64 {
    let sin_outside = 1.5 * (1.0 - cos * cos).sqrt();
    if sin_outside >= 1.0 {
        return 1.0;
    }
    let cos_outside = (1.0 - sin_outside * sin_outside).sqrt();
    let [s, p] =
        [(1.5 * cos, cos_outside), (cos, 1.5 * cos_outside)].map(|(a, b)| ((a - b) / (a + b)).powi(2));
    0.5 * (s + p)
}

/// Irradiance of a square of pixels over that of light from outside, rows from the bottom, for pixels of this
/// reflectance and a mask around them: each of 9 x 9 parts of a pixel sends Lambertian light by the face at the height `h` to
/// the place `r` away, `R 4 h^2/(pi (r^2 + 4 h^2)^2)` of it.
fn irradiance_in_a_mask(side: usize, pitch_mm: f64, height_mm: f64, reflectance: f64) -> Vec<f64> {
    const PARTS: usize = 9;
    let part_mm = pitch_mm / PARTS as f64;
    let way = 2.0 * height_mm;
    let kernel = |x: f64, y: f64| {
        let square = x * x + y * y + way * way;
        from_inside(way / square.sqrt()) * way * way / (PI * square * square)
    };
    let many = side * PARTS;
    let table: Vec<f64> = (0..many * many)
        .map(|at| kernel((at % many) as f64 * part_mm, (at / many) as f64 * part_mm) * part_mm * part_mm)
        .collect();
    // From all parts of one pixel to all of another, as many pixels away.
    let parts = || (0..PARTS * PARTS).map(|part| [part % PARTS, part / PARTS]);
    let sent = |[right, up]: [usize; 2]| {
        let to = |[x, y]: [usize; 2]| -> f64 {
            let from = |[i, j]: [usize; 2]| {
                table[(PARTS * up + y).abs_diff(j) * many + (PARTS * right + x).abs_diff(i)]
            };
            parts().map(from).sum()
        };
        parts().map(to).sum::<f64>() / (PARTS * PARTS) as f64
    };
    let by_distance: Vec<f64> = (0..side * side).map(|at| sent([at % side, at / side])).collect();
    let between = |from: usize, to: usize| {
        by_distance[(from / side).abs_diff(to / side) * side + (from % side).abs_diff(to % side)]
    };
    let count = side * side;
    let transfer: Vec<f64> =
        (0..count * count).map(|at| reflectance * between(at % count, at / count)).collect();
    let mut light = vec![1.0; count];
    for _ in 0..40 {
        let next =
            |row: &[f64]| 1.0 + row.iter().zip(&light).map(|(share, light)| share * light).sum::<f64>();
        light = transfer.chunks_exact(count).map(next).collect();
    }
    light
}

/// White pixels in a black mask, against light by place that is summed pixel by pixel. In glass of 0.5 mm the corners of
/// a square of 1.6 mm are brighter than its middle: light is reflected totally at 0.9 mm from where it began.
#[test]
fn a_mask_around_a_picture_returns_no_light() {
    let paper = PAPER.replace("black = 0.03", "black = 0.0");
    let names = ["white", "grey", "black"].map(str::to_owned).to_vec();
    let view = "[viewer]\ntheta_deg = 0\nfield_deg = 0\n";
    let page_returns = {
        let steps = 20_000;
        let cosines = (0..steps).map(|k| (f64::from(k) + 0.5) / f64::from(steps));
        2.0 * cosines.map(|cos| from_inside(cos) * cos).sum::<f64>() / f64::from(steps)
    };
    for (glass_mm, pitch_um) in [(0.5, 200.0), (0.2, 350.0), (1.3, 100.0)] {
        let glass = GLASS.replace("0.5", &glass_mm.to_string());
        let matrix = format!("[display.matrix]\npitch_um = {pitch_um}\n");
        let display = resolved(&[&glass, &matrix, &paper, LIGHT, view]);
        let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
        let seen = |state: u8, surround: PictureSurround| {
            let held = HeldPicture { size: [8, 8], states: vec![state; 64], names: names.clone(), surround };
            let found = held.factors(&display.scene, &control).unwrap();
            let y = |k: usize| found.lights.iter().map(|one| f64::from(one.pixels[k][1])).sum::<f64>();
            ((0..64).map(y).collect::<Vec<f64>>(), found.error)
        };
        let (faces, _) = seen(2, PictureSurround::Repeat);
        let (page, _) = seen(0, PictureSurround::Repeat);
        let (masked, error) = seen(0, PictureSurround::BlackMask);
        assert!(error < 2e-3, "{error}");
        let of_page = 1.0 / (1.0 - 0.6 * page_returns);
        let light = irradiance_in_a_mask(8, 1e-3 * pitch_um, glass_mm, 0.6);
        for (found, light) in masked.iter().zip(light) {
            let expected = faces[0] + (page[0] - faces[0]) * light / of_page;
            near(&format!("{glass_mm} mm"), *found, expected, error + 1e-3);
        }
    }
}

/// A front light. What is seen of grey states is linear in their light: uniform pages determine the line, and
/// pages are those of paths.
#[test]
fn front_light_brightens_pictures_as_pages() {
    let view = "[viewer]\ntheta_deg = 8\nfield_deg = 0\n";
    let guide = "[lighting.front_light]\nilluminance_lx = 700\nspectrum = \"LED-B5\"\nupward_leak = 0.1\n";
    let [without, with] = ["", guide].map(|guide| resolved(&[GLASS, MATRIX, PAPER, LIGHT, guide, view]));
    let seen = |display: &Resolved, states: Vec<u8>| -> Vec<f64> {
        let page = Picture { count: [12, 10], states };
        let found = computed(display, &page, Precision::FINE).unwrap();
        found.views[0].iter().map(|colour| f64::from(colour[1])).collect()
    };
    let page = |display: &Resolved, state: u8| seen(display, vec![state; 120])[0];
    let paths = "[solver]\nmethod = \"monte-carlo\"\npaths = 4096\n";
    let text = [GLASS, MATRIX, PAPER, LIGHT, guide, view].concat();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let by_paths =
        Scenario::from_text(&format!("[spectrum]\nstep_nm = 40\n{text}{paths}"), "p.toml", &folder, &[]);
    let run = common::run(&by_paths.unwrap().resolve().unwrap().scene).unwrap();
    for state in 0..3_u8 {
        let (_, of_paths) = run.views[0].states.iter().nth(usize::from(state)).unwrap();
        let error = of_paths.standard_error.Y;
        near("page by paths", page(&with, state), of_paths.value.Y, 5.0 * error + 1e-4);
    }
    let [white, black] = [0, 2].map(|state| [page(&without, state), page(&with, state)]);
    let slope = (white[1] - black[1]) / (white[0] - black[0]);
    assert!(slope > 1.5, "{slope}");
    let mixed: Vec<u8> = (0..120).map(|k| (k * k % 7 % 3) as u8).collect();
    for (without, with) in seen(&without, mixed.clone()).into_iter().zip(seen(&with, mixed)) {
        near("pixel", with, black[1] + slope * (without - black[0]), 1e-4);
    }
}

#[test]
fn pictures_that_are_not_computed_are_refused() {
    let page = Picture { count: [2, 2], states: vec![0, 1, 2, 0] };
    let refused = |parts: &[&str]| computed(&resolved(parts), &page, Precision::FAST).unwrap_err();
    assert_eq!(refused(&[GLASS, PAPER, LIGHT]), DisplayError::NoMatrix { command: "picture" });
    let thin = "[display.glass]\nindex = 1.5\nsurface = \"fresnel\"\n";
    let missing =
        DisplayError::MissingLength { key: "display.glass.thickness_mm".to_owned(), others: Vec::new() };
    assert_eq!(refused(&[thin, MATRIX, PAPER, LIGHT]), missing);
    let mirror = PAPER.replace("lambertian", "mirror");
    let error = refused(&[GLASS, MATRIX, &mirror, LIGHT]);
    assert!(
        matches!(&error, DisplayError::PlacesNotComputed { key, .. } if key == "display.pixel"),
        "{error}"
    );
    let display = resolved(&[GLASS, MATRIX, PAPER, LIGHT]);
    for wrong in [vec![0, 1, 2, 3], vec![0]] {
        let error = computed(&display, &Picture { states: wrong, ..page.clone() }, Precision::FAST);
        assert!(matches!(error, Err(DisplayError::NoSuchQuantity { .. })), "{error:?}");
    }
}
