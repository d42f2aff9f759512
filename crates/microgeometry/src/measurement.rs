//! A complete measurement of a surface: statistics of its heights, and what waves and rays show.
//!
//! **Parts.** The work is divided into independent parts, which may be computed in any order on any thread:
//! first the realisations of phase screens, then the replicates of rays. A finished part can be saved as
//! numbers and read again; the result is the same to the last bit.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use crate::by_azimuth::{AzimuthSums, directions};
use crate::goniometer::Replicate;
use crate::kernel::Audit;
use crate::waves::{WaveScreen, Waves};
use crate::{
    AzimuthKernel, ByWaves, Goniometer, Kernel, MicrogeometryError, REPLICATES, Statistics, Surface, Total,
};

/// A surface, and how it is measured.
#[derive(Debug, Clone)]
pub struct Measurement {
    /// The surface.
    pub surface: Surface,
    /// The instrument.
    pub goniometer: Goniometer,
    /// Whether it is measured by rays.
    pub by_rays: bool,
    /// Wavelengths at which it is measured by waves, nm, along the normal and at the inclinations of the
    /// instrument; none: it is not.
    pub waves_nm: Vec<f64>,
}

/// What was measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Findings {
    /// What rays show.
    pub rays: Option<ByRays>,
    /// What waves show.
    pub waves: Option<ByWaves>,
    /// Statistics of the heights, if the surface has one height at each place.
    pub statistics: Option<Statistics>,
}

/// A surface measured by rays.
#[derive(Debug, Clone, PartialEq)]
pub struct ByRays {
    /// Where light of each side and inclination goes.
    pub totals: Vec<Total>,
    /// From all directions to all directions.
    pub kernel: Kernel,
    /// The same by azimuth, if it was asked for.
    pub by_azimuth: Option<ByAzimuth>,
}

/// A surface measured by azimuth.
#[derive(Debug, Clone, PartialEq)]
pub struct ByAzimuth {
    /// Where light of each side, inclination and azimuth goes.
    pub totals: Vec<Total>,
    /// From all directions to all directions.
    pub kernel: AzimuthKernel,
}

/// A finished part of a measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct Part(Kind);

#[derive(Debug, Clone, PartialEq)]
enum Kind {
    Screen(WaveScreen),
    Replicate(Replicate),
}

/// Parts of a measurement, in any order. They are combined in that of their numbers: the result is the same
/// to the last bit.
#[derive(Debug)]
pub struct Collected {
    /// Parts that came before those with smaller numbers.
    waiting: BTreeMap<usize, Part>,
    /// Number of the next part to be combined.
    next: usize,
    screens: Vec<WaveScreen>,
    replicates: Vec<Replicate>,
    by_azimuth: Option<AzimuthSums>,
}

impl Collected {
    /// Adds a part with its number; each comes once.
    pub fn add(&mut self, number: usize, part: Part) {
        self.waiting.insert(number, part);
        while let Some(part) = self.waiting.remove(&self.next) {
            self.next += 1;
            match part.0 {
                Kind::Screen(screen) => self.screens.push(screen),
                Kind::Replicate(mut replicate) => {
                    if let (Some(sums), Some(light)) = (&mut self.by_azimuth, replicate.by_azimuth.take()) {
                        sums.add(light);
                    }
                    self.replicates.push(replicate);
                }
            }
        }
    }

    /// Number of parts so far.
    pub fn parts(&self) -> usize {
        self.next + self.waiting.len()
    }
}

impl Part {
    /// The part as numbers, for [`Measurement::part_of`].
    pub fn numbers(&self) -> Vec<f64> {
        match &self.0 {
            Kind::Screen(screen) => screen.numbers(),
            Kind::Replicate(replicate) => replicate.numbers(),
        }
    }
}

impl Measurement {
    /// Number of parts.
    pub fn parts(&self) -> usize {
        self.screens() + if self.by_rays { REPLICATES as usize } else { 0 }
    }

    /// Computes a part, `number` from 0 to below [`parts`](Self::parts). `stop` is called often; true
    /// interrupts.
    ///
    /// # Errors
    /// Surfaces that cannot be made or measured; [`MicrogeometryError::Interrupted`].
    pub fn part(&self, number: usize, stop: &dyn Fn() -> bool) -> Result<Part, MicrogeometryError> {
        let kind = match number.checked_sub(self.screens()) {
            None => Kind::Screen(self.waves().screen(&self.surface, number as u64, stop)?),
            Some(number) => Kind::Replicate(self.goniometer.replicate(&self.surface, number as u64, stop)?),
        };
        Ok(Part(kind))
    }

