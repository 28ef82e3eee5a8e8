//! Comparing two traces of a scene: the rules are stated in `main.rs`.

use super::Traced;
use super::branch::{MESH_ERROR, is_unresolved, mesh_error, named, range};
use super::variant::Claim;
use std::collections::BTreeSet;
use tangency::core::continuation::{Branch, End, Point, SpecialPoint};
use tangency::core::system::Kind;
use tangency::scene::Scene;

/// Partners are no farther apart than this, in units of the columns' ranges.
pub const SAME_POINT: f64 = 0.02;

/// Stated errors are estimates: they hold up to this factor.
pub const ESTIMATE: f64 = 2.0;

/// How far columns without a stated error may differ, in units of their ranges.
pub const OTHER: f64 = 1e-6;

/// How far points of a local map may differ, in units of the range: their errors are those on the
/// map, and not the map's.
pub const LOCAL_MAP: f64 = 1e-9;

/// An ordinary point this near to a special one says nothing about stability.
const AT_SPECIAL: f64 = 1e-7;

/// Columns that are nothing but rounding have no smaller range than this.
const LEAST_RANGE: f64 = 1e-6;

/// What comparisons have found.
#[derive(Clone, Debug, Default)]
pub struct Comparison {
    /// How many special points were compared.
    pub points: usize,
    pub missing: usize,
    pub extra: usize,
    pub beyond: usize,
    pub unstable: usize,
    /// Everything that is wrong, in words.
    pub wrong: Vec<String>,
    /// The largest difference of continued parameters, in units of the stated errors.
    pub worst: f64,
    /// How many scenes stopped with an error in both traces.
    pub refused: usize,
}

impl Comparison {
    pub fn add(&mut self, other: Comparison) {
        self.refused += other.refused;
        self.points += other.points;
        self.missing += other.missing;
        self.extra += other.extra;
        self.beyond += other.beyond;
        self.unstable += other.unstable;
        self.wrong.extend(other.wrong);
        self.worst = self.worst.max(other.worst);
    }
}

/// Compares all branches of two traces.
pub fn compare(
    scene: &Scene,
    reference: &Traced,
    found: &Traced,
    claim: &Claim,
    into: &mut Comparison,
) {
    let words = |error: &Option<String>| error.clone().unwrap_or("none".into());
    match (&reference.1, &found.1) {
        (None, None) => {}
        (Some(_), Some(_)) => into.refused += 1,
        (before, now) => {
            into.wrong.push(format!("error: {}, was {}", words(now), words(before)));
        }
    }
    for branch in &reference.0 {
        match found.0.iter().find(|other| other.name == branch.name) {
            Some(other) => {
                let run = scene.runs.iter().find(|run| run.name == branch.name);
                let of_a_map = run.is_some_and(|run| run.local.is_some());
                let pair = Pair::new(branch, other, &reference.0, claim);
                Pair { of_a_map, ..pair }.compare(into);
            }
            None => {
                into.missing += branch.special.len();
                let all = branch.special.iter().map(|s| s.kind.to_string());
                let all: Vec<String> = all.collect();
                let name = &branch.name;
                into.wrong
                    .extend(all.iter().map(|kind| format!("{name}: no branch, and no {kind}")));
            }
        }
    }
    for branch in &found.0 {
        if !reference.0.iter().any(|other| other.name == branch.name) {
            into.wrong.push(format!("{}: a branch that was not there", branch.name));
        }
    }
}

/// Two branches that should be one.
struct Pair<'a> {
    a: &'a Branch,
    b: &'a Branch,
    claim: &'a Claim,
    /// Whether they are made of points of a local map.
    of_a_map: bool,
    /// The range of each column of `a`, on all branches of the scene.
    ranges: Vec<f64>,
    /// The column of the continued parameter.
    first: usize,
    /// Columns that say something of the solution and not of its discretisation, as positions on
    /// `a` and on `b`.
    columns: Vec<[usize; 2]>,
}

