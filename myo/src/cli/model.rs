//! `myo model`: models of the body.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand, ValueEnum};
use myo::dynamics::{CouplingMode, Plan};
use myo::model::mjcf::{MjcfOptions, to_mjcf};
use myo::model::{Model, ModelDescription, builtin_names};
use myo::train::write_whole;
use myo::{Anatomy, ModelFileError, describe_model, moment_arm_plots, own_model};

use super::failure::{Failure, Mistake, Result, complain, model_failure};
use super::model_import::Import;
use super::output::{percent, print, print_file, print_json, row, table};
use super::task::as_json;

/// What to do with models.
#[derive(Subcommand)]
pub enum Command {
    /// Names of the models that come with the program
    #[command(after_help = "Example:\n  myo model list")]
    List {
        /// Print a JSON list of objects with `name`, `joints`, `muscles`, `source`
        #[arg(long)]
        json: bool,
    },
    /// What a model consists of
    #[command(after_help = "Example:\n  myo model show mobl-arms")]
    Show {
        /// Name of a model, or a model file
        model: String,
        /// Print the whole description as JSON, with the keys of the model file
        #[arg(long)]
        json: bool,
    },
    /// Whether a model can be simulated, what is wrong if not, and what it is: reach, fibres, moment arms
    #[command(after_help = "\
Examples:
  myo model check arm.yaml
  myo model check myo-arm --plots arms      moment arms over every joint, as SVG

A model passes that keeps finite for a thousand control steps of random controls, tried here. The exit status is 0 if it
does and 1 if not.

Reach, lengths of fibres and moment arms are those of 1,000 random poses within the limits of joints.

JSON: `ok`; `errors` with `file`, `line`, `column` and `message`; and, if it is ok, `bodies`, `joints`, `coordinates`,
`muscles`, `warnings` (sentences), and `anatomy`: `poses`, `fingertip_m` (from and to, along x, y and z), `distance_m` from
the shoulder, and `muscles`, a list of objects with `name`, `optimal_length_m`, `tendon_length_m`, `force_n`, `fibre` (from
and to, in optimal lengths), `pulls` (lengths between which fibres pull), `cannot_pull` (share of poses) and `moves` (the
coordinate with the greatest moment arm, and that in m).")]
    Check {
        /// Model file, or name of a model
        model: String,
        /// Write plots of moment arms into a folder
        #[arg(long, value_name = "DIR")]
        plots: Option<PathBuf>,
        /// Print the findings as JSON
        #[arg(long)]
        json: bool,
    },
    /// Write a model for another program
    #[command(after_help = "Examples:
  myo model export mobl-arms --format mjcf > arm.xml     for MuJoCo, which simulates the very same model
  myo model export mobl-arms --format yaml --out arm.yaml")]
    Export(Export),
    /// Make a model file of one of MuJoCo (MJCF)
    Import(Import),
}

