//! The program `gaitway`; everything it does is in the library's `cli`.

use std::process::ExitCode;

fn main() -> ExitCode {
    gaitway::cli::main()
}
