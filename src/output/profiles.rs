//! Figures of the profiles of special points: mode shapes, time histories, phase portraits.

use super::axis::keep_positive;
use super::diagram::{PERIOD, curve_name, event, has_free_period, stability, style};
use super::document::{Document, Plot};
use super::drawing::hexadecimal;
use super::error::{FigureError, UnknownPoint};
use super::figure::{Figure, Series, Style, Wall};
use super::number::significant;
use super::units::with_prefix;
use crate::core::continuation::{Branch, SpecialPoint};
use crate::core::problem::{Profile, UnknownName, distinct};
use crate::core::system::Kind;

/// The maximum number of orbits in a figure if the special points are chosen by default.
const MOST_ORBITS: usize = 3;
/// The maximum number of curves of solutions other than orbits in a figure, if the special points
/// are chosen by default.
const MOST_CURVES: usize = 8;
/// Two orbits count as different if one of their measures differs by more than this fraction of the
/// range of the measure over all orbits.
const ALIKE: f64 = 0.05;
/// A history counts as closed if the distance between its two ends is below this fraction of the
/// history's range.
const RETURNS: f64 = 1e-6;

/// The kinds of special points whose solutions are drawn by default.
const SHOWN: [Kind; 6] = [Kind::LP, Kind::PD, Kind::TR, Kind::BP, Kind::G, Kind::UZ];

/// The name that selects all special points with profiles.
pub(super) const ALL: &str = "all";

/// A special point whose profiles are drawn, and the name of the curve for this point.
pub(super) struct Shown<'a> {
    pub name: String,
    /// The name of the branch, preceded by the name of its document if several documents are drawn.
    pub place: String,
    branch: &'a Branch,
    pub point: &'a SpecialPoint,
}

impl Shown<'_> {
    fn is_orbit(&self) -> bool {
        let in_time = |profile: &Profile| profile.along == TIME;
        self.branch.column(PERIOD).is_some() && self.point.profiles.iter().any(in_time)
    }

    fn is_array(&self) -> bool {
        is_array(self.point)
    }

    /// Returns the time histories of the states.
    fn histories(&self) -> impl Iterator<Item = &Profile> {
        let is_history = |it: &&Profile| it.along == TIME && it.kicked().is_none();
        self.point.profiles.iter().filter(is_history)
    }

    /// Returns the history of one quantity against another quantity, where each quantity is the time
    /// or a state; `None` if the two histories do not have the same times.
    fn history(&self, x: &str, y: &str) -> Option<Profile> {
        let of = |name: &str| self.histories().find(|history| name == TIME || history.name == name);
        let [from, to] = match x {
            TIME => [of(y)?; 2],
            _ => [of(x)?, of(y)?],
        };
        let pairs = || from.points.iter().zip(&to.points);
        let same = from.points.len() == to.points.len() && pairs().all(|(a, b)| a[0] == b[0]);
        let value = |name: &str, at: &[f64; 2]| at[usize::from(name != TIME)];
        let points = pairs().map(|(a, b)| [value(x, a), value(y, b)]).collect();
        same.then(|| Profile { along: x.into(), name: y.into(), points })
    }

    /// Returns the time at which the drawn histories of an orbit begin if the phase of the orbit is
    /// free: the time of the first reset, or of the maximum of the first state. A history that
    /// begins just after an event keeps its start.
    fn begin(&self) -> Option<f64> {
        let free = has_free_period(self.branch)
            && self.histories().all(|history| returns(&history.points));
        let first = self.histories().next().filter(|_| free)?;
        let resets = self.histories().flat_map(|history| {
            let jumps = jumps(&history.points, &history.points);
            jumps.into_iter().map(|k| history.points[k][0])
        });
        let crest = || Some(first.points.iter().max_by(|a, b| a[1].total_cmp(&b[1]))?[0]);
        resets.min_by(f64::total_cmp).or_else(crest)
    }

    /// Returns a profile as curves: smooth pieces, and dotted lines for the resets between them.
    fn series(&self, profile: &Profile) -> Vec<Series> {
        let points = match self.begin().filter(|_| profile.along == TIME) {
            Some(begin) => begun_at(begin, &profile.points),
            None => profile.points.clone(),
        };
        // The points of a phase portrait are at the times of the histories.
        let same = |history: &&Profile| history.points.len() == points.len();
        let jumps = match profile.along == TIME {
            true => jumps(&points, &points),
            false => {
                let history = self.histories().find(same);
                history.map_or(Vec::new(), |history| jumps(&history.points, &points))
            }
        };
        let mut series = Vec::new();
        let mut add = |style, points: &[[f64; 2]]| {
            series.push(Series::new(&self.name, style, points.iter().copied()));
        };
        let mut from = 0;
        for jump in jumps {
            add(style(self.point.unstable), &points[from..=jump]);
            add(Style::Dotted, &points[jump..=jump + 1]);
            from = jump + 1;
        }
        add(style(self.point.unstable), &points[from..]);
        if let Some(closing) = self.closing(profile) {
            add(Style::Dotted, &closing);
        }
        series
    }

    /// Returns the reset that leads from the end of an orbit with events to its start, as a line in
    /// a phase portrait. A line is returned only if the horizontal coordinate does not change at
    /// the reset: jumps of winding angles are not resets.
    fn closing(&self, profile: &Profile) -> Option<[[f64; 2]; 2]> {
        let [first, last] = [*profile.points.first()?, *profile.points.last()?];
        let is_orbit = self.is_orbit() && !self.branch.itinerary.is_empty();
        let moves = |axis: usize| {
            let values = profile.points.iter().map(|at| at[axis]);
            (last[axis] - first[axis]).abs() > JUMP * range(values)
        };
        (is_orbit && profile.along != TIME && !moves(0) && moves(1)).then_some([last, first])
    }
}

