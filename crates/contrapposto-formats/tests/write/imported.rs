//! Model files are read, written and read again: the same model.

use std::path::PathBuf;

use contrapposto::model::Model;
use contrapposto_formats::{mjcf, osim, urdf};

use super::common::{here, shared};
use super::peers::asked;
use super::{Format, Mjcf, Osim, Urdf, difference, read, write};

/// The models that are read from the model files of the folders.
fn imported(folders: &[PathBuf]) -> Vec<(String, Format, Model)> {
    let mut all = vec![];
    for folder in folders {
        let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
        paths.sort();
        for path in paths {
            let format = match path.extension().and_then(|e| e.to_str()) {
                Some("osim") => Osim,
                Some("urdf") => Urdf,
                Some("xml") => Mjcf,
                _ => continue,
            };
            let bytes = std::fs::read(&path).unwrap();
            let mut include = |name: &str| std::fs::read(folder.join(name)).map_err(|e| e.to_string());
            let body = match format {
                Osim => osim::read(&bytes, "m").ok(),
                Urdf => urdf::read(&bytes, "m", &urdf::Options::default()).ok(),
                Mjcf => mjcf::read(&bytes, "m", &mut include, &mjcf::Options::default()).ok(),
            };
            let Some(Ok(imported)) = body.map(|b| b.model()) else { continue };
            all.push((path.file_name().unwrap().to_string_lossy().into_owned(), format, imported.model));
        }
    }
    all
}

/// The model's `Debug` text without its numbers, and the numbers.
fn skeleton(model: &Model) -> (String, Vec<f64>) {
    let text = format!("{model:?}");
    let (mut words, mut numbers) = (String::new(), vec![]);
    for token in text.split_inclusive(|c: char| " ,[]{}()".contains(c)) {
        let end = token.len() - token.ends_with(|c: char| " ,[]{}()".contains(c)) as usize;
        match token[..end].parse::<f64>() {
            Ok(value) => {
                numbers.push(value);
                words.push('#');
                words.push_str(&token[end..]);
            }
            Err(_) => words.push_str(token),
        }
    }
    (words, numbers)
}

/// No format of ours holds patches: they are listed as lost.
fn without_patches(mut model: Model) -> Model {
    for segment in 0..model.segments().len() {
        model = model.with_patch(segment, vec![]);
    }
    model
}

/// Writes and reads each model in its own format; the number of models that can be written. At most so many numbers of a
/// model change.
fn survivors(folders: &[PathBuf], most_changed: usize) -> usize {
    let mut seen = 0;
    for (name, format, model) in imported(folders) {
        let written = match write(&model, format) {
            Ok(written) => written,
            Err(error) => {
                println!("{name}: {error}");
                continue;
            }
        };
        let back = read(&written.text, format);
        assert_eq!(format!("{back:?}"), format!("{:?}", read(&written.text, format)), "{name} twice");
        let bare = without_patches(model.clone());
        let ((words, numbers), (words_back, numbers_back)) = (skeleton(&bare), skeleton(&back));
        let changed = numbers.iter().zip(&numbers_back).filter(|(a, b)| a != b).count();
        let pairs = numbers.iter().zip(&numbers_back).filter(|(a, b)| a != b);
        let worst = pairs.fold(0.0_f64, |w, (a, b)| w.max((a - b).abs() / a.abs().max(1.0)));
        let torque = difference(&model, &back, true);
        println!(
            "{name}: same structure {}, {changed} of {} numbers differ, by {worst:e} at most; torque {torque:e}",
            words == words_back,
            numbers.len()
        );
        seen += 1;
        // What no text gives exactly (products of rotations, multiples of splines) differs in the last digit, and once only.
        assert!(words == words_back && worst < 1e-15, "{name}");
        assert!(changed <= most_changed, "{name}: {changed} numbers");
        assert!(torque < 1e-15, "{name}: {torque:e}");
        let again = read(&write(&back, format).unwrap().text, format);
        assert_eq!(skeleton(&again), (words_back, numbers_back), "{name} again");
    }
    seen
}

#[test]
fn imported_models_survive_their_own_format() {
    assert!(survivors(&[here().join("tests/models")], usize::MAX) >= 5);
}

#[test]
#[ignore = "needs ../shared: published models"]
fn published_models_survive_their_own_format_unchanged() {
    let folders = ["opensim", "human-gazebo", "cmu", "gepetto"].map(|folder| shared("models").join(folder));
    assert!(survivors(&folders, 0) >= 11);
}

/// The files of `written/` are those that the writers write now, up to the last digits of another processor.
#[test]
fn stored_models_are_what_the_writers_write() {
    let models = asked();
    for (name, model) in [("right_arm", &models[2].1), ("hinges_and_slides", &models[3].1)] {
        for (format, ending) in [(Osim, "osim"), (Urdf, "urdf"), (Mjcf, "xml")] {
            let path = here().join(format!("tests/written/{name}.{ending}"));
            let stored = read(&std::fs::read_to_string(&path).unwrap(), format);
            let now = read(&write(model, format).unwrap().text, format);
            let ((words, numbers), (words_now, numbers_now)) = (skeleton(&stored), skeleton(&now));
            let again = format!("{} has changed: run scripts/written_models.py again", path.display());
            assert!(words == words_now, "{again}");
            let pairs = numbers.iter().zip(&numbers_now);
            let worst = pairs.fold(0.0_f64, |w, (a, b)| w.max((a - b).abs() / a.abs().max(1.0)));
            assert!(worst < 1e-13, "{again}: {worst:e}");
        }
    }
}
