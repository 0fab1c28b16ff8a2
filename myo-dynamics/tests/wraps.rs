//! Muscle paths over spheres and cylinders: forces fit lengths, lengths are continuous, and every evaluator and plan agrees.

mod common;

use common::{arm, difference, draw, greatest, random_state};
use myo_dynamics::plan::RoundShape;
use myo_dynamics::spatial::{Frame, Rotation, Vec3};
use myo_dynamics::step::wrap::{Course, OnSide, Round, course, points};
use myo_dynamics::step::{self, force, kinematics::kinematics, tendon};
use myo_dynamics::{CouplingMode, Obstacles, Plan, State, Workspace};
use myo_model::description::{Over, PathElement, SideRule, Wrap, WrapShape};
use myo_model::{Model, ModelDescription, builtin};
use myo_scalar::symbolic::{Buffer, Contents, Form, Program, Sharing, Sym, trace_as};
use myo_scalar::{LaneTask, Level, Scalar, dispatch};

/// A body with every kind of path.
fn wraps() -> Plan<f64> {
    wraps_by(SideRule::Mujoco4)
}

/// The same by a rule of sides.
fn wraps_by(rule: SideRule) -> Plan<f64> {
    let mut description = ModelDescription::from_yaml(include_str!("../examples/wraps.yaml"), "wraps.yaml").unwrap();
    description.options.side_rule = rule;
    Plan::exact(&Model::new(&description).unwrap(), CouplingMode::Reduced).unwrap()
}

fn over(wrap: &str, side: Option<&str>) -> PathElement {
    PathElement::Over(Over { over: wrap.into(), side: side.map(Into::into) })
}

/// The built-in arm with round things in the way of its muscles: in the middle between two sites of a path in the zero pose, on
/// bodies of the shoulder girdle, the upper arm, the forearm and the world.
fn wrapped_arm() -> Model {
    let (mut arm, plain) = (builtin("mobl-arms").unwrap(), arm("mobl-arms"));
    let plan = Plan::exact(&plain, CouplingMode::Reduced).unwrap();
    let (state, mut ws) = (State::<f64>::new(&plan), Workspace::<f64>::new(&plan));
    kinematics(&plan, &state.qpos, &state.qvel, &mut ws);
    for (muscle, after, body, is_sphere, side) in [
        ("SUPSP", 0, "humerus", true, None),
        ("DELT1", 1, "scapula", false, None),
        ("DELT2", 0, "world", true, Some("DELT2-P3")),
        ("TMAJ", 0, "scapula", false, Some("TMAJ-P3")),
        ("PECM1", 2, "clavicle", true, None),
        ("LAT1", 2, "thorax", false, None),
        ("LAT2", 2, "scapula", true, Some("LAT1-P1")),
        ("TRIlong", 3, "humerus", false, None),
        ("BIClong", 1, "humerus", true, None),
    ] {
        let index = plain.muscles.iter().position(|other| other.name == muscle).unwrap();
        let site = |k: usize| ws.place(&plan.elements.sites[plain.muscles[index].path[k]]);
        let (a, b) = (site(after), site(after + 1));
        let frame = ws.fixed(&plan.elements.bodies[plain.bodies.iter().position(|other| other.name == body).unwrap()]);
        let middle = (a + b).scale(0.5) + Vec3::new(0.001, 0.002, 0.0);
        let radius = 0.3 * (b - a).dot(b - a).sqrt();
        let shape =
            if is_sphere { WrapShape::Sphere { radius } } else { WrapShape::Cylinder { radius, half_length: 0.1 } };
        let pos = frame.rotation.apply_inverse(middle - frame.position).array();
        arm.wraps.push(Wrap { name: muscle.into(), body: body.into(), shape, pos, quat: [0.9, 0.1, 0.3, -0.2] });
        arm.muscles[index].path.insert(after + 1, over(muscle, side));
    }
    Model::new(&arm).unwrap()
}

/// Whether each stretch bends.
fn bends(ws: &Workspace<f64>) -> Vec<bool> {
    ws.wrap_bends.iter().map(|&bends| bends > 0.5).collect()
}

