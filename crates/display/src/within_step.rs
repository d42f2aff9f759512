//! What tabulated spectra change within a step of the wavelength grid.
//!
//! A run knows reflectances at the wavelengths of the grid, and they are linear between them. Tables may have detail there, which the same
//! display with its spectra at every nanometre shows. It is compared by a *scalar estimate* of the reflectance: one transmittance and one reflectance
//! for each layer, and all orders of reflection between them. The estimate at every nanometre, over the straight lines between the
//! estimates at the wavelengths of the grid, is the factor by which the reflectance factors of a run are off.
//!
//! There are two estimates: light along the normal; and oblique light, whose way through media is longer, and which smooth interfaces send back
//! from inside as they do diffuse light. The table of a pixel has one of each for several of its angles. The largest error is reported.
//!
//! Films and liquid crystals have their fringes elsewhere (`Scene::unresolved`): here, they change only by their materials.

use num_complex::Complex64;
use papilio_optics::film::{Film as Coherent, Layer as Sheet, Polarisation, coherent};
use papilio_spectra::{Grid, Spectrum};

use crate::DisplayError;
use crate::pixel::scan;
use crate::scene::{
    Coating, CrystalPixel, Depolarisation, Display, FilmLayer, FilterState, Interface, Layer, Length, Medium,
    Pixel, Ready, Scene, Thickness, UniformKind,
};

/// Length of an oblique pass of a medium over that along the normal.
const OBLIQUE: f64 = 1.4;
/// Largest number of angles of a table that are examined.
const MOST_ANGLES: usize = 6;
/// Changes below this are rounding.
const ROUNDING: f64 = 1e-12;

/// Relative changes of reflectance factors within a step of the grid.
#[derive(Debug, Clone, PartialEq)]
pub struct WithinStep {
    /// The two neighbours of every nanometre on the grid: the first, and the weight of the second.
    between: Vec<(usize, f64)>,
    estimates: Vec<Change>,
    is_known: bool,
}

/// One estimate: at every nanometre, the relative change of light.
#[derive(Debug, Clone, PartialEq)]
struct Change {
    /// That has met the pixel, in each state.
    via_pixel: Vec<Vec<f64>>,
    /// That has not.
    front: Vec<f64>,
}

/// What an element does to light from above and from below.
#[derive(Debug, Clone, Copy)]
struct Element {
    /// Transmittance downwards and upwards.
    through: [f64; 2],
    /// Reflectance from above and from below.
    back: [f64; 2],
}

/// How light passes the layers in an estimate.
#[derive(Debug, Clone, Copy)]
struct Passage {
    /// Length of a pass over that along the normal.
    length: f64,
    /// Whether light from inside is diffuse.
    is_diffuse: bool,
}

impl WithinStep {
    /// Compares the display of a scene with the same display whose spectra are known at every nanometre within the grid. `is_known`: the user
    /// has been warned. `None` if nothing changes, or if a film or liquid crystal cannot be computed.
    pub fn new(scene: &Scene, finer: &Display, is_known: bool) -> Option<Self> {
        let every_nm = scene.grid.integers().ok()?;
        let between = |nm: f64| {
            let mut pair = scene.grid.between(nm);
            let (left, _) = pair.next()?;
            Some((left, pair.next().map_or(0.0, |(_, share)| share)))
        };
        let between: Vec<(usize, f64)> =
            every_nm.wavelengths_nm().into_iter().map(between).collect::<Option<_>>()?;
        let grids = Grids { coarse: scene.grid, every_nm, between: &between };
        let estimates = changes(scene, finer, &grids).ok()?;
        let is_any = |change: &Change| {
            change.via_pixel.iter().chain([&change.front]).flatten().any(|change| change.abs() > ROUNDING)
        };
        let is_changed = estimates.iter().any(is_any);
        is_changed.then_some(Self { between, estimates, is_known })
    }

    /// Number of estimates.
    pub(crate) fn estimates(&self) -> usize {
        self.estimates.len()
    }

