//! Clips lines, cuts dashes, and spreads labels so that they do not overlap: pure functions of points on the sheet.

/// A point on the sheet, px: x right, y down.
pub(crate) type Point = (f64, f64);

/// An upright rectangle on the sheet, px.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rect {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
}

impl Rect {
    pub(crate) fn right(&self) -> f64 {
        self.left + self.width
    }

    pub(crate) fn bottom(&self) -> f64 {
        self.top + self.height
    }

    pub(crate) fn contains(&self, (x, y): Point) -> bool {
        (self.left..=self.right()).contains(&x) && (self.top..=self.bottom()).contains(&y)
    }
}

/// The parts of a line inside the rectangle.
pub(crate) fn clip(points: &[Point], window: Rect) -> Vec<Vec<Point>> {
    let mut parts: Vec<Vec<Point>> = Vec::new();
    for pair in points.windows(2) {
        let Some((start, end)) = clip_segment(pair[0], pair[1], window) else {
            continue;
        };
        match parts.last_mut() {
            Some(part) if part.last() == Some(&start) => part.push(end),
            _ => parts.push(vec![start, end]),
        }
    }
    parts
}

/// The part of one segment inside the rectangle (Liang and Barsky 1984): the segment is `a + t (b - a)`,
/// every edge narrows the interval of `t`.
fn clip_segment(a: Point, b: Point, window: Rect) -> Option<(Point, Point)> {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    // Each edge as (speed towards the outside, distance to the edge on the inside).
    for (speed, room) in
        [(-dx, a.0 - window.left), (dx, window.right() - a.0), (-dy, a.1 - window.top), (dy, window.bottom() - a.1)]
    {
        if speed == 0.0 {
            if room < 0.0 {
                return None;
            }
        } else if speed < 0.0 {
            from = from.max(room / speed);
        } else {
            to = to.min(room / speed);
        }
    }
    if from > to {
        return None;
    }
    let at = |t: f64| match t {
        0.0 => a,
        1.0 => b,
        t => (a.0 + t * dx, a.1 + t * dy),
    };
    Some((at(from), at(to)))
}

/// The part of a convex polygon inside the rectangle (Sutherland and Hodgman 1974): each edge of the rectangle cuts off the corners
/// beyond it.
pub(crate) fn clip_polygon(corners: &[Point], window: Rect) -> Vec<Point> {
    let mut left = corners.to_vec();
    // Room to each edge, positive inside.
    let rooms: [&dyn Fn(Point) -> f64; 4] =
        [&|p| p.0 - window.left, &|p| window.right() - p.0, &|p| p.1 - window.top, &|p| window.bottom() - p.1];
    for room in rooms {
        let mut inside = vec![];
        for (i, &b) in left.iter().enumerate() {
            let a = left[(i + left.len() - 1) % left.len()];
            let (from, to) = (room(a), room(b));
            if (from < 0.0) != (to < 0.0) {
                let t = from / (from - to);
                inside.push((a.0 + t * (b.0 - a.0), a.1 + t * (b.1 - a.1)));
            }
            if to >= 0.0 {
                inside.push(b);
            }
        }
        left = inside;
    }
    left
}

/// The dashes of a line: `dash` px drawn, `gap` px left out, and so on along the whole line.
pub(crate) fn dashes(points: &[Point], dash: f64, gap: f64) -> Vec<Vec<Point>> {
    let mut parts: Vec<Vec<Point>> = Vec::new();
    let mut drawing = true;
    let mut left = dash; // px until the pen is lifted or lowered
    let mut open: Vec<Point> = points.first().copied().into_iter().collect();
    for pair in points.windows(2) {
        let (mut here, there) = (pair[0], pair[1]);
        let mut length = libm::hypot(there.0 - here.0, there.1 - here.1);
        while length > left {
            let share = left / length;
            here = (here.0 + share * (there.0 - here.0), here.1 + share * (there.1 - here.1));
            length -= left;
            if drawing {
                open.push(here);
                parts.push(std::mem::take(&mut open));
            } else {
                open = vec![here];
            }
            drawing = !drawing;
            left = if drawing { dash } else { gap };
        }
        left -= length;
        if drawing {
            open.push(there);
        }
    }
    if open.len() > 1 {
        parts.push(open);
    }
    parts
}

