//! Files of the pages, part of the program: compressed once, at addresses that change with their bytes.

use super::Error;
use super::reply::{self, Packed};
use axum::response::Response;
use sha2::{Digest as _, Sha256};

/// Name, type and bytes of every file.
const FILES: [(&str, &str, &[u8]); 6] = [
    ("web.css", "text/css; charset=utf-8", include_bytes!("../../../assets/web/web.css")),
    ("icon.svg", "image/svg+xml", include_bytes!("../../../assets/web/icon.svg")),
    ("page.mjs", JAVASCRIPT, include_bytes!("../../../assets/web/page.mjs")),
    ("queue.mjs", JAVASCRIPT, include_bytes!("../../../assets/web/queue.mjs")),
    ("walk.mjs", JAVASCRIPT, include_bytes!("../../../assets/web/walk.mjs")),
    ("admin.mjs", JAVASCRIPT, include_bytes!("../../../assets/web/admin.mjs")),
];
const JAVASCRIPT: &str = "text/javascript; charset=utf-8";
/// Hexadecimal digits of the hash in addresses.
const DIGITS: usize = 16;

/// The files, ready to be sent.
#[derive(Debug)]
pub(super) struct Assets {
    hash: String,
    files: Vec<(&'static str, Packed)>,
}

impl Assets {
    /// Compresses the files.
    ///
    /// # Errors
    /// [`Error::Compress`].
    pub(super) fn new() -> Result<Self, Error> {
        let mut hash = Sha256::new();
        let mut files = Vec::new();
        for (name, kind, bytes) in FILES {
            hash.update(bytes);
            files.push((name, Packed::new(kind, bytes.to_vec())?));
        }
        let mut hash = reply::hex(&hash.finalize());
        hash.truncate(DIGITS);
        Ok(Self { hash, files })
    }

    /// The address of a file.
    pub(super) fn href(&self, name: &str) -> String {
        format!("/static/{}/{name}", self.hash)
    }

    /// A file; none at an address of other bytes.
    pub(super) fn find(&self, hash: &str, name: &str, takes_gzip: bool) -> Option<Response> {
        let (_, packed) = self.files.iter().find(|(own, _)| *own == name).filter(|_| hash == self.hash)?;
        Some(packed.reply(takes_gzip))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modules_are_short_few_and_name_no_other_host() {
        let modules: Vec<&str> = FILES
            .iter()
            .filter(|(name, ..)| name.ends_with(".mjs"))
            .map(|(.., bytes)| std::str::from_utf8(bytes).unwrap())
            .collect();
        assert_eq!(modules.len(), 4);
        let lines: usize = modules.iter().map(|text| text.lines().count()).sum();
        assert!(lines <= 600, "{lines} lines");
        for (name, _, bytes) in FILES {
            let text = std::str::from_utf8(bytes).unwrap().replace("http://www.w3.org/2000/svg", "");
            assert!(!text.contains("//www") && !text.contains("http"), "{name} names another host");
        }
    }

    #[test]
    fn a_page_with_its_files_is_light() {
        let assets = Assets::new().unwrap();
        let sent: usize = assets.files.iter().map(|(_, packed)| packed.gzipped.len()).sum();
        assert!(sent < 20_000, "{sent} bytes");
        assert!(assets.find(&assets.hash, "page.mjs", true).is_some());
        assert!(
            assets.find("0", "page.mjs", true).is_none() && assets.find(&assets.hash, "x", true).is_none()
        );
    }
}
