//! Links of pages: each leads to a file and, where it names one, to a heading.

use crate::ROOT;
use crate::page::Page;
use std::path::{Component, Path, PathBuf};

/// All links between files of the project that lead nowhere.
pub fn broken(pages: &[Page]) -> Vec<String> {
    pages
        .iter()
        .flat_map(|page| {
            links(page.text).into_iter().filter_map(move |link| {
                let reason = fault(pages, page, link)?;
                Some(format!("{}: the link `{link}` {reason}", page.name))
            })
        })
        .collect()
}

/// The targets of `[text](target)`, outside of fenced blocks.
fn links(text: &'static str) -> Vec<&'static str> {
    let mut inside = false;
    let prose = text.lines().filter(move |line| {
        if line.starts_with("```") {
            inside = !inside;
        }
        !inside
    });
    // Links inside of code spans are code.
    prose
        .flat_map(|line| line.split('`').step_by(2))
        .flat_map(|part| part.split("](").skip(1).filter_map(|rest| Some(rest.split_once(')')?.0)))
        .filter(|link| !link.contains("://") && !link.starts_with("mailto:"))
        .collect()
}

/// The folder of the interactive gallery, which a command writes.
const GALLERY: &str = "docs/gallery";

fn fault(pages: &[Page], page: &Page, link: &str) -> Option<String> {
    let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
    let folder = Path::new(&page.name).parent().unwrap_or(Path::new(""));
    let target =
        if file.is_empty() { PathBuf::from(&page.name) } else { plain(&folder.join(file)) };
    if page.name.starts_with("docs/") && !target.starts_with("docs") {
        return Some("leaves the book: name the file in place of a link".into());
    }
    let root = Path::new(ROOT);
    // Links into the gallery can be checked only where the gallery has been made.
    if target.starts_with(GALLERY) && !root.join(GALLERY).exists() {
        return None;
    }
    if !root.join(&target).exists() {
        return Some("leads to no file".into());
    }
    if anchor.is_empty() {
        return None;
    }
    let there = pages.iter().find(|page| Path::new(&page.name) == target)?;
    let known = anchors(there.text);
    (!known.iter().any(|heading| heading == anchor)).then(|| "leads to no heading".into())
}

/// The path without `..`.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        if part == Component::ParentDir {
            plain.pop();
        } else {
            plain.push(part);
        }
    }
    plain
}

/// The anchors of all headings, as GitHub makes them.
fn anchors(text: &str) -> Vec<String> {
    let mut inside = false;
    let mut anchors: Vec<String> = Vec::new();
    for line in text.lines() {
        inside ^= line.starts_with("```");
        let title = line.trim_start_matches('#');
        if inside || title.len() == line.len() || !title.starts_with(' ') {
            continue;
        }
        let kept = title.trim().chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
        let base = kept.collect::<String>().to_lowercase().replace(' ', "-");
        let again = anchors.iter().filter(|anchor| **anchor == base).count();
        anchors.push(if again == 0 { base } else { format!("{base}-{again}") });
    }
    anchors
}
