//! Placement of the labels of marks and the names of curves: near their own curve, away from other
//! curves and labels.

/// A rectangle in units of the canvas: left, top, right, bottom.
pub(super) type Rectangle = [f64; 4];

const ADVANCE: f64 = 13.0;
/// The distance between marks of the same kind below which the marks share one label.
const CROWDED: f64 = 16.0;
/// The number of points along a curve beside which the name of the curve may be placed.
const TRIED: usize = 40;
/// The distance between a curve and its name, and the distance from the name within which other
/// curves make the name ambiguous.
const BESIDE: f64 = 4.0;
const CONFUSING: f64 = 14.0;
/// The largest distance between neighbouring points of a sampled curve.
pub(super) const SAMPLED: f64 = 3.0;
/// The weight of a nearby point of a name's own curve, relative to the weight of a nearby point of
/// another curve.
const LENGTH: f64 = 0.05;

/// The distance between a curve and a text beside the curve; half the width of the strip between
/// curve and text that other curves must not enter; and the smallest number of points of a curve
/// with such texts.
const ASIDE: f64 = 2.5;
const ACROSS: f64 = 4.0;
const SHORTEST: usize = 9;

/// The label of a mark.
pub(super) struct Wanted<'a> {
    /// The position of the mark.
    pub at: [f64; 2],
    pub label: &'a str,
    /// The width and height of the label.
    pub size: [f64; 2],
}

/// The free space in a panel, in which labels can be placed.
pub(super) struct Room {
    /// The rectangle that must contain all labels.
    frame: Rectangle,
    /// The rectangles that marks and labels occupy.
    taken: Vec<Rectangle>,
    /// The points of all curves, sampled about three units apart.
    curves: Vec<[f64; 2]>,
}

impl Room {
    /// Creates the free space for labels within a frame.
    pub fn new(frame: Rectangle) -> Self {
        Room { frame, taken: Vec::new(), curves: Vec::new() }
    }

    /// Chooses the places of the labels of marks, in the order of the marks; a place is `None` if
    /// labels or marks occupy all candidates, or if the same label is nearby. `curves` contains
    /// points on all curves, about three units apart.
    pub fn place_labels(
        &mut self,
        marks: &[Wanted],
        curves: Vec<[f64; 2]>,
    ) -> Vec<Option<[f64; 2]>> {
        self.curves = curves;
        self.taken.extend(marks.iter().map(|wanted| around(wanted.at, [11.0, 11.0])));
        let mut centres: Vec<Option<[f64; 2]>> = vec![None; marks.len()];
        for (index, Wanted { at, label, size }) in marks.iter().enumerate() {
            // A cluster of marks of the same kind would repeat the same label.
            let repeated = marks.iter().zip(&centres).any(|(other, centre)| {
                let distance = (other.at[0] - at[0]).hypot(other.at[1] - at[1]);
                other.label == *label && Option::is_some(centre) && distance < CROWDED
            });
            let best = directions().filter_map(|(preference, direction)| {
                let reach = [ADVANCE + size[0] / 2.0 - 5.0, ADVANCE + size[1] / 2.0 - 5.0];
                let centre = [at[0] + direction[0] * reach[0], at[1] + direction[1] * reach[1]];
                let wide = around(centre, [size[0] + 4.0, size[1] + 2.0]);
                let on_curves = count(&self.curves, wide) as f64;
                let is_free = self.is_free(around(centre, *size));
                is_free.then_some((preference + on_curves, centre))
            });
            let best =
                best.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|_| !repeated && !label.is_empty());
            let centre = best.map(|(_, centre)| centre);
            self.taken.extend(centre.map(|centre| around(centre, *size)));
            centres[index] = centre;
        }
        centres
    }

    /// Places the name of a curve, which is given by points about three units apart: the name must
    /// not cover a curve, and is nearer to its own curve than to others. Returns `None` if no place
    /// for the name is suitable.
    pub fn place_name(&mut self, own: &[[f64; 2]], size: [f64; 2]) -> Option<[f64; 2]> {
        let step = own.len().div_ceil(TRIED).max(1);
        let reach = size.map(|side| side / 2.0 + BESIDE + 1.0);
        let nearby = size.map(|side| side + 2.0 * CONFUSING);
        let places = own.iter().step_by(step).flat_map(|at| {
            directions().map(move |(preference, [x, y])| {
                (preference, [at[0] + x * reach[0], at[1] + y * reach[1]])
            })
        });
        let best = places.filter_map(|(preference, centre)| {
            let wide = around(centre, size.map(|side| side + 2.0 * BESIDE - 2.0));
            let covers = |points: &[[f64; 2]]| points.iter().any(|point| contains(wide, *point));
            if !self.is_free(around(centre, size)) || covers(&self.curves) {
                return None;
            }
            // A long stretch of the curve beside its name is the least ambiguous.
            let beside = count(own, around(centre, size.map(|side| side + 4.0 * BESIDE)));
            let nearby = around(centre, nearby);
            let others = count(&self.curves, nearby) - count(own, nearby);
            (beside > 0).then_some((preference + others as f64 - LENGTH * beside as f64, centre))
        });
        let (_, centre) = best.min_by(|a, b| a.0.total_cmp(&b.0))?;
        self.taken.push(around(centre, size));
        Some(centre)
    }

    /// Places two texts of given sizes on the left and on the right of a part of a curve, which is
    /// given by points about three units apart with `y` downwards: as near to the middle of the
    /// part as possible, and opposite each other if possible.
    pub fn place_beside(
        &mut self,
        own: &[[f64; 2]],
        sizes: [[f64; 2]; 2],
    ) -> [Option<[f64; 2]>; 2] {
        if own.len() < SHORTEST {
            return [None; 2];
        }
        let middle = own.len() / 2;
        let mut order: Vec<usize> = (2..own.len() - 2).collect();
        order.sort_by_key(|k| k.abs_diff(middle));
        let left = |k: usize| self.place_aside([own[k - 1], own[k], own[k + 1]], 1.0, sizes[0]);
        let right = |k: usize| self.place_aside([own[k - 1], own[k], own[k + 1]], -1.0, sizes[1]);
        let both = order.iter().find_map(|&k| Some([Some(left(k)?), Some(right(k)?)]));
        let each = || [order.iter().find_map(|&k| left(k)), order.iter().find_map(|&k| right(k))];
        let places = both.unwrap_or_else(each);
        for (place, size) in places.iter().zip(sizes) {
            self.taken.extend(place.map(|centre| around(centre, size)));
        }
        places
    }

    /// Returns the place of a text beside the second of three points of a curve, on the left side
    /// (1) or the right side (−1), unless the place is occupied.
    fn place_aside(
        &self,
        [from, at, to]: [[f64; 2]; 3],
        side: f64,
        size: [f64; 2],
    ) -> Option<[f64; 2]> {
        let [x, y] = [to[0] - from[0], to[1] - from[1]];
        let length = x.hypot(y);
        let normal = [side * y / length, -side * x / length];
        let reach = 0.5 * (normal[0].abs() * size[0] + normal[1].abs() * size[1]) + ASIDE;
        let centre = [at[0] + reach * normal[0], at[1] + reach * normal[1]];
        let between = |[x, y]: &[f64; 2]| {
            let [x, y] = [x - at[0], y - at[1]];
            let away = x * normal[0] + y * normal[1];
            let along = x * normal[1] - y * normal[0];
            away > 1.5 && away < reach && along.abs() < ACROSS
        };
        let near = around(centre, size.map(|side| side + ASIDE));
        let free = self.is_free(around(centre, size))
            && count(&self.curves, near) == 0
            && !self.curves.iter().any(between);
        free.then_some(centre)
    }

    /// Frees the given number of places that were chosen most recently for labels.
    pub fn release(&mut self, count: usize) {
        self.taken.truncate(self.taken.len() - count);
    }

    fn is_free(&self, place: Rectangle) -> bool {
        within(place, self.frame) && !self.taken.iter().any(|other| overlap(place, *other))
    }
}

