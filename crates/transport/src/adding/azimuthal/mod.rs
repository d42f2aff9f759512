//! A diffuser above a mirror-like pixel that depends on azimuth, such as a liquid crystal: light by direction.
//!
//! Elsewhere Fourier orders over the azimuth are followed one by one; such a pixel mixes them.
//!
//! # Method
//! With the light `E` of a source below the diffuser, the light `V` of the view there, the reflectance `R` of the pixel and the light
//! `G` that the diffuser sends back down, the pixel receives `x = E + G R x`, and what is seen is `V R x`.
//!
//! - **First order**, `V R E`: an integral over a disc of directions: rings that are graded about those of lobes, each with uniform
//!   azimuths. The pixel is linear in the values of its table: the integral is a set of weights on its nodes and harmonics.
//! - **Further orders**, `V R (x - E)`, some per cent of that: on a coarser grid of the same kind, where G is a product of matrices
//!   for each azimuthal order. Orders are added until they are negligible.
//!
//! The regular light of a diffuser keeps its direction. Light counts as unpolarised, as below any scatterer.
//!
//! **Covered**: one k-correlation or Lambertian diffuser on clear glass without dispersion, with or without a reflection of its own that
//! has no mirror image from below; all light, if its directions are not too many. All other scatterers are for Monte Carlo.

mod film;
mod grid;

use std::f64::consts::PI;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use papilio_optics::{Beta, with_widest_simd};
use papilio_spectra::StateSpectra;

use self::film::{Film, Light, reflectance};
use self::grid::{Back, Grid};
use super::layered::is_same;
use crate::angular::add_rows;
use crate::light::cone_points::Point;
use crate::light::images::{ImagePoints, Mirror, image_points};
use crate::specular::layered_image;
use crate::{AngularTable, Base, Cone, Estimate, Ledger, Nodes, ReflectanceFactor, Reflector, Source, Stack};

/// Natural digits of level 0, of each further level, and the least.
const DIGITS: [f64; 3] = [8.0, 3.0, 4.0];

/// Digits that further orders have fewer: they are some per cent of the light.
const FEWER_DIGITS: f64 = 3.0;

/// Most numbers that light of further orders takes, and its kernels: half a gigabyte.
const MOST_NUMBERS: usize = 60_000_000;

/// Most directions of the first order.
const MOST_DIRECTIONS: usize = 4_000_000;

/// Most points of sources whose light a diffuser passes straight, and most pairs of points and directions: a second.
const MOST_POINTS: usize = 100;
const MOST_PAIRS: f64 = 3e8;

/// Light of further orders of all sources over a base.
#[derive(Debug)]
struct Returned {
    base: Base,
    /// Reflectance, `[node][column]`; a column is a state and a wavelength.
    rho: Vec<f64>,
    /// What the pixel reflects of the light that the diffuser has sent back down, by source, `[node][column]`.
    rises: Vec<Vec<f64>>,
}

/// Kernel prepared for a stack, its views and its sources.
#[derive(Debug)]
pub(super) struct Kernel {
    digits: f64,
    ledger: bool,
    film: Option<Film>,
    nodes: Nodes,
    views: Vec<Vec<Point>>,
    /// The last is diffuse light, for the ledger.
    sources: Vec<Light>,
    /// For each view, the mirror images in it.
    images: Vec<Vec<ImagePoints>>,
    /// Of the first order, with the harmonics of the pixel at its azimuths.
    grid: Grid,
    waves: Vec<f64>,
    /// Light of each source there.
    lit: Vec<Vec<f64>>,
    back: Option<Back>,
    last: Mutex<Option<Arc<Returned>>>,
}

impl Clone for Kernel {
    fn clone(&self) -> Self {
        Self {
            film: self.film.clone(),
            nodes: self.nodes.clone(),
            views: self.views.clone(),
            sources: self.sources.clone(),
            images: self.images.clone(),
            grid: self.grid.clone(),
            waves: self.waves.clone(),
            lit: self.lit.clone(),
            back: self.back.clone(),
            last: Mutex::new(self.last.lock().unwrap_or_else(PoisonError::into_inner).clone()),
            ..*self
        }
    }
}

