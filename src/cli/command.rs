//! The commands that gnomon suggests, spelled so that a POSIX shell runs exactly what was meant, whatever scenes and
//! lights are called.

use super::args::SceneArgs;
use crate::technique::Spec;
use glam::UVec2;
use std::path::Path;

/// One technique on one light of a scene, in a picture of one size: what a command about a result has to name.
#[derive(Debug, Clone, Copy)]
pub(super) struct Subject<'a> {
    /// The scene as the user wrote it.
    pub(super) scene: &'a Path,
    /// The light's name.
    pub(super) light: &'a str,
    /// The technique.
    pub(super) spec: &'a Spec,
    /// Width and height in pixels.
    pub(super) size: UVec2,
}

impl Subject<'_> {
    /// Measures it again; `jitter` as in `--jitter`, `motion` as in `--motion`.
    pub(super) fn check(&self, jitter: u32, motion: u32) -> String {
        let option = |name: &str, count: u32| if count > 0 { format!(" --{name} {count}") } else { String::new() };
        format!("{}{}{}", self.spelled("check"), option("jitter", jitter), option("motion", motion))
    }

    /// Looks for what is wrong.
    pub(super) fn diagnose(&self) -> String {
        self.spelled("diagnose")
    }

    /// Explains a pixel, which is still to be named with `--pixel X,Y`.
    pub(super) fn explain_some_pixel(&self) -> String {
        self.spelled("explain")
    }

    /// Explains a pixel, given as `y * width + x`.
    pub(super) fn explain(&self, pixel: u32) -> String {
        format!("{} --pixel {},{}", self.explain_some_pixel(), pixel % self.size.x, pixel / self.size.x)
    }

    fn spelled(&self, command: &str) -> String {
        let (scene, light) = (quoted_path(self.scene), light_option(self.light));
        let UVec2 { x, y } = self.size;
        format!("gnomon {command} {scene} -t {} {light} --size {x}x{y}", quoted(&self.spec.short()))
    }
}

/// Scene, light and size as the user gave them, for a command with the same arguments.
pub(super) fn as_typed(args: &SceneArgs) -> String {
    let light = args.light.as_deref().map_or_else(String::new, |name| format!(" {}", light_option(name)));
    let size = args.size.map_or_else(String::new, |size| format!(" --size {}x{}", size.x, size.y));
    format!("{}{light}{size}", quoted_path(&args.scene))
}

/// `--light NAME`; a name that looks like an option is tied to it.
pub(super) fn light_option(name: &str) -> String {
    let tie = if name.starts_with('-') { '=' } else { ' ' };
    format!("--light{tie}{}", quoted(name))
}

/// A path as an argument; one that looks like an option is led by `./`.
pub(super) fn quoted_path(path: &Path) -> String {
    let path = path.to_string_lossy();
    if path.starts_with('-') { quoted(&format!("./{path}")) } else { quoted(&path) }
}

/// A word as a POSIX shell takes it.
pub(super) fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./:=,+".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_survive_the_shell() {
        assert_eq!(quoted("map:size=64,filter=pcf-box3"), "map:size=64,filter=pcf-box3");
        assert_eq!(quoted("my scene; rm x"), "'my scene; rm x'");
        assert_eq!(quoted("it's"), "'it'\\''s'");
        assert_eq!(quoted(""), "''");
    }

    #[test]
    fn names_that_look_like_options_are_none() {
        assert_eq!(light_option("lamp"), "--light lamp");
        assert_eq!(light_option("-t"), "--light=-t");
        assert_eq!(quoted_path(Path::new("-o")), "./-o");
        assert_eq!(quoted_path(Path::new("-a b")), "'./-a b'");
    }

    #[test]
    fn a_subject_is_named_in_full() {
        let spec = Spec::parse("map:size=64").unwrap();
        let subject = Subject { scene: Path::new("s"), light: "sun", spec: &spec, size: UVec2::new(64, 48) };
        assert_eq!(subject.check(0, 0), "gnomon check s -t map:size=64 --light sun --size 64x48");
        assert_eq!(subject.check(3, 2), "gnomon check s -t map:size=64 --light sun --size 64x48 --jitter 3 --motion 2");
        assert_eq!(subject.explain(65), "gnomon explain s -t map:size=64 --light sun --size 64x48 --pixel 1,1");
        assert!(subject.diagnose().starts_with("gnomon diagnose s"));
    }
}
