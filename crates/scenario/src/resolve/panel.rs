//! The panel: front of screen, diffuser, glass; and whether the angles make sense for it.

use papilio_display::scene::{
    self, AngleMedium, Diffuser, Display, FrontComponent, Glass, Layers, Lobe, Panel, Scene,
};
use papilio_optics::lobe::{largest_haze, width_from_haze};
use papilio_spectra::Spectrum;

use super::Resolver;
use crate::describe::File;
use crate::describe::display::{self as describe, DiffuserModel};
use crate::describe::numbers::NARROWEST_LOBE;
use crate::problem::Problem;
use crate::read::At;

/// ASTM D1003 measures haze up to here.
const HAZE_SCOPE: f64 = 0.30;

impl Resolver<'_> {
    pub(super) fn display(&mut self, file: &File) -> Option<Display> {
        let display = &file.display;
        self.limit(&display.front, "front components", display.front.len(), 32)?;
        let front: Vec<_> = display.front.iter().map(|component| self.front(component)).collect();
        let diffuser = match &display.diffuser.value {
            Some(diffuser) => self.diffuser(diffuser).map(Some),
            None => Some(None),
        };
        let glass = self.glass(display);
        let pixel = self.pixel(&display.pixel);
        let front = front.into_iter().collect::<Option<Vec<_>>>();
        let panel = Panel { front: front?, diffuser: diffuser?, glass: glass? };
        Some(Display { layers: Layers::Panel(panel), pixel: pixel? })
    }

    fn front(&mut self, component: &At<describe::FrontComponent>) -> Option<FrontComponent> {
        let reflectance = self.share(&component.reflectance);
        let absorptance = self.share(&component.absorptance);
        let (reflectance, absorptance) = (reflectance?, absorptance?);
        let sum = reflectance.zip_map(&absorptance, |r, a| r + a).max();
        // A tolerance for sums such as .7 + .3 of decimal files.
        if sum > 1.0 + 1e-12 {
            let what = "reflectance and absorptance";
            let at = component.origin.or_set([component.reflectance.origin, component.absorptance.origin]);
            self.errors.push(at, Problem::Sum { what, sum, expected: "at most 1" });
            return None;
        }
        Some(FrontComponent { reflectance, absorptance })
    }

    fn diffuser(&mut self, diffuser: &describe::Diffuser) -> Option<Diffuser> {
        let lobe = self.lobe(diffuser);
        let transmittance = self.diffuser_transmittance(diffuser, lobe);
        Some(Diffuser {
            lobe: lobe?,
            transmittance: transmittance?,
            straight_through: diffuser.straight_through.0,
        })
    }

    fn lobe(&mut self, diffuser: &describe::Diffuser) -> Option<Lobe> {
        let given = usize::from(diffuser.haze.is_some()) + usize::from(diffuser.width.is_some());
        let (haze, width) = (diffuser.haze.value, diffuser.width.value);
        if diffuser.model.value == DiffuserModel::Lambertian {
            if given == 0 {
                return Some(Lobe::Lambertian);
            }
            let (key, at) = if haze.is_some() {
                ("haze", diffuser.haze.origin)
            } else {
                ("width", diffuser.width.origin)
            };
            let at = at.or_set([diffuser.model.origin]);
            self.errors.push(at, Problem::NotWith { key, beside: "model = \"lambertian\"" });
            return None;
        }
        match (haze, width) {
            (Some(haze), None) => self.lobe_from_haze(haze.0, diffuser),
            (None, Some(width)) => Some(Lobe::KCorrelation { width: width.0 }),
            _ => {
                let at = diffuser.width.origin.or_set([diffuser.haze.origin, diffuser.model.origin]);
                self.errors.push(at, Problem::ExactlyOne { keys: "`haze` and `width`", given });
                None
            }
        }
    }

    fn lobe_from_haze(&mut self, haze: f64, diffuser: &describe::Diffuser) -> Option<Lobe> {
        let straight_through = diffuser.straight_through.0;
        let width = width_from_haze(haze, straight_through).filter(|width| *width >= NARROWEST_LOBE);
        let Some(width) = width else {
            let limit = largest_haze(straight_through);
            let at = diffuser.haze.origin.or_set([diffuser.straight_through.origin]);
            self.errors.push(at, Problem::NoWidth { haze, straight_through, limit });
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

    /// T of the whole lobe, from itself or from the datasheet's total transmittance.
    fn diffuser_transmittance(
        &mut self,
        diffuser: &describe::Diffuser,
        lobe: Option<Lobe>,
    ) -> Option<Spectrum> {
        let (whole, total) = (&diffuser.transmittance, &diffuser.total_transmittance);
        let (spec, share) = match (&whole.value, &total.value) {
            (Some(spec), None) => (At { value: spec.clone(), origin: whole.origin }, 1.0),
            (None, Some(spec)) => {
                let straight = diffuser.straight_through.0;
                let spec = At { value: spec.clone(), origin: total.origin };
                (spec, (1.0 - straight) * lobe?.hemispherical_share() + straight)
            }
            (whole_given, _) => {
                let given = if whole_given.is_some() { 2 } else { 0 };
                let keys = "`transmittance` and `total_transmittance`";
                self.errors.push(whole.origin.or_set([total.origin]), Problem::ExactlyOne { keys, given });
                return None;
            }
        };
        let transmittance = self.share(&spec)?.map(|t| t / share);
        let lobe = transmittance.max();
        if lobe > 1.0 + 1e-12 {
            let causes = [
                diffuser.width.origin,
                diffuser.haze.origin,
                diffuser.straight_through.origin,
                diffuser.model.origin,
            ];
            self.errors.push(spec.origin.or_set(causes), Problem::LobeAboveOne { lobe, limit: share });
            return None;
        }
        Some(transmittance.map(|t| t.min(1.0)))
    }

    fn glass(&mut self, display: &describe::Display) -> Option<Glass> {
        let glass = &display.glass;
        if display.diffuser.is_some() && glass.surface.value == Some(describe::Surface::Fresnel) {
            let at = glass.surface.origin.or_set([display.diffuser.origin]);
            self.errors.push(at, Problem::SurfaceUnderDiffuser);
        }
        let index = self.material(&glass.index)?;
        let lossless = |n: f64, k: f64| (1.0..=10.0).contains(&n) && k <= 1e-6;
        if let Some(i) = index.iter().position(|index| !lossless(index.re, index.im)) {
            let nm = self.grid.wavelength_nm(i);
            self.err(&glass.index, Problem::NoGlass { n: index[i].re, k: index[i].im, nm });
            return None;
        }
        Some(Glass {
            index: Spectrum::from_values(index.iter().map(|index| index.re).collect()),
            surface: match glass.surface.value {
                None | Some(describe::Surface::Coated) => scene::Surface::Coated,
                Some(describe::Surface::Fresnel) => scene::Surface::Fresnel,
            },
        })
    }

    /// Angles in glass: for a bare panel of one index, and only for light that gets out.
    pub(super) fn check_angles(&mut self, file: &File, scene: &Scene) {
        if scene.solver.angle_medium != AngleMedium::Glass {
            return;
        }
        let panel = scene.display.panel();
        let needs = if panel.is_none_or(|panel| panel.diffuser.is_some()) {
            "a panel without diffuser"
        } else if !scene.display.index_above_pixel().is_constant() {
            "a glass of the same index at all wavelengths"
        } else if panel.is_some_and(|panel| panel.glass.surface != scene::Surface::Coated) {
            "surface = \"coated\""
        } else {
            return self.check_trapped(file, scene);
        };
        let display = &file.display;
        let causes = [display.diffuser.origin, display.glass.index.origin, display.glass.surface.origin];
        let at = file.solver.angle_medium.origin.or_set(causes);
        self.errors.push(at, Problem::AnglesInGlass(needs));
    }

    /// What is seen or shines at |beta| >= 1 is light that the glass holds.
    fn check_trapped(&mut self, file: &File, scene: &Scene) {
        let limit_deg = (1.0 / scene.display.index_above_pixel()[0]).asin().to_degrees();
        let causes = [file.solver.angle_medium.origin, file.display.glass.index.origin];
        let half_field = 0.5 * scene.viewer.field_deg;
        let edges = scene.viewer.theta_deg.iter().map(|theta| theta.abs() + half_field);
        let edge = edges.fold(0.0, f64::max);
        if edge >= limit_deg {
            let at = file.viewer.theta_deg.origin.or_set(causes).or_set([file.viewer.field_deg.origin]);
            self.errors.push(at, Problem::Trapped { theta_deg: edge, limit_deg });
        }
        for source in file.lighting.directed.iter() {
            let theta_deg = source.theta_deg.0.abs() + source.radius_deg.map_or(0.0, |radius| radius.0);
            if theta_deg >= limit_deg {
                let at = source.theta_deg.origin.or_set(causes).or_set([source.radius_deg.origin]);
                self.errors.push(at, Problem::Trapped { theta_deg, limit_deg });
            }
        }
    }
}
