//! Reasons for which a table holds no ground reactions.

use contrapposto::math::SplineError;

use crate::input_error::InputError;

/// The reason for which a table holds no ground reactions of the model.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GroundReactionError {
    /// The file is no table.
    #[error(transparent)]
    Table(#[from] InputError),
    /// No column is the force of a plate.
    #[error(
        "{table}: no column is named like `ground_force_vx` (with ground_force_px and, if wanted, ground_torque_x)"
    )]
    NoPlates {
        /// Name of the table.
        table: String,
    },
    /// A column that must stand beside another one does not.
    #[error("{table}: there is `{label}`, but no `{missing}`")]
    Column {
        /// Name of the table.
        table: String,
        /// The column that is there.
        label: String,
        /// The column that is not.
        missing: String,
    },
    /// A column that an ExternalLoads file names is not there.
    #[error("{table}: there is no column `{missing}`, which the ExternalLoads file names")]
    Named {
        /// Name of the table.
        table: String,
        /// The column.
        missing: String,
    },
    /// Not as many segments are given as the table has plates.
    #[error("names {given} segments; {table} has {} ground reactions ({})", plates.len(), plates.join(", "))]
    Count {
        /// Name of the table.
        table: String,
        /// Number of segments given.
        given: usize,
        /// First column of every plate.
        plates: Vec<String>,
    },
    /// A given segment is not in the model.
    #[error("{0}")]
    Segment(String),
    /// The segment of a plate follows neither from what is given nor from the label.
    #[error("{table}: the segment that `{label}` acts on is not known: name one segment a plate")]
    Unknown {
        /// Name of the table.
        table: String,
        /// First column of the plate.
        label: String,
    },
    /// No spline goes through the rows.
    #[error("{table}: no splines between its rows: {why}")]
    Spline {
        /// Name of the table.
        table: String,
        /// The reason.
        why: SplineError,
    },
    /// The table has no rows.
    #[error("{table}: holds no rows")]
    Empty {
        /// Name of the table.
        table: String,
    },
    /// A time lies outside of the table.
    #[error(
        "frame {frame} at {time} s has no ground reaction: {table} goes from {first} s to {last} s; --from {first} --to {last} leaves the \
         other frames out"
    )]
    Outside {
        /// Name of the table.
        table: String,
        /// Number of the frame, counted from 0.
        frame: usize,
        /// Time of the row, s.
        time: f64,
        /// First time of the table, s.
        first: f64,
        /// Last time of the table, s.
        last: f64,
    },
}
