//! `papilio image`: a picture on the display, as the reader sees it, and what to send to the panel.

use std::path::Path;

use papilio_colour::Xyz;
use papilio_display::image::{
    ImageInRoom, ImageNumbers, ImageResult, ImageSettings, Losses, PictureDifferences, Rendition, Screen,
    ScreenSpace, ScreenWhite, Sharpness, SourceImage, image,
};
use papilio_display::palette::{PaletteColour, bytes, warn_of_room};
use papilio_display::scene::Scene;
use papilio_display::{Control, DisplayError, LightSummary};
use papilio_figures::file_names;
use papilio_formats::panel::write_states_png;
use papilio_formats::{ImageFile, TitledFile, device_colour, write_file, write_rgb_png, write_scene_exr};
use papilio_imaging::ImagingError;
use papilio_imaging::text::{Font, Setting};
use papilio_scenario::{ImageRequest, Resolved};
use serde::Serialize;

use crate::arguments::ImageCommand;
use crate::frame::{self, Frame, FrameRequest};
use crate::numbers::measured;
use crate::palette::room;
use crate::pictures::Shown;
use crate::spatial::{SpatialOutput, compute_files, show, title};
use crate::{Failure, costs, report};

/// Shows one picture, and prints its numbers.
pub(crate) fn show_one(shown: &Shown<'_>) -> Result<(), Failure> {
    let request = Request::new(shown)?;
    show(&shown.command, &request.resolved, |control| request.computed(control))
}

/// Shows one picture without printing; returns its numbers and the names of its files.
pub(crate) fn write_one(
    shown: &Shown<'_>,
    resolved: Resolved,
) -> Result<(ImageNumbers, Vec<String>), Failure> {
    let request = Request::of(shown, resolved)?;
    let (output, names) =
        compute_files(&shown.command, &request.resolved, |control| request.computed(control))?;
    Ok((output.here.numbers, names))
}

/// A picture that is shown in one or several rooms.
struct Request<'a> {
    arguments: &'a ImageCommand,
    resolved: Resolved,
    rooms: Vec<(String, Resolved)>,
    frame: Option<FrameRequest>,
    title: String,
}

impl<'a> Request<'a> {
    fn new(shown: &Shown<'a>) -> Result<Self, Failure> {
        Self::of(shown, shown.resolved()?)
    }

    /// Checks everything that can be checked before the picture is computed.
    fn of(shown: &Shown<'a>, resolved: Resolved) -> Result<Self, Failure> {
        let arguments = shown.arguments;
        crate::palette::check_rooms(&arguments.rooms)?;
        costs::check_picture(&resolved, shown.command.workers.threads)?;
        let states = resolved.scene.display.state_names();
        let frame = FrameRequest::new(&arguments.frame, image_of(&resolved)?, states)?;
        let title = title(&shown.command, &resolved);
        let of_room = |name: &String| {
            let in_room = |more| Ok(shown.scenario(more)?.resolve()?);
            Ok((name.clone(), room(in_room, &resolved, name)?))
        };
        let rooms = arguments.rooms.iter().map(of_room).collect::<Result<Vec<_>, Failure>>()?;
        Ok(Self { arguments, resolved, rooms, frame, title })
    }

