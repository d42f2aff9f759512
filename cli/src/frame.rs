//! The frame that `papilio image` writes for the controller of a panel: bytes, BMP, C header, and what changed.

use std::path::Path;

use papilio_display::image::{Halftone, ImageResult};
use papilio_formats::panel::{
    ChangedPixels, FrameNumbers, HeaderHead, Mounting, Packing, PanelFrame, RequestedPacking, ShownStates,
    changed_rectangle, read_shown_states, write_frame_header, write_indexed_bmp, write_mask_png,
};
use papilio_formats::{DataFile, LARGEST_PICTURE_FILE, write_file};
use papilio_scenario::{ImageRequest, PanelCodes};

use crate::arguments::{FrameArguments, FrameForm, Packed};
use crate::{Failure, output};

/// Names of all files of a frame.
const FILES: [&str; 4] = ["frame.bin", "frame.bmp", "frame.h", "changed.png"];

/// A frame that was requested, before its states are known.
pub(crate) struct FrameRequest {
    codes: PanelCodes,
    packing: Packing,
    forms: Vec<FrameForm>,
    /// Whether the codes are the numbers of the states.
    is_numbered: bool,
    mounting: Mounting,
    /// The frame that the panel shows.
    since: Option<ShownStates>,
}

impl FrameRequest {
    /// What the arguments request; `known` are the states of the display. Checks everything that can be checked
    /// before the picture is computed.
    pub(crate) fn new(
        arguments: &FrameArguments,
        request: &ImageRequest,
        known: Vec<String>,
    ) -> Result<Option<Self>, Failure> {
        let forms = forms(arguments);
        if forms.is_empty() && arguments.since.is_none() {
            return match (arguments.rotate, arguments.mirror) {
                (None, false) => Ok(None),
                (Some(_), _) => Err(no_frame("--rotate")),
                (None, true) => Err(no_frame("--mirror")),
            };
        }
        if request.settings.halftone == Halftone::None {
            return Err(input(
                "image.halftone = \"none\" gives no pixel a state, and a frame consists of states",
                "choose another halftone, such as \"error-diffusion\"",
            ));
        }
        let settings = &request.settings;
        let states = if settings.states.is_empty() { known } else { settings.states.clone() };
        let codes = match &request.codes {
            Some(codes) => codes.clone(),
            None => numbered(states)?,
        };
        let packing = packing(arguments.packed, &codes)?;
        let mounting =
            Mounting { quarter_turns: arguments.rotate.unwrap_or_default(), is_mirrored: arguments.mirror };
        let columns = request.source.columns.max(1);
        let size = [columns, request.source.pixels.len() / columns];
        let since = arguments.since.as_deref().map(|path| shown(path, size, &codes)).transpose()?;
        let is_numbered = request.codes.is_none();
        Ok(Some(Self { codes, packing, forms, is_numbered, mounting, since }))
    }

    /// The frame of a picture; `title` is that of its scenario.
    pub(crate) fn frame(&self, result: &ImageResult, title: String) -> Frame {
        let Self { codes, forms, since, .. } = self;
        let (packing, mounting) = (self.packing, self.mounting);
        let of_states: Vec<u8> = codes.of_states.iter().map(|(_, code)| *code).collect();
        let frame = PanelFrame::new(result.size, &result.states, &of_states, mounting);
        let changed = since.as_ref().map(|shown| {
            let differ: Vec<bool> =
                shown.states.iter().zip(&result.states).map(|(before, now)| before != now).collect();
            mounting.turned(result.size, &differ)
        });
        let numbers = FrameNumbers {
            changed: changed.as_ref().map(|changed| ChangedPixels {
                pixels: changed.iter().filter(|one| **one).count(),
                rectangle: changed_rectangle(frame.size[0], packing, changed),
            }),
            ..FrameNumbers::new(&frame, (packing, mounting), codes.controller, &codes.of_states)
        };
        let (forms, is_numbered) = (forms.clone(), self.is_numbered);
        Frame { frame, title, packing, forms, is_numbered, changed, numbers }
    }
}

/// A frame for the controller of a panel.
pub(crate) struct Frame {
    frame: PanelFrame,
    /// Title of the scenario.
    title: String,
    packing: Packing,
    forms: Vec<FrameForm>,
    /// Whether the codes are the numbers of the states.
    is_numbered: bool,
    /// Whether each pixel differs from what the panel shows.
    changed: Option<Vec<bool>>,
    pub(crate) numbers: FrameNumbers,
}

impl Frame {
    /// Writes its files; `colours` are those of the states. Returns their names.
    pub(crate) fn write(&self, folder: &Path, colours: &[[u8; 3]]) -> Result<Vec<String>, Failure> {
        let mut names = Vec::new();
        let bytes = self.frame.packed(self.packing);
        for form in &self.forms {
            let name = match form {
                FrameForm::Bytes => "frame.bin",
                FrameForm::Bmp => "frame.bmp",
                FrameForm::Header => "frame.h",
            };
            write_file(&folder.join(name), |out| match form {
                FrameForm::Bytes => out.write_all(&bytes),
                FrameForm::Bmp => {
                    let codes = self.numbers.codes.iter().map(|(_, code)| *code);
                    let palette: Vec<(u8, [u8; 3])> = codes.zip(colours.iter().copied()).collect();
                    write_indexed_bmp(out, &self.frame, self.packing.bits(), &palette)
                }
                FrameForm::Header => {
                    let program = concat!("papilio ", env!("CARGO_PKG_VERSION"));
                    let head = HeaderHead { program, title: &self.title, numbers: &self.numbers };
                    write_frame_header(out, head, &bytes)
                }
            })?;
            names.push(name.to_owned());
        }
        if let Some(changed) = &self.changed {
            write_file(&folder.join("changed.png"), |out| write_mask_png(out, self.frame.size[0], changed))?;
            names.push("changed.png".to_owned());
        }
        Ok(names)
    }

