//! Figures 5.5 to 5.13 and Table 5.2: bare and diffused panels.

use num_complex::Complex64;
use papilio_display::result::{RunResult, View};
use papilio_figures::{Chart, ChartCurve, Hue, chart, gamuts as draw_gamuts, spectra_over};
use papilio_optics::film::{Film, Layer, Polarisation, coherent};

use crate::displays::{Bench, ReproductionError, first, of};
use crate::report::{Section, Table, difference, number};

/// The three primaries: name, and the reference pixel's gap, nm.
const PRIMARIES: [(&str, f64); 3] = [("red", 275.9), ("green", 192.3), ("blue", 137.8)];

/// Table 5.2: peaks of the bare panel at 20 and 8 deg, and of the diffused one, nm.
const TABLE_5_2: [[f64; 4]; 3] =
    [[613.0, 690.0, 665.0, 683.0], [472.0, 528.0, 498.0, 520.0], [400.0, 437.0, 407.0, 421.0]];

/// Change of key for the diffused panel without front of screen: it differs from the bare panel by the
/// diffuser only.
const NO_FRONT: &str = "display.front=[]";

/// Change of key for the reflectance of the pixel at the angle in air, as the thesis's tracer probably used
/// it.
const UNREFRACTED: &str = "solver.angle_medium=unrefracted";

/// Change of key for the bare panel with angles in air.
const IN_AIR: &str = "solver.angle_medium=air";

fn bare(bench: &Bench<'_>, theta_deg: &[f64], medium: &str) -> Result<RunResult, ReproductionError> {
    bench.at("reference-pixel", theta_deg, &["spectrum.step_nm=5", medium])
}

/// Figures 5.5 and 5.7.
pub(super) fn gamuts(bench: &Bench<'_>) -> Result<Section, ReproductionError> {
    let bare = bare(bench, &[8.0], "solver.angle_medium=glass")?;
    let bare_in_air = self::bare(bench, &[8.0], IN_AIR)?;
    let diffused = bench.run("overcast", &[NO_FRONT])?;
    let measured = bench.run("measured-diffused", &[])?;
    let displays = [("bare", first(&bare)), ("diffused", first(&diffused))];
    let mut table = Table::new(&["", "gamut, % of sRGB", "contrast ratio", "white Y"]);
    for (name, result) in [
        ("bare, angles in glass", &bare),
        ("bare, angles in air", &bare_in_air),
        ("diffused, haze 78", &diffused),
        ("diffused, H78 from its measurement", &measured),
    ] {
        let view = first(result);
        let cells = [
            view.metrics.gamut_percent_srgb.unwrap_or(f64::NAN),
            view.metrics.contrast_ratio.unwrap_or(f64::NAN),
            of(view, "white", |v| Some(v.Y)),
        ];
        table.row(std::iter::once(name.to_owned()).chain(cells.map(|v| number(v, 3))));
    }
    let turn = |view: &View, other: &View| {
        // Hue angle of a primary about the white of the light, in u'v'.
        let hue_deg = |view: &View, state: &str| {
            let (u, v) = (of(view, state, |s| s.u_prime), of(view, state, |s| s.v_prime));
            (v - 0.46834).atan2(u - 0.19784).to_degrees()
        };
        PRIMARIES.map(|(state, _)| {
            let turned = hue_deg(other, state) - hue_deg(view, state);
            (turned + 540.0).rem_euclid(360.0) - 180.0
        })
    };
    let turned = turn(first(&bare), first(&diffused));
    let words: Vec<String> = PRIMARIES
        .iter()
        .zip(turned)
        .map(|((name, _), deg)| format!("{name} by {} deg", difference(deg, 1)))
        .collect();
    Ok(Section::new("figure-5-5", "Figures 5.5 and 5.7: colour gamuts of a bare and a diffused panel")
        .figure(draw_gamuts(&displays, "At 8 deg, diffuse light"), "The angle of the bare panel is in glass, as in the thesis.")
        .table(table)
        .say(format!(
            "The thesis finds that a diffuser rotates the gamut triangle counter-clockwise (to the blue) and makes it smaller. \
             Here, the primaries rotate about white: {} (positive is counter-clockwise).",
            words.join(", ")
        )))
}