fn paths(plan: &Plan<f64>, state: &State<f64>, ws: &mut Workspace<f64>) {
    kinematics(plan, &state.qpos, &state.qvel, ws);
    tendon::lengths(plan, ws);
}

#[test]
fn bodies_with_wraps_do_not_run_away() {
    wraps().try_out().unwrap();
    Plan::exact(&wrapped_arm(), CouplingMode::Reduced).unwrap().try_out().unwrap();
}

#[test]
fn every_stretch_bends_in_some_states_and_not_in_others() {
    let plan = wraps();
    let mut ws = Workspace::<f64>::new(&plan);
    let mut counts = vec![0; ws.wrap_lines.len()];
    for number in 0..1000 {
        paths(&plan, &random_state(&plan, number), &mut ws);
        counts.iter_mut().zip(bends(&ws)).for_each(|(count, bends)| *count += u32::from(bends));
    }
    assert!(counts.len() >= 18, "{}", counts.len());
    assert!(counts.iter().all(|&count| count > 5 && count < 995), "{counts:?}");
}

#[test]
fn forces_are_the_derivatives_of_lengths() {
    RULES.into_iter().for_each(|rule| check_derivatives(&wraps_by(rule)));
}

fn check_derivatives(plan: &Plan<f64>) {
    const H: f64 = 1e-6;
    let mut ws = [0, 1, 2].map(|_| Workspace::<f64>::new(plan));
    let (mut compared, mut left_out) = (0, 0);
    for number in 0..500 {
        let state = random_state(plan, number);
        paths(plan, &state, &mut ws[1]);
        for muscle in 0..plan.nmuscle() {
            let now = &mut ws[1];
            let moments = force::moment_arms::<f64>(plan, muscle, now);
            let rate: f64 = moments.iter().zip(&state.qvel).map(|(moment, speed)| moment * speed).sum();
            assert!((rate - now.tendon_velocity[muscle]).abs() < 1e-12, "state {number}, muscle {muscle}");
            for (dof, &moment) in moments.iter().enumerate() {
                for (ws, by) in ws.iter_mut().zip([-H, 0.0, H]) {
                    let mut state = state.clone();
                    state.qpos[dof] += by;
                    paths(plan, &state, ws);
                }
                if bends(&ws[0]) != bends(&ws[2]) {
                    left_out += 1;
                    continue;
                }
                let slope = (ws[2].tendon_length[muscle] - ws[0].tendon_length[muscle]) / (2.0 * H);
                assert!((slope - moment).abs() < 1e-8, "state {number}, muscle {muscle}, {dof}: {slope} for {moment}");
                compared += 1;
            }
        }
    }
    assert!(compared > 40_000 && left_out < 100, "{compared} compared, {left_out} left out");
}

#[test]
fn the_specialised_plan_equals_the_exact_one() {
    // Lengths (m), rates (m/s) and forces as in `specialised.rs`.
    let plans = [wraps(), wraps_by(SideRule::Mujoco3), Plan::exact(&wrapped_arm(), CouplingMode::Reduced).unwrap()];
    for (plan, exact) in plans.iter().enumerate() {
        let fast = exact.specialised();
        assert!(!fast.tendons.wraps.is_empty());
        let (mut a, mut b) = (Workspace::<f64>::new(exact), Workspace::<f64>::new(&fast));
        let mut bent = vec![0; a.wrap_lines.len()];
        let mut turned = 0;
        for number in 0..1000 {
            let state = random_state(exact, number);
            step::forward(exact, &Obstacles::none(exact), &state, &mut a);
            step::forward(&fast, &Obstacles::none(&fast), &state, &mut b);
            if bends(&a) != bends(&b) {
                turned += 1;
                continue;
            }
            bent.iter_mut().zip(bends(&a)).for_each(|(count, bends)| *count += u32::from(bends));
            let check = |what: &str, error: f64, bound: f64| {
                assert!(error <= bound, "plan {plan}, state {number}: {what} differs by {error:e}");
            };
            check("tendon length", difference(&a.tendon_length, &b.tendon_length), 1e-8);
            check("tendon velocity", difference(&a.tendon_velocity, &b.tendon_velocity), 5e-7);
            check("torque", difference(&a.torque, &b.torque), 5e-5);
            check("acceleration", difference(&a.qacc, &b.qacc), 5e-6 * greatest(&a.qacc));
        }
        assert!(turned <= 1, "plan {plan}: {turned} states");
        assert!(bent.iter().all(|&count| count > 0), "plan {plan}: {bent:?}");
    }
}

