//! Copies arrays of Python into rows, whatever their layout, and hands rows over as arrays.

use numpy::ndarray::{Array2, Array3};
use numpy::{PyArray2, PyArray3, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::errors::internal;

/// The rows of an array, copied: Fortran order, steps between columns and reversed axes give the same rows.
pub(crate) fn rows_of(array: &PyReadonlyArray2<'_, f64>) -> (usize, usize, Vec<f64>) {
    let (rows, columns) = (array.shape()[0], array.shape()[1]);
    // The view's `as_slice` gives only memory that lies row after row; that of `array` would give Fortran order as it lies, too.
    let view = array.as_array();
    (rows, columns, view.as_slice().map_or_else(|| view.iter().copied().collect(), <[f64]>::to_vec))
}

/// An array that owns `values`, row after row.
pub(crate) fn array_2(
    py: Python<'_>,
    (rows, columns): (usize, usize),
    values: Vec<f64>,
) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let array = Array2::from_shape_vec((rows, columns), values).map_err(|error| internal(py, &error.to_string()))?;
    Ok(PyArray2::from_owned_array(py, array))
}

/// An array of square matrices that owns `values`.
pub(crate) fn array_3(
    py: Python<'_>,
    (matrices, size): (usize, usize),
    values: Vec<f64>,
) -> PyResult<Bound<'_, PyArray3<f64>>> {
    let array = Array3::from_shape_vec((matrices, size, size), values);
    Ok(PyArray3::from_owned_array(py, array.map_err(|error| internal(py, &error.to_string()))?))
}
