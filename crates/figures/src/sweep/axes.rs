//! The axes of a sweep's results: its views, if there are several, then its swept axes.

use papilio_display::{Label, label_from_name, metric_label, uncapitalised};
use papilio_formats::{SweepHeadAxis, SweepPoint, sweep_value};

use super::SweepAxis;

/// The labels of keys and metrics, by their names.
pub(super) type Labels<'a> = &'a dyn Fn(&str) -> Label;

/// Returns the views of all points; none if they differ.
pub(super) fn common_views<'a>(points: &[&'a SweepPoint]) -> Vec<[&'a str; 2]> {
    let views = points.first().map(|first| first.views()).unwrap_or_default();
    if points.iter().all(|point| point.views() == views) { views } else { vec![] }
}

/// Returns the views as an axis, if there are several, with its label.
pub(super) fn of_views(views: &[[&str; 2]]) -> Option<LabelledAxis> {
    let first = views.first().filter(|_| views.len() > 1)?;
    let one = |k: usize| views.iter().all(|view| view[k] == first[k]);
    let labelled = |name| metric_label(name).unwrap_or_else(|| label_from_name(name));
    let (label, text): (Label, fn(&[&str; 2]) -> String) = match (one(0), one(1)) {
        (_, true) => (labelled("theta_deg"), |view| view[0].to_owned()),
        (true, false) => (labelled("phi_deg"), |view| view[1].to_owned()),
        (false, false) => (Label::new("Viewing angle / azimuth", "deg"), |view| view.join(" / ")),
    };
    Some(LabelledAxis::new(label, "", views.iter().map(text).collect()))
}

/// An axis, and the label of the quantity whose values it has.
#[derive(Debug, Clone)]
pub(super) struct LabelledAxis {
    pub(super) axis: SweepAxis,
    pub(super) label: Label,
}

impl LabelledAxis {
    fn new(label: Label, with: &str, values: Vec<String>) -> Self {
        Self { axis: SweepAxis { name: format!("{label}{with}"), values }, label }
    }
}

/// Returns a swept axis. Its name is the label of the first of its keys that changes; the others follow.
pub(super) fn of_axis(axis: &SweepHeadAxis, labels: Labels<'_>) -> LabelledAxis {
    let text = |key: usize| -> Vec<String> {
        axis.values.iter().map(|values| values.get(key).map(sweep_value).unwrap_or_default()).collect()
    };
    let changes = |key: &usize| text(*key).windows(2).any(|pair| pair[0] != pair[1]);
    let leading = (0..axis.keys.len()).find(changes).unwrap_or(0);
    let label = axis.keys.get(leading).map_or_else(|| Label::new("", ""), |key| labels(key));
    let others = || axis.keys.iter().enumerate().filter(|(k, _)| *k != leading).map(|(_, key)| labels(key));
    let with = match others().count() {
        0 => String::new(),
        1 | 2 => {
            let others: Vec<String> = others().map(|other| uncapitalised(&other.quantity)).collect();
            format!(", with {}", others.join(" and "))
        }
        more => format!(", with {more} other keys"),
    };
    LabelledAxis::new(label, &with, text(leading))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn words(key: &str) -> Label {
        label_from_name(key.rsplit('.').next().unwrap_or(key))
    }

    #[test]
    fn axis_of_several_keys_names_all() {
        let keys = ["lighting.preset", "lighting.diffuse", "lighting.directed.0.share"];
        let value = |share: f64| vec![json!("indoor"), json!(share), json!(1.0 - share)];
        let axis =
            SweepHeadAxis { keys: keys.map(str::to_owned).to_vec(), values: vec![value(1.0), value(0.5)] };
        let named = of_axis(&axis, &words);
        assert_eq!(named.axis.name, "Diffuse, with preset and share");
        assert_eq!(named.axis.values, ["1", "0.5"]);
        assert_eq!(named.label.with_value("1"), "Diffuse = 1");
    }

    #[test]
    fn axis_of_views_is_named_after_changing_angles() {
        let name = |views: &[[&str; 2]]| {
            of_views(views).map(|named| (named.axis.name, named.axis.values[1].clone()))
        };
        let expected = |name: &str, value: &str| Some((name.to_owned(), value.to_owned()));
        assert_eq!(name(&[["0", "0"]]), None);
        assert_eq!(name(&[["0", "0"], ["8", "0"]]), expected("Viewing angle (deg)", "8"));
        assert_eq!(name(&[["8", "0"], ["8", "90"]]), expected("Azimuth of the view (deg)", "90"));
        assert_eq!(name(&[["0", "0"], ["8", "90"]]), expected("Viewing angle / azimuth (deg)", "8 / 90"));
    }
}
