//! Computes points of the unscrambled Sobol sequence (Sobol 1967) with the direction numbers of Joe & Kuo 2008.
//!
//! Point `i` is the exclusive or of the direction numbers of the bits of the Gray code of `i`, so any point is computed alone.

use super::sobol_table::{Direction, TABLE};

/// Most dimensions: the first one, and those of the table.
pub const MOST_DIMENSIONS: usize = 1 + TABLE.len();
/// Bits of a coordinate, and logarithm of the number of points before they repeat.
const BITS: u32 = 30;

/// Coordinate `dimension` (below [`MOST_DIMENSIONS`]) of point `index` (below 2^30), at least 0 and below 1. Beyond both limits it is 0.
pub fn sobol(index: u32, dimension: usize) -> f64 {
    f64::from(digits(index, dimension)) / f64::from(1u32 << BITS)
}

/// The same with a digital shift: the binary digits of `shift`, at least 0 and below 1, are added to those of the coordinate without
/// carry, so that points stay as even and each is uniform. Above 0 and below 1.
pub(crate) fn shifted_sobol(index: u32, dimension: usize, shift: f64) -> f64 {
    let shift = (shift * f64::from(1u32 << BITS)) as u32;
    (f64::from(digits(index, dimension) ^ shift) + 0.5) / f64::from(1u32 << BITS)
}

/// The binary digits of a coordinate of a point, as a whole number.
fn digits(index: u32, dimension: usize) -> u32 {
    let numbers = if dimension == 0 {
        std::array::from_fn(|_| 1)
    } else {
        TABLE.get(dimension - 1).map_or([0; BITS as usize], direction_numbers)
    };
    let gray = index ^ (index >> 1);
    let bits = (0..BITS).filter(|bit| gray >> bit & 1 == 1).map(|bit| numbers[bit as usize] << (BITS - 1 - bit));
    bits.fold(0, |sum, bits| sum ^ bits)
}

/// All direction numbers of a dimension, by the recurrence of its primitive polynomial.
fn direction_numbers(given: &Direction) -> [u32; BITS as usize] {
    let mut numbers = [0; BITS as usize];
    let degree = given.first.len();
    numbers[..degree].copy_from_slice(given.first);
    for i in degree..BITS as usize {
        let mut number = numbers[i - degree] ^ (numbers[i - degree] << degree);
        for power in 1..degree {
            if given.polynomial >> (degree - power) & 1 == 1 {
                number ^= numbers[i - power] << power;
            }
        }
        numbers[i] = number;
    }
    numbers
}