    /// A line or two for the terminal.
    pub(crate) fn text(&self) -> String {
        let FrameNumbers { size: [columns, rows], bits, planes, changed, .. } = &self.numbers;
        let packing = if *planes { "planes" } else { "bits for each pixel" };
        let codes: Vec<String> =
            self.numbers.codes.iter().map(|(state, code)| format!("{state} {code}")).collect();
        let codes = codes.join(", ");
        let numbered = " (the numbers of the states: display.pixel.codes states those of a controller)";
        let numbered = if self.is_numbered { numbered } else { "" };
        let mut text =
            format!("frame: {columns} x {rows} pixels, {bits} {packing}; codes: {codes}{numbered}\n");
        if let Some(ChangedPixels { pixels, rectangle }) = changed {
            let rectangle = rectangle.map_or(String::new(), |[x, y, width, height]| {
                format!(", in {width} x {height} pixels from column {x}, row {y}")
            });
            text.push_str(&format!("changed: {pixels} pixels{rectangle}\n"));
        }
        text
    }
}

/// Removes the files of an earlier frame.
pub(crate) fn remove_old(folder: &Path) -> Result<(), Failure> {
    output::remove(folder, |name| FILES.contains(&name))
}

/// The forms that are written, each once.
fn forms(arguments: &FrameArguments) -> Vec<FrameForm> {
    let mut forms: Vec<FrameForm> = Vec::new();
    for form in arguments.packed.map(|_| FrameForm::Bytes).iter().chain(&arguments.frame) {
        if !forms.contains(form) {
            forms.push(*form);
        }
    }
    forms
}

/// The numbers of the states as their codes.
fn numbered(states: Vec<String>) -> Result<PanelCodes, Failure> {
    let count = states.len();
    let codes: Option<Vec<(String, u8)>> = states
        .into_iter()
        .enumerate()
        .map(|(number, state)| Some((state, u8::try_from(number).ok()?)))
        .collect();
    let too_many = || {
        input(
            &format!("a frame has codes from 0 to 255, and this display has {count} states"),
            "image.states lists the states that are used",
        )
    };
    Ok(PanelCodes { controller: None, of_states: codes.ok_or_else(too_many)? })
}

/// The packing that was requested, that of the controller, or the one of fewest bits.
fn packing(requested: Option<Packed>, codes: &PanelCodes) -> Result<Packing, Failure> {
    if codes.of_states.is_empty() {
        return Err(input("a frame needs states, and this display has none", "add states to the pixel"));
    }
    let requested = requested.map(|requested| match requested {
        Packed::Bits(bits) => RequestedPacking::Bits(bits),
        Packed::Planes => RequestedPacking::Planes,
    });
    let usual = codes.controller.map(|controller| controller.packing);
    Packing::chosen(requested, usual, &codes.of_states).map_err(|few| {
        let ([needed, bits], largest) = (few.needed(), few.largest());
        input(
            &format!(
                "--packed {} holds codes up to {largest}, and the code of `{}` is {}",
                few.bits, few.state, few.code
            ),
            &format!("it needs {needed} bits: --packed {bits}"),
        )
    })
}

/// The frame that a panel shows, if it has the size and the states of this one.
fn shown(path: &Path, size: [usize; 2], codes: &PanelCodes) -> Result<ShownStates, Failure> {
    let name = path.display().to_string();
    let file = DataFile::open_within(path, &name, LARGEST_PICTURE_FILE).map_err(Failure::Data)?;
    let shown = read_shown_states(&file).map_err(Failure::Data)?;
    let wrong = |what: String| {
        let hint =
            "--since takes states.png of the frame that the panel shows; without it, the whole frame is sent";
        Err(input(&format!("--since {name}: {what}"), hint))
    };
    let [columns, rows] = shown.size;
    if shown.size != size {
        return wrong(format!(
            "it has {columns} x {rows} pixels, and this picture {} x {}",
            size[0], size[1]
        ));
    }
    let states: Vec<&str> = codes.of_states.iter().map(|(state, _)| state.as_str()).collect();
    match &shown.names {
        Some(names) if *names != states => wrong(format!(
            "its states are {}, and those of this picture {}",
            names.join(", "),
            states.join(", ")
        )),
        None if shown.colours != states.len() => wrong(format!(
            "its palette has {} colours, and this picture {} states",
            shown.colours,
            states.len()
        )),
        _ if shown.states.iter().any(|state| usize::from(*state) >= states.len()) => {
            wrong(format!("a number in it is above {}, the last state", states.len() - 1))
        }
        _ => Ok(shown),
    }
}

fn no_frame(option: &str) -> Failure {
    input(
        &format!("{option} turns the frame for the panel, and no frame is written"),
        "add --packed BITS or --frame FORM",
    )
}

fn input(what: &str, hint: &str) -> Failure {
    Failure::Input(format!("{what}\n  = help: {hint}"))
}
