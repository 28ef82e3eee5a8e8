//! What is asked of a model on the command line, or of a scene beyond what it states.

use crate::core::system::Kind;
use crate::misread::reason;
use crate::problems::text::number;
use crate::scene::{Asked, Range};
use clap::{Args, ValueEnum};

/// What is asked of a model, or of a scene beyond what it states.
#[derive(Debug, Default, Args)]
pub struct Asking {
    /// The parameter of the diagram with its range; a second one for curves of special points. In a
    /// scene, another range of a parameter that it varies
    #[arg(long, value_name = "NAME=LOW..HIGH", value_parser = range)]
    pub along: Vec<Range>,
    /// End branches where a parameter or a column leaves a range
    #[arg(long, value_name = "NAME=LOW..HIGH", value_parser = range)]
    pub bound: Vec<Range>,
    /// Begin where motion has settled after this time (in periods of the forcing, if there is one)
    #[arg(long, value_name = "TIME", value_parser = value)]
    pub settle: Option<f64>,
    /// Follow the curve of a kind of special point, in the parameters of --along
    #[arg(long, value_name = "KIND", value_parser = kind)]
    pub hold: Option<Kind>,
    /// Follow what is found: branches across branch points, orbits from Hopf points, doubled ones
    /// from period doublings, what begins at grazings
    #[arg(long, value_name = "WHAT")]
    pub switch: Option<Switch>,
    /// How many times what was found is followed
    #[arg(long, value_name = "COUNT", default_value = "1", requires = "switch",
        value_parser = depth)]
    pub depth: u8,
}

/// What is followed.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Switch {
    /// All special points from which other branches go.
    All,
}

impl Asking {
    /// What is asked, beginning in some states.
    pub fn asked(&self, state: &[(String, f64)]) -> Asked {
        let Asking { along, bound, settle, hold, .. } = self;
        Asked {
            along: along.clone(),
            bounds: bound.clone(),
            state: state.to_vec(),
            settle: *settle,
            hold: *hold,
        }
    }
}

/// `NAME=LOW..HIGH`, of which either end may be left out: a range.
fn range(text: &str) -> Result<Range, String> {
    let parts =
        text.split_once('=').and_then(|(name, ends)| Some((name.trim(), ends.split_once("..")?)));
    let Some((name, (low, high))) = parts.filter(|(name, _)| !name.is_empty()) else {
        return Err(format!("`{text}` is not of the form NAME=LOW..HIGH, for example rho=0..30"));
    };
    let end = |end: &str| if end.trim().is_empty() { Ok(None) } else { value(end).map(Some) };
    Ok(Range { name: name.into(), low: end(low)?, high: end(high)? })
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

fn kind(text: &str) -> Result<Kind, String> {
    ron::from_str(&text.to_uppercase()).map_err(|error| match error.code {
        ron::Error::NoSuchEnumVariant { .. } => reason(&error.code),
        _ => "expected a kind of special point, as HB".into(),
    })
}