/// Returns whether a stack is of this kind.
pub(super) fn applies(stack: &Stack) -> bool {
    Film::of(stack).is_some()
}

/// Estimates the work of a level, in seconds of one processor; `None` if these views and sources are not covered.
pub(super) fn seconds(stack: &Stack, views: &[Cone], sources: &[Source], level: f64) -> Option<f64> {
    /// Per direction of the first order and point of light, and per product of the further orders.
    const DIRECTION: f64 = 1e-8;
    const PRODUCT: f64 = 3e-10;
    /// Numbers of a node and column, besides those of the sources, while orders are added.
    const AT_WORK: usize = 8;
    let film = Film::of(stack)?;
    let Reflector::Specular(table) = &stack.base().reflector else { return None };
    let digits = digits(level);
    let [views, sources] = [film.views(stack.base(), views, digits), film.points_of(sources, views, digits)];
    let all = film.radii(views.iter().chain(&sources));
    let grid = film.grid_of(table, &all, digits);
    let count = |lists: &[Vec<Point>]| lists.iter().map(Vec::len).sum::<usize>();
    let [seen, lit] = [&views, &sources].map(|lists| count(lists));
    // Regular light of each point is sent back to all directions.
    let is_many = film.regular() > 0.0 && lit.max(seen / views.len().max(1)) > MOST_POINTS;
    if grid.len() > MOST_DIRECTIONS || is_many || lit as f64 * grid.len() as f64 > MOST_PAIRS {
        return None;
    }
    let of_sources = sources.len() + 1;
    let first = (grid.len() * (seen + lit + views.len() * of_sources)) as f64 * DIRECTION;
    let Some(lobe) = film.lobe_back() else { return Some(first) };
    let (grid, orders) = film.grid_back(table, lobe, &all, digits);
    let columns = stack.base().states() * stack.base().bins();
    let numbers = grid.len() * columns * (2 * of_sources + AT_WORK)
        + grid.rings.len().pow(2) * orders
        + 4 * orders * grid.azimuths;
    // About five orders, of each source and of the ledger of each view.
    let products = (2 * orders * grid.rings.len().pow(2) + 4 * orders * grid.len()) as f64 * columns as f64;
    let further = 5.0 * (of_sources + views.len()) as f64 * products * PRODUCT;
    (numbers <= MOST_NUMBERS).then_some(first + further)
}

fn digits(level: f64) -> f64 {
    let [first, more, least] = DIGITS;
    (first + more * level).max(least)
}

impl Kernel {
    pub(super) fn new(level: f64, ledger: bool) -> Self {
        Self {
            digits: digits(level),
            ledger,
            film: None,
            nodes: Nodes::Constant,
            views: Vec::new(),
            sources: Vec::new(),
            images: Vec::new(),
            grid: Grid { rings: Vec::new(), azimuths: 0 },
            waves: Vec::new(),
            lit: Vec::new(),
            back: None,
            last: Mutex::default(),
        }
    }

