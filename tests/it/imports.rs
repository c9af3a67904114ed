//! How the modules of the command import each other.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// A module by the names on the way to it; the root has none.
type Module = Vec<String>;

/// The text of each module below a folder of sources, without its tests.
fn modules(folder: &Path) -> BTreeMap<Module, String> {
    let mut found = BTreeMap::new();
    let mut folders: Vec<(PathBuf, Module)> = vec![(folder.to_owned(), Vec::new())];
    while let Some((folder, name)) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let stem = path.file_stem().unwrap().to_string_lossy().into_owned();
            let child = [name.clone(), vec![stem.clone()]].concat();
            if path.is_dir() {
                folders.push((path, child));
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let is_own = ["mod", "main", "lib"].contains(&stem.as_str());
                let text = fs::read_to_string(&path).unwrap();
                let tests = text.find("#[cfg(test)]\nmod tests").unwrap_or(text.len());
                let module = if is_own { name.clone() } else { child };
                found.insert(module, text[..tests].to_owned());
            }
        }
    }
    found
}

/// The paths that a text uses, as words: those of its `use` items, and those that begin with
/// `crate`.
fn paths(text: &str) -> Vec<Vec<String>> {
    let code: Vec<&str> = (text.lines())
        .map(|line| line.split("//").next().unwrap_or_default())
        .collect();
    let code = code.join("\n");
    let mut paths = Vec::new();
    for item in code
        .split("\nuse ")
        .skip(1)
        .chain(code.split("\npub(crate) use ").skip(1))
    {
        let tree = item.split(';').next().unwrap_or_default();
        expand(&[], tree, &mut paths);
    }
    for rest in code.split("crate::").skip(1) {
        let is_path = |character: &char| character.is_alphanumeric() || "_:".contains(*character);
        let path: String = rest.chars().take_while(is_path).collect();
        if path.is_empty() {
            continue;
        }
        expand(&["crate".to_owned()], &path, &mut paths);
    }
    paths
}

/// Adds the paths of a tree such as `a::{b, c::{d, self}}`.
fn expand(prefix: &[String], tree: &str, paths: &mut Vec<Vec<String>>) {
    let tree = tree.trim().trim_end_matches(',');
    let (head, inner) = match tree.split_once('{') {
        Some((head, inner)) => (head, inner.trim_end().strip_suffix('}')),
        None => (tree, None),
    };
    let words = head.split("::").map(str::trim);
    let words = words.filter(|word| !word.is_empty() && *word != "self");
    let words = words.map(|word| word.split(' ').next().unwrap_or_default().to_owned());
    let path: Vec<String> = prefix.iter().cloned().chain(words).collect();
    let Some(inner) = inner else {
        paths.push(path);
        return;
    };
    let (mut depth, mut start) = (0, 0);
    for (place, character) in inner.char_indices() {
        match character {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                expand(&path, &inner[start..place], paths);
                start = place + 1;
            }
            _ => {}
        }
    }
    if !inner[start..].trim().is_empty() {
        expand(&path, &inner[start..], paths);
    }
}

/// The module that a path leads to: the longest beginning of it that is one.
fn resolved(from: &Module, path: &[String], all: &BTreeMap<Module, String>) -> Option<Module> {
    let mut words = path;
    let mut module = from.clone();
    match words.first()?.as_str() {
        "crate" => {
            module.clear();
            words = &words[1..];
        }
        "super" => {
            while words.first().is_some_and(|word| word == "super") {
                module.pop();
                words = &words[1..];
            }
        }
        // A child of the module itself, or another crate.
        word => {
            let child = [from.clone(), vec![word.to_owned()]].concat();
            all.get(&child)?;
        }
    }
    for word in words {
        let child = [module.clone(), vec![word.clone()]].concat();
        if !all.contains_key(&child) {
            break;
        }
        module = child;
    }
    Some(module).filter(|module| module != from)
}

/// Which modules each module imports.
fn imports(folder: &Path) -> BTreeMap<Module, BTreeSet<Module>> {
    let all = modules(folder);
    let imports_of = |(module, text): (&Module, &String)| {
        let found = paths(text).into_iter();
        let found = found.filter_map(|path| resolved(module, &path, &all));
        (module.clone(), found.collect())
    };
    all.iter().map(imports_of).collect()
}

/// Sets of modules that reach each other by imports.
fn circles(imports: &BTreeMap<Module, BTreeSet<Module>>) -> BTreeSet<BTreeSet<Module>> {
    let reached = |start: &Module| {
        let mut reached = BTreeSet::new();
        let mut open = vec![start];
        while let Some(module) = open.pop() {
            for next in imports.get(module).into_iter().flatten() {
                if reached.insert(next.clone()) {
                    open.push(next);
                }
            }
        }
        reached
    };
    let reached: BTreeMap<&Module, BTreeSet<Module>> = imports
        .keys()
        .map(|module| (module, reached(module)))
        .collect();
    let circle = |module: &Module| -> BTreeSet<Module> {
        let others = reached[module].iter();
        let back = others.filter(|other| reached[*other].contains(module));
        back.cloned().collect()
    };
    imports
        .keys()
        .map(circle)
        .filter(|circle| circle.len() > 1)
        .collect()
}

#[test]
fn modules_of_the_command_import_in_circles_only_within_one_subcommand() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/garnet-cli/src");
    let imports = imports(&folder);
    let edges: usize = imports.values().map(BTreeSet::len).sum();
    assert!(
        imports.len() > 50 && edges > 100,
        "{} modules, {edges} edges",
        imports.len()
    );
    for circle in circles(&imports) {
        let folders: BTreeSet<_> = circle.iter().map(|module| module.first()).collect();
        let names: Vec<String> = circle.iter().map(|module| module.join("::")).collect();
        assert_eq!(folders.len(), 1, "these import each other: {names:?}");
    }
}

#[test]
fn circles_are_seen() {
    let module = |name: &str| name.split("::").map(str::to_owned).collect::<Module>();
    let text = "//! Words.\n\nuse std::fs;\nuse crate::{b::{self, Thing}, c::d};\n\nfn f() { crate::e::g() }\n";
    let names = ["a", "b", "c", "c::d", "e"];
    let all: BTreeMap<Module, String> = names
        .iter()
        .map(|name| (module(name), String::new()))
        .collect();
    let found: BTreeSet<String> = (paths(text).iter())
        .filter_map(|path| resolved(&module("a"), path, &all))
        .map(|module| module.join("::"))
        .collect();
    assert_eq!(found, ["b", "c::d", "e"].map(str::to_owned).into());
    let path = ["super", "a"].map(str::to_owned);
    assert_eq!(resolved(&module("c::d"), &path, &all), Some(module("c")));

    let edges = [("a", "b"), ("b", "c"), ("c", "b"), ("e", "a")];
    let mut imports: BTreeMap<Module, BTreeSet<Module>> = BTreeMap::new();
    for (from, to) in edges {
        imports.entry(module(from)).or_default().insert(module(to));
    }
    let expected = BTreeSet::from([module("b"), module("c")]);
    assert_eq!(circles(&imports), BTreeSet::from([expected]));
}
