//! Figures of `papilio gonio`: a surface measured by rays and by waves, and its heights.

use papilio_microgeometry::{
    AzimuthKernel, ByRays, ByWaves, Findings, Side, Statistics, Total, WaveShares, WayShares,
};

use crate::{Chart, ChartCurve, Hue, chart};

/// All figures of a measurement, by name: `totals` and `azimuths` of rays, `psd` and `cutoff` of heights,
/// `waves`, and `waves-oblique`.
pub fn of_surface(Findings { rays, waves, statistics }: &Findings, title: &str) -> Vec<(String, String)> {
    let totals = rays.as_ref().map(|rays| ("totals", totals_figure(title, &rays.totals)));
    let by_azimuth = rays.as_ref().and_then(|rays| rays.by_azimuth.as_ref());
    let azimuths = by_azimuth.map(|found| ("azimuths", azimuths_figure(title, &found.kernel)));
    let psd = statistics.as_ref().map(|statistics| ("psd", psd_figure(title, statistics)));
    let cutoff = statistics.as_ref().map(|statistics| ("cutoff", cutoff_figure(title, statistics)));
    let oblique = waves.as_ref().and_then(|waves| oblique_figure(title, waves, rays.as_ref()));
    let oblique = oblique.map(|figure| ("waves-oblique", figure));
    let waves = waves.as_ref().map(|waves| ("waves", waves_figure(title, waves)));
    let all = [totals, azimuths, psd, cutoff, waves, oblique].into_iter().flatten();
    all.map(|(name, figure)| (name.to_owned(), figure)).collect()
}

/// |beta| from which the bands hold light that is trapped below a flat face: 1, but for rounding.
const BEYOND: f64 = 1.0 - 1e-9;

/// Scattered light by the azimuth to which it goes, for light from above within 2.5 deg of the normal.
fn azimuths_figure(title: &str, kernel: &AzimuthKernel) -> String {
    let (patches, count) = (&kernel.patches, kernel.patches.azimuths());
    let curve = |name: &str, hue: usize, is_of: fn(Side, f64) -> bool| {
        let percent = |at: usize| {
            // The first band is that of the normal.
            let rows = kernel.scattered.chunks_exact(patches.count()).take(count);
            let cells = rows.flat_map(|row| row.iter().enumerate().skip(at).step_by(count));
            let seen = cells.filter(|(patch, _)| {
                let (there, [from, _]) = patches.band(*patch);
                is_of(there, from)
            });
            100.0 / count as f64 * seen.map(|(_, light)| f64::from(*light)).sum::<f64>()
        };
        let middles = patches.phi_deg().into_iter().chain([360.0]);
        let points = middles.enumerate().map(|(at, deg)| (deg, percent(at % count))).collect();
        ChartCurve { name: name.to_owned(), hue: Hue::Group(hue), dashed: false, marks: false, points }
    };
    let mut curves = vec![
        curve("scattered R", 0, |side, _| side == Side::Above),
        curve("scattered T", 1, |side, from| side == Side::Below && from < BEYOND),
        curve("trapped T", 2, |side, from| side == Side::Below && from >= BEYOND),
    ];
    curves.retain(|curve| curve.points.iter().any(|(_, light)| *light > 0.0));
    let all = Chart {
        x: "Azimuth to which light along the normal goes (deg)".to_owned(),
        y: format!("Light in steps of {} deg (%)", 360.0 / count as f64),
        logarithmic: false,
        at_least: vec![0.0],
        curves,
    };
    chart(&all, title)
}

/// Power spectral density against frequency.
fn psd_figure(title: &str, statistics: &Statistics) -> String {
    // Below is the noise of rounding.
    let largest = statistics.density.iter().map(|[_, density]| *density).fold(0.0, f64::max);
    let known = statistics.density.iter().filter(|[_, density]| *density > 1e-15 * largest);
    let points = known.map(|[frequency, density]| (*frequency, *density)).collect();
    one_curve(title, "Frequency (cycles per μm)", "Power spectral density (μm\u{2074})", true, points)
}

/// What a cut-off of the instrument leaves of the slopes, which decide where rays go.
fn cutoff_figure(title: &str, statistics: &Statistics) -> String {
    let points = statistics.by_cutoff.iter().map(|[cutoff, _, slope]| (*cutoff, *slope)).collect();
    one_curve(
        title,
        "Cut-off of short wavelengths (μm)",
        "Root mean square slope of what remains",
        false,
        points,
    )
}

fn one_curve(title: &str, x: &str, y: &str, logarithmic: bool, points: Vec<(f64, f64)>) -> String {
    let curve = ChartCurve { name: String::new(), hue: Hue::Group(0), dashed: false, marks: false, points };
    let at_least = if logarithmic { Vec::new() } else { vec![0.0] };
    let all = Chart { x: x.to_owned(), y: y.to_owned(), logarithmic, at_least, curves: vec![curve] };
    chart(&all, title)
}

