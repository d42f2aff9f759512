//! The dissertation's tables and published numbers, against Papilio.
