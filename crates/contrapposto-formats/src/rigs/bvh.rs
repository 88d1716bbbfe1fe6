//! Reads BVH: a hierarchy of joints with offsets and channels, then a row of numbers for every frame.
//!
//! Keywords in any case, channels in any order and number, `{` on the same line or the next one, names with blanks. Angles are degrees and turn about
//! the axes that the turns before have left (`R = R1 R2 R3` in the order of the file); places stand instead of the joint's offset.

use contrapposto::model::LARGEST;
use nalgebra::{UnitQuaternion, Vector3};

use super::{Channel, Rig, RigJoint};
use crate::input_error::{InputError, Source, utf8};
use crate::motion::{MOST_NAME_BYTES, MOST_NUMBERS};
use crate::xml::shorten;

/// Most joints of a rig (assumed: with all fingers and a face a rig has some hundred).
const MOST_JOINTS: usize = 2000;
/// Most channels of a joint: three places and three turns, each once more for files that repeat them.
const MOST_CHANNELS: usize = 12;
/// Most joints times frames (assumed: to place them all takes seconds).
const MOST_PLACED_JOINTS: usize = 10_000_000;
/// Shortest and longest time between frames, s (assumed; times of a motion are rounded to 1e-6 s).
const FRAME_TIMES: std::ops::RangeInclusive<f64> = 1e-5..=1000.0;

/// Reads a `.bvh` file. `name` stands in errors only.
///
/// ```
/// let text = "HIERARCHY\nROOT Hips\n{\n OFFSET 0 0 0\n CHANNELS 1 Yposition\n End Site\n { OFFSET 0 1 0 }\n}\nMOTION\nFrames: 1\nFrame Time: 0.1\n0.9\n";
/// let rig = contrapposto_formats::rigs::read_bvh("a.bvh", text.as_bytes())?;
/// assert_eq!(rig.frames, [[0.9]]);
/// # Ok::<(), contrapposto_formats::InputError>(())
/// ```
///
/// # Errors
/// [`InputError`] says what is wrong, where, and what would be right.
pub fn read_bvh(name: &str, bytes: &[u8]) -> Result<Rig, InputError> {
    let text = utf8(name, bytes)?;
    let mut words = Words { source: Source { name, text }, at: 0, repeated: vec![] };
    if text.starts_with('\u{feff}') {
        words.at = '\u{feff}'.len_utf8();
    }
    words.expect("HIERARCHY", "a .bvh file begins with HIERARCHY")?;
    let mut rig = Rig { joints: vec![], ends: vec![], frame_time: 0.0, frames: vec![], warnings: vec![] };
    let channels = hierarchy(&mut words, &mut rig)?;
    rig.warnings.extend(words.repeated_names());
    words.expect("MOTION", "after the joints follows MOTION")?;
    words.label("Frames", "the number of frames is said by `Frames: 120`")?;
    let promised = words.word().ok_or_else(|| words.missing("the number of frames"))?;
    let promised = promised.parse::<usize>().map_err(|_| {
        words.error(promised, format!("`{}` is no number of frames", shorten(promised)), "a whole number is accepted")
    })?;
    let header = words.at;
    words.label("Frame", "the time of a frame is said by `Frame Time: 0.008333`")?;
    words.label("Time", "the time of a frame is said by `Frame Time: 0.008333`")?;
    rig.frame_time = words.frame_time()?;
    rows(&words, channels, &mut rig)?;
    if rig.frames.len() != promised {
        let (found, line) = (rig.frames.len(), text[..header].lines().count());
        rig.warnings.push(format!(
            "{name}: the header says {promised} frames (line {line}), but there are {found}, which are read; was the file cut off?"
        ));
    }
    Ok(rig)
}

