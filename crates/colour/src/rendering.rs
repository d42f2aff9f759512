//! Correlated colour temperature and general colour rendering index of a light.
//!
//! **What.** The correlated colour temperature is that of the black body nearest in the CIE 1960 (u, v)
//! diagram (CIE 15:2018; defined up to a distance of 0.05). The general colour rendering index Ra compares
//! eight test colours under the light with those under a black body (below 5000 K) or daylight of the same
//! temperature (CIE 13.3-1995): 100 if all are the same.
//!
//! **Range.** 1000 to 100 000 K; from 4000 to 25 000 K where daylight is the reference.
//!
//! **Source.** CIE 13.3-1995; reflectances of the test colours at 5 nm by colour-science
//! (`spectra/data/README.md`).

use std::sync::LazyLock;

use papilio_spectra::{Grid, Spectrum, Tabulated, daylight, planck};

use crate::{Observer, Xyz};

/// Largest distance from the locus of black bodies at which a correlated colour temperature is defined.
const FARTHEST_UV: f64 = 0.05;
/// Range of temperatures, K.
const TEMPERATURES_K: (f64, f64) = (1000.0, 100_000.0);
/// Temperature from which on daylight is the reference, K.
const DAYLIGHT_FROM_K: f64 = 5000.0;

/// Correlated colour temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColourTemperature {
    /// Temperature of the nearest black body, K.
    pub cct_k: f64,
    /// Distance from it in CIE 1960 (u, v), positive above the locus (greenish).
    pub duv: f64,
}

/// Returns the correlated colour temperature of a light at 1 nm on `grid`; `None` farther than 0.05 from all
/// black bodies.
pub fn colour_temperature(light: &Spectrum, grid: &Grid) -> Option<ColourTemperature> {
    let observer = Observer::new(grid).ok()?;
    let uv = uv_1960(observer.xyz(light))?;
    let away = |mired: f64| {
        let body = planck(1e6 / mired, grid).ok()?;
        let [u, v] = uv_1960(observer.xyz(&body))?;
        Some([uv[0] - u, uv[1] - v])
    };
    let distance = |mired: f64| away(mired).map_or(f64::INFINITY, |[u, v]| u.hypot(v));
    let (mut low, mut high) = (1e6 / TEMPERATURES_K.1, 1e6 / TEMPERATURES_K.0);
    // The distance has one minimum over reciprocal temperature near the locus; thirds to 1e-9 of the range.
    while high - low > 1e-6 {
        let (left, right) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if distance(left) < distance(right) { high = right } else { low = left }
    }
    let mired = 0.5 * (low + high);
    let [_, above] = away(mired)?;
    let nearest = distance(mired);
    (nearest < FARTHEST_UV).then_some(ColourTemperature { cct_k: 1e6 / mired, duv: nearest.copysign(above) })
}

/// Returns the general colour rendering index Ra of a light at 1 nm on `grid`; `None` without a correlated
/// colour temperature.
pub fn rendering_index(light: &Spectrum, grid: &Grid) -> Option<f64> {
    let ColourTemperature { cct_k, .. } = colour_temperature(light, grid)?;
    let reference = if cct_k < DAYLIGHT_FROM_K { planck(cct_k, grid) } else { daylight(cct_k, grid) }.ok()?;
    let observer = Observer::new(grid).ok()?;
    let seen = |light: &Spectrum| -> Option<(Xyz, Vec<Xyz>)> {
        let white = observer.xyz(light);
        let scale = 100.0 / white.y;
        let colour = |reflectance: &Tabulated| {
            let reflected = reflectance.on(grid).ok()?.zip_map(light, |r, l| r * l);
            Some(observer.xyz(&reflected) * scale)
        };
        Some((white * scale, TEST_COLOURS.iter().map(colour).collect::<Option<_>>()?))
    };
    let ((white, colours), (white_r, colours_r)) = (seen(light)?, seen(&reference)?);
    let (uv, uv_r) = (uv_1960(white)?, uv_1960(white_r)?);
    let index = |(colour, colour_r): (&Xyz, &Xyz)| {
        let adapted = adapted(uv_1960(*colour)?, uv, uv_r);
        let ours = uniform(adapted, colour.y, uv_r);
        let theirs = uniform(uv_1960(*colour_r)?, colour_r.y, uv_r);
        let squares: f64 = ours.iter().zip(theirs).map(|(a, b)| (a - b).powi(2)).sum();
        Some(100.0 - 4.6 * squares.sqrt())
    };
    let indices: Option<Vec<f64>> = colours.iter().zip(&colours_r).map(index).collect();
    indices.map(|all| all.iter().sum::<f64>() / all.len() as f64)
}