/// Lengths, rates and moment arms of all muscles, one after the other.
fn quantities<S: Scalar>(plan: &Plan<S::Const>, qpos: &[S], qvel: &[S], ws: &mut Workspace<S>) -> Vec<S> {
    kinematics(plan, qpos, qvel, ws);
    tendon::lengths(plan, ws);
    let mut out = [&ws.tendon_length[..], &ws.tendon_velocity[..]].concat();
    for muscle in 0..plan.nmuscle() {
        out.extend(force::moment_arms(plan, muscle, ws));
    }
    out
}

/// The same of states in lanes.
struct Lanes<'a>(&'a Plan<f32>, &'a [State<f64>]);

impl LaneTask for Lanes<'_> {
    type Output = Vec<Vec<f32>>;
    #[inline(always)]
    fn run<S: Scalar<Const = f32>>(self) -> Self::Output {
        let Self(plan, states) = self;
        let (n, mut ws) = (plan.ndof(), Workspace::<S>::new(plan));
        let mut out = vec![];
        for block in states.chunks(S::LANES) {
            let column = |of: fn(&State<f64>) -> &[f64], k: usize| {
                let lane = |lane: usize| of(&block[lane.min(block.len() - 1)])[k] as f32;
                S::load(&(0..S::LANES).map(lane).collect::<Vec<f32>>())
            };
            let qpos: Vec<S> = (0..n).map(|k| column(|state| &state.qpos, k)).collect();
            let qvel: Vec<S> = (0..n).map(|k| column(|state| &state.qvel, k)).collect();
            let found = quantities(plan, &qpos, &qvel, &mut ws);
            let mut lanes = vec![0.0; S::LANES];
            let first = out.len();
            out.resize(first + block.len(), vec![]);
            for number in found {
                number.store(&mut lanes);
                out[first..].iter_mut().zip(&lanes).for_each(|(out, &x)| out.push(x));
            }
        }
        out
    }
}

/// States around those where a stretch begins or ends to bend on the way of one coordinate: both sides of the place, and the
/// place itself. Left out where the length jumps, because a path changes its way.
fn onsets(plan: &Plan<f64>) -> Vec<State<f64>> {
    let mut ws = Workspace::<f64>::new(plan);
    let mut out = vec![];
    let place = |step: usize| -1.0 + 0.02 * step as f64;
    for number in 0..12 {
        let state = random_state(plan, 5000 + number);
        for dof in 0..plan.ndof() {
            let mut at = |position: f64| {
                let mut state = state.clone();
                state.qpos[dof] = position;
                paths(plan, &state, &mut ws);
                (bends(&ws), ws.tendon_length.clone(), state)
            };
            for step in 0..100 {
                let (mut low, mut high) = (place(step), place(step + 1));
                let before = at(low).0;
                let after = at(high).0;
                let Some(stretch) = (0..before.len()).find(|&k| before[k] != after[k]) else { continue };
                for _ in 0..45 {
                    let middle = 0.5 * (low + high);
                    *(if at(middle).0[stretch] == before[stretch] { &mut low } else { &mut high }) = middle;
                }
                if difference(&at(low).1, &at(high).1) < 1e-9 {
                    out.extend([-1e-3, -1e-5, -1e-7, 0.0, 1e-7, 1e-5, 1e-3].map(|by| at(low + by).2));
                }
            }
        }
    }
    out
}