/// Straight part, mirror part and haze against wavelength.
fn waves_figure(title: &str, waves: &ByWaves) -> String {
    let curve = |name: &str, hue: usize, of: fn(&WaveShares, &WayShares) -> f64| {
        let point = |(one, through): (&WaveShares, &WayShares)| (one.wavelength_nm, 100.0 * of(one, through));
        percent_curve(name, hue, waves.along_normal().map(point).collect())
    };
    let all = Chart {
        x: "Wavelength (nm)".to_owned(),
        y: "Light along the normal (%)".to_owned(),
        logarithmic: false,
        at_least: vec![0.0, 100.0],
        curves: vec![
            curve("haze", 0, |_, through| through.haze.value),
            curve("straight", 1, |_, through| through.regular.value),
            curve("mirror", 2, |one, _| one.reflected.regular.value),
        ],
    };
    chart(&all, title)
}

/// The same against the inclination, at the wavelength in the middle; `None` without inclinations but the
/// normal.
fn oblique_figure(title: &str, waves: &ByWaves, rays: Option<&ByRays>) -> Option<String> {
    let wavelengths: Vec<f64> = waves.along_normal().map(|(one, _)| one.wavelength_nm).collect();
    let nm = *wavelengths.get(wavelengths.len() / 2)?;
    let from_above = |one: &&WaveShares| one.from == Side::Above && one.wavelength_nm == nm;
    let shares: Vec<&WaveShares> = waves.shares.iter().filter(from_above).collect();
    if shares.len() < 2 {
        return None;
    }
    let curve = |name: &str, hue: usize, of: fn(&WaveShares) -> Option<f64>| {
        let point = |one: &&WaveShares| Some((one.theta_deg, 100.0 * of(one)?));
        percent_curve(name, hue, shares.iter().filter_map(point).collect())
    };
    let dashed = |curve: ChartCurve| ChartCurve { dashed: true, ..curve };
    let mut curves = vec![
        curve("haze", 0, |one| Some(one.transmitted?.haze.value)),
        dashed(curve("haze, two angles", 0, |one| Some(one.transmitted?.closed_form?.haze))),
        curve("straight", 1, |one| Some(one.transmitted?.regular.value)),
        curve("mirror", 2, |one| Some(one.reflected.regular.value)),
    ];
    if let Some(rays) = rays {
        let totals = rays.totals.iter().filter(|total| total.from == Side::Above);
        let points = totals.map(|total| (total.theta_deg, 100.0 * total.straight_haze.value)).collect();
        curves.push(dashed(percent_curve("haze by rays", 3, points)));
    }
    curves.retain(|curve| !curve.points.is_empty());
    let all = Chart {
        x: "Inclination of the light above (deg)".to_owned(),
        y: format!("Light of {nm} nm (%)"),
        logarithmic: false,
        at_least: vec![0.0, 100.0],
        curves,
    };
    Some(chart(&all, title))
}

fn percent_curve(name: &str, hue: usize, points: Vec<(f64, f64)>) -> ChartCurve {
    ChartCurve { name: name.to_owned(), hue: Hue::Group(hue), dashed: false, marks: false, points }
}

/// Reflected and transmitted light against inclination, from both sides.
fn totals_figure(title: &str, totals: &[Total]) -> String {
    let curve = |side: Side, name: &str, hue: usize, dashed: bool, of: fn(&Total) -> f64| ChartCurve {
        name: name.to_owned(),
        hue: Hue::Group(hue),
        dashed,
        marks: false,
        points: totals
            .iter()
            .filter(|total| total.from == side)
            .map(|total| (total.theta_deg, 100.0 * of(total)))
            .collect(),
    };
    let reflected = |total: &Total| total.reflected.value;
    let seen = |total: &Total| total.transmitted.value - total.transmitted_beyond.value;
    let beyond = |total: &Total| total.transmitted_beyond.value;
    let absorbed = |total: &Total| total.absorbed.value;
    let mut curves = vec![
        curve(Side::Above, "R from above", 0, false, reflected),
        curve(Side::Above, "T from above", 1, false, seen),
        curve(Side::Above, "trapped T", 2, false, beyond),
        curve(Side::Above, "absorbed from above", 3, false, absorbed),
        curve(Side::Below, "R from below", 0, true, reflected),
        curve(Side::Below, "T from below", 1, true, seen),
        curve(Side::Below, "absorbed from below", 3, true, absorbed),
    ];
    // Nothing passes metals, few surfaces absorb, and light is trapped only in the medium with the larger
    // index.
    curves.retain(|curve| curve.points.iter().any(|(_, light)| *light > 0.0));
    let all = Chart {
        x: "Inclination of the light in its medium (deg)".to_owned(),
        y: "Light (%)".to_owned(),
        logarithmic: false,
        at_least: vec![0.0, 100.0],
        curves,
    };
    chart(&all, title)
}
