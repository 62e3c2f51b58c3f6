//! The `gnomon` command; everything it does lives in the library.

fn main() -> std::process::ExitCode {
    gnomon::cli::main()
}
