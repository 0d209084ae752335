//! The constants that a shader declares, with the values that naga evaluated.

use super::Source;
use super::fault::Error;
use naga::{Expression, Handle, Literal, Module};
use std::path::PathBuf;

/// A constant of a module.
#[derive(Debug, Clone, PartialEq)]
pub struct Constant {
    /// Name.
    pub name: String,
    /// The file that declares it.
    pub file: PathBuf,
    /// The line of the declaration, from 1.
    pub line: usize,
    /// What it is.
    pub value: Value,
}

/// The value of a constant, as it was evaluated.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A number of 32 bits, or a truth.
    Scalar(Literal),
    /// The components of a vector, or the elements of an array.
    Many(Vec<Self>),
}

impl Value {
    /// The type in Rust.
    pub fn rust_type(&self) -> &'static str {
        match self {
            Self::Scalar(Literal::F32(_)) => "f32",
            Self::Scalar(Literal::U32(_)) => "u32",
            Self::Scalar(Literal::I32(_)) => "i32",
            Self::Scalar(_) => "bool",
            Self::Many(values) => match (values.len(), values.first().map_or("", Self::rust_type)) {
                (2, "f32") => "[f32; 2]",
                (3, "f32") => "[f32; 3]",
                (4, "f32") => "[f32; 4]",
                (4, "u32") => "[u32; 4]",
                _ => "",
            },
        }
    }

    /// The value in Rust, exact to the bit.
    pub fn rust(&self) -> String {
        match self {
            Self::Scalar(Literal::F32(x)) => {
                let bits = x.to_bits();
                format!("f32::from_bits(0x{:04x}_{:04x})", bits >> 16, bits & 0xffff)
            }
            Self::Scalar(Literal::U32(x)) => format!("{x}"),
            Self::Scalar(Literal::I32(x)) => format!("{x}"),
            Self::Scalar(x) => format!("{}", *x == Literal::Bool(true)),
            Self::Many(values) => {
                format!("[{}]", values.iter().map(Self::rust).collect::<Vec<_>>().join(", "))
            }
        }
    }

    /// The value as one reads it.
    pub fn text(&self) -> String {
        match self {
            Self::Scalar(Literal::F32(x)) => format!("{x:?}"),
            Self::Scalar(_) => self.rust(),
            Self::Many(values) => values.iter().map(Self::text).collect::<Vec<_>>().join(", "),
        }
    }
}

/// The constants that the text declares.
///
/// naga drops those without a type once it has put them in where they are used, so every constant states its type.
pub(super) fn of(source: &Source, module: &Module) -> Result<Vec<Constant>, Error> {
    let mut found = Vec::new();
    for (at, line) in source.text().lines().enumerate() {
        let Some(rest) = line.strip_prefix("const ") else { continue };
        let name = rest.split([':', ' ', '=']).next().unwrap_or_default();
        let (Some((file, line)), true) = (source.part(at), name != "KERNEL_ID") else { continue };
        let is_it = |constant: &&naga::Constant| constant.name.as_deref() == Some(name);
        let place = format!("{}:{line}", file.display());
        let constant = module.constants.iter().map(|(_, constant)| constant).find(is_it);
        let constant = constant.ok_or_else(|| {
            let message =
                format!("the constant `{name}` has no type: write it down, as in `const {name}: f32`");
            Error::at(&place, message)
        })?;
        let value = value(module, constant.init).filter(|value| !value.rust_type().is_empty());
        let value =
            value.ok_or_else(|| Error::at(&place, format!("the constant `{name}` has no twin in Rust")))?;
        found.push(Constant { name: name.to_owned(), file: file.to_path_buf(), line, value });
    }
    Ok(found)
}

/// What a constant expression came to.
fn value(module: &Module, handle: Handle<Expression>) -> Option<Value> {
    match &module.global_expressions[handle] {
        Expression::Literal(literal) => Some(Value::Scalar(*literal)),
        Expression::Constant(other) => value(module, module.constants[*other].init),
        Expression::Compose { components, .. } => {
            components.iter().map(|part| value(module, *part)).collect::<Option<_>>().map(Value::Many)
        }
        Expression::Splat { size, value: part } => {
            Some(Value::Many(vec![value(module, *part)?; *size as usize]))
        }
        _ => None,
    }
}
