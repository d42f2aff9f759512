//! A coherent coating between two transparent media, seen from both sides.
//!
//! **Model.** Reflectances and transmittance, mean of s and p or of one of them, of flat coherent layers
//! between two media, such as an antireflection film on a cover glass. They are tabulated over direction
//! once, so that a look-up costs a few dozen multiplications.
//!
//! **Parameters.** Layers as in [`film`](super), 0 to 0.05 mm in total; media of real index, per wavelength.
//! `beta` is conserved through the whole: `beta < n` is light in a medium of index n. The transmittance is a
//! fraction of power, the same from both sides (reciprocity). It therefore applies to basic radiance.
//!
//! **Beyond the smaller index** nothing is transmitted, and there is light only on the denser side. Between
//! dense media on both sides a thin gap of air does transmit light beyond its own critical angle, by
//! tunnelling.
//!
//! **Method.** The admittances of the fields contain `q = sqrt(n^2 - beta^2)` of the two media, so that as
//! functions of beta the quantities have square roots at both indices; layers in between add none. Below the
//! smaller index l they are analytic in `q_l`. Between l and the larger one h both roots are rational in x,
//! `sqrt(beta^2 - l^2) = D 2x/(1 + x^2)`, `q_h = D (1 - x^2)/(1 + x^2)`, `D^2 = h^2 - l^2`, so x runs from 0
//! to 1 without any root. Each of the two intervals has Chebyshev series on pieces that are halved until,
//! between their nodes, no quantity has an error above 1e-9. A guided resonance narrower than the distance
//! of the nodes could be missed; its fraction of the light is of the order of its width.
//!
//! **Validity.** That of [`coherent`], which computes every node. The two sides of an absorbing coating may
//! differ; R + T <= 1 holds to rounding on both.

use std::sync::Arc;

use num_complex::Complex64;

use super::coherent::{Film, Layer, Polarisation, coherent_at};
use super::{SpectralLayer, Thickness, checked_incidence, checked_wavelength, most_fringes};
use crate::OpticsError;
use crate::chebyshev::Piecewise;

/// Largest error between nodes.
const TOLERANCE: f64 = 1e-9;

/// A coating at every wavelength, ready for look-ups.
#[derive(Debug, Clone, PartialEq)]
pub struct Coating {
    bins: Vec<Table<3, 1>>,
    /// See [`with_products`](Coating::with_products): real and imaginary parts.
    products: Option<Arc<[Table<6, 2>]>>,
}

/// Products `p s*` of the amplitudes of p and of s, over those of the light that arrives, whose sizes are the geometric means of
/// the powers of both. Amplitudes of reflected p and s have opposite signs along the normal, as in [`Coherent::r`](super::Coherent::r).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Products {
    /// Transmitted, the same in both directions; 0 from the smaller index on.
    pub transmitted: Complex64,
    /// Reflected, from above.
    pub above: Complex64,
    /// Reflected, from below.
    pub below: Complex64,
}

/// Reflection and transmission of a flat part for light of one wavelength and direction; basic radiance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoatingPart {
    /// Transmittance, the same in both directions; 0 from the smaller index on.
    pub transmittance: f64,
    /// Reflectance for light from above; 0 where `|beta|` is not below the index there.
    pub above: f64,
    /// Reflectance for light from below; 0 where `|beta|` is not below the index there.
    pub below: f64,
}

/// Table of one wavelength.
#[derive(Debug, Clone, PartialEq)]
struct Table<const BOTH: usize, const DENSER: usize> {
    above_squared: f64,
    below_squared: f64,
    /// Transmission, reflections from above and below; over `q/n` of the smaller index.
    both: Piecewise<BOTH>,
    /// Reflection from the denser side between the indices, where they differ.
    denser: Option<Piecewise<DENSER>>,
}

/// What a table has at a direction.
enum Found<const BOTH: usize, const DENSER: usize> {
    /// Below both indices.
    Both([f64; BOTH]),
    /// Between them.
    Denser([f64; DENSER]),
    /// No light.
    Nothing,
}

/// A film as light from above and from below meets it.
struct Sides {
    down: Film,
    up: Film,
}

impl Coating {
    /// Largest number of panels of the table of a wavelength, on each side of the smaller index.
    pub const MOST_PANELS: usize = 256;

