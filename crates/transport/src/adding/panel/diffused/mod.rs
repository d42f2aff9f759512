//! A panel with a diffuser: data that persist between estimates. `estimate` sums them.

mod by_order;
mod estimate;
mod lights;
mod sums;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::Views;
use super::first_pass::{Pass, SourceFreeView, Weights};
use super::lambertian::Shares;
use super::recycling::{Exact, Forms, Group, OwnForms, Plan, Recycling, Reflectances, Seen, Towards};
use crate::base::largest;
use crate::layers::Indices;
use crate::light::cone_points::Nodes as QuadratureNodes;
use crate::light::cone_points::{Point, cone_points_of};
use crate::light::images::{ImagePoints, Mirror, image_points};
use crate::{AngularTable, Cone, Diffuser, Medium, Nodes, Panel, Reflector, Source, Top};
use by_order::{ByOrder, OfView};
use lights::{Bundle, Light};

pub use sums::ViewSums;

/// All data of a panel that do not depend on its spectra.
#[derive(Debug, Clone)]
pub(super) struct Kernel {
    digits: f64,
    diffuser: Diffuser,
    medium: Medium,
    /// Nodes of the base's table; `None` over a Lambertian base.
    table: Option<Nodes>,
    indices: Indices,
    /// See [`reach`].
    reach: Option<f64>,
    /// Whether there are beams or discs, and fields.
    has_points: bool,
    has_fields: bool,
    sources: Vec<Arc<Light>>,
    /// Views for which the directions of fields are chosen.
    directions: Vec<Cone>,
    views: Vec<View>,
    /// For each index.
    shares: Vec<Shares>,
    recycling: Option<Arc<[Recycling]>>,
    seen: Option<BaseData>,
}

/// Data computed from the base's table.
#[derive(Debug, Clone)]
struct BaseData {
    table: AngularTable,
    /// Largest value of the table's basis.
    largest: f64,
    /// For each index the reflectances that recycling needs.
    at: Vec<Arc<Reflectances>>,
}

#[derive(Debug, Clone)]
struct View {
    cone: Cone,
    groups: Vec<Bundle>,
    images: Vec<ImagePoints>,
    /// For each index.
    at: Vec<AtIndex>,
}

/// One view at one index; empty over a Lambertian base. For each of its groups:
#[derive(Debug, Clone, Default)]
struct AtIndex {
    alone: Vec<SourceFreeView>,
    /// By group, source and the source's group, and the number of nodes used.
    pairs: Vec<Vec<Vec<(Weights, usize)>>>,
    /// The same of fields, shared by views at the same inclination; of other sources none.
    fields: Vec<Vec<Vec<Arc<ByOrder>>>>,
    recycled: Vec<Recycled>,
}

#[derive(Debug, Clone)]
struct Recycled {
    group: Group,
    /// `None` under a narrow lobe, which has a basis of its own.
    alone: Option<OwnForms>,
    seen: Option<Seen>,
    /// By source and the source's group, on the grid and under a narrow lobe.
    between: Vec<Vec<(Forms, Option<Towards>)>>,
}

impl Kernel {
    pub(super) fn new(stack: &Panel, diffuser: &Diffuser, digits: f64) -> Self {
        Self {
            digits,
            diffuser: diffuser.clone(),
            medium: stack.medium.clone(),
            table: table_nodes(stack).cloned(),
            indices: Indices::new(&stack.medium, digits),
            reach: None,
            has_points: false,
            has_fields: false,
            sources: Vec::new(),
            directions: Vec::new(),
            views: Vec::new(),
            shares: Vec::new(),
            recycling: None,
            seen: None,
        }
    }

    /// Returns whether the layers are those for which it was made.
    pub(super) fn serves(&self, stack: &Panel, diffuser: &Diffuser) -> bool {
        self.diffuser.lobe == diffuser.lobe
            && self.diffuser.regular_fraction == diffuser.regular_fraction
            && self.medium == stack.medium
            && self.table.as_ref() == table_nodes(stack)
    }

