//! Whether a kernel for groups keeps to the parts of its buffers.

use naga::{AddressSpace, BinaryOperator, Expression, Function, Handle, Module};

/// Refuses buffers that are used in another way than by an index that begins with that of the group's part.
pub fn check_parts(module: &Module) -> Result<(), String> {
    let functions = module.functions.iter().map(|(_, function)| function);
    let points = module.entry_points.iter().map(|point| &point.function);
    functions.chain(points).try_for_each(|function| check_function(module, function))
}

fn check_function(module: &Module, function: &Function) -> Result<(), String> {
    for (place, expression) in function.expressions.iter() {
        let Some(name) = buffer_name(module, expression) else { continue };
        let is_part = |index: Handle<Expression>| begins_with_part(module, function, index, name);
        let uses = || function.expressions.iter().map(|(_, expression)| expression).filter(|x| takes(x, place));
        let is_right = |x: &Expression| matches!(*x, Expression::Access { index, .. } if is_part(index));
        if uses().next().is_none() || !uses().all(is_right) {
            return Err(format!(
                "{name} is used in another way than `{name}[index]`, which kernels for groups must keep to"
            ));
        }
    }
    Ok(())
}

/// Name of the buffer that an expression is.
fn buffer_name<'a>(module: &'a Module, expression: &Expression) -> Option<&'a str> {
    let Expression::GlobalVariable(variable) = *expression else { return None };
    let global = &module.global_variables[variable];
    let is_storage = matches!(global.space, AddressSpace::Storage { .. });
    is_storage.then(|| global.name.as_deref().unwrap_or_default())
}

/// Whether an expression is about what lies at this place.
fn takes(expression: &Expression, place: Handle<Expression>) -> bool {
    match *expression {
        Expression::Access { base, .. } | Expression::AccessIndex { base, .. } => base == place,
        Expression::Load { pointer } => pointer == place,
        Expression::ArrayLength(array) => array == place,
        _ => false,
    }
}

/// Whether an index is a sum that begins with where the part of this buffer does.
fn begins_with_part(module: &Module, function: &Function, index: Handle<Expression>, name: &str) -> bool {
    let Expression::Binary { op: BinaryOperator::Add, left, .. } = function.expressions[index] else { return false };
    let Expression::Load { pointer } = function.expressions[left] else { return false };
    let Expression::GlobalVariable(part) = function.expressions[pointer] else { return false };
    module.global_variables[part].name.as_deref() == Some(&format!("part_of_{name}"))
}
