//! Documents: what is saved is what is loaded, and what makes no sense is refused by place and
//! value.

use crate::program::scenarios::any_text;
use proptest::prelude::*;
use tangency::core::continuation::{Branch, End};
use tangency::core::failure::one_line;
use tangency::core::system::Kind;
use tangency::output::{
    Columns, Document, FileError, FormatError, PointTable, Selection, UnknownPoint, example_branch,
};

fn document() -> Document {
    let mut document = Document::new("Pull-in", vec![example_branch()]);
    document.settings = vec![("scene".into(), "plate".into())];
    document.plot.x = Some("load".into());
    document.plot.labels = vec![("load".into(), "load λ (1)".into())];
    document
}

fn message(text: &str) -> String {
    Document::parse(text).unwrap_err().to_string()
}

/// The message after one replacement in a sound document.
fn message_after(from: &str, to: &str) -> String {
    let text = document().to_ron().unwrap();
    assert!(text.contains(from), "{from} is not in {text}");
    message(&text.replacen(from, to, 1))
}

fn numbers(length: usize) -> impl Strategy<Value = Vec<f64>> {
    let number = prop_oneof![
        any::<f64>().prop_filter("documents hold finite numbers", |value| value.is_finite()),
        Just(-0.0),
        Just(f64::MIN_POSITIVE / 3.0),
        Just(f64::MAX),
        Just(0.1 + 0.2),
    ];
    prop::collection::vec(number, length)
}

proptest! {
    #[test]
    fn saving_and_loading_is_the_identity_to_the_last_bit(
        values in numbers(41 * 3),
        special in numbers(4 * 7),
        unstable in prop::option::of(0_usize..9),
        texts in prop::collection::vec(any_text(), 4),
    ) {
        let mut document = document();
        // Names and titles hold no control characters, those of directions among them; anything else
        // may.
        let of_direction = |it: char| matches!(it, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}');
        let hidden = |it: char| it.is_control() || of_direction(it);
        let [title, setting, name] = [0, 1, 3].map(|k| texts[k].replace(hidden, ""));
        document.title = title;
        document.settings = vec![(setting, texts[2].clone())];
        let branch = &mut document.branches[0];
        branch.name = name;
        branch.condition = unstable.map(|_| Kind::LP);
        let (step, cause) = (values[0], texts[2].clone());
        branch.ends[1] = End::StepTooSmall { step, cause, failure: None };
        for (point, v) in branch.points.iter_mut().zip(values.chunks(3)) {
            (point.parameters, point.monitors) = (v[..2].to_vec(), v[2..].to_vec());
            point.unstable = unstable;
        }
        for (point, v) in branch.special.iter_mut().zip(special.chunks(7)) {
            (point.parameters, point.monitors) = (v[..2].to_vec(), v[2..3].to_vec());
            (point.error, point.bracket, point.state) = (v[3], [v[4], v[5]], v[6..].to_vec());
        }
        let loaded = Document::parse(&document.to_ron().unwrap()).unwrap();
        prop_assert_eq!(bits(&loaded.branches[0]), bits(&document.branches[0]));
        prop_assert_eq!(loaded, document);
    }

    #[test]
    fn no_beginning_of_a_document_is_taken_for_a_document(part in 0.0..1.0_f64) {
        let text = document().to_ron().unwrap();
        let text = text.trim_end();
        let end = text.floor_char_boundary((part * text.len() as f64) as usize);
        prop_assert!(Document::parse(&text[..end]).is_err());
    }

    #[test]
    fn no_text_makes_the_reader_panic(text in any_text()) {
        prop_assert!(Document::parse(&text).is_err());
    }
}

fn bits(branch: &Branch) -> Vec<u64> {
    let points =
        branch.points.iter().flat_map(|point| point.parameters.iter().chain(&point.monitors));
    let special = branch.special.iter().flat_map(|point| {
        let lists = [&point.parameters, &point.monitors, &point.state];
        lists.into_iter().flatten().chain([&point.error]).chain(&point.bracket)
    });
    points.chain(special).map(|value| value.to_bits()).collect()
}

#[test]
fn the_text_is_ron_for_any_reader_one_line_a_point() {
    let text = document().to_ron().unwrap();
    let read: Document = ron::from_str(&text).unwrap();
    assert_eq!(read, document());
    assert!(text.contains("(parameters: [0.019208, 1.2], monitors: [0.02], unstable: 0),\n"));
}

