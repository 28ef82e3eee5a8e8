//! `tangency trace SCENE --grid …`: traces a scene over a grid of settings, one document per
//! design.

use super::error::CommandError;
use super::request::range;
use super::results::Results;
use super::signals;
use super::warning::warn;
use super::watch::bar;
use crate::core::failure::one_line;
use crate::core::sweep::Part;
use crate::output::{
    Columns, Document, Format, PointTable, Selection, SizeLimit, Summary, read, write_atomically,
};
use crate::scene::{Choices, Grid, Outcome, designs};
use clap::Args;
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Sender, channel};

/// The options of a grid of settings: the axes of the grid, and the part of the grid to compute.
#[derive(Debug, Args)]
pub struct GridArgs {
    /// Trace the scene for equally spaced values or for a list of values of a setting, on all cores;
    /// repeat the option to trace all combinations of several settings. The results of finished
    /// combinations are kept; repeat the command to resume an interrupted grid
    #[arg(long, value_name = "NAME=LOW..HIGH:COUNT or NAME=VALUE,…", value_parser = choices)]
    pub grid: Vec<Choices>,
    /// Compute only part K of N parts of the grid; the part that finishes last writes the table of
    /// all parts
    #[arg(long, value_name = "K/N", value_parser = super::sweep::share, requires = "grid")]
    part: Option<Part>,
}

/// Parses `NAME=LOW..HIGH:COUNT` or `NAME=VALUE,…`.
fn choices(text: &str) -> Result<Choices, String> {
    if text.contains("..") {
        return axis(text).map(Choices::from);
    }
    let form = || {
        format!(
            "`{text}` is not of the form NAME=LOW..HIGH:COUNT or NAME=VALUE,…, for example gap=1,2,4"
        )
    };
    let (name, values) = text.split_once('=').ok_or_else(form)?;
    let values: Vec<String> = values.split(',').map(|value| value.trim().to_string()).collect();
    let (name, empty) = (name.trim().to_string(), values.iter().any(String::is_empty));
    if name.is_empty() || empty { Err(form()) } else { Ok(Choices { name, values }) }
}

/// Parses `NAME=LOW..HIGH:COUNT`.
pub(super) fn axis(text: &str) -> Result<Grid, String> {
    let form =
        || format!("`{text}` is not of the form NAME=LOW..HIGH:COUNT, for example gap=1..4:20");
    let (ends, count) = text.rsplit_once(':').ok_or_else(form)?;
    let range = range(ends)?;
    let count: usize = count.trim().parse().map_err(|_| form())?;
    let [low, high] = [range.low, range.high].map(|end| end.ok_or_else(form));
    let (low, high) = (low?, high?);
    match count {
        0 => Err(format!("the axis `{text}` has no values: the count must be at least 1")),
        1 if low != high => Err(format!(
            "the axis `{text}` has different ends but a single value: increase the \
                         count, or write {low}..{low}:1"
        )),
        _ => Ok(Grid { name: range.name, low, high, count }),
    }
}

/// A design, that is, a point of the grid: the name and the value of each setting.
pub type Design = Vec<(String, String)>;

/// The result of tracing a design: a description of its branches with their warnings, or the error
/// that ended the computation.
type Done = Result<(String, Vec<String>), CommandError>;

/// A grid of settings that is being traced.
pub struct Traced<'a> {
    /// All designs (points) of the grid.
    pub designs: Vec<Design>,
    /// The folder in which the documents of the designs are saved.
    pub folder: PathBuf,
    /// A text that contains the program version, the settings and the scene from which the designs
    /// are computed.
    pub made_of: String,
    /// The input files.
    pub inputs: &'a [&'a Path],
    /// The warnings that concern all designs of the grid.
    pub warnings: Vec<String>,
    pub limit: SizeLimit,
}

