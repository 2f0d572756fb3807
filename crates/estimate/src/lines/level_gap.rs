//! Gap between the levels of excited lines and those of the others, among neighbouring lines.

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
    let n_lowest = lines.partition_point(|&line| line < LOWEST);
    let (lowest, others) = lines.split_at(n_lowest);
    let Some(least) = gap(level_db, others) else {
        return gap(level_db, lines);
    };
    let nearest = others.iter().find(|&&line| level_db[line] >= least)?;
    let reach = level_db[*nearest] - GAP_DB;
    let levels = lowest.iter().map(|&line| level_db[line]);
    Some(levels.filter(|&level| level >= reach).fold(least, f64::min))
}

/// The lowest level above the gap: the first one of 12 dB, or that below a step.
fn gap(level_db: &[f64], lines: &[usize]) -> Option<f64> {
    if is_power_law(level_db, lines) {
        return None;
    }
    let mut falling = lines.to_vec();
    falling.sort_by(|&a, &b| level_db[b].total_cmp(&level_db[a]));
    let step = below_steps(level_db, &falling);
    let end = step.or_else(|| {
        groups(level_db, &falling, GAP_DB)
            .next()
            .map(|(_, end)| end)
    })?;
    let (above, below) = falling.split_at(end);
    let is_gap = below.len() >= FEW || above.len() < FEW || step.is_some();
    (is_gap && !below.is_empty()).then(|| above.last().map(|&line| level_db[line]))?
}

/// Where the lines end that are smooth, or beside smooth ones that are stronger (a step of the
/// excitation) as opposed to between them; half a gap does if the others lie a whole one below in
/// the middle.
fn below_steps(level_db: &[f64], falling: &[usize]) -> Option<usize> {
    let strongest = falling.first().map_or(0.0, |&line| level_db[line]);
    let is_step = |&(start, end): &(usize, usize)| {
        let (before, group) = (&falling[..start], &falling[start..end]);
        let is_near = level_db[falling[start]] >= strongest - RANGE_DB;
        is_near && is_smooth(level_db, group) && is_beside(before, group)
    };
    let steps = groups(level_db, falling, GAP_DB / 2.0).filter(is_step);
    let (_, end) = steps.last()?;
    let (above, below) = falling.split_at(end);
    let is_apart = |below| middle(level_db, above).is_some_and(|above| above - below >= GAP_DB);
    middle(level_db, below).is_none_or(is_apart).then_some(end)
}

/// Starts and ends of groups of falling lines, each `gap` above the next.
fn groups(level_db: &[f64], falling: &[usize], gap: f64) -> impl Iterator<Item = (usize, usize)> {
    let is_joined = move |a: &usize, b: &usize| level_db[*a] - level_db[*b] < gap;
    falling.chunk_by(is_joined).scan(0, |end, group| {
        *end += group.len();
        Some((*end - group.len(), *end))
    })
}

/// Whether levels change by so many dB per octave, and no line is off.
fn is_power_law(level_db: &[f64], lines: &[usize]) -> bool {
    let points = || {
        lines
            .iter()
            .map(|&line| (((line + 1) as f64).ln(), level_db[line]))
    };
    let n = lines.len() as f64;
    let mean_x = points().map(|(x, _)| x).sum::<f64>() / n;
    let mean_y = points().map(|(_, y)| y).sum::<f64>() / n;
    let xx: f64 = points().map(|(x, _)| (x - mean_x).powi(2)).sum();
    let xy: f64 = points().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    let off = points().map(|(x, y)| (y - mean_y - xy / xx * (x - mean_x)).powi(2));
    lines.len() >= FEWEST && (off.sum::<f64>() / (n - 2.0)).sqrt() <= SMOOTH_DB
}

fn is_smooth(level_db: &[f64], lines: &[usize]) -> bool {
    let mut rising = lines.to_vec();
    rising.sort_unstable();
    let bend = |l: &[usize]| level_db[l[0]] - 2.0 * level_db[l[1]] + level_db[l[2]];
    let bends = rising.windows(3).map(|three| bend(three).powi(2));
    let mean = bends.sum::<f64>() / lines.len().saturating_sub(2) as f64;
    lines.len() >= FEW && (mean / 6.0).sqrt() <= SMOOTH_DB
}

/// Whether no more than one in ten of the lines lies between the others.
fn is_beside(others: &[usize], lines: &[usize]) -> bool {
    let (Some(&first), Some(&last)) = (others.iter().min(), others.iter().max()) else {
        return true;
    };
    let is_between = |line: &&usize| (first..last).contains(*line);
    10 * lines.iter().filter(is_between).count() <= lines.len()
}

/// Median level, none of no lines.
pub(super) fn middle(level_db: &[f64], lines: &[usize]) -> Option<f64> {
    let mut levels: Vec<f64> = lines.iter().map(|&line| level_db[line]).collect();
    levels.sort_unstable_by(f64::total_cmp);
    levels.get(levels.len() / 2).copied()
}
