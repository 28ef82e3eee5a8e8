//! XPPAUT's `.ode` files. Those in this folder are written after what its manual documents; each
//! stands beside the same model in RON.

mod agreement;
mod mutated;
mod refused;
mod stated;
mod written;

use tangency::language::xpp::{self, Ode};
use tangency::language::{Model, Source};

/// The files of this folder: names, and texts in both languages.
fn files() -> Vec<(String, Source, Source)> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/models/ode");
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "ode") {
            let name = path.file_stem().unwrap().to_string_lossy().into_owned();
            let source = |extension: &str| {
                let text = std::fs::read_to_string(path.with_extension(extension)).unwrap();
                Source::new(format!("{name}.{extension}"), text)
            };
            files.push((name.clone(), source("ode"), source("ron")));
        }
    }
    files.sort_by(|a, b| a.0.cmp(&b.0));
    files
}

/// What a text is read as.
fn read(text: &str) -> Ode {
    xpp::read(&Source::new("", text)).unwrap_or_else(|error| panic!("{error}"))
}

/// The model of a text.
fn model(text: &str) -> Model {
    let source = Source::new("", text);
    let understood = xpp::read(&source).and_then(|read| read.statement.model(&source, &[]));
    understood.unwrap_or_else(|error| panic!("{error}"))
}
