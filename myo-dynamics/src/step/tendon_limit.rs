//! Rows of tendons that are at a limit of their length.
//!
//! How a length changes with every coordinate is asked for only then: it takes a pull of one newton along the tendon, as far as forces go.

use crate::plan::Plan;
use crate::step::constraint::within;
use crate::step::force;
use crate::workspace::{Row, Workspace};
use myo_scalar::{Carried, Scalar, Stage, Visitor};

/// Fills `tendon_limit` and its Jacobian. To be called between the [lengths](super::tendon::lengths) of paths and the
/// forces of muscles, whose memory it uses.
#[inline(always)]
pub fn tendon_limits<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>) {
    for (number, limit) in plan.tendon_limits.iter().enumerate() {
        let (length, rate) = (ws.tendon_length[limit.muscle], ws.tendon_velocity[limit.muscle]);
        let (distance, sign) = within(limit.range.map(S::splat), length);
        let violation = distance - S::splat(limit.margin);
        let (weight, reference) = limit.impedance.row(violation, sign * rate, S::splat(limit.diagonal));
        let exists = violation.lt(S::zero());
        ws.tendon_limit[number] = Row { exists, active: exists, weight, reference, slope: S::lit(1.0) };
        S::when(exists, &mut Slopes { plan, number, sign, ws }, |Slopes { plan, number, sign, ws }| {
            S::outline(Slopes { plan, number: *number, sign: *sign, ws });
        });
    }
}

/// How the length of a limited tendon changes.
struct Slopes<'a, S: Scalar> {
    plan: &'a Plan<S::Const>,
    number: usize,
    /// Less one at the longest length.
    sign: S,
    ws: &'a mut Workspace<S>,
}

impl<S: Scalar> Slopes<'_, S> {
    fn jacobian(&mut self) -> &mut [S] {
        let n = self.plan.ndof();
        &mut self.ws.tendon_limit_jacobian[self.number * n..(self.number + 1) * n]
    }
}

impl<S: Scalar> Carried<S> for Slopes<'_, S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        visitor.numbers(self.jacobian());
    }
}

impl<S: Scalar> Stage<S> for Slopes<'_, S> {
    const NAME: &'static str = "slopes of a limited tendon";
    type Output = ();
    #[inline(always)]
    fn run(mut self) {
        let muscle = self.plan.tendon_limits[self.number].muscle;
        force::pull_alone(self.plan, muscle, self.ws);
        for dof in 0..self.plan.ndof() {
            let slope = self.sign * self.ws.torque[dof];
            self.jacobian()[dof] = slope;
        }
        // Far beyond its limits what a coordinate drives by profiles stands still.
        for (coordinate, profiled) in self.plan.profiled.iter().enumerate() {
            let slope = self.jacobian()[profiled.dof].only(self.ws.profiled[coordinate].is_free);
            self.jacobian()[profiled.dof] = slope;
        }
    }
}
