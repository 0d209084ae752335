// Atomic operations, and lists that invocations join.
@group(0) @binding(0) var<storage, read> given: array<i32>;
@group(0) @binding(1) var<storage, read_write> sums: array<atomic<u32>>;
@group(0) @binding(2) var<storage, read_write> extremes: array<atomic<i32>>;
@group(0) @binding(3) var<storage, read_write> list: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let value = given[id.x];
    let bits = bitcast<u32>(value);
    atomicAdd(&sums[0], bits);
    atomicSub(&sums[1], bits);
    atomicOr(&sums[2], bits);
    atomicXor(&sums[3], bits);
    atomicAnd(&sums[4], bits | 0xffff0000u);
    atomicMin(&sums[5], bits);
    atomicMax(&sums[6], bits);
    atomicMin(&extremes[0], value);
    atomicMax(&extremes[1], value);
    if value > 0 {
        let place = atomicAdd(&sums[7], 1u);
        list[place] = id.x;
        atomicStore(&sums[8u + id.x % 2u], 1u);
        atomicExchange(&extremes[2], 5);
    }
    let seen = atomicLoad(&sums[7]);
    if seen > 1000u {
        list[0] = seen;
    }
}
