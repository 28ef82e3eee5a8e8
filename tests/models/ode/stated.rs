//! What XPPAUT's language means: values that xppaut prints, options, names, and motion.

use super::{model, read};
use crate::common::close;
use tangency::core::hybrid::{HybridFlow, HybridSettings, HybridState};
use tangency::core::problem::DiscreteMap;
use tangency::core::problem::VectorField;
use tangency::language::xpp::Options;
use tangency::language::{Model, Statement};

/// What is declared where formulas are evaluated.
const DECLARED: &str =
    "par p=3,q=-2,z=0\nnumber n=4\nf(a,b)=a-2*b\ng(t)=t*p\nw0=p+1\nw1=w0*x\nw2=7\nx'=0\n";
/// Formulas with the values that xppaut 6.11 writes, in single precision, where `x` is 2.
#[rustfmt::skip]
const VALUES: &[(&str, f64)] = &[
    ("-p^2", -9.0),
    ("2^3^2", 64.0),
    ("10-4-3", 3.0),
    ("p>2+2", 3.0),
    ("1>2&0", 0.0),
    ("1|0&0", 1.0),
    ("2*3>1", 2.0),
    ("not(p)", 0.0),
    ("not(z)+1", 2.0),
    ("flr(-1.5)", -2.0),
    ("mod(-1,3)", 2.0),
    ("heav(0)", 1.0),
    ("heav(-p)", 0.0),
    ("sign(0)", 0.0),
    ("sign(q)", -1.0),
    ("log(3)", 1.0986123),
    ("log10(100)", 2.0),
    ("1/2/2", 0.25),
    ("if(x>1)then(5)else(6)+1", 6.0),
    ("2**3", 8.0),
    ("mod(5.5,-3)", 2.5),
    ("mod(-5.5,-3)", -5.5),
    ("mod(-5.5,q)", -3.5),
    ("sum(1,10)of(i')", 55.0),
    ("sum(1,n)of(i'*i')", 30.0),
    ("sum(3,1)of(1)", 0.0),
    ("p!=3", 0.0),
    ("atan2(1,-1)", 2.3561945),
    ("max(1,2)+min(1,2)", 3.0),
    ("1.e1+.5E+1-2e-0", 13.0),
    ("(-8)^3", -512.0),
    ("2^(-2)", 0.25),
    ("f(p,q)", 7.0),
    ("g(x)", 6.0),
    ("shift(w0,2)", 7.0),
    ("sum(0,2)of(shift(w0,i'))", 19.0),
    ("shift(p,1)", -2.0),
    ("-x*q", 4.0),
    ("-x>q", -1.0),
    ("x-1>0", 1.0),
    ("1<2<3", 1.0),
    ("x==2", 1.0),
    ("x>=2|q", 1.0),
    ("-(p)&z", 0.0),
    ("abs(q)^2/4*p", 3.0),
    ("pi*X", 6.2831855),
    ("~p+1", -2.0),
    ("sum(0,1.9)of(shift(w0,i'+1))", 15.0),
    ("shift(x,1.9)", 4.0),
    ("cosh(1)-sinh(1)+tanh(.5)", 0.82999659),
    ("exp(ln(3))", 3.0),
    ("sqrt(2)*acos(.5)*asin(.5)*atan(2)", 0.85851562),
    ("not p>2", 0.0),
    ("1>x^2", 0.0),
    ("x^2>1", 1.0),
    ("if(p&q)then(if(z)then(1)else(2))else(3)", 2.0),
    ("1-if(z)then(1)else(2)-1", -2.0),
];

#[test]
fn formulas_have_the_values_that_xppaut_writes() {
    for (formula, expected) in VALUES {
        let Model::Field(field) = model(&format!("{DECLARED}aux a={formula}\n")) else { panic!() };
        let found = field.monitor(0, 0.0, &[2.0], &field.defaults());
        assert!((found - expected).abs() < 1e-7 * (1.0 + expected.abs()), "{formula}: {found}");
    }
}

