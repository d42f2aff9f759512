//! What adding does not compute of the places of light: one list, with the reason of each. Monte Carlo with
//! places computes all of it but approximations and mixtures of the states of liquid crystals.

use papilio_transport::adding::NotCovered;
use papilio_transport::spatial::SpreadError;

use crate::DisplayError;
use crate::scene::SPREAD_KEY;

/// Layers, pixels and lights whose places adding does not compute.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Refused {
    /// Places of light below general layers are known of Lambertian pixels alone: those of mirror-like pixels
    /// would take the transform at many frequencies and azimuths, seconds each.
    Layers,
    /// The same for the means of patterns of mirror-like pixels.
    PatternsBelowLayers,
    /// What frequencies below general layers do not cover.
    Layered(NotCovered),
    /// Above a flat face, the common reflectance of several components of a front does not tell how much each of them returns; above
    /// a diffuser, light may go to and fro between them too often.
    Fronts(SpreadError),
    /// A ghost of one sub-pixel lies on another: the reflectance of the pixel's mean is not enough.
    SubPixelsBelowFaces,
    /// Light that has spread inside the pixels is blurred by the lobe; the product of both is not computed.
    SpreadBelowLobe,
    /// Below windows that depend on both directions, each cell of a period would send light to all others by an
    /// integral of its own.
    SpreadBelowFilter,
    /// The response of a display with a filter is not the same at all places of a period: its mean would take the
    /// light of all cells at each frequency.
    SharpnessWithFilter,
    /// Places of light in the plane of the filter are those of an ordinary panel.
    FilterBelowLayers,
    /// Light that a front returns through a lobe passes the filter in one direction on its way up and in another
    /// on its way down: a sum over pairs of directions for each pair of cells.
    FilterBelowLobeAndFront,
    /// A single pass has no orders, and the filter is solved through all of them. No solver computes it.
    FilterInSinglePass,
    /// The transforms of adding have one reflectance for all azimuths.
    Azimuth,
    /// Flat layers return polarised light to a pixel that depends on azimuth: without its polarisation its light is not known.
    AzimuthOfUnpolarised,
    /// What changes the polarisation of light is known of the states of a pixel, not of mixtures of them in a sub-pixel. No solver computes it.
    AzimuthOfMixtures,
}

impl From<Refused> for DisplayError {
    fn from(refused: Refused) -> Self {
        let azimuth = |what, key, hint| Self::Azimuth { what, key, hint };
        let (what, key) = match refused {
            Refused::Azimuth => {
                let what = "a computation of places of light by adding";
                return azimuth(what, "solver.method", "use the Monte Carlo solver");
            }
            Refused::AzimuthOfUnpolarised => {
                let what = "a computation of places of unpolarised light below flat layers";
                return azimuth(
                    what,
                    "display.pixel",
                    "follow polarisation by solver.approximation = \"none\" and angles in air or glass, or use `papilio run` without a colour filter",
                );
            }
            Refused::AzimuthOfMixtures => {
                let what = "crosstalk below flat layers without a colour filter";
                return azimuth(
                    what,
                    "display.pixel",
                    "use `papilio mtf` with solver.method = \"monte-carlo\", or `papilio run`",
                );
            }
            Refused::Layered(NotCovered::Stopped) => return Self::Interrupted,
            Refused::Layered(why) => {
                let key = if why == NotCovered::Pixel { "display.pixel" } else { "display.layers" };
                return Self::PlacesByPaths {
                    what: format!("{why} ([[display.layers]])"),
                    key: key.to_owned(),
                };
            }
            Refused::Fronts(error) => {
                return Self::PlacesByPaths { what: error.to_string(), key: "display.front".to_owned() };
            }
            Refused::Layers => (
                "mirror-like pixels, or pixels inside which light spreads, below general layers ([[display.layers]])",
                "display.layers",
            ),
            Refused::PatternsBelowLayers => (
                "patterns of these pixels below general layers ([[display.layers]]), and does all else without the table [pattern]",
                "pattern",
            ),
            Refused::SubPixelsBelowFaces => (
                "mirror-like sub-pixels of different colours below a face, or a front, that reflects",
                "display.glass.surface",
            ),
            Refused::SpreadBelowLobe => ("light that spreads inside pixels below a diffuser", SPREAD_KEY),
            Refused::SpreadBelowFilter => (
                "light that spreads inside the pixels below a colour filter that is not of stripes",
                SPREAD_KEY,
            ),
            Refused::SharpnessWithFilter => {
                ("the sharpness of a display with a colour filter", "display.matrix.filter")
            }
            Refused::FilterBelowLayers => {
                ("a colour filter below general layers ([[display.layers]])", "display.layers")
            }
            Refused::FilterBelowLobeAndFront => {
                ("a colour filter below a diffuser and a front that reflects light", "display.front")
            }
            Refused::FilterInSinglePass => {
                return Self::PlacesNotComputed {
                    what: "a colour filter in a single pass".to_owned(),
                    key: "solver.approximation".to_owned(),
                };
            }
        };
        Self::PlacesByPaths { what: what.to_owned(), key: key.to_owned() }
    }
}
