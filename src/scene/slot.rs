//! Settings by name: places in a structure that can be written and read as text.

use super::error::SceneError;
use crate::language::number;
use ron::Error as RonError;
use ron::extensions::Extensions;
use serde::de::Visitor;
use serde::{Deserialize, Deserializer, Serialize};

/// A place for one setting.
pub(super) trait Slot {
    /// Its value as RON writes it.
    fn written(&self) -> String;

    /// Reads a value into it.
    fn assign(&mut self, name: &str, value: &str) -> Result<(), SceneError>;
}

/// Settings by name.
pub(super) type Slots<'a> = Vec<(&'static str, Box<dyn Slot + 'a>)>;

/// The slots of all fields of a structure but some, by the names of the fields.
macro_rules! slots {
    ($settings:expr => $name:ident { $($field:ident: $slot:ident),* $(,)? } $(without $($skipped:ident),*)?) => {{
        let $name { $($field,)* $($($skipped: _,)*)? } = $settings;
        let slots: $crate::scene::slot::Slots =
            vec![$((stringify!($field), Box::new($crate::scene::slot::$slot($field)))),*];
        slots
    }};
}
pub(super) use slots;

/// Reads a value into the setting of a name; false if there is none of this name.
pub(super) fn assign(slots: Slots, name: &str, value: &str) -> Result<bool, SceneError> {
    match slots.into_iter().find(|(known, _)| *known == name) {
        Some((_, mut slot)) => slot.assign(name, value).map(|()| true),
        None => Ok(false),
    }
}

/// A setting that RON writes and reads.
pub(super) struct Plain<'a, T>(pub &'a mut T);

/// A setting that the problem chooses by itself unless it is given: `usual`.
pub(super) struct Usual<'a, T>(pub &'a mut Option<T>);

/// Letters without quotes, in either case: kept as capitals.
pub(super) struct Capitals<'a>(pub &'a mut String);

/// Words without quotes.
pub(super) struct Words<'a>(pub &'a mut String);

impl<T: Serialize + for<'d> Deserialize<'d>> Slot for Plain<'_, T> {
    fn written(&self) -> String {
        written(&self.0)
    }

    fn assign(&mut self, name: &str, value: &str) -> Result<(), SceneError> {
        *self.0 = read(name, value, &self.written())?;
        Ok(())
    }
}

impl<T: Serialize + for<'d> Deserialize<'d>> Slot for Usual<'_, T> {
    fn written(&self) -> String {
        self.0.as_ref().map_or("usual".into(), written)
    }

    fn assign(&mut self, name: &str, value: &str) -> Result<(), SceneError> {
        *self.0 = match value {
            "usual" => None,
            _ => Some(read(name, value, &self.written())?),
        };
        Ok(())
    }
}

impl Slot for Words<'_> {
    fn written(&self) -> String {
        self.0.clone()
    }

    fn assign(&mut self, _name: &str, value: &str) -> Result<(), SceneError> {
        *self.0 = value.into();
        Ok(())
    }
}

impl Slot for Capitals<'_> {
    fn written(&self) -> String {
        self.0.clone()
    }

    fn assign(&mut self, _name: &str, value: &str) -> Result<(), SceneError> {
        *self.0 = value.to_uppercase();
        Ok(())
    }
}

/// How scenes are written.
pub(super) fn options() -> ron::Options {
    ron::Options::default()
        .with_default_extension(Extensions::IMPLICIT_SOME)
        .with_default_extension(Extensions::UNWRAP_VARIANT_NEWTYPES)
}

/// Reads a value as RON would; errors show another one of its form.
pub(super) fn read<T: for<'a> Deserialize<'a>>(
    name: &str,
    value: &str,
    example: &str,
) -> Result<T, SceneError> {
    let refused = |_| {
        let form = form::<T>().unwrap_or_else(|| format!("of the form of `{example}`"));
        SceneError::value(name, value, format!("it must be {form}"))
    };
    options().from_str(value).map_err(refused)
}

/// The form of values of a type: the reader says which names it knows, and values of other forms
/// are tried.
fn form<T: for<'a> Deserialize<'a>>() -> Option<String> {
    let reads = |text: &str| options().from_str::<T>(text);
    if let Err(RonError::NoSuchEnumVariant { expected, .. }) =
        reads("unknown").map_err(|error| error.code)
    {
        return Some(format!("one of {}", expected.join(", ")));
    }
    let forms = [
        ("true", "true or false"),
        ("-0.5", "a number"),
        ("0.5", "a number that is not negative"),
        ("-1", "a whole number"),
        ("1", "a whole number that is not negative"),
        ("[]", "a list in brackets"),
        ("\"\"", "a text in quotes"),
    ];
    let of_form = forms.into_iter().find(|(value, _)| reads(value).is_ok());
    of_form.map(|(_, form)| form.into()).or_else(structure::<T>)
}

/// A structure with all of its fields: the reader says which are missing.
fn structure<T: for<'a> Deserialize<'a>>() -> Option<String> {
    let mut fields: Vec<String> = Vec::new();
    loop {
        let text = format!("({})", fields.join(", "));
        let missing = match options().from_str::<T>(&text).map_err(|error| error.code) {
            Ok(_) if fields.is_empty() => return None,
            Ok(_) => return Some(format!("of the form of `{text}`")),
            Err(RonError::MissingStructField { field, .. }) => field,
            Err(_) => return None,
        };
        let fits = |value: &&str| {
            let field = fields.iter().cloned().chain([format!("{missing}: {value}")]);
            let text = format!("({})", field.collect::<Vec<_>>().join(", "));
            let read = options().from_str::<T>(&text).map_err(|error| error.code);
            read.is_ok()
                || matches!(read, Err(RonError::MissingStructField { field, .. }) if field != missing)
        };
        let value = ["1", "(1, 1)", "true", "[]", "\"\""].into_iter().find(fits)?;
        fields.push(format!("{missing}: {value}"));
    }
}

pub(super) fn written<T: Serialize>(value: &T) -> String {
    // Settings are plain enums, numbers and lists: they can always be written.
    ron::to_string(value).unwrap_or_default()
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
