//! Table 5.3: daylight readability.

use papilio_display::readability::{AGES_YEARS, CONTRAST_RANGE, LUMINANCE_RANGE_CD_M2, Text};
use papilio_display::result::View;
use papilio_figures::{SweepAxis, SweepFigure, sweep_map};

use crate::displays::{Bench, ReproductionError, first, of};
use crate::report::{Section, Table, number, off};
use crate::table_5_3::TABLE_5_3;

/// The two set-ups: illuminances of sky and sun, lx (that of the sun perpendicular to its beam), and
/// inclinations of the sun and the eye, degrees.
const SET_UPS: [(&str, f64, f64, f64, f64); 2] =
    [("45/0", 1e4, 1e5, -45.0, 0.0), ("35/20", 1e3, 1e4, -35.0, 20.0)];

/// Separator of numbers, without a line break.
const SEPARATOR: &str = ",\u{a0}";

/// Range of the colours of all maps.
const PERFORMANCE: [f64; 2] = [0.2, 1.0];

/// Table 5.3.
pub(super) fn table_5_3(bench: &Bench<'_>) -> Result<Section, ReproductionError> {
    let mut derived = Table::new(&[
        "",
        "D, thesis",
        "here",
        "L_ave, thesis",
        "here",
        "C, thesis",
        "here",
        "P at 20, 50, 75 years, %, thesis",
        "surrogate",
    ]);
    for column in &TABLE_5_3 {
        let text = text(column.white_cd_m2, column.black_cd_m2);
        let printed = column.performance_percent.map(|percent| format!("{percent:.0}"));
        derived.row([
            column.name.to_owned(),
            column.contrast_ratio.to_string(),
            number(column.white_cd_m2 / column.black_cd_m2, 4),
            column.text_luminance_cd_m2.to_string(),
            number(text.luminance_cd_m2, 6),
            column.text_contrast.to_string(),
            number(text.contrast, 3),
            printed.join(SEPARATOR),
            performances(text),
        ]);
    }
    let mut panels = Table::new(&[
        "set-up",
        "panel",
        "Kw, cd/m\u{b2}",
        "difference",
        "Kk, cd/m\u{b2}",
        "difference",
        "Kw / Kk",
        "C",
        "P, %",
    ]);
    for ((set_up, sky, sun, sun_deg, eye_deg), printed) in SET_UPS.into_iter().zip(&TABLE_5_3[2..]) {
        let light = [
            format!("lighting.illuminance_lx={}", sky + sun),
            format!("lighting.diffuse={}", sky / (sky + sun)),
            format!(
                "lighting.directed=[{{ theta_deg = {sun_deg}, share = {}, normal_to_beam = true, radius_deg = 0.27 }}]",
                sun / (sky + sun)
            ),
            format!("viewer.theta_deg={eye_deg}"),
        ];
        panels.row([
            set_up,
            "thesis",
            &number(printed.white_cd_m2, 4),
            "",
            &number(printed.black_cd_m2, 3),
            "",
            &number(printed.white_cd_m2 / printed.black_cd_m2, 3),
            &number(printed.text_contrast, 2),
            "",
        ]);
        for (panel, changes) in [
            ("haze 65", &["display.diffuser.haze=0.65"] as &[&str]),
            ("haze 78", &[]),
            (
                "haze 78, front 0.5 % and 1 %",
                &["display.front=[{ reflectance = 0.005, absorptance = 0.01 }]"],
            ),
            (
                "lobe as measured (b = 0.105)",
                &["display.diffuser={ model = \"k-correlation\", width = 0.105, transmittance = 0.954 }"],
            ),
            ("haze 78, single pass", &["solver.approximation=single-pass"]),
        ] {
            let set: Vec<&str> = std::iter::once("display.front=[]")
                .chain(light.iter().map(String::as_str))
                .chain(changes.iter().copied())
                .collect();
            let result = bench.run("overcast", &set)?;
            let view: &View = first(&result);
            let [white, black] = ["white", "black"].map(|state| of(view, state, |v| Some(v.luminance_cd_m2)));
            panels.row([
                set_up.to_owned(),
                panel.to_owned(),
                number(white, 4),
                off(printed.white_cd_m2, white),
                number(black, 3),
                off(printed.black_cd_m2, black),
                number(white / black, 3),
                number(text(white, black).contrast, 3),
                performances(text(white, black)),
            ]);
        }
    }
    let mut section =
        Section::new("table-5-3", "Table 5.3 and figure 5.20: readability results of various displays")
        .table(derived)
        .say(
            "D is the ratio of Kw and Kk; the thesis prints 10.08 where its luminances give 10.73. L_ave = 0.75 Kw + 0.25 Kk \
             (eq. 5-13), C = (Kw - Kk)/(Kw + Kk/3) (eq. 5-14). P is the reading performance, which the thesis read by eye \
             from charts of CIE 145:2002 (its table has 70 years where its chart has 75). Ours is a surrogate that was \
             calibrated with this table, not the model of the CIE, so that the agreement is no verification.",
        )
        .table(panels)
        .say(
            "Luminances of our panels in the thesis's light: a sky of uniform radiance, and a sun whose illuminance is given \
             perpendicular to its beam. The thesis does not give the lobe, the front or the white of its panel. In both \
             set-ups, its panel reflects more sunlight to the eye than lobes of these hazes, and its black is lighter; these \
             differences are reported, not fitted. Above C = 0.9, the surrogate is undefined.",
        );
    for age in AGES_YEARS {
        section = section.figure(
            chart_5_20(age),
            format!("Figure 5.20 by the calibrated surrogate, {age} years: reading performance over luminance and contrast of the text."),
        );
    }
    let (map, contrast) = illuminance_and_age(bench)?;
    Ok(section
        .figure(
            map,
            format!(
                "Reading performance of our panel over illuminance and age: haze 78 behind a cover with a reflectance of 4 %, in \
                 diffuse light, in which its text has a contrast of {} at any illuminance. Empty where the luminance of the \
                 text is outside the range for which the surrogate is calibrated (1000 to 5200 cd/m\u{b2}).",
                number(contrast, 3)
            ),
        )
        .say(
            "The thesis's charts do not have the illuminance; the luminance is to be taken from table 5.3. Between 20, 50 and \
             75 years, the coefficients of the surrogate are interpolated linearly.",
        ))
}