#[test]
fn a_document_cut_short_says_so() {
    let text = document().to_ron().unwrap();
    for part in [3, 4, 8] {
        let cut = &text[..text.floor_char_boundary(text.len() * part / 9)];
        let error = Document::parse(cut).unwrap_err();
        let line = cut.trim_end().lines().count();
        assert!(
            matches!(error, FormatError::Truncated { line: at, .. } if at == line),
            "{error:?} is not at line {line}"
        );
        assert!(one_line(&error).contains("is truncated"), "{error}");
    }
}

#[test]
fn foreign_texts_are_called_foreign() {
    for text in
        ["", "(modes: 3)", "[1, 2]", "{\"a\": 1}", "Scene(name: \"plate\")", "# a book", "("]
    {
        let error = Document::parse(text).unwrap_err();
        assert!(matches!(error, FormatError::Foreign { .. }), "{text}: {error:?}");
    }
    let error = message("(modes: 3)");
    assert!(error.contains("not a tangency document (line 1, column"), "{error}");
}

#[test]
fn another_version_is_named() {
    let error = message_after("tangency/1", "tangency/7");
    assert!(error.contains("`tangency/7`") && error.contains("`tangency/1`"), "{error}");
}

#[test]
fn keys_that_are_unknown_or_there_twice_are_refused_with_their_place() {
    let error = message_after("  title:", "  colour: 3,\n  title:");
    assert!(
        error.starts_with("line 4, column 3: ") && error.contains("\n4 |   colour: 3,\n"),
        "{error}"
    );
    let error = message_after("  title:", "  title: \"a\",\n  title:");
    assert!(error.starts_with("line 5, column ") && error.contains("title"), "{error}");
    let error = message_after("unstable: 0)", "unstable: 0, unstable: 1)");
    assert!(error.contains("unstable"), "{error}");
}

#[test]
fn values_of_the_wrong_type_are_named_with_their_place() {
    let error = message_after("kind: LP", "kind: XY");
    assert!(
        error.contains("`XY`") && error.contains("^^") && error.starts_with("line "),
        "{error}"
    );
    let error = message_after("[0.019208, 1.2]", "[\"much\", 1.2]");
    assert!(error.contains(": expected a number"), "{error}");
}

#[test]
fn numbers_that_are_not_finite_are_named_by_branch_point_and_column() {
    for (written, shown) in [("NaN", "NaN"), ("inf", "inf"), ("-inf", "-inf"), ("1e999", "inf")] {
        assert_eq!(
            message_after("[0.019208, 1.2]", &format!("[{written}, 1.2]")),
            format!(
                "branch `plate`, point 1, column `load` is {shown}, but must be a finite number"
            )
        );
    }
    let error = message_after("error: 2.5e-15", "error: NaN");
    assert!(error.starts_with("branch `plate`, label 2, error is NaN"), "{error}");
    let error = message_after("value: 0.8", "value: inf");
    assert!(error.starts_with("branch `plate`, ends, value is inf"), "{error}");
    let error = message_after("max_step: 0.15", "max_step: NaN");
    assert!(error.contains("the setting `max_step` is NaN"), "{error}");
}

#[test]
fn what_could_not_be_read_back_is_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ron");
    let mut document = document();
    document.save(&path).unwrap();
    let before = std::fs::read_to_string(&path).unwrap();
    document.branches[0].special[2].state[0] = f64::NAN;
    let error = one_line(&document.save(&path).unwrap_err());
    assert!(error.contains("a.ron: branch `plate`, label 3, state, component 0 is NaN"), "{error}");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), before);
}

#[test]
fn lists_of_the_wrong_length_are_refused() {
    assert_eq!(
        message_after("[0.019208, 1.2]", "[0.019208]"),
        "branch `plate`, point 1, parameters is a list of 1, but the list must have 2 entries, one \
         for each of the names"
    );
    let error = message_after("length: 1", "length: 2");
    assert!(error.contains("label 1, state is a list of 1"), "{error}");
}

/// Changes the branch of a sound document and says how it is refused.
fn refused(change: impl FnOnce(&mut Branch)) -> String {
    let mut document = document();
    change(&mut document.branches[0]);
    document.to_ron().unwrap_err().to_string()
}

