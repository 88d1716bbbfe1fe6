//! Model files are read, written and read again: the same model.

use contrapposto::model::Model;
use contrapposto_formats::{mjcf, osim, urdf};

use super::common::here;
use super::{Format, Mjcf, Osim, Urdf, difference, read, write};

/// Our own model files and, where they are, published ones (`true`).
fn imported() -> Vec<(String, bool, Format, Model)> {
    let shared = here().join("../../../shared/models");
    let mut all = vec![];
    for folder in [
        here().join("tests/models"),
        shared.join("opensim"),
        shared.join("human-gazebo"),
        shared.join("cmu"),
        shared.join("gepetto"),
    ] {
        let Ok(entries) = std::fs::read_dir(&folder) else { continue };
        let mut paths: Vec<_> = entries.map(|e| e.unwrap().path()).collect();
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
            let published = folder.starts_with(&shared);
            all.push((path.file_name().unwrap().to_string_lossy().into_owned(), published, format, imported.model));
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

#[test]
fn imported_models_survive_their_own_format() {
    let mut seen = 0;
    for (name, published, format, model) in imported() {
        let written = match write(&model, format) {
            Ok(written) => written,
            Err(error) => {
                println!("{name}: {error}");
                continue;
            }
        };
        let back = read(&written.text, format);
        assert_eq!(format!("{back:?}"), format!("{:?}", read(&written.text, format)), "{name} twice");
        let ((words, numbers), (words_back, numbers_back)) = (skeleton(&model), skeleton(&back));
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
        assert!(!published || changed == 0, "{name}: {changed} numbers");
        assert!(torque < 1e-15, "{name}: {torque:e}");
        let again = read(&write(&back, format).unwrap().text, format);
        assert_eq!(skeleton(&again), (words_back, numbers_back), "{name} again");
    }
    assert!(seen >= 5);
}
