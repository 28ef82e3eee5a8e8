//! `tangency table FILE…`: lists the special points of many documents in one table.

use super::cells::Cells;
use super::error::CommandError;
use super::request::kind;
use super::results::Results;
use crate::core::system::Kind;
use crate::output::{
    Columns, Document, FileError, Format, PointTable, Selection, SizeLimit, write_atomically,
};
use clap::Args;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The examples shown in the help of `table`.
const EXAMPLES: &str = "Examples:
  tangency table out/lorenz.ron
  tangency table out/lorenz.ron --csv > special.csv
  tangency table out/plate-device.ron --kind LP --sensitivity
  tangency table out/plate-device/*.ron --kind LP --columns gap,voltage,error --out pull-in.csv";

/// List the special points of one or several documents in one table
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Table {
    /// The documents (.ron)
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// The kinds of special points to list [default: all kinds]
    #[arg(long, value_name = "KIND,…", value_delimiter = ',', value_parser = kind)]
    kind: Vec<Kind>,
    /// The columns to list: settings, parameters and monitors by their names, and the columns named
    /// file, branch, label, kind, error, unstable, converged, multiplicity and itinerary (of hybrid
    /// orbits) [default: the parameters that vary, and the settings in which the documents differ]
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    columns: Vec<String>,
    /// Add the derivatives of each special point's location with respect to all other parameters,
    /// such as dvoltage/dgap; if --columns names some of these derivatives, only the named
    /// derivatives are added
    #[arg(long)]
    sensitivity: bool,
    /// Print the table as comma-separated values, with all columns unless --columns is given
    #[arg(long, conflicts_with = "out")]
    csv: bool,
    #[command(flatten)]
    cells: Cells,
    /// Write the table to this file as comma-separated values, instead of printing the table
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

impl Table {
    /// Writes the table.
    pub fn run(&self, limit: SizeLimit, out: &mut impl Write) -> Result<(), CommandError> {
        let inputs: Vec<&Path> = self.files.iter().map(PathBuf::as_path).collect();
        if let Some(path) =
            self.out.as_ref().filter(|path| Format::of(path).ok() != Some(Format::Csv))
        {
            return Err(FileError::Ending { path: path.clone(), known: &[".csv"] }.into());
        }
        let claimed = self.out.as_ref().map(|path| Results::claim_file(path, &inputs));
        let _claimed = claimed.transpose()?;
        let documents = self.files.iter().map(|file| Document::load_within(limit, file));
        let documents = documents.collect::<Result<Vec<Document>, _>>()?;
        let names: Vec<String> = self.files.iter().map(|file| file.display().to_string()).collect();
        let named: Vec<(&str, &Document)> =
            names.iter().map(String::as_str).zip(&documents).collect();
        let columns: Vec<&str> = self.columns.iter().map(String::as_str).collect();
        let csv = self.csv || self.out.is_some();
        let columns = match (columns.is_empty(), csv) {
            (false, _) => Columns::Named(&columns),
            (true, true) => Columns::All,
            (true, false) => Columns::Usual,
        };
        let selection = Selection { kinds: &self.kind, columns, sensitivities: self.sensitivity };
        let table = PointTable::of(&named, selection).map_err(CommandError::NoColumn)?;
        let text = match csv {
            true => self.cells.rewrite(&table.csv())?,
            false => {
                self.cells.refuse()?;
                table.screen()
            }
        };
        let Some(path) = &self.out else { return Ok(out.write_all(text.as_bytes())?) };
        write_atomically(path, text)?;
        Ok(writeln!(out, "{}", path.display())?)
    }
}
