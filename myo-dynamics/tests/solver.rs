//! The constraint solver against the best of all sets of pushing rows, tried one by one.

mod common;

use common::{arm, difference, draw, exact, greatest, random_state};
use myo_dynamics::step::constraint::{self, BLOCK_ROUNDS};
use myo_dynamics::{Batch, CouplingMode, Obstacles, Plan, SolverCount, State, StaticBox, Surface, Workspace, step};
use myo_scalar::symbolic::{Buffer, Contents, Sharing, Sym, trace};
use myo_scalar::{LaneTask, Level, Real, Scalar, Word, dispatch};
use nalgebra::{DMatrix, DVector};

/// Coordinates and limit rows of a made-up problem; four rows of a contact come on top.
const N: usize = 5;
const LIMITS: usize = 6;
const PYRAMID: usize = 4;
/// Numbers of a problem: mass, torque, (exists, weight, reference, slope) per limit, contact exists, (weight, reference) per
/// edge, jacobian.
const NUMBERS: usize = N * N + N + 4 * LIMITS + 1 + 2 * PYRAMID + PYRAMID * N;

/// A constraint row that exists: `D/2 min(0, J a - aref)^2`.
#[derive(Debug)]
struct DenseRow {
    jacobian: DVector<f64>,
    weight: f64,
    reference: f64,
}

/// The acceleration of least cost among those of all sets of rows.
fn best_of_all_sets(mass: &DMatrix<f64>, torque: &DVector<f64>, rows: &[DenseRow]) -> DVector<f64> {
    let residual = |row: &DenseRow, a: &DVector<f64>| (row.jacobian.dot(a) - row.reference).min(0.0);
    let cost = |a: &DVector<f64>| {
        let rows: f64 = rows.iter().map(|row| 0.5 * row.weight * residual(row, a).powi(2)).sum();
        0.5 * a.dot(&(mass * a)) - torque.dot(a) + rows
    };
    let solution = |set: usize| {
        let (mut matrix, mut right) = (mass.clone(), torque.clone());
        for (_, row) in rows.iter().enumerate().filter(|(k, _)| set >> k & 1 == 1) {
            matrix += row.weight * &row.jacobian * row.jacobian.transpose();
            right += row.weight * row.reference * &row.jacobian;
        }
        matrix.cholesky().expect("positive definite").solve(&right)
    };
    let all = (0..1usize << rows.len()).map(solution);
    all.min_by(|a, b| cost(a).total_cmp(&cost(b))).expect("the empty set is one")
}

/// A random problem, its rows nearly dependent and much stiffer than the mass, so that rows push each other away.
fn problem(number: u32) -> Vec<f64> {
    let centred = |k: usize| 2.0 * draw(number, k) - 1.0;
    let root = DMatrix::from_fn(N, N, |i, j| centred(10 * i + j));
    let mass = &root * root.transpose() + DMatrix::identity(N, N) * 0.05;
    let mut numbers: Vec<f64> = mass.iter().copied().collect();
    numbers.extend((0..N).map(|k| 30.0 * centred(100 + k)));
    for k in 0..LIMITS {
        let exists = f64::from(u8::from(draw(number, 200 + k) < 0.6));
        let side = if draw(number, 210 + k) < 0.5 { 1.0 } else { -1.0 };
        numbers.extend([exists, 10.0_f64.powf(1.0 + 1.5 * centred(220 + k)), 40.0 * centred(230 + k), side]);
    }
    numbers.push(f64::from(u8::from(draw(number, 300) < 0.8)));
    let weight = 10.0_f64.powf(1.0 + centred(301));
    numbers.extend((0..PYRAMID).flat_map(|k| [weight, 60.0 * centred(310 + k)]));
    let normal: Vec<f64> = (0..N).map(|j| centred(320 + j)).collect();
    for k in 0..PYRAMID {
        let side = if k % 2 == 0 { 1.0 } else { -1.0 };
        numbers.extend((0..N).map(|j| normal[j] + side * centred(330 + 10 * (k / 2) + j)));
    }
    assert_eq!(numbers.len(), NUMBERS);
    numbers
}

