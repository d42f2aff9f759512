//! The two chromaticity diagrams.

use papilio_colour::{Chromaticity, GamutReference, UvPrime, Xy, Xyz};
use papilio_display::result::{Illuminant, StateValues, View, ViewMetrics};

use crate::axis::Axis;
use crate::panel::Panel;
use crate::svg::Point;

/// A chromaticity diagram.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Diagram {
    /// CIE 1976 u'v', in which equal distances are about equal differences.
    Uv,
    /// CIE 1931 xy, which data sheets use.
    Xy,
}

/// Chromaticity coordinates in a diagram.
pub(crate) type Coordinates = (f64, f64);

/// Standard gamuts with a triangle in the diagram, with their names.
pub(crate) const REFERENCES: [(GamutReference, &str); 3] =
    [(GamutReference::Srgb, "sRGB"), (GamutReference::DciP3, "DCI-P3"), (GamutReference::Ntsc, "NTSC")];

impl Diagram {
    /// Both diagrams.
    pub const ALL: [Self; 2] = [Self::Uv, Self::Xy];

    /// Returns the name that is printed: `u′v′` or `xy`.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Uv => "u\u{2032}v\u{2032}",
            Self::Xy => "xy",
        }
    }

    /// Ranges of the axes, from and to.
    fn drawn(self) -> [Coordinates; 2] {
        match self {
            Self::Uv => [(-0.05, 0.65), (0.0, 0.63)],
            Self::Xy => [(-0.05, 0.80), (0.0, 0.90)],
        }
    }

    /// Returns the height of a diagram of this width for which both axes have the same scale.
    pub(crate) fn height(self, width: f64) -> f64 {
        let [x, y] = self.drawn().map(|(from, to)| to - from);
        width * y / x
    }

    /// Returns the panel with its axes.
    pub(crate) fn panel(self, origin: Point, width: f64) -> Panel {
        let [x, y] = self.drawn();
        let titles = match self {
            Self::Uv => ["u\u{2032}", "v\u{2032}"],
            Self::Xy => ["x", "y"],
        };
        Panel {
            origin,
            size: (width, self.height(width)),
            x: Axis::exact(x.0, x.1, 7, titles[0]),
            y: Axis::exact(y.0, y.1, 7, titles[1]),
        }
    }

    /// Coordinates of tristimulus values; `None` without light.
    pub(crate) fn of(self, xyz: Xyz) -> Option<Coordinates> {
        match self {
            Self::Uv => xyz.uv_prime().map(|uv| (uv.u, uv.v)),
            Self::Xy => xyz.chromaticity().map(|xy| (xy.x, xy.y)),
        }
    }

    /// Tristimulus values of Y = 1 with these coordinates; `None` if there are none.
    pub(crate) fn xyz(self, (x, y): Coordinates) -> Option<Xyz> {
        match self {
            Self::Uv => UvPrime { u: x, v: y }.with_luminance(1.0),
            Self::Xy => Xy { x, y }.with_luminance(1.0),
        }
    }

    /// Coordinates of a state, or their errors, if they are finite.
    pub(crate) fn of_state(self, value: &StateValues) -> Option<Coordinates> {
        let (x, y) = match self {
            Self::Uv => (value.u_prime?, value.v_prime?),
            Self::Xy => (value.x?, value.y?),
        };
        (x.is_finite() && y.is_finite()).then_some((x, y))
    }

    /// Coordinates of the light.
    pub(crate) fn of_light(self, light: &Illuminant) -> Coordinates {
        match self {
            Self::Uv => (light.u_prime, light.v_prime),
            Self::Xy => (light.x, light.y),
        }
    }

    /// Triangle of a standard gamut.
    pub(crate) fn primaries(self, reference: GamutReference) -> [Coordinates; 3] {
        let pair = |[x, y]: [f64; 2]| (x, y);
        match self {
            Self::Uv => UvPrime::primaries_of(reference).map(|uv| pair(uv.coordinates())),
            Self::Xy => Xy::primaries_of(reference).map(|xy| pair(xy.coordinates())),
        }
    }

    /// Triangle of the display, if it has the states red, green and blue.
    pub(crate) fn display(self, view: &View) -> Option<[Coordinates; 3]> {
        let [red, green, blue] =
            ["red", "green", "blue"].map(|name| self.of_state(&view.states.get(name)?.value));
        Some([red?, green?, blue?])
    }

    /// Gamut area of the display in this diagram, % of a standard gamut.
    pub(crate) fn percent(self, metrics: &ViewMetrics, reference: GamutReference) -> Option<f64> {
        use GamutReference::{DciP3, Ebu, Ntsc, Srgb};
        match (self, reference) {
            (Self::Uv, Srgb) => metrics.gamut_percent_srgb,
            (Self::Uv, Ebu) => metrics.gamut_percent_ebu,
            (Self::Uv, Ntsc) => metrics.gamut_percent_ntsc,
            (Self::Uv, DciP3) => metrics.gamut_percent_dci_p3,
            (Self::Xy, Srgb) => metrics.gamut_percent_srgb_xy,
            (Self::Xy, Ebu) => metrics.gamut_percent_ebu_xy,
            (Self::Xy, Ntsc) => metrics.gamut_percent_ntsc_xy,
            (Self::Xy, DciP3) => metrics.gamut_percent_dci_p3_xy,
        }
    }
}
