//! Choices on the command line, taken from the enums of the library as serde spells them, so that
//! flags and settings file can never disagree about a name.

use std::marker::PhantomData;

use clap::builder::{PossibleValue, TypedValueParser};
use clap::error::{ContextKind, ContextValue, ErrorKind};
use foveal::variant_names;
use serde::Deserialize;
use serde::de::IntoDeserializer;
use serde::de::value::{Error as DeError, StrDeserializer};

/// Parses one of the names of `T`; help and errors list them.
pub struct VariantParser<T>(PhantomData<fn() -> T>);

impl<T> VariantParser<T> {
    /// The parser of `T`.
    pub fn new() -> Self {
        Self(PhantomData)
    }
}

impl<T> Default for VariantParser<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T> Clone for VariantParser<T> {
    fn clone(&self) -> Self {
        Self::new()
    }
}

impl<T> TypedValueParser for VariantParser<T>
where
    T: for<'de> Deserialize<'de> + Clone + Send + Sync + 'static,
{
    type Value = T;

    fn parse_ref(
        &self,
        command: &clap::Command,
        arg: Option<&clap::Arg>,
        value: &std::ffi::OsStr,
    ) -> Result<T, clap::Error> {
        let text = value.to_string_lossy();
        let deserializer: StrDeserializer<'_, DeError> = text.as_ref().into_deserializer();
        T::deserialize(deserializer).map_err(|_| {
            let mut error = clap::Error::new(ErrorKind::InvalidValue).with_cmd(command);
            if let Some(arg) = arg {
                error.insert(
                    ContextKind::InvalidArg,
                    ContextValue::String(arg.to_string()),
                );
            }
            error.insert(
                ContextKind::InvalidValue,
                ContextValue::String(text.to_string()),
            );
            let valid = variant_names::<T>().iter().map(|&n| n.to_owned()).collect();
            error.insert(ContextKind::ValidValue, ContextValue::Strings(valid));
            error
        })
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(
            variant_names::<T>()
                .iter()
                .map(|&name| PossibleValue::new(name)),
        ))
    }
}