/// The same problem for [`best_of_all_sets`].
fn dense(numbers: &[f64]) -> (DMatrix<f64>, DVector<f64>, Vec<DenseRow>) {
    let mut next = numbers.iter().copied();
    let mut take = |count: usize| next.by_ref().take(count).collect::<Vec<f64>>();
    let mass = DMatrix::from_vec(N, N, take(N * N));
    let torque = DVector::from_vec(take(N));
    let mut rows = vec![];
    for k in 0..LIMITS {
        let [exists, weight, reference, slope] = take(4)[..] else { unreachable!("four were taken") };
        let jacobian = DVector::from_fn(N, |j, _| if j == k % N { slope } else { 0.0 });
        rows.extend((exists > 0.5).then_some(DenseRow { jacobian, weight, reference }));
    }
    let touches = take(1)[0] > 0.5;
    let edges = take(2 * PYRAMID);
    for edge in edges.chunks_exact(2) {
        let jacobian = DVector::from_vec(take(N));
        rows.extend(touches.then_some(DenseRow { jacobian, weight: edge[0], reference: edge[1] }));
    }
    (mass, torque, rows)
}

/// A plan whose solver takes such problems: two limits on the first coordinate.
fn plan<C: Real>() -> Plan<C> {
    let mut plan = exact(CouplingMode::Reduced);
    assert_eq!(plan.ndof(), N);
    let of = |k: usize| plan.limits.iter().find(|limit| limit.drive.dof == Some(k % N)).expect("it is limited").clone();
    plan.limits = (0..LIMITS).map(of).collect();
    plan.cast()
}

/// Solves a problem whose numbers are given one after the other.
#[inline(always)]
fn solve<S: Scalar>(plan: &Plan<S::Const>, numbers: &[S], ws: &mut Workspace<S>) -> Vec<S> {
    let mut next = numbers.iter().copied();
    let mut take = || next.next().unwrap();
    let is_true = |x: S| S::lit(0.5).lt(x);
    for entry in &mut ws.mass {
        *entry = take();
    }
    for entry in &mut ws.torque {
        *entry = take();
    }
    for row in &mut ws.limit {
        row.exists = is_true(take());
        row.active = row.exists;
        (row.weight, row.reference, row.slope) = (take(), take(), take());
    }
    ws.contacts[0].exists = is_true(take());
    let exists = ws.contacts[0].exists;
    for row in &mut ws.contacts[0].rows {
        row.exists = exists;
        row.active = row.exists;
        (row.weight, row.reference) = (take(), take());
    }
    for entry in &mut ws.contact_jacobian {
        *entry = take();
    }
    constraint::solve(plan, ws);
    ws.qacc.clone()
}

fn assert_close(found: &[f64], wanted: &DVector<f64>, tolerance: f64, what: &str) {
    let error = difference(found, wanted.as_slice()) / greatest(wanted.as_slice()).max(1.0);
    assert!(error < tolerance, "{what}: {found:?} for {wanted}");
}

#[test]
fn random_problems_end_at_the_best_of_all_sets() {
    let plan = plan::<f64>();
    let (mut ws, mut late, mut most) = (Workspace::<f64>::new(&plan), 0, 0);
    for number in 0..4000 {
        let numbers = problem(number);
        let found = solve(&plan, &numbers, &mut ws);
        let mut count = [SolverCount::default()];
        ws.tally.take(1, &mut count);
        assert_eq!(count[0].unsolved, 0, "problem {number}");
        let (mass, torque, rows) = dense(&numbers);
        assert_close(&found, &best_of_all_sets(&mass, &torque, &rows), 1e-5, &format!("problem {number}"));
        late += u32::from(count[0].rounds > BLOCK_ROUNDS as u64);
        most = most.max(count[0].rounds);
    }
    // Both rules had work to do.
    assert!(late >= 20, "{late} of 4000 problems took more than {BLOCK_ROUNDS} rounds");
    assert!(most < 20, "{most} rounds");
}

