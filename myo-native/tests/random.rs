//! Programs of chance run as machine code as they do interpreted.
//!
//! All numbers are whole and small, so single precision computes them exactly, and a difference is a fault.

use myo_native::{BLOCKS, LANES, Memory, NativeError, Routine, View};
use myo_scalar::symbolic::{Buffer, Contents, Form, Program, Sharing, Sym, SymMask, SymWord, trace_as};
use myo_scalar::{Carried, Scalar, Visitor, Word};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestCaseResult, TestRunner};

const NUMBERS: Buffer = Buffer { binding: 0, sharing: Sharing::PerEnv };
const WORDS: Buffer = Buffer { binding: 1, sharing: Sharing::PerEnv };
const SHARED: Buffer = Buffer { binding: 2, sharing: Sharing::Shared };
const NUMBER_ROWS: usize = 12;
const WORD_ROWS: usize = 3;
const SHARED_ROWS: usize = 7;

/// Choices that were drawn, one after the other, and round again.
struct Choices<'a> {
    drawn: &'a [u32],
    next: usize,
}

impl Choices<'_> {
    fn below(&mut self, count: usize) -> usize {
        let drawn = self.drawn[self.next % self.drawn.len()] as usize + self.next / self.drawn.len();
        self.next += 1;
        drawn % count
    }
}

/// Everything that a program computes with.
#[derive(Clone)]
struct Pool {
    numbers: Vec<Sym>,
    masks: Vec<SymMask>,
    words: Vec<SymWord>,
}

impl Carried<Sym> for Pool {
    fn visit(&mut self, visitor: &mut impl Visitor<Sym>) {
        visitor.numbers(&mut self.numbers);
        self.masks.iter_mut().for_each(|mask| visitor.mask(mask));
        self.words.iter_mut().for_each(|word| visitor.word(word));
    }
}

/// A branch that only writes.
struct Nothing;

impl Carried<Sym> for Nothing {
    fn visit(&mut self, _: &mut impl Visitor<Sym>) {}
}

/// Whole and small.
fn bounded(x: Sym) -> Sym {
    x.floor().clamp(-90.0, 90.0)
}

impl Pool {
    fn read() -> Self {
        let numbers: Vec<Sym> = (0..NUMBER_ROWS).map(|row| NUMBERS.number(row)).collect();
        let masks = vec![numbers[0].lt(numbers[1]), numbers[2].lt(Sym::lit(3.0))];
        Self { numbers, masks, words: (0..WORD_ROWS).map(|row| WORDS.word(row)).collect() }
    }

    fn write(&self) {
        for (row, &x) in self.numbers.iter().enumerate() {
            NUMBERS.set_number(row, x + Sym::indicator(self.masks[row % self.masks.len()]));
        }
        for (row, &x) in self.words.iter().enumerate() {
            WORDS.set_word(row, x);
        }
    }

    /// What there was where the mask is false.
    fn keep_unless(&mut self, mask: SymMask, before: &Self) {
        for (x, &old) in self.numbers.iter_mut().zip(&before.numbers) {
            *x = Sym::select(mask, *x, old);
        }
        for (x, &old) in self.masks.iter_mut().zip(&before.masks) {
            *x = (*x & mask) | (old & !mask);
        }
        for (x, &old) in self.words.iter_mut().zip(&before.words) {
            *x = Sym::select_word(mask, *x, old);
        }
    }

    fn number(&self, choices: &mut Choices<'_>) -> Sym {
        match choices.below(NUMBER_ROWS + 3) {
            row if row < NUMBER_ROWS => self.numbers[row],
            k if k == NUMBER_ROWS => Sym::lit(choices.below(9) as f64 - 4.0),
            k if k == NUMBER_ROWS + 1 => Sym::zero(),
            _ => SHARED.number(choices.below(SHARED_ROWS)),
        }
    }

