//! Holds outlines and lines on the sheet as a list of steps, the form that the SVG writer and the PNG renderer share.

use crate::geometry::Point;

/// One step of a path; points in px.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Step {
    Move(Point),
    Line(Point),
    /// A cubic Bézier curve: two control points and the end.
    Curve(Point, Point, Point),
    /// A straight line back to the last [`Step::Move`].
    Close,
}

/// Steps of one or several lines.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Path(pub(crate) Vec<Step>);

impl Path {
    /// Straight lines through the points of every list.
    pub(crate) fn lines(lines: &[Vec<Point>]) -> Self {
        let points = lines.iter().flat_map(|line| line.iter().enumerate());
        Self(points.map(|(i, &point)| if i == 0 { Step::Move(point) } else { Step::Line(point) }).collect())
    }

    /// A polygon.
    pub(crate) fn polygon(corners: &[Point]) -> Self {
        let mut path = Self::lines(&[corners.to_vec()]);
        path.0.push(Step::Close);
        path
    }
}
