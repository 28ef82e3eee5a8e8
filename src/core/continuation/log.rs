//! The log of a continuation: labels, warnings, and computed points in the order in which they were
//! found.

use super::branch::{Branch, Point, SpecialPoint, Traced};
use super::mesh_share::Shortfall;
use super::progress::Crawl;
use crate::core::failure::one_line;
use crate::core::problem::distinct;
use crate::core::system::Kind;
use miette::Diagnostic;
use std::collections::VecDeque;

/// Assigns labels to special points, and stores computed points until the iterator returns them.
pub(super) struct Log {
    /// The branch that is being traced, without its points.
    pub branch: Branch,
    /// The number of labels assigned so far.
    labels: usize,
    /// The special points whose discretisation errors are larger than requested.
    shortfalls: Vec<(Kind, Shortfall)>,
    /// The points that are computed but not yet returned by the iterator.
    items: VecDeque<Traced>,
}

impl Log {
    pub fn new(branch: Branch) -> Self {
        Log { branch, labels: 0, shortfalls: Vec::new(), items: VecDeque::new() }
    }

    /// Returns the next computed point that has not yet been returned.
    pub fn next(&mut self) -> Option<Traced> {
        self.items.pop_front()
    }

    /// Appends a regular point to the queue of the iterator.
    pub fn point(&mut self, point: &Point) {
        self.items.push_back(Traced::Point(point.clone()));
    }

    /// Labels a special point, appends it to the queue of the iterator, and adds it to a list.
    pub fn special(&mut self, list: &mut Vec<SpecialPoint>, mut special: SpecialPoint) {
        self.labels += 1;
        special.label = self.labels;
        if let Some(reason) = &special.without_phase_response {
            let SpecialPoint { label, kind, .. } = special;
            let warning = format!(
                "the special point {label} ({kind}) has no phase response: \
                                   {reason}"
            );
            self.branch.warnings.push(warning);
        }
        self.items.push_back(Traced::Special(Box::new(special.clone())));
        list.push(special);
    }

    /// Notes the column of a special point whose discretisation error is larger than requested.
    pub fn falls_short(&mut self, kind: Kind, shortfall: Option<Shortfall>) {
        self.shortfalls.extend(shortfall.map(|shortfall| (kind, shortfall)));
    }

    /// Warns about the special points whose discretisation errors are larger than requested.
    pub fn short_of(&mut self, refinement: f64) {
        let relative = |(_, it): &&(Kind, Shortfall)| it.relative;
        let worst = self.shortfalls.iter().max_by(|a, b| relative(a).total_cmp(&relative(b)));
        let Some((_, Shortfall { column, relative })) = worst else { return };
        let kinds: Vec<String> = self.shortfalls.iter().map(|(kind, _)| kind.to_string()).collect();
        let kinds = distinct(&kinds).join(", ");
        self.branch.warnings.push(format!(
            "special points ({kinds}) have a larger error than `refinement` = {refinement:e} permits, because finer \
             discretisations are not available or do not converge: the relative error of `{column}` is up to {relative:.1e}; the column `error` \
             gives the error of each point"
        ));
    }

    /// Warns that an event between two values of the continued parameter was not located.
    pub fn not_located(&mut self, event: &str, [low, high]: [f64; 2], cause: &dyn Diagnostic) {
        let continued = &self.branch.released[0];
        self.branch.warnings.push(format!(
            "the event `{event}` between {continued} = {low:.6} and {high:.6} was not located: {}",
            one_line(cause)
        ));
    }

    /// Warns, once per branch, that several successive solutions lie at the same limit of
    /// admissible solutions, either because events of the orbits are simultaneous along the branch
    /// or because the motion is about to stop at an equilibrium.
    pub fn stays_at_limit(&mut self, event: &str) {
        let warning = format!(
            "the test function of `{event}` vanishes, up to its error, at several successive \
             points, so these points are not reported as special points: either two events are \
             simultaneous along the branch, as in synchrony, and the multipliers are computed for \
             one order of the two events; or the motion is about to stop at an equilibrium"
        );
        let warnings = &mut self.branch.warnings;
        if !warnings.contains(&warning) {
            warnings.push(warning);
        }
    }

    /// Warns that the number of unstable eigenvalues beside a curve changes without a special point.
    /// The released parameters have the given `values` there.
    pub fn passes_unseen(&mut self, values: &[f64], change: isize) {
        let both = self.branch.released.iter().zip(values);
        let place: Vec<String> = both.map(|(name, value)| format!("{name} = {value:.6}")).collect();
        let place = place.join(", ");
        self.branch.warnings.push(format!(
            "near {place}, the number of unstable eigenvalues beside the curve changes by {change:+}, \
             and no special point on the curve explains the change: possibly several eigenvalues vanish together, or an \
             eigenvalue vanishes whose eigenvector is independent of the eigenvectors that define the curve"
        ));
    }

    /// Warns that the homoclinic orbit at the end of the branch was not located.
    pub fn homoclinic_not_located(&mut self, cause: &dyn Diagnostic) {
        let warning = format!(
            "the homoclinic orbit at the end of the branch was not located: {}",
            one_line(cause)
        );
        self.branch.warnings.push(warning);
    }

    /// Warns that deviations which grow over a segment may have ended the branch.
    pub fn stopped_by_growth(&mut self, growth: f64) {
        self.branch.warnings.push(format!(
            "at the end of the branch, deviations grow by {growth:.1e} over a segment, which makes the \
             steps short: use more segments (`segments=8`), or collocation"
        ));
    }

    /// Warns that a branch makes hardly any progress before it reaches a value of the continued
    /// parameter.
    pub fn crawls(&mut self, Crawl { points, change }: &Crawl, value: f64) {
        let (continued, percent) = (&self.branch.released[0], 100.0 * change);
        self.branch.warnings.push(format!(
            "the branch crawls before {continued} = {value:.6}: over {points} points each parameter, and the norm and \
             the sum of each group of unknowns, change by at most {percent:.2} % of their scales, as where a steep \
             front moves along a mesh; `method: shooting()` may take longer steps"
        ));
    }

    /// Warns that the parameter varies from a value on, although it was constant at the start of the branch.
    pub fn leaves_family(&mut self, value: f64) {
        let continued = &self.branch.released[0];
        self.branch.warnings.push(format!(
            "at the start of this branch `{continued}` is constant, up to errors, as along a family of cycles of a conservative \
             system; it varies after {continued} = {value:.3e}. Up to this value, folds are not sought, and `unstable` does \
             not count a second multiplier 1"
        ));
    }

    /// Warns that states have become small at a value of the continued parameter.
    pub fn small_from(&mut self, value: f64) {
        let continued = &self.branch.released[0];
        self.branch.warnings.push(format!(
            "from {continued} = {value:.6} on, all states of a segment are smaller than 1e-7 of \
             their scales: because tolerances are relative to the scales, durations have fewer \
             correct digits than their error estimates suggest; end the branch at this value, or \
             give smaller `scales`"
        ));
    }
}
