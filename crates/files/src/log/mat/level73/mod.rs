//! Variables of a MAT file v7.3, which is an HDF5 file: arrays are datasets, transposed; structs are groups, arrays of
//! structs groups of references.
//!
//! The HDF Group, HDF5 File Format Specification, version 3.0; the attributes are MATLAB's own.

mod metered;
mod stored;
#[cfg(test)]
mod tests;

use std::collections::HashMap;
use std::fs::File;
use std::path::Path;

use hdf5_pure::{AttrValue, DType, Dataset, Error, Group, Object};

use crate::error::FileError;
use crate::log::mat::damaged;
use crate::log::mat::level73::metered::Metered;
use crate::log::mat::level73::stored::check_stored;
use crate::log::mat::value::{Array, DEEPEST, Value, Variable, fields_of};
use crate::run::header::MOST_VALUES;

/// MATLAB's classes of arrays of numbers.
const NUMBERS: [&str; 11] = [
    "double", "single", "logical", "int8", "int16", "int32", "int64", "uint8", "uint16", "uint32",
    "uint64",
];

/// Attributes by their names.
type Attributes = HashMap<String, AttrValue>;

/// Why a value cannot be read.
type Reason = String;

/// The variables of a file, those of these sources, or all, with their values.
pub(super) fn variables(path: &Path, sources: Option<&[&str]>) -> Result<Vec<Variable>, FileError> {
    let file = File::open(path).map_err(FileError::cannot("open", path))?;
    let reader = Metered::of(file).map_err(told);
    let read = reader.and_then(|(reader, size)| {
        let file = hdf5_pure::File::from_source(reader).map_err(told)?;
        let declared = file.superblock().eof_address;
        if size < declared {
            return Err(format!("{size} of {declared} bytes"));
        }
        let mut tree = Tree {
            sources: sources
                .map(|sources| sources.iter().map(|source| fields_of(source)).collect()),
            size,
            left: MOST_VALUES,
        };
        tree.variables(&file.root())
    });
    read.map_err(|reason| damaged(path, &reason))
}

/// What the library says.
fn told(error: impl std::fmt::Display) -> Reason {
    error.to_string()
}

/// Variables while they are read.
struct Tree {
    /// The paths of the mapped arrays, without numbers of elements; none: all.
    sources: Option<Vec<String>>,
    /// Bytes of the file.
    size: u64,
    /// Numbers that may still be read.
    left: usize,
}

impl Tree {
    fn variables(&mut self, root: &Group) -> Result<Vec<Variable>, Reason> {
        let mut variables = Vec::new();
        for (name, dataset) in root.iter_datasets().map_err(told)? {
            let value = self.dataset(&dataset, &name);
            variables.push((name, self.unless_listed(value)?));
        }
        for (name, group) in root.iter_groups().map_err(told)? {
            // `#refs#` and `#subsystem#` are MATLAB's own
            if !name.starts_with('#') {
                let value = self.group(&group, &name, 0);
                variables.push((name, self.unless_listed(value)?));
            }
        }
        Ok(variables)
    }

    /// The value of a variable; where all are listed, none of a damaged one.
    fn unless_listed(&self, value: Result<Value, Reason>) -> Result<Option<Value>, Reason> {
        match (value, &self.sources) {
            (Err(_), None) => Ok(None),
            (value, _) => value.map(Some),
        }
    }

