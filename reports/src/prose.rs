//! The text of the project (documents, help, errors and comments), split into paragraphs and
//! sentences.
//!
//! Tests search the paragraphs for turns of phrase that plain English avoids; the command
//! `tangency-reports sentences` draws random sentences that a reader judges one by one.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// The kind of text from which a paragraph is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The README, the book and the other Markdown files.
    Document,
    /// The help of the command line program.
    Help,
    /// Messages: the texts of `#[error("…")]` attributes, and other string literals of several
    /// words.
    Message,
    /// Titles and labels of reports: string literals of `reports/`.
    Report,
    /// Documentation comments.
    Doc,
    /// Comments in code.
    Comment,
}

impl Source {
    /// The kinds of text from which equal numbers of sentences are drawn.
    pub const READ: [Source; 4] = [Source::Document, Source::Help, Source::Message, Source::Doc];
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Source::Document => "document",
            Source::Help => "help",
            Source::Message => "message",
            Source::Report => "report",
            Source::Doc => "doc comment",
            Source::Comment => "comment",
        })
    }
}

/// A paragraph of text, with its source, its file, the number of its first line, and its text
/// without line breaks.
#[derive(Clone, Debug, PartialEq)]
pub struct Paragraph {
    /// The source.
    pub source: Source,
    /// The path of the file, relative to the root of the project.
    pub file: PathBuf,
    /// The line number at which the paragraph begins, counted from 1.
    pub line: usize,
    /// The text of the paragraph without line breaks.
    pub text: String,
}

/// Returns all paragraphs of the project in a folder.
///
/// # Errors
/// [`io::Error`] if a file cannot be read.
pub fn paragraphs(root: &Path) -> io::Result<Vec<Paragraph>> {
    let mut files = Vec::new();
    for name in ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "docs", "src", "reports/src"] {
        collect(&root.join(name), &mut files)?;
    }
    // Tables of measurements are made by the program.
    files.retain(|path| path.parent().is_none_or(|folder| !folder.ends_with("measured")));
    files.sort();
    let mut all = Vec::new();
    for path in files {
        let read = match path.extension().and_then(|extension| extension.to_str()) {
            Some("md") => markdown,
            Some("rs") => rust,
            _ => continue,
        };
        read(path.strip_prefix(root).unwrap_or(&path), &std::fs::read_to_string(&path)?, &mut all);
    }
    Ok(all)
}

fn collect(path: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    if path.is_dir() {
        for entry in std::fs::read_dir(path)? {
            collect(&entry?.path(), files)?;
        }
    } else if path.exists() {
        files.push(path.to_path_buf());
    }
    Ok(())
}

/// Joins the lines of one source in one file into paragraphs.
struct Joiner<'a> {
    source: Source,
    file: &'a Path,
    line: usize,
    text: String,
    is_code: bool,
}

impl<'a> Joiner<'a> {
    fn new(source: Source, file: &'a Path) -> Self {
        Joiner { source, file, line: 0, text: String::new(), is_code: false }
    }

    /// Adds a line of Markdown to the paragraphs.
    fn take(&mut self, number: usize, line: &str, all: &mut Vec<Paragraph>) {
        let line = line.trim();
        if line.starts_with("```") {
            self.end(all);
            self.is_code = !self.is_code;
            return;
        }
        if self.is_code {
            return;
        }
        let numbered = line.split_once(". ").filter(|(number, _)| number.parse::<u8>().is_ok());
        let item = ["- ", "* ", "> "].iter().find_map(|m| line.strip_prefix(m));
        let item = item.or(numbered.map(|(_, text)| text));
        let is_heading = line.starts_with('#');
        let is_other = line.starts_with('|') || line.starts_with("![") || line.starts_with('<');
        if line.is_empty() || item.is_some() || is_heading || is_other {
            self.end(all);
        }
        if line.starts_with('|') {
            for cell in line.split('|').map(str::trim).filter(|cell| cell.contains(' ')) {
                self.begin(number, cell);
                self.end(all);
            }
        } else if !is_heading && !is_other {
            self.begin(number, item.unwrap_or(line));
        }
    }

    fn begin(&mut self, number: usize, text: &str) {
        if self.text.is_empty() {
            self.line = number;
        } else {
            self.text.push(' ');
        }
        self.text.push_str(text);
    }

    /// Ends the paragraph.
    fn end(&mut self, all: &mut Vec<Paragraph>) {
        let text = std::mem::take(&mut self.text);
        if text.contains(' ') && !is_link(&text) {
            let (source, file, line) = (self.source, self.file.to_path_buf(), self.line);
            all.push(Paragraph { source, file, line, text });
        }
    }
}

