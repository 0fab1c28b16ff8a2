//! Puts the studio's pages into the program: built here from `web/` where npm is there. Without it everything else is built
//! all the same, and `myo studio` says what is missing.

use std::env;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What the pages are made of.
const SOURCES: [&str; 9] = [
    "src",
    "public",
    "index.html",
    "report.html",
    "package.json",
    "package-lock.json",
    "svelte.config.js",
    "vite.config.ts",
    "vite.report.config.ts",
];

fn main() {
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    let web = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default()).join("web");
    for source in SOURCES {
        println!("cargo::rerun-if-changed={}", web.join(source).display());
    }
    println!("cargo::rerun-if-env-changed=MYO_NO_PAGES");
    let code = match build(&web, &out) {
        Ok(pages) => with_pages(&pages),
        Err(reason) => {
            println!("cargo::warning=the studio is built without its pages: {reason}");
            without_pages(&reason)
        }
    };
    fs::write(out.join("pages.rs"), code).expect("the folder of a build can be written");
}

/// What was built.
struct Pages {
    /// Files of the studio, compressed, by their paths.
    files: Vec<(String, PathBuf)>,
    /// The page of reports, which is one file.
    report: PathBuf,
}

/// Builds the pages into a folder.
fn build(web: &Path, out: &Path) -> Result<Pages, String> {
    if env::var_os("MYO_NO_PAGES").is_some() {
        return Err("MYO_NO_PAGES is set; unset it and build again".into());
    }
    let npm = if cfg!(windows) { "npm.cmd" } else { "npm" };
    if Command::new(npm).arg("--version").output().is_err() {
        watch_for_npm();
        return Err(
            "npm was not found; install Node.js 20.19 or later (nodejs.org), then run the same command again".into()
        );
    }
    if !is_installed(web) {
        run(npm, web, &["ci", "--no-audit", "--no-fund", "--prefer-offline"])?;
    }
    let (pages, report) = (out.join("pages"), out.join("report"));
    for (script, folder) in [("build", &pages), ("build:report", &report)] {
        let folder = folder.to_string_lossy();
        run(npm, web, &["run", script, "--", "--outDir", &folder, "--emptyOutDir", "--logLevel", "warn"])?;
    }
    let mut files = Vec::new();
    list(&pages, &pages, &mut files).map_err(|error| format!("{} cannot be read: {error}", pages.display()))?;
    Ok(Pages { files, report: report.join("report.html") })
}

/// Whether the packages that are there are those of the lock file: npm writes its own copy after them.
fn is_installed(web: &Path) -> bool {
    let time = |path: PathBuf| fs::metadata(path).and_then(|file| file.modified()).ok();
    let installed = time(web.join("node_modules/.package-lock.json"));
    matches!((installed, time(web.join("package-lock.json"))), (Some(installed), Some(wanted)) if installed >= wanted)
}

fn run(npm: &str, web: &Path, arguments: &[&str]) -> Result<(), String> {
    let output = Command::new(npm).args(arguments).current_dir(web).output();
    let output = output.map_err(|error| format!("npm cannot be started: {error}"))?;
    if output.status.success() {
        return Ok(());
    }
    let said = [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned()).concat();
    let last: Vec<&str> = said.lines().filter(|line| !line.trim().is_empty()).rev().take(6).collect();
    let last: Vec<&str> = last.into_iter().rev().collect();
    Err(format!("`npm {}` failed in {}: {}", arguments.join(" "), web.display(), last.join(" | ")))
}

/// Builds again once npm comes to where it would be found.
fn watch_for_npm() {
    let paths = env::var_os("PATH").unwrap_or_default();
    println!("cargo::rerun-if-env-changed=PATH");
    for folder in env::split_paths(&paths).filter(|folder| folder.is_dir()) {
        println!("cargo::rerun-if-changed={}", folder.display());
    }
}

fn list(root: &Path, folder: &Path, files: &mut Vec<(String, PathBuf)>) -> std::io::Result<()> {
    let mut entries: Vec<PathBuf> = fs::read_dir(folder)?.filter_map(|entry| Some(entry.ok()?.path())).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            list(root, &path, files)?;
        } else if let Some(name) =
            path.strip_prefix(root).ok().and_then(Path::to_str).and_then(|name| name.strip_suffix(".gz"))
        {
            files.push((name.replace('\\', "/"), path.clone()));
        }
    }
    Ok(())
}

fn with_pages(Pages { files, report }: &Pages) -> String {
    let mut code = String::from("const MISSING: Option<&str> = None;\n");
    let _ = writeln!(code, "static REPORT: &str = include_str!({report:?});");
    code += "static PAGES: &[(&str, &[u8])] = &[\n";
    for (name, path) in files {
        let _ = writeln!(code, "    ({name:?}, include_bytes!({path:?})),");
    }
    code + "];\n"
}

fn without_pages(reason: &str) -> String {
    format!(
        "const MISSING: Option<&str> = Some({reason:?});\nstatic REPORT: &str = \"\";\n\
         static PAGES: &[(&str, &[u8])] = &[];\n"
    )
}
