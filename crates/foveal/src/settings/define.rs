//! The definition of settings: a macro that makes the struct, its defaults and a table of
//! descriptions from one list. The program's flags, the window's panels and the page's controls are
//! made from the table; the keys of a TOML file are the struct's fields. A setting that is added to
//! the list is in all of them.

#[cfg(feature = "serde")]
use serde::Deserialize;
#[cfg(feature = "serde")]
use serde::de::value::Error;
#[cfg(feature = "serde")]
use serde::de::{Deserializer, Error as _, Visitor};
#[cfg(feature = "serde")]
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
    /// The path of a file, as the help text says.
    File,
    /// Words or numbers, as the help text says.
    Text,
}

#[cfg(feature = "serde")]
impl Kind {
    /// A choice between the unit variants of `T`.
    pub(super) const fn choice<T: for<'de> Deserialize<'de>>() -> Self {
        Self::Choice(variant_names::<T>)
    }
}

#[cfg(feature = "serde")]
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

/// Makes [`Settings`](crate::Settings), a struct per stage, their defaults and the table of
/// [`Setting`]s. Each stage has a help text, a heading and its place in `Settings`. Each setting
/// has a help text (rustdoc, `--help`, the window's tooltip), `key => field: type = default`, a
/// label and a kind. In a settings file all keys lie side by side.
macro_rules! settings {
    (
        $(
            $(#[doc = $about:literal])+
            $stage:literal $place:ident: $group:ident {
                $( $(#[doc = $help:literal])+ $key:ident => $field:ident: $type:ty = $default:expr, $label:literal, $kind:expr; )+
            }
        )+
    ) => {
        /// All settings of a frame. In a file, and as flags, all keys lie side by side:
        /// `coarse.source` is `rate`, `stereo.ipd_m` is `ipd`; [`Settings::ALL`] lists them.
        #[derive(Clone, Debug, Default, PartialEq)]
        #[cfg_attr(
            feature = "serde",
            derive(Serialize, Deserialize),
            serde(from = "Keys", into = "Keys")
        )]
        #[non_exhaustive]
        pub struct Settings {
            $( $(#[doc = $about])+ pub $place: $group, )+
        }

        $(
            $(#[doc = $about])+
            #[derive(Clone, Debug, PartialEq)]
            #[non_exhaustive]
            pub struct $group {
                $( $(#[doc = $help])+ pub $field: $type, )+
            }

            impl Default for $group {
                fn default() -> Self {
                    Self { $( $field: $default, )+ }
                }
            }
        )+

        /// A settings file.
        #[cfg(feature = "serde")]
        #[derive(Serialize, Deserialize)]
        #[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
        struct Keys {
            $( $( $key: $type, )+ )+
        }

        #[cfg(feature = "serde")]
        impl Default for Keys {
            fn default() -> Self {
                Settings::default().into()
            }
        }

        #[cfg(feature = "serde")]
        impl From<Keys> for Settings {
            fn from(keys: Keys) -> Self {
                Self { $( $place: $group { $( $field: keys.$key, )+ }, )+ }
            }
        }

        #[cfg(feature = "serde")]
        impl From<Settings> for Keys {
            fn from(settings: Settings) -> Self {
                Self { $( $( $key: settings.$place.$field, )+ )+ }
            }
        }

        #[cfg(feature = "serde")]
        impl Settings {
            /// Descriptions of all settings, stage by stage in the order of the frame.
            pub const ALL: &'static [$crate::settings::Setting] = &[
                $( $( $crate::settings::Setting {
                    key: {
                        const KEY: [u8; stringify!($key).len()] =
                            $crate::settings::define::kebab(stringify!($key));
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

#[cfg(feature = "serde")]
/// Lets serde have a type as the text that [`FromStr`](std::str::FromStr) reads and
/// [`Display`](std::fmt::Display) writes.
macro_rules! as_text {
    ($type:ty) => {
        impl serde::Serialize for $type {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.collect_str(self)
            }
        }

        impl<'de> serde::Deserialize<'de> for $type {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let text = <std::borrow::Cow<'_, str>>::deserialize(deserializer)?;
                text.parse().map_err(serde::de::Error::custom)
            }
        }
    };
}

#[cfg(feature = "serde")]
pub(super) use as_text;

#[cfg(feature = "serde")]
/// Names of the unit variants of `T` as serde spells them, in the order of declaration.
#[must_use]
pub fn variant_names<T: for<'de> Deserialize<'de>>() -> &'static [&'static str] {
    let mut found: &'static [&'static str] = &[];
    let _ = T::deserialize(Probe(&mut found));
    found
}

#[cfg(feature = "serde")]
/// A deserializer that yields no value and records the names of the variants that are expected.
struct Probe<'a>(&'a mut &'static [&'static str]);

#[cfg(feature = "serde")]
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

#[cfg(all(test, feature = "serde"))]
mod tests {
    use super::*;
    use crate::{DebugView, LightingModel, Settings};

    #[test]
    fn names_are_those_of_the_settings_file() {
        assert_eq!(variant_names::<LightingModel>(), ["ggx", "blinn-phong"]);
        assert!(variant_names::<DebugView>().contains(&"base-color"));
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