    /// Prepares views and sources; incomplete if `stop` is set during the computation.
    pub(super) fn prepare(&mut self, stack: &Panel, views: Views<'_>, sources: &[Source], stop: &AtomicBool) {
        let common = views.diffused();
        let Views { own: views, together, .. } = views;
        let old_views = std::mem::take(&mut self.views);
        let old_sources = std::mem::take(&mut self.sources);
        if self.table.is_none() && self.shares.is_empty() {
            let at = |index: &f64| Shares::new(&self.diffuser, *index, self.digits);
            self.shares = match common {
                Some(common) => common.shares.clone(),
                None => self.indices.nodes.iter().map(at).collect(),
            };
        }
        let directions = if together.is_empty() { views } else { together };
        self.reach = reach(directions, sources);
        self.has_points = sources.iter().any(|source| matches!(source, Source::Beam(_) | Source::Disc(_)));
        self.has_fields = sources.iter().any(|source| matches!(source, Source::Field(_)));
        match common.and_then(|common| common.seen.as_ref()) {
            Some(seen) => self.seen = Some(seen.clone()),
            None => self.reset_for_new_base(stack),
        }
        let same_recycling = self.prepare_recycling(stack, common);
        let at = self.reflectances_at(stack);
        if let (Some(seen), Some(at)) = (&mut self.seen, at) {
            seen.at = at;
        }
        let same_views = self.directions == directions;
        if !same_views {
            self.directions = directions.to_vec();
        }
        let kept: Vec<Option<usize>> =
            sources.iter().map(|source| position(source, &old_sources, same_views)).collect();
        let light = |(source, kept): (&Source, &Option<usize>)| match kept {
            Some(kept) if same_recycling => old_sources[*kept].clone(),
            _ => {
                match common.and_then(|common| common.sources.iter().find(|light| light.source == *source)) {
                    Some(light) => light.clone(),
                    _ => self.light(source.clone()).into(),
                }
            }
        };
        self.sources = sources.iter().zip(&kept).map(light).collect();
        let old_view = |k: usize, cone: &Cone| {
            let same = old_views.get(k).filter(|old| old.cone == *cone);
            same.or_else(|| old_views.iter().find(|old| old.cone == *cone))
        };
        let mut made: Vec<View> = Vec::with_capacity(views.len());
        for (k, cone) in views.iter().enumerate() {
            if stop.load(Ordering::Relaxed) {
                break;
            }
            let turned = made.iter().rev().find(|view| view.cone.is_turned(cone));
            let across = stack.base.nodes_across(cone, &stack.medium);
            let at_inclination = views.iter().filter(|other| other.is_turned(cone)).count();
            let old = (old_view(k, cone), turned);
            let view = self.view((cone, across, at_inclination), sources, old, &kept, same_recycling);
            made.push(view);
        }
        self.views = made;
    }

    /// Builds the grid for recycled light, or takes the common one; returns whether it equals the previous
    /// one.
    fn prepare_recycling(&mut self, stack: &Panel, common: Option<&Self>) -> bool {
        let plan = self.plan(stack);
        let old = self.recycling.as_ref().and_then(|all| all.first()).map(|one| &one.plan);
        if plan.as_ref() == old {
            return true;
        }
        if let Some(common) = common {
            self.recycling.clone_from(&common.recycling);
            return false;
        }
        if let Some(seen) = &mut self.seen {
            seen.at.clear();
        }
        self.recycling = plan.map(|plan| {
            let nodes = self.indices.nodes.clone();
            let at = |j: usize| self.pass(j).map(|pass| Recycling::new(&pass, plan.clone()));
            (0..nodes.len()).filter_map(at).collect()
        });
        false
    }

    fn plan(&self, stack: &Panel) -> Option<Plan> {
        let pass = self.pass(0)?;
        let Top::Diffuser(diffuser) = &stack.top else { return None };
        let g = sent_back(stack, &diffuser.transmittance).into_iter().fold(0.0, f64::max);
        let strength = if g > 0.0 { g * self.largest_reflectance(stack) } else { 0.0 };
        Plan::new(&pass, strength, (self.reach, self.has_points, self.has_fields))
    }

