//! Special points at which two branches meet in a grazing: the branches share one special point,
//! and only one of the branches lists this point as a grazing.

use super::identity::is_one_grazing;
use super::observer::SceneObserver;
use crate::core::continuation::{Branch, Observer, Point, SpecialPoint};
use crate::core::system::Kind;
use std::time::Duration;

/// An observer that reports a grazing as the end of a branch if an earlier branch already has this
/// grazing.
pub(super) struct Joined<'a> {
    pub done: &'a [&'a Branch],
    pub observer: &'a mut dyn SceneObserver,
}

impl Observer for Joined<'_> {
    fn begin(&mut self, branch: &Branch) {
        self.observer.begin(branch);
    }

    fn point(&mut self, point: &Point) {
        self.observer.point(point);
    }

    fn special(&mut self, branch: &Branch, special: &SpecialPoint) {
        let mut special = special.clone();
        join(branch, &mut special, self.done);
        self.observer.special(branch, &special);
    }
}

/// Turns a grazing at which a branch meets an earlier branch into an end, because the earlier
/// branch already lists the grazing. A monitor that is zero at the grazing on one branch may have a
/// nonzero value at the same grazing on the other branch.
pub(super) fn join(branch: &Branch, special: &mut SpecialPoint, done: &[&Branch]) {
    if special.kind != Kind::G || branch.condition.is_some() {
        return;
    }
    let others = done.iter().copied().filter(|other| other.condition.is_none());
    let mut met = others.flat_map(|other| other.of_kind(Kind::G).map(move |there| (other, there)));
    if let Some((other, there)) =
        met.find(|(other, there)| is_one_grazing((branch, special), (other, there)))
    {
        special.kind = Kind::EP;
        special.event = format!(
            "the branch meets `{}` at point {}, where both branches graze",
            other.name, there.label
        );
    }
}

impl SceneObserver for Joined<'_> {
    fn work(&mut self, run: &str, what: &str, longest: Duration) {
        self.observer.work(run, what, longest);
    }
}