fn count(points: &[[f64; 2]], place: Rectangle) -> usize {
    points.iter().filter(|point| contains(place, **point)).count()
}

/// Returns 16 directions from a mark to its label, eight for each of two distances, and the penalty
/// for each direction.
fn directions() -> impl Iterator<Item = (f64, [f64; 2])> {
    const D: f64 = 0.75;
    let near =
        [[1.0, 0.0], [D, -D], [0.0, -1.0], [-D, -D], [-1.0, 0.0], [D, D], [0.0, 1.0], [-D, D]];
    let ring = move |preference: f64, stretch: f64| {
        near.into_iter().enumerate().map(move |(index, direction)| {
            let direction = direction.map(|component| component * stretch);
            (preference + 0.1 * index as f64, direction)
        })
    };
    ring(0.0, 1.0).chain(ring(5.0, 1.6))
}

fn around([x, y]: [f64; 2], [width, height]: [f64; 2]) -> Rectangle {
    [x - width / 2.0, y - height / 2.0, x + width / 2.0, y + height / 2.0]
}

fn overlap(a: Rectangle, b: Rectangle) -> bool {
    a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
}

fn within(inner: Rectangle, outer: Rectangle) -> bool {
    inner[0] >= outer[0] && inner[1] >= outer[1] && inner[2] <= outer[2] && inner[3] <= outer[3]
}

fn contains(rectangle: Rectangle, [x, y]: [f64; 2]) -> bool {
    rectangle[0] <= x && x <= rectangle[2] && rectangle[1] <= y && y <= rectangle[3]
}

/// Samples a line at points about three units apart.
pub(super) fn sampled(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let between = |pair: &[[f64; 2]]| {
        let (from, to) = (pair[0], pair[1]);
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let number = (length / SAMPLED).ceil().max(1.0) as usize;
        (0..number).map(move |i| {
            let t = i as f64 / number as f64;
            [from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1])]
        })
    };
    points.windows(2).flat_map(between).chain(points.last().copied()).collect()
}
