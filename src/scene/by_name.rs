//! Access to settings by name: the fields of a settings structure, with their values in RON
//! notation.
//!
//! A setting whose value has settings of its own, such as `method: collocation(intervals: 20,
//! degree: 4)`, counts as the setting `method` with the value `collocation`, and as the additional
//! settings `intervals` and `degree`.

use super::error::SceneError;
use super::notation::{options, written};
use crate::language::Parts;
use crate::misread::{reason, remedy};
use ron::Error as RonError;
use ron::value::RawValue;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// A field of a settings structure: its name and its value.
struct Field {
    name: String,
    /// The value of the field in RON notation; if the value has settings of its own, as in
    /// `collocation(intervals: 20)`, only the name of the value, `collocation`.
    value: String,
    /// The settings that belong to the value of the field, such as `intervals` in
    /// `collocation(intervals: 20)`; `None` for a value that cannot have settings.
    own: Option<Vec<(String, String)>>,
}

impl Field {
    fn written(&self) -> String {
        match &self.own {
            Some(own) => format!("{}:{}{}", self.name, self.value, joined(own)),
            None => format!("{}:{}", self.name, self.value),
        }
    }

    /// Replaces the value of the field, or a setting that belongs to this value; returns false if
    /// the name is unknown.
    fn replace(&mut self, name: &str, value: &str) -> Result<bool, RonError> {
        if self.name == name {
            let chosen = self.own.as_ref().is_some_and(|_| self.value == value);
            if !chosen {
                self.own = self.own.take().filter(|_| is_word(value)).map(|_| Vec::new());
                self.value = in_quotes(&self.value, value)?;
            }
            return Ok(true);
        }
        match self.own.iter_mut().flatten().find(|(own, _)| own == name) {
            Some((_, old)) => *old = in_quotes(old, value)?,
            None => return Ok(false),
        }
        Ok(true)
    }
}

/// Returns all fields of a settings structure, with their values.
fn fields(settings: &impl Serialize) -> Vec<Field> {
    let choice = |value: &str| {
        let (word, _) = value.split_once('(').filter(|(word, _)| is_word(word))?;
        Some((word.to_string(), parts(&value[word.len()..])))
    };
    let field = |(name, value): (String, String)| match choice(&value) {
        Some((word, own)) => Field { name, value: word, own: Some(own) },
        None => Field { name, value, own: None },
    };
    parts(&written(settings)).into_iter().map(field).collect()
}

fn is_word(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_alphabetic())
        && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// Returns the values between the brackets of a RON text, each with its name.
fn parts(text: &str) -> Vec<(String, String)> {
    // The text was serialized from a structure, so it can always be parsed.
    let Parts(parts) = options().from_str(text).unwrap_or_default();
    parts.into_iter().map(|(name, value)| (name, value.trim().get_ron().into())).collect()
}

fn joined(parts: &[(String, String)]) -> String {
    let parts: Vec<String> = parts.iter().map(|(name, value)| format!("{name}:{value}")).collect();
    format!("({})", parts.join(","))
}

/// Converts a new value into the notation of the value that it replaces: a text needs no quotes,
/// and `usual` means `None`. Returns an error for an incomplete value, and for a value that would
/// add further fields.
fn in_quotes(old: &str, value: &str) -> Result<String, RonError> {
    let value = match value {
        "usual" => "None".into(),
        _ if old.starts_with('"') && !value.starts_with('"') => written(&value),
        _ => value.into(),
    };
    options().from_str::<Box<RawValue>>(&value).map_err(|error| error.code)?;
    Ok(value)
}

/// Formats a value for display: a text is shown without quotes, and `None` is shown as `usual`,
/// which means that the problem chooses a default.
fn shown(value: String) -> String {
    match options().from_str::<String>(&value) {
        Ok(text) => text,
        Err(_) if value == "None" => "usual".into(),
        Err(_) => value,
    }
}

/// Returns all settings of a settings structure by name, with their values.
pub(super) fn settings(settings: &impl Serialize) -> Vec<(String, String)> {
    let field = |Field { name, value, own }| {
        std::iter::once((name, value)).chain(own.into_iter().flatten())
    };
    let all = fields(settings).into_iter().flat_map(field);
    all.map(|(name, value)| (name, shown(value))).collect()
}

/// Returns the name of the setting whose value has settings of its own, such as `method`, and the
/// name of this value, such as `collocation`.
pub(super) fn choice(settings: &impl Serialize) -> Option<(String, String)> {
    let choice = fields(settings).into_iter().find(|field| field.own.is_some())?;
    Some((choice.name, choice.value))
}

/// Parses a value and assigns it to the named setting; returns false if the name is unknown.
pub(super) fn assign<S: Serialize + DeserializeOwned>(
    settings: &mut S,
    name: &str,
    value: &str,
) -> Result<bool, SceneError> {
    let mut fields = fields(settings);
    let refused = |code: RonError| {
        let (reason, help) = match code {
            // A complete value that was not read to its end is a number with decimals.
            RonError::ExpectedStructLikeEnd | RonError::ExpectedComma => {
                ("expected a whole number".into(), None)
            }
            code => (reason(&code), remedy(&code)),
        };
        let refused = SceneError::value(name, value, reason);
        match help {
            Some(help) => refused.with_help(help),
            None => refused,
        }
    };
    if !replace(&mut fields, name, value).map_err(refused)? {
        return Ok(false);
    }
    *settings = read(&fields).map_err(|code| {
        let no_name = matches!(
            code,
            RonError::ExpectedIdentifier
                | RonError::InvalidIdentifier(_)
                | RonError::SuggestRawIdentifier(_)
        );
        // The error for an invalid name lists the valid names.
        let tried = no_name && replace(&mut fields, name, "none").is_ok();
        match read::<S>(&fields) {
            Err(RonError::NoSuchEnumVariant { expected, outer, .. }) if tried => {
                refused(RonError::NoSuchEnumVariant { expected, found: value.into(), outer })
            }
            _ => refused(code),
        }
    })?;
    Ok(true)
}

/// Replaces the value of the field with a given name; returns false if no field has this name.
fn replace(fields: &mut [Field], name: &str, value: &str) -> Result<bool, RonError> {
    for field in fields {
        if field.replace(name, value)? {
            return Ok(true);
        }
    }
    Ok(false)
}

/// Builds a settings structure from its fields.
fn read<S: DeserializeOwned>(fields: &[Field]) -> Result<S, RonError> {
    let fields: Vec<String> = fields.iter().map(Field::written).collect();
    options().from_str(&format!("({})", fields.join(","))).map_err(|error| error.code)
}