/// Returns whether a text consists only of links, like an entry of a table of contents.
fn is_link(text: &str) -> bool {
    let (mut rest, mut outside) = (text, String::new());
    while let Some((before, link)) = rest.split_once('[') {
        let Some((_, target)) = link.split_once("](") else { return false };
        let Some((_, after)) = target.split_once(')') else { return false };
        outside.push_str(before);
        rest = after;
    }
    rest.len() < text.len()
        && !outside.contains(char::is_alphanumeric)
        && !rest.contains(char::is_alphanumeric)
}

fn markdown(file: &Path, text: &str, all: &mut Vec<Paragraph>) {
    let mut joiner = Joiner::new(Source::Document, file);
    for (index, line) in text.lines().enumerate() {
        joiner.take(index + 1, line, all);
    }
    joiner.end(all);
}

fn rust(file: &Path, text: &str, all: &mut Vec<Paragraph>) {
    let lines: Vec<&str> = text.lines().map(str::trim_start).collect();
    // clap takes the help from comments above its attributes.
    let documented = |from: usize| lines[from..].iter().find(|line| !line.starts_with("///"));
    let is_help = |item: &&str| ["#[arg", "#[command"].iter().any(|start| item.starts_with(start));
    let mut joiner = Joiner::new(Source::Doc, file);
    for (index, line) in lines.iter().enumerate() {
        let help = documented(index).is_some_and(is_help);
        let of_doc = if help { Source::Help } else { Source::Doc };
        let doc = line.strip_prefix("///").or(line.strip_prefix("//!"));
        let (source, content) = match (doc, line.strip_prefix("//")) {
            (Some(doc), _) => (of_doc, doc),
            (None, Some(comment)) => (Source::Comment, comment),
            (None, None) => (of_doc, ""),
        };
        if source != joiner.source {
            joiner.end(all);
            joiner.source = source;
        }
        if doc.is_none() {
            joiner.is_code = false;
        }
        joiner.take(index + 1, content, all);
    }
    joiner.end(all);
    messages(file, text, all);
}

/// Returns the string literals of at least six words: shorter literals are mostly parts of
/// messages.
fn messages(file: &Path, text: &str, all: &mut Vec<Paragraph>) {
    let source = if file.starts_with("reports") { Source::Report } else { Source::Message };
    let mut rest = text;
    let mut line = 1;
    while let Some(at) = rest.find(['"', '/', '\'']) {
        line += rest[..at].matches('\n').count();
        let found = &rest[at..];
        let length = if found.starts_with("//") {
            found.find('\n').unwrap_or(found.len())
        } else if let Some(length) = raw(&rest[..at], found) {
            // Raw strings are scenes, equations and patterns.
            length
        } else if found.starts_with('"') {
            let length = literal(found);
            let words = unescaped(&found[1..length.max(2) - 1]);
            let is_prose = ["Scene(", ": [", "Examples:"].iter().all(|mark| !words.contains(mark));
            let count =
                words.split(' ').filter(|word| word.chars().any(char::is_alphabetic)).count();
            if is_prose && count >= 6 {
                let file = file.to_path_buf();
                all.push(Paragraph { source, file, line, text: words });
            }
            length
        } else if found.starts_with('\'') {
            character(found)
        } else {
            1
        };
        line += found[..length].matches('\n').count();
        rest = &found[length..];
    }
}

/// Returns the length of the raw string literal that begins at a quotation mark; `None` if the text
/// before the quotation mark does not end in `r`, `r#`, ….
fn raw(before: &str, found: &str) -> Option<usize> {
    let prefix = before.trim_end_matches('#');
    let name = prefix.strip_suffix('r')?;
    if !found.starts_with('"') || name.ends_with(|c: char| c.is_alphanumeric() || c == '_') {
        return None;
    }
    let end = format!("\"{}", "#".repeat(before.len() - prefix.len()));
    found[1..].find(&end).map(|at| 1 + at + end.len())
}

/// Returns the length of a string literal, including its quotation marks.
fn literal(text: &str) -> usize {
    let mut is_escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            _ if is_escaped => is_escaped = false,
            '\\' => is_escaped = true,
            '"' => return at + 1,
            _ => {}
        }
    }
    text.len()
}

/// Returns the length of a character literal, or 1 for the apostrophe of a lifetime.
fn character(text: &str) -> usize {
    let mut chars = text.char_indices().skip(1);
    match (chars.next(), chars.next(), chars.next()) {
        (Some((_, '\\')), _, Some((at, '\''))) | (Some(_), Some((at, '\'')), _) => at + 1,
        _ => 1,
    }
}