    fn computed(&self, control: &Control<'_>) -> Result<ImageOutput, DisplayError> {
        let ImageRequest { source, settings, .. } =
            self.resolved.image.as_ref().ok_or(DisplayError::NoWhite { what: "a picture" })?;
        let settings = ImageSettings { losses: !self.rooms.is_empty(), ..settings.clone() };
        let white = match self.arguments.relative_to {
            Some(white) => white.into(),
            None if self.arguments.on.is_some() => ScreenWhite::Display,
            None => ScreenWhite::Perfect,
        };
        let screen = Screen { white, space: self.arguments.space };
        let part =
            |number: usize| [number, number + 1].map(|lights| lights as f64 / (1 + self.rooms.len()) as f64);
        let scene = &self.resolved.scene;
        let shown = |scene: &Scene, settings: &ImageSettings, part: [f64; 2], control: &Control<'_>| {
            let mut shown =
                control.within(part, |control| image(scene, source, settings, screen, control))?;
            shown.forget_targets();
            Ok::<_, DisplayError>(shown)
        };
        let mut here = shown(scene, &settings, part(0), control)?;
        // The panel holds its states while the light changes.
        let given = (!here.states.is_empty()).then(|| here.states.clone());
        let held = ImageSettings { given, ..settings.clone() };
        let there = |(number, (name, room)): (usize, &(String, Resolved))| {
            Ok((name.clone(), shown(&room.scene, &held, part(number + 1), control)?))
        };
        let rooms = self
            .rooms
            .iter()
            .enumerate()
            .map(there)
            .collect::<Result<Vec<(String, ImageResult)>, DisplayError>>()?;
        let numbers =
            rooms.iter().map(|(room, one)| ImageInRoom { room: room.clone(), numbers: one.numbers.clone() });
        here.numbers.rooms = numbers.collect();
        for (name, room) in &rooms {
            warn_of_room(&mut here.numbers.warnings, name, &room.numbers.warnings);
        }
        let resolved = self.rooms.iter().map(|(name, room)| (name.as_str(), room));
        self.resolved.warn_of_rooms(resolved, &mut here.numbers.warnings);
        let frame = self.frame.as_ref().map(|frame| frame.frame(&here, self.title.clone()));
        let picture = if rooms.is_empty() { Vec::new() } else { on_screen(source, here.samples_per_pixel) };
        Ok(ImageOutput { picture, rooms, here, device_colours: self.arguments.device_colours, frame })
    }
}

/// The picture of a scenario.
fn image_of(resolved: &Resolved) -> Result<&ImageRequest, Failure> {
    resolved.image.as_ref().ok_or_else(|| Failure::Input("the scenario names no picture".to_owned()))
}

/// A picture in the light of the scenario, and in other rooms.
struct ImageOutput {
    /// The picture itself, with as many pixels as what is seen; empty without rooms.
    picture: Vec<[u8; 3]>,
    here: ImageResult,
    rooms: Vec<(String, ImageResult)>,
    /// Whether states.png has the usual codes of states.
    device_colours: bool,
    /// The frame for the panel, if it was requested.
    frame: Option<Frame>,
}

/// Encoded red, green and blue of a picture, each pixel as this number of samples along each axis.
fn on_screen(source: &SourceImage, samples: usize) -> Vec<[u8; 3]> {
    let encoded =
        |[x, y, z]: &[f32; 3]| Xyz { x: f64::from(*x), y: f64::from(*y), z: f64::from(*z) }.srgb_clipped();
    let pixels: Vec<[u8; 3]> = source.pixels.iter().map(encoded).collect();
    let rows = pixels.chunks(source.columns.max(1)).flat_map(|row| std::iter::repeat_n(row, samples));
    rows.flat_map(|row| row.iter().flat_map(|pixel| std::iter::repeat_n(*pixel, samples))).collect()
}

/// Columns between the pictures of several rooms.
const BETWEEN: usize = 12;

