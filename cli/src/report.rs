//! Reports on the terminal: tables with the results of a command.

use std::fmt::Write;
use std::path::Path;

use papilio_display::pixel::PixelAbsorption;
use papilio_display::result::{RunResult, View};
use papilio_display::{BrdfTable, ConeResult, Reflection};
pub(crate) use papilio_formats::report::plain;
use papilio_formats::report::{
    VIEWS_IN_FULL, effort, lines_of_view, rows_of_states, rows_of_views, seen_from,
};
pub(crate) use papilio_formats::words::table;

use crate::numbers::{has_errors, percent, unsigned_zero};

/// Largest width of a column heading before it continues on the next line, characters.
const HEADING: usize = 16;

/// Returns the headings of a table's columns, on as many lines as the longest one needs.
pub(crate) fn headings(labels: &[String]) -> Vec<Vec<String>> {
    let lines = |label: &String| {
        let mut lines: Vec<String> = Vec::new();
        for word in label.split(' ') {
            match lines.last_mut() {
                Some(line) if line.chars().count() + 1 + word.chars().count() <= HEADING => {
                    *line = format!("{line} {word}");
                }
                _ => lines.push(word.to_owned()),
            }
        }
        lines
    };
    let all: Vec<Vec<String>> = labels.iter().map(lines).collect();
    let height = all.iter().map(Vec::len).max().unwrap_or(0);
    // The last lines are next to the numbers.
    let cell = |lines: &Vec<String>, row: usize| {
        (row + lines.len()).checked_sub(height).map_or_else(String::new, |line| lines[line].clone())
    };
    (0..height).map(|row| all.iter().map(|lines| cell(lines, row)).collect()).collect()
}

