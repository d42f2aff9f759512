//! `papilio palette`: the colours of all states in one light and view, in other rooms, and as files for other
//! programs.

use std::path::Path;

use papilio_display::image::ScreenWhite;
use papilio_display::palette::PaletteResult;
use papilio_formats::{TitledFile, files_of_palette, light_and_view, write_file};
use papilio_scenario::{Resolved, illuminant_sheet, preset_names};
use serde::Serialize;

use crate::arguments::PaletteCommand;
use crate::numbers::measured;
use crate::spatial::{SpatialOutput, show, title};
use crate::{Failure, report};

pub(crate) fn palette(arguments: &PaletteCommand) -> Result<(), Failure> {
    let command = &arguments.command;
    let resolved = command.resolve(None)?;
    check_rooms(&arguments.rooms)?;
    let rooms = arguments
        .rooms
        .iter()
        .map(|name| Ok((name.clone(), room(|more| command.resolve(more), &resolved, name)?)));
    let rooms = rooms.collect::<Result<Vec<(String, Resolved)>, Failure>>()?;
    let scenes: Vec<_> = rooms.iter().map(|(name, room)| (name.clone(), &room.scene)).collect();
    show(command, &resolved, |control| {
        let mut result = papilio_display::palette::palette(&resolved.scene, &scenes, control)?;
        resolved.warn_of_rooms(rooms.iter().map(|(name, room)| (name.as_str(), room)), &mut result.warnings);
        Ok(PaletteOutput { result, white: arguments.relative_to.into(), title: title(command, &resolved) })
    })
}

/// Refuses names of rooms that are empty or given twice.
pub(crate) fn check_rooms(rooms: &[String]) -> Result<(), Failure> {
    for (at, name) in rooms.iter().enumerate() {
        let wrong = match name.is_empty() {
            true => "there is an empty name".to_owned(),
            false if rooms[..at].contains(name) => format!("`{name}` is given twice"),
            false => continue,
        };
        return Err(Failure::Input(format!(
            "--rooms: {wrong}\n  = help: presets and illuminants with commas between them, as in --rooms D65,FL11"
        )));
    }
    Ok(())
}

/// The scenario in the light of a preset, or in its own light with the spectrum of a CIE illuminant; in the
/// same view.
///
/// `resolve` reads the scenario with further overrides.
pub(crate) fn room(
    resolve: impl Fn(Vec<String>) -> Result<Resolved, Failure>,
    resolved: &Resolved,
    name: &str,
) -> Result<Resolved, Failure> {
    let light = match (preset_names().any(|known| known == name), illuminant_sheet(name)) {
        (true, _) => format!("lighting={{ preset = \"{name}\" }}"),
        (false, Ok(_)) => format!("lighting.spectrum=\"{name}\""),
        (false, Err(_)) => {
            let known = preset_names().collect::<Vec<_>>().join(", ");
            return Err(Failure::Input(format!(
                "--rooms: there is no preset and no illuminant named `{name}`\n  = help: the presets are {known}; \
                 `papilio illuminants` lists the illuminants, which replace lighting.spectrum"
            )));
        }
    };
    let viewer = &resolved.scene.viewer;
    let view =
        [format!("viewer.theta_deg={:?}", viewer.theta_deg), format!("viewer.phi_deg={:?}", viewer.phi_deg)];
    resolve([light].into_iter().chain(view).collect())
}

/// Colours, and what is white in files for other programs.
struct PaletteOutput {
    result: PaletteResult,
    white: ScreenWhite,
    /// Title of the scenario, which the files for other programs have.
    title: String,
}

impl SpatialOutput for PaletteOutput {
    const JSON: &'static str = "palette.json";
    const FIGURES: &'static [&'static str] = &["palette"];

    fn content<'a>(
        &'a self,
        resolved: &'a Resolved,
        title: &'a str,
        notes: &'a [String],
    ) -> impl Serialize + 'a {
        let (papilio, hash) = (env!("CARGO_PKG_VERSION"), &resolved.hash);
        TitledFile { papilio, title, hash, notes, result: &self.result }
    }

    fn table(&self, title: &str) -> String {
        format!(
            "{}\n\ncolours {}\n{}{}",
            report::plain(title),
            light_and_view(&self.result),
            report::table(&self.rows()),
            self.rows_of_rooms(),
        )
    }

    fn write_tables(&self, folder: &Path) -> Result<Vec<String>, Failure> {
        let mut names = Vec::new();
        for (name, content) in files_of_palette(&self.title, &self.result, self.white) {
            write_file(&folder.join(name), |out| out.write_all(&content))?;
            names.push(name.to_owned());
        }
        Ok(names)
    }

    fn figures(&self, title: &str) -> Vec<(String, String)> {
        papilio_figures::of_palette(&self.result, title)
    }

    fn warnings(&mut self) -> &mut Vec<String> {
        &mut self.result.warnings
    }
}

impl PaletteOutput {
    /// A line for each room whose colours are those of an earlier one: presets of rooms have the same
    /// spectrum.
    fn equal_rooms(&self) -> String {
        let rooms = &self.result.rooms.0;
        let hexes = |at: usize| rooms[at].1.iter().map(|(_, there)| &there.colour.hex).collect::<Vec<_>>();
        let line = |at: usize| {
            let same = (0..at).find(|earlier| hexes(*earlier) == hexes(at))?;
            let (name, other) = (&rooms[at].0, &rooms[same].0);
            Some(format!(
                "{name} has the colours of {other}: the spectrum is the same; name an illuminant, such as FL11 or LED-B1\n"
            ))
        };
        (1..rooms.len()).filter_map(line).collect()
    }

    fn rows(&self) -> Vec<Vec<String>> {
        let head = ["state", "X", "Y", "Z", "L*", "a*", "b*", "sRGB", "relative to the display"];
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        rows.extend(self.result.palette.colours.iter().map(|one| {
            let error = &one.error;
            let hex = |srgb: Option<[f64; 3]>| srgb.map_or("-".to_owned(), papilio_display::palette::hex);
            vec![
                one.state.clone(),
                measured(Some(one.X), Some(error.X), 4),
                measured(Some(one.Y), Some(error.Y), 4),
                measured(Some(one.Z), Some(error.Z), 4),
                measured(one.L_star, error.L_star, 2),
                measured(one.a_star, error.a_star, 2),
                measured(one.b_star, error.b_star, 2),
                hex(one.srgb),
                hex(one.srgb_relative),
            ]
        }));
        rows
    }

    /// How the colours move between rooms; nothing without rooms.
    fn rows_of_rooms(&self) -> String {
        if self.result.rooms.0.is_empty() {
            return String::new();
        }
        let head = self.result.rooms.0.iter().map(|(name, _)| name.clone());
        let mut rows = vec![std::iter::once("state".to_owned()).chain(head).collect::<Vec<_>>()];
        rows.extend(self.result.palette.colours.iter().map(|one| {
            let there = self.result.rooms.0.iter().map(|(_, room)| {
                let found = room.get(&one.state);
                let difference = measured(found.and_then(|there| there.delta_e_2000), None, 2);
                let hex = found.and_then(|there| there.colour.hex.clone());
                format!("{} {difference}", hex.unwrap_or_default())
            });
            std::iter::once(one.state.clone()).chain(there).collect()
        }));
        format!(
            "\nin other rooms: sRGB, and the CIEDE2000 difference from the colour above\n{}{}",
            report::table(&rows),
            self.equal_rooms()
        )
    }
}
