//! Interfaces and clear media.

use super::Stokes;
use super::row::{self, Row};
use super::sums::{Path, Run, intensities, unpolarised};
use crate::layers::{Arrival, Channel, Departure, Incidence, ScatteringInterface};
use crate::mueller::Factors;
use crate::skeleton::Propagation::Down;
use crate::{Interface, Medium};

impl Stokes<'_> {
    /// An interface or a medium.
    pub(super) fn meet_element(&self, element: usize, path: &mut Path, run: &mut Run<'_>) {
        let layer = &self.stack.layers[element / 2];
        if element.is_multiple_of(2) {
            return self.meet_interface(element, &layer.interface, path, run);
        }
        match layer.medium.scattering() {
            Some(slab) if path.towards.is_none() => self.cross_slab(element, slab, path, run),
            _ => {
                let Some((kind, _)) = self.stack.elements().nth(element) else { return };
                let squared = path.beta.squared();
                let at = |row| Incidence::between([&layer.medium; 2], self.bin(row), squared);
                let lost = path.weaken(|row| kind.regular(&at(row)).t);
                run.absorb(kind.account(), path, &lost);
                path.depart(element, Departure { beta: path.beta, going: path.going });
            }
        }
    }

    /// An interface: light passes, is reflected, or takes a channel of scattered light, in proportion to the unpolarised
    /// light of all columns that does.
    fn meet_interface(&self, element: usize, interface: &Interface, path: &mut Path, run: &mut Run<'_>) {
        let kind = interface.kind();
        let (media, from) = (self.media(element), path.going);
        let at: Vec<Incidence> =
            self.bins.iter().map(|bin| Incidence::between(media, *bin, path.beta.squared())).collect();
        let flats: Vec<[Factors; 2]> =
            at.iter().map(|at| passed_and_reflected(interface, at, from == Down)).collect();
        let behind = |way: usize| -> Vec<Row> {
            let one = |(k, of): (usize, &Row)| row::behind(flats[k % flats.len()][way], *of);
            path.rows.iter().enumerate().map(one).collect()
        };
        let [passed, reflected] = [behind(0), behind(1)];
        let disc = media[from as usize].largest_index();
        let scatterer = kind.scattering_interface().filter(|_| path.towards.is_none());
        let share = |scatterer: &dyn ScatteringInterface, channel| -> Vec<f64> {
            let fraction = scatterer.fraction(channel, from, path.beta.length(), disc);
            let of = |(k, row): (usize, &Row)| {
                let at = &at[k % at.len()];
                row[0] * fraction.map_or(kind.scattered(at)[from as usize], |(all, by)| all * by[at.bin])
            };
            path.rows.iter().enumerate().map(of).collect()
        };
        let channels: Vec<(&dyn ScatteringInterface, Channel, Vec<f64>)> = scatterer
            .into_iter()
            .flat_map(|scatterer| {
                scatterer.channels(from).into_iter().map(move |channel| (scatterer, channel))
            })
            .map(|(scatterer, channel)| (scatterer, channel, share(scatterer, channel)))
            .collect();
        let flat = [intensities(&passed), intensities(&reflected)];
        let parts: Vec<&Vec<f64>> = flat.iter().chain(channels.iter().map(|(_, _, part)| part)).collect();
        let sum = |row: usize| parts.iter().map(|part| part[row]).sum::<f64>();
        let lost: Vec<f64> = path.rows.iter().enumerate().map(|(k, row)| row[0] - sum(k)).collect();
        run.absorb(kind.account(), path, &lost);
        let weights: Vec<f64> = parts.iter().map(|part| part.iter().sum()).collect();
        let whole: f64 = weights.iter().sum();
        let mut u = run.random()[0] * whole;
        let chosen = weights.iter().position(|weight| {
            u -= weight;
            u < 0.0
        });
        let Some(chosen) = chosen else { return path.end() };
        let scale = whole / weights[chosen];
        // Of columns that differ, the choice takes more or less.
        let less: Vec<f64> =
            parts[chosen].iter().enumerate().map(|(k, part)| sum(k) - scale * part).collect();
        run.unaccounted(path, &less);
        match chosen {
            0 | 1 => {
                let going = if chosen == 0 { from } else { from.reversed() };
                path.rows = if chosen == 0 { passed } else { reflected };
                path.weaken(|_| scale);
                path.depart(element, Departure { beta: path.beta, going });
            }
            _ => {
                let (scatterer, channel, share) = &channels[chosen - 2];
                let share = share.iter().map(|share| scale * share).collect();
                let arrival = Arrival { beta: path.beta, going: from, channel: *channel, disc };
                self.scatter_at(element, (*scatterer, arrival, share), path, run);
            }
        }
    }

    /// Light that takes a channel of scattered light at an interface, by row.
    fn scatter_at(
        &self,
        element: usize,
        (scatterer, arrival, share): (&dyn ScatteringInterface, Arrival, Vec<f64>),
        path: &mut Path,
        run: &mut Run<'_>,
    ) {
        let Arrival { channel, going, .. } = arrival;
        let media = self.media(element);
        // The kernel is that of the largest indices.
        let times = |to: Departure, factor: f64| -> Vec<Row> {
            let medium = media[usize::from(to.going == Down)];
            let colours = scatterer.colours(arrival, to.beta);
            let of = |(k, share): (usize, &f64)| {
                let n = medium.index()[self.bin(k)];
                let carried = if to.beta.squared() < n * n { factor * share } else { 0.0 };
                let spread = scatterer.spread(channel, going, [medium.largest_index(), n]);
                carried * colours.at(self.bin(k)) * spread
            };
            unpolarised(share.iter().enumerate().map(of))
        };
        let sampled = scatterer.sample(arrival, run.random());
        let sampled = sampled.map(|(to, s)| (to, times(to, s.value / s.density), s.density));
        let density = |to| {
            let scattered = scatterer.scatter(arrival, to);
            (times(to, scattered.value), scattered.density)
        };
        let mut lost = share.clone();
        if let Some((_, rows, _)) = &sampled {
            lost.iter_mut().zip(rows).for_each(|(lost, row)| *lost -= row[0]);
        }
        run.absorb(self.stack.layers[element / 2].interface.kind().account(), path, &lost);
        self.scatter((element, channel.leaves(going)), path, run, density, sampled);
    }

    /// The media above and below an interface.
    fn media(&self, element: usize) -> [&Medium; 2] {
        let above = element.checked_sub(1).map_or(&self.air, |medium| &self.stack.layers[medium / 2].medium);
        [above, &self.stack.layers[element / 2].medium]
    }
}

/// Returns the factors of light that an interface passes, and of light that it reflects from above or below.
fn passed_and_reflected(interface: &Interface, at: &Incidence, from_above: bool) -> [Factors; 2] {
    let ([s, p], crossed) = interface.of_each(at);
    let reflected = match from_above {
        true => Factors { p: p.above, s: s.above, crossed: crossed.above },
        false => Factors { p: p.below, s: s.below, crossed: crossed.below },
    };
    [Factors { p: p.t, s: s.t, crossed: crossed.t }, reflected]
}
