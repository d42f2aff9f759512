//! The endpoints `/image` and `/image/export`: a picture on the display, as by `papilio image`.
//!
//! `/image` responds with the picture in each light of the room, which the page adds up: lamps that become brighter need no request. The
//! picture of the page has few pixels: of a larger display a smaller one with the same pixels is computed. The server holds the states of
//! recent pictures, so that a moved lamp or eye needs no new halftone. `/image/export` writes the files of the command line, in full size; all
//! files of one picture are those of one computation.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use axum::http::StatusCode;
use papilio_display::image::{
    Factors, Halftone, HeldPicture, ImageResult, LampImage, Screen, SourceImage, exact,
};
use papilio_display::palette::bytes as encoded;
use papilio_display::scene::{Drive, Pixel, Scene};
use papilio_display::{Control, DisplayError};
use papilio_formats::panel::{
    FrameNumbers, HeaderHead, Mounting, Packing, PanelFrame, write_frame_header, write_indexed_bmp,
};
use papilio_formats::{TitledFile, palette_files, write_indexed_png, write_json, write_rgb_png};
use papilio_imaging::{Fit, fitted};
use papilio_scenario::{Edit, ImageRequest, PanelCodes, Resolved};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::export::Exported;
use super::packed::{push_bytes, push_pixels, with_head};
use super::written::bytes;
use crate::fault::{Fault, shortened};
use crate::held::WrittenPicture;
use crate::reading::{Given, Solver, edited};
use crate::site::Site;

/// The picture that the page shows if the scenario has none.
const OWN_PICTURE: &str = "data/page.png";

/// Largest numbers of pixels along the longer and the shorter side of the picture of the page.
const MOST_SIDES: [usize; 2] = [480, 360];

/// Maximum number of pixels of a picture that is written to a file.
const MOST_WRITTEN: usize = 4_000_000;

/// Maximum number of lights: as many pictures are computed and sent.
const MOST_LIGHTS: usize = 16;

/// A request for a picture on the display.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct PictureOf {
    /// The scenario: TOML.
    scenario: String,
    /// Ids of uploaded files by their names in the scenario.
    #[serde(default)]
    files: BTreeMap<String, String>,
    /// Name of an uploaded picture; null: that of the scenario, or one of the program's own.
    #[serde(default)]
    picture: Option<String>,
    /// Halftone, as `image.halftone`; null: that of the scenario.
    #[serde(default)]
    halftone: Option<String>,
    /// Inclination of the eye, degrees; null: that of the first view.
    #[serde(default)]
    theta_deg: Option<f64>,
    /// Azimuth of the eye, degrees; null: that of the first view.
    #[serde(default)]
    phi_deg: Option<f64>,
    /// Key of a picture that the panel holds; null: the states are decided in the light and view of this request.
    #[serde(default)]
    held: Option<String>,
}

/// The head of a response. After it come, each with a length that is a multiple of 4 bytes: if `held` is not null, the state of each pixel
/// (8 bits); X, Y, Z of each pixel in each light (16-bit floating point, the lowest byte first), relative to the Y of a perfect white in all light; and, if
/// `has_source`, X, Y, Z of the picture itself under D65.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct PictureHead {
    /// Number of columns and rows; rows begin at the top.
    size: [usize; 2],
    /// Number of columns and rows of the display, if the scenario has it.
    panel: Option<[usize; 2]>,
    /// Period of the pixels along x and y, mm, if the scenario has it.
    pitch_mm: Option<[f64; 2]>,
    /// Distance of the eye, mm.
    distance_mm: f64,
    /// Inclination of the eye, degrees.
    theta_deg: f64,
    /// Azimuth of the eye, degrees.
    phi_deg: f64,
    /// Illuminance, lx.
    illuminance_lx: f64,
    /// Key of the picture that the panel holds; null: without a halftone, pixels have exact colours and no states.
    held: Option<String>,
    /// Whether the states were decided for another light, that of `image.prepared_for`.
    prepared_elsewhere: bool,
    /// Names of the states.
    states: Vec<String>,
    /// The lights.
    lights: Vec<PictureLight>,
    /// The sub-pixels, if their places are known and each of them shows its colour or is dark.
    sub_pixels: Vec<SubPixelSeen>,
    /// X, Y, Z of a page of each state in all light, relative to a perfect white.
    colours: Vec<[f64; 3]>,
    /// Fraction of the panel in each state; without a halftone, that of a halftone with the same mean colour.
    coverage: Vec<f64>,
    /// Mirror images of lamps, which the picture does not contain.
    lamps: Vec<LampSeen>,
    /// Whether the picture itself follows.
    has_source: bool,
    /// Whether the light that layers return from each pixel to its neighbours is computed.
    neighbours_light: bool,
    /// Estimated error of X, Y, Z of a pixel.
    error: f64,
    /// Warnings.
    warnings: Vec<String>,
}

