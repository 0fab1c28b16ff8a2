//! Kernels do what they say, on whatever adapter this machine has.

mod common;

use common::{gpu, kernel, shader};
use myo_gpu::{Access, Gpu, GpuError, Kernel, Source};

const UPDATE: &[Access] = &[Access::ReadWrite];

fn read(gpu: &Gpu, buffer: &myo_gpu::Buffer<f32>) -> Vec<f32> {
    let mut out = vec![f32::NAN; buffer.len()];
    gpu.read(buffer, 0, &mut out).unwrap();
    out
}

/// Runs a kernel of one buffer, which starts as zeros.
fn run(gpu: &Gpu, kernel: &Kernel, len: usize, threads: u32) -> Vec<f32> {
    let x = gpu.buffer::<f32>("x", len).unwrap();
    let bindings = kernel.bind(&[x.binding()]).unwrap();
    let mut batch = gpu.batch();
    batch.dispatch(kernel, &bindings, threads);
    batch.submit().unwrap();
    read(gpu, &x)
}

#[test]
fn a_kernel_reads_one_buffer_and_writes_another() {
    let Some(gpu) = gpu() else { return };
    let add = kernel(&gpu, "if i < arrayLength(&y) { y[i] = x[i] + 0.5; }", &[Access::Read, Access::ReadWrite]);
    let (x, y) = (gpu.buffer::<f32>("x", 1000).unwrap(), gpu.buffer::<f32>("y", 1000).unwrap());
    let values: Vec<_> = (0..1000).map(|i| i as f32).collect();
    gpu.write(&x, 0, &values).unwrap();
    let bindings = add.bind(&[x.binding(), y.binding()]).unwrap();
    let mut batch = gpu.batch();
    batch.dispatch(&add, &bindings, 1000);
    batch.submit().unwrap();
    assert!(read(&gpu, &y).iter().zip(&values).all(|(y, x)| *y == x + 0.5));
}

#[test]
fn every_thread_runs_once_beyond_65535_workgroups() {
    let Some(gpu) = gpu() else { return };
    let count = kernel(&gpu, "if i < arrayLength(&x) { x[i] += f32(i % 1000u + 1u); }", UPDATE);
    let len = 70_000 * 64 + 5;
    let got = run(&gpu, &count, len, len as u32);
    assert!((0..len).all(|i| got[i] == (i % 1000 + 1) as f32));
}

#[test]
fn threads_beyond_the_last_workgroup_do_not_run() {
    let Some(gpu) = gpu() else { return };
    let mark = kernel(&gpu, "x[i] = 1.0;", UPDATE);
    assert_eq!(run(&gpu, &mark, 256, 65).iter().sum::<f32>(), 128.0);
    assert_eq!(run(&gpu, &mark, 256, 0).iter().sum::<f32>(), 0.0);
}

#[test]
fn a_batch_runs_in_order() {
    let Some(gpu) = gpu() else { return };
    let add = kernel(&gpu, "x[i] += 1.0;", UPDATE);
    let double = kernel(&gpu, "x[i] *= 2.0;", UPDATE);
    let (a, b) = (gpu.buffer::<f32>("a", 64).unwrap(), gpu.buffer::<f32>("b", 64).unwrap());
    // Bindings serve every kernel of the same accesses.
    let (add_a, double_b) = (add.bind(&[a.binding()]).unwrap(), add.bind(&[b.binding()]).unwrap());
    gpu.write(&a, 0, &[1.0; 64]).unwrap();
    let mut batch = gpu.batch();
    for _ in 0..3 {
        batch.dispatch(&add, &add_a, 64).copy(&a, 0, &b, 0, 64);
        batch.dispatch(&double, &double_b, 64).copy(&b, 0, &a, 0, 64);
    }
    let mut got = [0.0; 64];
    batch.submit_and_read(&mut [a.part(0, &mut got).unwrap()]).unwrap();
    assert_eq!(got, [22.0; 64]);
}

#[test]
fn a_uniform_is_the_same_for_all_threads() {
    let Some(gpu) = gpu() else { return };
    let text = shader("x[i] = f32(u.y);", UPDATE) + "@group(0) @binding(1) var<uniform> u: vec4<u32>;";
    let bindings = [Access::ReadWrite, Access::Uniform];
    let fill = gpu.compile("fill", Source::Wgsl(&text), "main", &bindings).unwrap();
    let (x, u) = (gpu.buffer::<f32>("x", 64).unwrap(), gpu.buffer::<[u32; 4]>("u", 1).unwrap());
    gpu.write(&u, 0, &[[3, 7, 0, 0]]).unwrap();
    let bound = fill.bind(&[x.binding(), u.binding()]).unwrap();
    let mut batch = gpu.batch();
    batch.dispatch(&fill, &bound, 64);
    batch.submit().unwrap();
    assert_eq!(read(&gpu, &x), [7.0; 64]);
}

#[test]
fn a_module_needs_no_text() {
    let Some(gpu) = gpu() else { return };
    let module = naga::front::wgsl::parse_str(&shader("x[i] = 3.0;", UPDATE)).unwrap();
    // SAFETY: the buffer has as many elements as there are threads.
    let kernel = unsafe { gpu.compile_trusted("module", module.into(), "main", UPDATE) }.unwrap();
    assert_eq!(kernel.workgroup_size(), 64);
    assert_eq!(run(&gpu, &kernel, 128, 128), [3.0; 128]);
}

