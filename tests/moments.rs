//! Moment filters on scenes made to break them, and on one where they must not break: light bleeding, formats that
//! overflow, and what they share with the filters that compare.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, reason = "tests")]

mod support;

use gnomon::cause::Cause;
use gnomon::evaluate::Evaluation;
use gnomon::technique::Unsupported;
use support::models::boxes_on_diagonals;
use support::scenes::{scene_of_texts, shipped};
use support::shot::{Shot, parsed};

const SIZE: [u32; 2] = [200, 150];

fn wrong_of(evaluation: &Evaluation<'_>, cause: Cause) -> u64 {
    evaluation.ledger.causes.get(&cause).map_or(0, |share| share.pixels)
}

fn fact(evaluation: &Evaluation<'_>, label: &str) -> Option<String> {
    evaluation.prepared.facts().into_iter().find(|(known, _)| known == label).map(|(_, value)| value)
}

/// Two overlapping blockers at different depths: light bleeds through with every bound, most with the exponential one,
/// and not at all where answers are averaged.
#[test]
fn light_bleeds_where_two_blockers_overlap_and_only_with_moments() {
    let scene = shipped("bleeding", SIZE);
    let shot = Shot::new(&scene, "sun");
    let bled = |filter: &str| {
        let evaluation = shot.evaluate(&format!("map:size=512,filter={filter}"));
        (wrong_of(&evaluation, Cause::LightBleeding), evaluation.verdict.pixels.wrong)
    };
    for filter in ["vsm9", "esm9", "evsm9", "msm9"] {
        let (by_bleeding, wrong) = bled(filter);
        assert!(by_bleeding > 100 && by_bleeding * 10 > 8 * wrong, "{filter}: {by_bleeding} of {wrong}");
    }
    assert_eq!(bled("pcf-bilinear9").0, 0);
    // Four moments and two warps keep more apart than variance; a cut takes the rest, and some penumbra with it.
    let [cut, esm, vsm] = ["vsm9,bleeding_cut=0.5", "esm9", "vsm9"].map(|filter| bled(filter).0);
    assert!(esm > vsm + vsm / 2 && cut < vsm - vsm / 4, "{cut} {esm} {vsm}");
}

/// Thin parallel sheets: the same in small steps. Hardly behind each sheet lies the next.
#[test]
fn thin_parallel_sheets_shine_through() {
    let sheet = |y: f64, first: u32| {
        let corners = [[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]];
        let corners = corners.map(|[x, z]| format!("v {} {y} {z}\n", x + 0.3 * y)).concat();
        format!("o Sheet{first}\n{corners}f {} {} {} {}\n", first, first + 1, first + 2, first + 3)
    };
    let sheets: String = (0..5).map(|i| sheet(0.1 + 0.1 * f64::from(i), 5 + 4 * i)).collect();
    let model = format!("o Floor\nv -9 0 -9\nv -9 0 9\nv 9 0 9\nv 9 0 -9\nf 1 2 3 4\n{sheets}");
    let scene = scene_of_texts(
        "about = \"sheets\"\nsize = [160, 120]\n\
         [camera]\neye = [-4, 2.5, 0.1]\ntarget = [-0.6, 0.2, 0]\nfov_y_deg = 40\n\
         [[mesh]]\nfile = \"model.obj\"\n\
         [[light]]\nname = \"sun\"\nkind = \"directional\"\ndirection = [-1, -1, -0.2]\n",
        &model,
    );
    let shot = Shot::new(&scene, "sun");
    let [vsm, pcf] = ["vsm5", "pcf-bilinear5"].map(|filter| {
        let evaluation = shot.evaluate(&format!("map:size=256,filter={filter}"));
        (evaluation.verdict.pixels.false_light, wrong_of(&evaluation, Cause::LightBleeding))
    });
    assert!(vsm.1 > 100 && vsm.0 > 2 * pcf.0 && pcf.1 == 0, "{vsm:?} {pcf:?}");
}

/// MO-5: within the format's range nothing overflows; beyond it the texels are counted, and what they do is booked to
/// precision.
#[test]
fn exponents_beyond_the_format_are_counted_and_booked() {
    let scene = shipped("triangle", SIZE);
    let shot = Shot::new(&scene, "sun");
    let overflow = |filter: &str| {
        let evaluation = shot.evaluate(&format!("map:size=256,filter={filter}"));
        let counted: u32 = fact(&evaluation, "overflowed moments").expect("a moment filter").parse().expect("a count");
        let booked = evaluation.ledger.causes.get(&Cause::Precision).copied().unwrap_or_default();
        (counted, booked.pixels + booked.merely_differing)
    };
    for sound in ["vsm", "esm,exponent=80", "evsm,exponent=44"] {
        let (counted, by_precision) = overflow(sound);
        assert!(counted == 0 && by_precision <= 8, "{sound}: {counted} texels, {by_precision} pixels");
    }
    assert_eq!(overflow("esm,exponent=11,moment_format=float16").0, 0);
    assert_eq!(overflow("evsm,exponent=5.5,negative_exponent=5.5,moment_format=float16").0, 0);
    for broken in
        ["evsm,exponent=46", "evsm,exponent=10,moment_format=float16", "esm,exponent=12,moment_format=float16"]
    {
        assert!(overflow(broken).0 > 1000, "{broken}");
    }
    // Far beyond, where it reaches the shadow.
    for broken in ["evsm,exponent=40,moment_format=float16", "esm,exponent=40,moment_format=float16"] {
        let (counted, by_precision) = overflow(broken);
        assert!(counted > 1000 && by_precision > 20, "{broken}: {counted} texels, {by_precision} pixels");
    }
    assert_eq!(fact(&shot.evaluate("map"), "overflowed moments"), None);
}

