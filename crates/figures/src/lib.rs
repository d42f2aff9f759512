//! Figures of the results, as SVG text and PNG.
//!
//! | figure | shows |
//! |---|---|
//! | [`of_run`] | all that `papilio run` draws |
//! | [`overview`] | a view at a glance: patches, spectra, u'v' diagram |
//! | [`spectra`] | reflectance factor of every state against wavelength |
//! | [`chromaticity`] | states and gamut in the u'v' diagram |
//! | [`gamuts`] | gamuts of several displays in the u'v' diagram |
//! | [`gamut_rings`] | the gamut's solid in CIELAB, laid flat |
//! | [`patches`] | the states as the reader would see them |
//! | [`against_angle`] | a metric against the viewing angle |
//! | [`pixel_scan`] | pixel reflectance at several angles |
//! | [`cone`] | polar maps over all viewing directions |
//! | [`spectra_over`] | spectra of a display over those of variants of it |
//! | [`compared_spectra`], [`compared_gamuts`] | a simulated display beside a measured one |
//! | [`light`] | where the light comes from: luminance over the hemisphere, lamps |
//! | [`transmission`] | what diffusers transmit against wavelength |
//! | [`scattering`] | a measured lobe: in the plane of incidence, and over the hemisphere |
//! | [`lobes`] | the same of every part of a measurement |
//! | [`chart`] | plain curves in a panel |
//! | [`accuracy`] | errors of solvers against their cost |
//! | [`of_sweep`] | all that `papilio sweep` draws |
//! | [`sweep_curves`], [`sweep_map`] | a metric over one or two swept keys |
//! | [`histogram`], [`sensitivities`], [`good_and_bad`] | what production makes of a design |
//! | [`point_sets`] | where points lie in the unit square |
//!
//! Each takes the scenario's title (empty: none), which stands above the figure, and
//! figures of a view say from where it is seen. Errors are one standard error, drawn where they are wider than a line.
//! Whatever the data (NaN, missing states, odd names), the text is well-formed
//! XML: what cannot be drawn is left out.
//!
//! The SVG is written by a small module of our own: the u'v' diagram, names at the
//! ends of curves and composed pages are most of the work, and plotting crates offer none
//! of them. Text names generic fonts only, and nothing is measured with a font. [`png`] makes
//! a picture of any of them.
//!
//! **Out of scope.** Files; names are proposed for those that a program writes.

mod accuracy;
mod angle;
mod axis;
mod chart;
mod chromaticity;
mod colour_map;
mod comparison;
mod cone;
mod contour;
mod labels;
mod light;
mod lobes;
mod locus;
mod marks;
mod of_run;
mod overlay;
mod overview;
mod paint;
mod panel;
mod patches;
mod pixel_scan;
mod place;
mod png;
mod point_sets;
mod polar;
mod production;
mod rings;
mod scattering;
mod spectra;
mod style;
mod svg;
mod sweep;

pub use accuracy::{ErrorCurve, ErrorPanel, accuracy};
pub use angle::{AngleMetric, against_angle};
pub use chart::{Chart, ChartCurve, Hue, chart};
pub use chromaticity::{chromaticity, gamuts};
pub use comparison::{compared_gamuts, compared_spectra};
pub use cone::cone;
pub use light::light;
pub use lobes::lobes;
pub use of_run::of_run;
pub use overlay::{Transmission, spectra_over, transmission};
pub use overview::overview;
pub use patches::patches;
pub use pixel_scan::{PixelScan, pixel_scan};
pub use png::{HAS_PNG, PNG_SCALE, PngError, png};
pub use point_sets::point_sets;
pub use production::{Blame, Ends, good_and_bad, histogram, sensitivities};
pub use rings::gamut_rings;
pub use scattering::{ScatterCurve, ScatterMap, Scattering, scattering};
pub use spectra::spectra;
pub use style::named_with_unit;
pub use sweep::{SweepAxis, SweepFigure, of_sweep, short_key, sweep_curves, sweep_map};
