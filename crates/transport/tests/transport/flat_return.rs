//! Light that flat faces and a front return to paper, tabulated: closed forms, and the sum over directions.

use papilio_transport::spatial::{Accuracy, FlatReturn, PanelSpread};
use papilio_transport::{Base, Cone, Front, Medium, Panel, Reflector, Source, Top};

fn panel(top: Top, index: &[f64], front: &[f64]) -> Panel {
    let bins = index.len();
    Panel {
        front: Front::exact(bins, [(front, &vec![0.0; bins][..])]),
        top,
        medium: Medium::new(index.to_vec().into()),
        base: Base {
            reflector: Reflector::Lambertian(vec![0.5; bins]),
            inactive_absorptance: vec![0.0; bins].into(),
        },
        single_pass: false,
    }
}

const ACCURACY: Accuracy = Accuracy { digits: 12.0, most_per_mm: 40.0 };

/// The table resolves ways of up to 30 lengths. Through a face that transmits grazing light, too, (2/30)^2 = 4e-3 of it go farther.
///
/// Through a clear face the integral over the directions of air has a closed form: all light of one pass returns the fraction of the
/// front, 1/n^2 of all.
#[test]
fn uniform_light_has_the_return_of_colours() {
    let ideal = panel(Top::IdealAr, &[1.5], &[0.3]);
    let all = FlatReturn::all(&ideal, &[0.4, 0.6], ACCURACY).unwrap();
    let expected = 1.0 - 1.0 / 2.25 + 0.3 / 2.25;
    assert!((all[0].at(0.0) - expected).abs() < 1e-6, "{} {expected}", all[0].at(0.0));
    // Of a plate without glass the way is 2 g tan(theta): f K_1(f) as between two plates, here with a thin glass of index near 1.
    let thin = panel(Top::IdealAr, &[1.0 + 1e-9], &[1.0]);
    let all = FlatReturn::all(&thin, &[1.0, 1e-9], ACCURACY).unwrap();
    for (fd, expected) in [(0.05, 0.768_495), (0.1, 0.500_191), (0.2, 0.182_669)] {
        let found = all[0].by_front(fd);
        assert!((found - expected).abs() < 1e-3, "{fd}: {found} {expected}");
    }
}

/// The table against the sum over directions of the spread of a panel, with dispersion and a coloured front.
#[test]
fn table_equals_the_sum_over_directions() {
    let index = [1.52, 1.5, 1.49];
    let front = [0.04, 0.3, 0.1];
    let glass = panel(Top::Fresnel(index.to_vec().into()), &index, &front);
    let lengths = [0.3, 0.7];
    let view = Cone::new(0.0, 0.0, 0.0, 1.0);
    let accuracy = Accuracy { digits: 12.0, most_per_mm: 6.0 };
    let spread = PanelSpread::new(&glass, &lengths, &view, &Source::Diffuse, accuracy);
    let spread = spread.unwrap();
    let all = FlatReturn::all(&glass, &lengths, accuracy).unwrap();
    assert_eq!(all.len(), 3);
    for f in [0.0, 0.03, 0.11, 0.4, 0.9, 1.7, 3.1, 5.9] {
        let expected = spread.returned(f);
        for one in &all {
            let (bin, found) = (one.bins[0], one.at(f));
            assert!(
                (found - expected[bin]).abs() < 2e-5 * front[bin],
                "{f}, {bin}: {found} {}",
                expected[bin]
            );
        }
    }
}
