//! A card takes a while to open, and so does the check of a task: one beside the other.

use std::thread::Scope;

use myo::train::PpoConfig;

use super::Train;
use crate::cli::backend::BackendName;

/// Begins to open the card of a new training, in a thread that whoever made `beside` waits for. The card is found open when it
/// is asked for; why there is none, and what is wrong with the arguments, is told then.
pub fn open_card<'scope>(args: &Train, beside: &'scope Scope<'scope, '_>) {
    let (backend, config) =
        (args.how.physics.choice(BackendName::Auto), args.how.learner.settings(&PpoConfig::default()));
    if let (Ok(backend), Ok(config), None) = (backend, config, &args.resume) {
        beside.spawn(move || drop(backend.device(config.num_envs, &mut |_| ())));
    }
}