/// Problems side by side in lanes, some numbers each: their accelerations, and what the solver counted.
struct Lanes<'a>(&'a [Vec<f64>]);

impl LaneTask for Lanes<'_> {
    type Output = Vec<(Vec<f64>, SolverCount)>;
    #[inline(always)]
    fn run<S: Scalar<Const = f32>>(self) -> Self::Output {
        let plan = plan::<f32>();
        let mut out = vec![];
        for block in self.0.chunks_exact(S::LANES) {
            let column = |k: usize| block.iter().map(|numbers| numbers[k] as f32).collect::<Vec<f32>>();
            let numbers: Vec<S> = (0..NUMBERS).map(|k| S::load(&column(k))).collect();
            let mut ws = Workspace::<S>::new(&plan);
            let found = solve(&plan, &numbers, &mut ws);
            let mut lanes = vec![[0.0; 16]; N];
            found.iter().zip(&mut lanes).for_each(|(x, to)| x.store(to));
            let mut counts = vec![SolverCount::default(); S::LANES];
            ws.tally.take(1, &mut counts);
            out.extend((0..S::LANES).map(|k| (lanes.iter().map(|row| f64::from(row[k])).collect(), counts[k])));
        }
        out
    }
}

#[test]
fn lanes_solve_as_the_reference_does_whatever_is_beside_them() {
    let plan = plan::<f64>();
    let problems: Vec<Vec<f64>> = (0..2000).map(problem).collect();
    for level in Level::available() {
        let found = dispatch(level, Lanes(&problems));
        assert_eq!(found.len(), problems.len());
        for (number, (numbers, (found, count))) in problems.iter().zip(&found).enumerate() {
            let mut ws = Workspace::<f64>::new(&plan);
            let wanted = DVector::from_vec(solve(&plan, numbers, &mut ws));
            assert_close(found, &wanted, 2e-3, &format!("{}: problem {number}", level.name()));
            assert_eq!((count.steps, count.unsolved), (1, 0), "{}: problem {number}", level.name());
        }
        for number in [3, 700, 1234] {
            let alone = vec![problems[number].clone(); level.lanes()];
            assert_eq!(dispatch(level, Lanes(&alone))[0], found[number], "{}: problem {number}", level.name());
        }
    }
}

#[test]
fn the_recorded_program_solves_as_the_reference_does() {
    let plan = plan::<f64>();
    let [input, output, rounds] = [0, 1, 2].map(|binding| Buffer { binding, sharing: Sharing::PerEnv });
    let program = trace(|| {
        let numbers: Vec<Sym> = (0..NUMBERS).map(|row| input.number(row)).collect();
        let mut ws = Workspace::<Sym>::new(&plan);
        for (row, x) in solve(&plan, &numbers, &mut ws).into_iter().enumerate() {
            output.set_number(row, x);
        }
        rounds.set_word(0, ws.tally.rounds);
    });
    let mut late = 0;
    for number in 0..300 {
        let numbers = problem(number);
        let mut ws = Workspace::<f64>::new(&plan);
        let wanted = DVector::from_vec(solve(&plan, &numbers, &mut ws));
        let mut count = [SolverCount::default()];
        ws.tally.take(1, &mut count);
        late += u32::from(count[0].rounds > BLOCK_ROUNDS as u64);
        let mut buffers = [Contents::Numbers(numbers), Contents::Numbers(vec![f64::NAN; N]), Contents::Words(vec![0])];
        program.interpret(&mut buffers);
        let [_, Contents::Numbers(found), Contents::Words(rounds)] = &buffers else { unreachable!("made so") };
        assert_eq!(u64::from(rounds[0]), count[0].rounds, "problem {number}");
        assert_close(found, &wanted, 1e-9, &format!("problem {number}"));
    }
    assert!(late > 0, "no problem took more than {BLOCK_ROUNDS} rounds");
}