#[test]
fn options_are_read_and_others_are_listed() {
    let read = read(
        "@ TOTAL=10,dt=.1 total=40\n@ trans=5, bounds=1e3,Ntst=30,npr=50,t0=-2\nx'=1\n\
         @ meth=qualrk\nset a {b=1}\nonly x\nhello world\n@ novalue\n",
    );
    let options = Options {
        start: -2.0,
        total: Some(40.0),
        transient: Some(5.0),
        bounds: Some(1000.0),
        ntst: Some(30),
        npr: Some(50),
    };
    assert_eq!(read.options, options);
    let ignored = [
        "line 1: option `dt=.1`",
        "line 4: option `meth=qualrk`",
        "line 5: `set`",
        "line 6: `only`",
        "line 7: `hello`",
        "line 8: `novalue` in options",
    ];
    assert_eq!(read.ignored, ignored);
}

#[test]
fn names_that_are_in_use_are_changed() {
    let read = read("round(x)=x\nfloor'=round(floor)\naux floor=1\naux t=2\naux a.b=3\n");
    let pairs = [("round", "round_"), ("floor", "floor_aux"), ("t", "t_aux"), ("a.b", "a_b")];
    let pairs = pairs.map(|(before, after)| (before.to_string(), after.to_string()));
    assert_eq!(read.renamed, pairs);
}

/// The modes of a file with conditions, and how many of them were tried out.
fn modes(text: &str) -> (usize, Vec<String>) {
    let read = read(text);
    match read.statement {
        Statement::HybridEquations(stated) => (stated.modes.len(), read.tried),
        other => panic!("{other:?}"),
    }
}

#[test]
fn whether_motion_goes_on_beyond_a_condition_follows_from_affine_formulas() {
    for (text, count) in [
        // Set to a value before the condition, by a constant, and by the period of an angle.
        ("v'=1-v^3\nglobal 1 {v-vt} {v=vr}\npar vt=.5,vr=-.2\n", 1),
        ("a'=w\nw'=-sin(a)\nglobal 1 {a-2*pi} {a=a-2*pi}\ninit w=3\n", 1),
        // Set to a value beyond the condition.
        ("v'=1-v^3\nglobal 1 {v-vt} {v=vt+1}\npar vt=.5\n", 2),
        // The speed is turned round, slowed down, and not set at all.
        ("x'=v\nv'=-2\nglobal -1 {x} {v=-r*v}\npar r=.5\ninit x=1\n", 1),
        ("x'=v\nv'=-2\nglobal -1 {x} {v=r*v}\npar r=.5\ninit x=1\n", 2),
        ("x'=y^3\ny'=-x\nn'=0\nglobal 1 {x-.5} {n=n+1}\ninit y=1\n", 2),
        // It would go on for one state in a million only, which trials miss.
        ("x'=v\nv'=-1e-9\nglobal -1 {x} {v=-v-1e-6}\ninit x=1\n", 2),
        // Time passes the condition.
        ("x'=-x\nglobal 1 {t-3} {x=1}\n", 2),
    ] {
        assert_eq!(modes(text), (count, Vec::new()), "{text}");
    }
}

#[test]
fn conditions_that_are_tried_out_are_named() {
    let (count, tried) = modes("x'=v\nv'=-x\nglobal 1 {x^2-.25} {v=-v}\n");
    assert_eq!((count, tried.len()), (1, 1));
    let begin = "line 3: the formulas do not show whether, after an event of `global`, the motion crosses the \
                 surface where the condition `x^2-.25` changes; a test from 24 states has the following result: \
                 from all tested states, the motion stays on one side";
    assert!(tried[0].starts_with(begin), "{}", tried[0]);
    let (count, tried) = modes("x'=v\nv'=-x\nglobal 1 {x^2-.25} {v=v/2}\n");
    assert_eq!((count, tried.len()), (2, 1));
    assert!(tried[0].contains("from at least one of the tested states"), "{}", tried[0]);
}

#[test]
fn time_makes_a_field_aperiodic() {
    let is_aperiodic = |text: &str| model(text).is_aperiodic();
    assert!(is_aperiodic("x'=f(x)\nf(y)=y*T\n"));
    assert!(!is_aperiodic("x'=f(x)\nf(t)=t+1\n"));
}