    /// Whether the user has been warned of a table.
    pub(crate) fn is_known(&self) -> bool {
        self.is_known
    }

    /// Adds the changes of X, Y and Z of a state, of each estimate in its turn, from reflectance factors on the grid via the pixel and
    /// without it, and weights at every nanometre.
    pub(crate) fn add(
        &self,
        (base, front): (&[f64], &[f64]),
        state: usize,
        weights: &[Vec<f64>; 3],
        out: &mut [f64],
    ) {
        // A scene at other wavelengths has no changes.
        let is_own = |last: &(usize, f64)| last.0 + 2 == base.len() && weights[0].len() == self.between.len();
        if !self.between.last().is_some_and(is_own) {
            return;
        }
        for (change, out) in self.estimates.iter().zip(out.chunks_exact_mut(3)) {
            let Some(via_pixel) = change.via_pixel.get(state) else { continue };
            for (k, (left, share)) in self.between.iter().enumerate() {
                let at = |values: &[f64]| (1.0 - share) * values[*left] + share * values[left + 1];
                let off = at(base) * via_pixel[k] + at(front) * change.front[k];
                out.iter_mut().zip(weights).for_each(|(out, weights)| *out += weights[k] * off);
            }
        }
    }
}

/// The grid, and every nanometre within it.
struct Grids<'a> {
    coarse: Grid,
    every_nm: Grid,
    between: &'a [(usize, f64)],
}

impl Grids<'_> {
    /// Values at every nanometre on straight lines between those of the grid.
    fn lines(&self, values: &[f64]) -> Vec<f64> {
        self.between
            .iter()
            .map(|(left, share)| (1.0 - share) * values[*left] + share * values[left + 1])
            .collect()
    }

    fn complex_lines(&self, values: &[Complex64]) -> Vec<Complex64> {
        let at = |(left, share): &(usize, f64)| values[*left] * (1.0 - share) + values[left + 1] * *share;
        self.between.iter().map(at).collect()
    }
}

/// Returns all estimates.
fn changes(scene: &Scene, finer: &Display, grids: &Grids<'_>) -> Result<Vec<Change>, DisplayError> {
    let display = &scene.display;
    let is_diffuse = !display.is_flat()
        || match &display.pixel {
            Pixel::Uniform(pixel) => pixel.kind == UniformKind::Lambertian,
            Pixel::Scattering(_) => true,
            Pixel::Film(_) | Pixel::Table(_) | Pixel::Crystal(_) => false,
        };
    let passages = [Passage { length: 1.0, is_diffuse: false }, Passage { length: OBLIQUE, is_diffuse }];
    let angles = match &display.pixel {
        Pixel::Table(table) => table.states.first().map_or(1, |state| state.reflectance.len()),
        _ => 1,
    };
    let count = angles.min(MOST_ANGLES);
    let angle = |number: usize| number * (angles - 1) / (count - 1).max(1);
    let pixels = (0..count).map(|number| {
        let of = |is_fine: bool| states(scene, finer, grids, is_fine, angle(number));
        Ok((of(false)?, of(true)?))
    });
    let pixels: Vec<_> = pixels.collect::<Result<_, DisplayError>>()?;
    let mut all = Vec::new();
    for passage in passages {
        let stacks = [false, true].map(|is_fine| stack(display, finer, grids, is_fine, passage));
        let change = |[grid, each]: [Vec<f64>; 2]| -> Vec<f64> {
            let relative = |(each, line): (f64, f64)| if line > 0.0 { each / line - 1.0 } else { 0.0 };
            each.into_iter().zip(grids.lines(&grid)).map(relative).collect()
        };
        let fronts = || stacks.each_ref().map(|stack| stack.iter().map(|element| element.back[0]).collect());
        for (coarse, fine) in &pixels {
            let (coarse, fine) = (filtered(coarse, display, passage), filtered(fine, finer, passage));
            let via = |stack: &[Element], pixel: Vec<f64>| -> Vec<f64> {
                stack.iter().zip(pixel).map(|(stack, pixel)| stack.via(pixel)).collect()
            };
            let via_pixel = coarse
                .into_iter()
                .zip(fine)
                .map(|(coarse, fine)| change([via(&stacks[0], coarse), via(&stacks[1], fine)]));
            all.push(Change { via_pixel: via_pixel.collect(), front: change(fronts()) });
        }
    }
    Ok(all)
}