/// Arguments of `myo model export`.
#[derive(Args)]
pub struct Export {
    /// Name of a model, or a model file
    model: String,
    /// File format
    #[arg(long, value_enum, default_value_t = Format::Mjcf)]
    format: Format,
    /// File to write [default: standard output]
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Format {
    /// MuJoCo's XML
    Mjcf,
    /// The model file of this program
    Yaml,
}

/// Runs a `myo model` command.
pub fn run(command: Command) -> Result<()> {
    match command {
        Command::List { json } => list(json),
        Command::Show { model, json } => show(&model, json),
        Command::Check { model, plots, json } => check(&model, plots.as_deref(), json),
        Command::Export(export) => write(&export),
        Command::Import(import) => import.run(),
    }
}

/// A model that comes with the program, or that of a file.
pub fn describe(name_or_file: &str) -> Result<ModelDescription> {
    describe_model(name_or_file).map_err(|error| file_failure(&error))
}

/// The description of a model that does not come with the program.
pub fn own(name_or_file: &str) -> Result<Option<ModelDescription>> {
    own_model(name_or_file).map_err(|error| file_failure(&error))
}

fn file_failure(error: &ModelFileError) -> Failure {
    match error {
        ModelFileError::Model(error) => model_failure(error),
        other => Failure::sentence(other.to_string()),
    }
}

/// The checked model of [`describe`].
pub fn open(name_or_file: &str) -> Result<Model> {
    Model::new(&describe(name_or_file)?).map_err(|error| model_failure(&error))
}

fn list(json: bool) -> Result<()> {
    let models = builtin_names().iter().map(|name| describe(name)).collect::<Result<Vec<_>>>()?;
    if json {
        let object = |model: &ModelDescription| {
            let (joints, muscles) = (model.joints.len(), model.muscles.len());
            serde_json::json!({"name": model.name, "joints": joints, "muscles": muscles, "source": model.source})
        };
        return print_json(&models.iter().map(object).collect::<Vec<_>>());
    }
    let mut rows = vec![row(["name", "joints", "coupled", "muscles"])];
    rows.extend(models.iter().map(|model| {
        let [joints, coupled, muscles] =
            [model.joints.len(), model.couplings.len(), model.muscles.len()].map(|n| n.to_string());
        vec![model.name.clone(), joints, coupled, muscles]
    }));
    print(&table(&rows))
}

fn show(name_or_file: &str, json: bool) -> Result<()> {
    let description = describe(name_or_file)?;
    if json {
        return print_json(&description);
    }
    let model = Model::new(&description).map_err(|error| model_failure(&error))?;
    print(&format!("{}\n\nJoints\n{}\nMuscles\n{}", heading(&model, &description), joints(&model), muscles(&model)))
}

fn check(name_or_file: &str, plots: Option<&Path>, json: bool) -> Result<()> {
    let errors = match simulate(name_or_file) {
        Ok((model, plan)) => {
            tell(name_or_file, &model, &plan, json)?;
            return plots.map_or(Ok(()), |folder| draw(&model, &plan, folder));
        }
        Err(Failure::Mistakes(errors)) => errors,
        Err(Failure::Sentence(message)) => vec![Mistake { message, place: None, text: None, warning: false }],
        Err(failure) => return Err(failure),
    };
    if json {
        print_json(&serde_json::json!({"ok": false, "errors": errors.iter().map(as_json).collect::<Vec<_>>()}))?;
        return Err(Failure::Mistakes(Vec::new()));
    }
    Err(Failure::Mistakes(errors))
}

/// The model and its plan, tried out.
fn simulate(name_or_file: &str) -> Result<(Model, Plan<f64>)> {
    let in_file = |error: &dyn std::error::Error| Failure::sentence(format!("{name_or_file}: {error}"));
    let model = Model::new(&describe(name_or_file)?).map_err(|error| in_file(&error))?;
    let plan = Plan::exact(&model, CouplingMode::Reduced).map_err(|error| in_file(&error))?;
    plan.try_out().map_err(|error| in_file(&error))?;
    Ok((model, plan))
}

fn tell(name_or_file: &str, model: &Model, plan: &Plan<f64>, json: bool) -> Result<()> {
    let (bodies, joints, coordinates) = (model.bodies.len() - 1, model.joints.len(), plan.ndof());
    let muscles = model.muscles.len();
    let anatomy = Anatomy::of(model, plan);
    let warnings = anatomy.warnings();
    if json {
        return print_json(&serde_json::json!({
            "ok": true, "errors": [], "bodies": bodies, "joints": joints, "coordinates": coordinates, "muscles": muscles,
            "warnings": warnings, "anatomy": anatomy,
        }));
    }
    for warning in warnings {
        complain(&format!("{name_or_file}: warning: {warning}"));
    }
    let [near, far] = anatomy.distance_m;
    let [x, y, z] = anatomy.fingertip_m.map(|[from, to]| format!("{from:.2} to {to:.2}"));
    print(&format!(
        "{name_or_file} can be simulated: {bodies} bodies, {joints} joints that move with {coordinates} coordinates, \
         {muscles} muscles\n\nThe fingertip comes as near as {near:.2} m to the shoulder and {far:.2} m away, x {x}, y {y}, z {z} m.\n\n{}",
        lengths(&anatomy)
    ))
}

/// What each muscle is.
fn lengths(anatomy: &Anatomy) -> String {
    let mut rows =
        vec![row(["muscle", "force", "fibre", "tendon", "in use", "cannot pull", "moves most", "moment arm"])];
    rows.extend(anatomy.muscles.iter().map(|muscle| {
        let [from, to] = muscle.fibre;
        let (joint, arm) = match &muscle.moves {
            Some((joint, arm)) => (joint.clone(), format!("{:.1} cm", 100.0 * arm)),
            None => ("nothing".into(), String::new()),
        };
        let share = if muscle.cannot_pull > 0.0 { percent(muscle.cannot_pull) } else { String::new() };
        row([
            &muscle.name,
            &format!("{:.0} N", muscle.force_n),
            &format!("{:.1} cm", 100.0 * muscle.optimal_length_m),
            &format!("{:.1} cm", 100.0 * muscle.tendon_length_m),
            &format!("{from:.2} to {to:.2}"),
            &share,
            &joint,
            &arm,
        ])
    }));
    table(&rows)
}

/// Writes a plot for every coordinate that muscles move.
fn draw(model: &Model, plan: &Plan<f64>, folder: &Path) -> Result<()> {
    let plots = moment_arm_plots(model, plan);
    std::fs::create_dir_all(folder)
        .map_err(|error| Failure::sentence(format!("cannot make {}: {error}", folder.display())))?;
    for (coordinate, plot) in &plots {
        let svg = plot.svg().map_err(|error| Failure::sentence(error.to_string()))?;
        // A name of a joint may be anything.
        let safe: String =
            coordinate.chars().map(|c| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '_' }).collect();
        write_whole(&folder.join(format!("{safe}.svg")), svg.as_bytes())?;
    }
    complain(&format!("{} plots of moment arms are in {}", plots.len(), folder.display()));
    Ok(())
}

