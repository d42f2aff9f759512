//! The dissertation's tables and published numbers, against Papilio.

pub mod table_5_1;
