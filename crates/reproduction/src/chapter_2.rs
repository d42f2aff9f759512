//! Chapter 2: phase functions.

use papilio_figures::{Chart, ChartCurve, Hue, chart};
use papilio_optics::phase::HenyeyGreenstein;

use crate::report::{Section, Table, fixed, number};

/// Mean cosines of the phase functions in the figure.
const MEAN_COSINES: [f64; 5] = [-0.3, 0.0, 0.3, 0.6, 0.9];

/// Figure 2.17.
pub(crate) fn phase_functions() -> Section {
    let count = MEAN_COSINES.len() as f64;
    let curve = |(k, g): (usize, f64)| {
        let phase = HenyeyGreenstein { anisotropy: g };
        let value = |deg: f64| phase.at_cosine(deg.to_radians().cos());
        ChartCurve {
            name: format!("g = {g}"),
            hue: Hue::Scale(k as f64 / count),
            dashed: false,
            marks: false,
            points: (0..=180).map(f64::from).map(|deg| (deg, value(deg))).collect(),
        }
    };
    let figure = Chart {
        x: "Scattering angle (deg)".to_owned(),
        y: "Phase function (1/sr)".to_owned(),
        logarithmic: true,
        at_least: vec![],
        curves: MEAN_COSINES.into_iter().enumerate().map(curve).collect(),
    };
    let mut table = Table::new(&["g", "integral over all directions", "mean cosine"]);
    for g in MEAN_COSINES {
        let phase = HenyeyGreenstein { anisotropy: g };
        // Midpoint rule in the scattering angle. Twice as many steps do not change the sixth digit of either
        // number.
        let steps = 20_000;
        let step = std::f64::consts::PI / f64::from(steps);
        let mut sums = [0.0; 2];
        for k in 0..steps {
            let (sin, cos) = ((f64::from(k) + 0.5) * step).sin_cos();
            let ring = 2.0 * std::f64::consts::PI * sin * step * phase.at_cosine(cos);
            sums[0] += ring;
            sums[1] += ring * cos;
        }
        table.row([g.to_string(), number(sums[0], 7), fixed(sums[1], 5)]);
    }
    Section::new("figure-2-17", "Figure 2.17: typical shapes of phase functions")
        .figure(chart(&figure, ""), "Henyey-Greenstein phase functions (eq. 2-18) of bulk scatterers.")
        .say(
            "Each phase function integrates to 1 and has the mean cosine g. In the second form of the thesis's eq. 2-19 for \
             the mean cosine, the factor sin \u{3b8} is missing; with this factor, the result is g:",
        )
        .table(table)
}
