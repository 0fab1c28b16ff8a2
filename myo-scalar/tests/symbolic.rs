//! Recorded programs: what is simplified away, and that the rest computes what the code computes.

use myo_scalar::symbolic::{Buffer, Contents, Entries, Form, Item, Op, Program, Sharing, Sym, trace, trace_as};
use myo_scalar::{
    Carried, Counter, LaneTask, Level, Mask, RowMap, Scalar, Stage, Visitor, Word, dispatch, normal_pair, philox,
    seed_words,
};
use proptest::prelude::*;

const IN: Buffer = Buffer { binding: 0, sharing: Sharing::PerEnv };
const OUT: Buffer = Buffer { binding: 1, sharing: Sharing::PerEnv };

/// Records a function of some numbers.
fn record(arity: usize, f: impl FnOnce(&[Sym]) -> Vec<Sym>) -> Program {
    record_as(Form::Straight, arity, f)
}

fn record_as(form: Form, arity: usize, f: impl FnOnce(&[Sym]) -> Vec<Sym>) -> Program {
    trace_as(form, || {
        let inputs: Vec<Sym> = (0..arity).map(|row| IN.number(row)).collect();
        for (row, &value) in f(&inputs).iter().enumerate() {
            OUT.set_number(row, value);
        }
    })
}

fn run(program: &Program, inputs: &[f64], outputs: usize) -> Vec<f64> {
    let mut buffers = [Contents::Numbers(inputs.to_vec()), Contents::Numbers(vec![f64::NAN; outputs])];
    program.interpret(&mut buffers);
    match &buffers[1] {
        Contents::Numbers(out) => out.clone(),
        Contents::Words(_) => unreachable!("made as numbers"),
    }
}

fn operations(f: impl FnOnce(Sym, Sym) -> Sym) -> usize {
    record(2, |x| vec![f(x[0], x[1])]).operations()
}

#[test]
fn a_program_says_which_entries_of_a_buffer_it_touches() {
    let shared = Buffer { binding: 2, sharing: Sharing::Shared };
    let program = trace(|| {
        let unused = IN.number(9);
        OUT.set_number(3, IN.number(4) + Sym::from_word(shared.word(1)));
        Sym::when(Sym::zero().lt(IN.number(0)), &mut Nothing, |_| OUT.set_number(6, IN.number(5)));
        let _ = unused + unused;
    });
    let entries = |per_env, shared| Entries { per_env, shared };
    assert_eq!([0, 1, 2, 3].map(|k| program.entries(k)), [entries(6, 0), entries(7, 0), entries(0, 2), entries(0, 0)]);
    assert_eq!((entries(7, 0).needed(10), entries(0, 2).needed(10), entries(3, 40).needed(10)), (70, 2, 40));
}

/// A branch without variables: it only writes.
struct Nothing;

impl Carried<Sym> for Nothing {
    fn visit(&mut self, _: &mut impl Visitor<Sym>) {}
}

#[test]
fn identities_leave_nothing_to_compute() {
    let (zero, one) = (Sym::zero, || Sym::lit(1.0));
    type Function = fn(Sym, Sym) -> Sym;
    let free: [(&str, Function); 12] = [
        ("x * 1", |x, _| x * Sym::lit(1.0)),
        ("x * 0 + y", |x, y| x * Sym::zero() + y),
        ("x + 0", |x, _| x + Sym::zero()),
        ("0 + x - 0", |x, _| Sym::zero() + x - Sym::zero()),
        ("--x", |x, _| -(-x)),
        ("x - x", |x, _| x - x),
        ("x * -1", |x, _| x * Sym::lit(-1.0)),
        ("0 y + x", |x, y| Sym::zero().mul_add(y, x)),
        ("select(m, x, x)", |x, y| Sym::select(x.lt(y), x, x)),
        ("select(true, x, y)", |x, y| Sym::select(<Sym as Scalar>::Mask::splat(true), x, y)),
        ("constants", |_, _| (Sym::lit(2.0).sqrt() * Sym::lit(3.0)).max(Sym::lit(1.0))),
        ("min(x, x)", |x, _| x.min(x)),
    ];
    for (name, f) in free {
        assert_eq!(operations(f), 0, "{name}");
    }
    assert_eq!(run(&record(1, |x| vec![x[0] * zero() + one()]), &[7.0], 1), [1.0]);
}

