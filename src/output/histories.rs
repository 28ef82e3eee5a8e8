//! Tables of simulated histories and of profiles of special points: comma-separated values, and
//! NumPy arrays.

use super::document::Document;
use super::npz::Npz;
use super::number::significant;
use super::profiles::{Shown, TIME};
use super::table::{Csv, quoted};
use crate::core::continuation::{Branch, SpecialPoint};
use crate::core::problem::{Profile, distinct};

/// A set of profiles over the same abscissa, with the name of their branch and the label of their
/// special point.
struct Course<'a> {
    /// The name of the branch and, if several special points are written, the label of the point.
    place: Vec<String>,
    curves: Vec<&'a Profile>,
}

impl<'a> Course<'a> {
    fn new(place: Vec<String>, points: &'a [SpecialPoint], along: &str) -> Self {
        let all = points.iter().flat_map(|point| &point.profiles);
        Course { place, curves: all.filter(|profile| profile.along == along).collect() }
    }

    /// Returns the histories of a document: for each branch, the set of profiles over time that
    /// forms its history.
    fn histories(document: &'a Document) -> Vec<Self> {
        let of = |branch: &'a Branch| Course::new(vec![branch.name.clone()], &branch.special, TIME);
        document.branches.iter().map(of).collect()
    }

    /// Returns the profiles of special points over time, or over their first abscissa if no point
    /// has profiles over time.
    fn of_points(points: &[Shown<'a>]) -> (&'a str, Vec<Self>) {
        let mut known = points.iter().flat_map(|shown| &shown.point.profiles);
        let along = known.clone().find(|profile| profile.along == TIME).or(known.next());
        let along = along.map_or(TIME, |profile| &profile.along);
        let of = |shown: &Shown<'a>| {
            let place = vec![shown.place.clone(), shown.point.label.to_string()];
            Course::new(place, std::slice::from_ref(shown.point), along)
        };
        (along, points.iter().map(of).collect())
    }
}

/// The values of all profiles of a set at one abscissa; the value is NaN for a state that does not
/// exist in the mode.
struct Row {
    course: usize,
    at: f64,
    state: Vec<f64>,
}

/// Returns the names of all ordinates, and the rows of a table of all sets of profiles. If two rows
/// of the table have the same time, they contain the states just before and just after an event.
fn rows(courses: &[Course]) -> (Vec<String>, Vec<Row>) {
    let names = distinct(courses.iter().flat_map(|course| &course.curves).map(|it| &it.name));
    let mut rows = Vec::new();
    for (course, Course { curves: profiles, .. }) in courses.iter().enumerate() {
        // The number of points of each curve that are already in rows.
        let mut next = vec![0; profiles.len()];
        let first = |next: &[usize]| {
            let times = profiles.iter().zip(next).filter_map(|(it, k)| Some(it.points.get(*k)?[0]));
            times.min_by(f64::total_cmp)
        };
        while let Some(at) = first(&next) {
            let mut state = vec![f64::NAN; names.len()];
            for (profile, next) in profiles.iter().zip(&mut next) {
                let Some(&[t, value]) = profile.points.get(*next) else { continue };
                let column = names.iter().position(|name| *name == profile.name);
                if let Some(column) = column.filter(|_| t == at) {
                    state[column] = value;
                    *next += 1;
                }
            }
            rows.push(Row { course, at, state });
        }
    }
    (names.into_iter().map(String::from).collect(), rows)
}

/// Writes the histories of all branches as comma-separated values: `branch`, `time`, and every
/// state by name. If two rows have the same time, they contain the states just before and just
/// after an event; a cell is empty if the state does not exist in the mode. Numbers in the table
/// have 15 significant digits.
///
/// ```
/// use tangency::scene::{Scene, execute};
/// let scene = Scene::parse("Scene(title: \"t\", problem: Equations(states: [(\"x\", \"-x\")]),
///     runs: [(name: \"r\", start: Simulated(state: [(\"x\", 1)], transient: 0, duration: 1))])")?;
/// let table = tangency::output::histories(&execute(&scene, None, &mut ()).document);
/// assert!(table.starts_with("branch,time,x\nr,0,1\n"), "{table}");
/// let last = table.lines().last().unwrap().rsplit_once(',').unwrap().1;
/// assert!((last.parse::<f64>().unwrap() - (-1.0_f64).exp()).abs() < 1e-9);
/// # Ok::<(), tangency::scene::SceneError>(())
/// ```
pub fn histories(document: &Document) -> String {
    table(&["branch", TIME], &Course::histories(document))
}

/// Writes the profiles of special points as comma-separated values: `branch`, `label`, the abscissa
/// (time if any profile is a history), and every ordinate by name.
pub(super) fn of_points(points: &[Shown]) -> String {
    let (along, courses) = Course::of_points(points);
    table(&["branch", "label", along], &courses)
}

fn table(first: &[&str], courses: &[Course]) -> String {
    let (names, rows) = rows(courses);
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let mut table = Csv::new(first, &[], &names, &[]);
    for Row { course, at, state } in rows {
        let cell = |value: f64| if value.is_nan() { String::new() } else { significant(value, 15) };
        let place = courses[course].place.iter().map(|word| quoted(word));
        table.row(place.chain([significant(at, 15)]).chain(state.into_iter().map(cell)));
    }
    table.0
}

/// Returns the histories as an archive of NumPy arrays: `time` and every state by name, with NaN
/// where the state does not exist in the mode. If the document contains several branches, each
/// array name is preceded by the name of its branch, as in `r/time`.
pub(super) fn arrays(document: &Document) -> Result<Vec<u8>, String> {
    archive(TIME, &Course::histories(document))
}

/// Returns the profiles of special points as an archive of NumPy arrays, with the same columns as
/// the table that [`of_points`] writes. For several special points, each array name is preceded by
/// the branch and the label, as in `r/2/time`.
pub(super) fn arrays_of_points(points: &[Shown]) -> Result<Vec<u8>, String> {
    let (along, courses) = Course::of_points(points);
    archive(along, &courses)
}

fn archive(along: &str, courses: &[Course]) -> Result<Vec<u8>, String> {
    let (names, rows) = rows(courses);
    let mut archive = Npz::new();
    for (index, Course { place, .. }) in courses.iter().enumerate() {
        let own = || rows.iter().filter(|row| row.course == index);
        let name = |column: &str| match courses.len() {
            1 => column.to_string(),
            _ => format!("{}/{column}", place.join("/")),
        };
        archive.add(&name(along), own().map(|row| row.at))?;
        for (k, column) in names.iter().enumerate() {
            archive.add(&name(column), own().map(|row| row.state[k]))?;
        }
    }
    archive.finish()
}
