//! The reference pages match the program: `docs/reference/scenes.md` has every field of a scene with its default,
//! `docs/how-to/branch-ends.md` every end of a branch, and `docs/coming-from.md` only names that exist.

use ron::extensions::Extensions;
use serde::de::value::{Error, StrDeserializer};
use serde::de::{
    DeserializeOwned, DeserializeSeed, Deserializer, EnumAccess, Error as _, IntoDeserializer,
    VariantAccess, Visitor,
};
use serde::forward_to_deserialize_any;
use std::collections::BTreeSet;
use std::fmt::Debug;
use std::process::Command;
use tangency::core::attractor::AttractorSearch;
use tangency::core::continuation::{End, Settings};
use tangency::core::sweep::Order;
use tangency::core::system::Kind;
use tangency::output::{Against, Deviation, Enlargement, Plot, Summary, example_branch};
use tangency::problems::plate::PlateSettings;
use tangency::scene::{
    BoundarySettings, CollocationSettings, FieldSettings, Grid, HybridOrbitSettings, Local,
    MapSettings, Profile, Range, Run, Scene, ShootingSettings, Simulated, SoughtCrisis, Start,
    Sweep, Way, ZeroSettings, execute,
};

const SCENES: &str = include_str!("../../docs/reference/scenes.md");
const ENDS: &str = include_str!("../../docs/how-to/branch-ends.md");
const COMING_FROM: &str = include_str!("../../docs/coming-from.md");
const MODELS: &str = include_str!("../../docs/reference/language.md");

/// The rows of the table below a heading: the first column without its marks, and the second one.
fn rows(heading: &str) -> Vec<(String, String)> {
    let mark = format!("# `{heading}`\n");
    let page = if heading == "End" { ENDS } else { SCENES };
    let (_, section) = page.split_once(&mark).unwrap_or_else(|| panic!("no section `{heading}`"));
    let section = section.split("\n#").next().unwrap_or_default();
    let table = section.lines().filter(|line| line.starts_with("| `"));
    let cells = table.map(|line| line.split(" |").map(|cell| cell.trim_matches(['|', ' ', '`'])));
    cells
        .map(|mut cells| {
            let mut next = || cells.next().unwrap_or_default().to_string();
            (next(), next())
        })
        .collect()
}

/// Reads nothing but the names that a type has: of its fields, of its variants, or of the fields of one
/// variant.
#[derive(Default)]
struct Names {
    variant: Option<&'static str>,
    found: Vec<&'static str>,
}

impl<'de> Deserializer<'de> for &mut Names {
    type Error = Error;

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Error> {
        Err(Error::custom("no names"))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        _: V,
    ) -> Result<V::Value, Error> {
        self.found = fields.to_vec();
        Err(Error::custom("names are known"))
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        self.found = variants.to_vec();
        visitor.visit_enum(self)
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 u8 u16 u32 u64 f32 f64 char str string bytes byte_buf option unit
        unit_struct newtype_struct seq tuple tuple_struct map identifier ignored_any
    }
}

impl<'de> EnumAccess<'de> for &mut Names {
    type Error = Error;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, Self), Error> {
        let variant = self.variant.ok_or_else(|| Error::custom("names are known"))?;
        let name: StrDeserializer<Error> = variant.into_deserializer();
        Ok((seed.deserialize(name)?, self))
    }
}

impl<'de> VariantAccess<'de> for &mut Names {
    type Error = Error;

    fn unit_variant(self) -> Result<(), Error> {
        Err(Error::custom("no names"))
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, _: T) -> Result<T::Value, Error> {
        Err(Error::custom("no names"))
    }

    fn tuple_variant<V: Visitor<'de>>(self, _: usize, _: V) -> Result<V::Value, Error> {
        Err(Error::custom("no names"))
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        _: V,
    ) -> Result<V::Value, Error> {
        self.found = fields.to_vec();
        Err(Error::custom("names are known"))
    }
}

/// The page lists the names of a type, or of one of its variants.
fn lists<T: DeserializeOwned>(heading: &str, variant: Option<&'static str>) {
    let mut names = Names { variant, found: Vec::new() };
    assert!(T::deserialize(&mut names).is_err());
    let listed: BTreeSet<String> = rows(heading).into_iter().map(|(name, _)| name).collect();
    let known: BTreeSet<String> = names.found.iter().map(|name| name.to_string()).collect();
    assert_eq!(listed, known, "the names of `{heading}`");
}

/// The page lists the fields of a structure and says which are required. A field with its default
/// changes nothing.
fn describes<T: DeserializeOwned + Debug + PartialEq>(heading: &str, required: &[(&str, &str)]) {
    lists::<T>(heading, None);
    has_defaults::<T>(heading, "", required);
}

