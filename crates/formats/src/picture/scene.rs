//! Pictures of high dynamic range: the light of a scene, which has no white, becomes a picture that has one.
//!
//! Values up to 1 are taken as they are: 1 is white, as in pictures that were rendered for a screen. If a luminance
//! exceeds 1, the curve of E. Reinhard et al., *Photographic tone reproduction for digital images*, SIGGRAPH
//! 2002, equations 1 to 4, is applied with their key 0.18:
//!
//! `L_d = L (1 + L/L_w^2)/(1 + L)`, `L = 0.18 Y/mean(Y)`,
//!
//! where the mean is geometric and `L_w` is the luminance that only one pixel of a thousand exceeds, 1 or more. Red, green and
//! blue keep their ratios. `image.exposure` changes the result in stops.
//!
//! Opacity (OpenEXR's channel A, by which light is multiplied already) leaves the luminances in the curve as they are without it; after the curve, the
//! picture lies on white, as those of other formats do.

use papilio_diagnostics::{Diagnostic, Warned};

use super::colour_space::{RgbSpace, d65};
use super::source::SourcePicture;
use super::transfer::Transfer;
use crate::light::{LightMap, LinearLight, MapColour, XYZ};

/// Luminance of the geometric mean of a scene (Reinhard et al.).
const KEY: f64 = 0.18;

/// Fraction of the pixels that may be brighter than white.
const HIGHLIGHTS: f64 = 1e-3;

/// A picture of the light in a file.
///
/// # Errors
/// If its channels are wavelengths, a value is not finite, or the primaries are on a line.
pub(super) fn developed(light: LinearLight) -> Result<Warned<SourcePicture>, Diagnostic> {
    let LinearLight { map, primaries, opacity } = light;
    let LightMap { width, height, channels, notes: mut warnings } = map;
    if channels.iter().any(|channel| matches!(channel.colour, MapColour::Wavelength(_))) {
        return Err(Diagnostic::new("this file has the light of wavelengths")
            .expected("red, green and blue, or X, Y and Z, or luminance")
            .hint("convert it to red, green and blue in the program that created it"));
    }
    let (space, xyz_from_pixel) = match primaries {
        Some(primaries) if primaries == XYZ => ("X, Y, Z", IDENTITY),
        stated => {
            let mut space = RgbSpace::srgb();
            space.transfer = Transfer::Linear;
            if let Some([red, green, blue, white]) = stated {
                (space.primaries, space.white) = ([red, green, blue], white);
            }
            let matrix = space.xyz_from_rgb().ok_or_else(|| {
                super::unsupported(
                    "the colour space of this file",
                    "primaries that are not on a line, and a white",
                )
            })?;
            (if stated.is_some() { "linear light of stated primaries" } else { "linear sRGB" }, matrix)
        }
    };
    let value =
        |k: usize, at: usize| channels.get(k).or(channels.first()).map_or(0.0, |one| one.radiance[at]);
    let mut pixels: Vec<[f32; 3]> = (0..width * height).map(|at| [0, 1, 2].map(|k| value(k, at))).collect();
    let opaque = |at: usize| opacity.as_ref().map_or(1.0, |all| f64::from(all[at]).clamp(0.0, 1.0));
    let is_wrong = |at: &usize| !pixels[*at].iter().all(|value| value.is_finite()) || opaque(*at).is_nan();
    if let Some(at) = (0..pixels.len()).find(is_wrong) {
        let place =
            format!("pixel {} in row {} has a value that is not finite", at % width + 1, at / width + 1);
        return Err(Diagnostic::new(place).expected("light of 0 or more"));
    }
    let luminance = |pixel: &[f32; 3]| -> f64 {
        pixel.iter().zip(xyz_from_pixel[1]).map(|(value, weight)| f64::from(*value) * weight).sum()
    };
    // Of the light without its opacity; that of a pixel without any is added to what is behind it.
    let straight = |luminance: f64, opaque: f64| if opaque > 0.0 { luminance / opaque } else { luminance };
    let is_bright = |at: usize| luminance(&pixels[at]) > opaque(at) + ROUNDING;
    let luminances = || (0..pixels.len()).map(|at| straight(luminance(&pixels[at]), opaque(at)));
    let curve = if (0..pixels.len()).any(is_bright) { Curve::of(luminances()) } else { None };
    if let Some(curve) = curve {
        for (at, pixel) in pixels.iter_mut().enumerate() {
            let factor = curve.factor(straight(luminance(pixel), opaque(at)));
            pixel.iter_mut().for_each(|value| *value = (f64::from(*value) * factor) as f32);
        }
        warnings.push(format!(
            "this is the light of a scene, which has no white: its mean (geometric, {:.3}) becomes {KEY}, and {:.3} becomes white; image.exposure makes it \
             lighter or darker",
            KEY / curve.scale,
            curve.white / curve.scale,
        ));
    }
    if (0..pixels.len()).any(|at| opaque(at) < 1.0) {
        let white = if primaries == Some(XYZ) { d65() } else { [1.0; 3] };
        for (at, pixel) in pixels.iter_mut().enumerate() {
            let behind = 1.0 - opaque(at);
            for (value, white) in pixel.iter_mut().zip(white) {
                *value += (behind * white) as f32;
            }
        }
        warnings.push(super::TRANSPARENT.to_owned());
    }
    Ok(Warned { value: SourcePicture::linear([width, height], pixels, xyz_from_pixel, space), warnings })
}

const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The curve of a scene.
struct Curve {
    /// 0.18 over the geometric mean of the luminances.
    scale: f64,
    /// Luminance that becomes white, after the scale.
    white: f64,
}

impl Curve {
    /// `None` without light.
    fn of(luminances: impl Iterator<Item = f64>) -> Option<Self> {
        let mut lit: Vec<f64> = luminances.filter(|one| *one > 0.0).collect();
        if lit.is_empty() {
            return None;
        }
        let scale = KEY / (lit.iter().map(|one| one.ln()).sum::<f64>() / lit.len() as f64).exp();
        let at = ((1.0 - HIGHLIGHTS) * (lit.len() - 1) as f64).round() as usize;
        let white = (scale * *lit.select_nth_unstable_by(at, f64::total_cmp).1).max(1.0);
        (scale.is_finite() && white.is_finite()).then_some(Self { scale, white })
    }

    /// Factor on a pixel of this luminance.
    fn factor(&self, luminance: f64) -> f64 {
        let scaled = self.scale * luminance.max(0.0);
        self.scale * (1.0 + scaled / (self.white * self.white)) / (1.0 + scaled)
    }
}

/// Luminances above 1 that are rounding: half precision.
const ROUNDING: f64 = 1e-3;
