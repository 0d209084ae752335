//! A build without the feature `import` reads no gait libraries.

use crate::gait::Gait;

/// The gaits of a file; not in this build.
pub(super) fn gaits(_: &[u8]) -> Result<Vec<Gait>, String> {
    Err("this build reads no gait libraries: build it with the feature `import`".to_owned())
}
