//! Lists the scenes that come with the program.

use std::path::{Path, PathBuf};

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    list_scenes();
}

/// Writes the names and texts of all scenes as Rust: a file in `scenes` is a scene of the program.
fn list_scenes() {
    let root = PathBuf::from(std::env::var("CARGO_MANIFEST_DIR").expect("set by Cargo"));
    let scenes = listed(&root.join("scenes"), &[]);
    // A model that is built in as Rust, too, has its name already.
    let library = listed(&root.join("scenes/library"), &scenes);
    let list = |name: &str, doc: &str, scenes: &[(String, PathBuf)]| {
        let entry = |(name, path): &(String, PathBuf)| {
            format!("    BuiltIn {{ name: {name:?}, text: include_str!({path:?}) }},\n")
        };
        let entries: String = scenes.iter().map(entry).collect();
        format!("/// {doc}\npub const {name}: &[BuiltIn] = &[\n{entries}];\n")
    };
    let text = list("BUILT_IN", "The devices and examples, by name.", &scenes)
        + &list("LIBRARY", "Models of the literature, stated as text, by name.", &library);
    let out = PathBuf::from(std::env::var("OUT_DIR").expect("set by Cargo"));
    std::fs::write(out.join("scenes.rs"), text).expect("the list of scenes can be written");
}

/// The names and paths of the scenes in a folder, but for some names.
fn listed(folder: &Path, taken: &[(String, PathBuf)]) -> Vec<(String, PathBuf)> {
    println!("cargo::rerun-if-changed={}", folder.display());
    let paths = std::fs::read_dir(folder).expect("a folder of scenes").flatten();
    let scene = |path: PathBuf| {
        let name = path.file_stem()?.to_str()?.to_string();
        let is_scene = path.extension().is_some_and(|ending| ending == "ron");
        let is_taken = taken.iter().any(|(other, _)| *other == name);
        (is_scene && !is_taken).then_some((name, path))
    };
    let mut scenes: Vec<_> = paths.filter_map(|entry| scene(entry.path())).collect();
    scenes.sort();
    scenes
}
