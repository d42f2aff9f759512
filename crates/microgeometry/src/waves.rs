//! Waves at a surface: the light along the normal that passes straight through, and haze, by wavelength.
//!
//! **Model.** A thin phase screen: heights h delay light by 2π (n₂ - n₁) h/λ in transmission, and by 4π n₁ h/λ in reflection. The far field is the
//! Fourier transform of exp(i phase); its power at the frequency f (cycles per um) goes to beta = λ f, as from a grating. One pass, no shadows:
//! slopes below about 0.3.
//!
//! **Closed forms.** For Gaussian heights with the rms phase g^(1/2), the straight part is exp(-g). Where the correlation of the heights is
//! exp(-r²/τ²), the rest is the sum of exp(-g) g^m/m! times Gaussians `exp(-(π τ f)²/m)` of f; where it is exp(-r/τ), of lobes `m b₁/(2π (m² b₁² +
//! beta²)^(3/2))` with b₁ = λ/(2π τ) (P. Beckmann, A. Spizzichino 1963; J. E. Harvey et al., Opt. Eng. 51, 013402 (2012)).
//!
//! Rays know none of this: they hold where g is above [`LEAST_G`], thin screens where slopes are below [`MOST_SLOPE`].

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_fourier::Plane;

use crate::goniometer::{Measured, haze_beta};
use crate::{HeightMap, MicrogeometryError, Spectrum, Surface};

/// Largest number of heights of which screens are made.
const MOST_HEIGHTS: usize = 1 << 22;

/// Realisations of a random surface.
const SCREENS: u64 = 8;

/// What a surface does to waves along the normal, at a wavelength.
#[derive(Debug, Clone, PartialEq)]
pub struct WaveShares {
    /// Wavelength in air, nm.
    pub wavelength_nm: f64,
    /// Square of the rms phase of transmitted light, g. Rays describe the surface where it is large, above about 10.
    pub g: f64,
    /// Fraction of the transmitted light that passes straight through.
    pub straight: Measured,
    /// Fraction of the reflected light that is reflected as by a mirror.
    pub mirror: Measured,
    /// Haze in air: of the transmitted light with |beta| up to 1, the fraction beyond sin 2.5 deg.
    pub haze: Measured,
    /// The same in closed form, for random faces with Gaussian or exponential correlation.
    pub haze_closed_form: Option<f64>,
}

/// A surface measured by waves.
#[derive(Debug, Clone, PartialEq)]
pub struct ByWaves {
    /// Root mean square slope along x or y, the larger one. Thin screens hold up to about [`MOST_SLOPE`].
    pub slope_rms: f64,
    /// Root mean square height, um.
    pub rms_um: f64,
    /// By wavelength.
    pub shares: Vec<WaveShares>,
}

/// Largest rms slope of surfaces that thin phase screens describe.
pub const MOST_SLOPE: f64 = 0.3;

/// Smallest square of the rms phase of surfaces that rays describe.
pub const LEAST_G: f64 = 10.0;

/// A measurement by waves along the normal.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Waves {
    /// Index of the media above and below.
    pub index: [f64; 2],
    /// Wavelengths in air, nm.
    pub wavelengths_nm: Vec<f64>,
}

/// Results of a realisation.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct WaveScreen {
    slope_rms: f64,
    rms_um: f64,
    /// Straight part, mirror part and haze by wavelength.
    shares: Vec<[f64; 3]>,
}

impl WaveScreen {
    /// All of it as numbers, for [`Waves::screen_of`].
    pub(crate) fn numbers(&self) -> Vec<f64> {
        [&[self.slope_rms, self.rms_um], self.shares.as_flattened()].concat()
    }
}

impl Waves {
    /// Number of realisations: several of random surfaces.
    pub(crate) fn screens(surface: &Surface) -> u64 {
        if surface.is_random() { SCREENS } else { 1 }
    }

    /// Measures a realisation; realisations may be measured in any order on any thread.
    ///
    /// # Errors
    /// Surfaces that cannot be made, or have too many heights; [`MicrogeometryError::Interrupted`].
    pub(crate) fn screen(
        &self,
        surface: &Surface,
        number: u64,
        stop: &dyn Fn() -> bool,
    ) -> Result<WaveScreen, MicrogeometryError> {
        let map = surface.heights(number)?;
        if map.heights_um().len() > MOST_HEIGHTS {
            return Err(MicrogeometryError::NoScreen {
                columns: map.columns(),
                rows: map.rows(),
                most: MOST_HEIGHTS,
            });
        }
        let statistics = map.statistics();
        let plane = Plane::new([map.columns(), map.rows()]);
        let share = |nm: &f64| {
            if stop() {
                return Err(MicrogeometryError::Interrupted);
            }
            let um = 1e-3 * nm;
            let [straight, haze] = shares(&map, &plane, self.per_um(um), um, haze_beta());
            let mirror = mean(&map, 4.0 * PI * self.index[0] / um).norm_sqr();
            Ok([straight, mirror, haze])
        };
        let [x, y] = statistics.slope_rms;
        let shares = self.wavelengths_nm.iter().map(share).collect::<Result<_, _>>()?;
        Ok(WaveScreen { slope_rms: x.max(y), rms_um: statistics.rms_um, shares })
    }

    /// The realisation with these [`numbers`](WaveScreen::numbers); `None` if their count is wrong.
    pub(crate) fn screen_of(&self, numbers: &[f64]) -> Option<WaveScreen> {
        let ([slope_rms, rms_um], shares) = numbers.split_first_chunk()?;
        let shares = shares.as_chunks().0.to_vec();
        let fits = numbers.len() == 2 + 3 * self.wavelengths_nm.len();
        fits.then_some(WaveScreen { slope_rms: *slope_rms, rms_um: *rms_um, shares })
    }