#[test]
fn checked_kernels_cannot_leave_their_buffers() {
    let Some(gpu) = gpu() else { return };
    let wild =
        kernel(&gpu, "x[i] += x[i + 100000000u] * 0.0 + 1.0; x[i * 100000000u + 64u] = 7.0; x[i + 64u] = 7.0;", UPDATE);
    // Buffers made one after the other often lie side by side.
    let buffers = [(); 16].map(|()| gpu.buffer::<f32>("x", 64).unwrap());
    let mut batch = gpu.batch();
    batch.dispatch(&wild, &wild.bind(&[buffers[7].binding()]).unwrap(), 64);
    batch.submit().unwrap();
    for (k, buffer) in buffers.iter().enumerate() {
        let (got, want) = (read(&gpu, buffer), if k == 7 { 1.0 } else { 0.0 });
        // The last element of its own buffer is where a driver may let stray writes end.
        assert_eq!(got[..63], [want; 63], "buffer {k}");
        assert!(k == 7 || got[63] == 0.0, "buffer {k}: {}", got[63]);
    }
}

#[test]
fn threads_of_the_program_can_work_at_once() {
    let Some(gpu) = gpu() else { return };
    std::thread::scope(|scope| {
        for n in 1..5 {
            let gpu = gpu.clone();
            scope.spawn(move || {
                let add = kernel(&gpu, &format!("x[i] += {n}.0;"), UPDATE);
                for _ in 0..20 {
                    assert_eq!(run(&gpu, &add, 64, 64), [n as f32; 64]);
                }
            });
        }
    });
}

#[test]
fn dispatches_are_timed_one_by_one() {
    let Some(gpu) = gpu() else { return };
    let add = kernel(&gpu, "for (var k = 0; k < 100; k++) { x[i] += 1.0; }", UPDATE);
    let x = gpu.buffer::<f32>("x", 1 << 16).unwrap();
    let bindings = add.bind(&[x.binding()]).unwrap();
    // The first run of a kernel may compile it.
    let mut first = gpu.batch();
    first.dispatch(&add, &bindings, 64);
    first.submit().unwrap();
    let mut batch = match gpu.batch().timed() {
        Ok(batch) => batch,
        Err(error) => {
            assert!(!gpu.adapter().timestamps && matches!(error, GpuError::NoClock { .. }), "{error}");
            println!("skipped: {error}");
            return;
        }
    };
    batch.dispatch(&add, &bindings, 64).dispatch(&add, &bindings, 1 << 16);
    let times = batch.submit_and_time().unwrap();
    assert_eq!(times.iter().map(|time| time.kernel.as_str()).collect::<Vec<_>>(), ["test", "test"]);
    assert!(times.iter().all(|time| time.seconds > 0.0 && time.seconds < 10.0), "{times:?}");
    assert_eq!(read(&gpu, &x)[..65], [[300.0; 64].as_slice(), &[100.0]].concat());
}

#[test]
fn work_made_ready_runs_when_it_is_submitted() {
    let Some(gpu) = gpu() else { return };
    let add = kernel(&gpu, "x[i] = 2.0 * x[i] + 1.0;", UPDATE);
    let set = kernel(&gpu, "x[i] = 5.0;", UPDATE);
    let x = gpu.buffer::<f32>("x", 64).unwrap();
    let ready = |kernel: &Kernel| {
        let mut batch = gpu.batch();
        batch.dispatch(kernel, &kernel.bind(&[x.binding()]).unwrap(), 64);
        batch.finish().unwrap()
    };
    let (later, first) = (ready(&add), ready(&set));
    first.submit().unwrap().wait().unwrap();
    assert_eq!(read(&gpu, &x), [5.0; 64]);
    gpu.write(&x, 0, &[3.0; 64]).unwrap();
    let mut got = [0.0; 64];
    let told = later.submit_and_read(&mut [x.part(0, &mut got).unwrap()], || "meanwhile").unwrap();
    assert_eq!((told, got), ("meanwhile", [7.0; 64]));
}

const MATRICES: &str = "enable f16;
enable wgpu_cooperative_matrix;

@group(0) @binding(0) var<storage, read_write> x: array<f32>;
var<workgroup> a: array<f16, 256>;
var<workgroup> b: array<f16, 256>;

@compute @workgroup_size(32)
fn main(@builtin(local_invocation_index) local: u32) {
    for (var i = local; i < 256u; i += 32u) {
        a[i] = f16(i % 7u);
        b[i] = f16(i % 5u) - 2.0h;
    }
    workgroupBarrier();
    let rows = coopLoadT<coop_mat16x16<f16, A>>(&a[0], 16u);
    let columns = coopLoadT<coop_mat16x16<f16, B>>(&b[0], 16u);
    var product = coop_mat16x16<f32, C>();
    product = coopMultiplyAdd(rows, columns, product);
    coopStoreT(product, &x[0], 16u);
}";

#[test]
fn matrix_units_multiply_matrices() {
    let Some(gpu) = gpu() else { return };
    if !gpu.adapter().cooperative_matrix {
        println!("skipped: {} has no matrix units of 16 x 16", gpu.adapter().name);
        return;
    }
    let multiply = gpu.compile("matrices", Source::Wgsl(MATRICES), "main", UPDATE).unwrap();
    let got = run(&gpu, &multiply, 256, 32);
    let (a, b) = (|i: usize| (i % 7) as f32, |i: usize| (i % 5) as f32 - 2.0);
    let entry = |i: usize| (0..16).map(|k| a(i / 16 * 16 + k) * b(16 * k + i % 16)).sum::<f32>();
    assert_eq!(got, (0..256).map(entry).collect::<Vec<_>>());
}
