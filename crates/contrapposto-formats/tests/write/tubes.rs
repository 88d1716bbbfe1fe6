//! glTF with tubes along lines that segments carry: a skin moves every corner with the segment of its point.

use contrapposto::kinematics::Kinematics;
use contrapposto::model::{Adult, Model, adult};
use contrapposto::posture::Posture;
use contrapposto_formats::animation::{Clip, Tube, glb, glb_with_tubes};
use nalgebra::{Rotation3, Vector3};

use super::players::Glb;
use super::skinned::{check, moved};
use super::{build, hinges_and_slides};

const RADIUS: f64 = 0.004;
/// Corners of a ring.
const SIDES: usize = 6;

#[test]
fn rings_of_tubes_stay_about_their_points_in_every_posture() {
    let model = adult(&Adult::default()).unwrap();
    rings_stay(&model, ["torso", "humerus_r", "ulna_r"].map(|name| model.segment(name).unwrap()));
    // Joints away from the origins of their segments.
    let model = build(hinges_and_slides());
    let away = |s: &usize| model.segments()[*s].in_segment.translation.vector.norm() > 0.01;
    let mut segments = (0..model.segments().len()).filter(away);
    rings_stay(&model, [(); 3].map(|()| segments.next().unwrap()));
}

fn rings_stay(model: &Model, [first, second, third]: [usize; 3]) {
    let line = vec![
        (None, [0.1, 1.2, 0.3]),
        (Some(first), [0.05, 0.2, 0.1]),
        (Some(second), [0.02, -0.1, 0.01]),
        (Some(third), [-0.01, -0.15, 0.02]),
    ];
    let tubes = [
        Tube { lines: vec![line.clone(), line[1..].to_vec()], radius: RADIUS, color: [255, 0, 128] },
        // A line of one point is none.
        Tube { lines: vec![line[..1].to_vec()], radius: RADIUS, color: [0; 3] },
    ];
    let mut postures = vec![model.default_posture(); 3];
    for (k, posture) in postures.iter_mut().enumerate() {
        for (i, coordinate) in model.coordinates().iter().enumerate() {
            let (low, high) = (coordinate.range.0.max(-1.0), coordinate.range.1.min(1.0));
            posture.values_mut()[i] = low + (high - low) * (0.2 + 0.25 * k as f64);
        }
    }
    let rows: Vec<&[f64]> = postures.iter().map(Posture::values).collect();
    let turn = Rotation3::from_euler_angles(0.4, -1.1, 2.0);
    let directions = [-Vector3::z(), Vector3::y(), Vector3::x()].map(|d| turn * d);
    let times = [0.0, 1.0, 2.0];
    let clip = Clip {
        model,
        title: "any",
        directions,
        times: &times,
        postures: &rows,
        steps: false,
        things: &[],
        arrows: &[],
    };
    let solids = vec![vec![vec![[0.0, 0.0, 0.0, 0.05]]]; model.segments().len()];
    let bytes = glb_with_tubes(&clip, &solids, &tubes).unwrap();
    assert_eq!(bytes, glb_with_tubes(&clip, &solids, &tubes).unwrap());
    assert_eq!(glb(&clip, &solids).unwrap(), glb_with_tubes(&clip, &solids, &[]).unwrap());
    let file = Glb::read(&bytes);
    check(&file);
    let mesh = file.json["meshes"].as_array().unwrap().len() - 1;
    assert_eq!(file.json["materials"][0]["alphaMode"], "BLEND");
    let points: Vec<_> = line.iter().chain(&line[1..]).collect();
    let (mut kinematics, mut worst) = (Kinematics::new(model), 0f64);
    for (time, posture) in times.iter().zip(&postures) {
        kinematics.update(model, posture).unwrap();
        let corners = moved(&file, mesh, &file.frames(*time));
        assert_eq!(corners.len(), SIDES * points.len());
        for (ring, (segment, place)) in corners.chunks_exact(SIDES).zip(&points) {
            let place = Vector3::from(*place);
            let place = segment.map_or(place, |s| kinematics.station(model, s, place));
            let wanted = Vector3::from(directions.map(|d| d.dot(&place)));
            for corner in ring {
                worst = worst.max(((corner - wanted).norm() - RADIUS).abs());
            }
        }
    }
    println!("rings of tubes are off by {worst:.1e} m");
    assert!(worst < 1e-5, "{worst:e}");
}