/// Rows of a workspace for [`best_of_all_sets`].
fn rows_of(plan: &Plan<f64>, ws: &Workspace<f64>) -> Vec<DenseRow> {
    let n = plan.ndof();
    let limits = ws.limit.iter().zip(&plan.limits).filter(|(row, _)| row.exists).map(|(row, limit)| {
        let jacobian = DVector::from_fn(n, |j, _| if limit.drive.dof == Some(j) { row.slope } else { 0.0 });
        DenseRow { jacobian, weight: row.weight, reference: row.reference }
    });
    let edges = ws.contacts[0].rows.iter().zip(ws.contact_jacobian.chunks_exact(n)).filter(|_| ws.contacts[0].exists);
    let edges = edges.map(|(row, jacobian)| DenseRow {
        jacobian: DVector::from_column_slice(jacobian),
        weight: row.weight,
        reference: row.reference,
    });
    limits.chain(edges).collect()
}

fn full(n: usize, lower: &[f64]) -> DMatrix<f64> {
    DMatrix::from_fn(n, n, |i, j| lower[i.max(j) * n + i.min(j)])
}

const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

#[test]
fn presses_with_joints_beyond_limits_end_at_the_best_of_all_sets() {
    let mut crowded = 0;
    for name in ["mobl-arms", "mobl-arms-uitb"] {
        let plan = Plan::exact(&arm(name), CouplingMode::Reduced).unwrap();
        let mut ws = Workspace::<f64>::new(&plan);
        for number in 0..1500 {
            let mut state = random_state(&plan, number);
            for (k, dof) in plan.dofs.iter().enumerate() {
                let [lo, hi] = dof.range.unwrap();
                let beyond = 0.03 * draw(number, 600 + k);
                match draw(number, 500 + k) {
                    x if x < 0.3 => state.qpos[k] = lo - beyond,
                    x if x < 0.6 => state.qpos[k] = hi + beyond,
                    _ => {}
                }
            }
            step::kinematics::kinematics(&plan, &state.qpos, &state.qvel, &mut ws);
            let tip = step::fingertip(&plan, &ws);
            let centre = [0, 1, 2].map(|k| tip[k] + 0.03 * (draw(number, 700 + k) - 0.5));
            let obstacle = StaticBox::new(centre, AXES, [0.01, 0.02, 0.02]);
            let obstacles = Obstacles::new(&plan, &[obstacle], Surface::default());
            step::forward(&plan, &obstacles, &state, &mut ws);
            let rows = rows_of(&plan, &ws);
            crowded += u32::from(ws.contacts[0].exists && rows.len() >= 7);
            let torque = DVector::from_column_slice(&ws.torque);
            let wanted = best_of_all_sets(&full(plan.ndof(), &ws.mass), &torque, &rows);
            assert_close(&ws.qacc, &wanted, 1e-5, &format!("{name}, state {number}"));
        }
        let mut count = [SolverCount::default()];
        ws.tally.take(1500, &mut count);
        assert!(count[0].rounds > 1500 && count[0].unsolved == 0, "{:?}", count[0]);
    }
    assert!(crowded > 300, "{crowded} states press with three joints beyond their limits");
}

