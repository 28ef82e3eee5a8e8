//! How scenes are written: RON, with formulas of numbers in place of numbers.

use crate::problems::text::number;
use ron::extensions::Extensions;
use ron::value::RawValue;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

/// How scenes are written.
pub(super) fn options() -> ron::Options {
    ron::Options::default()
        .with_default_extension(Extensions::IMPLICIT_SOME)
        .with_default_extension(Extensions::UNWRAP_VARIANT_NEWTYPES)
}

/// A value, as RON writes it.
pub(super) fn written<T: Serialize>(value: &T) -> String {
    // Settings are plain enums, numbers and lists: they can always be written.
    options().to_string(value).unwrap_or_default()
}

/// Names with numbers, or with formulas of numbers.
pub(super) fn values<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Vec<(String, f64)>, D::Error> {
    let read: Vec<(String, Value)> = Deserialize::deserialize(deserializer)?;
    Ok(read.into_iter().map(|(name, Value(value))| (name, value)).collect())
}

/// A number, or a formula of numbers.
pub(super) fn value<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    let read: Option<Value> = Deserialize::deserialize(deserializer)?;
    Ok(read.map(|Value(value)| value))
}

/// A number, or a formula of numbers.
struct Value(f64);

impl<'de> Deserialize<'de> for Value {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;
        impl Visitor<'_> for Reader {
            type Value = Value;

            fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
                f.write_str("a number, or a formula of numbers in quotes")
            }

            fn visit_f64<E>(self, number: f64) -> Result<Value, E> {
                Ok(Value(number))
            }

            fn visit_i64<E>(self, number: i64) -> Result<Value, E> {
                Ok(Value(number as f64))
            }

            fn visit_u64<E>(self, number: u64) -> Result<Value, E> {
                Ok(Value(number as f64))
            }

            fn visit_str<E: serde::de::Error>(self, formula: &str) -> Result<Value, E> {
                number(formula).map(Value).map_err(E::custom)
            }
        }
        deserializer.deserialize_any(Reader)
    }
}

/// Names with what stands behind them, not yet read.
#[derive(Default)]
pub(super) struct Parts<'a>(pub Vec<(String, &'a RawValue)>);

impl<'de> Deserialize<'de> for Parts<'de> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;
        impl<'de> Visitor<'de> for Reader {
            type Value = Parts<'de>;

            fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
                f.write_str("names with values in brackets, as in `(states: [(\"x\", \"-x\")])`")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut parts = Vec::new();
                while let Some(part) = map.next_entry()? {
                    parts.push(part);
                }
                Ok(Parts(parts))
            }

            fn visit_unit<E>(self) -> Result<Self::Value, E> {
                Ok(Parts(Vec::new()))
            }
        }
        deserializer.deserialize_any(Reader)
    }
}
