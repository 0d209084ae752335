// Loops whose counter all lanes have alike, and loops that look so: arrays read and written by them, inside and behind.
@group(0) @binding(0) var<storage, read> given: array<u32>;
@group(0) @binding(1) var<storage, read_write> made: array<array<u32, 8>>;
var<immediate> first: u32;

var<private> rows: array<vec2<u32>, 6>;
var<private> words: array<u32, 5>;

struct Pair {
    low: u32,
    high: u32,
}

// `base` is the same for all who call it so.
fn sum_of(base: u32, count: u32, start: u32) -> u32 {
    var sum = 0u;
    for (var i = start; i < count; i++) {
        sum = sum * 3u + rows[base + i].x;
    }
    return sum;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let own = given[id.x];
    var pairs: array<Pair, 3>;
    // lanes leave after different turns; the counter is read behind the loop, and beyond the end of the array
    var number = 0u;
    for (; number < own % 9u; number++) {
        if number == own % 5u + 2u {
            break;
        }
        if number % 2u == own % 2u {
            continue;
        }
        rows[number] = vec2<u32>(number * 10u + own % 4u, own);
        words[number] += rows[number].y + given[number];
    }
    made[id.x][0] = number;
    // begun again in every turn of another, and at another place than 0
    var nested = 0u;
    for (var i = first; i < first + 3u; i++) {
        for (var j = i; j < i + own % 4u; j += 2u) {
            nested = nested * 7u + rows[j].x + words[i];
            pairs[i % 3u].low += j;
            rows[j].y = nested;
        }
        pairs[i - first].high = nested;
    }
    made[id.x][1] = nested;
    // no counters: one begins where each lane says, one goes as far, one is changed in between
    var total = 0u;
    for (var i = own % 3u; i < 5u; i++) {
        total += rows[i].x * (i + 1u);
    }
    for (var i = 0u; i < 5u; i += own % 2u + 1u) {
        total = total * 5u + words[i];
    }
    for (var i = 0u; i < 5u; i++) {
        if words[i] % 2u == 1u {
            i++;
        }
        total = total * 5u + words[i];
    }
    made[id.x][2] = total;
    // written before and not begun again: it goes on from where each lane left it
    var onward = 0u;
    for (var turn = 0u; turn < 2u; turn++) {
        for (; onward < own % 6u; onward++) {
            if words[onward] % 3u == 2u {
                onward++;
                break;
            }
            total += words[onward] * (turn + 1u);
        }
        total = total * 2u + onward;
    }
    // the same, written nowhere else
    var again = 0u;
    for (var turn = 0u; turn < 3u; turn++) {
        for (; again < own % 7u; again++) {
            if (words[again] + own + again) % 3u == turn {
                break;
            }
            total += words[again] * 3u;
        }
        total = total * 2u + again;
    }
    made[id.x][3] = total;
    made[id.x][4] = sum_of(0u, own % 5u, 0u);
    made[id.x][5] = sum_of(own % 3u, 3u, own % 2u);
    made[id.x][6] = sum_of(first, 4u, 1u);
    var all = 0u;
    for (var i = 0u; i < 3u; i++) {
        all = all * 11u + pairs[i].low + 3u * pairs[i].high;
    }
    made[id.x][7] = all;
}
