//! Whatever is done to a file, reading ends with a tree or an error.

use super::*;
use proptest::collection::vec;
use proptest::prelude::*;

const RICH: &str = include_str!("../data/rich.xml");
const PARTS: &str = include_str!("../data/parts.xml");
const HAND: &str = include_str!("../data/hand.xml");

/// Reads a main file beside the others, and shows what comes of it.
fn survives(main: &str) {
    let files: BTreeMap<_, _> = [("m.xml", main), ("parts.xml", PARTS), ("hand.xml", HAND)]
        .map(|(path, text)| (path.to_owned(), text.to_owned()))
        .into();
    let mut limits = Limits::default();
    limits.elements = 20_000;
    match read_from(&files, "m.xml", limits) {
        Ok(model) => assert!(!model.bodies.is_empty()),
        Err(error) => assert!(error.to_string().contains(':')),
    }
}

/// Bytes that mean something, so that mutations get past the first check.
const PIECES: [&str; 20] = [
    "<",
    ">",
    "/>",
    "\"",
    "=",
    " ",
    "<!--",
    "-->",
    "<body>",
    "</body>",
    "0",
    "-1",
    "1e308",
    "nan",
    "main",
    "é",
    "&amp;",
    "<replicate count=\"9\">",
    "<frame>",
    "name=\"ulna\"",
];

#[derive(Clone, Debug)]
enum Mutation {
    Delete(usize, usize),
    Repeat(usize, usize),
    Insert(usize, usize),
    Flip(usize, u8),
    Truncate(usize),
}

fn mutation() -> impl Strategy<Value = Mutation> {
    let at = 0..RICH.len();
    prop_oneof![
        (at.clone(), 1..200_usize).prop_map(|(at, length)| Mutation::Delete(at, length)),
        (at.clone(), 1..500_usize).prop_map(|(at, length)| Mutation::Repeat(at, length)),
        (at.clone(), 0..PIECES.len()).prop_map(|(at, piece)| Mutation::Insert(at, piece)),
        (at.clone(), 1..=255_u8).prop_map(|(at, bits)| Mutation::Flip(at, bits)),
        at.prop_map(Mutation::Truncate),
    ]
}

fn mutate(bytes: &mut Vec<u8>, mutation: &Mutation) {
    let length = bytes.len();
    let within = |at: usize| at.min(length);
    match *mutation {
        Mutation::Delete(at, count) => drop(bytes.drain(within(at)..within(at + count))),
        Mutation::Repeat(at, count) => {
            let part = bytes[within(at)..within(at + count)].to_vec();
            bytes.splice(within(at)..within(at), part);
        }
        Mutation::Insert(at, piece) => drop(bytes.splice(within(at)..within(at), PIECES[piece].bytes())),
        Mutation::Flip(at, bits) => {
            if let Some(byte) = bytes.get_mut(at) {
                *byte ^= bits;
            }
        }
        Mutation::Truncate(at) => bytes.truncate(at),
    }
}

/// Swaps whole lines, which keeps most of the file valid.
fn shuffled(lines: &[usize]) -> String {
    let all: Vec<_> = RICH.lines().collect();
    lines.iter().map(|line| all[line % all.len()]).collect::<Vec<_>>().join("\n")
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_are_survived(bytes in vec(any::<u8>(), 0..300)) {
        survives(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn mutations_of_a_rich_model_are_survived(mutations in vec(mutation(), 1..6)) {
        let mut bytes = RICH.as_bytes().to_vec();
        mutations.iter().for_each(|mutation| mutate(&mut bytes, mutation));
        survives(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn shuffled_elements_are_survived(lines in vec(0..400_usize, 1..60)) {
        survives(&format!("<mujoco><worldbody>{}</worldbody></mujoco>", shuffled(&lines)));
    }

    #[test]
    fn any_number_is_read_or_refused(number in any::<f64>(), attribute in 0..4_usize) {
        let name = ["pos", "size", "mass", "euler"][attribute];
        let text = [vec![number.to_string(); 3].join(" "), number.to_string()][usize::from(name == "mass")].clone();
        let result = try_read(&format!("<worldbody><geom {name}='{text}'/></worldbody>"));
        prop_assert_eq!(result.is_ok(), number.is_finite());
    }
}
