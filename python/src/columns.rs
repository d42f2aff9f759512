//! Conversion of the numbers of many equally structured items from JSON into one array for each name.

use numpy::ndarray::{ArrayD, IxDyn};
use numpy::{IntoPyArray, PyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::Value;

use crate::errors;

/// Arrays by name, one for each number of an item; NaN where an item lacks the number.
pub(crate) struct Columns {
    items: Vec<usize>,
    found: Vec<(String, Column)>,
}

/// Numbers of one name for all items.
struct Column {
    /// Shape of the numbers of one item.
    shape: Vec<usize>,
    values: Vec<f64>,
}

impl Columns {
    /// Creates columns for items in an array of this shape.
    pub(crate) fn new(items: &[usize]) -> Self {
        Self { items: items.to_vec(), found: Vec::new() }
    }

    /// Adds the numbers of an item; those of nested objects have names `outer.inner`. Strings and booleans are skipped.
    pub(crate) fn add(&mut self, item: usize, name: &str, value: &Value) {
        match value {
            Value::Object(keys) => keys.iter().for_each(|(key, value)| match name {
                "" => self.add(item, key, value),
                _ => self.add(item, &format!("{name}.{key}"), value),
            }),
            Value::Null if name.is_empty() => {}
            Value::String(_) | Value::Bool(_) => {}
            Value::Null | Value::Number(_) | Value::Array(_) => {
                let shape = shape(value);
                if shape.iter().all(|length| *length > 0) {
                    self.put(item, name, &shape, value);
                }
            }
        }
    }

    fn put(&mut self, item: usize, name: &str, shape: &[usize], value: &Value) {
        let at = self.found.iter().position(|(known, _)| known == name).unwrap_or(self.found.len());
        if at == self.found.len() {
            self.found.push((name.to_owned(), Column { shape: Vec::new(), values: Vec::new() }));
        }
        let column = &mut self.found[at].1;
        // A null does not determine the shape; the first number does.
        if column.values.is_empty() || column.shape.len() < shape.len() {
            column.shape = shape.to_vec();
            let all = self.items.iter().chain(shape).product();
            column.values = vec![f64::NAN; all];
        }
        let size = column.shape.iter().product::<usize>();
        if let Some(place) = column.values.get_mut(item * size..(item + 1) * size) {
            fill(place, &column.shape, value);
        }
    }

    /// Converts the columns to a dictionary of names and arrays.
    pub(crate) fn into_dict(self, py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let dict = PyDict::new(py);
        for (name, column) in self.found {
            let shape: Vec<usize> = self.items.iter().chain(&column.shape).copied().collect();
            dict.set_item(name, array(py, &shape, column.values)?)?;
        }
        Ok(dict)
    }
}

/// Creates a numpy array that owns the values.
pub(crate) fn array<'py>(
    py: Python<'py>,
    shape: &[usize],
    values: Vec<f64>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let array = ArrayD::from_shape_vec(IxDyn(shape), values);
    Ok(array.map_err(|error| errors::internal(&error.to_string()))?.into_pyarray(py))
}

/// Shape of nested arrays, from the deepest item.
fn shape(value: &Value) -> Vec<usize> {
    let Value::Array(items) = value else { return Vec::new() };
    let inner = items.iter().map(shape).max_by_key(Vec::len).unwrap_or_default();
    [vec![items.len()], inner].concat()
}

/// Copies the numbers of nested arrays in order; places without a number are not changed.
fn fill(place: &mut [f64], shape: &[usize], value: &Value) {
    match (value, shape) {
        (Value::Number(number), []) => place.fill(number.as_f64().unwrap_or(f64::NAN)),
        (Value::Array(items), [_, inner @ ..]) => {
            let size = inner.iter().product::<usize>();
            items.iter().zip(place.chunks_mut(size)).for_each(|(item, place)| fill(place, inner, item));
        }
        _ => {}
    }
}