/// Figure 5.6.
pub(super) fn spectra(bench: &Bench<'_>) -> Result<Section, ReproductionError> {
    let bare = bare(bench, &[8.0], "solver.angle_medium=glass")?;
    let diffused = bench.run("overcast", &[NO_FRONT])?;
    let single = bench.run("overcast", &[NO_FRONT, UNREFRACTED])?;
    let mut table = Table::new(&["largest reflectance factor", "bare", "diffused", "diffused, unrefracted"]);
    for (state, _) in PRIMARIES {
        let largest = |result: &RunResult| {
            let values =
                first(result).states.get(state).and_then(|state| state.value.reflectance_factor.as_ref());
            let values = values.into_iter().flatten().zip(&result.wavelength_nm);
            values.filter(|(_, nm)| **nm >= 400.0).map(|(value, _)| *value).fold(0.0, f64::max)
        };
        let cells = [&bare, &diffused, &single].map(|result| number(largest(result), 3));
        table.row(std::iter::once(state.to_owned()).chain(cells));
    }
    let shown = [("bare", &bare), ("diffused", &diffused), ("diffused, unrefracted", &single)];
    Ok(Section::new("figure-5-6", "Figure 5.6: simulated reflectance, bare and diffused, at 8 deg")
        .figure(spectra_over(&shown, ""), "Diffuse light. The measured panel of the thesis, part (b) of its figure, is not public.")
        .table(table)
        .say(
            "As in the thesis, the diffuser lowers the reflectance and flattens the spectra. It shifts them to the blue \
             relative to a bare panel whose angles are in air (table 5.2); a bare panel whose angles are in glass has its \
             peaks further in the blue. Without a front, no light returns to the pixel, so that one pass is exact here. \
             The third column differs only in the angle at which the reflectance of the pixel is taken.",
        ))
}

/// Figure 5.8.
pub(super) fn gamut_against_angle(bench: &Bench<'_>) -> Result<Section, ReproductionError> {
    let theta: Vec<f64> = (8..=20).step_by(2).map(f64::from).collect();
    let all = [
        ("bare, glass", bare(bench, &theta, "solver.angle_medium=glass")?, false),
        ("bare, air", bare(bench, &theta, IN_AIR)?, true),
        ("diffused, air", bench.at("overcast", &theta, &[NO_FRONT])?, false),
        ("unrefracted", bench.at("overcast", &theta, &[NO_FRONT, UNREFRACTED])?, true),
    ];
    let gamut = |view: &View| view.metrics.gamut_percent_ebu.unwrap_or(f64::NAN);
    let curve = |(k, (name, result, dashed)): (usize, &(&str, RunResult, bool))| ChartCurve {
        name: (*name).to_owned(),
        hue: Hue::Group(if k < 2 { 0 } else { 2 }),
        dashed: *dashed,
        marks: false,
        points: result.views.iter().map(|view| (view.theta_deg, gamut(view))).collect(),
    };
    let figure = Chart {
        x: "Viewing angle (deg)".to_owned(),
        y: "Gamut (% of EBU)".to_owned(),
        logarithmic: false,
        at_least: vec![0.0],
        curves: all.iter().enumerate().map(curve).collect(),
    };
    let mut table = Table::new(&["gamut, % of EBU", "8 deg", "20 deg", "decrease"]);
    for (name, result, _) in &all {
        let ends = [result.views.first(), result.views.last()].map(|view| view.map_or(f64::NAN, gamut));
        let decrease = format!("{:.0} %", 100.0 * (1.0 - ends[1] / ends[0]));
        table.row([(*name).to_owned(), number(ends[0], 3), number(ends[1], 3), decrease]);
    }
    Ok(Section::new("figure-5-8", "Figure 5.8: colour gamut against viewing angle")
        .figure(chart(&figure, ""), "Diffuse light. Unrefracted: the diffused panel, with the reflectance of the pixel at the angle in air.")
        .table(table)
        .say(
            "The thesis finds that the gamut of a bare panel decreases faster. This holds if the angles of the bare panel are \
             in glass. If the angles of both panels are in air, the bare panel hardly changes from 8 to 20 deg, which are 5 \
             to 13 deg at the pixel: the thesis's figure compares two conventions.",
        ))
}

