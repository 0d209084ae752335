//! What a glTF file keeps outside its JSON: buffers and images, in the GLB, in a `data:` URI or in a file beside it.

use super::accessor::Buffer;
use super::paint::Texture;
use std::io::Cursor;
use std::path::Path;
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// Most texels along a side of an image, and most bytes of one: a small file can claim to be very large.
const MOST_TEXELS: usize = 16_384;
const MOST_BYTES: usize = 1 << 28;

/// Reads the buffers of a document; `base` is the folder of its file.
///
/// # Errors
/// A buffer that is not there, leaves the folder, or is shorter than the document says.
pub(super) fn buffers(gltf: &gltf::Gltf, base: Option<&Path>) -> Result<Vec<Buffer>, String> {
    let mut blob = gltf.blob.clone();
    let mut buffers = Vec::new();
    for buffer in gltf.buffers() {
        let of_buffer = |what: String| format!("buffer {} {what}", buffer.index());
        let bytes = match buffer.source() {
            gltf::buffer::Source::Bin => blob.take().ok_or("is not in the file".to_owned()),
            gltf::buffer::Source::Uri(uri) => named(uri, base),
        };
        let bytes = bytes.map_err(of_buffer)?;
        if bytes.len() < buffer.length() {
            let (wanted, found) = (buffer.length(), bytes.len());
            return Err(of_buffer(format!("should have {wanted} bytes, it has {found}")));
        }
        buffers.push(bytes);
    }
    Ok(buffers)
}

/// Reads an image of a document: PNG or JPEG, whatever the document calls it.
///
/// # Errors
/// An image that is not there, leaves the folder, or cannot be decoded.
pub(super) fn texture(
    image: &gltf::Image<'_>,
    base: Option<&Path>,
    buffers: &[Buffer],
) -> Result<Texture, String> {
    match image.source() {
        gltf::image::Source::Uri { uri, .. } => decoded(&named(uri, base)?),
        gltf::image::Source::View { view, .. } => {
            let end = view.offset().checked_add(view.length());
            let bytes = buffers.get(view.buffer().index()).zip(end);
            let bytes = bytes.and_then(|(bytes, end)| bytes.get(view.offset()..end));
            decoded(bytes.ok_or("lies outside its buffer")?)
        }
    }
}

/// What a URI names. It may not leave the folder of the file, nor go to the network.
fn named(uri: &str, base: Option<&Path>) -> Result<Vec<u8>, String> {
    let lower = uri.to_ascii_lowercase();
    if lower.starts_with("data:") {
        let url = data_url::DataUrl::process(uri)
            .map_err(|error| format!("has a data: URI that cannot be read ({error})"))?;
        let (bytes, _) =
            url.decode_to_vec().map_err(|error| format!("has a data: URI that is no base64 ({error})"))?;
        return Ok(bytes);
    }
    let leaves = ["..", "%2e", "%2f", "%5c", ":", "\\"].iter().any(|part| lower.contains(part));
    if leaves || lower.starts_with('/') {
        return Err(format!(
            "has the URI {uri:?}, which leaves the folder of the file; put the data beside it or into it"
        ));
    }
    let name = urlencoding::decode(uri).map_err(|error| format!("has the URI {uri:?}: {error}"))?;
    let base = base.ok_or_else(|| format!("needs the file {name:?}, which was not given"))?;
    std::fs::read(base.join(&*name)).map_err(|error| format!("cannot be read from {name:?}: {error}"))
}

fn decoded(bytes: &[u8]) -> Result<Texture, String> {
    let texture = if bytes.starts_with(b"\x89PNG") {
        png(bytes).map_err(|error| format!("cannot be decoded as PNG: {error}"))
    } else if bytes.starts_with(&[0xff, 0xd8]) {
        jpeg(bytes).map_err(|error| format!("cannot be decoded as JPEG: {error}"))
    } else {
        return Err("is neither PNG nor JPEG".to_owned());
    }?;
    let [width, height] = [texture.width, texture.height];
    if width == 0 || height == 0 {
        return Err(format!("is {width} x {height} texels"));
    }
    Ok(texture)
}

/// The bytes of an image of this size, if it is one that is read.
fn bytes_of(width: usize, height: usize, channels: usize) -> Result<usize, String> {
    let bytes = width.saturating_mul(height).saturating_mul(channels);
    if width.max(height) > MOST_TEXELS || bytes > MOST_BYTES {
        return Err(format!(
            "{width} x {height} texels, at most {MOST_TEXELS} along a side and {} MiB are read; make it smaller",
            MOST_BYTES >> 20
        ));
    }
    Ok(bytes)
}

/// Palettes become colours; of 16 bits the upper 8 are kept.
fn png(bytes: &[u8]) -> Result<Texture, String> {
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().map_err(|error| error.to_string())?;
    let (width, height) = (reader.info().width, reader.info().height);
    let channels = reader.output_color_type().0.samples();
    let mut pixels = vec![0; bytes_of(width as usize, height as usize, channels)?];
    reader.next_frame(&mut pixels).map_err(|error| error.to_string())?;
    Ok(Texture { width, height, channels, pixels })
}

