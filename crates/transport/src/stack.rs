//! The stack: any layers in any order, as interfaces and media in turn, over a pixel.
//!
//! Top to bottom: air, then for each layer its interface and the medium below it, then the base under the
//! last medium. Light is followed through all orders of inter-reflection, including light trapped by total
//! internal reflection. Every interface is an operator on direction cosines; light with `|beta| >= n` does
//! not enter a medium of index n.
//!
//! Where all layers are flat, or scatter light without changing its shares of s and p, and the pixel is a mirror, they are kept apart through all orders: such a
//! stack may hold itself for light of each polarisation ([`Stack::with_polarisations`]). Both
//! solvers return the mean of both, or what a polariser before the viewer makes of them.
//!
//! Both solvers have methods of their own for the ordinary panel ([`Panel`]). [`Stack::new`] recognises it
//! among any layers, here and nowhere else. A diffuser over a mirror that depends on azimuth is no panel: its methods
//! rely on the same light at all azimuths.

use std::borrow::Cow;
use std::sync::Arc;

use papilio_optics::Beta;
use papilio_optics::film::Polarisation;
use papilio_spectra::Spectrum;

use crate::layers::{LayerKind, least_edge};
use crate::mirror_run::{Mirror, MirrorRun};
use crate::polarised_view::PolarisedView;
use crate::{
    Approximation, Base, Cone, Described, FlatRun, Interface, Medium, Mueller, Panel, PanelParts, Phases,
    Reflector, Source, Top,
};

/// Layers over a pixel.
#[derive(Debug, Clone)]
pub struct Stack {
    /// Top to bottom.
    pub(crate) layers: Vec<Layer>,
    form: Form,
    /// The same for light of s and of p, if they are kept apart to the end.
    polarised: Option<Box<Polarised>>,
    /// The same with its flat layers in runs that keep s and p apart, if it has any.
    in_runs: Option<Box<Self>>,
    /// The last of its layers, if that is a run which keeps s and p apart together with the mirror below.
    mirror_run: Option<Box<MirrorRun>>,
    /// The mirror-like pixel for light of s and of p, for the tracer of Stokes parameters.
    mirrors_of_each: Option<Box<MirrorsOfEach>>,
    /// Polarised light, and a polariser before the eye above layers that scatter.
    polarised_view: Option<Arc<PolarisedView>>,
    /// All layers for light of s and of p, for light with its places, if they are flat and the pixel is Lambertian.
    of_each: Option<Arc<[Vec<Layer>; 2]>>,
    /// Of the stack for light of s or of p: the phase between both, if it is known.
    phases: Option<Arc<Phases>>,
}

/// A mirror-like pixel for polarised light.
#[derive(Debug, Clone)]
pub(crate) struct MirrorsOfEach {
    /// For s and for p.
    pub(crate) both: [Base; 2],
    /// Real and imaginary part of the product of both amplitudes; `None`: as of metal, with opposite signs.
    pub(crate) products: Option<[Base; 2]>,
}

/// A stack for light of each polarisation.
#[derive(Debug, Clone)]
struct Polarised {
    /// For s and for p.
    both: [Stack; 2],
    /// Their weights in what is seen.
    weights: [f64; 2],
}

/// What the solvers see, each with the pixel.
#[derive(Debug, Clone)]
#[allow(clippy::large_enum_variant, reason = "there is one stack, not many")]
enum Form {
    /// The ordinary panel that the layers are.
    Panel(Panel),
    /// Any layers.
    General(Base),
}

/// An interface and the medium below it.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// Between the medium above (air over the first layer) and `medium`.
    pub interface: Interface,
    /// Below the interface.
    pub medium: Medium,
    /// Thickness of the medium, mm, at least 0. It decides where light leaves, not how much of it.
    pub thickness_mm: f64,
}

impl Layer {
    /// A layer without thickness, for light without regard to places.
    pub fn new(interface: Interface, medium: Medium) -> Self {
        Self { interface, medium, thickness_mm: 0.0 }
    }
}

/// An approximation for panels was requested of other layers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NotAPanel;

impl Stack {
    /// Returns the stack of these layers over a pixel.
    pub fn new(layers: Vec<Layer>, base: Base) -> Self {
        Self::recognised(layers, base, Approximation::default())
    }

