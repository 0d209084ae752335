// Sums over a workgroup. Every invocation of the workgroup must call these, since they wait for one another.
const LANES: u32 = 128u; // invocations of a workgroup that sums: the most that every Vulkan device has
const ROW: u32 = 8u;     // lanes whose values one lane adds up
const ROWS: u32 = 16u;

var<workgroup> scan_values: array<u32, 128>; // [lane]
var<workgroup> scan_rows: array<u32, 16>;    // [row]

struct Sums {
    before: u32, // of the lanes before this one
    total: u32,
}

// Sums of one value a lane. Two levels need three barriers; a tree over the lanes needs seven.
fn scan(lane: u32, value: u32) -> Sums {
    workgroupBarrier(); // the sums before have been read
    scan_values[lane] = value;
    workgroupBarrier();
    if lane < ROWS {
        var sum = 0u;
        for (var i = 0u; i < ROW; i++) {
            sum += scan_values[lane * ROW + i];
        }
        scan_rows[lane] = sum;
    }
    workgroupBarrier();
    let own = lane / ROW;
    var before = 0u;
    var total = 0u;
    for (var row = 0u; row < ROWS; row++) {
        before += select(0u, scan_rows[row], row < own);
        total += scan_rows[row];
    }
    for (var i = own * ROW; i < lane; i++) {
        before += scan_values[i];
    }
    return Sums(before, total);
}
