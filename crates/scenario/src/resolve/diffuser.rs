//! Diffusers given by their BTDF: lobes, kernels and transmittances.

use papilio_diagnostics::Diagnostic;
use papilio_display::scene::{Diffuser, Lobe, Ready, ScatterFace, ScatterKernel};
use papilio_optics::lobe::{largest_haze, width_from_haze};
use papilio_optics::scatter::{self, Normalisation, Scatter};
use papilio_spectra::Spectrum;

use super::Resolver;
use super::layers::{Neighbours, Part};
use crate::describe::diffuser::{Btdf, KCorrelation, Lambertian, Ward};
use crate::describe::display::ShareSpectrum;
use crate::describe::numbers::{NARROWEST_LOBE, Share};
use crate::mistake;
use crate::origin::Origin;
use crate::read::Spanned;

/// Largest haze in the scope of ASTM D1003.
const HAZE_SCOPE: f64 = 0.30;

/// Keys that all BTDFs have in addition to their lobe.
struct BtdfTransmittance<'a> {
    transmittance: &'a Spanned<Option<ShareSpectrum>>,
    total_transmittance: &'a Spanned<Option<ShareSpectrum>>,
    regular_fraction: &'a Spanned<Share>,
}

/// Converts a scattering given by its BSDF to an interface.
pub(super) fn scattering(face: ScatterFace) -> Ready {
    Ready::Scatter(Box::new(face))
}

/// Returns Ward's lobe for rho = 1; `None` if alpha is out of range, which its key excludes.
pub(super) fn ward_kernel(alpha: f64, normalisation: Normalisation) -> Option<Scatter> {
    scatter::Ward::new(alpha, normalisation).ok().map(Scatter::from)
}

