//! Texts that are not what they should be lead to errors, never to a panic, and fast.

use super::files;
use crate::common::random::Random;
use std::time::{Duration, Instant};
use tangency::language::{Source, xpp};

/// Pieces that are put into texts.
const PIECES: &[&str] = &[
    "'",
    "=",
    "(",
    ")",
    "{",
    "}",
    "[",
    "]",
    "[j]",
    "[j+1]",
    "[0..3]",
    "[3..0]",
    "[-2..900]",
    "%[1..4]\n",
    "%\n",
    "\n",
    "\\\n",
    "#",
    "@ ",
    "global 1 ",
    "global -1 {x} {x=0}\n",
    "par ",
    "init ",
    "aux ",
    "number ",
    "done",
    "d",
    "!",
    "+",
    "-",
    "*",
    "/",
    "^",
    "**",
    ">",
    "<=",
    "!=",
    "&",
    "|",
    "~",
    "not(",
    "if(",
    ")then(",
    ")else(",
    "sum(0,9)of(",
    "sum(0,99999)of(shift(x,i'))",
    "i'",
    "shift(x,",
    "x",
    "y",
    "t",
    "pi",
    "e",
    "1e",
    ".5",
    "9e9",
    "7777777",
    "é",
    "∂",
    "\"",
    ";",
    ",",
    " ",
    "\t",
    "\r\n",
    "x'=",
    "dx/dt=",
    "x(t+1)=",
    "x(0)=",
    "f(x)=",
    "0=",
    "delay(",
    "int{",
    "\u{a0}",
    "....",
    "mod(x,-2)",
    "u[1..40]'=u[j]*u[j-1]\n",
];

fn mutated(random: &mut Random, text: &str) -> String {
    let mut text = text.to_string();
    for _ in 0..=random.below(6) {
        let boundary = |random: &mut Random, text: &str| {
            let mut at = random.below(text.len() + 1);
            while !text.is_char_boundary(at) {
                at -= 1;
            }
            at
        };
        let (a, b) = (boundary(random, &text), boundary(random, &text));
        match random.below(4) {
            0 => text.insert_str(a, PIECES[random.below(PIECES.len())]),
            1 => text.replace_range(a.min(b)..a.max(b), PIECES[random.below(PIECES.len())]),
            2 => {
                let part = text[a.min(b)..a.max(b)].to_string();
                text.insert_str(a, &part);
            }
            _ => text.truncate(a),
        }
    }
    text
}

#[test]
fn mutated_files_never_panic_and_are_read_fast() {
    let (files, mut random) = (files(), Random::new(5));
    let mut slowest = Duration::ZERO;
    for _ in 0..2000 {
        let (_, file, _) = &files[random.below(files.len())];
        let source = Source::new("mutated.ode", mutated(&mut random, &file.text));
        let start = Instant::now();
        match xpp::read(&source) {
            Ok(read) => {
                let _ = read.statement.ron();
                let _ = read.statement.model(&source, &[]);
            }
            Err(error) => assert!(!error.to_string().is_empty()),
        }
        slowest = slowest.max(start.elapsed());
    }
    assert!(slowest < Duration::from_secs(5), "{slowest:?}");
}

#[test]
fn sizes_and_nesting_have_limits() {
    let deep = format!("x'={}x{}\n", "(".repeat(5000), ")".repeat(5000));
    let signs = format!("x'={}x\n", "-".repeat(100_000));
    let functions: String = (0..1000).map(|k| format!("f{k}(x)=x\n")).collect();
    let large = [
        "x[1..500001]'=1\n",
        "x'=sum(0,900000000)of(shift(x,i'))\n",
        "x[0..99999]'=sum(0,99999)of(shift(x0,i'))\n",
    ];
    let wide = format!("x[1..400000]'={}\n", "x".repeat(50));
    for text in large.into_iter().chain([&*deep, &*signs, &*functions, &*wide]) {
        let start = Instant::now();
        assert!(xpp::read(&Source::new("large.ode", text)).is_err());
        assert!(start.elapsed() < Duration::from_secs(5), "{}", &text[..20]);
    }
}