    fn largest_reflectance(&self, stack: &Panel) -> f64 {
        match &stack.base.reflector {
            Reflector::Specular(table) => {
                let seen = self.seen.as_ref().filter(|seen| seen.table.is_same(table));
                let of_basis = seen.map_or_else(|| largest(&table.basis), |seen| seen.largest);
                table.largest_reflectance(of_basis)
            }
            Reflector::Lambertian(_) | Reflector::Scattering(_) => stack.base.largest_reflectance(),
        }
    }

    /// Resets the data of the base if the base has changed.
    fn reset_for_new_base(&mut self, stack: &Panel) {
        let Reflector::Specular(table) = &stack.base.reflector else {
            self.seen = None;
            return;
        };
        let before = self.seen.take();
        if before.as_ref().is_some_and(|seen| seen.table.is_same(table)) {
            self.seen = before;
            return;
        }
        let same_basis = before.filter(|seen| Arc::ptr_eq(&seen.table.basis, &table.basis));
        let largest = same_basis.map_or_else(|| largest(&table.basis), |seen| seen.largest);
        self.seen = Some(BaseData { table: table.clone(), largest, at: Vec::new() });
    }

    /// Computes the reflectances of the base that recycling needs, unless they are known.
    fn reflectances_at(&self, stack: &Panel) -> Option<Vec<Arc<Reflectances>>> {
        let seen = self.seen.as_ref().filter(|seen| seen.at.is_empty())?;
        let Top::Diffuser(diffuser) = &stack.top else { return None };
        let g = sent_back(stack, &diffuser.transmittance).repeat(stack.base.states());
        let at = |(index, recycling): (usize, &Recycling)| {
            Arc::new(recycling.reflectances(&stack.base, &seen.table, &self.medium_at(stack, index), &g))
        };
        Some(self.grids().enumerate().map(at).collect())
    }

    /// Returns the grid of each index; none without recycled light.
    fn grids(&self) -> impl Iterator<Item = &Recycling> {
        self.recycling.iter().flat_map(|all| all.iter())
    }

    /// Returns the medium above the base, as if it had this index at all wavelengths.
    fn medium_at(&self, stack: &Panel, index: usize) -> Medium {
        match stack.medium.constant_index() {
            Some(_) => stack.medium.clone(),
            None => Medium::new(vec![self.indices.nodes[index]; stack.base.bins()].into()),
        }
    }

