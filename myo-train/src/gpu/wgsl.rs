//! The files of the kernels hold what the language holds for whole: modules, or functions and declarations that a kernel is put
//! together from, of which one is printed of generic code. Nothing is filled in.

use std::path::{Path, PathBuf};

use myo_gpu::{Source, kernel_in_groups};

use super::testing::{assert_valid, assert_valid_module};
use super::{Tile, dense, kernels, learn, noise};

/// Files that are no modules of their own, and what they lack first.
const PARTS: &[(&str, &str)] = &[
    // What a tile is made with, which depends on its sizes (`Tile`), and what its kernels say to that.
    ("tile/tile.wgsl", "THREADS_X"),
    ("dense.wgsl", "make_tile"),
    ("learn/product.wgsl", "weight_at"),
    ("learn/outer.wgsl", "TILE_GROUPS"),
    // What is printed of generic code.
    ("noise.wgsl", "open_units"),
    // One of several cases of a kernel.
    ("dense_linear.wgsl", "y"),
    ("dense_silu.wgsl", "y"),
    ("dense_sample.wgsl", "shape"),
    ("dense_noisy.wgsl", "parameters"),
    ("learn/product_forward.wgsl", "Shape"),
    ("learn/product_backward.wgsl", "Shape"),
    ("learn/gather.wgsl", "Real"),
    // What several kernels have in common, and what is made with it.
    ("workgroup_sum.wgsl", "Summand"),
    ("sums.wgsl", "WORKGROUP"),
    ("learn/adam.wgsl", "WORKGROUP"),
    ("learn/reduce.wgsl", "WORKGROUP"),
    ("learn/scale.wgsl", "WORKGROUP"),
    ("learn/loss.wgsl", "log_density"),
    ("learn/job.wgsl", "all"),
    ("learn/half/pack.wgsl", "job_of"),
    ("units.wgsl", "SUBGROUPS"),
    // Loops over matrices, which cannot lie in arrays, are written out.
    ("learn/half/passes.wgsl", "COLUMNS"),
    ("learn/half/weights.wgsl", "TILE_COLUMNS"),
];

/// All kernels that are put together, of all kinds and of several sizes.
fn kernels() -> Vec<String> {
    let tiles = [
        Tile::new(4, 64, 8, (4, 4)),
        Tile::new(16, 64, 16, (4, 4)),
        Tile::new(64, 128, 8, (8, 4)),
        Tile::new(128, 128, 8, (8, 8)),
    ];
    let mut all: Vec<_> = tiles.iter().flat_map(|&tile| [dense::texts(tile), learn::texts(tile)].concat()).collect();
    all.extend([kernels::SUMS.to_owned(), noise::text()]);
    all.sort();
    all.dedup();
    all
}

/// The kernels' files, by their path from here.
fn files() -> Vec<(String, String)> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/gpu");
    let (mut folders, mut files) = (vec![here.clone()], vec![]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            match entry.unwrap().path() {
                path if path.is_dir() => folders.push(path),
                path if path.extension().is_some_and(|e| e == "wgsl") => files.push(read(&here, path)),
                _ => {}
            }
        }
    }
    files
}

fn read(here: &Path, path: PathBuf) -> (String, String) {
    let name = path.strip_prefix(here).unwrap().to_str().unwrap().replace('\\', "/");
    (name, std::fs::read_to_string(path).unwrap())
}

#[test]
fn every_kernel_is_valid() {
    let kernels = kernels();
    assert!(kernels.len() > 40, "{}", kernels.len());
    kernels.iter().for_each(|text| assert_valid(text));
}

#[test]
fn every_kernel_is_valid_for_groups() {
    for text in kernels() {
        let module =
            kernel_in_groups(Source::Wgsl(&text), "main", 9).unwrap_or_else(|reason| panic!("{reason}\n{text}"));
        assert_valid_module(&module, &text);
    }
}

#[test]
fn every_file_is_a_module_or_lacks_only_what_other_files_declare() {
    let (files, kernels) = (files(), kernels());
    for (name, text) in &files {
        let Some((_, missing)) = PARTS.iter().find(|(part, _)| part == name) else {
            assert_valid(text);
            continue;
        };
        // It is read to its end before names are looked up: there is no other mistake in its grammar.
        let error = naga::front::wgsl::parse_str(text).expect_err(name).emit_to_string(text);
        assert!(error.contains(&format!("no definition in scope for identifier: `{missing}`")), "{name}: {error}");
        assert!(kernels.iter().any(|kernel| kernel.contains(text)), "{name} is in no kernel as it stands");
    }
    for (part, _) in PARTS {
        assert!(files.iter().any(|(name, _)| name == part), "there is no {part}");
    }
}
