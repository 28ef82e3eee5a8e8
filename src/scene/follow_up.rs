//! The runs that can continue from one special point of a traced branch.

use super::explore::{following, orbits_of};
use super::resolve::Resolution;
use super::statement::{Range, Run, Start, Way};
use crate::core::bifurcation::catalogue;
use crate::core::continuation::{Branch, SpecialPoint};
use crate::core::system::Kind;
use serde::Serialize;

/// A run that can continue from a special point.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FollowUp {
    /// A description of the solutions that the further run traces.
    pub title: String,
    /// The run that can continue from the special point. For a curve in two parameters, the run
    /// lacks the range of the second parameter.
    pub run: Run,
    /// The parameters that can be chosen as the second parameter of a curve, with their usual
    /// ranges; empty for branches, and for curves that continue in the two parameters of another
    /// curve.
    pub second: Vec<Range>,
}

impl Resolution {
    /// Returns the runs that can continue from a special point of a traced branch: the branches
    /// that emanate from the point, and the curve of special points of the same kind in two
    /// parameters.
    ///
    /// ```
    /// use tangency::scene::{BUILT_IN, Scene, execute};
    /// let lure = BUILT_IN.iter().find(|scene| scene.name == "lure").expect("a scene");
    /// let scene = Scene::parse(lure.text)?;
    /// let document = execute(&scene, None, &mut ()).document;
    /// let branch = &document.branches[0];
    /// let hopf = branch.special.iter().find(|it| it.kind.letters() == "HB").expect("a Hopf point");
    /// let all = scene.resolve(None)?.follow_ups(branch, hopf.label);
    /// let titles: Vec<&str> = all.iter().map(|it| it.title.as_str()).collect();
    /// assert_eq!(titles, ["orbits", "curve of Hopf points in two parameters"]);
    /// # Ok::<(), tangency::scene::SceneError>(())
    /// ```
    pub fn follow_ups(&self, branch: &Branch, label: usize) -> Vec<FollowUp> {
        let named = self.runs.iter().find(|resolved| resolved.run.name == branch.name);
        let (Some(resolved), Some(point)) = (named, branch.labelled(label)) else {
            return Vec::new();
        };
        let run = &resolved.run;
        // Points of local maps, and curves from them, have runs of their own.
        if !point.converged || run.local.is_some() || run.along.is_empty() {
            return Vec::new();
        }
        let nth = branch.of_kind(point.kind).position(|it| it.label == label).unwrap_or_default();
        let is_here = |run: &Run| match run.start {
            Start::From { kind, nth: own, .. } => (kind, own) == (point.kind, nth),
            _ => false,
        };
        let switched = following(self, run, branch, &[point.kind]).into_iter();
        let switched = switched.filter(is_here).map(|run| {
            let title = title_of(&run, point);
            FollowUp { title, run, second: Vec::new() }
        });
        let mut all: Vec<FollowUp> = switched.collect();
        all.extend(self.curve(run, (branch, point), nth));
        all.iter_mut().for_each(|it| it.run.name = self.unused(&it.run.name));
        all
    }

    /// Returns a run along the curve of special points of the same kind as a given special point on
    /// a branch of solutions; `None` if such a curve cannot be traced.
    fn curve(
        &self,
        run: &Run,
        (branch, point): (&Branch, &SpecialPoint),
        nth: usize,
    ) -> Option<FollowUp> {
        let kind = point.kind;
        let is_known = catalogue::of_curves().contains(&kind) && point.multiplicity == 1;
        if branch.condition.is_some() || !is_known {
            return None;
        }
        let number =
            if branch.of_kind(kind).count() > 1 { (nth + 1).to_string() } else { String::new() };
        let start = Start::From {
            run: run.name.clone(),
            kind,
            nth,
            switch: false,
            which: 0,
            unconverged: false,
        };
        let mut set = run.set.clone();
        set.extend(orbits_of(self, run));
        let name = format!("{}-{kind}{number}-curve", run.name);
        let direction = Way::Both;
        let run = Run { name, start, set, hold: Some(kind), direction, ..run.clone() };
        let values = branch.parameters.iter().zip(&point.parameters);
        let others = values.filter(|(name, _)| !branch.released.contains(name));
        let second: Vec<Range> = others.map(|(name, value)| Range::usual(name, *value)).collect();
        let title = format!("curve of {}s in two parameters", kind.meaning());
        (!second.is_empty()).then_some(FollowUp { title, run, second })
    }

    /// Returns a name that is different from the names of all runs of the scene.
    fn unused(&self, name: &str) -> String {
        let mut name = name.to_string();
        while self.scene().runs.iter().any(|run| run.name == name) {
            name += "'";
        }
        name
    }
}

/// Returns a description of the solutions that a run traces from a special point.
fn title_of(run: &Run, point: &SpecialPoint) -> String {
    match (run.hold, point.kind) {
        (Some(held), _) => format!("curve of {}s", held.meaning()),
        (None, Kind::HB) => "orbits".into(),
        (None, Kind::PD) => "doubled orbits".into(),
        (None, Kind::G) => "orbits beyond the grazing".into(),
        (None, _) => "other branch".into(),
    }
}