#[test]
fn names_and_labels_must_be_unique_and_refer_to_something() {
    let error = refused(|branch| branch.special[1].label = 1);
    assert_eq!(error, "branch `plate`: a label is `1`, but occurs twice: rename one of them");
    let error = refused(|branch| branch.monitors[0] = "load".into());
    assert!(error.contains("a column is `load`"), "{error}");
    let error = refused(|branch| branch.special[3].after = 41);
    assert!(
        error.contains(
            "label 4: after is 41, but the position of a special point must be at most 40"
        ),
        "{error}"
    );
    let error = refused(|branch| branch.special.swap(0, 3));
    assert!(error.contains("the position of a special point must be at least 40"), "{error}");
    let error = refused(|branch| branch.released[0] = "weight".into());
    assert!(
        error.contains("a released parameter must be one of the parameters load, aspect_ratio"),
        "{error}"
    );
    let error = refused(|branch| branch.special[0].label = 0);
    assert!(error.contains("counted from 1"), "{error}");
    let mut twice = document();
    twice.branches.push(example_branch());
    let error = one_line(&twice.to_ron().unwrap_err());
    assert!(error.starts_with("the name of a branch is `plate`"), "{error}");
    let mut twice = document();
    twice.settings = vec![("k".into(), "1".into()), ("k".into(), "2".into())];
    assert!(twice.to_ron().unwrap_err().to_string().contains("a setting is `k`"));
}

#[test]
fn files_that_cannot_be_read_or_written_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let blocked = folder.path().join("file").join("a.ron");
    std::fs::write(folder.path().join("file"), "in the way").unwrap();
    let error = document().save(&blocked).unwrap_err();
    assert!(matches!(error, FileError::Write { .. }), "{error:?}");
    let error = one_line(&error);
    assert!(
        error.contains(&*blocked.to_string_lossy()) && error.contains("choose a writable folder"),
        "{error}"
    );
    let error = one_line(&Document::load(folder.path().join("missing.ron")).unwrap_err());
    assert!(error.starts_with("cannot read ") && error.contains("missing.ron"), "{error}");
}

#[test]
fn saving_leaves_nothing_but_the_document() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("new").join("a.ron");
    document().save(&path).unwrap();
    document().save(&path).unwrap();
    let files: Vec<_> = std::fs::read_dir(folder.path().join("new")).unwrap().collect();
    assert_eq!(files.len(), 1);
    assert_eq!(Document::load(&path).unwrap(), document());
}

#[test]
fn special_points_are_found_by_label_and_ambiguity_is_named() {
    let mut document = document();
    let mut second = example_branch();
    second.name = "second".into();
    second.special[3].label = 9;
    document.branches.push(second);
    assert_eq!(document.special_point(None, 9).unwrap().0.name, "second");
    assert_eq!(document.special_point(Some("second"), 3).unwrap().1.kind, Kind::LP);
    let error = document.special_point(None, 3).unwrap_err();
    assert!(matches!(error, UnknownPoint::Ambiguous { .. }));
    assert!(one_line(&error).ends_with("name one of plate/3, second/3"), "{error}");
    let error = one_line(&document.special_point(Some("secnod"), 3).unwrap_err());
    assert!(error.contains("did you mean `second`?"), "{error}");
    assert_eq!(document.setting("scene"), Some("plate"));
}

/// A table of points has the settings in which documents differ, under names of their own, and is in
/// the order of these: numbers, then words. Text that looks like a number stays as it is.
#[test]
fn tables_of_points_say_where_they_belong() {
    let documents: Vec<Document> = ["word", "10", "9"]
        .map(|value| {
            let mut document = Document::new("t", vec![example_branch()]);
            document.branches[0].name = "12345678901234".into();
            document.settings.push(("error".into(), value.into()));
            document
        })
        .into();
    let named: Vec<(&str, &Document)> = ["a", "b", "c"].into_iter().zip(&documents).collect();
    let folds = Selection { kinds: &[Kind::LP], ..Selection::default() };
    let table = PointTable::of(&named, folds).unwrap();
    let rows: Vec<Vec<String>> = table
        .screen()
        .lines()
        .map(|line| {
            line.split("  ").map(str::trim).filter(|it| !it.is_empty()).map(String::from).collect()
        })
        .collect();
    assert_eq!(
        rows[0],
        ["setting error", "branch", "label", "kind", "load", "deflection", "error"]
    );
    assert_eq!(rows[1..].iter().map(|row| &*row[0]).collect::<Vec<_>>(), ["9", "10", "word"]);
    assert!(rows[1..].iter().all(|row| row[1] == "12345678901234"));
    let full = PointTable::of(&named, Selection { columns: Columns::All, ..folds });
    let full = full.unwrap().csv();
    assert!(full.starts_with("file,setting error,branch,label,kind,load,"), "{full}");
    // Equal settings do not say which file it is.
    let twice = [named[0], named[1], named[1]];
    assert!(
        PointTable::of(&twice, Selection::default())
            .unwrap()
            .csv()
            .starts_with("file,setting error,")
    );
}