/// Greatest differences of lengths, rates and moment arms, muscle by muscle and state by state; muscles that go another way are
/// counted instead.
fn compare(plan: &Plan<f64>, states: &[State<f64>], found: &[Vec<f64>]) -> ([f64; 3], usize) {
    let (mut ws, m) = (Workspace::<f64>::new(plan), plan.nmuscle());
    let (mut worst, mut other_ways) = ([0.0_f64; 3], 0);
    for (state, found) in states.iter().zip(found) {
        let wanted = quantities(plan, &state.qpos, &state.qvel, &mut ws);
        assert!(found.iter().all(|x| x.is_finite()), "{state:?}");
        for muscle in 0..m {
            let moments = |all: &[f64]| all[2 * m..].chunks(plan.ndof()).nth(muscle).unwrap().to_vec();
            let errors = [
                (found[muscle] - wanted[muscle]).abs(),
                (found[m + muscle] - wanted[m + muscle]).abs(),
                difference(&moments(found), &moments(&wanted)),
            ];
            if errors[2] > 0.01 {
                other_ways += 1;
                continue;
            }
            worst.iter_mut().zip(errors).for_each(|(worst, error)| *worst = worst.max(error));
        }
    }
    (worst, other_ways)
}

#[test]
fn lanes_equal_the_reference_also_where_paths_begin_to_bend() {
    let (exact, arm) = (wraps(), Plan::exact(&wrapped_arm(), CouplingMode::Reduced).unwrap());
    let before = wraps_by(SideRule::Mujoco3);
    for (plan, onsets) in [(&exact, onsets(&exact)), (&before, onsets(&before)), (&arm, vec![])] {
        let random: Vec<State<f64>> = (0..2000).map(|number| random_state(plan, number)).collect();
        for level in Level::available() {
            for (states, what) in [(&random, "random"), (&onsets, "onset")] {
                let found = dispatch(level, Lanes(&plan.cast(), states));
                let found: Vec<Vec<f64>> =
                    found.into_iter().map(|row| row.into_iter().map(f64::from).collect()).collect();
                let (worst, other_ways) = compare(plan, states, &found);
                println!("{} {what}, {} states: {worst:?}, {other_ways} other ways", level.name(), states.len());
                // Lengths (m), rates (m/s at 5 rad/s), moment arms (m).
                for (error, bound) in worst.into_iter().zip([1e-6, 1e-5, 2e-6]) {
                    assert!(error < bound, "{} {what}: {worst:?}", level.name());
                }
                assert!(other_ways <= states.len() / 500, "{} {what}: {other_ways} other ways", level.name());
            }
        }
    }
    assert!(onsets(&exact).len() > 500);
}

#[test]
fn lanes_do_not_depend_on_what_is_beside_them() {
    let plan = wraps().cast();
    let states: Vec<State<f64>> = (0..64).map(|number| random_state(&wraps(), number)).collect();
    for level in Level::available() {
        let all = dispatch(level, Lanes(&plan, &states));
        let backwards: Vec<State<f64>> = states.iter().rev().cloned().collect();
        let turned: Vec<Vec<f32>> = dispatch(level, Lanes(&plan, &backwards)).into_iter().rev().collect();
        assert_eq!(all, turned, "{}", level.name());
        for (state, found) in states.iter().zip(&all) {
            assert_eq!(&dispatch(level, Lanes(&plan, std::slice::from_ref(state)))[0], found, "{}", level.name());
        }
    }
}

#[test]
fn the_recorded_program_computes_what_the_reference_computes() {
    RULES.into_iter().for_each(|rule| check_recorded(&wraps_by(rule)));
}

fn check_recorded(plan: &Plan<f64>) {
    let states: Vec<State<f64>> = (0..300).map(|number| random_state(plan, number)).chain(onsets(plan)).collect();
    for form in [Form::Straight, Form::Paths] {
        let (program, count) = recorded(plan, form);
        let found: Vec<Vec<f64>> = states
            .iter()
            .map(|state| {
                let numbers = [&state.qpos[..], &state.qvel[..]].concat();
                let mut buffers = [Contents::Numbers(numbers), Contents::Numbers(vec![f64::NAN; count])];
                program.interpret(&mut buffers);
                let [_, Contents::Numbers(found)] = buffers else { unreachable!("made so") };
                found
            })
            .collect();
        let (worst, other_ways) = compare(plan, &states, &found);
        let operations = program.operations();
        println!("{form:?}: {} states: {worst:?}, {other_ways} other ways, {operations} operations", states.len());
        // The program's numbers are those of the tables, and the short series of the angle, interpreted in double precision.
        assert!(worst[0] < 2e-7 && worst[1] < 2e-6 && worst[2] < 5e-7, "{form:?}: {worst:?}");
        assert!(other_ways <= states.len() / 500, "{form:?}: {other_ways}");
    }
}

