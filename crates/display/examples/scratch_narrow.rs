use papilio_display::{Control, Prepared};
use papilio_scenario::Scenario;
use std::sync::atomic::AtomicBool;
fn cpu() -> f64 {
    let t = std::fs::read_to_string("/proc/self/schedstat").unwrap();
    t.split(' ').next().unwrap().parse::<f64>().unwrap() * 1e-9
}
fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let scene = Scenario::load(args[0].as_ref(), &args[1..]).unwrap().resolve().unwrap().scene;
    let control = Control { threads: Some(1), progress: &|p| eprint!("{:.1e} ", p.relative_error), stop: &AtomicBool::new(false) };
    let mut t = cpu();
    let mut prepared = Prepared::new(&scene).unwrap();
    eprintln!("setup {:.4}", cpu() - t);
    t = cpu();
    let result = prepared.run(&scene, &control).unwrap();
    eprintln!("\nrun {:.4}", cpu() - t);
    t = cpu();
    let mut prepared = Prepared::new(&scene).unwrap();
    prepared.run(&scene, &control).unwrap();
    eprintln!("\nagain {:.4}", cpu() - t);
    let mut moved = scene.clone();
    moved.display.layers = match moved.display.layers.clone() {
        papilio_display::scene::Layers::Panel(mut p) => {
            if let Some(d) = &mut p.diffuser { if let papilio_display::scene::Lobe::KCorrelation { width } = &mut d.lobe { *width *= 1.001; } }
            papilio_display::scene::Layers::Panel(p)
        }
        other => other,
    };
    t = cpu();
    prepared.run(&moved, &control).unwrap();
    eprintln!("\nnew haze {:.4}", cpu() - t);
    println!("{}", serde_json::to_string(&result).unwrap_or_default());
}
