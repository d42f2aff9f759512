//! Mistakes in files of surfaces.

use papilio_diagnostics::Diagnostic;

use super::MOST_HEIGHTS;
use crate::error::Problem;

/// The errors of a map of heights, in addition to those of any data file.
#[derive(Debug, Clone, PartialEq)]
pub enum SurfaceProblem {
    /// The file has no known format.
    NotAMap,
    /// The file has a known format that is not read.
    Unsupported {
        /// Name of the format, with its article.
        format: String,
        /// What to export instead.
        export: &'static str,
    },
    /// The file is not the kernel of a face.
    NotAFace,
    /// The file has no triangles that can be read.
    NotAMesh {
        /// Why.
        what: String,
    },
    /// An unsupported size.
    Size {
        /// Heights along x.
        columns: usize,
        /// Heights along y.
        rows: usize,
    },
    /// Heights that are missing.
    Holes {
        /// Their number.
        holes: usize,
        /// Number of all heights.
        of: usize,
        /// The number that marks them, if it is a usual one that the file does not declare.
        marker: Option<f64>,
    },
    /// The file contradicts its format.
    Damaged {
        /// The format.
        format: &'static str,
        /// What is wrong.
        what: String,
    },
    /// Something in a text that is not understood.
    Text {
        /// What is wrong.
        what: String,
        /// What was expected.
        expected: &'static str,
    },
}

impl SurfaceProblem {
    /// Returns what is wrong, what was expected and what to do, in words.
    pub fn diagnostic(&self) -> Diagnostic {
        match self {
            Self::NotAMap => Diagnostic::new("this is not a map of heights in a supported format")
                .expected(
                    "SDF of ISO 25178-71 or BCR, X3P of ISO 25178-72, .sur, .gsf, .opd, .plux, .vk4, .vk6, rows of numbers, points x, y, z on a grid, \
                     a .npy array of two dimensions, a grey PNG or TIFF of 16 bits or more, or OpenEXR",
                )
                .hint("export the map as SDF or X3P from the program of the instrument"),
            Self::Unsupported { format, export } => {
                Diagnostic::new(format!("this is {format}, which is not supported")).hint(*export)
            }
            Self::NotAFace => Diagnostic::new("this is not the kernel of a face")
                .expected("face.npz, which `papilio gonio` writes"),
            Self::NotAMesh { what } => {
                Diagnostic::new(format!("this is not a mesh in a supported format: {what}"))
                    .expected("a Wavefront OBJ file, or an STL file in text or binary")
            }
            Self::Size { columns, rows } => Diagnostic::new(format!("this map has {columns} x {rows} heights"))
                .expected(format!("at least 2 x 2, and at most {MOST_HEIGHTS} in all"))
                .hint("cut out a part of the map, or reduce its resolution"),
            Self::Holes { holes, of, marker } => {
                let marked = marker.map_or(String::new(), |marker| {
                    format!(": they are {marker}, a usual mark of missing heights far from all others")
                });
                Diagnostic::new(format!("{holes} of {of} heights are missing{marked}"))
                    .expected("a map without holes")
                    .hint("fill them in the program of the instrument, which knows why they are missing, or cut out a part without holes")
            }
            Self::Damaged { format, what } => {
                Diagnostic::new(format!("this {format} file cannot be used: {what}"))
            }
            Self::Text { what, expected } => Diagnostic::new(what.clone()).expected(*expected),
        }
    }
}

impl From<SurfaceProblem> for Problem {
    fn from(problem: SurfaceProblem) -> Self {
        Self::Surface(Box::new(problem))
    }
}