impl<'a> Pair<'a> {
    fn new(a: &'a Branch, b: &'a Branch, all: &[Branch], claim: &'a Claim) -> Self {
        let range = |name: &str| {
            let ranges = all.iter().filter_map(|branch| Some(range(branch, branch.column(name)?)));
            ranges.fold(LEAST_RANGE, f64::max)
        };
        let ranges = a.columns().map(range).collect();
        let columns = a.columns().enumerate().filter(|(_, name)| *name != MESH_ERROR);
        let columns = columns.filter_map(|(k, name)| Some([k, b.column(name)?])).collect();
        let first = a.column(&a.released[0]).unwrap_or_default();
        Pair { a, b, claim, of_a_map: false, ranges, first, columns }
    }

    fn compare(&self, into: &mut Comparison) {
        let names = |branch: &'a Branch| branch.columns().filter(|name| *name != MESH_ERROR);
        if names(self.a).ne(names(self.b)) {
            let columns = |branch: &'a Branch| names(branch).collect::<Vec<_>>().join(", ");
            let text =
                format!("{}: columns {}, were {}", self.a.name, columns(self.b), columns(self.a));
            into.wrong.push(text);
            return;
        }
        let reversed = self.is_reversed();
        self.compare_ends(reversed, into);
        let partners = self.partners(into);
        for &(i, j) in &partners {
            self.compare_points(&self.a.special[i], &self.b.special[j], into);
        }
        if !self.claim.unstable_unknown {
            self.compare_between(&partners, reversed, into);
        }
    }

    /// How far apart values are, at most, in units of their ranges.
    fn distance(&self, a: impl Fn(usize) -> Option<f64>, b: impl Fn(usize) -> Option<f64>) -> f64 {
        let each = self.columns.iter().map(|&[k, l]| self.column_apart(k, a(k), b(l)));
        each.fold(0.0, f64::max)
    }

    fn column_apart(&self, column: usize, a: Option<f64>, b: Option<f64>) -> f64 {
        match (a, b) {
            (Some(a), Some(b)) if a.is_finite() || b.is_finite() => {
                let apart = (a - b).abs() / self.ranges[column];
                if apart.is_nan() { f64::INFINITY } else { apart }
            }
            _ => 0.0,
        }
    }

    fn apart(&self, a: &SpecialPoint, b: &SpecialPoint) -> f64 {
        self.distance(|k| a.value(k), |k| b.value(k))
    }

    /// Whether the second branch runs the other way.
    fn is_reversed(&self) -> bool {
        let (Some(first), Some(last)) = (self.b.points.first(), self.b.points.last()) else {
            return false;
        };
        let Some(start) = self.a.points.first() else { return false };
        let far = |point: &Point| self.distance(|k| start.value(k), |k| point.value(k));
        far(last) < far(first)
    }

    fn compare_ends(&self, reversed: bool, into: &mut Comparison) {
        let expected = self.a.ends.each_ref().map(named);
        let mut found = self.b.ends.each_ref().map(named);
        if reversed {
            found.reverse();
        }
        if expected != found {
            let ends =
                |branch: &Branch| branch.ends.each_ref().map(|end| end.to_string()).join("; ");
            let text = format!("{}: it ends: {}; was: {}", self.a.name, ends(self.b), ends(self.a));
            into.wrong.push(text);
        }
    }

    /// Whether a kind is looked for under the claim.
    fn is_claimed(&self, special: &SpecialPoint) -> bool {
        let always = [Kind::EP, Kind::MX, Kind::G, Kind::UZ];
        let detect = self.claim.detect.as_ref();
        always.contains(&special.kind) || detect.is_none_or(|kinds| kinds.contains(&special.kind))
    }

    /// A special point in words; parameters have the same columns on both branches.
    fn describe(&self, special: &SpecialPoint) -> String {
        let value = |name: &String| self.a.column(name).and_then(|k| special.value(k));
        let words = |name| format!("{name} = {:.14}", value(name).unwrap_or(f64::NAN));
        let values: Vec<String> = self.a.released.iter().map(words).collect();
        let state = if special.converged { "" } else { ", not converged" };
        format!(
            "{}: {} at {} ± {:.1e}{state}",
            self.a.name,
            special.kind,
            values.join(", "),
            special.error
        )
    }

