//! Machine code steps bodies as lanes do.

use myo_dynamics::{Batch, CouplingMode, NotCompiled, Plan};
use myo_model::{Model, builtin};
use myo_native::NativeError;
use myo_scalar::Level;

const BODIES: usize = 37;

/// Bodies on lanes and as machine code after some steps under controls that differ from body to body; none where the processor has no
/// AVX-512.
fn both(name: &str, steps: usize) -> Option<[Batch; 2]> {
    let model = Model::new(&builtin(name).expect("a built-in model")).expect("the model is whole");
    let plan = Plan::exact(&model, CouplingMode::Reduced).expect("it can be simulated").specialised();
    let compiled = match Batch::compiled(&plan, BODIES) {
        Err(NotCompiled::Native(NativeError::Unsupported)) => {
            println!("skipped: no AVX-512 here");
            return None;
        }
        compiled => compiled.expect("the plan is compiled"),
    };
    let mut both = [Batch::new(&plan, BODIES, Level::widest()), compiled];
    for batch in &mut both {
        for body in 0..BODIES {
            let ctrl: Vec<f32> = (0..plan.nmuscle()).map(|k| ((body * 7 + k * 5) % 11) as f32 / 10.0).collect();
            batch.set_ctrl(body, &ctrl);
        }
        batch.step(steps);
    }
    Some(both)
}

/// The greatest difference of what is looked at, over all bodies.
fn greatest(both: &[Batch; 2], of: impl Fn(&Batch, usize) -> Vec<f32>) -> f32 {
    let differences = (0..BODIES).flat_map(|body| {
        let [a, b] = both.each_ref().map(|batch| of(batch, body));
        a.into_iter().zip(b).map(|(a, b)| (a - b).abs()).collect::<Vec<f32>>()
    });
    differences.fold(0.0, f32::max)
}

#[test]
fn arms_move_as_on_lanes() {
    for (name, bound) in [("mobl-arms", 2e-5), ("myo-arm", 5e-4)] {
        let Some(both) = both(name, 20) else { continue };
        let moved = both[0].qvel(5).iter().fold(0.0f32, |most, x| most.max(x.abs()));
        assert!(moved > 0.5, "`{name}` moves at {moved}");
        let [qpos, qvel, act] = [Batch::qpos, Batch::qvel, Batch::act].map(|of| greatest(&both, of));
        assert!(qpos < bound && qvel < 100.0 * bound && act < 1e-6, "`{name}`: {qpos} {qvel} {act}");
        assert_eq!(both[0].solver_counts()[3].steps, both[1].solver_counts()[3].steps);
        assert!(both[1].solver_counts().iter().all(|count| count.rounds >= 20 && count.unsolved == 0));
    }
}

#[test]
fn results_do_not_depend_on_a_bodys_place() {
    let Some([_, mut compiled]) = both("mobl-arms", 5) else { return };
    let (qpos, qvel, act) = (compiled.qpos(3), compiled.qvel(3), compiled.act(3));
    let wide = |x: &[f32]| x.iter().map(|&x| f64::from(x)).collect::<Vec<f64>>();
    let ctrl = vec![0.3; act.len()];
    for body in [3, 30] {
        compiled.set_state(body, &wide(&qpos), &wide(&qvel), &wide(&act));
        compiled.set_ctrl(body, &ctrl);
    }
    compiled.step(10);
    assert_eq!(compiled.qpos(3), compiled.qpos(30));
    assert_eq!(compiled.qvel(3), compiled.qvel(30));
}
