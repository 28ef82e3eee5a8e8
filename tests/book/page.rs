//! Pages of Markdown, their fenced blocks, and texts compared word by word.

use std::error::Error;
use std::path::Path;

/// A page: its path from the root of the project, its text and its fenced blocks.
pub struct Page {
    pub name: String,
    pub text: &'static str,
    pub blocks: Vec<Block>,
}

/// A fenced block: its language and its text, with the last line break.
pub struct Block {
    pub language: &'static str,
    pub text: &'static str,
}

impl Block {
    /// The file that the block shows: its first line is a comment that begins with the file's name.
    pub fn file(&self) -> Option<&str> {
        if ["sh", "text", "console"].contains(&self.language) {
            return None;
        }
        let first = self.text.lines().next()?;
        let comment = ["//", "#", "--"].iter().find_map(|mark| first.strip_prefix(mark))?;
        let name = comment.split_whitespace().next()?;
        let plain = |c: char| c.is_ascii_alphanumeric() || "._-".contains(c);
        let extension = name.rsplit_once('.').is_some_and(|(stem, extension)| {
            !stem.is_empty() && (1..=4).contains(&extension.len())
        });
        (extension && name.chars().all(plain)).then_some(name)
    }

    /// Whether the commands of the block run in the page's folder.
    pub fn is_run(&self) -> bool {
        let of_a_clone = |line: &str| {
            ["cargo ", "python3 benches/", ".ci/", "target/"]
                .iter()
                .any(|start| line.starts_with(start))
        };
        self.language == "sh" && !self.text.starts_with("#!") && !self.text.lines().any(of_a_clone)
    }
}

/// The README and all pages of the book.
pub fn all(root: &Path) -> Result<Vec<Page>, Box<dyn Error>> {
    let mut names = vec!["README.md".to_string(), "CONTRIBUTING.md".into(), "CHANGELOG.md".into()];
    let mut folders = vec![root.join("docs")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder)? {
            let path = entry?.path();
            if path.is_dir() {
                // Tables of measurements are parts of a page.
                if !path.ends_with("measured") {
                    folders.push(path);
                }
            } else if path.extension().is_some_and(|extension| extension == "md") {
                names.push(path.strip_prefix(root)?.display().to_string());
            }
        }
    }
    names[3..].sort();
    names.into_iter().map(|name| read(root, name)).collect()
}

fn read(root: &Path, name: String) -> Result<Page, Box<dyn Error>> {
    // Pages are few, and are needed to the end.
    let text: &'static str = std::fs::read_to_string(root.join(&name))?.leak();
    let blocks = blocks(text).ok_or_else(|| format!("{name}: a block has no end"))?;
    Ok(Page { name, text, blocks })
}

/// All fenced blocks of a page; `None` if the last one has no end.
fn blocks(page: &'static str) -> Option<Vec<Block>> {
    let mut blocks = Vec::new();
    let mut open: Option<(usize, &'static str)> = None;
    let mut position = 0;
    for line in page.split_inclusive('\n') {
        if let Some(language) = line.strip_prefix("```") {
            open = match open {
                None => Some((position + line.len(), language.trim())),
                Some((start, language)) => {
                    blocks.push(Block { language, text: &page[start..position] });
                    None
                }
            };
        }
        position += line.len();
    }
    open.is_none().then_some(blocks)
}

/// The first difference of two texts, word by word. Numbers agree to a relative 1e-6; below 1e-5 they may be rounding.
pub fn difference(shown: &str, found: &str) -> Option<String> {
    let words = |text: &str| -> Vec<String> {
        let words = text.split([' ', '\n', ',', '(', ')', ';', '=', ':']);
        words.filter(|word| !word.is_empty()).map(String::from).collect()
    };
    let (shown, found) = (words(shown), words(found));
    let agree = |a: &str, b: &str| match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs() <= 1e-6 * a.abs().max(b.abs()).max(10.0),
        _ => a == b,
    };
    if let Some((a, b)) = shown.iter().zip(&found).find(|(a, b)| !agree(a, b)) {
        return Some(format!("the page shows `{a}`, and the program prints `{b}`"));
    }
    let (shown, found) = (shown.len(), found.len());
    (shown != found)
        .then(|| format!("the page shows {shown} words, and the program prints {found}"))
}