fn has_defaults<T: DeserializeOwned + Debug + PartialEq>(
    heading: &str,
    variant: &str,
    required: &[(&str, &str)],
) {
    let extensions = Extensions::IMPLICIT_SOME | Extensions::UNWRAP_VARIANT_NEWTYPES;
    let options = ron::Options::default().with_default_extension(extensions);
    let given = |more: Option<(&str, &str)>| {
        let fields = required.iter().copied().chain(more);
        let fields: Vec<String> = fields.map(|(name, value)| format!("{name}: {value}")).collect();
        let text = format!("{variant}({})", fields.join(", "));
        options.from_str::<T>(&text).unwrap_or_else(|error| panic!("{text}: {error}"))
    };
    for (field, default) in rows(heading) {
        let is_required = required.iter().any(|(name, _)| *name == field);
        assert_eq!(default.is_empty(), is_required, "`{field}` of `{heading}`");
        let default = match &*default {
            "" | "–" => continue,
            "none" => "None",
            other => other,
        };
        assert_eq!(given(Some((&field, default))), given(None), "`{field}` of `{heading}`");
    }
}

#[test]
fn the_page_lists_every_field_of_scenes() {
    describes::<Scene<()>>("Scene", &[("title", "\"t\"")]);
    describes::<Run>("Run", &[("name", "\"r\"")]);
    describes::<Range>("Range", &[("name", "\"x\"")]);
    lists::<Start>("Start", None);
    lists::<Start>("Start::From", Some("From"));
    has_defaults::<Start>("Start::From", "From", &[("run", "\"r\""), ("kind", "LP")]);
    describes::<Profile>("Profile", &[]);
    describes::<Simulated>("Simulated", &[]);
    lists::<Way>("Way", None);
    let local = [("run", "\"r\""), ("kind", "G"), ("parameters", "[\"a\"]")];
    describes::<Local>("Local", &local);
    describes::<Plot>("Plot", &[]);
    let deviation = [("column", "\"x\""), ("branch", "\"b\""), ("kind", "G")];
    describes::<Deviation>("Deviation", &deviation);
    describes::<Enlargement>("Enlargement", &[("x", "(0, 1)"), ("y", "(0, 1)")]);
    let against = [("kind", "LP"), ("setting", "\"modes\""), ("column", "\"load\"")];
    describes::<Against>("Against", &against);
}

#[test]
fn the_page_lists_every_field_of_sweeps() {
    describes::<Sweep>("Sweep", &[("name", "\"s\""), ("over", "[]")]);
    let grid = [("name", "\"x\""), ("low", "0"), ("high", "1"), ("count", "2")];
    describes::<Grid>("Grid", &grid);
    lists::<Order>("Order", None);
    describes::<AttractorSearch>("AttractorSearch", &[]);
    let crisis = [("name", "\"x\""), ("from", "0"), ("to", "1"), ("tolerance", "0.1")];
    describes::<SoughtCrisis>("SoughtCrisis", &crisis);
}

#[test]
fn the_page_lists_every_setting() {
    describes::<Settings>("Settings", &[]);
    describes::<FieldSettings>("FieldSettings", &[]);
    describes::<HybridOrbitSettings>("HybridOrbitSettings", &[]);
    describes::<BoundarySettings>("BoundarySettings", &[]);
    describes::<CollocationSettings>("CollocationSettings", &[]);
    describes::<ShootingSettings>("ShootingSettings", &[]);
    describes::<MapSettings>("MapSettings", &[]);
    describes::<ZeroSettings>("ZeroSettings", &[]);
    describes::<PlateSettings>("PlateSettings", &[]);
}

/// Every section with a table is one of the tests above.
#[test]
fn the_page_has_no_other_sections() {
    let sections = SCENES.lines().filter(|line| line.starts_with('#') && line.contains('`'));
    assert_eq!(sections.count(), 27);
}

#[test]
fn the_example_does_what_the_page_says() {
    let (_, block) = SCENES.split_once("```ron\n").expect("an example");
    let (text, _) = block.split_once("```").expect("an end");
    let outcome = execute(&Scene::parse(text).expect("a scene"), None, &mut ());
    assert_eq!(outcome.error, None);
    let place = |name: &str, kind| {
        let branch = outcome.document.branch(name).expect("a branch");
        let point = branch.of_kind(kind).next().expect("a point");
        point.value(branch.column("rho").expect("a column")).expect("a value")
    };
    assert!((place("rest", Kind::BP) - 1.0).abs() < 1e-10);
    assert!((place("convection", Kind::HB) - 470.0 / 19.0).abs() < 1e-9);
}

/// One end of each kind.
fn ends() -> Vec<End> {
    let text = || "NAME".to_string();
    vec![
        End::ParameterBound { name: text(), value: 3.0 },
        End::MonitorBound { name: "period".into(), value: 3.0 },
        End::Grazing { name: text(), subkind: None },
        End::ResetJumps { event: text(), state: text(), from: 0.0, to: 1.0 },
        End::Closed { points: 9 },
        End::PointLimit { points: 9 },
        End::StepTooSmall { step: 1e-7, cause: text(), failure: None },
        End::MeshTooCoarse { error: 0.1, limit: 0.02 },
        End::Homoclinic { period: 9.0, distance: 1e-3 },
        End::WeakSaddle { name: text(), largest: 1.0, rate: 1e-4 },
        End::LongPeriod { period: 9.0, shortest: 1.0 },
        End::Snaking { turns: 12, values: [1.0, 2.0], from: 1.0, to: 9.0 },
        End::Infinite { name: text(), from: 1.0, to: 9.0 },
        End::ConvergesTo { point: vec![1.0] },
        End::NoProgress { points: 9, way: 1.0, ahead: 1e-4 },
        End::Event { event: "the name of the event".into() },
        End::Interrupted,
        End::Start,
    ]
}

