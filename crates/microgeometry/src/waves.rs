//! Waves at a surface: the light that keeps the regular direction, and haze, by wavelength and inclination.
//!
//! **Model.** A thin phase screen: heights h delay light by 2π h/λ times gamma₂ - gamma₁ in transmission, and
//! times gamma₁ + gamma₂ in reflection, gamma being n cos(theta) before and after the mean face. The far
//! field is the Fourier transform of exp(i phase); its power at the frequency f (cycles per um) goes λ f
//! beside the regular direction, as from a grating. Powers in directions that exist are multiplied so that
//! nothing is lost to those that do not. One pass, no shadows: slopes below about 0.3.
//!
//! **Closed forms.** For Gaussian heights with the rms phase g^(1/2), the regular part is exp(-g). Where the
//! correlation of the heights is exp(-r²/τ²), the rest is the sum of exp(-g) g^m/m! times Gaussians
//! `exp(-(π τ f)²/m)` of f; where it is exp(-r/τ), of lobes `m b₁/(2π (m² b₁² + beta²)^(3/2))` with b₁ =
//! λ/(2π τ) (P. Beckmann, A. Spizzichino 1963; J. E. Harvey et al., Opt. Eng. 51, 013402 (2012)). At oblique
//! angles g may be that of both directions: see [`harvey_shack`](crate::harvey_shack).
//!
//! Rays know none of this: they hold where g is above [`LEAST_G`], thin screens where slopes are below
//! [`MOST_SLOPE`] and shadows are few, up to [`MOST_SHADOW`].

use num_complex::Complex64;
use papilio_fourier::Plane;

use crate::goniometer::{Measured, haze_beta};
use crate::harvey_shack::{HarveyShack, Lobes};
use crate::screen_rings::{Lattice, Orders, ScreenLight, ScreenRings, ScreenShares};
use crate::wave_way::Way;
use crate::{HeightMap, MicrogeometryError, Side, Surface};

/// Largest number of heights of which screens are made.
const MOST_HEIGHTS: usize = 1 << 22;

/// Realisations of a random surface.
const SCREENS: u64 = 8;

/// What a surface does to waves of an inclination and a wavelength.
#[derive(Debug, Clone, PartialEq)]
pub struct WaveShares {
    /// Side of the light.
    pub from: Side,
    /// Its inclination in its own medium, degrees; it comes from all azimuths.
    pub theta_deg: f64,
    /// Wavelength in air, nm.
    pub wavelength_nm: f64,
    /// Reflected light.
    pub reflected: WayShares,
    /// Transmitted light; `None` beyond the critical angle.
    pub transmitted: Option<WayShares>,
}

/// Waves that a surface reflects, or that it transmits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WayShares {
    /// Fraction of the light that goes this way: Fresnel's, at the mean face.
    pub fresnel: f64,
    /// Square of the rms phase in the regular direction, g.
    pub g: f64,
    /// Of the light of this way, the fraction in the regular direction: straight through, or as from a
    /// mirror.
    pub regular: Measured,
    /// Haze: of the light of this way that is seen, the fraction beyond |beta| = sin 2.5 deg from the regular
    /// direction. Transmitted light is seen with
    /// |beta| up to 1, reflected light in all directions.
    pub haze: Measured,
    /// Fraction of the screen's orders in directions that do not exist, before renormalisation.
    pub evanescent: Measured,
    /// Closed forms for random faces with Gaussian or exponential correlation.
    pub closed_form: Option<HarveyShack>,
    /// Largest tangent of the angles to the normal before and behind the mean face.
    pub tangent: f64,
}

impl WayShares {
    /// Whether rays describe this light: g is above [`LEAST_G`].
    pub fn rays_hold(&self) -> bool {
        self.g > LEAST_G
    }

    /// Whether thin screens describe this light on a surface of this rms slope.
    pub fn waves_hold(&self, slope_rms: f64) -> bool {
        slope_rms < MOST_SLOPE && slope_rms * self.tangent < MOST_SHADOW
    }
}

/// A surface measured by waves.
#[derive(Debug, Clone, PartialEq)]
pub struct ByWaves {
    /// Root mean square slope along x or y, the larger one. Thin screens hold up to about [`MOST_SLOPE`].
    pub slope_rms: f64,
    /// Root mean square height, um.
    pub rms_um: f64,
    /// Light along the normal from above, by wavelength; then that of all inclinations from above and from
    /// below.
    pub shares: Vec<WaveShares>,
}

impl ByWaves {
    /// Light along the normal from above, by wavelength, with what is transmitted.
    pub fn along_normal(&self) -> impl Iterator<Item = (&WaveShares, &WayShares)> {
        let along = self.shares.iter().filter(|one| one.is_normal());
        along.filter_map(|one| Some((one, one.transmitted.as_ref()?)))
    }
}

impl WaveShares {
    /// Whether it is light along the normal from above.
    pub fn is_normal(&self) -> bool {
        self.from == Side::Above && self.theta_deg == 0.0
    }
}

