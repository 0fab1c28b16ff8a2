//! What all kernels of an update are compiled from, before there is any memory to work on.

use myo_gpu::{Gpu, Recipe};

use super::half;
use super::layout::{Layout, Precision};
use super::outer::Outer;
use super::products::Products;
use super::small;
use super::update::{Tiles, max_bytes, precision};
use crate::PpoConfig;
use crate::gpu::Sizes;
use crate::networks::Networks;

/// Those of the learner that [`DeviceLearner::new`](super::DeviceLearner::new) makes.
pub fn recipes(gpu: &Gpu, sizes: &Sizes, networks: &Networks, config: &PpoConfig) -> Vec<Recipe> {
    let (tiles, precision) = (Tiles::default(), precision(gpu, config, networks));
    let layout = Layout::new(sizes, networks, config, max_bytes(gpu), precision);
    let passes = match precision {
        Precision::Single => {
            let mut passes = Products::new(gpu, sizes, &layout, networks, tiles.layers).recipes();
            passes.push(Outer::new(gpu, sizes, &layout, networks, tiles.weights).recipe());
            passes
        }
        Precision::Half => half::recipes(&layout, networks, tiles),
    };
    [small::recipes(precision), passes].concat()
}
