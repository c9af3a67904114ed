//! Tells the command which commit and features it is built from.

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};

/// Digits of a commit that are shown.
const DIGITS: usize = 9;

fn main() {
    let package = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=GARNET_COMMIT");
    let given = env::var("GARNET_COMMIT").ok();
    let commit = given
        .filter(|commit| !commit.is_empty() && commit.chars().all(char::is_alphanumeric))
        .or_else(|| of_checkout(&package))
        .or_else(|| of_package(&package))
        .unwrap_or_else(|| "unknown".to_owned());
    println!("cargo::rustc-env=GARNET_BUILT_FROM={commit}");
}

/// The commit that is checked out, if the repository around the package is that of garnet.
fn of_checkout(package: &Path) -> Option<String> {
    let workspace = fs::canonicalize(package.join("../..")).ok()?;
    let top = fs::canonicalize(git(&workspace, &["rev-parse", "--show-toplevel"])?).ok()?;
    if top != workspace {
        return None;
    }
    // A branch may be in a file of its own or in the list of all; the log tells of both.
    let branch = git(&workspace, &["symbolic-ref", "-q", "HEAD"]);
    let files = ["HEAD", "packed-refs", "logs/HEAD"].into_iter();
    for file in files.chain(branch.as_deref()) {
        let Some(path) = git(&workspace, &["rev-parse", "--git-path", file]) else {
            continue;
        };
        // One that is missing would have this script run each time.
        let path = workspace.join(path);
        if path.exists() {
            println!("cargo::rerun-if-changed={}", path.display());
        }
    }
    let digits = format!("--short={DIGITS}");
    git(&workspace, &["rev-parse", &digits, "HEAD"])
}

/// The commit that a published package was made of, which Cargo notes in it.
fn of_package(package: &Path) -> Option<String> {
    let text = fs::read_to_string(package.join(".cargo_vcs_info.json")).ok()?;
    let (_, after) = text.split_once("\"sha1\"")?;
    let commit = after.split('"').nth(1)?;
    commit.get(..DIGITS).map(str::to_owned)
}

fn git(folder: &Path, arguments: &[&str]) -> Option<String> {
    let mut command = Command::new("git");
    let output = command.args(arguments).current_dir(folder).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}
