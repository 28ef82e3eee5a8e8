//! The lines of an XPPAUT file: joins continued lines, and expands arrays and blocks.

use super::super::source::{Fault, ModelError, Source};
use super::origin::{Slice, Text};
use std::ops::ControlFlow;

/// The maximum number of elements of all arrays of a file together.
const ELEMENTS: usize = 500_000;
/// The maximum number of letters in the expanded arrays of a file.
const LETTERS: usize = 4_000_000;
/// The maximum length of a file in bytes.
const LONGEST: usize = 16_000_000;

/// A callback that receives each line and whether the line belongs to an array; it returns a break
/// to end the file.
pub(super) type Visit<'v> = &'v mut dyn FnMut(Text, bool) -> Result<ControlFlow<()>, ModelError>;

/// Returns the lines of a source, and joins each line that ends in a backslash with the next line.
fn joined(source: &Source) -> Vec<Text> {
    let (mut lines, mut open, mut at) = (Vec::new(), None::<Text>, 0);
    for whole in source.text.split_inclusive('\n') {
        let line = whole.trim_end_matches(['\n', '\r']);
        let mut text = open.take().unwrap_or_else(|| Text::empty(at));
        let end = line.find('\\');
        text.push(&line[..end.unwrap_or(line.len())], at);
        at += whole.len();
        match end {
            Some(_) => open = Some(text),
            None => lines.push(text),
        }
    }
    lines.extend(open);
    lines
}

/// Returns whether a line is a comment, a list of options, or a list of parameter sets; indices in
/// such a line are not expanded.
fn is_plain(text: &str) -> bool {
    let word = text.trim_start();
    let set = word.get(..4).is_some_and(|first| first.eq_ignore_ascii_case("set "));
    set || text.starts_with('@') || word.is_empty() || word.starts_with(['#', '"'])
}

/// Passes all lines, with expanded arrays, to the callback until it ends the file.
pub(super) fn for_each(source: &Source, visit: Visit) -> Result<(), ModelError> {
    if source.text.len() > LONGEST {
        let fault = Fault::TooLarge { what: "letters of a file", limit: LONGEST };
        return Err(Text::empty(0).all().fault(source, fault));
    }
    let lines = joined(source);
    let mut lines = lines.iter();
    let mut budget = Budget { source, elements: 0, letters: 0 };
    while let Some(line) = lines.next() {
        let line = line.all();
        let flow = if is_plain(line.text) {
            visit(line.to_text(), false)?
        } else if line.text.starts_with('%') {
            let Some(range) = range_of(source, line)? else { continue };
            let block: Vec<Slice> = lines
                .by_ref()
                .map(Text::all)
                .take_while(|line| !line.text.starts_with('%'))
                .collect();
            for inner in &block {
                refuse_range(source, *inner)?;
            }
            budget.write_out(&block, &range, (visit, false))?
        } else {
            match range_of(source, line)? {
                Some(range) => budget.write_out(&[line], &range, (visit, true))?,
                None => visit(alone(source, line)?, false)?,
            }
        };
        if flow.is_break() {
            break;
        }
    }
    Ok(())
}

fn refuse_range(source: &Source, line: Slice) -> Result<(), ModelError> {
    match range_of(source, line)? {
        Some(range) if !is_plain(line.text) => {
            let reason = "the block already gives the index";
            Err(range
                .brackets
                .unsupported(source, "a range within a block", reason)
                .with_help("write `[j]`"))
        }
        _ => Ok(()),
    }
}

/// The number of array elements, and the number of letters, that the expansion of arrays has
/// produced so far.
struct Budget<'s> {
    source: &'s Source,
    elements: usize,
    letters: usize,
}

impl Budget<'_> {
    /// Expands lines of an array: writes them once for each index of a range.
    fn write_out(
        &mut self,
        lines: &[Slice],
        range: &Range,
        (visit, array): (Visit, bool),
    ) -> Result<ControlFlow<()>, ModelError> {
        let count = range.first.abs_diff(range.last) as usize + 1;
        self.elements = self.elements.saturating_add(count);
        if self.elements > ELEMENTS {
            let fault = Fault::TooLarge { what: "elements of arrays", limit: ELEMENTS };
            return Err(range.brackets.fault(self.source, fault));
        }
        for k in 0..count as i64 {
            let k = if range.last < range.first { range.first - k } else { range.first + k };
            for line in lines {
                if is_plain(line.text) {
                    continue;
                }
                let text = subscripted(self.source, *line, Some(k))?;
                self.letters += text.len();
                if self.letters > LETTERS {
                    let what = "letters of written-out arrays";
                    let fault = Fault::TooLarge { what, limit: LETTERS };
                    return Err(range.brackets.fault(self.source, fault));
                }
                if visit(text, array)?.is_break() {
                    return Ok(ControlFlow::Break(()));
                }
            }
        }
        Ok(ControlFlow::Continue(()))
    }
}

