//! The `orogen` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    orogen::cli::main()
}
