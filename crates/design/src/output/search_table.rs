//! Table of the results of all tasks of a search.

use crate::search::{Search, SearchResult};
use papilio_formats::sweep_value;
use serde_json::Value;

/// Formats `optimize.csv`: the result of each task, in order.
pub fn search_table(search: &Search, results: &[SearchResult]) -> String {
    let quoted = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
    let study = search.study();
    let paths = study.variables.iter().flat_map(|one| one.keys.iter().map(|key| quoted(&key.path)));
    let quantities = study.quantities.iter().map(|one| quoted(&one.name));
    let titles =
        ["task", "evaluations", "missed"].map(str::to_owned).into_iter().chain(paths).chain(quantities);
    let mut text = titles.collect::<Vec<_>>().join(",") + "\n";
    for one in results.iter().filter(|one| !one.design.is_empty()) {
        let settings = study.settings(&one.design).unwrap_or_default();
        let settings = settings.iter().map(|(_, value)| match value {
            Value::Number(number) => number.to_string(),
            other => quoted(&sweep_value(other)),
        });
        let values = one.values.iter().map(|value| value.map_or(String::new(), |value| value.to_string()));
        let missed = search.aims().missed(&one.values);
        let start = [one.task.to_string(), one.evaluations.to_string(), missed.to_string()];
        text += &(start.into_iter().chain(settings).chain(values).collect::<Vec<_>>().join(",") + "\n");
    }
    text
}
