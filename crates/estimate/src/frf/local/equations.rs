//! Equations of a window, each with its weight: signals times powers of the places of their lines.
//!
//! Products of such columns are moments of the signals, `sum_k w_k^2 x_k^n conj(a_k) b_k`, so that the normal equations
//! of all answers are made of few sums. What is lost by squaring the condition is found by solving once more for what
//! the unknowns do not explain (A. Bjorck, Stability analysis of the method of seminormal equations for linear least
//! squares problems, Linear Algebra Appl. 88/89 (1987) 31-48).

use std::iter::zip;

use num_complex::Complex64;

use crate::frf::local::column::{Column, Reals};
use crate::frf::local::moments::{Lines, Moments};
use crate::frf::local::normal_equations::Factors;
use crate::frf::local::window::{N_TERMS, Window};

/// What the equations of all answers have in common.
pub(super) struct Equations<'w> {
    pub(super) window: &'w Window,
    /// Order of the denominator.
    n_poles: usize,
    pub(super) lines: Lines,
    /// Of the columns of drives, then transients.
    common: Factors,
}

/// The equations of one answer: behind the common columns those of its denominator.
pub(super) struct System<'e> {
    equations: &'e Equations<'e>,
    answer: &'e Column,
    factors: Factors,
    right: Vec<Complex64>,
}

impl<'w> Equations<'w> {
    /// Without weights.
    pub(super) fn even(window: &'w Window) -> Self {
        let places = Reals::of(&window.places);
        let weights = places.map(|_| 1.0);
        Self::of(window, Lines { places, weights })
    }

    fn of(window: &'w Window, lines: Lines) -> Self {
        Self {
            n_poles: window.n_poles,
            common: common(window, &lines),
            window,
            lines,
        }
    }

    /// The same with other squares of the weights.
    pub(super) fn weighted(&self, weights: Reals) -> Self {
        let places = self.lines.places.clone();
        Self::of(self.window, Lines { places, weights })
    }

    pub(super) fn without_poles(self) -> Self {
        Self { n_poles: 0, ..self }
    }

    /// Moments of a signal with those of the common columns, and with the answer.
    fn moments(&self, signal: &Column, answer: &Column) -> (Vec<Moments>, Moments) {
        let common = self.window.signals();
        let common = common.map(|common| self.lines.moments(signal, common));
        (common.collect(), self.lines.moments(signal, answer))
    }

    /// The right side of the normal equations of a signal, from its moments.
    fn right(&self, with_common: &[Moments], with_own: &Moments) -> Vec<Complex64> {
        let own = with_own[1..=self.n_poles].iter().map(|value| -value);
        let all = products(with_common, 0).chain(own);
        all.map(|value| value.conj()).collect()
    }

    /// The denominator on every line, from the last unknowns.
    pub(super) fn denominator(&self, unknowns: &[Complex64]) -> Column {
        let mut terms = self.own(unknowns);
        terms[0] = Complex64::ONE;
        let mut denominator = self.lines.zeros();
        for piece in &self.window.transients {
            denominator.add_polynomial(terms, &self.lines.places, piece);
        }
        denominator
    }

    /// The unknowns of the denominator, by powers of the places.
    fn own(&self, unknowns: &[Complex64]) -> [Complex64; N_TERMS] {
        let mut own = [Complex64::ZERO; N_TERMS];
        own[1..=self.n_poles].copy_from_slice(&unknowns[unknowns.len() - self.n_poles..]);
        own
    }
}

impl<'e> System<'e> {
    pub(super) fn of(equations: &'e Equations, answer: &'e Column) -> Self {
        let n_poles = equations.n_poles;
        let (with_common, with_own) = equations.moments(answer, answer);
        let mut factors = equations.common.and(n_poles);
        for power in 1..=n_poles {
            let common = products(&with_common, power).map(|value| -value);
            let own = &with_own[power + 1..=2 * power];
            factors.push(common.chain(own.iter().copied()));
        }
        Self {
            right: equations.right(&with_common, &with_own),
            equations,
            answer,
            factors,
        }
    }

    /// The denominator on every line as rounding leaves it, which is enough for weights.
    pub(super) fn denominator(self) -> Column {
        let unknowns = self.factors.solve_last(self.equations.n_poles, self.right);
        self.equations.denominator(&unknowns)
    }

    /// The unknowns, and what they leave of the answer.
    pub(super) fn solved(&self) -> (Vec<Complex64>, Column) {
        let mut unknowns = self.factors.solve(self.right.clone());
        let mut left = self.answer.less(&self.explained(&unknowns));
        let (with_common, with_own) = self.equations.moments(&left, self.answer);
        let right = self.equations.right(&with_common, &with_own);
        let lost = self.factors.solve(right);
        left = left.less(&self.explained(&lost));
        zip(&mut unknowns, lost).for_each(|(unknown, lost)| *unknown += lost);
        (unknowns, left)
    }

    /// What an unknown is of the right side without weights, `sum_k w_k^2 conj(values_k) y_k`.
    pub(super) fn functional(&self, unknown: usize) -> Column {
        self.explained(&self.factors.inverse_column(unknown))
    }

    /// What unknowns make of the columns.
    fn explained(&self, unknowns: &[Complex64]) -> Column {
        let Equations { window, lines, .. } = self.equations;
        let mut explained = lines.zeros();
        for (terms, signal) in zip(unknowns.as_chunks().0, window.signals()) {
            explained.add_polynomial(*terms, &lines.places, signal);
        }
        let own = self.equations.own(unknowns).map(|unknown| -unknown);
        explained.add_polynomial(own, &lines.places, self.answer);
        explained
    }
}

/// The factors of the columns that all answers have in common.
fn common(window: &Window, lines: &Lines) -> Factors {
    let signals: Vec<&Column> = window.signals().collect();
    let mut factors = Factors::with_capacity(N_TERMS * signals.len());
    for (last, signal) in signals.iter().enumerate() {
        let with = signals[..=last].iter();
        let with: Vec<Moments> = with.map(|other| lines.moments(signal, other)).collect();
        for power in 0..N_TERMS {
            let own = &with[last][power..=2 * power];
            factors.push(products(&with[..last], power).chain(own.iter().copied()));
        }
    }
    factors
}

/// Products of a column, a signal times a power of the places, with those of other signals, from their moments.
fn products(with: &[Moments], power: usize) -> impl Iterator<Item = Complex64> {
    let terms = with
        .iter()
        .flat_map(move |with| &with[power..power + N_TERMS]);
    terms.copied()
}
