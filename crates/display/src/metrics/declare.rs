//! Macros that declare the metrics from the table in `mod.rs`.

/// The label of a line of a table: the quantity, and its unit if it has one.
macro_rules! label_of {
    ($name:ident) => {
        KnownLabel { name: stringify!($name), quantity: None, unit: "" }
    };
    ($name:ident $quantity:literal) => {
        KnownLabel { name: stringify!($name), quantity: Some($quantity), unit: "" }
    };
    ($name:ident $quantity:literal $unit:literal) => {
        KnownLabel { name: stringify!($name), quantity: Some($quantity), unit: $unit }
    };
}

/// Declares a structure of metrics that may be undefined, with iterators over all of them.
macro_rules! numbers {
    (
        $(#[doc = $doc:literal])*
        $name:ident {
            $( $(#[doc = $field_doc:literal])* $field:ident $(= $quantity:literal $(in $unit:literal)?)? ),* $(,)?
        }
    ) => {
        $(#[doc = $doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, JsonSchema)]
        #[allow(non_snake_case, reason = "the letters of the field's own symbols")]
        pub struct $name {
            $( $(#[doc = $field_doc])* pub $field: Option<f64>, )*
        }

        impl $name {
            /// Labels of all fields.
            #[allow(dead_code, reason = "contrasts of lines have those of the metrics of a view")]
            pub(crate) const LABELS: &[KnownLabel] = &[$(label_of!($field $($quantity $($unit)?)?)),*];

            /// Returns names and values, in order.
            pub fn named(&self) -> impl Iterator<Item = (&'static str, Option<f64>)> + use<> {
                [$((stringify!($field), self.$field)),*].into_iter()
            }

            /// Returns all values, in order.
            #[allow(dead_code, reason = "not all metrics are computed in lists")]
            pub(crate) fn all_mut(&mut self) -> impl Iterator<Item = &mut Option<f64>> {
                [$(&mut self.$field),*].into_iter()
            }
        }
    };
}

/// Declares the enum of all metrics that can be targets: those of a view, and those of a state.
macro_rules! names {
    (
        view {
            $( $(#[doc = $view_doc:literal])* $view:ident $(= $view_quantity:literal $(in $view_unit:literal)?)? ),* $(,)?
        }
        values { $($value:ident $(= $quantity:literal $(in $unit:literal)?)?),* $(,)? }
        state {
            $( $(#[doc = $state_doc:literal])* $state:ident $(= $state_quantity:literal $(in $state_unit:literal)?)? ),* $(,)?
        }
        mtf_view {
            $( $(#[doc = $mv_doc:literal])* $mtf_view:ident $(= $mv_quantity:literal $(in $mv_unit:literal)?)? ),* $(,)?
        }
        mtf_state {
            $( $(#[doc = $ms_doc:literal])* $mtf_state:ident $(= $ms_quantity:literal $(in $ms_unit:literal)?)? ),* $(,)?
        }
        crosstalk {
            $( $(#[doc = $crosstalk_doc:literal])* $crosstalk:ident $(= $crosstalk_quantity:literal $(in $crosstalk_unit:literal)?)? ),* $(,)?
        }
        sparkle {
            $( $(#[doc = $sparkle_doc:literal])* $sparkle:ident $(= $sparkle_quantity:literal $(in $sparkle_unit:literal)?)? ),* $(,)?
        }
        image {
            $( $(#[doc = $image_doc:literal])* $image:ident $(= $image_quantity:literal $(in $image_unit:literal)?)? ),* $(,)?
        }
        gloss {
            $( $(#[doc = $gloss_doc:literal])* $gloss:ident $(= $gloss_quantity:literal $(in $gloss_unit:literal)?)? ),* $(,)?
        }
    ) => {
        /// Labels of the fields of `StateValues` that are metrics.
        pub(crate) const VALUE_LABELS: &[KnownLabel] = &[$(label_of!($value $($quantity $($unit)?)?)),*];

        /// Metric of a result, named as there.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[allow(missing_docs, non_camel_case_types, reason = "named and documented as the fields of a result")]
        pub enum Metric { $($view,)* $($value,)* $($state,)* $($mtf_view,)* $($mtf_state,)* $($crosstalk,)* $($sparkle,)* $($image,)* $($gloss,)* }

        impl Metric {
            /// Returns true for metrics of a view, which combine its states.
            pub fn is_of_view(self) -> bool {
                matches!(
                    self,
                    $(Self::$view)|* $(| Self::$mtf_view)* $(| Self::$crosstalk)* $(| Self::$sparkle)* $(| Self::$image)*
                )
            }

            /// Returns the name of the metric in a result.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$view => stringify!($view),)*
                    $(Self::$value => stringify!($value),)*
                    $(Self::$state => stringify!($state),)*
                    $(Self::$mtf_view => stringify!($mtf_view),)*
                    $(Self::$mtf_state => stringify!($mtf_state),)*
                    $(Self::$crosstalk => stringify!($crosstalk),)*
                    $(Self::$sparkle => stringify!($sparkle),)*
                    $(Self::$image => stringify!($image),)*
                    $(Self::$gloss => stringify!($gloss),)*
                }
            }

            /// Returns what computes the metric.
            pub fn source(self) -> MetricSource {
                match self {
                    $(Self::$mtf_view)|* $(| Self::$mtf_state)* => MetricSource::Mtf,
                    $(Self::$crosstalk)|* => MetricSource::Crosstalk,
                    $(Self::$sparkle)|* => MetricSource::Sparkle,
                    $(Self::$image)|* => MetricSource::Image,
                    $(Self::$gloss)|* => MetricSource::Gloss,
                    _ => MetricSource::Colours,
                }
            }

            /// Returns the value of a metric of the sharpness of a view; `None` for all others.
            pub(crate) fn of_sharpness(self, metrics: &SharpnessMetrics) -> Option<f64> {
                match self {
                    $(Self::$mtf_view => metrics.$mtf_view,)*
                    _ => None,
                }
            }

            /// Returns the value of a metric of the sharpness of a state; `None` for all others.
            pub(crate) fn of_spatial(self, scalars: &SpatialScalars) -> Option<f64> {
                match self {
                    $(Self::$mtf_state => scalars.$mtf_state,)*
                    _ => None,
                }
            }

            /// Returns the value of a metric of crosstalk; `None` for all others.
            pub(crate) fn of_crosstalk(self, metrics: &CrosstalkMetrics) -> Option<f64> {
                match self {
                    $(Self::$crosstalk => metrics.$crosstalk,)*
                    _ => None,
                }
            }

            /// Returns the value of a metric of sparkle; `None` for all others.
            pub(crate) fn of_sparkle(self, metrics: &SparkleMetrics) -> Option<f64> {
                match self {
                    $(Self::$sparkle => metrics.$sparkle,)*
                    _ => None,
                }
            }

            /// Returns the value of a metric of a picture; `None` for all others.
            pub(crate) fn of_image(self, metrics: &ImageMetrics) -> Option<f64> {
                match self {
                    $(Self::$image => metrics.$image,)*
                    _ => None,
                }
            }

            /// Returns the value of a metric of gloss; `None` for all others.
            pub(crate) fn of_gloss(self, metrics: &GlossMetrics) -> Option<f64> {
                match self {
                    $(Self::$gloss => metrics.$gloss,)*
                    _ => None,
                }
            }

            /// All metrics.
            pub const ALL: &[Self] = &[
                $(Self::$view,)* $(Self::$value,)* $(Self::$state,)*
                $(Self::$mtf_view,)* $(Self::$mtf_state,)* $(Self::$crosstalk,)* $(Self::$sparkle,)* $(Self::$image,)*
                $(Self::$gloss,)*
            ];

            /// Returns the state and the metric of a written name: `white.Y`, or `contrast_ratio` without a state.
            pub fn with_state(text: &str) -> Option<(Option<&str>, Self)> {
                let (state, name) = match text.rsplit_once('.') {
                    Some((state, name)) => (Some(state), name),
                    None => (None, text),
                };
                let metric = Self::named(name).filter(|metric| metric.is_of_view() == state.is_none())?;
                Some((state, metric))
            }

            /// Returns the metric of this name, if it can be a target.
            pub fn named(name: &str) -> Option<Self> {
                Self::ALL.iter().copied().find(|metric| metric.name() == name)
            }

            /// Returns the value of a metric of a view; `None` for metrics of a state.
            pub(crate) fn of_view(self, metrics: &ViewMetrics) -> Option<f64> {
                match self {
                    $(Self::$view => metrics.$view,)*
                    _ => None,
                }
            }

            /// Returns the value of a metric of a state; `None` for metrics of a view.
            pub(crate) fn of_state(self, values: &StateValues) -> Option<f64> {
                match self {
                    $(Self::$value => values.$value.into(),)*
                    $(Self::$state => values.metrics.$state,)*
                    _ => None,
                }
            }
        }
    };
}

/// Declares all metrics from one table.
macro_rules! metrics {
    (
        $(#[doc = $view_doc:literal])* view $view_name:ident { $($view:tt)* }
        values { $($value:tt)* }
        $(#[doc = $state_doc:literal])* state $state_name:ident { $($state:tt)* }
        between_views { $($between:tt)* }
        state { $($last:tt)* }
        $(#[doc = $mv_doc:literal])* mtf_view $mv_name:ident { $($mtf_view:tt)* }
        $(#[doc = $ms_doc:literal])* mtf_state $ms_name:ident { $($mtf_state:tt)* }
        $(#[doc = $crosstalk_doc:literal])* crosstalk $crosstalk_name:ident { $($crosstalk:tt)* }
        $(#[doc = $sparkle_doc:literal])* sparkle $sparkle_name:ident { $($sparkle:tt)* }
        $(#[doc = $image_doc:literal])* image $image_name:ident { $($image:tt)* }
        $(#[doc = $gloss_doc:literal])* gloss $gloss_name:ident { $($gloss:tt)* }
    ) => {
        numbers! { $(#[doc = $view_doc])* $view_name { $($view)* } }
        numbers! { $(#[doc = $state_doc])* $state_name { $($state)* $($between)* $($last)* } }
        numbers! { $(#[doc = $mv_doc])* $mv_name { $($mtf_view)* } }
        numbers! { $(#[doc = $ms_doc])* $ms_name { $($mtf_state)* } }
        numbers! { $(#[doc = $crosstalk_doc])* $crosstalk_name { $($crosstalk)* } }
        numbers! { $(#[doc = $sparkle_doc])* $sparkle_name { $($sparkle)* } }
        numbers! { $(#[doc = $image_doc])* $image_name { $($image)* } }
        numbers! { $(#[doc = $gloss_doc])* $gloss_name { $($gloss)* } }
        names! {
            view { $($view)* } values { $($value)* } state { $($state)* $($last)* }
            mtf_view { $($mtf_view)* } mtf_state { $($mtf_state)* }
            crosstalk { $($crosstalk)* } sparkle { $($sparkle)* } image { $($image)* }
            gloss { $($gloss)* }
        }
    };
}