    fn pass(&self, index: usize) -> Option<Pass<'_>> {
        let index = *self.indices.nodes.get(index)?;
        let table = self.table.as_ref()?;
        Some(Pass { diffuser: &self.diffuser, table, index, digits: self.digits })
    }

    /// Computes the view of a cone, across which lie this many nodes of the base's table; so many views, itself
    /// included, are at its inclination.
    fn view(
        &self,
        (cone, across, at_inclination): (&Cone, f64, usize),
        sources: &[Source],
        (old, turned): (Option<&View>, Option<&View>),
        kept: &[Option<usize>],
        same_recycling: bool,
    ) -> View {
        // Only unscattered light resolves the table.
        let across = if self.diffuser.regular_fraction > 0.0 { across } else { 0.0 };
        // Without it there is only the image in the front, which reflects the same at all angles.
        let mirror =
            if self.diffuser.regular_fraction > 0.0 { Mirror::Across(across) } else { Mirror::Uniform };
        let groups = match old {
            Some(old) => old.groups.clone(),
            None => {
                let axis = Point { beta: cone.axis_towards(), weight: 1.0 };
                let nodes = QuadratureNodes { rings: 0, across };
                self.bundles(cone_points_of(cone, self.scale(), self.digits, nodes), axis)
            }
        };
        let images = image_points(cone, sources, self.digits, mirror);
        let at = (0..self.indices.nodes.len())
            .map(|j| {
                let old = old.and_then(|old| old.at.get(j));
                let turned = turned.and_then(|turned| turned.at.get(j));
                self.view_at((j, at_inclination), &groups, (old, turned), kept, same_recycling)
            })
            .collect();
        View { cone: *cone, groups, images, at }
    }

    /// Computes a view at an index; so many views, itself included, are at its inclination.
    fn view_at(
        &self,
        (index, at_inclination): (usize, usize),
        groups: &[Bundle],
        (old, turned): (Option<&AtIndex>, Option<&AtIndex>),
        kept: &[Option<usize>],
        same_recycling: bool,
    ) -> AtIndex {
        let Some(pass) = self.pass(index) else { return AtIndex::default() };
        let alone = match old {
            Some(old) => old.alone.clone(),
            None => match turned {
                Some(turned) => turned.alone.clone(),
                None => groups.iter().map(|group| pass.alone(&group.points)).collect(),
            },
        };
        let recycling = self.recycling.as_ref().and_then(|all| all.get(index));
        let recycled: Vec<Option<(Group, Option<OwnForms>)>> = groups
            .iter()
            .enumerate()
            .map(|(g, bundle)| {
                let recycling = recycling?;
                let old = old.filter(|_| same_recycling).and_then(|old| old.recycled.get(g));
                let turned = turned.and_then(|turned| turned.recycled.get(g));
                Some(match (old, turned) {
                    (Some(old), _) => (old.group.clone(), old.alone.clone()),
                    (None, Some(turned)) => (turned.group.turned_to(bundle.axis), turned.alone.clone()),
                    (None, None) => {
                        let group = recycling.group(&bundle.points, bundle.axis, pass.index, true);
                        let alone = (!recycling.is_narrow()).then(|| recycling.alone(&group));
                        (group, alone)
                    }
                })
            })
            .collect();
        let fields: Vec<Vec<Vec<Arc<ByOrder>>>> = match (turned, old) {
            (Some(turned), _) => turned.fields.clone(),
            (None, Some(old)) if same_recycling && kept.iter().all(Option::is_some) => {
                let of = |of_group: &Vec<Vec<Arc<ByOrder>>>| {
                    kept.iter().flatten().map(|kept| of_group[*kept].clone()).collect()
                };
                old.fields.iter().map(of).collect()
            }
            _ => {
                let own = recycled.iter().map(|own| recycling.zip(own.as_ref().map(|(group, _)| group)));
                let of_groups: Vec<OfView<'_>> =
                    groups.iter().zip(own).map(|(bundle, recycled)| OfView { bundle, recycled }).collect();
                let mut fields = vec![Vec::new(); groups.len()];
                for light in &self.sources {
                    let project = |bundle: &Bundle| self.projected(&pass, bundle);
                    let of_light = by_order::of((&pass, index), &of_groups, light, project, at_inclination);
                    fields.iter_mut().zip(of_light).for_each(|(all, one)| all.push(one));
                }
                fields
            }
        };
        let pairs = groups.iter().enumerate().map(|(g, group)| {
            let towards = |(i, kept): (usize, &Option<usize>)| match (old, kept) {
                (Some(old), Some(kept)) => old.pairs[g][*kept].clone(),
                _ if !fields[g][i].is_empty() => {
                    fields[g][i].iter().map(|field| field.weights_at(group.azimuth(), &pass)).collect()
                }
                _ => self.sources[i].groups.iter().map(|b| pass.between(&group.points, &b.points)).collect(),
            };
            kept.iter().enumerate().map(towards).collect()
        });
        let pairs = pairs.collect();
        let exact =
            self.exact_passes(recycling, groups, |i| same_recycling && old.is_some() && kept[i].is_some());
        let recycled = recycled.into_iter().zip(groups).enumerate().filter_map(|(g, (own, bundle))| {
            let (recycling, (group, alone)) = recycling.zip(own)?;
            let old = old.filter(|_| same_recycling).and_then(|old| old.recycled.get(g));
            let turned = turned.and_then(|turned| turned.recycled.get(g));
            let seen = match old.or(turned) {
                Some(known) => known.seen.clone(),
                None => recycling.seen(&bundle.points),
            };
            let towards = |(i, kept): (usize, &Option<usize>)| match (old, kept) {
                (Some(old), Some(kept)) => old.between[*kept].clone(),
                _ => {
                    let light = &self.sources[i];
                    let both = |(k, b): (usize, &Bundle)| {
                        let forms = match fields[g][i].get(k) {
                            Some(field) => field.forms_at(bundle.azimuth()),
                            None => recycling.between(&group, &light.recycled[index][k]),
                        };
                        let exact = exact[i].as_ref().map_or_else(Vec::new, |exact| exact[g][k].clone());
                        let towards = seen
                            .as_ref()
                            .and_then(|seen| recycling.towards((&bundle.points, seen), b.lit(exact)));
                        (forms, towards)
                    };
                    light.groups.iter().enumerate().map(both).collect()
                }
            };
            let between = kept.iter().enumerate().map(towards).collect();
            Some(Recycled { seen, group, alone, between })
        });
        let recycled = recycled.collect();
        AtIndex { alone, pairs, fields, recycled }
    }

    /// Returns the exact passes between the groups of a view and of each source of points under a narrow
    /// lobe, by source, group of the view and of the source; `None` for others, and for sources that are
    /// known.
    fn exact_passes(
        &self,
        recycling: Option<&Recycling>,
        views: &[Bundle],
        is_known: impl Fn(usize) -> bool,
    ) -> Vec<Option<Vec<Vec<Exact>>>> {
        let of = |(i, light): (usize, &Arc<Light>)| {
            let has_points = matches!(light.source, Source::Beam(_) | Source::Disc(_));
            let is_needed = has_points && !is_known(i);
            recycling
                .filter(|_| is_needed)?
                .between_points(&lights::points(views), &lights::points(&light.groups))
        };
        self.sources.iter().enumerate().map(of).collect()
    }

    pub(super) fn nodes(&self) -> usize {
        let pair = |pairs: &Vec<Vec<Vec<(Weights, usize)>>>| -> usize {
            pairs.iter().flatten().flatten().map(|pair| pair.1).sum()
        };
        let views: usize = self
            .views
            .iter()
            .flat_map(|view| &view.at)
            .map(|at| at.alone.iter().map(|alone| alone.nodes).sum::<usize>() + pair(&at.pairs))
            .sum();
        let shares: usize = self.shares.iter().map(|shares| shares.nodes).sum();
        views + shares + self.grids().map(Recycling::nodes).sum::<usize>()
    }
}

