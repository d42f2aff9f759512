//! `[[display.layers]]`, and the media of all displays.

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_diagnostics::{Diagnostic, number};
use papilio_display::THICKEST_FOR_MONTE_CARLO;
use papilio_display::scene::{
    Coating, Depolarisation, FilmLayer, Interface, Layer, Length, Medium, Method, Particles, Ready,
    Scattering, Thickness,
};
use papilio_spectra::Spectrum;

use super::Resolver;
use super::rough::slopes;
use super::stack::Stack;
use crate::describe::File;
use crate::describe::diffuser::{self, Btdf, Diffuser, Slab};
use crate::describe::display::{Display, MaterialSpec, ShareSpectrum};
use crate::describe::layers as describe;
use crate::describe::numbers;
use crate::mistake::{self, tidy};
use crate::origin::Origin;
use crate::read::{Read, Spanned};

/// Largest k of a clear medium.
const CLEAR_K: f64 = 1e-6;
/// Largest k of a medium that absorbs along its thickness; beyond it, Fresnel's equations need the complex
/// index.
const ABSORBING_K: f64 = 1e-3;
/// Largest number of layers.
const MOST_LAYERS: usize = 64;
/// Wavelength of the particles' scattering, um.
const PARTICLES_AT_UM: f64 = 0.55;
/// Nanometres in a millimetre.
const NM_PER_MM: f64 = 1e6;

/// Error: the index is not that of a transparent medium.
fn not_transparent(index: Complex64, nm: f64, largest_k: f64) -> Diagnostic {
    let Complex64 { re: n, im: k } = index;
    let wrong = Diagnostic::new(format!("the refractive index is {n} + {}i at {nm} nm", number(k)));
    let wrong = match k <= largest_k {
        true => wrong.expected("n from 1 to 10"),
        false => wrong.expected(format!("n from 1 to 10 and k below {largest_k:e}")),
    };
    let absorbs = (1.0..=10.0).contains(&n) && k > largest_k && k <= ABSORBING_K;
    wrong.hint_if(absorbs.then_some("specify `thickness_mm`: k then absorbs along the path"))
}

/// An entry of the list of layers.
pub(super) enum Part {
    /// A medium, its thickness, and the place of its index.
    Medium(Medium, Length, Origin),
    Interface(Interface),
}

/// A layer of the list that is resolved with the media next to it, or was resolved alone.
enum Resolved<'a> {
    Part(Part),
    /// A diffuser, which may depend on the media next to it.
    Diffuser(&'a Btdf),
}

/// Indices of the media next to an interface.
#[derive(Clone, Copy)]
pub(super) struct Neighbours<'a> {
    /// Of the medium above.
    pub(super) above: &'a Spectrum,
    /// Of the medium that is the next layer below; `None` if that is an interface or the pixel.
    pub(super) below: Option<&'a Spectrum>,
}

/// The media next to a layer of a list.
fn neighbours<'p>(parts: &'p [Resolved<'_>], at: usize, air: &'p Spectrum) -> Neighbours<'p> {
    let index = |part: &'p Resolved<'_>| match part {
        Resolved::Part(Part::Medium(medium, ..)) => Some(&medium.index),
        _ => None,
    };
    Neighbours {
        above: parts[..at].iter().rev().find_map(index).unwrap_or(air),
        below: parts.get(at + 1).and_then(index),
    }
}

/// Thickness of a medium whose key, should it be missing, is `thickness_mm` in the table at `path`.
pub(super) fn length(path: &str, thickness_mm: &Option<numbers::Thickness>) -> Length {
    match thickness_mm {
        Some(thickness) => Length::Mm(thickness.0),
        None => Length::Missing { key: format!("{path}.thickness_mm") },
    }
}

/// Place of an interface: that of its reflection, if it is described.
fn place_of(layer: &Spanned<describe::Layer>) -> Origin {
    match &layer.value {
        describe::Layer::Diffuser(diffuser) => match diffuser.reflection() {
            Some(reflection) if reflection.is_some() => reflection.origin,
            _ => layer.origin,
        },
        _ => layer.origin,
    }
}

