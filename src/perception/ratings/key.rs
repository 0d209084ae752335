//! The table of the gait that each video shows: `video,gait`, one row per video, gaits quoted (RFC 4180).

use crate::file;
use crate::perception::Error;
use crate::table::{Records, Unclosed};
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
/// [`Error::Syntax`] with the line if the first one is not [`KEY_HEAD`], a row has not two cells, a quote is never closed, or a
/// video stands twice.
#[doc(hidden)]
pub fn parse_key(text: &str, origin: &str) -> Result<HashMap<String, String>, Error> {
    let syntax = |line, message| Error::Syntax { path: origin.to_owned(), line, message };
    let unclosed = |quote: Unclosed| syntax(quote.line, quote.to_string());
    let mut records = Records::with_header(text);
    let head = records.next().transpose().map_err(unclosed)?;
    if head.is_none_or(|head| head.cells.join(",") != KEY_HEAD) {
        return Err(syntax(1, format!("the first line must be {KEY_HEAD}")));
    }
    let mut gaits = HashMap::new();
    for record in records {
        let record = record.map_err(unclosed)?;
        let [video, gait] = &record.cells[..] else {
            let count = record.cells.len();
            return Err(syntax(record.line, format!("{count} cells; a row is VIDEO,\"GAIT\"")));
        };
        if gaits.insert(video.to_string(), gait.to_string()).is_some() {
            let message = format!("the video {video:?} stands in an earlier row, too");
            return Err(syntax(record.line, message));
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
        let saved = parse_key("\u{feff}video;gait\r\nclip-1;\"a\r\nb; c\"\r\n", "k").unwrap();
        assert_eq!(saved["clip-1"], "a\r\nb; c", "as a spreadsheet saves it");
        for (text, wanted) in [
            ("", "k:1: the first line must be video,gait"),
            ("video,gait\nclip-1\n", "k:2: 1 cells; a row is VIDEO,\"GAIT\""),
            ("video,gait\nclip-1,a, b\n", "k:2: 3 cells"),
            ("video,gait\nclip-1,a\nclip-2,\"b\n", "k:3: a quote is opened and never closed"),
            ("video,gait\na,b\na,c\n", "k:3: the video \"a\" stands in an earlier row"),
        ] {
            let message = parse_key(text, "k").unwrap_err().to_string();
            assert!(message.starts_with(wanted), "{message}");
        }
    }
}