/// A state found while training, in which changing all wrong rows at once ends at 286.6 N.
#[test]
fn a_press_that_went_round_in_circles_has_its_force() {
    let found: serde_json::Value = serde_json::from_str(include_str!("fixtures/cycle.json")).unwrap();
    let vector = |x: &serde_json::Value| -> Vec<f64> { serde_json::from_value(x.clone()).unwrap() };
    let exact = Plan::exact(&arm(found["model"].as_str().unwrap()), CouplingMode::Reduced).unwrap();
    let upright = |button: &serde_json::Value| {
        let (at, size) = (vector(&button["position"]), vector(&button["size"]));
        // The face looks at the user: its normal is -x, its own x axis up.
        let axes = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]];
        StaticBox::new([at[0], at[1], at[2]], axes, [size[1], size[0], size[2]].map(|x| 0.5 * x))
    };
    let boxes: Vec<StaticBox> = found["buttons"].as_array().unwrap().iter().map(upright).collect();
    let [qpos, qvel, act] = ["qpos", "qvel", "activation"].map(|key| vector(&found[key]));
    for (plan, tolerance) in [(&exact, 1e-6), (&exact.specialised(), 1e-4)] {
        let state = State { qpos: qpos.clone(), qvel: qvel.clone(), act: act.clone() };
        let mut ws = Workspace::<f64>::new(plan);
        step::forward(plan, &Obstacles::new(plan, &boxes, Surface::default()), &state, &mut ws);
        let (force, wanted) = (ws.contacts[0].force, found["contact_force"].as_f64().unwrap());
        assert!((force / wanted - 1.0).abs() < tolerance, "{force} N, not {wanted} N");
        assert_close(&ws.qacc, &DVector::from_vec(vector(&found["qacc"])), tolerance, "acceleration");
        let mut count = [SolverCount::default()];
        ws.tally.take(1, &mut count);
        assert!(count[0].rounds > BLOCK_ROUNDS as u64 && count[0].unsolved == 0, "{:?}", count[0]);
    }
}

#[test]
fn batches_count_per_body_and_counts_do_not_saturate() {
    let plan = exact(CouplingMode::Reduced).specialised();
    let mut batch = Batch::new(&plan, 19, Level::current());
    let free = [0.6, 0.9, -0.5, 1.2, 0.3];
    let [zero, act] = [plan.ndof(), plan.nmuscle()].map(|n| vec![0.0; n]);
    (0..19).for_each(|body| batch.set_state(body, &free, &zero, &act));
    // One body bends its elbow too far.
    let mut bent = free;
    bent[3] = plan.dofs[3].range.unwrap()[1] + 0.1;
    batch.set_state(17, &bent, &[0.0, 0.0, 0.0, 3.0, 0.0], &act);
    batch.step(2);
    batch.step(1);
    for (body, count) in batch.solver_counts().iter().enumerate() {
        assert_eq!((count.steps, count.unsolved), (3, 0), "body {body}");
    }
    let total: SolverCount = batch.solver_counts().iter().copied().sum();
    assert_eq!(total.steps, 57);
    assert!(batch.solver_counts()[0].rounds == 3 && total.rounds >= 57, "{total:?}");

    let mut counts = [SolverCount { steps: 1 << 40, rounds: u64::from(u32::MAX), unsolved: u64::from(u32::MAX) }];
    let mut ws = Workspace::<f64>::new(&plan);
    let word = <f64 as Scalar>::Word::splat;
    (ws.tally.rounds, ws.tally.unsolved) = (word(u32::MAX), word(7));
    ws.tally.take(5, &mut counts);
    ws.tally.take(5, &mut counts);
    let wanted = SolverCount { steps: (1 << 40) + 10, rounds: 2 * u64::from(u32::MAX), unsolved: (1 << 32) + 6 };
    assert_eq!(counts, [wanted]);
}

#[test]
fn a_state_of_the_wrong_length_is_refused_and_no_neighbour_touched() {
    let plan = exact(CouplingMode::Reduced).specialised();
    let mut batch = Batch::new(&plan, 3, Level::current());
    let right = [plan.ndof(), plan.ndof(), plan.nmuscle(), plan.nmuscle()].map(|n| vec![0.5; n]);
    for wrong in 0..4 {
        for by in [-1, 1] {
            let mut arrays = right.clone();
            arrays[wrong].resize((arrays[wrong].len() as isize + by) as usize, 0.5);
            let [qpos, qvel, act, ctrl] = &arrays;
            let ctrl: Vec<f32> = ctrl.iter().map(|&x| x as f32).collect();
            let refused = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                batch.set_ctrl(1, &ctrl);
                batch.set_state(1, qpos, qvel, act);
            }));
            assert!(refused.is_err(), "array {wrong}, {by:+}");
            assert!([0, 2].iter().all(|&body| batch.qpos(body).iter().chain(&batch.act(body)).all(|&x| x == 0.0)));
        }
    }
}
