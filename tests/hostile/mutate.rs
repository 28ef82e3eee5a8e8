//! Texts that are not quite what they should be: changed by their grammar, and by bytes.

use super::dice::Dice;
use super::words::{FORMULAS, TEXTS, WORDS, number};
use std::ops::Range;

/// What a piece of text is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Token {
    Number,
    Word,
    Quoted,
    Mark(u8),
}

/// The pieces of a text: numbers, words, texts in quotes, and single signs.
fn tokens(text: &str) -> Vec<(Token, Range<usize>)> {
    let bytes = text.as_bytes();
    let while_ = |from: usize, keep: &dyn Fn(u8) -> bool| {
        bytes[from..].iter().position(|b| !keep(*b)).map_or(bytes.len(), |length| from + length)
    };
    let (mut all, mut at) = (Vec::new(), 0);
    while at < bytes.len() {
        let (token, end) = match bytes[at] {
            b if b.is_ascii_whitespace() => (None, at + 1),
            b'/' if bytes.get(at + 1) == Some(&b'/') => (None, while_(at, &|b| b != b'\n')),
            b'"' => (Some(Token::Quoted), (while_(at + 1, &|b| b != b'"') + 1).min(bytes.len())),
            b'0'..=b'9' => (
                Some(Token::Number),
                while_(at, &|b| b.is_ascii_alphanumeric() || b == b'.' || b == b'_'),
            ),
            b if b.is_ascii_alphabetic() || b == b'_' || b >= 0x80 => (
                Some(Token::Word),
                while_(at, &|b| b.is_ascii_alphanumeric() || b == b'_' || b >= 0x80),
            ),
            b => (Some(Token::Mark(b)), at + 1),
        };
        all.extend(token.map(|token| (token, at..end)));
        at = end;
    }
    all
}

/// The words of a text.
pub fn words(text: &str) -> Vec<String> {
    let all = tokens(text).into_iter().filter(|(token, _)| *token == Token::Word);
    let mut all: Vec<String> = all.map(|(_, range)| text[range].to_string()).collect();
    all.sort();
    all.dedup();
    all
}

/// The fields `name: value,` of a text.
fn fields(text: &str, tokens: &[(Token, Range<usize>)]) -> Vec<Range<usize>> {
    let begins = tokens
        .windows(2)
        .enumerate()
        .filter(|(_, pair)| pair[0].0 == Token::Word && pair[1].0 == Token::Mark(b':'));
    begins.map(|(k, _)| tokens[k].1.start..field_end(text, &tokens[k..])).collect()
}

/// Where a field ends: after its comma, or before the bracket that closes what it is in.
fn field_end(text: &str, tokens: &[(Token, Range<usize>)]) -> usize {
    let mut depth = 0;
    for (token, range) in tokens {
        match token {
            Token::Mark(b'(' | b'[' | b'{') => depth += 1,
            Token::Mark(b')' | b']' | b'}') if depth == 0 => return range.start,
            Token::Mark(b')' | b']' | b'}') => depth -= 1,
            Token::Mark(b',') if depth == 0 => return range.end,
            _ => {}
        }
    }
    text.len()
}

/// A text with one change that respects its grammar to some extent; `known` are words that may
/// stand in it.
pub fn by_grammar(text: &str, known: &[String], dice: &mut Dice) -> String {
    let all = tokens(text);
    let of = |wanted: fn(Token) -> bool| -> Vec<Range<usize>> {
        let some = all.iter().filter(|(token, _)| wanted(*token));
        some.map(|(_, range)| range.clone()).collect()
    };
    let (ranges, choice) = match dice.below(16) {
        0..6 => (of(|token| token == Token::Number), 0),
        6 | 7 => (of(|token| token == Token::Quoted), 1),
        8 | 9 => (of(|token| token == Token::Quoted), 2),
        10 | 11 => (fields(text, &all), 3),
        12 => (fields(text, &all), 4),
        13 => (of(|token| token == Token::Word), 5),
        14 => (of(|token| matches!(token, Token::Mark(_))), 6 + 2 * dice.below(2)),
        _ => (of(|_| true), 7),
    };
    if ranges.is_empty() {
        return text.to_string();
    }
    let range = dice.pick(&ranges).clone();
    let new = replacement(&text[range.clone()], choice, known, dice);
    [&text[..range.start], &new, &text[range.end..]].concat()
}

/// What comes in the place of a part.
fn replacement(old: &str, choice: usize, known: &[String], dice: &mut Dice) -> String {
    match choice {
        0 => number(dice).to_string(),
        1 => match dice.below(3) {
            0 => format!("\"{}\"", dice.pick(known)),
            1 => format!("{:?}", dice.word(TEXTS)),
            // As it is: control characters stand in the file.
            _ => format!("\"{}\"", dice.word(TEXTS)),
        },
        2 => {
            let letters: Vec<char> = old.chars().collect();
            let (a, b) = letters.split_at(1 + dice.below(letters.len().saturating_sub(1)));
            let text = |letters: &[char]| letters.iter().collect::<String>();
            text(a) + dice.word(FORMULAS) + &text(b)
        }
        3 => match dice.below(4) {
            0..3 => String::new(),
            _ => format!("{old}{}{old}", if old.ends_with(',') { " " } else { ", " }),
        },
        4 => {
            let (name, rest) = old.split_once(':').unwrap_or((old, ""));
            let comma = if rest.ends_with(',') { "," } else { "" };
            match dice.below(3) {
                0 => format!("{}:{rest}", dice.pick(known)),
                1 => format!("{name}: {}{comma}", dice.word(WORDS)),
                _ => format!("{name}: {}{comma}", number(dice)),
            }
        }
        5 => dice.pick(known).clone(),
        6 => String::new(),
        7 => format!("{old} {old}"),
        _ => dice.word(&["(", "[", "{", ")", "]", "}"]).repeat(*dice.pick(&[1, 1, 2, 200, 20_000])),
    }
}

/// Bytes with one change.
pub fn by_bytes(bytes: &mut Vec<u8>, dice: &mut Dice) {
    let at = dice.below(bytes.len());
    let end = (at + 1 + dice.below(12)).min(bytes.len());
    match dice.below(6) {
        0 => drop(bytes.drain(at..end)),
        1 => bytes.truncate(at),
        2 => {
            let copy = bytes[at..end].to_vec();
            let to = dice.below(bytes.len());
            bytes.splice(to..to, copy);
        }
        3 => bytes.insert(at, dice.number() as u8),
        4 => bytes.extend_from_within(at..),
        _ => {
            if let Some(byte) = bytes.get_mut(at) {
                *byte ^= 1 << dice.below(8);
            }
        }
    }
}

/// A text with up to three changes.
pub fn mutated(text: &str, known: &[String], dice: &mut Dice) -> Vec<u8> {
    let changes = 1 + dice.below(3) / 2 + dice.below(6) / 5;
    let (mut text, mut by_byte) = (text.to_string(), 0);
    for _ in 0..changes {
        match dice.chance(1, 12) {
            true => by_byte += 1,
            false => text = by_grammar(&text, known, dice),
        }
    }
    let mut bytes = text.into_bytes();
    for _ in 0..by_byte {
        by_bytes(&mut bytes, dice);
    }
    bytes
}
