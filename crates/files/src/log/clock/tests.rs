//! Clocks of recorders as they are: even, rounded, late, in bursts, with losses and copies; and what
//! is no clock.

use frfid_signals::random::{normal, stream};

use super::*;

/// A series of one signal whose values are the true slots.
fn series(rows: &[(i64, usize)]) -> Series {
    Series {
        topic: "/t".into(),
        stamps_ns: rows.iter().map(|row| row.0).collect(),
        signals: vec![0],
        columns: vec![rows.iter().map(|row| row.1 as f64).collect()],
        ..Default::default()
    }
}

fn clock_of(rows: &[(i64, usize)], stated_s: Option<f64>) -> Result<(Clock, Series), Flaw> {
    let mut series = series(rows);
    let clock = Clock::of(&mut series, stated_s, &mut Vec::new())?;
    Ok((clock, series))
}

/// The clock of rows `(stamp, true slot)`, and how many of them are in another slot than the most.
fn misplaced(rows: &[(i64, usize)], stated_s: Option<f64>) -> (Clock, usize) {
    let (clock, series) = clock_of(rows, stated_s).expect("a clock");
    let rising = clock.slots.windows(2).all(|pair| pair[0] < pair[1]);
    assert!(rising && clock.slots[0] == 0, "{:?}", clock.slots);
    let slots = clock.slots.iter().zip(&series.columns[0]);
    let off: Vec<i64> = slots
        .map(|(slot, truth)| *truth as i64 - i64::from(*slot))
        .collect();
    let mut sorted = off.clone();
    sorted.sort_unstable();
    let usual = sorted[sorted.len() / 2];
    let misplaced = off.iter().filter(|off| **off != usual).count();
    (clock, misplaced)
}

fn found(rows: &[(i64, usize)]) -> String {
    let clock = clock_of(rows, None).map(|(clock, _)| Clock {
        slots: vec![],
        ..clock
    });
    clock.expect_err("refused").0
}

