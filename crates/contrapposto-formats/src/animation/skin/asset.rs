//! Reads the baked skin `data/skin/adult.skin`, whose layout stands in `scripts/bake_skin.py`.

use nalgebra::Vector3;

/// The embedded file; a test reads all of it.
pub(super) const BYTES: &[u8] = include_bytes!("../../../data/skin/adult.skin");
/// Decimetres in metres.
const DECIMETRE: f64 = 0.1;
/// Landmarks of the middle of the body, and those of one side, as they stand in the file.
const MIDDLE_MARKS: usize = 4;
const SIDE_MARKS: usize = 10;

/// Thin and stout shapes of the woman and of the man.
const BAKED_SHAPES: usize = 4;

/// A landmark of the middle of the body.
#[derive(Clone, Copy)]
pub(super) enum Middle {
    Sole,
    Top,
}

/// A landmark of one side.
#[derive(Clone, Copy)]
pub(super) enum Place {
    Shoulder,
    Elbow,
    Wrist,
    /// Knuckles of index, middle and little finger.
    Index,
    MiddleFinger,
    Little,
    Hip,
    Knee,
    Ankle,
    Ball,
}

/// The mesh before it is fitted: m, x ahead, y up, z right.
pub(super) struct Asset {
    /// Of the woman and the man of mean mass.
    means: [Vec<Vector3<f64>>; 2],
    /// Thin and stout, less the mean.
    shapes: [[Vec<Vector3<f64>>; 2]; 2],
    landmarks: [Vec<Vector3<f64>>; 2],
    pub(super) bones: Vec<[u8; 4]>,
    pub(super) weights: Vec<[u8; 4]>,
    /// sRGB.
    pub(super) colors: Vec<[u8; 3]>,
    pub(super) quads: Vec<[u16; 4]>,
}

/// Takes numbers off the front of bytes.
struct Cursor<'a>(&'a [u8]);

impl Cursor<'_> {
    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*first)
    }

    fn count(&mut self) -> Option<usize> {
        self.array().map(u32::from_le_bytes)?.try_into().ok()
    }

    fn float(&mut self) -> Option<f64> {
        self.array().map(f32::from_le_bytes).map(f64::from)
    }

    /// A point of the file's axes (left, up, ahead) from three numbers.
    fn point(&mut self, mut number: impl FnMut(&mut Self) -> Option<f64>) -> Option<Vector3<f64>> {
        let [left, up, ahead] = [number(self)?, number(self)?, number(self)?];
        Some(DECIMETRE * Vector3::new(ahead, up, -left))
    }

    /// A step, and points in multiples of it.
    fn points(&mut self, count: usize, number: fn(&mut Self) -> Option<f64>) -> Option<Vec<Vector3<f64>>> {
        let step = self.float()?;
        (0..count).map(|_| self.point(number).map(|point| step * point)).collect()
    }

    fn list<const N: usize>(&mut self, count: usize) -> Option<Vec<[u8; N]>> {
        (0..count).map(|_| self.array()).collect()
    }
}

impl Asset {
    /// From the bytes of a file; `None` unless it is whole.
    pub(super) fn read(bytes: &[u8]) -> Option<Self> {
        let mut file = Cursor(bytes);
        let known = file.array()? == *b"SKIN" && file.count()? == 1;
        let [vertices, quads, shapes, landmarks] = [file.count()?, file.count()?, file.count()?, file.count()?];
        if !known || shapes != BAKED_SHAPES || landmarks != MIDDLE_MARKS + 2 * SIDE_MARKS {
            return None;
        }
        let word = |file: &mut Cursor<'_>| file.array().map(i16::from_le_bytes).map(f64::from);
        let byte = |file: &mut Cursor<'_>| file.array().map(i8::from_le_bytes).map(f64::from);
        let woman = file.points(vertices, word)?;
        let man = file.points(vertices, word)?.iter().zip(&woman).map(|(more, mean)| mean + more).collect();
        let mut thin_and_stout = || Some([file.points(vertices, byte)?, file.points(vertices, byte)?]);
        let shapes = [thin_and_stout()?, thin_and_stout()?];
        let mut marks = || (0..landmarks).map(|_| file.point(Cursor::float)).collect::<Option<Vec<_>>>();
        let landmarks = [marks()?, marks()?];
        let [bones, weights] = [file.list(vertices)?, file.list(vertices)?];
        let colors = file.list(vertices)?;
        let corner = |file: &mut Cursor<'_>| file.array().map(u16::from_le_bytes);
        let mut quad = || Some([corner(&mut file)?, corner(&mut file)?, corner(&mut file)?, corner(&mut file)?]);
        let quads = (0..quads).map(|_| quad()).collect::<Option<_>>()?;
        let whole = file.0.is_empty();
        whole.then_some(Self { means: [woman, man], shapes, landmarks, bones, weights, colors, quads })
    }

    /// Vertices of a woman or a man; `mass` is -1 for the thin one, 1 for the stout one, and may be beyond both.
    pub(super) fn vertices(&self, male: bool, mass: f64) -> Vec<Vector3<f64>> {
        let sex = usize::from(male);
        let more = &self.shapes[sex][usize::from(mass > 0.0)];
        self.means[sex].iter().zip(more).map(|(mean, more)| mean + mass.abs() * more).collect()
    }

    pub(super) fn middle(&self, male: bool, mark: Middle) -> Vector3<f64> {
        self.landmarks[usize::from(male)][mark as usize]
    }

    /// A landmark of the left or the right side.
    pub(super) fn side(&self, male: bool, left: bool, place: Place) -> Vector3<f64> {
        self.landmarks[usize::from(male)][MIDDLE_MARKS + usize::from(left) * SIDE_MARKS + place as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_embedded_file_is_whole_and_any_other_length_is_refused() {
        let asset = Asset::read(BYTES).unwrap();
        assert_eq!(asset.bones.len(), asset.weights.len());
        assert!(asset.weights.iter().all(|w| w.iter().map(|&w| u32::from(w)).sum::<u32>() == 255));
        let corners = asset.quads.iter().flatten();
        assert!(corners.into_iter().all(|&corner| usize::from(corner) < asset.bones.len()));
        for male in [false, true] {
            let heights = |mass| asset.vertices(male, mass).iter().map(|p| p.y).fold(0.0, f64::max);
            let tall = asset.middle(male, Middle::Top).y - asset.middle(male, Middle::Sole).y;
            assert!((1.5..1.8).contains(&tall), "{tall}");
            assert!((heights(0.0) - asset.middle(male, Middle::Top).y).abs() < 1e-3);
            assert!(asset.side(male, true, Place::Hip).z < 0.0, "the left is at negative z");
            assert!(asset.side(male, false, Place::Ball).x > 0.05, "toes are ahead");
        }
        assert!(Asset::read(&BYTES[..BYTES.len() - 1]).is_none());
        assert!(Asset::read(&[BYTES, &[0]].concat()).is_none());
    }
}
