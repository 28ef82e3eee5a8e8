//! The command line that computes the same result as the page.

use super::library::Library;
use super::opened::Opened;
use super::setup::Setup;
use crate::core::cancel::CancelToken;

/// Returns the `tangency trace` command that computes the same result as the page: from the opened
/// scene, from an example with its request, or otherwise from the scene file that the page saves.
pub(super) fn command(setup: &Setup, library: &Library, opened: Option<&Opened>) -> String {
    let opened = opened.filter(|opened| opened.setup.text == setup.text);
    let opened = opened.map(|opened| opened.place.clone());
    let example = || {
        let scenes = library.catalogue.scenes().iter();
        scenes.clone().find(|scene| scene.text == setup.text).map(|scene| scene.name.clone())
    };
    let place = opened.or_else(example).filter(|_| setup.runs.is_empty());
    let mut words = vec!["tangency".into(), "trace".into()];
    match place {
        Some(place) => {
            words.push(quoted(&place));
            let options = setup.request(&CancelToken::default()).options().into_iter();
            words.extend(options.map(|(option, value)| format!("{option} {}", quoted(&value))));
        }
        None => words.push(quoted(&format!("{}.ron", setup.file_name()))),
    }
    let following = setup.following().into_iter();
    let following = following.flat_map(|it| it.options());
    words.extend(following.map(|(option, value)| format!("{option} {}", quoted(&value))));
    words.join(" ")
}

/// Quotes a word for a shell if the word contains special characters.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_-./=,+:@%".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.into(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}
