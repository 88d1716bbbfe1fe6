//! Dense linear algebra for small problems.

mod vector;

pub use vector::{
    add_fours, add_scaled, add_scaled_fours, add_scaled_pair, add_square, add_squares, dot, dot_pair, norm,
    norm_and_count,
};
