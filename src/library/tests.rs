use super::*;

#[test]
fn scaling_covers_every_index_evenly() {
    assert_eq!(scaled(0, 3), 0);
    assert_eq!(scaled(u32::MAX, 3), 2);
    assert_eq!(scaled(u32::MAX, 0), 0);
    assert_eq!(scaled(1 << 31, 4), 2);
}
