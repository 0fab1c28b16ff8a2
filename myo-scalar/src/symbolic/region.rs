//! Loops, branches and stores: what happens in order.

use super::graph::{Buffer, Id, Kind, Op};
use super::number::{Handle, Sym, SymMask, SymWord};
use super::with_graph;
use crate::carried::{Carried, Visitor};
use crate::scalar::Scalar;

/// Statements that run in order; the numbers they need are computed between them.
#[derive(Clone, Debug, Default)]
pub struct Region {
    /// Numbers of the statements.
    pub statements: Vec<u32>,
    /// The body of a loop, which runs once at least.
    pub is_loop: bool,
}

/// A variable of a loop or branch.
#[derive(Clone, Copy, Debug)]
pub struct Carry {
    /// Before.
    pub init: Id,
    /// For loops, [`Op::Carried`]: at the beginning of the body.
    pub start: Id,
    /// At the end of the body.
    pub next: Id,
    /// What it is.
    pub kind: Kind,
}

impl Carry {
    /// Whether the body leaves it as it is.
    pub fn is_constant(&self) -> bool {
        self.next == self.start || self.next == self.init
    }
}

/// A loop.
#[derive(Clone, Debug)]
pub struct Loop {
    /// Runs at most.
    pub limit: u32,
    /// Goes on only where this is true at the end of the body.
    pub again: Option<Id>,
    /// Its region.
    pub body: u32,
    /// Its variables.
    pub vars: Vec<Carry>,
}

/// A branch.
#[derive(Clone, Debug)]
pub struct Branch {
    /// Where it is taken.
    pub mask: Id,
    /// Its region.
    pub body: u32,
    /// Its variables; `start` is `init`.
    pub vars: Vec<Carry>,
}

/// A loop over the chunks of an array.
#[derive(Clone, Debug)]
pub struct Chunks {
    /// Region of the body.
    pub body: u32,
    /// Number of the chunk within the body, an integer.
    pub index: Id,
    /// The array before.
    pub init: Vec<Id>,
    /// Entries of one chunk at the beginning of the body.
    pub start: Vec<Id>,
    /// Entries of one chunk at its end.
    pub next: Vec<Id>,
    /// Where the program's table tells how many chunks there are: a driver that knew it would unroll a loop that is one because its
    /// body is long.
    pub count: Option<u32>,
}

impl Chunks {
    /// An entry of every chunk before the loop.
    pub fn init_of(&self, entry: usize) -> impl Iterator<Item = Id> + '_ {
        self.init.iter().copied().skip(entry).step_by(self.start.len())
    }
}

/// A write to a buffer.
#[derive(Clone, Copy, Debug)]
pub struct Store {
    /// Where.
    pub buffer: Buffer,
    /// Which entry.
    pub row: u32,
    /// What.
    pub value: Id,
}

/// What happens in order.
#[derive(Clone, Debug)]
pub enum Statement {
    /// See [`Loop`].
    Loop(Loop),
    /// See [`Branch`].
    Branch(Branch),
    /// See [`Chunks`].
    Chunks(Chunks),
    /// See [`Store`].
    Store(Store),
}

/// Applies one function to every variable.
struct Each<F>(F);

impl<F: FnMut(Id, Kind) -> Id> Visitor<Sym> for Each<F> {
    fn number(&mut self, x: &mut Sym) {
        *x = Sym::new((self.0)(x.id(), Kind::Number));
    }
    fn mask(&mut self, x: &mut SymMask) {
        *x = SymMask::new((self.0)(x.id(), Kind::Mask));
    }
    fn word(&mut self, x: &mut SymWord) {
        *x = SymWord::new((self.0)(x.id(), Kind::Word));
    }
}

fn each<V: Carried<Sym>>(vars: &mut V, apply: impl FnMut(Id, Kind) -> Id) {
    vars.visit(&mut Each(apply));
}

/// Number that the next statement will have. It is reserved, since nodes of its body name it.
fn reserve() -> u32 {
    with_graph(|graph| {
        let placeholder = Branch { mask: 0, body: 0, vars: vec![] };
        graph.statement(Statement::Branch(placeholder))
    })
}

/// Records a loop.
pub fn record_loop<V: Carried<Sym>>(limit: usize, vars: &mut V, body: impl FnOnce(&mut V) -> Option<SymMask>) {
    let statement = reserve();
    let region = with_graph(|graph| graph.open_region(true));
    let mut carries = Vec::new();
    each(vars, |init, kind| {
        let op = Op::Carried(statement, carries.len() as u32);
        let start = with_graph(|graph| graph.fresh(op, kind, region));
        carries.push(Carry { init, start, next: start, kind });
        start
    });
    let again = body(vars).map(Handle::id);
    with_graph(|graph| graph.close_region());
    finish(statement, vars, &mut carries);
    let made = Loop { limit: limit as u32, again, body: region, vars: carries };
    with_graph(|graph| graph.statements[statement as usize] = Statement::Loop(made));
}

/// Records a branch.
pub fn record_branch<V: Carried<Sym>>(mask: SymMask, vars: &mut V, body: impl FnOnce(&mut V)) {
    if let Some(known) = mask.known() {
        if known {
            body(vars);
        }
        return;
    }
    let statement = reserve();
    let region = with_graph(|graph| graph.open_region(false));
    let mut carries = Vec::new();
    each(vars, |init, kind| {
        carries.push(Carry { init, start: init, next: init, kind });
        init
    });
    body(vars);
    with_graph(|graph| graph.close_region());
    finish(statement, vars, &mut carries);
    let made = Branch { mask: mask.id(), body: region, vars: carries };
    with_graph(|graph| graph.statements[statement as usize] = Statement::Branch(made));
}

