//! Computes random numbers that are a function of a seed, a stream and a place in it (SplitMix64: Steele, Lea & Flood 2014,
//! OOPSLA, recalled; the test of uniformity is ours).

/// Odd constant between two states: 2^64 over the golden ratio.
const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

fn mixed(mut bits: u64) -> u64 {
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

/// A number above 0 and below 1.
pub(crate) fn uniform(seed: u32, stream: usize, place: usize) -> f64 {
    let start = mixed(u64::from(seed).wrapping_mul(STEP) ^ mixed((stream as u64).wrapping_add(1).wrapping_mul(STEP)));
    let bits = mixed(start.wrapping_add((place as u64).wrapping_add(1).wrapping_mul(STEP)));
    ((bits >> 12) as f64 + 0.5) / (1u64 << 52) as f64
}

/// The numbers 0 to `count - 1` in random order (Fisher & Yates).
pub(crate) fn permutation(seed: u32, stream: usize, count: usize) -> Vec<u32> {
    let mut order: Vec<u32> = (0..count as u32).collect();
    for last in (1..count).rev() {
        let chosen = (uniform(seed, stream, last) * (last + 1) as f64) as usize;
        order.swap(last, chosen.min(last));
    }
    order
}

#[cfg(test)]
mod tests {
    use super::{permutation, uniform};

    #[test]
    fn a_hundred_thousand_numbers_have_the_moments_of_a_uniform_distribution_and_streams_are_uncorrelated() {
        let count = 100_000;
        let mean = |value: &dyn Fn(usize) -> f64| (0..count).map(value).sum::<f64>() / count as f64;
        for (seed, stream) in [(0, 0), (1, 0), (1, 1), (4_000_000_000, 63)] {
            let u = |place: usize| uniform(seed, stream, place) - 0.5;
            // Five standard errors.
            assert!(mean(&u).abs() < 5.0 * (1.0 / 12.0 / count as f64).sqrt());
            assert!((mean(&|i| u(i).powi(2)) - 1.0 / 12.0).abs() < 5.0 * (1.0 / 180.0 / count as f64).sqrt());
            for other in [uniform(seed, stream + 1, 0), uniform(seed.wrapping_add(1), stream, 0)] {
                assert_ne!(other, uniform(seed, stream, 0));
            }
            for product in [
                mean(&|i| u(i) * u(i + 1)),
                mean(&|i| u(i) * (uniform(seed, stream + 1, i) - 0.5)),
                mean(&|i| u(i) * (uniform(seed.wrapping_add(1), stream, i) - 0.5)),
            ] {
                assert!(product.abs() < 5.0 / 12.0 / (count as f64).sqrt(), "{product}");
            }
        }
    }

    #[test]
    fn a_permutation_has_every_number_once_and_every_place_is_equally_likely() {
        let mut counts = [[0u32; 5]; 5];
        for seed in 0..5000 {
            let order = permutation(seed, 2, 5);
            let mut sorted = order.clone();
            sorted.sort_unstable();
            assert_eq!(sorted, [0, 1, 2, 3, 4]);
            order.iter().enumerate().for_each(|(place, number)| counts[place][*number as usize] += 1);
        }
        for count in counts.into_iter().flatten() {
            assert!((f64::from(count) - 1000.0).abs() < 5.0 * 800f64.sqrt(), "{counts:?}");
        }
    }
}