    /// Combines realisations. Errors are standard errors over these; none for a surface that is not random.
    pub(crate) fn combined(&self, surface: &Surface, screens: &[WaveScreen]) -> ByWaves {
        let of = |of: &dyn Fn(&WaveScreen) -> f64| match screens {
            [one] => Measured { value: of(one), error: 0.0 },
            all => Measured::of(all.iter().map(of)),
        };
        let rms_um = of(&|screen| screen.rms_um).value;
        let share = |(at, nm): (usize, &f64)| {
            let um = 1e-3 * nm;
            let g = (self.per_um(um) * rms_um).powi(2);
            let haze_closed_form = match surface {
                Surface::Random(face) => {
                    let g = (self.per_um(um) * face.spectrum().rms_um().unwrap_or(rms_um)).powi(2);
                    closed_form_haze(face.spectrum(), g, um)
                }
                _ => None,
            };
            WaveShares {
                wavelength_nm: *nm,
                g,
                straight: of(&|screen| screen.shares[at][0]),
                mirror: of(&|screen| screen.shares[at][1]),
                haze: of(&|screen| screen.shares[at][2]),
                haze_closed_form,
            }
        };
        ByWaves {
            slope_rms: of(&|screen| screen.slope_rms).value,
            rms_um,
            shares: self.wavelengths_nm.iter().enumerate().map(share).collect(),
        }
    }

    /// Phase of transmitted light per um of height.
    fn per_um(&self, wavelength_um: f64) -> f64 {
        2.0 * PI * (self.index[1] - self.index[0]) / wavelength_um
    }
}

/// Mean of the light behind a screen, its phase being `per_um` times the height.
fn mean(map: &HeightMap, per_um: f64) -> Complex64 {
    let sum: Complex64 = map.heights_um().iter().map(|height| Complex64::cis(per_um * height)).sum();
    sum / map.heights_um().len() as f64
}

/// Fraction of the light behind a screen that passes straight through, and of that with |beta| up to 1 the fraction beyond a |beta|.
pub(crate) fn shares(
    map: &HeightMap,
    plane: &Plane,
    per_um: f64,
    wavelength_um: f64,
    beyond: f64,
) -> [f64; 2] {
    let field = map.heights_um().iter().map(|height| Complex64::cis(per_um * height)).collect();
    let orders = plane.forward(field);
    let [columns, rows] = [map.columns(), map.rows()];
    let pitch = map.pitch_um();
    let beta = |k: usize, count: usize, pitch: f64| {
        let order = if 2 * k > count { k as f64 - count as f64 } else { k as f64 };
        wavelength_um * order / (count as f64 * pitch)
    };
    let (mut all, mut in_air, mut far) = (0.0, 0.0, 0.0);
    for (at, amplitude) in orders.iter().enumerate() {
        let [x, y] = [beta(at / rows, columns, pitch[0]), beta(at % rows, rows, pitch[1])];
        let (power, square) = (amplitude.norm_sqr(), x * x + y * y);
        all += power;
        in_air += if square <= 1.0 { power } else { 0.0 };
        far += if square <= 1.0 && square > beyond * beyond { power } else { 0.0 };
    }
    [orders.first().map_or(0.0, |order| order.norm_sqr()) / all, far / in_air]
}

/// Haze of a random face for light along the normal, in closed form: of the light with |beta| up to 1, the fraction beyond sin 2.5 deg. `None` for
/// spectra without a closed form. `g`: square of the rms phase; `wavelength_um`: in air.
pub(crate) fn closed_form_haze(spectrum: &Spectrum, g: f64, wavelength_um: f64) -> Option<f64> {
    let beyond = |beta: f64| closed_form_beyond(spectrum, g, wavelength_um, beta);
    let trapped = beyond(1.0)?;
    Some((beyond(haze_beta())? - trapped) / (1.0 - trapped))
}

/// Fraction of light along the normal beyond a |beta| behind a random face, in closed form.
fn closed_form_beyond(spectrum: &Spectrum, g: f64, wavelength_um: f64, beyond: f64) -> Option<f64> {
    let term: Box<dyn Fn(f64) -> f64> = match *spectrum {
        // The Gaussian of order m: power exp(-(π τ f)²/m) in f, beta = λ f.
        Spectrum::Gaussian { correlation_um, .. } => {
            Box::new(move |m: f64| (-(PI * correlation_um * beyond / wavelength_um).powi(2) / m).exp())
        }
        // The lobe of width m b₁: beyond beta lies m b₁/(m² b₁² + beta²)^(1/2) of it.
        Spectrum::Exponential { correlation_um, .. } => Box::new(move |m: f64| {
            let width = m * wavelength_um / (2.0 * PI * correlation_um);
            width / width.hypot(beyond)
        }),
        Spectrum::Abc { .. } | Spectrum::Table { .. } => return None,
    };
    Some(poisson(g).map(|(m, weight)| weight * term(m)).sum())
}

/// Orders m of scattering from 1 on, with their fractions of the light exp(-g) g^m/m!, as far as these matter.
pub(crate) fn poisson(g: f64) -> impl Iterator<Item = (f64, f64)> {
    let most = (g + 40.0 * g.sqrt() + 40.0) as u64;
    // By logarithms, which do not overflow.
    let mut log_weight = -g;
    (1..=most).map(move |m| {
        let m = m as f64;
        log_weight += (g / m).ln();
        (m, log_weight.exp())
    })
}
