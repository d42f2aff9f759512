//! Weights of the CIE 1931 observer in D65, for formats with X, Y and Z instead of spectra.

use papilio_colour::{Between, Observer, Standard};
use papilio_spectra::{EveryNm, Grid, illuminant};

/// Returns the weights of X, Y and Z of a spectrum of reflectances in D65; those of Y sum to 1. They are sums over
/// every nanometre, between the wavelengths of reflectances that are linear there; with a step of less than 1 nm,
/// sums over the wavelengths.
pub(super) fn weights(wavelength_nm: &[f64]) -> Result<[Vec<f64>; 3], String> {
    let (Some(first), Some(last)) = (wavelength_nm.first(), wavelength_nm.last()) else {
        return Err("the BSDF has no wavelengths".to_owned());
    };
    let step = (last - first) / (wavelength_nm.len().max(2) - 1) as f64;
    let grid = Grid::new(*first, *last, step).map_err(|error| error.to_string())?;
    let own = grid.integers().unwrap_or(grid);
    let values = illuminant("D65", &own).map_err(|error| error.to_string())?;
    let observer = Observer::of(Standard::Cie1931, &own).map_err(|error| error.to_string())?;
    let products = observer.of_light(&EveryNm { grid: own, values }, &grid, Between::Linear);
    let white: f64 = products[1].iter().sum();
    Ok(products.map(|product| product.iter().map(|weight| weight / white).collect()))
}

/// Returns the weights of Y of a spectrum of reflectances in D65, whose sum is 1; the same weight for all
/// wavelengths that are not those of light.
pub(super) fn luminous_weights(wavelength_nm: &[f64]) -> Vec<f64> {
    let count = wavelength_nm.len();
    weights(wavelength_nm).map_or_else(|_| vec![1.0 / count.max(1) as f64; count], |[_, y, _]| y)
}
