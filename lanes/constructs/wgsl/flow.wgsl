// Branches, loops, early ends of both, and switches.
@group(0) @binding(0) var<storage, read> given: array<u32>;
@group(0) @binding(1) var<storage, read_write> made: array<vec4<u32>>;

fn collatz(start: u32) -> u32 {
    var at = start;
    var turns = 0u;
    loop {
        if at <= 1u {
            return turns;
        }
        if turns > 40u {
            break;
        }
        if at % 2u == 0u {
            at /= 2u;
        } else {
            at = 3u * at + 1u;
        }
        turns++;
    }
    return 1000u + at;
}

// Counts pairs without those whose sum is divisible by three, until a pair is found that is too much.
fn pairs(most: u32) -> u32 {
    var count = 0u;
    for (var i = 0u; i < most; i++) {
        for (var j = i; j < 12u; j++) {
            if (i + j) % 3u == 0u {
                continue;
            }
            if i * j > most + 7u {
                return count + 100u * i;
            }
            if j > most {
                break;
            }
            count++;
        }
        let grows = count > 40u;
        if grows {
            continue;
        }
        count += 2u;
    }
    return count;
}

fn name(kind: u32) -> u32 {
    var found = 7u;
    switch kind {
        case 0u: {
            found = 1u;
        }
        case 1u, 2u: {
            if found > 3u {
                found = 20u;
                break;
            }
            found = 3u;
        }
        case 5u: {
            return 500u;
        }
        default: {
            found += kind;
        }
    }
    return found;
}

// A switch in a loop: a break leaves the switch, a continue the turn.
fn machine(program: u32) -> u32 {
    var rest = program;
    var sum = 0u;
    while rest != 0u {
        let code = rest & 3u;
        rest >>= 2u;
        switch code {
            case 0u: {
                continue;
            }
            case 1u: {
                sum += 1u;
            }
            case 2u: {
                if sum > 5u {
                    break;
                }
                sum *= 2u;
            }
            default: {
                sum += 10u;
            }
        }
        sum = sum ^ 1u;
    }
    return sum;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let value = given[id.x];
    let at = id.x;
    if value == 13u {
        made[at] = vec4<u32>(13u);
        return;
    }
    var last = 0u;
    {
        let twice = value * 2u;
        last = name(twice % 8u);
    }
    loop {
        last++;
        continuing {
            last += 2u;
            break if last > value;
        }
    }
    made[at] = vec4<u32>(collatz(value), pairs(value % 12u), name(value % 7u) + 10000u * last, machine(value));
}