/// A label `width` px wide whose preferred centre is `wanted`, px.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slot {
    pub(crate) wanted: f64,
    pub(crate) width: f64,
}

/// Centres of the slots near their preferred ones, without overlap, between `low` and `high`.
///
/// The slots come in the order of `wanted`, and together they are no wider than `high - low`. Neighbours that would
/// overlap form a block; a block stands at the mean of its members' preferred places.
pub(crate) fn spread(slots: &[Slot], low: f64, high: f64) -> Vec<f64> {
    struct Block {
        members: usize,
        width: f64,
        /// Sum of the left edges that the members prefer for the block.
        lefts: f64,
    }
    let left_of = |block: &Block| {
        let wanted = block.lefts / block.members as f64;
        wanted.min(high - block.width).max(low)
    };
    let mut blocks: Vec<Block> = Vec::new();
    for slot in slots {
        let mut block = Block { members: 1, width: slot.width, lefts: slot.wanted - slot.width / 2.0 };
        while let Some(before) = blocks.pop_if(|b| left_of(b) + b.width > left_of(&block)) {
            block = Block {
                members: before.members + block.members,
                lefts: before.lefts + block.lefts - before.width * block.members as f64,
                width: before.width + block.width,
            };
        }
        blocks.push(block);
    }
    let mut centers = Vec::with_capacity(slots.len());
    let mut rest = slots.iter();
    for block in &blocks {
        let mut left = left_of(block);
        for slot in rest.by_ref().take(block.members) {
            centers.push(left + slot.width / 2.0);
            left += slot.width;
        }
    }
    centers
}

#[cfg(test)]
mod tests {
    use super::*;

    const WINDOW: Rect = Rect { left: 0.0, top: 0.0, width: 10.0, height: 10.0 };

    #[test]
    fn clipping_a_line_that_leaves_the_window_twice_gives_two_parts() {
        let parts = clip(&[(-5.0, 5.0), (5.0, 5.0), (5.0, 20.0), (8.0, 20.0), (8.0, 2.0)], WINDOW);
        assert_eq!(parts, [vec![(0.0, 5.0), (5.0, 5.0), (5.0, 10.0)], vec![(8.0, 10.0), (8.0, 2.0)]]);
    }

    #[test]
    fn clipping_a_triangle_at_an_edge_gives_a_quadrilateral_and_one_outside_gives_nothing() {
        let clipped = clip_polygon(&[(-4.0, 2.0), (4.0, 2.0), (4.0, 6.0)], WINDOW);
        assert_eq!(clipped, [(0.0, 4.0), (0.0, 2.0), (4.0, 2.0), (4.0, 6.0)]);
        assert!(clip_polygon(&[(-4.0, 2.0), (-1.0, 2.0), (-1.0, 6.0)], WINDOW).is_empty());
    }

    #[test]
    fn the_dash_pattern_continues_around_a_corner() {
        let parts = dashes(&[(0.0, 0.0), (3.0, 0.0), (3.0, 4.0)], 2.0, 2.0);
        assert_eq!(parts, [vec![(0.0, 0.0), (2.0, 0.0)], vec![(3.0, 1.0), (3.0, 3.0)],]);
    }

    #[test]
    fn overlapping_slots_are_moved_apart_within_the_bounds() {
        let slots = [1.0, 2.0, 2.0, 50.0, 99.0].map(|wanted| Slot { wanted, width: 10.0 });
        let centers = spread(&slots, 0.0, 100.0);
        assert_eq!(centers, [5.0, 15.0, 25.0, 50.0, 95.0]);
    }
}
