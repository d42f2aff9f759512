//! The short form of the layers: front of screen, surface or diffuser, glass; and the checks of keys for the
//! ordinary panel only.

use papilio_diagnostics::Diagnostic;
use papilio_display::scene::{
    AngleMedium, Depolarisation, Display, Interface, Layer, Length, Medium, Ready, Scene,
};
use papilio_spectra::Spectrum;

use super::Resolver;
use super::layers::{Neighbours, Part, length};
use super::stack::Stack;
use crate::describe::File;
use crate::describe::diffuser::Diffuser;
use crate::describe::display as describe;
use crate::describe::display::ShareSpectrum;
use crate::describe::solver::Approximation;
use crate::mistake;
use crate::origin::Origin;
use crate::read::Spanned;

/// Error: a key is for the ordinary panel only; `instead` is possible for every display.
fn needs_panel(what: &str, instead: &str) -> Diagnostic {
    Diagnostic::new(format!("{what} is for the ordinary panel only"))
        .expected(
            "front components, a surface or a lobe given by a formula (without `reflection`), clear glass, and a pixel that is \
             not measured",
        )
        .hint(format!("use {instead}"))
}

/// Error: light in this direction in glass is totally reflected.
fn trapped(theta_deg: f64, limit_deg: f64) -> Diagnostic {
    Diagnostic::new(format!("light at {theta_deg} deg in this glass never leaves it"))
        .expected(format!("less than {limit_deg:.2} deg, including field of view and radius"))
}

