//! Groups: the same work on several parts of every buffer at once.
//!
//! A [`Gpu`] [in groups](Gpu::in_groups) makes buffers of one part per group, one part after the other, and a kernel runs for
//! every group on the parts of that group alone, as if there were no other: the groups are the third dimension of a dispatch,
//! and [`kernel_in_groups`] rewrites every access to begin at the group's part. Whoever writes kernels and binds buffers need not know.

use std::sync::Arc;

use naga::{AddressSpace, Binding, BuiltIn, Function, Module, TypeInner};

use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::parts::check_parts;
use crate::source::Source;

/// Most groups: their numbers lie in a small uniform.
pub const MAX_GROUPS: usize = 256;

/// Parts begin at multiples of so many bytes, a multiple of the size of every element.
const ALIGNMENT: u64 = 256;

/// Bindings whose parts have lengths: more than any kernel has.
const BINDINGS: usize = 16;

/// How many groups a handle makes buffers and kernels for, and those that its batches run for.
#[derive(Clone, Debug)]
pub(crate) struct Groups {
    pub count: usize,
    pub layout: wgpu::BindGroupLayout,
    pub active: Active,
}

/// Groups that a batch runs for.
#[derive(Clone, Debug)]
pub(crate) struct Active {
    pub list: Arc<[usize]>,
    pub bindings: wgpu::BindGroup,
}

impl Gpu {
    /// The same device for `count` groups: buffers that it makes have a part for each, kernels that it compiles run for all of
    /// them at once, and batches run for all. For one group, the device as it is.
    ///
    /// # Errors
    /// [`GpuError::Groups`] for none, for more than [`MAX_GROUPS`], or for groups of groups; no memory left, device lost.
    pub fn in_groups(&self, count: usize) -> Result<Self, GpuError> {
        match count {
            1 => return Ok(self.clone()),
            2..=MAX_GROUPS if self.groups.is_none() => {}
            _ => return Err(GpuError::Groups { got: count, max: MAX_GROUPS }),
        }
        let entries = [wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        }];
        let descriptor = wgpu::BindGroupLayoutDescriptor { label: Some("groups"), entries: &entries };
        let layout = self
            .guarded(|| self.device().create_bind_group_layout(&descriptor))
            .map_err(|fault| fault.during("groups"))?;
        let all: Vec<_> = (0..count).collect();
        let active = self.active(&layout, &all)?;
        Ok(self.with_groups(Some(Groups { count, layout, active })))
    }

    /// How many groups buffers and kernels are made for.
    pub fn groups(&self) -> usize {
        self.groups.as_ref().map_or(1, |groups| groups.count)
    }

    /// A handle whose batches run for these groups alone.
    ///
    /// # Errors
    /// [`GpuError::Groups`] for a group that there is not, no memory left, device lost.
    pub fn for_groups(&self, list: &[usize]) -> Result<Self, GpuError> {
        if let Some(&wrong) = list.iter().find(|&&group| group >= self.groups()) {
            return Err(GpuError::Groups { got: wrong + 1, max: self.groups() });
        }
        let Some(groups) = &self.groups else { return Ok(self.clone()) };
        let active = self.active(&groups.layout, list)?;
        Ok(self.with_groups(Some(Groups { active, ..groups.clone() })))
    }

    fn active(&self, layout: &wgpu::BindGroupLayout, list: &[usize]) -> Result<Active, GpuError> {
        let mut words = [0; MAX_GROUPS];
        words.iter_mut().zip(list).for_each(|(word, &group)| *word = group as u32);
        // What the groups have in common needs no parts.
        let plain = self.with_groups(None);
        let uniform = plain.buffer::<u32>("groups", words.len())?;
        plain.write(&uniform, 0, &words)?;
        let entries = [wgpu::BindGroupEntry { binding: 0, resource: uniform.raw().as_entire_binding() }];
        let descriptor = wgpu::BindGroupDescriptor { label: Some("groups"), layout, entries: &entries };
        let bindings =
            self.guarded(|| self.device().create_bind_group(&descriptor)).map_err(|fault| fault.during("groups"))?;
        Ok(Active { list: list.into(), bindings })
    }
}

