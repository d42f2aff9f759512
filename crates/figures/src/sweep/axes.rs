//! The axes of a sweep's results: its views, if there are several, then its swept axes.

use papilio_formats::{SweepHead, SweepHeadAxis, SweepPoint, sweep_value};

use super::SweepAxis;

/// Returns the views of all points; none if they differ.
pub(super) fn common_views<'a>(points: &[&'a SweepPoint]) -> Vec<[&'a str; 2]> {
    let views = points.first().map(|first| first.views()).unwrap_or_default();
    if points.iter().all(|point| point.views() == views) { views } else { vec![] }
}

/// Returns the views as an axis, if there are several.
pub(super) fn of_views(views: &[[&str; 2]]) -> Option<SweepAxis> {
    let first = views.first().filter(|_| views.len() > 1)?;
    let one = |k: usize| views.iter().all(|view| view[k] == first[k]);
    let (name, text): (&str, fn(&[&str; 2]) -> String) = match (one(0), one(1)) {
        (_, true) => ("theta_deg", |view| view[0].to_owned()),
        (true, false) => ("phi_deg", |view| view[1].to_owned()),
        (false, false) => ("theta_deg / phi_deg", |view| view.join(" / ")),
    };
    Some(SweepAxis { name: name.to_owned(), values: views.iter().map(text).collect() })
}

/// Returns a swept axis. Its name is the first of its keys that changes, followed by the others in brackets.
pub(super) fn of_axis(head: &SweepHead, axis: &SweepHeadAxis) -> SweepAxis {
    let text = |key: usize| -> Vec<String> {
        axis.values.iter().map(|values| values.get(key).map(sweep_value).unwrap_or_default()).collect()
    };
    let changes = |key: &usize| text(*key).windows(2).any(|pair| pair[0] != pair[1]);
    let leading = (0..axis.keys.len()).find(changes).unwrap_or(0);
    let names: Vec<String> = axis.keys.iter().map(|key| short_key(head, key)).collect();
    let others: Vec<&str> =
        names.iter().enumerate().filter(|(k, _)| *k != leading).map(|(_, name)| name.as_str()).collect();
    let with = if others.is_empty() { String::new() } else { format!(" (with {})", others.join(", ")) };
    SweepAxis {
        name: names.get(leading).map(|name| format!("{name}{with}")).unwrap_or_default(),
        values: text(leading),
    }
}

/// Returns the shortest end of a key that no other swept key has: `haze` for `display.diffuser.haze`.
pub fn short_key(head: &SweepHead, key: &str) -> String {
    let all = || head.axes.iter().flat_map(|axis| &axis.keys).filter(|other| *other != key);
    let starts = key.match_indices('.').map(|(at, _)| at + 1).rev().chain([0]);
    let is_clear = |end: &&str| {
        !end.starts_with(|c: char| c.is_ascii_digit()) && all().all(|other| !other.ends_with(*end))
    };
    starts.map(|start| &key[start..]).find(is_clear).unwrap_or(key).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn head(axes: Vec<SweepHeadAxis>) -> SweepHead {
        SweepHead { papilio: String::new(), title: None, axes, figures: vec![], light: None }
    }

    #[test]
    fn axis_of_several_keys_names_all() {
        let keys = ["lighting.preset", "lighting.diffuse", "lighting.directed.0.share"];
        let value = |share: f64| vec![json!("indoor"), json!(share), json!(1.0 - share)];
        let axis =
            SweepHeadAxis { keys: keys.map(str::to_owned).to_vec(), values: vec![value(1.0), value(0.5)] };
        let named = of_axis(&head(vec![axis.clone()]), &axis);
        assert_eq!(named.name, "diffuse (with preset, share)");
        assert_eq!(named.values, ["1", "0.5"]);
    }

    #[test]
    fn axis_of_views_is_named_after_changing_angles() {
        let name = |views: &[[&str; 2]]| of_views(views).map(|named| (named.name, named.values[1].clone()));
        let expected = |name: &str, value: &str| Some((name.to_owned(), value.to_owned()));
        assert_eq!(name(&[["0", "0"]]), None);
        assert_eq!(name(&[["0", "0"], ["8", "0"]]), expected("theta_deg", "8"));
        assert_eq!(name(&[["8", "0"], ["8", "90"]]), expected("phi_deg", "90"));
        assert_eq!(name(&[["0", "0"], ["8", "90"]]), expected("theta_deg / phi_deg", "8 / 90"));
    }

    #[test]
    fn short_keys_are_shortest_unique_ends() {
        let axis = |key: &str| SweepHeadAxis { keys: vec![key.to_owned()], values: vec![] };
        let keys = ["display.diffuser.haze", "viewer.theta_deg", "lighting.directed.0.theta_deg"];
        let head = head(keys.iter().map(|key| axis(key)).collect());
        let short = keys.map(|key| super::short_key(&head, key));
        assert_eq!(short, ["haze", "viewer.theta_deg", "directed.0.theta_deg"]);
    }
}
