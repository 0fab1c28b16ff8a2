//! Single operations, many buffers, and what is refused.

use myo_native::{LANES, Memory, NativeError, Routine, View};
use myo_scalar::symbolic::{Buffer, Contents, Program, Sharing, Sym, SymWord, trace};
use myo_scalar::{Carried, Scalar, Visitor, Word};

const fn per_env(binding: u32) -> Buffer {
    Buffer { binding, sharing: Sharing::PerEnv }
}

/// A program as machine code; none where the processor has no AVX-512.
fn compiled(program: &Program) -> Option<Routine> {
    match Routine::compile(program) {
        Err(NativeError::Unsupported) => {
            println!("skipped: no AVX-512 here");
            None
        }
        routine => Some(routine.expect("the program is compiled")),
    }
}

#[test]
fn integers_are_those_of_the_interpreter() {
    let buffer = per_env(0);
    let program = trace(|| {
        let (x, y): (SymWord, SymWord) = (buffer.word(0), buffer.word(1));
        let found = [x + y, x ^ y, x & y, x | (y << 3), x >> 5, x.mul_wide(0xD251_1F53).0, y.mul_wide(0xCD9E_8D57).1];
        for (k, x) in found.into_iter().enumerate() {
            buffer.set_word(2 + k, x);
        }
    });
    let Some(routine) = compiled(&program) else { return };
    let mut words: Vec<u32> = (0..9 * LANES as u32).map(|k| k.wrapping_mul(2_654_435_761).rotate_left(k)).collect();
    let before = words.clone();
    routine.run(&mut [View::WordsMut(&mut words)], &mut Memory::default());
    for lane in 0..LANES {
        let mut contents = [Contents::Words(before.iter().skip(lane).step_by(LANES).copied().collect())];
        program.interpret(&mut contents);
        let found: Vec<u32> = words.iter().skip(lane).step_by(LANES).copied().collect();
        assert_eq!(contents[0], Contents::Words(found));
    }
}

#[test]
fn roots_quotients_and_elementary_functions_are_exact_to_single_precision() {
    let [xs, ys] = [0, 1].map(per_env);
    let program = trace(|| {
        let x: Sym = xs.number(0);
        let (sin, cos) = x.sin_cos();
        let found = [x.sqrt(), x.rsqrt(), x.recip(), x.exp(), x.ln(), sin, cos, -x.sqrt(), (-x).abs()];
        for (row, y) in found.into_iter().enumerate() {
            ys.set_number(row, y);
        }
    });
    let Some(routine) = compiled(&program) else { return };
    let x: Vec<f32> = (0..LANES).map(|lane| 0.07 * (lane as f32 + 1.0).powi(2)).collect();
    let mut y = vec![0.0; 9 * LANES];
    routine.run(&mut [View::Numbers(&x), View::NumbersMut(&mut y)], &mut Memory::default());
    for (lane, &x) in x.iter().enumerate() {
        let x = f64::from(x);
        let wanted = [x.sqrt(), x.sqrt().recip(), x.recip(), x.exp(), x.ln(), x.sin(), x.cos(), -x.sqrt(), x];
        for (row, wanted) in wanted.into_iter().enumerate() {
            let found = f64::from(y[row * LANES + lane]);
            assert!((found - wanted).abs() <= 4e-7 * (1.0 + wanted.abs()), "{row} of {x}: {found} for {wanted}");
        }
    }
}

#[test]
fn eleven_buffers_are_found_and_no_more_are_taken() {
    let program = |count: u32| {
        trace(|| {
            let sum = (1..count).map(|binding| per_env(binding).number(0)).fold(Sym::zero(), |sum, x| sum + x);
            per_env(0).set_number(0, sum);
        })
    };
    let refused = Routine::compile(&program(12));
    let Some(routine) = compiled(&program(11)) else { return };
    assert!(matches!(refused, Err(NativeError::TooManyBuffers { count: 12, most: 11 })));
    let mut sum = [0.0; LANES];
    let others: Vec<[f32; LANES]> = (1..11).map(|k| [k as f32; LANES]).collect();
    let others = others.iter().map(|x| View::Numbers(x));
    let mut buffers: Vec<View<'_>> = [View::NumbersMut(&mut sum)].into_iter().chain(others).collect();
    routine.run(&mut buffers, &mut Memory::default());
    assert_eq!(sum, [55.0; LANES]);
}

/// A branch that only writes.
struct Nothing;

impl Carried<Sym> for Nothing {
    fn visit(&mut self, _: &mut impl Visitor<Sym>) {}
}

#[test]
fn rows_are_looked_up_as_they_were_before() {
    let (own, index) = (per_env(0), per_env(1));
    let program = trace(|| {
        own.set_number(0, Sym::lit(9.0));
        let found = Sym::gather(3, |row| [own.number(row)], index.number(0))[0];
        own.set_number(2, found);
    });
    let Some(routine) = compiled(&program) else { return };
    let mut rows: Vec<f32> = (0..3 * LANES).map(|k| k as f32).collect();
    let index: Vec<f32> = (0..LANES).map(|lane| (lane % 3) as f32).collect();
    routine.run(&mut [View::NumbersMut(&mut rows), View::Numbers(&index)], &mut Memory::default());
    for lane in 0..LANES {
        assert_eq!([rows[lane], rows[2 * LANES + lane]], [9.0, ((lane % 3) * LANES + lane) as f32]);
    }
}

#[test]
fn what_several_would_write_or_look_up_as_it_was_is_refused() {
    let shared = Buffer { binding: 1, sharing: Sharing::Shared };
    let writes = trace(|| shared.set_number(0, per_env(0).number(0)));
    let looks_up = trace(|| {
        // In a branch, after what the branch is told by was written.
        let (own, index) = (per_env(0), per_env(2).number(0));
        own.set_number(1, index);
        Sym::when(index.lt(Sym::lit(2.0)), &mut Nothing, |_| {
            own.set_number(3, Sym::gather(3, |row| [own.number(row)], index)[0]);
        });
    });
    if compiled(&trace(|| per_env(0).set_number(0, Sym::lit(1.0)))).is_none() {
        return;
    }
    assert!(matches!(Routine::compile(&writes), Err(NativeError::WritesShared { binding: 1 })));
    assert!(matches!(Routine::compile(&looks_up), Err(NativeError::GathersWhatItWrites { binding: 0 })));
}

/// Runs `2 x` on the rows of two buffers.
fn double(x: &[f32], y: View<'_>) {
    let program = trace(|| per_env(1).set_number(1, per_env(0).number(1) * Sym::lit(2.0)));
    if let Some(routine) = compiled(&program) {
        routine.run(&mut [View::Numbers(x), y], &mut Memory::default());
    } else {
        panic!("buffer 0 has few entries, buffer 1 is written: what machine code would say");
    }
}

#[test]
#[should_panic(expected = "buffer 0 has")]
fn a_buffer_that_is_too_short_is_not_read() {
    double(&[0.0; LANES], View::NumbersMut(&mut [0.0; 2 * LANES]));
}

#[test]
#[should_panic(expected = "buffer 1 is written")]
fn a_buffer_that_may_not_be_written_is_not() {
    double(&[0.0; 2 * LANES], View::Numbers(&[0.0; 2 * LANES]));
}