/// Absorption of a medium: its internal transmittance, or its thickness.
type Absorption<'a> = (&'a Spanned<Option<ShareSpectrum>>, &'a Spanned<Option<numbers::Thickness>>);

impl Resolver<'_> {
    /// Resolves `[[display.layers]]`, which describes everything above the pixel.
    pub(super) fn layers(
        &mut self,
        display: &Spanned<Display>,
        layers: &[Spanned<describe::Layer>],
    ) -> Option<Vec<Layer>> {
        let beside = [
            ("front", display.front.is_some(), display.front.origin, "{ kind = \"component\", ... }"),
            (
                "diffuser",
                display.diffuser.is_some(),
                display.diffuser.origin,
                "{ kind = \"diffuser\", ... } or { kind = \"slab\", ... }",
            ),
            ("glass", display.glass.is_some(), display.glass.origin, "{ kind = \"medium\", index = 1.5 }"),
        ];
        for (key, _, at, layer) in beside.into_iter().filter(|(_, given, ..)| *given) {
            let wrong = "cannot be combined with `layers`, which describes everything above the pixel";
            let wrong = Diagnostic::new(format!("`{key}` {wrong}"))
                .hint(format!("replace it by a layer, {layer}, or remove it"));
            self.errors.push(at.or_override([display.layers.origin]), wrong);
        }
        if layers.is_empty() {
            self.err(&display.layers, mistake::empty_list());
            return None;
        }
        self.limit(&display.layers, "layers", layers.len(), MOST_LAYERS)?;
        let parts = layers.iter().enumerate();
        let parts: Vec<_> =
            parts.map(|(i, layer)| self.layer(&format!("display.layers.{i}"), layer, layer.origin)).collect();
        let parts = parts.into_iter().collect::<Option<Vec<_>>>()?;
        let parts = self.with_diffusers(parts)?;
        let mut stack = Stack::new(&self.grid);
        for (number, (parts, layer)) in parts.into_iter().zip(layers).enumerate() {
            stack.depolarise(match &layer.value {
                describe::Layer::Diffuser(diffuser) => Depolarisation {
                    fraction: diffuser.depolarisation(),
                    key: format!("display.layers.{number}.depolarisation"),
                },
                _ => Depolarisation::default(),
            });
            for part in parts {
                match part {
                    Part::Medium(medium, length, index_at) => stack.fill(medium, length, index_at),
                    Part::Interface(interface) => stack.put(interface, place_of(layer)),
                }
            }
        }
        self.note_coatings(layers);
        self.note_idle_faces(layers);
        Some(stack.finish(&mut self.errors))
    }

    /// Resolves the diffusers of a list, which may depend on the media next to them. Returns the parts of
    /// each layer.
    fn with_diffusers(&mut self, layers: Vec<Resolved<'_>>) -> Option<Vec<Vec<Part>>> {
        let air = Spectrum::constant(&self.grid, 1.0);
        let mut diffusers = Vec::new();
        for (i, layer) in layers.iter().enumerate() {
            if let Resolved::Diffuser(diffuser) = layer {
                let media = neighbours(&layers, i, &air);
                diffusers.push(self.btdf(&format!("display.layers.{i}"), diffuser, media)?);
            }
        }
        let mut diffusers = diffusers.into_iter();
        let parts = |layer| match layer {
            Resolved::Part(part) => Some(vec![part]),
            Resolved::Diffuser(_) => diffusers.next(),
        };
        layers.into_iter().map(parts).collect()
    }

    /// Notes each coating without a medium below it: it is inside the medium above, which is rarely intended.
    fn note_coatings(&mut self, layers: &[Spanned<describe::Layer>]) {
        let is_medium =
            |layer: &describe::Layer| matches!(layer, describe::Layer::Medium(_) | describe::Layer::Slab(_));
        let mut above = "the air";
        for (i, layer) in layers.iter().enumerate() {
            if is_medium(layer) {
                above = "the medium above it";
            }
            let on_nothing = layers.get(i + 1).is_none_or(|next| !is_medium(next));
            if matches!(layer.value, describe::Layer::Coating(_)) && on_nothing {
                self.notes.push(format!(
                    "display.layers.{i}: no medium follows this coating, so {above} is on both sides of it; on glass it \
                     would be followed by {{ kind = \"medium\", index = 1.5 }}"
                ));
            }
        }
    }

    /// Notes each bare face directly above a diffuser: the same medium is on both sides of it, so that it
    /// reflects nothing.
    fn note_idle_faces(&mut self, layers: &[Spanned<describe::Layer>]) {
        for (i, pair) in layers.windows(2).enumerate() {
            if let [describe::Layer::Fresnel(_), describe::Layer::Diffuser(_)] =
                [&pair[0].value, &pair[1].value]
            {
                self.notes.push(format!(
                    "display.layers.{i}: this face has no effect: a diffuser follows without a medium between them, so the same medium is \
                     on both sides of the face; a diffuser given by its lobe contains its own faces ([display.diffuser.reflection] gives it \
                     a reflection, and a medium below the face, {{ kind = \"medium\", index = 1.5 }}, makes it the face of a film)"
                ));
            }
        }
    }

    /// Resolves one layer, except for a diffuser; `path` is its key.
    fn layer<'l>(&mut self, path: &str, layer: &'l describe::Layer, at: Origin) -> Option<Resolved<'l>> {
        Some(Resolved::Part(match layer {
            describe::Layer::Medium(medium) => {
                let absorption = (&medium.internal_transmittance, &medium.thickness_mm);
                let length = length(path, &medium.thickness_mm);
                Part::Medium(self.medium(path, &medium.index, absorption)?, length, medium.index.origin)
            }
            describe::Layer::Slab(slab) => {
                Part::Medium(self.slab(path, slab, at)?, length(path, &slab.thickness_mm), slab.index.origin)
            }
            describe::Layer::Diffuser(diffuser) => return Some(Resolved::Diffuser(diffuser)),
            describe::Layer::Component(component) => {
                let component = self.component((&component.reflectance, &component.absorptance), at)?;
                Part::Interface(component)
            }
            describe::Layer::Coating(coating) => {
                let films = self.coating(path, coating)?;
                Part::Interface(Interface::Coating(Coating { films, key: path.to_owned() }))
            }
            describe::Layer::IdealAr(_) => Part::Interface(Ready::IdealAr.into()),
            describe::Layer::Fresnel(_) => Part::Interface(Ready::Fresnel.into()),
            describe::Layer::Rough(rough) => {
                let (alpha, distribution) = match slopes(rough, at) {
                    Ok(slopes) => slopes,
                    Err(wrong) => {
                        let (at, wrong) = *wrong;
                        self.errors.push(at, wrong);
                        return None;
                    }
                };
                Part::Interface(Interface::Rough { alpha, distribution })
            }
        }))
    }

    /// Resolves a medium without scattering.
    pub(super) fn medium(
        &mut self,
        path: &str,
        index: &Spanned<MaterialSpec>,
        (transmittance, thickness_mm): Absorption<'_>,
    ) -> Option<Medium> {
        let clear = transmittance.is_none() && thickness_mm.is_none();
        let index = self.transparent(index, if clear { CLEAR_K } else { ABSORBING_K })?;
        let transmittance = match (&transmittance.value, thickness_mm.value) {
            (Some(share), thickness) => {
                if thickness.is_some() {
                    let why = "`internal_transmittance` is the transmittance of this thickness";
                    self.note_length(path, why);
                }
                self.share(share, transmittance.origin)?
            }
            (None, Some(thickness)) => self.beer_lambert(path, &index, thickness.0),
            (None, None) => Spectrum::constant(&self.grid, 1.0),
        };
        let index = Spectrum::from_values(index.iter().map(|index| index.re).collect());
        Some(Medium { index, transmittance, scattering: None, particles: None })
    }

    /// Computes exp(-4 pi k d / wavelength) with k of `index`.
    fn beer_lambert(&mut self, path: &str, index: &[Complex64], thickness_mm: f64) -> Spectrum {
        if index.iter().all(|index| index.im == 0.0) {
            self.note_length(path, "the index has k = 0 at every wavelength");
        }
        let depth = 4.0 * PI * NM_PER_MM * thickness_mm;
        let transmittance = |(index, nm): (&Complex64, f64)| (-depth * index.im / nm).exp();
        Spectrum::from_values(index.iter().zip(self.grid.wavelengths_nm()).map(transmittance).collect())
    }

    /// Notes that a thickness does not change colours, unless it has another purpose.
    fn note_length(&mut self, path: &str, why: &str) {
        if !self.needs_lengths {
            self.notes.push(format!("{path}.thickness_mm has no effect on colours: {why}"));
        }
    }

    /// Resolves a slab of particles in a binder.
    pub(super) fn slab(&mut self, path: &str, slab: &Slab, at: Origin) -> Option<Medium> {
        let own = |value, origin| Spanned { value, origin };
        let binder = match (&slab.index.value, slab.faces.value) {
            (Some(_), false) => {
                let wrong =
                    Diagnostic::new("`index` is that between the faces of a slab, and this one has none")
                        .hint("remove `index`, or `faces = false`: scatterers in air have the index 1");
                self.errors.push(slab.index.origin.or_override([slab.faces.origin]), wrong);
                return None;
            }
            (None, false) => own(MaterialSpec::Number(numbers::Index(1.0)), slab.faces.origin),
            (None, true) => own(MaterialSpec::Number(numbers::Index(1.5)), slab.index.origin),
            (Some(index), true) => own(index.clone(), slab.index.origin),
        };
        let index = self.transparent(&binder, ABSORBING_K);
        let albedo = self.share(&slab.albedo.value, slab.albedo.origin);
        let (index, albedo) = (index?, albedo?);
        let n = Spectrum::from_values(index.iter().map(|index| index.re).collect());
        let k = index.iter().fold(0.0, |most: f64, index| most.max(index.im));
        if !n.is_constant() || k > CLEAR_K {
            let (least, largest) = (tidy(n.min()), tidy(n.max()));
            let wrong =
                Diagnostic::new(format!("this refractive index is {least} to {largest}, with k up to {k}"))
                    .expected("one real index for all wavelengths, as slabs need")
                    .hint("give the index at 550 nm as a number; the absorption of a slab is 1 - `albedo`");
            self.err(&binder, wrong);
            return None;
        }
        let optical_thickness = slab.optical_thickness.0;
        let (anisotropy, particles) = match (&slab.anisotropy.value, &slab.particles.value) {
            (Some(anisotropy), None) => (anisotropy.0, None),
            (None, Some(particles)) => (0.0, Some(self.particles(particles, n[0])?)),
            (Some(_), Some(_)) => {
                let wrong = Diagnostic::new("both `anisotropy` and `particles` are given")
                    .expected("one of them")
                    .hint("remove `anisotropy`: it follows from the particles");
                self.errors.push(slab.anisotropy.origin.or_override([slab.particles.origin]), wrong);
                return None;
            }
            (None, None) => {
                let expected = format!("{}, or `particles`", numbers::Anisotropy::in_words());
                self.errors.push(at, mistake::missing_key("anisotropy", expected));
                return None;
            }
        };
        if anisotropy != 0.0 {
            let reduced = tidy((1.0 - anisotropy) * optical_thickness);
            self.notes.push(format!(
                "{path}: an optical thickness of {optical_thickness} with anisotropy {anisotropy} scatters light \
                 back about as much as one of {reduced} with anisotropy 0 (similarity)"
            ));
        }
        if slab.thickness_mm.is_some() {
            self.note_length(path, "`optical_thickness` is that of the whole slab");
        }
        Some(Medium {
            index: n,
            transmittance: Spectrum::constant(&self.grid, 1.0),
            scattering: Some(Scattering::unpolarised(optical_thickness, anisotropy, albedo)),
            particles,
        })
    }

    /// Resolves particles in a binder of this index.
    fn particles(&mut self, particles: &diffuser::Particles, binder: f64) -> Option<Particles> {
        match particles {
            diffuser::Particles::Rayleigh(molecules) => {
                Some(Particles::Molecules { depolarisation: molecules.depolarisation_factor.0 })
            }
            diffuser::Particles::Mie(spheres) => {
                let per_um = 2.0 * PI * binder / PARTICLES_AT_UM;
                let size_parameter = per_um * spheres.radius_um.0;
                if size_parameter > Particles::LARGEST_SIZE {
                    let most = tidy(Particles::LARGEST_SIZE / per_um);
                    let wrong = Diagnostic::new(format!(
                        "spheres of {} um have a size parameter of {size_parameter:.0} in this binder",
                        spheres.radius_um.0
                    ))
                    .expected(format!("at most {}: a radius of {most} um", Particles::LARGEST_SIZE))
                    .hint("larger spheres scatter as rays do: use `anisotropy`");
                    self.errors.push(spheres.radius_um.origin, wrong);
                    return None;
                }
                if spheres.index.0 == binder {
                    let wrong = Diagnostic::new("spheres of the binder's index do not scatter")
                        .expected(format!("an index other than {binder}"));
                    self.errors.push(spheres.index.origin, wrong);
                    return None;
                }
                let index = Complex64::new(spheres.index.0 / binder, 0.0);
                Some(Particles::Spheres { size_parameter, index, variance: spheres.variance.0 })
            }
        }
    }

    /// Refuses slabs that are too thick for the Monte Carlo solver.
    pub(super) fn check_slab_thickness(&mut self, file: &File) {
        if file.solver.method.0 != Method::MonteCarlo {
            return;
        }
        let diffuser = match &file.display.diffuser.value {
            Some(Diffuser::Slab(slab)) => Some(slab),
            _ => None,
        };
        let layers = file.display.layers.iter().flatten().filter_map(|layer| match &layer.value {
            describe::Layer::Slab(slab) => Some(slab),
            _ => None,
        });
        for slab in diffuser.into_iter().chain(layers) {
            let optical_thickness = slab.optical_thickness.0;
            if optical_thickness > THICKEST_FOR_MONTE_CARLO {
                let at = slab.optical_thickness.origin.or_override([file.solver.method.origin]);
                let wrong = format!(
                    "the Monte Carlo solver would take hours with an optical thickness of {optical_thickness}"
                );
                let wrong = Diagnostic::new(wrong)
                    .expected(format!("at most {THICKEST_FOR_MONTE_CARLO} with method = \"monte-carlo\""))
                    .hint("use method = \"adding\", whose time hardly depends on the thickness");
                self.errors.push(at, wrong);
            }
        }
    }

    fn coating(&mut self, path: &str, coating: &describe::Coating) -> Option<Vec<FilmLayer>> {
        if coating.film.is_empty() {
            self.err(&coating.film, mistake::empty_list());
            return None;
        }
        self.limit(&coating.film, "films", coating.film.len(), 256)?;
        let mut films = Vec::with_capacity(coating.film.len());
        for (i, film) in coating.film.iter().enumerate() {
            let thickness_nm = film.thickness_nm.0;
            self.check_nm(&format!("{path}.film.{i}.thickness_nm"), thickness_nm);
            let index = self.material(&film.material);
            films.push(index.map(|index| FilmLayer { index, thickness: Thickness::Fixed(thickness_nm) }));
        }
        films.into_iter().collect()
    }

    /// Resolves the index of a transparent medium: n from 1 to 10, k at most `largest_k`.
    fn transparent(&mut self, spec: &Spanned<MaterialSpec>, largest_k: f64) -> Option<Vec<Complex64>> {
        let index = self.material(spec)?;
        let is_transparent = |index: &Complex64| (1.0..=10.0).contains(&index.re) && index.im <= largest_k;
        if let Some(i) = index.iter().position(|index| !is_transparent(index)) {
            let nm = self.grid.wavelength_nm(i);
            self.err(spec, not_transparent(index[i], nm, largest_k));
            return None;
        }
        Some(index)
    }
}
