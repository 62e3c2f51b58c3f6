//! Exit codes, and the one place where an error becomes a message.

use crate::evaluate::EvaluateError;
use crate::gpu::GpuError;
use crate::technique::TechniqueError;
use crate::watch::Interrupted;
use std::process::ExitCode;

/// Everything done, all budgets met.
pub(super) const OK: u8 = 0;
/// A budget exceeded.
pub(super) const BUDGET: u8 = 1;
/// Bad input or usage.
pub(super) const USAGE: u8 = 2;
/// No usable adapter or oracle.
pub(super) const NO_ADAPTER: u8 = 3;
/// A run failed.
pub(super) const FAILED: u8 = 4;
/// The user interrupted.
pub(super) const INTERRUPTED: u8 = 130;

/// What `--help` says about exit codes.
pub(super) const HELP: &str = "Exit codes: 0 done, all budgets met; 1 a budget exceeded; 2 bad input or usage; \
                               3 no usable adapter or oracle; 4 a run failed; 130 interrupted.";

/// Prints an error and says which code it is.
pub(super) fn of_error(error: &anyhow::Error) -> ExitCode {
    let code = code_of(error);
    super::terminal::complain(&format!("error: {error:#}"));
    ExitCode::from(code)
}

/// clap's own message; `--help` and `--version` are no errors.
pub(super) fn of_usage(error: &clap::Error) -> ExitCode {
    // Nothing is left to do if the terminal is gone.
    let _ = error.print();
    ExitCode::from(if error.use_stderr() { USAGE } else { OK })
}

fn code_of(error: &anyhow::Error) -> u8 {
    let gpu = |error: &GpuError| match error {
        GpuError::NoAdapter { .. } | GpuError::NoDevice { .. } => NO_ADAPTER,
        GpuError::TooLarge { .. } => USAGE,
        GpuError::OutOfMemory { .. } | GpuError::Invalid { .. } | GpuError::Lost { .. } => FAILED,
    };
    let technique = |error: &TechniqueError| match error {
        TechniqueError::Unsupported(_) => USAGE,
        TechniqueError::Gpu(error) => gpu(error),
        TechniqueError::NoAnswer { .. } => FAILED,
        TechniqueError::Interrupted(_) => INTERRUPTED,
    };
    for cause in error.chain() {
        if cause.is::<Interrupted>() {
            return INTERRUPTED;
        }
        if let Some(error) = cause.downcast_ref::<GpuError>() {
            return gpu(error);
        }
        if let Some(error) = cause.downcast_ref::<TechniqueError>() {
            return technique(error);
        }
        match cause.downcast_ref::<EvaluateError>() {
            Some(EvaluateError::Technique(error)) => return technique(error),
            Some(EvaluateError::Interrupted(_)) => return INTERRUPTED,
            Some(EvaluateError::Verdict(_) | EvaluateError::Ledger(_)) => return FAILED,
            None => {}
        }
    }
    USAGE
}
