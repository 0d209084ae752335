//! The procedural walker and the gait library, seen from outside.

mod picture;
