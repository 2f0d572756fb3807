//! s
use frfid_estimate::{count_transient_periods, find_lines, find_repetition};
use ndarray::{Array2, Array3, Axis, s};
fn load(name: &str) -> Array2<f64> {
    let b = std::fs::read(format!("/tmp/runs_raw/{name}")).expect(name);
    let u = |i: usize| u64::from_le_bytes(b[8 * i..8 * i + 8].try_into().expect("8"));
    let v: Vec<f64> = (2..b.len() / 8).map(|i| f64::from_bits(u(i))).collect();
    Array2::from_shape_vec((u(0) as usize, u(1) as usize), v).expect("shape")
}
fn short(l: &[usize]) -> String {
    format!(
        "{} lines {:?}..{:?}",
        l.len(),
        &l[..l.len().min(4)],
        &l[l.len().saturating_sub(3)..]
    )
}
fn show(name: &str, x: &Array2<f64>) {
    let t = std::time::Instant::now();
    match find_repetition(x.view(), None) {
        Ok(f) => {
            println!(
                "{name}: {} runs {:?} rests {:?} residual {:.1e} ({:?})",
                f.period,
                f.runs,
                f.rests,
                f.residual,
                t.elapsed()
            );
            for r in &f.runs {
                match find_lines(x.slice(s![.., r.clone()]), f.period) {
                    Ok(l) => println!("    {}", short(&l)),
                    Err(e) => println!("    {e}"),
                }
            }
        }
        Err(e) => println!("{name}: {e} ({:?})", t.elapsed()),
    }
}
#[test]
fn records() {
    let mut names: Vec<String> = std::fs::read_dir("/tmp/runs_raw")
        .expect("dir")
        .map(|e| e.expect("e").file_name().into_string().expect("s"))
        .collect();
    names.sort();
    for n in &names {
        let x = load(n);
        if n.starts_with("swept") {
            let flat =
                Array2::from_shape_vec((1, x.len()), x.iter().copied().collect()).expect("f");
            show(n, &flat);
        } else {
            show(n, &x);
        }
    }
    let x = load("motor.1");
    println!(
        "motor whole: {:?}",
        find_lines(x.view(), 2500.0).map(|l| short(&l))
    );
    for n in ["data_emps.qg", "data_emps.vir"] {
        println!("{n}: {:?}", find_lines(load(n).view(), 6240.0));
    }
    for l in [1, 3, 7] {
        let x = load(&format!("F16Data_FullMSine_Level{l}.voltage"));
        println!(
            "f16 {l} {:?}",
            find_lines(x.view(), 8192.0).map(|l| short(&l))
        );
    }
    let u = load("snls80mv.u");
    let odd: Vec<usize> = (1..=2683).step_by(2).collect();
    for p in 0..10 {
        let a = 40_985 + 8692 * p;
        let x = u.slice(s![.., a..a + 8192]);
        match find_lines(x, 8192.0) {
            Ok(mut f) => {
                f.retain(|&l| l != 2014);
                println!("silverbox {p}: {} {}", f == odd, short(&f));
                if f != odd {
                    println!(
                        "   extra {:?} missing {:?}",
                        f.iter()
                            .filter(|l| !odd.contains(l))
                            .take(10)
                            .collect::<Vec<_>>(),
                        odd.iter()
                            .filter(|l| !f.contains(l))
                            .take(10)
                            .collect::<Vec<_>>()
                    );
                }
            }
            Err(e) => println!("silverbox {p} {e}"),
        }
    }
    for n in ["motor.1", "motor.2", "motor.3"] {
        let x = load(n);
        let f = find_repetition(x.view(), None).expect("p");
        let r = f.runs[0].clone();
        let k = r.len() / 2500;
        let p = Array3::from_shape_fn((k, 1, 2500), |(q, _, j)| x[[0, r.start + q * 2500 + j]]);
        let l: Vec<usize> = (11..=250).collect();
        println!(
            "{n} {r:?} transient {:?}",
            count_transient_periods(p.view(), &l)
        );
        let _ = Axis(0);
    }
}
#[test]
fn silver() {
    use frfid_estimate::{LineDft, Transform};
    let u = load("snls80mv.u");
    for p in [0, 6] {
        let a = 40_985 + 8692 * p;
        let dft = LineDft::new(8192, &(1..4096).collect::<Vec<_>>()).expect("d");
        let f = dft.transform("u", u.slice(s![.., a..a + 8192])).expect("t");
        let l = |h: usize| 20.0 * f[[0, h - 1]].norm().log10();
        println!(
            "{:?}",
            (1995..2020)
                .map(|h| format!("{h}:{:.1}", l(h)))
                .collect::<Vec<_>>()
        );
        println!(
            "{:?}",
            (3345..3365)
                .map(|h| format!("{h}:{:.1}", l(h)))
                .collect::<Vec<_>>()
        );
    }
    let x = load("F16Data_FullMSine_Level7.voltage");
    let dft = LineDft::new(8192, &(1..4096).collect::<Vec<_>>()).expect("d");
    let f = dft.transform("u", x.slice(s![.., 8192..16384])).expect("t");
    let l = |h: usize| 20.0 * f[[0, h - 1]].norm().log10();
    println!(
        "{:?}",
        (300..312)
            .chain(400..410)
            .map(|h| format!("{h}:{:.1}", l(h)))
            .collect::<Vec<_>>()
    );
}

#[test]
fn emps() {
    show("qg", &load("data_emps.qg"));
}