#[test]
fn equal_work_is_done_once_and_useless_work_never() {
    assert_eq!(operations(|x, y| (x * y + Sym::lit(1.0)) * (y * x + Sym::lit(1.0))), 2);
    assert_eq!(operations(|x, y| (-x) * (-y)), 1);
    assert_eq!(operations(|x, _| x * Sym::lit(2.0) * Sym::lit(3.0) + Sym::lit(1.0) + Sym::lit(1.0)), 1);
    assert_eq!(operations(|x, _| x.clamp(0.0, 1.0).clamp(0.0, 1.0)), 1);
    let program = record(2, |x| {
        let _ = x[0].exp() * x[1];
        vec![x[0]]
    });
    assert_eq!(program.operations(), 0);
}

/// A few steps of everything that a loop can do, generic: a power, a Newton root with an early end, a branch, chunks.
fn everything<S: Scalar>(x: S, y: S) -> Vec<S> {
    struct Vars<S>(S, S);
    impl<S: Scalar> Carried<S> for Vars<S> {
        fn visit(&mut self, visitor: &mut impl Visitor<S>) {
            visitor.numbers([&mut self.0, &mut self.1]);
        }
    }
    let mut power = Vars(S::lit(1.0), x);
    S::repeat(5, &mut power, |v| v.0 = v.0 * v.1);
    let mut root = Vars(S::lit(1.0), S::zero());
    let square = y.abs() + S::lit(0.5);
    S::repeat_while(40, &mut root, |v| {
        let next = (v.0 + square * v.0.recip()) * S::lit(0.5);
        let step = (next - v.0).abs();
        *v = Vars(next, v.1 + S::lit(1.0));
        S::lit(1e-9).lt(step)
    });
    let mut chosen = Vars(x, y);
    let mask = x.lt(y);
    S::when(mask, &mut chosen, |v| {
        let mut inner = Vars(v.0, v.1);
        S::repeat(3, &mut inner, |v| v.0 += v.1);
        v.0 = S::select(mask, inner.0, v.0);
    });
    let mut values = vec![x, y, x + y, x - y];
    S::map_chunks(&mut values, |index, [a, b]: [S; 2]| [a * b, a + S::from_word(index)]);
    [vec![power.0, root.0, chosen.0, chosen.1], values].concat()
}

proptest! {
    #[test]
    fn loops_branches_and_chunks_compute_what_plain_code_computes(x in -2.0..2.0, y in -2.0..2.0) {
        let program = record(2, |v| everything(v[0], v[1]));
        let want = everything::<f64>(x, y);
        for (got, want) in run(&program, &[x, y], want.len()).into_iter().zip(want) {
            prop_assert!((got - want).abs() <= 1e-12 * (1.0 + want.abs()), "{got} for {want}");
        }
    }

    #[test]
    fn elementary_functions_are_those_of_the_lanes(x in -50.0..50.0f64, y in 1e-6..1e6f64) {
        let program = record(2, |v| {
            let (sin, cos) = v[0].sin_cos();
            let (minus, _) = (-v[0]).sin_cos();
            vec![sin, cos, minus, (v[0] * Sym::lit(0.5)).exp(), v[1].ln()]
        });
        let (sin, cos) = x.sin_cos();
        for (got, want) in run(&program, &[x, y], 5).into_iter().zip([sin, cos, -sin, (0.5 * x).exp(), y.ln()]) {
            prop_assert!((got - want).abs() <= 3e-7 * (1.0 + want.abs()), "{got} for {want}");
        }
    }

    #[test]
    fn random_draws_are_the_same(seed: u64, env: u32, step: u32) {
        fn draw<S: Scalar>(seed: u64, [env, step]: [S::Word; 2]) -> [S; 3] {
            let [episode, stream] = [3, 0x1001].map(S::Word::splat);
            let words = philox::<S>(Counter { seed: seed_words(seed), env, episode, step, stream });
            let (a, b) = normal_pair(words[0], words[1]);
            [a, b, S::from_word(words[3] >> 8)]
        }
        let words = Buffer { binding: 0, sharing: Sharing::PerEnv };
        let program = trace(|| {
            for (row, value) in draw::<Sym>(seed, [words.word(0), words.word(1)]).into_iter().enumerate() {
                OUT.set_number(row, value);
            }
        });
        let mut buffers = [Contents::Words(vec![env, step]), Contents::Numbers(vec![0.0; 3])];
        program.interpret(&mut buffers);
        let want = draw::<f64>(seed, [env, step].map(<f64 as Scalar>::Word::splat));
        let Contents::Numbers(got) = &buffers[1] else { unreachable!("made as numbers") };
        // Logarithm, sine and cosine are good to 3e-7 (1 + |value|), see above; the radius is the root of -2 ln u.
        let radius = want[0].hypot(want[1]);
        let bound = 6e-7 * radius + 3e-7 * (1.0 + 0.5 * radius * radius) / radius;
        for (got, want) in got.iter().zip(want).take(2) {
            prop_assert!((got - want).abs() <= bound, "{got} for {want}, within {bound}");
        }
        prop_assert_eq!(got[2], want[2]);
    }
}

