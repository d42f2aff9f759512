//! Words of the grammar and the values that they mean; `choice!` declares them.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Serialize, Serializer};

use crate::error::Errors;
use crate::read::{Read, unknown_word};
use crate::schema::choices;
use crate::tree::{Node, Value};

/// Values that have words in the grammar.
pub(crate) trait Words: Copy + 'static {
    /// Each word with its value and its meaning for the documentation.
    const WORDS: &'static [(&'static str, Self, &'static str)];

    /// Returns the word of the value.
    fn word(self) -> &'static str;

    /// Returns all words.
    fn words() -> Vec<&'static str> {
        Self::WORDS.iter().map(|(word, ..)| *word).collect()
    }
}

/// A word of the grammar, read as the value that it means, which may be of another crate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Word<T>(pub(crate) T);

impl<T: Words> Read for Word<T> {
    fn in_words() -> String {
        T::words().iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(" or ")
    }

    fn on_page() -> String {
        choices(&T::WORDS.iter().map(|(word, _, meaning)| (*word, *meaning)).collect::<Vec<_>>())
    }

    fn read(node: &Node, errors: &mut Errors) -> Option<Self> {
        let Value::Text(text) = &node.value else {
            return node.wrong_type(Self::in_words(), errors);
        };
        match T::WORDS.iter().find(|(word, ..)| word == text) {
            Some((_, value, _)) => Some(Self(*value)),
            None => unknown_word(node, text, &T::words(), &[], errors),
        }
    }
}

impl<T: Words> Serialize for Word<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.0.word())
    }
}

impl<T: Words> JsonSchema for Word<T> {
    fn schema_name() -> Cow<'static, str> {
        "Word".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "enum": T::words() })
    }
    fn inline_schema() -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use papilio_display::scene::{Method, Sampler, Strategy};
    use papilio_imaging::halftone::{DiffusionKernel, Scan};

    use super::Words;

    #[test]
    fn names_of_samplers_and_strategies_are_their_words_in_scenarios() {
        assert!(Sampler::ALL.iter().all(|sampler| sampler.name() == sampler.word()));
        assert!(Strategy::ALL.iter().all(|strategy| strategy.name() == strategy.word()));
    }

    #[test]
    fn every_kernel_and_scan_has_a_word() {
        assert_eq!(DiffusionKernel::words().len(), DiffusionKernel::ALL.len());
        assert_eq!(Scan::words().len(), Scan::ALL.len());
        assert_eq!(Method::words(), ["adding", "monte-carlo", "auto"]);
    }
}
