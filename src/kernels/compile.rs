//! WGSL to SPIR-V and to what the rest of the program needs to know about a shader: its bindings, their access
//! and types, the workgroup size, the struct layouts.
//!
//! `build.rs` includes this file and compiles every shader when the crate is built; the feature `hot-reload`
//! uses the same code while the program runs.

#[path = "barriers.rs"]
pub(crate) mod barriers;
#[path = "constants.rs"]
pub mod constants;
#[path = "emit.rs"]
pub(crate) mod emit;
#[path = "fault.rs"]
pub mod fault;
#[path = "source.rs"]
pub mod source;

use super::spirv;
use constants::Constant;
use fault::{Error, Fault};
pub use source::Source;

use naga::proc::Layouter;
use naga::valid::{Capabilities, GlobalUse, ModuleInfo, ValidationFlags, Validator};
use naga::{AddressSpace, Handle, Module, ScalarKind, ShaderStage, Type, TypeInner, VectorSize};

/// How a shader uses a buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Use {
    /// Uniform buffer.
    Uniform,
    /// Storage buffer, read only.
    Read,
    /// Storage buffer, written (and perhaps read).
    Write,
    /// Sampled image.
    Texture,
    /// Sampler.
    Sampler,
}

/// One binding.
#[derive(Debug, Clone)]
pub struct Binding {
    /// Name of the variable, and of the buffer.
    pub name: String,
    /// Descriptor set.
    pub group: u32,
    /// Binding number.
    pub binding: u32,
    /// Access.
    pub access: Use,
    /// Bytes of one element (storage) or of the whole (uniform).
    pub stride: u32,
    /// Element type in Rust.
    pub rust: String,
    /// Of each word of an element whether it is an integer, or bits.
    pub integer_words: Vec<bool>,
    /// `file:line:column` of the declaration.
    pub place: String,
}

/// A field of a struct that a buffer holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Field {
    /// Name.
    pub name: String,
    /// Type in Rust.
    pub rust: String,
    /// The comment behind it.
    pub comment: String,
}

/// A struct that a buffer holds.
#[derive(Debug, Clone)]
pub struct Layout {
    /// Name.
    pub name: String,
    /// Fields, one behind the other without a gap.
    pub fields: Vec<Field>,
    /// `file:line:column` of the declaration.
    pub place: String,
}

/// One entry point.
#[derive(Debug)]
pub struct Entry {
    /// Name.
    pub name: String,
    /// Stage.
    pub stage: ShaderStage,
    /// Workgroup size of a compute entry point.
    pub workgroup_size: [u32; 3],
    /// Bytes of workgroup memory.
    pub workgroup_bytes: u32,
    /// What it binds, by binding number.
    pub bindings: Vec<Binding>,
    /// Name and size of the immediates, if any.
    pub immediate: Option<(String, u32)>,
    /// The code.
    pub spirv: Vec<u32>,
    /// The same for one eye a pass, which needs no multiview, where it reads the number of the eye.
    pub one_eye: Option<Vec<u32>>,
}

/// A compiled shader file.
#[derive(Debug)]
pub struct Shader {
    /// Entry points in source order.
    pub entries: Vec<Entry>,
    /// Structs in buffers.
    pub layouts: Vec<Layout>,
    /// Constants of the file and of the shared texts it uses.
    pub constants: Vec<Constant>,
}

/// Compiles one file.
///
/// # Errors
/// The faults of its text.
pub fn compile(source: &Source) -> Result<Shader, Error> {
    let module = naga::front::wgsl::parse_str(source.text()).map_err(|error| {
        let fault = |(span, label): (naga::Span, &str)| Fault {
            place: source.place(span),
            message: format!("{}: {label}", error.message()),
        };
        let faults: Vec<Fault> = error.labels().map(fault).collect();
        if faults.is_empty() { Error::at(&source.name, error.message()) } else { Error { faults } }
    })?;
    let capabilities = Capabilities::IMMEDIATES | Capabilities::MULTIVIEW;
    let info = Validator::new(ValidationFlags::all(), capabilities).validate(&module).map_err(|error| {
        let mut text = error.to_string();
        let mut cause = std::error::Error::source(error.as_inner());
        while let Some(inner) = cause {
            text = format!("{text}: {inner}");
            cause = inner.source();
        }
        let place = error.spans().next().map_or(source.name.clone(), |(span, _)| source.place(*span));
        Error::at(place, text)
    })?;
    if let Some(span) = barriers::fault(&module) {
        let message = "a barrier that some invocations may not reach hangs a GPU";
        return Err(Error::at(source.place(span), message));
    }
    bindings_are_used(&module, &info, source)?;
    let mut layouter = Layouter::default();
    layouter.update(module.to_ctx()).map_err(|error| Error::at(&source.name, error))?;
    let mut entries = Vec::new();
    for index in 0..module.entry_points.len() {
        entries.push(entry(source, &module, &info, &layouter, index)?);
    }
    let constants = constants::of(source, &module)?;
    Ok(Shader { entries, layouts: layouts(source, &module, &layouter)?, constants })
}

