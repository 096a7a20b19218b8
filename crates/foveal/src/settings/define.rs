//! The definition of settings: a macro that makes the struct, its defaults and a table of
//! descriptions from one list. The program's flags, the window's panels and the page's controls are
//! made from the table; the keys of a TOML file are the struct's fields. A setting that is added to
//! the list is in all of them.

use serde::Deserialize;
use serde::de::value::Error;
use serde::de::{Deserializer, Error as _, Visitor};
use serde::forward_to_deserialize_any;

/// Description of a setting, from which flags, panels and controls are made.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// Key in a settings file, and the flag without its dashes: `tone-map`.
    pub key: &'static str,
    /// Stage of the frame that the setting belongs to, as a heading.
    pub stage: &'static str,
    /// Name on a panel.
    pub label: &'static str,
    /// Help text: a few sentences without markup.
    pub help: &'static str,
    /// Values that the setting takes.
    pub kind: Kind,
}

/// Values that a setting takes.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// `true` or `false`.
    Switch,
    /// One of these names.
    Choice(fn() -> &'static [&'static str]),
    /// A whole number in this range.
    Integer {
        /// Smallest value.
        least: i64,
        /// Largest value.
        most: i64,
    },
    /// A number. The range is a slider's; [`Settings::validate`](crate::Settings::validate) may
    /// accept more.
    Number {
        /// Smallest value of a slider.
        least: f64,
        /// Largest value of a slider.
        most: f64,
    },
    /// A place in the picture: two fractions of its size from the top left corner.
    Place,
    /// The path of a PNG file.
    File,
    /// Words or numbers, as the help text says.
    Text,
}

impl Kind {
    /// A choice between the unit variants of `T`.
    pub(super) const fn choice<T: for<'de> Deserialize<'de>>() -> Self {
        Self::Choice(variant_names::<T>)
    }
}

/// A field's name as a settings file spells it: kebab case.
pub(super) const fn kebab<const N: usize>(name: &str) -> [u8; N] {
    let mut key = [0; N];
    let mut i = 0;
    while i < N {
        let byte = name.as_bytes()[i];
        key[i] = if byte == b'_' { b'-' } else { byte };
        i += 1;
    }
    key
}

/// Makes the struct, its [`Default`] and its table of [`Setting`]s. Each stage has a heading. Each
/// setting has a help text (rustdoc, `--help`, the window's tooltip), `field: type = default`, a
/// label and a kind.
macro_rules! settings {
    (
        $(#[$attribute:meta])*
        pub struct $name:ident {
            $( $stage:literal {
                $( $(#[doc = $help:literal])+ $field:ident: $type:ty = $default:expr, $label:literal, $kind:expr; )+
            } )+
        }
    ) => {
        $(#[$attribute])*
        pub struct $name {
            $( $( $(#[doc = $help])+ pub $field: $type, )+ )+
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $( $( $field: $default, )+ )+ }
            }
        }

        impl $name {
            /// Descriptions of all settings, stage by stage in the order of the frame.
            pub const ALL: &'static [$crate::settings::Setting] = &[
                $( $( $crate::settings::Setting {
                    key: {
                        const KEY: [u8; stringify!($field).len()] =
                            $crate::settings::define::kebab(stringify!($field));
                        match std::str::from_utf8(&KEY) {
                            Ok(key) => key,
                            Err(_) => "",
                        }
                    },
                    stage: $stage,
                    label: $label,
                    help: concat!($($help),+).trim_ascii(),
                    kind: $kind,
                }, )+ )+
            ];
        }
    };
}
pub(super) use settings;

/// Names of the unit variants of `T` as serde spells them, in the order of declaration.
#[must_use]
pub fn variant_names<T: for<'de> Deserialize<'de>>() -> &'static [&'static str] {
    let mut found: &'static [&'static str] = &[];
    let _ = T::deserialize(Probe(&mut found));
    found
}

/// A deserializer that yields no value and records the names of the variants that are expected.
struct Probe<'a>(&'a mut &'static [&'static str]);

impl<'de> Deserializer<'de> for Probe<'_> {
    type Error = Error;

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Error> {
        Err(Error::custom("nothing here"))
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        variants: &'static [&'static str],
        _: V,
    ) -> Result<V::Value, Error> {
        *self.0 = variants;
        Err(Error::custom("nothing here"))
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 u8 u16 u32 u64 f32 f64 char str string bytes byte_buf option unit unit_struct
        newtype_struct seq tuple tuple_struct map struct identifier ignored_any
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LightingModel, Settings, View};

    #[test]
    fn names_are_those_of_the_settings_file() {
        assert_eq!(variant_names::<LightingModel>(), ["ggx", "blinn-phong"]);
        assert!(variant_names::<View>().contains(&"base-color"));
        assert!(variant_names::<u32>().is_empty());
    }

    #[test]
    fn every_setting_is_described() {
        for setting in Settings::ALL {
            let key = setting.key;
            assert!(!key.is_empty() && !key.contains('_'), "{key}");
            for text in [setting.stage, setting.label] {
                assert!((1..30).contains(&text.len()), "{key}: {text}");
            }
            assert!(setting.help.len() > 10, "{key}: {}", setting.help);
            assert!(
                !setting.help.contains(['[', '`']) && !setting.help.contains("  "),
                "{key}: not plain text: {}",
                setting.help
            );
            match setting.kind {
                Kind::Choice(names) => assert!(names().len() > 1, "{key}"),
                Kind::Integer { least, most } => assert!(least < most, "{key}"),
                Kind::Number { least, most } => assert!(least < most, "{key}"),
                Kind::Switch | Kind::Place | Kind::File | Kind::Text => {}
            }
        }
    }
}
