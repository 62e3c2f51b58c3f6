//! `gnomon doctor`: what this machine can do.

use super::exit;
use super::terminal::say;
use crate::gpu::{Gpu, describe_adapters};
use crate::truth::mitsuba::Mitsuba;

pub(super) fn run() -> anyhow::Result<u8> {
    say(&format!("gnomon {} ({} {})", env!("CARGO_PKG_VERSION"), std::env::consts::OS, std::env::consts::ARCH));
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    say(&format!("threads            {threads}"));
    for (index, adapter) in describe_adapters().iter().enumerate() {
        say(&format!("adapter {index}          {} ({}) {}", adapter.name, adapter.backend, adapter.driver));
    }
    let gpu = Gpu::open()?;
    let adapter = gpu.adapter();
    say(&format!("in use             {} (choose another with GNOMON_ADAPTER=NAME or a number)", adapter.name));
    if adapter.is_software {
        say("                   a software rasteriser: its milliseconds stand for no real machine");
    }
    say(&format!("features           {}", adapter.features.join(", ")));
    let limits = gpu.limits();
    say(&format!("largest map        {0} x {0} texels", limits.texture_side));
    say(&format!("largest binding    {} MiB", limits.storage_binding_bytes >> 20));
    say(&format!("largest buffer     {} MiB", limits.buffer_bytes >> 20));
    say(&format!("vertices snap to   1/{:.0} pixel (measured)", 1.0 / gpu.vertex_step_px()));
    say("oracle exact       available (built in, f64 with exact predicates)");
    say("oracle brute       available (built in, cross-checks a sample of every truth)");
    let mitsuba =
        if Mitsuba::is_installed() { "available (--oracle both)" } else { "not installed: run `make oracle`" };
    say(&format!("oracle mitsuba     {mitsuba}"));
    Ok(exit::OK)
}
