//! The progress of a trace: prints special points, and shows a progress bar on a terminal.

use super::error::CommandError;
use super::signals::interrupted;
use super::warning::warn;
use crate::core::continuation::{Branch, Observer, Point, SpecialPoint};
use crate::output::{Screen, printable};
use crate::scene::SceneObserver;
use clap::Args;
use console::Term;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{IsTerminal, Sink, Write};
use std::time::Duration;

/// Returns a progress bar, which is visible if the standard error stream is a terminal.
pub fn bar() -> ProgressBar {
    let bar = match std::io::stderr().is_terminal() {
        true => ProgressBar::new_spinner(),
        false => ProgressBar::hidden(),
    };
    if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {msg}") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(120));
    bar
}

/// The estimated duration above which a computation is announced.
const LONG: Duration = Duration::from_secs(60);
/// The number of minutes in a year.
const YEAR: u64 = 365 * 24 * 60;

/// Announces a computation that may take a long time, with its estimated duration.
pub fn announce(bar: &ProgressBar, name: &str, what: &str, longest: Duration, remedy: &str) {
    if longest < LONG {
        return;
    }
    let time = match longest.as_secs() / 60 {
        minutes @ 0..YEAR => {
            humantime::format_duration(Duration::from_secs(minutes * 60)).to_string()
        }
        _ => "more than a year".into(),
    };
    let name = printable(name);
    let warning = format!("`{name}`: {what} may take up to {time}; {remedy}");
    bar.suspend(|| warn(&warning));
}

/// The option that suppresses all output except warnings and errors.
#[derive(Clone, Copy, Debug, Args)]
pub struct Quiet {
    /// Print only warnings and errors
    #[arg(short, long)]
    pub quiet: bool,
}

impl Quiet {
    /// Returns the stream to which a command prints: the given output, or nowhere.
    pub fn stream<'a>(self, out: &'a mut dyn Write, nowhere: &'a mut Sink) -> &'a mut dyn Write {
        if self.quiet { nowhere } else { out }
    }
}

/// The options that control the printed output of a trace.
#[derive(Clone, Copy, Debug, Args)]
pub struct Telling {
    #[command(flatten)]
    pub quiet: Quiet,
    /// Print all points of branches, not only the special points
    #[arg(short, long, conflicts_with = "quiet")]
    pub verbose: bool,
    /// Print all columns, even if the lines are wider than the terminal
    #[arg(long)]
    pub wide: bool,
}

impl Telling {
    /// The default printed output of commands other than `trace`: special points with all columns.
    pub const USUAL: Telling =
        Telling { quiet: Quiet { quiet: false }, verbose: false, wide: true };

    /// Returns the width of the terminal in letters, or `None` if all columns are printed.
    fn width(self) -> Option<usize> {
        let size = Term::stdout().size_checked().filter(|_| !self.wide);
        size.map(|(_, columns)| usize::from(columns))
    }
}

/// Prints special points to the standard output as soon as they are found.
pub struct Watch<'a, W: Write + ?Sized> {
    out: &'a mut W,
    telling: Telling,
    screen: Option<Screen>,
    bar: ProgressBar,
    points: u64,
    shown: bool,
    failure: Option<std::io::Error>,
}

impl<'a, W: Write + ?Sized> Watch<'a, W> {
    /// Creates a watch, which prints special points to `out` and shows a progress bar if the
    /// standard error stream is a terminal.
    pub fn new(out: &'a mut W, telling: Telling) -> Self {
        Watch { out, telling, screen: None, bar: bar(), points: 0, shown: true, failure: None }
    }

    /// Ends the watch, and returns whether the program received a signal.
    ///
    /// # Errors
    /// [`CommandError::Output`] if the standard output cannot be written to.
    pub fn finish(self) -> Result<bool, CommandError> {
        self.bar.finish_and_clear();
        self.failure.map_or(Ok(interrupted()), |failure| Err(failure.into()))
    }

    fn line(&mut self, text: &str) {
        if self.failure.is_none() {
            let out = &mut self.out;
            self.failure =
                self.bar.suspend(|| writeln!(out, "{text}").and_then(|()| out.flush())).err();
        }
    }
}

impl<W: Write + ?Sized> Observer for Watch<'_, W> {
    fn begin(&mut self, branch: &Branch) {
        let screen = Screen::of(branch, self.telling.width());
        if self.shown {
            self.line(&branch.name);
            self.line(&screen.header());
        }
        self.screen = Some(screen);
    }

    fn point(&mut self, point: &Point) {
        if let (Some(screen), true, true) = (&self.screen, self.shown, self.telling.verbose) {
            let line = screen.point(point);
            self.line(&line);
        }
        self.points += 1;
        self.bar.set_message(format!("{} points", self.points));
    }

    fn special(&mut self, _branch: &Branch, special: &SpecialPoint) {
        if let (Some(screen), true) = (&self.screen, self.shown) {
            let line = screen.line(special);
            self.line(&line);
        }
    }
}

impl<W: Write + ?Sized> SceneObserver for Watch<'_, W> {
    fn work(&mut self, run: &str, what: &str, longest: Duration) {
        announce(&self.bar, run, what, longest, "Ctrl-C keeps the results computed so far");
    }

    fn run(&mut self, _run: &str, shown: bool) {
        self.shown = shown;
    }
}
