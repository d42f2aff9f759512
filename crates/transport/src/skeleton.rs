//! The flat skeleton of a stack: transport of light of one direction without scattering.
//!
//! At given direction cosines everything flat reflects and transmits light without changing them. A scatterer
//! is replaced by its regular part: a diffuser by s T, a scattering medium by exp(-tau/mu), a rough interface
//! and a Lambertian base by nothing. The result is a row of parts with reflectances and one transmittance
//! each. All their inter-reflections are summed in closed form, for every wavelength and, where the base is a
//! mirror, for every state.
//!
//! Layers that are the same at every wavelength are computed once: the arrays of one *band*. Otherwise each
//! wavelength is a band of its own.
//!
//! *Elements* are counted from the top: interface, medium, interface, medium ... *Planes* are between them:
//! plane 0 in the air above all elements, plane e above element e, the last one on the base. A [`Field`]
//! contains the light at every plane, in both directions, that one unit of basic radiance causes. All parts
//! are reciprocal: the light going down at a plane, per unit that enters from the air, is also the fraction
//! of light emitted upwards there that leaves.

use papilio_optics::{Beta, with_widest_simd};

use crate::front::Flat;
use crate::layers::LayerKind;
use crate::{Base, Medium, Reflector, Stack};

/// Whether light propagates down or up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Propagation {
    Down,
    Up,
}

impl Propagation {
    /// The other way.
    pub(crate) fn reversed(self) -> Self {
        match self {
            Self::Down => Self::Up,
            Self::Up => Self::Down,
        }
    }
}

/// Light at a plane, propagating down or up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Ray {
    pub(crate) plane: usize,
    pub(crate) going: Propagation,
}

impl Ray {
    /// In the air, towards the display.
    pub(crate) const ENTERING: Self = Self { plane: 0, going: Propagation::Down };

    /// In the air, away from the display.
    pub(crate) const LEAVING: Self = Self { plane: 0, going: Propagation::Up };

    /// The ray that arrives at `element`.
    pub(crate) fn arriving_at(element: usize, going: Propagation) -> Self {
        match going {
            Propagation::Down => Self { plane: element, going },
            Propagation::Up => Self { plane: element + 1, going },
        }
    }

    /// The ray that leaves `element`.
    pub(crate) fn from_element(element: usize, going: Propagation) -> Self {
        match going {
            Propagation::Down => Self { plane: element + 1, going },
            Propagation::Up => Self { plane: element, going },
        }
    }

    /// The ray of the opposite propagation.
    pub(crate) fn reversed(self) -> Self {
        Self { going: self.going.reversed(), ..self }
    }
}

/// Flat parts of a stack at one direction, and the reflectances above and below each plane.
#[derive(Debug, Clone)]
pub(crate) struct Skeleton {
    air: Medium,
    bins: usize,
    /// Number of bands: 1 if the layers are the same at every wavelength, else the number of wavelengths.
    bands: usize,
    /// `|beta|` of the light.
    length: f64,
    /// The elements; shape `[element][band]`.
    parts: Vec<Part>,
    /// Reflectance of everything above a plane, seen from it; shape `[plane][band]`.
    above: Vec<f64>,
    /// The same of everything below, over a black base.
    below: Vec<f64>,
    /// The base's reflectance; shape `[state][wavelength]`, 0 where it scatters.
    base: Vec<f64>,
    /// True if the base is a mirror, and light is followed through it.
    mirror: bool,
}

/// An element at one direction and wavelength.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Part {
    pub(crate) flat: Flat,
    /// Fraction scattered, of light from above and from below.
    pub(crate) scattered: [f64; 2],
}

impl Part {
    pub(crate) const fn flat(flat: Flat) -> Self {
        Self { flat, scattered: [0.0; 2] }
    }

    /// Fraction absorbed, of light that arrives going down or up.
    #[inline]
    pub(crate) fn absorbed(&self, going: Propagation) -> f64 {
        let reflected = match going {
            Propagation::Down => self.flat.above,
            Propagation::Up => self.flat.below,
        };
        1.0 - self.flat.t - reflected - self.scattered[going as usize]
    }
}

impl Skeleton {
    /// An empty skeleton of these layers over a base, which may have fewer wavelengths if the layers are
    /// grey.
    pub(crate) fn new(stack: &Stack, base: &Base) -> Self {
        let bins = base.bins();
        let bands = if stack.is_grey() { 1 } else { bins };
        let elements = 2 * stack.layers.len();
        Self {
            air: Medium::new(vec![1.0; bins].into()),
            bins,
            bands,
            length: 0.0,
            parts: vec![Part::flat(Flat::CLEAR); elements * bands],
            above: vec![0.0; (elements + 1) * bands],
            below: vec![0.0; (elements + 1) * bands],
            base: vec![0.0; base.states() * bins],
            mirror: base.is_specular(),
        }
    }

    /// An empty field of this skeleton.
    pub(crate) fn field(&self) -> Field {
        let currents = || Currents { down: vec![0.0; self.above.len()], up: vec![0.0; self.above.len()] };
        Field { bands: self.bands, direct: currents(), risen: currents(), rising: vec![0.0; self.base.len()] }
    }

    /// The number of elements.
    pub(crate) fn elements(&self) -> usize {
        self.parts.len() / self.bands
    }

    /// `|beta|` of the light that it is prepared for.
    pub(crate) fn length(&self) -> f64 {
        self.length
    }

    /// An element, by band.
    pub(crate) fn element(&self, element: usize) -> &[Part] {
        &self.parts[element * self.bands..][..self.bands]
    }

