//! Output of results: documents in RON, tables of special points, diagrams in SVG, PDF, PNG and
//! HTML.
//!
//! This module is independent of the problem: it uses only
//! [`Branch`](crate::core::continuation::Branch)es.
//!
//! ```
//! use tangency::output::{Document, PAGE, diagram, draw};
//! let document = Document::new("Pull-in of a plate", vec![tangency::output::example_branch()]);
//! let text = document.to_ron()?;
//! assert_eq!(Document::parse(&text)?, document);
//! let svg = draw(&[diagram(&[("pull-in", &document)], None, &["deflection"])?], PAGE)?;
//! assert!(svg.starts_with("<svg") && svg.contains("fold"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod axis;
mod bars;
mod check;
mod chosen;
mod comparison;
mod cubic;
mod diagram;
mod document;
mod document_file;
mod drawing;
mod error;
mod example;
mod fields;
mod figure;
mod files;
mod format;
mod histories;
mod names;
mod npy;
mod npz;
mod number;
mod page;
mod panels;
mod point_table;
mod profiles;
mod regions;
mod save;
mod summary;
mod sweeps;
mod symbols;
mod table;
mod tag;
mod tile;
mod units;
mod words;

pub(crate) use bars::Bar;
pub use chosen::Chosen;
pub use comparison::{Difference, compare, compare_within};
pub use diagram::diagram;
#[cfg(feature = "live")]
pub(crate) use diagram::usual_axes;
pub use document::{Against, Deviation, Document, Enlargement, Plot};
#[cfg(feature = "live")]
pub(crate) use drawing::hexadecimal;
pub use drawing::{COLUMN, PAGE, draw, pdf, png};
pub use error::{FigureError, FileError, FormatError, UnknownPoint};
pub use example::example_branch;
pub use figure::{Beside, Figure, Mark, Origin, Series, Style, Symbol, Wall};
pub(crate) use files::read;
#[cfg(feature = "cli")]
pub(crate) use files::{Lock, kind, target, text_of};
pub use files::{SizeLimit, write_atomically, write_together};
pub use format::Format;
pub use histories::histories;
#[cfg(feature = "cli")]
pub(crate) use names::{sort_by_number, tell_apart};
pub use number::significant;
pub use page::PLOTLY;
#[cfg(feature = "live")]
pub(crate) use page::Panel;
pub use panels::figures;
#[cfg(feature = "live")]
pub(crate) use panels::specks;
pub(crate) use panels::{check_columns, drop_missing_points, restrict_plot, restrict_to_finished};
pub use point_table::{Columns, PointTable, Selection, csv};
pub use save::{Render, RenderError, Results, SaveError, save};
pub use summary::Summary;
pub use sweeps::{MergeError, Row, SWEEPS, SweepTable, Sweeps, TableDifference, merge};
pub use table::{Screen, separated, table};
#[cfg(feature = "cli")]
pub use tag::FORMAT;
pub use tile::{Hue, Tile, spacing};
pub use words::Invalid;
#[cfg(feature = "cli")]
pub(crate) use words::printable;
pub(crate) use words::{entry, text};
