//! Gap between the levels of excited lines and those of the others, among neighbouring lines.

use std::iter::zip;
use std::ops::Range;

use frfid_signals::median;

/// Smallest gap between the weakest excited line and the strongest other one (12 dB).
pub(super) const GAP_DB: f64 = 12.0;
/// Excited lines are no weaker than the strongest by more (60 dB): what a converter's steps leave is
/// anywhere, and smooth by chance.
pub(super) const RANGE_DB: f64 = 60.0;
/// Levels are smooth if second differences, over those of independent numbers of the same spread,
/// are below this; random lines have 5.6 dB.
const SMOOTH_DB: f64 = 2.5;
/// Fewer lines are smooth by chance.
pub(super) const FEW: usize = 6;
/// So few lines tell a power law.
const FEWEST: usize = 4;
/// In a steep spectrum so many of the lowest lines lie far apart.
const LOWEST: usize = 4;

/// The level in dB from which on those of the rising `lines` are excited, if there is a gap below
/// it; index 0 is line 1.
pub(super) fn least_excited(level_db: &[f64], lines: &[usize]) -> Option<f64> {
    let (lowest, others) = lines.split_at(lines.partition_point(|&line| line < LOWEST));
    match gap(level_db, others) {
        Some(least) => least_with_lowest(level_db, lowest, others, least),
        None => gap(level_db, lines),
    }
}

/// The least level of the excited lines, those among the lowest that are less than a gap below the
/// nearest of the others.
fn least_with_lowest(
    level_db: &[f64],
    lowest: &[usize],
    others: &[usize],
    least: f64,
) -> Option<f64> {
    let nearest = levels(level_db, others).find(|&level| level >= least)?;
    let lowest = levels(level_db, lowest).filter(|&level| level >= nearest - GAP_DB);
    Some(lowest.fold(least, f64::min))
}

fn levels(level_db: &[f64], lines: &[usize]) -> impl Iterator<Item = f64> {
    lines.iter().map(|&line| level_db[line])
}

/// The lowest level above the gap: the first one of 12 dB, or that below a step.
fn gap(level_db: &[f64], lines: &[usize]) -> Option<f64> {
    if is_power_law(level_db, lines) {
        return None;
    }
    let falling = falling(level_db, lines);
    let end = gap_start(level_db, &falling)?;
    levels(level_db, &falling[..end]).last()
}

/// The lines, the strongest first.
fn falling(level_db: &[f64], lines: &[usize]) -> Vec<usize> {
    let mut falling = lines.to_vec();
    falling.sort_by(|&a, &b| level_db[b].total_cmp(&level_db[a]));
    falling
}

/// How many lines lie above the gap, and others below.
fn gap_start(level_db: &[f64], falling: &[usize]) -> Option<usize> {
    let step = below_steps(level_db, falling);
    let start = step.or_else(|| first_gap(level_db, falling));
    start.filter(|&start| start < falling.len())
}

/// How many lines lie above the first gap, unless that are many and few lie below.
fn first_gap(level_db: &[f64], falling: &[usize]) -> Option<usize> {
    let n_above = groups(level_db, falling, GAP_DB).next()?.end;
    let is_gap = falling.len() - n_above >= FEW || n_above < FEW;
    is_gap.then_some(n_above)
}

/// Where the lines end that are smooth, or beside smooth ones that are stronger (a step of the
/// excitation) as opposed to between them; half a gap does if the others lie a whole one below in
/// the middle.
fn below_steps(level_db: &[f64], falling: &[usize]) -> Option<usize> {
    let end = last_step(level_db, falling)?;
    let (above, below) = falling.split_at(end);
    is_apart(level_db, above, below).then_some(end)
}

fn last_step(level_db: &[f64], falling: &[usize]) -> Option<usize> {
    let strongest = falling.first().map_or(0.0, |&line| level_db[line]);
    let is_step = |group: &Range<usize>| {
        let is_near = level_db[falling[group.start]] >= strongest - RANGE_DB;
        let (before, group) = (&falling[..group.start], &falling[group.clone()]);
        is_near && is_smooth(level_db, group) && is_beside(before, group)
    };
    let steps = groups(level_db, falling, GAP_DB / 2.0).filter(is_step);
    steps.last().map(|step| step.end)
}

/// Whether the middle of the lines below, if there are any, is a whole gap under that of the others.
fn is_apart(level_db: &[f64], above: &[usize], below: &[usize]) -> bool {
    let above = middle(level_db, above);
    let is_under = |below| above.is_some_and(|above| above - below >= GAP_DB);
    middle(level_db, below).is_none_or(is_under)
}

/// Groups of falling lines, each `gap` above the next.
fn groups(level_db: &[f64], falling: &[usize], gap: f64) -> impl Iterator<Item = Range<usize>> {
    let is_joined = move |a: &usize, b: &usize| level_db[*a] - level_db[*b] < gap;
    falling.chunk_by(is_joined).scan(0, |end, group| {
        *end += group.len();
        Some(*end - group.len()..*end)
    })
}

/// Whether levels change by so many dB per octave, and no line is off.
fn is_power_law(level_db: &[f64], lines: &[usize]) -> bool {
    let octaves = lines.iter().map(|&line| ((line + 1) as f64).ln());
    let x = centred(octaves.collect());
    let y = centred(levels(level_db, lines).collect());
    lines.len() >= FEWEST && deviation(&x, &y) <= SMOOTH_DB
}

/// What is left without the mean.
fn centred(mut values: Vec<f64>) -> Vec<f64> {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter_mut().for_each(|value| *value -= mean);
    values
}

/// Standard deviation of centred `y` from the straight line over `x` by least squares.
fn deviation(x: &[f64], y: &[f64]) -> f64 {
    let slope = dot(x, y) / dot(x, x);
    let off = zip(x, y).map(|(x, y)| (y - slope * x).powi(2));
    (off.sum::<f64>() / (x.len() as f64 - 2.0)).sqrt()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    zip(a, b).map(|(a, b)| a * b).sum()
}

fn is_smooth(level_db: &[f64], lines: &[usize]) -> bool {
    let levels: Vec<f64> = levels(level_db, &rising(lines)).collect();
    lines.len() >= FEW && (mean_bend_squared(&levels) / 6.0).sqrt() <= SMOOTH_DB
}

fn rising(lines: &[usize]) -> Vec<usize> {
    let mut rising = lines.to_vec();
    rising.sort_unstable();
    rising
}

fn mean_bend_squared(levels: &[f64]) -> f64 {
    let bends = levels.windows(3).map(bend_squared);
    bends.sum::<f64>() / levels.len().saturating_sub(2) as f64
}

/// Second difference of three levels, squared.
fn bend_squared(l: &[f64]) -> f64 {
    (l[0] - 2.0 * l[1] + l[2]).powi(2)
}

/// Whether no more than one in ten of the lines lies between the others.
fn is_beside(others: &[usize], lines: &[usize]) -> bool {
    let extent = extent(others).unwrap_or_default();
    let between = lines.iter().filter(|line| extent.contains(line));
    10 * between.count() <= lines.len()
}

/// From the first line to the last.
fn extent(lines: &[usize]) -> Option<Range<usize>> {
    Some(*lines.iter().min()?..*lines.iter().max()?)
}

/// Median level, none of no lines.
pub(super) fn middle(level_db: &[f64], lines: &[usize]) -> Option<f64> {
    median(levels(level_db, lines).collect())
}
