//! The promises of every sample of a body on supports.

use contrapposto::contact::{Slip, Support};
use contrapposto::kinematics::Kinematics;
use contrapposto::model::Model;
use contrapposto::posture::Posture;
use contrapposto::simulation::{Contact, Sample, Scenario};
use nalgebra::Vector3;

/// Every adult is taller than this, m.
const STATURE: f64 = 1.5;
const ROOTS: [&str; 6] = ["pelvis_tx", "pelvis_ty", "pelvis_tz", "pelvis_tilt", "pelvis_list", "pelvis_rotation"];

/// The worst of all samples.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Worst {
    pub(crate) samples: usize,
    /// Force left on the root, as a share of weight.
    pub(crate) force: f64,
    /// Moment left on the root, as a share of weight times stature.
    pub(crate) moment: f64,
    /// Greatest share of the slip that a result warns of, distance or angle.
    pub(crate) slip: f64,
    /// Pull of a support, or friction beyond its limit, as a share of weight.
    pub(crate) beyond: f64,
    /// Distance of a centre of pressure outside of its patch, m.
    pub(crate) outside: f64,
}

impl Worst {
    /// Takes in a sample; ranges, Eq. 1 and fatigue are judged here.
    pub(crate) fn take(&mut self, scenario: &Scenario, sample: &Sample) {
        let model = &scenario.model;
        let weight = model.mass() * model.gravity().norm();
        let standing = sample.standing.unwrap();
        self.samples += 1;
        for (i, name) in ROOTS.iter().enumerate() {
            let left = sample.external[model.coordinate(name).unwrap()].abs() / weight;
            if i < 3 { self.force = self.force.max(left) } else { self.moment = self.moment.max(left / STATURE) }
        }
        self.slip = self.slip.max(standing.slip.share_of(Slip::NOTICED));
        for (i, coordinate) in model.coordinates().iter().enumerate() {
            assert_eq!(sample.external[i] + sample.passive[i] + sample.active[i], 0.0);
            assert!((coordinate.range.0..=coordinate.range.1).contains(&sample.posture[i]), "{}", coordinate.name);
            assert!(sample.fatigue[i].iter().all(|level| (0.0..=1.0).contains(level)));
        }
        for (support, contact) in scenario.supports.iter().zip(&standing.contacts) {
            let normal = contact.force.dot(&support.normal);
            let along = (contact.force - normal * support.normal).norm();
            self.beyond = self.beyond.max(-normal / weight).max((along - support.friction * normal) / weight);
            self.outside = self.outside.max(outside_the_patch(model, sample.posture, support, contact));
        }
    }

    /// The root is in equilibrium, forces stay within friction and patches.
    pub(crate) fn is_held(&self, name: &str) {
        println!("{name}: {self:?}");
        assert!(self.force < 1e-8 && self.moment < 1e-8, "{name}");
        assert!(self.beyond < 1e-9, "{name}: {}", self.beyond);
        assert!(self.outside < 1e-6, "{name}: {} m", self.outside);
    }
}

/// Distance of the centre of pressure of a support outside of its patch, m: in sixteen directions along its plane no corner may
/// lie behind it.
fn outside_the_patch(model: &Model, posture: &[f64], support: &Support, contact: &Contact) -> f64 {
    let Some(center) = contact.center_of_pressure else { return 0.0 };
    let mut kinematics = Kinematics::new(model);
    kinematics.update(model, &Posture::new(posture.to_vec())).unwrap();
    let corners: Vec<_> =
        support.corners.iter().map(|corner| kinematics.station(model, support.segment, *corner) - center).collect();
    let along =
        support.normal.cross(&if support.normal.x.abs() < 0.5 { Vector3::x() } else { Vector3::y() }).normalize();
    let across = support.normal.cross(&along);
    let farthest = |angle: f64| {
        let direction = libm::cos(angle) * along + libm::sin(angle) * across;
        corners.iter().map(|corner| corner.dot(&direction)).fold(f64::NEG_INFINITY, f64::max)
    };
    (0..16).map(|i| -farthest(f64::from(i) * std::f64::consts::TAU / 16.0)).fold(0.0, f64::max)
}

/// The bits of a sample.
pub(crate) fn digest(sample: &Sample) -> u64 {
    let mut hash = 0;
    let parts = [sample.posture, sample.external, sample.passive, sample.active, sample.load];
    let contacts =
        sample.standing.iter().flat_map(|s| s.contacts.iter().flat_map(|c| [c.force.x, c.force.y, c.force.z]));
    for value in parts.into_iter().flatten().chain(sample.fatigue.iter().flatten()).copied().chain(contacts) {
        hash = (hash ^ value.to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
    }
    hash
}