/// Largest rms slope of surfaces that thin phase screens describe.
pub const MOST_SLOPE: f64 = 0.3;

/// Largest product of rms slope and tangent of the inclination: Gaussian slopes then hide 0.2 % of the face
/// (Smith's Lambda at 1.6, where the fit of B. Walter et al., EGSR 2007, ends).
pub const MOST_SHADOW: f64 = 0.44;

/// Smallest square of the rms phase of surfaces that rays describe.
pub const LEAST_G: f64 = 10.0;

/// Largest rms phase, radians, of surfaces whose light is computed by waves; far beyond it, scattering has as
/// many orders as its square.
pub const MOST_PHASE: f64 = 300.0;

/// Fraction of the light of an order of scattering that does not matter.
const LITTLE: f64 = 1e-18;

/// A measurement by waves.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Waves {
    /// Index of the media above and below.
    pub index: [f64; 2],
    /// Inclinations, degrees; the normal from above is measured in any case.
    pub incidence_deg: Vec<f64>,
    /// Wavelengths in air, nm.
    pub wavelengths_nm: Vec<f64>,
}

/// Results of a realisation.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct WaveScreen {
    slope_rms: f64,
    rms_um: f64,
    /// By row: regular part, haze and evanescent part of reflected and of transmitted light; 0 where nothing
    /// is transmitted.
    shares: Vec<[f64; 6]>,
}

impl WaveScreen {
    /// All of it as numbers, for [`Waves::screen_of`].
    pub(crate) fn numbers(&self) -> Vec<f64> {
        [&[self.slope_rms, self.rms_um], self.shares.as_flattened()].concat()
    }
}

/// Light that is measured: its side, inclination (degrees) and wavelength (nm).
type Row = (Side, f64, f64);

impl Waves {
    /// Number of realisations: several of random surfaces.
    pub(crate) fn screens(surface: &Surface) -> u64 {
        if surface.is_random() { SCREENS } else { 1 }
    }

    /// Light along the normal from above first.
    fn rows(&self) -> Vec<Row> {
        let of = |from: Side| self.incidence_deg.iter().map(move |deg| (from, *deg));
        let others = Side::ALL.into_iter().flat_map(of).filter(|one| *one != (Side::Above, 0.0));
        let all = [(Side::Above, 0.0)].into_iter().chain(others);
        all.flat_map(|(from, deg)| self.wavelengths_nm.iter().map(move |nm| (from, deg, *nm))).collect()
    }

    /// Ways of the light of a row, with its wavelength in um.
    fn ways(&self, (from, theta_deg, nm): &Row) -> impl Iterator<Item = (Way, f64)> + use<> {
        let (reflected, transmitted) = Way::both(self.index, *from, *theta_deg);
        let um = 1e-3 * nm;
        [Some(reflected), transmitted].into_iter().flatten().map(move |way| (way, um))
    }

    /// Fails for heights of so many wavelengths that the orders of scattering, about g of them, would need
    /// endless time.
    fn check_phase(&self, rms_um: f64) -> Result<(), MicrogeometryError> {
        let rows = self.rows();
        let ways = rows.iter().flat_map(|row| self.ways(row));
        let largest = ways.map(|(way, um)| way.regular_per_um(um)).fold(0.0, f64::max);
        if largest * rms_um <= MOST_PHASE {
            return Ok(());
        }
        Err(MicrogeometryError::RandomFace {
            wrong: format!(
                "heights of {rms_um:e} um rms are too many wavelengths for waves (expected at most {:.3} um rms here): `road = \"rays\"` describes \
                 such a surface",
                MOST_PHASE / largest
            ),
        })
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
        if let Surface::Random(face) = surface {
            face.spectrum().rms_um().map_or(Ok(()), |rms_um| self.check_phase(rms_um))?;
        }
        let map = surface.heights(number)?;
        if map.heights_um().len() > MOST_HEIGHTS {
            return Err(MicrogeometryError::NoScreen {
                columns: map.columns(),
                rows: map.rows(),
                most: MOST_HEIGHTS,
            });
        }
        let statistics = map.statistics();
        self.check_phase(statistics.rms_um)?;
        let plane = Plane::new([map.columns(), map.rows()]);
        let rows = self.rows();
        let light = ScreenLight::new(rows.iter().flat_map(|row| self.ways(row)));
        let orders = match surface {
            Surface::Random(_) => Orders::Cells,
            other if other.is_random() => Orders::CellsOfShapes,
            _ => Orders::Exact,
        };
        let rings = ScreenRings::new(&map, (&plane, orders), &light, stop);
        let rings = rings.ok_or(MicrogeometryError::Interrupted)?;
        let share = |row: &Row| {
            let (from, theta_deg, nm) = *row;
            let um = 1e-3 * nm;
            let (reflected, transmitted) = Way::both(self.index, from, theta_deg);
            let reflected = rings.of(&reflected, um);
            let transmitted = transmitted.map_or(ScreenShares::default(), |way| {
                let found = rings.of(&way, um);
                if theta_deg != 0.0 {
                    return found;
                }
                // Along the normal, orders and not circles are counted, from both sides.
                let per_um = way.regular_per_um(um);
                let [regular, haze] = shares(&map, (&plane, orders), per_um, um, haze_beta());
                ScreenShares { regular, haze, ..found }
            });
            let of = |one: ScreenShares| [one.regular, one.haze, one.evanescent];
            let ([a, b, c], [d, e, f]) = (of(reflected), of(transmitted));
            [a, b, c, d, e, f]
        };
        let [x, y] = statistics.slope_rms;
        let shares = rows.iter().map(share).collect();
        Ok(WaveScreen { slope_rms: x.max(y), rms_um: statistics.rms_um, shares })
    }