/// Reads the joints; answers the number of channels of a frame.
fn hierarchy(words: &mut Words<'_>, rig: &mut Rig) -> Result<usize, InputError> {
    words.expect("ROOT", "the first joint is `ROOT NAME`")?;
    let mut channels = 0;
    let mut open = vec![(Open::Joint(joint(words, rig, None)?), false)];
    while let Some((last, has_offset)) = open.last_mut() {
        let last = &*last;
        let Some(word) = words.word() else { return Err(words.missing("a closing brace `}`")) };
        let (known, inside) = (word.to_ascii_uppercase(), last.joint());
        match (known.as_str(), last) {
            ("}", _) => drop(open.pop()),
            ("OFFSET", _) if *has_offset => {
                return Err(words.error(word, "the joint or end has an offset already", "one OFFSET each"));
            }
            ("OFFSET", _) => {
                let offset = words.triple()?;
                *has_offset = true;
                match last {
                    Open::Joint(j) => rig.joints[*j].offset = offset,
                    Open::End(j) => rig.ends.push((*j, offset)),
                }
            }
            ("CHANNELS", Open::Joint(j)) if rig.joints[*j].channels.is_empty() => {
                rig.joints[*j].first = channels;
                rig.joints[*j].channels = words.channels()?;
                channels += rig.joints[*j].channels.len();
            }
            ("CHANNELS", Open::Joint(_)) => {
                return Err(words.error(word, "the joint has channels already", "one line CHANNELS a joint"));
            }
            ("JOINT", Open::Joint(_)) => open.push((Open::Joint(joint(words, rig, Some(inside))?), false)),
            ("END", Open::Joint(_)) => {
                let _ = words.name();
                words.expect("{", "an end is `End Site { OFFSET x y z }`")?;
                open.push((Open::End(inside), false));
            }
            _ => {
                let help = "OFFSET, CHANNELS, JOINT, `End Site` and `}` are known in a joint, OFFSET and `}` in an end";
                return Err(words.error(word, format!("`{}` is unknown here", shorten(word)), help));
            }
        }
    }
    if channels == 0 {
        return Err(words.missing("a joint with CHANNELS, without which nothing moves"));
    }
    Ok(channels)
}

/// An open brace.
enum Open {
    Joint(usize),
    /// The end of a joint.
    End(usize),
}

impl Open {
    fn joint(&self) -> usize {
        match self {
            Self::Joint(joint) | Self::End(joint) => *joint,
        }
    }
}

/// Reads the name of a joint and its opening brace.
fn joint(words: &mut Words<'_>, rig: &mut Rig, parent: Option<usize>) -> Result<usize, InputError> {
    let name = words.name();
    let named = words.at;
    if name.is_empty() || name.len() > MOST_NAME_BYTES || name.contains(char::is_control) {
        let help = format!("a name has 1 to {MOST_NAME_BYTES} bytes and no control characters");
        return Err(words.error(name, "the joint's name cannot be read", &help));
    }
    if rig.joints.len() == MOST_JOINTS {
        return Err(words.error(name, format!("more than {MOST_JOINTS} joints"), "keep fewer joints"));
    }
    words.expect("{", "a joint is `JOINT NAME { OFFSET x y z CHANNELS ... }`")?;
    if rig.joint(name).is_some() {
        words.repeated.push((named, name));
    }
    let offset = Vector3::zeros();
    rig.joints.push(RigJoint {
        name: name.to_owned(),
        parent,
        offset,
        rest: UnitQuaternion::identity(),
        channels: vec![],
        first: 0,
    });
    Ok(rig.joints.len() - 1)
}

/// Reads the frames, a line each.
fn rows(words: &Words<'_>, channels: usize, rig: &mut Rig) -> Result<(), InputError> {
    let turns: Vec<bool> = rig
        .joints
        .iter()
        .flat_map(|joint| &joint.channels)
        .map(|channel| matches!(channel, Channel::Turn(_)))
        .collect();
    let joints = rig.joints.len();
    for line in words.source.text[words.at..].split('\n').map(str::trim).filter(|line| !line.is_empty()) {
        if (rig.frames.len() + 1).saturating_mul(channels) > MOST_NUMBERS {
            return Err(words.error(&line[..0], format!("more than {MOST_NUMBERS} numbers"), "keep fewer frames"));
        }
        if (rig.frames.len() + 1).saturating_mul(joints) > MOST_PLACED_JOINTS {
            let message = format!("{joints} joints times frames are more than {MOST_PLACED_JOINTS}");
            return Err(words.error(&line[..0], message, "keep fewer frames, or fewer joints"));
        }
        let mut row = Vec::with_capacity(channels);
        for cell in line.split_whitespace() {
            let Some(&turns) = turns.get(row.len()) else {
                let message = format!("the row has more than the {channels} numbers of its channels");
                return Err(words.error(cell, message, "decimals need a point"));
            };
            let value = words.number(cell)?;
            row.push(if turns { value.to_radians() } else { value });
        }
        if row.len() < channels {
            let message = format!("the row has {} numbers, the channels need {channels}", row.len());
            return Err(words.error(&line[line.len()..], message, "was the file cut off?"));
        }
        rig.frames.push(row);
    }
    if rig.frames.is_empty() { Err(words.missing("a row of numbers for every frame")) } else { Ok(()) }
}

/// The words of a text, one after the other.
struct Words<'a> {
    source: Source<'a>,
    at: usize,
    /// Names that a joint had before, each with the place after it.
    repeated: Vec<(usize, &'a str)>,
}

