//! The endpoint `/files`: stores an uploaded file, detects its kind from its content, audits it, and offers
//! edits that use it.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};

use papilio_figures::{Chart, ChartCurve, Hue, PixelScan, chart, lobes, pixel_scan};
use papilio_formats::{
    BsdfProblem, DataFile, FormatError, MapColour, MeshFile, Problem, RgbSpace, audit_text, is_height_file,
    is_luminaire, picture_format, read_bsdf, read_heights, read_index_within, read_light_map, read_luminaire,
    read_measurement, read_mesh, read_picture, read_pixel_over_half_turn, read_pixel_table, read_profile,
    read_spectrum,
};
use papilio_goniometry::{Audit, MeasuredPart, Measurement};
use papilio_scenario::{Edit, SurfaceScenario};
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Value, json};

use super::drawn::Figure;
use crate::fault::Fault;
use crate::reading::Given;
use crate::site::Site;
use crate::work::abandoned;

/// The kind of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum FileKind {
    /// A measured BSDF.
    Bsdf,
    /// A spectrum: a value for each wavelength.
    Spectrum,
    /// A refractive index: n and k.
    Material,
    /// A pixel table: reflectances of states by angle and wavelength.
    Pixel,
    /// A light map: radiance over all directions.
    Map,
    /// A luminaire (IES, EULUMDAT).
    Luminaire,
    /// A light profile: radiance by inclination.
    Profile,
    /// Measurements of a panel.
    Panel,
    /// A picture for the display.
    Picture,
    /// A surface by its geometry: TOML with the table `[microgeometry]`.
    Surface,
    /// Heights of a surface.
    Heights,
    /// Triangles of a surface.
    Mesh,
}

/// A stored file.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Kept {
    /// Its id in requests: the SHA-256 of its bytes.
    id: String,
    /// Its name.
    name: String,
    /// Its kind.
    kind: FileKind,
    /// The lines of its audit.
    words: Vec<String>,
    /// Drawings of its contents.
    figures: Vec<Figure>,
    /// The possible uses of the file.
    edits: Vec<Offer>,
}

/// A use of a file.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Offer {
    /// A description of the use.
    label: String,
    /// The edits of the scenario.
    edits: Vec<Edit>,
}

/// The contents of a file.
struct Contents {
    kind: FileKind,
    words: Vec<String>,
    figures: Vec<Figure>,
    edits: Vec<Offer>,
}

pub(super) async fn file(site: Site, name: String, bytes: Vec<u8>) -> Result<Kept, Fault> {
    let server = site.clone();
    site.files()
        .work(move |stop| {
            let file = DataFile { name, bytes };
            let Contents { kind, words, figures, edits } = read_contents(&server, &file, stop)?;
            let name = file.name.clone();
            Ok(Kept { id: server.store().insert(file), name, kind, words, figures, edits })
        })
        .await
}

/// Maximum number of pixels of a picture: linear light needs 12 bytes for each.
const MOST_PIXELS: usize = 16_000_000;

/// Detects the kind of a file from its content, and reads it. The readers are tried from the most specific to
/// the most general one.
fn read_contents(site: &Site, file: &DataFile, stop: &AtomicBool) -> Result<Contents, Fault> {
    // Other pictures than PNG and JPEG are refused by their names; a TIFF file holds heights.
    if picture_format(&file.bytes).is_some_and(|format| format != "TIFF") {
        return picture(file);
    }
    match read_bsdf(file) {
        Ok(read) => return scattering(file, &read.value, &read.warnings, stop),
        Err(FormatError { problem: Problem::Bsdf(problem), .. }) if *problem == BsdfProblem::Unknown => {}
        Err(error) => return Err(error.into()),
    }
    if is_luminaire(file) {
        return luminaire(file);
    }
    if let Some(contents) = geometry(site, file) {
        return contents;
    }
    if file.bytes.starts_with(b"#?") || file.bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        return map(file).or_else(|fault| heights(file).map_err(|_| fault));
    }
    let text = String::from_utf8_lossy(&file.bytes);
    let mut rows = text.lines().filter(|line| !line.trim_start().starts_with('#'));
    let head: Vec<&str> = rows.next().unwrap_or_default().split([',', ';', '\t']).map(str::trim).collect();
    if read_pixel_table(file).is_ok() || (head.contains(&"state") && head.contains(&"reflectance")) {
        return pixel(file);
    }
    if head.contains(&"state") || head.contains(&"metric") {
        return panel(file);
    }
    if let Ok(read) = read_spectrum(file) {
        return Ok(spectrum(file, read.wavelengths_nm(), read.values()));
    }
    match read_profile(file) {
        Ok(points) => Ok(profile(file, &points)),
        // The message about a material is the clearest one.
        Err(_) => material(file).or_else(|fault| panel(file).or_else(|_| heights(file)).map_err(|_| fault)),
    }
}

