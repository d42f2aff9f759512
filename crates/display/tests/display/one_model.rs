//! One display in two commands: the figures of crosstalk are those that the spread of `mtf` draws.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use papilio_display::Control;
use papilio_display::spatial::{CrosstalkResult, MtfResult, SpreadTable, crosstalk, mtf};
use papilio_scenario::Scenario;
use papilio_testing::everyday;

const LOBE: &str = "[display.diffuser]\nmodel = \"k-correlation\"\nwidth = 0.05667\ntransmittance = 1.0\n";
const LIGHT: &str = "[lighting]\nilluminance_lx = 500\nspectrum = \"D65\"\ndiffuse = 1.0\n";
const BESIDE: &str = "[lighting]\nilluminance_lx = 500\nspectrum = \"D65\"\ndiffuse = 0.0\ndirected = [{ theta_deg = -15, share = 1.0 }]\n";
const VIEW: &str = "[viewer]\ntheta_deg = 0\nfield_deg = 0\n";
const OBLIQUE: &str = "[viewer]\ntheta_deg = 40\nfield_deg = 0\n";
const MATRIX: &str = "[display.matrix]\nppi = 127\nlayout = \"single\"\n";

/// Pixels of this kind whose two states differ by 0.3 %.
fn pixels(kind: &str) -> String {
    format!(
        "[display.pixel]\nmodel = \"uniform\"\nkind = \"{kind}\"\nreflectance = {{ white = 0.7, black = 0.698 }}\n"
    )
}

fn front(reflectance: f64, gap_mm: f64) -> String {
    format!("[[display.front]]\nreflectance = {reflectance}\ngap_mm = {gap_mm}\n")
}

fn glass(surface: &str, thickness_mm: f64) -> String {
    format!("[display.glass]\nindex = 1.5\nsurface = \"{surface}\"\nthickness_mm = {thickness_mm}\n")
}

fn computed(parts: &[&str]) -> (MtfResult, CrosstalkResult) {
    let text = format!("[spectrum]\nstep_nm = 80\n[solver]\nrelative_error = 1e-3\n{}", parts.concat());
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let resolved = Scenario::from_text(&text, "one-model.toml", &folder, &[]).unwrap().resolve().unwrap();
    let stop = AtomicBool::new(false);
    let control = Control { threads: Some(2), progress: &|_| {}, stop: &stop };
    let sharpness = mtf(&resolved.scene, &resolved.patterns, &control).unwrap();
    (sharpness, crosstalk(&resolved.scene, " ", &control).unwrap())
}

/// Integral of an edge spread from one place to another, um; linear between its places.
fn integral(table: &SpreadTable, from: f64, to: f64) -> f64 {
    let at = |x: f64| {
        let next = table.position_um.partition_point(|place| *place < x);
        match (next.checked_sub(1), table.position_um.get(next)) {
            (None, _) => 0.0,
            (_, None) => 1.0,
            (Some(last), Some(there)) => {
                let [x0, e0, e1] =
                    [table.position_um[last], table.edge_spread[last], table.edge_spread[next]];
                e0 + (e1 - e0) * (x - x0) / (there - x0)
            }
        }
    };
    let mut places = vec![from];
    places.extend(table.position_um.iter().filter(|x| (from..to).contains(*x)));
    places.push(to);
    // The edge of a sharp image is a step.
    let middle = |pair: &[f64]| 0.5 * (at(pair[0] + 1e-9) + at(pair[1] - 1e-9)) * (pair[1] - pair[0]);
    places.windows(2).map(middle).sum()
}

/// Of the light of a column of pixels, the mean over a pixel that is so many columns away.
fn of_column(table: &SpreadTable, pitch_um: f64, away: f64) -> f64 {
    let after = integral(table, away * pitch_um, (away + 1.0) * pitch_um);
    let before = integral(table, (away - 1.0) * pitch_um, away * pitch_um);
    (after - before) / pitch_um
}

/// Lines and stripes that differ little from their page change its light by as much as the spread of the page
/// says, for every top, pixel, front, thickness and light that both commands know.
#[test]
fn figures_of_crosstalk_follow_from_the_spread_of_mtf() {
    let mut all = Vec::new();
    for (reflectance, gap_mm) in [(0.2, 0.5), (0.2, 0.0), (0.0, 0.0)] {
        for turn in 0..2 {
            let front = if reflectance > 0.0 { front(reflectance, gap_mm) } else { String::new() };
            let below = [
                ("", "fresnel", "lambertian", LIGHT, VIEW),
                ("", "fresnel", "mirror", LIGHT, OBLIQUE),
                (LOBE, "coated", "lambertian", LIGHT, VIEW),
                (LOBE, "coated", "mirror", LIGHT, VIEW),
                (LOBE, "coated", "mirror", BESIDE, VIEW),
            ];
            for (number, (top, surface, kind, light, view)) in below.into_iter().enumerate() {
                // Every day, each of them below one thickness.
                let thickness_mm = [0.5, 0.1][(turn + number) % 2];
                all.push((front.clone(), glass(surface, thickness_mm), top, pixels(kind), light, view));
            }
        }
    }
    for (front, glass, top, pixel, light, view) in everyday(5, all) {
        let scene = format!("{front}{top}{glass}{pixel}{light}");
        let (sharpness, crosstalk) = computed(&[&front, top, &glass, &pixel, light, MATRIX, view]);
        let state = sharpness.views[0].states.get("white").unwrap();
        let table = state.spread.iter().find(|table| table.light == "all" && table.axis == 0).unwrap();
        let pitch_um = sharpness.pitch_um.unwrap()[0];
        let patterns = &crosstalk.views[0].patterns;
        let lost = |k: usize| 1.0 - 1.0 / patterns[k].values.contrast_ratio_via_pixel.unwrap();
        let line = of_column(table, pitch_um, 0.0);
        // Of light from farther away than the table, half comes from black stripes.
        let most = (table.position_um[table.position_um.len() - 1] / pitch_um) as i32 / 2 * 2 - 2;
        let columns: Vec<f64> = (-most..=most).map(|k| of_column(table, pitch_um, f64::from(k))).collect();
        let far = 1.0 - columns.iter().sum::<f64>();
        let stripes = columns.iter().step_by(2).sum::<f64>() + 0.5 * far;
        for (number, expected, name) in [(2, line, "line"), (1, stripes, "stripes")] {
            let found = match name {
                "line" => lost(number) / lost(0),
                // Black stripes have white ones beside them, seen in the same light.
                _ => 0.5 * (1.0 + lost(number) / lost(0)),
            };
            assert!((found - expected).abs() < 4e-3, "{scene}{name}: {found} {expected}");
        }
    }
}