    /// Prepares views and sources; incomplete if `stop` is set during the computation.
    pub(super) fn prepare(&mut self, stack: &Stack, views: &[Cone], sources: &[Source], stop: &AtomicBool) {
        let (digits, ledger) = (self.digits, self.ledger);
        *self = Self { digits, ..Self::new(0.0, ledger) };
        let (Some(film), Reflector::Specular(table)) = (Film::of(stack), &stack.base().reflector) else {
            debug_assert!(false, "what is not covered is refused before");
            return;
        };
        self.nodes = table.nodes.clone();
        self.views = film.views(stack.base(), views, digits);
        let directed = film.points_of(sources, views, digits);
        let mirror = |view: &Cone| Mirror::Across(stack.base().nodes_across(view, &film.medium));
        self.images = views.iter().map(|view| image_points(view, sources, digits, mirror(view))).collect();
        let all = film.radii(self.views.iter().chain(&directed));
        self.grid = film.grid_of(table, &all, digits);
        self.waves = table.waves(self.grid.azimuths);
        self.back = film.lobe_back().map(|lobe| Back::new(&film, table, lobe, &all, digits));
        let light =
            |points: Vec<Point>| if points.is_empty() { Light::Diffuse } else { Light::Points(points) };
        self.sources = directed.into_iter().map(light).chain([Light::Diffuse]).collect();
        let lit = self.sources.iter().take_while(|_| !stop.load(Ordering::Relaxed));
        self.lit = lit.map(|light| self.grid.light(&film, light)).collect();
        self.film = Some(film);
    }

    /// Returns whether its directions are also right over this base.
    pub(super) fn serves(&self, stack: &Stack) -> bool {
        matches!(&stack.base().reflector, Reflector::Specular(table) if table.nodes == self.nodes)
    }

    pub(super) fn nodes(&self) -> usize {
        self.grid.rings.len()
    }

    /// Returns the estimate of a view; invalid if `stop` was set during the computation.
    pub(super) fn estimate(&self, stack: &Stack, view: usize, stop: &AtomicBool) -> Estimate {
        let (Some(film), Reflector::Specular(table)) = (&self.film, &stack.base().reflector) else {
            return Estimate::default();
        };
        let Some(returned) = self.returned(film, stack.base(), stop) else { return Estimate::default() };
        let points = &self.views[view];
        let own = Light::Points(points.clone());
        let of_view = self.grid.weighted(film, &own);
        let again = self.back.as_ref().map(|back| back.grid.weighted(film, &own)).unwrap_or_default();
        let seen = |(number, light): (usize, &Light)| ReflectanceFactor {
            via_pixel: self.via_pixel(film, table, (points, [&of_view, &again]), (number, &returned)),
            front: film.front(points, light),
        };
        let mut rho: Vec<ReflectanceFactor> = self.sources.iter().enumerate().map(seen).collect();
        let in_diffuse = rho.pop().unwrap_or_default().total();
        for image in &self.images[view] {
            for point in &image.points {
                rho[image.source].add(&layered_image(stack, point.beta), point.weight);
            }
        }
        let ledger = match self.ledger {
            true => {
                self.ledger(film, (stack.base(), table), (points, &of_view), (&returned, in_diffuse), stop)
            }
            false => Ledger::zeros(stack.base().states(), stack.base().bins()),
        };
        Estimate { rho, ledger }
    }

    /// Light of a source that a view sees via the pixel; `of_view` is its light on both grids, weighted.
    fn via_pixel(
        &self,
        film: &Film,
        table: &AngularTable,
        (points, [of_view, again]): (&[Point], [&[f64]; 2]),
        (number, returned): (usize, &Returned),
    ) -> StateSpectra {
        let (light, bins) = (&self.sources[number], film.diffuser.transmittance.len());
        let mut sum = table.sum_of(&self.first_order(film, table, (points, of_view), Some(number)));
        if self.back.is_some() {
            with_widest_simd(
                #[inline(always)]
                || add_rows(&mut sum, &returned.rises[number], again),
            );
            for point in points.iter().filter(|_| film.regular() > 0.0) {
                let arrives = self.sent_back_to(film, point.beta, (number, returned), table);
                let rho = reflectance(table, film, point.beta);
                let regular = film.regular() * point.weight;
                sum.iter_mut()
                    .zip(arrives.iter().zip(&rho))
                    .for_each(|(sum, (x, r))| *sum += regular * x * r);
            }
        }
        let scale = if *light == Light::Diffuse { 1.0 } else { PI };
        for (at, sum) in sum.iter_mut().enumerate() {
            *sum *= scale * film.diffuser.transmittance[at % bins].powi(2);
        }
        StateSpectra::new(sum, bins)
    }

