//! The TOML scenario: describe and resolve, with errors that say where.
