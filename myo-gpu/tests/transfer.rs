//! Numbers arrive where they were sent, and nowhere else.

mod common;

use common::gpu;
use myo_gpu::{Gpu, GpuError};

#[test]
fn new_buffers_are_zero() {
    let Some(gpu) = gpu() else { return };
    for _ in 0..3 {
        let x = gpu.buffer::<u32>("x", 1000).unwrap();
        let mut got = [7; 1000];
        gpu.read(&x, 0, &mut got).unwrap();
        assert_eq!(got, [0; 1000]);
        gpu.write(&x, 0, &[u32::MAX; 1000]).unwrap();
    }
}

#[test]
fn parts_are_written_and_read() {
    let Some(gpu) = gpu() else { return };
    let x = gpu.buffer::<[f32; 3]>("x", 5).unwrap();
    gpu.write(&x, 2, &[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]).unwrap();
    gpu.write(&x, 5, &[]).unwrap();
    let mut got = [[9.0; 3]; 3];
    gpu.read(&x, 1, &mut got).unwrap();
    assert_eq!(got, [[0.0; 3], [1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
    gpu.read(&x, 5, &mut []).unwrap();
}

#[test]
fn several_buffers_of_several_types_are_read_at_once() {
    let Some(gpu) = gpu() else { return };
    let (a, b) = (gpu.buffer::<f32>("a", 10).unwrap(), gpu.buffer::<u32>("b", 100_000).unwrap());
    gpu.write(&a, 0, &[0.5; 10]).unwrap();
    gpu.write(&b, 99_998, &[8, 9]).unwrap();
    let (mut from_a, mut from_b, mut nothing) = ([0.0; 3], [0; 3], [0.0; 0]);
    gpu.read_many(&mut [
        a.part(7, &mut from_a).unwrap(),
        a.part(0, &mut nothing).unwrap(),
        b.part(99_997, &mut from_b).unwrap(),
    ])
    .unwrap();
    assert_eq!((from_a, from_b), ([0.5; 3], [0, 8, 9]));
}

#[test]
fn elements_that_are_not_there_are_refused() {
    let Some(gpu) = gpu() else { return };
    let (x, y) = (gpu.buffer::<f32>("state", 10).unwrap(), gpu.buffer::<f32>("y", 20).unwrap());
    let wrong = |start, end| GpuError::OutOfRange { buffer: "state".into(), start, end, len: 10 };
    assert_eq!(gpu.write(&x, 8, &[0.0; 3]), Err(wrong(8, 11)));
    assert_eq!(gpu.read(&x, usize::MAX, &mut [0.0; 3]), Err(wrong(usize::MAX, usize::MAX)));
    assert_eq!(x.part(10, &mut [0.0]).unwrap_err(), wrong(10, 11));
    let mut batch = gpu.batch();
    batch.copy(&y, 0, &x, 0, 10).copy(&y, 5, &x, 5, 6).copy(&y, 0, &x, 0, 20);
    assert_eq!(batch.submit(), Err(wrong(5, 11)));
    assert_eq!(wrong(8, 11).to_string(), "elements 8..11 of buffer state were asked for; it has 10");
}

#[test]
fn buffers_no_kernel_could_use_are_refused() {
    let Some(gpu) = gpu() else { return };
    let max = gpu.adapter().max_binding_bytes.min(gpu.adapter().max_buffer_bytes);
    let too_large = |len: usize| gpu.buffer::<f32>("state", len).unwrap_err();
    let message = too_large(max as usize / 4 + 1).to_string();
    assert!(message.contains("buffer state") && message.contains(&max.to_string()), "{message}");
    assert!(matches!(too_large(usize::MAX), GpuError::TooLarge { .. }));
    assert_eq!(too_large(0), GpuError::EmptyBuffer { buffer: "state".into() });
}

#[test]
fn handles_can_go_from_thread_to_thread() {
    fn check<T: Send + Sync>() {}
    check::<Gpu>();
    check::<myo_gpu::Buffer<f32>>();
    check::<myo_gpu::Kernel>();
    check::<myo_gpu::Bindings>();
    check::<myo_gpu::Batch>();
}
