//! Peak wavelength of a spectrum.

use papilio_spectra::Grid;

/// Relative variation below which a spectrum is regarded as flat.
const FLAT: f64 = 1e-9;

/// Wavelength interval in which peaks are searched, nm.
const SEARCHED_NM: (f64, f64) = (400.0, 700.0);

const LANES: usize = 8;

/// Wavelength of the largest value between 400 and 700 nm, nm, from the parabola
/// through the largest sample and its two neighbours.
///
/// Returns `None` if the largest sample is at an edge of that interval (or of the
/// grid), because the spectrum may continue to rise there, and for a flat spectrum, whose
/// differences are rounding errors. NaN is never the largest value.
pub fn peak_nm(grid: &Grid, values: &[f64]) -> Option<f64> {
    let (top, [left, centre, right]) = around_the_peak(grid, values)?;
    let curvature = left - 2.0 * centre + right;
    // The peak of a flat top (curvature 0) is its first sample.
    let shift = if curvature < 0.0 { 0.5 * (left - right) / curvature } else { 0.0 };
    Some(grid.wavelength_nm(top) + shift * grid.step_nm())
}

/// Derivatives of [`peak_nm`] with respect to the three values that it depends on, and the index of the
/// first.
pub fn peak_slopes(grid: &Grid, values: &[f64]) -> Option<(usize, [f64; 3])> {
    let (top, [left, centre, right]) = around_the_peak(grid, values)?;
    let curvature = left - 2.0 * centre + right;
    if curvature >= 0.0 {
        return None;
    }
    let (scale, lean) = (0.5 * grid.step_nm() / curvature, (left - right) / curvature);
    Some((top - 1, [scale * (1.0 - lean), scale * 2.0 * lean, -scale * (1.0 + lean)]))
}

/// Index of the largest value, with the values before, at and after it; `None` at an edge or for a flat
/// spectrum.
fn around_the_peak(grid: &Grid, values: &[f64]) -> Option<(usize, [f64; 3])> {
    let searched = |i: &usize| {
        let nm = grid.wavelength_nm(*i);
        nm >= SEARCHED_NM.0 - 1e-6 && nm <= SEARCHED_NM.1 + 1e-6
    };
    let mut bins = 0..grid.len().min(values.len());
    let (first, last) = (bins.clone().find(searched)?, bins.rfind(searched)?);
    let (lowest, largest) = extremes(&values[first..=last]);
    let top = first + values[first..=last].iter().position(|value| *value == largest)?;
    if top == first || top == last || largest - lowest <= FLAT * largest.abs() {
        return None;
    }
    Some((top, [values[top - 1], values[top], values[top + 1]]))
}

/// Smallest and largest value, ignoring NaN. Independent lanes keep comparisons from waiting for each other.
fn extremes(values: &[f64]) -> (f64, f64) {
    let (mut least, mut most) = ([f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]);
    for chunk in values.chunks(LANES) {
        for ((least, most), value) in least.iter_mut().zip(&mut most).zip(chunk) {
            *least = if value < least { *value } else { *least };
            *most = if value > most { *value } else { *most };
        }
    }
    (least.into_iter().fold(f64::INFINITY, f64::min), most.into_iter().fold(f64::NEG_INFINITY, f64::max))
}

#[cfg(test)]
mod tests {
    use super::*;
    use papilio_spectra::Spectrum;

    fn grid() -> Grid {
        Grid::new(380.0, 780.0, 5.0).unwrap()
    }

    #[test]
    fn peak_of_a_parabola_is_exact() {
        for peak in [406.0, 517.3, 523.0, 694.0] {
            let values = Spectrum::from_fn(&grid(), |nm| 1.0 - ((nm - peak) / 300.0).powi(2));
            assert!((peak_nm(&grid(), &values).unwrap() - peak).abs() < 1e-9);
        }
    }

    #[test]
    fn peak_at_an_edge_or_of_a_flat_spectrum_is_undefined() {
        for peak in [390.0, 400.0, 702.0, 760.0] {
            let values = Spectrum::from_fn(&grid(), |nm| -(nm - peak).powi(2));
            assert_eq!(peak_nm(&grid(), &values), None, "{peak}");
        }
        assert_eq!(peak_nm(&grid(), &Spectrum::constant(&grid(), 0.5)), None);
        let rounding = Spectrum::from_fn(&grid(), |nm| if nm == 550.0 { 0.5 + 1e-15 } else { 0.5 });
        assert_eq!(peak_nm(&grid(), &rounding), None);
        let infrared = Grid::new(800.0, 900.0, 5.0).unwrap();
        assert_eq!(peak_nm(&infrared, &Spectrum::constant(&infrared, 0.5)), None);
    }

    #[test]
    fn nan_values_are_ignored() {
        assert_eq!(peak_nm(&grid(), &Spectrum::constant(&grid(), f64::NAN)), None);
        let mut values = Spectrum::from_fn(&grid(), |nm| -(nm - 550.0).abs()).to_vec();
        values[4] = f64::NAN;
        assert!((peak_nm(&grid(), &values).unwrap() - 550.0).abs() < 1e-9);
    }
}
