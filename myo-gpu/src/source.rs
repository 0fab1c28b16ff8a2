//! What kernels are made from.

use naga::ShaderStage;

/// The program of a kernel.
#[derive(Clone, Debug)]
pub enum Source<'a> {
    /// In naga's intermediate language: for generated code, which reaches the driver without being parsed.
    Naga(Box<naga::Module>),
    /// Text in WebGPU's shading language.
    Wgsl(&'a str),
}

impl From<naga::Module> for Source<'static> {
    fn from(module: naga::Module) -> Self {
        Self::Naga(Box::new(module))
    }
}

/// The program, parsed if it is text.
pub(crate) fn module(source: Source<'_>) -> Result<naga::Module, String> {
    match source {
        Source::Naga(module) => Ok(*module),
        Source::Wgsl(text) => naga::front::wgsl::parse_str(text).map_err(|e| e.emit_to_string(text)),
    }
}

/// Threads in one workgroup of an entry point.
pub(crate) fn workgroup_size(module: &naga::Module, entry: &str) -> Result<u32, String> {
    let compute = |point: &&naga::EntryPoint| point.stage == ShaderStage::Compute;
    let points = || module.entry_points.iter().filter(compute);
    let point = points().find(|point| point.name == entry).ok_or_else(|| {
        let names: Vec<_> = points().map(|point| point.name.as_str()).collect();
        format!("it has no compute entry point {entry}; there is {}", names.join(", "))
    })?;
    if point.workgroup_size_overrides.is_some() {
        return Err(format!("the workgroup size of {entry} must be a constant, not an override"));
    }
    Ok(point.workgroup_size.iter().product())
}
