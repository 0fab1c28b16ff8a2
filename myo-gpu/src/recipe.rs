//! What a kernel is compiled from, as a value.

use std::borrow::Cow;

use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::kernel::{Access, Kernel};
use crate::source::Source;

/// What a kernel is compiled from: equal recipes make the same kernel, which [`Gpu::kernel`] therefore compiles once.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Recipe {
    label: Cow<'static, str>,
    text: Cow<'static, str>,
    bindings: Vec<Access>,
    trusted: bool,
}

impl Recipe {
    /// A kernel with a name for messages, in WebGPU's shading language with the entry point `main`; see [`Gpu::compile`].
    pub fn new(
        label: impl Into<Cow<'static, str>>,
        text: impl Into<Cow<'static, str>>,
        bindings: impl Into<Vec<Access>>,
    ) -> Self {
        Self { label: label.into(), text: text.into(), bindings: bindings.into(), trusted: false }
    }

    /// The same kernel without checks.
    ///
    /// # Safety
    /// As for [`Gpu::compile_trusted`], of every kernel that is made of this recipe.
    #[must_use]
    pub unsafe fn trusted(self) -> Self {
        Self { trusted: true, ..self }
    }

    /// Compiles it, whether there is such a kernel already or not.
    pub(crate) fn compile(&self, gpu: &Gpu) -> Result<Kernel, GpuError> {
        let Self { label, text, bindings, trusted } = self;
        let source = Source::Wgsl(text);
        match trusted {
            false => gpu.compile(label, source, "main", bindings),
            // SAFETY: whoever made the recipe vouches for the kernel.
            true => unsafe { gpu.compile_trusted(label, source, "main", bindings) },
        }
    }
}
