//! What is around the computation: types, buffers, the entry point.

use super::body::Body;
use super::{ENTRY_POINT, KernelSource, Use};
use crate::symbolic::graph::{Kind, Op, Sharing};
use crate::symbolic::program::Program;
use crate::symbolic::region::Statement;
use naga::{
    AddressSpace, ArraySize, BinaryOperator, Binding, Block, BuiltIn, EntryPoint, Expression, Function,
    FunctionArgument, GlobalVariable, Handle, Module, ResourceBinding, Scalar, ShaderStage, Span,
    Statement as Instruction, StorageAccess, Type, TypeInner, VectorSize,
};

/// Types of a kernel.
pub struct Types {
    pub number: Handle<Type>,
    pub word: Handle<Type>,
    pub mask: Handle<Type>,
}

impl Types {
    pub fn of(&self, kind: Kind) -> Handle<Type> {
        match kind {
            Kind::Number => self.number,
            Kind::Word => self.word,
            Kind::Mask => self.mask,
        }
    }
}

/// How the program uses a buffer.
#[derive(Clone, Copy)]
struct BufferUse {
    kind: Kind,
    written: bool,
}

pub fn print(program: &Program, names: &[&str], workgroup_size: u32) -> KernelSource {
    let mut module = Module::default();
    let types = scalar_types(&mut module);
    let uses = buffer_uses(program, names.len());
    let buffers: Vec<Handle<GlobalVariable>> =
        (0..names.len()).map(|binding| buffer(&mut module, &types, binding, names[binding], uses[binding])).collect();
    let has_table = !program.table.is_empty();
    let table = has_table.then(|| table(&mut module, &types, names.len()));
    let environments = environments(&mut module, &types, names.len() + usize::from(has_table));
    let arguments = arguments(&mut module, &types);
    let mut body = Body::new(program, &mut module, &types, arguments, names);
    body.bind(buffers.into_iter().map(Expression::GlobalVariable), table.map(Expression::GlobalVariable));
    body.guard(workgroup_size, environments);
    body.run();
    let function = body.finish();
    module.entry_points.push(entry_point(function, workgroup_size));
    let used = uses.iter().map(|each| if each.written { Use::Write } else { Use::Read });
    let bindings = used.chain(has_table.then_some(Use::Table)).chain([Use::Environments]).collect();
    KernelSource { module, bindings, table: program.table.iter().map(|&x| x as f32).collect() }
}

/// A module of one function, whose arguments point to the program's buffers.
pub fn print_function(program: &Program, name: &str, names: &[&str]) -> Module {
    let mut module = Module::default();
    let types = scalar_types(&mut module);
    let uses = buffer_uses(program, names.len());
    let mut pointer = |binding: usize| {
        let size = program.entries(binding as u32).shared.try_into().expect("every buffer is used");
        let base = types.of(uses[binding].kind);
        let inner = TypeInner::Array { base, size: ArraySize::Constant(size), stride: 4 };
        let base = module.types.insert(Type { name: None, inner }, Span::default());
        let inner = TypeInner::Pointer { base, space: AddressSpace::Function };
        module.types.insert(Type { name: None, inner }, Span::default())
    };
    let argument =
        |binding: usize| FunctionArgument { name: Some(names[binding].into()), ty: pointer(binding), binding: None };
    let arguments = (0..names.len()).map(argument).collect();
    assert!(program.table.is_empty(), "functions look up no constants");
    let mut body = Body::new(program, &mut module, &types, arguments, names);
    body.bind((0..names.len() as u32).map(Expression::FunctionArgument), None);
    body.run();
    let function = Function { name: Some(name.into()), ..body.finish() };
    module.functions.append(function, Span::default());
    module
}

fn entry_point(function: Function, workgroup_size: u32) -> EntryPoint {
    EntryPoint {
        name: ENTRY_POINT.into(),
        stage: ShaderStage::Compute,
        early_depth_test: None,
        workgroup_size: [workgroup_size, 1, 1],
        workgroup_size_overrides: None,
        function,
        mesh_info: None,
        task_payload: None,
        incoming_ray_payload: None,
    }
}

fn scalar_types(module: &mut Module) -> Types {
    let mut scalar =
        |scalar| module.types.insert(Type { name: None, inner: TypeInner::Scalar(scalar) }, Span::default());
    Types { number: scalar(Scalar::F32), word: scalar(Scalar::U32), mask: scalar(Scalar::BOOL) }
}

