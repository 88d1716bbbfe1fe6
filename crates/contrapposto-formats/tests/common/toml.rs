//! Mutants of TOML files: bytes, lines and above all numbers changed, so that most of them get past the parser.

use super::{hammer_mutants, next};

/// Texts that strangers write instead of a number.
pub const ODD: [&str; 22] = [
    "nan",
    "-inf",
    "inf",
    "1e999",
    "1e308",
    "-1e308",
    "1e300",
    "1e150",
    "1e16",
    "-0.0",
    "0",
    "5e-324",
    "1e-300",
    "-1",
    "0.5",
    "1",
    "9223372036854775807",
    "-9223372036854775808",
    "99999999999999999999",
    "0x7fff",
    "\"1\"",
    "[]",
];

fn mutated(texts: &[String], state: &mut u64) -> Vec<u8> {
    let mut bytes = texts[next(state) % texts.len()].clone().into_bytes();
    for _ in 0..1 + next(state) % 3 {
        if bytes.is_empty() {
            break;
        }
        let at = next(state) % bytes.len();
        match next(state) % 16 {
            0 => bytes[at] = next(state) as u8,
            1 => drop(bytes.remove(at)),
            2 => bytes.insert(at, next(state) as u8),
            3 => bytes.truncate(at),
            4 => {
                let other = texts[next(state) % texts.len()].as_bytes();
                let from = next(state) % other.len();
                let to = other.len().min(from + 1 + next(state) % 80);
                bytes.splice(at..at, other[from..to].iter().copied());
            }
            5 => {
                let to = bytes.len().min(at + 1 + next(state) % 60);
                bytes.drain(at..to);
            }
            6 => {
                let lines: Vec<&[u8]> = bytes.split(|&b| b == b'\n').collect();
                let (one, two) = (next(state) % lines.len(), next(state) % lines.len());
                let mut lines = lines;
                lines.swap(one, two);
                bytes = lines.join(&b'\n');
            }
            // Numbers are what gets through: most mutants change one.
            _ => {
                let numbers = numbers(&bytes);
                if let Some(&(from, to)) = numbers.get(next(state) % numbers.len().max(1)) {
                    let odd = if next(state).is_multiple_of(2) {
                        ODD[next(state) % ODD.len()].to_owned()
                    } else {
                        let text = String::from_utf8_lossy(&bytes[from..to]);
                        let value: f64 = text.parse().unwrap_or(1.0);
                        format!("{:?}", value * libm::pow(10.0, next(state) as f64 / f64::from(1 << 30) * 3.0 - 3.0))
                    };
                    bytes.splice(from..to, odd.into_bytes());
                }
            }
        }
    }
    bytes
}

/// Places of the numbers: what stands after a space or a bracket and begins with a digit, a sign or a point.
pub fn numbers(bytes: &[u8]) -> Vec<(usize, usize)> {
    let part = |b: u8| b.is_ascii_digit() || matches!(b, b'.' | b'-' | b'+' | b'e');
    let mut found = vec![];
    let mut at = 0;
    while at < bytes.len() {
        let starts = bytes[at].is_ascii_digit() || bytes[at] == b'-';
        if starts && (at == 0 || matches!(bytes[at - 1], b' ' | b'[')) {
            let end = (at..bytes.len()).find(|&i| !part(bytes[i])).unwrap_or(bytes.len());
            found.push((at, end));
            at = end;
        }
        at += 1;
    }
    found
}

/// Reads mutants of `texts`; as [`super::hammer`] otherwise.
pub fn hammer_toml(format: &str, seed: u64, usual: usize, texts: &[String], read: impl FnMut(&[u8]) -> bool) {
    hammer_mutants(format, seed, usual, |_, state| mutated(texts, state), read);
}
