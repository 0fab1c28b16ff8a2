//! Nothing in a file can exhaust the machine.

use super::*;
use std::time::{Duration, Instant};

/// The message, which must come soon.
#[track_caller]
fn soon(text: &str) -> String {
    let start = Instant::now();
    let result = read_files(&[("m.xml", text)]);
    // Generous for a busy machine; what goes wrong here takes minutes or all memory.
    assert!(start.elapsed() < Duration::from_secs(20), "{:?}", start.elapsed());
    result.map(|_| "read".to_owned()).unwrap_or_else(|error| error.to_string())
}

#[test]
fn deep_nesting_is_an_error_and_no_overflow() {
    let text = format!("<mujoco>\n<worldbody>{}", "<body>".repeat(100_000));
    assert_eq!(
        soon(&text),
        "m.xml:2:1200: <body>: more than 200 elements within each other; raise the limit if this is meant"
    );
    // As deep as allowed is fine on the small stack of a test.
    let bodies = 198;
    let text =
        format!("<mujoco><worldbody>{}{}</worldbody></mujoco>", "<body>".repeat(bodies), "</body>".repeat(bodies));
    assert_eq!(read_files(&[("m.xml", &text)]).unwrap().bodies.len(), 199);
}

#[test]
fn models_attached_within_each_other_count_as_deep() {
    let nest = |inside: &str| format!("{}{inside}{}", "<frame>".repeat(150), "</frame>".repeat(150));
    let main = format!(
        "<mujoco><asset><model name='b' file='b.xml'/></asset><worldbody>{}</worldbody></mujoco>",
        nest("<attach model='b' prefix=''/>")
    );
    let other = format!("<mujoco><worldbody>{}</worldbody></mujoco>", nest("<geom/>"));
    let error = read_files(&[("a.xml", &main), ("b.xml", &other)]).unwrap_err().to_string();
    assert!(error.contains("<attach>: more than 200 elements within each other"), "{error}");
}

#[test]
fn copies_have_a_limit_alone_and_within_each_other() {
    let text = "<mujoco><worldbody><replicate count='1000000000'><geom/></replicate></worldbody></mujoco>";
    assert_eq!(
        soon(text),
        "m.xml:1:20: <replicate>: more than 100000 copies of one <replicate>; raise the limit if this is meant"
    );
    let nest = |count: &str, depth| {
        let open = format!("<replicate count='{count}'>").repeat(depth);
        format!("<mujoco><worldbody>{open}<geom/>{}</worldbody></mujoco>", "</replicate>".repeat(depth))
    };
    assert!(soon(&nest("1000", 5)).contains("more than 200000 elements after includes and copies"));
    assert!(soon(&nest("2", 150)).contains("more than 200000 elements after includes and copies"));
    let empty = nest("100000", 150).replace("<geom/>", "");
    assert_eq!(soon(&empty), "read");
}

#[test]
fn many_copies_of_much_text_are_too_much() {
    let user = "1 ".repeat(100_000);
    let text =
        format!("<mujoco><worldbody><replicate count='10000'><geom user='{user}'/></replicate></worldbody></mujoco>");
    assert!(soon(&text).contains("more than 268435456 bytes of names and lists"));
    let geoms = "<geom/>".repeat(10_000);
    let text = format!("<mujoco><default><geom user='{user}'/></default><worldbody>{geoms}</worldbody></mujoco>");
    assert!(soon(&text).contains("more than 268435456 bytes of names and lists"));
}

#[test]
fn sensors_of_copies_count() {
    let sensors = "<touch site='s'/>".repeat(1000);
    let text = format!(
        "<mujoco><worldbody><replicate count='1000'><site name='s'/></replicate></worldbody><sensor>{sensors}</sensor></mujoco>"
    );
    assert!(soon(&text).contains("<sensor>: more than 200000 elements after includes and copies"));
}

#[test]
fn elements_and_attributes_have_a_limit() {
    let text = format!("<mujoco><worldbody>{}</worldbody></mujoco>", "<geom/>".repeat(300_000));
    assert!(soon(&text).contains("<geom>: more than 200000 elements"));
    let attributes: String = (0..300).map(|number| format!(" a{number}=''")).collect();
    let text = format!("<mujoco{attributes}/>");
    assert_eq!(
        soon(&text),
        "m.xml:1:1: <mujoco>: more than 200 attributes of one element; raise the limit if this is meant"
    );
}

#[test]
fn billion_laughs_are_no_joke() {
    let text = "<!DOCTYPE m [<!ENTITY a 'ha'><!ENTITY b '&a;&a;&a;'>]><mujoco model='&b;'/>";
    let message = "m.xml:1:1: document type declarations (`<!DOCTYPE`) and entities are not read; remove them";
    assert_eq!(soon(text), message);
    assert!(
        soon("<mujoco model='&b;'/>").starts_with("m.xml:1:16: unknown entity"),
        "{}",
        soon("<mujoco model='&b;'/>")
    );
}

