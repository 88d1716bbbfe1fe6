//! Computes the line of a tendon of MuJoCo: from site to site, round at most one sphere or cylinder between two sites, in parts that
//! pulleys divide.
//!
//! Each part between two sites is independent of the others, so that no search for rest is needed. The rules are those of MuJoCo's
//! `mj_tendon` and `mju_wrap` (engine sources, read for the facts; where version 4.0 differs from them, found from its answers).

mod around;
mod circle;
mod inside;
mod line;
mod parts;

pub use parts::{Around, RoundShape, SidePoint, Tendon, TendonGeom, TendonPart};