    /// Whether a mapped array is at this path or below it.
    fn is_mapped(&self, path: &str) -> bool {
        let is_below = |source: &String| {
            source
                .strip_prefix(path)
                .is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        let sources = self.sources.as_ref();
        sources.is_none_or(|sources| sources.iter().any(is_below))
    }

    fn object(&mut self, object: &Object, path: &str, depth: usize) -> Result<Value, Reason> {
        match object {
            Object::Dataset(dataset) => self.dataset(dataset, path),
            Object::Group(group) => self.group(group, path, depth),
            _ => Ok(Value::Other("an object")),
        }
    }

    /// A struct, or what else MATLAB keeps in groups.
    fn group(&mut self, group: &Group, path: &str, depth: usize) -> Result<Value, Reason> {
        if !path.contains('.') && !self.is_mapped(path) {
            return Ok(Value::Unread);
        }
        if depth > DEEPEST {
            return Err(format!("{path} is nested more than {DEEPEST} deep"));
        }
        let attributes = group.attrs().map_err(told)?;
        if attributes.contains_key("MATLAB_sparse") {
            return Ok(Value::Other("a sparse matrix"));
        }
        if is_object(&attributes) || class_of(&attributes).is_some_and(|class| class != "struct") {
            return Ok(Value::Other("an object"));
        }
        let mut fields = Vec::new();
        for (name, dataset) in group.iter_datasets().map_err(told)? {
            let path = format!("{path}.{name}");
            let elements = self.elements(&dataset, &path, depth)?;
            fields.push((name, elements));
        }
        for (name, inner) in group.iter_groups().map_err(told)? {
            let value = self.group(&inner, &format!("{path}.{name}"), depth + 1)?;
            fields.push((name, vec![value]));
        }
        Ok(Value::Struct(fields))
    }

    /// The values of a field: one, or one for each element of an array of structs.
    fn elements(
        &mut self,
        dataset: &Dataset,
        path: &str,
        depth: usize,
    ) -> Result<Vec<Value>, Reason> {
        let is_reference = dataset.dtype().map_err(told)? == DType::ObjectReference;
        // a cell array holds references, too, and says what it is
        if !is_reference || class_of(&dataset.attrs().map_err(told)?).is_some() {
            return Ok(vec![self.dataset(dataset, path)?]);
        }
        check_stored(dataset, path, self.size)?;
        let objects = dataset.dereference().map_err(told)?;
        let objects = objects.iter();
        objects
            .map(|object| self.object(object, path, depth + 1))
            .collect()
    }

    /// An array, if it is mapped, or what else MATLAB keeps in datasets.
    fn dataset(&mut self, dataset: &Dataset, path: &str) -> Result<Value, Reason> {
        if !path.contains('.') && !self.is_mapped(path) {
            return Ok(Value::Unread);
        }
        let attributes = dataset.attrs().map_err(told)?;
        let shape = dataset.shape().map_err(told)?;
        let is_empty = is_set(&attributes, "MATLAB_empty") || shape.contains(&0);
        match class_of(&attributes) {
            _ if is_object(&attributes) => Ok(Value::Other("an object")),
            Some("cell") => Ok(Value::Other("a cell array")),
            Some("char") => Ok(Value::Other("a text")),
            Some(class) if !NUMBERS.contains(&class) => Ok(Value::Other("an object")),
            _ if is_empty => Ok(Value::Other("nothing")),
            _ => self.numbers(dataset, path, &shape),
        }
    }

    fn numbers(&mut self, dataset: &Dataset, path: &str, shape: &[u64]) -> Result<Value, Reason> {
        let dtype = dataset.dtype().map_err(told)?;
        match dtype {
            DType::Compound(_) => return Ok(Value::Other("complex numbers")),
            DType::String | DType::VariableLengthString => return Ok(Value::Other("a text")),
            _ => {}
        }
        let sources = self.sources.as_ref();
        if sources.is_some_and(|sources| !sources.iter().any(|source| source == path)) {
            return Ok(Value::Unread);
        }
        let count = check_stored(dataset, path, self.size)?;
        let left = self.left.checked_sub(count);
        self.left = left.ok_or_else(|| format!("{path}: more than {MOST_VALUES} numbers"))?;
        let cannot = |error: Error| format!("{path}: {error}");
        let Some((values, integers)) = read(dataset, &dtype).map_err(cannot)? else {
            return Ok(Value::Other("no numbers"));
        };
        if values.len() != count {
            return Err(format!("{path}: {} numbers of {count}", values.len()));
        }
        // rows of an HDF5 dataset are columns of MATLAB
        let lengths = shape.iter().rev().filter(|&&length| length != 1);
        let lengths = lengths.map(|&length| usize::try_from(length));
        Ok(Value::Array(Array {
            shape: lengths.collect::<Result<_, _>>().map_err(told)?,
            values,
            integers,
        }))
    }
}

/// Numbers, and the same as integers where they are kept as such.
type Numbers = (Vec<f64>, Option<Vec<i64>>);

/// The numbers of a dataset; `None` of a type that holds none.
fn read(dataset: &Dataset, dtype: &DType) -> Result<Option<Numbers>, Error> {
    let integers = match dtype {
        DType::F32 | DType::F64 => return Ok(Some((dataset.read_f64()?, None))),
        DType::U64 => {
            let integers = dataset.read_u64()?.into_iter();
            let within = |integer: u64| i64::try_from(integer).unwrap_or(i64::MAX);
            integers.map(within).collect()
        }
        DType::I8 | DType::I16 | DType::I32 | DType::I64 => dataset.read_i64()?,
        DType::U8 | DType::U16 | DType::U32 => dataset.read_i64()?,
        _ => return Ok(None),
    };
    let values = integers.iter().map(|&integer| integer as f64).collect();
    Ok(Some((values, Some(integers))))
}

fn class_of(attributes: &Attributes) -> Option<&str> {
    attributes.get("MATLAB_class").and_then(AttrValue::as_str)
}

fn is_set(attributes: &Attributes, name: &str) -> bool {
    attributes
        .get(name)
        .and_then(AttrValue::as_i64)
        .is_some_and(|value| value != 0)
}

/// Whether a value is an object whose data lie elsewhere, in MATLAB's own form.
fn is_object(attributes: &Attributes) -> bool {
    is_set(attributes, "MATLAB_object_decode")
}
