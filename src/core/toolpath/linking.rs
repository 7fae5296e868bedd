//! Rapids between passes: up, across and down. A rapid of length zero is left out.

use nalgebra::Point3;

use super::{Builder, PathError};

/// The place over or under `p` at the height `z` mm.
pub fn at_height(p: Point3<f64>, z: f64) -> Point3<f64> {
    Point3::new(p.x, p.y, z)
}

impl Builder {
    /// Goes straight up or down to the height `z` mm.
    ///
    /// # Errors
    /// When `z` is not finite.
    pub fn rapid_to_height(&mut self, z: f64) -> Result<(), PathError> {
        self.rapid_unless_there(at_height(self.at(), z))
    }

    /// Goes to the place over `to` by way of the height `over_z`, and there down to the height `down_z`; mm.
    ///
    /// # Errors
    /// When a coordinate is not finite.
    pub fn rapid_over(&mut self, to: Point3<f64>, over_z: f64, down_z: f64) -> Result<(), PathError> {
        self.rapid_to_height(over_z)?;
        self.rapid_unless_there(at_height(to, over_z))?;
        self.rapid_to_height(down_z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toolpath::Toolpath;

    #[test]
    fn rapids_go_up_across_and_down_and_never_nowhere() {
        let mut builder = Toolpath::builder(Point3::new(1.0, 2.0, -3.0));
        builder.begin_pass(None);
        for _ in 0..2 {
            builder.rapid_over(Point3::new(5.0, 2.0, -4.0), 10.0, 1.0).unwrap();
        }
        builder.rapid_over(Point3::new(5.0, 2.0, -4.0), 1.0, 1.0).unwrap();
        let toolpath = builder.finish().unwrap();
        // Up, across and down; then up and down; then nothing.
        assert_eq!(toolpath.moves().count(), 5);
    }
}
