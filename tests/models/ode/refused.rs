//! What is refused, by name, line and column; and how errors look.

use tangency::core::failure::one_line;
use tangency::language::{Fault, ModelError, Source, xpp};

fn refused(text: &str) -> ModelError {
    let source = Source::new("model.ode", text);
    let understood = xpp::read(&source).and_then(|read| read.statement.model(&source, &[]));
    match understood {
        Ok(_) => panic!("this is read:\n{text}"),
        Err(error) => error,
    }
}

/// Constructs without a counterpart: the text, the line and the column, and words of the error.
const UNSUPPORTED: &[(&str, usize, usize, &str)] = &[
    ("x'=-x\ny'=-delay(x,2)\n", 2, 5, "`delay`"),
    ("x'=-x\ny'=1+del_shft(x,1,2)\n", 2, 6, "`del_shft`"),
    ("x(0)=1-t\nx'=-delay(x,1)\n", 1, 6, ""),
    ("x'=-x+int{exp(-t)#x}\n", 1, 7, "`int`"),
    ("u(t)=1+INT[.5]{exp(-t)#u}\n", 1, 8, "`int`"),
    ("volterra u=int{u}\n", 1, 1, "`volterra`"),
    ("x'=-x\n  wiener w\n", 2, 3, "`wiener`"),
    ("x'=ran(1)-x\n", 1, 4, "`ran`"),
    ("x'=normal(0,1)\n", 1, 4, "`normal`"),
    ("x'=1\nmarkov z 2\n{0} {1}\n{1} {0}\n", 2, 1, "`markov`"),
    ("table w % 11 -5 5 t\nx'=w(x)\n", 1, 1, "`table`"),
    ("x'=y\n0=x+y\nsolve y=1\n", 2, 1, "algebraic"),
    ("x'=y\nsolv y=1\n", 2, 1, "`solve`"),
    ("special k=conv(even,9,2,w,u0)\n", 1, 1, "`special`"),
    ("export {x} {y}\nx'=1\n", 1, 1, "`export`"),
    ("x'=1\n@ total=10,dll_lib=a.so\n", 2, 12, "library"),
    ("x'=1\nbndry x-1\n", 2, 1, "`bdry`"),
    ("options standard.opt\n", 1, 1, "`options`"),
    ("#include other.ode\nx'=1\n", 1, 1, "`#include`"),
    ("2\nv x=1,y=2\n", 1, 1, "old form"),
    ("x'=besselj(0,x)\n", 1, 4, "`besselj`"),
    ("x'=erf(x)\n", 1, 4, "`erf`"),
    ("x'=1\nglobal 0 {x-1} {x=0}\n", 2, 8, "sign 0"),
    ("x'=a\npar a=1\nglobal 1 {x-1} {a=-1}\n", 3, 17, "other than a state"),
    ("x'=1\nglobal 1 {x-1} {arret=1}\n", 2, 17, "`arret`"),
    ("x(t+1)=x+1\nglobal 1 {x-5} {x=0}\n", 2, 11, "`global` of a map"),
    ("a=b+1\nb=5\nx'=a\n", 1, 1, "computed earlier"),
    ("a=a+1\nx'=a\n", 1, 1, "computed earlier"),
    ("x'=b\n!b=2*x\n", 2, 2, "`!b`"),
    ("x'=sum(1,n)of(i')\npar n=3\n", 1, 4, "limits of a sum"),
    ("x'=sum(0,1)of(sum(0,1)of(i')+i')\n", 1, 4, "sum within a sum"),
    ("x'=i'\n", 1, 4, "`i'`"),
    ("x'=shift(x,y)\ny'=0\n", 1, 4, "`shift`"),
    ("x'=shift(x,7)\n", 1, 4, "`shift`"),
    ("x'=[j]\n", 1, 4, "`[j]`"),
    ("x[0..2]'=-x[j-1]\n", 1, 12, "negative index"),
    ("x[0..2]'=0\ninit x[0..1]=1,x[0..2]=2\n", 2, 17, "second range"),
    ("x[0..2]'=0\nx[1](0)=3\n", 2, 4, "in brackets"),
];