    /// Returns the stack of an ordinary panel, with approximations.
    ///
    /// # Errors
    /// [`NotAPanel`] if an approximation is requested of layers that are no panel.
    pub fn approximated(
        layers: Vec<Layer>,
        base: Base,
        approximation: Approximation,
    ) -> Result<Self, NotAPanel> {
        let stack = Self::recognised(layers, base, approximation);
        if approximation.is_none() || stack.panel().is_some() { Ok(stack) } else { Err(NotAPanel) }
    }

    /// Returns the stack of these layers for the methods of general layers, even if they are an ordinary
    /// panel: both have the same results.
    pub fn general(layers: Vec<Layer>, base: Base) -> Self {
        Self::of(layers, Form::General(base))
    }

    /// The same stack, with what it is for light of s and of p, which all layers keep apart: `[s, p]`, with as
    /// many states and wavelengths, and their weights in what is seen, 0.5 each without a polariser. What scatters in it
    /// must keep them apart, too.
    #[must_use]
    pub fn with_polarisations(self, both: [Self; 2], weights: [f64; 2]) -> Self {
        debug_assert!(self.base().is_specular());
        Self { polarised: Some(Box::new(Polarised { both, weights })), ..self }
    }

    /// The same stack, which keeps s and p apart, with the phase between them.
    #[must_use]
    pub fn with_phases(mut self, phases: Option<Phases>) -> Self {
        self.set_phases(phases);
        self
    }

    /// Sets the phase between s and p, if they are kept apart; `None`: it is not known.
    pub fn set_phases(&mut self, phases: Option<Phases>) {
        let phases = phases.map(Arc::new);
        let both = self.polarised.iter_mut().flat_map(|polarised| &mut polarised.both);
        both.for_each(|one| one.phases.clone_from(&phases));
    }

    /// The phase between s and p, of the stack for light of either.
    pub(crate) fn phases(&self) -> Option<&Phases> {
        self.phases.as_deref()
    }

    /// Replaces the product of both amplitudes of the mirror, with as many states, if the phase is known: its real and its imaginary part.
    pub fn set_products(&mut self, products: [Base; 2]) {
        if let Some(mirrors) = self.mirrors_of_each.as_deref_mut() {
            mirrors.products = Some(products);
            return;
        }
        let Some([s, _]) = self.polarised() else { return };
        if let Some(mut phases) = s.phases().cloned() {
            phases.set_mirror(products);
            self.set_phases(Some(phases));
        }
    }

    /// The product of both amplitudes of the mirror, its real and its imaginary part, if the phase between s and p is known.
    pub fn products(&self) -> Option<&[Base; 2]> {
        if let Some(mirrors) = self.mirrors_of_each() {
            return mirrors.products.as_ref();
        }
        let [s, _] = self.polarised()?;
        Some(s.phases()?.mirror())
    }

    /// What the stack is for light of s and of p, if they are kept apart.
    pub fn polarised(&self) -> Option<&[Self; 2]> {
        self.polarised.as_deref().map(|polarised| &polarised.both)
    }

    /// The same stack, with what it is for light without regard to places: `layers` with runs of flat layers that
    /// keep s and p apart ([`Interface::Run`]), over the same pixel. `mirrors`: that pixel for light of s and of p, if
    /// the last layer is a run that keeps them apart together with it.
    #[must_use]
    pub fn with_runs(self, layers: Vec<Layer>, mirrors: Option<[Base; 2]>) -> Self {
        let mut in_runs = Self::general(layers, self.base().clone());
        let mirror = mirrors.map(|mirrors| Mirror::OfEach(Box::new(mirrors)));
        let mirror_run = mirror.and_then(|mirror| MirrorRun::new(&in_runs.layers, mirror));
        in_runs.mirror_run = mirror_run.map(Box::new);
        Self { in_runs: Some(Box::new(in_runs)), ..self }
    }

    /// The same stack with its layers for light of s and of p, all flat above a Lambertian pixel: light with its places
    /// keeps them apart between two meetings with the pixel. In a panel, so does all light.
    #[must_use]
    pub fn with_layers_of_each(mut self, both: [Vec<Layer>; 2]) -> Self {
        debug_assert!(self.elements().all(|(kind, _)| !kind.scatters()) && !self.base().is_specular());
        self.of_each = Some(Arc::new(both));
        self.keeping_s_and_p()
    }

