//! Errors of the library as exceptions that carry the way out.

use gaitway::scenario;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// What goes wrong below Python, before it is an exception: worker threads know no interpreter.
#[derive(Debug)]
pub(crate) struct Fault {
    message: String,
    hint: Option<String>,
    is_bad_value: bool,
}

pub(crate) type Result<T> = std::result::Result<T, Fault>;

impl Fault {
    /// A value that is not allowed.
    pub(crate) fn value(message: impl Into<String>, hint: impl Into<String>) -> Self {
        Self { message: message.into(), hint: Some(hint.into()), is_bad_value: true }
    }

    /// Something that cannot be done.
    pub(crate) fn failed(message: impl Into<String>, hint: impl Into<String>) -> Self {
        Self { message: message.into(), hint: Some(hint.into()), is_bad_value: false }
    }
}

impl<E: Into<gaitway::Error>> From<E> for Fault {
    fn from(error: E) -> Self {
        let error = error.into();
        Self {
            hint: error.hint().or_else(|| hint_of(&error)).map(str::to_owned),
            is_bad_value: is_bad_value(&error),
            message: error.to_string(),
        }
    }
}

/// Ways out that messages of the library already end in.
fn hint_of(error: &gaitway::Error) -> Option<&str> {
    match error {
        gaitway::Error::Scenario(scenario::Error::Value(bad)) => Some(&bad.hint),
        gaitway::Error::Scenario(scenario::Error::Populate { hint, .. }) => Some(hint),
        _ => None,
    }
}

/// Whether the caller gave something that does not do, in an argument or in a file.
fn is_bad_value(error: &gaitway::Error) -> bool {
    use gaitway::sim::Error as Sim;
    match error {
        gaitway::Error::Scenario(error) => !matches!(error, scenario::Error::Read { .. }),
        gaitway::Error::Sim(error) => matches!(error, Sim::NotLed { .. } | Sim::Lead { .. }),
        gaitway::Error::Scene(_) | gaitway::Error::Usage { .. } | gaitway::Error::Statistics(_) => true,
        _ => false,
    }
}

impl From<Fault> for PyErr {
    fn from(fault: Fault) -> Self {
        Python::attach(|py| {
            let name = if fault.is_bad_value { "BadValue" } else { "Error" };
            let made = py.import("gaitway._errors").and_then(|module| {
                module.getattr(name)?.call1((fault.message.as_str(), fault.hint.as_deref()))
            });
            match made {
                Ok(exception) => Self::from_value(exception),
                Err(_) => PyRuntimeError::new_err(fault.message),
            }
        })
    }
}
