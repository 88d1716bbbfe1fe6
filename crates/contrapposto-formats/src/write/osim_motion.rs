//! Writes a motion of the model that [`super::osim`] writes.

use contrapposto::model::{CoordinateKind, Model};
use nalgebra::{Quaternion, UnitQuaternion};

use super::osim::Writer;
use crate::animation::zyx;
use crate::motion::{UnwritableTable, plain, write_sto};

/// A column of the table.
struct Column {
    label: String,
    kind: CoordinateKind,
    from: From,
}

/// Source of a column's numbers.
#[derive(Clone, Copy)]
enum From {
    Coordinate(usize),
    /// An angle of the ball with this first coordinate.
    Ball(usize, usize),
}

/// A `.mot` table that plays the file of [`super::osim`] in OpenSim: postures `rows` (rad, m) of `model` at `times` (s).
///
/// Every coordinate has the column that our own readers look for. Besides, what has another name in the model file has a second
/// column of that name: balls their three angles, and coordinates whose names OpenSim cannot have. Coordinates that follow
/// another one are computed from it. Angles are in degrees, as the header says, unless OpenSim takes some coordinate to be no
/// angle, or the other way round: then everything is in radians.
///
/// # Errors
/// [`UnwritableTable`] if the table could not be read back.
pub fn osim_motion<R: AsRef<[f64]>>(
    model: &Model,
    title: &str,
    times: &[f64],
    rows: &[R],
) -> Result<String, UnwritableTable> {
    let (columns, in_degrees) = columns(model);
    let mut angles = vec![[0.0; 3]; model.coordinates().len()];
    let mut filled: Vec<Vec<f64>> = vec![];
    for (row, values) in rows.iter().enumerate() {
        let mut values = values.as_ref().to_vec();
        let (found, needed) = (values.len(), model.coordinates().len());
        if found != needed {
            return Err(UnwritableTable::Ragged { row, found, needed });
        }
        for coupling in model.couplings() {
            values[coupling.dependent] = coupling.function.value(values[coupling.independent]);
        }
        for column in &columns {
            if let From::Ball(first, 0) = column.from {
                let [w, i, j, k] = [0, 1, 2, 3].map(|part| values[first + part]);
                let turn = UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k)).to_rotation_matrix();
                // About x, then y, then z: turned back that is about z, then y, then x.
                let [x, y, z] = angles[first].map(|angle: f64| -angle);
                let [z, y, x] = zyx(&turn.matrix().transpose(), [z, y, x]);
                angles[first] = [-x, -y, -z];
            }
        }
        let value = |column: &Column| match column.from {
            From::Coordinate(i) => values[i],
            From::Ball(first, axis) => angles[first][axis],
        };
        filled.push(columns.iter().map(value).collect());
    }
    let labels: Vec<_> = columns.iter().map(|column| (column.label.as_str(), column.kind)).collect();
    write_sto(title, &labels, in_degrees, times, &filled)
}

/// The columns, and whether angles are in degrees. Of a model that has no `.osim` file our own columns, in degrees.
fn columns(model: &Model) -> (Vec<Column>, bool) {
    let coordinates = model.coordinates();
    let own = |i: usize| Column {
        label: plain(&coordinates[i].name, false),
        kind: coordinates[i].kind,
        from: From::Coordinate(i),
    };
    let mut columns: Vec<Column> = (0..coordinates.len()).map(own).collect();
    let Ok(writer) = Writer::new(model, &mut vec![]) else { return (columns, true) };
    let mut in_degrees = true;
    for (i, (name, degrees)) in writer.coordinates.iter().enumerate() {
        if coordinates[i].kind == CoordinateKind::Quaternion {
            continue;
        }
        in_degrees &= *degrees == (coordinates[i].kind == CoordinateKind::Rotation);
        if *name != columns[i].label {
            columns.push(Column { label: name.clone(), ..own(i) });
        }
    }
    for first in writer.pieces.iter().flat_map(|(pieces, _)| pieces).filter_map(|piece| piece.ball) {
        columns.extend([0, 1, 2].map(|axis| Column {
            label: writer.coordinates[first + axis].0.clone(),
            kind: CoordinateKind::Rotation,
            from: From::Ball(first, axis),
        }));
    }
    (columns, in_degrees)
}