/// Two successive points at the same time are the two ends of a reset if their relative distance
/// exceeds this value.
const JUMP: f64 = 1e-6;

fn range(values: impl Iterator<Item = f64>) -> f64 {
    let [low, high] =
        values.fold([f64::MAX, f64::MIN], |[low, high], value| [low.min(value), high.max(value)]);
    high - low
}

/// Returns the points just before resets of a state: each of these points is followed by a point
/// with the same time and another value of the state.
fn jumps(times: &[[f64; 2]], points: &[[f64; 2]]) -> Vec<usize> {
    let ranges = [0, 1].map(|k| range(points.iter().map(|at| at[k])));
    let moves =
        |k: usize| (0..2).any(|i| (points[k + 1][i] - points[k][i]).abs() > JUMP * ranges[i]);
    let pairs = 0..points.len().saturating_sub(1);
    pairs.filter(|k| times[*k][0] == times[k + 1][0] && moves(*k)).collect()
}

/// Returns whether the last value of a history equals its first value.
fn returns(points: &[[f64; 2]]) -> bool {
    let [Some(first), Some(last)] = [points.first(), points.last()] else {
        return false;
    };
    (last[1] - first[1]).abs() <= RETURNS * range(points.iter().map(|at| at[1]))
}

/// Shifts a periodic history such that it begins at a given time; at the time of a reset, the
/// history begins after the reset. If the values at the two ends of a history differ, the shifted
/// history has a jump there, for example a phase response at an event without a reset.
fn begun_at(time: f64, points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let [Some(first), Some(last)] = [points.first(), points.last()] else { return Vec::new() };
    let after = points.iter().rposition(|at| at[0] == time);
    let begin = after.or_else(|| points.iter().position(|at| at[0] >= time)).unwrap_or(0);
    let at = |point: &[f64; 2], turn: f64| [point[0] - time + turn, point[1]];
    let rest = points[usize::from(returns(points))..=begin]
        .iter()
        .map(|point| at(point, last[0] - first[0]));
    points[begin..].iter().map(|point| at(point, 0.0)).chain(rest).collect()
}

/// The name of the abscissa of time histories.
pub(super) const TIME: &str = "time";

/// Returns the special points whose profiles and fields are shown: the points that the first
/// document names, or the default points.
pub(super) fn shown<'a>(documents: &[(&str, &'a Document)]) -> Result<Vec<Shown<'a>>, FigureError> {
    match documents.first().map(|(_, document)| &document.plot.points) {
        Some(points) if !points.is_empty() => named(documents, points),
        _ => Ok(usual(documents)),
    }
}

