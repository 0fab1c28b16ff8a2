use myo_dynamics::{Batch, CouplingMode, Plan};
use myo_model::Model;
use myo_model::description::Landmarks;
use myo_model::import::{ImportOptions, from_mjcf};
use myo_scalar::Level;
use std::path::Path;
fn main() {
    let a: Vec<String> = std::env::args().skip(1).collect();
    let mjcf = myo_mjcf::read(Path::new(&a[0])).unwrap();
    let landmarks = Landmarks { fingertip: a[1].clone(), shoulder: a[2].clone(), elbow: None, wrist: None };
    let options = ImportOptions { landmarks, without_contacts: a.len() > 4, locked: vec![] };
    let model = Model::new(&from_mjcf(&mjcf, &options).unwrap()).unwrap();
    let t = std::time::Instant::now();
    let plan = Plan::exact(&model, CouplingMode::Reduced).unwrap().specialised();
    println!("plan {:?} ndof {} nq {} links {} pairs {} sets {} massterms {} elim entries {} products {}", t.elapsed(), plan.ndof(), plan.nq(), plan.links.len(), plan.pairs.len(), plan.sets.len(),
        plan.mass_terms.iter().map(|t| t.rows.len()).sum::<usize>(), plan.elimination.entries(), plan.elimination.columns.iter().flat_map(|c| &c.after).map(|l| l.products.len()).sum::<usize>());
    let n: usize = a[3].parse().unwrap();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let mut batch = Batch::new(&plan, n, Level::current());
    let mut seed = 1u64;
    let mut rnd = || { seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407); ((seed >> 33) as f32) / (1u64 << 31) as f32 };
    for rep in 0..8 {
        let mut dt = 0.0;
        for _ in 0..4 {
            for b in 0..n { let c: Vec<f32> = (0..plan.nmuscle()).map(|_| rnd() * 0.3).collect(); batch.set_ctrl(b, &c); }
            let t = std::time::Instant::now();
            pool.install(|| batch.step(25));
            dt += t.elapsed().as_secs_f64();
        }
        let s = batch.solver_counts().iter().fold((0, 0, 0), |s, c| (s.0 + c.steps, s.1 + c.rounds, s.2 + c.unsolved));
        println!("{rep}: {:.2} us/step/body rounds {:.3} unsolved {} z {:?}", dt / (100 * n) as f64 * 1e6, s.1 as f64 / s.0 as f64, s.2, batch.qpos(0)[2]);
    }
}