#[test]
fn what_a_loop_does_not_change_is_computed_before_it_and_what_it_keeps_is_no_variable() {
    struct Vars(Sym, Sym);
    impl Carried<Sym> for Vars {
        fn visit(&mut self, visitor: &mut impl Visitor<Sym>) {
            visitor.numbers([&mut self.0, &mut self.1]);
        }
    }
    let program = record(2, |x| {
        let mut vars = Vars(x[0], x[1]);
        Sym::repeat(10, &mut vars, |v| v.0 += x[1].sqrt());
        vec![vars.0, vars.1]
    });
    let order = program.order();
    assert_eq!(order.len(), 2, "the program and the body");
    assert_eq!(program.live_carries(0).count(), 1);
    let body: Vec<_> = order[1].iter().collect();
    assert_eq!(body.len(), 2, "the variable and the sum; the root is outside: {body:?}");
    let got = run(&program, &[1.0, 4.0], 2);
    assert_eq!(got, [21.0, 4.0]);
}

#[test]
fn operations_are_counted_per_stage() {
    struct Half(Sym);
    impl Stage<Sym> for Half {
        const NAME: &'static str = "half";
        type Output = Sym;
        fn run(self) -> Sym {
            self.0 * Sym::lit(0.5)
        }
    }
    let program = record(1, |x| vec![Sym::outline(Half(x[0])).sqrt()]);
    let counts: Vec<(String, usize)> =
        program.stage_counts().into_iter().map(|stage| (stage.path.join("/"), stage.operations)).collect();
    assert_eq!(counts, [("program".into(), 1), ("program/half".into(), 1)]);
}

#[test]
#[should_panic(expected = "must be one of its variables")]
fn a_number_from_inside_a_loop_is_refused_outside() {
    struct Nothing;
    impl Carried<Sym> for Nothing {
        fn visit(&mut self, _: &mut impl Visitor<Sym>) {}
    }
    record(1, |x| {
        let mut inside = x[0];
        Sym::when(x[0].lt(Sym::zero()), &mut Nothing, |_| inside = x[0].sqrt());
        vec![inside + Sym::lit(1.0)]
    });
}

#[test]
fn a_panic_ends_the_trace_it_happened_in() {
    let inside_a_stage = || {
        struct Fails;
        impl Stage<Sym> for Fails {
            const NAME: &'static str = "fails";
            type Output = ();
            fn run(self) {
                panic!("on purpose");
            }
        }
        trace(|| Sym::outline(Fails));
    };
    let nested = || {
        trace(|| {
            trace(|| {});
        });
    };
    for fails in [inside_a_stage as fn(), nested] {
        assert!(std::panic::catch_unwind(fails).is_err());
        assert_eq!(run(&record(1, |x| vec![x[0] + x[0]]), &[2.0], 1), [4.0]);
    }
}

#[test]
fn reads_see_what_was_there_before_writes() {
    let program = trace(|| {
        let (a, b) = (IN.number(0), IN.number(1));
        IN.set_number(0, b);
        IN.set_number(1, a);
    });
    let mut buffers = [Contents::Numbers(vec![1.0, 2.0])];
    program.interpret(&mut buffers);
    assert_eq!(buffers, [Contents::Numbers(vec![2.0, 1.0])]);
}