fn heading(model: &Model, description: &ModelDescription) -> String {
    let mass: f64 = model.bodies.iter().map(|body| body.mass).sum();
    format!(
        "{}: {} bodies of {mass:.2} kg, {} joints of which {} follow others, {} muscles\n{}",
        model.name,
        // The world is not one of them.
        model.bodies.len() - 1,
        model.joints.len(),
        model.couplings.len(),
        model.muscles.len(),
        description.source.trim(),
    )
}

fn joints(model: &Model) -> String {
    let mut rows = vec![row(["name", "moves", "from", "to", "follows"])];
    rows.extend(model.joints.iter().enumerate().map(|(index, joint)| {
        let [from, to] = joint.range.map_or([String::new(), String::new()], |range| range.map(|x| format!("{x:.3}")));
        let coupling = model.couplings.iter().find(|coupling| coupling.dependent == index);
        let follows = coupling.map_or(String::new(), |coupling| match coupling.independent {
            Some(leader) => model.joints[leader].name.clone(),
            None => "held".into(),
        });
        vec![joint.name.clone(), model.bodies[joint.body].name.clone(), from, to, follows]
    }));
    table(&rows)
}

fn muscles(model: &Model) -> String {
    let mut rows = vec![row(["name", "sites", "from", "to"])];
    rows.extend(model.muscles.iter().map(|muscle| {
        let end = |site: Option<&usize>| site.map_or("", |&site| model.bodies[model.sites[site].body].name.as_str());
        let (from, to) = (end(muscle.path.first()), end(muscle.path.last()));
        row([&muscle.name, &muscle.path.len().to_string(), from, to])
    }));
    table(&rows)
}

fn write(export: &Export) -> Result<()> {
    let description = describe(&export.model)?;
    let model = Model::new(&description).map_err(|error| model_failure(&error))?;
    let text = match export.format {
        Format::Mjcf => to_mjcf(&model, &MjcfOptions::default()),
        Format::Yaml => description.to_yaml()?,
    };
    match &export.out {
        Some(path) => Ok(write_whole(path, text.as_bytes())?),
        None => print_file(&text),
    }
}
