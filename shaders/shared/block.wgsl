// Tiles of a side of a block. For a block the depth of all tiles is found, or of none.
const BLOCK: u32 = 8u;