#[test]
fn include_chains_and_numbers_have_a_limit() {
    let files: Vec<_> = (0..30)
        .map(|number| (format!("{number}.xml"), format!("<mujoco><include file='{}.xml'/></mujoco>", number + 1)))
        .collect();
    let files: Vec<_> = files.iter().map(|(path, text)| (path.as_str(), text.as_str())).collect();
    let error = read_files(&files).unwrap_err().to_string();
    assert_eq!(
        error,
        "16.xml:1:9: <include>: more than 16 files that include each other; raise the limit if this is meant"
    );
}

#[test]
fn bytes_have_a_limit() {
    let mut limits = Limits::default();
    limits.file_bytes = 100;
    limits.total_bytes = 150;
    let file = |inside: &str| format!("<mujoco>{inside}{}</mujoco>", " ".repeat(83 - inside.len()));
    let files: BTreeMap<_, _> = [
        ("a.xml".to_owned(), file("<include file='b.xml'/>")),
        ("b.xml".to_owned(), file("<option/>")),
        ("c.xml".to_owned(), " ".repeat(101)),
    ]
    .into();
    let error = read_from(&files, "a.xml", limits.clone()).unwrap_err().to_string();
    assert_eq!(error, "a.xml:1:18: <include> file: `b.xml` has more than 50 bytes");
    assert_eq!(read_from(&files, "c.xml", limits).unwrap_err().to_string(), "c.xml: has more than 100 bytes");
}

#[test]
fn numbers_that_add_up_to_infinity_are_told() {
    let text = "<mujoco><worldbody><frame pos='1e308 0 0'><frame pos='1e308 0 0'><geom name='g'/></frame></frame></worldbody></mujoco>";
    let error =
        "m.xml:1:66: <geom name=\"g\"> pos: `inf`; it must be small enough to be a finite number after its frames";
    assert_eq!(soon(text), error);
    assert_eq!(soon("<mujoco><worldbody><body quat='1e308 1e308 0 0' /></worldbody></mujoco>"), "read");
}

#[test]
fn a_truncated_file_says_where_it_ends() {
    let text = include_str!("../data/rich.xml");
    for end in [10, 100, 1000, 3000, text.len() - 5] {
        let message = soon(&text[..end]);
        assert!(message.starts_with("m.xml:"), "{message}");
    }
}

#[test]
fn attaching_small_parts_of_a_large_model_again_and_again_has_an_end() {
    let attaches = "<attach model='b' body='x' prefix='p'/>".repeat(50_000);
    let main =
        format!("<mujoco><asset><model name='b' file='b.xml'/></asset><worldbody>{attaches}</worldbody></mujoco>");
    let other = format!("<mujoco><worldbody>{}<body name='x'/></worldbody></mujoco>", "<body/>".repeat(50_000));
    let error = read_files(&[("a.xml", &main), ("b.xml", &other)]).unwrap_err().to_string();
    assert!(
        error.ends_with("<attach>: more than 4000000 visits of attached elements; raise the limit if this is meant"),
        "{error}"
    );
}

#[test]
fn classes_that_inherit_long_lists_count() {
    let user = "1 ".repeat(1_000_000);
    let classes: String =
        (0..100).map(|number| format!("<default class='c{number}'><geom size='1'/></default>")).collect();
    let text = format!("<mujoco><default><geom user='{user}'/>{classes}</default></mujoco>");
    assert!(soon(&text).contains("more than 268435456 bytes of names and lists"));
}

#[test]
fn long_names_make_neither_long_messages_nor_long_searches() {
    let long = "x".repeat(5_000_000);
    for text in [
        format!("<mujoco><{long}/></mujoco>"),
        format!("<mujoco><option {long}='1'/></mujoco>"),
        format!("<mujoco><option timestep='{long}'/></mujoco>"),
        format!("<mujoco><worldbody><geom name='{long}' type='{long}'/></worldbody></mujoco>"),
        format!("<mujoco><worldbody><geom class='{long}'/></worldbody></mujoco>"),
    ] {
        let message = soon(&text);
        assert!(message.len() < 2_000, "{}", message.len());
    }
}

#[test]
fn many_attributes_in_all_have_a_limit() {
    let attributes: String = (0..150).map(|number| format!(" a{number}=''")).collect();
    let text = format!("<mujoco>{}</mujoco>", format!("<x{attributes}/>").repeat(15_000));
    assert!(soon(&text).contains("more than 2000000 attributes"));
}