/// MO-4: over one texel only the bilinear weights are left, so what moments say of a receiver among its own depths is what
/// the comparison says.
#[test]
fn on_lit_and_on_dark_ground_moments_agree_with_comparisons() {
    let scene = shipped("triangle", SIZE);
    for light in ["lamp", "sun"] {
        let shot = Shot::new(&scene, light);
        let nearest = shot.evaluate("map:size=512,depth_metric=linear").mask;
        for (filter, within) in [("vsm1", 0.01), ("evsm1", 0.001), ("msm1", 0.01)] {
            let mask = shot.evaluate(&format!("map:size=512,filter={filter}")).mask;
            let pairs = nearest.pixels.iter().zip(&mask.pixels).filter_map(|(a, b)| Some(((*a)?.get(), (*b)?.get())));
            let off = pairs.clone().filter(|(a, b)| f64::from((a - b).abs()) > within).count();
            // The bilinear rim of the one edge there is.
            assert!(20 < off && 30 * off < pairs.clone().count(), "{light} {filter}: {off} of {}", pairs.count());
        }
    }
}

/// Around a lamp, across the seam of two discs: what a window holds beyond the disc's rim is its nearest texel, on the
/// device as in the replay, and the answers are as good as those of a cube with about as many texels.
#[test]
fn moments_on_discs_end_at_their_rims() {
    let scene = boxes_on_diagonals();
    let shot = Shot::new(&scene, "lamp");
    for filter in ["vsm5", "esm3", "evsm8", "msm3", "vsm9,depth_convention=forward"] {
        let of = |typed: &str| shot.evaluate(&format!("map:{typed},seam=clamp,filter={filter}"));
        let (discs, cube) = (of("projection=dual-paraboloid,size=480"), of("projection=cube,size=256"));
        let by_precision = discs.ledger.causes.get(&Cause::Precision).copied().unwrap_or_default();
        // Rows that took what lies beyond the rim for what it is would leave up to nine.
        assert!(by_precision.pixels + by_precision.merely_differing <= 1, "{filter}: {by_precision:?}");
        let (on_discs, on_cube) = (discs.verdict.pixels.wrong, cube.verdict.pixels.wrong);
        println!("{filter}: {on_discs} wrong on discs, {on_cube} on a cube; {by_precision:?}");
        assert!(on_discs < 2 * on_cube, "{filter}: {on_discs} {on_cube}");
    }
}

/// FI-5: averaged depths are answered with light or shadow, never in between, where averaged answers have a penumbra.
#[test]
fn depths_that_are_averaged_leave_a_hard_edge() {
    let scene = shipped("triangle", SIZE);
    let shot = Shot::new(&scene, "sun");
    let between = |filter: &str| {
        let mask = shot.evaluate(&format!("map:size=256,filter={filter}")).mask;
        mask.pixels.iter().flatten().filter(|v| v.get() > 0.0 && v.get() < 1.0).count()
    };
    assert_eq!(between("depth-mean5"), 0);
    assert!(between("pcf-bilinear5") > 300);
    let evaluation = shot.evaluate("map:size=256,filter=depth-mean5");
    assert!(wrong_of(&evaluation, Cause::TechniqueModel) > 50, "{:?}", evaluation.ledger.causes);
}

#[test]
fn views_that_cannot_be_averaged_across_are_refused() {
    let scene = shipped("torus", [64, 48]);
    let gpu = support::scenes::gpu();
    let refusal = |typed: &str| {
        let spec = parsed(typed);
        spec.technique().supports(&spec, &scene, scene.light("lamp").unwrap(), &gpu).err()
    };
    let refused = refusal("map:projection=cube,filter=vsm").unwrap();
    assert!(
        matches!(refused, Unsupported::Combination { .. }) && refused.to_string().contains("seam=clamp"),
        "{refused}"
    );
    assert_eq!(refusal("map:projection=cube,filter=vsm,seam=clamp"), None);
    assert!(refusal("map:filter=msm,depth_metric=projected").is_some());
    assert!(refusal("map:filter=msm,bias=receiver-plane").unwrap().to_string().contains("texel by texel"));
    assert!(refusal("map:filter=vsm,border=clamp-edge").unwrap().to_string().contains("has no means"));
    assert_eq!(refusal("map:filter=vsm,border=shadow"), None);
}
