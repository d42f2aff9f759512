//! Figures 5.3 and 5.4 and Table 5.1: colours of spectra.

use papilio_colour::{Observer, Xyz};
use papilio_display::result::{StateValues, View};
use papilio_figures::{Chart, ChartCurve, Hue, chart};
use papilio_spectra::Grid;

use crate::displays::{Bench, ReproductionError, first, of};
use crate::report::{Section, Table, number, off};
use crate::table_5_1::{Column, GAMUT_PERCENT, TABLE_5_1};

/// Figures 5.3 and 5.4.
pub(super) fn observer() -> Result<Section, ReproductionError> {
    let wrong = |error: &dyn std::fmt::Display| ReproductionError::Sample(error.to_string());
    let grid = Grid::new(380.0, 780.0, 1.0).map_err(|error| wrong(&error))?;
    let observer = Observer::new(&grid).map_err(|error| wrong(&error))?;
    let [x, y, z] = observer.weights();
    let nm: Vec<f64> = grid.wavelengths_nm();
    let curve = |name: &str, group: usize, values: &[f64]| ChartCurve {
        name: name.to_owned(),
        hue: Hue::Group(group),
        dashed: false,
        marks: false,
        points: nm.iter().copied().zip(values.iter().copied()).collect(),
    };
    let draw = |curves: Vec<ChartCurve>| {
        let figure = Chart {
            x: "Wavelength (nm)".to_owned(),
            y: "Relative sensitivity".to_owned(),
            logarithmic: false,
            at_least: vec![0.0],
            curves,
        };
        chart(&figure, "")
    };
    let integral: f64 = y.iter().sum();
    let mut table = Table::new(&["", "thesis", "here"]);
    table.row(["integral of the luminosity function (nm)", "1", &number(integral, 6)]);
    table.row([
        "illuminance of a radiance of 1 W/(m\u{b2} sr nm) from all directions (lx)",
        "2145.7141",
        &number(683.002 * std::f64::consts::PI * integral, 6),
    ]);
    Ok(Section::new("figure-5-3", "Figures 5.3 and 5.4: luminosity and colour matching functions")
        .figure(draw(vec![curve("V", 3, y)]), "The standard luminosity function, CIE 1931.")
        .figure(
            draw(vec![curve("x", 0, x), curve("y", 1, y), curve("z", 2, z)]),
            "The colour matching functions of the CIE 1931 2 degree observer.",
        )
        .table(table)
        .say(
            "Eq. 5-5 assumes that the integral of the luminosity function is 1; it is 106.857 nm (106.856 nm from 380 to \
             780 nm). The thesis's 2145.7 lx is 683.002 \u{3c0} and is correct in the thesis's normalisation. This does not \
             affect ratios, so that all its colours are correct.",
        ))
}

/// A row of Table 5.1.
struct Row {
    name: &'static str,
    printed: fn(&Column) -> f64,
    from_xyz: fn(Xyz) -> f64,
    ours: fn(&StateValues) -> Option<f64>,
    /// Formats the deviation of our number: relative, or absolute for quantities that may be 0.
    deviation: fn(f64, f64) -> String,
}

/// Formats the absolute difference.
fn absolute(theirs: f64, ours: f64) -> String {
    let difference = ours - theirs;
    let sign = if difference > 0.0 { "+" } else { "" };
    format!("{sign}{}", number(difference, 2))
}

