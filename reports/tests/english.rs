//! Promise: text is plain English. Documents, help, messages and comments have none of the turns that readers stumbled over.

use std::path::Path;
use tangency_reports::prose::{Paragraph, Source, drawn, paragraphs};

/// Turns that are not used, and better ones.
const TURNS: &[(&str, &str)] = &[
    ("anyhow", "leave the word out"),
    ("are said", "name who says so, or state the fact"),
    ("are to be", "must be, or will be"),
    ("are told", "are given, are reported"),
    ("as it may", "state the condition"),
    ("as long as `", "of the same length as, or while"),
    ("as theory says", "as the theory predicts"),
    ("asked for", "requested, or name the request"),
    ("asked of", "requested from, required of"),
    ("by misfortune", "by chance, or in rare cases"),
    ("change its sign", "change sign"),
    ("change their sign", "change sign"),
    ("change their signs", "change sign"),
    ("changed its sign", "changed sign"),
    ("changed their signs", "changed sign"),
    ("changes its sign", "changes sign"),
    ("changing its sign", "changing sign"),
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
    ("one after the other", "one after another, in turn"),
    ("reason of the end", "the reason why … ends"),
    ("reasons of the end", "the reasons why … end"),
    ("restitutions", "coefficients of restitution"),
    ("so many", "the number"),
    ("stand for", "represent, denote"),
    ("stands for", "represents, denotes"),
    ("that is so", "that holds"),
    ("there are none", "say what is missing"),
    ("there is none", "say what is missing"),
    ("to be edited", "ready to edit"),
    ("told apart", "distinguished"),
    ("what there is", "name the thing"),
    ("without delay", "immediately"),
];

/// Words after `derivative by` that name a method; before a variable, `with respect to` is clearer.
const METHODS: [&str; 15] = [
    "automatic",
    "central",
    "differences",
    "dual",
    "finite",
    "forward",
    "nested",
    "one-sided",
    "shooting",
    "taylor",
    "the chain",
    "the formula",
    "the linear",
    "the same",
    "the schur",
];

/// First words that name nothing.
const FIRST: [&str; 6] = ["What ", "Those ", "It ", "That ", "They ", "Whatever "];

fn project() -> Vec<Paragraph> {
    paragraphs(&Path::new(env!("CARGO_MANIFEST_DIR")).join("..")).unwrap()
}

/// Whether a text in lower case has a turn as whole words.
fn has(text: &str, turn: &str) -> bool {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let at_word = |c: Option<char>| !c.is_some_and(is_word);
    text.match_indices(turn).any(|(at, _)| {
        at_word(text[..at].chars().next_back())
            && (!turn.ends_with(is_word) || at_word(text[at + turn.len()..].chars().next()))
    })
}

/// Faults of a text in lower case that depend on the words around them, with better turns.
fn faults_of_pairs(text: &str) -> Vec<(String, &'static str)> {
    let mut faults = Vec::new();
    for turn in ["derivative by ", "derivatives by ", "gradient by ", "gradients by "] {
        let mut variables = text.match_indices(turn).map(|(at, _)| &text[at + turn.len()..]);
        if variables.any(|after| METHODS.iter().all(|method| !after.starts_with(method))) {
            faults.push((turn.trim().into(), "with respect to"));
        }
    }
    let mut reasons =
        text.match_indices("not supported: ").map(|(at, found)| &text[at + found.len()..]);
    if reasons.any(|reason| reason.split(". ").next().is_some_and(|r| r.contains("not supported")))
    {
        faults.push(("not supported: … not supported".into(), "a reason"));
    }
    for before in ["after", "by", "in", "with"] {
        for noun in ["cases", "impacts", "minutes", "periods", "seconds", "steps"] {
            let turn = format!("{before} some {noun}");
            if has(text, &turn) {
                faults.push((turn, "a few"));
            }
        }
    }
    faults
}

#[test]
fn turns_that_readers_stumble_over_are_not_used() {
    let mut faults = Vec::new();
    for Paragraph { file, line, text, source } in project() {
        let lower = text.to_lowercase();
        for (turn, better) in TURNS.iter().filter(|(turn, _)| has(&lower, turn)) {
            faults.push(format!("{}:{line}: `{turn}` ({better}): {text}", file.display()));
        }
        for (turn, better) in faults_of_pairs(&lower) {
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

/// Numbers end a sentence; abbreviations in the names of journals do not.
#[test]
fn sentences_end_after_numbers() {
    let text = "The error falls to 1e-11. The order is 3.2 at least, see *SIAM J. Numer. Anal.* 43:1407. Both are \
        measured here.";
    let source = Source::Document;
    let paragraph = Paragraph { source, file: "a.md".into(), line: 1, text: text.into() };
    assert_eq!(paragraph.sentences().len(), 3, "{:?}", paragraph.sentences());
}

/// Raw strings and links without further words are not prose; titles of reports are not messages.
#[test]
fn only_prose_is_read() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [
        (
            "docs/a.md",
            "[The first page](a.md)\n\n| [The next page](b.md) | This cell has words |\n",
        ),
        (
            "src/a.rs",
            "const A: &str = r#\"cut \"a b c d e f g h\" out\"#;\nconst B: &str = \"ab cd ef gh ij kl\";\n",
        ),
        ("reports/src/b.rs", "const C: &str = \"mn op qr st uv wx\";\n"),
    ] {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    let found = paragraphs(folder.path()).unwrap();
    let found: Vec<_> = found.iter().map(|p| (p.source, p.line, p.text.as_str())).collect();
    let expected = [
        (Source::Document, 3, "This cell has words"),
        (Source::Report, 1, "mn op qr st uv wx"),
        (Source::Message, 2, "ab cd ef gh ij kl"),
    ];
    assert_eq!(found, expected);
}
