//! s
mod recordings;
use frfid_estimate::LineDft;
use frfid_estimate::Transform;
use ndarray::Array2;
use recordings::*;
#[test]
fn clip() {
    let odd: Vec<usize> = (5..160).step_by(2).collect();
    let m = Multisine::new(2000.0, &odd, |_| 1.0, 1);
    let s = m.samples(2000);
    let dft = LineDft::new(2000, &(1..1000).collect::<Vec<_>>()).expect("d");
    for clip in [1.6, 1.3, 1.0] {
        for asym in [1.0, 0.8] {
            let t = clip * m.rms();
            let x = Array2::from_shape_vec(
                (1, 2000),
                s.iter().map(|x| x.clamp(-t, asym * t)).collect(),
            )
            .expect("x");
            let f = dft.transform("x", x.view()).expect("t");
            let p: Vec<f64> = std::iter::once(-300.0)
                .chain(f.iter().map(|v| 20.0 * v.norm().log10() - 60.0))
                .collect();
            let st = |l: &mut dyn Iterator<Item = usize>| {
                let mut v: Vec<f64> = l.map(|h| p[h]).collect();
                v.sort_by(f64::total_cmp);
                format!("{:.1} {:.1} {:.1}", v[0], v[v.len() / 2], v[v.len() - 1])
            };
            println!(
                "{clip} {asym}: E {} even {} out {} far {} low {:.1} {:.1}",
                st(&mut odd.iter().copied()),
                st(&mut (2..160).step_by(2)),
                st(&mut (161..200).step_by(2)),
                st(&mut (301..400).step_by(2)),
                p[1],
                p[3]
            );
        }
    }
}
