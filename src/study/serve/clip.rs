//! Clips: files that are sent whole or in part, as players ask.

use super::reply::keep_for_ever;
use axum::body::Body;
use axum::http::header::{ACCEPT_RANGES, CONTENT_RANGE, CONTENT_TYPE, HeaderValue, RANGE};
use axum::http::{HeaderMap, StatusCode};
use axum::response::Response;
use std::fs::File;
use std::io::{Read as _, Seek as _, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Most bytes of one reply; players ask for the rest.
const MOST: u64 = 8 << 20;

/// The reply to a request for a clip; none if it cannot be read.
pub(super) async fn reply(path: PathBuf, headers: &HeaderMap) -> Option<Response> {
    let asked = headers.get(RANGE).and_then(|value| value.to_str().ok()).map(str::to_owned);
    let read = tokio::task::spawn_blocking(move || read(&path, asked.as_deref()));
    let (range, length, bytes) = read.await.ok()??;
    let mut response = Response::new(Body::from(bytes));
    let headers = response.headers_mut();
    headers.insert(CONTENT_TYPE, HeaderValue::from_static("video/mp4"));
    headers.insert(ACCEPT_RANGES, HeaderValue::from_static("bytes"));
    keep_for_ever(headers);
    let Some(range) = range else { return Some(response) };
    let part = if range.is_empty() {
        *response.status_mut() = StatusCode::RANGE_NOT_SATISFIABLE;
        format!("bytes */{length}")
    } else {
        *response.status_mut() = StatusCode::PARTIAL_CONTENT;
        format!("bytes {}-{}/{length}", range.start, range.end - 1)
    };
    response.headers_mut().insert(CONTENT_RANGE, HeaderValue::from_str(&part).ok()?);
    Some(response)
}

/// The range that was asked for, empty if it cannot be had; the file's length; the bytes.
fn read(path: &Path, asked: Option<&str>) -> Option<(Option<Range<u64>>, u64, Vec<u8>)> {
    let mut file = File::open(path).ok()?;
    let length = file.metadata().ok()?.len();
    let range = asked.and_then(|asked| parse(asked, length));
    let wanted = range.clone().unwrap_or(0..length);
    let mut bytes = Vec::new();
    if !wanted.is_empty() {
        file.seek(SeekFrom::Start(wanted.start)).ok()?;
        file.take(wanted.end - wanted.start).read_to_end(&mut bytes).ok()?;
    }
    Some((range, length, bytes))
}

/// One range of bytes; none where the header is not that, and everything is sent.
fn parse(asked: &str, length: u64) -> Option<Range<u64>> {
    let (from, to) = asked.strip_prefix("bytes=")?.split_once('-')?;
    if from.is_empty() {
        let last: u64 = to.parse().ok()?;
        return Some(length.saturating_sub(last.min(MOST))..length);
    }
    let start: u64 = from.parse().ok()?;
    let end = if to.is_empty() { length } else { to.parse::<u64>().ok()?.saturating_add(1).min(length) };
    Some(start..end.min(start.saturating_add(MOST)).max(start))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn players_get_the_part_that_they_ask_for() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mp4");
        std::fs::write(&path, (0..100).collect::<Vec<u8>>()).unwrap();
        let part = |asked| read(&path, Some(asked)).unwrap();
        assert_eq!(part("bytes=10-12"), (Some(10..13), 100, vec![10, 11, 12]));
        assert_eq!(part("bytes=98-").2, [98, 99]);
        assert_eq!(part("bytes=-2").2, [98, 99]);
        assert_eq!(part("bytes=90-1000").0, Some(90..100));
        assert!(part("bytes=100-").0.unwrap().is_empty() && part("bytes=7-3").0.unwrap().is_empty());
        assert_eq!(part("bytes=1-2,5-6").0, None, "several ranges: everything");
        assert_eq!(read(&path, None).unwrap().2.len(), 100);
        assert!(read(&folder.path().join("none"), None).is_none());
    }
}
