//! What leaves the toolkit: documents in RON, tables of special points, diagrams in SVG.
//!
//! Nothing here knows a problem: everything is made from [`Branch`](crate::core::continuation::Branch)es.
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
mod diagram;
mod document;
mod document_file;
mod error;
mod example;
mod figure;
mod format;
mod number;
mod panels;
mod profiles;
mod report;
mod robustness;
mod svg;
mod sweeps;
mod table;
mod tile;
mod work_precision;
mod write;

pub use chosen::Chosen;
pub use diagram::diagram;
pub use document::{Against, Deviation, Document, Enlargement, Plot};
pub use error::{FigureError, FileError, FormatError, Invalid, UnknownPoint};
pub use example::example_branch;
pub use figure::{Figure, Mark, Series, Style, Symbol};
pub use format::FORMAT;
pub use number::significant;
pub(crate) use panels::check_columns;
pub use panels::figures;
#[cfg(feature = "cli")]
pub(crate) use report::entries;
pub use report::{Entry, Report, ReportError};
pub use robustness::{Cell, Class, Outcome, ROBUSTNESS, Region, RobustnessMap, Tried};
pub use svg::draw;
pub use sweeps::{MergeError, Row, SWEEPS, SweepTable, Sweeps, TableDifference, merge};
pub use table::{Screen, csv};
pub use tile::{Hue, Tile};
pub use work_precision::{
    Circumstances, Clock, Drawn, Line, Measured, Measurement, WORK_PRECISION, WorkPrecision,
};
pub use write::write_atomically;
