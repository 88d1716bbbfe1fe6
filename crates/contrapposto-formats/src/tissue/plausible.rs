//! Warns of models that cannot be what their author meant: without mass, or in another unit of length.

use contrapposto::kinematics::Kinematics;
use nalgebra::Vector3;

use super::SourcedModel;

/// A larger body is not in metres, m.
const LARGEST_BODY: f64 = 100.0;

impl SourcedModel {
    /// Reasons to doubt that the model is what its author meant, a sentence each.
    pub fn warnings(&self) -> Vec<String> {
        let model = &self.model;
        let mut warnings = vec![];
        if !model.segments().is_empty() && model.mass() == 0.0 {
            let all = "no segment has mass: all torques of weight are 0";
            warnings.push(format!("`{}`: {all}", model.name()));
        }
        let kinematics = Kinematics::new(model);
        let origins = (0..model.segments().len()).map(|s| kinematics.placement(model, s).translation.vector);
        let points: Vec<Vector3<f64>> = origins.chain(kinematics.center_of_mass(model)).collect();
        let lowest = points.iter().fold(Vector3::repeat(f64::INFINITY), |low, point| low.inf(point));
        let highest = points.iter().fold(Vector3::repeat(f64::NEG_INFINITY), |high, point| high.sup(point));
        let extent = (highest - lowest).max();
        if extent > LARGEST_BODY {
            warnings.push(format!(
                "`{}`: joints and centre of mass lie up to {extent:.1} m apart; lengths are read as metres, are they millimetres?",
                model.name()
            ));
        }
        warnings
    }
}
