//! Figures of the results, as SVG.