    /// Light that the diffuser sends back to a direction which is no node, by column.
    fn sent_back_to(
        &self,
        film: &Film,
        to: Beta,
        (number, returned): (usize, &Returned),
        table: &AngularTable,
    ) -> Vec<f64> {
        let Some(back) = &self.back else { return vec![0.0; table.state_count() * table.common.len()] };
        let light = &self.sources[number];
        let columns = table.state_count() * table.common.len();
        let mut sum = vec![0.0; columns];
        let nodes: Vec<Point> = back.grid.points().collect();
        let weights: Vec<f64> =
            nodes.iter().map(|node| node.weight * film.sends_back(back.lobe, node.beta, to)).collect();
        add_rows(&mut sum, &returned.rises[number], &weights);
        let of_first =
            nodes.iter().zip(&weights).map(|(node, weight)| weight * film.arrives(light, node.beta));
        add_rows(&mut sum, &returned.rho, &of_first.collect::<Vec<_>>());
        if let Light::Points(points) = light {
            for point in points {
                let weight = film.regular() * point.weight * film.sends_back(back.lobe, point.beta, to);
                add_rows(&mut sum, &reflectance(table, film, point.beta), &[weight]);
            }
        }
        film.times_reflectance(&mut sum, table.common.len());
        sum
    }

    /// Weights of the nodes and harmonics of the pixel's table: the integral of the light of a view times that of a source, by its
    /// number, or of the light of the view alone.
    fn first_order(
        &self,
        film: &Film,
        table: &AngularTable,
        (points, of_view): (&[Point], &[f64]),
        source: Option<usize>,
    ) -> Vec<f64> {
        let mut sums = table.no_weights();
        let azimuths = self.grid.azimuths;
        let mut along = vec![0.0; azimuths];
        with_widest_simd(
            #[inline(always)]
            || {
                for (number, ring) in self.grid.rings.iter().enumerate() {
                    let here = number * azimuths..(number + 1) * azimuths;
                    along.copy_from_slice(&of_view[here.clone()]);
                    if let Some(source) = source {
                        along.iter_mut().zip(&self.lit[source][here]).for_each(|(light, lit)| *light *= lit);
                    }
                    table.add_ring(&mut sums, (ring.x * ring.x, film.index), (&along, &self.waves));
                }
            },
        );
        let source = source.map(|source| &self.sources[source]);
        if film.regular() == 0.0 {
            return sums;
        }
        let mut add = |beta: Beta, weight: f64| table.add_direction(&mut sums, (beta, film.index), weight);
        for point in points {
            let arrives = source.map_or(1.0, |light| film.arrives(light, point.beta));
            add(point.beta, film.regular() * point.weight * arrives);
        }
        if let Some(Light::Points(lit)) = source {
            let own = Light::Points(points.to_vec());
            for point in lit {
                add(point.beta, film.regular() * point.weight * film.arrives(&own, point.beta));
            }
        }
        sums
    }

    /// Light of further orders over this base; `None` if `stop` was set.
    fn returned(&self, film: &Film, base: &Base, stop: &AtomicBool) -> Option<Arc<Returned>> {
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = last.as_ref().filter(|known| is_same(&known.base, base)) {
            return Some(Arc::clone(known));
        }
        let mut found = Returned { base: base.clone(), rho: Vec::new(), rises: Vec::new() };
        if let (Some(back), Reflector::Specular(table)) = (&self.back, &base.reflector) {
            found.rho = back.grid.points().flat_map(|node| reflectance(table, film, node.beta)).collect();
            for light in &self.sources {
                let arrives = self.sent_back(film, table, light, (&found.rho, stop))?;
                found.rises.push(arrives.iter().zip(&found.rho).map(|(x, r)| x * r).collect());
            }
        }
        let found = Arc::new(found);
        *last = Some(Arc::clone(&found));
        Some(found)
    }

