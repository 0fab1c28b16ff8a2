//! What things cost on a device: `cargo run --release -p myo-gpu --example costs [NAME]`, medians.
//!
//! Run it twice: the second time, compiled kernels come from the cache on disk, ours or the driver's.

use std::fmt::Write;
use std::time::Instant;

use myo_gpu::{Access, AdapterChoice, Gpu, GpuError, Kernel, Source, adapters};

fn main() -> Result<(), GpuError> {
    let start = Instant::now();
    for adapter in adapters() {
        println!("{adapter:?}");
    }
    println!("listing {:.1} ms", ms(start));
    let choice = std::env::args().nth(1).map_or(AdapterChoice::Any, AdapterChoice::Named);
    let start = Instant::now();
    let gpu = Gpu::open(&choice)?;
    println!("{}: opening {:.1} ms", gpu.adapter().name, ms(start));
    compiling(&gpu)?;
    submitting(&gpu)?;
    moving(&gpu)
}

fn ms(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

/// The median of some calls, in microseconds.
fn median_us(calls: usize, mut call: impl FnMut() -> Result<(), GpuError>) -> Result<f64, GpuError> {
    call()?;
    let mut times = Vec::new();
    for _ in 0..calls {
        let start = Instant::now();
        call()?;
        times.push(ms(start) * 1e3);
    }
    times.sort_by(f64::total_cmp);
    Ok(times[calls / 2])
}

/// A kernel of so many statements, each depending on those before it.
fn shader(statements: usize) -> String {
    let mut body = String::from("var a = x[i]; var b = a + 0.5; var c = b * 0.3;\n");
    for k in 0..statements {
        let (to, from, add) = [("a", "b", "c"), ("b", "c", "a"), ("c", "a", "b")][k % 3];
        let _ = writeln!(body, "{to} = {from} * {} + {add};", 0.5 + (k % 97) as f32 * 1e-4);
    }
    format!(
        "@group(0) @binding(0) var<storage, read_write> x: array<f32>;
        @compute @workgroup_size(64)
        fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                @builtin(local_invocation_index) local: u32) {{
            let i = (group.y * groups.x + group.x) * 64u + local;
            if i >= arrayLength(&x) {{ return; }}
            {body} x[i] = a + b + c;
        }}"
    )
}

fn kernel(gpu: &Gpu, statements: usize) -> Result<Kernel, GpuError> {
    let text = shader(statements);
    // SAFETY: straight-line code that returns beyond the end of its only buffer.
    unsafe { gpu.compile_trusted("costs", Source::Wgsl(&text), "main", &[Access::ReadWrite]) }
}

fn compiling(gpu: &Gpu) -> Result<(), GpuError> {
    for statements in [100, 1000, 3000] {
        let start = Instant::now();
        let kernel = kernel(gpu, statements)?;
        let compiled = ms(start);
        let x = gpu.buffer::<f32>("x", 65536)?;
        let bindings = kernel.bind(&[x.binding()])?;
        let start = Instant::now();
        let mut batch = gpu.batch();
        batch.dispatch(&kernel, &bindings, 65536);
        batch.submit_and_read(&mut [])?;
        println!(
            "{statements} statements: compiling {compiled:.1} ms, first run {:.2} ms, cache {:?}",
            ms(start),
            kernel.cached()
        );
    }
    Ok(())
}

fn submitting(gpu: &Gpu) -> Result<(), GpuError> {
    let kernel = kernel(gpu, 1)?;
    let x = gpu.buffer::<f32>("x", 4096)?;
    let bindings = kernel.bind(&[x.binding()])?;
    for dispatches in [0, 1, 100] {
        let us = median_us(100, || {
            let mut batch = gpu.batch();
            for _ in 0..dispatches {
                batch.dispatch(&kernel, &bindings, 4096);
            }
            batch.submit_and_read(&mut [])
        })?;
        println!("submit and wait, {dispatches} dispatches of 4,096 threads: {us:.0} us");
    }
    Ok(())
}

fn moving(gpu: &Gpu) -> Result<(), GpuError> {
    for kib in [16, 400, 4096, 65536] {
        let len = kib * 256;
        let (x, mut host) = (gpu.buffer::<f32>("x", len)?, vec![0.0; len]);
        let read = median_us(30, || gpu.read(&x, 0, &mut host))?;
        let write = median_us(30, || gpu.write(&x, 0, &host).and_then(|()| gpu.wait()))?;
        println!("{kib} KiB: read {read:.0} us, write and wait {write:.0} us");
    }
    Ok(())
}
