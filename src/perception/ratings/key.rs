//! The table of the gait that each video shows: `video,gait`, one row per video, gaits quoted (RFC 4180).

use crate::file;
use crate::perception::Error;
use std::collections::HashMap;
use std::path::Path;

/// Longest table, bytes.
const MOST_BYTES: u64 = 16 << 20;
/// First line of the table.
#[doc(hidden)]
pub const KEY_HEAD: &str = "video,gait";

/// Reads the table at `path`: names of gaits by names of videos.
///
/// # Errors
/// [`Error::Read`] if it cannot be read, else as [`parse_key`].
#[doc(hidden)]
pub fn read_key(path: &Path) -> Result<HashMap<String, String>, Error> {
    let text =
        file::read_text(path, MOST_BYTES).map_err(|source| Error::Read { path: path.to_owned(), source })?;
    parse_key(&text, &path.display().to_string())
}

/// Reads the table from text; `origin` names it in errors.
///
/// # Errors
/// [`Error::Syntax`] with the line if the first one is not [`KEY_HEAD`], a row has no comma, or a video stands twice.
#[doc(hidden)]
pub fn parse_key(text: &str, origin: &str) -> Result<HashMap<String, String>, Error> {
    let syntax = |line, message| Error::Syntax { path: origin.to_owned(), line, message };
    let mut lines = (1..).zip(text.lines());
    if lines.next().is_none_or(|(_, head)| head.trim() != KEY_HEAD) {
        return Err(syntax(1, format!("the first line must be {KEY_HEAD}")));
    }
    let mut gaits = HashMap::new();
    for (line, row) in lines.filter(|(_, row)| !row.trim().is_empty()) {
        let (video, gait) = row
            .trim_end()
            .split_once(',')
            .ok_or_else(|| syntax(line, "no comma; a row is VIDEO,\"GAIT\"".to_owned()))?;
        let gait = gait.strip_prefix('"').and_then(|gait| gait.strip_suffix('"')).unwrap_or(gait);
        if gaits.insert(video.to_owned(), gait.replace("\"\"", "\"")).is_some() {
            return Err(syntax(line, format!("the video {video:?} stands in an earlier row, too")));
        }
    }
    Ok(gaits)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_read_and_what_is_none_is_refused_with_its_line() {
        let gaits = parse_key("video,gait\nclip-1,\"a \"\"b\"\", c\"\n\nclip-2,d\r\n", "k").unwrap();
        assert_eq!((gaits.len(), gaits["clip-1"].as_str(), gaits["clip-2"].as_str()), (2, "a \"b\", c", "d"));
        for (text, wanted) in [
            ("", "k:1: the first line must be video,gait"),
            ("video,gait\nclip-1\n", "k:2: no comma"),
            ("video,gait\na,b\na,c\n", "k:3: the video \"a\" stands in an earlier row"),
        ] {
            let message = parse_key(text, "k").unwrap_err().to_string();
            assert!(message.starts_with(wanted), "{message}");
        }
    }
}
