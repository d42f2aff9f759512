//! Spectra of linear sRGB colours from three primaries.
//!
//! # Model
//! `S = (r rho_r + g rho_g + b rho_b) W`: three reflectances that sum to 1, times the white light W of (1, 1,
//! 1). The conversion is linear: an RGB picture is the sum of three pictures, each with one spectrum. In D65
//! the colours are those of sRGB, to 0.001 in u'v'. With another white W, the result is the light from the
//! same reflectances under W.
//!
//! # Source
//! I. Mallett, C. Yuksel, *Spectral primary decomposition for rendering with sRGB reflectance*, Eurographics
//! Symposium on Rendering (2019): 380 to 780 nm at 5 nm, here rounded to five decimals.

use crate::{Grid, SpectraError, Spectrum, Tabulated};

/// rho of red and green; that of blue is 1 minus both.
#[rustfmt::skip]
const RED_AND_GREEN: [[f64; 2]; 81] = [
    [0.32746, 0.33186], [0.32375, 0.32969], [0.31344, 0.32786], [0.28888, 0.31917], [0.23921, 0.29432],
    [0.18970, 0.25870], [0.12175, 0.18889], [0.07458, 0.12539], [0.04443, 0.07869], [0.02893, 0.05314],
    [0.02232, 0.04229], [0.01691, 0.03332], [0.01418, 0.02976], [0.01305, 0.03033], [0.01199, 0.03099],
    [0.01129, 0.03169], [0.01091, 0.03467], [0.01040, 0.03455], [0.01064, 0.04068], [0.01091, 0.05446],
    [0.01103, 0.08091], [0.01131, 0.14635], [0.01115, 0.37968], [0.01015, 0.76674], [0.00892, 0.87621],
    [0.00769, 0.91849], [0.00671, 0.94066], [0.00600, 0.95373], [0.00554, 0.96164], [0.00519, 0.96720],
    [0.00503, 0.97099], [0.00514, 0.97285], [0.00543, 0.97312], [0.00582, 0.97335], [0.00640, 0.97335],
    [0.00745, 0.97226], [0.00858, 0.97335], [0.01040, 0.97315], [0.01357, 0.97106], [0.01938, 0.96637],
    [0.03208, 0.95494], [0.07436, 0.91358], [0.62439, 0.36435], [0.91831, 0.07151], [0.94925, 0.04123],
    [0.95819, 0.03242], [0.95819, 0.03192], [0.95819, 0.03128], [0.95568, 0.03263], [0.95801, 0.02953],
    [0.95410, 0.03156], [0.94761, 0.03567], [0.93868, 0.04140], [0.92447, 0.05060], [0.90461, 0.06343],
    [0.88041, 0.07892], [0.84779, 0.09954], [0.80578, 0.12560], [0.75253, 0.15759], [0.68644, 0.19540],
    [0.61869, 0.23147], [0.54026, 0.26885], [0.47296, 0.29603], [0.43270, 0.30975], [0.40536, 0.31782],
    [0.38549, 0.32299], [0.37098, 0.32635], [0.35761, 0.32914], [0.34871, 0.33081], [0.34488, 0.33148],
    [0.34192, 0.33198], [0.33953, 0.33234], [0.33717, 0.33291], [0.33617, 0.33292], [0.33517, 0.33303],
    [0.33442, 0.33318], [0.33401, 0.33325], [0.33392, 0.33326], [0.33382, 0.33328], [0.33367, 0.33329],
    [0.33357, 0.33331],
];

/// Returns the reflectances of red, green and blue on a grid; they sum to 1.
///
/// # Errors
/// If the grid extends beyond 380 to 780 nm.
///
/// ```
/// # use papilio_spectra::{Grid, srgb_primaries};
/// let [red, green, blue] = srgb_primaries(&Grid::new(400.0, 700.0, 5.0)?)?;
/// assert_eq!((red[42], green[42]), (0.95819, 0.03192));
/// assert!((red[7] + green[7] + blue[7] - 1.0).abs() < 1e-12);
/// # Ok::<(), papilio_spectra::SpectraError>(())
/// ```
pub fn srgb_primaries(grid: &Grid) -> Result<[Spectrum; 3], SpectraError> {
    let nm: Vec<f64> = (0..RED_AND_GREEN.len()).map(|k| 380.0 + 5.0 * k as f64).collect();
    let on = |column: usize| {
        Tabulated::new(nm.clone(), RED_AND_GREEN.iter().map(|row| row[column]).collect())?.on(grid)
    };
    let (red, green) = (on(0)?, on(1)?);
    let blue = red.zip_map(&green, |red, green| 1.0 - red - green);
    Ok([red, green, blue])
}
