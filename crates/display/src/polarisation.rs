//! Where light of s and of p is kept apart.
//!
//! All faces are parallel: s stays s, and p stays p, until something scatters the light, which then counts as
//! unpolarised. Therefore
//!
//! - above a mirror-like pixel, where nothing scatters, the whole display is computed for s and for p ([`weights`],
//!   [`Stack::with_polarisations`]), and a polariser before the eye chooses between them;
//! - elsewhere each run of flat layers that begins and ends with the air or a scatterer is one interface
//!   ([`FlatRun`]) of light without regard to places; the run between the last scatterer and a mirror is one together
//!   with the mirror.
//!
//! Where light meets one face only, the mean of s and p is exact, and nothing is done. That is so for ordinary panels
//! of paper below a face; sheets, given by their reflectance, are the same for both.

use std::ops::Range;

use papilio_optics::film::{Coating, Polarisation};
use papilio_spectra::Spectrum;
use papilio_transport::{Base, FlatRun, Interface, Layer, Stack};

use crate::DisplayError;
use crate::scene::{self, AngleMedium, Approximation, Pixel, Ready, Scene, UniformKind, UniformPixel};

/// Returns the weights of s and of p in what is seen, if they are kept apart to the end.
///
/// # Errors
/// With a polariser, if they are not.
pub(crate) fn weights(scene: &Scene) -> Result<Option<[f64; 2]>, DisplayError> {
    let meetings = Meetings::of(scene).filter(|_| is_followed(scene));
    let Some(angle_deg) = scene.viewer.polariser_deg else {
        return Ok(meetings.is_some_and(Meetings::mix).then_some([0.5; 2]));
    };
    if !is_followed(scene) {
        return Err(DisplayError::Polariser {
            needs: "s and p, which the approximation of the solver does not follow",
        });
    }
    if matches!(scene.display.pixel, Pixel::Crystal(_)) {
        let needs = "another pixel: that of a liquid crystal is computed for unpolarised light";
        return Err(DisplayError::Polariser { needs });
    }
    match meetings {
        None => Err(DisplayError::Polariser {
            needs: "flat layers above a mirror-like pixel: light that has been scattered counts as unpolarised",
        }),
        Some(Meetings { polarising: 0, .. }) => Ok(None),
        Some(_) => {
            let (sin, cos) = angle_deg.to_radians().sin_cos();
            Ok(Some([sin * sin, cos * cos]))
        }
    }
}

/// Returns whether s and p are kept apart where they meet the pixel.
///
/// # Errors
/// As [`weights`].
pub(crate) fn reaches_pixel(scene: &Scene) -> Result<bool, DisplayError> {
    Ok(weights(scene)?.is_some() || has_mirror_run(scene))
}

/// Returns whether they are kept apart by flat layers between a scatterer and the mirror.
fn has_mirror_run(scene: &Scene) -> bool {
    is_followed(scene) && scene.display.panel().is_none() && runs(scene).iter().any(|run| run.meets_mirror)
}

/// Returns the stack with what it is for s and p; `pixel` is that of light of s and of p, if they are kept apart where
/// they meet it.
pub(crate) fn kept(scene: &Scene, stack: Stack, pixel: Option<[Base; 2]>) -> Result<Stack, DisplayError> {
    let weights = weights(scene)?;
    if weights.is_none() && (!is_followed(scene) || stack.panel().is_some()) {
        return Ok(stack);
    }
    let runs = if weights.is_none() { runs(scene) } else { Vec::new() };
    if weights.is_none() && runs.is_empty() {
        return Ok(stack);
    }
    let of_s = of_polarisation(scene, stack.layers(), Polarisation::S)?;
    let of_p = of_polarisation(scene, stack.layers(), Polarisation::P)?;
    Ok(match (weights, pixel) {
        (Some(weights), Some([s, p])) => {
            stack.with_polarisations([Stack::new(of_s, s), Stack::new(of_p, p)], weights)
        }
        (_, mirrors) => {
            let layers = in_runs(stack.layers(), [&of_s, &of_p], &runs);
            stack.with_runs(layers, mirrors)
        }
    })
}

/// Returns the scene for light with its places, whose s and p are not followed.
///
/// # Errors
/// With a polariser.
pub(crate) fn unpolarised(scene: &Scene) -> Result<Scene, DisplayError> {
    if scene.viewer.polariser_deg.is_some() {
        let needs = "`papilio run`, `cone`, `brdf` or `sweep`: light with its places counts as unpolarised";
        return Err(DisplayError::Polariser { needs });
    }
    let mut scene = scene.clone();
    if scene.solver.approximation == Approximation::None {
        scene.solver.approximation = Approximation::Unpolarised;
    }
    Ok(scene)
}

/// True if the solver follows s and p.
fn is_followed(scene: &Scene) -> bool {
    scene.solver.approximation == Approximation::None && scene.solver.angle_medium != AngleMedium::Unrefracted
}

/// What light meets on its way.
#[derive(Debug, Clone, Copy, Default)]
struct Meetings {
    /// Faces and films, which reflect s and p differently.
    polarising: usize,
    /// All that reflects.
    reflecting: usize,
}

impl Meetings {
    /// Those of a whole display; `None` if anything scatters, or depends on place.
    fn of(scene: &Scene) -> Option<Self> {
        let display = &scene.display;
        let is_flat = |layer: &scene::Layer| is_flat(&layer.interface) && layer.medium.scattering.is_none();
        if display.filter().is_some() || !display.layers.iter().all(is_flat) {
            return None;
        }
        Self::with_mirror(scene, 0..display.layers.len())
    }

