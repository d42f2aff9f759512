//! Figures of the results, as SVG text and PNG.
//!
//! | figure | shows |
//! |---|---|
//! | [`of_run`], [`of_run_with_maps`] | all figures of `papilio run` |
//! | [`overview`] | one page for a view: patches, spectra, u'v' diagram |
//! | [`spectra`] | reflectance factor of each state against wavelength |
//! | [`chromaticity`] | states and gamut in the u'v' or xy diagram |
//! | [`gamuts`] | gamuts of several displays in the u'v' diagram |
//! | [`gamut_rings`] | gamut rings of the CIELAB volume |
//! | [`patches`] | colours of the states as the reader would see them |
//! | [`against_angle`] | a metric against the viewing angle |
//! | [`pixel_scan`] | pixel reflectance at several angles |
//! | [`cone`] | polar maps over all viewing directions |
//! | [`cone_differences`] | polar maps of colour differences from a reference direction |
//! | [`absorption`] | absorptance of each layer of a film pixel |
//! | [`spectra_over`] | spectra of variants of a display in one panel |
//! | [`compared_spectra`], [`compared_panels`], [`compared_gamuts`], [`compared_metrics`] | a simulated and a measured display |
//! | [`light`] | the lighting: luminance over the hemisphere, directed sources |
//! | [`transmission`] | transmittance of diffusers against wavelength |
//! | [`scattering`] | a measured lobe in the plane of incidence and over the hemisphere |
//! | [`lobes`] | the same for each part of a measurement |
//! | [`of_sparkle`] | all figures of `papilio sparkle`: pixels below an antiglare face, their deviation against the face |
//! | [`crosstalk()`] | which sub-pixel lights which, as matrices |
//! | [`of_mtf`] | all figures of `papilio mtf`: modulation transfer, edges, kernels |
//! | [`of_surface`] | all figures of `papilio gonio`: reflected and transmitted light, heights, waves |
//! | [`chart`] | curves in one panel |
//! | [`accuracy`] | errors of the solvers against their cost |
//! | [`of_sweep`] | all figures of `papilio sweep` |
//! | [`sweep_curves`], [`sweep_map`] | a metric over one or two swept keys |
//! | [`histogram`], [`sensitivities`], [`pass_fail_scatter`] | a tolerance analysis: distribution, sensitivities, displays that pass and fail |
//! | [`point_sets`] | points in the unit square |
//!
//! Each function takes the title of the scenario, which is printed above the figure (empty: no title).
//! Figures of a view also state its direction. Error bars are one standard error; they are drawn where they
//! are wider than a line. The output is well-formed XML for any data (NaN, missing states, unusual names).
//! Values that cannot be drawn are omitted.
//!
//! A small module of this crate writes the SVG. Most of the work is in the u'v' diagram, the labels at the
//! ends of curves and the composed pages, which plotting crates do not offer. Text refers to generic fonts
//! only, and no font is used to measure it. [`png`] rasterises any of the figures.
//!
//! **Out of scope.** Writing files; the functions only propose file names.

mod absorption;
mod accuracy;
mod angle;
mod axis;
mod chart;
mod chromaticity;
mod colour_map;
mod compared_metrics;
mod compared_panels;
mod comparison;
mod cone;
mod cone_differences;
mod cone_scale;
mod contour;
mod crosstalk;
mod diagram;
mod file_names;
mod fit;
mod labels;
mod light;
mod lobes;
mod locus;
mod marks;
mod mtf;
mod of_run;
mod overlay;
mod overview;
mod paint;
mod palette;
mod panel;
mod patches;
mod pixel_scan;
mod place;
mod point_sets;
mod polar;
mod production;
mod rings;
mod scattering;
mod sparkle;
mod spectra;
mod style;
mod surface;
mod svg;
mod sweep;

pub use absorption::absorption;
pub use accuracy::{ErrorCurve, ErrorPanel, accuracy};
pub use angle::{AngleMetric, against_angle};
pub use chart::{Chart, ChartCurve, Hue, chart};
pub use chromaticity::{chromaticity, gamuts};
pub use compared_metrics::compared_metrics;
pub use compared_panels::compared_panels;
pub use comparison::{compared_gamuts, compared_spectra};
pub use cone::cone;
pub use cone_differences::cone_differences;
pub use crosstalk::crosstalk;
pub use diagram::Diagram;
pub use file_names::file_names;
pub use fit::{FittedSpectrum, fit_residuals, fitted_spectra};
pub use light::light;
pub use lobes::lobes;
pub use mtf::of_mtf;
pub use of_run::{of_run, of_run_with_maps};
pub use overlay::{Transmission, spectra_over, transmission};
pub use overview::overview;
pub use palette::of_palette;
pub use papilio_formats::{HAS_PNG, PNG_SCALE, PngError, png};
pub use patches::patches;
pub use pixel_scan::{PixelScan, pixel_scan};
pub use point_sets::point_sets;
pub use production::{Ends, SensitivityBar, histogram, pass_fail_scatter, sensitivities};
pub use rings::gamut_rings;
pub use scattering::{ScatterCurve, ScatterMap, Scattering, scattering};
pub use sparkle::of_sparkle;
pub use spectra::spectra;
pub use surface::of_surface;
pub use sweep::{SweepAxis, SweepFigure, of_sweep, sweep_curves, sweep_map};