fn jpeg(bytes: &[u8]) -> Result<Texture, String> {
    let options = DecoderOptions::default()
        .set_max_width(MOST_TEXELS)
        .set_max_height(MOST_TEXELS)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(Cursor::new(bytes), options);
    decoder.decode_headers().map_err(|error| error.to_string())?;
    let (width, height) = decoder.dimensions().ok_or("no size")?;
    bytes_of(width, height, 3)?;
    let pixels = decoder.decode().map_err(|error| error.to_string())?;
    #[allow(clippy::cast_possible_truncation, reason = "at most MOST_TEXELS")]
    let (width, height) = (width as u32, height as u32);
    Ok(Texture { width, height, channels: 3, pixels })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A PNG of one row: of two texels, or of a byte each where there are many.
    fn png_of(color: png::ColorType, depth: png::BitDepth, palette: Option<&[u8]>, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let width = if data.len() > 100 { u32::try_from(data.len()).unwrap() } else { 2 };
        let mut encoder = png::Encoder::new(&mut bytes, width, 1);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if let Some(palette) = palette {
            encoder.set_palette(palette);
        }
        encoder.write_header().unwrap().write_image_data(data).unwrap();
        bytes
    }

    /// A grey JPEG of 8 x 8 texels: one coefficient, and codes of one bit.
    fn jpeg_of(grey: u8) -> Vec<u8> {
        assert!((192..=255).contains(&grey), "coefficients of seven bits");
        let mut bytes = vec![0xff, 0xd8, 0xff, 0xdb, 0, 67, 0];
        bytes.extend([8; 64]);
        bytes.extend([0xff, 0xc0, 0, 11, 8, 0, 8, 0, 8, 1, 1, 0x11, 0]);
        for (table, symbol) in [(0, 7), (0x10, 0)] {
            bytes.extend([0xff, 0xc4, 0, 20, table, 1]);
            bytes.extend([0; 15]);
            bytes.push(symbol);
        }
        bytes.extend([0xff, 0xda, 0, 8, 1, 1, 0, 0, 63, 0, grey - 128, 0x7f, 0xff, 0xd9]);
        bytes
    }

    #[test]
    fn images_are_read_whatever_their_bits_are() {
        use png::BitDepth::{Eight, One, Sixteen};
        use png::ColorType::{Grayscale, Indexed, Rgb, Rgba};
        let of = |bytes: &[u8]| {
            let Texture { width, height, channels, pixels } = decoded(bytes).unwrap();
            (width, height, channels, pixels)
        };
        let clear = [1, 2, 3, 4, 5, 6, 7, 8];
        assert_eq!(of(&png_of(Rgba, Eight, None, &clear)), (2, 1, 4, clear.to_vec()));
        let upper = [9, 8, 7, 6, 5, 4];
        let words: Vec<u8> = upper.iter().flat_map(|&byte| [byte, 77]).collect();
        assert_eq!(of(&png_of(Rgb, Sixteen, None, &words)), (2, 1, 3, upper.to_vec()));
        let palette = png_of(Indexed, One, Some(&upper), &[0b0100_0000]);
        assert_eq!(of(&palette), (2, 1, 3, upper.to_vec()));
        assert_eq!(of(&png_of(Grayscale, One, None, &[0b0100_0000])), (2, 1, 1, vec![0, 255]));
        assert_eq!(of(&jpeg_of(200)), (8, 8, 3, vec![200; 8 * 8 * 3]));
    }

    #[test]
    fn images_that_are_none_say_why() {
        let message = |bytes: &[u8]| decoded(bytes).err().unwrap();
        assert!(message(b"GIF89a").contains("neither PNG nor JPEG"));
        let png = png_of(png::ColorType::Rgb, png::BitDepth::Eight, None, &[0; 6]);
        assert!(message(&png[..40]).contains("as PNG"), "{}", message(&png[..40]));
        let row = vec![0; MOST_TEXELS + 1];
        let wide = png_of(png::ColorType::Grayscale, png::BitDepth::Eight, None, &row);
        assert!(message(&wide).contains("16385 x 1 texels, at most 16384"), "{}", message(&wide));
        assert!(message(&jpeg_of(200)[..100]).contains("as JPEG"));
        assert!(bytes_of(8192, 8192, 4).is_ok());
        // a small JPEG that claims to be large
        let mut large = jpeg_of(200);
        large[76..80].copy_from_slice(&[0x3f, 0xff, 0x3f, 0xff]);
        assert!(message(&large).contains("16383 x 16383 texels, at most"), "{}", message(&large));
    }

    #[test]
    fn uris_name_data_or_files_beside() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a b.bin"), [1, 2, 3]).unwrap();
        let read = |uri: &str| named(uri, Some(folder.path()));
        assert_eq!(read("data:application/octet-stream;base64,AQID").unwrap(), [1, 2, 3]);
        assert_eq!(read("a%20b.bin").unwrap(), [1, 2, 3]);
        assert_eq!(read("a b.bin").unwrap(), [1, 2, 3]);
        for (uri, why) in [
            ("data:AQID", "has a data: URI that cannot be read"),
            ("data:;base64,A", "no base64"),
            ("none.bin", "cannot be read from \"none.bin\""),
            ("../a b.bin", "leaves the folder"),
            ("%2e%2e/a.bin", "leaves the folder"),
            ("/etc/passwd", "leaves the folder"),
            ("http://a.example/a.bin", "leaves the folder"),
        ] {
            assert!(read(uri).unwrap_err().contains(why), "{uri}: {:?}", read(uri));
        }
        assert!(named("a.bin", None).unwrap_err().contains("which was not given"));
    }
}