    fn operate(&mut self, choices: &mut Choices<'_>) {
        let [a, b, c] = std::array::from_fn(|_| self.number(choices));
        let mask = self.masks[choices.below(2)];
        let word = self.words[choices.below(WORD_ROWS)];
        let to = choices.below(NUMBER_ROWS);
        let x = match choices.below(16) {
            0 => a + b,
            1 => a - b,
            2 => a * b,
            3 => a.mul_add(b, c),
            4 => a.mul_add(-b, c),
            5 => a.mul_add(b, -c),
            6 => (-a).mul_add(b, -c),
            7 => a.min(b),
            8 => a.max(b),
            9 => Sym::select(mask, a, b),
            10 => a.only(mask),
            11 => a.abs() - (-b),
            12 => a.clamp(0.0, 1.0) + (b * Sym::lit(0.5)).floor(),
            13 => Sym::from_word(word & SymWord::splat(31)),
            14 => Sym::gather(SHARED_ROWS, |row| [SHARED.number(row)], a)[0],
            // Of no negative number: what comes of none is not the same everywhere, and nothing asks for it.
            _ => (a * b).abs().sqrt().min(c),
        };
        self.numbers[to] = bounded(x);
        self.operate_on_the_rest(choices, [a, b]);
    }

    fn operate_on_the_rest(&mut self, choices: &mut Choices<'_>, [a, b]: [Sym; 2]) {
        let (to, other) = (choices.below(2), choices.below(2));
        self.masks[to] = match choices.below(5) {
            0 => a.lt(b),
            1 => self.masks[to] & self.masks[other],
            2 => self.masks[to] | self.masks[other],
            3 => !self.masks[other],
            _ => self.masks[to],
        };
        let (to, other) = (choices.below(WORD_ROWS), choices.below(WORD_ROWS));
        let (x, y) = (self.words[to], self.words[other]);
        self.words[to] = match choices.below(8) {
            0 => x + y,
            1 => x ^ y,
            2 => x & y,
            3 => x | (y << 3),
            4 => x >> 5,
            5 => x.mul_wide(0xD251_1F53).0 ^ y,
            6 => y.mul_wide(0xCD9E_8D57).1,
            _ => Sym::select_word(self.masks[0], x, y),
        };
    }

    fn grow(&mut self, choices: &mut Choices<'_>, depth: usize) {
        for _ in 0..2 + choices.below(5) {
            self.operate(choices);
            if depth > 0 {
                self.nest(choices, depth - 1);
            }
        }
    }

    fn nest(&mut self, choices: &mut Choices<'_>, depth: usize) {
        match choices.below(6) {
            0 => Sym::repeat(1 + choices.below(3), self, |pool| pool.grow(choices, depth)),
            1 => {
                // Lanes that want no further run see it and stay as they are: the first mask tells which.
                let limit = 1 + choices.below(4);
                Sym::repeat_while(limit, self, |pool| {
                    let (before, goes_on) = (pool.clone(), pool.masks[0]);
                    pool.grow(choices, depth);
                    pool.keep_unless(goes_on, &before);
                    pool.masks[0] = pool.masks[0] & goes_on;
                    pool.masks[0]
                });
            }
            2 => {
                let mask = self.masks[1];
                Sym::when(mask, self, |pool| {
                    let before = pool.clone();
                    pool.grow(choices, depth);
                    pool.keep_unless(mask, &before);
                });
            }
            3 => {
                let added = self.numbers[choices.below(NUMBER_ROWS)];
                Sym::map_chunks(&mut self.numbers, |index, [a, b, c]| {
                    [bounded(a + Sym::from_word(index)), bounded(b * c), added]
                });
            }
            4 => {
                let inputs = self.numbers.clone();
                let constants = |k: usize| [k as f64 - 5.0, (k * k) as f64 - 30.0];
                Sym::for_rows(constants, [&inputs], &mut self.numbers, |[c, d], [x], old| bounded(x * c + d - old));
            }
            _ => {}
        }
    }
}

