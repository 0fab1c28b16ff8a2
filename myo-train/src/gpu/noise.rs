//! The kernel that draws the noise of a roll-out, with the random numbers of all other code.

use myo_scalar::symbolic::{Buffer, Sharing, Sym, trace};
use myo_scalar::{open_unit, philox_block};

/// The kernel.
pub fn text() -> String {
    [include_str!("noise.wgsl"), &open_units()].concat()
}

/// The function that it calls: four numbers in (0, 1) for a key and a counter.
fn open_units() -> String {
    let [key, counter, units] = [0, 1, 2].map(|binding| Buffer { binding, sharing: Sharing::Shared });
    let program = trace(|| {
        let words = philox_block::<Sym>([0, 1].map(|k| key.word(k)), [0, 1, 2, 3].map(|k| counter.word(k)));
        words.into_iter().enumerate().for_each(|(k, word)| units.set_number(k, open_unit(word)));
    });
    program.to_wgsl_function("open_units", &["key", "counter", "units"]).expect("what is recorded is valid")
}

#[cfg(test)]
mod tests {
    use myo_gpu::{Access, Source};
    use myo_scalar::{Scalar, Word};

    use super::*;
    use crate::gpu::testing::gpu;

    const BLOCKS: usize = 300;

    const MAIN: &str = "
        @group(0) @binding(0) var<storage, read> words: array<u32>;
        @group(0) @binding(1) var<storage, read_write> out: array<f32>;
        @compute @workgroup_size(1)
        fn main(@builtin(workgroup_id) block: vec3<u32>) {
            var key = array<u32, 2>(words[0], words[1]);
            var counter = array<u32, 4>(block.x, words[2], words[3], words[4]);
            var units: array<f32, 4>;
            open_units(&key, &counter, &units);
            for (var k = 0u; k < 4u; k += 1u) { out[4u * block.x + k] = units[k]; }
        }\n";

    #[test]
    fn random_numbers_of_the_card_are_those_of_the_processor_bit_for_bit() {
        let Some(gpu) = gpu() else { return };
        let words = [7, 0x8000_0001, 0xffff_fff0, 3, 2];
        let text = [MAIN, &open_units()].concat();
        let kernel =
            gpu.compile("units", Source::Wgsl(&text), "main", &[Access::Read, Access::ReadWrite]).expect("it is valid");
        let (given, out) = (gpu.buffer("words", words.len()).unwrap(), gpu.buffer("out", 4 * BLOCKS).unwrap());
        gpu.write(&given, 0, &words).unwrap();
        let bindings = kernel.bind(&[given.binding(), out.binding()]).unwrap();
        let mut batch = gpu.batch();
        batch.dispatch(&kernel, &bindings, BLOCKS as u32);
        batch.submit().unwrap();
        let mut got = vec![0.0_f32; 4 * BLOCKS];
        gpu.read(&out, 0, &mut got).unwrap();

        let word = <f32 as Scalar>::Word::splat;
        let [low, high, rest @ ..] = words.map(word);
        let block = |number| philox_block::<f32>([low, high], [word(number), rest[0], rest[1], rest[2]]);
        let expected: Vec<f32> = (0..BLOCKS as u32).flat_map(|number| block(number).map(open_unit)).collect();
        assert_eq!(got, expected);
    }
}
