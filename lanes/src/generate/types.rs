//! Types, constants, and the choice between two values of a type.

use super::Writer;
use naga::{ArraySize, Expression, Handle, Literal, Scalar, ScalarKind, Type, TypeInner};
use std::fmt::Write as _;

/// What the words of a value are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Float,
    Unsigned,
    Signed,
    Bool,
}

impl Kind {
    pub(super) fn of(scalar: Scalar) -> Result<Self, String> {
        match (scalar.kind, scalar.width) {
            (ScalarKind::Float, 4) => Ok(Self::Float),
            (ScalarKind::Uint, 4) => Ok(Self::Unsigned),
            (ScalarKind::Sint, 4) => Ok(Self::Signed),
            (ScalarKind::Bool, _) => Ok(Self::Bool),
            (kind, width) => Err(format!("{kind:?} of {width} bytes")),
        }
    }

    /// First letter of the operations that differ by kind.
    pub(super) const fn letter(self) -> char {
        match self {
            Self::Float => 'f',
            Self::Unsigned => 'u',
            Self::Signed => 'i',
            Self::Bool => 'm',
        }
    }

    const fn rust(self) -> &'static str {
        match self {
            Self::Bool => "M",
            _ => "V",
        }
    }
}

/// A scalar or a vector.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Shape {
    pub(super) kind: Kind,
    /// Components of a vector.
    pub(super) size: Option<usize>,
}

impl Shape {
    pub(super) fn of(inner: &TypeInner) -> Result<Self, String> {
        match *inner {
            TypeInner::Scalar(scalar) | TypeInner::Atomic(scalar) => {
                Ok(Self { kind: Kind::of(scalar)?, size: None })
            }
            TypeInner::Vector { size, scalar } => {
                Ok(Self { kind: Kind::of(scalar)?, size: Some(size as usize) })
            }
            TypeInner::Matrix { .. } => Err("arithmetic with a matrix".to_owned()),
            _ => Err("arithmetic with other than numbers and vectors".to_owned()),
        }
    }

    /// Applies `f` to each component of some values of this shape: a value, or an array.
    pub(super) fn each(self, values: &[(&str, Self)], f: impl Fn(&[String]) -> String) -> String {
        let component = |at: Option<usize>| {
            let pick = |(value, shape): &(&str, Self)| match (at, shape.size) {
                (Some(at), Some(_)) => format!("{value}[{at}]"),
                _ => (*value).to_owned(),
            };
            f(&values.iter().map(pick).collect::<Vec<_>>())
        };
        match self.size {
            None => component(None),
            Some(size) => {
                let all: Vec<String> = (0..size).map(|at| component(Some(at))).collect();
                format!("[{}]", all.join(", "))
            }
        }
    }
}

