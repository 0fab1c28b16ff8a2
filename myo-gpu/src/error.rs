//! What can go wrong on a device.

use thiserror::Error;

/// Why a device cannot be opened or does not do what was asked.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum GpuError {
    /// No driver answers.
    #[error(
        "no GPU was found: no Vulkan, Metal or Direct3D 12 driver answers. Install the driver of the graphics card; to run on \
         the processor instead, install a software driver (Debian, Ubuntu: libvulkan1 mesa-vulkan-drivers; Fedora: vulkan-loader \
         mesa-vulkan-drivers)"
    )]
    NoAdapter,
    /// Only software drivers answer, and hardware was asked for.
    #[error(
        "no graphics card was found, only software that imitates one: {}. Install the driver of the card, or ask for any adapter \
         to run on the processor, slowly", found.join(", ")
    )]
    OnlySoftware {
        /// Names of what there is.
        found: Vec<String>,
    },
    /// No adapter has this number.
    #[error("there is no GPU {wanted}; there is {}", found.join(", "))]
    NoSuchNumber {
        /// What was asked for.
        wanted: String,
        /// Number and name of what there is.
        found: Vec<String>,
    },
    /// Several adapters have this in their names.
    #[error(
        "\"{wanted}\" is part of the name of several GPUs, {}; take a number or more of the name", found.join(", ")
    )]
    SeveralAdapters {
        /// What was asked for.
        wanted: String,
        /// Number and name of those.
        found: Vec<String>,
    },
    /// No adapter has this name.
    #[error("no GPU is called \"{wanted}\"; there is {}", found.join(", "))]
    NoSuchAdapter {
        /// What was asked for.
        wanted: String,
        /// Number and name of what there is.
        found: Vec<String>,
    },
    /// The driver lists the adapter but does not open it.
    #[error("{adapter} cannot be opened: {reason}")]
    Open {
        /// Its name.
        adapter: String,
        /// What the driver said.
        reason: String,
    },
    /// Groups that there are not, or not so many.
    #[error("{got} groups were asked for; there can be 1 to {max}")]
    Groups {
        /// Groups asked for.
        got: usize,
        /// The greatest number.
        max: usize,
    },
    /// A kernel that not every driver could bind.
    #[error("kernel {kernel} binds {got} storage buffers; at most {max} are portable, so join some of them")]
    TooManyBuffers {
        /// Its label.
        kernel: String,
        /// Storage buffers asked for.
        got: usize,
        /// The greatest number allowed.
        max: usize,
    },
    /// A kernel that the checks or the driver refused.
    #[error("kernel {kernel} was refused: {reason}")]
    Kernel {
        /// Its label.
        kernel: String,
        /// What was wrong, with the place in the source where there is one.
        reason: String,
    },
    /// Buffers that do not fit the kernel.
    #[error("kernel {kernel} cannot be bound: {reason}")]
    Bind {
        /// Its label.
        kernel: String,
        /// What was wrong.
        reason: String,
    },
    /// A buffer without elements.
    #[error("buffer {buffer} has no elements; drivers want at least one")]
    EmptyBuffer {
        /// Its label.
        buffer: String,
    },
    /// A buffer greater than the device allows.
    #[error("buffer {buffer} needs {bytes} bytes, but {adapter} allows {max} in one buffer that kernels use; split it")]
    TooLarge {
        /// Its label.
        buffer: String,
        /// Its size.
        bytes: u64,
        /// The greatest size allowed, in bytes.
        max: u64,
        /// Name of the adapter.
        adapter: String,
    },
    /// The device has not enough memory left.
    #[error("the GPU is out of memory ({what})")]
    OutOfMemory {
        /// For what it was wanted.
        what: String,
    },
    /// Elements that a buffer does not have.
    #[error("elements {start}..{end} of buffer {buffer} were asked for; it has {len}")]
    OutOfRange {
        /// Its label.
        buffer: String,
        /// First element wanted.
        start: usize,
        /// One past the last element wanted.
        end: usize,
        /// Elements that there are.
        len: usize,
    },
    /// A device without a clock that kernels can be timed by.
    #[error("{adapter} cannot time kernels: its driver has no timestamps")]
    NoClock {
        /// Its name.
        adapter: String,
    },
    /// Work that the checks refused, for instance buffers bound to another kernel.
    #[error("{what} was refused: {reason}")]
    Refused {
        /// Which call.
        what: String,
        /// What was wrong.
        reason: String,
    },
    /// The device stopped: reset, unplugged, driver crashed or updated. All buffers are gone.
    #[error("the GPU was lost: {reason}. Its memory is gone; open it again and start from the last checkpoint")]
    DeviceLost {
        /// What the driver said.
        reason: String,
    },
}