#[test]
fn what_a_branch_alone_reads_is_read_in_the_branch_unless_it_is_written_elsewhere() {
    let written = Buffer { binding: 2, sharing: Sharing::PerEnv };
    let program = trace(|| {
        let [taken, both, inside, looped] = [0, 1, 2, 3].map(|row| IN.number(row));
        Sym::when(Sym::zero().lt(taken), &mut Nothing, |_| {
            OUT.set_number(0, inside.sqrt() + written.number(0));
            let mut sum = Sum(both);
            Sym::repeat(3, &mut sum, |sum| sum.0 += looped);
            OUT.set_number(1, sum.0);
        });
        OUT.set_number(2, both);
        written.set_number(0, both);
    });
    let order = program.order();
    let reads = |region: usize| -> Vec<_> {
        let op = |item: &Item| match item {
            Item::Node(id) => Some(program.nodes[*id as usize].op),
            Item::Statement(_) => None,
        };
        let row = |op| match op {
            Op::Input(buffer, row) => Some((buffer.binding, row)),
            _ => None,
        };
        order[region].iter().filter_map(op).filter_map(row).collect()
    };
    assert_eq!(reads(0), [(0, 0), (2, 0), (0, 1)], "the branch's mask, what is needed after it, what is written");
    assert_eq!(reads(1), [(0, 2), (0, 3)], "what only the branch needs, once where a loop needs it");
    assert_eq!(reads(2), []);
    let run = |taken: f64| {
        let numbers = |row: &[f64]| Contents::Numbers(row.to_vec());
        let mut buffers = [numbers(&[taken, 2.0, 9.0, 5.0]), numbers(&[0.0; 3]), numbers(&[7.0])];
        program.interpret(&mut buffers);
        buffers
    };
    let numbers = |row: &[f64]| Contents::Numbers(row.to_vec());
    assert_eq!(run(1.0)[1..], [numbers(&[10.0, 17.0, 2.0]), numbers(&[2.0])]);
    assert_eq!(run(-1.0)[1..], [numbers(&[0.0, 0.0, 2.0]), numbers(&[2.0])]);
}

/// One variable of a loop.
struct Sum(Sym);

impl Carried<Sym> for Sum {
    fn visit(&mut self, visitor: &mut impl Visitor<Sym>) {
        visitor.number(&mut self.0);
    }
}

/// Kernels are valid, and their text is what people read.
#[cfg(feature = "gpu")]
#[test]
fn a_kernel_reads_like_the_code() {
    let program = record(2, |x| vec![(x[0] * x[1] + Sym::lit(2.0)).max(Sym::zero())]);
    let wgsl = program.to_kernel(&["numbers", "result"], 64).to_wgsl().unwrap();
    for part in ["@workgroup_size(64, 1, 1)", "numbers_0", "fma(", "max(", "result["] {
        assert!(wgsl.contains(part), "{part} is missing in\n{wgsl}");
    }
    let every = record(2, |v| everything(v[0], v[1]));
    assert!(every.to_kernel(&["numbers", "result"], 64).to_wgsl().is_ok());
}

#[cfg(feature = "gpu")]
#[test]
fn a_function_takes_its_buffers_as_arrays() {
    let [words, result] = [0, 1].map(|binding| Buffer { binding, sharing: Sharing::Shared });
    let program = trace(|| result.set_number(0, Sym::from_word(words.word(1) ^ words.word(2))));
    let wgsl = program.to_wgsl_function("mixed", &["words", "result"]).unwrap();
    let head = "fn mixed(words: ptr<function, array<u32, 3>>, result: ptr<function, array<f32, 1>>)";
    for part in [head, "(*words)[1u]", "(*result)[0u] ="] {
        assert!(wgsl.contains(part), "{part} is missing in\n{wgsl}");
    }
    assert!(!wgsl.contains("var<"), "{wgsl}");
}

