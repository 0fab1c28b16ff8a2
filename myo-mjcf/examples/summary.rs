//! Reads a model file and prints how many elements of each kind it has, and what of it is not read.
//!
//! `cargo run -p myo-mjcf --example summary -- MODEL.xml [ROOT_FOLDER]`

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let model = match &arguments[..] {
        [path] => myo_mjcf::read(Path::new(path)),
        [path, root] => myo_mjcf::read_below(Path::new(root), Path::new(path)),
        _ => {
            eprintln!("usage: summary MODEL.xml [ROOT_FOLDER]");
            return ExitCode::from(2);
        }
    };
    match model {
        Ok(model) => {
            print(&model);
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn print(model: &myo_mjcf::Mjcf) {
    let counts = [
        ("bodies", model.bodies.len()),
        ("joints", model.joints().count()),
        ("geoms", model.geoms().count()),
        ("sites", model.sites().count()),
        ("cameras", model.cameras().count()),
        ("lights", model.lights().count()),
        ("meshes", model.meshes.len()),
        ("textures", model.textures.len()),
        ("materials", model.materials.len()),
        ("height fields", model.height_fields.len()),
        ("pairs", model.pairs.len()),
        ("excludes", model.excludes.len()),
        ("equalities", model.equalities.len()),
        ("tendons", model.tendons.len()),
        ("actuators", model.actuators.len()),
        ("sensors", model.sensors.len()),
        ("keys", model.keys.len()),
        ("numerics", model.numerics.len()),
        ("texts", model.texts.len()),
        ("tuples", model.tuples.len()),
    ];
    println!("model {}", model.model.as_deref().unwrap_or("without a name"));
    for (kind, count) in counts.into_iter().filter(|(_, count)| *count > 0) {
        println!("{count:7} {kind}");
    }
    for refused in &model.refused {
        println!("not read: {refused}");
    }
}