impl Element {
    const NOTHING: Self = Self { through: [1.0; 2], back: [0.0; 2] };

    /// This element and another below it, with all orders of reflection between them.
    fn over(self, below: Self) -> Self {
        let orders = 1.0 / (1.0 - self.back[1] * below.back[0]).max(ROUNDING);
        let [down, up] = self.through;
        let [further_down, further_up] = below.through;
        Self {
            through: [down * further_down * orders, up * further_up * orders],
            back: [
                self.back[0] + down * below.back[0] * up * orders,
                below.back[1] + further_up * self.back[1] * further_down * orders,
            ],
        }
    }

    /// Light that has met a pixel of this reflectance.
    fn via(&self, pixel: f64) -> f64 {
        self.through[0] * pixel * self.through[1] / (1.0 - self.back[1] * pixel).max(ROUNDING)
    }
}

/// Returns the layers above the pixel as one element, at each wavelength of the grid or at every nanometre.
fn stack(
    display: &Display,
    finer: &Display,
    grids: &Grids<'_>,
    is_fine: bool,
    passage: Passage,
) -> Vec<Element> {
    let (grid, own) = if is_fine { (grids.every_nm, finer) } else { (grids.coarse, display) };
    let mut all = vec![Element::NOTHING; grid.len()];
    let mut above = Spectrum::constant(&grid, 1.0);
    for (layer, coarse) in own.layers.iter().zip(&display.layers) {
        let coated = match (&layer.interface, &coarse.interface) {
            (Interface::Coating(own), Interface::Coating(coarse_own)) => {
                Some(coating((own, coarse_own), (&above, &layer.medium.index), grids, is_fine))
            }
            _ => None,
        };
        for (bin, all) in all.iter_mut().enumerate() {
            let indices = [above[bin], layer.medium.index[bin]];
            let r = coated.as_ref().map(|coated| coated[bin]);
            *all = all.over(interface(layer, bin, indices, r, passage)).over(medium(
                &layer.medium,
                bin,
                passage,
            ));
        }
        above = layer.medium.index.clone();
    }
    all
}

/// A smooth interface that transmits and reflects these fractions of light along the normal.
fn smooth(t: f64, r: f64, [above, below]: [f64; 2], passage: Passage) -> Element {
    if !passage.is_diffuse || above >= below {
        return Element { through: [t; 2], back: [r; 2] };
    }
    // Diffuse light from inside: what is beyond the critical angle returns.
    let escaping = (above / below).powi(2);
    Element { through: [t, t * escaping], back: [r, 1.0 - (1.0 - r) * escaping] }
}

fn interface(
    layer: &Layer,
    bin: usize,
    indices: [f64; 2],
    coated: Option<[f64; 2]>,
    passage: Passage,
) -> Element {
    let bare = || {
        let r = ((indices[0] - indices[1]) / (indices[0] + indices[1])).powi(2);
        smooth(1.0 - r, r, indices, passage)
    };
    let passing = |t: f64| Element { through: [t; 2], back: [0.0; 2] };
    let transmitted = |ready: &Ready| match ready {
        Ready::Diffuser(diffuser) => diffuser.transmittance[bin],
        Ready::Scatter(face) => {
            face.straight()[bin] + face.transmission().map_or(0.0, |kernel| kernel.factor[bin])
        }
        _ => 1.0,
    };
    match &layer.interface {
        Interface::Coating(_) => coated.map_or(Element::NOTHING, |[t, r]| smooth(t, r, indices, passage)),
        Interface::Rough { .. } | Interface::OfSurface(_) => bare(),
        Interface::Ready(ready) => match ready {
            Ready::Open => Element::NOTHING,
            Ready::IdealAr => smooth(1.0, 0.0, indices, passage),
            Ready::Component(component) => {
                let r = component.reflectance[bin];
                Element { through: [1.0 - r - component.absorptance[bin]; 2], back: [r; 2] }
            }
            Ready::Diffuser(_) | Ready::Scatter(_) => passing(transmitted(ready)),
            Ready::Reflecting(diffuser) => {
                let back = diffuser.reflections().each_ref().map(|side| {
                    side.as_ref().map_or(0.0, |side| side.scattered()[bin] + side.mirrored()[bin])
                });
                Element { through: [transmitted(diffuser.transmission()); 2], back }
            }
            _ => bare(),
        },
    }
}