/// A program of [`quantities`], and how many these are.
fn recorded(plan: &Plan<f64>, form: Form) -> (Program, usize) {
    let [input, output] = [0, 1].map(|binding| Buffer { binding, sharing: Sharing::PerEnv });
    let (n, mut count) = (plan.ndof(), 0);
    let program = trace_as(form, || {
        let numbers: Vec<Sym> = (0..2 * n).map(|row| input.number(row)).collect();
        let mut ws = Workspace::<Sym>::new(&plan.cast());
        let out = quantities(&plan.cast(), &numbers[..n], &numbers[n..], &mut ws);
        count = out.len();
        out.into_iter().enumerate().for_each(|(row, x)| output.set_number(row, x));
    });
    (program, count)
}

#[test]
fn in_loops_another_stretch_is_hardly_any_code() {
    let plan = Plan::exact(&arm("myo-arm"), CouplingMode::Reduced).unwrap().specialised();
    let paths = |form| {
        let counts = recorded(&plan, form).0.stage_counts();
        counts
            .iter()
            .filter(|stage| stage.path.contains(&"muscle paths over wraps"))
            .map(|stage| stage.operations)
            .sum::<usize>()
    };
    let (straight, loops) = (paths(Form::Straight), paths(Form::Paths));
    println!("{straight} operations, {loops} in loops");
    assert!(3 * loops < straight, "{straight} and {loops}");
}

fn vector<S: Scalar>(v: [f64; 3]) -> Vec3<S> {
    Vec3::new(S::lit(v[0]), S::lit(v[1]), S::lit(v[2]))
}

/// A path past it.
fn path<S: Scalar>(shape: RoundShape, radius: f64, side: Option<[f64; 3]>, a: [f64; 3], b: [f64; 3]) -> Course<S> {
    let ends = [vector(a), vector(b)];
    let side = match side {
        None => OnSide::Any,
        Some(side) if side.iter().map(|x| x * x).sum::<f64>().sqrt() < radius => OnSide::Inside,
        Some(side) => OnSide::Of(vector(side)),
    };
    course(shape, SideRule::Mujoco4, S::lit(radius), side, ends)
}

const RULES: [SideRule; 2] = [SideRule::Mujoco4, SideRule::Mujoco3];
const SHAPES: [RoundShape; 2] = [RoundShape::Sphere, RoundShape::Cylinder];

