//! Reading accessors with every range checked: a file's numbers are claims, not facts.

use glam::{Mat4, Vec2, Vec3, Vec4};
use gltf::Accessor;
use gltf::accessor::DataType;
use gltf::accessor::sparse::IndexType;

/// Bytes of a buffer of the file.
pub(super) type Buffer = Vec<u8>;

/// Most vertices of a character. A sparse accessor may claim as many without bytes for them.
pub(super) const MOST_VERTICES: usize = 2_000_000;

/// Bytes of each element of an accessor.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
    count: usize,
}

impl<'a> Elements<'a> {
    fn of(accessor: &Accessor<'_>, buffers: &'a [Buffer]) -> Result<Self, String> {
        let index = accessor.index();
        let view = accessor.view().ok_or_else(|| format!("accessor {index} has no data"))?;
        let size = accessor.data_type().size() * accessor.dimensions().multiplicity();
        let stride = view.stride().unwrap_or(size);
        Self { bytes: &[], stride, size, count: accessor.count() }.within(
            index,
            &view,
            accessor.offset(),
            buffers,
        )
    }

    /// The same with its bytes, from an offset in a view on.
    fn within(
        self,
        index: usize,
        view: &gltf::buffer::View<'_>,
        offset: usize,
        buffers: &'a [Buffer],
    ) -> Result<Self, String> {
        let buffer = buffers.get(view.buffer().index()).map_or(&[][..], Vec::as_slice);
        let end = view.offset().checked_add(view.length());
        let view_bytes = end.and_then(|end| buffer.get(view.offset()..end)).ok_or_else(|| {
            let (from, length) = (view.offset(), view.length());
            format!(
                "buffer view {} is bytes {from} + {length} of a buffer of {} bytes",
                view.index(),
                buffer.len()
            )
        })?;
        let Self { stride, size, count, .. } = self;
        let needed = count
            .checked_sub(1)
            .map_or(Some(0), |last| last.checked_mul(stride).and_then(|n| n.checked_add(size)));
        let bytes = view_bytes.get(offset..).unwrap_or(&[]);
        match needed {
            Some(needed) if needed <= bytes.len() && stride >= size => Ok(Self { bytes, ..self }),
            _ => Err(format!(
                "accessor {index} claims {count} elements of {size} bytes every {stride}, but its view has {} bytes",
                bytes.len()
            )),
        }
    }

    fn iter(&self) -> impl Iterator<Item = &'a [u8]> {
        let (bytes, stride, size) = (self.bytes, self.stride, self.size);
        (0..self.count).map(move |i| bytes.get(i * stride..i * stride + size).unwrap_or(&[]))
    }
}

fn array<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    let mut out = [0; N];
    if let Some(found) = bytes.get(at..at + N) {
        out.copy_from_slice(found);
    }
    out
}

/// The component at `slot` as a float; integers as they are, or divided by their maximum if `normalised`.
fn float(bytes: &[u8], data: DataType, slot: usize, normalised: bool) -> f32 {
    let at = slot * data.size();
    let (value, most) = match data {
        DataType::F32 => return f32::from_le_bytes(array(bytes, at)),
        DataType::U8 => (f32::from(array::<1>(bytes, at)[0]), 255.0),
        DataType::I8 => (f32::from(i8::from_le_bytes(array(bytes, at))), 127.0),
        DataType::U16 => (f32::from(u16::from_le_bytes(array(bytes, at))), 65535.0),
        DataType::I16 => (f32::from(i16::from_le_bytes(array(bytes, at))), 32767.0),
        DataType::U32 => {
            // glTF has no float attribute of this type; the last bits do not matter.
            let value = u32::from_le_bytes(array(bytes, at));
            (value as f32, u32::MAX as f32)
        }
    };
    if normalised { (value / most).max(-1.0) } else { value }
}

