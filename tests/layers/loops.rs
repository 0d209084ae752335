//! No invocation works alone: a software device forgives a dispatch of one, and a loop over a crowd, and a GPU does not.

use std::fs;
use std::path::Path;

/// Words for as many things as there are people, cells, or groups of them.
const CROWDS: [&str; 6] =
    ["agent_count", "cell_count", "visible_capacity", "groups", "group_count", "run_count"];

/// Loops of a shader over a crowd, but for those in which a whole workgroup goes on together.
fn loops_over_crowds(shader: &str) -> Vec<&str> {
    let heads = shader
        .lines()
        .map(str::trim)
        .filter(|line| ["for (", "while ", "loop "].iter().any(|word| line.starts_with(word)));
    let words = |line: &str| -> Vec<String> {
        line.split(|c: char| !(c.is_alphanumeric() || c == '_')).map(str::to_owned).collect()
    };
    heads
        .filter(|line| words(line).iter().any(|word| CROWDS.contains(&word.as_str())))
        .filter(|line| !line.contains("+= LANES)"))
        .collect()
}

/// Dispatches of one invocation.
fn lone(source: &str) -> Vec<&str> {
    let is_lone = |line: &&str| {
        line.split_once("Dispatch::of(").is_some_and(|(_, rest)| rest.contains(", 1)"))
            || line.contains("Invocations(1)")
    };
    source.lines().filter(is_lone).collect()
}

#[test]
fn no_kernel_loops_over_a_crowd_and_none_is_dispatched_alone() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut read = 0;
    for folder in ["shaders", "shaders/shared"] {
        for entry in fs::read_dir(root.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|extension| extension == "wgsl") {
                let text = fs::read_to_string(&path).unwrap();
                assert_eq!(loops_over_crowds(&text), Vec::<&str>::new(), "{}", path.display());
                read += 1;
            }
        }
    }
    assert!(read > 60, "{read} shaders");
    let order = fs::read_to_string(root.join("src/sim/order.rs")).unwrap();
    assert_eq!(lone(&order), Vec::<&str>::new());

    let planted = [
        "for (var run = 0u; run < run_count(); run++) {",
        "while agent < frame.agent_count {",
        "for (var first = 0u; first < groups; first += 1u) {",
    ];
    for line in planted {
        assert_eq!(loops_over_crowds(line), [line]);
    }
    assert!(loops_over_crowds("for (var first = 0u; first < groups; first += LANES) {").is_empty());
    let planted = "(true, Dispatch::of(Phase::GridScan, 1)),";
    assert_eq!(lone(planted), [planted]);
}
