//! Reads numbers of the three kinds of computers that C3D files come from.

/// Kind of computer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Processor {
    /// Little-endian, IEEE 754.
    Intel,
    /// Little-endian words; floats of VAX and PDP-11 (F_floating).
    Dec,
    /// Big-endian, IEEE 754.
    Mips,
}

impl Processor {
    /// The kind that the fourth byte of the parameters says.
    pub(super) fn of(byte: u8) -> Option<Self> {
        match byte {
            84 => Some(Self::Intel),
            85 => Some(Self::Dec),
            86 => Some(Self::Mips),
            _ => None,
        }
    }

    /// A number of 16 bits, without a sign.
    pub(super) fn word(self, bytes: [u8; 2]) -> u16 {
        match self {
            Self::Mips => u16::from_be_bytes(bytes),
            Self::Intel | Self::Dec => u16::from_le_bytes(bytes),
        }
    }

    /// A real of 32 bits.
    pub(super) fn float(self, [a, b, c, d]: [u8; 4]) -> f64 {
        match self {
            Self::Intel => f32::from_le_bytes([a, b, c, d]).into(),
            Self::Mips => f32::from_be_bytes([a, b, c, d]).into(),
            Self::Dec => f_floating(u32::from_be_bytes([b, a, d, c])),
        }
    }
}

/// The value of a VAX F_floating: a sign, 8 bits of exponent `e`, 23 bits of fraction `f`: `(1/2 + f / 2^24) 2^(e - 128)`, 0 for `e = 0`; with a sign that is no number
/// (VAX Architecture Reference Manual).
fn f_floating(bits: u32) -> f64 {
    /// Exponent of an f64 of the same value, less that of the F_floating: 1023 for 1, which is 129 there.
    const MORE: u64 = 1023 - 129;
    let (sign, exponent, fraction) = (u64::from(bits >> 31), u64::from(bits >> 23 & 0xff), u64::from(bits & 0x7f_ffff));
    match (exponent, sign) {
        (0, 0) => 0.0,
        (0, _) => f64::NAN,
        _ => f64::from_bits(sign << 63 | (exponent + MORE) << 52 | fraction << 29),
    }
}

#[cfg(test)]
mod tests {
    use super::Processor;

    #[test]
    fn one_and_minus_two_and_a_half_are_the_same_everywhere() {
        // VAX F_floating of 1.0 is 0x00004080, of -2.5 0x0000c120 (VAX Architecture Reference Manual).
        for (kind, one, other) in [
            (Processor::Intel, [0, 0, 0x80, 0x3f], [0, 0, 0x20, 0xc0]),
            (Processor::Mips, [0x3f, 0x80, 0, 0], [0xc0, 0x20, 0, 0]),
            (Processor::Dec, [0x80, 0x40, 0, 0], [0x20, 0xc1, 0, 0]),
        ] {
            assert_eq!((kind.float(one), kind.float(other)), (1.0, -2.5), "{kind:?}");
            assert_eq!(kind.float([0; 4]), 0.0);
        }
        assert_eq!((Processor::Mips.word([1, 2]), Processor::Dec.word([1, 2])), (258, 513));
    }

    #[test]
    fn every_exponent_of_a_vax_has_its_power_of_two() {
        for exponent in 1..256_i32 {
            let bits = (exponent as u32) << 23 | 0x40_0001;
            let [a, b, c, d] = bits.to_be_bytes();
            let wanted = (0.75 + 0.5_f64.powi(24)) * 2_f64.powi(exponent - 128);
            assert_eq!(Processor::Dec.float([b, a, d, c]), wanted, "{exponent}");
        }
        assert!(Processor::Dec.float([0, 0x80, 0, 0]).is_nan());
    }
}