    /// The same stack, in which front and face of a panel above a Lambertian pixel keep s and p apart in the light that they return to each other.
    #[must_use]
    pub fn keeping_s_and_p(mut self) -> Self {
        if let Form::Panel(panel) = &mut self.form {
            panel.keeps_s_and_p = matches!(panel.top, Top::Fresnel(_)) && !panel.single_pass;
        }
        self
    }

    /// These layers.
    pub(crate) fn layers_of_each(&self) -> Option<&[Vec<Layer>; 2]> {
        self.of_each.as_deref()
    }

    /// The pixel for light of s and of p, if they are kept apart where they meet it.
    pub fn polarised_bases(&self) -> Option<[&Base; 2]> {
        if let Some(both) = self.polarised() {
            return Some(both.each_ref().map(Self::base));
        }
        if let Some(mirrors) = self.mirrors_of_each() {
            return Some(mirrors.both.each_ref());
        }
        self.in_runs.as_deref()?.mirrors().map(|mirrors| mirrors.each_ref())
    }

    /// The same for modification; whether they scatter must not change.
    pub fn polarised_bases_mut(&mut self) -> Option<[&mut Base; 2]> {
        if let Some(polarised) = self.polarised.as_deref_mut() {
            return Some(polarised.both.each_mut().map(Self::base_mut));
        }
        if let Some(mirrors) = self.mirrors_of_each.as_deref_mut() {
            return Some(mirrors.both.each_mut());
        }
        match &mut self.in_runs.as_deref_mut()?.mirror_run.as_deref_mut()?.mirror {
            Mirror::OfEach(mirrors) => Some(mirrors.each_mut()),
            Mirror::Changing(_) => None,
        }
    }

    /// Replaces the pixel for light of s and of p, if they are kept apart where they meet it; whether they scatter must not change.
    pub fn set_polarised_bases(&mut self, bases: [Base; 2]) {
        if let Some(polarised) = self.polarised.as_deref_mut() {
            return polarised.both.iter_mut().zip(bases).for_each(|(stack, base)| stack.set_base(base));
        }
        let both = self.polarised_bases_mut().into_iter().flatten();
        both.zip(bases).for_each(|(one, base)| *one = base);
    }

    /// The mirror for s and for p, if they are kept apart by layers below the last scatterer together with it.
    pub(crate) fn mirrors(&self) -> Option<&[Base; 2]> {
        match &self.mirror_run.as_deref()?.mirror {
            Mirror::OfEach(mirrors) => Some(mirrors),
            Mirror::Changing(_) => None,
        }
    }

    /// Computes the reflectance of the base, `[state][wavelength]`: below a run that keeps s and p apart together with
    /// it, that for mean light.
    pub(crate) fn reflectance_of(&self, base: &Base, beta: Beta, medium: &Medium, out: &mut [f64]) {
        match &self.mirror_run {
            Some(run) => run.reflectance(beta, out),
            None => base.reflectance_towards(beta, medium, out),
        }
    }

    /// The stack with its flat layers in runs, if it has any; else itself.
    pub(crate) fn in_runs(&self) -> &Self {
        self.in_runs.as_deref().unwrap_or(self)
    }

    /// Returns the same stack, for light without regard to places as a panel with these flat layers, all of its own, as one run: above a pixel that
    /// changes polarisation, s and p are kept apart; above any other, their mean is followed.
    #[must_use]
    pub fn with_flat_run(self, run: FlatRun) -> Self {
        let air = Medium::new(vec![1.0; self.base().bins()].into());
        let medium = self.layers.last().map_or(&air, |layer| &layer.medium);
        let panel = Panel::below_run(run, medium, self.base().clone());
        let in_runs = Self::of(self.layers.clone(), Form::Panel(panel));
        Self { in_runs: Some(Box::new(in_runs)), ..self }
    }

    /// Returns whether *adding* knows the azimuth of light at the pixel, if the pixel depends on it.
    pub fn adding_knows_azimuth(&self) -> bool {
        let one = self.polarised().map_or(self, |[s, _]| s);
        one.in_runs().panel().is_some() || !self.base().is_azimuthal()
    }

