//! Exit codes, and the one place where an error becomes a message.

use crate::evaluate::EvaluateError;
use crate::gpu::GpuError;
use crate::technique::TechniqueError;
use crate::truth::mitsuba::MitsubaError;
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

/// What `--help` says at its end.
pub(super) const HELP: &str = "Start with:\n  gnomon list scenes\n  gnomon check scenes/torus\n\n\
                               GNOMON_ADAPTER chooses the graphics adapter, by its name or number in 'gnomon doctor'.\n\n\
                               Exit codes: 0 done, all budgets met; 1 a budget exceeded; 2 bad input or usage; \
                               3 no usable adapter or oracle; 4 a run failed; 130 interrupted.";

/// Prints an error and says which code it is.
pub(super) fn of_error(error: &anyhow::Error) -> ExitCode {
    super::terminal::complain(&format!("error: {}", message(error)));
    ExitCode::from(code_of(error))
}

/// The error and its causes, from the outside in. Some errors repeat their cause in their own text: what is said already
/// is not said again.
pub(super) fn message(error: &anyhow::Error) -> String {
    let mut text = String::new();
    for cause in error.chain().map(ToString::to_string) {
        if !text.contains(&cause) {
            let joint = if text.is_empty() { "" } else { ": " };
            text = format!("{text}{joint}{cause}");
        }
    }
    text
}

/// clap's own message; `--help` and `--version` are no errors.
pub(super) fn of_usage(error: &clap::Error) -> ExitCode {
    // Nothing is left to do if the terminal is gone.
    let _ = error.print();
    ExitCode::from(if error.use_stderr() { USAGE } else { OK })
}

/// The code of an error, by the first of its causes that has one.
pub(super) fn code_of(error: &anyhow::Error) -> u8 {
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
    let mitsuba = |error: &MitsubaError| match error {
        MitsubaError::Missing => NO_ADAPTER,
        MitsubaError::Interrupted(_) => INTERRUPTED,
        MitsubaError::Io(_) | MitsubaError::Answer(_) | MitsubaError::Void { .. } => FAILED,
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
        if let Some(error) = cause.downcast_ref::<MitsubaError>() {
            return mitsuba(error);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cause_is_said_once() {
        let io = || std::io::Error::other("disk full");
        let repeating = anyhow::Error::from(io()).context("x.png: disk full").context("writing");
        assert_eq!(message(&repeating), "writing: x.png: disk full");
        assert_eq!(message(&anyhow::Error::from(io()).context("x.png")), "x.png: disk full");
    }

    #[test]
    fn the_code_is_that_of_the_cause_whatever_is_said_about_it() {
        let wrapped = |error: EvaluateError| anyhow::Error::from(error).context("scene 'a'");
        assert_eq!(code_of(&wrapped(Interrupted.into())), INTERRUPTED);
        assert_eq!(code_of(&wrapped(TechniqueError::Interrupted(Interrupted).into())), INTERRUPTED);
        let large = GpuError::TooLarge { what: "x".to_owned(), asked: 2, limit: 1 };
        assert_eq!(code_of(&anyhow::Error::from(large).context("scene 'a'")), USAGE);
        let missing = GpuError::NoAdapter { why: String::new(), found: String::new(), remedy: String::new() };
        assert_eq!(code_of(&missing.into()), NO_ADAPTER);
        assert_eq!(code_of(&anyhow::anyhow!("anything else")), USAGE);
    }
}