    /// The part that was saved as these numbers; `None` if they are not of this measurement.
    pub fn part_of(&self, number: usize, numbers: &[f64]) -> Option<Part> {
        match number.checked_sub(self.screens()) {
            None => self.waves().screen_of(numbers).map(Kind::Screen),
            Some(_) => self.goniometer.replicate_of(numbers).map(Kind::Replicate),
        }
        .map(Part)
    }

    /// No parts yet.
    ///
    /// # Errors
    /// Azimuths that cannot be measured.
    pub fn collected(&self) -> Result<Collected, MicrogeometryError> {
        let sums = |patches| AzimuthSums::new(patches, self.goniometer.rays);
        Ok(Collected {
            waiting: BTreeMap::new(),
            next: 0,
            screens: Vec::new(),
            replicates: Vec::new(),
            by_azimuth: self.goniometer.patches()?.filter(|_| self.by_rays).map(sums),
        })
    }

    /// What all parts show.
    ///
    /// # Errors
    /// Surfaces without statistics; lost rays; a kernel that contradicts reciprocity or the conservation of
    /// energy.
    pub fn findings(&self, parts: Collected) -> Result<Findings, MicrogeometryError> {
        debug_assert!(parts.waiting.is_empty());
        let statistics = self.surface.statistics()?;
        let Collected { screens, replicates, by_azimuth, .. } = parts;
        let by_rays = || {
            let totals = self.goniometer.totals(&replicates)?;
            let kernel = self.goniometer.kernel(&replicates)?;
            let by_azimuth = by_azimuth.map(|sums| self.by_azimuth(sums, &replicates)).transpose()?;
            Ok(ByRays { totals, kernel, by_azimuth })
        };
        Ok(Findings {
            rays: self.by_rays.then(by_rays).transpose()?,
            waves: (!screens.is_empty()).then(|| self.waves().combined(&self.surface, &screens)),
            statistics,
        })
    }

    /// Computes all parts on a number of threads (all processors if `None`) and combines them. `finished` is
    /// called after each part.
    ///
    /// # Errors
    /// Those of [`part`](Self::part) and [`findings`](Self::findings).
    pub fn measured(
        &self,
        threads: Option<usize>,
        stop: &(dyn Fn() -> bool + Sync),
        finished: &(dyn Fn() + Sync),
    ) -> Result<Findings, MicrogeometryError> {
        self.measured_with(self.screens(), threads, stop, finished)
    }

    /// As [`measured`](Self::measured), with at most `screens` realisations of a phase screen, whose errors
    /// are then larger.
    ///
    /// # Errors
    /// As [`measured`](Self::measured).
    pub fn measured_with(
        &self,
        screens: usize,
        threads: Option<usize>,
        stop: &(dyn Fn() -> bool + Sync),
        finished: &(dyn Fn() + Sync),
    ) -> Result<Findings, MicrogeometryError> {
        let left_out = self.screens().saturating_sub(screens);
        let collected = Mutex::new(self.collected()?);
        let part = |at: usize| {
            let number = if at < screens { at } else { at + left_out };
            let part = self.part(number, stop)?;
            collected.lock().unwrap_or_else(PoisonError::into_inner).add(at, part);
            finished();
            Ok(())
        };
        on_threads(self.parts() - left_out, threads, &part)?;
        self.findings(collected.into_inner().unwrap_or_else(PoisonError::into_inner))
    }

    /// The kernel by azimuth and its totals.
    fn by_azimuth(
        &self,
        sums: AzimuthSums,
        replicates: &[Replicate],
    ) -> Result<ByAzimuth, MicrogeometryError> {
        let rows: Vec<_> = sums.rows.iter().map(Vec::as_slice).collect();
        let directions = directions(&self.goniometer.incidence_deg, &sums.patches).enumerate();
        let totals = directions
            .map(|(row, (side, theta, phi))| Total::of(&rows, row, (side, theta, Some(phi))))
            .collect();
        Ok(ByAzimuth { totals, kernel: AzimuthKernel::new(sums, Audit::of_rays(replicates))? })
    }