const ROWS: [Row; 10] = [
    Row { name: "X", printed: |c| c.xyz.x, from_xyz: |c| c.x, ours: |v| Some(v.X), deviation: off },
    Row { name: "Y", printed: |c| c.xyz.y, from_xyz: |c| c.y, ours: |v| Some(v.Y), deviation: off },
    Row { name: "Z", printed: |c| c.xyz.z, from_xyz: |c| c.z, ours: |v| Some(v.Z), deviation: off },
    Row {
        name: "u\u{2032}",
        printed: |c| c.uv[0],
        from_xyz: |c| c.uv_prime().map_or(f64::NAN, |uv| uv.u),
        ours: |v| v.u_prime,
        deviation: absolute,
    },
    Row {
        name: "v\u{2032}",
        printed: |c| c.uv[1],
        from_xyz: |c| c.uv_prime().map_or(f64::NAN, |uv| uv.v),
        ours: |v| v.v_prime,
        deviation: absolute,
    },
    Row {
        name: "dR",
        printed: |c| c.distance_from_d65,
        from_xyz: |c| c.uv_prime().map_or(f64::NAN, |uv| uv.distance(papilio_colour::D65_UV)),
        ours: |v| v.distance_from_d65_uv,
        deviation: absolute,
    },
    Row {
        name: "CR",
        printed: |c| c.contrast,
        from_xyz: |c| c.y / TABLE_5_1[1].xyz.y,
        ours: |v| v.contrast,
        deviation: off,
    },
    Row {
        name: "L*",
        printed: |c| c.lab[0],
        from_xyz: |c| c.lab(papilio_colour::D65_WHITE).map_or(f64::NAN, |lab| lab.l),
        ours: |v| v.L_star,
        deviation: absolute,
    },
    Row {
        name: "a*",
        printed: |c| c.lab[1],
        from_xyz: |c| c.lab(papilio_colour::D65_WHITE).map_or(f64::NAN, |lab| lab.a),
        ours: |v| v.a_star,
        deviation: absolute,
    },
    Row {
        name: "b*",
        printed: |c| c.lab[2],
        from_xyz: |c| c.lab(papilio_colour::D65_WHITE).map_or(f64::NAN, |lab| lab.b),
        ours: |v| v.b_star,
        deviation: absolute,
    },
];

/// Table 5.1.
pub(super) fn table_5_1(bench: &Bench<'_>) -> Result<Section, ReproductionError> {
    let bare = bench.run("reference-pixel", &[])?;
    let diffused = bench.run("overcast", &["display.front=[]"])?;
    let single = bench.run(
        "overcast",
        &["display.front=[]", "solver.approximation=single-pass", "solver.angle_medium=unrefracted"],
    )?;
    let views: [&View; 3] = [first(&bare), first(&diffused), first(&single)];
    let mut table = Table::new(&[
        "",
        "state",
        "thesis",
        "from its X, Y, Z",
        "here: bare, glass angles",
        "difference",
        "here: diffused, exact",
        "here: diffused, as the thesis",
    ]);
    for row in &ROWS {
        for column in &TABLE_5_1 {
            let printed = (row.printed)(column);
            let ours = views.map(|view| of(view, column.name, row.ours));
            table.row([
                row.name.to_owned(),
                column.name.to_owned(),
                number(printed, 3),
                number((row.from_xyz)(column.xyz), 3),
                number(ours[0], 3),
                (row.deviation)(printed, ours[0]),
                number(ours[1], 3),
                number(ours[2], 3),
            ]);
        }
    }
    let gamuts = views.map(|view| view.metrics.gamut_percent_ebu.unwrap_or(f64::NAN));
    let triangle = TABLE_5_1.map(|column| column.xyz.uv_prime());
    let printed = match triangle {
        [_, _, Some(r), Some(g), Some(b)] => {
            papilio_colour::gamut_percent([r, g, b], papilio_colour::GamutReference::Ebu)
        }
        _ => f64::NAN,
    };
    table.row([
        "Gamut, % of EBU".to_owned(),
        String::new(),
        number(GAMUT_PERCENT, 3),
        number(printed, 3),
        number(gamuts[0], 3),
        off(GAMUT_PERCENT, gamuts[0]),
        number(gamuts[1], 3),
        number(gamuts[2], 3),
    ]);
    Ok(Section::new("table-5-1", "Table 5.1: colorimetric output")
        .table(table)
        .say(
            "The derived rows follow from the thesis's own X, Y, Z within their rounding. Our most similar display is the bare \
             reference pixel at 8 deg in glass, the condition to which it was fitted: X, Y, Z of white, red, green and blue \
             agree with the thesis's to 12.5 %; black is bluer.",
        )
        .say(
            "The diffused panels (haze 78, diffuse light, 8 deg, no front) mix the colours of many angles. Their gamut is \
             smaller than the thesis's 33.4 %: the display of the table has a narrower lobe than haze 78, or more \
             saturated pixels than ours. \u{201c}As the thesis\u{201d}: one pass through the panel (eq. 3-5), with the \
             reflectance of the pixel at the angle in air.",
        ))
}
