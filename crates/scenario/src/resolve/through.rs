//! Reflectances that were measured through a flat face: those of the pixel below it. How far light spreads
//! within the pixel.

use papilio_diagnostics::Diagnostic;
use papilio_optics::saunderson::DiffuseFace;
use papilio_spectra::Spectrum;

use super::Resolver;
use crate::describe::pixel::{MeasuredThrough, SpecularComponent, SpreadWithin};
use crate::mistake::tidy;
use crate::origin::Origin;
use crate::read::Spanned;

/// Angle at which instruments with a sphere see the sample, degrees.
const VIEW_DEG: f64 = 8.0;
/// Millimetres in a micrometre.
const MM_PER_UM: f64 = 1e-3;
/// Rounding of values in files.
const ROUNDING: f64 = 1e-9;

impl Resolver<'_> {
    /// Resolves the face through which values were measured, and notes its reflectances.
    pub(super) fn face(&mut self, through: &Spanned<Option<MeasuredThrough>>) -> Option<DiffuseFace> {
        let through = through.as_ref()?;
        let face = DiffuseFace::new(through.index.0, VIEW_DEG);
        let face = match through.specular.value {
            SpecularComponent::Included => face,
            SpecularComponent::Excluded => face.without_specular(),
        };
        let [view, outside, inside] = [face.view(), face.external(), face.internal()].map(four_digits);
        self.notes.push(format!(
            "display.pixel.measured_through: a face of index {} reflects {view} at {VIEW_DEG} deg, {outside} of diffuse light from outside and \
             {inside} from inside; the reflectances below it are used",
            tidy(through.index.0)
        ));
        Some(face)
    }

    /// Recovers the reflectance of a state from its measured one; `at` is the place of that.
    pub(super) fn below(
        &mut self,
        face: Option<DiffuseFace>,
        (state, measured): (&str, Spectrum),
        at: Origin,
    ) -> Option<Spectrum> {
        let Some(face) = face else { return Some(measured) };
        let fits = |value: &f64| (face.least() - ROUNDING..=face.most() + ROUNDING).contains(value);
        if let Some(bin) = measured.iter().position(|value| !fits(value)) {
            let (value, nm) = (measured[bin], self.grid.wavelengths_nm()[bin]);
            self.errors
                .push(at, impossible(&format!("{} at {nm} nm", four_digits(value)), value, state, face));
            return None;
        }
        Some(measured.map(|value| face.own(value).clamp(0.0, 1.0)))
    }

    /// Resolves how far light spreads within a Lambertian pixel, mm.
    pub(super) fn spread_within(&mut self, spread: &Spanned<Option<SpreadWithin>>) -> Option<f64> {
        match &spread.value {
            None => Some(0.0),
            Some(SpreadWithin::Radius(radius)) => Some(radius.0 * MM_PER_UM),
            Some(SpreadWithin::Slab(_)) => {
                let wrong = Diagnostic::new("the spread of a slab is not computed for a pixel that is given by its reflectance")
                    .expected("a length in um")
                    .note("a reflectance alone does not say how far light spreads: two slabs of the same reflectance may spread it differently")
                    .hint(
                        "describe the slab as a layer, [[display.layers]] with kind = \"slab\" and its thickness_mm, above its ground: `papilio \
                         mtf` computes where its light leaves, by the Monte Carlo solver",
                    );
                self.err(spread, wrong);
                None
            }
        }
    }
}

/// Error: a value that no reflector below the face has.
pub(super) fn impossible(value: &str, number: f64, state: &str, face: DiffuseFace) -> Diagnostic {
    let (least, most) = (four_digits(face.least()), four_digits(face.most()));
    let wrong =
        Diagnostic::new(format!("state `{state}` has {value}, which no measurement through this face gives"))
            .expected(format!(
                "{least} to {most}: what is seen of a black and of a perfect white reflector below it"
            ));
    if number < face.least() {
        return wrong.hint(
            "if the instrument excluded the specular component, add specular = \"excluded\" to measured_through; else check its index",
        );
    }
    wrong.hint("check the scale of the values: fractions, not per cent, relative to a perfect white")
}

fn four_digits(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}