/// Returns one figure for each kind of profile, as [`figures`](super::figures) describes; the names
/// of the curves in the diagram are given in the order of their colours.
pub(super) fn profiles(
    documents: &[(&str, &Document)],
    drawn: Vec<String>,
) -> Result<Vec<Figure>, FigureError> {
    let Some((_, first)) = documents.first() else { return Ok(Vec::new()) };
    let plot = &first.plot;
    let shown = shown(documents)?;
    let mut figures: Vec<(&Profile, Figure)> = Vec::new();
    for shown in &shown {
        for profile in &shown.point.profiles {
            let kind = (&profile.along, &profile.name);
            let same = |(p, _): &(&Profile, Figure)| (&p.along, &p.name) == kind;
            let index = figures.iter().position(same).unwrap_or_else(|| {
                let [x, y] = [plot.label(&profile.along), &ordinate(plot, profile)];
                figures.push((profile, Figure::new("", x, y)));
                figures.len() - 1
            });
            figures[index].1.series.extend(shown.series(profile));
        }
    }
    let colours = colours(documents, &shown, drawn);
    figures.iter_mut().for_each(|(_, figure)| figure.colours.clone_from(&colours));
    if plot.profiles.is_empty() && plot.points.is_empty() && shown.iter().any(Shown::is_orbit) {
        // A phase portrait, the history of the first state, and its phase response; arrays of
        // equilibria are drawn, too.
        let mut seen = Vec::new();
        figures.retain(|(profile, _)| {
            let class = (profile.along == TIME, profile.kicked().is_some());
            let new = !seen.contains(&class);
            seen.push(class);
            new || profile.along == Profile::INDEX
        });
    }
    let walls = walls(&figures);
    for (profile, figure) in &mut figures {
        let axes = [&profile.along, &profile.name];
        let of_axes = walls.iter().flat_map(|(state, wall)| {
            (0..2).filter(move |axis| axes[*axis] == state).map(|axis| Wall { axis, ..*wall })
        });
        figure.walls = of_axes.collect();
    }
    let stability_is_known = shown.iter().any(|shown| shown.point.unstable.is_some());
    for (profile, figure) in &mut figures {
        if stability_is_known {
            figure.styles = stability();
        }
        if figure.series.iter().any(|series| series.style == Style::Dotted) {
            // A phase response jumps at any event.
            let meaning = if profile.kicked().is_some() { "event" } else { "reset" };
            figure.styles.push((Style::Dotted, meaning.into()));
        }
    }
    chosen(figures, &plot.profiles)
}

/// Returns a figure of the histories of documents with the given names on its axes, such as a phase
/// portrait of two states; by default the horizontal axis shows the time, and the vertical axis the
/// first state that is not on the horizontal axis. Returns `None` if a name is neither the time nor
/// a state of a history.
pub(super) fn portrait(
    documents: &[(&str, &Document)],
    x: Option<&str>,
    ys: &[&str],
) -> Result<Option<Figure>, FigureError> {
    let Some((_, first)) = documents.first() else { return Ok(None) };
    let shown = named(documents, &[ALL.to_owned()])?;
    let states = distinct(shown.iter().flat_map(Shown::histories).map(|it| &it.name));
    let is_known = |name: &&str| *name == TIME || states.contains(name);
    let x = x.unwrap_or(TIME);
    let usual = states.iter().copied().find(|state| *state != x);
    let ys: Vec<&str> = if ys.is_empty() { usual.into_iter().collect() } else { ys.to_vec() };
    if ys.is_empty() || !std::iter::once(&x).chain(&ys).all(is_known) {
        return Ok(None);
    }
    let plot = &first.plot;
    let labels = ys.iter().map(|y| plot.label(y)).collect::<Vec<_>>().join(", ");
    let mut figure = Figure::new(&first.title, plot.label(x), labels);
    let drawn = shown.iter().flat_map(|shown| ys.iter().map(move |y| (shown, *y)));
    for (shown, y) in drawn {
        let Some(profile) = shown.history(x, y) else { continue };
        let curve = match (documents.len(), ys.len()) {
            (_, 1) => shown.place.clone(),
            (1, _) => y.to_owned(),
            _ => format!("{}: {y}", shown.place),
        };
        let renamed = |series: Series| Series { name: curve.clone(), ..series };
        figure.series.extend(shown.series(&profile).into_iter().map(renamed));
    }
    figure.logarithmic = [plot.is_logarithmic(x), ys.iter().all(|y| plot.is_logarithmic(y))];
    keep_positive(&mut figure);
    if figure.series.iter().any(|series| series.style == Style::Dotted) {
        figure.styles.push((Style::Dotted, "reset".into()));
    }
    Ok(Some(figure))
}