fn record(drawn: &[u32]) -> Program {
    let form = if drawn[0].is_multiple_of(2) { Form::Loops } else { Form::Straight };
    trace_as(form, || {
        let mut choices = Choices { drawn, next: 0 };
        let mut pool = Pool::read();
        pool.grow(&mut choices, 3);
        let mask = pool.masks[1];
        Sym::when(mask, &mut Nothing, |_| {
            NUMBERS.set_number(NUMBER_ROWS, pool.numbers[3]);
            let inner = pool.masks[0];
            Sym::when(inner, &mut Nothing, |_| NUMBERS.set_number(NUMBER_ROWS + 1, pool.numbers[4]));
        });
        pool.write();
    })
}

/// What a program reads and writes for a block of environments.
struct Block {
    numbers: Vec<f32>,
    words: Vec<u32>,
    shared: Vec<f32>,
}

impl Block {
    fn draw(draws: &mut Choices<'_>) -> Self {
        let numbers = (0..(NUMBER_ROWS + 2) * LANES).map(|_| draws.below(19) as f32 - 9.0).collect();
        let word = |k: usize| (draws.below(1 << 20) as u32).wrapping_mul(k as u32 + 77_777);
        let words = (0..WORD_ROWS * LANES).map(word).collect();
        Self { numbers, words, shared: (0..SHARED_ROWS).map(|_| draws.below(9) as f32 - 4.0).collect() }
    }

    fn views(&mut self) -> [View<'_>; 3] {
        [View::NumbersMut(&mut self.numbers), View::WordsMut(&mut self.words), View::Numbers(&self.shared)]
    }

    /// The same of one lane.
    fn lane(&self, lane: usize) -> [Contents; 3] {
        [
            Contents::Numbers(self.numbers.iter().skip(lane).step_by(LANES).map(|&x| x.into()).collect()),
            Contents::Words(self.words.iter().skip(lane).step_by(LANES).copied().collect()),
            Contents::Numbers(self.shared.iter().map(|&x| x.into()).collect()),
        ]
    }
}

/// Runs blocks as `run` does and compares them with the interpreter, lane by lane.
fn compare_run(program: &Program, blocks: &mut [Block], run: impl FnOnce(&mut [Block])) -> TestCaseResult {
    let interpreted = |block: &Block, lane: usize| {
        let mut contents = block.lane(lane);
        program.interpret(&mut contents);
        contents
    };
    let wanted: Vec<Vec<_>> =
        blocks.iter().map(|block| (0..LANES).map(|lane| interpreted(block, lane)).collect()).collect();
    run(blocks);
    for (number, (block, wanted)) in blocks.iter().zip(&wanted).enumerate() {
        for (lane, wanted) in wanted.iter().enumerate() {
            prop_assert_eq!(&block.lane(lane), wanted, "lane {} of block {}", lane, number);
        }
    }
    Ok(())
}

fn compare(drawn: &[u32]) -> TestCaseResult {
    let program = record(drawn);
    let mut draws = Choices { drawn, next: 7 };
    let mut memory = Memory::default();
    let whole = Routine::compile(&program).expect("the program is compiled");
    compare_run(&program, &mut [Block::draw(&mut draws)], |blocks| whole.run(&mut blocks[0].views(), &mut memory))?;
    // Cut wherever it can be, for more blocks than run at once.
    let most = 1 + draws.below(30);
    let cut = Routine::compile_in_pieces(&program, most).expect("the program is compiled");
    let mut blocks: Vec<Block> = (0..BLOCKS + 1).map(|_| Block::draw(&mut draws)).collect();
    compare_run(&program, &mut blocks, |blocks| {
        let mut views: Vec<_> = blocks.iter_mut().map(Block::views).collect();
        cut.run_blocks(&mut views, &mut memory);
    })
}

#[test]
fn programs_run_as_they_are_interpreted() {
    if let Err(NativeError::Unsupported) = Routine::compile(&record(&[0])) {
        println!("skipped: no AVX-512 here");
        return;
    }
    let config = Config { cases: 150, failure_persistence: None, ..Config::default() };
    let choices = prop::collection::vec(any::<u32>().prop_map(|x| x >> 8), 60..600);
    TestRunner::new(config).run(&choices, |drawn| compare(&drawn)).expect("both agree");
}
