//! Figures 5.14 to 5.19: lights, front reflection, haze, front light.

use papilio_display::result::{RunResult, View};
use papilio_figures::{Chart, ChartCurve, Hue, chart, gamuts};
use papilio_optics::Beta;

use crate::chapter_3::{in_plane, measurement, shape};
use crate::displays::{Bench, ReproductionError, first, of};
use crate::report::{Section, Table, number};

/// The three lighting conditions.
const CONDITIONS: [&str; 3] = ["indoor", "sunny", "overcast"];

/// Axis title of a metric, and the function that returns it.
type Metric = (&'static str, fn(&View) -> f64);

const METRICS: [Metric; 3] = [
    ("Contrast ratio", |view| view.metrics.contrast_ratio.unwrap_or(f64::NAN)),
    ("Gamut (% of sRGB)", |view| view.metrics.gamut_percent_srgb.unwrap_or(f64::NAN)),
    ("White: luminance factor", |view| of(view, "white", |v| Some(v.Y))),
];

/// Figure 5.14.
pub(super) fn distributions() -> Section {
    Section::new("figure-5-14", "Figure 5.14: mean directional luminance of 42 outdoor and 70 indoor locations").say(
        "The data were measured by Kubota et al. 2006 and are not public, so that nothing is computed here. The thesis derives \
         three lighting conditions from them, which are presets: indoor (50 % diffuse, 50 % from -20 deg, viewed at 8 deg), \
         sunny (20 % diffuse, 80 % from -35 deg, viewed at 20 deg), overcast (diffuse, viewed at 8 deg).",
    )
}

/// Figure 5.15.
pub(super) fn front_reflection(bench: &Bench<'_>) -> Result<Section, ReproductionError> {
    const PERCENT: [f64; 7] = [0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0];
    let mut all = Vec::new();
    for condition in CONDITIONS {
        let runs = PERCENT.map(|percent| {
            let front = format!("display.front=[{{ reflectance = {}, absorptance = 0.0 }}]", percent / 100.0);
            bench.run(condition, &[front.as_str()])
        });
        all.push((condition, runs.into_iter().collect::<Result<Vec<RunResult>, _>>()?));
    }
    let mut section =
        Section::new("figure-5-15", "Figure 5.15: front surface reflection in different lighting conditions");
    for (name, metric) in METRICS {
        let curve = |(k, (condition, runs)): (usize, &(&str, Vec<RunResult>))| ChartCurve {
            name: (*condition).to_owned(),
            hue: Hue::Group(k),
            dashed: false,
            marks: false,
            points: PERCENT.iter().zip(runs).map(|(percent, run)| (*percent, metric(first(run)))).collect(),
        };
        let figure = Chart {
            x: "Front reflectance (%)".to_owned(),
            y: name.to_owned(),
            logarithmic: false,
            at_least: vec![0.0],
            curves: all.iter().enumerate().map(curve).collect(),
        };
        section = section.figure(chart(&figure, ""), "");
    }
    let mut table =
        Table::new(&["value at 2 % front reflectance over value at 0 %", "contrast ratio", "gamut", "white"]);
    for (condition, runs) in &all {
        let ratios = METRICS.map(|(_, metric)| metric(first(&runs[4])) / metric(first(&runs[0])));
        table.row(std::iter::once((*condition).to_owned()).chain(ratios.map(|ratio| number(ratio, 3))));
    }
    Ok(section.table(table).say(
        "The thesis finds that low front reflection gives higher contrast and a larger gamut in all conditions, and that the \
         effect is largest in diffuse light. This also holds here. White becomes brighter with front reflection only in \
         diffuse light; the front only attenuates a directed source whose mirror image is outside the view. Haze 78, one \
         front component without absorption.",
    ))
}

/// Figure 5.16.
pub(super) fn lobes(bench: &Bench<'_>) -> Result<Section, ReproductionError> {
    let mut curves = Vec::new();
    let mut table = Table::new(&["", "peak (1/sr)", "half width at half maximum (deg)"]);
    for (group, name) in ["H78", "H65"].into_iter().enumerate() {
        let shape = shape(&measurement(bench, &format!("data/{name}.bsdf"))?)?;
        let within = in_plane(&shape, 0, 0.0).into_iter().filter(|(deg, _)| deg.abs() <= 50.0);
        curves.push(ChartCurve {
            name: name.to_owned(),
            hue: Hue::Group(group),
            dashed: false,
            marks: false,
            points: within.collect(),
        });
        let peak = shape.value(0, Beta { x: 0.0, y: 0.0 });
        let half = shape.half_width_deg(0, 0.0).unwrap_or(f64::NAN);
        table.row([name.to_owned(), number(peak, 3), number(half, 3)]);
    }
    let figure = Chart {
        x: "Scattering angle (deg)".to_owned(),
        y: "BTDF (1/sr)".to_owned(),
        logarithmic: true,
        at_least: vec![],
        curves,
    };
    Ok(Section::new("figure-5-16", "Figure 5.16: scattering profile of haze 78 and haze 65 diffusers at normal angle")
        .figure(chart(&figure, ""), "Synthetic measurements on the thesis's grid, with the blur of the instrument of figure 3.8.")
        .table(table)
        .say(
            "The thesis's axis extends from 1 to 100 1/sr, and its text gives no numbers. Without the blur, the peaks would be \
             47 and 100 1/sr (haze 78 and 65, total transmittance 0.90).",
        ))
}

/// Figure 5.17.
pub(super) fn haze(bench: &Bench<'_>) -> Result<Section, ReproductionError> {
    let h65 = bench.run("measured-h65", &[])?;
    let h78 = bench.run("measured-h78", &[])?;
    let diffusers = [("H65", &h65), ("H78", &h78)];
    let mut section =
        Section::new("figure-5-17", "Figure 5.17: diffusers with different haze values in indoor lighting");
    for (name, metric) in METRICS {
        let curve = |(k, (name, run)): (usize, &(&str, &RunResult))| ChartCurve {
            name: (*name).to_owned(),
            hue: Hue::Group(k),
            dashed: false,
            marks: false,
            points: run.views.iter().map(|view| (view.theta_deg, metric(view))).collect(),
        };
        let figure = Chart {
            x: "Viewing angle (deg)".to_owned(),
            y: name.to_owned(),
            logarithmic: false,
            at_least: vec![0.0],
            curves: diffusers.iter().enumerate().map(curve).collect(),
        };
        section = section.figure(chart(&figure, ""), "");
    }
    let at = |run: &RunResult, deg: f64, metric: fn(&View) -> f64| {
        run.views.iter().find(|view| view.theta_deg == deg).map_or(f64::NAN, metric)
    };
    let brightest = |run: &RunResult| {
        let white = |view: &&View| of(view, "white", |v| Some(v.Y));
        run.views.iter().max_by(|a, b| white(a).total_cmp(&white(b))).map_or(f64::NAN, |view| view.theta_deg)
    };
    let mut claims = Table::new(&["the thesis finds", "H65 here", "H78 here"]);
    claims.row([
        "white peaks at the specular angle of 20 deg".to_owned(),
        format!("{} deg", brightest(&h65)),
        format!("{} deg", brightest(&h78)),
    ]);
    for (words, deg, metric) in [
        ("the peak of white is much higher with H65", 20.0, METRICS[2].1),
        ("H65 has higher contrast at typical angles (10 deg)", 10.0, METRICS[0].1),
        ("H65 has a larger gamut at typical angles (10 deg)", 10.0, METRICS[1].1),
        ("from 50 deg, H78 is better: white", 50.0, METRICS[2].1),
        ("from 50 deg, H78 is better: contrast", 50.0, METRICS[0].1),
        ("from 50 deg, H78 is better: gamut", 50.0, METRICS[1].1),
    ] {
        let [a, b] = [&h65, &h78].map(|run| number(at(run, deg, metric), 3));
        claims.row([words.to_owned(), a, b]);
    }
    Ok(section.table(claims).say(
        "All findings of the thesis hold here, although the samples are synthetic: the narrower lobe concentrates the light \
         of the source at its mirror angle, and the wider lobe scatters more light to 50 deg. The thesis prints no numbers.",
    ))
}

/// Figures 5.18 and 5.19.
pub(super) fn front_light(bench: &Bench<'_>) -> Result<Section, ReproductionError> {
    const RGB_LED: &str = "[{ led_nm = 630, width_nm = 20 }, { led_nm = 525, width_nm = 35, weight = 0.5636 }, \
                           { led_nm = 460, width_nm = 25, weight = 0.5506 }]";
    const WHITE_LED: &str = "\"LED-B5\"";
    let run = |room_lx: f64, spectrum: Option<&str>| {
        let room = format!("lighting.illuminance_lx={room_lx}");
        let guide = spectrum.map(|spectrum| {
            format!("lighting.front_light={{ illuminance_lx = 500, spectrum = {spectrum} }}")
        });
        let set: Vec<&str> = std::iter::once(room.as_str()).chain(guide.as_deref()).collect();
        bench.run("overcast", &set)
    };
    let (dark_lx, dim_lx) = (0.0, 100.0);
    let all = [
        ("room only", run(dim_lx, None)?),
        ("white LED only", run(dark_lx, Some(WHITE_LED))?),
        ("RGB LED only", run(dark_lx, Some(RGB_LED))?),
        ("white LED and room", run(dim_lx, Some(WHITE_LED))?),
        ("RGB LED and room", run(dim_lx, Some(RGB_LED))?),
    ];
    let mut table = Table::new(&[
        "light",
        "gamut, % of sRGB",
        "u\u{2032} of red",
        "v\u{2032} of red",
        "contrast ratio",
        "white, cd/m\u{b2}",
    ]);
    for (name, result) in &all {
        let view = first(result);
        let cells = [
            view.metrics.gamut_percent_srgb.unwrap_or(f64::NAN),
            of(view, "red", |v| v.u_prime),
            of(view, "red", |v| v.v_prime),
            view.metrics.contrast_ratio.unwrap_or(f64::NAN),
            of(view, "white", |v| Some(v.luminance_cd_m2)),
        ];
        table.row(std::iter::once((*name).to_owned()).chain(cells.map(|value| number(value, 3))));
    }
    let shown: Vec<(&str, &View)> = all[..3].iter().map(|(name, result)| (*name, first(result))).collect();
    Ok(Section::new("figure-5-19", "Figures 5.18 and 5.19: auxiliary lighting of different SPDs")
        .figure(
            gamuts(&shown, "Haze 78, at 8 deg"),
            "A front light below the front of screen (0.5 % reflectance, 1 % absorptance), which its light passes once, \
             with 500 lx on the diffuser. The room light is 100 lx of diffuse D65.",
        )
        .table(table)
        .say(
            "The thesis finds that an RGB LED front light gives a larger gamut than a white LED, and a much more saturated red. \
             This also holds here, and in a mixture with the room light (LED models: three of Ohno 2005 at 630, 525 and \
             460 nm, balanced to D65; CIE LED-B5). The front reflection of the room light lowers gamut and contrast; a front \
             light has no front reflection.",
        ))
}
