//! Where the light is and how wide it looks.
//!
//! M. Brasas, master's thesis, Kaunas University of Technology, 2010, moved a point light near the casters, 100 times as far
//! away, and into a pipe, and opened its field of view too little and too much; the conclusions are pictures and words.

use super::lab::{Lab, LabError};
use super::{Experiment, Row};
use crate::cause::Cause;
use crate::scene::{LightKind, Scene};

const SOURCE: &str = "M. Brasas, master's thesis, Kaunas 2010 (pictures and words)";
/// How much farther the far light is.
const FARTHER: f32 = 100.0;

/// Light near, far, and inside the pipe.
pub(super) fn distance(lab: &Lab<'_>, scenes: &[Scene]) -> Result<Experiment, LabError> {
    let near = &scenes[0];
    let far = moved_away(near);
    let typed = |map: &str| vec![map.to_owned(), "volume".to_owned()];
    let fov_of_near = "map:fov_deg=90";
    let [near, kept, refitted, pipe] = [
        lab.measure(near, &typed("map"))?,
        lab.measure(&far, &typed(fov_of_near))?,
        lab.measure(&far, &typed("map"))?,
        lab.measure(&scenes[4], &typed("map"))?,
    ];
    let wrong = |sample: &Result<super::lab::Sample, String>| sample.as_ref().map_or(f64::NAN, |sample| sample.wrong);
    let said = |sample: &Result<super::lab::Sample, String>| match sample {
        Ok(sample) => sample.error(),
        Err(why) => format!("not applicable: {why}"),
    };
    let row = |what: &str, published: &str, here: String, error: String, holds: Option<bool>| Row {
        what: what.to_owned(),
        published: published.to_owned(),
        here,
        error,
        holds,
    };
    let grows = wrong(&kept[0]) / wrong(&near[0]);
    let bounded = wrong(&refitted[0]) / wrong(&near[0]);
    let rows = vec![
        row("light near, map fitted", "shadows as expected", String::new(), said(&near[0]), None),
        row(
            "100 × farther, same wide field of view",
            "unusable: texels 100 × as large",
            format!("× {} as many wrong pixels", super::times(grows)),
            said(&kept[0]),
            Some(grows > super::TOLERANCE),
        ),
        row(
            "100 × farther, field of view fitted again",
            "as good as near",
            format!("× {} as many wrong pixels", super::times(bounded)),
            said(&refitted[0]),
            Some(bounded <= super::TOLERANCE),
        ),
        row(
            "inside the pipe, one map",
            "one map cannot hold it",
            String::new(),
            said(&pipe[0]),
            Some(pipe[0].is_err()),
        ),
        row(
            "near, far and inside the pipe, volumes",
            "do not depend on the light's place",
            String::new(),
            [&near[1], &refitted[1], &pipe[1]].map(said).join("; "),
            Some([&near[1], &refitted[1], &pipe[1]].iter().all(|sample| wrong(sample) < 1e-4)),
        ),
    ];
    Ok(Experiment { title: "the light's place", source: SOURCE, rows })
}

/// The scene with its first light farther from where it aims; other kinds of lights have no distance.
fn moved_away(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    if let Some(light) = scene.lights.first_mut()
        && let LightKind::Point { position, aim, .. } = &mut light.kind
    {
        *position = *aim + FARTHER * (*position - *aim);
    }
    scene
}

/// Field of view too narrow and too wide.
pub(super) fn field_of_view(lab: &Lab<'_>, scenes: &[Scene]) -> Result<Experiment, LabError> {
    let typed = ["map", "map:fov_deg=30", "map:fov_deg=160"].map(str::to_owned);
    let samples = lab.samples(&scenes[0], &typed)?;
    let [fitted, narrow, wide] = [&samples[0], &samples[1], &samples[2]];
    let ratio = |sample: &super::lab::Sample| sample.wrong / fitted.wrong;
    let row = |what: &str, published: &str, sample: &super::lab::Sample, holds: Option<bool>| Row {
        what: what.to_owned(),
        published: published.to_owned(),
        here: format!("× {} as many wrong pixels", super::times(ratio(sample))),
        error: sample.error(),
        holds,
    };
    let rows = vec![
        row("fitted", "shadows as expected", fitted, None),
        row(
            "too narrow, 30 degrees",
            "shadows outside are lost",
            narrow,
            Some(narrow.main_cause == Some(Cause::ClippingFrustum) && ratio(narrow) > 1.0),
        ),
        row("too wide, 160 degrees", "coarse shadows: texels are wasted", wide, Some(ratio(wide) > super::TOLERANCE)),
    ];
    Ok(Experiment { title: "the light's field of view", source: SOURCE, rows })
}
