//! The entries of the gallery: all built-in scenes, and the models and scenes in the folders
//! `examples` and `scenes/library` that are not built in.

use std::path::Path;
use tangency::scene::{BUILT_IN, BuiltIn, LIBRARY};

/// An entry of the gallery.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// The name of the entry, and of its files.
    pub name: String,
    /// The section that contains the entry.
    pub section: Section,
    /// The arguments with which `tangency trace` traces the entry.
    pub arguments: &'static str,
    /// The text of the scene or model.
    pub text: &'static str,
    /// The branches to trace, if the entry is a model; `None` if the entry is a scene.
    pub request: Option<Wanted>,
}

/// The branches of a model to trace: one branch, and the branches that emanate from this branch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// The continuation parameter, and the ends of its range.
    pub along: (&'static str, f64, f64),
    /// The number of generations of emanating branches.
    pub depth: usize,
}

/// A section of the gallery.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Section {
    /// Models of the literature, stated as text.
    Literature,
    /// Devices and examples, built into the program as Rust code.
    Devices,
}

impl Section {
    /// All sections, in the order of the gallery.
    pub const ALL: [Section; 2] = [Section::Literature, Section::Devices];

    /// Returns the heading of the section.
    pub fn title(self) -> &'static str {
        match self {
            Section::Literature => "Models of the literature",
            Section::Devices => "Devices and examples",
        }
    }
}

impl Entry {
    /// Returns the entry of a built-in scene.
    fn of(section: Section) -> impl Fn(&BuiltIn) -> Entry {
        move |&BuiltIn { name, text }| Entry {
            name: name.into(),
            section,
            arguments: name,
            text,
            request: None,
        }
    }

    /// Returns the scene or the file that the arguments of the entry name.
    pub fn source(&self) -> &'static str {
        self.arguments.split(' ').next().unwrap_or_default()
    }

    /// Returns the name of the files that `tangency trace` writes.
    pub fn stem(&self) -> &'static str {
        let stem = Path::new(self.source()).file_stem();
        stem.and_then(|stem| stem.to_str()).unwrap_or_default()
    }
}

/// Returns all entries of the gallery: first the models of the literature, then the devices.
pub fn entries() -> Vec<Entry> {
    let file = |name: &str, arguments, text, request| Entry {
        name: name.into(),
        section: Section::Literature,
        arguments,
        text,
        request,
    };
    let files = [
        file(
            "lorenz-model",
            "examples/lorenz.ron --along rho=0..30 --switch all --depth 2",
            include_str!("../../../examples/lorenz.ron"),
            Some(Wanted { along: ("rho", 0.0, 30.0), depth: 2 }),
        ),
        // The name `lure` belongs to the scene whose equations are Rust code.
        file(
            "lure-text",
            "scenes/library/lure.ron",
            include_str!("../../../scenes/library/lure.ron"),
            None,
        ),
    ];
    let library = LIBRARY.iter().map(Entry::of(Section::Literature));
    library.chain(files).chain(BUILT_IN.iter().map(Entry::of(Section::Devices))).collect()
}
