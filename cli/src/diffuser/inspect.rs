//! `papilio diffuser inspect`: the quality of a measurement.

use std::io::Write;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use papilio_figures::{Transmission, lobes, transmission};
use papilio_formats::{
    AuditFile, BsdfFile, LARGEST_FILE, Warned, audit_text, open_input, read_fractions_with_notes, write_json,
};
use papilio_goniometry::{Audit, Channels, MeasuredPart};

use super::{read_file, report};
use crate::arguments::Inspect;
use crate::progress::Progress;
use crate::{Failure, output, print_message};

pub(crate) fn inspect(arguments: &Inspect) -> Result<(), Failure> {
    arguments.out.as_deref().map_or(Ok(()), output::check)?;
    let BsdfFile { measurement, warnings, mut notes, .. } = read_file(&arguments.file, arguments.part)?;
    let spectra: Vec<Transmission> =
        arguments.transmission.iter().map(|path| spectrum(path, &mut notes)).collect::<Result<_, _>>()?;
    // The printed report has the luminous channel of each part; JSON has all channels.
    let audits: Vec<Option<Audit>> =
        measurement.parts.iter().map(|part| Audit::of(part, part.luminous())).collect();
    let mut stdout = crate::terminal::output(arguments.json);
    if arguments.json {
        let all: Vec<(&MeasuredPart, Vec<Audit>)> =
            measurement.parts.iter().map(|part| (part, all_channels(part))).collect();
        write_json(&mut stdout, &AuditFile::new(&measurement, &all, [&notes, &warnings]))?;
    } else {
        let name = arguments.file.display().to_string();
        stdout.write_all(audit_text(&name, &measurement, &audits).as_bytes())?;
        stdout.write_all(report::spectra(&spectra).as_bytes())?;
    }
    stdout.flush()?;
    let Some(folder) = &arguments.out else { return Ok(()) };
    output::make_folder(folder)?;
    let mut figures: Vec<(String, String)> = lobes(&measurement, &audits);
    if !spectra.is_empty() {
        figures.push(("transmission".to_owned(), transmission(&spectra, "Transmission along the normal")));
    }
    output::print_written(folder, &output::write_figures(folder, figures, arguments.png)?);
    Ok(())
}

/// Audits all channels of a part, several at a time.
fn all_channels(part: &MeasuredPart) -> Vec<Audit> {
    let Some(channels) = Channels::new(part, (0..part.channels.len()).collect()) else { return Vec::new() };
    let progress = Mutex::new((channels.count() > 1).then(|| Progress::new(channels.count(), "channels")));
    let (next, audits) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let work = || {
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= channels.count() {
                return;
            }
            let audit = channels.audit(number);
            audits.lock().unwrap_or_else(PoisonError::into_inner).push((number, audit));
            progress.lock().unwrap_or_else(PoisonError::into_inner).iter_mut().for_each(|bar| bar.done(true));
        }
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from).min(channels.count());
    std::thread::scope(|scope| (0..threads).for_each(|_| drop(scope.spawn(work))));
    let mut audits = audits.into_inner().unwrap_or_else(PoisonError::into_inner);
    audits.sort_by_key(|(number, _)| *number);
    audits.into_iter().map(|(_, audit)| audit).collect()
}

/// Reads a transmission spectrum from a file, and adds its notes.
fn spectrum(path: &Path, notes: &mut Vec<String>) -> Result<Transmission, Failure> {
    let file = open_input(path, &path.display().to_string(), LARGEST_FILE).map_err(Failure::Data)?;
    let Warned { value: spectrum, warnings } = read_fractions_with_notes(&file).map_err(Failure::Data)?;
    for note in warnings {
        let note = format!("{}: {note}", file.name);
        print_message(&format!("note: {note}"));
        notes.push(note);
    }
    Ok(Transmission {
        name: path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        wavelength_nm: spectrum.wavelengths_nm().to_vec(),
        share: spectrum.values().to_vec(),
    })
}
