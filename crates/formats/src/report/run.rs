//! The tables and lines about a run that the terminal and `report.html` share.

use papilio_display::angle_in_text;
use papilio_display::result::{ReferenceWhite, RunResult, State, StateValues, View, ViewMetrics};

use super::numbers::{measured, percent};
use super::readability;

/// Most states in the row of a view, for displays without white and black.
const STATES_IN_A_ROW: usize = 6;

/// Most views that are printed in full; more views have one row each.
pub const VIEWS_IN_FULL: usize = 3;

/// A title as one line, with control characters replaced by spaces.
pub fn plain(title: &str) -> String {
    title.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// The solver of a result, what it did and the error that it reached.
pub fn effort(result: &RunResult) -> String {
    let solver = &result.solver;
    let reached = percent(solver.relative_error_reached);
    let effort = match (solver.paths, solver.nodes) {
        (Some(paths), _) => format!("{paths} paths, relative standard error {reached}"),
        (None, nodes) => format!("{} nodes, discretisation error {reached}", nodes.unwrap_or_default()),
    };
    format!("{}: {effort}", solver.method)
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

/// The direction of a view.
pub fn seen_from(view: &View, in_glass: bool) -> String {
    let medium = if in_glass { " in glass" } else { "" };
    let azimuth = if view.phi_deg == 0.0 {
        String::new()
    } else {
        format!(", azimuth {} deg", angle_in_text(view.phi_deg))
    };
    format!("seen from {} deg{medium}{azimuth}", angle_in_text(view.theta_deg))
}

/// The states of a view: a head, and a row for each state.
pub fn rows_of_states(result: &RunResult, view: &View) -> Vec<Vec<String>> {
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
pub fn lines_of_view(result: &RunResult, view: &View) -> String {
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
            let number = if values.len() > 1 { format!("_{k}") } else { String::new() };
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
    // Russian roulette leaves noise around zero, which is not reported; a computation of a single pass leaves
    // out light.
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

/// A row for each view: contrast, gamut and white of a display with the states white and black, otherwise the
/// Y of its states.
pub fn rows_of_views(result: &RunResult) -> Vec<Vec<String>> {
    let names: Vec<&str> = result.views[0].states.iter().map(|(name, _)| name).collect();
    let has_white_and_black = ["white", "black"].iter().all(|name| names.contains(name));
    let y = |view: &View, name: &str| {
        let state = view.states.get(name);
        state.map_or("-".to_owned(), |s| measured(Some(s.value.Y), Some(s.standard_error.Y), 4))
    };
    let angles = |view: &View| vec![angle_in_text(view.theta_deg), angle_in_text(view.phi_deg)];
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
