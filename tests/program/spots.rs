//! Promise: spots of sweeps are drawn exactly at their places, and take little room in a file.

#[allow(dead_code)]
#[path = "../../src/output/drawing/spots.rs"]
mod short;

use short::{joined, stacks};

#[test]
fn spots_keep_their_places() {
    let centres = [(7, 100), (5, 30), (5, 22), (5, 22), (5, 60)];
    let stacks = stacks(centres.into_iter(), 12);
    assert_eq!(stacks, [[5, 16, 36], [5, 54, 66], [7, 94, 106]]);
}

#[test]
fn vertical_lines_become_one_path() {
    let line = |colour: &str, points: &str| {
        format!("<polyline fill=\"none\" stroke=\"{colour}\" points=\"{points}\"/>\n")
    };
    let lines = [
        line("#000", "1,2 1,3 "),
        line("#000", "5,2 5,9 "),
        line("#111", "5,2 5,9 "),
        line("#111", "5,2 6,9 "),
    ];
    let path = "<path fill=\"none\" stroke=\"#000\" d=\"M1 2V3M5 2V9\"/>\n";
    assert_eq!(joined(&lines.concat()), format!("{path}{}", lines[2..].concat()));
}
