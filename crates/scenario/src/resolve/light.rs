//! The spectrum of a light: by name, from a file, or by models.

use papilio_diagnostics::Diagnostic;
use papilio_formats::read_light;
use papilio_spectra::{
    Grid, SpectraError, Spectrum, Tabulated, daylight, illuminant, illuminant_names, ohno_led, planck,
};

use super::{Resolver, sampling};
use crate::describe::lighting::{LightModel, LightSpectrum};
use crate::describe::numbers::Wavelength;
use crate::mistake;
use crate::origin::Origin;
use crate::read::{Read, Spanned};

/// Wavelength at which daylight and black bodies have the value 1, nm.
const UNIT_NM: f64 = 560.0;

/// Smallest maximum of a light: the squares of smaller values underflow.
const DARKEST: f64 = 1e-30;

/// One of the terms of a light.
struct Part {
    /// Name in errors.
    name: String,
    origin: Origin,
    weight: f64,
    source: Source,
}

enum Source {
    Illuminant(String),
    Table(Tabulated),
    Led { peak_nm: f64, width_nm: f64 },
    Daylight { cct_k: f64 },
    BlackBody { temperature_k: f64 },
}

impl Part {
    fn on(&self, grid: &Grid) -> Result<Spectrum, SpectraError> {
        let spectrum = match &self.source {
            Source::Illuminant(name) => illuminant(name, grid),
            Source::Table(table) => table.on(grid),
            Source::Led { peak_nm, width_nm } => ohno_led(grid, *peak_nm, *width_nm),
            Source::Daylight { cct_k } => unit(|grid| daylight(*cct_k, grid), grid),
            Source::BlackBody { temperature_k } => unit(|grid| planck(*temperature_k, grid), grid),
        };
        Ok(spectrum?.map(|v| v * self.weight))
    }
}

impl Resolver<'_> {
    /// Resolves the relative spectrum at `key` on the grid, which has no negative values and some positive ones.
    pub(super) fn light(&mut self, key: &str, light: &Spanned<LightSpectrum>) -> Option<Spectrum> {
        let parts = match &light.value {
            LightSpectrum::Text(name) => vec![self.named_light(name, light)?],
            LightSpectrum::One(model) => vec![self.model(model, light.origin)?],
            LightSpectrum::Sum(models) => {
                self.limit(light, "models", models.len(), 256)?;
                if models.is_empty() {
                    self.err(light, mistake::empty_list());
                    return None;
                }
                let parts: Vec<_> = models.iter().map(|model| self.model(model, model.origin)).collect();
                parts.into_iter().collect::<Option<_>>()?
            }
        };
        let sampled = |part: &Part| {
            let on_grid = part.on(&self.grid);
            self.sampled(&part.name, part.origin, on_grid)
        };
        let sampled: Vec<_> = parts.iter().map(sampled).collect();
        let spectrum = sum(&self.grid, sampled.into_iter().collect::<Option<Vec<_>>>()?);
        if spectrum.max() < DARKEST {
            let (start, stop) = (self.grid.start_nm(), self.grid.stop_nm());
            let wrong = Diagnostic::new(format!("this light is dark between {start} and {stop} nm")).hint(
                "lines narrower than the grid's step are lost: set spectrum.step_nm = 1; or change range_nm",
            );
            self.errors.push(light.origin.or_override([self.range]), wrong);
            return None;
        }
        let all_on = |grid: &Grid| {
            let parts: Result<_, _> = parts.iter().map(|part| part.on(grid)).collect();
            parts.map(|parts| sum(grid, parts))
        };
        if let Some(loss) = sampling::loss(all_on, &self.grid) {
            self.warnings.push(format!("{key} {loss}"));
        }
        Some(spectrum)
    }

    fn named_light(&mut self, name: &str, light: &Spanned<LightSpectrum>) -> Option<Part> {
        let part = |source| Part { name: name.to_owned(), origin: light.origin, weight: 1.0, source };
        match illuminant(name, &self.grid) {
            Err(SpectraError::UnknownName { .. }) if self.is_file(name) => {
                let table = self.data(name, light.origin, read_light)?;
                Some(part(Source::Table(table)))
            }
            Err(SpectraError::UnknownName { .. }) => {
                self.err(light, mistake::unknown_name("light", name, illuminant_names()));
                None
            }
            _ => Some(part(Source::Illuminant(name.to_owned()))),
        }
    }

    fn model(&mut self, model: &LightModel, origin: Origin) -> Option<Part> {
        let (name, source) =
            match (model.led_nm.value, model.width_nm.value, model.daylight_K.value, model.planck_K.value) {
                (Some(peak), Some(width), None, None) => {
                    ("the LED", Source::Led { peak_nm: peak.0, width_nm: width.0 })
                }
                (None, None, Some(cct), None) => ("daylight", Source::Daylight { cct_k: cct.0 }),
                (None, None, None, Some(t)) => ("the black body", Source::BlackBody { temperature_k: t.0 }),
                (led, width, None, None) if led.is_some() != width.is_some() => {
                    let key = if led.is_some() { "width_nm" } else { "led_nm" };
                    self.errors.push(origin, mistake::missing_key(key, Wavelength::in_words()));
                    return None;
                }
                (led, width, daylight, planck) => {
                    let given = [led.is_some() || width.is_some(), daylight.is_some(), planck.is_some()];
                    let given = given.into_iter().filter(|given| *given).count();
                    let keys = "`led_nm` with `width_nm`, `daylight_K` and `planck_K`";
                    let keys_at = [
                        model.led_nm.origin,
                        model.width_nm.origin,
                        model.daylight_K.origin,
                        model.planck_K.origin,
                    ];
                    self.errors.push(origin.or_override(keys_at), mistake::exactly_one(keys, given));
                    return None;
                }
            };
        Some(Part { name: name.to_owned(), origin, weight: model.weight.0, source })
    }
}

/// Returns the sum of all parts.
fn sum(grid: &Grid, parts: Vec<Spectrum>) -> Spectrum {
    parts.iter().fold(Spectrum::constant(grid, 0.0), |sum, part| sum.zip_map(part, |a, b| a + b))
}

/// Scales a spectrum to 1 at 560 nm.
fn unit(
    model: impl Fn(&Grid) -> Result<Spectrum, SpectraError>,
    grid: &Grid,
) -> Result<Spectrum, SpectraError> {
    let one = Grid::new(UNIT_NM, UNIT_NM + 1.0, 1.0)?;
    let scale = model(&one)?[0];
    Ok(model(grid)?.map(|v| v / scale))
}
