//! A choice of the columns of a sweep's table.

use papilio_diagnostics::did_you_mean;
use papilio_display::scene::Metric;

use crate::sweep::{SweepHead, SweepPoint};

/// Columns that say where a row belongs; they are always part of the table.
const PLACES: [&str; 3] = ["theta_deg", "phi_deg", "state"];

/// Returns points whose rows have only these columns, after inclination and azimuth of the view.
///
/// A column is one of `states.csv` (`Y`, `contrast_ratio`, `Y_se`), or that of one state (`white.Y`). If all
/// are metrics of a view or of one state, there is one row for each view. Otherwise there is one for each
/// view and state, which the column `state` names. Points that lack a column have empty cells.
///
/// # Errors
/// A column that no point has, or `Y` of all states next to `white.Y` of one: its name, and what is wrong.
pub fn sweep_columns(points: &[&SweepPoint], columns: &[String]) -> Result<Vec<SweepPoint>, String> {
    let by_view = columns.iter().all(|name| is_of_view(points, name));
    for name in columns.iter().filter(|name| !PLACES.contains(&name.as_str())) {
        let of_state = state_of(points, name);
        if !by_view && of_state.is_some() {
            return Err(format!(
                "`{name}` is a column of one state; it cannot be next to columns of all states (write their states too: `white.Y`)"
            ));
        }
        let column = of_state.map_or(name.as_str(), |(_, column)| column);
        if !points.iter().any(|point| point.columns.iter().any(|own| own == column)) {
            let near = did_you_mean(name, known(points).iter().map(String::as_str));
            let near = near.map_or(String::new(), |near| format!("; {near}"));
            return Err(format!("there is no column `{name}`{near}"));
        }
    }
    let chosen: Vec<&str> =
        columns.iter().map(String::as_str).filter(|name| !PLACES.contains(name)).collect();
    Ok(points
        .iter()
        .map(|point| if by_view { of_views(point, &chosen) } else { of_states(point, &chosen) })
        .collect())
}

/// All columns of the first point, and those of each of its states.
fn known(points: &[&SweepPoint]) -> Vec<String> {
    let Some(point) = points.first() else { return Vec::new() };
    let mut states: Vec<&str> = point.rows.iter().filter_map(|row| point.cell(row, "state")).collect();
    states.sort_unstable();
    states.dedup();
    let of_states =
        states.iter().flat_map(|state| point.columns.iter().map(move |own| format!("{state}.{own}")));
    point.columns.iter().cloned().chain(of_states).collect()
}

/// Returns the rows of a point with these columns.
fn of_states(point: &SweepPoint, chosen: &[&str]) -> SweepPoint {
    let places = PLACES.into_iter().filter(|name| point.columns.iter().any(|own| own == name));
    let columns: Vec<String> = places.chain(chosen.iter().copied()).map(str::to_owned).collect();
    let at: Vec<Option<usize>> =
        columns.iter().map(|name| point.columns.iter().position(|own| own == name)).collect();
    let cells = |row: &Vec<String>| {
        at.iter().map(|at| at.and_then(|at| row.get(at)).cloned().unwrap_or_default()).collect()
    };
    SweepPoint { rows: point.rows.iter().map(cells).collect(), columns, ..point.clone() }
}

/// Returns one row for each view of a point.
fn of_views(point: &SweepPoint, chosen: &[&str]) -> SweepPoint {
    let has_views = point.columns.iter().any(|own| own == PLACES[0]);
    let places = PLACES.into_iter().take(if has_views { 2 } else { 0 });
    let columns = places.chain(chosen.iter().copied()).map(str::to_owned).collect();
    let row = |view: [&str; 2]| {
        let values = chosen.iter().map(|name| point.cell_of(view, name).unwrap_or_default().to_owned());
        view.into_iter().filter(|_| has_views).map(str::to_owned).chain(values).collect()
    };
    SweepPoint { rows: point.views().into_iter().map(row).collect(), columns, ..point.clone() }
}

