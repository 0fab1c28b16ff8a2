//! `myo report`: runs as one page that opens without a server.

use std::path::{Path, PathBuf};

use clap::Args;
use myo::find_runs;
use myo::train::write_whole;

use super::failure::{Failure, Result};
use super::output::print;

/// Arguments of `myo report`.
#[derive(Args)]
#[command(after_help = HELP)]
pub struct Report {
    /// Run folders, or folders with runs in them
    #[arg(required = true, value_name = "RUN")]
    runs: Vec<PathBuf>,

    /// File to write [default: REPORT.html, named after the first run]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,

    /// Replace the file where there is one
    #[arg(long)]
    force: bool,
}

const HELP: &str = "\
Examples:
  myo report runs/pointing-1                     pointing-1.html: figures, each step, a replay in 3D, how it was learnt
  myo report runs/grid-1 runs/row-1 --out layouts.html
  myo report runs/grid-row                       all users of a comparison, by layout

The page is one file with everything in it. It opens in any browser without a server or a network, and can be sent to others.";

/// Runs `myo report`.
pub fn run(args: &Report) -> Result<()> {
    let runs = named(&args.runs)?;
    let path = args.out.clone().unwrap_or_else(|| default_path(&args.runs[0]));
    if path.exists() && !args.force {
        let path = path.display();
        return Err(Failure::sentence(format!("{path} is there already; name another with --out, or add --force")));
    }
    let page = myo_studio::engine::report(&runs).map_err(|refusal| Failure::sentence(refusal.message))?;
    write_whole(&path, page.as_bytes())?;
    let count = match runs.len() {
        1 => String::new(),
        several => format!(" ({several} runs)"),
    };
    print(&format!("the report{count} is {}\n", path.display()))
}

/// All runs in these folders, each with its name: as short as tells them apart.
fn named(folders: &[PathBuf]) -> Result<Vec<(String, PathBuf)>> {
    let mut paths: Vec<PathBuf> = Vec::new();
    for folder in folders {
        let found = find_runs(folder)?;
        if found.is_empty() {
            return Err(Failure::sentence(format!("there is no run in {}", folder.display())));
        }
        paths.extend(found.into_iter().map(|run| run.path).filter(|path| !paths.contains(path)).collect::<Vec<_>>());
    }
    let last = |path: &Path| path.file_name().map(|name| name.to_string_lossy().into_owned());
    let name = |path: &PathBuf| match last(path) {
        Some(name) if paths.iter().filter(|other| last(other).as_ref() == Some(&name)).count() == 1 => name,
        _ => path.display().to_string(),
    };
    Ok(paths.iter().map(|path| (name(path), path.clone())).collect())
}

/// A file of this folder that is called like the run.
fn default_path(run: &Path) -> PathBuf {
    let name = run.file_name().map_or_else(|| "report".into(), |name| name.to_string_lossy().into_owned());
    PathBuf::from(format!("{name}.html"))
}