/// CIE 1960 u, v; `None` without light.
fn uv_1960(xyz: Xyz) -> Option<[f64; 2]> {
    let uv = xyz.uv_prime()?;
    Some([uv.u, 2.0 / 3.0 * uv.v])
}

/// Adapts u, v of a colour from a white to that of the reference (von Kries, CIE 13.3).
fn adapted(uv: [f64; 2], white: [f64; 2], reference: [f64; 2]) -> [f64; 2] {
    let c = |[u, v]: [f64; 2]| (4.0 - u - 10.0 * v) / v;
    let d = |[u, v]: [f64; 2]| (1.708 * v + 0.404 - 1.481 * u) / v;
    let (c, d) = (c(reference) / c(white) * c(uv), d(reference) / d(white) * d(uv));
    let below = 16.518 + 1.481 * c - d;
    [(10.872 + 0.404 * c - 4.0 * d) / below, 5.520 / below]
}

/// CIE 1964 W*, U*, V* of a colour.
fn uniform([u, v]: [f64; 2], y: f64, [u_white, v_white]: [f64; 2]) -> [f64; 3] {
    let w = 25.0 * y.cbrt() - 17.0;
    [w, 13.0 * w * (u - u_white), 13.0 * w * (v - v_white)]
}

/// Reflectances of the test colours 1 to 8, 380 to 780 nm.
static TEST_COLOURS: LazyLock<Vec<Tabulated>> = LazyLock::new(|| {
    let rows: Vec<Vec<f64>> = include_str!("../data/test-colours.csv")
        .lines()
        .skip(1)
        .map(|row| row.split(',').filter_map(|cell| cell.parse().ok()).collect())
        .collect();
    let column = |k: usize| {
        let (nm, value) = rows.iter().filter_map(|row| Some((*row.first()?, *row.get(k)?))).unzip();
        Tabulated::new(nm, value).ok()
    };
    (1..=8).filter_map(column).collect()
});

#[cfg(test)]
mod tests {
    use papilio_spectra::illuminant;

    use super::*;

    fn every_nm() -> Grid {
        Grid::new(380.0, 780.0, 1.0).unwrap()
    }

    #[test]
    fn black_bodies_have_their_temperature_and_render_perfectly() {
        let grid = every_nm();
        for kelvin in [2000.0, 2856.0, 4000.0, 20_000.0] {
            let light = planck(kelvin, &grid).unwrap();
            let found = colour_temperature(&light, &grid).unwrap();
            assert!(
                (found.cct_k / kelvin - 1.0).abs() < 1e-5 && found.duv.abs() < 1e-8,
                "{kelvin}: {found:?}"
            );
            if kelvin < 5000.0 {
                assert!((rendering_index(&light, &grid).unwrap() - 100.0).abs() < 1e-3);
            }
        }
    }

    /// CIE 15:2004, table T.7: correlated colour temperature and Ra of fluorescent lamps, rounded to
    /// integers.
    #[test]
    fn fluorescent_lamps_have_their_published_values() {
        let grid = every_nm();
        assert_eq!(TEST_COLOURS.len(), 8);
        for (name, cct_k, ra) in [
            ("FL1", 6430.0, 76.0),
            ("FL2", 4230.0, 64.0),
            ("FL4", 2940.0, 51.0),
            ("FL7", 6500.0, 90.0),
            ("FL8", 5000.0, 95.0),
            ("FL11", 4000.0, 83.0),
            ("FL12", 3000.0, 83.0),
        ] {
            let light = illuminant(name, &grid).unwrap();
            let (t, index) =
                (colour_temperature(&light, &grid).unwrap(), rendering_index(&light, &grid).unwrap());
            assert!((t.cct_k - cct_k).abs() < 11.0, "{name}: {t:?}");
            assert!((index - ra).abs() < 1.0, "{name}: {index}");
        }
    }

    #[test]
    fn saturated_light_has_no_temperature() {
        let grid = every_nm();
        let red = Spectrum::from_fn(&grid, |nm| if nm > 640.0 { 1.0 } else { 0.0 });
        let dark = Spectrum::constant(&grid, 0.0);
        for light in [red, dark] {
            assert_eq!((colour_temperature(&light, &grid), rendering_index(&light, &grid)), (None, None));
        }
    }
}
