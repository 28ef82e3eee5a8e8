//! dbg
use tangency::core::continuation::*;
use tangency::core::dense::Dense;
use tangency::core::scalar::Scalar;
use tangency::core::zero::{Names, ZeroProblem};
struct PredatorPrey;
impl ZeroProblem for PredatorPrey {
    fn names(&self) -> Names {
        Names::new(["x", "y"], ["p"])
    }
    fn residual<T: Scalar>(&self, z: &[T], p: &[T], r: &mut [T]) {
        let (x, y) = (z[0], z[1]);
        r[0] = x * 3.0 * (T::one() - x) - x * y - p[0] * (T::one() - (x * -5.0).exp());
        r[1] = x * y * 3.0 - y;
    }
}
fn main() {
    let mut system = Dense::new(PredatorPrey);
    let t = Continuation::of(&mut system).named("trivial").along("p", 0.0..=1.0).trace().unwrap();
    for p in &t.points { println!("{:?}", p); }
    println!("{:?} {:?}", t.ends, t.special);
}
