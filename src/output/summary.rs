//! Summarises a branch in one sentence.

use super::number::significant;
use crate::core::continuation::{Branch, End};
use crate::core::system::Kind;
use std::fmt;

/// The summary of a branch in one sentence: the range of the continuation parameter, the ends of
/// the branch with the reasons for them, and its stability. Unexpected ends are explained in the
/// last part of the summary.
///
/// ```
/// use tangency::output::{Summary, example_branch};
/// let text = "plate: load from 0 (start) to 0.032 (deflection = 0.8), 41 points; \
///     stable from 0 to 0.148148";
/// assert_eq!(Summary(&example_branch()).to_string(), text);
///
/// let mut branch = example_branch();
/// branch.points.truncate(1);
/// branch.ends[1] = tangency::core::continuation::End::Interrupted;
/// assert_eq!(Summary(&branch).to_string(), "plate: load = 0 (interrupted), 1 point; stable");
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Summary<'a>(pub &'a Branch);

/// The number of significant digits of numbers in the summary.
const DIGITS: usize = 6;

/// The maximum number of intervals of stability that the summary lists.
const MOST: usize = 3;

/// Rounding: a parameter is constant along a branch if it changes by less than this number, or by less
/// than this fraction of its value.
const CONSTANT: f64 = 1e-6;

/// Heuristic: a period varies along a branch if it changes by more than this fraction of its value.
const VARIES: f64 = 1e-3;

impl fmt::Display for Summary<'_> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Branch { name, points, ends, released, .. } = self.0;
        write!(f, "{name}: ")?;
        let values = || (0..points.len()).map(|index| self.value(index));
        match (released.first(), values().next(), values().next_back()) {
            (Some(parameter), Some(first), Some(last)) if points.len() > 1 => match &ends[1] {
                End::Closed { .. } => {
                    let [low, high] =
                        [values().fold(first, f64::min), values().fold(last, f64::max)];
                    write!(
                        f,
                        "a closed curve, {parameter} from {} to {}, ",
                        number(low),
                        number(high)
                    )?;
                }
                _ => {
                    let [from, to] = [(first, &ends[0]), (last, &ends[1])]
                        .map(|(value, end)| format!("{} ({})", number(value), reason(end)));
                    write!(f, "{parameter} from {from} to {to}, ")?;
                }
            },
            // After an immediate interruption, the start is the only point.
            (Some(parameter), Some(value), _) => {
                write!(f, "{parameter} = {} ({}), ", number(value), reason(&ends[1]))?;
            }
            _ => {}
        }
        write!(f, "{} point{}", points.len(), if points.len() == 1 { "" } else { "s" })?;
        if let Some(stable) = self.stability() {
            write!(f, "; {stable}")?;
        }
        // The number of points is stated above.
        let told = |end: &End| end.is_expected() || matches!(end, End::PointLimit { .. });
        let mut unasked = ends.iter().filter(|end| !told(end));
        unasked.try_for_each(|end| write!(f, "; {end}"))?;
        let mut notes = self.turned_back().into_iter().chain(self.halved());
        notes.try_for_each(|note| write!(f, "; {note}"))
    }
}

