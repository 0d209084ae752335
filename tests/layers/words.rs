//! Words that a room must not know.

use super::rust_files;
use std::fs;
use std::path::Path;

/// Words by which a backend would show that it knows what it is used for.
fn words_of_users(source: &str) -> Vec<&'static str> {
    let words = ["feature = \"xr\"", "feature = \"view\"", "openxr", "headset", "window"];
    let lower = source.to_lowercase();
    words.into_iter().filter(|word| lower.contains(word)).collect()
}

#[test]
fn the_vulkan_backend_knows_neither_headset_nor_window() {
    let mut files = Vec::new();
    rust_files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src/gpu"), &mut files).unwrap();
    assert!(files.len() > 8, "{} files", files.len());
    for file in files {
        let found = words_of_users(&fs::read_to_string(&file).unwrap());
        assert!(found.is_empty(), "{}: {found:?}", file.display());
    }
    assert_eq!(words_of_users("#[cfg(feature = \"xr\")] // OpenXR"), ["feature = \"xr\"", "openxr"]);
}