/// Returns the state and the column of a name such as `white.Y`, if the points have this state.
fn state_of<'a>(points: &[&SweepPoint], name: &'a str) -> Option<(&'a str, &'a str)> {
    let (state, column) = name.rsplit_once('.')?;
    points.iter().any(|point| point.has_state(state)).then_some((state, column))
}

/// Returns whether a column has one value for each view.
fn is_of_view(points: &[&SweepPoint], name: &str) -> bool {
    let metric = ["_se", "_de"].iter().find_map(|end| name.strip_suffix(end)).unwrap_or(name);
    PLACES[..2].contains(&name)
        || Metric::named(metric).is_some_and(Metric::is_of_view)
        || state_of(points, name).is_some()
}

/// Returns the head and the rows of a compact sweep with these metrics only, in all views.
///
/// # Errors
/// A metric that the sweep does not store: its name.
pub fn light_columns(
    head: &SweepHead,
    rows: &[&[f64]],
    columns: &[String],
) -> Result<(SweepHead, Vec<Vec<f64>>), String> {
    let mut head = head.clone();
    let Some(light) = &mut head.light else { return Ok((head, Vec::new())) };
    let is = |metric: &String, name: &String| {
        metric == name || metric.strip_prefix(name.as_str()).is_some_and(|rest| rest.starts_with(", view "))
    };
    if let Some(name) = columns.iter().find(|name| !light.metrics.iter().any(|metric| is(metric, name))) {
        return Err(format!("this sweep does not store `{name}`, only {}", light.metrics.join(", ")));
    }
    let kept: Vec<usize> = columns
        .iter()
        .flat_map(|name| {
            (0..light.metrics.len()).filter(|k| is(&light.metrics[*k], name)).collect::<Vec<_>>()
        })
        .collect();
    light.metrics = kept.iter().map(|k| light.metrics[*k].clone()).collect();
    let row = |row: &&[f64]| kept.iter().map(|k| row.get(*k).copied().unwrap_or(f64::NAN)).collect();
    Ok((head, rows.iter().map(row).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::tests::{head, point};
    use crate::write_sweep_csv;

    fn table(columns: &[&str]) -> Result<Vec<String>, String> {
        let points: Vec<SweepPoint> = (0..6).map(point).collect();
        let columns: Vec<String> = columns.iter().map(|&name| name.to_owned()).collect();
        let chosen = sweep_columns(&points.iter().collect::<Vec<_>>(), &columns)?;
        let mut text = Vec::new();
        write_sweep_csv(&mut text, &head(), &chosen.iter().collect::<Vec<_>>()).unwrap();
        Ok(String::from_utf8(text).unwrap().lines().map(str::to_owned).collect())
    }

    #[test]
    fn columns_of_states_have_a_row_for_each_state() {
        let lines = table(&["Y"]).unwrap();
        assert_eq!(
            (lines[0].as_str(), lines[2].as_str(), lines.len()),
            ("point,a,b,state,Y", "0,1,0.1,black,0.05", 13)
        );
    }

    #[test]
    fn metrics_of_views_and_of_named_states_have_a_row_for_each_view() {
        let lines = table(&["contrast_ratio", "black.Y"]).unwrap();
        assert_eq!((lines[0].as_str(), lines.len()), ("point,a,b,contrast_ratio,black.Y", 7));
        assert_eq!(lines[5], "4,2,0.2,10,0.05");
    }

    #[test]
    fn column_that_does_not_exist_is_named() {
        assert_eq!(table(&["Q"]).unwrap_err(), "there is no column `Q`");
        assert!(table(&["Y", "white.Y"]).unwrap_err().contains("`white.Y` is a column of one state"));
        assert_eq!(table(&["whit.Y"]).unwrap_err(), "there is no column `whit.Y`; did you mean `white.Y`?");
    }
}