/// A medium: what it absorbs, and the two streams of light in one that scatters (Kubelka & Munk).
fn medium(medium: &Medium, bin: usize, passage: Passage) -> Element {
    let t = medium.transmittance[bin].powf(passage.length);
    let Some(scattering) = &medium.scattering else { return Element { through: [t; 2], back: [0.0; 2] } };
    let (albedo, thickness) = (scattering.albedo[bin], scattering.optical_thickness);
    let s = (0.75 * albedo * (1.0 - scattering.anisotropy) * thickness).max(ROUNDING);
    let k = 2.0 * (1.0 - albedo) * thickness;
    let a = (s + k) / s;
    let b = (a * a - 1.0).max(ROUNDING).sqrt();
    let depth = (b * s).min(300.0);
    let whole = a * depth.sinh() + b * depth.cosh();
    Element { through: [t * b / whole; 2], back: [depth.sinh() / whole; 2] }
}

/// Transmittance and reflectance of a coating along the normal. At every nanometre, its fringes are straight lines between the
/// wavelengths of the grid, and its materials are its own.
fn coating(
    (own, coarse): (&Coating, &Coating),
    (above, below): (&Spectrum, &Spectrum),
    grids: &Grids<'_>,
    is_fine: bool,
) -> Vec<[f64; 2]> {
    let at = |films: &[FilmLayer], nm: f64, bin: usize, indices: [f64; 2]| {
        let layers = films.iter().map(|film| Sheet {
            index: film.index[bin],
            thickness_nm: match film.thickness {
                Thickness::Fixed(nm) => nm,
                Thickness::Gap => 0.0,
            },
        });
        let film = Coherent { incidence: indices[0], layers: layers.collect(), substrate: indices[1].into() };
        coherent(&film, nm, 0.0, Polarisation::S)
            .map_or([1.0, 0.0], |film| [film.transmittance, film.reflectance])
    };
    let grid = if is_fine { &grids.every_nm } else { &grids.coarse };
    let indices = |bin: usize| [above[bin], below[bin]];
    let all = |films: &[FilmLayer]| -> Vec<[f64; 2]> {
        (0..grid.len()).map(|bin| at(films, grid.wavelength_nm(bin), bin, indices(bin))).collect()
    };
    let own = all(&own.films);
    if !is_fine {
        return own;
    }
    let lines = |film: &FilmLayer| FilmLayer { index: grids.complex_lines(&film.index), ..film.clone() };
    let without = all(&coarse.films.iter().map(lines).collect::<Vec<_>>());
    // Of the grid itself, at every nanometre.
    let start = grids.coarse.start_nm() - grids.every_nm.start_nm();
    let nodes = (0..grids.coarse.len()).map(|bin| {
        let nearest = (start + bin as f64 * grids.coarse.step_nm()).round().max(0.0) as usize;
        without[nearest.min(without.len() - 1)]
    });
    let nodes: Vec<[f64; 2]> = nodes.collect();
    let [t, r] = [0, 1].map(|k| grids.lines(&nodes.iter().map(|node| node[k]).collect::<Vec<f64>>()));
    let changed = |k: usize| {
        let line = [t[k], r[k]];
        std::array::from_fn(|q| (line[q] + own[k][q] - without[k][q]).clamp(0.0, 1.0))
    };
    (0..own.len()).map(changed).collect()
}

