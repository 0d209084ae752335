// Conditions that are the same in all lanes, a function of two entry points, and elements that lie one behind the other.
@group(0) @binding(0) var<storage, read> given: array<u32>;
@group(0) @binding(1) var<storage, read_write> made: array<u32>;
@group(0) @binding(2) var<storage, read_write> sums: array<u32>;
@group(0) @binding(3) var<storage, read> pairs: array<vec2<u32>>;
var<immediate> flags: u32;

fn fold(value: u32, most: u32) -> u32 {
    var sum = value;
    for (var i = 0u; i < 8u; i++) {
        if (flags & 1u) != 0u {
            if i == 3u {
                continue;
            }
            sum = sum * 3u + i;
        }
        if bitcast<i32>(flags) < 0 && value > 5u {
            return sum + 100u;
        }
        if !(flags > 6u) {
            sum ^= 5u;
        } else {
            sum += value % (i + 1u);
            if i >= 4u && flags != 9u {
                break;
            }
        }
        if i == most {
            return sum + 1000u;
        }
        if f32(flags & 7u) >= 4.0 {
            sum += 7u;
        } else if i <= 2u {
            sum += value & 1u;
        }
    }
    return sum;
}

@compute @workgroup_size(64)
fn alike(@builtin(global_invocation_id) id: vec3<u32>) {
    made[id.x] = fold(given[id.x], 6u);
}

@compute @workgroup_size(64)
fn alike_to_most(@builtin(global_invocation_id) id: vec3<u32>) {
    sums[id.x] = fold(given[id.x], flags % 9u);
}

@compute @workgroup_size(64)
fn side_by_side(@builtin(global_invocation_id) id: vec3<u32>) {
    let at = given[id.x] % arrayLength(&pairs);
    let next = at + 1u;
    let first = pairs[at];
    let second = pairs[next];
    let low = given[at];
    let apart = given[id.x + 1u];
    let high = given[at + 1u];
    sums[id.x] = first.x * 3u + first.y * 5u + second.x * 7u + second.y * 11u + low * 13u + high * 17u + apart * 19u;
}
