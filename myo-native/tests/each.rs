//! Every operation on integers alone.
use myo_native::{LANES, Memory, Routine, View};
use myo_scalar::Word;
use myo_scalar::symbolic::{Buffer, Contents, Sharing, SymWord, trace};

#[test]
fn words() {
    let buffer = Buffer { binding: 0, sharing: Sharing::PerEnv };
    let program = trace(|| {
        let (x, y): (SymWord, SymWord) = (buffer.word(0), buffer.word(1));
        let out = [x + y, x ^ y, x & y, x | (y << 3), x >> 5, x.mul_wide(0xD251_1F53).0, y.mul_wide(0xCD9E_8D57).1];
        for (k, x) in out.into_iter().enumerate() {
            buffer.set_word(2 + k, x);
        }
    });
    let mut words: Vec<u32> = (0..9 * LANES as u32).map(|k| k.wrapping_mul(2_654_435_761).rotate_left(k)).collect();
    let before = words.clone();
    Routine::compile(&program).unwrap().run(&mut [View::WordsMut(&mut words)], &mut Memory::default());
    for lane in 0..LANES {
        let mut contents = [Contents::Words(before.iter().skip(lane).step_by(LANES).copied().collect())];
        program.interpret(&mut contents);
        let found: Vec<u32> = words.iter().skip(lane).step_by(LANES).copied().collect();
        assert_eq!(contents[0], Contents::Words(found));
    }
}
