//! The notation of scenes: RON, in which formulas may replace numbers.

use crate::language::number;
pub(super) use crate::language::options;
use serde::de::Visitor;
use serde::{Deserialize, Deserializer, Serialize};

/// Serializes a value as RON.
pub(super) fn written<T: Serialize>(value: &T) -> String {
    // Settings are plain enums, numbers and lists, so serialization cannot fail.
    options().to_string(value).unwrap_or_default()
}

/// Deserializes a list of names with numbers; a number may be given as a formula.
pub(super) fn values<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Vec<(String, f64)>, D::Error> {
    let read: Vec<(String, Value)> = Deserialize::deserialize(deserializer)?;
    Ok(read.into_iter().map(|(name, Value(value))| (name, value)).collect())
}

/// Deserializes a number, which may be given as a formula.
pub(super) fn value<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    let read: Option<Value> = Deserialize::deserialize(deserializer)?;
    Ok(read.map(|Value(value)| value))
}

/// A number, or a formula that contains only numbers.
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
