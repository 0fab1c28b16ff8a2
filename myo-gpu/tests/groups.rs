//! The same kernels on several parts of every buffer.

mod common;

use common::{gpu, kernel};
use myo_gpu::{Access, Gpu, GpuError, MAX_GROUPS, Source, kernel_in_groups};

const N: usize = 100;

/// Numbers that differ from group to group.
fn numbers(group: usize) -> Vec<f32> {
    (0..N).map(|i| (1000 * group + i) as f32).collect()
}

/// What `y = 2 x + y` leaves in every group's part of `y`, run for these groups.
fn run(gpu: &Gpu, count: usize, run_for: &[usize]) -> Vec<Vec<f32>> {
    let gpu = gpu.in_groups(count).unwrap();
    let kernel = kernel(&gpu, "if i < 100u { y[i] = 2.0 * x[i] + y[i]; }", &[Access::Read, Access::ReadWrite]);
    let [x, y] = ["x", "y"].map(|name| gpu.buffer::<f32>(name, N).unwrap());
    gpu.write(&y, 0, &[0.5; N]).unwrap();
    (0..count).for_each(|group| gpu.write(&x.of(group), 0, &numbers(group)).unwrap());
    let bindings = kernel.bind(&[x.binding(), y.binding()]).unwrap();
    let mut batch = gpu.for_groups(run_for).unwrap().batch();
    batch.dispatch(&kernel, &bindings, N as u32).dispatch(&kernel, &bindings, N as u32);
    batch.submit().unwrap();
    let read = |group| {
        let mut out = vec![0.0; N];
        gpu.read(&y.of(group), 0, &mut out).unwrap();
        out
    };
    (0..count).map(read).collect()
}

#[test]
fn every_group_has_its_own_part_and_runs_only_when_it_is_asked_to() {
    let Some(gpu) = gpu() else { return };
    for (count, run_for) in [(1, &[0][..]), (3, &[0, 1, 2]), (5, &[3, 1]), (4, &[]), (70, &[69, 0])] {
        for (group, got) in run(&gpu, count, run_for).into_iter().enumerate() {
            let times = if run_for.contains(&group) { 4.0 } else { 0.0 };
            let expected: Vec<f32> = numbers(group).iter().map(|x| times * x + 0.5).collect();
            assert_eq!(got, expected, "group {group} of {count}, run for {run_for:?}");
        }
    }
}

#[test]
fn copies_are_from_part_to_part() {
    let Some(gpu) = gpu() else { return };
    let gpu = gpu.in_groups(3).unwrap();
    let [x, y] = ["x", "y"].map(|name| gpu.buffer::<f32>(name, N).unwrap());
    (0..3).for_each(|group| gpu.write(&x.of(group), 0, &numbers(group)).unwrap());
    let mut batch = gpu.for_groups(&[0, 2]).unwrap().batch();
    batch.copy(&x, 10, &y, 20, 5);
    let mut got = [[0.0; 6]; 3];
    let parts = [0, 1, 2].map(|group| y.of(group));
    let mut reads: Vec<_> = parts.iter().zip(&mut got).map(|(part, out)| part.part(20, out).unwrap()).collect();
    batch.submit_and_read(&mut reads).unwrap();
    drop(reads);
    assert_eq!(got[0], [10.0, 11.0, 12.0, 13.0, 14.0, 0.0]);
    assert_eq!(got[1], [0.0; 6]);
    assert_eq!(got[2], [2010.0, 2011.0, 2012.0, 2013.0, 2014.0, 0.0]);
}

#[test]
fn groups_that_are_not_there_are_refused() {
    let Some(gpu) = gpu() else { return };
    for count in [0, MAX_GROUPS + 1] {
        let error = gpu.in_groups(count).unwrap_err();
        assert_eq!(error, GpuError::Groups { got: count, max: MAX_GROUPS });
    }
    let groups = gpu.in_groups(2).unwrap();
    assert!(matches!(groups.in_groups(2), Err(GpuError::Groups { .. })), "groups of groups");
    assert!(matches!(groups.for_groups(&[1, 2]), Err(GpuError::Groups { got: 3, max: 2 })));

    // A kernel for groups in a batch of none, where no group is active.
    let kernel = kernel(&groups, "if i < 4u { x[i] = 1.0; }", &[Access::ReadWrite]);
    let x = groups.buffer::<f32>("x", 4).unwrap();
    let mut batch = gpu.batch();
    batch.dispatch(&kernel, &kernel.bind(&[x.binding()]).unwrap(), 4);
    assert!(matches!(batch.submit(), Err(GpuError::Bind { .. })));
}

#[test]
fn kernels_that_cannot_be_rewritten_are_refused() {
    let refused = |declarations: &str, arguments: &str, body: &str, why: &str| {
        let text = format!("{declarations}\n@compute @workgroup_size(1) fn main({arguments}) {{ {body} }}");
        let error = kernel_in_groups(Source::Wgsl(&text), "main", 1).unwrap_err();
        assert!(error.contains(why), "{error}");
    };
    let (x, group) =
        ("@group(0) @binding(0) var<storage, read_write> x: array<f32>;", "@builtin(workgroup_id) g: vec3<u32>");
    refused(x, "", "x[0] = 1.0;", "workgroup_id");
    refused(x, group, "let y = x[0]; { let x = array<f32, 2>(y, y); }", "x is the name of a buffer and of a variable");
    refused("@group(0) @binding(0) var<storage, read_write> x: f32;", group, "x = 1.0;", "x is no array");
    let other = "x is used in another way than `x[index]`";
    for body in ["x [0] = 1.0;", "(x)[0] = 1.0;", "x/**/[0] = 1.0;", "let p = &x; (*p)[0] = 1.0;"] {
        refused(x, group, body, other);
    }
    refused(x, group, "if g.x < arrayLength(&x) { x[g.x] = 1.0; }", other);
}
