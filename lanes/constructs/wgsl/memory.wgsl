// Variables of an invocation, arrays with an index of its own, pointers, structs, uniforms, and rows of buffers.
struct Inner {
    low: f32,
    high: vec2<f32>,
}

struct Item {
    inner: Inner,
    count: u32,
    table: array<u32, 3>,
}

struct Uniforms {
    scale: vec2<f32>,
    limits: array<vec4<u32>, 2>,
    turn: mat2x2<f32>,
}

@group(0) @binding(0) var<uniform> settings: Uniforms;
@group(0) @binding(1) var<storage, read> items: array<Item>;
@group(0) @binding(2) var<storage, read_write> copies: array<Item>;
@group(0) @binding(3) var<storage, read_write> made: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> nothing: array<f32>;
var<immediate> offset: u32;

const TABLE: array<u32, 4> = array<u32, 4>(3u, 1u, 4u, 1u);

var<private> stack: array<vec2<f32>, 6>;
var<private> words: array<u32, 5> = array<u32, 5>(9u, 8u, 7u, 6u, 5u);
var<private> top: u32;
var<private> other: u32 = 70u;

fn push(value: vec2<f32>) {
    stack[top] = value;
    top = min(top + 1u, 5u);
}

fn swap(a: ptr<private, u32>, b: ptr<private, u32>) {
    let before = *a;
    *a = *b;
    *b = before;
}

fn add_to(item: ptr<function, Item>, by: u32) {
    (*item).count += by;
    (*item).table[by % 3u] = by;
    (*item).inner.high.y += 1.0;
}

fn turned(v: vec2<f32>) -> Inner {
    if v.x < 0.0 {
        return Inner(v.y, -v.yx);
    }
    return Inner(v.x, v);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let number = id.x + offset;
    var item = items[number];
    add_to(&item, id.x + 1u);
    for (var i = 0u; i < item.count % 7u; i++) {
        push(vec2<f32>(f32(i), item.inner.low) * settings.scale);
    }
    stack[item.count % 4u].y = 50.0;
    top += words[item.count % 6u]; // beyond the end: the last
    swap(&top, &other);
    words[id.x % 3u] = TABLE[top % 4u];
    words[4] = words[1] + settings.limits[id.x % 2u][id.x % 4u] + settings.limits[1].z;
    var chosen = turned(vec2<f32>(item.inner.low, 2.0));
    let picked = stack[id.x % 5u];
    var whole = stack;
    whole[1] = vec2<f32>(nothing[3], settings.turn[1].x);
    if item.count > 4u {
        stack = whole;
        chosen = Inner(1.0, picked);
    }
    copies[id.x] = item;
    copies[id.x].inner = chosen;
    made[id.x] = vec4<f32>(f32(top + 100u * other), f32(words[id.x % 5u]), stack[1].y, picked[item.count % 2u]);
    made[id.x].z += chosen.high.x;
}