/// Returns the names of the curves of special points in the order of their colours, which are the
/// same in all figures of profiles: the first special point of a branch has the colour of the branch
/// in the diagram, and each further point a colour that no branch has, as long as there are such
/// colours.
fn colours(
    documents: &[(&str, &Document)],
    shown: &[Shown],
    mut colours: Vec<String>,
) -> Vec<String> {
    let mut taken = vec![false; colours.len()];
    let mut further = Vec::new();
    for Shown { name, branch, .. } in shown {
        let curve = curve_name(documents, branch);
        match colours.iter().position(|colour| curve.as_ref() == Some(colour)) {
            Some(place) => (colours[place], taken[place]) = (name.clone(), true),
            None => further.push(name),
        }
    }
    for name in further {
        let free = taken.iter().rposition(|taken| !taken);
        match free.filter(|_| colours.len() >= hexadecimal().len()) {
            Some(place) => (colours[place], taken[place]) = (name.clone(), true),
            None => {
                colours.push(name.clone());
                taken.push(true);
            }
        }
    }
    colours
}

/// Returns the label of the vertical axis of a profile.
fn ordinate(plot: &Plot, profile: &Profile) -> String {
    let label = plot.label(&profile.name);
    match profile.kicked().filter(|_| label == profile.name) {
        Some(state) => format!("phase response to {state}"),
        None => label.to_owned(),
    }
}

/// Returns the walls in a phase portrait, each with the state that the wall bounds: at a wall, the
/// motion is reset along a line on which this state is constant, and the state does not go beyond
/// the line. A line counts as a wall only if at least two different resets lie on it, because the
/// largest value of any state on an orbit with a single reset may occur at this reset, even without
/// a wall.
fn walls(figures: &[(&Profile, Figure)]) -> Vec<(String, Wall)> {
    let mut walls: Vec<(String, Wall)> = Vec::new();
    for (profile, figure) in figures.iter().filter(|(profile, _)| profile.along != TIME) {
        let resets = figure.series.iter().filter(|series| series.style == Style::Dotted);
        let resets: Vec<[[f64; 2]; 2]> =
            resets.map(|reset| [reset.points[0], reset.points[1]]).collect();
        for (axis, state) in [&profile.along, &profile.name].into_iter().enumerate() {
            let values = |axis: usize| {
                figure.series.iter().flat_map(|it| &it.points).map(move |at| at[axis])
            };
            let [near, apart] = [axis, 1 - axis].map(|axis| JUMP * range(values(axis)));
            let along = |[from, to]: &&[[f64; 2]; 2]| (to[axis] - from[axis]).abs() <= near;
            for [from, _] in resets.iter().filter(along) {
                let at = from[axis];
                let here = |[other, _]: &&[[f64; 2]; 2]| (other[axis] - at).abs() <= near;
                let differs =
                    |[other, _]: &[[f64; 2]; 2]| (other[1 - axis] - from[1 - axis]).abs() > apart;
                let known = walls
                    .iter()
                    .any(|(known, wall)| known == state && (wall.at - at).abs() <= near);
                if known || !resets.iter().filter(along).filter(here).any(differs) {
                    continue;
                }
                let beyond = |side: f64| values(axis).any(|value| side * (value - at) > near);
                let side = [1.0, -1.0].into_iter().find(|side| !beyond(*side) && beyond(-side));
                walls.extend(side.map(|side| (state.clone(), Wall { axis, at, side })));
            }
        }
    }
    walls
}

