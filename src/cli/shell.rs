//! `tangency completions SHELL` and `tangency man`: print shell completions and manual pages.

use super::error::CommandError;
use clap::{Args, CommandFactory};
use clap_complete::Shell;
use clap_mangen::Man;
use std::io::Write;

/// Print the completions of commands and options for a shell
///
/// For example `tangency completions bash > ~/.local/share/bash-completion/completions/tangency`.
#[derive(Debug, Args)]
pub struct Completions {
    /// The shell
    shell: Shell,
}

/// Print the manual page of each command, one after another, in roff
///
/// For example `tangency man > tangency.1; man ./tangency.1`.
#[derive(Debug, Args)]
pub struct Manual {}

impl Completions {
    /// Prints the shell completions for a command line.
    pub fn run<C: CommandFactory>(&self, out: &mut impl Write) -> Result<(), CommandError> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut C::command(), "tangency", &mut script);
        Ok(out.write_all(&script)?)
    }
}

impl Manual {
    /// Prints the manual pages of a command line.
    pub fn run<C: CommandFactory>(&self, out: &mut impl Write) -> Result<(), CommandError> {
        let mut all = C::command();
        all.build();
        Man::new(all.clone()).render(out)?;
        for command in all.get_subcommands() {
            Man::new(command.clone()).render(out)?;
        }
        Ok(())
    }
}