    /// Those of the interfaces of flat layers and the pixel; `None` if that is no mirror.
    fn with_mirror(scene: &Scene, layers: Range<usize>) -> Option<Self> {
        let is_film = match &scene.display.pixel {
            Pixel::Film(_) => true,
            Pixel::Table(_) | Pixel::Uniform(UniformPixel { kind: UniformKind::Mirror, .. }) => false,
            Pixel::Uniform(_) | Pixel::Scattering(_) | Pixel::Crystal(_) => return None,
        };
        let of_layers = Self::within(scene, layers);
        Some(Self {
            polarising: of_layers.polarising + usize::from(is_film),
            reflecting: of_layers.reflecting + 1,
        })
    }

    /// Those of the interfaces of flat layers.
    fn within(scene: &Scene, layers: Range<usize>) -> Self {
        let all = &scene.display.layers;
        let mut sum = Self::default();
        for number in layers {
            let below = &all[number].medium.index;
            let above = number.checked_sub(1).map(|above| &all[above].medium.index);
            let differs = || (0..below.len()).any(|bin| above.map_or(1.0, |above| above[bin]) != below[bin]);
            let (polarises, reflects) = match &all[number].interface {
                scene::Interface::Ready(Ready::Fresnel) => (differs(), differs()),
                scene::Interface::Coating(_) => (true, true),
                scene::Interface::Ready(Ready::Component(sheet)) => (false, sheet.reflectance.max() > 0.0),
                _ => (false, false),
            };
            sum.polarising += usize::from(polarises);
            sum.reflecting += usize::from(reflects);
        }
        sum
    }

    /// True if the mean of s and p at each meeting is not that of all of them.
    fn mix(self) -> bool {
        self.polarising > 0 && self.reflecting > 1
    }
}

fn is_flat(interface: &scene::Interface) -> bool {
    use Ready::{Component, Fresnel, IdealAr, Open};
    match interface {
        scene::Interface::Coating(_) => true,
        scene::Interface::Ready(ready) => matches!(ready, Open | IdealAr | Fresnel | Component(_)),
        _ => false,
    }
}

/// Flat layers within which light meets several faces.
struct Run {
    /// By their interfaces; the last medium may scatter.
    layers: Range<usize>,
    /// True if the last of what light meets is a mirror-like pixel.
    meets_mirror: bool,
}

/// Returns the runs of flat layers within which light meets several faces.
fn runs(scene: &Scene) -> Vec<Run> {
    let layers = &scene.display.layers;
    let mut found = Vec::new();
    let mut first = 0;
    while first < layers.len() {
        let rest = &layers[first..];
        let flat = rest.iter().take_while(|layer| is_flat(&layer.interface)).count();
        let murky = rest.iter().take(flat).position(|layer| layer.medium.scattering.is_some());
        let run = first..first + murky.map_or(flat, |last| last + 1);
        first = run.end.max(first + 1);
        let is_last = run.end == layers.len() && murky.is_none();
        // All layers together, without a scatterer, have a way of their own.
        let with_mirror = match is_last && !run.is_empty() {
            true => Meetings::with_mirror(scene, run.clone()),
            false => None,
        };
        let meets_mirror = with_mirror.is_some();
        let meetings = with_mirror.unwrap_or_else(|| Meetings::within(scene, run.clone()));
        if meetings.mix() && !(meets_mirror && run.start == 0) {
            found.push(Run { layers: run, meets_mirror });
        }
    }
    found
}

/// Layers for light of one polarisation.
fn of_polarisation(
    scene: &Scene,
    layers: &[Layer],
    polarisation: Polarisation,
) -> Result<Vec<Layer>, DisplayError> {
    let nm = scene.grid.wavelengths_nm();
    let air = Spectrum::constant(&scene.grid, 1.0);
    let mut above = &air;
    let mut made = Vec::with_capacity(layers.len());
    for (described, layer) in scene.display.layers.iter().zip(layers) {
        let below = &described.medium.index;
        let interface = match &described.interface {
            scene::Interface::Coating(coating) => {
                let made = Coating::of(polarisation, &nm, above, &coating.films, below);
                Interface::Coating(made.map_err(|error| DisplayError::of_coating(error, &coating.key))?)
            }
            scene::Interface::Ready(Ready::Fresnel) => Interface::FresnelOf(polarisation),
            _ => layer.interface.clone(),
        };
        made.push(Layer { interface, ..layer.clone() });
        above = below;
    }
    Ok(made)
}

/// Returns the layers with each of these runs as one interface; `both` are the layers for light of s and of p.
fn in_runs(layers: &[Layer], both: [&[Layer]; 2], runs: &[Run]) -> Vec<Layer> {
    let mut made = Vec::with_capacity(layers.len());
    let mut next = 0;
    for Run { layers: run, .. } in runs {
        made.extend_from_slice(&layers[next..run.start]);
        let interfaces =
            both.map(|own| own[run.clone()].iter().map(|layer| layer.interface.clone()).collect());
        let (last, inner) = (&layers[run.end - 1], &layers[run.start..run.end - 1]);
        let media = inner.iter().map(|layer| layer.medium.clone()).collect();
        let interface = Interface::Run(Box::new(FlatRun::new(interfaces, media)));
        made.push(Layer { interface, ..last.clone() });
        next = run.end;
    }
    made.extend_from_slice(&layers[next..]);
    made
}
