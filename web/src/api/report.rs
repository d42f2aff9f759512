//! `report.html`: the result of a scenario on one self-contained page.

use papilio_display::ConeResult;
use papilio_display::result::{State, View};
use papilio_reproduction::{Report, Section, Table};

use super::live::Answer;

/// Writes the report: figures, numbers, energy balance, conoscopic maps, notes and the scenario.
pub(super) fn page(answer: &Answer, scenario: &str, cone: &ConeResult) -> String {
    let (result, title) = (&answer.result, answer.title());
    let mut sections = vec![Section::new("seen", "Appearance")];
    for (name, svg) in papilio_figures::of_run(result, "") {
        let is_overview = name.starts_with("overview") || name.ends_with("_against_angle");
        if let (true, Some(section)) = (is_overview, sections.pop()) {
            sections.push(section.figure(svg, ""));
        }
    }
    let mut numbers = Section::new("numbers", "Numbers");
    let mut ledger = Section::new("ledger", "Energy balance");
    for view in &result.views {
        let direction = format!("Seen from {} deg, azimuth {} deg.", view.theta_deg, view.phi_deg);
        numbers = numbers.say(direction.clone()).table(colours(view, &result.primaries)).table(metrics(view));
        ledger = ledger
            .say(format!(
                "{direction} Fractions of a beam that enters from this direction, weighted by luminance."
            ))
            .table(energy_balance(view));
    }
    sections.extend([numbers, ledger]);
    if let Some(svg) = papilio_figures::cone(cone, "") {
        sections.push(Section::new("directions", "From all directions").figure(svg, ""));
    }
    let remarks = result.warnings.iter().chain(&result.notes);
    let remarks = remarks
        .fold(Section::new("remarks", "Warnings and notes"), |section, text| section.say(text.clone()));
    sections.extend((!remarks.parts.is_empty()).then_some(remarks));
    sections.push(Section::new("scenario", "The scenario").code(scenario));
    let about = format!(
        "Computed by Papilio {} with the solver adding, to a relative error of {:.1e}; scenario {}. \
         The errors are discretisation errors: the difference from the next coarser level.",
        env!("CARGO_PKG_VERSION"),
        result.solver.relative_error_reached,
        answer.resolved.hash,
    );
    let title = if title.is_empty() { "A reflective display" } else { title };
    Report { title: title.to_owned(), about: vec![about], sections }.html()
}

/// The table of the states; peaks are those of states that drive one sub-pixel, `primaries`.
fn colours(view: &View, primaries: &[String]) -> Table {
    let mut table =
        Table::new(&["state", "Y", "L*", "u'", "v'", "contrast", "peak (nm)", "luminance (cd/m\u{b2})"]);
    for (name, state) in view.states.iter() {
        let of = |get: fn(&papilio_display::result::StateValues) -> Option<f64>, decimals: usize| {
            with_error(state, get, decimals)
        };
        table.row([
            name.to_owned(),
            of(|values| Some(values.Y), 4),
            of(|values| values.L_star, 2),
            of(|values| values.u_prime, 4),
            of(|values| values.v_prime, 4),
            of(|values| values.contrast, 2),
            if primaries.iter().any(|primary| primary == name) {
                of(|values| values.peak_nm, 1)
            } else {
                "-".to_owned()
            },
            of(|values| Some(values.luminance_cd_m2), 2),
        ]);
    }
    table
}

fn with_error(
    state: &State,
    get: fn(&papilio_display::result::StateValues) -> Option<f64>,
    decimals: usize,
) -> String {
    let Some(value) = get(&state.value) else { return "-".to_owned() };
    let error = state.discretisation_error.as_ref().and_then(get).filter(|error| *error > 0.0);
    let error = error.map_or(String::new(), |error| format!(" \u{b1} {error:.1e}"));
    format!("{value:.decimals$}{error}")
}

/// The table of the metrics of a view that are defined.
fn metrics(view: &View) -> Table {
    let mut table = Table::new(&["metric", "value"]);
    for (name, value) in view.metrics.named() {
        if let Some(value) = value {
            let label =
                papilio_display::metric_label(name).map_or(name.to_owned(), |label| label.to_string());
            table.row([label, format!("{value:.3}")]);
        }
    }
    table
}

/// The table of the energy balance of each state.
fn energy_balance(view: &View) -> Table {
    let mut table =
        Table::new(&["state", "returned", "front", "diffuser", "glass", "pixel", "inactive", "unaccounted"]);
    for (name, ledger) in view.ledger.iter() {
        let absorbed = &ledger.absorbed;
        let fractions = [
            ledger.returned,
            absorbed.front,
            absorbed.diffuser,
            absorbed.glass,
            absorbed.pixel,
            absorbed.inactive,
            ledger.unaccounted,
        ];
        table.row(std::iter::once(name.to_owned()).chain(fractions.map(|fraction| format!("{fraction:.4}"))));
    }
    table
}
