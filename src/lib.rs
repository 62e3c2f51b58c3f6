//! gnomon measures shadows: it renders a scene's shadows with real-time techniques on wgpu, works out by exact ray
//! casting what every pixel should have been, and explains every wrong pixel by its cause.
//!
//! Data flows one way, and a module uses only what stands above it:
//!
//! ```text
//! watch      how long work reports progress and learns that it should stop
//! scene      file → validated, immutable Scene                              (no wgpu)
//! inspect    what the scene requires: closed? T-junctions? depth range?     (no wgpu)
//! cast       the exact ray core: bvh, watertight test, brute force          (no wgpu)
//! gpu        device, buffers, G-buffer, readback, timing                    (the only raw wgpu set-up)
//! receiver   triangle ids → f64 point on that triangle, per pixel           (no wgpu)
//! mask       visibility per pixel: a technique's answer and the truth       (no wgpu)
//! truth      receivers → TruthMask                                          (no wgpu)
//! cause      the closed list of error causes, and the stages of a replay   (no wgpu)
//! technique  (gpu, scene, receivers) → Mask, and its stages replayed in f64
//! shade      receivers and masks → a lit picture                            (no wgpu)
//! verdict    (Mask, TruthMask, stages) → Verdict                            (pure functions, no wgpu)
//! evaluate   technique against truth: answer, cost, verdict and ledger of one run
//! report     Verdict → json, csv, png                                       (pure: returns bytes, no wgpu)
//! trade      many configurations: grids, results, what nothing beats        (pure: returns bytes, no wgpu)
//! cli        the only IO and the only anyhow
//! ```

pub mod cast;
pub mod cause;
pub mod cli;
pub mod evaluate;
pub mod gpu;
pub mod inspect;
pub mod mask;
pub mod receiver;
pub mod report;
pub mod scene;
pub mod shade;
mod suggest;
pub mod technique;
pub mod trade;
pub mod truth;
pub mod verdict;
pub mod watch;