    /// Light that is sent back down once and more often, `[node][column]`; `None` if `stop` was set.
    fn sent_back(
        &self,
        film: &Film,
        table: &AngularTable,
        light: &Light,
        (rho, stop): (&[f64], &AtomicBool),
    ) -> Option<Vec<f64>> {
        /// More than enough for the largest reflectance of a diffuser.
        const MOST_ORDERS: usize = 400;
        let Some(back) = &self.back else { return Some(Vec::new()) };
        let (columns, bins) = (table.state_count() * table.common.len(), table.common.len());
        let first = back.grid.light(film, light);
        let first: Vec<f64> = rho
            .chunks_exact(columns)
            .zip(&first)
            .flat_map(|(rho, x)| rho.iter().map(move |r| r * x))
            .collect();
        let sent = |rises: &[f64]| {
            let mut sent = back.apply(rises, columns);
            film.times_reflectance(&mut sent, bins);
            sent
        };
        let mut once = sent(&first);
        if let Light::Points(points) = light {
            for point in points.iter().filter(|_| film.regular() > 0.0) {
                let mut rises = reflectance(table, film, point.beta);
                film.times_reflectance(&mut rises, bins);
                for (out, node) in once.chunks_exact_mut(columns).zip(back.grid.points()) {
                    let weight =
                        film.regular() * point.weight * film.sends_back(back.lobe, point.beta, node.beta);
                    out.iter_mut().zip(&rises).for_each(|(out, rises)| *out += weight * rises);
                }
            }
        }
        let (mut arrives, mut order) = (once.clone(), once);
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let negligible = largest(&arrives) * (-self.digits).exp();
        for _ in 0..MOST_ORDERS {
            if stop.load(Ordering::Relaxed) {
                return None;
            }
            let rises: Vec<f64> = order.iter().zip(rho).map(|(x, r)| x * r).collect();
            order = sent(&rises);
            arrives.iter_mut().zip(&order).for_each(|(sum, more)| *sum += more);
            if largest(&order) <= negligible {
                break;
            }
        }
        Some(arrives)
    }

    /// What becomes of a beam from a view, given what of diffuse light the view sees.
    fn ledger(
        &self,
        film: &Film,
        (base, table): (&Base, &AngularTable),
        (points, of_view): (&[Point], &[f64]),
        (returned, in_diffuse): (&Returned, StateSpectra),
        stop: &AtomicBool,
    ) -> Ledger {
        let bins = base.bins();
        let reflected = table.sum_of(&self.first_order(film, table, (points, of_view), None));
        let arrives = film.arrives_in_all(points);
        // Light that arrives, and what of it is absorbed, by column.
        let mut all = vec![arrives; reflected.len()];
        let mut rises = reflected;
        let own = Light::Points(points.to_vec());
        let again = self.sent_back(film, table, &own, (&returned.rho, stop)).unwrap_or_default();
        if let Some(back) = &self.back {
            let weights: Vec<f64> = back.grid.points().map(|node| node.weight).collect();
            add_rows(&mut all, &again, &weights);
            let reflected: Vec<f64> = again.iter().zip(&returned.rho).map(|(x, r)| x * r).collect();
            add_rows(&mut rises, &reflected, &weights);
        }
        let through = |at: usize| film.diffuser.transmittance[at % bins];
        let spectra = |of: &dyn Fn(usize) -> f64| StateSpectra::new((0..all.len()).map(of).collect(), bins);
        let inactive = spectra(&|at| through(at) * base.inactive_absorptance[at % bins] * all[at]);
        let pixel = spectra(&|at| through(at) * (all[at] - rises[at]) - inactive[at]);
        let diffuser = spectra(&|at| 1.0 - in_diffuse[at] - pixel[at] - inactive[at]);
        Ledger { returned: in_diffuse, pixel, inactive, diffuser, ..Ledger::zeros(base.states(), bins) }
    }
}