/// A light of the room.
#[derive(Debug, Serialize, JsonSchema)]
struct PictureLight {
    /// Its name: `diffuse`, `directed.0`, `environment.0`, `front_light`; `all`: all of them together, without a halftone.
    light: String,
    /// X, Y, Z of a perfect white in this light, relative to the Y of a perfect white in all light.
    white: [f64; 3],
}

/// The mirror image of a lamp.
#[derive(Debug, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the field's own letters")]
struct LampSeen {
    /// Name of the light: `directed.0`, ...
    light: String,
    /// Direction from the display to an eye that sees the middle of the image: to the right, upwards, and away from the panel; of length 1.
    towards: [f64; 3],
    /// Half of the angle across the lamp, degrees.
    radius_deg: f64,
    /// Whether its light is collimated, so that it has no luminance: it is drawn as a small disc.
    is_collimated: bool,
    /// X, Y, Z of the image on a pixel in each state, relative to a perfect white in all light; in addition to all other light.
    XYZ: Vec<[f64; 3]>,
}

/// A sub-pixel.
#[derive(Debug, Serialize, JsonSchema)]
struct SubPixelSeen {
    /// Its rectangles x0, y0, x1, y1 in fractions of the pixel, from the lower left corner.
    window: Vec<[f64; 4]>,
    /// The fraction of it that shows its colour in each state.
    shown: Vec<f64>,
}

pub(super) async fn image(site: Site, request: PictureOf) -> Result<Vec<u8>, Fault> {
    let server = site.clone();
    site.quick().work(move |stop| computed(&server, request, stop)).await
}

/// What a response shows.
struct Answer {
    resolved: Resolved,
    /// Number of columns and rows of the display.
    panel: Option<[usize; 2]>,
    /// Key of the picture that the panel holds.
    held: Option<String>,
    prepared_elsewhere: bool,
    names: Vec<String>,
    states: Vec<u8>,
    factors: Factors,
    /// The picture itself.
    source: Option<SourceImage>,
}

fn computed(site: &Site, request: PictureOf, stop: &AtomicBool) -> Result<Vec<u8>, Fault> {
    let control = Control { threads: None, progress: &|_| {}, stop };
    let eye = [request.theta_deg, request.phi_deg];
    let given = Given { scenario: request.scenario, files: request.files };
    let answer = match request.held {
        Some(key) => still_held(site, given, key, eye, &control)?,
        None => {
            let chosen = Chosen { picture: request.picture, halftone: request.halftone };
            brought(site, given, &chosen, eye, &control)?
        }
    };
    packed(answer)
}

/// A picture that the panel holds, in the light and view of a request.
fn still_held(
    site: &Site,
    given: Given,
    key: String,
    eye: [Option<f64>; 2],
    control: &Control<'_>,
) -> Result<Answer, Fault> {
    let picture = site.held().get(&key).ok_or_else(|| {
        let message = format!("the picture `{}` is no longer held", shortened(&key));
        Fault::new(StatusCode::GONE, message, "request it again without `held`")
    })?;
    let (_, mut resolved) = given.resolve(site, Solver::Adding)?;
    seen_from(&mut resolved.scene, eye)?;
    let panel = resolved.scene.display.matrix.as_ref().and_then(|matrix| matrix.pixels);
    let factors = factors(site, &picture, &resolved, control)?;
    let (names, states) = (picture.names.clone(), picture.states.clone());
    let (held, prepared_elsewhere, source) = (Some(key), false, None);
    Ok(Answer { resolved, panel, held, prepared_elsewhere, names, states, factors, source })
}