/// The range of indices of a line, such as `[1..9]`.
struct Range<'a> {
    brackets: Slice<'a>,
    first: i64,
    last: i64,
}

/// Returns the position and the contents of each pair of square brackets, except the brackets of
/// integrals.
fn brackets<'a>(source: &Source, line: Slice<'a>) -> Result<Vec<(usize, Slice<'a>)>, ModelError> {
    let (mut found, mut at) = (Vec::new(), 0);
    while let Some(open) = line.text[at..].find('[').map(|open| at + open) {
        let Some(length) = line.text[open..].find(']') else {
            return Err(line.part(open..open + 1).expected(source, "`]` after it"));
        };
        let before = &line.text.as_bytes()[..open];
        let integral = before.len() >= 3 && before[open - 3..].eq_ignore_ascii_case(b"int");
        if !integral {
            found.push((open, line.part(open + 1..open + length)));
        }
        at = open + length + 1;
    }
    Ok(found)
}

fn range_of<'a>(source: &Source, line: Slice<'a>) -> Result<Option<Range<'a>>, ModelError> {
    if is_plain(line.text) {
        return Ok(None);
    }
    let mut found = None;
    for (open, inner) in brackets(source, line)? {
        let Some((first, last)) = inner.text.split_once("..") else { continue };
        let whole = line.part(open..open + inner.text.len() + 2);
        let [Ok(first), Ok(last)] = [first, last].map(|end| end.trim().parse::<i32>()) else {
            return Err(inner.expected(source, "two whole numbers, as in `[1..9]`"));
        };
        if found.is_some() {
            let reason = "XPPAUT writes out one range per line";
            return Err(whole.unsupported(source, "a second range in a line", reason).with_help(
                "write each range on a line of its own, or replace the second range by `[j]`",
            ));
        }
        found = Some(Range { brackets: whole, first: first.into(), last: last.into() });
    }
    Ok(found)
}

/// Returns the text of a line that is not expanded as an array.
fn alone(source: &Source, line: Slice) -> Result<Text, ModelError> {
    if let Some(at) = line.text.find("](0)") {
        let place = line.part(at..at + 4);
        return Err(place
            .unsupported(source, "an initial value in brackets", "XPPAUT ignores such a value")
            .with_help("write the name of the array element, as in `u3(0)=1`"));
    }
    subscripted(source, line, None)
}

/// Returns a line in which index expressions such as `[j+1]` are replaced by their values.
fn subscripted(source: &Source, line: Slice, k: Option<i64>) -> Result<Text, ModelError> {
    if !line.text.contains('[') {
        return Ok(line.to_text());
    }
    let (mut text, mut at) = (line.part(0..0).to_text(), 0);
    for (open, inner) in brackets(source, line)? {
        text.extend(line.part(at..open));
        at = open + inner.text.len() + 2;
        let whole = line.part(open..at);
        let ranged = inner.text.contains("..");
        let index = if ranged { k.unwrap_or(0) } else { index(source, whole, inner, k)? };
        let named = line.text[..open].ends_with(|c: char| c.is_alphanumeric() || c == '_');
        if index < 0 && named {
            let reason =
                format!("the index is {index}, but an index in a name must not be negative");
            return Err(whole.unsupported(source, "a negative index", reason));
        }
        text.replace(whole, &index.to_string());
    }
    text.extend(line.from(at));
    Ok(text)
}

/// Returns the integer between square brackets.
fn index(source: &Source, whole: Slice, inner: Slice, k: Option<i64>) -> Result<i64, ModelError> {
    let forms = "`[j]`, `[j+1]`, `[j-1]`, `[j*2]` or a whole number in brackets";
    let plain: String = inner.text.chars().filter(|c| *c != ' ').collect();
    let wrong = || inner.expected(source, forms);
    let value = match plain.strip_prefix('j') {
        None => plain.parse::<i32>().map_err(|_| wrong())?.into(),
        Some(rest) => {
            let Some(k) = k else {
                let reason = "the line has no range, such as `[1..9]`, and is not inside a block";
                return Err(whole.unsupported(source, "`[j]` outside of an array", reason));
            };
            let number = |text: &str| text.parse::<u16>().map(i64::from).map_err(|_| wrong());
            match rest.split_at_checked(1) {
                None => k,
                Some(("+", number_text)) => k + number(number_text)?,
                Some(("-", number_text)) => k - number(number_text)?,
                Some(("*", number_text)) => k * number(number_text)?,
                Some(_) => return Err(wrong()),
            }
        }
    };
    Ok(value)
}
