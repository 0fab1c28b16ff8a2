//! Trying a plan out: does it stay finite under any controls?

use crate::batch::Batch;
use crate::plan::{Dof, DofKind, Plan, PlanError};
use myo_scalar::{Counter, Level, Scalar, Word, philox, seed_words, unit};

/// Bodies tried side by side.
const BODIES: usize = 16;
/// Physics steps that a body's controls are held for.
const HELD: usize = 25;
/// Draws of controls; together with [`HELD`] as long as a thousand control steps of the published systems.
const DRAWS: usize = 1000;
/// Speed (rad/s or m/s) that no joint of a body that muscles drive comes to; what is faster is on its way to infinity.
const TOO_FAST: f32 = 1e3;
/// Distance past a limit, or from zero without one (rad or m), that nothing gets to either.
const TOO_FAR: f32 = 100.0;
/// Seed of the draws.
const SEED: u64 = 11;

impl Plan<f64> {
    /// Runs the plan in single precision, as batches of environments do, for a thousand control steps of random controls:
    /// half of the bodies with controls in between, half with muscles that are either slack or fully excited. They start
    /// anywhere within the joints' limits.
    ///
    /// # Errors
    /// [`PlanError::Unstable`] names the first coordinate that became faster or went farther than any body does.
    pub fn try_out(&self) -> Result<(), PlanError> {
        let mut batch = Batch::new(&self.specialised(), BODIES, Level::current());
        let (still, slack) = (vec![0.0; self.ndof()], vec![0.0; self.nmuscle()]);
        for body in 0..BODIES {
            batch.set_state(body, &self.anywhere(body), &still, &slack);
        }
        for draw in 0..DRAWS {
            for body in 0..BODIES {
                batch.set_ctrl(body, &self.controls(draw, body));
            }
            batch.step(HELD);
            if let Some(dof) = (0..BODIES).find_map(|body| self.runaway(&batch, body)) {
                let time_s = ((draw + 1) * HELD) as f64 * self.timestep;
                return Err(PlanError::Unstable {
                    joint: self.dofs[dof].name.clone(),
                    time_s,
                    timestep_s: self.timestep,
                });
            }
        }
        Ok(())
    }

    /// A pose within the limits.
    fn anywhere(&self, body: usize) -> Vec<f64> {
        self.pose(|k, dof| dof.range.map_or(0.0, |[lo, hi]| lo + (hi - lo) * uniform(DRAWS, body, k)))
    }

    fn controls(&self, draw: usize, body: usize) -> Vec<f32> {
        let control = |u: f64| if body.is_multiple_of(2) { u } else { u.round() };
        (0..self.nmuscle()).map(|k| control(uniform(draw, body, k)) as f32).collect()
    }

    /// A coordinate that is faster or farther out than any body's.
    fn runaway(&self, batch: &Batch, body: usize) -> Option<usize> {
        let (qpos, qvel) = (batch.qpos(body), batch.qvel(body));
        let is_fine = |(dof, speed): (&Dof<f64>, f32)| {
            let (position, [lo, hi]) = (qpos[dof.at], dof.range.unwrap_or([0.0; 2]).map(|bound| bound as f32));
            // A free body may fall, but not for ever faster.
            let is_near = match dof.kind {
                DofKind::Place => position.is_finite(),
                DofKind::Joint | DofKind::Turn => position > lo - TOO_FAR && position < hi + TOO_FAR,
            };
            speed.abs() < TOO_FAST && is_near
        };
        let is_active = batch.act(body).iter().all(|act| act.is_finite());
        let stray = self.dofs.iter().zip(qvel).position(|coordinate| !is_fine(coordinate));
        stray.or((!is_active).then_some(0))
    }
}

/// Uniform in [0, 1).
fn uniform(draw: usize, body: usize, entry: usize) -> f64 {
    let word = |x: usize| <f64 as Scalar>::Word::splat(x as u32);
    let counter =
        Counter { seed: seed_words(SEED), env: word(body), episode: word(0), step: word(draw), stream: word(entry) };
    unit::<f64>(philox::<f64>(counter)[0])
}