/// A picture that is brought to the panel in the light and view of a request.
fn brought(
    site: &Site,
    given: Given,
    chosen: &Chosen,
    eye: [Option<f64>; 2],
    control: &Control<'_>,
) -> Result<Answer, Fault> {
    let (given, panel) = with_picture(site, given, chosen, Some(MOST_SIDES))?;
    let mut resolved = given.resolve_with_picture(site)?;
    seen_from(&mut resolved.scene, eye)?;
    let ImageRequest { source, settings, .. } = resolved.image.take().ok_or_else(no_picture)?;
    let (scene, source) = (&resolved.scene, reduced(source, MOST_SIDES));
    let fault = |error: DisplayError| Fault::of(&resolved, error);
    let has_one_state = scene.display.state_names().len() == 1;
    if settings.halftone == Halftone::None && settings.given.is_none() && !has_one_state {
        check_lights(scene)?;
        let compute = |prepared: &mut _| exact(scene, &source, &settings, prepared, control);
        let found = site.prepared().with(scene, control, compute);
        let (names, factors) = found.map_err(fault)?;
        let (held, prepared_elsewhere, states, source) = (None, false, Vec::new(), Some(source));
        return Ok(Answer { resolved, panel, held, prepared_elsewhere, names, states, factors, source });
    }
    let is_elsewhere = !settings.prepared_for.is_empty();
    let key = format!("{} {:?} {:?}", resolved.hash, scene.viewer.theta_deg, scene.viewer.phi_deg);
    let picture = match site.held().get(&key) {
        Some(picture) => picture,
        None => {
            let decide = |prepared: &mut _| HeldPicture::with(scene, &source, &settings, prepared, control);
            let picture = Arc::new(site.prepared().with(scene, control, decide).map_err(fault)?);
            site.held().insert(key.clone(), picture.clone());
            picture
        }
    };
    let factors = factors(site, &picture, &resolved, control)?;
    let (names, states) = (picture.names.clone(), picture.states.clone());
    let (held, prepared_elsewhere, source) = (Some(key), is_elsewhere, Some(source));
    Ok(Answer { resolved, panel, held, prepared_elsewhere, names, states, factors, source })
}

fn factors(
    site: &Site,
    picture: &HeldPicture,
    resolved: &Resolved,
    control: &Control<'_>,
) -> Result<Factors, Fault> {
    let scene = &resolved.scene;
    check_lights(scene)?;
    let mut known = site.held().known();
    let compute = |prepared: &mut _| picture.factors_with(scene, prepared, &mut known, control);
    let found = site.prepared().with(scene, control, compute);
    site.held().set_known(known);
    found.map_err(|error| Fault::of(resolved, error))
}

fn packed(answer: Answer) -> Result<Vec<u8>, Fault> {
    let Answer { resolved, panel, held, prepared_elsewhere, names, states, factors, source } = answer;
    let scene = &resolved.scene;
    let viewer = &scene.viewer;
    let first = |angles: &[f64]| angles.first().copied().unwrap_or_default();
    let lights = factors.lights.iter();
    let is_held = held.is_some();
    let mut out = with_head(&PictureHead {
        size: factors.size,
        panel,
        pitch_mm: scene.display.matrix.as_ref().map(|matrix| matrix.pitch_mm),
        distance_mm: viewer.distance_mm,
        theta_deg: first(&viewer.theta_deg),
        phi_deg: first(&viewer.phi_deg),
        illuminance_lx: scene.lighting.illuminance_lx,
        held,
        prepared_elsewhere,
        lights: lights.map(|one| PictureLight { light: one.light.clone(), white: one.white }).collect(),
        sub_pixels: if is_held { sub_pixels(scene, &names) } else { Vec::new() },
        states: names,
        colours: factors.pages.clone(),
        coverage: factors.coverage.clone(),
        lamps: factors.lamps.iter().map(LampSeen::of).collect(),
        has_source: source.is_some(),
        neighbours_light: factors.neighbours_light,
        error: factors.error,
        warnings: resolved.warnings.clone(),
    })?;
    push_bytes(&mut out, &states);
    factors.lights.iter().for_each(|light| push_pixels(&mut out, &light.pixels));
    if let Some(source) = source {
        push_pixels(&mut out, &source.pixels);
    }
    Ok(out)
}