/// Returns the reflectance of each state of the pixel, at each wavelength of the grid or at every nanometre.
fn states(
    scene: &Scene,
    finer: &Display,
    grids: &Grids<'_>,
    is_fine: bool,
    angle: usize,
) -> Result<Vec<Vec<f64>>, DisplayError> {
    let display = &scene.display;
    let coarse = || along_normal(scene, &display.pixel, grids.coarse, display.index_above_pixel());
    Ok(match if is_fine { &finer.pixel } else { &display.pixel } {
        Pixel::Uniform(pixel) => pixel.states.iter().map(|(_, state)| state.to_vec()).collect(),
        Pixel::Table(pixel) => pixel.states.iter().map(|state| state.reflectance[angle].to_vec()).collect(),
        Pixel::Scattering(pixel) => pixel.states.iter().map(|(_, kernel)| kernel.factor.to_vec()).collect(),
        Pixel::Film(_) | Pixel::Crystal(_) if !is_fine => coarse()?,
        pixel @ Pixel::Film(_) => {
            let of = |pixel: &Pixel| along_normal(scene, pixel, grids.every_nm, finer.index_above_pixel());
            let (own, without) = (of(pixel)?, of(&film_in_lines(&display.pixel, grids))?);
            let add = |((line, own), without): ((Vec<f64>, Vec<f64>), Vec<f64>)| -> Vec<f64> {
                let both = line.into_iter().zip(own).zip(without);
                both.map(|((line, own), without)| (line + own - without).clamp(0.0, 1.0)).collect()
            };
            let lines = coarse()?.into_iter().map(|state| grids.lines(&state));
            lines.zip(own).zip(without).map(add).collect()
        }
        Pixel::Crystal(pixel) => crystal_states(scene, pixel, grids, coarse()?)?,
    })
}

/// Returns the reflectance of each state of a liquid crystal at every nanometre, from that on the grid. A reflectance is taken for
/// exponential in its spectra, which is exact for absorption: a change of each at the wavelengths of the grid tells how much.
fn crystal_states(
    scene: &Scene,
    finer: &CrystalPixel,
    grids: &Grids<'_>,
    coarse: Vec<Vec<f64>>,
) -> Result<Vec<Vec<f64>>, DisplayError> {
    let display = &scene.display;
    let Pixel::Crystal(pixel) = &display.pixel else { return Ok(Vec::new()) };
    // Deviations from the lines between the wavelengths of the grid, each with the numbers of the spectra that have it.
    let mut deviations: Vec<(Vec<f64>, Vec<usize>)> = Vec::new();
    for (number, (own, on_grid)) in spectra(finer).into_iter().zip(spectra(pixel)).enumerate() {
        let off: Vec<f64> = own.iter().zip(grids.lines(&on_grid)).map(|(own, line)| own - line).collect();
        match deviations.iter_mut().find(|(known, _)| *known == off) {
            Some((_, numbers)) => numbers.push(number),
            None => deviations.push((off, vec![number])),
        }
    }
    let mut exponents = vec![vec![0.0; grids.between.len()]; coarse.len()];
    for (off, numbers) in deviations {
        let most = off.iter().fold(0.0_f64, |most, off| most.max(off.abs()));
        if most <= ROUNDING {
            continue;
        }
        let changed = Pixel::Crystal(with_more(pixel, &numbers, most));
        let changed = along_normal(scene, &changed, grids.coarse, display.index_above_pixel())?;
        for ((exponents, changed), coarse) in exponents.iter_mut().zip(changed).zip(&coarse) {
            let slope = |(changed, coarse): (f64, &f64)| match changed > 0.0 && *coarse > 0.0 {
                true => (changed / coarse).ln() / most,
                false => 0.0,
            };
            let slopes: Vec<f64> = changed.into_iter().zip(coarse).map(slope).collect();
            let each = exponents.iter_mut().zip(grids.lines(&slopes)).zip(&off);
            each.for_each(|((exponent, slope), off)| *exponent += slope * off);
        }
    }
    let of_state = |(coarse, exponents): (Vec<f64>, Vec<f64>)| {
        let lines = grids.lines(&coarse).into_iter().zip(exponents);
        lines.map(|(line, exponent)| (line * exponent.exp()).clamp(0.0, 1.0)).collect()
    };
    Ok(coarse.into_iter().zip(exponents).map(of_state).collect())
}

