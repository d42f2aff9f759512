//! Feng 2012, run again.
//!
//! Z. Feng, *Light Transport Simulation in Reflective Displays*, PhD thesis, Texas Tech University, 2012, is what
//! Papilio follows. [`reproduce`] computes each of its tables and figures that is made of numbers, and says beside
//! them what the thesis prints, by how much they differ, and why. Every number of ours in the [`Report`] is
//! computed by that call; those of the thesis are in the chapters' files, as printed.
//!
//! Its display is not public. Ours is the reference pixel (fitted to its bare peaks and colours) behind lobes of
//! its diffusers' haze; the measured samples are synthetic. So numbers of the bare panel should agree, those of
//! diffused panels in kind.
//!
//! **Out of scope.** The thesis's photographs and drawings, its measured data, and what it took from others' charts.

mod chapter_2;
mod chapter_3;
mod chapter_4;
mod chapter_5;
mod displays;
mod report;
pub mod table_5_1;
pub mod table_5_3;

use std::path::Path;

use papilio_display::Control;

pub use displays::ReproductionError;
pub use report::{Part, Report, Section, Table};

/// Computes the report; its scenarios are written into `folder`, to be run again by hand.
///
/// # Errors
/// If files cannot be written, or the work was stopped.
pub fn reproduce(folder: &Path, control: &Control<'_>) -> Result<Report, ReproductionError> {
    let bench = displays::Bench::new(folder, control)?;
    let mut sections = vec![chapter_2::phase_functions()];
    sections.extend(chapter_3::sections(&bench)?);
    sections.extend(chapter_4::sections(&bench)?);
    sections.extend(chapter_5::sections(&bench)?);
    Ok(Report {
        title: "Feng 2012, run again".to_owned(),
        about: [
            "Z. Feng, Light Transport Simulation in Reflective Displays, PhD thesis, Texas Tech University, 2012: its \
             tables and figures, computed by Papilio. Every number under \u{201c}here\u{201d} was computed for this page; \
             numbers under \u{201c}thesis\u{201d} are as printed.",
            "The thesis's display and its files are not public. Here stands the reference pixel, an interferometric \
             film stack fitted to the thesis's bare peaks and colours, behind diffusers of the same haze (76 to 81 %), \
             and synthetic measurements of them. So bare panels should agree in numbers, diffused ones in kind; \
             nothing was tuned to agree.",
            "The scenarios lie in the folder scenarios beside this page: papilio run scenarios/overcast.toml.",
        ]
        .map(str::to_owned)
        .to_vec(),
        sections,
    })
}