impl GridArgs {
    /// Returns all designs (points) of the grid.
    pub fn designs(&self) -> Result<Vec<Design>, CommandError> {
        let all = designs(&self.grid).map_err(CommandError::Grid)?;
        let mut names: Vec<String> = all.iter().map(name).collect();
        if let Some(long) = names.iter().find(|name| name.len() > LONGEST) {
            return Err(CommandError::LongDesign { name: long.clone(), most: LONGEST });
        }
        names.sort();
        match names.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => Err(CommandError::EqualDesigns { name: pair[0].clone() }),
            None => Ok(all),
        }
    }

    /// Traces the designs of one part of the grid that have no document yet, and writes a table of
    /// the special points after all designs of the grid are finished. Returns, for all documents of
    /// the grid, the reasons why their results are doubtful.
    ///
    /// # Errors
    /// [`CommandError::OtherGrid`] if the folder contains designs (points of the grid) of another
    /// scene; [`CommandError::Designs`] if some designs fail, after the other designs have been
    /// saved.
    pub fn run(
        &self,
        Traced { designs: all, folder, made_of, inputs, warnings, limit }: Traced,
        trace: impl Fn(&Design) -> Result<Outcome, CommandError> + Sync,
        out: &mut dyn Write,
    ) -> Result<Vec<String>, CommandError> {
        let part = self.part.unwrap_or(Part::WHOLE);
        signals::handle();
        let lock = format!("part-{}-of-{}", part.number, part.of);
        let _claimed = Results::claim(&folder, &lock, &[], inputs)?;
        let file = |design: &Design| Format::Ron.file(&folder.join(name(design)));
        let is_begun = all.iter().any(|design| file(design).exists());
        check_made_of(&folder, &made_of, is_begun, limit)?;
        warnings.iter().for_each(|warning| warn(warning));
        let own = all.iter().skip(part.number - 1).step_by(part.of);
        let todo: Vec<&Design> = own.filter(|design| !file(design).exists()).collect();
        let one = |design: &Design| -> Done {
            let Outcome { document, error, .. } = trace(design)?;
            if signals::interrupted() {
                return Err(CommandError::Interrupted);
            }
            if let Some(cause) = error {
                let place = name(design);
                return Err(CommandError::Scene { place, cause: Box::new(cause) });
            }
            document.save(file(design))?;
            Ok(told(&document, &warnings))
        };
        together(&todo, &one, out)?;
        let done = all.iter().filter(|design| file(design).exists());
        let done: Vec<&Design> = done.collect();
        let documents = done.iter().map(|design| Document::load_within(limit, file(design)));
        let documents = documents.collect::<Result<Vec<_>, _>>()?;
        let names: Vec<String> = done.iter().map(|design| name(design)).collect();
        let named: Vec<(&str, &Document)> =
            names.iter().map(String::as_str).zip(&documents).collect();
        let doubts = named.iter().flat_map(|(name, document)| {
            let of = document.branches.iter().flat_map(|branch| Summary(branch).doubts());
            of.map(move |doubt| format!("{name}: {doubt}"))
        });
        if done.len() < all.len() {
            let (missing, all) = (all.len() - done.len(), all.len());
            writeln!(
                out,
                "{}: {missing} of {all} designs of the grid are not finished",
                folder.display()
            )?;
            return Ok(doubts.collect());
        }
        let table = folder.join(TABLE);
        let selection = Selection { columns: Columns::All, ..Selection::default() };
        let points = PointTable::of(&named, selection).map_err(CommandError::NoColumn)?;
        write_atomically(&table, points.csv())?;
        writeln!(out, "{}", table.display())?;
        Ok(doubts.collect())
    }
}

/// The names of two files in the folder of the designs: the table of all special points, and the
/// text of [`Traced::made_of`].
const TABLE: &str = "points.csv";
const MADE_OF: &str = "scene.txt";

/// The maximum length of a design's name in bytes: file systems allow 255 bytes including the
/// extension, and the names of temporary files are longer.
const LONGEST: usize = 200;

/// Returns the name of a design from its settings, such as `gap=0.000002,thickness=1`.
fn name(design: &Design) -> String {
    let plain = |letter: char| letter.is_alphanumeric() || "_-.,=".contains(letter);
    let settings = design.iter().map(|(name, value)| format!("{name}={value}"));
    settings.collect::<Vec<_>>().join(",").replace(|letter| !plain(letter), "_")
}

/// Describes the branches of a design (a point of the grid), and returns the warnings that concern
/// this design only.
fn told(document: &Document, said: &[String]) -> (String, Vec<String>) {
    let branches = document.branches.iter().map(|branch| Summary(branch).to_string());
    let chosen = document.chosen.iter().map(|chosen| chosen.to_string());
    let warnings = document.branches.iter().flat_map(|branch| {
        let new = branch.warnings.iter().filter(|warning| !said.contains(warning));
        new.map(|warning| format!("{}: {warning}", branch.name))
    });
    (branches.chain(chosen).collect::<Vec<_>>().join("; "), warnings.collect())
}

/// Records, in the folder of the designs, the program version, the settings and the scene from
/// which the designs are computed; rejects a folder whose designs come from another scene, other
/// settings or another version.
fn check_made_of(
    folder: &Path,
    text: &str,
    is_begun: bool,
    limit: SizeLimit,
) -> Result<(), CommandError> {
    let path = folder.join(MADE_OF);
    match is_begun && path.exists() {
        false => Ok(write_atomically(path, text)?),
        true if read(&path, limit)? == text.as_bytes() => Ok(()),
        true => Err(CommandError::OtherGrid { folder: folder.into() }),
    }
}

/// Computes the designs (points of the grid) in parallel on all cores, and prints each result when
/// it is finished.
fn together(
    todo: &[&Design],
    one: &(impl Fn(&Design) -> Done + Sync),
    out: &mut dyn Write,
) -> Result<(), CommandError> {
    let bar = bar();
    let (mut failed, mut unwritten) = (0, None);
    std::thread::scope(|scope| {
        let (sender, receiver) = channel();
        scope.spawn(move || {
            todo.par_iter().for_each_with(sender, |sender: &mut Sender<_>, design| {
                // After an interruption no further design is started.
                if !signals::interrupted() {
                    let _ = sender.send((*design, one(design)));
                }
            });
        });
        for (done, (design, result)) in receiver.into_iter().enumerate() {
            bar.set_message(format!("{} of {} designs", done + 1, todo.len()));
            let name = name(design);
            match result {
                Ok((told, warnings)) => {
                    let tell = || writeln!(out, "{name}: {told}").and_then(|()| out.flush());
                    if let Err(cause) = bar.suspend(tell) {
                        unwritten.get_or_insert(cause);
                    }
                    let all = || warnings.iter().for_each(|it| warn(&format!("{name}: {it}")));
                    bar.suspend(all);
                }
                Err(CommandError::Interrupted) => {}
                Err(cause) => {
                    failed += 1;
                    bar.suspend(|| warn(&format!("{name}: {}", one_line(&cause))));
                }
            }
        }
    });
    bar.finish_and_clear();
    if let Some(cause) = unwritten {
        return Err(cause.into());
    }
    match failed {
        _ if signals::interrupted() => Err(CommandError::Interrupted),
        0 => Ok(()),
        failed => Err(CommandError::Designs { failed, of: todo.len() }),
    }
}
