//! A program as a compute kernel: naga's intermediate representation, which wgpu takes directly, and WGSL for people; or as a
//! function of WGSL, for kernels that are written by hand.
//!
//! One invocation runs one environment. Its number is
//! `(workgroup_id.y * num_workgroups.x + workgroup_id.x) * workgroup_size + local_invocation_index`; invocations past the
//! last environment do nothing. After the buffers follow the program's table of constants, if it has one, and the number of
//! environments, a `u32` uniform.

mod body;
mod shell;

use super::program::Program;
use naga::Module;
use naga::valid::{Capabilities, ValidationFlags, Validator};

/// Name of the kernel's entry point.
pub const ENTRY_POINT: &str = "main";

/// How buffers appear to a kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Use {
    /// Only read.
    Read,
    /// Written, and perhaps read.
    Write,
    /// The constants of [`KernelSource::table`].
    Table,
    /// The uniform with the number of environments.
    Environments,
}

/// A kernel.
#[derive(Clone, Debug)]
pub struct KernelSource {
    /// What a graphics interface compiles.
    pub module: Module,
    /// Use of each binding in order.
    pub bindings: Vec<Use>,
    /// Constants that the kernel looks up, for the binding [`Use::Table`] if there are any.
    pub table: Vec<f32>,
}

impl Program {
    /// Prints the program as a kernel. `names` are those of the buffers, by binding.
    pub fn to_kernel(&self, names: &[&str], workgroup_size: u32) -> KernelSource {
        shell::print(self, names, workgroup_size)
    }

    /// Prints the program as a function of WGSL. Its arguments, with these names, point to arrays: the buffers, by binding, with
    /// as many entries as the program touches.
    ///
    /// # Errors
    /// If the function is invalid, which would be a defect of this crate.
    ///
    /// # Panics
    /// If a buffer is per environment or not used, or the program looks up constants.
    pub fn to_wgsl_function(&self, name: &str, arguments: &[&str]) -> Result<String, String> {
        wgsl(&shell::print_function(self, name, arguments))
    }
}

impl KernelSource {
    /// The kernel as WGSL.
    ///
    /// # Errors
    /// If the kernel is invalid, which would be a defect of this crate.
    pub fn to_wgsl(&self) -> Result<String, String> {
        wgsl(&self.module)
    }
}

fn wgsl(module: &Module) -> Result<String, String> {
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::all());
    let info = validator.validate(module).map_err(|error| format!("{:?}", error.into_inner()))?;
    let flags = naga::back::wgsl::WriterFlags::empty();
    naga::back::wgsl::write_string(module, &info, flags).map_err(|error| error.to_string())
}
