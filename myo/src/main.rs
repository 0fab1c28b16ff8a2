//! The `myo` command: `myo --help` tells the rest.
mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    quieten_drivers();
    cli::main()
}

/// Without a graphical session, a layer of Mesa complains on standard error whenever graphics cards are listed. It only
/// chooses where windows are drawn, so it is left out.
fn quieten_drivers() {
    if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        // SAFETY: this process has no other thread yet that could read the environment.
        unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    }
}
