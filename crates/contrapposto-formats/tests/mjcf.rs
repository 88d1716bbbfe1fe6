//! MJCF models as bodies: against MuJoCo's own numbers, and what is refused where.

mod common;

use common::{center_of_mass, difference, frames, here, mutate, mutations, shared};
use contrapposto_formats::body::{Body, BodyCoordinateKind, BodyRoot, PassiveLawText};
use contrapposto_formats::mjcf::{self, MjcfError, Options};
use contrapposto_formats::xml::Limits;
use serde_json::Value;
use std::path::Path;

fn read_with(text: &[u8], options: &Options) -> Result<Body, MjcfError> {
    mjcf::read(text, "file.xml", &mut |name| Err(format!("no file {name}")), options)
}

fn read(text: &str) -> Result<Body, MjcfError> {
    read_with(text.as_bytes(), &Options::default())
}

fn read_file(path: &Path, options: &Options) -> Body {
    let folder = path.parent().unwrap().to_owned();
    let mut include = |name: &str| std::fs::read(folder.join(name)).map_err(|e| e.to_string());
    mjcf::read(&std::fs::read(path).unwrap(), "file.xml", &mut include, options).unwrap_or_else(|e| panic!("{e}"))
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

fn references() -> Vec<(Body, Value)> {
    let text = std::fs::read_to_string(here().join("tests/data/mujoco_reference.json")).unwrap();
    let all: Value = serde_json::from_str(&text).unwrap();
    let mut found = vec![];
    for reference in all["models"].as_array().unwrap() {
        let name = reference["model"].as_str().unwrap();
        let ours = here().join("tests/models").join(name);
        let path = if ours.exists() { Some(ours) } else { shared(&format!("models/cmu/{name}")) };
        if let Some(path) = path {
            found.push((read_file(&path, &Options::default()), reference.clone()));
        }
    }
    found
}

#[test]
fn masses_are_mujocos() {
    for (body, reference) in references() {
        let bodies = reference["bodies"].as_array().unwrap();
        assert_eq!(body.segments.len(), bodies.len());
        let mut worst = [0.0_f64; 3];
        for (segment, expected) in body.segments.iter().zip(bodies) {
            let name = expected["name"].as_str().unwrap();
            assert!(segment.name == name || name.is_empty());
            assert_eq!(segment.parent.map_or(0, |p| p as u64 + 1), expected["parent"].as_u64().unwrap());
            let mass = expected["mass"].as_f64().unwrap();
            worst[0] = worst[0].max((segment.mass - mass).abs() / mass.max(1.0));
            worst[1] = worst[1].max(difference(segment.center_of_mass.as_slice(), &numbers(&expected["center"])));
            worst[2] = worst[2].max(difference(segment.inertia.as_slice(), &numbers(&expected["inertia"])));
        }
        println!("{}: mass {:.1e}, centre {:.1e} m, inertia {:.1e}", reference["model"], worst[0], worst[1], worst[2]);
        assert!(worst.iter().all(|w| *w < 1e-12), "{}: {worst:?}", reference["model"]);
        assert!(difference(body.gravity.as_slice(), &numbers(&reference["gravity"])) == 0.0);
    }
}

#[test]
fn joints_are_mujocos() {
    for (body, reference) in references() {
        let off = |name: &str| reference[name].as_bool().unwrap();
        let mut at = 0;
        for expected in reference["joints"].as_array().unwrap() {
            let kind = expected["type"].as_str().unwrap();
            let coordinate = &body.coordinates[at];
            let name = expected["name"].as_str().unwrap();
            let limited = expected["limited"].as_bool().unwrap() && !off("limits_disabled");
            at += match kind {
                "free" => 7,
                "ball" => 4,
                _ => 1,
            };
            if matches!(kind, "free" | "ball") {
                let ending = if kind == "free" { "_tx" } else { "_qw" };
                assert!(coordinate.name.ends_with(ending) && coordinate.name.starts_with(name));
                let high = numbers(&expected["range"])[1];
                assert!(!limited || (coordinate.range.0 - (high / 2.0).cos()).abs() < 1e-15);
                continue;
            }
            assert!(coordinate.name == name || name.is_empty());
            let slide = coordinate.kind == BodyCoordinateKind::Translation;
            assert_eq!(slide, kind == "slide");
            assert_eq!(coordinate.clamped, limited);
            if limited {
                assert!(difference(&[coordinate.range.0, coordinate.range.1], &numbers(&expected["range"])) < 1e-15);
            } else {
                assert_eq!(coordinate.range, (f64::NEG_INFINITY, f64::INFINITY));
            }
            // A joint that an equality fixes rests where the equality says.
            if !coordinate.locked {
                assert!((coordinate.default - expected["qpos0"].as_f64().unwrap()).abs() < 1e-15);
            }
            let spring = body.passive.iter().find(|p| p.coordinate == at - 1);
            let (found, rest) = match spring.map(|s| &s.law) {
                None => (vec![0.0; 3], None),
                Some(PassiveLawText::Spring { stiffness, rest }) => (vec![*stiffness, 0.0, 0.0], Some(*rest)),
                Some(PassiveLawText::Polynomial { coefficients, rest }) => (coefficients.clone(), Some(*rest)),
                Some(law) => panic!("{law:?}"),
            };
            let stiffness = if off("springs_disabled") { vec![0.0; 3] } else { numbers(&expected["stiffness"]) };
            assert!(difference(&found, &stiffness) < 1e-12, "{name}: {found:?}, MuJoCo {stiffness:?}");
            assert!(rest.is_none_or(|r| (r - expected["rest"].as_f64().unwrap()).abs() < 1e-15));
        }
        assert_eq!(at, body.coordinates.len());
    }
}

#[test]
fn poses_springs_and_sites_are_mujocos() {
    for (body, reference) in references() {
        let sites: Vec<_> = reference["sites"].as_array().unwrap().iter().map(|s| s.as_str().unwrap()).collect();
        let mut worst = [0.0_f64; 5];
        for pose in reference["poses"].as_array().unwrap() {
            let q = numbers(&pose["qpos"]);
            let found = frames(&body, &q);
            let positions: Vec<f64> =
                found.iter().flat_map(|f| f.translation.vector.iter().copied().collect::<Vec<_>>()).collect();
            let turn = |f: &nalgebra::Isometry3<f64>| f.rotation.to_rotation_matrix().matrix().transpose();
            let rotations: Vec<f64> = found.iter().flat_map(|f| turn(f).iter().copied().collect::<Vec<_>>()).collect();
            // A mocap body's rotation is its own; all others follow.
            worst[0] = worst[0].max(difference(&positions, &numbers(&pose["positions"])));
            worst[1] = worst[1].max(difference(&rotations, &numbers(&pose["rotations"])));
            let center = center_of_mass(&body, &q);
            worst[2] = worst[2].max(difference(center.as_slice(), &numbers(&pose["center_of_mass"])));
            let site_positions = numbers(&pose["sites"]);
            for (name, segment, at) in &body.stations {
                let index = sites.iter().position(|s| s == name).unwrap();
                let world = found[*segment] * nalgebra::Point3::from(*at);
                worst[3] = worst[3].max(difference(world.coords.as_slice(), &site_positions[3 * index..3 * index + 3]));
            }
            let mut springs = numbers(&pose["spring"]).into_iter();
            let single = |c: &&contrapposto_formats::body::BodyCoordinate| c.kind != BodyCoordinateKind::Quaternion;
            let free = body.coordinates.iter().filter(|c| c.name.starts_with("root_t")).count();
            for (index, _) in body.coordinates.iter().enumerate().filter(|(_, c)| single(c)).skip(free) {
                let torque: f64 = body
                    .passive
                    .iter()
                    .filter(|p| p.coordinate == index)
                    .map(|p| match &p.law {
                        PassiveLawText::Spring { stiffness, rest } => -stiffness * (q[index] - rest),
                        PassiveLawText::Polynomial { coefficients, rest } => {
                            let x = q[index] - rest;
                            -coefficients.iter().rev().fold(0.0, |sum, k| (sum + k) * x)
                        }
                        law => panic!("{law:?}"),
                    })
                    .sum();
                worst[4] = worst[4].max(difference(&[torque], &[springs.next().unwrap()]));
            }
        }
        println!(
            "{}: position {:.1e} m, rotation {:.1e}, centre of mass {:.1e} m, sites {:.1e} m, springs {:.1e} N m",
            reference["model"], worst[0], worst[1], worst[2], worst[3], worst[4]
        );
        assert!(worst.iter().all(|w| *w < 1e-12), "{}: {worst:?}", reference["model"]);
    }
}
