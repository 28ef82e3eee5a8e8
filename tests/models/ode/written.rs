//! Statements written as RON read as they were.

use super::files;
use crate::common::random::Random;
use tangency::language::statement::{
    Boundary, Equations, FilippovEquations, Guard, HybridEquations, Map, Mode, Next, Residual,
    Static,
};
use tangency::language::{Model, Phrase, Source, Statement, xpp};

/// What a statement reads as that was written.
fn again(statement: &Statement) -> Statement {
    let source = Source::new("again.ron", statement.ron());
    Statement::of(&source).unwrap_or_else(|error| panic!("{error}\n{}", source.text))
}

#[test]
fn files_are_written_as_statements_that_read_the_same() {
    for (_, file, _) in files() {
        let statement = xpp::read(&file).unwrap().statement;
        assert_eq!(again(&statement), statement);
        let source = Source::new("", statement.ron());
        Model::read(&source, &[]).unwrap_or_else(|error| panic!("{error}"));
    }
}

/// Statements of all kinds with any texts.
struct Any(Random);

impl Any {
    fn phrase(&mut self) -> Phrase {
        const PIECES: [&str; 16] = [
            "x", "1", "-2", "0", "007", "2.5", "\"", "\\", "\n", "ü", "\t", "[i=1..3]", " + ",
            "é\u{7}", "1e3", "",
        ];
        let count = self.0.below(4);
        let text: String = (0..count).map(|_| PIECES[self.0.below(PIECES.len())]).collect();
        text.into()
    }

    fn many<T>(&mut self, one: impl Fn(&mut Self) -> T) -> Vec<T> {
        (0..self.0.below(4)).map(|_| one(self)).collect()
    }

    fn pairs(&mut self) -> Vec<(Phrase, Phrase)> {
        self.many(|any| (any.phrase(), any.phrase()))
    }

    fn functions(&mut self) -> Vec<(Phrase, Vec<Phrase>, Phrase)> {
        self.many(|any| (any.phrase(), any.many(Any::phrase), any.phrase()))
    }

    fn next(&mut self) -> Next {
        Next(self.many(|any| (any.phrase(), (any.0.signed() < 0.0).then(|| any.phrase()))))
    }

    fn maybe(&mut self) -> Option<Phrase> {
        (self.0.signed() < 0.0).then(|| self.phrase())
    }

    fn mode(&mut self) -> Mode {
        Mode { name: self.phrase(), states: self.pairs(), definitions: self.pairs() }
    }

    fn guard(&mut self) -> Guard {
        Guard {
            name: self.phrase(),
            modes: self.many(Any::phrase),
            function: Some(self.phrase()),
            at: None,
            next: self.next(),
            reset: self.pairs(),
            accumulates_to: self.next(),
            changes_in: self.maybe(),
        }
    }
}

/// Fills in what all kinds of statements have.
macro_rules! stated {
    ($any:ident, $kind:ident { $($field:ident: $value:expr),* $(,)? }) => {
        Statement::$kind($kind {
            $($field: $value,)*
            parameters: $any.pairs(),
            definitions: $any.pairs(),
            functions: $any.functions(),
            monitors: $any.pairs(),
            initial: $any.pairs(),
            labels: $any.pairs(),
            units: $any.pairs(),
        })
    };
}

impl Any {
    fn statement(&mut self) -> Statement {
        let any = self;
        match any.0.below(6) {
            0 => stated!(
                any,
                Equations { states: any.pairs(), period: any.maybe(), scales: any.pairs() }
            ),
            1 => {
                let all = [Static::None, Static::Flow, Static::Potential, Static::SecondOrder];
                stated!(
                    any,
                    Residual {
                        unknowns: any.pairs(),
                        dynamics: all[any.0.below(4)],
                        scales: any.pairs()
                    }
                )
            }
            2 => stated!(any, Map { states: any.pairs(), scales: any.pairs() }),
            3 => stated!(
                any,
                Boundary {
                    states: any.pairs(),
                    conditions: any.many(Any::phrase),
                    integrals: any.many(Any::phrase),
                    unknowns: any.many(Any::phrase),
                    length: any.maybe(),
                    scales: any.pairs(),
                }
            ),
            4 => stated!(
                any,
                FilippovEquations {
                    above: any.pairs(),
                    below: any.pairs(),
                    surface: any.maybe(),
                    sliding: any.pairs(),
                    holds: any.pairs(),
                    names: any.pairs(),
                    period: any.maybe(),
                    scales: any.pairs(),
                }
            ),
            _ => stated!(
                any,
                HybridEquations {
                    states: any.pairs(),
                    modes: any.many(Any::mode),
                    product: any.many(|any| any.many(Any::mode)),
                    guards: any.many(Any::guard),
                    period: any.maybe(),
                    scales: any.pairs(),
                }
            ),
        }
    }
}

#[test]
fn any_statement_is_written_so_that_it_reads_the_same() {
    let mut any = Any(Random::new(4));
    for _ in 0..2000 {
        let statement = any.statement();
        assert_eq!(again(&statement), statement, "{}", statement.ron());
    }
}