impl<'a> Words<'a> {
    fn error(&self, part: &str, message: impl Into<String>, help: &str) -> InputError {
        let start = (part.as_ptr() as usize).checked_sub(self.source.text.as_ptr() as usize);
        let span = start.map(|start| start..start + part.len()).filter(|s| self.source.text.get(s.clone()).is_some());
        self.source.error(span, message, "here", Some(help.to_owned()))
    }

    fn missing(&self, what: &str) -> InputError {
        let end = self.source.text.len();
        let help = Some(format!("{what} is due; was the file cut off?"));
        self.source.error(Some(end..end), format!("{}: ends too early", self.source.name), "here", help)
    }

    /// A warning about joints whose name another one had before.
    fn repeated_names(&self) -> Option<String> {
        let ((at, name), more) = self.repeated.split_first()?;
        let line = self.source.text[..*at].lines().count();
        let more = match more.len() {
            0 => String::new(),
            count => format!("; so it is with {count} more joints"),
        };
        Some(format!("{}:{line}: two joints are named `{name}`; the first one counts{more}", self.source.name))
    }

    /// The next word; braces stand alone.
    fn word(&mut self) -> Option<&'a str> {
        let rest = &self.source.text[self.at..];
        let begin = self.at + (rest.len() - rest.trim_start().len());
        let rest = &self.source.text[begin..];
        let first = rest.chars().next()?;
        let end = if "{}".contains(first) {
            first.len_utf8()
        } else {
            rest.find(|c: char| c.is_whitespace() || "{}".contains(c)).unwrap_or(rest.len())
        };
        self.at = begin + end;
        Some(&rest[..end])
    }

    /// The rest of the line up to a brace: a name that may hold blanks.
    fn name(&mut self) -> &'a str {
        let rest = &self.source.text[self.at..];
        let end = rest.find(['\n', '{', '}']).unwrap_or(rest.len());
        self.at += end;
        rest[..end].trim()
    }

    fn expect(&mut self, known: &str, help: &str) -> Result<(), InputError> {
        match self.word() {
            Some(word) if word.eq_ignore_ascii_case(known) => Ok(()),
            Some(word) => Err(self.error(word, format!("`{}` stands where `{known}` is due", shorten(word)), help)),
            None => Err(self.missing(&format!("`{known}`"))),
        }
    }

    /// A word of the header with or without its colon.
    fn label(&mut self, known: &str, help: &str) -> Result<(), InputError> {
        let begin = self.at;
        match self.word() {
            Some(word) if word.trim_end_matches(':').eq_ignore_ascii_case(known) => {}
            // `Frames:120`, without a blank.
            Some(word)
                if word
                    .split_at_checked(known.len())
                    .is_some_and(|(name, rest)| name.eq_ignore_ascii_case(known) && rest.starts_with(':')) =>
            {
                self.at -= word.len() - known.len() - 1;
            }
            Some(word) => {
                return Err(self.error(word, format!("`{}` stands where `{known}` is due", shorten(word)), help));
            }
            None => return Err(self.missing(&format!("`{known}`"))),
        }
        let rest = self.source.text[self.at..].trim_start();
        if rest.starts_with(':') && self.at > begin {
            self.at = self.source.text.len() - rest.len() + 1;
        }
        Ok(())
    }

    fn number(&self, cell: &str) -> Result<f64, InputError> {
        let help = "a number of at most 1e9 in size is accepted, with a decimal point";
        let value = cell.parse::<f64>().ok().filter(|value| value.abs() <= LARGEST);
        value.ok_or_else(|| self.error(cell, format!("`{}` is no number that is accepted", shorten(cell)), help))
    }

    fn triple(&mut self) -> Result<Vector3<f64>, InputError> {
        let mut triple = Vector3::zeros();
        for value in triple.iter_mut() {
            let word = self.word().ok_or_else(|| self.missing("an offset of three numbers"))?;
            *value = self.number(word)?;
        }
        Ok(triple)
    }

    fn frame_time(&mut self) -> Result<f64, InputError> {
        let word = self.word().ok_or_else(|| self.missing("the time of a frame"))?;
        let time = self.number(word)?;
        if FRAME_TIMES.contains(&time) {
            return Ok(time);
        }
        let message = format!("the time of a frame is {time:?} s");
        Err(self.error(word, message, &format!("{:?} s to {} s are accepted", FRAME_TIMES.start(), FRAME_TIMES.end())))
    }

    fn channels(&mut self) -> Result<Vec<Channel>, InputError> {
        let word = self.word().ok_or_else(|| self.missing("the number of channels"))?;
        let count = word.parse::<usize>().ok().filter(|count| *count <= MOST_CHANNELS);
        let Some(count) = count else {
            let message = format!("`{}` is no number of channels", shorten(word));
            return Err(self.error(word, message, &format!("0 to {MOST_CHANNELS} are accepted")));
        };
        let mut channels = vec![];
        for _ in 0..count {
            let word = self.word().ok_or_else(|| self.missing("the name of a channel"))?;
            let lower = word.to_ascii_lowercase();
            let axis = ["x", "y", "z"].iter().position(|axis| lower.starts_with(axis));
            channels.push(match (axis, lower.get(1..)) {
                (Some(axis), Some("position")) => Channel::Place(axis),
                (Some(axis), Some("rotation")) => Channel::Turn(axis),
                _ => {
                    let help = "Xposition, Yposition, Zposition, Xrotation, Yrotation, Zrotation are known";
                    return Err(self.error(word, format!("`{}` is no known channel", shorten(word)), help));
                }
            });
        }
        Ok(channels)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test that cannot go on says where")]

    use miette::Diagnostic;

    use super::{MOST_JOINTS, MOST_PLACED_JOINTS, read_bvh};

    /// A chain of joints of which the first has a channel.
    fn chain(names: &[String], frames: usize) -> String {
        let mut text = "HIERARCHY\nROOT hips {\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n".to_owned();
        names.iter().for_each(|name| text += &format!("JOINT {name} {{\nOFFSET 0 1 0\n"));
        text += &"}".repeat(names.len() + 1);
        text + &format!("\nMOTION\nFrames: {frames}\nFrame Time: 0.01\n") + &"0\n".repeat(frames)
    }

    #[test]
    fn joints_times_frames_have_a_cap() {
        let names: Vec<String> = (1..MOST_JOINTS).map(|joint| format!("j{joint}")).collect();
        let most = MOST_PLACED_JOINTS / MOST_JOINTS;
        assert_eq!(read_bvh("a.bvh", chain(&names, most).as_bytes()).unwrap().frames.len(), most);
        let error = read_bvh("a.bvh", chain(&names, most + 1).as_bytes()).unwrap_err().to_string();
        assert!(error.contains("2000 joints times frames are more than 10000000"), "{error}");
    }

    /// A letter of several bytes inside a label once ended in a panic.
    #[test]
    fn letters_of_several_bytes_are_refused_or_read_wherever_they_stand() {
        let text = chain(&["a".to_owned()], 2).replace("Frames: 2", "Frames:2");
        assert!(read_bvh("a.bvh", text.as_bytes()).is_ok());
        for at in 0..text.len() {
            for letter in ['\u{e9}', '\u{feff}', '\u{1d11e}'] {
                let changed = format!("{}{letter}{}", &text[..at], &text[at..]);
                let _ = read_bvh("a.bvh", changed.as_bytes());
            }
        }
        let refused = read_bvh("a.bvh", text.replace("Frames", "Fram\u{feff}").as_bytes()).unwrap_err().to_string();
        assert!(refused.contains("stands where `Frames` is due"), "{refused}");
    }

    #[test]
    fn repeated_names_are_one_warning() {
        let names = ["a", "hips", "a", "b"].map(str::to_owned);
        let rig = read_bvh("a.bvh", chain(&names, 1).as_bytes()).unwrap();
        let said = "a.bvh:7: two joints are named `hips`; the first one counts; so it is with 1 more joints";
        assert_eq!(rig.warnings, [said]);
    }

    #[test]
    fn headers_that_cannot_be_meant_are_refused_or_told_with_their_line() {
        let text = chain(&[], 2);
        let refused = |old: &str, new: &str| {
            let changed = text.replacen(old, new, 1);
            assert_ne!(changed, text);
            let error = read_bvh("a.bvh", changed.as_bytes()).unwrap_err();
            format!("{error}; {}", error.help().unwrap())
        };
        let twice = refused("OFFSET 0 0 0\n", "OFFSET 0 0 0\nOFFSET 0 1 0\n");
        assert!(twice.contains("has an offset already"), "{twice}");
        let end = refused("}", "End Site {\nOFFSET 0 1 0\nOFFSET 0 2 0\n}\n}");
        assert!(end.contains("has an offset already"), "{end}");
        let short = refused("0.01", "1e-7");
        assert!(short.contains("is 1e-7 s") && short.contains("1e-5 s to 1000 s are accepted"), "{short}");
        let cut = text.replace("Frames: 2\n", "Frames: 3\n\n\n");
        let warnings = read_bvh("a.bvh", cut.as_bytes()).unwrap().warnings;
        assert!(warnings[0].contains("the header says 3 frames (line 7), but there are 2"), "{warnings:?}");
    }
}
