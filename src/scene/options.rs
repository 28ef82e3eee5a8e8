//! Conversion of requests to options of the command line.

use super::explore::Following;
use super::request::Request;
use super::statement::Range;

impl Request {
    /// Returns the options of `tangency trace` that correspond to the request, as pairs of a name
    /// and a value.
    ///
    /// ```
    /// use tangency::scene::{Range, Request};
    /// let along = vec![Range { name: "a".into(), low: Some(0.1), high: None }];
    /// let request = Request { along, settle: Some(1e30), ..Request::default() };
    /// assert_eq!(request.options(), [("--along", "a=0.1..".into()), ("--settle", "1e30".into())]);
    /// ```
    pub fn options(&self) -> Vec<(&'static str, String)> {
        let ranges = |option, ranges: &[Range]| -> Vec<_> {
            ranges.iter().map(|range| (option, written(range))).collect()
        };
        let set = self.set.iter().map(|(name, value)| ("--set", format!("{name}={value}")));
        let mut all: Vec<(&'static str, String)> = set.collect();
        all.extend(ranges("--along", &self.along));
        all.extend(ranges("--bound", &self.bounds));
        all.extend(self.marks.iter().map(|mark| ("--mark", equal(mark))));
        if !self.state.is_empty() {
            all.push(("--start", self.state.iter().map(equal).collect::<Vec<_>>().join(",")));
        }
        if let Some(within) = &self.within {
            let ranges = within.ranges.iter().map(written).collect::<Vec<_>>().join(",");
            all.push(("--start", "all".into()));
            all.extend([("--box", ranges), ("--starts", within.starts.to_string())]);
        }
        all.extend(self.settle.map(|time| ("--settle", number(time))));
        all.extend(self.hold.map(|kind| ("--hold", kind.to_string())));
        all
    }
}

impl Following {
    /// Returns the options of `tangency trace` that select the kinds of special points at which
    /// branches are switched, and the depth of branch switching.
    pub fn options(&self) -> Vec<(&'static str, String)> {
        if self.kinds.is_empty() {
            return Vec::new();
        }
        let kinds: Vec<&str> = self.kinds.iter().map(|kind| kind.letters()).collect();
        let is_all = self.kinds == Following::all(1).kinds || self.kinds == Following::of_curves();
        let kinds = if is_all { "all".into() } else { kinds.join(",") };
        vec![("--switch", kinds), ("--depth", self.depth.to_string())]
    }
}

/// Formats a range as `NAME=LOW..HIGH`.
fn written(Range { name, low, high }: &Range) -> String {
    let [low, high] = [low, high].map(|end| end.map_or(String::new(), number));
    format!("{name}={low}..{high}")
}

/// Formats the value of a state or of a mark as `NAME=VALUE`.
fn equal((name, value): &(String, f64)) -> String {
    format!("{name}={}", number(*value))
}

/// Returns the shortest decimal form of a floating-point number from which the same number is
/// parsed.
fn number(value: f64) -> String {
    let [plain, scientific] = [value.to_string(), format!("{value:e}")];
    if plain.len() <= scientific.len() + 2 { plain } else { scientific }
}
