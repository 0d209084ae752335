//! What lanes cannot do is refused by name, with the function in which it stands.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test")]

use naga::valid::{Capabilities, ValidationFlags, Validator};
use wgsl_lanes::Isa;
use wgsl_lanes::generate::{Kernel, Options, Unsupported, Written, kernels};

/// The only entry point, and the text.
fn first(text: &str, capabilities: Capabilities) -> (Result<Kernel, Unsupported>, String) {
    let module =
        naga::front::wgsl::parse_str(text).unwrap_or_else(|error| panic!("{}", error.emit_to_string(text)));
    let info = Validator::new(ValidationFlags::all(), capabilities).validate(&module).unwrap();
    let Written { text, mut kernels } = kernels(&module, &info, Isa::Portable, Options::default());
    (kernels.remove(0), text)
}

/// Why a shader whose entry point has this body is refused.
fn refusal(globals: &str, body: &str) -> String {
    let text = format!(
        "@group(0) @binding(0) var<storage, read_write> data: array<u32>;\n{globals}\n\
         @compute @workgroup_size(64)\nfn main(@builtin(global_invocation_id) id: vec3<u32>) {{\n{body}\n}}\n"
    );
    match first(&text, Capabilities::IMMEDIATES) {
        (Err(error), _) => error.to_string(),
        (Ok(_), text) => panic!("this was written:\n{text}"),
    }
}

#[test]
fn what_lanes_cannot_do_is_refused_by_name() {
    let shared = "var<workgroup> sums: array<u32, 64>;";
    let cases = [
        (shared, "sums[0] = 1u; data[0] = sums[0];", "main: a variable of WorkGroup cannot be done by lanes"),
        ("", "storageBarrier(); data[id.x] = 1u;", "main: a barrier cannot be done by lanes"),
        (
            "",
            "data[id.x] = u32(exp(f32(id.x)));",
            "main: Exp, which no two machines compute alike, cannot be done by lanes",
        ),
        (
            "fn deep(x: f32) -> f32 { return sin(x); }",
            "data[id.x] = u32(deep(f32(id.x)));",
            "deep: Sin, which no two machines compute alike, cannot be done by lanes",
        ),
        (
            "struct S { a: u32 }\nvar<private> all: array<S, 4>;",
            "data[id.x] = all[id.x % 4u].a;",
            "main: an index that differs by lane into an array of structs or arrays cannot be done by lanes",
        ),
        (
            "var<private> m: mat2x2<f32>;",
            "data[id.x] = u32((m * vec2<f32>(1.0, 2.0)).x);",
            "main: arithmetic with a matrix cannot be done by lanes",
        ),
        (
            "@group(0) @binding(1) var picture: texture_2d<f32>;",
            "data[id.x] = u32(textureLoad(picture, vec2<u32>(0u), 0u).x);",
            "main: a variable of Handle cannot be done by lanes",
        ),
    ];
    for (globals, body, message) in cases {
        assert_eq!(refusal(globals, body), message);
    }
}

#[test]
fn other_inputs_than_the_number_of_the_invocation_are_refused() {
    let text = "@group(0) @binding(0) var<storage, read_write> data: array<u32>;\n\
                @compute @workgroup_size(64) fn main(@builtin(local_invocation_index) lane: u32) { data[lane] = 1u; }";
    let error = first(text, Capabilities::empty()).0.unwrap_err().to_string();
    assert_eq!(error, "main: another input than one global_invocation_id cannot be done by lanes");
}

#[test]
fn what_is_refused_leaves_the_others_as_they_are() {
    let text = "@group(0) @binding(0) var<storage, read_write> data: array<u32>;\n\
                var<workgroup> sums: array<u32, 64>;\n\
                fn twice(x: u32) -> u32 { return 2u * x; }\n\
                fn deep(x: u32) -> u32 { return twice(u32(sin(f32(x)))); }\n\
                @compute @workgroup_size(64) fn refused(@builtin(global_invocation_id) id: vec3<u32>) { data[id.x] = deep(id.x); }\n\
                @compute @workgroup_size(64) fn shares(@builtin(global_invocation_id) id: vec3<u32>) { sums[0] = 1u; data[id.x] = sums[0]; }\n\
                @compute @workgroup_size(64) fn written(@builtin(global_invocation_id) id: vec3<u32>) { data[id.x] = twice(id.x); }";
    let module = naga::front::wgsl::parse_str(text).unwrap();
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module).unwrap();
    let Written { text, kernels } = kernels(&module, &info, Isa::Portable, Options::default());
    let names: Vec<String> = kernels
        .iter()
        .map(|kernel| kernel.as_ref().map_or_else(|e| e.function.clone(), |k| k.name.clone()))
        .collect();
    assert_eq!(names, ["deep", "shares", "written"]);
    assert_eq!(kernels.iter().filter(|kernel| kernel.is_ok()).count(), 1);
    assert_eq!(text.matches("fn f_twice(").count(), 1);
    assert!(!text.contains("f_deep") && !text.contains("run_refused"), "{text}");
}