impl LampSeen {
    fn of(image: &LampImage) -> Self {
        let LampImage { light, towards, radius_deg, is_collimated, XYZ } = image.clone();
        Self { light, towards, radius_deg, is_collimated, XYZ }
    }
}

/// Replaces the directions of the eye by one.
fn seen_from(scene: &mut Scene, [theta_deg, phi_deg]: [Option<f64>; 2]) -> Result<(), Fault> {
    scene.viewer = scene.viewer.with_view(0);
    set_angle(&mut scene.viewer.theta_deg, theta_deg, "theta_deg", 89.0)?;
    set_angle(&mut scene.viewer.phi_deg, phi_deg, "phi_deg", 360.0)
}

/// Replaces an angle of the view.
fn set_angle(angles: &mut Vec<f64>, wanted: Option<f64>, name: &str, most: f64) -> Result<(), Fault> {
    match wanted {
        None => Ok(()),
        Some(angle) if angle.abs() <= most => {
            *angles = vec![angle];
            Ok(())
        }
        Some(_) => Err(Fault::malformed(format!("{name} must be from -{most} to {most} deg"))),
    }
}

/// What is chosen on the page instead of what the scenario says.
struct Chosen {
    /// Name of an uploaded picture.
    picture: Option<String>,
    halftone: Option<String>,
}

/// Returns the scenario with a picture, and the numbers of columns and rows of its display. With `most`, larger displays get fewer pixels.
fn with_picture(
    site: &Site,
    given: Given,
    chosen: &Chosen,
    most: Option<[usize; 2]>,
) -> Result<(Given, Option<[usize; 2]>), Fault> {
    let scenario = given.scenario(site, Solver::Adding)?;
    let (display, image) = (scenario.filled_at("display"), scenario.filled_at("image"));
    let panel: Option<[usize; 2]> = serde_json::from_value(display["matrix"]["pixels"].clone()).ok();
    let set = |path: &str, value: Value| Edit::Set { path: path.to_owned(), value };
    let mut edits = Vec::new();
    if let (Some(panel), Some(most)) = (panel, most) {
        let most = along(panel, most);
        edits.push(set("display.matrix.pixels", json!([panel[0].min(most[0]), panel[1].min(most[1])])));
    }
    let sources = ["file", "text", "pattern"];
    let is_given = sources.iter().any(|key| image.get(key).is_some_and(|value| !value.is_null()));
    let picture = chosen.picture.as_deref();
    edits.extend(chosen.halftone.as_ref().map(|halftone| set("image.halftone", json!(halftone))));
    if let Some(name) = picture.or_else(|| (!is_given).then_some(OWN_PICTURE)) {
        if !is_given || picture.is_some() {
            edits.extend(sources.map(|key| Edit::Remove { path: format!("image.{key}") }));
        }
        edits.push(set("image.file", json!(name)));
    }
    Ok((Given { scenario: edited(given.scenario, &edits)?, files: given.files }, panel))
}

/// Orders the largest lengths of two sides as those of a picture.
fn along(size: [usize; 2], [longer, shorter]: [usize; 2]) -> [usize; 2] {
    if size[0] >= size[1] { [longer, shorter] } else { [shorter, longer] }
}

/// Reduces a picture that is too large.
fn reduced(source: SourceImage, most: [usize; 2]) -> SourceImage {
    let from = [source.columns, source.pixels.len() / source.columns.max(1)];
    let most = along(from, most);
    let ratio = [0, 1].map(|k| most[k] as f64 / from[k].max(1) as f64).into_iter().fold(1.0, f64::min);
    if ratio >= 1.0 {
        return source;
    }
    let to = from.map(|length| ((length as f64 * ratio).round() as usize).max(1));
    let row = |at: usize| source.pixels[at * from[0]..][..from[0]].to_vec();
    SourceImage { columns: to[0], pixels: fitted(from, row, to, Fit::Stretch, [0.0; 3]) }
}

