//! Arguments of `tangency scenes` and `tangency trace SCENE`.

use clap::Args;
use std::path::PathBuf;
use std::str::FromStr;

/// List the scenes that can be traced
#[derive(Debug, Args)]
pub struct Scenes {}

/// Trace a scene, and save its branches
#[derive(Debug, Args)]
pub struct Trace {
    /// The name of a scene (see `tangency scenes`), or the path of a RON file
    pub scene: String,
    /// Change a value of the scene; may be repeated
    #[arg(long = "set", value_name = "NAME=VALUE")]
    pub settings: Vec<Setting>,
    /// The folder for the results
    #[arg(long, value_name = "DIR", default_value = ".")]
    pub out: PathBuf,
    /// Start from a special point of an earlier result
    #[arg(long, value_name = "FILE:LABEL or FILE:BRANCH/LABEL")]
    pub start: Option<Start>,
}

/// `NAME=VALUE`: what `--set` changes. The value may hold further equals signs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setting {
    /// The name, without blanks around it.
    pub name: String,
    /// The value as text, without blanks around it.
    pub value: String,
}

/// `FILE:LABEL` or `FILE:BRANCH/LABEL`: where `--start` begins. The colon is the last one, the slash
/// the last one behind it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Start {
    /// The document.
    pub file: PathBuf,
    /// The branch; not needed where only one has the label.
    pub branch: Option<String>,
    /// The label of the special point.
    pub label: usize,
}

/// An argument that cannot be understood.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ArgumentError {
    /// `--set` without a name, an equals sign or a value.
    #[error("`{0}` is not of the form NAME=VALUE, for example load=0.1")]
    Setting(String),
    /// `--start` without a file or a label.
    #[error(
        "`{0}` is not of the form FILE:LABEL or FILE:BRANCH/LABEL, for example pull-in.ron:3; \
         labels are counted from 1"
    )]
    Start(String),
}

impl FromStr for Setting {
    type Err = ArgumentError;

    fn from_str(text: &str) -> Result<Self, ArgumentError> {
        match text.split_once('=').map(|(name, value)| (name.trim(), value.trim())) {
            Some((name, value)) if !name.is_empty() && !value.is_empty() => {
                Ok(Setting { name: name.into(), value: value.into() })
            }
            _ => Err(ArgumentError::Setting(text.into())),
        }
    }
}

impl FromStr for Start {
    type Err = ArgumentError;

    fn from_str(text: &str) -> Result<Self, ArgumentError> {
        let parts = || {
            let (file, point) = text.rsplit_once(':')?;
            let (branch, label) = match point.rsplit_once('/') {
                Some((branch, label)) => (Some(branch), label),
                None => (None, point),
            };
            let label = label.parse().ok().filter(|label| *label > 0)?;
            let named = !file.is_empty() && branch != Some("");
            named.then(|| Start { file: file.into(), branch: branch.map(String::from), label })
        };
        parts().ok_or_else(|| ArgumentError::Start(text.into()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        trace: Trace,
    }

    #[test]
    fn a_whole_line() {
        let line =
            ["trace", "plate", "--set", "modes=3", "--set", "k = a=b", "--start", "a/b.ron:x/2"];
        let trace = Line::try_parse_from(line).unwrap().trace;
        assert_eq!((trace.scene.as_str(), trace.out), ("plate", PathBuf::from(".")));
        assert_eq!(trace.settings[1], Setting { name: "k".into(), value: "a=b".into() });
        let start = Start { file: "a/b.ron".into(), branch: Some("x".into()), label: 2 };
        assert_eq!(trace.start, Some(start));
    }

    #[test]
    fn a_file_in_a_folder_without_a_branch() {
        let start: Start = "C:/results/a.ron:12".parse().unwrap();
        assert_eq!(start, Start { file: "C:/results/a.ron".into(), branch: None, label: 12 });
    }

    #[test]
    fn bad_syntax_is_explained() {
        for text in ["load", "=3", "load=", " = "] {
            let error = text.parse::<Setting>().unwrap_err();
            assert_eq!(error, ArgumentError::Setting(text.into()));
        }
        for text in ["a.ron", "a.ron:", "a.ron:x", ":3", "a.ron:0", "a.ron:/3", "a.ron:b/-1"] {
            assert_eq!(text.parse::<Start>().unwrap_err(), ArgumentError::Start(text.into()));
        }
        let Err(error) = Line::try_parse_from(["trace", "plate", "--set", "load"]) else {
            panic!("accepted")
        };
        assert!(error.to_string().contains("`load` is not of the form NAME=VALUE"), "{error}");
    }
}
