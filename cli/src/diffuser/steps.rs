//! `papilio diffuser steps`: a display with each step from its diffuser's measurement taken out in turn.

use std::io::Write;

use papilio_display::result::{RunResult, View};
use papilio_figures::spectra_over;
use papilio_scenario::{Resolved, Scenario};

use crate::arguments::Steps;
use crate::{Failure, folder, output, report, run, say};

/// A key of `[display.diffuser]`, the value with which it does nothing, and what the display is then.
const STEPS: [(&str, &str, &str); 6] = [
    ("normalise", "none", "without k"),
    ("spectral_mean", "uniform", "uniform spectral mean"),
    ("transmission", "1.0", "without transmission spectrum"),
    ("instrument_blur", "0", "blurred as measured"),
    ("fill", "none", "dark cells dark"),
    ("extrapolate", "none", "nothing beyond the last incidence"),
];

/// A run, and what it is called.
struct Variant {
    name: String,
    /// The key that was changed; `None` for the scenario as it stands, and what it is held to.
    key: Option<&'static str>,
    result: RunResult,
}

pub(crate) fn steps(arguments: &Steps) -> Result<(), Failure> {
    let scenario = &arguments.scenario;
    let base = Scenario::load(&scenario.file, &scenario.set)?.resolve()?;
    let out = folder::choose(scenario, &base.hash)?;
    let compute = |resolved: &Resolved| run::compute(resolved, arguments.workers.threads);
    let mut variants = vec![Variant { name: "as described".to_owned(), key: None, result: compute(&base)? }];
    for (key, off, name) in taken(&base)? {
        let set = [scenario.set.clone(), vec![format!("display.diffuser.{key}={off}")]].concat();
        let result = compute(&Scenario::load(&scenario.file, &set)?.resolve()?)?;
        variants.push(Variant { name: name.to_owned(), key: Some(key), result });
    }
    if let Some(beside) = &arguments.beside {
        let resolved = Scenario::load(beside, &[])?.resolve()?;
        let name = resolved.title.clone().unwrap_or_else(|| report::file_title(beside));
        variants.push(Variant { name, key: None, result: compute(&resolved)? });
    }
    base.warnings.iter().for_each(|warning| say(&format!("warning: {warning}")));
    let title = base.title.clone().unwrap_or_else(|| report::file_title(&scenario.file));
    let mut stdout = crate::terminal::stdout();
    stdout.write_all(told(&title, &variants).as_bytes())?;
    stdout.flush()?;
    output::make_folder(&out)?;
    let mut names = Vec::new();
    let beside: Vec<&Variant> = variants.iter().skip(1).filter(|variant| variant.key.is_none()).collect();
    for variant in &variants {
        let Some(key) = variant.key else { continue };
        let shown: Vec<(&str, &RunResult)> = [&variants[0], variant]
            .into_iter()
            .chain(beside.iter().copied())
            .map(|variant| (variant.name.as_str(), &variant.result))
            .collect();
        names.extend(output::write_figure(&out, &format!("step-{key}"), &spectra_over(&shown, &title))?);
    }
    folder::sign(&out, &title, &base.hash)?;
    names.push(folder::ABOUT.to_owned());
    output::announce(&out, &names);
    Ok(())
}

/// The steps that the scenario takes.
fn taken(base: &Resolved) -> Result<Vec<(&'static str, &'static str, &'static str)>, Failure> {
    let diffuser = &base.canonical["display"]["diffuser"];
    if diffuser["model"] != "measured" {
        return Err(Failure::Input(
            "the steps are those of a measured diffuser, and [display.diffuser] is none\n  = help: give it model = \"measured\" and a file"
                .to_owned(),
        ));
    }
    let coloured = diffuser["transmission"].is_string();
    let done = |(key, off, _): &(&str, &str, &str)| match *key {
        "transmission" => coloured,
        "spectral_mean" if !coloured => false,
        key => match &diffuser[key] {
            serde_json::Value::String(value) => value != off,
            value => value.as_f64().is_some_and(|value| value > 0.0),
        },
    };
    Ok(STEPS.into_iter().filter(done).collect())
}

/// A line for each variant.
fn told(title: &str, variants: &[Variant]) -> String {
    let state = |view: &View| {
        let state = view.states.get("white").or_else(|| view.states.iter().next().map(|(_, state)| state));
        state.map_or(f64::NAN, |state| state.value.Y)
    };
    let number = |value: Option<f64>, decimals: usize| {
        value.map_or("-".to_owned(), |value| format!("{value:.decimals$}"))
    };
    let mut rows =
        vec![["", "Y of white", "changes by", "contrast", "gamut (% sRGB)"].map(str::to_owned).to_vec()];
    let first = variants[0].result.views.first().map_or(f64::NAN, state);
    for variant in variants {
        let Some(view) = variant.result.views.first() else { continue };
        let y = state(view);
        rows.push(vec![
            variant.name.clone(),
            format!("{y:.4}"),
            format!("{} %", report::signed(100.0 * (y / first - 1.0), 1)),
            number(view.metrics.contrast_ratio, 2),
            number(view.metrics.gamut_percent_srgb, 2),
        ]);
    }
    format!("{title}\n\n{}", report::table(&rows))
}
