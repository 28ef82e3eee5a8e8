//! Promise: scenes of the library have the same special points where each of their states is in
//! another unit, which is stated in `scales`; scenes with events also without `scales`.

use super::variant::Variant;
use super::{Found, differences, points};
use tangency::scene::{Scene, execute};

/// Scenes of all kinds of models that take less than a second each.
const SCENES: [&str; 14] = [
    "bouncing-ball",
    "brusselator",
    "buck-converter",
    "co-oxidation",
    "duffing",
    "fitzhugh-nagumo",
    "integrate-and-fire",
    "lorenz",
    "lure",
    "relay",
    "rocking-block",
    "simplest-walker",
    "soft-stop",
    "two-walls",
];

/// The scenes among them whose models have events.
const WITH_EVENTS: [&str; 8] = [
    "bouncing-ball",
    "buck-converter",
    "integrate-and-fire",
    "relay",
    "rocking-block",
    "simplest-walker",
    "soft-stop",
    "two-walls",
];

/// The fields that give states a rate or a value.
const FIELDS: [&str; 6] =
    ["states: [", "reset: [", "initial: [", "above: [", "below: [", "sliding: ["];

/// The position after the bracket that closes the one at a position. Brackets in strings do not
/// count.
fn closed(text: &str, open: usize) -> usize {
    let (mut depth, mut quoted) = (0, false);
    for (at, c) in text[open..].char_indices() {
        match c {
            '"' => quoted = !quoted,
            '(' | '[' if !quoted => depth += 1,
            ')' | ']' if !quoted => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return open + at + 1;
        }
    }
    panic!("a bracket is not closed: {}", &text[open..]);
}

/// A scene without comments and pictures.
fn plain(text: &str) -> String {
    let lines = text.lines().filter(|line| !line.trim_start().starts_with("//"));
    let mut text = lines.collect::<Vec<_>>().join("\n");
    if let Some(at) = text.find("plot: (") {
        let end = closed(&text, at + "plot: ".len());
        text.replace_range(at..=end, "");
    }
    text
}

/// The states of a scene and their units.
struct Units {
    powers: Vec<i32>,
    states: Vec<String>,
}

impl Units {
    fn of(&mut self, state: &str) -> f64 {
        let known = self.states.iter().position(|name| name == state);
        let k = known.unwrap_or_else(|| {
            self.states.push(state.to_string());
            self.states.len() - 1
        });
        self.powers[k % self.powers.len()].into()
    }

    /// A list of `("state", rate)` in the units of the states, each with another name.
    fn list(&mut self, list: &str) -> String {
        let (mut out, mut at) = (String::new(), 0);
        while let Some(start) = list[at..].find("(\"") {
            let (start, end) = (at + start, closed(list, at + start));
            let (name, value) = list[start + 2..end - 1].split_once("\",").expect("a pair");
            let value = value.trim().trim_matches('"');
            let power = self.of(name);
            out += &list[at..start];
            out += &format!("(\"u_{name}\", \"1e{power}*({value})\")");
            at = end;
        }
        out + &list[at..]
    }
}

/// A scene whose states have other units, which may be stated.
fn in_units(text: &str, powers: &[i32], stated: bool) -> String {
    let mut units = Units { powers: powers.to_vec(), states: Vec::new() };
    let mut text = text.to_string();
    for field in FIELDS {
        let mut at = 0;
        while let Some(found) = text[at..].find(field) {
            let open = at + found + field.len() - 1;
            let end = closed(&text, open);
            let list = units.list(&text[open..end]);
            text.replace_range(open..end, &list);
            at = open + list.len();
        }
    }
    let list = |entry: &dyn Fn(&str, f64) -> String, units: &mut Units| {
        let states = units.states.clone();
        states.iter().map(|name| entry(name, units.of(name))).collect::<Vec<_>>().join(", ")
    };
    let definition = |name: &str, power: f64| format!("(\"{name}\", \"u_{name}/1e{power}\")");
    let scale = |name: &str, power: f64| format!("(\"u_{name}\", \"1e{power}\")");
    let [definitions, scales] = [list(&definition, &mut units), list(&scale, &mut units)];
    match text.find("definitions: [") {
        Some(at) => text.insert_str(at + "definitions: [".len(), &format!("{definitions}, ")),
        None => {
            let problem = text.find("problem: ").expect("a problem");
            let at = problem + text[problem..].find('(').expect("a problem") + 1;
            text.insert_str(at, &format!("definitions: [{definitions}], "));
        }
    }
    let problem = text.find("problem: ").expect("a problem");
    let at = problem + text[problem..].find('(').expect("a problem") + 1;
    if stated {
        text.insert_str(at, &format!("scales: [{scales}], "));
    }
    text
}

fn found(text: &str) -> Result<Vec<Vec<Found>>, String> {
    let scene = Scene::parse(text).map_err(|error| format!("{error}\n{text}"))?;
    let outcome = execute(&scene, None, &mut ());
    if let Some(error) = outcome.error {
        return Err(error.to_string());
    }
    let variant = Variant::default();
    Ok(outcome.document.branches.iter().map(|branch| points(branch, &variant)).collect())
}

/// Compares scenes with the same scenes in other units.
fn compare(names: &[&str], units: &[&[i32]], stated: bool) {
    let mut wrong = Vec::new();
    for name in names {
        let path = format!("{}/scenes/library/{name}.ron", env!("CARGO_MANIFEST_DIR"));
        let text = plain(&std::fs::read_to_string(path).unwrap());
        let here = found(&text).unwrap_or_else(|error| panic!("{name}: {error}"));
        for powers in units {
            let differences = match found(&in_units(&text, powers, stated)) {
                Ok(there) => differences(100.0, &here, &there),
                Err(error) => vec![error],
            };
            wrong.extend(differences.into_iter().map(|it| format!("{name}, {powers:?}: {it}")));
        }
    }
    assert!(wrong.is_empty(), "{} differences:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn scenes_of_the_library_in_other_units() {
    compare(&SCENES, &[&[3], &[-6], &[-6, 4, 6, -3]], true);
}

#[test]
fn scenes_with_events_find_their_scales() {
    compare(&WITH_EVENTS, &[&[-9], &[-6, -3], &[9]], false);
}
