//! Simulated histories as tables: comma-separated values, and arrays for NumPy.

use super::document::Document;
use super::npz::Npz;
use super::number::significant;
use super::table::{Csv, quoted};
use crate::core::continuation::Branch;
use crate::core::problem::{Profile, distinct};

/// The state at a time of a history; NaN for what a mode lacks.
struct Row<'a> {
    branch: &'a str,
    time: f64,
    state: Vec<f64>,
}

/// The names of all states, and the rows of all histories. Just before and just after an event
/// there are two rows of one time.
fn rows(document: &Document) -> (Vec<String>, Vec<Row<'_>>) {
    let in_time = |branch: &'_ Branch| -> Vec<Profile> {
        let all = branch.special.iter().flat_map(|point| &point.profiles);
        all.filter(|profile| profile.along == "time").cloned().collect()
    };
    let all: Vec<(&str, Vec<Profile>)> =
        document.branches.iter().map(|branch| (branch.name.as_str(), in_time(branch))).collect();
    let names = distinct(all.iter().flat_map(|(_, profiles)| profiles).map(|it| &it.name));
    let mut rows = Vec::new();
    for (branch, profiles) in &all {
        // How many points of each curve are in rows that are there.
        let mut next = vec![0; profiles.len()];
        let first = |next: &[usize]| {
            let times = profiles.iter().zip(next).filter_map(|(it, k)| Some(it.points.get(*k)?[0]));
            times.min_by(f64::total_cmp)
        };
        while let Some(time) = first(&next) {
            let mut state = vec![f64::NAN; names.len()];
            for (profile, next) in profiles.iter().zip(&mut next) {
                let Some(&[t, value]) = profile.points.get(*next) else { continue };
                let column = names.iter().position(|name| *name == profile.name);
                if let Some(column) = column.filter(|_| t == time) {
                    state[column] = value;
                    *next += 1;
                }
            }
            rows.push(Row { branch, time, state });
        }
    }
    (names.into_iter().map(String::from).collect(), rows)
}

/// The histories of all branches as comma-separated values: `branch`, `time`, and every state by
/// name. Just before and just after an event there are two rows of one time; a cell is empty where
/// a mode lacks the state. Numbers have 15 significant digits.
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
    let (names, rows) = rows(document);
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let mut table = Csv::new(&["branch", "time"], &[], &names, &[]);
    for Row { branch, time, state } in rows {
        let cell = |value: f64| if value.is_nan() { String::new() } else { significant(value, 15) };
        let place = [quoted(branch), significant(time, 15)];
        table.row(place.into_iter().chain(state.into_iter().map(cell)));
    }
    table.0
}

/// The histories as an archive of arrays: `time` and every state by name, NaN where a mode lacks the
/// state. Of several branches, each array has the name of its branch before its own, `r/time`.
pub(super) fn arrays(document: &Document) -> Result<Vec<u8>, String> {
    let (names, rows) = rows(document);
    let mut archive = Npz::new();
    for Branch { name: branch, .. } in &document.branches {
        let own = || rows.iter().filter(|row| row.branch == branch);
        let name = |column: &str| match document.branches.len() {
            1 => column.to_string(),
            _ => format!("{branch}/{column}"),
        };
        archive.add(&name("time"), own().map(|row| row.time))?;
        for (k, column) in names.iter().enumerate() {
            archive.add(&name(column), own().map(|row| row.state[k]))?;
        }
    }
    archive.finish()
}
