//! Dielectric tensors and their orientation.

use num_complex::Complex64;

use crate::OpticsError;
use crate::film::checked_index;

/// Complex relative dielectric tensor in the frame of the panel (x, y in the panel, z to the viewer).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dielectric(pub(super) [[Complex64; 3]; 3]);

/// Returns the unit vector of this azimuth and tilt, degrees, in the frame of the panel.
pub fn direction(azimuth_deg: f64, tilt_deg: f64) -> [f64; 3] {
    let ((sin, cos), (up, along)) = (azimuth_deg.to_radians().sin_cos(), tilt_deg.to_radians().sin_cos());
    [along * cos, along * sin, up]
}

/// Returns three principal axes, as rows. The first is [`direction`]; `roll_deg` turns the other two about it: at
/// 0 the second lies in the panel, counter-clockwise of the first.
pub fn axes(azimuth_deg: f64, tilt_deg: f64, roll_deg: f64) -> [[f64; 3]; 3] {
    let first = direction(azimuth_deg, tilt_deg);
    let level = direction(azimuth_deg + 90.0, 0.0);
    let raised = cross(first, level);
    let (sin, cos) = roll_deg.to_radians().sin_cos();
    let second = std::array::from_fn(|k| cos * level[k] + sin * raised[k]);
    [first, second, cross(first, second)]
}

impl Dielectric {
    /// Returns the tensor of an isotropic medium.
    ///
    /// # Errors
    /// If n or k is below 0, or both are 0; likewise below.
    pub fn isotropic(index: Complex64) -> Result<Self, OpticsError> {
        Self::biaxial([index; 3], axes(0.0, 0.0, 0.0))
    }

    /// Returns the tensor of a uniaxial medium with its optic axis along this unit vector.
    ///
    /// # Errors
    /// As of [`isotropic`](Self::isotropic).
    pub fn uniaxial(
        ordinary: Complex64,
        extraordinary: Complex64,
        axis: [f64; 3],
    ) -> Result<Self, OpticsError> {
        let [o, e] = [checked_index(ordinary)?.powi(2), checked_index(extraordinary)?.powi(2)];
        let element =
            |i: usize, k: usize| (e - o) * (axis[i] * axis[k]) + if i == k { o } else { Complex64::ZERO };
        Ok(Self(std::array::from_fn(|i| std::array::from_fn(|k| element(i, k)))))
    }

    /// Returns the tensor with these principal indices along orthogonal unit vectors.
    ///
    /// # Errors
    /// As of [`isotropic`](Self::isotropic).
    pub fn biaxial(indices: [Complex64; 3], axes: [[f64; 3]; 3]) -> Result<Self, OpticsError> {
        let mut out = [[Complex64::ZERO; 3]; 3];
        for (index, axis) in indices.into_iter().zip(axes) {
            let square = checked_index(index)?.powi(2);
            for (i, row) in out.iter_mut().enumerate() {
                row.iter_mut().enumerate().for_each(|(k, value)| *value += square * (axis[i] * axis[k]));
            }
        }
        Ok(Self(out))
    }

    /// Returns the tensor of any symmetric medium, by rows.
    pub fn of_rows(rows: [[Complex64; 3]; 3]) -> Self {
        Self(rows)
    }

    /// Returns its elements, by rows.
    pub fn rows(&self) -> [[Complex64; 3]; 3] {
        self.0
    }

    /// Returns the tensor in the frame of a wave that travels at this azimuth: x along its travel, z down
    /// into the stack, y = z x x.
    pub(super) fn for_wave(&self, azimuth_deg: f64) -> [[Complex64; 3]; 3] {
        let (sin, cos) = azimuth_deg.to_radians().sin_cos();
        let frame = [[cos, sin, 0.0], [sin, -cos, 0.0], [0.0, 0.0, -1.0]];
        let along = |i: usize, axis: [f64; 3]| -> Complex64 { (0..3).map(|k| self.0[i][k] * axis[k]).sum() };
        let between = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| along(i, b) * a[i]).sum();
        std::array::from_fn(|i| std::array::from_fn(|k| between(frame[i], frame[k])))
    }

    /// Returns the index of an isotropic medium of the same mean.
    pub(super) fn mean_index(&self) -> Complex64 {
        ((self.0[0][0] + self.0[1][1] + self.0[2][2]) / 3.0).sqrt()
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