/// Element type and direction of each buffer, from how the program uses it.
fn buffer_uses(program: &Program, count: usize) -> Vec<BufferUse> {
    let mut uses = vec![BufferUse { kind: Kind::Number, written: false }; count];
    for id in program.live_nodes() {
        let node = &program.nodes[id as usize];
        if let Op::Input(buffer, _) | Op::Gather(buffer, _) = node.op {
            uses[buffer.binding as usize].kind = node.kind;
        }
    }
    for statement in &program.statements {
        if let Statement::Store(store) = statement {
            let kind = program.nodes[store.value as usize].kind;
            uses[store.buffer.binding as usize] = BufferUse { kind, written: true };
        }
    }
    uses
}

fn buffer(module: &mut Module, types: &Types, binding: usize, name: &str, used: BufferUse) -> Handle<GlobalVariable> {
    let inner = TypeInner::Array { base: types.of(used.kind), size: ArraySize::Dynamic, stride: 4 };
    let array = module.types.insert(Type { name: None, inner }, Span::default());
    let access = if used.written { StorageAccess::LOAD | StorageAccess::STORE } else { StorageAccess::LOAD };
    global(module, name, AddressSpace::Storage { access }, binding, array)
}

fn table(module: &mut Module, types: &Types, binding: usize) -> Handle<GlobalVariable> {
    buffer(module, types, binding, "table", BufferUse { kind: Kind::Number, written: false })
}

fn environments(module: &mut Module, types: &Types, binding: usize) -> Handle<GlobalVariable> {
    global(module, "environments", AddressSpace::Uniform, binding, types.word)
}

fn global(
    module: &mut Module,
    name: &str,
    space: AddressSpace,
    binding: usize,
    ty: Handle<Type>,
) -> Handle<GlobalVariable> {
    let variable = GlobalVariable {
        name: Some(name.into()),
        space,
        binding: Some(ResourceBinding { group: 0, binding: binding as u32 }),
        ty,
        init: None,
        memory_decorations: naga::MemoryDecorations::empty(),
    };
    module.global_variables.append(variable, Span::default())
}

/// `workgroup_id`, `num_workgroups` and `local_invocation_index`.
fn arguments(module: &mut Module, types: &Types) -> Vec<FunctionArgument> {
    let inner = TypeInner::Vector { size: VectorSize::Tri, scalar: Scalar::U32 };
    let vector = module.types.insert(Type { name: None, inner }, Span::default());
    [
        ("workgroup", vector, BuiltIn::WorkGroupId),
        ("workgroups", vector, BuiltIn::NumWorkGroups),
        ("invocation", types.word, BuiltIn::LocalInvocationIndex),
    ]
    .map(|(name, ty, builtin)| FunctionArgument {
        name: Some(name.into()),
        ty,
        binding: Some(Binding::BuiltIn(builtin)),
    })
    .into()
}

impl Body<'_> {
    /// Works out the environment's number; invocations past the last one return.
    fn guard(&mut self, workgroup_size: u32, environments: Handle<GlobalVariable>) {
        let [workgroup, workgroups, invocation] = [0, 1, 2].map(|k| self.declare(Expression::FunctionArgument(k)));
        let environments = self.declare(Expression::GlobalVariable(environments));
        let (row, column) = (self.component(workgroup, 1), self.component(workgroup, 0));
        let width = self.component(workgroups, 0);
        let size = self.literal_word(workgroup_size);
        let group = self.binary(BinaryOperator::Multiply, row, width);
        let group = self.binary(BinaryOperator::Add, group, column);
        let first = self.binary(BinaryOperator::Multiply, group, size);
        let environment = self.binary(BinaryOperator::Add, first, invocation);
        let environments = self.load(environments);
        let past = self.binary(BinaryOperator::GreaterEqual, environment, environments);
        let leave = Block::from_vec(vec![Instruction::Return { value: None }]);
        self.branch(past, leave, Block::new());
        self.set_environment(environment, environments);
    }
}

/// Position of an entry in a buffer.
pub fn entry(body: &mut Body<'_>, sharing: Sharing, row: u32) -> Handle<Expression> {
    let row = body.literal_word(row);
    entry_of(body, sharing, row)
}

/// The same where the row is computed.
pub fn entry_of(body: &mut Body<'_>, sharing: Sharing, row: Handle<Expression>) -> Handle<Expression> {
    match sharing {
        Sharing::Shared => row,
        Sharing::PerEnv => {
            let (environment, environments) = body.environment();
            let first = body.binary(BinaryOperator::Multiply, row, environments);
            body.binary(BinaryOperator::Add, first, environment)
        }
    }
}