impl Resolver<'_> {
    pub(super) fn display(&mut self, file: &File) -> Option<Display> {
        let display = &file.display;
        self.needs_lengths = display.matrix.is_some() || file.lighting.port_mm.is_some();
        let layers = match &display.layers.value {
            Some(layers) => self.layers(display, layers),
            None => self.short_form(display),
        };
        let pixel = self.pixel(&display.pixel);
        let matrix = match (&display.matrix.value, &pixel) {
            (Some(matrix), Some(pixel)) => {
                self.matrix((matrix, display.matrix.origin), &display.pixel, pixel).map(Some)
            }
            _ => Some(None),
        };
        let display = Display { layers: layers?, pixel: pixel?, matrix: matrix? };
        self.check_filter_height(file, &display);
        Some(display)
    }

    /// Resolves the short form of a list of layers: front of screen, surface or diffuser, and glass.
    fn short_form(&mut self, display: &describe::Display) -> Option<Vec<Layer>> {
        let front = display.front.as_deref().unwrap_or_default();
        self.limit(&display.front, "front components", front.len(), 32)?;
        let component = |one: &Spanned<describe::FrontComponent>| {
            self.component((&one.reflectance, &one.absorptance), one.origin)
        };
        let components: Vec<_> = front.iter().map(component).collect();
        let glass = self.glass(display);
        let top = self.top(display, glass.as_ref());
        let components = components.into_iter().collect::<Option<Vec<_>>>()?;
        let (top, (glass, _)) = (top?, glass?);
        let mut stack = Stack::new(&self.grid);
        for (i, (component, described)) in components.into_iter().zip(front).enumerate() {
            let gap = match described.gap_mm.value {
                Some(gap) => Length::Mm(gap.0),
                None => Length::Missing { key: format!("display.front.{i}.gap_mm") },
            };
            stack.put_above(component, gap, Origin::FILE);
        }
        let reflection = display.diffuser.as_ref().and_then(Diffuser::reflection);
        let thickness = display.glass.as_ref().and_then(|glass| glass.thickness_mm.value);
        let glass = Part::Medium(glass, length("display.glass", &thickness), Origin::FILE);
        if let Some(diffuser) = display.diffuser.as_ref().and_then(Diffuser::btdf) {
            let key = "display.diffuser.depolarisation".to_owned();
            stack.depolarise(Depolarisation { fraction: diffuser.depolarisation(), key });
        }
        for part in top.into_iter().chain([glass]) {
            match (part, reflection) {
                (Part::Medium(medium, length, index_at), _) => stack.fill(medium, length, index_at),
                (Part::Interface(face @ Interface::Ready(Ready::Reflecting(_))), Some(reflection)) => {
                    stack.put(face, reflection.origin);
                }
                (Part::Interface(interface), _) => stack.put(interface, Origin::FILE),
            }
        }
        Some(stack.finish(&mut self.errors))
    }

    /// Resolves the layers between air and this glass and its surface (`None` if they are unknown).
    fn top(&mut self, display: &describe::Display, glass: Option<&(Medium, Ready)>) -> Option<Vec<Part>> {
        let path = "display.diffuser";
        match &display.diffuser.value {
            None => Some(vec![Part::Interface(glass?.1.clone().into())]),
            Some(Diffuser::Slab(slab)) => {
                let length = length(path, &slab.thickness_mm);
                let slab = self.slab(path, slab, display.diffuser.origin)?;
                let slab = Part::Medium(slab, length, Origin::FILE);
                Some(vec![Part::Interface(Ready::Fresnel.into()), slab])
            }
            Some(Diffuser::Measured(_) | Diffuser::Microgeometry(_)) if glass.is_none() => None,
            Some(diffuser) => {
                let air = Spectrum::constant(&self.grid, 1.0);
                let media = Neighbours { above: &air, below: glass.map(|(medium, _)| &medium.index) };
                self.btdf(path, &diffuser.btdf()?, media)
            }
        }
    }

    pub(super) fn component(
        &mut self,
        (reflectance_spec, absorptance_spec): (&Spanned<ShareSpectrum>, &Spanned<ShareSpectrum>),
        origin: Origin,
    ) -> Option<Interface> {
        let reflectance = self.share(reflectance_spec, reflectance_spec.origin);
        let absorptance = self.share(absorptance_spec, absorptance_spec.origin);
        let (reflectance, absorptance) = (reflectance?, absorptance?);
        let sum = reflectance.zip_map(&absorptance, |r, a| r + a).max();
        // The tolerance is for rounding errors of sums such as 0.7 + 0.3.
        if sum > 1.0 + 1e-12 {
            let what = "reflectance and absorptance";
            let at = origin.or_override([reflectance_spec.origin, absorptance_spec.origin]);
            self.errors.push(at, mistake::sum(what, sum, "at most 1"));
            return None;
        }
        Some(Ready::component(reflectance, absorptance).into())
    }

    /// Resolves the glass and its surface.
    fn glass(&mut self, display: &describe::Display) -> Option<(Medium, Ready)> {
        let glass = display.glass.as_ref()?;
        let wrong = match (&display.diffuser.value, glass.surface.value) {
            (Some(Diffuser::Slab(_)), Some(_)) => {
                Some("a slab has interfaces of its own: bare ones, where the index changes")
            }
            (Some(_), Some(describe::Surface::Fresnel)) => {
                Some("a diffuser given by its BTDF includes its surfaces")
            }
            _ => None,
        };
        if let Some(why) = wrong {
            let model = display.diffuser.as_ref().map_or(display.diffuser.origin, Diffuser::model);
            let at = glass.surface.origin.or_override([display.diffuser.origin, model]);
            self.errors.push(at, Diagnostic::new(why).hint("remove `surface`, or the diffuser"));
        }
        let absorption = (&glass.internal_transmittance, &glass.thickness_mm);
        let medium = self.medium("display.glass", &glass.index, absorption)?;
        let surface = match glass.surface.value {
            None | Some(describe::Surface::IdealAr) => Ready::IdealAr,
            Some(describe::Surface::Fresnel) => Ready::Fresnel,
        };
        Some((medium, surface))
    }

    /// Checks that a front light with a distribution is above a lobe, so that only the front of screen
    /// reflects it specularly.
    fn check_front_light(&mut self, file: &File, scene: &Scene) {
        let Some(guide) = &file.lighting.front_light.value else { return };
        let over_lobe = scene.display.panel().is_some_and(|panel| panel.diffuser().is_some());
        if guide.distribution.value.is_some() && !over_lobe {
            let wrong = Diagnostic::new(
                "`distribution` of a front light is computed only above a diffuser of the model \"k-correlation\" or \"lambertian\", without \
                 `reflection`, on the glass",
            )
            .hint("remove `distribution`: a diffuse front light can be above any layers");
            self.errors.push(guide.distribution.origin, wrong);
        }
    }

    /// Checks the keys for the ordinary panel only: angles in other media than air, and single-pass.
    pub(super) fn check_panel(&mut self, file: &File, scene: &Scene) {
        self.check_front_light(file, scene);
        if scene.display.panel().is_some() {
            return self.check_angles(file, scene);
        }
        let (display, solver) = (&file.display, &file.solver);
        let mut causes = vec![display.layers.origin, display.diffuser.origin, display.glass.origin];
        causes.push(display.pixel.model());
        causes.extend(display.diffuser.as_ref().map(Diffuser::model));
        let reflection = display.diffuser.as_ref().and_then(Diffuser::reflection);
        causes.extend(reflection.map(|reflection| reflection.origin));
        causes.extend(display.glass.as_ref().map(|glass| glass.internal_transmittance.origin));
        causes.extend(display.glass.as_ref().map(|glass| glass.thickness_mm.origin));
        let what = match solver.angle_medium.0 {
            AngleMedium::Air => None,
            AngleMedium::Glass => Some("angle_medium = \"glass\""),
            AngleMedium::Unrefracted => Some("angle_medium = \"unrefracted\""),
        };
        if let Some(what) = what {
            let at = solver.angle_medium.origin.or_override(causes.iter().copied());
            self.errors.push(at, needs_panel(what, "angle_medium = \"air\""));
        }
        let what = match solver.approximation.value {
            Approximation::None | Approximation::Unpolarised => None,
            Approximation::SinglePass => Some("approximation = \"single-pass\""),
            Approximation::Unrefracted => Some("approximation = \"unrefracted\""),
        };
        if let Some(what) = what {
            let at = solver.approximation.origin.or_override(causes);
            self.errors.push(at, needs_panel(what, "approximation = \"none\""));
        }
    }

    /// Checks angles in glass, which are for a bare panel of one index, and for light that leaves the glass.
    fn check_angles(&mut self, file: &File, scene: &Scene) {
        if file.solver.angle_medium.0 != AngleMedium::Glass {
            return;
        }
        let panel = scene.display.panel();
        let needs = if panel.as_ref().is_none_or(|panel| panel.diffuser().is_some()) {
            "a panel without diffuser"
        } else if !scene.display.index_above_pixel().is_constant() {
            "a glass of the same index at all wavelengths"
        } else if panel.is_some_and(|panel| *panel.face != Ready::IdealAr) {
            "surface = \"ideal-ar\""
        } else {
            return self.check_trapped(file, scene);
        };
        let display = &file.display;
        let mut causes = vec![display.layers.origin, display.diffuser.origin, display.glass.origin];
        causes.extend(display.glass.iter().flat_map(|glass| [glass.index.origin, glass.surface.origin]));
        let at = file.solver.angle_medium.origin.or_override(causes);
        let wrong = Diagnostic::new(format!("angles in glass need {needs}"))
            .hint("use angle_medium = \"air\": angles are then refracted by Snell's law");
        self.errors.push(at, wrong);
    }

    /// Refuses views and sources with |beta| >= 1, whose light is totally reflected in the glass.
    fn check_trapped(&mut self, file: &File, scene: &Scene) {
        let limit_deg = (1.0 / scene.display.index_above_pixel()[0]).asin().to_degrees();
        let glass = file.display.glass.as_ref().map_or(file.display.glass.origin, |glass| glass.index.origin);
        let causes = [file.solver.angle_medium.origin, file.display.glass.origin, glass];
        let half_field = 0.5 * scene.viewer.field_deg;
        let edges = scene.viewer.theta_deg.iter().map(|theta| theta.abs() + half_field);
        let edge = edges.fold(0.0, f64::max);
        if edge >= limit_deg {
            let at =
                file.viewer.theta_deg.origin.or_override(causes).or_override([file.viewer.field_deg.origin]);
            self.errors.push(at, trapped(edge, limit_deg));
        }
        for source in file.lighting.directed.iter() {
            let theta_deg = source.theta_deg.0.abs() + source.radius_deg.map_or(0.0, |radius| radius.0);
            if theta_deg >= limit_deg {
                let at = source.theta_deg.origin.or_override(causes).or_override([source.radius_deg.origin]);
                self.errors.push(at, trapped(theta_deg, limit_deg));
            }
        }
    }
}
