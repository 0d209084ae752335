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

/// Words of our prose that say too little.
const VAGUE: [&str; 5] = ["whoever", "somebody", "those who", "anew", "is told"];

fn vague_words(text: &str) -> Vec<&'static str> {
    let plain: String =
        text.to_lowercase().chars().map(|c| if c.is_alphabetic() { c } else { ' ' }).collect();
    let words: Vec<&str> = plain.split_whitespace().collect();
    let is_in = |phrase: &&str| {
        let phrase: Vec<&str> = phrase.split(' ').collect();
        words.windows(phrase.len()).any(|window| window == phrase)
    };
    VAGUE.into_iter().filter(is_in).collect()
}

#[test]
fn prose_in_sources_is_plain() {
    let mut files = Vec::new();
    rust_files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut files).unwrap();
    for file in files {
        for (line, text) in fs::read_to_string(&file).unwrap().lines().enumerate() {
            let found = vague_words(text);
            assert!(found.is_empty(), "{}:{}: {found:?}", file.display(), line + 1);
        }
    }
    assert_eq!(
        vague_words("/// Whoever is TOLD, and those who_anew."),
        ["whoever", "those who", "anew", "is told"]
    );
}