/// Reads a surface, its heights or its triangles; `None` for other files.
fn geometry(site: &Site, file: &DataFile) -> Option<Result<Contents, Fault>> {
    if is_height_file(&file.bytes) {
        return Some(heights(file));
    }
    let Ok(text) = file.text() else {
        return read_mesh(file).ok().map(|read| Ok(mesh(file, &read)));
    };
    if text.lines().any(|line| line.trim_start().starts_with("[microgeometry")) {
        return Some(surface(site, file, text));
    }
    let is_mesh = text.trim_start().starts_with("solid") || text.lines().any(|line| line.starts_with("v "));
    is_mesh.then(|| Ok(mesh(file, &read_mesh(file)?)))
}

/// Reads the keys of a surface. Its own files are read when it is measured.
fn surface(site: &Site, file: &DataFile, text: &str) -> Result<Contents, Fault> {
    let none = Given { scenario: text.to_owned(), files: BTreeMap::new() };
    SurfaceScenario::from_text(text, &file.name, none.library(site)?, &[])?;
    // Few rays: the page measures the surface while the scenario is read.
    let face = json!({ "model": "microgeometry", "surface": file.name, "rays": 20_000 });
    let offer = offer(
        "Use as the face of the glass, in place of the diffuser",
        [remove("display.glass.surface"), remove("display.layers"), set("display.diffuser", face)],
    );
    let words = vec![format!("{}: surface by its geometry, as for `papilio gonio`", file.name)];
    Ok(Contents { kind: FileKind::Surface, words, figures: vec![], edits: vec![offer] })
}

fn heights(file: &DataFile) -> Result<Contents, Fault> {
    let read = read_heights(file)?;
    let rows = read.numbers.len() / read.columns.max(1);
    let mut words = vec![format!("{}: map of {} x {rows} heights", file.name, read.columns)];
    words.push(match read.pitch_um {
        Some([x, y]) => format!("{x} um apart along x, {y} um along y"),
        None => "it does not state the distance of its heights".to_owned(),
    });
    words.extend(read.warnings.iter().map(|warning| format!("warning: {warning}")));
    Ok(Contents { kind: FileKind::Heights, words, figures: vec![], edits: vec![] })
}

fn mesh(file: &DataFile, read: &MeshFile) -> Contents {
    let words = vec![format!("{}: mesh of {} triangles", file.name, read.triangles.len())];
    Contents { kind: FileKind::Mesh, words, figures: vec![], edits: vec![] }
}

fn scattering(
    file: &DataFile,
    measurement: &Measurement,
    warnings: &[String],
    stop: &AtomicBool,
) -> Result<Contents, Fault> {
    let audit = |part: &MeasuredPart| match stop.load(Ordering::Relaxed) {
        true => Err(abandoned()),
        false => Ok(Audit::of(part, part.luminous())),
    };
    let audits: Vec<Option<Audit>> = measurement.parts.iter().map(audit).collect::<Result<_, _>>()?;
    let mut words: Vec<String> =
        audit_text(&file.name, measurement, &audits).lines().map(str::to_owned).collect();
    words.extend(warnings.iter().map(|warning| format!("warning: {warning}")));
    let transmits = measurement.parts.iter().any(|part| part.way.is_transmission());
    let diffuser = json!({ "model": "measured", "file": file.name });
    let offer = offer(
        "Use as the diffuser",
        [remove("display.glass.surface"), remove("display.layers"), set("display.diffuser", diffuser)],
    );
    Ok(Contents {
        kind: FileKind::Bsdf,
        words,
        figures: lobes(measurement, &audits).into_iter().map(|(name, svg)| Figure { name, svg }).collect(),
        edits: transmits.then_some(offer).into_iter().collect(),
    })
}

fn luminaire(file: &DataFile) -> Result<Contents, Fault> {
    let read = read_luminaire(file)?;
    let mut words = vec![
        format!("{}: luminaire", file.name),
        format!("opening: {}", read.opening.in_words()),
        format!("luminous flux: {:.1} lm", read.flux_lm()[0]),
    ];
    words.extend(read.notes.iter().cloned());
    let points = (0..=180).map(|deg| (f64::from(deg), read.intensity(f64::from(deg), 0.0))).collect();
    let drawn = drawn("intensity", ["Angle from the nadir (deg)", "Intensity (cd)"], vec![points]);
    let light = json!({ "model": "luminaire", "file": file.name, "elevation_deg": 60, "azimuth_deg": 90,
        "distance_m": 3, "share": 1 });
    Ok(Contents { kind: FileKind::Luminaire, words, figures: vec![drawn], edits: vec![all_light(light)] })
}

