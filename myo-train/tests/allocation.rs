//! Learning on the processor works in memory that it took at the start.

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use common::Points;
use myo_train::{PpoConfig, Trainer};

/// Counts what is asked for while it listens.
struct Counting;

static LISTENING: AtomicBool = AtomicBool::new(false);
static CALLS: AtomicU64 = AtomicU64::new(0);
static BYTES: AtomicU64 = AtomicU64::new(0);

// SAFETY: every call is handed to the system as it is.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if LISTENING.load(Ordering::Relaxed) {
            CALLS.fetch_add(1, Ordering::Relaxed);
            BYTES.fetch_add(layout.size() as u64, Ordering::Relaxed);
        }
        // SAFETY: as the caller promised.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as the caller promised.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

/// Calls and bytes of one update after some, so that every kind of episode end was seen.
fn of_an_update(num_envs: usize) -> (u64, u64) {
    let config = PpoConfig { num_envs, exploring_starts: 0.0, ..PpoConfig::default() };
    let mut trainer = Trainer::new(Box::new(Points::new(num_envs)), config, 1).unwrap();
    (0..40).for_each(|_| drop(trainer.update().unwrap()));
    [&CALLS, &BYTES].into_iter().for_each(|count| count.store(0, Ordering::Relaxed));
    LISTENING.store(true, Ordering::Relaxed);
    drop(trainer.update().unwrap());
    LISTENING.store(false, Ordering::Relaxed);
    (CALLS.load(Ordering::Relaxed), BYTES.load(Ordering::Relaxed))
}

#[test]
fn an_update_takes_memory_for_its_metrics_only() {
    for num_envs in [256, 4096] {
        let (calls, bytes) = of_an_update(num_envs);
        // The names and numbers of its metrics, and now and then a block of rayon's queues.
        assert!(calls < 100 && bytes < 8000, "{num_envs} environments: {calls} calls, {bytes} bytes");
    }
}