/// All spectra of a liquid crystal: n and k of the layers along their axes, and of the substrate; the inactive area.
fn spectra(pixel: &CrystalPixel) -> Vec<Vec<f64>> {
    let indices = pixel.parts.iter().flat_map(|part| &part.indices).chain([&pixel.substrate]);
    let both = indices.flat_map(|index| {
        [index.iter().map(|index| index.re).collect(), index.iter().map(|index| index.im).collect()]
    });
    both.chain([pixel.inactive_reflectance.to_vec()]).collect()
}

/// The same liquid crystal with more of some of its [`spectra`].
fn with_more(pixel: &CrystalPixel, numbers: &[usize], more: f64) -> CrystalPixel {
    let mut pixel = pixel.clone();
    let at = |number: usize| if numbers.contains(&number) { more } else { 0.0 };
    let indices = pixel.parts.iter_mut().flat_map(|part| &mut part.indices).chain([&mut pixel.substrate]);
    let mut count = 0;
    for index in indices {
        let more = Complex64::new(at(count), at(count + 1));
        index.iter_mut().for_each(|index| *index += more);
        count += 2;
    }
    let inactive = pixel.inactive_reflectance.iter().map(|value| value + at(count));
    pixel.inactive_reflectance = inactive.collect::<Vec<f64>>().into();
    pixel
}

/// Returns the reflectance of each state of a pixel on this grid, along the normal, below a medium of this index.
fn along_normal(
    scene: &Scene,
    pixel: &Pixel,
    grid: Grid,
    index: &Spectrum,
) -> Result<Vec<Vec<f64>>, DisplayError> {
    let layer = Layer {
        interface: Interface::Ready(Ready::Fresnel),
        medium: Medium::clear(index.clone()),
        thickness: Length::Mm(0.0),
        depolarisation: Depolarisation::default(),
    };
    let display = Display { layers: vec![layer], pixel: pixel.clone(), matrix: None };
    let scan = scan(&Scene { grid, display, within_step: None, ..scene.clone() }, &[0.0])?;
    Ok(scan.states.into_iter().map(|(_, state)| state).collect())
}

/// Returns the states of the display: those of the pixel, or of it below a colour filter.
fn filtered(states: &[Vec<f64>], display: &Display, passage: Passage) -> Vec<Vec<f64>> {
    let (Some(filter), Some(matrix)) = (display.filter(), &display.matrix) else { return states.to_vec() };
    let of_state = |state: &FilterState| {
        let mut sum = vec![0.0; states.first().map_or(0, Vec::len)];
        let windows = matrix.sub_pixels.iter().zip(&filter.transmittance);
        for (pixel, (window, t)) in state.pixel_states.iter().zip(windows) {
            for (bin, sum) in sum.iter_mut().enumerate() {
                *sum += window.fraction * states[*pixel][bin] * t[bin].powf(2.0 * passage.length);
            }
        }
        sum
    };
    filter.states.iter().map(of_state).collect()
}

/// The same pixel of films with materials on straight lines between the wavelengths of the grid.
fn film_in_lines(pixel: &Pixel, grids: &Grids<'_>) -> Pixel {
    let mut pixel = pixel.clone();
    if let Pixel::Film(film) = &mut pixel {
        film.layers.iter_mut().for_each(|layer| layer.index = grids.complex_lines(&layer.index));
        film.substrate = grids.complex_lines(&film.substrate);
        film.inactive_reflectance = grids.lines(&film.inactive_reflectance).into();
    }
    pixel
}