impl Summary<'_> {
    /// Returns the reasons why the results for a branch may be wrong: special points that have not
    /// converged, and unexpected ends.
    ///
    /// ```
    /// use tangency::output::{Summary, example_branch};
    /// let mut branch = example_branch();
    /// assert!(Summary(&branch).doubts().is_empty());
    /// branch.special[2].converged = false;
    /// assert_eq!(Summary(&branch).doubts(), ["plate: the special point LP with label 3 has not converged"]);
    /// ```
    pub fn doubts(&self) -> Vec<String> {
        let Branch { name, special, ends, .. } = self.0;
        let open = special.iter().filter(|point| !point.converged && point.kind != Kind::MX);
        let open = open.map(|point| {
            format!(
                "{name}: the special point {} with label {} has not converged",
                point.kind, point.label
            )
        });
        let ends = ends.iter().filter(|end| !end.is_expected()).map(|end| format!("{name}: {end}"));
        open.chain(ends).collect()
    }

    /// Returns a note if a branch of solutions that starts at a bound of the continuation parameter
    /// leaves the range at the same bound again.
    ///
    /// ```
    /// use tangency::core::continuation::End;
    /// use tangency::output::{Summary, example_branch};
    /// let mut branch = example_branch();
    /// let (name, value) = (branch.released[0].clone(), branch.points[0].parameters[0]);
    /// branch.ends = [(); 2].map(|()| End::ParameterBound { name: name.clone(), value });
    /// let text = Summary(&branch).to_string();
    /// assert!(text.ends_with("; the branch turned back and left its range where it started, at load = 0: a range \
    ///     with a lower LOW shows more of it"));
    /// ```
    fn turned_back(&self) -> Option<String> {
        let Branch { condition: None, ends, released, points, special, .. } = self.0 else {
            return None;
        };
        let [End::ParameterBound { name, value }, other] = ends else { return None };
        // A start at a bound has the first label.
        let starts_there = special.first().is_some_and(|start| start.label == 1);
        if ends[0] != *other || released.first() != Some(name) || !starts_there {
            return None;
        }
        let beyond = if (0..points.len()).any(|index| self.value(index) > *value) {
            "lower LOW"
        } else {
            "higher HIGH"
        };
        Some(format!(
            "the branch turned back and left its range where it started, at {name} = {}: a range \
             with a {beyond} shows more of it",
            number(*value)
        ))
    }

    /// Returns a note for each end at which the two halves of the cycles become equal.
    fn halved(&self) -> impl Iterator<Item = String> {
        let Branch { name, special, .. } = self.0;
        special.iter().filter(|it| it.halves_the_period()).map(move |it| {
            format!(
                "cycles of half the period go on from the label {0}: `--start FILE:{name}/{0} \
                 --switch PD`",
                it.label
            )
        })
    }

    /// Returns the value of the continuation parameter at a point.
    fn value(&self, index: usize) -> f64 {
        self.value_in(self.0.released.first().and_then(|name| self.0.column(name)), index)
    }

    /// Returns the value in a column at a point.
    fn value_in(&self, column: Option<usize>, index: usize) -> f64 {
        column.and_then(|column| self.0.points[index].value(column)).unwrap_or(f64::NAN)
    }

    /// Returns the value of the continuation parameter at which stability changes between a given
    /// point of the branch and the next point: the value at a special point between the two points,
    /// or else the value at the point with the index `otherwise`.
    fn boundary(&self, column: Option<usize>, index: usize, otherwise: usize) -> f64 {
        let keeps = |kind| matches!(kind, Kind::EP | Kind::UZ | Kind::RG | Kind::MX | Kind::ND);
        let mut special = self.0.special.iter().filter(|point| point.after == index);
        let special = special.find(|point| point.converged && !keeps(point.kind));
        let value = special.zip(column).and_then(|(point, column)| point.value(column));
        value.unwrap_or_else(|| self.value_in(column, otherwise))
    }

    /// Returns the column in which intervals of stability are given: the continued parameter or, along
    /// a family of cycles at one value of the parameter, the period.
    fn ruler(&self) -> (Option<usize>, &str) {
        let range = |column: usize| {
            let values = || self.0.points.iter().filter_map(|point| point.value(column));
            let [low, high] =
                [f64::min, f64::max].map(|of| values().reduce(of).unwrap_or(f64::NAN));
            (high - low) / low.abs().max(high.abs()).max(1.0)
        };
        let continued = self.0.released.first().and_then(|name| self.0.column(name));
        let period = self.0.column("period");
        let is_constant = continued.is_some_and(|column| range(column) <= CONSTANT);
        match period.filter(|column| is_constant && range(*column) > VARIES) {
            Some(column) => (Some(column), "for period "),
            None => (continued, ""),
        }
    }

    /// Describes the intervals in which the branch is stable; `None` if its solutions have no
    /// stability.
    fn stability(&self) -> Option<String> {
        let points = &self.0.points;
        let stable = |index: usize| points[index].unstable == Some(0) && points[index].admissible;
        points.iter().find(|point| point.unstable.is_some())?;
        let (column, name) = self.ruler();
        let value = |index: usize| self.value_in(column, index);
        let mut intervals: Vec<[f64; 2]> = Vec::new();
        for index in (0..points.len()).filter(|index| stable(*index)) {
            if index == 0 || !stable(index - 1) {
                // The first point may be the special point at which the branch emanates.
                let from = match index {
                    0 => value(0),
                    1 => self.boundary(column, 0, 0),
                    _ => self.boundary(column, index - 1, index),
                };
                intervals.push([from; 2]);
            }
            let goes_on = index + 1 == points.len() || stable(index + 1);
            let to = if goes_on { value(index) } else { self.boundary(column, index, index) };
            if let Some([low, high]) = intervals.last_mut() {
                for value in [value(index), to] {
                    (*low, *high) = (low.min(value), high.max(value));
                }
            }
        }
        // At an end where stability changes, the critical eigenvalue does not count as unstable.
        if (1..points.len()).any(|index| value(index) != value(0)) {
            intervals.retain(|[low, high]| low < high);
        }
        Some(match &intervals[..] {
            // Stability is undetermined where orbits emanate.
            [] if points.iter().all(|it| {
                (it.unstable != Some(0) || it.admissible) && it.undetermined.is_none()
            }) =>
            {
                "unstable".into()
            }
            [] => "nowhere stable".into(),
            _ if (0..points.len()).all(stable) => "stable".into(),
            all => {
                let words = |[a, b]: &[f64; 2]| format!("from {} to {}", number(*a), number(*b));
                let listed: Vec<String> = all.iter().take(MOST).map(words).collect();
                let more = match all.len().saturating_sub(MOST) {
                    0 => String::new(),
                    more => format!(", and {more} more"),
                };
                format!("stable {name}{}{more}", listed.join(", "))
            }
        })
    }
}

fn number(value: f64) -> String {
    significant(value, DIGITS)
}

/// Describes the reason why a branch ends.
fn reason(end: &End) -> String {
    match end {
        End::ParameterBound { .. } => "bound".into(),
        End::MonitorBound { name, value } => format!("{name} = {}", number(*value)),
        End::Grazing { subkind, .. } => subkind.clone().unwrap_or("grazing".into()),
        End::Event { event } => event.clone(),
        End::Closed { .. } => "closed".into(),
        End::Start => "start".into(),
        End::Interrupted => "interrupted".into(),
        End::Homoclinic { .. } => "homoclinic orbit".into(),
        End::LongPeriod { .. } => "long period".into(),
        End::Snaking { .. } => "snaking".into(),
        End::WeakSaddle { .. } => "no saddle".into(),
        End::Infinite { name, .. } => format!("infinite {name}"),
        End::PointLimit { .. } => "max_points".into(),
        End::MeshTooCoarse { .. } => "coarse mesh".into(),
        End::StepTooSmall { .. } => "no step".into(),
        End::ConvergesTo { .. } => "a limit point".into(),
        End::NoProgress { .. } => "no progress".into(),
        End::ResetJumps { .. } => "jump".into(),
    }
}