impl ImageOutput {
    /// The picture itself and what is seen of it in all rooms, side by side on white, each below its name, its difference
    /// from the picture and the losses of the steps: number of columns, and the pixels.
    fn side_by_side(&self) -> Result<(usize, Vec<[u8; 3]>), Failure> {
        let [columns, rows] = self.here.seen_size();
        let here = ("this light", &self.here);
        let seen = std::iter::once(here).chain(self.rooms.iter().map(|(name, room)| (name.as_str(), room)));
        let mut all: Vec<([String; 2], &[[u8; 3]])> =
            vec![(["the picture".to_owned(), String::new()], &self.picture)];
        all.extend(seen.map(|(name, one)| {
            let difference = one.numbers.against_photograph.scielab_mean;
            let difference = difference.map_or(String::new(), |mean| format!(", S-CIELAB {mean:.1}"));
            let name = format!("{name}: {}{difference}", light(&one.numbers.light));
            ([name, one.numbers.losses.map_or(String::new(), in_words)], &one.on_screen[..])
        }));
        let label = |(lines, _): &([String; 2], &[[u8; 3]])| {
            let lines = lines.each_ref().map(|text| label(text, columns));
            let lines: Vec<Vec<[u8; 3]>> = lines.into_iter().collect::<Result<_, _>>()?;
            Ok(lines.concat())
        };
        let label = |one: &_| label(one).map_err(|error: ImagingError| Failure::Input(error.to_string()));
        let labels = all.iter().map(label).collect::<Result<Vec<_>, Failure>>()?;
        let row = |row: usize| {
            let parts = all.iter().zip(&labels).map(|((_, one), label)| match row.checked_sub(2 * LABEL) {
                None => &label[row * columns..][..columns],
                Some(row) => &one[row * columns..][..columns],
            });
            parts.collect::<Vec<_>>().join(&[[255; 3]; BETWEEN][..])
        };
        Ok((all.len() * (columns + BETWEEN) - BETWEEN, (0..rows + 2 * LABEL).flat_map(row).collect()))
    }
}

/// A line with the losses of the steps, if they were computed.
fn losses_line(numbers: &ImageNumbers) -> String {
    numbers.losses.map_or(String::new(), |losses| format!("S-CIELAB of each step: {}\n", in_words(losses)))
}

/// The losses of the steps in words.
fn in_words(Losses { tone, gamut, halftone, layers }: Losses) -> String {
    format!("tone {tone:.1}, gamut {gamut:.1}, halftone {halftone:.1}, layers {layers:.1}")
}

/// Rows of a line of the label above a picture, and size of its letters in pixels.
const LABEL: usize = 24;
const LETTERS_PX: f64 = 14.0;

/// A line of text on white, black, as wide as a picture; what is wider is cut off.
fn label(text: &str, columns: usize) -> Result<Vec<[u8; 3]>, ImagingError> {
    // Points and inches cancel: the em has this number of pixels.
    let setting = Setting { size_pt: LETTERS_PX, per_inch: [72.0; 2], margin: 3 };
    let ([across, down], covered) = Font::bundled().coverage(text, setting)?;
    let mut pixels = vec![[255; 3]; columns * LABEL];
    for (at, covered) in covered.iter().enumerate() {
        // Coverage begins with the lowest row.
        let (column, row) = (at % across, LABEL as isize - 1 - (at / across) as isize);
        if column < columns && row >= 0 && at / across < down {
            pixels[row as usize * columns + column] = [(255.0 * (1.0 - covered)).round() as u8; 3];
        }
    }
    Ok(pixels)
}

/// A light in words.
fn light(light: &LightSummary) -> String {
    let temperature = light.colour_temperature_k.map_or(String::new(), |kelvin| format!(", {kelvin:.0} K"));
    format!("{} lx{temperature}", light.illuminance_lx)
}

