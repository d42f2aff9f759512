//! Reference IMOD sub-pixels, bare, angles in glass: peak wavelengths.
//!
//! The stack is fitted to the bare peaks of Feng 2012, table 5.2; the values here are those of two
//! independent computations of the fitted stack (2 nm grid, mean of s and p, parabola through three samples,
//! 400 to 700 nm).

use papilio_optics::film::{GapFilm, SpectralLayer, Thickness};
use papilio_spectra::{Grid, material};

fn reference() -> (Grid, GapFilm) {
    let grid = Grid::new(380.0, 780.0, 2.0).unwrap();
    let on = |name: &str| material(name).and_then(|m| m.on(&grid)).unwrap();
    let fixed = |name, nm| SpectralLayer { index: on(name), thickness: Thickness::Fixed(nm) };
    let layers = [
        fixed("Si3N4", 55.9),
        fixed("Cr:Johnson", 12.15),
        fixed("SiO2", 38.6),
        fixed("AlOx", 9.0),
        SpectralLayer { index: on("air"), thickness: Thickness::Gap },
    ];
    let glass = vec![1.5; grid.len()];
    let film = GapFilm::new(&grid.wavelengths_nm(), &glass, &layers, &on("Al")).unwrap();
    (grid, film)
}

/// Wavelength of the largest sample from 400 to 700 nm, refined by a parabola unless it is at an edge.
fn peak_nm(grid: &Grid, reflectance: &[f64]) -> f64 {
    let inside = (0..grid.len()).filter(|&i| (400.0..=700.0).contains(&grid.wavelength_nm(i)));
    let i = inside.max_by(|&a, &b| reflectance[a].total_cmp(&reflectance[b])).unwrap();
    let (a, b, c) = (reflectance[i - 1], reflectance[i], reflectance[i + 1]);
    if a > b || c > b {
        return grid.wavelength_nm(i);
    }
    grid.wavelength_nm(i) + grid.step_nm() * 0.5 * (a - c) / (a - 2.0 * b + c)
}

#[test]
fn sub_pixels_peak_at_reference_wavelengths() {
    let (grid, film) = reference();
    let expected = [(8.0_f64, [686.3, 530.1, 432.5]), (20.0, [615.5, 476.8, 400.0])];
    let beta = expected.map(|(theta, _)| 1.5 * theta.to_radians().sin());
    let gaps_nm = [275.9, 192.3, 137.8];
    let mut out = vec![0.0; 2 * 3 * grid.len()];
    film.reflectance(&beta, &gaps_nm, &mut out).unwrap();
    let mut spectra = out.chunks_exact(grid.len());
    for (theta, peaks) in expected {
        for (gap, peak) in gaps_nm.into_iter().zip(peaks) {
            let found = peak_nm(&grid, spectra.next().unwrap());
            assert!((found - peak).abs() < 0.1, "gap {gap} nm at {theta} deg: {found}, not {peak}");
        }
    }
}
