//! Three problems of one's own, with the whole command line.

mod ball;
mod smooth;

use ball::Ball;
use smooth::{Brusselator, Rod};
use std::process::ExitCode;
use tangency::prelude::*;

fn main() -> ExitCode {
    tangency::cli::run(
        Catalogue::built_in()
            .hybrid("Ball", Ball)
            .field("Brusselator", Brusselator)
            .zero("Rod", Rod)
            .scene("ball", include_str!("../scenes/ball.ron"))
            .scene("brusselator", include_str!("../scenes/brusselator.ron"))
            .scene("rod", include_str!("../scenes/rod.ron")),
    )
}