/// Title of a scenario without `title`: the name of its file.
pub(crate) fn file_title(file: &Path) -> String {
    if crate::input::is_stdin(file) {
        return crate::input::STDIN_NAME.to_owned();
    }
    file.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Report of `papilio run`; `in_glass`: the angles of the scenario are in glass.
pub(crate) fn run(title: &str, in_glass: bool, result: &RunResult, seconds: f64) -> String {
    let mut text = format!("{}\n", plain(title));
    if result.views.len() <= VIEWS_IN_FULL {
        result.views.iter().for_each(|view| text.push_str(&view_in_full(result, view, in_glass)));
    } else {
        let _ = write!(text, "\n{}", table(&rows_of_views(result)));
    }
    let (solver, has_errors) = (&result.solver, has_errors(&text));
    let _ = write!(text, "\n{}, {seconds:.2} s", effort(result));
    if let (Some(paths), Some(target)) = (solver.paths, &solver.target) {
        let [likely, most] = target.paths_for_a_tenth.map(|more| more / paths as f64);
        let over = target
            .error_over_tolerance
            .map_or("undefined".to_owned(), |over| format!("{over:.2} of its tolerance"));
        let most = if most > 1.1 * likely { format!(" (at most {most:.0} times)") } else { String::new() };
        let _ = write!(
            text,
            ".\nThe standard error of the target is {over}; reducing it to a tenth takes about {likely:.0} times as many \
             paths{most}"
        );
    }
    if solver.paths.is_some() && has_errors {
        text.push_str(". 0.123(4) means 0.123 with a standard error of 0.004.");
    }
    text.push('\n');
    text
}

/// Additional report of `papilio run --cone`.
pub(crate) fn cone(cone: &ConeResult, seconds: f64) -> String {
    let (thetas, phis) = (cone.theta_deg.len(), cone.phi_deg.len());
    let error = percent(cone.discretisation_error);
    format!("cone: {thetas} x {phis} directions, discretisation error {error}, {seconds:.2} s\n")
}

/// Incidences in the table of a BSDF; the nearest ones of the grid are shown.
const SHOWN_INCIDENCES_DEG: [f64; 4] = [0.0, 30.0, 45.0, 60.0];

/// Wavelength of the table of a BSDF; the nearest one of the grid is used.
const SHOWN_NM: f64 = 550.0;

/// Report of `papilio brdf`: reflectances at a few incidences.
pub(crate) fn brdf(title: &str, table: &BrdfTable) -> String {
    let bins = table.wavelength_nm.len();
    let distance = |nm: &f64| (nm - SHOWN_NM).abs();
    let nearest = (0..bins)
        .min_by(|a, b| distance(&table.wavelength_nm[*a]).total_cmp(&distance(&table.wavelength_nm[*b])));
    let Some(bin) = nearest else { return format!("{}\n", plain(title)) };
    let incidences = &table.grid.theta_i_deg;
    let nearest = |deg: &f64| {
        let away = |at: &usize| (incidences[*at] - deg).abs();
        (0..incidences.len()).min_by(|a, b| away(a).total_cmp(&away(b)))
    };
    let mut shown: Vec<usize> = SHOWN_INCIDENCES_DEG.iter().filter_map(nearest).collect();
    shown.dedup();
    let azimuths = table.grid.phi_i_deg.len().max(1);
    let at = table.grid.phi_i_deg.first().map_or_else(String::new, |phi| format!(" at azimuth {phi} deg"));
    let mut rows = vec![vec!["state".to_owned()]];
    rows[0].extend(shown.iter().map(|i| format!("{} deg", (10.0 * incidences[*i]).round() / 10.0)));
    for state in &table.states {
        let cells = shown.iter().map(|i| {
            let cell = |values: &[f64]| {
                values.get(i * azimuths * bins + bin).map_or("-".to_owned(), |v| format!("{v:.4}"))
            };
            format!("{} / {}", cell(&state.directional_hemispherical), cell(&state.specular))
        });
        rows.push(std::iter::once(state.name.clone()).chain(cells).collect());
    }
    let error = percent(table.discretisation_error);
    format!(
        "{}\n\ndirectional-hemispherical reflectance / regular reflectance, at {} nm, by incidence{at}\n{}\nadding: {} nodes, \
         discretisation error {error}\n",
        plain(title),
        table.wavelength_nm[bin],
        self::table(&rows),
        table.nodes,
    )
}

/// Incidences at which the reflected light is divided into its components.
pub(crate) const SPLIT_AT_DEG: [f64; 4] = [0.0, 8.0, 30.0, 45.0];

/// Additional report of `papilio brdf`: regular, haze and Lambertian components of the reflected light.
pub(crate) fn reflection(all: &[Reflection]) -> String {
    let mut text = "\nreflectance in the scene's light, %, by incidence: total = regular + haze + Lambertian; fraction of the total\n\
         that leaves more than 2.5 deg from the mirror direction, %\n"
        .to_owned();
    let mut azimuths: Vec<Option<f64>> = all.iter().map(|one| one.phi_deg).collect();
    azimuths.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
    azimuths.dedup();
    let mut rows = vec![vec!["state".to_owned()]];
    let of_azimuth = |phi: Option<f64>| all.iter().filter(move |one| one.phi_deg == phi);
    let first = azimuths.first().copied().flatten();
    rows[0].extend(of_azimuth(first).map(|one| format!("{} deg", one.theta_deg)));
    let states = all.first().map_or(&[][..], |one| &one.states);
    let each = states.iter().enumerate().flat_map(|state| azimuths.iter().map(move |phi| (state, *phi)));
    for ((k, state), phi) in each {
        let name = phi.map_or(state.name.clone(), |phi| format!("{}, from azimuth {phi} deg", state.name));
        let cells = of_azimuth(phi).filter_map(|one| one.states.get(k)).map(|one| {
            let [total, regular, haze, lambertian] = [one.returned, one.mirror, one.haze, one.lambertian]
                .map(|fraction| format!("{:.1}", 100.0 * fraction));
            let outside =
                one.beyond_straight.map_or("-".to_owned(), |fraction| format!("{:.0}", 100.0 * fraction));
            format!("{total} = {regular} + {haze} + {lambertian}; {outside}")
        });
        rows.push(std::iter::once(name).chain(cells).collect());
    }
    text.push_str(&table(&rows));
    text
}

/// A peak wavelength, nm, and the largest reflectance.
pub(crate) type Peak = (Option<f64>, f64);

/// Peaks of the states of a pixel.
pub(crate) struct Peaks {
    /// Angles, degrees.
    pub(crate) theta_deg: Vec<f64>,
    /// Name of each state, and its peaks at each angle.
    pub(crate) states: Vec<(String, Vec<Peak>)>,
}

/// Report of `papilio pixel`.
pub(crate) fn pixel(title: &str, medium: &str, peaks: &Peaks, phi_deg: Option<f64>) -> String {
    let angles = peaks.theta_deg.iter().map(|theta| format!("{theta} deg"));
    let mut rows = vec![std::iter::once("state".to_owned()).chain(angles).collect::<Vec<_>>()];
    for (name, at_angles) in &peaks.states {
        let cells = at_angles.iter().map(|(peak, most)| {
            let peak = peak.map_or("-".to_owned(), |nm| format!("{nm:.1}"));
            format!("{peak} / {most:.3}")
        });
        rows.push(std::iter::once(name.clone()).chain(cells).collect());
    }
    let title = plain(title);
    let azimuth = phi_deg.map_or(String::new(), |phi| format!(" at azimuth {phi} deg"));
    format!(
        "{title}\n\npeak wavelength (nm) / largest reflectance from 400 to 700 nm, by angle in {medium}{azimuth}\n{}",
        table(&rows)
    )
}

/// Wavelength of the absorptances on the terminal; the nearest one of the grid is used.
const ABSORBED_NM: f64 = 550.0;

/// Additional report of `papilio pixel --absorption`: the absorptances of each distinct sub-pixel at the
/// smallest angle.
pub(crate) fn absorption(all: &PixelAbsorption, medium: &str) -> String {
    let bins = all.wavelength_nm.len();
    let distance = |bin: &usize| (all.wavelength_nm[*bin] - ABSORBED_NM).abs();
    let nearest = (0..bins).min_by(|a, b| distance(a).total_cmp(&distance(b)));
    let (Some(bin), Some(theta)) = (nearest, all.theta_deg.first()) else { return String::new() };
    let mut rows = vec![vec!["sub-pixel (state)".to_owned(), "reflected".to_owned()]];
    rows[0].extend(all.layers.iter().map(|layer| match layer.number {
        Some(number) => format!("{number} {}", layer.material),
        None => format!("substrate {}", layer.material),
    }));
    let mut known: Vec<&[f64]> = Vec::new();
    for one in &all.sub_pixels {
        // A sub-pixel that is driven in the same way in several states is printed once.
        if known.contains(&one.absorptance.as_slice()) {
            continue;
        }
        known.push(&one.absorptance);
        let layers = one.absorptance.iter().skip(bin).step_by(all.theta_deg.len() * bins);
        let percent = |fraction: &f64| unsigned_zero(format!("{:.1}", 100.0 * fraction));
        let cells = std::iter::once(&one.reflectance[bin]).chain(layers).map(percent);
        rows.push(std::iter::once(format!("{} ({})", one.sub_pixel, one.state)).chain(cells).collect());
    }
    format!(
        "\nreflected, and absorbed by each layer, at {} nm, {theta} deg in {medium}, % of the light on the sub-pixel\n{}",
        all.wavelength_nm[bin],
        table(&rows)
    )
}

/// Report of a view: all states, metrics, and the energy balance.
fn view_in_full(result: &RunResult, view: &View, in_glass: bool) -> String {
    let table = table(&rows_of_states(result, view));
    format!("\n{}\n{table}{}", seen_from(view, in_glass), lines_of_view(result, view))
}
