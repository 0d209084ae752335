//! Files that hold no text, known by their first bytes and named with the way to a file that is read.

/// What a binary file is, and how to get at its people.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Known {
    /// What it is.
    pub(super) name: &'static str,
    /// The way out.
    pub(super) hint: &'static str,
}

/// First bytes of an SQLite database.
pub(super) const SQLITE: &[u8] = b"SQLite format 3\0";
/// First bytes of Parquet.
pub(super) const PARQUET: &[u8] = b"PAR1";

const TO_CSV: &str = "in Python with PedPy: t = pedpy.load_trajectory_from_ped_data_archive_hdf5(trajectory_file=pathlib.Path(\"FILE\")); \
     t.data[[\"id\", \"frame\", \"x\", \"y\"]].to_csv(\"crowd.csv\", index=False); print(t.frame_rate); then replay crowd.csv with --fps";
const UNPICKLE: &str = "in Python: t = pandas.read_pickle(\"FILE\"), only if you trust where it is from; then write the columns id, \
     frame, x, y with to_csv(\"crowd.csv\", index=False) and replay crowd.csv with --fps";

const SIGNATURES: [(&[u8], &str, &str); 12] = [
    (b"\x89HDF\r\n\x1a\n", "HDF5, as PedPy and the Pedestrian Dynamics Data Archive write it", TO_CSV),
    (b"\x1f\x8b", "compressed with gzip", "decompress it first: gunzip -k FILE"),
    (b"BZh", "compressed with bzip2", "decompress it first: bunzip2 -k FILE"),
    (b"\xfd7zXZ\0", "compressed with xz", "decompress it first: unxz -k FILE"),
    (b"\x28\xb5\x2f\xfd", "compressed with zstd", "decompress it first: unzstd FILE"),
    (
        b"PK\x03\x04",
        "a zip archive (npz and xlsx are such, too)",
        "unpack it first: unzip FILE; export tables as .csv",
    ),
    (b"7z\xbc\xaf\x27\x1c", "a 7z archive", "unpack it first: 7z x FILE"),
    (
        b"\x93NUMPY",
        "a NumPy array",
        "in Python: numpy.savetxt(\"crowd.txt\", numpy.load(\"FILE\")); then replay crowd.txt with --columns",
    ),
    (
        b"MATLAB 5.0",
        "a MATLAB file",
        "in Python: scipy.io.loadmat(\"FILE\") holds its arrays; write one with numpy.savetxt",
    ),
    (b"\xff\xfe", "text in UTF-16", "save it as UTF-8: iconv -f UTF-16 -t UTF-8 FILE > crowd.csv"),
    (b"\xfe\xff", "text in UTF-16", "save it as UTF-8: iconv -f UTF-16 -t UTF-8 FILE > crowd.csv"),
    (b"\x89PNG", "a picture", "a recording has the places of people"),
];

/// What a file is that begins with these bytes, if it is none of ours.
pub(super) fn of(head: &[u8]) -> Option<Known> {
    let known = SIGNATURES.iter().find(|(first, ..)| head.starts_with(first));
    if let Some((_, name, hint)) = known {
        return Some(Known { name, hint });
    }
    // Protocols 2 to 5 begin with their number, and a frame, a tuple, a dictionary or a name follows.
    if let [0x80, 2..=5, next, ..] = head
        && matches!(next, 0x95 | b'}' | b']' | b'c' | b'(' | b'K' | b'X' | 0x8c)
    {
        return Some(Known { name: "a Python pickle, as pandas and PedPy write it", hint: UNPICKLE });
    }
    let text = std::str::from_utf8(head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head));
    let start =
        text.or_else(|error| std::str::from_utf8(&head[..error.valid_up_to()])).unwrap_or("").trim_start();
    if start.starts_with('{') && start.contains("\"track\"") | start.contains("\"scene\"") {
        let hint = "its rows as columns: jq -r 'select(.track).track | [.f, .p, .x, .y] | @csv' FILE > crowd.csv; then --columns \
                    frame,id,x,y";
        return Some(Known { name: "TrajNet++ (a JSON object a line)", hint });
    }
    if start.starts_with('{') || start.starts_with('[') {
        let hint = "write its people as columns id, frame (or time), x, y; Pathfinder writes .csv, too";
        return Some(Known { name: "JSON", hint });
    }
    if start.starts_with('<') {
        let hint = "write its people as columns id, frame (or time), x, y, for instance with PedPy or pandas.read_xml";
        return Some(Known { name: "XML", hint });
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_others_are_known_by_their_first_bytes_and_texts_are_not() {
        let name = |head: &[u8]| of(head).map_or("", |known| known.name);
        assert!(name(b"\x89HDF\r\n\x1a\n\0\0").contains("HDF5"));
        assert!(name(b"\x1f\x8b\x08\0").contains("gzip"));
        assert!(name(b"\x80\x05\x95\x10").contains("pickle"));
        assert!(name(b"\x80\x02}q\0").contains("pickle"));
        assert!(name(b"{\"scene\": {\"id\": 1}}\n{\"track\"").contains("TrajNet++"));
        assert!(name(b"\xef\xbb\xbf{\"1\": {\"0.0\"").contains("JSON"));
        assert!(name(b"  <?xml version").contains("XML"));
        for text in
            ["1 0 2 3\n", "# framerate: 25\n", "ID,Frame,x,y\n", "", "\u{feff}id;frame;x;y", "-1 2 3 4"]
        {
            assert_eq!(of(text.as_bytes()), None, "{text:?}");
        }
    }
}
