//! The spectrum of a light: by name, from a file, or by models.

use papilio_diagnostics::Diagnostic;
use papilio_formats::read_light_with_notes;
use papilio_spectra::{
    Grid, LightSpectrum, SpectraError, Spectrum, Tabulated, daylight, illuminant, illuminant_info, ohno_led,
    planck,
};

use super::Resolver;
use super::sampling::{self, ColourAndEfficacy, Loss};
use crate::describe::lighting::{LightModel, LightSpectrum as Described};
use crate::describe::numbers::Wavelength;
use crate::mistake;
use crate::origin::Origin;
use crate::read::{Read, Spanned};

/// Wavelength at which daylight and black bodies have the value 1, nm.
const UNIT_NM: f64 = 560.0;

/// Smallest maximum of a light: the squares of smaller values underflow.
const DARKEST: f64 = 1e-30;

/// Samples per nanometre of an LED model, whose width is at least 0.1 nm.
const LED_PER_NM: usize = 40;

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

    /// Means over 1 nm; the values at integer wavelengths of smooth spectra, and of the CIE's illuminants and tables with points there
    /// alone, which are summed over 1 nm by definition.
    fn means(&self, own: &Grid) -> Result<Spectrum, SpectraError> {
        match &self.source {
            Source::Table(table) if !is_at_integers(table) => Ok(table.means(own)?.map(|v| v * self.weight)),
            Source::Led { .. } => {
                let finer = Grid::new(own.start_nm(), own.stop_nm(), 1.0 / LED_PER_NM as f64)?;
                Ok(sampling::means(&self.on(&finer)?, LED_PER_NM).into())
            }
            _ => self.on(own),
        }
    }
}

fn all_on(parts: &[Part], grid: &Grid) -> Result<Spectrum, SpectraError> {
    let parts: Result<_, _> = parts.iter().map(|part| part.on(grid)).collect();
    parts.map(|parts| sum(grid, parts))
}

fn is_at_integers(table: &Tabulated) -> bool {
    table.wavelengths_nm().iter().all(|nm| nm.fract() == 0.0)
}

impl Resolver<'_> {
    /// Resolves the relative spectrum at `key` on the grid, which has no negative values and some positive
    /// ones.
    pub(super) fn light(&mut self, key: &str, light: &Spanned<Described>) -> Option<LightSpectrum> {
        let parts = match &light.value {
            Described::Text(name) => vec![self.named_light(name, light)?],
            Described::One(model) => vec![self.model(model, light.origin)?],
            Described::Sum(models) => {
                self.limit(light, "models", models.len(), 256)?;
                if models.is_empty() {
                    self.err(light, mistake::empty_list());
                    return None;
                }
                let parts: Vec<_> = models.iter().map(|model| self.model(model, model.origin)).collect();
                parts.into_iter().collect::<Option<_>>()?
            }
        };
        if !self.needs_light
            && let Some(Err(SpectraError::OutsideTable { first, last, .. })) =
                parts.iter().map(|part| part.on(&self.grid)).find(Result::is_err)
        {
            let (start, stop) = (self.grid.start_nm(), self.grid.stop_nm());
            self.notes.push(format!(
                "{key} reaches from {first} to {last} nm, not from {start} to {stop} nm; where this command needs a light, it is one of equal energy"
            ));
            return Some(Spectrum::constant(&self.grid, 1.0).into());
        }
        let sampled = |part: &Part| {
            let on_grid = part.on(&self.grid);
            self.sampled(&part.name, part.origin, on_grid)
        };
        let sampled: Vec<_> = parts.iter().map(sampled).collect();
        let on_grid = sum(&self.grid, sampled.into_iter().collect::<Option<Vec<_>>>()?);
        let with_lines = sampling::loss(|grid| all_on(&parts, grid), &self.grid)
            .and_then(|loss| self.with_lines(key, &parts, &loss));
        let spectrum = match with_lines {
            Some(light) => light,
            None => LightSpectrum::sampled(&self.grid, |grid| all_on(&parts, grid))
                .unwrap_or_else(|_| on_grid.into()),
        };
        if spectrum.max() < DARKEST {
            let (start, stop) = (self.grid.start_nm(), self.grid.stop_nm());
            let wrong = Diagnostic::new(format!("this light is dark between {start} and {stop} nm"));
            let wrong =
                wrong.hint("change spectrum.range_nm; lines narrower than a step below 1 nm are lost");
            self.errors.push(light.origin.or_override([self.range]), wrong);
            return None;
        }
        Some(spectrum)
    }

    /// Represents a light whose lines are too narrow for the grid by its means over 1 nm, with a note. On a
    /// grid of less than 1 nm there is a warning instead.
    fn with_lines(&mut self, key: &str, parts: &[Part], loss: &Loss) -> Option<LightSpectrum> {
        let step = self.grid.step_nm();
        let means = |own: &Grid| {
            let parts: Result<_, _> = parts.iter().map(|part| part.means(own)).collect();
            parts.map(|parts| sum(own, parts))
        };
        let light = self.grid.integers().and_then(|own| LightSpectrum::with_lines(&self.grid, means(&own)?));
        let in_words =
            |it: Option<ColourAndEfficacy>| it.map_or("no visible light".to_owned(), |it| it.to_string());
        let (here, itself) = (in_words(loss.on_grid), in_words(loss.itself));
        match light {
            Ok(light) => {
                self.notes.push(format!(
                    "{key} changes too fast for a step of {step} nm (on the grid it would have {here} instead of {itself}): it is represented by its means \
                     over 1 nm, from which X, Y and Z are computed (docs/light.md)"
                ));
                Some(light)
            }
            Err(_) => {
                self.warnings.push(format!(
                    "{key} changes too fast for a step of {step} nm: it has {here} on the grid, {itself} without it; set \
                     spectrum.step_nm to 1 or more: a light is then represented by its means over 1 nm"
                ));
                None
            }
        }
    }

    fn named_light(&mut self, name: &str, light: &Spanned<Described>) -> Option<Part> {
        let part = |source| Part { name: name.to_owned(), origin: light.origin, weight: 1.0, source };
        match illuminant(name, &self.grid) {
            Err(SpectraError::UnknownName { .. }) if self.is_file(name) => {
                let table = self.data_with_notes(name, light.origin, read_light_with_notes)?;
                Some(part(Source::Table(table)))
            }
            Err(SpectraError::UnknownName { .. }) => {
                self.err(light, mistake::unknown_light(name));
                None
            }
            _ => {
                self.note_alias(name);
                Some(part(Source::Illuminant(name.to_owned())))
            }
        }
    }

    /// Notes that the name of a lamp is taken as the CIE's illuminant of its type.
    fn note_alias(&mut self, name: &str) {
        let spelled = |name: &str| name.to_uppercase().replace(['-', '_', ' '], "");
        let Some(info) = illuminant_info(name) else { return };
        let (given, known) = (spelled(name), spelled(info.name));
        if given != known && given.replacen('F', "FL", 1) != known {
            let note = format!("the light `{name}` is the CIE's {}: {}", info.name, info.what);
            if !self.notes.contains(&note) {
                self.notes.push(note);
            }
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
