//! Names the rules by which paths lie on surfaces.

/// Rule by which OpenSim chooses the plane of a path over an ellipsoid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WrapMethod {
    /// A blend of the two others.
    #[default]
    Hybrid,
    /// A point half way.
    Midpoint,
    /// A point along the axis that is most across the path.
    Axial,
}

/// The rule by which a path lies on its surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PathRule {
    /// Shortest lines on the surfaces: moment arms are the derivatives of the length, so that forces of length are conservative.
    #[default]
    Geodesic,
    /// The rule of OpenSim 4, for comparisons with it: its lines are not the shortest ones, and its moment arms, those of a tension
    /// along the line, are not the derivatives of its length.
    OpenSim,
}