    /// Sets the pixel for polarised light, with as many states and wavelengths: a pixel that changes polarisation below flat layers. Another pixel in
    /// its place ends that.
    pub fn set_mueller(&mut self, mueller: Option<Arc<Mueller>>) {
        if let Some(in_runs) = &mut self.in_runs {
            return in_runs.set_mueller(mueller);
        }
        match &mut self.form {
            Form::Panel(panel) => {
                panel.mueller = mueller.filter(|_| !matches!(panel.top, Top::Diffuser(_)));
            }
            Form::General(_) => {
                let mirror = mueller.map(Mirror::Changing);
                let run = mirror.and_then(|mirror| MirrorRun::new(&self.layers, mirror));
                if run.is_some() || self.mirrors().is_none() {
                    self.mirror_run = run.map(Box::new);
                }
            }
        }
    }

    /// The pixel for polarised light, if it changes polarisation.
    pub fn mueller(&self) -> Option<&Arc<Mueller>> {
        let stack = self.in_runs();
        match (&stack.form, stack.mirror_run.as_deref()) {
            (Form::Panel(panel), _) => panel.mueller.as_ref(),
            (_, Some(MirrorRun { mirror: Mirror::Changing(mueller), .. })) => Some(mueller),
            _ => None,
        }
    }

    /// The pixel that changes polarisation below flat layers alone, and the interfaces of these for light of s and of p.
    pub(crate) fn changing(&self) -> Option<(&Mueller, [Vec<Interface>; 2])> {
        let panel = self.in_runs().panel()?;
        let pixel = panel.mueller.as_deref()?;
        if let Some(run) = &panel.run {
            return Some((pixel, run.interfaces().clone()));
        }
        let of = |polarisation| {
            let own = |layer: &Layer| match &layer.interface {
                Interface::Fresnel => Interface::FresnelOf(polarisation),
                other => other.clone(),
            };
            self.layers.iter().map(own).collect()
        };
        Some((pixel, [Polarisation::S, Polarisation::P].map(of)))
    }

    /// Returns whether light with its places and directions follows the change of polarisation by the pixel.
    pub fn follows_changes(&self) -> bool {
        self.in_runs().panel().is_some_and(|panel| panel.mueller.is_some())
    }

    /// Sets what is polarised: sources are those with these numbers in the lists of kernels and walks.
    pub fn set_polarised_view(&mut self, view: Option<PolarisedView>) {
        let whole = || view.as_ref().and_then(|view| view.whole().cloned());
        if let Some(Form::Panel(panel)) = self.in_runs.as_deref_mut().map(|in_runs| &mut in_runs.form) {
            panel.whole = whole();
        }
        if let Form::Panel(panel) = &mut self.form {
            panel.whole = whole();
        }
        self.polarised_view = view.map(Arc::new);
    }

    /// The same stack, for the tracer of Stokes parameters with a mirror-like pixel for light of s and of p, and the real and the imaginary part of
    /// the product of both amplitudes; without it, the pixel reflects as metal does, with opposite signs.
    #[must_use]
    pub fn with_mirrors_of_each(mut self, both: [Base; 2], products: Option<[Base; 2]>) -> Self {
        debug_assert!(self.base().is_specular());
        self.mirrors_of_each = Some(Box::new(MirrorsOfEach { both, products }));
        self
    }

    /// That pixel.
    pub(crate) fn mirrors_of_each(&self) -> Option<&MirrorsOfEach> {
        self.mirrors_of_each.as_deref()
    }

    /// Returns whether a medium has a phase matrix: only the tracer of Stokes parameters computes it.
    pub fn has_phase_matrix(&self) -> bool {
        self.layers.iter().any(|layer| layer.medium.scattering().is_some_and(|slab| slab.matrix.is_some()))
    }

    /// What is polarised.
    pub(crate) fn polarised_view(&self) -> Option<&Arc<PolarisedView>> {
        self.polarised_view.as_ref()
    }