/// Returns the figures of the requested kinds of profiles, in the requested order; by default all
/// figures. The figure of a phase response is always included, because a phase response is computed
/// only if a setting requests it.
fn chosen(
    mut figures: Vec<(&Profile, Figure)>,
    kinds: &[(String, String)],
) -> Result<Vec<Figure>, FigureError> {
    if kinds.is_empty() || figures.is_empty() {
        return Ok(figures.into_iter().map(|(_, figure)| figure).collect());
    }
    let response = figures.iter().find(|(profile, _)| profile.kicked().is_some());
    let response = response.map(|(profile, _)| (profile.along.clone(), profile.name.clone()));
    let is_response = |(_, name): &(String, String)| name.starts_with(Profile::PHASE_RESPONSE);
    let more = response.filter(|_| !kinds.iter().any(is_response));
    let written = |along: &str, name: &str| format!("{name} along {along}");
    let mut found = Vec::new();
    for (along, name) in kinds.iter().chain(&more) {
        let meant = |(p, _): &(&Profile, Figure)| (&p.along, &p.name) == (along, name);
        match figures.iter().position(meant) {
            Some(index) => found.push(figures.remove(index).1),
            None => {
                let known = figures.iter().map(|(p, _)| written(&p.along, &p.name));
                let unknown = UnknownName::new("profile", written(along, name), known);
                return Err(FigureError::UnknownProfile(unknown));
            }
        }
    }
    Ok(found)
}

/// Returns the special points whose profiles are drawn by default.
fn usual<'a>(documents: &[(&str, &'a Document)]) -> Vec<Shown<'a>> {
    let mut shown: Vec<Shown> = Vec::new();
    for (document, content) in documents {
        let plot = &content.plot;
        for branch in content.branches.iter().filter(|branch| branch.condition.is_none()) {
            let points = interesting(branch).into_iter();
            let points = points.filter(|point| point.converged && has_curves(point));
            shown.extend(points.map(|point| {
                let place = place(documents, document, branch);
                Shown { name: name(plot, &place, branch, point), place, branch, point }
            }));
        }
    }
    match shown.iter().all(|it| it.is_orbit() || it.is_array()) {
        true => different(shown),
        false => {
            shown.truncate(MOST_CURVES);
            shown
        }
    }
}

/// Returns the first few orbits that differ from each other; orbits at ends of branches are
/// considered after all other orbits.
fn different(mut orbits: Vec<Shown>) -> Vec<Shown> {
    orbits.sort_by_key(|shown| matches!(shown.point.kind, Kind::EP | Kind::MX));
    let of = |shown: &Shown, name: &str| shown.point.value(shown.branch.column(name)?);
    let names: Vec<String> =
        orbits.iter().flat_map(|shown| shown.branch.monitors.clone()).collect();
    let measures =
        |name: &&String| *name == PERIOD || name.starts_with("max_") || name.starts_with("min_");
    let names = match names.iter().any(|name| measures(&name)) {
        true => distinct(names.iter().filter(measures)),
        false => distinct(&names),
    };
    let range = |name: &str| {
        let values = || orbits.iter().filter_map(|shown| of(shown, name));
        values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
    };
    let measures: Vec<(String, f64)> =
        names.into_iter().map(|name| (name.to_owned(), range(name))).collect();
    let mut chosen: Vec<Shown> = Vec::new();
    for orbit in orbits {
        let differs = |other: &Shown| {
            measures.iter().any(|(name, range)| match (of(&orbit, name), of(other, name)) {
                (Some(a), Some(b)) => (a - b).abs() > ALIKE * range,
                (a, b) => a.is_some() != b.is_some(),
            })
        };
        if chosen.len() < MOST_ORBITS && chosen.iter().all(differs) {
            chosen.push(orbit);
        }
    }
    chosen
}

/// Returns whether a special point has profiles or fields.
fn has_curves(point: &SpecialPoint) -> bool {
    !(point.profiles.is_empty() && point.fields.is_empty())
}

/// Returns whether the profiles of a special point show the elements of arrays of unknowns.
fn is_array(point: &SpecialPoint) -> bool {
    !point.fields.is_empty() || point.profiles.iter().any(|profile| profile.along == Profile::INDEX)
}

/// Returns the special points of a branch whose profiles are shown by default.
fn interesting(branch: &Branch) -> Vec<&SpecialPoint> {
    let special = || branch.special.iter();
    let users = || special().filter(|point| point.kind == Kind::UZ);
    if special().any(|point| !point.mesh.is_empty() || is_array(point)) {
        let last = special().next_back().map(|last| last.label);
        // At a Hopf point an orbit has no size.
        let ends = |point: &SpecialPoint| Some(point.label) == last && point.kind != Kind::HB;
        let own = |point: &&SpecialPoint| SHOWN.contains(&point.kind) || ends(point);
        return special().filter(own).collect();
    }
    match users().next() {
        Some(_) => {
            special().find(|point| point.kind == Kind::EP).into_iter().chain(users()).collect()
        }
        None => Vec::new(),
    }
}