/// Returns black text on white; its quantities are NaN without light.
fn text(white_cd_m2: f64, black_cd_m2: f64) -> Text {
    Text::new(white_cd_m2, black_cd_m2).unwrap_or(Text { luminance_cd_m2: f64::NAN, contrast: f64::NAN })
}

/// Formats the reading performance at the three ages, %.
fn performances(text: Text) -> String {
    let percent = |age| text.reading_surrogate(age).map(|p| format!("{:.0}", 100.0 * p));
    let all: Option<Vec<String>> = AGES_YEARS.into_iter().map(percent).collect();
    all.map_or("out of range".to_owned(), |all| all.join(SEPARATOR))
}

/// Draws the surrogate over its range.
fn chart_5_20(age_years: f64) -> String {
    let between = |[from, to]: [f64; 2], count: u32| -> Vec<f64> {
        (0..count).map(|k| from + (to - from) * (f64::from(k) + 0.5) / f64::from(count)).collect()
    };
    let x = ("Mean luminance of text (cd/m\u{b2})", between(LUMINANCE_RANGE_CD_M2, 42));
    let y = ("Contrast of text", between(CONTRAST_RANGE, 33));
    let value =
        |luminance_cd_m2: f64, contrast: f64| Text { luminance_cd_m2, contrast }.reading_surrogate(age_years);
    map(x, y, value, &format!("{age_years} years"))
}

/// Draws the reading performance of a panel with a bare cover in diffuse light over illuminance and age, and
/// returns the contrast of its text. The panel has no front light, so that its luminances are proportional to
/// the illuminance.
fn illuminance_and_age(bench: &Bench<'_>) -> Result<(String, f64), ReproductionError> {
    const AT_LX: f64 = 1e4;
    // Ten steps per decade, rounded (ISO 3, R 10).
    const LIT_LX: [f64; 11] = [1e4, 1.25e4, 1.6e4, 2e4, 2.5e4, 3.15e4, 4e4, 5e4, 6.3e4, 8e4, 1e5];
    let cover = "display.front=[{ reflectance = 0.04, absorptance = 0.01 }]";
    let result = bench.run("overcast", &[cover, &format!("lighting.illuminance_lx={AT_LX}")])?;
    let [white, black] =
        ["white", "black"].map(|state| of(first(&result), state, |v| Some(v.luminance_cd_m2)));
    let lit = text(white, black);
    let illuminances = LIT_LX.to_vec();
    let ages = (0..=22).map(|k| 20.0 + 2.5 * f64::from(k)).collect();
    let value = |lux: f64, age_years: f64| {
        Text { luminance_cd_m2: lit.luminance_cd_m2 * lux / AT_LX, ..lit }.reading_surrogate(age_years)
    };
    let svg = map(
        ("Illuminance (lx)", illuminances),
        ("Age (years)", ages),
        value,
        "Haze 78, cover with 4 % reflectance, diffuse light",
    );
    Ok((svg, lit.contrast))
}

/// Draws the reading performance over two quantities.
fn map(
    (x_name, x): (&str, Vec<f64>),
    (y_name, y): (&str, Vec<f64>),
    value: impl Fn(f64, f64) -> Option<f64>,
    title: &str,
) -> String {
    let axis = |name: &str, values: &[f64]| SweepAxis {
        name: name.to_owned(),
        values: values.iter().map(f64::to_string).collect(),
    };
    let points = y.iter().flat_map(|y| x.iter().map(move |x| (*x, *y)));
    let figure = SweepFigure {
        metric: "Reading performance".to_owned(),
        x: axis(x_name, &x),
        y: Some(axis(y_name, &y)),
        colours: Some(PERFORMANCE),
        values: points.map(|(x, y)| (value(x, y).unwrap_or(f64::NAN), 0.0)).collect(),
    };
    sweep_map(&figure, title).unwrap_or_default()
}
