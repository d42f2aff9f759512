//! `[sparkle]`: the antiglare face.

use papilio_diagnostics::Diagnostic;
use papilio_display::scene::{self, Interface, Layers, Ready, Scene};
use papilio_display::spatial::Antiglare;
use papilio_optics::RandomFace;

use super::Resolver;
use crate::describe::File;
use crate::describe::layers::{Layer, Rough, Slopes};
use crate::describe::sparkle::{CorrelationLengths, FaceGaps, Sparkle};
use crate::mistake::{self, Mistake};
use crate::origin::Origin;
use crate::read::{Read as _, Spanned};
use crate::tree::Node;

/// Wavelength of the index from which a haze gives the slope, nm.
const INDEX_NM: f64 = 555.0;

impl Resolver<'_> {
    /// Resolves the antiglare face: that of `[sparkle]`, or a rough layer whose correlation length is known; `None` if neither is
    /// described.
    pub(super) fn sparkle(&mut self, file: &File, scene: &Scene) -> Option<Antiglare> {
        let rough = self.rough_face(file, scene);
        let table = file.sparkle.value.as_ref();
        if table.is_none() && rough.is_none() {
            return None;
        }
        let defaults;
        let table = match table {
            Some(table) => table,
            None => {
                defaults = Sparkle::read(&Node::empty_table(), &mut self.errors)?;
                &defaults
            }
        };
        let at = file.sparkle.origin;
        let own = table.slope_rms.value.is_some() || table.haze.value.is_some();
        let gap_mm = match &table.gap_mm.value {
            None => Vec::new(),
            Some(FaceGaps::One(gap)) => vec![gap.0],
            Some(FaceGaps::List(list)) => self.listed(list, |gap| gap.0, table.gap_mm.origin)?,
        };
        let (slope_rms, correlation_um, layer) = match rough {
            Some((rough, layer)) if !own => {
                let alone = rough.correlation_um.value.as_ref().map(|length| vec![length.0]);
                (rough.alpha.0 / std::f64::consts::SQRT_2, self.correlation(table)?.or(alone)?, layer)
            }
            _ => {
                let slope_rms = self.slope(table, at, scene)?;
                let Some(lengths) = self.correlation(table)? else {
                    let wrong = mistake::missing_key(
                        "correlation_um",
                        "the correlation length of the face, um, or a list",
                    );
                    self.errors.push(at, with_reason(wrong));
                    return None;
                };
                (slope_rms, lengths, 0)
            }
        };
        Some(Antiglare {
            slope_rms,
            correlation_mm: correlation_um.into_iter().map(|length| 1e-3 * length).collect(),
            gap_mm,
            layer,
            pupil_mm: table.pupil_mm.0,
            replicates: table.replicates.0 as usize,
        })
    }

    /// Returns the correlation lengths of the table, um; the inner `None` if it has none.
    fn correlation(&mut self, table: &Sparkle) -> Option<Option<Vec<f64>>> {
        Some(match &table.correlation_um.value {
            None => None,
            Some(CorrelationLengths::One(length)) => Some(vec![length.0]),
            Some(CorrelationLengths::List(list)) => {
                Some(self.listed(list, |length| length.0, table.correlation_um.origin)?)
            }
        })
    }

    /// Returns the slope of the face.
    fn slope(&mut self, table: &Sparkle, at: Origin, scene: &Scene) -> Option<f64> {
        match (&table.slope_rms.value, &table.haze.value) {
            (Some(slope), None) => Some(slope.0),
            (None, Some(haze)) => {
                let index = match &scene.display.layers {
                    Layers::Panel(panel) => &panel.glass.index,
                    Layers::General(layers) => &layers[0].medium.index,
                };
                let nm = self.grid.wavelengths_nm();
                let nearest = (0..nm.len())
                    .min_by(|a, b| (nm[*a] - INDEX_NM).abs().total_cmp(&(nm[*b] - INDEX_NM).abs()));
                let slope = RandomFace::slope_rms_from_haze(haze.0, index[nearest?]);
                if slope.is_none() {
                    let wrong = Diagnostic::new(
                        "the medium below the face has the index of air: a face there has no haze",
                    );
                    self.err(&table.haze, wrong.expected("an index above 1"));
                }
                slope
            }
            (None, None) => {
                let wrong = mistake::missing_key(
                    "slope_rms",
                    "the root mean square slope of the face along one axis, or `haze`",
                );
                self.errors.push(at, with_reason(wrong));
                None
            }
            (Some(_), Some(_)) => {
                let at = table.haze.origin.or_override([table.slope_rms.origin]);
                self.errors.push(at, mistake::exactly_one("`slope_rms` and `haze`", 2));
                None
            }
        }
    }

    /// Returns the rough layer whose correlation length is known, with the number of its layer in the scene.
    fn rough_face<'f>(&mut self, file: &'f File, scene: &Scene) -> Option<(&'f Rough, usize)> {
        let Layers::General(resolved) = &scene.display.layers else { return None };
        let layers: &[Spanned<Layer>] = file.display.value.layers.value.as_deref()?;
        let known = |layer: &'f Spanned<Layer>| -> Option<&'f Rough> {
            match &layer.value {
                Layer::Rough(rough) if rough.correlation_um.value.is_some() => Some(rough),
                _ => None,
            }
        };
        let mut faces = layers.iter().enumerate().filter_map(|(number, layer)| Some((number, known(layer)?)));
        let (number, rough) = faces.next()?;
        if let Some((_, second)) = faces.next() {
            let wrong = Diagnostic::new("more than one rough layer has a `correlation_um`");
            self.err(&second.correlation_um, wrong.hint("sparkle is that of one face: remove one of them"));
            return None;
        }
        if *rough.distribution != Slopes::Beckmann {
            let wrong = Diagnostic::new(
                "`correlation_um` describes a face with Gaussian heights, whose slopes are not GGX",
            );
            let wrong = wrong.expected("distribution = \"beckmann\"");
            self.err(
                &rough.correlation_um,
                wrong.hint("add distribution = \"beckmann\", or remove `correlation_um`"),
            );
            return None;
        }
        // Media without an interface above them have one in the scene: the face is found as the same among the rough ones.
        let before = layers[..number].iter().filter(|layer| matches!(layer.value, Layer::Rough(_))).count();
        let is_rough = |layer: &scene::Layer| {
            matches!(layer.interface, Interface::Rough { .. } | Interface::Ready(Ready::Rough(_)))
        };
        let mut faces = resolved.iter().enumerate().filter(|(_, layer)| is_rough(layer));
        faces.nth(before).map(|(number, _)| (rough, number))
    }
}

/// Adds why the slope and the correlation length of a face are not guessed.
fn with_reason(mut wrong: Mistake) -> Mistake {
    let why = "sparkle depends on the slope of the face and on its correlation length; a gloss number such as AG120 determines \
               neither, and haze does not determine the correlation length: it is read from a profile";
    wrong.diagnostic = wrong.diagnostic.note(why);
    wrong
}