/// All components as floats, `[element][component]`, refused if not finite or of another shape.
fn floats(accessor: &Accessor<'_>, buffers: &[Buffer], components: usize) -> Result<Vec<Vec<f32>>, String> {
    let (index, found) = (accessor.index(), accessor.dimensions().multiplicity());
    if found < components {
        return Err(format!("accessor {index} has {found} components, expected {components}"));
    }
    let (data, normalised) = (accessor.data_type(), accessor.normalized());
    let read = |(i, bytes): (usize, &[u8])| -> Result<Vec<f32>, String> {
        let values: Vec<f32> = (0..components).map(|slot| float(bytes, data, slot, normalised)).collect();
        if values.iter().all(|v| v.is_finite()) {
            Ok(values)
        } else {
            Err(format!("accessor {index}, element {i} is not finite: {values:?}"))
        }
    };
    let Some(sparse) = accessor.sparse() else {
        return Elements::of(accessor, buffers)?.iter().enumerate().map(read).collect();
    };
    if accessor.count() > MOST_VERTICES {
        return Err(format!(
            "accessor {index} claims {} elements; at most {MOST_VERTICES} are read",
            accessor.count()
        ));
    }
    // What it does not name is as in its view, or 0.
    let mut all = match accessor.view() {
        Some(_) => Elements::of(accessor, buffers)?.iter().enumerate().map(read).collect::<Result<_, _>>()?,
        None => vec![vec![0.0; components]; accessor.count()],
    };
    let size = data.size() * found;
    let (indices, values) = (sparse.indices(), sparse.values());
    let width = match indices.index_type() {
        IndexType::U8 => 1,
        IndexType::U16 => 2,
        IndexType::U32 => 4,
    };
    let elements = |size: usize| Elements { bytes: &[], stride: size, size, count: sparse.count() };
    let places = elements(width).within(index, &indices.view(), indices.offset(), buffers)?;
    let values = elements(size).within(index, &values.view(), values.offset(), buffers)?;
    for (place, value) in places.iter().zip(values.iter().enumerate()) {
        let mut wide = [0; 4];
        wide.iter_mut().zip(place).for_each(|(wide, byte)| *wide = *byte);
        let place = u32::from_le_bytes(wide) as usize;
        let slot = all.get_mut(place).ok_or_else(|| {
            format!("accessor {index} is sparse and names element {place} of {}", accessor.count())
        })?;
        *slot = read(value)?;
    }
    Ok(all)
}

pub(super) fn vec2(accessor: &Accessor<'_>, buffers: &[Buffer]) -> Result<Vec<Vec2>, String> {
    Ok(floats(accessor, buffers, 2)?.iter().map(|v| Vec2::new(v[0], v[1])).collect())
}

pub(super) fn vec3(accessor: &Accessor<'_>, buffers: &[Buffer]) -> Result<Vec<Vec3>, String> {
    Ok(floats(accessor, buffers, 3)?.iter().map(|v| Vec3::new(v[0], v[1], v[2])).collect())
}

/// Colours; those without alpha have 1.
pub(super) fn color(accessor: &Accessor<'_>, buffers: &[Buffer]) -> Result<Vec<Vec4>, String> {
    if accessor.dimensions().multiplicity() < 4 {
        return Ok(vec3(accessor, buffers)?.into_iter().map(|color| color.extend(1.0)).collect());
    }
    Ok(floats(accessor, buffers, 4)?.iter().map(|v| Vec4::new(v[0], v[1], v[2], v[3])).collect())
}

pub(super) fn vec4(accessor: &Accessor<'_>, buffers: &[Buffer]) -> Result<Vec<[f32; 4]>, String> {
    Ok(floats(accessor, buffers, 4)?.iter().map(|v| [v[0], v[1], v[2], v[3]]).collect())
}

pub(super) fn mat4(accessor: &Accessor<'_>, buffers: &[Buffer]) -> Result<Vec<Mat4>, String> {
    let matrix = |v: &Vec<f32>| Mat4::from_cols_array(&std::array::from_fn(|i| v[i]));
    Ok(floats(accessor, buffers, 16)?.iter().map(matrix).collect())
}

/// Unsigned integers, `[element][component]` flattened.
pub(super) fn integers(
    accessor: &Accessor<'_>,
    buffers: &[Buffer],
    components: usize,
) -> Result<Vec<u32>, String> {
    let (index, found) = (accessor.index(), accessor.dimensions().multiplicity());
    if found < components {
        return Err(format!("accessor {index} has {found} components, expected {components}"));
    }
    let data = accessor.data_type();
    let read = |bytes: &[u8], slot: usize| match data {
        DataType::U8 => Ok(u32::from(array::<1>(bytes, slot)[0])),
        DataType::U16 => Ok(u32::from(u16::from_le_bytes(array(bytes, slot * 2)))),
        DataType::U32 => Ok(u32::from_le_bytes(array(bytes, slot * 4))),
        other => Err(format!("accessor {index} holds {other:?}, expected unsigned integers")),
    };
    if accessor.sparse().is_some() {
        return Err(format!(
            "accessor {index} is sparse, which is not supported for integers; export without sparse accessors"
        ));
    }
    let elements = Elements::of(accessor, buffers)?;
    elements
        .iter()
        .flat_map(|bytes| (0..components).map(move |slot| (bytes, slot)))
        .map(|(b, s)| read(b, s))
        .collect()
}
