//! Tests the skin of the page in a real browser: its bones follow segments, and the wooden figure is a choice.

#![allow(clippy::unwrap_used, reason = "tests: helpers outside #[test] functions too")]

#[allow(dead_code, reason = "each test uses a part")]
mod support;

use std::path::PathBuf;

use contrapposto_report::{Bone, Followed, Moments, Report, Segment, Skin, write};
use serde_json::json;
use support::chromium::Chromium;

const PICTURE: &str = "document.getElementById('body').toDataURL()";

/// Points and normals of the skin in the second frame.
const POINTS: &str = "(() => {
  const skin = new Skin(report.skin, { paintedMesh() {}, fillPoints() {}, fillPaint() {} });
  skin.fill(null, (segment) => segment.places.map((column) => column[1]));
  return Array.from(skin.points);
})()";

/// A rod of two segments whose lower half has turned by 1 rad about its own axis, in the second frame.
fn report() -> Report {
    let (sin, cos) = libm::sincos(0.5);
    let (rest, turned) = ([0.0, 0.5, 0.0, 1.0, 0.0, 0.0, 0.0], [0.0, 0.5, 0.0, cos, 0.0, sin, 0.0]);
    let segment = |places: [[f64; 7]; 2]| Segment {
        name: "rod".to_owned(),
        balls: vec![[0.0, 0.0, 0.0, 0.1], [0.0, -0.4, 0.0, 0.1]],
        places: places.to_vec(),
        start: rest,
        ..Segment::default()
    };
    let followed =
        |places: [[f64; 7]; 2]| Followed { rest, places: places.to_vec(), start: rest, ..Followed::default() };
    let bone = |from, to, twist| Bone { from, to, axis: [0.0, 1.0, 0.0], shares: [1.0, twist] };
    let skin = Skin {
        vertices: vec![[0.2, 0.1, 0.0], [0.2, 0.5, 0.0], [0.2, 0.9, 0.1], [-0.2, 0.5, 0.0]],
        triangles: vec![[0, 1, 3], [1, 2, 3], [2, 1, 3], [1, 0, 3]],
        light: vec![255; 4],
        bones: vec![[2, 0, 0, 0], [1, 0, 0, 0], [0, 0, 0, 0], [1, 0, 0, 0]],
        weights: vec![[255, 0, 0, 0]; 4],
        nodes: vec![bone(0, 0, 1.0), bone(0, 1, 0.5), bone(1, 1, 1.0)],
        segments: vec![followed([rest, rest]), followed([rest, turned])],
    };
    Report {
        segments: vec![segment([rest, rest]), segment([rest, rest])],
        skin: Some(skin),
        moments: Moments::Times(vec![0.0, 1.0]),
        ..Report::default()
    }
}

#[test]
#[ignore = "needs a browser: a Chromium, also by CONTRAPPOSTO_CHROMIUM"]
fn bones_turn_by_their_shares_and_the_wooden_figure_is_a_choice() {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("skin.html");
    std::fs::write(&path, write(&report())).unwrap();
    let mut page = Chromium::start();
    page.open(&path);
    let points = page.evaluate(POINTS);
    // Corners of the mesh: at the whole turn, at half of it, and unmoved.
    for (vertex, angle) in [(0, 1.0_f64), (1, 0.5), (2, 0.0)] {
        let [x, z] = [0, 2].map(|k| points[6 * vertex + k].as_f64().unwrap());
        let z0 = if vertex == 2 { 0.1 } else { 0.0 };
        let wanted = [0.2 * libm::cos(angle) + z0 * libm::sin(angle), z0 * libm::cos(angle) - 0.2 * libm::sin(angle)];
        assert!(libm::hypot(x - wanted[0], z - wanted[1]) < 1e-3, "vertex {vertex}: {x} {z}, not {wanted:?}");
    }
    let skin = page.evaluate(PICTURE);
    page.evaluate("document.querySelector('[data-figure=wooden]').click()");
    let wooden = page.evaluate(PICTURE);
    assert_ne!(skin, wooden);
    let pressed = "[...document.querySelectorAll('[data-figure]')].map((button) => button.ariaPressed)";
    assert_eq!(page.evaluate(pressed), json!(["false", "true"]));
    page.evaluate("document.querySelector('[data-figure=skin]').click()");
    assert_eq!(page.evaluate(PICTURE), skin);
    assert_eq!(page.complaints(), Vec::<String>::new());

    std::fs::write(&path, write(&Report { skin: None, ..report() })).unwrap();
    page.open(&path);
    assert_eq!(page.evaluate("document.getElementById('figure').hidden"), true);
    assert_eq!(page.complaints(), Vec::<String>::new());
}

/// Skin is not white, and its brightness does not change the colour that the key explains; cloth, of which there is less, is darker.
#[test]
#[ignore = "needs a browser: a Chromium, also by CONTRAPPOSTO_CHROMIUM"]
fn bare_skin_that_faces_the_viewer_has_the_colour_of_the_key() {
    let mut report = report();
    let skin = report.skin.as_mut().unwrap();
    skin.triangles = vec![[0, 1, 3], [1, 2, 3]];
    skin.light = vec![186, 186, 186, 150];
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("lit-skin.html");
    std::fs::write(&path, write(&report)).unwrap();
    let mut page = Chromium::start();
    page.open(&path);
    let count = "(() => { document.querySelector('[data-view=side]').click();
      const c = document.getElementById('body'), gl = c.getContext('webgl'), p = new Uint8Array(4 * c.width * c.height);
      gl.readPixels(0, 0, c.width, c.height, gl.RGBA, gl.UNSIGNED_BYTE, p);
      const wanted = styleColor('--none').map((v) => 255 * v);
      let count = 0;
      for (let i = 0; i < p.length; i += 4) if (wanted.every((v, k) => Math.abs(p[i + k] - v) <= 8)) count++;
      return count; })()";
    assert!(page.evaluate(count).as_u64().unwrap() > 100, "no pixel of the skin is within 3 % of its colour");
    assert_eq!(page.complaints(), Vec::<String>::new());
}