fn entry(
    source: &Source,
    module: &Module,
    info: &ModuleInfo,
    layouter: &Layouter,
    index: usize,
) -> Result<Entry, Error> {
    let point = &module.entry_points[index];
    let (mut bindings, mut immediate, mut workgroup_bytes) = (Vec::new(), None, 0);
    for (handle, variable) in module.global_variables.iter() {
        let usage = info.get_entry_point(index)[handle];
        let name = variable.name.clone().unwrap_or_default();
        let place = source.place(module.global_variables.get_span(handle));
        if variable.space == AddressSpace::Immediate && !usage.is_empty() {
            immediate = Some((name, layouter[variable.ty].size));
            continue;
        }
        if variable.space == AddressSpace::WorkGroup && !usage.is_empty() {
            workgroup_bytes += layouter[variable.ty].size;
        }
        let Some(resource) = &variable.binding else { continue };
        if usage.is_empty() {
            continue;
        }
        let ty = &module.types[variable.ty];
        let element = match &ty.inner {
            TypeInner::Array { base, .. } => {
                named(module, layouter, *base).map_err(|e| Error::at(&place, e))?
            }
            _ => ty,
        };
        let integer_words = integer_words(module, element);
        let (access, stride, rust) = match (&variable.space, &ty.inner) {
            (AddressSpace::Uniform, _) => (
                Use::Uniform,
                layouter[variable.ty].size,
                rust_type(module, ty).map_err(|e| Error::at(&place, e))?,
            ),
            (AddressSpace::Storage { .. }, TypeInner::Array { stride, .. }) => {
                let access = if usage.contains(GlobalUse::WRITE) { Use::Write } else { Use::Read };
                (access, *stride, rust_type(module, element).map_err(|e| Error::at(&place, e))?)
            }
            (AddressSpace::Storage { .. }, _) => {
                let message = format!("storage binding `{name}` must be an array of elements");
                return Err(Error::at(place, message));
            }
            (_, TypeInner::Sampler { .. }) => (Use::Sampler, 0, String::new()),
            _ => (Use::Texture, 0, String::new()),
        };
        bindings.push(Binding {
            name,
            group: resource.group,
            binding: resource.binding,
            access,
            stride,
            rust,
            integer_words,
            place,
        });
    }
    bindings.sort_by_key(|binding| (binding.group, binding.binding));
    let spirv = emit::entry(module, info, index).map_err(|e| Error::at(&source.name, e))?;
    let one_eye = emit::one_eye(module, index).map_err(|e| Error::at(&source.name, e))?;
    Ok(Entry {
        name: point.name.clone(),
        stage: point.stage,
        workgroup_size: point.workgroup_size,
        workgroup_bytes,
        bindings,
        immediate,
        spirv,
        one_eye,
    })
}

/// A kernel binds nothing that none of its phases uses, nor does a draw shader of one entry point.
fn bindings_are_used(module: &Module, info: &ModuleInfo, source: &Source) -> Result<(), Error> {
    let is_kernel = module.entry_points.iter().all(|point| point.stage == ShaderStage::Compute);
    for (handle, variable) in module.global_variables.iter().filter(|(_, v)| v.binding.is_some()) {
        let is_used = (0..module.entry_points.len()).any(|i| !info.get_entry_point(i)[handle].is_empty());
        if !is_used && (is_kernel || module.entry_points.len() == 1) {
            let place = source.place(module.global_variables.get_span(handle));
            let name = variable.name.as_deref().unwrap_or_default();
            return Err(Error::at(place, format!("binding `{name}` is never used: remove it")));
        }
    }
    Ok(())
}

/// What a struct ends with in its name that holds the struct of the rest of the name in vectors of four. A GPU reads and writes
/// such a vector at once, but the numbers of a struct one by one.
const QUADS: &str = "Quads";

/// An element of a buffer, with names for its numbers.
fn named<'a>(module: &'a Module, layouter: &Layouter, element: Handle<Type>) -> Result<&'a Type, String> {
    let quads = &module.types[element];
    let Some(name) = quads.name.as_deref().and_then(|name| name.strip_suffix(QUADS)) else {
        return Ok(quads);
    };
    let same = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name));
    let (handle, ty) =
        same.ok_or_else(|| format!("{name}{QUADS} is of a struct {name}, which is not there"))?;
    let (bytes, wanted) = (layouter[element].size, layouter[handle].size);
    if bytes != wanted {
        return Err(format!("{name}{QUADS} has {bytes} bytes, but {name} has {wanted}"));
    }
    Ok(ty)
}

