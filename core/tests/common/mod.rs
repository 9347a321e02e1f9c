//! The square plate that the contact tests use.
use signorini_core::element::{Kind, Material, Thickness};
use signorini_core::plate::Plate;
use std::sync::Arc;

pub const SIZE: usize = 3;

/// The plate in other units: lengths are multiplied by `length`, forces by `force`.
pub fn plate_in([length, force]: [f64; 2]) -> Arc<Plate> {
    let columns = 2 * SIZE + 1;
    let mut number = vec![usize::MAX; columns * columns];
    let mut points = Vec::new();
    for k in (0..columns * columns).filter(|k| k % columns % 2 == 0 || k / columns % 2 == 0) {
        number[k] = points.len();
        points.push([length * (0.5 * (k % columns) as f64 - 1.5), length * (0.5 * (k / columns) as f64 - 1.5)]);
    }
    let corner = |e: usize| 2 * (e / SIZE) * columns + 2 * (e % SIZE);
    let nodes = [0, 2, 2 * columns + 2, 2 * columns, 1, columns + 2, 2 * columns + 1, columns];
    let elements = (0..SIZE * SIZE).map(|e| nodes.map(|offset| number[corner(e) + offset])).collect();
    let thickness = Thickness::Constant(0.2 * length);
    let material = Material::isotropic(1000.0 * force / (length * length), 0.3, 5.0 / 6.0);
    Arc::new(Plate::new(points, elements, thickness, material, Kind::Mitc9, None).unwrap())
}

pub fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |a, b| a.max(b.abs()))
}
