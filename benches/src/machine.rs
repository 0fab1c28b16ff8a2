//! Where benches run, and how.

use std::sync::OnceLock;
use std::time::Duration;

use criterion::Criterion;
use myo_gpu::{AdapterChoice, Gpu};
use myo_scalar::Level;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Runs benches as the command line asks, and says first where; what a `main` of a bench calls.
///
/// Twenty samples in two seconds: differences of 2 % show on a quiet machine, and all benches take four minutes.
pub fn harness(benches: &[fn(&mut Criterion)]) {
    eprintln!("{}", here());
    let criterion = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2));
    let mut criterion = criterion.configure_from_args();
    benches.iter().for_each(|bench| bench(&mut criterion));
    criterion.final_summary();
}

/// Processor, its levels, and the card, in a line.
fn here() -> String {
    let processor = processor().unwrap_or_else(|| std::env::consts::ARCH.into());
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let levels: Vec<_> = Level::available().into_iter().map(Level::name).collect();
    let card = card().map_or("no graphics card: benches on one are left out".into(), |gpu| {
        format!("{}, driver {}", gpu.adapter().name, gpu.adapter().driver)
    });
    format!("myo {}; {processor}, {threads} hardware threads, {}; {card}", env!("CARGO_PKG_VERSION"), levels.join(", "))
}

fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

/// The graphics card, if there is one. `MYO_BENCH_SOFTWARE_CARD=1` takes software that imitates one.
pub fn card() -> Option<&'static Gpu> {
    static CARD: OnceLock<Option<Gpu>> = OnceLock::new();
    let software = std::env::var("MYO_BENCH_SOFTWARE_CARD").is_ok_and(|value| value == "1");
    let choice = if software { AdapterChoice::Any } else { AdapterChoice::Hardware };
    CARD.get_or_init(|| Gpu::open(&choice).ok()).as_ref()
}

/// One thread, on which per-core figures are measured.
pub fn one_core() -> &'static ThreadPool {
    static POOL: OnceLock<ThreadPool> = OnceLock::new();
    POOL.get_or_init(|| ThreadPoolBuilder::new().num_threads(1).build().expect("a thread starts"))
}
