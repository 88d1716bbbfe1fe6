//! Computes with eight numbers at a time, one of each posture of a block.
//!
//! Every operation is the same sequence of IEEE additions and multiplications in each lane, never a fused one, so that a lane has the
//! same bits in registers of two, four or eight numbers, and whatever the other lanes hold.

#![allow(clippy::needless_range_loop, reason = "loops over indices of arrays of one length become one instruction")]

use std::ops::{Add, AddAssign, Mul, Neg, Sub};

/// Postures in a block.
pub(super) const LANES: usize = 8;

/// One number of each posture of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub(super) struct Lanes(pub(super) [f64; LANES]);

macro_rules! operation {
    ($operation:ident, $function:ident, $sign:tt) => {
        impl $operation for Lanes {
            type Output = Self;
            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                let mut result = [0.0; LANES];
                for i in 0..LANES {
                    result[i] = self.0[i] $sign other.0[i];
                }
                Self(result)
            }
        }

        impl $operation<f64> for Lanes {
            type Output = Self;
            #[inline(always)]
            fn $function(self, other: f64) -> Self {
                self $sign Self::all(other)
            }
        }
    };
}

operation!(Add, add, +);
operation!(Sub, sub, -);
operation!(Mul, mul, *);

impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|x| -x)
    }
}

impl AddAssign for Lanes {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Lanes {
    pub(super) const ZERO: Self = Self([0.0; LANES]);
    pub(super) const ONE: Self = Self([1.0; LANES]);

    /// The same number in every lane.
    #[inline(always)]
    pub(super) fn all(number: f64) -> Self {
        Self([number; LANES])
    }

    /// `function` of every lane.
    #[inline(always)]
    pub(super) fn map(self, function: impl Fn(f64) -> f64) -> Self {
        let mut result = [0.0; LANES];
        for i in 0..LANES {
            result[i] = function(self.0[i]);
        }
        Self(result)
    }

    /// Whether `condition` holds in every lane.
    #[inline(always)]
    pub(super) fn every(self, condition: impl Fn(f64) -> bool) -> bool {
        let mut held = true;
        for i in 0..LANES {
            held &= condition(self.0[i]);
        }
        held
    }
}

/// A vector of each posture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vectors(pub(super) [Lanes; 3]);

impl Add for Vectors {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a + x, b + y, c + z])
    }
}

impl Sub for Vectors {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a - x, b - y, c - z])
    }
}

impl Mul<Lanes> for Vectors {
    type Output = Self;
    #[inline(always)]
    fn mul(self, by: Lanes) -> Self {
        let [a, b, c] = self.0;
        Self([a * by, b * by, c * by])
    }
}

impl Mul<f64> for Vectors {
    type Output = Self;
    #[inline(always)]
    fn mul(self, by: f64) -> Self {
        let [a, b, c] = self.0;
        Self([a * by, b * by, c * by])
    }
}

impl Vectors {
    pub(super) const ZERO: Self = Self([Lanes::ZERO; 3]);

    /// The same vector in every posture.
    #[inline(always)]
    pub(super) fn all([x, y, z]: [f64; 3]) -> Self {
        Self([Lanes::all(x), Lanes::all(y), Lanes::all(z)])
    }

    #[inline(always)]
    pub(super) fn dot(self, other: Self) -> Lanes {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        a * x + b * y + c * z
    }

    /// The dot product with a vector that is the same in every posture.
    #[inline(always)]
    pub(super) fn dot_all(self, [x, y, z]: [f64; 3]) -> Lanes {
        let [a, b, c] = self.0;
        a * x + b * y + c * z
    }

    #[inline(always)]
    pub(super) fn cross(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([b * z - c * y, c * x - a * z, a * y - b * x])
    }

    /// The cross product with a vector that is the same in every posture.
    #[inline(always)]
    pub(super) fn cross_all(self, [x, y, z]: [f64; 3]) -> Self {
        let [a, b, c] = self.0;
        Self([b * z - c * y, c * x - a * z, a * y - b * x])
    }
}

/// A rotation or another matrix of each posture, by its columns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rotations(pub(super) [Vectors; 3]);

impl Rotations {
    pub(super) const IDENTITY: Self = Self([
        Vectors([Lanes::ONE, Lanes::ZERO, Lanes::ZERO]),
        Vectors([Lanes::ZERO, Lanes::ONE, Lanes::ZERO]),
        Vectors([Lanes::ZERO, Lanes::ZERO, Lanes::ONE]),
    ]);

    pub(super) const ZERO: Self = Self([Vectors::ZERO; 3]);

    #[inline(always)]
    pub(super) fn plus(&self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a + x, b + y, c + z])
    }

    #[inline(always)]
    pub(super) fn trace(&self) -> Lanes {
        let [x, y, z] = self.0;
        x.0[0] + y.0[1] + z.0[2]
    }

    /// The product with a vector.
    #[inline(always)]
    pub(super) fn turn(&self, vector: Vectors) -> Vectors {
        let ([a, b, c], [x, y, z]) = (self.0, vector.0);
        a * x + b * y + c * z
    }

    /// The rotated vector, which is the same in every posture before.
    #[inline(always)]
    pub(super) fn turn_all(&self, [x, y, z]: [f64; 3]) -> Vectors {
        self.0[0] * x + self.0[1] * y + self.0[2] * z
    }

    /// The product with a rotation, given by its columns, that is the same in every posture.
    #[inline(always)]
    pub(super) fn times_all(&self, columns: [[f64; 3]; 3]) -> Self {
        Self([self.turn_all(columns[0]), self.turn_all(columns[1]), self.turn_all(columns[2])])
    }

    #[inline(always)]
    pub(super) fn times(&self, other: Self) -> Self {
        let [x, y, z] = other.0;
        Self([self.turn(x), self.turn(y), self.turn(z)])
    }
}
