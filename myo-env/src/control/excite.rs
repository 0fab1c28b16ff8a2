//! From actions to excitations: the range of controls, and motor noise.

use super::Scratch;
use crate::parameters::World;
use crate::state::EnvState;
use myo_muscle::noisy_excitation;
use myo_scalar::{Counter, Scalar, Word, normal_pair, philox};

/// Random stream of motor noise.
const NOISE_STREAM: u32 = 0x1000;

/// The excitation that an action asks a muscle for: from -1 to 1, mapped to 0 to 1.
#[inline(always)]
pub fn excitation<S: Scalar>(action: S) -> S {
    action.clamp(-1.0, 1.0).mul_add(S::lit(0.5), S::lit(0.5))
}

/// Maps actions (in `ctrl`) to excitations `(a + 1) / 2` and adds motor noise.
#[inline(always)]
pub fn excite<S: Scalar>(world: &World<'_, S>, env: &mut EnvState<S>, ws: &mut Scratch<S>) {
    let Scratch { ctrl, noisy, .. } = ws;
    for u in ctrl.iter_mut() {
        *u = excitation(*u);
    }
    if let Some([signal_dependent, constant]) = world.parameters.noise {
        let n = ctrl.len();
        noisy[..n].copy_from_slice(ctrl);
        let counter = env.counter();
        // One block of random words serves two muscles.
        S::map_chunks(noisy, |pair, two: [S; 2]| {
            let words = philox::<S>(Counter { stream: S::Word::splat(NOISE_STREAM) + pair, ..counter });
            let add = |u, a, b| {
                let (z1, z2) = normal_pair(a, b);
                noisy_excitation(u, signal_dependent, constant, z1, z2)
            };
            [add(two[0], words[0], words[1]), add(two[1], words[2], words[3])]
        });
        ctrl.copy_from_slice(&noisy[..n]);
    }
    env.step = env.step + S::Word::splat(1);
}
