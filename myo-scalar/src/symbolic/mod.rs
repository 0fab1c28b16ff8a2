//! Symbolic numbers: generic code, run once on them, writes down what it computes.
//!
//! [`trace`] runs a closure whose [`Sym`] numbers record every operation in a graph. Equal operations on equal operands are
//! one node, constants are folded, and algebraic identities applied as the graph grows; what no output needs is
//! dropped when the [`Program`] is finished. Loops and branches that must stay ones are the trait's
//! [`repeat`](crate::Scalar::repeat), [`repeat_while`](crate::Scalar::repeat_while), [`when`](crate::Scalar::when) and
//! [`map_chunks`](crate::Scalar::map_chunks); ordinary Rust loops are unrolled, since the graph never sees them.
//!
//! ```
//! use myo_scalar::Scalar;
//! use myo_scalar::symbolic::{Sharing, Buffer, Sym, trace};
//!
//! let xs = Buffer { binding: 0, sharing: Sharing::PerEnv };
//! let program = trace(|| {
//!     let x: Sym = xs.number(0);
//!     let y = (x + x * Sym::zero()) * Sym::lit(2.0) * Sym::lit(3.0);
//!     xs.set_number(0, y);
//! });
//! // One multiplication by six is left.
//! assert_eq!(program.operations(), 1);
//! ```

mod count;
mod fold;
mod graph;
mod interpret;
mod needs;
mod number;
mod order;
#[cfg(feature = "gpu")]
pub mod print;
mod program;
mod region;
mod sink;

pub use count::StageCount;
pub use graph::{Buffer, Form, Id, Kind, Node, Op, Rows, Sharing};
pub use interpret::Contents;
pub use number::{Sym, SymMask, SymWord};
pub use order::Item;
pub use program::{Entries, Program};
pub use region::{Branch, Carry, Chunks, Loop, Statement, Store};

use graph::Graph;
use std::cell::RefCell;

thread_local! {
    /// The graph that this thread's symbolic numbers refer to.
    static GRAPH: RefCell<Option<Graph>> = const { RefCell::new(None) };
}

/// Runs `record` and returns what its symbolic numbers computed and stored. Numbers must not outlive it.
///
/// # Panics
/// Inside another trace on the same thread, and where `record` uses a number from a loop or branch outside it.
pub fn trace(record: impl FnOnce()) -> Program {
    trace_as(Form::Straight, record)
}

/// The same in a form.
///
/// # Panics
/// As [`trace`].
pub fn trace_as(form: Form, record: impl FnOnce()) -> Program {
    let recording = Recording::begin(form);
    record();
    Program::new(recording.finish())
}

/// That a trace is running on this thread. Dropping it ends the trace, also when a panic unwinds through `record`.
struct Recording;

impl Recording {
    fn begin(form: Form) -> Self {
        GRAPH.with_borrow_mut(|graph| {
            assert!(graph.is_none(), "a trace is running on this thread already");
            *graph = Some(Graph::new(form));
        });
        Self
    }

    fn finish(self) -> Graph {
        GRAPH.with_borrow_mut(Option::take).expect("the graph put in by `begin`")
    }
}

impl Drop for Recording {
    fn drop(&mut self) {
        GRAPH.with_borrow_mut(|graph| *graph = None);
    }
}

/// Works on the graph of the running trace.
fn with_graph<T>(work: impl FnOnce(&mut Graph) -> T) -> T {
    GRAPH.with_borrow_mut(|graph| work(graph.as_mut().expect("symbolic numbers exist only inside `trace`")))
}