fn check_lights(scene: &Scene) -> Result<(), Fault> {
    let lights = 2 + scene.lighting.directed.len() + scene.lighting.environment.len();
    if lights <= MOST_LIGHTS {
        return Ok(());
    }
    let message = format!("the picture of the page needs at most {} lamps and environments", MOST_LIGHTS - 2);
    Err(Fault::too_much(message, "`papilio image` has no such limit"))
}

fn no_picture() -> Fault {
    Fault::internal("the scenario has no picture")
}

/// The sub-pixels of a film pixel whose places are known.
fn sub_pixels(scene: &Scene, names: &[String]) -> Vec<SubPixelSeen> {
    let (Some(matrix), Pixel::Film(film)) = (&scene.display.matrix, &scene.display.pixel) else {
        return Vec::new();
    };
    let drives = |name: &String| film.states.iter().find(|state| state.name == *name).map(|one| &one.drives);
    let shown = |number: usize| -> Option<Vec<f64>> {
        let share = |name: &String| match drives(name)?.get(number)? {
            Drive::Share(share) => Some(*share),
            _ => None,
        };
        names.iter().map(share).collect()
    };
    let all = matrix.sub_pixels.iter().enumerate().map(|(number, one)| {
        let window = one.window.rectangles.iter().map(|one| [one.x[0], one.y[0], one.x[1], one.y[1]]);
        Some(SubPixelSeen { window: window.collect(), shown: shown(number)? })
    });
    let all: Option<Vec<_>> = all.collect();
    all.filter(|all| all.len() == film.sub_pixels.len()).unwrap_or_default()
}

/// A request for a file of a picture on the display.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct PictureFileOf {
    /// The scenario: TOML.
    scenario: String,
    /// Ids of uploaded files by their names in the scenario.
    #[serde(default)]
    files: BTreeMap<String, String>,
    /// Name of an uploaded picture; null: that of the scenario, or one of the program's own.
    #[serde(default)]
    picture: Option<String>,
    /// Halftone, as `image.halftone`; null: that of the scenario.
    #[serde(default)]
    halftone: Option<String>,
    /// Inclination of the eye, degrees; null: that of the first view.
    #[serde(default)]
    theta_deg: Option<f64>,
    /// Azimuth of the eye, degrees; null: that of the first view.
    #[serde(default)]
    phi_deg: Option<f64>,
    /// `states.png`, `seen.png`, `image.json`, a frame for the panel (`frame.bin`, `frame.bmp`, `frame.h`), or a file of `papilio palette`, such as
    /// `palette.gpl`.
    what: String,
}

pub(super) async fn export(site: Site, request: PictureFileOf) -> Result<Exported, Fault> {
    let server = site.clone();
    site.long().work(move |stop| exported(&server, request, stop)).await
}

fn exported(site: &Site, request: PictureFileOf, stop: &AtomicBool) -> Result<Exported, Fault> {
    let PictureFileOf { scenario, files, picture, halftone, theta_deg, phi_deg, what } = request;
    let chosen = Chosen { picture, halftone };
    let (given, panel) = with_picture(site, Given { scenario, files }, &chosen, None)?;
    check_size(panel.map_or(0, |[columns, rows]| columns.saturating_mul(rows)))?;
    let mut resolved = given.resolve_with_picture(site)?;
    seen_from(&mut resolved.scene, [theta_deg, phi_deg])?;
    let request = resolved.image.take().ok_or_else(no_picture)?;
    check_size(request.source.pixels.len())?;
    let viewer = &resolved.scene.viewer;
    let key = format!("{} {:?} {:?}", resolved.hash, viewer.theta_deg, viewer.phi_deg);
    // All files of a picture are often saved, one request each, and the search for the best states takes seconds.
    let found = match site.held().written(&key) {
        Some(found) => found,
        None => {
            let found = Arc::new(in_full_size(&resolved, &request, stop)?);
            site.held().insert_written(key, found.clone());
            found
        }
    };
    file(&found, &resolved, request.codes, &what)
}