    /// Returns the sources of light of s (0) or of p (1), if they are kept apart: those of unpolarised light instead of polarised ones.
    pub fn sources_of<'s>(&self, polarisation: usize, sources: &'s [Source]) -> Cow<'s, [Source]> {
        match self.polarised_view() {
            Some(light) => light.sources(sources, Some(polarisation)),
            None => sources.into(),
        }
    }

    /// Weights of s and of p in what a view sees of a ray with these direction cosines, from the source of this number; without a view, through
    /// a polariser in the frame of the ray itself. `None` except in flat layers above a mirror where anything is polarised.
    pub fn weights_of_ray(
        &self,
        view: Option<&Cone>,
        (number, source): (usize, &Source),
        beta: Beta,
    ) -> Option<[f64; 2]> {
        let seen = self.polarised_view()?.rays()?;
        Some(seen.weights(view, (number, source.direction()), beta))
    }

    /// Weights of s and of p in what a view sees of each source, of the reflectance factors of both: 1 where they belong to each ray. Without a view,
    /// of its mirror image.
    pub fn weights_by_source(&self, view: Option<&Cone>, sources: &[Source]) -> Vec<[f64; 2]> {
        let usual = self.weights_of_polarisations();
        let of = |(number, source)| match &self.polarised_view {
            Some(light) => light.weights(view, (number, source), usual),
            None => usual,
        };
        sources.iter().enumerate().map(of).collect()
    }

    /// Weights of s and of p in what is seen of unpolarised light; those of unpolarised light if they are not kept apart.
    pub fn weights_of_polarisations(&self) -> [f64; 2] {
        self.polarised.as_deref().map_or([0.5; 2], |polarised| polarised.weights)
    }

    fn recognised(layers: Vec<Layer>, base: Base, approximation: Approximation) -> Self {
        let scatters = matches!(base.reflector, Reflector::Scattering(_));
        let parts = PanelParts::recognised(described(&layers))
            .filter(|parts| !scatters && (parts.diffuser().is_none() || !base.is_azimuthal()));
        let form = match (parts, layers.last()) {
            (Some(parts), Some(glass)) => {
                Form::Panel(Panel::new(&parts, (&layers, glass), base, approximation))
            }
            _ => Form::General(base),
        };
        Self::of(layers, form)
    }

    fn of(layers: Vec<Layer>, form: Form) -> Self {
        Self {
            layers,
            form,
            polarised: None,
            in_runs: None,
            mirror_run: None,
            mirrors_of_each: None,
            polarised_view: None,
            of_each: None,
            phases: None,
        }
    }

    /// The layers, top to bottom.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// Sets the thickness of the medium of each layer, mm, top to bottom.
    pub fn set_thickness_mm(&mut self, thickness_mm: &[f64]) {
        self.layers.iter_mut().zip(thickness_mm).for_each(|(layer, mm)| layer.thickness_mm = *mm);
        if let Form::Panel(panel) = &mut self.form {
            panel.gaps_mm.clear();
            panel.gaps_mm.extend(self.layers.iter().map(|layer| layer.thickness_mm));
        }
        if let Some(polarised) = &mut self.polarised {
            polarised.both.iter_mut().for_each(|one| one.set_thickness_mm(thickness_mm));
        }
    }

    /// Thickness of all layers together, mm.
    pub fn thickness_mm(&self) -> f64 {
        self.layers.iter().map(|layer| layer.thickness_mm).sum()
    }

    /// The ordinary panel, if the layers are one.
    pub fn panel(&self) -> Option<&Panel> {
        match &self.form {
            Form::Panel(panel) => Some(panel),
            Form::General(_) => None,
        }
    }

    /// The ordinary panel that the layers are, also where its pixel depends on azimuth below a diffuser: for methods that
    /// know the direction of all light.
    pub fn panel_by_direction(&self) -> Option<Panel> {
        let Form::General(base) = &self.form else { return self.panel().cloned() };
        let parts = PanelParts::recognised(described(&self.layers)).filter(|_| base.is_specular())?;
        let layers = (&self.layers[..], self.layers.last()?);
        Some(Panel::new(&parts, layers, base.clone(), Approximation::default()))
    }

    /// The pixel, under the last layer's medium.
    pub fn base(&self) -> &Base {
        match &self.form {
            Form::Panel(panel) => &panel.base,
            Form::General(base) => base,
        }
    }

    /// Replaces the pixel; whether it scatters must not change. For light of one polarisation it is that of
    /// [`polarised_bases_mut`](Self::polarised_bases_mut).
    pub fn set_base(&mut self, base: Base) {
        if let Some(in_runs) = &mut self.in_runs {
            in_runs.set_base(base.clone());
        }
        if self.mueller().is_some() {
            self.mirror_run = None;
        }
        match &self.form {
            Form::Panel(Panel { top: Top::Diffuser(_), .. }) if base.is_azimuthal() => {
                self.form = Form::General(base);
            }
            _ => *self.base_mut() = base,
        }
    }

    /// Replaces the reflection of the pixel in the same way.
    pub fn set_reflector(&mut self, reflector: Reflector) {
        if let Some(in_runs) = &mut self.in_runs {
            in_runs.set_reflector(reflector.clone());
        }
        self.base_mut().reflector = reflector;
    }

    fn base_mut(&mut self) -> &mut Base {
        match &mut self.form {
            Form::Panel(panel) => {
                panel.mueller = None;
                &mut panel.base
            }
            Form::General(base) => base,
        }
    }

    /// The same layers over another pixel, for unpolarised light; whether it scatters must not change.
    pub fn with_base(&self, base: Base) -> Self {
        let mut other = Self::of(self.layers.clone(), self.form.clone());
        other.set_base(base);
        other
    }

    /// The same layers over another pixel, which may scatter, for the methods of general layers and light with its
    /// places. `both`: a mirror-like pixel for light of s and of p, if they are kept apart.
    pub fn general_over(&self, base: Base, both: Option<[Base; 2]>) -> Self {
        let kept = self.polarised.as_deref();
        let of_mirrors = || kept.map(|kept| Arc::new(kept.both.each_ref().map(|one| one.layers.clone())));
        let of_each = self.of_each.clone().or_else(of_mirrors).filter(|_| !base.is_specular());
        let polarised = kept.zip(both).map(|(Polarised { both: [s, p], weights }, [of_s, of_p])| {
            let both = [s.general_over(of_s, None), p.general_over(of_p, None)];
            Box::new(Polarised { both, weights: *weights })
        });
        let polarised_view = self.polarised_view.clone();
        Self { of_each, polarised, polarised_view, ..Self::general(self.layers.clone(), base) }
    }

    /// The same layers above glass, the lowest medium, that is clear, and the internal transmittance that it has
    /// had; `None` if it has absorbed nothing, or scatters.
    pub fn above_clear_glass(&self) -> Option<(Self, &Spectrum)> {
        let medium = &self.layers.last()?.medium;
        let transmittance = medium.transmittance().filter(|_| medium.scattering().is_none())?;
        let cleared = |layers: &Vec<Layer>| {
            let mut layers = layers.clone();
            if let Some(last) = layers.last_mut() {
                last.medium = Medium::new(medium.index().clone());
            }
            layers
        };
        let stack = Self::new(cleared(&self.layers), self.base().clone());
        let stack = match self.layers_of_each() {
            Some(both) => stack.with_layers_of_each(both.each_ref().map(cleared)),
            None => stack,
        };
        Some((stack, transmittance))
    }

    /// The `|beta|` beyond which the appearance from above is unknown: where the table of the first scatterer
    /// ends. `None` if it extends to the horizon.
    pub fn known_within(&self) -> Option<f64> {
        if let Some(first) = self.elements().map(|(kind, _)| kind).find(|kind| kind.scatters()) {
            return first.known_within();
        }
        let Reflector::Scattering(states) = &self.base().reflector else { return None };
        let index = self.layers.last().map_or(1.0, |layer| layer.medium.index().min());
        least_edge(states).map(|edge| index * edge)
    }

    /// Returns interfaces and media in turn, top to bottom, each with the media above and below it. A medium
    /// has itself on both sides; the first interface has `None`, air, above.
    pub(crate) fn elements(&self) -> impl Iterator<Item = (&dyn LayerKind, [Option<&Medium>; 2])> {
        let above = std::iter::once(None).chain(self.layers.iter().map(|layer| Some(&layer.medium)));
        self.layers.iter().zip(above).flat_map(|(Layer { interface, medium, .. }, above)| {
            let medium_itself: &dyn LayerKind = medium;
            [(interface.kind(), [above, Some(medium)]), (medium_itself, [Some(medium); 2])]
        })
    }

    /// True if all layers are the same at every wavelength; the pixel may have colour.
    pub(crate) fn is_grey(&self) -> bool {
        let key = |bin: usize| {
            let mut key = Vec::new();
            self.elements().for_each(|(kind, _)| kind.spectral_key(bin, &mut key));
            key
        };
        let first = key(0);
        (1..self.base().bins()).all(|bin| key(bin) == first)
    }
}

/// Layers as what an ordinary panel is recognised by.
fn described(layers: &[Layer]) -> impl Iterator<Item = Described<'_>> {
    layers.iter().map(|Layer { interface, medium, .. }| {
        let is_clear = medium.transmittance().is_none() && medium.scattering().is_none();
        (Some(interface), medium.index(), is_clear)
    })
}
