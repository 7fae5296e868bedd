//! How many connections may be open, in all and for each address. Connections beyond that are for health
//! checks and metrics.
//!
//! The limit for an address is a setting for services without a proxy. hyper and tower have no limit that
//! still lets a health check in, and a supervisor restarts a service whose health check gets no answer.

use std::collections::{HashMap, VecDeque};
use std::net::{IpAddr, Ipv6Addr};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::task::AbortHandle;

use crate::config::Settings;

/// Most connections beyond the limit. A health check needs one for some milliseconds.
const MOST_BEYOND: usize = 128;

/// How many connections may be open.
#[derive(Debug)]
pub struct ConnectionLimit {
    open: Arc<Mutex<Open>>,
    most: usize,
    most_of_address: usize,
}

/// The connections that are open.
#[derive(Debug, Default)]
struct Open {
    all: usize,
    /// By address; addresses without a connection are absent.
    of_address: HashMap<IpAddr, usize>,
}

impl ConnectionLimit {
    pub fn new(settings: &Settings) -> Self {
        Self {
            open: Arc::default(),
            most: settings.connections as usize,
            most_of_address: settings.connections_per_address as usize,
        }
    }

    /// Number of connections within the limit.
    pub fn open(&self) -> usize {
        locked(&self.open).all
    }

    /// Counts a connection from `address`. `None` where it is beyond the limit.
    pub fn take(&self, address: IpAddr) -> Option<Admitted> {
        let network = network(address);
        let mut open = locked(&self.open);
        let of_address = open.of_address.get(&network).copied().unwrap_or(0);
        if open.all >= self.most || of_address >= self.most_of_address {
            return None;
        }
        open.all += 1;
        open.of_address.insert(network, of_address + 1);
        Some(Admitted { open: Arc::clone(&self.open), network })
    }
}

fn locked(open: &Mutex<Open>) -> MutexGuard<'_, Open> {
    open.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What counts as one address: for IPv6 the network of 64 bits, in which one machine may take any address.
fn network(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V6(address) => {
            let [a, b, c, d, ..] = address.segments();
            Ipv6Addr::new(a, b, c, d, 0, 0, 0, 0).into()
        }
        address => address,
    }
}

/// A connection within the limit. Dropping the value counts the connection as closed.
#[derive(Debug)]
pub struct Admitted {
    open: Arc<Mutex<Open>>,
    network: IpAddr,
}

impl Drop for Admitted {
    fn drop(&mut self) {
        let mut open = locked(&self.open);
        open.all -= 1;
        if let Some(count) = open.of_address.get_mut(&self.network) {
            *count -= 1;
            if *count == 0 {
                open.of_address.remove(&self.network);
            }
        }
    }
}

/// The connections beyond the limit, the oldest first. A new one displaces the oldest when there are too
/// many.
#[derive(Debug, Default)]
pub struct BeyondLimit(VecDeque<AbortHandle>);

impl BeyondLimit {
    pub fn add(&mut self, connection: AbortHandle) {
        self.0.retain(|other| !other.is_finished());
        if self.0.len() >= MOST_BEYOND
            && let Some(oldest) = self.0.pop_front()
        {
            oldest.abort();
        }
        self.0.push_back(connection);
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;
    use crate::config::Cli;

    #[test]
    fn connections_are_limited_in_all_and_for_each_address() {
        let flags = ["toolpathd", "--connections", "3", "--connections-per-address", "2"];
        let limit = ConnectionLimit::new(&Cli::parse_from(flags).settings);
        let take = |address: &str| limit.take(address.parse().expect("an address"));
        let (one, two) = (take("10.0.0.1"), take("::ffff:10.0.0.1"));
        assert!(one.is_some() && two.is_some() && take("10.0.0.1").is_none());
        let other = take("2001:db8::1");
        assert!(other.is_some() && take("10.0.0.3").is_none());
        assert_eq!(limit.open(), 3);
        drop((one, two));
        let same_network = take("2001:db8::ffff");
        assert!(same_network.is_some() && take("2001:db8::2").is_none() && take("2001:db8:0:1::2").is_some());
        drop((other, same_network));
        assert_eq!((limit.open(), locked(&limit.open).of_address.len()), (0, 0));
    }

    #[tokio::test]
    async fn a_new_connection_beyond_the_limit_displaces_the_oldest() {
        let mut beyond = BeyondLimit::default();
        let tasks: Vec<_> = (0..=MOST_BEYOND).map(|_| tokio::spawn(std::future::pending::<()>())).collect();
        tasks.iter().for_each(|task| beyond.add(task.abort_handle()));
        let mut tasks = tasks.into_iter();
        assert!(tasks.next().expect("the oldest").await.expect_err("displaced").is_cancelled());
        assert!(tasks.all(|task| !task.is_finished()));
    }
}