/// The page lists every end with its words in the summary, and says which ones are unexpected.
#[test]
fn the_page_lists_every_end_of_branches() {
    lists::<End>("End", None);
    let (_, unexpected) = ENDS.split_once("With `--strict`").expect("a paragraph");
    let unexpected = unexpected.split("\n\n").next().unwrap_or_default();
    let ends = ends();
    assert_eq!(ends.len(), rows("End").len());
    for (end, written) in ends.into_iter().map(|end| {
        let written = ron::to_string(&end).expect("a text");
        (end, written)
    }) {
        let name = written.split('(').next().unwrap_or_default();
        let (_, words) = rows("End")
            .into_iter()
            .find(|(row, _)| row == name)
            .unwrap_or_else(|| panic!("{name}"));
        let words = words.split('`').next().unwrap_or_default();
        assert_eq!(unexpected.contains(&format!("`{name}`")), !end.is_expected(), "{name}");
        let mut branch = example_branch();
        branch.ends[1] = end;
        let summary = Summary(&branch).to_string();
        assert!(summary.contains(words), "{name}: {summary}");
    }
}

/// The help of the program, or of one of its commands.
fn help(arguments: &[&str]) -> String {
    let program = env!("CARGO_BIN_EXE_tangency");
    let output = Command::new(program).args(arguments).arg("--help").output().expect("the program");
    String::from_utf8(output.stdout).expect("a text")
}

/// Names that stand for those of other programs are fields, settings, kinds of points, parts of
/// equations, commands or options.
#[test]
fn names_for_users_of_other_programs_exist() {
    let (commands, options) = (help(&[]), help(&["trace"]));
    let mut count = 0;
    for line in COMING_FROM.lines().filter(|line| line.starts_with("| ")) {
        let column = line.trim_end_matches(" |").rsplit(" | ").next().unwrap_or_default();
        for token in column.split('`').skip(1).step_by(2) {
            let is_part = |c: char| c.is_ascii_alphanumeric() || "_-".contains(c);
            let name = token.split(|c: char| !is_part(c)).next().unwrap_or_default();
            let exists = match token.strip_prefix("tangency ") {
                Some(command) => commands.contains(&format!("\n  {command} ")),
                None if name.starts_with("--") => options.contains(&format!("\n      {name} ")),
                None => {
                    let quoted = format!("`{name}");
                    SCENES.contains(&format!("| {quoted}` |"))
                        || MODELS.contains(&quoted)
                        || ron::from_str::<Kind>(name).is_ok()
                }
            };
            assert!(exists, "`{token}` in {line}");
            count += 1;
        }
    }
    assert!(count > 100, "{count} names");
}

/// The long option in the first cell of a row of a table: `| `-q`, `--quiet` | …`.
fn option_of_row(row: &str) -> Option<String> {
    let cell = row.strip_prefix("| ").filter(|row| row.starts_with("`-"))?.split(" |").next()?;
    cell.split('`').find(|part| part.starts_with("--")).map(String::from)
}

/// The page of commands has a section for each command, and in each section a row for each option
/// that `--help` lists, and for no other.
#[test]
fn the_page_of_commands_has_every_option() {
    let page = include_str!("../../docs/reference/commands.md");
    let help_of_program = help(&[]);
    let (_, list) = help_of_program.split_once("Commands:\n").expect("a list of commands");
    let commands = list.lines().take_while(|line| !line.is_empty());
    let commands: Vec<&str> = commands.filter_map(|line| line.split_whitespace().next()).collect();
    assert!(commands.len() >= 14, "{commands:?}");
    // Options of all commands have one table.
    let of_all = ["--help", "--version", "--max-size"].map(String::from);
    for command in commands {
        let heading = format!("\n## {command}\n");
        let (_, section) = page.split_once(&heading).unwrap_or_else(|| panic!("no {heading}"));
        let section = section.split("\n## ").next().unwrap_or_default();
        let mut shown: BTreeSet<String> = section.lines().filter_map(option_of_row).collect();
        let text = help(&[command]);
        let options = text.lines().filter(|line| line.trim_start().starts_with('-'));
        let long = |line: &str| Some(format!("--{}", line.split_once("--")?.1.split(' ').next()?));
        let options: BTreeSet<String> =
            options.filter_map(long).filter(|option| !of_all.contains(option)).collect();
        shown.retain(|option| !of_all.contains(option));
        assert_eq!(shown, options, "{command}");
    }
}
