//! Rigid motions of plates as nodal vectors, and small linear systems in double-double.

use super::scale::Scale;
use super::tolerances;
use crate::double_double::DoubleDouble;
use crate::plate::Plate;

/// A small matrix in double-double, as a list of rows.
pub(super) type Matrix = Vec<Vec<DoubleDouble>>;

/// The rigid motions w = 1, (x − x₀)/a, (y − y₀)/a as nodal vectors (3n,). (x₀, y₀) is the centre of the bounding box
/// of all plates, a its longer side.
pub(super) fn rigid_motions(plate: &Plate, &Scale { centre, size, .. }: &Scale) -> [Vec<f64>; 3] {
    let motion = |k: usize| -> Vec<f64> {
        let of_node = |node: usize| {
            let [x, y] = plate.point(node);
            let [c, s] = plate.frame(node).unwrap_or([1.0, 0.0]);
            let arm = [(x - centre[0]) / size, (y - centre[1]) / size];
            [[1.0, 0.0, 0.0], [arm[0], c / size, -s / size], [arm[1], s / size, c / size]][k]
        };
        (0..plate.node_count()).flat_map(of_node).collect()
    };
    [motion(0), motion(1), motion(2)]
}

/// For each connected component of the mesh, the rigid motion (w, θx, θy at the centre) that is nearest to the
/// prescribed values of its held dofs in least squares. `None` if all these values are zero.
pub(super) fn nearest_motions(plate: &Plate, scale: &Scale, held: &[bool], value: &[f64]) -> Option<Vec<[f64; 3]>> {
    if (0..held.len()).all(|dof| !held[dof] || value[dof] == 0.0) {
        return None;
    }
    let (components, motions) = (plate.components(), rigid_motions(plate, scale));
    let mut matrix = vec![vec![vec![DoubleDouble::default(); 3]; 3]; components.count()];
    let mut right = vec![vec![DoubleDouble::default(); 3]; components.count()];
    for dof in (0..held.len()).filter(|&dof| held[dof]) {
        let component = components.of(dof / 3);
        let weight = if dof % 3 == 0 { 1.0 } else { scale.size };
        let arm = [0, 1, 2].map(|k| weight * motions[k][dof]);
        for j in 0..3 {
            (0..3).for_each(|k| matrix[component][j][k].add_product(arm[j], arm[k]));
            right[component][j].add_product(arm[j], weight * value[dof]);
        }
    }
    let of = |(matrix, right)| {
        let amount = eliminated(matrix, right).unknown;
        [amount[0], amount[1] / scale.size, amount[2] / scale.size]
    };
    Some(matrix.into_iter().zip(right).map(of).collect())
}

/// Solution of a symmetric system of equations by elimination, with pivots chosen by size.
pub(super) struct Eliminated {
    /// Unknowns (n,) of the equations; unknowns that no equation determines are zero.
    pub(super) unknown: Vec<f64>,
    /// Smallest pivot of the elimination that does not count as zero.
    pub(super) least: f64,
    /// Largest magnitude of the right-hand side in the equations without a pivot. It is 0 if the equations have a
    /// solution.
    pub(super) unbalanced: f64,
}

pub(super) fn eliminated(mut matrix: Matrix, mut right: Vec<DoubleDouble>) -> Eliminated {
    let n = right.len();
    let mut order = Vec::new();
    let mut largest = 0.0_f64;
    let mut least = f64::INFINITY;
    loop {
        let left = (0..n).filter(|i| !order.contains(i));
        let Some(pivot) = left.max_by(|&a, &b| matrix[a][a].hi.total_cmp(&matrix[b][b].hi)) else { break };
        largest = largest.max(matrix[pivot][pivot].hi);
        if matrix[pivot][pivot].hi <= tolerances::HELD * largest {
            break;
        }
        order.push(pivot);
        least = matrix[pivot][pivot].hi;
        for row in (0..n).filter(|i| !order.contains(i)) {
            let factor = quotient(matrix[row][pivot], matrix[pivot][pivot]);
            for column in 0..n {
                matrix[row][column] = matrix[row][column] - factor.times_sum(matrix[pivot][column]);
            }
            right[row] = right[row] - factor.times_sum(right[pivot]);
        }
    }
    let mut unknown = vec![0.0; n];
    for &row in order.iter().rev() {
        let known: f64 = (0..n).filter(|&k| k != row).map(|k| matrix[row][k].value() * unknown[k]).sum();
        unknown[row] = (right[row].value() - known) / matrix[row][row].value();
    }
    let unbalanced = (0..n).filter(|i| !order.contains(i)).map(|i| right[i].value().abs()).fold(0.0, f64::max);
    Eliminated { unknown, least, unbalanced }
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
        // The matrix 1e14 (1, 1, 1)ᵀ(1, 1, 1) + 1e-6 (0, 1, 2)ᵀ(0, 1, 2).
        let stiff = [1.0, 1.0, 1.0];
        let soft = [0.0, 1.0, 2.0];
        let mut matrix = vec![vec![DoubleDouble::default(); 3]; 3];
        for j in 0..3 {
            for k in 0..3 {
                matrix[j][k].add_product(1e14 * stiff[j], stiff[k]);
                matrix[j][k].add_product(1e-6 * soft[j], soft[k]);
            }
        }
        // For the right-hand side 1e-6 (0, 1, 2)ᵀ the solution has (0, 1, 2)·x = 1 and (1, 1, 1)·x = 0.
        let right = soft.map(|s| DoubleDouble::from(1e-6 * s)).to_vec();
        let Eliminated { unknown, least, unbalanced } = eliminated(matrix, right);
        let [a, b, c] = unknown[..] else { panic!("three unknowns") };
        assert!((b + 2.0 * c - 1.0).abs() < 1e-9 && (a + b + c).abs() < 1e-9, "{a} {b} {c}");
        assert!(least < 1e-5 && unbalanced < 1e-9);
    }
}
