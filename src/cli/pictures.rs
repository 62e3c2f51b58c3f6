//! The pictures of a run.
use super::output::OutFolder;
use crate::evaluate::{Evaluation, Question, View};
use crate::mask::Mask;
use crate::report::model::Run;
use crate::verdict::Verdict;
pub(super) fn write_run(
    _o: &OutFolder,
    _n: usize,
    _v: &View<'_>,
    _q: &Question<'_>,
    _r: &Run,
    _e: &Evaluation<'_>,
) -> anyhow::Result<()> {
    Ok(())
}
pub(super) fn write_error_map(
    _o: &OutFolder,
    _n: usize,
    _q: &Question<'_>,
    _r: &Run,
    _m: &Mask,
    _v: &Verdict,
) -> anyhow::Result<()> {
    Ok(())
}
