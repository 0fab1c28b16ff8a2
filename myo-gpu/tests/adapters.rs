//! Adapters are listed and chosen.

mod common;

use common::gpu;
use myo_gpu::{AdapterChoice, AdapterKind, Cached, Gpu, GpuError, adapters};

#[test]
fn the_best_adapter_comes_first_and_opens() {
    let Some(gpu) = gpu() else { return };
    let all = adapters();
    assert!(all.is_sorted_by_key(|adapter| adapter.kind));
    assert_eq!(gpu.adapter(), &all[0]);
    assert_eq!(&all[0], Gpu::open(&AdapterChoice::Named("0".into())).unwrap().adapter());
    assert_eq!(&all[0], Gpu::open(&AdapterChoice::Named(all[0].name.to_uppercase())).unwrap().adapter());
}

#[test]
fn adapters_are_written_as_json() {
    let Some(gpu) = gpu() else { return };
    let json = serde_json::to_value(gpu.adapter()).unwrap();
    let kind = format!("{:?}", gpu.adapter().kind).to_lowercase();
    assert_eq!((&json["name"], &json["kind"]), (&gpu.adapter().name.as_str().into(), &kind.into()));
    assert!(json["max_binding_bytes"].as_u64() >= Some(128 << 20));
    let memory = json["memory_bytes"].as_u64();
    assert!(memory >= Some(128 << 20) || gpu.adapter().backend != "vulkan", "{memory:?}");
}

#[test]
fn hardware_is_never_software() {
    let Some(_) = gpu() else { return };
    match Gpu::open(&AdapterChoice::Hardware) {
        Ok(gpu) => assert_ne!(gpu.adapter().kind, AdapterKind::Software),
        Err(error) => assert!(matches!(error, GpuError::OnlySoftware { .. }), "{error}"),
    }
}

#[test]
fn an_unknown_name_is_refused_with_those_there_are() {
    let Some(gpu) = gpu() else { return };
    let message = Gpu::open(&AdapterChoice::Named("voodoo".into())).unwrap_err().to_string();
    assert!(message.contains("voodoo") && message.contains(&format!("0: {}", gpu.adapter().name)), "{message}");
}

#[test]
fn kernels_are_kept_on_disk_where_that_is_possible() {
    let Some(any) = gpu() else { return };
    let folder = tempfile::tempdir().unwrap();
    let compile = |folder: &std::path::Path| {
        let gpu = Gpu::open_with_cache(&AdapterChoice::Any, Some(folder)).unwrap();
        common::kernel(&gpu, "x[i] = 1.0;", &[myo_gpu::Access::ReadWrite]).cached().clone()
    };
    if !any.adapter().pipeline_cache {
        assert_eq!(compile(folder.path()), Cached::Off);
        return;
    }
    assert_eq!(compile(folder.path()), Cached::Stored);
    assert_eq!(compile(folder.path()), Cached::Loaded);
    let file = std::fs::read_dir(folder.path().join("kernels")).unwrap().next().unwrap().unwrap().path();
    std::fs::write(&file, b"nonsense, and more than a checksum").unwrap();
    assert_eq!(compile(folder.path()), Cached::Stored);
    assert_eq!(compile(folder.path()), Cached::Loaded);
    match compile(&file) {
        Cached::Failed { reason } => assert!(reason.starts_with("cannot write "), "{reason}"),
        other => panic!("{other:?} in a folder that is a file"),
    }
}

#[test]
fn without_a_folder_nothing_is_kept() {
    let Some(_) = gpu() else { return };
    let gpu = Gpu::open_with_cache(&AdapterChoice::Any, None).unwrap();
    assert_eq!(common::kernel(&gpu, "", &[]).cached(), &Cached::Off);
}
