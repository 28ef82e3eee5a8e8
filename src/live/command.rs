//! The command that is equivalent to a setup.

use super::opened::Opened;
use super::setup::Setup;
use super::shop::Shop;
use crate::scene::Range;

/// Returns the `tangency trace` command with the same result: of the opened scene or an example with
/// its request, or else of the scene as the page saves it.
pub(super) fn command(setup: &Setup, shop: &Shop, opened: Option<&Opened>) -> String {
    let opened = opened.filter(|opened| opened.setup.text == setup.text);
    let opened = opened.map(|opened| opened.place.clone());
    let example = || {
        let scenes = shop.catalogue.scenes().iter();
        scenes.clone().find(|scene| scene.text == setup.text).map(|scene| scene.name.clone())
    };
    let place = opened.or_else(example).filter(|_| setup.runs.is_empty());
    let mut words = vec!["tangency".into(), "trace".into()];
    match place {
        Some(place) => {
            words.push(quoted(&place));
            words.extend(options(setup));
        }
        None => words.push(quoted(&format!("{}.ron", setup.file_name()))),
    }
    if setup.depth > 0 {
        let kinds: Vec<&str> = setup.kinds.iter().map(|kind| kind.letters()).collect();
        let kinds = if kinds.is_empty() { "all".into() } else { kinds.join(",") };
        words.push(format!("--switch {kinds} --depth {}", setup.depth));
    }
    words.join(" ")
}

/// Returns the options of a request.
fn options(setup: &Setup) -> Vec<String> {
    let Setup { set, along, bounds, marks, state, settle, hold, .. } = setup;
    let mut options: Vec<String> = Vec::new();
    let mut add =
        |option: &str, value: String| options.push(format!("{option} {}", quoted(&value)));
    set.iter().for_each(|(name, value)| add("--set", format!("{name}={value}")));
    along.iter().for_each(|it| add("--along", range(it)));
    bounds.iter().for_each(|it| add("--bound", range(it)));
    marks.iter().for_each(|(name, value)| add("--mark", format!("{name}={value}")));
    if !state.is_empty() {
        let states: Vec<String> = state.iter().map(|(name, x)| format!("{name}={x}")).collect();
        add("--start", states.join(","));
    }
    settle.iter().for_each(|time| add("--settle", time.to_string()));
    hold.iter().for_each(|kind| add("--hold", kind.to_string()));
    options
}

fn range(range: &Range) -> String {
    let end = |end: Option<f64>| end.map_or(String::new(), |end| end.to_string());
    format!("{}={}..{}", range.name, end(range.low), end(range.high))
}

/// Quotes a word for a shell, if necessary.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_-./=,+:@%".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.into(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}
