//! Shares of light by window and sub-pixel.

use super::Shares;
use super::found::errors;

/// Shares of the light of a page and of what entered, of all lights together, `[light][window][sub-pixel]`.
pub(super) fn shares(page: &[Vec<Vec<f64>>], entered: &[Vec<Vec<f64>>]) -> Shares {
    let out = Rows::new(&sum(page));
    let entered = (!entered.is_empty()).then(|| {
        let sums = sum(entered);
        let count = sums.first().map_or(0, Vec::len);
        let row = |sub_pixel: usize| sums.iter().map(|window| window[sub_pixel]).collect();
        Rows::new(&(0..count).map(row).collect::<Vec<_>>())
    });
    Shares {
        out: out.shares,
        inactive_out: out.rest,
        own_share_out: out.own,
        own_share_in: entered.as_ref().and_then(|entered| entered.own),
        between_in: entered.as_ref().map(|entered| entered.rest.clone()),
        in_: entered.map(|entered| entered.shares),
        error: 0.0,
        own_share_errors: [None; 2],
    }
}

/// Shares of the light of each row.
struct Rows {
    /// Of each row, all but the last of its light: sums are 1.
    shares: Vec<Vec<f64>>,
    /// The last, over all light of the row.
    rest: Vec<f64>,
    /// Light of the diagonal over all light but the last.
    own: Option<f64>,
}

impl Rows {
    fn new(light: &[Vec<f64>]) -> Self {
        let count = light.len();
        let over = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
        let active = |row: &[f64]| row[..count].iter().sum::<f64>();
        let shares = |row: &Vec<f64>| row[..count].iter().map(|light| over(*light, active(row))).collect();
        let rest = |row: &Vec<f64>| over(row[count], active(row) + row[count]);
        let own: f64 = light.iter().enumerate().map(|(i, row)| row[i]).sum();
        let total: f64 = light.iter().map(|row| active(row)).sum();
        Self {
            shares: light.iter().map(shares).collect(),
            rest: light.iter().map(rest).collect(),
            own: (total > 0.0).then(|| own / total),
        }
    }
}

/// Sum over lights.
fn sum(lights: &[Vec<Vec<f64>>]) -> Vec<Vec<f64>> {
    let mut sums = lights.first().cloned().unwrap_or_default();
    for light in lights.iter().skip(1) {
        for (sum, row) in sums.iter_mut().zip(light) {
            sum.iter_mut().zip(row).for_each(|(sum, light)| *sum += light);
        }
    }
    sums
}

/// Shares with the largest of their errors, and those of the own shares.
pub(super) fn with_error(found: Shares, others: &[Shares]) -> Shares {
    let all = |shares: &Shares| -> Vec<Option<f64>> {
        let rows = shares.out.iter().chain(shares.in_.iter().flatten()).flatten();
        let rest = shares.inactive_out.iter().chain(shares.between_in.iter().flatten());
        let own = [shares.own_share_out, shares.own_share_in];
        rows.chain(rest).copied().map(Some).chain(own).collect()
    };
    let others: Vec<_> = others.iter().map(all).collect();
    let errors = errors(&all(&found), &others);
    let own_share_errors = [errors[errors.len() - 2], errors[errors.len() - 1]];
    let error = errors.into_iter().flatten().fold(0.0, f64::max);
    Shares { error, own_share_errors, ..found }
}
