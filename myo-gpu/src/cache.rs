//! Compiled kernels kept on disk, so that drivers need not compile them again in the next process.
//!
//! File: checksum of the payload (FNV-1a, u64, little endian), payload as the driver made it. One file per device and
//! kernel in the folder `kernels` of the cache folder; the oldest are removed when they become too many.

use std::fmt::Write;
use std::io;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::gpu::Gpu;

/// What became of keeping a compiled kernel on disk. Whatever it is, the kernel works.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Cached {
    /// There is no cache folder, or the driver takes no cache from programs.
    Off,
    /// Found from an earlier process.
    Loaded,
    /// Compiled and written, or written again because the driver changed.
    Stored,
    /// Compiled, but not written.
    Failed {
        /// Why, with the file's name.
        reason: String,
    },
}

/// Files kept, of some kilobytes to megabytes each.
const FILES_MAX: usize = 200;

/// The user's folder for what can be calculated again: `MYO_CACHE_DIR`, none if that is empty, else the platform's.
pub(crate) fn default_folder() -> Option<PathBuf> {
    match std::env::var_os("MYO_CACHE_DIR") {
        Some(folder) => Some(PathBuf::from(folder)).filter(|folder| !folder.as_os_str().is_empty()),
        None => dirs::cache_dir().map(|folder| folder.join("myo")),
    }
}

/// The cache of one kernel while it is compiled.
pub(crate) struct Slot {
    path: PathBuf,
    found: Option<Vec<u8>>,
    pub raw: wgpu::PipelineCache,
}

impl Slot {
    /// The cache of a kernel, filled from disk if it is there; nothing if the device has none.
    pub fn open(gpu: &Gpu, module: &naga::Module) -> Option<Self> {
        let device = wgpu::util::pipeline_cache_key(gpu.info())?;
        let folder = gpu.cache_folder()?.join("kernels");
        if !gpu.features().contains(wgpu::Features::PIPELINE_CACHE) {
            return None;
        }
        let path = folder.join(format!("{device}_{:016x}", hash_of(module)));
        let found = load(&path);
        let descriptor = wgpu::PipelineCacheDescriptor { label: None, data: found.as_deref(), fallback: true };
        // SAFETY: the checksum says that the data is what `store` wrote, which came from `get_data`; that it belongs to
        // this device and driver is checked by wgpu.
        let raw = unsafe { gpu.device().create_pipeline_cache(&descriptor) };
        Some(Self { path, found, raw })
    }

    /// Writes what the driver compiled, unless it was found so.
    pub fn store(self) -> Cached {
        let data = self.raw.get_data();
        if data == self.found {
            return if data.is_some() { Cached::Loaded } else { Cached::Off };
        }
        match save(&self.path, &data.unwrap_or_default()) {
            Ok(()) => Cached::Stored,
            Err(e) => Cached::Failed { reason: format!("cannot write {}: {e}", self.path.display()) },
        }
    }
}

fn load(path: &Path) -> Option<Vec<u8>> {
    let file = std::fs::read(path).ok()?;
    let (checksum, data) = file.split_first_chunk()?;
    (u64::from_le_bytes(*checksum) == fnv(data).0).then(|| data.to_vec())
}

/// Writes beside the file and renames, so that no process reads half of it.
fn save(path: &Path, data: &[u8]) -> io::Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder)?;
    let mut part = tempfile::NamedTempFile::new_in(folder)?;
    io::Write::write_all(&mut part, &fnv(data).0.to_le_bytes())?;
    io::Write::write_all(&mut part, data)?;
    part.persist(path).map_err(|e| e.error)?;
    prune(folder);
    Ok(())
}

/// Removes the files written longest ago. Another process may be at it too: what is gone is gone.
fn prune(folder: &Path) {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<(SystemTime, PathBuf)> =
        entries.filter_map(|entry| Some((entry.metadata().ok()?.modified().ok()?, entry.path()))).collect();
    files.sort();
    for (_, path) in &files[..files.len().saturating_sub(FILES_MAX)] {
        let _ = std::fs::remove_file(path);
    }
}

/// FNV-1a, the same in every process and version. It tells kernels apart and finds damage; nobody attacks it.
struct Fnv(u64);

impl Fnv {
    fn add(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}

impl Write for Fnv {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        self.add(text.as_bytes());
        Ok(())
    }
}

fn fnv(bytes: &[u8]) -> Fnv {
    let mut hash = Fnv(0xcbf2_9ce4_8422_2325);
    hash.add(bytes);
    hash
}

/// Of all that is in a module, through its text form.
fn hash_of(module: &naga::Module) -> u64 {
    let mut hash = fnv(b"");
    let _ = write!(hash, "{module:?}");
    hash.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_comes_back_unless_it_is_damaged_or_cut() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("kernels/a");
        assert_eq!(load(&path), None);
        save(&path, b"compiled").unwrap();
        assert_eq!(load(&path).unwrap(), b"compiled");
        let mut file = std::fs::read(&path).unwrap();
        for cut in 0..file.len() {
            std::fs::write(&path, &file[..cut]).unwrap();
            assert_eq!(load(&path), None, "cut to {cut}");
        }
        file[10] ^= 1;
        std::fs::write(&path, &file).unwrap();
        assert_eq!(load(&path), None);
    }

    #[test]
    fn the_oldest_files_go_and_no_other_is_left_behind() {
        let folder = tempfile::tempdir().unwrap();
        for i in 0..FILES_MAX + 3 {
            save(&folder.path().join(format!("{i:04}")), &[0; 9]).unwrap();
        }
        let left = std::fs::read_dir(folder.path()).unwrap().count();
        assert_eq!(left, FILES_MAX);
        assert!(load(&folder.path().join(format!("{:04}", FILES_MAX + 2))).is_some());
    }

    #[test]
    fn the_hash_is_that_of_fnv_1a() {
        assert_eq!(fnv(b"foobar").0, 0x8594_4171_f739_67e8);
    }

    #[test]
    fn kernels_differ_by_hash() {
        let parse = |text| hash_of(&naga::front::wgsl::parse_str(text).unwrap());
        let one = parse("@compute @workgroup_size(1) fn main() { var x = 1; x = 2; }");
        assert_eq!(one, parse("@compute @workgroup_size(1) fn main() { var x = 1; x = 2; }"));
        assert_ne!(one, parse("@compute @workgroup_size(1) fn main() { var x = 1; x = 3; }"));
    }
}
