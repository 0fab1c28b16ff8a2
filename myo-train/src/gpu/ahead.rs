//! Kernels compiled side by side before they are asked for. A driver compiles in the thread that asks, and takes a second and
//! a half for those of a training one after the other.

use std::collections::HashSet;

use myo_env::EnvSpec;
use myo_gpu::{Gpu, Recipe};
use rayon::prelude::*;

use super::{Sizes, evaluate, learn, rollout};
use crate::PpoConfig;
use crate::device::check_spec;
use crate::networks::Networks;

/// Compiles what a training in such environments needs, and looks at its policy in `looks` environments, on the calling
/// thread's rayon pool. What is made with this handle, or a clone of it, finds the kernels there; the environments' own are
/// not among them, so this may be done while those are compiled.
///
/// It is of no consequence but for the time: what is refused here is refused again, and told, where it is asked for.
pub fn compile_ahead(gpu: &Gpu, spec: &EnvSpec, config: &PpoConfig, looks: usize) {
    if check_spec(spec, config).is_err() {
        return;
    }
    let networks = Networks::new(spec, config);
    let looks = evaluate::recipes(gpu, &networks.policy, looks);
    compile([training(gpu, spec, config), looks].concat(), gpu);
}

/// What a training in such environments is compiled from.
pub(super) fn training(gpu: &Gpu, spec: &EnvSpec, config: &PpoConfig) -> Vec<Recipe> {
    let (sizes, networks) = (Sizes::new(spec, config), Networks::new(spec, config));
    [rollout::recipes(gpu, &sizes, &networks), learn::recipes(gpu, &sizes, &networks, config)].concat()
}

/// Compiles each of them once.
pub(super) fn compile(recipes: Vec<Recipe>, gpu: &Gpu) {
    let different: HashSet<_> = recipes.into_iter().collect();
    different.par_iter().for_each(|recipe| drop(gpu.kernel(recipe)));
}

#[cfg(test)]
mod tests {
    use myo_env::{EnvConfig, VectorEnv};

    use super::*;
    use crate::gpu::DeviceEvaluator;
    use crate::gpu::testing::gpu;
    use crate::gpu::tests::{config, env};
    use crate::{Member, Trainer};

    /// Trains a little and looks at the policies, after all kernels for that were compiled; none may have been missing.
    fn check(gpu: &Gpu, config: &PpoConfig) {
        let (looks, env) = (37, env(gpu, config.num_envs));
        let base = env.sibling(&EnvConfig { num_envs: looks, ..EnvConfig::default() }).unwrap();
        assert_eq!(gpu.recipes(), 0);
        compile_ahead(gpu, env.spec(), config, looks);
        let before = gpu.recipes();
        let members: Vec<_> = (0..gpu.groups()).map(|seed| Member::New { config, seed: seed as u64 }).collect();
        let trainers = Trainer::several_on_card(env, &members).unwrap();
        drop(DeviceEvaluator::several(base, &trainers).unwrap());
        assert!(before > 10 && gpu.recipes() == before, "{before} recipes ahead, {} in the end", gpu.recipes());
    }

    #[test]
    fn what_a_training_needs_is_compiled_ahead() {
        let Some(one) = gpu() else { return };
        // So many that columns go through the networks in several chunks, of other tiles.
        check(&one, &config(4096));
        // Each test has a handle of its own, and so its own kernels.
        let several = gpu().unwrap().in_groups(3).unwrap();
        check(&several, &PpoConfig { policy_hidden: vec![], ..config(8) });
    }

    #[test]
    fn a_kernel_that_is_refused_is_refused_again_where_it_is_asked_for() {
        let Some(gpu) = gpu() else { return };
        let bad = Recipe::new("bad", "@compute @workgroup_size(1) fn main() { y = 3; }", []);
        compile(vec![bad.clone()], &gpu);
        let errors = [gpu.kernel(&bad), gpu.kernel(&bad)].map(|kernel| kernel.unwrap_err().to_string());
        assert!(errors[0] == errors[1] && errors[0].contains("kernel bad"), "{errors:?}");
    }

    #[test]
    fn settings_out_of_range_are_left_to_the_training() {
        let Some(gpu) = gpu() else { return };
        let env = env(&gpu, 4);
        compile_ahead(&gpu, env.spec(), &PpoConfig { minibatches: 0, ..config(4) }, 4);
        assert_eq!(gpu.recipes(), 0);
    }
}
