//! Writes C3D files for tests: numbers of three kinds of computers, by arithmetic.

/// Kind of computer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Intel,
    Dec,
    Mips,
}

impl Kind {
    pub(crate) const ALL: [Self; 3] = [Self::Intel, Self::Dec, Self::Mips];

    fn word(self, number: u16) -> [u8; 2] {
        let (high, low) = ((number / 256) as u8, (number % 256) as u8);
        if self == Self::Mips { [high, low] } else { [low, high] }
    }

    fn real(self, value: f64) -> [u8; 4] {
        match self {
            Self::Intel => (value as f32).to_le_bytes(),
            Self::Mips => (value as f32).to_be_bytes(),
            Self::Dec => vax(value),
        }
    }
}

/// F_floating: sign, exponent above 128, and the fraction after its first bit, which is one half; the word with the sign stands first, each word with
/// its low byte first.
fn vax(value: f64) -> [u8; 4] {
    if value == 0.0 {
        return [0; 4];
    }
    let (mut fraction, mut exponent) = (value.abs(), 128_u32);
    while fraction >= 1.0 {
        fraction /= 2.0;
        exponent += 1;
    }
    while fraction < 0.5 {
        fraction *= 2.0;
        exponent -= 1;
    }
    let fraction = ((fraction - 0.5) * 16_777_216.0) as u32;
    let first = u32::from(value < 0.0) * 32_768 + exponent * 128 + fraction / 65_536;
    let second = fraction % 65_536;
    [first % 256, first / 256, second % 256, second / 256].map(|byte| byte as u8)
}

/// A trial that is written. `scale`: of integers; reals for a negative one. Points: x, y, z and residual, in the file's unit.
#[derive(Clone)]
pub(crate) struct Trial {
    pub(crate) kind: Kind,
    pub(crate) scale: f64,
    pub(crate) rate: f64,
    pub(crate) unit: &'static str,
    pub(crate) labels: Vec<String>,
    /// First and last frame in the header.
    pub(crate) ends: (u16, u16),
    /// Further parameters of numbers: group (1 POINT, 2 TRIAL, 3 ANALOG), name, words.
    pub(crate) words: Vec<(i8, &'static str, Vec<u16>)>,
    /// Further parameters of reals: group (4 FORCE_PLATFORM, too), name, dimensions, numbers.
    pub(crate) reals: Vec<(i8, &'static str, Vec<usize>, Vec<f64>)>,
    /// Further parameters of integers with dimensions.
    pub(crate) integers: Vec<(i8, &'static str, Vec<usize>, Vec<i16>)>,
    /// Further parameters of texts.
    pub(crate) texts: Vec<(i8, &'static str, Vec<&'static str>)>,
    /// Analog samples of a frame, and of a channel in it.
    pub(crate) samples: u16,
    pub(crate) per_channel: u16,
    /// Raw analog numbers of each frame; some numbers where it is empty.
    pub(crate) analog: Vec<Vec<f64>>,
    pub(crate) frames: Vec<Vec<[f64; 4]>>,
}

impl Trial {
    pub(crate) fn new(kind: Kind, scale: f64, labels: &[&str], frames: Vec<Vec<[f64; 4]>>) -> Self {
        let labels = labels.iter().map(|&label| label.to_owned()).collect();
        let ends = (1, frames.len() as u16);
        Self {
            kind,
            scale,
            rate: 50.0,
            unit: "mm",
            labels,
            ends,
            words: vec![],
            reals: vec![],
            integers: vec![],
            texts: vec![],
            samples: 3,
            per_channel: 1,
            analog: vec![],
            frames,
        }
    }

    fn parameters(&self) -> Vec<u8> {
        let mut bytes = vec![1, 0x50, 0, [84, 85, 86][self.kind as usize]];
        for (id, name) in [(1, "POINT"), (2, "TRIAL"), (3, "ANALOG"), (4, "FORCE_PLATFORM")] {
            bytes.extend([name.len() as u8, (256 - id) as u8]);
            bytes.extend(name.as_bytes());
            bytes.extend(self.kind.word(3));
            bytes.push(0);
        }
        let mut add = |id: i8, name: &str, kind: i8, dimensions: &[usize], data: &[u8]| {
            // A locked one.
            bytes.push(if name == "RATE" { 256 - name.len() } else { name.len() } as u8);
            bytes.push(id as u8);
            bytes.extend(name.as_bytes());
            bytes.extend(self.kind.word((5 + dimensions.len() + data.len()) as u16));
            bytes.extend([kind as u8, dimensions.len() as u8]);
            bytes.extend(dimensions.iter().map(|d| *d as u8));
            bytes.extend(data);
            bytes.push(0);
        };
        add(1, "RATE", 4, &[], &self.kind.real(self.rate));
        add(1, "SCALE", 4, &[], &self.kind.real(self.scale));
        add(1, "UNITS", -1, &[4], format!("{:4}", self.unit).as_bytes());
        for (part, labels) in self.labels.chunks(255).enumerate() {
            let name = if part == 0 { "LABELS".to_owned() } else { format!("LABELS{}", part + 1) };
            let data: String = labels.iter().map(|label| format!("{label:8}")).collect();
            add(1, &name, -1, &[8, labels.len()], data.as_bytes());
        }
        for (group, name, words) in &self.words {
            let data: Vec<u8> = words.iter().flat_map(|word| self.kind.word(*word)).collect();
            add(*group, name, 2, &[words.len()], &data);
        }
        for (group, name, dimensions, numbers) in &self.reals {
            let data: Vec<u8> = numbers.iter().flat_map(|number| self.kind.real(*number)).collect();
            add(*group, name, 4, dimensions, &data);
        }
        for (group, name, dimensions, numbers) in &self.integers {
            let data: Vec<u8> = numbers.iter().flat_map(|number| self.kind.word(*number as u16)).collect();
            add(*group, name, 2, dimensions, &data);
        }
        for (group, name, texts) in &self.texts {
            let data: String = texts.iter().map(|text| format!("{text:8}")).collect();
            add(*group, name, -1, &[8, texts.len()], data.as_bytes());
        }
        bytes.resize(bytes.len().next_multiple_of(512), 0);
        bytes[2] = (bytes.len() / 512) as u8;
        bytes
    }

    pub(crate) fn bytes(&self) -> Vec<u8> {
        let parameters = self.parameters();
        let mut bytes = vec![2, 0x50];
        let points = self.frames.first().map_or(0, Vec::len);
        for word in [points as u16, self.samples, self.ends.0, self.ends.1, 0] {
            bytes.extend(self.kind.word(word));
        }
        bytes.extend(self.kind.real(self.scale));
        bytes.extend(self.kind.word(2 + (parameters.len() / 512) as u16));
        bytes.extend(self.kind.word(self.per_channel));
        bytes.extend(self.kind.real(self.rate));
        bytes.resize(512, 0);
        bytes.extend(parameters);
        for (i, frame) in self.frames.iter().enumerate() {
            let some = || (0..self.samples).map(|sample| f64::from(sample) - 7.0).collect();
            let analog: Vec<f64> = self.analog.get(i).cloned().unwrap_or_else(some);
            for number in frame.iter().flatten().copied().chain(analog) {
                if self.scale < 0.0 {
                    bytes.extend(self.kind.real(number));
                } else {
                    bytes.extend(self.kind.word(if number < 0.0 { number as i16 as u16 } else { number as u16 }));
                }
            }
        }
        bytes
    }
}
