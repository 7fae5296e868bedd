//! Numbers in a row of bytes.

use crate::fault::{Place, Unreadable};

/// The order of the bytes of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    LittleEndian,
    BigEndian,
}

/// Takes numbers from the bytes of a file, one behind the other.
#[derive(Clone)]
pub struct Bytes<'a> {
    all: &'a [u8],
    at: usize,
    order: Order,
}

impl<'a> Bytes<'a> {
    /// The bytes of a file from the byte `at` on.
    pub fn new(all: &'a [u8], at: usize, order: Order) -> Self {
        Self { all, at: at.min(all.len()), order }
    }

    /// The place of the next byte.
    pub fn place(&self) -> Place {
        Place::Byte(self.at as u64)
    }

    /// How many bytes are left.
    pub fn n_left(&self) -> usize {
        self.all.len() - self.at
    }

    /// Takes `n` bytes.
    ///
    /// # Errors
    /// When fewer are left.
    pub fn take(&mut self, n: usize) -> Result<&'a [u8], Unreadable> {
        if n > self.n_left() {
            let detail = format!("the file ends here; {n} bytes were to follow byte {}", self.at);
            return Err(Unreadable::at(Place::Byte(self.all.len() as u64), detail));
        }
        let taken = &self.all[self.at..self.at + n];
        self.at += n;
        Ok(taken)
    }

    /// Takes N bytes, the least first.
    ///
    /// # Errors
    /// When fewer are left.
    pub fn little<const N: usize>(&mut self) -> Result<[u8; N], Unreadable> {
        let mut bytes = [0; N];
        bytes.copy_from_slice(self.take(N)?);
        if self.order == Order::BigEndian {
            bytes.reverse();
        }
        Ok(bytes)
    }

    pub fn u16(&mut self) -> Result<u16, Unreadable> {
        self.little().map(u16::from_le_bytes)
    }

    pub fn u32(&mut self) -> Result<u32, Unreadable> {
        self.little().map(u32::from_le_bytes)
    }

    pub fn u64(&mut self) -> Result<u64, Unreadable> {
        self.little().map(u64::from_le_bytes)
    }
}
