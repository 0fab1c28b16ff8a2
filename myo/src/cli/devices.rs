//! `myo devices`: the graphics cards of this machine.

use clap::Args;
use myo::auto_envs;
use myo::gpu::{Adapter, AdapterKind, GpuError, adapters};
use serde_json::json;

use super::failure::Result;
use super::output::{print, print_json, row, table};

/// Arguments of `myo devices`.
#[derive(Args)]
#[command(after_help = HELP)]
pub struct Devices {
    /// Print the list as JSON
    #[arg(long)]
    json: bool,
}

const HELP: &str = "\
Examples:
  myo devices
  myo train pointing --envs 16384 --device 0

`--device` takes the number, or the name, or a part of the name that no other adapter has, in upper or lower case; of
several cards of one name, the first. A number is never looked for in names.

JSON: `devices`, a list of objects with `number`, `name`, `kind` (`discrete`, `integrated`, `virtual` or `software`),
`backend` (the interface: `vulkan`, `metal` or `dx12`), `driver`, `max_buffer_bytes`, `max_binding_bytes`,
`max_workgroup_threads`, `max_workgroup_bytes`, `min_subgroup_threads`, and true or false for `subgroups`, `f16`, `cooperative_matrix`,
`pipeline_cache`, `timestamps`; `auto`, the number that `--backend auto` takes, or null if it takes the processor;
`auto_envs`, the least number of environments for which it does; and `hint`, what to install, or null.";

/// Runs `myo devices`.
pub fn run(args: &Devices) -> Result<()> {
    let adapters = adapters();
    let hint = hint(&adapters);
    if args.json {
        let devices: Vec<_> = adapters.iter().enumerate().map(as_json).collect::<Result<_>>()?;
        let auto = auto(&adapters);
        return print_json(&json!({"devices": devices, "auto": auto, "auto_envs": auto_envs(), "hint": hint}));
    }
    let mut text = if adapters.is_empty() { String::new() } else { format!("{}\n", listing(&adapters)) };
    text += &choice(&adapters);
    text += &hint.map_or(String::new(), |hint| format!("{hint}\n"));
    print(&text)
}

/// The adapter that `--backend auto` takes: the best one, if it is a card.
fn auto(adapters: &[Adapter]) -> Option<usize> {
    adapters.iter().position(|adapter| adapter.kind != AdapterKind::Software)
}

/// What to install, if there is no card.
fn hint(adapters: &[Adapter]) -> Option<String> {
    let error = match auto(adapters) {
        Some(_) => return None,
        None if adapters.is_empty() => GpuError::NoAdapter.to_string(),
        None => {
            "if the machine has a graphics card, install its driver; it is missing, or does not speak Vulkan, Metal \
                 or Direct3D 12"
                .into()
        }
    };
    Some(error)
}

fn choice(adapters: &[Adapter]) -> String {
    match auto(adapters) {
        Some(number) => format!(
            "`--backend auto` takes {number}, {}, for {} environments or more, the processor for fewer\n",
            adapters[number].name,
            auto_envs()
        ),
        None if adapters.is_empty() => "`--backend auto` takes the processor\n".into(),
        None => {
            "`--backend auto` takes the processor: software adapters are used only when named with --device\n".into()
        }
    }
}

fn listing(adapters: &[Adapter]) -> String {
    let mut rows = vec![row(["number", "name", "kind", "through", "largest buffer", "driver", "can do"])];
    rows.extend(adapters.iter().enumerate().map(|(number, adapter)| {
        row([
            &number.to_string(),
            &adapter.name,
            &format!("{:?}", adapter.kind).to_lowercase(),
            &adapter.backend,
            &bytes(adapter.max_buffer_bytes),
            &adapter.driver,
            &abilities(adapter),
        ])
    }));
    table(&rows)
}

fn abilities(adapter: &Adapter) -> String {
    let all = [
        (adapter.subgroups, "subgroups"),
        (adapter.f16, "16-bit floats"),
        (adapter.cooperative_matrix, "matrices"),
        (adapter.timestamps, "timing"),
        (adapter.pipeline_cache, "kernels on disk"),
    ];
    all.iter().filter(|(can, _)| *can).map(|(_, name)| *name).collect::<Vec<_>>().join(", ")
}

/// A size in powers of 1024.
fn bytes(size: u64) -> String {
    let (mut x, mut unit) = (size as f64, "B");
    for next in ["KiB", "MiB", "GiB", "TiB"] {
        if x < 1024.0 {
            break;
        }
        (x, unit) = (x / 1024.0, next);
    }
    format!("{x:.0} {unit}")
}

fn as_json((number, adapter): (usize, &Adapter)) -> Result<serde_json::Value> {
    let mut object = serde_json::to_value(adapter)?;
    object["number"] = number.into();
    Ok(object)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_read_well() {
        assert_eq!([512, 128 << 20, 2 << 30, u64::MAX].map(bytes), ["512 B", "128 MiB", "2 GiB", "16777216 TiB"]);
    }

    #[test]
    fn without_adapters_it_is_said_what_to_install() {
        assert_eq!(auto(&[]), None);
        assert!(hint(&[]).unwrap().contains("mesa-vulkan-drivers"));
        assert_eq!(choice(&[]), "`--backend auto` takes the processor\n");
    }
}
