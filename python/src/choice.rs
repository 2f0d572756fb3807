//! Values of serde types as Python writes them: enumerations by their names, structures as dicts
//! and lists.

use frfid_files::Overwrite;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

/// The value called `name`; `ValueError` names the argument and what it may be.
pub(crate) fn choice<T: DeserializeOwned>(argument: &str, name: &str) -> PyResult<T> {
    from_json(argument, name)
}

/// Whether what is in a folder is replaced, or goes on.
pub(crate) fn resume_unless(replaces: bool) -> Overwrite {
    if replaces {
        Overwrite::Replace
    } else {
        Overwrite::Resume
    }
}

/// A value as strings, numbers, lists and dicts.
pub(crate) fn to_python<'py, T: Serialize>(
    py: Python<'py>,
    value: &T,
) -> PyResult<Bound<'py, PyAny>> {
    let json =
        serde_json::to_string(value).map_err(|error| PyValueError::new_err(error.to_string()))?;
    py.import("json")?.call_method1("loads", (json,))
}

/// A value from strings, numbers, lists and dicts; `ValueError` names the argument.
pub(crate) fn from_python<T: DeserializeOwned>(
    argument: &str,
    value: &Bound<'_, PyAny>,
) -> PyResult<T> {
    from_json(argument, json_value(argument, value)?)
}

/// Strings, numbers, lists and dicts as JSON, which knows no NaN; `ValueError` names the argument.
pub(crate) fn json_value(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<Value> {
    if let Ok(number) = value.extract::<f64>()
        && !number.is_finite()
    {
        return Err(PyValueError::new_err(format!(
            "{argument} is {number}, needed: a finite number"
        )));
    }
    let dumps = value.py().import("json")?.getattr("dumps")?;
    let json: String = dumps.call1((value,))?.extract()?;
    serde_json::from_str(&json)
        .map_err(|error| PyValueError::new_err(format!("{argument}: {error}")))
}

/// A structure as a JSON object.
pub(crate) fn json_object<T: Serialize>(value: &T) -> PyResult<Map<String, Value>> {
    match serde_json::to_value(value) {
        Ok(Value::Object(object)) => Ok(object),
        other => unreachable!("a structure is an object in JSON: {other:?}"),
    }
}

/// A value from JSON; `ValueError` names the argument and the place in it.
pub(crate) fn from_json<T: DeserializeOwned>(
    argument: &str,
    json: impl Into<Value>,
) -> PyResult<T> {
    serde_path_to_error::deserialize(json.into()).map_err(|error| {
        let place = match error.path().to_string().as_str() {
            "." => argument.to_owned(),
            path if path.starts_with('[') => format!("{argument}{path}"),
            path => format!("{argument}.{path}"),
        };
        PyValueError::new_err(format!("{place}: {}", error.inner()))
    })
}

/// What is done with a file that exists.
pub(crate) fn overwrite_if(replace: bool) -> Overwrite {
    if replace {
        Overwrite::Replace
    } else {
        Overwrite::Refuse
    }
}
