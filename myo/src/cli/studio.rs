//! `myo studio`: the local web application.

use std::net::{IpAddr, Ipv4Addr};
use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use myo_studio::engine::Engine;
use myo_studio::pages::missing_pages;
use myo_studio::server::{PORT, Server};

use super::backend::{BackendName, Options};
use super::failure::{Failure, Result, complain};
use super::interrupt::Interrupt;
use super::output::print;

/// Ctrl-C is looked for so often.
const LOOK_EVERY: Duration = Duration::from_millis(50);

/// Arguments of `myo studio`.
#[derive(Args)]
#[command(after_help = HELP)]
pub struct Studio {
    /// Port to listen at [default: the first that is free from 7117 on]
    #[arg(long, value_name = "N")]
    port: Option<u16>,

    /// Address to listen at: others than this machine need the token that is printed then
    #[arg(long, value_name = "ADDRESS", default_value_t = IpAddr::V4(Ipv4Addr::LOCALHOST))]
    host: IpAddr,

    /// Folder of tasks and runs
    #[arg(long, value_name = "FOLDER", default_value = ".")]
    folder: PathBuf,

    /// Do not open a browser
    #[arg(long)]
    no_open: bool,

    #[command(flatten)]
    physics: Options,
}

const HELP: &str = "\
Examples:
  myo studio                         set up, train, watch and compare in the browser
  myo studio --port 8000 --no-open   print the address and leave it to you to open it
  myo studio --host 0.0.0.0          for other machines of a network that you trust

Task files are kept in `tasks/` of the folder, runs in `runs/`, where `myo train` puts them too, and what was thrown away in
`bin/`. Trainings that were ordered are listed in `studio.json`; a studio that was killed goes on with them when it comes again.

Ctrl-C ends it; a training that is under way writes a checkpoint first, and goes on from there the next time. Ctrl-C again does not wait.";

/// Runs `myo studio`.
pub fn run(args: &Studio) -> Result<()> {
    missing_pages()?;
    let backend = args.physics.choice(BackendName::Auto)?;
    let engine = Engine::open(args.folder.clone(), backend).map_err(|refusal| Failure::sentence(refusal.message))?;
    let server = Server::bind(engine, args.host, args.port).map_err(|error| unbound(args, &error))?;
    let url = server.url()?;
    print(&format!("the studio is at {url}\nCtrl-C ends it\n"))?;
    if !args.no_open
        && let Err(error) = open::that_detached(&url)
    {
        complain(&format!("warning: no browser could be opened ({error}); open the address above"));
    }
    let interrupt = Interrupt::listen()?;
    server.serve(async move {
        while !interrupt.wanted() {
            tokio::time::sleep(LOOK_EVERY).await;
        }
    })?;
    Ok(())
}

fn unbound(args: &Studio, error: &std::io::Error) -> Failure {
    match args.port {
        Some(port) => Failure::sentence(format!(
            "cannot listen at {}, port {port}: {error}; leave --port out to take one that is free",
            args.host
        )),
        None => Failure::sentence(format!("cannot listen at {}, from port {PORT} on: {error}", args.host)),
    }
}