impl SpatialOutput for ImageOutput {
    const JSON: &'static str = "image.json";
    const FIGURES: &'static [&'static str] = &["seen", "rooms", "states"];

    fn content<'a>(
        &'a self,
        resolved: &'a Resolved,
        title: &'a str,
        notes: &'a [String],
    ) -> impl Serialize + 'a {
        let (papilio, hash) = (env!("CARGO_PKG_VERSION"), &resolved.hash);
        ImageFile {
            file: TitledFile { papilio, title, hash, notes, result: &self.here.numbers },
            frame: self.frame.as_ref().map(|frame| &frame.numbers),
        }
    }

    fn table(&self, title: &str) -> String {
        let mut all = text(title, &self.here);
        for (name, room) in &self.rooms {
            let numbers = &room.numbers;
            let rows = differences(numbers);
            let light = light(&numbers.light);
            all.push_str(&format!(
                "\nthe same states in the light of {name}, {light}\n{}{}",
                report::table(&rows),
                losses_line(numbers)
            ));
        }
        if let Some(frame) = &self.frame {
            all.push_str(&format!("\n{}", frame.text()));
        }
        all
    }

    /// The largest file and the states are written while the others are.
    fn write_tables(&self, folder: &Path) -> Result<Vec<String>, Failure> {
        frame::remove_old(folder)?;
        std::thread::scope(|scope| {
            let linear = scope.spawn(|| self.write_linear(folder));
            let states = scope.spawn(|| self.write_states(folder));
            let names = self.write_seen(folder);
            linear.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
            let states = states.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
            let mut names = names?;
            names.push(LINEAR.to_owned());
            names.extend(states);
            Ok(names)
        })
    }

    fn figures(&self, _: &str) -> Vec<(String, String)> {
        Vec::new()
    }

    fn notes(&self, resolved: &Resolved) -> Vec<String> {
        resolved.notes_of_places()
    }

    fn warnings(&mut self) -> &mut Vec<String> {
        &mut self.here.numbers.warnings
    }
}

/// The file of linear light.
const LINEAR: &str = "seen.exr";

impl ImageOutput {
    fn write_linear(&self, folder: &Path) -> Result<(), Failure> {
        let ImageResult { seen, white_cd_m2, .. } = &self.here;
        let [across, _] = self.here.seen_size();
        Ok(write_file(&folder.join(LINEAR), |out| {
            write_scene_exr(out, across, seen.len(), self.here.linear(), Some(*white_cd_m2))
        })?)
    }

    /// Writes pictures of what is seen, and returns their names.
    fn write_seen(&self, folder: &Path) -> Result<Vec<String>, Failure> {
        let [across, _] = self.here.seen_size();
        let mut names = Vec::new();
        let mut png = |name: String, columns: usize, pixels: &[[u8; 3]]| {
            let is_display_p3 = self.here.space == ScreenSpace::DisplayP3;
            let written =
                write_file(&folder.join(&name), |out| write_rgb_png(out, columns, pixels, is_display_p3));
            names.push(name);
            written
        };
        png("seen.png".to_owned(), across, &self.here.on_screen)?;
        let files = file_names(self.rooms.iter().map(|(name, _)| name.as_str()), "seen-", ".png");
        for ((_, room), file) in self.rooms.iter().zip(files) {
            png(file, across, &room.on_screen)?;
        }
        if !self.rooms.is_empty() {
            let (columns, pixels) = self.side_by_side()?;
            png("rooms.png".to_owned(), columns, &pixels)?;
        }
        Ok(names)
    }

    /// Writes what the panel is sent, and returns the names of the files.
    fn write_states(&self, folder: &Path) -> Result<Vec<String>, Failure> {
        let ImageResult { size: [columns, _], states, palette, .. } = &self.here;
        let mut names = Vec::new();
        if !states.is_empty() {
            let colours = palette.colours.iter();
            let shown = |one: &PaletteColour| {
                let device = device_colour(&one.state).filter(|_| self.device_colours);
                device.unwrap_or_else(|| one.srgb.map_or([0; 3], bytes))
            };
            let palette: Vec<[u8; 3]> = colours.map(shown).collect();
            write_file(&folder.join("states.png"), |out| {
                write_states_png(out, *columns, states, &palette, &self.here.numbers.states)
            })?;
            names.push("states.png".to_owned());
            if let Some(frame) = &self.frame {
                names.extend(frame.write(folder, &palette)?);
            }
        }
        Ok(names)
    }
}

