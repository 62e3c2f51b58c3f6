//! The search of `advise` beside trying everything: on real scenes it finds what costs least, and tries at most a quarter.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "tests")]

use glam::UVec2;
use gnomon::evaluate::{Effort, View, evaluate};
use gnomon::gpu::Gpu;
use gnomon::scene::{LoadOptions, load};
use gnomon::technique::Spec;
use gnomon::trade::advise::{Trial, lines, search};
use gnomon::trade::specs_of_grids;
use gnomon::watch::Unwatched;
use std::convert::Infallible;
use std::path::Path;

/// 8 sizes × 25 lines.
const GRID: &str = "map:size=16..2048,filter=nearest|pcf-box2|pcf-box3|pcf-box4|pcf-box5,\
                    bias_cap_texels=4|8|16|32|64";
const BUDGETS: [f64; 3] = [0.02, 0.005, 0.001];
const SCENES: [&str; 5] = ["torus", "room", "posts", "contact", "polygons-69"];

/// Every configuration of the grid on the first light that it applies to, in lines.
fn all_trials(gpu: &Gpu, name: &str) -> Vec<Vec<Trial>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
    let scene = load(&folder, &LoadOptions { size: Some(UVec2::new(120, 90)), ..LoadOptions::default() }).unwrap();
    let view = View::new(gpu, &scene).unwrap();
    let specs = specs_of_grids(&[GRID.to_owned()]).unwrap();
    assert_eq!(specs.len(), 200);
    let applies = |light: &&gnomon::scene::Light| specs[0].technique().supports(&specs[0], &scene, light, gpu).is_ok();
    let question = view.ask(scene.lights.iter().find(applies).unwrap(), &Unwatched).unwrap();
    let trial = |spec: &Spec| {
        let evaluation = evaluate(&view, &question, spec, Effort::VERDICT, &Unwatched).unwrap();
        Trial::by_work(spec, evaluation.verdict.error.wrong_fraction.unwrap(), &evaluation.cost).unwrap()
    };
    lines(&specs).iter().map(|line| line.steps.iter().map(trial).collect()).collect()
}

#[test]
fn it_finds_what_trying_everything_finds_with_a_quarter_of_the_trials() {
    let gpu = Gpu::open().unwrap();
    let mut answered = 0;
    for name in SCENES {
        let all = all_trials(&gpu, name);
        let lengths: Vec<usize> = all.iter().map(Vec::len).collect();
        for line in &all {
            for (step, trial) in line.iter().enumerate() {
                let bounds = line.iter().all(|other| trial.least_cost <= other.cost);
                let next = line.get(step + 1).is_none_or(|next| trial.next_cost <= next.cost);
                assert!(bounds && next, "{name}, step {step}: {trial:?}");
            }
        }
        for budget in BUDGETS {
            let step = |line: usize, step: usize| Ok::<_, Infallible>(Some(all[line][step]));
            let Ok(found) = search(&lengths, budget, step);
            let good = all.iter().flatten().filter(|trial| trial.error <= budget);
            let least = good.map(|trial| trial.cost).min_by(f64::total_cmp);
            let cost = found.answer.map(|(line, step)| all[line][step].cost);
            assert_eq!(cost, least, "{name}, {budget}");
            assert!(4 * found.tried.len() <= 200, "{name}, {budget}: {} tried", found.tried.len());
            answered += usize::from(cost.is_some());
            println!("{name}, {budget}: {cost:?}, {} tried", found.tried.len());
        }
    }
    assert!(answered > SCENES.len() * BUDGETS.len() / 2, "{answered} budgets can be met at all");
}
