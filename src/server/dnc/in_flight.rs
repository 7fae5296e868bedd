//! How many characters are on their way: given to the system and not yet taken by the line.
//!
//! Two figures tell: a model of the line, which takes one character in the time of its bits, and the output
//! queue that the system states. The larger figure counts. The model alone drifts, because no two clocks
//! agree; the queue alone leaves out the buffers of adapters and is always empty on a pseudo terminal.

use std::time::Duration;

/// Most characters on their way on a line with a known speed. A control commonly has room for 64 characters
/// when it sends XOFF. Half of them are left for those that arrive before the XOFF is read.
pub const MOST: usize = 32;

/// Most characters of one write on a line without a known speed. 64 bytes fill one packet of full-speed USB.
pub const UNPACED_WRITE: usize = 64;

/// The shortest time to wait until the system's queue is asked again.
const QUEUE_INTERVAL: Duration = Duration::from_millis(1);

/// The characters on their way.
#[derive(Debug, Clone)]
pub struct InFlight {
    /// Characters a second; `None` without a known speed.
    rate: Option<f64>,
    /// Characters on their way by the model, at the time `at`.
    modelled: f64,
    at: Duration,
}

impl InFlight {
    /// `rate` is the speed of the line in characters a second.
    pub fn new(rate: Option<f64>) -> Self {
        Self { rate, modelled: 0.0, at: Duration::ZERO }
    }

    fn most(&self) -> usize {
        if self.rate.is_some() { MOST } else { UNPACED_WRITE }
    }

    fn modelled(&self, now: Duration) -> f64 {
        let taken = self.rate.unwrap_or_default() * now.saturating_sub(self.at).as_secs_f64();
        (self.modelled - taken).max(0.0)
    }

    /// Characters on their way at the time `now`, while the system's queue holds `queued`.
    pub fn characters(&self, now: Duration, queued: usize) -> usize {
        queued.max(self.modelled(now).ceil() as usize)
    }

    /// Number of characters that may be written now: none, or at least half of what may be on its way. Short
    /// writes would cost more than they gain.
    pub fn room(&self, now: Duration, queued: usize) -> usize {
        let room = self.most().saturating_sub(self.characters(now, queued));
        if room >= self.most() / 2 { room } else { 0 }
    }

    /// The time at which there may be room again.
    pub fn time_of_room(&self, now: Duration, queued: usize) -> Duration {
        let excess = self.characters(now, queued) as f64 - (self.most() / 2) as f64;
        let wait = self.rate.map_or(Duration::ZERO, |rate| Duration::from_secs_f64(excess.max(0.0) / rate));
        now + wait.max(QUEUE_INTERVAL)
    }

    /// Tells that `count` characters were given to the system.
    pub fn wrote(&mut self, count: usize, now: Duration) {
        // Without a known speed nothing would ever leave the model.
        if self.rate.is_some() {
            self.modelled = self.modelled(now) + count as f64;
            self.at = now;
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_line_takes_a_character_in_the_time_of_its_bits() {
        let mut in_flight = InFlight::new(Some(1000.0));
        assert_eq!(in_flight.room(Duration::ZERO, 0), MOST);
        in_flight.wrote(MOST, Duration::ZERO);
        assert_eq!((in_flight.characters(Duration::ZERO, 0), in_flight.room(Duration::ZERO, 0)), (MOST, 0));
        assert_eq!(in_flight.time_of_room(Duration::ZERO, 0), Duration::from_millis(16));
        assert_eq!(in_flight.room(Duration::from_millis(15), 0), 0);
        assert_eq!(in_flight.room(Duration::from_millis(16), 0), MOST / 2);
        assert_eq!(in_flight.characters(Duration::from_millis(32), 0), 0);
    }

    #[test]
    fn the_systems_queue_counts_where_it_is_longer_than_the_model_says() {
        let mut in_flight = InFlight::new(Some(1000.0));
        in_flight.wrote(10, Duration::ZERO);
        let late = Duration::from_secs(1);
        assert_eq!((in_flight.characters(late, 0), in_flight.characters(late, 20)), (0, 20));
        assert_eq!((in_flight.room(late, 20), in_flight.room(late, 16)), (0, 16));
        let unpaced = InFlight::new(None);
        assert_eq!((unpaced.room(late, 0), unpaced.room(late, 33)), (UNPACED_WRITE, 0));
    }

    proptest! {
        /// However the writes fall, the line never holds more than it may, and over a long time it is kept
        /// busy.
        #[test]
        fn the_line_is_never_overfilled(rate in 400.0..12_000.0_f64, delays in prop::collection::vec(0_u64..3000, 1..300)) {
            let mut in_flight = InFlight::new(Some(rate));
            let (mut now, mut written, mut line_free) = (Duration::ZERO, 0_usize, 0.0_f64);
            for delay in delays {
                now += Duration::from_micros(delay);
                let room = in_flight.room(now, 0);
                in_flight.wrote(room, now);
                written += room;
                line_free = line_free.max(now.as_secs_f64()) + room as f64 / rate;
                let on_line = (line_free - now.as_secs_f64()) * rate;
                prop_assert!(on_line <= MOST as f64 + 1e-3, "{} characters are on the line", on_line);
            }
            prop_assert!(written as f64 <= now.as_secs_f64() * rate + MOST as f64 + 1e-3);
        }
    }
}
