//! `[display]`: front of screen, diffuser, glass.

use super::numbers::{Extinction, Index, InnerShare, Share, Width};
use super::pixel::Pixel;
use crate::grammar::{choice, forms, table};
use crate::read::At;

table! {
    /// The layers of the panel, top to bottom: front, surface or diffuser, glass, pixel.
    Display later ["layers", "front_light"] {
        /// Front-of-screen components in air, outermost first. Default: none.
        front: Vec<At<FrontComponent>> = Vec::new(),
        /// The diffuser between air and glass. Default: none, a bare panel.
        diffuser: Option<Diffuser>,
        /// The glass above the pixel.
        glass: Glass,
        /// The pixel array.
        pixel: Pixel,
    }
}

impl Display {
    /// Fills in the face of a bare panel; under a diffuser there is none.
    pub(super) fn complete(&mut self) {
        if self.diffuser.is_none() {
            self.glass.value.surface.value.get_or_insert(Surface::Coated);
        }
    }
}

table! {
    /// A front-of-screen component, alike from both sides and at all angles.
    FrontComponent {
        /// Share of the light that it mirrors: 0 to 1, or a spectrum file. Default 0.
        reflectance: ShareSpectrum = ShareSpectrum::Constant(Share(0.0)),
        /// Share of the light that it absorbs: 0 to 1, or a spectrum file; the two together at most 1. Default 0.
        absorptance: ShareSpectrum = ShareSpectrum::Constant(Share(0.0)),
    }
}

table! {
    /// A diffuser given by its BTDF; it stands for everything between air and glass, its faces included.
    Diffuser later [
        "optical_thickness", "anisotropy", "albedo", "index", "file", "transmission", "normalise", "mounting", "alpha",
    ] {
        /// The shape of its lobe.
        model: DiffuserModel,
        /// ASTM D1003 haze, between 0 and 1: the share of the transmitted light beyond 2.5 deg,
        /// straight-through included. `k-correlation` takes this or `width`.
        haze: Option<InnerShare>,
        /// Width b of the k-correlation lobe, in direction cosines, 1e-6 to 100.
        width: Option<Width>,
        /// Transmittance that a datasheet gives (hemispherical, air to air, normal incidence): 0 to 1,
        /// or a spectrum file. This or `transmittance`.
        total_transmittance: Option<ShareSpectrum>,
        /// Transmittance T over the whole plane of direction cosines, straight-through included: 0 to 1, or a spectrum file.
        transmittance: Option<ShareSpectrum>,
        /// Share s of T that is not scattered, 0 to 1: T splits into s T unscattered and (1 - s) T of the lobe over
        /// the whole plane of direction cosines. So `total_transmittance` is T ((1 - s) f + s), f the lobe's share
        /// within |beta| <= 1 at normal incidence. Default 0.
        straight_through: Share = Share(0.0),
    }
}

choice! {
    /// The shape of a diffuser's lobe.
    DiffuserModel {
        /// Generalised Harvey-Shack with exponent 3/2.
        KCorrelation = "k-correlation",
        /// The same radiance in every direction of the air hemisphere.
        Lambertian = "lambertian",
    } later ["slab", "measured", "ward"]
}

table! {
    /// The glass between surface and pixel.
    Glass {
        /// Refractive index, real, 1 to 10: a number, a material or a file. Default 1.5.
        index: MaterialSpec = MaterialSpec::Number(Index(1.5)),
        /// The face between air and glass of a panel without diffuser. Default "coated".
        surface: Option<Surface>,
    }
}

choice! {
    /// The face between air and glass.
    Surface {
        /// A perfect antireflection face: |beta| <= 1 passes whole, beyond it everything is reflected.
        Coated = "coated",
        /// A bare face.
        Fresnel = "fresnel",
    }
}

forms! {
    /// A share of the light at every wavelength: a number from 0 to 1, or a two-column spectrum file.
    ShareSpectrum, "a number from 0 to 1, or a spectrum file" {
        /// Alike at all wavelengths.
        Constant(Share) if Value::Integer(_) | Value::Float(_),
        /// A file, relative to the scenario.
        File(String) if Value::Text(_),
    }
}

forms! {
    /// A refractive index: a number, `{ n, k }`, the name of a material, or a file (n-k CSV in nm, or refractiveindex.info YAML).
    MaterialSpec, "a refractive index, { n, k }, a material or a file" {
        /// A real index.
        Number(Index) if Value::Integer(_) | Value::Float(_),
        /// A name first, else a file, relative to the scenario.
        Text(String) if Value::Text(_),
        /// A complex index.
        Complex(NK) if Value::Table(_),
    }
}

table! {
    /// A complex refractive index, alike at all wavelengths.
    NK {
        /// Refractive index.
        n: Index,
        /// Extinction coefficient, 0 or more. Default 0.
        k: Extinction = Extinction(0.0),
    }
}
