//! What leaves the toolkit: documents in RON, tables of special points, diagrams in SVG.
//!
//! Nothing here knows a problem: everything is made from
//! [`Branch`](crate::core::continuation::Branch)es.
//!
//! ```
//! use tangency::output::{Document, diagram, draw};
//! let document = Document::new("Pull-in of a plate", vec![tangency::output::example_branch()]);
//! let text = document.to_ron()?;
//! assert_eq!(Document::parse(&text)?, document);
//! let svg = draw(&[diagram(&[("pull-in", &document)], None, Some("deflection"))?])?;
//! assert!(svg.starts_with("<svg") && svg.contains("fold"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod axis;
mod check;
mod chosen;
mod comparison;
mod diagram;
mod document;
mod document_file;
mod error;
mod example;
mod figure;
mod files;
mod format;
mod number;
mod panels;
#[cfg(feature = "png")]
mod png;
mod profiles;
mod report;
mod robustness;
mod svg;
mod sweeps;
mod table;
mod tag;
mod tile;
mod words;
mod work_precision;

pub use chosen::Chosen;
pub use comparison::{Difference, compare};
pub use diagram::diagram;
pub use document::{Against, Deviation, Document, Enlargement, Plot};
pub use error::{FigureError, FileError, FormatError, UnknownPoint};
pub use example::example_branch;
pub use figure::{Figure, Mark, Series, Style, Symbol};
pub(crate) use files::read;
#[cfg(feature = "cli")]
pub(crate) use files::{Lock, kind, read_text, target, text_of};
pub use files::{SizeLimit, write_atomically, write_together};
pub use format::Format;
pub use number::significant;
pub(crate) use panels::check_columns;
pub use panels::figures;
#[cfg(feature = "png")]
pub use png::png;
#[cfg(feature = "cli")]
pub(crate) use report::entries;
pub use report::{Entry, Report, ReportError};
pub use robustness::{Cell, Class, Outcome, ROBUSTNESS, Region, RobustnessMap, Tried};
pub use svg::draw;
pub use sweeps::{MergeError, Row, SWEEPS, SweepTable, Sweeps, TableDifference, merge};
pub use table::{Screen, csv, histories, table};
#[cfg(feature = "cli")]
pub use tag::FORMAT;
pub use tile::{Hue, Tile};
pub use words::Invalid;
pub(crate) use words::{entry, printable, text};
pub use work_precision::{
    Circumstances, Clock, Drawn, Line, Measured, Measurement, WORK_PRECISION, WorkPrecision,
};
