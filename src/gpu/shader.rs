//! Every WGSL source by name. A module is the concatenation of the files it needs: WGSL resolves names regardless of
//! order, so shared functions and permutations are files that are added, never text that is rewritten.

/// A WGSL file of the `shaders/` folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Wgsl {
    /// Its path below `shaders/`, for error messages.
    pub path: &'static str,
    /// Its text.
    pub text: &'static str,
}

/// Includes a file of the `shaders/` folder.
macro_rules! wgsl {
    ($path:literal) => {
        $crate::gpu::shader::Wgsl {
            path: $path,
            text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/", $path)),
        }
    };
}
pub(crate) use wgsl;

/// The G-buffer.
pub const GBUFFER: Wgsl = wgsl!("gbuffer.wgsl");

/// One module out of several files.
#[must_use]
pub fn concatenated(files: &[Wgsl]) -> String {
    files.iter().map(|file| file.text).collect::<Vec<_>>().join("\n")
}

impl super::Gpu {
    /// What a module of these files holds.
    pub(super) fn text(&self, files: &[Wgsl]) -> String {
        let text = concatenated(files);
        #[cfg(test)]
        let text = self.fault.iter().fold(text, |text, (from, to)| text.replace(from, to));
        text
    }

    pub(super) fn module(&self, label: &str, text: String) -> wgpu::ShaderModule {
        self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(label),
            source: wgpu::ShaderSource::Wgsl(text.into()),
        })
    }
}