/// Figure 5.10.
pub(super) fn soap_film() -> Section {
    /// A film of water in air, nm.
    const THICKNESS_NM: f64 = 300.0;
    const WATER: f64 = 1.33;
    let angles = [0.0_f64, 10.0, 20.0, 30.0];
    let nm: Vec<f64> = (380..=780).step_by(4).map(f64::from).collect();
    let exact = |theta: f64, nm: f64| {
        let film = Film {
            incidence: 1.0,
            layers: vec![Layer { index: Complex64::new(WATER, 0.0), thickness_nm: THICKNESS_NM }],
            substrate: Complex64::new(1.0, 0.0),
        };
        let beta = theta.to_radians().sin();
        let of = |polarisation| coherent(&film, nm, beta, polarisation).map_or(f64::NAN, |c| c.reflectance);
        0.5 * (of(Polarisation::S) + of(Polarisation::P))
    };
    let formula = |theta: f64, nm: f64| {
        // Eq. 5-11; R_f is the reflectance of one interface at normal incidence.
        let inside = (theta.to_radians().sin() / WATER).asin();
        let interface = ((WATER - 1.0) / (WATER + 1.0)).powi(2);
        4.0 * interface * (std::f64::consts::TAU * THICKNESS_NM * WATER * inside.cos() / nm).sin().powi(2)
    };
    let mut curves = Vec::new();
    for (k, theta) in angles.into_iter().enumerate() {
        let position = k as f64 / angles.len() as f64;
        let curve = |name: String, dashed, of: &dyn Fn(f64, f64) -> f64| ChartCurve {
            name,
            hue: Hue::Scale(position),
            dashed,
            marks: false,
            points: nm.iter().map(|nm| (*nm, of(theta, *nm))).collect(),
        };
        curves.push(curve(format!("{theta} deg"), false, &exact));
        curves.push(curve(String::new(), true, &formula));
    }
    let figure = Chart {
        x: "Wavelength (nm)".to_owned(),
        y: "Reflectance".to_owned(),
        logarithmic: false,
        at_least: vec![0.0],
        curves,
    };
    let mut table =
        Table::new(&["angle in air (deg)", "peak, exact (nm)", "peak, 4 w n cos \u{3b8} / 3 (nm)"]);
    for theta in angles {
        let highest = nm.iter().copied().max_by(|a, b| exact(theta, *a).total_cmp(&exact(theta, *b)));
        let inside = (theta.to_radians().sin() / WATER).asin();
        // Interference is constructive if the path is an odd number of half waves; 4 w n cos/3 is in the
        // visible range.
        let order = 4.0 * THICKNESS_NM * WATER * inside.cos() / 3.0;
        table.row([theta.to_string(), number(highest.unwrap_or(f64::NAN), 3), number(order, 3)]);
    }
    Section::new("figure-5-10", "Figure 5.10: thin film spectral reflectance at different angles")
        .figure(
            chart(&figure, "A film of water, 300 nm, in air"),
            "Solid: all orders and both polarisations, by the transfer matrices of Papilio's pixels. Dashed: eq. 5-11, first \
             order.",
        )
        .table(table)
        .say(
            "The peak shifts from red to violet with increasing angle. The thesis's text (p. 69) states the opposite, but its \
             figure agrees. The thesis does not give the thickness of the film.",
        )
}