impl Writer<'_> {
    /// The type in Rust.
    pub(super) fn rust(&mut self, handle: Handle<Type>) -> Result<String, String> {
        let inner = &self.module.types[handle].inner;
        if let TypeInner::Struct { members, .. } = inner {
            if !self.structs.contains_key(&handle) {
                self.structs.insert(handle, String::new()); // what it holds may come again
                let text = self.struct_text(handle, members)?;
                self.structs.insert(handle, text);
            }
            return Ok(struct_name(handle));
        }
        self.rust_inner(inner)
    }

    /// The type in Rust of what has no name.
    pub(super) fn rust_inner(&mut self, inner: &TypeInner) -> Result<String, String> {
        Ok(match *inner {
            TypeInner::Scalar(scalar) | TypeInner::Atomic(scalar) => Kind::of(scalar)?.rust().to_owned(),
            TypeInner::Vector { size, scalar } => format!("[{}; {}]", Kind::of(scalar)?.rust(), size as u32),
            TypeInner::Matrix { columns, rows, scalar } => {
                format!("[[{}; {}]; {}]", Kind::of(scalar)?.rust(), rows as u32, columns as u32)
            }
            TypeInner::Array { base, size: ArraySize::Constant(count), .. } => {
                format!("[{}; {count}]", self.rust(base)?)
            }
            TypeInner::Array { .. } => return Err("an array of open length as a value".to_owned()),
            TypeInner::Pointer { .. } | TypeInner::ValuePointer { .. } => {
                return Err("a pointer as a value".to_owned());
            }
            _ => return Err("a texture, or another thing that is not made of words,".to_owned()),
        })
    }

    fn struct_text(
        &mut self,
        handle: Handle<Type>,
        members: &[naga::StructMember],
    ) -> Result<String, String> {
        let name = struct_name(handle);
        let (mut fields, mut picks) = (String::new(), Vec::new());
        for (at, member) in members.iter().enumerate() {
            let _ = write!(fields, "m{at}: {}, ", self.rust(member.ty)?);
            let value = self.pick(member.ty, "mask", &format!("yes.m{at}"), &format!("no.m{at}"))?;
            picks.push(format!("m{at}: {value}"));
        }
        let said = self.module.types[handle].name.as_deref().unwrap_or("unnamed");
        Ok(format!(
            "/// `{said}`\n#[derive(Clone, Copy)]\nstruct {name} {{ {fields}}}\n\n#[inline]\n{attribute}\
             fn pick_{name}(mask: M, yes: {name}, no: {name}) -> {name} {{\n    {name} {{ {picks} }}\n}}\n\n",
            attribute = self.attribute(),
            picks = picks.join(", "),
        ))
    }

    /// The one where the mask is true, else the other.
    pub(super) fn pick(
        &mut self,
        ty: Handle<Type>,
        mask: &str,
        yes: &str,
        no: &str,
    ) -> Result<String, String> {
        match &self.module.types[ty].inner {
            TypeInner::Struct { .. } => {
                self.rust(ty)?;
                Ok(format!("pick_{}({mask}, {yes}, {no})", struct_name(ty)))
            }
            &TypeInner::Array { base, size: ArraySize::Constant(count), .. } => {
                let one = self.pick(base, mask, "yes[at]", "no[at]")?;
                Ok(format!(
                    "{{ let yes = {yes}; let mut no = {no}; let mut at = 0; while at < {count} {{ no[at] = {one}; at += 1; }} no }}"
                ))
            }
            inner => pick_words(inner, mask, yes, no),
        }
    }

    /// All zero.
    pub(super) fn zero(&mut self, ty: Handle<Type>) -> Result<String, String> {
        let inner = &self.module.types[ty].inner;
        if let TypeInner::Struct { members, .. } = inner {
            let mut all = Vec::new();
            for (at, member) in members.iter().enumerate() {
                all.push(format!("m{at}: {}", self.zero(member.ty)?));
            }
            return Ok(format!("{} {{ {} }}", self.rust(ty)?, all.join(", ")));
        }
        Ok(match *inner {
            TypeInner::Array { base, size: ArraySize::Constant(count), .. } => {
                format!("[{}; {count}]", self.zero(base)?)
            }
            TypeInner::Matrix { columns, rows, .. } => {
                format!("[[V::c(0); {}]; {}]", rows as u32, columns as u32)
            }
            _ => {
                let shape = Shape::of(inner)?;
                let zero = if shape.kind == Kind::Bool { "M::c(false)" } else { "V::c(0)" };
                shape.size.map_or_else(|| zero.to_owned(), |size| format!("[{zero}; {size}]"))
            }
        })
    }

    /// A constant expression of the module.
    pub(super) fn constant(&mut self, handle: Handle<Expression>) -> Result<String, String> {
        match &self.module.global_expressions[handle] {
            &Expression::Literal(value) => literal(value),
            &Expression::Constant(constant) => self.constant(self.module.constants[constant].init),
            &Expression::ZeroValue(ty) => self.zero(ty),
            Expression::Compose { ty, components } => {
                let parts: Result<Vec<String>, String> =
                    components.iter().map(|part| self.constant(*part)).collect();
                self.compose(*ty, &parts?)
            }
            &Expression::Splat { size, value } => Ok(format!("[{}; {}]", self.constant(value)?, size as u32)),
            _ => Err("an override, or another constant that is not yet known,".to_owned()),
        }
    }

    /// A value of its parts, one each.
    pub(super) fn compose(&mut self, ty: Handle<Type>, parts: &[String]) -> Result<String, String> {
        if let TypeInner::Struct { .. } = self.module.types[ty].inner {
            let fields: Vec<String> =
                parts.iter().enumerate().map(|(at, part)| format!("m{at}: {part}")).collect();
            return Ok(format!("{} {{ {} }}", self.rust(ty)?, fields.join(", ")));
        }
        Ok(format!("[{}]", parts.join(", ")))
    }
}

/// The one or the other, of numbers, vectors and matrices.
pub(super) fn pick_words(inner: &TypeInner, mask: &str, yes: &str, no: &str) -> Result<String, String> {
    if let TypeInner::Matrix { columns, rows, .. } = *inner {
        let column = |column| {
            let all: Vec<String> = (0..rows as u32)
                .map(|row| format!("{mask}.pick({yes}[{column}][{row}], {no}[{column}][{row}])"))
                .collect();
            format!("[{}]", all.join(", "))
        };
        let all: Vec<String> = (0..columns as u32).map(column).collect();
        return Ok(format!("[{}]", all.join(", ")));
    }
    let shape = Shape::of(inner)?;
    Ok(shape.each(&[(yes, shape), (no, shape)], |parts| pick_one(shape.kind, mask, &parts[0], &parts[1])))
}

/// The one or the other, of one word or truth value.
pub(super) fn pick_one(kind: Kind, mask: &str, yes: &str, no: &str) -> String {
    match kind {
        Kind::Bool => format!("{mask}.and({yes}).or({no}.andnot({mask}))"),
        _ => format!("{mask}.pick({yes}, {no})"),
    }
}

pub(super) fn literal(value: Literal) -> Result<String, String> {
    match value {
        Literal::F32(value) => Ok(format!("V::f({value:?}f32)")),
        Literal::U32(value) => Ok(format!("V::c({value})")),
        Literal::I32(value) => Ok(format!("V::c({value}i32 as u32)")),
        Literal::Bool(value) => Ok(format!("M::c({value})")),
        other => Err(format!("the number {other:?}")),
    }
}

fn struct_name(handle: Handle<Type>) -> String {
    format!("S{}", handle.index())
}