/// Returns the text of a string literal in one line.
fn unescaped(literal: &str) -> String {
    let joined = literal.replace("\\\"", "\"").replace("\\n", " ").replace("\\\n", " ");
    joined.split_whitespace().collect::<Vec<_>>().join(" ")
}

impl Paragraph {
    /// The sentences of the paragraph that have at least four words. In documents and doc comments,
    /// only texts that end with a punctuation mark are sentences: cells of tables, and the two
    /// parts of a sentence around a displayed formula, do not count. In messages, only texts that
    /// contain a verb are sentences, because texts without a verb are parts of messages.
    pub fn sentences(&self) -> Vec<&str> {
        let mut sentences = Vec::new();
        let mut start = 0;
        for (at, _) in self.text.match_indices(['.', '?', '!']) {
            let (before, after) = (&self.text[start..at], &self.text[at + 1..]);
            let last = before.rsplit([' ', '(']).next().unwrap_or_default();
            // Abbreviations are short, or begin with a capital letter: `eq.`, `Int.`
            let letters = last.chars().filter(|c| c.is_alphabetic()).count();
            let least = if last.starts_with(char::is_uppercase) { 4 } else { 3 };
            let word = letters >= least
                || last.ends_with(['`', ')', '*'])
                || last.ends_with(|c: char| c.is_ascii_digit());
            let word = word && !JOURNALS.contains(&last.trim_start_matches('*'));
            let next = after.strip_prefix(' ').and_then(|next| next.chars().next());
            if word && next.is_some_and(|c| c.is_uppercase() || "`[*".contains(c)) {
                sentences.push(self.text[start..=at].trim());
                start = at + 1;
            }
        }
        sentences.push(self.text[start..].trim());
        let ends =
            |sentence: &str| sentence.trim_end_matches(['*', ')']).ends_with(['.', ':', '?', '!']);
        // A displayed formula interrupts the sentence around it.
        let goes_on = |sentence: &str| sentence.starts_with(|c: char| c.is_lowercase() || c == ',');
        sentences.retain(|sentence| {
            let whole = match self.source {
                Source::Document => ends(sentence),
                Source::Doc => ends(sentence) && !goes_on(sentence),
                Source::Message => is_clause(sentence),
                _ => true,
            };
            whole && sentence.split_whitespace().count() >= 4
        });
        sentences
    }
}

/// Abbreviated words in the names of journals, which do not end a sentence.
const JOURNALS: [&str; 16] = [
    "Anal", "Appl", "Chem", "Commun", "Comput", "Differ", "Dynam", "Engng", "Math", "Mech",
    "Numer", "Phys", "Proc", "Softw", "Theor", "Trans",
];

/// Verbs that occur in messages, and imperatives with which the suggested remedies begin.
const VERBS: [&str; 18] = [
    "is", "are", "has", "have", "must", "cannot", "does", "do", "did", "was", "needs", "can",
    "ends", "begins", "starts", "grows", "changes", "contains",
];
const IMPERATIVES: [&str; 20] = [
    "choose", "give", "state", "name", "omit", "start", "use", "take", "lower", "raise", "write",
    "set", "trace", "check", "repeat", "locate", "simulate", "remove", "draw", "define",
];

/// Returns whether a message contains a verb.
fn is_clause(text: &str) -> bool {
    let mut words = text.split(|c: char| !c.is_alphabetic()).filter(|word| !word.is_empty());
    words.clone().next().is_some_and(|first| IMPERATIVES.contains(&first))
        || words.any(|word| VERBS.contains(&word))
}

/// Draws `count` different sentences, in equal numbers from documents, help, messages and doc
/// comments; the same seed draws the same sentences.
pub fn drawn(paragraphs: &[Paragraph], count: usize, mut seed: u64) -> Vec<(&Paragraph, &str)> {
    let mut drawn = Vec::new();
    for (index, source) in Source::READ.into_iter().enumerate() {
        let from = paragraphs.iter().filter(|paragraph| paragraph.source == source);
        let mut all: Vec<(&Paragraph, &str)> = from
            .flat_map(|p| p.sentences().into_iter().map(move |sentence| (p, sentence)))
            .collect();
        for _ in 0..(count + index) / Source::READ.len() {
            if all.is_empty() {
                break;
            }
            seed = next(seed);
            drawn.push(all.swap_remove((seed >> 33) as usize % all.len()));
        }
    }
    drawn
}

/// Returns the next state of Knuth's linear congruential generator (MMIX).
fn next(state: u64) -> u64 {
    state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407)
}
