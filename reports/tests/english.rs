//! Promise: text is plain English. Documents, help, messages and comments have none of the turns that readers stumbled over.

use std::path::Path;
use tangency_reports::prose::{Paragraph, Source, drawn, paragraphs};

/// Turns that are not used, and better ones.
const TURNS: [(&str, &str); 29] = [
    ("anyhow", "leave the word out"),
    ("are said", "name who says so, or state the fact"),
    ("are to be", "must be, or will be"),
    ("are told", "are given, are reported"),
    ("as it may", "state the condition"),
    ("asked for", "requested, or name the request"),
    ("asked of", "requested from, required of"),
    ("by misfortune", "by chance, or in rare cases"),
    ("come out", "are, result in"),
    ("comes out", "is, results in"),
    ("has none", "does not have any"),
    ("is none", "does not count as one; name the thing"),
    ("is said", "name who says so, or state the fact"),
    ("is to be", "must be, or will be"),
    ("is told", "is given, is reported"),
    ("it is said", "state the fact"),
    ("let alone", "and not"),
    ("nobody", "no user, no code"),
    ("none that", "no …"),
    ("of which", "whose, or a sentence of its own"),
    ("so many", "the number"),
    ("stand for", "represent, denote"),
    ("stands for", "represents, denotes"),
    ("that is so", "that holds"),
    ("there are none", "say what is missing"),
    ("there is none", "say what is missing"),
    ("to be edited", "ready to edit"),
    ("told apart", "distinguished"),
    ("what there is", "name the thing"),
];

/// First words that name nothing.
const FIRST: [&str; 6] = ["What ", "Those ", "It ", "That ", "They ", "Whatever "];

fn project() -> Vec<Paragraph> {
    paragraphs(&Path::new(env!("CARGO_MANIFEST_DIR")).join("..")).unwrap()
}

/// Whether a text in lower case has a turn as whole words.
fn has(text: &str, turn: &str) -> bool {
    let at_word = |c: Option<char>| !c.is_some_and(|c| c.is_alphanumeric() || c == '_');
    text.match_indices(turn).any(|(at, _)| {
        at_word(text[..at].chars().next_back()) && at_word(text[at + turn.len()..].chars().next())
    })
}

#[test]
fn turns_that_readers_stumble_over_are_not_used() {
    let mut faults = Vec::new();
    for Paragraph { file, line, text, source } in project() {
        let lower = text.to_lowercase();
        for (turn, better) in TURNS.iter().filter(|(turn, _)| has(&lower, turn)) {
            faults.push(format!("{}:{line}: `{turn}` ({better}): {text}", file.display()));
        }
        let names = [Source::Doc, Source::Help, Source::Document].contains(&source);
        if let Some(word) = FIRST.iter().find(|word| names && text.starts_with(**word)) {
            faults.push(format!("{}:{line}: begins with `{word}`: {text}", file.display()));
        }
    }
    assert!(faults.is_empty(), "{} faults\n{}", faults.len(), faults.join("\n"));
}

/// The command draws equal parts of all sources, and the same sentences for the same seed.
#[test]
fn sentences_are_drawn_from_all_sources() {
    let all = project();
    let sentences = drawn(&all, 200, 7);
    assert_eq!(sentences.len(), 200);
    for source in Source::READ {
        let count = sentences.iter().filter(|(paragraph, _)| paragraph.source == source).count();
        assert_eq!(count, 50, "{source}");
    }
    assert_eq!(sentences, drawn(&all, 200, 7));
    assert_ne!(sentences, drawn(&all, 200, 8));
}

#[test]
fn paragraphs_end_in_sentences() {
    let text = "The first sentence has an end. See Doedel (Int. J. Bif. Chaos 1:493, 1991) for more on that topic. The third has `code`.";
    let source = Source::Document;
    let paragraph = Paragraph { source, file: "a.md".into(), line: 1, text: text.into() };
    assert_eq!(paragraph.sentences().len(), 3, "{:?}", paragraph.sentences());
}