/// Returns the special points named as `LABEL`, `BRANCH/LABEL`, `KIND` or `BRANCH/KIND`, in all
/// documents that contain them, or all points with profiles.
pub(super) fn named<'a>(
    documents: &[(&str, &'a Document)],
    names: &[String],
) -> Result<Vec<Shown<'a>>, FigureError> {
    let mut shown = Vec::new();
    if names.iter().any(|name| name == ALL) {
        let points = documents.iter().flat_map(|(document, all)| {
            all.branches.iter().flat_map(move |branch| {
                let place = place(documents, document, branch);
                branch.special.iter().map(move |point| (&all.plot, place.clone(), branch, point))
            })
        });
        return Ok(points
            .filter(|(_, _, _, point)| has_curves(point))
            .map(|(plot, place, branch, point)| Shown {
                name: name(plot, &place, branch, point),
                place,
                branch,
                point,
            })
            .collect());
    }
    for wanted in names {
        let (branch, label) = match wanted.rsplit_once('/') {
            Some((branch, label)) => (Some(branch), label),
            None => (None, wanted.as_str()),
        };
        let (branch, label) = (branch.map(str::trim), label.trim());
        let before = shown.len();
        let mut missing = None;
        for named in documents {
            let found = match label.parse() {
                Ok(label) => named.1.special_point(branch, label).map(|found| vec![found]),
                Err(_) => of_kind(named.1, branch, label, wanted),
            };
            missing = missing.or(found.as_ref().err().cloned());
            for (branch, point) in found.into_iter().flatten() {
                let place = place(documents, named.0, branch);
                let name = name(&named.1.plot, &place, branch, point);
                if shown.iter().all(|known: &Shown| known.name != name) {
                    shown.push(Shown { name, place, branch, point });
                }
            }
        }
        if let (Some(error), true) = (missing, shown.len() == before) {
            return Err(error.into());
        }
    }
    Ok(shown)
}

/// Returns all special points of a document, or of one of its branches, whose kind has the given
/// letters.
fn of_kind<'a>(
    document: &'a Document,
    branch: Option<&str>,
    letters: &str,
    wanted: &str,
) -> Result<Vec<(&'a Branch, &'a SpecialPoint)>, UnknownPoint> {
    let branches = match branch {
        Some(name) => vec![document.branch(name)?],
        None => document.branches.iter().collect::<Vec<&Branch>>(),
    };
    let points = branches.into_iter();
    let points = points.flat_map(|it| it.special.iter().map(move |point| (it, point)));
    let meant =
        |(_, point): &(&Branch, &SpecialPoint)| point.kind.letters().eq_ignore_ascii_case(letters);
    let found: Vec<_> = points.filter(meant).collect();
    if found.is_empty() { Err(UnknownPoint::Form(wanted.into())) } else { Ok(found) }
}

/// Returns the name of the branch of a special point, preceded by the name of its document if
/// several documents are drawn.
fn place(documents: &[(&str, &Document)], document: &str, branch: &Branch) -> String {
    match documents.len() {
        1 => branch.name.clone(),
        _ => format!("{document}: {}", branch.name),
    }
}

/// Returns the name of the curve for a special point: branch, label, kind (or the user-defined
/// event), and the continuation parameter.
fn name(plot: &Plot, place: &str, branch: &Branch, point: &SpecialPoint) -> String {
    let kind = match point.kind {
        Kind::UZ => event(plot, point),
        kind => kind.to_string(),
    };
    // A user's point of the parameter has its value already.
    let says = |name: &&String| kind.strip_prefix(&***name).is_some_and(|it| it.starts_with(" = "));
    let released = branch.released.first().filter(|name| !says(name));
    let value = released.and_then(|name| {
        let value = point.value(branch.column(name)?)?;
        let shown = with_prefix(significant(value, 6).parse().ok()?, plot.label(name));
        Some(format!(", {name} = {}", shown.unwrap_or_else(|| significant(value, 6))))
    });
    format!("{place}/{} {kind}{}", point.label, value.unwrap_or_default())
}
