//! What a user of this crate has to compile.

use std::process::Command;

/// Names of the crates that a package depends on with the given features.
fn dependencies(package: &str, features: &[&str]) -> Vec<String> {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    let tree = ["tree", "--offline", "--edges", "normal", "--prefix", "none", "--package", package];
    let output = Command::new(cargo).args(tree).args(features).output().expect("cargo starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let lines = String::from_utf8(output.stdout).unwrap();
    lines.lines().filter_map(|line| line.split(' ').next()).map(String::from).collect()
}

#[test]
fn without_files_there_is_nothing_that_reads_them() {
    let heavy = |name: &String| {
        ["serde", "schemars", "garde", "yaml", "saphyr", "wgpu", "naga"].iter().any(|part| name.contains(part))
    };
    for package in ["myo-scalar", "myo-muscle", "myo-model", "myo-dynamics"] {
        let bare = dependencies(package, &["--no-default-features"]);
        assert!(bare.contains(&package.to_owned()), "{bare:?}");
        let found: Vec<_> = bare.iter().filter(|name| heavy(name)).collect();
        assert!(found.is_empty(), "{package} needs {found:?}");
    }
    // With files they are there, so these are the names to look for.
    assert!(dependencies("myo-dynamics", &[]).iter().any(heavy));
}
