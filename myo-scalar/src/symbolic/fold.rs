//! Constant folding and algebraic identities. They hold for finite numbers; products with zero are zero.

use super::graph::{Graph, Id, Kind, Op};

/// A node that an operation is equal to, if a simpler one is known.
pub fn simplify(graph: &mut Graph, op: Op, args: [Id; 3]) -> Option<Id> {
    fold_numbers(graph, op, args)
        .or_else(|| fold_words(graph, op, args))
        .or_else(|| fold_masks(graph, op, args))
        .or_else(|| identity(graph, op, args))
        .or_else(|| select(graph, op, args))
}

fn op(graph: &Graph, id: Id) -> (Op, [Id; 3]) {
    let node = &graph.nodes[id as usize];
    (node.op, node.args)
}

fn number(graph: &Graph, id: Id) -> Option<f64> {
    match graph.nodes[id as usize].op {
        Op::Number(bits) => Some(f64::from_bits(bits)),
        _ => None,
    }
}

fn word(graph: &Graph, id: Id) -> Option<u32> {
    match graph.nodes[id as usize].op {
        Op::Word(x) => Some(x),
        _ => None,
    }
}

fn truth(graph: &Graph, id: Id) -> Option<bool> {
    match graph.nodes[id as usize].op {
        Op::Truth(x) => Some(x),
        _ => None,
    }
}

/// Numbers from constant numbers, in double precision.
fn fold_numbers(graph: &mut Graph, op: Op, args: [Id; 3]) -> Option<Id> {
    let operand = |k: usize| number(graph, args[k]);
    let value = match op {
        Op::Add => operand(0)? + operand(1)?,
        Op::Sub => operand(0)? - operand(1)?,
        Op::Mul => operand(0)? * operand(1)?,
        Op::MulAdd => operand(0)? * operand(1)? + operand(2)?,
        Op::Neg => -operand(0)?,
        Op::Sqrt => operand(0)?.sqrt(),
        Op::Rsqrt => operand(0)?.sqrt().recip(),
        Op::Recip => operand(0)?.recip(),
        Op::Abs => operand(0)?.abs(),
        Op::Saturate => operand(0)?.clamp(0.0, 1.0),
        Op::Min => operand(0)?.min(operand(1)?),
        Op::Max => operand(0)?.max(operand(1)?),
        Op::Floor => operand(0)?.floor(),
        Op::Round => operand(0)?.round_ties_even(),
        Op::ToNumber => f64::from(word(graph, args[0])?),
        Op::FromBits => f64::from(f32::from_bits(word(graph, args[0])?)),
        Op::Less => {
            let less = operand(0)? < operand(1)?;
            return Some(graph.truth(less));
        }
        _ => return None,
    };
    Some(graph.number(value))
}

fn fold_words(graph: &mut Graph, op: Op, args: [Id; 3]) -> Option<Id> {
    let operand = |k: usize| word(graph, args[k]);
    let wide = || Some(u64::from(operand(0)?) * u64::from(operand(1)?));
    let value = match op {
        Op::WordAdd => operand(0)?.wrapping_add(operand(1)?),
        Op::Xor => operand(0)? ^ operand(1)?,
        Op::BitAnd => operand(0)? & operand(1)?,
        Op::BitOr => operand(0)? | operand(1)?,
        Op::ShiftLeft(by) => operand(0)? << by,
        Op::ShiftRight(by) => operand(0)? >> by,
        Op::MulHigh => (wide()? >> 32) as u32,
        Op::MulLow => wide()? as u32,
        Op::ToBits => (number(graph, args[0])? as f32).to_bits(),
        Op::ToWord => number(graph, args[0])? as i64 as u32,
        _ => return None,
    };
    Some(graph.word(value))
}

fn fold_masks(graph: &mut Graph, op: Op, args: [Id; 3]) -> Option<Id> {
    let [a, b, _] = args;
    match op {
        Op::Not => match (truth(graph, a), self::op(graph, a)) {
            (Some(x), _) => Some(graph.truth(!x)),
            (None, (Op::Not, [inner, ..])) => Some(inner),
            _ => None,
        },
        Op::And | Op::Or => {
            // `true` is neutral for "and", `false` for "or"; the other one decides.
            let neutral = op == Op::And;
            match (truth(graph, a), truth(graph, b)) {
                (Some(x), _) => Some(if x == neutral { b } else { a }),
                (_, Some(y)) => Some(if y == neutral { a } else { b }),
                _ if a == b => Some(a),
                _ => None,
            }
        }
        Op::Less if a == b => Some(graph.truth(false)),
        _ => None,
    }
}

