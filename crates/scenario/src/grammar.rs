//! Macros that declare the grammar of a scenario.
//!
//! `table!`, `kinds!`, `choice!`, `number!` and `forms!` declare each part of the grammar once:
//! the type, its reading, its defaults, its JSON Schema and its documentation come from the same lines.
//! The declarations themselves are in `describe`.

/// Declares a table: its keys, each with its type, meaning and (after `=`) default; after `as` its label, where the words of
/// the key are not enough.
/// Keys that a later version will have (`later`) get a message of their own.
macro_rules! table {
    (
        $(#[doc = $doc:literal])*
        $name:ident $(later [$($later:literal),* $(,)?])? {
            $( $(#[doc = $field_doc:literal])* $field:ident $(as $label:literal)? : $ty:ty $(= $default:expr)? ),* $(,)?
        }
    ) => {
        $(#[doc = $doc])*
        #[derive(Debug, Clone, serde::Serialize)]
        #[allow(non_snake_case, reason = "the unit K keeps its letter")]
        pub(crate) struct $name {
            $(
                $(#[doc = $field_doc])*
                #[serde(skip_serializing_if = "Spanned::is_absent")]
                pub(crate) $field: Spanned<$ty>,
            )*
        }

        impl $crate::read::Table for $name {
            fn keys() -> Vec<&'static str> {
                vec![$(stringify!($field)),*]
            }

            fn rows() -> Vec<$crate::schema::Row> {
                vec![$( $crate::schema::Row::new::<$ty>(
                    stringify!($field),
                    concat!($($field_doc, "\n"),*),
                    $crate::grammar::table!(@label $($label)?),
                    $crate::grammar::table!(@default $($default)?),
                ) ),*]
            }
        }

        impl $crate::read::Read for $name {
            fn in_words() -> String {
                format!("a table with the keys {}", <Self as $crate::read::Table>::keys().join(", "))
            }

            fn on_page() -> String {
                "a table".to_owned()
            }

            #[allow(non_snake_case, reason = "as in the struct")]
            fn read(node: &$crate::tree::Node, errors: &mut $crate::error::Errors) -> Option<Self> {
                node.known_entries(&<Self as $crate::read::Table>::keys(), &[$($($later),*)?], errors)?;
                $( let $field = node.field::<$ty>(stringify!($field), $crate::grammar::table!(@default $($default)?), errors); )*
                Some(Self { $($field: $field?),* })
            }

            /// A table may be missing if all its keys may be missing.
            fn absent() -> Option<Self> {
                let mut errors = $crate::error::Errors::default();
                let table = Self::read(&$crate::tree::Node::empty_table(), &mut errors);
                table.filter(|_| errors.is_empty())
            }
        }

        impl schemars::JsonSchema for $name {
            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($name).into()
            }

            fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
                let rows = <Self as $crate::read::Table>::rows();
                $crate::schema::of_table(&rows, concat!($($doc, "\n"),*), generator)
            }
        }
    };
    (@label) => { None };
    (@label $label:literal) => { Some($label) };
    (@default) => { None };
    (@default $default:expr) => { Some($default) };
}
pub(crate) use table;

/// Declares a table of several kinds, selected by one key: each kind has keys of its own.
macro_rules! kinds {
    (
        $(#[doc = $doc:literal])*
        $name:ident by $tag:literal {
            $( $(#[doc = $kind_doc:literal])* $variant:ident($ty:ty) = $word:literal ),* $(,)?
        }
        $(later [$($later:literal),* $(,)?])?
    ) => {
        $(#[doc = $doc])*
        #[derive(Debug, Clone, serde::Serialize)]
        #[serde(tag = $tag)]
        #[allow(clippy::large_enum_variant, reason = "a scenario has a few of them, not many")]
        pub(crate) enum $name {
            $( $(#[doc = $kind_doc])* #[serde(rename = $word)] $variant($crate::read::Spanned<$ty>), )*
        }

        impl $crate::read::Table for $name {
            fn keys() -> Vec<&'static str> {
                let kinds = [$(<$ty as $crate::read::Table>::keys()),*];
                std::iter::once($tag).chain(kinds.into_iter().flatten()).collect()
            }
        }

        impl $crate::read::Read for $name {
            fn in_words() -> String {
                let kinds: &[&str] = &[$(concat!($tag, " = \"", $word, "\"")),*];
                format!("a table with {}", kinds.join(" or "))
            }

            fn on_page() -> String {
                concat!("a table; its keys depend on `", $tag, "`").to_owned()
            }

            fn read(node: &$crate::tree::Node, errors: &mut $crate::error::Errors) -> Option<Self> {
                let known = vec![$($crate::kinds::Kind {
                    word: $word,
                    named: concat!($tag, " = \"", $word, "\""),
                    keys: <$ty as $crate::read::Table>::keys(),
                }),*];
                let kinds = $crate::kinds::Kinds { tag: $tag, known, later: &[$($($later),*)?] };
                let $crate::tree::Value::Table(_) = &node.value else {
                    return node.wrong_type(Self::in_words(), errors);
                };
                let (word, origin, rest) = kinds.split(node, errors)?;
                match word {
                    $( $word => <$ty as $crate::read::Read>::read(&rest, errors)
                        .map(|value| Self::$variant($crate::read::Spanned { value, origin })), )*
                    _ => None,
                }
            }
        }

        impl schemars::JsonSchema for $name {
            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($name).into()
            }
            fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
                let kinds = [$(
                    $crate::schema::with_tag($tag, $word, <$ty as schemars::JsonSchema>::json_schema(generator))
                ),*];
                schemars::json_schema!({ "oneOf": kinds, "description": concat!($($doc, "\n"),*).trim() })
            }
        }
    };
}
pub(crate) use kinds;

/// Declares a set of words, of which a value is one: an enum of the grammar, or, after `for`, the words of an enum that
/// means something elsewhere, which is then read as [`Word`](crate::word::Word).
macro_rules! choice {
    (for $name:ident { $( $(#[doc = $word_doc:literal])* $variant:ident = $word:literal ),* $(,)? }) => {
        impl $crate::word::Words for $name {
            const WORDS: &'static [(&'static str, Self, &'static str)] =
                &[$(($word, Self::$variant, concat!($($word_doc),*))),*];

            fn word(self) -> &'static str {
                match self { $(Self::$variant => $word),* }
            }
        }
    };
    (
        $(#[doc = $doc:literal])*
        $name:ident { $( $(#[doc = $word_doc:literal])* $variant:ident = $word:literal ),* $(,)? }
    ) => {
        $(#[doc = $doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub(crate) enum $name { $( $(#[doc = $word_doc])* $variant, )* }

        $crate::grammar::choice! { for $name { $( $(#[doc = $word_doc])* $variant = $word ),* } }

        impl serde::Serialize for $name {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                $crate::word::Word(*self).serialize(serializer)
            }
        }

        impl $crate::read::Read for $name {
            fn in_words() -> String {
                $crate::word::Word::<Self>::in_words()
            }

            fn on_page() -> String {
                $crate::word::Word::<Self>::on_page()
            }

            fn read(node: &$crate::tree::Node, errors: &mut $crate::error::Errors) -> Option<Self> {
                $crate::word::Word::read(node, errors).map(|word| word.0)
            }
        }

        impl schemars::JsonSchema for $name {
            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($name).into()
            }
            fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
                $crate::word::Word::<Self>::json_schema(generator)
            }
            fn inline_schema() -> bool {
                true
            }
        }
    };
}
pub(crate) use choice;

/// Declares a number with its range, which defines its description, test and schema.
macro_rules! number {
    ($(#[doc = $doc:literal])* $name:ident, $range:expr) => {
        $(#[doc = $doc])*
        #[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
        pub(crate) struct $name(pub(crate) f64);

        impl $name {
            /// Range of the number.
            const RANGE: $crate::range::Range = $range;
        }

        impl $crate::read::Read for $name {
            fn in_words() -> String {
                Self::RANGE.in_words()
            }

            fn read(node: &$crate::tree::Node, errors: &mut $crate::error::Errors) -> Option<Self> {
                Self::RANGE.read(node, errors).map(Self)
            }
        }

        impl schemars::JsonSchema for $name {
            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($name).into()
            }
            fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
                Self::RANGE.schema().into()
            }
            fn inline_schema() -> bool {
                true
            }
        }
    };
}
pub(crate) use number;

/// Declares a value with several forms: the first form that fits the type of the value, and a further condition on it, is read.
macro_rules! forms {
    (
        $(#[doc = $doc:literal])*
        $name:ident, $words:expr; { $( $(#[doc = $form_doc:literal])* $variant:ident($ty:ty) if $pattern:pat $(if $fits:path)? ),* $(,)? }
    ) => {
        $(#[doc = $doc])*
        #[derive(Debug, Clone, serde::Serialize)]
        #[serde(untagged)]
        pub(crate) enum $name { $( $(#[doc = $form_doc])* $variant($ty), )* }

        impl $crate::read::Read for $name {
            fn in_words() -> String {
                ($words).to_string()
            }

            fn read(node: &$crate::tree::Node, errors: &mut $crate::error::Errors) -> Option<Self> {
                use $crate::tree::Value;
                let before = errors.count();
                let read = match &node.value {
                    $( $pattern $(if $fits(node))? => <$ty as $crate::read::Read>::read(node, errors).map(Self::$variant), )*
                    _ => node.wrong_type(Self::in_words(), errors),
                };
                if read.is_none() && matches!(node.value, Value::Text(_)) {
                    errors.expected_at(before, node.origin, &Self::in_words());
                }
                read
            }
        }

        impl schemars::JsonSchema for $name {
            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($name).into()
            }
            fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
                let forms = [$(generator.subschema_for::<$ty>()),*];
                schemars::json_schema!({ "anyOf": forms, "description": concat!($($doc, "\n"),*).trim() })
            }
        }
    };
}
pub(crate) use forms;