fn map(file: &DataFile) -> Result<Contents, Fault> {
    let read = read_light_map(file)?;
    let channel = |colour: MapColour| match colour {
        MapColour::Red => "red".to_owned(),
        MapColour::Green => "green".to_owned(),
        MapColour::Blue => "blue".to_owned(),
        MapColour::Grey => "grey".to_owned(),
        MapColour::Wavelength(nm) => format!("{nm} nm"),
    };
    let channels: Vec<String> = read.channels.iter().map(|one| channel(one.colour)).collect();
    let words = vec![
        format!("{}: light map of {} by {} pixels", file.name, read.width, read.height),
        format!("channels: {}", channels.join(", ")),
    ];
    let light = json!({ "model": "map", "file": file.name, "share": 1 });
    Ok(Contents { kind: FileKind::Map, words, figures: vec![], edits: vec![all_light(light)] })
}

fn pixel(file: &DataFile) -> Result<Contents, Fault> {
    let read = read_pixel_over_half_turn(file)?;
    let table = read.value;
    let states: Vec<String> = table.states.iter().map(|(name, _)| name.clone()).collect();
    let (theta, nm) = (&table.theta_deg, &table.wavelength_nm);
    let ends = |values: &[f64]| [values.first(), values.last()].map(|end| end.copied().unwrap_or_default());
    let ([low, high], [first, last]) = (ends(theta), ends(nm));
    let mut words = vec![
        format!("{}: pixel table of {} states: {}", file.name, states.len(), states.join(", ")),
        format!(
            "{} angles from {low} to {high} deg, {} wavelengths from {first} to {last} nm",
            theta.len(),
            nm.len()
        ),
    ];
    let azimuths = table.phi_deg.len();
    if let Some(step) = (azimuths > 0).then(|| (1800.0 / azimuths as f64).round() / 10.0) {
        words.push(format!(
            "{azimuths} azimuths in steps of {step} deg over half a turn; the figure shows the first"
        ));
    }
    words.extend(read.warnings);
    let (bins, of_angle) = (nm.len().max(1), azimuths.max(1));
    let rows = table.states.iter().flat_map(|(_, values)| values.chunks(bins).step_by(of_angle));
    let reflectance: Vec<f64> = rows.flatten().copied().collect();
    let scan = PixelScan {
        states: &states,
        medium: "the table's medium",
        theta_deg: theta,
        wavelength_nm: nm,
        reflectance: &reflectance,
    };
    let figures = vec![Figure { name: "pixel".to_owned(), svg: pixel_scan(&scan, "") }];
    let pixel = |angles: &str| {
        let pixel = json!({ "model": "table", "file": file.name, "angles": angles });
        offer(
            &format!("Use as the pixel; the angles of the table are in {angles}"),
            [set("display.pixel", pixel)],
        )
    };
    Ok(Contents { kind: FileKind::Pixel, words, figures, edits: vec![pixel("glass"), pixel("air")] })
}

fn panel(file: &DataFile) -> Result<Contents, Fault> {
    let read = read_measurement(file)?;
    let (states, metrics) = (read.value.states.len(), read.value.metrics.len());
    let what = match metrics {
        0 => format!("{states} measurements (states and directions)"),
        _ => format!("{metrics} metrics"),
    };
    let mut words = vec![
        format!("{}: measured panel, {what}", file.name),
        "compare it with a simulated panel: `papilio compare`; fit a scenario to it: `papilio fit`"
            .to_owned(),
    ];
    words.extend(read.warnings.iter().map(|note| format!("note: {note}")));
    Ok(Contents { kind: FileKind::Panel, words, figures: vec![], edits: vec![] })
}

fn picture(file: &DataFile) -> Result<Contents, Fault> {
    let read = read_picture(file, &RgbSpace::srgb())?;
    let (columns, rows) = (read.value.columns(), read.value.rows());
    if columns * rows > MOST_PIXELS {
        let most = MOST_PIXELS / 1_000_000;
        let message = format!(
            "{}: a picture of {columns} x {rows} pixels is too large for the page: at most {most} megapixels",
            file.name
        );
        return Err(Fault::too_much(message, "reduce it, or use `papilio image`, which reads 64 megapixels"));
    }
    let mut words =
        vec![format!("{}: picture of {columns} x {rows} pixels, {}", file.name, read.value.space())];
    words.extend(read.warnings.iter().map(|warning| format!("note: {warning}")));
    let image = offer("Use as the picture of the scenario", [set("image.file", json!(file.name))]);
    Ok(Contents { kind: FileKind::Picture, words, figures: vec![], edits: vec![image] })
}

