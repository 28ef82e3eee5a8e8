//! A regression test on a bifurcation point, as the book shows it.
use tangency::core::system::Kind;
use tangency::scene::{BUILT_IN, Scene, execute};

#[test]
fn the_device_pulls_in_where_it_did() {
    let device = BUILT_IN.iter().find(|scene| scene.name == "plate-device").unwrap();
    let mut scene = Scene::parse(device.text).unwrap();
    scene.set("gap", "1.9e-6").unwrap();
    let outcome = execute(&scene, None, &mut ());
    assert_eq!(outcome.error, None);
    let plate = outcome.document.branch("plate").unwrap();
    let fold = plate.of_kind(Kind::LP).next().expect("a fold");
    let voltage = fold.value(plate.column("voltage").unwrap()).unwrap();
    println!("pull-in at {voltage} V, error {:.0e} V", fold.error);
    assert!(fold.converged && fold.error < 1e-6);
    assert!((voltage - 63.718073).abs() < 1e-6 + fold.error);
}
