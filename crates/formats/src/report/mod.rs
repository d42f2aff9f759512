//! The result of a run as words and tables, for the terminal and for `report.html`.

pub mod numbers;
mod page;
mod readability;
mod run;

pub use page::RunReport;
pub use run::{VIEWS_IN_FULL, effort, lines_of_view, plain, rows_of_states, rows_of_views, seen_from};
