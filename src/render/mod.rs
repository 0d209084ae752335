//! placeholder
#[allow(missing_docs)] #[derive(Debug, thiserror::Error)] pub enum Error {}