/// A sum over the rows of a table, and a row of it by number. Written once, as all code is.
fn rows<S: Scalar>(table: &[[S; 2]], index: S) -> [S; 4] {
    struct Sum<S> {
        plain: S,
        numbered: S,
    }
    impl<S: Scalar> Carried<S> for Sum<S> {
        fn visit(&mut self, visitor: &mut impl Visitor<S>) {
            visitor.numbers([&mut self.plain, &mut self.numbered]);
        }
    }
    let mut sum = Sum { plain: S::zero(), numbered: S::zero() };
    S::for_each_row(table.len(), &mut sum, |sum, row| {
        let [a, b] = S::of_row(row, table.len(), |k| table[k]);
        sum.plain += a;
        sum.numbered += S::row_number(row) * b;
    });
    let [a, b] = S::gather(table.len(), |k| table[k], index);
    [sum.plain, sum.numbered, a, b]
}

proptest! {
    #[test]
    fn rows_by_number_are_those_of_plain_code(table in prop::collection::vec([-9.0..9.0, -9.0..9.0], 1..12), index in -3.0..15.0_f64) {
        let index = index.floor();
        let want = rows(&table, index);
        let last = (table.len() - 1) as f64;
        prop_assert_eq!(&want[2..], &table[index.clamp(0.0, last) as usize][..]);
        let flat: Vec<f64> = table.iter().flatten().copied().chain([index]).collect();
        // Read from memory, evenly spaced; and chosen from computed numbers.
        for computed in [false, true] {
            let program = record(flat.len(), |x| {
                let change = |x: Sym| if computed { x * Sym::lit(2.0) } else { x };
                let table: Vec<[Sym; 2]> = x[..flat.len() - 1].chunks(2).map(|row| [row[0], row[1]].map(change)).collect();
                rows(&table, x[flat.len() - 1]).to_vec()
            });
            let [plain, numbered, a, b] = want;
            let want = if computed { [2.0 * plain, 2.0 * numbered, 2.0 * a, 2.0 * b] } else { want };
            for (got, want) in run(&program, &flat, 4).into_iter().zip(want) {
                prop_assert!((got - want).abs() < 1e-9, "{} for {}", got, want);
            }
        }
    }
}

#[test]
fn programs_do_not_grow_with_the_rows_of_a_table_in_memory() {
    let operations = |count: usize| {
        record(2 * count + 1, |x| {
            let table: Vec<[Sym; 2]> = x[..2 * count].chunks(2).map(|row| [row[0], row[1]]).collect();
            rows(&table, x[2 * count]).to_vec()
        })
        .operations()
    };
    assert_eq!(operations(4), operations(200));
}

#[test]
fn a_row_beyond_its_table_is_counted_among_what_a_program_touches() {
    let program = record(8, |x| vec![Sym::gather(4, |k| [x[2 * k]], x[7] * x[7])[0]]);
    assert_eq!(program.entries(0), Entries { per_env: 8, shared: 0 });
    let program = trace(|| {
        let table = Buffer { binding: 2, sharing: Sharing::Shared };
        let [x] = Sym::gather(50, |k| [table.number(3 + 2 * k)], IN.number(0));
        OUT.set_number(0, x);
    });
    assert_eq!(program.entries(2), Entries { per_env: 0, shared: 102 });
}

/// Polynomials at places: constants that differ and one that does not, numbers that vary, a loop in the map, more outcomes than are
/// needed.
struct Polynomials<'a, S: Scalar> {
    table: &'a [[S::Const; 2]],
    places: &'a [S],
    sums: Vec<S>,
}

impl<S: Scalar> RowMap<S, 5, 3> for Polynomials<'_, S> {
    #[inline(always)]
    fn take(&self, k: usize) -> [S; 5] {
        let Self { table, places, .. } = self;
        [S::splat(table[k][0]), places[k], S::lit(3.0), S::splat(table[k][1]), places[k] + places[0]]
    }
    #[inline(always)]
    fn map(&self, [slope, x, three, offset, _]: [S; 5]) -> [S; 3] {
        struct Power<S>(S);
        impl<S: Scalar> Carried<S> for Power<S> {
            #[inline(always)]
            fn visit(&mut self, visitor: &mut impl Visitor<S>) {
                visitor.number(&mut self.0);
            }
        }
        let mut power = Power(S::lit(1.0));
        S::repeat(3, &mut power, |power| power.0 = power.0 * x);
        let value = slope.mul_add(x, offset) * three + power.0;
        [value, x.exp(), value - x]
    }
    #[inline(always)]
    fn put(&mut self, k: usize, [value, _, less]: [S; 3]) {
        self.sums.push(self.sums[k] + value * less);
    }
}