    /// The pairs of special points that are the same, as positions; what has no partner is noted.
    fn partners(&self, into: &mut Comparison) -> Vec<(usize, usize)> {
        let mut near = Vec::new();
        let mine = self.a.special.iter().enumerate();
        for (i, a) in mine.filter(|(i, s)| self.is_claimed(s) && !is_unresolved(self.a, *i)) {
            let same = self.b.special.iter().enumerate();
            let same = same.filter(|(j, b)| b.kind == a.kind && !is_unresolved(self.b, *j));
            near.extend(same.map(|(j, b)| (self.apart(a, b), i, j)));
        }
        near.retain(|(apart, ..)| *apart <= SAME_POINT);
        near.sort_by(|x, y| x.0.total_cmp(&y.0));
        let mut pairs: Vec<(usize, usize)> = Vec::new();
        for (_, i, j) in near {
            if pairs.iter().all(|(k, l)| *k != i && *l != j) {
                pairs.push((i, j));
            }
        }
        pairs.sort();
        for (i, special) in self.a.special.iter().enumerate() {
            let claimed = self.is_claimed(special) && !is_unresolved(self.a, i);
            if claimed && pairs.iter().all(|(k, _)| *k != i) {
                into.missing += 1;
                let nearest = self.nearest(special);
                into.wrong.push(format!("missing: {}; {nearest}", self.describe(special)));
            }
        }
        // What is not looked for is not found; unclassified points stand for it.
        let stands = |s: &SpecialPoint| self.claim.detect.is_some() && s.kind == Kind::ND;
        for (j, special) in self.b.special.iter().enumerate() {
            let claimed = !stands(special) && !is_unresolved(self.b, j);
            if claimed && pairs.iter().all(|(_, l)| *l != j) {
                into.extra += 1;
                into.wrong.push(format!("extra: {}", self.describe(special)));
            }
        }
        pairs
    }

    /// What is nearest to a special point that has no partner, and in which column they differ
    /// most.
    fn nearest(&self, a: &SpecialPoint) -> String {
        let others = self.b.special.iter().filter(|b| b.kind == a.kind);
        let nearest = others.min_by(|x, y| self.apart(a, x).total_cmp(&self.apart(a, y)));
        let Some(b) = nearest else { return format!("there is no {}", a.kind) };
        let apart = |k: usize, l: usize| self.column_apart(k, a.value(k), b.value(l));
        let column = self.columns.iter().max_by(|x, y| {
            let [x, y] = [x, y].map(|&&[k, l]| apart(k, l));
            x.total_cmp(&y)
        });
        let Some(&[k, l]) = column else { return String::new() };
        let name = self.a.columns().nth(k).unwrap_or_default();
        let values = [a.value(k), b.value(l)].map(|value| value.unwrap_or(f64::NAN));
        format!("the nearest has {name} = {:e} in place of {:e}", values[1], values[0])
    }

    fn compare_points(&self, a: &SpecialPoint, b: &SpecialPoint, into: &mut Comparison) {
        into.points += 1;
        let value = |special: &SpecialPoint| special.value(self.first).unwrap_or(f64::NAN);
        let (x, y) = (value(a), value(b));
        let mesh = [mesh_error(self.a, a), mesh_error(self.b, b)].into_iter().flatten();
        let mesh = mesh.reduce(f64::max);
        let unknown = match (self.claim.on_mesh, mesh) {
            (false, _) => 0.0,
            (true, Some(mesh)) => mesh * x.abs().max(y.abs()),
            // The problem does not say what its discretisation is worth.
            (true, None) => SAME_POINT * self.ranges[self.first],
        };
        let of_map = if self.of_a_map { LOCAL_MAP * self.ranges[self.first] } else { 0.0 };
        let (apart, allowed) = ((x - y).abs(), a.error + b.error + unknown + of_map);
        let share = if apart == 0.0 { 0.0 } else { apart / allowed };
        into.worst = into.worst.max(share);
        if share.is_nan() || share > ESTIMATE {
            into.beyond += 1;
            into.wrong.push(format!(
                "beyond its error by {share:.1}: {}, was {x:.14} ± {:.1e}",
                self.describe(b),
                a.error
            ));
            return self.compare_counts(a, b, into);
        }
        for &[k, l] in &self.columns {
            let apart = self.column_apart(k, a.value(k), b.value(l));
            let size = a.value(k).unwrap_or_default().abs() / self.ranges[k];
            let allowed = OTHER
                + ESTIMATE
                    * (allowed / self.ranges[self.first] + mesh.unwrap_or(0.0) * size.max(1.0));
            if apart > allowed {
                into.beyond += 1;
                let name = self.a.columns().nth(k).unwrap_or_default();
                let values = [(a, k), (b, l)].map(|(s, k)| s.value(k).unwrap_or(f64::NAN));
                into.wrong.push(format!(
                    "{name} is {:.12}, was {:.12}, {apart:.1e} of its range apart, mesh error {:.0e}: {}",
                    values[1],
                    values[0],
                    mesh.unwrap_or(0.0),
                    self.describe(b)
                ));
                break;
            }
        }
        self.compare_counts(a, b, into);
    }