/// What is wrong: the text, the line and the column, and words of the error.
const WRONG: &[(&str, usize, usize, &str)] = &[
    ("# nothing\ndone\n", 0, 0, "the file has no equation"),
    ("x'=-x\ny'=2*zz+1\n", 2, 6, "unknown name `zz`"),
    ("x'=alpha\npar Alpah=1\n", 1, 4, "did you mean `Alpah`"),
    ("x'=f(x,1)\nf(a)=a\n", 1, 4, "`f` takes one argument, not 2"),
    ("x'=atan2(x)\n", 1, 4, "`atan2` takes 2 arguments, not 1"),
    ("x'=f(x)\nf(a)=g(a)\ng(a)=f(a)\n", 2, 1, "`f` is defined in terms of itself"),
    ("x'=a\n!a=b\n!b=a\n", 2, 2, "is defined in terms of itself"),
    ("x'=1\npar X=2\n", 2, 5, "`X` is already a state"),
    ("x'=1\npar sin=2\n", 2, 5, "`sin` is already a name reserved by XPPAUT"),
    ("x'=1\nX'=2\n", 2, 1, "`X` is already a state"),
    ("x'=1\npar a=1/2\n", 2, 7, "expected a number"),
    ("x'=1\n@ total=9,npr=-50\n", 2, 11, "expected a whole number of 0 or more after `=`"),
    ("x'=1\n@ ntst=0\n", 2, 3, "expected a whole number of 1 or more after `=`"),
    ("x'=1\n@ ntst=2.5\n", 2, 3, "expected a whole number of 1 or more"),
    ("x'=1\n@ bounds=-1\n", 2, 3, "expected a number above 0 after `=`"),
    ("x'=1\npar a=1,b=- 2\n", 2, 11, "expected a number"),
    ("x'=a\npar a=3\nx(0)=2*a\n", 3, 6, "expected a number"),
    ("x'=1\ninit y=1\n", 2, 6, "unknown state `y`"),
    ("x'=(x+1\n", 1, 8, "expected an operator or `)`"),
    ("x'=x+1)\n", 1, 7, "expected an operator"),
    ("x'=2x\n", 1, 5, "expected an operator"),
    ("x'=1 # no comment here\n", 1, 6, "expected an operator"),
    ("x'=if(x)then(1)\n", 1, 16, "expected `else(`"),
    ("x'=1.2.3\n", 1, 7, "expected an operator"),
    ("x'=x+\n", 1, 6, "expected a number, a name or `(`"),
    ("x'=x+\\\n y z\ny'=1\nz'=1\n", 2, 4, "expected an operator"),
    ("x[0..2]'=-x[j\n", 1, 12, "expected `]`"),
    ("x[0..n]'=1\n", 1, 3, "two whole numbers"),
    ("x[0..2]'=[j/2]\n", 1, 11, "expected `[j]`"),
    ("x[0..2]'=-x[j]*qq[j+1]\n", 1, 16, "unknown name `qq1`"),
    ("u[1..9999999]'=1\n", 1, 2, "elements of arrays: the limit is 500000"),
    ("x'=1\nfoo\n", 2, 1, "expected a statement"),
    ("x '=1\n", 1, 1, "expected a statement"),
    ("x/y=1\n", 1, 1, "expected a statement"),
    ("x'=1\nglobal {x} {x=0}\n", 2, 8, "expected a sign"),
    ("x'=1\nglobal 1 {x-1} {y=0}\n", 2, 17, "unknown state `y`"),
    ("f(a,A)=a\nx'=f(1,2)\n", 1, 5, "`A` is already an argument"),
    ("x'=1\n3a=4\n", 2, 1, "expected a name"),
];

#[test]
fn constructs_are_refused_by_name_and_place() {
    for (text, line, column, words) in UNSUPPORTED {
        let error = refused(text);
        let place = (error.place.line, error.place.column);
        assert_eq!(place, (Some(*line), *column), "{text}\n{error}");
        let unsupported = matches!(&error.fault, Fault::Unsupported { .. });
        assert!(one_line(&error).contains(words) && (unsupported || words.is_empty()), "{error}");
    }
}

#[test]
fn errors_have_their_place() {
    for (text, line, column, words) in WRONG {
        let error = refused(text);
        let place = (error.place.line.unwrap_or(0), error.place.column);
        let expected = if *line == 0 { (0, place.1) } else { (*line, *column) };
        assert_eq!(place, expected, "{text}\n{error}");
        assert!(one_line(&error).contains(words), "{error}");
    }
}

#[test]
fn errors_show_the_line() {
    let error = refused("# a chain\nu[0..3]'=-u[j]\nv[1..3]'=u[j]*Kq[j]\n");
    assert_eq!(
        error.to_string(),
        "\
model.ode, line 3, column 15: unknown name `Kq1`
  |
3 | v[1..3]'=u[j]*Kq[j]
  |               ^^^^^"
    );
}