/// Notes the variables' last values and replaces them by the statement's outcome.
fn finish<V: Carried<Sym>>(statement: u32, vars: &mut V, carries: &mut [Carry]) {
    let mut index = 0;
    each(vars, |next, kind| {
        let carry = &mut carries[index];
        carry.next = next;
        let outcome = if carry.is_constant() {
            carry.init
        } else {
            with_graph(|graph| graph.fresh(Op::Outcome(statement, index as u32), kind, graph.region()))
        };
        index += 1;
        outcome
    });
}

/// Records a loop over chunks of `size` values.
pub fn record_chunks(values: &mut [Sym], size: usize, body: impl FnOnce(SymWord, &[Sym]) -> Vec<Sym>) {
    record_counted_chunks(None, values, size, body);
}

fn record_counted_chunks(
    count: Option<u32>,
    values: &mut [Sym],
    size: usize,
    body: impl FnOnce(SymWord, &[Sym]) -> Vec<Sym>,
) {
    let statement = reserve();
    let region = with_graph(|graph| graph.open_region(true));
    let carried = |k: usize, kind| with_graph(|graph| graph.fresh(Op::Carried(statement, k as u32), kind, region));
    let index = carried(0, Kind::Word);
    let start: Vec<Sym> = (0..size).map(|k| Sym::new(carried(k + 1, Kind::Number))).collect();
    let next = body(SymWord::new(index), &start);
    with_graph(|graph| graph.close_region());
    let ids = |values: &[Sym]| values.iter().map(|x| x.id()).collect();
    let made = Chunks { body: region, index, init: ids(values), start: ids(&start), next: ids(&next), count };
    with_graph(|graph| graph.statements[statement as usize] = Statement::Chunks(made));
    for (k, value) in values.iter_mut().enumerate() {
        let op = Op::Outcome(statement, k as u32);
        *value = Sym::new(with_graph(|graph| graph.fresh(op, Kind::Number, graph.region())));
    }
}

/// Records a loop over the rows of a table: chunks of the inputs and the old output.
pub fn record_rows<const K: usize, const I: usize>(
    table: &[[f64; K]],
    inputs: [&[Sym]; I],
    output: &mut [Sym],
    mut body: impl FnMut([Sym; K], [Sym; I], Sym) -> Sym,
) {
    let row = |k: usize| inputs.iter().map(move |input| input[k]).chain([output[k]]);
    let mut values: Vec<Sym> = (0..output.len()).flat_map(row).collect();
    record_chunks(&mut values, I + 1, |index, chunk| {
        let constants = std::array::from_fn(|column| entry(table, column, index));
        let next = body(constants, std::array::from_fn(|k| chunk[k]), chunk[I]);
        chunk[..I].iter().copied().chain([next]).collect()
    });
    for (x, row) in output.iter_mut().zip(values.chunks_exact(I + 1)) {
        *x = row[I];
    }
}

/// What a map takes of all rows.
enum Column {
    /// The same of each.
    Same(Sym),
    /// Constants.
    Constants(Vec<f64>),
    /// Anything else.
    Varying,
}

impl Column {
    fn of(all: &[Sym]) -> Self {
        match all.iter().map(|x| x.constant()).collect() {
            _ if all.iter().all(|x| x.is_same(all[0])) => Self::Same(all[0]),
            Some(constants) => Self::Constants(constants),
            None => Self::Varying,
        }
    }
}

/// Records a loop that maps rows: constants become a table, what varies entries of chunks, which the outcomes take over.
pub fn map_rows<const I: usize, const O: usize>(
    rows: &[[Sym; I]],
    mut map: impl FnMut([Sym; I]) -> [Sym; O],
) -> Vec<[Sym; O]> {
    let columns: [Column; I] =
        std::array::from_fn(|column| Column::of(&rows.iter().map(|row| row[column]).collect::<Vec<Sym>>()));
    let varying: Vec<usize> = (0..I).filter(|&column| matches!(columns[column], Column::Varying)).collect();
    let size = varying.len().max(O);
    let entry = |row: &[Sym; I], k: usize| varying.get(k).map_or_else(Sym::zero, |&column| row[column]);
    let mut values: Vec<Sym> = rows.iter().flat_map(|row| (0..size).map(move |k| entry(row, k))).collect();
    let count = with_graph(|graph| graph.put_in_table([rows.len() as f64]));
    record_counted_chunks(Some(count), &mut values, size, |index, chunk| {
        let mut entries = chunk.iter();
        let taken = std::array::from_fn(|column| match &columns[column] {
            Column::Same(x) => *x,
            Column::Constants(constants) => looked_up(constants, index),
            Column::Varying => *entries.next().expect("a chunk holds all that varies"),
        });
        map(taken).iter().chain(&chunk[O..]).copied().collect()
    });
    values.chunks_exact(size).map(|chunk| std::array::from_fn(|k| chunk[k])).collect()
}

/// An entry of the current row.
fn entry<const K: usize>(table: &[[f64; K]], column: usize, index: SymWord) -> Sym {
    looked_up(&table.iter().map(|row| row[column]).collect::<Vec<f64>>(), index)
}

/// The constant of the current row; one for all if it is the same in all rows.
fn looked_up(constants: &[f64], index: SymWord) -> Sym {
    if constants.iter().all(|&x| x == constants[0]) {
        return Sym::splat(constants[0]);
    }
    with_graph(|graph| {
        let base = graph.put_in_table(constants.iter().copied());
        Sym::new(graph.apply(Op::Table(base), &[index.id()], Kind::Number))
    })
}
