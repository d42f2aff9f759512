//! Reproduction of the tables and figures of Feng 2012.
//!
//! Papilio follows Z. Feng, *Light Transport Simulation in Reflective Displays*, PhD thesis, Texas Tech
//! University,
//! 2012. [`reproduce`] computes all its tables and figures that consist of numbers. It compares them with the
//!       numbers
//! printed in the thesis, and explains the differences. The call computes all our numbers in the [`Report`];
//! the numbers of the thesis are in the files of the chapters, as printed.
//!
//! The thesis's display is not public. Ours is the reference pixel (fitted to the peaks and colours of the
//! bare panel) behind diffusers of the same haze; the measured samples are synthetic. Numbers of the bare
//! panel should therefore agree, and those of diffused panels qualitatively.
//!
//! [`samples`] predicts samples that others measured.
//!
//! **Out of scope.** The thesis's photographs and drawings, its measured data, and the data that it took from
//! charts of others.

mod bumps;
mod chapter_2;
mod chapter_3;
mod chapter_4;
mod chapter_5;
mod dipoles;
mod displays;
mod report;
pub mod samples;
pub mod table_5_1;
pub mod table_5_3;
mod verdict;

use std::path::Path;

use papilio_display::{Control, Progress};

pub use displays::ReproductionError;
pub use report::{Part, Report, Section, Table};

/// A chapter of the report.
type Chapter = fn(&displays::Bench<'_>) -> Result<Vec<Section>, ReproductionError>;

/// The chapters, in order; they take about equally long.
const CHAPTERS: [Chapter; 5] = [
    bumps::sections,
    |bench| Ok(vec![chapter_2::phase_functions(), dipoles::section(bench)?]),
    chapter_3::sections,
    chapter_4::sections,
    chapter_5::sections,
];

/// Computes the report, and writes its scenarios to `folder`, where they can be run with `papilio run`. The
/// progress is that of the whole.
///
/// # Errors
/// If files cannot be written, or the computation was stopped.
pub fn reproduce(folder: &Path, control: &Control<'_>) -> Result<Report, ReproductionError> {
    let of_chapters = Control { progress: &|_| {}, ..*control };
    let bench = displays::Bench::new(folder, &of_chapters)?;
    let mut sections = Vec::new();
    for (done, chapter) in CHAPTERS.iter().enumerate() {
        (control.progress)(Progress { unit: "chapters", ..Progress::of_views(done, CHAPTERS.len()) });
        sections.extend(chapter(&bench)?);
    }
    let mut report = Report {
        title: "Feng 2012, reproduced".to_owned(),
        about: [
            "Z. Feng, Light Transport Simulation in Reflective Displays, PhD thesis, Texas Tech University, 2012: its \
             tables and figures, computed by Papilio. Every number under \u{201c}here\u{201d} was computed for this page; \
             numbers under \u{201c}thesis\u{201d} are as printed.",
            "The thesis's display and its files are not public. Here they are replaced by the reference pixel, an \
             interferometric film stack fitted to the peaks and colours of the thesis's bare panel, behind diffusers of the \
             same haze (76 to 81 %), and by synthetic measurements of these. Bare panels should therefore agree in numbers, \
             and diffused panels qualitatively. Apart from that fit of the pixel, nothing was adjusted to improve the agreement.",
            "The scenarios are in the folder scenarios next to this page: papilio run scenarios/overcast.toml.",
        ]
        .map(str::to_owned)
        .to_vec(),
        sections,
    };
    report.sections.insert(0, report.summary());
    Ok(report)
}