    /// Whether both have converged, and their counts of unstable directions.
    fn compare_counts(&self, a: &SpecialPoint, b: &SpecialPoint, into: &mut Comparison) {
        if a.converged != b.converged {
            let words = if b.converged { "only now" } else { "no more" };
            into.wrong.push(format!("converged {words}: {}", self.describe(b)));
        }
        if let (Some(before), Some(now), false) =
            (a.unstable, b.unstable, self.claim.unstable_unknown)
            && before != now
        {
            into.unstable += 1;
            into.wrong.push(format!("unstable {now}, was {before}: {}", self.describe(b)));
        }
    }

    /// The counts of unstable directions between the same special points.
    fn compare_between(&self, partners: &[(usize, usize)], reversed: bool, into: &mut Comparison) {
        let [in_pairs, in_b] = [0, 1]
            .map(|side| move |i: usize| partners.iter().any(|pair| [pair.0, pair.1][side] == i));
        let mut mine = self.counts((self.a, true), false, in_pairs);
        let theirs = self.counts((self.b, false), reversed, in_b);
        // Between a point that is not looked for and the next one there may be no other.
        let mut gap = 0;
        for (i, special) in self.a.special.iter().enumerate() {
            if in_pairs(i) {
                gap += 1;
            } else if self.claim.detect.is_some() {
                let critical = if matches!(special.kind, Kind::HB | Kind::TR) { 2 } else { 1 };
                let beside = special.unstable.map(|own| [Some(own), Some(own + critical)]);
                mine[gap].extend(beside.into_iter().flatten());
            }
        }
        let last = partners.len();
        for (gap, (a, b)) in mine.iter().zip(&theirs).enumerate() {
            let unresolved = |branch: &Branch, turned: bool| {
                let is_at = |k: usize| gap == if (k == 0) == turned { last } else { 0 };
                (0..2).any(|k| is_at(k) && matches!(branch.ends[k], End::Homoclinic { .. }))
            };
            if unresolved(self.a, false) || unresolved(self.b, reversed) {
                continue;
            }
            let fewer = self.claim.detect.is_some();
            let same = if fewer { b.is_subset(a) } else { a == b };
            if !same && !a.is_empty() && !b.is_empty() {
                into.unstable += 1;
                into.wrong.push(format!(
                    "{}: unstable {b:?}, was {a:?}, after special point {gap}",
                    self.a.name
                ));
            }
        }
    }

    /// The counts on ordinary points before, between and after those special points that have
    /// partners.
    fn counts(
        &self,
        (branch, own): (&Branch, bool),
        reversed: bool,
        has_partner: impl Fn(usize) -> bool,
    ) -> Vec<BTreeSet<Option<usize>>> {
        let partnered: Vec<&SpecialPoint> = (0..branch.special.len())
            .filter(|i| has_partner(*i))
            .map(|i| &branch.special[i])
            .collect();
        let mut gaps = vec![BTreeSet::new(); partnered.len() + 1];
        for (index, point) in branch.points.iter().enumerate() {
            let near = |special: &SpecialPoint| {
                self.columns.iter().all(|&[k, l]| {
                    let at = if own { k } else { l };
                    self.column_apart(k, point.value(at), special.value(at)) <= AT_SPECIAL
                })
            };
            if !branch.special.iter().any(near) {
                let gap = partnered.iter().filter(|special| special.after < index).count();
                gaps[gap].insert(point.unstable);
            }
        }
        if reversed {
            gaps.reverse();
        }
        gaps
    }
}
