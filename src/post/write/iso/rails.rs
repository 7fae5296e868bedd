//! Rails in the words of Siemens: polynomials of the tip and of a second point.

use super::Writer;
use crate::WriteError;
use crate::rails::{RAIL_DECIMALS, RailWords};
use crate::words::{AXES, FeedWord, fixed};

const SECOND: [&str; 3] = ["XH", "YH", "ZH"];

impl Writer<'_> {
    /// States the second point where the tip is, so that the first polynomial knows its start.
    pub(super) fn begin_rails(&mut self, second: [i64; 3], feed: FeedWord) -> Result<(), WriteError> {
        self.lines.line("ORICURVE")?;
        self.feed_mode(false);
        self.motion("G1");
        for (axis, at) in self.at.into_iter().enumerate() {
            if let Some(at) = at {
                self.axis(axis, at);
            }
        }
        for (name, at) in SECOND.into_iter().zip(second) {
            self.lines.number(&format!("{name}="), at, RAIL_DECIMALS);
        }
        self.feed(feed);
        Ok(())
    }

    /// The ends of the polynomials and the coefficients of their powers from 2 on, for a parameter from 0 to
    /// 1.
    pub(super) fn rail(&mut self, index: usize) {
        let RailWords { to, second, powers, feed } = self.part.lowered.rails[index];
        self.motion("POLY");
        let decimals = self.job.program.resolution.decimals;
        for axis in 0..3 {
            self.polynomial(&AXES[axis].to_string(), (to[axis], decimals), powers[0].map(|p| p[axis]));
            self.at[axis] = Some(to[axis]);
        }
        for axis in 0..3 {
            self.polynomial(SECOND[axis], (second[axis], RAIL_DECIMALS), powers[1].map(|p| p[axis]));
        }
        self.lines.word("PL=1");
        self.feed(feed);
    }

    fn polynomial(&mut self, name: &str, (end, decimals): (i64, u8), powers: [i64; 4]) {
        let degree = powers.iter().rposition(|p| *p != 0).map_or(0, |k| k + 1);
        let mut text = format!("PO[{name}]=({}", fixed(end, decimals));
        self.lines.check_digits(end, decimals);
        for power in &powers[..degree] {
            text.push(',');
            text.push_str(&fixed(*power, RAIL_DECIMALS));
            self.lines.check_digits(*power, RAIL_DECIMALS);
        }
        text.push(')');
        self.lines.word(&text);
    }
}