    /// A coating of these layers (top to bottom, thicknesses fixed) between media of these
    /// indices, one for each wavelength (nm).
    ///
    /// ```
    /// use papilio_optics::film::{Coating, SpectralLayer, Thickness};
    /// // A quarter wave of MgF2 (1.38) on glass.
    /// let quarter = Thickness::Fixed(550.0 / (4.0 * 1.38));
    /// let mgf2 = SpectralLayer { index: vec![1.38.into()], thickness: quarter };
    /// let coating = Coating::new(&[550.0], &[1.0], &[mgf2], &[1.52])?;
    /// assert!((coating.part(0.0, 0).above - 0.0126).abs() < 1e-4);
    /// // Light in the glass beyond the critical angle is reflected whole.
    /// assert!((coating.part(1.2, 0).below - 1.0).abs() < 1e-12);
    /// # Ok::<(), papilio_optics::OpticsError>(())
    /// ```
    ///
    /// # Errors
    /// As [`GapFilm::new`](super::GapFilm::new); if a thickness is the gap's; if the layers are
    /// so thick, or between mirrors so good, that their fringes are too many or too sharp.
    pub fn new(
        wavelengths_nm: &[f64],
        above: &[f64],
        layers: &[SpectralLayer],
        below: &[f64],
    ) -> Result<Self, OpticsError> {
        Self::tabulated(None, wavelengths_nm, above, layers, below)
    }

    /// The same coating for light of one polarisation.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn of(
        polarisation: Polarisation,
        wavelengths_nm: &[f64],
        above: &[f64],
        layers: &[SpectralLayer],
        below: &[f64],
    ) -> Result<Self, OpticsError> {
        Self::tabulated(Some(polarisation), wavelengths_nm, above, layers, below)
    }

    fn tabulated(
        polarisation: Option<Polarisation>,
        wavelengths_nm: &[f64],
        above: &[f64],
        layers: &[SpectralLayer],
        below: &[f64],
    ) -> Result<Self, OpticsError> {
        let table = |at: At<'_>| {
            let of = |film: &Film, beta, q| powers(polarisation, film, at.nm, beta, q);
            let both = |sides: &Sides, beta, [above, below]: [Complex64; 2]| {
                let [transmittance, reflectance] = of(&sides.down, beta, [above, below])?;
                Ok([transmittance, reflectance, of(&sides.up, beta, [below, above])?[1]])
            };
            Table::new(at, both, |film, beta, q| Ok([of(film, beta, q)?[1]]))
        };
        Ok(Self { bins: tables(wavelengths_nm, above, layers, below, table)?, products: None })
    }

    /// The same coating with the products of both amplitudes, by which light between s and p is reflected and transmitted.
    ///
    /// # Errors
    /// As [`new`](Self::new), whose arguments these are.
    pub fn with_products(
        self,
        wavelengths_nm: &[f64],
        above: &[f64],
        layers: &[SpectralLayer],
        below: &[f64],
    ) -> Result<Self, OpticsError> {
        let table = |at: At<'_>| {
            let both = |sides: &Sides, beta, [above, below]: [Complex64; 2]| {
                let [transmitted, from_above] = products(&sides.down, at.nm, beta, [above, below])?;
                let [_, from_below] = products(&sides.up, at.nm, beta, [below, above])?;
                let [t, a, b] = [transmitted, from_above, from_below];
                Ok([t.re, t.im, a.re, a.im, b.re, b.im])
            };
            let denser = |film: &Film, beta, q| {
                let [_, reflected] = products(film, at.nm, beta, q)?;
                Ok([reflected.re, reflected.im])
            };
            Table::new(at, both, denser)
        };
        let products = tables(wavelengths_nm, above, layers, below, table)?;
        Ok(Self { products: Some(products.into()), ..self })
    }

    /// Returns the reflection and transmission at `|beta|^2` and wavelength number `bin`.
    #[inline]
    pub fn part(&self, beta_squared: f64, bin: usize) -> CoatingPart {
        self.bins[bin].part(beta_squared)
    }

    /// Returns the products of both amplitudes at `|beta|^2` and wavelength number `bin`, if it has them.
    pub fn products(&self, beta_squared: f64, bin: usize) -> Option<Products> {
        Some(self.products.as_deref()?[bin].products(beta_squared))
    }

    /// Returns the `|beta|^2` between which the parts of a wavelength are smooth: the ends of the pieces of its
    /// table, which are short where the coating has sharp resonances. They do not ascend.
    pub fn pieces(&self, bin: usize) -> Vec<f64> {
        self.bins[bin].pieces()
    }
}

