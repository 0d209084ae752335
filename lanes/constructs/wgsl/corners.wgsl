// What is rare: the ends of blocks and functions, variables that outlive a turn, choices between truth values.
@group(0) @binding(0) var<storage, read> given: array<u32>;
@group(0) @binding(1) var<storage, read_write> made: array<vec4<u32>>;

var<private> numbers: array<u32, 4> = array<u32, 4>(10u, 20u, 30u, 40u);

// Returns from within two loops.
fn first_square_above(value: u32) -> u32 {
    for (var root = 1u; root < 20u; root++) {
        loop {
            if root * root > value {
                return root;
            }
            break;
        }
    }
    return 0u;
}

// A return in a block of its own, with more behind it.
fn halved(value: u32) -> u32 {
    var rest = value;
    {
        if rest % 2u == 1u {
            return rest + 100u;
        }
        rest /= 2u;
    }
    {
        if rest > 40u {
            return 1u;
        }
    }
    rest += 1000u;
    return rest;
}

// `kept` is first written in a branch of a turn, then in the turn; who goes on before that keeps it.
fn carried(value: u32) -> u32 {
    var kept: u32;
    var sum = 0u;
    for (var turn = 0u; turn < 6u; turn++) {
        if (value >> turn) % 2u == 1u {
            kept = turn + 5u;
        }
        if (value + turn) % 3u == 0u {
            continue;
        }
        let before = kept;
        kept = before * 2u + 1u;
        sum += kept;
    }
    return sum;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let value = given[id.x];
    let is_small = select(value > 3u, value < 90u, value % 2u == 0u);
    let both = select(vec2<bool>(true, value > 8u), vec2<bool>(value < 9u, false), vec2<bool>(is_small, value > 20u));
    var all = 9u; // beyond the end, the same for all
    if value > 1000000u {
        all = 2u;
    }
    let zero = f32(value % 2u) * -0.0;
    let bits = u32(is_small) | u32(both.x) << 1u | u32(both.y) << 2u | u32(bool(zero)) << 3u | u32(bool(zero + f32(value))) << 4u;
    numbers[all] += value;
    made[id.x] = vec4<u32>(first_square_above(value), halved(value), carried(value), bits + numbers[all] * 32u + numbers[id.y]);
}
