//! The cases: what is run on which files.

mod archive;
mod arguments;
mod document;
mod model;
mod scene;
mod settings;

use super::bases::Bases;
use super::dice::Dice;
use super::report::escaped;
use std::fs::FileType;
use std::path::{Path, PathBuf};

/// What is bad about a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    Scene,
    Settings,
    Model,
    Document,
    Archive,
    Arguments,
}

impl Kind {
    pub const ALL: [Kind; 6] =
        [Kind::Scene, Kind::Settings, Kind::Model, Kind::Document, Kind::Archive, Kind::Arguments];

    /// The kind of a case, by its number: a quarter are scenes, a quarter models.
    pub fn of(number: u64) -> Kind {
        match number % 8 {
            6 => Kind::Scene,
            7 => Kind::Model,
            k => Kind::ALL[k as usize],
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            Kind::Scene => "scene",
            Kind::Settings => "settings",
            Kind::Model => "model",
            Kind::Document => "document",
            Kind::Archive => "archive",
            Kind::Arguments => "arguments",
        }
    }
}

/// A command on some files.
pub struct Case {
    pub number: u64,
    pub kind: Kind,
    /// A folder that holds nothing but that of the files, and what the streams say.
    pub root: PathBuf,
    /// The folder of the files, in which the command runs.
    pub folder: PathBuf,
    pub arguments: Vec<String>,
    /// What a message may name: one of these it must.
    pub subjects: Vec<String>,
    /// Files that are as they were, afterwards.
    pub inputs: Vec<(PathBuf, Vec<u8>)>,
    /// What is neither file nor folder, and remains what it is.
    pub special: Vec<(PathBuf, FileType)>,
}

impl Case {
    /// Makes a case of a seed: its files, and the command.
    pub fn new(bases: &Bases, seed: u64, number: u64, root: &Path) -> std::io::Result<Case> {
        let folder = root.join("work");
        std::fs::create_dir_all(&folder)?;
        let kind = Kind::of(number);
        let mut case = Case {
            number,
            kind,
            root: root.into(),
            folder,
            arguments: Vec::new(),
            subjects: Vec::new(),
            inputs: Vec::new(),
            special: Vec::new(),
        };
        let dice = &mut Dice::new(seed, number);
        match kind {
            Kind::Scene => scene::make(&mut case, bases, dice),
            Kind::Settings => settings::make(&mut case, bases, dice),
            Kind::Model => model::make(&mut case, bases, dice),
            Kind::Document => document::make(&mut case, bases, dice),
            Kind::Archive => archive::make(&mut case, bases, dice),
            Kind::Arguments => arguments::make(&mut case, bases, dice),
        }?;
        // No argument holds the end of a text.
        case.arguments.iter_mut().for_each(|argument| argument.retain(|c| c != '\0'));
        if case.subjects.iter().any(String::is_empty) {
            case.subjects.push("``".into());
        }
        case.subjects.retain(|subject| !subject.is_empty());
        case.subjects.extend(case.subjects.clone().iter().map(|subject| escaped(subject)));
        Ok(case)
    }

    /// Arguments of the command.
    fn arguments<S: AsRef<str>>(&mut self, arguments: &[S]) {
        self.arguments.extend(arguments.iter().map(|text| text.as_ref().to_string()));
    }

    /// An option with its value, either of which a message may name.
    fn option(&mut self, option: &str, value: &str) {
        self.arguments(&[option, value]);
        self.subjects.push(option.into());
        self.subjects
            .extend(value.split(['=', ',', ':']).next().map(|name| name.trim().to_string()));
    }

    /// A file that the command reads, and must not change.
    fn input(&mut self, name: &str, bytes: Vec<u8>) -> std::io::Result<()> {
        self.file(name, &bytes)?;
        self.inputs.push((self.folder.join(name), bytes));
        Ok(())
    }

    /// A file that the command may replace.
    fn file(&mut self, name: &str, bytes: &[u8]) -> std::io::Result<()> {
        let path = self.folder.join(name);
        self.subjects.push(name.into());
        std::fs::create_dir_all(path.parent().unwrap_or(&self.folder))?;
        std::fs::write(path, bytes)
    }

    /// The command, as a shell takes it.
    pub fn in_words(&self) -> String {
        let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=:,+%".contains(c);
        let quoted = self.arguments.iter().map(|argument| {
            if !argument.is_empty() && argument.chars().all(plain) {
                return argument.clone();
            }
            if argument.contains(char::is_control) {
                return format!("$'{}'", argument.escape_debug());
            }
            format!("'{}'", argument.replace('\'', "'\\''"))
        });
        format!("tangency {}", quoted.collect::<Vec<_>>().join(" "))
    }
}