fn select(graph: &mut Graph, op: Op, args: [Id; 3]) -> Option<Id> {
    let (Op::Select, [mask, a, b]) = (op, args) else { return None };
    if a == b {
        return Some(a);
    }
    match (truth(graph, mask), self::op(graph, mask)) {
        (Some(x), _) => Some(if x { a } else { b }),
        (None, (Op::Not, [inner, ..])) => {
            let kind = graph.nodes[a as usize].kind;
            Some(graph.apply(Op::Select, &[inner, b, a], kind))
        }
        _ => None,
    }
}

fn apply(graph: &mut Graph, op: Op, args: &[Id]) -> Option<Id> {
    Some(graph.apply(op, args, Kind::Number))
}

fn identity(graph: &mut Graph, op: Op, args: [Id; 3]) -> Option<Id> {
    let [a, b, c] = args;
    match op {
        Op::Neg => negation(graph, a),
        Op::Add => sum(graph, a, b),
        Op::Sub => difference(graph, a, b),
        Op::Mul => product(graph, a, b),
        Op::MulAdd => fused(graph, a, b, c),
        Op::Min | Op::Max if a == b => Some(a),
        Op::Min => limited(graph, a, b, Op::Max, [1.0, 0.0]),
        Op::Max => limited(graph, a, b, Op::Min, [0.0, 1.0]),
        Op::Saturate if self::op(graph, a).0 == Op::Saturate => Some(a),
        _ => None,
    }
}

/// A minimum with one or a maximum with zero (`bounds[0]`), perhaps of the other (`inner` with `bounds[1]`).
fn limited(graph: &mut Graph, a: Id, b: Id, inner: Op, bounds: [f64; 2]) -> Option<Id> {
    let x = match (number(graph, a), number(graph, b)) {
        (Some(bound), _) if bound == bounds[0] => b,
        (_, Some(bound)) if bound == bounds[0] => a,
        _ => return None,
    };
    let (op, [p, q, _]) = op(graph, x);
    if op == Op::Saturate {
        return Some(x);
    }
    (op == inner && number(graph, q) == Some(bounds[1])).then(|| graph.apply(Op::Saturate, &[p], Kind::Number))
}

fn negation(graph: &mut Graph, a: Id) -> Option<Id> {
    match op(graph, a) {
        (Op::Neg, [x, ..]) => Some(x),
        (Op::Sub, [x, y, _]) => apply(graph, Op::Sub, &[y, x]),
        _ => None,
    }
}

fn sum(graph: &mut Graph, a: Id, b: Id) -> Option<Id> {
    match (number(graph, a), number(graph, b)) {
        (Some(0.0), _) => return Some(b),
        (_, Some(0.0)) => return Some(a),
        (Some(x), _) => return add_constant(graph, b, x),
        (_, Some(y)) => return add_constant(graph, a, y),
        _ => {}
    }
    match (op(graph, a), op(graph, b)) {
        (_, (Op::Neg, [y, ..])) => apply(graph, Op::Sub, &[a, y]),
        ((Op::Neg, [x, ..]), _) => apply(graph, Op::Sub, &[b, x]),
        (_, (Op::Mul, [p, q, _])) => apply(graph, Op::MulAdd, &[p, q, a]),
        ((Op::Mul, [p, q, _]), _) => apply(graph, Op::MulAdd, &[p, q, b]),
        _ => None,
    }
}

/// `a + y` where `a` ends in a constant itself.
fn add_constant(graph: &mut Graph, a: Id, y: f64) -> Option<Id> {
    let (op, [p, q, r]) = op(graph, a);
    match op {
        Op::Add => {
            let sum = graph.number(number(graph, q)? + y);
            apply(graph, Op::Add, &[p, sum])
        }
        Op::Sub => match (number(graph, p), number(graph, q)) {
            (Some(x), _) => {
                let sum = graph.number(x + y);
                apply(graph, Op::Sub, &[sum, q])
            }
            (_, Some(x)) => {
                let sum = graph.number(y - x);
                apply(graph, Op::Add, &[p, sum])
            }
            _ => None,
        },
        Op::MulAdd => {
            let sum = graph.number(number(graph, r)? + y);
            apply(graph, Op::MulAdd, &[p, q, sum])
        }
        Op::Mul => {
            let y = graph.number(y);
            apply(graph, Op::MulAdd, &[p, q, y])
        }
        _ => None,
    }
}

