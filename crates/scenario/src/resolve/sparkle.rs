//! `[sparkle]`: the antiglare face.

use papilio_diagnostics::Diagnostic;
use papilio_display::scene::{self, Distribution, Interface, Ready, Scene};
use papilio_display::spatial::{Antiglare, Face};
use papilio_optics::RandomFace;

use super::rough::slopes;
use super::{FaceHeights, KnownFace, Resolver};
use crate::describe::File;
use crate::describe::layers::{Layer, Rough};
use crate::describe::sparkle::{CorrelationLengths, FaceGaps, Sparkle};
use crate::mistake::{self, Mistake};
use crate::origin::Origin;
use crate::read::{Read as _, Spanned};
use crate::tree::Node;

/// Wavelength of the index from which a haze gives the slope, nm.
const INDEX_NM: f64 = 555.0;

impl Resolver<'_> {
    /// Resolves the antiglare face: that of `[sparkle]`, or a layer whose heights are known; `None` if
    /// neither is described.
    pub(super) fn sparkle(&mut self, file: &File, scene: &Scene) -> Option<Antiglare> {
        let face = self.known_face(file, scene);
        let table = file.sparkle.value.as_ref();
        if table.is_none() && face.is_none() {
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
        let (faces, layer) = match face {
            Some((face, layer)) if !own => match face.heights {
                FaceHeights::Gaussian { slope_rms, correlation_um } => {
                    let lengths = self.correlation(table)?.unwrap_or_else(|| vec![correlation_um]);
                    (gaussian(slope_rms, lengths), layer)
                }
                FaceHeights::Surface(relief) => {
                    if table.correlation_um.is_some() {
                        let wrong = Diagnostic::new("`correlation_um` cannot change the heights of the surface in this display")
                            .hint("remove it, or add `slope_rms`: both describe a Gaussian face, which then takes the place of the surface");
                        self.err(&table.correlation_um, wrong);
                        return None;
                    }
                    (vec![Face::Relief(relief)], layer)
                }
            },
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
                (gaussian(slope_rms, lengths), scene.display.surface())
            }
        };
        Some(Antiglare {
            faces,
            gap_mm,
            layer,
            pupil_mm: table.pupil_mm.0,
            replicates: table.replicates.0 as usize,
            has_target: file.solver.relative_error.origin != Origin::FILE,
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
                let index = &scene.display.layers[scene.display.surface()].medium.index;
                let nm = self.grid.wavelengths_nm();
                let nearest = (0..nm.len())
                    .min_by(|a, b| (nm[*a] - INDEX_NM).abs().total_cmp(&(nm[*b] - INDEX_NM).abs()));
                let slopes = RandomFace::slopes_from_haze(haze.0, index[nearest?]);
                if let Some([tail, gaussian]) = slopes {
                    self.notes.push(format!(
                        "sparkle.haze = {}: the slope of the face is {gaussian:.4} along one axis if its slopes are Gaussian, as assumed; \
                         with the longest tail of etched glass (GGX), the same haze has the mean slope of a Gaussian face of {tail:.4}: \
                         sparkle.slope_rms = {tail:.4} computes this end of the range, and a measured `slope_rms` decides",
                        haze.0
                    ));
                }
                let slope = slopes.map(|[_, gaussian]| gaussian);
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

    /// Returns the layer whose heights are known, with its number in the scene: a rough one with
    /// `correlation_um`, or else the only surface by its geometry.
    fn known_face(&mut self, file: &File, scene: &Scene) -> Option<(KnownFace, usize)> {
        let Some(layers) = file.display.layers.as_deref() else {
            // In the short form only the diffuser can have known heights.
            let (_, face) = self.known_faces.first()?;
            return Some((face.clone(), scene.display.surface()));
        };
        let (mut rough, mut surfaces) = (Vec::new(), Vec::new());
        for (number, layer) in layers.iter().enumerate() {
            match &layer.value {
                Layer::Rough(one) => rough.extend(self.rough_face(one)?.map(|face| (number, face))),
                Layer::Diffuser(_) => {
                    let key = format!("display.layers.{number}");
                    let face = self.known_faces.iter().find(|(of, _)| *of == key);
                    surfaces.extend(face.map(|(_, face)| (number, face.clone())));
                }
                _ => {}
            }
        }
        if let [_, (_, second), ..] = &rough[..] {
            let wrong = Diagnostic::new("more than one rough layer has a `correlation_um`");
            self.errors.push(second.origin, wrong.hint("sparkle is that of one face: remove one of them"));
            return None;
        }
        // Surfaces by their geometry have heights whether or not anybody asks for sparkle: of several, none
        // is preferred.
        let (number, face) = match (&rough[..], &surfaces[..]) {
            ([one], _) | ([], [one]) => one.clone(),
            _ => return None,
        };
        // Media without an interface above them have one in the scene: the face is found as the same among
        // those of its kind.
        let is_rough = matches!(layers[number].value, Layer::Rough(_));
        let in_file = |layer: &&Spanned<Layer>| match layer.value {
            Layer::Rough(_) => is_rough,
            Layer::Diffuser(_) => !is_rough,
            _ => false,
        };
        let in_scene = |layer: &scene::Layer| match &layer.interface {
            Interface::Rough { .. } | Interface::Ready(Ready::Rough(_)) => is_rough,
            Interface::Ready(
                Ready::Diffuser(_) | Ready::Reflecting(_) | Ready::Scatter(_) | Ready::Wave(_),
            )
            | Interface::OfSurface(_) => !is_rough,
            _ => false,
        };
        let before = layers[..number].iter().filter(in_file).count();
        let mut faces = scene.display.layers.iter().enumerate().filter(|(_, layer)| in_scene(layer));
        faces.nth(before).map(|(number, _)| (face, number))
    }

    /// The face of a rough layer; the inner `None` if its correlation length is not known.
    fn rough_face(&mut self, rough: &Rough) -> Option<Option<KnownFace>> {
        let Some(length) = &rough.correlation_um.value else { return Some(None) };
        // What is wrong with its slopes is an error of the layer.
        let Ok((alpha, distribution)) = slopes(rough, rough.correlation_um.origin) else { return Some(None) };
        if distribution != Distribution::Beckmann {
            let wrong = Diagnostic::new(
                "`correlation_um` describes a face with Gaussian heights, whose slopes are Gaussian",
            );
            let wrong = wrong.expected("distribution = \"beckmann\"");
            self.err(
                &rough.correlation_um,
                wrong.hint("add distribution = \"beckmann\", or remove `correlation_um`"),
            );
            return None;
        }
        let slope_rms = alpha / std::f64::consts::SQRT_2;
        let heights = FaceHeights::Gaussian { slope_rms, correlation_um: length.0 };
        Some(Some(KnownFace { origin: rough.correlation_um.origin, heights }))
    }
}

/// Gaussian faces of these correlation lengths, um.
fn gaussian(slope_rms: f64, correlation_um: Vec<f64>) -> Vec<Face> {
    let face = |length| Face::Gaussian(RandomFace { slope_rms, correlation_mm: 1e-3 * length });
    correlation_um.into_iter().map(face).collect()
}

/// Adds why the slope and the correlation length of a face are not guessed.
fn with_reason(mut wrong: Mistake) -> Mistake {
    let why = "sparkle depends on the slope of the face and on its correlation length; a gloss number such as AG120 determines \
               neither, and haze does not determine the correlation length: it is read from a profile";
    wrong.diagnostic = wrong.diagnostic.note(why);
    wrong
}
