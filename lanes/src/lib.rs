#![doc = include_str!("../README.md")]
#![allow(
    unsafe_code,
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    clippy::float_cmp,
    clippy::missing_safety_doc,
    reason = "words of vectors, which are reinterpreted and converted as a shader does, by instructions that the module names"
)]

#[cfg(feature = "generate")]
pub mod generate;
pub mod vector;
mod words;

pub use vector::Isa;
pub use words::Words;
