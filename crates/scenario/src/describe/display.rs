//! `[display]`: front of screen, diffuser, glass, or layers in any order.

use num_complex::Complex64;

use super::diffuser::Diffuser;
use super::dispersion::{DispersionSpec, has_model};
use super::layers::Layer;
use super::matrix::Matrix;
use super::numbers::{AirGap, Extinction, Index, IndexFactor, Share, Thickness};
use super::pixel::Pixel;
use crate::grammar::{choice, forms, table};
use crate::mistake::{self, Mistake};
use crate::read::{Read, Spanned};

table! {
    /// The layers above the pixel, from top to bottom: front, surface or diffuser, glass; or `layers` in any
    /// order.
    Display later ["front_light"] {
        /// Any layers in any order, 1 to 64, from the air down to the pixel, instead of `front`, `diffuser`
        /// and `glass`.
        layers: Option<Vec<Spanned<Layer>>>,
        /// Front-of-screen components, in air, outermost first.
        front: Option<Vec<Spanned<FrontComponent>>>,
        /// The diffuser between air and glass. Default: none, a bare panel.
        diffuser: Option<Diffuser>,
        /// The glass above the pixel. Default: clear, with an index of 1.5.
        glass: Option<Glass>,
        /// The pixel array.
        pixel: Pixel,
        /// The sub-pixels in the plane of the panel. Default: not described.
        matrix: Option<Matrix>,
    }
}

impl Display {
    /// Fills in the defaults of a panel. The general form, `layers`, has none.
    pub(super) fn complete(&mut self) {
        if self.layers.is_some() {
            return;
        }
        self.front.value.get_or_insert_default();
        let bare = self.diffuser.is_none();
        if self.glass.is_none() {
            self.glass.value = Glass::absent();
            // A palette was measured through the panel's own glass.
            if let (Pixel::Palette(_), Some(glass)) = (&self.pixel.value, &mut self.glass.value) {
                glass.index.value = MaterialSpec::Number(Index(1.0));
            }
        }
        if let Some(glass) = self.glass.value.as_mut().filter(|_| bare) {
            // A diffuser replaces the surface.
            glass.surface.value.get_or_insert(Surface::IdealAr);
        }
    }
}

table! {
    /// A front-of-screen component, with the same properties from both sides and at all angles.
    FrontComponent {
        /// Fraction of the light that is reflected specularly.
        reflectance: ShareSpectrum = ShareSpectrum::Constant(Share(0.0)),
        /// Fraction of the light that is absorbed. Its sum with `reflectance` is at most 1.
        absorptance: ShareSpectrum = ShareSpectrum::Constant(Share(0.0)),
        /// Air between the component and what is below it, for places of light.
        gap_mm as "Air gap": Option<AirGap>,
    }
}

table! {
    /// The glass above the pixel.
    Glass {
        /// Refractive index, with n from 1 to 10; its k absorbs only with `thickness_mm`.
        index as "Refractive index": MaterialSpec = MaterialSpec::Number(Index(1.5)),
        /// Surface of the glass of a panel without a diffuser. Default: `"ideal-ar"`; with a diffuser none.
        surface: Option<Surface>,
        /// Transmittance along the normal without the surfaces. Default:
        /// clear.
        internal_transmittance: Option<ShareSpectrum>,
        /// Thickness, for places of light. Without `internal_transmittance`, k of the index (at most 1e-3)
        /// absorbs along the path.
        thickness_mm: Option<Thickness>,
    }
}

choice! {
    /// The interface between air and glass.
    Surface {
        /// An ideal antireflection interface: transmits light with |beta| <= 1, and reflects all other.
        IdealAr = "ideal-ar",
        /// A bare interface, with Fresnel reflection.
        Fresnel = "fresnel",
    }
}

forms! {
    /// A fraction of the light at every wavelength: a number from 0 to 1, or a spectrum file with two
    /// columns.
    ShareSpectrum, format!("{}, or a spectrum file", Share::in_words()); {
        /// The same at all wavelengths.
        Constant(Share) if Value::Integer(_) | Value::Float(_),
        /// A file, relative to the folder of the scenario.
        File(String) if Value::Text(_),
    }
}

forms! {
    /// A refractive index: a number, `{ n, k }`, the name of a material, a file (n-k CSV in nm, or
    /// refractiveindex.info YAML or CSV), or a model by its parameters.
    MaterialSpec, "a refractive index, { n, k }, a material or a file"; {
        /// A real index.
        Number(Index) if Value::Integer(_) | Value::Float(_),
        /// The name of a material, or else a file, relative to the folder of the scenario.
        Text(String) if Value::Text(_),
        /// A model of dispersion.
        Model(DispersionSpec) if Value::Table(_) if has_model,
        /// A complex index.
        Complex(NK) if Value::Table(_),
    }
}

table! {
    /// A complex refractive index: the same at all wavelengths, or that of a material with factors, to fit them.
    NK {
        /// Refractive index.
        n as "Refractive index n": Option<Index>,
        /// Extinction coefficient, positive in an absorber (n + ik).
        k as "Extinction coefficient k": Extinction = Extinction(0.0),
        /// Name of a material, or a file, instead of n and k.
        material: Option<String>,
        /// Factor of n.
        n_scale as "Factor of n": IndexFactor = IndexFactor(1.0),
        /// Factor of k.
        k_scale as "Factor of k": IndexFactor = IndexFactor(1.0),
    }
}

/// What a table of an index describes.
pub(crate) enum IndexOf<'a> {
    Constant { n: f64, k: f64 },
    Material(&'a str),
}

impl NK {
    /// Returns what the table describes, without the factors.
    pub(crate) fn index_of(&self) -> Result<IndexOf<'_>, Box<Mistake>> {
        match (&self.n.value, &self.material.value) {
            (Some(n), None) => Ok(IndexOf::Constant { n: n.0, k: self.k.0 }),
            (None, Some(name)) if self.k.0 == 0.0 => Ok(IndexOf::Material(name)),
            (None, Some(_)) => Err(Box::new(mistake::not_with("k", "`material`").into())),
            (None, None) => Err(Box::new(mistake::missing_key("n", Index::in_words()))),
            (Some(_), Some(_)) => Err(Box::new(mistake::exactly_one("`n` and `material`", 2).into())),
        }
    }

    /// Returns an index times the factors.
    pub(crate) fn scaled(&self, index: Complex64) -> Complex64 {
        Complex64::new(self.n_scale.0 * index.re, self.k_scale.0 * index.im)
    }
}
