//! The modal state behind each block.

use super::*;
use crate::codes::{FeedMode, Motion};

#[test]
fn each_block_that_runs_has_its_state() {
    let text = "G20 G90\nT3 M6\nG0 X1 Y0 Z1\nG55 G91 G1 Z-1 F10 S500 M3\nM98 P7 L2\nM30\nO7\nX1.\nM99";
    let traced = ReadJob { most_traced: 100, start: [Some(0.0); 3], ..job("mach4", text) };
    let offsets = [(1, [0.0; 3]), (2, [10.0, 0.0, 0.0])];
    let reading = reading(&ReadJob { offsets: &offsets, start: [Some(0.0); 3], ..traced.clone() });
    let lines: Vec<u32> = reading.trace.iter().map(|block| block.line).collect();
    assert_eq!(lines, [1, 2, 3, 4, 5, 8, 9, 8, 9, 6]);
    let second = &reading.trace[2];
    assert_eq!((second.motion, second.is_in_inches, second.is_absolute), (Some(Motion::Rapid), true, true));
    assert_eq!(second.at, [Some(25.4), Some(0.0), Some(25.4)]);
    let few = ReadJob { offsets: &offsets, most_traced: 2, ..traced };
    assert_eq!(super::reading(&few).trace, reading.trace[..2]);
    let last = reading.trace.last().unwrap();
    assert_eq!((last.tool, last.work_offset, last.feed_mode), (Some(3), 2, FeedMode::PerMinute));
    close(&[last.feed.unwrap(), last.speed_rpm.unwrap()], &[254.0, 500.0]);
}
