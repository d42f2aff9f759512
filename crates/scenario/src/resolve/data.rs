//! Files, share spectra and materials.

use num_complex::Complex64;
use papilio_formats::{DataFile, read_index, read_spectrum};
use papilio_spectra::{Dispersion, SpectraError, Spectrum, Tabulated, material, material_names};
use sha2::{Digest, Sha256};

use super::Resolver;
use crate::describe::display::{MaterialSpec, ShareSpectrum};
use crate::problem::Problem;
use crate::read::At;
use crate::source::Origin;

impl Resolver<'_> {
    /// Reads a file of the scenario's and notes its SHA-256.
    pub(super) fn open(&mut self, name: &str, origin: Origin) -> Option<DataFile> {
        match DataFile::open(&self.folder.join(name), name) {
            Ok(file) => {
                self.inputs.insert(name.to_owned(), hex(&Sha256::digest(&file.bytes)));
                Some(file)
            }
            Err(error) => {
                self.errors.push_data(origin, error);
                None
            }
        }
    }

    /// True if `text` is meant as a file rather than as a name.
    pub(super) fn is_file(&self, text: &str) -> bool {
        let looks_so =
            text.contains(['/', '\\']) || text.rsplit_once('.').is_some_and(|(_, end)| !end.is_empty());
        looks_so || self.folder.join(text).is_file()
    }

    /// The two-column file `name`, as a table.
    pub(super) fn table(&mut self, name: &str, origin: Origin) -> Option<Tabulated> {
        let file = self.open(name, origin)?;
        match read_spectrum(&file) {
            Ok(table) => Some(table),
            Err(error) => {
                self.errors.push_data(origin, error);
                None
            }
        }
    }

    /// A share of the light on the grid, 0 to 1.
    pub(super) fn share(&mut self, share: &At<ShareSpectrum>) -> Option<Spectrum> {
        let name = match &share.value {
            ShareSpectrum::Constant(share) => return Some(Spectrum::constant(&self.grid, share.0)),
            ShareSpectrum::File(name) => name,
        };
        let table = self.table(name, share.origin)?;
        self.check_values(name, share.origin, &table, |v| (0.0..=1.0).contains(&v), "a share from 0 to 1")?;
        let on_grid = table.on(&self.grid);
        self.sampled(name, share.origin, on_grid)
    }

    /// Fails on the first value of a table that `accepts` does not take.
    pub(super) fn check_values(
        &mut self,
        name: &str,
        origin: Origin,
        table: &Tabulated,
        accepts: fn(f64) -> bool,
        expected: &'static str,
    ) -> Option<()> {
        let mut points = table.wavelengths_nm().iter().zip(table.values());
        let Some((&nm, &value)) = points.find(|(_, value)| !accepts(**value)) else { return Some(()) };
        self.errors.push(origin, Problem::SpectrumValue { what: name.to_owned(), value, nm, expected });
        None
    }

    /// What a table or model gives on the grid; says what is missing where it does not cover it.
    pub(super) fn sampled<T>(
        &mut self,
        name: &str,
        origin: Origin,
        on_grid: Result<T, SpectraError>,
    ) -> Option<T> {
        let problem = match on_grid {
            Ok(values) => return Some(values),
            Err(SpectraError::OutsideTable { first, last, .. }) => Problem::NotCovered {
                what: name.to_owned(),
                first,
                last,
                needed_nm: (self.grid.start_nm(), self.grid.stop_nm()),
            },
            Err(error) => error.into(),
        };
        self.errors.push(origin, problem);
        None
    }

    /// n + ik on the grid.
    pub(super) fn material(&mut self, spec: &At<MaterialSpec>) -> Option<Vec<Complex64>> {
        let (name, dispersion) = match &spec.value {
            MaterialSpec::Number(n) => ("the index", Dispersion::constant(n.0, 0.0)),
            MaterialSpec::Complex(index) => ("the index", Dispersion::constant(index.n.0, index.k.0)),
            MaterialSpec::Text(name) => (name.as_str(), material(name)),
        };
        let dispersion = match dispersion {
            Err(SpectraError::UnknownName { .. }) if self.is_file(name) => {
                self.index_file(name, spec.origin)?
            }
            Err(SpectraError::UnknownName { kind, .. }) => {
                let names = material_names().to_vec();
                self.err(spec, Problem::UnknownName { kind, name: name.to_owned(), names });
                return None;
            }
            other => self.sampled(name, spec.origin, other)?,
        };
        let on_grid = dispersion.on(&self.grid);
        self.sampled(name, spec.origin, on_grid)
    }

    fn index_file(&mut self, name: &str, origin: Origin) -> Option<Dispersion> {
        let file = self.open(name, origin)?;
        match read_index(&file) {
            Ok(dispersion) => Some(dispersion),
            Err(error) => {
                self.errors.push_data(origin, error);
                None
            }
        }
    }
}

/// Bytes as hexadecimal digits.
pub(crate) fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
