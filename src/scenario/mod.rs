//! placeholder
pub mod crowd;
#[allow(missing_docs)] #[derive(Debug, thiserror::Error)] pub enum Error {}