impl Resolver<'_> {
    /// Resolves a diffuser between these media: its interface, and what is between a mounted foil and the
    /// medium below it.
    pub(super) fn btdf(&mut self, path: &str, diffuser: &Btdf, media: Neighbours<'_>) -> Option<Vec<Part>> {
        let (through, reflection) = match diffuser {
            Btdf::KCorrelation(lobe) => (self.k_correlation(lobe).map(Ready::Diffuser), &lobe.reflection),
            Btdf::Lambertian(lobe) => (self.lambertian(lobe).map(Ready::Diffuser), &lobe.reflection),
            Btdf::Ward(ward) => (self.ward(path, ward).map(scattering), &ward.reflection),
            Btdf::Measured(foil) => return self.foil(path, foil, media.below),
            Btdf::Microgeometry(face) => {
                let below = media.below.unwrap_or(media.above);
                return Some(vec![Part::Interface(self.microgeometry(path, face, [media.above, below])?)]);
            }
        };
        Some(vec![Part::Interface(self.with_reflection(path, through?, reflection)?)])
    }

    pub(super) fn ward(&mut self, path: &str, ward: &Spanned<Ward>) -> Option<ScatterFace> {
        let (scatter, transmittance) = self.ward_lobe(ward)?;
        self.unbounded_transmission(path, &scatter, &transmittance, ward.regular_fraction.0);
        Some(transmitting_face(scatter, &transmittance, ward.regular_fraction.0))
    }

    /// Returns the lobe and its factor, including the regular part.
    pub(super) fn ward_lobe(&mut self, ward: &Spanned<Ward>) -> Option<(Scatter, Spectrum)> {
        let Ward { alpha, normalisation, transmittance, total_transmittance, regular_fraction, .. } =
            &ward.value;
        let scatter = ward_kernel(alpha.value.0, normalisation.0)?;
        let whole = BtdfTransmittance { transmittance, total_transmittance, regular_fraction };
        let causes = [alpha.origin, ward.origin, ward.origin];
        let transmittance = self.transmittance(Some(scatter.albedo_at(0.0)), &whole, causes)?;
        Some((scatter, transmittance))
    }

    pub(super) fn k_correlation(&mut self, diffuser: &Spanned<KCorrelation>) -> Option<Diffuser> {
        let lobe = self.lobe(diffuser);
        let KCorrelation { transmittance, total_transmittance, regular_fraction, .. } = &diffuser.value;
        let whole = BtdfTransmittance { transmittance, total_transmittance, regular_fraction };
        let causes = [diffuser.width.origin, diffuser.haze.origin, diffuser.origin];
        self.transmitting(lobe, &whole, causes)
    }

    pub(super) fn lambertian(&mut self, diffuser: &Spanned<Lambertian>) -> Option<Diffuser> {
        let Lambertian { transmittance, total_transmittance, regular_fraction, .. } = &diffuser.value;
        let whole = BtdfTransmittance { transmittance, total_transmittance, regular_fraction };
        self.transmitting(Some(Lobe::Lambertian), &whole, [diffuser.origin; 3])
    }

    /// Returns a k-correlation lobe from its width or its haze; the place of `diffuser` is that of its model.
    fn lobe(&mut self, diffuser: &Spanned<KCorrelation>) -> Option<Lobe> {
        match (diffuser.haze.value, diffuser.width.value) {
            (Some(haze), None) => self.lobe_from_haze(haze.0, diffuser),
            (None, Some(width)) => Some(Lobe::KCorrelation { width: width.0 }),
            (haze, _) => {
                let at = diffuser.width.origin.or_override([diffuser.haze.origin, diffuser.origin]);
                let given = if haze.is_some() { 2 } else { 0 };
                self.errors.push(at, mistake::exactly_one("`haze` and `width`", given));
                None
            }
        }
    }

    fn lobe_from_haze(&mut self, haze: f64, diffuser: &KCorrelation) -> Option<Lobe> {
        let regular_fraction = diffuser.regular_fraction.0;
        let width = width_from_haze(haze, regular_fraction).filter(|width| *width >= NARROWEST_LOBE);
        let Some(width) = width else {
            let at = diffuser.haze.origin.or_override([diffuser.regular_fraction.origin]);
            self.errors.push(at, no_width(haze, ("regular_fraction", regular_fraction)));
            return None;
        };
        if haze > HAZE_SCOPE {
            self.notes.push(format!(
                "haze {haze} means a lobe of width {width:.5} (b, direction cosines); above 30 % haze is outside \
                 ASTM D1003's scope, see ASTM E2387"
            ));
        }
        Some(Lobe::KCorrelation { width })
    }

    /// Returns a diffuser with T from `transmittance` or from the total transmittance of a datasheet.
    fn transmitting(
        &mut self,
        lobe: Option<Lobe>,
        whole: &BtdfTransmittance<'_>,
        causes: [Origin; 3],
    ) -> Option<Diffuser> {
        let transmittance =
            self.transmittance(lobe.map(|lobe| lobe.hemispherical_fraction()), whole, causes)?;
        Some(Diffuser { lobe: lobe?, transmittance, regular_fraction: whole.regular_fraction.0 })
    }

    /// Returns T of a lobe; `leaving` is the fraction of the lobe that leaves at normal incidence.
    fn transmittance(
        &mut self,
        leaving: Option<f64>,
        whole: &BtdfTransmittance<'_>,
        causes: [Origin; 3],
    ) -> Option<Spectrum> {
        let regular_fraction = whole.regular_fraction.0;
        let (spec, origin, share) = match (&whole.transmittance.value, &whole.total_transmittance.value) {
            (Some(spec), None) => (spec, whole.transmittance.origin, 1.0),
            (None, Some(spec)) => {
                let share = (1.0 - regular_fraction) * leaving? + regular_fraction;
                (spec, whole.total_transmittance.origin, share)
            }
            (given, _) => {
                let given = if given.is_some() { 2 } else { 0 };
                let keys = "`transmittance` and `total_transmittance`";
                let at = whole.transmittance.origin.or_override([whole.total_transmittance.origin]);
                self.errors.push(at, mistake::exactly_one(keys, given));
                return None;
            }
        };
        let transmittance: Spectrum = self.share(spec, origin)?.map(|t| t / share);
        let largest = transmittance.max();
        if largest > 1.0 + 1e-12 {
            let at = origin.or_override(causes).or_override([whole.regular_fraction.origin]);
            // Rounded down, so that the number of the hint is accepted.
            let most = (share * 1e4).floor() / 1e4;
            let total = largest * share;
            let wrong = Diagnostic::new(format!("a lobe this wide cannot transmit {total:.4} of the light into the hemisphere"))
                .expected(format!("total_transmittance of at most {most:.4}"))
                .hint(
                    "a wider lobe (more haze) sends more of its light beyond the hemisphere, where it is lost: reduce the haze or width, \
                     or total_transmittance",
                )
                .accepted(most);
            self.errors.push(at, wrong);
            return None;
        }
        Some(transmittance.map(|t| t.min(1.0)))
    }
}

/// Error: no k-correlation lobe has this haze with this regular fraction, whose key is given, too.
pub(super) fn no_width(haze: f64, (key, regular_fraction): (&str, f64)) -> Diagnostic {
    let limit = (largest_haze(regular_fraction) * 1e4).floor() / 1e4;
    let lobe = "no k-correlation lobe has a haze of";
    let wrong = Diagnostic::new(format!("{lobe} {haze} with {key} = {regular_fraction}"));
    if limit <= 0.0 {
        wrong.hint("regular transmission is not haze")
    } else if haze < limit {
        wrong.hint("this haze is too small: give a larger one, or remove the diffuser")
    } else {
        let hint = format!("haze can be {limit} at most: a wider lobe loses its light beyond the hemisphere");
        wrong.hint(hint).accepted(limit)
    }
}

/// Returns an interface with this transmission and regular fraction, and without reflection.
pub(super) fn transmitting_face(
    scatter: Scatter,
    transmittance: &Spectrum,
    regular_fraction: f64,
) -> ScatterFace {
    let factor = transmittance.map(|t| t * (1.0 - regular_fraction));
    ScatterFace::new(transmittance.map(|t| t * regular_fraction))
        .with_transmission(ScatterKernel { scatter, factor })
}
