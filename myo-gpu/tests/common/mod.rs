//! What the tests share: a device, and kernels of two buffers.

#![allow(dead_code, reason = "every test file uses a part of this")]

use myo_gpu::{Access, AdapterChoice, Gpu, Kernel, Source};

/// The index of a thread, as `Batch::dispatch` lays workgroups out.
pub const INDEX: &str = "let i = (group.y * groups.x + group.x) * 64u + local;";

/// Any device. Without one the test fails, unless `MYO_NO_GPU` says that this is meant.
pub fn gpu() -> Option<Gpu> {
    match Gpu::open_with_cache(&AdapterChoice::Any, None) {
        Ok(gpu) => Some(gpu),
        Err(error) if std::env::var_os("MYO_NO_GPU").is_some_and(|value| value == "1") => {
            println!("skipped: MYO_NO_GPU=1, and {error}");
            None
        }
        Err(error) => panic!("{error}. To skip these tests, set MYO_NO_GPU=1."),
    }
}

/// Compiles a function body that finds its thread's index in `i` and `f32` buffers `x`, `y`, `z`, one per access.
pub fn kernel(gpu: &Gpu, body: &str, bindings: &[Access]) -> Kernel {
    gpu.compile("test", Source::Wgsl(&shader(body, bindings)), "main", bindings).unwrap()
}

pub fn shader(body: &str, bindings: &[Access]) -> String {
    let variables: String = bindings
        .iter()
        .zip(["x", "y", "z"])
        .enumerate()
        .map(|(i, (access, name))| {
            let access = if *access == Access::Read { "read" } else { "read_write" };
            format!("@group(0) @binding({i}) var<storage, {access}> {name}: array<f32>;\n")
        })
        .collect();
    format!(
        "{variables}
        @compute @workgroup_size(64)
        fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                @builtin(local_invocation_index) local: u32) {{ {INDEX} {body} }}"
    )
}