fn in_full_size(
    resolved: &Resolved,
    request: &ImageRequest,
    stop: &AtomicBool,
) -> Result<WrittenPicture, Fault> {
    let control = Control { threads: None, progress: &|_| {}, stop };
    let (scene, white) = (&resolved.scene, Screen::default());
    let found = papilio_display::image::image(scene, &request.source, &request.settings, white, &control);
    let ImageResult { size, states, on_screen, mut numbers, palette, .. } =
        found.map_err(|error| Fault::of(resolved, error))?;
    resolved.warn_before(&mut numbers.warnings);
    Ok(WrittenPicture { size, states, on_screen, numbers, palette })
}

fn check_size(pixels: usize) -> Result<(), Fault> {
    if pixels <= MOST_WRITTEN {
        return Ok(());
    }
    let message = format!("a picture of {pixels} pixels is too large for the page: at most {MOST_WRITTEN}");
    Err(Fault::too_much(message, "use `papilio image`, which has no such limit"))
}

fn file(
    found: &WrittenPicture,
    resolved: &Resolved,
    codes: Option<PanelCodes>,
    what: &str,
) -> Result<Exported, Fault> {
    let columns = found.size[0];
    let title = resolved.title.as_deref().unwrap_or_default();
    let colours = found.palette.colours.iter();
    let palette: Vec<(&str, [u8; 3])> =
        colours.map(|one| (one.state.as_str(), one.srgb.map_or([0; 3], encoded))).collect();
    let (kind, bytes) = match what {
        "states.png" | "frame.bin" | "frame.bmp" | "frame.h" if found.states.is_empty() => {
            let message = "a picture without halftone has no states".to_owned();
            return Err(Fault::too_much(message, "choose a halftone, such as `error-diffusion`"));
        }
        "states.png" => {
            let palette: Vec<[u8; 3]> = palette.iter().map(|(_, colour)| *colour).collect();
            ("image/png", bytes(|out| write_indexed_png(out, columns, &found.states, &palette))?)
        }
        "frame.bin" | "frame.bmp" | "frame.h" => {
            let colours: Vec<[u8; 3]> = palette.iter().map(|(_, colour)| *colour).collect();
            ("application/octet-stream", frame(found, codes, title, (what, &colours))?)
        }
        "seen.png" => ("image/png", bytes(|out| write_rgb_png(out, columns, &found.on_screen, false))?),
        "image.json" => {
            let papilio = env!("CARGO_PKG_VERSION");
            let (hash, notes) = (&resolved.hash, &resolved.notes_of_places());
            let file = TitledFile { papilio, title, hash, notes, result: &found.numbers };
            ("application/json", bytes(|out| write_json(out, &file))?)
        }
        _ => {
            let mut files = palette_files(title, &palette).into_iter();
            let file = files.find(|(name, _)| *name == what);
            ("application/octet-stream", file.ok_or_else(|| Fault::unknown("export", what))?.1)
        }
    };
    Ok(Exported { kind, bytes })
}

/// A frame with the codes and the packing of the scenario's controller, or else with the numbers of the states.
fn frame(
    found: &WrittenPicture,
    codes: Option<PanelCodes>,
    title: &str,
    (what, colours): (&str, &[[u8; 3]]),
) -> Result<Vec<u8>, Fault> {
    let numbered = || PanelCodes {
        controller: None,
        of_states: found.palette.names().into_iter().zip(0..=u8::MAX).collect(),
    };
    let PanelCodes { controller, of_states } = codes.unwrap_or_else(numbered);
    let packing = Packing::chosen(None, controller.map(|controller| controller.packing), &of_states);
    let packing = packing.map_err(|_| Fault::internal("a code without bits"))?;
    let of: Vec<u8> = of_states.iter().map(|(_, code)| *code).collect();
    let frame = PanelFrame::new(found.size, &found.states, &of, Mounting::default());
    let packed = frame.packed(packing);
    bytes(|out| match what {
        "frame.bin" => out.write_all(&packed),
        "frame.bmp" => {
            let palette: Vec<(u8, [u8; 3])> = of.iter().copied().zip(colours.iter().copied()).collect();
            write_indexed_bmp(out, &frame, packing.bits(), &palette)
        }
        _ => {
            let numbers = FrameNumbers::new(&frame, (packing, Mounting::default()), controller, &of_states);
            let program = concat!("papilio ", env!("CARGO_PKG_VERSION"));
            write_frame_header(out, HeaderHead { program, title, numbers: &numbers }, &packed)
        }
    })
}
