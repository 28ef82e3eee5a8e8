//! Requests to a model, or to a scene beyond its statement, on the command line.

use super::scene_at::setting;
use super::signals;
use crate::core::system::Kind;
use crate::language::number;
use crate::misread::reason;
use crate::scene::{Following, Range, Request, SearchBox};
use clap::Args;

/// A request to a model, or to a scene beyond its statement.
#[derive(Debug, Default, Args)]
pub struct RequestArgs {
    /// The parameter of the diagram with its range; a second one for curves of special points. In a
    /// scene, another range of a parameter that it varies
    #[arg(long, value_name = "NAME=LOW..HIGH", value_parser = range)]
    pub along: Vec<Range>,
    /// End branches where a parameter or a column leaves a range
    #[arg(long, value_name = "NAME=LOW..HIGH", value_parser = range)]
    pub bound: Vec<Range>,
    /// Mark where a parameter or a column has a value; orbits there are drawn and saved
    #[arg(long, value_name = "NAME=VALUE", value_parser = mark)]
    pub mark: Vec<(String, f64)>,
    /// Begin where motion has settled after this time (in periods of the forcing, if there is one)
    #[arg(long, value_name = "TIME", value_parser = value)]
    pub settle: Option<f64>,
    /// Follow the curve of a kind of special point, in the parameters of --along
    #[arg(long, value_name = "KIND", value_parser = kind)]
    pub hold: Option<Kind>,
    /// Follow what is found: branches across branch points, orbits from Hopf points, doubled ones
    /// from period doublings, what begins at grazings; all of these, or from some kinds of points
    /// (LP: only where several folds coincide)
    #[arg(long, value_name = "all or BP,HB,…", value_parser = switch)]
    pub switch: Option<Switch>,
    /// How many times what was found is followed
    #[arg(long, value_name = "COUNT", default_value = "1", requires = "switch",
        value_parser = depth)]
    pub depth: u8,
}

/// The kinds of special points that are followed.
#[derive(Clone, Debug)]
pub enum Switch {
    /// All that the request can meet.
    All,
    /// Some.
    Kinds(Vec<Kind>),
}

impl RequestArgs {
    /// Which special points are followed; where branches begin at all solutions, each branch is
    /// traced once.
    pub fn following(&self, everywhere: bool) -> Option<Following> {
        let kinds = match &self.switch {
            None if everywhere => Vec::new(),
            None => return None,
            // In two parameters the picture is made of curves.
            Some(Switch::All) if self.hold.is_some() => Following::of_curves(),
            Some(Switch::All) => Following::all(1).kinds,
            Some(Switch::Kinds(kinds)) => kinds.clone(),
        };
        Some(Following { kinds, depth: self.depth.into(), distinct: everywhere })
    }

    /// The request to a scene with some changed values, beginning in some states.
    pub fn request(&self, set: &[(String, String)], state: &[(String, f64)]) -> Request {
        let RequestArgs { along, bound, mark, settle, hold, .. } = self;
        Request {
            restarts: false,
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

/// Where solutions are sought.
#[derive(Debug, Args)]
pub struct Within {
    /// The range of each unknown in which solutions are sought
    #[arg(long = "box", value_name = "NAME=LOW..HIGH,…", value_delimiter = ',',
        value_parser = range)]
    ranges: Vec<Range>,
    /// From how many starts in the box solutions are sought
    #[arg(long, value_name = "COUNT", default_value_t = 100, requires = "ranges",
        value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    starts: u32,
}

impl Within {
    /// The box; none without a range.
    pub fn search(&self) -> Option<SearchBox> {
        let (ranges, starts) = (self.ranges.clone(), self.starts as usize);
        (!ranges.is_empty()).then_some(SearchBox { ranges, starts })
    }
}

/// `NAME=LOW..HIGH`, of which either end may be left out: a range.
pub(super) fn range(text: &str) -> Result<Range, String> {
    let parts =
        text.split_once('=').and_then(|(name, ends)| Some((name.trim(), ends.split_once("..")?)));
    let Some((name, (low, high))) = parts.filter(|(name, _)| !name.is_empty()) else {
        return Err(format!("`{text}` is not of the form NAME=LOW..HIGH, for example rho=0..30"));
    };
    let end = |end: &str| if end.trim().is_empty() { Ok(None) } else { value(end).map(Some) };
    Ok(Range { name: name.into(), low: end(low)?, high: end(high)? })
}

/// `NAME=VALUE`: a value that is marked.
fn mark(text: &str) -> Result<(String, f64), String> {
    let (name, text) = setting(text)?;
    Ok((name, value(&text)?))
}

/// A number, or a formula of numbers.
pub(super) fn value(text: &str) -> Result<f64, String> {
    number(text.trim()).map_err(|error| error.to_string())
}

/// How many times branches are followed.
fn depth(text: &str) -> Result<u8, String> {
    let depth = text.trim().parse().ok().filter(|depth| (1..=20).contains(depth));
    depth.ok_or_else(|| "a depth is a whole number from 1 to 20".into())
}

/// `all`, or kinds of special points from which branches go.
fn switch(text: &str) -> Result<Switch, String> {
    if text == "all" {
        return Ok(Switch::All);
    }
    let all = Following::all(1).kinds;
    let followed = |text: &str| {
        let kind = kind(text.trim())?;
        let known = all.iter().map(|kind| kind.letters()).collect::<Vec<_>>().join(", ");
        let refused = || format!("no branch goes on from {kind}: take some of {known}, or `all`");
        all.contains(&kind).then_some(kind).ok_or_else(refused)
    };
    text.split(',').map(followed).collect::<Result<_, _>>().map(Switch::Kinds)
}

pub fn kind(text: &str) -> Result<Kind, String> {
    ron::from_str(&text.to_uppercase()).map_err(|error| match error.code {
        ron::Error::NoSuchEnumVariant { .. } => reason(&error.code),
        _ => "expected a kind of special point, as HB".into(),
    })
}
