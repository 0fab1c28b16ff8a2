//! Mistakes come back as errors that say what is wrong, and the device works on.

mod common;

use common::{gpu, kernel, shader};
use myo_gpu::{Access, Batch, Gpu, GpuError, Source};

const UPDATE: &[Access] = &[Access::ReadWrite];

/// The message of a refused shader, after which another one compiles.
fn refused(gpu: &Gpu, text: &str, entry: &str, bindings: &[Access]) -> String {
    let error = gpu.compile("bad", Source::Wgsl(text), entry, bindings).unwrap_err();
    kernel(gpu, "x[i] = 1.0;", UPDATE);
    assert!(matches!(error, GpuError::Kernel { .. }), "{error}");
    error.to_string()
}

#[test]
fn a_mistake_in_the_text_is_shown_with_its_place() {
    let Some(gpu) = gpu() else { return };
    let message = refused(&gpu, "@compute @workgroup_size(1)\nfn main() { y = 3; }", "main", &[]);
    assert!(message.contains("kernel bad") && message.contains("2:13") && message.contains("y"), "{message}");
}

#[test]
fn a_missing_entry_point_is_named_with_those_there_are() {
    let Some(gpu) = gpu() else { return };
    let text = "@compute @workgroup_size(1) fn one() {} @compute @workgroup_size(1) fn two() {}";
    let message = refused(&gpu, text, "three", &[]);
    assert!(message.contains("three") && message.ends_with("there is one, two"), "{message}");
}

#[test]
fn bindings_other_than_declared_are_refused() {
    let Some(gpu) = gpu() else { return };
    let text = shader("x[i] = 1.0;", UPDATE);
    for bindings in [&[][..], &[Access::Read], &[Access::Uniform]] {
        refused(&gpu, &text, "main", bindings);
    }
}

#[test]
fn a_module_that_is_not_valid_is_refused() {
    let Some(gpu) = gpu() else { return };
    let mut module = naga::front::wgsl::parse_str(&shader("x[i] = 1.0;", UPDATE)).unwrap();
    let float = naga::Expression::Literal(naga::Literal::F32(1.0));
    let function = &mut module.entry_points[0].function;
    let value = function.expressions.append(float, naga::Span::default());
    function.body.push(naga::Statement::Return { value: Some(value) }, naga::Span::default());
    let error = gpu.compile("bad", module.into(), "main", UPDATE).unwrap_err();
    assert!(error.to_string().starts_with("kernel bad was refused: "), "{error}");
}

#[test]
fn workgroups_larger_than_the_device_allows_are_refused() {
    let Some(gpu) = gpu() else { return };
    let text = shader("x[i] = 1.0;", UPDATE).replace("(64)", "(65536)");
    refused(&gpu, &text, "main", UPDATE);
}

#[test]
fn nine_storage_buffers_are_refused() {
    let Some(gpu) = gpu() else { return };
    let error = gpu.compile("big", Source::Wgsl(""), "main", &[Access::Read; 9]).unwrap_err();
    assert_eq!(error, GpuError::TooManyBuffers { kernel: "big".into(), got: 9, max: 8 });
}

#[test]
fn buffers_that_do_not_fit_the_kernel_are_refused() {
    let Some(gpu) = gpu() else { return };
    let one = kernel(&gpu, "x[i] = 1.0;", UPDATE);
    let x = gpu.buffer::<f32>("x", 64).unwrap();
    let message = one.bind(&[x.binding(), x.binding()]).unwrap_err().to_string();
    assert_eq!(message, "kernel test cannot be bound: it has 1 bindings, but 2 buffers were given");
    one.bind(&[x.binding()]).unwrap();
}

#[test]
fn a_batch_that_cannot_run_is_refused_as_a_whole() {
    let Some(gpu) = gpu() else { return };
    let both = kernel(&gpu, "y[i] = x[i] + 1.0;", &[Access::Read, Access::ReadWrite]);
    let one = kernel(&gpu, "x[i] = 1.0;", UPDATE);
    let x = gpu.buffer::<f32>("x", 64).unwrap();
    let (same, fine) = (both.bind(&[x.binding(), x.binding()]).unwrap(), one.bind(&[x.binding()]).unwrap());
    let mistakes: [&dyn Fn(&mut Batch); 3] =
        [&|batch| _ = batch.dispatch(&both, &same, 64), &|batch| _ = batch.dispatch(&both, &fine, 64), &|batch| {
            _ = batch.copy(&x, 0, &x, 32, 32)
        }];
    for mistake in mistakes {
        let mut batch = gpu.batch();
        batch.dispatch(&one, &fine, 64);
        mistake(&mut batch);
        let mut out = [0.0; 64];
        let error = batch.submit_and_read(&mut [x.part(0, &mut out).unwrap()]).unwrap_err();
        assert!(matches!(error, GpuError::Refused { .. }), "{error}");
    }
    let mut out = [9.0; 64];
    gpu.read(&x, 0, &mut out).unwrap();
    assert_eq!(out, [0.0; 64]);
}

#[test]
fn a_batch_can_be_dropped() {
    let Some(gpu) = gpu() else { return };
    let one = kernel(&gpu, "x[i] = 1.0;", UPDATE);
    let x = gpu.buffer::<f32>("x", 64).unwrap();
    let bindings = one.bind(&[x.binding()]).unwrap();
    gpu.batch().dispatch(&one, &bindings, 64);
    gpu.wait().unwrap();
    let mut out = [9.0; 64];
    gpu.read(&x, 0, &mut out).unwrap();
    assert_eq!(out, [0.0; 64], "what was not submitted has not run");
}
