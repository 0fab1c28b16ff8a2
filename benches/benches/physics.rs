//! One control step of physics alone, 25 steps of 2 ms, on one core: in double precision and on every level of this processor.

use std::cell::LazyCell;
use std::ops::Deref;

use criterion::{BatchSize, BenchmarkGroup, Criterion, Throughput, measurement::WallTime};
use myo_benches::{Numbers, PhysicsScene, SCENES, assert_finite, harness, one_core};
use myo_dynamics::{Batch, Obstacles, Plan, State, Surface, Workspace, step};
use myo_scalar::Level;

/// Physics steps between two draws of the excitations.
const SUBSTEPS: usize = 25;
/// Bodies on lanes.
const BODIES: usize = 256;
/// Bodies in double precision, one after the other.
const REFERENCE_BODIES: usize = 4;
/// Control steps before the first measurement: bodies leave the pose they start in, and come to their limits or the table.
const WARM_UP: usize = 40;

/// Bodies in the middle of a movement.
struct Moving {
    plan: Plan<f64>,
    obstacles: Obstacles<f64>,
    batch: Batch,
    ctrl: Vec<Vec<f32>>,
}

impl Moving {
    fn new(scene: &PhysicsScene) -> Self {
        let plan = scene.plan();
        let obstacles = Obstacles::new(&plan, &scene.boxes(), Surface::default());
        let batch = Batch::new(&plan, BODIES, Level::current()).touching(&scene.boxes(), Surface::default());
        let mut moving = Self { ctrl: vec![vec![0.0; plan.nmuscle()]; BODIES], plan, obstacles, batch };
        let mut numbers = Numbers(1);
        for _ in 0..WARM_UP {
            for (body, ctrl) in moving.ctrl.iter_mut().enumerate() {
                ctrl.iter_mut().for_each(|u| *u = scene.excitation_max * numbers.unit());
                moving.batch.set_ctrl(body, ctrl);
            }
            one_core().install(|| moving.batch.step(SUBSTEPS));
        }
        moving.check(scene);
        moving
    }

    /// A table is touched by most bodies, and nothing is where no table is.
    fn check(&self, scene: &PhysicsScene) {
        let mut ws = Workspace::<f64>::new(&self.plan);
        let touches = (0..BODIES).filter(|&body| {
            let (state, _) = self.state(body);
            step::forward(&self.plan, &self.obstacles, &state, &mut ws);
            ws.contacts[0].force > 0.0
        });
        let share = touches.count() as f64 / BODIES as f64;
        let expected = if scene.table_z_m.is_some() { 0.5..=1.0 } else { 0.0..=0.0 };
        assert!(expected.contains(&share), "{share} of the bodies of `{}` touch something", scene.name);
    }

    /// State and excitations of a body in double precision.
    fn state(&self, body: usize) -> (State<f64>, Vec<f64>) {
        let double = |x: Vec<f32>| x.into_iter().map(f64::from).collect::<Vec<_>>();
        let mut state = State::new(&self.plan);
        state.qpos = double(self.batch.qpos(body));
        state.qvel = double(self.batch.qvel(body));
        state.act = double(self.batch.act(body));
        (state, double(self.ctrl[body].clone()))
    }

    /// The same bodies on lanes of a level.
    fn on(&self, scene: &PhysicsScene, level: Level) -> Batch {
        let mut batch = Batch::new(&self.plan, BODIES, level).touching(&scene.boxes(), Surface::default());
        for (body, ctrl) in self.ctrl.iter().enumerate() {
            let (state, _) = self.state(body);
            batch.set_state(body, &state.qpos, &state.qvel, &state.act);
            batch.set_ctrl(body, ctrl);
        }
        batch
    }
}

/// Bodies in double precision, one after the other.
fn reference(group: &mut BenchmarkGroup<'_, WallTime>, scene: &PhysicsScene, moving: &impl Deref<Target = Moving>) {
    group.throughput(Throughput::Elements((REFERENCE_BODIES * SUBSTEPS) as u64));
    group.bench_function(format!("{}/f64", scene.name), |bencher| {
        let start: Vec<_> = (0..REFERENCE_BODIES).map(|body| moving.state(body)).collect();
        let mut ws = Workspace::<f64>::new(&moving.plan);
        let mut run = |bodies: &mut Vec<(State<f64>, Vec<f64>)>| {
            for (state, ctrl) in bodies {
                (0..SUBSTEPS).for_each(|_| step::step(&moving.plan, &moving.obstacles, ctrl, state, &mut ws));
            }
        };
        bencher.iter_batched_ref(|| start.clone(), &mut run, BatchSize::LargeInput);
        let mut end = start;
        run(&mut end);
        let positions = end.iter().flat_map(|(state, _)| state.qpos.iter().map(|&q| q as f32));
        assert_finite("the positions", positions, REFERENCE_BODIES * moving.plan.ndof());
    });
}

/// Bodies on lanes of a level.
fn lanes(
    group: &mut BenchmarkGroup<'_, WallTime>,
    scene: &PhysicsScene,
    moving: &impl Deref<Target = Moving>,
    level: Level,
) {
    group.throughput(Throughput::Elements((BODIES * SUBSTEPS) as u64));
    group.bench_function(format!("{}/{}", scene.name, level.name()), |bencher| {
        let start = moving.on(scene, level);
        let run = |batch: &mut Batch| one_core().install(|| batch.step(SUBSTEPS));
        bencher.iter_batched_ref(|| start.clone(), run, BatchSize::LargeInput);
        let mut end = start;
        run(&mut end);
        assert_finite("the positions", (0..BODIES).flat_map(|body| end.qpos(body)), BODIES * moving.plan.ndof());
    });
}

fn physics(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("physics");
    for scene in &SCENES.physics {
        let moving = LazyCell::new(|| Moving::new(scene));
        reference(&mut group, scene, &moving);
        for level in Level::available() {
            lanes(&mut group, scene, &moving, level);
        }
    }
    group.finish();
}

fn main() {
    harness(&[physics]);
}