/// Figure 5.12.
pub(super) fn shift_at_20(bench: &Bench<'_>) -> Result<Section, ReproductionError> {
    let bare = bare(bench, &[20.0], "solver.angle_medium=glass")?;
    let diffused = bench.at("overcast", &[20.0], &[NO_FRONT])?;
    let unrefracted = bench.at("overcast", &[20.0], &[NO_FRONT, UNREFRACTED])?;
    let shown =
        [("bare, in glass", &bare), ("diffused, in air", &diffused), ("diffused, unrefracted", &unrefracted)];
    Ok(Section::new("figure-5-12", "Figure 5.12: SPD shift from a bare to a diffused panel at 20 deg")
        .figure(spectra_over(&shown, ""), "Diffuse light.")
        .say(
            "The thesis finds a red shift at 20 deg. There is one relative to a bare panel whose angle is in glass, but it is \
             due to the convention: the 20 deg of the diffused panel in air are 13 deg at the pixel. Figure 5.13 compares \
             both conventions.",
        ))
}

/// Returns the peaks of the three sub-pixels, each computed as the only one, in several views of a panel, nm;
/// NaN where the peak of blue is below 400 nm.
fn peaks(
    bench: &Bench<'_>,
    scenario: &str,
    theta_deg: &[f64],
    set: &[&str],
) -> Result<[Vec<f64>; 3], ReproductionError> {
    let mut all = [const { Vec::new() }; 3];
    for ((name, gap), peaks) in PRIMARIES.into_iter().zip(&mut all) {
        let own = [
            format!("display.pixel.area={{ {name} = 1.0 }}"),
            format!("display.pixel.gap_nm={{ {name} = {gap}, dark = 20.0 }}"),
            format!("display.pixel.states={{ {name} = {{ {name} = 1.0 }} }}"),
        ];
        let set: Vec<&str> = own.iter().map(String::as_str).chain(set.iter().copied()).collect();
        let result = bench.at(scenario, theta_deg, &set)?;
        *peaks = result.views.iter().map(|view| of(view, name, |v| v.peak_nm)).collect();
    }
    Ok(all)
}

/// Figure 5.13.
pub(super) fn peak_shift(bench: &Bench<'_>) -> Result<Section, ReproductionError> {
    let theta: Vec<f64> = (0..=24).step_by(2).map(f64::from).collect();
    let bare_glass = peaks(bench, "reference-pixel", &theta, &[])?;
    let bare_air = peaks(bench, "reference-pixel", &theta, &[IN_AIR])?;
    let diffused = peaks(bench, "overcast", &theta, &[NO_FRONT])?;
    let unrefracted = peaks(bench, "overcast", &theta, &[NO_FRONT, UNREFRACTED])?;
    let mean = |diffused: &[Vec<f64>; 3], bare: &[Vec<f64>; 3]| -> Vec<(f64, f64)> {
        let at = |k: usize| {
            let shifts: Vec<f64> =
                (0..3).map(|c| diffused[c][k] - bare[c][k]).filter(|s| s.is_finite()).collect();
            shifts.iter().sum::<f64>() / shifts.len() as f64
        };
        theta.iter().enumerate().map(|(k, theta)| (*theta, at(k))).collect()
    };
    let all = [
        ("glass and air", mean(&diffused, &bare_glass), 0, false),
        ("both in air", mean(&diffused, &bare_air), 2, false),
        ("at the pixel", mean(&unrefracted, &bare_glass), 1, true),
    ];
    let curves = all.iter().map(|(name, points, group, dashed)| ChartCurve {
        name: (*name).to_owned(),
        hue: Hue::Group(*group),
        dashed: *dashed,
        marks: false,
        points: points.clone(),
    });
    let figure = Chart {
        x: "Viewing angle (deg)".to_owned(),
        y: "Average peak shift (nm)".to_owned(),
        logarithmic: false,
        at_least: vec![0.0],
        curves: curves.collect(),
    };
    let mut table = Table::new(&["average peak shift, nm (eq. 5-12)", "0 deg", "8 deg", "20 deg"]);
    for (name, points, ..) in &all {
        let at = |deg: f64| points.iter().find(|(theta, _)| *theta == deg).map_or(f64::NAN, |point| point.1);
        table.row(
            std::iter::once((*name).to_owned()).chain([0.0, 8.0, 20.0].map(|d| format!("{:+.1}", at(d)))),
        );
    }
    Ok(Section::new("figure-5-13", "Figure 5.13: average peak shift against angle")
        .figure(chart(&figure, ""), "Peaks of single sub-pixels, diffused minus bare, in diffuse light; haze 78. Glass and air: angles of the bare panel in \
             glass, of the diffused panel in air. At the pixel: the diffused panel unrefracted.")
        .table(table)
        .say(
            "The thesis finds a blue shift at small angles that becomes a red shift at large angles (about +35 nm at 24 deg in \
             its figure). With the angles of the bare panel in glass and those of the diffused panel in air, the result here \
             is the same. With one convention for both, the red shift at 20 deg is a few nm or none. Peaks below 400 nm \
             (blue at large angles in glass) are omitted from the mean.",
        ))
}