/// Of each word of a type whether it is an integer; of what holds no numbers nothing.
fn integer_words(module: &Module, ty: &Type) -> Vec<bool> {
    let is_integer = |s: &naga::Scalar| matches!(s.kind, ScalarKind::Uint | ScalarKind::Sint);
    let of = |handle: Handle<Type>| integer_words(module, &module.types[handle]);
    match &ty.inner {
        TypeInner::Scalar(s) | TypeInner::Atomic(s) => vec![is_integer(s)],
        TypeInner::Vector { size, scalar } => vec![is_integer(scalar); *size as usize],
        TypeInner::Matrix { columns, rows, .. } => vec![false; *columns as usize * *rows as usize],
        TypeInner::Array { base, size: naga::ArraySize::Constant(n), .. } => {
            of(*base).repeat(n.get() as usize)
        }
        TypeInner::Struct { members, .. } => members.iter().flat_map(|member| of(member.ty)).collect(),
        _ => Vec::new(),
    }
}

/// The Rust twin of a WGSL type in a buffer.
fn rust_type(module: &Module, ty: &Type) -> Result<String, String> {
    let scalar = |scalar: &naga::Scalar| match (scalar.kind, scalar.width) {
        (ScalarKind::Float, 4) => Ok("f32"),
        (ScalarKind::Uint, 4) => Ok("u32"),
        (ScalarKind::Sint, 4) => Ok("i32"),
        other => Err(format!("{other:?} has no place in a buffer: use f32, u32 or i32")),
    };
    match &ty.inner {
        TypeInner::Scalar(s) | TypeInner::Atomic(s) => Ok(scalar(s)?.to_owned()),
        TypeInner::Vector { size: VectorSize::Tri, .. } => {
            Err("vec3 is padded differently in Rust: use vec2 or vec4".to_owned())
        }
        TypeInner::Vector { size, scalar: s } => Ok(format!("[{}; {}]", scalar(s)?, *size as u32)),
        TypeInner::Matrix { columns, rows, scalar: s } => {
            Ok(format!("[[{}; {}]; {}]", scalar(s)?, *rows as u32, *columns as u32))
        }
        TypeInner::Array { base, size: naga::ArraySize::Constant(n), .. } => {
            Ok(format!("[{}; {n}]", rust_type(module, &module.types[*base])?))
        }
        TypeInner::Struct { .. } => {
            Ok(format!("crate::kernels::layout::{}", ty.name.as_deref().unwrap_or("?")))
        }
        other => {
            Err(format!("{other:?} has no Rust twin: use scalars, vec2, vec4, arrays or structs of these"))
        }
    }
}

/// Layouts of all structs that a buffer variable holds.
fn layouts(source: &Source, module: &Module, layouter: &Layouter) -> Result<Vec<Layout>, Error> {
    let mut reached: Vec<_> = module
        .global_variables
        .iter()
        .filter(|(_, v)| matches!(v.space, AddressSpace::Uniform | AddressSpace::Storage { .. }))
        .map(|(_, v)| v.ty)
        .collect();
    let mut found = Vec::new();
    while let Some(handle) = reached.pop() {
        let ty = &module.types[handle];
        match &ty.inner {
            TypeInner::Array { base, .. } => reached.push(*base),
            TypeInner::Struct { members, .. } => {
                reached.extend(members.iter().map(|member| member.ty));
                let name = ty.name.clone().unwrap_or_default();
                if name.ends_with(QUADS) {
                    continue;
                }
                let place = source.place(module.types.get_span(handle));
                let (mut fields, mut end) = (Vec::new(), 0);
                for member in members {
                    let field = member.name.clone().unwrap_or_default();
                    if member.offset != end {
                        let hole = member.offset - end;
                        let message = format!("{hole} bytes lie unnamed before {name}.{field}: name them");
                        return Err(Error::at(place, message));
                    }
                    end += layouter[member.ty].size;
                    let rust = rust_type(module, &module.types[member.ty])
                        .map_err(|e| Error::at(&place, format!("{field}: {e}")))?;
                    let comment = source.comment_of(&name, &field).unwrap_or_default();
                    fields.push(Field { name: field, rust, comment });
                }
                let size = layouter[handle].to_stride();
                if size != end {
                    let message = format!("{} bytes lie unnamed at the end of {name}: name them", size - end);
                    return Err(Error::at(place, message));
                }
                found.push(Layout { name, fields, place });
            }
            _ => {}
        }
    }
    Ok(found)
}
