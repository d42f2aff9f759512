//! Light below flat layers above a pixel that changes polarisation, such as liquid crystals.
//!
//! A path follows back what a meter sees of light: a row of four numbers for each image and wavelength. Before a flat part and before the pixel, it is the row
//! times their matrices. All light keeps its direction, so that a path only branches, as in [`branches`](super::branches).

use papilio_optics::Beta;

use super::branches;
use super::dice::Dice;
use super::path::Path;
use super::tally::Record;
use super::tracer::{Shows, Tracer, Workspace};
use crate::layers::{Crossed, Incidence};
use crate::mueller::{Factors, Mueller};
use crate::skeleton::Propagation;
use crate::walk::add_scaled;
use crate::{Interface, Stack};

/// The pixel and the layers above it.
pub(super) struct Changing<'a> {
    pixel: &'a Mueller,
    /// For light of s and of p.
    interfaces: [Vec<Interface>; 2],
}

/// Matrices of the pixel in the last direction of a path, and what a pattern shows of them.
#[derive(Debug, Clone, Default)]
pub(super) struct ChangingWork {
    beta: Option<Beta>,
    /// `[state][element][wavelength]`.
    matrices: Vec<f64>,
    /// `[image][element][wavelength]`.
    mixed: Vec<f64>,
}

impl<'a> Changing<'a> {
    /// `None` of other stacks.
    pub(super) fn of(stack: &'a Stack) -> Option<Self> {
        let (pixel, interfaces) = stack.changing()?;
        Some(Self { pixel, interfaces })
    }
}

impl Tracer<'_> {
    /// Follows a path to both sides of an interface.
    pub(super) fn divide_changing(
        &self,
        (changing, number): (&Changing<'_>, usize),
        dice: &mut Dice<'_>,
        work: &mut Workspace,
    ) {
        let Workspace { path, branches, .. } = work;
        let alternatives = self.factors(changing, number, path);
        let [p, s] = path.light.totals_of_each();
        let all: f64 = p.iter().chain(&s).sum();
        for (passes, factors) in alternatives.iter().enumerate() {
            let light = factors.iter().zip(p.iter().zip(&s)).map(|(by, (p, s))| by.p * p + by.s * s);
            let share = if all > 0.0 { light.sum::<f64>() / all } else { 0.0 };
            let Some(scale) = branches::weight(path.light.brightness() * share, dice) else { continue };
            let (branch, _) = branches.add(path, dice.branch());
            branch.light.pass_back(factors, scale);
            if passes == 1 { branch.advance() } else { branch.turn() }
        }
    }

    /// What an interface reflects (0) and transmits (1), by wavelength.
    fn factors(&self, changing: &Changing<'_>, number: usize, path: &Path) -> [Vec<Factors>; 2] {
        let upper = number.checked_sub(1).map_or(&self.air, |above| &self.stack.layers[above].medium);
        let media = [upper, &self.stack.layers[number].medium];
        let both = changing.interfaces.each_ref().map(|own| &own[number]);
        let is_down = path.going == Propagation::Down;
        let of = |bin: usize| {
            let at = Incidence::between(media, bin, path.beta.squared());
            let flats = both.map(|own| own.kind().regular(&at));
            let crossed = Crossed::of(both[0], flats, &at);
            let [s, p] = flats;
            let reflects = match is_down {
                true => Factors { p: p.above, s: s.above, crossed: crossed.above },
                false => Factors { p: p.below, s: s.below, crossed: crossed.below },
            };
            (reflects, Factors { p: p.t, s: s.t, crossed: crossed.t })
        };
        let (reflects, transmits) = (0..self.bins()).map(of).unzip();
        [reflects, transmits]
    }

    /// Reflection by the pixel at the place of the path.
    pub(super) fn reflect_changing(
        &self,
        changing: &Changing<'_>,
        path: &mut Path,
        work: &mut ChangingWork,
        record: &impl Record,
    ) {
        let ChangingWork { beta, matrices, mixed } = work;
        if *beta != Some(path.beta) {
            *matrices = changing.pixel.at(path.beta, self.lowest());
            *beta = Some(path.beta);
        }
        match self.shows {
            Shows::EachState => path.light.reflect_back(matrices),
            Shows::Pattern(pattern) => {
                let bins = self.bins();
                let of_one = Mueller::ELEMENTS * bins;
                mixed.clear();
                mixed.resize(self.images() * of_one, 0.0);
                for place in 0..path.place_mm.len() {
                    let here = path.bins_at(place);
                    pattern.shows_at(&path.meeting(place), &mut |image, state, coverage| {
                        let rows = mixed[image * of_one..][..of_one].chunks_exact_mut(bins);
                        for (row, own) in rows.zip(matrices[state * of_one..].chunks_exact(bins)) {
                            add_scaled(&mut row[here.clone()], &own[here.clone()], coverage);
                        }
                    });
                }
                path.light.reflect_back(mixed);
            }
        }
        record.meets(path);
    }
}
