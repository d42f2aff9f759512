//! `[microgeometry.coating]`: what lies on the facets of a surface.

use std::collections::BTreeMap;

use num_complex::Complex64;
use papilio_diagnostics::Diagnostic;
use papilio_formats::read_index_within;
use papilio_microgeometry::Coating;
use papilio_optics::film::Layer;
use papilio_spectra::{Dispersion, SpectraError, material};

use super::{Common, SurfaceScenario};
use crate::describe::display::{IndexOf, MaterialSpec};
use crate::describe::microgeometry::{FaceCoating, Road};
use crate::error::Errors;
use crate::here::looks_like_path;
use crate::mistake;
use crate::read::Spanned;

/// Most films of a coating.
const MOST_FILMS: usize = 256;

impl SurfaceScenario {
    /// Resolves what lies on the facets.
    pub(super) fn coating(
        &self,
        common: &Common<'_>,
        errors: &mut Errors,
        inputs: &mut BTreeMap<String, String>,
    ) -> Option<Coating> {
        let Some((described, at)) = common.coating else { return Some(Coating::None) };
        if common.road != Road::Rays {
            let wrong = Diagnostic::new("waves do not know what lies on the facets")
                .expected("`road = \"rays\"` with a coating");
            errors.push(common.road_at.or_override([at]), wrong);
            return None;
        }
        match described {
            FaceCoating::Mirror(mirror) => Some(Coating::Mirror { reflectance: mirror.reflectance.0 }),
            FaceCoating::Metal(metal) => {
                let index = self.index_at(&metal.material, metal.wavelength_nm.0, errors, inputs)?;
                if index.im <= 0.0 {
                    let wrong = Diagnostic::new(format!(
                        "the index {} + {}i is not that of a metal",
                        index.re, index.im
                    ))
                    .expected("an extinction coefficient k above 0, which makes it opaque")
                    .hint("{ n = 0.06, k = 3.6 }, or \"Al\"; thin layers are `kind = \"film\"`");
                    errors.push(metal.material.origin, wrong);
                    return None;
                }
                Some(Coating::Metal { index })
            }
            FaceCoating::Film(films) => {
                let count = films.film.len();
                if !(1..=MOST_FILMS).contains(&count) {
                    let wrong = Diagnostic::new(format!("this coating has {count} films"))
                        .expected(format!("1 to {MOST_FILMS} of them"));
                    errors.push(films.film.origin, wrong);
                    return None;
                }
                let nm = films.wavelength_nm.0;
                let layers: Vec<Option<Layer>> = films
                    .film
                    .iter()
                    .map(|film| {
                        let index = self.index_at(&film.material, nm, errors, inputs)?;
                        Some(Layer { index, thickness_nm: film.thickness_nm.0 })
                    })
                    .collect();
                let layers: Vec<Layer> = layers.into_iter().collect::<Option<_>>()?;
                match Coating::films(common.index, &layers, nm) {
                    Ok(coating) => Some(coating),
                    Err(wrong) => {
                        errors.push(films.film.origin, Diagnostic::new(wrong.to_string()));
                        None
                    }
                }
            }
        }
    }

    /// n + ik of a material at a wavelength.
    fn index_at(
        &self,
        spec: &Spanned<MaterialSpec>,
        nm: f64,
        errors: &mut Errors,
        inputs: &mut BTreeMap<String, String>,
    ) -> Option<Complex64> {
        let (name, dispersion) = match &spec.value {
            MaterialSpec::Number(n) => ("the index", Dispersion::constant(n.0, 0.0)),
            MaterialSpec::Complex(table) => match table.index_of() {
                Ok(IndexOf::Constant { n, k }) => ("the index", Dispersion::constant(n, k)),
                Ok(IndexOf::Material(name)) => (name, material(name)),
                Err(wrong) => {
                    errors.push(spec.origin, *wrong);
                    return None;
                }
            },
            MaterialSpec::Model(model) => ("the index", Ok(Dispersion::model(model.model()))),
            MaterialSpec::Text(name) => (name.as_str(), material(name)),
        };
        let dispersion = match dispersion {
            Err(SpectraError::UnknownName { .. }) if looks_like_path(name) || self.library.has(name) => {
                let file = Spanned { value: name.to_owned(), origin: spec.origin };
                let kept = self.open(&file, errors, inputs)?;
                match read_index_within(kept.file(), (nm, nm)) {
                    Ok(read) => Ok(read.value),
                    Err(error) => {
                        errors.push_data(spec.origin, error);
                        return None;
                    }
                }
            }
            Err(SpectraError::UnknownName { .. }) => {
                errors.push(spec.origin, mistake::unknown_material(name));
                return None;
            }
            other => other,
        };
        match dispersion.and_then(|dispersion| dispersion.index(nm)) {
            Ok(index) => {
                return Some(match &spec.value {
                    MaterialSpec::Complex(table) => table.scaled(index),
                    MaterialSpec::Number(_) | MaterialSpec::Text(_) | MaterialSpec::Model(_) => index,
                });
            }
            Err(SpectraError::OutsideTable { first, last, .. }) => {
                errors.push(spec.origin, mistake::not_covered(name, (first, last), (nm, nm), 0.0));
            }
            Err(error) => errors.push(spec.origin, error),
        }
        None
    }
}