/// What the sum of all is after each row.
#[inline(always)]
fn mapped<S: Scalar>(table: &[[S::Const; 2]], places: &[S]) -> Vec<S> {
    let mut rows = Polynomials { table, places, sums: vec![S::zero()] };
    S::map_rows(table.len(), &mut rows);
    rows.sums
}

/// The same in lanes, all alike.
struct MappedLanes<'a>(&'a [[f32; 2]], &'a [f32]);

impl LaneTask for MappedLanes<'_> {
    type Output = Vec<f32>;
    #[inline(always)]
    fn run<S: Scalar<Const = f32>>(self) -> Vec<f32> {
        let places: Vec<S> = self.1.iter().map(|&x| S::splat(x)).collect();
        let mut lanes = vec![0.0; S::LANES];
        let mut last = |x: S| {
            x.store(&mut lanes);
            lanes[S::LANES - 1]
        };
        mapped(self.0, &places).into_iter().map(&mut last).collect()
    }
}

proptest! {
    #[test]
    fn mapped_rows_are_those_of_plain_code_in_every_kind_of_number(
        rows in prop::collection::vec([-2.0..2.0f32, -2.0..2.0, -2.0..2.0], 1..9)
    ) {
        let places: Vec<f32> = rows.iter().map(|row| row[0]).collect();
        let table: Vec<[f32; 2]> = rows.iter().map(|row| [row[1], row[2]]).collect();
        let (wide_table, wide_places): (Vec<[f64; 2]>, Vec<f64>) =
            (table.iter().map(|row| row.map(f64::from)).collect(), places.iter().map(|&x| f64::from(x)).collect());
        let want = mapped::<f64>(&wide_table, &wide_places);
        for form in [Form::Straight, Form::Paths, Form::Loops] {
            let program = record_as(form, rows.len(), |x| mapped(&wide_table, x));
            for (got, want) in run(&program, &wide_places, want.len()).into_iter().zip(&want) {
                prop_assert!((got - want).abs() <= 1e-9 * (1.0 + want.abs()), "{form:?}: {got} for {want}");
            }
        }
        for level in Level::available() {
            for (got, want) in dispatch(level, MappedLanes(&table, &places)).into_iter().zip(&want) {
                prop_assert!((f64::from(got) - want).abs() <= 1e-4 * (1.0 + want.abs()), "{}: {got} for {want}", level.name());
            }
        }
    }
}

#[test]
fn rows_that_a_loop_maps_are_recorded_once_and_keep_only_what_is_needed() {
    let table: Vec<[f64; 2]> = (0..20).map(|k| [f64::from(k), 1.0]).collect();
    let count = |form| record_as(form, 20, |x| mapped(&table, x)).operations();
    let (straight, loops) = (count(Form::Straight), count(Form::Paths));
    // One sum per row stays.
    assert!(straight > 60 && loops < 20 + 20, "{straight} and {loops}");
    let program = record_as(Form::Paths, 20, |x| mapped(&table, x));
    assert!(program.live_nodes().all(|id| program.nodes[id as usize].op != Op::Round), "the exponential is not needed");
}

/// Kernels of loops over rows are valid, and what they keep is there once per row.
#[cfg(feature = "gpu")]
#[test]
fn a_kernel_keeps_the_rows_of_a_loop_in_an_array() {
    let table: Vec<[f64; 2]> = (0..20).map(|k| [f64::from(k), 1.0]).collect();
    let kernel = record_as(Form::Paths, 20, |x| mapped(&table, x)).to_kernel(&["numbers", "result"], 64);
    let wgsl = kernel.to_wgsl().unwrap();
    // Place in, value out; the difference out.
    assert!(wgsl.contains("array<f32, 40>"), "{wgsl}");
    // How many rows there are, and the slopes.
    assert_eq!(kernel.table.len(), 21);
}
