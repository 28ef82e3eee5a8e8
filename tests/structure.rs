//! Promise: imports go one way, and a type has one job.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The folders and files of `src/core`: each imports only from itself and from those before it.
const LAYERS: [&str; 21] = [
    "spelling",
    "cancel",
    "failure",
    "threads",
    "vectors",
    "scalar",
    "linalg",
    "numerics",
    "problem",
    "ode",
    "hybrid",
    "system",
    "bvp",
    "orbit",
    "equilibrium",
    "bifurcation",
    "continuation",
    "manifold",
    "attractor",
    "local_map",
    "sweep",
];

/// The folders and files of `src`: each imports only from itself and from those before it.
const FOLDERS: [&str; 10] = [
    "core",
    "misread",
    "problems",
    "language",
    "output",
    "scene",
    "robustness",
    "work_precision",
    "live",
    "cli",
];

/// The most methods of a type over all its files, those of the traits that it implements among
/// them.
const MOST_METHODS: usize = 25;

fn src() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

fn core() -> PathBuf {
    src().join("core")
}

/// All source files of a folder with their code, without lines of comments.
fn sources(folder: &Path) -> Vec<(PathBuf, String)> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let files = entries.flat_map(|entry| {
        if entry.is_dir() {
            return sources(&entry);
        }
        let text = fs::read_to_string(&entry).unwrap();
        let code: Vec<&str> =
            text.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
        vec![(entry, code.join("\n"))]
    });
    files.collect()
}

fn layer(name: &str) -> Option<usize> {
    LAYERS.iter().position(|layer| *layer == name)
}

/// The word with which a text begins.
fn word(text: &str) -> &str {
    text.split(|c: char| !(c.is_alphanumeric() || c == '_')).next().unwrap_or_default()
}

/// A circle of imports between folders would need an import that goes up.
#[test]
fn imports_go_one_way() {
    for (file, code) in sources(&core()) {
        let path = file.strip_prefix(core()).unwrap();
        let (depth, first) = (path.components().count(), path.iter().next().unwrap());
        let own = word(first.to_str().unwrap());
        if own == "mod" {
            continue;
        }
        let own_layer = layer(own).unwrap_or_else(|| panic!("{own} has no layer"));
        for import in code.split("crate::core::").skip(1).map(word) {
            let imported = layer(import).unwrap_or_else(|| panic!("{path:?} imports `{import}`"));
            assert!(imported <= own_layer, "{path:?} imports from `{import}`, which is above it");
        }
        // A folder is left by absolute paths only.
        let out = "super::".repeat(depth - usize::from(path.ends_with("mod.rs")));
        assert!(depth == 1 || !code.contains(&out), "{path:?} leaves its folder by `super`");
    }
}

#[test]
fn folders_import_one_way() {
    let position = |name: &str| FOLDERS.iter().position(|folder| *folder == name);
    for (file, code) in sources(&src()) {
        let path = file.strip_prefix(src()).unwrap();
        let own = word(path.iter().next().unwrap().to_str().unwrap());
        if ["lib", "main", "prelude"].contains(&own) {
            continue;
        }
        let own = position(own).unwrap_or_else(|| panic!("{path:?} is in no known folder"));
        for import in code.split("crate::").skip(1).map(word) {
            // Macros have no folder.
            let imported = position(import).unwrap_or(own);
            assert!(imported <= own, "{path:?} imports from `{import}`, which is above it");
        }
    }
}

/// The name of a file in `src`: `core/bvp/mesh` for `crate::core::bvp::mesh`.
fn module(file: &Path) -> String {
    let path = file.strip_prefix(src()).unwrap().with_extension("");
    path.to_str().unwrap().trim_end_matches("/mod").to_string()
}

/// The files that a file imports from by their own paths; what a `mod.rs` re-exports belongs to
/// folders.
fn imports(own: &str, code: &str, files: &BTreeMap<String, String>) -> Vec<String> {
    let statements = code.split("\nuse ").skip(1).map(|rest| rest.split(';').next().unwrap());
    let paths = statements.flat_map(|statement| match statement.split_once('{') {
        Some((path, names)) => {
            names.split(',').map(|name| format!("{path}{}", name.trim())).collect()
        }
        None => vec![statement.to_string()],
    });
    let resolved = paths.map(|path| {
        let mut module: Vec<&str> = own.split('/').collect();
        for segment in path.split("::") {
            match segment {
                "crate" => module.clear(),
                "super" => drop(module.pop()),
                "self" => {}
                name => {
                    let deeper = [&module[..], &[name]].concat().join("/");
                    let known =
                        |file: &String| *file == deeper || file.starts_with(&format!("{deeper}/"));
                    if !files.keys().any(known) {
                        break;
                    }
                    module.push(name);
                }
            }
        }
        module.join("/")
    });
    resolved.filter(|file| file != own && files.contains_key(file)).collect()
}

