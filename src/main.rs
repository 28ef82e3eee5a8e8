//! The program `tangency`: the command line with the built-in problems and scenes.

fn main() -> std::process::ExitCode {
    tangency::cli::run(tangency::Catalogue::built_in())
}