/// A number between 0 and 1.
fn uniform(seed: u64, k: usize) -> f64 {
    let mut hash =
        seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ (k as u64).wrapping_mul(0xD1B5_4A32_D192_ED03);
    hash = (hash ^ (hash >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    hash = (hash ^ (hash >> 32)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((hash ^ (hash >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// Rows of an even clock with some of them lost; stamps by `stamp`.
fn rows(
    n: usize,
    is_lost: impl Fn(usize) -> bool,
    stamp: impl Fn(usize) -> f64,
) -> Vec<(i64, usize)> {
    let kept = (0..n).filter(|k| !is_lost(*k));
    kept.map(|k| (stamp(k) as i64, k)).collect()
}

#[test]
fn an_even_clock_is_exact_to_the_last_bit() {
    let start = 1_400_000_000_000_000_000;
    let rows: Vec<_> = (0..50_000)
        .map(|k| (start + 400_000 * k as i64, k))
        .collect();
    let (clock, _) = clock_of(&rows, None).expect("even");
    assert_eq!(
        (
            clock.sample_time_s,
            clock.jitter,
            clock.n_slots(),
            clock.resolution_s
        ),
        (4e-4, 0.0, 50_000, None)
    );
}

#[test]
fn gaps_are_found_and_jitter_is_measured() {
    let is_lost = |k| (400..=410).contains(&k) || k == 700;
    let early = |k: usize| {
        1e6 * k as f64
            + if k.is_multiple_of(2) {
                50_001.0
            } else {
                -50_000.0
            }
    };
    let (clock, _) = clock_of(&rows(1000, is_lost, early), None).expect("5 % of jitter");
    assert!((clock.jitter - 0.05).abs() < 1e-3 && (clock.sample_time_s - 1e-3).abs() < 1e-6);
    assert_eq!(
        (clock.n_slots(), clock.slots.len(), clock.slots[400]),
        (1000, 988, 411)
    );
}

#[test]
fn stamps_in_whole_ms_of_800_hz_lose_nothing() {
    for seed in 0..20 {
        let offset = 1e6 * uniform(seed, 0);
        let stamp = |k: usize| ((1.25e6 * k as f64 + offset) / 1e6).floor() * 1e6;
        let (clock, misplaced) = misplaced(&rows(6000, |_| false, stamp), None);
        assert!((clock.sample_time_s - 1.25e-3).abs() < 1e-9, "{clock:?}");
        assert_eq!(
            (clock.n_slots(), misplaced, clock.resolution_s),
            (6000, 0, Some(1e-3))
        );
    }
}

#[test]
fn other_clocks_in_whole_ms_too() {
    for (step, n) in [
        (1.02e6, 3000),
        (1.1e6, 3000),
        (1.6e6, 3000),
        (1.75e6, 400),
        (2.5e6, 400),
        (3.2e6, 400),
        (10.0e6 / 3.0, 600),
    ] {
        let stamp = |k: usize| (step * k as f64 / 1e6).floor() * 1e6;
        let (clock, misplaced) = misplaced(&rows(n, |_| false, stamp), None);
        assert!(
            (clock.sample_time_s / step * 1e9 - 1.0).abs() < 2e-5,
            "{step} {}",
            clock.sample_time_s
        );
        assert_eq!((clock.n_slots(), misplaced), (n, 0), "{step}");
    }
}

#[test]
fn whole_ms_of_800_hz_with_losses() {
    for seed in 0..5 {
        for step in [1.25e6, 1.2e6, 1.6e6, 1.75e6] {
            let is_lost = |k| k > 0 && uniform(seed, k) < 0.07;
            let stamp = |k: usize| (step * k as f64 / 1e6 + uniform(seed, 1)).floor() * 1e6;
            let (clock, misplaced) = misplaced(&rows(6000, is_lost, stamp), None);
            assert!(
                (clock.sample_time_s / step * 1e9 - 1.0).abs() < 1e-5,
                "{seed} {step} {}",
                clock.sample_time_s
            );
            assert_eq!(misplaced, 0, "{seed} {step}");
        }
    }
}

/// The same stamps say that 1 kHz lost a fifth of its rows at random.
#[test]
fn losses_at_random_are_no_other_clock() {
    for seed in 0..20 {
        let share = [0.01, 0.07, 0.2, 0.4][seed as usize % 4];
        let is_lost = |k| k > 0 && uniform(seed, k) < share;
        let (clock, misplaced) = misplaced(&rows(5000, is_lost, |k| 1e6 * k as f64), None);
        assert_eq!((clock.sample_time_s, misplaced), (1e-3, 0));
    }
    let one = rows(400, |k| k == 100, |k| 1e6 * k as f64);
    assert_eq!(misplaced(&one, None).0.n_slots(), 400);
}

#[test]
fn several_rows_for_each_stamp_need_the_sample_time() {
    let stamp = |k: usize| (0.125 * k as f64).floor() * 1e6;
    let dense = rows(8000, |_| false, stamp);
    let (_, needed) = clock_of(&dense, None).expect_err("8 kHz in whole ms");
    assert!(needed.contains("sample_time_s"), "{needed}");
    let (clock, misplaced) = misplaced(&dense, Some(1.25e-4));
    assert_eq!(
        (clock.sample_time_s, clock.n_slots(), misplaced),
        (1.25e-4, 8000, 0)
    );
    let (found, _) =
        clock_of(&rows(800, |_| false, |k| 1e6 * k as f64), Some(1.25e-3)).expect_err("other");
    assert!(
        found.contains("1 ms") || found.contains("1.25 ms"),
        "{found}"
    );
}

#[test]
fn a_stated_sample_time_is_taken_to_its_last_digit() {
    let (clock, _) =
        clock_of(&rows(5000, |_| false, |k| 1.00004e6 * k as f64), Some(1e-3)).expect("40 ppm");
    assert_eq!(clock.sample_time_s, 1e-3);
    let found = clock_of(&rows(500, |_| false, |k| 1.01e6 * k as f64), Some(1e-3)).map(drop);
    assert!(found.expect_err("1 %").0.contains("1.01 ms"));
}

#[test]
fn rows_stamped_as_the_one_before_keep_their_places() {
    let late = |k: usize| k > 0 && uniform(4, k) < 0.02;
    let rows = rows(
        12_000,
        |_| false,
        |k| 1e6 * (k - usize::from(late(k))) as f64,
    );
    let (clock, misplaced) = misplaced(&rows, None);
    assert_eq!(
        (clock.n_slots(), misplaced, clock.sample_time_s),
        (12_000, 0, 1e-3)
    );
}

/// The recorder of UR: 7.5 % of a 2 ms grid missing, 40 rows there twice, two of them torn.
#[test]
fn copies_go_and_torn_rows_take_the_free_slot() {
    let mut rows = rows(1776, |k| k > 0 && uniform(9, k) < 0.075, |k| 2e6 * k as f64);
    for place in (10..1600).step_by(40) {
        rows.insert(place, rows[place]);
    }
    let before_gap = |rows: &[(i64, usize)], from: usize| {
        let gap = |k: &usize| rows[k + 1].1 == rows[*k].1 + 2;
        (from..).find(gap).expect("a gap")
    };
    for from in [301, 900] {
        let place = before_gap(&rows, from);
        rows.insert(place + 1, (rows[place].0, rows[place].1 + 1));
    }
    let (clock, misplaced) = misplaced(&rows, None);
    assert_eq!(
        (clock.sample_time_s, misplaced, clock.n_slots()),
        (2e-3, 0, 1776)
    );
    assert!(clock.contested.is_empty());
}

#[test]
fn a_torn_row_without_a_free_slot_costs_its_sample() {
    let mut rows = rows(2000, |k| k == 1000, |k| 2e6 * k as f64);
    rows.insert(500, (rows[499].0, 500));
    rows.insert(1500, (rows[1499].0, 1500));
    let (clock, misplaced) = misplaced(&rows, None);
    assert_eq!(
        (clock.slots.len(), misplaced, clock.contested),
        (1997, 0, vec![499, 1499])
    );
}

#[test]
fn bursts_of_late_messages_are_put_in_order() {
    for length in [1, 5, 30] {
        let stamp = |k: usize| {
            let (second, place) = (k - k % 100, k % 100);
            let is_late = (37 - length..37).contains(&place);
            let late = 1e6 * (second + 37) as f64 + 1e3 * place as f64;
            let on_time = 1e6 * k as f64 + 5e4 + 2e4 * uniform(3, k);
            if is_late { late } else { on_time }
        };
        let (clock, misplaced) = misplaced(&rows(5000, |_| false, stamp), None);
        assert_eq!((clock.n_slots(), misplaced), (5000, 0), "{length}");
        assert!(
            (clock.sample_time_s - 1e-3).abs() < 1e-9,
            "{}",
            clock.sample_time_s
        );
        assert_eq!(clock.n_out, 50 * length);
    }
}

#[test]
fn a_recording_that_begins_with_a_burst_begins_where_it_did() {
    let late = |k: usize| if k < 9 { 8.1 } else { k as f64 };
    let stamp = |k: usize| 1e6 * late(k) + 1e3 * k as f64;
    let (clock, misplaced) = misplaced(&rows(500, |_| false, stamp), None);
    assert_eq!((misplaced, clock.n_slots()), (0, 500));
}

#[test]
fn the_longest_delays_that_are_taken() {
    for seed in 0..10 {
        let delay = |k: usize| -0.3 * (1.0 - uniform(seed, 3 * k)).ln();
        let is_lost = |k: usize| k > 0 && (k % 500) < 12;
        let mut last = 0.0_f64;
        let mut stamps = Vec::new();
        for k in 0..20_000 {
            last = last.max(1e6 * (k as f64 + delay(k)));
            stamps.push(last);
        }
        let (clock, misplaced) = misplaced(&rows(20_000, is_lost, |k| stamps[k]), None);
        assert!(
            (clock.sample_time_s - 1e-3).abs() < 2e-9,
            "{}",
            clock.sample_time_s
        );
        assert!(misplaced <= 20, "{misplaced}");
    }
}

/// A clock that is slewed by 200 ppm for a while moves no sample.
#[test]
fn a_slow_drift_makes_no_gap() {
    let drift = |k: usize| 0.3 * (k as f64 / 3000.0).sin();
    let stamp = |k: usize| 1e6 * (k as f64 + drift(k)) + 3e4 * uniform(1, k);
    let (clock, misplaced) = misplaced(&rows(20_000, |k| k == 77, stamp), None);
    assert_eq!((clock.n_slots(), misplaced), (20_000, 0));
}

#[test]
fn a_message_out_of_order_fills_its_gap() {
    let mut swapped = rows(400, |_| false, |k| 1e6 * k as f64);
    swapped.swap(7, 8);
    let mut warnings = Vec::new();
    let mut sorted = series(&swapped);
    let clock = Clock::of(&mut sorted, None, &mut warnings).expect("sorted");
    assert_eq!(
        (clock.jitter, clock.n_slots(), sorted.columns[0][7]),
        (0.0, 400, 7.0)
    );
    assert!(
        warnings[0].contains("1 messages out of order"),
        "{warnings:?}"
    );
}

#[test]
fn a_clock_that_was_set_back_is_refused_with_its_place() {
    for back in [5.0, 5.5] {
        let stamp = |k: usize| 1e6 * (k as f64 - if k < 3000 { 0.0 } else { back });
        let found = found(&rows(6000, |_| false, stamp));
        assert!(
            found.contains("that of sample 3001, ") && found.contains("2.999 s"),
            "{back}: {found}"
        );
    }
    let restarted = rows(
        6000,
        |_| false,
        |k| 1e6 * (k % 3000) as f64 + 3.0 * (k / 3000) as f64,
    );
    assert!(found(&restarted).contains("2999 stamps before their predecessor"));
}

#[test]
fn a_stamp_hours_off_is_named_before_memory_is_taken() {
    for place in [1499, 2999] {
        let hours = |k: usize| if k == place { 39_600e9 } else { 0.0 };
        let rows = rows(3000, |_| false, |k| 1e6 * k as f64 + hours(k));
        let found = found(&rows);
        assert!(
            found.contains("a gap of 11 h") || found.contains("a gap of 10.999"),
            "{found}"
        );
    }
    let zero = rows(
        3000,
        |_| false,
        |k| {
            if k == 77 {
                0.0
            } else {
                1.7e18 + 1e6 * k as f64
            }
        },
    );
    assert!(found(&zero).contains("a gap of"), "{}", found(&zero));
}

#[test]
fn mixed_recordings_are_refused() {
    let even = rows(8000, |_| false, |k| 1e6 * k as f64);
    let mut twice = even.clone();
    let others = even
        .iter()
        .filter(|row| row.1 % 50 == 7)
        .map(|row| (row.0, 99_999));
    twice.extend(others);
    twice.sort_by_key(|row| row.0);
    assert!(
        found(&twice).contains("there twice with different values"),
        "{}",
        found(&twice)
    );
    let mut between = even.clone();
    between.extend(
        even.iter()
            .filter(|row| row.1 % 50 == 7)
            .map(|row| (row.0 + 300_001, 0)),
    );
    between.sort_by_key(|row| row.0);
    assert!(
        found(&between).contains("no even clock explains"),
        "{}",
        found(&between)
    );
    let mut both = even.clone();
    both.extend(even.iter().map(|row| (row.0, 99_999)));
    both.sort_by_key(|row| row.0);
    assert!(
        found(&both).contains("stamp of the one before"),
        "{}",
        found(&both)
    );
}

#[test]
fn what_is_no_clock_is_refused() {
    let wild = rows(
        100,
        |_| false,
        |k| 1e6 * k as f64 + 3e5 * (2.0 * (k % 2) as f64 - 1.0) + 1e6,
    );
    for (rows, told) in [
        (&wild[..], "need a span of 60 % of a sample"),
        (&[(5, 0)], "1 samples"),
        (&[], "0 samples"),
        (&[(7, 0), (7, 1), (7, 2)], "all of one stamp"),
    ] {
        assert!(found(rows).contains(told), "{}", found(rows));
    }
    let poisson = (0..2000).scan(0.0, |time, k| {
        *time -= 1e6 * (1.0 - uniform(2, k)).ln();
        Some((*time as i64, k))
    });
    assert!(found(&poisson.collect::<Vec<_>>()).contains("an even clock"));
}

/// Random losses, Gaussian jitter and single late stamps, over many seeds: every row in its slot.
#[test]
fn random_recordings_are_put_on_their_slots() {
    for seed in 0..60 {
        let mut random = stream(seed, "jitter", &[]);
        let (loss, jitter) = (0.3 * uniform(seed, 1), 0.1 * uniform(seed, 2));
        let step = 1e5 + 1e7 * uniform(seed, 3);
        let mut noise: Vec<f64> = (0..3000).map(|_| jitter * normal(&mut random)).collect();
        (10..2990).step_by(97).for_each(|k| noise[k] += 0.45);
        let is_lost = |k: usize| k % 97 > 15 && uniform(seed, 10 + k) < loss;
        let stamp = |k: usize| 1e15 + step * (k as f64 + noise[k].clamp(-0.45, 0.49));
        let (clock, misplaced) = misplaced(&rows(3000, is_lost, stamp), None);
        assert!(
            (clock.sample_time_s / step * 1e9 - 1.0).abs() < 1e-5,
            "{seed}"
        );
        assert_eq!(misplaced, 0, "{seed}");
    }
}

proptest::proptest! {
    #[test]
    fn any_stamps(stamps in proptest::collection::vec(proptest::num::i64::ANY, 0..20), small in proptest::collection::vec(0..40_i64, 0..40), stated in proptest::option::of(1e-9..1e-7)) {
        for stamps in [stamps, small] {
            let rows: Vec<_> = stamps.into_iter().enumerate().map(|(k, stamp)| (stamp, k)).collect();
            if let Ok((clock, series)) = clock_of(&rows, stated) {
                assert!(clock.slots.windows(2).all(|pair| pair[0] < pair[1]));
                assert_eq!(clock.slots.len(), series.stamps_ns.len());
                assert!(clock.n_slots() <= 8 * rows.len() + 8192);
            }
        }
    }
}