fn spectrum(file: &DataFile, nm: &[f64], values: &[f64]) -> Contents {
    let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let smallest = values.iter().copied().fold(f64::INFINITY, f64::min);
    let words = vec![
        format!("{}: spectrum, {}", file.name, wavelengths(nm)),
        format!("values from {smallest} to {largest}"),
    ];
    let points = nm.iter().copied().zip(values.iter().copied()).collect();
    let drawn = drawn("spectrum", ["Wavelength (nm)", "Value"], vec![points]);
    let mut edits = vec![offer("Use as the light's spectrum", [set("lighting.spectrum", json!(file.name))])];
    if smallest >= 0.0 && largest <= 1.0 {
        let path = "display.diffuser.transmission";
        edits.push(offer(
            "Use as the transmission spectrum of a measured diffuser",
            [set(path, json!(file.name))],
        ));
    } else if smallest >= 1.0 && largest < 10.0 {
        let glass = [set("display.glass.index", json!(file.name))];
        edits.insert(0, offer("Use as the refractive index of the glass", glass));
    }
    Contents { kind: FileKind::Spectrum, words, figures: vec![drawn], edits }
}

fn profile(file: &DataFile, points: &[(f64, f64)]) -> Contents {
    let words = vec![format!("{}: light profile, {} angles", file.name, points.len())];
    let drawn = drawn("profile", ["Angle (deg)", "Relative radiance"], vec![points.to_vec()]);
    let light = json!({ "model": "profile", "file": file.name, "share": 1 });
    Contents { kind: FileKind::Profile, words, figures: vec![drawn], edits: vec![all_light(light)] }
}

fn material(file: &DataFile) -> Result<Contents, Fault> {
    // A display needs the index at visible wavelengths.
    let read = read_index_within(file, (380.0, 780.0))?;
    let index = read.value;
    let (first, last) = index.range_nm();
    let mut words = vec![format!("{}: refractive index from {first} to {last} nm", file.name)];
    words.extend(read.warnings.iter().map(|note| format!("note: {note}")));
    let (from, to) = (first.max(300.0), last.min(1000.0));
    let at = (0..=140).map(|k| from + (to - from) * f64::from(k) / 140.0);
    let seen: Vec<(f64, _)> = at.filter_map(|nm| Some((nm, index.index(nm).ok()?))).collect();
    let n = seen.iter().map(|(nm, index)| (*nm, index.re)).collect();
    let k = seen.iter().map(|(nm, index)| (*nm, index.im)).collect();
    let drawn = drawn("index", ["Wavelength (nm)", "n and k"], vec![n, k]);
    let offers = [("the glass", "display.glass.index"), ("the pixel's substrate", "display.pixel.substrate")];
    let edits = offers.map(|(what, path)| offer(&format!("Use as {what}"), [set(path, json!(file.name))]));
    Ok(Contents { kind: FileKind::Material, words, figures: vec![drawn], edits: edits.into() })
}

fn wavelengths(nm: &[f64]) -> String {
    let ends = [nm.first(), nm.last()].map(|end| end.copied().unwrap_or_default());
    format!("{} wavelengths from {} to {} nm", nm.len(), ends[0], ends[1])
}

/// Draws curves in one diagram.
fn drawn(name: &str, [x, y]: [&str; 2], curves: Vec<Vec<(f64, f64)>>) -> Figure {
    let curve = |(group, points)| ChartCurve {
        name: String::new(),
        hue: Hue::Group(group + 2),
        dashed: false,
        marks: false,
        points,
    };
    let (x, y) = (x.to_owned(), y.to_owned());
    let curves = curves.into_iter().enumerate().map(curve).collect();
    let svg = chart(&Chart { x, y, logarithmic: false, at_least: vec![0.0], curves }, "");
    Figure { name: name.to_owned(), svg }
}

/// Offers to replace all ambient light by an environment.
fn all_light(light: Value) -> Offer {
    let others = ["lighting.preset", "lighting.diffuse", "lighting.directed"];
    let edits = others.map(remove).into_iter().chain([set("lighting.environment", json!([light]))]);
    Offer { label: "Use as the only ambient light".to_owned(), edits: edits.collect() }
}

fn offer<const N: usize>(label: &str, edits: [Edit; N]) -> Offer {
    Offer { label: label.to_owned(), edits: edits.into() }
}

fn set(path: &str, value: Value) -> Edit {
    Edit::Set { path: path.to_owned(), value }
}

fn remove(path: &str) -> Edit {
    Edit::Remove { path: path.to_owned() }
}
