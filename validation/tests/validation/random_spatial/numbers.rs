//! Numbers of `papilio mtf` and `papilio crosstalk`, with their errors.

use std::collections::HashMap;

use papilio_display::spatial::{CrosstalkResult, Curves, MtfResult};

/// Frequencies compared of each curve.
const FREQUENCIES: usize = 3;

/// A real or complex number of a result.
#[derive(Debug, Clone, Copy)]
pub(super) struct Number {
    pub(super) value: [f64; 2],
    pub(super) error: f64,
}

/// Numbers by their names. Those of errors that are bounds, not standard errors, have names that end with
/// `*`.
pub(super) type Numbers = HashMap<String, Number>;

fn add(all: &mut Numbers, what: String, value: Option<f64>, error: Option<f64>) {
    if let (Some(value), Some(error)) = (value, error) {
        all.insert(what, Number { value: [value, 0.0], error });
    }
}

fn add_curves(all: &mut Numbers, what: &str, curves: &Curves, frequencies: &[(f64, usize)]) {
    let axes = [(&curves.otf_x, &curves.error_x, 'x'), (&curves.otf_y, &curves.error_y, 'y')];
    for (otf, errors, axis) in axes {
        for (f, k) in frequencies {
            let number = Number { value: otf[*k], error: errors[*k] };
            all.insert(format!("{what} at {f:.4} {axis}"), number);
        }
    }
}

/// Numbers of sharpness. Below `from_per_mm` most of what is missing to 1 is rare light from far away, of
/// which few paths find neither mean nor error.
pub(super) fn of_sharpness(result: &MtfResult, highest: [f64; 2]) -> Numbers {
    let mut all = Numbers::new();
    let view = &result.views[0];
    let [from, to] = highest;
    let frequencies: Vec<(f64, usize)> = result.frequency_per_mm.iter().copied().zip(0..).collect();
    let inside: Vec<(f64, usize)> =
        frequencies.into_iter().filter(|(f, _)| (from..=to).contains(f)).collect();
    let step = inside.len().div_ceil(FREQUENCIES).max(1);
    let some: Vec<(f64, usize)> = inside.into_iter().step_by(step).collect();
    for (name, state) in view.states.iter() {
        add_curves(&mut all, &format!("otf {name}"), &state.otf, &some);
        for (light, curves) in state.by_light.iter() {
            add_curves(&mut all, &format!("otf {name} {light}"), curves, &some);
        }
        for ((what, value), (_, error)) in state.scalars.named().zip(state.error.named()) {
            add(&mut all, format!("{what} {name}"), value, error);
        }
    }
    let lines = view.line_contrast.named().zip(view.line_contrast_error.named());
    for ((what, value), (_, error)) in lines {
        add(&mut all, format!("line {what}"), value, error);
    }
    // The smallest one of noisy numbers is low.
    let text_error = view.text_contrast_error.map(|[_, median]| median);
    add(&mut all, "text median".to_owned(), view.text_contrast_median, text_error);
    for (k, mean) in result.patterns.iter().enumerate() {
        add(&mut all, format!("pattern {:?} {k}", mean.kind), Some(mean.mean_Y), Some(mean.error));
    }
    all
}

/// Numbers of crosstalk.
pub(super) fn of_crosstalk(result: &CrosstalkResult) -> Numbers {
    let mut all = Numbers::new();
    let view = &result.views[0];
    let lights = view.by_light.iter().chain([("all", &view.shares)]);
    for (light, shares) in lights {
        let rows = shares.out.iter().chain(shares.in_.iter().flatten()).flatten();
        let rest = shares.inactive_out.iter().chain(shares.between_in.iter().flatten());
        for (k, share) in rows.chain(rest).enumerate() {
            add(&mut all, format!("share {light} {k}*"), Some(*share), Some(shares.error));
        }
        let own = [shares.own_share_out, shares.own_share_in].into_iter().zip(shares.own_share_errors);
        for (k, (share, error)) in own.enumerate() {
            add(&mut all, format!("own {k} {light}"), share, error);
        }
    }
    for pattern in &view.patterns {
        let (values, errors) = (pattern.values, pattern.error);
        let mut add =
            |what: &str, value, error| add(&mut all, format!("{what} {:?}", pattern.name), value, error);
        add("gamut", values.gamut_percent_srgb, errors.gamut_percent_srgb);
        add("contrast", values.contrast_ratio, errors.contrast_ratio);
        add("pixel-contrast", values.contrast_ratio_via_pixel, errors.contrast_ratio_via_pixel);
    }
    all
}