#[test]
fn maps_that_depend_on_time_have_a_state_that_counts() {
    let read = read("x(t+1)=x+t\n@ t0=3\n");
    assert_eq!(read.clock.as_deref(), Some("iterate"));
    let Model::Map(map) = model("x(t+1)=x+t\n@ t0=3\n") else { panic!() };
    let mut next = [0.0; 2];
    map.next(&[10.0, 3.0], &[], &mut next);
    assert_eq!(next, [13.0, 4.0]);
}

/// Where a motion with events is after a time, and how many events there were.
fn moved(text: &str, time: f64) -> (Vec<f64>, usize) {
    let model = model(text);
    let initial: Vec<f64> = model.initial(model.defaults()).iter().map(|(_, x)| *x).collect();
    let Model::Hybrid(system) = model else { panic!("no events") };
    let p = tangency::core::hybrid::HybridSystem::defaults(&*system);
    let mut flow = HybridFlow::<f64>::new(&*system, HybridSettings::default()).unwrap();
    let mut state = HybridState { mode: 0, time: 0.0, x: initial };
    let statistics = flow.advance(&mut state, time, &p, &mut ()).unwrap();
    (state.x, statistics.events)
}

#[test]
fn resets_count_for_those_behind_them() {
    let (x, events) = moved("x'=1\ny'=0\nz'=0\nq=2*x\nglobal 1 x-1.2 {x=0;y=x+10;z=y+q}\n", 2.0);
    assert_eq!(events, 1);
    close(x[0], 0.8, 1e-12);
    close(x[1], 10.0, 1e-12);
    close(x[2], 12.4, 1e-10);
}

#[test]
fn a_ball_bounces_in_one_mode() {
    // From 1 with g = 2 it falls for a second, and rises to 1/4 within half a second.
    let text = "x'=v\nv'=-2\nglobal -1 {x} {v=-.5*v}\ninit x=1\n";
    let (x, events) = moved(text, 1.5);
    assert_eq!(events, 1);
    close(x[0], 0.25, 1e-10);
    close(x[1], 0.0, 1e-10);
    let Statement::HybridEquations(stated) = read(text).statement else { panic!() };
    assert_eq!(stated.modes.len(), 1);
}

#[test]
fn a_condition_that_stays_met_is_met_again_only_after_it_was_not() {
    // x = sin t rises through 1/2 at π/6, at 13π/6 and so on; the count rises by 1 each time.
    let text = "x'=y\ny'=-x\nn'=0\nglobal 1 {x-.5} {n=n+1}\ninit y=1\n";
    let (x, _) = moved(text, 2.5 * std::f64::consts::TAU);
    close(x[2], 3.0, 1e-12);
    // It begins with the condition met.
    let (x, _) = moved(&text.replace("y=1", "x=1"), 2.9 * std::f64::consts::TAU);
    close(x[2], 3.0, 1e-12);
}

#[test]
fn a_reset_may_meet_another_condition() {
    // x reaches 1.2 at 1.2 and lifts y beyond 1/2 at once, which sets both.
    let text = "x'=1\ny'=0\nglobal 1 {x-1.2} {x=0;y=y+1}\nglobal 1 {y-.5} {y=0;x=.3}\n";
    let (x, _) = moved(text, 1.5);
    close(x[0], 0.6, 1e-12);
    close(x[1], 0.0, 1e-12);
}

#[test]
fn long_sums_and_arrays_are_read() {
    let sum = vec!["x"; 400].join("+");
    assert!(matches!(model(&format!("x'={sum}\n")), Model::Field(_)));
    let Model::Field(field) = model("u[1..2000]'=-u[j]+[j]\n") else { panic!() };
    let (x, mut f) = (vec![1.0; 2000], vec![0.0; 2000]);
    field.field(0.0, &x, &[], &mut f);
    assert_eq!((f[0], f[1999]), (0.0, 1999.0));
}
