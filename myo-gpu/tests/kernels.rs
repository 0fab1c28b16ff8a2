//! Kernels do what they say, on whatever adapter this machine has.

mod common;

use common::{gpu, kernel};
use myo_gpu::Access;

#[test]
fn a_kernel_reads_and_writes_its_buffers() {
    let Some(gpu) = gpu() else { return };
    let add = kernel(&gpu, "if i < arrayLength(&y) { y[i] = x[i] + 0.5; }", &[Access::Read, Access::ReadWrite]);
    let x = gpu.buffer::<f32>("x", 1000).unwrap();
    let y = gpu.buffer::<f32>("y", 1000).unwrap();
    let values: Vec<_> = (0..1000).map(|i| i as f32).collect();
    gpu.write(&x, 0, &values).unwrap();
    let bindings = add.bind(&[x.binding(), y.binding()]).unwrap();
    let mut batch = gpu.batch();
    batch.dispatch(&add, &bindings, 1000);
    batch.submit().unwrap();
    let mut got = vec![0.0; 1000];
    gpu.read(&y, 0, &mut got).unwrap();
    assert!(got.iter().zip(&values).all(|(got, x)| *got == x + 0.5));
}
