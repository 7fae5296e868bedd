//! Generic machines by name: examples of the usual kinds, with round numbers. They describe no machine of any
//! maker. Axes pass through the origin of the workpiece, or through the rotary centre of the head.
//!
//! | name | rotary axes |
//! |---|---|
//! | `table_table_ac` | A about X carries C about Z, which carries the workpiece |
//! | `table_table_bc` | B about Y carries C about Z, which carries the workpiece |
//! | `table_table_nutating_bc` | B at 45 degrees between Y and Z carries C about Z, which carries the workpiece |
//! | `head_table_bc` | B about Y carries the tool, pivot 150 mm; C about Z carries the workpiece |
//! | `head_head_ca` | C about Z carries A about X, which carries the tool; pivot 150 mm |
//! | `head_head_cb` | C about Z carries B about Y, which carries the tool; pivot 150 mm |

use std::f64::consts::FRAC_1_SQRT_2;

use nalgebra::{Point3, UnitVector3, Vector3};

use super::{Kind, Machine, RotaryAxis};

/// Travel of X, Y and Z of every machine, mm.
const TRAVEL_MM: [Option<[f64; 2]>; 3] =
    [Some([-500.0, 500.0]), Some([-400.0, 400.0]), Some([-300.0, 500.0])];

/// Distance from the tool tip to the rotary centre of the heads, mm.
const PIVOT_MM: f64 = 150.0;

/// The machines, in the order of the table above.
pub fn named() -> Vec<Machine> {
    use Kind::{HeadHead, HeadTable, TableTable};
    let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
    let nutating = FRAC_1_SQRT_2 * (y + z);
    let endless = RotaryAxis { is_wrapped: true, ..axis('C', z, None) };
    let machines = [
        (
            "table_table_ac",
            TableTable,
            [axis('A', x, Some([-120, 30])), axis('C', z, Some([-360, 360]))],
            0.0,
        ),
        ("table_table_bc", TableTable, [axis('B', y, Some([-110, 110])), endless], 0.0),
        ("table_table_nutating_bc", TableTable, [axis('B', nutating, Some([-5, 185])), endless], 0.0),
        ("head_table_bc", HeadTable, [axis('B', y, Some([-30, 120])), endless], PIVOT_MM),
        (
            "head_head_ca",
            HeadHead,
            [axis('C', z, Some([-360, 360])), axis('A', x, Some([-110, 110]))],
            PIVOT_MM,
        ),
        (
            "head_head_cb",
            HeadHead,
            [axis('C', z, Some([-360, 360])), axis('B', y, Some([-110, 110]))],
            PIVOT_MM,
        ),
    ];
    // A test holds that none of them is refused.
    machines
        .into_iter()
        .filter_map(|(name, kind, rotary, pivot_mm)| {
            Machine::new(name, kind, rotary, TRAVEL_MM, pivot_mm).ok()
        })
        .collect()
}

/// The machine with a name.
pub fn by_name(name: &str) -> Option<Machine> {
    named().into_iter().find(|machine| machine.name() == name)
}

/// An axis through the origin, with its travel in degrees.
fn axis(name: char, direction: Vector3<f64>, travel_deg: Option<[i32; 2]>) -> RotaryAxis {
    RotaryAxis {
        name,
        direction: UnitVector3::new_normalize(direction),
        point_mm: Point3::origin(),
        travel: travel_deg.map(|ends| ends.map(|end| f64::from(end).to_radians())),
        is_wrapped: false,
        is_mirrored: false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_machine_of_the_table_is_valid_and_found_by_its_name() {
        let machines = named();
        assert_eq!(machines.len(), 6);
        for machine in machines {
            assert_eq!(by_name(machine.name()), Some(machine));
        }
        assert_eq!(by_name("unknown"), None);
    }
}
