//! Command-line options from which a [`Request`] is made.

use super::scene_at::setting;
use super::signals;
use crate::core::system::Kind;
use crate::language::number;
use crate::misread::{reason, remedy};
use crate::scene::{Following, Range, Request, SearchBox};
use clap::Args;

/// The options that specify a computation for a model, or that change a scene.
#[derive(Debug, Default, Args)]
pub struct RequestArgs {
    /// The continuation parameter and its range; for a curve of special points, repeat the option
    /// with a second parameter. For a scene, the option replaces the range of a continuation
    /// parameter of the scene
    #[arg(long, value_name = "NAME=LOW..HIGH", value_parser = range)]
    pub along: Vec<Range>,
    /// End branches where a parameter or a column leaves the given range
    #[arg(long, value_name = "NAME=LOW..HIGH", value_parser = range)]
    pub bound: Vec<Range>,
    /// Mark the points of branches at which a parameter or a column has the given value; the orbits
    /// at marked points are drawn and saved
    #[arg(long, value_name = "NAME=VALUE", value_parser = mark)]
    pub mark: Vec<(String, f64)>,
    /// Simulate the motion for this time first, and start the branch from the resulting motion; if
    /// there is a forcing, the unit of this time is the forcing period
    #[arg(long, value_name = "TIME", value_parser = value)]
    pub settle: Option<f64>,
    /// Trace a curve of special points of the given kind, in the two parameters of --along
    #[arg(long, value_name = "KIND", value_parser = kind)]
    pub hold: Option<Kind>,
    /// Also trace the branches that emanate from special points: other branches at branch points,
    /// periodic orbits at Hopf points, orbits of twice the period at period doublings, and
    /// impacting or sliding orbits at grazings. Give `all`, or a list of kinds of special points;
    /// for `LP`, branches are switched only at points where several folds coincide
    #[arg(long, value_name = "all or BP,HB,…", value_parser = switch)]
    pub switch: Option<Switch>,
    /// The number of generations of emanating branches to trace: 2 also traces the branches that
    /// emanate from emanating branches
    #[arg(long, value_name = "COUNT", default_value = "1", requires = "switch",
        value_parser = depth)]
    pub depth: u8,
}

/// The kinds of special points at which the program switches to other branches.
#[derive(Clone, Debug)]
pub enum Switch {
    /// All kinds of special points that can occur in the request.
    All,
    /// The given kinds.
    Kinds(Vec<Kind>),
}

impl RequestArgs {
    /// Returns the kinds of special points at which the program switches to other branches. If
    /// branches start at all solutions in a box, a branch through several of these solutions is
    /// traced only once.
    pub fn following(&self, everywhere: bool) -> Option<Following> {
        let kinds = match &self.switch {
            None if everywhere => Vec::new(),
            None => return None,
            // Diagrams in two parameters consist of curves.
            Some(Switch::All) if self.hold.is_some() => Following::of_curves(),
            Some(Switch::All) => Following::all(1).kinds,
            Some(Switch::Kinds(kinds)) => kinds.clone(),
        };
        Some(Following { kinds, depth: self.depth.into(), distinct: everywhere })
    }

    /// Returns the request that consists of these options and of the given settings and initial
    /// states.
    pub fn request(&self, set: &[(String, String)], state: &[(String, f64)]) -> Request {
        let RequestArgs { along, bound, mark, settle, hold, .. } = self;
        Request {
            start: None,
            set: set.to_vec(),
            along: along.clone(),
            bounds: bound.clone(),
            marks: mark.clone(),
            state: state.to_vec(),
            settle: *settle,
            hold: *hold,
            within: None,
            cancel: signals::token(),
        }
    }
}

/// The options of a search for solutions in a box.
#[derive(Debug, Args)]
pub struct Within {
    /// The box to search for solutions: a range for each unknown
    #[arg(long = "box", value_name = "NAME=LOW..HIGH,…", value_delimiter = ',',
        value_parser = range)]
    ranges: Vec<Range>,
    /// The number of starting points from which the box is searched for solutions
    #[arg(long, value_name = "COUNT", default_value_t = 100, requires = "ranges",
        value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    starts: u32,
}

impl Within {
    /// Returns the search box, or `None` if no range is given.
    pub fn search(&self) -> Option<SearchBox> {
        let (ranges, starts) = (self.ranges.clone(), self.starts as usize);
        (!ranges.is_empty()).then_some(SearchBox { ranges, starts })
    }
}

/// Parses the range `NAME=LOW..HIGH`; either end may be omitted.
pub(super) fn range(text: &str) -> Result<Range, String> {
    let parts =
        text.split_once('=').and_then(|(name, ends)| Some((name.trim(), ends.split_once("..")?)));
    let Some((name, (low, high))) = parts.filter(|(name, _)| !name.is_empty()) else {
        return Err(format!("`{text}` is not of the form NAME=LOW..HIGH, for example rho=0..30"));
    };
    Ok(Range { name: name.into(), low: end(low)?, high: end(high)? })
}

/// Parses one end of a range; returns `None` if the end is omitted.
pub(super) fn end(text: &str) -> Result<Option<f64>, String> {
    if text.trim().is_empty() { Ok(None) } else { value(text).map(Some) }
}

/// Parses the marked value `NAME=VALUE` of a column.
fn mark(text: &str) -> Result<(String, f64), String> {
    let (name, text) = setting(text)?;
    Ok((name, value(&text)?))
}

/// Parses a number, or a formula that contains only numbers.
pub(super) fn value(text: &str) -> Result<f64, String> {
    number(text.trim()).map_err(|error| error.to_string())
}

/// Parses the number of generations of emanating branches.
fn depth(text: &str) -> Result<u8, String> {
    let depth = text.trim().parse().ok().filter(|depth| (1..=20).contains(depth));
    depth.ok_or_else(|| {
        "the depth, a number of generations of branches, must be a whole number \
                         between 1 and 20"
            .into()
    })
}

/// Parses the word `all`, or a list of the kinds of special points from which branches emanate.
fn switch(text: &str) -> Result<Switch, String> {
    if text == "all" {
        return Ok(Switch::All);
    }
    let all = Following::all(1).kinds;
    let followed = |text: &str| {
        let kind = kind(text.trim())?;
        let known = all.iter().map(|kind| kind.letters()).collect::<Vec<_>>().join(", ");
        let refused =
            || format!("no branch emanates from {kind}: choose among {known}, or give `all`");
        all.contains(&kind).then_some(kind).ok_or_else(refused)
    };
    text.split(',').map(followed).collect::<Result<_, _>>().map(Switch::Kinds)
}

/// Labels of special points in MatCont and other programs, each with this program's label of the
/// same kind.
const OTHER_LABELS: [(&str, &str); 6] =
    [("SN", "LP"), ("H", "HB"), ("NS", "TR"), ("LPC", "LP"), ("BPC", "BP"), ("PD1", "PD")];

/// Parses a kind of special point.
pub fn kind(text: &str) -> Result<Kind, String> {
    if let Some((_, own)) = OTHER_LABELS.iter().find(|(other, _)| *other == text.to_uppercase()) {
        return Err(format!(
            "there is no kind `{text}`: points that other programs label `{text}` are called `{own}` here"
        ));
    }
    ron::from_str(&text.to_uppercase()).map_err(|error| match error.code {
        ron::Error::NoSuchEnumVariant { .. } => [Some(reason(&error.code)), remedy(&error.code)]
            .map(Option::unwrap_or_default)
            .join("; "),
        _ => "expected a kind of special point, such as HB".into(),
    })
}