/// Bytes from one part to the next, for parts of so many bytes.
pub(crate) fn part_bytes(bytes: u64) -> u64 {
    bytes.saturating_add(ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT
}

/// The uniform that a kernel for groups is bound to behind all others: bytes from one part to the next of every buffer, by
/// their bindings. None for more than a kernel can address.
pub(crate) fn lengths(parts: impl Iterator<Item = u64>) -> Option<[u32; BINDINGS]> {
    let mut words = [0; BINDINGS];
    for (word, bytes) in words.iter_mut().zip(parts) {
        *word = bytes.try_into().ok()?;
    }
    Some(words)
}

/// A storage buffer of a kernel.
struct Storage {
    name: String,
    binding: u32,
    /// Bytes of an element.
    stride: u32,
}

/// What a [`Gpu`] in groups compiles instead of a kernel of so many bindings: accesses to storage buffers begin at the part of
/// the group, whose place in the list of active ones is the third index of the workgroup. Behind the other bindings follow the
/// lengths of the parts.
///
/// # Errors
/// The kernel is invalid, has buffers that are no arrays, uses one in another way than `buffer[index]`, or does not ask for its
/// workgroup's index.
pub fn kernel_in_groups(source: Source<'_>, entry: &str, bindings: usize) -> Result<Module, String> {
    let text = match source {
        Source::Wgsl(text) => text.to_owned(),
        Source::Naga(module) => written(&module)?,
    };
    let parse = |text: &str| naga::front::wgsl::parse_str(text).map_err(|e| e.emit_to_string(text));
    let module = parse(&text)?;
    let storage = storage(&module)?;
    let workgroup = workgroup_name(&module, entry)?;
    let names: Vec<&str> = storage.iter().map(|storage| storage.name.as_str()).collect();
    let shadows =
        std::iter::chain(module.functions.iter().map(|(_, function)| function), [entry_point(&module, entry)?]);
    if let Some(name) = shadows.flat_map(local_names).find(|name| names.contains(name)) {
        return Err(format!("{name} is the name of a buffer and of a variable"));
    }
    let mut begin = format!("\n    let part_of = active_groups[{workgroup}.z / 4u][{workgroup}.z % 4u];\n");
    let mut declarations = format!(
        "\n@group(1) @binding(0) var<uniform> active_groups: array<vec4<u32>, {}>;
@group(0) @binding({bindings}) var<uniform> part_bytes: array<vec4<u32>, {}>;\n",
        MAX_GROUPS / 4,
        BINDINGS / 4
    );
    for Storage { name, binding, stride } in &storage {
        declarations += &format!("var<private> part_of_{name}: u32;\n");
        let bytes = format!("part_bytes[{}u][{}u]", binding / 4, binding % 4);
        begin += &format!("    part_of_{name} = part_of * ({bytes} / {stride}u);\n");
    }
    let text = from_parts(&text, &names);
    let head = text.find(&format!("fn {entry}(")).ok_or("the entry point is not to be found")?;
    let body = head + text[head..].find(") {").ok_or("the entry point has no body")? + 3;
    let module = parse(&[&text[..body], &begin, &text[body..], &declarations].concat())?;
    check_parts(&module)?;
    Ok(module)
}

fn written(module: &Module) -> Result<String, String> {
    use naga::valid::{Capabilities, ValidationFlags, Validator};
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::all());
    let info = validator.validate(module).map_err(|error| error.into_inner().to_string())?;
    let flags = naga::back::wgsl::WriterFlags::empty();
    naga::back::wgsl::write_string(module, &info, flags).map_err(|error| error.to_string())
}

fn storage(module: &Module) -> Result<Vec<Storage>, String> {
    let is_storage = |space| matches!(space, AddressSpace::Storage { .. });
    let globals = module.global_variables.iter().map(|(_, global)| global);
    let place = |global: &naga::GlobalVariable| {
        let name = global.name.clone().ok_or("a buffer has no name")?;
        let binding = global.binding.filter(|at| at.group == 0).ok_or_else(|| format!("{name} is not bound"))?.binding;
        match module.types[global.ty].inner {
            TypeInner::Array { stride, .. } if ALIGNMENT.is_multiple_of(stride.into()) => {
                Ok(Storage { name, binding, stride })
            }
            _ => Err(format!("{name} is no array of elements whose size divides {ALIGNMENT} bytes")),
        }
    };
    globals.filter(|global| is_storage(global.space)).map(place).collect()
}

fn entry_point<'a>(module: &'a Module, entry: &str) -> Result<&'a Function, String> {
    let point = module.entry_points.iter().find(|point| point.name == entry);
    point.map(|point| &point.function).ok_or_else(|| format!("it has no entry point {entry}"))
}

/// Name of the argument with the index of the workgroup.
fn workgroup_name(module: &Module, entry: &str) -> Result<String, String> {
    let is_workgroup = |binding: &Option<Binding>| *binding == Some(Binding::BuiltIn(BuiltIn::WorkGroupId));
    let mut arguments = entry_point(module, entry)?.arguments.iter();
    let name = arguments.find(|argument| is_workgroup(&argument.binding)).and_then(|argument| argument.name.clone());
    name.ok_or_else(|| format!("{entry} has no argument with the workgroup_id"))
}

fn local_names(function: &Function) -> impl Iterator<Item = &str> {
    let arguments = function.arguments.iter().filter_map(|argument| argument.name.as_deref());
    let variables = function.local_variables.iter().filter_map(|(_, variable)| variable.name.as_deref());
    arguments.chain(variables).chain(function.named_expressions.values().map(String::as_str))
}

/// Adds the beginning of the part to every index of these buffers.
fn from_parts(text: &str, names: &[&str]) -> String {
    let is_other = |c: char| !(c.is_alphanumeric() || c == '_');
    let (mut out, mut rest) = (String::new(), text);
    // Of every open bracket, whether it holds the index of a buffer.
    let mut indices = Vec::new();
    while let Some(c) = rest.chars().next() {
        let comment = if rest.starts_with("//") { rest.find('\n').unwrap_or(rest.len()) } else { 0 };
        let length = rest.find(is_other).unwrap_or(rest.len()).max(comment).max(c.len_utf8());
        let word = &rest[..length];
        rest = &rest[length..];
        if word == "]" && indices.pop() == Some(true) {
            out.push(')');
        }
        let is_buffer = names.contains(&word) && !out.ends_with('.') && rest.starts_with('[');
        out += word;
        if is_buffer {
            out += &format!("[part_of_{word} + (");
            rest = &rest[1..];
            indices.push(true);
        } else if word == "[" {
            indices.push(false);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::from_parts;

    #[test]
    fn indices_of_buffers_alone_begin_at_the_part() {
        let text = "x[i << 1u] = y[j[x[2]] + 1u][k]; // x[0, 1)\ns.x[0] += xx[a[1]] + x;";
        let expected =
            "x[part_of_x + (i << 1u)] = y[j[x[part_of_x + (2)]] + 1u][k]; // x[0, 1)\ns.x[0] += xx[a[1]] + x;";
        assert_eq!(from_parts(text, &["x"]), expected);
    }
}