/// Table 5.2.
pub(super) fn table_5_2(bench: &Bench<'_>) -> Result<Section, ReproductionError> {
    let views = [20.0, 8.0];
    let bare_glass = peaks(bench, "reference-pixel", &views, &[])?;
    let bare_air = peaks(bench, "reference-pixel", &views, &[IN_AIR])?;
    let diffused_air = peaks(bench, "overcast", &views, &[NO_FRONT])?;
    let unrefracted = peaks(bench, "overcast", &views, &[NO_FRONT, UNREFRACTED])?;
    let nm = |value: f64| if value.is_finite() { format!("{value:.0}") } else { "400 or less".to_owned() };
    let mut bare = Table::new(&["bare: peak, nm", "thesis", "here, in glass", "difference", "here, in air"]);
    let mut diffused = Table::new(&[
        "diffused: peak, nm",
        "thesis",
        "here, in air",
        "difference",
        "here, unrefracted",
        "difference",
    ]);
    let difference = |ours: f64, theirs: f64| {
        if ours.is_finite() { format!("{:+.1}", ours - theirs) } else { "at most 0".to_owned() }
    };
    for (c, (name, _)) in PRIMARIES.into_iter().enumerate() {
        for (k, theta) in views.into_iter().enumerate() {
            let row = format!("{name}, {theta} deg");
            let [printed_bare, printed] = [TABLE_5_2[c][k], TABLE_5_2[c][2 + k]];
            let (glass, air) = (bare_glass[c][k], bare_air[c][k]);
            bare.row([row.clone(), nm(printed_bare), nm(glass), difference(glass, printed_bare), nm(air)]);
            let (air, at_air_angle) = (diffused_air[c][k], unrefracted[c][k]);
            diffused.row([
                row,
                nm(printed),
                nm(air),
                difference(air, printed),
                nm(at_air_angle),
                difference(at_air_angle, printed),
            ]);
        }
    }
    let spread = |peaks: &[Vec<f64>; 3]| {
        let shifts: Vec<f64> =
            peaks.iter().map(|of| of[1] - of[0]).filter(|shift| shift.is_finite()).collect();
        format!("{:.1}", shifts.iter().sum::<f64>() / shifts.len() as f64)
    };
    let mut average = Table::new(&["average shift from 8 to 20 deg, nm", "thesis", "here"]);
    average.row(["bare, in glass", "56.7", &spread(&bare_glass)]);
    average.row(["bare, in air", "", &spread(&bare_air)]);
    average.row(["diffused, in air", "18", &spread(&diffused_air)]);
    average.row(["diffused, unrefracted", "", &spread(&unrefracted)]);
    Ok(Section::new("table-5-2", "Table 5.2: SPD peak shift of a bare and a diffused panel at 20 and 8 deg")
        .table(bare)
        .table(diffused)
        .table(average)
        .say(
            "Peaks of single sub-pixels. The thesis's peaks of the bare panel can only be for angles in glass: in air, the peak \
             of any film at 20 deg is at least cos 20/cos 8 = 0.949 of that at 8 deg, and the thesis has 0.888 to 0.915. \
             The thesis's peaks of the diffused panel are closest to angles in air at 20 deg, and to a pixel at the angle in \
             air (unrefracted) at 8 deg. Averages omit peaks at the edge of 400 nm.",
        ))
}
