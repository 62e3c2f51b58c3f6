//! The rows of a sweep: which there are, which of them a shard measures, and measuring them.

use super::folder::ResultsFolder;
use super::limits::{RowLimits, RowWatch};
use super::proceed;
use super::truths::TruthFolder;
use crate::cli::command::Subject;
use crate::cli::context::lights;
use crate::cli::report;
use crate::evaluate::{Effort, EvaluateError, Question, View, evaluate, time_evaluations};
use crate::gpu::{Gpu, GpuError};
use crate::report::model::Run;
use crate::scene::{Light, Scene};
use crate::technique::{Spec, TechniqueError};
use crate::trade::Record;
use crate::watch::Watch;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

/// One configuration for one light of one scene.
#[derive(Debug, Clone)]
pub(super) struct Row<'s> {
    /// Its place in the whole sweep, over all shards.
    pub(super) index: usize,
    pub(super) scene: &'s Scene,
    pub(super) light: &'s Light,
    pub(super) spec: Spec,
}

/// One share of a sweep: the rows whose place leaves `part` − 1 when divided by `of`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Shard {
    /// From 1.
    pub(crate) part: usize,
    /// How many there are.
    pub(crate) of: usize,
}

/// The rows of a shard, scene by scene, light by light. A light that `name` names is in every scene.
pub(super) fn plan<'s>(
    scenes: &[(&Path, &'s Scene)],
    name: Option<&str>,
    specs: &[Spec],
    shard: Shard,
) -> Vec<Row<'s>> {
    let lit =
        scenes.iter().flat_map(|(_, scene)| lights(scene, name).into_iter().flatten().map(|light| (*scene, light)));
    let rows = lit.flat_map(|(scene, light)| specs.iter().map(move |spec| (scene, light, spec.clone())));
    let numbered = rows.enumerate().filter(|(index, _)| index % shard.of == shard.part - 1);
    numbered.map(|(index, (scene, light, spec))| Row { index, scene, light, spec }).collect()
}

/// What measuring needs but the device.
pub(super) struct Session<'a> {
    pub(super) results: &'a mut ResultsFolder,
    pub(super) truths: &'a Path,
    pub(super) limits: RowLimits,
    pub(super) terminal: &'a dyn Watch,
}

/// How measuring a scene's rows ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ended {
    /// All are done.
    AllRows,
    /// The device was lost, and with it the row at hand; the rest is still pending.
    DeviceLost,
}

impl Session<'_> {
    /// Measures the pending rows of a scene and takes them off the list. What is in the results already is not measured
    /// again.
    pub(super) fn measure(
        &mut self,
        gpu: &Gpu,
        path: &Path,
        scene: &Scene,
        pending: &mut Vec<&Row<'_>>,
    ) -> anyhow::Result<Ended> {
        let view = View::new(gpu, scene)?;
        let truths = TruthFolder::new(self.truths);
        while let Some(first) = pending.first() {
            let light = first.light;
            let key = view.truth_key(light).to_string();
            let of_light = pending.iter().take_while(|row| std::ptr::eq(row.light, light)).count();
            let is_done = |row: &&Row<'_>| self.results.holds(&key, &row.spec.to_string());
            if pending[..of_light].iter().all(is_done) {
                pending.drain(..of_light);
                self.terminal.advance(of_light as u64);
                continue;
            }
            let question = view.ask_stored(light, &truths, &RowWatch::new(self.terminal, f64::INFINITY))?;
            for _ in 0..of_light {
                let row = pending.remove(0);
                self.terminal.advance(1);
                if self.results.holds(&key, &row.spec.to_string()) {
                    continue;
                }
                proceed(self.terminal)?;
                let (run, ended) = self.measured(&view, &question, path, row)?;
                self.results.append(Record { row: row.index, question: key.clone(), run })?;
                if ended == Ended::DeviceLost {
                    return Ok(ended);
                }
            }
        }
        Ok(Ended::AllRows)
    }

    /// One row. Whatever a technique does wrong is a row, too; only the user's interrupt is an error.
    fn measured(
        &self,
        view: &View<'_>,
        question: &Question<'_>,
        path: &Path,
        row: &Row<'_>,
    ) -> anyhow::Result<(Run, Ended)> {
        let size = row.scene.image_size;
        let subject = Subject { scene: path, light: &row.light.name, spec: &row.spec, size };
        let asked = report::question(row.scene, row.light, &row.spec, subject.check(0, 0));
        let watch = RowWatch::new(self.terminal, self.limits.seconds);
        let outcome = guarded(|| {
            self.limits.admit(view, question, &row.spec)?;
            evaluate(view, question, &row.spec, Effort::CAUSES, &watch)
                .and_then(|mut evaluation| {
                    time_evaluations(view, &mut [&mut evaluation], &watch)?;
                    Ok(evaluation)
                })
                .map_err(|error| watch.told(error))
        });
        let (run, ended) = match outcome {
            Ok(evaluation) => {
                let mut run = Run::judged(asked, &evaluation.verdict).explained_by(&evaluation.ledger);
                run.cost = Some(evaluation.cost.clone());
                run.truth = Some(report::truth_source(question));
                (run, Ended::AllRows)
            }
            Err(RowError::Evaluate(EvaluateError::Technique(TechniqueError::Unsupported(why)))) => {
                (Run::unsupported(asked, why.to_string()), Ended::AllRows)
            }
            Err(error) => {
                proceed(self.terminal)?;
                let ended = if error.is_device_lost() { Ended::DeviceLost } else { Ended::AllRows };
                (Run::failed(asked, error.to_string()), ended)
            }
        };
        Ok((run, ended))
    }
}