    fn waves(&self) -> Waves {
        let index = [self.goniometer.index_above, self.goniometer.index_below];
        Waves {
            index,
            incidence_deg: self.goniometer.incidence_deg.clone(),
            wavelengths_nm: self.waves_nm.clone(),
        }
    }

    /// Number of phase screens.
    fn screens(&self) -> usize {
        if self.waves_nm.is_empty() { 0 } else { Waves::screens(&self.surface) as usize }
    }
}

/// The results of `part` for the numbers 0 to below `count`, computed on a number of threads (all processors
/// if `None`).
pub(crate) fn on_threads<T: Send>(
    count: usize,
    threads: Option<usize>,
    part: &(impl Fn(usize) -> Result<T, MicrogeometryError> + Sync),
) -> Result<Vec<T>, MicrogeometryError> {
    let available = || std::thread::available_parallelism().map_or(1, usize::from);
    let threads = threads.unwrap_or_else(available).clamp(1, count.max(1));
    let next = AtomicUsize::new(0);
    let work = || {
        let numbers = std::iter::from_fn(|| Some(next.fetch_add(1, Ordering::Relaxed)));
        let mine = numbers.take_while(|number| *number < count);
        mine.map(|number| Ok((number, part(number)?))).collect()
    };
    let found: Result<Vec<Vec<_>>, _> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        let lost = MicrogeometryError::Interrupted;
        workers.into_iter().map(|worker| worker.join().unwrap_or(Err(lost.clone()))).collect()
    });
    let mut all: Vec<(usize, T)> = found?.into_iter().flatten().collect();
    all.sort_by_key(|(number, _)| *number);
    Ok(all.into_iter().map(|(_, part)| part).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Coating, RandomHeights, Spectrum};

    fn measurement(azimuths: Option<usize>) -> Measurement {
        let spectrum = Spectrum::Gaussian { rms_um: 0.2, correlation_um: 4.0 };
        Measurement {
            surface: Surface::Random(RandomHeights::new(spectrum, 3).unwrap()),
            goniometer: Goniometer {
                index_above: 1.0,
                index_below: 1.5,
                coating: Coating::None,
                incidence_deg: vec![0.0, 60.0],
                azimuths,
                rays: 4,
                seed: 5,
            },
            by_rays: true,
            waves_nm: vec![450.0, 650.0],
        }
    }

    /// Parts that were saved, in any order, give the result of one computation to the last bit.
    #[test]
    fn saved_parts_give_the_same_result() {
        for azimuths in papilio_testing::everyday(1, [Some(4), None]) {
            saved_in_parts(&measurement(azimuths));
        }
    }

    fn saved_in_parts(of: &Measurement) {
        let at_once = of.measured(Some(2), &|| false, &|| {}).unwrap();
        let part = |number: usize| of.part(number, &|| false).unwrap();
        let mut saved: Vec<(usize, Vec<f64>)> =
            (0..of.parts()).rev().map(|number| (number, part(number).numbers())).collect();
        saved.swap(3, 9);
        let mut parts = of.collected().unwrap();
        saved.iter().for_each(|(number, numbers)| parts.add(*number, of.part_of(*number, numbers).unwrap()));
        assert_eq!(parts.parts(), of.parts());
        assert_eq!(of.findings(parts).unwrap(), at_once);
        assert!(at_once.waves.is_some() && at_once.statistics.is_some());
        assert_eq!(at_once.rays.unwrap().by_azimuth.is_some(), of.goniometer.azimuths.is_some());
    }

    /// Numbers of another measurement are not taken.
    #[test]
    fn numbers_of_another_kind_are_refused() {
        let of = measurement(Some(4));
        let (screen, replicate) = (0, of.parts() - 1);
        let numbers = of.part(replicate, &|| false).unwrap().numbers();
        assert_eq!(of.part_of(screen, &numbers), None);
        assert_eq!(of.part_of(replicate, &numbers[1..]), None);
        for azimuths in [None, Some(6)] {
            assert_eq!(measurement(azimuths).part_of(replicate, &numbers), None);
        }
        let other = Measurement { waves_nm: vec![550.0], ..of.clone() };
        assert_eq!(other.part_of(screen, &of.part(screen, &|| false).unwrap().numbers()), None);
    }

    #[test]
    fn interruption_ends_all_threads() {
        let stopped = measurement(None).measured(None, &|| true, &|| {});
        assert_eq!(stopped, Err(MicrogeometryError::Interrupted));
    }
}