/// Files that import nothing, or that nothing imports, are taken away until none is left; those in
/// a circle would stay.
#[test]
fn files_import_one_another_in_no_circle() {
    let all = sources(&src()).into_iter().filter(|(file, _)| !file.ends_with("mod.rs"));
    let files: BTreeMap<String, String> =
        all.map(|(file, code)| (module(&file), format!("\n{code}"))).collect();
    let pairs = files.iter().flat_map(|(own, code)| {
        imports(own, code, &files).into_iter().map(|imported| (own.clone(), imported))
    });
    let mut pairs: Vec<(String, String)> = pairs.collect();
    assert!(pairs.len() > 500, "imports are not read");
    let mut before = usize::MAX;
    while pairs.len() < before {
        before = pairs.len();
        let known = pairs.clone();
        pairs.retain(|(own, imported)| {
            known.iter().any(|pair| pair.0 == *imported) && known.iter().any(|pair| pair.1 == *own)
        });
    }
    pairs.dedup();
    assert!(pairs.is_empty(), "these import one another in a circle: {pairs:?}");
}

/// The folders that know segments, limits and events, but nothing of what makes a limit.
const GENERAL: [&str; 3] = ["system", "bvp", "continuation"];

/// Files among them with public names that have the field's word.
const WITH_PUBLIC_NAMES: [&str; 4] =
    ["continuation/branch.rs", "continuation/builder.rs", "continuation/end.rs", "system/kind.rs"];

fn is_of_hybrid_orbits(word: &str) -> bool {
    ["leg", "legs"].contains(&word) || ["graz", "touch"].iter().any(|start| word.starts_with(start))
}

/// Hybrid orbits are the subject of `orbit` and `hybrid`, and of rows of the catalogue.
#[test]
fn general_folders_have_no_words_of_hybrid_orbits() {
    for (file, _) in sources(&core()) {
        let path = file.strip_prefix(core()).unwrap();
        let folder = word(path.iter().next().unwrap().to_str().unwrap());
        if !GENERAL.contains(&folder) || WITH_PUBLIC_NAMES.iter().any(|named| path.ends_with(named))
        {
            continue;
        }
        let text = fs::read_to_string(&file).unwrap().to_lowercase();
        let found = text.split(|c: char| !c.is_alphabetic()).find(|word| is_of_hybrid_orbits(word));
        assert_eq!(found, None, "in {path:?}");
    }
}

/// The name of the type that the line opens an `impl` of, or of the trait that it declares.
fn subject(line: &str) -> Option<&str> {
    let line = line.strip_prefix("pub ").unwrap_or(line);
    let line = line.strip_prefix("pub(in crate::core) ").unwrap_or(line);
    if let Some(rest) = line.strip_prefix("trait ") {
        return Some(word(rest));
    }
    let rest = line.strip_prefix("impl")?;
    // The parameters of the `impl` itself.
    let mut depth = 0;
    let end = rest.find(|c| {
        depth += i32::from(c == '<') - i32::from(c == '>');
        depth == 0 && c == ' '
    })?;
    let of = rest[end + 1..].trim_start();
    let of = of.split_once(" for ").map_or(of, |(_, of)| of);
    Some(word(of.trim_start_matches("dyn ").trim_start_matches(['&', '(', '['])))
}

/// Whether a line begins a method.
fn is_method(line: &str) -> bool {
    let Some(line) = line.strip_prefix("    ") else {
        return false;
    };
    let visibilities = ["pub(in crate::core) ", "pub(crate) ", "pub(super) ", "pub "];
    let line = visibilities.iter().find_map(|v| line.strip_prefix(v)).unwrap_or(line);
    line.strip_prefix("const ").unwrap_or(line).starts_with("fn ")
}

/// The number of methods of each type.
fn methods() -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    for (_, code) in sources(&core()) {
        let mut of = None;
        for line in code.lines() {
            match line {
                "}" => of = None,
                _ if !line.starts_with(' ') => of = subject(line).or(of),
                _ => (),
            }
            if let Some(of) = of.filter(|_| is_method(line)) {
                *counts.entry(of.to_string()).or_default() += 1;
            }
        }
    }
    counts
}

#[test]
fn a_type_has_few_methods() {
    let mut counts: Vec<(String, usize)> = methods().into_iter().collect();
    counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    println!("the largest types: {:?}", &counts[..5]);
    for (name, count) in counts {
        assert!(count <= MOST_METHODS, "{name} has {count} methods; {MOST_METHODS} are the most");
    }
}

/// The packed crate contains every page of the book that a source file includes.
#[test]
fn included_pages_are_packed() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let list = fs::read_to_string(root.join("Cargo.toml")).unwrap();
    let mut pages = 0;
    for (file, code) in sources(&root.join("src"))
        .iter()
        .filter(|(file, _)| file.extension().is_some_and(|extension| extension == "rs"))
    {
        let included = code.split("include_str!(\"").skip(1).filter_map(|it| it.split('"').next());
        for page in included.filter_map(|path| path.find("docs/").map(|at| &path[at..])) {
            assert!(list.contains(&format!("\"/{page}\"")), "{page} in {}", file.display());
            pages += 1;
        }
    }
    assert!(pages > 3, "{pages}");
}
