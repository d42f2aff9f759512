//! The web app: a display laboratory in the browser, served from this machine.
//!
//! A thin face over `scenario`, `display`, `formats` and `figures`: no physics lives here. The browser holds the
//! scenario's text, the one thing that is ever edited; each request carries it whole. The server keeps only what
//! may be lost at any moment: prepared displays (so that a moved slider costs milliseconds), files that were dropped
//! onto the page (known by their SHA-256, sent again when they are gone), and running work.
//!
//! - [`Site::bind`] takes a port of this machine, [`Site::serve`] answers on it.
//! - `api` has a row for each endpoint; its OpenAPI description is made from the same rows and types
//!   ([`openapi`]).
//! - `work` runs what computes: on threads of its own, bounded in number and time, ended when nobody listens.
//! - `guard` turns away whoever is not this page: foreign hosts and origins, missing tokens.
//! - `listen` and `places` accept connections, so many at once, and end those whose clients do not read.
//! - `page` hands out the bundle of `web/page`, if one was built in.
//!
//! **Limits.** Requests of at most 1 MiB, scenarios of 256 KiB, files of 64 MiB, answers of about half a million
//! numbers. **Out of scope.** Reading or writing the disk on behalf of the browser; users and their passwords.

mod api;
mod fault;
mod guard;
mod kept;
mod listen;
mod page;
mod places;
mod reading;
mod shipped;
mod site;
mod store;
mod work;

pub use api::openapi;
pub use listen::ServeError;
pub use site::{Options, Site, Start};
