//! Operations per stage of a task's kernels, and the kernels themselves as WGSL:
//! `operations [TASK] [FILE]`.
use myo_env::gpu::record;
use myo_env::{Autoreset, Tables};
use myo_scalar::symbolic::Form;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let name = std::env::args().nth(1).unwrap_or("pointing".into());
    let task = myo_tasks::preset(&name).ok_or("no such task")?;
    let model = myo_model::Model::new(&myo_model::builtin(&task.model)?)?;
    let tables = Tables::<f64>::new(&model, &task)?;
    let loops = std::env::var_os("MYO_LOOPS").is_some();
    let form = if loops { Form::Loops } else { Form::Straight };
    let start = std::time::Instant::now();
    let program = record::step(&tables, Autoreset::SameStep, form);
    println!("recorded in {:.1?}, {} operations", start.elapsed(), program.operations());
    for stage in program.stage_counts() {
        println!("{:6}  {}", stage.operations, stage.path.join(" / "));
    }
    if std::env::args().nth(3).is_some() {
        let mut h = std::collections::BTreeMap::new();
        for id in program.live_nodes() {
            let n = &program.nodes[id as usize];
            if n.op.is_work() {
                *h.entry((n.stage, format!("{:?}", n.op))).or_insert(0) += 1;
            }
        }
        for (k, v) in h {
            println!("{k:?} {v}");
        }
    }
    let start = std::time::Instant::now();
    let kernel = program.to_kernel(&record::STEP_BUFFERS, 64);
    println!("printed in {:.1?}", start.elapsed());
    let text = kernel.to_wgsl()?;
    println!("{} lines", text.lines().count());
    if let Some(file) = std::env::args().nth(2) {
        std::fs::write(file, text)?;
    }
    Ok(())
}
