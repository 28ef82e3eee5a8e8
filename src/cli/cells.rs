//! The options for the cells of comma-separated values.

use super::error::CommandError;
use crate::output::separated;
use clap::{Args, ValueEnum};

/// The options for the cells of comma-separated values.
#[derive(Clone, Copy, Debug, Args)]
pub struct Cells {
    /// The separator between columns in comma-separated values (.csv), such as ; or tab [default: a
    /// comma, or a semicolon with --decimal comma]
    #[arg(long, value_name = "LETTER", value_parser = separator)]
    separator: Option<char>,
    /// The decimal separator of numbers in comma-separated values (.csv): point, or comma for
    /// spreadsheet programs in languages that write 0,5 [default: point]
    #[arg(long, value_name = "SIGN", hide_possible_values = true)]
    decimal: Option<Decimal>,
}

/// The decimal separator of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Decimal {
    Point,
    Comma,
}

impl Cells {
    /// Returns an error if an option is given for an output that is not comma-separated.
    pub fn refuse(&self) -> Result<(), CommandError> {
        match (self.separator, self.decimal) {
            (None, None) => Ok(()),
            _ => Err(CommandError::NoSeparator),
        }
    }

    /// Rewrites comma-separated values with the chosen separators.
    ///
    /// # Errors
    /// [`CommandError::OneSeparator`] if the comma would have both meanings.
    pub fn rewrite(&self, csv: &str) -> Result<String, CommandError> {
        let (usual, decimal) = match self.decimal {
            Some(Decimal::Comma) => (';', ','),
            Some(Decimal::Point) | None => (',', '.'),
        };
        let separator = self.separator.unwrap_or(usual);
        if separator == decimal {
            return Err(CommandError::OneSeparator);
        }
        Ok(separated(csv, separator, decimal))
    }
}

/// Parses a separator of cells: a character that does not occur in numbers.
fn separator(text: &str) -> Result<char, String> {
    let mut letters = text.chars();
    match (text, letters.next(), letters.next()) {
        ("tab", _, _) => Ok('\t'),
        (_, Some(letter @ (',' | ';' | '|' | ':' | ' ' | '\t')), None) => Ok(letter),
        _ => {
            Err("the separator must be a comma, a semicolon, a vertical bar, a colon, a space, or \
                  the word tab"
                .into())
        }
    }
}
