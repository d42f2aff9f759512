//! `codes` of `[display.pixel]`: what the controller of the panel calls each state.

use std::borrow::Cow;

use papilio_formats::panel::{CONTROLLERS, Controller};
use schemars::{JsonSchema, Schema, SchemaGenerator};

use super::numbers::Count;
use crate::error::Errors;
use crate::read::{Named, Read};
use crate::tree::{Node, Value};
use crate::word::{Word, Words};

/// Codes of states: one for each, or those of a controller.
#[derive(Debug, Clone, serde::Serialize)]
#[serde(untagged)]
pub(crate) enum Codes {
    /// Those of a controller.
    Of(Word<NamedController>),
    /// A code for each state.
    Own(Named<Code>),
}

/// A code of a state.
pub(crate) type Code = Count<0, 255>;

/// A controller with a name.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NamedController(pub(crate) &'static Controller);

impl Words for NamedController {
    const WORDS: &'static [(&'static str, Self, &'static str)] = &{
        let mut words = [("", Self(&CONTROLLERS[0]), ""); CONTROLLERS.len()];
        let mut at = 0;
        while at < CONTROLLERS.len() {
            words[at] = (CONTROLLERS[at].name, Self(&CONTROLLERS[at]), CONTROLLERS[at].panel);
            at += 1;
        }
        words
    };

    fn word(self) -> &'static str {
        self.0.name
    }
}

impl Read for Codes {
    fn in_words() -> String {
        format!("{}, or the name of a controller: {}", Self::own(), Word::<NamedController>::in_words())
    }

    fn on_page() -> String {
        format!("{}, or a [controller](panel.md#controllers)", Self::own())
    }

    fn read(node: &Node, errors: &mut Errors) -> Option<Self> {
        match &node.value {
            Value::Text(_) => Word::read(node, errors).map(Self::Of),
            Value::Table(_) => Named::read(node, errors).map(Self::Own),
            _ => node.wrong_type(Self::in_words(), errors),
        }
    }
}

impl Codes {
    /// Codes of the user's own, in words.
    fn own() -> String {
        format!("a table of states, each with {}", Code::in_words())
    }
}

impl JsonSchema for Codes {
    fn schema_name() -> Cow<'static, str> {
        "Codes".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let forms =
            [generator.subschema_for::<Word<NamedController>>(), generator.subschema_for::<Named<Code>>()];
        schemars::json_schema!({ "anyOf": forms })
    }

    fn inline_schema() -> bool {
        true
    }
}
