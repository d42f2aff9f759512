//! Reports on the terminal: tables with the results of a command.

use std::fmt::Write;
use std::path::Path;

use papilio_display::pixel::PixelAbsorption;
use papilio_display::result::{ReferenceWhite, RunResult, State, StateValues, View, ViewMetrics};
use papilio_display::{BrdfTable, ConeResult, Reflection};
pub(crate) use papilio_formats::words::table;

use crate::numbers::{measured, percent, unsigned_zero};
use crate::readability;

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

/// Most states in the row of a view, for displays without white and black.
const STATES_IN_A_ROW: usize = 6;

/// Most views that are printed in full; more views have one row each.
const VIEWS_IN_FULL: usize = 3;

/// Title of a scenario without `title`: the name of its file.
pub(crate) fn file_title(file: &Path) -> String {
    if crate::input::is_stdin(file) {
        return crate::input::STDIN_NAME.to_owned();
    }
    file.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// A title as one line, with control characters replaced by spaces.
pub(crate) fn plain(title: &str) -> String {
    title.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// Report of `papilio run`; `in_glass`: the angles of the scenario are in glass.
pub(crate) fn run(title: &str, in_glass: bool, result: &RunResult, seconds: f64) -> String {
    let mut text = format!("{}\n", plain(title));
    if result.views.len() <= VIEWS_IN_FULL {
        result.views.iter().for_each(|view| text.push_str(&view_in_full(result, view, in_glass)));
    } else {
        let _ = write!(text, "\n{}", table(&rows_of_views(result)));
    }
    let solver = &result.solver;
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
    if solver.paths.is_some() {
        text.push_str(". 0.123(4) means 0.123 with a standard error of 0.004.");
    }
    text.push('\n');
    text
}

/// The solver of a result, what it did and the error that it reached.
pub(crate) fn effort(result: &RunResult) -> String {
    let solver = &result.solver;
    let reached = percent(solver.relative_error_reached);
    let effort = match (solver.paths, solver.nodes) {
        (Some(paths), _) => format!("{paths} paths, relative standard error {reached}"),
        (None, nodes) => format!("{} nodes, discretisation error {reached}", nodes.unwrap_or_default()),
    };
    format!("{}: {effort}", solver.method)
}

/// Additional report of `papilio run --cone`.
pub(crate) fn cone(cone: &ConeResult, seconds: f64) -> String {
    let (thetas, phis) = (cone.theta_deg.len(), cone.phi_deg.len());
    let error = percent(cone.discretisation_error);
    format!("cone: {thetas} x {phis} directions, discretisation error {error}, {seconds:.2} s\n")
}

/// Incidences in the table of a BSDF.
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
    let shown: Vec<usize> = SHOWN_INCIDENCES_DEG
        .iter()
        .filter_map(|deg| incidences.iter().position(|theta| (theta - deg).abs() < 1e-9))
        .collect();
    let mut rows = vec![vec!["state".to_owned()]];
    rows[0].extend(shown.iter().map(|i| format!("{} deg", incidences[*i])));
    for state in &table.states {
        let cells = shown.iter().map(|i| {
            let cell =
                |values: &[f64]| values.get(i * bins + bin).map_or("-".to_owned(), |v| format!("{v:.4}"));
            format!("{} / {}", cell(&state.directional_hemispherical), cell(&state.specular))
        });
        rows.push(std::iter::once(state.name.clone()).chain(cells).collect());
    }
    let error = percent(table.discretisation_error);
    format!(
        "{}\n\ndirectional-hemispherical reflectance / regular reflectance, at {} nm, by incidence\n{}\nadding: {} nodes, \
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
    let mut rows = vec![vec!["state".to_owned()]];
    rows[0].extend(all.iter().map(|one| format!("{} deg", one.theta_deg)));
    let states = all.first().map_or(&[][..], |one| &one.states);
    for (k, state) in states.iter().enumerate() {
        let cells = all.iter().filter_map(|one| one.states.get(k)).map(|one| {
            let [total, regular, haze, lambertian] = [one.returned, one.mirror, one.haze, one.lambertian]
                .map(|fraction| format!("{:.1}", 100.0 * fraction));
            let outside =
                one.beyond_straight.map_or("-".to_owned(), |fraction| format!("{:.0}", 100.0 * fraction));
            format!("{total} = {regular} + {haze} + {lambertian}; {outside}")
        });
        rows.push(std::iter::once(state.name.clone()).chain(cells).collect());
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
pub(crate) fn pixel(title: &str, medium: &str, peaks: &Peaks) -> String {
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
    format!(
        "{title}\n\npeak wavelength (nm) / largest reflectance from 400 to 700 nm, by angle in {medium}\n{}",
        table(&rows)
    )
}

/// Wavelength of the absorptances on the terminal; the nearest one of the grid is used.
const ABSORBED_NM: f64 = 550.0;

/// Additional report of `papilio pixel --absorption`: the absorptances of each distinct sub-pixel at the smallest angle.
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

/// A column of the table of states: its title, its decimals without an error, and its value.
type Column = (&'static str, usize, fn(&StateValues) -> Option<f64>);

const COLUMNS: [Column; 9] = [
    ("Y", 4, |s| Some(s.Y)),
    ("L (cd/m2)", 2, |s| Some(s.luminance_cd_m2)),
    ("contrast", 2, |s| s.contrast),
    ("L*", 2, |s| s.L_star),
    ("a*", 2, |s| s.a_star),
    ("b*", 2, |s| s.b_star),
    ("u'", 4, |s| s.u_prime),
    ("v'", 4, |s| s.v_prime),
    (PEAK, 1, |s| s.peak_nm),
];

/// Title of the last column, which has values for states that drive one sub-pixel only.
const PEAK: &str = "peak (nm)";

/// Report of a view: all states, metrics, and the energy balance.
fn view_in_full(result: &RunResult, view: &View, in_glass: bool) -> String {
    let table = table(&rows_of_states(result, view));
    format!("\n{}\n{table}{}", seen_from(view, in_glass), lines_of_view(result, view))
}

/// The direction of a view.
pub(crate) fn seen_from(view: &View, in_glass: bool) -> String {
    let medium = if in_glass { " in glass" } else { "" };
    let azimuth = if view.phi_deg == 0.0 { String::new() } else { format!(", azimuth {} deg", view.phi_deg) };
    format!("seen from {} deg{medium}{azimuth}", view.theta_deg)
}

/// The states of a view: a head, and a row for each state.
pub(crate) fn rows_of_states(result: &RunResult, view: &View) -> Vec<Vec<String>> {
    let mut rows = vec![vec!["state".to_owned()]];
    rows[0].extend(COLUMNS.iter().map(|(title, ..)| (*title).to_owned()));
    for (name, State { value, standard_error, .. }) in view.states.iter() {
        let is_primary = result.primaries.iter().any(|primary| primary == name);
        let cells = COLUMNS.iter().map(|(title, decimals, get)| {
            // The peak of a mixture of sub-pixels is that of one of them.
            let value = get(value).filter(|_| is_primary || *title != PEAK);
            measured(value, get(standard_error), *decimals)
        });
        rows.push(std::iter::once(name.to_owned()).chain(cells).collect());
    }
    if result.primaries.is_empty() {
        rows.iter_mut().for_each(|row| _ = row.pop());
    }
    rows
}

/// Lines below the states of a view: metrics, and the energy balance.
pub(crate) fn lines_of_view(result: &RunResult, view: &View) -> String {
    let white = match result.reference_white {
        ReferenceWhite::Display => "  L*, a*, b* and colour differences: relative to the white state\n",
        _ => "",
    };
    let text = readability::of_text(view, &result.reader);
    [white.to_owned(), display_metrics(view), text, by_source(view), energy_balance(view)].concat()
}

/// Metrics of the display: contrast, gamut.
fn display_metrics(view: &View) -> String {
    let error = &view.standard_error;
    let contrast = view.metrics.contrast_ratio.map_or(String::new(), |contrast| {
        format!("  contrast ratio {}\n", measured(Some(contrast), error.contrast_ratio, 2))
    });
    let gamut: String = GAMUTS.iter().map(|diagram| gamut(view, diagram)).collect();
    let volume = view.metrics.gamut_volume_cielab.map_or(String::new(), |volume| {
        let volume = measured(Some(volume), error.gamut_volume_cielab, 0);
        format!("  gamut volume {volume} in CIELAB (sRGB: 819000)\n")
    });
    format!("{contrast}{gamut}{volume}")
}

/// A percentage of a view.
type Percent = fn(&ViewMetrics) -> Option<f64>;

/// Gamuts in a chromaticity diagram: areas relative to standards, and the coverage of sRGB.
struct Gamuts {
    diagram: &'static str,
    areas: [(&'static str, Percent); 4],
    coverage: Percent,
}

const GAMUTS: [Gamuts; 2] = [
    Gamuts {
        diagram: "u'v'",
        areas: [
            ("sRGB", |m| m.gamut_percent_srgb),
            ("EBU", |m| m.gamut_percent_ebu),
            ("NTSC", |m| m.gamut_percent_ntsc),
            ("DCI-P3", |m| m.gamut_percent_dci_p3),
        ],
        coverage: |m| m.coverage_percent_srgb,
    },
    Gamuts {
        diagram: "xy",
        areas: [
            ("sRGB", |m| m.gamut_percent_srgb_xy),
            ("EBU", |m| m.gamut_percent_ebu_xy),
            ("NTSC", |m| m.gamut_percent_ntsc_xy),
            ("DCI-P3", |m| m.gamut_percent_dci_p3_xy),
        ],
        coverage: |m| m.coverage_percent_srgb_xy,
    },
];

/// Gamut areas in a diagram, in one line; empty if they are not defined.
fn gamut(view: &View, Gamuts { diagram, areas, coverage }: &Gamuts) -> String {
    let shown = |of: &str, percent: Percent| {
        let value = Some(percent(&view.metrics)?);
        Some(format!("{} % of {of}", measured(value, percent(&view.standard_error), 2)))
    };
    let areas: Vec<String> = areas.iter().filter_map(|(of, percent)| shown(of, *percent)).collect();
    if areas.is_empty() {
        return String::new();
    }
    let coverage = shown("sRGB", *coverage).map_or(String::new(), |text| format!("; coverage {text}"));
    format!("  gamut in {diagram}: area {}{coverage}\n", areas.join(", "))
}

/// Luminance factor of the first state in the light of each source, if there are several.
fn by_source(view: &View) -> String {
    let Some((name, State { value, standard_error, .. })) = view.states.iter().next() else {
        return String::new();
    };
    let sources = |name: &str, values: &[Option<f64>], errors: &[Option<f64>]| -> Vec<String> {
        let one = |(k, value): (usize, &Option<f64>)| {
            let number = if values.len() > 1 { format!(" {}", k + 1) } else { String::new() };
            let error = errors.get(k).copied().flatten();
            value.map(|value| format!("{name}{number} {}", measured(Some(value), error, 4)))
        };
        values.iter().enumerate().filter_map(one).collect()
    };
    let all = [
        sources("R_hemi", &[value.R_hemi], &[standard_error.R_hemi]),
        sources("R_dir", &value.R_dir, &standard_error.R_dir),
        sources("R_environment", &value.R_environment, &standard_error.R_environment),
    ];
    let all = all.concat();
    if all.len() < 2 {
        String::new()
    } else {
        format!("  luminance factor by source, {name}: {}\n", all.join(", "))
    }
}

/// Energy balance of the first state.
fn energy_balance(view: &View) -> String {
    let Some((name, ledger)) = view.ledger.iter().next() else { return String::new() };
    let absorbed = &ledger.absorbed;
    let parts = [
        ("front", absorbed.front),
        ("diffuser", absorbed.diffuser),
        ("glass", absorbed.glass),
        ("pixel", absorbed.pixel),
        ("inactive", absorbed.inactive),
    ];
    // Russian roulette leaves noise around zero, which is not reported; a computation of a single pass leaves out light.
    let noise = 5.0 * ledger.standard_error.unaccounted;
    let unaccounted = if ledger.unaccounted.abs() > noise.max(5e-4) {
        format!("; unaccounted: {:.1} %", 100.0 * ledger.unaccounted)
    } else {
        String::new()
    };
    let parts: Vec<String> = parts
        .iter()
        .filter(|(_, fraction)| *fraction > 5e-5)
        .map(|(part, fraction)| format!("{part} {:.1} %", 100.0 * fraction))
        .collect();
    if parts.is_empty() && !unaccounted.is_empty() {
        return format!(
            "  energy balance of a beam from the viewer, {name}: returned {:.1} %; what absorbs the rest is not computed below a colour \
             filter\n",
            100.0 * ledger.returned
        );
    }
    let parts = if parts.is_empty() { "nothing".to_owned() } else { parts.join(", ") };
    format!(
        "  energy balance of a beam from the viewer, {name}: returned {:.1} %; absorbed: {parts}{unaccounted}\n",
        100.0 * ledger.returned
    )
}

/// A row for each view: contrast, gamut and white of a display with the states white and black, otherwise the Y of its
/// states.
pub(crate) fn rows_of_views(result: &RunResult) -> Vec<Vec<String>> {
    let names: Vec<&str> = result.views[0].states.iter().map(|(name, _)| name).collect();
    let has_white_and_black = ["white", "black"].iter().all(|name| names.contains(name));
    let y = |view: &View, name: &str| {
        let state = view.states.get(name);
        state.map_or("-".to_owned(), |s| measured(Some(s.value.Y), Some(s.standard_error.Y), 4))
    };
    let angles = |view: &View| vec![view.theta_deg.to_string(), view.phi_deg.to_string()];
    let mut rows = vec![["theta (deg)", "phi (deg)"].map(str::to_owned).to_vec()];
    if has_white_and_black {
        let titles =
            ["Y white", "Y black", "contrast", "sRGB u'v' (%)", "NTSC xy (%)", "white u'", "white v'"];
        rows[0].extend(titles.map(str::to_owned));
    } else {
        rows[0].extend(names.iter().take(STATES_IN_A_ROW).map(|name| format!("Y {name}")));
    }
    let has_reader = has_white_and_black && result.reader.is_described;
    if has_reader {
        rows[0].extend(["visibility level", "contrast margin"].map(str::to_owned));
    }
    for view in &result.views {
        let mut row = angles(view);
        if has_white_and_black {
            let error = &view.standard_error;
            row.extend(["white", "black"].map(|name| y(view, name)));
            row.push(measured(view.metrics.contrast_ratio, error.contrast_ratio, 2));
            row.push(measured(view.metrics.gamut_percent_srgb, error.gamut_percent_srgb, 2));
            row.push(measured(view.metrics.gamut_percent_ntsc_xy, error.gamut_percent_ntsc_xy, 2));
            let white = view.states.get("white");
            row.push(
                white.map_or("-".to_owned(), |s| measured(s.value.u_prime, s.standard_error.u_prime, 4)),
            );
            row.push(
                white.map_or("-".to_owned(), |s| measured(s.value.v_prime, s.standard_error.v_prime, 4)),
            );
        } else {
            row.extend(names.iter().take(STATES_IN_A_ROW).map(|name| y(view, name)));
        }
        if has_reader {
            let error = &view.standard_error;
            row.push(measured(view.metrics.visibility_level, error.visibility_level, 2));
            row.push(measured(view.metrics.contrast_margin, error.contrast_margin, 1));
        }
        rows.push(row);
    }
    rows
}
