//! The options of an XPPAUT file, given on lines that begin with `@`.

use super::super::source::{ModelError, Source};
use super::origin::Slice;

/// The numerical options of an XPPAUT file, such as the duration of a simulation.
///
/// ```
/// use tangency::language::{Source, xpp};
/// let source = Source::new("decay.ode", "x'=-x\n@ total=50, dt=.1, bounds=1000, ntst=30\ndone\n");
/// let read = xpp::read(&source)?;
/// assert_eq!((read.options.total, read.options.bounds), (Some(50.0), Some(1000.0)));
/// assert_eq!((read.options.ntst, read.options.npr), (Some(30), None));
/// assert_eq!(read.ignored, ["line 2: option `dt=.1`"]);
/// # Ok::<(), tangency::language::ModelError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// The initial time, XPPAUT's option `t0`; 0 by default.
    pub start: f64,
    /// The duration: `total`.
    pub total: Option<f64>,
    /// The duration of the transient to discard, XPPAUT's option `trans`.
    pub transient: Option<f64>,
    /// The bound on all quantities, XPPAUT's option `bound` or `bounds`.
    pub bounds: Option<f64>,
    /// The number of mesh intervals of a periodic orbit in AUTO, XPPAUT's option `ntst`.
    pub ntst: Option<usize>,
    /// The number of points between two outputs of AUTO, XPPAUT's option `npr`; 0 for no output.
    pub npr: Option<usize>,
}

/// The settings found on the option lines of a file.
#[derive(Default)]
pub(super) struct Found {
    pub options: Options,
    /// Whether the integration method that the file selects is XPPAUT's method for maps.
    pub discrete: bool,
    pub ignored: Vec<String>,
}

impl Found {
    /// Parses the part of an option line that follows `@`. XPPAUT recognises an option by its first
    /// letters, and uses the last value if an option occurs several times.
    pub fn read(&mut self, source: &Source, line: Slice) -> Result<(), ModelError> {
        let mut at = 0;
        for piece in line.text.split_inclusive([' ', ',', '\t']) {
            let (start, word) = (at, piece.trim_end_matches([' ', ',', '\t']));
            at += piece.len();
            if !word.is_empty() {
                self.option(source, line.part(start..start + word.len()))?;
            }
        }
        Ok(())
    }

    fn option(&mut self, source: &Source, piece: Slice) -> Result<(), ModelError> {
        let (name, value) = piece.text.split_once('=').unwrap_or((piece.text, ""));
        let name = name.to_ascii_uppercase();
        let options = &mut self.options;
        let real = || number(value).ok_or_else(|| piece.expected(source, "a number after `=`"));
        let size = || {
            let expected = "a number above 0 after `=`";
            number(value)
                .filter(|value| *value > 0.0)
                .ok_or_else(|| piece.expected(source, expected))
        };
        let whole = |least: usize| {
            let value =
                number(value).filter(|value| value.fract() == 0.0 && *value >= least as f64);
            let expected = || format!("a whole number of {least} or more after `=`");
            value
                .map(|value| Some(value as usize))
                .ok_or_else(|| piece.expected(source, expected()))
        };
        if name.starts_with("DLL") {
            let reason = "the file would not contain the equations";
            return Err(piece.unsupported(source, "a library of compiled functions", reason));
        }
        if value.is_empty() {
            self.ignored.push(format!("line {}: `{}` in options", piece.line(source), piece.text));
            return Ok(());
        }
        match name.as_str() {
            name if name.starts_with("TOTAL") => options.total = Some(real()?),
            name if name.starts_with("TRANS") => options.transient = Some(real()?),
            name if name.starts_with("BOUND") => options.bounds = Some(size()?),
            name if name.starts_with("T0") => options.start = real()?,
            name if name.starts_with("NTST") => options.ntst = whole(1)?,
            name if name.starts_with("NPR") => options.npr = whole(0)?,
            name if name.starts_with("METH") => {
                self.discrete = value.starts_with(['d', 'D']);
                if !self.discrete {
                    self.pass_over(source, piece);
                }
            }
            _ => self.pass_over(source, piece),
        }
        Ok(())
    }

    fn pass_over(&mut self, source: &Source, piece: Slice) {
        self.ignored.push(format!("line {}: option `{}`", piece.line(source), piece.text));
    }
}

/// Parses a whole text as a number in the syntax of C; returns `None` if it is not a number.
pub(super) fn number(text: &str) -> Option<f64> {
    let text = text.trim();
    let plain = text.bytes().all(|b| b.is_ascii_digit() || b"+-.eE".contains(&b));
    let value: f64 = text.parse().ok().filter(|_| plain)?;
    value.is_finite().then_some(value)
}
