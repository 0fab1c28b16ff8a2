//! Inverse inertias in the reference pose (all joints at zero), which scale soft constraints and automatic muscle forces.
//!
//! MuJoCo's `dof_invweight0`, `body_invweight0`, `tendon_invweight0` and `actuator_acc0`, of the model with all joints.

use super::{Connection, ContactPair, Plan, PlanError, Point, TendonLimit};
use crate::spatial::{Vec3, Wrench};
use crate::step::{cholesky, force, inertia, kinematics, tendon};
use crate::workspace::{State, Workspace};

/// What is measured.
pub(super) struct ReferencePose {
    /// Diagonal of the inverse mass matrix, per coordinate.
    pub inverse_inertia: Vec<f64>,
    /// Per sphere that presses, mean inverse mass of the body that carries it (1/kg).
    pub sphere_inverse_masses: Vec<f64>,
    /// The same of both bodies of each pair of parts that touch.
    pub pair_inverse_masses: Vec<[f64; 2]>,
    /// Inverse mass (1/kg) and inverse inertia (1/(kg m^2)) of both bodies of each connection.
    pub connection_inverses: Vec<[[f64; 2]; 2]>,
    /// Inverse inertia that each limited tendon feels (1/kg).
    pub tendon_inverse_masses: Vec<f64>,
    /// Norm of the joint acceleration per newton, per muscle.
    pub acc0: Vec<f64>,
}

/// Measures on an exact plan with all joints as coordinates.
pub(super) fn measure(plan: &Plan<f64>) -> Result<ReferencePose, PlanError> {
    let n = plan.ndof();
    let (state, mut ws) = (State::<f64>::new(plan), Workspace::<f64>::new(plan));
    kinematics::kinematics(plan, &state.qpos, &state.qvel, &mut ws);
    tendon::lengths(plan, &mut ws);
    inertia::resist(plan, &mut ws);
    inertia::mass_matrix(plan, &state, &mut ws);
    if let Some(bad) = (0..n).find(|&k| ws.mass[k * n + k] <= 0.0) {
        return Err(PlanError::Singular { joint: plan.dofs[bad].name.clone() });
    }
    ws.matrix.copy_from_slice(&ws.mass);
    cholesky::factor(&plan.elimination, &mut ws.matrix, &mut ws.pivot);
    if let Some(bad) = ws.pivot.iter().position(|p| !p.is_finite()) {
        return Err(PlanError::Singular { joint: plan.dofs[bad].name.clone() });
    }
    let solve = |ws: &Workspace<f64>, mut b: Vec<f64>| {
        cholesky::solve(&plan.elimination, &ws.matrix, &ws.pivot, &mut b);
        b
    };
    let unit = |k: usize| (0..n).map(|j| f64::from(u8::from(j == k))).collect::<Vec<f64>>();
    let inverse_inertia = (0..n).map(|k| solve(&ws, unit(k))[k]).collect();
    let arms = |muscle: usize| force::moment_arms(plan, muscle, &mut ws.clone());
    let acc0 =
        (0..plan.nmuscle()).map(|muscle| solve(&ws, arms(muscle)).iter().map(|a| a * a).sum::<f64>().sqrt()).collect();
    let felt = |limit: &TendonLimit<f64>| {
        let arms = arms(limit.muscle);
        solve(&ws, arms.clone()).iter().zip(&arms).map(|(a, b)| a * b).sum()
    };
    let tendon_inverse_masses = plan.tendon_limits.iter().map(felt).collect();
    let mass_at = |point: &Point<f64>| inverse_mass(plan, &ws, point, solve);
    let inverses_at = |point: &Point<f64>| [mass_at(point), inverse_inertia_of(plan, &ws, point.link, solve)];
    let of_connection = |connection: &Connection<f64>| connection.coms.each_ref().map(inverses_at);
    let connection_inverses = plan.connections.iter().map(of_connection).collect();
    let sphere_inverse_masses = plan.contact_spheres.iter().map(|sphere| mass_at(&sphere.body_com)).collect();
    let of_pair = |pair: &ContactPair<f64>| [mass_at(&pair.parts[0].body_com), mass_at(&pair.parts[1].body_com)];
    let pair_inverse_masses = plan.pairs.iter().map(of_pair).collect();
    Ok(ReferencePose {
        inverse_inertia,
        sphere_inverse_masses,
        pair_inverse_masses,
        connection_inverses,
        tendon_inverse_masses,
        acc0,
    })
}

/// Inverse diagonal of the inverse mass matrix at zero: what each coordinate alone feels (kg m^2 or kg).
pub(super) fn inertias(plan: &Plan<f64>) -> Result<Vec<f64>, PlanError> {
    Ok(measure(plan)?.inverse_inertia.into_iter().map(f64::recip).collect())
}

/// Mean inverse mass (1/kg) that the body of a point feels there; MuJoCo's `body_invweight0`.
fn inverse_mass(
    plan: &Plan<f64>,
    ws: &Workspace<f64>,
    point: &Point<f64>,
    solve: impl Fn(&Workspace<f64>, Vec<f64>) -> Vec<f64>,
) -> f64 {
    let at = ws.place(point);
    mean_inverse(plan, ws, point.link, |direction| Wrench::at(at, direction), solve)
}

/// Mean inverse inertia (1/(kg m^2)) by which a link turns.
fn inverse_inertia_of(
    plan: &Plan<f64>,
    ws: &Workspace<f64>,
    link: usize,
    solve: impl Fn(&Workspace<f64>, Vec<f64>) -> Vec<f64>,
) -> f64 {
    mean_inverse(plan, ws, link, |ang| Wrench { ang, lin: Vec3::zero() }, solve)
}

/// Mean of what a link does under a unit wrench of each axis, along that wrench.
fn mean_inverse(
    plan: &Plan<f64>,
    ws: &Workspace<f64>,
    link: usize,
    wrench: impl Fn(Vec3<f64>) -> Wrench<f64>,
    solve: impl Fn(&Workspace<f64>, Vec<f64>) -> Vec<f64>,
) -> f64 {
    let screws = &plan.links[link].screw_of_dof;
    let along = |direction: Vec3<f64>| {
        let wrench = wrench(direction);
        let row: Vec<f64> = screws.iter().map(|s| s.map_or(0.0, |s| ws.screw[s].dot(wrench))).collect();
        solve(ws, row.clone()).iter().zip(&row).map(|(a, b)| a * b).sum::<f64>()
    };
    let axes = [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)];
    axes.into_iter().map(along).sum::<f64>() / 3.0
}