    /// The realisation with these [`numbers`](WaveScreen::numbers); `None` if their count is wrong.
    pub(crate) fn screen_of(&self, numbers: &[f64]) -> Option<WaveScreen> {
        let ([slope_rms, rms_um], shares) = numbers.split_first_chunk()?;
        let shares = shares.as_chunks().0.to_vec();
        let fits = numbers.len() == 2 + 6 * self.rows().len();
        fits.then_some(WaveScreen { slope_rms: *slope_rms, rms_um: *rms_um, shares })
    }

    /// Combines realisations. Errors are standard errors over these; none for a surface that is not random.
    pub(crate) fn combined(&self, surface: &Surface, screens: &[WaveScreen]) -> ByWaves {
        let of = |of: &dyn Fn(&WaveScreen) -> f64| match screens {
            [one] => Measured { value: of(one), error: 0.0 },
            all => Measured::of(all.iter().map(of)),
        };
        let rms_um = of(&|screen| screen.rms_um).value;
        let spectrum = match surface {
            Surface::Random(face) => Some(face.spectrum()),
            _ => None,
        };
        let lobes = |nm: f64| Lobes::new(spectrum?, 1e-3 * nm, 2.0 * self.index[0].max(self.index[1]));
        let lobes: Vec<Option<Lobes>> = self.wavelengths_nm.iter().map(|nm| lobes(*nm)).collect();
        let share = |(at, (from, theta_deg, wavelength_nm)): (usize, Row)| {
            let um = 1e-3 * wavelength_nm;
            let lobes = lobes[at % self.wavelengths_nm.len()].as_ref();
            let way = |way: Way, first: usize| WayShares {
                fresnel: way.fresnel,
                g: (way.regular_per_um(um) * rms_um).powi(2),
                regular: of(&|screen| screen.shares[at][first]),
                haze: of(&|screen| screen.shares[at][first + 1]),
                evanescent: of(&|screen| screen.shares[at][first + 2]),
                closed_form: lobes.map(|lobes| lobes.of(&way)),
                tangent: way.tangent(),
            };
            let (reflected, transmitted) = Way::both(self.index, from, theta_deg);
            WaveShares {
                from,
                theta_deg,
                wavelength_nm,
                reflected: way(reflected, 0),
                transmitted: transmitted.map(|transmitted| way(transmitted, 3)),
            }
        };
        ByWaves {
            slope_rms: of(&|screen| screen.slope_rms).value,
            rms_um,
            shares: self.rows().into_iter().enumerate().map(share).collect(),
        }
    }
}

/// Fraction of the light behind a screen that passes straight through, and of that with |beta| up to 1 the
/// fraction beyond a |beta|.
pub(crate) fn shares(
    map: &HeightMap,
    (plane, stands_for): (&Plane, Orders),
    per_um: f64,
    wavelength_um: f64,
    beyond: f64,
) -> [f64; 2] {
    let field = map.heights_um().iter().map(|height| Complex64::cis(per_um * height)).collect();
    let orders = plane.forward(field);
    let lattice = Lattice::new(map);
    let (mut all, mut in_air, mut far) = (0.0, 0.0, 0.0);
    for (at, amplitude) in orders.iter().enumerate() {
        let [x, y] = lattice.frequency(at);
        let (power, exists) = (amplitude.norm_sqr(), wavelength_um * x.hypot(y) <= 1.0);
        all += power;
        if exists {
            in_air += power;
            // The regular direction is one, whatever the orders about it.
            let is_regular = at == 0;
            let is_far = stands_for.beyond([x, y], lattice.per_order, beyond / wavelength_um);
            far += if is_regular { 0.0 } else { power * is_far };
        }
    }
    [orders.first().map_or(0.0, |order| order.norm_sqr()) / all, far / in_air]
}

/// Orders m of scattering from 1 on, with their fractions of the light exp(-g) g^m/m!, as far as these
/// matter.
pub(crate) fn poisson(g: f64) -> impl Iterator<Item = (f64, f64)> {
    let most = (g + 40.0 * g.sqrt() + 40.0) as u64;
    // By logarithms, which do not overflow.
    let mut log_weight = -g;
    let all = (1..=most).map(move |m| {
        let m = m as f64;
        log_weight += (g / m).ln();
        (m, log_weight.exp())
    });
    all.filter(|(_, weight)| *weight > LITTLE)
}