fn difference(graph: &mut Graph, a: Id, b: Id) -> Option<Id> {
    if a == b {
        return Some(graph.number(0.0));
    }
    match (number(graph, a), number(graph, b)) {
        (Some(0.0), _) => return apply(graph, Op::Neg, &[b]),
        (_, Some(y)) => {
            let minus = graph.number(-y);
            return apply(graph, Op::Add, &[a, minus]);
        }
        _ => {}
    }
    match (op(graph, a), op(graph, b)) {
        (_, (Op::Neg, [y, ..])) => apply(graph, Op::Add, &[a, y]),
        (_, (Op::Mul, [p, q, _])) => {
            let minus = apply(graph, Op::Neg, &[p])?;
            apply(graph, Op::MulAdd, &[minus, q, a])
        }
        ((Op::Mul, [p, q, _]), _) => {
            let minus = apply(graph, Op::Neg, &[b])?;
            apply(graph, Op::MulAdd, &[p, q, minus])
        }
        _ => None,
    }
}

fn product(graph: &mut Graph, a: Id, b: Id) -> Option<Id> {
    let (constant, other) = match (number(graph, a), number(graph, b)) {
        (Some(x), _) => (x, b),
        (_, Some(y)) => (y, a),
        _ => return signs(graph, a, b),
    };
    if constant == 0.0 {
        return Some(graph.number(0.0));
    }
    if constant == 1.0 {
        return Some(other);
    }
    if constant == -1.0 {
        return apply(graph, Op::Neg, &[other]);
    }
    let (op, [p, q, r]) = op(graph, other);
    match op {
        Op::Neg => {
            let minus = graph.number(-constant);
            apply(graph, Op::Mul, &[p, minus])
        }
        Op::Mul => {
            let product = graph.number(number(graph, q)? * constant);
            apply(graph, Op::Mul, &[p, product])
        }
        Op::MulAdd => {
            let [factor, offset] = [q, r].map(|x| number(graph, x));
            let [factor, offset] = [factor? * constant, offset? * constant].map(|x| graph.number(x));
            apply(graph, Op::MulAdd, &[p, factor, offset])
        }
        _ => None,
    }
}

fn signs(graph: &mut Graph, a: Id, b: Id) -> Option<Id> {
    let (x, y) = match (op(graph, a), op(graph, b)) {
        ((Op::Neg, [x, ..]), (Op::Neg, [y, ..])) => return apply(graph, Op::Mul, &[x, y]),
        ((Op::Neg, [x, ..]), _) => (x, b),
        (_, (Op::Neg, [y, ..])) => (a, y),
        _ => return None,
    };
    let product = apply(graph, Op::Mul, &[x, y])?;
    apply(graph, Op::Neg, &[product])
}

fn fused(graph: &mut Graph, a: Id, b: Id, c: Id) -> Option<Id> {
    if number(graph, c) == Some(0.0) {
        return apply(graph, Op::Mul, &[a, b]);
    }
    let (constant, other) = match (number(graph, a), number(graph, b)) {
        (Some(_), Some(_)) => {
            let product = apply(graph, Op::Mul, &[a, b])?;
            return apply(graph, Op::Add, &[product, c]);
        }
        (Some(x), _) => (x, b),
        (_, Some(y)) => (y, a),
        _ => return fused_signs(graph, a, b, c),
    };
    if constant == 0.0 {
        return Some(c);
    }
    if constant == 1.0 {
        return apply(graph, Op::Add, &[other, c]);
    }
    if constant == -1.0 {
        return apply(graph, Op::Sub, &[c, other]);
    }
    let (op, [p, q, _]) = op(graph, other);
    match op {
        Op::Neg => {
            let minus = graph.number(-constant);
            apply(graph, Op::MulAdd, &[p, minus, c])
        }
        Op::Mul => {
            let product = graph.number(number(graph, q)? * constant);
            apply(graph, Op::MulAdd, &[p, product, c])
        }
        _ => None,
    }
}

fn fused_signs(graph: &mut Graph, a: Id, b: Id, c: Id) -> Option<Id> {
    match (op(graph, a), op(graph, b)) {
        ((Op::Neg, [x, ..]), (Op::Neg, [y, ..])) => apply(graph, Op::MulAdd, &[x, y, c]),
        // One place for the sign, so that equal products meet.
        (_, (Op::Neg, [y, ..])) => {
            let minus = apply(graph, Op::Neg, &[a])?;
            apply(graph, Op::MulAdd, &[minus, y, c])
        }
        _ => None,
    }
}