#[test]
fn known_paths() {
    let quarter = std::f64::consts::FRAC_PI_2;
    let half = 2.0 * quarter;
    let below = Some([0.0, -2.0, 0.0]);
    for shape in SHAPES {
        let length = |side, a, b| path::<f64>(shape, 1.0, side, a, b).length;
        let near = |found: f64, wanted: f64| assert!((found - wanted).abs() < 1e-12, "{shape:?}: {found} for {wanted}");
        // A tangent, a quarter of the circle, a tangent.
        let (a, b) = ([-1.0, -0.5, 0.0], [1.0, 1.0, 0.0]);
        near(length(None, a, b), 0.5 + quarter + 1.0);
        near(length(Some([-2.0, 2.0, 0.0]), a, b), 0.5 + quarter + 1.0);
        // The same where a side asks for it.
        let (a, b) = ([-1.0, -3.0, 0.0], [2.0, 1.0, 0.0]);
        near(length(Some([-2.0, 2.0, 0.0]), a, b), 3.0 + quarter + 2.0);
        // Through the middle: either way is as long.
        let (a, b) = ([-2.0, 0.0, 0.0], [2.0, 0.0, 0.0]);
        let over = 2.0 * 3.0_f64.sqrt() + half - 2.0 * (0.5_f64).acos();
        for side in [None, below, Some([0.5, 3.0, 0.0])] {
            near(length(side, a, b), over);
        }
        // The line passes above; a side below pulls it round, three quarters of the circle.
        let (a, b) = ([-1.0, 1.0, 0.0], [1.0, 1.0, 0.0]);
        near(length(None, a, b), 2.0);
        near(length(below, a, b), 2.0 + half);
        near(length(Some([0.0, 2.0, 0.0]), a, b), 2.0);
        // From the surface to the surface.
        let (a, b) = ([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
        near(length(None, a, b), half);
        near(length(below, a, b), half);
        // Inside: straight.
        near(length(None, [0.5, 0.0, 0.0], [3.0, 0.0, 0.0]), 2.5);
        near(length(below, [0.5, 0.0, 0.0], [3.0, 0.0, 0.0]), 2.5);
        // Through: to the top of the circle and back down.
        let inside = Some([0.0, 0.1, 0.0]);
        near(length(inside, [-2.0, 2.0, 0.0], [2.0, 2.0, 0.0]), 2.0 * 5.0_f64.sqrt());
        near(length(inside, [-2.0, 0.5, 0.0], [2.0, 0.5, 0.0]), 4.0);
        near(length(inside, [2.0, 0.0, 0.0], [3.0, 0.0, 0.0]), 3.0);
    }
    // A helix: a half turn that climbs by two.
    let found = path::<f64>(RoundShape::Cylinder, 1.0, None, [-1.0, 0.0, -1.0], [1.0, 0.0, 1.0]);
    assert!((found.length - half.hypot(2.0)).abs() < 1e-12);
}

/// Positions with as many kinds of trouble as there are: at the centre, on the axis, on the surface, next to it, in line.
fn awkward() -> Vec<[f64; 3]> {
    let mut out = vec![];
    for size in [0.0, 1e-30, 1e-9, 0.02, 0.999_999, 1.0, 1.0 + 1e-7, 1.000_001, 1.5, 300.0] {
        let r = 0.03 * size;
        for direction in [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.6, -0.8, 0.0], [-0.48, 0.64, 0.6]] {
            out.push(direction.map(|x: f64| x * r));
        }
    }
    out
}

#[test]
fn nothing_is_ever_not_a_number() {
    fn check<S: Scalar + std::fmt::Debug>(number: fn(S) -> f64) {
        let sides = [None, Some([0.0; 3]), Some([0.01, 0.0, 0.0]), Some([0.0, 0.05, 0.0]), Some([0.0, 0.0, 0.05])];
        for (shape, side) in SHAPES.into_iter().flat_map(|shape| sides.map(|side| (shape, side))) {
            for (a, b) in awkward().into_iter().flat_map(|a| awkward().into_iter().map(move |b| (a, b))) {
                let path = path::<S>(shape, 0.03, side, a, b);
                let numbers = [path.leaving.array(), path.arriving.array()].concat();
                let what = || format!("{shape:?} {side:?} from {a:?} to {b:?}: {path:?}");
                assert!(numbers.iter().all(|&x| number(x).abs() < 1.0 + 1e-5), "{}", what());
                let length = number(path.length);
                let straight = (0..3).map(|k| (b[k] - a[k]).powi(2)).sum::<f64>().sqrt();
                assert!(length.is_finite() && length > straight * (1.0 - 1e-5) - 1e-7, "{}", what());
                // To the circle, all around, and back.
                let far = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
                assert!(length < 1.001 * (far(a) + far(b) + std::f64::consts::TAU * 0.03), "{}", what());
            }
        }
    }
    check::<f64>(|x| x);
    check::<f32>(f64::from);
}

/// A path that begins to bend, comes off again and passes close by, its length as a function of time.
fn sweep<S: Scalar>(shape: RoundShape, side: Option<[f64; 3]>, case: u32, time: f64, number: fn(S) -> f64) -> f64 {
    let between = |entry: usize, lo: f64, hi: f64| lo + (hi - lo) * draw(7000 + case, entry);
    let height = between(0, -0.06, -0.045) + 0.1 * time;
    // Over a sphere all in one plane: the plane of other paths may turn about the line between their ends.
    let climb = if shape == RoundShape::Sphere { 0.0 } else { 1.0 };
    let a = [-between(1, 0.031, 0.09), height, climb * between(2, -0.03, 0.03)];
    let b = [between(3, 0.031, 0.09), height + between(4, -0.005, 0.005), climb * between(5, -0.03, 0.03)];
    number(path::<S>(shape, 0.03, side, a, b).length)
}

#[test]
fn lengths_are_continuous_in_both_precisions() {
    const STEPS: usize = 4000;
    for (shape, case) in SHAPES.into_iter().flat_map(|shape| (0..40).map(move |case| (shape, case))) {
        // No end crosses the ray opposite the side, where a path snaps off.
        for side in [None, Some([0.0, 0.0, 0.001]), Some([0.0, -0.1, 0.0])] {
            let mut last = None;
            for step in 0..=STEPS {
                let time = step as f64 / STEPS as f64;
                let [double, single] =
                    [sweep::<f64>(shape, side, case, time, |x| x), sweep::<f32>(shape, side, case, time, f64::from)];
                let what = || format!("{shape:?} {side:?} case {case} at {time}");
                if let Some(last) = last.replace(double) {
                    // Both ends move by 0.1 m in all.
                    let most = 0.2 / STEPS as f64;
                    let jump: f64 = double - last;
                    assert!(jump.abs() < 1.01 * most, "{}: jumps by {jump:e}", what());
                }
                assert!((single - double).abs() < 3e-7, "{}: {single} for {double}", what());
            }
        }
    }
}

#[test]
fn wraps_change_nothing_where_they_are_out_of_the_way() {
    let mut far = builtin("mobl-arms").unwrap();
    let shape = WrapShape::Sphere { radius: 0.01 };
    let (name, body) = ("far".to_owned(), "world".to_owned());
    far.wraps.push(Wrap { name, body, shape, pos: [5.0, 5.0, 5.0], quat: [1.0, 0.0, 0.0, 0.0] });
    for muscle in &mut far.muscles {
        muscle.path.insert(1, over("far", None));
    }
    let [plan, far] =
        [arm("mobl-arms"), Model::new(&far).unwrap()].map(|model| Plan::exact(&model, CouplingMode::Reduced).unwrap());
    let (mut a, mut b) = (Workspace::<f64>::new(&plan), Workspace::<f64>::new(&far));
    for number in 0..200 {
        let state = random_state(&plan, number);
        step::forward(&plan, &Obstacles::none(&plan), &state, &mut a);
        step::forward(&far, &Obstacles::none(&far), &state, &mut b);
        assert!(difference(&a.tendon_length, &b.tendon_length) < 1e-14);
        assert!(difference(&a.qacc, &b.qacc) < 1e-9 * greatest(&a.qacc));
    }
}

#[test]
fn the_rule_before_4_goes_by_the_side_of_a_site_once_the_line_is_on_the_other() {
    let side = vector::<f64>([0.0, 2.0, 0.0]);
    let length = |rule, height: f64| {
        let ends = [vector([-2.0, height, 0.0]), vector([2.0, height, 0.0])];
        course(RoundShape::Cylinder, rule, 1.0, OnSide::Of(side), ends).length
    };
    // Above and below the cylinder: by 4.0 a line under it goes by the side only if it is that way round.
    for rule in RULES {
        assert_eq!(length(rule, 1.5), 4.0, "clear of it on its side");
        assert!(length(rule, 0.5) > 4.0 && length(rule, -0.5) > length(rule, 0.5), "through it");
    }
    assert!(length(SideRule::Mujoco3, -1.5) > 6.0, "clear of it on the other side");
}

/// Where a way through a circle of radius 1 touches it, both lines make the same angle with the radius, as far as an end may be from
/// where it is and however close to the circle.
#[test]
fn ways_through_meet_the_circle_at_equal_angles() {
    let mut bent = 0;
    for case in 0..20_000 {
        let draw = |entry: usize| draw(31_000 + case, entry);
        // Radius by distance, down to a ten-millionth below one; and the angle between the ends, up to where the straight line cuts.
        let far =
            |entry: usize| if case % 2 == 0 { 0.02 + 0.97 * draw(entry) } else { 1.0 - 10f64.powf(-7.0 * draw(entry)) };
        let ratios = [far(0), far(1)];
        let most = (ratios[0].acos() + ratios[1].acos()).min(std::f64::consts::PI);
        let between = most * if case % 4 < 2 { draw(2) } else { 1.0 - 10f64.powf(-6.0 * draw(2)) };
        let (sin, cos) = between.sin_cos();
        let (a, b) = ([1.0 / ratios[0], 0.0, 0.0], [cos / ratios[1], sin / ratios[1], 0.0]);
        let way = path::<f64>(RoundShape::Cylinder, 1.0, Some([0.0; 3]), a, b);
        if !way.bends {
            continue;
        }
        bent += 1;
        // The first point of the circle on the line that leaves.
        let (towards, reach) = (-way.leaving.x / ratios[0], 1.0 / ratios[0]);
        let along = towards - (towards * towards - (reach * reach - 1.0)).max(0.0).sqrt();
        let (x, y) = (reach + along * way.leaving.x, along * way.leaving.y);
        let angle = |dx: f64, dy: f64| (x * dy - y * dx).atan2(x * dx + y * dy);
        let [first, last] = [-angle(-way.leaving.x, -way.leaving.y), angle(b[0] - x, b[1] - y)];
        let seen = |psi: f64, ratio: f64| psi - (ratio * psi.sin()).asin();
        let left = seen(first, ratios[0]) + seen(first, ratios[1]) - between;
        // A line that all but grazes the circle, or comes from afar, meets it somewhere about there, and a short one has its direction from
        // few digits.
        let sure = first.cos().abs() * along.min((b[0] - x).hypot(b[1] - y)) / (reach * reach);
        assert!(left.abs() < 1e-13 + 1e-13 / sure, "{case}: {left} of the angle, {first}, {ratios:?}, {between}");
        if case % 2 == 0 {
            assert!((first - last).abs() < 1e-11 + 1e-13 / sure, "{case}: {first} and {last}, {ratios:?}, {between}");
        }
    }
    assert!(bent > 15_000, "{bent} of 20,000 ways bend");
}

#[test]
fn points_lie_on_the_path() {
    let near = |found: f64, wanted: f64, bound: f64| assert!((found - wanted).abs() < bound, "{found} for {wanted}");
    let distance = |a: Vec3<f64>, b: Vec3<f64>| (b - a).dot(b - a).sqrt();
    let (mut bent, mut straight) = (0, 0);
    for case in 0..400 {
        let between = |entry: usize, lo: f64, hi: f64| lo + (hi - lo) * draw(9000 + case, entry);
        let place = |first: usize, size: f64| Vec3::splat([0, 1, 2].map(|k| between(first + k, -size, size)));
        let turn = nalgebra::Rotation3::from_scaled_axis(nalgebra::Vector3::from(place(0, 3.0).array()));
        let axes = [0, 1, 2].map(|k| Vec3::splat(turn.matrix().column(k).into_owned().into()));
        let frame = Frame { rotation: Rotation { x: axes[0], y: axes[1], z: axes[2] }, position: place(3, 0.1) };
        let (a, b, side) = (place(6, 0.3), place(9, 0.3), (case % 3 > 0).then(|| place(12, 0.1)));
        let round = Round { shape: SHAPES[case as usize % 2], rule: RULES[case as usize / 2 % 2], radius: 0.05, frame };
        let local = |p: Vec3<f64>| frame.rotation.apply_inverse(p - frame.position);
        let told = side.map_or(OnSide::Any, |side| OnSide::told_by(local(side), round.shape, round.radius));
        let path = course(round.shape, round.rule, round.radius, told, [local(a), local(b)]);
        let found = points(&round, side, [a, b], 200);
        let all: Vec<Vec3<f64>> = [a].into_iter().chain(found.iter().copied()).chain([b]).collect();
        let length: f64 = all.windows(2).map(|ends| distance(ends[0], ends[1])).sum();
        near(length, path.length, 2e-5);
        if path.length > distance(a, b) + 1e-9 {
            for point in found {
                let p = local(point);
                let off_axis = if round.shape == RoundShape::Sphere { p.dot(p).sqrt() } else { p.x.hypot(p.y) };
                near(off_axis, round.radius, 1e-9);
            }
            // Ends in the directions that pull.
            let [first, last] = [all[1] - a, b - all[all.len() - 2]];
            near(first.dot(frame.rotation.apply(path.leaving)), distance(a, all[1]), 1e-9);
            near(last.dot(frame.rotation.apply(path.arriving)), distance(b, all[all.len() - 2]), 1e-9);
            bent += 1;
        } else {
            straight += 1;
        }
    }
    assert!(bent > 50 && straight > 50, "{bent} bent, {straight} straight");
}
