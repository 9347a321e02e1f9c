//! Rigid motions of a plate that only springs and contact points hold, apart from everything else.
//!
//! Where what holds is soft beside the plate, eliminating K finds them to few digits, and adding them as doubles strains
//! the plate by their rounding. Here they follow from the three resultants alone, and are added exactly.

use super::problem::ContactProblem;
use super::refinement::Step;
use super::solution::ContactSolution;
use crate::double_double::DoubleDouble;

/// A pivot below this part of the largest is rounding of the lever arms: nothing holds that motion.
const HELD: f64 = 1e-22;

/// What the three rigid motions w, w + x and w + y about a centre, over a size, do at springs and contact points.
pub(super) struct Floating {
    pub(super) centre: [f64; 2],
    size: f64,
    nodal: [Vec<f64>; 3],
    springs: Vec<[f64; 3]>,
    points: Vec<[f64; 3]>,
}

impl Floating {
    /// Nothing where a dof is held.
    pub(super) fn of(problem: &ContactProblem) -> Option<Self> {
        if problem.held.contains(&true) {
            return None;
        }
        let plate = &problem.plate;
        let count = plate.node_count();
        let over = |k: usize, choose: fn(f64, f64) -> f64, start: f64| {
            (0..count).map(|node| plate.point(node)[k]).fold(start, choose)
        };
        let least = [over(0, f64::min, f64::INFINITY), over(1, f64::min, f64::INFINITY)];
        let most = [over(0, f64::max, f64::NEG_INFINITY), over(1, f64::max, f64::NEG_INFINITY)];
        let centre = [0.5 * (least[0] + most[0]), 0.5 * (least[1] + most[1])];
        let size = f64::max(most[0] - least[0], most[1] - least[1]);
        let motion = |k: usize| -> Vec<f64> {
            let of_node = |node: usize| {
                let [x, y] = plate.point(node);
                let [c, s] = plate.frame(node).unwrap_or([1.0, 0.0]);
                let arm = [(x - centre[0]) / size, (y - centre[1]) / size];
                [[1.0, 0.0, 0.0], [arm[0], c / size, -s / size], [arm[1], s / size, c / size]][k]
            };
            (0..count).flat_map(of_node).collect()
        };
        let nodal = [motion(0), motion(1), motion(2)];
        let springs = (0..problem.springs.rows.len())
            .map(|row| [0, 1, 2].map(|k| problem.springs.rows.dot(plate, row, &nodal[k])))
            .collect();
        let points = (0..problem.constraints.rows.len())
            .map(|row| [0, 1, 2].map(|k| problem.constraints.rows.dot(plate, row, &nodal[k])))
            .collect();
        Some(Self { centre, size, nodal, springs, points })
    }

    /// The rigid motion (deflection and slopes at the centre) that balances a step's resultants by springs and closed
    /// points alone, and the increments of reaction that go with it.
    pub(super) fn response(
        &self,
        problem: &ContactProblem,
        step: &Step,
        solution: &ContactSolution,
    ) -> ([f64; 3], Vec<f64>) {
        let compliance = &problem.base.condensed.compliance;
        let mut matrix = [[DoubleDouble::default(); 3]; 3];
        let mut right = [0, 1, 2].map(|k| {
            let mut sum = DoubleDouble::default();
            self.nodal[k].iter().zip(&step.imbalance).for_each(|(u, f)| sum.add_product(*u, *f));
            sum
        });
        let mut hold = |arm: &[f64; 3], stiffness: f64, remaining: f64| {
            let root = stiffness.sqrt();
            let scaled = arm.map(|a| root * a);
            for j in 0..3 {
                for k in 0..3 {
                    matrix[j][k].add_product(scaled[j], scaled[k]);
                }
                right[j].add_product(scaled[j], root * remaining);
            }
        };
        for (arm, &stiffness) in self.springs.iter().zip(&problem.springs.stiffness) {
            hold(arm, stiffness, 0.0);
        }
        let acting = |i: usize| solution.closed[i] && compliance[i] > 0.0;
        for i in (0..self.points.len()).filter(|&i| acting(i)) {
            hold(&self.points[i], 1.0 / compliance[i], step.remaining[i]);
        }
        let [w, sx, sy] = solved(matrix, right);
        let moved = |arm: &[f64; 3]| arm[0] * w + arm[1] * sx + arm[2] * sy;
        let push = |i: usize| match acting(i) {
            true => (moved(&self.points[i]) - step.remaining[i]) / compliance[i],
            false => 0.0,
        };
        ([w, sx / self.size, sy / self.size], (0..self.points.len()).map(push).collect())
    }
}

/// Elimination with complete pivoting; unknowns that nothing holds are zero.
fn solved(mut matrix: [[DoubleDouble; 3]; 3], mut right: [DoubleDouble; 3]) -> [f64; 3] {
    let mut order = Vec::new();
    let mut largest = 0.0_f64;
    while order.len() < 3 {
        let left = (0..3).filter(|i| !order.contains(i));
        let Some(pivot) = left.max_by(|&a, &b| matrix[a][a].hi.total_cmp(&matrix[b][b].hi)) else { break };
        largest = largest.max(matrix[pivot][pivot].hi);
        if matrix[pivot][pivot].hi <= HELD * largest {
            break;
        }
        order.push(pivot);
        for row in (0..3).filter(|i| !order.contains(i)) {
            let factor = quotient(matrix[row][pivot], matrix[pivot][pivot]);
            for column in 0..3 {
                matrix[row][column] = matrix[row][column] - factor.times_sum(matrix[pivot][column]);
            }
            right[row] = right[row] - factor.times_sum(right[pivot]);
        }
    }
    let mut unknown = [0.0; 3];
    for &row in order.iter().rev() {
        let known: f64 = (0..3).filter(|&k| k != row).map(|k| matrix[row][k].value() * unknown[k]).sum();
        unknown[row] = (right[row].value() - known) / matrix[row][row].value();
    }
    unknown
}

fn quotient(a: DoubleDouble, b: DoubleDouble) -> DoubleDouble {
    let first = a.hi / b.hi;
    let rest = a - b.times(first);
    DoubleDouble::new(first, rest.hi / b.hi)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_soft_direction_beside_a_stiff_one_keeps_its_digits() {
        // 1e14 (1, 1, 1)ᵀ(1, 1, 1) + 1e-6 (0, 1, 2)ᵀ(0, 1, 2) and nothing else.
        let stiff = [1.0, 1.0, 1.0];
        let soft = [0.0, 1.0, 2.0];
        let mut matrix = [[DoubleDouble::default(); 3]; 3];
        for j in 0..3 {
            for k in 0..3 {
                matrix[j][k].add_product(1e14 * stiff[j], stiff[k]);
                matrix[j][k].add_product(1e-6 * soft[j], soft[k]);
            }
        }
        // The force of a unit of the soft direction alone: its stretch must be 1 and that of the stiff one 0.
        let right = soft.map(|s| DoubleDouble::from(1e-6 * s));
        let [a, b, c] = solved(matrix, right);
        assert!((b + 2.0 * c - 1.0).abs() < 1e-9 && (a + b + c).abs() < 1e-9, "{a} {b} {c}");
    }
}