/// Returns the previous position of a source; the directions of a field also depend on the views.
fn position(source: &Source, old: &[Arc<Light>], same_views: bool) -> Option<usize> {
    let serves = same_views || !matches!(source, Source::Field(_));
    old.iter().position(|old| serves && old.source == *source)
}

/// Returns the largest `sqrt(|beta_v| |beta_l|)` of a view and a directed source, if there is one.
fn reach(views: &[Cone], sources: &[Source]) -> Option<f64> {
    let radius = |cone: &Cone| (cone.axis_towards().length() + cone.half_angle()).min(1.0);
    let directed = sources.iter().filter_map(|source| match source {
        Source::Diffuse => None,
        Source::Beam(beta) => Some(beta.length()),
        Source::Disc(cone) => Some(radius(cone)),
        // A ring has only order 0.
        Source::Field(field) if field.is_ring() => None,
        Source::Field(_) => Some(1.0),
    });
    let largest_view = views.iter().map(radius).fold(0.0, f64::max);
    directed.reduce(f64::max).map(|l| (l * largest_view).sqrt())
}

fn table_nodes(stack: &Panel) -> Option<&Nodes> {
    match &stack.base.reflector {
        Reflector::Specular(table) => Some(&table.nodes),
        Reflector::Lambertian(_) | Reflector::Scattering(_) => None,
    }
}

/// Returns `r T^2`: the fraction of light leaving the underside of the diffuser that returns to it, per
/// wavelength.
fn sent_back(stack: &Panel, transmittance: &[f64]) -> Vec<f64> {
    let one = |(t, r): (&f64, &f64)| if stack.single_pass { 0.0 } else { t * t * r };
    transmittance.iter().zip(stack.front.reflectance_below.iter()).map(one).collect()
}