    /// Prepares it for light with these direction cosines; their azimuth counts only for the base.
    pub(crate) fn set(&mut self, stack: &Stack, base: &Base, beta: Beta) {
        let beta_squared = beta.squared();
        self.length = beta_squared.sqrt();
        let mut upper = &self.air;
        for (layer, parts) in stack.layers.iter().zip(self.parts.chunks_exact_mut(2 * self.bands)) {
            let (interface, medium) = parts.split_at_mut(self.bands);
            layer.interface.kind().parts([upper, &layer.medium], beta_squared, interface);
            layer.medium.parts([&layer.medium; 2], beta_squared, medium);
            upper = &layer.medium;
        }
        match &base.reflector {
            Reflector::Specular(_) => stack.reflectance_of(base, beta, upper, &mut self.base),
            Reflector::Lambertian(_) | Reflector::Scattering(_) => {}
        }
        self.combine();
    }

    /// What lies above and below each plane.
    fn combine(&mut self) {
        let bands = self.bands;
        for (k, part) in self.parts.iter().enumerate() {
            let upper = Flat { t: 0.0, above: 0.0, below: self.above[k] };
            self.above[k + bands] = upper.over(part.flat).below;
        }
        for (k, part) in self.parts.iter().enumerate().rev() {
            let Flat { t, above, below } = part.flat;
            self.below[k] = above + t * passing(t, below * self.below[k + bands]) * self.below[k + bands];
        }
    }

    /// Computes the field of one unit of light emitted as `ray`.
    pub(crate) fn emit(&self, ray: Ray, field: &mut Field) {
        let last = self.elements();
        field.direct.clear();
        if self.mirror {
            field.risen.clear();
        }
        for band in 0..self.bands {
            self.spread(ray, band, &mut field.direct);
        }
        if !self.mirror {
            return;
        }
        for band in 0..self.bands {
            // Over a black base: returns to the base are in `rising`.
            self.spread(Ray { plane: last, going: Propagation::Up }, band, &mut field.risen);
        }
        let arriving = &field.direct.down[last * self.bands..];
        let above = &self.above[last * self.bands..];
        with_widest_simd(
            #[inline(always)]
            || match (arriving, above) {
                ([arriving], [above]) => {
                    let pairs = field.rising.iter_mut().zip(&self.base);
                    pairs.for_each(|(rising, r)| *rising = r * passing(*arriving, r * above));
                }
                _ => {
                    let rows =
                        field.rising.chunks_exact_mut(self.bins).zip(self.base.chunks_exact(self.bins));
                    for (rising, r) in rows {
                        for bin in 0..self.bins {
                            rising[bin] = r[bin] * passing(arriving[bin], r[bin] * above[bin]);
                        }
                    }
                }
            },
        );
    }

    /// Light at all planes for one unit over a black base, in one band.
    fn spread(&self, ray: Ray, band: usize, to: &mut Currents) {
        let at = |plane: usize| plane * self.bands + band;
        let start = at(ray.plane);
        let sent = passing(1.0, self.above[start] * self.below[start]);
        (to.down[start], to.up[start]) = match ray.going {
            Propagation::Down => (sent, sent * self.below[start]),
            Propagation::Up => (sent * self.above[start], sent),
        };
        let mut down = to.down[start];
        for plane in ray.plane..self.elements() {
            let Flat { t, below, .. } = self.parts[at(plane)].flat;
            down *= passing(t, below * self.below[at(plane + 1)]);
            to.down[at(plane + 1)] = down;
            to.up[at(plane + 1)] = down * self.below[at(plane + 1)];
        }
        let mut up = to.up[start];
        for plane in (0..ray.plane).rev() {
            let Flat { t, above, .. } = self.parts[at(plane)].flat;
            up *= passing(t, above * self.above[at(plane)]);
            to.up[at(plane)] = up;
            to.down[at(plane)] = up * self.above[at(plane)];
        }
    }
}

/// Light that passes a part and is then reflected to and fro behind it, a fraction `returned` each time.
/// Nothing enters a closed box of perfect mirrors.
#[inline]
fn passing(t: f64, returned: f64) -> f64 {
    if t == 0.0 || returned >= 1.0 { 0.0 } else { t / (1.0 - returned) }
}

/// Light at every plane, per unit emitted. Light via a specular base is `risen`, by wavelength, times
/// `rising`, by state and wavelength.
#[derive(Debug, Clone)]
pub(crate) struct Field {
    bands: usize,
    /// Light that has not met the base.
    pub(crate) direct: Currents,
    /// Light that has met the base, per unit that rises from it.
    pub(crate) risen: Currents,
    /// Light that rises from the base, all returns to it included; shape `[state][wavelength]`.
    pub(crate) rising: Vec<f64>,
}

impl Field {
    /// Light that travels as `ray`, per band: light that has not met the base, and per unit that rises from
    /// it.
    #[inline]
    pub(crate) fn at(&self, ray: Ray) -> (&[f64], &[f64]) {
        let at = ray.plane * self.bands;
        (&self.direct.going(ray.going)[at..][..self.bands], &self.risen.going(ray.going)[at..][..self.bands])
    }
}

/// Light going down and up; shape `[plane][band]`.
#[derive(Debug, Clone)]
pub(crate) struct Currents {
    down: Vec<f64>,
    up: Vec<f64>,
}

impl Currents {
    fn clear(&mut self) {
        self.down.fill(0.0);
        self.up.fill(0.0);
    }

    #[inline]
    fn going(&self, going: Propagation) -> &[f64] {
        match going {
            Propagation::Down => &self.down,
            Propagation::Up => &self.up,
        }
    }
}
