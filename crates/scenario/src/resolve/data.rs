//! Data files, spectra of fractions, and materials.

use std::path::Path;

use num_complex::Complex64;
use papilio_diagnostics::{Diagnostic, Warned, number};
use papilio_formats::{DataFile, FormatError, LARGEST_FILE, read_fractions_with_notes, read_index_within};
use papilio_spectra::{Dispersion, SpectraError, Spectrum, Tabulated, material, material_info};

use super::{Resolver, sampling};
use crate::describe::display::{IndexOf, MaterialSpec, ShareSpectrum};
use crate::here::looks_like_path;
use crate::library::{Library, MemoryFile, Missing};
use crate::mistake;
use crate::origin::Origin;
use crate::read::Spanned;

/// Most terms of a model of dispersion.
const MOST_TERMS: usize = 64;
/// Largest n and k of a film.
const LARGEST_INDEX: f64 = 1e3;
/// Smallest |n + ik|. Both limits are far beyond any material, and keep films computable.
const SMALLEST_INDEX: f64 = 1e-3;

impl Resolver<'_> {
    /// Reads a file of the scenario, and records its SHA-256.
    pub(super) fn open(&mut self, name: &str, origin: Origin) -> Option<MemoryFile> {
        self.open_within(name, origin, LARGEST_FILE)
    }

    /// As [`Resolver::open`], with a limit of its size in bytes.
    pub(super) fn open_within(&mut self, name: &str, origin: Origin, limit: u64) -> Option<MemoryFile> {
        match self.library.open(name, limit) {
            Ok(kept) => {
                self.inputs.insert(name.to_owned(), kept.sha256().to_owned());
                self.note_folder(name, origin);
                return Some(kept);
            }
            Err(Missing::Unread(error)) => {
                let tried = self.library.tried(name, self.is_set(origin));
                self.errors.push_unread(origin, error, tried);
            }
            Err(Missing::Unknown(wrong)) => self.errors.push(origin, wrong),
        }
        None
    }

    /// True if a place is in a `--set` whose paths are relative to the current folder.
    fn is_set(&self, origin: Origin) -> bool {
        self.sources.folder().is_some() && (1..=self.sources.overrides()).contains(&origin.source)
    }

    /// Adds a note if a path in a `--set` leads to a file in the folder of the scenario, and not in the
    /// current folder.
    fn note_folder(&mut self, name: &str, origin: Origin) {
        let Library::Folder(folder) = self.library else { return };
        let used = folder.join(name);
        // A path from the current folder was replaced by one that is not in the text, unless that is the folder of the scenario.
        let is_replaced = !self.sources.text(origin.source).contains(name);
        let is_here = || {
            Path::new(name)
                .canonicalize()
                .is_ok_and(|here| used.canonicalize().is_ok_and(|used| used == here))
        };
        if self.is_set(origin) && !is_replaced && used != Path::new(name) && !is_here() {
            let used = used.display();
            let note = format!(
                "there is no {name} in the current folder, so --set uses that in the folder of the scenario, {used}"
            );
            if !self.notes.contains(&note) {
                self.notes.push(note);
            }
        }
    }

    /// True if `text` is the path of a file rather than a name.
    pub(super) fn is_file(&self, text: &str) -> bool {
        looks_like_path(text) || self.library.has(text)
    }

    /// Reads the file `name` with `read`.
    pub(super) fn data<T>(
        &mut self,
        name: &str,
        origin: Origin,
        read: fn(&DataFile) -> Result<T, FormatError>,
    ) -> Option<T> {
        let kept = self.open(name, origin)?;
        match read(kept.file()) {
            Ok(data) => Some(data),
            Err(error) => {
                self.errors.push_data(origin, error);
                None
            }
        }
    }

    /// Reads the file `name` with `read`, whose notes on the file become notes of the scenario.
    pub(super) fn data_with_notes<T>(
        &mut self,
        name: &str,
        origin: Origin,
        read: fn(&DataFile) -> Result<Warned<T>, FormatError>,
    ) -> Option<T> {
        let Warned { value, warnings } = self.data(name, origin, read)?;
        for note in warnings.iter().map(|note| format!("{name}: {note}")) {
            // A file may be used in several places.
            if !self.notes.contains(&note) {
                self.notes.push(note);
            }
        }
        Some(value)
    }

    /// Resolves a fraction of the light on the grid, 0 to 1.
    pub(super) fn share(&mut self, share: &ShareSpectrum, origin: Origin) -> Option<Spectrum> {
        let name = match share {
            ShareSpectrum::Constant(share) => return Some(Spectrum::constant(&self.grid, share.0)),
            ShareSpectrum::File(name) => name,
        };
        let table = self.data_with_notes(name, origin, read_fractions_with_notes)?;
        self.fractions(name, origin, &table)
    }

    /// Returns the values of a table of fractions on the grid. Whether the grid is fine enough is examined when the light is known.
    pub(super) fn fractions(&mut self, name: &str, origin: Origin, table: &Tabulated) -> Option<Spectrum> {
        let values = self.sampled(name, origin, table.on(&self.grid))?;
        self.is_tabulated = true;
        if !sampling::has_all_points(&self.grid, table) {
            self.tables.push((name.to_owned(), table.clone()));
        }
        Some(values)
    }

    /// Returns the values of a table or model on the grid, or reports that it does not cover the grid.
    pub(super) fn sampled<T>(
        &mut self,
        name: &str,
        origin: Origin,
        on_grid: Result<T, SpectraError>,
    ) -> Option<T> {
        match on_grid {
            Ok(values) => return Some(values),
            Err(SpectraError::OutsideTable { first, last, .. }) => {
                let needed = (self.grid.start_nm(), self.grid.stop_nm());
                let wrong = mistake::not_covered(name, (first, last), needed, self.grid.step_nm());
                self.errors.push(origin.or_override([self.range]), wrong);
            }
            Err(error) => self.errors.push(origin, error),
        }
        None
    }

    /// Reads n + ik from a file, which must be valid in the range of the grid.
    fn index_file(&mut self, name: &str, origin: Origin) -> Option<Dispersion> {
        let kept = self.open(name, origin)?;
        self.is_tabulated = true;
        match read_index_within(kept.file(), (self.grid.start_nm(), self.grid.stop_nm())) {
            Ok(read) => {
                for note in read.warnings.iter().map(|note| format!("{name}: {note}")) {
                    // A material may be used in several places.
                    if !self.notes.contains(&note) {
                        self.notes.push(note);
                    }
                }
                Some(read.value)
            }
            Err(error) => {
                self.errors.push_data(origin, error);
                None
            }
        }
    }

    /// Notes that a named material has no data in a part of the grid's range.
    fn note_beyond_data(&mut self, name: &str) {
        let range = (self.grid.start_nm(), self.grid.stop_nm());
        let Some((info, beyond)) =
            material_info(name).ok().and_then(|info| info.beyond_data(range).map(|beyond| (info, beyond)))
        else {
            return;
        };
        let note = format!(
            "{name}: the data are from {} to {} nm; {beyond} the formula is continued, or the last value is used",
            info.measured_nm.0, info.measured_nm.1
        );
        if !self.notes.contains(&note) {
            self.notes.push(note);
        }
    }

    /// Resolves n + ik on the grid.
    pub(super) fn material(&mut self, spec: &Spanned<MaterialSpec>) -> Option<Vec<Complex64>> {
        let (name, dispersion) = match &spec.value {
            MaterialSpec::Number(n) => ("the index", Dispersion::constant(n.0, 0.0)),
            MaterialSpec::Complex(table) => match table.index_of() {
                Ok(IndexOf::Constant { n, k }) => ("the index", Dispersion::constant(n, k)),
                Ok(IndexOf::Material(name)) => (name, material(name)),
                Err(wrong) => {
                    self.err(spec, *wrong);
                    return None;
                }
            },
            MaterialSpec::Model(model) => {
                self.limit(spec, "terms", model.term_count(), MOST_TERMS)?;
                ("the index", Ok(Dispersion::model(model.model())))
            }
            MaterialSpec::Text(name) => (name.as_str(), material(name)),
        };
        let dispersion = match dispersion {
            Err(SpectraError::UnknownName { .. }) if self.is_file(name) => {
                self.index_file(name, spec.origin)?
            }
            Err(SpectraError::UnknownName { .. }) => {
                self.err(spec, mistake::unknown_material(name));
                return None;
            }
            other => self.sampled(name, spec.origin, other)?,
        };
        let on_grid = dispersion.on(&self.grid);
        let mut index = self.sampled(name, spec.origin, on_grid)?;
        if let MaterialSpec::Complex(table) = &spec.value {
            index.iter_mut().for_each(|index| *index = table.scaled(*index));
        }
        self.note_beyond_data(name);
        let is_film =
            |index: &Complex64| index.re.max(index.im) <= LARGEST_INDEX && index.norm() >= SMALLEST_INDEX;
        if let Some(i) = index.iter().position(|index| !is_film(index)) {
            let Complex64 { re: n, im: k } = index[i];
            let nm = self.grid.wavelength_nm(i);
            let wrong = Diagnostic::new(format!("the refractive index is {n} + {}i at {nm} nm", number(k)));
            self.err(spec, wrong.expected("n and k up to 1000, and |n + ik| of at least 0.001"));
            return None;
        }
        Some(index)
    }
}