/// The graphics library panics where it maps a buffer of a device that was just lost; that, too, costs one row.
fn guarded<T>(work: impl FnOnce() -> Result<T, RowError>) -> Result<T, RowError> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
        Err(RowError::Panic { why: text.unwrap_or("no reason given").to_owned() })
    })
}

/// Why a row has no result.
#[derive(Debug, thiserror::Error)]
pub(super) enum RowError {
    /// As for every evaluation.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// The graphics library gave up; the device may be gone.
    #[error("the graphics library gave up: {why}")]
    Panic {
        /// Its words.
        why: String,
    },
    /// It took too long.
    #[error("took longer than {seconds} s")]
    Time {
        /// The limit.
        seconds: f64,
    },
    /// It takes too much memory on the GPU.
    #[error("takes {megabytes:.0} MB on the GPU, more than {limit}")]
    Memory {
        /// What it takes.
        megabytes: f64,
        /// The limit.
        limit: f64,
    },
}

impl RowError {
    fn is_device_lost(&self) -> bool {
        match self {
            Self::Evaluate(EvaluateError::Technique(TechniqueError::Gpu(error))) => {
                matches!(error, GpuError::Lost { .. })
            }
            Self::Panic { .. } => true,
            Self::Evaluate(_) | Self::Time { .. } | Self::Memory { .. } => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::model::Status;
    use std::sync::atomic::{AtomicU32, Ordering};

    /// A watch that loses the device when the second row begins.
    struct Saboteur<'g> {
        gpu: &'g Gpu,
        rows: AtomicU32,
    }

    impl Watch for Saboteur<'_> {
        fn start(&self, _what: &str, _total: u64) {}
        fn advance(&self, _units: u64) {
            if self.rows.fetch_add(1, Ordering::SeqCst) == 1 {
                self.gpu.device.destroy();
            }
        }
        fn interrupted(&self) -> bool {
            false
        }
    }

    #[test]
    fn a_lost_device_costs_one_row() {
        let folder = tempfile::TempDir::new().unwrap();
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/triangle");
        let size = Some(glam::UVec2::new(32, 24));
        let scene = crate::scene::load(&path, &crate::scene::LoadOptions { size, ..Default::default() }).unwrap();
        let specs: Vec<Spec> =
            ["map:size=16", "map:size=32", "map:size=64"].map(|typed| Spec::parse(typed).unwrap()).into();
        let light = Some(scene.lights[0].name.as_str());
        let rows = plan(&[(&path, &scene)], light, &specs, Shard { part: 1, of: 1 });
        let mut pending: Vec<&Row<'_>> = rows.iter().collect();
        let gpu = Gpu::open().unwrap();
        let mut results = ResultsFolder::open(folder.path(), &super::super::header(&gpu)).unwrap();
        let limits = RowLimits { seconds: 1e9, megabytes: None };
        let saboteur = Saboteur { gpu: &gpu, rows: AtomicU32::new(0) };
        let mut measure = |gpu: &Gpu, watch: &dyn Watch, pending: &mut Vec<&Row<'_>>| {
            let mut session = Session { results: &mut results, truths: folder.path(), limits, terminal: watch };
            session.measure(gpu, &path, &scene, pending).unwrap()
        };
        assert_eq!(measure(&gpu, &saboteur, &mut pending), Ended::DeviceLost);
        assert_eq!(pending.len(), 1);
        assert_eq!(measure(&Gpu::open().unwrap(), &crate::watch::Unwatched, &mut pending), Ended::AllRows);
        let statuses: Vec<Status> = results.records().iter().map(|record| record.run.status).collect();
        assert_eq!(statuses, [Status::Ok, Status::Failed, Status::Ok]);
    }

    #[test]
    fn shards_share_the_rows_without_overlap() {
        let whole = Shard { part: 1, of: 1 };
        let scene_of = |name: &str| {
            let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
            crate::scene::load(&folder, &crate::scene::LoadOptions::default()).unwrap()
        };
        let (torus, room) = (scene_of("torus"), scene_of("room"));
        let scenes = [(Path::new("a"), &torus), (Path::new("b"), &room)];
        let specs: Vec<Spec> = ["map", "volume", "map:size=64"].map(|typed| Spec::parse(typed).unwrap()).into();
        let indices = |shard| plan(&scenes, None, &specs, shard).iter().map(|row| row.index).collect::<Vec<_>>();
        let all = indices(whole);
        assert!(all.iter().copied().eq(0..12));
        let mut shared: Vec<usize> = (1..=5).flat_map(|part| indices(Shard { part, of: 5 })).collect();
        assert_eq!(shared.len(), all.len());
        shared.sort_unstable();
        assert_eq!(shared, all);
    }
}
