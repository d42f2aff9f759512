//! `surface = "psd"`: a power spectral density by three numbers or by a table.

use std::collections::BTreeMap;

use papilio_diagnostics::Diagnostic;
use papilio_formats::read_density;
use papilio_microgeometry::Spectrum;

use super::SurfaceScenario;
use crate::describe::microgeometry::Psd;
use crate::error::Errors;
use crate::read::Spanned;

impl SurfaceScenario {
    /// The density of a face.
    pub(super) fn spectrum(
        &self,
        face: &Spanned<Psd>,
        errors: &mut Errors,
        inputs: &mut BTreeMap<String, String>,
    ) -> Option<Spectrum> {
        let cutoff_um = face.cutoff_um.0;
        match (&face.abc.value, &face.file.value) {
            (Some(list), None) => {
                let abc: Vec<f64> = list.iter().map(|number| number.0).collect();
                let Ok(abc) = <[f64; 3]>::try_from(abc) else {
                    let wrong = Diagnostic::new(format!("this list has {} numbers", list.len()))
                        .expected("three numbers: A (um^4), B (um) and C");
                    errors.push(face.abc.origin, wrong);
                    return None;
                };
                Some(Spectrum::Abc { abc, cutoff_um })
            }
            (None, Some(name)) => {
                let file = Spanned { value: name.clone(), origin: face.file.origin };
                let kept = self.open(&file, errors, inputs)?;
                match read_density(kept.file()) {
                    Ok(points) => Some(Spectrum::Table { points, cutoff_um }),
                    Err(error) => {
                        errors.push_data(file.origin, error);
                        None
                    }
                }
            }
            (abc, _) => {
                let wrong = if abc.is_some() {
                    "both `abc` and `file` are given"
                } else {
                    "neither `abc` nor `file` is given"
                };
                let wrong = Diagnostic::new(wrong)
                    .expected("`abc`, three numbers, or `file`, a table of frequency and density");
                errors.push(face.origin, wrong);
                None
            }
        }
    }
}
