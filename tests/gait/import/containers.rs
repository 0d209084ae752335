//! Writers of C3D, `.npy` and `.npz`, for tests.

use gaitway::gait::{Joint, Recording};
use glam::Vec3;
use std::io::{Cursor, Write as _};

/// A C3D of a take's 16 joints, z up. `processor` is 84 (Intel), 85 (DEC) or 86 (MIPS).
pub(crate) fn c3d(take: &Recording, processor: u8, is_float: bool, unit: &str) -> Vec<u8> {
    let names: Vec<String> = Joint::ALL.iter().map(|joint| joint.name().to_owned()).collect();
    let frames: Vec<Vec<Vec3>> = take.poses.iter().map(|pose| pose.to_vec()).collect();
    c3d_points(&names, &frames, take.frame_rate, processor, is_float, unit)
}

struct Numbers(u8);

impl Numbers {
    fn word(&self, value: u16) -> [u8; 2] {
        if self.0 == 86 { value.to_be_bytes() } else { value.to_le_bytes() }
    }

    fn float(&self, value: f32) -> [u8; 4] {
        match self.0 {
            86 => value.to_be_bytes(),
            84 => value.to_le_bytes(),
            _ => {
                let [a, b, c, d] = (value * 4.0).to_le_bytes();
                [c, d, a, b]
            }
        }
    }
}

/// A C3D of points in metres, y up; written in millimetres, z up.
pub(crate) fn c3d_points(
    names: &[String],
    frames: &[Vec<Vec3>],
    rate: f32,
    processor: u8,
    is_float: bool,
    unit: &str,
) -> Vec<u8> {
    let n = Numbers(processor);
    let count = u16::try_from(names.len()).unwrap();
    let scale = if is_float { -0.1 } else { 0.25 };
    let mut parameters = vec![0, 0, 2, processor];
    let entry = |parameters: &mut Vec<u8>, name: &str, group: i8, body: &[u8]| {
        parameters.push(u8::try_from(name.len()).unwrap());
        parameters.push(group.cast_unsigned());
        parameters.extend(name.as_bytes());
        parameters.extend(n.word(u16::try_from(body.len() + 2).unwrap()));
        parameters.extend(body);
    };
    entry(&mut parameters, "POINT", -1, &[0]);
    let width = names.iter().map(String::len).max().unwrap();
    let labels: String = names.iter().map(|name| format!("{name:width$}")).collect();
    let words = |kind: u8, extents: &[u8], data: &[u8]| {
        [&[kind, u8::try_from(extents.len()).unwrap()], extents, data, &[0]].concat()
    };
    let text = 0xff;
    entry(&mut parameters, "USED", 1, &words(2, &[], &n.word(count)));
    entry(&mut parameters, "SCALE", 1, &words(4, &[], &n.float(scale)));
    entry(&mut parameters, "RATE", 1, &words(4, &[], &n.float(rate)));
    let extents = [u8::try_from(width).unwrap(), u8::try_from(names.len()).unwrap()];
    entry(&mut parameters, "LABELS", 1, &words(text, &extents, labels.as_bytes()));
    entry(&mut parameters, "UNITS", 1, &words(text, &[u8::try_from(unit.len()).unwrap()], unit.as_bytes()));
    let blocks = (parameters.len() + 64).div_ceil(512);
    let start = u16::try_from(2 + blocks).unwrap();
    entry(&mut parameters, "DATA_START", 1, &words(2, &[], &n.word(start)));
    parameters[2] = u8::try_from(blocks).unwrap();
    parameters.resize(blocks * 512, 0);

    let last = u16::try_from(frames.len()).unwrap();
    let mut header = vec![2, 0x50];
    for word in [count, 0, 1, last, 0] {
        header.extend(n.word(word));
    }
    header.extend(n.float(scale));
    header.extend(n.word(start));
    header.extend(n.word(0));
    header.extend(n.float(rate));
    header.resize(512, 0);

    let mut bytes = [header, parameters].concat();
    for point in frames.iter().flatten() {
        let z_up = Vec3::new(point.x, -point.z, point.y) * 1000.0;
        for value in z_up.to_array() {
            if is_float {
                bytes.extend(n.float(value));
            } else {
                #[allow(clippy::cast_possible_truncation, reason = "millimetres of a walk of metres")]
                let whole = (value / scale).round() as i16;
                bytes.extend(n.word(whole.cast_unsigned()));
            }
        }
        if is_float { bytes.extend(n.float(0.0)) } else { bytes.extend(n.word(0)) }
    }
    bytes.resize(bytes.len().div_ceil(512) * 512, 0);
    bytes
}

/// A TRC of points in metres, as `OpenSim` writes it; `None` where a point was lost.
pub(crate) fn trc(names: &[String], frames: &[Vec<Option<Vec3>>], rate: f32, unit: &str) -> String {
    let scale = if unit == "mm" { 1000.0 } else { 1.0 };
    let (count, points) = (frames.len(), names.len());
    let mut text = format!(
        "PathFileType\t4\t(X/Y/Z)\twalk.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\t\
         OrigDataStartFrame\tOrigNumFrames\n{rate}\t{rate}\t{count}\t{points}\t{unit}\t{rate}\t1\t{count}\nFrame#\tTime"
    );
    let axes: String = (1..=points).map(|i| format!("\tX{i}\tY{i}\tZ{i}")).collect();
    text += &names.iter().map(|name| format!("\t{name}\t\t")).collect::<String>();
    text += &format!("\n\t{axes}\n\n");
    for (index, frame) in frames.iter().enumerate() {
        text += &format!("{}\t{:.5}", index + 1, index as f32 / rate);
        for point in frame {
            text += &match point {
                Some(p) => format!("\t{:.6}\t{:.6}\t{:.6}", p.x * scale, p.y * scale, p.z * scale),
                None => "\t\t\t".to_owned(),
            };
        }
        text.push('\n');
    }
    text
}

/// A `NumPy` array in C order.
pub(crate) fn npy(descr: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n");
    let length = u16::try_from(header.len()).unwrap().to_le_bytes();
    [b"\x93NUMPY\x01\x00".as_slice(), &length, header.as_bytes(), data].concat()
}

/// An archive of arrays, packed or stored.
pub(crate) fn npz(arrays: &[(&str, Vec<u8>)], packed: bool) -> Vec<u8> {
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let method = if packed { zip::CompressionMethod::Deflated } else { zip::CompressionMethod::Stored };
    let options = zip::write::SimpleFileOptions::default().compression_method(method);
    for (name, bytes) in arrays {
        writer.start_file(format!("{name}.npy"), options).unwrap();
        writer.write_all(bytes).unwrap();
    }
    writer.finish().unwrap().into_inner()
}
