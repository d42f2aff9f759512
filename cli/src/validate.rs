//! `papilio validate`: the tables and figures of Feng (2012) next to Papilio's results, as HTML; or samples that others
//! measured.

mod measured;

use std::path::PathBuf;
use std::time::Instant;

use papilio_display::{Control, DisplayError};
use papilio_formats::write_file;
use papilio_reproduction::{ReproductionError, reproduce};

use crate::arguments::Validate;
use crate::progress::FractionBar;
use crate::{Failure, interrupt, output, print_message};

pub(crate) fn validate(arguments: &Validate) -> Result<(), Failure> {
    if let Some(names) = &arguments.measured {
        return measured::run(arguments, names);
    }
    let folder = arguments.out.clone().unwrap_or_else(|| PathBuf::from("out/validate"));
    output::check(&folder)?;
    output::make_folder(&folder)?;
    interrupt::catch_ctrl_c();
    let started = Instant::now();
    let bar = FractionBar::new();
    let log = bar.in_log(String::new);
    let control = Control {
        threads: arguments.workers.threads.map(usize::from),
        progress: &|report| bar.show(&report),
        stop: &interrupt::STOP,
    };
    let scenarios = folder.join("scenarios");
    let is_new = !scenarios.exists();
    let report = reproduce(&scenarios, &control);
    drop((log, bar));
    let report = match report {
        Err(ReproductionError::Display(DisplayError::Interrupted)) => {
            if is_new {
                // If a file cannot be removed, the next report writes it again.
                std::fs::remove_dir_all(&scenarios).ok();
            }
            return Err(Failure::Interrupted("no report was written"));
        }
        other => other?,
    };
    write_file(&folder.join("report.html"), |out| out.write_all(report.html().as_bytes()))?;
    print_message(&format!(
        "reproduced {} tables and figures in {:.1} s",
        report.sections.len() - 1,
        started.elapsed().as_secs_f64()
    ));
    print_message(&report.verdict());
    print_message(&format!("wrote {}: report.html, scenarios/", folder.display()));
    Ok(())
}
