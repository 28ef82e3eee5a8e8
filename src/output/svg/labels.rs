//! Where the labels of marks stand: near their mark, off the curves, off each other.

/// A rectangle in pixels: left, top, right, bottom.
pub(super) type Rectangle = [f64; 4];

const ADVANCE: f64 = 13.0;
/// Marks of one kind that are nearer than this share a label.
const CROWDED: f64 = 16.0;

/// Chooses a place for every label, in order; `None` where each place is taken by a label or a
/// mark, or where the same label stands close by.
///
/// `marks` are the points in pixels with the sizes of their labels, `curves` points in pixels some
/// three pixels apart, `frame` the rectangle that labels may not leave.
pub(super) fn place(
    marks: &[([f64; 2], &str, [f64; 2])],
    curves: &[[f64; 2]],
    frame: Rectangle,
) -> Vec<Option<[f64; 2]>> {
    let symbols: Vec<Rectangle> =
        marks.iter().map(|(at, _, _)| around(*at, [11.0, 11.0])).collect();
    let mut taken: Vec<Rectangle> = Vec::new();
    let mut centres: Vec<Option<[f64; 2]>> = Vec::new();
    for (index, (at, label, size)) in marks.iter().enumerate() {
        // A crowd of marks of one kind would write the same letters over and over.
        let repeated = marks[..index].iter().zip(&centres).any(|((other, text, _), centre)| {
            let distance = (other[0] - at[0]).hypot(other[1] - at[1]);
            text == label && Option::is_some(centre) && distance < CROWDED
        });
        let best = directions().filter_map(|(preference, direction)| {
            let reach = [ADVANCE + size[0] / 2.0 - 5.0, ADVANCE + size[1] / 2.0 - 5.0];
            let centre = [at[0] + direction[0] * reach[0], at[1] + direction[1] * reach[1]];
            let rectangle = around(centre, *size);
            let free = within(rectangle, frame)
                && !taken.iter().chain(&symbols).any(|other| overlap(rectangle, *other));
            let wide = around(centre, [size[0] + 4.0, size[1] + 2.0]);
            let on_curves = curves.iter().filter(|point| contains(wide, **point)).count() as f64;
            free.then_some((preference + on_curves, centre, rectangle))
        });
        let best = best.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|_| !repeated);
        taken.extend(best.map(|(_, _, rectangle)| rectangle));
        centres.push(best.map(|(_, centre, _)| centre));
    }
    centres
}

/// The eight directions, two rings of them, with the preference for each (less is better).
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

/// Points some three pixels apart on a line.
pub(super) fn sampled(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let between = |pair: &[[f64; 2]]| {
        let (from, to) = (pair[0], pair[1]);
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let number = (length / 3.0).ceil().max(1.0) as usize;
        (0..number).map(move |i| {
            let t = i as f64 / number as f64;
            [from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1])]
        })
    };
    points.windows(2).flat_map(between).chain(points.last().copied()).collect()
}