/// A coating at one wavelength.
#[derive(Clone, Copy)]
struct At<'a> {
    nm: f64,
    above: f64,
    layers: &'a [Layer],
    below: f64,
}

/// Returns a table for each wavelength.
fn tables<T>(
    wavelengths_nm: &[f64],
    above: &[f64],
    layers: &[SpectralLayer],
    below: &[f64],
    table: impl Fn(At<'_>) -> Result<T, OpticsError>,
) -> Result<Vec<T>, OpticsError> {
    let expected = wavelengths_nm.len();
    let arrays = [("indices of the medium above", above.len()), ("indices of the medium below", below.len())];
    let of_layers = layers.iter().map(|layer| ("indices of a layer", layer.index.len()));
    for (what, found) in arrays.into_iter().chain(of_layers) {
        if found != expected {
            return Err(OpticsError::Length { what, expected, found });
        }
    }
    let at = |bin: usize| {
        let layers: Vec<Layer> = layers.iter().map(|layer| layer_at(layer, bin)).collect::<Result<_, _>>()?;
        table(At { nm: wavelengths_nm[bin], above: above[bin], layers: &layers, below: below[bin] })
    };
    (0..expected).map(at).collect()
}

fn layer_at(layer: &SpectralLayer, bin: usize) -> Result<Layer, OpticsError> {
    match layer.thickness {
        Thickness::Fixed(thickness_nm) => Ok(Layer { index: layer.index[bin], thickness_nm }),
        Thickness::Gap => Err(OpticsError::CoatingGap),
    }
}

impl<const BOTH: usize, const DENSER: usize> Table<BOTH, DENSER> {
    /// Tabulates a coating: what it has on `both` sides, given `q` above and below, and on the `denser` one, given a film and `q` of
    /// its medium of incidence and of its substrate.
    fn new(
        At { nm, above, layers, below }: At<'_>,
        on_both: impl Fn(&Sides, f64, [Complex64; 2]) -> Result<[f64; BOTH], OpticsError>,
        on_denser: impl Fn(&Film, f64, [Complex64; 2]) -> Result<[f64; DENSER], OpticsError>,
    ) -> Result<Self, OpticsError> {
        checked_wavelength(nm)?;
        let (above, below) = (checked_incidence(above)?, checked_incidence(below)?);
        let fringes = || too_many_fringes(layers, nm);
        let from_below = layers.iter().rev().copied().collect();
        let sides = Sides {
            down: Film { incidence: above, layers: layers.to_vec(), substrate: below.into() },
            up: Film { incidence: below, layers: from_below, substrate: above.into() },
        };
        let (smaller, larger) = (above.min(below), above.max(below));

        let gap = ((larger - smaller) * (larger + smaller)).sqrt();
        // `q` is computed from x and not from beta, whose rounding is magnified close to the horizons: 1e-16
        // in beta is 1e-8 in q.
        let both = Piecewise::new(TOLERANCE, Coating::MOST_PANELS, |x| {
            let beta = smaller * ((1.0 - x) * (1.0 + x)).sqrt();
            let (q_smaller, q_larger) = (smaller * x, gap.hypot(smaller * x));
            let q = if above > below { [q_larger, q_smaller] } else { [q_smaller, q_larger] };
            on_both(&sides, beta, q.map(Complex64::from))
        })?;
        let denser = |x: f64| {
            let (beyond, within) = (2.0 * x / (1.0 + x * x), (1.0 - x) * (1.0 + x) / (1.0 + x * x));
            let film = if above > below { &sides.down } else { &sides.up };
            let q = [Complex64::from(gap * within), Complex64::new(0.0, gap * beyond)];
            on_denser(film, smaller.hypot(gap * beyond), q)
        };
        let denser = match above == below {
            true => None,
            false => Some(Piecewise::new(TOLERANCE, Coating::MOST_PANELS, denser)?.ok_or_else(fringes)?),
        };
        let both = both.ok_or_else(fringes)?;
        Ok(Self { above_squared: above * above, below_squared: below * below, both, denser })
    }

    fn pieces(&self) -> Vec<f64> {
        let (smaller, larger) =
            (self.above_squared.min(self.below_squared), self.above_squared.max(self.below_squared));
        let both = self.both.pieces().map(|(x, _)| smaller * (1.0 - x) * (1.0 + x));
        let denser = self.denser.iter().flat_map(Piecewise::pieces);
        let beyond = denser.map(|(x, _)| smaller + (larger - smaller) * (2.0 * x / (1.0 + x * x)).powi(2));
        both.chain(beyond).collect()
    }

    #[inline]
    fn at(&self, beta_squared: f64) -> Found<BOTH, DENSER> {
        let smaller = self.above_squared.min(self.below_squared);
        if beta_squared < smaller {
            return Found::Both(self.both.at((1.0 - beta_squared / smaller).sqrt()));
        }
        let larger = self.above_squared.max(self.below_squared);
        match &self.denser {
            Some(table) if beta_squared < larger => {
                let (beyond, within) = ((beta_squared - smaller).sqrt(), (larger - beta_squared).sqrt());
                Found::Denser(table.at(beyond / ((larger - smaller).sqrt() + within)))
            }
            _ => Found::Nothing,
        }
    }

    /// Returns what light from above and from below has of that of the denser side.
    fn of_denser<T: Default>(&self, value: T) -> [T; 2] {
        if self.above_squared > self.below_squared { [value, T::default()] } else { [T::default(), value] }
    }
}

impl Table<3, 1> {
    #[inline]
    fn part(&self, beta_squared: f64) -> CoatingPart {
        // Interpolation errors must not create light.
        match self.at(beta_squared) {
            Found::Both([transmittance, above, below]) => {
                let [above, below] = [above, below].map(|r| r.clamp(0.0, 1.0));
                let transmittance = transmittance.clamp(0.0, 1.0 - above.max(below));
                CoatingPart { transmittance, above, below }
            }
            Found::Denser([reflectance]) => {
                let [above, below] = self.of_denser(reflectance.clamp(0.0, 1.0));
                CoatingPart { transmittance: 0.0, above, below }
            }
            Found::Nothing => CoatingPart { transmittance: 0.0, above: 0.0, below: 0.0 },
        }
    }
}

impl Table<6, 2> {
    fn products(&self, beta_squared: f64) -> Products {
        match self.at(beta_squared) {
            Found::Both([t, t_im, above, above_im, below, below_im]) => Products {
                transmitted: Complex64::new(t, t_im),
                above: Complex64::new(above, above_im),
                below: Complex64::new(below, below_im),
            },
            Found::Denser([re, im]) => {
                let [above, below] = self.of_denser(Complex64::new(re, im));
                Products { transmitted: Complex64::ZERO, above, below }
            }
            Found::Nothing => {
                Products { transmitted: Complex64::ZERO, above: Complex64::ZERO, below: Complex64::ZERO }
            }
        }
    }
}

/// Returns the error of layers whose fringes are too many to tabulate.
fn too_many_fringes(layers: &[Layer], nm: f64) -> OpticsError {
    let most = most_fringes(layers.iter().map(|layer| (layer.index, layer.thickness_nm)), nm);
    let thickness_nm = layers.get(most.layer).map_or(0.0, |layer| layer.thickness_nm);
    OpticsError::Fringes { layer: most.layer, thickness_nm, fringes: most.fringes.ceil(), nm }
}

/// Returns transmittance and reflectance, the mean of s and p or those of one; a ray along the layers is
/// reflected completely. `q` is that of the medium of incidence and of the substrate.
fn powers(
    polarisation: Option<Polarisation>,
    film: &Film,
    nm: f64,
    beta: f64,
    q: [Complex64; 2],
) -> Result<[f64; 2], OpticsError> {
    if q[0].re <= 0.0 {
        return Ok([0.0, 1.0]);
    }
    let of = |polarisation| coherent_at(film, nm, beta, q, polarisation);
    if let Some(polarisation) = polarisation {
        let one = of(polarisation)?;
        return Ok([one.transmittance, one.reflectance]);
    }
    let (s, p) = (of(Polarisation::S)?, of(Polarisation::P)?);
    Ok([0.5 * (s.transmittance + p.transmittance), 0.5 * (s.reflectance + p.reflectance)])
}

/// Returns the products of both amplitudes, transmitted and reflected; a ray along the layers is reflected completely, with equal signs.
fn products(film: &Film, nm: f64, beta: f64, q: [Complex64; 2]) -> Result<[Complex64; 2], OpticsError> {
    if q[0].re <= 0.0 {
        return Ok([Complex64::ZERO, Complex64::ONE]);
    }
    let of = |polarisation| coherent_at(film, nm, beta, q, polarisation);
    let (s, p) = (of(Polarisation::S)?, of(Polarisation::P)?);
    // Nothing is transmitted where light is evanescent.
    let flux = q[1].re / q[0].re;
    Ok([p.t * s.t.conj() * flux, p.r * s.r.conj()])
}