fn text(title: &str, result: &ImageResult) -> String {
    let numbers = &result.numbers;
    let percent = |fraction: f64| format!("{:.2} %", 100.0 * fraction);
    let mut rows = vec![["state", "pixels"].map(str::to_owned).to_vec()];
    for (state, fraction) in numbers.coverage.iter().flat_map(|coverage| coverage.iter()) {
        rows.push(vec![state.to_owned(), percent(*fraction)]);
    }
    let [columns, lines] = numbers.size;
    let neighbours = if numbers.neighbours_light {
        "contains the light that the layers return from each pixel to others"
    } else {
        "each pixel has the colour of a uniform area of its state, without light from its neighbours"
    };
    let distance = match numbers.pixels_per_degree {
        Some(per_degree) => format!("at {per_degree:.1} pixels in a degree\n"),
        None => "S-CIELAB and FLIP need the size of the pixels: [display.matrix] with ppi or pitch_um\n"
            .to_owned(),
    };
    let sharpness = numbers.sharpness.map_or(String::new(), |Sharpness { sqri_jnd, sqri_ideal_jnd }| {
        let [x, y] = [0, 1].map(|k| format!("{:.1} JND of {:.1}", sqri_jnd[k], sqri_ideal_jnd[k]));
        format!("square-root integral of white (Barten): {x} along x, {y} along y\n")
    });
    let rendition = numbers.rendition.map_or(String::new(), |one| {
        let Rendition { exposure, contrast, saturation, .. } = one;
        let balance = one.white_balance_k.map_or(String::new(), |kelvin| format!(", {kelvin} K is white"));
        format!(
            "drawings: {} of the pixels; exposure {exposure:.2} stops, contrast of detail {contrast:.2}, saturation {saturation:.2}{balance}; {} of the \
             pixels are darker than the display's black\n",
            percent(numbers.drawing_fraction),
            percent(one.below_black_fraction)
        )
    });
    let losses = losses_line(numbers);
    let mapped = numbers.against_mapped;
    let shift = format!(
        "tone shift by halftone and layers, in blocks of 64 x 64 pixels: {:.2} % of the light, CIEDE2000 {:.2}\n",
        mapped.tone_shift_percent, mapped.tone_shift_delta_e_2000
    );
    let luminous = result.palette.colours.iter().map(|one| one.Y);
    let (darkest, lightest) = (luminous.clone().fold(f64::INFINITY, f64::min), luminous.fold(0.0, f64::max));
    let contrast =
        if darkest > 0.0 { format!(", contrast {:.1}", lightest / darkest) } else { String::new() };
    format!(
        "{}\n\n{columns} x {lines} pixels in light of {}; {neighbours}\n{}luminance of the lightest state {lightest:.3}, of the darkest \
         {darkest:.3} of a perfect white{contrast}\n\n{}{losses}{shift}{distance}{sharpness}\n{rendition}colours outside the gamut: {} of the pixels; clipped in \
         seen.png: {}\n",
        report::plain(title),
        light(&numbers.light),
        report::table(&rows),
        report::table(&differences(numbers)),
        percent(numbers.out_of_gamut_fraction),
        percent(numbers.clipped_fraction),
    )
}

/// What is seen, compared with the picture itself, and with its targets before and after gamut mapping.
fn differences(numbers: &ImageNumbers) -> Vec<Vec<String>> {
    let head = [
        "seen against",
        "S-CIELAB: mean",
        "95th pct.",
        "hue error, deg",
        "chroma",
        "local contrast",
        "FLIP: mean",
        "CIEDE2000: mean",
    ];
    let row = |name: &str, one: PictureDifferences| {
        let number = |value: Option<f64>, digits| measured(value, None, digits);
        vec![
            name.to_owned(),
            number(one.scielab_mean, 2),
            number(one.scielab_p95, 2),
            number(one.hue_error_deg, 1),
            number(one.chroma_ratio, 2),
            number(one.local_contrast_ratio, 2),
            number(one.flip_mean, 4),
            number(Some(one.delta_e_2000_mean), 2),
        ]
    };
    vec![
        head.map(str::to_owned).to_vec(),
        row("the picture", numbers.against_photograph),
        row("with the display's white and black", numbers.against_source),
        row("mapped to its gamut", numbers.against_mapped),
    ]
}
